/* faces: the faces of a mesh whose vertices are read as points, for the normals of the points. Internal to
 * src/io. */
#ifndef ISO_IO_POLYDATA_FACES_H
#define ISO_IO_POLYDATA_FACES_H

#include "io/polydata/polydata.h"

/* Triangles. Zero-initialise; iso_faces_free when done. */
typedef struct iso_faces {
    iso_buffer corners; /* uint32_t, three point numbers for each triangle */
    size_t count;
    iso_buffer fans; /* of iso_fan: the polygons (io/common/fans.h) */
    size_t fan_count;
} iso_faces;

/* A polygon or strip that is read corner by corner; begin each with zeros. */
typedef struct iso_face {
    bool strip; /* every corner from the third on makes a triangle with the two before it, not a fan */
    uint32_t first, last;
    size_t count;
} iso_face;

/* Adds the next corner of a face: a point number, which is checked by iso_faces_make_normals. Corners are in
 * counter-clockwise order, seen from outside. ISO_ERR_LIMIT, ISO_ERR_NOMEM. */
iso_status iso_faces_add_corner(iso_reading *reading, iso_faces *faces, iso_face *face, uint32_t corner,
                                iso_error *error);

/* Ends a face. ISO_ERR_LIMIT, ISO_ERR_NOMEM. */
iso_status iso_faces_end_face(iso_reading *reading, iso_faces *faces, const iso_face *face, iso_error *error);

/* Whether faces are to be read for normals: the caller has asked for them, and the points have none yet. */
bool iso_faces_are_wanted(const iso_polydata *data);

/* If faces are wanted and there are any, adds a column of normals: at each point the sum of the unit normals
 * of its faces, weighted with the faces' angles at the point (Thürmer and Wüthrich 1998, "Computing vertex
 * normals from polygonal facets"), as unit vectors; zero where a point has no face. ISO_ERR_FORMAT: a face
 * names a point that does not exist; ISO_ERR_LIMIT, ISO_ERR_NOMEM. */
iso_status iso_faces_make_normals(const iso_faces *faces, iso_polydata *data, iso_error *error);

void iso_faces_free(iso_reading *reading, iso_faces *faces);

#endif
