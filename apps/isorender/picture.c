/* Renders surfaces to PNG and EXR files: one picture or the frames of a turntable. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "apps/common/page.h"
#include "apps/isorender/annotations.h"
#include "apps/isorender/chunks.h"
#include "apps/isorender/colorings.h"
#include "apps/isorender/cuts.h"
#include "apps/isorender/isorender.h"
#include "apps/isorender/keyframes.h"
#include "apps/isorender/page.h"
#include "apps/isorender/picture_record.h"
#include "apps/isorender/scene_file.h"
#include "base/clock.h"
#include "base/memory.h"

/* ---- one picture ---- */

/* The loops of the pool that follow belong to this part of the frame's rows. */
static void tell_part(isorender_job *job, double from, double to) {
    const int frames = job->frame_count ? job->frame_count : 1;
    isorender_progress_part(job, "rendering", (job->frame + from) / frames, (job->frame + to) / frames);
}

/* The frame is drawn so far, and no loop belongs to a part of it. */
static void tell_end(isorender_job *job, double to) {
    const int frames = job->frame_count ? job->frame_count : 1;
    isorender_progress(job, "rendering", (job->frame + to) / frames);
}

/* Whether a strip is shaded while it is drawn, in one loop that takes most of the time. */
static bool has_layers(const isorender_job *job) {
    return job->environment || job->gaussians || job->translucent;
}

/* iso_scene_progress.strip. */
static void begin_strip(void *context, double from, double to) {
    isorender_job *job = context;
    job->strip[0] = from;
    job->strip[1] = to;
    if (has_layers(job))
        tell_part(job, from, to);
    else
        tell_end(job, from); /* surfaces tell their parts: clearing and shading are short */
}

/* iso_scene_progress.surface. */
static void tell_surface(void *context, int number, bool done) {
    isorender_job *job = context;
    const double length = (job->strip[1] - job->strip[0]) / job->surface_count,
                 from = job->strip[0] + length * number;
    if (done)
        tell_end(job, from + length);
    else if (isorender_has_instances(job, number))
        tell_end(job, job->strip[0]); /* each of them is drawn by loops of its own */
    else
        tell_part(job, from, from + length);
}

/* FNV-1a, 64 bits, over width and height as 4 little-endian bytes each and the pixels. */
static uint64_t hash_image(const iso_image *image) {
    uint64_t hash = 0xcbf29ce484222325u;
    const int sides[2] = {image->width, image->height};
    for (int side = 0; side < 2; side++)
        for (int shift = 0; shift < 32; shift += 8)
            hash = (hash ^ (uint64_t)(sides[side] >> shift & 255)) * 0x100000001b3u;
    size_t count = (size_t)image->width * (size_t)image->height * 4;
    for (size_t i = 0; i < count; i++) hash = (hash ^ image->rgba[i]) * 0x100000001b3u;
    return hash;
}

iso_status isorender_picture_record_make(const isorender_job *job, isorender_picture_record *l,
                                         iso_error *error) {
    const iso_program *program = isorender_program();
    snprintf(l->software, sizeof l->software, "%s %s", program->name, program->version);
    size_t used = 0;
    l->isovalues[0] = 0;
    for (int i = 0; i < job->surface_count && used + 32 < sizeof l->isovalues; i++)
        if (!job->surfaces[i].loader->has_points)
            used += (size_t)snprintf(l->isovalues + used, sizeof l->isovalues - used, "%s%.10g",
                                     used ? ", " : "isovalue ", job->surfaces[i].scene.isovalue);
    snprintf(l->command, sizeof l->command, "%s %s", program->name, job->plan->model);
    isorender_scene_command(job, l->command, sizeof l->command);
    return isorender_scene_text(job, &l->scene, error);
}

void isorender_picture_record_free(isorender_picture_record *l) {
    free(l->scene);
}

iso_length_style isorender_lengths(const isorender_job *job) {
    return (iso_length_style){(iso_length_unit)job->settings->unit, isorender_unit(job)};
}

double isorender_pixels_per_metre(const isorender_job *job) {
    if (job->settings->dpi > 0) return job->settings->dpi / 0.0254;
    const double millimetres = iso_camera_mm_per_pixel(&job->camera, job->settings->height) *
                               iso_world_unit_millimetres(isorender_unit(job));
    const double density = millimetres > 0 ? 1000 / millimetres : 0;
    return density < 2e8 ? density : 0; /* (molecules: no file can state it) */
}

/* What the file of a picture tells; borrows `record`. */
static iso_picture_facts facts_of(const isorender_job *job, const isorender_picture_record *record) {
    return (iso_picture_facts){.software = record->software,
                               .title = job->plan->model,
                               .command = record->command,
                               .description = record->isovalues[0] ? record->isovalues : NULL,
                               .scene = record->scene,
                               .pixels_per_metre = isorender_pixels_per_metre(job),
                               .sized = job->settings->dpi > 0,
                               .pool = job->pool};
}

iso_status isorender_write_picture(isorender_job *job, iso_image *image, const iso_drawing *over,
                                   const char *path, iso_error *error) {
    isorender_picture_record record;
    if (iso_page_is_named(path)) return isorender_page_write(job, image, path, error);
    ISO_TRY(isorender_picture_record_make(job, &record, error));
    const iso_picture_facts facts = facts_of(job, &record);
    const iso_status status = iso_picture_file_write(path, image, over, &facts, error);
    isorender_picture_record_free(&record);
    return status;
}

static iso_status write_aov(isorender_job *job, int frame, const iso_aov *aov, const char *path,
                            iso_error *error) {
    isorender_picture_record record;
    ISO_TRY(isorender_picture_record_make(job, &record, error));
    const iso_camera camera = isorender_camera_of_frame(job, frame);
    const iso_picture_facts facts = facts_of(job, &record);
    const iso_status status = iso_picture_file_write_aov(path, aov, &camera, &facts, error);
    isorender_picture_record_free(&record);
    return status;
}

/* The buffers of a frame; the planes of aov are NULL without --aov. */
typedef struct canvas {
    iso_image image;
    iso_drawing over; /* what is not painted onto the image */
    iso_aov aov;
} canvas;

static iso_scene_glass make_glass(const isorender_job *job) {
    const isorender_settings *settings = job->settings;
    iso_scene_glass made = {.glass = {.ior = settings->ior,
                                      .surface_opacity = settings->opacity_count ? settings->opacities[0] : 0,
                                      .environment = job->environment},
                            .refraction = (iso_refraction)settings->refraction,
                            .abbe = settings->dispersion,
                            .shows_environment = !settings->background_given && !settings->transparent};
    if (settings->attenuation_colored)
        iso_glass_set_absorption(&made.glass, settings->attenuation_color, settings->attenuation_distance);
    return made;
}

iso_scene isorender_scene(isorender_job *job, isorender_scene_arrays *arrays) {
    for (int i = 0; i < job->surface_count; i++)
        arrays->surfaces[i] = (iso_layered_surface){&job->surfaces[i].scene, job->surfaces[i].translucency};
    for (int i = 0; i < job->object_count; i++) arrays->objects[i] = &job->objects[i].scene;
    if (job->gaussians) arrays->gaussians = isorender_gaussians_of(job);
    arrays->engine = iso_gl_scene_engine(&job->gl);
    arrays->progress = (iso_scene_progress){begin_strip, tell_surface, job};
    return (iso_scene){.renderer = job->renderer,
                       .surfaces = arrays->surfaces,
                       .count = job->surface_count,
                       .objects = arrays->objects,
                       .object_count = job->object_count,
                       .translucent = job->translucent,
                       .placed = &job->instances.placed,
                       .placed_count = isorender_has_instances(job, 0) ? job->input_surface_count : 0,
                       .pyramid_count = job->settings->one_pyramid ? job->input_surface_count : 0,
                       .gaussians = job->gaussians ? &arrays->gaussians : NULL,
                       .workspace = job->point_workspace,
                       .transparency = (iso_transparency)job->settings->transparency,
                       .engine = job->backend->engine ? &arrays->engine : NULL,
                       .progress = &arrays->progress};
}

static iso_occlusion_opts occlusion_opts(const isorender_settings *settings) {
    return (iso_occlusion_opts){.ambient = settings->occlusion != 0,
                                .range = isnan(settings->occlusion) ? 0 : settings->occlusion,
                                .shadow = settings->shadow,
                                .most_bytes = iso_memory_limit(settings->common.input.max_memory) / 8};
}

static iso_status render_scene(isorender_job *job, iso_picture_opts *opts, iso_image *image,
                               isorender_frame *frame, iso_error *error) {
    const iso_scene_glass glass = make_glass(job);
    isorender_scene_arrays arrays;
    iso_capped solids[ISORENDER_SURFACES];
    iso_cut_caps caps;
    iso_scene scene = isorender_scene(job, &arrays);
    if (job->environment) scene.glass = &glass;
    if (isorender_has_caps(job->settings)) {
        caps = isorender_caps(job, solids);
        scene.caps = &caps;
    }
    scene.occlusion = occlusion_opts(job->settings);
    scene.occluders = &job->occluders;
    if (!has_layers(job)) tell_part(job, 0, 1);
    ISO_TRY(iso_scene_render(&scene, opts, image, &frame->covered, error));
    frame->layers = scene.totals;
    return ISO_OK;
}

static iso_status render_picture(isorender_job *job, iso_picture_opts *opts, iso_image *image,
                                 isorender_frame *frame, iso_error *error) {
    if (job->chunks) return isorender_chunks_draw(job, opts, image, &frame->covered, error);
    return render_scene(job, opts, image, frame, error);
}

/* Whether a pixel can show one of several things, whose ids --aov writes. */
static bool has_ids(const isorender_settings *settings) {
    return settings->aov && (settings->object_options.count || settings->volume_count ||
                             settings->isovalue_count > 1 || settings->labels || settings->smooth);
}

static uint64_t smaller(uint64_t a, uint64_t b) {
    return a < b ? a : b;
}

/* The most bytes of the gbuffer of a strip: where memory is scarce, strips are shorter. */
static uint64_t strip_bytes(const isorender_settings *settings) {
    return smaller(iso_memory_limit(settings->common.input.max_memory) / 4, ISO_PICTURE_STRIP_BYTES);
}

/* Whether a picture may show nothing: it is one of several, among which the surface comes and goes; but not
 * if it is the last of them, and all have shown nothing. */
static bool may_be_empty(const isorender_job *job, int frame) {
    const isorender_settings *settings = job->settings;
    const isorender_film *film = settings->film;
    return (settings->series_of || settings->keyframes) &&
           (film->covered > 0 || film->first + frame + 1 < film->count);
}

/* Draws a frame without what is over it, in `factor` times as many pixels on each side. rows: as in
 * iso_picture_opts. */
static iso_status draw_frame(isorender_job *job, int frame, int factor, const int rows[2], iso_image *image,
                             iso_aov *aov, isorender_frame *counts, iso_error *error) {
    const isorender_settings *settings = job->settings;
    iso_camera camera = isorender_camera_of_frame(job, frame);
    iso_rgb colors[ISORENDER_SURFACES + ISORENDER_OBJECTS];
    const int count = job->surface_count + job->object_count;
    for (int i = 0; i < count; i++)
        colors[i] = i < job->surface_count ? job->surfaces[i].color
                                           : job->objects[i - job->surface_count].scene.color;
    iso_picture_opts opts = {.camera = &camera,
                             .width = settings->width * factor,
                             .height = settings->height * factor,
                             .rows = {rows[0], rows[1]},
                             .samples = job->samples,
                             .strip_bytes = (size_t)strip_bytes(settings),
                             .shading = {.colors = colors,
                                         .color_count = count,
                                         .background = settings->background,
                                         .transparent = settings->transparent},
                             .lighting = (iso_lighting)settings->lighting,
                             .outline = settings->outline,
                             .pool = job->pool,
                             .aov = aov && aov->depth ? aov : NULL};
    ISO_TRY(isorender_instances_begin(job, error));
    ISO_TRY(isorender_cuts_make(job, frame, error));
    return render_picture(job, &opts, image, counts, error);
}

/* isorender_enlarged: of an inset. */
static iso_status draw_enlarged(isorender_job *job, int frame, int factor, const int rows[2],
                                iso_image *image, iso_error *error) {
    isorender_frame counts = {0};
    ISO_TRY(iso_image_create(job->settings->width * factor, job->settings->height * factor, image, error));
    return draw_frame(job, frame, factor, rows, image, NULL, &counts, error);
}

/* Whether annotations stay marks: of a sheet, or of a panel. */
static bool keeps_marks(const isorender_job *job) {
    return job->settings->panel || (job->plan->image && iso_image_is_sheet(job->plan->image));
}

static iso_status annotate(isorender_job *job, int frame, canvas *c, iso_error *error) {
    const iso_camera camera = isorender_camera_of_frame(job, frame);
    iso_drawing_free(&c->over);
    ISO_TRY(isorender_annotate(job, frame, &camera, &c->image, draw_enlarged, &c->over, error));
    if (keeps_marks(job)) return ISO_OK;
    ISO_TRY(iso_drawing_paint(&c->over, &c->image, error));
    iso_drawing_free(&c->over);
    return ISO_OK;
}

static iso_status render_frame(isorender_job *job, int frame, canvas *c, iso_error *error) {
    const isorender_settings *settings = job->settings;
    const iso_selection_counts before = isorender_selection(job);
    double start = iso_clock_seconds();
    ISO_TRY(draw_frame(job, frame, 1, (int[2]){0, 0}, &c->image, &c->aov, &job->frames[frame], error));
    job->frames[frame].instances = iso_placed_counts(&job->instances.placed);
    isorender_detail_note(job, &before, &job->frames[frame]);
    job->seconds.render += iso_clock_seconds() - start;
    settings->film->covered += job->frames[frame].covered;
    const bool fails = job->frames[frame].covered == 0 && !may_be_empty(job, frame);
    if (fails) ISO_TRY(isorender_cuts_fail_empty(job, error));
    if (fails)
        return iso_fail(error, ISO_ERR_EMPTY,
                        job->object_count ? "nothing is in view" : "nothing of the surface is in view");
    if (!settings->ranks.rank) ISO_TRY(annotate(job, frame, c, error));
    /* (a few milliseconds, byte by byte) */
    if (settings->common.json && !settings->ranks.rank) job->frames[frame].hash = hash_image(&c->image);
    return ISO_OK;
}

isorender_film isorender_film_of(const isorender_settings *settings) {
    isorender_film film = {.count = settings->pictures ? settings->pictures : 1};
    for (int i = 0; i < ISORENDER_COLORINGS; i++) film.ranges[i][0] = film.ranges[i][1] = NAN;
    return film;
}

/* Adds a picture to the film's video, which the first one begins and the last one ends. */
static iso_status film_picture(isorender_job *job, int frame, const iso_image *image, iso_error *error) {
    const isorender_settings *settings = job->settings;
    isorender_film *film = settings->film;
    const bool last = film->first + frame + 1 >= film->count;
    isorender_picture_record record;
    ISO_TRY(isorender_picture_record_make(job, &record, error));
    const iso_picture_facts facts = facts_of(job, &record);
    const iso_status status =
        iso_picture_file_add(job->plan->image, image, settings->frame_rate, settings->transparent != 0,
                             &facts, last, &film->video, error);
    isorender_picture_record_free(&record);
    if (status == ISO_OK && last) job->frames_written = 1;
    return status;
}

static iso_status save_image(isorender_job *job, int frame, canvas *c, iso_error *error) {
    isorender_panel *panel = job->settings->panel;
    isorender_tile *tile = job->settings->sheet.tile;
    if (tile) {
        tile->image = c->image;
        c->image = (iso_image){.rgba = NULL};
        return ISO_OK;
    }
    if (panel) { /* it becomes a part of a sheet */
        panel->image = c->image, panel->drawing = c->over;
        c->image = (iso_image){.rgba = NULL}, c->over = (iso_drawing){.marks = NULL};
        return ISO_OK;
    }
    if (!job->plan->image || job->settings->ranks.rank) return ISO_OK;
    if (job->plan->video) return film_picture(job, frame, &c->image, error);
    char *path = NULL;
    ISO_TRY(isorender_plan_frame(job->plan, job->plan->image, frame, &path, error));
    iso_status status = isorender_write_picture(job, &c->image, &c->over, path, error);
    if (status == ISO_OK) job->frames_written = frame + 1;
    free(path);
    return status;
}

static iso_status save_aov(isorender_job *job, int frame, const canvas *c, iso_error *error) {
    if (!job->plan->aov) return ISO_OK;
    char *path = NULL;
    ISO_TRY(isorender_plan_frame(job->plan, job->plan->aov, frame, &path, error));
    iso_status status = write_aov(job, frame, &c->aov, path, error);
    if (status == ISO_OK) job->aovs_written = frame + 1;
    free(path);
    return status;
}

/* Uploads everything to the GPU. */
static iso_status upload(isorender_job *job, iso_error *error) {
    isorender_scene_arrays arrays;
    const iso_scene scene = isorender_scene(job, &arrays);
    iso_gl_engine_reset_seconds(job->backend->engine);
    job->gl.engine = job->backend->engine;
    job->gl.pool = job->pool;
    job->gl.strips = job->settings->strips;
    job->gl.scaling = (iso_point_scaling)job->settings->scaling;
    job->gl.tan_y = iso_tan(job->camera.view_angle * (ISO_PI / 360));
    job->gl.tan_x = job->gl.tan_y * job->settings->width / job->settings->height;
    return iso_gl_scene_upload(&job->gl, &scene, error);
}

/* Makes camera, surfaces and opacities those of a picture between keyframes. */
static iso_status show_keyframe(isorender_job *job, int frame, iso_error *error) {
    bool remade;
    ISO_TRY(isorender_keyframes_show(job, frame, &remade, error));
    if (!remade) return ISO_OK;
    iso_occluders_free(&job->occluders);
    ISO_TRY(isorender_detail_make(job, error));
    if (!job->backend->engine) return ISO_OK;
    iso_gl_scene_free(&job->gl);
    return upload(job, error);
}

static iso_status make_frame(isorender_job *job, int frame, canvas *c, iso_error *error) {
    ISO_TRY(show_keyframe(job, frame, error));
    ISO_TRY(render_frame(job, frame, c, error));
    double start = iso_clock_seconds();
    ISO_TRY(save_image(job, frame, c, error));
    ISO_TRY(save_aov(job, frame, c, error));
    job->seconds.write += iso_clock_seconds() - start;
    return ISO_OK;
}

static iso_status render_frames(isorender_job *job, canvas *c, iso_error *error) {
    for (int frame = 0; frame < job->frame_count; frame++) {
        job->frame = frame;
        begin_strip(job, 0, 1);
        ISO_TRY(iso_ranks_agree(&job->settings->ranks, make_frame(job, frame, c, error), error));
    }
    isorender_progress(job, "rendering", 1);
    return ISO_OK;
}

/* ---- all pictures ---- */

static float smallest_spacing(const isorender_job *job) {
    if (!job->has_volume) return 0;
    const double *s = job->loader.volume.info.transform.spacing;
    return (float)fmin(s[0], fmin(s[1], s[2]));
}

/* Main memory that a software renderer of OpenGL takes for a picture. */
static uint64_t gl_bytes(const isorender_job *job) {
    const isorender_settings *settings = job->settings;
    if (iso_gl_context_info(job->backend->context).hardware) return 0;
    const int factor = iso_picture_factor(job->samples);
    const iso_gl_picture picture = {.renderer = job->renderer,
                                    .width = settings->width * factor,
                                    .height = settings->height * factor,
                                    .groups = settings->groups,
                                    .selects = settings->selection != (int)ISO_SELECTION_ALL,
                                    .shapes = settings->object_options.count > 0};
    return iso_gl_scene_bytes(job->backend->engine, &picture);
}

uint64_t isorender_picture_bytes(const isorender_job *job, int samples) {
    const isorender_settings *settings = job->settings;
    uint64_t pixels = (uint64_t)settings->width * (uint64_t)settings->height;
    const uint64_t count = pixels * (uint64_t)samples;
    uint64_t strip = count * ISO_PICTURE_SAMPLE_BYTES;
    const bool planes[] = {settings->lighting, settings->occlusion != 0, settings->shadow,
                           settings->outline > 0};
    for (int i = 0; i < 4; i++) strip += planes[i] ? count * sizeof(float) : 0;
    const uint64_t gbuffer = smaller(strip, strip_bytes(settings));
    uint64_t aov = settings->aov ? pixels * (ISO_AOV_PLANES + 1) * sizeof(float) : 0;
    if (has_ids(settings)) aov += pixels * ISO_ID_PLANES * sizeof(uint32_t);
    const uint64_t larger = (uint64_t)isorender_inset_factor(settings);
    uint64_t bytes = 4 * pixels * (1 + larger * larger) + isorender_chunks_bytes(job) + aov + gbuffer;
    const uint64_t threads = (uint64_t)iso_pool_threads(job->pool);
    const bool fragments = isorender_object_opacity_option(settings) != NULL;
    if (isorender_is_translucent(settings) || fragments) bytes += threads * ISO_EXACT_LAYERS_BYTES;
    if (fragments) bytes += threads * ISO_SHAPES_PIECES_BYTES;
    if (settings->ior > 0) bytes += iso_glass_scene_bytes((iso_refraction)settings->refraction, count);
    if (job->backend->engine && settings->object_options.count) bytes += gbuffer;
    if (job->backend->engine) return bytes + gl_bytes(job);
    const bool pyramids = job->renderer->can & ISO_CAN_PYRAMID;
    if (!pyramids && job->method != ISO_METHOD_DISCS) return bytes;
    enum { PYRAMID = 24, SETS = 104 }; /* bytes a sample; drawn in parts as well */
    bool sets = false, meshes = job->method == ISO_METHOD_HYBRID;
    for (int i = 0; i < settings->object_options.count; i++) {
        sets |= settings->object_options.kinds[i] != ISO_OBJECT_GLYPHS;
        meshes |= settings->object_options.kinds[i] == ISO_OBJECT_MESH;
    }
    if (meshes) bytes += gbuffer; /* the triangles' picture */
    uint64_t pyramid = count * (PYRAMID + (sets && pyramids ? SETS : 0));
    return bytes + smaller(pyramid, ISO_PICTURE_STRIP_BYTES);
}

/* Notes that there is nothing that could occlude. */
static void note_occlusion(const isorender_job *job) {
    const isorender_settings *settings = job->settings;
    if (settings->occlusion == 0 && !settings->shadow) return;
    for (int i = 0; i < job->surface_count; i++)
        if (!job->surfaces[i].loader->has_points && job->surfaces[i].translucency.opacity >= 1) return;
    for (int i = 0; i < job->object_count; i++)
        if (iso_scene_object_is_opaque(&job->objects[i].scene)) return;
    isorender_log(job,
                  "note: %s of opaque surfaces of volumes, lines, glyphs and meshes: there is none in the "
                  "picture",
                  settings->occlusion != 0 ? "--occlusion is" : "--shadow is");
}

/* Sets what a panel adds to what all panels have in common. */
static iso_status survey(isorender_job *job, iso_error *error) {
    isorender_panel *panel = job->settings->panel;
    iso_color_bar bars[ISORENDER_BARS];
    panel->range_count = isorender_color_bars(job, bars);
    panel->camera = job->camera;
    panel->box = job->bounds_framed;
    panel->has_camera = true;
    free(panel->ranges);
    panel->ranges = calloc(ISORENDER_BARS, sizeof *panel->ranges);
    if (!panel->ranges) return iso_fail(error, ISO_ERR_NOMEM, "out of memory");
    for (int i = 0; i < panel->range_count; i++)
        panel->ranges[i][0] = bars[i].low, panel->ranges[i][1] = bars[i].high;
    return ISO_OK;
}

iso_status isorender_render(isorender_job *job, iso_error *error) {
    const isorender_settings *settings = job->settings;
    note_occlusion(job);
    isorender_cuts_note(job);
    ISO_TRY(isorender_keyframes_measure(job, error));
    ISO_TRY(isorender_camera_make(job, error));
    ISO_TRY(isorender_colorings_see(job, error));
    ISO_TRY(isorender_chunks_check(job, error));
    if (settings->panel && settings->panel->is_survey) return survey(job, error);
    if (settings->sheet.tile && settings->sheet.tile->is_survey) return ISO_OK;
    if (settings->parts) {
        ISO_TRY(isorender_cuts_make(job, 0, error));
        return isorender_chunks_write_part(job, error);
    }
    job->frame_count = settings->pictures ? settings->pictures : 1;
    job->frames = calloc((size_t)job->frame_count, sizeof *job->frames);
    if (!job->frames) return iso_fail(error, ISO_ERR_NOMEM, "out of memory");
    canvas c = {0};
    iso_status status = iso_image_create(settings->width, settings->height, &c.image, error);
    if (status == ISO_OK && job->plan->aov)
        status = iso_aov_create(settings->width, settings->height, &c.aov, error);
    if (status == ISO_OK && job->plan->aov && job->translucent) status = iso_aov_add_layers(&c.aov, error);
    if (status == ISO_OK && has_ids(settings)) status = iso_aov_add_ids(&c.aov, error);
    c.aov.voxel = smallest_spacing(job);
    double start = iso_clock_seconds();
    if (status == ISO_OK) status = isorender_detail_make(job, error);
    if (status == ISO_OK && job->backend->engine) status = upload(job, error);
    job->seconds.render += iso_clock_seconds() - start;
    if (status == ISO_OK) status = render_frames(job, &c, error);
    if (status == ISO_OK) isorender_cuts_note_seen(job);
    iso_image_free(&c.image);
    iso_drawing_free(&c.over);
    iso_aov_free(&c.aov);
    return status;
}

iso_status isorender_render_nothing(isorender_job *job, iso_error *error) {
    const isorender_settings *settings = job->settings;
    const iso_rgb color = settings->background;
    const uint8_t pixel[4] = {color.r, color.g, color.b, settings->transparent ? 0 : 255};
    canvas c = {0};
    if (!may_be_empty(job, 0)) return ISO_ERR_EMPTY;
    ISO_TRY(isorender_camera_make(job, error));
    ISO_TRY(iso_image_create(settings->width, settings->height, &c.image, error));
    const size_t count = (size_t)settings->width * (size_t)settings->height;
    for (size_t i = 0; i < count; i++) memcpy(c.image.rgba + 4 * i, pixel, sizeof pixel);
    isorender_log(job, "note: there is nothing of the surface: the picture shows the background");
    iso_status status = annotate(job, 0, &c, error);
    if (status == ISO_OK) status = save_image(job, 0, &c, error);
    iso_image_free(&c.image);
    iso_drawing_free(&c.over);
    return status;
}
