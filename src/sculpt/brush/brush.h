/* brush: what a hand holds, and one touch of it.
 *
 * All lengths are world millimetres and all positions world positions, never screen coordinates: a stroke is
 * data that can be replayed on another grid, at another voxel size. Every number is a double that is written
 * to the journal with all its digits. */
#ifndef ISO_SCULPT_BRUSH_BRUSH_H
#define ISO_SCULPT_BRUSH_BRUSH_H

#include <stdbool.h>

#include "base/geometry.h"
#include "base/status.h"
#include "isopoint.h"

#ifdef __cplusplus
extern "C" {
#endif

/* What a touch does to the field. The first group are set operations with a shape, the second deforms what is
 * there (sculpt/field/edit.h says how the two keep the field a distance field). */
#define ISO_TOOLS(X)                                                                                         \
    X(ADD, "add")             /* union with the shape */                                                     \
    X(CARVE, "carve")         /* difference */                                                               \
    X(BLEND_ADD, "blend-add") /* smooth union, over `blend` */                                               \
    X(BLEND_CARVE, "blend-carve")                                                                            \
    X(SMOOTH, "smooth")                                                                                      \
    X(INFLATE, "inflate")                                                                                    \
    X(DEFLATE, "deflate")                                                                                    \
    X(FLATTEN, "flatten") /* towards the plane of the sample's position and normal */                        \
    X(PINCH, "pinch")     /* towards the axis of the sample's normal */                                      \
    X(MOVE, "move")       /* drags what lay at the stroke's first sample to the current one */               \
    X(MASK, "mask")       /* freezes what it touches */                                                      \
    X(UNMASK, "unmask")

/* The solid of a set operation, centred on the sample, its z axis along the sample's normal. Sizes are in
 * units of the radius. */
#define ISO_SOLIDS(X)                                                                                        \
    X(SPHERE, "sphere")                                                                                      \
    X(BOX, "box")           /* half sides 1, `aspect`, `aspect` */                                           \
    X(CAPSULE, "capsule")   /* from the sample before to this one */                                         \
    X(CYLINDER, "cylinder") /* radius 1, half height `aspect` */                                             \
    X(TORUS, "torus")       /* ring radius 1, tube radius `aspect` */                                        \
    X(STAMP, "stamp")       /* a field of its own (sculpt/brush/stamp.h) */

/* How the effect of a deforming touch fades from 1 at the centre to 0 at the radius. */
#define ISO_FALLOFFS(X)                                                                                      \
    X(SMOOTH, "smooth") /* (1 - t^2)^2 */                                                                    \
    X(LINEAR, "linear")                                                                                      \
    X(CONSTANT, "constant")

const char *iso_tool_name(iso_tool tool);
const char *iso_solid_name(iso_solid shape);
const char *iso_falloff_name(iso_falloff falloff);
/* ISO_ERR_USAGE, naming what was asked for, when there is no such name. */
iso_status iso_tool_find(const char *name, iso_tool *tool, iso_error *error);
iso_status iso_solid_find(const char *name, iso_solid *shape, iso_error *error);
iso_status iso_falloff_find(const char *name, iso_falloff *falloff, iso_error *error);

/* ISO_ERR_USAGE naming the value: a number that is not finite or outside its range. */
iso_status iso_brush_check(const iso_brush *brush, iso_error *error);

#ifdef __cplusplus
}
#endif
#endif
