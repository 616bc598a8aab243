/* prepare_lines: cuts lines into runs of segments and sorts the runs into blocks by their middle vertices. */
#include <math.h>
#include <string.h>

#include "base/memory.h"
#include "render/shapes/prepare.h"

enum {
    WANTED = 12, /* runs of a block, on average */
    MOST = ISO_SHAPES_BLOCK / ISO_SHAPES_RUN
};
static const size_t MOST_VERTICES = ((size_t)1 << 29) - 1; /* their floats are counted in 31 bits */

/* ---- vertices */

static iso_status copy_vertices(iso_shapes *shapes, const iso_lines *lines, iso_error *error) {
    const size_t count = lines->vertex_count;
    shapes->vertices = iso_alloc((count + 1) * sizeof *shapes->vertices);
    if (!shapes->vertices) return iso_fail(error, ISO_ERR_NOMEM, "out of memory for %zu vertices", count);
    for (size_t i = 0; i < count; i++) {
        memcpy(shapes->vertices[i], lines->vertices[i], 3 * sizeof(float));
        shapes->vertices[i][3] =
            (float)((lines->radii ? (double)lines->radii[i] : shapes->radius) * shapes->scale);
    }
    shapes->bytes += (count + 1) * sizeof *shapes->vertices;
    return ISO_OK;
}

/* Stores a vector of any length for iso_shapes_across; none if it is too short or not finite. */
static void store_across(const double vector[3], uint16_t words[3]) {
    const double length = sqrt(vector[0] * vector[0] + vector[1] * vector[1] + vector[2] * vector[2]);
    uint64_t bits = ISO_ACROSS_NONE;
    if (length > 1e-6 && isfinite(length)) {
        int largest = fabs(vector[1]) > fabs(vector[0]);
        if (fabs(vector[2]) > fabs(vector[largest])) largest = 2;
        bits = (uint64_t)largest | (vector[largest] < 0 ? 4 : 0);
        for (int i = 0; i < 2; i++) { /* at most the root of 1/2: they fit */
            const double value = vector[(largest + 1 + i) % 3] / length;
            const uint64_t steps = (uint64_t)floor((value + 1) * (1 << (ISO_ACROSS_BITS - 1)) + 0.5);
            bits |= steps << (3 + i * ISO_ACROSS_BITS);
        }
    }
    for (int i = 0; i < 3; i++) words[i] = (uint16_t)(bits >> 16 * i);
}

/* The directions across ribbons: perpendicular to the line and to its normals. */
static iso_status make_across(iso_shapes *shapes, const iso_lines *lines, iso_error *error) {
    if (shapes->kind != ISO_SHAPE_RIBBON) return ISO_OK;
    const size_t count = lines->vertex_count;
    shapes->across = iso_alloc((count + 1) * sizeof *shapes->across);
    float(*tangents)[3] = iso_alloc((count + 1) * sizeof *tangents);
    const bool has_room = shapes->across && tangents;
    if (has_room) iso_lines_tangents(lines, tangents[0], 3);
    for (size_t i = 0; i < count && has_room; i++) {
        const float *t = tangents[i], *n = lines->normals[i];
        const double across[3] = {(double)t[1] * (double)n[2] - (double)t[2] * (double)n[1],
                                  (double)t[2] * (double)n[0] - (double)t[0] * (double)n[2],
                                  (double)t[0] * (double)n[1] - (double)t[1] * (double)n[0]};
        store_across(across, shapes->across[i]);
    }
    iso_free(tangents);
    if (!has_room) return iso_fail(error, ISO_ERR_NOMEM, "out of memory for %zu vertices", count);
    shapes->bytes += (count + 1) * sizeof *shapes->across;
    return ISO_OK;
}

static bool is_vertex(const iso_shapes *shapes, size_t vertex) {
    const float *v = shapes->vertices[vertex];
    float across[3];
    if (shapes->across && !iso_shapes_across(shapes, vertex, across)) return false;
    return isfinite(v[0]) && isfinite(v[1]) && isfinite(v[2]) && v[3] >= 0 && isfinite(v[3]);
}

static bool is_segment(const iso_shapes *shapes, size_t first) {
    const float *a = shapes->vertices[first], *b = shapes->vertices[first + 1];
    return is_vertex(shapes, first) && is_vertex(shapes, first + 1) &&
           (a[3] > 0 || b[3] > 0 || shapes->min_pixels > 0);
}

/* ---- runs */

/* Runs in the order of lines, and the point that each is sorted by. */
typedef struct runs {
    iso_buffer first, length, ends, points;
    size_t count;
} runs;

static iso_status append(iso_buffer *buffer, size_t index, const void *item, size_t bytes, iso_error *error) {
    ISO_TRY(iso_buffer_reserve(buffer, (index + 1) * bytes, index * bytes, error));
    memcpy((char *)buffer->data + index * bytes, item, bytes);
    return ISO_OK;
}

static iso_status add_run(iso_shapes *shapes, runs *r, size_t first, size_t length, uint8_t ends,
                          iso_error *error) {
    const uint32_t vertex = (uint32_t)first;
    const uint8_t segments = (uint8_t)length;
    ISO_TRY(append(&r->first, r->count, &vertex, sizeof vertex, error));
    ISO_TRY(append(&r->length, r->count, &segments, sizeof segments, error));
    ISO_TRY(append(&r->ends, r->count, &ends, sizeof ends, error));
    ISO_TRY(append(&r->points, r->count, shapes->vertices[first + length / 2], 3 * sizeof(float), error));
    shapes->count += length;
    r->count++;
    return ISO_OK;
}

/* Cuts one line, whose vertices are begin .. end - 1, into runs of segments that can be drawn. */
static iso_status cut_line(iso_shapes *shapes, runs *r, size_t begin, size_t end, iso_error *error) {
    for (size_t at = begin; at + 1 < end;) {
        size_t length = 0;
        while (length < ISO_SHAPES_RUN && at + length + 1 < end && is_segment(shapes, at + length)) length++;
        if (!length) {
            shapes->skipped++;
            at++;
            continue;
        }
        const int ends = (at == begin ? ISO_RUN_STARTS : 0) | (at + length + 1 == end ? ISO_RUN_ENDS : 0);
        ISO_TRY(add_run(shapes, r, at, length, (uint8_t)ends, error));
        at += length;
    }
    return ISO_OK;
}

static iso_status cut_lines(iso_shapes *shapes, const iso_lines *lines, runs *r, iso_error *error) {
    for (size_t i = 0; i < lines->line_count; i++)
        ISO_TRY(cut_line(shapes, r, lines->starts[i], lines->starts[i + 1], error));
    if (r->count > UINT32_MAX) return iso_fail(error, ISO_ERR_LIMIT, "more than 2^32 - 1 runs of segments");
    return ISO_OK;
}

/* ---- blocks */

static void fill_block(iso_shapes *shapes, iso_shapes_block *block) {
    iso_box box = iso_box_empty();
    for (uint32_t i = block->first; i < block->first + block->count; i++)
        for (uint32_t k = 0; k <= shapes->runs.length[i]; k++) {
            const float *v = shapes->vertices[shapes->runs.first[i] + k];
            iso_box_add(&box, iso_vec3_make((double)v[0], (double)v[1], (double)v[2]));
            iso_shapes_add_bounds(shapes, v, v[3]);
            if (v[3] > block->reach) block->reach = v[3];
        }
    iso_shapes_set_box(block, &box);
}

static iso_status store(iso_shapes *shapes, const runs *r, const iso_shapes_sort *sort, iso_error *error) {
    ISO_TRY(iso_shapes_make_blocks(shapes, sort, (uint32_t)r->count, error));
    const size_t bytes = r->count * (sizeof(uint32_t) + 2);
    shapes->runs.first = iso_alloc(bytes);
    if (!shapes->runs.first) return iso_fail_memory(error, "shapes");
    shapes->runs.length = (uint8_t *)(shapes->runs.first + r->count);
    shapes->runs.ends = shapes->runs.length + r->count;
    shapes->bytes += bytes;
    for (size_t i = 0; i < r->count; i++) {
        const uint32_t run = sort->order[i];
        shapes->runs.first[i] = ((const uint32_t *)r->first.data)[run];
        shapes->runs.length[i] = ((const uint8_t *)r->length.data)[run];
        shapes->runs.ends[i] = ((const uint8_t *)r->ends.data)[run];
    }
    for (size_t i = 0; i < shapes->block_count; i++) fill_block(shapes, &shapes->blocks[i]);
    return ISO_OK;
}

static iso_status sort_lines(iso_shapes *shapes, const iso_lines *lines, runs *r, iso_shapes_sort *sort,
                             iso_error *error) {
    ISO_TRY(copy_vertices(shapes, lines, error));
    ISO_TRY(make_across(shapes, lines, error));
    ISO_TRY(cut_lines(shapes, lines, r, error));
    ISO_TRY(iso_shapes_sort_make((const float(*)[3])r->points.data, r->count, sort, error));
    sort->wanted = WANTED;
    sort->most = MOST;
    ISO_TRY(iso_shapes_sort_run(sort, (uint32_t)r->count, error));
    return store(shapes, r, sort, error);
}

iso_status iso_shapes_check_lines(const iso_lines *lines, const iso_shapes_opts *opts, iso_error *error) {
    ISO_TRY(iso_shapes_check(opts, error));
    if (!lines->radii && !(opts->radius > 0) && !(opts->min_pixels > 0))
        return iso_fail(error, ISO_ERR_USAGE,
                        "the lines have no radii, and neither radius nor width is given");
    if (opts->style == ISO_LINE_RIBBON && !lines->normals)
        return iso_fail(error, ISO_ERR_USAGE, "the lines have no normals, which ribbons need");
    if (lines->vertex_count > MOST_VERTICES)
        return iso_fail(error, ISO_ERR_LIMIT, "%zu vertices; %zu at most", lines->vertex_count,
                        MOST_VERTICES);
    return ISO_OK;
}

static iso_status from_lines(const iso_lines *lines, const iso_shapes_opts *opts, iso_shapes **shapes,
                             iso_error *error) {
    ISO_TRY(iso_shapes_check_lines(lines, opts, error));
    iso_shapes *made = iso_shapes_make(opts, lines->origin);
    if (!made) return iso_fail_memory(error, "shapes");
    made->kind = opts->style == ISO_LINE_RIBBON ? ISO_SHAPE_RIBBON : ISO_SHAPE_TUBE;
    made->colors = (const uint8_t(*)[3])lines->colors;
    made->line_starts = lines->starts;
    made->line_count = lines->line_count;
    runs r = {.count = 0};
    iso_shapes_sort sort = {0};
    const iso_status status = sort_lines(made, lines, &r, &sort, error);
    iso_shapes_sort_free(&sort);
    iso_buffer_free(&r.first);
    iso_buffer_free(&r.length);
    iso_buffer_free(&r.ends);
    iso_buffer_free(&r.points);
    if (status == ISO_OK)
        *shapes = made;
    else
        iso_shapes_destroy(made);
    return status;
}

iso_status iso_shapes_from_lines(const iso_lines *lines, const iso_shapes_opts *opts, iso_shapes **shapes,
                                 iso_error *error) {
    iso_shapes_opts resolved = *opts;
    if (isnan(opts->radius)) resolved.radius = iso_lines_usual_radius(lines);
    return from_lines(lines, &resolved, shapes, error);
}
