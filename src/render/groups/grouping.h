/* grouping: divides points into groups whose discs do not overlap (Zhang and Pajarola 2006, section 4.1), so
 * that in a picture of one group each pixel shows at most one disc of a layer of the surface.
 *
 * The points are the nodes of a graph; two are joined when the distance of their centres is below c times
 * the sum of their discs' radii (eq. 5 with rule 3), and joined points conflict when they are in one
 * group. The groups are a greedy colouring: each point gets the smallest number that no conflicting point
 * has. The paper takes points by falling degree (Largest First); here they are taken cell by cell in scan
 * order, which needs no graph in memory, can be updated locally, and needs as few groups within 3, sometimes
 * fewer (a bear, a head and a scan, c = 1 / .8 / .6 / .4: 19 15 10 7, 29 22 15 10, 22 16 12 6; Largest First
 * 21 15 9 6, 27 20 13 8, 22 14 10 6). With 4 groups both have as many conflicts. With a limit of groups, a
 * point for which none is free gets the one whose discs its own overlaps least: splats in 8 groups are 5 dB
 * nearer to two passes than with the fewest conflicts.
 *
 * Where thousands of discs overlap, only some of them are looked at.
 *
 * The result depends on the points and their order only, not on threads: blocks of cells of one parity are
 * coloured in parallel (base/point_cells.h), in 8 passes. A change of points can change groups within 8
 * blocks of them only; iso_groups_update colours only blocks that a change reaches, with the same result as
 * colouring everything anew. */
#ifndef ISO_RENDER_GROUPS_GROUPING_H
#define ISO_RENDER_GROUPS_GROUPING_H

#include "base/parallel.h"
#include "base/primitives.h"

enum { ISO_GROUPS_MOST = 64 };

typedef struct iso_groups_opts {
    double disc;    /* radius of discs in radii of their points; 0: 1 */
    double overlap; /* c of rule 3, up to 1; 0: 1 */
    int limit;      /* most groups, 1 .. ISO_GROUPS_MOST; 0: ISO_GROUPS_MOST */
    /* Rule 2: points whose normals differ by more than 90 degrees do not conflict. Fewer groups, but the two
     * sides of thin things then hide each other. */
    bool ignore_opposite;
    /* Rule 1: points of one colour do not conflict if their normals differ by less than this many degrees and
     * each lies within this angle of the other's plane; 0: they do. A pixel averages only one of the points
     * of a group, so that surfaces become less smooth: a smaller `overlap` is better for as few groups (a
     * bear in 15 groups: 38 dB from 19 without conflicts with 10 degrees, 47 with c = .8). */
    double coplanar;
    /* With a limit: a point for which no group is free gets the group with the fewest conflicts, instead
     * of that whose discs its own overlaps least. Better where each group is to cover the surface by
     * itself (algorithms 2 and 3: 1 dB), worse where all groups are blended (5 dB with 8 groups). */
    bool by_number;
    iso_pool *pool; /* or NULL */
} iso_groups_opts;

/* What iso_groups_update remembers from one call to the next: about 30 bytes a point. */
typedef struct iso_groups_memory iso_groups_memory;

/* The groups of a view's points. Zero-initialise; free with iso_groups_free. */
typedef struct iso_groups {
    uint8_t *group;   /* one per item of the view's arrays; 0 for points that are left out */
    int count;        /* 1 + the largest group; 0 without points */
    size_t conflicts; /* joined pairs of points that are in one group */
    size_t joined;    /* joined pairs: the mean degree is 2 joined / points */
    size_t computed;  /* points whose group the last call computed; the others kept theirs */
    /* Factors of radii with which each group covers the surface by itself (render/groups/coverage.h); 0: not
     * computed. */
    float widening[ISO_GROUPS_MOST];
    /* One per item of the view's arrays: bits of the groups that have a copy of the point beside its own
     * group; NULL: there are none (render/groups/copies.h). */
    uint64_t *copies;
    size_t copy_count;         /* of all points */
    iso_groups_memory *memory; /* of iso_groups_update; NULL after iso_groups_make */
} iso_groups;

/* The length of a view's arrays. */
size_t iso_groups_length(const iso_point_view *view);
/* Divides the points of a view into groups. Points whose position is not finite, or whose radius is not
 * above 0, are left out. ISO_ERR_NOMEM; ISO_ERR_LIMIT: 2^32 - 1 points or more. */
iso_status iso_groups_make(const iso_point_view *view, const iso_groups_opts *opts, iso_groups *groups,
                           iso_error *error);
/* Brings groups up to date after points were changed, added or removed; zero-initialised groups are made. The
 * result is that of iso_groups_make for the same view. The points are sorted into cells again; a block of
 * cells is coloured again only if points in or around it have changed, or if groups around it have changed
 * that are assigned before its own. All points are coloured again if the options differ from those of the
 * last call, with ignore_opposite, or if the surface has grown so much that the cells are laid out anew.
 * Errors as iso_groups_make; the groups are then freed. */
iso_status iso_groups_update(const iso_point_view *view, const iso_groups_opts *opts, iso_groups *groups,
                             iso_error *error);
/* Bytes of what iso_groups_update remembers. */
size_t iso_groups_memory_bytes(const iso_groups *groups);
void iso_groups_free(iso_groups *groups);

#endif
