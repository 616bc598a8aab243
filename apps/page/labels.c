/* labels: the part of a page's engine that makes smooth surfaces of labels, as isorender --labels does
 * (apps/isorender/segmentation.c). */
#include "apps/page/engine.h"

static struct {
    iso_labels labels;
    uint8_t *group;  /* of each label */
    iso_rgb *colors; /* of each label */
    iso_label_colors shared;
} made;

/* Takes a volume of nx x ny x nz labels at `data`, from alloc: numbers from 0 to count - 1, of `type`. */
EXPORT(labels)
int page_labels(int nx, int ny, int nz, int type, void *data, const double *transform, int count) {
    iso_grid grid = {NULL, NULL};
    ISO_TRY(page_grid(nx, ny, nz, type, data, 1, 0, transform, 0, &grid.rgrid));
    ISO_TRY(iso_labels_make(&grid, NULL, NULL, &made.labels, NULL, &page.error));
    made.group = iso_alloc_zero((size_t)count, sizeof *made.group);
    made.colors = iso_alloc_zero((size_t)count, sizeof *made.colors);
    if (made.group && made.colors && made.labels.count == count) return ISO_OK;
    return iso_fail(&page.error, ISO_ERR_NOMEM, "out of memory for labels");
}

/* Says to which group label `number` belongs, and its colour in the surface of that group. */
EXPORT(label) void page_label(int number, int group, int color) {
    made.group[number] = (uint8_t)group;
    made.colors[number] = rgb(color);
}

/* Makes the level sets of groups 1 .. count, after `label` has been called of all labels. shared: the group
 * whose surface has the colours of its labels; 0: none. caps: cuts will have caps. */
EXPORT(groups) int page_groups(int count, int shared, int caps) {
    iso_label_fields *fields;
    const int places = ISO_LABELS_DRAWN + (caps ? ISO_LABELS_INSIDE : 0);
    ISO_TRY(iso_label_fields_make(&made.labels, made.group, count, places, NULL, &fields, &page.error));
    made.shared = (iso_label_colors){fields, made.labels.label, shared, made.colors};
    for (int g = 1; g <= count; g++)
        page.labels[g] =
            (group){{.hgrid = iso_label_fields_grid(fields, g)}, g == shared ? &made.shared : NULL};
    return ISO_OK;
}
