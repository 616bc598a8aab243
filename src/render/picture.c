/* picture: draws, shades and measures one strip after the other into one gbuffer. */
#include "render/picture.h"

#include <assert.h>

#include "base/memory.h"
#include "render/shading/eye_dome.h"
#include "render/shading/outline.h"

int iso_picture_factor(int samples) {
    if (samples == 0) return 1;
    for (int factor = 1; factor <= ISO_FACTOR_MAX; factor++)
        if (factor * factor == samples) return factor;
    return 0;
}

iso_status iso_picture_check_samples(int samples, iso_error *error) {
    if (iso_picture_factor(samples)) return ISO_OK;
    return iso_fail(error, ISO_ERR_USAGE, "%d samples a pixel: must be a square number 1, 4, 9 .. 64",
                    samples);
}

static int strip_rows(const iso_picture_opts *opts, int factor) {
    if (opts->gbuffer) return opts->height;
    const size_t row = (size_t)opts->width * (size_t)(factor * factor) * ISO_PICTURE_SAMPLE_BYTES,
                 most = opts->strip_bytes ? opts->strip_bytes : ISO_PICTURE_STRIP_BYTES,
                 rows = (most - 1) / row;
    if (rows < 1) return 1;
    return rows > (size_t)opts->height ? opts->height : (int)rows;
}

typedef struct picture {
    const iso_picture_opts *opts;
    iso_view view; /* of all samples */
    int factor;
    iso_gbuffer gbuffer;
    iso_image *image;
    size_t covered;
} picture;

static iso_status draw_strip(picture *p, iso_draw_fn *draw, void *context, const iso_view *view,
                             iso_error *error) {
    p->gbuffer.height = view->height;
    iso_gbuffer_clear_bands(&p->gbuffer, p->opts->pool);
    return draw(context, view, &p->gbuffer, error);
}

/* The rows of a gbuffer from `first` on. */
static iso_gbuffer rows_of(const iso_gbuffer *gbuffer, int first, int count) {
    const size_t skipped = (size_t)first * (size_t)gbuffer->width;
    iso_gbuffer rows = *gbuffer;
    rows.height = count;
    rows.samples -= skipped;
    rows.depth += skipped;
    rows.surface += skipped;
    for (int axis = 0; axis < 3; axis++) rows.normal[axis] += skipped;
    if (rows.color) rows.color += skipped;
    if (rows.element) rows.element += skipped;
    if (rows.light) rows.light += skipped;
    if (rows.ambient) rows.ambient += skipped;
    if (rows.key) rows.key += skipped;
    if (rows.ink) rows.ink += skipped;
    return rows;
}

static bool is_lit_by_depths(const iso_picture_opts *opts) {
    return opts->lighting == ISO_LIGHTING_EYE_DOME && !opts->layers;
}

static bool has_outline(const iso_picture_opts *opts) {
    return opts->outline > 0 && !opts->layers;
}

/* How many rows of pixels above and below a row its light and lines depend on. */
static int reach_of(const iso_picture_opts *opts) {
    const int light = is_lit_by_depths(opts) ? ISO_EYE_DOME_REACH : 0,
              lines = has_outline(opts) ? iso_outline_reach(opts->outline) : 0;
    return light > lines ? light : lines;
}

static bool is_occluded(const iso_picture_opts *opts) {
    return opts->occlusion && (!opts->layers || opts->layers->draw_opaque);
}

/* Finds the light and the lines of rows first .. last of samples. */
static iso_status light_rows(picture *p, const iso_view *view, int first, int last, iso_error *error) {
    const iso_picture_opts *opts = p->opts;
    if (is_lit_by_depths(opts)) iso_eye_dome_light(view, p->factor, first, last, &p->gbuffer, opts->pool);
    if (has_outline(opts))
        iso_outline_draw(view, p->factor, opts->outline, first, last, &p->gbuffer, opts->pool);
    if (!is_occluded(opts)) return ISO_OK;
    return iso_occlusion_light(opts->occlusion, view, p->factor, first, last, &p->gbuffer, opts->pool, error);
}

/* Shades a strip with translucent surfaces. */
static iso_status shade_layers(picture *p, const iso_strip *strip, iso_error *error) {
    const iso_picture_layers *layers = p->opts->layers;
    const iso_gbuffer size = {.width = strip->view->width, .height = strip->view->height};
    iso_strip behind = *strip;
    size_t covered = 0;
    if (layers->draw_opaque) {
        ISO_TRY(draw_strip(p, layers->draw_opaque, layers->context, strip->view, error));
        ISO_TRY(light_rows(p, strip->view, 0, strip->view->height - 1, error));
    } else
        behind.gbuffer = &size;
    ISO_TRY(layers->shade(layers->context, &behind, p->image, p->opts->aov, &covered, error));
    p->covered += covered;
    return ISO_OK;
}

/* Draws opaque pixel rows, with as many rows above and below as that needs. */
static iso_status render_opaque_rows(picture *p, int y0, int count, iso_error *error) {
    const iso_picture_opts *opts = p->opts;
    const int factor = p->factor, reach = reach_of(opts), first = y0 > reach ? y0 - reach : 0,
              end = y0 + count + reach < opts->height ? y0 + count + reach : opts->height;
    const iso_view drawn = iso_view_rows(&p->view, first * factor, (end - first) * factor),
                   view = iso_view_rows(&p->view, y0 * factor, count * factor);
    const int above = (y0 - first) * factor;
    ISO_TRY(draw_strip(p, opts->draw, opts->draw_context, &drawn, error));
    ISO_TRY(light_rows(p, &drawn, above, above + count * factor - 1, error));
    const iso_gbuffer rows = rows_of(&p->gbuffer, above, count * factor);
    const iso_strip strip = {&view, &rows, factor, y0};
    if (opts->aov) iso_strip_measure(&strip, opts->aov, opts->pool);
    iso_shading shading = opts->shading;
    if (has_outline(opts)) shading.ink = iso_outline_color(shading.background, shading.transparent);
    p->covered += iso_shade(&shading, &strip, p->image, opts->pool);
    return ISO_OK;
}

/* Draws pixel rows y0 .. y0 + count - 1 and adds them to the image and the aov. */
static iso_status render_rows(picture *p, int y0, int count, iso_error *error) {
    const iso_picture_opts *opts = p->opts;
    const iso_view view = iso_view_rows(&p->view, y0 * p->factor, count * p->factor);
    const iso_strip strip = {&view, &p->gbuffer, p->factor, y0};
    if (!opts->layers) return render_opaque_rows(p, y0, count, error);
    if (opts->aov) ISO_TRY(draw_strip(p, opts->draw, opts->draw_context, &view, error));
    if (opts->aov) iso_strip_measure(&strip, opts->aov, opts->pool);
    return shade_layers(p, &strip, error);
}

/* Whether anything is drawn into the gbuffer. */
static bool needs_gbuffer(const iso_picture_opts *opts) {
    return !opts->layers || opts->layers->draw_opaque || opts->aov;
}

/* Allocates a plane of the gbuffer that the picture needs, or frees what an earlier picture has left. */
static iso_status set_plane(const iso_gbuffer *g, float **plane, bool needed, iso_error *error) {
    if (needed) return iso_gbuffer_add_plane(g, plane, error);
    iso_free(*plane);
    *plane = NULL;
    return ISO_OK;
}

static iso_status set_planes(picture *p, iso_error *error) {
    const iso_picture_opts *opts = p->opts;
    iso_gbuffer *g = &p->gbuffer;
    const bool occluded = is_occluded(opts);
    ISO_TRY(set_plane(g, &g->light, is_lit_by_depths(opts), error));
    ISO_TRY(set_plane(g, &g->ambient, occluded && opts->occlusion->range > 0, error));
    ISO_TRY(set_plane(g, &g->key, occluded && opts->occlusion->has_shadow, error));
    ISO_TRY(set_plane(g, &g->ink, has_outline(opts), error));
    return opts->aov && opts->aov->ids[0] ? iso_gbuffer_add_elements(g, error) : ISO_OK;
}

iso_status iso_picture_render(const iso_picture_opts *opts, iso_image *image, size_t *covered,
                              iso_error *error) {
    assert(image->width == opts->width && image->height == opts->height);
    assert(!opts->aov || (opts->aov->width == opts->width && opts->aov->height == opts->height));
    ISO_TRY(iso_picture_check_samples(opts->samples, error));
    const int factor = iso_picture_factor(opts->samples);
    int rows = strip_rows(opts, factor);
    iso_view pixels = opts->view ? *opts->view : iso_view_make(opts->camera, opts->width, opts->height);
    picture p = {.opts = opts, .view = iso_view_scaled(&pixels, factor), .factor = factor, .image = image};
    const int more = rows < opts->height ? 2 * reach_of(opts) : 0;
    if (opts->gbuffer)
        p.gbuffer = *opts->gbuffer;
    else if (needs_gbuffer(opts))
        ISO_TRY(iso_gbuffer_create(opts->width * factor, (rows + more) * factor, &p.gbuffer, error));
    iso_status status = set_planes(&p, error);
    const int end = opts->rows[1] ? opts->rows[1] : opts->height;
    for (int y0 = opts->rows[0]; y0 < end && status == ISO_OK; y0 += rows) {
        const int count = end - y0 < rows ? end - y0 : rows;
        if (opts->begin_strip)
            opts->begin_strip(opts->draw_context, (double)y0 / opts->height,
                              (double)(y0 + count) / opts->height);
        status = render_rows(&p, y0, count, error);
        if (status == ISO_OK) status = iso_pool_check(opts->pool, "the picture", error);
    }
    if (opts->gbuffer)
        *opts->gbuffer = p.gbuffer;
    else
        iso_gbuffer_free(&p.gbuffer);
    if (covered && status == ISO_OK) *covered = p.covered;
    return status;
}
