/* primitives: points and meshes as extraction stores them and renderers borrow them, one span per brick.
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

#include "base/c_linkage.h"
#include "base/geometry.h"
#include "base/point_numbers.h"

ISO_C_BEGIN

enum { ISO_BRICK_VOXELS = ISO_BRICK * ISO_BRICK * ISO_BRICK };

/* A point in floats: of a point set with floats, or a vertex of a mesh. 24 bytes. */
typedef struct iso_surfel {
    float position[3];
    float normal[3];
} iso_surfel;

/* A point in 8 bytes: bits 0..41 hold x, y, z as 14-bit steps of 20/16384 voxel from -2 (positions in [-2,
 * 18)), bits 42..63 an octahedral normal, 11 bits for each of its two numbers. Position error <= 0.00062
 * voxel an axis, normal <= 0.13 degrees. The constants are in base/point_numbers.h; kernels pack and unpack
 * with base/point_code.h. */
typedef struct iso_point {
    uint64_t bits;
} iso_point;

/* Packs a point, rounding to the nearest steps. Positions outside [-2, 18) are clamped. The normal must not
 * be zero. */
iso_point iso_point_pack(const iso_surfel *surfel);
/* Packs a point whose normal is already scaled to |x| + |y| + |z| = 1. */
iso_point iso_point_pack_scaled(const iso_surfel *surfel);
iso_surfel iso_point_unpack(iso_point point);

/* The curvature of a surface at a point, in 8 bytes: its shape operator S (second fundamental form) in index
 * space, a symmetric matrix in the basis (u, v) that iso_curvature_frame computes from the point's normal (as
 * returned by iso_point_view_get). A step q along the surface turns the outward normal by S q: entries are in
 * 1 / voxel, positive where the surface is convex (1 / r on a sphere). They are stored in steps of
 * ISO_CURVATURE_STEP; norms are clamped to ISO_CURVATURE_MOST. Entries are multiples of 32 steps: their low
 * five bits hold the tilt. */
typedef struct iso_curvature {
    int16_t uu, uv, vv;
    uint16_t extents; /* see below; 0: unknown, or not an edge point */
} iso_curvature;

/* The tilt is the direction of the surface relative to the point's normal, which comes from gradients over
 * two voxels: the surface's own normal at the point is along normal + tilt[0] u + tilt[1] v. It is stored as
 * two numbers k of 7 bits in two's complement, -63 .. 63, with tilt = k |k| ISO_CURVATURE_TILT_MOST / 63^2;
 * their 14 bits are the low five bits of uu, then those of uv, then of vv. */

/* extents: how far the surface continues from an edge point in the four faces beside its edge, before it
 * reaches another edge of the face. Bits 0-11: four distances of 3 bits, down and up along the first axis
 * perpendicular to the edge, then along the second, in steps of 1/7 voxel (0 to 1), rounded up; 1
 * instead of 0 where the surface only touches the face and continues in cells beside it. Bits 12-13: 1 + the
 * edge's axis. Bits 14-15: by how much the point's disc is drawn smaller, in quarters of its radius (0
 * to 3), so that its rim does not leave the surface. */
#define ISO_CURVATURE_MOST 4.0f /* largest sqrt(uu^2 + 2 uv^2 + vv^2), 1 / voxel */

/* Two unit tangents of a unit normal, perpendicular to each other, with u x v = normal (Duff et al. 2017,
 * "Building an orthonormal basis, revisited"). */
void iso_curvature_frame(const float normal[3], float u[3], float v[3]);
/* Packs a shape operator (1 / voxel), rounded to the nearest steps, with its norm clamped and no tilt; all 0
 * when an entry is not finite. */
iso_curvature iso_curvature_pack(float uu, float uv, float vv);
/* Sets s to uu, uv, vv in 1 / voxel, and the tilt. */
void iso_curvature_unpack(iso_curvature curvature, float s[3], float tilt[2]);

/* The points of one brick. */
typedef struct iso_point_span {
    int32_t brick[3];
    uint32_t count;
    size_t first; /* index of the span's first point */
} iso_point_span;

/* Boxes around a span's positions (relative to its brick) and around its normals (of a mesh: those of its
 * triangles) scaled to |x| + |y| + |z| = 1; lo > hi when the span is empty. */
typedef struct iso_point_bounds {
    float lo[3], hi[3];
    float normal_lo[3], normal_hi[3];
} iso_point_bounds;

/* Points, all borrowed. Exactly one of `packed` and `surfels` is set (both are NULL when there are no
 * points). */
typedef struct iso_point_view {
    const iso_point *packed;
    const iso_surfel *surfels;
    const iso_curvature *curvatures; /* one per point; NULL: points are flat */
    const float *radii;              /* one per point, mm; NULL: all have `radius` */
    const iso_point_span *spans;
    size_t span_count;
    iso_transform transform;
    int32_t dims[3]; /* size of the points' grid: the surface ends at its first and last voxels; 0: unknown */
    /* What `radii` are multiplied by where points are drawn as discs (render/discs/discs.h), of instances of
     * another size; 0 means 1. */
    float radii_scale;
    double radius; /* mm; extracted points: largest spacing * sqrt(2) / 2 (2003 paper, section 4.1) */
    /* One per span: what `radius` is multiplied by where points are drawn as discs
     * (render/discs/discs.h), between two levels of detail. Radii of points' own are not. NULL: 1. */
    const float *span_scales;
    const uint8_t (
        *colors)[3]; /* one per point, red green blue, display values; NULL: the surface's colour */
    /* One per point, 0 (not seen) to 255 (opaque), of translucent points (iso_splat_layer in
     * render/groups/disc_layers.h); everything else draws points opaque. NULL: opaque. */
    const uint8_t *opacities;
    /* One per span, never 0: changes when the span's contents change or another brick gets the span's number,
     * not when the span only moves in the arrays. NULL: unknown. */
    const uint64_t *versions;
    const iso_point_bounds *bounds; /* one per span; NULL: unknown */
    bool closed; /* the points lie on closed surfaces with outward normals: seen from outside, points that
                    face away are hidden */
    bool overlapping; /* discs of different sheets may lie nearer to each other than their radii, as in
                         scans: splats are drawn in two passes, so that they do not depend on the order of
                         the points, and points of levels of detail have radii of their own */
} iso_point_view;

/* The factor of the view's radii. */
static inline float iso_point_view_radii_scale(const iso_point_view *view) {
    return view->radii_scale > 0 ? view->radii_scale : 1;
}

/* Number of points in all spans. */
size_t iso_point_view_count(const iso_point_view *view);
/* The point at `index` in the arrays (not in a span) in floats. */
iso_surfel iso_point_view_get(const iso_point_view *view, size_t index);
/* Index coordinates of a position that is relative to a brick's first voxel, both in voxels. */
iso_vec3 iso_brick_position(const int32_t brick[3], const float position[3]);

/* Box of all points in index coordinates: that of the spans' bounds where they are known. */
iso_box iso_point_view_bounds(const iso_point_view *view);

/* The part of a mesh that lies in the cells of one brick. Vertices first .. first + owned_count - 1 are on
 * edges that the brick owns (an edge belongs to its lower voxel's brick); the others are exact copies of
 * vertices that a neighbouring brick owns. Triangles are counter-clockwise seen from outside. */
typedef struct iso_mesh_span {
    int32_t brick[3];
    uint32_t vertex_count, owned_count;
    uint32_t triangle_count;
    size_t first_vertex;
    size_t first_triangle;
} iso_mesh_span;

/* Identifies an edge of a brick by its axis and its lower voxel (0 .. 16 on each axis). Ascending keys go by
 * axis first: all x edges of a brick, then all y edges, then all z edges. The own vertices of a mesh span,
 * and the edge points of a brick, are sorted by key. */
typedef uint16_t iso_edge_key;

enum { ISO_LATTICE = ISO_BRICK + 1, ISO_LATTICE_VOXELS = ISO_LATTICE * ISO_LATTICE * ISO_LATTICE };

static inline iso_edge_key iso_edge_key_make(int x, int y, int z, int axis) {
    return (iso_edge_key)(axis * ISO_LATTICE_VOXELS + (z * ISO_LATTICE + y) * ISO_LATTICE + x);
}

/* Sets `voxel` to the lower voxel of the edge with this key; returns the axis of the edge. */
static inline int iso_edge_key_split(iso_edge_key key, int voxel[3]) {
    int lower = key % ISO_LATTICE_VOXELS;
    voxel[0] = lower % ISO_LATTICE;
    voxel[1] = lower / ISO_LATTICE % ISO_LATTICE;
    voxel[2] = lower / ISO_LATTICE / ISO_LATTICE;
    return key / ISO_LATTICE_VOXELS;
}

/* A mesh in spans. All pointers are borrowed. */
typedef struct iso_mesh_view {
    const iso_surfel *vertices;
    const iso_edge_key *keys;       /* one per vertex */
    const uint16_t (*triangles)[3]; /* vertex numbers counted from the span's first_vertex */
    const iso_mesh_span *spans;
    size_t span_count;
    iso_transform transform;
    const uint64_t *versions;       /* as in iso_point_view */
    const iso_point_bounds *bounds; /* one per span; NULL: unknown */
    bool closed; /* the mesh is closed: seen from outside, triangles that face away are hidden */
} iso_mesh_view;

/* A triangle mesh from a file, in world millimetres; triangles need not share vertices. */
typedef struct iso_triangles {
    float (*vertices)[3];
    uint32_t (*triangles)[3];
    size_t vertex_count, triangle_count;
    uint8_t (*colors)[3]; /* of vertices: red, green and blue, display values; NULL: none */
} iso_triangles;
void iso_triangles_free(iso_triangles *mesh);

/* The numbers of vertices and triangles of the welded mesh: copies of vertices are not counted. */
size_t iso_mesh_view_vertex_count(const iso_mesh_view *view);
size_t iso_mesh_view_triangle_count(const iso_mesh_view *view);
/* Box of all vertices in index coordinates. */
iso_box iso_mesh_view_bounds(const iso_mesh_view *view);

ISO_C_END
#endif
