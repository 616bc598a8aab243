/* span_bounds: recomputes the bounds of spans whose version has changed, in parallel, and decides whether the
 * surface can have a border. */
#include "extract/span_bounds.h"

enum { TASK_SPANS = 256 };

/* The version of a span for which its bounds were computed, and whether the surface may have a border there.
 */
typedef struct bounded_span {
    uint64_t version;
    bool open;
} bounded_span;

void iso_span_bounds_forget(iso_span_bounds *bounds, bool whole) {
    bounds->whole = whole;
    bounds->known = bounds->closed = false;
}

const iso_point_bounds *iso_span_bounds_of(const iso_span_bounds *bounds) {
    return bounds->known ? bounds->bounds.data : NULL;
}

void iso_span_bounds_free(iso_span_bounds *bounds) {
    iso_buffer_free(&bounds->bounds);
    iso_buffer_free(&bounds->bounded);
}

/* Whether the surface may have a border in a span. It ends at the border of the volume and around voxels that
 * are not finite. Where it reaches the volume's border, it has points (edge points as well as foot points)
 * within one voxel of that border. */
static bool may_be_open(const iso_brick_set *set, const int32_t at[3], const iso_point_bounds *bounds) {
    const iso_rgrid *rgrid = set->grid.rgrid;
    const int *dims = iso_brick_set_dims(set);
    for (int axis = 0; axis < 3; axis++) {
        float corner = (float)(at[axis] * ISO_BRICK);
        if (corner + bounds->lo[axis] < 1 || corner + bounds->hi[axis] > (float)(dims[axis] - 2)) return true;
    }
    if (!rgrid || rgrid->type != ISO_FLOAT32 || set->restricted) return false;
    const iso_brick_index *index = rgrid->index;
    if (!index || !iso_brick_index_current(index)) return true;
    for (int corner = 0; corner < 8; corner++) { /* cells of lower neighbours touch the brick's voxels */
        int brick[3];
        for (int axis = 0; axis < 3; axis++) {
            brick[axis] = at[axis] - (corner >> axis & 1);
            if (brick[axis] < 0) brick[axis] = 0;
        }
        if (!iso_brick_index_finite(index, iso_brick_index_number(index, brick))) return true;
    }
    return false;
}

typedef struct search {
    const iso_brick_set *set;
    iso_span_bounds_find *find;
    const void *context;
    iso_point_bounds *bounds;
    bounded_span *bounded;
} search;

static void bound_spans(void *context, size_t index, int worker) {
    (void)worker;
    const search *s = context;
    const uint64_t *versions = iso_brick_set_versions(s->set);
    size_t end = (index + 1) * TASK_SPANS;
    for (size_t i = index * TASK_SPANS; i < end && i < s->set->span_count; i++) {
        if (s->bounded[i].version == versions[i]) continue;
        s->find(s->context, i, &s->bounds[i]);
        /* iso_point_span and iso_mesh_span both begin with their brick */
        const int32_t *brick =
            (const int32_t *)((const char *)s->set->spans.data + i * s->set->kernel.span_bytes);
        s->bounded[i] = (bounded_span){versions[i], may_be_open(s->set, brick, &s->bounds[i])};
    }
}

iso_status iso_span_bounds_update(iso_span_bounds *bounds, const iso_brick_set *set,
                                  iso_span_bounds_find *find, const void *context, iso_error *error) {
    const iso_brick_index *index; /* made up to date for may_be_open: it knows which bricks are finite */
    if (set->grid.rgrid && set->grid.rgrid->type == ISO_FLOAT32 && !set->restricted)
        ISO_TRY(iso_brick_index_of(set->grid.rgrid, set->pool, &index, error));
    size_t count = set->span_count, had = bounds->bounded.bytes / sizeof(bounded_span);
    ISO_TRY(
        iso_buffer_reserve(&bounds->bounds, count * sizeof(iso_point_bounds), bounds->bounds.bytes, error));
    ISO_TRY(iso_buffer_reserve(&bounds->bounded, count * sizeof(bounded_span), bounds->bounded.bytes, error));
    bounded_span *bounded = bounds->bounded.data;
    for (size_t i = had; i < bounds->bounded.bytes / sizeof(bounded_span); i++) bounded[i].version = 0;
    search s = {set, find, context, bounds->bounds.data, bounded};
    iso_parallel_for(set->pool, (count + TASK_SPANS - 1) / TASK_SPANS, bound_spans, &s);
    bounds->known = true;
    bounds->closed = bounds->whole;
    for (size_t i = 0; i < count; i++) bounds->closed &= !bounded[i].open;
    return ISO_OK;
}
