/* shape: surfaces in the GPU's memory. Inside render/gl only. */
#ifndef ISO_RENDER_GL_SURFACE_H
#define ISO_RENDER_GL_SURFACE_H

#include <stdint.h>

#include "base/memory.h"
#include "render/gl/engine.h"
#include "render/gl/internal.h"
#include "render/gl/program.h"
#include "render/gl/strips.h"
#include "render/gl/timer.h"
#include "render/point_blocks.h"

#ifdef __cplusplus
extern "C" {
#endif

/* What a draw has to know of a span without asking the GPU. */
typedef struct iso_gl_span {
    int32_t brick[3];
    uint32_t count;     /* points, or indices */
    uint32_t first;     /* point, or index */
    uint32_t triangles; /* of a mesh */
    int32_t base;       /* vertex that indices count from */
    bool changed;       /* by the last update */
    uint64_t stamp;     /* of what was uploaded; 0: none */
    size_t place[2];    /* where that lay: points, or vertices and triangles */
    iso_box box;        /* index coordinates */
    double radius;      /* mm, the largest; 0 of triangles */
} iso_gl_span;

typedef struct iso_gl_buffer {
    unsigned name;
    size_t room; /* items */
} iso_gl_buffer;

/* What a draw tells points of the span or block that they are in. */
typedef struct iso_gl_instance {
    float origin[3]; /* view space */
    float place[4];  /* index coordinates of the first step of positions; whether shapes matter */
} iso_gl_instance;

/* Draws as OpenGL wants them in buffers. */
typedef struct iso_gl_points_command {
    uint32_t count, instances, first, first_instance;
} iso_gl_points_command;

typedef struct iso_gl_mesh_command {
    uint32_t count, instances, first;
    int32_t base;
    uint32_t first_instance;
} iso_gl_mesh_command;

struct iso_gl_surface {
    iso_gl_engine *engine;
    iso_transform transform;
    iso_buffer spans; /* of iso_gl_span */
    size_t span_count;
    bool mesh, stripped, surfels, has_radii, has_colors, has_shapes, closed;
    iso_buffer bounds;        /* of a closed mesh: one iso_point_bounds a span */
    iso_point_blocks *blocks; /* of points: where each begins in its span, and what they are; owned */
    double radius;            /* of all points without radii */
    int32_t dims[3];          /* of their grid; 0: not known */
    uint64_t uploaded;        /* bytes, by the last update */
    iso_gl_strips strips;
    /* One vertex array draws points or triangles, the other quads. */
    iso_gl_buffer vertices, radii, colors, shapes, indices;
    unsigned array, quad_array;
};

/* Buffers of pull-push. */
typedef enum iso_gl_storage {
    ISO_GL_STORE_UNIFORMS,
    ISO_GL_STORE_REFINED, /* uniforms too */
    ISO_GL_STORE_BLOCKS,
    ISO_GL_STORE_KEYS,
    ISO_GL_STORE_DISCS,
    ISO_GL_STORE_SHADES,
    ISO_GL_STORE_RANGES,
    ISO_GL_STORE_SHAPES,
    ISO_GL_STORE_ENDS,
    ISO_GL_STORE_TINTS,
    ISO_GL_STORE_PICTURE
} iso_gl_storage;
enum { ISO_GL_STORES = 11 };

/* What discs are drawn into, at least as large as what is drawn: the nearest depths, and sums. */
typedef struct iso_gl_discs {
    int width, height;
    unsigned framebuffers[2], fronts, sums[4];
} iso_gl_discs;

struct iso_gl_engine {
    iso_gl_context *context;
    unsigned programs[ISO_GL_PROGRAMS]; /* 0: not needed so far */
    int max_side;                       /* of what is drawn at once */
    double max_point;                   /* pixels */
    /* A framebuffer of at least the size that is drawn; all of it is made again when it must grow. */
    int width, height;
    unsigned framebuffer, color, surface, depth;
    iso_gl_discs discs;
    unsigned frame, commands, instances; /* buffers */
    bool keep_averted;                   /* for tests: nothing is left out for facing away */
    size_t drawn, averted;               /* spans, by the last draw; what its parts share counts for each */
    /* Buffers that grow as they must, 0 where not needed so far. */
    unsigned storage[ISO_GL_STORES];
    size_t storage_bytes[ISO_GL_STORES];
    size_t max_storage; /* bytes of one that shaders can see */
    bool wide_atomics;  /* on 64 bits of it */
    iso_gl_timer timer;
};

/* The program, compiled when it is asked for the first time. */
iso_status iso_gl_engine_program(iso_gl_engine *engine, iso_gl_program program, unsigned *name,
                                 iso_error *error);

/* Uninitialised, of one level. */
unsigned iso_gl_make_texture(const GladGLContext *gl, unsigned format, int width, int height);

/* A buffer of pull-push of at least so many bytes, whose contents are lost when it must grow. */
void iso_gl_engine_need(iso_gl_engine *engine, iso_gl_storage which, size_t bytes);

/* Points are drawn while their centres are in the viewport, so that it is wider than the picture by half the
 * widest point. */
static inline int iso_gl_engine_margin(const iso_gl_engine *engine) {
    return (int)(engine->max_point / 2) + 1;
}

/* Draws that follow one another: their commands (points' or a mesh's) and what each tells its primitives
 * (iso_gl_instance, or a mesh's brick), which stay until others come. */
void iso_gl_surface_command(const iso_gl_surface *shape, size_t count, const void *commands,
                            const void *instances);
/* By the program in use. */
void iso_gl_surface_draw(const iso_gl_surface *shape, size_t count);
/* So many points from `first` on as quads. */
void iso_gl_surface_draw_quads(const iso_gl_surface *shape, size_t first, size_t count,
                               const iso_gl_instance *instance);

#ifdef __cplusplus
}
#endif
#endif
