/* svg_write: a drawing as SVG 1.1. */
#include <stdlib.h>

#include "base/file.h"
#include "base/html.h"
#include "base/text.h"
#include "image/drawing_write.h"
#include "image/font.h"

double iso_sheet_points(const iso_sheet *sheet) {
    return sheet->pixels_per_metre > 0 ? 72 / 0.0254 / sheet->pixels_per_metre : 1;
}

static void put_escaped(FILE *f, const char *text) {
    for (; *text; text++)
        if (*text == '<' || *text == '>' || *text == '&' || *text == '"')
            fprintf(f, "&#%d;", *text);
        else
            fputc(*text, f);
}

static void put_color(FILE *f, const char *name, iso_rgb c) {
    fprintf(f, " %s=\"#%02x%02x%02x\"", name, c.r, c.g, c.b);
}

static iso_status put_picture(FILE *f, const iso_mark *mark, iso_pool *pool, iso_error *error) {
    uint8_t *bytes;
    size_t size;
    const iso_png_opts opts = {.small = true, .pool = pool};
    ISO_TRY(iso_png_encode(&mark->picture, &opts, &bytes, &size, error));
    const double width = mark->right - mark->left, height = mark->bottom - mark->top;
    fprintf(f, "<image x=\"%.7g\" y=\"%.7g\" width=\"%.7g\" height=\"%.7g\" preserveAspectRatio=\"none\" ",
            mark->left, mark->top, width, height);
    fputs("xlink:href=\"data:image/png;base64,", f);
    iso_html_base64(f, bytes, size);
    fputs("\"/>\n", f);
    free(bytes);
    return ISO_OK;
}

/* Draws along the edges of a mark: lines, or the halo around it. That of a text is no text, which would be
 * found and read a second time. */
static iso_status put_stroke(FILE *f, const iso_mark *mark, iso_rgb color, double width, iso_error *error) {
    iso_edge *edges;
    const int count = iso_mark_edges(mark, &edges);
    if (count < 0) return iso_fail(error, ISO_ERR_NOMEM, "out of memory for annotations");
    fputs("<path", f);
    put_color(f, "stroke", color);
    fprintf(f, " stroke-width=\"%.6g\" d=\"", width);
    for (int i = 0; i < count; i++) {
        const iso_edge *e = &edges[i];
        if (i == 0 || e->x0 != e[-1].x1 || e->y0 != e[-1].y1) fprintf(f, "M%.6g %.6g", e->x0, e->y0);
        fprintf(f, "L%.6g %.6g", e->x1, e->y1);
    }
    fputs("\"/>\n", f);
    free(edges);
    return ISO_OK;
}

static void put_polygon(FILE *f, const iso_mark *mark) {
    fputs("<polygon", f);
    put_color(f, "fill", mark->color);
    fputs(" points=\"", f);
    for (int i = 0; i < mark->point_count; i++)
        fprintf(f, "%s%.6g,%.6g", i ? " " : "", mark->points[i][0], mark->points[i][1]);
    fputs("\"/>\n", f);
}

static void put_text(FILE *f, const iso_mark *mark) {
    fprintf(f, "<text x=\"%.6g\" y=\"%.6g\" font-size=\"%.6g\" textLength=\"%.6g\"%s", mark->x, mark->y,
            mark->size, iso_font_width(mark->text) * mark->size / ISO_FONT_SIZE,
            mark->bold ? " font-weight=\"bold\"" : "");
    put_color(f, "fill", mark->color);
    fputs(">", f);
    put_escaped(f, mark->text);
    fputs("</text>\n", f);
}

static iso_status put_mark(FILE *f, const iso_mark *mark, iso_pool *pool, iso_error *error) {
    const bool lines = mark->kind == ISO_MARK_LINES;
    if (mark->kind == ISO_MARK_PICTURE) return put_picture(f, mark, pool, error);
    if (mark->halo > 0)
        ISO_TRY(put_stroke(f, mark, mark->halo_color, (lines ? mark->width : 0) + 2 * mark->halo, error));
    if (lines) return put_stroke(f, mark, mark->color, mark->width, error);
    (mark->kind == ISO_MARK_TEXT ? put_text : put_polygon)(f, mark);
    return ISO_OK;
}

static iso_status put_drawing(FILE *f, const iso_drawing *d, const iso_sheet *sheet, iso_pool *pool,
                              iso_error *error) {
    const double points = iso_sheet_points(sheet);
    fprintf(f,
            "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<svg xmlns=\"http://www.w3.org/2000/svg\" "
            "xmlns:xlink=\"http://www.w3.org/1999/xlink\" version=\"1.1\" width=\"%.7gpt\" height=\"%.7gpt\" "
            "viewBox=\"0 0 %d %d\">\n",
            sheet->width * points, sheet->height * points, sheet->width, sheet->height);
    if (sheet->title) {
        char *title = iso_text_clean_copy(sheet->title); /* of a file's name, which may hold any bytes */
        fputs("<title>", f);
        put_escaped(f, title ? title : "");
        fputs("</title>\n", f);
        free(title);
    }
    fputs("<g fill=\"none\" stroke-linecap=\"round\" stroke-linejoin=\"round\" xml:space=\"preserve\" "
          "font-family=\"Arial, Helvetica, 'Liberation Sans', sans-serif\" "
          "style=\"font-kerning:none;font-variant-ligatures:none\">\n",
          f);
    for (int i = 0; i < d->count; i++) ISO_TRY(put_mark(f, &d->marks[i], pool, error));
    fputs("</g>\n</svg>\n", f);
    return ISO_OK;
}

iso_status iso_svg_write(const char *path, const iso_drawing *drawing, const iso_sheet *sheet, iso_pool *pool,
                         iso_error *error) {
    iso_sink sink;
    ISO_TRY(iso_drawing_check(drawing, error));
    ISO_TRY(iso_sink_open(path, &sink, error));
    iso_status status = put_drawing(sink.stream, drawing, sheet, pool, error);
    if (status == ISO_OK) status = iso_sink_commit(&sink, error);
    iso_sink_abort(&sink);
    return status;
}
