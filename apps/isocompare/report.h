/* report: the data of isocompare report, and the functions that write it. */
#ifndef ISO_APPS_ISOCOMPARE_REPORT_H
#define ISO_APPS_ISOCOMPARE_REPORT_H

#include "apps/isocompare/isocompare.h"
#include "compare/cost.h"
#include "compare/splat_cost.h"
#include "compare/stroke_cost.h"
#include "compare/transparency.h"
#include "compare/visible_points.h"
#include "scene/loader.h"
#include "scene/method.h"

enum { REPORT_ZOOMS = 3, REPORT_METHODS = 16 };

/* Number of samples for each pixel. REPORT_SINGLE: 1 in the candidate and 1 in the truth; REPORT_FINE: 4 and
 * 16. */
typedef enum report_sampling { REPORT_SINGLE, REPORT_FINE, REPORT_SAMPLINGS } report_sampling;

/* A PNG in memory. */
typedef struct report_picture {
    uint8_t *bytes;
    size_t size;
} report_picture;

/* The results of a method at one zoom. cells[0] of a view is the truth, which has no metrics and no
 * difference picture. */
typedef struct report_cell {
    iso_metrics metrics[REPORT_SAMPLINGS];
    double seconds;  /* time of a picture with one sample a pixel, median of three */
    uint64_t memory; /* bytes allocated while drawing it; 0: unknown */
    report_picture picture, difference;
} report_cell;

typedef struct report_view {
    int zoom;
    double pixels_per_voxel;
    iso_view view;
    report_cell cells[1 + REPORT_METHODS];
    iso_visible_points visible;
} report_view;

typedef struct report_part {
    bool made;
    double seconds;
    iso_part_size size;
} report_part;

typedef struct report {
    const isocompare_settings *settings;
    iso_pool *pool;
    iso_loader loader;
    iso_file_set files; /* the files that are read, and the outputs */
    char *model;        /* the volume's name without folder and extension */
    iso_scene_surface surface;
    iso_study_ball ball;
    double voxel; /* the smallest spacing, mm */
    const char *isovalue_from;
    const iso_renderer *methods[1 + REPORT_METHODS]; /* the truth is the first one */
    int method_count;                                /* the truth is counted */
    int step;                                        /* of the steps that are logged, the last one */
    report_part parts[ISO_PART_COUNT];
    report_view views[REPORT_ZOOMS];
    int transparency_side; /* pixels along a side of the translucent pictures */
    iso_transparency_study transparency;
    iso_cost_study cost;
    iso_splat_cost splats;
    iso_stroke_cost strokes; /* if the input is a stroke file */
    char *page;              /* the surface as a page, as HTML of the report; NULL: none can be made */
    char processor[128];
    uint64_t peak; /* largest memory of the process, bytes */
} report;

/* html.c: writes the whole page. Write errors are detected when the caller commits the stream's sink. */
void isocompare_write_html(const report *r, FILE *stream);
/* report_json.c: writes all numbers of the report. Write errors are detected in the same way.
 * ISO_ERR_NOMEM. */
iso_status isocompare_write_json(const report *r, FILE *stream, iso_error *error);

/* html_page.c: the surface at the report's isovalue as an element of HTML that holds a page
 * (apps/common/page.h); the caller's: free(). NULL: this build writes no pages, the volume is sparse, its
 * voxels are too many, or there is no memory. */
char *isocompare_make_page(const report *r);

/* plots.c: plots as inline SVG. A report_value gives the number of a cell; NaN is not plotted. */
typedef double report_value(const report *r, int view, int method);
typedef struct report_plot {
    const char *title, *unit;
    report_value *value;
    bool logarithmic, with_truth;
} report_plot;
void isocompare_plot_bars(const report *r, const report_plot *plot, FILE *stream);
/* Plots the error (FLIP, with one sample for each pixel) against the time for a picture. */
void isocompare_plot_scatter(const report *r, FILE *stream);
const char *isocompare_method_color(int method); /* colour of a method, by its number in the report */

/* Writes a time with three digits, and a number with three digits and a metric prefix: 1234567 as "1.23 M",
 * or with a unit as "1.23 MB". */
void isocompare_put_milliseconds(FILE *stream, double seconds);
void isocompare_put_amount(FILE *stream, double value, const char *unit);
/* html_cost.c: writes a cell of a table with a rate, a time or a percentage; a dash if it is NaN. */
void isocompare_put_cell(FILE *stream, double value, const char *unit);
/* The tables of what extraction and frames cost. */
void isocompare_put_costs(const report *r, FILE *stream);
/* html_points.c: the tables of what is selected from the points, and of splats in groups. */
void isocompare_put_points(const report *r, FILE *stream);

/* machine.c: describes the processor and measures the memory of this process. */
void isocompare_processor(char *text, size_t size);
bool isocompare_reset_peak(void);        /* false: the system does not allow it */
uint64_t isocompare_resident(bool peak); /* bytes now, or (peak) the largest number since the reset; 0:
                                            unknown */

#endif
