/* gbuffer: what every method of the cpu engine draws into and what shading reads: per sample, the nearest
 * surface. */
#ifndef ISO_RENDER_GBUFFER_H
#define ISO_RENDER_GBUFFER_H

#include <stdint.h>

#include "base/status.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Surface numbers are 0 .. ISO_SURFACE_MAX - 1; ISO_SURFACE_NONE where nothing was drawn. */
enum { ISO_SURFACE_MAX = 255, ISO_SURFACE_NONE = 255 };

typedef struct iso_gbuffer {
    int width, height;
    float *depth;       /* width * height; view z in mm, INFINITY where nothing was drawn */
    float (*normal)[3]; /* unit, view space, pointing out of the solid (not flipped to the viewer) */
    uint8_t *surface;   /* which surface */
} iso_gbuffer;

/* Planes uninitialised; iso_gbuffer_free when done. ISO_ERR_NOMEM. */
iso_status iso_gbuffer_create(int width, int height, iso_gbuffer *gbuffer, iso_error *error);
void iso_gbuffer_free(iso_gbuffer *gbuffer);
/* Depth INFINITY, surface ISO_SURFACE_NONE everywhere. */
void iso_gbuffer_clear(iso_gbuffer *gbuffer);

#ifdef __cplusplus
}
#endif
#endif
