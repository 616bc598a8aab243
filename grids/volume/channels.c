/* channels: finds a channel of a file by its number or by the name that the file states. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "grids/volume/volume.h"

const iso_channel *iso_channel_of(const iso_channels *channels, int component) {
    if (!channels->count || component % channels->count >= ISO_CHANNELS) return NULL;
    return &channels->items[component % channels->count];
}

static int listed_count(const iso_channels *channels) {
    return channels->count < ISO_CHANNELS ? channels->count : ISO_CHANNELS;
}

static bool is_called(const iso_channel *channel, const char *name, bool exactly) {
    return (exactly ? strcmp : strcasecmp)(channel->name, name) == 0;
}

/* Returns how many channels have this name, and sets *first to the first of them. An empty name is none. */
static int count_called(const iso_channels *channels, const char *name, bool exactly, int *first) {
    int found = 0;
    for (int i = listed_count(channels) - 1; i >= 0 && *name; i--)
        if (is_called(&channels->items[i], name, exactly)) *first = i, found++;
    return found;
}

/* Writes "0 'DAPI', 1 'GFP'": the channels with this name in any case; NULL: all that have a name. */
static void list_names(const iso_channels *channels, const char *name, char *text, size_t room) {
    size_t used = 0;
    *text = 0;
    for (int i = 0; i < listed_count(channels) && used < room; i++) {
        const iso_channel *channel = &channels->items[i];
        if (!channel->name[0] || (name && !is_called(channel, name, false))) continue;
        used += (size_t)snprintf(text + used, room - used, "%s%d '%s'", used ? ", " : "", i, channel->name);
    }
}

/* Returns whether `text` is the number of a component, and sets *number. */
static bool is_number(const char *text, long *number) {
    char *end;
    *number = strtol(text, &end, 10);
    return *text >= '0' && *text <= '9' && !*end;
}

iso_status iso_channels_find(const iso_channels *channels, int components, const char *text, int *component,
                             iso_error *error) {
    char names[400];
    long number;
    const bool numbered = is_number(text, &number);
    if (numbered && number < components) {
        *component = (int)number;
        return ISO_OK;
    }
    int found = count_called(channels, text, true, component);
    if (!found) found = count_called(channels, text, false, component);
    if (found == 1) return ISO_OK;
    list_names(channels, found ? text : NULL, names, sizeof names);
    if (found)
        return iso_fail(error, ISO_ERR_USAGE, "%d channels are called '%.80s': choose by number: %s", found,
                        text, names);
    if (*names && !numbered)
        return iso_fail(error, ISO_ERR_USAGE, "no channel '%.80s', there %s %s", text,
                        components == 1 ? "is" : "are", names);
    return iso_fail(error, ISO_ERR_USAGE, "no channel %.80s, there %s %d (from 0)%s", text,
                    components == 1 ? "is" : "are", components, numbered ? "" : ", without names");
}
