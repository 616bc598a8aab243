/* series: --series-of: files, or the components of one, as steps in time: the inputs of one film, which share
 * isovalue, framing and ranges of colours. */
#ifndef ISO_APPS_ISORENDER_SERIES_H
#define ISO_APPS_ISORENDER_SERIES_H

#include "apps/isorender/isorender.h"

/* Makes the steps the inputs of the settings, in the order of the numbers in their names; of one file its
 * components that follow each other in time. isorender_series_free when done. ISO_ERR_IO: no file fits the
 * pattern; ISO_ERR_USAGE: one step only; errors of reading a header. */
iso_status isorender_series_take(isorender_settings *settings, iso_error *error);
void isorender_series_free(isorender_settings *settings);

/* The settings of step `step` from those of all: its component. */
void isorender_series_choose(isorender_settings *settings, int step);

/* Whether all steps have to be looked at before the first one is drawn, for what they share. */
bool isorender_series_is_measured(const isorender_settings *settings);
/* Adds what a step has to what all share: its box and its ranges. */
void isorender_series_measure(isorender_job *job);

#endif
