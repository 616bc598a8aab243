/* gbuffer: depth, normal and surface number of the nearest surface at every sample of a picture. Every method
 * of the cpu engine draws into a gbuffer; shading turns it into colours. */
#ifndef ISO_RENDER_VIEW_GBUFFER_H
#define ISO_RENDER_VIEW_GBUFFER_H

#include <stddef.h>
#include <stdint.h>

#include "base/geometry.h"
#include "base/parallel.h"
#include "base/status.h"

/* Surface numbers are 0 .. ISO_SURFACE_MAX - 1; ISO_SURFACE_NONE where nothing was drawn. */
enum { ISO_SURFACE_MAX = 255, ISO_SURFACE_NONE = 255 };

typedef struct iso_gbuffer {
    int width, height;
    float *depth;     /* width * height; view z in mm, INFINITY where nothing was drawn */
    float *normal[3]; /* planes x, y, z: unit, view space, pointing out of the solid (not flipped to the
                         viewer); 0 where a sample with a colour of its own is not lit */
    uint8_t *surface; /* surface number, or ISO_SURFACE_NONE */
    /* NULL, or the colours of samples that have one of their own: red in the low byte, then green and blue
     * (display values), and the surface number + 1 in the high byte. An entry whose surface number differs
     * from the sample's is left over from a surface that has been overdrawn and does not count. */
    uint32_t *color;
    /* NULL, or the element that a sample shows: its number + 1, or 0. Elements are glyphs, segments (the
     * number of the first vertex) and triangles of a mesh: iso_draw_shapes and iso_draw_mesh write them.
     * Other renderers leave the plane as it is: what they draw is to be drawn first. */
    uint32_t *element;
    /* NULL, or the share of light that samples get, 0 .. 1: they are then shaded by it instead of by their
     * normals (render/shading/eye_dome.h). */
    float *light;
    /* NULL, or the shares of the light from all around and of the key light that reach the samples, 0 .. 1
     * (render/occlusion/occlusion.h). */
    float *ambient, *key;
    /* NULL, or the share of the outline's colour that samples have (render/shading/outline.h). */
    float *ink;
    size_t samples; /* capacity of the planes */
} iso_gbuffer;

/* The normal of sample `index`. */
static inline iso_vec3 iso_gbuffer_normal(const iso_gbuffer *gbuffer, size_t index) {
    return iso_vec3_make(gbuffer->normal[0][index], gbuffer->normal[1][index], gbuffer->normal[2][index]);
}

/* Allocates the planes, uninitialised, without colours and elements. Free with iso_gbuffer_free.
 * ISO_ERR_NOMEM. */
iso_status iso_gbuffer_create(int width, int height, iso_gbuffer *gbuffer, iso_error *error);
/* Allocates the plane of colours unless it exists; no sample has a colour yet. ISO_ERR_NOMEM. */
iso_status iso_gbuffer_add_color(iso_gbuffer *gbuffer, iso_error *error);
/* Allocates the plane of elements unless it exists; no sample shows one yet. ISO_ERR_NOMEM. */
iso_status iso_gbuffer_add_elements(iso_gbuffer *gbuffer, iso_error *error);
/* Allocates a plane of floats (`light`, `ambient`, `key` or `ink`), uninitialised, unless it exists.
 * ISO_ERR_NOMEM. */
iso_status iso_gbuffer_add_plane(const iso_gbuffer *gbuffer, float **plane, iso_error *error);
void iso_gbuffer_free(iso_gbuffer *gbuffer);
/* Sets depth to INFINITY and surface to ISO_SURFACE_NONE everywhere, and removes colours and elements. */
void iso_gbuffer_clear(iso_gbuffer *gbuffer);
/* The same with all threads of the pool: page faults of fresh memory take longer than the drawing. */
void iso_gbuffer_clear_bands(iso_gbuffer *gbuffer, iso_pool *pool);

#endif
