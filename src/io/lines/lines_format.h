/* lines_format: the readers of single formats, behind iso_lines_read. Internal to src/io/lines. Each returns
 * the errors of iso_lines_read, whose messages begin with the path, and sets `lines` only when it succeeds.
 */
#ifndef ISO_IO_LINES_LINES_FORMAT_H
#define ISO_IO_LINES_LINES_FORMAT_H

#include "io/common/reading.h"

iso_status iso_lines_read_tck(iso_reading *reading, iso_lines *lines, iso_error *error);
iso_status iso_lines_read_trk(iso_reading *reading, iso_lines *lines, iso_error *error);
iso_status iso_lines_read_swc(iso_reading *reading, iso_lines *lines, iso_error *error);
iso_status iso_lines_read_obj(iso_reading *reading, iso_lines *lines, iso_error *error);
iso_status iso_lines_read_vtp(iso_reading *reading, iso_lines *lines, iso_error *error);
iso_status iso_lines_read_vtk(iso_reading *reading, iso_lines *lines, iso_error *error);
iso_status iso_lines_read_ply(iso_reading *reading, iso_lines *lines, iso_error *error);

#endif
