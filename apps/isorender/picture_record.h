/* picture_record: what a picture's file says of the picture beside its pixels, and units of lengths in it. */
#ifndef ISO_APPS_ISORENDER_PICTURE_RECORD_H
#define ISO_APPS_ISORENDER_PICTURE_RECORD_H

#include "apps/isorender/isorender.h"
#include "scene/picture_file.h"

/* Metadata of the picture's file. Without paths and thread counts, so that the same picture is the same file
 * everywhere. */
typedef struct isorender_picture_record {
    char software[64], isovalues[512], command[ISO_RECORD_SIZE + 256];
    char *scene; /* isorender_scene_text; owned, or NULL */
} isorender_picture_record;
/* isorender_picture_record_free when done. ISO_ERR_NOMEM. */
iso_status isorender_picture_record_make(const isorender_job *job, isorender_picture_record *record,
                                         iso_error *error);
void isorender_picture_record_free(isorender_picture_record *record);
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
