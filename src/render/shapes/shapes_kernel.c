/* shapes_kernel: draws blocks of shapes into bins of pixels, and writes what is seen. */
#include "render/shapes/line_block_simd.h"
#include "render/shapes/resolve_simd.h"
#include "render/shapes/solid_block_simd.h"
#include "render/shapes/sphere_block_simd.h"

static void draw_block(iso_shapes_bin *bin, const iso_shapes_seen *seen) {
    const iso_shape_kind kind = iso_shapes_kind(bin->frame->shapes);
    bin->chunk.count = 0;
    if (kind == ISO_SHAPE_TUBE) {
        add_line_block(bin, seen, ISO_SHAPE_TUBE);
        draw_chunk(bin, ISO_SHAPE_TUBE);
    } else if (kind == ISO_SHAPE_RIBBON) {
        add_line_block(bin, seen, ISO_SHAPE_RIBBON);
        draw_chunk(bin, ISO_SHAPE_RIBBON);
    } else if (kind == ISO_SHAPE_SPHERE) {
        add_sphere_block(bin, seen);
        draw_chunk(bin, ISO_SHAPE_SPHERE);
    } else {
        add_solid_block(bin, seen);
        draw_chunk(bin, ISO_SHAPE_SOLID);
    }
}
const iso_shapes_kernel ISO_KERNEL_NAME(iso_shapes_kernel) = {
    .measure = measure, .hidden = hidden, .draw = draw_block, .resolve = resolve};
