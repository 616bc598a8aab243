/* bench quality: how near every method comes to the ray caster, on real volumes and scenes, at fit, 4 and 16
 * times, 1024 x 1024 pixels, one sample a pixel. Views and measures are those of compare/study.h and
 * compare/metrics.h. Volumes are seen in their own axes, in millimetres, wherever their files put them. PSNR
 * is of unrounded colours under one light at the eye (iso_study_shade), everything else of the pictures that
 * isorender makes: rounding to bytes alone costs 6 dB at 58 dB. So the figures compare with those of earlier
 * studies. */
#include "bench_quality.h"
#include "base/clock.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "apps/common/json.h"
#include "apps/common/options.h"
#include "base/file.h"
#include "base/memory.h"
#include "compare/metrics.h"
#include "grids/scenes/scenes.h"
#include "grids/volume/volume.h"
#include "scene/method.h"
#include "study_support.h"

enum { ENTRIES = 64, ROWS = 1024, NAME = QUALITY_NAME, ZOOMS = 3, METHODS = 16 };

typedef quality_row row;
static const int zooms[ZOOMS] = {1, 4, 16};

/* The colours of the study whose figures stand in the issues. */
static const iso_study_look look = {.color = {191, 140, 102}, .background = {31, 33, 41}};

/* A volume or scene. */
typedef struct entry {
    char name[NAME], path[512]; /* path empty: a scene */
    double isovalue;
    bool raw;
    int dims[3];
} entry;

typedef struct settings {
    const char *json, *volumes, *folder, *pictures, *only;
    int threads, side, frames, help;
} settings;

typedef struct state {
    const settings *settings;
    iso_pool *pool;
    const iso_renderer *methods[METHODS]; /* those that are judged */
    int method_count;
    entry entries[ENTRIES];
    int entry_count;
    row rows[ROWS];
    int row_count;
    iso_sink json; /* open from the start: minutes of work shall not fail at the end */
} state;

/* Whether `name` is one of the words of a list separated by commas; NULL lists everything. */
static bool is_listed(const char *list, const char *name) {
    size_t length = strlen(name);
    for (const char *word = list; word;) {
        size_t end = strcspn(word, ",");
        if (end == length && strncmp(word, name, length) == 0) return true;
        word = word[end] ? word + end + 1 : NULL;
    }
    return list == NULL;
}

/* Lists the methods that isocompare compares, and splats, if they are asked for. */
static void list_methods(state *s) {
    static const iso_method splats[] = {ISO_METHOD_SPLATS_FLAT, ISO_METHOD_SPLATS_ONEPASS,
                                        ISO_METHOD_SPLATS_EWA};
    const size_t splat_count = sizeof splats / sizeof *splats;
    size_t count;
    const iso_renderer *methods = iso_renderer_list(&count);
    for (size_t i = 0; i < count + splat_count && s->method_count < METHODS; i++) {
        const iso_renderer *method = i < count ? &methods[i] : iso_renderer_get(splats[i - count]);
        if (is_listed(s->settings->only, method->name)) s->methods[s->method_count++] = method;
    }
}

/* ---- what is looked at ---- */

/* Names that volumes have in tables: short ones. */
static const char *short_name(const char *name) {
    static const char *const names[][2] = {
        {"stroke FLAIR", "FLAIR"},           {"ch2better brain", "ch2better"},
        {"OpenVDB sphere", "sphere.vdb"},    {"brainsmall MRI", "brainsmall"},
        {"headsq CT (quarter)", "headsq"},   {"USD smoke", "smoke"},
        {"USD two fields", "densityAndHeat"}};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        if (strcmp(names[i][0], name) == 0) return names[i][1];
    return name;
}

static entry *add_entry(state *s, const char *name) {
    for (int i = 0; i < s->entry_count; i++) /* one file of several with the same voxels is enough */
        if (strcmp(s->entries[i].name, name) == 0) return NULL;
    if (s->entry_count == ENTRIES || !is_listed(s->settings->volumes, name)) return NULL;
    entry *e = &s->entries[s->entry_count++];
    snprintf(e->name, sizeof e->name, "%s", name);
    return e;
}

/* One line of INDEX.tsv: name, path, format, dims, voxel type, spacing, least, most, isovalue, ... */
static void add_line(state *s, char *line) {
    enum { FIELDS = 9 };
    char *fields[FIELDS];
    for (int i = 0; i < FIELDS; i++) {
        fields[i] = line;
        line = strchr(line, '\t');
        if (!line) return;
        *line++ = 0;
    }
    double isovalue;
    if (!iso_parse_real(fields[8], &isovalue)) return;
    entry *e = add_entry(s, short_name(fields[0]));
    if (!e) return;
    snprintf(e->path, sizeof e->path, "%s/%s", s->settings->folder, fields[1]);
    e->isovalue = isovalue;
    e->raw = strncmp(fields[2], "raw", 3) == 0 || strncmp(fields[2], "VolPack", 7) == 0;
    if (sscanf(fields[3], "%dx%dx%d", &e->dims[0], &e->dims[1], &e->dims[2]) != 3) e->raw = false;
}

static void list_volumes(state *s) {
    char path[512], line[4096];
    snprintf(path, sizeof path, "%s/INDEX.tsv", s->settings->folder);
    FILE *file = fopen(path, "r");
    if (!file) {
        fprintf(stderr, "bench: no real volumes: cannot read %s\n", path);
        return;
    }
    while (fgets(line, sizeof line, file)) add_line(s, line);
    fclose(file);
}

static void list_scenes(state *s) {
    static const char *const scenes[] = {"sphere", "cylinder", "cube", "gyroid"};
    for (int i = 0; i < 4; i++) add_entry(s, scenes[i]);
}

/* Raw files hold bytes behind a header that is as long as the rest of the file. */
static iso_status read_file(const entry *e, iso_pool *pool, iso_grid *grid, iso_error *error) {
    iso_raw_layout raw = {.dims = {e->dims[0], e->dims[1], e->dims[2]}, .type = ISO_UINT8};
    struct stat info;
    size_t voxels = (size_t)e->dims[0] * (size_t)e->dims[1] * (size_t)e->dims[2];
    if (e->raw && stat(e->path, &info) == 0 && (size_t)info.st_size >= voxels)
        raw.offset = (size_t)info.st_size - voxels;
    iso_volume_opts opts = {.pool = pool, .raw = e->raw ? &raw : NULL};
    iso_volume volume;
    ISO_TRY(iso_volume_read(e->path, &opts, &volume, error));
    *grid = volume.grid;
    return ISO_OK;
}

static iso_status open_entry(const entry *e, iso_pool *pool, iso_grid *grid, double *isovalue,
                             iso_error *error) {
    iso_scene_opts opts = {.pool = pool};
    *isovalue = e->isovalue;
    if (!e->path[0]) return iso_scene_create(e->name, &opts, grid, isovalue, error);
    ISO_TRY(read_file(e, pool, grid, error));
    iso_transform *transform = grid->rgrid ? &grid->rgrid->transform : &grid->hgrid->transform;
    *transform = iso_transform_local(transform);
    return ISO_OK;
}

/* ---- one volume ---- */

/* What is kept while a volume is looked at. */
typedef struct session {
    state *state;
    const char *name;
    iso_grid grid;
    iso_scene_surface surface;
    iso_study_ball ball;
    double voxel; /* mm */
    iso_study_frame truth, candidate;
    float *colors[2]; /* unrounded, of both */
} session;

static iso_status prepare(session *s, iso_error *error) {
    size_t side = (size_t)s->state->settings->side;
    ISO_TRY(iso_study_frame_create((int)side, true, &s->truth, error));
    ISO_TRY(iso_study_frame_create((int)side, true, &s->candidate, error));
    for (int i = 0; i < 2; i++)
        if (!(s->colors[i] = iso_alloc(side * side * 3 * sizeof(float))))
            return iso_fail(error, ISO_ERR_NOMEM, "out of memory");
    unsigned needs = iso_renderer_truth()->needs | 1u << ISO_PART_MESH; /* the mesh bounds the view */
    for (int m = 0; m < s->state->method_count; m++) needs |= s->state->methods[m]->needs;
    for (int part = 0; part < ISO_PART_COUNT; part++)
        if (needs & 1u << part) ISO_TRY(iso_scene_surface_prepare(&s->surface, (iso_part)part, error));
    iso_mesh_view mesh = iso_mesh_set_view(s->surface.mesh);
    const double *spacing = iso_grid_transform(&s->grid)->spacing;
    s->voxel = fmin(spacing[0], fmin(spacing[1], spacing[2]));
    return iso_study_bound(&mesh, &s->ball, error);
}

static iso_status keep_picture(const session *s, const iso_study_frame *frame, int zoom, const char *method,
                               iso_error *error) {
    char path[512];
    if (!s->state->settings->pictures) return ISO_OK;
    snprintf(path, sizeof path, "%s/%s_%d_%s.png", s->state->settings->pictures, s->name, zoom, method);
    return iso_png_write(path, &frame->image, NULL, 0, error);
}

static iso_status judge(session *s, const iso_view *view, const iso_renderer *method, row *r,
                        iso_error *error) {
    double start = iso_clock_seconds();
    ISO_TRY(iso_study_draw(&s->surface, method, view, &look, &s->candidate, error));
    r->seconds = iso_clock_seconds() - start;
    ISO_TRY(keep_picture(s, &s->candidate, r->zoom, method->name, error));
    iso_study_shade(&s->candidate, view, &look, s->colors[1]);
    iso_compare_picture truth = iso_study_picture(&s->truth), candidate = iso_study_picture(&s->candidate);
    truth.color = s->colors[0];
    candidate.color = s->colors[1];
    iso_compare_opts opts = {.background = look.background,
                             .voxel = s->voxel,
                             .pixels_per_voxel = r->pixels_per_voxel,
                             .pool = s->state->pool};
    return iso_compare(&truth, &candidate, &opts, &r->metrics, error);
}

static void print_head(void) {
    printf("%-14s %4s %-17s %7s %7s %6s %6s %6s %7s %7s %6s %6s %7s %6s %7s %7s\n", "volume", "zoom",
           "method", "psnr_in", "psnr", "ssim", "flip", "iou", "dil px", "max px", "holes%", "normal",
           "depth", "wrong%", "differ", "s");
}

static void print_row(const row *r) {
    const iso_metrics *m = &r->metrics;
    printf("%-14s %4d %-17s %7.2f %7.2f %6.4f %6.4f %6.4f %7.3f %7.1f %6.2f %6.2f %7.4f %6.2f %7.0f %7.3f\n",
           r->volume, r->zoom, r->method->name, m->psnr_in, m->psnr, m->ssim, m->flip, m->iou,
           m->dilation_mean, m->dilation_max, m->holes, m->normal_error_deg, m->depth_error_voxel, m->wrong,
           m->pixels_differing, r->seconds);
    fflush(stdout);
}

static iso_status judge_all(session *s, const iso_view *view, int zoom, double pixels_per_voxel,
                            iso_error *error) {
    state *st = s->state;
    ISO_TRY(iso_study_draw(&s->surface, iso_renderer_truth(), view, &look, &s->truth, error));
    iso_study_shade(&s->truth, view, &look, s->colors[0]);
    ISO_TRY(keep_picture(s, &s->truth, zoom, iso_renderer_truth()->name, error));
    for (int m = 0; m < st->method_count && st->row_count < ROWS; m++) {
        row *r = &st->rows[st->row_count];
        *r = (row){.zoom = zoom, .method = st->methods[m], .pixels_per_voxel = pixels_per_voxel};
        snprintf(r->volume, sizeof r->volume, "%s", s->name);
        ISO_TRY(judge(s, view, st->methods[m], r, error));
        st->row_count++;
        print_row(r);
    }
    return ISO_OK;
}

/* Where the view is narrowed to, and how far away that is. */
static iso_status take_aim(session *s, const iso_view *fit, int aim[2], double *depth, iso_error *error) {
    int side = fit->width;
    size_t count = (size_t)side * (size_t)side;
    uint8_t *mask = malloc(count);
    if (!mask) return iso_fail(error, ISO_ERR_NOMEM, "out of memory");
    iso_silhouette_from_coverage(s->truth.aov.coverage, count, mask);
    iso_status status = iso_study_aim(mask, side, aim, error);
    size_t middle = (size_t)aim[1] * (size_t)side + (size_t)aim[0];
    if (status == ISO_OK && mask[middle]) *depth = (double)s->truth.aov.depth[middle];
    free(mask);
    return status;
}

static iso_status look_at(session *s, iso_error *error) {
    iso_view fit = iso_study_fit(&s->ball, s->state->settings->side, 0);
    double distance = iso_view_point(&fit, s->ball.center).z, depth = distance;
    int aim[2];
    ISO_TRY(judge_all(s, &fit, zooms[0], fit.focal * s->voxel / distance, error));
    ISO_TRY(take_aim(s, &fit, aim, &depth, error));
    for (int z = 1; z < ZOOMS; z++) {
        iso_view view = iso_study_zoom(&fit, aim, zooms[z]);
        ISO_TRY(judge_all(s, &view, zooms[z], view.focal * s->voxel / depth, error));
    }
    return ISO_OK;
}

/* ---- a turntable ---- */

/* Mean change from frame to frame, half a degree apart. */
static iso_status turn(session *s, const iso_renderer *method, double *change, iso_error *error) {
    const settings *set = s->state->settings;
    iso_study_frame frames[2] = {0};
    double sum = 0;
    iso_status status = iso_study_frame_create(set->side, true, &frames[0], error);
    if (status == ISO_OK) status = iso_study_frame_create(set->side, true, &frames[1], error);
    for (int i = 0; i < set->frames && status == ISO_OK; i++) {
        iso_view view = iso_study_fit(&s->ball, set->side, 0.5 * i);
        status = iso_study_draw(&s->surface, method, &view, &look, &frames[i & 1], error);
        if (i > 0 && status == ISO_OK) sum += iso_study_change(&frames[0], &frames[1]);
    }
    iso_study_frame_free(&frames[0]);
    iso_study_frame_free(&frames[1]);
    *change = sum / (set->frames - 1);
    return status;
}

static iso_status turn_all(session *s, iso_error *error) {
    const state *st = s->state;
    double truth, change;
    if (s->state->settings->frames < 2) return ISO_OK;
    ISO_TRY(turn(s, iso_renderer_truth(), &truth, error));
    printf("\n%s, %d frames half a degree apart: mean change between frames, of 255\n", s->name,
           s->state->settings->frames);
    printf("  %-18s %8.3f\n", iso_renderer_truth()->name, truth);
    for (int m = 0; m < st->method_count; m++) {
        ISO_TRY(turn(s, st->methods[m], &change, error));
        printf("  %-18s %8.3f  %.2f times raycast's (at most 1.5 is asked for)\n", st->methods[m]->name,
               change, change / truth);
    }
    printf("\n");
    return ISO_OK;
}

static iso_status run_entry(state *st, const entry *e, iso_error *error) {
    session s = {.state = st, .name = e->name};
    ISO_TRY(open_entry(e, st->pool, &s.grid, &s.surface.isovalue, error));
    s.surface.grid = s.grid;
    s.surface.pool = st->pool;
    s.surface.bounded = true; /* as every program draws surfaces: hidden sides of closed ones are left out */
    iso_status status = prepare(&s, error);
    if (status == ISO_OK) status = look_at(&s, error);
    if (status == ISO_OK && strcmp(e->name, "stent") == 0) status = turn_all(&s, error);
    iso_study_frame_free(&s.truth);
    iso_study_frame_free(&s.candidate);
    iso_free(s.colors[0]);
    iso_free(s.colors[1]);
    iso_scene_surface_free(&s.surface);
    iso_grid_destroy(&s.grid);
    return status;
}

/* ---- everything ---- */

static iso_status write_json(state *s, iso_error *error) {
    iso_json json = {0};
    size_t count;
    const iso_metric *metrics = iso_metric_list(&count);
    iso_json_begin_array(&json, NULL);
    for (const row *r = s->rows; r < s->rows + s->row_count; r++) {
        iso_json_begin_object(&json, NULL);
        iso_json_string(&json, "volume", r->volume);
        iso_json_integer(&json, "zoom", (uint64_t)r->zoom);
        iso_json_string(&json, "method", r->method->name);
        for (size_t i = 0; i < count; i++)
            iso_json_real(&json, metrics[i].name, iso_metric_value(&metrics[i], &r->metrics));
        iso_json_real(&json, "pixels_per_voxel", r->pixels_per_voxel);
        iso_json_integer(&json, "missing", r->metrics.missing);
        iso_json_integer(&json, "extra", r->metrics.extra);
        iso_json_integer(&json, "depth_off", r->metrics.depth_off);
        iso_json_integer(&json, "others_differing", r->metrics.others_differing);
        iso_json_real(&json, "seconds", r->seconds);
        iso_json_end_object(&json);
    }
    iso_json_end_array(&json);
    return iso_json_commit(&json, &s->json, error);
}

bool quality_is_in_study(const char *volume) {
    return is_listed("stent,vase,ironProt,tooth,FLAIR,ch2better,sphere.vdb", volume);
}

/* Means over the seven volumes of the study when all are there, else over everything. */
static void print_means(const state *s) {
    int seven = 0;
    for (int i = 0; i < s->entry_count; i++) seven += quality_is_in_study(s->entries[i].name);
    printf("\n%s\n", seven == 7 ? "mean of the study's seven volumes" : "mean");
    print_head();
    for (int m = 0; m < s->method_count; m++)
        for (int z = 0; z < ZOOMS; z++) {
            row mean = {.zoom = zooms[z], .method = s->methods[m], .volume = "mean"};
            double sums[32] = {0}, counts[32] = {0};
            size_t metric_count;
            const iso_metric *metrics = iso_metric_list(&metric_count);
            for (const row *r = s->rows; r < s->rows + s->row_count; r++) {
                bool counts_in = seven != 7 || quality_is_in_study(r->volume);
                if (r->method != s->methods[m] || r->zoom != zooms[z] || !counts_in) continue;
                for (size_t i = 0; i < metric_count; i++) {
                    double value = iso_metric_value(&metrics[i], &r->metrics);
                    if (isnan(value)) continue;
                    sums[i] += value;
                    counts[i]++;
                }
                mean.seconds += r->seconds;
            }
            if (counts[0] == 0) continue;
            for (size_t i = 0; i < metric_count; i++) {
                double value = sums[i] / counts[i];
                memcpy((char *)&mean.metrics + metrics[i].offset, &value, sizeof value);
            }
            mean.seconds /= counts[0];
            print_row(&mean);
        }
}

/* A volume that cannot be read is said so and left out. */
static iso_status run_all(state *s, iso_error *error) {
    if (s->settings->json) ISO_TRY(iso_sink_open(s->settings->json, &s->json, error));
    list_methods(s);
    list_volumes(s);
    list_scenes(s);
    if (s->entry_count == 0) return iso_fail(error, ISO_ERR_USAGE, "no volume has such a name");
    print_head();
    for (int i = 0; i < s->entry_count; i++) {
        iso_error problem = {0};
        iso_status status = run_entry(s, &s->entries[i], &problem);
        if (status != ISO_OK) fprintf(stderr, "bench: %s: %s\n", s->entries[i].name, problem.text);
        if (status == ISO_ERR_NOMEM) return iso_fail(error, status, "out of memory");
    }
    if (s->row_count == 0) return iso_fail(error, ISO_ERR_EMPTY, "nothing was measured");
    print_means(s);
    quality_print_asked(s->rows, s->row_count);
    return s->settings->json ? write_json(s, error) : ISO_OK;
}

/* ---- the command line ---- */

#define FIELD(name) .offset = offsetof(settings, name)
#include "apps/common/option_rows.h"

static const iso_option options[] = {
    {"json", NULL, "FILE", "write one object a row", TEXT(json)},
    {"volumes", NULL, "A,B", "only these", TEXT(volumes)},
    {"methods", NULL, "A,B", "only these", TEXT(only)},
    {"folder", NULL, "DIR", "where INDEX.tsv and the real volumes are", TEXT(folder)},
    {"pictures", NULL, "DIR", "write all pictures there", TEXT(pictures)},
    {"frames", NULL, "N", "frames of the stent's turntable; 0: none", .standard = "64", INT(frames, 0, 720)},
    {"side", NULL, "N", "pixels a side, a multiple of 32", .standard = "1024", INT(side, 32, 4096)},
    {"threads", NULL, "N", "threads to use; figures do not depend on it", .standard = "one a processor",
     INT(threads, 1, 1024)},
    {"help", "h", NULL, "print this text", FLAG(help)},
};

static const char *const usage[] = {"[OPTION]...", NULL};
static const char *const groups[] = {"Options", NULL};
static const char *const notes[] = {
    "zoom is 1 (fit), 4 or 16. psnr_in: dB over both silhouettes widened by 2 pixels; dil px, max px: the",
    "silhouette's dilation, mean and largest; normal: degrees; depth: voxels; differ: pixels that differ by",
    "more than 1/255. The truth is raycast. Speeds are for orientation only: see bench render.", NULL};
static const iso_section sections[] = {{"Notes", notes}};

static const iso_program program = {.name = "bench quality",
                                    .version = "",
                                    .summary = "measures every method's pictures against the ray caster's",
                                    .usage = usage,
                                    .groups = groups,
                                    .options = options,
                                    .option_count = sizeof options / sizeof *options,
                                    .sections = sections,
                                    .section_count = 1};

static iso_status parse(int argc, char **argv, settings *set, iso_error *error) {
    const char **values = calloc((size_t)argc + 1, sizeof *values);
    if (!values) return iso_fail(error, ISO_ERR_NOMEM, "out of memory");
    iso_operands operands = {.values = values};
    iso_status status = iso_options_parse(&program, argc, argv, set, &operands, error);
    if (status == ISO_OK && operands.count)
        status = iso_fail(error, ISO_ERR_USAGE, "'%s' is not an option", values[0]);
    if (status == ISO_OK && set->side % 32)
        status = iso_fail(error, ISO_ERR_USAGE, "--side: %d is not a multiple of 32", set->side);
    free(values);
    return status;
}

static iso_status run(const settings *set, iso_error *error) {
    state *s = calloc(1, sizeof *s);
    if (!s) return iso_fail(error, ISO_ERR_NOMEM, "out of memory");
    s->settings = set;
    iso_status status = iso_pool_create(set->threads, &s->pool, error);
    if (status == ISO_OK) status = run_all(s, error);
    iso_sink_abort(&s->json);
    iso_pool_destroy(s->pool);
    free(s);
    return status;
}

int bench_quality(int argc, char **argv) {
    settings set = {.folder = ISO_TEST_VOLUMES, .side = 1024, .frames = 64};
    iso_error error = {0};
    iso_status status = parse(argc, argv, &set, &error);
    if (status == ISO_OK && set.help)
        iso_options_help(&program, "all", stdout, NULL);
    else if (status == ISO_OK)
        status = run(&set, &error);
    return status == ISO_OK ? 0 : iso_program_fail(&program, &error, status);
}
