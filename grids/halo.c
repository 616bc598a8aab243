/* Enlarges the boxes of changes by a halo and lists the bricks that they meet. */
#include "grids/halo.h"

#include <stdlib.h>

#include "base/primitives.h"

/* A range of bricks along one axis. */
typedef struct brick_range {
    int first, last;
} brick_range;

static brick_range range_of(int first_voxel, int last_voxel, int bricks) {
    int first = first_voxel < 0 ? 0 : first_voxel / ISO_BRICK;
    int last = last_voxel / ISO_BRICK;
    return (brick_range){first, last < bricks ? last : bricks - 1};
}

static void ranges_of(const iso_change *change, const int bricks[3], iso_halo halo, brick_range range[3]) {
    uint32_t columns = (uint32_t)bricks[0], rows = (uint32_t)bricks[1];
    const uint32_t cell[3] = {change->cell % columns, change->cell / columns % rows,
                              change->cell / columns / rows};
    for (int axis = 0; axis < 3; axis++) {
        int origin = (int)cell[axis] * ISO_BRICK;
        range[axis] = range_of(origin + change->lo[axis] - halo.down, origin + change->hi[axis] + halo.up,
                               bricks[axis]);
    }
}

static int compare_numbers(const void *a, const void *b) {
    uint32_t x = *(const uint32_t *)a, y = *(const uint32_t *)b;
    return (x > y) - (x < y);
}

static size_t sort_and_unite(uint32_t *numbers, size_t count) {
    if (!count) return 0;
    qsort(numbers, count, sizeof *numbers, compare_numbers);
    size_t kept = 1;
    for (size_t i = 1; i < count; i++)
        if (numbers[i] != numbers[i - 1]) numbers[kept++] = numbers[i];
    return kept;
}

iso_status iso_halo_bricks(const iso_changes *changes, iso_halo halo, iso_buffer *list, size_t *count,
                           iso_error *error) {
    size_t found = 0;
    const int *bricks = changes->bricks;
    for (size_t i = 0; i < changes->count; i++) {
        brick_range range[3];
        ranges_of(&changes->changes[i], bricks, halo, range);
        /* a box in one cell, enlarged by less than a brick, meets at most 27 bricks */
        ISO_TRY(iso_buffer_reserve(list, (found + 27) * sizeof(uint32_t), found * sizeof(uint32_t), error));
        uint32_t *numbers = list->data;
        for (int z = range[2].first; z <= range[2].last; z++)
            for (int y = range[1].first; y <= range[1].last; y++)
                for (int x = range[0].first; x <= range[0].last; x++)
                    numbers[found++] =
                        ((uint32_t)z * (uint32_t)bricks[1] + (uint32_t)y) * (uint32_t)bricks[0] + (uint32_t)x;
    }
    *count = sort_and_unite(list->data, found);
    return ISO_OK;
}
