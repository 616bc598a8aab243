/* point_blocks: points divided into blocks of up to 4096. A block is culled as a whole, by the picture's
 * sides and by its facing, and assigned to the bands of rows that it covers. Internal to render. */
#ifndef ISO_RENDER_POINTS_POINT_BLOCKS_H
#define ISO_RENDER_POINTS_POINT_BLOCKS_H

#include "base/memory.h"
#include "render/view/project.h"

/* Radius of the disc drawn for a point, in radii of the point. Larger than 1: discs that only just touch
 * leave holes. */
#define ISO_DISC_RADII 1.25f

/* The depth, mm, of pixels without a point: greater than any other, and finite, so that a weight of zero
 * makes it zero. */
#define ISO_NOWHERE 1e30f

/* A span of points, or a part of a span that is longer than a block. */
typedef struct iso_point_block {
    int32_t brick[3];
    uint32_t count; /* points */
    size_t first;   /* index of the first point */
    size_t span;    /* number of the span */
    float scale;    /* of the radius of points without radii of their own (iso_point_view.span_scales) */
    /* In the current view: */
    bool back_facing, front_facing; /* all points face away from the eye; all face the eye */
    bool seen;                      /* discs may cover pixels of the whole picture */
    bool clipped;      /* some points are too near to be seen: `row` and `column` do not include them */
    int32_t row[2];    /* first and last pixel row of the points' centres, counted from the optical axis */
    int32_t column[2]; /* the same for columns */
    float depth[2];    /* least and greatest depth of the points' centres, mm, widened for rounding */
    float radius[2];   /* smallest and largest projected radius of discs that may be seen, pixels */
} iso_point_block;

/* Zero-initialise; free with iso_point_blocks_free. Buffers are kept from one call to the next. */
typedef struct iso_point_blocks {
    iso_buffer blocks;       /* iso_point_block */
    iso_buffer rows, chunks; /* working memory */
    size_t count;            /* of blocks */
    /* Results of iso_point_blocks_measure that do not depend on the view, of this call and the one before;
     * how many blocks this call measured; and the radius (mm) of points without radii of their own. */
    iso_buffer extents, last_blocks, last_extents;
    size_t measured;
    double shared_radius;
    size_t seen;         /* number of blocks that are seen */
    float radius[2];     /* smallest and largest projected radius of their discs, pixels */
    double lo[3], hi[3]; /* the box around all blocks, seen or not, with the eye at the origin */
    bool around_eye;     /* the eye is inside this box */
    /* size_t start[], uint32_t order[]: the blocks of band b are order[start[b]] .. order[start[b + 1] -
     * 1]. */
    iso_buffer order, start;
} iso_point_blocks;

/* Divides the points into blocks and computes their view-dependent fields. The result holds for every strip
 * of the picture. ISO_ERR_NOMEM. */
iso_status iso_point_blocks_make(iso_point_blocks *blocks, const iso_point_view *points,
                                 const iso_projector *projector, iso_pool *pool, iso_error *error);

/* The same in two steps, for points that are in GPU memory when they are drawn: iso_point_blocks_measure
 * divides and measures them when they change, iso_point_blocks_set_view then computes the view-dependent
 * fields without reading the points. Spans for which `same` (context, number of the span) returns true have
 * not changed since the last call and are not measured again; NULL: all are measured. ISO_ERR_NOMEM. */
typedef bool iso_same_span(const void *context, size_t span);
iso_status iso_point_blocks_measure(iso_point_blocks *blocks, const iso_point_view *points,
                                    iso_same_span *same, const void *context, iso_error *error);
iso_status iso_point_blocks_set_view(iso_point_blocks *blocks, bool closed, const iso_transform *transform,
                                     const iso_projector *projector, iso_error *error);

/* The rows of a pyramid's level, in bands: `row` is the view's row that is the first of level 0, `rows` the
 * number of rows of level `level`, of which a band has `band_rows`, a power of two. */
typedef struct iso_level_bands {
    int level, row, rows, band_rows;
} iso_level_bands;

/* Assigns the visible blocks, with `cull` only those that are not back-facing, to bands of rows: sets `order`
 * and `start`. ISO_ERR_NOMEM. */
iso_status iso_point_blocks_assign_bands(iso_point_blocks *blocks, const iso_view *view,
                                         const iso_level_bands *bands, bool cull, iso_error *error);

void iso_point_blocks_free(iso_point_blocks *blocks);

#endif
