/* line_graph: the fragments of lines alone in the base level, as a list with all that pull and push ask of
 * them, and with the neighbours that continue each of them. Going along a line is then a walk from one item
 * of the list to the next. The list takes 128 bytes a fragment, besides the pyramid. Internal to render.
 *
 * It is made in four steps, once all keys are there: count_rows for all rows, reserve once, make_rows for all
 * rows, link_rows for all rows. Rows of a step are independent of each other. */
#ifndef ISO_RENDER_PULLPUSH_LINE_GRAPH_H
#define ISO_RENDER_PULLPUSH_LINE_GRAPH_H

#include <math.h>

#include "render/pullpush/kernel.h"
#include "render/pullpush/lines.h"

/* A symmetric matrix. */
typedef struct iso_line_form {
    double xx, xy, yy;
} iso_line_form;

/* A fragment; what every step along a line reads comes first, in one line of the cache. */
struct iso_line_fragment {
    float x, y; /* its place, pixels of level 0 */
    /* d'Md is less than 1 at a place d beside it in its ellipse; and the square of the distance from there to
     * the nearest place of the line, along the line, pixels^2. */
    iso_line_form ellipse, along;
    uint32_t key; /* its place among the keys */
    /* Bit k is set: the k-th of the eight pixels around, row by row, has a fragment that continues it. */
    uint8_t links;
    bool thin;             /* the ellipse is less than ISO_LINE_THIN pixels of level 0 wide */
    uint16_t line;         /* segment.line of line_fragments.c, modulo 2^16: if they differ, lines do */
    float depth, interval; /* mm */
    int32_t column, row;   /* its pixel of the base level */
    float cosine, sine;    /* of twice the angle of the line's direction in the picture */
    float shape[3];        /* the ellipse's matrix: xx, xy, yy */
    float radius, end;     /* planes RADIUS and ROOM */
    float reach;           /* a radius that holds the ellipse, pixels of level 0 */
    uint32_t color;        /* red, green and blue from the lowest byte on; 0 without the planes */
    float n[3];            /* tangent of a tube, normal of a ribbon: unit, view space */
};

enum { ISO_LINE_THIN = 4 };

/* Whether two fragments that are near each other in the picture continue each other: they are of one line,
 * and near in depth. */
static inline bool iso_line_fragments_follow(const iso_line_fragment *a, const iso_line_fragment *b) {
    const float step = fabsf(a->depth - b->depth);
    return a->line == b->line && (step <= a->interval || step <= b->interval);
}

static inline double iso_line_form_at(const iso_line_form *form, double x, double y) {
    return (form->xx * x + 2 * form->xy * y) * x + form->yy * y * y;
}

/* Counts the fragments of rows of the base level, from an even row on, and notes which pieces have any. */
void iso_line_graph_count_rows(const iso_pyramid *pyramid, iso_rows rows);
/* Makes room for all that were counted. ISO_ERR_NOMEM. */
iso_status iso_line_graph_reserve(iso_pyramid *pyramid, iso_error *error);
/* Makes the fragments of rows from keys and planes, and numbers them in pyramid->index. */
void iso_line_graph_make_rows(const iso_pullpush_params *params, iso_rows rows);
/* Finds the links of the fragments of rows. */
void iso_line_graph_link_rows(const iso_pullpush_params *params, iso_rows rows);

/* iso_draw_pyramid_lines (lines.h) by an engine, which gets linked fragments; NULL: by the cpu.
 * (pullpush.c) */
iso_status iso_draw_pyramid_lines_by(const iso_pyramid_engine *engine, const iso_target *target,
                                     const iso_pyramid_lines *lines, iso_pullpush *workspace,
                                     iso_error *error);

#endif
