/* state: saves and restores the OpenGL state of a context that is shared with other code (Dear ImGui, a host
 * application). Inside render/gl only. */
#ifndef ISO_RENDER_GL_STATE_H
#define ISO_RENDER_GL_STATE_H

#include <stdbool.h>

typedef struct GladGLContext GladGLContext;

enum {
    ISO_GL_SWITCHES = 14,
    ISO_GL_PIXEL_STORES = 8,
    ISO_GL_BINDINGS = 5,
    ISO_GL_ATTRIBUTES = 3,
    ISO_GL_BLENDS = 4, /* colour outputs with blending */
    ISO_GL_BLEND_VALUES = 6
};

typedef struct iso_gl_state {
    bool on[ISO_GL_SWITCHES];
    int pixel_store[ISO_GL_PIXEL_STORES], binding[ISO_GL_BINDINGS];
    int draw_framebuffer, read_framebuffer, program, array;
    int viewport[4], scissor[4], depth_func, clip_origin, clip_depth, polygon_mode[2];
    unsigned char depth_mask, color_mask[4];
    float attribute[ISO_GL_ATTRIBUTES][4];
    int blend[ISO_GL_BLENDS][ISO_GL_BLEND_VALUES];
} iso_gl_state;

/* Saves the state that drawing changes or depends on, then resets to OpenGL's defaults what drawing
 * depends on but does not set itself. The context must be current, here and below. */
void iso_gl_state_save(iso_gl_state *state, const GladGLContext *gl);
/* Restores the saved state. Uniform buffers, storage buffers, textures and images bound to numbered slots are
 * not saved: the slots that this renderer uses are unbound. */
void iso_gl_state_restore(const iso_gl_state *state, const GladGLContext *gl);

#endif
