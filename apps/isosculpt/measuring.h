/* measuring: what the window and --measure say about the sculpture: places that were picked and what lies
 * between them, volume, area and size. */
#ifndef ISO_APPS_ISOSCULPT_MEASURING_H
#define ISO_APPS_ISOSCULPT_MEASURING_H

#include "apps/common/json.h"
#include "base/c_linkage.h"
#include "scene/measure.h"

ISO_C_BEGIN

/* In the window: zero-initialise. */
typedef struct isosculpt_measuring {
    bool on;                     /* clicks on the surface pick places */
    int count;                   /* of places: the third click begins anew */
    iso_measured_place place[2]; /* the distance is between these */
    size_t place_changes;        /* document.change_count when the last one was picked */
    bool has_solid;
    iso_solid_measures solid;
    size_t solid_changes;
} isosculpt_measuring;

/* Picks the place of the surface that is nearest to a point. Errors: those of iso_measure_place. */
iso_status isosculpt_measuring_pick(isosculpt_measuring *measuring, const iso_grid *grid, iso_vec3 point,
                                    iso_pool *pool, iso_error *error);
/* The distance between the two places, mm. */
double isosculpt_measuring_distance(const isosculpt_measuring *measuring);
/* "12.5 mm", or "beyond the grid" for a thickness that the grid ends. */
void isosculpt_length_text(double length, char *text, size_t size);

/* What --measure asks for. */
enum { ISOSCULPT_MEASURE_PLACES = 64 };
typedef struct isosculpt_measure_request {
    bool on;
    int count;
    iso_vec3 near[ISOSCULPT_MEASURE_PLACES];
} isosculpt_measure_request;

/* Reads X/Y/Z,X/Y/Z ... (mm); NULL: no places. ISO_ERR_USAGE. */
iso_status isosculpt_measure_parse(const char *text, isosculpt_measure_request *request, iso_error *error);

/* Of each place the distance to the one before is said, too. */
typedef struct isosculpt_measured {
    iso_solid_measures solid;
    int count;
    iso_measured_place place[ISOSCULPT_MEASURE_PLACES];
} isosculpt_measured;

iso_status isosculpt_measure(const isosculpt_measure_request *request, const iso_grid *grid, iso_pool *pool,
                             isosculpt_measured *measured, iso_error *error);
void isosculpt_put_measured(iso_json *json, const isosculpt_measured *measured);
/* Calls `tell` with a line for the solid, and one for each place. */
void isosculpt_tell_measured(const isosculpt_measured *measured, void (*tell)(const char *line));

ISO_C_END
#endif
