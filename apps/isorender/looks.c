/* looks: --look, applied. */
#include "apps/isorender/looks.h"

#include <string.h>

#include "apps/common/looks.h"

static bool is_given(const isorender_settings *settings, const iso_program *program, const char *name) {
    const iso_option *option = iso_options_find(program, name, strlen(name));
    return option && settings->given[option - program->options] != 0;
}

iso_status isorender_look_apply(isorender_settings *settings, iso_error *error) {
    const iso_program *program = isorender_program();
    size_t count;
    const iso_look_value *values = iso_look_values(&count);
    for (size_t i = 0; i < count; i++) {
        const iso_look_value *v = &values[i];
        const iso_option *option = iso_options_find(program, v->option, strlen(v->option));
        const bool cleared =
            strcmp(v->option, "background") == 0 && is_given(settings, program, "no-background");
        if (strcmp(v->look, iso_look_names[settings->look]) != 0 || cleared ||
            is_given(settings, program, v->option))
            continue;
        ISO_TRY(iso_option_store(option, v->value, settings, error));
        program->seen(settings, option, v->value);
    }
    return ISO_OK;
}
