/* prepare: sorts glyphs into blocks and stores their positions relative to them. */
#include <math.h>
#include <string.h>

#include "base/memory.h"
#include "base/simd.h"
#include "render/shapes/set.h"
#include "render/shapes/sort.h"

enum {
    WANTED = 128,             /* glyphs of a block, on average */
    SLACK = 2 * ISO_LANES_MAX /* values that can be read past the end of each array */
};

static bool is_drawable(const iso_shapes *shapes, const iso_glyphs *glyphs, uint32_t id) {
    const float *p = glyphs->positions[id], radius = iso_shapes_radius(shapes, id);
    return isfinite(p[0]) && isfinite(p[1]) && isfinite(p[2]) && radius > 0 && isfinite(radius);
}

static uint32_t list_drawable(const iso_shapes *shapes, const iso_glyphs *glyphs, uint32_t *order) {
    uint32_t count = 0;
    for (uint32_t id = 0; id < (uint32_t)glyphs->count; id++)
        if (is_drawable(shapes, glyphs, id)) order[count++] = id;
    return count;
}

/* The coordinate that positions are stored relative to: the middle of their box, or 0 where that is near, so
 * that no position loses bits that it has in the file. */
static float origin_of(double low, double high, float *half) {
    const double middle = (low + high) / 2, radius = (high - low) / 2;
    const float origin = fabs(middle) < 2 * radius ? 0 : (float)middle;
    const double below = (double)origin - low, above = high - (double)origin;
    *half = (float)(1.0000002 * (below > above ? below : above));
    return origin;
}

/* The box of a block's positions, relative to the file's origin. */
static iso_box block_box(iso_shapes *shapes, const iso_glyphs *glyphs, iso_shapes_block *block) {
    iso_box box = iso_box_empty();
    for (uint32_t i = block->first; i < block->first + block->count; i++) {
        const float *p = glyphs->positions[shapes->id[i]], radius = iso_shapes_radius(shapes, shapes->id[i]);
        iso_box_add(&box, iso_vec3_make((double)p[0], (double)p[1], (double)p[2]));
        if (radius > block->reach) block->reach = radius;
    }
    return box;
}

static void add_bounds(iso_shapes *shapes, const iso_glyphs *glyphs, const iso_box *box, double reach) {
    const iso_vec3 margin = iso_vec3_make(reach, reach, reach);
    iso_box_add(&shapes->bounds, iso_vec3_add(glyphs->origin, iso_vec3_sub(box->lo, margin)));
    iso_box_add(&shapes->bounds, iso_vec3_add(glyphs->origin, iso_vec3_add(box->hi, margin)));
}

/* Sets a block's box, and its glyphs' positions relative to it. */
static void fill_block(iso_shapes *shapes, const iso_glyphs *glyphs, iso_shapes_block *block) {
    const iso_box box = block_box(shapes, glyphs, block);
    const float x = origin_of(box.lo.x, box.hi.x, &block->half[0]),
                y = origin_of(box.lo.y, box.hi.y, &block->half[1]),
                z = origin_of(box.lo.z, box.hi.z, &block->half[2]);
    add_bounds(shapes, glyphs, &box, (double)block->reach);
    iso_vec3_store(iso_vec3_add(glyphs->origin, iso_vec3_make((double)x, (double)y, (double)z)),
                   block->origin);
    for (uint32_t i = block->first; i < block->first + block->count; i++) {
        const float *p = glyphs->positions[shapes->id[i]];
        shapes->x[i] = p[0] - x;
        shapes->y[i] = p[1] - y;
        shapes->z[i] = p[2] - z;
    }
}

static iso_status make_blocks(iso_shapes *shapes, const iso_glyphs *glyphs, const iso_shapes_sort *sort,
                              iso_error *error) {
    const size_t stride = shapes->count + SLACK;
    shapes->blocks = iso_alloc(sort->block_count * sizeof *shapes->blocks);
    shapes->x = iso_alloc_zero(stride, 4 * sizeof *shapes->x);
    if (!shapes->blocks || !shapes->x) return iso_fail_memory(error, "shapes");
    shapes->y = shapes->x + stride;
    shapes->z = shapes->y + stride;
    shapes->id = (uint32_t *)(shapes->z + stride);
    memcpy(shapes->id, sort->order, shapes->count * sizeof *shapes->id);
    const uint32_t *firsts = sort->firsts.data;
    for (size_t i = 0; i < sort->block_count; i++) {
        const uint32_t end = i + 1 < sort->block_count ? firsts[i + 1] : (uint32_t)shapes->count;
        shapes->blocks[i] = (iso_shapes_block){.first = firsts[i], .count = end - firsts[i]};
        fill_block(shapes, glyphs, &shapes->blocks[i]);
    }
    shapes->block_count = sort->block_count;
    shapes->bytes =
        sizeof *shapes + shapes->block_count * sizeof *shapes->blocks + 4 * stride * sizeof(float);
    return ISO_OK;
}

static iso_status sort_glyphs(iso_shapes *shapes, const iso_glyphs *glyphs, iso_error *error) {
    iso_shapes_sort sort = {.points = (const float(*)[3])glyphs->positions,
                            .order = iso_alloc(glyphs->count * sizeof(uint32_t)),
                            .spare = iso_alloc(glyphs->count * sizeof(uint32_t)),
                            .wanted = WANTED,
                            .most = ISO_SHAPES_BLOCK};
    iso_status status = ISO_ERR_NOMEM;
    if (!sort.order || !sort.spare) {
        iso_fail(error, status, "out of memory for sorting %zu glyphs", glyphs->count);
    } else {
        shapes->count = list_drawable(shapes, glyphs, sort.order);
        shapes->skipped = glyphs->count - shapes->count;
        status = iso_shapes_sort_run(&sort, (uint32_t)shapes->count, error);
        if (status == ISO_OK) status = make_blocks(shapes, glyphs, &sort, error);
    }
    iso_free(sort.order);
    iso_free(sort.spare);
    iso_buffer_free(&sort.firsts);
    return status;
}

static iso_status check(const iso_glyphs *glyphs, const iso_shapes_opts *opts, iso_error *error) {
    if (opts->glyph != ISO_GLYPH_SPHERE)
        return iso_fail(error, ISO_ERR_UNSUPPORTED, "only spheres are drawn as glyphs");
    if (!(opts->scale >= 0 && isfinite(opts->scale)) || !(opts->radius >= 0 && isfinite(opts->radius)))
        return iso_fail(error, ISO_ERR_USAGE, "radius and scale of glyphs must be finite and not negative");
    if (!glyphs->radii && !(opts->radius > 0))
        return iso_fail(error, ISO_ERR_USAGE, "the glyphs have no radii, and no radius is given");
    if (glyphs->count >= (size_t)1 << 31)
        return iso_fail(error, ISO_ERR_LIMIT, "%zu glyphs; 2^31 - 1 at most", glyphs->count);
    return ISO_OK;
}

iso_status iso_shapes_from_glyphs(const iso_glyphs *glyphs, const iso_shapes_opts *opts, iso_shapes **shapes,
                                  iso_error *error) {
    ISO_TRY(check(glyphs, opts, error));
    iso_shapes *made = iso_alloc(sizeof *made);
    if (!made) return iso_fail_memory(error, "shapes");
    *made = (iso_shapes){.glyph = opts->glyph,
                         .radius = opts->radius,
                         .scale = opts->scale > 0 ? opts->scale : 1,
                         .bounds = iso_box_empty(),
                         .radii = glyphs->radii,
                         .colors = (const uint8_t(*)[3])glyphs->colors};
    iso_status status = sort_glyphs(made, glyphs, error);
    if (status == ISO_OK)
        *shapes = made;
    else
        iso_shapes_destroy(made);
    return status;
}

void iso_shapes_destroy(iso_shapes *shapes) {
    if (!shapes) return;
    iso_free(shapes->blocks);
    iso_free(shapes->x);
    iso_free(shapes);
}

iso_shapes_totals iso_shapes_stats(const iso_shapes *shapes) {
    return (iso_shapes_totals){shapes->count, shapes->skipped, shapes->block_count, shapes->bytes};
}

iso_box iso_shapes_bounds(const iso_shapes *shapes) {
    return shapes->bounds;
}
