/* fans: polygons of meshes as triangles. A reader divides every polygon into the fan of triangles around its
 * first corner, which is right for a convex one, and remembers those of four and more corners. When all
 * points are known, the polygons whose fan is wrong are divided by ear clipping. Internal to src/io. */
#ifndef ISO_IO_COMMON_FANS_H
#define ISO_IO_COMMON_FANS_H

#include <stddef.h>
#include <stdint.h>

#include "base/status.h"

/* A polygon of `corners` corners, at least 4, whose corners - 2 triangles begin with number `first`. */
typedef struct iso_fan {
    size_t first, corners;
} iso_fan;

/* Divides anew every polygon of which a triangle faces against the polygon, as concave ones have; all others
 * keep their fans. The numbers of triangles stay. Concave polygons may touch themselves, as those with a hole
 * that is joined to the outline do. Polygons that cross themselves or enclose no area are divided somehow.
 * `triangles` name points that exist. `path` is used in messages. Time: at most 16384 steps for each corner;
 * ISO_ERR_FORMAT: a polygon of over 16384 corners would take more; ISO_ERR_NOMEM. */
iso_status iso_fans_divide(const char *path, const iso_fan *fans, size_t count, const float (*points)[3],
                           uint32_t (*triangles)[3], iso_error *error);

#endif
