#include "render/gbuffer.h"

#include <math.h>
#include <string.h>

#include "base/memory.h"

enum { SAMPLE_BYTES = 4 * sizeof(float) + 1 }; /* of all planes */

iso_status iso_gbuffer_create(int width, int height, iso_gbuffer *gbuffer, iso_error *error) {
    size_t samples;
    if (width < 1 || height < 1 || !iso_size_multiply((size_t)width, (size_t)height, &samples) ||
        samples > SIZE_MAX / SAMPLE_BYTES)
        return iso_fail(error, ISO_ERR_NOMEM, "a buffer of %dx%d samples is impossible", width, height);
    iso_gbuffer made = {.width = width,
                        .height = height,
                        .depth = iso_alloc(samples * sizeof(float)),
                        .surface = iso_alloc(samples)};
    for (int axis = 0; axis < 3; axis++) made.normal[axis] = iso_alloc(samples * sizeof(float));
    if (!made.depth || !made.normal[0] || !made.normal[1] || !made.normal[2] || !made.surface) {
        iso_gbuffer_free(&made);
        return iso_fail(error, ISO_ERR_NOMEM, "out of memory for %dx%d samples", width, height);
    }
    *gbuffer = made;
    return ISO_OK;
}

void iso_gbuffer_free(iso_gbuffer *gbuffer) {
    iso_free(gbuffer->depth);
    for (int axis = 0; axis < 3; axis++) iso_free(gbuffer->normal[axis]);
    iso_free(gbuffer->surface);
    *gbuffer = (iso_gbuffer){0};
}

void iso_gbuffer_clear(iso_gbuffer *gbuffer) {
    size_t samples = (size_t)gbuffer->width * (size_t)gbuffer->height;
    for (size_t i = 0; i < samples; i++) gbuffer->depth[i] = INFINITY;
    memset(gbuffer->surface, ISO_SURFACE_NONE, samples);
}
