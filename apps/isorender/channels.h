/* channels: several channels of one file as surfaces in one picture (--channel). The first one is the
 * component of the input, the others are further volumes (volumes.c) that are read from the same file. */
#ifndef ISO_APPS_ISORENDER_CHANNELS_H
#define ISO_APPS_ISORENDER_CHANNELS_H

#include "apps/isorender/isorender.h"

/* Parses the value of --channel, "0,2,GFP". ISO_ERR_USAGE. */
iso_status isorender_apply_channel(void *settings, const char *value, iso_error *error);

/* Makes all channels but the first one further volumes, and gives them their isovalues, colours and
 * opacities, of which the settings keep only those of the first one; to be called before the --volume are
 * resolved. ISO_ERR_USAGE: there are more values than channels, --component is given as well, or an isovalue
 * of several of one channel is auto. */
iso_status isorender_channels_take(isorender_settings *settings, iso_error *error);
/* Checks that the inputs and the outputs go together with --channel. ISO_ERR_USAGE. */
iso_status isorender_channels_check(const isorender_settings *settings, iso_error *error);
/* Checks, after iso_loader_open, that a further volume is not a channel that the input or a volume before it
 * is. ISO_ERR_USAGE. */
iso_status isorender_channel_check(const isorender_job *job, int volume, iso_error *error);

/* "channel 1 (GFP)", or "channel 1" if the file does not name it; "" if it is not chosen by --channel. */
enum { ISORENDER_CHANNEL_TITLE = ISO_CHANNEL_NAME + 32 };
const char *isorender_channel_title(const iso_loader *loader, char title[ISORENDER_CHANNEL_TITLE]);

/* The colour that the file states for the channel of a surface, after those of the surfaces before it were
 * chosen. False: it states none; or white or black, which programs write that know no colour; or the colour
 * of a surface before it; or there is no --channel. */
bool isorender_channel_color(const isorender_job *job, int surface, iso_rgb *color);

/* Prints the channels that the file states, for --info. */
void isorender_channels_info(const iso_loader *loader);
/* Adds to the report of --json the name of the channel that is drawn, if the file states it. */
void isorender_report_channel(iso_json *json, const iso_loader *loader);
/* The same of all channels of the file. */
void isorender_report_channels(iso_json *json, const iso_loader *loader);

#endif
