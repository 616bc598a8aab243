/* module: readers in shared objects that are loaded when a file needs them; and MPI, when mpirun has started
 * the program.
 *
 * VTK, OpenVDB and GDCM take tens of milliseconds and megabytes before they read a byte, so programs must not
 * be linked to them. A module is the file libisopoint-NAME.so. It exports one symbol, a table of functions,
 * and contains copies of the functions of this library that it needs, because the shared libisopoint does not
 * export them. The copies have separate static variables; the only one, the limit set by iso_cpu_limit, is
 * not used by readers.
 *
 * Modules are searched in the folder ISO_MODULE_PATH, an absolute path, if it is set; otherwise in isopoint/
 * beside the shared library, or at the place of the installation relative to a program in bin/, and then
 * where it was installed. Modules are never unloaded. */
#ifndef ISO_GRIDS_VOLUME_MODULE_H
#define ISO_GRIDS_VOLUME_MODULE_H

#include <stdio.h>

#include "base/c_linkage.h"
#include "base/mpi_ranks.h"
#include "grids/level_set.h"
#include "grids/volume/dicom/dicom.h"
#include "grids/volume/format.h"
#include "grids/volume/remote/remote.h"

ISO_C_BEGIN

/* Increase this if a type that modules share with the library changes between two releases. */
#define ISO_MODULE_ABI 15

struct iso_level_set_colors;
/* Writes an hgrid to `stream`, as iso_level_set_put_vdb; `path` is for messages. */
typedef iso_status iso_level_set_writer(FILE *stream, const char *path, const iso_hgrid *grid,
                                        const char *name, const struct iso_level_set_colors *colors,
                                        const iso_progress *progress, iso_error *error);

/* Reads the colours of a file, as iso_level_set_read_colors. */
typedef iso_status iso_color_reader(const char *path, const iso_volume_opts *opts,
                                    const iso_color_receiver *to, iso_error *error);

/* Undoes the compression of a block by vtkLZMADataCompressor (`lzma`) or vtkLZ4DataCompressor. Returns the
 * number of bytes written to `to`, at most `room`; 0: it is damaged. */
typedef size_t iso_vtk_unpacker(bool lzma, const unsigned char *packed, size_t size, unsigned char *to,
                                size_t room);

/* Reads the `count` numbers of a small array of a file, in the order of the file. ISO_ERR_FORMAT: there is no
 * such array, or it has not as many numbers; ISO_ERR_IO, ISO_ERR_NOMEM. */
typedef iso_status iso_number_reader(const char *path, const char *array, const iso_volume_opts *opts,
                                     uint64_t count, double *numbers, iso_error *error);

/* Changes a row of the values of slice z, of the type in the file and in the machine's byte order; returns
 * whether it has. */
typedef bool iso_row_changer(void *context, int y, int z, char *row);
/* Writes a file to `stream` again, with rows changed in their order, and everything else as it is. */
typedef iso_status iso_file_rewriter(const char *path, const iso_volume_opts *opts, iso_row_changer *change,
                                     void *context, FILE *stream, const iso_progress *progress,
                                     iso_error *error);

/* The table of a module; functions that it does not have are NULL. */
typedef struct iso_module {
    int abi; /* the first member, so that every version can read it */
    const char *version;
    const iso_format *format;
    iso_dicom_decoder *dicom_decode;
    iso_level_set_writer *write_level_set;
    iso_color_reader *read_colors;
    const iso_message_passing *messages;
    const iso_remote *remote;
    iso_vtk_unpacker *vtk_unpack;
    iso_number_reader *read_numbers;
    iso_file_rewriter *rewrite;
} iso_module;

#ifdef __cplusplus
#define ISO_MODULE_EXTERN extern "C"
#else
#define ISO_MODULE_EXTERN extern
#endif

/* Defines the one symbol that a module exports. ISO_VERSION comes from the build. */
#define ISO_MODULE(format, dicom_decode, write_level_set, read_colors, vtk_unpack)                           \
    ISO_MODULE_EXTERN const iso_module iso_module_table;                                                     \
    const iso_module iso_module_table = {ISO_MODULE_ABI,  ISO_VERSION, format, dicom_decode,                 \
                                         write_level_set, read_colors, 0,      0,                            \
                                         vtk_unpack,      0,           0}

/* Loads module `name` and returns its table, which stays valid. `path` is the file that needs it and
 * `library` the library that it uses, both for messages. ISO_ERR_UNSUPPORTED: the module or a library is not
 * installed, or is of another version. Thread-safe. */
iso_status iso_module_load(const char *path, const char *name, const char *library, const iso_module **module,
                           iso_error *error);

ISO_C_END
#endif
