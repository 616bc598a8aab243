/* lod_cut: descends from the spans of the coarsest level to their children until their errors are small
 * enough. */
#include "render/selection/lod_cut.h"

#include <math.h>

#include "render/project.h"

/* What the descent knows. */
typedef struct descent {
    iso_lod_cut *cut;
    const iso_lod *lod;
    double pixels; /* most error */
    iso_projector projector[ISO_LOD_LEVELS];
    double voxel[ISO_LOD_LEVELS]; /* mm: the largest side of a level's voxels */
    iso_point_view level[ISO_LOD_LEVELS];
    iso_error *error;
} descent;

/* Adds a span to the view of its level. */
static iso_status choose_span(const descent *d, int level, size_t span) {
    iso_lod_cut *cut = d->cut;
    const size_t n = cut->view[level].span_count;
    const iso_point_view *from = &d->level[level];
    ISO_TRY(iso_buffer_reserve(&cut->spans[level], (n + 1) * sizeof(iso_point_span),
                               n * sizeof(iso_point_span), d->error));
    ((iso_point_span *)cut->spans[level].data)[n] = from->spans[span];
    if (from->bounds) {
        ISO_TRY(iso_buffer_reserve(&cut->bounds[level], (n + 1) * sizeof(iso_point_bounds),
                                   n * sizeof(iso_point_bounds), d->error));
        ((iso_point_bounds *)cut->bounds[level].data)[n] = from->bounds[span];
    }
    cut->view[level].span_count++;
    cut->points[level] += from->spans[span].count;
    return ISO_OK;
}

/* The least depth of a span's points, mm. */
static double nearest_depth(const iso_projector *projector, const iso_point_span *span,
                            const iso_point_bounds *bounds) {
    const double *m = projector->matrix + 6;
    double depth = projector->origin[2];
    for (int k = 0; k < 3; k++) {
        const double corner = span->brick[k] * (double)ISO_BRICK, lo = corner + (double)bounds->lo[k],
                     hi = corner + (double)bounds->hi[k];
        depth += iso_min(m[k] * lo, m[k] * hi);
    }
    return depth;
}

/* Whether the error of a span of a level above 0 is small enough. */
static bool is_fine_enough(const descent *d, int level, size_t span) {
    const iso_projector *projector = &d->projector[level];
    const iso_view *view = projector->view;
    const double depth =
        nearest_depth(projector, &d->level[level].spans[span], &d->level[level].bounds[span]);
    if (!view->orthographic && !(depth >= view->near && depth > 0)) return false;
    return d->voxel[level] * (double)d->lod->level[level].errors[span] *
               iso_projector_scale(projector, depth) <=
           d->pixels;
}

static iso_status descend(const descent *d, int level, size_t span) {
    if (level == 0 || is_fine_enough(d, level, span)) return choose_span(d, level, span);
    const uint32_t *first = d->lod->level[level].first_child + span;
    for (uint32_t child = first[0]; child < first[1]; child++)
        ISO_TRY(descend(d, level - 1, iso_lod_child(d->lod, level, child)));
    return ISO_OK;
}

iso_status iso_lod_cut_make(iso_lod_cut *cut, const iso_lod *lod, const iso_view *view, double pixels,
                            iso_error *error) {
    descent d = {.cut = cut, .lod = lod, .pixels = pixels, .error = error};
    cut->levels = lod->count;
    for (int k = 0; k < lod->count; k++) {
        cut->view[k] = d.level[k] = iso_lod_view(lod, k);
        cut->view[k].span_count = cut->points[k] = 0;
        d.projector[k] = iso_projector_make(view, &d.level[k].transform);
        const double *side = d.level[k].transform.spacing;
        d.voxel[k] = iso_max(side[0], iso_max(side[1], side[2]));
    }
    const int top = lod->count - 1;
    for (size_t s = 0; s < d.level[top].span_count; s++) ISO_TRY(descend(&d, top, s));
    for (int k = 0; k < lod->count; k++) {
        cut->view[k].spans = cut->spans[k].data;
        cut->view[k].bounds = d.level[k].bounds ? cut->bounds[k].data : NULL;
        cut->view[k].versions = NULL;
    }
    return ISO_OK;
}

void iso_lod_cut_free(iso_lod_cut *cut) {
    for (int k = 0; k < ISO_LOD_LEVELS; k++) {
        iso_buffer_free(&cut->spans[k]);
        iso_buffer_free(&cut->bounds[k]);
    }
    *cut = (iso_lod_cut){0};
}
