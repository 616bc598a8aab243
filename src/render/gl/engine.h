/* engine: points and meshes into a gbuffer by OpenGL, with the conventions of render/raster/raster.h.
 *
 * The gbuffer is read back and shaded by render/shading/shading.h, as the cpu engine's is: pictures of both
 * engines agree but for pixels where rounding decides. An engine is used by one thread at a time, as its
 * context is.
 */
#ifndef ISO_RENDER_GL_ENGINE_H
#define ISO_RENDER_GL_ENGINE_H

#include "base/primitives.h"
#include "image/camera.h"
#include "render/gbuffer.h"
#include "render/gl/context.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct iso_gl_engine iso_gl_engine;

/* The context is kept, and must live as long as the engine. ISO_ERR_NOMEM, ISO_ERR_BACKEND. */
iso_status iso_gl_engine_create(iso_gl_context *context, iso_gl_engine **engine, iso_error *error);
/* Its shapes must be gone. NULL is fine. */
void iso_gl_engine_destroy(iso_gl_engine *engine);

/* The largest picture, in samples: reading it back takes minutes where the cpu engine takes one. */
#define ISO_GL_SAMPLES_MAX (UINT64_C(1) << 32)

/* Bytes that drawing takes from the GPU, or where the driver has none from main memory, for pictures of this
 * many samples: the same for all above the size of a part. */
uint64_t iso_gl_draw_bytes(const iso_gl_engine *engine, int width, int height);

/* What the GPU does for pictures: points or triangles (draw), and the steps of pull-push and of its refined
 * reconstruction. */
typedef enum iso_gl_pass {
    ISO_GL_PASS_DRAW,
    ISO_GL_PASS_PROJECT,
    ISO_GL_PASS_PULL,
    ISO_GL_PASS_PUSH,
    ISO_GL_PASS_FINISH,
    ISO_GL_PASS_FRONT,
    ISO_GL_PASS_ADD,
    ISO_GL_PASS_SETTLE
} iso_gl_pass;
enum { ISO_GL_PASSES = 8 };
const char *iso_gl_pass_name(iso_gl_pass pass); /* "draw", "project", .. */

/* Seconds that the GPU took for each, by its own clock (software renderers: by the computer's), in all
 * pictures since the engine was made or told to forget. */
void iso_gl_engine_seconds(const iso_gl_engine *engine, double seconds[ISO_GL_PASSES]);
void iso_gl_engine_forget_seconds(iso_gl_engine *engine);

/* A surface in the GPU's memory: copied, so that the view's owner may change it. What lies between the view's
 * spans takes room there as it does in the view. Errors: ISO_ERR_NOMEM, ISO_ERR_LIMIT (2^31 vertices, 2^32
 * points, 2^30 triangles; main memory, where the driver has no other), ISO_ERR_BACKEND. Keeps the engine. */
typedef struct iso_gl_surface iso_gl_surface;
iso_status iso_gl_upload_points(iso_gl_engine *engine, const iso_point_view *points, iso_gl_surface **shape,
                                iso_error *error);
iso_status iso_gl_upload_mesh(iso_gl_engine *engine, const iso_mesh_view *mesh, iso_gl_surface **shape,
                              iso_error *error);
/* The mesh as triangle strips (2003, section 5), brick by brick: the same picture from fewer indices. */
iso_status iso_gl_upload_strips(iso_gl_engine *engine, const iso_mesh_view *mesh, iso_gl_surface **shape,
                                iso_error *error);

/* Another view of the same set, later: only spans that changed are uploaded, which the view's stamps tell.
 * Points keep their kind: packed or not, with radii, colours and shapes or without. After a failure the shape
 * is empty until an update succeeds. */
iso_status iso_gl_update_points(iso_gl_surface *shape, const iso_point_view *points, iso_error *error);
iso_status iso_gl_update_mesh(iso_gl_surface *shape, const iso_mesh_view *mesh, iso_error *error);
void iso_gl_surface_destroy(iso_gl_surface *shape);

typedef struct iso_gl_surface_stats {
    uint64_t uploaded; /* bytes, by the upload or the last update */
    /* Of a mesh: triangles, and the indices that draw them, restarts included (2003, table 2, compares these
     * with three a triangle). */
    size_t triangles, indices;
} iso_gl_surface_stats;
iso_gl_surface_stats iso_gl_surface_measure(const iso_gl_surface *shape);

/* How wide points are (2003, section 4.1). */
typedef enum iso_point_scaling {
    ISO_SCALING_EXACT,     /* eq. 3-4: by depth z, as the cpu engine does */
    ISO_SCALING_ATTENUATED /* eq. 5-8: by the distance to the eye d, with z >= d sqrt(k) everywhere in the
                              picture, as fixed-function OpenGL had it: never narrower than the exact ones */
} iso_point_scaling;

typedef struct iso_gl_draw_opts {
    const iso_view *view;                /* borrowed */
    const iso_gl_surface *const *shapes; /* shape i is surface i of the gbuffer */
    int shape_count;
    iso_point_scaling scaling;
    /* Attenuated: tangents of half the angles of the whole picture, across and upwards; for a picture that is
     * not square k = 1 / (1 + tan_x^2 + tan_y^2). 0: those of `view`, which is then the whole picture. */
    double tan_x, tan_y;
} iso_gl_draw_opts;

/* Draws all shapes and fills the whole gbuffer, which has the view's size. Pictures larger than the driver's
 * limits are drawn in parts. Errors: ISO_ERR_NOMEM, ISO_ERR_BACKEND; the gbuffer is then undefined. */
iso_status iso_gl_draw(iso_gl_engine *engine, const iso_gl_draw_opts *opts, iso_gbuffer *gbuffer,
                       iso_error *error);

#ifdef __cplusplus
}
#endif
#endif
