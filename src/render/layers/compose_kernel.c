/* compose_kernel: composites rows of samples, ISO_LANES neighbours at a time. */
#include "render/layers/compose_kernel.h"

#include <string.h>

#include "base/simd.h"
#include "render/shading/phong_simd.h"

/* Unpacks a vector of fragments (iso_packed_fragment): sets rgb to the colours, returns the opacities. */
ISO_INLINE vf unpack(const vf packed[4], vf rgb[3]) {
    const vi first = v_bits(packed[1]), second = v_bits(packed[2]), third = v_bits(packed[3]);
    const vi green = (first >> 22 & 0x3ff) | (second << 10 & (ISO_LAYER_COLOR & ~0x3ff)),
             blue = (second >> 12 & 0xfffff) | (third << 20 & (ISO_LAYER_COLOR & ~0xfffff));
    rgb[0] = v_to_float(first & ISO_LAYER_COLOR) * (1.0f / ISO_LAYER_COLOR);
    rgb[1] = v_to_float(green) * (1.0f / ISO_LAYER_COLOR);
    rgb[2] = v_to_float(blue) * (1.0f / ISO_LAYER_COLOR);
    return v_to_float(third >> 9 & (ISO_LAYER_OPACITY - 1)) * (1.0f / ISO_LAYER_OPACITY);
}

/* Composites those fragments of a group's samples from `column` on whose bits in `present` are set (Porter
 * and Duff 1984, `over`). at: index of the first sample in the line. */
ISO_INLINE void compose_vector(const iso_layer_group *group, int column, vm present,
                               const iso_layer_line *line, int at, iso_layer_totals *totals) {
    const vf zero = v_set(0), one = v_set(1), cut = v_set(ISO_LAYER_CUT);
    vf color[3] = {zero, zero, zero}, through = one, layers = zero, list[4];
    int32_t index[ISO_LANES];
    v_storei(index, v_lanes() * 4); /* of 16-byte lists and fragments */
    v_load4((const float *)&group->list[column], index, 1, list);
    const vi count = v_bits(list[3]);
    const iso_layer_chunk *chunk = group->first;
    for (int k = 0; chunk; chunk = chunk->next)
        for (int layer = 0; layer < ISO_LAYER_CHUNK; layer++, k++) {
            const vm open = v_andnot(v_lti(v_seti(k), count), v_lt(through, cut));
            const uint32_t bits = v_mask(v_and(open, present));
            if (!bits) goto done;
            totals->layers += (size_t)__builtin_popcount(bits);
            if (k >= totals->most) totals->most = k + 1;
            vf packed[4], rgb[3];
            v_load4((const float *)&chunk->layer[layer][column], index, 1, packed);
            const vf opacity = unpack(packed, rgb);
            const vf weight = v_select(open, through * opacity, zero);
            for (int c = 0; c < 3; c++) color[c] += v_select(open, weight * rgb[c], zero);
            through = v_select(open, through * (one - opacity), through);
            layers += v_select(open, one, zero);
        }
done:
    for (int k = 0; k < 3; k++) v_store(line->color[k] + at, color[k]);
    v_store(line->through + at, through);
    v_store(line->layers + at, layers);
}

/* Clears the line for a group none of whose samples has a fragment. */
ISO_INLINE void clear_line(const iso_layer_line *line, int x, int count) {
    for (int i = 0; i < count; i += ISO_LANES) {
        for (int k = 0; k < 3; k++) v_store(line->color[k] + x + i, v_set(0));
        v_store(line->through + x + i, v_set(1));
        v_store(line->layers + x + i, v_set(0));
    }
}

static void compose(const iso_layer_lists *lists, int row, const iso_layer_line *line,
                    iso_layer_totals *totals) {
    for (int x = 0; x < lists->width; x += ISO_LAYER_GROUP) {
        const iso_layer_group *group = iso_layer_group_at(lists, x, row);
        const int last = lists->width - x < ISO_LAYER_GROUP ? lists->width - x : ISO_LAYER_GROUP;
        if (!group->first) {
            clear_line(line, x, last);
            continue;
        }
        for (int column = 0; column < last; column += ISO_LANES)
            compose_vector(group, column, v_lti(v_lanes(), v_seti(last - column)), line, x + column, totals);
    }
}

/* Computes the shaded colours of the opaque surfaces from sample x on. Lanes that show no surface are
 * undefined. */
ISO_INLINE void shade_back(const iso_layer_back *back, int x, vi surface, vf rgb[3]) {
    const vf normal[3] = {v_load(back->normal[0] + x), v_load(back->normal[1] + x),
                          v_load(back->normal[2] + x)};
    const vf to_eye[3] = {-v_load(back->u + x), v_set(-back->v), v_set(-1)};
    vf base[3];
    for (int k = 0; k < 3; k++) base[k] = v_gather(back->color[k], surface);
    if (back->own_color) replace_colors(back->surface + x, back->own_color + x, base);
    if (back->ambient || back->key)
        phong_open(normal, to_eye, base, back->ambient ? v_load(back->ambient + x) : v_set(1),
                   back->key ? v_load(back->key + x) : v_set(1), rgb);
    else
        phong(normal, to_eye, base, rgb);
    if (back->own_color) leave_unlit(normal, base, rgb);
}

/* The function iso_layer_kernel.add_back. The gbuffer's rows end where the strip ends: only `count` of the
 * last vector's samples are valid. */
static size_t add_back(const iso_layer_back *back, int width, const iso_layer_line *line) {
    const vf zero = v_set(0);
    size_t covered = 0;
    for (int x = 0; x < width; x += ISO_LANES) {
        const vm present = v_lti(v_lanes(), v_seti(width - x));
        vf through = v_load(line->through + x);
        vm shows = v_lt(zero, v_load(line->layers + x));
        if (back->surface) {
            const vi surface = v_load_u8(back->surface + x);
            const vm opaque = v_lti(surface, v_seti(ISO_SURFACE_NONE));
            shows = v_or(shows, opaque);
            if (v_mask(v_and(opaque, present))) {
                vf rgb[3];
                shade_back(back, x, surface, rgb);
                for (int k = 0; k < 3; k++) {
                    const vf color = v_load(line->color[k] + x);
                    v_store(line->color[k] + x, v_select(opaque, color + through * rgb[k], color));
                }
                through = v_select(opaque, zero, through);
            }
        }
        for (int k = 0; k < 3 && !back->transparent; k++)
            v_store(line->color[k] + x, v_load(line->color[k] + x) + through * back->background[k]);
        v_store(line->through + x, through);
        covered += (size_t)__builtin_popcount(v_mask(v_and(shows, present)));
    }
    return covered;
}

/* The function iso_layer_kernel.write. */
static void write(const float *const color[3], const float *through, bool transparent, int width,
                  int32_t *words) {
    const vf one = v_set(1);
    for (int x = 0; x < width; x += ISO_LANES) {
        const vf alpha = transparent ? one - v_load(through + x) : one;
        const vm seen = v_lt(v_set(0), alpha);
        vf rgb[3];
        for (int k = 0; k < 3; k++)
            rgb[k] = v_min(transparent ? v_select(seen, v_load(color[k] + x) / alpha, v_set(0))
                                       : v_load(color[k] + x),
                           one);
        int32_t vector[ISO_LANES];
        v_storei(vector, pack_pixels(rgb, to_byte(alpha)));
        const int count = width - x < ISO_LANES ? width - x : ISO_LANES;
        memcpy(words + x, vector, (size_t)count * sizeof *words);
    }
}

const iso_layer_kernel ISO_KERNEL_NAME(iso_layer_kernel) = {compose, add_back, write};
