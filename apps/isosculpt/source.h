/* source: what a session begins with, when it is no new ball: a level set, any volume at an isovalue, or a
 * mesh, as a field that can be sculpted. */
#ifndef ISO_APPS_ISOSCULPT_SOURCE_H
#define ISO_APPS_ISOSCULPT_SOURCE_H

#include "apps/common/input.h"
#include "base/parallel.h"
#include "base/progress.h"
#include "extract/isovalue/isovalue.h"
#include "grids/closing/closed_mesh.h"
#include "grids/hgrid.h"
#include "grids/parts/components.h"
#include "grids/volume/volume.h"
#include "sculpt/session/journal.h"

#ifdef __cplusplus
extern "C" {
#endif

/* A volume in memory, before it is sculpted. Read only: threads may share it. */
typedef struct isosculpt_volume {
    char path[ISO_JOURNAL_TEXT];
    uint32_t crc;                   /* of the file */
    char reading[ISO_JOURNAL_TEXT]; /* how it was read, as journals keep it */
    int largest;                    /* parts to keep when it becomes a field, as an iso_input's */
    double min_size;
    iso_volume volume;
    /* of volumes that have isovalues to choose from: */
    bool has_isovalues; /* dense and no level set */
    iso_histogram histogram;
    double suggested;
    double candidates[ISO_ISOVALUE_CANDIDATES]; /* best first; iso_isovalue_suggest */
    size_t candidate_count;
} isosculpt_volume;

/* `input` (NULL: by default) and `pool` are borrowed for the call. As iso_input_read; ISO_ERR_EMPTY when no
 * voxel is a number. */
iso_status isosculpt_volume_read(const char *path, const iso_input *input, iso_pool *pool,
                                 const iso_progress *progress, isosculpt_volume **volume, iso_error *error);
void isosculpt_volume_free(isosculpt_volume *volume); /* NULL is fine */

typedef struct isosculpt_source {
    const char *path;
    double isovalue; /* physical; NAN: not given, which only level sets and meshes can do without */
    double voxel;    /* mm; 0: the file's smallest spacing, or a 256th of a mesh's longest side */
    iso_pool *pool;  /* borrowed */
    const iso_progress *progress;   /* told from any thread; cancelled: ISO_ERR_IO */
    const isosculpt_volume *volume; /* the file's content, borrowed; NULL: it is read */
    double close_holes;             /* of an open mesh: iso_closing_opts.hole */
    iso_mesh_report *report;        /* of a mesh, when it is one; NULL: not wanted */
    const iso_input *input;         /* how it is read, borrowed; NULL: by default */
    bool voxel_isovalue;            /* iso_journal_start */
    iso_components_totals *parts;   /* what was kept and dropped; NULL: nobody asks */
    iso_file_set *files;            /* gets every file that is read; NULL is fine */
    bool notes;                     /* say on stderr what the reader had to decide */
} isosculpt_source;

/* Reads the file and says in *start what a journal says of it. A level set (.vdb) at its own voxel size is
 * taken as it is; a volume is sampled and made a distance field; so is a mesh, which is closed if it is open
 * (grids/closing/closed_mesh.h). All with 32 voxels of room around. Parts of the solid are dropped as `input`
 * (or the volume, as it was read) says, and the distances around them made again. ISO_ERR_USAGE: a volume
 * without an isovalue; else as the readers. */
iso_status isosculpt_source_open(const isosculpt_source *source, iso_journal_start *start, iso_hgrid **grid,
                                 iso_error *error);

/* The same from a journal's header: the file by its path, or beside the stroke file `strokes`. Of `how`
 * only voxel (0: the header's), pool, progress and the input's max_memory count: the holes of a mesh were
 * closed when the session began, and are closed again whatever their size. ISO_ERR_IO when it is not there,
 * ISO_ERR_FORMAT when it is not the same any more. */
iso_status isosculpt_source_find(const char *strokes, const isosculpt_source *how, iso_journal_start *start,
                                 iso_hgrid **grid, iso_error *error);

/* By its name. */
bool isosculpt_is_mesh(const char *path);

/* The mesh at source->path as a stamp; of the source its voxel size, isovalue and volume do not count. As
 * iso_mesh_read, iso_closed_mesh_create and iso_stamp_from_mesh. */
iso_status isosculpt_stamp_read(const isosculpt_source *source, iso_stamp **stamp, iso_error *error);

#ifdef __cplusplus
}
#endif
#endif
