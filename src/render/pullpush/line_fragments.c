/* line_fragments: cuts segments into fragments, one for each pixel of the base level along the major axis. In
 * double precision and one at a time, so that they are the same in every band and strip. */
#include "render/pullpush/line_fragments.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"

/* The least square of a disc's axes, pixels^2: ribbons seen from their edges. */
static const double EDGE = 0.04;
/* A depth interval is as long as the depth changes in two pixels, but not longer than so many radii. */
static const double MOST_RADII = 16;
/* Ellipses are made longer as far as a line that curves leaves them by half of this, in its radii. */
static const double CURVE = 0.5;
/* Ellipses of ribbons are at least and at most so long along the line, in half, in pixels of the base level:
 * thin ribbons have no gaps between fragments, and a ribbon that twists leaves the plane of a longer one. */
static const double RIBBON_LENGTH[2] = {1.5, 4};
/* Discs' radii in pixels are limited to this. */
static const double MOST_PIXELS = 1e6;

/* ---- vertices */

typedef struct place {
    double at[3];    /* view space, mm */
    double radius;   /* mm */
    double n[3];     /* of ribbons: normal, view space */
    double color[3]; /* 0 .. 255 */
} place;

static void to_view(const iso_view *view, const float vector[3], double out[3]) {
    const iso_vec3 v =
        iso_view_vector(view, iso_vec3_make((double)vector[0], (double)vector[1], (double)vector[2]));
    out[0] = v.x, out[1] = v.y, out[2] = v.z;
}

static void place_vertex(const iso_line_frame *frame, size_t i, place *out) {
    const iso_pyramid_lines *set = frame->lines;
    const float *v = set->lines.vertices[i];
    const iso_vec3 world = iso_vec3_add(set->lines.origin,
                                        iso_vec3_make((double)v[0], (double)v[1], (double)v[2])),
                   at = iso_view_point(frame->view, world);
    out->at[0] = at.x, out->at[1] = at.y, out->at[2] = at.z;
    out->radius = (double)set->radii[i];
    out->n[0] = out->n[1] = out->n[2] = 0;
    if (set->opts.style == ISO_LINE_RIBBON) to_view(frame->view, set->lines.normals[i], out->n);
    for (int k = 0; k < 3; k++) out->color[k] = set->lines.colors ? set->lines.colors[i][k] : 0;
}

static double mix(double a, double b, double u) {
    return a + u * (b - a);
}

static place mix_places(const place *a, const place *b, double u) {
    place out = {.radius = mix(a->radius, b->radius, u)};
    for (int k = 0; k < 3; k++) {
        out.at[k] = mix(a->at[k], b->at[k], u);
        out.n[k] = mix(a->n[k], b->n[k], u);
        out.color[k] = mix(a->color[k], b->color[k], u);
    }
    return out;
}

/* ---- where lines are in the picture */

static double dot(const double a[3], const double b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* A pixel's size at a depth, mm. */
static double pixel_at(const iso_view *view, double z) {
    return view->orthographic ? 1 / view->focal : z / view->focal;
}

static double radius_at(const iso_line_frame *frame, const place *p) {
    return iso_max(p->radius, 0.5 * frame->lines->opts.min_pixels * pixel_at(frame->view, p->at[2]));
}

/* Adds a vertex of a segment to the box of a run in the picture: columns, rows, and the least depth. A
 * segment that reaches in front of the near plane can be anywhere. */
static void add_to_box(const iso_line_frame *frame, const place *p, double box[5], double radius[2]) {
    const iso_view *view = frame->view;
    const double z = p->at[2];
    box[4] = iso_min(box[4], z);
    if (!(z >= view->near)) {
        box[0] = box[2] = -INFINITY;
        box[1] = box[3] = INFINITY;
        radius[1] = MOST_PIXELS;
        return;
    }
    const double pixel = pixel_at(view, z), r = iso_min(radius_at(frame, p) / pixel, MOST_PIXELS);
    const double middle[2] = {view->cx, view->cy + view->above};
    for (int k = 0; k < 2; k++) {
        const double at = middle[k] + p->at[k] / pixel;
        box[2 * k] = iso_min(box[2 * k], at - r);
        box[2 * k + 1] = iso_max(box[2 * k + 1], at + r);
    }
    radius[0] = iso_min(radius[0], r);
    radius[1] = iso_max(radius[1], r);
}

typedef struct run_search {
    iso_line_frame *frame;
    float (*radius)[2]; /* of each run */
} run_search;

static void find_run(void *context, size_t index, int worker) {
    (void)worker;
    const run_search *search = context;
    iso_line_frame *frame = search->frame;
    const iso_pyramid_lines *set = frame->lines;
    const iso_view *view = frame->view;
    const size_t first = index * ISO_LINE_RUN, count = set->lines.vertex_count;
    double box[5] = {INFINITY, -INFINITY, INFINITY, -INFINITY, INFINITY}, radius[2] = {MOST_PIXELS, 0};
    for (size_t i = first; i < first + ISO_LINE_RUN && i < count; i++) {
        place p;
        if (!set->segments[i] && !(i > first && set->segments[i - 1])) continue;
        place_vertex(frame, i, &p);
        add_to_box(frame, &p, box, radius);
    }
    const size_t last = first + ISO_LINE_RUN;
    if (last < count && set->segments[last - 1]) {
        place p;
        place_vertex(frame, last, &p);
        add_to_box(frame, &p, box, radius);
    }
    const int height = view->above + view->height + view->below;
    const bool seen = box[1] >= 0 && box[0] <= view->width && box[3] >= 0 && box[2] <= height;
    const uint8_t level = iso_line_dropping_level(set, pixel_at(view, iso_max(box[4], view->near)));
    frame->rows[index] =
        seen ? (iso_line_rows){(float)box[2], (float)box[3], (float)box[4], (uint32_t)index, level}
             : (iso_line_rows){1, 0, INFINITY, (uint32_t)index, 0};
    search->radius[index][0] = seen ? (float)radius[0] : (float)MOST_PIXELS;
    search->radius[index][1] = seen ? (float)radius[1] : 0;
}

static int compare_rows(const void *a, const void *b) {
    const iso_line_rows *first = a, *second = b;
    if (first->depth != second->depth) return first->depth < second->depth ? -1 : 1;
    return first->run < second->run ? -1 : first->run > second->run;
}

/* Leaves out runs that are not seen, and sorts the others. */
static void sort_runs(iso_line_frame *frame) {
    size_t seen = 0;
    for (size_t i = 0; i < frame->runs; i++)
        if (frame->rows[i].lo <= frame->rows[i].hi) frame->rows[seen++] = frame->rows[i];
    frame->runs = seen;
    qsort(frame->rows, seen, sizeof *frame->rows, compare_rows);
}

iso_status iso_line_frame_make(const iso_pyramid_lines *lines, const iso_target *target,
                               iso_line_frame *frame, iso_error *error) {
    const size_t runs = (lines->lines.vertex_count + ISO_LINE_RUN - 1) / ISO_LINE_RUN;
    iso_line_frame made = {.lines = lines, .view = target->view, .runs = runs};
    made.rows = iso_alloc((runs + 1) * sizeof *made.rows);
    run_search search = {&made, iso_alloc((runs + 1) * sizeof *search.radius)};
    if (!made.rows || !search.radius) {
        iso_free(made.rows);
        iso_free(search.radius);
        return iso_fail_memory(error, "lines");
    }
    for (int k = 0; k < 9; k++) made.normal[k] = target->view->rotation[k % 3 * 3 + k / 3];
    iso_parallel_for(target->pool, runs, find_run, &search);
    made.radius[0] = (float)MOST_PIXELS;
    for (size_t i = 0; i < runs; i++) {
        made.radius[0] = fminf(made.radius[0], search.radius[i][0]);
        made.radius[1] = fmaxf(made.radius[1], search.radius[i][1]);
    }
    iso_free(search.radius);
    sort_runs(&made);
    *frame = made;
    return ISO_OK;
}

void iso_line_frame_free(iso_line_frame *frame) {
    iso_free(frame->rows);
    frame->rows = NULL;
}

/* ---- fragments */

/* What is the same for all fragments of a band. Columns and rows are those of the base level, from the guard
 * band of the whole picture on. */
typedef struct line_pen {
    const iso_line_frame *frame;
    const iso_pyramid *pyramid;
    const iso_pyramid_level *level;
    double focal, middle[2]; /* pixels per unit of x / z; the optical axis */
    int first_row, last_row; /* of the band */
    int rows_before;         /* the pyramid's first row */
} line_pen;

/* The part of the segment from a to b that is being drawn. */
typedef struct segment {
    place a, b;
    double direction[3];  /* unit, view space */
    double before, after; /* from a and b to the ends of the leg, mm */
    double length;        /* mm */
    size_t line;          /* of ribbons: the number of the line; tubes may go on in others, as trees' do */
    double curve;         /* radius of curvature, mm */
    bool flat[2];         /* the line ends there, and flat */
} segment;

static double project(const line_pen *pen, const place *p, int axis) {
    const double focal = pen->frame->view->orthographic ? pen->focal : pen->focal / p->at[2];
    return pen->middle[axis] + focal * p->at[axis];
}

/* The picture of a vector at a place, pixels of level 0. */
static void project_vector(const iso_view *view, const place *p, const double vector[3], double out[2]) {
    const double scale = 1 / pixel_at(view, p->at[2]);
    for (int k = 0; k < 2; k++)
        out[k] = scale * (vector[k] - (view->orthographic ? 0 : p->at[k] / p->at[2] * vector[2]));
}

static double normalise(double v[3]) {
    const double length = sqrt(dot(v, v));
    for (int k = 0; k < 3; k++) v[k] /= length > 0 ? length : 1;
    return length;
}

static void cross(const double a[3], const double b[3], double out[3]) {
    for (int k = 0; k < 3; k++) out[k] = a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3];
}

/* The half axes of a fragment's disc across and along the line, unit, and the part of the line's direction
 * that lies in the disc. Of a tube the disc faces the eye. */
static double make_axes(const iso_view *view, const segment *s, const place *p, bool ribbon, double across[3],
                        double along[3]) {
    double ray[3] = {0, 0, 1};
    if (ribbon) {
        cross(s->direction, p->n, across);
        normalise(across);
        memcpy(along, s->direction, 3 * sizeof *along);
        return 1;
    }
    for (int k = 0; k < 3 && !view->orthographic; k++) ray[k] = p->at[k];
    normalise(ray);
    cross(s->direction, ray, across);
    const double part = normalise(across);
    if (!(part > 1e-6)) { /* end on: any direction will do */
        const double other[3] = {fabs(ray[0]) < 0.5, fabs(ray[0]) >= 0.5, 0};
        cross(other, ray, across);
        normalise(across);
    }
    cross(ray, across, along);
    return part;
}

/* How far a line goes on from a place of a segment, to the nearer side, in the plane of its disc, mm, with
 * the disc at a round end; and half the length of the disc there. `part`: as made by make_axes. */
static double room_at(const segment *s, double u, double part, double radius, double *length) {
    const double rest[2] = {part * (s->before + u * s->length), part * (s->after + (1 - u) * s->length)};
    double room = iso_max(radius, sqrt(CURVE * radius * s->curve));
    *length = radius;
    for (int k = 0; k < 2; k++) {
        room = iso_min(room, rest[k] + (s->flat[k] ? 0 : radius));
        if (s->flat[k]) *length = iso_min(*length, rest[k]);
    }
    return room;
}

/* How far the nearer end of the leg is from a place of a segment, mm: less than 0 if it is where the leg
 * begins. */
static double nearer_end(const segment *s, double u) {
    const double before = s->before + u * s->length, after = s->after + (1 - u) * s->length;
    return before < after ? -iso_max(before, 1e-30) : after;
}

/* Half the length of a ribbon's ellipse, mm. length: of the disc; scale: pixels of a mm along the line. */
static double ribbon_length(const line_pen *pen, double length, double radius, double scale) {
    const double pixel = (1 << pen->pyramid->layout.base) / iso_max(scale, 1e-12);
    if (length == radius) length = iso_max(length, RIBBON_LENGTH[0] * pixel); /* no end is near */
    return iso_min(length, RIBBON_LENGTH[1] * pixel);
}

/* The ellipse of a fragment, and how it may be longer at coarser levels: the planes from SHAPE_XX to ROOM. */
static void make_shape(const line_pen *pen, const segment *s, const place *p, double u, double radius,
                       float shape[6]) {
    const iso_view *view = pen->frame->view;
    const bool ribbon = pen->frame->lines->opts.style == ISO_LINE_RIBBON;
    const double most = MOST_PIXELS * MOST_PIXELS;
    double axis[2][3], a[2], b[2], length;
    const double part = make_axes(view, s, p, ribbon, axis[0], axis[1]);
    const double room = room_at(s, u, part, radius, &length);
    project_vector(view, p, axis[0], a);
    project_vector(view, p, axis[1], b);
    const double size = b[0] * b[0] + b[1] * b[1]; /* of a unit along the line */
    if (ribbon) length = ribbon_length(pen, length, radius, sqrt(size));
    const double wide = radius * radius, tall = length * length;
    shape[0] = (float)iso_min(wide * a[0] * a[0] + tall * b[0] * b[0] + EDGE, most);
    shape[1] = (float)iso_max(iso_min(wide * a[0] * a[1] + tall * b[0] * b[1], most), -most);
    shape[2] = (float)iso_min(wide * a[1] * a[1] + tall * b[1] * b[1] + EDGE, most);
    shape[3] = (float)(size > 0 ? (b[0] * b[0] - b[1] * b[1]) / size : 0);
    shape[4] = (float)(size > 0 ? 2 * b[0] * b[1] / size : 0);
    shape[5] = (float)(ribbon ? iso_min(room * sqrt(size), MOST_PIXELS) : nearer_end(s, u));
}

/* Bits 0 .. 21 of a key's payload. `n` is in view space. */
static uint32_t pack_direction(const double m[9], const double n[3]) {
    iso_surfel surfel = {.position = {0}};
    for (int k = 0; k < 3; k++)
        surfel.normal[k] = (float)(m[3 * k] * n[0] + m[3 * k + 1] * n[1] + m[3 * k + 2] * n[2]);
    return (uint32_t)(iso_point_pack(&surfel).bits >> 42);
}

/* Makes the normal of a ribbon perpendicular to its segment; of a tube, the segment's direction takes its
 * place. */
static void correct_direction(const segment *s, bool ribbon, double n[3]) {
    const double along = dot(n, s->direction);
    if (!ribbon) {
        memcpy(n, s->direction, 3 * sizeof *n);
        return;
    }
    for (int k = 0; k < 3; k++) n[k] -= along * s->direction[k];
    if (normalise(n) > 1e-6) return;
    const double other[3] = {fabs(n[0]) < 0.5, fabs(n[0]) >= 0.5, 0};
    cross(other, s->direction, n);
    normalise(n);
}

static void write_planes(const line_pen *pen, const segment *s, const place *p, double u, size_t at) {
    const iso_view *view = pen->frame->view;
    float *const *plane = pen->level->plane;
    const double radius = radius_at(pen->frame, p), pixel = pixel_at(view, p->at[2]);
    double step[2];
    float shape[6];
    project_vector(view, p, s->direction, step);
    const double pixels = iso_max(fabs(step[0]), fabs(step[1])) / (1 << pen->pyramid->layout.base),
                 rise = fabs(s->direction[2]) / iso_max(pixels, 1e-12);
    make_shape(pen, s, p, u, iso_min(radius, MOST_PIXELS * pixel), shape);
    plane[ISO_PLANE_RADIUS][at] = (float)radius;
    plane[ISO_PLANE_INTERVAL][at] = (float)iso_min(iso_max(radius, 2 * rise), MOST_RADII * radius);
    for (int k = 0; k < 6; k++) plane[ISO_PLANE_SHAPE_XX + k][at] = shape[k];
    for (int k = 0; k < 3 && plane[ISO_PLANE_RED]; k++) plane[ISO_PLANE_RED + k][at] = (float)p->color[k];
    if (plane[ISO_PLANE_SET]) plane[ISO_PLANE_SET][at] = (float)pen->frame->set;
}

/* Bits 0 .. 31: normal, and place in the pixel. */
static int64_t key_payload(const double normal[9], const place *p, double x, double y) {
    const uint32_t column = (uint32_t)((x - floor(x)) * 32) & 31, row = (uint32_t)((y - floor(y)) * 32) & 31;
    return (int64_t)(pack_direction(normal, p->n) | column << 22 | row << 27);
}

/* Draws the fragment at u of a segment, at `x`, `y` of the base level. Its depth alone is computed first:
 * most fragments of dense lines are hidden. */
static void draw_fragment(const line_pen *pen, const segment *s, double u, double x, double y) {
    if (!(x >= 0 && x < pen->level->width && y >= pen->first_row && y < pen->last_row + 1.0)) return;
    const int column = (int)x, row = (int)y - pen->rows_before;
    const size_t there = (size_t)row * pen->pyramid->key_stride + (size_t)column;
    int64_t *key = pen->pyramid->keys + there;
    const int64_t depth = iso_key_of_depth((float)mix(s->a.at[2], s->b.at[2], u));
    if (depth >= *key) return;
    place p = mix_places(&s->a, &s->b, u);
    correct_direction(s, pen->frame->lines->opts.style == ISO_LINE_RIBBON, p.n);
    const int64_t made = depth + key_payload(pen->frame->normal, &p, x, y);
    if (made >= *key) return;
    *key = made;
    /* of lines alone the index has the line's number, until fragments are numbered (line_graph.h) */
    const bool alone = pen->pyramid->layout.planes >> ISO_PLANE_PLACE & 1;
    if (pen->pyramid->index)
        pen->pyramid->index[there] = alone ? (int32_t)(s->line & INT32_MAX) : ISO_INDEX_NONE;
    write_planes(pen, s, &p, u, (size_t)row * pen->level->stride + (size_t)column);
}

static void draw_end(const line_pen *pen, const segment *s, double u) {
    const place p = mix_places(&s->a, &s->b, u);
    draw_fragment(pen, s, u, project(pen, &p, 0), project(pen, &p, 1));
}

/* Cuts off what lies in front of the near plane. False: nothing is left. */
static bool clip_near(const iso_view *view, segment *s) {
    const double a = s->a.at[2] - view->near, b = s->b.at[2] - view->near;
    if (a < 0 && b < 0) return false;
    if (a >= 0 && b >= 0) return true;
    const place cut = mix_places(&s->a, &s->b, a / (a - b));
    const double left = s->length * (a < 0 ? b / (b - a) : a / (a - b));
    *(a < 0 ? &s->before : &s->after) += s->length - left;
    s->length = left;
    *(a < 0 ? &s->a : &s->b) = cut;
    (a < 0 ? &s->a : &s->b)->at[2] = view->near;
    return true;
}

/* A fragment at the middle of each column or row that the segment crosses, and one at its first vertex; at
 * the last one too if `last`. */
static void draw_segment(const line_pen *pen, segment *s, bool last) {
    const iso_view *view = pen->frame->view;
    for (int k = 0; k < 3; k++) s->direction[k] = s->b.at[k] - s->a.at[k];
    s->length = normalise(s->direction);
    if (!(s->length > 0)) s->direction[0] = 1;
    if (!clip_near(view, s)) return;
    const double a[2] = {project(pen, &s->a, 0), project(pen, &s->a, 1)},
                 b[2] = {project(pen, &s->b, 0), project(pen, &s->b, 1)};
    const double margin = 1;
    if (iso_max(a[1], b[1]) < pen->first_row - margin || iso_min(a[1], b[1]) > pen->last_row + 1 + margin)
        return;
    draw_fragment(pen, s, 0, a[0], a[1]);
    if (last) draw_end(pen, s, 1);
    const int axis = fabs(b[1] - a[1]) > fabs(b[0] - a[0]);
    const double lo = iso_min(a[axis], b[axis]), hi = iso_max(a[axis], b[axis]);
    const double low = axis ? pen->first_row : 0, high = axis ? pen->last_row : pen->level->width - 1;
    if (!(hi > lo) || !(lo <= high + 1 && hi >= low)) return;
    const int first = (int)iso_max(ceil(lo - 0.5), low), end = (int)iso_min(floor(hi - 0.5), high);
    for (int k = first; k <= end; k++) {
        const double part = (k + 0.5 - a[axis]) / (b[axis] - a[axis]), near = part * s->a.at[2],
                     u = view->orthographic ? part : near / ((1 - part) * s->b.at[2] + near);
        const double other = mix(a[!axis], b[!axis], part);
        draw_fragment(pen, s, u, axis ? other : k + 0.5, axis ? k + 0.5 : other);
    }
}

/* The line that has a vertex. */
static size_t line_of(const iso_lines *lines, size_t vertex) {
    size_t low = 0, high = lines->line_count; /* the line is one of low .. high - 1 */
    while (high - low > 1) {
        const size_t middle = low + (high - low) / 2;
        *(lines->starts[middle] <= vertex ? &low : &high) = middle;
    }
    return low;
}

/* Draws the segments of a run between the vertices that are not dropped at a level: those at which runs begin
 * and lines end never are. */
static void draw_run(const line_pen *pen, size_t run, uint8_t level) {
    const iso_pyramid_lines *set = pen->frame->lines;
    const size_t first = run * ISO_LINE_RUN, count = set->lines.vertex_count,
                 end = count - first < ISO_LINE_RUN ? count : first + ISO_LINE_RUN;
    const bool flat = set->opts.style == ISO_LINE_RIBBON || set->opts.caps == ISO_CAPS_FLAT;
    size_t line = line_of(&set->lines, first);
    place next; /* the last vertex that was placed */
    for (size_t i = first, to; i < end; i = to) {
        segment s;
        to = i + 1;
        if (!set->segments[i]) continue;
        while (set->lines.starts[line + 1] <= i) line++;
        s.line = set->opts.style == ISO_LINE_RIBBON ? line : 0;
        while (to < end && set->segments[to] && set->drop[to] <= level) to++;
        if (i == first || !set->segments[i - 1]) place_vertex(pen->frame, i, &next);
        s.a = next;
        place_vertex(pen->frame, to, &next);
        s.b = next;
        s.before = (double)set->before[i];
        s.after = (double)set->after[to - 1];
        s.curve = iso_min((double)set->curves[i], (double)set->curves[to]);
        s.flat[0] = flat && set->segments[i] & ISO_LINE_STARTS;
        s.flat[1] = flat && set->segments[to - 1] & ISO_LINE_STOPS;
        draw_segment(pen, &s, !set->segments[to]);
    }
}

void iso_line_fragments_project(const iso_line_frame *frame, const iso_pyramid *pyramid, iso_rows rows) {
    const iso_pyramid_layout *layout = &pyramid->layout;
    const iso_view *view = frame->view;
    const double pixel = 1.0 / (1 << layout->base);
    const int before = layout->rows_before >> layout->base;
    const line_pen pen = {.frame = frame,
                          .pyramid = pyramid,
                          .level = &pyramid->level[layout->base],
                          .focal = view->focal * pixel,
                          .middle = {(view->cx - layout->column) * pixel,
                                     (view->cy - layout->row + layout->rows_before) * pixel},
                          .first_row = before + rows.first,
                          .last_row = before + rows.last,
                          .rows_before = before};
    /* in rows of level 0 of the whole picture, with a pixel more on each side for rounding */
    const double top = (double)(pen.first_row << layout->base) - layout->guard - 2,
                 bottom = (double)((pen.last_row + 1) << layout->base) - layout->guard + 2;
    for (size_t run = 0; run < frame->runs; run++)
        if ((double)frame->rows[run].hi >= top && (double)frame->rows[run].lo <= bottom)
            draw_run(&pen, frame->rows[run].run, frame->rows[run].level);
}
