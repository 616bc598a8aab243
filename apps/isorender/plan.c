/* Names of the outputs of every input, and the refusal of names that would destroy something. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "apps/common/template.h"
#include "apps/isorender/plan.h"
#include "base/file.h"
#include "scene/loader.h"

/* The name of what there is one of for every frame. The name of a single picture is complete. That of several
 * of an input stays a template, with {model}: the input's name may have braces of its own. */
static iso_status make_frame_name(const isorender_settings *settings, const isorender_plan *plan,
                                  const char *output, int number, char **name, iso_error *error) {
    const int frames = settings->series_of ? settings->input_count : settings->pictures;
    /* The files of a series can have names of their own. */
    const bool named = settings->series_of && !settings->step_stride && iso_template_has(output, "model");
    if (!frames || named || iso_video_is_name(output))
        return iso_template_expand(output, plan->model, number, name, error);
    /* {n} numbers the frames, or the steps of a series. */
    int digits = 3;
    char *numbered = NULL;
    for (int rest = frames; rest > 1000; rest = (rest + 9) / 10) digits++;
    ISO_TRY(iso_template_numbered(output, digits, &numbered, error));
    iso_status status = ISO_OK;
    if (settings->series_of)
        status = iso_template_expand(numbered, plan->model, number, name, error);
    else
        *name = strdup(numbered);
    free(numbered);
    return status == ISO_OK && !*name ? iso_fail(error, ISO_ERR_NOMEM, "out of memory") : status;
}

static iso_status make_names(const isorender_settings *settings, int number, isorender_plan *plan,
                             iso_error *error) {
    plan->numbered = settings->pictures != 0;
    ISO_TRY(iso_template_model(plan->input, &plan->model, error));
    if (settings->points)
        ISO_TRY(iso_template_expand(settings->points, plan->model, number, &plan->points, error));
    if (settings->mesh) ISO_TRY(iso_template_expand(settings->mesh, plan->model, number, &plan->mesh, error));
    if (settings->table)
        ISO_TRY(iso_template_expand(settings->table, plan->model, number, &plan->table, error));
    if (settings->common.json_path)
        ISO_TRY(iso_template_expand(settings->common.json_path, plan->model, number, &plan->json, error));
    if (settings->save_scene)
        ISO_TRY(iso_template_expand(settings->save_scene, plan->model, number, &plan->scene_file, error));
    if (settings->info) return ISO_OK;
    if (settings->aov) ISO_TRY(make_frame_name(settings, plan, settings->aov, number, &plan->aov, error));
    if (settings->no_image) return ISO_OK;
    const char *output = settings->output         ? settings->output
                         : settings->scene_output ? settings->scene_output
                                                  : "{model}.png";
    char part[64];
    if (settings->parts && !settings->output) {
        snprintf(part, sizeof part, "{model}-%d-of-%d.isokeys", settings->part, settings->parts);
        output = part;
    }
    plan->video = iso_video_is_name(output);
    return make_frame_name(settings, plan, output, number, &plan->image, error);
}

static iso_status scene_input(const char *scene, char **input, iso_error *error) {
    size_t size = strlen(scene) + sizeof "scene:";
    *input = malloc(size);
    if (!*input) return iso_fail(error, ISO_ERR_NOMEM, "out of memory");
    snprintf(*input, size, "scene:%s", scene);
    return ISO_OK;
}

/* ---- collisions ---- */

enum { IMAGE, POINTS, MESH, JSON, AOV, SCENE_FILE, TABLE, NAMES };

static void names_of(const isorender_plan *plan, const char *names[NAMES]) {
    names[IMAGE] = plan->image;
    names[POINTS] = plan->points;
    names[MESH] = plan->mesh;
    names[JSON] = plan->json;
    names[AOV] = plan->aov;
    names[SCENE_FILE] = plan->scene_file;
    names[TABLE] = plan->table;
}

/* Every frame of an input has a name of its own, but for those of a video. */
static iso_status add_frames(const isorender_settings *settings, const isorender_plan *plan, const char *name,
                             iso_file_set *files, iso_error *error) {
    const bool several = settings->pictures && !(plan->video && name == plan->image);
    for (int frame = 0; name && frame < (several ? settings->pictures : 1); frame++) {
        char *path = NULL;
        ISO_TRY(isorender_plan_frame(plan, name, frame, &path, error));
        iso_file_set_write(files, path);
        free(path);
    }
    return ISO_OK;
}

static void add_input(iso_file_set *files, const char *input) {
    if (!iso_loader_is_scene(input) && !iso_spool_is_stream(input)) iso_file_set_read(files, input);
}

static iso_status add_outputs(const isorender_settings *settings, const isorender_plan *plan, int number,
                              iso_file_set *files, iso_error *error) {
    const char *names[NAMES];
    names_of(plan, names);
    for (int i = 0; i < NAMES; i++)
        if (i == IMAGE && plan->video && settings->series_of && number)
            continue; /* all steps go into one */
        else if (i == IMAGE || i == AOV)
            ISO_TRY(add_frames(settings, plan, names[i], files, error));
        else
            iso_file_set_write(files, names[i]);
    return ISO_OK;
}

iso_status isorender_plans_add_outputs(const isorender_settings *settings, const isorender_plan *plans,
                                       iso_file_set *files, iso_error *error) {
    for (int i = 0; i < settings->input_count; i++)
        ISO_TRY(add_outputs(settings, &plans[i], i, files, error));
    return ISO_OK;
}

/* Checks that no output is an input or another output, among the files named on the command line. The files
 * that an input's header names are added later, by iso_loader_open and iso_loader_list_files. */
static iso_status check_all(const isorender_settings *settings, const isorender_plan *plans,
                            iso_error *error) {
    if (settings->environment) iso_file_set_read(plans->files, settings->environment);
    if (settings->scene_file) iso_file_set_read(plans->files, settings->scene_file);
    if (settings->keyframe_file) iso_file_set_read(plans->files, settings->keyframe_file);
    if (settings->labels) add_input(plans[0].files, settings->labels);
    if (settings->label_table) iso_file_set_read(plans->files, settings->label_table);
    for (int i = 0; i < settings->panel_files.count; i++)
        add_input(plans->files, settings->panel_files.values[i]);
    for (int i = 0; i < settings->object_options.count; i++)
        iso_file_set_read(plans->files, settings->object_options.paths[i]);
    for (int i = 0; i < settings->volume_options.count; i++)
        add_input(plans[0].files, settings->volume_options.paths[i]);
    for (int i = 0; i < settings->input_count; i++) add_input(plans->files, plans[i].input);
    ISO_TRY(isorender_plans_add_outputs(settings, plans, plans->files, error));
    return iso_file_set_check(plans->files, error);
}

static iso_status make_all(const isorender_settings *settings, isorender_plan *plans, iso_error *error) {
    iso_file_set *files = calloc(1, sizeof *files);
    if (!files) return iso_fail(error, ISO_ERR_NOMEM, "out of memory");
    for (int i = 0; i < settings->input_count; i++) plans[i].files = files;
    for (int i = 0; i < settings->input_count; i++) {
        if (settings->scene) ISO_TRY(scene_input(settings->scene, &plans[i].scene, error));
        plans[i].input = settings->scene ? plans[i].scene : settings->inputs[i];
        const int number = settings->scene_number * settings->input_count + i;
        ISO_TRY(make_names(settings, number, &plans[i], error));
        if (!i || !plans[i].video || !settings->series_of) continue;
        free(plans[i].image); /* all steps go into one */
        plans[i].image = strdup(plans[0].image);
        if (!plans[i].image) return iso_fail(error, ISO_ERR_NOMEM, "out of memory");
    }
    return check_all(settings, plans, error);
}

iso_status isorender_plans_make(const isorender_settings *settings, isorender_plan **plans,
                                iso_error *error) {
    isorender_plan *made = calloc((size_t)settings->input_count, sizeof *made);
    if (!made) return iso_fail(error, ISO_ERR_NOMEM, "out of memory");
    iso_status status = make_all(settings, made, error);
    if (status != ISO_OK) {
        isorender_plans_free(made, settings->input_count);
        return status;
    }
    *plans = made;
    return ISO_OK;
}

void isorender_plans_free(isorender_plan *plans, int count) {
    if (plans && plans->files) iso_file_set_free(plans->files);
    if (plans) free(plans->files);
    for (int i = 0; plans && i < count; i++) {
        free(plans[i].scene);
        free(plans[i].model);
        free(plans[i].image);
        free(plans[i].aov);
        free(plans[i].points);
        free(plans[i].mesh);
        free(plans[i].json);
        free(plans[i].scene_file);
        free(plans[i].table);
    }
    free(plans);
}

bool isorender_plan_draws(const isorender_plan *plan) {
    return plan->image || plan->aov;
}

iso_status isorender_plan_frame(const isorender_plan *plan, const char *name, int frame, char **path,
                                iso_error *error) {
    if (plan->numbered && !(plan->video && name == plan->image))
        return iso_template_expand(name, plan->model, frame, path, error);
    *path = strdup(name);
    return *path ? ISO_OK : iso_fail(error, ISO_ERR_NOMEM, "out of memory");
}

static iso_status check_first_frame(const isorender_plan *plan, const char *name, iso_error *error) {
    if (!name) return ISO_OK;
    char *first = NULL;
    ISO_TRY(isorender_plan_frame(plan, name, 0, &first, error));
    iso_status status = iso_sink_check(first, error);
    free(first);
    return status;
}

iso_status isorender_plan_check_writable(const isorender_plan *plan, iso_error *error) {
    ISO_TRY(iso_picture_file_check(plan->image, plan->aov, error));
    ISO_TRY(check_first_frame(plan, plan->image, error));
    ISO_TRY(check_first_frame(plan, plan->aov, error));
    ISO_TRY(iso_sink_check(plan->points, error));
    ISO_TRY(iso_sink_check(plan->mesh, error));
    ISO_TRY(iso_sink_check(plan->scene_file, error));
    ISO_TRY(iso_sink_check(plan->table, error));
    return iso_sink_check(plan->json, error);
}
