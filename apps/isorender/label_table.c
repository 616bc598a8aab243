/* label_table: measures labels: voxels as they are, volume and area of the smooth surfaces. */
#include "apps/isorender/label_table.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "apps/isorender/segmentation.h"
#include "base/memory.h"

/* Volume and area of a group's smooth surface. */
static iso_status measure_group(isorender_job *job, const iso_label_fields *fields, int group,
                                iso_mesh_measures *measures, iso_error *error) {
    iso_scene_surface surface = {.grid = {.hgrid = iso_label_fields_grid(fields, group)}, .pool = job->pool};
    iso_weld weld;
    iso_status status = iso_scene_surface_update(&surface, ISO_PART_MESH, error);
    if (status == ISO_OK) {
        const iso_mesh_view view = iso_mesh_set_view(surface.mesh);
        status = iso_mesh_weld(&view, &weld, error);
        if (status == ISO_OK) {
            status = iso_weld_measure(&weld, &view.transform, job->pool, measures, error);
            iso_weld_free(&weld);
        }
    }
    iso_scene_surface_free(&surface);
    return status;
}

/* Measures the labels first .. end - 1, each as a group of its own. */
static iso_status measure_batch(isorender_job *job, int first, int end, uint8_t *group,
                                iso_mesh_measures *measures, iso_error *error) {
    const iso_labels *labels = &job->segmentation->labels;
    iso_label_fields *fields = NULL;
    memset(group, 0, (size_t)labels->count);
    for (int i = first; i < end; i++) group[i] = (uint8_t)(i - first + 1);
    ISO_TRY(iso_label_fields_make(labels, group, end - first, false, job->pool, &fields, error));
    iso_status status = ISO_OK;
    for (int i = first; i < end && status == ISO_OK; i++)
        status = measure_group(job, fields, i - first + 1, &measures[i], error);
    iso_label_fields_destroy(fields);
    return status;
}

static iso_status measure_all(isorender_job *job, iso_mesh_measures *measures, iso_error *error) {
    const int count = job->segmentation->labels.count;
    uint8_t *group = calloc((size_t)count, 1);
    if (!group) return iso_fail(error, ISO_ERR_NOMEM, "out of memory");
    iso_status status = ISO_OK;
    for (int i = 1; i < count && status == ISO_OK; i += ISO_LABEL_GROUPS) {
        const int end = i + ISO_LABEL_GROUPS < count ? i + ISO_LABEL_GROUPS : count;
        status = measure_batch(job, i, end, group, measures, error);
    }
    free(group);
    return status;
}

/* A field of a row: in quotation marks if it needs them. */
static void put_text(FILE *stream, const char *text) {
    if (!strpbrk(text, ",\"")) {
        fputs(text, stream);
        return;
    }
    fputc('"', stream);
    for (; *text; text++) {
        if (*text == '"') fputc('"', stream);
        fputc(*text, stream);
    }
    fputc('"', stream);
}

static void put_touching(FILE *stream, const iso_labels *labels, const iso_label_contacts *contacts,
                         int label) {
    const char *separator = "";
    for (size_t i = 0; i < contacts->count; i++) {
        const uint16_t *pair = contacts->pair[i];
        const int other = pair[0] == label ? pair[1] : pair[1] == label ? pair[0] : -1;
        if (other < 0) continue;
        fprintf(stream, "%s%d", separator, labels->label[other].value);
        separator = " ";
    }
}

static void put_rows(FILE *stream, const isorender_segmentation *s, const iso_mesh_measures *measures,
                     const iso_label_contacts *contacts) {
    const iso_affine affine = iso_transform_affine(&s->labels.transform);
    const double voxel = fabs(affine.determinant);
    fputs("label,name,voxels,voxels_mm3,volume_mm3,area_mm2,center_x,center_y,center_z,min_x,min_y,min_z,"
          "max_x,max_y,max_z,touches\n",
          stream);
    for (int i = 1; i < s->labels.count; i++) {
        const iso_label *label = &s->labels.label[i];
        const double n = (double)label->voxels;
        const iso_vec3 middle =
            iso_affine_point(&affine, iso_vec3_make((double)label->sums[0] / n, (double)label->sums[1] / n,
                                                    (double)label->sums[2] / n));
        const iso_box index = {{label->lo[0] - 0.5, label->lo[1] - 0.5, label->lo[2] - 0.5},
                               {label->hi[0] + 0.5, label->hi[1] + 0.5, label->hi[2] + 0.5}},
                      box = iso_box_transform(&index, &affine);
        fprintf(stream, "%d,", label->value);
        put_text(stream, s->items[i].name);
        fprintf(stream, ",%" PRIu64 ",%.9g,%.9g,%.9g,%.9g,%.9g,%.9g,%.9g,%.9g,%.9g,%.9g,%.9g,%.9g,",
                label->voxels, n * voxel, measures[i].volume, measures[i].area, middle.x, middle.y, middle.z,
                box.lo.x, box.lo.y, box.lo.z, box.hi.x, box.hi.y, box.hi.z);
        put_touching(stream, &s->labels, contacts, i);
        fputc('\n', stream);
    }
}

static iso_status write_rows(const isorender_job *job, const iso_mesh_measures *measures,
                             const iso_label_contacts *contacts, iso_error *error) {
    iso_sink sink = {0};
    ISO_TRY(iso_sink_open(job->plan->table, &sink, error));
    put_rows(sink.stream, job->segmentation, measures, contacts);
    return iso_sink_commit(&sink, error);
}

iso_status isorender_label_table_write(isorender_job *job, iso_error *error) {
    const isorender_segmentation *s = job->segmentation;
    iso_label_contacts contacts = {0};
    if (!job->plan->table) return ISO_OK;
    iso_mesh_measures *measures = calloc((size_t)s->labels.count, sizeof *measures);
    if (!measures) return iso_fail(error, ISO_ERR_NOMEM, "out of memory");
    iso_status status = measure_all(job, measures, error);
    if (status == ISO_OK) status = iso_labels_contacts(&s->labels, &contacts, error);
    if (status == ISO_OK) status = write_rows(job, measures, &contacts, error);
    if (status == ISO_OK) job->table_written = true;
    iso_label_contacts_free(&contacts);
    free(measures);
    return status;
}
