/* crease: chooses among the kernels that correct distances beside creases (crease_kernel.c). */
#include "sculpt/field/crease.h"

#include "base/kernel_units.h"

iso_status iso_crease_correct(const float *window, float band, iso_buffer *room, float *out, bool *any) {
    enum { MOST = 3 * ISO_CREASE_EDGES * ISO_CREASE_EDGES * ISO_CREASE_EDGES };
    ISO_TRY(iso_buffer_reserve(room, MOST * sizeof(iso_crease_point), 0, NULL));
    *any = ISO_KERNEL_UNIT(iso_bound_creases, iso_cpu_best())(window, band, room->data, out);
    return ISO_OK;
}
