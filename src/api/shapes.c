/* The functions of isopoint.h for lines, glyphs and meshes: copies of arrays, contents of files, or what is
 * made of fields, prepared for drawing. */
#include <math.h>
#include <string.h>

#include "api/internal.h"
#include "base/memory.h"

/* ---- copies of arrays */

static iso_status copy_lines(const iso_line_arrays *from, iso_lines *to, iso_error *error) {
    const size_t vertices = from->line_count ? from->starts[from->line_count] : 0;
    if (!vertices) return iso_fail(error, ISO_ERR_EMPTY, "there are no lines");
    to->line_count = from->line_count;
    to->vertex_count = vertices;
    ISO_TRY(iso_api_copy(from->starts, from->line_count + 1, sizeof *to->starts, &to->starts, error));
    ISO_TRY(iso_api_copy(from->vertices, vertices, sizeof *to->vertices, &to->vertices, error));
    ISO_TRY(iso_api_copy(from->radii, vertices, sizeof *to->radii, &to->radii, error));
    ISO_TRY(iso_api_copy(from->normals, vertices, sizeof *to->normals, &to->normals, error));
    return iso_api_copy(from->colors, vertices, sizeof *to->colors, &to->colors, error);
}

static iso_status copy_glyphs(const iso_glyph_arrays *from, iso_glyphs *to, iso_error *error) {
    if (!from->count) return iso_fail(error, ISO_ERR_EMPTY, "there are no points");
    to->count = from->count;
    ISO_TRY(iso_api_copy(from->positions, to->count, sizeof *to->positions, &to->positions, error));
    ISO_TRY(iso_api_copy(from->radii, to->count, sizeof *to->radii, &to->radii, error));
    ISO_TRY(iso_api_copy(from->directions, to->count, sizeof *to->directions, &to->directions, error));
    ISO_TRY(iso_api_copy(from->axes, to->count, sizeof *to->axes, &to->axes, error));
    return iso_api_copy(from->colors, to->count, sizeof *to->colors, &to->colors, error);
}

/* ---- what all sets have */

static iso_status begin(const iso_shape_set_opts *opts, iso_shape_set **set, iso_error *error) {
    if (!(opts->radius >= 0) || !isfinite(opts->radius))
        return iso_fail(error, ISO_ERR_USAGE, "a radius of %g mm", opts->radius);
    if (opts->glyph < ISO_GLYPH_SPHERE || opts->glyph >= ISO_GLYPH_COUNT)
        return iso_fail(error, ISO_ERR_USAGE, "there is no glyph %d", (int)opts->glyph);
    if (!(opts->opacity >= 0 && opts->opacity <= 1))
        return iso_fail(error, ISO_ERR_USAGE, "an opacity of %g is not between 0 and 1", opts->opacity);
    *set = iso_alloc_zero(1, sizeof **set);
    if (!*set) return iso_fail(error, ISO_ERR_NOMEM, "out of memory for a set of shapes");
    (*set)->opacity = opts->opacity > 0 ? opts->opacity : 1;
    (*set)->has_color = opts->color != NULL;
    if (opts->color) (*set)->color = *opts->color;
    return ISO_OK;
}

/* Prepares a filled set for drawing. If this fails, or if `status` is a failure already, frees the set. */
static iso_status finish(iso_status status, iso_shape_set *made, const iso_shape_set_opts *opts,
                         iso_shape_set **set, iso_error *error) {
    const bool lines = made->file.lines.line_count > 0;
    if (made->has_color) { /* one colour is given for the whole set */
        iso_free(made->file.lines.colors);
        iso_free(made->file.glyphs.colors);
        made->file.lines.colors = made->file.glyphs.colors = NULL;
    }
    const iso_shapes_opts how = {.radius = opts->radius > 0 ? opts->radius : NAN,
                                 .glyph = opts->glyph,
                                 .min_pixels = opts->true_width ? 0 : 1,
                                 .style = opts->ribbons ? ISO_LINE_RIBBON : ISO_LINE_TUBE,
                                 .caps = opts->flat_caps ? ISO_CAPS_FLAT : ISO_CAPS_ROUND};
    if (status == ISO_OK && lines && opts->ribbons) status = iso_lines_add_normals(&made->file.lines, error);
    if (lines) made->object.lines = &made->file.lines;
    if (status == ISO_OK)
        status = lines ? iso_shapes_from_lines(&made->file.lines, &how, &made->object.shapes, error)
                       : iso_shapes_from_glyphs(&made->file.glyphs, &how, &made->object.shapes, error);
    if (status == ISO_OK && !iso_shapes_stats(made->object.shapes).shapes)
        status = iso_fail(error, ISO_ERR_EMPTY, "no shape can be drawn");
    if (status == ISO_OK)
        *set = made;
    else
        iso_shape_set_destroy(made);
    return status;
}

static const iso_shape_set_opts defaults;

iso_status iso_shape_set_of_lines(const iso_line_arrays *lines, const iso_shape_set_opts *opts,
                                  iso_shape_set **set, iso_error *error) {
    iso_shape_set *made;
    if (!opts) opts = &defaults;
    ISO_TRY(begin(opts, &made, error));
    return finish(copy_lines(lines, &made->file.lines, error), made, opts, set, error);
}

iso_status iso_shape_set_of_glyphs(const iso_glyph_arrays *glyphs, const iso_shape_set_opts *opts,
                                   iso_shape_set **set, iso_error *error) {
    iso_shape_set *made;
    if (!opts) opts = &defaults;
    ISO_TRY(begin(opts, &made, error));
    return finish(copy_glyphs(glyphs, &made->file.glyphs, error), made, opts, set, error);
}

/* ---- files */

static iso_status read_shapes(const char *path, iso_object_kind kind, const iso_shape_set_opts *opts,
                              iso_shape_set **set, iso_error *error) {
    iso_shape_set *made;
    if (!opts) opts = &defaults;
    const iso_read_opts reading = {.space = opts->ras ? ISO_SPACE_RAS : ISO_SPACE_FILE};
    ISO_TRY(begin(opts, &made, error));
    iso_status status = iso_api_check_path(path, error);
    if (status == ISO_OK) status = iso_object_file_read(&made->file, path, kind, &reading, NULL, NULL, error);
    return finish(status, made, opts, set, error);
}

iso_status iso_shape_set_read_lines(const char *path, const iso_shape_set_opts *opts, iso_shape_set **set,
                                    iso_error *error) {
    return read_shapes(path, ISO_OBJECT_LINES, opts, set, error);
}

iso_status iso_shape_set_read_glyphs(const char *path, const iso_shape_set_opts *opts, iso_shape_set **set,
                                     iso_error *error) {
    return read_shapes(path, ISO_OBJECT_GLYPHS, opts, set, error);
}

/* ---- meshes */

/* Prepares triangles for drawing, and frees a set for which that fails. */
static iso_status finish_mesh(iso_status status, iso_shape_set *made, const iso_triangles *triangles,
                              iso_shape_set **set, iso_error *error) {
    if (status == ISO_OK) status = iso_triangle_spans_make(triangles, &made->object.spans, error);
    if (status == ISO_OK && !made->object.spans.span_count)
        status = iso_fail(error, ISO_ERR_EMPTY, "no triangle has an area");
    if (status == ISO_OK && !made->has_color && made->opacity >= 1)
        status = iso_scene_object_use_vertex_colors(&made->object, triangles, error);
    if (status == ISO_OK)
        *set = made;
    else
        iso_shape_set_destroy(made);
    return status;
}

iso_status iso_api_check_mesh(const iso_mesh *mesh, iso_error *error) {
    if (!mesh->triangle_count) return iso_fail(error, ISO_ERR_EMPTY, "there are no triangles");
    for (size_t i = 0; i < mesh->triangle_count; i++)
        for (int k = 0; k < 3; k++)
            if (mesh->triangles[i][k] >= mesh->vertex_count)
                return iso_fail(error, ISO_ERR_USAGE, "triangle %zu has vertex %u of %zu", i,
                                mesh->triangles[i][k], mesh->vertex_count);
    for (size_t i = 0; i < mesh->vertex_count; i++)
        for (int k = 0; k < 3; k++)
            if (!isfinite(mesh->positions[i][k]))
                return iso_fail(error, ISO_ERR_USAGE, "the position of vertex %zu is not finite", i);
    return ISO_OK;
}

iso_status iso_shape_set_of_mesh(const iso_mesh *mesh, const iso_shape_set_opts *opts, iso_shape_set **set,
                                 iso_error *error) {
    iso_shape_set *made;
    const iso_triangles triangles = {.vertices = mesh->positions,
                                     .vertex_count = mesh->vertex_count,
                                     .triangles = mesh->triangles,
                                     .triangle_count = mesh->triangle_count};
    ISO_TRY(iso_api_check_mesh(mesh, error));
    ISO_TRY(begin(opts ? opts : &defaults, &made, error));
    return finish_mesh(ISO_OK, made, &triangles, set, error);
}

iso_status iso_api_read_mesh(const char *path, bool ras, iso_triangles *triangles, iso_error *error) {
    ISO_TRY(iso_api_check_path(path, error));
    return iso_object_read_mesh(path, ras, triangles, error);
}

iso_status iso_shape_set_read_mesh(const char *path, const iso_shape_set_opts *opts, iso_shape_set **set,
                                   iso_error *error) {
    iso_shape_set *made;
    iso_triangles triangles = {0};
    if (!opts) opts = &defaults;
    ISO_TRY(begin(opts, &made, error));
    const iso_status status =
        finish_mesh(iso_api_read_mesh(path, opts->ras, &triangles, error), made, &triangles, set, error);
    iso_triangles_free(&triangles);
    return status;
}

/* ---- fields */

static const iso_vector_shape_opts field_defaults;

static iso_status check_array(const iso_vector_array *array, iso_error *error) {
    const int components = array->components, *dims = array->dims;
    if (components && components != ISO_VECTOR_COMPONENTS && components != ISO_TENSOR_COMPONENTS)
        return iso_fail(error, ISO_ERR_USAGE, "a field of %d components: vectors have 3, tensors 6",
                        components);
    if (!array->values || dims[0] < 1 || dims[1] < 1 || dims[2] < 1)
        return iso_fail(error, ISO_ERR_USAGE, "a field of %d x %d x %d voxels%s", dims[0], dims[1], dims[2],
                        array->values ? "" : " without values");
    if (array->transform && iso_transform_is_singular(array->transform))
        return iso_fail(error, ISO_ERR_USAGE, "the field's transform is singular");
    return ISO_OK;
}

/* The caller's array, which is only borrowed: iso_vectors_free must not be called. */
static iso_status borrow_field(const iso_vector_array *from, iso_vectors *to, iso_error *error) {
    ISO_TRY(check_array(from, error));
    *to = (iso_vectors){.transform = from->transform ? *from->transform : iso_transform_identity(),
                        .components = from->components ? from->components : ISO_VECTOR_COMPONENTS};
    memcpy(&to->values, &from->values, sizeof to->values); /* which are only read */
    memcpy(to->dims, from->dims, sizeof to->dims);
    return ISO_OK;
}

static iso_status read_field(const char *path, const iso_shape_set_opts *opts, iso_vectors *field,
                             iso_error *error) {
    ISO_TRY(iso_api_check_path(path, error));
    const iso_vectors_opts reading = {.axes = opts->ras ? ISO_VECTOR_AXES_RAS : ISO_VECTOR_AXES_FILE};
    iso_vectors_info info;
    return iso_vectors_read(path, &reading, field, &info, error);
}

static iso_status check_field(const iso_vector_shape_opts *how, iso_error *error) {
    const double numbers[4] = {how->least, how->scale, how->step, how->length};
    for (int i = 0; i < 4; i++)
        if (!(numbers[i] >= 0) || !isfinite(numbers[i]))
            return iso_fail(error, ISO_ERR_USAGE, "an option of a field is %g", numbers[i]);
    if (how->every < 0 || how->streamlines < 0)
        return iso_fail(error, ISO_ERR_USAGE, "%d streamlines, glyphs at each %d voxels", how->streamlines,
                        how->every);
    return ISO_OK;
}

static iso_status make_glyphs(const iso_vectors *field, const iso_vector_shape_opts *how,
                              const iso_shape_set_opts *opts, iso_glyphs *glyphs, iso_error *error) {
    const iso_vector_glyphs_opts glyph_opts = {.every = how->every,
                                               .scale = how->scale,
                                               .least = how->least,
                                               .centred = opts->glyph == ISO_GLYPH_CYLINDER};
    iso_vector_glyphs_totals totals;
    ISO_TRY(iso_vector_glyphs(field, &glyph_opts, glyphs, &totals, error));
    return glyphs->count
               ? ISO_OK
               : iso_fail(error, ISO_ERR_EMPTY, "no voxel of the field has a glyph (of %zu)", totals.voxels);
}

static iso_status make_streamlines(const iso_vectors *field, const iso_vector_shape_opts *how,
                                   iso_lines *lines, iso_error *error) {
    const iso_streamlines_opts line_opts = {.count = how->streamlines,
                                            .seed = how->seed,
                                            .step = how->step,
                                            .length = how->length,
                                            .slowest = how->least,
                                            .axial = how->axial};
    iso_streamlines_totals totals;
    ISO_TRY(iso_streamlines(field, &line_opts, lines, &totals, error));
    return lines->line_count ? ISO_OK
                             : iso_fail(error, ISO_ERR_EMPTY,
                                        "no streamline begins where vectors are %g long", totals.slowest);
}

/* Makes a set of a field that has been read or borrowed. */
static iso_status make_of_field(const iso_vectors *field, const iso_vector_shape_opts *how,
                                const iso_shape_set_opts *opts, iso_shape_set **set, iso_error *error) {
    iso_shape_set_opts drawn = *opts;
    iso_shape_set *made;
    ISO_TRY(check_field(how, error));
    if (opts->glyph == ISO_GLYPH_SPHERE)
        drawn.glyph = field->components == ISO_TENSOR_COMPONENTS ? ISO_GLYPH_ELLIPSOID : ISO_GLYPH_ARROW;
    ISO_TRY(begin(&drawn, &made, error));
    const iso_status status = how->streamlines ? make_streamlines(field, how, &made->file.lines, error)
                                               : make_glyphs(field, how, &drawn, &made->file.glyphs, error);
    return finish(status, made, &drawn, set, error);
}

iso_status iso_shape_set_of_vectors(const iso_vector_array *vectors, const iso_vector_shape_opts *how,
                                    const iso_shape_set_opts *opts, iso_shape_set **set, iso_error *error) {
    iso_vectors field;
    ISO_TRY(borrow_field(vectors, &field, error));
    return make_of_field(&field, how ? how : &field_defaults, opts ? opts : &defaults, set, error);
}

iso_status iso_shape_set_read_vectors(const char *path, const iso_vector_shape_opts *how,
                                      const iso_shape_set_opts *opts, iso_shape_set **set, iso_error *error) {
    iso_vectors field = {0};
    if (!opts) opts = &defaults;
    iso_status status = read_field(path, opts, &field, error);
    if (status == ISO_OK) status = make_of_field(&field, how ? how : &field_defaults, opts, set, error);
    iso_vectors_free(&field);
    return status;
}

void iso_shape_set_destroy(iso_shape_set *set) {
    if (!set) return;
    iso_scene_object_free(&set->object);
    iso_object_file_free(&set->file);
    iso_free(set);
}

iso_box iso_shape_set_bounds(const iso_shape_set *set) {
    return iso_scene_object_bounds(&set->object);
}
