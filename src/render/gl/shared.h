/* shared: what C and GLSL both have to know: numbers of slots, sizes of things, the layout of blocks. Every
 * shader begins with this file, after "#define ISO_GLSL 1". */
#ifndef ISO_RENDER_GL_SHARED_H
#define ISO_RENDER_GL_SHARED_H

/* Inputs of vertices. */
#define ISO_GL_PACKED 0   /* uvec2: an iso_point */
#define ISO_GL_POSITION 1 /* vec3: an iso_surfel's */
#define ISO_GL_NORMAL 2   /* vec3 */
#define ISO_GL_RADIUS 3   /* float, mm */
#define ISO_GL_ORIGIN 4   /* vec3, per span of points: view space position of its brick's corner */
#define ISO_GL_BRICK 5    /* ivec3, per span of triangles */

/* Uniform blocks. */
#define ISO_GL_FRAME 0

/* Outputs of fragments. */
#define ISO_GL_NORMAL_DEPTH 0 /* rgba32f: view space normal, view z in mm */
#define ISO_GL_SURFACE 1      /* r8ui */

/* base/primitives.h's numbers. */
#define ISO_GL_BRICK_SIDE 16
#define ISO_GL_COORDINATE_BITS 14
#define ISO_GL_COORDINATE_LOW -2.0
#define ISO_GL_COORDINATE_STEP (20.0 / 16384.0)
#define ISO_GL_NORMAL_BITS 11
#define ISO_GL_NORMAL_STEPS 2047

/* Vertices of triangles are snapped to pixels / ISO_GL_SUBPIXEL, as the cpu engine does. */
#define ISO_GL_SUBPIXEL 256
/* Points are drawn as squares this much wider than their discs, in pixels: the disc is cut out by fragments,
 * and no pixel of it may be missed by rounding. */
#define ISO_GL_POINT_MARGIN 0.125

#ifdef ISO_GLSL
#define ISO_GL_FLOATS(name) vec4 name
#define ISO_GL_DOUBLES(name) dvec4 name
#define ISO_GL_UINTS(name) uvec4 name
#else
#define ISO_GL_FLOATS(name) float name[4]
#define ISO_GL_DOUBLES(name) double name[4]
#define ISO_GL_UINTS(name) unsigned name[4]
#endif

/* std140. One draw of one surface. */
#define ISO_GL_FRAME_FIELDS                                                                                  \
    ISO_GL_DOUBLES(row_x); /* index to view space: x, y, z, 1 */                                             \
    ISO_GL_DOUBLES(row_y);                                                                                   \
    ISO_GL_DOUBLES(row_z);                                                                                   \
    ISO_GL_DOUBLES(pixels); /* focal, optical axis x and y, near */                                          \
    ISO_GL_FLOATS(turn_x);  /* the same without translation */                                               \
    ISO_GL_FLOATS(turn_y);                                                                                   \
    ISO_GL_FLOATS(turn_z);                                                                                   \
    ISO_GL_FLOATS(normal_x); /* index covector to view space */                                              \
    ISO_GL_FLOATS(normal_y);                                                                                 \
    ISO_GL_FLOATS(normal_z);                                                                                 \
    ISO_GL_FLOATS(screen); /* viewport width, height, what it is wider than the picture on each side */      \
    ISO_GL_FLOATS(depths); /* orthographic: far, 1 / (far - near) */                                         \
    ISO_GL_FLOATS(points); /* widest point that the driver draws, px; attenuated: 1 / sqrt(k) of eq. 6 */    \
    ISO_GL_UINTS(flags);   /* surface, orthographic, attenuated */

#ifndef ISO_GLSL
typedef struct iso_gl_frame {
    ISO_GL_FRAME_FIELDS
} iso_gl_frame;
#endif

#endif
