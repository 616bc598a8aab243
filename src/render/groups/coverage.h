/* coverage: how much the discs of a group must be enlarged so that the group covers nearly as much of the
 * surface as all discs together (Zhang and Pajarola 2006, section 4.2.2, eq. 7 to 9). */
#ifndef ISO_RENDER_GROUPS_COVERAGE_H
#define ISO_RENDER_GROUPS_COVERAGE_H

#include "render/groups/grouping.h"

/* The largest factor. */
#define ISO_COVERAGE_MOST 3.0

/* Sets groups->widening to a factor from 1 to ISO_COVERAGE_MOST for each group. disc: the radius of discs in
 * radii of their points, as it was for the groups. Areas are estimated from a part of the discs if there are
 * many (to 2 % with 8 groups of 2,500 points and radii of 1 to 4); the result depends on the points and their
 * order only. ISO_ERR_NOMEM; ISO_ERR_LIMIT: 2^32 - 1 points or more. */
iso_status iso_groups_cover(const iso_point_view *view, double disc, iso_pool *pool, iso_groups *groups,
                            iso_error *error);

#endif
