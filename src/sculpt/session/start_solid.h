/* start_solid: the solid that a new session begins with, and its field. */
#ifndef ISO_SCULPT_SESSION_START_SOLID_H
#define ISO_SCULPT_SESSION_START_SOLID_H

#include "base/c_linkage.h"
#include "base/geometry.h"
#include "base/status.h"
#include "grids/hgrid.h"
#include "isopoint_sculpt.h"

ISO_C_BEGIN

struct iso_journal_start;

/* A sphere, box, capsule, cylinder or torus around the world's origin, the last three around the z axis. */
typedef struct iso_start_solid {
    iso_solid kind;
    iso_vec3 size; /* of its bounding box, mm; x = 0: there is none. All but a box have the same size along x
                      and y, whatever y says; a torus is a ring of x, whose tube has the diameter z */
    double round;  /* of a box or cylinder: the radius of its edges, mm */
} iso_start_solid;

/* Checks kind and sizes, whose unit is `voxel` mm. ISO_ERR_USAGE: a size is not positive, or one of them does
 * not fit the others; ISO_ERR_FORMAT: one is outside its bounds (sculpt/limits.h). */
iso_status iso_start_solid_check(const iso_start_solid *solid, double voxel, iso_error *error);

/* The signed distance of a point to the solid's surface, in the unit of the sizes: exact, everywhere. */
double iso_start_solid_distance(const iso_start_solid *solid, iso_vec3 point);

/* Describes the start of a session with the solid in a grid that has room of .7 of its longest side around
 * it. voxel: mm; 0: 1/160 of the longest side. ISO_ERR_USAGE: as above, or the solid is thinner than two
 * voxels; ISO_ERR_LIMIT: the grid is too large. */
iso_status iso_start_with_solid(const iso_start_solid *solid, double voxel, struct iso_journal_start *start,
                                iso_error *error);
/* Whether a session begins with a solid, and with which (size.x = 0: with none). */
bool iso_start_has_solid(const struct iso_journal_start *start);
iso_start_solid iso_start_get_solid(const struct iso_journal_start *start);

/* Makes the level set of a new session: a grid as `start` describes it, with its solid. The caller owns
 * *grid. ISO_ERR_USAGE: a size that is not positive; ISO_ERR_LIMIT, ISO_ERR_NOMEM. */
iso_status iso_session_solid(const struct iso_journal_start *start, iso_hgrid **grid, iso_error *error);

ISO_C_END
#endif
