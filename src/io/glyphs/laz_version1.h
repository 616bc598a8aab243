/* laz_version1: items of version 1, which LASzip wrote until 2011, and waveforms, which have no other one.
 * Each function replaces the item of the last point by that of the next. Zero-initialise the structs.
 * Internal to src/io/glyphs. */
#ifndef ISO_IO_GLYPHS_LAZ_VERSION1_H
#define ISO_IO_GLYPHS_LAZ_VERSION1_H

#include "io/glyphs/laz_coder.h"

typedef struct iso_laz_point1 {
    int32_t x_steps[3], y_steps[3]; /* the last three, of which the median is the next one's prediction */
    int newest;
    iso_laz_integers dx, dy, z, intensity, angle, source;
    iso_laz_model changed, flags[256], classes[256], users[256];
} iso_laz_point1;

typedef struct iso_laz_time1 {
    int32_t step;
    int extremes;
    iso_laz_model multiple, after_zero;
    iso_laz_integers integers;
} iso_laz_time1;

typedef struct iso_laz_color1 {
    iso_laz_model used;
    iso_laz_integers parts;
} iso_laz_color1;

typedef struct iso_laz_wave {
    uint32_t step, how; /* how the last offset was coded */
    iso_laz_model descriptor, offset[4];
    iso_laz_integers offset_step, size, place, direction;
} iso_laz_wave;

void iso_laz_point1_next(iso_laz_point1 *point, iso_laz_coder *coder, unsigned char last[20]);
void iso_laz_time1_next(iso_laz_time1 *time, iso_laz_coder *coder, unsigned char last[8]);
void iso_laz_color1_next(iso_laz_color1 *color, iso_laz_coder *coder, unsigned char last[6]);
void iso_laz_wave_next(iso_laz_wave *wave, iso_laz_coder *coder, unsigned char last[29]);

#endif
