/* limits: the bounds of every number that a stroke file holds, and of the work that it may ask for.
 *
 * A stroke file may come from anybody, and is played without being asked about. All that a person can make in
 * the window lies well within these bounds; what lies outside is refused where the line is read, or where it
 * is played. Lengths are bounded in voxels of the file's own grid: it is voxels that cost time and memory. */
#ifndef ISO_SCULPT_SESSION_LIMITS_H
#define ISO_SCULPT_SESSION_LIMITS_H

#include "sculpt/session/journal.h"

#ifdef __cplusplus
extern "C" {
#endif

/* X(name, text, lowest, highest, unit). A unit of "voxels" is a length in millimetres that is compared after
 * division by the voxel size; "radii", "s", "mm" and "" are compared as they are. */
#define ISO_STROKE_LIMITS(X)                                                                                 \
    /* the first line */                                                                                     \
    X(VOXEL_SIZE, "voxel size", 1e-12, 1e12, "mm")                                                           \
    X(DIMS, "number of voxels along an axis", 1, 2048, "") /* ISO_HGRID_MAX */                               \
    X(ORIGIN, "origin", -1e9, 1e9, "voxels")                                                                 \
    X(BALL, "radius of the ball", 0.01, 1024, "voxels")                                                      \
    X(ISOVALUE, "isovalue", -1e300, 1e300, "")                                                               \
    X(CHECKSUM, "checksum of the source", -2147483648.0, 4294967295.0, "")                                   \
    /* a brush; a spacing, aspect or blend of 0 is the default */                                            \
    X(RADIUS, "radius", 0.01, 1024, "voxels")                                                                \
    X(STRENGTH, "strength", 0, 1, "")                                                                        \
    X(ASPECT, "aspect", 0, 10, "radii")                                                                      \
    X(BLEND, "blend", 0, 1024, "voxels")                                                                     \
    X(SPACING, "spacing", 0.01, 10, "radii")                                                                 \
    X(SYMMETRY, "symmetry", 0, 7, "")                                                                        \
    X(MIRROR, "mirror plane", -1e9, 1e9, "voxels")                                                           \
    /* a sample; positions are taken from the grid's first voxel */                                          \
    X(POSITION, "distance from the grid's origin", -1e6, 1e6, "voxels")                                      \
    X(NORMAL, "component of a normal", -1000, 1000, "")                                                      \
    X(PRESSURE, "pressure", 0, 1, "")                                                                        \
    X(SECONDS, "time", 0, 1e9, "s")                                                                          \
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

/* Bytes of a line, its newline included: the largest stamp takes a quarter of it. */
enum { ISO_LIMIT_LINE = 64 << 20 };
/* Touches that one sample makes: with the smallest brush of the window, half a million voxels of way. */
enum { ISO_LIMIT_TOUCHES = 1 << 20 };
/* Cells that one touch lists: each takes 16 KiB of scratch memory, several times. */
enum { ISO_LIMIT_TOUCH_CELLS = 1 << 18 };
/* Snapshots that are tried before a session is played from its beginning. */
enum { ISO_LIMIT_SNAPSHOTS = 8 };
/* Work of a whole file, in cells edited (iso_editor_work; some 10 microseconds each): so much, and so much
 * more for each sample. A hand that makes a million cells of work with every sample would wait for 10 s
 * each time. */
static inline double iso_limit_work(double samples) {
    return (double)(1 << 22) + (double)(1 << 20) * samples;
}

/* ISO_ERR_FORMAT, naming the number and its bounds, when it is outside (or not a number). `voxel` is the
 * voxel size in millimetres, for lengths. */
iso_status iso_limit_check(iso_limit limit, double value, double voxel, iso_error *error);

/* The same for all numbers of a header, and of an event in the file that begins with it. Who writes a file
 * asks before, so that it can be read. */
iso_status iso_limits_start(const iso_journal_start *start, iso_error *error);
iso_status iso_limits_event(const iso_event *event, const iso_journal_start *start, iso_error *error);

#ifdef __cplusplus
}
#endif
#endif
