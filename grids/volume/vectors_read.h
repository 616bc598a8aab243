/* vectors_read: reads volumes with several components at each voxel as vectors or tensors in the axes of the
 * world.
 *
 * Every format of iso_volume_read can hold them: channels of MetaImage and raw files, arrays of .vti and
 * legacy .vtk, vector grids of .vdb, axes of vectors and matrices in .nrrd, fourth and fifth dimensions of
 * NIfTI. The number of components determines what they are:
 *
 *   3   a vector
 *   6   a symmetric tensor: xx xy xz yy yz zz. In .vti and .vtk: xx yy zz xy yz xz. In NIfTI with the
 *       intent of symmetric matrices: xx yx yy zx zy zz
 *   7   a mask and a symmetric tensor, which is used where the mask is at least 0.5
 *       (3D-masked-symmetric-matrix of .nrrd)
 *   9   a tensor row by row, of which the symmetric part is used
 *
 * The axes of the components are those that the header states (the space and measurement frame of .nrrd, the
 * space of .vdb). NIfTI does not state them; they are taken as RAS. In other formats they are the axes of
 * the file's world. */
#ifndef ISO_GRIDS_VOLUME_VECTORS_READ_H
#define ISO_GRIDS_VOLUME_VECTORS_READ_H

#include "grids/vectors.h"
#include "grids/volume/volume.h"

/* The axes in which components are given. */
typedef enum iso_vector_axes {
    ISO_VECTOR_AXES_FILE, /* those of the file, as described above */
    ISO_VECTOR_AXES_LPS,
    ISO_VECTOR_AXES_RAS,    /* also for positions, if the format does not state their axes */
    ISO_VECTOR_AXES_VOXELS, /* the directions of the voxels' axes */
    ISO_VECTOR_AXES_FSL     /* the axes of the voxels, the first one reversed in volumes that are right-handed
                               in RAS */
} iso_vector_axes;

/* Options. Zero means the default. Strings are borrowed for the call. */
typedef struct iso_vectors_opts {
    const char *array; /* name of the array in a .vti, .vtk or .vdb; NULL: the first one with 3, 6, 7 or 9
                          components */
    iso_vector_axes axes;
    /* For six components: the numbers (from 1) of those that are xx, xy, xz, yy, yz and zz; all 0: as
     * above. */
    int order[6];
    uint64_t max_memory; /* limit in bytes for the vectors and for reading them; 0: 80 % of the available
                            memory */
    iso_file_set *files; /* every file that is read is added to it; may be NULL */
    iso_pool *pool;
} iso_vectors_opts;

/* What the file states. */
typedef struct iso_vectors_info {
    iso_volume_info volume;
    bool ras;         /* the components were read as RAS */
    bool axes_stated; /* the header states the axes of the components */
    double asymmetry; /* for nine components: greatest difference between two entries that should be equal */
} iso_vectors_info;

/* Reads the volume; iso_vectors_free when done. `opts` may be NULL. Errors: those of iso_volume_read;
 * ISO_ERR_EMPTY: the voxels have another number of components; ISO_ERR_LIMIT: vectors and reading take more
 * than max_memory, checked before anything is allocated. Each text names the file. */
iso_status iso_vectors_read(const char *path, const iso_vectors_opts *opts, iso_vectors *vectors,
                            iso_vectors_info *info, iso_error *error);

#endif
