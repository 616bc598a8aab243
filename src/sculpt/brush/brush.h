/* brush: looks up the names of tools, solids and falloffs, and checks the numbers of a brush.
 *
 * The types iso_brush and iso_sample are in isopoint.h. Their lengths (radius, blend) are in millimetres and
 * their positions in world coordinates, never screen coordinates, so a stroke can be replayed on another grid
 * with another voxel size. sculpt/brush/brush_to_voxels.c converts them to voxels (iso_dabs of dab.h). */
#ifndef ISO_SCULPT_BRUSH_BRUSH_H
#define ISO_SCULPT_BRUSH_BRUSH_H

#include <stdbool.h>
#include <stddef.h>

#include "base/c_linkage.h"
#include "base/geometry.h"
#include "base/status.h"
#include "isopoint.h"

ISO_C_BEGIN

/* The tools: X(enumerator, name in stroke files). ADD to BLEND_CARVE are set operations with a solid, SMOOTH
 * to MOVE deform the surface, those of the mask change only it, and PAINT only the paint. */
#define ISO_TOOLS(X)                                                                                         \
    X(ADD, "add")                 /* union with the solid */                                                 \
    X(CARVE, "carve")             /* difference */                                                           \
    X(BLEND_ADD, "blend-add")     /* union with a fillet of width `blend` */                                 \
    X(BLEND_CARVE, "blend-carve") /* difference with a fillet */                                             \
    X(SMOOTH, "smooth")                                                                                      \
    X(INFLATE, "inflate")                                                                                    \
    X(DEFLATE, "deflate")                                                                                    \
    X(FLATTEN,                                                                                               \
      "flatten")        /* moves the surface to the plane through the sample, perpendicular to its normal */ \
    X(SCRAPE, "scrape") /* removes what is above the mean plane of the surface within the radius */          \
    X(FILL, "fill")     /* fills what is below that plane */                                                 \
    X(CLAY, "clay")     /* fills what is below a plane a little above that one */                            \
    X(PINCH, "pinch")   /* gathers the surface around the line through the sample along its normal */        \
    X(CREASE, "crease") /* pinches, and moves the surface against its normal */                              \
    X(SNAKE_HOOK, "snake-hook")   /* drags the surface from the previous sample to the current one */        \
    X(MOVE, "move")               /* drags the surface from the stroke's first sample to the current one */  \
    X(MASK, "mask")               /* freezes the voxels within the radius */                                 \
    X(UNMASK, "unmask")           /* unfreezes them */                                                       \
    X(CLEAR_MASK, "clear-mask")   /* at a stroke's first sample: unfreezes all voxels of the grid */         \
    X(INVERT_MASK, "invert-mask") /* the same: freezes the voxels that are not frozen, unfreezes the rest */ \
    X(BLUR_MASK, "blur-mask")     /* the same: smooths the mask's border (sculpt/edit/mask_rewrite.h) */     \
    X(MASK_VOXELS, "mask-voxels") /* the same: freezes those of the stamp (brush/voxel_set.h) */             \
    X(PAINT, "paint")             /* lays a colour over the surface (sculpt/edit/painter.h) */               \
    X(TRIM_PLANE, "trim-plane")   /* removes what is on one side of a plane (sculpt/brush/outline.h) */      \
    X(TRIM_LASSO, "trim-lasso")   /* removes what is within an outline */                                    \
    X(CROP_LASSO, "crop-lasso")   /* removes what is outside of it */

/* The solids of set operations, centred on the sample with the z axis along its normal. Sizes are in units of
 * the radius. */
#define ISO_SOLIDS(X)                                                                                        \
    X(SPHERE, "sphere")                                                                                      \
    X(BOX, "box")           /* half sides 1, `aspect`, `aspect` */                                           \
    X(CAPSULE, "capsule")   /* from the previous sample to this one */                                       \
    X(CYLINDER, "cylinder") /* radius 1, half height `aspect` */                                             \
    X(TORUS, "torus")       /* ring radius 1, tube radius `aspect` */                                        \
    X(STAMP, "stamp")       /* a mesh, as a distance field (sculpt/brush/stamp.h) */

/* The factor by which a deforming touch acts on a voxel: 1 at the centre, 0 at the radius. t = distance from
 * the centre / radius. */
#define ISO_FALLOFFS(X)                                                                                      \
    X(SMOOTH, "smooth")     /* (1 - t^2)^2 */                                                                \
    X(LINEAR, "linear")     /* 1 - t */                                                                      \
    X(CONSTANT, "constant") /* 1 up to the radius */

#define ISO_ALPHAS(X)                                                                                        \
    X(NONE, "none")                                                                                          \
    X(FIXED, "fixed")                                                                                        \
    X(FOLLOWS, "follows")

/* Return the name that stroke files use for an enumerator; a static string. */
const char *iso_tool_name(iso_tool tool);
const char *iso_solid_name(iso_solid solid);
const char *iso_falloff_name(iso_falloff falloff);
const char *iso_alpha_name(iso_alpha alpha);
/* Find the enumerator with a name. ISO_ERR_USAGE: there is no such name; the message quotes it. */
iso_status iso_tool_find(const char *name, iso_tool *tool, iso_error *error);
iso_status iso_solid_find(const char *name, iso_solid *solid, iso_error *error);
iso_status iso_falloff_find(const char *name, iso_falloff *falloff, iso_error *error);
iso_status iso_alpha_find(const char *name, iso_alpha *alpha, iso_error *error);

/* Checks the enumerators and numbers of a brush. ISO_ERR_USAGE: one of them is not finite or outside its
 * range; the message names it. */
iso_status iso_brush_check(const iso_brush *brush, iso_error *error);

bool iso_brush_is_same(const iso_brush *a, const iso_brush *b);

/* The samples that determine a touch: its own, that of the touch before it and the first one of the stroke.
 * At the start of a stroke all three are the same. */
typedef struct iso_touch {
    iso_sample sample, previous, first;
    const iso_sample *path; /* all samples of a stroke that acts when it ends (iso_tool_is_trim); else NULL */
    size_t path_count;
} iso_touch;

/* Whether the tool acts once, when its stroke ends, by all the stroke's samples: TRIM_PLANE to CROP_LASSO. */
bool iso_tool_is_trim(iso_tool tool);
/* Whether a picture of heights weighs what the tool does: SMOOTH to CLAY. */
bool iso_tool_has_alpha(iso_tool tool);

/* symmetry.c: the images of a touch, all of which act: repeated ones, with radial symmetry turned ones of
 * these, and with mirror planes the mirror images of all. The first is the touch itself. Unless it is
 * repeated no two are the same. */
enum { ISO_RADIAL_MOST = 32, ISO_IMAGES_MOST = 8 * ISO_RADIAL_MOST };

/* First moved, then turned around an axis, then mirrored. */
typedef struct iso_brush_image {
    bool moved;
    iso_vec3 by;
    iso_vec3 through; /* a point of the axis and of all mirror planes */
    int axis;         /* 0: x, 1: y, 2: z */
    bool turned;
    double cosine, sine;
    unsigned mirrored; /* bit a: at the plane perpendicular to axis a */
} iso_brush_image;

bool iso_brush_is_radial(const iso_brush *brush);
/* The axis of the radial symmetry, 0 (x) to 2 (z, also if the brush names none). */
int iso_brush_radial_axis(const iso_brush *brush);
bool iso_brush_is_repeated(const iso_brush *brush);
/* Returns the number of images; a brush with more than ISO_IMAGES_MOST is refused (iso_brush_check). */
int iso_brush_image_count(const iso_brush *brush);
/* Lists the images of a brush's touches, at most ISO_IMAGES_MOST, and returns their number. */
int iso_brush_images(const iso_brush *brush, iso_brush_image images[ISO_IMAGES_MOST]);
/* Return the image of a point and of a direction; by half and quarter turns and mirrors these are exact but
 * for the rounding of sums. */
iso_vec3 iso_brush_image_point(const iso_brush_image *image, iso_vec3 point);
iso_vec3 iso_brush_image_direction(const iso_brush_image *image, iso_vec3 direction);

ISO_C_END
#endif
