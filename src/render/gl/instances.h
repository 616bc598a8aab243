/* instances: render/selection/instances.h by OpenGL. Each instance is drawn into the part of the picture that
 * it can cover; those outside the picture or hidden by nearer ones are left out, and so are the parts of the
 * others that are hidden. As they are drawn from front to back, this needs no frame before. */
#ifndef ISO_RENDER_GL_INSTANCES_H
#define ISO_RENDER_GL_INSTANCES_H

#include "render/gl/engine.h"
#include "render/selection/instances.h"

/* Draws instances over the picture that the target's gbuffer holds: what iso_draw_instances draws, except for
 * rounding, and with the same bytes whether hidden ones are left out or not (`draw_hidden`). It looks for
 * these less often than the cpu, and may draw some that the cpu finds hidden. Uploads the points of each set
 * once for this picture. Errors: those of iso_gl_upload_points and iso_gl_draw_pullpush. */
iso_status iso_gl_draw_instances(iso_gl_engine *engine, iso_instance_drawing *drawing,
                                 const iso_target *target, const iso_instances *instances,
                                 iso_instance_counts *counts, iso_error *error);

#endif
