/* label: names of labels, their level sets, and the comparison of two fields at the voxels of a
 * segmentation. */
#include "source/label.h"

#include <fnmatch.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "base/file_types.h"
#include "base/memory.h"
#include "base/parse.h"
#include "grids/labels/label_fields.h"
#include "grids/labels/label_names.h"
#include "grids/volume/rewrite.h"

/* ---- names */

/* Finds the label that a name means among those of the chosen component, or of all if none is chosen. */
static const iso_label_name *find_name(const iso_label_names *names, const iso_input *input, bool *several) {
    const iso_label_name *found = NULL;
    *several = false;
    for (int i = 0; i < names->count; i++) {
        const iso_label_name *name = &names->items[i];
        if (input->component && name->layer != input->component && !input->label_table) continue;
        if (fnmatch(input->label, name->name, FNM_CASEFOLD) != 0) continue;
        *several |= found && (found->value != name->value || found->layer != name->layer);
        found = name;
    }
    return found;
}

iso_status iso_source_label_find(const char *path, iso_input *input, char number[16], iso_error *error) {
    iso_label_names names = {NULL, 0};
    int value;
    bool several = false;
    if (!iso_parse_int(input->label, &value)) {
        ISO_TRY(input->label_table ? iso_label_names_read(input->label_table, &names, error)
                                   : iso_label_names_of_file(path, &names, error));
        const iso_label_name *name = find_name(&names, input, &several);
        value = name ? name->value : 0;
        if (name && !input->label_table) input->component = name->layer;
        iso_label_names_free(&names);
    }
    if (value < 1 || value > ISO_LABEL_VALUE_MAX || several)
        return iso_fail(error, ISO_ERR_USAGE, "%s: --label %s is %s", path, input->label,
                        several ? "the name of several labels: give a number"
                                : "neither the number of a label nor a name in the file or in --label-table");
    snprintf(number, 16, "%d", value);
    input->label = number;
    return ISO_OK;
}

/* ---- the level set */

/* Fails with a message that lists the labels that there are. */
static iso_status fail_missing(const iso_source *source, const iso_labels *labels, iso_error *error) {
    char known[160] = "";
    size_t used = 0;
    for (int i = 1; i < labels->count && used + 16 < sizeof known; i++)
        used += (size_t)snprintf(known + used, sizeof known - used, "%s%d", i > 1 ? ", " : "",
                                 labels->label[i].value);
    if (used + 16 >= sizeof known) snprintf(known + used, sizeof known - used, ", ..");
    return iso_fail(error, ISO_ERR_USAGE, "%s: there is no label %s: there are %s", source->path,
                    source->input->label, *known ? known : "none");
}

iso_status iso_source_label_solid(const iso_source *source, const iso_grid *grid, iso_grid *solid,
                                  iso_error *error) {
    iso_label_fields *fields = NULL;
    iso_labels labels = {.count = 0};
    iso_error reason = {0};
    iso_status status = iso_labels_make(grid, source->pool, NULL, &labels, NULL, &reason);
    if (status != ISO_OK) return iso_fail(error, status, "%s: %s", source->path, reason.text);
    const int place = iso_labels_find(&labels, atoi(source->input->label));
    uint8_t *group = iso_alloc_zero((size_t)labels.count, 1);
    if (!group)
        status = iso_fail_memory(error, source->path);
    else if (place < 1)
        status = fail_missing(source, &labels, error);
    else
        group[place] = 1;
    if (status == ISO_OK)
        status = iso_label_fields_make(&labels, group, 1, ISO_LABELS_BAND, source->pool, &fields, error);
    if (status == ISO_OK) {
        const iso_grid own = {.hgrid = iso_label_fields_grid(fields, 1)};
        status = iso_grid_copy(&own, source->pool, solid, error);
    }
    iso_label_fields_destroy(fields);
    iso_free(group);
    iso_labels_free(&labels);
    return status;
}

/* ---- what a session began with */

/* The options with which the source was read; *text holds their strings. */
static iso_status reading_of(const iso_journal_start *start, char text[ISO_JOURNAL_TEXT], iso_input *input,
                             iso_error *error) {
    memcpy(text, start->reading, ISO_JOURNAL_TEXT);
    return iso_input_parse(text, input, error);
}

int iso_source_label(const iso_journal_start *start) {
    char text[ISO_JOURNAL_TEXT];
    iso_input input;
    if (reading_of(start, text, &input, NULL) != ISO_OK || !input.label) return 0;
    return atoi(input.label);
}

static const char *extension_of(const char *path) {
    const char *slash = strrchr(path, '/'), *dot = strrchr(slash ? slash : path, '.');
    return dot ? dot : "";
}

iso_status iso_source_label_check(const char *strokes, const iso_journal_start *start, const char *path,
                                  iso_error *error) {
    char text[ISO_JOURNAL_TEXT], found[ISO_SOURCE_PATH];
    iso_input input;
    iso_volume_info info;
    if (!iso_source_label(start))
        return iso_fail(
            error, ISO_ERR_USAGE,
            "%.400s: is a name for a segmentation: only a label that was opened by --label goes back "
            "into its own",
            path);
    ISO_TRY(reading_of(start, text, &input, error));
    const bool same = strcasecmp(extension_of(path), extension_of(start->source)) == 0 &&
                      iso_file_type_of_name(path, ISO_HOLDS_VOLUME) ==
                          iso_file_type_of_name(start->source, ISO_HOLDS_VOLUME);
    if (!same)
        return iso_fail(error, ISO_ERR_USAGE,
                        "%.400s: the label goes back as it came: the name must end as in %.400s", path,
                        start->source);
    ISO_TRY(iso_source_find(strokes, start, NULL, found, error));
    const iso_volume_opts opts = iso_input_volume_opts(&input);
    return iso_volume_rewrite_check(found, &opts, &info, error);
}

/* ---- writing */

typedef struct comparing {
    iso_grid first, now;
    iso_affine voxels, field; /* of the segmentation, of the fields */
    uint8_t *changed;         /* of each cell of the fields: whether its places may have changed sides */
    int label, voxel_count;   /* voxel_count: of a row */
    iso_label_changes *changes;
} comparing;

/* Whether the values of a cell differ. */
static bool cell_differs(const comparing *c, size_t cell) {
    const int32_t a = c->first.hgrid->cell[cell], b = c->now.hgrid->cell[cell];
    if (a < 0 || b < 0) return a != b;
    return memcmp(iso_hgrid_brick(c->first.hgrid, a), iso_hgrid_brick(c->now.hgrid, b),
                  ISO_BRICK_VOXELS * sizeof(float)) != 0;
}

/* Marks the cells that differ, and those before them along each axis: a place in these is interpolated
 * between voxels of both. */
static void mark_changed(const comparing *c) {
    const iso_hgrid *grid = c->now.hgrid;
    const size_t count = iso_hgrid_cell_count(grid);
    for (size_t cell = 0; cell < count; cell++) {
        if (!cell_differs(c, cell)) continue;
        int at[3];
        iso_hgrid_cell_position(grid, cell, at);
        for (int corner = 0; corner < 8; corner++) {
            const int x = at[0] - (corner & 1), y = at[1] - (corner >> 1 & 1), z = at[2] - (corner >> 2);
            if (x >= 0 && y >= 0 && z >= 0) c->changed[iso_hgrid_cell_index(grid, x, y, z)] = 1;
        }
    }
}

/* Whether a place, in index coordinates of the fields, lies where they may differ. */
static bool may_differ(const comparing *c, iso_vec3 p) {
    const int *dims = c->now.hgrid->dims;
    if (!(p.x >= 0 && p.y >= 0 && p.z >= 0 && p.x <= dims[0] - 1 && p.y <= dims[1] - 1 && p.z <= dims[2] - 1))
        return false;
    return c->changed[iso_hgrid_cell_index(c->now.hgrid, (int)p.x / ISO_BRICK, (int)p.y / ISO_BRICK,
                                           (int)p.z / ISO_BRICK)];
}

static void change_value(const comparing *c, bool inside, float *value) {
    const int old = *value >= 0 && *value <= ISO_LABEL_VALUE_MAX ? (int)floorf(*value + 0.5f) : 0;
    if ((old == c->label) == inside) return; /* has it already, or has another label that stays */
    c->changes->added += inside;
    c->changes->removed += !inside;
    c->changes->taken[old] += inside;
    *value = inside ? (float)c->label : 0;
}

/* iso_rewrite_row */
static void change_row(void *context, int y, int z, float *values) {
    const comparing *c = context;
    for (int x = 0; x < c->voxel_count; x++) {
        const iso_vec3 world = iso_affine_point(&c->voxels, iso_vec3_make(x, y, z)),
                       p = iso_affine_point_to_index(&c->field, world);
        if (!may_differ(c, p)) continue;
        const bool before = iso_grid_sample(&c->first, p) < 0, inside = iso_grid_sample(&c->now, p) < 0;
        if (before != inside) change_value(c, inside, &values[x]);
    }
}

iso_status iso_source_label_write(const char *strokes, const iso_journal_start *start, const iso_hgrid *first,
                                  const iso_hgrid *now, FILE *stream, const iso_progress *progress,
                                  iso_label_changes *changes, iso_error *error) {
    const iso_progress summing = iso_progress_part(progress, 0, 0.1),
                       writing = iso_progress_part(progress, 0.1, 1);
    char text[ISO_JOURNAL_TEXT], found[ISO_SOURCE_PATH];
    iso_input input;
    iso_volume_info info;
    ISO_TRY(reading_of(start, text, &input, error));
    ISO_TRY(iso_source_find(strokes, start, &summing, found, error));
    const iso_volume_opts opts = iso_input_volume_opts(&input);
    ISO_TRY(iso_volume_rewrite_check(found, &opts, &info, error));
    memset(changes, 0, sizeof *changes);
    comparing c = {.first = {.hgrid = (iso_hgrid *)(uintptr_t)first},
                   .now = {.hgrid = (iso_hgrid *)(uintptr_t)now},
                   .voxels = iso_transform_affine(&info.transform),
                   .field = iso_transform_affine(&now->transform),
                   .changed = iso_alloc_zero(iso_hgrid_cell_count(now), 1),
                   .label = atoi(input.label),
                   .voxel_count = info.dims[0],
                   .changes = changes};
    if (!c.changed) return iso_fail_memory(error, found);
    mark_changed(&c);
    iso_status status = iso_volume_rewrite(found, &opts, change_row, &c, stream, &writing, error);
    iso_free(c.changed);
    return status;
}
