/* copies: copies of points in other groups, with which each group covers the surface by itself without larger
 * discs (Zhang and Pajarola 2006, section 4.2.2, method 1: their choice for 4 groups). */
#ifndef ISO_RENDER_GROUPS_COPIES_H
#define ISO_RENDER_GROUPS_COPIES_H

#include "render/groups/grouping.h"

/* Sets groups->copies. To each group points of other groups are added, always the one that the group's discs
 * overlap most, but none of which they overlap more than seven eighths. disc: the radius of discs in radii of
 * their points, as it was for the groups. The result depends on the points and their order only. Takes about
 * 150 bytes a point, and 50 more for each thread. ISO_ERR_NOMEM; ISO_ERR_LIMIT: 2^32 - 1 points or more. */
iso_status iso_groups_copy(const iso_point_view *view, double disc, iso_pool *pool, iso_groups *groups,
                           iso_error *error);

#endif
