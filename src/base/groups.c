/* groups: colours the graph of overlapping discs greedily (Zhang and Pajarola 2006, section 4.1). Levels are
 * processed from the largest discs to the smallest; within a level, blocks of cells are processed in 8
 * passes, each of which takes the blocks of one parity. */
#include "base/groups.h"

#include <string.h>

#include "base/point_cells.h"

/* Counts are kept by group, and by NO_GROUP for points that have no group yet. */
enum {
    NO_GROUP = ISO_GROUPS_MOST,
    COUNTS,
    RANGES = ISO_CELL_ROWS * ISO_CELL_LEVELS,
    /* The largest number of neighbours of a point that are examined. It is much larger than the number of
     * groups; only where very many discs lie on top of each other are there more neighbours. */
    LOOKED_AT = 4096
};

/* The share of one block of cells in the counts of iso_groups. */
typedef struct tally {
    size_t conflicts, joined;
    int count;
} tally;

typedef struct colouring {
    const iso_point_view *view;
    const iso_point_cells *cells;
    uint8_t *group;               /* one per point of the cells; NO_GROUP: not yet */
    tally *tallies;               /* one per block */
    const iso_cell_block *blocks; /* of one pass; its tallies begin at the same number */
    size_t first_block;
    int limit;
    bool ignore_opposite, by_number;
} colouring;

/* The points in the cells around a cell: of its own level and of all coarser levels. */
typedef struct surroundings {
    iso_cell_range range[RANGES];
    int count;
} surroundings;

static void look_around(const colouring *c, uint32_t cell, surroundings *around) {
    const int own = iso_point_cells_level(c->cells, cell);
    around->count = 0;
    for (int level = 0; level <= own; level++)
        if (c->cells->levels >> level & 1)
            around->count += iso_point_cells_around(c->cells, cell, level, around->range + around->count);
}

static bool are_opposite(const iso_point_view *view, uint32_t a, uint32_t b) {
    const iso_affine affine = iso_transform_affine(&view->transform);
    iso_vec3 normal[2];
    for (int i = 0; i < 2; i++) {
        const iso_surfel surfel = iso_point_view_get(view, i ? b : a);
        normal[i] =
            iso_affine_normal(&affine, iso_vec3_make(surfel.normal[0], surfel.normal[1], surfel.normal[2]));
    }
    return iso_vec3_dot(normal[0], normal[1]) < 0;
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

/* As count_range, but ignores points whose normals are opposite to that of point `at`. */
static void count_alike(const colouring *c, iso_cell_range range, const iso_cell_point *at,
                        uint32_t conflicts[COUNTS]) {
    const iso_cell_point *points = c->cells->points.data;
    for (uint32_t i = range.first; i < range.end; i++)
        conflicts[c->group[i]] +=
            do_overlap(at, &points[i]) && !are_opposite(c->view, at->index, points[i].index);
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
            const bool ignored =
                overlap && c->ignore_opposite && are_opposite(c->view, at->index, points[i].index);
            weights[c->group[i]] += ignored ? 0 : overlap;
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
    look_around(c, cell, &around);
    for (uint32_t i = first[0].first; i < first[1].first; i++) {
        uint32_t conflicts[COUNTS] = {0};
        uint32_t left = LOOKED_AT;
        for (int r = 0; r < around.count && left; r++) {
            const iso_cell_range range = limited(around.range[r], left);
            (c->ignore_opposite ? count_alike : count_range)(c, range, &points[i], conflicts);
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

static void colour_block(void *context, size_t index, int worker) {
    (void)worker;
    const colouring *c = context;
    const size_t block = c->first_block + index;
    for (uint32_t cell = c->blocks[block].first; cell < c->blocks[block].end; cell++)
        colour_cell(c, cell, &c->tallies[block]);
}

static void colour_all(colouring *c, iso_pool *pool) {
    const size_t *start = c->cells->start;
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
        groups->count = t->count > groups->count ? t->count : groups->count;
    }
    for (size_t i = 0; i < c->cells->point_count; i++) groups->group[points[i].index] = c->group[i];
}

/* The length of the view's arrays. */
static size_t array_length(const iso_point_view *view) {
    size_t length = 0;
    for (size_t s = 0; s < view->span_count; s++) {
        const size_t end = view->spans[s].first + view->spans[s].count;
        length = end > length ? end : length;
    }
    return length;
}

static iso_status colour(const iso_point_cells *cells, const iso_point_view *view,
                         const iso_groups_opts *opts, iso_groups *groups, iso_error *error) {
    const size_t blocks = cells->start[ISO_CELL_LEVELS * ISO_CELL_PARITIES];
    colouring c = {.view = view,
                   .cells = cells,
                   .group = iso_alloc(cells->point_count),
                   .tallies = iso_alloc_zero(blocks, sizeof(tally)),
                   .blocks = cells->blocks.data,
                   .limit = opts->limit ? opts->limit : ISO_GROUPS_MOST,
                   .ignore_opposite = opts->ignore_opposite,
                   .by_number = opts->by_number};
    *groups = (iso_groups){.group = iso_alloc_zero(array_length(view), 1)};
    const bool enough = c.group && c.tallies && groups->group;
    if (enough) {
        memset(c.group, NO_GROUP, cells->point_count);
        colour_all(&c, opts->pool);
        collect(&c, groups);
    }
    iso_free(c.group);
    iso_free(c.tallies);
    if (enough) return ISO_OK;
    iso_groups_free(groups);
    return iso_fail(error, ISO_ERR_NOMEM, "out of memory for groups of points");
}

iso_status iso_groups_make(const iso_point_view *view, const iso_groups_opts *opts, iso_groups *groups,
                           iso_error *error) {
    const double disc = opts->disc > 0 ? opts->disc : 1, overlap = opts->overlap > 0 ? opts->overlap : 1;
    iso_point_cells cells = {0};
    iso_status status = iso_point_cells_make(&cells, view, disc * overlap, error);
    if (status == ISO_OK) status = colour(&cells, view, opts, groups, error);
    iso_point_cells_free(&cells);
    return status;
}

void iso_groups_free(iso_groups *groups) {
    iso_free(groups->group);
    *groups = (iso_groups){0};
}
