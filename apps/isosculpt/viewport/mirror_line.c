/* Marching squares over the samples of a picture: the zero line of their distances to the mirror plane. */
#include "apps/isosculpt/viewport/mirror_line.h"

#include <math.h>

/* STEP: samples from one corner of a square to the next. STEEPEST: a square whose corners differ in depth by
 * more than this many widths shows two surfaces, one in front of the other, and is ignored. */
enum { STEP = 4, STEEPEST = 12 };

/* A corner: its distance from the plane and its depth, mm; NAN: no surface is there. */
typedef struct corner {
    double distance, depth;
} corner;

typedef struct plane {
    const isosculpt_pick_buffer *buffer;
    int axis;
    double at;
} plane;

static corner read_corner(const plane *p, int column, int row) {
    const iso_view *v = &p->buffer->view;
    const iso_gbuffer *g = &p->buffer->gbuffer;
    const size_t i = (size_t)row * (size_t)v->width + (size_t)column;
    if (g->surface[i] == ISO_SURFACE_NONE) return (corner){NAN, NAN};
    iso_vec3 origin, direction;
    iso_view_ray(v, column + 0.5, row + 0.5, &origin, &direction);
    const double depth = (double)g->depth[i];
    const iso_vec3 w = iso_vec3_add(origin, iso_vec3_scale(direction, depth));
    return (corner){(p->axis == 0 ? w.x : p->axis == 1 ? w.y : w.z) - p->at, depth};
}

static bool is_one_surface(const iso_view *view, const corner c[4]) {
    double low = c[0].depth, high = c[0].depth;
    for (int i = 0; i < 4; i++) {
        if (isnan(c[i].depth)) return false;
        low = fmin(low, c[i].depth);
        high = fmax(high, c[i].depth);
    }
    return high - low <= STEEPEST * STEP * (view->orthographic ? 1 : low) / view->focal;
}

/* Finds where the plane crosses the four sides of a square, in order around the square; returns their number.
 * Two crossings make a segment. */
static int find_crossings(const isosculpt_pick_buffer *buffer, const corner c[4], int column, int row,
                          isosculpt_segment *segment) {
    static const int x[] = {0, 1, 1, 0}, y[] = {0, 0, 1, 1};
    int found = 0;
    for (int i = 0; i < 4 && found < 2; i++) {
        const int k = (i + 1) % 4;
        if ((c[i].distance < 0) == (c[k].distance < 0)) continue;
        const double t = c[i].distance / (c[i].distance - c[k].distance);
        segment->x[found] = (column + 0.5 + STEP * (x[i] + t * (x[k] - x[i]))) / buffer->samples;
        segment->y[found++] = (row + 0.5 + STEP * (y[i] + t * (y[k] - y[i]))) / buffer->samples;
    }
    return found;
}

size_t isosculpt_mirror_lines(const isosculpt_pick_buffer *buffer, int axis, double at,
                              isosculpt_segment *segments, size_t room) {
    const plane p = {buffer, axis, at};
    const iso_view *view = &buffer->view;
    size_t count = 0;
    if (buffer->canvas || !(buffer->samples > 0)) return 0;
    for (int row = 0; row + STEP < view->height; row += STEP) {
        corner left[2] = {read_corner(&p, 0, row), read_corner(&p, 0, row + STEP)};
        for (int column = 0; column + STEP < view->width && count < room; column += STEP) {
            const corner right[2] = {read_corner(&p, column + STEP, row),
                                     read_corner(&p, column + STEP, row + STEP)},
                         square[4] = {left[0], right[0], right[1], left[1]};
            if (is_one_surface(view, square))
                count += find_crossings(buffer, square, column, row, &segments[count]) == 2;
            left[0] = right[0];
            left[1] = right[1];
        }
    }
    return count;
}
