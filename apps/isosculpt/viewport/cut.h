/* cut: what is cut away of what a viewport shows, as --clip of isorender writes it (scene/cuts.h); and the
 * plane among these cuts that has a handle in the picture, by which the mouse moves and tilts it. */
#ifndef ISO_APPS_ISOSCULPT_VIEWPORT_CUT_H
#define ISO_APPS_ISOSCULPT_VIEWPORT_CUT_H

#include "apps/common/cap_style.h"
#include "base/c_linkage.h"
#include "scene/cuts.h"

ISO_C_BEGIN

enum { ISOSCULPT_CUT_TEXT = 200 };

/* Zero-initialised with plane -1, nothing is cut. */
typedef struct isosculpt_cut {
    iso_cut cuts[ISO_CLIP_BODIES];
    char texts[ISO_CLIP_BODIES][ISOSCULPT_CUT_TEXT]; /* of which the cuts were made */
    int count;
    int plane;                /* the cut that has the handle, a half-space; -1: none */
    iso_vec3 handle, outward; /* a point of that plane; unit, towards what it cuts away */
    iso_cap_style cap;
    double window[2]; /* centre and width of the values that caps show; NAN: all of the volume */
} isosculpt_cut;

/* Adds a cut (iso_cut_parse); the first one that is a plane gets the handle, at its point next to `middle`.
 * ISO_ERR_USAGE, ISO_ERR_LIMIT. */
iso_status isosculpt_cut_add(isosculpt_cut *cut, const char *text, iso_vec3 middle, iso_error *error);
/* Puts the plane with the handle, which is added if there is none, through a point; `outward` (not zero)
 * points to what it cuts away. No room for it: does nothing. */
void isosculpt_cut_place(isosculpt_cut *cut, iso_vec3 point, iso_vec3 outward);
/* Takes the plane with the handle away. */
void isosculpt_cut_remove_plane(isosculpt_cut *cut);

/* The handle in a picture; pixels. */
typedef struct isosculpt_cut_handle {
    double x, y;         /* of the point on the plane */
    double tip_x, tip_y; /* of the tip of an arrow from there along `outward` */
    double mm;           /* of a pixel at the handle's depth */
} isosculpt_cut_handle;
/* Which part of the handle is at a place: the point moves the plane along its normal, the tip tilts it. */
typedef enum isosculpt_cut_part {
    ISOSCULPT_CUT_NOTHING,
    ISOSCULPT_CUT_POINT,
    ISOSCULPT_CUT_TIP
} isosculpt_cut_part;

/* Half the size of the handle's parts, and the length of its arrow; pixels at scale 1. */
#define ISOSCULPT_CUT_GRIP 9.0
#define ISOSCULPT_CUT_ARROW 64.0

/* Finds the handle in a picture of `view`, whose text has this scale; false: there is none, or it lies behind
 * the eye. */
bool isosculpt_cut_find_handle(const isosculpt_cut *cut, const iso_view *view, double scale,
                               isosculpt_cut_handle *handle);
isosculpt_cut_part isosculpt_cut_hit(const isosculpt_cut_handle *handle, double scale, double x, double y);

/* Moves the plane along its normal as the pointer moves by dx, dy pixels: as far as the handle follows the
 * pointer; of a plane that is seen face on, upwards is away from the eye. */
void isosculpt_cut_drag(isosculpt_cut *cut, const iso_view *view, double dx, double dy);
/* Tilts the plane about its handle, whose arrow follows the pointer. */
void isosculpt_cut_tilt(isosculpt_cut *cut, const iso_view *view, double dx, double dy);

ISO_C_END
#endif
