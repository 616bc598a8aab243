/* chunk_source: chunks of a volume that is in memory. */
#include "grids/chunk_source.h"

#include <string.h>

static iso_status view_chunk(void *context, const iso_grid_chunk *chunk, iso_pool *pool, iso_rgrid **grid,
                             iso_error *error) {
    (void)pool;
    return iso_grid_chunk_view(context, chunk, grid, error);
}

iso_chunk_source iso_chunk_source_of(const iso_rgrid *grid) {
    iso_chunk_source source = {.type = grid->type,
                               .scale = grid->scale,
                               .offset = grid->offset,
                               .transform = grid->transform,
                               .level_set = grid->level_set,
                               .read = view_chunk,
                               .context = (void *)(uintptr_t)grid};
    memcpy(source.dims, grid->dims, sizeof source.dims);
    return source;
}
