/* Points in groups of discs that do not overlap (--reconstruction groups): divides and reports them. */
#include "apps/isorender/isorender.h"

bool isorender_uses_groups(const isorender_job *job) {
    return job->renderer->method == ISO_METHOD_SPLATS;
}

iso_status isorender_groups_make(isorender_job *job, int surface, iso_error *error) {
    iso_scene_surface *scene = &job->surfaces[surface].scene;
    ISO_TRY(iso_scene_surface_update(scene, ISO_PART_GROUPS, error));
    const iso_point_view points = iso_scene_surface_points(scene);
    const double count = (double)iso_point_view_count(&points);
    isorender_log_verbose(job, "%d groups: %.2f overlapping discs a disc, %.4f of them in its group",
                          scene->groups.count, 2 * (double)scene->groups.joined / count,
                          2 * (double)scene->groups.conflicts / count);
    return ISO_OK;
}

iso_grouping isorender_grouping(const isorender_settings *settings) {
    return (iso_grouping){.limit = settings->groups,
                          .overlap = settings->group_overlap,
                          .coplanar = settings->group_coplanar,
                          .ignore_opposite = settings->group_opposite != 0,
                          .once = true,
                          .radii = (iso_group_radii)settings->group_radii};
}

static void report_widening(iso_json *json, const iso_groups *groups) {
    double widening[ISO_GROUPS_MOST];
    for (int k = 0; k < groups->count; k++) widening[k] = (double)groups->widening[k];
    iso_json_reals(json, "radius_factors", widening, groups->count);
}

void isorender_report_groups(iso_json *json, const isorender_job *job) {
    if (!isorender_uses_groups(job)) return;
    iso_json_begin_array(json, "groups");
    for (int i = 0; i < job->surface_count; i++) {
        const iso_groups *groups = &job->surfaces[i].scene.groups;
        iso_json_begin_object(json, NULL);
        iso_json_integer(json, "count", (uint64_t)groups->count);
        iso_json_integer(json, "overlaps", groups->joined);
        iso_json_integer(json, "conflicts", groups->conflicts);
        if (groups->copies) iso_json_integer(json, "copies", groups->copy_count);
        if (groups->widening[0] > 0) report_widening(json, groups);
        iso_json_end_object(json);
    }
    iso_json_end_array(json);
}
