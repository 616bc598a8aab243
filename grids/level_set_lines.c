/* Converts lines to a level set: the union of the rounded cones around their segments. Segments are listed
 * for the cells whose bricks they may reach; every voxel of such a cell gets the least distance to a listed
 * segment. */
#include <math.h>

#include "base/memory.h"
#include "grids/level_set.h"

static const double BAND = 3;
/* The distance from the centre of a brick to its outermost voxels, in voxels. */
static const double BRICK_RADIUS = 12.991;
/* Bricks are divided into cubes of 4^3 voxels. SUBBRICK_RADIUS: the distance from the centre of such a cube
 * to its outermost voxels. */
enum { SUBBRICK = 4 };
static const double SUBBRICK_RADIUS = 2.599;

/* A rounded cone in voxels, prepared for computing distances. If the ball at one end of a segment contains
 * the ball at the other end, the cone is the larger ball alone. */
typedef struct rounded_cone {
    double a[3], axis[3]; /* one end; the unit vector to the other one */
    double length, radius;
    double sine, cosine; /* of the angle between flank and axis; radius falls by `sine` a voxel of length */
} rounded_cone;

typedef struct conversion {
    const char *path;
    iso_hgrid *grid;
    rounded_cone *cones;
    size_t cone_count;
    size_t *start;    /* by cell: first of its items; one more entry for the end */
    uint32_t *items;  /* numbers of cones */
    uint32_t *bricks; /* numbers of the cells with items */
    size_t brick_count;
    size_t most_items;  /* of a cell */
    uint32_t *selected; /* room for most_items numbers by worker */
    iso_progress progress;
} conversion;

/* ---- distances */

static rounded_cone make_cone(const double a[3], double radius_a, const double b[3], double radius_b) {
    rounded_cone c = {.radius = radius_a, .cosine = 1};
    double square = 0;
    for (int k = 0; k < 3; k++) {
        c.a[k] = a[k];
        c.axis[k] = b[k] - a[k];
        square += c.axis[k] * c.axis[k];
    }
    const double length = sqrt(square), fall = radius_a - radius_b;
    if (length <= fabs(fall)) {
        for (int k = 0; k < 3; k++) c.a[k] = radius_a >= radius_b ? a[k] : b[k];
        c.radius = fmax(radius_a, radius_b);
        return c; /* a cone of length 0, that is a ball */
    }
    for (int k = 0; k < 3; k++) c.axis[k] /= length;
    c.length = length;
    c.sine = fall / length;
    c.cosine = sqrt(1 - c.sine * c.sine);
    return c;
}

/* Returns the signed distance from p to the cone's surface. On the flank, the nearest point lies in the
 * direction (sine, cosine) from the centre of a ball on the axis; beyond the ends of the axis the surface is
 * that of the ball at that end. */
static double distance_to(const rounded_cone *c, const double p[3]) {
    double along = 0, square = 0;
    for (int k = 0; k < 3; k++) {
        const double d = p[k] - c->a[k];
        along += d * c->axis[k];
        square += d * d;
    }
    const double away = sqrt(fmax(square - along * along, 0)), centre = along - away * c->sine / c->cosine;
    if (!(centre > 0) || c->length == 0) return sqrt(square) - c->radius;
    if (centre < c->length) return c->cosine * away + c->sine * along - c->radius;
    const double beyond = along - c->length;
    return sqrt(away * away + beyond * beyond) - (c->radius - c->sine * c->length);
}

/* ---- cones */

static void to_voxels(const conversion *c, const iso_lines *lines, size_t vertex, double at[3]) {
    const double origin[3] = {lines->origin.x, lines->origin.y, lines->origin.z};
    for (int k = 0; k < 3; k++)
        at[k] = (origin[k] + (double)lines->vertices[vertex][k] - c->grid->transform.origin[k]) /
                c->grid->transform.spacing[k];
}

static double radius_of(const iso_lines *lines, size_t vertex, double radius) {
    return lines->radii ? (double)lines->radii[vertex] : radius;
}

/* The radius in voxels that a vertex is drawn with. */
static double radius_in_voxels(const conversion *c, const iso_lines *lines, size_t vertex, double radius) {
    return fmax(radius_of(lines, vertex, radius) / c->grid->transform.spacing[0], ISO_TUBE_VOXELS);
}

static void make_cones(conversion *c, const iso_lines *lines, double radius) {
    for (size_t line = 0; line < lines->line_count; line++)
        for (size_t i = lines->starts[line]; i < lines->starts[line + 1]; i++) {
            const bool last = i + 1 == lines->starts[line + 1];
            if (last && i > lines->starts[line]) continue;
            const size_t next = last ? i : i + 1; /* a line of one vertex is a ball */
            double a[3], b[3];
            to_voxels(c, lines, i, a);
            to_voxels(c, lines, next, b);
            c->cones[c->cone_count++] = make_cone(a, radius_in_voxels(c, lines, i, radius), b,
                                                  radius_in_voxels(c, lines, next, radius));
        }
}

/* ---- cells */

/* Computes the cells that a cone's band may reach: first and last on each axis. */
static void cells_of(const conversion *c, const rounded_cone *cone, int lo[3], int hi[3]) {
    const double reach = fmax(cone->radius, cone->radius - cone->sine * cone->length) + BAND;
    for (int k = 0; k < 3; k++) {
        const double b = cone->a[k] + cone->axis[k] * cone->length;
        const double low = fmin(cone->a[k], b) - reach, high = fmax(cone->a[k], b) + reach;
        lo[k] = (int)(fmax(low, 0) / ISO_BRICK);
        hi[k] = (int)(fmin(high, c->grid->dims[k] - 1) / ISO_BRICK);
    }
}

static bool reaches(const rounded_cone *cone, const int cell[3]) {
    const double middle = (ISO_BRICK - 1) / 2.0,
                 p[3] = {cell[0] * ISO_BRICK + middle, cell[1] * ISO_BRICK + middle,
                         cell[2] * ISO_BRICK + middle};
    return distance_to(cone, p) < BAND + BRICK_RADIUS;
}

/* Lists the cones of every cell, or (items NULL) counts them in start[cell + 1]. */
static void list_cones(conversion *c) {
    for (size_t i = 0; i < c->cone_count; i++) {
        int lo[3], hi[3], at[3];
        cells_of(c, &c->cones[i], lo, hi);
        for (at[2] = lo[2]; at[2] <= hi[2]; at[2]++)
            for (at[1] = lo[1]; at[1] <= hi[1]; at[1]++)
                for (at[0] = lo[0]; at[0] <= hi[0]; at[0]++) {
                    if (!reaches(&c->cones[i], at)) continue;
                    const size_t cell = iso_hgrid_cell_index(c->grid, at[0], at[1], at[2]);
                    if (c->items)
                        c->items[c->start[cell]++] = (uint32_t)i;
                    else
                        c->start[cell + 1]++;
                }
    }
}

/* Lists the cones by cell, and gives bricks to the cells with cones. */
static iso_status make_cells(conversion *c, iso_error *error) {
    const size_t cells = iso_hgrid_cell_count(c->grid);
    c->start = iso_alloc_zero(cells + 2, sizeof *c->start);
    c->bricks = iso_alloc(cells * sizeof *c->bricks);
    if (!c->start || !c->bricks) return iso_fail_memory(error, c->path);
    list_cones(c);
    for (size_t cell = 0; cell < cells; cell++) c->start[cell + 1] += c->start[cell];
    c->items = iso_alloc(c->start[cells] * sizeof *c->items);
    if (!c->items) return iso_fail_memory(error, c->path);
    list_cones(c); /* this moves every start to that of the next cell */
    for (size_t cell = cells; cell > 0; cell--) c->start[cell] = c->start[cell - 1];
    c->start[0] = 0;
    for (size_t cell = 0; cell < cells; cell++) {
        int at[3];
        if (c->start[cell] == c->start[cell + 1]) continue;
        iso_hgrid_cell_position(c->grid, cell, at);
        ISO_TRY(iso_hgrid_split_unset(c->grid, at[0], at[1], at[2], error));
        c->bricks[c->brick_count++] = (uint32_t)cell;
        const size_t items = c->start[cell + 1] - c->start[cell];
        if (items > c->most_items) c->most_items = items;
    }
    return ISO_OK;
}

/* Selects the cones that may be nearest to a voxel of a cube of SUBBRICK^3 voxels: those whose distance from
 * its centre exceeds the least distance by no more than the cube's diameter. Returns the least distance. */
static double select_cones(const conversion *c, size_t cell, const double centre[3], uint32_t *selected,
                           size_t *count) {
    double least = INFINITY;
    *count = 0;
    for (size_t k = c->start[cell]; k < c->start[cell + 1]; k++)
        least = fmin(least, distance_to(&c->cones[c->items[k]], centre));
    if (fabs(least) >= BAND + SUBBRICK_RADIUS) return least;
    for (size_t k = c->start[cell]; k < c->start[cell + 1]; k++)
        if (distance_to(&c->cones[c->items[k]], centre) <= least + 2 * SUBBRICK_RADIUS)
            selected[(*count)++] = c->items[k];
    return least;
}

/* Writes the distances of a cube of SUBBRICK^3 voxels. corner: the cube's first voxel in the brick; first:
 * the brick's first voxel in the grid. */
static void fill_subbrick(const conversion *c, size_t cell, const int first[3], const int corner[3],
                          uint32_t *selected, float *brick) {
    const double middle = (SUBBRICK - 1) / 2.0,
                 centre[3] = {first[0] + corner[0] + middle, first[1] + corner[1] + middle,
                              first[2] + corner[2] + middle};
    size_t count;
    const double far = select_cones(c, cell, centre, selected, &count);
    for (int i = 0; i < SUBBRICK * SUBBRICK * SUBBRICK; i++) {
        const int x = corner[0] + i % SUBBRICK, y = corner[1] + i / SUBBRICK % SUBBRICK,
                  z = corner[2] + i / (SUBBRICK * SUBBRICK);
        const double p[3] = {first[0] + x, first[1] + y, first[2] + z};
        double least = count ? INFINITY : far;
        for (size_t k = 0; k < count; k++) least = fmin(least, distance_to(&c->cones[selected[k]], p));
        brick[(z * ISO_BRICK + y) * ISO_BRICK + x] = (float)fmin(fmax(least, -BAND), BAND);
    }
}

static void fill_brick(void *context, size_t index, int worker) {
    conversion *c = context;
    const size_t cell = c->bricks[index];
    float *brick = iso_hgrid_brick(c->grid, c->grid->cell[cell]);
    uint32_t *selected = c->selected + (size_t)worker * c->most_items;
    int first[3], corner[3];
    if (iso_progress_tell(&c->progress, "", (double)index / (double)c->brick_count, NULL) != ISO_OK) return;
    iso_hgrid_cell_position(c->grid, cell, first);
    for (int k = 0; k < 3; k++) first[k] *= ISO_BRICK;
    for (corner[2] = 0; corner[2] < ISO_BRICK; corner[2] += SUBBRICK)
        for (corner[1] = 0; corner[1] < ISO_BRICK; corner[1] += SUBBRICK)
            for (corner[0] = 0; corner[0] < ISO_BRICK; corner[0] += SUBBRICK)
                fill_subbrick(c, cell, first, corner, selected, brick);
}

/* ---- conversion */

/* Returns the bounding box of all tubes; counts the radii below ISO_TUBE_VOXELS. */
static iso_box tubes_box(const iso_lines *lines, double radius, double voxel, size_t *widened) {
    iso_box box = iso_box_empty();
    *widened = 0;
    for (size_t i = 0; i < lines->vertex_count; i++) {
        const double own = radius_of(lines, i, radius), r = fmax(own, ISO_TUBE_VOXELS * voxel);
        const float *v = lines->vertices[i];
        const iso_vec3 p =
            iso_vec3_add(lines->origin, iso_vec3_make((double)v[0], (double)v[1], (double)v[2]));
        iso_box_add(&box, iso_vec3_sub(p, iso_vec3_make(r, r, r)));
        iso_box_add(&box, iso_vec3_add(p, iso_vec3_make(r, r, r)));
        *widened += own < ISO_TUBE_VOXELS * voxel;
    }
    return box;
}

static iso_status convert_lines(conversion *c, const iso_lines *lines, double radius,
                                const iso_sampling *sampling, iso_error *error) {
    c->cones = iso_alloc(lines->vertex_count * sizeof *c->cones);
    if (!c->cones) return iso_fail_memory(error, c->path);
    make_cones(c, lines, radius);
    ISO_TRY(make_cells(c, error));
    c->selected = iso_alloc((size_t)iso_pool_threads(sampling->pool) * c->most_items * sizeof *c->selected);
    if (!c->selected) return iso_fail_memory(error, c->path);
    iso_parallel_for(sampling->pool, c->brick_count, fill_brick, c);
    iso_hgrid_prune(c->grid);
    return iso_progress_tell(&c->progress, c->path, 1, error);
}

iso_status iso_level_set_from_lines(const char *path, const iso_lines *lines, double radius,
                                    const iso_sampling *sampling, iso_hgrid **grid, size_t *widened,
                                    iso_error *error) {
    size_t thin;
    conversion c = {.path = path, .progress = iso_progress_part(sampling->progress, 0, 1)};
    const iso_box box = tubes_box(lines, radius, sampling->voxel, &thin);
    if (iso_box_is_empty(&box)) return iso_fail(error, ISO_ERR_EMPTY, "%s: holds no lines", path);
    if (lines->vertex_count >= UINT32_MAX)
        return iso_fail(error, ISO_ERR_LIMIT, "%s: %zu vertices are too many", path, lines->vertex_count);
    ISO_TRY(iso_level_set_around(path, &box, sampling, &c.grid, error));
    iso_status status = convert_lines(&c, lines, radius, sampling, error);
    iso_free(c.cones);
    iso_free(c.start);
    iso_free(c.items);
    iso_free(c.bricks);
    iso_free(c.selected);
    if (status != ISO_OK) {
        iso_hgrid_destroy(c.grid);
        return status;
    }
    *grid = c.grid;
    if (widened) *widened = thin;
    return ISO_OK;
}
