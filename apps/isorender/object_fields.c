/* object_fields: what is told of objects that are made of a volume of vectors or tensors. */
#include "apps/isorender/objects.h"

/* Of lines in all the volume, not of one of them, so that a picture shows some hundreds of them. */
double isorender_field_radius(const isorender_object *object) {
    const iso_box box = iso_lines_bounds(&object->file.lines);
    return iso_vec3_length(iso_vec3_sub(box.hi, box.lo)) / 400;
}

static void put_glyphs(iso_json *json, const iso_vector_glyphs_totals *totals) {
    iso_json_integer(json, "every", (uint64_t)totals->every);
    iso_json_real(json, "scale_mm", totals->scale);
    iso_json_integer(json, "indefinite", totals->indefinite);
    iso_json_integer(json, "small", totals->small);
}

static void put_lines(iso_json *json, const iso_streamlines_totals *totals) {
    iso_json_real(json, "step_mm", totals->step);
    iso_json_real(json, "least", totals->slowest);
    iso_json_integer(json, "tried", totals->tried);
    iso_json_begin_object(json, "ends");
    iso_json_integer(json, "left", totals->left);
    iso_json_integer(json, "slow", totals->slowed);
    iso_json_integer(json, "length", totals->grown);
    iso_json_end_object(json);
}

void isorender_field_put(iso_json *json, const isorender_object *object) {
    const iso_vector_field *field = &object->file.field;
    iso_json_begin_object(json, "field");
    iso_json_ints(json, "dims", field->dims, 3);
    iso_json_integer(json, "components", (uint64_t)field->components);
    iso_json_integer(json, "usable", field->vectors.usable);
    iso_json_integer(json, "zero", field->vectors.zero);
    iso_json_integer(json, "missing", field->vectors.missing);
    iso_json_real(json, "longest", field->vectors.longest);
    if (object->settings->kind == ISO_OBJECT_LINES)
        put_lines(json, &field->lines);
    else
        put_glyphs(json, &field->glyphs);
    iso_json_end_object(json);
}

void isorender_field_info(const isorender_object *object) {
    const iso_vector_field *field = &object->file.field;
    printf("  %-11s %d x %d x %d, %d components: %s\n", "voxels", field->dims[0], field->dims[1],
           field->dims[2], field->components,
           field->components == 3   ? "vectors"
           : field->components == 7 ? "masked symmetric tensors"
                                    : "symmetric tensors");
    printf("  %-11s %zu, %zu are 0, %zu missing; the longest %.6g\n",
           field->components == 3 ? "vectors" : "tensors", field->vectors.usable, field->vectors.zero,
           field->vectors.missing, field->vectors.longest);
}
