/* Scenes: written, and read as JSON. */
#include "apps/common/scene_json.h"

#include <errno.h>
#include <jansson.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "apps/common/value_path.h"
#include "base/file.h"
#include "base/file_identity.h"
#include "base/file_set.h"
#include "base/file_types.h"
#include "base/text.h"
#include "scene/loader.h"
#include "scene/picture_file.h"

/* Larger files hold no scene, bytes. */
enum { MOST_BYTES = 1 << 24 };

static const char *base_name(const char *path) {
    const char *slash = strrchr(path, '/');
    return slash ? slash + 1 : path;
}

/* Length of the path of the folder that a file is in, with the slash; 0: the working directory. */
static int folder_length(const char *path) {
    return (int)(base_name(path) - path);
}

/* A path without the folder of a file that is in the same one; else NULL. */
static const char *without_folder(const char *path, const char *file) {
    const int length = file ? folder_length(file) : 0;
    return length && strncmp(path, file, (size_t)length) == 0 ? path + length : NULL;
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

/* A path as it is written, the caller's: in a PNG never an absolute one, and as in the scene that the picture
 * was drawn from; in a file
 * of its own relative to that, or an absolute one. `file`: of its own; NULL: a text in a PNG.
 * NULL: no memory. */
static char *path_text(const char *path, const iso_scene_record *record, const char *file) {
    const char *inside = without_folder(path, file ? file : record->from);
    errno = 0;
    char *whole = file && !inside && folder_length(file) ? realpath(path, NULL) : NULL;
    if (whole) return whole;
    if (errno == ENOMEM) return NULL;
    return strdup(inside ? inside : !file && path[0] == '/' ? base_name(path) : path);
}

static void put_path(iso_json *json, const char *key, const char *path, const iso_scene_record *record,
                     const char *file) {
    char *text = path_text(path, record, file);
    json->failed |= !text;
    if (text) iso_json_string(json, key, text);
    free(text);
}

/* Adds a value that may contain a path, which is written as put_path does. */
static void put_part(iso_json *json, const iso_scene_option *option, const iso_scene_record *record,
                     const char *file) {
    iso_value_path at;
    char *found = NULL, *path = NULL, *text = NULL;
    const char *value = option->value;
    if (!iso_value_path_find(value, NULL, &at, &found)) {
        iso_json_string(json, option->name, value);
        return;
    }
    path = path_text(found, record, file);
    if (!path || asprintf(&text, "%.*s%s%s", (int)at.begin, value, path, value + at.begin + at.length) < 0)
        text = NULL;
    json->failed |= !text;
    if (text) iso_json_string(json, option->name, text);
    free(found);
    free(path);
    free(text);
}

static void put_file(iso_json *json, const char *path, const iso_scene_record *record, const char *file) {
    char text[17];
    if (!find_fingerprint(path, text, &json->failed)) return;
    iso_json_begin_object(json, NULL);
    put_path(json, "path", path, record, file);
    iso_json_string(json, "fingerprint", text);
    iso_json_end_object(json);
}

static void put_option(iso_json *json, const iso_scene_option *option, const iso_scene_record *record,
                       const char *file) {
    iso_json_begin_object(json, NULL);
    if (!option->value)
        iso_json_bool(json, option->name, true);
    else if (option->is_file)
        put_path(json, option->name, option->value, record, file);
    else if (option->has_file)
        put_part(json, option, record, file);
    else
        iso_json_string(json, option->name, option->value);
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

static void put_scene(iso_json *json, const iso_scene_record *record, const char *file) {
    iso_json_begin_object(json, NULL);
    iso_json_integer(json, "scene", ISO_SCENE_JSON_VERSION);
    iso_json_string(json, "isorender", record->version);
    if (record->input) put_path(json, "input", record->input, record, file);
    iso_json_begin_array(json, "options");
    for (int i = 0; i < record->option_count; i++) put_option(json, &record->options[i], record, file);
    iso_json_end_array(json);
    iso_json_begin_array(json, "files");
    if (record->input) put_file(json, record->input, record, file);
    for (int i = 0; i < record->option_count; i++) {
        const iso_scene_option *option = &record->options[i];
        iso_value_path at;
        char *found = NULL;
        if (option->is_file && option->value) put_file(json, option->value, record, file);
        if (!option->has_file || !option->value || !iso_value_path_find(option->value, NULL, &at, &found))
            continue;
        put_file(json, found, record, file);
        free(found);
    }
    iso_json_end_array(json);
    if (file && record->camera) put_camera(json, record->camera);
    if (file) iso_json_reals(json, "isovalues", record->isovalues, record->isovalue_count);
    iso_json_end_object(json);
}

iso_status iso_scene_json_text(const iso_scene_record *record, char **text, iso_error *error) {
    char *line = NULL;
    size_t bytes = 0;
    *text = NULL;
    FILE *stream = open_memstream(&line, &bytes);
    if (!stream) return iso_fail(error, ISO_ERR_NOMEM, "out of memory");
    iso_json json = {.one_line = true};
    put_scene(&json, record, NULL);
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

iso_status iso_scene_json_save(const iso_scene_record *record, const char *path, iso_error *error) {
    iso_sink sink;
    iso_json json = {0};
    ISO_TRY(iso_sink_open(path, &sink, error));
    put_scene(&json, record, path);
    return iso_json_commit(&json, &sink, error);
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

static iso_status check_form(const char *path, const json_t *scene, iso_error *error) {
    const json_t *options = json_object_get(scene, "options"), *option;
    size_t i;
    if (json_integer_value(json_object_get(scene, "scene")) != ISO_SCENE_JSON_VERSION)
        return iso_fail(error, ISO_ERR_FORMAT, "%s: a scene of another version than %d", path,
                        ISO_SCENE_JSON_VERSION);
    if (!json_is_array(options))
        return iso_fail(error, ISO_ERR_FORMAT, "%s: a scene has a list of options", path);
    json_array_foreach(options, i, option) {
        if (json_object_size(option) != 1)
            return iso_fail(error, ISO_ERR_FORMAT, "%s: option %zu is not one name with its value", path,
                            i + 1);
    }
    return ISO_OK;
}

iso_status iso_scene_json_read(const char *path, json_t **scene, iso_error *error) {
    char *text = NULL;
    json_error_t reason;
    *scene = NULL;
    const bool is_png = iso_file_type_of_name(path, ISO_HOLDS_SCENE) == ISO_FILE_png;
    ISO_TRY(is_png ? iso_png_read_text(path, "Scene", &text, error) : read_text(path, &text, error));
    json_t *found = json_loads(text + iso_text_mark(text, strlen(text)), JSON_REJECT_DUPLICATES, &reason);
    free(text);
    if (!found) return iso_fail(error, ISO_ERR_FORMAT, "%s: line %d: %s", path, reason.line, reason.text);
    iso_status status = ISO_OK;
    const bool is_scene = json_is_object(found) && json_object_get(found, "scene");
    if (is_scene) status = check_form(path, found, error);
    if (is_scene && status == ISO_OK)
        *scene = found;
    else
        json_decref(found);
    return status;
}

/* The path of a scene's file: as it stands there, or beside the scene; of one that is nowhere the first of
 * both. The caller's, NULL: no memory. */
char *iso_scene_json_find(const char *scene_path, const char *path) {
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

static iso_status check_file(const char *scene_path, const json_t *file, iso_error *error) {
    const char *path = json_string_value(json_object_get(file, "path")),
               *known = json_string_value(json_object_get(file, "fingerprint"));
    char now[17];
    if (!path || !known)
        return iso_fail(error, ISO_ERR_FORMAT, "%s: a file without path and fingerprint", scene_path);
    char *found = iso_scene_json_find(scene_path, path);
    if (!found) return iso_fail(error, ISO_ERR_NOMEM, "out of memory");
    bool failed = false;
    const bool same = !find_fingerprint(found, now, &failed) || strcmp(now, known) == 0;
    const bool missing = access(found, F_OK) != 0;
    free(found);
    if (failed) return iso_fail(error, ISO_ERR_NOMEM, "out of memory");
    if (same) return ISO_OK;
    if (missing)
        return iso_fail(error, ISO_ERR_IO,
                        "%s: %s, of which it was drawn, is not beside it (an input, or an option for another "
                        "file, takes its place)",
                        scene_path, path);
    return iso_fail(error, ISO_ERR_FORMAT,
                    "%s: %s is not the file that it was drawn from (a file named behind the scene is taken "
                    "whatever it holds)",
                    scene_path, path);
}

iso_status iso_scene_json_check_files(const char *scene_path, const json_t *scene,
                                      bool (*is_read)(void *context, const char *path), void *context,
                                      iso_error *error) {
    json_t *file;
    size_t i;
    json_array_foreach(json_object_get(scene, "files"), i, file) {
        const char *path = json_string_value(json_object_get(file, "path"));
        if (!is_read || !path || is_read(context, path)) ISO_TRY(check_file(scene_path, file, error));
    }
    return ISO_OK;
}
