/* viewport: the picture that a window shows of a field or a volume, and picking in it. Knows nothing of
 * windows.
 *
 * While the camera moves the picture has a lower resolution if the machine is too slow for the full one; at
 * rest it gets one sample a pixel, then four. A stroke redraws only those parts of an exact picture that it
 * changed. Surfaces are extracted again only where the change log says so. All picture coordinates are pixels
 * of the full picture, y down. One thread at a time. */
#ifndef ISO_APPS_ISOSCULPT_VIEWPORT_VIEWPORT_H
#define ISO_APPS_ISOSCULPT_VIEWPORT_VIEWPORT_H

#include "apps/isosculpt/task.h"
#include "apps/isosculpt/viewport/backdrop.h"
#include "apps/isosculpt/viewport/cut.h"
#include "apps/isosculpt/viewport/damage.h"
#include "apps/isosculpt/viewport/gl.h"
#include "apps/isosculpt/viewport/lod.h"
#include "apps/isosculpt/viewport/shading.h"
#include "base/c_linkage.h"
#include "scene/method.h"
#include "scene/occluders.h"
#include "scene/painted.h"

ISO_C_BEGIN

/* The methods that a user can choose, in the order of the panel: a selection from the table of renderers
 * (methods/method.h). */
enum { ISOSCULPT_METHODS = 6 };
extern const iso_method isosculpt_methods[ISOSCULPT_METHODS];
/* How iso_draw_point_surface draws the points of the methods discs, pullpush and pullpush-box. */
iso_reconstruction isosculpt_reconstruction(iso_method method);

/* The engine that draws. OpenGL has all methods except exact; instead of it the mesh is drawn while the
 * camera moves. Fields with a mask are drawn by the cpu engine. */
typedef enum isosculpt_engine { ISOSCULPT_ENGINE_CPU, ISOSCULPT_ENGINE_GL } isosculpt_engine;

/* The last ISOSCULPT_LATENCIES times, in seconds. Zero-initialise. */
enum { ISOSCULPT_LATENCIES = 256 };
typedef struct isosculpt_latency {
    double seconds[ISOSCULPT_LATENCIES];
    size_t count; /* ever added */
} isosculpt_latency;
void isosculpt_latency_add(isosculpt_latency *latency, double seconds);
/* Returns the time below which a part `quantile` (0 .. 1) of the times lie; 0 when there are none. */
double isosculpt_latency_quantile(const isosculpt_latency *latency, double quantile);

/* The quality of a picture: while the camera moves; at rest; with four samples for each pixel. */
typedef enum isosculpt_quality {
    ISOSCULPT_QUALITY_MOVING,
    ISOSCULPT_QUALITY_REST,
    ISOSCULPT_QUALITY_FINE
} isosculpt_quality;

typedef struct isosculpt_display_mode {
    iso_method method; /* one of isosculpt_methods */
    isosculpt_engine engine;
    isosculpt_material material;
} isosculpt_display_mode;

/* Masked voxels are drawn darker. `at` returns whether a voxel is masked, and is called from several threads.
 * Zero: no voxel is masked. */
typedef struct isosculpt_mask {
    bool (*at)(const void *context, int x, int y, int z);
    const void *context; /* borrowed */
} isosculpt_mask;

/* The opacities of the surfaces of a viewed volume, and a second isosurface in the same picture. */
typedef struct isosculpt_see_through {
    double opacity; /* of the surface, 0 .. 1 */
    bool has_second;
    double second_isovalue, second_opacity; /* physical; 0 .. 1 */
    iso_rgb second_color;
} isosculpt_see_through;

/* The light of the picture at rest that takes time to find, as of isorender's options; while the camera moves
 * there is none of it. */
typedef struct isosculpt_light {
    iso_occlusion_opts occlusion;
    double outline; /* width, pixels; 0: none */
} isosculpt_light;

/* How the reference is drawn with a field. */
typedef struct isosculpt_reference_mode {
    bool shown;
    bool over;      /* the whole reference is seen through the sculpture; if false, only what lies in front of
                       it */
    bool labels;    /* the other labels of the segmentation instead of the surface at the beginning */
    double opacity; /* where it is seen face on, 0 .. 1 */
    iso_rgb color;
} isosculpt_reference_mode;
typedef struct isosculpt_reference isosculpt_reference; /* reference.h */

/* Parts of the surface; the additional one is the cells of the second isosurface. */
enum { ISOSCULPT_PART_SECOND = ISO_PART_COUNT, ISOSCULPT_PARTS };

typedef struct isosculpt_async_surface isosculpt_async_surface;

/* The samples of a picture, for picking: depth and normal of each. */
typedef struct isosculpt_pick_buffer {
    iso_gbuffer gbuffer; /* allocated size; view.width x view.height samples are used */
    const iso_gl_canvas
        *canvas; /* borrowed: holds the samples instead of gbuffer; NULL: gbuffer holds them */
    iso_view view;
    double samples; /* samples along a pixel of the full picture; 0: nothing has been drawn yet */
} isosculpt_pick_buffer;

/* Zero-initialise. camera, mode, mask, painted, see_through, cut and light (with `style`; so does what
 * color_by.h sets), opaque, sliding, reference_mode and gl may be changed between calls; the rest is read
 * only. */
typedef struct isosculpt_viewport {
    iso_camera camera;
    isosculpt_display_mode mode;
    isosculpt_mask mask;
    iso_painted painted;               /* of a field; `own` is the material's colour */
    double isovalue;                   /* physical; for volumes set by isosculpt_viewport_set_isovalue */
    isosculpt_see_through see_through; /* for volumes; ignored for fields */
    isosculpt_cut cut;                 /* @1 and @2 name the surface and the second one */
    isosculpt_light light;
    struct isosculpt_color_by *color_by; /* owned: color_by.h; NULL: the surfaces have colours of their own */
    double values[2];  /* of a volume: its least and greatest value, which caps show black and white */
    unsigned style;    /* counts the changes of cut, light and color_by: add 1 after changing them */
    bool opaque;       /* draw only the first surface, opaque, because it is being converted into a field */
    bool sliding;      /* the user is dragging an isovalue */
    int moving_factor; /* width of a sample in pixels while the camera moves, 1 ..
                          ISOSCULPT_MOVING_FACTOR_MAX; adapted to the time that pictures take */

    const isosculpt_backdrop *backdrop; /* borrowed: a picture behind the surface (with `style`); or NULL */
    isosculpt_reference_mode reference_mode; /* of fields */
    isosculpt_reference *reference;          /* owned; NULL: none */
    iso_error reference_error;               /* why the reference was hidden; text[0] == 0: it was not */

    iso_grid grid;      /* borrowed */
    iso_pool *pool;     /* borrowed */
    isosculpt_gl *gl;   /* borrowed; NULL: the cpu engine draws all pictures */
    iso_error gl_error; /* why drawing fell back from OpenGL to the cpu engine; text[0] == 0: it did not */
    iso_scene_surface surface;
    iso_scene_surface second; /* the second isosurface, of which there are only cells */
    iso_occluders *occluders; /* what occlusion was found with; NULL: none yet */
    iso_point_workspace *workspace;
    isosculpt_matcap matcap;

    /* For volumes only. Until the surface of the current isovalue is extracted, by a background thread, the
     * points of `lod` are drawn. */
    isosculpt_lod *lod;                     /* NULL: the grid is a field */
    isosculpt_async_surface *async_surface; /* the surface that is being extracted; NULL: none */
    iso_pool *async_surface_pool;           /* the background thread's, owned */
    double failed_isovalues[2]; /* isovalues at which the background thread failed, of the first and the
                                   second surface: drawing tries again and returns the error; NAN: none */
    size_t point_count;         /* of the points as last extracted */

    const iso_point_set
        *drawn_points; /* borrowed: those of `surface` or of `lod`; the only set in OpenGL's buffers */

    isosculpt_pick_buffer drawn;       /* samples of the last picture */
    isosculpt_pick_buffer pick_buffer; /* of the picture that the current stroke began on */
    iso_image image;   /* the last picture, unless drawn.canvas holds it; with room for a larger one */
    size_t image_room; /* pixels allocated */
    iso_gbuffer tile;  /* room for a part of the picture */
    iso_image tile_image;
    size_t tile_room;     /* pixels allocated */
    iso_image fine_image; /* a part of the picture with a pixel for every sample */
    size_t fine_room;     /* pixels allocated */

    /* The state that the last picture shows: */
    int width, height; /* of the full picture */
    iso_camera drawn_camera;
    isosculpt_display_mode drawn_mode;
    double drawn_isovalue;
    isosculpt_see_through drawn_see_through;
    bool drawn_opaque;
    unsigned drawn_style;
    bool drawn_lit; /* with `light` */
    isosculpt_reference_mode drawn_reference_mode;
    bool slow_layers; /* translucent surfaces of these isovalues take too long while the camera moves */
    isosculpt_quality quality;
    bool drawn_exactly;         /* the exact surface, with one sample a pixel or more */
    uint64_t drawn_edit;        /* number of the last edit that the picture shows */
    uint64_t drawn_paint;       /* the same of the paint's log */
    bool drawn_painted;         /* there was paint */
    bool mask_changed;          /* the mask has changed since then */
    isosculpt_damage redrawn;   /* pixels of the image that the last call drew */
    isosculpt_damage unrefined; /* pixels with one sample */

    isosculpt_latency extract, draw; /* draw: while the camera moves, and of strokes */
} isosculpt_viewport;

/* The second limit is for pictures with translucent surfaces. */
enum { ISOSCULPT_MOVING_FACTOR_MAX = 3, ISOSCULPT_LAYERS_FACTOR_MAX = 4 };

/* A viewport of a field, with the camera in front of the whole surface. `grid` and `pool` are borrowed until
 * free. ISO_ERR_NOMEM. */
iso_status isosculpt_viewport_init(isosculpt_viewport *viewport, iso_hgrid *grid, iso_pool *pool,
                                   iso_error *error);
/* Works as isosculpt_viewport_init for any grid at an isovalue (physical). */
iso_status isosculpt_viewport_init_grid(isosculpt_viewport *viewport, const iso_grid *grid, double isovalue,
                                        iso_pool *pool, iso_error *error);
/* Chooses another isovalue; the next drawing shows it. */
void isosculpt_viewport_set_isovalue(isosculpt_viewport *viewport, double isovalue);
void isosculpt_viewport_free(isosculpt_viewport *viewport);

/* These functions return whether the picture has a second isosurface; a second isosurface or a translucent
 * surface; a translucent surface. The second kind is drawn by the cpu engine with the method exact, and lit
 * by lamps. */
bool isosculpt_viewport_has_second(const isosculpt_viewport *viewport);
bool isosculpt_viewport_is_see_through(const isosculpt_viewport *viewport);
bool isosculpt_viewport_is_translucent(const isosculpt_viewport *viewport);
/* Whether the surfaces of a viewed volume are coloured by data, which the cpu engine draws with lamps;
 * methods that cannot are replaced by exact. */
bool isosculpt_viewport_is_colored(const isosculpt_viewport *viewport);
/* Whether a field has paint, which is drawn in the same way. */
bool isosculpt_viewport_is_painted(const isosculpt_viewport *viewport);
/* Returns what of `light` the picture at rest has: translucent surfaces have none, and beside them there
 * are no outlines. */
isosculpt_light isosculpt_viewport_light(const isosculpt_viewport *viewport);
/* Whether something is cut away, which the cpu engine draws with the methods exact and mesh, and lamps; and
 * whether the picture at rest has any light of those, which the cpu engine draws, with lamps. */
bool isosculpt_viewport_is_cut(const isosculpt_viewport *viewport);
bool isosculpt_viewport_has_light(const isosculpt_viewport *viewport);
/* Returns the method of the picture at rest: the chosen one, or exact if the picture requires it. */
iso_method isosculpt_viewport_method(const isosculpt_viewport *viewport);
/* Returns the material, which is lit by lamps if the picture requires it. */
isosculpt_material isosculpt_viewport_material(const isosculpt_viewport *viewport);

/* Puts a plane with a handle through the middle of the surface, square to the axis that points most to the
 * eye, and cuts away the half in front of it; or takes it away if there is one. */
void isosculpt_viewport_toggle_plane(isosculpt_viewport *viewport);
/* Cuts by a text of --clip: of camera:MM by what it cuts now, which does not turn with the camera. Errors as
 * isosculpt_cut_add. */
iso_status isosculpt_viewport_add_cut(isosculpt_viewport *viewport, const char *text, iso_error *error);

/* Sets another reference, which is owned by the viewport from now on, or none (NULL). The next picture shows
 * it. */
void isosculpt_viewport_set_reference(isosculpt_viewport *viewport, isosculpt_reference *reference);
/* Returns whether the picture shows the reference. The cpu engine then draws it. */
bool isosculpt_viewport_shows_reference(const isosculpt_viewport *viewport);

/* Draws the picture, as far as it has changed: into viewport->image, which may be a factor smaller than width
 * x height while the camera moves, or into viewport->drawn.canvas. `moving`: speed matters more than quality.
 * ISO_ERR_NOMEM. */
iso_status isosculpt_viewport_draw(isosculpt_viewport *viewport, int width, int height, bool moving,
                                   iso_error *error);

/* Draws a part of a picture at rest again with four samples a pixel. Call it until viewport->quality is
 * ISOSCULPT_QUALITY_FINE. ISO_ERR_NOMEM. */
iso_status isosculpt_viewport_refine(isosculpt_viewport *viewport, iso_error *error);

/* Copies a picture that drawn.canvas holds into viewport->image. ISO_ERR_NOMEM, ISO_ERR_BACKEND. */
iso_status isosculpt_viewport_read_back(isosculpt_viewport *viewport, iso_error *error);

/* Whether the picture at rest can be drawn without first extracting a whole surface, which may take long.
 * Always true for a field. */
bool isosculpt_viewport_is_ready(isosculpt_viewport *viewport);
/* Extracts the surface of the picture at rest in a background thread, unless one is running; `wake`: as in
 * isosculpt_task_start. Viewport and pool may be used in the meantime. If the isovalue changes in the
 * meantime, the result is discarded. ISO_ERR_NOMEM. */
iso_status isosculpt_viewport_prepare(isosculpt_viewport *viewport, void (*wake)(void), iso_error *error);
bool isosculpt_viewport_is_preparing(const isosculpt_viewport *viewport);

/* Returns the number of points of the surface when it was last extracted. */
size_t isosculpt_viewport_point_count(const isosculpt_viewport *viewport);

/* A point of the visible surface; world coordinates. */
typedef struct isosculpt_pick {
    iso_vec3 position, normal;
    double depth; /* view z, mm */
} isosculpt_pick;
/* Finds the surface at pixel (x, y) of a buffer; returns false if there is none. */
bool isosculpt_pick_buffer_pick(const isosculpt_pick_buffer *buffer, double x, double y,
                                isosculpt_pick *pick);
/* Returns the world position at a depth behind pixel (x, y). */
iso_vec3 isosculpt_pick_buffer_point(const isosculpt_pick_buffer *buffer, double x, double y, double depth);
/* Computes the pixel of a world position; returns false if the position lies behind the eye. */
bool isosculpt_pick_buffer_pixel(const isosculpt_pick_buffer *buffer, iso_vec3 world, double *x, double *y);

/* Copies the samples of the last picture to viewport->pick_buffer: a stroke picks from the surface as it was
 * when the stroke began. ISO_ERR_NOMEM, ISO_ERR_BACKEND. */
iso_status isosculpt_viewport_keep_pick_buffer(isosculpt_viewport *viewport, iso_error *error);

/* Camera moves. dx, dy: pixels of the full picture. */
void isosculpt_viewport_orbit(isosculpt_viewport *viewport, double dx, double dy);
void isosculpt_viewport_pan(isosculpt_viewport *viewport, double dx, double dy);
void isosculpt_viewport_zoom(isosculpt_viewport *viewport, double factor); /* > 1: things appear larger */
/* Shows the whole surface from a side. */
void isosculpt_viewport_set_direction(isosculpt_viewport *viewport, iso_direction direction);
/* Sets the size of the pictures that will be drawn, and shows the whole surface in them. */
void isosculpt_viewport_set_size(isosculpt_viewport *viewport, int width, int height);
/* Returns the world box around the current surface, or around the grid if there is no surface. */
iso_box isosculpt_viewport_bounds(isosculpt_viewport *viewport);
/* Moves a world position to the middle of the picture without changing the scale; the camera then orbits
 * around it. NULL: shows the whole surface. */
void isosculpt_viewport_focus(isosculpt_viewport *viewport, const iso_vec3 *at);

ISO_C_END
#endif
