#include "grids/brick_range.h"

#include <float.h>
#include <math.h>
#include <stdint.h>

#include "base/primitives.h"

/* A chunk of bricks along x at a time: the columns of one stay in the first-level cache. */
enum { CHUNK = 64, COLUMNS = CHUNK * ISO_BRICK + 1 };

/* Voxels to read, from the first one's address on. */
typedef struct range_box {
    ptrdiff_t stride_y, stride_z; /* elements */
    int n[3];
    int own; /* voxels along x that start bricks of their own: n[0], less the one of the next brick */
} range_box;

typedef void range_kernel(const void *data, const range_box *box, iso_brick_range *ranges);

#define ISO_V(name) name##_generic
#define ISO_TARGET
#include "grids/brick_range_body.inc"

#if ISO_HAVE_X86
#define ISO_V(name) name##_avx2
#define ISO_TARGET ISO_TARGET_AVX2
#include "grids/brick_range_body.inc"
#define ISO_V(name) name##_avx512
#define ISO_TARGET ISO_TARGET_AVX512
#include "grids/brick_range_body.inc"
#endif

static range_kernel *kernel_of(iso_type type, iso_cpu_level level) {
#define ISO_TYPES(v)                                                                                         \
    { ranges_uint8_##v, ranges_int16_##v, ranges_uint16_##v, ranges_float_##v }
#if ISO_HAVE_X86
    static range_kernel *const kernels[ISO_CPU_LEVELS][4] = {ISO_TYPES(generic), ISO_TYPES(avx2),
                                                             ISO_TYPES(avx512)};
    return kernels[level][type];
#else
    static range_kernel *const kernels[4] = ISO_TYPES(generic);
    (void)level;
    return kernels[type];
#endif
#undef ISO_TYPES
}

static int smaller(int a, int b) {
    return a < b ? a : b;
}

void iso_brick_ranges(const iso_rgrid *grid, iso_cpu_level level, const int first[3], int count,
                      iso_brick_range *ranges) {
    range_kernel *kernel = kernel_of(grid->type, level);
    const ptrdiff_t y = (ptrdiff_t)first[1] * ISO_BRICK, z = (ptrdiff_t)first[2] * ISO_BRICK;
    range_box box = {.stride_y = grid->stride_y, .stride_z = grid->stride_z};
    for (int axis = 1; axis < 3; axis++)
        box.n[axis] = smaller(ISO_BRICK + 1, grid->dims[axis] - first[axis] * ISO_BRICK);
    for (int done = 0; done < count; done += CHUNK) {
        const ptrdiff_t x = (ptrdiff_t)(first[0] + done) * ISO_BRICK;
        const int left = grid->dims[0] - (int)x;
        box.own = smaller(smaller(count - done, CHUNK) * ISO_BRICK, left);
        box.n[0] = smaller(box.own + 1, left);
        const ptrdiff_t at = x + y * grid->stride_y + z * grid->stride_z;
        kernel((const char *)grid->data + at * (ptrdiff_t)iso_type_size(grid->type), &box, ranges + done);
    }
}
