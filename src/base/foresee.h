/* foresee: how large an array that is filled step by step will get. Growing it often would copy it and touch
 * fresh memory several times. */
#ifndef ISO_BASE_FORESEE_H
#define ISO_BASE_FORESEE_H

#include <stddef.h>

/* How many bytes to reserve for an array that has `used` bytes after `done` of `total` steps: what all steps
 * will need if they are like those so far, but at most four times what is used, because the first steps may
 * mislead. 0: nothing is known yet, or memory is short. */
size_t iso_foresee_bytes(size_t used, size_t done, size_t total);

#endif
