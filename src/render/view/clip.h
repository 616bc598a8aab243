/* clip: what is cut away of a surface, so that one sees what lies behind it: bodies in world space, which
 * every method of the cpu engine leaves out, and the parts of a ray that are left between them. */
#ifndef ISO_RENDER_CLIP_H
#define ISO_RENDER_CLIP_H

#include "base/geometry.h"

enum { ISO_CLIP_FACES = 6, ISO_CLIP_BODIES = 16, ISO_CLIP_PIECES = ISO_CLIP_BODIES + 1 };

/* A convex body: the points in front of none of its faces, or a ball. */
typedef struct iso_clip_body {
    int faces; /* 0: a ball */
    /* A point p lies in the body if x * p.x + y * p.y + z * p.z < offset for each face x y z offset. x y z:
     * the outward unit normal; mm. */
    double face[ISO_CLIP_FACES][4];
    iso_vec3 centre; /* of the ball, mm */
    double radius;
    bool keeps; /* what lies outside is cut away; if not, what lies inside */
} iso_clip_body;

/* Zero-initialised, nothing is cut away. Several bodies cut one after the other: what is left is cut by
 * none. */
typedef struct iso_clip {
    int count;
    iso_clip_body body[ISO_CLIP_BODIES];
} iso_clip;

/* A half-space: the points on the side of a plane that its normal (not zero, of any length) points to. */
iso_clip_body iso_clip_half_space(iso_vec3 point, iso_vec3 normal);
iso_clip_body iso_clip_box(const iso_box *box);
iso_clip_body iso_clip_ball(iso_vec3 centre, double radius);

/* Whether it is a single half-space that is cut away, or left. `clip` may be NULL. */
static inline bool iso_clip_is_plane(const iso_clip *clip) {
    return clip && clip->count == 1 && clip->body[0].faces == 1;
}

/* Whether a point is left. */
bool iso_clip_shows(const iso_clip *clip, iso_vec3 point);

/* A part of a ray origin + t * direction that is left. */
typedef struct iso_clip_piece {
    double begin, end; /* t */
    int body, face;    /* the body, and its face, that cuts the ray where the piece begins; -1: none */
} iso_clip_piece;

/* Writes the parts that are left of a ray from t = begin to t = end, in order; returns their number. */
int iso_clip_pieces(const iso_clip *clip, iso_vec3 origin, iso_vec3 direction, double begin, double end,
                    iso_clip_piece pieces[ISO_CLIP_PIECES]);
/* The unit normal of the cut where a piece that a body cuts begins, at `point`: towards what was cut away. */
iso_vec3 iso_clip_normal(const iso_clip *clip, const iso_clip_piece *piece, iso_vec3 point);

/* What is left of a box: all, some, or nothing. */
typedef enum iso_clip_rest { ISO_CLIP_ALL, ISO_CLIP_SOME, ISO_CLIP_NOTHING } iso_clip_rest;
/* The box has its centre at `centre` and reaches as far as +- each of the vectors `half`, which need not be
 * perpendicular. Conservative: `SOME` may be said where all or nothing is left. Sets bit n of *cutting if
 * body n may cut the box. */
iso_clip_rest iso_clip_of_box(const iso_clip *clip, iso_vec3 centre, const iso_vec3 half[3],
                              unsigned *cutting);

#endif
