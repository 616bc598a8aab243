/* flat: whether what is drawn is flat. */
#ifndef ISO_APPS_ISORENDER_FLAT_H
#define ISO_APPS_ISORENDER_FLAT_H

#include "apps/isorender/isorender.h"

/* Whether the points, lines, glyphs and meshes of files are flat in any direction: at most `ratio` times as
 * thick as wide, by the standard deviations of a sample of their vertices. Sets *across to that direction
 * (unit, world). Not if a few points lie far from the others: with these they would seem flat. */
bool isorender_is_flat(const isorender_job *job, double ratio, iso_vec3 *across);

#endif
