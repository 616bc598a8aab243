/* Scenes: written from the options of a command line, and read back into one. */
#define _GNU_SOURCE /* asprintf */
#include "apps/isorender/scene_file.h"

#include <errno.h>
#include <jansson.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "apps/isorender/labels.h"
#include "base/file.h"
#include "base/file_identity.h"
#include "base/file_types.h"
#include "base/text.h"
#include "image/image_file.h"
#include "image/png_text.h"

/* The version of the form of scenes. */
enum { SCENE = 1 };
/* Larger files hold no scene, bytes. */
enum { MOST_BYTES = 1 << 24 };

static const char *base_name(const char *path) {
    const char *slash = strrchr(path, '/');
    return slash ? slash + 1 : path;
}

/* ---- writing */

/* A number made of a file's size and a few blocks of it, as text; false: it is no regular file, or *failed:
 * there was no memory. */
static bool find_fingerprint(const char *path, char text[17], bool *failed) {
    iso_file_set set = {0};
    iso_file_set_read(&set, path);
    const bool regular = set.count > 0 && !set.incomplete;
    *failed |= set.incomplete;
    if (regular) snprintf(text, 17, "%016llx", (unsigned long long)iso_file_set_content(&set));
    iso_file_set_free(&set);
    return regular;
}

/* Where a scene is written to, and what decides how paths stand in it. */
typedef struct target {
    const isorender_settings *settings;
    const char *file; /* of its own; NULL: a text in a PNG */
} target;

/* Length of the path of the folder that a file is in, with the slash; 0: the working directory. */
static int folder_length(const char *path) {
    return (int)(base_name(path) - path);
}

/* A path without the folder of a file that is in the same one; else NULL. */
static const char *without_folder(const char *path, const char *file) {
    const int length = file ? folder_length(file) : 0;
    return length && strncmp(path, file, (size_t)length) == 0 ? path + length : NULL;
}

/* Adds a path: in a PNG never an absolute one, and as in the scene that the picture was drawn from; in a file
 * of its own relative to that, or an absolute one. */
static void put_path(iso_json *json, const char *key, const char *path, const target *to) {
    const char *inside = without_folder(path, to->file ? to->file : to->settings->scene_file);
    errno = 0;
    char *whole = to->file && !inside && folder_length(to->file) ? realpath(path, NULL) : NULL;
    json->failed |= !whole && errno == ENOMEM;
    iso_json_string(json, key,
                    inside                        ? inside
                    : whole                       ? whole
                    : !to->file && path[0] == '/' ? base_name(path)
                                                  : path);
    free(whole);
}

static void put_file(iso_json *json, const char *path, const target *to) {
    char text[17];
    if (!find_fingerprint(path, text, &json->failed)) return;
    iso_json_begin_object(json, NULL);
    put_path(json, "path", path, to);
    iso_json_string(json, "fingerprint", text);
    iso_json_end_object(json);
}

static void put_option(iso_json *json, const isorender_noted *noted, const target *to) {
    const char *name = noted->option->name, *value = noted->value;
    iso_json_begin_object(json, NULL);
    if (!value)
        iso_json_bool(json, name, true);
    else if (noted->option->flags & ISO_OPTION_READS)
        put_path(json, name, value, to);
    else
        iso_json_string(json, name, value);
    iso_json_end_object(json);
}

static void put_camera(iso_json *json, const iso_camera *camera) {
    const double position[] = {camera->position.x, camera->position.y, camera->position.z},
                 focal_point[] = {camera->focal_point.x, camera->focal_point.y, camera->focal_point.z},
                 view_up[] = {camera->view_up.x, camera->view_up.y, camera->view_up.z};
    iso_json_begin_object(json, "camera");
    iso_json_reals(json, "position", position, 3);
    iso_json_reals(json, "focal_point", focal_point, 3);
    iso_json_reals(json, "view_up", view_up, 3);
    iso_json_real(json, "view_angle", camera->view_angle);
    iso_json_bool(json, "orthographic", camera->orthographic);
    iso_json_real(json, "parallel_scale", camera->parallel_scale);
    iso_json_end_object(json);
}

static bool has_input(const isorender_job *job) {
    return !job->settings->no_input && !job->settings->scene;
}

/* `file`: of its own; NULL: a text in a PNG. */
static void put_scene(iso_json *json, const isorender_job *job, const char *file) {
    const isorender_settings *settings = job->settings;
    const target to = {settings, file};
    iso_json_begin_object(json, NULL);
    iso_json_integer(json, "scene", SCENE);
    iso_json_string(json, "isorender", isorender_program()->version);
    if (has_input(job)) put_path(json, "input", job->plan->input, &to);
    iso_json_begin_array(json, "options");
    for (int i = 0; i < settings->noted_count; i++) put_option(json, &settings->noted[i], &to);
    if (*isorender_camera_record(job)) {
        iso_json_begin_object(json, NULL);
        iso_json_string(json, "fit", "box");
        iso_json_end_object(json);
    }
    iso_json_end_array(json);
    iso_json_begin_array(json, "files");
    if (has_input(job)) put_file(json, job->plan->input, &to);
    for (int i = 0; i < settings->noted_count; i++)
        if (settings->noted[i].option->flags & ISO_OPTION_READS)
            put_file(json, settings->noted[i].value, &to);
    iso_json_end_array(json);
    if (file) {
        put_camera(json, &job->camera);
        iso_json_begin_array(json, "isovalues");
        for (int i = 0; i < job->surface_count; i++)
            iso_json_real(json, NULL, job->surfaces[i].scene.isovalue);
        iso_json_end_array(json);
    }
    iso_json_end_object(json);
}

iso_status isorender_scene_text(const isorender_job *job, char **text, iso_error *error) {
    char *line = NULL;
    size_t bytes = 0;
    *text = NULL;
    if (job->settings->noted_count > ISORENDER_NOTED) return ISO_OK;
    FILE *stream = open_memstream(&line, &bytes);
    if (!stream) return iso_fail(error, ISO_ERR_NOMEM, "out of memory");
    iso_json json = {.one_line = true};
    put_scene(&json, job, NULL);
    iso_status status = iso_json_write(&json, stream, error);
    if (!iso_memory_stream_close(stream, &line) && status == ISO_OK)
        status = iso_fail(error, ISO_ERR_NOMEM, "out of memory");
    if (status != ISO_OK) {
        free(line);
        return status;
    }
    line[strcspn(line, "\n")] = 0;
    *text = line;
    return ISO_OK;
}

iso_status isorender_scene_save(const isorender_job *job, iso_error *error) {
    iso_sink sink;
    iso_json json = {0};
    if (!job->plan->scene_file) return ISO_OK;
    if (job->settings->noted_count > ISORENDER_NOTED)
        return iso_fail(error, ISO_ERR_LIMIT, "--save-scene: more than %d options", ISORENDER_NOTED);
    ISO_TRY(iso_sink_open(job->plan->scene_file, &sink, error));
    put_scene(&json, job, job->plan->scene_file);
    return iso_json_commit(&json, &sink, error);
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
    iso_json_integer(&json, "const", SCENE);
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

static iso_status read_text(const char *path, char **text, iso_error *error) {
    FILE *stream;
    uint64_t bytes;
    ISO_TRY(iso_file_open(path, &stream, &bytes, error));
    *text = bytes < MOST_BYTES ? malloc((size_t)bytes + 1) : NULL;
    const size_t got = *text ? fread(*text, 1, (size_t)bytes, stream) : 0;
    fclose(stream);
    if (bytes >= MOST_BYTES) return iso_fail(error, ISO_ERR_FORMAT, "%s: is too large for a scene", path);
    if (!*text) return iso_fail_memory(error, path);
    (*text)[got] = 0;
    return ISO_OK;
}

/* Sets *scene to NULL if the file is JSON of something else. */
static iso_status read_scene(const char *path, json_t **scene, iso_error *error) {
    char *text = NULL;
    json_error_t reason;
    *scene = NULL;
    const bool is_png = iso_file_type_of_name(path, ISO_HOLDS_SCENE) == ISO_FILE_png;
    ISO_TRY(is_png ? iso_png_read_text(path, "Scene", &text, error) : read_text(path, &text, error));
    *scene = json_loads(text, JSON_REJECT_DUPLICATES, &reason);
    free(text);
    if (!*scene) return iso_fail(error, ISO_ERR_FORMAT, "%s: line %d: %s", path, reason.line, reason.text);
    if (json_is_object(*scene) && json_object_get(*scene, "scene")) return ISO_OK;
    json_decref(*scene);
    *scene = NULL;
    return ISO_OK;
}

/* The path of a scene's file: as it stands there, or beside the scene; of one that is nowhere the first of
 * both. The caller's, NULL: no memory. */
static char *find_file(const char *scene_path, const char *path) {
    const int folder = folder_length(scene_path);
    const char *names[] = {path, base_name(path)};
    for (int i = 0; i < 2; i++) {
        char *beside = NULL;
        if (names[i][0] == '/' ? (beside = strdup(names[i])) == NULL
                               : asprintf(&beside, "%.*s%s", folder, scene_path, names[i]) < 0)
            return NULL;
        if (access(beside, F_OK) == 0) return beside;
        free(beside);
    }
    char *missing = NULL;
    const bool is_whole = path[0] == '/' || iso_loader_is_scene(path) || strcmp(path, "-") == 0;
    return asprintf(&missing, "%.*s%s", is_whole ? 0 : folder, scene_path, path) < 0 ? NULL : missing;
}

/* A command line under construction. */
typedef struct builder {
    const char *path;    /* of the scene */
    bool replaces_input; /* the command line has an input of its own */
    char **made;         /* strings, with room for all */
    int count;
} builder;

static iso_status add(builder *b, char *text, iso_error *error) {
    if (!text) return iso_fail(error, ISO_ERR_NOMEM, "out of memory");
    b->made[b->count++] = text;
    return ISO_OK;
}

/* Adds the input, which must not be taken for an option or a command when it is called like one. */
static iso_status add_input(builder *b, const char *input, iso_error *error) {
    char *found = find_file(b->path, input), *operand = NULL;
    const bool is_plain = found && !strchr(found, '/') && strcmp(found, "-") != 0,
               is_word =
                   is_plain && (found[0] == '-' || strcmp(found, "merge") == 0 || strcmp(found, "help") == 0);
    if (!is_word) return add(b, found, error);
    if (asprintf(&operand, "./%s", found) < 0) operand = NULL;
    free(found);
    return add(b, operand, error);
}

static iso_status add_option(builder *b, const char *name, json_t *value, iso_error *error) {
    const iso_option *option = iso_options_find(isorender_program(), name, strlen(name));
    char *text = NULL;
    if (!option || strcmp(option->name, name) != 0)
        return iso_fail(error, ISO_ERR_FORMAT, "%s: there is no option '%s'", b->path, name);
    if (option->flags & ISO_OPTION_UNRECORDED)
        return iso_fail(error, ISO_ERR_FORMAT,
                        "%s: '%s' does not belong to a scene: it is for the command line", b->path, name);
    if (json_is_true(value)) {
        if (asprintf(&text, "--%s", name) < 0) text = NULL;
        return add(b, text, error);
    }
    if (!json_is_string(value) && !json_is_number(value))
        return iso_fail(error, ISO_ERR_FORMAT, "%s: the value of '%s' is no text, number or true", b->path,
                        name);
    char *file = NULL, *number = json_is_number(value) ? json_dumps(value, JSON_ENCODE_ANY) : NULL;
    const char *given = number ? number : json_string_value(value);
    if (option->flags & ISO_OPTION_READS && given) given = file = find_file(b->path, given);
    if (!given || asprintf(&text, "--%s=%s", name, given) < 0) text = NULL;
    free(file);
    free(number);
    return add(b, text, error);
}

/* Refuses a scene of which a file has changed. */
static iso_status check_file(const char *scene_path, const json_t *file, iso_error *error) {
    const char *path = json_string_value(json_object_get(file, "path")),
               *known = json_string_value(json_object_get(file, "fingerprint"));
    char now[17];
    if (!path || !known)
        return iso_fail(error, ISO_ERR_FORMAT, "%s: a file without path and fingerprint", scene_path);
    char *found = find_file(scene_path, path);
    if (!found) return iso_fail(error, ISO_ERR_NOMEM, "out of memory");
    bool failed = false;
    const bool same = !find_fingerprint(found, now, &failed) || strcmp(now, known) == 0;
    free(found);
    if (failed) return iso_fail(error, ISO_ERR_NOMEM, "out of memory");
    if (same) return ISO_OK;
    return iso_fail(error, ISO_ERR_FORMAT,
                    "%s: %s is not the file that it was drawn from (a file named behind the scene is taken "
                    "whatever it holds)",
                    scene_path, path);
}

static iso_status add_scene(builder *b, json_t *scene, iso_error *error) {
    const char *input = json_string_value(json_object_get(scene, "input")), *name;
    json_t *options = json_object_get(scene, "options"), *option, *value, *file;
    size_t i;
    if (json_integer_value(json_object_get(scene, "scene")) != SCENE)
        return iso_fail(error, ISO_ERR_FORMAT, "%s: a scene of another version than %d", b->path, SCENE);
    if (!json_is_array(options))
        return iso_fail(error, ISO_ERR_FORMAT, "%s: a scene has a list of options", b->path);
    json_array_foreach(options, i, option) {
        if (json_object_size(option) != 1)
            return iso_fail(error, ISO_ERR_FORMAT, "%s: option %zu is not one name with its value", b->path,
                            i + 1);
        json_object_foreach(option, name, value) ISO_TRY(add_option(b, name, value, error));
    }
    json_array_foreach(json_object_get(scene, "files"), i, file) {
        const char *path = json_string_value(json_object_get(file, "path"));
        const bool replaced = b->replaces_input && input && path && strcmp(path, input) == 0;
        if (!replaced) ISO_TRY(check_file(b->path, file, error));
    }
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
    ISO_TRY(read_scene(b->path, &scene, error));
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
    const iso_status status = read_scene(operand, &scene, NULL);
    json_decref(scene);
    return scene != NULL || status != ISO_OK;
}

/* Whether an operand that is no scene is an input. Pictures are outputs, but for TIFF files that are there.
 * */
static bool is_input(const char *operand) {
    const iso_image_kind kind = iso_image_kind_of(operand);
    return kind == ISO_IMAGE_UNKNOWN || (kind == ISO_IMAGE_TIFF && access(operand, F_OK) == 0);
}

static iso_status list_scenes(int argc, char **argv, iso_texts *scenes, bool *replaces_input,
                              iso_error *error) {
    isorender_settings *parsed = calloc(1, sizeof *parsed);
    iso_operands operands = {calloc((size_t)argc + 1, sizeof *operands.values), 0};
    iso_status status = ISO_OK;
    if (!parsed || !operands.values)
        status = iso_fail(error, ISO_ERR_NOMEM, "out of memory");
    else if (iso_options_parse(isorender_program(), argc, argv, parsed, &operands, NULL) == ISO_OK) {
        *scenes = parsed->again;
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
    bool replaces_input = false;
    *commands = (isorender_commands){.items = NULL};
    if (argc > 1 && strcmp(argv[1], "merge") == 0) return ISO_OK;
    ISO_TRY(list_scenes(argc, argv, &scenes, &replaces_input, error));
    if (!scenes.count) return ISO_OK;
    if (scenes.count > 1 && iso_ranks_are_several())
        return iso_fail(error, ISO_ERR_USAGE, "mpirun draws one picture, not %d scenes", scenes.count);
    commands->items = calloc((size_t)scenes.count, sizeof *commands->items);
    if (!commands->items) return iso_fail(error, ISO_ERR_NOMEM, "out of memory");
    iso_status status = ISO_OK;
    for (int i = 0; i < scenes.count && status == ISO_OK; i++) {
        builder b = {.path = scenes.values[i], .replaces_input = replaces_input};
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
