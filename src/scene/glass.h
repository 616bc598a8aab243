/* glass: pictures of a surface as transparent glass, by the methods exact and raycast, and by splats for
 * points. */
#ifndef ISO_SCENE_GLASS_H
#define ISO_SCENE_GLASS_H

#include "render/glass/glass.h"
#include "render/groups/disc_layers.h"
#include "render/picture.h"
#include "scene/method.h"

/* Returns the refraction that ISO_REFRACTION_AUTO means. points: glass is drawn from points; transparency:
 * how their layers are found. */
iso_refraction iso_glass_usual_refraction(bool points, iso_transparency transparency);

/* Returns the part of the surface (iso_part) that must be computed before rendering. */
iso_part iso_glass_part(iso_method method, iso_refraction refraction);

/* A picture of glass. The caller sets the members before `view`; all pointers are borrowed while the picture
 * is rendered. */
typedef struct iso_glass_scene {
    iso_method method; /* one with ISO_CAN_GLASS. With traced refraction the method makes
                          no difference */
    iso_refraction
        refraction; /* not AUTO; of splats not traced; with ISO_TRANSPARENCY_NEAREST not two-sided */
    iso_transparency transparency;    /* how splats find layers: sorted or nearest */
    double abbe;                      /* dispersion as an Abbe number; 0: all colours are refracted alike */
    const iso_scene_surface *surface; /* its part iso_glass_part is up to date */
    iso_glass glass;
    bool shows_environment; /* the environment is seen behind the solid; if not, the background colour */
    const iso_picture_opts *opts;
    iso_view view; /* the view of the samples; set by iso_glass_scene_start */
    iso_glass_map map;
} iso_glass_scene;

/* Computes the maps that the picture needs, and sets `layers`, the callbacks with which iso_picture_render
 * renders it (iso_picture_opts.layers). In `opts`, camera, size, samples, shading and pool must be set. Call
 * iso_glass_scene_free when done, also after a failure. ISO_ERR_NOMEM. */
iso_status iso_glass_scene_start(iso_glass_scene *scene, iso_picture_layers *callbacks, iso_error *error);
void iso_glass_scene_free(iso_glass_scene *scene);

/* Returns the bytes that a picture with so many samples needs in addition to image and gbuffer. */
uint64_t iso_glass_scene_bytes(iso_refraction refraction, uint64_t samples);

#endif
