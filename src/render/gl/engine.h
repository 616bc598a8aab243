/* engine: draws points and meshes into a gbuffer by OpenGL, with the conventions of
 * render/raster/raster.h.
 *
 * The gbuffer is read back and shaded by render/shading/shading.h like the cpu engine's: pictures of both
 * engines agree except at pixels where rounding decides. An engine and its context are used by one thread
 * at a time. */
#ifndef ISO_RENDER_GL_ENGINE_H
#define ISO_RENDER_GL_ENGINE_H

#include "base/primitives.h"
#include "image/camera.h"
#include "render/gl/context.h"
#include "render/points/reconstruction.h"
#include "render/view/gbuffer.h"

typedef struct iso_gl_engine iso_gl_engine;

/* The context is borrowed and must outlive the engine. ISO_ERR_NOMEM, ISO_ERR_BACKEND. */
iso_status iso_gl_engine_create(iso_gl_context *context, iso_gl_engine **engine, iso_error *error);
/* The engine's surfaces must have been destroyed. NULL is fine. */
void iso_gl_engine_destroy(iso_gl_engine *engine);

/* Most samples of a picture that the programs draw by OpenGL: reading more back takes minutes. */
#define ISO_GL_SAMPLES_MAX (UINT64_C(1) << 32)

/* Bytes of GPU memory (of main memory with a software renderer) that drawing takes for a picture of width
 * x height samples. Pictures are drawn in parts of limited size, so the number does not grow beyond that
 * of a part. */
uint64_t iso_gl_draw_bytes(const iso_gl_engine *engine, int width, int height);

/* The counts of all pictures in which the engine has selected points: points; those in
 * blocks that were looked at; those drawn. Points that two parts of a picture show are counted for each. */
iso_selection_counts iso_gl_engine_selection(const iso_gl_engine *engine);

/* What is timed: drawing points, triangles, lines or glyphs (draw), the steps of pull-push (project ..
 * finish) and those of the method discs (front .. resolve, and select: the choice of points). */
typedef enum iso_gl_pass {
    ISO_GL_PASS_DRAW,
    ISO_GL_PASS_PROJECT,
    ISO_GL_PASS_PULL,
    ISO_GL_PASS_PUSH,
    ISO_GL_PASS_FINISH,
    ISO_GL_PASS_FRONT,
    ISO_GL_PASS_ADD,
    ISO_GL_PASS_RESOLVE,
    ISO_GL_PASS_SELECT
} iso_gl_pass;
enum { ISO_GL_PASSES = 9 };
const char *iso_gl_pass_name(iso_gl_pass pass); /* "draw", "project", .. */

/* Seconds of GPU time (of the computer's clock with a software renderer) per pass, summed over all
 * pictures since the engine was created or last reset. */
void iso_gl_engine_seconds(const iso_gl_engine *engine, double seconds[ISO_GL_PASSES]);
void iso_gl_engine_reset_seconds(iso_gl_engine *engine);

/* A surface in GPU memory: a copy of a view, so that the view's owner may change the original. Gaps
 * between the view's spans are copied too. The engine is borrowed and must outlive the surface. Errors:
 * ISO_ERR_NOMEM, ISO_ERR_LIMIT (2^31 vertices, 2^32 points, 2^30 triangles; free main memory with a
 * software renderer), ISO_ERR_BACKEND. */
typedef struct iso_gl_surface iso_gl_surface;
iso_status iso_gl_upload_points(iso_gl_engine *engine, const iso_point_view *points, iso_gl_surface **surface,
                                iso_error *error);
iso_status iso_gl_upload_mesh(iso_gl_engine *engine, const iso_mesh_view *mesh, iso_gl_surface **surface,
                              iso_error *error);
/* Uploads the mesh as triangle strips, brick by brick (Baerentzen and Christensen 2003, section 5): the
 * same picture from fewer indices. */
iso_status iso_gl_upload_strips(iso_gl_engine *engine, const iso_mesh_view *mesh, iso_gl_surface **surface,
                                iso_error *error);

/* Brings a surface up to date with a later view of the same set. Only spans whose version or place changed
 * are uploaded (all of them when the view has no versions). Points must be of the same kind as before:
 * packed or floats, with or without radii, colours and curvatures. After a failure the surface is empty
 * until an update succeeds. */
iso_status iso_gl_update_points(iso_gl_surface *surface, const iso_point_view *points, iso_error *error);
iso_status iso_gl_update_mesh(iso_gl_surface *surface, const iso_mesh_view *mesh, iso_error *error);
void iso_gl_surface_destroy(iso_gl_surface *surface);

typedef struct iso_gl_surface_stats {
    uint64_t uploaded; /* bytes, by the upload or the last update */
    /* Of a mesh: triangles, and the indices that draw them, restarts included (2003, table 2, compares
     * their number with three per triangle). */
    size_t triangles, indices;
} iso_gl_surface_stats;
iso_gl_surface_stats iso_gl_surface_measure(const iso_gl_surface *surface);

/* Size of points in the picture (2003, section 4.1). */
typedef enum iso_point_scaling {
    ISO_SCALING_EXACT,     /* eq. 3-4: by depth z, as the cpu engine does */
    ISO_SCALING_ATTENUATED /* eq. 5-8: by the distance to the eye d, with z >= d sqrt(k) everywhere in the
                              picture, as fixed-function OpenGL had it: never narrower than the exact ones */
} iso_point_scaling;

typedef struct iso_gl_draw_opts {
    const iso_view *view;                  /* borrowed */
    const iso_gl_surface *const *surfaces; /* surfaces[i] gets number first_surface + i in the gbuffer */
    int surface_count, first_surface;
    bool keep; /* the gbuffer holds a picture: its samples are replaced where a surface is nearer */
    iso_point_scaling scaling;
    /* For attenuated points: tangents of half the horizontal and vertical angle of view of the whole picture,
     * of which `view` may be a part; k = 1 / (1 + tan_x^2 + tan_y^2). 0: `view` is the whole picture. */
    double tan_x, tan_y;
} iso_gl_draw_opts;

/* Draws all surfaces and, without opts->keep, fills the whole gbuffer, which must have the view's size.
 * Pictures larger than the driver's limits are drawn in parts. Errors: ISO_ERR_NOMEM, ISO_ERR_BACKEND; the
 * gbuffer is then undefined. */
iso_status iso_gl_draw(iso_gl_engine *engine, const iso_gl_draw_opts *opts, iso_gbuffer *gbuffer,
                       iso_error *error);

#endif
