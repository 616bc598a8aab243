/* segmentation: a volume of labels, from its file to surfaces: each label is a smooth solid, with a name, a
 * colour and an opacity. Opaque labels share a surface; each translucent one has its own. */
#ifndef ISO_SCENE_SEGMENTATION_H
#define ISO_SCENE_SEGMENTATION_H

#include "extract/mesh/mesh.h"
#include "grids/labels/label_fields.h"
#include "grids/labels/label_names.h"
#include "scene/label_colors.h"
#include "scene/loader.h"

/* How a label is drawn. */
typedef struct iso_drawn_label {
    char name[ISO_LABEL_NAME]; /* "label 7" if nothing states it */
    iso_rgb color;
    double opacity; /* 0: it is not drawn */
} iso_drawn_label;

/* Zero-initialise, open `loader` with `input` as its options, iso_segmentation_free when done. */
typedef struct iso_segmentation {
    iso_loader loader;
    iso_input input; /* how the file is read */
    iso_labels labels;
    iso_components_totals
        parts; /* of the parts of labels that `input` keeps and drops; zeros: all are kept */
    /* What the file states. If `layered`, label n is its n-th segment: segments of several layers, */
    iso_label_names stated;
    bool layered;
    size_t overlaps;        /* and voxels that belong to several of them get the last one */
    iso_drawn_label *items; /* by place in labels.label */
    uint8_t *group;         /* of each label: that of its surface; 0: it is not drawn */
    int groups;
    iso_rgb *colors; /* of each label */
    iso_label_fields *fields;
    iso_label_colors shared; /* of the surface that the opaque labels share, group 1 */
} iso_segmentation;

/* Reads the voxels and what the file states of its labels: of segments in layers the other layers, too,
 * unless one is chosen. Errors of iso_loader_read, iso_label_names_of_file and iso_labels_make. */
iso_status iso_segmentation_read(iso_segmentation *s, iso_error *error);

/* Makes `labels`, in place of the voxels, without the parts that input.largest and input.min_size drop, and
 * `items`: names and colours of the table in a file (NULL: none), then of the labels' file, then usual ones.
 * *missing, *first: how many labels the table lacks, and the first of them. Errors of iso_label_names_read
 * and iso_labels_make. */
iso_status iso_segmentation_name(iso_segmentation *s, const char *table, int *missing, int *first,
                                 iso_error *error);

/* Whether the labels are the many values of a scan, whose neighbours along x mostly differ: to draw them
 * takes minutes and shows nothing. Not if the file states names. */
bool iso_segmentation_is_scan(const iso_segmentation *s);

/* Divides the labels into groups: 1 of all opaque ones, if there are some, and one of each translucent one.
 */
void iso_segmentation_divide(iso_segmentation *s);
/* Makes the level sets of the groups, of which there are 1 .. ISO_LABEL_GROUPS, and `shared`. `places`:
 * ISO_LABELS_DRAWN .. ISO_ERR_NOMEM. */
iso_status iso_segmentation_make_fields(iso_segmentation *s, int places, iso_error *error);

/* Is given the mesh of label `label`, a place in the list of labels; it may keep it, and set *weld to zeros.
 */
typedef iso_status iso_label_mesh_fn(void *context, int label, iso_weld *weld, const iso_transform *transform,
                                     iso_error *error);
/* Makes the meshes of all labels, or of those that are drawn, and calls `take` with each of them. Where two
 * labels meet, their meshes have the same vertices. ISO_ERR_NOMEM, and the errors of `take`. */
iso_status iso_segmentation_each_mesh(const iso_segmentation *s, bool drawn, iso_label_mesh_fn *take,
                                      void *context, iso_error *error);

/* Measures the smooth surfaces of all labels (`measures`: by place in the list of labels), and finds which
 * touch; iso_label_contacts_free when done, also after an error. ISO_ERR_NOMEM. */
iso_status iso_segmentation_measure(const iso_segmentation *s, iso_mesh_measures *measures,
                                    iso_label_contacts *contacts, iso_error *error);

void iso_segmentation_free(iso_segmentation *s);

/* How many values a volume has that seems to be a mask (2) or labels (more), and *last, the largest of them;
 * 0: it seems to be neither. */
int iso_segmentation_guess(const iso_rgrid *grid, int *last);

/* Whether a file is an .nrrd whose header names segments, as 3D Slicer writes them. */
bool iso_segmentation_has_segments(const char *path);

#endif
