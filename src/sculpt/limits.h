/* limits: the bounds of every number in a stroke file, and of the computation that replaying it may take.
 *
 * Stroke files may come from untrusted sources and are replayed without asking. Everything that can be
 * recorded in the program's window lies well within the bounds; anything else is an error when its line is
 * read or replayed. Lengths are bounded in voxels of the file's grid, because voxels cost time and memory. */
#ifndef ISO_SCULPT_LIMITS_H
#define ISO_SCULPT_LIMITS_H

#include "base/status.h"

/* X(name, text in messages, lowest, highest, unit). With the unit "voxels" the value is a length in
 * millimetres, compared after division by the voxel size. Values with other units are compared as they are.
 */
#define ISO_STROKE_LIMITS(X)                                                                                 \
    /* the first line */                                                                                     \
    X(VOXEL_SIZE, "voxel size", 1e-12, 1e12, "mm")                                                           \
    X(DIMS, "number of voxels along an axis", 1, 2048, "") /* ISO_HGRID_MAX */                               \
    X(ORIGIN, "origin", -1e9, 1e9, "voxels")                                                                 \
    X(BALL, "radius of the ball", 0.01, 1024, "voxels")                                                      \
    X(SIZE, "size of the solid", 0.01, 4096, "voxels")                                                       \
    X(ISOVALUE, "isovalue", -1e300, 1e300, "")                                                               \
    X(CHECKSUM, "checksum of the source", -2147483648.0, 4294967295.0, "")                                   \
    /* a brush, whatever it comes from; a spacing, aspect or blend of 0 is the default */                    \
    X(RADIUS, "radius", 0.01, 1024, "voxels")                                                                \
    X(STRENGTH, "strength", 0, 1, "")                                                                        \
    X(ASPECT, "aspect", 0, 10, "radii")                                                                      \
    X(BLEND, "blend", 0, 1024, "voxels")                                                                     \
    X(SPACING, "spacing", 0.01, 10, "radii")                                                                 \
    X(SYMMETRY, "symmetry", 0, 7, "")                                                                        \
    X(RADIAL, "radial", 2, 32, "images")  /* ISO_RADIAL_MOST */                                              \
    X(REPEAT, "repeat", 0, 256, "images") /* ISO_IMAGES_MOST */                                              \
    X(REPEAT_BY, "distance of repeated images", -1e6, 1e6, "voxels")                                         \
    X(MIRROR, "mirror plane", -1e9, 1e9, "voxels")                                                           \
    /* a sample; positions are relative to the grid's first voxel */                                         \
    X(POSITION, "distance from the grid's origin", -1e6, 1e6, "voxels")                                      \
    X(NORMAL, "component of a normal", -1000, 1000, "")                                                      \
    X(PRESSURE, "pressure", 0, 1, "")                                                                        \
    X(SECONDS, "time", 0, 1e9, "s")                                                                          \
    X(STROKE, "number of a stroke", 1, 1e9, "")                                                              \
    X(PICTURE, "stamp's number of pixels along an axis", 1, 256, "") /* ISO_HEIGHTS_MOST */                  \
    /* a stamp's fields: their longest side is 2 */                                                          \
    X(STAMP_DIMS, "stamp's number of voxels along an axis", 1, 1024, "")                                     \
    X(STAMP_SPACING, "stamp's voxel size", 1e-3, 1, "")                                                      \
    X(STAMP_ORIGIN, "stamp's origin", -64, 64, "")

typedef enum iso_limit {
#define ISO_LIMIT_ENUM(name, text, low, high, unit) ISO_LIMIT_##name,
    ISO_STROKE_LIMITS(ISO_LIMIT_ENUM)
#undef ISO_LIMIT_ENUM
        ISO_LIMIT_COUNT
} iso_limit;

/* The largest size of a line in bytes, its newline included; the largest stamp takes a quarter of this. */
enum { ISO_LIMIT_LINE = 64 << 20 };
/* The largest number of touches of one sample; with the smallest brush of the window this is a path of half a
 * million voxels. */
enum { ISO_LIMIT_TOUCHES = 1 << 20 };
/* The largest number of cells that one touch may edit; each needs several scratch copies of 16 KiB. */
enum { ISO_LIMIT_TOUCH_CELLS = 1 << 18 };
/* The largest number of checkpoints that are tried before a journal is replayed from its beginning. */
enum { ISO_LIMIT_CHECKPOINTS = 8 };
/* Returns the largest cost (iso_editor_cost) that replaying a file with this many samples may have. A million
 * cells for each sample: a recording with such a cost would have kept its user waiting for 10 s at each
 * sample. */
static inline double iso_limit_cost(double samples) {
    return (double)(1 << 22) + (double)(1 << 20) * samples;
}

/* Checks a value. ISO_ERR_FORMAT: it is NaN or outside its bounds; the message has the value and the bounds.
 * `voxel` is the voxel size in millimetres, used for lengths. */
iso_status iso_limit_check(iso_limit limit, double value, double voxel, iso_error *error);

#endif
