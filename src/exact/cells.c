/* cells: chooses among the kernels that find a brick's crossed cells (cells_kernel.c). */
#include "exact/cells.h"

#include "base/kernel_units.h"

iso_exact_extract *iso_exact_extract_get(iso_type type, iso_cpu_level level) {
    return (*ISO_KERNEL_UNIT(iso_exact_extracts, level))[type];
}
