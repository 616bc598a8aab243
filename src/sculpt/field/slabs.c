/* A pool of bricks that is allocated in slabs of 2 MiB, so that growing neither copies nor moves a brick. */
#include "sculpt/field/slabs.h"

iso_status iso_slabs_reserve(iso_slabs *slabs, size_t bricks, iso_error *error) {
    while (slabs->count * ISO_SLAB_BRICKS < bricks) {
        const size_t bytes = slabs->count * sizeof(float *);
        ISO_TRY(iso_buffer_reserve(&slabs->table, bytes + sizeof(float *), bytes, error));
        float *slab = iso_alloc((size_t)ISO_SLAB_BRICKS * ISO_BRICK_VOXELS * sizeof *slab);
        if (!slab) return iso_fail(error, ISO_ERR_NOMEM, "out of memory for sculpting %zu cells", bricks);
        ((float **)slabs->table.data)[slabs->count++] = slab;
    }
    return ISO_OK;
}

void iso_slabs_prefault(iso_slabs *slabs) {
    enum { PAGE = 4096 / sizeof(float) };
    for (size_t i = 0; i < slabs->count; i++)
        for (size_t k = 0; k < (size_t)ISO_SLAB_BRICKS * ISO_BRICK_VOXELS; k += PAGE)
            ((float **)slabs->table.data)[i][k] = 0;
}

void iso_slabs_free(iso_slabs *slabs) {
    for (size_t i = 0; i < slabs->count; i++) iso_free(((float **)slabs->table.data)[i]);
    iso_buffer_free(&slabs->table);
    slabs->count = 0;
}
