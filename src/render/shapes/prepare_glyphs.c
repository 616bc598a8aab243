/* prepare_glyphs: sorts glyphs into blocks and stores their positions relative to them. */
#include <math.h>
#include <string.h>

#include "base/cpu.h"
#include "base/memory.h"
#include "render/shapes/prepare.h"
#include "render/shapes/solid.h"

enum {
    WANTED = 128,             /* glyphs of a block, on average */
    SLACK = 2 * ISO_LANES_MAX /* values that can be read past the end of each array */
};

static const double MOST_REACH = 1e30; /* mm: squares of it are finite */

static bool is_drawable(const iso_shapes *shapes, const iso_glyphs *glyphs, uint32_t id) {
    const float *p = glyphs->positions[id];
    const double reach = iso_solid_reach(shapes, id);
    return isfinite(p[0]) && isfinite(p[1]) && isfinite(p[2]) && reach > 0 && reach < MOST_REACH;
}

/* Keeps the numbers of glyphs that can be drawn. */
static uint32_t keep_drawable(const iso_shapes *shapes, const iso_glyphs *glyphs, uint32_t *order) {
    uint32_t count = 0;
    for (size_t i = 0; i < glyphs->count; i++)
        if (is_drawable(shapes, glyphs, order[i])) order[count++] = order[i];
    return count;
}

/* Sets a block's box, and its glyphs' positions relative to it. */
static void fill_block(iso_shapes *shapes, const iso_glyphs *glyphs, iso_shapes_block *block) {
    const uint32_t end = block->first + block->count;
    iso_box box = iso_box_empty();
    for (uint32_t i = block->first; i < end; i++) {
        const uint32_t id = iso_shapes_id(shapes, i);
        const float *p = glyphs->positions[id];
        const float reach = (float)(iso_solid_reach(shapes, id) * (1 + 1e-6));
        iso_box_add(&box, iso_vec3_make((double)p[0], (double)p[1], (double)p[2]));
        iso_shapes_add_bounds(shapes, p, reach);
        if (reach > block->reach) block->reach = reach;
    }
    iso_shapes_set_box(block, &box);
    for (uint32_t i = block->first; i < end; i++) {
        const float *p = glyphs->positions[iso_shapes_id(shapes, i)];
        shapes->x[i] = p[0] - block->origin[0];
        shapes->y[i] = p[1] - block->origin[1];
        shapes->z[i] = p[2] - block->origin[2];
    }
}

/* Makes room for positions and numbers. wide: numbers have more than 24 bits. */
static iso_status reserve(iso_shapes *shapes, bool wide, iso_error *error) {
    const size_t stride = shapes->count + SLACK,
                 bytes = 3 * sizeof *shapes->x + sizeof *shapes->id_low + (wide ? 2 : 1);
    shapes->x = iso_alloc_zero(stride, bytes);
    if (!shapes->x) return iso_fail_memory(error, "shapes");
    shapes->y = shapes->x + stride;
    shapes->z = shapes->y + stride;
    shapes->id_low = (uint16_t *)(shapes->z + stride);
    if (wide)
        shapes->id_high_wide = shapes->id_low + stride;
    else
        shapes->id_high = (uint8_t *)(shapes->id_low + stride);
    shapes->bytes += stride * bytes;
    return ISO_OK;
}

static void set_id(iso_shapes *shapes, size_t place, uint32_t id) {
    shapes->id_low[place] = (uint16_t)id;
    if (shapes->id_high)
        shapes->id_high[place] = (uint8_t)(id >> 16);
    else
        shapes->id_high_wide[place] = (uint16_t)(id >> 16);
}

/* The numbers of radii: a hash table of their bits. */
enum { SIZE_SLOTS = 4 * ISO_SHAPES_SIZES, SIZE_SHIFT = 32 - 10 };
typedef struct size_table {
    int count;
    uint16_t number[SIZE_SLOTS]; /* of the radius, from 1; 0: the slot is free */
    uint32_t bits[SIZE_SLOTS];
} size_table;

/* Returns the number of a radius, which may be a new one; -1 when there are too many. */
static int number_size(size_table *table, float radius, float *sizes) {
    uint32_t bits;
    memcpy(&bits, &radius, sizeof bits);
    uint32_t slot = bits * 2654435769u >> SIZE_SHIFT;
    while (table->number[slot] && table->bits[slot] != bits) slot = (slot + 1) % SIZE_SLOTS;
    if (table->number[slot]) return table->number[slot] - 1;
    if (table->count == ISO_SHAPES_SIZES) return -1;
    table->bits[slot] = bits;
    sizes[table->count] = radius;
    table->number[slot] = (uint16_t)++table->count;
    return table->count - 1;
}

/* Sets the numbers of the spheres' radii, if they have few. */
static iso_status number_sizes(iso_shapes *shapes, iso_error *error) {
    if (shapes->kind != ISO_SHAPE_SPHERE || !shapes->radii) return ISO_OK;
    size_table table = {0};
    const size_t bytes = ISO_SHAPES_SIZES * sizeof *shapes->sizes + shapes->count + SLACK;
    int number = 0;
    shapes->sizes = iso_alloc_zero(1, bytes);
    if (!shapes->sizes) return iso_fail_memory(error, "shapes");
    shapes->size = (uint8_t *)(shapes->sizes + ISO_SHAPES_SIZES);
    for (size_t i = 0; i < shapes->count && number >= 0; i++) {
        number = number_size(&table, iso_shapes_radius(shapes, iso_shapes_id(shapes, i)), shapes->sizes);
        shapes->size[i] = (uint8_t)number;
    }
    if (number >= 0) {
        shapes->bytes += bytes;
        return ISO_OK;
    }
    iso_free(shapes->sizes);
    shapes->sizes = NULL;
    shapes->size = NULL;
    return ISO_OK;
}

static iso_status store(iso_shapes *shapes, const iso_glyphs *glyphs, const iso_shapes_sort *sort,
                        iso_error *error) {
    ISO_TRY(iso_shapes_make_blocks(shapes, sort, (uint32_t)shapes->count, error));
    ISO_TRY(reserve(shapes, glyphs->count > (size_t)1 << 24, error));
    for (size_t i = 0; i < shapes->count; i++) set_id(shapes, i, sort->order[i]);
    for (size_t i = 0; i < shapes->block_count; i++) fill_block(shapes, glyphs, &shapes->blocks[i]);
    return number_sizes(shapes, error);
}

static iso_status sort_glyphs(iso_shapes *shapes, const iso_glyphs *glyphs, iso_shapes_sort *sort,
                              iso_error *error) {
    ISO_TRY(iso_shapes_sort_make((const float(*)[3])glyphs->positions, glyphs->count, sort, error));
    sort->wanted = WANTED;
    sort->most = ISO_SHAPES_BLOCK;
    shapes->count = keep_drawable(shapes, glyphs, sort->order);
    shapes->skipped = glyphs->count - shapes->count;
    ISO_TRY(iso_shapes_sort_run(sort, (uint32_t)shapes->count, error));
    return store(shapes, glyphs, sort, error);
}

static iso_status check(const iso_glyphs *glyphs, const iso_shapes_opts *opts, iso_error *error) {
    ISO_TRY(iso_shapes_check(opts, error));
    const iso_glyph glyph = opts->glyph;
    const bool axes = glyph == ISO_GLYPH_ELLIPSOID || glyph == ISO_GLYPH_BOX,
               sized = glyphs->radii || opts->radius > 0;
    if (glyph < 0 || glyph >= ISO_GLYPH_COUNT)
        return iso_fail(error, ISO_ERR_USAGE, "unknown glyph %d", (int)glyph);
    if (opts->projection != ISO_GLYPH_PROJECTION_EXACT && opts->projection != ISO_GLYPH_PROJECTION_BILLBOARD)
        return iso_fail(error, ISO_ERR_USAGE, "unknown projection of glyphs %d", (int)opts->projection);
    if ((glyph == ISO_GLYPH_SPHERE || glyph == ISO_GLYPH_DISC) && !sized)
        return iso_fail(error, ISO_ERR_USAGE, "the glyphs have no radii, and no radius is given");
    if (axes && !glyphs->axes && !sized)
        return iso_fail(error, ISO_ERR_USAGE,
                        "the glyphs have neither axes nor radii, and no radius is given");
    if (!axes && glyph != ISO_GLYPH_SPHERE && !glyphs->directions)
        return iso_fail(error, ISO_ERR_USAGE, "the glyphs have no directions");
    if (glyphs->count >= (size_t)1 << 31)
        return iso_fail(error, ISO_ERR_LIMIT, "%zu glyphs; 2^31 - 1 at most", glyphs->count);
    return ISO_OK;
}

static iso_status from_glyphs(const iso_glyphs *glyphs, const iso_shapes_opts *opts, iso_shapes **shapes,
                              iso_error *error) {
    ISO_TRY(check(glyphs, opts, error));
    iso_shapes *made = iso_shapes_make(opts, glyphs->origin);
    if (!made) return iso_fail_memory(error, "shapes");
    made->kind = opts->glyph == ISO_GLYPH_SPHERE ? ISO_SHAPE_SPHERE : ISO_SHAPE_SOLID;
    made->glyph = opts->glyph;
    made->billboards = opts->projection == ISO_GLYPH_PROJECTION_BILLBOARD;
    made->radii = glyphs->radii;
    made->directions = (const float(*)[3])glyphs->directions;
    made->axes = (const float(*)[9])glyphs->axes;
    made->colors = (const uint8_t(*)[3])glyphs->colors;
    iso_shapes_sort sort = {0};
    const iso_status status = sort_glyphs(made, glyphs, &sort, error);
    iso_shapes_sort_free(&sort);
    if (status == ISO_OK)
        *shapes = made;
    else
        iso_shapes_destroy(made);
    return status;
}

iso_status iso_shapes_from_glyphs(const iso_glyphs *glyphs, const iso_shapes_opts *opts, iso_shapes **shapes,
                                  iso_error *error) {
    iso_shapes_opts resolved = *opts;
    if (isnan(opts->radius)) resolved.radius = iso_glyphs_usual_radius(glyphs, opts->glyph);
    return from_glyphs(glyphs, &resolved, shapes, error);
}
