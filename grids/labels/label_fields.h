/* label_fields: labels as smooth solids that divide space among them.
 *
 * Labels are drawn in groups: the labels of a group make one solid. Each group gets a field: its signed
 * distance, twice the Gaussian of 1.5 voxels less that of 1.5 sqrt(2), which does not move surfaces as one
 * Gaussian does. Where that would take a voxel away from its label, as in structures thinner than 2 voxels,
 * the Gaussian is one of 0.8 voxels, and at last each voxel's own group is raised above the others: no voxel
 * changes its group, and none is lost. A group's level set is the greatest field of all others less its own,
 * halved. Fields are interpolated trilinearly between voxels. The solids of two groups share their border:
 * without gaps, without overlaps. (Where three groups meet, the trilinear level sets leave less than a voxel
 * between them.)
 *
 * In the solid of a group a place belongs to the label with the greatest field there; fields of labels are
 * those of groups of one. They are computed where a picture shows several labels. */
#ifndef ISO_GRIDS_LABELS_LABEL_FIELDS_H
#define ISO_GRIDS_LABELS_LABEL_FIELDS_H

#include "grids/labels/labels.h"

enum {
    ISO_LABEL_GROUPS = 63, /* most groups */
    ISO_LABEL_BORDER = 1   /* voxels of background that the level sets have around the volume */
};

typedef struct iso_label_fields iso_label_fields;

/* Where the level sets are smooth; elsewhere they are -ISO_LABEL_BAND or ISO_LABEL_BAND. */
typedef enum iso_label_places {
    ISO_LABELS_DRAWN = 0,  /* at cells with a surface and the voxels around them: for trilinear surfaces and
                             their gradients */
    ISO_LABELS_INSIDE = 1, /* and where labels border on each other inside of solids: for caps */
    ISO_LABELS_BAND = 2,   /* and at all voxels of bricks near a surface: for all else */
    ISO_LABELS_APART = 4   /* labels of a group are told apart at once, not when a place is asked for */
} iso_label_places;

/* group: of each label of `labels`, 1 .. group_count; 0: it is not drawn and counts as background, as the
 * background itself does. places: the sum of some. `labels` is borrowed until iso_label_fields_destroy, and
 * must stay where it is. ISO_ERR_LIMIT: the volume has more than ISO_HGRID_MAX - 2 voxels along an axis;
 * ISO_ERR_NOMEM. The same fields for any number of threads and instruction set. */
iso_status iso_label_fields_make(const iso_labels *labels, const uint8_t *group, int group_count, int places,
                                 iso_pool *pool, iso_label_fields **fields, iso_error *error);
void iso_label_fields_destroy(iso_label_fields *fields);

/* The level set of a group, 1 .. group_count; owned by the fields. It is larger than the volume by
 * ISO_LABEL_BORDER voxels on all sides, where the solids end. */
iso_hgrid *iso_label_fields_grid(const iso_label_fields *fields, int group);

/* Tells labels of a group apart around all places that iso_label_fields_near was asked for and did not know:
 * it then knows them. No other function may use the fields meanwhile. ISO_ERR_NOMEM. */
iso_status iso_label_fields_tell_apart(iso_label_fields *fields, iso_pool *pool, iso_error *error);

/* The cell that was looked at last, for lookups at places beside each other. Zero-initialise. */
typedef struct iso_label_cell {
    bool known, apart; /* apart: its labels are told apart, or there is but one */
    int lo[3];
    int count, labels[8]; /* of its corners that belong to the group, each once */
    float values[8][8];   /* their fields at the corners, if there are several */
} iso_label_cell;

/* The label of a place of a group's solid, in index coordinates of its level set: the one with the greatest
 * field of the group's labels around it, as its place in the list of labels; 0: there is none within a voxel.
 * The fields are made with ISO_LABELS_APART. */
int iso_label_fields_at(const iso_label_fields *fields, int group, iso_vec3 p);
/* The same of any fields; -1: labels are not told apart there yet. *cell is of the last place in the same
 * group. Any number of threads may ask. */
int iso_label_fields_near(const iso_label_fields *fields, int group, iso_vec3 p, iso_label_cell *cell);

#endif
