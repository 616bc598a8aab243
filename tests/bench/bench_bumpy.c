#include "bench_bumpy.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/point_bounds.h"
#include "extract/points/points.h"

/* ---- the field, in units of the picture's world: negative inside ---- */

static const float SLOPE = 1.45f; /* the field changes by no more than this per unit */

typedef struct lattice {
    float spacing;
    float *place; /* of each voxel along an axis */
    float *bump;  /* sin(11 * place): the bumps are a sum of one for each axis */
} lattice;

/* `bricks`: with the one to spare at either end. */
static iso_status lattice_create(int side, int bricks, lattice *made, iso_error *error) {
    int count = bricks * ISO_BRICK;
    *made = (lattice){.spacing = 2.0f / (float)side,
                      .place = calloc((size_t)count, sizeof(float)),
                      .bump = calloc((size_t)count, sizeof(float))};
    if (!made->place || !made->bump) {
        free(made->place);
        free(made->bump);
        return iso_fail(error, ISO_ERR_NOMEM, "out of memory");
    }
    for (int i = 0; i < count; i++) {
        made->place[i] = -1 + (float)(i - ISO_BRICK) * made->spacing;
        made->bump[i] = sinf(11 * made->place[i]);
    }
    return ISO_OK;
}

static void lattice_free(lattice *made) {
    free(made->place);
    free(made->bump);
}

/* Between the sphere of radius 0.68 and the ring of radii 0.86 and 0.05, tilted about z. */
static float field(float x, float y, float z, float bumps) {
    float sphere = sqrtf(x * x + y * y + z * z) - (0.68f + 0.02f * bumps);
    float across = sqrtf(x * x + z * z) - 0.86f, height = y - 0.25f * x;
    float ring = sqrtf(across * across + height * height) - 0.05f;
    return sphere < ring ? sphere : ring;
}

static float field_at(const lattice *l, int x, int y, int z) {
    const float *place = l->place + ISO_BRICK, *bump = l->bump + ISO_BRICK;
    return field(place[x], place[y], place[z], bump[x] + bump[y] + bump[z]);
}

/* ---- one piece: an hgrid with a brick more on each side ---- */

typedef struct piece {
    const lattice *lattice;
    int base[3]; /* brick of the lattice at the grid's cell (0, 0, 0) */
    int cells[3];
    iso_hgrid *grid;
    int (*split)[3]; /* cells with bricks */
    size_t split_count;
} piece;

static void fill_brick(void *context, size_t index, int worker) {
    (void)worker;
    const piece *p = context;
    const int *cell = p->split[index];
    const iso_hgrid *grid = p->grid;
    float *out = iso_hgrid_brick(grid, grid->cell[iso_hgrid_cell_index(grid, cell[0], cell[1], cell[2])]);
    int first[3];
    for (int axis = 0; axis < 3; axis++) first[axis] = (p->base[axis] + cell[axis]) * ISO_BRICK;
    for (int z = 0; z < ISO_BRICK; z++)
        for (int y = 0; y < ISO_BRICK; y++)
            for (int x = 0; x < ISO_BRICK; x++) {
                float value =
                    field_at(p->lattice, first[0] + x, first[1] + y, first[2] + z) / p->lattice->spacing;
                *out++ = fmaxf(-grid->band, fminf(grid->band, value));
            }
}

/* Cells that may hold a value within the band get a brick, the others their sign. */
static iso_status split_cell(piece *p, const int cell[3], iso_error *error) {
    const lattice *l = p->lattice;
    const int half = ISO_BRICK / 2;
    float middle =
        field_at(l, (p->base[0] + cell[0]) * ISO_BRICK + half, (p->base[1] + cell[1]) * ISO_BRICK + half,
                 (p->base[2] + cell[2]) * ISO_BRICK + half);
    if (fabsf(middle) > l->spacing * (SLOPE * 1.7321f * half + p->grid->band)) {
        if (middle < 0) iso_hgrid_coalesce(p->grid, cell[0], cell[1], cell[2], ISO_CELL_INSIDE);
        return ISO_OK;
    }
    float *brick;
    ISO_TRY(iso_hgrid_split(p->grid, cell[0], cell[1], cell[2], &brick, error));
    memcpy(p->split[p->split_count++], cell, sizeof *p->split);
    return ISO_OK;
}

static iso_status fill_grid(piece *p, iso_pool *pool, iso_error *error) {
    size_t cells = (size_t)p->cells[0] * (size_t)p->cells[1] * (size_t)p->cells[2];
    p->split = calloc(cells, sizeof *p->split);
    if (!p->split) return iso_fail(error, ISO_ERR_NOMEM, "out of memory");
    int cell[3];
    for (cell[2] = 0; cell[2] < p->cells[2]; cell[2]++)
        for (cell[1] = 0; cell[1] < p->cells[1]; cell[1]++)
            for (cell[0] = 0; cell[0] < p->cells[0]; cell[0]++) ISO_TRY(split_cell(p, cell, error));
    iso_parallel_for(pool, p->split_count, fill_brick, p);
    return ISO_OK;
}

static iso_status make_grid(piece *p, iso_pool *pool, iso_error *error) {
    const double spacing = p->lattice->spacing;
    iso_transform transform = iso_transform_identity();
    int dims[3];
    for (int axis = 0; axis < 3; axis++) {
        dims[axis] = p->cells[axis] * ISO_BRICK;
        transform.spacing[axis] = spacing;
        transform.origin[axis] = -1 + p->base[axis] * ISO_BRICK * spacing;
    }
    ISO_TRY(iso_hgrid_create(dims, 0, &transform, &p->grid, error));
    iso_status status = fill_grid(p, pool, error);
    free(p->split);
    p->split = NULL;
    return status;
}

/* ---- the points of all pieces, one after another ---- */

typedef struct gathering {
    const lattice *lattice;
    iso_pool *pool;
    bench_bumpy *bumpy;
    bool with_mesh;
    iso_buffer points, curvatures, spans;
    size_t point_count, span_count;
} gathering;

static iso_status make_room(gathering *all, const iso_point_view *view, iso_error *error) {
    size_t had = all->point_count, has = had + iso_point_view_count(view);
    ISO_TRY(iso_buffer_reserve(&all->points, has * sizeof(iso_point), had * sizeof(iso_point), error));
    ISO_TRY(iso_buffer_reserve(&all->curvatures, has * sizeof(iso_curvature), had * sizeof(iso_curvature),
                               error));
    return iso_buffer_reserve(&all->spans, (all->span_count + view->span_count) * sizeof(iso_point_span),
                              all->span_count * sizeof(iso_point_span), error);
}

/* Spans of the piece's own cells; those of the brick around it are another piece's. */
static iso_status keep_spans(gathering *all, const piece *p, const iso_point_view *view, iso_error *error) {
    ISO_TRY(make_room(all, view, error));
    iso_point *points = all->points.data;
    iso_curvature *curvatures = all->curvatures.data;
    iso_point_span *spans = all->spans.data;
    for (size_t s = 0; s < view->span_count; s++) {
        iso_point_span span = view->spans[s];
        bool own = span.count > 0;
        for (int axis = 0; axis < 3; axis++)
            own = own && span.brick[axis] > 0 && span.brick[axis] < p->cells[axis] - 1;
        if (!own) continue;
        memcpy(points + all->point_count, view->packed + span.first, span.count * sizeof *points);
        memcpy(curvatures + all->point_count, view->curvatures + span.first, span.count * sizeof *curvatures);
        for (int axis = 0; axis < 3; axis++) span.brick[axis] += p->base[axis];
        span.first = all->point_count;
        all->point_count += span.count;
        spans[all->span_count++] = span;
    }
    return ISO_OK;
}

static iso_status gather_points(gathering *all, const piece *p, const iso_grid *grid, iso_error *error) {
    iso_point_set *set = NULL;
    iso_points_opts opts = {.primitive = ISO_PRIMITIVE_EDGE, .curvature = true, .pool = all->pool};
    ISO_TRY(iso_point_set_create(grid, &opts, &set, error));
    iso_status status = iso_point_set_update(set, error);
    iso_point_view view = iso_point_set_view(set);
    if (status == ISO_OK) status = keep_spans(all, p, &view, error);
    iso_point_set_destroy(set);
    return status;
}

static iso_status gather_piece(gathering *all, piece *p, iso_error *error) {
    iso_grid grid = {0};
    iso_status status = make_grid(p, all->pool, error);
    grid.hgrid = p->grid;
    if (status == ISO_OK) status = gather_points(all, p, &grid, error);
    if (status != ISO_OK || !all->with_mesh) {
        iso_grid_destroy(&grid);
        return status;
    }
    all->bumpy->grid = grid;
    iso_mesh_opts opts = {.pool = all->pool};
    ISO_TRY(iso_mesh_set_create(&all->bumpy->grid, &opts, &all->bumpy->mesh, error));
    return iso_mesh_set_update(all->bumpy->mesh, error);
}

/* `count` pieces a side, each of `size` bricks. */
static iso_status gather(gathering *all, int count, int size, iso_error *error) {
    for (int k = 0; k < count * count * count; k++) {
        const int at[3] = {k % count, k / count % count, k / count / count};
        piece p = {.lattice = all->lattice};
        for (int axis = 0; axis < 3; axis++) {
            p.base[axis] = at[axis] * size - 1;
            p.cells[axis] = size + 2;
        }
        ISO_TRY(gather_piece(all, &p, error));
    }
    return ISO_OK;
}

static void bound_span(void *context, size_t index, int worker) {
    (void)worker;
    const iso_point_view *view = context;
    const iso_point_span *span = &view->spans[index];
    iso_point_bounds_find(view, span->first, span->count, (iso_point_bounds *)&view->bounds[index]);
}

static iso_status bound_spans(iso_point_view *view, iso_pool *pool, iso_error *error) {
    view->bounds = iso_alloc_zero(view->span_count, sizeof *view->bounds);
    if (!view->bounds) return iso_fail(error, ISO_ERR_NOMEM, "out of memory");
    iso_parallel_for(pool, view->span_count, bound_span, view);
    return ISO_OK;
}

iso_status bench_bumpy_create(int side, int piece_bricks, bool with_mesh, iso_pool *pool, bench_bumpy *bumpy,
                              iso_error *error) {
    int bricks = (side + ISO_BRICK - 1) / ISO_BRICK;
    int count = (bricks + piece_bricks - 1) / piece_bricks, size = (bricks + count - 1) / count;
    lattice places;
    *bumpy = (bench_bumpy){.points.transform = iso_transform_identity()};
    ISO_TRY(lattice_create(side, count * size + 2, &places, error));
    gathering all = {.lattice = &places, .pool = pool, .bumpy = bumpy, .with_mesh = with_mesh && count == 1};
    iso_status status = gather(&all, count, size, error);
    iso_point_view *view = &bumpy->points;
    view->packed = all.points.data;
    view->curvatures = all.curvatures.data;
    view->spans = all.spans.data;
    view->span_count = all.span_count;
    view->closed = true;
    view->radius = 0.5 * sqrt(2) * places.spacing; /* as for extracted points */
    for (int axis = 0; axis < 3; axis++) {
        view->transform.spacing[axis] = places.spacing;
        view->transform.origin[axis] = -1;
    }
    lattice_free(&places);
    return status == ISO_OK ? bound_spans(view, pool, error) : status;
}

void bench_bumpy_free(bench_bumpy *bumpy) {
    iso_mesh_set_destroy(bumpy->mesh);
    iso_grid_destroy(&bumpy->grid);
    iso_free((void *)bumpy->points.packed);
    iso_free((void *)bumpy->points.curvatures);
    iso_free((void *)bumpy->points.bounds);
    iso_free((void *)bumpy->points.spans);
    *bumpy = (bench_bumpy){0};
}
