/* chunks: volumes that are drawn chunk by chunk, those larger than memory and the parts of pictures, if
 * job->chunks is set. */
#ifndef ISO_APPS_ISORENDER_CHUNKS_H
#define ISO_APPS_ISORENDER_CHUNKS_H

#include "apps/isorender/isorender.h"
#include "grids/volume_index.h"
#include "scene/point_chunks.h"

/* A volume that is drawn chunk by chunk. */
typedef struct isorender_chunks {
    isorender_backend cpu; /* job->backend: OpenGL draws no chunks */
    iso_chunk_source source;
    iso_chunk_walk *walk;
    iso_volume_index index;
    char *index_path;  /* where the index is kept; NULL: nowhere */
    const char *stage; /* of isorender_progress, while chunks are visited */
    bool fits;         /* the volume could be read as a whole: its picture is framed as if it were */
    /* The error of isorender_chunks_bounds, kept until a caller that can fail returns it. */
    iso_status status;
    iso_error error;
} isorender_chunks;

/* Decides, after the header was read, whether the volume is drawn in chunks, and sets job->chunks then:
 * when --part or --chunk-size is given, and when the volume is larger than the memory limit and the options
 * allow it. ISO_ERR_USAGE: the options given do not go together with chunks. */
iso_status isorender_chunks_choose(isorender_job *job, iso_error *error);
void isorender_chunks_free(isorender_job *job);
uint64_t isorender_chunks_bytes(const isorender_job *job); /* of the keys */
/* Reads the index of the volume, NAME.isoindex, before the isovalue is chosen. */
iso_status isorender_chunks_begin(isorender_job *job, iso_error *error);
/* A member of the report: chunks, and how much of the volume was read. */
void isorender_report_chunks(iso_json *json, const isorender_job *job);
/* Finds the surface's cells: sets their number, the surface's bounds, and *index to those in index
 * coordinates. */
iso_status isorender_chunks_extract(isorender_job *job, iso_box *index, iso_error *error);
/* Writes the plan's points and mesh. */
iso_status isorender_chunks_export(isorender_job *job, const char *comment, iso_error *error);
/* The surface's box in the coordinates to which `affine` maps its index coordinates. Empty after a failure,
 * of which isorender_chunks_check tells. */
iso_box isorender_chunks_bounds(const isorender_job *job, const iso_affine *affine);
iso_status isorender_chunks_check(const isorender_job *job, iso_error *error);
/* Draws the picture. */
iso_status isorender_chunks_draw(isorender_job *job, const iso_picture_opts *opts, iso_image *image,
                                 size_t *covered, iso_error *error);
/* Draws part --part of the picture of job->camera and writes it to the plan's image. */
iso_status isorender_chunks_write_part(isorender_job *job, iso_error *error);

/* log.c: logs that voxels are NaN or infinite, if some are. */
void isorender_log_nonfinite(const isorender_job *job);

#endif
