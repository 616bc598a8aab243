#include "sculpt/redistance.h"

#include "base/simd.h"

#define ISO_LEVEL generic
#include "sculpt/redistance_body.inc"
#undef ISO_LEVEL
#if ISO_HAVE_X86
#define ISO_LEVEL avx2
#include "sculpt/redistance_body.inc"
#undef ISO_LEVEL
#define ISO_LEVEL avx512
#include "sculpt/redistance_body.inc"
#undef ISO_LEVEL
#endif

const iso_redistancer *iso_redistancer_get(iso_cpu_level level) {
    return ISO_KERNEL(redistancer, level);
}
