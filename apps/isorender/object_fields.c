/* object_fields: objects that are made of a volume of vectors or tensors: glyphs at its voxels, or lines
 * along its vectors. */
#include <inttypes.h>
#include <string.h>

#include "apps/isorender/objects.h"
#include "base/file.h"
#include "grids/volume/npy_header.h"

/* ---- recognising volumes */

bool isorender_object_is_field(const char *path) {
    char head[1024];
    const size_t count = iso_file_head(path, head, sizeof head);
    const char *format = iso_volume_format(head, count);
    if (!format) return false;
    if (strcmp(format, "npy") == 0) return iso_npy_axes(path) > 2; /* else rows of points */
    /* VTK's files hold other things, too, and say in their first lines what */
    const char *kind = strcmp(format, "vtk") == 0 ? "STRUCTURED_POINTS" : "ImageData";
    if (strcmp(format, "vtk") != 0 && strcmp(format, "vti") != 0) return true;
    return memmem(head, count, kind, strlen(kind)) != NULL;
}

/* ---- reading */

static void note(iso_read_report *report, const char *text) {
    if (report->note_count == ISO_READ_NOTES) return;
    snprintf(report->notes[report->note_count++], ISO_READ_TEXT, "%s", text);
}

static void note_count(iso_read_report *report, size_t count, const char *format) {
    char text[ISO_READ_TEXT];
    snprintf(text, sizeof text, format, count);
    if (count) note(report, text);
}

static void fill_report(isorender_object *object, const iso_vectors_info *info) {
    iso_read_report *report = &object->report;
    const bool nifti = strcmp(info->volume.format, "nifti") == 0;
    snprintf(report->format, sizeof report->format, "%s", info->volume.format);
    report->space = info->ras ? ISO_SPACE_RAS : ISO_SPACE_LPS;
    report->space_stated = info->axes_stated;
    for (int i = 0; i < info->volume.note_count; i++) note(report, info->volume.notes[i]);
    if (nifti && object->settings->field.axes == ISO_VECTOR_AXES_FILE)
        note(report,
             "vectors are taken as RAS, which the file does not say (--space ras, lps, voxels or fsl)");
    if (info->asymmetry > 1e-3 * object->field.vectors.longest)
        note(report, "tensors are not symmetric: their symmetric parts are drawn");
}

static iso_status fail_no_vectors(const isorender_object *object, iso_error *error) {
    const iso_vectors_totals *totals = &object->field.vectors;
    const char *what = object->field.components == 3 ? "vector" : "tensor";
    const char *path = object->settings->path;
    if (!totals->missing) return iso_fail(error, ISO_ERR_EMPTY, "%s: every %s is 0", path, what);
    if (!totals->zero)
        return iso_fail(error, ISO_ERR_EMPTY, "%s: no %s is finite%s", path, what,
                        object->field.components == 7 ? " and inside the mask" : "");
    return iso_fail(error, ISO_ERR_EMPTY, "%s: every %s is 0 or not finite", path, what);
}

/* ---- glyphs */

static void note_glyphs(isorender_object *object) {
    const iso_vector_glyphs_totals *totals = &object->field.glyphs;
    if (object->field.components != 7) /* else these are the voxels outside the mask */
        note_count(&object->report, totals->missing, "%zu vectors are not finite: they have no glyphs");
    note_count(&object->report, totals->indefinite,
               "%zu tensors are not positive definite: they have no ellipsoids");
    if (object->settings->every || totals->every == 1) return;
    char text[ISO_READ_TEXT];
    snprintf(text, sizeof text, "one glyph for every %d voxels on each axis (--every)", totals->every);
    note(&object->report, text);
}

static iso_status make_glyphs(isorender_object *object, const iso_vectors *vectors, const iso_read_opts *opts,
                              iso_pool *pool, iso_error *error) {
    const isorender_object_settings *settings = object->settings;
    const bool tensors = vectors->components == ISO_TENSOR_COMPONENTS;
    if (!settings->glyph_given) object->glyph = tensors ? ISO_GLYPH_ELLIPSOID : ISO_GLYPH_ARROW;
    const iso_vector_glyphs_opts glyph_opts = {.every = opts->every,
                                               .scale = settings->field.scale,
                                               .least = settings->field.least,
                                               .centred = object->glyph == ISO_GLYPH_CYLINDER,
                                               .max_memory = opts->max_memory,
                                               .pool = pool};
    ISO_TRY(iso_vector_glyphs(vectors, &glyph_opts, &object->glyphs, &object->field.glyphs, error));
    note_glyphs(object);
    const iso_vector_glyphs_totals *totals = &object->field.glyphs;
    object->report.items = totals->voxels;
    if (!settings->colored && !settings->by_direction && !object->color_by)
        object->color_by = tensors ? "anisotropy" : "magnitude";
    if (object->glyphs.count) return ISO_OK;
    if (totals->small)
        return iso_fail(error, ISO_ERR_EMPTY, "%s: no glyphs: no %s is at least %g (--least)", settings->path,
                        tensors ? "anisotropy" : "vector", settings->field.least);
    return iso_fail(error, ISO_ERR_EMPTY, "%s: no glyphs: of %zu %s %zu are 0, %zu not finite%s",
                    settings->path, totals->voxels, tensors ? "tensors" : "vectors", totals->zero,
                    totals->missing, totals->indefinite ? ", the others not positive definite" : "");
}

/* ---- lines */

static iso_status make_lines(isorender_object *object, const iso_vectors *vectors, const iso_read_opts *opts,
                             iso_pool *pool, iso_error *error) {
    const isorender_object_settings *settings = object->settings;
    const isorender_field_settings *field = &settings->field;
    const int every = opts->every ? opts->every : 1;
    if (vectors->components != ISO_VECTOR_COMPONENTS)
        return iso_fail(error, ISO_ERR_EMPTY, "%s: holds tensors: streamlines follow vectors (3 components)",
                        settings->path);
    const iso_streamlines_opts line_opts = {.count = (field->streamlines - 1) / every + 1,
                                            .seed = (uint64_t)field->seed,
                                            .length = field->length,
                                            .slowest = field->least,
                                            .axial = field->axial,
                                            .max_memory = opts->max_memory,
                                            .pool = pool};
    ISO_TRY(iso_streamlines(vectors, &line_opts, &object->lines, &object->field.lines, error));
    object->report.items = (uint64_t)field->streamlines;
    if (!settings->colored && !settings->by_direction && !object->color_by) object->color_by = "speed";
    if (!object->lines.line_count)
        return iso_fail(error, ISO_ERR_EMPTY,
                        "%s: no streamlines at %" PRIu64
                        " places: vectors are shorter than %g there, or lead out "
                        "of the volume",
                        settings->path, object->field.lines.tried, object->field.lines.slowest);
    if (object->lines.line_count < (size_t)line_opts.count)
        note_count(&object->report, object->lines.line_count, "%zu streamlines: no more places have vectors");
    return ISO_OK;
}

/* Of lines in all the volume, not of one of them, so that a picture shows some hundreds of them. */
double isorender_field_radius(const isorender_object *object) {
    const iso_box box = iso_lines_bounds(&object->lines);
    return iso_vec3_length(iso_vec3_sub(box.hi, box.lo)) / 400;
}

static iso_status make(isorender_object *object, const iso_vectors *vectors, const iso_vectors_info *info,
                       const iso_read_opts *opts, iso_pool *pool, iso_error *error) {
    memcpy(object->field.dims, vectors->dims, sizeof object->field.dims);
    object->field.components = info->volume.components;
    ISO_TRY(iso_vectors_measure(vectors, pool, &object->field.vectors, error));
    fill_report(object, info);
    if (!object->field.vectors.usable) return fail_no_vectors(object, error);
    return (object->settings->kind == ISORENDER_LINES ? make_lines : make_glyphs)(object, vectors, opts, pool,
                                                                                  error);
}

iso_status isorender_object_read_field(isorender_object *object, const iso_read_opts *opts, iso_pool *pool,
                                       iso_error *error) {
    const isorender_field_settings *field = &object->settings->field;
    iso_vectors_opts vector_opts = {.array = field->array,
                                    .axes = field->axes,
                                    .max_memory = opts->max_memory,
                                    .files = opts->files,
                                    .pool = pool};
    memcpy(vector_opts.order, field->order, sizeof vector_opts.order);
    iso_vectors vectors = {0};
    iso_vectors_info info;
    ISO_TRY(iso_vectors_read(object->settings->path, &vector_opts, &vectors, &info, error));
    const uint64_t taken =
        (uint64_t)iso_vectors_count(&vectors) * (uint64_t)vectors.components * sizeof(float);
    iso_read_opts left = *opts;
    if (left.max_memory > taken) left.max_memory -= taken;
    const iso_status status = make(object, &vectors, &info, &left, pool, error);
    iso_vectors_free(&vectors);
    return status;
}

/* ---- reports */

static void put_glyphs(iso_json *json, const iso_vector_glyphs_totals *totals) {
    iso_json_integer(json, "every", (uint64_t)totals->every);
    iso_json_real(json, "scale_mm", totals->scale);
    iso_json_integer(json, "indefinite", totals->indefinite);
    iso_json_integer(json, "small", totals->small);
}

static void put_lines(iso_json *json, const iso_streamlines_totals *totals) {
    iso_json_real(json, "step_mm", totals->step);
    iso_json_real(json, "least", totals->slowest);
    iso_json_integer(json, "tried", totals->tried);
    iso_json_begin_object(json, "ends");
    iso_json_integer(json, "left", totals->left);
    iso_json_integer(json, "slow", totals->slowed);
    iso_json_integer(json, "length", totals->grown);
    iso_json_end_object(json);
}

void isorender_field_put(iso_json *json, const isorender_object *object) {
    const isorender_field *field = &object->field;
    iso_json_begin_object(json, "field");
    iso_json_ints(json, "dims", field->dims, 3);
    iso_json_integer(json, "components", (uint64_t)field->components);
    iso_json_integer(json, "usable", field->vectors.usable);
    iso_json_integer(json, "zero", field->vectors.zero);
    iso_json_integer(json, "missing", field->vectors.missing);
    iso_json_real(json, "longest", field->vectors.longest);
    if (object->settings->kind == ISORENDER_LINES)
        put_lines(json, &field->lines);
    else
        put_glyphs(json, &field->glyphs);
    iso_json_end_object(json);
}

void isorender_field_info(const isorender_object *object) {
    const isorender_field *field = &object->field;
    printf("  %-11s %d x %d x %d, %d components: %s\n", "voxels", field->dims[0], field->dims[1],
           field->dims[2], field->components,
           field->components == 3   ? "vectors"
           : field->components == 7 ? "masked symmetric tensors"
                                    : "symmetric tensors");
    printf("  %-11s %zu, %zu are 0, %zu missing; the longest %.6g\n",
           field->components == 3 ? "vectors" : "tensors", field->vectors.usable, field->vectors.zero,
           field->vectors.missing, field->vectors.longest);
}
