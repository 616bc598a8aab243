/* caps: where the pieces of rays that a clip leaves begin in a solid there is a cap. All in double
 * precision. */
#include "scene/caps.h"

#include <math.h>
#include <string.h>

#include "base/memory.h"

enum { ROWS_PER_TASK = 4 };

/* Half the width of outlines, pixels. */
static const double OUTLINE = 0.75;

/* A solid, prepared for sampling. */
typedef struct solid {
    const iso_capped *input;
    iso_affine affine;
    double last[3];  /* index of the last voxel */
    double isovalue; /* stored */
    bool level_set;
    bool same_clip; /* as the solid before it */
    bool by_plane;  /* its clip is one plane */
} solid;

/* A number that depends linearly on the column: first + x * next. */
typedef struct linear {
    double first, next;
} linear;

/* A solid that one plane cuts, for a row of samples. With the slope of a ray towards what is left, the ray
 * meets the plane at depth / slope, at the index coordinates place / slope. */
typedef struct plane_row {
    linear slope, depth, place[3];
    int begin, end; /* columns in which that can be in the volume */
} plane_row;

typedef struct caps_draw {
    const iso_cut_caps *caps;
    const iso_view *view;
    iso_gbuffer *gbuffer;
    solid *solids;
    plane_row *rows; /* by worker and solid */
    bool others;     /* some solids get caps that are not cut by one plane */
} caps_draw;

/* What a sample shows. */
typedef struct found {
    double depth;
    const solid *solid;
    iso_vec3 normal; /* world; 0: not lit */
    iso_rgb color;
} found;

/* Interpolates between the eight corners of a cell, whose first is `v`; y, z: to the next row and layer. */
#define BLEND(v)                                                                                             \
    do {                                                                                                     \
        const double a = (v)[0], b = (v)[y], c = (v)[z], d = (v)[y + z];                                     \
        const double low = a + part[0] * ((v)[1] - a), high = b + part[0] * ((v)[y + 1] - b),                \
                     low2 = c + part[0] * ((v)[z + 1] - c), high2 = d + part[0] * ((v)[y + z + 1] - d);      \
        const double near = low + part[1] * (high - low), far = low2 + part[1] * (high2 - low2);             \
        return near + part[2] * (far - near);                                                                \
    } while (0)

/* iso_grid_sample of a dense grid, in a cell that lies in it; NAN or infinite: a corner is not finite. */
static double sample_dense(const iso_rgrid *grid, const int cell[3], const double part[3]) {
    const ptrdiff_t y = grid->stride_y, z = grid->stride_z, first = cell[0] + cell[1] * y + cell[2] * z;
    switch (grid->type) {
    case ISO_UINT8:
        BLEND((const uint8_t *)grid->data + first);
    case ISO_INT16:
        BLEND((const int16_t *)grid->data + first);
    case ISO_UINT16:
        BLEND((const uint16_t *)grid->data + first);
    default:
        BLEND((const float *)grid->data + first);
    }
}

/* The stored value at a place in index coordinates; NAN outside the volume, and beside a voxel that is not
 * finite. */
static double value_at_index(const solid *s, iso_vec3 place) {
    const double p[3] = {place.x, place.y, place.z},
                 slack = 1e-9; /* a plane along the border lies in the volume */
    double part[3];
    int cell[3];
    for (int axis = 0; axis < 3; axis++) {
        if (!(p[axis] >= -slack && p[axis] <= s->last[axis] + slack)) return NAN;
        cell[axis] = (int)p[axis];
        part[axis] = p[axis] - cell[axis];
    }
    const bool within = cell[0] < s->last[0] && cell[1] < s->last[1] && cell[2] < s->last[2];
    if (!s->input->grid->rgrid || !within) return iso_grid_sample(s->input->grid, place);
    const double value = sample_dense(s->input->grid->rgrid, cell, part);
    return isfinite(value) ? value : NAN;
}

/* The same at a point in the world. */
static double value_at(const solid *s, iso_vec3 point) {
    return value_at_index(s, iso_affine_point_to_index(&s->affine, point));
}

static bool is_inside(const solid *s, double value) {
    return !isnan(value) && (value >= s->isovalue) != s->level_set;
}

/* Whether solid `a` is drawn where `b` has a cap as well, which comes before it. */
static bool is_inner(const solid *a, const solid *b) {
    if (a->input->grid->rgrid != b->input->grid->rgrid || a->input->grid->hgrid != b->input->grid->hgrid)
        return true;
    return (a->isovalue > b->isovalue) != a->level_set;
}

static iso_rgb color_of(const iso_slice_look *look, const solid *s, double value) {
    const double width = look->high - look->low, physical = iso_grid_physical(s->input->grid, value);
    return iso_colormap_at(look->map, isnan(value) ? NAN : (physical - look->low) / width);
}

static linear between(double first, double second) {
    return (linear){first, second - first};
}

static double at_column(const linear *l, int x) {
    return l->first + x * l->next;
}

/* Leaves only columns in which l is not below 0, and a column more on both sides for rounding. */
static void limit_columns(linear l, plane_row *row) {
    const double zero = -l.first / l.next;
    if (l.next > 0 && zero - 1 > row->begin) row->begin = zero - 1 < row->end ? (int)(zero - 1) : row->end;
    if (l.next < 0 && zero + 2 < row->end) row->end = zero + 2 > row->begin ? (int)(zero + 2) : row->begin;
    if (l.next == 0 && l.first < 0) row->end = row->begin;
}

/* In perspective all rays of a row have one origin, and else one direction: so that what row->place stands
 * for is linear. */
static plane_row make_plane_row(const solid *s, const iso_view *view, int y) {
    const iso_clip_body *body = &s->input->clip->body[0];
    const double side = body->keeps ? -1 : 1, *f = body->face[0];
    const iso_vec3 normal = {side * f[0], side * f[1], side * f[2]};
    plane_row row = {.begin = 0, .end = view->width};
    double slope[2], depth[2], place[2][3];
    for (int x = 0; x < 2; x++) {
        iso_vec3 origin, direction;
        iso_view_ray(view, x + 0.5, y + 0.5, &origin, &direction);
        slope[x] = iso_vec3_dot(normal, direction);
        depth[x] = side * f[3] - iso_vec3_dot(normal, origin);
        const iso_vec3 from = iso_vec3_scale(iso_affine_point_to_index(&s->affine, origin), slope[x]),
                       step = iso_vec3_scale(iso_affine_vector_to_index(&s->affine, direction), depth[x]);
        iso_vec3_store(iso_vec3_add(from, step), place[x]);
    }
    row.slope = between(slope[0], slope[1]);
    row.depth = between(depth[0], depth[1]);
    limit_columns(row.slope, &row);
    for (int axis = 0; axis < 3; axis++) {
        const double last = s->last[axis];
        row.place[axis] = between(place[0][axis], place[1][axis]);
        limit_columns(row.place[axis], &row);
        limit_columns(between(last * slope[0] - place[0][axis], last * slope[1] - place[1][axis]), &row);
    }
    return row;
}

static void take_cap(const caps_draw *draw, const solid *s, const iso_clip_piece *piece, iso_vec3 point,
                     double value, found *f) {
    const bool shows = draw->caps->shows && !s->input->plain;
    f->depth = piece->begin;
    f->solid = s;
    f->normal = shows ? iso_vec3_make(0, 0, 0) : iso_clip_normal(s->input->clip, piece, point);
    f->color = shows ? color_of(&draw->caps->look, s, value) : s->input->color;
}

/* The cap of a solid that one plane cuts, in column x, if it is not behind *f. */
static void find_plane_cap(const caps_draw *draw, const solid *s, const plane_row *row, int x, found *f) {
    if (x < row->begin || x >= row->end) return;
    const double slope = at_column(&row->slope, x), inverse = 1 / slope,
                 t = at_column(&row->depth, x) * inverse;
    if (!(slope > 0 && t > draw->view->near && t <= f->depth)) return;
    const iso_vec3 place = {at_column(&row->place[0], x) * inverse, at_column(&row->place[1], x) * inverse,
                            at_column(&row->place[2], x) * inverse};
    const double value = value_at_index(s, place);
    if (!is_inside(s, value) || (t == f->depth && f->solid && !is_inner(s, f->solid))) return;
    const iso_clip_piece piece = {t, INFINITY, 0, 0};
    take_cap(draw, s, &piece, s->input->clip->body[0].centre, value, f);
}

/* The nearest cap of the solids that are not cut by one plane, if it is not behind *f. */
static void find_cap(const caps_draw *draw, iso_vec3 origin, iso_vec3 direction, found *f) {
    iso_clip_piece pieces[ISO_CLIP_PIECES];
    int count = 0;
    const double limit = f->depth;
    for (int i = 0; i < draw->caps->count; i++) {
        const solid *s = &draw->solids[i];
        if (!s->input->clip || s->by_plane) continue;
        if (!s->same_clip)
            count = iso_clip_pieces(s->input->clip, origin, direction, draw->view->near, limit, pieces);
        for (int k = 0; k < count && pieces[k].begin <= f->depth; k++) {
            if (pieces[k].body < 0) continue;
            const iso_vec3 point = iso_vec3_add(origin, iso_vec3_scale(direction, pieces[k].begin));
            const double value = value_at(s, point);
            if (!is_inside(s, value)) continue;
            if (pieces[k].begin < f->depth || !f->solid || is_inner(s, f->solid))
                take_cap(draw, s, &pieces[k], point, value, f);
            break;
        }
    }
}

/* ---- slices */

/* Where the ray of a sample meets a plane; false: nowhere in front of the eye. */
static bool meet_plane(const iso_view *view, const double plane[4], double x, double y, double *t,
                       iso_vec3 *point) {
    iso_vec3 origin, direction;
    iso_view_ray(view, x, y, &origin, &direction);
    const double slope = plane[0] * direction.x + plane[1] * direction.y + plane[2] * direction.z;
    *t = (plane[3] - (plane[0] * origin.x + plane[1] * origin.y + plane[2] * origin.z)) / slope;
    *point = iso_vec3_add(origin, iso_vec3_scale(direction, *t));
    return *t >= view->near && *t < INFINITY;
}

/* Whether an outline of a surface passes within OUTLINE pixels. across, down: the values in the next
 * samples. */
static bool is_outline(const caps_draw *draw, const solid *s, double value, double across, double down) {
    const double reach = OUTLINE * draw->caps->factor, from = value - s->isovalue;
    const double square = (across - value) * (across - value) + (down - value) * (down - value);
    return from * from < reach * reach * square;
}

static void find_slice(const caps_draw *draw, const iso_slice *slice, int x, int y, found *f) {
    const solid *first = &draw->solids[0];
    double t, unused;
    iso_vec3 point, next;
    if (!meet_plane(draw->view, slice->plane, x + 0.5, y + 0.5, &t, &point) || !(t <= f->depth)) return;
    const double value = value_at(first, point);
    if (isnan(value)) return;
    *f = (found){t, first, {0, 0, 0}, color_of(&draw->caps->look, first, value)};
    const double across =
        meet_plane(draw->view, slice->plane, x + 1.5, y + 0.5, &unused, &next) ? value_at(first, next) : NAN;
    const double down =
        meet_plane(draw->view, slice->plane, x + 0.5, y + 1.5, &unused, &next) ? value_at(first, next) : NAN;
    for (int i = 0; i < draw->caps->count; i++) {
        const solid *s = &draw->solids[i];
        const bool same = s->input->grid->rgrid == first->input->grid->rgrid &&
                          s->input->grid->hgrid == first->input->grid->hgrid;
        if (same && is_outline(draw, s, value, across, down)) f->color = s->input->color;
    }
}

/* ---- the gbuffer */

static void write_sample(const caps_draw *draw, size_t at, const found *f) {
    iso_gbuffer *gbuffer = draw->gbuffer;
    const iso_vec3 normal = iso_view_vector(draw->view, f->normal);
    const iso_rgb c = f->color;
    gbuffer->depth[at] = (float)f->depth;
    gbuffer->normal[0][at] = (float)normal.x;
    gbuffer->normal[1][at] = (float)normal.y;
    gbuffer->normal[2][at] = (float)normal.z;
    gbuffer->surface[at] = f->solid->input->surface;
    gbuffer->color[at] = (uint32_t)c.r | (uint32_t)c.g << 8 | (uint32_t)c.b << 16 |
                         ((uint32_t)f->solid->input->surface + 1) << 24;
}

static void draw_sample(const caps_draw *draw, const plane_row *rows, int x, int y) {
    const size_t at = (size_t)y * (size_t)draw->gbuffer->width + (size_t)x;
    found f = {.depth = (double)draw->gbuffer->depth[at]};
    for (int i = 0; i < draw->caps->count && draw->caps->caps; i++)
        if (draw->solids[i].by_plane) find_plane_cap(draw, &draw->solids[i], &rows[i], x, &f);
    if (draw->others) {
        iso_vec3 origin, direction;
        iso_view_ray(draw->view, x + 0.5, y + 0.5, &origin, &direction);
        find_cap(draw, origin, direction, &f);
    }
    for (int i = 0; i < draw->caps->slice_count; i++) find_slice(draw, &draw->caps->slices[i], x, y, &f);
    if (f.solid) write_sample(draw, at, &f);
}

/* The columns in which there can be a cap of a solid that one plane cuts. */
static void limit_row(const caps_draw *draw, const plane_row *rows, int *begin, int *end) {
    *begin = draw->gbuffer->width;
    *end = 0;
    for (int i = 0; i < draw->caps->count; i++) {
        if (!draw->solids[i].by_plane || rows[i].begin >= rows[i].end) continue;
        if (rows[i].begin < *begin) *begin = rows[i].begin;
        if (rows[i].end > *end) *end = rows[i].end;
    }
}

static void draw_rows(void *context, size_t index, int worker) {
    const caps_draw *draw = context;
    plane_row *rows = draw->rows + (size_t)worker * (size_t)draw->caps->count;
    const int first = (int)index * ROWS_PER_TASK;
    for (int y = first; y < first + ROWS_PER_TASK && y < draw->gbuffer->height; y++) {
        for (int i = 0; i < draw->caps->count; i++)
            if (draw->solids[i].by_plane) rows[i] = make_plane_row(&draw->solids[i], draw->view, y);
        int begin = 0, end = draw->gbuffer->width;
        if (!draw->others && !draw->caps->slice_count) limit_row(draw, rows, &begin, &end);
        for (int x = begin; x < end; x++) draw_sample(draw, rows, x, y);
    }
}

static bool are_equal(const iso_clip *a, const iso_clip *b) {
    return a && b &&
           (a == b ||
            (a->count == b->count && memcmp(a->body, b->body, (size_t)a->count * sizeof *a->body) == 0));
}

static void prepare_solid(const iso_capped *input, solid *s) {
    *s = (solid){.input = input, .level_set = iso_grid_is_level_set(input->grid)};
    s->affine = iso_transform_affine(iso_grid_transform(input->grid));
    s->isovalue = iso_grid_stored(input->grid, input->isovalue);
    for (int axis = 0; axis < 3; axis++) s->last[axis] = iso_grid_dims(input->grid)[axis] - 1;
}

iso_status iso_caps_draw(const iso_cut_caps *caps, const iso_view *view, iso_gbuffer *gbuffer, iso_pool *pool,
                         iso_error *error) {
    if (!caps->count) return ISO_OK;
    ISO_TRY(iso_gbuffer_add_color(gbuffer, error));
    const size_t count = (size_t)caps->count, workers = (size_t)iso_pool_threads(pool);
    caps_draw draw = {.caps = caps, .view = view, .gbuffer = gbuffer};
    draw.solids = iso_alloc(count * (sizeof *draw.solids + workers * sizeof *draw.rows));
    if (!draw.solids) return iso_fail(error, ISO_ERR_NOMEM, "out of memory for caps");
    draw.rows = (plane_row *)(draw.solids + count);
    for (int i = 0; i < caps->count; i++) {
        prepare_solid(&caps->solids[i], &draw.solids[i]);
        const bool cut = caps->solids[i].clip && caps->solids[i].clip->count;
        draw.solids[i].by_plane =
            cut && caps->solids[i].clip->count == 1 && caps->solids[i].clip->body[0].faces == 1;
        draw.others |= caps->caps && cut && !draw.solids[i].by_plane;
        draw.solids[i].same_clip =
            i && !draw.solids[i - 1].by_plane && are_equal(caps->solids[i].clip, caps->solids[i - 1].clip);
    }
    const size_t tasks = ((size_t)gbuffer->height + ROWS_PER_TASK - 1) / ROWS_PER_TASK;
    iso_parallel_for(pool, tasks, draw_rows, &draw);
    iso_free(draw.solids);
    return ISO_OK;
}
