/* vector_glyphs: makes glyphs of a grid of vectors or tensors, at every n-th voxel on each axis. A vector
 * becomes an arrow, a cone or another solid along the vector. A tensor becomes an ellipsoid whose half axes
 * are the eigenvectors, with lengths proportional to the eigenvalues. */
#ifndef ISO_EXTRACT_VECTORS_VECTOR_GLYPHS_H
#define ISO_EXTRACT_VECTORS_VECTOR_GLYPHS_H

#include "base/glyphs.h"
#include "grids/vectors.h"

/* The largest number of glyphs that a picture shows clearly; with opts.every 0, so many voxels are skipped
 * that no more are made. */
enum { ISO_VECTOR_GLYPHS_USUAL = 10000 };

/* Options. Zero means the default. */
typedef struct iso_vector_glyphs_opts {
    int every; /* spacing of glyphs in voxels, on each axis; 0: the smallest with at most about
                  ISO_VECTOR_GLYPHS_USUAL glyphs. The lattice of glyphs is centred in the volume. */
    /* Length in mm of a vector of length 1, or of a half axis with eigenvalue 1. 0: the longest vector is as
     * long as the smallest distance between neighbouring glyphs, and the longest half axis half as long, so
     * that ellipsoids touch at most. */
    double scale;
    double least; /* shorter vectors, or tensors of less anisotropy, get no glyph */
    bool centred; /* vectors are centred on the voxel, for solids without a head; if false, they begin at the
                     voxel */
    uint64_t max_memory; /* limit in bytes; 0: 80 % of the available memory */
    iso_pool *pool;
} iso_vector_glyphs_opts;

typedef struct iso_vector_glyphs_totals {
    int every;
    double scale;
    size_t voxels; /* voxels of the lattice; the following ones got no glyph because they are: */
    size_t zero;
    size_t missing;
    size_t small;      /* below opts.least */
    size_t indefinite; /* tensors whose smallest eigenvalue is below a millionth of the largest, so that there
                          is no ellipsoid */
} iso_vector_glyphs_totals;

/* Makes glyphs. Free with iso_glyphs_free. A result without glyphs is not an error. Vectors become
 * directions, with a column "magnitude" in the file's units. Tensors become axes, with directions along the
 * largest one, and with the columns "mean" (of the eigenvalues) and "anisotropy" (fractional). The bytes are
 * the same for every number of threads. ISO_ERR_LIMIT: more memory than opts->max_memory; ISO_ERR_NOMEM. */
iso_status iso_vector_glyphs(const iso_vectors *vectors, const iso_vector_glyphs_opts *opts,
                             iso_glyphs *glyphs, iso_vector_glyphs_totals *totals, iso_error *error);

#endif
