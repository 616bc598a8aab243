/* module: readers in shared objects of their own, loaded when a file needs them.
 *
 * VTK, OpenVDB and GDCM take tens of milliseconds and megabytes before they read a byte, so nothing that is
 * linked into every program may need them. A module is libisopoint-NAME.so; it exports one symbol, a table of
 * what it can do, and calls this library as any code in grids/ does: it holds a copy of the functions that it
 * needs, because the shared libisopoint exports none of them. The copies share what they are given and the C
 * library's heap; the one value that they keep for themselves, the limit that iso_cpu_limit sets, is not read
 * by readers.
 *
 * Modules are looked for in ISO_MODULE_PATH (a folder, and then only there), else in isopoint/ beside the
 * shared library or where the installation has it as seen from a program in bin/, else where it was
 * installed. Nothing is kept here: the dynamic linker knows what it has loaded, and no module is ever
 * unloaded. */
#ifndef ISO_GRIDS_VOLUME_MODULE_H
#define ISO_GRIDS_VOLUME_MODULE_H

#include <stdio.h>

#include "grids/level_set.h"
#include "grids/volume/dicom/dicom.h"
#include "grids/volume/format.h"

#ifdef __cplusplus
extern "C" {
#endif

/* To be raised when a type that modules share with the library changes between two releases. */
#define ISO_MODULE_ABI 5

/* Writes an hgrid to `stream` (grids/level_set.h); `path` is for messages. */
typedef iso_status iso_level_set_writer(FILE *stream, const char *path, const iso_hgrid *grid,
                                        const char *name, const iso_progress *progress, iso_error *error);

/* What a module cannot do is NULL. */
typedef struct iso_module {
    int abi; /* first, so that every version can read it */
    const char *version;
    const iso_format *format;
    iso_dicom_decoder *dicom_decode;
    iso_level_set_writer *write_level_set;
} iso_module;

/* Defines the one symbol that a module exports. ISO_VERSION comes from the build. */
#define ISO_MODULE(format, dicom_decode, write_level_set)                                                    \
    extern "C" const iso_module iso_module_table;                                                            \
    const iso_module iso_module_table = {ISO_MODULE_ABI, ISO_VERSION, format, dicom_decode, write_level_set}

/* The table of module `name`, valid for ever. `path` is the file that needs it and `library` the library that
 * it brings, both for messages. ISO_ERR_UNSUPPORTED when the module or a library is not installed, or is of
 * another version. Any thread may call it. */
iso_status iso_module_load(const char *path, const char *name, const char *library, const iso_module **module,
                           iso_error *error);

#ifdef __cplusplus
}
#endif
#endif
