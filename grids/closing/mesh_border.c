/* Finds the winding numbers in the faces of the box, as mesh_border.h describes. The number at a point of a
 * face is found by counting the open edges between a side of the face and the point. A constant for each face
 * follows from its neighbours, because numbers do not change across the edges of the box. */
#include "grids/closing/mesh_border.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/numbers.h"

/* MOST_ROWS: the largest number of rows into which the edges of a face are sorted (for speed only);
 * ROW_EDGES: see rows_for; SAMPLES: samples along each side of a face for finding its smallest number. */
enum { FACES = 6, MOST_ROWS = 1024, SAMPLES = 256, ROW_EDGES = 4 };

/* An open edge in the coordinates of a face, directed as in its triangle. */
typedef struct flat_edge {
    double a[2], b[2];
} flat_edge;

/* A change of the winding number along a side of a face: beyond coordinate `at` the number is larger by `by`.
 * In a complete list, `by` is the sum of this change and all before it. */
typedef struct jump {
    double at;
    int by;
} jump;

typedef struct jumps {
    jump *list; /* owned, ascending */
    size_t count;
} jumps;

/* A face of the box. `u` and `v` are the axes of its coordinates, and u x v points out of the box. Seen from
 * outside, the winding number on the right of an open edge is one more than on its left. */
struct iso_border_face {
    int axis, u, v;
    double plane, lo[2], hi[2];
    flat_edge *edges;
    size_t count, room;
    int first;           /* the winding number beside the corner (lo, lo) */
    jumps left, right;   /* where the winding number changes along v, just inside u = lo and u = hi */
    jumps bottom, top;   /* where it changes along u, just inside v = lo and v = hi */
    uint32_t *row_edges; /* for each row (a range of v), the edges that reach into it */
    size_t *row_first;   /* rows + 1 indices into row_edges */
    size_t rows;
};

void iso_border_init(iso_border *border, const iso_triangles *mesh) {
    double longest = 0, largest = 0;
    *border = (iso_border){{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}, 0, NULL};
    for (int axis = 0; axis < 3; axis++) {
        for (size_t i = 0; i < 3 * mesh->triangle_count; i++) {
            const double p = (double)mesh->vertices[mesh->triangles[i / 3][i % 3]][axis];
            border->lo[axis] = fmin(border->lo[axis], p);
            border->hi[axis] = fmax(border->hi[axis], p);
        }
        longest = fmax(longest, border->hi[axis] - border->lo[axis]);
        largest = fmax(largest, fmax(fabs(border->lo[axis]), fabs(border->hi[axis])));
    }
    border->near = 1e-6 * longest +
                   0x1p-21 * largest; /* the second term is the rounding of positions, which are floats */
}

static void free_faces(iso_border_face *faces) {
    for (int f = 0; faces && f < FACES; f++) {
        iso_free(faces[f].edges);
        iso_free(faces[f].left.list);
        iso_free(faces[f].right.list);
        iso_free(faces[f].bottom.list);
        iso_free(faces[f].top.list);
        iso_free(faces[f].row_edges);
        iso_free(faces[f].row_first);
    }
    iso_free(faces);
}

void iso_border_free(iso_border *border) {
    free_faces(border->faces);
    *border = (iso_border){0};
}

/* ---- assigning edges to faces */

/* Returns the face in which an edge lies, the first one if there are two; -1: none. Faces 0, 2, 4 are at lo,
 * 1, 3, 5 at hi. */
static int face_of(const iso_border *border, const float a[3], const float b[3]) {
    for (int f = 0; f < FACES; f++) {
        const int axis = f / 2;
        const double plane = f % 2 ? border->hi[axis] : border->lo[axis];
        if (fabs((double)a[axis] - plane) <= border->near && fabs((double)b[axis] - plane) <= border->near)
            return f;
    }
    return -1;
}

bool iso_border_holds(const iso_border *border, const float a[3], const float b[3]) {
    return face_of(border, a, b) >= 0;
}

static void place_faces(const iso_border *border, iso_border_face *faces) {
    for (int f = 0; f < FACES; f++) {
        iso_border_face *face = &faces[f];
        face->axis = f / 2;
        face->u = (face->axis + (f % 2 ? 1 : 2)) % 3;
        face->v = (face->axis + (f % 2 ? 2 : 1)) % 3;
        face->plane = f % 2 ? border->hi[face->axis] : border->lo[face->axis];
        const int axes[2] = {face->u, face->v};
        for (int k = 0; k < 2; k++) {
            face->lo[k] = border->lo[axes[k]];
            face->hi[k] = border->hi[axes[k]];
        }
    }
}

/* Returns the coordinate `at`, or that of the rim (lo or hi) if this is within `near`. */
static double snap(double at, double lo, double hi, double near) {
    if (at - lo <= near) return lo;
    return hi - at <= near ? hi : at;
}

static bool add_edge(const iso_border *border, iso_border_face *face, const float *a, const float *b) {
    if (face->count == face->room) {
        const size_t room = face->room ? 2 * face->room : 64;
        flat_edge *more = iso_alloc(room * sizeof *more);
        if (!more) return false;
        if (face->count) memcpy(more, face->edges, face->count * sizeof *more);
        iso_free(face->edges);
        face->edges = more;
        face->room = room;
    }
    const int axes[2] = {face->u, face->v};
    flat_edge *e = &face->edges[face->count++];
    for (int k = 0; k < 2; k++) {
        e->a[k] = snap((double)a[axes[k]], face->lo[k], face->hi[k], border->near);
        e->b[k] = snap((double)b[axes[k]], face->lo[k], face->hi[k], border->near);
    }
    return true;
}

/* ---- numbers along the sides of a face */

static int compare_jumps(const void *a, const void *b) {
    const jump *x = a, *y = b;
    return (x->at > y->at) - (x->at < y->at);
}

/* Finds the changes of the winding number along a line just inside a side of the face: the side where
 * coordinate `across` is lowest or, with `high`, highest. The number changes at open edges that begin or end
 * at the side. Edges that lie in the side are taken as if they were a little farther inside, with both ends
 * bent outwards; the line crosses both ends. `forward` is the change at an edge that runs towards larger
 * values of `across`. */
static bool find_jumps(const iso_border_face *face, int across, bool high, int forward, jumps *out) {
    const double side = high ? face->hi[across] : face->lo[across];
    const int inward = high ? -forward : forward;
    out->list = iso_alloc((2 * face->count + 1) * sizeof *out->list);
    if (!out->list) return false;
    for (size_t i = 0; i < face->count; i++) {
        const flat_edge *e = &face->edges[i];
        if (e->a[across] == side) out->list[out->count++] = (jump){e->a[1 - across], inward};
        if (e->b[across] == side) out->list[out->count++] = (jump){e->b[1 - across], -inward};
    }
    qsort(out->list, out->count, sizeof *out->list, compare_jumps);
    for (size_t i = 1; i < out->count; i++)
        out->list[i].by += out->list[i - 1].by; /* from here on `by` is a sum */
    return true;
}

/* Returns the sum of the changes up to coordinate `at`. */
static int jumps_until(const jumps *j, double at) {
    size_t lo = 0, hi = j->count;
    while (lo < hi) {
        const size_t middle = (lo + hi) / 2;
        if (j->list[middle].at <= at)
            lo = middle + 1;
        else
            hi = middle;
    }
    return lo ? j->list[lo - 1].by : 0;
}

/* Returns the sum of all changes along a side. */
static int jumps_all(const jumps *j) {
    return j->count ? j->list[j->count - 1].by : 0;
}

static bool find_sides(iso_border_face *face) {
    return find_jumps(face, 0, false, -1, &face->left) && find_jumps(face, 0, true, -1, &face->right) &&
           find_jumps(face, 1, false, 1, &face->bottom) && find_jumps(face, 1, true, 1, &face->top);
}

/* ---- numbers anywhere in a face */

static size_t row_of(const iso_border_face *face, double v) {
    const double height = face->hi[1] - face->lo[1];
    const double row = height > 0 ? (v - face->lo[1]) / height * (double)face->rows : 0;
    return (size_t)fmin(fmax(row, 0), (double)(face->rows - 1));
}

/* Returns a number of rows with which an edge is in about ROW_EDGES rows on average. */
static size_t rows_for(const iso_border_face *face) {
    double rise = 0;
    const double height = face->hi[1] - face->lo[1];
    for (size_t i = 0; i < face->count; i++) rise += fabs(face->edges[i].b[1] - face->edges[i].a[1]);
    const double crossings =
        height > 0 ? rise / height : 0; /* how many edges a line of constant v crosses on average */
    const double rows = ROW_EDGES * (double)face->count / (crossings + 1);
    return (size_t)fmin(fmax(rows, 1), MOST_ROWS);
}

static bool make_rows(iso_border_face *face) {
    face->rows = rows_for(face);
    face->row_first = iso_alloc_zero(face->rows + 2, sizeof *face->row_first);
    if (!face->row_first) return false;
    for (int pass = 0; pass < 2; pass++) {
        for (size_t i = 0; i < face->count; i++) {
            const size_t a = row_of(face, face->edges[i].a[1]), b = row_of(face, face->edges[i].b[1]);
            for (size_t row = a < b ? a : b; row <= (a < b ? b : a); row++)
                if (pass)
                    face->row_edges[face->row_first[row + 1]++] = (uint32_t)i;
                else
                    face->row_first[row + 2]++;
        }
        if (pass) break;
        for (size_t row = 0; row <= face->rows; row++) face->row_first[row + 1] += face->row_first[row];
        face->row_edges = iso_alloc((face->row_first[face->rows + 1] + 1) * sizeof *face->row_edges);
        if (!face->row_edges) return false;
    }
    return true;
}

/* Returns the winding number at (u, v): that at the left side, changed by each edge between the left side and
 * the point. */
static int number_at(const iso_border_face *face, double u, double v) {
    int number = face->first + jumps_until(&face->left, v);
    const size_t row = row_of(face, v);
    for (size_t i = face->row_first[row]; i < face->row_first[row + 1]; i++) {
        const flat_edge *e = &face->edges[face->row_edges[i]];
        if ((e->a[1] <= v) == (e->b[1] <= v)) continue;
        const double at = e->a[0] + (v - e->a[1]) / (e->b[1] - e->a[1]) * (e->b[0] - e->a[0]);
        if (at < u) number += e->b[1] > e->a[1] ? 1 : -1;
    }
    return number;
}

/* ---- the constant */

/* Returns the number of the box's corner (bit 0, 1, 2: high x, y, z) that is corner k of a face (bit 0: high
 * u, bit 1: high v). */
static int box_corner(const iso_border_face *face, int f, int k) {
    return (f % 2) << face->axis | (k & 1) << face->u | (k >> 1) << face->v;
}

/* Returns the winding number at corner k of a face minus that at its first corner. */
static int corner_number(const iso_border_face *face, int k) {
    if (k == 0) return 0;
    if (k == 1) return jumps_all(&face->bottom);
    return jumps_all(&face->left) + (k == 3 ? jumps_all(&face->top) : 0);
}

/* Sets `first` of all faces, up to a constant for the whole box. Winding numbers do not change across the
 * edges of the box, so they are passed on from face to face at the corners. Returns false if they contradict
 * each other. */
static bool join_faces(iso_border_face *faces) {
    int number[8] = {0};
    bool known[8] = {true}, done[FACES] = {false};
    for (int round = 0; round < FACES; round++)
        for (int f = 0; f < FACES; f++) {
            for (int k = 0; k < 4 && !done[f]; k++) {
                const int corner = box_corner(&faces[f], f, k);
                done[f] = known[corner];
                faces[f].first = number[corner] - corner_number(&faces[f], k);
            }
            for (int k = 0; k < 4 && done[f]; k++) {
                const int corner = box_corner(&faces[f], f, k),
                          wanted = faces[f].first + corner_number(&faces[f], k);
                if (known[corner] && number[corner] != wanted) return false;
                number[corner] = wanted;
                known[corner] = true;
            }
        }
    for (int f = 0; f < FACES; f++)
        if (jumps_all(&faces[f].left) + jumps_all(&faces[f].top) !=
            jumps_all(&faces[f].bottom) + jumps_all(&faces[f].right))
            return false;
    return true;
}

/* Returns the smallest winding number of samples in all faces. */
static int smallest_number(const iso_border_face *faces) {
    int smallest = 0;
    for (int f = 0; f < FACES; f++)
        for (int i = 0; i < SAMPLES * SAMPLES; i++) {
            const double s = (i % SAMPLES + 0.5) / SAMPLES, t = ((double)(i / SAMPLES) + 0.5) / SAMPLES;
            const int number = number_at(&faces[f], faces[f].lo[0] + s * (faces[f].hi[0] - faces[f].lo[0]),
                                         faces[f].lo[1] + t * (faces[f].hi[1] - faces[f].lo[1]));
            smallest = (f == 0 && i == 0) || number < smallest ? number : smallest;
        }
    return smallest;
}

/* Subtracts the constant from all winding numbers: the number of the faces without open edges or, if all
 * faces have some, the smallest number. Returns false if two faces without open edges have different numbers.
 */
static bool find_constant(iso_border_face *faces) {
    int whole = -1;
    for (int f = 0; f < FACES; f++) {
        if (faces[f].count) continue;
        if (whole >= 0 && faces[f].first != faces[whole].first)
            return false; /* one of the two faces is covered by the solid */
        whole = f;
    }
    const int zero = whole >= 0 ? faces[whole].first : smallest_number(faces);
    for (int f = 0; f < FACES; f++) faces[f].first -= zero;
    return true;
}

iso_status iso_border_close(iso_border *border, const iso_triangles *mesh, const uint32_t (*edges)[2],
                            size_t count, iso_error *error) {
    iso_border_face *faces = iso_alloc_zero(FACES, sizeof *faces);
    bool whole = faces != NULL;
    if (faces) place_faces(border, faces);
    for (size_t i = 0; whole && i < count; i++) {
        const float *a = mesh->vertices[edges[i][0]], *b = mesh->vertices[edges[i][1]];
        whole = add_edge(border, &faces[face_of(border, a, b)], a, b);
    }
    for (int f = 0; whole && f < FACES; f++) whole = find_sides(&faces[f]) && make_rows(&faces[f]);
    if (!whole) {
        free_faces(faces);
        return iso_fail(error, ISO_ERR_NOMEM, "out of memory for %zu open edges", count);
    }
    if (!join_faces(faces) || !find_constant(faces)) {
        free_faces(faces);
        return iso_fail(error, ISO_ERR_FORMAT, "an open sheet");
    }
    border->faces = faces;
    return ISO_OK;
}

/* ---- nearest points and triangles of the caps */

static void nearest_on_face(const iso_border_face *face, const double p[3], iso_nearest *nearest) {
    const double away = p[face->axis] - face->plane;
    double at[3];
    if (away * away >= nearest->squared) return;
    at[face->axis] = face->plane;
    at[face->u] = iso_min(iso_max(p[face->u], face->lo[0]), face->hi[0]);
    at[face->v] = iso_min(iso_max(p[face->v], face->lo[1]), face->hi[1]);
    const double du = p[face->u] - at[face->u], dv = p[face->v] - at[face->v];
    const double squared = away * away + du * du + dv * dv;
    if (squared >= nearest->squared || number_at(face, at[face->u], at[face->v]) == 0) return;
    nearest->squared = squared;
    nearest->point = iso_vec3_make(at[0], at[1], at[2]);
}

void iso_border_nearest(const iso_border *border, iso_vec3 p, iso_nearest *nearest) {
    const double at[3] = {p.x, p.y, p.z};
    for (int f = 0; border->faces && f < FACES; f++)
        if (border->faces[f].count || border->faces[f].first) nearest_on_face(&border->faces[f], at, nearest);
}

typedef struct fan {
    iso_triangles *out; /* vertices NULL: vertices and triangles are only counted */
    const iso_border_face *face;
} fan;

static void add_corner(fan *f, const double at[2]) {
    if (f->out->vertices) {
        float *v = f->out->vertices[f->out->vertex_count];
        v[f->face->axis] = (float)f->face->plane;
        v[f->face->u] = (float)at[0];
        v[f->face->v] = (float)at[1];
    }
    f->out->vertex_count++;
}

/* Adds the triangle between the face's first corner, a and b `number` times; if `number` is negative, -number
 * times with the opposite orientation. */
static void add_triangles(fan *f, const double a[2], const double b[2], int number) {
    for (int i = 0; i < abs(number); i++) {
        uint32_t *t = f->out->triangles ? f->out->triangles[f->out->triangle_count] : NULL;
        for (int k = 0; t && k < 3; k++) t[k] = (uint32_t)f->out->vertex_count + (uint32_t)k;
        add_corner(f, f->face->lo);
        add_corner(f, number > 0 ? a : b);
        add_corner(f, number > 0 ? b : a);
        f->out->triangle_count++;
    }
}

/* Adds the triangles from the face's lowest corner to the side of the face where coordinate `across` is
 * highest: one for each segment of the side between two successive changes of the winding number, which is
 * `number` at the lower end of the side. */
static void add_side(fan *f, int across, const jumps *j, int number) {
    double from[2], to[2];
    from[across] = to[across] = f->face->hi[across];
    from[1 - across] = f->face->lo[1 - across];
    for (size_t i = 0; i <= j->count; i++) {
        to[1 - across] = i < j->count ? j->list[i].at : f->face->hi[1 - across];
        const int sum = number + (i ? j->list[i - 1].by : 0);
        if (to[1 - across] > from[1 - across]) add_triangles(f, from, to, across == 0 ? sum : -sum);
        from[1 - across] = to[1 - across];
    }
}

static void add_fan(const iso_border_face *face, iso_triangles *out) {
    fan f = {out, face};
    for (size_t i = 0; i < face->count; i++) add_triangles(&f, face->edges[i].b, face->edges[i].a, 1);
    add_side(&f, 0, &face->right, face->first + jumps_all(&face->bottom));
    add_side(&f, 1, &face->top, face->first + jumps_all(&face->left));
}

iso_status iso_border_fans(const iso_border *border, iso_triangles *fans, iso_error *error) {
    *fans = (iso_triangles){0};
    for (int f = 0; border->faces && f < FACES; f++) add_fan(&border->faces[f], fans);
    if (fans->triangle_count == 0) return ISO_OK;
    iso_triangles made = {.vertices = iso_alloc(fans->vertex_count * sizeof *made.vertices),
                          .triangles = iso_alloc(fans->triangle_count * sizeof *made.triangles)};
    if (!made.vertices || !made.triangles) {
        iso_free(made.vertices);
        iso_free(made.triangles);
        *fans = (iso_triangles){0};
        return iso_fail(error, ISO_ERR_NOMEM, "out of memory for the caps of a mesh");
    }
    for (int f = 0; f < FACES; f++) add_fan(&border->faces[f], &made);
    *fans = made;
    return ISO_OK;
}
