/* --json: what was read, made and measured, as one object. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "apps/common/json.h"
#include "apps/isorender/channels.h"
#include "apps/isorender/chunks.h"
#include "apps/isorender/colorings.h"
#include "apps/isorender/engines.h"
#include "apps/isorender/picture_record.h"
#include "apps/isorender/segmentation.h"
#include "base/file.h"
#include "base/memory.h"

static void put_vector(iso_json *json, const char *key, iso_vec3 v) {
    const double values[3] = {v.x, v.y, v.z};
    iso_json_reals(json, key, values, 3);
}

/* x0 x1 y0 y1 z0 z1, as --crop and VTK have it. */
static void put_box(iso_json *json, const char *key, const iso_box *box) {
    const double values[6] = {box->lo.x, box->hi.x, box->lo.y, box->hi.y, box->lo.z, box->hi.z};
    iso_json_reals(json, key, values, 6);
}

static void put_volume(iso_json *json, const isorender_job *job) {
    const iso_volume_info *info = &job->loader.volume.info;
    iso_json_begin_object(json, "volume");
    iso_json_string(json, "path", job->plan->input);
    iso_json_string(json, "format", job->loader.has_points ? job->loader.report.format : info->format);
    if (job->has_volume) {
        iso_json_string(json, "name", info->name);
        iso_json_ints(json, "dims", info->dims, 3);
        iso_json_string(json, "type", iso_type_name(info->type));
        iso_json_string(json, "file_type", info->file_type);
        iso_json_integer(json, "components", (uint64_t)info->components);
        iso_json_integer(json, "component", (uint64_t)info->component);
        isorender_report_channel(json, &job->loader);
        isorender_report_channels(json, &job->loader);
        iso_json_reals(json, "spacing", info->transform.spacing, 3);
        iso_json_reals(json, "origin", info->transform.origin, 3);
        iso_json_reals(json, "direction", info->transform.direction, 9);
        iso_json_real(json, "scale", info->scale);
        iso_json_real(json, "offset", info->offset);
        iso_json_bool(json, "level_set", info->level_set);
        iso_json_bool(json, "sparse", info->sparse);
        iso_json_bool(json, "anatomical", info->anatomical);
        const iso_world_unit unit = isorender_volume_unit(info); /* of all lengths below and above */
        iso_json_string(json, "unit", unit == ISO_WORLD_UNIT_NONE ? NULL : iso_world_unit_suffix(unit) + 1);
        iso_json_begin_array(json, "items");
        for (int i = 0; i < info->item_count; i++) iso_json_string(json, NULL, info->items[i]);
        iso_json_end_array(json);
        iso_json_begin_array(json, "notes");
        for (int i = 0; i < info->note_count; i++) iso_json_string(json, NULL, info->notes[i]);
        iso_json_end_array(json);
        if (job->settings->common.input.cropped || job->settings->common.input.cropped_mm)
            iso_json_ints(json, "crop", job->loader.crop, 6);
    }
    iso_json_end_object(json);
}

static void put_histogram(iso_json *json, const isorender_job *job) {
    const iso_histogram *histogram = &job->loader.histogram;
    iso_json_begin_object(json, "histogram");
    iso_json_real(json, "low", histogram->low);
    iso_json_real(json, "high", histogram->high);
    iso_json_integer(json, "counted", histogram->counted);
    iso_json_integer(json, "padding", histogram->padding);
    if (histogram->padding) iso_json_real(json, "padding_value", histogram->padding_value);
    double bins[ISO_HISTOGRAM_BINS];
    for (int i = 0; i < ISO_HISTOGRAM_BINS; i++) bins[i] = (double)histogram->bins[i];
    iso_json_reals(json, "bins", bins, ISO_HISTOGRAM_BINS);
    iso_json_end_object(json);
    iso_json_reals(json, "suggested_isovalues", job->loader.candidates, (int)job->loader.candidate_count);
}

static void put_info(iso_json *json, const isorender_job *job) {
    if (job->has_volume) {
        iso_affine affine = iso_transform_affine(&job->loader.volume.info.transform);
        double matrix[12];
        for (int row = 0; row < 3; row++) {
            memcpy(matrix + 4 * row, affine.m + 3 * row, 3 * sizeof *matrix);
            matrix[4 * row + 3] = affine.origin[row];
        }
        iso_json_reals(json, "matrix", matrix, 12);
    }
    if (job->loader.has_histogram) put_histogram(json, job);
    iso_json_begin_object(json, "memory");
    iso_json_integer(json, "grid", job->loader.volume.info.bytes);
    iso_json_integer(json, "reading", job->loader.volume.info.read_bytes);
    iso_json_integer(json, "picture", isorender_picture_bytes(job, job->samples));
    iso_json_end_object(json);
}

static void put_glass(iso_json *json, const isorender_settings *settings) {
    iso_json_begin_object(json, "glass");
    iso_json_real(json, "ior", settings->ior);
    iso_json_string(json, "refraction", iso_refraction_name((iso_refraction)settings->refraction));
    if (settings->dispersion > 0) iso_json_real(json, "dispersion", settings->dispersion);
    if (settings->opacity_count) iso_json_real(json, "surface_opacity", settings->opacities[0]);
    iso_json_string(json, "environment", settings->environment ? settings->environment : "studio");
    iso_json_end_object(json);
}

static void put_objects(iso_json *json, const isorender_job *job) {
    if (!job->object_count) return;
    iso_json_begin_array(json, "objects");
    for (int i = 0; i < job->object_count; i++) isorender_object_put(json, &job->objects[i]);
    iso_json_end_array(json);
}

/* Isovalues, colours and counts of the input's surfaces. */
static void put_surfaces(iso_json *json, const isorender_job *job) {
    const int count = job->input_surface_count;
    iso_json_real(json, "isovalue", job->surfaces[0].scene.isovalue);
    double isovalues[ISORENDER_SURFACES];
    for (int i = 0; i < count; i++) isovalues[i] = job->surfaces[i].scene.isovalue;
    iso_json_reals(json, "isovalues", isovalues, count);
    iso_json_begin_array(json, "colors");
    for (int i = 0; i < count; i++) {
        char text[8];
        iso_rgb c = job->surfaces[i].color;
        snprintf(text, sizeof text, "%02X%02X%02X", c.r, c.g, c.b);
        iso_json_string(json, NULL, text);
    }
    iso_json_end_array(json);
    if (job->translucent) {
        double opacities[ISORENDER_SURFACES];
        for (int i = 0; i < count; i++) opacities[i] = (double)job->surfaces[i].translucency.opacity;
        iso_json_reals(json, "opacities", opacities, count);
    }
    if (job->environment) put_glass(json, job->settings);
    bool points = job->loader.has_points || job->surfaces[0].scene.points,
         mesh = job->surfaces[0].scene.mesh != NULL, cells = job->surfaces[0].scene.exact != NULL;
    cells |= job->chunks && job->cell_count; /* of which none is kept */
    points |= job->chunks && job->point_count;
    mesh |= job->chunks && job->triangle_count;
    iso_json_begin_object(json, "primitives");
    if (cells) iso_json_integer(json, "cells", job->cell_count);
    if (points) iso_json_integer(json, "points", job->point_count);
    if (points && !job->loader.has_points)
        iso_json_string(json, "kind", iso_primitive_name(isorender_primitive(job)));
    if (job->loader.has_points) isorender_cloud_report(json, job);
    if (points && !job->loader.has_points) iso_json_integer(json, "rejected", job->rejected);
    if (mesh) iso_json_integer(json, "vertices", job->vertex_count);
    if (mesh) iso_json_integer(json, "triangles", job->triangle_count);
    iso_json_end_object(json);
    isorender_report_groups(json, job);
    isorender_report_solid(json, job);
    put_box(json, "bounds_local", &job->bounds_local);
}

/* What the picture shows. */
static void put_contents(iso_json *json, const isorender_job *job) {
    if (job->input_surface_count) put_surfaces(json, job);
    put_objects(json, job);
    isorender_colorings_report(json, job);
    put_box(json, "bounds_world", &job->bounds_world);
}

static void put_camera(iso_json *json, const iso_camera *camera, int height) {
    iso_json_begin_object(json, "camera");
    put_vector(json, "position", camera->position);
    put_vector(json, "focal_point", camera->focal_point);
    put_vector(json, "view_up", camera->view_up);
    iso_json_real(json, "view_angle", camera->view_angle);
    iso_json_bool(json, "orthographic", camera->orthographic);
    iso_json_real(json, "parallel_scale", camera->orthographic ? camera->parallel_scale : NAN);
    iso_json_real(json, "mm_per_pixel", camera->orthographic ? iso_camera_mm_per_pixel(camera, height) : NAN);
    iso_json_end_object(json);
}

static iso_status put_name(iso_json *json, const char *key, const isorender_plan *plan, const char *name,
                           int frame, iso_error *error) {
    if (!name) return ISO_OK;
    char *path = NULL;
    ISO_TRY(isorender_plan_frame(plan, name, frame, &path, error));
    iso_json_string(json, key, path);
    free(path);
    return ISO_OK;
}

/* mean: of the samples that show a surface. */
static void put_layers(iso_json *json, const isorender_frame *frame) {
    const iso_layer_totals *layers = &frame->layers.layers;
    iso_json_begin_object(json, "layers");
    iso_json_real(json, "mean", layers->covered ? (double)layers->layers / (double)layers->covered : 0);
    iso_json_integer(json, "most", (uint64_t)layers->most);
    iso_json_integer(json, "retraced", frame->layers.retraced);
    iso_json_end_object(json);
}

static iso_status put_frame(iso_json *json, const char *key, const isorender_job *job, int frame,
                            iso_error *error) {
    const isorender_settings *settings = job->settings;
    char hash[20];
    snprintf(hash, sizeof hash, "%016llx", (unsigned long long)job->frames[frame].hash);
    iso_json_begin_object(json, key);
    ISO_TRY(put_name(json, "path", job->plan, job->plan->image, frame, error));
    ISO_TRY(put_name(json, "aov_path", job->plan, job->plan->aov, frame, error));
    iso_json_integer(json, "width", (uint64_t)settings->width);
    iso_json_integer(json, "height", (uint64_t)settings->height);
    iso_json_integer(json, "samples", (uint64_t)job->samples);
    iso_json_integer(json, "covered", job->frames[frame].covered);
    iso_json_string(json, "hash", hash);
    if (job->translucent || job->gaussians) put_layers(json, &job->frames[frame]);
    isorender_detail_report(json, &job->frames[frame]);
    isorender_instances_put(json, &job->frames[frame].instances);
    iso_json_end_object(json);
    return ISO_OK;
}

static iso_status put_images(iso_json *json, const isorender_job *job, iso_error *error) {
    if (!isorender_plan_draws(job->plan)) return ISO_OK;
    put_camera(json, &job->camera, job->settings->height);
    if (job->settings->scale_bar)
        iso_json_real(json, isorender_unit(job) == ISO_WORLD_UNIT_MILLIMETRE ? "scale_bar_mm" : "scale_bar",
                      iso_scale_bar_length(&job->camera, job->settings->width, job->settings->height));
    if (!job->frames) return ISO_OK; /* a part of a picture (--part) */
    ISO_TRY(put_frame(json, "image", job, 0, error));
    if (!job->settings->pictures) return ISO_OK;
    iso_json_begin_array(json, "frames");
    for (int i = 0; i < job->frame_count; i++) ISO_TRY(put_frame(json, NULL, job, i, error));
    iso_json_end_array(json);
    return ISO_OK;
}

static void put_seconds(iso_json *json, const isorender_seconds *seconds) {
    iso_json_begin_object(json, "seconds");
    iso_json_real(json, "load", seconds->load);
    iso_json_real(json, "extract", seconds->extract);
    iso_json_real(json, "render", seconds->render);
    iso_json_real(json, "write", seconds->write);
    iso_json_real(json, "total", seconds->total);
    iso_json_end_object(json);
}

static void put_files(iso_json *json, const isorender_job *job) {
    if (job->plan->points) iso_json_string(json, "points_path", job->plan->points);
    if (job->plan->mesh) iso_json_string(json, "mesh_path", job->plan->mesh);
}

/* Writes the number of strip indices, restart indices included, also in percent of the three indices that
 * each triangle takes without strips: the measure of table 2 in Baerentzen and Christensen 2003. */
static void put_strips(iso_json *json, const isorender_job *job) {
    uint64_t indices = 0, triangles = 0;
    for (int i = 0; i < job->surface_count && job->gl.surfaces[i]; i++) {
        iso_gl_surface_stats stats = iso_gl_surface_measure(job->gl.surfaces[i]);
        indices += stats.indices;
        triangles += stats.triangles;
    }
    if (!triangles) return;
    iso_json_integer(json, "strip_indices", indices);
    iso_json_real(json, "strip_percent", 100 * (double)indices / (3 * (double)triangles));
}

/* Seconds that the GPU took for the pictures, by what it did. */
static void put_passes(iso_json *json, const iso_gl_engine *engine) {
    double seconds[ISO_GL_PASSES];
    iso_gl_engine_seconds(engine, seconds);
    iso_json_begin_object(json, "seconds");
    for (int pass = 0; pass < ISO_GL_PASSES; pass++)
        if (seconds[pass] > 0) iso_json_real(json, iso_gl_pass_name((iso_gl_pass)pass), seconds[pass]);
    iso_json_end_object(json);
}

static void put_backend(iso_json *json, const isorender_job *job) {
    const isorender_backend backend = isorender_engines_backend(job);
    iso_json_string(json, "backend", backend.name);
    iso_json_string(json, "renderer", backend.renderer);
    if (!backend.context) return;
    iso_gl_info info = iso_gl_context_info(backend.context);
    iso_json_begin_object(json, "gl");
    iso_json_string(json, "context", info.name);
    iso_json_string(json, "vendor", info.vendor);
    iso_json_string(json, "version", info.version);
    iso_json_integer(json, "messages", iso_gl_context_messages(backend.context).count);
    if (job->settings->strips) put_strips(json, job);
    put_passes(json, backend.engine);
    iso_json_end_object(json);
}

static void put_method(iso_json *json, const isorender_job *job) {
    iso_json_string(json, "method", job->gaussians ? "gaussians" : iso_method_name(job->method));
    if (isorender_has_reconstructions(job->method) && !job->gaussians)
        iso_json_string(json, "reconstruction",
                        isorender_reconstruction_name(job->settings, job->method == ISO_METHOD_SPLATS));
    if (job->settings->filter != ISO_FILTER_LINEAR)
        iso_json_string(json, "reconstruction_filter", iso_filter_names[job->settings->filter]);
}

static iso_status put_report(iso_json *json, const isorender_job *job, iso_error *error) {
    const isorender_settings *settings = job->settings;
    iso_json_begin_object(json, NULL);
    iso_json_string(json, "schema", "isorender/1");
    iso_json_string(json, "version", isorender_program()->version);
    if (!settings->no_input) put_volume(json, job);
    if (job->loader.has_histogram) {
        const double range[2] = {job->loader.histogram.minimum, job->loader.histogram.maximum};
        iso_json_reals(json, "value_range", range, 2);
    }
    if (!settings->no_input) iso_json_integer(json, "nonfinite", job->loader.nonfinite);
    isorender_report_volumes(json, job);
    isorender_report_labels(json, job);
    isorender_report_chunks(json, job);
    isorender_instances_report(json, job);
    if (settings->info)
        put_info(json, job);
    else
        put_contents(json, job);
    put_files(json, job);
    put_seconds(json, &job->seconds);
    iso_json_integer(json, "peak_bytes", iso_memory_peak());
    if (settings->ranks.mpi) {
        iso_json_integer(json, "ranks", (uint64_t)settings->ranks.size);
        iso_json_reals(json, "peak_bytes_of_ranks", job->rank_bytes, 3);
    }
    put_backend(json, job);
    if (!settings->info) put_method(json, job);
    iso_json_integer(json, "threads", (uint64_t)iso_pool_threads(job->pool));
    ISO_TRY(put_images(json, job, error));
    iso_json_end_object(json);
    return ISO_OK;
}

iso_status isorender_report_json(const isorender_job *job, iso_error *error) {
    iso_sink sink = {0};
    iso_json json = {.one_line = job->settings->input_count > 1 && !job->plan->json}; /* lines of JSON */
    ISO_TRY(iso_sink_open(job->plan->json ? job->plan->json : "-", &sink, error));
    iso_status status = put_report(&json, job, error);
    if (status == ISO_OK) return iso_json_commit(&json, &sink, error);
    iso_json_discard(&json);
    iso_sink_abort(&sink);
    return status;
}
