/* source: what a sculpting session begins with (a solid, a level set, a volume at an isovalue, a mesh, lines
 * or points), converted into a field that can be sculpted; and volumes that are viewed before they are
 * sculpted. Used by isosculpt and by the public header's functions for sculpting. */
#ifndef ISO_SOURCE_SOURCE_H
#define ISO_SOURCE_SOURCE_H

#include "base/c_linkage.h"
#include "base/file_types.h"
#include "base/parallel.h"
#include "base/progress.h"
#include "extract/isovalue/isovalue.h"
#include "grids/closing/closed_mesh.h"
#include "grids/hgrid.h"
#include "grids/parts/components.h"
#include "grids/volume/input.h"
#include "grids/volume/volume.h"
#include "sculpt/field/cell_items.h"
#include "sculpt/session/journal.h"
#include "sculpt/session/session.h"

ISO_C_BEGIN

/* A volume in memory that is viewed before it is sculpted. Read only, so that threads may share it. */
typedef struct iso_source_volume {
    char path[ISO_JOURNAL_TEXT];
    uint32_t crc;                   /* checksum of the file */
    char reading[ISO_JOURNAL_TEXT]; /* the options it was read with, as iso_input_write writes them */
    int largest;                    /* number of parts to keep when it is converted into a field, as in
                                       iso_input */
    double min_size;                /* mm3, as in iso_input */
    iso_volume volume;
    bool has_isovalues; /* it is dense and not a level set, so the user can choose an isovalue. Then the
                           following are set: */
    iso_histogram histogram;
    double suggested;                           /* isovalue to begin with, physical */
    double candidates[ISO_ISOVALUE_CANDIDATES]; /* iso_isovalue_suggest, best first */
    size_t candidate_count;
} iso_source_volume;

/* Reads a volume; iso_source_volume_free when done. `input` (NULL: default options) and `pool` are borrowed
 * for the call. Errors: those of iso_input_read; ISO_ERR_EMPTY when no voxel is finite. */
iso_status iso_source_volume_read(const char *path, const iso_input *input, iso_pool *pool,
                                  const iso_progress *progress, iso_source_volume **volume, iso_error *error);
void iso_source_volume_free(iso_source_volume *volume); /* NULL is fine */

typedef struct iso_source {
    const char *path;             /* NULL: `solid` */
    const iso_start_solid *solid; /* borrowed */
    double isovalue;              /* physical; NAN: not given, which is allowed for level sets and meshes */
    double voxel; /* mm; 0: the file's smallest spacing; for meshes and lines 1/256 of their longest side */
    double close_holes;              /* of an open mesh: iso_closing_opts.hole, mm */
    const iso_input *input;          /* how the file is read, borrowed; NULL: default options */
    iso_pool *pool;                  /* borrowed */
    const iso_progress *progress;    /* called from any thread; cancelled: ISO_ERR_IO */
    const iso_source_volume *volume; /* the file's content, if it is already in memory, borrowed; or NULL */
    bool voxel_isovalue;             /* iso_journal_start */
    /* Is called with each note of the reader or the conversion, a line that begins with the path; or NULL. */
    void (*note)(const char *text);
    iso_mesh_report *report;      /* receives how the mesh was closed, if the file is a mesh; or NULL */
    iso_components_totals *parts; /* receives which parts were kept and dropped; or NULL */
    /* Receives the colours of a mesh, of points or of a .vdb file as the paint of the field, for
     * iso_cell_items_free: empty if the file has none. NULL: not wanted. */
    iso_cell_items *paint;
    iso_file_set *files; /* every file that is read is added; or NULL */
} iso_source;

/* Makes the solid, or reads the file, converts it into a field (*grid, the caller's), and fills the journal's
 * header (*start). A level set (.vdb) at its own voxel size is used as it is; a volume is sampled and
 * redistanced; a mesh is closed if it is open (grids/closing/closed_mesh.h), and becomes a distance field;
 * lines (.tck .trk .swc) become the solid of the tubes around them; points (also those of a .ply without
 * triangles) become the solid whose surface they lie on (grids/point_solid.h). All get 32 voxels of room on
 * every side. Parts of the solid are dropped as `input` (or the volume) says. ISO_ERR_USAGE: a volume without
 * an isovalue; else the readers' errors. */
iso_status iso_source_open(const iso_source *source, iso_journal_start *start, iso_hgrid **grid,
                           iso_error *error);

/* Makes the field that a stroke file began with, from its header (*start, updated): its solid, or from the
 * file at the path in the header, or the file of the same name beside the stroke file `strokes`. Only these
 * members of `how` count: voxel (0: the header's), pool, progress, parts, files, input->max_memory and paint,
 * which is empty if the session did not begin with colours. All holes of a mesh are closed, since those that
 * matter were closed when the session began. ISO_ERR_IO: the file is missing; ISO_ERR_FORMAT: its content has
 * changed. */
iso_status iso_source_reopen(const char *strokes, const iso_source *how, iso_journal_start *start,
                             iso_hgrid **grid, iso_error *error);

/* Finds the file that a session began with, as iso_source_reopen does, and compares its content. strokes: ""
 * if the session has no stroke file. The same errors. */
enum { ISO_SOURCE_PATH = 2 * ISO_JOURNAL_TEXT };
iso_status iso_source_find(const char *strokes, const iso_journal_start *start, const iso_progress *progress,
                           char found[ISO_SOURCE_PATH], iso_error *error);

/* What a file is taken for, judged by its type and content (io/file_contents.h): ISO_HOLDS_MESH, _POINTS,
 * _LINES, or otherwise _VOLUME. */
unsigned iso_source_kind(const char *path);

/* Reads the mesh or grey picture (.png) at source->path as a stamp; iso_stamp_free when done. Voxel size,
 * isovalue and volume of the source do not count. Errors: those of iso_mesh_read, iso_closed_mesh_create,
 * iso_stamp_from_mesh and iso_grey_picture_read. */
iso_status iso_source_read_stamp(const iso_source *source, iso_stamp **stamp, iso_error *error);

/* Freezes the voxels of a session's field in the solid that a volume has at an isovalue (physical), as a
 * stroke with ISO_TOOL_MASK_VOXELS, which needs no volume to be replayed. Beyond the volume nothing is
 * frozen. `pool` may be NULL. ISO_ERR_EMPTY: nothing is; ISO_ERR_USAGE: a stroke is being drawn;
 * ISO_ERR_NOMEM. */
iso_status iso_source_freeze(iso_session *session, const iso_grid *volume, double isovalue, iso_pool *pool,
                             iso_error *error);
/* The same of all labels of a segmentation but `own` and the background. */
iso_status iso_source_freeze_labels(iso_session *session, const iso_grid *volume, int own, iso_pool *pool,
                                    iso_error *error);

ISO_C_END
#endif
