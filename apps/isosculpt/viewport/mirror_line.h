/* mirror_line: the lines along which a mirror plane cuts the visible surface. */
#ifndef ISO_APPS_ISOSCULPT_VIEWPORT_MIRROR_LINE_H
#define ISO_APPS_ISOSCULPT_VIEWPORT_MIRROR_LINE_H

#include "apps/isosculpt/viewport/viewport.h"
#include "base/c_linkage.h"

ISO_C_BEGIN

/* A line from (x[0], y[0]) to (x[1], y[1]), pixels of the full picture. */
typedef struct isosculpt_segment {
    double x[2], y[2];
} isosculpt_segment;

/* Finds where the surface in `buffer` crosses the plane on which the world coordinate `axis` (0: x) is `at`
 * mm, looking at every fourth sample. Writes at most `room` segments and returns their number; 0 for a buffer
 * on the GPU, whose samples would have to be read back. */
size_t isosculpt_mirror_lines(const isosculpt_pick_buffer *buffer, int axis, double at,
                              isosculpt_segment *segments, size_t room);

ISO_C_END
#endif
