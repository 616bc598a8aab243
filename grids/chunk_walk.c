/* chunk_walk: visits the chunks of a volume that a surface crosses, and divides them among processes. */
#include "grids/chunk_walk.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/primitives.h"
#include "grids/threshold.h"

enum { USUAL_SIDE = 128 };

struct iso_chunk_walk {
    iso_chunk_walk_opts opts;
    iso_chunk_cuts cuts;
    size_t total; /* of chunks */
    float isovalue_ceil;
    iso_block_ranges own_ranges;
    iso_block_ranges *ranges; /* own_ranges or the caller's */
    uint8_t *states;          /* by chunk: flags CHUNK_ .. */
    /* By chunk, crossed_words words each: bit n: the surface crosses brick n of the chunk (CHUNK_READ).
     * NULL: there was no memory for them; then ranges are read in every visit. */
    uint64_t *crossed;
    size_t crossed_words;
    uint64_t *needed; /* the same of the chunk that is read, as far as it is known before */
    uint32_t *piece;  /* by chunk: which of `pieces` it belongs to, from 0; NULL: not yet divided */
    int pieces;
    iso_brick_range *bricks; /* of the chunk that is read */
    iso_chunk_totals totals;
};

enum {
    CHUNK_ENTERED = 1, /* its bricks are in `ranges`, or its blocks were known before */
    CHUNK_READ = 2,    /* its words of `crossed` are set */
    CHUNK_COUNTED = 4  /* it was visited */
};

/* ---- chunks */

static iso_grid_chunk make_chunk(const iso_chunk_walk *walk, size_t number) {
    const iso_chunk_source *source = walk->opts.source;
    iso_grid_chunk chunk;
    const iso_brick_box box = iso_chunk_box(&walk->cuts, number);
    iso_grid_chunk_make(source->dims, &source->transform, &box, &chunk);
    return chunk;
}

static bool crosses(const iso_chunk_walk *walk, const iso_brick_range *range) {
    return range->lo < walk->isovalue_ceil && walk->isovalue_ceil <= range->hi;
}

/* ---- reading */

static void enter_bricks(iso_chunk_walk *walk, size_t number, const iso_grid_chunk *chunk) {
    if (walk->states[number] & CHUNK_ENTERED) return;
    iso_block_ranges_add(walk->ranges, &chunk->box, walk->bricks);
    walk->states[number] |= CHUNK_ENTERED;
}

/* Whether a chunk must be read to know whether the surface crosses it, or because it does. Enters the
 * ranges of chunks that are constant. */
static bool must_read(iso_chunk_walk *walk, size_t number, const iso_grid_chunk *chunk) {
    const iso_chunk_source *source = walk->opts.source;
    iso_brick_range range;
    float value;
    if (iso_block_ranges_of(walk->ranges, &chunk->box, &range)) {
        walk->states[number] |= CHUNK_ENTERED;
        return crosses(walk, &range);
    }
    if (!source->is_constant || !source->is_constant(source->context, chunk, &value)) return true;
    const size_t bricks = iso_brick_box_count(&chunk->box);
    const bool finite = isfinite(value);
    for (size_t i = 0; i < bricks; i++)
        walk->bricks[i] = (iso_brick_range){finite ? value : INFINITY, finite ? value : -INFINITY, finite};
    enter_bricks(walk, number, chunk);
    return false;
}

/* Tells the source which bricks matter: those that were crossed in an earlier visit, or that lie in crossed
 * blocks. */
static void set_needed(iso_chunk_walk *walk, size_t number, iso_grid_chunk *chunk) {
    const iso_brick_box *box = &chunk->box;
    iso_brick_range range;
    if (walk->states[number] & CHUNK_READ) {
        chunk->needed = walk->crossed + number * walk->crossed_words;
        return;
    }
    if (!walk->needed || !iso_block_ranges_of(walk->ranges, box, &range)) return;
    memset(walk->needed, 0, walk->crossed_words * sizeof *walk->needed);
    size_t i = 0;
    for (int z = box->first[2]; z < box->end[2]; z++)
        for (int y = box->first[1]; y < box->end[1]; y++)
            for (int x = box->first[0]; x < box->end[0]; x++, i++) {
                const iso_brick_box brick = {{x, y, z}, {x + 1, y + 1, z + 1}};
                iso_block_ranges_of(walk->ranges, &brick, &range);
                walk->needed[i / 64] |= (uint64_t)crosses(walk, &range) << i % 64;
            }
    chunk->needed = walk->needed;
}

static bool any_crosses(const iso_chunk_walk *walk, const iso_grid_chunk *chunk) {
    const size_t bricks = iso_brick_box_count(&chunk->box);
    for (size_t i = 0; i < bricks; i++)
        if (crosses(walk, &walk->bricks[i])) return true;
    return false;
}

/* Sets walk->bricks to the ranges of a chunk's bricks. Later visits need to know only which bricks the
 * surface crosses, which the first one has noted. */
static void read_ranges(iso_chunk_walk *walk, size_t number, const iso_grid_chunk *chunk,
                        const iso_rgrid *grid) {
    const size_t bricks = iso_brick_box_count(&chunk->box);
    uint64_t *crossed = walk->crossed ? walk->crossed + number * walk->crossed_words : NULL;
    if (walk->states[number] & CHUNK_READ) {
        for (size_t i = 0; i < bricks; i++) {
            const bool is_crossed = crossed[i / 64] >> i % 64 & 1;
            walk->bricks[i].lo = is_crossed ? -INFINITY : INFINITY;
            walk->bricks[i].hi = -walk->bricks[i].lo;
        }
        return;
    }
    iso_grid_chunk_ranges(grid, chunk, walk->opts.pool, walk->bricks);
    for (size_t i = 0; i < bricks && chunk->needed; i++) /* the others' voxels were not read */
        if (!(chunk->needed[i / 64] >> i % 64 & 1))
            walk->bricks[i] = (iso_brick_range){INFINITY, -INFINITY, true};
    enter_bricks(walk, number, chunk);
    if (!crossed) return;
    for (size_t i = 0; i < bricks; i++)
        crossed[i / 64] |= (uint64_t)crosses(walk, &walk->bricks[i]) << i % 64;
    walk->states[number] |= CHUNK_READ;
}

/* Bytes of the voxels that a chunk needs. */
static uint64_t voxel_bytes(const iso_chunk_walk *walk, const iso_grid_chunk *chunk) {
    int first[3], end[3];
    uint64_t bytes = iso_type_size(walk->opts.source->type);
    iso_grid_chunk_voxels(chunk, first, end);
    for (int axis = 0; axis < 3; axis++) bytes *= (uint64_t)(end[axis] - first[axis]);
    return bytes;
}

/* What is done with each chunk; without a function only ranges are read. */
typedef struct chunk_action {
    iso_chunk_visitor *visit;
    void *context;
    iso_chunk_chooser *wants; /* NULL: chunks that the surface crosses are visited */
} chunk_action;

static iso_status visit_grid(iso_chunk_walk *walk, size_t number, iso_grid_chunk *chunk, iso_rgrid *grid,
                             const chunk_action *action, iso_error *error) {
    read_ranges(walk, number, chunk, grid);
    if (!action->visit || !any_crosses(walk, chunk)) return ISO_OK;
    if (!(walk->states[number] & CHUNK_COUNTED)) {
        walk->states[number] |= CHUNK_COUNTED;
        walk->totals.crossed++;
        walk->totals.bytes_crossed += voxel_bytes(walk, chunk);
    }
    chunk->ranges = walk->bricks;
    const iso_chunk_visit visit = {number, chunk, grid};
    return action->visit(action->context, &visit, error);
}

static iso_status read_and_visit(iso_chunk_walk *walk, size_t number, const chunk_action *action,
                                 iso_error *error) {
    const iso_chunk_source *source = walk->opts.source;
    iso_grid_chunk chunk = make_chunk(walk, number);
    iso_rgrid *grid = NULL;
    set_needed(walk, number, &chunk);
    ISO_TRY(source->read(source->context, &chunk, walk->opts.pool, &grid, error));
    walk->totals.bytes_read += voxel_bytes(walk, &chunk);
    const iso_status status = visit_grid(walk, number, &chunk, grid, action, error);
    iso_rgrid_destroy(grid);
    return status;
}

/* The same of a chunk that is wanted: with all its voxels. */
static iso_status read_wanted(iso_chunk_walk *walk, size_t number, const chunk_action *action,
                              iso_error *error) {
    const iso_chunk_source *source = walk->opts.source;
    const iso_grid_chunk chunk = make_chunk(walk, number);
    iso_rgrid *grid = NULL;
    ISO_TRY(source->read(source->context, &chunk, walk->opts.pool, &grid, error));
    walk->totals.bytes_read += voxel_bytes(walk, &chunk);
    const iso_chunk_visit visit = {number, &chunk, grid};
    const iso_status status = action->visit(action->context, &visit, error);
    iso_rgrid_destroy(grid);
    return status;
}

static bool is_wanted(const iso_chunk_walk *walk, const iso_grid_chunk *chunk, const chunk_action *action) {
    iso_brick_range range;
    const bool known = iso_block_ranges_of(walk->ranges, &chunk->box, &range);
    return action->wants(action->context, chunk, known ? &range : NULL);
}

static iso_status visit_chunk(iso_chunk_walk *walk, size_t number, const chunk_action *action,
                              iso_error *error) {
    const iso_chunk_source *source = walk->opts.source;
    const iso_grid_chunk chunk = make_chunk(walk, number);
    if (!(action->wants ? is_wanted(walk, &chunk, action) : must_read(walk, number, &chunk))) return ISO_OK;
    if (!action->visit && walk->states[number] & CHUNK_ENTERED) return ISO_OK; /* its ranges are known */
    iso_status status;
    do status = (action->wants ? read_wanted : read_and_visit)(walk, number, action, error);
    while (status == ISO_ERR_NOMEM && source->give_back && source->give_back(source->context));
    return status;
}

static iso_status report(const iso_chunk_walk *walk, size_t done, iso_error *error) {
    const iso_chunk_walk_opts *opts = &walk->opts;
    if (!opts->progress || !opts->progress(opts->progress_context, (double)done / (double)walk->total))
        return ISO_OK;
    return iso_fail(error, ISO_ERR_IO, "cancelled");
}

/* Whether a chunk belongs to a piece of the division, of which there are some; or, while there are none, to
 * those that are read in turns. Below 0: all do. */
typedef struct chunk_choice {
    int piece, turns;
} chunk_choice;

static bool is_chosen(const iso_chunk_walk *walk, size_t number, chunk_choice choice) {
    if (choice.piece < 0) return true;
    return choice.turns ? number % (size_t)choice.turns == (size_t)choice.piece
                        : (int)walk->piece[number] == choice.piece;
}

static iso_status visit_chosen(iso_chunk_walk *walk, chunk_choice choice, const chunk_action *action,
                               iso_error *error) {
    const iso_chunk_source *source = walk->opts.source;
    for (size_t number = 0; number < walk->total; number++) {
        if (is_chosen(walk, number, choice)) ISO_TRY(visit_chunk(walk, number, action, error));
        if ((number + 1) % (size_t)walk->cuts.counts[0]) continue;
        if (source->rest) source->rest(source->context);
        ISO_TRY(report(walk, number + 1, error));
    }
    return ISO_OK;
}

/* ---- the division among processes */

/* Spreads the lowest 21 bits, to every third bit. */
static uint64_t spread_bits(uint64_t value) {
    value = (value | value << 32) & 0x1f00000000ffff;
    value = (value | value << 16) & 0x1f0000ff0000ff;
    value = (value | value << 8) & 0x100f00f00f00f00f;
    value = (value | value << 4) & 0x10c30c30c30c30c3;
    return (value | value << 2) & 0x1249249249249249;
}

typedef struct curve_point {
    uint64_t place; /* along the Morton curve */
    size_t number;  /* of the chunk */
} curve_point;

static int compare_places(const void *left, const void *right) {
    const curve_point *a = left, *b = right;
    return (a->place > b->place) - (a->place < b->place);
}

static uint64_t weight_of(const iso_chunk_walk *walk, size_t number) {
    const iso_grid_chunk chunk = make_chunk(walk, number);
    return iso_block_ranges_crossed(walk->ranges, &chunk.box, walk->isovalue_ceil);
}

/* Cuts the curve into pieces of about equal weight. */
static void cut_curve(iso_chunk_walk *walk, const curve_point *curve, int pieces) {
    uint64_t whole = 0, before = 0;
    for (size_t i = 0; i < walk->total; i++) whole += weight_of(walk, i);
    for (size_t i = 0; i < walk->total; i++) {
        const uint64_t weight = weight_of(walk, curve[i].number);
        /* the piece of the middle of the chunk's weight; in doubles, as whole * pieces may overflow */
        const double middle = (double)before + 0.5 * (double)weight;
        const double piece = whole ? floor(middle * pieces / (double)whole) : 0;
        walk->piece[curve[i].number] = piece < pieces ? (uint32_t)piece : (uint32_t)pieces - 1;
        before += weight;
    }
}

static iso_status divide(iso_chunk_walk *walk, int pieces, iso_error *error) {
    static const chunk_action nothing = {0};
    if (walk->piece && walk->pieces == pieces) return ISO_OK;
    if (walk->ranges->unknown) ISO_TRY(visit_chosen(walk, (chunk_choice){-1, 0}, &nothing, error));
    if (!walk->piece) walk->piece = iso_alloc(walk->total * sizeof *walk->piece);
    curve_point *curve = iso_alloc(walk->total * sizeof *curve);
    if (!walk->piece || !curve) {
        iso_free(curve);
        return iso_fail(error, ISO_ERR_NOMEM, "out of memory for a table of %zu chunks", walk->total);
    }
    for (size_t i = 0; i < walk->total; i++) {
        const size_t columns = (size_t)walk->cuts.counts[0], rows = (size_t)walk->cuts.counts[1];
        const uint64_t place = spread_bits(i % columns) | spread_bits(i / columns % rows) << 1 |
                               spread_bits(i / columns / rows) << 2;
        curve[i] = (curve_point){place, i};
    }
    qsort(curve, walk->total, sizeof *curve, compare_places);
    walk->pieces = pieces;
    cut_curve(walk, curve, pieces);
    iso_free(curve);
    return ISO_OK;
}

/* ---- the interface */

static iso_status allocate(iso_chunk_walk *walk, iso_error *error) {
    const int *most = walk->cuts.most;
    const size_t bricks = (size_t)most[0] * (size_t)most[1] * (size_t)most[2];
    if (!walk->opts.ranges) {
        int before[3];
        iso_chunk_source_blocks(walk->opts.source, before);
        ISO_TRY(iso_block_ranges_create(walk->opts.source->dims, before, &walk->own_ranges, error));
        walk->ranges = &walk->own_ranges;
    }
    walk->states = iso_alloc_zero(walk->total, 1);
    walk->crossed_words = (bricks + 63) / 64;
    walk->crossed = iso_alloc_zero(walk->total * walk->crossed_words, sizeof *walk->crossed);
    walk->needed = iso_alloc_zero(walk->crossed_words, sizeof *walk->needed);
    walk->bricks = iso_alloc(bricks * sizeof *walk->bricks);
    if (walk->states && walk->bricks) return ISO_OK;
    return iso_fail(error, ISO_ERR_NOMEM, "out of memory for a table of %zu chunks", walk->total);
}

/* The isovalue as it is compared with stored values: that of a grid with the source's scale and offset. */
static float isovalue_ceil_of(const iso_chunk_walk_opts *opts) {
    iso_rgrid grid = {.type = opts->source->type,
                      .scale = opts->source->scale,
                      .offset = opts->source->offset,
                      .level_set = opts->source->level_set};
    const iso_grid handle = {.rgrid = &grid};
    return iso_threshold_of(&handle, opts->isovalue).isovalue_ceil;
}

iso_status iso_chunk_walk_create(const iso_chunk_walk_opts *opts, iso_chunk_walk **out, iso_error *error) {
    if (!isfinite(opts->isovalue)) return iso_fail(error, ISO_ERR_USAGE, "the isovalue is not finite");
    iso_chunk_walk *walk = iso_alloc_zero(1, sizeof *walk);
    if (!walk) return iso_fail(error, ISO_ERR_NOMEM, "out of memory for a table of chunks");
    walk->opts = *opts;
    walk->ranges = opts->ranges;
    int side = opts->side > 0 ? opts->side : USUAL_SIDE, largest = 1;
    for (int axis = 0; axis < 3; axis++)
        if (opts->source->dims[axis] > largest) largest = opts->source->dims[axis];
    if (side > largest) side = largest;
    iso_chunk_cuts_make(opts->source, side, &walk->cuts);
    walk->total = iso_chunk_cuts_count(&walk->cuts);
    walk->isovalue_ceil = isovalue_ceil_of(opts);
    const iso_status status = allocate(walk, error);
    if (status != ISO_OK) {
        iso_chunk_walk_destroy(walk);
        return status;
    }
    *out = walk;
    return ISO_OK;
}

void iso_chunk_walk_destroy(iso_chunk_walk *walk) {
    if (!walk) return;
    iso_block_ranges_free(&walk->own_ranges);
    iso_free(walk->states);
    iso_free(walk->crossed);
    iso_free(walk->needed);
    iso_free(walk->piece);
    iso_free(walk->bricks);
    iso_free(walk);
}

static iso_status visit_share(iso_chunk_walk *walk, iso_chunk_share share, const chunk_action *action,
                              iso_error *error) {
    if (share.parts > 1) ISO_TRY(divide(walk, share.parts, error));
    return visit_chosen(walk, (chunk_choice){share.parts > 1 ? share.part - 1 : -1, 0}, action, error);
}

iso_status iso_chunk_walk_visit(iso_chunk_walk *walk, iso_chunk_share share, iso_chunk_visitor *visit,
                                void *context, iso_error *error) {
    const chunk_action action = {visit, context, NULL};
    return visit_share(walk, share, &action, error);
}

iso_status iso_chunk_walk_visit_wanted(iso_chunk_walk *walk, iso_chunk_share share, iso_chunk_chooser *wants,
                                       iso_chunk_visitor *visit, void *context, iso_error *error) {
    const chunk_action action = {visit, context, wants};
    return visit_share(walk, share, &action, error);
}

iso_status iso_chunk_walk_read_ranges(iso_chunk_walk *walk, iso_chunk_share share, iso_error *error) {
    const chunk_action nothing = {0};
    if (!walk->ranges->unknown) return ISO_OK;
    return visit_chosen(walk, (chunk_choice){share.part - 1, share.parts}, &nothing, error);
}

const iso_chunk_cuts *iso_chunk_walk_cuts(const iso_chunk_walk *walk) {
    return &walk->cuts;
}

const iso_chunk_walk_opts *iso_chunk_walk_opts_of(const iso_chunk_walk *walk) {
    return &walk->opts;
}

iso_chunk_totals iso_chunk_walk_stats(const iso_chunk_walk *walk) {
    iso_chunk_totals totals = walk->totals;
    totals.chunks = walk->total;
    if (walk->opts.source->decoded)
        totals.bytes_decoded = walk->opts.source->decoded(walk->opts.source->context);
    for (size_t i = 0; i < walk->ranges->count; i++)
        totals.nonfinite_blocks += (walk->ranges->states[i] & ISO_BLOCK_NONFINITE) != 0;
    return totals;
}
