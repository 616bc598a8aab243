/* coverage: estimates areas that discs cover, and finds the factor of radii with which the discs of a group
 * cover a given area (Zhang and Pajarola 2006, section 4.2.2, eq. 7 to 9).
 *
 * The paper subtracts from the area of all discs of a group what other discs of the group overlap of each
 * ("Clipped"), which subtracts an overlap of two discs twice. Here a place that m discs cover counts 1/m for
 * each of them. The paper does not say how overlaps are computed; here each disc has 32 fixed samples, spread
 * evenly by the golden angle (Vogel 1979), and a sample is covered by discs that do not face the opposite way
 * and whose centre is nearer than their radius. The paper's iteration (eq. 9) diverges where the covered area
 * hardly grows any more; here factors up to ISO_COVERAGE_MOST are tried, and bisection finds the least. */
#include "render/groups/coverage.h"

#include "base/point_cells.h"
#include "render/groups/disc_samples.h"

enum {
    SAMPLES = ISO_DISC_SAMPLES,
    DISCS = 8192,      /* whose overlaps are computed, about */
    NEIGHBOURS = 2048, /* most of a disc that are examined */
    FACTORS = 16,      /* that are tried, evenly spaced */
    BISECTIONS = 7     /* between two of them: the result is exact to 1/1000 */
};

#define FACTOR_STEP ((ISO_COVERAGE_MOST - 1) / FACTORS)

/* Chosen by measurement, as pictures compared with sorted layers: algorithms 2 and 3 gain .3 and .5 dB over
 * the square root of half the number of groups (six
 * volumes; 2, 4 and 8 groups); with .99 they gain nothing. */
#define COVERED 0.97

/* A disc near another one. */
typedef struct neighbour {
    float offset[3]; /* mm, between the centres */
    float radius;    /* mm, before enlarging */
    bool same_group;
} neighbour;

/* A disc whose overlaps are computed. */
typedef struct measured {
    float u[3], v[3]; /* tangents times the radius */
    float radius;
    uint8_t group;
    uint32_t point; /* in the cells */
    size_t first;   /* neighbour */
    uint32_t count; /* of neighbours */
} measured;

typedef struct covering {
    const iso_point_view *view;
    iso_affine affine;
    iso_point_cells cells; /* with reaches for the largest factor */
    iso_groups *groups;
    size_t step; /* of so many points of the cells that follow each other one is measured, by chance */
    measured *discs;
    size_t disc_count;
    neighbour *neighbours; /* NULL: they are counted only */
    float samples[SAMPLES][2];
    /* Areas of all discs of a group, and of those that are measured, in mm^2 / pi. Their ratio turns what is
     * measured into what the group covers. */
    double total[ISO_GROUPS_MOST], sampled[ISO_GROUPS_MOST];
    double whole; /* area that all groups together cover, mm^2 / pi */
} covering;

/* ---- neighbours */

static iso_vec3 normal_at(const covering *c, uint32_t point) {
    const iso_cell_point *points = c->cells.points.data;
    const iso_surfel surfel = iso_point_view_get(c->view, points[point].index);
    return iso_affine_normal(&c->affine, iso_vec3_make(surfel.normal[0], surfel.normal[1], surfel.normal[2]));
}

static uint8_t group_at(const covering *c, uint32_t point) {
    return c->groups->group[((const iso_cell_point *)c->cells.points.data)[point].index];
}

/* Adds a point to the neighbours of a measured disc if their discs can overlap. */
static void add_neighbour(covering *c, measured *disc, uint32_t point) {
    const iso_cell_point *points = c->cells.points.data, *at = &points[disc->point], *to = &points[point];
    const bool same = group_at(c, point) == disc->group;
    const float reach = (at->reach + to->reach) / (same ? 1 : (float)ISO_COVERAGE_MOST);
    neighbour n = {.radius = to->reach / (float)ISO_COVERAGE_MOST, .same_group = same};
    float square = 0;
    for (int k = 0; k < 3; k++) {
        n.offset[k] = to->position[k] - at->position[k];
        square += n.offset[k] * n.offset[k];
    }
    if (point == disc->point || !(square < reach * reach) || disc->count == NEIGHBOURS) return;
    if (iso_vec3_dot(normal_at(c, disc->point), normal_at(c, point)) < 0) return;
    if (c->neighbours) c->neighbours[disc->first + disc->count] = n;
    disc->count++;
}

/* Calls add_neighbour for the measured points of one range and all points of the other. */
static void add_pairs(covering *c, iso_cell_range of, iso_cell_range others) {
    for (size_t i = of.first / c->step; i * c->step < of.end; i++) {
        if (c->discs[i].point < of.first || c->discs[i].point >= of.end) continue;
        for (uint32_t j = others.first; j < others.end; j++) add_neighbour(c, &c->discs[i], j);
    }
}

/* Counts the neighbours of all measured discs, or stores them. Points find those of their own and of coarser
 * levels only; so the measured ones among these get the points as well. */
static void find_neighbours(covering *c) {
    const iso_point_cell *cells = c->cells.cells.data;
    iso_cell_range around[ISO_CELL_RANGES];
    for (size_t i = 0; i < c->disc_count; i++) c->discs[i].count = 0;
    for (uint32_t cell = 0; cell < c->cells.cell_count; cell++) {
        const iso_cell_range own = {cells[cell].first, cells[cell + 1].first};
        int same_level;
        const int count = iso_point_cells_all_around(&c->cells, cell, around, &same_level);
        for (int r = 0; r < count; r++) {
            add_pairs(c, around[r], own);
            if (r < same_level) add_pairs(c, own, around[r]);
        }
    }
}

/* ---- areas */

/* Copies those neighbours of a disc that overlap it if both are enlarged; returns how many. */
static int find_overlapping(const covering *c, const measured *disc, float factor, bool all_groups,
                            neighbour found[NEIGHBOURS]) {
    const neighbour *n = c->neighbours + disc->first;
    int count = 0;
    for (uint32_t i = 0; i < disc->count; i++) {
        const float *o = n[i].offset, reach = factor * (disc->radius + n[i].radius);
        if ((n[i].same_group || all_groups) && o[0] * o[0] + o[1] * o[1] + o[2] * o[2] < reach * reach)
            found[count++] = n[i];
    }
    return count;
}

/* Returns by how many of the discs a place is covered (mm, from the centre of the measured disc). */
static int count_covering(const neighbour *discs, int count, const float at[3], float factor) {
    int found = 0;
    for (int i = 0; i < count; i++) {
        const float x = discs[i].offset[0] - at[0], y = discs[i].offset[1] - at[1],
                    z = discs[i].offset[2] - at[2], radius = factor * discs[i].radius;
        found += x * x + y * y + z * z < radius * radius;
    }
    return found;
}

/* Returns the share of a disc in the covered area, in mm^2 / pi. */
static double covered_by(const covering *c, const measured *disc, float factor, bool all_groups) {
    neighbour overlapping[NEIGHBOURS];
    const int count = find_overlapping(c, disc, factor, all_groups, overlapping);
    double share = 0;
    for (int s = 0; s < SAMPLES; s++) {
        float at[3];
        for (int k = 0; k < 3; k++)
            at[k] = factor * (c->samples[s][0] * disc->u[k] + c->samples[s][1] * disc->v[k]);
        share += 1.0 / (1 + count_covering(overlapping, count, at, factor));
    }
    const double radius = (double)(factor * disc->radius);
    return share / SAMPLES * radius * radius;
}

/* Returns the area that a group's discs cover if they are enlarged by a factor. */
static double area_of_group(const covering *c, int group, double factor) {
    double area = 0;
    for (size_t i = 0; i < c->disc_count; i++)
        if (c->discs[i].group == group) area += covered_by(c, &c->discs[i], (float)factor, false);
    return area * (c->total[group] / c->sampled[group]);
}

/* Returns the area that all discs cover. */
static double area_of_all(const covering *c) {
    double area = 0;
    for (size_t i = 0; i < c->disc_count; i++) {
        const uint8_t group = c->discs[i].group;
        area += covered_by(c, &c->discs[i], 1, true) * (c->total[group] / c->sampled[group]);
    }
    return area;
}

/* Finds the first of a few factors that covers an area: sets `low` and `high` to the factor before it and to
 * itself. Where discs are larger than the surface's features, their area stops growing before: then the area
 * wanted is a share of the largest one. Returns the area that is wanted. */
static double bracket(const covering *c, int group, double *low, double *high) {
    double area[FACTORS + 1], most = 0, wanted = COVERED * c->whole;
    int count = 0, first = 0;
    for (; count <= FACTORS && most < wanted; count++) {
        area[count] = area_of_group(c, group, 1 + count * FACTOR_STEP);
        most = area[count] > most ? area[count] : most;
    }
    if (most < wanted) wanted = COVERED * most;
    while (area[first] < wanted) first++;
    *high = 1 + first * FACTOR_STEP;
    *low = first ? *high - FACTOR_STEP : *high;
    return wanted;
}

/* The callback of iso_parallel_for. */
static void widen_group(void *context, size_t group, int worker) {
    (void)worker;
    const covering *c = context;
    double low, high;
    if (!(c->sampled[group] > 0)) return; /* so few points that no factor can be told */
    const double wanted = bracket(c, (int)group, &low, &high);
    for (int i = 0; i < BISECTIONS && low < high; i++) {
        const double middle = (low + high) / 2;
        const bool covers = area_of_group(c, (int)group, middle) >= wanted;
        low = covers ? low : middle;
        high = covers ? middle : high;
    }
    c->groups->widening[group] = (float)high;
}

/* ---- setting up */

/* Returns a number that looks random (the finalizer of MurmurHash3, Appleby). */
static uint32_t scramble(uint32_t number) {
    number = (number ^ number >> 16) * 0x85ebca6bu;
    number = (number ^ number >> 13) * 0xc2b2ae35u;
    return number ^ number >> 16;
}

static float radius_at(const covering *c, size_t point) {
    return ((const iso_cell_point *)c->cells.points.data)[point].reach / (float)ISO_COVERAGE_MOST;
}

/* Chooses a point to be measured. A fixed place in each step would prefer groups, which follow a pattern
 * where points do. */
static void start_disc(covering *c, size_t number) {
    measured *disc = &c->discs[number];
    const size_t first = number * c->step, left = c->cells.point_count - first;
    const uint32_t point =
        (uint32_t)(first + scramble((uint32_t)number + 1) % (left < c->step ? left : c->step));
    const iso_vec3 along = normal_at(c, point);
    const float normal[3] = {(float)along.x, (float)along.y, (float)along.z};
    *disc = (measured){.point = point, .group = group_at(c, point), .radius = radius_at(c, point)};
    iso_curvature_frame(normal, disc->u, disc->v);
    for (int k = 0; k < 3; k++) {
        disc->u[k] *= disc->radius;
        disc->v[k] *= disc->radius;
    }
    c->sampled[disc->group] += (double)disc->radius * (double)disc->radius;
}

static iso_status measure(covering *c, iso_pool *pool, iso_error *error) {
    size_t total = 0;
    c->step = (c->cells.point_count + DISCS - 1) / DISCS;
    c->disc_count = c->step ? (c->cells.point_count + c->step - 1) / c->step : 0;
    c->discs = iso_alloc(c->disc_count * sizeof *c->discs);
    if (!c->discs) return iso_fail(error, ISO_ERR_NOMEM, "out of memory for the coverage of groups");
    for (size_t i = 0; i < c->disc_count; i++) start_disc(c, i);
    for (uint32_t i = 0; i < c->cells.point_count; i++)
        c->total[group_at(c, i)] += (double)radius_at(c, i) * (double)radius_at(c, i);
    find_neighbours(c);
    for (size_t i = 0; i < c->disc_count; i++) {
        c->discs[i].first = total;
        total += c->discs[i].count;
    }
    c->neighbours = iso_alloc(total * sizeof *c->neighbours);
    if (!c->neighbours) return iso_fail(error, ISO_ERR_NOMEM, "out of memory for the coverage of groups");
    find_neighbours(c);
    iso_spread_disc_samples(c->samples);
    c->whole = area_of_all(c);
    iso_parallel_for(pool, (size_t)c->groups->count, widen_group, c);
    return ISO_OK;
}

iso_status iso_groups_cover(const iso_point_view *view, double disc, iso_pool *pool, iso_groups *groups,
                            iso_error *error) {
    covering c = {.view = view, .affine = iso_transform_affine(&view->transform), .groups = groups};
    iso_status status = iso_point_cells_make(&c.cells, view, ISO_COVERAGE_MOST * disc, error);
    if (status == ISO_OK) status = measure(&c, pool, error);
    iso_free(c.discs);
    iso_free(c.neighbours);
    iso_point_cells_free(&c.cells);
    return status;
}
