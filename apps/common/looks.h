/* looks: what --look stands for: values of options of light, colour and background. */
#ifndef ISO_APPS_COMMON_LOOKS_H
#define ISO_APPS_COMMON_LOOKS_H

#include <stddef.h>

#include "base/c_linkage.h"

ISO_C_BEGIN

/* Names of looks, NULL-terminated; the first is "none". */
extern const char *const iso_look_names[];

/* A value that a look gives an option of isorender. */
typedef struct iso_look_value {
    const char *look, *option, *value; /* value: NULL: none */
} iso_look_value;

/* The values of all looks; *count: how many. */
const iso_look_value *iso_look_values(size_t *count);

ISO_C_END
#endif
