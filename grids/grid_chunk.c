/* grid_chunk: where a chunk's grid lies in the whole, and chunks of a whole that is in memory. */
#include "grids/grid_chunk.h"

#include "base/numbers.h"
#include "base/primitives.h"

bool iso_grid_chunk_make(const int dims[3], const iso_transform *transform, const iso_brick_box *box,
                         iso_grid_chunk *chunk) {
    *chunk = (iso_grid_chunk){.transform = *transform};
    for (int axis = 0; axis < 3; axis++) {
        const int bricks = (dims[axis] - 1) / ISO_BRICK + 1;
        const int first = box->first[axis] > 0 ? box->first[axis] : 0,
                  end = iso_min_int(box->end[axis], bricks);
        if (first >= end) return false;
        chunk->dims[axis] = dims[axis];
        chunk->box.first[axis] = first;
        chunk->box.end[axis] = end;
        chunk->origin[axis] = first ? first - 1 : 0;
        const int last = end < bricks ? end * ISO_BRICK + ISO_CHUNK_ABOVE : dims[axis];
        chunk->size[axis] = iso_min_int(last, dims[axis]) - chunk->origin[axis] * ISO_BRICK;
    }
    return true;
}

void iso_grid_chunk_voxels(const iso_grid_chunk *chunk, int first[3], int end[3]) {
    for (int axis = 0; axis < 3; axis++) {
        const int own = chunk->box.first[axis] * ISO_BRICK;
        first[axis] = own && !chunk->bare ? own - ISO_CHUNK_BELOW : own;
        end[axis] = chunk->bare ? iso_min_int(chunk->box.end[axis] * ISO_BRICK, chunk->dims[axis])
                                : chunk->origin[axis] * ISO_BRICK + chunk->size[axis];
    }
}

bool iso_grid_chunk_needs(const iso_grid_chunk *chunk, const int first[3], const int end[3]) {
    const iso_brick_box *box = &chunk->box;
    int lo[3], hi[3]; /* the bricks whose windows have some of the voxels */
    if (!chunk->needed) return true;
    for (int axis = 0; axis < 3; axis++) {
        const int below = (first[axis] - ISO_CHUNK_ABOVE) / ISO_BRICK,
                  above = (end[axis] - 1 + ISO_CHUNK_BELOW) / ISO_BRICK;
        lo[axis] = below > box->first[axis] ? below : box->first[axis];
        hi[axis] = iso_min_int(above, box->end[axis] - 1);
    }
    for (int z = lo[2]; z <= hi[2]; z++)
        for (int y = lo[1]; y <= hi[1]; y++)
            for (int x = lo[0]; x <= hi[0]; x++)
                if (iso_brick_box_has(box, chunk->needed, (const int[3]){x, y, z})) return true;
    return false;
}

iso_status iso_grid_chunk_view(const iso_rgrid *whole, const iso_grid_chunk *chunk, iso_rgrid **view,
                               iso_error *error) {
    ptrdiff_t first =
        chunk->origin[0] + chunk->origin[1] * whole->stride_y + chunk->origin[2] * whole->stride_z;
    first *= ISO_BRICK;
    const iso_rgrid_desc desc = {
        .dims = {chunk->size[0], chunk->size[1], chunk->size[2]},
        .type = whole->type,
        .data = (char *)whole->data + first * (ptrdiff_t)iso_type_size(whole->type),
        .scale = whole->scale,
        .offset = whole->offset,
        .transform = &whole->transform,
        .level_set = whole->level_set,
    };
    ISO_TRY(iso_rgrid_create(&desc, view, error));
    (*view)->stride_y = whole->stride_y;
    (*view)->stride_z = whole->stride_z;
    return ISO_OK;
}

/* The reading of ranges. Each layer of bricks is divided along y into bands of most[1] rows, as for an index
 * (brick_index.c). */
typedef struct range_reading {
    const iso_rgrid *grid;
    const iso_grid_chunk *chunk;
    iso_brick_range *ranges;
    int most[2], bands; /* the largest batch along x and y; bands of a layer */
} range_reading;

static void read_band(void *context, size_t number, int worker) {
    (void)worker;
    const range_reading *read = context;
    const iso_brick_box *box = &read->chunk->box;
    const int *origin = read->chunk->origin, columns = box->end[0] - box->first[0],
              rows = box->end[1] - box->first[1], y = (int)(number % (size_t)read->bands) * read->most[1],
              z = (int)(number / (size_t)read->bands), height = iso_min_int(read->most[1], rows - y);
    iso_brick_reading readings[ISO_BATCH_BRICKS];
    for (int x = 0; x < columns; x += read->most[0]) {
        const int width = iso_min_int(read->most[0], columns - x);
        const iso_brick_batch batch = {
            {box->first[0] - origin[0] + x, box->first[1] - origin[1] + y, box->first[2] - origin[2] + z},
            {width, height}};
        iso_brick_ranges(read->grid, iso_cpu_best(), &batch, readings);
        for (int row = 0; row < height; row++) {
            const size_t first = ((size_t)z * (size_t)rows + (size_t)(y + row)) * (size_t)columns + (size_t)x;
            for (int i = 0; i < width; i++) read->ranges[first + (size_t)i] = readings[row * width + i].range;
        }
    }
}

void iso_grid_chunk_ranges(const iso_rgrid *grid, const iso_grid_chunk *chunk, iso_pool *pool,
                           iso_brick_range *ranges) {
    range_reading read = {.grid = grid, .chunk = chunk, .ranges = ranges};
    const iso_brick_box *box = &chunk->box;
    iso_brick_batch_max(grid, read.most);
    read.bands = (box->end[1] - box->first[1] - 1) / read.most[1] + 1;
    iso_parallel_for(pool, (size_t)read.bands * (size_t)(box->end[2] - box->first[2]), read_band, &read);
}
