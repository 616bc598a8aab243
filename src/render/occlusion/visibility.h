/* visibility: how much light from a fixed set of directions reaches the surroundings of a solid's surface.
 *
 * Rays are followed through solid_bits from the voxels next to the surface, the nodes. As all nodes lie at
 * voxels, all rays of a direction pass the same voxels relative to their nodes, and a vector instruction
 * follows the rays of hundreds of nodes. What is found at a node is a function of the normal, so that it does
 * not depend on the camera: it is kept from picture to picture, and computed only where a picture needs it.
 *
 * Light from all around, weighted by the cosine to a normal n, is nearly a quadratic function of n
 * (Ramamoorthi and Hanrahan 2001, "An efficient representation for irradiance environment maps"): of N
 * directions d that are spread evenly the sum of 0.375 + 2 (n.d) + 1.875 (n.d)^2 over the free ones, divided
 * by N. */
#ifndef ISO_RENDER_OCCLUSION_VISIBILITY_H
#define ISO_RENDER_OCCLUSION_VISIBILITY_H

#include "base/geometry.h"
#include "base/parallel.h"
#include "render/occlusion/solid_bits.h"

enum { ISO_DIRECTIONS_MAX = 128 };

/* Unit vectors in the world. */
typedef struct iso_directions {
    int count;
    bool by_cosine; /* light is weighted by the cosine to the normal; else all directions count alike */
    iso_vec3 axis[ISO_DIRECTIONS_MAX];
} iso_directions;

/* `count` directions spread evenly over the sphere, weighted by cosines; a multiple of 8. */
iso_directions iso_directions_sphere(int count);
/* `count` directions spread evenly over the disc of a light around `axis`, a unit vector; `radius` is the
 * tangent of half the angle under which it is seen. */
iso_directions iso_directions_disc(iso_vec3 axis, double radius, int count);

/* Borrows the bits. One thread at a time, but for the const functions. */
typedef struct iso_visibility iso_visibility;

/* range: how far rays go, mm; INFINITY: to the end of the lattice. ISO_ERR_NOMEM. */
iso_status iso_visibility_create(const iso_solid_bits *bits, const iso_directions *directions, double range,
                                 iso_visibility **visibility, iso_error *error);
void iso_visibility_destroy(iso_visibility *visibility);

/* Forgets the nodes from which rays can reach voxels lo .. hi (inclusive), whose bits have changed. */
void iso_visibility_forget(iso_visibility *visibility, const int lo[3], const int hi[3]);

/* Computes what was asked for (iso_visibility_node), unless it is there. ISO_ERR_NOMEM: the rest is computed
 * when it is asked for again. */
iso_status iso_visibility_compute(iso_visibility *visibility, iso_pool *pool, iso_error *error);

#endif
