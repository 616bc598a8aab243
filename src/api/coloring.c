/* coloring: checks iso_color_by, and makes colorings of it and of paint. */
#include "api/coloring.h"

#include "base/memory.h"
#include "scene/distances.h"

static bool has_range(const iso_color_by *given) {
    return given->range[0] != 0 || given->range[1] != 0;
}

static iso_status check(iso_surface *const *surfaces, int surface_count, const iso_color_by *given,
                        int number, iso_error *error) {
    iso_colormap map;
    if (given->surface < 0 || given->surface >= surface_count)
        return iso_fail(error, ISO_ERR_USAGE, "color_by %d: there is no surface %d", number, given->surface);
    if (!surfaces[given->surface])
        return iso_fail(error, ISO_ERR_USAGE, "surface %d is NULL", given->surface);
    if (surfaces[given->surface]->cloud)
        return iso_fail(error, ISO_ERR_USAGE,
                        "color_by %d: surface %d is a cloud of points, which has colours of its own", number,
                        given->surface);
    if ((int)given->source < 0 || given->source > ISO_COLOR_BY_NORMAL)
        return iso_fail(error, ISO_ERR_USAGE, "color_by %d: there is no source %d", number,
                        (int)given->source);
    const bool needs = given->source == ISO_COLOR_BY_VOLUME || given->source == ISO_COLOR_BY_DISTANCE;
    if (needs && !given->volume)
        return iso_fail(error, ISO_ERR_USAGE, "color_by %d: the volume is NULL", number);
    if (given->source == ISO_COLOR_BY_DISTANCE && !isfinite(given->isovalue))
        return iso_fail(error, ISO_ERR_USAGE, "color_by %d: the isovalue is not finite", number);
    const double *range = given->range;
    if (has_range(given) && !(range[0] < range[1] && isfinite(range[0]) && isfinite(range[1])))
        return iso_fail(error, ISO_ERR_USAGE, "color_by %d: range %g and %g are not in ascending order",
                        number, range[0], range[1]);
    return given->colormap ? iso_colormap_find(given->colormap, &map, error) : ISO_OK;
}

iso_status iso_api_colorings_check(iso_surface *const *surfaces, int surface_count,
                                   const iso_render_opts *opts, const iso_renderer *renderer,
                                   iso_error *error) {
    if (!opts->color_by_count) return ISO_OK;
    if (opts->color_by_count < 0 || !opts->color_by)
        return iso_fail(error, ISO_ERR_USAGE, "color_by: %d of them", opts->color_by_count);
    if (opts->glass || opts->instances)
        return iso_fail(error, ISO_ERR_USAGE, "glass and instances are not coloured by data");
    ISO_TRY(iso_renderer_require(renderer, ISO_CAN_COLORS, "the method", "surfaces coloured by data", error));
    for (int i = 0; i < opts->color_by_count; i++)
        ISO_TRY(check(surfaces, surface_count, &opts->color_by[i], i, error));
    return ISO_OK;
}

static iso_status make(iso_api_colorings *all, int i, const iso_view *view, iso_error *error) {
    const iso_color_by *given = &all->given[i];
    iso_scene_surface *scene = &all->surfaces[given->surface]->scene;
    iso_coloring *coloring = &all->made[i];
    size_t points, found;
    coloring->source = given->source;
    if (given->colormap) ISO_TRY(iso_colormap_find(given->colormap, &coloring->bar.map, error));
    if (given->source == ISO_COLOR_BY_VOLUME)
        iso_coloring_set_grid(coloring, &iso_api_volume_of(given->volume)->volume.grid);
    if (given->source == ISO_COLOR_BY_CURVATURE) iso_coloring_set_grid(coloring, &scene->grid);
    if (given->source == ISO_COLOR_BY_DISTANCE) {
        const iso_api_volume *volume = iso_api_volume_of(given->volume);
        ISO_TRY(iso_distance_of_isosurface(&volume->volume.grid, given->isovalue, volume->pool,
                                           &all->distances[i], error));
        coloring->distance = all->distances[i];
    }
    coloring->bar.low = given->range[0];
    coloring->bar.high = given->range[1];
    if (!has_range(given))
        ISO_TRY(iso_coloring_find_surface_range(coloring, scene, view, &points, &found, error));
    if (!given->colormap) coloring->bar.map = iso_coloring_usual_map(given->source, &coloring->bar);
    scene->coloring = coloring;
    return ISO_OK;
}

/* Of a surface at the distance 0 of a sculpt. */
static void use_paint(const iso_api_colored *what, int i, iso_api_colorings *all) {
    iso_surface *surface = what->surfaces[i];
    const iso_capability wanted = what->translucent ? ISO_CAN_COLOR_LAYERS : ISO_CAN_COLORS;
    if (surface->scene.coloring || !surface->volume || !surface->volume->paint || surface->label_fields ||
        surface->scene.isovalue != 0 || !(what->renderer->can & (unsigned)wanted))
        return;
    all->painted[i] = iso_painted_make(surface->volume->paint, surface->scene.grid.hgrid, what->colors[i]);
    all->paint[i] = iso_painted_coloring(&all->painted[i]);
    if (iso_painted_any(&all->painted[i])) surface->scene.coloring = &all->paint[i];
}

iso_status iso_api_colorings_begin(const iso_api_colored *what, const iso_render_opts *opts,
                                   const iso_view *view, iso_api_colorings *colorings, iso_error *error) {
    const size_t count = (size_t)opts->color_by_count;
    *colorings = (iso_api_colorings){.surfaces = what->surfaces,
                                     .given = opts->color_by,
                                     .count = opts->color_by_count,
                                     .surface_count = what->count};
    colorings->painted = iso_alloc_zero((size_t)what->count + 1, sizeof *colorings->painted);
    colorings->paint = iso_alloc_zero((size_t)what->count + 1, sizeof *colorings->paint);
    if (!colorings->painted || !colorings->paint)
        return iso_fail(error, ISO_ERR_NOMEM, "out of memory for the paint of %d surfaces", what->count);
    if (count) {
        colorings->made = iso_alloc_zero(count, sizeof *colorings->made);
        colorings->distances = iso_alloc_zero(count, sizeof *colorings->distances);
        if (!colorings->made || !colorings->distances)
            return iso_fail(error, ISO_ERR_NOMEM, "out of memory for %zu colorings", count);
    }
    for (int i = 0; i < colorings->count; i++) ISO_TRY(make(colorings, i, view, error));
    for (int i = 0; i < what->count && !opts->glass && !opts->instances; i++) use_paint(what, i, colorings);
    return ISO_OK;
}

void iso_api_colorings_end(iso_api_colorings *colorings) {
    for (int i = 0; i < colorings->surface_count; i++) colorings->surfaces[i]->scene.coloring = NULL;
    for (int i = 0; i < colorings->count && colorings->distances; i++)
        iso_distance_destroy(colorings->distances[i]);
    iso_free(colorings->distances);
    iso_free(colorings->made);
    iso_free(colorings->painted);
    iso_free(colorings->paint);
}
