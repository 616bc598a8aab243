/* volume_settings: deals the values of the options of --volume to the volumes they belong to, and parses
 * them. */
#include "apps/isorender/volume_settings.h"

#include <math.h>
#include <string.h>

#include "apps/isorender/object_settings.h"

bool isorender_parse_isovalue(const char *text, isorender_isovalue *isovalue) {
    const char *end = text;
    *isovalue = (isorender_isovalue){NAN, false};
    if (strcmp(text, "auto") == 0) return true;
    if (!iso_parse_real_prefix(text, &isovalue->value, &end)) return false;
    isovalue->sigma = strcmp(end, "sigma") == 0;
    return isovalue->sigma || !*end;
}

static iso_status set_isovalue(const char *value, isorender_volume_settings *volume, iso_error *error) {
    if (isorender_parse_isovalue(value ? value : "auto", &volume->isovalue)) return ISO_OK;
    return iso_fail(error, ISO_ERR_USAGE,
                    "--volume-isovalue: '%s' is neither a number, such as 3sigma, nor 'auto'", value);
}

static iso_status set_component(const char *value, isorender_volume_settings *volume, iso_error *error) {
    if (!value || (iso_parse_int(value, &volume->component) && volume->component >= 0)) return ISO_OK;
    return iso_fail(error, ISO_ERR_USAGE, "--volume-component: '%s' is not a whole number from 0", value);
}

iso_status isorender_volumes_resolve(const isorender_volume_options *options,
                                     isorender_volume_settings *volumes, iso_error *error) {
    const struct {
        const char *name;
        const iso_texts *texts;
    } repeated[] = {{"volume-isovalue", &options->isovalues},
                    {"volume-color", &options->colors},
                    {"volume-opacity", &options->opacities},
                    {"volume-grid", &options->grids},
                    {"volume-component", &options->components}};
    for (int i = 0; i < options->count; i++) {
        isorender_volume_settings *volume = &volumes[i];
        *volume = (isorender_volume_settings){.path = options->paths[i], .opacity = 1};
        ISO_TRY(set_isovalue(isorender_value_for(&options->isovalues, i), volume, error));
        ISO_TRY(isorender_parse_color("volume-color", isorender_value_for(&options->colors, i), "",
                                      &volume->colored, &volume->color, error));
        ISO_TRY(isorender_parse_opacity("volume-opacity", isorender_value_for(&options->opacities, i),
                                        &volume->opacity, error));
        volume->grid = isorender_value_for(&options->grids, i);
        ISO_TRY(set_component(isorender_value_for(&options->components, i), volume, error));
    }
    for (size_t i = 0; i < sizeof repeated / sizeof *repeated; i++)
        ISO_TRY(
            isorender_check_count(repeated[i].name, repeated[i].texts, "--volume", options->count, error));
    return ISO_OK;
}
