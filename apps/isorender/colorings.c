/* colorings: --surface-color-by, from its words to the colorings of surfaces and meshes. */
#include "apps/isorender/colorings.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "apps/isorender/picture_record.h"

/* One value of the option with what it names. */
typedef struct color_source {
    const iso_coloring_settings *settings;
    iso_color_file file; /* not opened if none is named */
    iso_color_table table;
    bool ranged; /* its range is known: given, or that of the first thing that it colours */
    iso_color_bar bar;
    size_t points, found; /* vertices of what it colours, and those where it has a number */
} color_source;

typedef struct isorender_colorings {
    color_source sources[ISORENDER_COLORINGS];
    int count;
    iso_vertex_field *fields[ISO_CUT_THINGS]; /* by number of the thing: of numbers of vertices */
    iso_coloring *things; /* by number of the surface, then of the object; NULL: not made */
    int *source_of;       /* the same: the place in `sources`; -1: in its own colour */
} isorender_colorings;

/* Whether its colours stand for no numbers that a bar could show. */
static bool has_own_colors(const color_source *source) {
    return source->settings->source == ISO_COLOR_BY_NORMAL || source->file.vertices.colors;
}

/* ---- options */

iso_status isorender_apply_surface_color_by(void *target, const char *value, iso_error *error) {
    isorender_settings *settings = target;
    if (settings->coloring_count == ISORENDER_COLORINGS)
        return iso_fail(error, ISO_ERR_USAGE, "more than %d", ISORENDER_COLORINGS);
    ISO_TRY(iso_coloring_settings_parse(value, &settings->colorings[settings->coloring_count], error));
    settings->object_options.colorings = ++settings->coloring_count;
    return ISO_OK;
}

/* The number of things whose --colormap and --range come before those of colorings. */
static int columns_of(const isorender_object_options *options) {
    int count = options->has_cloud;
    for (int i = 0; i < options->count; i++) count += options->kinds[i] != ISO_OBJECT_MESH;
    return count;
}

/* A word that is no file's name is an array of the input. */
static void take_array(const isorender_settings *settings, iso_coloring_settings *coloring) {
    if (coloring->source != ISO_COLOR_BY_VOLUME || coloring->rest[0] || strpbrk(coloring->path, "/:.") ||
        settings->no_input || settings->input_count != 1 || access(coloring->path, F_OK) == 0 ||
        strlen(settings->inputs[0]) >= sizeof coloring->path ||
        strlen(coloring->path) >= sizeof coloring->rest)
        return;
    memcpy(coloring->rest, coloring->path, strlen(coloring->path) + 1);
    memcpy(coloring->path, settings->inputs[0], strlen(settings->inputs[0]) + 1);
}

static iso_status deal(isorender_settings *settings, int i, iso_error *error) {
    iso_coloring_settings *coloring = &settings->colorings[i];
    take_array(settings, coloring);
    const isorender_object_options *options = &settings->object_options;
    const int number = columns_of(options) + i;
    ISO_TRY(iso_colormap_choice_parse(isorender_value_for(&options->maps, number), &coloring->map, error));
    ISO_TRY(iso_range_parse(isorender_value_for(&options->ranges, number), coloring->range, error));
    return ISO_OK;
}

iso_status isorender_colorings_check(isorender_settings *settings, iso_error *error) {
    const bool translucent = isorender_is_translucent(settings);
    for (int i = 0; i < settings->coloring_count; i++) ISO_TRY(deal(settings, i, error));
    if (!settings->coloring_count) return ISO_OK;
    if (settings->object_options.has_cloud)
        return iso_fail(error, ISO_ERR_USAGE,
                        "--surface-color-by colours isosurfaces and meshes: --color-by colours points");
    ISO_TRY(isorender_method_require(
        settings, translucent ? ISO_CAN_COLOR_LAYERS : ISO_CAN_COLORS,
        translucent ? "--surface-color-by of translucent surfaces" : "--surface-color-by", error));
    const char *unfit = settings->gaussians   ? "--method gaussians"
                        : settings->ior > 0   ? "--ior"
                        : settings->instances ? "--instances"
                        : settings->parts     ? "--part"
                                              : NULL;
    if (unfit) return iso_fail(error, ISO_ERR_USAGE, "--surface-color-by cannot be combined with %s", unfit);
    return ISO_OK;
}

/* ---- files */

/* Puts a file's name before a message that does not begin with it. */
static iso_status named(const char *path, iso_status status, iso_error *error) {
    char text[sizeof error->text];
    if (status == ISO_OK || strncmp(error->text, path, strlen(path)) == 0) return status;
    snprintf(text, sizeof text, "%s", error->text);
    return iso_fail(error, status, "%s: %s", path, text);
}

iso_status isorender_colorings_open(isorender_job *job, iso_error *error) {
    const isorender_settings *settings = job->settings;
    if (!settings->coloring_count) return ISO_OK;
    if (!job->colorings) job->colorings = calloc(1, sizeof *job->colorings);
    if (!job->colorings) return iso_fail(error, ISO_ERR_NOMEM, "out of memory");
    for (int i = 0; i < settings->coloring_count; i++) {
        color_source *source = &job->colorings->sources[job->colorings->count++];
        source->settings = &settings->colorings[i];
        source->file = iso_coloring_settings_file(source->settings);
        if (!source->file.path[0]) continue;
        const iso_status status = iso_color_file_open(&source->file, settings->common.input.max_memory,
                                                      job->plan->files, job->pool, error);
        ISO_TRY(named(source->file.path, status, error));
    }
    return ISO_OK;
}

static iso_status read_source(const isorender_job *job, color_source *source, iso_error *error) {
    const iso_loader *loader = &source->file.loader;
    if (!source->file.path[0]) return ISO_OK;
    ISO_TRY(iso_color_file_read(&source->file, error));
    for (int i = 0; i < loader->volume.info.note_count; i++)
        isorender_log(job, "note: %s: %s", loader->input, loader->volume.info.notes[i]);
    if (source->file.chosen)
        isorender_log(job, "%s: distances from isovalue %g (%s); distance:FILE:ISOVALUE sets it",
                      loader->input, source->file.isovalue,
                      iso_grid_is_level_set(&loader->volume.grid) ? "a level set" : "Otsu's threshold, 1979");
    return ISO_OK;
}

iso_status isorender_colorings_read(isorender_job *job, iso_error *error) {
    for (int i = 0; job->colorings && i < job->colorings->count; i++) {
        color_source *source = &job->colorings->sources[i];
        const iso_colormap_choice *map = &source->settings->map;
        if (source->bar.high > source->bar.low) continue; /* in an earlier attempt */
        ISO_TRY(named(source->settings->path, read_source(job, source, error), error));
        if (map->file) ISO_TRY(iso_color_table_read(map->file, &source->table, error));
        source->bar =
            (iso_color_bar){.map = map->map, .table = map->file ? &source->table : NULL, .low = 0, .high = 1};
        iso_coloring_settings_title(source->settings, isorender_unit(job), &source->bar);
    }
    return job->colorings ? iso_file_set_check(job->plan->files, error) : ISO_OK;
}

void isorender_colorings_free(isorender_job *job) {
    isorender_colorings *all = job->colorings;
    for (int i = 0; all && i < all->count; i++) {
        color_source *source = &all->sources[i];
        iso_color_file_close(&source->file);
        iso_color_table_free(&source->table);
    }
    for (int i = 0; all && i < ISO_CUT_THINGS; i++) iso_vertex_field_destroy(all->fields[i]);
    if (all) free(all->things);
    if (all) free(all->source_of);
    free(all);
    job->colorings = NULL;
}

/* ---- surfaces */

static bool is_surface(const isorender_job *job, int thing) {
    return thing < job->surface_count;
}

/* Why a thing cannot be coloured; NULL: it can be. */
static const char *reason_against(const isorender_job *job, const color_source *source, int thing) {
    if (is_surface(job, thing))
        return job->surfaces[thing].loader->has_points ? "it is points: --color-by colours them"
               : source->file.vertices.values          ? "it has no vertices, as a mesh of --surface has"
                                                       : NULL;
    const isorender_object *object = &job->objects[thing - job->surface_count];
    if (object->settings->kind != ISO_OBJECT_MESH || object->scene.shapes)
        return "it is lines or glyphs: --color-by colours them";
    if (source->settings->source == ISO_COLOR_BY_CURVATURE)
        return "it is a mesh, which has no field to take it from";
    return iso_scene_object_is_opaque(&object->scene) ? NULL : "it is a translucent mesh";
}

/* Whether a source colours a thing: those that it names; else the isosurfaces, or meshes if there are
 * none. */
static bool is_for(const isorender_job *job, const color_source *source, int thing) {
    if (source->settings->things.named) return iso_things_have(&source->settings->things, thing);
    return is_surface(job, thing) || (!job->surface_count && !reason_against(job, source, thing));
}

static iso_status choose_thing(isorender_job *job, int i, int thing, iso_error *error) {
    isorender_colorings *all = job->colorings;
    const color_source *source = &all->sources[i];
    const char *reason = reason_against(job, source, thing);
    if (reason)
        return iso_fail(error, ISO_ERR_USAGE, "--surface-color-by %s: @%d cannot be coloured: %s",
                        source->settings->text, thing + 1, reason);
    if (all->source_of[thing] >= 0)
        return iso_fail(error, ISO_ERR_USAGE, "--surface-color-by %s and %s both colour @%d",
                        all->sources[all->source_of[thing]].settings->text, source->settings->text,
                        thing + 1);
    all->source_of[thing] = i;
    return ISO_OK;
}

static iso_status choose_things(isorender_job *job, int things, iso_error *error) {
    for (int i = 0; i < job->colorings->count; i++) {
        const color_source *source = &job->colorings->sources[i];
        bool any = false;
        for (int thing = 0; thing < ISO_CUT_THINGS; thing++) {
            if (thing >= things && source->settings->things.named && is_for(job, source, thing))
                return iso_fail(error, ISO_ERR_USAGE,
                                "--surface-color-by %s: there is no @%d: the picture has %d thing%s",
                                source->settings->text, thing + 1, things, things == 1 ? "" : "s");
            if (thing >= things || !is_for(job, source, thing)) continue;
            ISO_TRY(choose_thing(job, i, thing, error));
            any = true;
        }
        if (!any)
            return iso_fail(error, ISO_ERR_USAGE, "--surface-color-by %s: there is no surface to be coloured",
                            source->settings->text);
    }
    return ISO_OK;
}

/* The range that the pictures of a film share becomes wider by this one, while they are measured; that of
 * depth is the first picture's. */
static void share_range(const isorender_job *job, const color_source *source) {
    const isorender_film *film = job->settings->film;
    double *range = job->settings->film->ranges[source - job->colorings->sources];
    if (!film->measuring && film->count < 2) return;
    range[0] = fmin(range[0], source->bar.low); /* (of NAN and a number the number) */
    range[1] = fmax(range[1], source->bar.high);
}

/* Sets the range of a thing's coloring if it is not known, and counts where it has numbers. */
static iso_status find_range(isorender_job *job, int thing, const iso_view *view, iso_error *error) {
    iso_coloring *coloring = &job->colorings->things[thing];
    color_source *source = &job->colorings->sources[job->colorings->source_of[thing]];
    size_t points = 0, found = 0;
    if (!source->ranged || source->settings->source == ISO_COLOR_BY_VOLUME) {
        if (is_surface(job, thing))
            ISO_TRY(iso_coloring_find_surface_range(coloring, &job->surfaces[thing].scene, view, &points,
                                                    &found, error));
        else {
            const iso_mesh_view mesh =
                iso_triangle_spans_view(&job->objects[thing - job->surface_count].scene.spans);
            ISO_TRY(iso_coloring_find_range(coloring, &mesh, view, job->pool, &points, &found, error));
        }
    }
    source->points += points;
    source->found += found;
    if (!source->ranged) source->bar = coloring->bar;
    if (!source->ranged && found) share_range(job, source);
    source->ranged |= found > 0;
    if (!source->settings->map.given)
        source->bar.map = iso_coloring_usual_map(coloring->source, &source->bar);
    coloring->bar = source->bar;
    return ISO_OK;
}

/* Says where there is nothing to be coloured by, and what the ranges are. */
static void log_source(const isorender_job *job, const color_source *source) {
    const char *text = source->settings->text;
    if (has_own_colors(source)) return;
    if (source->points && !source->found)
        isorender_log(
            job, "note: --surface-color-by %s: there are no values where the surface is: it is gray", text);
    else if (source->found < source->points)
        isorender_log(job,
                      "note: --surface-color-by %s: %.3g %% of the surface lies outside the volume, or where "
                      "there are no finite values: gray",
                      text, 100 - 100.0 * (double)source->found / (double)source->points);
    if (isnan(source->settings->range[0]) && source->ranged && !(source->bar.high > source->bar.low))
        isorender_log(job, "note: --surface-color-by %s: it is %g everywhere on the surface", text,
                      source->bar.low);
    else if (isnan(source->settings->range[0]) && source->ranged)
        isorender_log(job, "--surface-color-by %s: --range %.6g,%.6g (2nd to 98th percentile%s)", text,
                      source->bar.low, source->bar.high,
                      !iso_color_source_is_signed(source->settings->source) ? ""
                      : source->bar.low < 0 && source->bar.high > 0         ? ", on both sides of 0"
                                                                    : ", from 0 on: they have one sign");
}

/* The numbers of a mesh's vertices on the mesh. */
static iso_status make_field(isorender_job *job, const color_source *source, int thing, iso_error *error) {
    const isorender_object *object = &job->objects[thing - job->surface_count];
    const iso_vertex_values *given = &source->file.vertices;
    iso_vertex_field **field = &job->colorings->fields[thing];
    if (given->count != object->file.mesh.vertex_count)
        return iso_fail(error, ISO_ERR_FORMAT, "%s: has numbers of %zu vertices: %s has %zu",
                        source->settings->path, given->count, object->settings->path,
                        object->file.mesh.vertex_count);
    iso_vertex_field_destroy(*field);
    *field = NULL;
    return iso_vertex_field_create(&object->file.mesh, given->values, (const uint8_t(*)[3])given->colors,
                                   field, error);
}

static iso_coloring make_coloring(const isorender_job *job, const color_source *source, int thing) {
    iso_coloring coloring = {
        .source = source->settings->source, .distance = source->file.distance, .bar = source->bar};
    coloring.vertices = source->file.vertices.values ? job->colorings->fields[thing] : NULL;
    if (source->file.has_volume && coloring.source == ISO_COLOR_BY_VOLUME)
        iso_coloring_set_grid(&coloring, &source->file.loader.volume.grid);
    if (coloring.source == ISO_COLOR_BY_CURVATURE)
        iso_coloring_set_grid(&coloring, &job->surfaces[thing].scene.grid);
    return coloring;
}

static void set_given_range(const isorender_job *job, color_source *source) {
    const isorender_film *film = job->settings->film;
    const double *range = source->settings->range;
    if (isnan(range[0]) && !film->measuring) range = film->ranges[source - job->colorings->sources];
    if (isnan(range[0])) return;
    source->ranged = true;
    source->bar.low = range[0];
    source->bar.high = range[1];
}

/* ---- paint */

/* Why surfaces cannot be drawn with their paint; NULL: they can. */
static const char *reason_against_paint(const isorender_job *job, iso_error *denied) {
    const isorender_settings *settings = job->settings;
    const iso_capability needed = job->translucent ? ISO_CAN_COLOR_LAYERS : ISO_CAN_COLORS;
    if (settings->ior > 0) return "glass has none";
    if (settings->instances) return "--instances have none";
    if (settings->parts) return "surfaces of --part have none";
    const char *what = job->translucent ? "it on translucent surfaces" : "it";
    return iso_renderer_require(job->renderer, needed, "--method", what, denied) == ISO_OK ? NULL
                                                                                           : denied->text;
}

/* Whether the paint of a surface's file colours it, rather than --surface-color-by, or --color, which is for
 * what is not painted only where the file tells that. */
static bool is_painted(const isorender_job *job, const isorender_surface *surface) {
    const iso_loader *loader = surface->loader;
    return !job->chunks && !surface->label_group && !surface->scene.coloring &&
           iso_painted_any(&loader->painted) && (loader->has_strokes || !surface->color_given);
}

static void paint_surfaces(isorender_job *job) {
    iso_error denied = {ISO_OK, ""};
    bool any = false;
    for (int i = 0; i < job->surface_count; i++) any |= is_painted(job, &job->surfaces[i]);
    const char *reason = any ? reason_against_paint(job, &denied) : NULL;
    if (reason && !job->settings->film->first)
        isorender_log(job, "note: drawn without its paint: %s", reason);
    for (int i = 0; i < job->surface_count && !reason; i++) {
        isorender_surface *surface = &job->surfaces[i];
        if (!is_painted(job, surface)) continue;
        surface->painted = surface->loader->painted;
        surface->painted.own = surface->color;
        surface->paint = iso_painted_coloring(&surface->painted);
        surface->scene.coloring = &surface->paint;
    }
}

/* ---- the colorings of a picture */

static iso_status make_colorings(isorender_job *job, iso_error *error) {
    isorender_colorings *all = job->colorings;
    const int things = job->surface_count + job->object_count;
    if (!all) return ISO_OK;
    if (job->chunks)
        return iso_fail(
            error, ISO_ERR_USAGE,
            "--surface-color-by colours volumes in memory: this one is drawn in chunks (--max-memory)");
    free(all->things);
    free(all->source_of);
    all->things = calloc((size_t)things + 1, sizeof *all->things);
    all->source_of = calloc((size_t)things + 1, sizeof *all->source_of);
    if (!all->things || !all->source_of) return iso_fail(error, ISO_ERR_NOMEM, "out of memory");
    for (int i = 0; i < things; i++) all->source_of[i] = -1;
    ISO_TRY(choose_things(job, things, error));
    for (int i = 0; i < all->count; i++) set_given_range(job, &all->sources[i]);
    for (int i = 0; i < things; i++) {
        if (all->source_of[i] < 0) continue;
        const color_source *source = &all->sources[all->source_of[i]];
        if (source->file.vertices.values) ISO_TRY(make_field(job, source, i, error));
        all->things[i] = make_coloring(job, source, i);
        if (source->settings->source != ISO_COLOR_BY_DEPTH) ISO_TRY(find_range(job, i, NULL, error));
        if (is_surface(job, i))
            job->surfaces[i].scene.coloring = &all->things[i];
        else
            job->objects[i - job->surface_count].scene.coloring = &all->things[i];
    }
    for (int i = 0; i < all->count; i++)
        if (all->sources[i].settings->source != ISO_COLOR_BY_DEPTH) log_source(job, &all->sources[i]);
    return ISO_OK;
}

iso_status isorender_colorings_make(isorender_job *job, iso_error *error) {
    ISO_TRY(make_colorings(job, error));
    paint_surfaces(job);
    return ISO_OK;
}

iso_status isorender_colorings_see(isorender_job *job, iso_error *error) {
    isorender_colorings *all = job->colorings;
    if (!all) return ISO_OK;
    const iso_view view = iso_view_make(&job->camera, job->settings->width, job->settings->height);
    for (int i = 0; i < job->surface_count + job->object_count; i++) {
        if (all->source_of[i] < 0 || all->things[i].source != ISO_COLOR_BY_DEPTH) continue;
        color_source *source = &all->sources[all->source_of[i]];
        ISO_TRY(find_range(job, i, &view, error));
        log_source(job, source);
    }
    return ISO_OK;
}

/* ---- exports, bars, reports */

const iso_coloring *isorender_colorings_exported(const isorender_job *job, const isorender_surface *colored,
                                                 const char *option) {
    const iso_coloring *coloring = colored->scene.coloring;
    if (!coloring || coloring->source != ISO_COLOR_BY_DEPTH) return coloring;
    isorender_log(job, "note: %s gets no colours by depth, which are of a picture", option);
    return NULL;
}

int isorender_colorings_bars(const isorender_job *job, iso_color_bar bars[ISORENDER_COLORINGS]) {
    int count = 0;
    for (int i = 0; job->colorings && i < job->colorings->count; i++)
        if (!has_own_colors(&job->colorings->sources[i])) bars[count++] = job->colorings->sources[i].bar;
    return count;
}

void isorender_colorings_report(iso_json *json, const isorender_job *job) {
    static const char *const names[] = {"volume", "curvature", "distance", "depth", "normal"};
    if (!job->colorings) return;
    iso_json_begin_array(json, "surface_colors");
    for (int i = 0; i < job->colorings->count; i++) {
        const color_source *source = &job->colorings->sources[i];
        const iso_coloring_settings *settings = source->settings;
        iso_json_begin_object(json, NULL);
        iso_json_string(json, "by", source->file.vertices.values ? "vertices" : names[settings->source]);
        if (settings->path[0]) iso_json_string(json, "path", settings->path);
        if (source->file.has_volume) iso_json_string(json, "name", source->file.loader.volume.info.name);
        if (source->file.has_volume && source->file.distance)
            iso_json_real(json, "isovalue", source->file.isovalue);
        if (!has_own_colors(source)) {
            const double range[2] = {source->bar.low, source->bar.high};
            iso_json_reals(json, "range", range, 2);
            iso_json_string(json, "colormap",
                            settings->map.file ? settings->map.file : iso_colormap_name(source->bar.map));
        }
        if (source->points) iso_json_real(json, "covered", (double)source->found / (double)source->points);
        iso_json_end_object(json);
    }
    iso_json_end_array(json);
}
