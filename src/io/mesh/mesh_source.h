/* mesh_source: a mesh as the writers of mesh_write.c see it. Internal to src/io/mesh. */
#ifndef ISO_IO_MESH_MESH_SOURCE_H
#define ISO_IO_MESH_MESH_SOURCE_H

#include <stdio.h>

#include "extract/mesh/mesh.h"
#include "io/mesh/mesh_write.h"

/* Its world positions are computed vertex by vertex. */
typedef struct mesh_source {
    const iso_weld *weld;
    iso_affine affine;
    int second, third; /* the corners that are written second and third: 1 and 2, or 2 and 1 if the transform
                          is left-handed and would turn triangles inside out */
    const char *name;  /* of the object, or NULL */
    const iso_rgb *color; /* of the object, or NULL; weld->colors has the last word */
    double opacity;
} mesh_source;

static inline iso_vec3 iso_source_position(const mesh_source *source, size_t vertex) {
    const float *p = source->weld->vertices[vertex].position;
    return iso_affine_point(&source->affine, iso_vec3_make(p[0], p[1], p[2]));
}

static inline iso_vec3 iso_source_normal(const mesh_source *source, size_t vertex) {
    const float *n = source->weld->vertices[vertex].normal;
    return iso_affine_normal(&source->affine, iso_vec3_make(n[0], n[1], n[2]));
}

static inline void iso_source_triangle(const mesh_source *source, size_t triangle, uint32_t corner[3]) {
    const uint32_t *from = source->weld->triangles[triangle];
    corner[0] = from[0];
    corner[1] = from[source->second];
    corner[2] = from[source->third];
}

/* Write all objects to a stream, whose errors are the caller's to find. ISO_ERR_NOMEM; ISO_ERR_LIMIT: more
 * than the format holds. */
iso_status iso_put_glb(const mesh_source *sources, int count, const char *comment, FILE *stream,
                       iso_error *error);
iso_status iso_put_threemf(const mesh_source *sources, int count, const char *comment, FILE *stream,
                           iso_error *error);
iso_status iso_put_vtp(const mesh_source *sources, int count, const char *comment, FILE *stream,
                       iso_error *error);

#endif
