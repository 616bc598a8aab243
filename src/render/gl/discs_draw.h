/* discs_draw: the drawing of one surface as discs, tile by tile: what discs.c and selection.c share.
 * Inside render/gl only. */
#ifndef ISO_RENDER_GL_DISCS_DRAW_H
#define ISO_RENDER_GL_DISCS_DRAW_H

#include "render/gl/surface.h"
#include "render/selection/depth_pyramid.h"

/* The drawing of one surface. */
typedef struct iso_gl_discs_draw {
    iso_gl_engine *engine;
    const GladGLContext *gl;
    const iso_gl_surface *surface;
    const iso_view *view;
    iso_projector projector;
    float slant;
    bool cull;
    bool flat;    /* curvatures are not used, and small discs are filtered */
    bool widened; /* filtered discs cover what they are widened to */
    bool select;  /* only visible points are drawn (render/gl/selection.h) */
    bool cells;   /* there may be dense blocks */
    int number;
    iso_area area;                   /* the part of the view that is drawn into */
    const iso_depth_pyramid *before; /* of the picture that is drawn over; NULL: not known */
    double thickness;                /* the largest of a disc, mm */
    int color; /* of all samples: red, green and blue from the lowest byte on, and 1 << 24; 0: none */
} iso_gl_discs_draw;

/* How the points of a block are selected; draw commands are in this order. */
typedef enum iso_gl_block_kind {
    ISO_GL_DENSE,  /* small discs: by the cells of pixels */
    ISO_GL_TESTED, /* larger ones: those that the fronts do not hide */
    ISO_GL_WHOLE /* not: without selection. Sums depend on the order of blocks, which kinds must not change */
} iso_gl_block_kind;
enum { ISO_GL_BLOCK_KINDS = 3 };

/* What is known of a block that the tile's rows may show. */
typedef struct iso_gl_tile_block {
    uint32_t number;
    uint8_t kind;
    bool fresh;  /* not drawn into the fronts so far, but to be */
    bool tested; /* its points take part in the choice, and are drawn into the fronts */
    bool hidden; /* by the fronts */
} iso_gl_tile_block;

/* A part of what is drawn of the view; its first pixel is (x, y). */
typedef struct iso_gl_tile {
    int x, y, width, height;
    bool first, whole; /* it is the first one of the picture; the only one */
    iso_gl_tile_block *blocks;
    size_t block_count;
    int rounds; /* how often blocks have been tested against the fronts */
    bool grows; /* there are no dense blocks: fronts are added to in every round instead of made anew */
    bool stale; /* the fronts hide more points than when they were marked as visible */
    /* The draw commands of some of these blocks, in the order of their kinds: one item each in the arrays.
     * end[k]: one beyond those of kind k. Points of DENSE and TESTED ones are listed. */
    size_t draws, end[ISO_GL_BLOCK_KINDS];
    iso_gl_points_command *commands;
    iso_gl_instance *instances;
    bool *wide; /* discs may be wider than the driver's points: they are drawn as quads too */
} iso_gl_tile;

/* Whether the block's discs follow the surface's curvature. */
bool iso_gl_is_curved(const iso_gl_discs_draw *draw, const iso_point_block *block);

#endif
