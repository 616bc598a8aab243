/* conventions: what programs agree on about arrays in HDF5 files: VTKHDF, Imaris, BigDataViewer, NeXus, MINC,
 * EMD, ITK, dimension scales, and the attribute element_size_um. In the child process. */
#ifndef ISO_GRIDS_VOLUME_HDF5_CONVENTIONS_H
#define ISO_GRIDS_VOLUME_HDF5_CONVENTIONS_H

#include "grids/volume/hdf5/library.h"

/* What a convention tells about an array. */
typedef struct iso_hdf5_meaning {
    double spacing[3]; /* mm; 0: not stated */
    bool relative;     /* only the ratios of the spacing are known */
    uint64_t used[3];  /* voxels along x, y and z of an array that is padded; 0: all */
    int channels;      /* arrays of this kind that are components of one volume */
    int level, levels; /* of an image at several resolutions, 0 the finest; levels is 0: there is one */
    iso_hdf5_positions *positions; /* to be set where voxels are not evenly spaced */
} iso_hdf5_meaning;

/* Opens the array that is read when the user names none, of level opts->level if there is one, else of the
 * finest; negative: no convention tells. ISO_ERR_FORMAT: a file of VTK without an image. */
iso_status iso_hdf5_default(const iso_hdf5_file *file, const iso_volume_opts *opts, hid_t *dataset,
                            iso_error *error);

/* Opens the array of this name over the points or cells of a VTK image; negative: there is none. */
hid_t iso_hdf5_vtk_array(const iso_hdf5_file *file, const char *name);

/* Opens the array that a NeXus group is about: its attributes signal or default say so; negative: they do
 * not. */
hid_t iso_hdf5_signal(hid_t group);

/* Fills *meaning from what the file says about an array whose axes are known; may change the array's type.
 * Sets direction and origin of info->transform, and adds notes. ISO_ERR_FORMAT, ISO_ERR_UNSUPPORTED: what it
 * says makes no sense, or cannot be drawn. */
iso_status iso_hdf5_interpret(const iso_hdf5_file *file, iso_hdf5_array *array, iso_hdf5_meaning *meaning,
                              iso_volume_info *info, iso_error *error);

/* Sets the names and colours that an Imaris file states of the channels of an array, of which there are
 * `count`. *channels is zero before. */
void iso_hdf5_name_channels(const iso_hdf5_file *file, const iso_hdf5_array *array, int count,
                            iso_channels *channels);

/* Writes "its attribute NAME is 40 4 4" of an attribute that is called as distances of voxels often are, but
 * without a unit or an order that programs agree on. False: the array has none. */
bool iso_hdf5_unclear_distance(const iso_hdf5_file *file, const iso_hdf5_array *array, char *text,
                               size_t room);

/* ---- coordinates.c ---- */

/* Sets spacing, origin and positions from arrays of coordinates: of NeXus, EMD, and dimension scales. */
void iso_hdf5_take_coordinates(const iso_hdf5_file *file, const iso_hdf5_array *array,
                               iso_hdf5_meaning *meaning, iso_volume_info *info);

/* ---- minc.c ---- */

/* Opens the image of a MINC file; negative: there is none. */
hid_t iso_hdf5_minc_image(const iso_hdf5_file *file);
bool iso_hdf5_is_minc(const iso_hdf5_array *array);
/* As iso_hdf5_interpret. */
iso_status iso_hdf5_minc_geometry(const iso_hdf5_file *file, const iso_hdf5_array *array,
                                  iso_hdf5_meaning *meaning, iso_volume_info *info, iso_error *error);
/* Sets info's scale and offset; or *slices, and the type to floats, if they differ from slice to slice. Needs
 * dims, and array->at. ISO_ERR_FORMAT. */
iso_status iso_hdf5_minc_scales(const iso_hdf5_file *file, const iso_hdf5_array *array, iso_volume_info *info,
                                iso_hdf5_slices *slices, iso_error *error);

#endif
