/* lod_cut: descends from the spans of the coarsest level to their children until their errors are small
 * enough. */
#include "render/selection/lod_cut.h"

#include <math.h>
#include <string.h>

#include "render/view/project.h"

/* A span whose parent, one level coarser, has been found not to be fine enough. */
typedef struct span_place {
    int level;
    size_t span;
    double pixels; /* the parent's error; INFINITY: there is no parent */
    const uint8_t (
        *parent_colors)[3]; /* for each of the span's points, that of the point of the parent that stands
                                          for it; NULL: points have no colours, or there is no parent */
} span_place;

/* How the colours of a chosen span are made. */
typedef struct color_blend {
    const uint8_t (*parent_colors)[3];
    uint32_t share; /* of the parent's colours, of BLEND_WHOLE */
} color_blend;

enum { BLEND_BITS = 8, BLEND_WHOLE = 1 << BLEND_BITS };

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

/* The share of the parent in a span with the error `own`, of BLEND_WHOLE: 0 when that has just become small
 * enough, all when the parent's is about to. Where errors differ by 2, `way` grows linearly with the
 * distance. */
static uint32_t share_of_parent(const descent *d, const span_place *at, double own) {
    if (!at->parent_colors || !(d->pixels > 0) || !isfinite(at->pixels)) return 0;
    const double inside = iso_max(d->pixels - own, 0), outside = iso_max(at->pixels - d->pixels, 0);
    const double way = inside > 0 ? inside / (inside + outside) : 0;
    return (uint32_t)(BLEND_WHOLE * way * way + 0.5);
}

/* Adds a span to the view of its level. `own`: its error in pixels. */
static iso_status choose_span(const descent *d, const span_place *at, double own) {
    iso_lod_cut *cut = d->cut;
    const int level = at->level;
    const size_t span = at->span;
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
    if (from->colors) {
        ISO_TRY(iso_buffer_reserve(&cut->blends[level], (n + 1) * sizeof(color_blend),
                                   n * sizeof(color_blend), d->error));
        ((color_blend *)cut->blends[level].data)[n] =
            (color_blend){at->parent_colors, share_of_parent(d, at, own)};
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

/* The error of a span of a level above 0 in pixels, at its nearest depth; INFINITY: it may be too near to
 * be seen. */
static double error_of(const descent *d, int level, size_t span) {
    const iso_projector *projector = &d->projector[level];
    const iso_view *view = projector->view;
    const double depth =
        nearest_depth(projector, &d->level[level].spans[span], &d->level[level].bounds[span]);
    if (!view->orthographic && !(depth >= view->near && depth > 0)) return INFINITY;
    return d->voxel[level] * (double)d->lod->level[level].errors[span] *
           iso_projector_scale(projector, depth);
}

static iso_status descend(const descent *d, const span_place *at) {
    /* points of level 0 have no error; half their parent's is what one level less has */
    const double own = at->level ? error_of(d, at->level, at->span) : iso_min(at->pixels / 2, d->pixels);
    if (at->level == 0 || own <= d->pixels) return choose_span(d, at, own);
    const iso_lod_level *level = &d->lod->level[at->level];
    span_place below = {.level = at->level - 1, .pixels = own};
    if (level->colors_below)
        below.parent_colors = (const uint8_t(*)[3])level->colors_below + level->first_color_below[at->span];
    for (uint32_t child = level->first_child[at->span]; child < level->first_child[at->span + 1]; child++) {
        below.span = iso_lod_child(d->lod, at->level, child);
        ISO_TRY(descend(d, &below));
        if (below.parent_colors) below.parent_colors += d->level[below.level].spans[below.span].count;
    }
    return ISO_OK;
}

/* ---- colours */

/* A level whose chosen spans get colours. */
typedef struct coloring {
    const iso_point_span *spans;
    const color_blend *blends;
    const uint8_t (*from)[3];
    uint8_t (*to)[3];
} coloring;

/* Task: colours the points of a span. */
static void color_span(void *context, size_t number, int worker) {
    (void)worker;
    const coloring *c = context;
    const iso_point_span *span = &c->spans[number];
    const color_blend *blend = &c->blends[number];
    const uint8_t *own = c->from[span->first];
    uint8_t *to = c->to[span->first];
    const size_t count = 3 * (size_t)span->count;
    if (!blend->share) {
        memcpy(to, own, count);
        return;
    }
    const uint8_t *parent = blend->parent_colors[0];
    const uint32_t share = blend->share, rest = BLEND_WHOLE - share;
    for (size_t i = 0; i < count; i++)
        to[i] = (uint8_t)((own[i] * rest + parent[i] * share + BLEND_WHOLE / 2) >> BLEND_BITS);
}

/* Enlarges the discs of a level's chosen spans towards those of the next one; discs of radii of their own
 * are left. */
static iso_status scale_spans(const descent *d, int level) {
    iso_lod_cut *cut = d->cut;
    iso_point_view *view = &cut->view[level];
    const color_blend *blends = cut->blends[level].data;
    if (view->radii || !(view->radius > 0) || level + 1 >= d->lod->count) return ISO_OK;
    ISO_TRY(iso_buffer_reserve(&cut->scales[level], view->span_count * sizeof(float), 0, d->error));
    float *scales = cut->scales[level].data;
    const double more = d->level[level + 1].radius / view->radius - 1;
    for (size_t s = 0; s < view->span_count; s++)
        scales[s] = (float)(1 + more * blends[s].share / BLEND_WHOLE);
    view->span_scales = scales;
    return ISO_OK;
}

/* Makes the colours of the spans that are chosen of a level, if some are between it and the next one. */
static iso_status color_level(const descent *d, int level, iso_pool *pool) {
    iso_lod_cut *cut = d->cut;
    iso_point_view *view = &cut->view[level];
    const color_blend *blends = cut->blends[level].data;
    bool blended = false;
    size_t end = 0;
    if (!view->colors) return ISO_OK;
    for (size_t s = 0; s < view->span_count; s++) {
        const size_t last = view->spans[s].first + view->spans[s].count;
        blended |= blends[s].share > 0;
        end = last > end ? last : end;
    }
    if (!blended) return ISO_OK;
    ISO_TRY(iso_buffer_reserve(&cut->colors[level], end * sizeof *view->colors, 0, d->error));
    coloring c = {view->spans, blends, view->colors, cut->colors[level].data};
    iso_parallel_for(pool, view->span_count, color_span, &c);
    view->colors = (const uint8_t(*)[3])c.to;
    return scale_spans(d, level);
}

iso_status iso_lod_cut_make(iso_lod_cut *cut, const iso_lod *lod, const iso_view *view, double pixels,
                            iso_pool *pool, iso_error *error) {
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
    for (size_t s = 0; s < d.level[top].span_count; s++)
        ISO_TRY(descend(&d, &(span_place){.level = top, .span = s, .pixels = INFINITY}));
    for (int k = 0; k < lod->count; k++) {
        cut->view[k].spans = cut->spans[k].data;
        cut->view[k].bounds = d.level[k].bounds ? cut->bounds[k].data : NULL;
        cut->view[k].versions = NULL;
        ISO_TRY(color_level(&d, k, pool));
    }
    return ISO_OK;
}

void iso_lod_cut_free(iso_lod_cut *cut) {
    for (int k = 0; k < ISO_LOD_LEVELS; k++) {
        iso_buffer_free(&cut->spans[k]);
        iso_buffer_free(&cut->bounds[k]);
        iso_buffer_free(&cut->colors[k]);
        iso_buffer_free(&cut->blends[k]);
        iso_buffer_free(&cut->scales[k]);
    }
    *cut = (iso_lod_cut){0};
}
