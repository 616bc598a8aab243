/* ellipses_simd: the ellipses of the levels of the pyramid, as push needs them. */
#ifndef ISO_RENDER_PULLPUSH_ELLIPSES_SIMD_H
#define ISO_RENDER_PULLPUSH_ELLIPSES_SIMD_H

#include "render/pullpush/gaps_simd.h"

/* Which pixels show ribbons, judged by their set numbers. */
ISO_INLINE vm are_ribbons(vf set) {
    return v_eqi(v_trunc(set) & ISO_SET_RIBBON, v_seti(ISO_SET_RIBBON));
}

/* A vector of ellipses: the planes WIDE to OUT. */
typedef struct pp_ellipse {
    vf wide, thin_x, thin_y;
    vi out; /* bits of OUT, without HIDDEN */
} pp_ellipse;

/* Inverts the matrices M that a level stores, into the form q of pyramid.h: WIDE is the lesser eigenvalue of
 * M^-1; THIN is the eigenvector of the greater one, with the length sqrt(greater - lesser). `area`: the area
 * of a pixel of level 0 in pixels of this level. */
ISO_INLINE pp_ellipse invert_shape(const iso_pyramid_level *level, size_t at, float area) {
    vf xx = v_load(level->plane[ISO_PLANE_SHAPE_XX] + at) * area,
       xy = v_load(level->plane[ISO_PLANE_SHAPE_XY] + at) * area,
       yy = v_load(level->plane[ISO_PLANE_SHAPE_YY] + at) * area;
    vf half = 0.5f * (xx - yy), spread = v_sqrt(half * half + xy * xy), mean = 0.5f * (xx + yy);
    vf wide = 1 / v_max(mean + spread, v_set(1e-12f)),
       thin = v_max(1 / v_max(mean - spread, v_set(1e-12f)) - wide, v_set(0));
    /* (half, xy) / spread is the direction of the longer axis with its angle doubled */
    vf ratio = v_max(v_min(half / v_max(spread, v_set(1e-12f)), v_set(1)), v_set(-1));
    vf along_x = v_sqrt(0.5f * (1 - ratio) * thin), along_y = v_sqrt(0.5f * (1 + ratio) * thin);
    return (pp_ellipse){.wide = wide,
                        .thin_x = along_x,
                        .thin_y = v_select(v_lt(v_set(0), xy), -along_y, along_y),
                        .out = v_bits(v_set(ISO_NOWHERE))};
}

/* Makes ellipses from normals and radii; lanes in `none` have no disc. The orthogonal projection along z of a
 * disc has the matrix P^2 (I - m m'), where P is the disc's projected radius and m the x and y of its unit
 * normal. With the low-pass filter L it is P^2 (I - m m') + L I (Zwicker et al. 2001). Its inverse, by the
 * formula of Sherman and Morrison, is the quadratic form q of pyramid.h. On the side of the silhouette, OUT
 * limits the ellipse to a smaller low-pass, which decreases as the disc turns edge-on: otherwise silhouettes
 * would grow by the filter. `radius`: pixels of the level; `ray`: x and y of the pixels' rays of depth 1. */
ISO_INLINE pp_ellipse project_disc(const iso_pullpush_params *params, const iso_pyramid_level *level,
                                   size_t at, vf radius, const vf ray[2], vm none, vm hidden, float area) {
    const vf low_pass = v_set(params->low_pass * area), facing = v_set(params->facing * area),
             edge = v_set(params->edge * area);
    vf nx = v_load(level->plane[ISO_PLANE_NX] + at), ny = v_load(level->plane[ISO_PLANE_NY] + at),
       nz = v_load(level->plane[ISO_PLANE_NZ] + at);
    /* rotate the normal as the pixel's ray must be rotated to lie on the z axis, so that a disc is seen
     * edge-on where it is at right angles to its own ray */
    vf ray_z = 1 / v_sqrt(ray[0] * ray[0] + ray[1] * ray[1] + 1);
    vf along = (nx * ray[0] + ny * ray[1] + nz) * ray_z, turn = (along + nz) * ray_z / (1 + ray_z);
    nx -= turn * ray[0];
    ny -= turn * ray[1];
    vf flat = nx * nx + ny * ny, square = v_max(flat + along * along, v_set(1e-12f));
    vf b = radius * radius, a = b + low_pass, e = a * square - b * flat;
    vf inverse = 1 / (a * e);
    pp_ellipse made = {.wide = e * inverse};
    vf thin = v_sqrt(v_select(none, v_set(0), b * inverse));
    vf reach = v_sqrt(flat * ((b + facing) * along * along + v_select(hidden, facing, edge) * flat) / square);
    made.out = v_bits(reach * thin);
    /* with back-facing normals, the silhouette is on the other side */
    thin = v_floats(v_bits(thin) ^ (~v_bits(along) & INT32_MIN));
    made.thin_x = nx * thin;
    made.thin_y = ny * thin;
    return made;
}

/* Returns the projected radii of discs, in pixels of the level. */
ISO_INLINE vf disc_radii(const iso_pullpush_params *params, const iso_pyramid_level *level, size_t at,
                         vm none, float shrink) {
    vf radius = v_set(params->radius * params->scale * shrink);
    if (level->plane[ISO_PLANE_RADIUS])
        radius = v_load(level->plane[ISO_PLANE_RADIUS] + at) * (params->scale * shrink);
    if (params->orthographic) return radius;
    return radius / v_select(none, v_set(1), v_load(level->plane[ISO_PLANE_DEPTH] + at));
}

/* ellipses_simd: the ellipses of a vector of pixels; adds to *none the lanes whose discs are too small to
 * have one. */
ISO_INLINE pp_ellipse make_ellipse(const iso_pullpush_params *params, const iso_pyramid_level *level,
                                   size_t at, const vf ray[2], vm *none, vm hidden, float shrink) {
    const float area = shrink * shrink;
    const bool shaped = level->plane[ISO_PLANE_SHAPE_XX] != NULL, sets = level->plane[ISO_PLANE_SET] != NULL;
    if (shaped && !sets) return invert_shape(level, at, area);
    vf radius = disc_radii(params, level, at, *none, shrink);
    vm ribbon = v_from_mask(0);
    if (sets) ribbon = are_ribbons(v_load(level->plane[ISO_PLANE_SET] + at));
    *none = v_or(*none, v_andnot(v_lt(radius, v_set(params->least_radius * shrink)), ribbon));
    pp_ellipse made = project_disc(params, level, at, radius, ray, *none, hidden, area);
    if (!shaped || !v_mask(ribbon)) return made;
    const pp_ellipse shape = invert_shape(level, at, area);
    return (pp_ellipse){.wide = v_select(ribbon, shape.wide, made.wide),
                        .thin_x = v_select(ribbon, shape.thin_x, made.thin_x),
                        .thin_y = v_select(ribbon, shape.thin_y, made.thin_y),
                        .out = v_selecti(ribbon, shape.out, made.out)};
}

/* ISO_OUT_BORDER where a disc may reach the grid's border, with a wide margin. `column` and `row`: of the
 * pixels' centres, as for index_ray; `size`: of a pixel, pixels of level 0. */
ISO_INLINE vi mark_border(const iso_pullpush_params *params, const iso_pyramid_level *level, size_t at,
                          vf column, vf row, float size) {
    const vf depth = v_load(level->plane[ISO_PLANE_DEPTH] + at);
    const pp_ray ray = index_ray(params, column, row);
    vf pixel = v_set(4 * size / params->scale), longest = v_set(0);
    if (!params->orthographic) pixel = pixel * v_abs(depth);
    for (int k = 0; k < 3; k++) {
        const float *n = params->normal + k;
        longest = v_max(longest, v_set(n[0] * n[0] + n[3] * n[3] + n[6] * n[6]));
    }
    const vf reach = (pixel + 2 * plane_or(level, ISO_PLANE_RADIUS, at, params->radius)) * v_sqrt(longest);
    vf room = v_set(ISO_NOWHERE);
    for (int k = 0; k < 3; k++) room = v_min(room, room_in_grid(params, &ray, depth, k));
    return v_selecti(v_lt(room, reach), v_seti(ISO_OUT_BORDER), v_seti(0));
}

static void make_ellipses(const iso_pullpush_params *params, int number, iso_rows rows) {
    const iso_pyramid_level *level = &params->pyramid->level[number];
    const float size = (float)(1 << number), shrink = 1.0f / size;
    const bool surface = is_surface(PP_SIDES);
    for (int y = rows.first; y <= rows.last; y++) {
        const int whole = y + (params->pyramid->layout.rows_before >> number);
        const vf ray_y = v_set((((float)whole + 0.5f) * size - params->ray[1]) * params->slope);
        for (int x = 0; x < level->width; x += ISO_LANES) {
            size_t at = (size_t)y * level->stride + (size_t)x;
            vf low = v_load(level->plane[ISO_PLANE_LOW] + at);
            vm none = v_le(v_set(ISO_NOWHERE), low);
            const vm marked = v_lt(v_set(0), v_load(level->plane[ISO_PLANE_HIDDEN] + at)),
                     hidden = surface ? v_from_mask(0) : marked;
            if (!v_mask(v_lt(low, v_set(ISO_NOWHERE)))) {
                v_store(level->plane[ISO_PLANE_WIDE] + at, v_set(INFINITY));
                continue;
            }
            const vf ray_x = ((v_to_float(v_lanes() + x) + 0.5f) * size - params->ray[0]) * params->slope;
            const vf ray[2] = {ray_x, ray_y};
            const pp_ellipse made = make_ellipse(params, level, at, ray, &none, hidden, shrink);
            v_store(level->plane[ISO_PLANE_WIDE] + at, v_select(none, v_set(INFINITY), made.wide));
            v_store(level->plane[ISO_PLANE_THIN_X] + at, made.thin_x);
            v_store(level->plane[ISO_PLANE_THIN_Y] + at, made.thin_y);
            vi out = made.out & ~(ISO_OUT_MARK | ISO_OUT_BORDER);
            out |= v_selecti(marked, v_seti(ISO_OUT_MARK), v_seti(0));
            if (surface && params->has_border)
                out |= mark_border(params, level, at, (v_to_float(v_lanes() + x) + 0.5f) * size,
                                   v_set(((float)whole + 0.5f) * size), size);
            v_store(level->plane[ISO_PLANE_OUT] + at, v_floats(out));
        }
    }
}

#endif
