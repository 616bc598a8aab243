/* shared: definitions for C and GLSL: slots of vertex inputs, buffers and textures, sizes of work groups,
 * and uniform blocks. Every shader begins with "#define ISO_GLSL 1", this file and base/point_numbers.h. */
#ifndef ISO_RENDER_GL_SHARED_H
#define ISO_RENDER_GL_SHARED_H

/* Vertex inputs. */
#define ISO_GL_PACKED 0   /* uvec2: an iso_point */
#define ISO_GL_POSITION 1 /* vec3: position of an iso_surfel or vertex, voxels */
#define ISO_GL_NORMAL 2   /* vec3 */
#define ISO_GL_RADIUS 3   /* float, mm */
#define ISO_GL_ORIGIN 4   /* vec3, per span of points: view space position of its brick's corner */
#define ISO_GL_BRICK 5    /* ivec3, per span of triangles */
#define ISO_GL_PLACE                                                                                         \
    5 /* vec4, per block: index coordinates of its first step; 1: curved discs, 0: flat, -1: filtered flat */
#define ISO_GL_CURVATURE 6 /* ivec4: an iso_curvature */
#define ISO_GL_COLOR 7     /* vec3: the point's colour, 0 .. 255 */
/* Of lines and glyphs, per block or shape: the origin that positions are relative to (iso_shapes_origin). */
#define ISO_GL_SHAPE_PIXEL 0 /* vec4: column, row; place in that pixel */
#define ISO_GL_SHAPE_RAY 1   /* vec4: depth, and what the float leaves of it; slopes */
#define ISO_GL_SHAPE_FROM 2  /* vec3: its position as those of the shapes are stored */

/* Uniform blocks. */
#define ISO_GL_DRAW 0
#define ISO_GL_PULLPUSH 1
#define ISO_GL_SHADE 2
#define ISO_GL_DISC_UNIFORMS 3
#define ISO_GL_SPLATTING 4
#define ISO_GL_SHAPING 5
#define ISO_GL_UNIFORM_SLOTS 6

/* Uniforms of pull-push's passes. */
#define ISO_GL_LEVEL 0 /* int: the level that a pass makes */
#define ISO_GL_FIRST 0 /* uvec2, of projections: the first block, and one beyond the last */

/* Storage buffers. Only eight slots are guaranteed: buffers that no pass uses together share a slot. */
#define ISO_GL_POINTS 0   /* uint: points as they are in C */
#define ISO_GL_RADII 1    /* float: one a point, mm */
#define ISO_GL_BLOCKS 2   /* iso_gl_point_block */
#define ISO_GL_KEYS 3     /* uvec2, of the base level's pixels: payload, depth */
#define ISO_GL_DISCS 4    /* uint: bits of the radius of each such pixel's disc, mm; then colours likewise */
#define ISO_GL_PAINTS 5   /* uint: the points' colours, three bytes each */
#define ISO_GL_TINTS 2    /* vec4, of the pixels of all levels above 0: colour, 0 .. 255 */
#define ISO_GL_SHADES 5   /* vec4, of the pixels of all levels above 0: normal, mean depth */
#define ISO_GL_RANGES 6   /* vec4: least and greatest depth; offset of the ellipse's centre */
#define ISO_GL_ELLIPSES 7 /* vec4: the ellipse (WIDE, THIN_X, THIN_Y of pyramid.h), the disc's radius */
#define ISO_GL_REACHES 1  /* uint: bits of the ellipse's OUT; the lowest is HIDDEN */
#define ISO_GL_SPLATS 1   /* iso_gl_splat: discs of splats */
#define ISO_GL_SHAPES 1   /* vec4: lines and glyphs (shapes.c) */
#define ISO_GL_MARKS 2    /* uint: a glyph's number and colour; a segment's first vertex, and flags */
#define ISO_GL_LINE_COLORS 5 /* uint: one a vertex, three bytes */
#define ISO_GL_NEAR_SHAPES 4 /* iso_gl_near_shape */
/* Of layers of splats: pairs of vec4, a disc's shaded colour and opacity, and its layer's thickness; lists of
 * discs by tile; for each sample the depths between which discs are drawn; the layers. */
#define ISO_GL_LOOKS 2
#define ISO_GL_TILE_STARTS 3
#define ISO_GL_TILE_DISCS 4
#define ISO_GL_LAYER_BOUNDS 5
#define ISO_GL_LAYERS 6
#define ISO_GL_HITS 7 /* uvec4: depth, e, disc, whether it faces away */
/* Of the selection of points (selection.h): least depths of each pixel's cells, in the order of their bits; a
 * bit for each point, 1: it is chosen; the numbers of the chosen points; commands that draw points, and those
 * that draw chosen ones; how many are chosen; the deepest front of each square of pixels. */
#define ISO_GL_CELLS 1
#define ISO_GL_MARKED 2
#define ISO_GL_CHOSEN 3
#define ISO_GL_COMMANDS 4
#define ISO_GL_ELEMENTS 5
#define ISO_GL_TOTAL 6
#define ISO_GL_DEEPEST 7
#define ISO_GL_MARKED_FRONTS 1 /* a bit for each point: it makes fronts, or did in the frame before */
#define ISO_GL_PICTURE 0       /* uint: planes of a gbuffer: depth, normal x, y, z, surface, colours */
#define ISO_GL_PICTURE_PLANES 5
#define ISO_GL_STORAGE_SLOTS 8

/* Textures and images of shading. */
#define ISO_GL_NORMAL_DEPTHS 0 /* normal and depth that the fragment shaders wrote */
#define ISO_GL_SPHERE 1        /* a lit sphere's colours by the normal's x and y, -1 .. 1 */
/* Textures of the method discs. */
#define ISO_GL_FRONTS 0 /* nearest depths of front-facing and of flipped back-facing discs (discs.frag) */
#define ISO_GL_SUMS 1   /* four textures of sums over the frontmost discs */
#define ISO_GL_TEXTURE_SLOTS 5
#define ISO_GL_COLORS 0  /* rgba8: a canvas's */
#define ISO_GL_SAMPLES 1 /* rgba32f: view space normal, view z */
#define ISO_GL_IMAGE_SLOTS 2

/* Invocations of a work group: in a row, and along a side of a square. */
#define ISO_GL_GROUP 64
#define ISO_GL_TILE 8
#define ISO_GL_SPLAT_TILE 16  /* of layers of splats */
#define ISO_GL_MOST_GROUPS 64 /* ISO_GROUPS_MOST */
#define ISO_GL_LAYER_FLOATS 8 /* of a sample's layer */

/* Of the selection of points. A pixel has a cell for each of its quarters, and one each for the discs
 * that cover its centre, front-facing and flipped back-facing; pixels up to GUARD outside a tile have
 * cells too. Fronts are combined in squares of SQUARE x SQUARE pixels. */
#define ISO_GL_PIXEL_CELLS 6
#define ISO_GL_GUARD 3
#define ISO_GL_SQUARE 8
#define ISO_GL_DRAWS 0 /* uvec3, a uniform: first command, one beyond the last, 1: only fresh points */

/* Constants of pull-push, the same as in render/pullpush/pyramid.h and render/points/point_blocks.h. */
#define ISO_GL_LEVELS 11
#define ISO_GL_NOWHERE 1e30
#define ISO_GL_KEY_NONE 0xFFFFFFFFu /* greater than the ordered bits of any depth */
#define ISO_GL_DISC_RADII 1.25
#define ISO_GL_FURTHEST 16777216.0 /* pixels: coordinates are clamped to +- this */

/* Outputs of fragment shaders. */
#define ISO_GL_NORMAL_DEPTH 0 /* rgba32f: view space normal, view z in mm */
#define ISO_GL_SURFACE 1      /* r8ui */
#define ISO_GL_IDS 1          /* rg32ui, of lines and glyphs: shapes_ids.glsl */

/* Vertices of triangles are snapped to pixels / ISO_GL_SUBPIXEL, as the cpu engine does. */
#define ISO_GL_SUBPIXEL 256
/* Kinds of lines and glyphs: iso_shape_kind. */
#define ISO_GL_SPHERES 0
#define ISO_GL_TUBES 1
#define ISO_GL_RIBBONS 2
#define ISO_GL_SOLIDS 3
/* iso_glyph of solids; shape of the arrow (render/shapes/solid.h). */
#define ISO_GL_CONE 1
#define ISO_GL_CYLINDER 2
#define ISO_GL_ARROW 3
#define ISO_GL_ELLIPSOID 4
#define ISO_GL_DISC 5
#define ISO_GL_BOX 6
#define ISO_GL_ARROW_NECK 0.3
#define ISO_GL_ARROW_SHAFT 0.3
/* Flags of segments: ISO_TUBE_.. of render/shapes/set.h. */
#define ISO_GL_TUBE_CUT_FIRST 1u
#define ISO_GL_TUBE_CUT_LAST 2u
#define ISO_GL_TUBE_WIDENED 4u
#define ISO_GL_TUBE_SECOND_ONLY 8u
/* Boxes of lines and glyphs are this much wider on each side, in pixels: more than the driver's rounding. */
#define ISO_GL_SHAPE_MARGIN 0.02

/* Points are drawn as squares this much wider than their discs, in pixels, so that rounding misses no
 * pixel of a disc; the fragment shader discards the pixels outside the disc. */
#define ISO_GL_POINT_MARGIN 0.125

#ifdef ISO_GLSL
/* The bits of a float, mapped so that unsigned integers compare like the floats. */
uint ordered(float depth) {
    uint bits = floatBitsToUint(depth);
    return bits >> 31 != 0u ? ~bits : bits | 0x80000000u;
}

#define ISO_GL_FLOATS(name) vec4 name
#define ISO_GL_DOUBLES(name) dvec4 name
#define ISO_GL_DOUBLE_ROWS(name, count) dvec4 name[count]
#define ISO_GL_UINTS(name) uvec4 name
#define ISO_GL_INTS(name) ivec4 name
#define ISO_GL_INT_ROWS(name, count) ivec4 name[count]
#else
#define ISO_GL_FLOATS(name) float name[4]
#define ISO_GL_DOUBLES(name) double name[4]
#define ISO_GL_DOUBLE_ROWS(name, count) double name[count][4]
#define ISO_GL_UINTS(name) unsigned name[4]
#define ISO_GL_INTS(name) int name[4]
#define ISO_GL_INT_ROWS(name, count) int name[count][4]
#endif

/* std140. Drawing one surface as points or triangles. */
#define ISO_GL_DRAW_FIELDS                                                                                   \
    ISO_GL_DOUBLES(row_x); /* rows of the transform from index to view space */                              \
    ISO_GL_DOUBLES(row_y);                                                                                   \
    ISO_GL_DOUBLES(row_z);                                                                                   \
    ISO_GL_DOUBLES(pixels); /* focal; optical axis x and y; depth of the near plane */                       \
    ISO_GL_FLOATS(turn_x);  /* the same rows without translation */                                          \
    ISO_GL_FLOATS(turn_y);                                                                                   \
    ISO_GL_FLOATS(turn_z);                                                                                   \
    ISO_GL_FLOATS(normal_x); /* normals from index to view space */                                          \
    ISO_GL_FLOATS(normal_y);                                                                                 \
    ISO_GL_FLOATS(normal_z);                                                                                 \
    ISO_GL_FLOATS(screen); /* width and height of the viewport; its margin around the picture, pixels */     \
    ISO_GL_FLOATS(depths); /* orthographic: far, 1 / (far - near) */                                         \
    ISO_GL_FLOATS(points); /* widest point that the driver draws, px; attenuated: 1 / sqrt(k) of eq. 6 */    \
    ISO_GL_UINTS(flags);   /* surface, orthographic, attenuated */

/* std140. Drawing one surface by pull-push: the fields of iso_point_projection and iso_pullpush_params
 * (render/pullpush/kernel.h). */
#define ISO_GL_PULLPUSH_FIELDS                                                                               \
    ISO_GL_FLOATS(step_x); /* rows of the transform from steps: x and y to pixels at depth 1, z to mm */     \
    ISO_GL_FLOATS(step_y);                                                                                   \
    ISO_GL_FLOATS(step_z);                                                                                   \
    ISO_GL_FLOATS(normal_x); /* normals from index to view space */                                          \
    ISO_GL_FLOATS(normal_y);                                                                                 \
    ISO_GL_FLOATS(normal_z);                                                                                 \
    ISO_GL_FLOATS(axis);   /* optical axis in the base level; depth of the near plane; scale */              \
    ISO_GL_FLOATS(disc);   /* radius; low_pass, facing, edge */                                              \
    ISO_GL_FLOATS(ray);    /* ray; slope */                                                                  \
    ISO_GL_FLOATS(weight); /* coefficients */                                                                \
    ISO_GL_FLOATS(border); /* index coordinates of the grid's last voxel; 1: discs end there */              \
    ISO_GL_FLOATS(eye);    /* index coordinates of view space's origin */                                    \
    ISO_GL_INTS(lattice);  /* base level; rows_before; the picture's pixel that is (0, 0) of level 0 */      \
    ISO_GL_INTS(picture);  /* width, height, surface number */                                               \
    ISO_GL_UINTS(flags);   /* orthographic; two_sided; points have radii; points have colours */             \
    ISO_GL_INT_ROWS(levels, ISO_GL_LEVELS); /* width, height, first pixel in the buffers */

/* std140. Drawing one surface by the method discs in a tile of the picture.
 * `step_x`: its last is what radii are multiplied by. `step_y`: its last is iso_discs_slant of the picture.
 * `sizes`: 1 / focal (orthographic: 0); most voxels per mm; the largest spacing in mm when voxels are not
 * cubes, else 0; the largest thickness of a disc, mm. `screen`: width and height of the viewport; its margin
 * around the tile; the widest point that the driver draws, in pixels. */
#define ISO_GL_DISCS_FIELDS                                                                                  \
    ISO_GL_FLOATS(step_x); /* rows of the transform from steps to view space, without translation */         \
    ISO_GL_FLOATS(step_y);                                                                                   \
    ISO_GL_FLOATS(step_z);                                                                                   \
    ISO_GL_FLOATS(normal_x); /* normals from index to view space */                                          \
    ISO_GL_FLOATS(normal_y);                                                                                 \
    ISO_GL_FLOATS(normal_z);                                                                                 \
    ISO_GL_FLOATS(border); /* index coordinates of the grid's last voxel; 1: discs are clipped there */      \
    ISO_GL_FLOATS(axis);   /* optical axis in the tile; depth of the near plane; pixels per mm at depth 1 */ \
    ISO_GL_FLOATS(sizes);                                                                                    \
    ISO_GL_FLOATS(screen);                                                                                   \
    ISO_GL_INTS(tile);    /* width, height; the picture's pixel at its corner */                             \
    ISO_GL_INTS(picture); /* width, height, surface number; its colour, 0: none */                           \
    ISO_GL_UINTS(flags);  /* orthographic; leave out back-facing points; points have colours; filtered
                              discs cover what they are widened to */

/* std140. Drawing one surface by splats in a strip of the picture.
 *
 * `rays`: 1 / focal (orthographic: 0); mm a pixel (perspective: 0); depth of the near plane; thickness of a
 * layer in radii of discs. `layers`: width of layers' bins of depth; of opaque discs: bins, origin, range. */
#define ISO_GL_SPLATTING_FIELDS                                                                              \
    ISO_GL_FLOATS(axis); /* optical axis in the strip */                                                     \
    ISO_GL_FLOATS(rays);                                                                                     \
    ISO_GL_INTS(picture); /* width, height, surface number */                                                \
    ISO_GL_INTS(counts);  /* discs; slots of a pixel; points have colours */                                 \
    ISO_GL_FLOATS(layers);

/* std140. Drawing a set of lines or glyphs: the fields of iso_shapes_frame (render/shapes/frame.h).
 *
 * `lens`: optical axis in the part; focal length; depth of the near plane. `rays`: slope, spread, fixed.
 * `least`: least radius of lines by depth, least_slope and least_fixed; in parallel views the farthest depth,
 * and 1 / (farthest - nearest). */
#define ISO_GL_SHAPING_FIELDS                                                                                \
    ISO_GL_DOUBLES(camera); /* optical axis in the part, focal length, depth of the near plane */            \
    ISO_GL_FLOATS(turn_x);  /* rows of the rotation from world to view space */                              \
    ISO_GL_FLOATS(turn_y);                                                                                   \
    ISO_GL_FLOATS(turn_z);                                                                                   \
    ISO_GL_FLOATS(lens);                                                                                     \
    ISO_GL_FLOATS(rays);                                                                                     \
    ISO_GL_FLOATS(least);                                                                                    \
    ISO_GL_FLOATS(screen); /* width and height of the part */                                                \
    ISO_GL_INTS(set);      /* surface number; it has colours; parallel view */

/* std430. A shape whose rays are traced in double precision (iso_near_shape), in view space. */
#define ISO_GL_NEAR_FIELDS                                                                                   \
    ISO_GL_DOUBLE_ROWS(ends, 2);    /* centres or vertices, and radii */                                     \
    ISO_GL_DOUBLE_ROWS(across, 2);  /* of ribbons */                                                         \
    ISO_GL_DOUBLE_ROWS(inverse, 3); /* of solids: rows of the map's inverse */                               \
    ISO_GL_FLOATS(box);             /* pixels: low x, y, high x, y */                                        \
    ISO_GL_FLOATS(front);           /* no visible sample is nearer */                                        \
    ISO_GL_FLOATS(unused);          /* C pads structures of doubles less */                                  \
    ISO_GL_UINTS(numbers);          /* element, colours of both ends, flags */

/* std430. A block of points that is projected by one work group. */
#define ISO_GL_BLOCK_FIELDS                                                                                  \
    ISO_GL_FLOATS(origin); /* projection of the block's first step */                                        \
    ISO_GL_FLOATS(eye);    /* the eye in steps from there; orthographic: the direction of view */            \
    ISO_GL_UINTS(part);    /* first point in the bound range; number of points; leave out back-facing ones */

/* std140. Shading a part of a picture. */
#define ISO_GL_SHADE_FIELDS                                                                                  \
    ISO_GL_FLOATS(ray);        /* optical axis in the part, samples; 1 / focal, orthographic: 0 */           \
    ISO_GL_FLOATS(color);      /* 0 .. 1 */                                                                  \
    ISO_GL_FLOATS(background); /* 0 .. 1 */                                                                  \
    ISO_GL_INTS(part);         /* width, height in pixels; the picture's pixel at its corner */              \
    ISO_GL_INTS(how);          /* samples along a pixel's side; store them; use the matcap */

#ifndef ISO_GLSL
typedef struct iso_gl_draw_uniforms {
    ISO_GL_DRAW_FIELDS
} iso_gl_draw_uniforms;
typedef struct iso_gl_pullpush_uniforms {
    ISO_GL_PULLPUSH_FIELDS
} iso_gl_pullpush_uniforms;
typedef struct iso_gl_discs_uniforms {
    ISO_GL_DISCS_FIELDS
} iso_gl_discs_uniforms;
typedef struct iso_gl_shaping_uniforms {
    ISO_GL_SHAPING_FIELDS
} iso_gl_shaping_uniforms;
typedef struct iso_gl_near_shape {
    ISO_GL_NEAR_FIELDS
} iso_gl_near_shape;
typedef struct iso_gl_point_block {
    ISO_GL_BLOCK_FIELDS
} iso_gl_point_block;
typedef struct iso_gl_splatting_uniforms {
    ISO_GL_SPLATTING_FIELDS
} iso_gl_splatting_uniforms;
typedef struct iso_gl_shade_uniforms {
    ISO_GL_SHADE_FIELDS
} iso_gl_shade_uniforms;
#endif

#endif
