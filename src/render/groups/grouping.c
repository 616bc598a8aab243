/* grouping: colours the graph of overlapping discs greedily (Zhang and Pajarola 2006, section 4.1). Levels
 * are processed from the largest discs to the smallest; within a level, blocks of cells are processed in 8
 * passes, each of which takes the blocks of one parity.
 *
 * An update compares each block with the block of the same key in the cells of the last call. What a block's
 * colouring reads are the points of the blocks around it, and the groups of those of them that are coloured
 * before it. If all of these are unchanged, so is the result, which is copied. */
#include "render/groups/grouping.h"

#include <math.h>
#include <string.h>

#include "base/point_cells.h"

/* Counts are kept by group, and by NO_GROUP for points that have no group yet. */
enum {
    NO_GROUP = ISO_GROUPS_MOST,
    COUNTS,
    /* The largest number of neighbours of a point that are examined. It is much larger than the number of
     * groups; only where very many discs lie on top of each other are there more neighbours. */
    LOOKED_AT = 4096
};

/* The share of one block of cells in the counts of iso_groups. */
typedef struct tally {
    size_t conflicts, joined, computed;
    int count;
} tally;

struct iso_groups_memory {
    iso_point_cells cells;
    uint8_t *group; /* one per point of the cells */
    tally *tallies; /* one per block */
    int limit;
    bool by_number, by_normals; /* by_normals: rule 1 or 2 is followed */
};

typedef struct colouring {
    const iso_point_view *view;
    iso_affine affine; /* of the view */
    const iso_point_cells *cells;
    uint8_t *group;               /* one per point of the cells; NO_GROUP: not yet */
    tally *tallies;               /* one per block */
    const iso_cell_block *blocks; /* of one pass; its tallies begin at the same number */
    size_t first_block;
    int limit;
    bool by_number, by_normals, ignore_opposite;
    double least_cosine, most_sine; /* of rule 1; least_cosine above 1: it is not followed */
    const iso_groups_memory *last;  /* of the last call, or NULL: all points are coloured */
    /* One per block: its points, or their groups, differ from those of the last call. */
    uint8_t *altered;
} colouring;

/* The points in the cells around a cell: of its own level and of all coarser levels. */
typedef struct surroundings {
    iso_cell_range range[ISO_CELL_RANGES];
    int count;
} surroundings;

static iso_vec3 vector_between(const iso_cell_point *a, const iso_cell_point *b) {
    return iso_vec3_make((double)(b->position[0] - a->position[0]), (double)(b->position[1] - a->position[1]),
                         (double)(b->position[2] - a->position[2]));
}

static bool have_other_colors(const iso_point_view *view, uint32_t a, uint32_t b) {
    return view->colors && memcmp(view->colors[a], view->colors[b], sizeof view->colors[a]) != 0;
}

/* Whether two points that overlap do not conflict, by rule 1 or 2. */
static bool is_allowed(const colouring *c, const iso_cell_point *a, const iso_cell_point *b) {
    iso_vec3 normal[2];
    for (int i = 0; i < 2; i++) {
        const iso_surfel surfel = iso_point_view_get(c->view, i ? b->index : a->index);
        normal[i] = iso_affine_normal(&c->affine,
                                      iso_vec3_make(surfel.normal[0], surfel.normal[1], surfel.normal[2]));
    }
    const double cosine = iso_vec3_dot(normal[0], normal[1]);
    if (c->ignore_opposite && cosine < 0) return true;
    if (cosine < c->least_cosine || have_other_colors(c->view, a->index, b->index)) return false;
    const iso_vec3 between = vector_between(a, b);
    const double most = c->most_sine * iso_vec3_length(between);
    return fabs(iso_vec3_dot(normal[0], between)) <= most && fabs(iso_vec3_dot(normal[1], between)) <= most;
}

static float squared_distance(const iso_cell_point *a, const iso_cell_point *b) {
    const float x = a->position[0] - b->position[0], y = a->position[1] - b->position[1],
                z = a->position[2] - b->position[2];
    return x * x + y * y + z * z;
}

static bool do_overlap(const iso_cell_point *a, const iso_cell_point *b) {
    const float reach = a->reach + b->reach;
    return squared_distance(a, b) < reach * reach;
}

/* Returns how much two discs overlap: 0 when they do not, up to 1001 when they are in the same place. (A
 * square or a fourth power works as well as the cube.) */
static uint32_t overlap_of(const iso_cell_point *a, const iso_cell_point *b) {
    const float reach = a->reach + b->reach, part = 1 - squared_distance(a, b) / (reach * reach);
    return part > 0 ? (uint32_t)(1 + 1000 * part * part * part) : 0;
}

/* Counts for each group the points first .. end - 1 in it that conflict with point `at`. */
static void count_range(const colouring *c, iso_cell_range range, const iso_cell_point *at,
                        uint32_t conflicts[COUNTS]) {
    const iso_cell_point *points = c->cells->points.data;
    for (uint32_t i = range.first; i < range.end; i++) conflicts[c->group[i]] += do_overlap(at, &points[i]);
}

/* As count_range, but ignores points that are allowed in the group of point `at`. */
static void count_by_normals(const colouring *c, iso_cell_range range, const iso_cell_point *at,
                             uint32_t conflicts[COUNTS]) {
    const iso_cell_point *points = c->cells->points.data;
    for (uint32_t i = range.first; i < range.end; i++)
        conflicts[c->group[i]] += do_overlap(at, &points[i]) && !is_allowed(c, at, &points[i]);
}

/* Returns the first `most` points of a range. */
static iso_cell_range limited(iso_cell_range range, uint32_t most) {
    return (iso_cell_range){range.first, range.end - range.first > most ? range.first + most : range.end};
}

/* Adds up for each group how much its discs overlap that of point `at`. */
static void weigh_conflicts(const colouring *c, const surroundings *around, const iso_cell_point *at,
                            uint32_t weights[COUNTS]) {
    const iso_cell_point *points = c->cells->points.data;
    uint32_t left = LOOKED_AT;
    for (int r = 0; r < around->count && left; r++) {
        const iso_cell_range range = limited(around->range[r], left);
        for (uint32_t i = range.first; i < range.end; i++) {
            const uint32_t overlap = overlap_of(at, &points[i]);
            const bool allowed = overlap && c->by_normals && is_allowed(c, at, &points[i]);
            weights[c->group[i]] += allowed ? 0 : overlap;
        }
        left -= range.end - range.first;
    }
}

/* Returns the first group with the fewest conflicts, or with the least weight of conflicts. */
static int best_group(const uint32_t conflicts[ISO_GROUPS_MOST], int limit) {
    int best = 0;
    for (int k = 1; k < limit && conflicts[best]; k++)
        if (conflicts[k] < conflicts[best]) best = k;
    return best;
}

static void colour_cell(const colouring *c, uint32_t cell, tally *t) {
    const iso_point_cell *first = (const iso_point_cell *)c->cells->cells.data + cell;
    const iso_cell_point *points = c->cells->points.data;
    surroundings around;
    around.count = iso_point_cells_all_around(c->cells, cell, around.range, NULL);
    for (uint32_t i = first[0].first; i < first[1].first; i++) {
        uint32_t conflicts[COUNTS] = {0};
        uint32_t left = LOOKED_AT;
        for (int r = 0; r < around.count && left; r++) {
            const iso_cell_range range = limited(around.range[r], left);
            (c->by_normals ? count_by_normals : count_range)(c, range, &points[i], conflicts);
            left -= range.end - range.first;
        }
        for (int k = 0; k < c->limit; k++) t->joined += conflicts[k];
        int group = best_group(conflicts, c->limit);
        if (conflicts[group] && !c->by_number) { /* no group is free */
            uint32_t weights[COUNTS] = {0};
            weigh_conflicts(c, &around, &points[i], weights);
            group = best_group(weights, c->limit);
        }
        t->conflicts += conflicts[group];
        t->count = group >= t->count ? group + 1 : t->count;
        c->group[i] = (uint8_t)group;
    }
}

/* ---- updating */

static iso_cell_range points_of(const iso_point_cells *cells, const iso_cell_block *block) {
    const iso_point_cell *cell = cells->cells.data;
    return (iso_cell_range){cell[block->first].first, cell[block->end].first};
}

static const iso_cell_block *last_block(const colouring *c, uint64_t key) {
    return c->last ? iso_point_cells_block(&c->last->cells, key) : NULL;
}

static tally *last_tally(const colouring *c, const iso_cell_block *block) {
    return c->last->tallies + (block - (const iso_cell_block *)c->last->cells.blocks.data);
}

static bool has_same_cells(const iso_point_cells *a, const iso_cell_block *in_a, const iso_point_cells *b,
                           const iso_cell_block *in_b) {
    const iso_point_cell *of_a = (const iso_point_cell *)a->cells.data + in_a->first,
                         *of_b = (const iso_point_cell *)b->cells.data + in_b->first;
    const uint32_t count = in_a->end - in_a->first;
    if (in_b->end - in_b->first != count) return false;
    for (uint32_t i = 0; i < count; i++)
        if (of_a[i].key != of_b[i].key || of_a[i].first - of_a[0].first != of_b[i].first - of_b[0].first)
            return false;
    return true;
}

/* Returns whether two blocks have the same points in the same cells, except for the points' indices. */
static bool is_same_block(const iso_point_cells *a, const iso_cell_block *in_a, const iso_point_cells *b,
                          const iso_cell_block *in_b) {
    const iso_cell_range of_a = points_of(a, in_a), of_b = points_of(b, in_b);
    const iso_cell_point *at = (const iso_cell_point *)a->points.data + of_a.first,
                         *to = (const iso_cell_point *)b->points.data + of_b.first;
    const uint32_t count = of_a.end - of_a.first;
    if (of_b.end - of_b.first != count || !has_same_cells(a, in_a, b, in_b)) return false;
    for (uint32_t i = 0; i < count; i++)
        if (memcmp(&at[i], &to[i], offsetof(iso_cell_point, index)) != 0) return false;
    return true;
}

static void compare_block(void *context, size_t index, int worker) {
    (void)worker;
    const colouring *c = context;
    const iso_cell_block *block = &c->blocks[index], *last = last_block(c, block->key);
    c->altered[index] = !last || !is_same_block(c->cells, block, &c->last->cells, last);
}

/* Returns whether a block that exists now, or existed in the last call, is altered. */
static bool is_altered(const colouring *c, uint64_t key) {
    const iso_cell_block *block = iso_point_cells_block(c->cells, key);
    return block ? c->altered[block - c->blocks] : last_block(c, key) != NULL;
}

static bool is_altered_around(const colouring *c, uint64_t key) {
    for (int level = 0; level <= iso_point_cells_block_level(key); level++) {
        if (!((c->cells->levels | c->last->cells.levels) >> level & 1)) continue;
        uint64_t keys[ISO_CELL_BLOCKS_AROUND];
        const int count = iso_point_cells_blocks_around(key, level, keys);
        for (int i = 0; i < count; i++)
            if (is_altered(c, keys[i])) return true;
    }
    return false;
}

/* Copies the groups of a block from the last call. */
static void copy_block(const colouring *c, size_t number) {
    const iso_cell_block *last = last_block(c, c->blocks[number].key);
    const iso_cell_range from = points_of(&c->last->cells, last),
                         to = points_of(c->cells, &c->blocks[number]);
    memcpy(c->group + to.first, c->last->group + from.first, to.end - to.first);
    c->tallies[number] = *last_tally(c, last);
    c->tallies[number].computed = 0;
}

/* Sets whether a block that has just been coloured is altered. */
static void compare_groups(const colouring *c, size_t number) {
    if (c->altered[number]) return; /* its points have changed */
    const iso_cell_range from = points_of(&c->last->cells, last_block(c, c->blocks[number].key)),
                         to = points_of(c->cells, &c->blocks[number]);
    c->altered[number] = memcmp(c->group + to.first, c->last->group + from.first, to.end - to.first) != 0;
}

/* ---- all blocks */

static void colour_block(void *context, size_t index, int worker) {
    (void)worker;
    const colouring *c = context;
    const size_t number = c->first_block + index;
    const iso_cell_block *block = &c->blocks[number];
    if (c->last && !is_altered_around(c, block->key)) {
        copy_block(c, number);
        return;
    }
    const iso_cell_range points = points_of(c->cells, block);
    c->tallies[number].computed = points.end - points.first;
    for (uint32_t cell = block->first; cell < block->end; cell++) colour_cell(c, cell, &c->tallies[number]);
    if (c->last) compare_groups(c, number);
}

static void colour_all(colouring *c, iso_pool *pool) {
    const size_t *start = c->cells->start, blocks = start[ISO_CELL_LEVELS * ISO_CELL_PARITIES];
    memset(c->group, NO_GROUP, c->cells->point_count);
    if (c->last) iso_parallel_for(pool, blocks, compare_block, c);
    for (size_t list = 0; list < ISO_CELL_LEVELS * ISO_CELL_PARITIES; list++) {
        c->first_block = start[list];
        iso_parallel_for(pool, start[list + 1] - start[list], colour_block, c);
    }
}

/* Adds up the tallies of the blocks, and writes the groups in the order of the view's arrays. */
static void collect(const colouring *c, iso_groups *groups) {
    const iso_cell_point *points = c->cells->points.data;
    for (size_t i = 0; i < c->cells->start[ISO_CELL_LEVELS * ISO_CELL_PARITIES]; i++) {
        const tally *t = &c->tallies[i];
        groups->conflicts += t->conflicts;
        groups->joined += t->joined;
        groups->computed += t->computed;
        groups->count = t->count > groups->count ? t->count : groups->count;
    }
    for (size_t i = 0; i < c->cells->point_count; i++) groups->group[points[i].index] = c->group[i];
}

size_t iso_groups_length(const iso_point_view *view) {
    size_t length = 0;
    for (size_t s = 0; s < view->span_count; s++) {
        const size_t end = view->spans[s].first + view->spans[s].count;
        length = end > length ? end : length;
    }
    return length;
}

/* Returns whether points that have not changed get the same groups as in the last call. The cells' points
 * have no normals, so changes of normals are not noticed. */
static bool is_comparable(const iso_groups_memory *last, const colouring *c) {
    return last && !c->by_normals && !last->by_normals && last->limit == c->limit &&
           last->by_number == c->by_number;
}

/* Colours the points of memory->cells, and sets the groups and the rest of the memory. */
static iso_status colour(const iso_point_view *view, const iso_groups_opts *opts, iso_groups_memory *memory,
                         const iso_groups_memory *last, iso_groups *groups, iso_error *error) {
    const iso_point_cells *cells = &memory->cells;
    const size_t blocks = cells->start[ISO_CELL_LEVELS * ISO_CELL_PARITIES];
    double sine, cosine;
    iso_sincos(opts->coplanar * (3.14159265358979323846 / 180), &sine, &cosine);
    memory->group = iso_alloc(cells->point_count);
    memory->tallies = iso_alloc_zero(blocks, sizeof *memory->tallies);
    memory->limit = opts->limit ? opts->limit : ISO_GROUPS_MOST;
    memory->by_normals = opts->ignore_opposite || opts->coplanar > 0;
    memory->by_number = opts->by_number;
    colouring c = {.view = view,
                   .affine = iso_transform_affine(&view->transform),
                   .cells = cells,
                   .group = memory->group,
                   .tallies = memory->tallies,
                   .blocks = cells->blocks.data,
                   .limit = memory->limit,
                   .by_normals = memory->by_normals,
                   .ignore_opposite = opts->ignore_opposite,
                   .least_cosine = opts->coplanar > 0 ? cosine : 2,
                   .most_sine = sine,
                   .by_number = memory->by_number,
                   .altered = iso_alloc(blocks)};
    c.last = is_comparable(last, &c) ? last : NULL;
    groups->group = iso_alloc_zero(iso_groups_length(view), 1);
    const bool enough = c.group && c.tallies && c.altered && groups->group;
    if (enough) {
        colour_all(&c, opts->pool);
        collect(&c, groups);
    }
    iso_free(c.altered);
    return enough ? ISO_OK : iso_fail(error, ISO_ERR_NOMEM, "out of memory for groups of points");
}

static void free_memory(iso_groups_memory *memory) {
    if (!memory) return;
    iso_point_cells_free(&memory->cells);
    iso_free(memory->group);
    iso_free(memory->tallies);
    iso_free(memory);
}

iso_status iso_groups_update(const iso_point_view *view, const iso_groups_opts *opts, iso_groups *groups,
                             iso_error *error) {
    const double disc = opts->disc > 0 ? opts->disc : 1, overlap = opts->overlap > 0 ? opts->overlap : 1;
    iso_groups updated = {.memory = iso_alloc_zero(1, sizeof *updated.memory)};
    iso_status status = updated.memory
                            ? iso_point_cells_make(&updated.memory->cells, view, disc * overlap, error)
                            : iso_fail(error, ISO_ERR_NOMEM, "out of memory for groups of points");
    if (status == ISO_OK) status = colour(view, opts, updated.memory, groups->memory, &updated, error);
    iso_groups_free(groups);
    *groups = updated;
    if (status != ISO_OK) iso_groups_free(groups);
    return status;
}

iso_status iso_groups_make(const iso_point_view *view, const iso_groups_opts *opts, iso_groups *groups,
                           iso_error *error) {
    *groups = (iso_groups){0};
    const iso_status status = iso_groups_update(view, opts, groups, error);
    free_memory(groups->memory);
    groups->memory = NULL;
    return status;
}

size_t iso_groups_memory_bytes(const iso_groups *groups) {
    if (!groups->memory) return 0;
    const iso_point_cells *cells = &groups->memory->cells;
    return sizeof *groups->memory + cells->points.bytes + cells->cells.bytes + cells->blocks.bytes +
           cells->table.bytes + cells->point_count +
           cells->start[ISO_CELL_LEVELS * ISO_CELL_PARITIES] * sizeof(tally);
}

void iso_groups_free(iso_groups *groups) {
    iso_free(groups->group);
    iso_free(groups->copies);
    free_memory(groups->memory);
    *groups = (iso_groups){0};
}
