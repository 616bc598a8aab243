/* compose: composites bands of samples and averages them into pixels. The kernel is compose_kernel.c. */
#include "render/layers/compose.h"

#include <assert.h>
#include <string.h>

#include "base/kernel_units.h"
#include "base/memory.h"
#include "render/layers/compose_kernel.h"
#include "render/shading/phong_vectors.h"

/* The rows of floats of a composer: the members of iso_layer_line, by sample and summed by pixel; the rays'
 * slopes; copies of a row of the gbuffer, because the last vector would read beyond its end; and the colours
 * of 256 surfaces. */
enum {
    LINE_SAMPLES,
    LINE_SUMS = 5,
    LINE_U = 10,
    LINE_NORMAL,
    LINE_SURFACE = LINE_NORMAL + 3,
    LINE_OWN,
    LINE_AMBIENT,
    LINE_KEY,
    LINES
};
enum { SURFACES = ISO_SURFACE_NONE + 1 };

iso_status iso_layer_composer_reserve(iso_layer_composer *composer, int width, int factor, iso_error *error) {
    composer->line_floats = (size_t)width * (size_t)factor + ISO_LANES_MAX;
    composer->lines =
        iso_alloc((LINES * composer->line_floats + 3 * (size_t)SURFACES) * sizeof *composer->lines);
    if (!composer->lines) return iso_fail(error, ISO_ERR_NOMEM, "out of memory for a row of a picture");
    return ISO_OK;
}

void iso_layer_composer_free(iso_layer_composer *composer) {
    iso_free(composer->lines);
    composer->lines = NULL;
}

static float *line_of(const iso_layer_composer *composer, int number) {
    return composer->lines + (size_t)number * composer->line_floats;
}

static iso_layer_line line_at(const iso_layer_composer *composer, int first) {
    return (iso_layer_line){
        {line_of(composer, first), line_of(composer, first + 1), line_of(composer, first + 2)},
        line_of(composer, first + 3),
        line_of(composer, first + 4)};
}

/* Prepares what all rows of a band have in common. */
static iso_layer_back make_back(const iso_layer_picture *picture, const iso_layer_composer *composer) {
    const iso_shading *shading = picture->shading;
    const iso_rgb empty = shading->background;
    const iso_view *view = picture->strip->view;
    float *u = line_of(composer, LINE_U), *colors = line_of(composer, LINES);
    for (int x = 0; x < view->width; x++) u[x] = iso_slope_of_column(view, x);
    memset(u + view->width, 0, ISO_LANES_MAX * sizeof *u);
    iso_layer_back back = {.u = u,
                           .background = {(float)empty.r / 255, (float)empty.g / 255, (float)empty.b / 255},
                           .transparent = shading->transparent};
    for (int i = 0; i < SURFACES; i++) {
        const iso_rgb c = shading->colors[i < shading->color_count ? i : shading->color_count - 1];
        colors[i] = (float)c.r / 255;
        colors[SURFACES + i] = (float)c.g / 255;
        colors[2 * SURFACES + i] = (float)c.b / 255;
    }
    for (int k = 0; k < 3; k++) {
        back.color[k] = colors + k * SURFACES;
        back.normal[k] = line_of(composer, LINE_NORMAL + k);
    }
    return back;
}

static const float *copy_plane(const float *plane, size_t at, size_t width, float *line) {
    return plane ? memcpy(line, plane + at, width * sizeof *line) : NULL;
}

/* Copies row y of the strip's gbuffer, which has the opaque surfaces, to the arrays that the kernel reads. */
static void copy_row(const iso_gbuffer *gbuffer, int y, const iso_layer_composer *composer,
                     iso_layer_back *back) {
    if (!gbuffer->depth) return;
    const size_t width = (size_t)gbuffer->width, at = (size_t)y * width;
    for (int k = 0; k < 3; k++)
        memcpy(line_of(composer, LINE_NORMAL + k), gbuffer->normal[k] + at, width * sizeof(float));
    uint8_t *surface = (uint8_t *)line_of(composer, LINE_SURFACE);
    memcpy(surface, gbuffer->surface + at, width);
    memset(surface + width, ISO_SURFACE_NONE, ISO_LANES_MAX);
    back->surface = surface;
    back->ambient = copy_plane(gbuffer->ambient, at, width, line_of(composer, LINE_AMBIENT));
    back->key = copy_plane(gbuffer->key, at, width, line_of(composer, LINE_KEY));
    if (!gbuffer->color) return;
    float *own = line_of(composer, LINE_OWN);
    memcpy(own, gbuffer->color + at, width * sizeof *gbuffer->color);
    back->own_color = (const uint32_t *)own;
}

/* Adds a row of samples to the sums of its pixels. */
static void add_line(const iso_layer_line *line, int factor, int width, const iso_layer_line *sums) {
    for (int k = 0; k < 5; k++) {
        const float *from = k < 3 ? line->color[k] : k == 3 ? line->through : line->layers;
        float *to = k < 3 ? sums->color[k] : k == 3 ? sums->through : sums->layers;
        for (int x = 0; x < width; x++)
            for (int i = 0; i < factor; i++) to[x] += from[x * factor + i];
    }
}

static void scale_line(const iso_layer_line *line, int width, float by) {
    for (int x = 0; x < width; x++) {
        for (int k = 0; k < 3; k++) line->color[k][x] *= by;
        line->through[x] *= by;
        line->layers[x] *= by;
    }
}

/* Writes a row of pixels. y: the row in the image. */
static void write_row(const iso_layer_picture *picture, const iso_layer_kernel *kernel, int y,
                      const iso_layer_line *line) {
    const size_t width = (size_t)picture->image->width, at = (size_t)y * width;
    const float *const color[3] = {line->color[0], line->color[1], line->color[2]};
    kernel->write(color, line->through, picture->shading->transparent, picture->image->width,
                  (int32_t *)picture->image->rgba + at);
    if (picture->layer_counts) memcpy(picture->layer_counts + at, line->layers, width * sizeof(float));
    for (size_t x = 0; picture->coverage && x < width; x++) picture->coverage[at + x] = 1 - line->through[x];
}

void iso_layer_totals_add(iso_layer_totals *totals, const iso_layer_totals *more) {
    totals->covered += more->covered;
    totals->layers += more->layers;
    if (more->most > totals->most) totals->most = more->most;
}

void iso_layers_finish(const iso_layer_picture *picture, int first, int rows, iso_layer_row_fn *compose,
                       const void *context, iso_layer_composer *composer, iso_layer_totals *totals) {
    const iso_layer_kernel *kernel = ISO_KERNEL_UNIT(iso_layer_kernel, iso_cpu_best());
    const iso_strip *strip = picture->strip;
    const int factor = strip->factor, width = picture->image->width;
    const iso_layer_line line = line_at(composer, LINE_SAMPLES), sums = line_at(composer, LINE_SUMS);
    iso_layer_back back = make_back(picture, composer);
    assert(first % factor == 0 && rows % factor == 0 && strip->view->width == width * factor);
    for (int row = 0; row < rows; row++) {
        if (row % factor == 0) memset(sums.color[0], 0, 5 * composer->line_floats * sizeof(float));
        compose(context, row, &line, totals);
        back.v = iso_slope_of_row(strip->view, first + row);
        copy_row(strip->gbuffer, first + row, composer, &back);
        totals->covered += kernel->add_back(&back, width * factor, &line);
        if (factor > 1) add_line(&line, factor, width, &sums);
        if (factor > 1 && row % factor == factor - 1) scale_line(&sums, width, 1 / (float)(factor * factor));
        if (row % factor == factor - 1)
            write_row(picture, kernel, strip->y0 + (first + row) / factor, factor > 1 ? &sums : &line);
    }
}

/* Lists of fragments as they are composited. */
typedef struct listed {
    const iso_layer_lists *lists;
    const iso_layer_media *media;
} listed;

static void compose_listed(const void *context, int row, const iso_layer_line *line,
                           iso_layer_totals *totals) {
    const listed *l = context;
    if (l->media)
        iso_layers_absorb(l->media, l->lists, row, line, totals);
    else
        ISO_KERNEL_UNIT(iso_layer_kernel, iso_cpu_best())->compose(l->lists, row, line, totals);
}

void iso_layers_compose(const iso_layer_picture *picture, const iso_layer_lists *lists,
                        const iso_layer_media *media, int first, iso_layer_composer *composer,
                        iso_layer_totals *totals) {
    const listed l = {lists, media};
    assert(lists->width == picture->image->width * picture->strip->factor);
    iso_layers_finish(picture, first, lists->rows, compose_listed, &l, composer, totals);
}
