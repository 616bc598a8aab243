/* unit: the units of length that files state, for numbers that a person reads. Coordinates stay as they are
 * in the file, and functions that speak of mm mean the file's unit. Thread-safe. */
#ifndef ISO_BASE_UNIT_H
#define ISO_BASE_UNIT_H

typedef enum iso_world_unit {
    ISO_WORLD_UNIT_MILLIMETRE, /* the world's own */
    ISO_WORLD_UNIT_NONE,       /* neither the format nor the file states one */
    ISO_WORLD_UNIT_ANGSTROM,
    ISO_WORLD_UNIT_MICROMETRE,
    ISO_WORLD_UNIT_METRE,
    ISO_WORLD_UNIT_FOOT,        /* .3048 m */
    ISO_WORLD_UNIT_SURVEY_FOOT, /* 1200 / 3937 m */
    ISO_WORLD_UNIT_DEGREE       /* longitude and latitude, beside heights in another unit */
} iso_world_unit;

/* What stands behind a number: " mm", ..; an empty text for ISO_WORLD_UNIT_NONE. */
const char *iso_world_unit_suffix(iso_world_unit unit);
/* Millimetres of a unit; 0: it is no length, or not a power of ten of a metre. */
double iso_world_unit_millimetres(iso_world_unit unit);

#endif
