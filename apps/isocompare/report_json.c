/* report_json: the numbers of the report as JSON. */
#include <math.h>

#include "apps/common/json.h"
#include "apps/isocompare/report.h"
#include "base/cpu.h"

static void put_volume(iso_json *json, const report *r) {
    const iso_volume_info *info = &r->loader.volume.info;
    iso_json_begin_object(json, "volume");
    iso_json_string(json, "path", r->loader.input);
    iso_json_string(json, "format", info->format);
    iso_json_ints(json, "dims", info->dims, 3);
    iso_json_string(json, "type", iso_type_name(info->type));
    iso_json_reals(json, "spacing", info->transform.spacing, 3);
    iso_json_end_object(json);
    iso_json_real(json, "isovalue", r->surface.isovalue);
    iso_json_string(json, "isovalue_from", r->isovalue_from);
}

static void put_parts(iso_json *json, const report *r) {
    iso_json_begin_array(json, "extraction");
    for (int part = 0; part < ISO_PART_COUNT; part++) {
        const report_part *p = &r->parts[part];
        if (!p->made) continue;
        iso_json_begin_object(json, NULL);
        iso_json_string(json, "part", iso_part_name((iso_part)part));
        iso_json_real(json, "seconds", p->seconds);
        iso_json_integer(json, "primitives", p->size.primitives);
        iso_json_integer(json, "bytes", p->size.bytes);
        iso_json_end_object(json);
    }
    iso_json_end_array(json);
}

static void put_metrics(iso_json *json, const iso_metrics *metrics) {
    size_t count;
    const iso_metric *list = iso_metric_list(&count);
    for (size_t i = 0; i < count; i++)
        isocompare_put_metric(json, list[i].name, isocompare_metric_value(&list[i], metrics));
    iso_json_integer(json, "missing", metrics->missing);
    iso_json_integer(json, "extra", metrics->extra);
    iso_json_integer(json, "depth_off", metrics->depth_off);
    iso_json_integer(json, "others_differing", metrics->others_differing);
}

static void put_rows(iso_json *json, const report *r) {
    static const int samples[REPORT_SAMPLINGS] = {1, 4}, truth_samples[REPORT_SAMPLINGS] = {1, 16};
    iso_json_begin_array(json, "rows");
    for (int s = 0; s < REPORT_SAMPLINGS; s++)
        for (int z = 0; z < REPORT_ZOOMS; z++)
            for (int m = 1; m < r->method_count; m++) {
                iso_json_begin_object(json, NULL);
                iso_json_integer(json, "zoom", (uint64_t)r->views[z].zoom);
                iso_json_string(json, "method", r->methods[m]->name);
                iso_json_integer(json, "samples", (uint64_t)samples[s]);
                iso_json_integer(json, "truth_samples", (uint64_t)truth_samples[s]);
                put_metrics(json, &r->views[z].cells[m].metrics[s]);
                iso_json_end_object(json);
            }
    iso_json_end_array(json);
}

static void put_frames(iso_json *json, const report *r) {
    iso_json_begin_array(json, "frames");
    for (int z = 0; z < REPORT_ZOOMS; z++)
        for (int m = 0; m < r->method_count; m++) {
            const report_cell *cell = &r->views[z].cells[m];
            iso_json_begin_object(json, NULL);
            iso_json_integer(json, "zoom", (uint64_t)r->views[z].zoom);
            iso_json_string(json, "method", r->methods[m]->name);
            iso_json_real(json, "pixels_per_voxel", r->views[z].pixels_per_voxel);
            iso_json_real(json, "seconds", cell->seconds);
            iso_json_real(json, "bytes", cell->memory ? (double)cell->memory : NAN);
            iso_json_end_object(json);
        }
    iso_json_end_array(json);
}

static void put_transparency(iso_json *json, const report *r) {
    const iso_transparency_study *study = &r->transparency;
    iso_json_begin_object(json, "transparency");
    iso_json_integer(json, "side", (uint64_t)r->transparency_side);
    iso_json_string(json, "truth", r->methods[0]->name);
    iso_json_integer(json, "covered", study->covered);
    iso_json_real(json, "mean_layers", study->mean_layers);
    iso_json_integer(json, "most_layers", (uint64_t)study->most_layers);
    iso_json_begin_array(json, "rows");
    for (int i = 0; i < ISO_TRANSPARENCY_OPACITIES; i++)
        for (int c = 0; c < ISO_COMPOSITINGS; c++) {
            iso_json_begin_object(json, NULL);
            iso_json_string(json, "compositing", iso_compositing_name((iso_compositing)c));
            iso_json_real(json, "opacity", ISO_TRANSPARENCY_OPACITY[i]);
            isocompare_put_metric(json, "psnr", isocompare_psnr_value(study->psnr[c][i]));
            iso_json_real(json, "median_seconds", study->seconds[c]);
            if (c == ISO_COMPOSITING_EXACT) iso_json_integer(json, "wrong_layers", study->wrong_layers[i]);
            iso_json_end_object(json);
        }
    iso_json_end_array(json);
    iso_json_end_object(json);
}

static void put_frame_cost(iso_json *json, const char *key, const iso_cost_frame *frame) {
    iso_json_begin_object(json, key);
    iso_json_real(json, "seconds", frame->median);
    iso_json_real(json, "best_seconds", frame->best);
    iso_json_integer(json, "frames", (uint64_t)frame->frames);
    iso_json_end_object(json);
}

static void put_cost_row(iso_json *json, int number, const iso_cost_row *row) {
    iso_json_begin_object(json, NULL);
    iso_json_string(json, "method", iso_cost_method(number)->name);
    iso_json_integer(json, "primitives", row->primitives);
    iso_json_real(json, "extraction_seconds", row->generation);
    put_frame_cost(json, "frame", &row->still);
    put_frame_cost(json, "edited_frame", &row->edited);
    iso_json_begin_array(json, "viewports");
    for (int v = 0; v < ISO_COST_VIEWPORTS; v++) put_frame_cost(json, NULL, &row->viewport[v]);
    iso_json_end_array(json);
    iso_json_end_object(json);
}

static void put_strokes(iso_json *json, const iso_stroke_cost *cost) {
    iso_json_begin_object(json, "strokes");
    iso_json_integer(json, "strokes", cost->strokes);
    iso_json_integer(json, "samples", cost->samples);
    iso_json_integer(json, "frames", cost->frames);
    iso_json_real(json, "edit_seconds", cost->edit);
    iso_json_begin_array(json, "rows");
    for (int i = 0; i < ISO_COST_METHODS; i++) {
        iso_json_begin_object(json, NULL);
        iso_json_string(json, "method", iso_cost_method(i)->name);
        iso_json_real(json, "extraction_seconds", cost->rows[i].update);
        iso_json_real(json, "frame_seconds", cost->rows[i].frame);
        iso_json_end_object(json);
    }
    iso_json_end_array(json);
    iso_json_end_object(json);
}

static void put_cost(iso_json *json, const iso_cost_study *study) {
    iso_json_begin_object(json, "cost");
    iso_json_integer(json, "side", (uint64_t)study->side);
    iso_json_integer(json, "bricks", study->bricks);
    iso_json_integer(json, "crossed_bricks", study->crossed);
    iso_json_integer(json, "edited_bricks", (uint64_t)study->dirty);
    iso_json_real(json, "strip_indices", study->strips);
    iso_json_ints(json, "viewports", ISO_COST_VIEWPORT, ISO_COST_VIEWPORTS);
    iso_json_begin_array(json, "rows");
    for (int i = 0; i < ISO_COST_METHODS; i++) put_cost_row(json, i, &study->rows[i]);
    iso_json_end_array(json);
    iso_json_end_object(json);
}

static void put_selection(iso_json *json, const report *r) {
    iso_json_begin_array(json, "selection");
    for (int z = 0; z < REPORT_ZOOMS; z++) {
        const report_view *v = &r->views[z];
        iso_json_begin_object(json, NULL);
        iso_json_integer(json, "zoom", (uint64_t)v->zoom);
        iso_json_integer(json, "points", v->visible.points);
        iso_json_integer(json, "outside", v->visible.outside);
        iso_json_integer(json, "hidden", v->visible.hidden);
        iso_json_integer(json, "same_pixel", v->visible.same_pixel);
        iso_json_integer(json, "seen", v->visible.seen);
        iso_json_end_object(json);
    }
    iso_json_end_array(json);
}

static void put_splats(iso_json *json, const iso_splat_cost *cost) {
    iso_json_begin_object(json, "splats");
    iso_json_real(json, "ungrouped_frame_seconds", cost->ungrouped);
    iso_json_begin_array(json, "rows");
    for (int i = 0; i < ISO_SPLAT_COST_OVERLAPS; i++) {
        iso_json_begin_object(json, NULL);
        iso_json_real(json, "overlap", ISO_SPLAT_COST_OVERLAP[i]);
        iso_json_integer(json, "groups", (uint64_t)cost->rows[i].groups);
        iso_json_real(json, "mean_degree", cost->rows[i].mean_degree);
        iso_json_real(json, "grouping_seconds", cost->rows[i].grouping);
        iso_json_real(json, "frame_seconds", cost->rows[i].frame);
        iso_json_end_object(json);
    }
    iso_json_end_array(json);
    iso_json_end_object(json);
}

iso_status isocompare_write_json(const report *r, FILE *stream, iso_error *error) {
    iso_json json = {0};
    iso_json_begin_object(&json, NULL);
    iso_json_string(&json, "schema", "isocompare-report/1");
    iso_json_string(&json, "version", isocompare_program()->version);
    put_volume(&json, r);
    iso_json_integer(&json, "side", (uint64_t)r->settings->side);
    iso_json_string(&json, "truth", r->methods[0]->name);
    iso_json_string(&json, "processor", r->processor);
    iso_json_string(&json, "instructions", iso_cpu_level_name(iso_cpu_best()));
    iso_json_integer(&json, "threads", (uint64_t)iso_pool_threads(r->pool));
    iso_json_integer(&json, "peak_bytes", r->peak);
    put_parts(&json, r);
    put_frames(&json, r);
    put_rows(&json, r);
    put_transparency(&json, r);
    put_cost(&json, &r->cost);
    put_selection(&json, r);
    put_splats(&json, &r->splats);
    if (r->loader.has_strokes) put_strokes(&json, &r->strokes);
    iso_json_end_object(&json);
    return iso_json_write(&json, stream, error);
}
