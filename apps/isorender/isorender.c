/* isorender: any volume file to a correct picture of its isosurface, in one command. */
#include <stdlib.h>
#include <string.h>

#include "apps/isorender/isorender.h"
#include "apps/isorender/keyframes.h"
#include "apps/isorender/merge.h"
#include "apps/isorender/mpi_ranks.h"
#include "apps/isorender/panels.h"
#include "apps/isorender/scene_file.h"
#include "apps/isorender/series.h"
#include "apps/isorender/sheet.h"
#include "apps/isorender/watch.h"
#include "base/file_types.h"

static int fail(const iso_error *error, iso_status status) {
    return iso_program_fail(isorender_program(), error, status);
}

static iso_status list_backends(const isorender_settings *settings, iso_error *error) {
    iso_pool *pool = NULL;
    ISO_TRY(iso_pool_create(settings->common.threads, &pool, error));
    isorender_backends_list(iso_pool_threads(pool));
    iso_pool_destroy(pool);
    return ISO_OK;
}

/* Prints an error, unless another rank does; returns the exit status. */
static int say(const iso_error *error, iso_status status) {
    return error->text[0] ? fail(error, status) : iso_status_exit(status);
}

static bool draws_any(const isorender_settings *settings, const isorender_plan *plans) {
    for (int i = 0; i < settings->input_count && !settings->info; i++)
        if (isorender_plan_draws(&plans[i])) return true;
    return false;
}

/* Looks at all steps of a series for what they share, and draws them. What fails ends it, but for steps that
 * have no surface. */
static int render_series(isorender_settings *settings, const isorender_plan *plans, iso_pool *pool,
                         const isorender_backend *backend, const iso_environment *environment) {
    isorender_film *film = settings->film;
    const isorender_settings given = *settings;
    const bool draws = draws_any(settings, plans), measured = draws && isorender_series_is_measured(settings);
    film->count = settings->input_count;
    for (int pass = measured ? 0 : 1; pass < 2; pass++) {
        iso_error error = {0};
        iso_status status = ISO_OK, last = ISO_OK;
        bool any = false;
        film->measuring = pass == 0;
        for (int i = 0; i < given.input_count; i++) {
            *settings = given;
            settings->common.quiet |= film->measuring;
            isorender_series_choose(settings, i);
            film->first = i;
            status = isorender_run(settings, &plans[i], pool, backend, environment, &error);
            any |= status == ISO_OK;
            if (status != ISO_OK) last = status;
            if (status != ISO_OK && !(film->measuring && status == ISO_ERR_EMPTY)) break;
        }
        if (last == ISO_OK || (any && last == ISO_ERR_EMPTY && film->measuring)) continue;
        iso_settings_explain_memory(&given.common, &error);
        return say(&error, last);
    }
    return 0;
}

/* One input that fails does not stop the others; the first failure gives the exit status. */
static int render_each(const isorender_settings *given, const isorender_plan *plans, iso_pool *pool,
                       const isorender_backend *backend, const iso_environment *environment) {
    int worst = 0;
    isorender_same_view first = {0};
    isorender_film film = isorender_film_of(given);
    isorender_settings copy = *given, *settings = &copy;
    const bool panels = isorender_has_panels(settings);
    if (settings->same_view) settings->first = &first;
    settings->film = &film;
    if (settings->series_of) return render_series(settings, plans, pool, backend, environment);
    for (int i = 0; i < settings->input_count; i++) {
        iso_error error = {0};
        const iso_box bounds = film.bounds;
        const bool has_bounds = settings->same_view && film.has_bounds;
        film = isorender_film_of(given);
        if (has_bounds) film.bounds = bounds, film.has_bounds = true;
        iso_status status = (panels ? isorender_panels_run : isorender_run)(settings, &plans[i], pool,
                                                                            backend, environment, &error);
        if (status == ISO_OK) continue;
        if (error.text[0]) iso_settings_explain_memory(&settings->common, &error);
        int code = say(&error, status);
        if (worst == 0) worst = code;
    }
    return worst;
}

static iso_status render_inputs(const isorender_settings *settings, int *code, iso_error *error) {
    isorender_plan *plans = NULL;
    iso_pool *pool = NULL;
    iso_environment *environment = NULL;
    iso_settings_limit_memory(&settings->common);
    iso_status status = isorender_plans_make(settings, &plans, error);
    isorender_backend backend = isorender_backend_cpu();
    for (int i = 0; status == ISO_OK && settings->input_count > 1 && i < settings->input_count; i++)
        iso_loader_list_files(plans[i].input, &settings->common.input, plans[i].files);
    if (status == ISO_OK) status = iso_file_set_check(plans->files, error);
    if (status == ISO_OK) status = iso_pool_create(settings->common.threads, &pool, error);
    if (status == ISO_OK && draws_any(settings, plans))
        status = isorender_backend_open(settings, &backend, error);
    if (status == ISO_OK && draws_any(settings, plans))
        status = isorender_environment_open(settings, pool, &environment, error);
    status = iso_ranks_agree(&settings->ranks, status, error);
    if (status == ISO_OK) *code = render_each(settings, plans, pool, &backend, environment);
    iso_environment_destroy(environment);
    isorender_backend_close(&backend);
    iso_pool_destroy(pool);
    isorender_plans_free(plans, settings->input_count);
    return status;
}

/* Only rank 0 speaks, and of a failure the lowest rank that failed. */
static iso_status render_with_ranks(isorender_settings *settings, int *code, iso_error *error) {
    iso_status status = isorender_ranks_check_settings(settings, error);
    if (settings->ranks.rank) settings->common.quiet = 1;
    const char *unfit = settings->parts                  ? "--part"
                        : settings->info                 ? "--info"
                        : settings->no_image             ? "--no-image"
                        : settings->has_inset            ? "--inset"
                        : isorender_has_panels(settings) ? "--panels"
                                                         : NULL;
    if (status == ISO_OK && settings->ranks.mpi && unfit)
        status =
            iso_fail(error, ISO_ERR_USAGE, "mpirun draws one picture: it cannot be combined with %s", unfit);
    if (status == ISO_OK) status = isorender_ranks_limit_memory(settings, error);
    if (status == ISO_OK) status = render_inputs(settings, code, error);
    return iso_ranks_agree(&settings->ranks, status, error);
}

static iso_status perform(isorender_settings *settings, int *code, iso_error *error) {
    bool helped;
    ISO_TRY(iso_settings_print_help(&settings->common, isorender_program(), &helped, error));
    if (helped) return ISO_OK;
    if (settings->common.action == ISORENDER_ACTION_LIST_BACKENDS) return list_backends(settings, error);
    if (settings->common.action == ISORENDER_ACTION_SCHEMA) return isorender_scene_print_schema(error);
    if (settings->merge) return isorender_merge(settings, error);
    if (settings->sheet.is_given) return isorender_sheet(settings, code, error);
    return render_with_ranks(settings, code, error);
}

/* Starts MPI if the command line asks for what the ranks do together, or if it is wrong: the others' may not
 * be. Returns the status of all ranks. */
static iso_status join_ranks(isorender_settings *settings, iso_status parsed, iso_error *error) {
    iso_error reason = {0};
    if (parsed == ISO_OK && (settings->common.action || settings->merge || settings->sheet.is_given))
        return ISO_OK;
    const iso_status started = isorender_ranks_start(&settings->ranks, &reason);
    if (started == ISO_OK) return iso_ranks_agree(&settings->ranks, parsed, error);
    if (parsed == ISO_OK) *error = reason;
    if (iso_ranks_number_on_node() > 0) error->text[0] = 0; /* the first rank of the node tells it */
    return parsed == ISO_OK ? started : parsed;
}

/* Remembers which file the options come from. A picture of NAME.json without a name of its own is NAME.png,
 * which is returned, to be freed. */
static char *take_scene_path(isorender_settings *settings, const char *path) {
    const char *slash = strrchr(path, '/'), *name = slash ? slash + 1 : path, *dot = strrchr(name, '.');
    char *picture = NULL;
    settings->scene_file = path;
    if (dot && iso_file_type_of_name(name, ISO_HOLDS_SCENE) == ISO_FILE_json &&
        asprintf(&picture, "%.*s.png", (int)(dot - name), name) < 0)
        picture = NULL;
    settings->scene_output = picture;
    return picture;
}

/* The settings of a command line, and what they borrow. */
typedef struct parsed {
    isorender_settings settings;
    iso_operands operands;
    char *picture; /* take_scene_path */
} parsed;

/* `number`: of the command, of several. Free with parsed_free also after errors. */
static iso_status parse(const isorender_command *command, int number, parsed *p, iso_error *error) {
    p->operands = (iso_operands){calloc((size_t)command->argc + 1, sizeof *p->operands.values), 0};
    p->settings = (isorender_settings){.scene_number = 0};
    p->picture = NULL;
    if (!p->operands.values) return iso_fail(error, ISO_ERR_NOMEM, "out of memory");
    const iso_status status =
        isorender_settings_parse(command->argc, command->argv, &p->settings, &p->operands, error);
    if (command->path) p->picture = take_scene_path(&p->settings, command->path);
    p->settings.scene_number = number;
    p->settings.argc = command->argc;
    p->settings.argv = command->argv;
    return status;
}

static void parsed_free(parsed *p) {
    isorender_keyframes_free(&p->settings);
    isorender_series_free(&p->settings);
    isorender_bids_free(&p->settings.sheet.bids);
    free(p->operands.values);
    free(p->picture);
}

static int run_command(const isorender_command *command, int number) {
    iso_error error = {0};
    parsed p;
    int code = 0;
    iso_status status = parse(command, number, &p, &error);
    if (!p.operands.values) return iso_program_fail(isorender_program(), &error, status);
    isorender_settings *settings = &p.settings;
    status = join_ranks(settings, status, &error);
    if (status == ISO_OK && settings->sheet.watch && !settings->common.action)
        status = isorender_watch(settings, &error);
    if (status == ISO_OK) status = perform(settings, &code, &error);
    if (status != ISO_OK) code = say(&error, status);
    isorender_ranks_finish(&settings->ranks);
    parsed_free(&p);
    return iso_program_finish(isorender_program(), code);
}

/* Checks that no scene would overwrite what another one has drawn. What else is wrong with one is said when
 * it is drawn. */
static iso_status check_outputs(const isorender_commands *scenes, iso_error *error) {
    iso_file_set outputs = {0};
    iso_status status = ISO_OK;
    for (int i = 0; i < scenes->count && status == ISO_OK; i++) {
        parsed p;
        isorender_plan *plans = NULL;
        if (parse(&scenes->items[i], i, &p, NULL) == ISO_OK && !p.settings.common.action &&
            isorender_plans_make(&p.settings, &plans, NULL) == ISO_OK)
            status = isorender_plans_add_outputs(&p.settings, plans, &outputs, error);
        isorender_plans_free(plans, p.settings.input_count);
        parsed_free(&p);
    }
    if (status == ISO_OK) status = iso_file_set_check(&outputs, error);
    iso_file_set_free(&outputs);
    if (status != ISO_ERR_USAGE) return status;
    char reason[sizeof error->text];
    memcpy(reason, error->text, sizeof reason);
    return iso_fail(error, status, "%s; several scenes need a template, such as --output 'figure-{n}.png'",
                    reason);
}

static int run_program(int argc, char **argv) {
    iso_error error = {0};
    isorender_commands scenes;
    int worst = 0;
    const iso_status status = isorender_commands_make(argc, argv, &scenes, &error);
    if (status != ISO_OK && iso_ranks_number_on_node() > 0) error.text[0] = 0; /* the first rank tells it */
    if (status != ISO_OK) return say(&error, status);
    if (!scenes.count) return run_command(&(isorender_command){.argc = argc, .argv = argv}, 0);
    const iso_status outputs = scenes.count > 1 ? check_outputs(&scenes, &error) : ISO_OK;
    if (outputs != ISO_OK) worst = say(&error, outputs);
    for (int i = 0; i < scenes.count && outputs == ISO_OK; i++) {
        const int code = run_command(&scenes.items[i], i);
        if (!worst) worst = code;
    }
    isorender_commands_free(&scenes);
    return worst;
}

int main(int argc, char **argv) {
    return iso_program_main(argc, argv, run_program);
}
