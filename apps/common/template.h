/* template: makes names of outputs from names of inputs, with the variables of F3D.
 *
 * {model} is the input's name without folder and extension; {n} is a number, {n:3} a number with at least
 * three digits. The returned texts belong to the caller: free(). */
#ifndef ISO_APPS_COMMON_TEMPLATE_H
#define ISO_APPS_COMMON_TEMPLATE_H

#include <stdbool.h>

#include "base/status.h"

/* Computes {model}: "a/foo.nii.gz" gives "foo", a folder gives its own name, "scene:gyroid:64" gives
 * "gyroid", and "-" gives "stdin". */
iso_status iso_template_model(const char *input, char **model, iso_error *error);

/* Returns whether `text` contains the variable `name` ("model" or "n"). */
bool iso_template_has(const char *text, const char *name);

/* Replaces {model} by `model` and {n} by `number`; a variable stays unchanged if model is NULL or the number
 * is negative. ISO_ERR_USAGE: another variable, or a malformed one. */
iso_status iso_template_expand(const char *text, const char *model, int number, char **out, iso_error *error);

/* Returns `path` with {n:digits} inserted before its extension, unless it contains {n} already. */
iso_status iso_template_numbered(const char *path, int digits, char **out, iso_error *error);

#endif
