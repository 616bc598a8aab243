/* html_page: the surface of a report, to be turned: a page within the page. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "apps/common/page.h"
#include "apps/isocompare/report.h"
#include "base/file.h"
#include "scene/bounds.h"
#include "scene/picture.h"

enum { SIDE = 512, MOST_BYTES = 4000000 };

/* From the front, as isorender begins. */
static iso_camera fit(const iso_scene_surface *surface) {
    const iso_box box = iso_bounds_of_part(surface, ISO_PART_CELLS);
    iso_camera camera = {.view_angle = 30, .parallel_scale = 1};
    iso_vec3 forward;
    iso_direction_vectors(ISO_FRONT, iso_vec3_make(0, 0, 1), &forward, &camera.view_up);
    camera.position = iso_vec3_scale(forward, -1);
    iso_camera_fit(&camera, &box, 1, 1);
    return camera;
}

/* Writes the page to a stream: its first picture, then all of it. */
static iso_status put_page(const report *r, FILE *stream, iso_error *error) {
    const iso_camera camera = fit(&r->surface);
    const iso_page_surface surface = {
        .isovalue = r->surface.isovalue, .color = {0xD9, 0xB3, 0x6C}, .translucency = {.opacity = 1}};
    const iso_layered_surface layered = {&r->surface, surface.translucency};
    iso_scene scene = {.renderer = iso_renderer_get(ISO_METHOD_EXACT), .surfaces = &layered, .count = 1};
    iso_picture_opts opts = {
        .camera = &camera,
        .width = SIDE,
        .height = SIDE,
        .shading = {.colors = &surface.color, .color_count = 1, .background = r->settings->background},
        .pool = r->pool};
    iso_image image = {0};
    iso_page_written written;
    ISO_TRY(iso_image_create(SIDE, SIDE, &image, error));
    const iso_page page = {.name = r->model,
                           .grid = r->surface.grid.rgrid,
                           .surfaces = &surface,
                           .count = 1,
                           .camera = &camera,
                           .image = &image,
                           .background = r->settings->background,
                           .range = {NAN, NAN},
                           .most = MOST_BYTES,
                           .pool = r->pool};
    iso_status status = iso_scene_render(&scene, &opts, &image, NULL, error);
    if (status == ISO_OK) status = iso_page_put(stream, "report.html", &page, &written, error);
    iso_image_free(&image);
    return status;
}

/* A page as the value of an attribute. */
static void put_quoted(FILE *stream, const char *text) {
    for (size_t plain; *text; text += plain) {
        plain = strcspn(text, "&\"");
        fwrite(text, 1, plain, stream);
        if (!text[plain]) break;
        fputs(text[plain++] == '&' ? "&amp;" : "&quot;", stream);
    }
}

char *isocompare_make_page(const report *r) {
    char *page = NULL, *element = NULL;
    size_t size;
    if (!r->surface.grid.rgrid || !r->surface.exact || iso_page_check("report.html", NULL) != ISO_OK)
        return NULL;
    FILE *stream = open_memstream(&page, &size);
    if (!stream) return NULL;
    const iso_status status = put_page(r, stream, NULL);
    const bool made = iso_memory_stream_close(stream, &page) && status == ISO_OK;
    stream = made ? open_memstream(&element, &size) : NULL;
    if (stream) {
        fputs("<h2>The surface, to be turned</h2>\n<p>Drawn by exact in this browser; the report holds the "
              "voxels that this needs.</p>\n<iframe title=\"The surface\" "
              "style=\"width:100%;height:640px;border:1px solid var(--line);border-radius:10px\" srcdoc=\"",
              stream);
        put_quoted(stream, page);
        fputs("\"></iframe>\n", stream);
        iso_memory_stream_close(stream, &element);
    }
    free(page);
    return element;
}
