/* state: what a context that others draw with too is set to, taken down and put back. Inside render/gl only.
 */
#ifndef ISO_RENDER_GL_STATE_H
#define ISO_RENDER_GL_STATE_H

#include <stdbool.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct GladGLContext GladGLContext;

enum {
    ISO_GL_SWITCHES = 14,
    ISO_GL_PIXEL_STORES = 8,
    ISO_GL_BINDINGS = 5,
    ISO_GL_ATTRIBUTES = 3,
    ISO_GL_BLENDS = 4, /* outputs that draws blend */
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

/* Takes down what there is and sets what we do not set ourselves to what we count on, which is what OpenGL
 * begins with. With the context current, like all here. */
void iso_gl_state_save(iso_gl_state *state, const GladGLContext *gl);
/* Puts it back. What shaders read by numbered slots is unbound. */
void iso_gl_state_restore(const iso_gl_state *state, const GladGLContext *gl);

#ifdef __cplusplus
}
#endif
#endif
