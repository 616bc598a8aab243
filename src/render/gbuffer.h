/* gbuffer: what every method of the cpu engine draws into and what shading reads: per sample, the nearest
 * surface. */
#ifndef ISO_RENDER_GBUFFER_H
#define ISO_RENDER_GBUFFER_H

#include <stddef.h>
#include <stdint.h>

#include "base/geometry.h"
#include "base/parallel.h"
#include "base/status.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Surface numbers are 0 .. ISO_SURFACE_MAX - 1; ISO_SURFACE_NONE where nothing was drawn. */
enum { ISO_SURFACE_MAX = 255, ISO_SURFACE_NONE = 255 };

typedef struct iso_gbuffer {
    int width, height;
    float *depth;     /* width * height; view z in mm, INFINITY where nothing was drawn */
    float *normal[3]; /* planes x, y, z: unit, view space, pointing out of the solid (not flipped to the
                         viewer) */
    uint8_t *surface; /* which surface */
    /* NULL, or colours of single samples: red in the low byte, then green and blue (display values), and
     * above them the surface's number + 1. One that names another surface than the sample's is out of date.
     */
    uint32_t *color;
    size_t samples; /* that there is room for */
} iso_gbuffer;

/* The normal of sample `index`. */
static inline iso_vec3 iso_gbuffer_normal(const iso_gbuffer *gbuffer, size_t index) {
    return iso_vec3_make(gbuffer->normal[0][index], gbuffer->normal[1][index], gbuffer->normal[2][index]);
}

/* Planes uninitialised; iso_gbuffer_free when done. ISO_ERR_NOMEM. */
iso_status iso_gbuffer_create(int width, int height, iso_gbuffer *gbuffer, iso_error *error);
/* Makes the plane of colours, when there is none yet; of no sample. ISO_ERR_NOMEM. */
iso_status iso_gbuffer_add_color(iso_gbuffer *gbuffer, iso_error *error);
void iso_gbuffer_free(iso_gbuffer *gbuffer);
/* Depth INFINITY, surface ISO_SURFACE_NONE everywhere; so colours are of no sample. */
void iso_gbuffer_clear(iso_gbuffer *gbuffer);
/* The same by all threads: the first touch of fresh memory takes longer than anything that is written to it.
 */
void iso_gbuffer_clear_bands(iso_gbuffer *gbuffer, iso_pool *pool);

#ifdef __cplusplus
}
#endif
#endif
