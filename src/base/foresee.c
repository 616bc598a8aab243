/* foresee: extrapolates the size of arrays. */
#include "base/foresee.h"

#include "base/memory.h"

size_t iso_foresee_bytes(size_t used, size_t done, size_t total) {
    if (!done) return 0;
    const double all = 1.0625 * (double)used / (double)done * (double)total, most = 4 * (double)used;
    const size_t bytes = (size_t)(all < most ? all : most);
    return iso_memory_has_room(2 * bytes) ? bytes : 0;
}
