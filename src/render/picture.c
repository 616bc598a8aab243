#include "render/picture.h"

#include <assert.h>

/* Bytes of the gbuffer per sample: depth, normal, surface. */
enum { SAMPLE_BYTES = 4 * sizeof(float) + 1 };
static const size_t GBUFFER_BYTES = (size_t)256 << 20;

/* The root of a square number 1 .. 64, else 0. */
static int factor_of(int samples) {
    for (int factor = 1; factor <= 8; factor++)
        if (factor * factor == samples) return factor;
    return 0;
}

static int strip_rows(const iso_picture_opts *opts, int factor) {
    size_t row = (size_t)opts->width * (size_t)(factor * factor) * SAMPLE_BYTES;
    size_t rows = (GBUFFER_BYTES - 1) / row;
    return rows > (size_t)opts->height ? opts->height : (int)rows;
}

static size_t count_covered(const iso_gbuffer *gbuffer) {
    size_t covered = 0, samples = (size_t)gbuffer->width * (size_t)gbuffer->height;
    for (size_t i = 0; i < samples; i++) covered += gbuffer->surface[i] != ISO_SURFACE_NONE;
    return covered;
}

iso_status iso_picture_render(const iso_picture_opts *opts, iso_image *image, size_t *covered,
                              iso_error *error) {
    assert(image->width == opts->width && image->height == opts->height);
    int factor = factor_of(opts->samples ? opts->samples : 1);
    if (!factor)
        return iso_fail(error, ISO_ERR_USAGE, "%d samples a pixel: must be a square number 1, 4, 9 .. 64",
                        opts->samples);
    int rows = strip_rows(opts, factor);
    iso_gbuffer gbuffer;
    ISO_TRY(iso_gbuffer_create(opts->width * factor, rows * factor, &gbuffer, error));
    iso_view pixels = opts->view ? *opts->view : iso_view_make(opts->camera, opts->width, opts->height);
    iso_view whole = iso_view_scaled(&pixels, factor);
    size_t seen = 0;
    iso_status status = ISO_OK;
    for (int y0 = 0; y0 < opts->height && status == ISO_OK; y0 += rows) {
        int count = opts->height - y0 < rows ? opts->height - y0 : rows;
        iso_view view = iso_view_rows(&whole, y0 * factor, count * factor);
        gbuffer.height = view.height;
        iso_gbuffer_clear(&gbuffer);
        status = opts->draw(opts->draw_context, &view, &gbuffer, error);
        if (status != ISO_OK) break;
        iso_shade(&opts->shading, &view, &gbuffer, factor, y0, image, opts->pool);
        seen += count_covered(&gbuffer);
    }
    iso_gbuffer_free(&gbuffer);
    if (covered && status == ISO_OK) *covered = seen;
    return status;
}
