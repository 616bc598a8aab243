/* bricks: bricks that a frame extracts as it draws them, into a key image. */
#include "exact/frame.h"

#include <limits.h>

/* The bricks of the grid whose cells belong to the surface: first .. end - 1 on each axis. */
static iso_brick_box box_of(const iso_exact *exact) {
    iso_brick_box box = exact->set.region.box;
    for (int axis = 0; axis < 3; axis++) {
        box.first[axis] -= exact->origin[axis];
        box.end[axis] = exact->set.restricted ? box.end[axis] - exact->origin[axis] : exact->set.bricks[axis];
    }
    return box;
}

size_t iso_exact_count_bricks(const iso_exact *exact) {
    const iso_brick_box box = box_of(exact);
    return iso_brick_box_count(&box);
}

void iso_exact_order_bricks(iso_exact_frame *frame) {
    const iso_exact *exact = frame->projection.exact;
    const iso_brick_range *ranges = exact->set.region.ranges;
    const iso_brick_box box = box_of(exact);
    const float isovalue = exact->surface.isovalue_ceil;
    int split[3], size[3], at[3];
    size_t count = 0;
    for (int axis = 0; axis < 3; axis++) {
        size[axis] = box.end[axis] - box.first[axis];
        split[axis] = iso_exact_brick_split(&frame->projection, axis) - exact->origin[axis] - box.first[axis];
    }
    for (int k = 0; k < size[2]; k++)
        for (int j = 0; j < size[1]; j++)
            for (int i = 0; i < size[0]; i++) {
                const int step[3] = {i, j, k};
                for (int axis = 0; axis < 3; axis++)
                    at[axis] = iso_exact_front_to_back(step[axis], size[axis], split[axis]);
                const size_t number =
                    ((size_t)at[2] * (size_t)size[1] + (size_t)at[1]) * (size_t)size[0] + (size_t)at[0];
                if (ranges && !(ranges[number].lo < isovalue && isovalue <= ranges[number].hi)) continue;
                frame->order[count++] =
                    (uint32_t)(((box.first[2] + at[2]) * exact->set.bricks[1] + box.first[1] + at[1]) *
                                   exact->set.bricks[0] +
                               box.first[0] + at[0]);
            }
    frame->brick_count = count;
}

void iso_exact_locate_brick(const iso_exact_frame *frame, uint32_t number, int32_t brick[3]) {
    const iso_exact *exact = frame->projection.exact;
    iso_brick_set_coordinates(&exact->set, number, brick);
    for (int axis = 0; axis < 3; axis++) brick[axis] += exact->origin[axis];
}

bool iso_exact_frame_limit(iso_exact_frame *frame, int pixels[4]) {
    int32_t brick[3];
    pixels[0] = pixels[2] = INT_MAX;
    pixels[1] = pixels[3] = -1;
    for (size_t task = 0; task < frame->task_count; task++)
        for (int i = 0; i < frame->visible_count[task]; i++) {
            const iso_exact_box *box = &frame->visible[task * ISO_EXACT_BRICKS_PER_TASK + (size_t)i].box;
            if (box->x0 < pixels[0]) pixels[0] = box->x0;
            if (box->x1 > pixels[1]) pixels[1] = box->x1;
            if (box->y0 < pixels[2]) pixels[2] = box->y0;
            if (box->y1 > pixels[3]) pixels[3] = box->y1;
        }
    if (pixels[1] < 0) return false;
    iso_exact_locate_brick(frame, frame->order[0], brick);
    frame->least = iso_exact_place(&frame->projection, brick);
    frame->columns[0] = pixels[0];
    frame->columns[1] = pixels[1];
    return true;
}

/* Begins with no cells of `exact`. */
static void begin(iso_exact_single *single, const iso_exact *exact) {
    iso_exact *own = &single->exact;
    *own = *exact;
    own->set = (iso_brick_set){.spans.data = &single->span, .span_count = 1};
    own->set.heap[0] = (iso_span_heap){.live = 1, .array[0].data = single->extraction.output.octant};
    own->set.heap[1] = (iso_span_heap){.live = 1, .array[0].data = single->extraction.output.corners};
    single->span = (iso_exact_span){.octants = 0};
}

/* Replaces the cells by those of a brick of the grid; false: it has none. */
static bool extract(iso_exact_single *single, const int brick[3]) {
    const iso_exact *exact = &single->exact;
    const iso_exact_output *made = &single->extraction.output;
    if (!iso_exact_find_cells(exact, brick, &single->extraction) || !made->cells) return false;
    single->span.octants = made->octants;
    single->span.cells = made->cells;
    for (int axis = 0; axis < 3; axis++) single->span.brick[axis] = brick[axis] + exact->origin[axis];
    return true;
}

void iso_exact_draw_bricks(const iso_exact_frame *frame, iso_exact_scratch *scratch) {
    iso_exact_projection projection = frame->projection;
    iso_exact_single *single = scratch->single;
    iso_exact_visible octants[ISO_EXACT_OCTANTS];
    /* Pixels in the kernel's queue keep nothing of the bricks that they belong to. */
    begin(single, projection.exact);
    projection.exact = &single->exact;
    for (size_t task = 0; task < frame->task_count; task++)
        for (int i = 0; i < frame->visible_count[task]; i++) {
            const iso_exact_visible_brick *visible =
                &frame->visible[task * ISO_EXACT_BRICKS_PER_TASK + (size_t)i];
            int clip[4], brick[3];
            if (!iso_exact_is_open(scratch, &visible->box, clip)) continue;
            iso_brick_set_coordinates(&frame->projection.exact->set, visible->number, brick);
            if (!extract(single, brick)) continue;
            frame->kernel->draw(&projection, octants, iso_exact_list_visible_octants(&projection, 0, octants),
                                scratch);
        }
    frame->kernel->flush(&projection, scratch);
}
