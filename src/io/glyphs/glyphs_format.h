/* glyphs_format: the readers of single formats, behind iso_glyphs_read. Internal to src/io/glyphs. Each
 * returns the errors of iso_glyphs_read, whose messages begin with the path, and sets `glyphs` only when it
 * succeeds. */
#ifndef ISO_IO_GLYPHS_GLYPHS_FORMAT_H
#define ISO_IO_GLYPHS_GLYPHS_FORMAT_H

#include "base/glyphs.h"
#include "io/common/reading.h"

iso_status iso_glyphs_read_vtp(iso_reading *reading, iso_glyphs *glyphs, iso_error *error);
iso_status iso_glyphs_read_vtk(iso_reading *reading, iso_glyphs *glyphs, iso_error *error);
iso_status iso_glyphs_read_ply(iso_reading *reading, iso_glyphs *glyphs, iso_error *error);
iso_status iso_glyphs_read_xyz(iso_reading *reading, iso_glyphs *glyphs, iso_error *error);
iso_status iso_glyphs_read_csv(iso_reading *reading, iso_glyphs *glyphs, iso_error *error);
iso_status iso_glyphs_read_pdb(iso_reading *reading, iso_glyphs *glyphs, iso_error *error);
iso_status iso_glyphs_read_pcd(iso_reading *reading, iso_glyphs *glyphs, iso_error *error);
iso_status iso_glyphs_read_npy(iso_reading *reading, iso_glyphs *glyphs, iso_error *error);
iso_status iso_glyphs_read_rows(iso_reading *reading, iso_glyphs *glyphs, iso_error *error);
iso_status iso_glyphs_read_off(iso_reading *reading, iso_glyphs *glyphs, iso_error *error);
iso_status iso_glyphs_read_obj(iso_reading *reading, iso_glyphs *glyphs, iso_error *error);
iso_status iso_glyphs_read_las(iso_reading *reading, iso_glyphs *glyphs, iso_error *error);

#endif
