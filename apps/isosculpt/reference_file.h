/* reference_file: the reference of a session from files: lines and glyphs, or one surface. */
#ifndef ISO_APPS_ISOSCULPT_REFERENCE_FILE_H
#define ISO_APPS_ISOSCULPT_REFERENCE_FILE_H

#include "apps/isosculpt/isosculpt.h"
#include "apps/isosculpt/viewport/reference.h"
#include "base/progress.h"

enum { ISOSCULPT_REFERENCE_NOTES = 8, ISOSCULPT_REFERENCE_NOTE = 1024 };

/* The colour of the label that a session sculpts, in its segmentation. */
typedef struct isosculpt_sculpted_label {
    bool known;
    iso_rgb color;
} isosculpt_sculpted_label;

/* The settings are borrowed: references, space, close_holes, threads and input.max_memory count. */
typedef struct isosculpt_reference_files {
    const isosculpt_settings *settings;
    bool labels;  /* without files: the other labels (reference_job.h) */
    double voxel; /* mm; of surfaces that are read from meshes */
    iso_box box;  /* box of the sculpture; a note is written about files that lie beside it */
    const iso_progress *progress;
    /* Result: notes for the user, one line each. */
    char notes[ISOSCULPT_REFERENCE_NOTES][ISOSCULPT_REFERENCE_NOTE];
    int note_count;
    isosculpt_sculpted_label sculpted; /* and, with `labels`, this */
} isosculpt_reference_files;

/* Reads all files. .tck, .trk and .swc contain lines; .xyz, .pdb and .csv glyphs; .vtk and .vtp lines or, if
 * there are none, glyphs; .obj and .ply lines, a mesh or (.ply only) glyphs, whichever is found first. All
 * others contain surfaces: level sets and meshes, as read by iso_source_open. Glyphs are spheres, or
 * ellipsoids if the file has axes. ISO_ERR_USAGE: a surface together with other files; the readers' errors;
 * ISO_ERR_EMPTY: a file contains nothing to draw. Messages name the file. May be called in any thread. */
iso_status isosculpt_reference_read(isosculpt_reference_files *files, isosculpt_reference **reference,
                                    iso_error *error);

#endif
