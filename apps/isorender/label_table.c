/* label_table: measures labels: voxels as they are, volume and area of the smooth surfaces. */
#include "apps/isorender/label_table.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "apps/isorender/segmentation.h"

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

static void put_rows(FILE *stream, const iso_segmentation *s, const iso_mesh_measures *measures,
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
    const iso_segmentation *s = job->segmentation;
    iso_label_contacts contacts = {0};
    if (!job->plan->table) return ISO_OK;
    iso_mesh_measures *measures = calloc((size_t)s->labels.count, sizeof *measures);
    if (!measures) return iso_fail(error, ISO_ERR_NOMEM, "out of memory");
    iso_status status = iso_segmentation_measure(s, measures, &contacts, error);
    if (status == ISO_OK) status = write_rows(job, measures, &contacts, error);
    if (status == ISO_OK) job->table_written = true;
    iso_label_contacts_free(&contacts);
    free(measures);
    return status;
}
