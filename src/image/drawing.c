/* drawing: the list of marks. */
#include "image/drawing.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/text.h"
#include "image/font.h"

/* Hebrew, Arabic and what is written as they are, with their presentation forms and marks of direction. */
static bool is_right_to_left(uint32_t c) {
    return (c >= 0x590 && c <= 0x8FF) || (c >= 0xFB1D && c <= 0xFDFF) || (c >= 0xFE70 && c <= 0xFEFF) ||
           (c >= 0x10800 && c <= 0x10FFF) || (c >= 0x1E800 && c <= 0x1EFFF) || c == 0x200F || c == 0x202B ||
           c == 0x202E || c == 0x2067;
}

iso_status iso_drawing_check_text(const char *text, iso_error *error) {
    int count = 0;
    const char *at = text, *before = text;
    for (uint32_t c = iso_font_next(&at); c; before = at, c = iso_font_next(&at), count++) {
        if (is_right_to_left(c))
            return iso_fail(error, ISO_ERR_USAGE,
                            "'%.60s': text from right to left cannot be drawn: the font has Latin, Greek and "
                            "Cyrillic letters",
                            text);
        if (c < ' ' || !iso_font_glyph(c))
            return iso_fail(
                error, ISO_ERR_USAGE,
                "'%.60s': character '%.*s' (U+%04X) cannot be drawn: the font has Latin, Greek and "
                "Cyrillic letters",
                text, (int)(at - before), before, (unsigned)c);
    }
    if (!count) return iso_fail(error, ISO_ERR_USAGE, "the text is empty");
    if (count > ISO_FONT_LONGEST)
        return iso_fail(error, ISO_ERR_USAGE, "'%.40s..': a text of %d characters; at most %d are drawn",
                        text, count, ISO_FONT_LONGEST);
    return ISO_OK;
}

static iso_mark *add(iso_drawing *d, iso_mark_kind kind, iso_rgb color) {
    if (d->count == d->room) {
        const int room = d->room ? 2 * d->room : 32;
        iso_mark *grown = realloc(d->marks, (size_t)room * sizeof *grown);
        if (!grown) {
            d->failed = true;
            return NULL;
        }
        d->marks = grown;
        d->room = room;
    }
    iso_mark *mark = &d->marks[d->count++];
    *mark = (iso_mark){.kind = kind, .color = color};
    return mark;
}

iso_mark *iso_drawing_lines(iso_drawing *drawing, iso_rgb color, double width) {
    iso_mark *mark = add(drawing, ISO_MARK_LINES, color);
    if (mark) mark->width = width;
    return mark;
}

static bool add_points(iso_drawing *d, iso_mark *mark, const double (*points)[2], int count) {
    double(*grown)[2] = realloc(mark->points, (size_t)(mark->point_count + count) * sizeof *grown);
    d->failed |= !grown;
    if (!grown) return false;
    memcpy(grown + mark->point_count, points, (size_t)count * sizeof *grown);
    mark->points = grown;
    mark->point_count += count;
    return true;
}

void iso_drawing_line(iso_drawing *drawing, iso_mark *lines, double x0, double y0, double x1, double y1) {
    const double ends[2][2] = {{x0, y0}, {x1, y1}};
    if (lines) add_points(drawing, lines, ends, 2);
}

iso_mark *iso_drawing_polygon(iso_drawing *drawing, iso_rgb color, const double (*corners)[2], int count) {
    iso_mark *mark = add(drawing, ISO_MARK_POLYGON, color);
    return mark && add_points(drawing, mark, corners, count) ? mark : NULL;
}

iso_mark *iso_drawing_text(iso_drawing *drawing, const char *text, double x, double y, double size,
                           iso_rgb color) {
    iso_mark *mark = add(drawing, ISO_MARK_TEXT, color);
    if (!mark) return NULL;
    mark->x = x, mark->y = y, mark->size = size;
    mark->text = iso_text_clean_copy(text);
    drawing->failed |= !mark->text;
    return mark->text ? mark : NULL;
}

iso_mark *iso_drawing_picture(iso_drawing *drawing, iso_image *picture, double left, double top, double right,
                              double bottom) {
    iso_mark *mark = add(drawing, ISO_MARK_PICTURE, (iso_rgb){0, 0, 0});
    if (!mark) {
        iso_image_free(picture);
        return NULL;
    }
    mark->left = left, mark->top = top, mark->right = right, mark->bottom = bottom;
    mark->picture = *picture;
    *picture = (iso_image){.rgba = NULL};
    return mark;
}

void iso_drawing_append(iso_drawing *drawing, iso_drawing *from, double x, double y) {
    drawing->failed |= from->failed;
    for (int i = 0; i < from->count; i++) {
        iso_mark *mark = add(drawing, ISO_MARK_LINES, (iso_rgb){0, 0, 0}), *moved = &from->marks[i];
        if (!mark) break;
        *mark = *moved;
        moved->points = NULL, moved->text = NULL, moved->picture = (iso_image){.rgba = NULL};
        for (int k = 0; k < mark->point_count; k++) mark->points[k][0] += x, mark->points[k][1] += y;
        mark->x += x, mark->left += x, mark->right += x;
        mark->y += y, mark->top += y, mark->bottom += y;
    }
    iso_drawing_free(from);
}

static void widen(double box[4], double x, double y) {
    box[0] = fmin(box[0], x), box[1] = fmin(box[1], y);
    box[2] = fmax(box[2], x), box[3] = fmax(box[3], y);
}

void iso_drawing_box(const iso_drawing *drawing, double box[4]) {
    box[0] = box[1] = INFINITY, box[2] = box[3] = -INFINITY;
    for (int i = 0; i < drawing->count; i++) {
        const iso_mark *m = &drawing->marks[i];
        const double unit = m->size / ISO_FONT_SIZE;
        for (int k = 0; k < m->point_count; k++) widen(box, m->points[k][0], m->points[k][1]);
        if (m->kind == ISO_MARK_TEXT) {
            widen(box, m->x, m->y - ISO_FONT_CAPITALS * unit);
            widen(box, m->x + (m->text ? iso_font_width(m->text) * unit : 0), m->y + ISO_FONT_DESCENT * unit);
        } else if (m->kind == ISO_MARK_PICTURE) {
            widen(box, m->left, m->top);
            widen(box, m->right, m->bottom);
        }
    }
}

iso_status iso_drawing_check(const iso_drawing *drawing, iso_error *error) {
    return drawing->failed ? iso_fail(error, ISO_ERR_NOMEM, "out of memory for annotations") : ISO_OK;
}

void iso_drawing_free(iso_drawing *drawing) {
    for (int i = 0; i < drawing->count; i++) {
        free(drawing->marks[i].points);
        free(drawing->marks[i].text);
        iso_image_free(&drawing->marks[i].picture);
    }
    free(drawing->marks);
    *drawing = (iso_drawing){.marks = NULL};
}
