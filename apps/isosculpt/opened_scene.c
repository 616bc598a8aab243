/* opened_scene: turns a scene into the command line that opens its input, and its camera. */
#include "apps/isosculpt/opened_scene.h"

#include <jansson.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "apps/common/scene_json.h"
#include "apps/common/value_path.h"
#include "apps/isosculpt/style.h"
#include "base/file_types.h"

bool isosculpt_is_scene(const char *path) {
    return iso_file_type_of_name(path, ISO_HOLDS_SCENE) != ISO_FILE_UNKNOWN;
}

/* The text of an option's value, of which lists are cut at their first comma if `first`; the caller's:
 * free(). NULL: no memory. */
static char *text_of(const json_t *value, bool first) {
    char *text =
        json_is_string(value) ? strdup(json_string_value(value)) : json_dumps(value, JSON_ENCODE_ANY);
    if (text && first) text[strcspn(text, ",")] = 0;
    return text;
}

/* Adds --NAME=VALUE to the command line. */
static iso_status add_argument(isosculpt_opened_scene *scene, int *count, const char *name, char *value,
                               iso_error *error) {
    const int made = value ? asprintf(&scene->strings[*count], "--%s=%s", name, value) : -1;
    free(value);
    if (made < 0) {
        scene->strings[*count] = NULL;
        return iso_fail(error, ISO_ERR_NOMEM, "out of memory");
    }
    (*count)++;
    return ISO_OK;
}

static iso_vec3 vector_of(const json_t *array) {
    return iso_vec3_make(json_number_value(json_array_get(array, 0)),
                         json_number_value(json_array_get(array, 1)),
                         json_number_value(json_array_get(array, 2)));
}

/* The camera that was found for the picture. */
static void take_camera(isosculpt_opened_scene *scene, const json_t *camera) {
    const iso_camera taken = {.position = vector_of(json_object_get(camera, "position")),
                              .focal_point = vector_of(json_object_get(camera, "focal_point")),
                              .view_up = vector_of(json_object_get(camera, "view_up")),
                              .view_angle = json_number_value(json_object_get(camera, "view_angle")),
                              .orthographic = json_is_true(json_object_get(camera, "orthographic")),
                              .parallel_scale = json_number_value(json_object_get(camera, "parallel_scale"))};
    if (json_is_object(camera)) scene->camera = taken;
    scene->has_camera |= json_is_object(camera);
    scene->has_camera &= iso_camera_check(&scene->camera, NULL) == ISO_OK;
}

/* Takes a value with three numbers; false: it has none. */
static bool parse_vector(const json_t *value, iso_vec3 *vector) {
    char *text = text_of(value, false);
    double v[3];
    const bool good = text && sscanf(text, "%lf,%lf,%lf", &v[0], &v[1], &v[2]) == 3;
    if (good) *vector = iso_vec3_make(v[0], v[1], v[2]);
    free(text);
    return good;
}

/* Takes an option of the camera; a picture's scene has the camera in its options or not at all. */
static void take_camera_option(isosculpt_opened_scene *scene, const char *name, const json_t *value) {
    iso_camera *camera = &scene->camera;
    if (strcmp(name, "camera-position") == 0) scene->has_camera = parse_vector(value, &camera->position);
    if (strcmp(name, "camera-focal-point") == 0) parse_vector(value, &camera->focal_point);
    if (strcmp(name, "camera-view-up") == 0) parse_vector(value, &camera->view_up);
    if (strcmp(name, "view-angle") == 0) {
        char *text = text_of(value, false);
        if (text) camera->view_angle = strtod(text, NULL);
        free(text);
    }
}

/* Notes an option whose things or colours a window does not show. */
static void note_left_out(isosculpt_opened_scene *scene, const char *name) {
    static const char *const shown_by_isorender[] = {
        "volume", "surface",   "lines",     "glyphs", "streamlines", "labels", "smooth",     "ior", "slice",
        "aspect", "instances", "gaussians", "text",   "ruler",       "panels", "absorption", NULL};
    const size_t used = strlen(scene->left_out);
    int i = 0;
    while (shown_by_isorender[i] && strcmp(shown_by_isorender[i], name) != 0) i++;
    if (shown_by_isorender[i] && !strstr(scene->left_out, name))
        snprintf(scene->left_out + used, sizeof scene->left_out - used, "%s--%s", used ? ", " : "", name);
}

/* Adds an option of reading to the command line, or takes it for the view. */
static iso_status take_option(isosculpt_opened_scene *scene, int *count, bool *has_isovalue, const char *name,
                              const json_t *value, iso_error *error) {
    const iso_program *program = isosculpt_program();
    const iso_option *option = iso_options_find(program, name, strlen(name));
    const bool reads = option && strcmp(option->name, name) == 0 &&
                       strcmp(program->groups[option->group], ISOSCULPT_READING) == 0;
    take_camera_option(scene, name, value);
    note_left_out(scene, name);
    if (strcmp(name, "isovalue") == 0 && !*has_isovalue) {
        *has_isovalue = true;
        return add_argument(scene, count, name, text_of(value, true), error);
    }
    return reads ? add_argument(scene, count, name, text_of(value, false), error) : ISO_OK;
}

static iso_status take_scene(isosculpt_opened_scene *scene, const char *path, const json_t *json,
                             iso_error *error) {
    const char *input = json_string_value(json_object_get(json, "input")), *name;
    json_t *options = json_object_get(json, "options"), *option, *value;
    size_t i;
    bool has_isovalue = false;
    int count = 0;
    iso_operands operands = {(const char *[1]){NULL}, 0};
    if (!input)
        return iso_fail(error, ISO_ERR_FORMAT, "%s: a scene without an input, which a window needs", path);
    ISO_TRY(iso_scene_json_check_files(path, json, NULL, NULL, error));
    scene->strings = calloc(json_array_size(options) + 4, sizeof *scene->strings);
    if (!scene->strings) return iso_fail(error, ISO_ERR_NOMEM, "out of memory");
    scene->strings[count++] = strdup(isosculpt_program()->name);
    ISO_TRY(add_argument(scene, &count, "open", iso_scene_json_find(path, input), error));
    json_array_foreach(options, i, option) {
        json_object_foreach(option, name, value)
            ISO_TRY(take_option(scene, &count, &has_isovalue, name, value, error));
    }
    take_camera(scene, json_object_get(json, "camera"));
    scene->options = json_incref(options);
    return isosculpt_settings_parse(count, scene->strings, &scene->settings, &operands, error);
}

iso_status isosculpt_opened_scene_read(const char *path, isosculpt_opened_scene *scene, iso_error *error) {
    json_t *json;
    *scene = (isosculpt_opened_scene){.camera = {.view_up = {0, 0, 1}, .view_angle = 30}};
    ISO_TRY(iso_scene_json_read(path, &json, error));
    if (!json) return iso_fail(error, ISO_ERR_FORMAT, "%s: holds no scene", path);
    scene->path = strdup(path);
    const iso_status status =
        scene->path ? take_scene(scene, path, json, error) : iso_fail(error, ISO_ERR_NOMEM, "out of memory");
    json_decref(json);
    if (status != ISO_OK) isosculpt_opened_scene_free(scene);
    return status;
}

/* The value of an option, with the path of a file in it as it is found; the caller's: free(). NULL: no
 * memory. */
static char *found_text(const isosculpt_opened_scene *scene, const char *name, const json_t *value) {
    char *text = text_of(value, false), *found = NULL, *whole = NULL;
    iso_value_path at;
    if (!text || strcmp(name, "surface-color-by") != 0 ||
        !iso_value_path_find(text, scene->path, &at, &found))
        return text;
    if (asprintf(&whole, "%.*s%s%s", (int)at.begin, text, found, text + at.begin + at.length) < 0)
        whole = NULL;
    free(found);
    free(text);
    return whole;
}

/* Applies the looks of a scene, whose values others replace, or its other options. */
static iso_status apply_options(const isosculpt_opened_scene *scene, bool looks, isosculpt_viewport *viewport,
                                iso_error *error) {
    const char *name;
    json_t *option, *value;
    size_t i;
    json_array_foreach(scene->options, i, option) {
        json_object_foreach(option, name, value) {
            if ((strcmp(name, "look") == 0) != looks || !isosculpt_style_has(name)) continue;
            char *text = found_text(scene, name, value);
            if (!text) return iso_fail(error, ISO_ERR_NOMEM, "out of memory");
            const iso_status status = isosculpt_style_set(viewport, name, text, error);
            free(text);
            ISO_TRY(status);
        }
    }
    return ISO_OK;
}

iso_status isosculpt_opened_scene_apply(const isosculpt_opened_scene *scene, isosculpt_viewport *viewport,
                                        iso_error *error) {
    if (scene->has_camera) viewport->camera = scene->camera;
    if (scene->options) viewport->cut.cap.kind = ISO_CAP_NONE; /* as isorender, if it does not say */
    ISO_TRY(apply_options(scene, true, viewport, error));
    return apply_options(scene, false, viewport, error);
}

void isosculpt_opened_scene_free(isosculpt_opened_scene *scene) {
    for (int i = 0; scene->strings && scene->strings[i]; i++) free(scene->strings[i]);
    free(scene->strings);
    free(scene->path);
    json_decref(scene->options);
    *scene = (isosculpt_opened_scene){.strings = NULL};
}
