/* pieces: intersects the rays of samples with the shapes of those blocks whose boxes meet the rectangle. */
#include "render/shapes/pieces.h"

#include <math.h>

#include "render/shapes/solid.h"

/* What a rectangle's pieces are listed with. */
typedef struct listing {
    iso_shapes_pieces *out;
    const iso_shapes_frame *frame; /* NULL: a mesh is listed */
    int top;                       /* the strip's first row in the picture */
    const float *limit;
    size_t pitch;
    iso_status status;
} listing;

/* ---- a shape and its samples */

static uint32_t *first_of(const listing *l, int x, int y) {
    const iso_shapes_rect *r = &l->out->rect;
    const size_t width = (size_t)(r->x1 - r->x0 + 1);
    return (uint32_t *)l->out->first.data + (size_t)(y - r->y0) * width + (size_t)(x - r->x0);
}

static double limit_at(const listing *l, int x, int y) {
    if (!l->limit) return INFINITY;
    const iso_shapes_rect *r = &l->out->rect;
    return (double)l->limit[(size_t)(y - r->y0) * l->pitch + (size_t)(x - r->x0)];
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

static void add(listing *l, int x, int y, const iso_near_piece *from, uint32_t element, uint32_t whole) {
    iso_shapes_piece *p = reserve(l);
    if (!p) return;
    uint32_t *first = first_of(l, x, y);
    *p =
        (iso_shapes_piece){.t = {from->t[0], from->t[1]}, .element = element, .whole = whole, .next = *first};
    for (int end = 0; end < 2; end++) {
        p->along[end] = (float)from->along[end];
        for (int a = 0; a < 3; a++) p->normal[end][a] = (float)from->normal[end][a];
    }
    *first = (uint32_t)l->out->count++;
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

/* The ray of a sample for a billboard: along the optical axis, through the place where the sample's own ray
 * meets the plane of the billboard's centre. */
static iso_near_ray billboard_ray(const iso_near_ray *ray, const double centre[3]) {
    return (iso_near_ray){{centre[2] * ray->direction[0], centre[2] * ray->direction[1], 0}, {0, 0, 1}};
}

static void list_shape(listing *l, const iso_near_shape *shape, const iso_shapes_rect *rect, uint32_t whole,
                       bool billboard) {
    const iso_shapes_frame *frame = l->frame;
    for (int y = rect->y0; y <= rect->y1 && !l->out->full; y++)
        for (int x = rect->x0; x <= rect->x1 && !l->out->full && l->status == ISO_OK; x++) {
            iso_near_ray ray = iso_near_ray_of(frame, x, y);
            if (billboard) ray = billboard_ray(&ray, shape->end[0]);
            iso_near_piece pieces[ISO_NEAR_PIECES];
            const int count = iso_near_pieces(frame, shape, &ray, pieces);
            for (int i = 0; i < count; i++) {
                const iso_near_piece *p = &pieces[i];
                if (!(p->t[1] >= frame->near) || !(p->t[0] < limit_at(l, x, y))) continue;
                if (shape->kind == ISO_SHAPE_RIBBON)
                    add_crossings(l, x, y, p, shape->id, whole);
                else
                    add(l, x, y, p, shape->id, whole);
            }
        }
}

/* ---- the shapes of a block */

/* Whether a sphere is drawn as a billboard. */
static bool is_billboard(const iso_shapes_frame *frame, const iso_near_shape *sphere) {
    const double radius = sphere->radius[0];
    return frame->shapes->billboards && !frame->parallel &&
           iso_near_fits(frame, sphere->end[0][2] - radius, radius);
}

static void list_glyphs(listing *l, const iso_shapes_block *block) {
    const iso_shapes_frame *frame = l->frame;
    const iso_shapes *set = frame->shapes;
    for (uint32_t i = block->first; i < block->first + block->count; i++) {
        const uint32_t id = set->id[i];
        iso_near_shape shape;
        iso_shapes_rect rect;
        bool billboard = false, seen;
        if (set->kind == ISO_SHAPE_SPHERE) {
            const double position[3] = {(double)block->origin[0] + (double)set->x[i],
                                        (double)block->origin[1] + (double)set->y[i],
                                        (double)block->origin[2] + (double)set->z[i]};
            double view[3];
            iso_shapes_to_view(frame, position, view);
            shape = iso_near_sphere(frame, view, (double)iso_shapes_radius(set, id), id);
            seen = iso_solid_place_hull(frame, &shape, &l->out->rect, &rect);
            billboard = is_billboard(frame, &shape);
        } else {
            seen = iso_solid_place(frame, block, i, &l->out->rect, &shape, &rect, &billboard);
        }
        if (seen) list_shape(l, &shape, &rect, id, billboard);
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

static void list_run(listing *l, uint32_t run) {
    const iso_shapes *set = l->frame->shapes;
    const uint32_t first = set->runs.first[run], length = set->runs.length[run], line = line_of(set, first);
    const int ends = set->caps == ISO_CAPS_FLAT ? set->runs.ends[run] : 0;
    for (uint32_t k = 0; k < length; k++) {
        const int flags = (k == 0 && ends & ISO_RUN_STARTS ? ISO_TUBE_CUT_FIRST : 0) |
                          (k + 1 == length && ends & ISO_RUN_ENDS ? ISO_TUBE_CUT_LAST : 0);
        const iso_near_shape shape = iso_near_segment(l->frame, first + k, flags);
        iso_shapes_rect rect;
        if (iso_solid_place_hull(l->frame, &shape, &l->out->rect, &rect))
            list_shape(l, &shape, &rect, line, false);
    }
}

/* ---- rectangles */

static bool meets(const iso_shapes_rect *a, const iso_shapes_rect *b) {
    return a->x0 <= b->x1 && b->x0 <= a->x1 && a->y0 <= b->y1 && b->y0 <= a->y1;
}

static void list_block(listing *l, const iso_shapes_seen *seen) {
    const iso_shapes *set = l->frame->shapes;
    const iso_shapes_block *block = &set->blocks[seen->block];
    if (!iso_shapes_are_lines(set)) {
        list_glyphs(l, block);
        return;
    }
    for (uint32_t i = block->first; i < block->first + block->count; i++) list_run(l, i);
}

static iso_status clear(iso_shapes_pieces *pieces, const iso_shapes_rect *rect) {
    const size_t samples = (size_t)(rect->x1 - rect->x0 + 1) * (size_t)(rect->y1 - rect->y0 + 1);
    ISO_TRY(iso_buffer_reserve(&pieces->first, samples * sizeof(uint32_t), 0, NULL));
    for (size_t i = 0; i < samples; i++) ((uint32_t *)pieces->first.data)[i] = ISO_SHAPES_NO_PIECE;
    pieces->rect = *rect;
    pieces->count = 0;
    pieces->full = false;
    return ISO_OK;
}

iso_status iso_shapes_pieces_list(iso_shapes_pieces *pieces, const iso_shapes_frame *frame,
                                  const iso_shapes_rect *rect, const float *limit, size_t pitch) {
    listing l = {pieces, frame, frame->top, limit, pitch, ISO_OK};
    ISO_TRY(clear(pieces, rect));
    const size_t bin = (size_t)((rect->y0 - frame->top) / ISO_SHAPES_BIN) * (size_t)frame->columns +
                       (size_t)(rect->x0 / ISO_SHAPES_BIN);
    for (size_t i = bin ? frame->bin_end[bin - 1] : 0; i < frame->bin_end[bin]; i++) {
        const iso_shapes_seen *seen = &frame->seen[frame->bin_blocks[i]];
        if (meets(&seen->rect, rect)) list_block(&l, seen);
        if (pieces->full || l.status != ISO_OK) break;
    }
    return l.status;
}

/* ---- meshes */

/* iso_mesh_samples_visit.visit. */
static bool add_triangle(void *context, const iso_mesh_sample *sample) {
    listing *l = context;
    const int x = sample->x, y = sample->y + l->top;
    if (!(sample->depth < limit_at(l, x, y))) return true;
    iso_near_piece p = {.t = {sample->depth, sample->depth}};
    for (int a = 0; a < 3; a++) p.normal[0][a] = (double)sample->normal[a];
    add(l, x, y, &p, sample->triangle, sample->triangle);
    return !l->out->full && l->status == ISO_OK;
}

iso_status iso_shapes_pieces_list_mesh(iso_shapes_pieces *pieces, const iso_mesh_samples *mesh, int worker,
                                       int top, const iso_shapes_rect *rect, const float *limit,
                                       size_t pitch) {
    listing l = {pieces, NULL, top, limit, pitch, ISO_OK};
    const iso_rows columns = {rect->x0, rect->x1}, rows = {rect->y0 - top, rect->y1 - top};
    ISO_TRY(clear(pieces, rect));
    iso_mesh_samples_visit(mesh, worker, columns, rows, add_triangle, &l);
    return l.status;
}

void iso_shapes_pieces_free(iso_shapes_pieces *pieces) {
    iso_buffer_free(&pieces->pieces);
    iso_buffer_free(&pieces->first);
}
