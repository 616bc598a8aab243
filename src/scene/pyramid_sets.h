/* pyramid_sets: the surfaces and objects of a scene that share one image pyramid. */
#ifndef ISO_SCENE_PYRAMID_SETS_H
#define ISO_SCENE_PYRAMID_SETS_H

#include "render/pullpush/sets.h"
#include "scene/picture.h"

/* Draws sets into a gbuffer: iso_draw_pyramid_sets, or what stands for it in another engine. */
typedef iso_status iso_draw_sets_fn(void *context, const iso_target *target, const iso_pyramid_set *sets,
                                    size_t count, const iso_pullpush_opts *opts, iso_error *error);

/* Draws the scene's pyramid, if it has any, by `draw`; NULL: by the cpu. ISO_ERR_NOMEM, and the errors of
 * `draw`. */
iso_status iso_scene_draw_pyramid(const iso_scene *scene, const iso_target *target, iso_draw_sets_fn *draw,
                                  void *context, iso_error *error);

#endif
