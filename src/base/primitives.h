/* primitives: points and meshes as extraction makes them and renderers borrow them, in one span for each
 * brick.
 *
 * A brick is 16^3 voxels; brick (bx, by, bz) covers voxels 16*b .. 16*b + 15. Positions in a span are in
 * voxels relative to voxel 16*b of its brick, so index = 16 * brick + position, and world = transform(index).
 * Normals are unit covectors in index space, pointing out of the solid; iso_affine_normal transforms them to
 * world coordinates. */
#ifndef ISO_BASE_PRIMITIVES_H
#define ISO_BASE_PRIMITIVES_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/geometry.h"
#include "base/point_numbers.h"

#ifdef __cplusplus
extern "C" {
#endif

enum { ISO_BRICK_VOXELS = ISO_BRICK * ISO_BRICK * ISO_BRICK };

/* A point in floats (where such points were asked for), or a vertex of a mesh. 24 bytes. */
typedef struct iso_surfel {
    float position[3];
    float normal[3];
} iso_surfel;

/* A packed point, in 8 bytes. Bits 0..41 have x, y, z as 14-bit steps of 20/16384 voxel from -2, relative to
 * the brick's first voxel (positions in [-2, 18)). Bits 42..63 have an octahedral normal, 11 bits for each of
 * its two numbers. The error of a position is at most 0.00062 voxel along each axis, that of a normal 0.13
 * degrees. base/point_numbers.h has the constants, base/point_code.h the conversions. */
typedef struct iso_point {
    uint64_t bits;
} iso_point;

/* Returns the nearest packed point; positions outside [-2, 18) are clamped. The normal must not be zero. */
iso_point iso_point_pack(const iso_surfel *surfel);
/* Like iso_point_pack, for a normal that is scaled to |x| + |y| + |z| = 1 already. */
iso_point iso_point_pack_scaled(const iso_surfel *surfel);
iso_surfel iso_point_unpack(iso_point point);

/* The curvature of a surface at a point, in 8 bytes: its shape operator S (second fundamental form) in index
 * space, symmetric, in the frame (u, v) that iso_curvature_frame makes of the point's normal as
 * iso_point_view_get gives it. A step q along the surface turns the outward normal by S q. Entries are in 1 /
 * voxel, positive where the surface is convex (1 / r on a sphere), and stored in steps of ISO_CURVATURE_STEP.
 * The norm is clamped to ISO_CURVATURE_MOST. Entries are multiples of 32 steps; their low five bits have the
 * tilt. */
typedef struct iso_curvature {
    int16_t uu, uv, vv;
    uint16_t extents; /* see below; 0: not known, or not an edge point */
} iso_curvature;

/* tilt: the direction of the surface around an edge point relative to the point's normal, which is computed
 * from gradients over two voxels: the normal of the surface itself is along normal + tilt[0] u + tilt[1] v.
 * Both are numbers k of 7 bits in two's complement, -63 .. 63, with tilt = k |k| ISO_CURVATURE_TILT_MOST /
 * 63^2. Their 14 bits are the low five bits of uu, then those of uv, then those of vv. */

/* extents: how far the surface continues from an edge point within the four faces beside its edge, before
 * it reaches another edge of the face. Bits 0-11: four distances of 3 bits, down and up along the first
 * axis at right angles to the edge, then along the second, in steps of 1/7 voxel (0 to 1), rounded up.
 * Bits 12-13: 1 + the edge's axis. Bits 14-15: by how much the point's disc is drawn smaller, in quarters
 * of its radius (0 to 3), so that its rim does not leave the surface. */
#define ISO_CURVATURE_MOST 4.0f /* largest sqrt(uu^2 + 2 uv^2 + vv^2), 1 / voxel */

/* Computes two unit vectors u and v, perpendicular to a unit normal and to each other, with u x v = normal
 * (Duff et al. 2017, "Building an orthonormal basis, revisited"). */
void iso_curvature_frame(const float normal[3], float u[3], float v[3]);
/* Returns the nearest curvature, with the norm clamped; all 0 if an entry is not finite. Entries in 1 /
 * voxel. */
iso_curvature iso_curvature_pack(float uu, float uv, float vv);
/* Computes s = uu, uv, vv in 1 / voxel, and the tilt. */
void iso_curvature_unpack(iso_curvature curvature, float s[3], float tilt[2]);

/* The points of one brick. */
typedef struct iso_point_span {
    int32_t brick[3];
    uint32_t count;
    size_t first; /* index of the span's first point */
} iso_point_span;

/* A box around the positions of a span, relative to its brick, and a box around its normals, scaled to |x| +
 * |y| + |z| = 1 (of a mesh: around the normals of its triangles). lo > hi: the span has none. */
typedef struct iso_point_bounds {
    float lo[3], hi[3];
    float normal_lo[3], normal_hi[3];
} iso_point_bounds;

/* A view of points that another object owns. Exactly one of `packed` and `surfels` is set (both are NULL if
 * there are no points). */
typedef struct iso_point_view {
    const iso_point *packed;
    const iso_surfel *surfels;
    const iso_curvature *curvatures; /* per point, indexed like the points; NULL: points are flat */
    const float *radii; /* per point, mm, indexed like the points; NULL: `radius` holds for all */
    const iso_point_span *spans;
    size_t span_count;
    iso_transform transform;
    int32_t dims[3]; /* size in voxels of the grid that the points come from: the surface ends at its border,
                        voxels 0 and dims - 1; 0: not known */
    double radius;   /* mm; for extracted points half of sqrt(2) x the largest spacing (Baerentzen and
                        Christensen 2003, section 4.1) */
    const uint8_t (*colors)[3]; /* for each point: red, green, blue, display values; NULL: all have the colour
                                   of the surface */
    /* For each span a number, never 0, that changes when the content of the span changes or the span becomes
     * another brick's, but not when the content is only moved. NULL: not known. */
    const uint64_t *versions;
    const iso_point_bounds *bounds; /* one per span; NULL: not known */
    bool closed; /* the points lie on closed surfaces, with normals pointing out: from outside, points that
                    face away are hidden */
} iso_point_view;

/* Returns the number of points in all spans. */
size_t iso_point_view_count(const iso_point_view *view);
/* Returns point `index` (in the array of all points, not in a span) as floats. */
iso_surfel iso_point_view_get(const iso_point_view *view, size_t index);
/* Returns the index coordinates of a position that is relative to a brick's first voxel; both in voxels. */
iso_vec3 iso_brick_position(const int32_t brick[3], const float position[3]);

/* Returns the box of all points in index coordinates. */
iso_box iso_point_view_bounds(const iso_point_view *view);

/* The part of a mesh that lies in the cells of one brick. Vertices first .. first + owned_count - 1 are on
 * edges that the brick owns (an edge belongs to its lower voxel's brick); the rest are bit-identical copies
 * of vertices that a neighbour owns. Triangles are counter-clockwise seen from outside. */
typedef struct iso_mesh_span {
    int32_t brick[3];
    uint32_t vertex_count, owned_count;
    uint32_t triangle_count;
    size_t first_vertex;
    size_t first_triangle;
} iso_mesh_span;

/* The key of an edge between two neighbouring voxels: its axis, and its lower voxel in the brick (0..16 along
 * each axis). Keys order all x edges of a brick before all y edges, and these before all z edges. The edge
 * points of a brick, and the vertices that a span owns, are sorted by key. */
typedef uint16_t iso_edge_key;

enum { ISO_LATTICE = ISO_BRICK + 1, ISO_LATTICE_VOXELS = ISO_LATTICE * ISO_LATTICE * ISO_LATTICE };

static inline iso_edge_key iso_edge_key_make(int x, int y, int z, int axis) {
    return (iso_edge_key)(axis * ISO_LATTICE_VOXELS + (z * ISO_LATTICE + y) * ISO_LATTICE + x);
}

/* Computes the lower voxel of an edge; returns its axis. */
static inline int iso_edge_key_split(iso_edge_key key, int voxel[3]) {
    int lower = key % ISO_LATTICE_VOXELS;
    voxel[0] = lower % ISO_LATTICE;
    voxel[1] = lower / ISO_LATTICE % ISO_LATTICE;
    voxel[2] = lower / ISO_LATTICE / ISO_LATTICE;
    return key / ISO_LATTICE_VOXELS;
}

/* A view of a mesh that another object owns. */
typedef struct iso_mesh_view {
    const iso_surfel *vertices;
    const iso_edge_key *keys;       /* the edge that each vertex lies on */
    const uint16_t (*triangles)[3]; /* vertex numbers counted from the span's first_vertex */
    const iso_mesh_span *spans;
    size_t span_count;
    iso_transform transform;
    const uint64_t *versions;       /* see iso_point_view */
    const iso_point_bounds *bounds; /* one per span; NULL: not known */
    bool closed; /* the triangles form closed surfaces: from outside, triangles that face away are hidden */
} iso_mesh_view;

/* Triangles as files have them, in world millimetres. Triangles need not share vertices. */
typedef struct iso_triangles {
    float (*vertices)[3];
    uint32_t (*triangles)[3];
    size_t vertex_count, triangle_count;
} iso_triangles;

/* Return the number of vertices, each counted in the span that owns it, and of triangles. */
size_t iso_mesh_view_vertex_count(const iso_mesh_view *view);
size_t iso_mesh_view_triangle_count(const iso_mesh_view *view);
/* Returns the box of all vertices in index coordinates. */
iso_box iso_mesh_view_bounds(const iso_mesh_view *view);

#ifdef __cplusplus
}
#endif
#endif
