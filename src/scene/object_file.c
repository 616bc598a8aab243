/* object_file: reads files of lines, glyphs and meshes, and makes lines and glyphs of vectors, tensors and
 * branches. */
#include "scene/object_file.h"

#include <inttypes.h>
#include <string.h>

#include "base/file.h"
#include "base/file_types.h"
#include "base/memory.h"
#include "grids/volume/npy_header.h"
#include "io/glyphs/glyphs_read.h"
#include "io/lines/lines_read.h"
#include "io/mesh/mesh_read.h"

typedef struct reading {
    iso_object_file *file;
    const char *path;
    iso_object_kind kind;
    const iso_read_opts *opts;
    const iso_vector_field_opts *field;
} reading;

/* ---- recognising volumes */

/* Whether a file is a volume, by its content. */
static bool is_field(const char *path) {
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

static void fill_report(reading *r, const iso_vectors_info *info) {
    iso_read_report *report = &r->file->report;
    const bool nifti = strcmp(info->volume.format, "nifti") == 0;
    snprintf(report->format, sizeof report->format, "%s", info->volume.format);
    report->space = info->ras ? ISO_SPACE_RAS : ISO_SPACE_LPS;
    report->space_stated = info->axes_stated;
    for (int i = 0; i < info->volume.note_count; i++) note(report, info->volume.notes[i]);
    if (nifti && r->field->axes == ISO_VECTOR_AXES_FILE)
        note(report,
             "vectors are taken as RAS, which the file does not say (--space ras, lps, voxels or fsl)");
    if (info->asymmetry > 1e-3 * r->file->field.vectors.longest)
        note(report, "tensors are not symmetric: their symmetric parts are drawn");
}

static iso_status fail_no_vectors(const reading *r, iso_error *error) {
    const iso_vectors_totals *totals = &r->file->field.vectors;
    const char *what = r->file->field.components == 3 ? "vector" : "tensor";
    const char *path = r->path;
    if (!totals->missing) return iso_fail(error, ISO_ERR_EMPTY, "%s: every %s is 0", path, what);
    if (!totals->zero)
        return iso_fail(error, ISO_ERR_EMPTY, "%s: no %s is finite%s", path, what,
                        r->file->field.components == 7 ? " and inside the mask" : "");
    return iso_fail(error, ISO_ERR_EMPTY, "%s: every %s is 0 or not finite", path, what);
}

/* ---- glyphs */

static void note_glyphs(reading *r) {
    const iso_vector_glyphs_totals *totals = &r->file->field.glyphs;
    if (r->file->field.components != 7) /* else these are the voxels outside the mask */
        note_count(&r->file->report, totals->missing, "%zu vectors are not finite: they have no glyphs");
    note_count(&r->file->report, totals->indefinite,
               "%zu tensors are not positive definite: they have no ellipsoids");
    if (r->opts->every || totals->every == 1) return;
    char text[ISO_READ_TEXT];
    snprintf(text, sizeof text, "one glyph for every %d voxels on each axis (--every)", totals->every);
    note(&r->file->report, text);
}

static iso_status make_glyphs(reading *r, const iso_vectors *vectors, const iso_read_opts *opts,
                              iso_pool *pool, iso_error *error) {
    const bool tensors = vectors->components == ISO_TENSOR_COMPONENTS;
    r->file->glyph = r->field->glyph ? *r->field->glyph : tensors ? ISO_GLYPH_ELLIPSOID : ISO_GLYPH_ARROW;
    const iso_vector_glyphs_opts glyph_opts = {.every = opts->every,
                                               .scale = r->field->scale,
                                               .least = r->field->least,
                                               .centred = r->file->glyph == ISO_GLYPH_CYLINDER,
                                               .max_memory = opts->max_memory,
                                               .pool = pool};
    ISO_TRY(iso_vector_glyphs(vectors, &glyph_opts, &r->file->glyphs, &r->file->field.glyphs, error));
    note_glyphs(r);
    const iso_vector_glyphs_totals *totals = &r->file->field.glyphs;
    r->file->report.items = totals->voxels;
    r->file->values = tensors ? "anisotropy" : "magnitude";
    if (r->file->glyphs.count) return ISO_OK;
    if (totals->small)
        return iso_fail(error, ISO_ERR_EMPTY, "%s: no glyphs: no %s is at least %g (--least)", r->path,
                        tensors ? "anisotropy" : "vector", r->field->least);
    return iso_fail(error, ISO_ERR_EMPTY, "%s: no glyphs: of %zu %s %zu are 0, %zu not finite%s", r->path,
                    totals->voxels, tensors ? "tensors" : "vectors", totals->zero, totals->missing,
                    totals->indefinite ? ", the others not positive definite" : "");
}

/* ---- lines */

static iso_status make_lines(reading *r, const iso_vectors *vectors, const iso_read_opts *opts,
                             iso_pool *pool, iso_error *error) {
    const int every = opts->every ? opts->every : 1;
    if (vectors->components != ISO_VECTOR_COMPONENTS)
        return iso_fail(error, ISO_ERR_EMPTY, "%s: holds tensors: streamlines follow vectors (3 components)",
                        r->path);
    const iso_streamlines_opts line_opts = {.count = (r->field->streamlines - 1) / every + 1,
                                            .seed = (uint64_t)r->field->seed,
                                            .length = r->field->length,
                                            .slowest = r->field->least,
                                            .axial = r->field->axial,
                                            .max_memory = opts->max_memory,
                                            .pool = pool};
    ISO_TRY(iso_streamlines(vectors, &line_opts, &r->file->lines, &r->file->field.lines, error));
    r->file->report.items = (uint64_t)r->field->streamlines;
    r->file->values = "speed";
    if (!r->file->lines.line_count)
        return iso_fail(error, ISO_ERR_EMPTY,
                        "%s: no streamlines at %" PRIu64
                        " places: vectors are shorter than %g there, or lead out of the volume",
                        r->path, r->file->field.lines.tried, r->file->field.lines.slowest);
    if (r->file->lines.line_count < (size_t)line_opts.count)
        note_count(&r->file->report, r->file->lines.line_count,
                   "%zu streamlines: no more places have vectors");
    return ISO_OK;
}

static iso_status make(reading *r, const iso_vectors *vectors, const iso_vectors_info *info,
                       const iso_read_opts *opts, iso_pool *pool, iso_error *error) {
    memcpy(r->file->field.dims, vectors->dims, sizeof r->file->field.dims);
    r->file->field.components = info->volume.components;
    ISO_TRY(iso_vectors_measure(vectors, pool, &r->file->field.vectors, error));
    fill_report(r, info);
    if (!r->file->field.vectors.usable) return fail_no_vectors(r, error);
    return (r->kind == ISO_OBJECT_LINES ? make_lines : make_glyphs)(r, vectors, opts, pool, error);
}

static iso_status read_field(reading *r, iso_pool *pool, iso_error *error) {
    const iso_read_opts *opts = r->opts;
    iso_vectors_opts vector_opts = {.array = r->field->array,
                                    .axes = r->field->axes,
                                    .max_memory = opts->max_memory,
                                    .files = opts->files,
                                    .pool = pool};
    memcpy(vector_opts.order, r->field->order, sizeof vector_opts.order);
    iso_vectors vectors = {0};
    iso_vectors_info info;
    ISO_TRY(iso_vectors_read(r->path, &vector_opts, &vectors, &info, error));
    const uint64_t taken =
        (uint64_t)iso_vectors_count(&vectors) * (uint64_t)vectors.components * sizeof(float);
    iso_read_opts left = *opts;
    if (left.max_memory > taken) left.max_memory -= taken;
    const iso_status status = make(r, &vectors, &info, &left, pool, error);
    iso_vectors_free(&vectors);
    return status;
}

/* ---- meshes, and their branches */

iso_status iso_object_read_mesh(const char *path, bool ras, iso_triangles *mesh, iso_error *error) {
    ISO_TRY(iso_mesh_read(path, NULL, mesh, error));
    for (size_t i = 0; i < mesh->vertex_count && ras; i++) {
        mesh->vertices[i][0] = -mesh->vertices[i][0];
        mesh->vertices[i][1] = -mesh->vertices[i][1];
    }
    return ISO_OK;
}

bool iso_object_file_is_mesh(const char *path) {
    return iso_mesh_find_faces(path) != ISO_MESH_NO_FACES;
}

static iso_status read_mesh(const reading *r, iso_error *error) {
    const bool ras = r->opts->space == ISO_SPACE_RAS;
    iso_file_set_read(r->opts->files, r->path);
    r->file->report.space = ras ? ISO_SPACE_RAS : ISO_SPACE_LPS;
    return iso_object_read_mesh(r->path, ras, &r->file->mesh, error);
}

/* Makes lines of the mesh, which is freed. */
static iso_status make_branches(const reading *r, iso_error *error) {
    iso_object_file *file = r->file;
    if (r->opts->every)
        return iso_fail(error, ISO_ERR_USAGE, "%s: --every is not for lines of a mesh", r->path);
    file->branches = iso_alloc_zero(1, sizeof *file->branches);
    if (!file->branches) return iso_fail_memory(error, r->path);
    const iso_status status = iso_mesh_lines_make(r->path, &file->mesh, file->branches, error);
    file->branches_triangles = file->mesh.triangle_count;
    iso_triangles_free(&file->mesh);
    if (status == ISO_ERR_EMPTY && error) {
        char text[sizeof error->text];
        snprintf(text, sizeof text, "%s", error->text);
        return iso_fail(error, status, "%s; --surface draws its triangles", text);
    }
    snprintf(file->report.format, sizeof file->report.format, "mesh");
    return status;
}

/* ---- files */

/* A file without lines may be a mesh of branches. */
static iso_status read_lines(const reading *r, iso_error *error) {
    const bool is_mesh = r->field && iso_file_type_find(r->path, ISO_HOLDS_LINES) == ISO_FILE_UNKNOWN &&
                         iso_object_file_is_mesh(r->path);
    if (!is_mesh) ISO_TRY(iso_lines_read(r->path, r->opts, &r->file->lines, error));
    if (r->file->lines.line_count) return ISO_OK;
    if (!r->field || !iso_object_file_is_mesh(r->path))
        return iso_fail(error, ISO_ERR_EMPTY, "%s: holds no lines", r->path);
    iso_lines_free(&r->file->lines);
    ISO_TRY(read_mesh(r, error));
    return make_branches(r, error);
}

iso_status iso_object_file_read(iso_object_file *file, const char *path, iso_object_kind kind,
                                const iso_read_opts *opts, const iso_vector_field_opts *field, iso_pool *pool,
                                iso_error *error) {
    iso_read_opts reporting = *opts;
    reading r = {file, path, kind, &reporting, field};
    reporting.report = &file->report;
    if (field && kind != ISO_OBJECT_MESH && is_field(path)) return read_field(&r, pool, error);
    if (field && field->axes > ISO_VECTOR_AXES_RAS)
        return iso_fail(error, ISO_ERR_USAGE, "%s: --space voxels and fsl are for volumes of vectors", path);
    if (kind == ISO_OBJECT_MESH) return read_mesh(&r, error);
    if (kind == ISO_OBJECT_LINES) return read_lines(&r, error);
    reporting.pool = pool;
    ISO_TRY(iso_glyphs_read(path, &reporting, &file->glyphs, error));
    return file->glyphs.count ? ISO_OK : iso_fail(error, ISO_ERR_EMPTY, "%s: holds no points", path);
}

iso_status iso_object_file_read_any(iso_object_file *file, const char *path, unsigned holds,
                                    const iso_read_opts *opts, iso_error *error) {
    iso_read_opts reporting = *opts;
    reporting.report = &file->report;
    if (holds & ISO_HOLDS_LINES) ISO_TRY(iso_lines_read(path, &reporting, &file->lines, error));
    if (file->lines.line_count || holds & ISO_HOLDS_MESH || !(holds & ISO_HOLDS_GLYPHS)) return ISO_OK;
    return iso_glyphs_read(path, &reporting, &file->glyphs, error);
}

void iso_object_file_free(iso_object_file *file) {
    iso_lines_free(&file->lines);
    iso_glyphs_free(&file->glyphs);
    iso_triangles_free(&file->mesh);
    if (file->branches) iso_mesh_lines_free(file->branches);
    iso_free(file->branches);
    *file = (iso_object_file){.values = NULL};
}

/* ---- gradients */

iso_status iso_object_gradients(iso_scene_surface *const *surfaces, int count,
                                const iso_gradient_glyphs_opts *opts, iso_glyphs *glyphs,
                                iso_gradient_glyphs_totals *totals, iso_error *error) {
    iso_scene_surface *made = iso_alloc_zero((size_t)count, sizeof *made);
    iso_gradient_source *sources = iso_alloc_zero((size_t)count, sizeof *sources);
    iso_status status = made && sources ? ISO_OK : iso_fail_memory(error, "the points of surfaces");
    for (int i = 0; i < count && status == ISO_OK; i++) {
        const iso_scene_surface *from = surfaces[i];
        made[i] = (iso_scene_surface){
            .grid = from->grid, .isovalue = from->isovalue, .primitive = from->primitive, .pool = from->pool};
        if (!from->points) status = iso_scene_surface_update(&made[i], ISO_PART_POINTS, error);
        if (status != ISO_OK) break;
        sources[i] = (iso_gradient_source){
            .grid = &from->grid, .points = iso_point_set_view(from->points ? from->points : made[i].points)};
    }
    if (status == ISO_OK) status = iso_gradient_glyphs(sources, count, opts, glyphs, totals, error);
    for (int i = 0; i < count && made; i++) iso_scene_surface_free(&made[i]);
    iso_free(made);
    iso_free(sources);
    return status;
}
