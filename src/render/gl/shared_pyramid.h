/* shared_pyramid: definitions for C and GLSL, after shared.h: lines, triangles and several sets in the image
 * pyramid of pull-push. */
#ifndef ISO_RENDER_GL_SHARED_PYRAMID_H
#define ISO_RENDER_GL_SHARED_PYRAMID_H

#ifndef ISO_GLSL
#include "render/gl/shared.h"
#endif

/* Storage buffers: iso_gl_line_fragment; their numbers in the pixels of all levels above 0 (uvec2) and
 * of the base level (uint). */
#define ISO_GL_LINE_FRAGMENTS 1
#define ISO_GL_LINE_PLACES 2
#define ISO_GL_LINE_INDEX 3

/* std140. `sight_line`: ray and slope of iso_pullpush_params; mm a pixel of level 0 at depth 1. `picture`:
 * width, height, surface number; 1: it has colours, 2: so have the lines. `flags`: orthographic; tubes;
 * illuminated; number of fragments. `lattice` and `levels` as for points. */
#define ISO_GL_LINES_FIELDS                                                                                  \
    ISO_GL_FLOATS(sight_line);                                                                               \
    ISO_GL_INTS(lattice);                                                                                    \
    ISO_GL_INTS(picture);                                                                                    \
    ISO_GL_UINTS(flags);                                                                                     \
    ISO_GL_INT_ROWS(levels, ISO_GL_LEVELS);

/* std430. An iso_line_fragment. */
#define ISO_GL_LINE_FIELDS                                                                                   \
    ISO_GL_FLOATS(spot);    /* place, pixels of level 0; depth and interval, mm */                           \
    ISO_GL_FLOATS(ellipse); /* form: xx, xy, yy; reach */                                                    \
    ISO_GL_FLOATS(along);   /* form; radius, mm */                                                           \
    ISO_GL_FLOATS(shape);   /* matrix; distance to the nearer end of the leg, mm */                          \
    ISO_GL_FLOATS(way);     /* tangent or normal; cosine of twice the angle in the picture */                \
    /* column and row; bits of the sine; colour; links, 256: it is thin, and from bit 16 on the line */      \
    ISO_GL_UINTS(more);

/* Several sets (render/pullpush/sets.h): storage buffers: iso_gl_set_fragment; their numbers in the pixels of
 * the base level (uint); the pixels of all levels above 0. */
#define ISO_GL_SET_FRAGMENTS 1
#define ISO_GL_SET_PIXELS 2
#define ISO_GL_SET_INDEX 3
#define ISO_GL_SET_PIXEL_BYTES 96

/* std140. `sight`: ray, slope and scale of iso_pullpush_params. `disc`: low_pass, facing, edge, least_radius.
 * `picture`: width, height, 0; 1: it has colours. `flags`: orthographic. `lattice` and `levels` as for
 * points. */
#define ISO_GL_SETS_FIELDS                                                                                   \
    ISO_GL_FLOATS(normal_x); /* normals from index to view space */                                          \
    ISO_GL_FLOATS(normal_y);                                                                                 \
    ISO_GL_FLOATS(normal_z);                                                                                 \
    ISO_GL_FLOATS(sight);                                                                                    \
    ISO_GL_FLOATS(disc);                                                                                     \
    ISO_GL_FLOATS(weight); /* coefficients */                                                                \
    ISO_GL_INTS(lattice);                                                                                    \
    ISO_GL_INTS(picture);                                                                                    \
    ISO_GL_UINTS(flags);                                                                                     \
    ISO_GL_INT_ROWS(levels, ISO_GL_LEVELS);

/* std430. A pixel of the base level: its key and planes (render/pullpush/pyramid.h). */
#define ISO_GL_SET_FRAGMENT_FIELDS                                                                           \
    ISO_GL_UINTS(key);    /* payload; bits of the depth; SET; colour */                                      \
    ISO_GL_FLOATS(shape); /* SHAPE_XX, SHAPE_XY, SHAPE_YY, ROOM */                                           \
    ISO_GL_FLOATS(more);  /* TWICE_X, TWICE_Y, RADIUS, INTERVAL */

/* A slot of uniform blocks, which the passes of splats have, too. std140. The triangles of a hybrid surface:
 * iso_brick_choice and iso_polygon_set (render/pullpush/polygon_fragments.h). */
#define ISO_GL_POLYGONS 4
#define ISO_GL_POLYGONS_FIELDS                                                                               \
    ISO_GL_FLOATS(index_x); /* rows of the transform from view space to index coordinates */                 \
    ISO_GL_FLOATS(index_y);                                                                                  \
    ISO_GL_FLOATS(index_z);                                                                                  \
    ISO_GL_FLOATS(turn_x); /* normals from view to index space */                                            \
    ISO_GL_FLOATS(turn_y);                                                                                   \
    ISO_GL_FLOATS(turn_z);                                                                                   \
    ISO_GL_FLOATS(depth_row); /* from index coordinates to depth */                                          \
    ISO_GL_FLOATS(choice);    /* focal length times size of a cell; pixels; half of a brick's depth; radius  \
                                 of the points' discs, mm */

#ifndef ISO_GLSL
typedef struct iso_gl_lines_uniforms {
    ISO_GL_LINES_FIELDS
} iso_gl_lines_uniforms;
typedef struct iso_gl_line_fragment {
    ISO_GL_LINE_FIELDS
} iso_gl_line_fragment;
typedef struct iso_gl_sets_uniforms {
    ISO_GL_SETS_FIELDS
} iso_gl_sets_uniforms;
typedef struct iso_gl_set_fragment {
    ISO_GL_SET_FRAGMENT_FIELDS
} iso_gl_set_fragment;
typedef struct iso_gl_polygons_uniforms {
    ISO_GL_POLYGONS_FIELDS
} iso_gl_polygons_uniforms;
#endif

#endif
