/* polydata_formats: glyphs of the formats that are read as polydata. */
#include "io/glyphs/glyphs_format.h"
#include "io/polydata/polydata.h"

static iso_status read_as(iso_status (*read)(iso_polydata *data, iso_error *error), iso_reading *reading,
                          iso_glyphs *glyphs, iso_error *error) {
    iso_polydata data = {.reading = reading, .points_only = true};
    iso_status status = read(&data, error);
    if (status == ISO_OK) status = iso_polydata_to_glyphs(&data, glyphs, error);
    iso_polydata_free(&data);
    return status;
}

iso_status iso_glyphs_read_vtk(iso_reading *reading, iso_glyphs *glyphs, iso_error *error) {
    return read_as(iso_polydata_read_vtk, reading, glyphs, error);
}

iso_status iso_glyphs_read_ply(iso_reading *reading, iso_glyphs *glyphs, iso_error *error) {
    return read_as(iso_polydata_read_ply, reading, glyphs, error);
}

iso_status iso_glyphs_read_obj(iso_reading *reading, iso_glyphs *glyphs, iso_error *error) {
    return read_as(iso_polydata_read_obj, reading, glyphs, error);
}

iso_status iso_glyphs_read_vtp(iso_reading *reading, iso_glyphs *glyphs, iso_error *error) {
    return read_as(iso_polydata_read_vtp, reading, glyphs, error);
}
