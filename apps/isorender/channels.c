#include "apps/isorender/channels.h"

#include <math.h>
#include <string.h>

/* ---- options */

static iso_status add_channel(void *target, const char *value, iso_error *error) {
    isorender_settings *settings = target;
    if (!*value) return iso_fail(error, ISO_ERR_USAGE, "between its commas are numbers or names of channels");
    if (settings->channel_count == ISORENDER_VOLUMES + 1)
        return iso_fail(error, ISO_ERR_USAGE, "more than %d channels", ISORENDER_VOLUMES + 1);
    snprintf(settings->channels[settings->channel_count++], ISO_CHANNEL_NAME, "%s", value);
    return ISO_OK;
}

iso_status isorender_apply_channel(void *settings, const char *value, iso_error *error) {
    return iso_parse_items(value, add_channel, settings, error);
}

static bool is_given(const isorender_settings *settings, const char *name) {
    const iso_program *program = isorender_program();
    return settings->given[iso_options_find(program, name, strlen(name)) - program->options] != 0;
}

static iso_status check_value_count(const char *what, int values, int channels, iso_error *error) {
    if (values <= channels) return ISO_OK;
    return iso_fail(error, ISO_ERR_USAGE, "%d %s for %d channels", values, what, channels);
}

/* The value of a list for the i-th channel: the last one repeats. */
static double value_for(const double *values, int count, int i, double standard) {
    return count ? values[i < count ? i : count - 1] : standard;
}

static isorender_isovalue isovalue_for(const isorender_settings *settings, int i) {
    const int count = settings->isovalue_count, at = i < count ? i : count - 1;
    return count ? (isorender_isovalue){settings->isovalues[at], settings->isovalue_sigmas[at]}
                 : (isorender_isovalue){NAN, false};
}

static void make_volume(isorender_settings *settings, int i) {
    settings->volumes[settings->volume_count++] =
        (isorender_volume_settings){.channel = settings->channels[i],
                                    .isovalue = isovalue_for(settings, i),
                                    .colored = i < settings->color_count,
                                    .color = settings->colors[i],
                                    .opacity = value_for(settings->opacities, settings->opacity_count, i, 1)};
}

static int at_most_one(int count) {
    return count > 1 ? 1 : count;
}

/* Several surfaces of one volume have isovalues that are all given. */
static iso_status check_isovalues(const isorender_settings *settings, iso_error *error) {
    for (int i = 0; i < settings->isovalue_count; i++)
        if (isnan(settings->isovalues[i]))
            return iso_fail(error, ISO_ERR_USAGE,
                            "--isovalue: auto stands alone, or is that of one of several --channel");
    return ISO_OK;
}

iso_status isorender_channels_take(isorender_settings *settings, iso_error *error) {
    const int count = settings->channel_count;
    if (count < 2) ISO_TRY(check_isovalues(settings, error));
    if (!count) return ISO_OK;
    if (is_given(settings, "component"))
        return iso_fail(error, ISO_ERR_USAGE, "--channel and --component both say what is read: give one");
    settings->common.input.channel = settings->channels[0];
    if (count == 1) return ISO_OK;
    if (count - 1 + settings->volume_options.count > ISORENDER_VOLUMES)
        return iso_fail(error, ISO_ERR_USAGE, "more than %d channels and volumes", ISORENDER_VOLUMES + 1);
    ISO_TRY(check_value_count("isovalues", settings->isovalue_count, count, error));
    ISO_TRY(check_value_count("colours", settings->color_count, count, error));
    ISO_TRY(check_value_count("opacities", settings->opacity_count, count, error));
    for (int i = 1; i < count; i++) make_volume(settings, i);
    settings->isovalue_count = isnan(settings->isovalues[0]) ? 0 : at_most_one(settings->isovalue_count);
    settings->color_count = at_most_one(settings->color_count);
    settings->opacity_count = at_most_one(settings->opacity_count);
    return ISO_OK;
}

/* An option that is for one surface, or for the input alone; NULL: none is given. */
static const char *option_of_one_channel(const isorender_settings *settings) {
    return settings->points                      ? "--points"
           : settings->mesh                      ? "--mesh"
           : settings->closed                    ? "--closed"
           : settings->common.input.largest      ? "--largest"
           : settings->common.input.min_size > 0 ? "--min-size"
                                                 : NULL;
}

iso_status isorender_channels_check(const isorender_settings *settings, iso_error *error) {
    const char *option = option_of_one_channel(settings);
    if (!settings->channel_count) return ISO_OK;
    if (settings->no_input || settings->object_options.has_cloud)
        return iso_fail(error, ISO_ERR_USAGE, "--channel is for an input that is a volume");
    if (settings->channel_count == 1) return ISO_OK;
    if (settings->input_count > 1)
        return iso_fail(error, ISO_ERR_USAGE, "several channels are drawn of one input: there are %d",
                        settings->input_count);
    if (!settings->scene && iso_spool_is_stream(settings->inputs[0]))
        return iso_fail(error, ISO_ERR_USAGE,
                        "%s: several channels are read one after another: from a file, not from a pipe",
                        iso_spool_name(settings->inputs[0]));
    if (!option) return ISO_OK;
    return iso_fail(error, ISO_ERR_USAGE, "%s is for one surface: give one --channel", option);
}

iso_status isorender_channel_check(const isorender_job *job, int volume, iso_error *error) {
    const iso_loader *loader = &job->volumes[volume], *input = &job->loader;
    char title[ISORENDER_CHANNEL_TITLE];
    bool repeated = input->component == loader->component;
    if (!loader->options->channel) return ISO_OK;
    for (int i = 0; i < volume; i++) repeated |= job->volumes[i].component == loader->component;
    if (!repeated) return ISO_OK;
    return iso_fail(error, ISO_ERR_USAGE, "%s: %s is given twice", iso_spool_name(loader->input),
                    isorender_channel_title(loader, title));
}

/* ---- names and colours */

static const iso_channel *channel_of(const iso_loader *loader) {
    return loader->options->channel ? iso_channel_of(&loader->channels, loader->component) : NULL;
}

const char *isorender_channel_title(const iso_loader *loader, char title[ISORENDER_CHANNEL_TITLE]) {
    const iso_channel *channel = channel_of(loader);
    const int number = loader->component;
    if (!loader->options->channel) return "";
    if (channel && channel->name[0])
        snprintf(title, ISORENDER_CHANNEL_TITLE, "channel %d (%s)", number, channel->name);
    else
        snprintf(title, ISORENDER_CHANNEL_TITLE, "channel %d", number);
    return title;
}

static bool are_equal(iso_rgb a, iso_rgb b) {
    return a.r == b.r && a.g == b.g && a.b == b.b;
}

bool isorender_channel_color(const isorender_job *job, int surface, iso_rgb *color) {
    const iso_channel *channel = channel_of(job->surfaces[surface].loader);
    const iso_rgb white = {255, 255, 255}, black = {0, 0, 0};
    if (!channel || !channel->colored) return false;
    if (are_equal(channel->color, white) || are_equal(channel->color, black)) return false;
    for (int i = 0; i < surface; i++)
        if (are_equal(job->surfaces[i].color, channel->color)) return false;
    *color = channel->color;
    return true;
}

/* ---- reports */

static int listed_count(const iso_loader *loader) {
    const int count = loader->channels.count;
    return count < ISO_CHANNELS ? count : ISO_CHANNELS;
}

static const char *hexadecimal(iso_rgb color, char text[8]) {
    snprintf(text, 8, "%02X%02X%02X", color.r, color.g, color.b);
    return text;
}

void isorender_channels_info(const iso_loader *loader) {
    const char *label = "channels";
    for (int i = 0; i < listed_count(loader); i++) {
        const iso_channel *channel = &loader->channels.items[i];
        char color[8];
        if (!channel->name[0] && !channel->colored) continue;
        printf("  %-11s %d", label, i);
        label = "";
        if (channel->name[0]) printf(" %s", channel->name);
        if (channel->colored) printf(", colour %s", hexadecimal(channel->color, color));
        printf("\n");
    }
}

void isorender_report_channel(iso_json *json, const iso_loader *loader) {
    const iso_channel *channel = channel_of(loader);
    if (channel && channel->name[0]) iso_json_string(json, "channel", channel->name);
}

void isorender_report_channels(iso_json *json, const iso_loader *loader) {
    if (!loader->channels.count) return;
    iso_json_begin_array(json, "channels");
    for (int i = 0; i < listed_count(loader); i++) {
        const iso_channel *channel = &loader->channels.items[i];
        char color[8];
        iso_json_begin_object(json, NULL);
        iso_json_string(json, "name", channel->name[0] ? channel->name : NULL);
        iso_json_string(json, "color", channel->colored ? hexadecimal(channel->color, color) : NULL);
        iso_json_end_object(json);
    }
    iso_json_end_array(json);
}
