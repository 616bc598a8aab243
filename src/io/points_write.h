/* points_write: writes points as PLY; iso_glyphs_read (io/glyphs/glyphs_read.h) reads them.
 *
 * Binary little-endian PLY with per-vertex float properties x y z nx ny nz radius, world millimetres,
 * normals out of the solid, one comment naming the program; uchar red green blue where points have colours,
 * and uchar alpha where they have opacities. Points that are all those of closed surfaces have the comment
 * "closed surface of N points", too, so that readers know that points that face away are hidden. x y z are
 * doubles when the points lie so far from 0 that floats would round their places: map coordinates. */
#ifndef ISO_IO_POINTS_WRITE_H
#define ISO_IO_POINTS_WRITE_H

#include <stdbool.h>
#include <sys/types.h>

#include "base/file.h"
#include "base/geometry.h"
#include "base/primitives.h"
#include "base/status.h"

/* Writes through base/file.h. `comment` (one line) may be NULL. ISO_ERR_WRITE. */
iso_status iso_points_write_ply(const char *path, const iso_point_view *view, const char *comment,
                                iso_error *error);

/* A file whose points are written in pieces, in any order. */
typedef struct iso_point_file_opts {
    uint64_t count;     /* of all points */
    const iso_box *box; /* around all points, in index coordinates */
    const iso_transform *transform;
    bool colors;         /* the points have colours */
    bool opacities;      /* the points have opacities */
    bool closed;         /* as in iso_point_view */
    const char *comment; /* or NULL */
} iso_point_file_opts;

typedef struct iso_point_file {
    iso_sink sink; /* end with iso_sink_commit or iso_sink_abort */
    iso_affine affine;
    bool doubles;
    int record;  /* bytes of a point */
    off_t start; /* of the first point; below 0: the file can only be written from its beginning to its end */
} iso_point_file;

/* Opens the file and writes its header. ISO_ERR_WRITE. */
iso_status iso_point_file_begin(const char *path, const iso_point_file_opts *opts, iso_point_file *file,
                                iso_error *error);
/* The next points are those from `number` on. */
void iso_point_file_seek(iso_point_file *file, uint64_t number);
/* Writes the points of a span of the view. Errors are found by iso_sink_commit. */
void iso_point_file_put(iso_point_file *file, const iso_point_view *view, const iso_point_span *span);

#endif
