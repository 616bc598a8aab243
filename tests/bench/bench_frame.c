#include "bench_frame.h"

#include <stdlib.h>

#include "render/point_surface.h"
#include "render/shading/shading.h"

static const iso_rgb COLOR = {0xD9, 0xB3, 0x6C};
static const iso_shading SHADING = {.colors = &COLOR, .color_count = 1};

/* ---- the methods ---- */

static iso_status open_points(bench_frame *frame, iso_error *error) {
    ISO_TRY(bench_subject_points(frame->subject, &frame->points, error));
    frame->primitives = iso_point_view_count(&frame->points);
    return ISO_OK;
}

static iso_status draw_points(bench_frame *frame, const iso_target *target, iso_error *error) {
    return iso_draw_points(target, &frame->points, error);
}

static iso_status open_mesh(bench_frame *frame, iso_error *error) {
    ISO_TRY(bench_subject_mesh(frame->subject, &frame->mesh, error));
    frame->primitives = iso_mesh_view_triangle_count(&frame->mesh);
    return ISO_OK;
}

static iso_status draw_mesh(bench_frame *frame, const iso_target *target, iso_error *error) {
    return iso_draw_mesh(target, &frame->mesh, error);
}

static iso_status open_raycast(bench_frame *frame, iso_error *error) {
    return bench_subject_caster(frame->subject, &frame->caster, error);
}

static iso_status draw_raycast(bench_frame *frame, const iso_target *target, iso_error *error) {
    return iso_draw_raycast(target, frame->caster, error);
}

static iso_status open_pullpush(bench_frame *frame, iso_error *error) {
    ISO_TRY(open_points(frame, error));
    return iso_point_workspace_create(&frame->workspace, error);
}

static iso_status draw_gaussian(bench_frame *frame, const iso_target *target, iso_error *error) {
    const iso_point_surface_opts opts = {.reconstruction = ISO_RECONSTRUCTION_GAUSSIAN,
                                         .workspace = frame->workspace};
    return iso_draw_point_surface(target, &frame->points, &opts, error);
}

static iso_status draw_discs(bench_frame *frame, const iso_target *target, iso_error *error) {
    const iso_point_surface_opts opts = {.reconstruction = ISO_RECONSTRUCTION_CURVED,
                                         .workspace = frame->workspace};
    return iso_draw_point_surface(target, &frame->points, &opts, error);
}

/* Points without their curvatures, as files have them. */
static iso_status draw_flat(bench_frame *frame, const iso_target *target, iso_error *error) {
    const iso_point_surface_opts opts = {.reconstruction = ISO_RECONSTRUCTION_FLAT,
                                         .workspace = frame->workspace};
    return iso_draw_point_surface(target, &frame->points, &opts, error);
}

/* Points with colours of their own. */
static iso_status open_colored(bench_frame *frame, iso_error *error) {
    ISO_TRY(open_pullpush(frame, error));
    frame->colors = calloc(frame->primitives, sizeof *frame->colors);
    if (!frame->colors) return iso_fail(error, ISO_ERR_NOMEM, "out of memory");
    for (size_t i = 0; i < frame->primitives; i++)
        for (size_t k = 0; k < 3; k++) frame->colors[i][k] = (uint8_t)(i * (k + 1) / 64);
    frame->points.colors = (const uint8_t(*)[3])frame->colors;
    return ISO_OK;
}

static void close_pullpush(bench_frame *frame) {
    iso_point_workspace_destroy(frame->workspace);
    free(frame->colors);
}

/* Levels of detail with the program's default. */
static iso_status open_lod(bench_frame *frame, iso_error *error) {
    ISO_TRY(open_pullpush(frame, error));
    return iso_lod_update(&frame->lod, &frame->points, frame->pool, error);
}

static iso_status draw_lod(bench_frame *frame, const iso_target *target, iso_error *error) {
    const iso_point_surface_opts opts = {.reconstruction = ISO_RECONSTRUCTION_CURVED,
                                         .workspace = frame->workspace};
    ISO_TRY(iso_lod_cut_make(&frame->cut, &frame->lod, target->view, 1, target->pool, error));
    for (int k = 0; k < frame->cut.levels; k++)
        ISO_TRY(iso_draw_point_surface(target, &frame->cut.view[k], &opts, error));
    return ISO_OK;
}

static void finish_lod(bench_row *row) {
    const bench_frame *frame = row->context;
    size_t points = 0;
    for (int k = 0; k < frame->cut.levels; k++) points += frame->cut.points[k];
    const double bytes =
        (double)(frame->primitives * sizeof(iso_point) + frame->points.span_count * sizeof(iso_point_span));
    bench_count(row, "drawn_percent", 100 * (double)points / (double)frame->primitives, 0, 0);
    bench_count(row, "memory_percent", 100 * (double)iso_lod_bytes(&frame->lod) / bytes, 0,
                row->bench->settings->small ? 0 : 35);
}

static void close_lod(bench_frame *frame) {
    iso_lod_free(&frame->lod);
    iso_lod_cut_free(&frame->cut);
    close_pullpush(frame);
}

static iso_status open_exact(bench_frame *frame, iso_error *error) {
    ISO_TRY(bench_subject_exact(frame->subject, &frame->exact, error));
    frame->primitives = iso_exact_stats(frame->exact).cells;
    return ISO_OK;
}

static iso_status paint_exact(bench_frame *frame, size_t *covered, iso_error *error) {
    const iso_exact_picture canvas = {&frame->view.view, &SHADING, &frame->subject->image,
                                      frame->pool,       NULL,     1};
    return iso_paint_exact(&canvas, frame->exact, covered, error);
}

static iso_status paint_layers(bench_frame *frame, bool constant, size_t *covered, iso_error *error) {
    const iso_gbuffer size = {.width = frame->view.view.width, .height = frame->view.view.height};
    const iso_strip strip = {.view = &frame->view.view, .gbuffer = &size, .factor = 1};
    const iso_exact_layer layer = {
        frame->exact, COLOR, {.opacity = (float)BENCH_OPACITY, .constant = constant}, NULL, NULL};
    const iso_exact_layers picture = {
        .layers = &layer,
        .count = 1,
        .picture = {
            .strip = &strip, .shading = &SHADING, .image = &frame->subject->image, .pool = frame->pool}};
    frame->totals = (iso_exact_layers_totals){.retraced = 0};
    ISO_TRY(iso_shade_exact_layers(&picture, &frame->totals, error));
    *covered = frame->totals.layers.covered;
    return ISO_OK;
}

static iso_status paint_constant(bench_frame *frame, size_t *covered, iso_error *error) {
    return paint_layers(frame, true, covered, error);
}

static iso_status paint_by_angle(bench_frame *frame, size_t *covered, iso_error *error) {
    return paint_layers(frame, false, covered, error);
}

static void finish_layers(bench_row *row) {
    const bench_frame *frame = row->context;
    const iso_layer_totals *layers = &frame->totals.layers;
    bench_count(row, "mean_layers", (double)layers->layers / (double)layers->covered, 0, 0);
    bench_count(row, "retraced_percent", 100 * (double)frame->totals.retraced / (double)layers->covered, 0,
                0);
}

const bench_method bench_methods[] = {
    {.name = "points",
     .kernels = true,
     .on_bumpy = true,
     .on_volumes = true,
     .open = open_points,
     .draw = draw_points},
    {.name = "mesh", .on_bumpy = true, .on_volumes = true, .open = open_mesh, .draw = draw_mesh},
    {.name = "raycast", .slow = true, .on_volumes = true, .open = open_raycast, .draw = draw_raycast},
    {.name = "pullpush",
     .kernels = true,
     .on_bumpy = true,
     .on_volumes = true,
     .open = open_pullpush,
     .draw = draw_gaussian,
     .close = close_pullpush},
    {.name = "discs",
     .kernels = true,
     .on_bumpy = true,
     .on_volumes = true,
     .open = open_pullpush,
     .draw = draw_discs,
     .close = close_pullpush},
    {.name = "discs/lod",
     .on_bumpy = true,
     .open = open_lod,
     .draw = draw_lod,
     .finish = finish_lod,
     .close = close_lod},
    {.name = "splats/flat",
     .kernels = true,
     .on_bumpy = true,
     .open = open_pullpush,
     .draw = draw_flat,
     .close = close_pullpush},
    {.name = "splats/colors",
     .kernels = true,
     .on_bumpy = true,
     .open = open_colored,
     .draw = draw_flat,
     .close = close_pullpush},
    {.name = "exact", .kernels = true, .on_volumes = true, .open = open_exact, .paint = paint_exact},
    {.name = "layers/constant",
     .kernels = true,
     .on_volumes = true,
     .open = open_exact,
     .paint = paint_constant,
     .finish = finish_layers},
    {.name = "layers/angle",
     .kernels = true,
     .on_volumes = true,
     .open = open_exact,
     .paint = paint_by_angle,
     .finish = finish_layers},
};
const int bench_method_count = sizeof bench_methods / sizeof *bench_methods;

/* ---- the row ---- */

static iso_status open_frame(bench_row *row, iso_error *error) {
    const bench_frame_plan *plan = row->plan;
    bench_frame *frame = calloc(1, sizeof *frame);
    if (!frame) return iso_fail(error, ISO_ERR_NOMEM, "out of memory");
    row->context = frame;
    frame->method = plan->method;
    frame->subject = plan->subject;
    frame->gl = plan->gl;
    frame->pool = bench_pool(row->bench, row->threads);
    ISO_TRY(bench_subject_view(plan->subject, plan->view, &frame->view, error));
    ISO_TRY(bench_subject_frame(plan->subject, error));
    return frame->method->open(frame, error);
}

static iso_status draw_frame(bench_frame *frame, iso_error *error) {
    iso_gbuffer *gbuffer = &frame->subject->gbuffer;
    const iso_target target = {.view = &frame->view.view, .gbuffer = gbuffer, .pool = frame->pool};
    iso_gbuffer_clear_bands(gbuffer, frame->pool);
    ISO_TRY(frame->method->draw(frame, &target, error));
    const iso_strip strip = {.view = &frame->view.view, .gbuffer = gbuffer, .factor = 1};
    iso_shade(&SHADING, &strip, &frame->subject->image, frame->pool);
    return ISO_OK;
}

static iso_status run_frame(bench_row *row, bench_sample *sample, iso_error *error) {
    bench_frame *frame = row->context;
    const bench_method *method = frame->method;
    bench_clock clock = bench_clock_start();
    ISO_TRY(method->paint ? method->paint(frame, &frame->covered, error) : draw_frame(frame, error));
    bench_clock_stop(&clock, sample);
    sample->primitives = frame->primitives;
    if (!frame->covered) frame->covered = bench_covered(&frame->subject->gbuffer);
    return ISO_OK;
}

static void finish_frame(bench_row *row) {
    const bench_frame *frame = row->context;
    double seconds = bench_row_median(row) * 1e-3;
    bench_count(row, "covered_pixels", (double)frame->covered, 0, 0);
    if (frame->primitives) bench_count(row, "items_per_second", (double)frame->primitives / seconds, 0, 0);
    if (frame->method->finish) frame->method->finish(row);
}

static void close_frame(bench_row *row) {
    bench_frame *frame = row->context;
    if (frame && frame->method->close) frame->method->close(frame);
    free(frame);
}

const bench_kind bench_frame_kind = {
    .open = open_frame, .run = run_frame, .finish = finish_frame, .close = close_frame};
const bench_kind bench_slow_frame_kind = {
    .open = open_frame, .run = run_frame, .finish = finish_frame, .close = close_frame, .rounds = 3};
