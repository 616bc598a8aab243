/* settings: the command line of isorender, parsed and checked (options.c). */
#ifndef ISO_APPS_ISORENDER_SETTINGS_H
#define ISO_APPS_ISORENDER_SETTINGS_H

#include "apps/common/cap_style.h"
#include "apps/common/settings.h"
#include "apps/isorender/object_settings.h"
#include "apps/isorender/sheet_settings.h"
#include "apps/isorender/volume_settings.h"
#include "base/mpi_ranks.h"
#include "isopoint.h"
#include "scene/caps.h"
#include "scene/cuts.h"
#include "scene/method.h"
#include "scene/picture_file.h"
#include "scene/solid.h"

enum { ISORENDER_SURFACES = 64 };      /* isosurfaces in one picture */
enum { ISORENDER_MOST_OPTIONS = 256 }; /* rows of the table of options */

/* isorender_settings.method when the option is not given: exact for volumes, splats for files of points, or
 * pullpush if their reconstruction is box or gaussian; none of them for files of 3-D Gaussians. */
enum { ISORENDER_METHOD_UNCHOSEN = -1 };

/* isorender_settings.direction when the option is not given: front, but iso for flat files of points. */
enum { ISORENDER_DIRECTION_UNCHOSEN = -1 };

/* What the camera frames: the box around the surface, or the surface itself. Unchosen: as
 * isorender_camera_make decides. */
typedef enum isorender_fit {
    ISORENDER_FIT_BOX,
    ISORENDER_FIT_TIGHT,
    ISORENDER_FIT_UNCHOSEN = -1
} isorender_fit;

/* Values of isorender_settings.reconstruction beside iso_reconstruction. */
enum {
    ISORENDER_RECONSTRUCTION_UNCHOSEN = -1,
    ISORENDER_RECONSTRUCTION_GROUPS = ISO_RECONSTRUCTION_MEAN + 1
};

/* Whether the opacity of a surface depends on the angle at which it is seen. */
typedef enum isorender_opacity_mode {
    ISORENDER_OPACITY_BY_ANGLE,
    ISORENDER_OPACITY_CONSTANT
} isorender_opacity_mode;

/* Which normals the points of a file get: those that it has, or estimated ones. */
typedef enum isorender_normals { ISORENDER_NORMALS_FILE, ISORENDER_NORMALS_AUTO } isorender_normals;

/* What becomes of the faces of an input whose vertices can be drawn as points. */
typedef enum isorender_faces {
    ISORENDER_FACES_NONE,
    ISORENDER_FACES_DRAWN, /* it is drawn as a mesh */
    ISORENDER_FACES_LEFT_OUT
} isorender_faces;

/* A value of iso_common_settings.action. */
enum { ISORENDER_ACTION_LIST_BACKENDS = ISO_ACTION_OWN, ISORENDER_ACTION_SCHEMA };

/* What --same-view keeps of the first input that is drawn. Zero-initialise. */
typedef struct isorender_same_view {
    bool has_isovalue, has_camera;
    double isovalue; /* physical; NaN: of points */
    iso_camera camera;
} isorender_same_view;

/* The pictures of all inputs that go into one film, or of one input. */
typedef struct isorender_film {
    iso_video *video;           /* that is being written; NULL: none */
    int first, count;           /* the input's first picture in the film; pictures of the whole film */
    bool measuring, has_bounds; /* inputs are looked at only for what they share: */
    iso_box bounds;             /* what all pictures frame, mm, */
    double distance, scale;     /* and from how far, with which parallel_scale; 0: each its own */
    double ranges[ISORENDER_COLORINGS][2]; /* of colours, NAN: none yet */
    uint64_t covered;                      /* samples of all pictures that show a surface */
    iso_annotation_places places;          /* of what is over them */
} isorender_film;

enum { ISORENDER_NOTES = 64 }; /* texts, arrows and rulers in one picture */

/* One picture of --panels: what is kept of it, and what all have in common. */
typedef struct isorender_panel {
    bool is_survey;  /* it is only found out what the panels have in common; else it is drawn */
    bool is_last;    /* it has the legend and the colour bars of all */
    bool has_camera; /* drawn with this camera, else with one that frames the box; a survey sets both */
    iso_camera camera;
    iso_box box;
    int range_count; /* set by a survey: the ranges of everything that is coloured by numbers; owned */
    double (*ranges)[2];
    struct isorender_legend_list *names; /* of the legend, which panels share; borrowed */
    struct iso_loader_shelf *shelf;      /* the volume that was read last; borrowed */
    iso_image image;                     /* drawn: the picture, and what is over it; owned */
    iso_drawing drawing;
    iso_drawing legend, bars; /* of the last panel: what stands beside all panels; owned */
} isorender_panel;

/* An option that influences the picture, as it was given. */
typedef struct isorender_noted {
    const iso_option *option;
    const char *value; /* NULL: none */
} isorender_noted;
enum { ISORENDER_NOTED = 192 };

/* Strings are borrowed from argv. */
typedef struct isorender_settings {
    iso_common_settings common; /* first */
    const char *const *inputs;
    int input_count;
    const char *scene, *output;
    const char *save_scene; /* the file that the scene is written to; NULL: none */
    const char *scene_file; /* the file that the options come from; NULL: the command line alone */
    const char
        *scene_output; /* the picture's name when none is given: that of scene_file; NULL: the input's */
    int scene_number;  /* of several scenes: counts from 0 */
    iso_texts again;   /* files of scenes; isorender_commands_make has made command lines of them */
    isorender_noted noted[ISORENDER_NOTED];
    int noted_count; /* of options that were given, also of those beyond ISORENDER_NOTED */

    double isovalues[ISORENDER_SURFACES];     /* until channels are taken NaN stands for auto */
    bool isovalue_sigmas[ISORENDER_SURFACES]; /* isorender_isovalue.sigma of each */
    int isovalue_count, isovalue_auto;
    iso_rgb colors[ISORENDER_SURFACES];
    int color_count;
    double opacities[ISORENDER_SURFACES];
    int opacity_count;
    int opacity_mode;         /* isorender_opacity_mode */
    double absorption_length; /* mm; 0: not given */
    int layers;               /* crossings of each surface that are drawn; 0: all */
    double ior;               /* index of refraction; 0: not given, so the surface is not glass */
    int refraction;           /* iso_refraction; of glass not AUTO when options are checked */
    double dispersion;        /* Abbe number; 0: not given */
    const char *environment;  /* NULL: the built-in studio */
    iso_rgb attenuation_color;
    int attenuation_colored;     /* attenuation_color is given */
    double attenuation_distance; /* mm; 0: not given */
    int primitive;               /* iso_primitive */
    int closed;                  /* whether the solid is capped where it meets the volume's border */
    double radius;               /* of the points of a file, mm; 0: not given; below 0: estimate it */
    int normals;                 /* isorender_normals */
    const char *columns;         /* names of the columns of a file of points; NULL: not given */
    const char *points, *mesh, *aov;
    iso_mesh_edits mesh_edits; /* of --mesh */
    double hollow;             /* thickness of the wall that is left of the solid, mm; 0: it is not hollow */
    double drain;          /* diameter of the holes through which what is in the hollow leaves, mm; 0: none */
    const char *instances; /* where the model is drawn; NULL: once, where it is */
    int faces;             /* isorender_faces, of the input */

    isorender_object_options object_options;
    iso_cut cuts[ISO_CLIP_BODIES]; /* of --clip */
    const char *cut_texts[ISO_CLIP_BODIES];
    int cut_count;
    iso_cap_style cap; /* its colormap is also that of slices */
    double window[2];  /* centre and width of the values that they show; NaN: not given */
    bool window_auto;
    bool segments; /* `smooth` is not given, but the file names the segments that its labels are */
    iso_cut slices[ISO_SLICES]; /* of --slice */
    const char *slice_texts[ISO_SLICES];
    int slice_count;
    int no_input; /* the picture shows only the files of --lines, --glyphs, --surface and --volume */
    isorender_object_settings objects[ISORENDER_OBJECTS]; /* the first object_options.count are used */
    isorender_object_settings cloud;                      /* of the input, if it is a file of points */
    const char *labels, *label_table, *table; /* files of --labels, --label-table, --table; or NULL */
    int smooth, legend;                       /* smooth: the input is labels */
    iso_texts label_items;                    /* of --label */
    isorender_volume_options volume_options;
    isorender_volume_settings volumes[ISORENDER_VOLUMES]; /* channels of the input, then those of --volume */
    int volume_count;
    char channels[ISORENDER_VOLUMES + 1][ISO_CHANNEL_NAME]; /* of --channel: numbers and names */
    int channel_count;
    double line_min_pixels;  /* least width of lines in the picture, pixels */
    double line_drop_pixels; /* by how much dropped vertices may move outlines of lines, pixels */
    int color_bar;           /* with bar_titles */
    iso_coloring_settings colorings[ISORENDER_COLORINGS]; /* of --surface-color-by */
    int coloring_count;

    /* ISO_METHOD_EXACT, _POINTS, _PULLPUSH, _DISCS, _SPLATS, _MESH, _RAYCAST, _HYBRID or
     * ISORENDER_METHOD_UNCHOSEN */
    int method;
    int gaussians;    /* --method gaussians: of points of files; `method` is ISORENDER_METHOD_UNCHOSEN then */
    int lighting;     /* iso_lighting */
    double occlusion; /* range of ambient occlusion, mm; 0: none; NaN: the usual one */
    int shadow;       /* a soft shadow of the key light */
    double outline;   /* width of lines along outlines, pixels; 0: none */
    int look;         /* the place in iso_look_names */
    int reconstruction; /* iso_reconstruction; of pullpush GAUSSIAN or BOX, of discs CURVED or FLAT, of
                           splats from FLAT on, or _GROUPS; for files of points without --method CURVED,
                           which is then FLAT */
    int filter;         /* iso_filter */
    bool old_discs;     /* discs were chosen by an older name: --method pullpush --reconstruction curved */
    int one_pyramid;    /* of pullpush and hybrid */
    /* Of splats: iso_groups_opts, and iso_draw_groups_opts.bins. 0: not given. */
    int groups, group_bins, group_opposite;
    double group_overlap, group_coplanar; /* group_coplanar: degrees */
    int group_radii;                      /* iso_group_radii */
    int transparency;                     /* iso_transparency, of splats */
    int selection;                        /* iso_point_selection, of discs */
    double lod;                           /* levels of detail: pixels; 0: none; NaN: not given */
    const char *backend;
    int scaling; /* iso_point_scaling */
    int strips;
    int samples; /* of a pixel; 0: the usual number (isorender_job.samples) */
    int width, height, turntable, no_image;
    iso_rgb background;
    int transparent, background_given;

    iso_note notes[ISORENDER_NOTES]; /* of --text, --arrow and --ruler; texts are borrowed from argv */
    int note_count;
    int has_inset, inset_corner;           /* iso_corner */
    double inset[4];                       /* as iso_inset.box */
    const char *legend_names, *bar_titles; /* NULL: those of labels, files, isovalues and columns */
    double font_size;                      /* points, 1/72 inch; 0: by the picture's size */
    iso_texts panels;                      /* what differs between panels */
    iso_texts panel_files;                 /* the files of further panels */
    const char *panel_titles;              /* NULL: what differs */
    int panel_columns;                     /* 0: not given */
    isorender_panel *panel; /* borrowed; the picture is one of --panels; NULL: it is a file of its own */
    int argc;               /* the command line that this is made of, for panels */
    char *const *argv;

    int same_view;
    isorender_same_view *first; /* borrowed; NULL: inputs do not share a view */
    isorender_film *film;       /* borrowed */
    double frame_rate;          /* of a video, pictures a second */
    const char *series_of;      /* whose steps are the inputs; NULL: none */
    char **steps;               /* the paths of the steps: owned; series.h */
    char *series_file;          /* the only file of the series; owned */
    int step_stride;            /* components between two steps of series_file; 0: steps are files */
    const char *keyframe_file;
    struct isorender_keyframes *keyframes; /* of keyframe_file; NULL: none */
    int pictures;                          /* of each input, which are numbered; 0: one that is not */

    int direction; /* iso_direction, or ISORENDER_DIRECTION_UNCHOSEN */
    iso_vec3 up;
    double azimuth, elevation, view_angle; /* degrees */
    double zoom;
    int orthographic, fit; /* isorender_fit */
    double mm_per_pixel;   /* 0: not given */
    double dpi;            /* of the picture's file, pixels an inch; 0: not given */
    double margin;         /* on each side, as a fraction of the picture's size; NaN: not given */
    int scale_bar, orientation_marker;
    int unit;                                       /* iso_length_unit */
    double position[3], focal_point[3], view_up[3]; /* NaN: not given */

    double isovalue_range[2]; /* of a page; NaN: not given */
    uint64_t page_size;       /* its most bytes; 0: not given */

    int part, parts; /* part 1 .. parts of the picture, which is drawn into a file of keys; 0: the whole */
    int chunk_size;  /* voxels along the side of a chunk; 0: not given */
    int no_index;    /* NAME.isoindex is neither read nor written */
    int merge;       /* the command merge: `inputs` are files of keys */
    isorender_sheet_settings sheet; /* of the command sheet, and --watch */

    iso_ranks ranks; /* the processes of mpirun */
    /* Of every option, by its index in the table: a hash of the values given; 0: not given. */
    uint64_t given[ISORENDER_MOST_OPTIONS];
    int progress, verbose, info;
} isorender_settings;

/* The first option given that lights or outlines opaque surfaces by depths and normals; NULL: none is. */
const char *isorender_light_option(const isorender_settings *settings);
/* Whether any of the isosurfaces is translucent. */
bool isorender_is_translucent(const isorender_settings *settings);
/* Checks options that are for translucent surfaces (`translucent`: there are some) and, but for --absorption,
 * for translucent objects. ISO_ERR_USAGE. */
iso_status isorender_translucent_check(const isorender_settings *settings, bool translucent,
                                       iso_error *error);
/* The option that makes lines, glyphs or meshes translucent; NULL: all are opaque. */
const char *isorender_object_opacity_option(const isorender_settings *settings);
/* Whether --reconstruction is for this iso_method: for pullpush, discs and splats. */
bool isorender_has_reconstructions(int method);
/* Whether the method that is chosen, with its reconstruction, can do something. One that is not chosen yet
 * can do everything. */
bool isorender_method_can(const isorender_settings *settings, iso_capability capability);
/* Refuses with iso_renderer_require what it cannot draw. */
iso_status isorender_method_require(const isorender_settings *settings, unsigned capabilities,
                                    const char *what, iso_error *error);
/* Chooses the reconstruction when none is given, and checks that it is one of the method's and that the
 * options of splats are for splats. Replaces an older name of discs. ISO_ERR_USAGE. */
iso_status isorender_method_check(isorender_settings *settings, iso_error *error);
/* Chooses the method for --lod if none is given, and checks that it has levels of detail. ISO_ERR_USAGE. */
iso_status isorender_detail_check(isorender_settings *settings, iso_error *error);

/* The value of --reconstruction that is followed; splats: by the method splats, which files of points also
 * have without --method. */
const char *isorender_reconstruction_name(const isorender_settings *settings, bool splats);

/* Name, version and option table of isorender. */
const iso_program *isorender_program(void);

/* Parses the command line into `settings` and checks that the options agree with each other. `operands` has
 * room for argc pointers. ISO_ERR_USAGE; ISO_ERR_BACKEND for an unknown backend; ISO_ERR_LIMIT for a picture
 * larger than the backend draws. */
iso_status isorender_settings_parse(int argc, char *const *argv, isorender_settings *settings,
                                    iso_operands *operands, iso_error *error);

#endif
