/* phong_simd: Phong's reflection model (Phong 1975) for vectors of samples, and conversion of colours to
 * pixels. For kernels that shade. */
#ifndef ISO_RENDER_SHADING_PHONG_SIMD_H
#define ISO_RENDER_SHADING_PHONG_SIMD_H

#include "base/simd.h"
#include "render/shading/phong_vectors.h"

ISO_INLINE vf v_dot3(const vf a[3], const vf b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* Light that falls on samples with unit normals: the cosines `key` and `fill` of the two lights; `lobe` is
 * the squared cosine between the mirrored key light and the eye, from which phong_color computes the specular
 * term. `to_eye` need not be unit. */
ISO_INLINE void phong_lights(const vf normal[3], const vf to_eye[3], vf *key_cosine, vf *fill_cosine,
                             vf *lobe) {
    const vf zero = v_set(0), one = v_set(1);
    const vf light[3] = {v_set(KEY_LIGHT[0]), v_set(KEY_LIGHT[1]), v_set(KEY_LIGHT[2])};
    vf facing = v_dot3(normal, to_eye);
    vf side = v_select(v_lt(facing, zero), v_set(-1), one);
    vf key = v_max(side * v_dot3(normal, light), zero), fill = v_max(-side * normal[2], zero);
    /* the direction to the light mirrored at the normal, times the direction to the eye: (2 (n.l) n - l).v */
    vf mirror = v_max((key + key) * v_abs(facing) - v_dot3(light, to_eye), zero);
    mirror = v_select(v_lt(zero, key), mirror, zero);
    /* the 16th power of a smaller lobe could be denormal, which is slow; 0.01^16 is invisible anyway */
    *lobe = v_max(mirror * mirror / v_dot3(to_eye, to_eye), v_set(0.01f));
    *key_cosine = key;
    *fill_cosine = fill;
}

/* Light reflected by samples: `diffuse` is the factor of the surface's colour; `lobe` as phong_lights. */
ISO_INLINE void phong_terms(const vf normal[3], const vf to_eye[3], vf *diffuse, vf *lobe) {
    vf key, fill;
    phong_lights(normal, to_eye, &key, &fill, lobe);
    *diffuse = v_set(ISO_PHONG_AMBIENT) + v_set(ISO_PHONG_KEY) * key + v_set(ISO_PHONG_FILL) * fill;
}

/* The specular term. The exponent is 32; as the lobe is a square already, its 16th power is taken. */
ISO_INLINE vf phong_white(vf lobe) {
    for (int i = 0; i < 4; i++) lobe *= lobe;
    return v_set(ISO_PHONG_SPECULAR) * lobe;
}

/* Computes the colours (0 .. 1) of samples from the results of phong_terms and the surface's colour `base`.
 */
ISO_INLINE void phong_color(vf diffuse, vf lobe, const vf base[3], vf rgb[3]) {
    const vf white = phong_white(lobe);
    for (int c = 0; c < 3; c++) rgb[c] = v_min(base[c] * diffuse + white, v_set(1));
}

/* Applies phong_terms and phong_color. */
ISO_INLINE void phong(const vf normal[3], const vf to_eye[3], const vf base[3], vf rgb[3]) {
    vf diffuse, lobe;
    phong_terms(normal, to_eye, &diffuse, &lobe);
    phong_color(diffuse, lobe, base, rgb);
}

/* Applies the model to samples that `ambient` of the light from all around reaches and `shadow` of the key
 * light, 0 .. 1. The fill light stands for light from all around; of the key light the shadow takes all, and
 * what blocks the surroundings half, as there is no light that they reflect. */
ISO_INLINE void phong_open(const vf normal[3], const vf to_eye[3], const vf base[3], vf ambient, vf shadow,
                           vf rgb[3]) {
    vf key, fill, lobe;
    phong_lights(normal, to_eye, &key, &fill, &lobe);
    const vf direct = shadow * (v_set(0.5f) + v_set(0.5f) * ambient),
             diffuse = (v_set(ISO_PHONG_AMBIENT) + v_set(ISO_PHONG_FILL) * fill) * ambient +
                       v_set(ISO_PHONG_KEY) * key * direct,
             white = phong_white(lobe) * direct;
    for (int c = 0; c < 3; c++) rgb[c] = v_min(base[c] * diffuse + white, v_set(1));
}

/* Replaces the colours of samples that have one of their own (iso_gbuffer.color). */
ISO_INLINE void replace_colors(const uint8_t *surface, const uint32_t *color, vf base[3]) {
    vi word = v_loadi((const int32_t *)color);
    vm own = v_eqi(word >> 24 & 255, v_load_u8(surface) + 1);
    for (int c = 0; c < 3; c++)
        base[c] = v_select(own, v_to_float(word >> 8 * c & 255) / v_set(255), base[c]);
}

/* Gives samples whose normal is 0, which are not lit, the colours `base`. */
ISO_INLINE void leave_unlit(const vf normal[3], const vf base[3], vf rgb[3]) {
    const vf largest = v_max(v_max(v_abs(normal[0]), v_abs(normal[1])), v_abs(normal[2]));
    const vm unlit = v_eq(largest, v_set(0));
    for (int c = 0; c < 3; c++) rgb[c] = v_select(unlit, base[c], rgb[c]);
}

ISO_INLINE vi to_byte(vf value) {
    return v_trunc(value * v_set(255) + v_set(0.5f));
}

/* Converts colours (0 .. 1) and alpha (0 .. 255) to 32-bit words of four bytes. */
ISO_INLINE vi pack_pixels(const vf rgb[3], vi alpha) {
    return to_byte(rgb[0]) << SHIFT[0] | to_byte(rgb[1]) << SHIFT[1] | to_byte(rgb[2]) << SHIFT[2] |
           alpha << SHIFT[3];
}

#endif
