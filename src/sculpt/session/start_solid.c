/* The solids that sessions begin with: their distances, and the level sets of them. */
#include "sculpt/session/start_solid.h"

#include <math.h>
#include <string.h>

#include "sculpt/brush/brush.h"
#include "sculpt/limits.h"
#include "sculpt/session/journal.h"

static const char BALL[] = "ball";

/* ---- distances */

static double length_of(double x, double y) {
    return sqrt(x * x + y * y);
}

/* The distance to the sides of a box or, with c = -INFINITY, of a rectangle, from how far a point lies beyond
 * each pair of sides (negative: between them). */
static double distance_beyond(double a, double b, double c) {
    const iso_vec3 outside = iso_vec3_make(fmax(a, 0), fmax(b, 0), fmax(c, 0));
    return iso_vec3_length(outside) + fmin(fmax(a, fmax(b, c)), 0);
}

double iso_start_solid_distance(const iso_start_solid *solid, iso_vec3 p) {
    const double radius = 0.5 * solid->size.x, half = 0.5 * solid->size.z, round = solid->round;
    const double aside = length_of(p.x, p.y);
    switch (solid->kind) {
    case ISO_SOLID_BOX:
        return distance_beyond(fabs(p.x) - radius + round, fabs(p.y) - 0.5 * solid->size.y + round,
                               fabs(p.z) - half + round) -
               round;
    case ISO_SOLID_CAPSULE:
        return iso_vec3_length(iso_vec3_make(p.x, p.y, fmax(fabs(p.z) - (half - radius), 0))) - radius;
    case ISO_SOLID_CYLINDER:
        return distance_beyond(aside - radius + round, fabs(p.z) - half + round, -INFINITY) - round;
    case ISO_SOLID_TORUS:
        return length_of(aside - (radius - half), p.z) - half;
    default:
        return iso_vec3_length(p) - radius;
    }
}

/* ---- checks */

static iso_status fail_size(const iso_start_solid *solid, const char *what, iso_error *error) {
    return iso_fail(error, ISO_ERR_USAGE, "a %s of %g x %g x %g mm: %s", iso_solid_name(solid->kind),
                    solid->size.x, solid->size.y, solid->size.z, what);
}

static iso_status check_shape(const iso_start_solid *solid, iso_error *error) {
    const iso_vec3 s = solid->size;
    const double least = fmin(s.x, solid->kind == ISO_SOLID_BOX ? fmin(s.y, s.z) : s.z);
    const bool rounds = solid->kind == ISO_SOLID_BOX || solid->kind == ISO_SOLID_CYLINDER;
    if (solid->kind == ISO_SOLID_CAPSULE && s.z < s.x)
        return fail_size(solid, "it is at least as long as it is wide", error);
    if (solid->kind == ISO_SOLID_TORUS && s.x < 2 * s.z)
        return fail_size(solid, "the tube is at most half as wide as the ring", error);
    if (solid->round == 0 || (rounds && solid->round > 0 && solid->round <= 0.5 * least)) return ISO_OK;
    return iso_fail(error, ISO_ERR_USAGE, "a %s with edges of radius %g mm: %s", iso_solid_name(solid->kind),
                    solid->round,
                    rounds ? "at most half of its smallest side" : "only boxes and cylinders have edges");
}

iso_status iso_start_solid_check(const iso_start_solid *solid, double voxel, iso_error *error) {
    const double sizes[] = {solid->size.x, solid->size.y, solid->size.z};
    if (solid->kind < ISO_SOLID_SPHERE || solid->kind > ISO_SOLID_TORUS)
        return iso_fail(error, ISO_ERR_USAGE,
                        "a session begins with a sphere, box, capsule, cylinder or torus");
    for (int axis = 0; axis < 3; axis++) {
        if (!(sizes[axis] > 0)) return fail_size(solid, "sizes are positive", error);
        ISO_TRY(iso_limit_check(ISO_LIMIT_SIZE, sizes[axis], voxel, error));
    }
    if (!isfinite(solid->round)) return iso_fail(error, ISO_ERR_USAGE, "the radius of edges is not finite");
    return check_shape(solid, error);
}

/* ---- the start of a session */

bool iso_start_has_solid(const iso_journal_start *start) {
    return start->solid.size.x > 0 || strcmp(start->source, BALL) == 0;
}

iso_start_solid iso_start_get_solid(const iso_journal_start *start) {
    const double side = 2 * start->radius;
    if (start->solid.size.x > 0 || strcmp(start->source, BALL)) return start->solid;
    return (iso_start_solid){ISO_SOLID_SPHERE, iso_vec3_make(side, side, side), 0};
}

/* The smallest thickness of the solid. */
static double thickness_of(const iso_start_solid *solid) {
    const iso_vec3 s = solid->size;
    return fmin(s.x, solid->kind == ISO_SOLID_BOX ? fmin(s.y, s.z) : s.z);
}

static iso_status choose_grid(const iso_start_solid *solid, iso_journal_start *start, iso_error *error) {
    const double sizes[] = {solid->size.x, solid->size.y, solid->size.z}, voxel = start->voxel_size;
    const double longest = fmax(sizes[0], fmax(sizes[1], sizes[2]));
    double origin[3];
    for (int axis = 0; axis < 3; axis++) {
        const double voxels = ceil((sizes[axis] + 7 * longest / 5) / voxel / ISO_BRICK) * ISO_BRICK;
        if (!(voxels <= ISO_HGRID_MAX))
            return iso_fail(
                error, ISO_ERR_LIMIT,
                "a %s of %g mm in voxels of %g mm: its grid would have %g of them along %c, at most %d",
                iso_solid_name(solid->kind), longest, voxel, voxels, "xyz"[axis], ISO_HGRID_MAX);
        start->dims[axis] = (int)voxels;
        origin[axis] = -0.5 * (voxels - 1) * voxel;
    }
    start->origin = iso_vec3_make(origin[0], origin[1], origin[2]);
    return ISO_OK;
}

iso_status iso_start_with_solid(const iso_start_solid *given, double voxel, iso_journal_start *start,
                                iso_error *error) {
    iso_start_solid solid = *given;
    const bool sphere = solid.kind == ISO_SOLID_SPHERE;
    if (solid.kind != ISO_SOLID_BOX) solid.size.y = solid.size.x;
    if (sphere) solid.size.z = solid.size.x;
    const double longest = fmax(solid.size.x, fmax(solid.size.y, solid.size.z));
    *start = (iso_journal_start){.voxel_size = voxel > 0 ? voxel : longest / 160};
    if (iso_start_solid_check(&solid, start->voxel_size, error) != ISO_OK) return ISO_ERR_USAGE;
    if (thickness_of(&solid) < 2 * start->voxel_size)
        return iso_fail(error, ISO_ERR_USAGE,
                        "a %s that is %g mm thick needs voxels of at most half of that, not %g mm",
                        iso_solid_name(solid.kind), thickness_of(&solid), start->voxel_size);
    ISO_TRY(choose_grid(&solid, start, error));
    strcpy(start->source, sphere ? BALL : iso_solid_name(solid.kind));
    start->radius = sphere ? 0.5 * solid.size.x : 0;
    if (!sphere) start->solid = solid;
    return ISO_OK;
}

/* ---- the level set */

static iso_vec3 place_in(const int at[3], double x, double y, double z, const double centre[3]) {
    return iso_vec3_make(ISO_BRICK * (double)at[0] + x - centre[0], ISO_BRICK * (double)at[1] + y - centre[1],
                         ISO_BRICK * (double)at[2] + z - centre[2]);
}

/* `solid`: in voxels. */
static iso_status fill_cell(iso_hgrid *grid, const int at[3], const double centre[3],
                            const iso_start_solid *solid, iso_error *error) {
    const double band = (double)grid->band, half = 0.5 * (ISO_BRICK - 1);
    double distance = iso_start_solid_distance(solid, place_in(at, half, half, half, centre));
    iso_hgrid_coalesce(grid, at[0], at[1], at[2], distance < 0 ? ISO_CELL_INSIDE : ISO_CELL_OUTSIDE);
    if (fabs(distance) >= half * sqrt(3) + band) return ISO_OK;
    float *brick;
    ISO_TRY(iso_hgrid_split(grid, at[0], at[1], at[2], &brick, error));
    for (int i = 0; i < ISO_BRICK_VOXELS; i++) {
        const int x = i % ISO_BRICK, y = i / ISO_BRICK % ISO_BRICK, z = i / (ISO_BRICK * ISO_BRICK);
        distance = iso_start_solid_distance(solid, place_in(at, x, y, z, centre));
        brick[i] = (float)(distance > band ? band : distance < -band ? -band : distance);
    }
    return ISO_OK;
}

static iso_status fill_solid(iso_hgrid *grid, const iso_journal_start *start, iso_error *error) {
    const double voxel = start->voxel_size;
    const double centre[3] = {-start->origin.x / voxel, -start->origin.y / voxel, -start->origin.z / voxel};
    iso_start_solid solid = iso_start_get_solid(start);
    solid.size = iso_vec3_make(solid.size.x / voxel, solid.size.y / voxel, solid.size.z / voxel);
    solid.round /= voxel;
    int at[3];
    for (at[2] = 0; at[2] < grid->cells[2]; at[2]++)
        for (at[1] = 0; at[1] < grid->cells[1]; at[1]++)
            for (at[0] = 0; at[0] < grid->cells[0]; at[0]++)
                ISO_TRY(fill_cell(grid, at, centre, &solid, error));
    iso_hgrid_prune(grid);
    return ISO_OK;
}

iso_status iso_session_solid(const iso_journal_start *start, iso_hgrid **out, iso_error *error) {
    const iso_start_solid solid = iso_start_get_solid(start);
    if (!(start->voxel_size > 0) || !isfinite(start->voxel_size) || !(solid.size.x > 0) ||
        !isfinite(solid.size.x))
        return iso_fail(error, ISO_ERR_USAGE, "a %s of %g mm in voxels of %g mm", iso_solid_name(solid.kind),
                        solid.size.x, start->voxel_size);
    iso_transform transform = iso_transform_identity();
    const double origin[3] = {start->origin.x, start->origin.y, start->origin.z};
    for (int axis = 0; axis < 3; axis++) {
        transform.origin[axis] = origin[axis];
        transform.spacing[axis] = start->voxel_size;
    }
    iso_hgrid *grid;
    ISO_TRY(iso_hgrid_create(start->dims, 0, &transform, &grid, error));
    iso_status status = fill_solid(grid, start, error);
    if (status == ISO_OK)
        *out = grid;
    else
        iso_hgrid_destroy(grid);
    return status;
}
