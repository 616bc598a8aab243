/* segmentation: from a file of labels to surfaces of the scene. */
#include "apps/isorender/segmentation.h"

#include <stdlib.h>
#include <string.h>

#include "apps/common/json_parts.h"
#include "apps/isorender/cuts.h"
#include "apps/isorender/label_items.h"
#include "apps/isorender/label_table.h"
#include "base/file.h"

const char *isorender_labels_path(const isorender_job *job) {
    return job->settings->smooth ? job->plan->input : job->settings->labels;
}

iso_status isorender_segmentation_check(const isorender_settings *settings, iso_error *error) {
    const bool given = settings->labels || settings->smooth;
    const char *needs = settings->label_items.count ? "--label"
                        : settings->label_table     ? "--label-table"
                        : settings->table           ? "--table"
                                                    : NULL;
    if (!given && needs)
        return iso_fail(error, ISO_ERR_USAGE, "%s is for labels: it needs --labels FILE or --smooth", needs);
    if (settings->labels && settings->smooth)
        return iso_fail(error, ISO_ERR_USAGE,
                        "--smooth draws the input as labels, --labels another file: give one of them");
    for (int i = 0; settings->labels && i < settings->input_count; i++)
        if (settings->inputs[i] != settings->labels && /* which is the input where there is no other */
            iso_file_same(settings->labels, settings->inputs[i]))
            return iso_fail(
                error, ISO_ERR_USAGE,
                "--labels %s: is the input, whose isosurface would be in the way: --smooth draws its labels",
                settings->labels);
    const char *unfit = !given                            ? NULL
                        : settings->ior > 0               ? "--ior"
                        : settings->parts                 ? "--part"
                        : settings->instances             ? "--instances"
                        : settings->ranks.mpi             ? "mpirun"
                        : settings->chunk_size            ? "--chunk-size"
                        : settings->absorption_length > 0 ? "--absorption"
                                                          : NULL;
    if (unfit)
        return iso_fail(
            error, ISO_ERR_USAGE, "labels cannot be combined with %s%s", unfit,
            settings->segments ? ": the file names segments, of which --isovalue draws isosurfaces" : "");
    return isorender_label_items_check(&settings->label_items, error);
}

/* Puts the file's name before a message. */
static iso_status named(const isorender_job *job, iso_status status, iso_error *error) {
    const char *path = isorender_labels_path(job);
    char text[sizeof error->text];
    if (status == ISO_OK || strncmp(error->text, path, strlen(path)) == 0) return status;
    snprintf(text, sizeof text, "%s", error->text);
    return iso_fail(error, status, "%s: %s", path, text);
}

static iso_status open_file(isorender_job *job, iso_segmentation *s, iso_error *error) {
    s->input = job->settings->common.input;
    if (!job->settings->smooth && !job->settings->no_input) /* these options are the input's */
        s->input = (iso_input){.max_memory = s->input.max_memory};
    s->loader = (iso_loader){.input = isorender_labels_path(job),
                             .options = &s->input,
                             .files = job->plan->files,
                             .pool = job->pool,
                             .is_further = !job->settings->smooth};
    ISO_TRY(iso_loader_open(&s->loader, error));
    if (!s->loader.has_points) return ISO_OK;
    return iso_fail(error, ISO_ERR_USAGE, "holds points: labels are a volume of whole numbers");
}

iso_status isorender_segmentation_open(isorender_job *job, iso_error *error) {
    if (!isorender_labels_path(job)) return ISO_OK;
    job->segmentation = calloc(1, sizeof *job->segmentation);
    if (!job->segmentation) return iso_fail(error, ISO_ERR_NOMEM, "out of memory");
    return named(job, open_file(job, job->segmentation, error), error);
}

/* What notes on the file begin with: its name, unless that is the input's, which they have already. */
static const char *note_name(const isorender_job *job, const char **colon) {
    const char *path = isorender_labels_path(job);
    const bool is_input = strcmp(path, job->plan->input) == 0;
    *colon = is_input ? "" : ": ";
    return is_input ? "" : path;
}

iso_status isorender_segmentation_read(isorender_job *job, iso_error *error) {
    iso_segmentation *s = job->segmentation;
    if (!s) return ISO_OK;
    ISO_TRY(named(job, iso_segmentation_read(s, error), error));
    const iso_volume_info *info = &s->loader.volume.info;
    if (job->settings->segments)
        isorender_log(job, "note: drawn as labels, since it names segments: --isovalue draws isosurfaces");
    const char *colon, *name = note_name(job, &colon);
    if (s->layered)
        isorender_log(job, "note: %s%ssegments of %d layers, numbered in the order of the file", name, colon,
                      info->components);
    if (s->overlaps)
        isorender_log(
            job, "note: %s%s%zu voxels belong to several segments: that of the last layer is drawn there",
            name, colon, s->overlaps);
    for (int i = 0; i < info->note_count && !s->layered; i++)
        isorender_log(job, "note: %s%s%s", name, colon, info->notes[i]);
    return ISO_OK;
}

/* ---- what is drawn */

static iso_status make_items(isorender_job *job, iso_segmentation *s, iso_error *error) {
    const isorender_settings *settings = job->settings;
    int missing, first;
    ISO_TRY(iso_segmentation_name(s, settings->label_table, &missing, &first, error));
    if (!settings->label_items.count && !settings->label_table && iso_segmentation_is_scan(s))
        return iso_fail(
            error, ISO_ERR_USAGE,
            "these are %d values of which neighbours mostly differ, as in a scan, not labels: its "
            "surface is drawn without %s (--label all draws each value as a label all the same)",
            s->labels.count - 1, settings->smooth ? "--smooth" : "--labels");
    if (s->parts.kept)
        isorender_log(job, "kept %zu of %zu parts of the labels, dropped %zu with %.3g %% of their voxels",
                      s->parts.kept, s->parts.kept + s->parts.dropped, s->parts.dropped,
                      100 * s->parts.dropped_share);
    if (missing)
        isorender_log(job, "note: %s has no row for %d label%s (%d%s): coloured by number",
                      settings->label_table, missing, missing > 1 ? "s" : "", first,
                      missing > 1 ? ", .." : "");
    for (int i = 1; i < s->labels.count && settings->smooth; i++) {
        if (settings->color_count) s->items[i].color = settings->colors[0];
        if (settings->opacity_count) s->items[i].opacity = settings->opacities[0];
    }
    return isorender_label_items_apply(&settings->label_items, &s->labels, s->items, error);
}

/* ---- surfaces */

static void add_surface(isorender_job *job, iso_segmentation *s, int group) {
    isorender_surface *surface = &job->surfaces[job->surface_count++];
    int count = 0, only = 0;
    for (int i = 1; i < s->labels.count; i++)
        if (s->group[i] == group) only = i, count++;
    surface->loader = &s->loader;
    surface->label_group = group;
    surface->scene = (iso_scene_surface){.grid = {.hgrid = iso_label_fields_grid(s->fields, group)},
                                         .isovalue = 0,
                                         .pool = job->pool,
                                         .transparency = (iso_transparency)job->settings->transparency,
                                         .grouping = isorender_grouping(job->settings),
                                         .bins = job->settings->group_bins,
                                         .selection = (iso_point_selection)job->settings->selection,
                                         .borders = true,
                                         .filter = (iso_filter)job->settings->filter,
                                         .lod_pixels = isorender_detail_pixels(job->settings),
                                         .workspace = job->point_workspace};
    surface->color = s->items[only].color;
    surface->translucency = isorender_translucency(job->settings, s->items[only].opacity);
    job->translucent |= surface->translucency.opacity < 1;
    if (surface->translucency.opacity >= 1 && (count > 1 || job->settings->aov))
        surface->scene.labels = &s->shared;
}

/* Where the labels' surfaces are smooth. */
static int places_of(const isorender_job *job) {
    const int inside = isorender_has_caps(job->settings) ? ISO_LABELS_INSIDE : ISO_LABELS_DRAWN;
    const bool trilinear = !(job->renderer->needs & 1u << ISO_PART_POINTS);
    const bool drawn = trilinear && !job->settings->filter && !job->settings->coloring_count;
    return inside + (drawn ? ISO_LABELS_DRAWN : ISO_LABELS_BAND);
}

static iso_status make_surfaces(isorender_job *job, iso_segmentation *s, iso_error *error) {
    ISO_TRY(make_items(job, s, error));
    iso_segmentation_divide(s);
    const int groups = s->groups, most = ISORENDER_SURFACES - job->surface_count;
    if (!groups)
        return iso_fail(error, ISO_ERR_EMPTY,
                        s->labels.count > 1 ? "no label is drawn: all opacities are 0"
                                            : "no label is in it: every voxel is 0");
    if (groups > most || groups > ISO_LABEL_GROUPS)
        return iso_fail(error, ISO_ERR_USAGE,
                        "%d translucent labels: up to %d have surfaces of their own; opaque ones share one",
                        groups, most < ISO_LABEL_GROUPS ? most : ISO_LABEL_GROUPS);
    ISO_TRY(iso_segmentation_make_fields(s, places_of(job), error));
    for (int g = 1; g <= groups; g++) add_surface(job, s, g);
    return isorender_label_table_write(job, error);
}

iso_status isorender_segmentation_add(isorender_job *job, iso_error *error) {
    iso_segmentation *s = job->segmentation;
    return s ? named(job, make_surfaces(job, s, error), error) : ISO_OK;
}

void isorender_segmentation_free(isorender_job *job) {
    if (job->segmentation) iso_segmentation_free(job->segmentation);
    free(job->segmentation);
    job->segmentation = NULL;
}

/* ---- what is told of them */

int isorender_legend(const isorender_job *job, int room, iso_legend_entry *entries, int *all) {
    const iso_segmentation *s = job->segmentation;
    *all = 0;
    for (int i = 1; s && i < s->labels.count; i++) {
        if (!s->group[i]) continue;
        if (*all < room) entries[*all] = (iso_legend_entry){s->items[i].name, s->items[i].color};
        ++*all;
    }
    return *all < room ? *all : room;
}

void isorender_report_labels(iso_json *json, const isorender_job *job) {
    const iso_segmentation *s = job->segmentation;
    if (!s) return;
    iso_json_begin_array(json, "labels");
    for (int i = 1; i < s->labels.count; i++) {
        char color[8];
        const iso_drawn_label *item = &s->items[i];
        snprintf(color, sizeof color, "%02X%02X%02X", item->color.r, item->color.g, item->color.b);
        iso_json_begin_object(json, NULL);
        iso_json_integer(json, "label", (uint64_t)s->labels.label[i].value);
        iso_json_string(json, "name", item->name);
        iso_json_string(json, "color", color);
        iso_json_real(json, "opacity", item->opacity);
        iso_json_integer(json, "voxels", s->labels.label[i].voxels);
        iso_json_end_object(json);
    }
    iso_json_end_array(json);
    if (s->parts.kept) iso_put_components(json, "label_parts", &s->parts);
}

void isorender_segmentation_note(const isorender_job *job) {
    const iso_rgrid *grid = job->loader.volume.grid.rgrid;
    int last;
    if (!grid || grid->level_set || job->chunks) return;
    const int values = iso_segmentation_guess(grid, &last);
    if (values == 2)
        isorender_log(job, "note: this is a mask (0 and %d): --smooth draws it without steps", last);
    else if (values)
        isorender_log(job,
                      "note: these seem to be %d labels (up to %d): --smooth draws each as a smooth surface",
                      values - 1, last);
}
