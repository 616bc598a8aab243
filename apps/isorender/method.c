/* The method, its reconstruction and the options of groups: what is usual if none is given, what the method
 * can draw, and refusals of what it cannot. */
#include "apps/isorender/isorender.h"

/* The option of groups that is given, NULL: none. */
static const char *given_option(const isorender_settings *settings) {
    return settings->groups               ? "--groups"
           : settings->group_overlap > 0  ? "--group-overlap"
           : settings->group_bins         ? "--group-bins"
           : settings->group_opposite     ? "--group-opposite"
           : settings->group_coplanar > 0 ? "--group-coplanar"
           : settings->group_radii        ? "--group-radii"
                                          : NULL;
}

/* --transparency, and options of translucent surfaces that splats do not have. */
static iso_status check_transparency(const isorender_settings *settings, iso_error *error) {
    const bool sorted = settings->transparency == (int)ISO_TRANSPARENCY_SORTED;
    char what[64];
    snprintf(what, sizeof what, "--transparency %s",
             settings->transparency == (int)ISO_TRANSPARENCY_GROUPS ? "groups" : "nearest");
    if (!sorted) ISO_TRY(isorender_method_require(settings, ISO_CAN_GROUPS, what, error));
    if (sorted && settings->group_radii)
        return iso_fail(error, ISO_ERR_USAGE, "--group-radii is for --transparency groups and nearest");
    if (!sorted && settings->layers)
        return iso_fail(error, ISO_ERR_USAGE, "--layers needs --transparency sorted");
    if (settings->absorption_length > 0)
        return isorender_method_require(settings, ISO_CAN_ABSORPTION, "--absorption", error);
    return ISO_OK;
}

static iso_status check_selection(const isorender_settings *settings, iso_error *error) {
    if (settings->selection == (int)ISO_SELECTION_AUTO) return ISO_OK;
    if (isorender_is_translucent(settings))
        return iso_fail(error, ISO_ERR_USAGE, "--selection is for opaque surfaces");
    return isorender_method_require(settings, ISO_CAN_SELECTION, "with --selection", error);
}

bool isorender_has_reconstructions(int method) {
    return method == ISO_METHOD_PULLPUSH || method == ISO_METHOD_DISCS || method == ISO_METHOD_SPLATS;
}

static int usual_reconstruction(const isorender_settings *settings) {
    if (settings->method == ISO_METHOD_PULLPUSH) return ISO_RECONSTRUCTION_GAUSSIAN;
    if (settings->method != ISO_METHOD_SPLATS) return ISO_RECONSTRUCTION_CURVED;
    const bool sorted = settings->transparency == (int)ISO_TRANSPARENCY_SORTED;
    return given_option(settings) || !sorted ? ISORENDER_RECONSTRUCTION_GROUPS : (int)ISO_RECONSTRUCTION_FLAT;
}

/* The renderer of the method that is chosen; NULL: none is, or it does not have the reconstruction. */
static const iso_renderer *renderer_of(const isorender_settings *settings) {
    if (settings->method == ISORENDER_METHOD_UNCHOSEN) return NULL;
    const bool has_several = isorender_has_reconstructions(settings->method);
    return iso_renderer_find((iso_method)settings->method,
                             has_several ? isorender_reconstruction_name(settings, false) : NULL);
}

bool isorender_method_can(const isorender_settings *settings, iso_capability capability) {
    const iso_renderer *renderer = renderer_of(settings);
    return settings->method == ISORENDER_METHOD_UNCHOSEN ||
           (renderer && renderer->can & (unsigned)capability);
}

iso_status isorender_method_require(const isorender_settings *settings, unsigned capabilities,
                                    const char *what, iso_error *error) {
    const iso_renderer *renderer = renderer_of(settings);
    return renderer ? iso_renderer_require(renderer, capabilities, "--method", what, error) : ISO_OK;
}

static iso_status check_reconstruction(const isorender_settings *settings, iso_error *error) {
    const int chosen = settings->reconstruction;
    const bool of_splats = chosen >= (int)ISO_RECONSTRUCTION_FLAT;
    const char *name = isorender_reconstruction_name(settings, false);
    char list[ISO_METHODS_TEXT];
    if (isorender_has_reconstructions(settings->method) && !renderer_of(settings))
        return iso_fail(error, ISO_ERR_USAGE, "--method %s has --reconstruction %s",
                        iso_method_name((iso_method)settings->method),
                        iso_method_reconstructions((iso_method)settings->method, list));
    if (!isorender_has_reconstructions(settings->method) && of_splats)
        return iso_fail(error, ISO_ERR_USAGE, "--reconstruction %s is for --method %s", name,
                        iso_methods_with_reconstruction(name, list));
    return ISO_OK;
}

iso_status isorender_method_check(isorender_settings *settings, iso_error *error) {
    if ((settings->transparency || settings->selection) && settings->method == ISORENDER_METHOD_UNCHOSEN)
        settings->method = ISO_METHOD_SPLATS;
    settings->old_discs =
        settings->method == ISO_METHOD_PULLPUSH && (settings->reconstruction == ISO_RECONSTRUCTION_CURVED ||
                                                    settings->reconstruction == ISO_RECONSTRUCTION_FLAT);
    if (settings->old_discs) settings->method = ISO_METHOD_DISCS;
    const char *option = given_option(settings);
    if (settings->reconstruction == ISORENDER_RECONSTRUCTION_UNCHOSEN)
        settings->reconstruction = usual_reconstruction(settings);
    ISO_TRY(check_reconstruction(settings, error));
    if (option && !(renderer_of(settings) && isorender_method_can(settings, ISO_CAN_GROUPS)))
        return iso_fail(error, ISO_ERR_USAGE, "%s is for --method %s", option,
                        iso_methods_that_can(ISO_CAN_GROUPS, (char[ISO_METHODS_TEXT]){0}));
    ISO_TRY(check_transparency(settings, error));
    return check_selection(settings, error);
}
