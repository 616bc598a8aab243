/* label_fields: which bricks the level sets need, the smoothing of their labels block by block
 * (label_blocks.c), and the label of a place. */
#include "grids/labels/label_fields.h"

#include <math.h>
#include <string.h>

#include "base/memory.h"
#include "grids/labels/label_blocks.h"

/* A brick needs values of its own if labels change within this many voxels: those of a cell's corners, and
 * of their neighbours, from which come the gradients. */
enum { REACH = 3 };

/* ---- which bricks */

static inline int group_at(const iso_label_fields *f, int x, int y, int z) {
    const int b = ISO_LABEL_BORDER;
    return f->group[iso_labels_at(f->labels, x - b, y - b, z - b)];
}

/* The set of groups, as bits, of the voxels lo .. hi. *mixed: whether they have several labels. Stops when it
 * has found all of `most`; mixed may be NULL. */
static uint64_t groups_in(const iso_label_fields *f, const int lo[3], const int hi[3], uint64_t most,
                          bool *mixed) {
    const iso_labels *labels = f->labels;
    uint64_t set = 0;
    int a[3], b[3], first = -1;
    if (mixed) *mixed = false;
    for (int k = 0; k < 3; k++) {
        a[k] = lo[k] - ISO_LABEL_BORDER;
        b[k] = hi[k] - ISO_LABEL_BORDER;
        if (a[k] < 0 || b[k] >= labels->dims[k]) set |= 1; /* what is outside is background */
        a[k] = a[k] < 0 ? 0 : a[k];
        b[k] = b[k] >= labels->dims[k] ? labels->dims[k] - 1 : b[k];
        if (a[k] > b[k]) return 1;
    }
    for (int z = a[2]; z <= b[2] && set != most; z++)
        for (int y = a[1]; y <= b[1]; y++) {
            const uint16_t *row =
                labels->number + ((size_t)z * (size_t)labels->dims[1] + (size_t)y) * (size_t)labels->dims[0];
            for (int x = a[0]; x <= b[0]; x = iso_label_run_end(row, x, b[0] + 1)) {
                set |= 1ull << f->group[row[x]];
                if (first < 0) first = row[x];
                if (mixed) *mixed |= first != row[x];
            }
        }
    return set;
}

static void brick_at(const iso_label_fields *f, size_t brick, int at[3]) {
    at[0] = (int)(brick % (size_t)f->bricks[0]);
    at[1] = (int)(brick / (size_t)f->bricks[0] % (size_t)f->bricks[1]);
    at[2] = (int)(brick / (size_t)f->bricks[0] / (size_t)f->bricks[1]);
}

/* Finds the groups of a row of bricks along x, run by run of its rows of voxels. */
static void find_own_groups(void *context, size_t index, int worker) {
    (void)worker;
    iso_label_fields *f = context;
    const iso_labels *labels = f->labels;
    uint64_t *own = f->own_groups + index * (size_t)f->bricks[0];
    const int at[2] = {(int)(index % (size_t)f->bricks[1]), (int)(index / (size_t)f->bricks[1])};
    int lo[2], hi[2];
    bool outside = false; /* what is outside is background */
    for (int k = 0; k < 2; k++) {
        const int first = ISO_BRICK * at[k] - ISO_LABEL_BORDER, end = first + ISO_BRICK,
                  n = labels->dims[k + 1];
        outside |= first < 0 || end > n;
        lo[k] = first > 0 ? first : 0;
        hi[k] = end < n ? end : n;
    }
    for (int i = 0; i < f->bricks[0]; i++)
        if (outside || i == 0 || ISO_BRICK * (i + 1) - ISO_LABEL_BORDER > labels->dims[0]) own[i] |= 1;
    for (int z = lo[1]; z < hi[1]; z++)
        for (int y = lo[0]; y < hi[0]; y++) {
            const uint16_t *row =
                labels->number + ((size_t)z * (size_t)labels->dims[1] + (size_t)y) * (size_t)labels->dims[0];
            for (int x = 0, end; x < labels->dims[0]; x = end) {
                end = iso_label_run_end(row, x, labels->dims[0]);
                const int last = (end - 1 + ISO_LABEL_BORDER) / ISO_BRICK;
                const uint64_t bit = 1ull << f->group[row[x]];
                for (int i = (x + ISO_LABEL_BORDER) / ISO_BRICK; i <= last; i++) own[i] |= bit;
            }
        }
}

/* The groups of a brick and all its neighbours. */
static uint64_t groups_around(const iso_label_fields *f, const int at[3]) {
    uint64_t set = 0;
    for (int z = at[2] - 1; z <= at[2] + 1; z++)
        for (int y = at[1] - 1; y <= at[1] + 1; y++)
            for (int x = at[0] - 1; x <= at[0] + 1; x++)
                if (x >= 0 && y >= 0 && z >= 0 && x < f->bricks[0] && y < f->bricks[1] && z < f->bricks[2])
                    set |=
                        f->own_groups[((size_t)z * (size_t)f->bricks[1] + (size_t)y) * (size_t)f->bricks[0] +
                                      (size_t)x];
                else
                    set |= 1;
    return set;
}

static bool is_single(uint64_t set) {
    return (set & (set - 1)) == 0;
}

static void find_groups(void *context, size_t brick, int worker) {
    (void)worker;
    iso_label_fields *f = context;
    int at[3], lo[3], hi[3];
    brick_at(f, brick, at);
    f->near_groups[brick] = groups_around(f, at);
    const bool inside = f->places & ISO_LABELS_INSIDE;
    if (is_single(f->near_groups[brick]) && !inside) return;
    if (f->own_groups[brick] == f->near_groups[brick] && !inside) {
        f->smoothed[brick] = true;
        return;
    }
    for (int k = 0; k < 3; k++) lo[k] = ISO_BRICK * at[k] - REACH, hi[k] = lo[k] + ISO_BRICK + 2 * REACH - 1;
    bool mixed = false;
    f->near_groups[brick] =
        groups_in(f, lo, hi, inside ? UINT64_MAX : f->near_groups[brick], inside ? &mixed : NULL);
    f->smoothed[brick] = !is_single(f->near_groups[brick]) || (inside && mixed);
}

/* Gives the cells of all level sets bricks, or makes them empty. */
static iso_status make_bricks(iso_label_fields *f, iso_error *error) {
    for (size_t brick = 0; brick < f->brick_count; brick++) {
        const uint64_t set = f->near_groups[brick];
        int at[3];
        brick_at(f, brick, at);
        for (int g = 1; g <= f->group_count; g++) {
            const uint64_t bit = 1ull << g;
            iso_hgrid *grid = f->grid[g];
            if (set == bit) grid->cell[brick] = ISO_CELL_INSIDE;
            if ((set & bit) && set != bit) ISO_TRY(iso_hgrid_split_unset(grid, at[0], at[1], at[2], error));
        }
    }
    return ISO_OK;
}

/* ---- all together */

static iso_status make_grids(iso_label_fields *f, iso_error *error) {
    int dims[3];
    for (int k = 0; k < 3; k++) {
        dims[k] = f->labels->dims[k] + 2 * ISO_LABEL_BORDER;
        f->bricks[k] = (dims[k] + ISO_BRICK - 1) / ISO_BRICK;
        if (dims[k] > ISO_HGRID_MAX)
            return iso_fail(error, ISO_ERR_LIMIT, "labels of %d x %d x %d voxels: up to %d along an axis",
                            f->labels->dims[0], f->labels->dims[1], f->labels->dims[2],
                            ISO_HGRID_MAX - 2 * ISO_LABEL_BORDER);
    }
    f->brick_count = (size_t)f->bricks[0] * (size_t)f->bricks[1] * (size_t)f->bricks[2];
    const int b = -ISO_LABEL_BORDER;
    const iso_transform transform = iso_transform_shift(&f->labels->transform, (const int[3]){b, b, b});
    for (int g = 1; g <= f->group_count; g++)
        ISO_TRY(iso_hgrid_create(dims, ISO_LABEL_BAND, &transform, &f->grid[g], error));
    f->own_groups = iso_alloc_zero(f->brick_count, sizeof *f->own_groups);
    f->near_groups = iso_alloc_zero(f->brick_count, sizeof *f->near_groups);
    f->candidates = iso_alloc_zero(f->brick_count, sizeof *f->candidates);
    f->smoothed = iso_alloc_zero(f->brick_count, sizeof *f->smoothed);
    f->block_count = 1;
    for (int k = 0; k < 3; k++) {
        f->blocks[k] = (f->bricks[k] + ISO_LABEL_BLOCK - 1) / ISO_LABEL_BLOCK;
        f->block_count *= (size_t)f->blocks[k];
    }
    f->apart = iso_alloc_zero(f->block_count, sizeof *f->apart);
    f->asked = iso_alloc_zero(f->block_count, sizeof *f->asked);
    if (!f->apart || !f->asked || !f->smoothed || !f->own_groups || !f->near_groups || !f->candidates)
        return iso_fail(error, ISO_ERR_NOMEM, "out of memory for labels");
    return ISO_OK;
}

static iso_status make_fields(iso_label_fields *f, const uint8_t *group, iso_pool *pool, iso_error *error) {
    const size_t count = (size_t)f->labels->count;
    f->group = iso_alloc(count);
    if (!f->group) return iso_fail(error, ISO_ERR_NOMEM, "out of memory for labels");
    memcpy(f->group, group, count);
    f->group[0] = 0;
    for (size_t i = 1; i < count; i++) {
        f->labels_in_group[f->group[i]]++;
        f->has_undrawn |= f->group[i] == 0;
    }
    ISO_TRY(make_grids(f, error));
    iso_parallel_for(pool, (size_t)f->bricks[1] * (size_t)f->bricks[2], find_own_groups, f);
    iso_parallel_for(pool, f->brick_count, find_groups, f);
    ISO_TRY(make_bricks(f, error));
    ISO_TRY(iso_label_blocks_smooth(f, pool, error));
    if (!(f->places & ISO_LABELS_APART)) return ISO_OK;
    for (size_t i = 0; i < f->block_count; i++) f->asked[i] = UINT64_MAX;
    return iso_label_blocks_tell_apart(f, pool, error);
}

iso_status iso_label_fields_make(const iso_labels *labels, const uint8_t *group, int group_count, int places,
                                 iso_pool *pool, iso_label_fields **fields, iso_error *error) {
    iso_label_fields *f = iso_alloc_zero(1, sizeof *f);
    if (!f) return iso_fail(error, ISO_ERR_NOMEM, "out of memory for labels");
    f->labels = labels;
    f->group_count = group_count;
    f->places = places;
    const iso_status status = make_fields(f, group, pool, error);
    if (status != ISO_OK)
        iso_label_fields_destroy(f);
    else
        *fields = f;
    return status;
}

void iso_label_fields_destroy(iso_label_fields *f) {
    if (!f) return;
    for (int g = 1; g <= f->group_count; g++) iso_hgrid_destroy(f->grid[g]);
    for (size_t i = 0; f->candidates && i < f->brick_count; i++) iso_free(f->candidates[i]);
    iso_free(f->candidates);
    iso_free(f->own_groups);
    iso_free(f->near_groups);
    iso_free(f->smoothed);
    iso_free(f->apart);
    iso_free(f->asked);
    iso_free(f->group);
    iso_free(f);
}

iso_hgrid *iso_label_fields_grid(const iso_label_fields *fields, int group) {
    return fields->grid[group];
}

/* ---- the label of a place */

/* The candidates of the brick of a voxel, or NULL. */
static inline const iso_label_candidates *candidates_at(const iso_label_fields *f, int x, int y, int z) {
    const size_t column = (size_t)(z / ISO_BRICK) * (size_t)f->bricks[1] + (size_t)(y / ISO_BRICK);
    return f->candidates[column * (size_t)f->bricks[0] + (size_t)(x / ISO_BRICK)];
}

/* The field of a label at a voxel that has candidates. */
static float value_at(const iso_label_fields *f, int label, int x, int y, int z) {
    const iso_label_candidates *c = candidates_at(f, x, y, z);
    if (!c) return -ISO_LABEL_BAND;
    const int row = z % ISO_BRICK * ISO_BRICK + y % ISO_BRICK;
    for (uint32_t i = c->start[row]; i < c->start[row + 1]; i++)
        if (c->entry[i].x == x % ISO_BRICK && c->entry[i].label == label) return c->entry[i].value;
    return -ISO_LABEL_BAND;
}

typedef uint16_t corners __attribute__((vector_size(8 * sizeof(uint16_t))));

/* The labels at the corners of a cell, whose first one is voxel `at` of the volume. */
static corners labels_of_corners(const iso_labels *labels, const int at[3]) {
    const int *n = labels->dims;
    const size_t row = (size_t)n[0], slice = row * (size_t)n[1];
    corners found;
    if (at[0] >= 0 && at[1] >= 0 && at[2] >= 0 && at[0] + 1 < n[0] && at[1] + 1 < n[1] && at[2] + 1 < n[2]) {
        const uint16_t *first = labels->number + (size_t)at[2] * slice + (size_t)at[1] * row + (size_t)at[0];
        uint32_t pairs[4];
        memcpy(&pairs[0], first, sizeof *pairs);
        memcpy(&pairs[1], first + row, sizeof *pairs);
        memcpy(&pairs[2], first + slice, sizeof *pairs);
        memcpy(&pairs[3], first + slice + row, sizeof *pairs);
        memcpy(&found, pairs, sizeof found);
        return found;
    }
    for (int i = 0; i < 8; i++)
        found[i] = (uint16_t)iso_labels_at(labels, at[0] + (i & 1), at[1] + (i >> 1 & 1), at[2] + (i >> 2));
    return found;
}

/* Whether all labels are 0 or `label`. */
static bool are_of(corners labels, uint16_t label) {
    const corners known = (corners)((labels == 0) | (labels == label));
    uint64_t halves[2];
    memcpy(halves, &known, sizeof halves);
    return (halves[0] & halves[1]) == UINT64_MAX;
}

/* The labels of the group, each once, at the corners of a cell. */
static void list_labels(const iso_label_fields *f, int group, iso_label_cell *cell) {
    const int b = ISO_LABEL_BORDER, at[3] = {cell->lo[0] - b, cell->lo[1] - b, cell->lo[2] - b};
    const corners all = labels_of_corners(f->labels, at);
    uint16_t label[8];
    memcpy(label, &all, sizeof label);
    cell->count = 0;
    int corner = 0;
    while (corner < 7 && !label[corner]) corner++;
    const int end = are_of(all, label[corner]) ? corner + 1 : 8;
    for (; corner < end; corner++) {
        int i = 0;
        while (i < cell->count && cell->labels[i] != label[corner]) i++;
        if (label[corner] && i == cell->count && f->group[label[corner]] == group)
            cell->labels[cell->count++] = label[corner];
    }
}

/* Sets the fields of the cell's labels at its corners. The entries of a row ascend along x: those of two
 * corners beside each other are found together, unless a brick ends between them. */
static void find_values(const iso_label_fields *f, iso_label_cell *cell) {
    const int *lo = cell->lo, x = lo[0] % ISO_BRICK;
    for (int pair = 0; pair < 4; pair++) {
        const int y = lo[1] + (pair & 1), z = lo[2] + (pair >> 1);
        for (int i = 0; i < cell->count; i++)
            cell->values[i][2 * pair] = cell->values[i][2 * pair + 1] = -ISO_LABEL_BAND;
        const iso_label_candidates *c = candidates_at(f, lo[0], y, z);
        if (x == ISO_BRICK - 1)
            for (int i = 0; i < cell->count; i++)
                cell->values[i][2 * pair + 1] = value_at(f, cell->labels[i], lo[0] + 1, y, z);
        if (!c) continue;
        const int row = z % ISO_BRICK * ISO_BRICK + y % ISO_BRICK;
        const iso_label_value *entry = c->entry + c->start[row], *end = c->entry + c->start[row + 1];
        while (entry < end && entry->x < x) entry++;
        for (; entry < end && entry->x <= x + 1; entry++)
            for (int i = 0; i < cell->count; i++)
                if (entry->label == cell->labels[i]) cell->values[i][2 * pair + entry->x - x] = entry->value;
    }
}

/* Whether the labels of a cell can be told apart; asks for it if they cannot yet. */
static bool are_apart(const iso_label_fields *f, const int lo[3]) {
    bool apart = true;
    for (int corner = 0; corner < 8; corner++) {
        const int x = lo[0] + (corner & 1), y = lo[1] + (corner >> 1 & 1), z = lo[2] + (corner >> 2);
        const size_t column =
                         (size_t)(z / ISO_LABEL_SIDE) * (size_t)f->blocks[1] + (size_t)(y / ISO_LABEL_SIDE),
                     block = column * (size_t)f->blocks[0] + (size_t)(x / ISO_LABEL_SIDE);
        const uint64_t bit = UINT64_C(1) << iso_label_octant(x, y, z);
        if (f->apart[block] & bit) continue;
        atomic_fetch_or_explicit(&f->asked[block], bit, memory_order_relaxed);
        apart = false;
    }
    return apart;
}

iso_status iso_label_fields_tell_apart(iso_label_fields *f, iso_pool *pool, iso_error *error) {
    return iso_label_blocks_tell_apart(f, pool, error);
}

static void look_at_cell(const iso_label_fields *f, int group, const int lo[3], iso_label_cell *cell) {
    cell->known = true;
    memcpy(cell->lo, lo, sizeof cell->lo);
    list_labels(f, group, cell);
    cell->apart = cell->count < 2 || are_apart(f, lo);
    if (cell->count > 1 && cell->apart) find_values(f, cell);
}

/* The label of the group whose nearest voxel is nearest to p; of two, the lower one. */
static int nearest_label(const iso_label_fields *f, int group, const int cell[3], iso_vec3 p) {
    int nearest = 0;
    double least = INFINITY;
    for (int z = cell[2] - 1; z <= cell[2] + 2; z++)
        for (int y = cell[1] - 1; y <= cell[1] + 2; y++)
            for (int x = cell[0] - 1; x <= cell[0] + 2; x++) {
                if (group_at(f, x, y, z) != group) continue;
                const int b = ISO_LABEL_BORDER, label = iso_labels_at(f->labels, x - b, y - b, z - b);
                const iso_vec3 d = iso_vec3_sub(iso_vec3_make(x, y, z), p);
                const double square = iso_vec3_dot(d, d);
                if (square > least || (square == least && label > nearest)) continue;
                least = square;
                nearest = label;
            }
    return nearest;
}

int iso_label_fields_at(const iso_label_fields *f, int group, iso_vec3 p) {
    iso_label_cell cell = {.known = false};
    return iso_label_fields_near(f, group, p, &cell);
}

int iso_label_fields_near(const iso_label_fields *f, int group, iso_vec3 p, iso_label_cell *cell) {
    const double at[3] = {p.x, p.y, p.z};
    int lo[3];
    double t[3];
    for (int k = 0; k < 3; k++) {
        const int most = f->labels->dims[k] + 2 * ISO_LABEL_BORDER - 2;
        lo[k] = at[k] >= most ? most : at[k] > 0 ? (int)at[k] : 0;
        t[k] = at[k] - lo[k];
    }
    if (!cell->known || lo[0] != cell->lo[0] || lo[1] != cell->lo[1] || lo[2] != cell->lo[2])
        look_at_cell(f, group, lo, cell);
    if (!cell->apart) return -1;
    if (cell->count == 0) return nearest_label(f, group, lo, p);
    if (cell->count == 1) return cell->labels[0];
    int best = 0;
    double most = -INFINITY, weight[8];
    for (int corner = 0; corner < 8; corner++)
        weight[corner] = (corner & 1 ? t[0] : 1 - t[0]) * (corner >> 1 & 1 ? t[1] : 1 - t[1]) *
                         (corner >> 2 ? t[2] : 1 - t[2]);
    for (int i = 0; i < cell->count; i++) {
        double value = 0;
        for (int corner = 0; corner < 8; corner++) value += weight[corner] * (double)cell->values[i][corner];
        if (value < most || (value == most && cell->labels[i] > best)) continue;
        most = value;
        best = cell->labels[i];
    }
    return best;
}
