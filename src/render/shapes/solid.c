/* solid: the map from a glyph's unit solid to its place, and the exact box and the nearest depth that the
 * glyph has in the picture, in double precision. */
#include "render/shapes/solid.h"

#include <float.h>
#include <math.h>

/* No half axis is shorter than this part of the longest, so that flat ellipsoids and boxes keep a volume. */
static const double THINNEST = 1e-4;

static double dot(const double a[3], const double b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void cross(const double a[3], const double b[3], double out[3]) {
    out[0] = a[1] * b[2] - a[2] * b[1];
    out[1] = a[2] * b[0] - a[0] * b[2];
    out[2] = a[0] * b[1] - a[1] * b[0];
}

/* ---- what a glyph's numbers mean */

/* Sets two vectors of the given length, perpendicular to `along` and to each other. */
static void across(const double along[3], double length, double first[3], double second[3]) {
    const double x = fabs(along[0]), y = fabs(along[1]), z = fabs(along[2]);
    const int least = x <= y && x <= z ? 0 : y <= z ? 1 : 2;
    double unit[3] = {0};
    unit[least] = 1;
    cross(along, unit, first);
    cross(along, first, second);
    const double a = length / sqrt(dot(first, first)), b = length / sqrt(dot(second, second));
    for (int i = 0; i < 3; i++) first[i] *= a, second[i] *= b;
}

static double radius_of(const iso_shapes *set, uint32_t id, double length) {
    if (set->radii) return (double)set->radii[id] * set->scale;
    if (set->radius > 0) return set->radius * set->scale;
    return length * iso_solid_radius_ratio(set->glyph);
}

/* Sets the map of a glyph that has a direction: arrows, cones and cylinders lie along it, discs across it.
 * Returns false if nothing is drawn. */
static bool directed_map(const iso_shapes *set, uint32_t id, iso_solid_map *m) {
    double along[3];
    for (int a = 0; a < 3; a++) along[a] = (double)set->directions[id][a] * set->scale;
    const double length = sqrt(dot(along, along)), radius = radius_of(set, id, length);
    if (!(length > 0 && isfinite(length) && radius > 0 && isfinite(radius))) return false;
    const bool disc = set->glyph == ISO_GLYPH_DISC;
    for (int a = 0; a < 3; a++) {
        m->axis[2][a] = disc ? along[a] * (radius / length) : along[a] / 2;
        m->centre[a] = disc ? 0 : along[a] / 2;
    }
    across(along, radius, m->axis[0], m->axis[1]);
    return true;
}

/* Makes an axis perpendicular to the others with the least length. */
static void thicken(iso_solid_map *m, int axis, double length) {
    double *thin = m->axis[axis], *a = m->axis[(axis + 1) % 3], *b = m->axis[(axis + 2) % 3];
    double other[3];
    if (dot(a, a) < dot(b, b)) a = b, b = m->axis[(axis + 1) % 3];
    cross(a, b, thin);
    if (!(dot(thin, thin) > 0)) across(a, 1, thin, other);
    const double scale = length / sqrt(dot(thin, thin));
    for (int i = 0; i < 3; i++) thin[i] *= scale;
}

/* Sets the map of an ellipsoid or a box, which has three axes. Returns false if nothing is drawn. */
static bool axes_map(const iso_shapes *set, uint32_t id, iso_solid_map *m) {
    double longest = 0, product = 1;
    const double radius = set->axes ? 0 : radius_of(set, id, 0);
    for (int i = 0; i < 3; i++) {
        for (int a = 0; a < 3; a++)
            m->axis[i][a] = set->axes ? (double)set->axes[id][3 * i + a] * set->scale : i == a ? radius : 0;
        const double length = sqrt(dot(m->axis[i], m->axis[i]));
        if (!isfinite(length)) return false;
        longest = length > longest ? length : longest;
    }
    for (int i = 0; i < 3; i++) {
        if (!(dot(m->axis[i], m->axis[i]) >= THINNEST * longest * (THINNEST * longest)))
            thicken(m, i, THINNEST * longest);
        product *= sqrt(dot(m->axis[i], m->axis[i]));
    }
    double normal[3];
    cross(m->axis[0], m->axis[1], normal);
    return longest > 0 && fabs(dot(normal, m->axis[2])) > 1e-6 * product;
}

bool iso_solid_map_of(const iso_shapes *set, uint32_t id, iso_solid_map *m) {
    *m = (iso_solid_map){0};
    return iso_solid_is_directed(set->glyph) ? directed_map(set, id, m) : axes_map(set, id, m);
}

double iso_solid_extent(iso_glyph glyph, const iso_solid_map *m) {
    double square[3], length[3];
    for (int i = 0; i < 3; i++) {
        square[i] = dot(m->axis[i], m->axis[i]);
        length[i] = sqrt(square[i]);
    }
    if (glyph == ISO_GLYPH_BOX) return length[0] + length[1] + length[2];
    if (glyph == ISO_GLYPH_DISC) return length[0];
    /* The axes may have any directions: the square root of the trace of the map times its transpose. */
    if (glyph == ISO_GLYPH_ELLIPSOID) return sqrt(square[0] + square[1] + square[2]);
    return 2 * length[2] + length[0];
}

double iso_solid_reach(const iso_shapes *shapes, uint32_t id) {
    iso_solid_map m;
    if (iso_shapes_kind(shapes) != ISO_SHAPE_SPHERE)
        return iso_solid_map_of(shapes, id, &m) ? iso_solid_extent(shapes->glyph, &m) : 0;
    const double radius = (double)iso_shapes_radius(shapes, id);
    return radius > 0 && isfinite(radius) ? radius : 0;
}

/* ---- the box in the picture */

/* Slopes x / z (or mm, in parallel views) of a box, and the depth of its front. */
typedef struct bounds {
    double low[2], high[2], front;
} bounds;

/* Enlarges the bounds by an ellipsoid in view space: its centre, and the images of up to three unit vectors
 * (fewer for a disc or a point). The tangent planes through the eye, x = k z, touch it where the quadratic in
 * k below is 0. */
static void add_ellipsoid(bounds *b, const double centre[3], const double (*axes)[3], int count,
                          bool parallel) {
    double depth = 0;
    for (int i = 0; i < count; i++) depth += axes[i][2] * axes[i][2];
    b->front = fmin(b->front, centre[2] - sqrt(depth));
    for (int a = 0; a < 2; a++) {
        double wide = 0, mixed = 0;
        for (int i = 0; i < count; i++) wide += axes[i][a] * axes[i][a], mixed += axes[i][a] * axes[i][2];
        double middle = centre[a], half = sqrt(wide);
        if (!parallel) {
            const double scale = centre[2] * centre[2] - depth, k = centre[a] / centre[2];
            /* relative to the slope of the centre, for precision far from the eye */
            const double p = mixed - k * depth, q = wide - 2 * k * mixed + k * k * depth;
            half = sqrt(fmax(p * p + q * scale, 0)) / scale;
            middle = k - p / scale;
        }
        b->low[a] = fmin(b->low[a], middle - half);
        b->high[a] = fmax(b->high[a], middle + half);
    }
}

/* Enlarges the bounds by the image of a circle around the local z axis; radius 0: a point. */
static void add_circle(bounds *b, const double centre[3], const double (*axis)[3], double z, double radius,
                       bool parallel) {
    double at[3], axes[2][3];
    for (int a = 0; a < 3; a++) {
        at[a] = centre[a] + z * axis[2][a];
        for (int i = 0; i < 2; i++) axes[i][a] = radius * axis[i][a];
    }
    add_ellipsoid(b, at, (const double(*)[3])axes, radius > 0 ? 2 : 0, parallel);
}

static void add_corners(bounds *b, const double centre[3], const double (*axis)[3], bool parallel) {
    for (int corner = 0; corner < 8; corner++) {
        double at[3];
        for (int a = 0; a < 3; a++) {
            at[a] = centre[a];
            for (int i = 0; i < 3; i++) at[a] += corner >> i & 1 ? axis[i][a] : -axis[i][a];
        }
        add_ellipsoid(b, at, NULL, 0, parallel);
    }
}

static bounds bounds_of(iso_glyph glyph, const double centre[3], const double (*axis)[3], bool parallel) {
    bounds b = {{INFINITY, INFINITY}, {-INFINITY, -INFINITY}, INFINITY};
    if (glyph == ISO_GLYPH_ELLIPSOID) add_ellipsoid(&b, centre, axis, 3, parallel);
    if (glyph == ISO_GLYPH_BOX) add_corners(&b, centre, axis, parallel);
    if (glyph == ISO_GLYPH_DISC) add_circle(&b, centre, axis, 0, 1, parallel);
    if (glyph == ISO_GLYPH_CYLINDER) add_circle(&b, centre, axis, 1, 1, parallel);
    if (glyph == ISO_GLYPH_CYLINDER || glyph == ISO_GLYPH_CONE) add_circle(&b, centre, axis, -1, 1, parallel);
    if (glyph == ISO_GLYPH_CONE || glyph == ISO_GLYPH_ARROW) add_circle(&b, centre, axis, 1, 0, parallel);
    if (glyph != ISO_GLYPH_ARROW) return b;
    add_circle(&b, centre, axis, -1, ISO_ARROW_SHAFT, parallel);
    add_circle(&b, centre, axis, ISO_ARROW_NECK, 1, parallel);
    return b;
}

/* A billboard is a parallel projection, scaled by the depth of the glyph's centre. */
static bounds billboard_bounds(iso_glyph glyph, const double centre[3], const double (*axis)[3]) {
    bounds b = bounds_of(glyph, centre, axis, true);
    for (int a = 0; a < 2; a++) {
        b.low[a] /= centre[2];
        b.high[a] /= centre[2];
    }
    return b;
}

/* ---- placing */

void iso_solid_invert(const double axis[3][3], double inverse[3][3]) {
    for (int i = 0; i < 3; i++) cross(axis[(i + 1) % 3], axis[(i + 2) % 3], inverse[i]);
    const double determinant = dot(inverse[0], axis[0]);
    for (int i = 0; i < 3; i++)
        for (int a = 0; a < 3; a++) inverse[i][a] /= determinant;
}

iso_solid_placed iso_solid_in_view(const iso_shapes_frame *frame, const iso_solid_map *m,
                                   const double position[3]) {
    const double *r = frame->rotation;
    double middle[3];
    iso_solid_placed p;
    for (int a = 0; a < 3; a++) middle[a] = position[a] + m->centre[a];
    iso_shapes_to_view(frame, middle, p.centre);
    for (int i = 0; i < 3; i++)
        for (int a = 0; a < 3; a++)
            p.axis[i][a] =
                r[3 * a] * m->axis[i][0] + r[3 * a + 1] * m->axis[i][1] + r[3 * a + 2] * m->axis[i][2];
    iso_solid_invert((const double(*)[3])p.axis, p.inverse);
    return p;
}

/* Sets the first and the last pixel whose centre is in a range of slopes, with a margin for rounding. */
static void pixels_of(const iso_shapes_frame *frame, const bounds *b, int axis, int *first, int *last) {
    const double at = axis ? frame->cy : frame->cx,
                 margin = 1e-3 + 4e-6 * frame->focal * (b->high[axis] - b->low[axis]);
    const double low = at + frame->focal * b->low[axis] - 0.5 - margin,
                 high = at + frame->focal * b->high[axis] - 0.5 + margin;
    *first = low > -FLT_MAX && low > INT32_MIN / 2 ? (int)ceil(fmin(low, INT32_MAX / 2)) : INT32_MIN / 2;
    *last = high < INT32_MAX / 2 ? (int)floor(fmax(high, INT32_MIN / 2)) : INT32_MAX / 2;
}

/* Sets the box in pixels, clipped to `limit`. Returns false if nothing of it is left. */
static bool clip(const iso_shapes_frame *frame, const iso_shapes_rect *limit, const bounds *b,
                 iso_shapes_rect *r) {
    pixels_of(frame, b, 0, &r->x0, &r->x1);
    pixels_of(frame, b, 1, &r->y0, &r->y1);
    r->x0 = r->x0 > limit->x0 ? r->x0 : limit->x0;
    r->y0 = r->y0 > limit->y0 ? r->y0 : limit->y0;
    r->x1 = r->x1 < limit->x1 ? r->x1 : limit->x1;
    r->y1 = r->y1 < limit->y1 ? r->y1 : limit->y1;
    return r->x0 <= r->x1 && r->y0 <= r->y1;
}

static void add_to_chunk(iso_shapes_bin *bin, const iso_solid_placed *p, const iso_shapes_rect *r,
                         float nearest, uint32_t id) {
    const iso_shapes_frame *frame = bin->frame;
    iso_shapes_chunk *c = &bin->chunk;
    const double w = frame->parallel ? 1 : p->centre[2], u = p->centre[0] / w, v = p->centre[1] / w;
    const double x = frame->cx + frame->focal * u, y = frame->cy + frame->focal * v;
    const int i = c->count++;
    c->x0[i] = r->x0, c->y0[i] = r->y0, c->x1[i] = r->x1, c->y1[i] = r->y1;
    c->nearest[i] = nearest;
    c->pixel_x[i] = (int32_t)floor(x);
    c->pixel_y[i] = (int32_t)floor(y);
    c->id[i] = (int32_t)id;
    c->flags[i] = 0;
    c->field[ISO_FIELD_X][i] = (float)(x - c->pixel_x[i]);
    c->field[ISO_FIELD_Y][i] = (float)(y - c->pixel_y[i]);
    c->field[ISO_FIELD_Z][i] = (float)p->centre[2];
    for (int a = 0; a < 3; a++) {
        const double *row = p->inverse[a];
        c->field[ISO_FIELD_UNIT_X + a][i] = (float)row[0];
        c->field[ISO_FIELD_UNIT_Y + a][i] = (float)row[1];
        c->field[ISO_FIELD_UNIT_RAY + a][i] =
            (float)(frame->spread == 0 ? row[2] : u * row[0] + v * row[1] + row[2]);
    }
}

iso_near_shape iso_solid_near(const iso_shapes_frame *frame, const iso_solid_placed *p, uint32_t id) {
    iso_near_shape shape = {.nearest = frame->near, .id = id, .kind = ISO_SHAPE_SOLID};
    for (int a = 0; a < 3; a++) {
        shape.end[0][a] = p->centre[a];
        for (int i = 0; i < 3; i++) shape.inverse[i][a] = p->inverse[i][a];
    }
    return shape;
}

/* Whether the sphere around a glyph's position is in the bin and in front of what the bin shows. */
static bool may_be_seen(const iso_shapes_bin *bin, const double view[3], double reach) {
    const iso_shapes_frame *frame = bin->frame;
    const double front = view[2] - reach, margin = 1e-6 * (fabs(view[2]) + reach);
    if (view[2] + reach + margin < frame->near) return false;
    if (!frame->parallel && !(front > 0.1 * reach)) return true;
    bounds b = {{INFINITY, INFINITY}, {-INFINITY, -INFINITY}, INFINITY};
    const double axes[3][3] = {{reach, 0, 0}, {0, reach, 0}, {0, 0, reach}};
    iso_shapes_rect r;
    add_ellipsoid(&b, view, axes, 3, frame->parallel);
    return clip(frame, &bin->rect, &b, &r) && !bin->kernel->hidden(bin, &r, (float)(front - margin));
}

/* Sets `position` to that of a glyph, relative to the set's origin. */
static void position_of(const iso_shapes *set, const iso_shapes_block *block, uint32_t place, double out[3]) {
    out[0] = (double)block->origin[0] + (double)set->x[place];
    out[1] = (double)block->origin[1] + (double)set->y[place];
    out[2] = (double)block->origin[2] + (double)set->z[place];
}

bool iso_solid_fits(const iso_shapes_frame *frame, const iso_solid_placed *p, double depth, double reach) {
    const double w = frame->parallel ? 1 : p->centre[2], column = frame->focal * p->centre[0] / w,
                 row = frame->focal * p->centre[1] / w;
    return iso_near_fits(frame, depth - reach, reach) && fabs(column) < 1 << 20 && fabs(row) < 1 << 20;
}

static bounds placed_bounds(const iso_shapes_frame *frame, const iso_solid_placed *p) {
    const iso_shapes *set = frame->shapes;
    const double(*axis)[3] = (const double(*)[3])p->axis;
    return set->billboards && !frame->parallel ? billboard_bounds(set->glyph, p->centre, axis)
                                               : bounds_of(set->glyph, p->centre, axis, frame->parallel);
}

/* A depth that no sample is nearer than, rounding included. */
static double nearest_of(const bounds *b, double reach) {
    return b->front - 1e-5 * reach - 1e-6 * fabs(b->front);
}

void iso_solid_add(iso_shapes_bin *bin, const iso_shapes_block *block, uint32_t index) {
    const iso_shapes_frame *frame = bin->frame;
    const iso_shapes *set = frame->shapes;
    const uint32_t id = iso_shapes_id(set, index);
    double position[3], view[3];
    iso_solid_map m;
    position_of(set, block, index, position);
    iso_shapes_to_view(frame, position, view);
    /* The block's reach is tested first, because most glyphs of a large set are hidden. */
    if (!may_be_seen(bin, view, (double)block->reach) || !iso_solid_map_of(set, id, &m)) return;
    const iso_solid_placed p = iso_solid_in_view(frame, &m, position);
    const double reach = iso_solid_extent(set->glyph, &m);
    if (!iso_solid_fits(frame, &p, view[2], reach)) {
        const iso_near_shape shape = iso_solid_near(frame, &p, id);
        iso_near_draw(bin, &shape);
        return;
    }
    const bounds b = placed_bounds(frame, &p);
    const float nearest = (float)nearest_of(&b, reach);
    iso_shapes_rect r;
    if (clip(frame, &bin->rect, &b, &r) && !bin->kernel->hidden(bin, &r, nearest))
        add_to_chunk(bin, &p, &r, nearest, id);
}

/* ---- for rays in double precision */

bool iso_solid_place(const iso_shapes_frame *frame, const iso_shapes_block *block, uint32_t index,
                     const iso_shapes_rect *limit, iso_near_shape *shape, iso_shapes_rect *rect,
                     bool *billboard) {
    const iso_shapes *set = frame->shapes;
    double position[3], view[3];
    iso_solid_map m;
    position_of(set, block, index, position);
    iso_shapes_to_view(frame, position, view);
    if (!iso_solid_map_of(set, iso_shapes_id(set, index), &m)) return false;
    const double reach = iso_solid_extent(set->glyph, &m);
    if (view[2] + reach < frame->near) return false;
    const iso_solid_placed p = iso_solid_in_view(frame, &m, position);
    const bool small = iso_solid_fits(frame, &p, view[2], reach);
    *shape = iso_solid_near(frame, &p, iso_shapes_id(set, index));
    *billboard = small && set->billboards && !frame->parallel;
    *rect = *limit;
    if (!small) return true;
    const bounds b = placed_bounds(frame, &p);
    shape->nearest = fmax(shape->nearest, nearest_of(&b, reach));
    return clip(frame, limit, &b, rect);
}
