/* view: what a window shows of a field, and what lies under its cursor. Knows no window.
 *
 * While the camera moves the picture has a lower resolution where the machine needs it; at rest, in the end,
 * four samples a pixel. A stroke redraws only the parts of an exact picture that it changed. Each method
 * re-extracts only what the change log names. All picture coordinates are pixels of the full picture, y down.
 */
#ifndef ISO_APPS_ISOSCULPT_VIEW_VIEW_H
#define ISO_APPS_ISOSCULPT_VIEW_VIEW_H

#include "apps/isosculpt/task.h"
#include "apps/isosculpt/view/damage.h"
#include "apps/isosculpt/view/gl.h"
#include "apps/isosculpt/view/lod.h"
#include "apps/isosculpt/view/shading.h"
#include "exact/exact.h"
#include "extract/mesh/mesh.h"
#include "extract/points/points.h"
#include "image/camera.h"
#include "image/image.h"
#include "render/gbuffer.h"
#include "render/pullpush/pullpush.h"

#ifdef __cplusplus
extern "C" {
#endif

/* What draws; exact is both the best and, on a processor, as fast as any. */
#define ISOSCULPT_METHODS(X)                                                                                 \
    X(EXACT, "exact")                                                                                        \
    X(PULLPUSH, "pullpush")                                                                                  \
    X(POINTS, "points")                                                                                      \
    X(MESH, "mesh")
typedef enum isosculpt_method {
#define ISOSCULPT_METHOD_ENUM(name, text) ISOSCULPT_##name,
    ISOSCULPT_METHODS(ISOSCULPT_METHOD_ENUM)
#undef ISOSCULPT_METHOD_ENUM
        ISOSCULPT_METHOD_COUNT
} isosculpt_method;
const char *isosculpt_method_name(isosculpt_method method);

/* Which engine. OpenGL has all methods but exact, which it stands in for with the mesh while the camera
 * moves; where something is frozen the cpu engine draws. */
typedef enum isosculpt_engine { ISOSCULPT_CPU, ISOSCULPT_GL } isosculpt_engine;

/* The last ISOSCULPT_LATENCIES times, seconds. Zero-initialise. */
enum { ISOSCULPT_LATENCIES = 256 };
typedef struct isosculpt_latency {
    double seconds[ISOSCULPT_LATENCIES];
    size_t count; /* ever added */
} isosculpt_latency;
void isosculpt_latency_add(isosculpt_latency *latency, double seconds);
/* 0 .. 1 of them are faster; 0 when there are none. */
double isosculpt_latency_quantile(const isosculpt_latency *latency, double quantile);

/* How good a picture is: drawn while the camera moves; at rest; with four samples a pixel. */
typedef enum isosculpt_quality { ISOSCULPT_MOVING, ISOSCULPT_REST, ISOSCULPT_FINE } isosculpt_quality;

typedef struct isosculpt_display_mode {
    isosculpt_method method;
    isosculpt_engine engine;
    isosculpt_material paint;
} isosculpt_display_mode;

/* Frozen voxels look darker. `at`: whether one is frozen; called by several threads. Zero: none are. */
typedef struct isosculpt_mask {
    bool (*at)(const void *context, int x, int y, int z);
    const void *context; /* borrowed */
} isosculpt_mask;

typedef struct isosculpt_async_surface isosculpt_async_surface;

/* A picture as it was drawn: what a stroke picks from, while newer ones are drawn. */
typedef struct isosculpt_layer {
    iso_gbuffer gbuffer;         /* room; the used part is view.width x view.height */
    const iso_gl_canvas *canvas; /* borrowed: what holds the samples instead; NULL: the gbuffer does */
    iso_view view;
    double samples; /* along a pixel of the full picture; 0: nothing was drawn yet */
} isosculpt_layer;

/* Zero-initialise. Camera and look may be changed between calls. */
typedef struct isosculpt_view {
    iso_camera camera;
    isosculpt_display_mode mode;
    isosculpt_mask mask;
    double isovalue; /* physical; of volumes */
    bool sliding;    /* the isovalue changes under the hand */
    int factor;      /* of pictures while the camera moves: 1 .. ISOSCULPT_FACTOR_MAX; found by their times */

    iso_grid grid;      /* borrowed */
    iso_pool *pool;     /* borrowed */
    isosculpt_gl *gl;   /* borrowed; NULL: the cpu engine draws all */
    iso_error gl_error; /* why OpenGL was given up for the cpu engine; text[0] == 0: it was not */
    iso_point_set *points;
    iso_mesh_set *mesh;
    iso_exact *exact;
    iso_pullpush *workspace;
    isosculpt_matcap sphere;

    /* Of a volume, NULL for a field: what is drawn until the surface of its isovalue is there, which a thread
     * of its own may make. */
    isosculpt_lod *levels;
    isosculpt_async_surface *async_surface;          /* that is being made; NULL: nothing is */
    iso_pool *async_surface_pool;                    /* the thread's, owned */
    double surface_isovalue[ISOSCULPT_METHOD_COUNT]; /* isovalue of each method's surface, of volumes; NAN:
                                                        none */
    double failed_isovalue;     /* the isovalue that a thread failed at: drawing tries it again, and says why;
                                   NAN: none */
    size_t point_count;         /* when points were last made */
    const iso_point_set *shown; /* points that OpenGL has */

    isosculpt_layer drawn, pick_layer; /* the last picture; the one that a stroke began on */
    iso_image image;   /* room; its width and height are the last picture's, unless drawn.canvas has that */
    size_t image_room; /* pixels */
    iso_gbuffer piece; /* room for a part of the picture */
    iso_image piece_image;
    size_t piece_room; /* pixels */

    /* What is in the image: */
    int width, height; /* the full picture */
    iso_camera drawn_camera;
    isosculpt_display_mode drawn_mode;
    double drawn_isovalue;
    isosculpt_quality quality;
    bool exactly;           /* the exact surface, at least one sample a pixel */
    uint64_t seen;          /* edits up to this one */
    bool repaint;           /* the mask changed */
    isosculpt_damage fresh; /* what the last call drew; pixels of the image */
    isosculpt_damage rough; /* what has one sample a pixel */

    isosculpt_latency extract, draw; /* draw: while the hand moves */
} isosculpt_view;

enum { ISOSCULPT_FACTOR_MAX = 3 };

/* Grid and pool are borrowed until free; the camera looks at the whole from the front. ISO_ERR_NOMEM. */
iso_status isosculpt_view_init(isosculpt_view *view, iso_hgrid *grid, iso_pool *pool, iso_error *error);
/* The same of any grid at an isovalue (physical). */
iso_status isosculpt_view_init_grid(isosculpt_view *view, const iso_grid *grid, double isovalue,
                                    iso_pool *pool, iso_error *error);
/* Another isovalue, from the next drawing on. */
void isosculpt_view_set_isovalue(isosculpt_view *view, double isovalue);
void isosculpt_view_free(isosculpt_view *view);

/* Brings view->image up to date; it is the picture's size or, while the camera moves, a factor smaller.
 * `moving`: it should be quick. ISO_ERR_NOMEM. */
iso_status isosculpt_view_draw(isosculpt_view *view, int width, int height, bool moving, iso_error *error);

/* Smooths a part of a picture at rest; view->quality is ISOSCULPT_FINE when nothing is left to do.
 * ISO_ERR_NOMEM. */
iso_status isosculpt_view_refine(isosculpt_view *view, iso_error *error);

/* Brings view->image up to date where drawn.canvas has the picture. ISO_ERR_NOMEM, ISO_ERR_BACKEND. */
iso_status isosculpt_view_fetch(isosculpt_view *view, iso_error *error);

/* Whether the picture at rest can be drawn without making a surface first, which could take long: always,
 * but for volumes. */
bool isosculpt_view_is_ready(isosculpt_view *view);
/* Makes it in a thread of its own, unless that is under way; `wake`: isosculpt_task_start. View and pool can
 * be used meanwhile; the isovalue may change, and what is made is then made for nothing. ISO_ERR_NOMEM. */
iso_status isosculpt_view_prepare(isosculpt_view *view, void (*wake)(void), iso_error *error);
bool isosculpt_view_is_preparing(const isosculpt_view *view);

/* Points of the surface, as last extracted. */
size_t isosculpt_view_points(const isosculpt_view *view);

/* What lies at a pixel of a layer, world; false: nothing. */
typedef struct isosculpt_pick {
    iso_vec3 position, normal;
    double depth; /* view z, mm */
} isosculpt_pick;
bool isosculpt_layer_pick(const isosculpt_layer *layer, double x, double y, isosculpt_pick *pick);
/* The world point of a pixel at a depth. */
iso_vec3 isosculpt_layer_point(const isosculpt_layer *layer, double x, double y, double depth);
/* The pixel of a world point; false: behind the eye. */
bool isosculpt_layer_pixel(const isosculpt_layer *layer, iso_vec3 world, double *x, double *y);

/* Keeps the last picture as view->held, for picks, until the next hold. ISO_ERR_NOMEM. */
iso_status isosculpt_view_keep_pick_layer(isosculpt_view *view, iso_error *error);

/* The camera. Pixels are of the full picture. */
void isosculpt_view_orbit(isosculpt_view *view, double dx, double dy);
void isosculpt_view_pan(isosculpt_view *view, double dx, double dy);
void isosculpt_view_zoom(isosculpt_view *view, double factor); /* things appear `factor` times larger */
void isosculpt_view_set_direction(isosculpt_view *view, iso_direction direction);
/* The box around the surface, world, as it is now; around the grid when there is no surface. */
iso_box isosculpt_view_bounds(isosculpt_view *view);
/* To the middle, and turned about from now on; as large as it was. NULL: the whole. */
void isosculpt_view_focus(isosculpt_view *view, const iso_vec3 *at);

#ifdef __cplusplus
}
#endif
#endif
