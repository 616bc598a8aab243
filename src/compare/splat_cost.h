/* splat_cost: in how many groups the points of an isosurface are drawn as splats in one pass, and how long
 * that takes: tables 1 and 2 of Zhang and Pajarola 2006, on any volume. */
#ifndef ISO_COMPARE_SPLAT_COST_H
#define ISO_COMPARE_SPLAT_COST_H

#include "compare/study.h"

enum { ISO_SPLAT_COST_OVERLAPS = 4 };
/* The parameter c of the paper's section 4.2.1, which is how much discs of one group may overlap: 1 (not at
 * all), .8, .6, .4. */
extern const double ISO_SPLAT_COST_OVERLAP[ISO_SPLAT_COST_OVERLAPS];

typedef struct iso_splat_cost {
    struct {
        int groups;         /* number of groups, ISO_GROUPS_MOST at most */
        double mean_degree; /* number of discs that a disc overlaps by more than c allows, on average */
        double grouping;    /* seconds to divide the points into the groups */
        double frame;       /* seconds a frame takes, median of three; NaN: not enough memory */
    } rows[ISO_SPLAT_COST_OVERLAPS];
    double ungrouped; /* seconds a frame of the method splats-flat takes, which needs no groups; or NaN */
} iso_splat_cost;

/* Divides the surface's points into groups and draws them from one view, with one sample for each pixel; only
 * the colours of the look are used. The surface needs its part points, whose workspace is used. Allocates 8
 * bytes for each pixel and group, and about 30 for each point. ISO_ERR_NOMEM, ISO_ERR_LIMIT (2^32 - 1 points
 * or more), and the errors of drawing. */
iso_status iso_study_splats(const iso_scene_surface *surface, const iso_view *view,
                            const iso_study_look *look, iso_splat_cost *cost, iso_error *error);

#endif
