/* Isovalues and the surfaces they give: points, meshes, ray casters, their counts and bounds, their files. */
#include <math.h>

#include "apps/isorender/channels.h"
#include "apps/isorender/chunks.h"
#include "apps/isorender/colorings.h"
#include "apps/isorender/isorender.h"
#include "apps/isorender/label_meshes.h"
#include "apps/isorender/segmentation.h"
#include "scene/beside.h"
#include "scene/bounds.h"

/* ---- which isovalues ---- */

static bool is_of_input(const isorender_job *job, const isorender_surface *surface) {
    return surface->loader == &job->loader;
}

/* Says which isovalue was chosen. */
static void log_isovalue(isorender_job *job, const isorender_surface *surface) {
    const iso_loader *loader = surface->loader;
    const double *candidates = loader->candidates;
    /* The input is named already. */
    const bool is_input = is_of_input(job, surface), is_channel = loader->options->channel;
    char title[ISORENDER_CHANNEL_TITLE];
    const char *name = is_channel ? isorender_channel_title(loader, title) : is_input ? "" : loader->input;
    const char *colon = *name ? ": " : "";
    if (job->isovalue_logged && is_input) return;
    job->isovalue_logged |= is_input;
    if (iso_grid_is_level_set(&loader->volume.grid))
        isorender_log(job, "%s%sisovalue %g (a level set)", name, colon, candidates[0]);
    else if (loader->candidate_count < ISO_ISOVALUE_CANDIDATES)
        isorender_log(job, "%s%sisovalue %g (Otsu's threshold, 1979)", name, colon, candidates[0]);
    else
        isorender_log(job, "%s%sisovalue %g (Otsu's threshold, 1979); next candidates: %g and %g", name,
                      colon, candidates[0], candidates[1], candidates[2]);
}

/* Within a voxel of the end of the narrow band, neighbouring values are clamped. */
static void warn_of_band_end(const isorender_job *job, const isorender_surface *surface) {
    const iso_grid *grid = &surface->loader->volume.grid;
    const double isovalue = surface->scene.isovalue;
    if (!grid->hgrid || fabs(iso_grid_stored(grid, isovalue)) <= (double)grid->hgrid->band - 1) return;
    isorender_log(
        job,
        "note: isovalue %g lies within a voxel of the end of the level set's narrow band (%g mm): the "
        "surface is not exact",
        isovalue, iso_grid_physical(grid, (double)grid->hgrid->band));
}

/* The physical value of an isovalue that is given in standard deviations. */
static iso_status find_sigma(isorender_job *job, iso_loader *loader, double sigmas, double *isovalue,
                             iso_error *error) {
    ISO_TRY(iso_loader_moments(loader, NULL, error));
    *isovalue = loader->moments.mean + sigmas * loader->moments.deviation;
    isorender_log(job, "isovalue %g (%g sigma: mean %g, standard deviation %g)", *isovalue, sigmas,
                  loader->moments.mean, loader->moments.deviation);
    return ISO_OK;
}

static iso_status choose_isovalue(isorender_job *job, isorender_surface *surface, isorender_isovalue chosen,
                                  iso_error *error) {
    iso_loader *loader = surface->loader;
    double given = chosen.value;
    bool is_chosen;
    if (chosen.sigma && !loader->has_points) ISO_TRY(find_sigma(job, loader, chosen.value, &given, error));
    surface->scene.isovalue = given;
    if (loader->has_points) return ISO_OK;
    ISO_TRY(iso_loader_isovalue(loader, given, &surface->scene.isovalue, &is_chosen, error));
    if (is_chosen)
        log_isovalue(job, surface);
    else if (!isnan(given))
        warn_of_band_end(job, surface);
    return ISO_OK;
}

/* Makes the workspace that surfaces and lines share, if there is one: pictures are drawn one after the other.
 */
static iso_status make_workspace(isorender_job *job, iso_error *error) {
    const bool uses_one = job->renderer->can & (ISO_CAN_PYRAMID | ISO_CAN_LEVELS);
    if (!uses_one || (job->backend->engine && !job->object_count)) return ISO_OK;
    return iso_point_workspace_create(&job->point_workspace, error);
}

/* Adds a surface; errors as choose_isovalue. */
static iso_status add_surface(isorender_job *job, iso_loader *loader, isorender_isovalue isovalue,
                              iso_error *error) {
    isorender_surface *surface = &job->surfaces[job->surface_count++];
    surface->loader = loader;
    surface->scene = (iso_scene_surface){.pool = job->pool,
                                         .given = loader->has_points ? &job->read_points : NULL,
                                         .transparency = (iso_transparency)job->settings->transparency,
                                         .grouping = isorender_grouping(job->settings),
                                         .bins = job->settings->group_bins,
                                         .selection = (iso_point_selection)job->settings->selection,
                                         .filter = (iso_filter)job->settings->filter,
                                         .lod_pixels = isorender_detail_pixels(job->settings),
                                         .workspace = job->point_workspace};
    return choose_isovalue(job, surface, isovalue, error);
}

static isorender_isovalue given_isovalue(const isorender_settings *settings, int i) {
    return (isorender_isovalue){settings->isovalues[i], settings->isovalue_sigmas[i]};
}

static iso_status add_surfaces(isorender_job *job, iso_error *error) {
    const isorender_settings *settings = job->settings;
    for (int i = 0; i < settings->isovalue_count; i++)
        ISO_TRY(isorender_volume_named(
            job, -1, add_surface(job, &job->loader, given_isovalue(settings, i), error), error));
    const isorender_same_view *first = settings->first;
    const isorender_isovalue isovalue = {first && first->has_isovalue ? first->isovalue : NAN, false};
    if (!settings->isovalue_count && !settings->no_input)
        ISO_TRY(isorender_volume_named(job, -1, add_surface(job, &job->loader, isovalue, error), error));
    job->input_surface_count = job->surface_count;
    for (int i = 0; i < job->volume_count; i++)
        ISO_TRY(isorender_volume_named(
            job, i, add_surface(job, &job->volumes[i], settings->volumes[i].isovalue, error), error));
    return isorender_segmentation_add(job, error);
}

/* What the options say of the surface of a further volume; NULL: the surface is the input's. */
static const isorender_volume_settings *volume_settings(const isorender_job *job, int surface) {
    const int volume = surface - job->input_surface_count;
    return volume < 0 ? NULL : &job->settings->volumes[volume];
}

static void choose_colors(isorender_job *job) {
    const isorender_settings *settings = job->settings;
    for (int i = 0; i < job->surface_count && !job->surfaces[i].label_group; i++) {
        const isorender_volume_settings *volume = volume_settings(job, i);
        const iso_rgb *given = volume ? &volume->color : &settings->colors[i];
        const bool is_given = volume ? volume->colored : i < settings->color_count;
        const iso_loader *loader = job->surfaces[i].loader;
        iso_rgb stated = iso_shading_palette(i);
        if (!loader->has_strokes && iso_painted_any(&loader->painted)) stated = loader->painted.own;
        if (!is_given) isorender_channel_color(job, i, &stated);
        job->surfaces[i].color = is_given ? *given : stated;
        job->surfaces[i].color_given = is_given;
    }
}

iso_translucency isorender_translucency(const isorender_settings *settings, double opacity) {
    return (iso_translucency){.opacity = (float)opacity,
                              .constant = settings->opacity_mode == ISORENDER_OPACITY_CONSTANT,
                              .most_layers = settings->layers};
}

static void choose_opacities(isorender_job *job) {
    const isorender_settings *settings = job->settings;
    const int given = settings->opacity_count;
    for (int i = 0; i < job->surface_count && !job->surfaces[i].label_group; i++) {
        const isorender_volume_settings *volume = volume_settings(job, i);
        const double of_input = settings->ior > 0 ? 1
                                : given           ? settings->opacities[i < given ? i : given - 1]
                                                  : 1;
        iso_translucency *translucency = &job->surfaces[i].translucency;
        *translucency = isorender_translucency(settings, volume ? volume->opacity : of_input);
        translucency->absorption_length = (float)settings->absorption_length;
        job->translucent |= translucency->opacity < 1;
    }
    if (given && given < job->input_surface_count)
        isorender_log(job, "note: %d opacities for %d isovalues: the last one, %g, repeats", given,
                      job->input_surface_count, settings->opacities[given - 1]);
}

/* ---- extraction ---- */

/* Whether there is no picture: then the exports alone decide what is extracted. */
static bool only_exports(const isorender_job *job) {
    return !isorender_plan_draws(job->plan) && (job->settings->points || job->settings->mesh) &&
           !job->segmentation;
}

/* Whether a part of the surface is needed for the picture. The cells are also needed with the ray caster:
 * they give the bounds, so that its pictures are framed as those of exact. */
static bool is_drawn(const isorender_job *job, iso_part part) {
    unsigned needs = job->renderer->needs;
    if (job->environment)
        needs |= 1u << iso_glass_part(job->method, (iso_refraction)job->settings->refraction);
    if (needs & 1u << ISO_PART_CASTER) needs |= 1u << ISO_PART_CELLS;
    return needs & 1u << part && !only_exports(job);
}

/* The message says which values the volume has, so that the user can choose another isovalue. */
static iso_status fail_empty(const isorender_surface *surface, iso_error *error) {
    iso_loader *loader = surface->loader;
    const int *dims = iso_grid_dims(&loader->volume.grid);
    if (dims[0] < 2 || dims[1] < 2 || dims[2] < 2)
        return iso_fail(
            error, ISO_ERR_EMPTY,
            "%d x %d x %d voxels have no surface: it lies between two voxels or more on every axis", dims[0],
            dims[1], dims[2]);
    ISO_TRY(iso_loader_histogram(loader, error));
    const iso_histogram *histogram = &loader->histogram;
    if (histogram->minimum == histogram->maximum)
        return iso_fail(error, ISO_ERR_EMPTY, "no surface at isovalue %g: every voxel is %g",
                        surface->scene.isovalue, histogram->minimum);
    return iso_fail(error, ISO_ERR_EMPTY, "no surface at isovalue %g: values lie in %g .. %g",
                    surface->scene.isovalue, histogram->minimum, histogram->maximum);
}

/* Whether points are drawn as curved discs. */
static bool draws_curved_discs(const isorender_job *job) {
    return job->renderer->method == ISO_METHOD_DISCS;
}

iso_primitive isorender_primitive(const isorender_job *job) {
    const iso_primitive chosen = (iso_primitive)job->settings->primitive;
    return chosen == ISO_PRIMITIVE_AUTO ? ISO_PRIMITIVE_EDGE : chosen;
}

static iso_status extract_points(isorender_job *job, isorender_surface *surface, iso_error *error) {
    iso_scene_surface *scene = &surface->scene;
    scene->primitive = isorender_primitive(job);
    scene->flat = !draws_curved_discs(job);
    scene->floats = job->settings->points != NULL;
    /* Bounds tell whether the surface is closed: of closed ones, pyramids leave out points that face away,
     * and files say that they are. */
    scene->bounded =
        scene->floats || isorender_has_reconstructions(job->method) || job->method == ISO_METHOD_HYBRID;
    ISO_TRY(iso_scene_surface_update(scene, ISO_PART_POINTS, error));
    if (scene->filter != ISO_FILTER_LINEAR) ISO_TRY(iso_scene_surface_smooth(scene, ISO_PART_POINTS, error));
    const iso_points_stats stats = iso_point_set_stats(scene->points);
    job->point_count += stats.points;
    job->rejected += stats.rejected;
    isorender_log_verbose(job, "isovalue %g: %zu points in %zu bricks, %zu rejected", scene->isovalue,
                          stats.points, stats.bricks, stats.rejected);
    return stats.points ? ISO_OK : fail_empty(surface, error);
}

static iso_status extract_mesh(isorender_job *job, isorender_surface *surface, iso_error *error) {
    ISO_TRY(iso_scene_surface_update(&surface->scene, ISO_PART_MESH, error));
    if (surface->scene.filter != ISO_FILTER_LINEAR)
        ISO_TRY(iso_scene_surface_smooth(&surface->scene, ISO_PART_MESH, error));
    iso_mesh_view view = iso_mesh_set_view(surface->scene.mesh);
    size_t triangles = iso_mesh_view_triangle_count(&view), vertices = iso_mesh_view_vertex_count(&view);
    job->triangle_count += triangles;
    job->vertex_count += vertices;
    isorender_log_verbose(job, "isovalue %g: %zu vertices, %zu triangles", surface->scene.isovalue, vertices,
                          triangles);
    return triangles ? ISO_OK : fail_empty(surface, error);
}

static iso_status extract_cells(isorender_job *job, isorender_surface *surface, iso_error *error) {
    ISO_TRY(iso_scene_surface_update(&surface->scene, ISO_PART_CELLS, error));
    const iso_exact_totals totals = iso_exact_stats(surface->scene.exact);
    job->cell_count += totals.cells;
    isorender_log_verbose(job, "isovalue %g: %zu cells in %zu bricks", surface->scene.isovalue, totals.cells,
                          totals.bricks);
    return totals.cells ? ISO_OK : fail_empty(surface, error);
}

/* Whether --mesh writes this surface: the first one only, if the file holds no more. */
static bool is_exported(const isorender_job *job, int surface) {
    const char *path = job->settings->mesh;
    return path && !job->surfaces[surface].label_group &&
           (surface ? iso_mesh_file_objects(path) > 1 : job->input_surface_count > 0);
}

static iso_status extract_surface(isorender_job *job, isorender_surface *surface, iso_error *error) {
    ISO_TRY(isorender_solid_prepare(job, surface, error));
    const bool is_input = is_of_input(job, surface);
    const bool points = is_input && job->settings->points,
               mesh = is_exported(job, (int)(surface - job->surfaces));
    if (points || is_drawn(job, ISO_PART_POINTS)) ISO_TRY(extract_points(job, surface, error));
    if (mesh || is_drawn(job, ISO_PART_MESH)) ISO_TRY(extract_mesh(job, surface, error));
    if (is_drawn(job, ISO_PART_CELLS)) ISO_TRY(extract_cells(job, surface, error));
    if (isorender_plan_draws(job->plan) && is_drawn(job, ISO_PART_CASTER))
        return iso_scene_surface_update(&surface->scene, ISO_PART_CASTER, error);
    return ISO_OK;
}

/* ---- bounds ---- */

/* Voxel (0, 0, 0) of the file is the local origin, also when a part of it was cut out. Points have world
 * coordinates. */
static iso_box to_local(const isorender_job *job, const iso_box *index) {
    const int *crop = job->loader.crop;
    const int around = job->settings->closed ? 1 : 0; /* voxels that --closed adds */
    iso_transform transform = job->cloud.discs.transform;
    if (job->has_volume) {
        transform = iso_transform_local(iso_grid_transform(&job->surfaces[0].scene.grid));
        for (int axis = 0; axis < 3; axis++)
            transform.origin[axis] = (crop[2 * axis] - around) * transform.spacing[axis];
    }
    iso_affine affine = iso_transform_affine(&transform);
    return iso_box_transform(index, &affine);
}

/* The transform of a surface's index coordinates. */
static iso_transform transform_of(const isorender_job *job, const isorender_surface *surface) {
    return surface->loader->has_points ? job->cloud.discs.transform
                                       : *iso_grid_transform(&surface->scene.grid);
}

/* The box of a surface in the coordinates to which `affine` maps its index coordinates, NULL: in these. */
static iso_box bounds_of(const isorender_job *job, int i, const iso_affine *affine) {
    const iso_scene_surface *scene = &job->surfaces[i].scene;
    if (job->chunks) return isorender_chunks_bounds(job, affine);
    const iso_part part = scene->exact                    ? ISO_PART_CELLS
                          : scene->points || scene->given ? ISO_PART_POINTS
                                                          : ISO_PART_MESH;
    return iso_bounds_along(scene, part, affine);
}

/* Maps index coordinates to those along three world vectors. Only for points: the inverse is not set. */
static iso_affine affine_along(const iso_affine *world, const iso_vec3 vectors[3]) {
    iso_affine along = {.determinant = 1};
    for (int row = 0; row < 3; row++) {
        const iso_vec3 v = vectors[row];
        for (int column = 0; column < 3; column++)
            along.m[3 * row + column] =
                v.x * world->m[column] + v.y * world->m[3 + column] + v.z * world->m[6 + column];
        along.origin[row] = v.x * world->origin[0] + v.y * world->origin[1] + v.z * world->origin[2];
    }
    return along;
}

/* The box of all instances of a surface along three world vectors (NULL: the axes), of which `own` is the box
 * without instances. */
static iso_box bounds_of_instances(const isorender_job *job, int i, const iso_box *own,
                                   const iso_vec3 *vectors) {
    if (!isorender_has_instances(job, i)) return *own;
    const iso_transform transform = transform_of(job, &job->surfaces[i]);
    const iso_box index = bounds_of(job, i, NULL);
    return iso_placed_bounds(&job->instances.placements, &transform, &index, own, vectors);
}

/* Whether a surface is a cloud that is framed with its discs: not if the user has said how large they are. */
static bool has_framed_discs(const isorender_job *job, int i) {
    const bool has_discs = job->method != ISO_METHOD_POINTS && !job->gaussians;
    return job->surfaces[i].loader->has_points && has_discs && !(job->settings->radius > 0);
}

iso_box isorender_bounds(const isorender_job *job, const iso_vec3 vectors[3]) {
    iso_box all = iso_box_empty();
    for (int i = 0; i < job->surface_count; i++) {
        const iso_transform transform = transform_of(job, &job->surfaces[i]);
        const iso_affine world = iso_transform_affine(&transform);
        const iso_affine along = affine_along(&world, vectors);
        const iso_box own = has_framed_discs(job, i)
                                ? iso_bounds_of_each_disc(&job->read_points, &along, vectors)
                                : bounds_of(job, i, &along),
                      box = bounds_of_instances(job, i, &own, vectors);
        iso_bounds_add(&all, &box);
    }
    return all;
}

/* Makes `box` end where `border` ends. */
static void clip_box(iso_box *box, const iso_box *border) {
    box->lo = iso_vec3_make(fmax(box->lo.x, border->lo.x), fmax(box->lo.y, border->lo.y),
                            fmax(box->lo.z, border->lo.z));
    box->hi = iso_vec3_make(fmin(box->hi.x, border->hi.x), fmin(box->hi.y, border->hi.y),
                            fmin(box->hi.z, border->hi.z));
}

/* The caps of --closed lie up to ISO_CLOSED_TOLERANCE beyond the volume's outermost voxels, where the solid
 * ends: the bounds end there. */
static void clip_to_volume(isorender_job *job, iso_box *index) {
    const int *dims = iso_grid_dims(&job->surfaces[0].scene.grid);
    const iso_affine affine = iso_transform_affine(iso_grid_transform(&job->surfaces[0].scene.grid));
    const iso_box voxels = {{1, 1, 1}, {dims[0] - 2, dims[1] - 2, dims[2] - 2}}; /* without the added layer */
    const iso_box world = iso_box_transform(&voxels, &affine);
    clip_box(index, &voxels);
    clip_box(&job->bounds_world, &world);
}

/* Finds a surface's box in the world, and adds its box in index coordinates to *index. */
static void find_surface_bounds(isorender_job *job, int i, iso_box *index) {
    isorender_surface *surface = &job->surfaces[i];
    const iso_transform transform = transform_of(job, surface);
    const iso_affine affine = iso_transform_affine(&transform);
    const iso_box box = bounds_of(job, i, NULL);
    const iso_box own =
        iso_bounds_is_oblique(&transform) ? bounds_of(job, i, &affine) : iso_box_transform(&box, &affine);
    surface->bounds = bounds_of_instances(job, i, &own, NULL);
    iso_bounds_add(index, &box);
}

static void log_beside(const isorender_job *job, const char *path, const iso_box *bounds, iso_space space) {
    char note[ISO_BESIDE_TEXT];
    if (iso_beside_note(path, bounds, &job->bounds_world, space, note)) isorender_log(job, "note: %s", note);
}

static void find_bounds(isorender_job *job) {
    iso_box index = iso_box_empty(), unused = iso_box_empty();
    for (int i = 0; i < job->input_surface_count; i++) {
        find_surface_bounds(job, i, &index);
        iso_bounds_add(&job->bounds_world, &job->surfaces[i].bounds);
    }
    if (job->settings->closed) clip_to_volume(job, &index);
    if (job->input_surface_count) job->bounds_local = to_local(job, &index);
    for (int i = job->input_surface_count; i < job->surface_count; i++) {
        const isorender_surface *surface = &job->surfaces[i];
        find_surface_bounds(job, i, &unused);
        if (!surface->loader->options->channel)
            log_beside(job, surface->loader->input, &surface->bounds, ISO_SPACE_FILE);
        iso_bounds_add(&job->bounds_world, &surface->bounds);
    }
}

/* Whether --one-pyramid draws an object together with the surfaces: a mesh, or ribbons. Tubes and glyphs are
 * drawn alone. */
static bool shares_pyramid(const isorender_object *object) {
    return !object->scene.shapes ||
           (object->scene.pyramid_lines && object->settings->style == ISORENDER_STYLE_RIBBON);
}

/* Objects without a colour get one each, after those of the surfaces. */
static iso_status prepare_objects(isorender_job *job, iso_error *error) {
    const isorender_line_pixels pixels = {job->settings->line_min_pixels, job->settings->line_drop_pixels};
    for (int i = 0; i < job->object_count; i++) {
        isorender_object *object = &job->objects[i];
        if (isorender_object_is_surface(object->settings))
            ISO_TRY(isorender_object_take_gradients(job, object, error));
        if (object->whole)
            object->scene.color = object->whole->scene.color;
        else if (!object->settings->colored)
            object->scene.color = iso_shading_palette(job->surface_count + i);
        ISO_TRY(isorender_object_prepare(object, &pixels, job->renderer->can & ISO_CAN_PYRAMID, error));
        if (!object->whole)
            log_beside(job, object->settings->path, &object->bounds, object->file.report.space);
        object->scene.translucency = isorender_translucency(job->settings, object->settings->opacity);
        object->scene.in_pyramid = job->settings->one_pyramid && shares_pyramid(object);
        job->translucent |= object->settings->opacity < 1;
        iso_bounds_add(&job->bounds_world, &object->bounds);
    }
    return ISO_OK;
}

/* Extracts the only surface chunk by chunk, and finds its bounds. */
static iso_status extract_chunks(isorender_job *job, iso_error *error) {
    iso_box index;
    isorender_progress(job, "extracting", 0);
    ISO_TRY(isorender_chunks_extract(job, &index, error));
    if (!job->cell_count && !job->point_count) return fail_empty(&job->surfaces[0], error);
    job->bounds_world = job->surfaces[0].bounds;
    job->bounds_local = to_local(job, &index);
    return ISO_OK;
}

static iso_status extract_all(isorender_job *job, iso_error *error) {
    job->bounds_local = job->bounds_world = iso_box_empty();
    if (job->chunks) ISO_TRY(isorender_chunks_begin(job, error));
    ISO_TRY(make_workspace(job, error));
    ISO_TRY(add_surfaces(job, error));
    choose_colors(job);
    choose_opacities(job);
    if (job->chunks) return extract_chunks(job, error);
    if (job->loader.has_points) job->point_count = job->cloud.discs.count;
    for (int i = 0; i < job->surface_count; i++) {
        isorender_progress_part(job, "extracting", (double)i / job->surface_count,
                                (double)(i + 1) / job->surface_count);
        if (job->surfaces[i].loader->has_points) continue;
        const int volume = job->surfaces[i].label_group ? -1 : i - job->input_surface_count;
        ISO_TRY(isorender_volume_named(job, volume, extract_surface(job, &job->surfaces[i], error), error));
    }
    for (int i = 0; i < job->surface_count && is_drawn(job, ISO_PART_GROUPS); i++)
        ISO_TRY(isorender_groups_make(job, i, error));
    isorender_progress(job, "extracting", 1);
    find_bounds(job);
    return prepare_objects(job, error);
}

iso_status isorender_extract(isorender_job *job, iso_error *error) {
    isorender_same_view *first = job->settings->first;
    ISO_TRY(extract_all(job, error));
    if (!first || first->has_isovalue || !job->input_surface_count) return ISO_OK;
    first->has_isovalue = true;
    first->isovalue = job->surfaces[0].scene.isovalue;
    return ISO_OK;
}

/* ---- files ---- */

/* Measures the meshes for --json and --verbose if they are not exported; exporting measures them as well. */
static iso_status measure_meshes(isorender_job *job, iso_error *error) {
    const bool measured = job->settings->common.json || job->settings->verbose;
    for (int i = 0; i < job->input_surface_count && measured && !job->plan->mesh; i++) {
        iso_weld weld;
        if (!job->surfaces[i].scene.mesh) continue;
        ISO_TRY(isorender_mesh_weld(job, &job->surfaces[i], NULL, &weld, error));
        iso_weld_free(&weld);
    }
    return ISO_OK;
}

static void name_mesh(const isorender_job *job, int number, char name[256]) {
    const isorender_surface *surface = &job->surfaces[number];
    char title[ISORENDER_CHANNEL_TITLE];
    const char *channel = isorender_channel_title(surface->loader, title);
    const bool is_input = is_of_input(job, surface);
    snprintf(name, 256, "%.150s%s%s isovalue %g", is_input ? job->plan->model : surface->loader->input,
             *channel ? " " : "", channel, surface->scene.isovalue);
}

static iso_status export_meshes(isorender_job *job, const char *comment, iso_error *error) {
    iso_weld welds[ISORENDER_SURFACES] = {0};
    iso_mesh_object objects[ISORENDER_SURFACES] = {0};
    char names[ISORENDER_SURFACES][256];
    iso_status status = ISO_OK;
    int count = 0;
    for (int i = 0; i < job->surface_count && status == ISO_OK; i++) {
        isorender_surface *surface = &job->surfaces[i];
        if (!is_exported(job, i)) continue;
        name_mesh(job, i, names[count]);
        objects[count] = (iso_mesh_object){.weld = &welds[count],
                                           .transform = iso_grid_transform(&surface->scene.grid),
                                           .name = names[count],
                                           .color = &surface->color,
                                           .opacity = (double)surface->translucency.opacity};
        const iso_coloring *coloring = isorender_colorings_exported(job, surface, "--mesh");
        status = isorender_mesh_weld(job, surface, coloring, &welds[count], error);
        count++;
    }
    if (status == ISO_OK) status = iso_mesh_write_objects(job->plan->mesh, objects, count, comment, error);
    for (int i = 0; i < count; i++) iso_weld_free(&welds[i]);
    if (status == ISO_OK) job->mesh_written = true;
    return status;
}

static iso_status export_points(isorender_job *job, const char *comment, iso_error *error) {
    iso_point_view view = iso_scene_surface_points(&job->surfaces[0].scene);
    if (job->loader.has_points) view.opacities = job->cloud.discs.opacities; /* also when drawn opaque */
    const iso_coloring *coloring = isorender_colorings_exported(job, &job->surfaces[0], "--points");
    return iso_solid_write_points(job->plan->points, &view, coloring, job->pool, comment, error);
}

iso_status isorender_export(isorender_job *job, iso_error *error) {
    char comment[64];
    const iso_program *program = isorender_program();
    snprintf(comment, sizeof comment, "%s %s", program->name, program->version);
    if (job->chunks) return isorender_chunks_export(job, comment, error);
    if (job->segmentation && job->plan->mesh && !job->input_surface_count)
        return isorender_label_meshes_write(job, comment, error);
    if (job->plan->points) {
        ISO_TRY(export_points(job, comment, error));
        job->points_written = true;
    }
    if (job->plan->mesh) ISO_TRY(export_meshes(job, comment, error));
    return measure_meshes(job, error);
}
