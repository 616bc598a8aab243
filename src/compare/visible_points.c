/* visible_points: draws the numbers of points into pixels (Guennebaud et al. 2004, section 4.2). */
#include "compare/visible_points.h"

#include <math.h>

#include "render/view/project.h"

typedef struct number_picture {
    const iso_view *view;
    const float *depth;
    double tolerance;
    uint32_t *number;
    float *nearest;
    iso_visible_points counts;
} number_picture;

/* Returns the pixel of a point in view space; SIZE_MAX: outside the picture. */
static size_t pixel_of(const iso_projector *projector, iso_vec3 at) {
    const iso_view *view = projector->view;
    if (!(at.z > view->near && at.z < INFINITY)) return SIZE_MAX;
    const double scale = iso_projector_scale(projector, at.z), x = floor(view->cx + scale * at.x),
                 y = floor(view->cy + scale * at.y);
    if (!(x >= 0 && x < view->width && y >= 0 && y < view->height)) return SIZE_MAX;
    return (size_t)y * (size_t)view->width + (size_t)x;
}

static void draw_point(number_picture *p, size_t pixel, double z, size_t index) {
    if (pixel == SIZE_MAX) {
        p->counts.outside++;
    } else if (z > (double)p->depth[pixel] + p->tolerance) {
        p->counts.hidden++;
    } else if (p->number[pixel] && p->nearest[pixel] <= (float)z) {
        p->counts.same_pixel++;
    } else {
        p->counts.same_pixel += p->number[pixel] != 0; /* the one that it takes the place of */
        p->nearest[pixel] = (float)z;
        p->number[pixel] = (uint32_t)(index + 1);
    }
}

iso_visible_points iso_find_visible_points(const iso_point_view *points, const iso_view *view,
                                           const float *depth, double tolerance, uint32_t *number,
                                           float *nearest) {
    const iso_projector projector = iso_projector_make(view, &points->transform);
    const size_t pixels = (size_t)view->width * (size_t)view->height;
    number_picture picture = {view, depth, tolerance, number, nearest, {.points = 0}};
    for (size_t i = 0; i < pixels; i++) number[i] = 0;
    for (size_t s = 0; s < points->span_count; s++) {
        const iso_point_span *span = &points->spans[s];
        picture.counts.points += span->count;
        for (size_t i = span->first; i < span->first + span->count; i++) {
            const iso_surfel surfel = iso_point_view_get(points, i);
            const iso_vec3 at = iso_projector_point(&projector, span->brick, surfel.position);
            draw_point(&picture, pixel_of(&projector, at), at.z, i);
        }
    }
    for (size_t i = 0; i < pixels; i++) picture.counts.seen += number[i] != 0;
    return picture.counts;
}
