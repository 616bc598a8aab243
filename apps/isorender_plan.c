/* Names of the outputs of every input, and the refusal of names that would destroy something. */
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "apps/isorender.h"
#include "apps/template.h"
#include "base/file.h"

static iso_status make_names(const isorender_settings *settings, int number, isorender_plan *plan,
                             iso_error *error) {
    ISO_TRY(iso_template_model(plan->input, &plan->model, error));
    if (settings->points)
        ISO_TRY(iso_template_expand(settings->points, plan->model, number, &plan->points, error));
    if (settings->mesh) ISO_TRY(iso_template_expand(settings->mesh, plan->model, number, &plan->mesh, error));
    if (settings->json_path)
        ISO_TRY(iso_template_expand(settings->json_path, plan->model, number, &plan->json, error));
    if (settings->no_image || settings->info) return ISO_OK;
    const char *output = settings->output ? settings->output : "{model}.png";
    if (!settings->turntable) return iso_template_expand(output, plan->model, number, &plan->image, error);
    /* A turntable's {n} numbers its frames. */
    int digits = 3;
    for (int frames = settings->turntable; frames > 1000; frames = (frames + 9) / 10) digits++;
    char *numbered = NULL;
    ISO_TRY(iso_template_numbered(output, digits, &numbered, error));
    iso_status status = iso_template_expand(numbered, plan->model, -1, &plan->image, error);
    free(numbered);
    return status;
}

static iso_status scene_input(const char *scene, char **input, iso_error *error) {
    size_t size = strlen(scene) + sizeof "scene:";
    *input = malloc(size);
    if (!*input) return iso_fail(error, ISO_ERR_NOMEM, "out of memory");
    snprintf(*input, size, "scene:%s", scene);
    return ISO_OK;
}

/* ---- collisions ---- */

enum { NAMES = 4 };

static void names_of(const isorender_plan *plan, const char *names[NAMES]) {
    names[0] = plan->image;
    names[1] = plan->points;
    names[2] = plan->mesh;
    names[3] = plan->json;
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
        free(plans[i].points);
        free(plans[i].mesh);
        free(plans[i].json);
    }
    free(plans);
}

iso_status isorender_plan_frame(const isorender_plan *plan, int frame, char **path, iso_error *error) {
    return iso_template_expand(plan->image, NULL, frame, path, error);
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

iso_status isorender_plan_check_writable(const isorender_plan *plan, iso_error *error) {
    if (plan->image) {
        char *first = NULL;
        ISO_TRY(isorender_plan_frame(plan, 0, &first, error));
        iso_status status = check_writable(first, error);
        free(first);
        ISO_TRY(status);
    }
    ISO_TRY(check_writable(plan->points, error));
    ISO_TRY(check_writable(plan->mesh, error));
    return check_writable(plan->json, error);
}
