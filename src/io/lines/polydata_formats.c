/* polydata_formats: lines of the formats that are read as polydata. */
#include "io/lines/lines_format.h"
#include "io/polydata/polydata.h"

static iso_status read_as(iso_status (*read)(iso_polydata *data, iso_error *error), iso_reading *reading,
                          iso_lines *lines, iso_error *error) {
    iso_polydata data = {.reading = reading};
    iso_status status = read(&data, error);
    if (status == ISO_OK) status = iso_polydata_to_lines(&data, lines, error);
    iso_polydata_free(&data);
    return status;
}

iso_status iso_lines_read_vtk(iso_reading *reading, iso_lines *lines, iso_error *error) {
    return read_as(iso_polydata_read_vtk, reading, lines, error);
}

iso_status iso_lines_read_ply(iso_reading *reading, iso_lines *lines, iso_error *error) {
    return read_as(iso_polydata_read_ply, reading, lines, error);
}

iso_status iso_lines_read_obj(iso_reading *reading, iso_lines *lines, iso_error *error) {
    return read_as(iso_polydata_read_obj, reading, lines, error);
}

iso_status iso_lines_read_vtp(iso_reading *reading, iso_lines *lines, iso_error *error) {
    return read_as(iso_polydata_read_vtp, reading, lines, error);
}
