/* frame: lists the visible bricks of a surface front to back, and draws bands of rows: every band draws all
 * octants of the bricks that have free pixels in it. */
#include "exact/frame.h"

#include <stddef.h>
#include <string.h>

#include "base/memory.h"

enum {
    MOST_COLUMNS = 1 << 16, /* the kernels keep a pixel as y << 16 | x, signed */
    MOST_ROWS = 1 << 15,
    OCTANTS_AT_ONCE = 32 /* at least so many are drawn at once: a kernel fetches the next one in advance */
};

static void order_spans(iso_exact_frame *frame) {
    const iso_exact *exact = frame->projection.exact;
    const uint32_t *rows = exact->rows.data, *order = exact->order.data;
    const int *bricks = exact->set.bricks;
    int split[3];
    for (int axis = 0; axis < 3; axis++)
        split[axis] = iso_exact_brick_split(&frame->projection, axis) - exact->origin[axis];
    size_t count = 0;
    for (int k = 0; k < bricks[2]; k++)
        for (int j = 0; j < bricks[1]; j++) {
            const size_t row = (size_t)iso_exact_front_to_back(k, bricks[2], split[2]) * (size_t)bricks[1] +
                               (size_t)iso_exact_front_to_back(j, bricks[1], split[1]);
            uint32_t middle = rows[row];
            while (middle < rows[row + 1] &&
                   iso_exact_spans(exact)[order[middle]].brick[0] - exact->origin[0] < split[0])
                middle++;
            for (uint32_t i = middle; i < rows[row + 1]; i++) frame->order[count++] = order[i];
            for (uint32_t i = middle; i > rows[row]; i--) frame->order[count++] = order[i - 1];
        }
    frame->brick_count = count;
}

/* Whether a frame draws bricks that it extracts itself. */
static bool extracts(const iso_exact_frame *frame) {
    return frame->projection.paint && frame->projection.paint->keys;
}

/* The brick of the whole with a number of frame->order. */
static void locate(const iso_exact_frame *frame, uint32_t number, int32_t brick[3]) {
    if (extracts(frame))
        iso_exact_locate_brick(frame, number, brick);
    else
        memcpy(brick, iso_exact_spans(frame->projection.exact)[number].brick, 3 * sizeof *brick);
}

static void list_task_bricks(void *context, size_t index, int worker) {
    (void)worker;
    iso_exact_frame *frame = context;
    iso_exact_visible_brick *visible = frame->visible + index * ISO_EXACT_BRICKS_PER_TASK;
    size_t end = (index + 1) * ISO_EXACT_BRICKS_PER_TASK;
    if (end > frame->brick_count) end = frame->brick_count;
    int count = 0;
    for (size_t i = index * ISO_EXACT_BRICKS_PER_TASK; i < end; i++) {
        int32_t brick[3];
        visible[count].number = frame->order[i];
        locate(frame, frame->order[i], brick);
        count += iso_exact_brick_is_visible(&frame->projection, brick, &visible[count].box);
    }
    frame->visible_count[index] = count;
}

static iso_status alloc_frame(iso_exact_frame *frame, iso_error *error) {
    const iso_exact *exact = frame->projection.exact;
    const size_t bricks = extracts(frame) ? iso_exact_count_bricks(exact)
                          : exact->sorted ? exact->set.span_count
                                          : 0;
    frame->task_count = (bricks + ISO_EXACT_BRICKS_PER_TASK - 1) / ISO_EXACT_BRICKS_PER_TASK;
    frame->order = iso_alloc(bricks * sizeof *frame->order);
    frame->visible = iso_alloc(frame->task_count * ISO_EXACT_BRICKS_PER_TASK * sizeof *frame->visible);
    frame->visible_count = iso_alloc(frame->task_count * sizeof *frame->visible_count);
    if (frame->order && frame->visible && frame->visible_count) return ISO_OK;
    return iso_fail(error, ISO_ERR_NOMEM, "out of memory for drawing %zu bricks of cells", bricks);
}

iso_status iso_exact_frame_start(iso_exact_frame *frame, iso_error *error) {
    const iso_view *view = frame->projection.target->view;
    const iso_grid *grid = &frame->projection.exact->grid;
    if (view->width > MOST_COLUMNS || view->height > MOST_ROWS)
        return iso_fail(error, ISO_ERR_LIMIT,
                        "a picture of %d x %d samples, but the exact surface is drawn in %d x %d at most: "
                        "use fewer --samples or a lower --resolution",
                        view->width, view->height, MOST_COLUMNS, MOST_ROWS);
    frame->projection.gradients = iso_exact_gradients_get(grid, iso_cpu_best());
    frame->projection.voxels = iso_exact_voxels_of(grid);
    ISO_TRY(alloc_frame(frame, error));
    if (extracts(frame))
        iso_exact_order_bricks(frame);
    else if (frame->task_count)
        order_spans(frame);
    iso_parallel_for(frame->projection.target->pool, frame->task_count, list_task_bricks, frame);
    return ISO_OK;
}

void iso_exact_frame_free(iso_exact_frame *frame) {
    iso_free(frame->order);
    iso_free(frame->visible);
    iso_free(frame->visible_count);
}

/* Makes those pixels of a row of the band free that do not belong to a brick in front of all listed ones. */
static void open_row(const iso_exact_frame *frame, const uint64_t *keys, uint64_t *row) {
    const uint64_t least = (uint64_t)frame->least << 32;
    for (int x = frame->columns[0]; x <= frame->columns[1]; x++)
        row[x / 64] |= (uint64_t)(keys[x] > least) << x % 64;
}

/* If a single plane cuts the surface, nothing that is left of it is nearer than the plane: pixels of a row
 * that show something in front of the plane, as its cap, are not free. */
static void close_row(const iso_exact_projection *projection, int y, uint64_t *row) {
    const iso_target *target = projection->target;
    const iso_clip_body *body = &projection->clip->body[0];
    const double side = body->keeps ? -1 : 1, *face = body->face[0], slack = 1 + 2e-7; /* depths are floats */
    const iso_vec3 normal = {side * face[0], side * face[1], side * face[2]};
    double slope[2],
        depth[2]; /* towards what is left, in columns 0 and 1; the ray is there at depth / slope */
    for (int x = 0; x < 2; x++) {
        iso_vec3 origin, direction;
        iso_view_ray(target->view, x + 0.5, y + 0.5, &origin, &direction);
        slope[x] = iso_vec3_dot(normal, direction);
        depth[x] = slack * (side * face[3] - iso_vec3_dot(normal, origin));
    }
    const int width = target->gbuffer->width;
    const float *front = target->gbuffer->depth + (ptrdiff_t)y * width;
    for (int x = 0; x < width; x += 64) {
        uint64_t hidden = 0;
        const int count = width - x < 64 ? width - x : 64;
        for (int i = 0; i < count; i++) {
            if (front[x + i] == INFINITY) continue;
            const double toward = slope[0] + (x + i) * (slope[1] - slope[0]),
                         at = depth[0] + (x + i) * (depth[1] - depth[0]);
            hidden |= (uint64_t)((toward > 0) & (front[x + i] * toward <= at)) << i;
        }
        row[x / 64] &= ~hidden;
    }
}

/* Makes all pixels of the band free, but for those where nothing can be seen, and empties the lists. */
static void start_band(const iso_exact_frame *frame, iso_rows rows, iso_exact_scratch *scratch) {
    const int width = frame->projection.target->gbuffer->width;
    const iso_exact_paint *paint = frame->projection.paint;
    scratch->rows = rows;
    scratch->hits.count = scratch->hits.slots = 0;
    scratch->pairs = scratch->general = scratch->windows = 0;
    scratch->patch.count = scratch->patch.runs = 0;
    for (int y = 0; y <= rows.last - rows.first; y++) {
        uint64_t *row = scratch->open + (size_t)y * (size_t)scratch->words;
        if (paint && paint->keys) {
            memset(row, 0, (size_t)scratch->words * sizeof *row);
            open_row(frame, paint->keys + (size_t)(rows.first + y) * (size_t)width, row);
            continue;
        }
        for (int word = 0; word < scratch->words; word++) row[word] = word < width / 64 ? ~(uint64_t)0 : 0;
        if (width % 64) row[width / 64] = ((uint64_t)1 << width % 64) - 1;
        if (!paint && iso_clip_is_plane(frame->projection.clip))
            close_row(&frame->projection, rows.first + y, row);
    }
}

void iso_exact_frame_draw(const iso_exact_frame *frame, iso_rows rows, iso_exact_scratch *scratch) {
    iso_exact_visible octants[OCTANTS_AT_ONCE + ISO_EXACT_OCTANTS];
    int count = 0, clip[4];
    start_band(frame, rows, scratch);
    if (extracts(frame)) {
        iso_exact_draw_bricks(frame, scratch);
        return;
    }
    for (size_t task = 0; task < frame->task_count; task++)
        for (int i = 0; i < frame->visible_count[task]; i++) {
            const iso_exact_visible_brick *brick =
                &frame->visible[task * ISO_EXACT_BRICKS_PER_TASK + (size_t)i];
            if (!iso_exact_is_open(scratch, &brick->box, clip)) continue;
            count += iso_exact_list_visible_octants(&frame->projection, brick->number, octants + count);
            if (count < OCTANTS_AT_ONCE) continue;
            frame->kernel->draw(&frame->projection, octants, count, scratch);
            count = 0;
        }
    frame->kernel->draw(&frame->projection, octants, count, scratch);
    frame->kernel->flush(&frame->projection, scratch);
}

iso_exact_scratch *iso_exact_scratch_create(size_t workers, int width, int rows) {
    const size_t words = (size_t)width / 64 + 2, open = words * (size_t)rows;
    iso_exact_scratch *scratch = iso_alloc(workers * (sizeof *scratch + open * sizeof *scratch->open));
    for (size_t worker = 0; scratch && worker < workers; worker++) {
        /* Whole vectors are read, also behind the last pair and hit: what is computed from these lanes is not
         * used, but they have values. */
        memset(scratch[worker].pixel, 0, sizeof scratch->pixel);
        memset(&scratch[worker].hits, 0, offsetof(iso_exact_hits, place));
        scratch[worker].words = (int)words;
        scratch[worker].open = (uint64_t *)(scratch + workers) + worker * open;
    }
    return scratch;
}
