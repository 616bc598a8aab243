/* format_none: stands in for the formats whose library is not built in. An entry without functions makes
 * volume.c answer "built without ...". */
#include <stddef.h>

#include "grids/format.h"

#define ISO_FORMAT_NONE(format, library) const iso_format iso_format_##format = {#format, library, NULL, NULL}

#if !defined(ISO_HAVE_VTK) || !defined(ISO_HAVE_OPENVDB)
#error "the build has to say which libraries it has"
#endif

#if !ISO_HAVE_VTK
ISO_FORMAT_NONE(vti, "VTK");
#endif
#if !ISO_HAVE_TEEM
ISO_FORMAT_NONE(nrrd, "teem");
#endif
#if !ISO_HAVE_NIFTI
ISO_FORMAT_NONE(nifti, "libnifti2");
#endif
#if !ISO_HAVE_GDCM
ISO_FORMAT_NONE(dicom, "GDCM");
#endif
#if !ISO_HAVE_OPENVDB
ISO_FORMAT_NONE(vdb, "OpenVDB");
#endif

/* A translation unit may not be empty when everything is built in. */
_Static_assert(sizeof(iso_format) > 0, "");
