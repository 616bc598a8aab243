/* gl_support: what the tests of the gl engine share. */
#ifndef ISO_TESTS_GL_SUPPORT_H
#define ISO_TESTS_GL_SUPPORT_H

#include <stdbool.h>

#include "base/primitives.h"
#include "extract/mesh/mesh.h"
#include "extract/points/points.h"
#include "image/camera.h"
#include "image/image.h"
#include "render/gbuffer.h"
#include "render/gl/pullpush.h"

/* Contexts that tests draw with: those of this list that can be had here. */
typedef struct gl_contexts {
    iso_gl_context *context[ISO_GL_KINDS];
    int count;
} gl_contexts;

/* Says which are missing and why. False when there is none. */
bool gl_contexts_open(gl_contexts *contexts);
/* Fails the test when a driver said something above a notification. */
void gl_contexts_close(gl_contexts *contexts);

/* Tests of every context that can be had here, or of an engine on each; skipped where there is none. In lists
 * of tests: gl_context_test(check), gl_engine_test(check). */
typedef void gl_context_check(iso_gl_context *context);
typedef void gl_engine_check(iso_gl_engine *engine);
void gl_on_each_context(void **state);
void gl_on_each_engine(void **state);
#define gl_context_test(check)                                                                               \
    {                                                                                                        \
#check, gl_on_each_context, NULL, NULL, &(gl_context_check *) {                                      \
            check                                                                                            \
        }                                                                                                    \
    }
#define gl_engine_test(check)                                                                                \
    {                                                                                                        \
#check, gl_on_each_engine, NULL, NULL, &(gl_engine_check *) {                                        \
            check                                                                                            \
        }                                                                                                    \
    }

/* How the pictures of two gbuffers of one view differ when they are shaded. */
typedef struct gl_difference {
    double psnr;         /* dB */
    int differ, outline; /* pixels covered in one only; pixels of the first one's outline */
    int turned;          /* pixels covered in both, with normals to opposite sides */
    double depth;        /* largest difference where both are covered and equally near, in mm */
} gl_difference;
gl_difference gl_compare(const iso_view *view, const iso_gbuffer *a, const iso_gbuffer *b);

/* Of pictures of one size, dB. */
double gl_psnr(const iso_image *a, const iso_image *b);

/* A new gbuffer of the view's size. */
iso_gbuffer gl_gbuffer(const iso_view *view);

enum { GL_SIDES = 6 };

/* What is seen from a side, all of it. */
iso_view gl_side_view(const iso_box *box, int side, bool orthographic, int width, int height);

/* A grid's surface in all forms; the grid is kept. */
typedef struct gl_surface {
    iso_point_set *packed, *floats;
    iso_mesh_set *mesh;
    iso_box box; /* world */
} gl_surface;
gl_surface gl_surface_make(const iso_grid *grid, double isovalue);
void gl_surface_free(gl_surface *surface);

/* Edge points with shapes, as refined wants them. */
iso_point_set *gl_discs_make(const iso_grid *grid, double isovalue, bool floats);

/* The same views by both engines: PSNR >= 40 dB, at most 1 % of the outline's pixels differ, and normals
 * are turned in at most twice as many. Returns the lowest PSNR. */
double gl_check_points(iso_gl_engine *engine, const iso_point_view *points, const iso_view *views, int count,
                       const char *name);
double gl_check_pullpush(iso_gl_engine *engine, const iso_point_view *points,
                         iso_reconstruction reconstruction, const iso_view *views, int count,
                         const char *name);
double gl_check_mesh(iso_gl_engine *engine, const iso_mesh_view *mesh, const iso_view *views, int count,
                     const char *name);

#endif
