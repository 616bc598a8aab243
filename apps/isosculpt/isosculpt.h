/* isosculpt: the settings of the program, and its two ways to run: in a window, and headless. */
#ifndef ISO_APPS_ISOSCULPT_ISOSCULPT_H
#define ISO_APPS_ISOSCULPT_ISOSCULPT_H

#include "apps/common/settings.h"
#include "apps/isosculpt/freezing.h"
#include "apps/isosculpt/measuring.h"
#include "apps/isosculpt/stroke_edits.h"
#include "grids/closing/closed_mesh.h"
#include "sculpt/session/session.h"

/* The engine with which the window starts. Auto: OpenGL if a GPU runs it, else the cpu engine. */
typedef enum isosculpt_backend {
    ISOSCULPT_BACKEND_AUTO,
    ISOSCULPT_BACKEND_CPU,
    ISOSCULPT_BACKEND_GL
} isosculpt_backend;

/* How the reference is shown: in front of the sculpture only, or through it. Off: not shown at the start; but
 * in front if files of a reference are given. */
typedef enum isosculpt_x_ray {
    ISOSCULPT_X_RAY_OFF,
    ISOSCULPT_X_RAY_UNDER,
    ISOSCULPT_X_RAY_OVER
} isosculpt_x_ray;

/* A reference picture behind the sculpture: FILE.png,AXIS,HEIGHT. */
typedef struct isosculpt_picture_request {
    char path[1024]; /* "": none */
    char axis;       /* 'x', 'y' or 'z' */
    double height;   /* mm */
} isosculpt_picture_request;

/* Strings are borrowed from argv. */
typedef struct isosculpt_settings {
    iso_common_settings common;  /* first; `input` says how the opened file is read */
    const char *strokes;         /* the operand: a stroke file to continue in a window */
    iso_start_solid solid;       /* that a new session begins with; size.x = 0: not given */
    isosculpt_freezing freezing; /* of the opened volume */
    isosculpt_measure_request measure;
    const char *video; /* of the strokes as they are drawn; NULL: none */
    double seconds, turntable,
        frame_rate; /* of the video: of strokes, of a turn after them; pictures a second */
    const char *replay, *open, *stamp, *output, *mesh, *font;
    isosculpt_edits edits;    /* of the strokes that are replayed */
    const char *save_strokes; /* where the strokes go with their edits; NULL: nowhere */
    int headless, recover, extract, draw;
    int closed;           /* cap meshes at the border of the grid when they are written */
    int backend;          /* isosculpt_backend */
    int x_ray;            /* isosculpt_x_ray */
    iso_texts references; /* files of the reference; none: the surface as it was when the session began */
    isosculpt_picture_request picture; /* taken from them */
    int space;                         /* iso_space, of the references */
    int resolution[2];                 /* pixels, of the pictures of --draw and --video */
    double voxel_size;                 /* mm; 0: not given */
    double scale;                      /* of text and panel in the window; 0: the screen's */
    double isovalue;                   /* physical; NAN: not given */
    double close_holes;                /* iso_closing_opts.hole, mm */
    uint64_t undo_memory;              /* bytes */
} isosculpt_settings;

static inline bool isosculpt_has_new(const isosculpt_settings *settings) {
    return settings->solid.size.x > 0;
}

/* Reads SOLID:SIZE[,round=MM], where SIZE has the numbers that the solid needs: sphere:80, box:60x40x20,
 * capsule:20x60, cylinder:40x60 and torus:80x16 (across and along z). ISO_ERR_USAGE. */
iso_status isosculpt_solid_parse(const char *text, iso_start_solid *solid, iso_error *error);

/* The group of the options that say how a volume is read. */
#define ISOSCULPT_READING "Reading a volume"

/* Name, version and option table of isosculpt. */
const iso_program *isosculpt_program(void);

/* Parses the command line into `settings` and checks that the options agree with each other. `operands` has
 * room for argc pointers. ISO_ERR_USAGE. */
iso_status isosculpt_settings_parse(int argc, char *const *argv, isosculpt_settings *settings,
                                    iso_operands *operands, iso_error *error);

/* Headless (replay.c): makes the field of --open or --replay, plays the stroke file and writes the outputs.
 * Removes written outputs when a later one fails. Errors: those of reading, playing and writing. */
iso_status isosculpt_replay(const isosculpt_settings *settings, iso_pool *pool, iso_error *error);

/* Opens the window (window/window.c) and returns when it is closed. ISO_ERR_BACKEND: no window can be opened,
 * or the program was built without one. */
iso_status isosculpt_window(const isosculpt_settings *settings, iso_pool *pool, iso_error *error);

#endif
