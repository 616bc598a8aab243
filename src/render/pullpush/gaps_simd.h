/* gaps_simd: push, second part: where the discs of a surface end at the border of its grid, and the gaps
 * between discs. pull_push_simd.h describes cells. */
#ifndef ISO_RENDER_PULLPUSH_GAPS_SIMD_H
#define ISO_RENDER_PULLPUSH_GAPS_SIMD_H

#include "base/point_code_simd.h"
#include "base/simd.h"
#include "render/pullpush/kernel.h"
#include "render/shading/phong.h"

/* Of which side of the surface points are drawn: what iso_pullpush_kind means for averages. */
typedef enum pp_sides {
    PP_ONE,
    PP_TWO,
    PP_SETS /* surfaces as PP_TWO, and ribbons, whose normals have no sign, side by side */
} pp_sides;
/* The sides of the variant that is compiled (CMakeLists.txt). */
#ifndef ISO_VARIANT
#define ISO_VARIANT ONE
#endif
#define PP_SIDES ISO_PASTE(PP, ISO_VARIANT)

/* How far ellipses of ribbons reach along the line, in pixels of their level. */
#define PP_REACH 2

/* Index of corner k of the cells from `at` on. */
ISO_INLINE ptrdiff_t corner_index(const iso_pyramid_level *level, size_t at, int k) {
    return (ptrdiff_t)at + ((k & 1) - 1) + ((k >> 1) - 1) * (ptrdiff_t)level->stride;
}

/* How a vector of finer pixels is interpolated ("mixed") from the corners of their cells. */
typedef struct pp_mix {
    vm covered;   /* the finer pixel's centre is inside an ellipse */
    vm made;      /* the finer pixel gets a new value */
    vm around;    /* of surfaces, if not covered: all corners have values that are not WEAK */
    vm weak;      /* of surfaces: the new value is WEAK */
    vf weight[4]; /* of the corners; defined when weigh_corners returned true */
    vf sum;       /* of the weights; 1 where no value is made */
    vf side[4];   /* of normals without sides: -1 where the corner's is reversed, else 1 */
    vf set;       /* with several sets: the set of the corners that are mixed */
    vm foreign;   /* with several sets: the finer pixel has a value of its own, of another set than `set` */
} pp_mix;

/* The values that the finer pixels of a vector of cells have from pull, before push fills them. */
typedef struct pp_finer {
    vf low[4]; /* their depths, of lines and sets where their depth intervals begin; else ISO_NOWHERE */
    vf set[4]; /* with several sets: the sets of their values */
    bool last; /* with several sets: whether this is the last push, into level 0 */
} pp_finer;

/* Where a vector of cells is. */
typedef struct pp_cells {
    const iso_pyramid_level *corners; /* the coarser level, */
    int level;                        /* its number, */
    size_t at;                        /* and the index of the first cell's corner 3 in it */
    int x, y;                         /* of the first cell */
} pp_cells;

/* Whether pixels of a pyramid belong to a surface alone: their discs are planes with a depth at every pixel.
 * Lines and several sets have depth intervals instead. */
ISO_INLINE bool is_surface(const pp_sides sides) {
    return sides == PP_ONE || sides == PP_TWO;
}

/* A level's plane `which`, or `same` where there is none, at index o. */
ISO_INLINE vf plane_or(const iso_pyramid_level *level, const int which, ptrdiff_t o, float same) {
    return level->plane[which] ? v_load(level->plane[which] + o) : v_set(same);
}

/* How far a surface's disc continues in depth, mm, from its centre to its edge. Within the disc depth is
 * linear: at offset d it is the centre's plus this times d.THIN. */
ISO_INLINE vf rise_of(const iso_pullpush_params *params, const iso_pyramid_level *level, ptrdiff_t o) {
    return plane_or(level, ISO_PLANE_RADIUS, o, params->radius);
}

/* How far behind the frontmost disc others are of the same surface, mm. */
ISO_INLINE vf interval_of(const iso_pullpush_params *params, const iso_pyramid_level *level, ptrdiff_t o) {
    if (level->plane[ISO_PLANE_INTERVAL]) return v_load(level->plane[ISO_PLANE_INTERVAL] + o);
    return rise_of(params, level, o);
}

/* ---- the grid's border */

/* The ray of a vector of pixels in index coordinates: at depth z it is at from + z * along. */
typedef struct pp_ray {
    vf from[3], along[3];
} pp_ray;

/* The rays through pixels; column and row: of their centres, in pixels of level 0 from the corner of the
 * whole picture's guard band. */
ISO_INLINE pp_ray index_ray(const iso_pullpush_params *params, vf column, vf row) {
    const float *n = params->normal;
    const float scale = 1 / params->scale;
    const vf x = (column - params->ray[0]) * scale, y = (row - params->ray[1]) * scale;
    pp_ray ray;
    for (int k = 0; k < 3; k++) {
        const vf across = n[k] * x + n[3 + k] * y;
        ray.from[k] = params->eye[k] + (params->orthographic ? across : v_set(0));
        ray.along[k] = n[6 + k] + (params->orthographic ? v_set(0) : across);
    }
    return ray;
}

/* How far inside the grid's border the points of the rays at depth z lie along index axis k, voxels; less
 * than 0 beyond it. */
ISO_INLINE vf room_in_grid(const iso_pullpush_params *params, const pp_ray *ray, vf z, int k) {
    const vf at = ray->from[k] + z * ray->along[k];
    return v_min(at, params->border[k] - at);
}

/* How far beyond its border the grid still counts, because points that lie on the border are rounded: voxels
 * (packed points), and pixels (their places within these). */
#define PP_BORDER_VOXELS 0.005f
#define PP_BORDER_PIXELS 0.02f

/* Whether the points of the rays at depth z lie beyond the grid's border. */
ISO_INLINE vm is_beyond_grid(const iso_pullpush_params *params, const pp_ray *ray, vf z) {
    const vf pixels = params->orthographic ? v_set(PP_BORDER_PIXELS) : z * PP_BORDER_PIXELS;
    vm beyond = v_from_mask(0);
    for (int k = 0; k < 3; k++)
        beyond = v_or(beyond, v_lt(room_in_grid(params, ray, z, k) + PP_BORDER_VOXELS +
                                       pixels * params->voxels_per_pixel[k],
                                   v_set(0)));
    return beyond;
}

/* Takes the pixels out of `inside` whose rays, at the depth z of a disc, are beyond the grid's border, if the
 * disc may reach it (`border`). */
ISO_INLINE vm clip_to_grid(const iso_pullpush_params *params, const pp_ray *ray, vf z, vm border, vm inside) {
    return v_andnot(inside, v_and(border, is_beyond_grid(params, ray, z)));
}

/* Which pixels of a level from index o on have a bit in OUT. */
ISO_INLINE vm has_mark(const iso_pyramid_level *level, ptrdiff_t o, int bit) {
    return v_eqi(v_bits(v_load(level->plane[ISO_PLANE_OUT] + o)) & bit, v_seti(bit));
}

/* Whether a corner's disc may reach the grid's border, for any corner of a vector of cells. */
ISO_INLINE bool are_near_border(const iso_pullpush_params *params, const pp_cells *cells) {
    uint32_t any = 0;
    for (int k = 0; k < 4 && params->has_border; k++)
        any |= v_mask(has_mark(cells->corners, corner_index(cells->corners, cells->at, k), ISO_OUT_BORDER));
    return any != 0;
}

/* The rays through the finer pixels of cells. */
ISO_INLINE void make_cell_rays(const iso_pullpush_params *params, const pp_cells *cells, pp_ray ray[4]) {
    const int finer = cells->level - 1;
    const float size = (float)(1 << finer);
    const int above = params->pyramid->layout.rows_before >> finer;
    for (int s = 0; s < 4; s++) {
        const vf column = v_to_float(v_lanes() * 2 + (2 * cells->x - 1 + (s & 1))) + 0.5f;
        const vf row = v_set((float)(2 * cells->y - 1 + (s >> 1) + above) + 0.5f);
        ray[s] = index_ray(params, column * size, row * size);
    }
}

/* ---- gaps */

/* A finer pixel without a value and outside all ellipses may still be inside the surface: where averaged
 * ellipses do not meet, where a disc is so thin that it passes between the centres of the pixels of a level,
 * and where the front of two surfaces ends inside a pixel, which therefore has no value of the one behind.
 *
 * `Around` it are four corners with values: such a gap is filled from the ellipses of the surface that is
 * farthest away, because it continues behind the others. They are PP_GAP_GROW times as wide there, and
 * rounder: PP_GAP_ROUND of the longer axis' square is added to that of the shorter one. At outlines some
 * corner has no value, so that they do not grow. Before the last push other pixels get values, too, where an
 * ellipse meets the pixel though not its centre. These are WEAK: they do not count as corners around a gap.
 * None of this is in the paper, whose pixels in gaps stay empty. */
#define PP_GAP_GROW 1.4f
#define PP_GAP_ROUND 0.05f

/* An ellipse of a corner that is half a coarser pixel wider: at offset d the form is
 * across * (d.d - t) + along * t, where t = (d.THIN)^2 * per_thin. */
typedef struct pp_widened {
    vf dx, dy, thin_x, thin_y, across, along, per_thin, low, rise;
    vm there, border; /* border: may reach the grid's */
} pp_widened;

ISO_INLINE pp_widened widen_ellipse(const iso_pullpush_params *params, const iso_pyramid_level *c,
                                    ptrdiff_t o, vm around) {
    const vf wide = v_load(c->plane[ISO_PLANE_WIDE] + o);
    pp_widened e = {.dx = v_load(c->plane[ISO_PLANE_DX] + o),
                    .dy = v_load(c->plane[ISO_PLANE_DY] + o),
                    .thin_x = v_load(c->plane[ISO_PLANE_THIN_X] + o),
                    .thin_y = v_load(c->plane[ISO_PLANE_THIN_Y] + o),
                    .low = v_load(c->plane[ISO_PLANE_LOW] + o),
                    .rise = rise_of(params, c, o)};
    const vf square = v_max(e.thin_x * e.thin_x + e.thin_y * e.thin_y, v_set(1e-12f));
    e.there = v_lt(wide, v_set(ISO_NOWHERE));
    e.border = has_mark(c, o, ISO_OUT_BORDER);
    e.across = 1 / (1 / wide + 0.25f);
    const vf round = v_select(around, PP_GAP_ROUND / wide, v_set(0));
    e.along = 1 / (1 / (wide + square) + 0.25f + round);
    e.per_thin = 1 / square;
    return e;
}

/* The weight of a corner at q; 0 outside, and inside never 0, so that the sum of weights is not. */
ISO_INLINE vf weigh(const float g[4], vf q, vm inside) {
    const vf weight = g[0] + q * (g[1] + q * (g[2] + q * g[3]));
    return v_select(inside, v_max(weight, v_set(1e-5f)), v_set(0));
}

/* Finds the weights of the corners for the finer pixels `open`, and marks those that get a value. `ray`: of
 * the finer pixels when any disc is near the grid's border, else NULL. Returns whether any does. */
ISO_INLINE bool fill_gaps(const iso_pullpush_params *params, const pp_cells *cells, const vm open[4],
                          vm around, const pp_ray *ray, pp_mix mix[4], const pp_sides sides) {
    const iso_pyramid_level *c = cells->corners;
    const vf nowhere = v_set(ISO_NOWHERE),
             shrink = v_select(around, v_set(1 / (PP_GAP_GROW * PP_GAP_GROW)), v_set(1));
    vf place[4][4], weight[4][4], best[4], limit[4], front[4][3];
    for (int s = 0; s < 4; s++) best[s] = limit[s] = front[s][0] = front[s][1] = front[s][2] = nowhere;
    for (int k = 0; k < 4; k++) {
        const ptrdiff_t o = corner_index(c, cells->at, k);
        const pp_widened e = widen_ellipse(params, c, o, around);
        const vf behind = interval_of(params, c, o);
        for (int s = 0; s < 4; s++) {
            const vf x = (s & 1 ? 0.25f : -0.25f) + (k & 1 ? -0.5f : 0.5f) - e.dx,
                     y = (s >> 1 ? 0.25f : -0.25f) + (k >> 1 ? -0.5f : 0.5f) - e.dy;
            const vf thin = x * e.thin_x + y * e.thin_y, t = thin * thin * e.per_thin;
            const vf q = (e.across * (x * x + y * y - t) + e.along * t) * shrink, z = e.low + e.rise * thin;
            vm inside = v_and(v_and(e.there, open[s]), v_lt(q, v_set(1)));
            if (ray && cells->level == 1) inside = clip_to_grid(params, &ray[s], z, e.border, inside);
            weight[s][k] = weigh(params->weight, q, inside);
            place[s][k] =
                v_select(inside, v_select(around, -z, z), nowhere); /* least: the one that is taken */
            const vm better = v_lt(place[s][k], best[s]);
            best[s] = v_select(better, place[s][k], best[s]);
            limit[s] = v_select(better, place[s][k] + behind, limit[s]);
            for (int i = 0; i < 3 && sides == PP_TWO; i++)
                front[s][i] = v_select(better, v_load(c->plane[ISO_PLANE_NX + i] + o), front[s][i]);
        }
    }
    uint32_t any = 0;
    for (int s = 0; s < 4; s++) {
        const vm found = v_lt(best[s], nowhere);
        any |= v_mask(found);
        if (!v_mask(found)) continue;
        vf sum = v_set(0);
        for (int k = 0; k < 4; k++) {
            const ptrdiff_t o = corner_index(c, cells->at, k);
            vm joins = v_le(place[s][k], limit[s]);
            if (sides == PP_TWO) {
                vf same = v_set(0);
                for (int i = 0; i < 3; i++) same += front[s][i] * v_load(c->plane[ISO_PLANE_NX + i] + o);
                joins = v_and(joins, v_le(v_set(0), same));
            }
            const vf w = v_select(joins, weight[s][k], v_set(0));
            mix[s].weight[k] = v_select(found, w, mix[s].weight[k]);
            sum += w;
        }
        mix[s].sum = v_select(found, sum, mix[s].sum);
        mix[s].made = v_or(mix[s].made, found);
        mix[s].weak = v_andnot(found, around);
    }
    return any != 0;
}

/* Looks for gaps among the finer pixels of cells, and fills them. */
ISO_INLINE bool look_for_gaps(const iso_pullpush_params *params, const pp_cells *cells, const vf own[4],
                              const pp_ray *ray, pp_mix mix[4], const pp_sides sides) {
    const iso_pyramid_level *c = cells->corners;
    vm around = v_eqi(v_seti(0), v_seti(0)), open[4];
    for (int k = 0; k < 4; k++) {
        const ptrdiff_t o = corner_index(c, cells->at, k);
        const vm there = v_lt(v_load(c->plane[ISO_PLANE_LOW] + o), v_set(ISO_NOWHERE));
        around = v_andnot(v_and(around, there), has_mark(c, o, ISO_OUT_MARK));
    }
    uint32_t any = 0;
    for (int s = 0; s < 4; s++) {
        mix[s].around = around;
        open[s] = v_andnot(v_le(v_set(ISO_NOWHERE), own[s]), mix[s].covered);
        if (cells->level == 1) open[s] = v_and(open[s], around);
        any |= v_mask(open[s]);
    }
    return any && fill_gaps(params, cells, open, around, ray, mix, sides);
}

#endif
