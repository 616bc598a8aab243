/* Contact sheets: the commands of their panels, and what is measured. */
#include "apps/isorender/sheet.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "apps/common/contact_sheet.h"
#include "apps/isorender/annotations.h"
#include "apps/isorender/keyframes.h"
#include "apps/isorender/panels.h"
#include "base/file_identity.h"
#include "base/memory.h"

/* ---- options */

const char *const isorender_measures[] = {"none",     "volume",  "area",    "parts",
                                          "isovalue", "minimum", "maximum", NULL};

iso_status isorender_sheet_check(isorender_settings *settings, const iso_operands *operands,
                                 iso_error *error) {
    const char *unfit = isorender_panels_unfit(settings);
    if (!unfit && isorender_has_panels(settings)) unfit = "--panels";
    if (!unfit && settings->scene) unfit = "--scene (the input scene:NAME is fine)";
    if (!unfit && settings->save_scene) unfit = "--save-scene";
    if (!unfit && settings->again.count) unfit = "--again";
    if (unfit) return iso_fail(error, ISO_ERR_USAGE, "sheet cannot be combined with %s", unfit);
    if (!settings->output || strcmp(settings->output, "-") == 0)
        return iso_fail(error, ISO_ERR_USAGE, "sheet: needs a name: -o OUT.html or OUT.png");
    if (!operands->count) return iso_fail(error, ISO_ERR_USAGE, "sheet: no inputs (see --help)");
    if (iso_ranks_are_several())
        return iso_fail(error, ISO_ERR_USAGE,
                        "sheet starts processes itself (--jobs): run it without mpirun");
    if (strcmp(settings->backend, "auto") == 0) settings->backend = "cpu";
    settings->inputs = operands->values;
    settings->input_count = operands->count;
    for (int i = 0; i < operands->count; i++)
        if (iso_spool_is_stream(operands->values[i]))
            return iso_fail(error, ISO_ERR_USAGE, "%s: a sheet is made of files and folders",
                            operands->values[i]);
    if (operands->count > 1 || !isorender_bids_is(operands->values[0])) return ISO_OK;
    ISO_TRY(isorender_bids_find(operands->values[0], &settings->sheet.bids, error));
    settings->inputs = (const char *const *)settings->sheet.bids.images;
    settings->input_count = settings->sheet.bids.count;
    for (int i = 0; i < settings->input_count; i++)
        if (iso_spool_is_stream(settings->inputs[i]))
            return iso_fail(error, ISO_ERR_IO, "%s: not a regular file", settings->inputs[i]);
    return ISO_OK;
}

/* ---- the commands of panels */

/* The command of one panel. */
typedef struct command {
    char **argv, *mask; /* mask: the argument, or NULL */
    int argc;
    iso_operands operands;
    isorender_settings settings;
    isorender_plan *plans; /* one */
    isorender_film film;
    isorender_tile tile;
} command;

typedef struct maker {
    isorender_settings *settings; /* with the memory of one process */
    char **options;               /* the program's name and all options of panels */
    int option_count;
    command *command;           /* of the panel that is drawn */
    isorender_same_view *first; /* shared by the processes; NULL: panels do not share a view */
    int threads;                /* of each process */
    iso_pool *pool;
    isorender_backend backend;
    iso_environment *environment;
} maker;

/* Keeps the options of the command line without those of the sheet and without operands. */
static iso_status take_options(maker *m, iso_error *error) {
    static const char *const left_out[] = {"output",  "json",          "jobs",      "watch",  "quiet",
                                           "threads", "panel-columns", "same-view", "measure"};
    const isorender_settings *s = m->settings;
    const int argc = s->argc - 1; /* without the program's name: the first is the command's */
    char *const *argv = s->argv + 1, **kept = calloc((size_t)s->argc, sizeof *kept);
    isorender_settings *parsed = calloc(1, sizeof *parsed);
    iso_operands operands = {calloc((size_t)s->argc, sizeof *operands.values), 0};
    m->options = calloc((size_t)s->argc, sizeof *m->options);
    iso_status status = kept && parsed && operands.values && m->options
                            ? iso_options_parse(isorender_program(), argc, argv, parsed, &operands, error)
                            : iso_fail(error, ISO_ERR_NOMEM, "out of memory");
    const int count = status == ISO_OK ? iso_options_without(isorender_program(), argc, argv, left_out,
                                                             sizeof left_out / sizeof *left_out, kept)
                                       : 0;
    for (int i = 0, operand = 0; i < count; i++)
        if (operand < operands.count && kept[i] == operands.values[operand])
            operand++;
        else if (strcmp(kept[i], "--") != 0)
            m->options[m->option_count++] = kept[i];
    free(kept);
    free(parsed);
    free(operands.values);
    return status;
}

static void free_command(command *c) {
    if (!c) return;
    isorender_plans_free(c->plans, 1);
    isorender_keyframes_free(&c->settings);
    iso_image_free(&c->tile.image);
    free(c->operands.values);
    free(c->argv);
    free(c->mask);
    free(c);
}

static iso_status parse_command(const maker *m, int number, command *c, iso_error *error) {
    const isorender_settings *s = m->settings;
    const char *mask = s->sheet.bids.count ? s->sheet.bids.masks[number] : NULL;
    c->argv = calloc((size_t)m->option_count + 4, sizeof *c->argv);
    c->operands.values = calloc((size_t)m->option_count + 4, sizeof *c->operands.values);
    if (mask && asprintf(&c->mask, "--labels=%s", mask) < 0) c->mask = NULL;
    if (!c->argv || !c->operands.values || (mask && !c->mask))
        return iso_fail(error, ISO_ERR_NOMEM, "out of memory");
    memcpy(c->argv, m->options, (size_t)m->option_count * sizeof *c->argv);
    c->argc = m->option_count;
    if (mask && !s->labels) c->argv[c->argc++] = c->mask;
    if (mask && !s->labels && !s->opacity_count) c->argv[c->argc++] = "--opacity=0.3";
    c->argv[c->argc++] = "--";
    c->argv[c->argc++] = (char *)(uintptr_t)s->inputs[number];
    ISO_TRY(isorender_settings_parse(c->argc, c->argv, &c->settings, &c->operands, error));
    isorender_settings *own = &c->settings;
    own->width = s->width, own->height = s->height;
    own->output = "-"; /* it is kept in memory */
    own->backend = s->backend;
    if (own->fit == ISORENDER_FIT_UNCHOSEN) own->fit = ISORENDER_FIT_BOX; /* half the time of a tight one */
    own->common.quiet = 1;
    own->sheet.measure = s->sheet.measure;
    own->common.input.max_memory = s->common.input.max_memory;
    own->sheet.tile = &c->tile;
    c->film = isorender_film_of(own);
    own->film = &c->film;
    own->same_view = s->same_view;
    own->first = m->first;
    return isorender_plans_make(own, &c->plans, error);
}

/* The panel's command becomes that of the maker. */
static iso_status begin_panel(maker *m, int number, iso_error *error) {
    free_command(m->command);
    m->command = calloc(1, sizeof *m->command);
    if (!m->command) return iso_fail(error, ISO_ERR_NOMEM, "out of memory");
    const iso_status status = parse_command(m, number, m->command, error);
    const char *name = m->settings->inputs[number];
    if (status == ISO_OK || strncmp(error->text, name, strlen(name)) == 0) return status;
    return iso_fail(error, status, "%s: %s", name, error->text);
}

/* The key of a panel: of its command, the files that this reads, and what panels share. */
static iso_status find_key(void *context, int number, uint64_t *key, iso_error *error) {
    maker *m = context;
    ISO_TRY(begin_panel(m, number, error));
    command *c = m->command;
    iso_loader_list_files(c->plans[0].input, &c->settings.common.input, c->plans[0].files);
    uint64_t hash = iso_file_set_identity(c->plans[0].files);
    hash = iso_hash(hash, isorender_program()->version, strlen(isorender_program()->version) + 1);
    hash = iso_hash(hash, &c->settings.sheet.measure, sizeof c->settings.sheet.measure);
    for (int i = 1; i < c->argc; i++) hash = iso_hash(hash, c->argv[i], strlen(c->argv[i]) + 1);
    if (m->first) {
        const iso_camera *v = &m->first->camera;
        const double shared[] = {m->first->isovalue, v->position.x,    v->position.y,    v->position.z,
                                 v->focal_point.x,   v->focal_point.y, v->focal_point.z, v->view_up.x,
                                 v->view_up.y,       v->view_up.z,     v->view_angle,    v->orthographic,
                                 v->parallel_scale};
        hash = iso_hash(hash, shared, sizeof shared);
    }
    *key = hash;
    return ISO_OK;
}

/* Makes what draws, once a process. */
static iso_status open_means(maker *m, iso_error *error) {
    if (m->pool) return ISO_OK;
    iso_settings_limit_memory(&m->command->settings.common);
    ISO_TRY(iso_pool_create(m->threads, &m->pool, error));
    ISO_TRY(isorender_backend_open(&m->command->settings, &m->backend, error));
    return isorender_environment_open(&m->command->settings, m->pool, &m->environment, error);
}

static iso_status run_panel(maker *m, iso_error *error) {
    command *c = m->command;
    c->tile.isovalue = c->tile.measure = NAN;
    ISO_TRY(open_means(m, error));
    const iso_status status =
        isorender_run(&c->settings, &c->plans[0], m->pool, &m->backend, m->environment, error);
    if (status != ISO_OK && error->text[0]) iso_settings_explain_memory(&c->settings.common, error);
    return status;
}

static iso_status draw(void *context, int number, iso_image *image, double *values, iso_error *error) {
    maker *m = context;
    (void)number;
    ISO_TRY(run_panel(m, error));
    isorender_tile *tile = &m->command->tile;
    *image = tile->image;
    tile->image = (iso_image){.rgba = NULL};
    values[0] = tile->isovalue;
    values[1] = tile->measure;
    return ISO_OK;
}

/* In a process of its own: finds what panels share, the isovalue and the camera of the first that has a
 * surface. */
static void survey(void *context, int descriptor) {
    maker *m = context;
    (void)descriptor;
    for (int i = 0; i < m->settings->input_count && !m->first->has_camera; i++) {
        iso_error error = {0};
        if (begin_panel(m, i, &error) != ISO_OK) continue;
        m->command->tile.is_survey = true;
        run_panel(m, &error);
    }
}

/* ---- what is measured */

iso_status isorender_tile_measure(isorender_job *job, iso_error *error) {
    isorender_tile *tile = job->settings->sheet.tile;
    isorender_surface *surface = &job->surfaces[0];
    const int measure = job->settings->sheet.measure;
    if (tile->is_survey || !job->has_volume || !job->input_surface_count) return ISO_OK;
    tile->isovalue = surface->scene.isovalue;
    if (measure == ISORENDER_MEASURE_ISOVALUE) tile->measure = tile->isovalue;
    if (measure == ISORENDER_MEASURE_MINIMUM || measure == ISORENDER_MEASURE_MAXIMUM) {
        ISO_TRY(iso_loader_histogram(&job->loader, error));
        tile->measure = measure == ISORENDER_MEASURE_MINIMUM ? job->loader.histogram.minimum
                                                             : job->loader.histogram.maximum;
    }
    if (job->chunks) return ISO_OK;
    if (measure == ISORENDER_MEASURE_VOLUME || measure == ISORENDER_MEASURE_PARTS) {
        const iso_components_opts opts = {
            .isovalue = surface->scene.isovalue, .largest = 0, .min_volume = 0, .pool = job->pool};
        iso_components_totals parts;
        ISO_TRY(iso_components_filter(&surface->scene.grid, &opts, &parts, error));
        tile->measure = measure == ISORENDER_MEASURE_VOLUME ? parts.kept_volume : (double)parts.kept;
    }
    if (measure == ISORENDER_MEASURE_AREA) {
        iso_mesh_measures mesh;
        ISO_TRY(iso_solid_measure(&surface->scene.grid, surface->scene.isovalue, job->pool, &mesh, error));
        tile->measure = mesh.area;
    }
    return ISO_OK;
}

/* ---- the sheet */

/* No output is an input. Options that do not go together are found before anything is drawn. */
static iso_status check_files(maker *m, iso_error *error) {
    const isorender_settings *s = m->settings;
    iso_file_set files = {0};
    for (int i = 0; i < s->input_count; i++)
        if (!iso_loader_is_scene(s->inputs[i])) iso_file_set_read(&files, s->inputs[i]);
    iso_file_set_write(&files, s->output);
    if (s->common.json_path) iso_file_set_write(&files, s->common.json_path);
    iso_status status = iso_file_set_check(&files, error);
    iso_file_set_free(&files);
    ISO_TRY(status);
    iso_error reason = {0};
    status = begin_panel(m, 0, &reason);
    return status == ISO_ERR_USAGE ? iso_fail(error, status, "%s", reason.text) : ISO_OK;
}

static iso_status make_sheet(maker *m, int *code, iso_error *error) {
    const int measure = m->settings->sheet.measure;
    const char *unit = measure == ISORENDER_MEASURE_VOLUME ? "mm3"
                       : measure == ISORENDER_MEASURE_AREA ? "mm2"
                                                           : "";
    const isorender_settings *s = m->settings;
    iso_contact_sheet sheet = {.program = isorender_program(),
                               .output = s->output,
                               .inputs = s->inputs,
                               .beside = (const char *const *)s->sheet.bids.masks,
                               .count = s->input_count,
                               .jobs = s->sheet.jobs,
                               .values = {{"isovalue", ""}},
                               .value_count = measure && measure != ISORENDER_MEASURE_ISOVALUE ? 2 : 1,
                               .grid = {.columns = s->panel_columns,
                                        .panel = {s->width, s->height},
                                        .font = isorender_font_pixels(s),
                                        .background = s->background,
                                        .transparent = s->transparent != 0},
                               .json = s->common.json,
                               .quiet = s->common.quiet,
                               .json_path = s->common.json_path,
                               .max_memory = iso_memory_limit(s->common.input.max_memory),
                               .find_key = find_key,
                               .draw = draw,
                               .context = m};
    sheet.shown = measure ? sheet.value_count - 1 : -1;
    sheet.values[1] = (iso_sheet_value){isorender_measures[measure], unit};
    m->threads = s->common.threads;
    ISO_TRY(iso_sheet_share_machine(&sheet, &m->threads, error));
    m->settings->common.input.max_memory = sheet.max_memory / (uint64_t)sheet.jobs;
    if (s->same_view) ISO_TRY(iso_sheet_fork(1, survey, NULL, m, error));
    return iso_sheet_make(&sheet, code, error);
}

static void free_maker(maker *m) {
    free_command(m->command);
    iso_environment_destroy(m->environment);
    isorender_backend_close(&m->backend);
    iso_pool_destroy(m->pool);
    iso_sheet_unshare(m->first, sizeof *m->first);
    free(m->options);
}

iso_status isorender_sheet(const isorender_settings *settings, int *code, iso_error *error) {
    isorender_settings own = *settings;
    maker m = {.settings = &own, .backend = isorender_backend_cpu()};
    iso_settings_limit_memory(&own.common);
    iso_status status = ISO_OK;
    if (own.same_view && !(m.first = iso_sheet_share(sizeof *m.first)))
        status = iso_fail(error, ISO_ERR_NOMEM, "out of memory");
    if (status == ISO_OK) status = take_options(&m, error);
    if (status == ISO_OK) status = check_files(&m, error);
    if (status == ISO_OK) status = make_sheet(&m, code, error);
    free_maker(&m);
    return status;
}
