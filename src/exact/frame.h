/* frame: the visible bricks of one surface in one picture, front to back, and the drawing of bands of rows.
 * Internal to exact.
 *
 * A frame shows the bricks that the iso_exact has extracted. Into a key image it draws all bricks of the
 * grid: it extracts those that have free pixels when their turn comes. */
#ifndef ISO_EXACT_FRAME_H
#define ISO_EXACT_FRAME_H

#include "exact/kernel.h"

enum { ISO_EXACT_BRICKS_PER_TASK = 64 };

typedef struct iso_exact_frame {
    iso_exact_projection projection;
    const iso_exact_kernel *kernel;
    uint32_t *order; /* bricks front to back, as numbers of iso_exact_visible_brick */
    size_t brick_count;
    iso_exact_visible_brick
        *visible;       /* those of the bricks of task t, from index t * (bricks of a task) on */
    int *visible_count; /* number of visible bricks, by task */
    size_t task_count;
    /* Of key images: the least place (iso_exact_place) of a brick, and the first and last column to draw. */
    uint32_t least;
    int columns[2];
} iso_exact_frame;

/* Lists the visible bricks with all threads of the target's pool. The caller has set projection and kernel
 * and zeroed the rest. Free with iso_exact_frame_free, also after a failure. ISO_ERR_NOMEM. */
iso_status iso_exact_frame_start(iso_exact_frame *frame, iso_error *error);
void iso_exact_frame_free(iso_exact_frame *frame);

/* Before bands are drawn into a key image: sets `pixels` to those that the visible bricks can touch, columns
 * x0 .. x1 and rows y0 .. y1, and limits bands to these columns. False: nothing is visible. */
bool iso_exact_frame_limit(iso_exact_frame *frame, int pixels[4]);

/* Draws a band of rows. Any number of threads may draw bands of a frame, each with its own scratch. */
void iso_exact_frame_draw(const iso_exact_frame *frame, iso_rows rows, iso_exact_scratch *scratch);

/* For a frame that extracts the bricks (bricks.c): counts the bricks of the grid; lists those that the
 * isovalue crosses, if the ranges of a chunk are known, else all; tells the brick of the whole that has a
 * number; draws those that have free pixels into a band. */
size_t iso_exact_count_bricks(const iso_exact *exact);
void iso_exact_order_bricks(iso_exact_frame *frame);
void iso_exact_locate_brick(const iso_exact_frame *frame, uint32_t number, int32_t brick[3]);
void iso_exact_draw_bricks(const iso_exact_frame *frame, iso_exact_scratch *scratch);

/* The scratch memory of `workers` workers, for bands of at most `rows` rows of `width` pixels; NULL without
 * memory. Free with iso_free. */
iso_exact_scratch *iso_exact_scratch_create(size_t workers, int width, int rows);

#endif
