/* shared: what C and GLSL both have to know: numbers of slots, sizes of things, the layout of blocks. Every
 * shader begins with this file, after "#define ISO_GLSL 1", and with base/point_numbers.h. */
#ifndef ISO_RENDER_GL_SHARED_H
#define ISO_RENDER_GL_SHARED_H

/* Inputs of vertices. */
#define ISO_GL_PACKED 0   /* uvec2: an iso_point */
#define ISO_GL_POSITION 1 /* vec3: an iso_surfel's */
#define ISO_GL_NORMAL 2   /* vec3 */
#define ISO_GL_RADIUS 3   /* float, mm */
#define ISO_GL_ORIGIN 4   /* vec3, per span of points: view space position of its brick's corner */
#define ISO_GL_BRICK 5    /* ivec3, per span of triangles */
#define ISO_GL_PLACE 5 /* vec4, per span of points: index coordinates of its first step; 1: shapes matter */
#define ISO_GL_CURVATURE 6 /* ivec4: an iso_curvature */

/* Uniform blocks. */
#define ISO_GL_DRAW 0
#define ISO_GL_PULLPUSH 1
#define ISO_GL_SHADE 2
#define ISO_GL_REFINED 3
#define ISO_GL_UNIFORM_SLOTS 4

/* Uniforms of pull-push's passes. */
#define ISO_GL_LEVEL 0 /* int: the level that a pass makes */
#define ISO_GL_FIRST 0 /* uvec2, of projections: the first block, and one beyond the last */

/* Storage buffers. Drivers need have no more than eight slots: what no pass uses together shares them. */
#define ISO_GL_POINTS 0 /* uint: points as they are in C */
#define ISO_GL_RADII 1  /* float: one a point, mm */
#define ISO_GL_BLOCKS 2 /* iso_gl_point_block */
#define ISO_GL_KEYS 3   /* uvec2, of the base level's pixels: payload, depth */
#define ISO_GL_DISCS                                                                                         \
    4 /* uint, likewise: bits of the radius of the pixel's disc, mm; behind them all, colours */
#define ISO_GL_PAINTS 5   /* uint: three bytes a point: its colour */
#define ISO_GL_TINTS 2    /* vec4, of the pixels of all levels above 0: colour, 0 .. 255 */
#define ISO_GL_SHADES 5   /* vec4, of the pixels of all levels above 0: normal, mean depth */
#define ISO_GL_RANGES 6   /* vec4: least and greatest depth, from the pixel's centre to the ellipse's */
#define ISO_GL_ELLIPSES 7 /* vec4: the ellipse (wide, thin x, thin y), the disc's radius */
#define ISO_GL_REACHES 1  /* uint: bits of its reach to where the surface ends; the last: it hides another */
#define ISO_GL_PICTURE 0  /* uint: planes of the gbuffer's: depth, normal x, y, z, surface, and of colours */
#define ISO_GL_PICTURE_PLANES 5
#define ISO_GL_STORAGE_SLOTS 8

/* Textures and images of shading. */
#define ISO_GL_NORMAL_DEPTHS 0 /* what fragments made */
#define ISO_GL_SPHERE 1        /* a lit sphere's colours by the normal's x and y, -1 .. 1 */
/* Textures of the refined reconstruction. */
#define ISO_GL_FRONTS 0 /* nearest depths of discs that face the eye, and of others */
#define ISO_GL_SUMS 1   /* four, over the discs at the front */
#define ISO_GL_TEXTURE_SLOTS 5
#define ISO_GL_COLORS 0  /* rgba8: a canvas's */
#define ISO_GL_SAMPLES 1 /* rgba32f: view space normal, view z */
#define ISO_GL_IMAGE_SLOTS 2

/* Threads of a group: in a row, and in a square. */
#define ISO_GL_GROUP 64
#define ISO_GL_TILE 8

/* Pull-push, as render/pullpush/pyramid.h has it. */
#define ISO_GL_LEVELS 11
#define ISO_GL_NOWHERE 1e30
#define ISO_GL_KEY_NONE 0xFFFFFFFFu /* no depth's, made to order */
#define ISO_GL_DISC_RADII 1.25
#define ISO_GL_FURTHEST 16777216.0 /* pixels from the axis */

/* Outputs of fragments. */
#define ISO_GL_NORMAL_DEPTH 0 /* rgba32f: view space normal, view z in mm */
#define ISO_GL_SURFACE 1      /* r8ui */

/* Vertices of triangles are snapped to pixels / ISO_GL_SUBPIXEL, as the cpu engine does. */
#define ISO_GL_SUBPIXEL 256
/* Points are drawn as squares this much wider than their discs, in pixels: the disc is cut out by fragments,
 * and no pixel of it may be missed by rounding. */
#define ISO_GL_POINT_MARGIN 0.125

#ifdef ISO_GLSL
#define ISO_GL_FLOATS(name) vec4 name
#define ISO_GL_DOUBLES(name) dvec4 name
#define ISO_GL_UINTS(name) uvec4 name
#define ISO_GL_INTS(name) ivec4 name
#define ISO_GL_INT_ROWS(name, count) ivec4 name[count]
#else
#define ISO_GL_FLOATS(name) float name[4]
#define ISO_GL_DOUBLES(name) double name[4]
#define ISO_GL_UINTS(name) unsigned name[4]
#define ISO_GL_INTS(name) int name[4]
#define ISO_GL_INT_ROWS(name, count) int name[count][4]
#endif

/* std140. One draw of one surface. */
#define ISO_GL_DRAW_FIELDS                                                                                   \
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

/* std140. One surface by pull-push: an iso_point_projection and an iso_pullpush_params. */
#define ISO_GL_PULLPUSH_FIELDS                                                                               \
    ISO_GL_FLOATS(step_x); /* steps of points to pixels of the base level at depth 1, and to mm */           \
    ISO_GL_FLOATS(step_y);                                                                                   \
    ISO_GL_FLOATS(step_z);                                                                                   \
    ISO_GL_FLOATS(normal_x); /* index covector to view space */                                              \
    ISO_GL_FLOATS(normal_y);                                                                                 \
    ISO_GL_FLOATS(normal_z);                                                                                 \
    ISO_GL_FLOATS(axis);   /* optical axis, pixels of the base level; near; pixels per mm at depth 1 */      \
    ISO_GL_FLOATS(disc);   /* radius of points without one, mm; low-pass, facing, edge, pixels^2 */          \
    ISO_GL_FLOATS(ray);    /* optical axis, pixels of level 0; slope */                                      \
    ISO_GL_FLOATS(weight); /* of q, 0 .. 1: a polynomial */                                                  \
    ISO_GL_INTS(                                                                                             \
        lattice); /* base; rows of the whole frame before level 0's; the picture's pixel at its corner */    \
    ISO_GL_INTS(picture);                   /* width, height, surface */                                     \
    ISO_GL_UINTS(flags);                    /* orthographic, two-sided, points have radii, and colours */    \
    ISO_GL_INT_ROWS(levels, ISO_GL_LEVELS); /* width, height, first pixel in the buffers */

/* std140. One surface by the refined reconstruction, in a tile of the picture. */
#define ISO_GL_REFINED_FIELDS                                                                                \
    ISO_GL_FLOATS(step_x); /* a step of position, in view space */                                           \
    ISO_GL_FLOATS(step_y);                                                                                   \
    ISO_GL_FLOATS(step_z);                                                                                   \
    ISO_GL_FLOATS(normal_x); /* index covector to view space */                                              \
    ISO_GL_FLOATS(normal_y);                                                                                 \
    ISO_GL_FLOATS(normal_z);                                                                                 \
    ISO_GL_FLOATS(border); /* index coordinates of the grid's last voxels; 0: it has no border */            \
    ISO_GL_FLOATS(axis);   /* optical axis, pixels of the tile; near; pixels per mm at depth 1 */            \
    ISO_GL_FLOATS(sizes); /* slope of a pixel (orthographic: 0); voxels in a mm, at most; mm, of the largest \
                             side of voxels that are no cubes, or 0 */                                       \
    ISO_GL_FLOATS(screen); /* viewport width, height, what it is wider than the tile on each side; widest    \
                              point that the driver draws, px */                                             \
    ISO_GL_INTS(tile);     /* width, height, the picture's pixel at its corner */                            \
    ISO_GL_INTS(picture);  /* width, height, surface */                                                      \
    ISO_GL_UINTS(flags);   /* orthographic, points that face away are left out */

/* std430. Points that are projected together. */
#define ISO_GL_BLOCK_FIELDS                                                                                  \
    ISO_GL_FLOATS(origin); /* of its first step, as the points' steps lead on from it */                     \
    ISO_GL_FLOATS(eye);    /* steps; orthographic: direction of the view */                                  \
    ISO_GL_UINTS(part);    /* first point in what is bound, count, leave out those that face away */

/* std140. A part of a picture, shaded: samples as in render/shading/shading.h. */
#define ISO_GL_SHADE_FIELDS                                                                                  \
    ISO_GL_FLOATS(ray);        /* optical axis in the part's samples; 1 / focal, 0: orthographic */          \
    ISO_GL_FLOATS(color);      /* 0 .. 1 */                                                                  \
    ISO_GL_FLOATS(background); /* 0 .. 1 */                                                                  \
    ISO_GL_INTS(part);         /* its size in pixels; the picture's pixel at its corner */                   \
    ISO_GL_INTS(how);          /* samples along a pixel, whether they are kept, by a sphere's picture */

#ifndef ISO_GLSL
typedef struct iso_gl_draw_uniforms {
    ISO_GL_DRAW_FIELDS
} iso_gl_draw_uniforms;
typedef struct iso_gl_pullpush_uniforms {
    ISO_GL_PULLPUSH_FIELDS
} iso_gl_pullpush_uniforms;
typedef struct iso_gl_refined_uniforms {
    ISO_GL_REFINED_FIELDS
} iso_gl_refined_uniforms;
typedef struct iso_gl_point_block {
    ISO_GL_BLOCK_FIELDS
} iso_gl_point_block;
typedef struct iso_gl_shade_uniforms {
    ISO_GL_SHADE_FIELDS
} iso_gl_shade_uniforms;
#endif

#endif
