/* value_path: finds the path by asking which files there are. */
#include "apps/common/value_path.h"

#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "apps/common/scene_json.h"

iso_value_path iso_value_path_whole(const char *value) {
    static const char word[] = "distance:";
    const size_t begin = strncmp(value, word, sizeof word - 1) == 0 ? sizeof word - 1 : 0;
    const char *at = strrchr(value + begin, '@');
    const bool numbers = at && at[1] && !at[1 + strspn(at + 1, "0123456789,")];
    return (iso_value_path){begin, numbers ? (size_t)(at - value) - begin : strlen(value) - begin};
}

static bool exists(const char *text, size_t length, const char *scene, char **found) {
    char *path = strndup(text, length);
    char *place = path && scene ? iso_scene_json_find(scene, path) : NULL;
    if (place) {
        free(path);
        path = place;
    }
    const bool is_there = length && path && access(path, F_OK) == 0;
    if (is_there && found)
        *found = path;
    else
        free(path);
    return is_there;
}

bool iso_value_path_find(const char *value, const char *scene, iso_value_path *path, char **found) {
    *path = iso_value_path_whole(value);
    const char *text = value + path->begin;
    if (exists(text, path->length, scene, found)) return true;
    while (path->length && text[path->length - 1] != ':') path->length--;
    if (!path->length) return false;
    path->length--;
    return exists(text, path->length, scene, found);
}
