/* resolve_simd: writes the samples of a bin in which a shape was drawn: depth, normal, surface and colour,
 * computed from the shape's record. */
#ifndef ISO_RENDER_SHAPES_RESOLVE_SIMD_H
#define ISO_RENDER_SHAPES_RESOLVE_SIMD_H

#include "render/shapes/chunk_simd.h"

/* Loads the records of a vector of pixels; lanes that are not in `seen` get the first record. */
ISO_INLINE void load_records(const iso_shapes_bin *bin, iso_shape_kind kind, vm seen, vi record, vf *words) {
    const int floats = iso_shapes_record_floats(kind);
    const float *records = bin->records.data;
    int32_t index[ISO_LANES];
    v_storei(index, v_selecti(seen, record, v_seti(0)) * floats);
    v_load4(records, index, 2, words);
    if (kind == ISO_SHAPE_SOLID || kind == ISO_SHAPE_RIBBON) v_load4(records + 8, index, 2, words + 8);
    if (kind == ISO_SHAPE_TUBE) v_load4(records + 8, index, 4, words + 8);
}

/* A vector of samples to be written into the gbuffer. */
typedef struct sp_sample {
    vf depth, normal[3], along;
    vi id, flags;
} sp_sample;

ISO_INLINE sp_sample sample_of(const iso_shapes_bin *bin, iso_shape_kind kind, iso_glyph glyph, vm seen,
                               int x, int y, size_t at) {
    const iso_shapes *set = bin->frame->shapes;
    vf words[ISO_TUBE_RECORD];
    load_records(bin, kind, seen, v_loadi(bin->record + at), words);
    const vf *field = words + ISO_RECORD_HEAD;
    const vi pixel_x = v_bits(words[0]), pixel_y = v_bits(words[1]);
    const sp_place centre = place_of(bin->frame, v_to_float(pixel_x), v_to_float(pixel_y), field);
    const vf dx = (v_to_float(v_seti(x) + v_lanes() - pixel_x) + 0.5f) - field[ISO_FIELD_X],
             dy = (v_to_float(v_seti(y) - pixel_y) + 0.5f) - field[ISO_FIELD_Y];
    const sp_pixel p = pixel_of(bin->frame, &centre, dx, dy);
    sp_sample s = {.depth = v_load(bin->depth + at), .id = v_bits(words[2]), .flags = v_bits(words[3])};
    s.along = v_set(0);
    if (kind == ISO_SHAPE_TUBE)
        tube_normal(&p, &centre, field, s.flags, set->caps == ISO_CAPS_FLAT, s.normal, &s.along);
    else if (kind == ISO_SHAPE_RIBBON)
        ribbon_normal(&p, &centre, field, s.normal, &s.along);
    else if (kind == ISO_SHAPE_SPHERE)
        sphere_normal(&p, field, s.normal);
    else
        solid_normal(glyph, &p, &centre, field, s.normal);
    return s;
}

ISO_INLINE void write_all(const iso_gbuffer *g, size_t to, vm seen, const sp_sample *s, int surface) {
    v_store(g->depth + to, v_select(seen, s->depth, v_load(g->depth + to)));
    for (int a = 0; a < 3; a++)
        v_store(g->normal[a] + to, v_select(seen, s->normal[a], v_load(g->normal[a] + to)));
    v_store_u8(g->surface + to, v_selecti(seen, v_seti(surface), v_load_u8(g->surface + to)));
}

ISO_INLINE void write_few(const iso_gbuffer *g, size_t to, uint32_t seen, const sp_sample *s, int surface) {
    float depth[ISO_LANES], normal[3][ISO_LANES];
    v_store(depth, s->depth);
    for (int a = 0; a < 3; a++) v_store(normal[a], s->normal[a]);
    for (; seen; seen &= seen - 1) {
        const int lane = __builtin_ctz(seen);
        g->depth[to + (size_t)lane] = depth[lane];
        for (int a = 0; a < 3; a++) g->normal[a][to + (size_t)lane] = normal[a][lane];
        g->surface[to + (size_t)lane] = (uint8_t)surface;
    }
}

/* Writes colours and elements. */
ISO_INLINE void write_ids(const iso_shapes_frame *frame, size_t to, uint32_t seen, const sp_sample *s) {
    int32_t ids[ISO_LANES];
    float along[ISO_LANES];
    v_storei(ids, s->id);
    v_store(along, s->along);
    for (; seen; seen &= seen - 1) {
        const int lane = __builtin_ctz(seen);
        iso_shapes_write_color(frame, to + (size_t)lane, (uint32_t)ids[lane], along[lane]);
        iso_shapes_write_element(frame, to + (size_t)lane, (uint32_t)ids[lane]);
    }
}

/* Writes a vector of pixels from (x, y) on. */
ISO_INLINE void resolve_pixels(iso_shapes_bin *bin, iso_shape_kind kind, iso_glyph glyph, int x, int y) {
    const iso_target *target = bin->frame->target;
    const iso_gbuffer *g = target->gbuffer;
    const size_t at = iso_shapes_pixel(bin, x, y),
                 to = (size_t)(y - bin->frame->top) * (size_t)g->width + (size_t)x;
    const vm seen = v_lti(v_seti(ISO_SHAPES_NONE), v_loadi(bin->record + at));
    const uint32_t mask = v_mask(seen);
    if (!mask) return;
    const sp_sample s = sample_of(bin, kind, glyph, seen, x, y, at);
    if (x + ISO_LANES <= bin->rect.x1 + 1) /* the pixels beyond are another thread's */
        write_all(g, to, seen, &s, target->surface);
    else
        write_few(g, to, mask, &s, target->surface);
    if (bin->frame->shapes->colors || g->element) write_ids(bin->frame, to, mask, &s);
    const vm widened = v_lti(v_seti(0), s.flags & ISO_TUBE_WIDENED);
    bin->drawn.samples += (size_t)__builtin_popcount(mask);
    bin->drawn.widened += (size_t)__builtin_popcount(mask & v_mask(widened));
}

ISO_INLINE void resolve_kind(iso_shapes_bin *bin, iso_shape_kind kind, iso_glyph glyph) {
    for (int y = bin->rect.y0; y <= bin->rect.y1; y++)
        for (int x = bin->rect.x0; x <= bin->rect.x1; x += ISO_LANES) resolve_pixels(bin, kind, glyph, x, y);
}

/* Calls resolve_pixels with a constant for each kind of glyph, so that each has a loop of its own. */
static void resolve_solids(iso_shapes_bin *bin) {
    const iso_shape_kind solid = ISO_SHAPE_SOLID;
    switch (bin->frame->shapes->glyph) {
    case ISO_GLYPH_CONE:
        resolve_kind(bin, solid, ISO_GLYPH_CONE);
        break;
    case ISO_GLYPH_CYLINDER:
        resolve_kind(bin, solid, ISO_GLYPH_CYLINDER);
        break;
    case ISO_GLYPH_ARROW:
        resolve_kind(bin, solid, ISO_GLYPH_ARROW);
        break;
    case ISO_GLYPH_DISC:
        resolve_kind(bin, solid, ISO_GLYPH_DISC);
        break;
    case ISO_GLYPH_BOX:
        resolve_kind(bin, solid, ISO_GLYPH_BOX);
        break;
    default:
        resolve_kind(bin, solid, ISO_GLYPH_ELLIPSOID);
    }
}

static void resolve(iso_shapes_bin *bin) {
    if (!bin->record_count) return;
    const iso_shape_kind kind = iso_shapes_kind(bin->frame->shapes);
    if (kind == ISO_SHAPE_TUBE)
        resolve_kind(bin, ISO_SHAPE_TUBE, ISO_GLYPH_SPHERE);
    else if (kind == ISO_SHAPE_RIBBON)
        resolve_kind(bin, ISO_SHAPE_RIBBON, ISO_GLYPH_SPHERE);
    else if (kind == ISO_SHAPE_SPHERE)
        resolve_kind(bin, ISO_SHAPE_SPHERE, ISO_GLYPH_SPHERE);
    else
        resolve_solids(bin);
}

#endif
