/* isorender: the work on one input, from the file to pictures and exports. run.c calls the steps in this
 * order: open (the header; outputs are checked), read, extract surfaces, export, render, report. */
#ifndef ISO_APPS_ISORENDER_ISORENDER_H
#define ISO_APPS_ISORENDER_ISORENDER_H

#include "apps/common/json.h"
#include "apps/isorender/backend.h"
#include "apps/isorender/instances.h"
#include "apps/isorender/objects.h"
#include "apps/isorender/plan.h"
#include "apps/isorender/progress.h"
#include "apps/isorender/settings.h"
#include "scene/cloud.h"
#include "scene/gl_scene.h"
#include "scene/loader.h"
#include "scene/picture.h"
#include "scene/solid.h"

/* One isosurface, of the input or of a further volume. */
typedef struct isorender_surface {
    iso_loader *loader;      /* of its volume; borrowed: the job's `loader` or one of `volumes` */
    iso_scene_surface scene; /* its isovalue is NaN for points that were read; its grid is borrowed: the
                                volume's or own_grid */
    iso_rgb color;
    bool color_given; /* by --color */
    iso_translucency translucency;
    iso_grid own_grid;   /* of the scene, when it is a copy without small parts, or with caps; else NULL */
    int label_group;     /* of labels: iso_label_fields_grid, which its grid is; 0: it is none of labels */
    iso_painted painted; /* its paint, and */
    iso_coloring paint;  /* how it is coloured by it, if it is */
    iso_components_totals parts;
    iso_mesh_measures measures; /* of the mesh: isorender_mesh_weld */
    iso_box bounds;             /* in the world, mm */
} isorender_surface;

/* One picture of a turntable, or the only picture. */
typedef struct isorender_frame {
    uint64_t hash;                  /* FNV-1a of width, height and the pixels; with --json */
    size_t covered;                 /* samples that show a surface */
    iso_exact_layers_totals layers; /* with translucent surfaces */
    size_t detail[ISO_LOD_LEVELS];  /* points of each level of detail in the cuts of all surfaces */
    int detail_levels;              /* 0: there are no levels */
    iso_selection_counts selection; /* of discs and splats */
    iso_instance_counts instances;  /* with --instances */
} isorender_frame;

typedef struct isorender_seconds {
    double load, extract, render, write, total;
} isorender_seconds;

/* Everything about one input; owned by isorender_run. */
struct isorender_job {
    const isorender_settings *given;    /* of all pictures, */
    const isorender_settings *settings; /* and of the one that is drawn: keyframes.h */
    const isorender_plan *plan;
    iso_pool *pool;
    const isorender_backend *backend;
    const iso_environment *environment; /* what glass refracts; NULL: there is no glass */
    iso_loader loader;                  /* of the input; not opened when there is none */
    bool has_volume;                    /* the input is a volume: not points, and there is an input */
    iso_loader volumes[ISORENDER_VOLUMES];
    int volume_count;
    iso_input input,
        volume_inputs[ISORENDER_VOLUMES]; /* how the input, of a certain level, and `volumes` are read */

    iso_method method; /* of --method: ISO_METHOD_PULLPUSH, _DISCS, _SPLATS with any reconstruction */
    int samples;       /* a pixel: of --samples, or the usual number */
    const iso_renderer *renderer; /* the row of the renderers' table for the method and its reconstruction */

    isorender_surface surfaces
        [ISORENDER_SURFACES]; /* those of the input, then one of each of `volumes`, then those of labels */
    iso_scene_cloud cloud;    /* of a file of points */
    /* The input's points are drawn as 3-D Gaussians; `method` is then for what is beside them. */
    bool gaussians;
    isorender_object cloud_colors; /* how it is coloured; its glyphs are those of the loader */
    iso_point_view read_points;    /* of the cloud */
    int surface_count, input_surface_count;
    isorender_object objects[ISORENDER_OBJECTS]; /* their surface numbers follow those of the surfaces */
    int object_count;
    bool translucent;                      /* at least one surface or object is */
    isorender_instances instances;         /* of the input's surfaces */
    struct iso_segmentation *segmentation; /* of --labels and --smooth; NULL: none */
    iso_gl_scene gl;                       /* with backend->engine */
    uint64_t point_count, rejected, vertex_count, triangle_count, cell_count; /* of all surfaces */
    iso_box bounds_local, bounds_world;                                       /* mm */
    iso_box bounds_framed; /* of what the camera frames: without a few points far from the others */

    iso_clip *clips; /* of --clip: what is cut away of each surface, then of each object; NULL: nothing */
    iso_slice slices[ISO_SLICES]; /* of --slice */
    iso_slice_look slice_look;
    struct isorender_colorings *colorings;           /* of --surface-color-by; NULL: none */
    struct isorender_chunks *chunks;                 /* chunks.h; NULL: the volume is drawn as a whole */
    bool did_not_fit, notes_logged, isovalue_logged; /* in the attempt to draw it as a whole */
    iso_point_workspace *point_workspace;            /* or NULL */
    iso_occluders occluders;                         /* of --occlusion and --shadow */
    iso_camera camera;                               /* of the first frame */
    bool shares_view; /* it and the isovalue are those of an input before (--same-view) */
    isorender_frame *frames;
    int frame_count;
    int frame;       /* that is being drawn, */
    double strip[2]; /* and the part of it, 0 .. 1 */
    /* Outputs written so far, to be removed when a later step fails: */
    bool points_written, mesh_written, table_written;
    int frames_written, aovs_written;
    isorender_seconds seconds;
    double rank_bytes[3]; /* with mpirun: least, mean and greatest peak memory of a rank */
    isorender_progress_state progress;
};

/* ---- run.c */

/* Does all the work on one input. environment: of glass, else NULL. After a failure the outputs of this input
 * are removed; the error names the input. */
iso_status isorender_run(const isorender_settings *settings, const isorender_plan *plan, iso_pool *pool,
                         const isorender_backend *backend, const iso_environment *environment,
                         iso_error *error);

/* Opens what glass reflects and refracts; NULL without glass. Errors: iso_environment_read. */
iso_status isorender_environment_open(const isorender_settings *settings, iso_pool *pool,
                                      iso_environment **environment, iso_error *error);

/* ---- object_branches.c */

/* Adds what else a mesh in --lines has become: an object of ribbons, and one of triangles. Says what stays
 * triangles. ISO_ERR_USAGE: too many objects. */
iso_status isorender_object_add_parts(isorender_job *job, isorender_object *whole, iso_error *error);

/* ---- input.c */

/* Opens the input (iso_loader_open), chooses the method, and checks limits that depend on the header:
 * ISO_ERR_LIMIT when picture or copies of the grid do not fit into memory, ISO_ERR_USAGE for options that
 * points do not have. */
iso_status isorender_open(isorender_job *job, iso_error *error);
/* Reads voxels or points, and logs the reader's notes. */
iso_status isorender_read(isorender_job *job, iso_error *error);

/* ---- surface.c */

/* Chooses isovalues and colours; extracts what the method and the exports need of every surface; finds the
 * bounds. ISO_ERR_EMPTY when a surface is empty. */
iso_status isorender_extract(isorender_job *job, iso_error *error);
/* Returns the kind of points that are extracted: that of --primitive, or else edge points, because in narrow
 * creases the gradients of level sets are no normals, and foot points are missing or beside the surface. */
iso_primitive isorender_primitive(const isorender_job *job);
/* Writes --points and --mesh; measures meshes for --json and --verbose. */
iso_status isorender_export(isorender_job *job, iso_error *error);
/* Returns the translucency of a surface or an object with this opacity; without absorption. */
iso_translucency isorender_translucency(const isorender_settings *settings, double opacity);

/* Returns the box of all surfaces, of clouds with their discs, without objects, in coordinates along three
 * world vectors, as iso_fit.bounds asks for it. */
iso_box isorender_bounds(const isorender_job *job, const iso_vec3 vectors[3]);

/* ---- cloud.c: a file of points as the input */

/* ISO_ERR_USAGE for options that need a volume. */
iso_status isorender_cloud_check(const isorender_settings *settings, iso_error *error);
/* Reads the points and makes job->cloud of them, as the settings say. ISO_ERR_EMPTY: no point is left; other
 * errors as iso_loader_read and iso_cloud_make. */
iso_status isorender_cloud_read(isorender_job *job, iso_error *error);
/* Prints the lines of --info about the points. */
void isorender_cloud_info(const isorender_job *job);
/* Adds the members about the points to the report of --json. */
void isorender_cloud_report(iso_json *json, const isorender_job *job);

/* ---- gaussians.c: a file of 3-D Gaussians as the input */

/* Sets job->gaussians. ISO_ERR_USAGE: --method gaussians for another file, or options that Gaussians do not
 * have. */
iso_status isorender_gaussians_choose(isorender_job *job, iso_error *error);

/* The Gaussians of the file, which borrow the job. */
iso_gaussians isorender_gaussians_of(const isorender_job *job);
/* Prints the lines of --info about the Gaussians. */
void isorender_gaussians_info(const isorender_job *job);

/* ---- volumes.c: further volumes, of --volume */

/* As iso_loader_open and iso_loader_read, for all of them. Messages begin with the volume's name. */
iso_status isorender_volumes_open(isorender_job *job, iso_error *error);
iso_status isorender_volumes_read(isorender_job *job, iso_error *error);
/* Puts the name of volume `volume`, from 0, before the message of a failure, unless the message begins with
 * it; below 0 the input, of which only the channel is named here. Returns `status`. */
iso_status isorender_volume_named(const isorender_job *job, int volume, iso_status status, iso_error *error);
/* Adds a member about the volumes and their surfaces to the report of --json. */
void isorender_report_volumes(iso_json *json, const isorender_job *job);

/* ---- object_gradients.c */

/* Whether --glyphs surface is given. */
bool isorender_wants_gradients(const isorender_settings *settings);

/* Makes the glyphs of --glyphs surface. ISO_ERR_EMPTY: no gradient can be drawn; ISO_ERR_LIMIT,
 * ISO_ERR_NOMEM. */
iso_status isorender_object_take_gradients(isorender_job *job, isorender_object *object, iso_error *error);

/* ---- groups.c */

bool isorender_uses_groups(const isorender_job *job); /* draws points by --reconstruction groups */
/* Divides the points of a surface into groups. ISO_ERR_NOMEM, ISO_ERR_LIMIT. */
iso_status isorender_groups_make(isorender_job *job, int surface, iso_error *error);
iso_grouping isorender_grouping(const isorender_settings *settings);    /* of the options --group-.. */
void isorender_report_groups(iso_json *json, const isorender_job *job); /* a member of --json's report */

/* ---- levels_of_detail.c */

/* Makes the levels of detail of all surfaces if --lod asks for them or if they save more time than they take;
 * to be called when the camera is known. ISO_ERR_NOMEM, ISO_ERR_LIMIT: only if --lod asks. */
iso_status isorender_detail_make(isorender_job *job, iso_error *error);
/* The value of --lod, or its default. */
double isorender_detail_pixels(const isorender_settings *settings);
/* What pullpush has selected from points so far. */
iso_selection_counts isorender_selection(const isorender_job *job);
/* Sets the counts of a frame that has been drawn. `before`: isorender_selection before it. */
void isorender_detail_note(const isorender_job *job, const iso_selection_counts *before,
                           isorender_frame *frame);
/* Members of the frame's report: how many points were selected, and of which levels. */
void isorender_detail_report(iso_json *json, const isorender_frame *frame);

/* ---- camera.c */

/* The box of all surfaces and objects, as isorender_bounds gives that of the surfaces. */
iso_box isorender_bounds_of_all(isorender_job *job, const iso_vec3 vectors[3]);

/* The world box of all that a picture frames: surfaces, objects and slices. */
iso_box isorender_bounds_shown(const isorender_job *job);

/* Makes job->camera, that of the first frame. ISO_ERR_USAGE: as iso_camera_check. */
iso_status isorender_camera_make(isorender_job *job, iso_error *error);
iso_camera isorender_camera_of_frame(const isorender_job *job, int frame);

/* ---- solid.c */

/* Makes the scene's grid: without small parts, and closed, as the settings say. ISO_ERR_EMPTY: no part is
 * large enough. */
iso_status isorender_solid_prepare(isorender_job *job, isorender_surface *surface, iso_error *error);
/* Bytes that own_grid of all surfaces will take, for a volume of `dims` voxels in `grid_bytes` bytes. */
uint64_t isorender_solid_bytes(const isorender_job *job, const int dims[3], uint64_t grid_bytes);
/* The surface's welded mesh as it is exported; iso_weld_free when done. Measured into surface->measures for
 * --json, --verbose, and the line that says that the mesh was written. */
iso_status isorender_mesh_weld(const isorender_job *job, isorender_surface *surface,
                               const iso_coloring *coloring, iso_weld *weld, iso_error *error);
/* Adds members about parts and mesh to the report of --json: of the first surface and, if there are several,
 * of each. */
void isorender_report_solid(iso_json *json, const isorender_job *job);

/* ---- picture.c */

/* What an iso_scene borrows. */
typedef struct isorender_scene_arrays {
    iso_layered_surface surfaces[ISORENDER_SURFACES];
    iso_scene_object *objects[ISORENDER_OBJECTS];
    iso_scene_engine engine;
    iso_scene_progress progress;
    iso_gaussians gaussians;
} isorender_scene_arrays;

/* The job's surfaces and objects as a scene, without glass. It borrows the job and the arrays. */
iso_scene isorender_scene(isorender_job *job, isorender_scene_arrays *arrays);
/* The film of one input, or of a series, before its first picture. */
isorender_film isorender_film_of(const isorender_settings *settings);
/* Renders and writes all frames. ISO_ERR_EMPTY when a frame shows nothing of the surface, unless it is one of
 * a series or between keyframes, or when all of these show nothing. */
iso_status isorender_render(isorender_job *job, iso_error *error);
/* Writes the picture of a step of a series that has no surface: the background. ISO_ERR_EMPTY, without a
 * message: no step has one, and this is the last. */
iso_status isorender_render_nothing(isorender_job *job, iso_error *error);
/* Writes a picture, and what is over it, with the texts of its file. The image may be painted onto. */
iso_status isorender_write_picture(isorender_job *job, iso_image *image, const iso_drawing *over,
                                   const char *path, iso_error *error);
uint64_t isorender_picture_bytes(const isorender_job *job, int samples); /* main memory to render */

/* ---- report.c, info.c */

/* Writes --json. ISO_ERR_WRITE. */
iso_status isorender_report_json(const isorender_job *job, iso_error *error);
/* --info on standard output: what the header says, before reading; what the voxels say, after it. */
void isorender_info_header(const isorender_job *job);
void isorender_info_values(const isorender_job *job);

/* ---- log.c: messages on standard error, with the input's name in front */

#if defined(__GNUC__)
__attribute__((format(printf, 2, 3)))
#endif
void isorender_log(const isorender_job *job, const char *format, ...); /* unless --quiet */
#if defined(__GNUC__)
__attribute__((format(printf, 2, 3)))
#endif
void isorender_log_verbose(const isorender_job *job, const char *format, ...); /* with --verbose */
/* Logs the notes of a reader of points or lines; `path`: the file, "" for the input. */
void isorender_log_report(const isorender_job *job, const char *path, const iso_read_report *report);

#endif
