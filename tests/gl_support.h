/* gl_support: what the tests of the gl engine share. */
#ifndef ISO_TESTS_GL_SUPPORT_H
#define ISO_TESTS_GL_SUPPORT_H

#include <stdbool.h>

#include "base/primitives.h"
#include "image/camera.h"
#include "render/gbuffer.h"
#include "render/gl/engine.h"

/* Contexts that tests draw with: those of this list that can be had here. */
typedef struct gl_contexts {
    iso_gl_context *context[ISO_GL_KINDS];
    int count;
} gl_contexts;

/* Says which are missing and why. False when there is none. */
bool gl_contexts_open(gl_contexts *contexts);
/* Fails the test when a driver said something above a notification. */
void gl_contexts_close(gl_contexts *contexts);

/* How the pictures of two gbuffers of one view differ when they are shaded. */
typedef struct gl_difference {
    double psnr;         /* dB */
    int differ, outline; /* pixels covered in one only; pixels of the first one's outline */
    double depth;        /* largest difference where both are covered and equally near, in mm */
} gl_difference;
gl_difference gl_compare(const iso_view *view, const iso_gbuffer *a, const iso_gbuffer *b);

/* A new gbuffer of the view's size. */
iso_gbuffer gl_gbuffer(const iso_view *view);

/* The same view by both engines: PSNR >= 40 dB, at most 1 % of the outline's pixels differ. */
void gl_check_points(iso_gl_engine *engine, const iso_view *view, const iso_point_view *points,
                     const char *name);
void gl_check_mesh(iso_gl_engine *engine, const iso_view *view, const iso_mesh_view *mesh, const char *name);

#endif
