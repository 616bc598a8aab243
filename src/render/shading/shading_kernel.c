/* shading_kernel: Phong's model for rows of samples, and their averages. */
#include "render/shading/shading_kernel.h"

#include <string.h>

#include "base/simd.h"
#include "render/shading/phong_simd.h"

enum {
    TILE = 1024, /* columns of samples that are shaded in all rows before the next ones, so that their u stay
                    in the cache */
    SUMS = 4     /* red, green, blue, number of samples */
};

/* Samples of one row, from the first column of a tile on. */
typedef struct sample_row {
    const float *normal[3];
    const uint8_t *surface;
    const uint32_t *color;            /* iso_gbuffer.color, or NULL */
    const float *light;               /* iso_gbuffer.light, or NULL */
    const float *ambient, *key, *ink; /* of the gbuffer, or NULL */
    const float *u;                   /* the rays are (u, v, 1) */
    float v;
    size_t below; /* offset of the row below, which is prefetched; 0: none */
} sample_row;

static sample_row row_at(const iso_shade_params *params, const float *u, int x, int y) {
    const iso_gbuffer *g = params->strip->gbuffer;
    const iso_view *view = params->strip->view;
    size_t at = (size_t)y * (size_t)g->width + (size_t)x;
    return (sample_row){{g->normal[0] + at, g->normal[1] + at, g->normal[2] + at},
                        g->surface + at,
                        g->color ? g->color + at : NULL,
                        g->light ? g->light + at : NULL,
                        g->ambient ? g->ambient + at : NULL,
                        g->key ? g->key + at : NULL,
                        g->ink ? g->ink + at : NULL,
                        u,
                        iso_slope_of_row(view, y),
                        y + 1 < g->height ? (size_t)g->width : 0};
}

/* Copy of the last samples of a row, when they do not fill a vector; the rest shows no surface. */
typedef struct last_samples {
    float normal[3][ISO_LANES_MAX], light[ISO_LANES_MAX], ambient[ISO_LANES_MAX], key[ISO_LANES_MAX],
        ink[ISO_LANES_MAX], u[ISO_LANES_MAX];
    uint8_t surface[ISO_LANES_MAX];
    uint32_t color[ISO_LANES_MAX];
} last_samples;

static sample_row copy_last(const sample_row *row, int at, int count, last_samples *last) {
    *last = (last_samples){0};
    memset(last->surface, ISO_SURFACE_NONE, sizeof last->surface);
    size_t floats = (size_t)count * sizeof(float);
    for (int axis = 0; axis < 3; axis++) memcpy(last->normal[axis], row->normal[axis] + at, floats);
    memcpy(last->u, row->u + at, floats);
    memcpy(last->surface, row->surface + at, (size_t)count);
    if (row->light) memcpy(last->light, row->light + at, floats);
    if (row->ambient) memcpy(last->ambient, row->ambient + at, floats);
    if (row->key) memcpy(last->key, row->key + at, floats);
    if (row->ink) memcpy(last->ink, row->ink + at, floats);
    if (row->color) memcpy(last->color, row->color + at, (size_t)count * sizeof *last->color);
    return (sample_row){{last->normal[0], last->normal[1], last->normal[2]},
                        last->surface,
                        row->color ? last->color : NULL,
                        row->light ? last->light : NULL,
                        row->ambient ? last->ambient : NULL,
                        row->key ? last->key : NULL,
                        row->ink ? last->ink : NULL,
                        last->u,
                        row->v,
                        0};
}

/* Adds up the `factor` columns of each pixel. */
static void add_columns(float columns[SUMS][TILE + ISO_LANES_MAX], int factor, int pixels,
                        float sums[SUMS][TILE + ISO_LANES_MAX]) {
    for (int k = 0; k < SUMS; k++)
        for (int x = 0; x < pixels; x++) {
            float sum = columns[k][x * factor];
            for (int i = 1; i < factor; i++) sum += columns[k][x * factor + i];
            sums[k][x] = sum;
        }
}

/* Returns a bit for each of the samples from `at` on: set if it shows a surface. */
ISO_INLINE uint32_t covered_mask(const sample_row *row, int at) {
    uint32_t empty = v_mask(v_eqi(v_load_u8(row->surface + at), v_seti(ISO_SURFACE_NONE)));
    return ~empty & (uint32_t)((1u << ISO_LANES) - 1);
}

/* Looks up the colours of the samples' surfaces. Only lanes in `covered`, which must not be 0, are
 * defined. */
ISO_INLINE void find_colors(const iso_shade_params *params, const uint8_t *surface, uint32_t covered,
                            vf base[3]) {
    uint8_t first = surface[__builtin_ctz(covered)];
    bool same = params->one_color || (v_mask(v_eqi(v_load_u8(surface), v_seti(first))) & covered) == covered;
    for (int c = 0; c < 3; c++) base[c] = v_set(params->base[c][first]);
    if (same) return;
    for (int c = 0; c < 3; c++) {
        float lanes[ISO_LANES];
        for (int lane = 0; lane < ISO_LANES; lane++) lanes[lane] = params->base[c][surface[lane]];
        base[c] = v_load(lanes);
    }
}

/* Computes the colours of the samples from `at` on, of normals `n`, in their light. */
ISO_INLINE void light_samples(const sample_row *row, int at, const vf n[3], const vf base[3], vf rgb[3]) {
    if (row->light) {
        for (int c = 0; c < 3; c++) rgb[c] = base[c] * v_load(row->light + at);
        return;
    }
    const vf to_eye[3] = {-v_load(row->u + at), v_set(-row->v), v_set(-1)};
    if (!row->ambient && !row->key) {
        phong(n, to_eye, base, rgb);
        return;
    }
    phong_open(n, to_eye, base, row->ambient ? v_load(row->ambient + at) : v_set(1),
               row->key ? v_load(row->key + at) : v_set(1), rgb);
}

/* Computes the colours of the samples from `at` on, with the lines of the outline. Only lanes in `covered`,
 * which must not be 0, are defined. */
ISO_INLINE void shade_samples(const iso_shade_params *params, const sample_row *row, int at, uint32_t covered,
                              vf rgb[3]) {
    vf base[3];
    const vf n[3] = {v_load(row->normal[0] + at), v_load(row->normal[1] + at), v_load(row->normal[2] + at)};
    find_colors(params, row->surface + at, covered, base);
    if (row->color) replace_colors(row->surface + at, row->color + at, base);
    light_samples(row, at, n, base, rgb);
    if (row->color) leave_unlit(n, base, rgb);
    if (!row->ink) return;
    const vf ink = v_load(row->ink + at);
    for (int c = 0; c < 3; c++) rgb[c] += (v_set(params->ink[c]) - rgb[c]) * ink;
}

/* ---- one sample a pixel */

/* Returns the pixels of the samples from `at` on; `empty` where there is no surface. */
ISO_INLINE vi shade_pixels(const iso_shade_params *params, const sample_row *row, int at, uint32_t covered,
                           vi empty) {
    if (!covered) return empty;
    vf rgb[3];
    shade_samples(params, row, at, covered, rgb);
    return v_selecti(v_from_mask(covered), pack_pixels(rgb, v_seti(255)), empty);
}

/* Prefetches the pixels of the row below and, where this row shows a surface, the normals of the row
 * below. */
ISO_INLINE void prefetch_below(const sample_row *row, int at, uint32_t covered, const uint8_t *rgba) {
    __builtin_prefetch(rgba + 4 * (row->below + (size_t)at), 1, 2);
    for (int axis = 0; covered && axis < 3; axis++)
        __builtin_prefetch(row->normal[axis] + row->below + (size_t)at, 0, 2);
}

/* Shades a row of `count` samples; returns how many show a surface. */
static size_t shade_single_samples(const iso_shade_params *params, const sample_row *row, int count,
                                   uint8_t *rgba) {
    int32_t word, last_pixels[ISO_LANES_MAX];
    memcpy(&word, params->empty, sizeof word);
    const vi empty = v_seti(word);
    size_t total = 0;
    int at = 0;
    for (; at + ISO_LANES <= count; at += ISO_LANES) {
        uint32_t covered = covered_mask(row, at);
        if (row->below) prefetch_below(row, at, covered, rgba);
        vi pixels = shade_pixels(params, row, at, covered, empty);
        memcpy(rgba + 4 * at, &pixels, sizeof pixels);
        total += (size_t)__builtin_popcount(covered);
    }
    if (at == count) return total;
    last_samples last;
    sample_row rest = copy_last(row, at, count - at, &last);
    uint32_t covered = covered_mask(&rest, 0);
    v_storei(last_pixels, shade_pixels(params, &rest, 0, covered, empty));
    memcpy(rgba + 4 * at, last_pixels, (size_t)(count - at) * 4);
    return total + (size_t)__builtin_popcount(covered);
}

/* ---- several samples a pixel: sums of columns first, then of pixels */

/* Adds the shaded samples from `at` on to the sums of their columns. Colours are rounded to 0 .. 255 before
 * they are added, so that key images, which hold rounded colours, have the same means. */
ISO_INLINE size_t add_samples(const iso_shade_params *params, const sample_row *row, int at, vf sums[SUMS]) {
    uint32_t covered = covered_mask(row, at);
    if (!covered) return 0;
    vm mask = v_from_mask(covered);
    vf rgb[3];
    shade_samples(params, row, at, covered, rgb);
    for (int c = 0; c < 3; c++) sums[c] += v_select(mask, v_to_float(to_byte(rgb[c])), v_set(0));
    sums[3] += v_select(mask, v_set(1), v_set(0));
    return (size_t)__builtin_popcount(covered);
}

/* Sums the columns of the `factor` rows of samples of a row of pixels. */
static size_t sum_columns(const iso_shade_params *params, const sample_row *rows, int count,
                          float columns[SUMS][TILE + ISO_LANES_MAX]) {
    size_t total = 0;
    for (int at = 0; at < count; at += ISO_LANES) {
        vf sums[SUMS] = {v_set(0), v_set(0), v_set(0), v_set(0)};
        for (int j = 0; j < params->strip->factor; j++) {
            if (at + ISO_LANES <= count) {
                total += add_samples(params, &rows[j], at, sums);
            } else {
                last_samples last;
                sample_row rest = copy_last(&rows[j], at, count - at, &last);
                total += add_samples(params, &rest, 0, sums);
            }
        }
        for (int k = 0; k < SUMS; k++) v_store(columns[k] + at, sums[k]);
    }
    return total;
}

/* Computes the means of pixels, blended with the background or stored with alpha. */
static void resolve_pixels(const iso_shade_params *params, float sums[SUMS][TILE + ISO_LANES_MAX], int pixels,
                           uint8_t *rgba) {
    int samples = params->strip->factor * params->strip->factor;
    int32_t word, words[TILE + ISO_LANES_MAX];
    memcpy(&word, params->empty, sizeof word);
    for (int x = 0; x < pixels; x += ISO_LANES) {
        vf covered = v_load(sums[3] + x), part = covered / v_set((float)samples), rgb[3];
        for (int c = 0; c < 3; c++) {
            rgb[c] = v_load(sums[c] + x) / (v_max(covered, v_set(1)) * v_set(255));
            if (!params->transparent)
                rgb[c] = rgb[c] * part + v_set(params->background[c]) * (v_set(1) - part);
        }
        vi alpha = params->transparent ? to_byte(part) : v_seti(255);
        vi pixel = pack_pixels(rgb, alpha);
        v_storei(words + x, v_selecti(v_lt(v_set(0), covered), pixel, v_seti(word)));
    }
    memcpy(rgba, words, (size_t)pixels * 4);
}

static size_t shade_averages(const iso_shade_params *params, const sample_row *rows, int pixels,
                             uint8_t *rgba) {
    float columns[SUMS][TILE + ISO_LANES_MAX], sums[SUMS][TILE + ISO_LANES_MAX];
    int factor = params->strip->factor;
    size_t total = sum_columns(params, rows, pixels * factor, columns);
    for (int k = 0; k < SUMS; k++) memset(sums[k] + pixels, 0, ISO_LANES * sizeof(float));
    add_columns(columns, factor, pixels, sums);
    resolve_pixels(params, sums, pixels, rgba);
    return total;
}

size_t ISO_KERNEL_NAME(iso_shade_rows)(const iso_shade_params *params, int first, int last) {
    const iso_strip *strip = params->strip;
    int factor = strip->factor, width = strip->gbuffer->width / factor, tile = TILE / factor;
    size_t total = 0;
    float u[TILE];
    for (int x = 0; x < width; x += tile) {
        int pixels = width - x < tile ? width - x : tile;
        for (int i = 0; i < pixels * factor; i++) u[i] = iso_slope_of_column(strip->view, x * factor + i);
        for (int y = first; y <= last; y++) {
            uint8_t *rgba = params->rgba + ((size_t)y * (size_t)width + (size_t)x) * 4;
            sample_row rows[ISO_FACTOR_MAX];
            for (int j = 0; j < factor; j++) rows[j] = row_at(params, u, x * factor, y * factor + j);
            total += factor == 1 ? shade_single_samples(params, rows, pixels, rgba)
                                 : shade_averages(params, rows, pixels, rgba);
        }
    }
    return total;
}

/* ---- the means of samples that are shaded already */

/* Sums of the samples of columns, or of pixels, in 16 bits each: red and blue, green and alpha. */
typedef struct packed_sums {
    int32_t red_blue[TILE + ISO_LANES_MAX], green_alpha[TILE + ISO_LANES_MAX];
} packed_sums;

/* Sums the `factor` rows of `count` columns; `stride`: of the samples' rows. */
static void sum_shaded(const int32_t *samples, size_t stride, int factor, int count, packed_sums *columns) {
    const vi bytes = v_seti(0x00ff00ff);
    int at = 0;
    for (; at + ISO_LANES <= count; at += ISO_LANES) {
        vi red_blue = v_seti(0), green_alpha = v_seti(0);
        for (int j = 0; j < factor; j++) {
            const vi sample = v_loadi(samples + (size_t)j * stride + (size_t)at);
            red_blue += sample & bytes;
            green_alpha += sample >> 8 & bytes;
        }
        v_storei(columns->red_blue + at, red_blue);
        v_storei(columns->green_alpha + at, green_alpha);
    }
    for (; at < count; at++) {
        columns->red_blue[at] = columns->green_alpha[at] = 0;
        for (int j = 0; j < factor; j++) {
            const int32_t sample = samples[(size_t)j * stride + (size_t)at];
            columns->red_blue[at] += sample & 0x00ff00ff;
            columns->green_alpha[at] += sample >> 8 & 0x00ff00ff;
        }
    }
}

/* Sums the `factor` columns of each pixel, in place; the pixels up to a whole vector get 0. */
ISO_INLINE void add_packed(packed_sums *sums, int factor, int pixels) {
    for (int x = 0; x < pixels; x++) {
        int32_t red_blue = 0, green_alpha = 0;
        for (int i = x * factor; i < (x + 1) * factor; i++) {
            red_blue += sums->red_blue[i];
            green_alpha += sums->green_alpha[i];
        }
        sums->red_blue[x] = red_blue;
        sums->green_alpha[x] = green_alpha;
    }
    memset(sums->red_blue + pixels, 0, ISO_LANES * sizeof *sums->red_blue);
    memset(sums->green_alpha + pixels, 0, ISO_LANES * sizeof *sums->green_alpha);
}

void ISO_KERNEL_NAME(iso_average_rows)(const iso_shade_params *params, const int32_t *samples) {
    const iso_strip *strip = params->strip;
    const int factor = strip->factor, width = strip->gbuffer->width / factor,
              rows = strip->gbuffer->height / factor, tile = TILE / factor;
    const size_t stride = (size_t)strip->gbuffer->width;
    packed_sums packed;
    float sums[SUMS][TILE + ISO_LANES_MAX];
    for (int y = 0; y < rows; y++, samples += stride * (size_t)factor)
        for (int x = 0; x < width; x += tile) {
            const int pixels = width - x < tile ? width - x : tile;
            sum_shaded(samples + x * factor, stride, factor, pixels * factor, &packed);
            if (factor == 2)
                add_packed(&packed, 2, pixels); /* as vectors */
            else
                add_packed(&packed, factor, pixels);
            for (int i = 0; i < pixels; i += ISO_LANES) {
                const vi red_blue = v_loadi(packed.red_blue + i),
                         green_alpha = v_loadi(packed.green_alpha + i);
                v_store(sums[0] + i, v_to_float(red_blue & 0xffff));
                v_store(sums[1] + i, v_to_float(green_alpha & 0xffff));
                v_store(sums[2] + i, v_to_float(red_blue >> 16));
                v_store(sums[3] + i, v_to_float(((green_alpha >> 16) + 255) >> 8)); /* each is 255 */
            }
            resolve_pixels(params, sums, pixels, params->rgba + ((size_t)y * (size_t)width + (size_t)x) * 4);
        }
}
