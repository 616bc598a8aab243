/* The solid: small parts dropped (--largest, --min-size), closed at the volume's border (--closed); and the
 * measures of its mesh. */
#include <inttypes.h>

#include "apps/common/json_parts.h"
#include "apps/isorender/isorender.h"

static bool drops_parts(const isorender_settings *settings) {
    return iso_input_drops_parts(&settings->common.input);
}

static bool makes_copies(const isorender_job *job, int surfaces) {
    return drops_parts(job->settings) && surfaces > 1;
}

uint64_t isorender_solid_bytes(const isorender_job *job, const int dims[3], uint64_t grid_bytes) {
    const isorender_settings *settings = job->settings;
    const int surfaces = settings->isovalue_count ? settings->isovalue_count : 1;
    double bytes = 0;
    if (makes_copies(job, surfaces)) bytes += (double)grid_bytes * surfaces;
    if (settings->closed)
        bytes += surfaces * (job->loader.volume.info.sparse ? (double)grid_bytes
                                                            : (double)iso_grid_close_estimate(dims));
    return bytes < 0x1p63 ? (uint64_t)bytes : UINT64_MAX;
}

/* Foot points rely on every value of a dense level set being a distance. Where parts were dropped, values are
 * no longer distances: ISO_ERR_USAGE. */
static iso_status check_primitive(const isorender_job *job, iso_error *error) {
    const iso_grid *grid = &job->loader.volume.grid;
    if (job->settings->primitive == ISO_PRIMITIVE_FOOT && grid->rgrid && drops_parts(job->settings))
        return iso_fail(error, ISO_ERR_USAGE,
                        "--largest and --min-size of a dense level set cannot have --primitive foot");
    return ISO_OK;
}

static void log_parts(const isorender_job *job, const isorender_surface *surface, double isovalue) {
    const iso_components_totals *parts = &surface->parts;
    isorender_log(job,
                  "isovalue %g: kept %zu of %zu parts of the solid, dropped %zu with %.3g %% of its volume "
                  "(%.6g of %.6g mm3, counted in voxels)",
                  isovalue, parts->kept, parts->kept + parts->dropped, parts->dropped,
                  100 * parts->dropped_share, parts->dropped_volume,
                  parts->kept_volume + parts->dropped_volume);
}

iso_status isorender_solid_prepare(isorender_job *job, isorender_surface *surface, iso_error *error) {
    if (surface->label_group) return ISO_OK;
    surface->scene.grid = surface->loader->volume.grid;
    if (surface->loader != &job->loader) return ISO_OK; /* --largest and --closed are for the input only */
    ISO_TRY(check_primitive(job, error));
    const isorender_settings *settings = job->settings;
    const iso_hollow_opts hollow = {.drain = settings->drain, .up = settings->up};
    const iso_solid_opts opts = {.largest = (size_t)settings->common.input.largest,
                                 .min_volume = settings->common.input.min_size,
                                 .copied = makes_copies(job, job->surface_count),
                                 .closed = settings->closed != 0,
                                 .hollow = settings->hollow,
                                 .how = &hollow,
                                 .pool = job->pool};
    const double isovalue = surface->scene.isovalue;
    iso_grid *own = &surface->own_grid;
    ISO_TRY(
        iso_solid_make(&surface->scene.grid, &opts, &surface->scene.isovalue, own, &surface->parts, error));
    if (surface->parts.kept) log_parts(job, surface, isovalue);
    if (own->rgrid || own->hgrid) surface->scene.grid = *own;
    return ISO_OK;
}

static void log_mesh(const isorender_job *job, const isorender_surface *surface) {
    const iso_mesh_measures *m = &surface->measures;
    isorender_log_verbose(
        job,
        "isovalue %g: mesh of %zu connected pieces, %.6g mm2, %.6g mm3 enclosed, %zu open edges, "
        "Euler number %" PRId64,
        surface->scene.isovalue, m->pieces, m->area, m->volume, m->open_edges, m->euler);
}

iso_status isorender_mesh_weld(const isorender_job *job, isorender_surface *surface,
                               const iso_coloring *coloring, iso_weld *weld, iso_error *error) {
    const isorender_settings *settings = job->settings;
    const bool said = job->plan->mesh && !settings->common.quiet;
    const bool measured = settings->common.json || settings->verbose || said;
    const iso_mesh_view view = iso_mesh_set_view(surface->scene.mesh);
    const iso_solid_mesh_opts opts = {.closed = settings->closed != 0,
                                      .edits = &settings->mesh_edits,
                                      .coloring = coloring,
                                      .measures = measured ? &surface->measures : NULL,
                                      .pool = job->pool};
    ISO_TRY(iso_solid_weld(&view, &opts, weld, error));
    if (measured) log_mesh(job, surface);
    return ISO_OK;
}

/* ---- the report */

static void put_surface(iso_json *json, const isorender_job *job, const isorender_surface *surface) {
    if (drops_parts(job->settings)) iso_put_components(json, "solid_parts", &surface->parts);
    if (surface->scene.mesh) iso_put_mesh_measures(json, "mesh", &surface->measures);
}

void isorender_report_solid(iso_json *json, const isorender_job *job) {
    put_surface(json, job, &job->surfaces[0]);
    if (job->input_surface_count < 2 || (!drops_parts(job->settings) && !job->surfaces[0].scene.mesh)) return;
    iso_json_begin_array(json, "surfaces");
    for (int i = 0; i < job->input_surface_count; i++) {
        iso_json_begin_object(json, NULL);
        iso_json_real(json, "isovalue", job->surfaces[i].scene.isovalue);
        put_surface(json, job, &job->surfaces[i]);
        iso_json_end_object(json);
    }
    iso_json_end_array(json);
}
