/* cuts: what is cut away of the things in a scene, as people write it: planes, boxes and balls, for
 * everything or for certain surfaces. */
#ifndef ISO_SCENE_CUTS_H
#define ISO_SCENE_CUTS_H

#include "image/camera.h"
#include "render/view/clip.h"

enum { ISO_CUT_THINGS = 128 }; /* surfaces and objects that a cut can name: 1 .. this number */

/* Which things of a scene something is for. */
typedef struct iso_things {
    bool named; /* only those whose bits are set, bit n - 1 for thing n; else all */
    uint64_t bits[ISO_CUT_THINGS / 64];
} iso_things;

/* Parses "N,N..", numbers from 1. ISO_ERR_USAGE. */
iso_status iso_things_parse(const char *text, iso_things *things, iso_error *error);
/* Whether thing `number` (from 0) is one of them. */
bool iso_things_have(const iso_things *things, int number);

/* One cut. */
typedef struct iso_cut {
    bool by_depth;      /* cuts away what is less than `depth` mm behind the front of the scene */
    double depth;       /* mm along the view */
    iso_clip_body body; /* in the world; without by_depth */
    bool plane;         /* `body` is a half-space, */
    bool by_middle;     /* whose plane is moved into the middle by iso_cut_set_middle */
    bool space_stated;  /* by ras: or lps: */
    iso_things things;
} iso_cut;

/* The forms of iso_cut_parse in one line, for help and messages. */
#define ISO_CUT_FORMS                                                                                        \
    "x<MM or x>MM (so y, z), x (below the middle; also sagittal, coronal, axial: the patient's "             \
    "right, front or lower half), X,Y,Z:NX,NY,NZ, camera:MM, box:X0,Y0,Z0,X1,Y1,Z1 or "                      \
    "sphere:X,Y,Z,R, with keep:, ras: or lps: before it or @N,.. behind it"

/* Parses
 *   x<MM or x>MM (y, z)            what lies there in the world (mm, LPS)
 *   x, y, z, sagittal, coronal or axial   what lies below the middle; the last three are names of x, y and z
 *   X,Y,Z:NX,NY,NZ                 the side of the plane through the point that the normal points to
 *   camera:MM                      what lies less than MM behind the front of the scene, along the view
 *   box:X0,Y0,Z0,X1,Y1,Z1          the inside of a box
 *   sphere:X,Y,Z,R                 the inside of a ball
 * With ras: before it, it is in RAS; lps: states what is usual. With keep: before all that, everything
 * else is cut away. With @N,.. behind it, only the surfaces and objects with these
 * numbers (from 1) are cut. ISO_ERR_USAGE. */
iso_status iso_cut_parse(const char *text, iso_cut *cut, iso_error *error);

/* Parses a plane: x=MM or x (y, z), sagittal, coronal, axial, X,Y,Z:NX,NY,NZ or camera:MM, with ras: or lps:
 * before it. ISO_ERR_USAGE. */
iso_status iso_cut_parse_plane(const char *text, iso_cut *plane, iso_error *error);

/* The middle of a volume, for iso_cut_set_middle: the same in every program. */
iso_vec3 iso_cut_middle(const iso_transform *transform, const int dims[3]);
/* Moves the plane of a cut by the middle to `middle`; others stay. */
void iso_cut_set_middle(iso_cut *cut, iso_vec3 middle);

/* The half-space of a cut with by_depth, seen by a camera. front: least dot product of a point of the scene
 * with the unit vector of the view. Other cuts are returned as they are. */
iso_clip_body iso_cut_solve(const iso_cut *cut, const iso_camera *camera, double front);

/* What a list of cuts cuts away of thing `thing` (from 0). camera, front: as of iso_cut_solve. count: at most
 * ISO_CLIP_BODIES. */
iso_clip iso_cuts_clip(const iso_cut *cuts, int count, int thing, const iso_camera *camera, double front);

/* Whether a cut is for thing `number` (from 0). */
bool iso_cut_is_for(const iso_cut *cut, int number);

#endif
