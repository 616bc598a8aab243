/* colorings: --surface-color-by: reads what surfaces are coloured by, and sets how each is coloured. */
#ifndef ISO_APPS_ISORENDER_COLORINGS_H
#define ISO_APPS_ISORENDER_COLORINGS_H

#include "apps/isorender/isorender.h"

/* The function of the option --surface-color-by. */
iso_status isorender_apply_surface_color_by(void *target, const char *value, iso_error *error);
/* Deals --colormap and --range to the colorings, and checks that what is drawn can be coloured.
 * ISO_ERR_USAGE. */
iso_status isorender_colorings_check(isorender_settings *settings, iso_error *error);

/* Opens the volumes (their headers), and reads them, meshes and tables of colours. Messages begin with the
 * name of the file. Errors of iso_loader_open and iso_loader_read, iso_mesh_read, iso_color_table_read. */
iso_status isorender_colorings_open(isorender_job *job, iso_error *error);
iso_status isorender_colorings_read(isorender_job *job, iso_error *error);

/* Sets the coloring of each surface that has one, by data or by the paint of its file, when they are
 * extracted; their ranges too, but for that of depth. ISO_ERR_USAGE: a number that no surface has, one that
 * cannot be coloured or is coloured twice; ISO_ERR_NOMEM. */
iso_status isorender_colorings_make(isorender_job *job, iso_error *error);
/* Sets the ranges of depth, of the first camera. ISO_ERR_NOMEM. */
iso_status isorender_colorings_see(isorender_job *job, iso_error *error);

/* How the points or the mesh of a surface are coloured in a file; NULL: they have no colours. Says so if
 * these are of a picture. option: that asked for the file, "--mesh". */
const iso_coloring *isorender_colorings_exported(const isorender_job *job, const isorender_surface *surface,
                                                 const char *option);

/* The colour bars; returns their number. */
int isorender_colorings_bars(const isorender_job *job, iso_color_bar bars[ISORENDER_COLORINGS]);
/* Adds a member about the colorings to the report of --json. */
void isorender_colorings_report(iso_json *json, const isorender_job *job);
void isorender_colorings_free(isorender_job *job);

#endif
