/* shape: surfaces in the GPU's memory. Inside render/gl only. */
#ifndef ISO_RENDER_GL_SHAPE_H
#define ISO_RENDER_GL_SHAPE_H

#include <stdint.h>

#include "render/gl/engine.h"
#include "render/gl/internal.h"
#include "render/gl/program.h"

#ifdef __cplusplus
extern "C" {
#endif

/* What a draw has to know of a span without asking the GPU. */
typedef struct iso_gl_span {
    int32_t brick[3];
    uint32_t count; /* points, or indices */
    uint32_t first; /* point, or index */
    int32_t base;   /* vertex that indices count from */
    iso_box box;    /* index coordinates */
    double radius;  /* mm, the largest; 0 of triangles */
} iso_gl_span;

struct iso_gl_shape {
    iso_gl_engine *engine;
    iso_transform transform;
    iso_gl_span *spans;
    size_t span_count;
    bool mesh, surfels, has_radii;
    double radius; /* of all points without radii */
    /* Vertices, their radii, indices; one vertex array draws points or triangles, the other quads. */
    unsigned vertices, radii, indices, array, quad_array;
};

struct iso_gl_engine {
    iso_gl_context *context;
    unsigned programs[ISO_GL_PROGRAMS]; /* 0: not needed so far */
    int max_side;                       /* of what is drawn at once */
    double max_point;                   /* pixels */
    /* A framebuffer of at least the size that is drawn; all of it is made again when it must grow. */
    int width, height;
    unsigned framebuffer, color, surface, depth;
    unsigned frame, commands, instances; /* buffers */
};

/* The program, compiled when it is asked for the first time. */
iso_status iso_gl_engine_program(iso_gl_engine *engine, iso_gl_program program, unsigned *name,
                                 iso_error *error);

#ifdef __cplusplus
}
#endif
#endif
