/* isorender: what its source files share. The way of one input: open (header, outputs checked), read,
 * surfaces, exports, pictures, report. */
#ifndef ISO_APPS_ISORENDER_ISORENDER_H
#define ISO_APPS_ISORENDER_ISORENDER_H

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

#include "apps/common/input.h"
#include "apps/common/json.h"
#include "apps/common/options.h"
#include "apps/common/spool.h"
#include "base/parallel.h"
#include "exact/exact.h"
#include "extract/isovalue/isovalue.h"
#include "extract/mesh/mesh.h"
#include "extract/mesh/mesh_measure.h"
#include "extract/points/points.h"
#include "grids/parts/components.h"
#include "grids/volume/volume.h"
#include "image/camera.h"
#include "io/points_io.h"
#include "render/gl/engine.h"
#include "render/pullpush/pullpush.h"
#include "render/shading/shading.h"
#include "truth/raycast.h"

#ifdef __cplusplus
extern "C" {
#endif

/* ---- what the user asked for (options.c) ---- */

enum { ISORENDER_SURFACES = 64, ISORENDER_RECORD = 4096 };

typedef enum isorender_method {
    ISORENDER_UNCHOSEN = -1, /* exact for volumes, points for files of points */
    ISORENDER_EXACT,
    ISORENDER_POINTS,
    ISORENDER_PULLPUSH,
    ISORENDER_MESH,
    ISORENDER_RAYCAST
} isorender_method;
const char *isorender_method_name(isorender_method method);

/* What the camera frames. */
typedef enum isorender_fit { ISORENDER_FIT_BOX, ISORENDER_FIT_TIGHT } isorender_fit;

typedef enum isorender_help {
    ISORENDER_RUN,
    ISORENDER_HELP,
    ISORENDER_VERSION,
    ISORENDER_BACKENDS
} isorender_help;

/* Strings are borrowed from argv. */
typedef struct isorender_settings {
    iso_input input; /* first: other programs share its options */
    const char *const *inputs;
    int input_count;
    const char *scene, *output;

    double isovalues[ISORENDER_SURFACES];
    int isovalue_count, isovalue_auto;
    iso_rgb colors[ISORENDER_SURFACES];
    int color_count;
    int primitive; /* iso_primitive */
    int closed;    /* the solid ends at the volume's border */
    const char *points, *mesh, *aov;

    int method;         /* isorender_method */
    int reconstruction; /* iso_reconstruction */
    const char *backend;
    int scaling; /* iso_point_scaling */
    int strips;
    int width, height, samples, turntable, no_image;
    iso_rgb background;
    int transparent;

    int direction; /* iso_direction */
    iso_vec3 up;
    double azimuth, elevation, zoom, view_angle;
    int orthographic, fit; /* isorender_fit */
    double mm_per_pixel;   /* 0: not given */
    double margin;         /* part of the picture on each side; NaN: not given */
    int scale_bar, orientation_marker;
    double position[3], focal_point[3], view_up[3]; /* NaN: not given */

    int threads, progress, quiet, verbose;
    int info, json;
    const char *json_path; /* NULL: stdout */
    isorender_help help;
    iso_help_form help_form;
    char record[ISORENDER_RECORD]; /* the options that shape the picture, as typed */
} isorender_settings;

const iso_program *isorender_program(void);

/* Values of options that other programs have as well (running_options.inc). `settings`
 * begins with an isorender_settings. */
iso_status isorender_apply_json(void *settings, const char *value, iso_error *error);
iso_status isorender_apply_help(void *settings, const char *value, iso_error *error);
iso_status isorender_apply_version(void *settings, const char *value, iso_error *error);
/* Appends an option to settings->record. */
void isorender_record(void *settings, const iso_option *option, const char *value);

/* Fills settings from the command line and checks that it makes sense. `operands` has room for argc. */
iso_status isorender_settings_parse(int argc, char *const *argv, isorender_settings *settings,
                                    iso_operands *operands, iso_error *error);

/* ---- what one input becomes (plan.c) ---- */

/* Where the outputs of one input go: owned texts, NULL for what is not wanted. */
typedef struct isorender_plan {
    const char *input; /* as typed, or `scene` */
    char *scene;       /* "scene:NAME" made from --scene, or NULL */
    char *model;
    char *image, *aov; /* with {n:3} left in for a turntable */
    char *points, *mesh, *json;
    iso_file_set *files; /* read and written by the whole run; one for all plans, owned by the first */
} isorender_plan;

/* Plans for all inputs; refuses names that collide or would overwrite an input. isorender_plans_free. */
iso_status isorender_plans_make(const isorender_settings *settings, isorender_plan **plans, iso_error *error);
void isorender_plans_free(isorender_plan *plans, int count);

/* Whether there is something to render. */
bool isorender_plan_draws(const isorender_plan *plan);

/* `name` (a plan's image or aov) of frame `frame` of a turntable, or of the only picture. free(). */
iso_status isorender_plan_frame(const char *name, int frame, char **path, iso_error *error);

/* Fails with ISO_ERR_WRITE when an output cannot be made, with ISO_ERR_UNSUPPORTED when this build cannot
 * make its kind; leaves nothing behind. */
iso_status isorender_plan_check_writable(const isorender_plan *plan, iso_error *error);

/* ---- which engine draws (backend.c) ---- */

typedef struct isorender_backend {
    const char *name,
        *renderer;           /* "cpu", "egl", "osmesa"; what the driver calls itself, or the instructions */
    iso_gl_context *context; /* both NULL: the cpu engine */
    iso_gl_engine *engine;
} isorender_backend;

/* Whether the settings name a backend that can do what they ask for, as far as that can be told now. Without
 * a method, what asks for OpenGL gets points. */
iso_status isorender_backend_check(isorender_settings *settings, iso_error *error);
isorender_backend isorender_backend_cpu(void);
/* ISO_ERR_BACKEND when the one that is asked for cannot be used. isorender_backend_close, also after that. */
iso_status isorender_backend_open(const isorender_settings *settings, isorender_backend *backend,
                                  iso_error *error);
void isorender_backend_close(isorender_backend *backend);
/* To stdout: every backend, and what it is or why it cannot be used. */
void isorender_backends_list(int threads);

/* ---- the work on one input ---- */

typedef struct isorender_surface {
    double isovalue; /* physical; NaN for points that were read */
    iso_rgb color;
    iso_grid grid;     /* what the surface is extracted from; borrowed: the volume's or own_grid */
    iso_grid own_grid; /* neither is set: none */
    iso_components_totals parts;
    iso_mesh_measures measures; /* of the mesh, with --json or --verbose */
    iso_point_set *points;      /* or NULL */
    iso_mesh_set *mesh;         /* or NULL */
    iso_exact *exact;           /* or NULL */
    iso_raycaster *caster;      /* or NULL */
} isorender_surface;

typedef struct isorender_frame {
    uint64_t hash;  /* FNV-1a of width, height and the pixels */
    size_t covered; /* samples that show a surface */
} isorender_frame;

typedef struct isorender_seconds {
    double load, extract, render, write, total;
} isorender_seconds;

typedef struct isorender_job {
    const isorender_settings *settings;
    const isorender_plan *plan;
    iso_pool *pool;
    const isorender_backend *backend;
    iso_spool spool;  /* of standard input or a FIFO */
    const char *path; /* what to read */

    bool from_points; /* `points` was read, there is no volume */
    isorender_method method;
    iso_volume volume;
    iso_points points;
    int crop[6];           /* voxels of the file that `volume` holds: x0 x1 y0 y1 z0 z1, inclusive */
    double scene_isovalue; /* NaN when the input is not a scene */
    size_t nonfinite;
    bool has_histogram;
    iso_histogram histogram;

    isorender_surface surfaces[ISORENDER_SURFACES];
    int surface_count;
    iso_gl_surface *gl_surfaces[ISORENDER_SURFACES]; /* of the gl engine */
    uint64_t point_count, rejected, vertex_count, triangle_count, cell_count;
    iso_box bounds_local, bounds_world; /* mm */

    iso_pullpush *pullpush; /* or NULL */
    iso_camera camera;      /* of the first frame */
    isorender_frame *frames;
    int frame_count;
    /* Outputs that stand: removed again when a later step fails. */
    bool points_written, mesh_written;
    int frames_written, aovs_written;
    isorender_seconds seconds;
    const char *stage; /* progress: what is going on, and what was last told */
    int told;
} isorender_job;

/* The whole way of one input. On failure nothing that it wrote is left. */
iso_status isorender_run(const isorender_settings *settings, const isorender_plan *plan, iso_pool *pool,
                         const isorender_backend *backend, iso_error *error);

/* input.c: adds the files that the input is read from to the plan's, as far as its header can be
 * read. For runs of several inputs: what one reads no other may write. */
void isorender_look(const isorender_settings *settings, const isorender_plan *plan);
/* header, and the check of all outputs against what is read; notes; then the voxels or points. */
iso_status isorender_open(isorender_job *job, iso_error *error);
iso_status isorender_read(isorender_job *job, iso_error *error);
void isorender_close(isorender_job *job);

/* surface.c */
iso_status isorender_histogram(isorender_job *job, iso_error *error); /* into job->histogram, once */
iso_status isorender_extract(isorender_job *job, iso_error *error);
/* The points that are made, where they are: what is asked for, or the best for the grid and the method. */
iso_primitive isorender_primitive(const isorender_job *job);
iso_status isorender_export(isorender_job *job, iso_error *error);
iso_point_view isorender_points_view(const isorender_job *job, int surface);

/* The box of all surfaces in the space that `affine` takes index coordinates to. */
iso_box isorender_bounds(const isorender_job *job, const iso_affine *affine);

/* camera.c: the first frame's camera, into job->camera; and a frame's. */
iso_status isorender_camera_make(isorender_job *job, iso_error *error);
iso_camera isorender_camera_of_frame(const isorender_job *job, int frame);
/* ISO_ERR_USAGE when options contradict each other; --mm-per-pixel makes the projection parallel. */
iso_status isorender_camera_check(isorender_settings *settings, iso_error *error);

/* solid.c */
/* Makes surface->grid: without small parts, and closed, as the settings ask for. ISO_ERR_EMPTY: no part is
 * large enough. */
iso_status isorender_solid_prepare(isorender_job *job, isorender_surface *surface, iso_error *error);
/* Bytes that all surfaces' grids take beside the volume's own (`grid_bytes`, of `dims` voxels). */
uint64_t isorender_solid_bytes(const isorender_job *job, const int dims[3], uint64_t grid_bytes);
/* The surface's welded mesh as it is exported; measured into surface->measures when that is wanted. */
iso_status isorender_mesh_weld(const isorender_job *job, isorender_surface *surface, iso_weld *weld,
                               iso_error *error);
/* Members of the report: parts and mesh, of the first surface and, when there are several, of each. */
void isorender_solid_put(iso_json *json, const isorender_job *job);

/* picture.c */
iso_status isorender_render(isorender_job *job, iso_error *error);
uint64_t isorender_picture_bytes(const isorender_job *job); /* of main memory */

/* backend.c: surfaces to the GPU, a picture from there, and the surfaces away again. */
iso_status isorender_gl_upload(isorender_job *job, iso_error *error);
uint64_t isorender_gl_bytes(const isorender_job *job); /* of main memory, for a picture, by the driver */
iso_status isorender_gl_draw(const isorender_job *job, const iso_view *view, iso_gbuffer *gbuffer,
                             iso_error *error);
void isorender_gl_release(isorender_job *job);

/* report.c */
iso_status isorender_report_json(const isorender_job *job, iso_error *error);
/* Text on stdout: what the header says (info.c), and what the voxels say. */
void isorender_info_header(const isorender_job *job);
void isorender_info_values(const isorender_job *job);

/* log.c: what goes to stderr. */
#if defined(__GNUC__)
__attribute__((format(printf, 2, 3)))
#endif
void isorender_log(const isorender_job *job, const char *format, ...); /* unless --quiet */
#if defined(__GNUC__)
__attribute__((format(printf, 2, 3)))
#endif
void isorender_log_verbose(const isorender_job *job, const char *format, ...); /* with --verbose */
void isorender_progress(isorender_job *job, const char *stage, double fraction); /* with --progress */
const char *isorender_input_name(const isorender_job *job);
double isorender_now(void); /* seconds */

#ifdef __cplusplus
}
#endif
#endif
