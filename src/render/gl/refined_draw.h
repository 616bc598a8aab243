/* refined_draw: the drawing of one surface as discs, tile by tile: what refined.c and selection.c share.
 * Inside render/gl only. */
#ifndef ISO_RENDER_GL_REFINED_DRAW_H
#define ISO_RENDER_GL_REFINED_DRAW_H

#include "render/gl/surface.h"

/* The drawing of one surface. */
typedef struct iso_gl_refined_draw {
    iso_gl_engine *engine;
    const GladGLContext *gl;
    const iso_gl_surface *surface;
    const iso_view *view;
    iso_projector projector;
    float slant;
    bool cull;
    bool flat;   /* curvatures are not used, and small discs are filtered */
    bool select; /* only visible points are drawn (render/gl/selection.h) */
    int number;
} iso_gl_refined_draw;

/* What is known of a block that the tile's rows may show. */
typedef struct iso_gl_tile_block {
    uint32_t number;
    bool small;  /* its points are chosen one by one */
    bool tested; /* its points take part in the choice, and are drawn into the fronts */
    bool hidden; /* by the fronts */
} iso_gl_tile_block;

/* A part of the view; its first pixel is (x, y). */
typedef struct iso_gl_tile {
    int x, y, width, height;
    bool whole; /* the tile is the whole picture */
    iso_gl_tile_block *blocks;
    size_t block_count;
    int rounds; /* how often blocks have been tested against the fronts */
    /* The draw commands of some of these blocks, those of small ones first: one item each in the arrays. */
    size_t draws, small_draws;
    iso_gl_points_command *commands;
    iso_gl_instance *instances;
    bool *wide; /* discs may be wider than the driver's points: they are drawn as quads too */
} iso_gl_tile;

#endif
