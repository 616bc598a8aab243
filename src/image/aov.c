/* aov: allocates and frees the planes of a picture, and converts its ids to the numbers that users see. */
#include "image/aov.h"

#include "base/memory.h"

iso_status iso_aov_create(int width, int height, iso_aov *aov, iso_error *error) {
    if (width < 1 || height < 1 || width > ISO_IMAGE_MAX || height > ISO_IMAGE_MAX)
        return iso_fail(error, ISO_ERR_USAGE, "picture size %dx%d: sides must be 1..%d", width, height,
                        ISO_IMAGE_MAX);
    iso_aov made = {.width = width, .height = height};
    float **planes[ISO_AOV_PLANES] = {&made.depth, &made.normal[0], &made.normal[1], &made.normal[2],
                                      &made.coverage};
    for (int i = 0; i < ISO_AOV_PLANES; i++) {
        *planes[i] = iso_alloc((size_t)width * (size_t)height * sizeof(float));
        if (*planes[i]) continue;
        iso_aov_free(&made);
        return iso_fail(error, ISO_ERR_NOMEM, "out of memory for depth and normals of %dx%d pixels", width,
                        height);
    }
    *aov = made;
    return ISO_OK;
}

iso_status iso_aov_add_layers(iso_aov *aov, iso_error *error) {
    if (!aov->layers) aov->layers = iso_alloc((size_t)aov->width * (size_t)aov->height * sizeof(float));
    return aov->layers ? ISO_OK : iso_fail(error, ISO_ERR_NOMEM, "out of memory for the numbers of layers");
}

void iso_aov_remove_layers(iso_aov *aov) {
    iso_free(aov->layers);
    aov->layers = NULL;
}

iso_status iso_aov_add_ids(iso_aov *aov, iso_error *error) {
    for (int i = 0; i < ISO_ID_PLANES; i++) {
        if (!aov->ids[i])
            aov->ids[i] = iso_alloc((size_t)aov->width * (size_t)aov->height * sizeof *aov->ids[i]);
        if (!aov->ids[i]) return iso_fail(error, ISO_ERR_NOMEM, "out of memory for the ids of pixels");
    }
    return ISO_OK;
}

void iso_aov_remove_ids(iso_aov *aov) {
    for (int i = 0; i < ISO_ID_PLANES; i++) {
        iso_free(aov->ids[i]);
        aov->ids[i] = NULL;
    }
}

/* ---- numbers of elements */

/* Number of pixels that have ids. */
static size_t pixels_with_ids(const iso_aov *aov) {
    return aov->ids[0] ? (size_t)aov->width * (size_t)aov->height : 0;
}

/* The line that a vertex belongs to. */
static size_t line_of(const iso_lines *lines, size_t vertex) {
    size_t low = 0, high = lines->line_count; /* starts[low] <= vertex < starts[high] */
    while (high - low > 1) {
        const size_t middle = low + (high - low) / 2;
        *(lines->starts[middle] <= vertex ? &low : &high) = middle;
    }
    return low;
}

void iso_aov_number_lines(iso_aov *aov, uint32_t surface, const iso_lines *lines) {
    const size_t count = pixels_with_ids(aov);
    for (size_t i = 0; i < count; i++) {
        const uint32_t vertex = aov->ids[ISO_ID_ELEMENT][i];
        if (aov->ids[ISO_ID_SURFACE][i] != surface || !vertex) continue;
        const size_t line = line_of(lines, vertex - 1);
        aov->ids[ISO_ID_ELEMENT][i] = (uint32_t)(line + 1);
        aov->ids[ISO_ID_SEGMENT][i] = (uint32_t)(vertex - lines->starts[line]);
    }
}

void iso_aov_renumber(iso_aov *aov, uint32_t surface, const uint32_t *numbers) {
    const size_t count = pixels_with_ids(aov);
    uint32_t *element = aov->ids[ISO_ID_ELEMENT];
    for (size_t i = 0; i < count; i++)
        if (aov->ids[ISO_ID_SURFACE][i] == surface && element[i]) element[i] = numbers[element[i] - 1] + 1;
}

void iso_aov_unnumber(iso_aov *aov, uint32_t surface) {
    const size_t count = pixels_with_ids(aov);
    for (size_t i = 0; i < count; i++)
        if (aov->ids[ISO_ID_SURFACE][i] == surface) aov->ids[ISO_ID_ELEMENT][i] = 0;
}

void iso_aov_free(iso_aov *aov) {
    iso_aov_remove_ids(aov);
    iso_free(aov->depth);
    for (int axis = 0; axis < 3; axis++) iso_free(aov->normal[axis]);
    iso_free(aov->coverage);
    iso_free(aov->layers);
    *aov = (iso_aov){0};
}
