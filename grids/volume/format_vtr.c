/* format_vtr: rectilinear grids in VTK's XML format, of one piece. The file is mapped while it is read. */
#include <string.h>

#include "base/file.h"
#include "grids/volume/mapping.h"
#include "grids/volume/rectilinear.h"
#include "grids/volume/vtk_xml.h"

enum { ARRAYS = ISO_VOLUME_ITEMS };

typedef struct vtr {
    iso_vtk_xml xml;
    iso_mapping *mapping;
    const iso_volume_opts *opts;
    uint64_t points[3];
    bool has_extent;
    int pieces;
    enum { NOTHING, POINT_DATA, CELL_DATA, COORDINATES } in;
    char active[ISO_XML_TEXT]; /* the name of the points' scalars */
    iso_vtk_array coordinates[3], stored[ARRAYS];
    int coordinate_count, count;
    iso_format_array arrays[ARRAYS];
} vtr;

static iso_status reserve(void *context, iso_buffer *buffer, size_t count, size_t each, iso_error *error) {
    const vtr *v = context;
    size_t bytes;
    if (!iso_size_multiply(count, each, &bytes)) bytes = SIZE_MAX;
    ISO_TRY(iso_format_check_memory(v->xml.path, v->opts, bytes, "an array", error));
    return iso_buffer_reserve(buffer, bytes, 0, NULL) == ISO_OK ? ISO_OK
                                                                : iso_fail_memory(error, v->xml.path);
}

/* ---- markup */

static iso_status take_extent(vtr *v, const iso_xml_tag *t, iso_error *error) {
    char text[ISO_XML_TEXT];
    int extent[6];
    if (!iso_xml_attribute(t, "WholeExtent", text) || !iso_vtk_xml_extent(text, extent))
        return iso_vtk_xml_bad(&v->xml, "its WholeExtent is not six whole numbers", error);
    for (int i = 0; i < 3; i++) v->points[i] = (uint64_t)((int64_t)extent[2 * i + 1] - extent[2 * i] + 1);
    v->has_extent = true;
    return ISO_OK;
}

/* The piece must be the whole grid. */
static iso_status take_piece(vtr *v, const iso_xml_tag *t, iso_error *error) {
    char text[ISO_XML_TEXT];
    int extent[6];
    bool whole = v->has_extent && ++v->pieces == 1;
    if (whole && iso_xml_attribute(t, "Extent", text)) {
        whole = iso_vtk_xml_extent(text, extent);
        for (int i = 0; whole && i < 3; i++)
            whole = (uint64_t)((int64_t)extent[2 * i + 1] - extent[2 * i] + 1) == v->points[i];
    }
    if (whole) return ISO_OK;
    return iso_fail(error, ISO_ERR_UNSUPPORTED, "%s: is in several pieces: save it in one", v->xml.path);
}

static iso_status take_array(vtr *v, const iso_xml_tag *t, iso_error *error) {
    iso_vtk_array array;
    bool known;
    if (v->in == NOTHING || !v->pieces) return ISO_OK;
    ISO_TRY(iso_vtk_xml_array(&v->xml, t, &array, &known, error));
    if (v->in == COORDINATES) {
        if (!known || v->coordinate_count == 3)
            return iso_vtk_xml_bad(&v->xml, "it has not three arrays of coordinates", error);
        v->coordinates[v->coordinate_count++] = array;
        return ISO_OK;
    }
    if (!known || v->count == ARRAYS) return ISO_OK;
    const bool cells = v->in == CELL_DATA;
    uint64_t tuples = 1;
    for (int i = 0; i < 3; i++)
        if (__builtin_mul_overflow(tuples, v->points[i] - (cells && v->points[i] > 1), &tuples))
            return iso_vtk_xml_ends(&v->xml, error);
    v->stored[v->count] = array;
    v->arrays[v->count] = (iso_format_array){.scalar = array.scalar,
                                             .components = array.components,
                                             .tuples = tuples,
                                             .cells = cells,
                                             .active = !cells && strcmp(array.name, v->active) == 0};
    memcpy(v->arrays[v->count++].name, array.name, sizeof array.name);
    return ISO_OK;
}

static iso_status take_tag(vtr *v, const iso_xml_tag *t, iso_error *error) {
    if (iso_xml_is(t, "RectilinearGrid")) return take_extent(v, t, error);
    if (iso_xml_is(t, "Piece")) return take_piece(v, t, error);
    if (iso_xml_is(t, "DataArray")) return take_array(v, t, error);
    if (iso_xml_is(t, "PointData")) {
        v->in = POINT_DATA;
        iso_xml_attribute(t, "Scalars", v->active);
    } else if (iso_xml_is(t, "CellData")) {
        v->in = CELL_DATA;
    } else if (iso_xml_is(t, "Coordinates")) {
        v->in = COORDINATES;
    } else if (iso_xml_is(t, "/PointData") || iso_xml_is(t, "/CellData") || iso_xml_is(t, "/Coordinates")) {
        v->in = NOTHING;
    }
    return ISO_OK;
}

static iso_status read_markup(vtr *v, uint64_t bytes, iso_error *error) {
    iso_xml_tag t;
    bool ended = false;
    ISO_TRY(iso_vtk_xml_open(&v->xml, iso_mapping_data(v->mapping), (size_t)bytes, "RectilinearGrid", error));
    while (!ended && iso_xml_next(&v->xml.markup, &t)) {
        ISO_TRY(take_tag(v, &t, error));
        ended = iso_xml_is(&t, "/RectilinearGrid");
    }
    if (!ended) return iso_vtk_xml_ends(&v->xml, error);
    return v->pieces && v->coordinate_count == 3
               ? ISO_OK
               : iso_vtk_xml_bad(&v->xml, "it has not three arrays of coordinates", error);
}

/* ---- the file */

static void close_vtr(vtr *v) {
    iso_mapping_destroy(v->mapping);
    iso_buffer *const buffers[] = {&v->xml.values, &v->xml.sizes, &v->xml.packed};
    for (size_t i = 0; i < sizeof buffers / sizeof *buffers; i++) iso_buffer_free(buffers[i]);
    iso_free(v);
}

static iso_status open_vtr(const char *path, const iso_volume_opts *opts, vtr **opened, iso_error *error) {
    FILE *file;
    uint64_t bytes;
    ISO_TRY(iso_file_open(path, &file, &bytes, error));
    vtr *v = iso_alloc_zero(1, sizeof *v);
    iso_status status =
        v ? iso_mapping_of_file(path, file, bytes, &v->mapping, error) : iso_fail_memory(error, path);
    fclose(file);
    if (status == ISO_OK) {
        v->opts = opts;
        v->xml = (iso_vtk_xml){.path = path, .reserve = reserve, .context = v};
        status = read_markup(v, bytes, error);
    }
    if (status == ISO_OK)
        *opened = v;
    else if (v)
        close_vtr(v);
    return status;
}

static iso_status take_coordinates(vtr *v, iso_rectilinear *axes, iso_error *error) {
    for (int axis = 0; axis < 3; axis++) {
        const iso_vtk_array *a = &v->coordinates[axis];
        if (a->components != 1) return iso_vtk_xml_bad(&v->xml, "coordinates that are vectors", error);
        ISO_TRY(iso_vtk_xml_decode(&v->xml, a, v->points[axis], error));
        const size_t count = (size_t)v->points[axis];
        double *at = axes->axis[axis] = iso_alloc(count * sizeof *at);
        if (!at) return iso_fail_memory(error, v->xml.path);
        for (size_t i = 0; i < count; i++) at[i] = iso_vtk_xml_number(&v->xml, a, i);
        axes->count[axis] = (int)count;
    }
    return ISO_OK;
}

static iso_status describe(vtr *v, iso_rectilinear *axes, iso_volume_info *info, int *chosen,
                           iso_error *error) {
    const iso_format_image image = {{v->points[0], v->points[1], v->points[2]}, v->arrays, v->count};
    ISO_TRY(iso_format_dims(v->xml.path, v->points, info, error));
    ISO_TRY(take_coordinates(v, axes, error));
    ISO_TRY(iso_format_take_array(v->xml.path, v->opts, &image, info, chosen, error));
    if (v->arrays[*chosen].cells) iso_rectilinear_take_cells(axes);
    for (int axis = 0; axis < 3; axis++) info->transform.origin[axis] = axes->axis[axis][0];
    const iso_vtk_array *a = &v->stored[*chosen];
    uint64_t each = a->components * iso_scalar_size(a->scalar);
    if (a->encoding == ISO_VTI_TEXT) {
        info->type = ISO_FLOAT32;
        each = a->components * sizeof(double);
    }
    const uint64_t voxels = iso_format_size(info->dims, iso_type_size(info->type)),
                   values = iso_format_size(info->dims, each);
    if (__builtin_add_overflow(voxels, values, &info->read_bytes)) info->read_bytes = UINT64_MAX;
    return ISO_OK;
}

static iso_status vtr_info(const char *path, const iso_volume_opts *opts, iso_volume_info *info,
                           iso_error *error) {
    vtr *v;
    int chosen;
    ISO_TRY(open_vtr(path, opts, &v, error));
    const iso_status status = describe(v, opts->axes, info, &chosen, error);
    close_vtr(v);
    return status;
}

static iso_status read_voxels(vtr *v, const iso_volume_info *info, iso_grid *grid, iso_error *error) {
    iso_volume_info now = {.transform = iso_transform_identity()};
    iso_rectilinear axes = {.count = {0, 0, 0}};
    int chosen = 0;
    const iso_status status = describe(v, &axes, &now, &chosen, error);
    iso_rectilinear_free(&axes);
    ISO_TRY(status);
    if (memcmp(now.dims, info->dims, sizeof now.dims) != 0 || now.type != info->type ||
        now.component != info->component)
        return iso_fail(error, ISO_ERR_IO, "%s: changed while it was read", v->xml.path);
    const iso_vtk_array *a = &v->stored[chosen];
    const bool text = a->encoding == ISO_VTI_TEXT;
    const uint64_t voxels = v->arrays[chosen].tuples;
    uint64_t numbers;
    if (__builtin_mul_overflow(voxels, a->components, &numbers)) return iso_vtk_xml_ends(&v->xml, error);
    ISO_TRY(iso_vtk_xml_decode(&v->xml, a, numbers, error));
    ISO_TRY(iso_format_create(v->xml.path, info, NULL, grid, error));
    const iso_scalar_source source = {.data = v->xml.values.data,
                                      .scalar = text ? ISO_SCALAR_DOUBLE : a->scalar,
                                      .components = (int)a->components,
                                      .component = info->component,
                                      .swap = !text &&
                                              v->xml.big_endian != (__BYTE_ORDER__ == __ORDER_BIG_ENDIAN__)};
    iso_scalar_convert(&source, (size_t)voxels, info->type, grid->rgrid->data);
    return ISO_OK;
}

static iso_status vtr_read(const char *path, const iso_volume_opts *opts, iso_volume_info *info,
                           iso_grid *grid, iso_error *error) {
    vtr *v;
    ISO_TRY(open_vtr(path, opts, &v, error));
    const iso_status status = read_voxels(v, info, grid, error);
    close_vtr(v);
    return status;
}

const iso_format iso_format_vtr = {"vtr", "isopoint", NULL, vtr_info, vtr_read, NULL};
