/* sphere_simd: the ray of a pixel and a sphere.
 *
 * With the ray o + s d relative to the centre, o = (k dx, k dy, 0) and d = (u, v, 1), the discriminant is
 * r^2 |d|^2 - |o x d|^2 by Lagrange's identity: nothing in it is larger than the sphere. */
#ifndef ISO_RENDER_SHAPES_SPHERE_SIMD_H
#define ISO_RENDER_SHAPES_SPHERE_SIMD_H

#include "render/shapes/patch_simd.h"

/* Returns the discriminant r^2 |d|^2 - |o x d|^2, and sets *dd to |d|^2. */
ISO_INLINE vf sphere_discriminant(const sp_pixel *p, vf radius, vf *dd) {
    const vf across = p->dx * p->v - p->dy * p->u, offset = (p->dx * p->dx + p->dy * p->dy) + across * across;
    *dd = p->u * p->u + (p->v * p->v + 1.0f);
    return radius * radius * *dd - p->k * p->k * offset;
}

/* Returns s of the nearer intersection; the discriminant must not be negative. */
ISO_INLINE vf sphere_root(const sp_pixel *p, vf discriminant, vf dd) {
    return -(p->k * (p->dx * p->u + p->dy * p->v) + v_sqrt(discriminant)) / dd;
}

/* Returns which pixels see the sphere, and sets the depths. */
ISO_INLINE vm sphere_depth(const sp_pixel *p, const vf *field, vf *depth) {
    vf dd;
    const vf d = sphere_discriminant(p, field[ISO_FIELD_R], &dd);
    const vm hit = v_le(v_set(0), d);
    *depth = field[ISO_FIELD_Z];
    if (v_mask(hit)) *depth += sphere_root(p, v_max(d, v_set(0)), dd);
    return hit;
}

/* Computes the normal at the hit of sphere_depth. */
ISO_INLINE void sphere_normal(const sp_pixel *p, const vf *field, vf normal[3]) {
    vf dd;
    const vf d = sphere_discriminant(p, field[ISO_FIELD_R], &dd);
    const vf s = sphere_root(p, v_max(d, v_set(0)), dd), scale = 1.0f / field[ISO_FIELD_R];
    normal[0] = (p->k * p->dx + s * p->u) * scale;
    normal[1] = (p->k * p->dy + s * p->v) * scale;
    normal[2] = s * scale;
}

#endif
