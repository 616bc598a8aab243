/* attributes: named columns of numbers for sets that are computed, not read. Internal to
 * src/extract/vectors. */
#ifndef ISO_EXTRACT_VECTORS_ATTRIBUTES_H
#define ISO_EXTRACT_VECTORS_ATTRIBUTES_H

#include "base/lines.h"
#include "base/status.h"

/* Makes an array of attributes of one component with these names, which are copied, and room for `items`
 * values each; with 0 items the values are NULL. iso_attributes_free when done. ISO_ERR_NOMEM: nothing is
 * made. */
iso_status iso_attributes_make(const char *const *names, int count, size_t items, iso_attribute **attributes,
                               iso_error *error);

#endif
