/* sets: render/pullpush/sets.h by OpenGL: the cpu makes the fragments of the base level; shaders pull, push
 * and finish. */
#ifndef ISO_RENDER_GL_SETS_H
#define ISO_RENDER_GL_SETS_H

#include "render/gl/engine.h"
#include "render/pullpush/sets.h"

/* Draws all sets in one pyramid into a gbuffer that may hold a picture: what iso_draw_pyramid_sets draws,
 * except for rounding; the same bytes every time. Errors: ISO_ERR_NOMEM; ISO_ERR_USAGE as there;
 * ISO_ERR_LIMIT: the driver's storage buffers cannot hold a strip of the picture; ISO_ERR_BACKEND; the
 * gbuffer is then undefined. */
iso_status iso_gl_draw_pyramid_sets(iso_gl_engine *engine, const iso_target *target,
                                    const iso_pyramid_set *sets, size_t count, const iso_pullpush_opts *opts,
                                    iso_error *error);

#endif
