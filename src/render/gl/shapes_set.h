/* shapes_set: lines and glyphs in GPU memory, and their framebuffer. Inside render/gl only. */
#ifndef ISO_RENDER_GL_SHAPES_SET_H
#define ISO_RENDER_GL_SHAPES_SET_H

#include "render/gl/shapes.h"
#include "render/gl/surface.h"
#include "render/shapes/solid.h"

struct iso_gl_shapes {
    iso_gl_engine *engine;
    const iso_shapes *set;
    uint32_t *starts;             /* by block: its first shape on the GPU */
    unsigned data, marks, colors; /* buffers: ISO_GL_SHAPES, ISO_GL_MARKS, ISO_GL_LINE_COLORS; 0: none */
};

/* Deletes what the engine has made for drawing shapes. The context must be current. */
void iso_gl_shapes_target_free(iso_gl_shapes_target *target, const GladGLContext *gl);

/* The centre of a solid as it is uploaded, relative to its block's origin; place: in the order of blocks. */
void iso_gl_solid_centre(const iso_shapes *set, uint32_t place, const iso_solid_map *map, float centre[3]);

/* A colour as the shaders read it; 0 without colours. */
static inline uint32_t iso_gl_shape_color(const iso_shapes *set, size_t id) {
    if (!set->colors) return 0;
    const uint8_t *c = set->colors[id];
    return (uint32_t)c[0] | (uint32_t)c[1] << 8 | (uint32_t)c[2] << 16;
}

#endif
