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

/* A set in the strip. */
typedef struct set {
    const iso_translucent_set *input;
    const iso_shapes *shapes; /* NULL: a mesh */
    iso_shapes_frame frame;   /* of shapes */
    iso_mesh_samples *mesh;   /* without shapes */
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
    iso_buffer sorted, crossings; /* of a sample: const iso_shapes_piece *; crossing */
    iso_shapes_layered *listed;   /* by set: in the band */
    iso_shapes_layered *counted;  /* by set: in all bands */
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
    int number; /* of the worker */
    iso_layer_lists *lists;
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
    for (int end = 0; end < 2 && !order; end++) order = compare(a->t[end], b->t[end]);
    return order ? order : compare_numbers(a->element, b->element);
}

/* By depth; of equal depths the earlier glyph or line comes first. */
static int compare_crossings(const void *first, const void *second) {
    const crossing *a = first, *b = second;
    int order = compare(a->piece->t[a->end], b->piece->t[b->end]);
    if (!order) order = compare_numbers(a->piece->whole, b->piece->whole);
    if (!order) order = a->end - b->end;
    return order ? order : compare_numbers(a->piece->element, b->piece->element);
}

/* ---- the pieces of a sample */

/* Makes room in a buffer, whose contents are lost. */
static bool has_room(iso_buffer *buffer, size_t bytes) {
    return buffer->bytes >= bytes || iso_buffer_reserve(buffer, bytes, 0, NULL) == ISO_OK;
}

/* Collects the pieces that begin with number `first`, sorted; returns how many, 0 without memory. */
static size_t sort_pieces(worker *w, uint32_t first, const iso_shapes_piece ***sorted) {
    const iso_shapes_piece *pieces = w->pieces.pieces.data;
    size_t count = 0;
    for (uint32_t i = first; i != ISO_SHAPES_NO_PIECE; i = pieces[i].next) count++;
    if (!has_room(&w->sorted, count * sizeof **sorted)) return 0;
    *sorted = w->sorted.data;
    count = 0;
    for (uint32_t i = first; i != ISO_SHAPES_NO_PIECE; i = pieces[i].next) (*sorted)[count++] = &pieces[i];
    if (count > 1) qsort(*sorted, count, sizeof **sorted, compare_pieces);
    return count;
}

static size_t add_crossings(const set *s, const iso_shapes_piece *from, const iso_shapes_piece *to,
                            crossing *out) {
    size_t count = 0;
    if (!s->shapes || from->t[0] >= s->frame.near) out[count++] = (crossing){from, 0};
    if (to->t[1] > from->t[0]) out[count++] = (crossing){to, 1};
    return count;
}

/* Merges sorted pieces of the same glyph or line into the ends of their union. */
static size_t merge(const set *s, const iso_shapes_piece **sorted, size_t count, crossing *out) {
    size_t made = 0;
    for (size_t i = 0; i < count;) {
        const iso_shapes_piece *from = sorted[i], *to = from;
        double slack = 0;
        if (s->shapes && s->shapes->kind == ISO_SHAPE_RIBBON)
            slack = SAME_CROSSING * fabs(from->t[0] * (double)s->frame.slope + (double)s->frame.fixed);
        for (i++; i < count && sorted[i]->whole == from->whole && sorted[i]->t[0] <= to->t[1] + slack; i++)
            if (sorted[i]->t[1] > to->t[1] && sorted[i]->t[0] < sorted[i]->t[1]) to = sorted[i];
        made += add_crossings(s, from, to, out + made);
    }
    return made;
}

/* ---- fragments */

static iso_fragment make_fragment(const set *s, const crossing *c, const float to_eye[3], float middle) {
    const iso_shapes_piece *p = c->piece;
    iso_rgb color = s->input->color;
    if (s->shapes && s->shapes->colors) color = iso_shapes_color_at(s->shapes, p->element, p->along[c->end]);
    iso_fragment fragment = {.depth = (float)(p->t[c->end] - (double)middle),
                             .opacity = iso_layer_opacity_at(&s->opacity, p->normal[c->end], to_eye),
                             .surface = s->pass.surface,
                             .leaves = c->end == 1};
    iso_shade_sample(p->normal[c->end], to_eye, color, fragment.color);
    return fragment;
}

/* Adds the fragments of a sample; false without memory. x, y: in the strip. */
static bool add_sample(const listing *l, uint32_t first, int x, int y) {
    worker *w = l->worker;
    const iso_shapes_piece **sorted;
    const size_t count = sort_pieces(w, first, &sorted);
    if (!count || !has_room(&w->crossings, 2 * count * sizeof(crossing))) return false;
    crossing *crossings = w->crossings.data;
    const size_t made = merge(l->set, sorted, count, crossings);
    if (made > 1) qsort(crossings, made, sizeof *crossings, compare_crossings);
    const iso_view *view = l->lister->strip.view;
    const float to_eye[3] = {-iso_slope_of_column(view, x), -iso_slope_of_row(view, y), -1};
    const int row = y - l->rows.first, column = x % ISO_LAYER_GROUP;
    const iso_layer_list *list = &iso_layer_group_at(l->lists, x, row)->list[column];
    const int32_t before = list->count;
    bool done = false;
    for (size_t i = 0; i < made && !done && !l->lists->full; i++) {
        const iso_fragment fragment = make_fragment(l->set, &crossings[i], to_eye, l->lists->middle);
        done = iso_layer_add(l->lists, x, row, &fragment, false);
    }
    l->listed->samples += list->count > before;
    l->listed->layers += (size_t)(list->count - before);
    return !l->lists->full;
}

static bool add_samples(const listing *l) {
    const iso_shapes_pieces *pieces = &l->worker->pieces;
    const iso_shapes_rect *r = &pieces->rect;
    const uint32_t *first = pieces->first.data;
    for (int y = r->y0; y <= r->y1 && pieces->count; y++)
        for (int x = r->x0; x <= r->x1; x++, first++)
            if (*first != ISO_SHAPES_NO_PIECE && !add_sample(l, *first, x, y - l->lister->strip.view->above))
                return false;
    return true;
}

/* ---- rectangles and bands */

static iso_status list_pieces(const listing *l, const iso_shapes_rect *r) {
    iso_shapes_pieces *pieces = &l->worker->pieces;
    const int top = l->lister->strip.view->above;
    const size_t pitch = (size_t)l->lists->width;
    const float *limit = l->lists->limit;
    if (limit) limit += (size_t)(r->y0 - top - l->rows.first) * pitch + (size_t)r->x0;
    if (l->set->shapes) return iso_shapes_pieces_list(pieces, &l->set->frame, r, limit, pitch);
    return iso_shapes_pieces_list_mesh(pieces, l->set->mesh, l->number, top, r, limit, pitch);
}

/* Lists a rectangle, in two halves if it has too many pieces; false without memory. */
static bool list_rect(const listing *l, iso_shapes_rect r) {
    iso_shapes_pieces *pieces = &l->worker->pieces;
    const int width = r.x1 - r.x0 + 1, height = r.y1 - r.y0 + 1;
    pieces->most = width * height > 1 ? ISO_SHAPES_PIECES_BYTES / sizeof(iso_shapes_piece) : 0;
    if (list_pieces(l, &r) != ISO_OK) return false;
    if (!pieces->full) return add_samples(l);
    if (width * height == 1) return false;
    iso_shapes_rect first = r, second = r;
    if (width >= height)
        first.x1 = (second.x0 = r.x0 + width / 2) - 1;
    else
        first.y1 = (second.y0 = r.y0 + height / 2) - 1;
    return list_rect(l, first) && list_rect(l, second);
}

/* Bin by bin: each has a list of its blocks. */
static bool list_shapes(const listing *l) {
    const iso_shapes_frame *frame = &l->set->frame;
    for (int row = l->rows.first / ISO_SHAPES_BIN; row <= l->rows.last / ISO_SHAPES_BIN; row++)
        for (int column = 0; column < frame->columns; column++) {
            iso_shapes_rect r =
                iso_shapes_bin_rect(frame, (size_t)row * (size_t)frame->columns + (size_t)column);
            const int first = l->rows.first + frame->top, last = l->rows.last + frame->top;
            if (r.y0 < first) r.y0 = first;
            if (r.y1 > last) r.y1 = last;
            if (!list_rect(l, r)) return false;
        }
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
        const listing l = {lister, &lister->sets[i], w, number, lists, rows, &w->listed[i]};
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
    if (s->shapes) return iso_shapes_frame_make(&lister->target, s->shapes, &s->frame, error);
    return iso_mesh_samples_create(&lister->target, &input->mesh, &s->mesh, error);
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

void iso_shapes_lister_destroy(iso_shapes_lister *lister) {
    if (!lister) return;
    for (int i = 0; lister->workers && i < lister->worker_count; i++) {
        worker *w = &lister->workers[i];
        for (int k = 0; w->counted && k < lister->count; k++)
            if (lister->sets[k].input && lister->sets[k].input->drawn)
                add_counts(lister->sets[k].input->drawn, &w->counted[k]);
        iso_shapes_pieces_free(&w->pieces);
        iso_buffer_free(&w->sorted);
        iso_buffer_free(&w->crossings);
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
