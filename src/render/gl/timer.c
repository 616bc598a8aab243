/* timer: GL_TIME_ELAPSED queries, or the computer's clock for software renderers. */
#include "render/gl/timer.h"

#include <glad/gl.h>
#include <string.h>

#include "base/clock.h"
#include "render/gl/surface.h"

static double finished_at(const GladGLContext *gl) {
    gl->Finish();
    return iso_clock_seconds();
}

void iso_gl_timer_begin(iso_gl_timer *timer, const GladGLContext *gl, iso_gl_pass pass) {
    if (timer->by_clock) {
        timer->running = pass;
        timer->start = finished_at(gl);
        return;
    }
    if (timer->pending == ISO_GL_QUERIES) iso_gl_timer_read(timer, gl);
    int next = timer->pending++;
    if (!timer->queries[next]) gl->CreateQueries(GL_TIME_ELAPSED, 1, &timer->queries[next]);
    timer->pass[next] = pass;
    gl->BeginQuery(GL_TIME_ELAPSED, timer->queries[next]);
}

void iso_gl_timer_end(iso_gl_timer *timer, const GladGLContext *gl) {
    if (timer->by_clock)
        timer->seconds[timer->running] += finished_at(gl) - timer->start;
    else
        gl->EndQuery(GL_TIME_ELAPSED);
}

void iso_gl_timer_read(iso_gl_timer *timer, const GladGLContext *gl) {
    for (int i = 0; i < timer->pending; i++) {
        GLuint64 nanoseconds = 0;
        gl->GetQueryObjectui64v(timer->queries[i], GL_QUERY_RESULT, &nanoseconds);
        timer->seconds[timer->pass[i]] += 1e-9 * (double)nanoseconds;
    }
    timer->pending = 0;
}

void iso_gl_timer_free(iso_gl_timer *timer, const GladGLContext *gl) {
    gl->DeleteQueries(ISO_GL_QUERIES, timer->queries); /* 0 is ignored */
    *timer = (iso_gl_timer){.by_clock = timer->by_clock};
}

const char *iso_gl_pass_name(iso_gl_pass pass) {
    static const char *const names[ISO_GL_PASSES] = {"draw",  "project", "pull",    "push",  "finish",
                                                     "front", "add",     "resolve", "select"};
    return names[pass];
}

void iso_gl_engine_seconds(const iso_gl_engine *engine, double seconds[ISO_GL_PASSES]) {
    memcpy(seconds, engine->timer.seconds, sizeof engine->timer.seconds);
}

void iso_gl_engine_reset_seconds(iso_gl_engine *engine) {
    memset(engine->timer.seconds, 0, sizeof engine->timer.seconds);
}
