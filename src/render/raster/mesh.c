/* mesh: rasterises triangles with integer edge functions (Pineda 1988) on vertices snapped to 1/256 pixel.
 * Integers are exact, so that triangles with a common edge neither leave holes nor draw a pixel twice.
 * Triangles that cross the near plane, or extend so far that 64-bit edge functions would overflow, are
 * clipped first (Sutherland and Hodgman 1974); a new vertex is always computed from the inner end of an
 * edge towards the outer one, so that both triangles at the edge get the same. */
#include <assert.h>

#include "base/memory.h"
#include "render/raster/mesh_samples.h"

enum {
    SUBPIXEL = 256,
    GUARD = 1 << 21, /* pixels from the optical axis at which triangles are clipped, so that edge functions
                        stay below 2^62 */
    CLIP_PLANES = 5, /* near, and the guard band's four sides */
    POLYGON = 3 + CLIP_PLANES,
    NARROW =
        16 /* pixels: in rows up to this width every pixel is tested; in wider rows the ends are computed */
};

typedef struct vertex {
    iso_vec3 view;
    double weight;   /* for perspective correction: 1/z, or 1 */
    int64_t x, y;    /* in the picture, 1/256 pixel; set when inside */
    float normal[3]; /* view space */
    bool inside;     /* on the inner side of all clip planes */
} vertex;

struct iso_mesh_samples {
    iso_target target;
    const iso_mesh_view *mesh;
    iso_projector projector;
    iso_rows *rows;  /* of each span */
    vertex *scratch; /* `capacity` vertices for each worker */
    size_t capacity;
    int band_count;
};

/* A part of the picture, and what becomes of its samples. */
typedef struct part {
    const iso_mesh_samples *draw;
    iso_rows columns, rows;
    bool (*visit)(void *context, const iso_mesh_sample *sample); /* NULL: they are written into the gbuffer */
    void *context;
    bool ended; /* by `visit` */
} part;

/* Returns the signed distance of p from a clip plane, up to a factor; >= 0 on the inner side. */
static double plane_distance(const iso_view *view, iso_vec3 p, int plane) {
    double limit = view->orthographic ? GUARD / view->focal : p.z * (GUARD / view->focal);
    switch (plane) {
    case 0:
        return p.z - view->near;
    case 1:
        return limit - p.x;
    case 2:
        return limit + p.x;
    case 3:
        return limit - p.y;
    default:
        return limit + p.y;
    }
}

static bool is_inside(const iso_view *view, iso_vec3 p) {
    for (int plane = 0; plane < CLIP_PLANES; plane++)
        if (!(plane_distance(view, p, plane) >= 0)) return false;
    return true;
}

static int64_t snapped(double pixels) {
    return (int64_t)floor(pixels * SUBPIXEL + 0.5);
}

static void place_vertex(const iso_projector *projector, vertex *v) {
    const iso_view *view = projector->view;
    double scale = iso_projector_scale(projector, v->view.z);
    v->weight = view->orthographic ? 1 : 1 / v->view.z;
    v->x = snapped(v->view.x * scale) + snapped(view->cx);
    v->y = snapped(v->view.y * scale) + snapped(view->cy);
}

/* The edges of a triangle as functions that are >= 0 inside; edge k lies opposite to corner k. */
typedef struct edge {
    int64_t value;          /* at the centre of the pixel (0, 0) of the triangle's rectangle */
    int64_t step_x, step_y; /* per pixel */
    int64_t bias;           /* -1 where pixels exactly on the edge belong to the neighbour */
} edge;

typedef struct triangle {
    const vertex *corner[3];
    edge edge[3];
    int64_t x0, x1, y0, y1; /* pixels of its rectangle, clipped to the picture and the band */
    uint32_t number;        /* in the mesh */
} triangle;

/* Top-left rule, with y downwards and the inside to the right of a -> b. */
static edge make_edge(const vertex *a, const vertex *b, int64_t x0, int64_t y0) {
    int64_t dx = b->x - a->x, dy = b->y - a->y;
    int64_t px = x0 * SUBPIXEL + SUBPIXEL / 2, py = y0 * SUBPIXEL + SUBPIXEL / 2;
    bool top_left = dy < 0 || (dy == 0 && dx > 0);
    return (edge){.value = dx * (py - a->y) - dy * (px - a->x),
                  .step_x = -dy * SUBPIXEL,
                  .step_y = dx * SUBPIXEL,
                  .bias = top_left ? 0 : -1};
}

static int64_t floor_divide(int64_t a, int64_t b) {
    int64_t quotient = a / b;
    return quotient - (a % b != 0 && (a < 0) != (b < 0));
}

/* Computes the first and last pixel whose centre lies in [lo, hi] (1/256 pixel), clipped. */
static void pixel_range(int64_t lo, int64_t hi, iso_rows clip, int64_t out[2]) {
    out[0] = floor_divide(lo + SUBPIXEL / 2 - 1, SUBPIXEL);
    out[1] = floor_divide(hi - SUBPIXEL / 2, SUBPIXEL);
    if (out[0] < clip.first) out[0] = clip.first;
    if (out[1] > clip.last) out[1] = clip.last;
}

static int64_t min3(int64_t a, int64_t b, int64_t c) {
    int64_t ab = a < b ? a : b;
    return ab < c ? ab : c;
}

static int64_t max3(int64_t a, int64_t b, int64_t c) {
    return -min3(-a, -b, -c);
}

/* Sets up a triangle. Returns false if it covers no pixel of the band. */
static bool set_up_triangle(triangle *t, const vertex *a, const vertex *b, const vertex *c,
                            const iso_rows clip[2]) {
    int64_t x[2], y[2];
    pixel_range(min3(a->y, b->y, c->y), max3(a->y, b->y, c->y), clip[1], y);
    if (y[0] > y[1]) return false;
    pixel_range(min3(a->x, b->x, c->x), max3(a->x, b->x, c->x), clip[0], x);
    if (x[0] > x[1]) return false;
    int64_t area = (b->x - a->x) * (c->y - a->y) - (b->y - a->y) * (c->x - a->x);
    if (area == 0) return false;
    *t = (triangle){.x0 = x[0], .x1 = x[1], .y0 = y[0], .y1 = y[1]};
    t->corner[0] = a;
    t->corner[1] = area > 0 ? b : c;
    t->corner[2] = area > 0 ? c : b;
    for (int k = 0; k < 3; k++)
        t->edge[k] = make_edge(t->corner[(k + 1) % 3], t->corner[(k + 2) % 3], x[0], y[0]);
    return true;
}

/* The unit normal of a triangle where its corners have these weights. */
static void interpolate_normal(const triangle *t, const double weight[3], double sum, float out[3]) {
    float n[3], square = 0;
    for (int axis = 0; axis < 3; axis++) {
        n[axis] = (float)((weight[0] * t->corner[0]->normal[axis] + weight[1] * t->corner[1]->normal[axis] +
                           weight[2] * t->corner[2]->normal[axis]) /
                          sum);
        square += n[axis] * n[axis];
    }
    float length = sqrtf(square);
    for (int axis = 0; axis < 3; axis++) out[axis] = length > 0 ? n[axis] / length : axis == 2 ? -1.0f : 0.0f;
}

/* Whether a sample of a triangle is left of what is cut away. */
static bool is_left(const iso_target *target, int64_t x, int64_t y, double depth) {
    if (!target->clip) return true;
    iso_vec3 origin, direction;
    iso_view_ray(target->view, (double)x + 0.5, (double)y + 0.5, &origin, &direction);
    return iso_clip_shows(target->clip, iso_vec3_add(origin, iso_vec3_scale(direction, depth)));
}

static void draw_pixel(part *p, const triangle *t, const int64_t value[3], int64_t x, int64_t y) {
    const iso_target *target = &p->draw->target;
    const iso_gbuffer *g = target->gbuffer;
    double weight[3], sum = 0, depth = 0;
    for (int k = 0; k < 3; k++) {
        weight[k] = (double)value[k] * t->corner[k]->weight;
        sum += weight[k];
        depth += weight[k] * t->corner[k]->view.z;
    }
    float normal[3];
    if (!is_left(target, x, y, depth / sum)) return;
    if (p->visit) {
        iso_mesh_sample sample = {.x = (int)x, .y = (int)y, .depth = depth / sum, .triangle = t->number};
        interpolate_normal(t, weight, sum, sample.normal);
        p->ended |= !p->visit(p->context, &sample);
        return;
    }
    const size_t index = (size_t)y * (size_t)g->width + (size_t)x;
    float z = (float)(depth / sum);
    if (!(z < g->depth[index])) return;
    g->depth[index] = z;
    g->surface[index] = target->surface;
    if (g->element) g->element[index] = t->number + 1;
    interpolate_normal(t, weight, sum, normal);
    for (int axis = 0; axis < 3; axis++) g->normal[axis][index] = normal[axis];
}

/* Narrows pixels lo .. hi of a row to those where value + x * step >= 0. */
static void narrow_range(int64_t value, int64_t step, int64_t *lo, int64_t *hi) {
    if (step > 0) {
        int64_t first = -floor_divide(value, step);
        if (first > *lo) *lo = first;
    } else if (step < 0) {
        int64_t last = floor_divide(value, -step);
        if (last < *hi) *hi = last;
    } else if (value < 0) {
        *hi = *lo - 1;
    }
}

static void draw_row(part *p, const triangle *t, int64_t y) {
    int64_t start[3], lo = 0, hi = t->x1 - t->x0;
    for (int k = 0; k < 3; k++) {
        start[k] = t->edge[k].value + (y - t->y0) * t->edge[k].step_y;
        if (t->x1 - t->x0 > NARROW) narrow_range(start[k] + t->edge[k].bias, t->edge[k].step_x, &lo, &hi);
    }
    for (int64_t x = lo; x <= hi; x++) {
        int64_t value[3];
        bool covered = true;
        for (int k = 0; k < 3; k++) {
            value[k] = start[k] + x * t->edge[k].step_x;
            covered &= value[k] + t->edge[k].bias >= 0;
        }
        if (covered) draw_pixel(p, t, value, t->x0 + x, y);
    }
}

static void draw_triangle(part *p, const vertex *const corners[3], uint32_t number) {
    const iso_rows clip[2] = {p->columns, p->rows};
    triangle t;
    if (!set_up_triangle(&t, corners[0], corners[1], corners[2], clip)) return;
    t.number = number;
    for (int64_t y = t.y0; y <= t.y1 && !p->ended; y++) draw_row(p, &t, y);
}

/* Returns the vertex where the edge from `in` to `out` crosses a clip plane, given the distances of both ends
 * from it. */
static vertex cut_edge(const vertex *in, const vertex *out, double in_distance, double out_distance) {
    double t = in_distance / (in_distance - out_distance);
    vertex v = {.view = iso_vec3_add(in->view, iso_vec3_scale(iso_vec3_sub(out->view, in->view), t))};
    for (int axis = 0; axis < 3; axis++)
        v.normal[axis] = (float)(in->normal[axis] + t * (out->normal[axis] - in->normal[axis]));
    return v;
}

static int clip_polygon(const iso_view *view, int plane, const vertex *polygon, int count, vertex *out) {
    int kept = 0;
    for (int i = 0; i < count; i++) {
        const vertex *a = &polygon[i], *b = &polygon[(i + 1) % count];
        double da = plane_distance(view, a->view, plane), db = plane_distance(view, b->view, plane);
        if (da >= 0) out[kept++] = *a;
        if (da >= 0 && db < 0) out[kept++] = cut_edge(a, b, da, db);
        if (da < 0 && db >= 0) out[kept++] = cut_edge(b, a, db, da);
    }
    return kept;
}

/* Clips a triangle and draws the polygon that remains as a fan of triangles. */
static void draw_clipped(part *p, const vertex *const corners[3], uint32_t number) {
    const iso_projector *projector = &p->draw->projector;
    vertex polygon[2][POLYGON];
    int count = 3, now = 0;
    for (int k = 0; k < 3; k++) {
        polygon[0][k] = *corners[k];
        const iso_vec3 at = corners[k]->view;
        if (!isfinite(at.x) || !isfinite(at.y) || !isfinite(at.z)) return;
    }
    for (int plane = 0; plane < CLIP_PLANES && count; plane++, now = !now)
        count = clip_polygon(projector->view, plane, polygon[now], count, polygon[!now]);
    for (int k = 0; k < count; k++) place_vertex(projector, &polygon[now][k]);
    for (int k = 2; k < count; k++) {
        const vertex *fan[3] = {&polygon[now][0], &polygon[now][k - 1], &polygon[now][k]};
        draw_triangle(p, fan, number);
    }
}

static void transform_span(const iso_mesh_samples *draw, const iso_mesh_span *span, vertex *out) {
    const iso_surfel *in = draw->mesh->vertices + span->first_vertex;
    for (uint32_t i = 0; i < span->vertex_count; i++) {
        out[i].view = iso_projector_point(&draw->projector, span->brick, in[i].position);
        iso_projector_normal(&draw->projector, in[i].normal, out[i].normal);
        out[i].inside = is_inside(draw->projector.view, out[i].view);
        if (out[i].inside) place_vertex(&draw->projector, &out[i]);
    }
}

static void draw_span(part *p, const iso_mesh_span *span, vertex *vertices) {
    transform_span(p->draw, span, vertices);
    for (uint32_t i = 0; i < span->triangle_count && !p->ended; i++) {
        const uint32_t number = (uint32_t)span->first_triangle + i;
        const uint16_t *corner = p->draw->mesh->triangles[number];
        const vertex *corners[3] = {&vertices[corner[0]], &vertices[corner[1]], &vertices[corner[2]]};
        if (corners[0]->inside && corners[1]->inside && corners[2]->inside)
            draw_triangle(p, corners, number);
        else
            draw_clipped(p, corners, number);
    }
}

static void draw_part(part *p, int worker) {
    const iso_mesh_samples *draw = p->draw;
    vertex *vertices = draw->scratch + (size_t)worker * draw->capacity;
    for (size_t s = 0; s < draw->mesh->span_count && !p->ended; s++)
        if (iso_rows_meet(draw->rows[s], p->rows)) draw_span(p, &draw->mesh->spans[s], vertices);
}

static void draw_band(void *context, size_t index, int worker) {
    const iso_mesh_samples *draw = context;
    const iso_view *view = draw->projector.view;
    part p = {.draw = draw,
              .columns = {0, view->width - 1},
              .rows = iso_band_rows(view->height, draw->band_count, index)};
    draw_part(&p, worker);
}

void iso_mesh_samples_visit(const iso_mesh_samples *samples, int worker, iso_rows columns, iso_rows rows,
                            bool (*visit)(void *context, const iso_mesh_sample *sample), void *context) {
    part p = {.draw = samples, .columns = columns, .rows = rows, .visit = visit, .context = context};
    draw_part(&p, worker);
}

static void place_span(void *context, size_t index, int worker) {
    (void)worker;
    const iso_mesh_samples *draw = context;
    const iso_mesh_span *span = &draw->mesh->spans[index];
    iso_box box =
        iso_surfel_bounds(draw->mesh->vertices + span->first_vertex, span->vertex_count, span->brick);
    draw->rows[index] = iso_projector_rows(&draw->projector, &box, 0);
}

static size_t largest_span(const iso_mesh_view *mesh) {
    size_t most = 0;
    for (size_t s = 0; s < mesh->span_count; s++)
        if (mesh->spans[s].vertex_count > most) most = mesh->spans[s].vertex_count;
    return most;
}

/* Prepares a mesh; the caller frees it, also after a failure. */
static iso_status prepare(iso_mesh_samples *draw, const iso_target *target, const iso_mesh_view *mesh,
                          iso_error *error) {
    const iso_view *view = target->view;
    assert(view->width == target->gbuffer->width && view->height == target->gbuffer->height);
    *draw = (iso_mesh_samples){.target = *target,
                               .mesh = mesh,
                               .projector = iso_projector_make(view, &mesh->transform),
                               .capacity = largest_span(mesh),
                               .band_count = iso_band_count(target->pool, view->height)};
    draw->rows = iso_alloc_zero(mesh->span_count, sizeof *draw->rows);
    draw->scratch = iso_alloc((size_t)iso_pool_threads(target->pool) * draw->capacity * sizeof(vertex));
    if (!draw->rows || !draw->scratch)
        return iso_fail(error, ISO_ERR_NOMEM, "out of memory for %zu spans of triangles", mesh->span_count);
    iso_parallel_for(target->pool, mesh->span_count, place_span, draw);
    return ISO_OK;
}

static void free_draw(iso_mesh_samples *draw) {
    iso_free(draw->rows);
    iso_free(draw->scratch);
}

iso_status iso_draw_mesh(const iso_target *target, const iso_mesh_view *mesh, iso_error *error) {
    iso_mesh_samples draw;
    const iso_status status = prepare(&draw, target, mesh, error);
    if (status == ISO_OK) iso_parallel_for(target->pool, (size_t)draw.band_count, draw_band, &draw);
    free_draw(&draw);
    return status;
}

iso_status iso_mesh_samples_create(const iso_target *target, const iso_mesh_view *mesh,
                                   iso_mesh_samples **samples, iso_error *error) {
    iso_mesh_samples *made = iso_alloc(sizeof *made);
    if (!made) return iso_fail_memory(error, "triangles");
    const iso_status status = prepare(made, target, mesh, error);
    if (status == ISO_OK)
        *samples = made;
    else
        iso_mesh_samples_destroy(made);
    return status;
}

void iso_mesh_samples_destroy(iso_mesh_samples *samples) {
    if (!samples) return;
    free_draw(samples);
    iso_free(samples);
}
