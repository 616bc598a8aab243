/* Meshes in PLY. */
#include "io/mesh/mesh_format.h"

#include <string.h>

enum { POLYGON_MOST = 1 << 16 };

static iso_status read_ply_vertex(iso_mesh_reading *r, iso_ply *ply, const iso_ply_element *element,
                                  iso_error *error) {
    static const char *const names[3] = {"x", "y", "z"};
    static const char *const colors[2][3] = {{"red", "green", "blue"},
                                             {"diffuse_red", "diffuse_green", "diffuse_blue"}};
    const iso_ply_property *property = &ply->properties[element->first_property];
    double value[ISO_PLY_PROPERTIES], p[3] = {NAN, NAN, NAN}, rgb[3] = {NAN, NAN, NAN};
    ISO_TRY(iso_ply_read_item(ply, element, value, error));
    for (int i = 0; i < element->property_count; i++)
        for (int k = 0; k < 3 && !property[i].is_list; k++) {
            if (strcmp(property[i].name, names[k]) == 0) p[k] = value[i];
            if (strcmp(property[i].name, colors[0][k]) == 0 || strcmp(property[i].name, colors[1][k]) == 0) {
                rgb[k] = value[i];
                r->real_colors |= property[i].type == ISO_PLY_FLOAT32 || property[i].type == ISO_PLY_FLOAT64;
            }
        }
    ISO_TRY(iso_mesh_add_vertex(r, p, error));
    return isnan(rgb[0] + rgb[1] + rgb[2]) ? ISO_OK : iso_mesh_add_color(r, rgb, error);
}

static iso_status read_ply_corners(iso_mesh_reading *r, iso_ply *ply, const iso_ply_property *list,
                                   iso_error *error) {
    double count, corner;
    iso_mesh_polygon face = {0};
    ISO_TRY(iso_ply_read_value(ply, list->count_type, &count, error));
    if (!(count >= 0 && count <= POLYGON_MOST))
        return iso_fail(error, ISO_ERR_FORMAT, "%s: a face of %g corners", r->path, count);
    for (int i = 0; i < (int)count; i++) {
        ISO_TRY(iso_ply_read_value(ply, list->type, &corner, error));
        if (!(corner >= 0 && corner < UINT32_MAX))
            return iso_fail(error, ISO_ERR_FORMAT, "%s: a face has corner %g", r->path, corner);
        ISO_TRY(iso_mesh_add_corner(r, &face, (uint32_t)corner, error));
    }
    return iso_mesh_end_polygon(r, &face, error);
}

static iso_status read_ply_face(iso_mesh_reading *r, iso_ply *ply, const iso_ply_element *element,
                                iso_error *error) {
    for (int i = 0; i < element->property_count; i++) {
        const iso_ply_property *property = &ply->properties[element->first_property + i];
        const bool corners = property->is_list && (!strcmp(property->name, "vertex_indices") ||
                                                   !strcmp(property->name, "vertex_index"));
        double value;
        if (corners)
            ISO_TRY(read_ply_corners(r, ply, property, error));
        else if (property->is_list)
            ISO_TRY(iso_ply_skip_list(ply, property, error));
        else
            ISO_TRY(iso_ply_read_value(ply, property->type, &value, error));
    }
    return iso_ply_end_item(ply, error);
}

static iso_status read_ply_elements(iso_mesh_reading *r, iso_ply *ply, iso_error *error) {
    ISO_TRY(iso_ply_open(r->path, ply, error));
    r->ply = ply;
    r->bytes = (double)ply->in.remaining;
    for (int i = 0; i < ply->element_count; i++) {
        const iso_ply_element *element = &ply->elements[i];
        const bool vertices = strcmp(element->name, "vertex") == 0,
                   faces = strcmp(element->name, "face") == 0;
        /* an item without properties has no bytes: any number of them would fit into the file */
        if ((!vertices && !faces) || element->property_count == 0) {
            ISO_TRY(iso_ply_skip_element(ply, element, error));
            continue;
        }
        ISO_TRY(iso_ply_check_size(ply, element, error));
        for (uint64_t k = 0; k < element->count; k++)
            ISO_TRY(vertices ? read_ply_vertex(r, ply, element, error)
                             : read_ply_face(r, ply, element, error));
    }
    return ISO_OK;
}

iso_status iso_mesh_read_ply(iso_mesh_reading *r, iso_error *error) {
    iso_ply *ply = iso_alloc_zero(1, sizeof *ply);
    if (!ply) return iso_fail_memory(error, r->path);
    iso_status status = read_ply_elements(r, ply, error);
    iso_ply_close(ply);
    iso_free(ply);
    return status;
}
