/* sheet_settings: the part of isorender's settings that is about contact sheets. */
#ifndef ISO_APPS_ISORENDER_SHEET_SETTINGS_H
#define ISO_APPS_ISORENDER_SHEET_SETTINGS_H

#include "apps/isorender/bids.h"
#include "isopoint.h"

/* A number that --measure puts at each panel of a contact sheet. */
typedef enum isorender_measure {
    ISORENDER_MEASURE_NONE,
    ISORENDER_MEASURE_VOLUME,
    ISORENDER_MEASURE_AREA,
    ISORENDER_MEASURE_PARTS,
    ISORENDER_MEASURE_ISOVALUE,
    ISORENDER_MEASURE_MINIMUM,
    ISORENDER_MEASURE_MAXIMUM
} isorender_measure;
extern const char *const isorender_measures[]; /* their names, NULL-terminated */

enum { ISORENDER_SHEET_PANEL = 256 }; /* pixels a side without --resolution */

/* A picture of a contact sheet, and what is kept of it. */
typedef struct isorender_tile {
    bool is_survey;           /* only what --same-view shares is found */
    iso_image image;          /* owned */
    double isovalue, measure; /* NaN: there is none */
} isorender_tile;

typedef struct isorender_sheet_settings {
    int is_given;         /* the command is sheet */
    int jobs;             /* processes; 0: one for each processor */
    int measure;          /* isorender_measure */
    int watch;            /* whatever the command is, it is done again whenever an input changes */
    isorender_bids bids;  /* the inputs, if they are those of a folder of BIDS */
    isorender_tile *tile; /* borrowed; the picture is one of a sheet; NULL: it is a file of its own */
} isorender_sheet_settings;

#endif
