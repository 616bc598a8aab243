/* chunk_simd: draws the shapes of a chunk into a bin, each in its own way. Part of the kernel of shapes. */
#ifndef ISO_RENDER_SHAPES_CHUNK_SIMD_H
#define ISO_RENDER_SHAPES_CHUNK_SIMD_H

#include "render/shapes/patch_simd.h"
#include "render/shapes/ribbon_simd.h"
#include "render/shapes/solid_simd.h"
#include "render/shapes/sphere_simd.h"
#include "render/shapes/tube_simd.h"

/* ---- tiles: the farthest depth of 8 x 8 pixels */

ISO_INLINE void measure_tiles(iso_shapes_bin *bin, int x0, int y0, int x1, int y1) {
    for (int row = y0 / ISO_SHAPES_TILE; row <= y1 / ISO_SHAPES_TILE; row++)
        for (int column = x0 / ISO_SHAPES_TILE; column <= x1 / ISO_SHAPES_TILE; column++) {
            const float *depth =
                bin->depth + row * ISO_SHAPES_TILE * ISO_SHAPES_PITCH + column * ISO_SHAPES_TILE;
            vf most = patch_load(depth);
            for (int y = 0; y < ISO_SHAPES_TILE; y += PATCH_HEIGHT)
                for (int x = 0; x < ISO_SHAPES_TILE; x += PATCH_WIDTH)
                    most = v_max(most, patch_load(depth + y * ISO_SHAPES_PITCH + x));
            bin->farthest[row * ISO_SHAPES_TILE_PITCH + column] = largest(most);
        }
}

static void measure(iso_shapes_bin *bin) {
    measure_tiles(bin, 0, 0, ISO_SHAPES_BIN - 1, ISO_SHAPES_BIN - 1);
}

/* Whether something nearer than `nearest` is seen in all tiles of columns x0 .. x1, rows y0 .. y1. */
ISO_INLINE bool tiles_hidden(const iso_shapes_bin *bin, int x0, int y0, int x1, int y1, float nearest) {
    for (int y = y0; y <= y1; y++)
        for (int x = x0; x <= x1; x += ISO_LANES) {
            const float *tiles = bin->farthest + y * ISO_SHAPES_TILE_PITCH + x;
            uint32_t open = v_mask(v_lt(v_set(nearest), v_load(tiles)));
            if (x1 - x + 1 < ISO_LANES) open &= (1u << (x1 - x + 1)) - 1;
            if (open) return false;
        }
    return true;
}

static bool hidden(const iso_shapes_bin *bin, const iso_shapes_rect *rect, float nearest) {
    const iso_shapes_rect *r = &bin->rect;
    return tiles_hidden(bin, (rect->x0 - r->x0) / ISO_SHAPES_TILE, (rect->y0 - r->y0) / ISO_SHAPES_TILE,
                        (rect->x1 - r->x0) / ISO_SHAPES_TILE, (rect->y1 - r->y0) / ISO_SHAPES_TILE, nearest);
}

/* ---- drawing */

/* How a shape is drawn: each way has a loop of its own, because functions with the argument `way` are inlined
 * with a constant. */
enum {
    DRAW_SPHERE,
    DRAW_EVEN_TUBE, /* both radii are equal */
    DRAW_TUBE,
    DRAW_CUT_TUBE, /* with flat caps */
    DRAW_RIBBON,
    DRAW_SOLID /* the way of a glyph is this number plus its iso_glyph */
};

/* Which pixels see the shape, and at which depth. */
ISO_INLINE vm shape_depth(int way, const sp_pixel *p, const vf *field, int flags, vf *depth) {
    if (way == DRAW_SPHERE) return sphere_depth(p, field, depth);
    if (way >= DRAW_SOLID) return solid_depth((iso_glyph)(way - DRAW_SOLID), p, field, depth);
    if (way == DRAW_RIBBON) {
        vf s, t;
        return meet_ribbon(p, field, &s, &t, depth);
    }
    sp_meeting m;
    meet_tube(p, field, way != DRAW_EVEN_TUBE, &m);
    if (way == DRAW_CUT_TUBE) cut_tube(p, field, v_seti(flags), &m);
    *depth = m.depth;
    return m.hit;
}

/* A shape of the chunk, ready to be drawn. */
typedef struct sp_shape {
    sp_place at;
    vf field[ISO_SHAPES_FIELDS];
    float nearest;
    int flags, ox, oy; /* ox, oy: from the shape's pixel to the bin's corner */
} sp_shape;

/* Draws a patch, whose first pixel is depth[0]; returns which of its pixels the shape won. */
ISO_INLINE uint32_t draw_patch(iso_shapes_bin *bin, int way, const sp_shape *s, float *depth, vf dx, vf dy) {
    const vf old = patch_load(depth);
    vm open = v_lt(v_set(s->nearest), old);
    if (!v_mask(open)) return 0;
    const sp_pixel p = pixel_of(bin->frame, &s->at, dx, dy);
    vf z;
    open = v_and(open, shape_depth(way, &p, s->field, s->flags, &z));
    if (!v_mask(open)) return 0;
    open = v_and(open, v_lt(z, old));
    const uint32_t won = v_mask(open);
    if (won) patch_store(depth, bin->record + (depth - bin->depth), open, z, (int32_t)bin->record_count);
    return won;
}

/* Pixels of the bin, counted from its corner. */
typedef struct sp_box {
    int x0, y0, x1, y1;
} sp_box;

/* From this size on, tiles are tested one by one. */
enum { SMALL_WIDTH = 12, SMALL_HEIGHT = 16 };

/* Draws the pixels of a box in patches. */
ISO_INLINE bool draw_box(iso_shapes_bin *bin, int way, const sp_shape *s, sp_box b) {
    uint32_t won = 0;
    for (int y = b.y0; y <= b.y1; y += PATCH_HEIGHT) {
        const vf dy = (v_set((float)(y + s->oy)) + patch_rows()) - s->field[ISO_FIELD_Y];
        float *depth = bin->depth + (ptrdiff_t)y * ISO_SHAPES_PITCH + b.x0;
        for (int x = b.x0; x <= b.x1; x += PATCH_WIDTH, depth += PATCH_WIDTH) {
            const vf dx = (v_set((float)(x + s->ox)) + patch_columns()) - s->field[ISO_FIELD_X];
            won |= draw_patch(bin, way, s, depth, dx, dy);
        }
    }
    return won;
}

/* The same as draw_box for large boxes: tiles in which the shape is hidden are left out. */
ISO_INLINE bool draw_tiles(iso_shapes_bin *bin, int way, const sp_shape *s, sp_box b) {
    const int tile = ISO_SHAPES_TILE;
    bool any = false;
    for (int y = b.y0 / tile * tile; y <= b.y1; y += tile)
        for (int x = b.x0 / tile * tile; x <= b.x1; x += tile) {
            if (!(s->nearest < bin->farthest[y / tile * ISO_SHAPES_TILE_PITCH + x / tile])) continue;
            const sp_box part = {x, b.y0 > y ? b.y0 & ~(PATCH_HEIGHT - 1) : y, x + tile - 1,
                                 b.y1 < y + tile - 1 ? b.y1 : y + tile - 1};
            if (!draw_box(bin, way, s, part)) continue;
            measure_tiles(bin, x, y, x, y);
            any = true;
        }
    return any;
}

/* Draws shape i of the chunk. Returns whether it is the nearest so far in at least one pixel. Sets *measured:
 * the farthest depths of its tiles are up to date; after small shapes the caller measures tiles. */
ISO_INLINE bool draw_shape(iso_shapes_bin *bin, int way, int i, sp_box b, bool *measured) {
    const iso_shapes_chunk *c = &bin->chunk;
    sp_shape s; /* not initialised: it has room for more fields than this kind of shape has */
    s.nearest = c->nearest[i];
    s.flags = c->flags[i];
    s.ox = bin->rect.x0 - c->pixel_x[i];
    s.oy = bin->rect.y0 - c->pixel_y[i];
    const int fields = way == DRAW_SPHERE   ? ISO_SPHERE_FIELDS
                       : way == DRAW_RIBBON ? ISO_RIBBON_FIELDS
                       : way < DRAW_SOLID   ? ISO_TUBE_FIELDS
                                            : ISO_SOLID_FIELDS;
    for (int k = 0; k < fields; k++) s.field[k] = v_set(c->field[k][i]);
    s.at = place_of(bin->frame, v_set((float)c->pixel_x[i]), v_set((float)c->pixel_y[i]), s.field);
    *measured = b.x1 - b.x0 >= SMALL_WIDTH || b.y1 - b.y0 >= SMALL_HEIGHT;
    return *measured ? draw_tiles(bin, way, &s, b) : draw_box(bin, way, &s, b);
}

/* draw_shape, not inlined, for each way except that of spheres. */
#define DRAW_WAY(name, way)                                                                                  \
    static bool name(iso_shapes_bin *bin, int i, sp_box b, bool *measured) {                                 \
        return draw_shape(bin, way, i, b, measured);                                                         \
    }
DRAW_WAY(draw_even_tube, DRAW_EVEN_TUBE)
DRAW_WAY(draw_tube, DRAW_TUBE)
DRAW_WAY(draw_cut_tube, DRAW_CUT_TUBE)
DRAW_WAY(draw_ribbon, DRAW_RIBBON)
DRAW_WAY(draw_cone, DRAW_SOLID + ISO_GLYPH_CONE)
DRAW_WAY(draw_cylinder, DRAW_SOLID + ISO_GLYPH_CYLINDER)
DRAW_WAY(draw_arrow, DRAW_SOLID + ISO_GLYPH_ARROW)
DRAW_WAY(draw_ellipsoid, DRAW_SOLID + ISO_GLYPH_ELLIPSOID)
DRAW_WAY(draw_disc, DRAW_SOLID + ISO_GLYPH_DISC)
DRAW_WAY(draw_cuboid, DRAW_SOLID + ISO_GLYPH_BOX)
#undef DRAW_WAY

typedef bool draw_way(iso_shapes_bin *bin, int i, sp_box b, bool *measured);

ISO_INLINE draw_way *way_of_tube(const iso_shapes_chunk *c, int i) {
    if (c->flags[i] & (ISO_TUBE_CUT_FIRST | ISO_TUBE_CUT_LAST)) return draw_cut_tube;
    return c->field[ISO_FIELD_SINE][i] == 0 ? draw_even_tube : draw_tube;
}

ISO_INLINE bool draw_by_kind(iso_shapes_bin *bin, iso_shape_kind kind, int i, sp_box b, bool *measured) {
    static draw_way *const solids[ISO_GLYPH_COUNT] = {
        [ISO_GLYPH_CONE] = draw_cone,   [ISO_GLYPH_CYLINDER] = draw_cylinder,
        [ISO_GLYPH_ARROW] = draw_arrow, [ISO_GLYPH_ELLIPSOID] = draw_ellipsoid,
        [ISO_GLYPH_DISC] = draw_disc,   [ISO_GLYPH_BOX] = draw_cuboid};
    if (kind == ISO_SHAPE_SPHERE) return draw_shape(bin, DRAW_SPHERE, i, b, measured);
    if (kind == ISO_SHAPE_TUBE) return way_of_tube(&bin->chunk, i)(bin, i, b, measured);
    if (kind == ISO_SHAPE_RIBBON) return draw_ribbon(bin, i, b, measured);
    return solids[bin->frame->shapes->glyph](bin, i, b, measured);
}

ISO_INLINE void write_record(iso_shapes_bin *bin, int i, size_t floats) {
    const iso_shapes_chunk *c = &bin->chunk;
    float *record = (float *)bin->records.data + bin->record_count++ * floats;
    memcpy(record, &c->pixel_x[i], sizeof *record);
    memcpy(record + 1, &c->pixel_y[i], sizeof *record);
    memcpy(record + 2, &c->id[i], sizeof *record);
    memcpy(record + 3, &c->flags[i], sizeof *record);
    for (size_t k = 0; k < floats - ISO_RECORD_HEAD; k++) record[ISO_RECORD_HEAD + k] = c->field[k][i];
}

/* Draws the shapes of the chunk, and keeps the records of those that are the nearest in some pixel. */
ISO_INLINE void draw_chunk(iso_shapes_bin *bin, iso_shape_kind kind) {
    const iso_shapes_chunk *c = &bin->chunk;
    sp_box all = {ISO_SHAPES_BIN, ISO_SHAPES_BIN, -1, -1};
    for (int i = 0; i < c->count; i++) {
        const sp_box b = {c->x0[i] - bin->rect.x0, c->y0[i] - bin->rect.y0, c->x1[i] - bin->rect.x0,
                          c->y1[i] - bin->rect.y0};
        bool measured;
        if (!draw_by_kind(bin, kind, i, b, &measured)) continue;
        write_record(bin, i, (size_t)iso_shapes_record_floats(kind));
        if (measured) continue;
        all.x0 = b.x0 < all.x0 ? b.x0 : all.x0;
        all.y0 = b.y0 < all.y0 ? b.y0 : all.y0;
        all.x1 = b.x1 > all.x1 ? b.x1 : all.x1;
        all.y1 = b.y1 > all.y1 ? b.y1 : all.y1;
    }
    if (all.x1 >= 0) measure_tiles(bin, all.x0, all.y0, all.x1, all.y1);
}

/* ---- blocks */

/* Boxes in the picture before clipping, relative to an origin's pixel. */
typedef struct sp_reach {
    vf x0, y0, x1, y1;
} sp_reach;

ISO_INLINE vi clip_low(vf edge, vf size, int32_t at, int32_t limit) {
    const vf low = v_min(v_max(edge - 0.501f - size * 4e-6f, v_set(-FAR)), v_set(FAR));
    const vi first = v_seti(at) - v_floor(-low); /* rounded up */
    return v_selecti(v_lti(first, v_seti(limit)), v_seti(limit), first);
}
ISO_INLINE vi clip_high(vf edge, vf size, int32_t at, int32_t limit) {
    const vf high = v_min(v_max(edge - 0.499f + size * 4e-6f, v_set(-FAR)), v_set(FAR));
    const vi last = v_seti(at) + v_floor(high);
    return v_selecti(v_lti(v_seti(limit), last), v_seti(limit), last);
}

/* The farthest depth of the tiles at the corners of boxes of up to two by two tiles. */
ISO_INLINE vf corner_tiles(const iso_shapes_bin *bin, vi x0, vi y0, vi x1, vi y1) {
    const vi top = y0 * ISO_SHAPES_TILE_PITCH, bottom = y1 * ISO_SHAPES_TILE_PITCH;
    return v_max(v_max(v_gather(bin->farthest, top + x0), v_gather(bin->farthest, top + x1)),
                 v_max(v_gather(bin->farthest, bottom + x0), v_gather(bin->farthest, bottom + x1)));
}

/* Returns which shapes overlap the bin and are not behind the farthest depths of its tiles; sets their
 * boxes. */
ISO_INLINE vm clip(const iso_shapes_bin *bin, const iso_shapes_origin *o, vm wanted, const sp_reach *r,
                   vf nearest, vi to[4]) {
    const iso_shapes_rect *rect = &bin->rect;
    const vf width = r->x1 - r->x0, height = r->y1 - r->y0;
    to[0] = clip_low(r->x0, width, o->column, rect->x0);
    to[1] = clip_low(r->y0, height, o->row, rect->y0);
    to[2] = clip_high(r->x1, width, o->column, rect->x1);
    to[3] = clip_high(r->y1, height, o->row, rect->y1);
    wanted = v_andnot(wanted, v_or(v_lti(to[2], to[0]), v_lti(to[3], to[1])));
    if (!v_mask(wanted)) return wanted;
    vi tile[4];
    for (int k = 0; k < 4; k++)
        tile[k] = v_selecti(wanted, (to[k] - (k & 1 ? rect->y0 : rect->x0)) >> 3, v_seti(0));
    const vm large = v_or(v_lti(v_seti(1), tile[2] - tile[0]), v_lti(v_seti(1), tile[3] - tile[1]));
    const vm open = v_lt(nearest, corner_tiles(bin, tile[0], tile[1], tile[2], tile[3]));
    return v_and(wanted, v_or(large, open));
}

/* Adds shapes to the chunk; x, y: pixels from the origin's pixel to their centres. */
ISO_INLINE void add_shapes(iso_shapes_bin *bin, const iso_shapes_origin *o, vm wanted, const vi to[4], vf x,
                           vf y, vi id, vi flags, vf nearest, const vf *rest, int rest_count) {
    iso_shapes_chunk *c = &bin->chunk;
    x = v_select(wanted, x, v_set(0)), y = v_select(wanted, y, v_set(0));
    const vi column = v_floor(x), row = v_floor(y);
    const int n = c->count;
    v_compressi(c->x0 + n, wanted, to[0]);
    v_compressi(c->y0 + n, wanted, to[1]);
    v_compressi(c->x1 + n, wanted, to[2]);
    v_compressi(c->y1 + n, wanted, to[3]);
    v_compress(c->nearest + n, wanted, nearest);
    v_compressi(c->pixel_x + n, wanted, column + o->column);
    v_compressi(c->pixel_y + n, wanted, row + o->row);
    v_compressi(c->id + n, wanted, id);
    v_compressi(c->flags + n, wanted, flags);
    v_compress(c->field[ISO_FIELD_X] + n, wanted, x - v_to_float(column));
    v_compress(c->field[ISO_FIELD_Y] + n, wanted, y - v_to_float(row));
    for (int k = 0; k < rest_count; k++) v_compress(c->field[ISO_FIELD_Z + k] + n, wanted, rest[k]);
    c->count += __builtin_popcount(v_mask(wanted));
}

#endif
