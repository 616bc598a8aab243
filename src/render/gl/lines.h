/* lines: render/pullpush/lines.h by OpenGL: the cpu cuts lines into fragments and links these; shaders pull,
 * push and shade nothing else. */
#ifndef ISO_RENDER_GL_LINES_H
#define ISO_RENDER_GL_LINES_H

#include "render/gl/engine.h"
#include "render/pullpush/lines.h"

/* Draws lines into a gbuffer that may hold a picture: what iso_draw_pyramid_lines draws, except for rounding;
 * the same bytes every time. Errors: ISO_ERR_NOMEM; ISO_ERR_LIMIT: the driver's storage buffers cannot hold a
 * strip of the picture; ISO_ERR_BACKEND; the gbuffer is then undefined. */
iso_status iso_gl_draw_pyramid_lines(iso_gl_engine *engine, const iso_target *target,
                                     const iso_pyramid_lines *lines, iso_pullpush *workspace,
                                     iso_error *error);

#endif
