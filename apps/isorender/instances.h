/* instances: the option --instances: the model is drawn in many places (instances.c). */
#ifndef ISO_APPS_ISORENDER_INSTANCES_H
#define ISO_APPS_ISORENDER_INSTANCES_H

#include "apps/common/json.h"
#include "scene/instances.h"
#include "scene/loader.h"

typedef struct isorender_job isorender_job; /* isorender.h */

/* Where the surfaces of the input stand, and what is kept from one picture to the next. Zero-initialise. */
typedef struct isorender_instances {
    iso_placements placements; /* owned; count 0: the option is not given */
    iso_read_report report;
    iso_placed placed;
} isorender_instances;

/* Checks that what is drawn can have instances, when the method is known. ISO_ERR_USAGE. */
iso_status isorender_instances_check(const isorender_job *job, iso_error *error);
/* Reads the file of --instances, if it is given. Errors as iso_placements_read_file. */
iso_status isorender_instances_read(isorender_job *job, uint64_t max_memory, iso_error *error);
void isorender_instances_free(isorender_job *job);

/* Whether a surface is drawn as instances: those of the input are. */
bool isorender_has_instances(const isorender_job *job, int surface);

/* Begins a frame: ISO_ERR_NOMEM. */
iso_status isorender_instances_begin(isorender_job *job, iso_error *error);

/* Prints the lines of --info about the instances; adds members about them to the report of --json, and of
 * what was drawn of them to that of a frame. */
void isorender_instances_info(const isorender_job *job);
void isorender_instances_report(iso_json *json, const isorender_job *job);
void isorender_instances_put(iso_json *json, const iso_instance_counts *counts);

#endif
