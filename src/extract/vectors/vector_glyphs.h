/* vector_glyphs: glyphs of a grid of vectors or tensors: at every n-th voxel on each axis an arrow, a cone or
 * another solid along the vector, or the ellipsoid of the tensor, whose half axes are its eigenvectors with
 * lengths in proportion to its eigenvalues. */
#ifndef ISO_EXTRACT_VECTORS_VECTOR_GLYPHS_H
#define ISO_EXTRACT_VECTORS_VECTOR_GLYPHS_H

#include "base/glyphs.h"
#include "grids/vectors.h"

#ifdef __cplusplus
extern "C" {
#endif

/* How many glyphs a picture shows well: with opts.every 0, voxels are skipped until no more are left. */
enum { ISO_VECTOR_GLYPHS_USUAL = 10000 };

/* All zero means the default. */
typedef struct iso_vector_glyphs_opts {
    int every; /* voxels on each axis from one glyph to the next; 0: the least with about
                  ISO_VECTOR_GLYPHS_USUAL glyphs or fewer. The lattice of glyphs lies in the middle of the
                  volume. */
    /* Length in mm of a vector of length 1, or half axis of an eigenvalue of 1. 0: the longest vector of the
     * glyphs is as long as the distance of two glyphs along the axis on which they lie closest, the longest
     * half axis half of it, so that no two ellipsoids reach beyond where they meet. */
    double scale;
    double least; /* vectors that are shorter and tensors of less anisotropy get no glyph */
    bool centred; /* vectors have their middle at the voxel, for solids without a head; else their tail */
    uint64_t max_memory; /* bytes; 0: 80 % of what is available */
    iso_pool *pool;
} iso_vector_glyphs_opts;

typedef struct iso_vector_glyphs_totals {
    int every;
    double scale;
    size_t voxels; /* at which a glyph was to be made; left out because they are: */
    size_t zero;
    size_t missing;
    size_t small;      /* below opts.least */
    size_t indefinite; /* tensors whose least eigenvalue is below a millionth of the greatest: no ellipsoid */
} iso_vector_glyphs_totals;

/* Makes glyphs; iso_glyphs_free when done. None at all is no error. Vectors become directions, with a column
 * "magnitude" in the file's units. Tensors become axes, with directions along the greatest, and columns
 * "mean" (of the eigenvalues) and "anisotropy" (fractional). Every thread count gives the same bytes.
 * ISO_ERR_LIMIT: more memory than opts->max_memory; ISO_ERR_NOMEM. */
iso_status iso_vector_glyphs(const iso_vectors *vectors, const iso_vector_glyphs_opts *opts,
                             iso_glyphs *glyphs, iso_vector_glyphs_totals *totals, iso_error *error);

#ifdef __cplusplus
}
#endif
#endif
