/* bounds: the box of the points where the surface crosses the edges of cells. Octants whose crossed cells lie
 * wholly in the box found so far are skipped, so that the points of only a few octants are computed. */
#include <math.h>

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

static bool contains(const iso_box *box, const iso_box *other) {
    return box->lo.x <= other->lo.x && box->lo.y <= other->lo.y && box->lo.z <= other->lo.z &&
           box->hi.x >= other->hi.x && box->hi.y >= other->hi.y && box->hi.z >= other->hi.z;
}

iso_box iso_exact_bounds(const iso_exact *exact, const iso_affine *affine) {
    iso_box box = iso_box_empty();
    for (size_t s = 0; s < exact->set.span_count; s++) {
        const iso_exact_span *span = &iso_exact_spans(exact)[s];
        for (uint32_t b = 0; b < span->octants; b++) {
            const iso_exact_octant *octant = &iso_exact_octants(exact)[span->octant + b];
            double low[3], high[3];
            for (int axis = 0; axis < 3; axis++) {
                const double first = ISO_BRICK * (double)span->brick[axis] + octant->origin[axis];
                low[axis] = first + octant->low[axis];
                high[axis] = first + octant->high[axis] + 1;
            }
            iso_box most = {{low[0], low[1], low[2]}, {high[0], high[1], high[2]}};
            if (affine) most = iso_box_transform(&most, affine);
            if (!contains(&box, &most)) add_octant(exact, span, octant, affine, &box);
        }
    }
    return box;
}
