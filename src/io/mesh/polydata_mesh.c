/* Meshes in formats of polygonal data: legacy .vtk, .vtp, .off. */
#include "io/mesh/mesh_format.h"

#include <math.h>

#include "io/polydata/faces.h"
#include "io/polydata/polydata.h"

/* Makes the vertices of the points. */
static iso_status take_points(iso_mesh_reading *r, iso_polydata *data, iso_error *error) {
    const double turn = data->stated == ISO_SPACE_RAS ? -1 : 1;
    float(*p)[3] = data->points.data;
    for (size_t i = 0; i < data->point_count; i++) {
        if (isnan(p[i][0]))
            return iso_fail(error, ISO_ERR_FORMAT, "%s: vertex %zu is not finite", r->path, i + 1);
        p[i][0] = (float)(turn * (data->origin.x + (double)p[i][0]));
        p[i][1] = (float)(turn * (data->origin.y + (double)p[i][1]));
        p[i][2] = (float)(data->origin.z + (double)p[i][2]);
    }
    r->vertices = data->points;
    r->vertex_count = data->point_count;
    data->points = (iso_buffer){0};
    return ISO_OK;
}

static iso_status read_polydata(iso_mesh_reading *r, iso_status (*read)(iso_polydata *data, iso_error *error),
                                iso_error *error) {
    iso_faces faces = {0};
    iso_polydata data = {.reading = &r->text, .points_only = true, .surface = &faces};
    r->text = iso_reading_begin(r->path, NULL, &r->report);
    iso_status status = read(&data, error);
    if (status == ISO_OK) status = take_points(r, &data, error);
    if (status == ISO_OK) status = iso_progress_tell(r->progress, r->path, 1, error);
    r->triangles = faces.corners;
    r->triangle_count = faces.count;
    r->fans = faces.fans;
    r->fan_count = faces.fan_count;
    iso_polydata_free(&data);
    return status;
}

iso_status iso_mesh_read_vtk(iso_mesh_reading *r, iso_error *error) {
    return read_polydata(r, iso_polydata_read_vtk, error);
}

iso_status iso_mesh_read_vtp(iso_mesh_reading *r, iso_error *error) {
    return read_polydata(r, iso_polydata_read_vtp, error);
}

iso_status iso_mesh_read_off(iso_mesh_reading *r, iso_error *error) {
    return read_polydata(r, iso_polydata_read_off, error);
}
