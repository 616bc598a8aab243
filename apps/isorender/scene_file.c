/* Scenes: written from the options of a command line, and read back into one. */
#include "apps/isorender/scene_file.h"

#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "apps/common/page.h"
#include "apps/common/scene_json.h"
#include "apps/common/value_path.h"
#include "apps/isorender/picture_record.h"
#include "base/file_types.h"

/* ---- writing */

static bool has_input(const isorender_job *job) {
    const isorender_settings *settings = job->settings;
    return (!settings->no_input || settings->smooth) && !settings->scene && !settings->series_of;
}

enum { VIEW_OPTIONS = 6 };

/* The options of a scene. `values`: of those that no command line has. */
typedef struct scene_options {
    iso_scene_option list[ISORENDER_NOTED + VIEW_OPTIONS];
    int count;
    char values[VIEW_OPTIONS][96];
    int value_count;
} scene_options;

/* Adds an option with one number (`count` 1) or a vector (3), with all bits. */
static void add_numbers(scene_options *to, const char *name, const double *numbers, int count) {
    char *value = to->values[to->value_count++];
    snprintf(value, sizeof to->values[0], "%.17g", numbers[0]);
    if (count == 3)
        snprintf(value, sizeof to->values[0], "%.17g,%.17g,%.17g", numbers[0], numbers[1], numbers[2]);
    to->list[to->count++] = (iso_scene_option){name, value, false, false};
}

static void add_vector(scene_options *to, const char *name, iso_vec3 v) {
    add_numbers(to, name, (const double[]){v.x, v.y, v.z}, 3);
}

/* The millimetres of a pixel that give a parallel scale again: the quotient, or a number beside it. */
static double pixel_of_scale(double scale, int height) {
    const double quotient = scale * 2 / height;
    for (double pixel = quotient * (1 - 4e-16); pixel <= quotient * (1 + 4e-16);
         pixel = nextafter(pixel, INFINITY))
        if (pixel * height / 2 == scale) return pixel;
    return quotient;
}

/* What --same-view took from an input before: a picture must not need that one to be drawn again. */
static void add_view(const isorender_job *job, scene_options *to) {
    const isorender_settings *settings = job->settings;
    const iso_camera *camera = &job->camera;
    add_vector(to, "camera-position", camera->position);
    add_vector(to, "camera-focal-point", camera->focal_point);
    add_vector(to, "camera-view-up", camera->view_up);
    if (camera->orthographic) {
        const double pixel = pixel_of_scale(camera->parallel_scale, settings->height);
        add_numbers(to, "mm-per-pixel", &pixel, 1);
    } else
        add_numbers(to, "view-angle", &camera->view_angle, 1);
    if (!settings->isovalue_count && job->has_volume && job->input_surface_count &&
        !isnan(settings->first->isovalue))
        add_numbers(to, "isovalue", &settings->first->isovalue, 1);
}

/* Whether an option says which camera there is, so that it is not noted beside the camera itself. */
static bool is_of_view(const char *name) {
    static const char *const names[] = {"same-view",
                                        "camera",
                                        "up",
                                        "azimuth",
                                        "elevation",
                                        "zoom",
                                        "orthographic",
                                        "mm-per-pixel",
                                        "fit",
                                        "margin",
                                        "view-angle",
                                        "camera-position",
                                        "camera-view-up",
                                        "camera-focal-point"};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        if (strcmp(name, names[i]) == 0) return true;
    return false;
}

/* Whether a scene states the view that --same-view took; a series, which is one scene, has it by itself. */
static bool states_view(const isorender_job *job) {
    return job->shares_view && !job->settings->series_of;
}

static void list_options(const isorender_job *job, scene_options *options) {
    const isorender_settings *settings = job->settings;
    const bool shared = states_view(job);
    options->count = options->value_count = 0;
    for (int i = 0; i < settings->noted_count; i++) {
        const isorender_noted *noted = &settings->noted[i];
        if (shared && is_of_view(noted->option->name)) continue;
        options->list[options->count++] = (iso_scene_option){
            noted->option->name, noted->value, (noted->option->flags & ISO_OPTION_READS) != 0,
            (noted->option->flags & ISO_OPTION_READS_PART) != 0};
    }
    if (shared)
        add_view(job, options);
    else if (*isorender_camera_record(job))
        options->list[options->count++] = (iso_scene_option){"fit", "box", false, false};
}

/* `options` is set, and borrowed. */
static iso_scene_record make_record(const isorender_job *job, scene_options *options) {
    list_options(job, options);
    return (iso_scene_record){.version = isorender_program()->version,
                              .input = has_input(job) ? job->plan->input : NULL,
                              .options = options->list,
                              .option_count = options->count,
                              .from = job->settings->scene_file};
}

iso_status isorender_scene_text(const isorender_job *job, char **text, iso_error *error) {
    scene_options options;
    *text = NULL;
    if (job->settings->noted_count > ISORENDER_NOTED) return ISO_OK;
    const iso_scene_record record = make_record(job, &options);
    return iso_scene_json_text(&record, text, error);
}

void isorender_scene_command(const isorender_job *job, char *text, size_t size) {
    const size_t used = strlen(text);
    iso_common_settings shared = {.record = ""};
    scene_options options = {.count = 0};
    if (states_view(job) && job->settings->noted_count <= ISORENDER_NOTED) list_options(job, &options);
    for (int i = 0; i < options.count; i++) {
        const char *name = options.list[i].name;
        iso_settings_record_option(&shared, iso_options_find(isorender_program(), name, strlen(name)),
                                   options.list[i].value);
    }
    snprintf(text + used, size - used, "%s%s", options.count ? shared.record : job->settings->common.record,
             options.count ? "" : isorender_camera_record(job));
}

iso_status isorender_scene_save(const isorender_job *job, iso_error *error) {
    scene_options options;
    double isovalues[ISORENDER_SURFACES];
    if (!job->plan->scene_file) return ISO_OK;
    if (job->settings->noted_count > ISORENDER_NOTED)
        return iso_fail(error, ISO_ERR_LIMIT, "--save-scene: more than %d options", ISORENDER_NOTED);
    for (int i = 0; i < job->surface_count; i++) isovalues[i] = job->surfaces[i].scene.isovalue;
    iso_scene_record record = make_record(job, &options);
    record.camera = &job->camera;
    record.isovalues = isovalues;
    record.isovalue_count = job->surface_count;
    return iso_scene_json_save(&record, job->plan->scene_file, error);
}

/* ---- the schema */

static void put_type(iso_json *json, const char *key, const char *type, const char *description) {
    iso_json_begin_object(json, key);
    iso_json_string(json, "type", type);
    if (description) iso_json_string(json, "description", description);
    iso_json_end_object(json);
}

static void put_option_schema(iso_json *json, const iso_option *option) {
    if (option->flags & (ISO_OPTION_UNRECORDED | ISO_OPTION_HIDDEN)) return;
    iso_json_begin_object(json, option->name);
    if (!option->value || option->flags & ISO_OPTION_VALUE_OPTIONAL) {
        iso_json_begin_array(json, "type");
        iso_json_string(json, NULL, "boolean");
        if (option->value) iso_json_string(json, NULL, "string");
        iso_json_end_array(json);
    } else
        iso_json_string(json, "type", "string");
    char help[1024];
    iso_options_expand(option->help, help, sizeof help);
    iso_json_string(json, "description", help);
    iso_json_end_object(json);
}

iso_status isorender_scene_print_schema(iso_error *error) {
    const iso_program *program = isorender_program();
    iso_json json = {0};
    iso_json_begin_object(&json, NULL);
    iso_json_string(&json, "$schema", "https://json-schema.org/draft/2020-12/schema");
    iso_json_string(&json, "title", "A scene of isorender");
    iso_json_string(&json, "type", "object");
    iso_json_begin_array(&json, "required");
    iso_json_string(&json, NULL, "scene");
    iso_json_string(&json, NULL, "options");
    iso_json_end_array(&json);
    iso_json_begin_object(&json, "properties");
    iso_json_begin_object(&json, "scene");
    iso_json_integer(&json, "const", ISO_SCENE_JSON_VERSION);
    iso_json_end_object(&json);
    put_type(&json, "isorender", "string", "the version that wrote it");
    put_type(&json, "input", "string", "the volume, points or mesh; relative to the scene's folder");
    iso_json_begin_object(&json, "options");
    iso_json_string(&json, "type", "array");
    iso_json_begin_object(&json, "items");
    iso_json_string(&json, "type", "object");
    iso_json_integer(&json, "minProperties", 1);
    iso_json_integer(&json, "maxProperties", 1);
    iso_json_bool(&json, "additionalProperties", false);
    iso_json_begin_object(&json, "properties");
    for (size_t i = 0; i < program->option_count; i++) put_option_schema(&json, &program->options[i]);
    iso_json_end_object(&json);
    iso_json_end_object(&json);
    iso_json_end_object(&json);
    put_type(&json, "files", "array", "the path and the fingerprint of each file that is read");
    put_type(&json, "camera", "object", "the camera of the first picture, as it was found; not read");
    put_type(&json, "isovalues", "array", "of all surfaces, as they were found; not read");
    iso_json_end_object(&json);
    iso_json_end_object(&json);
    return iso_json_write(&json, stdout, error);
}

/* ---- reading */

/* A command line under construction. */
typedef struct builder {
    const char *path;     /* of the scene */
    bool replaces_input;  /* the command line has an input of its own, */
    const bool *replaced; /* and these options, by their places in the table */
    char **made;          /* strings, with room for all */
    int count;
} builder;

static iso_status add(builder *b, char *text, iso_error *error) {
    if (!text) return iso_fail(error, ISO_ERR_NOMEM, "out of memory");
    b->made[b->count++] = text;
    return ISO_OK;
}

/* Adds the input, which must not be taken for an option or a command when it is called like one. */
static iso_status add_input(builder *b, const char *input, iso_error *error) {
    char *found = iso_scene_json_find(b->path, input), *operand = NULL;
    const bool is_plain = found && !strchr(found, '/') && strcmp(found, "-") != 0,
               is_word = is_plain && (found[0] == '-' || strcmp(found, "merge") == 0 ||
                                      strcmp(found, "sheet") == 0 || strcmp(found, "help") == 0);
    if (!is_word) return add(b, found, error);
    if (asprintf(&operand, "./%s", found) < 0) operand = NULL;
    free(found);
    return add(b, operand, error);
}

/* A value that may contain a path, with the path as it is found beside the scene; the caller's, NULL: no
 * memory. */
static char *find_part(const builder *b, const char *value) {
    iso_value_path at;
    char *found = NULL, *made = NULL;
    if (!iso_value_path_find(value, b->path, &at, &found)) return strdup(value);
    if (asprintf(&made, "%.*s%s%s", (int)at.begin, value, found, value + at.begin + at.length) < 0)
        made = NULL;
    free(found);
    return made;
}

static iso_status add_option(builder *b, const char *name, json_t *value, iso_error *error) {
    const iso_option *option = iso_options_find(isorender_program(), name, strlen(name));
    char *text = NULL;
    if (!option || strcmp(option->name, name) != 0)
        return iso_fail(error, ISO_ERR_FORMAT, "%s: there is no option '%s'", b->path, name);
    if (option->flags & ISO_OPTION_UNRECORDED)
        return iso_fail(error, ISO_ERR_FORMAT,
                        "%s: '%s' does not belong to a scene: it is for the command line", b->path, name);
    if (b->replaced[option - isorender_program()->options]) return ISO_OK;
    if (json_is_true(value)) {
        if (asprintf(&text, "--%s", name) < 0) text = NULL;
        return add(b, text, error);
    }
    if (!json_is_string(value) && !json_is_number(value))
        return iso_fail(error, ISO_ERR_FORMAT, "%s: the value of '%s' is no text, number or true", b->path,
                        name);
    char *file = NULL, *number = json_is_number(value) ? json_dumps(value, JSON_ENCODE_ANY) : NULL;
    const char *given = number ? number : json_string_value(value);
    if (option->flags & ISO_OPTION_READS && given) given = file = iso_scene_json_find(b->path, given);
    if (option->flags & ISO_OPTION_READS_PART && given) given = file = find_part(b, given);
    if (!given || asprintf(&text, "--%s=%s", name, given) < 0) text = NULL;
    free(file);
    free(number);
    return add(b, text, error);
}

/* What is asked of a file of a scene: whether the input, or an option that is not replaced, names it. */
typedef struct file_question {
    const builder *b;
    const json_t *scene;
} file_question;

static bool is_read(void *context, const char *path) {
    const file_question *q = context;
    const iso_program *program = isorender_program();
    const char *input = json_string_value(json_object_get(q->scene, "input")), *name;
    json_t *option, *value;
    size_t i;
    bool named = false, kept = false;
    if (input && strcmp(input, path) == 0) named = true, kept = !q->b->replaces_input;
    json_array_foreach(json_object_get(q->scene, "options"), i, option) {
        json_object_foreach(option, name, value) {
            const iso_option *known = iso_options_find(program, name, strlen(name));
            if (!known || !json_is_string(value) || !strstr(json_string_value(value), path)) continue;
            named = true;
            kept |= !q->b->replaced[known - program->options];
        }
    }
    return kept || !named;
}

static iso_status add_scene(builder *b, json_t *scene, iso_error *error) {
    const char *input = json_string_value(json_object_get(scene, "input")), *name;
    json_t *options = json_object_get(scene, "options"), *option, *value;
    size_t i;
    json_array_foreach(options, i, option) {
        json_object_foreach(option, name, value) ISO_TRY(add_option(b, name, value, error));
    }
    file_question question = {b, scene};
    ISO_TRY(iso_scene_json_check_files(b->path, scene, is_read, &question, error));
    return input && !b->replaces_input ? add_input(b, input, error) : ISO_OK;
}

/* Whether an argument is left out of the command lines of scenes: --again, and the scenes themselves. */
static bool is_left_out(char *const *argv, int i, const iso_texts *scenes) {
    static const char again[] = "--again";
    for (int k = 0; k < scenes->count; k++)
        if (argv[i] == scenes->values[k]) return true;
    const size_t length = sizeof again - 1;
    return strncmp(argv[i], again, length) == 0 && (argv[i][length] == '=' || !argv[i][length]);
}

static iso_status make_command(int argc, char **argv, const iso_texts *scenes, builder *b,
                               isorender_command *command, iso_error *error) {
    json_t *scene;
    ISO_TRY(iso_scene_json_read(b->path, &scene, error));
    if (!scene)
        return iso_fail(error, ISO_ERR_FORMAT, "%s: holds no scene of isorender (--save-scene writes one)",
                        b->path);
    const size_t room = json_array_size(json_object_get(scene, "options")) + 2;
    b->made = command->made = calloc(room, sizeof *b->made);
    iso_status status =
        b->made ? add_scene(b, scene, error) : iso_fail(error, ISO_ERR_NOMEM, "out of memory");
    json_decref(scene);
    ISO_TRY(status);
    command->argv = calloc((size_t)argc + room + 2, sizeof *command->argv);
    if (!command->argv) return iso_fail(error, ISO_ERR_NOMEM, "out of memory");
    command->argv[command->argc++] = argv[0];
    for (int i = 0; i < b->count; i++) command->argv[command->argc++] = b->made[i];
    for (int i = 1; i < argc; i++)
        if (!is_left_out(argv, i, scenes)) command->argv[command->argc++] = argv[i];
    return ISO_OK;
}

/* Whether an operand of the command line is a file that holds a scene, or should: it is no JSON. */
static bool is_scene(const char *operand) {
    json_t *scene = NULL;
    if (iso_file_type_of_name(operand, ISO_HOLDS_SCENE) != ISO_FILE_json || access(operand, F_OK) != 0)
        return false;
    const iso_status status = iso_scene_json_read(operand, &scene, NULL);
    json_decref(scene);
    return scene != NULL || status != ISO_OK;
}

/* Whether an operand that is no scene is an input. Pictures are outputs, but for TIFF files that are there.
 */
static bool is_input(const char *operand) {
    const iso_image_kind kind = iso_image_kind_of(operand);
    if (iso_page_is_named(operand)) return false;
    if (kind == ISO_IMAGE_TIFF) return access(operand, F_OK) == 0;
    return kind == ISO_IMAGE_UNKNOWN && !iso_video_is_name(operand);
}

static iso_status list_scenes(int argc, char **argv, iso_texts *scenes, bool *replaces_input,
                              bool replaced[ISORENDER_MOST_OPTIONS], iso_error *error) {
    isorender_settings *parsed = calloc(1, sizeof *parsed);
    iso_operands operands = {calloc((size_t)argc + 1, sizeof *operands.values), 0};
    iso_status status = ISO_OK;
    if (!parsed || !operands.values)
        status = iso_fail(error, ISO_ERR_NOMEM, "out of memory");
    else if (iso_options_parse(isorender_program(), argc, argv, parsed, &operands, NULL) == ISO_OK) {
        *scenes = parsed->again;
        for (int i = 0; i < ISORENDER_MOST_OPTIONS; i++) replaced[i] = parsed->given[i] != 0;
        for (int i = 0; i < operands.count && status == ISO_OK; i++) {
            const bool found = is_scene(operands.values[i]);
            *replaces_input |= !found && is_input(operands.values[i]);
            if (found && scenes->count == ISO_TEXTS)
                status = iso_fail(error, ISO_ERR_USAGE, "more than %d scenes", ISO_TEXTS);
            else if (found)
                scenes->values[scenes->count++] = operands.values[i];
        }
    }
    free(parsed);
    free(operands.values);
    return status;
}

iso_status isorender_commands_make(int argc, char **argv, isorender_commands *commands, iso_error *error) {
    iso_texts scenes = {.count = 0};
    bool replaces_input = false, replaced[ISORENDER_MOST_OPTIONS] = {false};
    *commands = (isorender_commands){.items = NULL};
    if (argc > 1 && (strcmp(argv[1], "merge") == 0 || strcmp(argv[1], "sheet") == 0)) return ISO_OK;
    ISO_TRY(list_scenes(argc, argv, &scenes, &replaces_input, replaced, error));
    if (!scenes.count) return ISO_OK;
    if (scenes.count > 1 && iso_ranks_are_several())
        return iso_fail(error, ISO_ERR_USAGE, "mpirun draws one picture, not %d scenes", scenes.count);
    commands->items = calloc((size_t)scenes.count, sizeof *commands->items);
    if (!commands->items) return iso_fail(error, ISO_ERR_NOMEM, "out of memory");
    iso_status status = ISO_OK;
    for (int i = 0; i < scenes.count && status == ISO_OK; i++) {
        builder b = {.path = scenes.values[i], .replaces_input = replaces_input, .replaced = replaced};
        commands->items[i].path = b.path;
        commands->count = i + 1;
        status = make_command(argc, argv, &scenes, &b, &commands->items[i], error);
    }
    if (status != ISO_OK) isorender_commands_free(commands);
    return status;
}

void isorender_commands_free(isorender_commands *commands) {
    for (int i = 0; i < commands->count; i++) {
        isorender_command *command = &commands->items[i];
        for (int k = 0; command->made && command->made[k]; k++) free(command->made[k]);
        free(command->made);
        free(command->argv);
    }
    free(commands->items);
    *commands = (isorender_commands){.items = NULL};
}
