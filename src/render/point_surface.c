/* point_surface: hands points to the reconstruction that was asked for. */
#include "render/point_surface.h"

#include <assert.h>

#include "render/discs/discs.h"

struct iso_point_workspace {
    iso_point_blocks blocks; /* of discs */
    iso_discs discs;
    iso_pullpush *pullpush;
};

iso_status iso_point_workspace_create(iso_point_workspace **workspace, iso_error *error) {
    iso_point_workspace *made = iso_alloc_zero(1, sizeof *made);
    if (!made) return iso_fail(error, ISO_ERR_NOMEM, "out of memory for drawing points");
    const iso_status status = iso_pullpush_create(&made->pullpush, error);
    if (status == ISO_OK)
        *workspace = made;
    else
        iso_free(made);
    return status;
}

static void free_discs(iso_point_workspace *workspace) {
    iso_point_blocks_free(&workspace->blocks);
    iso_discs_free(&workspace->discs);
}

void iso_point_workspace_destroy(iso_point_workspace *workspace) {
    if (!workspace) return;
    free_discs(workspace);
    iso_pullpush_destroy(workspace->pullpush);
    iso_free(workspace);
}

iso_pullpush *iso_point_workspace_pullpush(iso_point_workspace *workspace) {
    return workspace ? workspace->pullpush : NULL;
}

iso_selection_counts iso_point_workspace_counts(const iso_point_workspace *workspace) {
    return workspace->discs.counts;
}

static iso_flat_disc_style flat_style(iso_reconstruction reconstruction) {
    return reconstruction == ISO_RECONSTRUCTION_ONEPASS ? ISO_FLAT_DISCS_ONEPASS
           : reconstruction == ISO_RECONSTRUCTION_EWA   ? ISO_FLAT_DISCS_EWA
           : reconstruction == ISO_RECONSTRUCTION_MEAN  ? ISO_FLAT_DISCS_MEAN
           : reconstruction == ISO_RECONSTRUCTION_FLAT  ? ISO_FLAT_DISCS_FILTERED
                                                        : ISO_FLAT_DISCS_PLAIN;
}

static iso_status draw_discs(const iso_target *target, const iso_point_view *points,
                             const iso_point_surface_opts *opts, iso_point_workspace *workspace,
                             iso_error *error) {
    iso_point_view drawn = *points;
    if (opts->reconstruction != ISO_RECONSTRUCTION_CURVED) drawn.curvatures = NULL;
    if (opts->color) drawn.colors = NULL;
    const iso_projector projector = iso_projector_make(target->view, &drawn.transform);
    ISO_TRY(iso_point_blocks_make(&workspace->blocks, &drawn, &projector, target->pool, error));
    if (workspace->blocks.seen == 0) return ISO_OK;
    if (drawn.colors || opts->color) ISO_TRY(iso_gbuffer_add_color(target->gbuffer, error));
    const iso_discs_opts discs = {flat_style(opts->reconstruction), opts->selection == ISO_SELECTION_ALL,
                                  opts->color};
    return iso_discs_draw(&workspace->discs, target, &drawn, &workspace->blocks, &discs, error);
}

iso_status iso_draw_point_surface(const iso_target *target, const iso_point_view *points,
                                  const iso_point_surface_opts *opts, iso_error *error) {
    assert(target->view->width == target->gbuffer->width && target->view->height == target->gbuffer->height);
    const iso_reconstruction how = opts->reconstruction;
    if (how == ISO_RECONSTRUCTION_BOX || how == ISO_RECONSTRUCTION_GAUSSIAN)
        return iso_draw_pullpush(
            target, points, &(iso_pullpush_opts){how, iso_point_workspace_pullpush(opts->workspace)}, error);
    iso_point_workspace once = {0};
    const iso_status status =
        draw_discs(target, points, opts, opts->workspace ? opts->workspace : &once, error);
    free_discs(&once);
    return status;
}
