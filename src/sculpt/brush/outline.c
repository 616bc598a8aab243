/* Makes outlines from the samples of strokes, and finds the sides that a brick's voxels can see. */
#include "sculpt/brush/outline.h"

#include <math.h>
#include <string.h>

#include "base/memory.h"
#include "grids/hgrid.h"

/* Normals that differ by less than this are parallel. */
static const double PARALLEL = 1e-6;
/* How far from the apex lines may pass, and samples from the line through their neighbours. */
static const double APEX_MISS = 0.5, STRAIGHT = 1.0 / 16;

/* ---- the lines of the samples */

typedef struct line {
    iso_vec3 at, along; /* `along` is a unit vector, towards the viewer */
} line;

static iso_status read_line(const iso_outline_space *space, const iso_brush_image *image,
                            const iso_sample *sample, line *out, iso_error *error) {
    const iso_vec3 normal = iso_brush_image_direction(image, sample->normal);
    out->at = iso_affine_point_to_index(space->affine, iso_brush_image_point(image, sample->position));
    out->along =
        iso_vec3_unit(iso_vec3_scale(iso_affine_vector_to_index(space->affine, normal), space->spacing));
    return iso_vec3_length(out->along) > 0
               ? ISO_OK
               : iso_fail(error, ISO_ERR_USAGE, "a sample of an outline has a normal of length 0");
}

static double determinant(const double m[3][3]) {
    return m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) -
           m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
           m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
}

static double miss(const line *l, iso_vec3 apex) {
    return iso_vec3_length(iso_vec3_cross(iso_vec3_sub(apex, l->at), l->along));
}

/* Finds the point that is nearest to all lines, by least squares, relative to the first one's sample. */
static bool find_apex(const line *lines, size_t count, iso_vec3 *apex) {
    double m[3][3] = {{0}}, right[3] = {0}, found[3];
    for (size_t i = 0; i < count; i++) {
        const iso_vec3 from = iso_vec3_sub(lines[i].at, lines[0].at);
        const double d[3] = {lines[i].along.x, lines[i].along.y, lines[i].along.z},
                     p[3] = {from.x, from.y, from.z};
        for (int r = 0; r < 3; r++)
            for (int c = 0; c < 3; c++) {
                const double part = (r == c) - d[r] * d[c];
                m[r][c] += part;
                right[r] += part * p[c];
            }
    }
    const double all = determinant(m);
    if (!(fabs(all) > 0)) return false;
    for (int k = 0; k < 3; k++) {
        double with[3][3];
        memcpy(with, m, sizeof with);
        for (int r = 0; r < 3; r++) with[r][k] = right[r];
        found[k] = determinant(with) / all;
    }
    *apex = iso_vec3_add(lines[0].at, iso_vec3_make(found[0], found[1], found[2]));
    for (size_t i = 0; i < count; i++)
        if (!(miss(&lines[i], *apex) <= APEX_MISS)) return false;
    return true;
}

/* ---- the viewer's picture */

/* Where the viewer stands, and the axes of the picture: to the right, up, and towards the viewer. */
typedef struct picture {
    bool perspective;
    iso_vec3 from, right, up, back;
} picture;

static iso_status make_picture(const line *lines, size_t count, picture *view, iso_error *error) {
    iso_vec3 mean = {0, 0, 0};
    for (size_t i = 0; i < count; i++) mean = iso_vec3_add(mean, lines[i].along);
    view->back = iso_vec3_unit(mean);
    view->from = lines[0].at;
    view->perspective = false;
    for (size_t i = 0; i < count; i++) {
        const double along = iso_vec3_dot(lines[i].along, view->back);
        if (!(along > 0.01))
            return iso_fail(error, ISO_ERR_USAGE, "the normals of an outline point in opposite directions");
        view->perspective |= iso_vec3_length(iso_vec3_sub(lines[i].along, view->back)) > PARALLEL;
    }
    if (view->perspective && !find_apex(lines, count, &view->from))
        return iso_fail(error, ISO_ERR_USAGE,
                        "the normals of an outline are neither parallel nor do they meet in a point");
    for (size_t i = 0; i < count && view->perspective; i++)
        if (!(iso_vec3_dot(iso_vec3_sub(view->from, lines[i].at), view->back) > 0))
            return iso_fail(error, ISO_ERR_USAGE, "the normals of an outline meet behind it");
    const iso_vec3 b = view->back, other = fabs(b.x) <= fabs(b.y) && fabs(b.x) <= fabs(b.z)
                                               ? iso_vec3_make(1, 0, 0)
                                           : fabs(b.y) <= fabs(b.z) ? iso_vec3_make(0, 1, 0)
                                                                    : iso_vec3_make(0, 0, 1);
    view->right = iso_vec3_unit(iso_vec3_cross(other, b));
    view->up = iso_vec3_cross(b, view->right);
    return ISO_OK;
}

/* A corner of the path in the picture: with perspective at distance 1 from the viewer, and `deep` is how far
 * the sample is. */
typedef struct corner {
    double x, y, deep;
} corner;

static corner project(const picture *view, iso_vec3 at) {
    const iso_vec3 from = iso_vec3_sub(at, view->from);
    const double deep = view->perspective ? -iso_vec3_dot(from, view->back) : 1;
    return (corner){iso_vec3_dot(from, view->right) / deep, iso_vec3_dot(from, view->up) / deep, deep};
}

/* Whether b lies within STRAIGHT voxels of the line between a and c, and between them. */
static bool is_straight(const corner *a, const corner *b, const corner *c) {
    const double x = c->x - a->x, y = c->y - a->y, length = sqrt(x * x + y * y);
    const double along = (b->x - a->x) * x + (b->y - a->y) * y,
                 across = (b->x - a->x) * y - (b->y - a->y) * x;
    if (!(length > 0)) return false;
    return fabs(across) / length * b->deep < STRAIGHT && along >= 0 && along <= length * length;
}

static bool is_same(const corner *a, const corner *b) {
    const double x = b->x - a->x, y = b->y - a->y;
    return sqrt(x * x + y * y) * b->deep < STRAIGHT;
}

/* Leaves out corners that change the path by less than STRAIGHT: each from the line between those that are
 * kept beside it. */
static size_t simplify(corner *corners, size_t count) {
    size_t kept = 0, first = 0; /* of those since the last one that was kept */
    for (size_t i = 0; i < count; i++) {
        if (i == 0) {
            kept = 1;
            first = 1;
            continue;
        }
        const corner *next = &corners[(i + 1) % count];
        bool straight = i + 1 < count;
        for (size_t k = first; k <= i && straight; k++)
            straight = is_same(&corners[kept - 1], &corners[k]) ||
                       is_straight(&corners[kept - 1], &corners[k], next);
        if (straight && i - first < 64) continue;
        if (is_same(&corners[kept - 1], &corners[i])) continue;
        corners[kept++] = corners[i];
        first = i + 1;
    }
    while (kept > 1 && is_same(&corners[0], &corners[kept - 1])) kept--;
    return kept;
}

/* Whether all corners lie within STRAIGHT of one line. */
static bool is_thin(const corner *corners, size_t count) {
    size_t farthest = 0;
    double most = 0, across = 0;
    for (size_t i = 1; i < count; i++) {
        const double x = corners[i].x - corners[0].x, y = corners[i].y - corners[0].y;
        if (!(x * x + y * y > most)) continue;
        most = x * x + y * y;
        farthest = i;
    }
    const double x = corners[farthest].x - corners[0].x, y = corners[farthest].y - corners[0].y;
    for (size_t i = 1; i < count; i++)
        across = fmax(across, fabs((corners[i].x - corners[0].x) * y - (corners[i].y - corners[0].y) * x) *
                                  corners[i].deep);
    return !(across >= STRAIGHT * sqrt(most));
}

/* ---- sides */

/* Makes the function dot(position - from, direction). */
static iso_affine_function function_of(iso_vec3 direction, iso_vec3 from) {
    return (iso_affine_function){{direction.x, direction.y, direction.z, -iso_vec3_dot(direction, from)}};
}

static iso_vec3 in_space(const picture *view, double right, double up, double back) {
    return iso_vec3_add(iso_vec3_add(iso_vec3_scale(view->right, right), iso_vec3_scale(view->up, up)),
                        iso_vec3_scale(view->back, back));
}

/* The height of an edge above a position: that of the edge at the position's depth, less that of the
 * position. */
static iso_affine_function level_of(const picture *view, const corner *c) {
    iso_affine_function level = function_of(in_space(view, 0, -1, view->perspective ? -c->y : 0), view->from);
    if (!view->perspective) level.of[3] += c->y;
    return level;
}

static iso_outline_side make_side(const picture *view, const corner *a, const corner *b) {
    const double back = view->perspective ? -1 : 0, x = b->x - a->x, y = b->y - a->y;
    const iso_vec3 corner_a = in_space(view, a->x, a->y, back), corner_b = in_space(view, b->x, b->y, back),
                   edge_a = view->perspective ? iso_vec3_unit(corner_a) : iso_vec3_scale(view->back, -1),
                   edge_b = view->perspective ? iso_vec3_unit(corner_b) : edge_a,
                   way = in_space(view, x, y, 0), left = iso_vec3_unit(iso_vec3_cross(way, edge_a)),
                   from_a = view->perspective ? view->from : iso_vec3_add(view->from, corner_a),
                   from_b = view->perspective ? view->from : iso_vec3_add(view->from, corner_b);
    return (iso_outline_side){.plane = function_of(left, from_a),
                              .limit = {function_of(iso_vec3_cross(edge_a, left), from_a),
                                        function_of(iso_vec3_cross(left, edge_b), from_b)},
                              .level = {level_of(view, a), level_of(view, b)},
                              .rises = b->y > a->y};
}

static iso_status make_sides(const picture *view, corner *corners, size_t count, bool mirrored,
                             iso_outline *outline, iso_error *error) {
    if (outline->plane) {
        corners[1] = corners[count - 1];
        if (is_same(&corners[0], &corners[1]))
            return iso_fail(error, ISO_ERR_USAGE, "a line to trim by has no length");
        outline->count = 1;
        outline->side[0] = make_side(view, &corners[mirrored], &corners[!mirrored]);
        return ISO_OK;
    }
    count = simplify(corners, count);
    if (count < 3 || is_thin(corners, count))
        return iso_fail(error, ISO_ERR_USAGE, "an outline to trim by encloses nothing");
    if (count > ISO_OUTLINE_SIDES)
        return iso_fail(error, ISO_ERR_LIMIT, "an outline of %zu corners: at most %d", count,
                        ISO_OUTLINE_SIDES);
    for (size_t i = 0; i < count; i++)
        outline->side[outline->count++] = make_side(view, &corners[i], &corners[(i + 1) % count]);
    return ISO_OK;
}

static iso_status fill(const iso_outline_space *space, const iso_brush_image *image,
                       const iso_sample *samples, size_t count, line *lines, corner *corners,
                       iso_outline *outline, iso_error *error) {
    picture view;
    for (size_t i = 0; i < count; i++) ISO_TRY(read_line(space, image, &samples[i], &lines[i], error));
    ISO_TRY(make_picture(lines, count, &view, error));
    outline->pyramid = view.perspective;
    outline->depth = function_of(iso_vec3_scale(view.back, -1), view.from);
    for (size_t i = 0; i < count; i++) corners[i] = project(&view, lines[i].at);
    const bool mirrored = (image->mirrored & 1) ^ (image->mirrored >> 1 & 1) ^ (image->mirrored >> 2 & 1);
    return make_sides(&view, corners, count, mirrored, outline, error);
}

iso_status iso_outline_make(const iso_outline_space *space, iso_tool tool, const iso_brush_image *image,
                            const iso_sample *samples, size_t count, iso_outline *outline, iso_error *error) {
    const size_t least = tool == ISO_TOOL_TRIM_PLANE ? 2 : 3;
    *outline = (iso_outline){.plane = tool == ISO_TOOL_TRIM_PLANE, .inverted = tool == ISO_TOOL_CROP_LASSO};
    if (count < least)
        return iso_fail(error, ISO_ERR_USAGE, "%s: a stroke of %zu samples: it takes at least %zu",
                        iso_tool_name(tool), count, least);
    if (count > ISO_OUTLINE_SAMPLES)
        return iso_fail(error, ISO_ERR_LIMIT, "%s: a stroke of %zu samples: at most %d", iso_tool_name(tool),
                        count, ISO_OUTLINE_SAMPLES);
    line *lines = iso_alloc(count * sizeof *lines);
    corner *corners = iso_alloc(count * sizeof *corners);
    outline->side = iso_alloc(ISO_OUTLINE_SIDES * sizeof *outline->side);
    iso_status status = lines && corners && outline->side
                            ? fill(space, image, samples, count, lines, corners, outline, error)
                            : iso_fail(error, ISO_ERR_NOMEM, "out of memory for an outline");
    iso_free(lines);
    iso_free(corners);
    if (status != ISO_OK) iso_outline_free(outline);
    return status;
}

void iso_outline_free(iso_outline *outline) {
    iso_free(outline->side);
    *outline = (iso_outline){.side = NULL};
}

/* ---- distances */

static double value_of(const iso_affine_function *f, const double at[3]) {
    return f->of[0] * at[0] + f->of[1] * at[1] + f->of[2] * at[2] + f->of[3];
}

static double side_square(const iso_outline_side *side, const double at[3]) {
    const double plane = value_of(&side->plane, at),
                 beyond = fmax(0, -fmin(value_of(&side->limit[0], at), value_of(&side->limit[1], at)));
    return plane * plane + beyond * beyond;
}

/* Whether a line from the position to the right, in the picture, crosses a side. */
static bool is_crossed(const iso_outline_side *side, const double at[3]) {
    const bool first = value_of(&side->level[0], at) > 0, second = value_of(&side->level[1], at) > 0;
    return first != second && (value_of(&side->plane, at) > 0) == side->rises;
}

double iso_outline_distance(const iso_outline *outline, const double at[3]) {
    if (outline->plane) return value_of(&outline->side[0].plane, at);
    double least = INFINITY;
    bool within = false;
    for (int i = 0; i < outline->count; i++) {
        least = fmin(least, side_square(&outline->side[i], at));
        within ^= is_crossed(&outline->side[i], at);
    }
    if (outline->pyramid && value_of(&outline->depth, at) <= 0) within = false;
    return within != outline->inverted ? -sqrt(least) : sqrt(least);
}

/* ---- bricks */

/* The lowest and highest value in a brick whose middle is at `middle`. */
static void find_range(const iso_affine_function *f, const double middle[3], double *low, double *high) {
    const double half = 0.5 * (ISO_BRICK - 1) + 0.001, at = value_of(f, middle),
                 reach = half * (fabs(f->of[0]) + fabs(f->of[1]) + fabs(f->of[2]));
    *low = at - reach;
    *high = at + reach;
}

/* Whether the sign of a function may differ between voxels; if not, *positive is it. */
static bool is_mixed(const iso_affine_function *f, const double middle[3], bool *positive) {
    double low, high;
    find_range(f, middle, &low, &high);
    *positive = low > 0;
    return low <= 0 && high > 0;
}

/* Decides whether a side is crossed alike from all voxels: returns true, and *crossed. */
static bool is_crossed_alike(const iso_outline_side *side, const double middle[3], bool *crossed) {
    bool first, second, left;
    *crossed = false;
    if (is_mixed(&side->level[0], middle, &first) || is_mixed(&side->level[1], middle, &second)) return false;
    if (first == second) return true;
    if (is_mixed(&side->plane, middle, &left)) return false;
    *crossed = left == side->rises;
    return true;
}

static void to_local(const iso_affine_function *f, const double first[3], float out[4]) {
    for (int k = 0; k < 3; k++) out[k] = (float)f->of[k];
    out[3] = (float)value_of(f, first);
}

void iso_outline_localize(const iso_outline *outline, const int brick[3], iso_local_outline *local) {
    const double reach = sqrt(3) * (ISO_BRICK - 1) + 0.01; /* across the brick */
    double first[3], middle[3], nearest = INFINITY, low, high;
    for (int k = 0; k < 3; k++) {
        first[k] = ISO_BRICK * (double)brick[k];
        middle[k] = first[k] + 0.5 * (ISO_BRICK - 1);
    }
    local->plane = outline->plane;
    local->inverted = outline->inverted;
    local->within = false;
    local->count = 0;
    to_local(&outline->depth, first, local->depth);
    find_range(&outline->depth, middle, &low, &high);
    local->pyramid = outline->pyramid && low <= 0;
    for (int i = 0; i < outline->count; i++)
        nearest = fmin(nearest, sqrt(side_square(&outline->side[i], middle)));
    for (int i = 0; i < outline->count; i++) {
        const iso_outline_side *side = &outline->side[i];
        iso_local_side *out = &local->side[local->count];
        bool crossed = false;
        out->near = outline->plane || sqrt(side_square(side, middle)) <= nearest + reach;
        out->crossed = !outline->plane && !is_crossed_alike(side, middle, &crossed);
        local->within ^= crossed;
        if (!out->near && !out->crossed) continue;
        to_local(&side->plane, first, out->plane);
        for (int k = 0; k < 2; k++) {
            to_local(&side->limit[k], first, out->limit[k]);
            to_local(&side->level[k], first, out->level[k]);
        }
        out->rises = side->rises;
        local->count++;
    }
}
