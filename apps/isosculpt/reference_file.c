/* reference_file: finds out what the files contain, reads them, and notes which of them lie beside the
 * sculpture. */
#include "apps/isosculpt/reference_file.h"

#include <inttypes.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>

#include "base/text.h"
#include "io/file_contents.h"
#include "scene/beside.h"
#include "source/source.h"

/* ---- what a file can hold, in the order in which it is tried */

enum { LINES = ISO_HOLDS_LINES, SURFACE = ISO_HOLDS_MESH, GLYPHS = ISO_HOLDS_GLYPHS };

static unsigned contents_of(const char *path) {
    const unsigned holds = iso_file_contents(path) & (LINES | SURFACE | GLYPHS | ISO_HOLDS_VOLUME);
    return !holds || holds & ISO_HOLDS_VOLUME ? SURFACE : holds;
}

/* ---- notes */

#if defined(__GNUC__)
__attribute__((format(printf, 2, 3)))
#endif
static void
note(isosculpt_reference_files *files, const char *format, ...) {
    va_list arguments;
    if (files->note_count == ISOSCULPT_REFERENCE_NOTES) return;
    va_start(arguments, format);
    iso_text_format(files->notes[files->note_count++], ISOSCULPT_REFERENCE_NOTE, format, arguments);
    va_end(arguments);
}

static void note_report(isosculpt_reference_files *files, const char *path, const iso_read_report *report) {
    for (int i = 0; i < report->note_count; i++) note(files, "%s: %s", path, report->notes[i]);
    if (report->dropped)
        note(files, "%s: %" PRIu64 " positions are not finite and are left out", path, report->dropped);
    if (report->mended_radii)
        note(files, "%s: %" PRIu64 " radii are negative or not finite and became 0", path,
             report->mended_radii);
}

static void note_place(isosculpt_reference_files *files, const char *path, const iso_box *box,
                       iso_space space) {
    char text[ISO_BESIDE_TEXT];
    if (iso_beside_note(path, box, &files->box, space, text)) note(files, "%s", text);
}

/* ---- lines and glyphs */

static iso_status prepare(isosculpt_reference_shapes *set, iso_error *error) {
    const iso_lines *lines = &set->file.lines;
    const iso_glyphs *glyphs = &set->file.glyphs;
    const iso_shapes_opts opts = {.radius = NAN,
                                  .min_pixels = lines->line_count ? 1 : 0,
                                  .glyph = glyphs->axes ? ISO_GLYPH_ELLIPSOID : ISO_GLYPH_SPHERE};
    return lines->line_count ? iso_shapes_from_lines(lines, &opts, &set->shapes, error)
           : glyphs->count   ? iso_shapes_from_glyphs(glyphs, &opts, &set->shapes, error)
                             : ISO_OK;
}

/* Reads lines or glyphs; set->shapes stays NULL when the file holds a surface. */
static iso_status read_set(isosculpt_reference_files *files, const char *path,
                           isosculpt_reference_shapes *set, iso_error *error) {
    const unsigned contents = contents_of(path);
    const iso_read_report *report = &set->file.report;
    const iso_read_opts opts = {.max_memory = files->settings->common.input.max_memory,
                                .space = (iso_space)files->settings->space};
    ISO_TRY(iso_progress_tell(files->progress, path, 0, error));
    if (contents == SURFACE) return ISO_OK;
    ISO_TRY(iso_object_file_read_any(&set->file, path, contents, &opts, error));
    ISO_TRY(prepare(set, error));
    if (!set->shapes)
        return contents & SURFACE ? ISO_OK : iso_fail(error, ISO_ERR_EMPTY, "%s: holds nothing", path);
    if (!iso_shapes_stats(set->shapes).shapes)
        return iso_fail(error, ISO_ERR_EMPTY, "%s: holds nothing that can be drawn", path);
    const iso_box box = iso_shapes_bounds(set->shapes);
    note_report(files, path, report);
    note_place(files, path, &box, report->space);
    return ISO_OK;
}

/* ---- surfaces */

static iso_status read_surface(isosculpt_reference_files *files, const char *path,
                               isosculpt_reference **reference, iso_error *error) {
    const isosculpt_settings *settings = files->settings;
    const iso_input input = {.max_memory = settings->common.input.max_memory};
    iso_journal_start start;
    iso_hgrid *grid;
    iso_pool *pool;
    ISO_TRY(iso_pool_create(settings->common.threads, &pool, error));
    const iso_source source = {.path = path,
                               .isovalue = NAN,
                               .voxel = files->voxel,
                               .close_holes = settings->close_holes,
                               .input = &input,
                               .pool = pool,
                               .progress = files->progress};
    const iso_status status = iso_source_open(&source, &start, &grid, error);
    iso_pool_destroy(pool);
    ISO_TRY(status);
    return isosculpt_reference_create(grid, settings->common.threads, reference, error);
}

/* Reads all files; *surface: the one that holds a surface, if there is one. */
static iso_status read_sets(isosculpt_reference_files *files, isosculpt_reference_shapes *sets,
                            const char **surface, iso_error *error) {
    const iso_texts *paths = &files->settings->references;
    *surface = NULL;
    for (int i = 0; i < paths->count; i++) {
        const char *path = paths->values[i];
        ISO_TRY(read_set(files, path, &sets[i], error));
        if (!sets[i].shapes) *surface = path;
    }
    if (*surface && paths->count > 1)
        return iso_fail(error, ISO_ERR_USAGE,
                        "%s: a surface is the only reference: several can be lines and glyphs", *surface);
    return ISO_OK;
}

iso_status isosculpt_reference_read(isosculpt_reference_files *files, isosculpt_reference **reference,
                                    iso_error *error) {
    const int count = files->settings->references.count;
    isosculpt_reference_shapes sets[ISOSCULPT_REFERENCE_SHAPES] = {{.shapes = NULL}};
    const char *surface;
    const iso_status status = read_sets(files, sets, &surface, error);
    if (status == ISO_OK && !surface) return isosculpt_reference_create_shapes(sets, count, reference, error);
    for (int i = 0; i < count; i++) isosculpt_reference_shapes_free(&sets[i]);
    return status == ISO_OK ? read_surface(files, surface, reference, error) : status;
}
