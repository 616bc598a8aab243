/* scene_json: a picture as data: a JSON object with the input, every option of isorender that influences the
 * picture, by its long name, and a fingerprint of each file. It stands in a file of its own, and in every PNG
 * as the text "Scene". docs/scenes.md describes it. */
#ifndef ISO_APPS_COMMON_SCENE_JSON_H
#define ISO_APPS_COMMON_SCENE_JSON_H

#include "apps/common/json.h"
#include "isopoint.h"

/* The version of the form of scenes. */
enum { ISO_SCENE_JSON_VERSION = 1 };

typedef struct iso_scene_option {
    const char *name, *value; /* without a value: NULL */
    bool is_file;             /* the value is the path of a file that is read, */
    bool has_file;            /* or may contain one (value_path.h) */
} iso_scene_option;

/* What is written. All borrowed. */
typedef struct iso_scene_record {
    const char *version; /* of isorender */
    const char *input;   /* NULL: there is none */
    const iso_scene_option *options;
    int option_count;
    const char
        *from; /* the scene that the picture was drawn from, where its paths begin; NULL: there is none */
    const iso_camera *camera; /* in files only; NULL: unknown */
    const double *isovalues;  /* the same */
    int isovalue_count;
} iso_scene_record;

/* Sets *text to the scene as one line, for PNGs; the caller's: free(). ISO_ERR_NOMEM. */
iso_status iso_scene_json_text(const iso_scene_record *record, char **text, iso_error *error);
/* Writes a file. Paths are relative to its folder. ISO_ERR_WRITE, ISO_ERR_NOMEM. */
iso_status iso_scene_json_save(const iso_scene_record *record, const char *path, iso_error *error);

/* Reads the JSON of a file, or of a PNG; *scene is the caller's: json_decref. NULL: it is JSON of something
 * else. ISO_ERR_IO; ISO_ERR_FORMAT: a PNG without a scene, no JSON, another version, options of a wrong form.
 */
iso_status iso_scene_json_read(const char *path, struct json_t **scene, iso_error *error);

/* The path of a scene's file: as it stands there, or beside the scene; of one that is nowhere the first of
 * both. The caller's: free(); NULL: no memory. */
char *iso_scene_json_find(const char *scene_path, const char *path);

/* Refuses a scene of which a file has changed; asked are files for which is_read(context, path) is true;
 * NULL: all. ISO_ERR_FORMAT, ISO_ERR_NOMEM. */
iso_status iso_scene_json_check_files(const char *scene_path, const struct json_t *scene,
                                      bool (*is_read)(void *context, const char *path), void *context,
                                      iso_error *error);

#endif
