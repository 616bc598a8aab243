/* segmentation: from a file of labels to surfaces of the scene. */
#include "apps/isorender/segmentation.h"

#include <fnmatch.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "apps/isorender/cuts.h"
#include "apps/isorender/label_items.h"
#include "apps/isorender/label_table.h"
#include "grids/scenes/scenes.h"

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
    const char *unfit = !given                            ? NULL
                        : settings->ior > 0               ? "--ior"
                        : settings->parts                 ? "--part"
                        : settings->instances             ? "--instances"
                        : settings->ranks.mpi             ? "mpirun"
                        : settings->chunk_size            ? "--chunk-size"
                        : settings->absorption_length > 0 ? "--absorption"
                                                          : NULL;
    if (unfit) return iso_fail(error, ISO_ERR_USAGE, "labels cannot be combined with %s", unfit);
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

static iso_status open_file(isorender_job *job, isorender_segmentation *s, iso_error *error) {
    s->input = job->settings->common.input;
    if (!job->settings->smooth) s->input = (iso_input){.max_memory = s->input.max_memory};
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

/* ---- layers: components with segments of their own, which may overlap */

typedef struct layers {
    uint16_t *voxels; /* numbers of segments, from 1; 0: none */
    size_t overlaps;
} layers;

/* Adds the segments of a layer to the voxels. */
static void add_layer(const iso_label_names *stated, int layer, const iso_labels *labels, layers *all) {
    const size_t count = (size_t)labels->dims[0] * (size_t)labels->dims[1] * (size_t)labels->dims[2];
    for (size_t i = 0; i < count; i++) {
        if (!labels->number[i]) continue;
        const iso_label_name *name =
            iso_label_names_find(stated, layer, labels->label[labels->number[i]].value);
        if (!name) continue;
        all->overlaps += all->voxels[i] != 0;
        all->voxels[i] = (uint16_t)(name - stated->items + 1);
    }
}

static iso_status read_layer(isorender_job *job, isorender_segmentation *s, int layer, layers *all,
                             iso_error *error) {
    iso_input input = s->input;
    iso_loader loader = {.input = s->loader.input, .options = &input, .pool = job->pool, .is_further = true};
    iso_labels labels = {.count = 0};
    input.component = layer;
    iso_status status = layer ? iso_loader_open(&loader, error) : ISO_OK;
    if (status == ISO_OK && layer) status = iso_loader_read(&loader, error);
    if (status == ISO_OK)
        status =
            iso_labels_make(layer ? &loader.volume.grid : &s->loader.volume.grid, job->pool, &labels, error);
    if (status == ISO_OK) add_layer(&s->stated, layer, &labels, all);
    iso_labels_free(&labels);
    if (layer) iso_loader_close(&loader);
    return status;
}

/* Reads the segments of all layers into one volume of their numbers. */
static iso_status read_layers(isorender_job *job, isorender_segmentation *s, iso_error *error) {
    const iso_volume_info *info = &s->loader.volume.info;
    const iso_rgrid_desc desc = {.dims = {info->dims[0], info->dims[1], info->dims[2]},
                                 .type = ISO_UINT16,
                                 .transform = iso_grid_transform(&s->loader.volume.grid)};
    iso_grid grid = {NULL, NULL};
    ISO_TRY(iso_rgrid_create(&desc, &grid.rgrid, error));
    layers all = {grid.rgrid->data, 0};
    memset(all.voxels, 0,
           (size_t)info->dims[0] * (size_t)info->dims[1] * (size_t)info->dims[2] * sizeof *all.voxels);
    iso_status status = ISO_OK;
    for (int layer = 0; layer < info->components && status == ISO_OK; layer++)
        status = read_layer(job, s, layer, &all, error);
    if (status != ISO_OK) {
        iso_grid_destroy(&grid);
        return status;
    }
    iso_grid_destroy(&s->loader.volume.grid);
    s->loader.volume.grid = grid;
    s->layered = true;
    const char *colon, *name = note_name(job, &colon);
    isorender_log(job, "note: %s%ssegments of %d layers, numbered in the order of the file", name, colon,
                  info->components);
    if (all.overlaps)
        isorender_log(
            job, "note: %s%s%zu voxels belong to several segments: that of the last layer is drawn there",
            name, colon, all.overlaps);
    return ISO_OK;
}

/* Reads what the file states of its labels; of segments in layers the other layers, unless one is chosen. */
static iso_status read_stated(isorender_job *job, isorender_segmentation *s, iso_error *error) {
    if (iso_loader_is_scene(s->loader.input)) return ISO_OK;
    ISO_TRY(iso_label_names_of_file(s->loader.path, &s->stated, error));
    const bool chosen = s->input.component > 0 || s->input.channel || s->input.cropped || s->input.cropped_mm;
    if (s->loader.volume.info.components < 2 || !s->stated.count || chosen) return ISO_OK;
    return read_layers(job, s, error);
}

iso_status isorender_segmentation_read(isorender_job *job, iso_error *error) {
    isorender_segmentation *s = job->segmentation;
    if (!s) return ISO_OK;
    ISO_TRY(named(job, iso_loader_read(&s->loader, error), error));
    const iso_volume_info *info = &s->loader.volume.info;
    ISO_TRY(named(job, read_stated(job, s, error), error));
    const char *colon, *name = note_name(job, &colon);
    for (int i = 0; i < info->note_count && !s->layered; i++)
        isorender_log(job, "note: %s%s%s", name, colon, info->notes[i]);
    return ISO_OK;
}

/* ---- names, colours, and what is drawn */

/* What the file states of a label; NULL: nothing. */
static const iso_label_name *stated_name(const isorender_segmentation *s, int value) {
    if (!s->layered) return iso_label_names_find(&s->stated, s->loader.component, value);
    return value > 0 && value <= s->stated.count ? &s->stated.items[value - 1] : NULL;
}

/* Names and colours of the table, then of the file, then usual ones. */
static iso_status name_labels(isorender_job *job, isorender_segmentation *s, iso_error *error) {
    iso_label_names table = {0};
    const char *path = job->settings->label_table;
    if (path) ISO_TRY(iso_label_names_read(path, &table, error));
    int beyond = 0, first = 0;
    for (int i = 0; i < s->labels.count; i++) {
        const int value = s->labels.label[i].value;
        isorender_label *item = &s->items[i];
        *item = (isorender_label){.color = iso_label_usual_color(value), .opacity = i > 0};
        snprintf(item->name, sizeof item->name, "label %d", value);
        const iso_label_name *name = iso_label_names_find(&table, 0, value);
        if (path && !name && i) first = beyond++ ? first : value;
        if (!name) name = stated_name(s, value);
        const char *organ = strncmp(s->loader.input, "scene:organs", 12) ? NULL : iso_scene_organ_name(value);
        if (organ) snprintf(item->name, sizeof item->name, "%s", organ);
        if (name && name->name[0]) snprintf(item->name, sizeof item->name, "%s", name->name);
        if (name && name->colored) item->color = name->color;
    }
    if (beyond)
        isorender_log(job, "note: %s has no row for %d label%s (%d%s): coloured by number", path, beyond,
                      beyond > 1 ? "s" : "", first, beyond > 1 ? ", .." : "");
    iso_label_names_free(&table);
    return ISO_OK;
}

/* Makes groups: 1 of all opaque labels, if there are some, and one of each translucent label. Returns their
 * number. */
static int make_groups(isorender_segmentation *s) {
    int opaque = 0, groups;
    for (int i = 1; i < s->labels.count; i++) opaque += s->items[i].opacity >= 1;
    groups = opaque > 0;
    for (int i = 0; i < s->labels.count; i++) {
        const double opacity = s->items[i].opacity;
        const bool translucent = i && opacity > 0 && opacity < 1;
        if (translucent) groups++;
        s->group[i] = !i || !(opacity > 0) || groups > ISO_LABEL_GROUPS ? 0
                      : translucent                                     ? (uint8_t)groups
                                                                        : 1;
        s->colors[i] = s->items[i].color;
    }
    return groups;
}

static iso_status make_items(isorender_job *job, isorender_segmentation *s, iso_error *error) {
    const size_t count = (size_t)s->labels.count;
    s->items = calloc(count, sizeof *s->items);
    s->group = calloc(count, 1);
    s->colors = calloc(count, sizeof *s->colors);
    if (!s->items || !s->group || !s->colors) return iso_fail(error, ISO_ERR_NOMEM, "out of memory");
    ISO_TRY(name_labels(job, s, error));
    const isorender_settings *settings = job->settings;
    for (int i = 1; i < s->labels.count && settings->smooth; i++) {
        if (settings->color_count) s->items[i].color = settings->colors[0];
        if (settings->opacity_count) s->items[i].opacity = settings->opacities[0];
    }
    return isorender_label_items_apply(&settings->label_items, &s->labels, s->items, error);
}

/* ---- surfaces */

static void add_surface(isorender_job *job, isorender_segmentation *s, int group) {
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
    if (count < 2 && !job->settings->aov) return;
    s->shared = (iso_label_colors){s->fields, s->labels.label, group, s->colors};
    if (surface->translucency.opacity >= 1) surface->scene.labels = &s->shared;
}

/* Refuses the many values of a scan, whose neighbours along x mostly differ: to draw them as labels takes
 * minutes
 * and shows nothing. Who names labels means them. */
static iso_status check_plateaus(const isorender_job *job, const isorender_segmentation *s,
                                 iso_error *error) {
    enum { FEW = 64 };
    const iso_labels *labels = &s->labels;
    uint64_t pairs = 0, equal = 0;
    if (labels->count <= FEW || job->settings->label_items.count || job->settings->label_table ||
        s->stated.count)
        return ISO_OK;
    /* (pairs of neighbours that are both background count as none) */
    pairs = (uint64_t)(labels->dims[0] - 1) * (uint64_t)labels->dims[1] * (uint64_t)labels->dims[2] -
            (labels->label[0].voxels - labels->label[0].runs);
    for (int i = 1; i < labels->count; i++) equal += labels->label[i].voxels - labels->label[i].runs;
    if (2 * equal >= pairs) return ISO_OK;
    return iso_fail(error, ISO_ERR_USAGE,
                    "these are %d values of which neighbours mostly differ, as in a scan, not labels: its "
                    "surface is drawn without %s (--label all draws each value as a label all the same)",
                    labels->count - 1, job->settings->smooth ? "--smooth" : "--labels");
}

/* Where the labels' surfaces are smooth. */
static int places_of(const isorender_job *job) {
    const int inside = isorender_has_caps(job->settings) ? ISO_LABELS_INSIDE : ISO_LABELS_DRAWN;
    const bool trilinear = job->method == ISO_METHOD_EXACT || job->method == ISO_METHOD_RAYCAST ||
                           job->method == ISO_METHOD_MESH;
    const bool drawn = trilinear && !job->settings->filter && !job->settings->coloring_count;
    return inside + (drawn ? ISO_LABELS_DRAWN : ISO_LABELS_BAND);
}

static iso_status make_surfaces(isorender_job *job, isorender_segmentation *s, iso_error *error) {
    ISO_TRY(iso_labels_make(&s->loader.volume.grid, job->pool, &s->labels, error));
    iso_grid_destroy(&s->loader.volume.grid);
    ISO_TRY(check_plateaus(job, s, error));
    ISO_TRY(make_items(job, s, error));
    const int groups = make_groups(s), most = ISORENDER_SURFACES - job->surface_count;
    if (!groups)
        return iso_fail(error, ISO_ERR_EMPTY,
                        s->labels.count > 1 ? "no label is drawn: all opacities are 0"
                                            : "no label is in it: every voxel is 0");
    if (groups > most || groups > ISO_LABEL_GROUPS)
        return iso_fail(error, ISO_ERR_USAGE,
                        "%d translucent labels: up to %d have surfaces of their own; opaque ones share one",
                        groups, most < ISO_LABEL_GROUPS ? most : ISO_LABEL_GROUPS);
    ISO_TRY(
        iso_label_fields_make(&s->labels, s->group, groups, places_of(job), job->pool, &s->fields, error));
    for (int g = 1; g <= groups; g++) add_surface(job, s, g);
    return isorender_label_table_write(job, error);
}

iso_status isorender_segmentation_add(isorender_job *job, iso_error *error) {
    isorender_segmentation *s = job->segmentation;
    return s ? named(job, make_surfaces(job, s, error), error) : ISO_OK;
}

void isorender_segmentation_free(isorender_job *job) {
    isorender_segmentation *s = job->segmentation;
    if (!s) return;
    iso_label_fields_destroy(s->fields);
    iso_labels_free(&s->labels);
    iso_label_names_free(&s->stated);
    iso_loader_close(&s->loader);
    free(s->items);
    free(s->group);
    free(s->colors);
    free(s);
    job->segmentation = NULL;
}

/* ---- what is told of them */

int isorender_legend(const isorender_job *job, int room, iso_legend_entry *entries, int *all) {
    const isorender_segmentation *s = job->segmentation;
    *all = 0;
    for (int i = 1; s && i < s->labels.count; i++) {
        if (!s->group[i]) continue;
        if (*all < room) entries[*all] = (iso_legend_entry){s->items[i].name, s->items[i].color};
        ++*all;
    }
    return *all < room ? *all : room;
}

void isorender_report_labels(iso_json *json, const isorender_job *job) {
    const isorender_segmentation *s = job->segmentation;
    if (!s) return;
    iso_json_begin_array(json, "labels");
    for (int i = 1; i < s->labels.count; i++) {
        char color[8];
        const isorender_label *item = &s->items[i];
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
}

/* ---- whether an input is labels */

enum { FOUND_MOST = 256, ROW_STEP = 3 };

typedef struct found_labels {
    bool present[FOUND_MOST + 1];
    uint64_t pairs, equal; /* of neighbours along x of which one at least is not 0 */
} found_labels;

/* False: a voxel is no whole number up to FOUND_MOST. */
static bool look_at_row(const iso_rgrid *grid, int y, int z, found_labels *found) {
    int before = -1;
    for (int x = 0; x < grid->dims[0]; x++) {
        const double value = (double)iso_rgrid_at(grid, x, y, z) * grid->scale + grid->offset;
        if (!(value >= 0 && value <= FOUND_MOST && value == floor(value))) return false;
        const int label = (int)value;
        found->present[label] = true;
        if (before > 0 || (before == 0 && label)) {
            found->pairs++;
            found->equal += before == label;
        }
        before = label;
    }
    return true;
}

void isorender_segmentation_note(const isorender_job *job) {
    const iso_rgrid *grid = job->loader.volume.grid.rgrid;
    found_labels found = {.pairs = 0};
    if (!grid || grid->level_set || job->chunks || iso_loader_is_scene(job->loader.input)) return;
    for (int z = 0; z < grid->dims[2]; z += ROW_STEP)
        for (int y = 0; y < grid->dims[1]; y += ROW_STEP)
            if (!look_at_row(grid, y, z, &found)) return;
    int values = 0, last = 0;
    for (int i = 0; i <= FOUND_MOST; i++)
        if (found.present[i]) values++, last = i;
    if (values == 2 && found.present[0])
        isorender_log(job, "note: this is a mask (0 and %d): --smooth draws it without steps", last);
    else if (values > 2 && found.present[0] && (double)found.equal >= 0.8 * (double)found.pairs)
        isorender_log(job,
                      "note: these seem to be %d labels (up to %d): --smooth draws each as a smooth surface",
                      values - 1, last);
}
