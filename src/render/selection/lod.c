/* lod: makes each level of detail of the level below it. The spans of a level are sorted by Morton codes, so
 * that the children of a span are next to each other. A span is made in two passes: the first counts its
 * points, so that all spans can be written in parallel. */
#include "render/selection/lod.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/point_bounds.h"

enum {
    BRICK_BITS = 20,    /* bricks are numbered -2^20 .. 2^20 - 1 along an axis */
    FEWEST_POINTS = 64, /* a level with fewer points is the last one */
    SIDES = 2, /* a voxel has a point for those that face the side of the first one, and one for the others */
    NODES = ISO_BRICK_VOXELS * SIDES /* most points of a span */
};

/* ---- the order of spans ---- */

/* A span's number and the Morton code of its brick. */
typedef struct place {
    uint64_t code;
    uint32_t span;
} place;

/* Moves bit i of 21 to bit 3 i. */
static uint64_t spread_bits(uint64_t bits) {
    bits = (bits | bits << 32) & 0x001f00000000ffffu;
    bits = (bits | bits << 16) & 0x001f0000ff0000ffu;
    bits = (bits | bits << 8) & 0x100f00f00f00f00fu;
    bits = (bits | bits << 4) & 0x10c30c30c30c30c3u;
    return (bits | bits << 2) & 0x1249249249249249u;
}

static uint64_t code_of(const int32_t brick[3]) {
    uint64_t code = 0;
    for (int axis = 0; axis < 3; axis++)
        code |= spread_bits((uint64_t)(brick[axis] + (1 << BRICK_BITS))) << axis;
    return code;
}

static int compare_places(const void *a, const void *b) {
    const place *one = a, *other = b;
    if (one->code != other->code) return one->code < other->code ? -1 : 1;
    return one->span < other->span ? -1 : one->span > other->span;
}

/* Sets lod->order to the spans of level 0 that have points, by Morton code; *count to how many they are. */
static iso_status sort_spans(iso_lod *lod, size_t *count, iso_error *error) {
    const iso_point_view *points = &lod->points;
    place *places = iso_alloc(points->span_count * sizeof *places);
    lod->order = iso_alloc(points->span_count * sizeof *lod->order);
    iso_status status = ISO_OK;
    if (!places || !lod->order) status = iso_fail(error, ISO_ERR_NOMEM, "out of memory for levels of detail");
    *count = 0;
    for (size_t s = 0; s < points->span_count && status == ISO_OK; s++) {
        const iso_point_span *span = &points->spans[s];
        for (int axis = 0; axis < 3; axis++)
            if (span->brick[axis] < -(1 << BRICK_BITS) || span->brick[axis] >= 1 << BRICK_BITS)
                status = iso_fail(error, ISO_ERR_LIMIT,
                                  "levels of detail reach 2^20 bricks from the origin; there are points in "
                                  "brick %d, %d, %d",
                                  span->brick[0], span->brick[1], span->brick[2]);
        if (span->count) places[(*count)++] = (place){code_of(span->brick), (uint32_t)s};
    }
    if (status == ISO_OK) {
        qsort(places, *count, sizeof *places, compare_places);
        for (size_t i = 0; i < *count; i++) lod->order[i] = places[i].span;
    }
    iso_free(places);
    return status;
}

/* ---- the points of a span ---- */

/* The sum of points that become one. */
typedef struct node {
    float position[3], normal[3], color[3];
    float color_square; /* the sum of the squares of all values of colours */
    float first[3];     /* the normal of the first point, with which others are compared */
    float radius;       /* mm */
    uint32_t count;
} node;

/* The nodes of a span while it is made. */
typedef struct scratch {
    uint16_t node_of[NODES]; /* 1 + number of the node of a voxel and a side; 0: none yet */
    node nodes[NODES];
    uint32_t count;
} scratch;

typedef struct building {
    iso_lod *lod;
    int number; /* of the level */
    iso_lod_level *to;
    iso_point_view from;         /* the level below */
    const uint32_t *from_span;   /* for each span: that of the update before from which it is kept */
    const iso_lod_level *before; /* the level in the update before */
    scratch *scratch;            /* one per worker */
} building;

static const uint32_t NOT_KEPT = UINT32_MAX;

/* Reads a point of the level below. False: it has no position or no normal. The position is converted to
 * voxels of the new level, relative to the new span's brick. */
static bool read_point(const building *b, const iso_point_span *span, uint32_t i, iso_surfel *point) {
    *point = iso_point_view_get(&b->from, span->first + i);
    float *p = point->position, *n = point->normal, square = 0;
    for (int axis = 0; axis < 3; axis++) {
        p[axis] = 0.5f * (p[axis] + (float)((span->brick[axis] & 1) * ISO_BRICK));
        square += n[axis] * n[axis];
    }
    if (!(square > 1e-20f && square < 1e20f && isfinite(p[0]) && isfinite(p[1]) && isfinite(p[2])))
        return false;
    for (int axis = 0; axis < 3; axis++) n[axis] /= sqrtf(square);
    return true;
}

/* The entry of scratch.node_of for a point: by its voxel and the side that it faces. */
static uint16_t *find_node(scratch *s, const iso_surfel *point) {
    int voxel = 0;
    for (int axis = 2; axis >= 0; axis--) {
        const float at = point->position[axis];
        voxel = voxel * ISO_BRICK + (at < 0 ? 0 : at >= ISO_BRICK ? ISO_BRICK - 1 : (int)at);
    }
    uint16_t *entry = &s->node_of[voxel * SIDES];
    if (!*entry) return entry;
    const float *first = s->nodes[*entry - 1].first, *n = point->normal;
    return first[0] * n[0] + first[1] * n[1] + first[2] * n[2] >= 0 ? entry : entry + 1;
}

static void add_point(const building *b, scratch *s, const iso_surfel *point, size_t index) {
    uint16_t *entry = find_node(s, point);
    if (!*entry) {
        *entry = (uint16_t)(s->count + 1);
        s->nodes[s->count++] = (node){0};
        memcpy(s->nodes[s->count - 1].first, point->normal, sizeof point->normal);
    }
    node *to = &s->nodes[*entry - 1];
    for (int k = 0; k < 3; k++) {
        to->position[k] += point->position[k];
        to->normal[k] += point->normal[k];
        if (!b->from.colors) continue;
        const float value = (float)b->from.colors[index][k];
        to->color[k] += value;
        to->color_square += value * value;
    }
    to->count++;
}

/* Calls add_point for all points of the children of span `span`. */
static void add_children(const building *b, scratch *s, size_t span) {
    memset(s->node_of, 0, sizeof s->node_of);
    s->count = 0;
    for (uint32_t c = b->to->first_child[span]; c < b->to->first_child[span + 1]; c++) {
        const iso_point_span *child = &b->from.spans[iso_lod_child(b->lod, b->number, c)];
        iso_surfel point;
        for (uint32_t i = 0; i < child->count; i++)
            if (read_point(b, child, i, &point)) add_point(b, s, &point, child->first + i);
    }
}

/* Divides the sums of the nodes. Returns the error of the span in voxels (ISO_LOD_FLAT_ERROR). */
static float divide_sums(scratch *s) {
    float bent = 0, mixed = 0, points = 0;
    for (uint32_t k = 0; k < s->count; k++) {
        node *n = &s->nodes[k];
        const float each = 1 / (float)n->count,
                    length = sqrtf(n->normal[0] * n->normal[0] + n->normal[1] * n->normal[1] +
                                   n->normal[2] * n->normal[2]);
        /* for each point of the node: the squared sine between its normal and the mean, and the squared
         * difference between its colour and the mean */
        bent += (float)n->count - length * length * each;
        mixed += n->color_square;
        points += (float)n->count;
        for (int axis = 0; axis < 3; axis++) {
            mixed -= n->color[axis] * n->color[axis] * each;
            n->position[axis] *= each;
            n->color[axis] *= each;
            n->normal[axis] = length > 1e-6f ? n->normal[axis] / length : n->first[axis];
        }
    }
    if (!(points > 0)) return 1;
    const float sine = sqrtf(fmaxf(bent, 0) / points), color = sqrtf(fmaxf(mixed, 0) / (3 * points)) / 255;
    return fminf(ISO_LOD_FLAT_ERROR + ISO_LOD_BENT_ERROR * (sine + color), 1);
}

/* Sets the radii of nodes so that their discs contain those of the points they stand for. */
static void enclose_discs(const building *b, scratch *s, size_t span) {
    const double *spacing = b->lod->points.transform.spacing, scale = ldexp(1, b->number);
    for (uint32_t c = b->to->first_child[span]; c < b->to->first_child[span + 1]; c++) {
        const iso_point_span *child = &b->from.spans[iso_lod_child(b->lod, b->number, c)];
        iso_surfel point;
        for (uint32_t i = 0; i < child->count; i++) {
            if (!read_point(b, child, i, &point)) continue;
            const float radius = b->from.radii ? b->from.radii[child->first + i] : (float)b->from.radius;
            node *n = &s->nodes[*find_node(s, &point) - 1];
            float square = 0;
            for (int axis = 0; axis < 3; axis++) {
                const float off = (point.position[axis] - n->position[axis]) * (float)(spacing[axis] * scale);
                square += off * off;
            }
            const float reach = sqrtf(square) + fmaxf(radius, 0);
            n->radius = fmaxf(n->radius, reach);
        }
    }
}

static void store_color(const node *n, uint8_t color[3]) {
    for (int c = 0; c < 3; c++) color[c] = (uint8_t)(n->color[c] + 0.5f);
}

static void store_nodes(const building *b, const scratch *s, const iso_point_span *span) {
    for (uint32_t k = 0; k < s->count; k++) {
        const node *n = &s->nodes[k];
        const size_t at = span->first + k;
        iso_surfel surfel;
        memcpy(surfel.position, n->position, sizeof surfel.position);
        memcpy(surfel.normal, n->normal, sizeof surfel.normal);
        if (b->to->packed)
            b->to->packed[at] = iso_point_pack(&surfel);
        else
            b->to->surfels[at] = surfel;
        if (b->to->radii) b->to->radii[at] = n->radius;
        if (b->to->colors) store_color(n, b->to->colors[at]);
    }
}

/* Sets the colours below a span: of each of its children's points the mean that takes its place. */
static void store_colors_below(const building *b, scratch *s, size_t span) {
    uint8_t(*to)[3] = b->to->colors_below + b->to->first_color_below[span];
    for (uint32_t c = b->to->first_child[span]; c < b->to->first_child[span + 1]; c++) {
        const iso_point_span *child = &b->from.spans[iso_lod_child(b->lod, b->number, c)];
        iso_surfel point;
        for (uint32_t i = 0; i < child->count; i++, to++) {
            if (read_point(b, child, i, &point))
                store_color(&s->nodes[*find_node(s, &point) - 1], *to);
            else
                memcpy(*to, b->from.colors[child->first + i], sizeof *to);
        }
    }
}

/* ---- the spans of a level ---- */

/* Task: counts the points of a span. */
static void count_span(void *context, size_t span, int worker) {
    const building *b = context;
    scratch *s = &b->scratch[worker];
    if (b->from_span[span] != NOT_KEPT) {
        b->to->spans[span].count = b->before->spans[b->from_span[span]].count;
        return;
    }
    add_children(b, s, span);
    b->to->spans[span].count = s->count;
}

static void copy_span(const building *b, size_t span) {
    const iso_point_span *to = &b->to->spans[span], *from = &b->before->spans[b->from_span[span]];
    const size_t n = to->count;
    if (b->to->packed)
        memcpy(b->to->packed + to->first, b->before->packed + from->first, n * sizeof *b->to->packed);
    else
        memcpy(b->to->surfels + to->first, b->before->surfels + from->first, n * sizeof *b->to->surfels);
    if (b->to->radii)
        memcpy(b->to->radii + to->first, b->before->radii + from->first, n * sizeof *b->to->radii);
    if (b->to->colors)
        memcpy(b->to->colors + to->first, b->before->colors + from->first, n * sizeof *b->to->colors);
    if (b->to->colors_below) {
        const size_t *first = b->to->first_color_below + span;
        memcpy(b->to->colors_below + first[0],
               b->before->colors_below + b->before->first_color_below[b->from_span[span]],
               (first[1] - first[0]) * sizeof *b->to->colors_below);
    }
    b->to->bounds[span] = b->before->bounds[b->from_span[span]];
    b->to->errors[span] = b->before->errors[b->from_span[span]];
}

/* Task: makes a span, or copies it from the update before. */
static void make_span(void *context, size_t span, int worker) {
    const building *b = context;
    scratch *s = &b->scratch[worker];
    const iso_point_span *to = &b->to->spans[span];
    if (b->from_span[span] != NOT_KEPT) {
        copy_span(b, span);
        return;
    }
    add_children(b, s, span);
    b->to->errors[span] = divide_sums(s);
    if (b->to->radii) enclose_discs(b, s, span);
    store_nodes(b, s, to);
    if (b->to->colors_below) store_colors_below(b, s, span);
    const iso_point_view points = {.packed = b->to->packed, .surfels = b->to->surfels};
    iso_point_bounds_find(&points, to->first, to->count, &b->to->bounds[span]);
}

/* Sets the bricks, versions and children of the new level's spans. `from_count`: children to choose from. */
static void list_spans(building *b, size_t from_count) {
    iso_lod_level *to = b->to;
    for (size_t i = 0; i < from_count; i++) {
        const size_t child = iso_lod_child(b->lod, b->number, (uint32_t)i);
        const int32_t *brick = b->from.spans[child].brick;
        const int32_t parent[3] = {brick[0] >> 1, brick[1] >> 1, brick[2] >> 1};
        iso_point_span *last = to->spans + to->span_count - 1;
        if (!to->span_count || memcmp(last->brick, parent, sizeof parent) != 0) {
            to->first_child[to->span_count] = (uint32_t)i;
            to->versions[to->span_count] = 0xcbf29ce484222325u;
            last = &to->spans[to->span_count++];
            *last = (iso_point_span){.count = 0};
            memcpy(last->brick, parent, sizeof parent);
        }
        /* FNV-1a over the children's bricks and versions */
        const uint64_t said[2] = {code_of(brick), b->from.versions ? b->from.versions[child] : 0};
        uint64_t *version = &to->versions[to->span_count - 1];
        for (int k = 0; k < 2; k++) *version = (*version ^ said[k]) * 0x100000001b3u;
    }
    to->first_child[to->span_count] = (uint32_t)from_count;
}

/* Whether the points of the update before have what those of this one have: colours, for example, may have
 * been given to points since, or taken from them. */
static bool has_same_arrays(const building *b) {
    const iso_lod_level *before = b->before;
    const bool radii = b->from.radii || b->from.overlapping;
    return !before->packed == !b->from.packed && !before->radii == !radii &&
           !before->colors == !b->from.colors;
}

/* Finds the spans of the update before that can be kept. Both lists are sorted by Morton code. */
static void find_kept(building *b, uint32_t *from_span) {
    const iso_lod_level *to = b->to, *before = b->before;
    const bool can_keep = b->from.versions && has_same_arrays(b);
    size_t old = 0;
    for (size_t s = 0; s < to->span_count; s++) {
        from_span[s] = NOT_KEPT;
        if (!can_keep) continue;
        const uint64_t code = code_of(to->spans[s].brick);
        while (old < before->span_count && code_of(before->spans[old].brick) < code) old++;
        if (old < before->span_count && code_of(before->spans[old].brick) == code &&
            before->versions[old] == to->versions[s])
            from_span[s] = (uint32_t)old;
        b->lod->kept += from_span[s] != NOT_KEPT;
    }
    b->from_span = from_span;
}

/* Counts the points below each span, and makes room for their colours. */
static bool allocate_colors_below(const building *b) {
    iso_lod_level *to = b->to;
    size_t count = 0;
    to->first_color_below = iso_alloc((to->span_count + 1) * sizeof *to->first_color_below);
    if (!to->first_color_below) return false;
    for (size_t s = 0; s < to->span_count; s++) {
        to->first_color_below[s] = count;
        for (uint32_t c = to->first_child[s]; c < to->first_child[s + 1]; c++)
            count += b->from.spans[iso_lod_child(b->lod, b->number, c)].count;
    }
    to->first_color_below[to->span_count] = count;
    to->colors_below = iso_alloc(count * sizeof *to->colors_below);
    return to->colors_below != NULL;
}

/* Allocates the points of a level whose spans are counted. */
static bool allocate_points(const building *b) {
    iso_lod_level *to = b->to;
    const iso_point_view *from = &b->from;
    for (size_t s = 0; s < to->span_count; s++) {
        to->spans[s].first = to->count;
        to->count += to->spans[s].count;
    }
    const size_t n = to->count;
    if (from->packed)
        to->packed = iso_alloc(n * sizeof *to->packed);
    else
        to->surfels = iso_alloc(n * sizeof *to->surfels);
    const bool radii = from->radii || from->overlapping;
    if (radii) to->radii = iso_alloc(n * sizeof *to->radii);
    if (from->colors) to->colors = iso_alloc(n * sizeof *to->colors);
    if (from->colors && !allocate_colors_below(b)) return false;
    return (to->packed || to->surfels) && (to->radii || !radii) && (to->colors || !from->colors);
}

static bool allocate_spans(iso_lod_level *to, size_t most) {
    to->spans = iso_alloc(most * sizeof *to->spans);
    to->bounds = iso_alloc(most * sizeof *to->bounds);
    to->errors = iso_alloc(most * sizeof *to->errors);
    to->versions = iso_alloc(most * sizeof *to->versions);
    to->first_child = iso_alloc((most + 1) * sizeof *to->first_child);
    return to->spans && to->bounds && to->errors && to->versions && to->first_child;
}

/* Makes a level of `from_count` spans of the level below. */
static iso_status make_level(building *b, size_t from_count, iso_pool *pool, iso_error *error) {
    iso_lod_level *to = b->to;
    if (!allocate_spans(to, from_count)) return iso_fail(error, ISO_ERR_NOMEM, "out of memory");
    list_spans(b, from_count);
    uint32_t *from_span = iso_alloc(to->span_count * sizeof *from_span);
    if (!from_span) return iso_fail(error, ISO_ERR_NOMEM, "out of memory for levels of detail");
    find_kept(b, from_span);
    iso_parallel_for(pool, to->span_count, count_span, b);
    iso_status status = ISO_OK;
    if (allocate_points(b))
        iso_parallel_for(pool, to->span_count, make_span, b);
    else
        status = iso_fail(error, ISO_ERR_NOMEM, "out of memory for levels of detail");
    iso_free(from_span);
    b->lod->made += to->span_count;
    return status;
}

/* ---- the interface ---- */

static void free_level(iso_lod_level *level) {
    iso_free(level->packed);
    iso_free(level->surfels);
    iso_free(level->radii);
    iso_free(level->colors);
    iso_free(level->colors_below);
    iso_free(level->first_color_below);
    iso_free(level->spans);
    iso_free(level->bounds);
    iso_free(level->errors);
    iso_free(level->versions);
    iso_free(level->first_child);
    *level = (iso_lod_level){0};
}

/* Makes all levels; those of the update before are in `before`. */
static iso_status make_levels(iso_lod *lod, const iso_lod *before, iso_pool *pool, iso_error *error) {
    size_t spans;
    ISO_TRY(sort_spans(lod, &spans, error));
    building b = {.lod = lod, .scratch = iso_alloc((size_t)iso_pool_threads(pool) * sizeof(scratch))};
    if (!b.scratch) return iso_fail(error, ISO_ERR_NOMEM, "out of memory for levels of detail");
    iso_status status = ISO_OK;
    size_t points = iso_point_view_count(&lod->points);
    while (status == ISO_OK && points >= FEWEST_POINTS && lod->count < ISO_LOD_LEVELS) {
        b.number = lod->count;
        b.to = &lod->level[b.number];
        b.before = &before->level[b.number];
        b.from = iso_lod_view(lod, b.number - 1);
        status = make_level(&b, spans, pool, error);
        lod->count++;
        spans = b.to->span_count;
        if (b.to->count == points) break; /* nothing is left to be merged */
        points = b.to->count;
    }
    iso_free(b.scratch);
    lod->made -= lod->kept;
    return status;
}

iso_status iso_lod_update(iso_lod *lod, const iso_point_view *points, iso_pool *pool, iso_error *error) {
    iso_lod made = {.points = *points, .count = 1};
    const iso_status status = make_levels(&made, lod, pool, error);
    iso_lod_free(lod);
    if (status == ISO_OK)
        *lod = made;
    else
        iso_lod_free(&made);
    return status;
}

void iso_lod_free(iso_lod *lod) {
    for (int k = 0; k < ISO_LOD_LEVELS; k++) free_level(&lod->level[k]);
    iso_free(lod->order);
    *lod = (iso_lod){0};
}

iso_point_view iso_lod_view(const iso_lod *lod, int number) {
    if (number == 0) return lod->points;
    const iso_lod_level *level = &lod->level[number];
    iso_point_view view = {.packed = level->packed,
                           .surfels = level->surfels,
                           .radii = level->radii,
                           .colors = (const uint8_t(*)[3])level->colors,
                           .spans = level->spans,
                           .span_count = level->span_count,
                           .transform = lod->points.transform,
                           .radii_scale = lod->points.radii_scale,
                           .radius = ldexp(ISO_LOD_RADIUS * lod->points.radius, number),
                           .versions = lod->points.versions ? level->versions : NULL,
                           .bounds = level->bounds,
                           .closed = lod->points.closed,
                           .overlapping = lod->points.overlapping};
    for (int axis = 0; axis < 3; axis++) view.transform.spacing[axis] *= ldexp(1, number);
    return view;
}

size_t iso_lod_count(const iso_lod *lod) {
    size_t count = 0;
    for (int k = 1; k < lod->count; k++) count += lod->level[k].count;
    return count;
}

size_t iso_lod_bytes(const iso_lod *lod) {
    size_t bytes = lod->count ? lod->points.span_count * sizeof *lod->order : 0;
    for (int k = 1; k < lod->count; k++) {
        const iso_lod_level *l = &lod->level[k];
        const size_t each = (l->packed ? sizeof *l->packed : sizeof *l->surfels) +
                            (l->radii ? sizeof *l->radii : 0) + (l->colors ? sizeof *l->colors : 0),
                     span = sizeof *l->spans + sizeof *l->bounds + sizeof *l->errors + sizeof *l->versions +
                            sizeof *l->first_child;
        bytes += l->count * each + l->span_count * span;
        if (l->colors_below)
            bytes += l->first_color_below[l->span_count] * sizeof *l->colors_below +
                     (l->span_count + 1) * sizeof *l->first_color_below;
    }
    return bytes;
}
