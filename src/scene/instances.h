/* instances: draws a surface once for every placement (iso_placements in isopoint.h), as discs: what
 * programs and the public interface call; the drawing itself is render/selection/instances.h. */
#ifndef ISO_SCENE_INSTANCES_H
#define ISO_SCENE_INSTANCES_H

#include "render/selection/instances.h"
#include "scene/method.h"

/* From so many drawings of a surface on levels of detail save more time than making them takes: of a
 * number of pictures, times the instances in each (measured with 5 to 20 million points). */
enum { ISO_LOD_PAYING_DRAWINGS = 50 };

/* What is kept from one strip and picture to the next. Zero-initialise; free with iso_placed_free. */
typedef struct iso_placed {
    const iso_placements *placements; /* borrowed */
    iso_instance_drawing drawing;
    iso_buffer instances, states;
    size_t points; /* drawn since iso_placed_begin */
} iso_placed;

/* Begins a picture of these placements, which it borrows. ISO_ERR_USAGE: a placement's numbers cannot be
 * used; ISO_ERR_NOMEM. */
iso_status iso_placed_begin(iso_placed *placed, const iso_placements *placements, iso_error *error);

/* Draws the surface's points (with its levels of detail, if it has any) once for each placement into the
 * target, which may be a strip of the picture. `method`: one that has instances. `by`: another engine's
 * iso_draw_instances; NULL: the cpu's. ISO_ERR_NOMEM, and errors of the engine. */
iso_status iso_placed_draw(iso_placed *placed, iso_method method, const iso_scene_surface *surface,
                           const iso_target *target, iso_draw_instances_fn *by, void *context,
                           iso_error *error);

/* What was drawn since iso_placed_begin: an instance counts as drawn if any of its surfaces was, in any
 * strip, and as outside if all were in all strips. Points count in every strip that they are drawn in. */
iso_instance_counts iso_placed_counts(const iso_placed *placed);

void iso_placed_free(iso_placed *placed);

/* The box of all instances of a surface, along three world vectors (NULL: the world's axes). `index`: the
 * box of the surface in its index coordinates, which `own` maps to the world; `along`: its box along the
 * vectors, as narrow as it is known. Instances that are not turned are as narrow as that; of others it is
 * the box of the corners of `index`. */
iso_box iso_placed_bounds(const iso_placements *placements, const iso_transform *own, const iso_box *index,
                          const iso_box *along, const iso_vec3 *vectors);

#endif
