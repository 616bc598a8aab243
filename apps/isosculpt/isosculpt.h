/* isosculpt: what its parts share. */
#ifndef ISO_APPS_ISOSCULPT_ISOSCULPT_H
#define ISO_APPS_ISOSCULPT_ISOSCULPT_H

#include "apps/common/settings.h"
#include "extract/mesh/mesh.h"
#include "extract/mesh/mesh_measure.h"
#include "extract/points/points.h"
#include "grids/closing/closed_mesh.h"
#include "grids/parts/components.h"
#include "sculpt/session/session.h"

/* Which engine draws in the window; auto: OpenGL where a GPU does it. */
typedef enum isosculpt_backend {
    ISOSCULPT_BACKEND_AUTO,
    ISOSCULPT_BACKEND_CPU,
    ISOSCULPT_BACKEND_GL
} isosculpt_backend;

typedef struct isosculpt_settings {
    iso_common_settings common; /* first; `input` says how the opened file is read */
    const char *strokes;        /* the operand: a stroke file to continue in a window */
    const char *replay, *open, *stamp, *output, *mesh;
    int headless, recover, extract, draw;
    int backend;                 /* isosculpt_backend */
    int resolution[2];           /* of the pictures that are drawn; 0: 1280 x 800 */
    double voxel_size, isovalue; /* isovalue: NAN when not given */
    double close_holes;          /* iso_closing_opts.hole */
    uint64_t undo_memory;        /* bytes */
} isosculpt_settings;

const iso_program *isosculpt_program(void);

/* Parses and checks. ISO_ERR_USAGE. */
iso_status isosculpt_settings_parse(int argc, char *const *argv, isosculpt_settings *settings,
                                    iso_operands *operands, iso_error *error);

/* What a replay did, and how long each touch of the hand took. */
typedef struct isosculpt_times {
    double *seconds; /* one a sample, owned */
    size_t count, room;
} isosculpt_times;

typedef struct isosculpt_report {
    iso_journal_start start;
    iso_mesh_report opened_mesh; /* of what was opened, when it is one */
    size_t strokes, samples, undone;
    iso_edit_stats edits;
    isosculpt_times edit, extract, draw, step; /* step: all that a sample takes */
    double total;
    size_t bricks, bytes, points;
    iso_components_totals parts; /* of what was opened; all 0 unless some could be dropped */
    bool has_mesh;
    iso_mesh_measures mesh; /* of the mesh that was written, with --json */
    int resolution[2];      /* of the pictures */
} isosculpt_report;

void isosculpt_report_free(isosculpt_report *report);

/* Plays a stroke file and writes what was asked for. *code: the exit status. */
iso_status isosculpt_replay(const isosculpt_settings *settings, iso_pool *pool, iso_error *error);

/* Opens the window and returns when it is closed. ISO_ERR_BACKEND: none can be opened, or the build has none.
 */
iso_status isosculpt_window(const isosculpt_settings *settings, iso_pool *pool, iso_error *error);

/* The report as JSON, to settings->common.json_path or standard output. ISO_ERR_WRITE. */
iso_status isosculpt_report_write(const isosculpt_settings *settings, const isosculpt_report *report,
                                  iso_error *error);

#endif
