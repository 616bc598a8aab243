/* vectors: a dense grid of vectors or of symmetric tensors: velocities, displacements, gradients, diffusion.
 *
 * Values are floats in the axes of the world (LPS), whatever the file's axes were, and in the file's units:
 * vectors x y z, tensors xx xy xz yy yz zz, one voxel after the other, x fastest. A voxel without a usable
 * value (not finite in the file, or outside its mask) has NaN in all components. */
#ifndef ISO_GRIDS_VECTORS_H
#define ISO_GRIDS_VECTORS_H

#include <stddef.h>
#include <stdint.h>

#include "base/c_linkage.h"
#include "base/geometry.h"
#include "base/parallel.h"

ISO_C_BEGIN

enum { ISO_VECTOR_COMPONENTS = 3, ISO_TENSOR_COMPONENTS = 6 };

/* Zero-initialise; iso_vectors_free when done. */
typedef struct iso_vectors {
    int dims[3];
    iso_transform transform;
    int components; /* ISO_VECTOR_COMPONENTS or ISO_TENSOR_COMPONENTS */
    float *values;  /* owned */
} iso_vectors;

void iso_vectors_free(iso_vectors *vectors);

size_t iso_vectors_count(const iso_vectors *vectors); /* voxels */

static inline const float *iso_vectors_at(const iso_vectors *vectors, int x, int y, int z) {
    const size_t index =
        ((size_t)z * (size_t)vectors->dims[1] + (size_t)y) * (size_t)vectors->dims[0] + (size_t)x;
    return vectors->values + index * (size_t)vectors->components;
}

/* Statistics of the voxels. */
typedef struct iso_vectors_totals {
    size_t usable;  /* finite and not 0 */
    size_t zero;    /* every component is 0 */
    size_t missing; /* NaN */
    double longest; /* largest length of a vector, or largest Frobenius norm of a tensor */
} iso_vectors_totals;

/* Counts the voxels. The same for every number of threads; `pool` may be NULL. ISO_ERR_NOMEM. */
iso_status iso_vectors_measure(const iso_vectors *vectors, iso_pool *pool, iso_vectors_totals *totals,
                               iso_error *error);

/* Interpolates vectors trilinearly at a position in index coordinates. Returns false outside the box of the
 * voxels' centres and where a voxel around the position is missing. A constant field is reproduced exactly.
 *
 * along: NULL, or a direction, for vectors without a sign (axes of fibres): each vector around the position
 * is reversed if it points against `along`, so that opposite vectors do not cancel. */
bool iso_vectors_sample(const iso_vectors *vectors, const double index[3], const double *along,
                        double value[3]);

ISO_C_END
#endif
