/* Pictures in rows and columns. */
#include "scene/picture_grid.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "image/annotate.h"
#include "image/font.h"

iso_status iso_picture_grid_lay_out(iso_picture_grid *g, const char *option, uint64_t limit,
                                    iso_error *error) {
    g->font = iso_annotation_font_size(g->font, g->panel[0], g->panel[1]);
    g->text = g->font * ISO_FONT_CAPITALS / ISO_FONT_SIZE;
    g->margin = ceil((g->below ? 2 : 0.8) * g->text);
    g->band = ceil((g->below ? 2.8 : 2.1) * g->text);
    if (!g->columns) g->columns = g->count <= 3 ? g->count : (int)ceil(sqrt(g->count));
    if (g->columns > g->count) g->columns = g->count;
    g->rows = (g->count + g->columns - 1) / g->columns;
    const double width = g->columns * (g->panel[0] + g->margin) + g->margin,
                 height = g->rows * (g->panel[1] + g->band) + g->margin,
                 bytes = 4 * (width * height + (double)g->count * g->panel[0] * g->panel[1]);
    if (width > ISO_IMAGE_MAX || height > ISO_IMAGE_MAX)
        return iso_fail(error, ISO_ERR_LIMIT, "%s: a sheet of %.0fx%.0f pixels; at most %d a side", option,
                        width, height, ISO_IMAGE_MAX);
    if (bytes > (double)limit)
        return iso_fail(error, ISO_ERR_LIMIT, "%s: a sheet of %.0fx%.0f pixels needs %.0f MB (--max-memory)",
                        option, width, height, bytes / 1e6);
    g->width = (int)width;
    g->height = (int)height;
    return ISO_OK;
}

void iso_picture_grid_fill(const iso_picture_grid *g, iso_image *sheet) {
    const uint8_t color[4] = {g->background.r, g->background.g, g->background.b, 255};
    for (size_t i = 0; i < (size_t)sheet->width * (size_t)sheet->height; i++)
        if (g->transparent)
            memset(sheet->rgba + 4 * i, 0, 4);
        else
            memcpy(sheet->rgba + 4 * i, color, 4);
}

void iso_picture_grid_corner(const iso_picture_grid *g, int number, int corner[2]) {
    corner[0] = (int)(g->margin + number % g->columns * (g->panel[0] + g->margin));
    corner[1] = (int)((g->below ? g->margin : g->band) + number / g->columns * (g->panel[1] + g->band));
}

void iso_picture_grid_place(const iso_picture_grid *g, int number, const iso_image *from, iso_image *sheet) {
    int corner[2];
    iso_picture_grid_corner(g, number, corner);
    for (int y = 0; y < from->height; y++)
        memcpy(sheet->rgba + 4 * ((size_t)(corner[1] + y) * (size_t)sheet->width + (size_t)corner[0]),
               from->rgba + 4 * (size_t)y * (size_t)from->width, 4 * (size_t)from->width);
}

static double width_of(const iso_picture_grid *g, const char *text) {
    return iso_font_width(text) * g->font / ISO_FONT_SIZE;
}

size_t iso_picture_grid_cut(const iso_picture_grid *g, const char *text, double pixels, char *cut,
                            size_t room) {
    size_t length = (size_t)snprintf(cut, room, "%s", text);
    if (length >= room) length = room - 1;
    while (length && ((text[length] && !cut[length]) || width_of(g, cut) > pixels)) {
        do length--;
        while (length && (length > room - 4 || ((unsigned char)text[length] & 0xC0) == 0x80));
        snprintf(cut + length, room - length, "\u2026");
        if (width_of(g, cut) <= pixels) break;
    }
    return length;
}

void iso_picture_grid_title(const iso_picture_grid *g, int number, char letter, const char *title,
                            const char *right, iso_drawing *over) {
    const iso_rgb ink =
        iso_is_dark(g->background, g->transparent) ? (iso_rgb){255, 255, 255} : (iso_rgb){0, 0, 0};
    const char text[2] = {letter, 0};
    const double indent = letter ? (iso_font_width(text) / ISO_FONT_SIZE + 0.5) * g->font : 0,
                 width = right ? width_of(g, right) : 0, room = right ? width + 0.5 * g->font : 0;
    char cut[256];
    int corner[2];
    iso_picture_grid_corner(g, number, corner);
    const double x = corner[0], y = corner[1] + (g->below ? g->panel[1] + 1.5 * g->text : -0.6 * g->text);
    iso_mark *mark = letter ? iso_drawing_text(over, text, x, y, g->font, ink) : NULL;
    if (mark) mark->bold = true;
    iso_picture_grid_cut(g, title, g->panel[0] - indent - room, cut, sizeof cut);
    iso_drawing_text(over, cut, x + indent, y, g->font, ink);
    if (right) iso_drawing_text(over, right, x + g->panel[0] - width, y, g->font, ink);
}
