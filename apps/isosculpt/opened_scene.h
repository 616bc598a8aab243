/* opened_scene: a scene (apps/common/scene_json.h) as isosculpt's window opens it: the input, how it is read,
 * and how it was shown. What the picture shows beside that is left out, and said. */
#ifndef ISO_APPS_ISOSCULPT_OPENED_SCENE_H
#define ISO_APPS_ISOSCULPT_OPENED_SCENE_H

#include "apps/isosculpt/isosculpt.h"
#include "apps/isosculpt/viewport/viewport.h"

typedef struct isosculpt_opened_scene {
    isosculpt_settings settings; /* open, isovalue and input are set; its strings lie in `strings` */
    char **strings;              /* owned; ends with NULL */
    char *path;                  /* of the scene, beside which its files may be; owned */
    bool has_camera;
    iso_camera camera;
    struct json_t *options; /* of the scene, owned */
    char left_out[160]; /* the options that the picture lacks in a window, as "--labels, --slice"; "": none */
} isosculpt_opened_scene;

/* Whether the path's extension is that of scenes, or of pictures that hold one. */
bool isosculpt_is_scene(const char *path);

/* Reads a scene; isosculpt_opened_scene_free when done. ISO_ERR_FORMAT: it holds no scene, has no input, or a
 * file of it has changed; ISO_ERR_USAGE: an option that the reader does not take; ISO_ERR_IO, ISO_ERR_NOMEM.
 */
iso_status isosculpt_opened_scene_read(const char *path, isosculpt_opened_scene *scene, iso_error *error);
/* Shows a viewport of the input as the scene does: its camera, if it has one, and style.h. ISO_ERR_USAGE,
 * ISO_ERR_LIMIT: a value that is not understood; what was set before it stays. */
iso_status isosculpt_opened_scene_apply(const isosculpt_opened_scene *scene, isosculpt_viewport *viewport,
                                        iso_error *error);
/* Frees and zeroes it; a zeroed one is fine. */
void isosculpt_opened_scene_free(isosculpt_opened_scene *scene);

#endif
