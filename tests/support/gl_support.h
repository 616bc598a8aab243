/* gl_support: contexts, pictures and comparisons for the tests of the gl engine. */
#ifndef ISO_TESTS_GL_SUPPORT_H
#define ISO_TESTS_GL_SUPPORT_H

#include <stdbool.h>

#include "base/primitives.h"
#include "extract/mesh/mesh.h"
#include "extract/points/points.h"
#include "image/camera.h"
#include "image/image.h"
#include "render/gl/pullpush.h"
#include "render/view/gbuffer.h"

/* The contexts that tests draw with: one of each kind that this machine has. */
typedef struct gl_contexts {
    iso_gl_context *context[ISO_GL_KINDS];
    int count;
} gl_contexts;

/* Opens contexts, and prints which are missing and why. False when there is none. */
bool gl_contexts_open(gl_contexts *contexts);
/* Closes contexts; fails the test when a driver reported more than notifications. */
void gl_contexts_close(gl_contexts *contexts);

/* Tests that are executed with every context that this machine has, with an engine on each, or with an engine
 * on the first one, which is enough for most: the others differ in how they are created, and draw by the same
 * driver. Skipped if there is none. In lists of tests: gl_context_test(check), gl_each_engine_test(check),
 * gl_engine_test(check). */
typedef void gl_context_check(iso_gl_context *context);
typedef void gl_engine_check(iso_gl_engine *engine);
void gl_on_each_context(void **state);
void gl_on_each_engine(void **state);
void gl_on_first_engine(void **state);
#define gl_context_test(check)                                                                               \
    {                                                                                                        \
#check, gl_on_each_context, NULL, NULL, &(gl_context_check *) {                                      \
            check                                                                                            \
        }                                                                                                    \
    }
#define gl_each_engine_test(check)                                                                           \
    {                                                                                                        \
#check, gl_on_each_engine, NULL, NULL, &(gl_engine_check *) {                                        \
            check                                                                                            \
        }                                                                                                    \
    }
#define gl_engine_test(check)                                                                                \
    {                                                                                                        \
#check, gl_on_first_engine, NULL, NULL, &(gl_engine_check *) {                                       \
            check                                                                                            \
        }                                                                                                    \
    }

/* Differences between two gbuffers of one view and their shaded pictures. */
typedef struct gl_difference {
    double psnr;         /* dB */
    int differ, outline; /* pixels covered in one gbuffer only; pixels of the first one's outline */
    int turned;          /* pixels covered in both, whose normals point to opposite sides */
    double depth;        /* largest difference where both are covered and equally near, in mm */
} gl_difference;
gl_difference gl_compare(const iso_view *view, const iso_gbuffer *a, const iso_gbuffer *b);

/* The PSNR of two pictures of the same size, dB. */
double gl_psnr(const iso_image *a, const iso_image *b);

/* A new gbuffer of the view's size. */
iso_gbuffer gl_gbuffer(const iso_view *view);

enum { GL_SIDES = 6 };

/* A view of a whole box from one of its sides. */
iso_view gl_side_view(const iso_box *box, int side, bool orthographic, int width, int height);

/* A grid's surface as points and as a mesh; borrows the grid. */
typedef struct gl_surface {
    iso_point_set *packed, *floats;
    iso_mesh_set *mesh;
    iso_box box; /* world */
} gl_surface;
gl_surface gl_surface_make(const iso_grid *grid, double isovalue);
void gl_surface_free(gl_surface *surface);

/* Edge points with curvatures, for the method discs. */
iso_point_set *gl_discs_make(const iso_grid *grid, double isovalue, bool floats);

/* Draw the same views by both engines; fail the test unless PSNR >= 40 dB, pixels that only one covers are at
 * most 1 % of the outline's, and turned normals at most twice as many. Return the lowest PSNR. */
double gl_check_points(iso_gl_engine *engine, const iso_point_view *points, const iso_view *views, int count,
                       const char *name);
double gl_check_pullpush(iso_gl_engine *engine, const iso_point_view *points,
                         iso_reconstruction reconstruction, const iso_view *views, int count,
                         const char *name);
double gl_check_mesh(iso_gl_engine *engine, const iso_mesh_view *mesh, const iso_view *views, int count,
                     const char *name);

#endif
