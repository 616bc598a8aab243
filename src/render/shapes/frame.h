/* frame: what is prepared once per picture: the view in the numbers that kernels use, and the blocks in
 * sight, front to back, dealt to rectangles of the picture (bins). Internal to shapes and render/gl.
 *
 * Rows are counted from the top of the whole picture, of which the target may be a strip: so that no number
 * depends on how the picture is cut. */
#ifndef ISO_RENDER_SHAPES_FRAME_H
#define ISO_RENDER_SHAPES_FRAME_H

#include <math.h>

#include "render/shapes/set.h"

enum { ISO_SHAPES_BIN = 256 }; /* pixels on a bin's side */

/* A rectangle of pixels, all inclusive. */
typedef struct iso_shapes_rect {
    int x0, y0, x1, y1;
} iso_shapes_rect;

/* A block in sight. */
typedef struct iso_shapes_seen {
    double centre[3]; /* the block's origin in view space */
    float nearest;    /* no sample of the block is nearer */
    uint32_t block;
    iso_shapes_rect rect; /* that its shapes can cover, within the picture */
    /* Its shapes are placed one by one in double precision: the block crosses the near plane or is so large
     * in the picture that floats relative to its origin are too coarse. */
    bool apart;
    bool is_cut; /* the target's clip may cut some of its shapes; blocks of which it leaves nothing are not in
                    sight */
} iso_shapes_seen;

typedef struct iso_shapes_frame {
    const iso_shapes *shapes;
    const iso_target *target;
    iso_vec3 eye; /* relative to the set's origin, as all positions */
    double rotation[9], focal, cx, cy, near;
    bool parallel;
    /* The same for kernels. The pixel at (dx, dy) from the projection of a point at depth z has the ray
     * (k dx, k dy, z) + s (u, v, 1) with k = z * slope + fixed, u = spread * (pixel - cx), v alike. `spread`
     * is the slope, but 0 for billboards, whose rays are parallel. */
    float turn[9], length, slope, spread, fixed, center_x, center_y; /* length: focal length */
    /* A tube's least radius at depth z is z * least_slope + least_fixed. */
    double least_slope, least_fixed;
    int top;           /* the target's first row in the picture */
    int columns, rows; /* numbers of bins */
    iso_shapes_seen *seen;
    size_t seen_count;
    size_t *bin_end;      /* by bin: where its list in bin_blocks ends, and the next bin's begins */
    uint32_t *bin_blocks; /* indices into `seen`, front to back */
} iso_shapes_frame;

/* A frame with the blocks in sight, without bins: what `target` needs is the view. ISO_ERR_NOMEM. The caller
 * frees the frame, also after errors. */
iso_status iso_shapes_frame_see(const iso_target *target, const iso_shapes *shapes, iso_shapes_frame *frame,
                                iso_error *error);
/* The same with bins. ISO_ERR_NOMEM. The caller frees the frame, also after errors. */
iso_status iso_shapes_frame_make(const iso_target *target, const iso_shapes *shapes, iso_shapes_frame *frame,
                                 iso_error *error);
void iso_shapes_frame_free(iso_shapes_frame *frame);

/* The pixels of a bin. */
iso_shapes_rect iso_shapes_bin_rect(const iso_shapes_frame *frame, size_t bin);

/* The view position of a point. */
static inline void iso_shapes_to_view(const iso_shapes_frame *frame, const double position[3],
                                      double view[3]) {
    const double *m = frame->rotation, x = position[0] - frame->eye.x, y = position[1] - frame->eye.y,
                 z = position[2] - frame->eye.z;
    for (int a = 0; a < 3; a++) view[a] = m[3 * a] * x + m[3 * a + 1] * y + m[3 * a + 2] * z;
}

/* Where a point of view space is in the picture: the origin that shapes near it are placed relative to. */
typedef struct iso_shapes_origin {
    float depth, rest; /* the depth, and what the float leaves of it */
    float u, v;        /* slopes of its ray; 0 in parallel views */
    float x, y;        /* its place in its pixel */
    int32_t column, row;
} iso_shapes_origin;

/* False where the point is so far outside the picture that floats do not count its pixels. */
static inline bool iso_shapes_origin_of(const iso_shapes_frame *frame, const double view[3],
                                        iso_shapes_origin *o) {
    const double w = frame->parallel ? 1 : view[2], u = view[0] / w, v = view[1] / w;
    const double x = frame->focal * u + frame->cx, y = frame->focal * v + frame->cy;
    if (!(fabs(x) < 1 << 20 && fabs(y) < 1 << 20)) return false;
    o->column = (int32_t)x - (x < (int32_t)x);
    o->row = (int32_t)y - (y < (int32_t)y);
    o->x = (float)(x - o->column);
    o->y = (float)(y - o->row);
    o->u = frame->parallel ? 0 : (float)u;
    o->v = frame->parallel ? 0 : (float)v;
    o->depth = (float)view[2];
    o->rest = (float)(view[2] - (double)o->depth);
    return true;
}

#endif
