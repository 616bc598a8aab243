/* exact: the set of crossed cells. Reads the voxels of changed bricks from an rgrid or an hgrid, calls the
 * kernel of cells.h to find the crossed cells, and keeps the spans sorted for drawing. */
#include "exact/exact.h"

#include <math.h>
#include <string.h>

#include "exact/set.h"

/* A cell depends on its own voxel and the next one on each axis. (Gradients, which depend on more, are
 * computed when drawing.) */
static const iso_halo HALO = {.down = 1, .up = 0};

enum { LATTICE = ISO_EXACT_LATTICE };

/* ---- one brick */

static void count_cells(const int *dims, const int brick[3], int cells[3]) {
    for (int axis = 0; axis < 3; axis++) {
        int left = dims[axis] - 1 - brick[axis] * ISO_BRICK;
        cells[axis] = left < ISO_BRICK ? left : ISO_BRICK;
    }
}

/* Copies the rows of a brick at the grid's upper x border into `window` and pads them with zeros, because the
 * grid's rows end there before the 17th voxel that the kernel reads. */
static void copy_rows(const iso_exact_source *source, size_t bytes, void *window) {
    const char *from = source->voxels;
    char *to = window;
    const size_t used = (size_t)(source->cells[0] + 1) * bytes, row = LATTICE * bytes;
    for (int z = 0; z <= source->cells[2]; z++)
        for (int y = 0; y <= source->cells[1]; y++) {
            char *out = to + ((size_t)z * LATTICE + (size_t)y) * row;
            memcpy(out, from + (y * source->stride_y + z * source->stride_z) * (ptrdiff_t)bytes, used);
            memset(out + used, 0, row - used);
        }
}

static void set_rgrid_source(const iso_rgrid *grid, const int brick[3], iso_exact_source *source,
                             void *window) {
    const size_t bytes = iso_type_size(grid->type);
    const ptrdiff_t first = ISO_BRICK * (brick[0] + brick[1] * grid->stride_y + brick[2] * grid->stride_z);
    source->voxels = (const char *)grid->data + first * (ptrdiff_t)bytes;
    source->stride_y = grid->stride_y;
    source->stride_z = grid->stride_z;
    if (source->cells[0] == ISO_BRICK) return;
    copy_rows(source, bytes, window);
    *source = (iso_exact_source){window,
                                 LATTICE,
                                 LATTICE * LATTICE,
                                 {source->cells[0], source->cells[1], source->cells[2]},
                                 source->isovalue_ceil};
}

/* A cell of an hgrid: the values of its brick or, if `values` is NULL, the value that all its voxels have. */
typedef struct hgrid_cell {
    const float *values;
    float value;
} hgrid_cell;

static hgrid_cell get_hgrid_cell(const iso_hgrid *grid, const int brick[3], int number) {
    int at[3];
    for (int axis = 0; axis < 3; axis++) {
        at[axis] = brick[axis] + (number >> axis & 1);
        if (at[axis] >= grid->cells[axis]) at[axis] = brick[axis]; /* not used */
    }
    const int32_t state = grid->cell[iso_hgrid_cell_index(grid, at[0], at[1], at[2])];
    if (state >= 0) return (hgrid_cell){.values = iso_hgrid_brick(grid, state)};
    return (hgrid_cell){.value = iso_hgrid_empty_value(grid, state)};
}

/* Copies the voxels of a brick and of its upper neighbours' first layers into `window`, and sets `source` to
 * it. */
static void set_hgrid_source(const iso_hgrid *grid, const int brick[3], iso_exact_source *source,
                             float *window) {
    hgrid_cell cells[8];
    for (int i = 0; i < 8; i++) cells[i] = get_hgrid_cell(grid, brick, i);
    for (int z = 0; z <= source->cells[2]; z++)
        for (int y = 0; y <= source->cells[1]; y++) {
            const hgrid_cell *cell = &cells[y / ISO_BRICK * 2 + z / ISO_BRICK * 4];
            const int row = (z % ISO_BRICK * ISO_BRICK + y % ISO_BRICK) * ISO_BRICK;
            float *out = window + (z * LATTICE + y) * LATTICE;
            if (cell->values)
                memcpy(out, cell->values + row, ISO_BRICK * sizeof *out);
            else
                for (int x = 0; x < ISO_BRICK; x++) out[x] = cell->value;
            out[ISO_BRICK] = cell[1].values ? cell[1].values[row] : cell[1].value;
        }
    source->voxels = window;
    source->stride_y = LATTICE;
    source->stride_z = LATTICE * LATTICE;
}

static bool may_exist(const void *context, const int brick[3]) {
    const iso_exact *exact = context;
    return iso_grid_brick_may_cross(&exact->grid, brick, exact->surface.isovalue_ceil);
}

static float isovalue_of(const void *context) {
    return ((const iso_exact *)context)->surface.isovalue_ceil;
}

bool iso_exact_find_cells(const iso_exact *exact, const int brick[3], iso_exact_extraction *extraction) {
    iso_exact_source source = {.isovalue_ceil = exact->surface.isovalue_ceil};
    count_cells(iso_grid_dims(&exact->grid), brick, source.cells);
    if (source.cells[0] < 1 || source.cells[1] < 1 || source.cells[2] < 1) return false;
    if (exact->grid.rgrid)
        set_rgrid_source(exact->grid.rgrid, brick, &source, extraction->window);
    else
        set_hgrid_source(exact->grid.hgrid, brick, &source, extraction->window);
    exact->extract(&source, &extraction->output);
    return true;
}

static void extract_brick(const void *context, const int brick[3], void *memory, iso_brick_output *output) {
    iso_exact_extraction *extraction = memory;
    const iso_exact_output *made = &extraction->output;
    if (!iso_exact_find_cells(context, brick, extraction)) return;
    *output = (iso_brick_output){.count = {made->octants, made->groups}, .own = made->cells};
    output->items[0] = made->octant;
    output->items[ISO_SPAN_ARRAYS] = made->corners;
}

/* The kernel's extract_many: extracts bricks one by one with extract_brick. A kernel needs extract_many for
 * the faster way of the brick set with one thread, in which items are copied to their final place at once. */
static void extract_bricks(const void *context, const uint32_t *bricks, size_t count, void *scratch,
                           iso_brick_sink *sink) {
    (void)context, (void)scratch;
    for (size_t i = 0; i < count && !iso_brick_sink_failed(sink); i++)
        iso_brick_sink_extract(sink, bricks[i]);
}

static void write_span(void *span, const iso_brick_location *place) {
    *(iso_exact_span *)span = (iso_exact_span){
        .brick = {place->brick[0], place->brick[1], place->brick[2]},
        .octants = place->count[0],
        .cells = place->own,
        .octant = place->first[0],
        .group = place->first[1],
    };
}

/* ---- the set */

static void set_whole(iso_exact *exact, const iso_grid_chunk *chunk) {
    memcpy(exact->dims, chunk ? chunk->dims : iso_grid_dims(&exact->grid), sizeof exact->dims);
    exact->transform = chunk ? chunk->transform : *iso_grid_transform(&exact->grid);
    if (chunk) memcpy(exact->origin, chunk->origin, sizeof exact->origin);
    exact->opts.chunk = NULL; /* borrowed for the call only */
}

static void set_surface(iso_exact *exact) {
    exact->surface = iso_threshold_of(&exact->grid, exact->opts.isovalue);
}

iso_status iso_exact_create(const iso_grid *grid, const iso_exact_opts *opts, iso_exact **out,
                            iso_error *error) {
    if (!isfinite(opts->isovalue)) return iso_fail(error, ISO_ERR_USAGE, "the isovalue is not finite");
    iso_exact *exact = iso_alloc_zero(1, sizeof *exact);
    if (!exact) return iso_fail(error, ISO_ERR_NOMEM, "out of memory for a set of cells");
    exact->grid = *grid;
    exact->opts = *opts;
    exact->type = grid->rgrid ? grid->rgrid->type : ISO_FLOAT32;
    exact->extract = iso_exact_extract_get(exact->type, iso_cpu_best());
    set_whole(exact, opts->chunk);
    set_surface(exact);
    const iso_brick_kernel kernel = {
        .item_bytes =
            {[0] = sizeof(iso_exact_octant), [ISO_SPAN_ARRAYS] = iso_exact_group_bytes(exact->type)},
        .scratch_bytes = sizeof(iso_exact_extraction),
        .span_bytes = sizeof(iso_exact_span),
        .halo = HALO,
        .may_exist = may_exist,
        .extract = extract_brick,
        .extract_many = extract_bricks,
        .isovalue = isovalue_of,
        .write_span = write_span,
    };
    iso_status status = iso_brick_set_init(&exact->set, &kernel, exact, grid, opts->pool, error);
    if (status != ISO_OK) {
        iso_exact_destroy(exact);
        return status;
    }
    if (opts->chunk) iso_brick_set_restrict(&exact->set, opts->chunk);
    *out = exact;
    return ISO_OK;
}

void iso_exact_destroy(iso_exact *exact) {
    if (!exact) return;
    iso_brick_set_free(&exact->set);
    iso_buffer_free(&exact->order);
    iso_buffer_free(&exact->rows);
    iso_free(exact);
}

/* Sets `order` and `rows`, which list the spans sorted by brick. (In the brick set, spans lose this order
 * when bricks are added and removed.) */
static iso_status sort_spans(iso_exact *exact, iso_error *error) {
    const iso_brick_set *set = &exact->set;
    const size_t row_count = (size_t)set->bricks[1] * (size_t)set->bricks[2];
    exact->sorted = false;
    ISO_TRY(iso_buffer_reserve(&exact->rows, (row_count + 1) * sizeof(uint32_t), 0, error));
    ISO_TRY(iso_buffer_reserve(&exact->order, set->span_count * sizeof(uint32_t), 0, error));
    uint32_t *order = exact->order.data, *rows = exact->rows.data, count = 0;
    for (size_t row = 0; row < row_count; row++) {
        const uint32_t *span_of = set->span_of + row * (size_t)set->bricks[0];
        rows[row] = count;
        for (int x = 0; x < set->bricks[0]; x++)
            if (span_of[x]) order[count++] = span_of[x] - 1;
    }
    rows[row_count] = count;
    exact->cells = 0;
    for (size_t i = 0; i < set->span_count; i++) exact->cells += iso_exact_spans(exact)[i].cells;
    exact->sorted = true;
    return ISO_OK;
}

iso_status iso_exact_update(iso_exact *exact, iso_error *error) {
    if (!isfinite(exact->opts.isovalue)) return iso_fail(error, ISO_ERR_USAGE, "the isovalue is not finite");
    const iso_status status = iso_brick_set_update(&exact->set, error);
    const iso_status sorted = sort_spans(exact, status == ISO_OK ? error : NULL);
    return status != ISO_OK ? status : sorted;
}

void iso_exact_set_isovalue(iso_exact *exact, double isovalue) {
    if (isovalue == exact->opts.isovalue) return;
    exact->opts.isovalue = isovalue;
    set_surface(exact);
    iso_brick_set_reset(&exact->set);
}

iso_exact_totals iso_exact_stats(const iso_exact *exact) {
    const iso_span_heap *heaps = exact->set.heap;
    return (iso_exact_totals){
        .cells = exact->cells,
        .bricks = exact->set.extracted,
        .bytes = heaps[0].end * sizeof(iso_exact_octant) + heaps[1].end * iso_exact_group_bytes(exact->type),
    };
}
