/* value_path: the path of a file within the value of an option, such as --surface-color-by distance:FILE:80@2
 * (ISO_OPTION_READS_PART). */
#ifndef ISO_APPS_COMMON_VALUE_PATH_H
#define ISO_APPS_COMMON_VALUE_PATH_H

#include <stdbool.h>
#include <stddef.h>

/* The path is `length` bytes from value[begin] on. */
typedef struct iso_value_path {
    size_t begin, length;
} iso_value_path;

/* What can be a path: what stands behind "distance:" and before @N,.. at the end. */
iso_value_path iso_value_path_whole(const char *value);

/* Looks for a path that exists in a value: all of iso_value_path_whole, or what comes before its last
 * colon. scene: also beside this file, as iso_scene_json_find does; NULL: not. *found, if it is not NULL,
 * is set to the path as it was found, the caller's: free(). False: there is none, or no memory. */
bool iso_value_path_find(const char *value, const char *scene, iso_value_path *path, char **found);

#endif
