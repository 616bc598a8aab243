/* finish_simd: the last push, from level 1 into the gbuffer, by cells as in pull_push_simd.h (Marroquim,
 * Kraus and Cavalcanti 2008, section 3.2). Nothing is pushed into planes of level 0: a sample is either
 * interpolated ("mixed") from the corners of its cell, or it is the point that was projected to its pixel. */
#ifndef ISO_RENDER_PULLPUSH_FINISH_SIMD_H
#define ISO_RENDER_PULLPUSH_FINISH_SIMD_H

#include "render/pullpush/pull_push_simd.h"

/* A vector of samples to be written into the gbuffer; depth is ISO_NOWHERE where there is none. */
typedef struct pp_sample {
    vf depth, normal[3];
    vi color;   /* as in iso_gbuffer.color */
    vi surface; /* of several sets: the surface numbers */
} pp_sample;

/* The points that were projected to a vector of pixels of level 0: every second pixel of a row. */
typedef struct pp_own {
    vf depth; /* ISO_NOWHERE where there is no point */
    vi payload;
    int column, row; /* of the first pixel */
    size_t at;       /* index in level 0's planes of the row's two vectors, */
    int side;        /* of which these pixels have even (0) or odd (1) number */
} pp_own;

/* Sets the colours of samples: those mixed from the corners, or those of their own points. Their surfaces'
 * numbers are in `color`. */
ISO_INLINE void set_colors(const iso_pullpush_params *params, size_t at, const pp_own own[4],
                           const pp_mix mix[4], pp_sample sample[4]) {
    const iso_pyramid_level *c = &params->pyramid->level[1];
    for (int k = 0; k < 3; k++) {
        const float *points = (c - 1)->plane[ISO_PLANE_RED + k];
        vf value[4];
        mix_plane(c, ISO_PLANE_RED + k, at, mix, value);
        for (int s = 0; s < 4; s++) {
            value[s] = value[s] / mix[s].sum;
            if (points) value[s] = v_select(mix[s].made, value[s], every_second(points + own[s].at, s & 1));
            sample[s].color |= v_trunc(value[s] + 0.5f) << 8 * k;
        }
    }
}

/* ---- support: points whose discs contain a sample */

/* Points farther away than this from a sample do not support it, columns and rows of the base level. */
#define PP_SUPPORT_REACH 16.0f
/* Discs support samples within this many of their radii. */
#define PP_SUPPORT_GROW 1.1f
/* Samples are not tested where discs have smaller radii, pixels: the points that would support them may have
 * lost their pixels to nearer ones. */
#define PP_SUPPORT_RADIUS 1.0f

/* A sample: its centre, pixels of level 0 from the corner of the whole picture's guard band; its ray. */
typedef struct pp_sight {
    float column, row, slope[2], ray_z;
} pp_sight;

/* The sight of the sample in a column and row of level 0. */
ISO_INLINE pp_sight make_sight(const iso_pullpush_params *params, int column, int row) {
    pp_sight sight = {.column = (float)column + 0.5f,
                      .row = (float)row + 0.5f + (float)params->pyramid->layout.rows_before};
    sight.slope[0] = (sight.column - params->ray[0]) * params->slope;
    sight.slope[1] = (sight.row - params->ray[1]) * params->slope;
    sight.ray_z = 1 / sqrtf(sight.slope[0] * sight.slope[0] + sight.slope[1] * sight.slope[1] + 1);
    return sight;
}

/* The radii of the discs of a vector of points, mm; `place`: of the first one's key. Not those of the base
 * level's planes, which push changes. */
ISO_INLINE vf radii_of_keys(const iso_pullpush_params *params, size_t place, vm there) {
    if (!params->radii) return v_set(params->radius);
    float radius[ISO_LANES] = {0};
    for (uint32_t left = v_mask(there); left; left &= left - 1) {
        const int i = __builtin_ctz(left);
        radius[i] = ISO_DISC_RADII * params->radii[params->pyramid->index[place + (size_t)i]];
    }
    return v_max(v_load(radius), v_set(0));
}

/* A vector of points as a sample's ray sees them. */
typedef struct pp_points {
    vm there;
    vf depth, normal[3]; /* view space */
    vf along, turned[2]; /* the normals, rotated as the ray must be to lie on the z axis */
    vf offset[2];        /* from the sample to the points, pixels of level 0 */
    vf radius;           /* of the discs, mm */
    vf pixel;            /* the size of a pixel of level 0 at the points' depths, mm */
} pp_points;

/* The points of the keys from column x of row y of the base level on, up to column `last`. Returns whether
 * there is any; if not, the rest is undefined. */
ISO_INLINE bool see_points(const iso_pullpush_params *params, const pp_sight *sight, int x, int y, int last,
                           pp_points *out) {
    const iso_pyramid *p = params->pyramid;
    const size_t place = (size_t)y * p->key_stride + (size_t)x;
    const float size = (float)(1 << p->layout.base),
                above = (float)(y + (p->layout.rows_before >> p->layout.base));
    vf folded[3];
    vi payload;
    split_keys(p->keys + place, &out->depth, &payload);
    out->there = v_andnot(v_lt(out->depth, v_set(ISO_NOWHERE)), v_lti(v_seti(last), v_lanes() + x));
    if (!v_mask(out->there)) return false;
    unfold_normals(payload, folded);
    transform_normals(params, folded, out->normal);
    const vf *n = out->normal;
    out->along = (n[0] * sight->slope[0] + n[1] * sight->slope[1] + n[2]) * sight->ray_z;
    const vf turn = (out->along + n[2]) * (sight->ray_z / (1 + sight->ray_z));
    for (int i = 0; i < 2; i++) out->turned[i] = n[i] - turn * sight->slope[i];
    out->offset[0] =
        (v_to_float(v_lanes() + x) + v_to_float(payload >> 22 & 31) * (1.0f / 32) + 1.0f / 64) * size -
        sight->column;
    out->offset[1] = (v_to_float(payload >> 27 & 31) * (1.0f / 32) + (1.0f / 64 + above)) * size - sight->row;
    out->radius = radii_of_keys(params, place, out->there);
    out->pixel = v_set(1 / params->scale);
    if (!params->orthographic) out->pixel = out->pixel * out->depth;
    return true;
}

/* Takes points out of `inside` whose discs, at depth z of the sample's ray, are beyond the grid's border. */
ISO_INLINE vm clip_points(const iso_pullpush_params *params, const pp_sight *sight, vf z, vm inside) {
    if (!v_mask(inside) || !params->has_border) return inside;
    const pp_ray ray = index_ray(params, v_set(sight->column), v_set(sight->row));
    return v_andnot(inside, is_beyond_grid(params, &ray, z));
}

/* Whether the ellipse of any of a vector of points contains a sample: that of project_disc in
 * ellipses_simd.h, with its limit OUT towards the silhouette. */
ISO_INLINE bool contain_sample(const iso_pullpush_params *params, const pp_sight *sight, int x, int y,
                               int last) {
    pp_points p;
    if (!see_points(params, sight, x, y, last, &p)) return false;
    const vf *m = p.turned, *d = p.offset, length = PP_SUPPORT_GROW * p.radius;
    vf radius = length * params->scale;
    if (!params->orthographic) radius = radius / p.depth;
    const vf flat = m[0] * m[0] + m[1] * m[1], square = v_max(flat + p.along * p.along, v_set(1e-12f)),
             b = radius * radius, a = b + params->low_pass, e = a * square - b * flat,
             out = d[0] * m[0] + d[1] * m[1];
    const vm silhouette = v_lt(v_set(0), out * p.along),
             beyond = v_lt(flat * ((b + params->facing) * p.along * p.along + params->edge * flat),
                           out * out * square);
    const vm inside = v_andnot(v_and(p.there, v_lt((d[0] * d[0] + d[1] * d[1]) * e + b * (out * out), a * e)),
                               v_and(silhouette, beyond));
    const vf rise = length * v_sqrt(b / (a * e)) * out,
             z = p.depth + v_select(v_lt(p.along, v_set(0)), -rise, rise);
    return v_mask(clip_points(params, sight, z, inside)) != 0;
}

/* The pixels of the base level, 0 .. count - 1, that lie between two places, pixels of level 0. */
ISO_INLINE iso_rows pixels_between(float from, float to, float size, int count) {
    const int first = (int)floorf(from / size), last = (int)floorf(to / size);
    return (iso_rows){first > 0 ? first : 0, last < count ? last : count - 1};
}

/* Whether a point supports the sample in a column and row of level 0. `reach`: how far away it may be, pixels
 * of level 0. Not inlined: it is seldom called. */
static __attribute__((noinline)) bool is_supported(const iso_pullpush_params *params, int column, int row,
                                                   float reach) {
    const iso_pyramid *p = params->pyramid;
    const iso_pyramid_level *base = &p->level[p->layout.base];
    const float size = (float)(1 << p->layout.base), x = (float)column + 0.5f, y = (float)row + 0.5f;
    const iso_rows rows = pixels_between(y - reach, y + reach, size, base->height),
                   columns = pixels_between(x - reach, x + reach, size, base->width);
    const pp_sight sight = make_sight(params, column, row);
    for (int i = rows.first; i <= rows.last; i++)
        for (int k = columns.first; k <= columns.last; k += ISO_LANES)
            if (contain_sample(params, &sight, k, i, columns.last)) return true;
    return false;
}

/* How far from samples the points are looked for that support them, pixels of level 0; `radius`: of discs,
 * mm, at depth `depth`. *large: where it is asked. */
ISO_INLINE vf support_reach(const iso_pullpush_params *params, vf radius, vf depth, vm *large) {
    const float most = PP_SUPPORT_REACH * (float)(1 << params->pyramid->layout.base);
    vf widest = radius * (PP_SUPPORT_GROW * params->scale);
    if (!params->orthographic) widest = widest / depth;
    *large = v_le(v_set(PP_SUPPORT_RADIUS), widest);
    return v_min(v_sqrt(widest * widest + params->low_pass), v_set(most));
}

/* Which samples of `asked` lie in the picture and no point supports. */
ISO_INLINE vm find_unsupported(const iso_pullpush_params *params, const pp_own *own, vf reach, vm asked) {
    const iso_pyramid_layout *layout = &params->pyramid->layout;
    const int guard = -layout->column, end = guard + params->target->gbuffer->width;
    float reaches[ISO_LANES];
    uint32_t open = 0;
    v_store(reaches, reach);
    for (uint32_t left = v_mask(asked); left; left &= left - 1) {
        const int i = __builtin_ctz(left), column = own->column + 2 * i;
        if (column < guard || column >= end) continue;
        if (!is_supported(params, column, own->row - layout->rows_before, reaches[i])) open |= 1u << i;
    }
    return v_from_mask(open);
}

/* ---- rims */

/* Pull and push lose discs: at outlines, whose pixels are averaged with those within, and behind nearer discs
 * in the same coarser pixel. A sample that gets no value beside pixels that have some (a rim) therefore shows
 * the nearest of the points whose discs it meets, within PP_RIM_PART of their radii: the whole discs would
 * overlap outlines that curve. Points are looked for up to PP_RIM_REACH columns and rows of the base level
 * away, and only where discs have radii of PP_SUPPORT_RADIUS. None of this is in the paper. */
#define PP_RIM_PART 0.7f
#define PP_RIM_REACH 6.0f

/* The nearest disc that a sample meets: depth, ISO_NOWHERE if there is none; normal, not unit; place of the
 * point's key. */
typedef struct pp_rim {
    float depth, normal[3];
    size_t place;
} pp_rim;

/* Takes the nearest of a vector of points whose discs the sample meets, if it is nearer than *out. */
ISO_INLINE void meet_discs(const iso_pullpush_params *params, const pp_sight *sight, int x, int y, int last,
                           pp_rim *out) {
    pp_points p;
    if (!see_points(params, sight, x, y, last, &p)) return;
    const vf *m = p.turned, *d = p.offset, radius = PP_RIM_PART * p.radius / p.pixel,
             steep = p.along * p.along, outward = d[0] * m[0] + d[1] * m[1],
             z = p.depth + p.pixel * outward / p.along;
    vm inside = v_and(p.there,
                      v_lt((d[0] * d[0] + d[1] * d[1]) * steep + outward * outward, radius * radius * steep));
    inside = v_and(clip_points(params, sight, z, inside), v_lt(z, v_set(out->depth)));
    if (!v_mask(inside)) return;
    float depth[ISO_LANES], normal[3][ISO_LANES];
    v_store(depth, z);
    for (int k = 0; k < 3; k++) v_store(normal[k], p.normal[k]);
    for (uint32_t left = v_mask(inside); left; left &= left - 1) {
        const int i = __builtin_ctz(left);
        if (!(depth[i] < out->depth)) continue;
        *out = (pp_rim){depth[i],
                        {normal[0][i], normal[1][i], normal[2][i]},
                        (size_t)y * params->pyramid->key_stride + (size_t)(x + i)};
    }
}

/* Finds what the sample in a column and row of level 0 meets. Not inlined: it is seldom called. */
static __attribute__((noinline)) pp_rim find_rim(const iso_pullpush_params *params, int column, int row,
                                                 float reach) {
    const iso_pyramid *p = params->pyramid;
    const iso_pyramid_level *base = &p->level[p->layout.base];
    const float size = (float)(1 << p->layout.base), x = (float)column + 0.5f, y = (float)row + 0.5f;
    const iso_rows rows = pixels_between(y - reach, y + reach, size, base->height),
                   columns = pixels_between(x - reach, x + reach, size, base->width);
    const pp_sight sight = make_sight(params, column, row);
    pp_rim out = {.depth = ISO_NOWHERE};
    for (int i = rows.first; i <= rows.last; i++)
        for (int k = columns.first; k <= columns.last; k += ISO_LANES)
            meet_discs(params, &sight, k, i, columns.last, &out);
    return out;
}

/* Gives the samples `open` of a vector what they meet. */
ISO_INLINE void fill_rims(const iso_pullpush_params *params, const pp_own *own, vf reach, vm open,
                          pp_sample *sample) {
    const iso_pyramid_layout *layout = &params->pyramid->layout;
    const int guard = -layout->column, end = guard + params->target->gbuffer->width;
    float reaches[ISO_LANES], depth[ISO_LANES], normal[3][ISO_LANES];
    int32_t color[ISO_LANES];
    v_store(reaches, reach);
    v_store(depth, sample->depth);
    v_storei(color, sample->color);
    for (int k = 0; k < 3; k++) v_store(normal[k], sample->normal[k]);
    for (uint32_t left = v_mask(open); left; left &= left - 1) {
        const int i = __builtin_ctz(left), column = own->column + 2 * i;
        if (column < guard || column >= end) continue;
        const pp_rim rim = find_rim(params, column, own->row - layout->rows_before, reaches[i]);
        if (!(rim.depth < ISO_NOWHERE)) continue;
        const float *n = rim.normal, length = 1 / sqrtf(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
        depth[i] = rim.depth;
        for (int k = 0; k < 3; k++) normal[k][i] = n[k] * length;
        if (!params->colors) continue;
        const uint8_t *point = params->colors[params->pyramid->index[rim.place]];
        color[i] = (int32_t)((uint32_t)(params->target->surface + 1) << 24 | (uint32_t)point[2] << 16 |
                             (uint32_t)point[1] << 8 | point[0]);
    }
    sample->depth = v_load(depth);
    sample->color = v_loadi(color);
    for (int k = 0; k < 3; k++) sample->normal[k] = v_load(normal[k]);
}

/* Looks for rims among the samples of a vector of cells. */
ISO_INLINE void look_for_rims(const iso_pullpush_params *params, const pp_cells *cells, const bool within[2],
                              const pp_own own[4], pp_sample sample[4]) {
    vf nearest = v_set(ISO_NOWHERE), widest = v_set(0);
    uint32_t any = 0;
    for (int s = 0; s < 4; s++)
        if (within[s >> 1]) any |= v_mask(v_le(v_set(ISO_NOWHERE), sample[s].depth));
    if (!any) return;
    for (int k = 0; k < 4; k++) {
        const ptrdiff_t o = corner_index(cells->corners, cells->at, k);
        const vf low = v_load(cells->corners->plane[ISO_PLANE_LOW] + o);
        const vm there = v_lt(low, v_set(ISO_NOWHERE));
        nearest = v_min(nearest, low);
        widest = v_max(widest, v_select(there, rise_of(params, cells->corners, o), v_set(0)));
    }
    vf radius = widest * params->scale;
    if (!params->orthographic) radius = radius / nearest;
    const vm large = v_le(v_set(PP_SUPPORT_RADIUS), radius);
    const vf most = v_set(PP_RIM_REACH * (float)(1 << params->pyramid->layout.base)),
             reach = v_min(PP_RIM_PART * radius, most);
    for (int s = 0; s < 4; s++) {
        const vm open = v_and(large, v_le(v_set(ISO_NOWHERE), sample[s].depth));
        if (within[s >> 1] && v_mask(open)) fill_rims(params, &own[s], reach, open, &sample[s]);
    }
}

/* ---- points of pixels */

/* Whether a pixel's centre lies outside its own point's disc on the side of the silhouette: the condition
 * d.THIN > OUT of the point's ellipse, evaluated without making the ellipse. Of a surface alone, also where
 * the disc is beyond the grid's border. `n`: the point's normal. */
ISO_INLINE vm is_beyond_disc(const iso_pullpush_params *params, const pp_own *own, const vf n[3]) {
    const float *radii = params->pyramid->level[0].plane[ISO_PLANE_RADIUS];
    vf radius = radii ? every_second(radii + own->at, own->side) : v_set(params->radius);
    vf column = v_to_float(v_lanes() * 2 + own->column) + 0.5f;
    vf ray_x = (column - params->ray[0]) * params->slope;
    vf ray_y = v_set(((float)own->row + 0.5f - params->ray[1]) * params->slope);
    vf away_x = 31.0f / 64 - v_to_float(own->payload >> 22 & 31) * (1.0f / 32);
    vf away_y = 31.0f / 64 - v_to_float(own->payload >> 27 & 31) * (1.0f / 32);
    vf along = n[0] * ray_x + n[1] * ray_y + n[2], out = n[0] * away_x + n[1] * away_y;
    vf square = (n[0] * n[0] + n[1] * n[1] + n[2] * n[2]) * (ray_x * ray_x + ray_y * ray_y + 1);
    vf size = radius * params->scale;
    if (!params->orthographic) size = size / own->depth;
    vf reach = (size * size + params->facing) * (along * along) + params->edge * square;
    const vm outward = v_lt(out * along, v_set(0)),
             beyond = v_and(outward, v_lt(reach, out * out * (ray_x * ray_x + ray_y * ray_y + 1)));
    if (!params->has_border) return beyond;
    const pp_ray ray = index_ray(params, column, v_set((float)own->row + 0.5f));
    vf pixel = v_set(1 / params->scale);
    if (!params->orthographic) pixel = pixel * own->depth;
    /* the disc's plane at the pixel's centre, no further than the disc reaches */
    const vf steep = v_select(v_lt(v_abs(along), v_set(1e-6f)), v_set(1e-6f), along),
             z = own->depth + v_max(-radius, v_min(radius, -out * pixel / steep));
    return v_or(beyond, is_beyond_grid(params, &ray, z));
}

/* Takes those out of `beyond` that are `around` and that points support, or whose discs are too small to
 * ask. */
ISO_INLINE vm leave_supported(const iso_pullpush_params *params, const pp_own *own, vm around, vm beyond) {
    const float *radii = params->pyramid->level[0].plane[ISO_PLANE_RADIUS];
    const vf radius = radii ? every_second(radii + own->at, own->side) : v_set(params->radius);
    const vm asked = v_and(beyond, around);
    vm large;
    if (!v_mask(asked)) return beyond;
    const vf reach = support_reach(params, radius, own->depth, &large);
    return v_or(v_andnot(beyond, around), find_unsupported(params, own, reach, v_and(asked, large)));
}

/* Completes a vector of samples. `normal` and `depth` are the weighted sums of the mixture. A pixel's own
 * point is drawn where no mixture replaces it, except at silhouettes: where no ellipse covers the pixel
 * and its centre lies beyond the point's disc. If, of a surface alone, all corners have values, which is so
 * at outlines before a surface behind, too, only where no other point's disc contains the centre. */
ISO_INLINE void complete_samples(const iso_pullpush_params *params, const pp_own *own, const pp_mix *mix,
                                 const vf normal[3], vf depth, pp_sample *out, const pp_sides sides) {
    vf n[3], kept[3], there = own->depth;
    unfold_normals(own->payload, n);
    transform_normals(params, n, kept);
    for (int k = 0; k < 3; k++) out->normal[k] = v_select(mix->made, normal[k], kept[k]);
    const vm alone = v_andnot(v_lt(own->depth, v_set(ISO_NOWHERE)), mix->covered);
    if (v_mask(alone)) {
        vm beyond = v_and(alone, is_beyond_disc(params, own, kept));
        if (is_surface(sides)) beyond = leave_supported(params, own, mix->around, beyond);
        there = v_select(beyond, v_set(ISO_NOWHERE), there);
    }
    vf square =
        out->normal[0] * out->normal[0] + out->normal[1] * out->normal[1] + out->normal[2] * out->normal[2];
    vm none = v_le(square, v_set(1e-20f));
    vf length = v_sqrt(v_select(none, v_set(1), square)), both = 1 / (length * mix->sum);
    for (int k = 0; k < 3; k++)
        out->normal[k] = v_select(none, v_set(k == 2 ? -1 : 0), out->normal[k] * (both * mix->sum));
    out->depth = v_select(mix->made, depth * (both * length), there);
}

/* What a vector of pixels shows of ribbons, a fragment or the weighted mean of several, and the pixels' rays:
 * the input of meet_ribbon, which finds where the rays meet the ribbon. */
typedef struct pp_place {
    vf n[3];      /* normal: unit, view space */
    vf depth;     /* of the point on the line's axis; ISO_NOWHERE where there is none */
    vf beside[2]; /* x and y from that point to the pixel's ray at the same depth, mm */
    vf radius;
    vf ray[3]; /* of depth 1 */
} pp_place;

ISO_INLINE vf dot3(const vf a[3], const vf b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* Intersects the pixel's ray with the plane of a ribbon. Where the ribbon is seen from its edge the slope of
 * the plane is limited, so that the depth stays near the line's. */
ISO_INLINE void meet_ribbon(const pp_place *p, pp_sample *out) {
    const vf across = dot3(p->ray, p->n), least = 0.25f * v_sqrt(dot3(p->ray, p->ray));
    const vm away = v_lt(v_set(0), across);
    const vf steep = v_max(v_abs(across), least), before = p->beside[0] * p->n[0] + p->beside[1] * p->n[1];
    for (int k = 0; k < 3; k++) out->normal[k] = v_select(away, -p->n[k], p->n[k]);
    out->depth = p->depth - v_select(away, before, -before) / steep;
}

/* The same as complete_samples for ribbons: a pixel's own fragment is always drawn, so that lines are at
 * least a pixel wide. `radius` and `offset` are weighted sums as well. */
ISO_INLINE void complete_line(const iso_pullpush_params *params, const pp_own *own, const pp_mix *mix,
                              const vf normal[3], vf depth, vf radius, const vf offset[2], pp_sample *out) {
    const float *radii = params->pyramid->level[0].plane[ISO_PLANE_RADIUS];
    const vf inverse = 1 / mix->sum;
    const vf part_x = v_to_float(own->payload >> 22 & 31) * (1.0f / 32) - 31.0f / 64,
             part_y = v_to_float(own->payload >> 27 & 31) * (1.0f / 32) - 31.0f / 64;
    pp_place p;
    vf n[3], kept[3];
    unfold_normals(own->payload, n);
    transform_normals(params, n, kept);
    for (int k = 0; k < 3; k++) p.n[k] = v_select(mix->made, normal[k], kept[k]);
    const vf square = dot3(p.n, p.n), scale = 1 / v_sqrt(v_max(square, v_set(1e-30f)));
    for (int k = 0; k < 3; k++) p.n[k] = p.n[k] * scale;
    p.depth = v_select(mix->made, depth * inverse, own->depth);
    p.radius = radius * inverse;
    if (radii) p.radius = v_select(mix->made, p.radius, every_second(radii + own->at, own->side));
    const vm there = v_lt(p.depth, v_set(ISO_NOWHERE));
    const vf at = v_select(there, p.depth, v_set(1));
    const vf pixel = params->orthographic ? v_set(1 / params->scale) : at * (1 / params->scale);
    p.beside[0] = -v_select(mix->made, offset[0] * inverse, part_x) * pixel;
    p.beside[1] = -v_select(mix->made, offset[1] * inverse, part_y) * pixel;
    p.ray[0] = (v_to_float(v_lanes() * 2 + own->column) + 0.5f - params->ray[0]) * params->slope;
    p.ray[1] = v_set(((float)own->row + 0.5f - params->ray[1]) * params->slope);
    p.ray[2] = v_set(1);
    meet_ribbon(&p, out);
    out->depth = v_select(there, out->depth, v_set(ISO_NOWHERE));
}

/* ---- several sets */

/* Completes a sample as a surface or as a ribbon, as its set says. */
ISO_INLINE void complete_set(const iso_pullpush_params *params, const pp_own *own, const pp_mix *mix,
                             const vf normal[3], vf depth, vf radius, const vf offset[2], vf set,
                             pp_sample *out) {
    const vm ribbon = are_ribbons(set);
    pp_sample line;
    complete_samples(params, own, mix, normal, depth, out, PP_SETS);
    if (!v_mask(ribbon)) return;
    complete_line(params, own, mix, normal, depth, radius, offset, &line);
    out->depth = v_select(ribbon, line.depth, out->depth);
    for (int k = 0; k < 3; k++) out->normal[k] = v_select(ribbon, line.normal[k], out->normal[k]);
}

/* Completes a vector of samples. Where the mixture is of another set than the pixel's own fragment, the
 * nearer of both is drawn: without regard to depth intervals, because different sets do not blend. Mixtures
 * that are not drawn are taken out of mix->made. */
ISO_INLINE void complete_nearer(const iso_pullpush_params *params, const pp_own *own, pp_mix *mix,
                                const vf normal[3], vf depth, vf radius, const vf offset[2], vf own_set,
                                pp_sample *out) {
    const vf set = v_select(mix->made, mix->set, own_set);
    complete_set(params, own, mix, normal, depth, radius, offset, set, out);
    if (v_mask(mix->foreign)) {
        pp_mix none = *mix;
        pp_sample kept;
        none.made = v_from_mask(0);
        none.covered = v_andnot(mix->covered, mix->foreign);
        none.sum = v_set(1);
        complete_set(params, own, &none, normal, depth, radius, offset, own_set, &kept);
        const vm keep = v_and(mix->foreign, v_le(kept.depth, out->depth));
        out->depth = v_select(keep, kept.depth, out->depth);
        for (int k = 0; k < 3; k++) out->normal[k] = v_select(keep, kept.normal[k], out->normal[k]);
        mix->made = v_andnot(mix->made, keep);
    }
    const vi bits = v_trunc(v_select(mix->made, mix->set, own_set));
    out->surface = bits & 255;
    out->color = v_selecti(v_eqi(bits & ISO_SET_COLORED, v_seti(ISO_SET_COLORED)), (out->surface + 1) << 24,
                           v_seti(0));
}

/* Completes the samples of several sets of a vector of cells. `any`: at least one sample is mixed. */
ISO_INLINE void complete_sets(const iso_pullpush_params *params, const pp_own own[4], pp_mix mix[4],
                              vf normal[3][4], const vf depth[4], const vf own_set[4], size_t at, bool any,
                              pp_sample sample[4]) {
    const iso_pyramid_level *c = &params->pyramid->level[1];
    vf radius[4], offset[2][4];
    for (int s = 0; s < 4; s++) radius[s] = offset[0][s] = offset[1][s] = v_set(0);
    if (any) {
        mix_plane(c, ISO_PLANE_RADIUS, at, mix, radius);
        mix_offsets(c, ISO_PLANE_DX, at, mix, offset[0]);
        mix_offsets(c, ISO_PLANE_DY, at, mix, offset[1]);
    }
    for (int s = 0; s < 4; s++) {
        const vf n[3] = {normal[0][s], normal[1][s], normal[2][s]}, from[2] = {offset[0][s], offset[1][s]};
        complete_nearer(params, &own[s], &mix[s], n, depth[s], radius[s], from, own_set[s], &sample[s]);
    }
}

/* The depths and sets of the fragments that were projected to the finer pixels. */
ISO_INLINE void read_own_sets(const iso_pyramid *p, const bool within[2], const pp_own own[4], pp_finer *out,
                              const pp_sides sides) {
    const float *sets = p->level[0].plane[ISO_PLANE_SET];
    out->last = true;
    for (int s = 0; s < 4; s++) {
        out->low[s] = own[s].depth;
        if (sides == PP_SETS) out->set[s] = within[s >> 1] ? every_second(sets + own[s].at, s & 1) : v_set(0);
    }
}

/* ---- into the gbuffer */

/* Interleaves left and right samples of cells to a row of the picture: its first (end 0) or second half. */
ISO_INLINE void interleave_samples(const pp_sample sample[2], const int end, pp_sample *out,
                                   const pp_sides sides) {
    if (sides == PP_SETS) {
        const vf left = v_floats(sample[0].surface), right = v_floats(sample[1].surface);
        out->surface = v_bits(end ? v_zip_high(left, right) : v_zip_low(left, right));
    }
    vf even = v_floats(sample[0].color), odd = v_floats(sample[1].color);
    out->color = v_bits(end ? v_zip_high(even, odd) : v_zip_low(even, odd));
    out->depth =
        end ? v_zip_high(sample[0].depth, sample[1].depth) : v_zip_low(sample[0].depth, sample[1].depth);
    for (int k = 0; k < 3; k++)
        out->normal[k] = end ? v_zip_high(sample[0].normal[k], sample[1].normal[k])
                             : v_zip_low(sample[0].normal[k], sample[1].normal[k]);
}

/* Writes a vector of samples into the gbuffer where they are nearer. */
ISO_INLINE void write_samples(const iso_target *target, size_t at, const pp_sample *sample,
                              const pp_sides sides) {
    const iso_gbuffer *g = target->gbuffer;
    vf there = v_load(g->depth + at);
    vm nearer = v_and(v_lt(sample->depth, there), v_lt(sample->depth, v_set(ISO_NOWHERE)));
    if (!v_mask(nearer)) return;
    bool all = v_mask(nearer) == (uint32_t)((1ull << ISO_LANES) - 1); /* no old value remains */
    v_store(g->depth + at, v_select(nearer, sample->depth, there));
    for (int k = 0; k < 3; k++) {
        float *plane = g->normal[k] + at;
        v_store(plane, all ? sample->normal[k] : v_select(nearer, sample->normal[k], v_load(plane)));
    }
    vi surface = sides == PP_SETS ? sample->surface : v_seti(target->surface);
    if (!all) surface = v_selecti(nearer, surface, v_load_u8(g->surface + at));
    v_store_u8(g->surface + at, surface);
    if (!g->color) return;
    int32_t *color = (int32_t *)g->color + at;
    v_storei(color, v_selecti(nearer, sample->color, v_loadi(color)));
}

/* The same for a vector of which some samples lie beside the picture. */
ISO_INLINE void write_some_samples(const iso_target *target, int line, int column, const pp_sample *sample,
                                   const pp_sides sides) {
    const iso_gbuffer *g = target->gbuffer;
    float depth[ISO_LANES], normal[3][ISO_LANES];
    int32_t color[ISO_LANES], surface[ISO_LANES];
    v_store(depth, sample->depth);
    v_storei(color, sample->color);
    v_storei(surface, sides == PP_SETS ? sample->surface : v_seti(target->surface));
    for (int k = 0; k < 3; k++) v_store(normal[k], sample->normal[k]);
    for (int i = column < 0 ? -column : 0; i < ISO_LANES && column + i < g->width; i++) {
        size_t to = (size_t)line * (size_t)g->width + (size_t)(column + i);
        if (!(depth[i] < g->depth[to] && depth[i] < ISO_NOWHERE)) continue;
        g->depth[to] = depth[i];
        for (int k = 0; k < 3; k++) g->normal[k][to] = normal[k][i];
        g->surface[to] = (uint8_t)surface[i];
        if (g->color) g->color[to] = (uint32_t)color[i];
    }
}

/* Writes a row of the samples of a vector of cells that begins in column x of cells. */
ISO_INLINE void write_row(const iso_pullpush_params *params, int x, int line, const pp_sample sample[2],
                          const pp_sides sides) {
    const iso_target *target = params->target;
    const int width = target->gbuffer->width;
#pragma GCC unroll 2
    for (int end = 0; end < 2; end++) {
        pp_sample samples;
        interleave_samples(sample, end, &samples, sides);
        int column = 2 * x - 1 + end * ISO_LANES + params->pyramid->layout.column;
        if (column >= 0 && column + ISO_LANES <= width)
            write_samples(target, (size_t)line * (size_t)width + (size_t)column, &samples, sides);
        else if (column < width)
            write_some_samples(target, line, column, &samples, sides);
    }
}

/* ---- gaps beside the surface */

/* Takes back the values of samples in gaps (gaps_simd.h) that the ellipses of no points support: the coarser
 * pixels around an opening of the surface that is narrower than two discs all have values. The points are
 * found in the keys around the sample. */
ISO_INLINE void open_gaps(const iso_pullpush_params *params, const pp_cells *cells, const pp_own own[4],
                          pp_mix mix[4]) {
    vf nearest = v_set(ISO_NOWHERE), widest = v_set(0);
    uint32_t any = 0;
    for (int s = 0; s < 4; s++) any |= v_mask(v_andnot(mix[s].made, mix[s].covered));
    if (!any) return;
    for (int k = 0; k < 4; k++) {
        const ptrdiff_t o = corner_index(cells->corners, cells->at, k);
        nearest = v_min(nearest, v_load(cells->corners->plane[ISO_PLANE_LOW] + o));
        widest = v_max(widest, rise_of(params, cells->corners, o));
    }
    vm large;
    const vf reach = support_reach(params, widest, nearest, &large);
    for (int s = 0; s < 4; s++) {
        const vm asked = v_and(large, v_andnot(mix[s].made, mix[s].covered));
        if (v_mask(asked))
            mix[s].made = v_andnot(mix[s].made, find_unsupported(params, &own[s], reach, asked));
    }
}

/* Reads the keys of the finer pixels of a vector of cells, in rows of the picture (`within`), when level 0
 * has keys (`has_own`). Columns left of the first are read from the end of the row above, which exists
 * because of the guard band; these pixels are not drawn. */
ISO_INLINE void read_own_points(const iso_pyramid *p, int x, int y, const bool within[2], const bool has_own,
                                pp_own own[4]) {
    for (int row = 0; row < 2; row++) {
        const int line = 2 * y - 1 + row;
        vf depth[2] = {v_set(ISO_NOWHERE), v_set(ISO_NOWHERE)}, bits[2] = {depth[0], depth[0]};
        if (has_own && within[row]) {
            const int64_t *keys = p->keys + (size_t)line * p->key_stride + (size_t)(2 * x - 1);
            vi payload[2];
            split_keys(keys, &depth[0], &payload[0]);
            split_keys(keys + ISO_LANES, &depth[1], &payload[1]);
            bits[0] = v_floats(payload[0]);
            bits[1] = v_floats(payload[1]);
        }
        for (int side = 0; side < 2; side++)
            own[2 * row + side] =
                (pp_own){.depth = side ? v_odd(depth[0], depth[1]) : v_even(depth[0], depth[1]),
                         .payload = v_bits(side ? v_odd(bits[0], bits[1]) : v_even(bits[0], bits[1])),
                         .column = 2 * x - 1 + side,
                         .row = line + p->layout.rows_before,
                         .at = (size_t)line * p->level[0].stride + (size_t)(2 * x - 1),
                         .side = side};
    }
}

/* Draws the samples of a vector of cells of level 1. */
ISO_INLINE void finish_cells(const iso_pullpush_params *params, int x, int y, const bool has_own,
                             const pp_sides sides) {
    const iso_pyramid *p = params->pyramid;
    const iso_pyramid_level *c = &p->level[1];
    const size_t at = (size_t)y * c->stride + (size_t)x;
    const int line = 2 * y - 1 + p->layout.row, height = params->target->gbuffer->height;
    const bool within[2] = {line >= 0 && line < height, line + 1 >= 0 && line + 1 < height};
    pp_own own[4];
    pp_mix mix[4];
    pp_sample sample[4];
    pp_finer finer;
    vf normal[3][4], depth[4];
    bool any;
    read_own_points(p, x, y, within, has_own, own);
    read_own_sets(p, within, own, &finer, sides);
    const pp_cells cells = {c, 1, at, x, y};
    any = weigh_corners(params, &cells, &finer, mix, sides);
    if (any && is_surface(sides)) open_gaps(params, &cells, own, mix);
    if (any) {
        for (int k = 0; k < 3; k++) mix_normals(c, ISO_PLANE_NX + k, at, mix, normal[k], sides);
        mix_plane(c, ISO_PLANE_DEPTH, at, mix, depth);
    } else {
        for (int s = 0; s < 4; s++) depth[s] = normal[0][s] = normal[1][s] = normal[2][s] = v_set(0);
    }
    const uint32_t marked = c->plane[ISO_PLANE_RED] ? (uint32_t)(params->target->surface + 1) << 24 : 0;
    for (int s = 0; s < 4; s++) sample[s].color = v_seti((int32_t)marked);
    if (sides == PP_SETS) {
        complete_sets(params, own, mix, normal, depth, finer.set, at, any, sample);
    } else {
#pragma GCC unroll 4
        for (int s = 0; s < 4; s++) {
            const vf n[3] = {normal[0][s], normal[1][s], normal[2][s]};
            complete_samples(params, &own[s], &mix[s], n, depth[s], &sample[s], sides);
        }
    }
    if (c->plane[ISO_PLANE_RED]) set_colors(params, at, own, mix, sample);
    if (is_surface(sides)) look_for_rims(params, &cells, within, own, sample);
    for (int row = 0; row < 2; row++)
        if (within[row]) write_row(params, x, line + row, sample + 2 * row, sides);
}

/* Prefetches the keys and the parts of the gbuffer of a vector of cells: hardware prefetchers follow fewer
 * rows at a time. */
ISO_INLINE void prefetch_cells(const iso_pullpush_params *params, int x, int y, const bool has_own) {
    const iso_pyramid *p = params->pyramid;
    const iso_gbuffer *g = params->target->gbuffer;
    const int line = 2 * y - 1 + p->layout.row, column = 2 * x - 1 + p->layout.column;
    if (line < 0 || line + 1 >= g->height || column + 2 * ISO_LANES > g->width) return;
    for (int row = 0; row < 2; row++) {
        const size_t at = (size_t)(line + row) * (size_t)g->width + (size_t)column;
        const int64_t *keys = p->keys + (size_t)(2 * y - 1 + row) * p->key_stride + (size_t)(2 * x - 1);
        for (int i = 0; has_own && i < 2 * ISO_LANES; i += 8) __builtin_prefetch(keys + i, 0, 2);
        for (int i = 0; i < 2 * ISO_LANES; i += 16) {
            __builtin_prefetch(g->depth + at + i, 1, 2);
            for (int k = 0; k < 3; k++) __builtin_prefetch(g->normal[k] + at + i, 1, 2);
        }
        __builtin_prefetch(g->surface + at, 1, 2);
    }
}

/* Draws row y of level 1's cells. Vectors are placed so that one ends with the picture's first column: only
 * that pixel is written alone, all other vectors lie inside the picture except at its right end. */
ISO_INLINE void finish_row(const iso_pullpush_params *params, int y, const bool own, const pp_sides sides) {
    const iso_pyramid *p = params->pyramid;
    const int guard = p->layout.guard, end = guard + params->target->gbuffer->width;
    for (int x = (guard + 2 - ISO_LANES) / 2; 2 * x - 1 < end; x += ISO_LANES) {
        if (!has_points_around(&p->level[1], (size_t)y * p->level[1].stride + (size_t)x)) continue;
        prefetch_cells(params, x, y + 1, own);
        finish_cells(params, x, y, own, sides);
    }
}

static void finish_samples(const iso_pullpush_params *params, iso_rows rows) {
    const bool own = params->pyramid->layout.base == 0;
    for (int y = rows.first; y <= rows.last; y++) finish_row(params, y, own, PP_SIDES);
}

#endif
