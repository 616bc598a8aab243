/* label_meshes: makes level sets of as many labels at a time as there can be groups. */
#include "apps/isorender/label_meshes.h"

#include <stdlib.h>
#include <string.h>

#include "apps/isorender/segmentation.h"
#include "extract/mesh/mesh_edit.h"
#include "io/mesh/mesh_write.h"

/* The labels of one set of fields: each is a group of its own. */
typedef struct batch {
    int label[ISO_LABEL_GROUPS];
    int count;
} batch;

typedef struct meshing {
    isorender_job *job;
    isorender_label_mesh_fn *take;
    void *context;
} meshing;

static iso_status make_mesh(const meshing *m, const iso_label_fields *fields, int group, int label,
                            iso_error *error) {
    iso_scene_surface surface = {.grid = {.hgrid = iso_label_fields_grid(fields, group)},
                                 .pool = m->job->pool};
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
    const iso_labels *labels = &m->job->segmentation->labels;
    iso_label_fields *fields = NULL;
    memset(group, 0, (size_t)labels->count);
    for (int i = 0; i < b->count; i++) group[b->label[i]] = (uint8_t)(i + 1);
    ISO_TRY(iso_label_fields_make(labels, group, b->count, ISO_LABELS_DRAWN, m->job->pool, &fields, error));
    iso_status status = ISO_OK;
    for (int i = 0; i < b->count && status == ISO_OK; i++)
        status = make_mesh(m, fields, i + 1, b->label[i], error);
    iso_label_fields_destroy(fields);
    return status;
}

iso_status isorender_label_meshes_each(isorender_job *job, bool drawn, isorender_label_mesh_fn *take,
                                       void *context, iso_error *error) {
    const isorender_segmentation *s = job->segmentation;
    const meshing m = {job, take, context};
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

/* ---- the file */

typedef struct writing {
    isorender_job *job;
    iso_mesh_object *objects;
    iso_weld *welds;           /* of the objects, */
    iso_transform *transforms; /* and these */
    int count;
} writing;

static iso_status take_mesh(void *context, int label, iso_weld *weld, const iso_transform *transform,
                            iso_error *error) {
    writing *w = context;
    const isorender_label *item = &w->job->segmentation->items[label];
    ISO_TRY(iso_weld_edit(weld, transform, &w->job->settings->mesh_edits, error));
    w->job->triangle_count += weld->triangle_count;
    w->welds[w->count] = *weld;
    w->transforms[w->count] = *transform;
    w->objects[w->count] = (iso_mesh_object){.weld = &w->welds[w->count],
                                             .transform = &w->transforms[w->count],
                                             .name = item->name,
                                             .color = &item->color,
                                             .opacity = item->opacity};
    *weld = (iso_weld){0};
    w->count++;
    return ISO_OK;
}

iso_status isorender_label_meshes_write(isorender_job *job, const char *comment, iso_error *error) {
    const isorender_segmentation *s = job->segmentation;
    const char *path = job->plan->mesh;
    size_t drawn = 0;
    for (int i = 1; i < s->labels.count; i++) drawn += s->group[i] != 0;
    if (drawn > 1 && iso_mesh_file_objects(path) == 1)
        return iso_fail(
            error, ISO_ERR_USAGE,
            "%s: %zu labels are written as the objects of an .obj, .glb or .3mf (or --label chooses one)",
            path, drawn);
    writing w = {.job = job,
                 .objects = calloc(drawn + 1, sizeof *w.objects),
                 .welds = calloc(drawn + 1, sizeof *w.welds),
                 .transforms = calloc(drawn + 1, sizeof *w.transforms)};
    const bool there = w.objects && w.welds && w.transforms;
    iso_status status = there ? isorender_label_meshes_each(job, true, take_mesh, &w, error)
                              : iso_fail(error, ISO_ERR_NOMEM, "out of memory");
    if (status == ISO_OK) status = iso_mesh_write_objects(path, w.objects, w.count, comment, error);
    for (int i = 0; i < w.count; i++) iso_weld_free(&w.welds[i]);
    free(w.objects);
    free(w.welds);
    free(w.transforms);
    if (status == ISO_OK) job->mesh_written = true;
    return status;
}
