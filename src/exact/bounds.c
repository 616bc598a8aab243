/* bounds: the box of the points where the surface crosses the edges of cells. Bricks and octants whose
 * crossed cells lie wholly in the box found so far are skipped, so that the points of only a few octants are
 * computed. */

#include "base/box_items.h"
#include "exact/set.h"

/* Value number `at` of the corner values of an octant (iso_exact_corners), as a float. */
static float corner_value(const iso_exact *exact, const void *corners, size_t at) {
    switch (exact->type) {
    case ISO_UINT8:
        return ((const uint8_t *)corners)[at];
    case ISO_INT16:
        return ((const int16_t *)corners)[at];
    case ISO_UINT16:
        return ((const uint16_t *)corners)[at];
    default:
        return ((const float *)corners)[at];
    }
}

/* Adds to the box the points where the surface crosses the twelve edges of a cell, computed as edge points
 * are (extract/points). value: at the cell's corners; first: index coordinates of its first corner. */
static void add_cell(const iso_threshold *surface, const float value[8], iso_vec3 first,
                     const iso_affine *affine, iso_box *box) {
    for (int corner = 0; corner < 8; corner++)
        for (int axis = 0; axis < 3; axis++) {
            const float low = value[corner], high = value[corner | 1 << axis];
            if (corner >> axis & 1 ||
                iso_threshold_inside(surface, low) == iso_threshold_inside(surface, high))
                continue;
            float t = (surface->isovalue_ceil - low + surface->residual) / (high - low);
            t = t > 0 ? t : 0;
            t = t < 1 ? t : 1;
            double p[3] = {first.x + (corner & 1), first.y + (corner >> 1 & 1), first.z + (corner >> 2)};
            p[axis] += (double)t;
            const iso_vec3 index = iso_vec3_make(p[0], p[1], p[2]);
            iso_box_add(box, affine ? iso_affine_point(affine, index) : index);
        }
}

static void add_octant(const iso_exact *exact, const iso_exact_span *span, const iso_exact_octant *octant,
                       const iso_affine *affine, iso_box *box) {
    const void *corners = iso_exact_corners(exact, span, octant);
    const size_t plane = (size_t)iso_exact_groups(octant->cells) * ISO_EXACT_GROUP;
    size_t cell = 0;
    for (int z = 0; z < ISO_EXACT_SIDE; z++)
        for (uint64_t mask = octant->mask[z]; mask; mask &= mask - 1, cell++) {
            const int position = __builtin_ctzll(mask);
            float value[8];
            for (size_t corner = 0; corner < 8; corner++)
                value[corner] = corner_value(exact, corners, corner * plane + cell);
            const iso_vec3 first =
                iso_vec3_make(ISO_BRICK * (double)span->brick[0] + octant->origin[0] + (position & 7),
                              ISO_BRICK * (double)span->brick[1] + octant->origin[1] + (position >> 3),
                              ISO_BRICK * (double)span->brick[2] + octant->origin[2] + z);
            add_cell(&exact->surface, value, first, affine, box);
        }
}

static iso_box box_of(const iso_exact_span *span, const int first[3], const int end[3]) {
    const int32_t *brick = span->brick;
    const double x = ISO_BRICK * (double)brick[0], y = ISO_BRICK * (double)brick[1],
                 z = ISO_BRICK * (double)brick[2];
    return (iso_box){{x + first[0], y + first[1], z + first[2]}, {x + end[0], y + end[1], z + end[2]}};
}

static iso_box around_octant(const iso_exact_span *span, const iso_exact_octant *octant) {
    int first[3], end[3];
    for (int axis = 0; axis < 3; axis++) {
        first[axis] = octant->origin[axis] + octant->low[axis];
        end[axis] = octant->origin[axis] + octant->high[axis] + 1;
    }
    return box_of(span, first, end);
}

static iso_box around_span(const void *context, size_t item) {
    const iso_exact *exact = context;
    static const int first[3] = {0}, end[3] = {ISO_BRICK, ISO_BRICK, ISO_BRICK};
    const iso_exact_span *span = &iso_exact_spans(exact)[item];
    return span->octants ? box_of(span, first, end) : iso_box_empty();
}

static void add_span(const void *context, size_t item, const iso_affine *affine, iso_box *box) {
    const iso_exact *exact = context;
    const iso_exact_span *span = &iso_exact_spans(exact)[item];
    for (uint32_t b = 0; b < span->octants; b++) {
        const iso_exact_octant *octant = &iso_exact_octants(exact)[span->octant + b];
        const iso_box around = around_octant(span, octant);
        if (!iso_box_contains_mapped(box, &around, affine)) add_octant(exact, span, octant, affine, box);
    }
}

iso_box iso_exact_bounds(const iso_exact *exact, const iso_affine *affine) {
    const iso_box_items spans = {exact, exact->set.span_count, around_span, add_span};
    const double side = exact->opts.cell_side > 0 ? exact->opts.cell_side : 1;
    if (affine && side != 1) {
        iso_affine scaled = *affine;
        for (int i = 0; i < 9; i++) scaled.m[i] *= side;
        return iso_box_of_items(&spans, &scaled);
    }
    iso_box box = iso_box_of_items(&spans, affine);
    if (side == 1 || iso_box_is_empty(&box)) return box;
    return (iso_box){iso_vec3_scale(box.lo, side), iso_vec3_scale(box.hi, side)};
}
