/* method: the table of renderers: the name of each method, the data it needs, and the function that draws.
 *
 * A method draws from parts that are computed from the grid beforehand: points, a mesh, crossed cells, or the
 * ray caster's index. A part is computed once, shared by the methods that need it, and updated after the
 * grid's edits. */
#ifndef ISO_METHODS_METHOD_H
#define ISO_METHODS_METHOD_H

#include "base/parallel.h"
#include "exact/exact.h"
#include "extract/mesh/mesh.h"
#include "extract/points/points.h"
#include "grids/grid.h"
#include "render/pullpush/pullpush.h"
#include "render/raster/raster.h"
#include "render/selection/lod_cut.h"
#include "render/splats/splats.h"
#include "truth/raycast.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef enum iso_part {
    ISO_PART_POINTS,
    ISO_PART_MESH,
    ISO_PART_CELLS, /* for the method exact */
    ISO_PART_CASTER,
    ISO_PART_GROUPS, /* groups of the points, for the method splats */
    ISO_PART_COUNT
} iso_part;

/* An isosurface and its parts. The caller sets grid, isovalue (physical), pool, bounded and primitive (grid
 * and pool are borrowed) and zeroes the rest; iso_subject_free frees the parts. */
typedef struct iso_subject {
    const iso_grid *grid;
    double isovalue;
    iso_pool *pool; /* or NULL */
    bool bounded;   /* also compute the bounds of points (iso_point_set_bound), which lets drawing skip hidden
                     points */
    iso_primitive primitive; /* of the points; AUTO: EDGE, with which pictures of points are best */
    iso_point_set *points;
    const iso_point_view
        *given;              /* points to draw instead of extracted ones; borrowed; NULL: extracted ones */
    iso_pullpush *workspace; /* part of ISO_PART_POINTS */
    iso_mesh_set *mesh;
    iso_exact *exact;
    iso_raycaster *caster;
    iso_transparency transparency; /* what the groups are for; SORTED: also for opaque pictures */
    iso_groups groups;
    iso_transparency grouped_for; /* what the groups were made for */
    /* the number of the grid's last edit when the caster and the groups were computed */
    uint64_t caster_edit, groups_edit;
    int bins; /* for the method splats: iso_splats_opts.bins */
    /* For the methods of pull-push: levels of detail of the points, the number of pixels for
     * iso_lod_cut_make, and where the cut is made; all borrowed. `lod` NULL: all points are drawn. */
    const iso_lod *lod;
    double lod_pixels;
    iso_lod_cut *cut;
    iso_point_selection selection; /* for the methods of pull-push that draw discs */
} iso_subject;

/* Computes a part unless it exists; an existing part is not updated. ISO_ERR_NOMEM, and the errors of
 * extraction. */
iso_status iso_subject_prepare(iso_subject *subject, iso_part part, iso_error *error);
/* Computes a part, or brings an existing one up to date with the grid's edits. Errors as iso_subject_prepare.
 */
iso_status iso_subject_update(iso_subject *subject, iso_part part, iso_error *error);
/* Sets the isovalue of all parts; the next update computes them again. */
void iso_subject_set_isovalue(iso_subject *subject, double isovalue);
bool iso_subject_has(const iso_subject *subject, iso_part part);
void iso_subject_free(iso_subject *subject);

const char *iso_part_name(iso_part part); /* "points", "mesh", "cells", ... */

/* The number of a part's points, triangles, cells or groups, and their size in memory; 0 for a part that
 * does not exist and for the ray caster. */
typedef struct iso_part_size {
    size_t primitives, bytes;
} iso_part_size;
iso_part_size iso_subject_size(const iso_subject *subject, iso_part part);

/* Returns the points to draw: the given ones, else the extracted ones. */
iso_point_view iso_subject_points(const iso_subject *subject);

typedef struct iso_renderer {
    iso_method method;
    const char *name, *title; /* title: a few words, for reports */
    unsigned needs;           /* bits 1 << iso_part */
    /* Draws into the target's gbuffer, like iso_draw_points. The needed parts must exist and be up to date.
     */
    iso_status (*draw)(const iso_subject *subject, const iso_target *target, iso_error *error);
} iso_renderer;

/* Returns the list of all methods except the reference renderer. The second function returns the reference
 * renderer, with which they are compared. */
const iso_renderer *iso_renderer_list(size_t *count);
const iso_renderer *iso_renderer_truth(void);

/* The renderer of any method, also the reference and those that are not compared; NULL when there is no such
 * method. */
const iso_renderer *iso_renderer_get(iso_method method);

/* Samples a pixel of opaque pictures when nobody says how many: 4 by exact, whose edges they smooth for less
 * than twice its time, else 1. */
int iso_method_samples(iso_method method);

#ifdef __cplusplus
}
#endif
#endif
