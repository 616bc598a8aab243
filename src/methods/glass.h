/* glass: pictures of a surface as transparent glass, by the methods exact and raycast. */
#ifndef ISO_METHODS_GLASS_H
#define ISO_METHODS_GLASS_H

#include "methods/method.h"
#include "render/glass/glass.h"
#include "render/picture.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Whether a method draws glass. */
bool iso_method_has_glass(iso_method method);

/* The part (iso_part) of the subject that a picture needs. */
iso_part iso_glass_part(iso_method method, iso_refraction refraction);

/* A picture of glass. The caller sets the first members; all pointers are borrowed while it is rendered. */
typedef struct iso_glass_scene {
    iso_method method; /* iso_method_has_glass. Traced, the pictures of both are the same */
    iso_refraction refraction;
    const iso_subject *subject; /* iso_glass_part is up to date */
    iso_glass glass;
    bool shows_environment; /* behind the solid; else the background does */
    const iso_picture_opts *opts;
    iso_view view; /* of the samples; set by iso_glass_scene_start */
    iso_glass_map map;
} iso_glass_scene;

/* Computes what the picture needs beforehand, and sets what iso_picture_render needs to render it
 * (iso_picture_opts.layers). `opts` has camera, size, samples, shading and pool. Call iso_glass_scene_free
 * when done, also after a failure. ISO_ERR_NOMEM. */
iso_status iso_glass_scene_start(iso_glass_scene *scene, iso_picture_layers *callbacks, iso_error *error);
void iso_glass_scene_free(iso_glass_scene *scene);

/* Bytes that a picture of so many samples takes beside image and gbuffer. */
uint64_t iso_glass_scene_bytes(iso_refraction refraction, uint64_t samples);

#ifdef __cplusplus
}
#endif
#endif
