/* color_file: reads what surfaces are coloured by. */
#include "scene/color_file.h"

#include <math.h>

#include "base/file_types.h"
#include "scene/distances.h"

/* Whether a file of one of these contents, or a volume, holds the first. */
static bool holds(const iso_color_file *file, iso_color_source source, unsigned contents) {
    if (file->source != source || iso_loader_is_scene(file->path)) return false;
    const iso_file_type type = iso_file_type_find(file->path, contents | ISO_HOLDS_VOLUME);
    return type != ISO_FILE_UNKNOWN && iso_file_type_holds(type) & contents;
}

bool iso_color_file_is_mesh(const iso_color_file *file) {
    return holds(file, ISO_COLOR_BY_DISTANCE, ISO_HOLDS_MESH);
}

bool iso_color_file_is_vertices(const iso_color_file *file) {
    return holds(file, ISO_COLOR_BY_VOLUME, ISO_HOLDS_VALUES);
}

iso_status iso_color_file_open(iso_color_file *file, uint64_t max_memory, iso_file_set *files, iso_pool *pool,
                               iso_error *error) {
    if (iso_color_file_is_mesh(file) && !isnan(file->isovalue))
        return iso_fail(error, ISO_ERR_USAGE, "%s: a mesh has no isovalue", file->path);
    if (iso_color_file_is_mesh(file) || iso_color_file_is_vertices(file)) {
        iso_file_set_read(files, file->path);
        return ISO_OK;
    }
    file->has_volume = true;
    file->input = (iso_input){.max_memory = max_memory, .grid = file->array};
    file->loader =
        (iso_loader){.input = file->path,
                     .options = &file->input,
                     .files = files,
                     .pool = pool,
                     .is_further = true,
                     .wants_histogram = file->source == ISO_COLOR_BY_DISTANCE && isnan(file->isovalue)};
    ISO_TRY(iso_loader_open(&file->loader, error));
    if (!file->loader.has_points) return ISO_OK;
    return iso_fail(error, ISO_ERR_USAGE, "%s: holds points, no volume", file->path);
}

iso_status iso_color_file_read(iso_color_file *file, iso_error *error) {
    iso_loader *loader = &file->loader;
    iso_vertex_values_free(&file->vertices);
    iso_distance_destroy(file->distance);
    file->distance = NULL;
    if (iso_color_file_is_vertices(file))
        return iso_vertex_values_read(file->path, file->array, &file->vertices, error);
    if (iso_color_file_is_mesh(file))
        return iso_distance_of_mesh_file(file->path, NULL, &file->distance, error);
    ISO_TRY(iso_loader_read(loader, error));
    if (file->source != ISO_COLOR_BY_DISTANCE) return ISO_OK;
    ISO_TRY(iso_loader_isovalue(loader, file->isovalue, &file->isovalue, &file->chosen, error));
    return iso_distance_of_isosurface(&loader->volume.grid, file->isovalue, loader->pool, &file->distance,
                                      error);
}

void iso_color_file_close(iso_color_file *file) {
    iso_distance_destroy(file->distance);
    iso_vertex_values_free(&file->vertices);
    iso_loader_close(&file->loader);
}
