/* loader: opens and reads the input of a program that works on one input at a time: a volume file or DICOM
 * folder, a procedural scene ("scene:NAME" or "scene:NAME:SIZE"), a file of points
 * (io/file_contents.h), a stroke file, whose strokes are played, or any of these files on standard input
 * ("-") or from a FIFO. The format of a volume is found from its content, not from its name.
 *
 *     iso_loader loader = {.input = path, .options = &input, .files = &files, .pool = pool};
 *     iso_loader_open(&loader, &error)     the header: kind of input, size, type; nothing large is read
 *     ... check whether the run fits into memory, whether the outputs can be written ...
 *     iso_loader_read(&loader, &error)     the voxels or points
 *     iso_loader_close(&loader)            always, also after an error
 *
 * Messages name the input only where a reader does; the caller puts iso_spool_name(loader.input) before the
 * others. One thread at a time. */
#ifndef ISO_SCENE_LOADER_H
#define ISO_SCENE_LOADER_H

#include "base/parallel.h"
#include "extract/isovalue/isovalue.h"
#include "grids/volume/input.h"
#include "io/glyphs/mapped_points.h"
#include "scene/input_spool.h"
#include "scene/painted.h"

/* The volume that was read last, for the next loader: work on one file in several steps reads it once.
 * Zero-initialise; iso_loader_shelf_free when done. */
typedef struct iso_loader_shelf {
    iso_volume volume; /* a dense one that nobody has edited; without a grid: there is none */
    char *path;
    iso_input options; /* with which it was read */
    int component, crop[6];
    size_t nonfinite;
} iso_loader_shelf;
void iso_loader_shelf_free(iso_loader_shelf *shelf);

/* The caller sets the members up to progress_context, all borrowed until iso_loader_close, and zeroes the
 * others, which the functions below set. */
typedef struct iso_loader {
    const char *input;        /* as the user typed it: a path, "scene:...", "-" */
    const iso_input *options; /* how volumes are read */
    iso_file_set *files;      /* every file that is read is added, to check that no output overwrites it; or
                                 NULL */
    iso_space space;          /* of points, which do not say theirs */
    int every;                /* keeps every n-th point; 0: all */
    const char *columns;      /* names of the columns of points: iso_read_opts.columns; or NULL */
    iso_pool *pool;
    bool
        wants_histogram; /* iso_loader_histogram will be called: values are counted while the voxels are read,
                           * which saves most of its time */
    void (*progress)(void *context,
                     double fraction); /* progress of iso_loader_read, 0 .. 1; NULL: not wanted */
    void *progress_context;
    iso_loader_shelf *shelf; /* takes the volume of a file from there and puts it back; NULL: it does not */
    /* Voxels are mapped from files if they can be (iso_volume_opts.mapped), and not counted. May be set
     * after iso_loader_open. */
    bool mapped;
    bool is_further;    /* not the main input: a FIFO is refused, which could wait for ever */
    uint64_t set_aside; /* bytes of the memory limit that chunks and tiles may not take */
    int chunk_side;     /* voxels along the side of the chunks that will be read; 0: iso_loader_chunk_side */

    /* after iso_loader_open: */
    const char *path; /* what readers open: the input, or the copy of standard input or a FIFO */
    iso_spool spool;
    bool has_points;       /* the input contains points instead of a volume, */
    bool has_gaussians;    /* and these are 3-D Gaussians (iso_glyphs_are_gaussians) */
    bool mappable;         /* the volume's voxels can stay in its files (iso_volume_opts.mappable) */
    bool has_strokes;      /* the input is a stroke file; the volume is the level set that they make */
    iso_volume volume;     /* the header; for scenes also the grid */
    iso_channels channels; /* of the volume's file */
    int component;         /* options->component, or that of options->channel */
    int crop[6];           /* voxels of the file that are kept: x0 x1 y0 y1 z0 z1, first and last */
    double scene_isovalue; /* the isovalue of a scene's surface; NAN when the input is not a scene */

    /* after iso_loader_read: */
    iso_glyphs points;      /* if has_points; the caller may free them when they are not needed any more */
    iso_read_report report; /* of the points */
    iso_cell_items paint;   /* of strokes, or the colours of a .vdb level set, and */
    iso_painted painted;    /* where it lies; zero: there is none */
    size_t nonfinite;       /* voxels that are NaN or infinite */
    bool shelved;           /* the volume goes to the shelf, */
    uint64_t edit;          /* unless its log has another last edit by then */

    /* after iso_loader_histogram: */
    bool has_histogram;
    iso_histogram histogram;
    double candidates[ISO_ISOVALUE_CANDIDATES]; /* isovalues that it suggests (iso_isovalue_suggest), */
    size_t candidate_count;                     /* the best one first; 0: the volume is constant */

    /* after iso_loader_moments: */
    bool has_moments;
    iso_moments moments;
} iso_loader;

/* Reads the header, adds the files to `files` and checks that none of them is also an output. A scene is
 * created at once, because that is fast. ISO_ERR_USAGE (unknown scene, no such channel, crop outside the
 * volume, an output would overwrite an input), ISO_ERR_LIMIT (a scene larger than the memory limit), and the
 * errors of iso_spool_open and iso_volume_read_info. */
iso_status iso_loader_open(iso_loader *loader, iso_error *error);

/* Reads the voxels and crops them to `crop`, or reads the points. Errors: those of iso_volume_read and
 * iso_glyphs_read. */
iso_status iso_loader_read(iso_loader *loader, iso_error *error);

/* Maps the points instead of reading them: iso_mapped_points_open, for iso_mapped_points_close. False: they
 * must be read. */
bool iso_loader_map_points(iso_loader *loader, iso_mapped_points *points);

/* Returns whether the voxels stay in the tiles of a file (grids/volume/tiled.h), so that only chunks of
 * them can be read. */
bool iso_loader_has_tiles(const iso_loader *loader);

/* The side of the chunks in which the volume is read, voxels. A chunk may take half of the memory limit:
 * `cell_bytes` for each voxel on average; 0: the corners of the cells, if half of them are crossed. */
int iso_loader_chunk_side(const iso_loader *loader, uint64_t cell_bytes);

/* Sets `nonfinite`; iso_loader_read does so unless voxels are mapped. Errors of reading tiles. */
iso_status iso_loader_count_nonfinite(iso_loader *loader, iso_error *error);

/* Computes `histogram` from the volume, unless it exists already. ISO_ERR_EMPTY: no voxel is finite. */
iso_status iso_loader_histogram(iso_loader *loader, iso_error *error);

/* The same by several processes that call it together, each of which reads a share of the voxels. */
iso_status iso_loader_histogram_together(iso_loader *loader, const iso_ranks *ranks, iso_error *error);

/* Takes a histogram of the volume that is known already. */
void iso_loader_set_histogram(iso_loader *loader, const iso_histogram *histogram);

/* Computes `moments`, unless they exist already, by several processes that call it together, or by one: NULL.
 * ISO_ERR_EMPTY: no voxel is finite. */
iso_status iso_loader_moments(iso_loader *loader, const iso_ranks *ranks, iso_error *error);

/* The isovalue of a volume that has been read: `given`, or if that is NAN a scene's own, or the first of the
 * candidates, *chosen. ISO_ERR_EMPTY: `given` lies beyond the band of a level set, or the volume is constant;
 * errors of iso_loader_histogram. */
iso_status iso_loader_isovalue(iso_loader *loader, double given, double *isovalue, bool *chosen,
                               iso_error *error);

/* Frees everything that was read, and the copy of standard input. */
void iso_loader_close(iso_loader *loader);

/* Adds the files that `input` consists of to `files`, as far as its header can be read; errors are ignored,
 * because iso_loader_open reports them. For runs with several inputs, in which no output of one input may
 * overwrite another input. */
void iso_loader_list_files(const char *input, const iso_input *options, iso_file_set *files);

/* Returns whether a file is read as points: iso_file_contents says so, or it has rows and `columns` names its
 * columns. */
bool iso_loader_reads_points(const char *path, const char *columns);

/* Returns whether the input is a scene, judged by its name. */
bool iso_loader_is_scene(const char *input);

#endif
