/* Names of the outputs of every input, and the refusal of names that would destroy something. */
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "apps/isorender.h"
#include "apps/template.h"
#include "base/file.h"
#include "image/exr.h"

/* The name of what there is one of for every frame. */
static iso_status make_frame_name(const isorender_settings *settings, const isorender_plan *plan,
                                  const char *output, int number, char **name, iso_error *error) {
    if (!settings->turntable) return iso_template_expand(output, plan->model, number, name, error);
    /* A turntable's {n} numbers its frames. */
    int digits = 3;
    for (int frames = settings->turntable; frames > 1000; frames = (frames + 9) / 10) digits++;
    char *numbered = NULL;
    ISO_TRY(iso_template_numbered(output, digits, &numbered, error));
    iso_status status = iso_template_expand(numbered, plan->model, -1, name, error);
    free(numbered);
    return status;
}

static iso_status make_names(const isorender_settings *settings, int number, isorender_plan *plan,
                             iso_error *error) {
    ISO_TRY(iso_template_model(plan->input, &plan->model, error));
    if (settings->points)
        ISO_TRY(iso_template_expand(settings->points, plan->model, number, &plan->points, error));
    if (settings->mesh) ISO_TRY(iso_template_expand(settings->mesh, plan->model, number, &plan->mesh, error));
    if (settings->json_path)
        ISO_TRY(iso_template_expand(settings->json_path, plan->model, number, &plan->json, error));
    if (settings->info) return ISO_OK;
    if (settings->aov) ISO_TRY(make_frame_name(settings, plan, settings->aov, number, &plan->aov, error));
    if (settings->no_image) return ISO_OK;
    const char *output = settings->output ? settings->output : "{model}.png";
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

enum { NAMES = 5 };

static void names_of(const isorender_plan *plan, const char *names[NAMES]) {
    names[0] = plan->image;
    names[1] = plan->points;
    names[2] = plan->mesh;
    names[3] = plan->json;
    names[4] = plan->aov;
}

/* stdout may be named by one output only, but that is checked with the options. */
static iso_status check_distinct(const isorender_plan *a, const isorender_plan *b, iso_error *error) {
    const char *first[NAMES], *second[NAMES];
    names_of(a, first);
    names_of(b, second);
    for (int i = 0; i < NAMES; i++)
        for (int j = a == b ? i + 1 : 0; j < NAMES; j++)
            if (first[i] && second[j] && strcmp(first[i], second[j]) == 0)
                return iso_fail(error, ISO_ERR_USAGE, "%s: two outputs have this name", first[i]);
    return ISO_OK;
}

static iso_status check_inputs_safe(const isorender_plan *plan, iso_error *error) {
    const char *names[NAMES];
    names_of(plan, names);
    for (int i = 0; i < NAMES; i++)
        if (names[i] && iso_file_same(plan->input, names[i]))
            return iso_fail(error, ISO_ERR_USAGE, "%s: an output would overwrite the input", names[i]);
    return ISO_OK;
}

static iso_status check_all(const isorender_plan *plans, int count, iso_error *error) {
    for (int i = 0; i < count; i++) {
        ISO_TRY(check_inputs_safe(&plans[i], error));
        for (int j = 0; j <= i; j++) ISO_TRY(check_distinct(&plans[j], &plans[i], error));
    }
    return ISO_OK;
}

static iso_status make_all(const isorender_settings *settings, isorender_plan *plans, iso_error *error) {
    for (int i = 0; i < settings->input_count; i++) {
        if (settings->scene) ISO_TRY(scene_input(settings->scene, &plans[i].scene, error));
        plans[i].input = settings->scene ? plans[i].scene : settings->inputs[i];
        ISO_TRY(make_names(settings, i, &plans[i], error));
    }
    return check_all(plans, settings->input_count, error);
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
    for (int i = 0; plans && i < count; i++) {
        free(plans[i].scene);
        free(plans[i].model);
        free(plans[i].image);
        free(plans[i].aov);
        free(plans[i].points);
        free(plans[i].mesh);
        free(plans[i].json);
    }
    free(plans);
}

bool isorender_plan_draws(const isorender_plan *plan) {
    return plan->image || plan->aov;
}

iso_status isorender_plan_frame(const char *name, int frame, char **path, iso_error *error) {
    return iso_template_expand(name, NULL, frame, path, error);
}

static iso_status check_writable(const char *path, iso_error *error) {
    if (!path || strcmp(path, "-") == 0) return ISO_OK;
    struct stat info;
    /* A pipe that is opened and closed has ended for its reader. */
    if (stat(path, &info) == 0 && !S_ISREG(info.st_mode) && !S_ISDIR(info.st_mode)) return ISO_OK;
    iso_sink sink = {0};
    ISO_TRY(iso_sink_open(path, &sink, error));
    iso_sink_abort(&sink);
    return ISO_OK;
}

static iso_status check_first_frame(const char *name, iso_error *error) {
    if (!name) return ISO_OK;
    char *first = NULL;
    ISO_TRY(isorender_plan_frame(name, 0, &first, error));
    iso_status status = check_writable(first, error);
    free(first);
    return status;
}

iso_status isorender_plan_check_writable(const isorender_plan *plan, iso_error *error) {
    ISO_TRY(check_first_frame(plan->image, error));
    if (plan->aov && !iso_exr_available())
        return iso_fail(error, ISO_ERR_UNSUPPORTED, "%s: built without OpenEXR", plan->aov);
    ISO_TRY(check_first_frame(plan->aov, error));
    ISO_TRY(check_writable(plan->points, error));
    ISO_TRY(check_writable(plan->mesh, error));
    return check_writable(plan->json, error);
}
