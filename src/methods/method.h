/* method: every way this library has to draw an isosurface, as one table: what each is called, what it needs,
 * and how it draws.
 *
 * A method draws from parts that are made from the grid beforehand: points, a mesh, an index. Parts are made
 * once, shared by the methods that need them, and follow the grid's edits. */
#ifndef ISO_METHODS_METHOD_H
#define ISO_METHODS_METHOD_H

#include "base/parallel.h"
#include "exact/exact.h"
#include "extract/mesh/mesh.h"
#include "extract/points/points.h"
#include "grids/grid.h"
#include "render/pullpush/pullpush.h"
#include "render/raster/raster.h"
#include "truth/raycast.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef enum iso_part {
    ISO_PART_POINTS,
    ISO_PART_MESH,
    ISO_PART_CELLS, /* of exact */
    ISO_PART_CASTER,
    ISO_PART_COUNT
} iso_part;

/* What is drawn. grid, isovalue (physical) and pool are set by the caller and borrowed; the parts are owned:
 * iso_subject_free. */
typedef struct iso_subject {
    const iso_grid *grid;
    double isovalue;
    iso_pool *pool; /* or NULL */
    bool bounded;   /* points get their bounds (iso_point_set_bound), so that hidden ones are left out */
    iso_point_set *points;
    iso_pullpush *workspace; /* comes with the points */
    iso_mesh_set *mesh;
    iso_exact *exact;
    iso_raycaster *caster;
    uint64_t caster_edit; /* number of the grid's last edit when it was made */
} iso_subject;

/* Makes a part, unless it is there. ISO_ERR_NOMEM, and what extraction returns. */
iso_status iso_subject_prepare(iso_subject *subject, iso_part part, iso_error *error);
/* As iso_subject_prepare; a part that exists is brought up to date with the grid's edits. */
iso_status iso_subject_update(iso_subject *subject, iso_part part, iso_error *error);
/* Another isovalue, for all parts; the next update makes them anew. */
void iso_subject_set_isovalue(iso_subject *subject, double isovalue);
bool iso_subject_has(const iso_subject *subject, iso_part part);
void iso_subject_free(iso_subject *subject);

const char *iso_part_name(iso_part part); /* "points", "mesh", "cells", ... */

/* Number of points, triangles or cells of a part that is there, and the bytes they take; 0 where nothing is
 * counted.
 */
typedef struct iso_part_size {
    size_t primitives, bytes;
} iso_part_size;
iso_part_size iso_subject_size(const iso_subject *subject, iso_part part);

typedef struct iso_renderer {
    iso_method method;
    const char *name, *title;
    unsigned needs; /* bits 1 << iso_part */
    /* Draws as iso_draw_points does. The parts needed are there. */
    iso_status (*draw)(const iso_subject *subject, const iso_target *target, iso_error *error);
} iso_renderer;

/* The methods that are judged, and the one that is the truth (which is not among them). */
const iso_renderer *iso_renderer_list(size_t *count);
const iso_renderer *iso_renderer_truth(void);

/* Any of them; NULL when there is no such method. */
const iso_renderer *iso_renderer_get(iso_method method);

#ifdef __cplusplus
}
#endif
#endif
