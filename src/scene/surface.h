/* surface: an isosurface of a scene, and the parts that methods draw it from: points, a mesh, crossed cells,
 * the ray caster's index. A part is computed once, when it is first needed, shared by the methods that need
 * it, and updated after the grid's edits. */
#ifndef ISO_SCENE_SURFACE_H
#define ISO_SCENE_SURFACE_H

#include "base/parallel.h"
#include "exact/exact.h"
#include "extract/mesh/mesh.h"
#include "extract/points/points.h"
#include "grids/grid.h"
#include "grids/ray/ray_tracer.h"
#include "grids/spline/spline.h"
#include "render/groups/groups.h"
#include "render/point_surface.h"
#include "render/raster/raster.h"
#include "render/selection/lod_cut.h"
#include "truth/raycast.h"

typedef enum iso_part {
    ISO_PART_POINTS,
    ISO_PART_MESH,
    ISO_PART_CELLS, /* for the method exact */
    ISO_PART_CASTER,
    ISO_PART_GROUPS, /* groups of the points, for the method splats */
    ISO_PART_COUNT
} iso_part;

/* How groups of points cover the surface when translucent ones are composited by GROUPS or NEAREST. */
typedef enum iso_group_radii {
    ISO_GROUP_RADII_COVERAGE, /* by larger radii, which are measured (render/groups/coverage.h) */
    ISO_GROUP_RADII_ROOT,     /* by radii as large as the root of the number of groups */
    ISO_GROUP_RADII_COPIES    /* by copies of discs of other groups (render/groups/copies.h) */
} iso_group_radii;

/* How points are divided into groups: as in iso_groups_opts, 0 where that is the usual. */
typedef struct iso_grouping {
    int limit;
    double overlap, coplanar;
    bool ignore_opposite;
    bool once; /* the points will not change, which takes less memory */
    iso_group_radii radii;
} iso_grouping;

/* An isosurface and its parts. The caller sets the members before `points` (the grid, pool and workspace are
 * borrowed) and zeroes the rest; iso_scene_surface_free frees the parts. */
typedef struct iso_scene_surface {
    iso_grid grid;
    double isovalue; /* physical; may be changed, which the next update of a part follows */
    iso_pool *pool;  /* or NULL */
    /* Of the points: AUTO means EDGE, with which pictures of points are best; `bounded`: also compute their
     * bounds (iso_point_set_bound), which lets drawing skip hidden points; `flat`: they get no curvatures,
     * because no method draws curved discs of them; `floats`: they keep all bits of their positions, for
     * files (pictures need 8 bytes); `given`: draw these instead of extracted ones, borrowed; NULL: none. */
    iso_primitive primitive;
    bool bounded, flat, floats;
    const iso_point_view *given;
    iso_transparency transparency; /* what the groups are for; SORTED: also for opaque pictures */
    iso_grouping grouping;
    int bins;                      /* for the method splats: iso_draw_groups_opts.bins */
    iso_point_selection selection; /* for the methods that draw discs */
    const iso_clip *clip;          /* what is cut away in pictures (ISO_CAN_CLIP); borrowed; NULL: nothing */
    const struct iso_label_colors *labels; /* the colours of its labels; borrowed; NULL: it has one colour */
    /* How it is coloured by data in pictures (ISO_CAN_COLORS); borrowed; NULL: in one colour. */
    const struct iso_coloring *coloring;
    bool layered;      /* pictures show it translucent; may be changed */
    bool borders;      /* its solid and others share their borders, as those of labels do */
    iso_filter filter; /* of the parts CELLS and CASTER; may be changed; the other parts are trilinear */
    double lod_pixels; /* the most that levels of detail are wrong by; 0: all points are drawn */
    /* Of the methods that draw points. NULL: one is made with the points, and owned. */
    iso_point_workspace *workspace;

    iso_point_set *points;
    iso_point_workspace *own_workspace;
    iso_mesh_set *mesh;
    iso_exact *exact;
    iso_raycaster *caster;
    /* Smooth surfaces: the spline, and its samples, whose cells `exact` has; NULL: none is needed yet. */
    iso_spline *spline;
    iso_hgrid *refined;
    iso_ray_tracer *tracer; /* of the spline, for the samples that `exact` alone cannot draw */
    iso_filter splined;     /* what filter the spline has, */
    uint64_t spline_edit;   /* after which of the grid's edits it was computed, */
    double refined_for;     /* and the isovalue of its samples, */
    bool refined_layered;   /* and whether they are for layers */
    iso_groups groups;
    iso_transparency grouped_for;     /* what the groups were made for */
    double isovalues[ISO_PART_COUNT]; /* with which each part was computed last; NAN: not yet as a whole */
    /* the number of the grid's last edit when the caster and the groups were computed */
    uint64_t caster_edit, groups_edit;
    iso_lod lod; /* levels of detail of the points; without levels before iso_scene_surface_make_levels */
    iso_lod_cut *cut; /* of the levels, for the picture that was drawn last */
} iso_scene_surface;

/* Computes a part unless it exists; an existing part is not updated. ISO_ERR_NOMEM, and the errors of
 * extraction. */
iso_status iso_scene_surface_prepare(iso_scene_surface *surface, iso_part part, iso_error *error);
/* Computes a part, or brings an existing one up to date with the isovalue and the grid's edits. Errors as
 * iso_scene_surface_prepare. */
iso_status iso_scene_surface_update(iso_scene_surface *surface, iso_part part, iso_error *error);
/* Moves the vertices of the part MESH, or the points of POINTS, which are floats, onto the smooth surface of
 * `filter`, with its normals. Once after each update. ISO_ERR_NOMEM, and the errors of iso_spline_create. */
iso_status iso_scene_surface_smooth(iso_scene_surface *surface, iso_part part, iso_error *error);
/* Makes levels of detail of the points, or brings them up to date. ISO_ERR_NOMEM; ISO_ERR_LIMIT as
 * iso_lod_update. */
iso_status iso_scene_surface_make_levels(iso_scene_surface *surface, iso_error *error);
/* Whether levels of detail are drawn, if there are some. */
static inline bool iso_scene_surface_uses_levels(const iso_scene_surface *surface) {
    return surface->lod.count && surface->lod_pixels > 0;
}
bool iso_scene_surface_has(const iso_scene_surface *surface, iso_part part);
/* Whether a part was computed with this isovalue. */
bool iso_scene_surface_is_at(const iso_scene_surface *surface, iso_part part, double isovalue);
void iso_scene_surface_free(iso_scene_surface *surface);

const char *iso_part_name(iso_part part); /* "points", "mesh", "cells", ... */

/* The number of a part's points, triangles, cells or groups, and their size in memory; 0 for a part that
 * does not exist and for the ray caster. */
typedef struct iso_part_size {
    size_t primitives, bytes;
} iso_part_size;
iso_part_size iso_scene_surface_size(const iso_scene_surface *surface, iso_part part);

/* Returns the points to draw: the given ones, else the extracted ones. */
iso_point_view iso_scene_surface_points(const iso_scene_surface *surface);

#endif
