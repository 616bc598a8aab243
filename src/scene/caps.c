/* caps: where the pieces of rays that a clip leaves begin in a solid there is a cap. All in double
 * precision, with a kernel for solids that one plane cuts. */
#include "scene/caps.h"

#include <assert.h>
#include <math.h>
#include <string.h>

#include "base/kernel_units.h"
#include "base/memory.h"
#include "grids/brick_index.h"
#include "render/shading/phong_vectors.h"
#include "render/shading/shading.h"
#include "render/view/project.h"
#include "scene/caps_kernel.h"

enum { ROWS_PER_TASK = 4 };

/* Half the width of outlines, pixels. */
static const double OUTLINE = 0.75;

/* A solid, prepared for sampling. */
typedef struct solid {
    const iso_capped *input;
    iso_affine affine;
    iso_grid voxels;         /* of the volume, or of the part of it that is looked at */
    int origin[3];           /* the index of their first one in the volume */
    double last[3];          /* index of the volume's last voxel */
    double low[3], high[3];  /* index coordinates between which there are caps */
    double first[3], end[3]; /* and slices: to `end`, which belongs to another part */
    double isovalue;         /* stored */
    bool level_set;
    bool same_clip;       /* as the solid before it */
    bool by_plane;        /* its clip is one plane */
    bool same_plane;      /* as the solid before it, in the same volume */
    float normal[3];      /* of the cap that a plane makes, in view space */
    bool shows;           /* its caps show the volume */
    double scale, offset; /* physical = stored * scale + offset */
} solid;

typedef struct caps_draw caps_draw;
typedef struct found found;

struct caps_draw {
    const iso_cut_caps *caps;
    const iso_view *view;
    iso_gbuffer *gbuffer;
    uint64_t *keys; /* the caps' plane of a key image; NULL: draws into the gbuffer */
    bool in_front;  /* iso_caps_are_in_front */
    iso_area area;  /* the samples that are drawn */
    iso_cap_kernel_fn *kernel;
    solid *solids;
    iso_cap_row *rows;           /* by worker and solid */
    bool others;                 /* some solids get caps that are not cut by one plane */
    iso_cap_painter_fn *painter; /* NULL: it cannot paint these caps */
    iso_cap_paint paint;         /* of the only solid */
    void (*write)(const caps_draw *draw, int x, int y, const found *f);
};

/* What a sample shows. */
struct found {
    double depth;
    const solid *solid;
    int order;       /* of two caps or slices at one depth the lower one is seen */
    float normal[3]; /* view space; 0: not lit */
    uint32_t color;  /* as in the gbuffer, without the surface's number */
};

/* A place in index coordinates of the volume, in those of the voxels that are there. (The origin is
 * subtracted without rounding.) */
static iso_vec3 in_part(const solid *s, iso_vec3 place) {
    return iso_vec3_sub(place, iso_vec3_make(s->origin[0], s->origin[1], s->origin[2]));
}

/* The stored value at a place in index coordinates; NAN outside the volume, or the part that is looked at,
 * and beside a voxel that is not finite. */
static double value_at_index(const solid *s, iso_vec3 place) {
    const double p[3] = {place.x, place.y, place.z};
    for (int axis = 0; axis < 3; axis++)
        if (!(p[axis] >= s->low[axis] && p[axis] <= s->high[axis])) return NAN;
    return iso_grid_sample(&s->voxels, in_part(s, place));
}

/* The same at a point in the world. */
static double value_at(const solid *s, iso_vec3 point) {
    return value_at_index(s, iso_affine_point_to_index(&s->affine, point));
}

static bool is_inside(const solid *s, double value) {
    return !isnan(value) && (value >= s->isovalue) != s->level_set;
}

static bool share_volume(const iso_capped *a, const iso_capped *b) {
    return a->grid->rgrid == b->grid->rgrid && a->grid->hgrid == b->grid->hgrid;
}

/* Whether solid `a` is drawn where `b` has a cap as well, which comes before it. */
static bool is_inner(const solid *a, const solid *b) {
    return !share_volume(a->input, b->input) || (a->isovalue > b->isovalue) != a->level_set;
}

static uint32_t pack(iso_rgb c) {
    return (uint32_t)c.r | (uint32_t)c.g << 8 | (uint32_t)c.b << 16;
}

static inline uint32_t color_of(const iso_slice_look *look, const solid *s, double value) {
    const double physical = value * s->scale + s->offset,
                 at = (physical - look->low) / (look->high - look->low);
    if (look->map == ISO_COLORMAP_GRAY && !isnan(at)) return iso_gray_at(at) * 0x010101u;
    return pack(iso_colormap_at(look->map, at));
}

static iso_cap_linear between(double first, double second) {
    return (iso_cap_linear){first, second - first};
}

/* Leaves only columns in which l is not below 0, and a column more on both sides for rounding. */
static void limit_columns(iso_cap_linear l, iso_cap_row *row) {
    const double zero = -l.first / l.next;
    if (l.next > 0 && zero - 1 > row->begin) row->begin = zero - 1 < row->end ? (int)(zero - 1) : row->end;
    if (l.next < 0 && zero + 2 < row->end) row->end = zero + 2 > row->begin ? (int)(zero + 2) : row->begin;
    if (l.next == 0 && l.first < 0) row->end = row->begin;
}

/* In perspective all rays of a row have one origin, and else one direction: so that what row->place stands
 * for is linear. */
static iso_cap_row make_plane_row(const solid *s, const iso_view *view, int y) {
    const iso_clip_body *body = &s->input->clip->body[0];
    const double side = body->keeps ? -1 : 1, *f = body->face[0];
    const iso_vec3 normal = {side * f[0], side * f[1], side * f[2]};
    iso_cap_row row = {.begin = 0, .end = view->width, .near = view->near};
    if (s->last[0] >= 1 && s->last[1] >= 1 && s->last[2] >= 1) row.grid = s->voxels.rgrid;
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
        const double low = row.low[axis] = s->low[axis], high = row.high[axis] = s->high[axis];
        row.last[axis] = s->last[axis];
        row.origin[axis] = s->origin[axis];
        row.place[axis] = between(place[0][axis], place[1][axis]);
        limit_columns(between(place[0][axis] - low * slope[0], place[1][axis] - low * slope[1]), &row);
        limit_columns(between(high * slope[0] - place[0][axis], high * slope[1] - place[1][axis]), &row);
    }
    return row;
}

static void store_normal(const iso_view *view, iso_vec3 normal, float to[3]) {
    const iso_vec3 v = iso_view_vector(view, normal);
    to[0] = (float)v.x, to[1] = (float)v.y, to[2] = (float)v.z;
}

/* Makes the sample show the cap of a solid. normal: view space; of caps that do not show the volume. */
static inline void take_cap(const caps_draw *draw, const solid *s, double depth, const float normal[3],
                            double value, found *f) {
    f->depth = depth;
    f->solid = s;
    f->order = ISO_SLICES;
    f->color = s->shows ? color_of(&draw->caps->look, s, value) : pack(s->input->color);
    for (int k = 0; k < 3; k++) f->normal[k] = s->shows ? 0 : normal[k];
}

/* Whether some brick that the plane crosses in `count` samples from column x on has a value inside; true
 * where that is not known. */
static bool may_be_inside(const solid *s, const iso_cap_row *row, int x, int count) {
    int first[3], last[3];
    if (row->begin >= x + count || row->end <= x) return false;
    const iso_brick_index *index = row->grid ? row->grid->index : NULL;
    if (!index || !iso_brick_index_current(index)) return true;
    const double from = row->slope.first + x * row->slope.next,
                 to = row->slope.first + (x + count - 1) * row->slope.next, slack = 1e-6;
    if (!(from > 0 && to > 0)) return true;
    for (int axis = 0; axis < 3; axis++) { /* the places lie on the line between the two ends */
        const iso_cap_linear *p = &row->place[axis];
        const double a = (p->first + x * p->next) / from, b = (p->first + (x + count - 1) * p->next) / to,
                     low = (a < b ? a : b) - slack, high = (a < b ? b : a) + slack;
        if (!(high >= 0 && low <= s->last[axis])) return false;
        first[axis] = low > 0 ? (int)low / ISO_BRICK : 0;
        last[axis] = (int)(high < s->last[axis] ? high : s->last[axis]) / ISO_BRICK;
    }
    for (int z = first[2]; z <= last[2]; z++)
        for (int y = first[1]; y <= last[1]; y++)
            for (int b = first[0]; b <= last[0]; b++) {
                const uint32_t brick = iso_brick_index_number(index, (int[3]){b, y, z});
                const iso_brick_range range = iso_brick_index_range(index, brick);
                if (s->level_set ? range.lo < s->isovalue : range.hi >= s->isovalue) return true;
            }
    return false;
}

/* Computes where the plane that cuts a solid is met, in `count` samples from column x on. */
static void fill_block(const caps_draw *draw, const solid *s, const iso_cap_row *row, int x, int count,
                       iso_cap_block *block) {
    draw->kernel(row, x, count, block);
    for (int i = 0; i < count && !row->grid; i++) {
        const iso_vec3 place = {block->place[0][i], block->place[1][i], block->place[2][i]};
        block->value[i] = block->depth[i] < INFINITY ? value_at_index(s, place) : NAN;
    }
}

/* The nearest caps of solids that one plane cuts, of a block of samples. */
typedef struct plane_caps {
    double depth[ISO_CAP_BLOCK], value[ISO_CAP_BLOCK];
    const solid *solid[ISO_CAP_BLOCK]; /* NULL: there is none before what was drawn */
} plane_caps;

/* Nothing yet, before the depths of what was drawn, if anything was. */
static void begin_plane_caps(const float *drawn, int count, plane_caps *caps) {
    for (int i = 0; i < count; i++) {
        caps->depth[i] = drawn ? (double)drawn[i] : INFINITY;
        caps->solid[i] = NULL;
    }
}

/* Adds the caps of a solid where they are not behind. */
static void find_plane_caps(const solid *s, int count, const iso_cap_block *block, plane_caps *caps) {
    const double isovalue = s->isovalue;
    for (int i = 0; i < count; i++) {
        const double depth = block->depth[i], value = block->value[i];
        const bool inside = s->level_set ? value < isovalue : value >= isovalue; /* (NAN is not) */
        if (!inside || depth > caps->depth[i]) continue;
        if (depth == caps->depth[i] && caps->solid[i] && !is_inner(s, caps->solid[i])) continue;
        caps->depth[i] = depth;
        caps->value[i] = value;
        caps->solid[i] = s;
    }
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
            if (pieces[k].begin < f->depth || !f->solid || is_inner(s, f->solid)) {
                float normal[3];
                store_normal(draw->view, iso_clip_normal(s->input->clip, &pieces[k], point), normal);
                take_cap(draw, s, pieces[k].begin, normal, value, f);
                f->order = ISO_SLICES + k; /* the piece of the ray that begins here */
            }
            break;
        }
    }
}

/* ---- slices */

/* Where the ray of a sample meets a plane, in the world; false: nowhere in front of the eye. */
static bool meet_plane(const iso_view *view, const double plane[4], double x, double y, double *t,
                       iso_vec3 *point) {
    iso_vec3 origin, direction;
    iso_view_ray(view, x, y, &origin, &direction);
    const double slope = plane[0] * direction.x + plane[1] * direction.y + plane[2] * direction.z;
    *t = (plane[3] - (plane[0] * origin.x + plane[1] * origin.y + plane[2] * origin.z)) / slope;
    *point = iso_vec3_add(origin, iso_vec3_scale(direction, *t));
    return *t >= view->near && *t < INFINITY;
}

/* By how much a value changes from a place in a plane to where the ray of a sample meets it, by the slope at
 * the place; NAN: nowhere. */
static double change_to(const caps_draw *draw, const iso_slice *slice, double x, double y, iso_vec3 place,
                        iso_vec3 slope) {
    double t;
    iso_vec3 next;
    if (!meet_plane(draw->view, slice->plane, x, y, &t, &next)) return NAN;
    return iso_vec3_dot(slope, iso_vec3_sub(iso_affine_point_to_index(&draw->solids[0].affine, next), place));
}

/* Shows the slice where it is not behind what the sample shows. An outline is where the isovalue lies within
 * OUTLINE pixels, by how the value changes to the next samples. Only the cell of the place is read, so that
 * parts of a volume show what the whole one does. */
static void find_slice(const caps_draw *draw, int number, int x, int y, found *f) {
    const solid *first = &draw->solids[0];
    const iso_slice *slice = &draw->caps->slices[number];
    double t;
    iso_vec3 point, slope;
    if (!meet_plane(draw->view, slice->plane, x + 0.5, y + 0.5, &t, &point) || !(t <= f->depth)) return;
    const iso_vec3 place = iso_affine_point_to_index(&first->affine, point);
    const double p[3] = {place.x, place.y, place.z};
    for (int axis = 0; axis < 3; axis++)
        if (!(p[axis] >= first->first[axis] && p[axis] < first->end[axis])) return;
    const double value = iso_grid_sample_slope(&first->voxels, in_part(first, place), &slope);
    if (isnan(value)) return;
    *f = (found){.depth = t,
                 .solid = first,
                 .order = ISO_SLICES - 1 - number,
                 .color = color_of(&draw->caps->look, first, value)};
    const double across = change_to(draw, slice, x + 1.5, y + 0.5, place, slope),
                 down = change_to(draw, slice, x + 0.5, y + 1.5, place, slope),
                 reach = OUTLINE * draw->caps->factor,
                 square = reach * reach * (across * across + down * down);
    for (int i = 0; i < draw->caps->count; i++) {
        const solid *s = &draw->solids[i];
        const double from = value - s->isovalue;
        if (share_volume(s->input, first->input) && from * from < square) f->color = pack(s->input->color);
    }
}

/* ---- the gbuffer, or keys */

static bool is_lit(const found *f) {
    return f->normal[0] != 0 || f->normal[1] != 0 || f->normal[2] != 0;
}

static void keep_key(const caps_draw *draw, int x, int y, const found *f) {
    const float to_eye[3] = {-iso_slope_of_column(draw->view, x), -iso_slope_of_row(draw->view, y), -1};
    const iso_rgb color = {(uint8_t)f->color, (uint8_t)(f->color >> 8), (uint8_t)(f->color >> 16)};
    const uint32_t rgba = is_lit(f) ? iso_shade_pixel(f->normal, to_eye, color) : f->color;
    const uint64_t made = iso_key_of_cap(draw->in_front ? -INFINITY : f->depth, f->order, rgba);
    uint64_t *key = draw->keys + (size_t)y * (size_t)draw->view->width + (size_t)x;
    if (made < *key) *key = made;
}

static void write_sample(const caps_draw *draw, int x, int y, const found *f) {
    iso_gbuffer *gbuffer = draw->gbuffer;
    const size_t at = (size_t)y * (size_t)gbuffer->width + (size_t)x;
    gbuffer->depth[at] = (float)f->depth;
    for (int k = 0; k < 3; k++) gbuffer->normal[k][at] = f->normal[k];
    gbuffer->surface[at] = f->solid->input->surface;
    gbuffer->color[at] = f->color | ((uint32_t)f->solid->input->surface + 1) << 24;
}

/* The nearest caps of solids that one plane cuts; false: there are none. */
static bool find_all_plane_caps(const caps_draw *draw, const iso_cap_row *rows, const float *drawn, int x,
                                int count, plane_caps *caps) {
    iso_cap_block block;
    bool filled = false, any = false;
    for (int i = 0; i < draw->caps->count && draw->caps->caps; i++) {
        const solid *s = &draw->solids[i];
        filled &= s->same_plane;
        if (!s->by_plane || !may_be_inside(s, &rows[i], x, count)) continue;
        if (!filled) fill_block(draw, s, &rows[i], x, count, &block);
        if (!any) begin_plane_caps(drawn, count, caps);
        find_plane_caps(s, count, &block, caps);
        filled = any = true;
    }
    return any;
}

/* Draws samples of a row as draw_samples does, in vectors, if there is one solid that one plane cuts and
 * nothing else. Returns how many are done, from the first one on. */
static int paint_samples(const caps_draw *draw, const iso_cap_row *rows, int x, int y, int count) {
    const solid *s = &draw->solids[0];
    iso_cap_block block;
    if (!draw->painter) return 0;
    if (!may_be_inside(s, rows, x, count)) return count;
    fill_block(draw, s, rows, x, count, &block);
    const iso_gbuffer *g = draw->gbuffer;
    const size_t at = (size_t)y * (size_t)g->width + (size_t)x;
    const iso_cap_samples samples = {g->depth + at,
                                     {g->normal[0] + at, g->normal[1] + at, g->normal[2] + at},
                                     g->color + at,
                                     g->surface + at};
    return draw->painter(&block, count, &draw->paint, &samples);
}

/* Draws `count` samples of a row (at most ISO_CAP_BLOCK) from column x on. */
static void draw_samples(const caps_draw *draw, const iso_cap_row *rows, int x, int y, int count) {
    const float *drawn =
        draw->keys ? NULL : draw->gbuffer->depth + (size_t)y * (size_t)draw->gbuffer->width + (size_t)x;
    plane_caps caps;
    const bool any = find_all_plane_caps(draw, rows, drawn, x, count, &caps),
               more = draw->others || draw->caps->slice_count;
    for (int i = 0; i < count && (any || more); i++) {
        found f = {.depth = drawn ? (double)drawn[i] : INFINITY, .solid = NULL};
        if (any && caps.solid[i])
            take_cap(draw, caps.solid[i], caps.depth[i], caps.solid[i]->normal, caps.value[i], &f);
        if (draw->others) {
            iso_vec3 origin, direction;
            iso_view_ray(draw->view, x + i + 0.5, y + 0.5, &origin, &direction);
            find_cap(draw, origin, direction, &f);
        }
        for (int k = 0; k < draw->caps->slice_count; k++) find_slice(draw, k, x + i, y, &f);
        if (f.solid) draw->write(draw, x + i, y, &f);
    }
}

/* The columns in which there can be a cap of a solid that one plane cuts. */
static void limit_row(const caps_draw *draw, const iso_cap_row *rows, int *begin, int *end) {
    *begin = draw->area.columns.last + 1;
    *end = draw->area.columns.first;
    for (int i = 0; i < draw->caps->count; i++) {
        if (!draw->solids[i].by_plane || rows[i].begin >= rows[i].end) continue;
        if (rows[i].begin < *begin) *begin = rows[i].begin;
        if (rows[i].end > *end) *end = rows[i].end;
    }
}

static void draw_rows(void *context, size_t index, int worker) {
    const caps_draw *draw = context;
    iso_cap_row *rows = draw->rows + (size_t)worker * (size_t)draw->caps->count;
    const int first = draw->area.rows.first + (int)index * ROWS_PER_TASK;
    for (int y = first; y < first + ROWS_PER_TASK && y <= draw->area.rows.last; y++) {
        for (int i = 0; i < draw->caps->count; i++)
            if (draw->solids[i].by_plane)
                rows[i] = draw->solids[i].same_plane ? rows[i - 1]
                                                     : make_plane_row(&draw->solids[i], draw->view, y);
        int begin = draw->area.columns.first, end = draw->area.columns.last + 1;
        if (!draw->others && !draw->caps->slice_count) limit_row(draw, rows, &begin, &end);
        for (int x = begin; x < end; x += ISO_CAP_BLOCK) {
            const int count = end - x < ISO_CAP_BLOCK ? end - x : ISO_CAP_BLOCK;
            const int done = paint_samples(draw, rows, x, y, count);
            if (done < count) draw_samples(draw, rows, x + done, y, count - done);
        }
    }
}

static bool are_equal(const iso_clip *a, const iso_clip *b) {
    return a && b &&
           (a == b ||
            (a->count == b->count && memcmp(a->body, b->body, (size_t)a->count * sizeof *a->body) == 0));
}

static void prepare_solid(const caps_draw *draw, int i) {
    const iso_capped *input = &draw->caps->solids[i];
    solid *s = &draw->solids[i];
    *s = (solid){.input = input, .level_set = iso_grid_is_level_set(input->grid)};
    s->affine = iso_transform_affine(iso_grid_transform(input->grid));
    s->isovalue = iso_grid_stored(input->grid, input->isovalue);
    s->voxels = *input->grid;
    for (int axis = 0; axis < 3; axis++) {
        s->last[axis] = iso_grid_dims(input->grid)[axis] - 1;
        s->low[axis] = s->first[axis] = -ISO_CAP_SLACK;
        s->high[axis] = s->end[axis] = s->last[axis] + ISO_CAP_SLACK;
    }
    s->shows = draw->caps->shows && !input->plain;
    s->offset = iso_grid_physical(input->grid, 0);
    s->scale = iso_grid_scale(input->grid);
    s->by_plane = iso_clip_is_plane(input->clip);
    const bool same = i && are_equal(input->clip, draw->caps->solids[i - 1].clip);
    s->same_plane = same && s->by_plane && share_volume(input, &draw->caps->solids[i - 1]);
    s->same_clip = same && !s->by_plane;
    if (!s->by_plane) return;
    const iso_clip_piece piece = {0, INFINITY, 0, 0};
    store_normal(draw->view, iso_clip_normal(input->clip, &piece, input->clip->body[0].centre), s->normal);
}

/* Caps of neighbouring parts overlap by this much, voxels: a place that rounding moves across their border is
 * found in both. */
static const double OVERLAP = 1e-6;

static void keep_to_part(solid *s, const iso_cap_part *part) {
    s->voxels = part->grid;
    memcpy(s->origin, part->origin, sizeof s->origin);
    for (int axis = 0; axis < 3; axis++) {
        if (part->low[axis] > 0) {
            s->first[axis] = part->low[axis];
            s->low[axis] = part->low[axis] - OVERLAP;
        }
        if (part->high[axis] < s->last[axis]) {
            s->end[axis] = part->high[axis];
            s->high[axis] = part->high[axis] + OVERLAP;
        }
    }
}

/* Chooses the painter if there is one solid, which one plane cuts, and no map of colours. */
static void choose_painter(caps_draw *draw) {
    const solid *s = &draw->solids[0];
    const iso_slice_look *look = &draw->caps->look;
    if (draw->caps->count != 1 || !draw->caps->caps || draw->caps->slice_count || !s->by_plane) return;
    if (s->shows && !(look->map == ISO_COLORMAP_GRAY && look->low < look->high)) return;
    draw->paint = (iso_cap_paint){.isovalue = s->isovalue,
                                  .level_set = s->level_set,
                                  .shows = s->shows,
                                  .scale = s->scale,
                                  .offset = s->offset,
                                  .low = look->low,
                                  .high = look->high,
                                  .color = pack(s->input->color),
                                  .surface = ((uint32_t)s->input->surface + 1) << 24,
                                  .number = s->input->surface};
    if (!s->shows) memcpy(draw->paint.normal, s->normal, sizeof s->normal);
    draw->painter = ISO_KERNEL_UNIT(iso_cap_painter, iso_cpu_best());
}

bool iso_caps_are_in_front(const iso_cut_caps *caps) {
    bool planes = caps->caps && !caps->slice_count;
    for (int i = 0; i < caps->count; i++) {
        const iso_clip *clip = caps->solids[i].clip;
        planes &= !clip || !clip->count || iso_clip_is_plane(clip);
    }
    return planes;
}

/* Draws caps as `draw` says, in which all up to `area` and `write` are set. part: NULL: the whole volume is
 * there. */
static iso_status draw_caps(caps_draw *draw, const iso_cap_part *part, iso_pool *pool, iso_error *error) {
    const iso_cut_caps *caps = draw->caps;
    const size_t count = (size_t)caps->count, workers = (size_t)iso_pool_threads(pool);
    draw->kernel = ISO_KERNEL_UNIT(iso_cap_kernel, iso_cpu_best());
    draw->solids = iso_alloc(count * (sizeof *draw->solids + workers * sizeof *draw->rows));
    if (!draw->solids) return iso_fail(error, ISO_ERR_NOMEM, "out of memory for caps");
    draw->rows = (iso_cap_row *)(draw->solids + count);
    for (int i = 0; i < caps->count; i++) {
        prepare_solid(draw, i);
        if (part) keep_to_part(&draw->solids[i], part);
        const iso_clip *clip = caps->solids[i].clip;
        draw->others |= caps->caps && clip && clip->count && !draw->solids[i].by_plane;
    }
    if (draw->gbuffer) choose_painter(draw);
    const iso_rows rows = draw->area.rows;
    const size_t tasks = ((size_t)(rows.last - rows.first) + ROWS_PER_TASK) / ROWS_PER_TASK;
    iso_parallel_for(pool, tasks, draw_rows, draw);
    iso_free(draw->solids);
    return ISO_OK;
}

iso_status iso_caps_draw(const iso_cut_caps *caps, const iso_view *view, iso_gbuffer *gbuffer, iso_pool *pool,
                         iso_error *error) {
    if (!caps->count) return ISO_OK;
    ISO_TRY(iso_gbuffer_add_color(gbuffer, error));
    caps_draw draw = {.caps = caps,
                      .view = view,
                      .gbuffer = gbuffer,
                      .write = write_sample,
                      .area = {.columns = {0, gbuffer->width - 1}, .rows = {0, gbuffer->height - 1}}};
    return draw_caps(&draw, NULL, pool, error);
}

iso_status iso_caps_draw_keys(const iso_cut_caps *caps, const iso_cap_part *part, const iso_view *view,
                              iso_key_image *keys, iso_pool *pool, iso_error *error) {
    assert(caps->count == 1 && keys->height == ISO_KEY_PLANES * view->height);
    const iso_projector projector = iso_projector_make(view, iso_grid_transform(caps->solids[0].grid));
    const double *low = part->low, *high = part->high;
    const iso_box box = {{low[0] - ISO_CAP_SLACK, low[1] - ISO_CAP_SLACK, low[2] - ISO_CAP_SLACK},
                         {high[0] + ISO_CAP_SLACK, high[1] + ISO_CAP_SLACK, high[2] + ISO_CAP_SLACK}};
    caps_draw draw = {.caps = caps,
                      .view = view,
                      .keys = keys->keys + 2 * (size_t)view->width * (size_t)view->height,
                      .write = keep_key,
                      .in_front = iso_caps_are_in_front(caps),
                      .area = iso_projector_area(&projector, &box, 0)};
    return iso_area_is_empty(&draw.area) ? ISO_OK : draw_caps(&draw, part, pool, error);
}
