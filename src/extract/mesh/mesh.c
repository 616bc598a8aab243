/* mesh: the set of meshes of a grid: connects the kernels of Marching Cubes to the brick set. */
#include "extract/mesh/mesh.h"

#include "extract/mesh/mesh_run.h"
#include "extract/span_bounds.h"
#include "grids/brick_set.h"

enum { VERTICES, TRIANGLES }; /* heaps of the brick set */

/* The working memory of one worker. In the worker's memory, iso_mesh_run_scratch_bytes() bytes follow it. */
typedef struct mesh_scratch {
    iso_brick_window window;
    iso_brick_mesh mesh;
} mesh_scratch;

struct iso_mesh_set {
    iso_brick_set set;
    iso_grid grid;
    double isovalue;
    iso_mesh_context context;
    iso_span_bounds bounds;
};

static bool may_exist(const void *context, const int brick[3]) {
    const iso_mesh_set *mesh = context;
    return iso_grid_brick_may_cross(&mesh->grid, brick, mesh->context.surface.isovalue_ceil);
}

static void extract_brick(const void *context, const int brick[3], void *memory, iso_brick_output *output) {
    const iso_mesh_set *set = context;
    mesh_scratch *scratch = memory;
    iso_brick_window_fill(&set->grid, brick, &scratch->window);
    iso_mesh_run_window(&set->context, &scratch->window, scratch + 1, &scratch->mesh);
    output->count[VERTICES] = scratch->mesh.vertex_count;
    output->count[TRIANGLES] = scratch->mesh.triangle_count;
    output->own = scratch->mesh.owned_count;
    output->items[VERTICES * ISO_SPAN_ARRAYS] = scratch->mesh.vertices;
    output->items[VERTICES * ISO_SPAN_ARRAYS + 1] = scratch->mesh.keys;
    output->items[TRIANGLES * ISO_SPAN_ARRAYS] = scratch->mesh.triangles;
}

static float stored_isovalue(const void *context) {
    const iso_mesh_set *set = context;
    return set->context.surface.isovalue_ceil;
}

static void extract_bricks(const void *context, const uint32_t *bricks, size_t count, void *memory,
                           iso_brick_sink *sink) {
    const iso_mesh_set *set = context;
    iso_mesh_run(&set->context, &set->set, bricks, count, (mesh_scratch *)memory + 1, sink);
}

static void set_surface(iso_mesh_set *mesh, double isovalue) {
    const iso_threshold surface = iso_threshold_of(&mesh->grid, isovalue);
    mesh->isovalue = isovalue;
    iso_mesh_context_init(&mesh->context, &mesh->grid, &surface);
}

static void write_span(void *span, const iso_brick_location *place) {
    *(iso_mesh_span *)span = (iso_mesh_span){
        .brick = {place->brick[0], place->brick[1], place->brick[2]},
        .vertex_count = place->count[VERTICES],
        .owned_count = place->own,
        .triangle_count = place->count[TRIANGLES],
        .first_vertex = place->first[VERTICES],
        .first_triangle = place->first[TRIANGLES],
    };
}

iso_status iso_mesh_set_create(const iso_grid *grid, const iso_mesh_opts *opts, iso_mesh_set **set,
                               iso_error *error) {
    if (!isfinite(opts->isovalue)) return iso_fail(error, ISO_ERR_USAGE, "the isovalue is not finite");
    iso_mesh_set *mesh = iso_alloc_zero(1, sizeof *mesh);
    if (!mesh) return iso_fail(error, ISO_ERR_NOMEM, "out of memory for a mesh");
    mesh->grid = *grid;
    set_surface(mesh, opts->isovalue);
    const iso_brick_kernel kernel = {
        .item_bytes = {sizeof(iso_surfel), sizeof(iso_edge_key), sizeof(uint16_t[3])},
        .scratch_bytes = sizeof(mesh_scratch) + iso_mesh_run_scratch_bytes(),
        .span_bytes = sizeof(iso_mesh_span),
        .halo = ISO_HALO_MESH,
        .may_exist = may_exist,
        .extract = extract_brick,
        .extract_many = grid->rgrid ? extract_bricks : NULL,
        .isovalue = stored_isovalue,
        .write_span = write_span,
    };
    iso_status status = iso_brick_set_init(&mesh->set, &kernel, mesh, grid, opts->pool, error);
    if (status != ISO_OK) {
        iso_mesh_set_destroy(mesh);
        return status;
    }
    if (opts->chunk) iso_brick_set_restrict(&mesh->set, opts->chunk);
    *set = mesh;
    return ISO_OK;
}

void iso_mesh_set_destroy(iso_mesh_set *set) {
    if (!set) return;
    iso_brick_set_free(&set->set);
    iso_span_bounds_free(&set->bounds);
    iso_free(set);
}

iso_status iso_mesh_set_update(iso_mesh_set *set, iso_error *error) {
    if (!isfinite(set->isovalue)) return iso_fail(error, ISO_ERR_USAGE, "the isovalue is not finite");
    iso_status status = iso_brick_set_update(&set->set, error);
    iso_span_bounds_forget(&set->bounds, status == ISO_OK);
    return status;
}

void iso_mesh_set_isovalue(iso_mesh_set *set, double isovalue) {
    if (isovalue == set->isovalue) return;
    set_surface(set, isovalue);
    iso_span_bounds_forget(&set->bounds, false);
    iso_brick_set_reset(&set->set);
}

iso_mesh_view iso_mesh_set_view(const iso_mesh_set *set) {
    return (iso_mesh_view){
        .vertices = iso_brick_set_items(&set->set, VERTICES, 0),
        .keys = iso_brick_set_items(&set->set, VERTICES, 1),
        .triangles = iso_brick_set_items(&set->set, TRIANGLES, 0),
        .spans = set->set.spans.data,
        .span_count = set->set.span_count,
        .transform = *iso_grid_transform(&set->grid),
        .versions = iso_brick_set_versions(&set->set),
        .bounds = iso_span_bounds_of(&set->bounds),
        .closed = set->bounds.closed,
    };
}

/* ---- bounds */

/* Sets `normal` to the normal of a triangle's plane in index space, with |x| + |y| + |z| = 1; returns false
 * if the triangle has no area. */
static bool plane_normal(const iso_surfel *vertices, const uint16_t triangle[3], double normal[3]) {
    const float *a = vertices[triangle[0]].position, *b = vertices[triangle[1]].position,
                *c = vertices[triangle[2]].position;
    double u[3], v[3], size = 0;
    for (int k = 0; k < 3; k++) {
        u[k] = (double)b[k] - (double)a[k];
        v[k] = (double)c[k] - (double)a[k];
    }
    for (int k = 0; k < 3; k++) {
        int i = (k + 1) % 3, j = (k + 2) % 3;
        normal[k] = u[i] * v[j] - u[j] * v[i];
        size += fabs(normal[k]);
    }
    for (int k = 0; k < 3; k++) normal[k] /= size;
    return size > 0;
}

static void find_bounds(const void *context, size_t number, iso_point_bounds *bounds) {
    const iso_mesh_view *view = context;
    const iso_mesh_span *span = &view->spans[number];
    const iso_surfel *vertices = view->vertices + span->first_vertex;
    *bounds = (iso_point_bounds){{INFINITY, INFINITY, INFINITY},
                                 {-INFINITY, -INFINITY, -INFINITY},
                                 {INFINITY, INFINITY, INFINITY},
                                 {-INFINITY, -INFINITY, -INFINITY}};
    for (uint32_t i = 0; i < span->vertex_count; i++)
        for (int k = 0; k < 3; k++) {
            bounds->lo[k] = fminf(bounds->lo[k], vertices[i].position[k]);
            bounds->hi[k] = fmaxf(bounds->hi[k], vertices[i].position[k]);
        }
    for (uint32_t i = 0; i < span->triangle_count; i++) {
        double normal[3];
        if (!plane_normal(vertices, view->triangles[span->first_triangle + i], normal)) continue;
        for (int k = 0; k < 3; k++) {
            bounds->normal_lo[k] = fminf(bounds->normal_lo[k], (float)normal[k]);
            bounds->normal_hi[k] = fmaxf(bounds->normal_hi[k], (float)normal[k]);
        }
    }
}

iso_status iso_mesh_set_bound(iso_mesh_set *set, iso_error *error) {
    const iso_mesh_view view = iso_mesh_set_view(set);
    return iso_span_bounds_update(&set->bounds, &set->set, find_bounds, &view, error);
}
