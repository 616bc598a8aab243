/* fragments: merges and sorts the pieces of each sample's ray, and adds their ends to the lists of layers. */
#include "render/shapes/fragments.h"

#include <math.h>
#include <stdlib.h>

#include "base/memory.h"
#include "render/layers/opacity.h"
#include "render/shading/phong_vectors.h"
#include "render/shading/shading.h"
#include "render/shapes/kernel.h"
#include "render/shapes/pieces.h"

/* A ribbon's neighbouring patches share an edge: crossings of one line that are closer than this part of a
 * pixel's width are one. */
static const double SAME_CROSSING = 1e-6;

enum {
    RECT_WIDTH = 128, /* samples of a rectangle of shapes */
    USUAL_PIECES = 2, /* of a sample, before their crossings are used */
    MANY_PIECES = 16, /* of a sample, whose crossings cannot be used yet */
    FETCHED = 8       /* pieces of the next samples */
};

/* A set in the strip. */
typedef struct set {
    const iso_translucent_set *input;
    const iso_shapes *shapes; /* NULL: a mesh */
    iso_target target;
    iso_shapes_frame frame; /* of shapes */
    iso_mesh_samples *mesh; /* without shapes */
    iso_layer_opacity opacity;
    iso_layer_pass pass;
} set;

/* An end of a piece. */
typedef struct crossing {
    const iso_shapes_piece *piece;
    int end;
} crossing;

/* The working memory of a worker. */
typedef struct worker {
    iso_shapes_pieces pieces;
    iso_buffer sorted, ends;     /* iso_shapes_piece *, by sample; uint32_t: where each sample's end there */
    iso_buffer crossings;        /* of a sample */
    iso_shapes_layered *listed;  /* by set: in the band */
    iso_shapes_layered *counted; /* by set: in all bands */
} worker;

struct iso_shapes_lister {
    iso_strip strip;
    iso_target target;
    iso_gbuffer size; /* of the strip */
    set *sets;
    int count;
    worker *workers;
    int worker_count;
};

/* What a worker lists in. */
typedef struct listing {
    const iso_shapes_lister *lister;
    const set *set;
    worker *worker;
    int number;                 /* of the worker */
    iso_layer_lists *lists;     /* NULL: the set is opaque, and drawn into `gbuffer` */
    iso_gbuffer *gbuffer;       /* of the strip */
    iso_rows rows;              /* of the strip */
    iso_shapes_layered *listed; /* of the set */
} listing;

/* ---- order */

static int compare(double a, double b) {
    return (a > b) - (a < b);
}

static int compare_numbers(uint32_t a, uint32_t b) {
    return (a > b) - (a < b);
}

/* By glyph or line, then by depth: a total order but for pieces that are alike. */
static int compare_pieces(const void *first, const void *second) {
    const iso_shapes_piece *a = *(const iso_shapes_piece *const *)first,
                           *b = *(const iso_shapes_piece *const *)second;
    int order = compare_numbers(a->whole, b->whole);
    if (!order) order = compare(a->t[0], b->t[0]);
    if (!order) order = compare_numbers(a->element[0], b->element[0]);
    return order ? order : compare(a->t[1], b->t[1]);
}

/* By depth; of equal depths the earlier glyph or line comes first. */
static int compare_crossings(const void *first, const void *second) {
    const crossing *a = first, *b = second;
    int order = compare(a->piece->t[a->end], b->piece->t[b->end]);
    if (!order) order = compare_numbers(a->piece->whole, b->piece->whole);
    if (!order) order = a->end - b->end;
    return order ? order : compare_numbers(a->piece->element[a->end], b->piece->element[b->end]);
}

enum { FEW = 24 }; /* that are sorted faster without a function call for each comparison */

static void sort_pieces(iso_shapes_piece **pieces, size_t count) {
    if (count > FEW) {
        qsort(pieces, count, sizeof *pieces, compare_pieces);
        return;
    }
    for (size_t i = 1; i < count; i++) {
        iso_shapes_piece *piece = pieces[i];
        size_t at = i;
        for (; at && compare_pieces(&pieces[at - 1], &piece) > 0; at--) pieces[at] = pieces[at - 1];
        pieces[at] = piece;
    }
}

static void sort_crossings(crossing *crossings, size_t count) {
    if (count > FEW) {
        qsort(crossings, count, sizeof *crossings, compare_crossings);
        return;
    }
    for (size_t i = 1; i < count; i++) {
        const crossing c = crossings[i];
        size_t at = i;
        for (; at && compare_crossings(&crossings[at - 1], &c) > 0; at--) crossings[at] = crossings[at - 1];
        crossings[at] = c;
    }
}

/* ---- the pieces of a sample */

/* Makes room in a buffer, whose contents are lost. */
static bool has_room(iso_buffer *buffer, size_t bytes) {
    return buffer->bytes >= bytes || iso_buffer_reserve(buffer, bytes, 0, NULL) == ISO_OK;
}

/* Pieces of the same glyph or line that overlap: where their union begins and ends. */
typedef struct merged {
    iso_shapes_piece *from;
    const iso_shapes_piece *to;
    size_t end;   /* the number of the first sorted piece behind */
    double slack; /* mm: crossings that are closer are one */
} merged;

/* Merges sorted pieces from number `i` on. */
static merged merge(const set *s, iso_shapes_piece **sorted, size_t count, size_t i) {
    merged m = {sorted[i], sorted[i], i + 1, 0};
    if (s->shapes && s->shapes->kind == ISO_SHAPE_RIBBON)
        m.slack = SAME_CROSSING * fabs(m.from->t[0] * (double)s->frame.slope + (double)s->frame.fixed);
    for (; m.end < count; m.end++) {
        const iso_shapes_piece *p = sorted[m.end];
        if (p->whole != m.from->whole || !(p->t[0] <= m.to->t[1] + m.slack)) break;
        const double beyond = p->t[1] - m.to->t[1];
        if ((beyond > 0 || (beyond == 0 && p->element[1] < m.to->element[1])) && p->t[0] < p->t[1]) m.to = p;
    }
    return m;
}

/* Takes the crossings in front of the depth `before` out of the sorted pieces of a sample; returns how many.
 * All pieces that are not listed yet begin at that depth or behind, so that they change none of these
 * crossings. Pieces that they cannot be merged with any more are marked. */
static size_t take_crossings(const set *s, iso_shapes_piece **sorted, size_t count, double before,
                             crossing *out) {
    size_t made = 0;
    for (size_t i = 0; i < count;) {
        const merged m = merge(s, sorted, count, i);
        const bool seen = !s->shapes || m.from->t[0] >= s->frame.near;
        if (seen && !m.from->is_entered && m.from->t[0] < before) out[made++] = (crossing){m.from, 0};
        if (m.to->t[1] > m.from->t[0] && m.to->t[1] < before) out[made++] = (crossing){m.to, 1};
        m.from->is_entered |= m.from->t[0] < before;
        for (; i < m.end; i++)
            if (m.to->t[1] + m.slack < before) sorted[i]->sample = ISO_SHAPES_NO_SAMPLE;
    }
    return made;
}

/* Drops the crossings that are cut away of the set. x, y: in the strip. */
static size_t drop_cut(const listing *l, crossing *crossings, size_t count, int x, int y) {
    const iso_clip *clip = l->set->input->clip;
    iso_vec3 origin, direction;
    size_t left = 0;
    if (!clip || !clip->count || !l->set->shapes) return count; /* meshes are cut already */
    iso_view_ray(l->lister->strip.view, x + 0.5, y + 0.5, &origin, &direction);
    for (size_t i = 0; i < count; i++) {
        const double t = crossings[i].piece->t[crossings[i].end];
        if (iso_clip_shows(clip, iso_vec3_add(origin, iso_vec3_scale(direction, t))))
            crossings[left++] = crossings[i];
    }
    return left;
}

/* ---- opaque sets */

/* Shows a crossing in a sample if it is nearer than what is there; returns whether the sample is done. */
static bool show(const listing *l, const crossing *c, int x, int y) {
    const set *s = l->set;
    const iso_shapes_piece *p = c->piece;
    iso_gbuffer *g = l->gbuffer;
    const size_t at = (size_t)y * (size_t)g->width + (size_t)x;
    const float depth = (float)p->t[c->end];
    if (!(depth < g->depth[at])) return true;
    l->listed->samples++;
    g->depth[at] = depth;
    g->surface[at] = s->frame.target->surface;
    for (int axis = 0; axis < 3; axis++) g->normal[axis][at] = p->normal[c->end][axis];
    iso_shapes_write_color(&s->frame, at, p->element[c->end], p->along[c->end]);
    iso_shapes_write_element(&s->frame, at, p->element[c->end]);
    return true;
}

/* ---- fragments */

static iso_fragment make_fragment(const set *s, const crossing *c, const float to_eye[3], float middle) {
    const iso_shapes_piece *p = c->piece;
    iso_rgb color = s->input->color;
    if (s->shapes && s->shapes->colors)
        color = iso_shapes_color_at(s->shapes, p->element[c->end], p->along[c->end]);
    iso_fragment fragment = {.depth = (float)(p->t[c->end] - (double)middle),
                             .opacity = iso_layer_opacity_at(&s->opacity, p->normal[c->end], to_eye),
                             .surface = s->pass.surface,
                             .leaves = c->end == 1};
    iso_shade_sample(p->normal[c->end], to_eye, color, fragment.color);
    return fragment;
}

/* Adds the fragments of a sample that are in front of the depth `before`, given the pieces that begin in
 * front of it; false without memory. x, y: in the strip. *limit is set when nothing of the set can be seen
 * behind them. */
static bool add_sample(const listing *l, iso_shapes_piece **sorted, size_t count, float *limit, int x, int y,
                       double before) {
    worker *w = l->worker;
    if (!has_room(&w->crossings, 2 * count * sizeof(crossing))) return false;
    crossing *crossings = w->crossings.data;
    sort_pieces(sorted, count);
    const size_t made =
        drop_cut(l, crossings, take_crossings(l->set, sorted, count, before, crossings), x, y);
    sort_crossings(crossings, made);
    if (!l->lists) {
        if (made && show(l, &crossings[0], x, y)) *limit = -INFINITY;
        return true;
    }
    const iso_view *view = l->lister->strip.view;
    const float to_eye[3] = {-iso_slope_of_column(view, x), -iso_slope_of_row(view, y), -1};
    const int row = y - l->rows.first;
    bool done = false;
    for (size_t i = 0; i < made && !done && !l->lists->full; i++) {
        const iso_fragment fragment = make_fragment(l->set, &crossings[i], to_eye, l->lists->middle);
        done = iso_layer_add(l->lists, x, row, &fragment, false);
    }
    if (done) *limit = -INFINITY;
    return !l->lists->full;
}

/* Collects the pieces that begin in front of the depth `before` by sample: `ends` gets where each sample's
 * end in `sorted`. */
static void collect(const iso_shapes_pieces *pieces, double before, size_t samples, uint32_t *ends,
                    iso_shapes_piece **sorted) {
    iso_shapes_piece *all = pieces->pieces.data;
    for (size_t i = 0; i <= samples; i++) ends[i] = 0;
    for (size_t i = 0; i < pieces->count; i++) ends[all[i].sample + 1] += all[i].t[0] < before;
    for (size_t i = 0; i < samples; i++) ends[i + 1] += ends[i];
    for (size_t i = 0; i < pieces->count; i++)
        if (all[i].t[0] < before) sorted[ends[all[i].sample]++] = &all[i];
}

/* Adds the fragments of the rectangle in front of the depth `before`; false without memory. */
static bool add_samples(const listing *l, double before) {
    worker *w = l->worker;
    iso_shapes_pieces *pieces = &w->pieces;
    const iso_shapes_rect *r = &pieces->rect;
    const size_t width = (size_t)(r->x1 - r->x0 + 1), samples = width * (size_t)(r->y1 - r->y0 + 1);
    if (!has_room(&w->sorted, pieces->count * sizeof(iso_shapes_piece *)) ||
        !has_room(&w->ends, (samples + 1) * sizeof(uint32_t)))
        return false;
    iso_shapes_piece **sorted = w->sorted.data;
    uint32_t *ends = w->ends.data;
    float *limit = pieces->limit.data;
    collect(pieces, before, samples, ends, sorted);
    uint32_t begin = 0;
    for (size_t i = 0; i < samples; begin = ends[i++]) {
        const int x = r->x0 + (int)(i % width), y = r->y0 + (int)(i / width);
        for (uint32_t k = ends[i]; k < ends[samples] && k < ends[i] + FETCHED; k++)
            __builtin_prefetch(sorted[k]);
        if (begin < ends[i] && !add_sample(l, sorted + begin, ends[i] - begin, &limit[i], x,
                                           y - l->lister->strip.view->above, before))
            return false;
    }
    iso_shapes_pieces_tidy(pieces);
    return true;
}

/* The list of a sample of a rectangle. */
static const iso_layer_list *list_at(const listing *l, int x, int y) {
    const int row = y - l->lister->strip.view->above - l->rows.first;
    return &iso_layer_group_at(l->lists, x, row)->list[x % ISO_LAYER_GROUP];
}

/* The depth at which the listed pieces of a sample leave so little light that nothing behind it can be seen,
 * however many others are still to be listed; INFINITY: there is none. x, y: in the picture. */
static double depth_of_cut(const listing *l, iso_shapes_piece **pieces, size_t count, int x, int y) {
    const iso_view *view = l->lister->strip.view;
    const int row = y - view->above;
    const float to_eye[3] = {-iso_slope_of_column(view, x), -iso_slope_of_row(view, row), -1};
    const iso_layer_list *list = list_at(l, x, y);
    crossing *crossings = l->worker->crossings.data;
    size_t made = 0;
    for (size_t i = 0; i < count; i++) {
        const iso_shapes_piece *p = pieces[i];
        const bool seen = !l->set->shapes || p->t[0] >= l->set->frame.near;
        if (seen && !p->is_entered) crossings[made++] = (crossing){p, 0};
        if (p->t[1] > p->t[0]) crossings[made++] = (crossing){p, 1};
    }
    made = drop_cut(l, crossings, made, x, row);
    sort_crossings(crossings, made);
    float through = list->through;
    int32_t own = list->own;
    for (size_t i = 0; i < made; i++) {
        const iso_fragment fragment = make_fragment(l->set, &crossings[i], to_eye, l->lists->middle);
        const iso_packed_fragment packed = iso_fragment_pack(&fragment);
        through *= 1 - iso_packed_opacity(&packed);
        if (through < ISO_LAYER_CUT || ++own == l->set->pass.most_layers)
            return crossings[i].piece->t[crossings[i].end];
    }
    return INFINITY;
}

/* Whether pieces that are not listed yet can merge with others, so that there may be fewer crossings than the
 * listed ones have. */
static bool merges(const set *s) {
    return s->shapes && iso_shapes_are_lines(s->shapes);
}

/* Sets the limits of samples by the pieces that are listed, so that no more are listed behind; false without
 * memory. */
static bool set_limits(const listing *l) {
    worker *w = l->worker;
    const iso_shapes_pieces *pieces = &w->pieces;
    const iso_shapes_rect *r = &pieces->rect;
    const size_t width = (size_t)(r->x1 - r->x0 + 1), samples = width * (size_t)(r->y1 - r->y0 + 1);
    if (!has_room(&w->crossings, 2 * pieces->count * sizeof(crossing))) return false;
    float *limit = pieces->limit.data;
    const uint32_t *ends = w->ends.data;
    iso_shapes_piece **by_sample = w->sorted.data;
    collect(pieces, INFINITY, samples, w->ends.data, by_sample);
    uint32_t begin = 0;
    for (size_t i = 0; i < samples; begin = ends[i++]) {
        const int x = r->x0 + (int)(i % width), y = r->y0 + (int)(i / width);
        const double depth = depth_of_cut(l, by_sample + begin, ends[i] - begin, x, y),
                     behind = depth + 1e-6 * fabs(depth);
        if (behind < (double)limit[i]) limit[i] = (float)behind;
    }
    iso_shapes_pieces_tidy(&w->pieces);
    return true;
}

/* ---- rectangles and bands */

static void count_samples(const listing *l, const iso_shapes_rect *r) {
    if (!l->lists) return;
    for (int y = r->y0; y <= r->y1; y++)
        for (int x = r->x0; x <= r->x1; x++) {
            const int32_t own = list_at(l, x, y)->own;
            l->listed->samples += own > 0;
            l->listed->layers += (size_t)own;
        }
}

/* Removes what has been added of a rectangle. */
static void restart(const listing *l, const iso_shapes_rect *r) {
    if (!l->lists) return; /* what is drawn is drawn again, or stays */
    for (int y = r->y0; y <= r->y1; y++)
        for (int x = r->x0; x <= r->x1; x++)
            if (list_at(l, x, y)->own)
                iso_layer_lists_restart(l->lists, x, y - l->lister->strip.view->above - l->rows.first);
}

/* A depth in front of all that is in the block and in those behind it. */
static double front_of(const iso_shapes_seen *seen) {
    const double nearest = (double)seen->nearest;
    return nearest - 1e-6 * fabs(nearest);
}

/* Adds the fragments of the blocks in the bin of the prepared rectangle, front to back: whenever there are
 * twice as many pieces as could not be used the last time. False without memory; pieces.full: for another
 * reason. */
static bool add_blocks(const listing *l) {
    const iso_shapes_frame *frame = &l->set->frame;
    iso_shapes_pieces *pieces = &l->worker->pieces;
    const iso_shapes_rect *r = &pieces->rect;
    const size_t samples = (size_t)(r->x1 - r->x0 + 1) * (size_t)(r->y1 - r->y0 + 1);
    const size_t bin = (size_t)((r->y0 - frame->top) / ISO_SHAPES_BIN) * (size_t)frame->columns +
                       (size_t)(r->x0 / ISO_SHAPES_BIN);
    size_t enough = samples * USUAL_PIECES;
    for (size_t i = bin ? frame->bin_end[bin - 1] : 0; i < frame->bin_end[bin]; i++) {
        const iso_shapes_seen *seen = &frame->seen[frame->bin_blocks[i]];
        if (!l->lists && !seen->is_cut && !merges(l->set)) continue; /* it is drawn already */
        if (pieces->count >= enough) {
            if (!add_samples(l, front_of(seen))) return false;
            if (pieces->count > samples * MANY_PIECES && l->lists && !merges(l->set) && !set_limits(l))
                return false;
            if (2 * pieces->count > enough) enough = 2 * pieces->count;
        }
        if (iso_shapes_pieces_list(pieces, frame, seen) != ISO_OK) return false;
        if (pieces->full) return true;
    }
    return add_samples(l, INFINITY);
}

static bool add_mesh(const listing *l) {
    iso_shapes_pieces *pieces = &l->worker->pieces;
    const int top = l->lister->strip.view->above;
    if (iso_shapes_pieces_list_mesh(pieces, l->set->mesh, l->number, top) != ISO_OK) return false;
    return pieces->full || add_samples(l, INFINITY);
}

/* Lists a rectangle, in two halves if it has too many pieces; false without memory. */
static bool list_rect(const listing *l, iso_shapes_rect r) {
    iso_shapes_pieces *pieces = &l->worker->pieces;
    const int width = r.x1 - r.x0 + 1, height = r.y1 - r.y0 + 1;
    const int row = r.y0 - l->lister->strip.view->above - l->rows.first;
    const size_t pitch = (size_t)(l->lists ? l->lists->width : l->gbuffer->width);
    const float *limit = l->lists ? l->lists->limit : l->gbuffer->depth;
    if (limit) limit += (size_t)row * pitch + (size_t)r.x0;
    pieces->most = width * height > 1 ? ISO_SHAPES_PIECES_BYTES / sizeof(iso_shapes_piece) : 0;
    const iso_shapes_frame *frame = l->set->shapes ? &l->set->frame : NULL;
    if (iso_shapes_pieces_begin(pieces, frame, &r, limit, pitch) != ISO_OK) return false;
    if (!(frame ? add_blocks(l) : add_mesh(l))) return false;
    if (!pieces->full) {
        count_samples(l, &r);
        return true;
    }
    if (width * height == 1) return false;
    restart(l, &r);
    iso_shapes_rect first = r, second = r;
    if (width >= height)
        first.x1 = (second.x0 = r.x0 + width / 2) - 1;
    else
        first.y1 = (second.y0 = r.y0 + height / 2) - 1;
    return list_rect(l, first) && list_rect(l, second);
}

/* Lists a bin, which has a list of its blocks, by rectangles whose pieces stay in the cache. */
static bool list_bin(const listing *l, size_t bin) {
    const iso_shapes_frame *frame = &l->set->frame;
    iso_shapes_rect r = iso_shapes_bin_rect(frame, bin);
    const int first = l->rows.first + frame->top, last = l->rows.last + frame->top, end = r.x1;
    if (r.y0 < first) r.y0 = first;
    if (r.y1 > last) r.y1 = last;
    for (; r.x0 <= end; r.x0 += RECT_WIDTH) {
        r.x1 = r.x0 + RECT_WIDTH - 1 < end ? r.x0 + RECT_WIDTH - 1 : end;
        if (!list_rect(l, r)) return false;
    }
    return true;
}

static bool list_shapes(const listing *l) {
    const iso_shapes_frame *frame = &l->set->frame;
    for (int row = l->rows.first / ISO_SHAPES_BIN; row <= l->rows.last / ISO_SHAPES_BIN; row++)
        for (int column = 0; column < frame->columns; column++)
            if (!list_bin(l, (size_t)row * (size_t)frame->columns + (size_t)column)) return false;
    return true;
}

/* The whole width at once: what can be seen of a mesh is not known by column. */
static bool list_mesh(const listing *l) {
    const int top = l->lister->strip.view->above;
    const iso_shapes_rect all = {0, l->rows.first + top, l->lister->size.width - 1, l->rows.last + top};
    return list_rect(l, all);
}

/* iso_layer_source.list. */
static bool list(void *context, int number, iso_layer_lists *lists, iso_rows rows) {
    const iso_shapes_lister *lister = context;
    worker *w = &lister->workers[number];
    for (int i = 0; i < lister->count && !lists->full; i++) {
        w->listed[i] = (iso_shapes_layered){0};
        const listing l = {lister, &lister->sets[i], w, number, lists, NULL, rows, &w->listed[i]};
        iso_layer_lists_begin(lists, &lister->sets[i].pass);
        if (!(l.set->shapes ? list_shapes(&l) : list_mesh(&l))) return false;
    }
    return !lists->full;
}

static void add_counts(iso_shapes_layered *to, const iso_shapes_layered *from) {
    to->samples += from->samples;
    to->layers += from->layers;
}

/* iso_layer_source.count. */
static void count(void *context, int number) {
    const iso_shapes_lister *lister = context;
    worker *w = &lister->workers[number];
    for (int i = 0; i < lister->count; i++) add_counts(&w->counted[i], &w->listed[i]);
}

/* ---- setting up */

static iso_status set_up_set(iso_shapes_lister *lister, const iso_translucent_set *input, int surface, set *s,
                             iso_error *error) {
    s->input = input;
    s->opacity = iso_layer_opacity_make(&input->translucency);
    s->pass =
        (iso_layer_pass){.surface = surface, .most_layers = input->translucency.most_layers, .tolerance = -1};
    s->shapes = input->shapes;
    s->target = lister->target;
    s->target.clip = input->clip;
    if (s->shapes) return iso_shapes_frame_make(&s->target, s->shapes, &s->frame, error);
    return iso_mesh_samples_create(&s->target, &input->mesh, &s->mesh, error);
}

static iso_status set_up(iso_shapes_lister *lister, const iso_translucent_set *sets, int count, int first,
                         iso_error *error) {
    lister->count = count;
    lister->sets = iso_alloc_zero((size_t)count, sizeof *lister->sets);
    lister->workers = iso_alloc_zero((size_t)lister->worker_count, sizeof *lister->workers);
    if (!lister->sets || !lister->workers) return iso_fail_memory(error, "translucent shapes");
    for (int i = 0; i < lister->worker_count; i++) {
        worker *w = &lister->workers[i];
        w->listed = iso_alloc_zero(2 * (size_t)count, sizeof *w->listed);
        if (!w->listed) return iso_fail_memory(error, "translucent shapes");
        w->counted = w->listed + count;
    }
    for (int i = 0; i < count; i++) ISO_TRY(set_up_set(lister, &sets[i], first + i, &lister->sets[i], error));
    return ISO_OK;
}

iso_status iso_shapes_lister_create(const iso_translucent_set *sets, int count, int first,
                                    const iso_strip *strip, iso_pool *pool, iso_shapes_lister **lister,
                                    iso_error *error) {
    iso_shapes_lister *made = iso_alloc_zero(1, sizeof *made);
    if (!made) return iso_fail_memory(error, "translucent shapes");
    made->strip = *strip;
    made->size = (iso_gbuffer){.width = strip->view->width, .height = strip->view->height};
    made->target = (iso_target){.view = strip->view, .gbuffer = &made->size, .pool = pool};
    made->worker_count = iso_pool_threads(pool);
    const iso_status status = set_up(made, sets, count, first, error);
    if (status == ISO_OK)
        *lister = made;
    else
        iso_shapes_lister_destroy(made);
    return status;
}

static void free_worker(worker *w) {
    iso_shapes_pieces_free(&w->pieces);
    iso_buffer_free(&w->sorted);
    iso_buffer_free(&w->ends);
    iso_buffer_free(&w->crossings);
}

void iso_shapes_lister_destroy(iso_shapes_lister *lister) {
    if (!lister) return;
    for (int i = 0; lister->workers && i < lister->worker_count; i++) {
        worker *w = &lister->workers[i];
        for (int k = 0; w->counted && k < lister->count; k++)
            if (lister->sets[k].input && lister->sets[k].input->drawn)
                add_counts(lister->sets[k].input->drawn, &w->counted[k]);
        free_worker(w);
        iso_free(w->listed);
    }
    for (int i = 0; lister->sets && i < lister->count; i++) {
        iso_shapes_frame_free(&lister->sets[i].frame);
        iso_mesh_samples_destroy(lister->sets[i].mesh);
    }
    iso_free(lister->sets);
    iso_free(lister->workers);
    iso_free(lister);
}

iso_layer_source iso_shapes_lister_source(iso_shapes_lister *lister) {
    return (iso_layer_source){list, count, lister};
}

/* ---- drawing opaque sets */

typedef struct cut_draw {
    const iso_shapes_lister *lister;
    iso_gbuffer *gbuffer;
    bool *failed; /* by worker */
} cut_draw;

static void draw_cut_bin(void *context, size_t bin, int number) {
    const cut_draw *d = context;
    worker *w = &d->lister->workers[number];
    const listing l = {d->lister,  &d->lister->sets[0],         w,         number, NULL,
                       d->gbuffer, {0, d->gbuffer->height - 1}, w->counted};
    d->failed[number] |= !list_bin(&l, bin);
}

iso_status iso_shapes_draw_cut(const iso_shapes_frame *frame, iso_shapes_drawn *drawn, iso_error *error) {
    const iso_target *target = frame->target;
    const iso_strip strip = {.view = target->view, .gbuffer = target->gbuffer, .factor = 1};
    const iso_translucent_set input = {.shapes = frame->shapes, .clip = target->clip};
    set own = {.input = &input, .shapes = frame->shapes, .frame = *frame};
    const int workers = iso_pool_threads(target->pool);
    iso_shapes_lister lister = {.strip = strip, .sets = &own, .count = 1, .worker_count = workers};
    lister.workers = iso_alloc_zero((size_t)workers, sizeof *lister.workers);
    iso_shapes_layered *counted = iso_alloc_zero((size_t)workers, sizeof *counted);
    cut_draw d = {&lister, target->gbuffer, iso_alloc_zero((size_t)workers, sizeof(bool))};
    bool failed = !lister.workers || !counted || !d.failed;
    for (int i = 0; i < workers && !failed; i++) lister.workers[i].counted = &counted[i];
    if (!failed)
        iso_parallel_for(target->pool, (size_t)frame->columns * (size_t)frame->rows, draw_cut_bin, &d);
    for (int i = 0; i < workers && !failed; i++) {
        failed |= d.failed[i];
        if (drawn) drawn->samples += counted[i].samples;
    }
    for (int i = 0; i < workers && lister.workers; i++) free_worker(&lister.workers[i]);
    iso_free(lister.workers);
    iso_free(counted);
    iso_free(d.failed);
    return failed ? iso_fail_memory(error, "shapes") : ISO_OK;
}

double iso_translucent_middle(const iso_translucent_set *sets, int count, const iso_view *view) {
    iso_box box = iso_box_empty();
    for (int i = 0; i < count; i++) {
        const iso_box one =
            sets[i].shapes ? iso_shapes_bounds(sets[i].shapes) : iso_mesh_view_bounds(&sets[i].mesh);
        iso_box_add(&box, one.lo);
        iso_box_add(&box, one.hi);
    }
    const iso_vec3 middle = iso_vec3_scale(iso_vec3_add(box.lo, box.hi), 0.5);
    return iso_view_point(view, middle).z;
}
