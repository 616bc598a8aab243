/* Finds connected components by run-based labelling (He, Chao and Suzuki 2008): rows become bit masks, masks
 * become runs, and overlapping runs of neighbouring rows are joined. */
#include "grids/parts/component_runs.h"
#include "base/disjoint_sets.h"

#include <string.h>

#include "grids/parts/component_mask.h"

/* SLICES: the smallest number of slices in a slab, so that few rows lie between slabs. SLABS: the largest
 * number of slabs. */
enum { SLICES = 4, SLABS = 64 };

typedef struct finder {
    const iso_grid *grid;
    iso_threshold surface;
    iso_mask_kernel *kernel; /* marks the inside voxels of a row of a dense grid */
    iso_mask_range range;
    bool none;     /* no value of the type is inside */
    bool diagonal; /* voxels are connected along the diagonals of faces too */
    iso_component_runs *runs;
} finder;

/* The runs of one row, and the number of the first one. */
typedef struct run_row {
    const iso_run *runs;
    uint32_t count, number;
} run_row;

/* Joins the runs of two neighbouring rows that overlap along x. With `reach` 1, runs whose ends are diagonal
 * neighbours are joined, too. */
static void join_rows(uint32_t *parent, run_row a, run_row b, int reach) {
    uint32_t i = 0, j = 0;
    while (i < a.count && j < b.count) {
        const iso_run p = a.runs[i], q = b.runs[j];
        if (p.last + reach >= q.first && q.last + reach >= p.first)
            iso_set_unite(parent, a.number + i, b.number + j);
        if (p.last < q.last)
            i++;
        else
            j++;
    }
}

/* ---- the bits of a row */

static uint64_t brick_bits(const float *row, float at) {
    uint64_t bits = 0;
    for (int i = 0; i < ISO_BRICK; i++) bits |= (uint64_t)(row[i] < at) << i;
    return bits;
}

static void sparse_row(const finder *f, int y, int z, uint64_t *words) {
    const iso_hgrid *grid = f->grid->hgrid;
    const float at = f->surface.isovalue_ceil;
    const uint64_t full = (1u << ISO_BRICK) - 1;
    const size_t first = iso_hgrid_cell_index(grid, 0, y / ISO_BRICK, z / ISO_BRICK);
    const size_t offset = ((size_t)(z % ISO_BRICK) * ISO_BRICK + (size_t)(y % ISO_BRICK)) * ISO_BRICK;
    const uint64_t inside = -grid->band < at ? full : 0, outside = grid->band < at ? full : 0;
    const int per_word = 64 / ISO_BRICK;
    for (int c = 0; c < grid->cells[0]; c++) {
        const int32_t cell = grid->cell[first + (size_t)c];
        const uint64_t bits = cell >= 0                 ? brick_bits(iso_hgrid_brick(grid, cell) + offset, at)
                              : cell == ISO_CELL_INSIDE ? inside
                                                        : outside;
        if (c % per_word == 0) words[c / per_word] = 0;
        words[c / per_word] |= bits << (c % per_word * ISO_BRICK);
    }
    if (grid->dims[0] % 64) words[grid->dims[0] / 64] &= ~(~(uint64_t)0 << (grid->dims[0] % 64));
}

static void find_bits(const finder *f, int y, int z, uint64_t *words) {
    if (f->grid->hgrid) {
        sparse_row(f, y, z, words);
        return;
    }
    const iso_rgrid *grid = f->grid->rgrid;
    const ptrdiff_t at = y * grid->stride_y + z * grid->stride_z;
    f->kernel((const char *)grid->data + at * (ptrdiff_t)iso_type_size(grid->type), grid->dims[0], &f->range,
              words);
}

/* Lists the runs of set bits, at most count / 2 + 1, and returns their number. */
static uint32_t list_runs(const uint64_t *words, int count, iso_run *runs) {
    uint32_t found = 0;
    uint64_t before = 0; /* the last bit of the word before */
    const int word_count = (count + 63) / 64;
    for (int w = 0; w < word_count; w++) {
        const uint64_t bits = words[w];
        /* Bits that differ from the one before: runs begin and end there in turn. */
        uint64_t changes = bits ^ (bits << 1 | before);
        before = bits >> 63;
        uint64_t inside = bits & changes;
        for (; changes; changes &= changes - 1) {
            const int32_t x = 64 * w + __builtin_ctzll(changes);
            const bool begins = inside & (changes & -changes);
            if (begins)
                runs[found++] = (iso_run){x, count - 1};
            else
                runs[found - 1].last = x - 1;
        }
    }
    return found;
}

/* ---- slabs */

/* Returns the runs of row (y, z) of a slab; `base` is the number of the slab's first run. */
static run_row row_of(const iso_run_slab *slab, int ny, int y, int z, size_t base) {
    const size_t row = (size_t)(z - slab->z[0]) * (size_t)ny + (size_t)y;
    const uint32_t first = slab->rows[row], count = slab->rows[row + 1] - first;
    const iso_run *runs = slab->runs.data; /* NULL when the slab has no run */
    return (run_row){count ? runs + first : NULL, count, (uint32_t)(base + first)};
}

/* Joins a row of slice z with its neighbours in slice z - 1. */
static void join_slices(const finder *f, uint32_t *parent, run_row row, const iso_run_slab *below,
                        const int at[3]) {
    const int ny = f->runs->dims[1], y = at[1], z = at[2] - 1;
    join_rows(parent, row_of(below, ny, y, z, below->base), row, f->diagonal);
    if (f->diagonal && y > 0) join_rows(parent, row_of(below, ny, y - 1, z, below->base), row, 0);
    if (f->diagonal && y + 1 < ny) join_rows(parent, row_of(below, ny, y + 1, z, below->base), row, 0);
}

static iso_status find_rows(const finder *f, iso_run_slab *slab, uint64_t *words) {
    const int *dims = f->runs->dims;
    size_t count = 0, row = 0;
    for (int z = slab->z[0]; z < slab->z[1]; z++)
        for (int y = 0; y < dims[1]; y++) {
            slab->rows[row++] = (uint32_t)count;
            if (f->none) continue;
            const size_t room = (size_t)dims[0] / 2 + 1;
            if ((count + room) * sizeof(iso_run) > slab->runs.bytes)
                ISO_TRY(iso_buffer_reserve(&slab->runs, (count + room) * sizeof(iso_run),
                                           count * sizeof(iso_run), NULL));
            find_bits(f, y, z, words);
            count += list_runs(words, dims[0], (iso_run *)slab->runs.data + count);
            if (count >= UINT32_MAX) return ISO_ERR_LIMIT;
        }
    slab->rows[row] = (uint32_t)count;
    return ISO_OK;
}

static iso_status join_slab(const finder *f, iso_run_slab *slab) {
    const int *dims = f->runs->dims;
    const uint32_t count = slab->rows[(size_t)(slab->z[1] - slab->z[0]) * (size_t)dims[1]];
    slab->parent = iso_alloc((size_t)count * sizeof *slab->parent);
    if (!slab->parent) return ISO_ERR_NOMEM;
    for (uint32_t i = 0; i < count; i++) slab->parent[i] = i;
    for (int z = slab->z[0]; z < slab->z[1]; z++)
        for (int y = 0; y < dims[1]; y++) {
            const run_row row = row_of(slab, dims[1], y, z, 0);
            if (!row.count) continue;
            if (y > 0) join_rows(slab->parent, row_of(slab, dims[1], y - 1, z, 0), row, f->diagonal);
            if (z > slab->z[0]) join_slices(f, slab->parent, row, slab, (const int[3]){0, y, z});
        }
    return ISO_OK;
}

static void find_slab(void *context, size_t index, int worker) {
    (void)worker;
    const finder *f = context;
    iso_run_slab *slab = &f->runs->slabs[index];
    const size_t rows = (size_t)(slab->z[1] - slab->z[0]) * (size_t)f->runs->dims[1];
    uint64_t *words = iso_alloc(((size_t)f->runs->dims[0] / 64 + 1) * sizeof *words);
    slab->rows = iso_alloc((rows + 1) * sizeof *slab->rows);
    slab->status = words && slab->rows ? find_rows(f, slab, words) : ISO_ERR_NOMEM;
    if (slab->status == ISO_OK) slab->status = join_slab(f, slab);
    iso_free(words);
}

static void copy_parents(void *context, size_t index, int worker) {
    (void)worker;
    iso_component_runs *runs = context;
    iso_run_slab *slab = &runs->slabs[index];
    const size_t end = index + 1 < runs->slab_count ? slab[1].base : runs->run_count;
    uint32_t *to = runs->component + slab->base;
    for (size_t i = 0; i < end - slab->base; i++) to[i] = slab->parent[i] + (uint32_t)slab->base;
    iso_free(slab->parent);
    slab->parent = NULL;
}

/* ---- the volume */

static iso_status make_slabs(iso_component_runs *runs, iso_error *error) {
    const int nz = runs->dims[2];
    int slices = (nz + SLABS - 1) / SLABS;
    if (slices < SLICES) slices = SLICES;
    runs->slab_count = (size_t)((nz + slices - 1) / slices);
    runs->slabs = iso_alloc_zero(runs->slab_count, sizeof *runs->slabs);
    if (!runs->slabs) return iso_fail(error, ISO_ERR_NOMEM, "out of memory for the parts of the solid");
    for (size_t i = 0; i < runs->slab_count; i++) {
        const int first = (int)i * slices, last = first + slices;
        runs->slabs[i].z[0] = first;
        runs->slabs[i].z[1] = last < nz ? last : nz;
    }
    return ISO_OK;
}

static iso_status number_runs(iso_component_runs *runs, iso_error *error) {
    size_t count = 0;
    for (size_t i = 0; i < runs->slab_count; i++) {
        iso_run_slab *slab = &runs->slabs[i];
        if (slab->status == ISO_ERR_NOMEM)
            return iso_fail(error, ISO_ERR_NOMEM, "out of memory for the parts of the solid");
        slab->base = count;
        if (slab->status == ISO_OK)
            count += slab->rows[(size_t)(slab->z[1] - slab->z[0]) * (size_t)runs->dims[1]];
        if (slab->status != ISO_OK || count >= UINT32_MAX)
            return iso_fail(error, ISO_ERR_LIMIT, "the solid has more than 2^32 runs of voxels");
    }
    runs->run_count = count;
    runs->component = iso_alloc(count * sizeof *runs->component);
    if (!runs->component)
        return iso_fail(error, ISO_ERR_NOMEM, "out of memory for %zu runs of voxels", count);
    return ISO_OK;
}

static void join_slabs(const finder *f) {
    iso_component_runs *runs = f->runs;
    for (size_t i = 1; i < runs->slab_count; i++) {
        const iso_run_slab *slab = &runs->slabs[i];
        for (int y = 0; y < runs->dims[1]; y++) {
            const run_row row = row_of(slab, runs->dims[1], y, slab->z[0], slab->base);
            if (row.count) join_slices(f, runs->component, row, slab - 1, (const int[3]){0, y, slab->z[0]});
        }
    }
}

/* Replaces the parent of each run by the number of its component. A parent precedes its children, so its
 * number is known by then. */
static iso_status number_components(iso_component_runs *runs, iso_error *error) {
    uint32_t count = 0;
    for (size_t i = 0; i < runs->run_count; i++) count += runs->component[i] == i;
    runs->component_count = count;
    runs->voxels = iso_alloc_zero(count ? count : 1, sizeof *runs->voxels);
    if (!runs->voxels)
        return iso_fail(error, ISO_ERR_NOMEM, "out of memory for %zu parts of the solid", (size_t)count);
    count = 0;
    for (size_t s = 0, i = 0; s < runs->slab_count; s++) {
        const size_t end = s + 1 < runs->slab_count ? runs->slabs[s + 1].base : runs->run_count;
        for (const iso_run *run = runs->slabs[s].runs.data; i < end; i++, run++) {
            const uint32_t parent = runs->component[i];
            runs->component[i] = parent == i ? count++ : runs->component[parent];
            const uint64_t voxels = (uint64_t)(run->last - run->first) + 1;
            runs->voxels[runs->component[i]] += voxels;
            runs->voxel_count += voxels;
        }
    }
    return ISO_OK;
}

iso_status iso_component_runs_find(const iso_grid *grid, const iso_threshold *surface, iso_pool *pool,
                                   iso_component_runs *runs, iso_error *error) {
    *runs = (iso_component_runs){0};
    memcpy(runs->dims, iso_grid_dims(grid), sizeof runs->dims);
    const bool below = iso_grid_is_level_set(grid);
    finder f = {.grid = grid, .surface = *surface, .diagonal = below, .runs = runs};
    if (grid->rgrid) {
        f.kernel = iso_mask_kernel_get(grid->rgrid->type, iso_cpu_best());
        f.none = !iso_mask_range_of(grid->rgrid->type, surface->isovalue_ceil, below, &f.range);
    }
    ISO_TRY(make_slabs(runs, error));
    iso_parallel_for(pool, runs->slab_count, find_slab, &f);
    ISO_TRY(number_runs(runs, error));
    iso_parallel_for(pool, runs->slab_count, copy_parents, runs);
    join_slabs(&f);
    return number_components(runs, error);
}

void iso_component_runs_free(iso_component_runs *runs) {
    for (size_t i = 0; i < runs->slab_count && runs->slabs; i++) {
        iso_buffer_free(&runs->slabs[i].runs);
        iso_free(runs->slabs[i].rows);
        iso_free(runs->slabs[i].parent);
    }
    iso_free(runs->slabs);
    iso_free(runs->component);
    iso_free(runs->voxels);
    *runs = (iso_component_runs){0};
}
