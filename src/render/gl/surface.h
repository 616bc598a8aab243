/* surface: points and meshes in GPU memory, how they are drawn, and the engine's own data. Inside
 * render/gl only. */
#ifndef ISO_RENDER_GL_SURFACE_H
#define ISO_RENDER_GL_SURFACE_H

#include <stdint.h>

#include "base/memory.h"
#include "render/gl/engine.h"
#include "render/gl/internal.h"
#include "render/gl/program.h"
#include "render/gl/target.h"
#include "render/gl/timer.h"
#include "render/point_surface.h"
#include "render/points/point_blocks.h"
#include "render/raster/triangle_strips.h"

/* A span of the surface: what drawing needs to know on the CPU. */
typedef struct iso_gl_span {
    int32_t brick[3];
    uint32_t count;     /* points, or indices */
    uint32_t first;     /* first point, or first index */
    uint32_t triangles; /* of a mesh */
    int32_t base;       /* vertex that indices count from */
    bool changed;       /* by the last update */
    uint64_t version;   /* of the uploaded data; 0: none */
    size_t place[2];    /* first point, or first vertex and triangle, of the uploaded data */
    iso_box box;        /* index coordinates */
    double radius;      /* largest radius of its points, mm; 0 for triangles */
} iso_gl_span;

typedef struct iso_gl_buffer {
    unsigned name;
    size_t room; /* capacity, items */
} iso_gl_buffer;

/* Per-instance data of points: the span or block that they belong to. */
typedef struct iso_gl_instance {
    float origin[3]; /* view space position that the points' steps count from */
    float place[4];  /* index coordinates of that position; see ISO_GL_PLACE */
} iso_gl_instance;

/* Draw commands in OpenGL's layout (DrawArraysIndirectCommand, DrawElementsIndirectCommand). */
typedef struct iso_gl_points_command {
    uint32_t count, instances, first, first_instance;
} iso_gl_points_command;

typedef struct iso_gl_mesh_command {
    uint32_t count, instances, first;
    int32_t base;
    uint32_t first_instance;
} iso_gl_mesh_command;

/* Which blocks of points, and which of their points, the last picture showed (selection.h). */
typedef struct iso_gl_seen {
    iso_buffer flags; /* uint8_t, one a block */
    size_t count;     /* of blocks; 0: not known */
    /* Buffers of a bit for each point, 1: its disc made fronts; of this picture, and of the one before. */
    unsigned fronts[2];
    size_t room; /* points that they have bits for */
} iso_gl_seen;

struct iso_gl_surface {
    iso_gl_engine *engine;
    iso_transform transform;
    iso_buffer spans; /* of iso_gl_span */
    size_t span_count;
    bool mesh, stripped, surfels, has_radii, has_colors, has_curvatures, closed;
    iso_buffer bounds;        /* of a closed mesh: an iso_point_bounds per span */
    iso_gl_seen *seen;        /* of points. Owned */
    iso_point_blocks *blocks; /* of points; a block's `first` counts from its span's first point. Owned */
    double radius;            /* mm, of all points when there are no radii */
    float radii_scale;        /* what radii of the points' own are multiplied by as discs */
    int32_t dims[3];          /* voxels of the grid that the points come from; 0: not known */
    uint64_t uploaded;        /* bytes, by the last update */
    iso_triangle_strips strips;
    /* `array` draws points or triangles, `quad_array` points as quads. */
    iso_gl_buffer vertices, radii, colors, curvatures, indices;
    unsigned array, quad_array;
};

/* Buffers of pull-push and the method discs; see the slots of the same names in shared.h. */
typedef enum iso_gl_storage {
    ISO_GL_STORE_UNIFORMS,
    ISO_GL_STORE_DISC_UNIFORMS, /* uniforms of discs */
    ISO_GL_STORE_BLOCKS,
    ISO_GL_STORE_KEYS,
    ISO_GL_STORE_DISCS,
    ISO_GL_STORE_SHADES,
    ISO_GL_STORE_RANGES,
    ISO_GL_STORE_ELLIPSES,
    ISO_GL_STORE_REACHES,
    ISO_GL_STORE_TINTS,
    ISO_GL_STORE_PICTURE,
    ISO_GL_STORE_SPLATTING, /* uniforms of splats */
    ISO_GL_STORE_SPLATS,
    ISO_GL_STORE_SLOTS,
    ISO_GL_STORE_SHAPING, /* uniforms of lines and glyphs */
    ISO_GL_STORE_NEAR_SHAPES,
    ISO_GL_STORE_LOOKS, /* of layers of splats, as the next ones */
    ISO_GL_STORE_TILE_STARTS,
    ISO_GL_STORE_TILE_DISCS,
    ISO_GL_STORE_LAYER_BOUNDS,
    ISO_GL_STORE_LAYERS,
    ISO_GL_STORE_HITS,
    ISO_GL_STORE_CELLS, /* of the selection of points, as the next ones */
    ISO_GL_STORE_MARKED,
    ISO_GL_STORE_VISIBLE, /* a bit for each point of blocks that are tested: the fronts do not hide it */
    ISO_GL_STORE_CHOSEN,
    ISO_GL_STORE_ELEMENTS,
    ISO_GL_STORE_TOTAL,
    ISO_GL_STORE_DEEPEST
} iso_gl_storage;
enum { ISO_GL_STORES = 29 };

/* Render targets of the method discs: nearest depths and sums. At least as large as a tile. */
typedef struct iso_gl_disc_targets {
    int width, height;
    unsigned framebuffers[2], fronts, sums[4];
} iso_gl_disc_targets;

/* What lines and glyphs are drawn into, and how. */
typedef struct iso_gl_shapes_target {
    iso_gl_target target;        /* its second texture: ISO_GL_IDS */
    unsigned quads;              /* indices of the quads of a block */
    unsigned array, empty_array; /* vertex arrays: with origins as per-instance data; without inputs */
} iso_gl_shapes_target;

struct iso_gl_engine {
    iso_gl_context *context;
    unsigned programs[ISO_GL_PROGRAMS]; /* 0: not compiled yet */
    int max_side;                       /* samples, of the largest part that is drawn at once */
    double max_point;                   /* the driver's largest point, pixels */
    iso_gl_target target;               /* of surfaces; its second texture: ISO_GL_SURFACE */
    iso_gl_disc_targets discs;
    iso_gl_shapes_target shapes;
    unsigned draw_uniforms, commands, instances; /* buffers */
    bool keep_back_facing;                       /* for tests: draw back-facing spans too */
    size_t drawn,
        back_facing; /* spans drawn and left out by the last draw, counted in every part of the picture */
    /* Buffers that grow as needed; 0: not needed yet. */
    unsigned storage[ISO_GL_STORES];
    size_t storage_bytes[ISO_GL_STORES];
    size_t max_storage;             /* bytes of the largest storage buffer that shaders can access */
    bool vertex_storage;            /* vertex shaders have storage buffers */
    iso_selection_counts selection; /* in all pictures with selection */
    bool keep_holes; /* for tests: the selection does not look at blocks that the frame before did not show */
    bool wide_atomics; /* 64-bit atomic operations in storage buffers */
    iso_gl_timer timer;
};

/* The OpenGL name of a program, which is compiled on first use. ISO_ERR_BACKEND. */
iso_status iso_gl_engine_program(iso_gl_engine *engine, iso_gl_program program, unsigned *name,
                                 iso_error *error);

/* A texture of one level, uninitialised. */
unsigned iso_gl_make_texture(const GladGLContext *gl, unsigned format, int width, int height);

/* Makes a storage buffer at least this large; its contents are lost when it has to grow. */
void iso_gl_engine_ensure_storage(iso_gl_engine *engine, iso_gl_storage which, size_t bytes);
/* The same, and binds the buffer to a slot of the shaders. `what` is what needs it, for the message.
 * ISO_ERR_LIMIT: the driver's buffers are smaller. */
iso_status iso_gl_engine_provide_storage(iso_gl_engine *engine, iso_gl_storage which, unsigned slot,
                                         size_t bytes, const char *what, iso_error *error);

/* Draws surfaces into the engine's framebuffer, and leaves them there: row by row as in a picture, infinite
 * depths where nothing is. The context must be current. ISO_ERR_LIMIT: the view is too large for it;
 * ISO_ERR_NOMEM, ISO_ERR_BACKEND. */
iso_status iso_gl_draw_target(iso_gl_engine *engine, const iso_gl_draw_opts *opts, iso_error *error);

/* Pixels by which the viewport is wider than the picture on each side: half the widest point, as OpenGL
 * drops points whose centres are outside the viewport. */
static inline int iso_gl_engine_margin(const iso_gl_engine *engine) {
    return (int)(engine->max_point / 2) + 1;
}

/* ISO_ERR_LIMIT when a copy of so many bytes does not fit into free memory: software renderers keep
 * buffers in main memory and are killed when it runs out. */
iso_status iso_gl_check_memory(const iso_gl_engine *engine, uint64_t bytes, iso_error *error);

/* Makes a surface of points an instance of those that were uploaded, which must be the same arrays: of other
 * spans of them, with another transform and other sizes. Nothing is uploaded. ISO_ERR_NOMEM. */
iso_status iso_gl_surface_place(iso_gl_surface *surface, const iso_point_view *points, iso_error *error);

/* Uploads the commands (iso_gl_points_command or iso_gl_mesh_command) and per-instance data
 * (iso_gl_instance, or three int32_t with a mesh's brick) of a multi-draw; they stay until the next call. */
void iso_gl_surface_command(const iso_gl_surface *surface, size_t count, const void *commands,
                            const void *instances);
/* Executes the uploaded commands with the program in use; of points also some of them. */
void iso_gl_surface_draw(const iso_gl_surface *surface, size_t count);
void iso_gl_surface_draw_range(const iso_gl_surface *surface, size_t first, size_t count);
/* Executes some commands of ISO_GL_STORE_ELEMENTS, which draw points of ISO_GL_STORE_CHOSEN. */
void iso_gl_surface_draw_chosen(const iso_gl_surface *surface, size_t first, size_t count);
/* Draws `count` points from `first` on as quads with the program in use. */
void iso_gl_surface_draw_quads(const iso_gl_surface *surface, size_t first, size_t count,
                               const iso_gl_instance *instance);

#endif
