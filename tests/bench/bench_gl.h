/* bench_gl: frames by OpenGL, by the best that this machine has: a GPU, else Mesa's software renderer. */
#ifndef ISO_TESTS_BENCH_GL_H
#define ISO_TESTS_BENCH_GL_H

#include "bench_frame.h"
#include "render/gl/engine.h"

typedef struct bench_gl {
    iso_gl_context *context; /* NULL: there is none */
    iso_gl_engine *engine;
    char name[32]; /* what draws, as rows are named: "llvmpipe" */
} bench_gl;

/* Without OpenGL there are no rows, and it is said why. ISO_ERR_NOMEM. */
iso_status bench_gl_open(bench_gl *gl, iso_error *error);
void bench_gl_close(bench_gl *gl);

/* points, mesh and pull-push; their frames' row->plan->gl is a bench_gl. */
extern const bench_method bench_gl_methods[];
extern const int bench_gl_method_count;

/* One line for the row of most points that was run: what its projection is bounded by. `row` is one of
 * pull-push that has its numbers. */
void bench_gl_say_limit(const bench_gl *gl, const bench_row *row);

#endif
