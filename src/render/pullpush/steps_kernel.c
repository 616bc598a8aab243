/* steps_kernel: pull, push and the last push, compiled for each way of averaging: ISO_VARIANT is ONE, TWO or
 * SETS. */
#include "render/pullpush/finish_simd.h"

const iso_pullpush_steps ISO_KERNEL_NAME(ISO_PASTE(iso_pullpush_steps, ISO_VARIANT)) = {
    .unpack_keys = unpack_keys,
    .pull_rows = pull_rows,
    .make_ellipses = make_ellipses,
    .push_rows = push_rows,
    .finish_samples = finish_samples,
};
