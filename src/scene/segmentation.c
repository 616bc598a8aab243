/* segmentation: reads labels, names and groups them, and makes their meshes. */
#include "scene/segmentation.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/file_types.h"
#include "extract/mesh/mesh_measure.h"
#include "grids/scenes/scenes.h"
#include "scene/surface.h"

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

static iso_status read_layer(iso_segmentation *s, int layer, layers *all, iso_error *error) {
    iso_input input = s->input;
    iso_loader loader = {
        .input = s->loader.input, .options = &input, .pool = s->loader.pool, .is_further = true};
    iso_labels labels = {.count = 0};
    input.component = layer;
    iso_status status = layer ? iso_loader_open(&loader, error) : ISO_OK;
    if (status == ISO_OK && layer) status = iso_loader_read(&loader, error);
    const iso_grid *grid = layer ? &loader.volume.grid : &s->loader.volume.grid;
    if (status == ISO_OK) status = iso_labels_make(grid, s->loader.pool, NULL, &labels, NULL, error);
    if (status == ISO_OK) add_layer(&s->stated, layer, &labels, all);
    iso_labels_free(&labels);
    if (layer) iso_loader_close(&loader);
    return status;
}

/* Reads the segments of all layers into one volume of their numbers. */
static iso_status read_layers(iso_segmentation *s, iso_error *error) {
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
        status = read_layer(s, layer, &all, error);
    if (status != ISO_OK) {
        iso_grid_destroy(&grid);
        return status;
    }
    iso_grid_destroy(&s->loader.volume.grid);
    s->loader.volume.grid = grid;
    s->layered = true;
    s->overlaps = all.overlaps;
    return ISO_OK;
}

iso_status iso_segmentation_read(iso_segmentation *s, iso_error *error) {
    ISO_TRY(iso_loader_read(&s->loader, error));
    if (iso_loader_is_scene(s->loader.input)) return ISO_OK;
    ISO_TRY(iso_label_names_of_file(s->loader.path, &s->stated, error));
    const bool chosen = s->input.component > 0 || s->input.channel || s->input.cropped || s->input.cropped_mm;
    if (s->loader.volume.info.components < 2 || !s->stated.count || chosen) return ISO_OK;
    return read_layers(s, error);
}

/* ---- names, colours, and what is drawn */

/* What the file states of a label; NULL: nothing. */
static const iso_label_name *stated_name(const iso_segmentation *s, int value) {
    if (!s->layered) return iso_label_names_find(&s->stated, s->loader.component, value);
    return value > 0 && value <= s->stated.count ? &s->stated.items[value - 1] : NULL;
}

/* The item of label number `i`, for which the table has `row`, or NULL. */
static iso_drawn_label make_item(const iso_segmentation *s, int i, const iso_label_name *row) {
    const int value = s->labels.label[i].value;
    iso_drawn_label item = {.color = iso_label_usual_color(value), .opacity = i > 0};
    const iso_label_name *name = row ? row : stated_name(s, value);
    const char *organ = strncmp(s->loader.input, "scene:organs", 12) ? NULL : iso_scene_organ_name(value);
    snprintf(item.name, sizeof item.name, "label %d", value);
    if (organ) snprintf(item.name, sizeof item.name, "%s", organ);
    if (name && name->name[0]) snprintf(item.name, sizeof item.name, "%s", name->name);
    if (name && name->colored) item.color = name->color;
    return item;
}

iso_status iso_segmentation_name(iso_segmentation *s, const char *table, int *missing, int *first,
                                 iso_error *error) {
    iso_label_names rows = {0};
    const iso_label_parts keep = {(size_t)s->input.largest, s->input.min_size};
    ISO_TRY(iso_labels_make(&s->loader.volume.grid, s->loader.pool,
                            iso_input_drops_parts(&s->input) ? &keep : NULL, &s->labels, &s->parts, error));
    iso_grid_destroy(&s->loader.volume.grid);
    const size_t count = (size_t)s->labels.count;
    s->items = calloc(count, sizeof *s->items);
    s->group = calloc(count, 1);
    s->colors = calloc(count, sizeof *s->colors);
    if (!s->items || !s->group || !s->colors) return iso_fail(error, ISO_ERR_NOMEM, "out of memory");
    if (table) ISO_TRY(iso_label_names_read(table, &rows, error));
    *missing = *first = 0;
    for (int i = 0; i < s->labels.count; i++) {
        const int value = s->labels.label[i].value;
        const iso_label_name *row = iso_label_names_find(&rows, 0, value);
        if (table && !row && i) *first = (*missing)++ ? *first : value;
        s->items[i] = make_item(s, i, row);
    }
    iso_label_names_free(&rows);
    return ISO_OK;
}

bool iso_segmentation_is_scan(const iso_segmentation *s) {
    enum { FEW = 64 };
    const iso_labels *labels = &s->labels;
    if (labels->count <= FEW || s->stated.count) return false;
    /* (pairs of neighbours that are both background count as none) */
    const uint64_t pairs =
        (uint64_t)(labels->dims[0] - 1) * (uint64_t)labels->dims[1] * (uint64_t)labels->dims[2] -
        (labels->label[0].voxels - labels->label[0].runs);
    uint64_t equal = 0;
    for (int i = 1; i < labels->count; i++) equal += labels->label[i].voxels - labels->label[i].runs;
    return 2 * equal < pairs;
}

void iso_segmentation_divide(iso_segmentation *s) {
    int opaque = 0;
    for (int i = 1; i < s->labels.count; i++) opaque += s->items[i].opacity >= 1;
    s->groups = opaque > 0;
    for (int i = 0; i < s->labels.count; i++) {
        const double opacity = s->items[i].opacity;
        const bool translucent = i && opacity > 0 && opacity < 1;
        if (translucent) s->groups++;
        s->group[i] = !i || !(opacity > 0) || s->groups > ISO_LABEL_GROUPS ? 0
                      : translucent                                        ? (uint8_t)s->groups
                                                                           : 1;
        s->colors[i] = s->items[i].color;
    }
}

iso_status iso_segmentation_make_fields(iso_segmentation *s, int places, iso_error *error) {
    ISO_TRY(
        iso_label_fields_make(&s->labels, s->group, s->groups, places, s->loader.pool, &s->fields, error));
    s->shared = (iso_label_colors){s->fields, s->labels.label, 1, s->colors};
    return ISO_OK;
}

void iso_segmentation_free(iso_segmentation *s) {
    iso_label_fields_destroy(s->fields);
    iso_labels_free(&s->labels);
    iso_label_names_free(&s->stated);
    iso_loader_close(&s->loader);
    free(s->items);
    free(s->group);
    free(s->colors);
}

/* ---- meshes: level sets of as many labels at a time as there can be groups */

/* The labels of one set of fields: each is a group of its own. */
typedef struct batch {
    int label[ISO_LABEL_GROUPS];
    int count;
} batch;

typedef struct meshing {
    const iso_segmentation *s;
    iso_label_mesh_fn *take;
    void *context;
} meshing;

static iso_status make_mesh(const meshing *m, const iso_label_fields *fields, int group, int label,
                            iso_error *error) {
    iso_scene_surface surface = {.grid = {.hgrid = iso_label_fields_grid(fields, group)},
                                 .pool = m->s->loader.pool};
    iso_weld weld;
    iso_status status = iso_scene_surface_update(&surface, ISO_PART_MESH, error);
    if (status == ISO_OK) {
        const iso_mesh_view view = iso_mesh_set_view(surface.mesh);
        status = iso_mesh_weld(&view, NULL, &weld, error);
        if (status == ISO_OK) {
            status = m->take(m->context, label, &weld, &view.transform, error);
            iso_weld_free(&weld);
        }
    }
    iso_scene_surface_free(&surface);
    return status;
}

static iso_status mesh_batch(const meshing *m, const batch *b, uint8_t *group, iso_error *error) {
    const iso_labels *labels = &m->s->labels;
    iso_label_fields *fields = NULL;
    memset(group, 0, (size_t)labels->count);
    for (int i = 0; i < b->count; i++) group[b->label[i]] = (uint8_t)(i + 1);
    ISO_TRY(
        iso_label_fields_make(labels, group, b->count, ISO_LABELS_DRAWN, m->s->loader.pool, &fields, error));
    iso_status status = ISO_OK;
    for (int i = 0; i < b->count && status == ISO_OK; i++)
        status = make_mesh(m, fields, i + 1, b->label[i], error);
    iso_label_fields_destroy(fields);
    return status;
}

iso_status iso_segmentation_each_mesh(const iso_segmentation *s, bool drawn, iso_label_mesh_fn *take,
                                      void *context, iso_error *error) {
    const meshing m = {s, take, context};
    batch b = {.count = 0};
    iso_status status = ISO_OK;
    uint8_t *group = calloc((size_t)s->labels.count, 1);
    if (!group) return iso_fail(error, ISO_ERR_NOMEM, "out of memory");
    for (int i = 1; i < s->labels.count && status == ISO_OK; i++) {
        if (!drawn || s->group[i]) b.label[b.count++] = i;
        if (!b.count || (b.count < ISO_LABEL_GROUPS && i + 1 < s->labels.count)) continue;
        status = mesh_batch(&m, &b, group, error);
        b.count = 0;
    }
    free(group);
    return status;
}

typedef struct measuring {
    iso_pool *pool;
    iso_mesh_measures *measures; /* of each label */
} measuring;

static iso_status measure(void *context, int label, iso_weld *weld, const iso_transform *transform,
                          iso_error *error) {
    const measuring *m = context;
    return iso_weld_measure(weld, transform, m->pool, &m->measures[label], error);
}

iso_status iso_segmentation_measure(const iso_segmentation *s, iso_mesh_measures *measures,
                                    iso_label_contacts *contacts, iso_error *error) {
    measuring m = {s->loader.pool, measures};
    ISO_TRY(iso_segmentation_each_mesh(s, false, measure, &m, error));
    return iso_labels_contacts(&s->labels, contacts, error);
}

/* ---- whether an input is labels */

enum { FOUND_MOST = 256, FEW_VALUES = 8, MANY_PAIRS = 4096, ROW_STEP = 3 };

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

int iso_segmentation_guess(const iso_rgrid *grid, int *last) {
    found_labels found = {.pairs = 0};
    int values = 0;
    for (int z = 0; z < grid->dims[2]; z += ROW_STEP)
        for (int y = 0; y < grid->dims[1]; y += ROW_STEP)
            if (!look_at_row(grid, y, z, &found)) return 0;
    for (int i = 0; i <= FOUND_MOST; i++)
        if (found.present[i]) values++, *last = i;
    /* (no scan has so few values in so many voxels) */
    const bool few = values <= FEW_VALUES && found.pairs >= MANY_PAIRS;
    const bool plateaus = values == 2 || few || (double)found.equal >= 0.8 * (double)found.pairs;
    return found.present[0] && values >= 2 && plateaus ? values : 0;
}

bool iso_segmentation_has_segments(const char *path) {
    iso_label_names names = {NULL, 0};
    if (iso_file_type_of_name(path, ISO_HOLDS_VOLUME) != ISO_FILE_nrrd ||
        iso_label_names_of_file(path, &names, NULL) != ISO_OK)
        return false;
    const bool found = names.count > 0;
    iso_label_names_free(&names);
    return found;
}
