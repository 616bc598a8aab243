/* points: the set of points of a grid: connects the extraction of edge points, foot points and curvatures to
 * the brick set. */
#include "extract/points/points.h"

#include <stddef.h>

#include "base/point_bounds.h"
#include "extract/points/edge_points.h"
#include "extract/points/edge_run.h"
#include "extract/points/foot_kernel.h"
#include "extract/points/foot_points.h"
#include "extract/span_bounds.h"
#include "grids/brick_set.h"

/* The working memory of one worker. */
typedef struct point_scratch {
    iso_brick_window window;
    iso_surfel surfels[ISO_EDGES_OWN];
    iso_point packed[ISO_EDGES_OWN];
    iso_curvature curvatures[ISO_EDGES_OWN];
    int32_t voxels[ISO_BRICK_VOXELS];
    iso_foot_block block; /* of iterated foot points */
} point_scratch;

struct iso_point_set {
    iso_brick_set set;
    iso_grid grid;
    iso_points_opts opts; /* primitive is never auto */
    iso_threshold surface;
    iso_edge_context context; /* edge points of an rgrid */
    iso_foot_surface foot_surface;
    const iso_foot_kernel *foot_kernel; /* foot points of an hgrid */
    iso_span_bounds bounds;
};

const char *iso_primitive_name(iso_primitive primitive) {
    static const char *const names[] = {"auto", "edge", "foot", "foot-iterated"};
    return names[primitive];
}

static void output_points(const iso_point_set *points, point_scratch *scratch, uint32_t count,
                          iso_brick_output *output) {
    output->count[0] = count;
    output->items[0] = points->opts.floats ? (const void *)scratch->surfels : scratch->packed;
    output->items[1] = scratch->curvatures;
}

static iso_curvature_points add_point_curvatures(const iso_point_set *points, const point_scratch *scratch,
                                                 uint32_t count) {
    if (points->opts.floats) return (iso_curvature_points){.surfels = scratch->surfels, .count = count};
    return (iso_curvature_points){.packed = scratch->packed, .count = count};
}

static iso_curvature_feet add_foot_curvatures_of(const iso_point_set *points, const int32_t *voxels) {
    return (iso_curvature_feet){voxels, points->foot_surface.isovalue_ceil, points->foot_surface.band};
}

static void pack_points(const iso_point_set *points, point_scratch *scratch, uint32_t count) {
    if (points->opts.floats) return;
    for (uint32_t i = 0; i < count; i++) scratch->packed[i] = iso_point_pack(&scratch->surfels[i]);
}

static bool edges_may_exist(const void *context, const int brick[3]) {
    const iso_point_set *points = context;
    return iso_grid_brick_may_cross(&points->grid, brick, points->surface.isovalue_ceil);
}

static void extract_edges(const void *context, const int brick[3], void *memory, iso_brick_output *output) {
    const iso_point_set *points = context;
    point_scratch *scratch = memory;
    iso_brick_window_fill(&points->grid, brick, &scratch->window);
    iso_edge_points edges = {.points = scratch->surfels, .scaled = !points->opts.floats};
    iso_edge_points_own(&scratch->window, &points->surface, &edges);
    for (uint32_t i = 0; i < edges.count && edges.scaled; i++)
        scratch->packed[i] = iso_point_pack_scaled(&scratch->surfels[i]);
    if (points->opts.curvature) {
        const iso_curvature_source source = iso_curvature_source_window(&scratch->window, &points->surface);
        const iso_curvature_points made = add_point_curvatures(points, scratch, edges.count);
        iso_curvatures_of_edges(&source, &made, scratch->curvatures);
    }
    output_points(points, scratch, edges.count, output);
}

static float edges_isovalue(const void *context) {
    return ((const iso_point_set *)context)->surface.isovalue_ceil;
}

/* Extracts edge points with the kernel. The worker's memory holds a point_scratch, for bricks that the kernel
 * passes to extract_edges, and after it the kernel's working memory. */
static void extract_edge_bricks(const void *context, const uint32_t *bricks, size_t count, void *scratch,
                                iso_brick_sink *sink) {
    const iso_point_set *points = context;
    iso_edge_run(&points->context, &points->set, bricks, count, (char *)scratch + sizeof(point_scratch),
                 sink);
}

static bool feet_may_exist(const void *context, const int brick[3]) {
    const iso_point_set *points = context;
    return iso_foot_points_may_exist(&points->grid, &points->surface, brick);
}

static void extract_feet(const void *context, const int brick[3], void *memory, iso_brick_output *output) {
    const iso_point_set *points = context;
    point_scratch *scratch = memory;
    iso_brick_window_fill(&points->grid, brick, &scratch->window);
    iso_foot_points feet = {.points = scratch->surfels, .voxels = scratch->voxels};
    iso_foot_points_direct(&scratch->window, &points->foot_surface, &feet);
    output->rejected = feet.rejected;
    pack_points(points, scratch, feet.count);
    if (points->opts.curvature) {
        const iso_curvature_source source = iso_curvature_source_window(&scratch->window, &points->surface);
        const iso_curvature_points made = add_point_curvatures(points, scratch, feet.count);
        const iso_curvature_feet from = add_foot_curvatures_of(points, scratch->voxels);
        iso_curvatures_of_feet(&source, &made, &from, scratch->curvatures);
    }
    output_points(points, scratch, feet.count, output);
}

static const float *values_of(const iso_point_set *points, uint32_t brick) {
    const iso_hgrid *grid = points->grid.hgrid; /* the grid's cells are numbered like the set's bricks */
    return iso_hgrid_brick(grid, grid->cell[brick]);
}

/* The working memory of extract_foot_bricks. */
typedef struct feet_scratch {
    iso_foot_scratch kernel;
    iso_brick_window window;
} feet_scratch;

static void add_foot_curvatures(const iso_point_set *points, const int brick[3], const iso_foot_output *feet,
                                feet_scratch *scratch, iso_curvature *curvatures) {
    if (!feet->count) return;
    iso_brick_window_fill(&points->grid, brick, &scratch->window);
    const iso_curvature_source source = iso_curvature_source_window(&scratch->window, &points->surface);
    const iso_curvature_points made = {feet->packed, feet->surfels, feet->count};
    const iso_curvature_feet from = add_foot_curvatures_of(points, scratch->kernel.voxel);
    iso_curvatures_of_feet(&source, &made, &from, curvatures);
}

/* Extracts foot points of bricks of an hgrid with the kernel; the next brick is prefetched meanwhile. */
static void extract_foot_bricks(const void *context, const uint32_t *bricks, size_t count, void *memory,
                                iso_brick_sink *sink) {
    const iso_point_set *points = context;
    feet_scratch *scratch = memory;
    for (size_t i = 0; i < count && !iso_brick_sink_failed(sink); i++) {
        int brick[3];
        iso_brick_set_coordinates(&points->set, bricks[i], brick);
        const bool with_curvature = points->opts.curvature;
        void *room = iso_brick_sink_room(sink, 0, ISO_FOOT_ROOM);
        iso_curvature *curvatures =
            room && with_curvature ? iso_brick_sink_room(sink, 1, ISO_FOOT_ROOM) : NULL;
        if (!room || (with_curvature && !curvatures)) return;
        iso_foot_brick around;
        iso_foot_brick_of(points->grid.hgrid, brick, &scratch->kernel, &around);
        around.next = values_of(points, bricks[i + 1 < count ? i + 1 : i]);
        iso_foot_output feet = {.packed = points->opts.floats ? NULL : room,
                                .surfels = points->opts.floats ? room : NULL};
        points->foot_kernel->extract(&points->foot_surface, &around, &scratch->kernel, &feet);
        if (with_curvature) add_foot_curvatures(points, brick, &feet, scratch, curvatures);
        iso_brick_sink_add(sink, bricks[i],
                           &(iso_brick_output){.count = {feet.count}, .rejected = feet.rejected});
    }
}

static bool seeds_may_exist(const void *context, const int brick[3]) {
    const iso_point_set *points = context;
    return iso_foot_seeds_may_exist(&points->grid, &points->surface, brick);
}

static void extract_iterated(const void *context, const int brick[3], void *memory,
                             iso_brick_output *output) {
    const iso_point_set *points = context;
    point_scratch *scratch = memory;
    iso_brick_window_fill(&points->grid, brick, &scratch->window);
    iso_foot_points feet = {.points = scratch->surfels};
    iso_foot_points_iterated(&points->grid, &scratch->window, &points->surface, &scratch->block, &feet);
    output->rejected = feet.rejected;
    pack_points(points, scratch, feet.count);
    if (points->opts.curvature) {
        const iso_curvature_points made = add_point_curvatures(points, scratch, feet.count);
        iso_curvatures_of_nearest_voxels(&points->grid, brick, points->surface.normal_sign, &made,
                                         scratch->curvatures);
    }
    output_points(points, scratch, feet.count, output);
}

static void write_span(void *span, const iso_brick_location *place) {
    *(iso_point_span *)span = (iso_point_span){
        .brick = {place->brick[0], place->brick[1], place->brick[2]},
        .count = place->count[0],
        .first = place->first[0],
    };
}

static iso_brick_kernel kernel_of(const iso_points_opts *opts, bool dense) {
    iso_brick_kernel kernel = {
        .item_bytes = {opts->floats ? sizeof(iso_surfel) : sizeof(iso_point),
                       opts->curvature ? sizeof(iso_curvature) : 0},
        .scratch_bytes = sizeof(point_scratch),
        .span_bytes = sizeof(iso_point_span),
        .write_span = write_span,
    };
    switch (opts->primitive) {
    case ISO_PRIMITIVE_FOOT:
        kernel.halo = ISO_HALO_FOOT;
        kernel.may_exist = feet_may_exist;
        kernel.extract = extract_feet;
        if (!dense) {
            kernel.extract_many = extract_foot_bricks;
            kernel.scratch_bytes = sizeof(feet_scratch);
            kernel.bricks_only = true;
        }
        break;
    case ISO_PRIMITIVE_FOOT_ITERATED:
        kernel.halo = ISO_HALO_ITERATED;
        kernel.may_exist = seeds_may_exist;
        kernel.extract = extract_iterated;
        break;
    default:
        kernel.halo = ISO_HALO_EDGE;
        kernel.may_exist = edges_may_exist;
        kernel.extract = extract_edges;
        if (dense) {
            kernel.extract_many = extract_edge_bricks;
            kernel.isovalue = edges_isovalue;
            kernel.scratch_bytes += iso_edge_run_scratch_bytes();
        }
        break;
    }
    return kernel;
}

static void set_surface(iso_point_set *points) {
    points->surface = iso_threshold_of(&points->grid, points->opts.isovalue);
    float band = points->grid.hgrid ? points->grid.hgrid->band : INFINITY;
    points->foot_surface = iso_foot_surface_of(&points->surface, band);
    if (points->grid.rgrid) {
        iso_edge_context_init(&points->context, points->grid.rgrid, &points->surface);
        points->context.floats = points->opts.floats;
        points->context.curvature = points->opts.curvature;
    }
}

iso_primitive iso_primitive_auto(const iso_grid *grid, double isovalue) {
    if (!grid->hgrid) return ISO_PRIMITIVE_EDGE;
    /* Foot points come from voxels with values up to sqrt 3 above the isovalue, and need those voxels'
     * neighbours inside the band, a distance of 1 away. */
    const double stored = iso_grid_stored(grid, isovalue), band = (double)grid->hgrid->band;
    const bool inside = stored + 1.7320508075688772 + 1 < band && stored - 1 > -band;
    return inside ? ISO_PRIMITIVE_FOOT : ISO_PRIMITIVE_EDGE;
}

iso_status iso_point_set_create(const iso_grid *grid, const iso_points_opts *opts, iso_point_set **set,
                                iso_error *error) {
    iso_points_opts chosen = *opts;
    if (chosen.primitive == ISO_PRIMITIVE_AUTO) chosen.primitive = iso_primitive_auto(grid, chosen.isovalue);
    if (!isfinite(chosen.isovalue)) return iso_fail(error, ISO_ERR_USAGE, "the isovalue is not finite");
    if (chosen.primitive == ISO_PRIMITIVE_FOOT && !iso_grid_is_level_set(grid))
        return iso_fail(error, ISO_ERR_USAGE,
                        "foot points need a distance field; use edge or foot-iterated for this volume");
    if (chosen.chunk && chosen.primitive != ISO_PRIMITIVE_EDGE)
        return iso_fail(error, ISO_ERR_USAGE, "foot points are of whole volumes");
    iso_point_set *points = iso_alloc_zero(1, sizeof *points);
    if (!points) return iso_fail(error, ISO_ERR_NOMEM, "out of memory for a set of points");
    points->grid = *grid;
    points->opts = chosen;
    set_surface(points);
    points->foot_kernel = iso_foot_kernel_get(iso_cpu_best());
    iso_brick_kernel kernel = kernel_of(&chosen, grid->rgrid != NULL);
    iso_status status = iso_brick_set_init(&points->set, &kernel, points, grid, chosen.pool, error);
    if (status != ISO_OK) {
        iso_point_set_destroy(points);
        return status;
    }
    if (chosen.chunk) iso_brick_set_restrict(&points->set, chosen.chunk);
    points->opts.chunk = NULL; /* borrowed for the call only */
    *set = points;
    return ISO_OK;
}

void iso_point_set_destroy(iso_point_set *set) {
    if (!set) return;
    iso_brick_set_free(&set->set);
    iso_span_bounds_free(&set->bounds);
    iso_free(set);
}

iso_status iso_point_set_update(iso_point_set *set, iso_error *error) {
    if (!isfinite(set->opts.isovalue)) return iso_fail(error, ISO_ERR_USAGE, "the isovalue is not finite");
    iso_status status = iso_brick_set_update(&set->set, error);
    iso_span_bounds_forget(&set->bounds, status == ISO_OK);
    return status;
}

void iso_point_set_isovalue(iso_point_set *set, double isovalue) {
    if (isovalue == set->opts.isovalue) return;
    set->opts.isovalue = isovalue;
    set_surface(set);
    iso_span_bounds_forget(&set->bounds, false);
    iso_brick_set_reset(&set->set);
}

double iso_edge_point_radius(const iso_transform *transform) {
    const double *spacing = transform->spacing;
    return sqrt(0.5) * fmax(spacing[0], fmax(spacing[1], spacing[2]));
}

iso_point_view iso_point_set_view(const iso_point_set *set) {
    const void *items = iso_brick_set_items(&set->set, 0, 0);
    iso_point_view view = {
        .packed = set->opts.floats ? NULL : items,
        .surfels = set->opts.floats ? items : NULL,
        .curvatures = set->opts.curvature ? iso_brick_set_items(&set->set, 0, 1) : NULL,
        .spans = set->set.spans.data,
        .span_count = set->set.span_count,
        .transform = set->set.restricted ? set->set.region.transform : *iso_grid_transform(&set->grid),
        .versions = iso_brick_set_versions(&set->set),
    };
    for (int k = 0; k < 3; k++) view.dims[k] = iso_brick_set_dims(&set->set)[k];
    view.radius = iso_edge_point_radius(&view.transform);
    view.bounds = iso_span_bounds_of(&set->bounds);
    view.closed = set->bounds.closed;
    return view;
}

/* ---- bounds */

static void find_bounds(const void *context, size_t span, iso_point_bounds *bounds) {
    const iso_point_view *view = context;
    iso_point_bounds_find(view, view->spans[span].first, view->spans[span].count, bounds);
}

iso_status iso_point_set_bound(iso_point_set *set, iso_error *error) {
    const iso_point_view view = iso_point_set_view(set);
    return iso_span_bounds_update(&set->bounds, &set->set, find_bounds, &view, error);
}

iso_points_stats iso_point_set_stats(const iso_point_set *set) {
    iso_point_view view = iso_point_set_view(set);
    return (iso_points_stats){
        .points = iso_point_view_count(&view),
        .rejected = set->set.rejected,
        .bricks = set->set.extracted,
    };
}
