/* objects: reads files of lines, glyphs and meshes, chooses radii, and prepares them for drawing. */
#include "apps/isorender/objects.h"

#include <math.h>
#include <string.h>

#include "base/memory.h"
#include "base/text.h"

static bool has_lines(const isorender_object *object) {
    return object->settings->kind == ISO_OBJECT_LINES;
}

/* ---- columns that options name */

static const iso_attribute *attributes_of(const isorender_object *object, int *count) {
    const bool lines = has_lines(object);
    *count = lines ? object->file.lines.attribute_count : object->file.glyphs.attribute_count;
    return lines ? object->file.lines.attributes : object->file.glyphs.attributes;
}

/* Adds a column "x", "y" or "z" with this coordinate of points, in mm. */
static iso_status add_coordinate(iso_glyphs *points, char name, iso_error *error) {
    const size_t count = (size_t)points->attribute_count;
    iso_attribute *attributes = iso_alloc_zero(count + 1, sizeof *attributes);
    iso_attribute added = {.name = iso_alloc_zero(2, 1), .components = 1};
    added.values = iso_alloc_zero(points->count, sizeof *added.values);
    if (!attributes || !added.name || !added.values) {
        iso_free(attributes);
        iso_free(added.name);
        iso_free(added.values);
        return iso_fail_memory(error, "a column of coordinates");
    }
    if (count) memcpy(attributes, points->attributes, count * sizeof *attributes);
    iso_free(points->attributes);
    points->attributes = attributes;
    added.name[0] = name;
    for (size_t i = 0; i < points->count; i++) {
        const iso_vec3 p = iso_glyph_position(points, i);
        added.values[i] = (float)(name == 'x' ? p.x : name == 'y' ? p.y : p.z);
    }
    points->attributes[points->attribute_count++] = added;
    return ISO_OK;
}

/* The attribute of a name that an option gives; the coordinates of points are attributes, too. ISO_ERR_USAGE
 * lists the names that there are. */
static iso_status find_attribute(isorender_object *object, const char *name, const iso_attribute **attribute,
                                 iso_error *error) {
    int count;
    const iso_attribute *attributes = attributes_of(object, &count);
    *attribute = isorender_attribute_find(attributes, count, name);
    if (*attribute) return ISO_OK;
    if (!has_lines(object) && strlen(name) == 1 && strchr("xyz", name[0])) {
        ISO_TRY(add_coordinate(&object->file.glyphs, name[0], error));
        *attribute = &object->file.glyphs.attributes[count];
        return ISO_OK;
    }
    char names[256] = "none";
    for (int i = 0, used = 0; i < count && used < (int)sizeof names; i++)
        used +=
            snprintf(names + used, sizeof names - (size_t)used, "%s%s", i ? ", " : "", attributes[i].name);
    return iso_fail(error, ISO_ERR_USAGE, "%s%shas no column '%s'; its columns: %s%s",
                    object->settings->path ? object->settings->path : "", object->settings->path ? ": " : "",
                    name, names, has_lines(object) ? "" : "; and x, y, z");
}

/* ---- radii */

/* Radii of an attribute; what is no usable number becomes 0, as in the readers. */
static iso_status take_radii(isorender_object *object, float **radii, iso_error *error) {
    const iso_attribute *attribute;
    const iso_lines *lines = &object->file.lines;
    const size_t count = has_lines(object) ? lines->vertex_count : object->file.glyphs.count;
    ISO_TRY(find_attribute(object, object->settings->radius_column, &attribute, error));
    if (attribute->components != 1)
        return iso_fail(error, ISO_ERR_USAGE, "%s: column '%s' has %d numbers, not a radius",
                        object->settings->path, attribute->name, attribute->components);
    float *taken = iso_alloc(count * sizeof *taken);
    if (!taken) return iso_fail(error, ISO_ERR_NOMEM, "out of memory for %zu radii", count);
    for (size_t line = 0; attribute->per_line && line < lines->line_count; line++)
        for (size_t i = lines->starts[line]; i < lines->starts[line + 1]; i++)
            taken[i] = attribute->values[line];
    if (!attribute->per_line) memcpy(taken, attribute->values, count * sizeof *taken);
    for (size_t i = 0; i < count; i++)
        if (!(taken[i] >= 0 && isfinite(taken[i]))) taken[i] = 0;
    iso_free(*radii);
    *radii = taken;
    return ISO_OK;
}

static iso_status set_radii(isorender_object *object, iso_error *error) {
    float **radii = has_lines(object) ? &object->file.lines.radii : &object->file.glyphs.radii;
    if (object->settings->radius_column) return take_radii(object, radii, error);
    if (isnan(object->settings->radius)) return ISO_OK;
    iso_free(*radii); /* one radius is given for all */
    *radii = NULL;
    return ISO_OK;
}

/* ---- reading and preparing */

iso_status isorender_object_read(isorender_object *object, const isorender_object_settings *settings,
                                 uint64_t max_memory, iso_file_set *files, iso_pool *pool, iso_error *error) {
    object->settings = settings;
    object->scene.color = settings->color;
    object->glyph = settings->glyph;
    object->color_by = settings->color_by;
    iso_object_file *file = &object->file;
    const iso_read_opts opts = {
        .max_memory = max_memory, .space = settings->space, .every = settings->every, .files = files};
    iso_vector_field_opts field = settings->field;
    if (isorender_object_is_surface(settings)) return ISO_OK;
    if (settings->glyph_given) field.glyph = &settings->glyph;
    ISO_TRY(iso_object_file_read(file, settings->path, settings->kind, &opts, &field, pool, error));
    if (file->field.components) object->glyph = file->glyph;
    if (file->values && !settings->colored && !settings->by_direction && !object->color_by)
        object->color_by = file->values;
    if (file->branches) isorender_object_take_branches(object);
    return settings->kind == ISO_OBJECT_MESH ? ISO_OK : isorender_object_style(object, error);
}

iso_status isorender_object_style(isorender_object *object, iso_error *error) {
    const iso_attribute *attribute;
    if (object->color_by) ISO_TRY(find_attribute(object, object->color_by, &attribute, error));
    ISO_TRY(set_radii(object, error));
    return isorender_object_color(object, error);
}

iso_lines isorender_object_lines(const isorender_object *object, const isorender_line_pixels *pixels,
                                 iso_shapes_opts *opts) {
    const double given = object->settings->radius,
                 usual = object->file.field.components ? isorender_field_radius(object) : (double)NAN;
    const isorender_line_style style = object->settings->style;
    iso_lines drawn = object->file.lines;
    *opts = (iso_shapes_opts){.radius = isnan(given) ? usual : given,
                              .min_pixels = pixels->least,
                              .drop_pixels = pixels->drop,
                              .caps = object->settings->caps,
                              .shading = object->settings->shading};
    if (style == ISORENDER_STYLE_RIBBON)
        opts->style = ISO_LINE_RIBBON;
    else
        drawn.normals = NULL;
    if (style == ISORENDER_STYLE_LINE) { /* no size in space */
        drawn.radii = NULL;
        opts->radius = 0;
    }
    return drawn;
}

static iso_status prepare_lines(isorender_object *object, const isorender_line_pixels *pixels,
                                bool by_pullpush, iso_error *error) {
    if (object->settings->style == ISORENDER_STYLE_RIBBON)
        ISO_TRY(iso_lines_add_normals(&object->file.lines, error));
    iso_shapes_opts opts;
    const iso_lines drawn = isorender_object_lines(object, pixels, &opts);
    object->scene.lines = &object->file.lines;
    ISO_TRY(iso_shapes_from_lines(&drawn, &opts, &object->scene.shapes, error));
    return by_pullpush ? iso_pyramid_lines_create(&drawn, &opts, &object->scene.pyramid_lines, error)
                       : ISO_OK;
}

static iso_status prepare_glyphs(isorender_object *object, iso_error *error) {
    const iso_shapes_opts opts = {.glyph = object->glyph,
                                  .projection = object->settings->projection,
                                  .radius = object->settings->radius};
    return iso_shapes_from_glyphs(&object->file.glyphs, &opts, &object->scene.shapes, error);
}

iso_status isorender_object_prepare(isorender_object *object, const isorender_line_pixels *pixels,
                                    bool by_pullpush, iso_error *error) {
    const bool mesh = object->settings->kind == ISO_OBJECT_MESH;
    ISO_TRY(mesh                ? iso_triangle_spans_make(&object->file.mesh, &object->scene.spans, error)
            : has_lines(object) ? prepare_lines(object, pixels, by_pullpush, error)
                                : prepare_glyphs(object, error));
    object->bounds = iso_scene_object_bounds(&object->scene);
    if (!iso_box_is_empty(&object->bounds))
        return mesh && !object->settings->colored && object->settings->opacity >= 1
                   ? iso_scene_object_use_vertex_colors(&object->scene, &object->file.mesh, error)
                   : ISO_OK;
    return iso_fail(error, ISO_ERR_EMPTY, "%s: nothing to draw: %s", object->settings->path,
                    mesh                ? "no triangle has an area"
                    : has_lines(object) ? "every line has one vertex, or radii of 0"
                                        : "every size is 0");
}

iso_box isorender_object_bounds_along(const isorender_object *object, const iso_vec3 vectors[3]) {
    iso_box box = iso_box_empty();
    if (object->settings->kind != ISO_OBJECT_MESH)
        return iso_shapes_bounds_along(object->scene.shapes, vectors);
    for (size_t i = 0; i < object->file.mesh.vertex_count; i++) {
        const float *v = object->file.mesh.vertices[i];
        const iso_vec3 p = iso_vec3_make((double)v[0], (double)v[1], (double)v[2]);
        iso_box_add(&box, iso_vec3_make(iso_vec3_dot(vectors[0], p), iso_vec3_dot(vectors[1], p),
                                        iso_vec3_dot(vectors[2], p)));
    }
    return box;
}

void isorender_object_free(isorender_object *object) {
    iso_scene_object_free(&object->scene);
    iso_object_file_free(&object->file);
    iso_color_table_free(&object->colors);
    *object = (isorender_object){.settings = NULL};
}

/* ---- reports */

static const char *space_name(iso_space space) {
    return space == ISO_SPACE_RAS ? "ras" : "lps";
}

/* Members of what is translucent. */
static void put_layers(iso_json *json, const isorender_object *object) {
    iso_json_real(json, "opacity", object->settings->opacity);
    iso_json_integer(json, "samples", object->scene.layered.samples);
    iso_json_integer(json, "layers", object->scene.layered.layers);
}

/* Members of lines and glyphs. */
static void put_shapes(iso_json *json, const isorender_object *object) {
    const iso_shapes_totals totals = iso_shapes_stats(object->scene.shapes);
    const bool is_file = !isorender_object_is_surface(object->settings);
    if (is_file) iso_json_string(json, "format", object->file.report.format);
    if (is_file) iso_json_string(json, "space", space_name(object->file.report.space));
    if (has_lines(object)) {
        iso_json_integer(json, "lines", object->file.lines.line_count);
        iso_json_integer(json, "vertices", object->file.lines.vertex_count);
        if (object->file.branches) iso_json_integer(json, "mesh_triangles", object->file.branches_triangles);
    } else {
        iso_json_integer(json, "glyphs", object->file.glyphs.count);
    }
    if (object->file.field.components) isorender_field_put(json, object);
    if (!is_file) isorender_gradients_put(json, object);
    iso_json_integer(json, "shapes", totals.shapes);
    iso_json_integer(json, "skipped", totals.skipped);
    iso_json_integer(json, "dropped", object->file.report.dropped);
    if (object->settings->opacity >= 1) {
        iso_json_integer(json, "samples", object->scene.drawn.samples);
        if (has_lines(object) && !object->scene.pyramid_lines)
            iso_json_integer(json, "widened_samples", object->scene.drawn.widened);
    }
    if (object->has_bar) {
        const double range[2] = {object->bar.low, object->bar.high};
        iso_json_reals(json, "range", range, 2);
    }
}

void isorender_object_put(iso_json *json, const isorender_object *object) {
    const iso_box *box = &object->bounds;
    const double bounds[6] = {box->lo.x, box->hi.x, box->lo.y, box->hi.y, box->lo.z, box->hi.z};
    iso_json_begin_object(json, NULL);
    iso_json_string(json, "path", object->settings->path);
    if (object->settings->kind == ISO_OBJECT_MESH)
        iso_json_integer(json, "triangles", object->file.mesh.triangle_count);
    else
        put_shapes(json, object);
    if (object->scene.by_cpu) iso_json_string(json, "backend", "cpu");
    if (object->settings->opacity < 1) put_layers(json, object);
    iso_json_reals(json, "bounds_world", bounds, 6);
    iso_json_end_object(json);
}

void isorender_object_info_columns(const isorender_object *object) {
    int count;
    const iso_attribute *attributes = attributes_of(object, &count);
    for (int i = 0; i < count; i++) {
        const iso_attribute *a = &attributes[i];
        const size_t items = !has_lines(object) ? object->file.glyphs.count
                             : a->per_line      ? object->file.lines.line_count
                                                : object->file.lines.vertex_count;
        double range[2];
        printf("  %-11s ", i ? "" : "columns");
        iso_text_put(stdout, a->name);
        if (a->components > 1) printf(", %d numbers", a->components);
        printf(a->per_line ? ", of lines: " : ": ");
        if (isorender_attribute_range(a, items, range))
            printf("%.6g .. %.6g%s\n", range[0], range[1], a->components > 1 ? " (lengths)" : "");
        else
            printf("no finite number\n");
    }
}

static void print_contents(const isorender_object *object) {
    printf("  %-11s %s, %s%s\n", "format", object->file.report.format, space_name(object->file.report.space),
           object->file.report.space_stated ? "" : " (not stated in the file)");
    if (object->file.field.components) isorender_field_info(object);
    if (has_lines(object))
        printf("  %-11s %zu, %zu vertices%s\n", "lines", object->file.lines.line_count,
               object->file.lines.vertex_count, object->file.lines.radii ? ", with radii" : "");
    else
        printf("  %-11s %zu%s\n", "glyphs", object->file.glyphs.count,
               object->file.glyphs.radii ? ", with radii" : "");
}

static iso_box contents_bounds(const isorender_object *object) {
    iso_box box = iso_box_empty();
    if (has_lines(object)) return iso_lines_bounds(&object->file.lines);
    if (object->settings->kind == ISO_OBJECT_GLYPHS) return iso_glyphs_bounds(&object->file.glyphs);
    for (size_t i = 0; i < object->file.mesh.vertex_count; i++) {
        const float *p = object->file.mesh.vertices[i];
        iso_box_add(&box, iso_vec3_make((double)p[0], (double)p[1], (double)p[2]));
    }
    return box;
}

void isorender_object_info(const isorender_object *object) {
    const iso_box box = contents_bounds(object);
    if (isorender_object_is_surface(object->settings)) return; /* nothing is extracted for --info */
    iso_text_put(stdout, object->settings->path);
    printf("\n");
    if (object->settings->kind == ISO_OBJECT_MESH)
        printf("  %-11s %zu\n", "triangles", object->file.mesh.triangle_count);
    else
        print_contents(object);
    printf("  %-11s %.6g %.6g %.6g .. %.6g %.6g %.6g%s\n", "bounds", box.lo.x, box.lo.y, box.lo.z, box.hi.x,
           box.hi.y, box.hi.z, iso_world_unit_suffix(object->file.report.unit));
    isorender_object_info_columns(object);
}
