/* label_meshes: makes level sets of as many labels at a time as there can be groups. */
#include "apps/isorender/label_meshes.h"

#include <stdlib.h>
#include <string.h>

#include "apps/isorender/segmentation.h"
#include "base/file_types.h"
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
    ISO_TRY(iso_label_fields_make(labels, group, b->count, false, m->job->pool, &fields, error));
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
    iso_sink sink;
    const char *comment;
    bool objects; /* the file has an object for each label; if not, there is one label */
    uint64_t vertices;
} writing;

static iso_status write_mesh(void *context, int label, const iso_weld *weld, const iso_transform *transform,
                             iso_error *error) {
    writing *w = context;
    w->job->triangle_count += weld->triangle_count;
    if (!w->objects)
        return iso_mesh_put_weld(w->sink.stream, w->job->plan->mesh, weld, transform, w->comment, error);
    iso_mesh_put_obj_object(w->sink.stream, w->job->segmentation->items[label].name, weld, transform,
                            &w->vertices);
    return ISO_OK;
}

iso_status isorender_label_meshes_write(isorender_job *job, const char *comment, iso_error *error) {
    const isorender_segmentation *s = job->segmentation;
    const char *path = job->plan->mesh;
    int drawn = 0;
    for (int i = 1; i < s->labels.count; i++) drawn += s->group[i] != 0;
    const bool objects = iso_file_type_of_name(path, ISO_WRITES_MESH) == ISO_FILE_obj;
    if (drawn > 1 && !objects)
        return iso_fail(error, ISO_ERR_USAGE,
                        "%s: %d labels are written as the objects of an .obj (or --label chooses one)", path,
                        drawn);
    writing w = {.job = job, .comment = comment, .objects = objects};
    ISO_TRY(iso_sink_open(path, &w.sink, error));
    iso_status status = isorender_label_meshes_each(job, true, write_mesh, &w, error);
    if (status == ISO_OK) status = iso_sink_commit(&w.sink, error);
    iso_sink_abort(&w.sink);
    if (status == ISO_OK) job->mesh_written = true;
    return status;
}
