/* timer: measures how long passes take on the GPU. Inside render/gl only. */
#ifndef ISO_RENDER_GL_TIMER_H
#define ISO_RENDER_GL_TIMER_H

#include "render/gl/engine.h"
#include "render/gl/internal.h"

enum { ISO_GL_QUERIES = 64 };

/* Zero-initialise; set by_clock for software renderers: timer queries of llvmpipe (Mesa 22.3) begin and
 * end when a framebuffer is drawn to, so that they do not measure compute shaders. */
typedef struct iso_gl_timer {
    bool by_clock; /* wait for each pass and measure with CLOCK_MONOTONIC, instead of GPU queries */
    double start;  /* of the running pass, seconds of that clock */
    iso_gl_pass running;
    unsigned queries[ISO_GL_QUERIES]; /* 0: not made so far */
    iso_gl_pass pass[ISO_GL_QUERIES]; /* what each measures */
    int pending;                      /* queries in use, not read yet */
    double seconds[ISO_GL_PASSES];
} iso_gl_timer;

/* The commands between the two are one pass; passes must not overlap. The context must be current, here
 * and below. */
void iso_gl_timer_begin(iso_gl_timer *timer, const GladGLContext *gl, iso_gl_pass pass);
void iso_gl_timer_end(iso_gl_timer *timer, const GladGLContext *gl);
/* Waits for the pending queries and adds their times to `seconds`. */
void iso_gl_timer_read(iso_gl_timer *timer, const GladGLContext *gl);
void iso_gl_timer_free(iso_gl_timer *timer, const GladGLContext *gl);

#endif
