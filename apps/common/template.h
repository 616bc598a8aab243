/* template: names of outputs made from names of inputs, with the variables that F3D has.
 *
 * {model} is the input's name without folder and extension; {n} and {n:3} a number, the second with at least
 * three digits. Texts are owned by the caller: free(). */
#ifndef ISO_APPS_COMMON_TEMPLATE_H
#define ISO_APPS_COMMON_TEMPLATE_H

#include <stdbool.h>

#include "base/status.h"

#ifdef __cplusplus
extern "C" {
#endif

/* The input's name without folder and extension: "a/foo.nii.gz" gives "foo", a folder its own name,
 * "scene:gyroid:64" gives "gyroid", "-" gives "stdin". */
iso_status iso_template_model(const char *input, char **model, iso_error *error);

/* Whether `text` has the variable `name` ("model" or "n"). */
bool iso_template_has(const char *text, const char *name);

/* Replaces variables: {model} by `model`, {n} by `number`; either stays as it is when model is NULL or the
 * number negative. ISO_ERR_USAGE for another variable or a malformed one. */
iso_status iso_template_expand(const char *text, const char *model, int number, char **out, iso_error *error);

/* `path` with {n:digits} before its extension, unless it has {n} already. */
iso_status iso_template_numbered(const char *path, int digits, char **out, iso_error *error);

#ifdef __cplusplus
}
#endif
#endif
