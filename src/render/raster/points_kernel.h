/* points_kernel: what the kernels of attenuated points (points.c) and their caller share: bands of rows, and
 * projected points. Internal to raster. */
#ifndef ISO_RENDER_RASTER_POINTS_KERNEL_H
#define ISO_RENDER_RASTER_POINTS_KERNEL_H

#include "base/cpu.h"
#include "base/point_code.h"
#include "render/raster/raster.h"
#include "render/view/project.h"

enum {
    BLOCK_POINTS = 4096, /* points that are culled together: a span, or a part of a longer one */
    CHUNK = 256,         /* points that are projected together */
    REACH = 24,          /* largest radius of discs drawn by the kernel, pixels */
    /* Pixels on both sides of a band's rows, so that discs need no clipping at the picture's sides. Their
     * depth is -INFINITY: nothing is drawn there. */
    MARGIN = 64,
    BAND_BYTES = 1200 << 10, /* largest memory of a band */
    MOST_ROWS = 128,
    LEAST_ROWS = 8
};
_Static_assert(MARGIN >= 2 * REACH + ISO_LANES_MAX, "discs must stay within the margin");
/* Pixels from the picture's corner: discs with centres farther away are drawn by draw_large. */
static const double FAR_PIXELS = 1 << 20;
/* The value of `source` in a pixel that shows no point. */
static const uint32_t NO_POINT = UINT32_MAX;

typedef struct block {
    const iso_point_span *span;
    size_t first; /* in the arrays of points */
    uint32_t count;
    iso_rows rows; /* rows of the picture that its discs may cover */
} block;

/* The drawing of one surface. */
typedef struct point_draw {
    const iso_target *target;
    const iso_point_view *points;
    iso_projector projector;
    block *blocks;
    size_t block_count;
    int band_rows;    /* rows of a band */
    size_t pitch;     /* pixels of a band's row, with margins */
    float *depth;     /* band_rows * pitch for each worker */
    uint32_t *source; /* likewise */
    const struct point_kernels *kernels;
} point_draw;

/* A band while it is drawn, by one worker. Pixel (x, y) is at [(y - rows.first) * pitch + MARGIN + x]. */
typedef struct point_band {
    const point_draw *draw;
    iso_rows rows;
    float *depth;
    uint32_t *source; /* packed normal of a packed point, or number of a surfel, or NO_POINT */
} point_band;

/* How a point is drawn: not at all; as one pixel; as a disc by the kernel; by draw_large. */
enum { POINT_OUT, POINT_PIXEL, POINT_DISC, POINT_LARGE };

/* Projected points. Centres are snapped to 1/65536 pixel relative to the optical axis, so that strips of a
 * picture cover the same pixels as the whole. */
typedef struct point_chunk {
    int32_t kind[CHUNK];               /* POINT_OUT .. */
    int32_t column[CHUNK], row[CHUNK]; /* pixel that contains the centre */
    float fx[CHUNK], fy[CHUNK];        /* centre inside it, 0 .. 1 */
    float radius[CHUNK];               /* pixels */
    float depth[CHUNK];
} point_chunk;

static inline float *band_pixel(const point_band *band, int x, int y) {
    const ptrdiff_t row = y - band->rows.first;
    return band->depth + row * (ptrdiff_t)band->draw->pitch + MARGIN + x;
}

/* Returns the value that point_band.source has for a point. */
static inline uint32_t source_of(const point_draw *draw, size_t index) {
    if (draw->points->surfels) return (uint32_t)index;
    return iso_point_normal_bits(draw->points->packed[index]);
}

static inline double point_radius(const iso_point_view *points, size_t index) {
    double radius = points->radii ? points->radii[index] : points->radius;
    return radius > 0 ? radius : 0;
}

typedef struct point_kernels {
    /* Projects `count` points of a block, from point number `first` on. */
    void (*project_chunk)(const point_draw *draw, const block *b, size_t first, int count, point_chunk *out);
    /* Draws projected points into a band. */
    void (*splat_chunk)(const point_band *band, const block *b, const point_chunk *chunk, size_t first,
                        int count);
    /* Writes a row of the band into the gbuffer, with the normals of packed points. */
    void (*resolve_row)(const point_band *band, int row);
} point_kernels;
ISO_KERNEL_UNITS(const point_kernels, iso_point_kernels);

/* Draws the disc of a point row by row; the disc may have any size. */
void iso_draw_large_point(const point_band *band, const block *b, size_t index);

#endif
