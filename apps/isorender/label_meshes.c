/* label_meshes: the objects of a file. */
#include "apps/isorender/label_meshes.h"

#include <stdlib.h>

#include "apps/isorender/segmentation.h"

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
    const iso_drawn_label *item = &w->job->segmentation->items[label];
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
    const iso_segmentation *s = job->segmentation;
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
    iso_status status = there ? iso_segmentation_each_mesh(s, true, take_mesh, &w, error)
                              : iso_fail(error, ISO_ERR_NOMEM, "out of memory");
    if (status == ISO_OK) status = iso_mesh_write_objects(path, w.objects, w.count, comment, error);
    for (int i = 0; i < w.count; i++) iso_weld_free(&w.welds[i]);
    free(w.objects);
    free(w.welds);
    free(w.transforms);
    if (status == ISO_OK) job->mesh_written = true;
    return status;
}
