/* nearby: what a search for the nearest thing remembers, so that the next search, for a place nearby, is
 * faster. */
#ifndef ISO_BASE_NEARBY_H
#define ISO_BASE_NEARBY_H

#include <stddef.h>

#include "base/memory.h"

/* Begins zeroed; for searches of one thing only, by one thread at a time. */
typedef struct iso_nearby {
    size_t last;     /* the number of what the last search found */
    size_t searches; /* how many there were, up to the one from which on there is memory */
    void *memory;    /* the search's own, of iso_alloc */
} iso_nearby;

/* Ends with it. */
static inline void iso_nearby_free(iso_nearby *nearby) {
    iso_free(nearby->memory);
    nearby->last = nearby->searches = 0;
    nearby->memory = NULL;
}

#endif
