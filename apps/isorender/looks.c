/* looks: values of options by the look's name. */
#include "apps/isorender/looks.h"

#include <string.h>

const char *const isorender_look_names[] = {"none", "paper", "studio", "xray", "clay", NULL};

typedef struct look_value {
    const char *look, *option, *value; /* value: NULL: none */
} look_value;

static const look_value values[] = {
    /* figures on white paper, also in greyscale */
    {"paper", "color", "EDE6D6"},
    {"paper", "background", "FFFFFF"},
    {"paper", "occlusion", NULL},
    {"paper", "outline", "1"},
    {"paper", "samples", "9"},
    /* a talk's dark slides */
    {"studio", "color", "E8E4DC"},
    {"studio", "background", "20242B"},
    {"studio", "occlusion", NULL},
    {"studio", "shadow", NULL},
    {"studio", "samples", "9"},
    /* everything is seen through */
    {"xray", "color", "DCEBFF"},
    {"xray", "background", "05080C"},
    {"xray", "opacity", "0.2"},
    {"xray", "samples", "4"},
    /* a model of clay on a light table */
    {"clay", "color", "C58A66"},
    {"clay", "background", "F3EEE6"},
    {"clay", "occlusion", NULL},
    {"clay", "shadow", NULL},
    {"clay", "samples", "9"},
};

static bool is_given(const isorender_settings *settings, const iso_program *program, const char *name) {
    const iso_option *option = iso_options_find(program, name, strlen(name));
    return option && settings->given[option - program->options] != 0;
}

iso_status isorender_look_apply(isorender_settings *settings, iso_error *error) {
    const iso_program *program = isorender_program();
    for (size_t i = 0; i < sizeof values / sizeof *values; i++) {
        const look_value *v = &values[i];
        const iso_option *option = iso_options_find(program, v->option, strlen(v->option));
        const bool cleared =
            strcmp(v->option, "background") == 0 && is_given(settings, program, "no-background");
        if (strcmp(v->look, isorender_look_names[settings->look]) != 0 || cleared ||
            is_given(settings, program, v->option))
            continue;
        ISO_TRY(iso_option_store(option, v->value, settings, error));
        program->seen(settings, option, v->value);
    }
    return ISO_OK;
}
