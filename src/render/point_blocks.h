/* point_blocks: points cut into blocks that are culled and dealt out to bands of rows together. Internal to
 * render. */
#ifndef ISO_RENDER_POINT_BLOCKS_H
#define ISO_RENDER_POINT_BLOCKS_H

#include "base/memory.h"
#include "render/project.h"
#include "render/pullpush/pyramid.h"

/* The radius of a point's disc, in the point's own radii: discs that only just meet leave holes. */
#define ISO_DISC_RADII 1.25f

/* A span, or a part of a long one. */
typedef struct iso_point_block {
    int32_t brick[3];
    uint32_t count;
    size_t first;
    size_t span;
    /* In this view: */
    bool back_facing, front_facing; /* all its points face away from the eye, or to it */
    bool seen;                      /* by the whole picture or the points' radii around it */
    bool clipped;                   /* rows and columns leave out points too near to be seen */
    int32_t row[2];    /* first and last pixel row of its points' centres, counted from the optical axis */
    int32_t column[2]; /* the same for columns */
    float depth[2];    /* of the nearest and the farthest of its points' centres, mm, a little widened */
    float radius[2];   /* smallest and largest projected radius of discs that may be seen, pixels */
} iso_point_block;

typedef struct iso_point_blocks {
    iso_buffer blocks, rows, chunks;
    size_t count;
    /* Of iso_point_blocks_measure: what it found out, and of how many blocks; the last one's. */
    iso_buffer extents, last_blocks, last_extents;
    size_t measured;
    double shared_radius;
    /* Of the blocks seen: */
    size_t seen;
    float radius[2];
    bool around_eye; /* the eye is inside the box around all blocks, seen or not */
    /* Blocks by band: those of band b are order[start[b]] .. order[start[b + 1] - 1]. */
    iso_buffer order, start;
} iso_point_blocks;

/* Cuts the points into blocks and computes their view-dependent fields. The result holds for every strip of a
 * picture. ISO_ERR_NOMEM. */
iso_status iso_point_blocks_make(iso_point_blocks *blocks, const iso_point_view *points,
                                 const iso_projector *projector, iso_pool *pool, iso_error *error);

/* The same in two steps, for points that are in GPU memory when they are drawn: iso_point_blocks_measure
 * cuts and measures them, iso_point_blocks_set_view then computes the view-dependent fields without
 * reading the points. Spans for which `same` (context, number of the span) returns true have not changed
 * since the last call and are not measured again; NULL: all are measured. ISO_ERR_NOMEM. */
typedef bool iso_same_span(const void *context, size_t span);
iso_status iso_point_blocks_measure(iso_point_blocks *blocks, const iso_point_view *points,
                                    iso_same_span *same, const void *context, iso_error *error);
iso_status iso_point_blocks_set_view(iso_point_blocks *blocks, bool closed, const iso_transform *transform,
                                     const iso_projector *projector, iso_error *error);

/* Assigns the visible blocks (with `cull` without back-facing ones) to bands of `band_rows` rows, a power
 * of two, of the pyramid's base level: sets `order` and `start`. ISO_ERR_NOMEM. */
iso_status iso_point_blocks_assign_bands(iso_point_blocks *blocks, const iso_view *view,
                                         const iso_pyramid *pyramid, int band_rows, bool cull,
                                         iso_error *error);

void iso_point_blocks_free(iso_point_blocks *blocks);

#endif
