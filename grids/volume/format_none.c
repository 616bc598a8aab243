/* format_none: entries without functions for formats whose library is not built in; volume.c reports "built
 * without ..." for these. */
#include <stddef.h>

#include "grids/volume/format.h"

#define ISO_FORMAT_NONE(format, library)                                                                     \
    const iso_format iso_format_##format = {#format, library, NULL, NULL, NULL, NULL}

#if !defined(ISO_HAVE_NIFTI) || !defined(ISO_HAVE_JPEG)
#error "the build has to say which libraries it has"
#endif

#if !ISO_HAVE_NIFTI
ISO_FORMAT_NONE(nifti, "libnifti2");
#endif

#if !ISO_HAVE_JPEG
ISO_FORMAT_NONE(jpeg, "libjpeg");
#endif

/* C does not allow an empty translation unit, which this would be when everything is built in. */
_Static_assert(sizeof(iso_format) > 0, "");
