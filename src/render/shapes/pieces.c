/* pieces: intersects the rays of samples with the shapes of those blocks whose boxes meet the rectangle. */
#include "render/shapes/pieces.h"

#include <float.h>
#include <math.h>

#include "base/cpu.h"
#include "render/shapes/solid.h"

enum { TILE = 8 }; /* samples on a side of a tile */

/* What a rectangle's pieces are listed with. */
typedef struct listing {
    iso_shapes_pieces *out;
    const iso_shapes_frame *frame; /* NULL: a mesh is listed */
    iso_shapes_candidates_fn *candidates;
    iso_status status;
} listing;

static int width_of(const iso_shapes_pieces *pieces) {
    return pieces->rect.x1 - pieces->rect.x0 + 1;
}

static int height_of(const iso_shapes_pieces *pieces) {
    return pieces->rect.y1 - pieces->rect.y0 + 1;
}

/* ---- a shape and its samples; x and y are counted from the corner of the rectangle */

static size_t sample_at(const listing *l, int x, int y) {
    return (size_t)y * (size_t)width_of(l->out) + (size_t)x;
}

/* Room for one more piece; NULL when there is none. */
static iso_shapes_piece *reserve(listing *l) {
    iso_shapes_pieces *out = l->out;
    const size_t bytes = out->count * sizeof(iso_shapes_piece);
    if ((out->most && out->count >= out->most) || out->count >= ISO_SHAPES_NO_PIECE) {
        out->full = true;
        return NULL;
    }
    if (out->pieces.bytes < bytes + sizeof(iso_shapes_piece)) /* not for each piece */
        l->status = iso_buffer_reserve(&out->pieces, bytes + sizeof(iso_shapes_piece), bytes, NULL);
    return l->status == ISO_OK ? (iso_shapes_piece *)out->pieces.data + out->count : NULL;
}

/* Sets an end of a piece to that of another one, which is finished. */
static void set_end(iso_shapes_piece *p, int end, const iso_near_piece *from, uint32_t element) {
    p->t[end] = from->t[end];
    p->element[end] = element;
    p->along[end] = (float)from->along[end];
    for (int a = 0; a < 3; a++) p->normal[end][a] = (float)from->normal[end][a];
}

/* Adds a finished piece. */
static void add(listing *l, int x, int y, const iso_near_piece *from, uint32_t element, uint32_t whole) {
    iso_shapes_piece *p = reserve(l);
    if (!p) return;
    const size_t sample = sample_at(l, x, y);
    for (int end = 0; end < 2; end++) set_end(p, end, from, element);
    p->whole = whole;
    p->sample = sample & ISO_SHAPES_NO_SAMPLE; /* its bits */
    p->is_entered = 0;
    ((uint32_t *)l->out->last.data)[sample] = (uint32_t)l->out->count++;
}

/* Adds each end of a piece as a crossing. */
static void add_crossings(listing *l, int x, int y, const iso_near_piece *from, uint32_t element,
                          uint32_t whole) {
    for (int end = 0; end < 2; end++) {
        if (end && from->t[1] == from->t[0]) break;
        iso_near_piece p = {.t = {from->t[end], from->t[end]}, .along = {from->along[end], 0}};
        for (int a = 0; a < 3; a++) p.normal[0][a] = from->normal[end][a];
        if (p.t[0] >= l->frame->near) add(l, x, y, &p, element, whole);
    }
}

/* A ray's piece in a shape, before it is finished. */
typedef struct met {
    const iso_near_shape *shape;
    const iso_near_ray *ray;
    iso_near_piece *piece;
    uint32_t whole;
} met;

/* Makes a piece the union of itself and another one, if they overlap and are of the same line. Of equal
 * depths the end of the earlier segment is kept, so that the order of segments does not matter. */
static bool unite(iso_shapes_piece *p, const met *m) {
    const iso_near_piece *other = m->piece;
    const uint32_t element = m->shape->id;
    if (p->whole != m->whole || !(other->t[0] <= p->t[1] && p->t[0] <= other->t[1])) return false;
    for (int end = 0; end < 2; end++) {
        const double beyond = end ? other->t[1] - p->t[1] : p->t[0] - other->t[0];
        if (beyond < 0 || (beyond == 0 && p->element[end] <= element)) continue;
        iso_near_finish(m->shape, m->ray, m->piece, end);
        set_end(p, end, m->piece, element);
    }
    return true;
}

static void add_met(listing *l, int x, int y, const met *m) {
    const iso_shape_kind kind = m->shape->kind;
    const uint32_t last = ((const uint32_t *)l->out->last.data)[sample_at(l, x, y)];
    if (kind == ISO_SHAPE_TUBE && last != ISO_SHAPES_NO_PIECE &&
        unite((iso_shapes_piece *)l->out->pieces.data + last, m))
        return;
    for (int end = 0; end < 2; end++) iso_near_finish(m->shape, m->ray, m->piece, end);
    if (kind == ISO_SHAPE_RIBBON)
        add_crossings(l, x, y, m->piece, m->shape->id, m->whole);
    else
        add(l, x, y, m->piece, m->shape->id, m->whole);
}

static iso_near_ray ray_of(const listing *l, int x, int y) {
    const double *slopes = l->out->slopes.data, u = slopes[x], v = slopes[width_of(l->out) + y];
    if (l->frame->parallel) return (iso_near_ray){{u, v, 0}, {0, 0, 1}};
    return (iso_near_ray){{0, 0, 0}, {u, v, 1}};
}

/* The ray of a sample for a billboard: along the optical axis, through the place where the sample's own ray
 * meets the plane of the billboard's centre. */
static iso_near_ray billboard_ray(const iso_near_ray *ray, const double centre[3]) {
    return (iso_near_ray){{centre[2] * ray->direction[0], centre[2] * ray->direction[1], 0}, {0, 0, 1}};
}

/* A shape, and where it may be met. */
typedef struct listed {
    iso_near_shape shape;
    iso_shapes_stadium stadium;
    iso_shapes_rect box; /* from the rectangle's corner */
    uint32_t whole;
    bool billboard;
} listed;

static void list_sample(listing *l, const listed *s, int x, int y) {
    const double limit = (double)((const float *)l->out->limit.data)[sample_at(l, x, y)];
    iso_near_ray ray = ray_of(l, x, y);
    if (s->billboard) ray = billboard_ray(&ray, s->shape.end[0]);
    iso_near_piece pieces[ISO_NEAR_PIECES];
    const int count = iso_near_pieces(l->frame, &s->shape, &ray, pieces);
    for (int i = 0; i < count; i++) {
        if (!(pieces[i].t[1] >= l->frame->near) || !(pieces[i].t[0] < limit)) continue;
        const met m = {&s->shape, &ray, &pieces[i], s->whole};
        add_met(l, x, y, &m);
    }
}

/* Whether nothing at the depth `nearest` or behind can be seen in a box, counted from the corner. */
static bool is_hidden(const iso_shapes_pieces *pieces, const iso_shapes_rect *box, float nearest) {
    const float *farthest = pieces->farthest.data;
    const int pitch = width_of(pieces) / TILE + 1;
    for (int y = box->y0 / TILE; y <= box->y1 / TILE; y++)
        for (int x = box->x0 / TILE; x <= box->x1 / TILE; x++)
            if (farthest[y * pitch + x] > nearest) return false;
    return true;
}

/* Lists the candidates of a stadium; returns how many. */
static int find(const listing *l, const iso_shapes_stadium *stadium, const iso_shapes_rect *box,
                double nearest) {
    const iso_shapes_samples samples = {l->out->limit.data, width_of(l->out)};
    const float front = nearest > -(double)FLT_MAX ? (float)nearest : -FLT_MAX;
    if (is_hidden(l->out, box, front)) return 0;
    return l->candidates(&samples, stadium, box, front, l->out->found.data);
}

static void list_found(listing *l, const listed *s, int count) {
    const int32_t *found = l->out->found.data;
    for (int i = 0; i < count && !l->out->full && l->status == ISO_OK; i++)
        list_sample(l, s, found[i] & 0xffff, found[i] >> 16);
}

/* All samples of the rectangle may meet the shape. */
static void set_everywhere(const listing *l, listed *s) {
    s->stadium = (iso_shapes_stadium){.radius = INFINITY};
    s->box = (iso_shapes_rect){0, 0, width_of(l->out) - 1, height_of(l->out) - 1};
}

/* ---- the shapes of a block */

/* Whether a sphere is drawn as a billboard. */
static bool is_billboard(const iso_shapes_frame *frame, const iso_near_shape *sphere) {
    const double radius = sphere->radius[0];
    return frame->shapes->billboards && !frame->parallel &&
           iso_near_fits(frame, sphere->end[0][2] - radius, radius);
}

/* Places a sphere; false where it is not in the rectangle. */
static bool place_sphere(const listing *l, const iso_shapes_block *block, uint32_t place, listed *s) {
    const iso_shapes_frame *frame = l->frame;
    const iso_shapes *set = frame->shapes;
    const uint32_t id = iso_shapes_id(set, place);
    const double position[3] = {(double)block->origin[0] + (double)set->x[place],
                                (double)block->origin[1] + (double)set->y[place],
                                (double)block->origin[2] + (double)set->z[place]},
                 radius = (double)iso_shapes_radius(set, id);
    double view[3];
    iso_shapes_to_view(frame, position, view);
    if (view[2] + radius < frame->near) return false;
    s->shape = iso_near_sphere(frame, view, radius, id);
    s->billboard = is_billboard(frame, &s->shape);
    if (!iso_near_fits(frame, view[2] - radius, radius)) {
        set_everywhere(l, s);
        return true;
    }
    const iso_shapes_disc disc = iso_shapes_disc_of(frame, view, radius);
    return iso_shapes_stadium_of(&disc, &disc, &l->out->rect, &s->stadium, &s->box);
}

static bool place_solid(const listing *l, const iso_shapes_block *block, uint32_t place, listed *s) {
    const iso_shapes_rect *all = &l->out->rect;
    iso_shapes_rect box;
    set_everywhere(l, s);
    if (!iso_solid_place(l->frame, block, place, all, &s->shape, &box, &s->billboard)) return false;
    s->box = (iso_shapes_rect){box.x0 - all->x0, box.y0 - all->y0, box.x1 - all->x0, box.y1 - all->y0};
    return true;
}

static void list_glyphs(listing *l, const iso_shapes_block *block) {
    const iso_shapes *set = l->frame->shapes;
    for (uint32_t i = block->first; i < block->first + block->count; i++) {
        listed s = {.whole = iso_shapes_id(set, i)};
        if (!(iso_shapes_kind(set) == ISO_SHAPE_SPHERE ? place_sphere : place_solid)(l, block, i, &s))
            continue;
        list_found(l, &s, find(l, &s.stadium, &s.box, s.shape.nearest));
    }
}

/* The number of the line that has a vertex. */
static uint32_t line_of(const iso_shapes *set, size_t vertex) {
    size_t low = 0, high = set->line_count - 1;
    while (low < high) {
        const size_t middle = (low + high + 1) / 2;
        if (set->line_starts[middle] <= vertex)
            low = middle;
        else
            high = middle - 1;
    }
    return (uint32_t)low;
}

/* A vertex, and the disc that holds its sphere, if floats suffice for it. */
typedef struct placed {
    iso_near_vertex vertex;
    iso_shapes_disc disc;
    bool fits;
} placed;

static placed place_vertex(const iso_shapes_frame *frame, uint32_t vertex) {
    placed p = {.vertex = iso_near_vertex_of(frame, vertex)};
    const double radius = p.vertex.radius, *position = p.vertex.position;
    p.fits = iso_near_fits(frame, position[2] - radius, radius);
    if (p.fits) p.disc = iso_shapes_disc_of(frame, position, radius);
    return p;
}

static void list_segment(listing *l, const placed *a, const placed *b, uint32_t id, int flags, listed *s) {
    const iso_near_vertex *ends[2] = {&a->vertex, &b->vertex};
    double front = INFINITY, back = -INFINITY;
    for (int end = 0; end < 2; end++) {
        front = fmin(front, ends[end]->position[2] - ends[end]->radius);
        back = fmax(back, ends[end]->position[2] + ends[end]->radius);
    }
    if (back < l->frame->near) return;
    if (!a->fits || !b->fits)
        set_everywhere(l, s);
    else if (!iso_shapes_stadium_of(&a->disc, &b->disc, &l->out->rect, &s->stadium, &s->box))
        return;
    const int count = find(l, &s->stadium, &s->box, iso_near_nearest(l->frame, front));
    if (!count) return;
    s->shape = iso_near_between(l->frame, ends[0], ends[1], id, flags);
    list_found(l, s, count);
}

static void list_run(listing *l, uint32_t run) {
    const iso_shapes *set = l->frame->shapes;
    const uint32_t first = set->runs.first[run], length = set->runs.length[run];
    const int ends = set->caps == ISO_CAPS_FLAT ? set->runs.ends[run] : 0;
    listed s = {.whole = line_of(set, first)};
    placed a = place_vertex(l->frame, first);
    for (uint32_t k = 0; k < length; k++) {
        const int flags = (k == 0 && ends & ISO_RUN_STARTS ? ISO_TUBE_CUT_FIRST : 0) |
                          (k + 1 == length && ends & ISO_RUN_ENDS ? ISO_TUBE_CUT_LAST : 0);
        const placed b = place_vertex(l->frame, first + k + 1);
        list_segment(l, &a, &b, first + k, flags, &s);
        a = b;
    }
}

/* ---- rectangles */

/* Reserves what depends on the size of the rectangle. */
static iso_status reserve_samples(iso_shapes_pieces *pieces) {
    const size_t width = (size_t)width_of(pieces), height = (size_t)height_of(pieces),
                 samples = width * height, padded = samples + 2 * ISO_LANES_MAX,
                 tiles = (width / TILE + 1) * (height / TILE + 1);
    ISO_TRY(iso_buffer_reserve(&pieces->last, samples * sizeof(uint32_t), 0, NULL));
    ISO_TRY(iso_buffer_reserve(&pieces->limit, padded * sizeof(float), 0, NULL));
    ISO_TRY(iso_buffer_reserve(&pieces->farthest, tiles * sizeof(float), 0, NULL));
    ISO_TRY(iso_buffer_reserve(&pieces->found, padded * sizeof(int32_t), 0, NULL));
    return iso_buffer_reserve(&pieces->slopes, (width + height) * sizeof(double), 0, NULL);
}

static void set_slopes(iso_shapes_pieces *pieces, const iso_shapes_frame *frame) {
    double *slopes = pieces->slopes.data;
    for (int x = pieces->rect.x0; x <= pieces->rect.x1; x++) *slopes++ = (x + 0.5 - frame->cx) / frame->focal;
    for (int y = pieces->rect.y0; y <= pieces->rect.y1; y++) *slopes++ = (y + 0.5 - frame->cy) / frame->focal;
}

/* Sets the farthest limits of tiles. */
static void measure(iso_shapes_pieces *pieces) {
    const int width = width_of(pieces), height = height_of(pieces), pitch = width / TILE + 1;
    float *farthest = pieces->farthest.data;
    const float *limit = pieces->limit.data;
    for (int i = 0; i < pitch * (height / TILE + 1); i++) farthest[i] = -INFINITY;
    for (int y = 0; y < height; y++)
        for (int x = 0; x < width; x++, limit++) {
            float *most = &farthest[y / TILE * pitch + x / TILE];
            if (*limit > *most) *most = *limit;
        }
}

iso_status iso_shapes_pieces_begin(iso_shapes_pieces *pieces, const iso_shapes_frame *frame,
                                   const iso_shapes_rect *rect, const float *limit, size_t pitch) {
    pieces->rect = *rect;
    ISO_TRY(reserve_samples(pieces));
    if (frame) set_slopes(pieces, frame);
    const size_t width = (size_t)width_of(pieces), samples = width * (size_t)height_of(pieces);
    float *limits = pieces->limit.data;
    for (size_t i = 0; i < samples; i++) {
        ((uint32_t *)pieces->last.data)[i] = ISO_SHAPES_NO_PIECE;
        limits[i] = limit ? limit[i / width * pitch + i % width] : INFINITY;
    }
    for (size_t i = samples; i < samples + 2 * ISO_LANES_MAX; i++) limits[i] = -INFINITY;
    measure(pieces);
    pieces->count = 0;
    pieces->full = false;
    return ISO_OK;
}

void iso_shapes_pieces_tidy(iso_shapes_pieces *pieces) {
    iso_shapes_piece *all = pieces->pieces.data;
    const float *limit = pieces->limit.data;
    uint32_t *last = pieces->last.data;
    size_t kept = 0;
    for (size_t i = 0; i < pieces->count; i++) {
        const uint32_t sample = all[i].sample;
        if (sample == ISO_SHAPES_NO_SAMPLE || !(all[i].t[0] < (double)limit[sample])) continue;
        if (kept < i) all[kept] = all[i];
        kept++;
    }
    pieces->count = kept;
    const size_t samples = (size_t)width_of(pieces) * (size_t)height_of(pieces);
    for (size_t i = 0; i < samples; i++) last[i] = ISO_SHAPES_NO_PIECE;
    measure(pieces);
}

/* Whether a block has nothing that can be seen in the rectangle. */
static bool is_block_hidden(const iso_shapes_pieces *pieces, const iso_shapes_seen *seen) {
    const iso_shapes_rect *all = &pieces->rect, *part = &seen->rect;
    const iso_shapes_rect box = {part->x0 > all->x0 ? part->x0 - all->x0 : 0,
                                 part->y0 > all->y0 ? part->y0 - all->y0 : 0,
                                 (part->x1 < all->x1 ? part->x1 : all->x1) - all->x0,
                                 (part->y1 < all->y1 ? part->y1 : all->y1) - all->y0};
    return box.x0 > box.x1 || box.y0 > box.y1 || is_hidden(pieces, &box, seen->nearest);
}

iso_status iso_shapes_pieces_list(iso_shapes_pieces *pieces, const iso_shapes_frame *frame,
                                  const iso_shapes_seen *seen) {
    listing l = {pieces, frame, iso_shapes_candidates_get(iso_cpu_best()), ISO_OK};
    const iso_shapes_block *block = &frame->shapes->blocks[seen->block];
    if (is_block_hidden(pieces, seen)) return ISO_OK;
    if (!iso_shapes_are_lines(frame->shapes)) {
        list_glyphs(&l, block);
        return l.status;
    }
    for (uint32_t i = block->first; i < block->first + block->count && !pieces->full; i++) list_run(&l, i);
    return l.status;
}

/* ---- meshes */

/* What visits the samples of a mesh. */
typedef struct visit {
    listing listing;
    int left, top; /* of the rectangle in the view */
} visit;

/* iso_mesh_samples_visit.visit. */
static bool add_triangle(void *context, const iso_mesh_sample *sample) {
    visit *v = context;
    listing *l = &v->listing;
    const int x = sample->x - v->left, y = sample->y - v->top;
    if (!(sample->depth < (double)((const float *)l->out->limit.data)[sample_at(l, x, y)])) return true;
    iso_near_piece p = {.t = {sample->depth, sample->depth}};
    for (int a = 0; a < 3; a++) p.normal[0][a] = (double)sample->normal[a];
    add(l, x, y, &p, sample->triangle, sample->triangle);
    return !l->out->full && l->status == ISO_OK;
}

iso_status iso_shapes_pieces_list_mesh(iso_shapes_pieces *pieces, const iso_mesh_samples *mesh, int worker,
                                       int top) {
    const iso_shapes_rect *rect = &pieces->rect;
    visit v = {{.out = pieces}, rect->x0, rect->y0 - top};
    const iso_rows columns = {rect->x0, rect->x1}, rows = {rect->y0 - top, rect->y1 - top};
    iso_mesh_samples_visit(mesh, worker, columns, rows, add_triangle, &v);
    return v.listing.status;
}

void iso_shapes_pieces_free(iso_shapes_pieces *pieces) {
    iso_buffer_free(&pieces->pieces);
    iso_buffer_free(&pieces->last);
    iso_buffer_free(&pieces->limit);
    iso_buffer_free(&pieces->farthest);
    iso_buffer_free(&pieces->found);
    iso_buffer_free(&pieces->slopes);
}
