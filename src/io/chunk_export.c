/* chunk_export: counts what each row of each chunk has, and writes it to its place in the file. */
#include "io/chunk_export.h"

#include "base/memory.h"
#include "extract/mesh/mesh.h"
#include "extract/points/points.h"
#include "io/mesh/mesh_write.h"
#include "io/points_write.h"

/* ---- segments */

/* The bricks of a row (along x) that belong to one chunk are a segment. In the file, rows follow each other
 * along y and z, and the segments of a row along x. */
typedef struct segments {
    const iso_chunk_cuts *cuts;
    int columns; /* segments of a row */
    int rows;    /* rows of a layer of bricks */
    size_t count;
    uint64_t *points, *triangles; /* by segment: how many it has, later how many are before it */
} segments;

static size_t segment_of(const segments *all, const int32_t brick[3]) {
    const size_t row = (size_t)brick[2] * (size_t)all->rows + (size_t)brick[1];
    return row * (size_t)all->columns + (size_t)iso_chunk_with(all->cuts, 0, brick[0]);
}

static void free_segments(segments *all) {
    iso_free(all->points);
    iso_free(all->triangles);
}

static iso_status make_segments(const iso_chunk_walk *walk, segments *all, iso_error *error) {
    const iso_chunk_cuts *cuts = iso_chunk_walk_cuts(walk);
    *all = (segments){.cuts = cuts, .columns = cuts->counts[0], .rows = cuts->bricks[1]};
    all->count = (size_t)cuts->bricks[2] * (size_t)all->rows * (size_t)all->columns;
    all->points = iso_alloc_zero(all->count, sizeof *all->points);
    all->triangles = iso_alloc_zero(all->count, sizeof *all->triangles);
    if (all->points && all->triangles) return ISO_OK;
    free_segments(all);
    return iso_fail(error, ISO_ERR_NOMEM, "out of memory for the places of %zu rows of bricks", all->count);
}

/* Replaces the number of each segment by the sum of those before it; returns the sum of all. */
static uint64_t sum_up(uint64_t *numbers, size_t count) {
    uint64_t sum = 0;
    for (size_t i = 0; i < count; i++) {
        const uint64_t own = numbers[i];
        numbers[i] = sum;
        sum += own;
    }
    return sum;
}

/* ---- points */

typedef struct point_export {
    const iso_chunk_walk *walk;
    segments all;
    iso_box box;         /* around all points, index coordinates */
    bool closed;         /* the surface of all chunks is */
    iso_point_file file; /* while points are written */
} point_export;

static iso_status extract_points(const iso_chunk_walk *walk, const iso_chunk_visit *visit,
                                 iso_point_set **points, iso_error *error) {
    const iso_chunk_walk_opts *walked = iso_chunk_walk_opts_of(walk);
    const iso_grid grid = {.rgrid = visit->grid};
    const iso_points_opts opts = {.isovalue = walked->isovalue,
                                  .primitive = ISO_PRIMITIVE_EDGE,
                                  .floats = true,
                                  .pool = walked->pool,
                                  .chunk = visit->chunk};
    ISO_TRY(iso_point_set_create(&grid, &opts, points, error));
    return iso_point_set_update(*points, error);
}

static iso_status count_points(void *context, const iso_chunk_visit *visit, iso_error *error) {
    point_export *out = context;
    iso_point_set *points = NULL;
    iso_status status = extract_points(out->walk, visit, &points, error);
    if (status == ISO_OK) status = iso_point_set_bound(points, error);
    if (status == ISO_OK) {
        const iso_point_view view = iso_point_set_view(points);
        out->closed &= view.closed;
        const iso_box box = iso_point_view_bounds(&view);
        for (size_t i = 0; i < view.span_count; i++)
            out->all.points[segment_of(&out->all, view.spans[i].brick)] += view.spans[i].count;
        if (!iso_box_is_empty(&box)) {
            iso_box_add(&out->box, box.lo);
            iso_box_add(&out->box, box.hi);
        }
    }
    iso_point_set_destroy(points);
    return status;
}

static iso_status put_points(void *context, const iso_chunk_visit *visit, iso_error *error) {
    point_export *out = context;
    iso_point_set *points = NULL;
    const iso_status status = extract_points(out->walk, visit, &points, error);
    if (status == ISO_OK) {
        const iso_point_view view = iso_point_set_view(points);
        size_t last = SIZE_MAX;
        for (size_t i = 0; i < view.span_count; i++) {
            const size_t segment = segment_of(&out->all, view.spans[i].brick);
            if (segment != last) iso_point_file_seek(&out->file, out->all.points[segment]);
            iso_point_file_put(&out->file, &view, &view.spans[i]);
            last = segment;
        }
    }
    iso_point_set_destroy(points);
    return status;
}

static iso_status fail_order(const char *path, iso_error *error) {
    return iso_fail(error, ISO_ERR_WRITE,
                    "%s: cannot be written: a surface of chunks goes to a regular file, whose parts are "
                    "written in any order",
                    path);
}

/* Completes the file after a visit, or removes it. */
static iso_status finish(iso_status status, iso_sink *sink, iso_error *error) {
    if (status == ISO_OK) return iso_sink_commit(sink, error);
    iso_sink_abort(sink);
    return status;
}

static iso_status write_points(point_export *out, iso_chunk_walk *walk, const char *path, const char *comment,
                               iso_chunk_exported *exported, iso_error *error) {
    const iso_chunk_share whole = {1, 1};
    ISO_TRY(iso_chunk_walk_visit(walk, whole, count_points, out, error));
    exported->points = sum_up(out->all.points, out->all.count);
    const iso_point_file_opts opts = {.count = exported->points,
                                      .box = &out->box,
                                      .transform = &iso_chunk_walk_opts_of(walk)->source->transform,
                                      .closed = out->closed,
                                      .comment = comment};
    ISO_TRY(iso_point_file_begin(path, &opts, &out->file, error));
    const iso_status status = out->file.start < 0 ? fail_order(path, error)
                                                  : iso_chunk_walk_visit(walk, whole, put_points, out, error);
    return finish(status, &out->file.sink, error);
}

iso_status iso_chunk_export_points(iso_chunk_walk *walk, const char *path, const char *comment,
                                   iso_chunk_exported *exported, iso_error *error) {
    point_export out = {.walk = walk, .box = iso_box_empty(), .closed = true};
    *exported = (iso_chunk_exported){0};
    ISO_TRY(make_segments(walk, &out.all, error));
    const iso_status status = write_points(&out, walk, path, comment, exported, error);
    free_segments(&out.all);
    return status;
}

/* ---- meshes */

typedef struct mesh_export {
    const iso_chunk_walk *walk;
    segments all;
    iso_mesh_file file; /* while the mesh is written */
} mesh_export;

static iso_status extract_mesh(const iso_chunk_walk *walk, const iso_grid_chunk *chunk, iso_rgrid *voxels,
                               iso_mesh_set **mesh, iso_error *error) {
    const iso_chunk_walk_opts *walked = iso_chunk_walk_opts_of(walk);
    const iso_grid grid = {.rgrid = voxels};
    const iso_mesh_opts opts = {.isovalue = walked->isovalue, .pool = walked->pool, .chunk = chunk};
    ISO_TRY(iso_mesh_set_create(&grid, &opts, mesh, error));
    return iso_mesh_set_update(*mesh, error);
}

static iso_status count_mesh(void *context, const iso_chunk_visit *visit, iso_error *error) {
    mesh_export *out = context;
    iso_mesh_set *mesh = NULL;
    const iso_status status = extract_mesh(out->walk, visit->chunk, visit->grid, &mesh, error);
    if (status == ISO_OK) {
        const iso_mesh_view view = iso_mesh_set_view(mesh);
        for (size_t i = 0; i < view.span_count; i++) {
            const size_t segment = segment_of(&out->all, view.spans[i].brick);
            out->all.points[segment] += view.spans[i].owned_count;
            out->all.triangles[segment] += view.spans[i].triangle_count;
        }
    }
    iso_mesh_set_destroy(mesh);
    return status;
}

/* Sets first[span] to the number of the span's first own vertex in the whole mesh. The spans of a segment
 * are all there, or the first of them, in order. */
static void number_vertices(const segments *all, const iso_mesh_view *view, uint32_t *first) {
    size_t last = SIZE_MAX;
    uint64_t next = 0;
    for (size_t i = 0; i < view->span_count; i++) {
        const size_t segment = segment_of(all, view->spans[i].brick);
        if (segment != last) next = all->points[segment];
        first[i] = (uint32_t)next;
        next += view->spans[i].owned_count;
        last = segment;
    }
}

static bool is_in_box(const iso_mesh_span *span, const iso_brick_box *box) {
    for (int axis = 0; axis < 3; axis++)
        if (span->brick[axis] >= box->end[axis]) return false;
    return true;
}

/* Writes the segments of a chunk's box, of which `part` has all vertices and triangles in span order. */
static void put_segments(mesh_export *out, const iso_mesh_view *view, const iso_brick_box *box,
                         const iso_weld *part) {
    size_t vertex = 0, triangle = 0;
    for (size_t i = 0; i < view->span_count;) {
        const size_t segment = segment_of(&out->all, view->spans[i].brick);
        size_t vertices = 0, triangles = 0;
        for (; i < view->span_count && segment_of(&out->all, view->spans[i].brick) == segment; i++) {
            if (!is_in_box(&view->spans[i], box)) continue;
            vertices += view->spans[i].owned_count;
            triangles += view->spans[i].triangle_count;
        }
        if (vertices)
            iso_mesh_file_put_vertices(&out->file, out->all.points[segment], part, vertex, vertex + vertices);
        if (triangles)
            iso_mesh_file_put_triangles(&out->file, out->all.triangles[segment], part, triangle,
                                        triangle + triangles);
        vertex += vertices;
        triangle += triangles;
    }
}

static iso_status weld_and_put(mesh_export *out, const iso_mesh_view *view, const iso_brick_box *box,
                               iso_error *error) {
    uint32_t *first = iso_alloc(view->span_count * sizeof *first);
    iso_weld part = {0};
    if (!first) return iso_fail(error, ISO_ERR_NOMEM, "out of memory for %zu bricks", view->span_count);
    number_vertices(&out->all, view, first);
    const iso_status status = iso_mesh_weld_box(view, box, first, &part, error);
    if (status == ISO_OK) put_segments(out, view, box, &part);
    iso_weld_free(&part);
    iso_free(first);
    return status;
}

/* The triangles of a chunk use vertices of the bricks next to it, whose numbers are known when all vertices
 * of these bricks are: the chunk is read again with one brick more on each axis. */
static iso_status put_mesh(void *context, const iso_chunk_visit *visit, iso_error *error) {
    mesh_export *out = context;
    const iso_chunk_walk_opts *walked = iso_chunk_walk_opts_of(out->walk);
    const iso_chunk_source *source = walked->source;
    iso_brick_box box = visit->chunk->box;
    iso_grid_chunk wider;
    iso_rgrid *voxels = NULL;
    iso_mesh_set *mesh = NULL;
    for (int axis = 0; axis < 3; axis++) box.end[axis]++;
    iso_grid_chunk_make(source->dims, &source->transform, &box, &wider);
    ISO_TRY(source->read(source->context, &wider, walked->pool, &voxels, error));
    iso_status status = extract_mesh(out->walk, &wider, voxels, &mesh, error);
    if (status == ISO_OK) {
        const iso_mesh_view view = iso_mesh_set_view(mesh);
        status = weld_and_put(out, &view, &visit->chunk->box, error);
    }
    iso_mesh_set_destroy(mesh);
    iso_rgrid_destroy(voxels);
    return status;
}

static iso_status write_mesh(mesh_export *out, iso_chunk_walk *walk, const char *path, const char *comment,
                             iso_chunk_exported *exported, iso_error *error) {
    const iso_chunk_share whole = {1, 1};
    ISO_TRY(iso_chunk_walk_visit(walk, whole, count_mesh, out, error));
    exported->points = sum_up(out->all.points, out->all.count);
    exported->triangles = sum_up(out->all.triangles, out->all.count);
    if (exported->points > UINT32_MAX)
        return iso_fail(error, ISO_ERR_LIMIT, "a welded mesh of %llu vertices needs wider indices",
                        (unsigned long long)exported->points);
    const iso_mesh_file_opts opts = {.vertices = exported->points,
                                     .triangles = exported->triangles,
                                     .transform = &iso_chunk_walk_opts_of(walk)->source->transform,
                                     .comment = comment};
    ISO_TRY(iso_mesh_file_begin(path, &opts, &out->file, error));
    const iso_status status = out->file.start < 0 ? fail_order(path, error)
                                                  : iso_chunk_walk_visit(walk, whole, put_mesh, out, error);
    return finish(status, &out->file.sink, error);
}

iso_status iso_chunk_export_mesh(iso_chunk_walk *walk, const char *path, const char *comment,
                                 iso_chunk_exported *exported, iso_error *error) {
    mesh_export out = {.walk = walk};
    *exported = (iso_chunk_exported){0};
    ISO_TRY(make_segments(walk, &out.all, error));
    const iso_status status = write_mesh(&out, walk, path, comment, exported, error);
    free_segments(&out.all);
    return status;
}
