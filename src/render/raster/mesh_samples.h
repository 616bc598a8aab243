/* mesh_samples: the samples of a view that a mesh's triangles cover, each triangle for itself: what is drawn
 * into a gbuffer (raster.h), and what is listed of translucent meshes. Internal to render. */
#ifndef ISO_RENDER_RASTER_MESH_SAMPLES_H
#define ISO_RENDER_RASTER_MESH_SAMPLES_H

#include "render/raster/raster.h"
#include "render/view/project.h"

/* A mesh in a view. */
typedef struct iso_mesh_samples iso_mesh_samples;

/* What a triangle is at a sample. */
typedef struct iso_mesh_sample {
    int x, y;          /* in the view */
    double depth;      /* mm */
    float normal[3];   /* unit, view space */
    uint32_t triangle; /* number in the mesh */
} iso_mesh_sample;

/* All is borrowed until iso_mesh_samples_destroy. ISO_ERR_NOMEM. */
iso_status iso_mesh_samples_create(const iso_target *target, const iso_mesh_view *mesh,
                                   iso_mesh_samples **samples, iso_error *error);
void iso_mesh_samples_destroy(iso_mesh_samples *samples);

/* Calls for each sample of the columns and rows and each triangle that covers it, in the order of triangles.
 * A sample on an edge that two triangles share is covered by one of them, as in iso_draw_mesh. visit: returns
 * false to end. worker: of the target's pool; each has memory of its own. */
void iso_mesh_samples_visit(const iso_mesh_samples *samples, int worker, iso_rows columns, iso_rows rows,
                            bool (*visit)(void *context, const iso_mesh_sample *sample), void *context);

#endif
