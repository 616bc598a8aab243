/* looks: values of options by the look's name. */
#include "apps/common/looks.h"

const char *const iso_look_names[] = {"none", "paper", "studio", "xray", "clay", NULL};

static const iso_look_value values[] = {
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

const iso_look_value *iso_look_values(size_t *count) {
    *count = sizeof values / sizeof *values;
    return values;
}
