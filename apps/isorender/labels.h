/* labels: what is written into and onto pictures beside the surface; picture.c. */
#ifndef ISO_APPS_ISORENDER_LABELS_H
#define ISO_APPS_ISORENDER_LABELS_H

#include "apps/isorender/isorender.h"
#include "scene/picture_file.h"

/* Metadata of the picture's file. Without paths and thread counts, so that the same picture is the same file
 * everywhere. */
typedef struct isorender_labels {
    char software[64], isovalues[512], command[ISO_RECORD_SIZE + 256];
    char *scene; /* isorender_scene_text; owned, or NULL */
} isorender_labels;
/* isorender_labels_free when done. ISO_ERR_NOMEM. */
iso_status isorender_labels_make(const isorender_job *job, isorender_labels *labels, iso_error *error);
void isorender_labels_free(isorender_labels *labels);
/* camera.c: the end of the command that the picture's file states: --fit=box if the picture frames the box
 * only because it is drawn in chunks; else nothing. */
const char *isorender_camera_record(const isorender_job *job);
/* The unit of the picture's world: that of the volume, of the points, or of lines and glyphs if there is
 * nothing else, as far as their files state it; mm by --mm-per-pixel if none is stated. */
iso_world_unit isorender_unit(const isorender_job *job);
iso_world_unit isorender_volume_unit(const iso_volume_info *info);
/* How lengths are shown. */
iso_length_style isorender_lengths(const isorender_job *job);
/* Of --dpi, or of a picture of one scale at its true size; 0: neither, or the world's unit has no length
 * here. */
double isorender_pixels_per_metre(const isorender_job *job);

#endif
