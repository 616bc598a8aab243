/* labels: what is written into and onto pictures beside the surface; picture.c. */
#ifndef ISO_APPS_ISORENDER_LABELS_H
#define ISO_APPS_ISORENDER_LABELS_H

#include "apps/isorender/isorender.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Metadata of the picture's file. Without paths and thread counts, so that the same picture is the same file
 * everywhere. */
typedef struct isorender_labels {
    char software[64], isovalues[512], command[ISO_RECORD_SIZE + 256];
} isorender_labels;
void isorender_labels_make(const isorender_job *job, isorender_labels *labels);
/* The unit of the picture's world: that of the points, or of lines and glyphs if there is nothing else, as
 * far as their files state it; mm with a volume, and
 * by --mm-per-pixel if none is stated. */
iso_world_unit isorender_unit(const isorender_job *job);
/* 0: there is no single scale, or `unit`, that of the world, has no length here. */
double isorender_pixels_per_metre(const iso_camera *camera, int height, iso_world_unit unit);

#ifdef __cplusplus
}
#endif
#endif
