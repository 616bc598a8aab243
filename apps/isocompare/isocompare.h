/* isocompare: the settings of the program, and its commands, images, surfaces and report. */
#ifndef ISO_APPS_ISOCOMPARE_ISOCOMPARE_H
#define ISO_APPS_ISOCOMPARE_ISOCOMPARE_H

#include "apps/common/json.h"
#include "apps/common/settings.h"
#include "base/parallel.h"
#include "compare/metrics.h"
#include "compare/surfaces.h"
#include "isopoint.h"

enum { ISOCOMPARE_BOUNDS = 32 };

typedef enum isocompare_command {
    ISOCOMPARE_IMAGES,
    ISOCOMPARE_REPORT,
    ISOCOMPARE_SURFACES,
    ISOCOMPARE_SHEET
} isocompare_command;

/* A limit of --fail-under: METRIC=VALUE. */
typedef struct isocompare_bound {
    const iso_metric *metric;
    double value;
} isocompare_bound;

/* Strings are borrowed from argv. */
typedef struct isocompare_settings {
    iso_common_settings common; /* first */
    isocompare_command command;
    const char *volume, *output; /* for the command report; of surfaces and sheet the page */
    double isovalue;             /* for the commands but images, physical; NaN: not given */
    int jobs;                    /* processes of sheet; 0: one for each processor */
    int side;
    const char *truth, *candidate; /* for the commands but report; of sheet folders */
    const char *truth_aov, *candidate_aov;
    const char *difference;
    iso_rgb background;
    double voxel, pixels_per_voxel, pixels_per_degree;
    isocompare_bound bounds[ISOCOMPARE_BOUNDS];
    int bound_count;
    const char *of_images, *of_report; /* the last option given that belongs only to images, and only to
                                          report; NULL: none */
    const char *not_of_surfaces;       /* the last option given that surfaces and sheet do not have */
} isocompare_settings;

const iso_program *isocompare_program(void);

/* Parses the command line into `settings` and checks that the options agree with each other. `operands` has
 * room for argc pointers. ISO_ERR_USAGE. */
iso_status isocompare_settings_parse(int argc, char *const *argv, isocompare_settings *settings,
                                     iso_operands *operands, iso_error *error);

/* metric_text.c: the values of metrics as they are shown to users. The PSNR of equal pictures is infinite. */
double isocompare_metric_value(const iso_metric *metric, const iso_metrics *metrics);
double isocompare_psnr_value(double psnr); /* of iso_psnr */
/* Formats a value with `format`, which takes a double: "-" for unknown (NaN), "identical" for infinite
 * values. Returns `text`. */
const char *isocompare_metric_text(double value, const char *format, char *text, size_t size);
/* Writes null for an unknown value, and the string "inf" for an infinite one. */
void isocompare_put_metric(iso_json *json, const char *key, double value);

/* images.c: compares two pictures and prints or writes the metrics. ISO_ERR_MISMATCH when the candidate is
 * worse than a bound. */
iso_status isocompare_images(const isocompare_settings *settings, iso_pool *pool, iso_error *error);

/* surfaces.c: compares two surfaces, prints or writes distances, areas and volumes, and writes a page. */
iso_status isocompare_surfaces(const isocompare_settings *settings, iso_pool *pool, iso_error *error);

/* The same of one pair for a sheet: the first surface, coloured by its distance from the second (an image of
 * `side` pixels, the caller's: iso_image_free), and the distances. */
iso_status isocompare_pair(const isocompare_settings *settings, iso_pool *pool, iso_image *image,
                           iso_surfaces_compared *result, iso_error *error);

/* sheet.c: compares the files of two folders, pair by pair, on one sheet. *code: the exit status of the first
 * pair that failed, or 0. */
iso_status isocompare_sheet(const isocompare_settings *settings, int *code, iso_error *error);

/* report.c: draws a volume by every method and writes report.html and report.json, both or neither. */
iso_status isocompare_report(const isocompare_settings *settings, iso_pool *pool, iso_error *error);

#endif
