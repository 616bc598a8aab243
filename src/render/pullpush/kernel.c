/* kernel: chooses among the units in which the kernels are compiled (project_kernel.c, steps_kernel.c). */
#include "render/pullpush/kernel.h"

#include "base/kernel_units.h"

iso_pullpush_project_fn *iso_pullpush_project_get(void) {
    return ISO_KERNEL_UNIT(iso_pullpush_project, iso_cpu_best());
}

const iso_pullpush_steps *iso_pullpush_steps_get(iso_pullpush_kind kind) {
    const iso_cpu_level level = iso_cpu_best();
    switch (kind) {
    case ISO_PULLPUSH_ONE_SIDED:
        return ISO_KERNEL_UNIT(iso_pullpush_steps_ONE, level);
    case ISO_PULLPUSH_TWO_SIDED:
        return ISO_KERNEL_UNIT(iso_pullpush_steps_TWO, level);
    case ISO_PULLPUSH_SETS:
        return ISO_KERNEL_UNIT(iso_pullpush_steps_SETS, level);
    case ISO_PULLPUSH_TUBES:
    case ISO_PULLPUSH_RIBBONS:
        break;
    }
    return &iso_line_steps;
}
