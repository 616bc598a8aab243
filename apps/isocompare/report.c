/* report: the command "isocompare report", which draws a volume by every method at three scales and compares
 * the pictures with those of the ray caster. */
#include "apps/isocompare/report.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "apps/common/template.h"
#include "base/clock.h"
#include "base/file.h"
#include "base/memory.h"
#include "base/text.h"

static const int ZOOMS[REPORT_ZOOMS] = {1, 4, 16};
static const int SAMPLES[REPORT_SAMPLINGS] = {1, 4}, TRUTH_SAMPLES[REPORT_SAMPLINGS] = {1, 16};

/* Logs that the next step begins. Beside the pictures of each method at each zoom there are: reading,
 * extracting, translucent surfaces, timing and grouping. */
static void log_step(report *r, const char *text) {
    const int steps = REPORT_ZOOMS * r->method_count + 5;
    r->step++;
    if (!r->settings->common.quiet)
        iso_program_log(isocompare_program(), "step %d of %d: %s", r->step, steps, text);
}

/* ---- the volume ---- */

static char *path_of(const char *folder, int file) {
    static const char *const names[2] = {"report.html", "report.json"};
    char *path = NULL;
    return asprintf(&path, "%s/%s", folder, names[file]) < 0 ? NULL : path;
}

static iso_status choose_isovalue(report *r, iso_error *error) {
    bool chosen;
    ISO_TRY(iso_loader_isovalue(&r->loader, r->settings->isovalue, &r->surface.isovalue, &chosen, error));
    r->isovalue_from = !isnan(r->settings->isovalue)                   ? "given"
                       : !chosen                                       ? "the scene's"
                       : iso_grid_is_level_set(&r->loader.volume.grid) ? "a level set's"
                                                                       : "Otsu's threshold (1979)";
    return ISO_OK;
}

/* Adds the outputs to r->files, so that iso_loader_open can check that they overwrite no file that is
 * read. */
static iso_status add_outputs(report *r, iso_error *error) {
    for (int i = 0; i < 2; i++) {
        char *path = path_of(r->settings->output, i);
        if (!path) return iso_fail(error, ISO_ERR_NOMEM, "out of memory");
        iso_file_set_write(&r->files, path);
        free(path);
    }
    return iso_file_set_check(&r->files, error);
}

static iso_status open_volume(report *r, iso_error *error) {
    ISO_TRY(iso_template_model(r->loader.input, &r->model, error));
    ISO_TRY(add_outputs(r, error));
    ISO_TRY(iso_loader_open(&r->loader, error));
    if (r->loader.has_points)
        return iso_fail(error, ISO_ERR_USAGE, "holds points: a report needs the volume they come from");
    log_step(r, "reading");
    ISO_TRY(iso_loader_read(&r->loader, error));
    const double *spacing = iso_grid_transform(&r->loader.volume.grid)->spacing;
    r->voxel = fmin(spacing[0], fmin(spacing[1], spacing[2]));
    r->surface.grid = r->loader.volume.grid;
    r->surface.pool = r->pool;
    r->surface.bounded = true; /* as isorender draws it */
    return choose_isovalue(r, error);
}

static void choose_methods(report *r) {
    size_t count;
    const iso_renderer *list = iso_renderer_list(&count);
    r->methods[r->method_count++] = iso_renderer_truth();
    for (size_t m = 0; m < count && r->method_count <= REPORT_METHODS; m++)
        r->methods[r->method_count++] = &list[m];
}

static iso_status extract(report *r, iso_error *error) {
    unsigned needs = 1u << ISO_PART_MESH; /* the views are chosen by the mesh's bounds */
    for (int m = 0; m < r->method_count; m++) needs |= r->methods[m]->needs;
    for (int part = 0; part < ISO_PART_COUNT; part++) {
        if (!(needs & 1u << part)) continue;
        double start = iso_clock_seconds();
        ISO_TRY(iso_scene_surface_prepare(&r->surface, (iso_part)part, error));
        r->parts[part] = (report_part){true, iso_clock_seconds() - start,
                                       iso_scene_surface_size(&r->surface, (iso_part)part)};
    }
    iso_mesh_view mesh = iso_mesh_set_view(r->surface.mesh);
    if (iso_mesh_view_triangle_count(&mesh) == 0)
        return iso_fail(error, ISO_ERR_EMPTY, "no surface at isovalue %g", r->surface.isovalue);
    return iso_study_bound(&mesh, &r->ball, error);
}

/* ---- pictures ---- */

/* The pictures of one view, and working memory. */
typedef struct view_buffers {
    iso_study_frame truth[REPORT_SAMPLINGS], candidate[REPORT_SAMPLINGS];
    float *map; /* FLIP differences */
    iso_image difference;
} view_buffers;

static void free_buffers(view_buffers *b) {
    for (int s = 0; s < REPORT_SAMPLINGS; s++) {
        iso_study_frame_free(&b->truth[s]);
        iso_study_frame_free(&b->candidate[s]);
    }
    iso_free(b->map);
    iso_image_free(&b->difference);
}

static iso_status create_buffers(int side, view_buffers *b, iso_error *error) {
    b->map = iso_alloc((size_t)side * (size_t)side * sizeof *b->map);
    if (!b->map) return iso_fail(error, ISO_ERR_NOMEM, "out of memory");
    for (int s = 0; s < REPORT_SAMPLINGS; s++) {
        ISO_TRY(iso_study_frame_create(side, s == REPORT_SINGLE, &b->truth[s], error));
        ISO_TRY(iso_study_frame_create(side, s == REPORT_SINGLE, &b->candidate[s], error));
    }
    return iso_image_create(side, side, &b->difference, error);
}

static iso_study_look look_of(const report *r, int samples) {
    iso_rgb color = {0xD9, 0xB3, 0x6C};
    return (iso_study_look){color, r->settings->background, samples, 1};
}

/* Records the process's peak memory in r->peak, before it is reset. */
static void note_peak(report *r) {
    uint64_t peak = iso_memory_peak();
    if (peak > r->peak) r->peak = peak;
}

static iso_status encode_picture(const report *r, const iso_image *image, report_picture *picture,
                                 iso_error *error) {
    iso_png_opts opts = {.small = true, .pool = r->pool};
    return iso_png_encode(image, &opts, &picture->bytes, &picture->size, error);
}

/* Draws the same picture three times, or fewer times if it takes long. Records the median time, and the
 * memory of the first time. */
static iso_status draw_timed(report *r, const report_view *v, int method, iso_study_frame *frame,
                             report_cell *cell, iso_error *error) {
    enum { FRAMES = 3 };
    const double time_limit = 0.5; /* seconds */
    iso_study_look look = look_of(r, SAMPLES[REPORT_SINGLE]);
    double seconds[FRAMES], spent = 0;
    int frames = 0;
    note_peak(r);
    bool known = isocompare_reset_peak();
    uint64_t before = isocompare_resident(false);
    while (frames == 0 || (frames < FRAMES && spent < time_limit)) {
        double start = iso_clock_seconds();
        ISO_TRY(iso_study_draw(&r->surface, r->methods[method], &v->view, &look, frame, error));
        seconds[frames] = iso_clock_seconds() - start;
        spent += seconds[frames];
        uint64_t peak = isocompare_resident(true);
        if (frames++ == 0 && known && peak > before) cell->memory = peak - before;
    }
    cell->seconds = frames < FRAMES
                        ? fmin(seconds[0], seconds[frames - 1])
                        : fmax(fmin(seconds[0], seconds[1]), fmin(fmax(seconds[0], seconds[1]), seconds[2]));
    return encode_picture(r, &frame->image, &cell->picture, error);
}

/* Maps a difference 0 .. 1 to a colour of increasing brightness: black, violet, orange, pale yellow. */
static void heat_color(float value, uint8_t rgba[4]) {
    enum { STEPS = 5 };
    static const float ramp[STEPS + 1][3] = {{0, 0, 0},     {66, 16, 110},  {156, 40, 106},
                                             {226, 92, 50}, {250, 176, 26}, {254, 253, 190}};
    float at = (float)(int)(value * 255 + 0.5f) / 255 * STEPS; /* 256 colours: the PNG can have a palette */
    int step = at < STEPS ? (int)at : STEPS - 1;
    for (int c = 0; c < 3; c++) {
        float mixed = ramp[step][c] + (at - (float)step) * (ramp[step + 1][c] - ramp[step][c]);
        rgba[c] = (uint8_t)(mixed + 0.5f);
    }
    rgba[3] = 255;
}

static iso_status encode_difference(const report *r, view_buffers *b, report_picture *picture,
                                    iso_error *error) {
    size_t count = (size_t)b->difference.width * (size_t)b->difference.height;
    for (size_t i = 0; i < count; i++) heat_color(b->map[i], b->difference.rgba + 4 * i);
    return encode_picture(r, &b->difference, picture, error);
}

static iso_status compare_frames(const report *r, const report_view *v, view_buffers *b,
                                 report_sampling sampling, iso_metrics *metrics, iso_error *error) {
    iso_compare_picture truth = iso_study_picture(&b->truth[sampling]);
    iso_compare_picture candidate = iso_study_picture(&b->candidate[sampling]);
    iso_compare_opts opts = {.background = r->settings->background,
                             .voxel = r->voxel,
                             .pixels_per_voxel = v->pixels_per_voxel,
                             .pixels_per_degree = r->settings->pixels_per_degree,
                             .flip_map = sampling == REPORT_SINGLE ? b->map : NULL,
                             .pool = r->pool};
    return iso_compare(&truth, &candidate, &opts, metrics, error);
}

/* Counts the points that the truth's surface leaves to be seen. */
static iso_status count_visible_points(const report *r, report_view *v, const view_buffers *b,
                                       iso_error *error) {
    const iso_point_view points = iso_scene_surface_points(&r->surface);
    const size_t pixels = (size_t)v->view.width * (size_t)v->view.height;
    uint32_t *number = iso_alloc(pixels * sizeof *number);
    float *nearest = iso_alloc(pixels * sizeof *nearest);
    iso_status status = ISO_OK;
    if (number && nearest)
        v->visible = iso_find_visible_points(&points, &v->view, b->truth[REPORT_SINGLE].aov.depth,
                                             points.radius, number, nearest);
    else
        status = iso_fail(error, ISO_ERR_NOMEM, "out of memory");
    iso_free(number);
    iso_free(nearest);
    return status;
}

static iso_status judge_method(report *r, report_view *v, int method, view_buffers *b, iso_error *error) {
    report_cell *cell = &v->cells[method];
    iso_study_frame *frames = method ? b->candidate : b->truth;
    ISO_TRY(draw_timed(r, v, method, &frames[REPORT_SINGLE], cell, error));
    iso_study_look fine = look_of(r, method ? SAMPLES[REPORT_FINE] : TRUTH_SAMPLES[REPORT_FINE]);
    ISO_TRY(iso_study_draw(&r->surface, r->methods[method], &v->view, &fine, &frames[REPORT_FINE], error));
    if (method == 0) return ISO_OK;
    for (int s = 0; s < REPORT_SAMPLINGS; s++)
        ISO_TRY(compare_frames(r, v, b, (report_sampling)s, &cell->metrics[s], error));
    return encode_difference(r, b, &cell->difference, error);
}

/* Finds the pixel of the fitted view that the other zooms magnify, one near a silhouette, and its depth. */
static iso_status find_target(report *r, const iso_study_frame *fit, int target[2], double *depth,
                              iso_error *error) {
    size_t side = (size_t)r->settings->side, count = side * side;
    uint8_t *mask = iso_alloc(count);
    if (!mask) return iso_fail(error, ISO_ERR_NOMEM, "out of memory");
    iso_silhouette_from_coverage(fit->aov.coverage, count, mask);
    iso_status status = iso_study_aim(mask, (int)side, target, error);
    size_t middle = (size_t)target[1] * side + (size_t)target[0];
    if (status == ISO_OK && mask[middle]) *depth = (double)fit->aov.depth[middle];
    iso_free(mask);
    return status;
}

static iso_status draw_each_view(report *r, view_buffers *b, iso_error *error) {
    iso_view fit = iso_study_fit(&r->ball, r->settings->side, 0);
    double depth = iso_view_point(&fit, r->ball.center).z;
    int target[2] = {0, 0};
    for (int z = 0; z < REPORT_ZOOMS; z++) {
        report_view *v = &r->views[z];
        v->zoom = ZOOMS[z];
        v->view = z ? iso_study_zoom(&fit, target, ZOOMS[z]) : fit;
        v->pixels_per_voxel = v->view.focal * r->voxel / depth;
        for (int m = 0; m < r->method_count; m++) {
            char text[96];
            snprintf(text, sizeof text, "drawing %s, zoom %d", r->methods[m]->name, v->zoom);
            log_step(r, text);
            ISO_TRY(judge_method(r, v, m, b, error));
        }
        ISO_TRY(count_visible_points(r, v, b, error));
        if (z == 0) ISO_TRY(find_target(r, &b->truth[REPORT_SINGLE], target, &depth, error));
    }
    return ISO_OK;
}

static iso_status draw_views(report *r, iso_error *error) {
    view_buffers b = {0};
    iso_status status = create_buffers(r->settings->side, &b, error);
    if (status == ISO_OK) status = draw_each_view(r, &b, error);
    free_buffers(&b);
    return status;
}

/* Draws the fitted view translucent. The size is limited because 21 pictures are drawn, and because only the
 * order of layers is compared, not their detail. */
static iso_status study_transparency(report *r, iso_error *error) {
    enum { LARGEST_SIDE = 512 };
    const int side = r->settings->side;
    r->transparency_side = side < LARGEST_SIDE ? side : LARGEST_SIDE;
    const iso_view fit = iso_study_fit(&r->ball, r->transparency_side, 0);
    const iso_study_look look = look_of(r, SAMPLES[REPORT_SINGLE]);
    log_step(r, "drawing translucent surfaces");
    return iso_study_transparency(&r->surface, &r->ball, &fit, &look, &r->transparency, error);
}

/* Divides the points into groups and draws them as splats, in the fitted view. */
static iso_status study_splats(report *r, iso_error *error) {
    const iso_view fit = iso_study_fit(&r->ball, r->cost.side, 0);
    const iso_study_look look = look_of(r, SAMPLES[REPORT_SINGLE]);
    log_step(r, "grouping splats");
    return iso_study_splats(&r->surface, &fit, &look, &r->splats, error);
}

/* Times extraction and frames. A report of small pictures is a quick one: runs are as long as pictures are
 * wide. */
static iso_status study_cost(report *r, iso_error *error) {
    const iso_cost_opts opts = {.seconds = r->settings->side * 0.2 / 1024};
    const iso_study_look look = look_of(r, SAMPLES[REPORT_SINGLE]);
    log_step(r, "timing extraction and frames");
    ISO_TRY(iso_study_cost(&r->surface, &r->ball, &look, &opts, &r->cost, error));
    if (!r->loader.has_strokes) return ISO_OK;
    const iso_source how = {.input = r->loader.options, .pool = r->pool};
    return iso_study_strokes(r->loader.path, &how, &r->ball, r->cost.side, &look, &r->strokes, error);
}

/* ---- files ---- */

/* Creates the folder if it does not exist; *made: it was created. */
static iso_status open_folder(const char *path, bool *made, iso_error *error) {
    struct stat info;
    *made = mkdir(path, 0777) == 0;
    if (*made) return ISO_OK;
    if (errno == EEXIST && stat(path, &info) == 0 && S_ISDIR(info.st_mode)) return ISO_OK;
    return iso_fail(error, ISO_ERR_WRITE, "%s: cannot make this folder: %s", path,
                    strerror(errno == EEXIST ? ENOTDIR : errno));
}

static iso_status open_sinks(const char *folder, iso_sink sinks[2], iso_error *error) {
    for (int i = 0; i < 2; i++) {
        char *path = path_of(folder, i);
        if (!path) return iso_fail(error, ISO_ERR_NOMEM, "out of memory");
        iso_status status = iso_sink_open(path, &sinks[i], error);
        free(path);
        ISO_TRY(status);
    }
    return ISO_OK;
}

/* Writes both files, or neither. */
static iso_status write_files(const report *r, iso_sink sinks[2], iso_error *error) {
    isocompare_write_html(r, sinks[0].stream);
    ISO_TRY(isocompare_write_json(r, sinks[1].stream, error));
    ISO_TRY(iso_sink_commit(&sinks[0], error));
    iso_status status = iso_sink_commit(&sinks[1], error);
    char *path = status == ISO_OK ? NULL : path_of(r->settings->output, 0);
    iso_file_remove(path);
    free(path);
    return status;
}

/* ---- the command ---- */

static iso_status make_report(report *r, iso_sink sinks[2], iso_error *error) {
    choose_methods(r);
    ISO_TRY(open_volume(r, error));
    ISO_TRY(open_sinks(r->settings->output, sinks, error));
    log_step(r, "extracting");
    ISO_TRY(extract(r, error));
    isocompare_processor(r->processor, sizeof r->processor);
    ISO_TRY(draw_views(r, error));
    ISO_TRY(study_transparency(r, error));
    ISO_TRY(study_cost(r, error));
    ISO_TRY(study_splats(r, error));
    note_peak(r);
    r->page = isocompare_make_page(r);
    return write_files(r, sinks, error);
}

static void free_report(report *r) {
    for (int z = 0; z < REPORT_ZOOMS; z++)
        for (int m = 0; m < r->method_count; m++) {
            free(r->views[z].cells[m].picture.bytes);
            free(r->views[z].cells[m].difference.bytes);
        }
    free(r->model);
    free(r->page);
    iso_scene_surface_free(&r->surface);
    iso_loader_close(&r->loader);
    iso_file_set_free(&r->files);
    free(r);
}

/* Puts the volume's name in front of a message, unless the message names a file. */
static void name_volume(const report *r, iso_error *error) {
    const char *name = iso_spool_name(r->loader.input);
    if (error->status == ISO_ERR_WRITE || iso_text_begins(error->text, name)) return;
    iso_fail(error, error->status, "%s: %s", name, error->text);
}

static iso_status write_report(const isocompare_settings *settings, iso_pool *pool, iso_error *error) {
    bool made = false;
    ISO_TRY(open_folder(settings->output, &made, error));
    report *r = calloc(1, sizeof *r);
    if (!r) return iso_fail(error, ISO_ERR_NOMEM, "out of memory");
    r->settings = settings;
    r->pool = pool;
    r->loader = (iso_loader){.input = settings->volume,
                             .options = &settings->common.input,
                             .files = &r->files,
                             .pool = pool,
                             .wants_histogram = isnan(settings->isovalue)};
    iso_sink sinks[2] = {{0}};
    iso_status status = make_report(r, sinks, error);
    for (int i = 0; i < 2; i++) iso_sink_abort(&sinks[i]);
    if (status != ISO_OK) name_volume(r, error);
    if (status != ISO_OK && made) rmdir(settings->output);
    if (status == ISO_OK && !settings->common.quiet)
        iso_program_log(isocompare_program(), "wrote %s/report.html and report.json", settings->output);
    free_report(r);
    return status;
}

/* The folder of the report without --output: NAME-report, for the volume NAME. */
static iso_status name_folder(const isocompare_settings *settings, char **folder, iso_error *error) {
    char *model = NULL;
    ISO_TRY(iso_template_model(settings->volume, &model, error));
    const bool named = asprintf(folder, "%s-report", model) >= 0;
    free(model);
    return named ? ISO_OK : iso_fail_memory(error, settings->volume);
}

iso_status isocompare_report(const isocompare_settings *given, iso_pool *pool, iso_error *error) {
    char *folder = NULL;
    isocompare_settings with_folder = *given;
    if (given->output) return write_report(given, pool, error);
    ISO_TRY(name_folder(given, &folder, error));
    with_folder.output = folder;
    const iso_status status = write_report(&with_folder, pool, error);
    free(folder);
    return status;
}
