/* make_mc_table: derives the case table of Marching Cubes and prints it as a C header, at build time.
 *
 * Nothing is typed in by hand. A case says which of a cube's eight corners are inside. On each face the
 * surface leaves directed segments: every run of inside corners along the face's border is cut off from the
 * rest, which on an ambiguous face keeps the two inside corners apart. Each crossed edge ends one segment and
 * starts another (the two faces that share it walk it in opposite directions), so the segments chain into
 * loops, counter-clockwise seen from outside. A loop of n vertices becomes n - 2 triangles, such that no
 * diagonal lies in a face of the cube: there a neighbouring cell could put the same diagonal, and four
 * triangles would meet in it. Among those triangulations the one whose worst triangle is best (at the edges'
 * midpoints) is taken.
 *
 * Corner i is at (i & 1, i >> 1 & 1, i >> 2). Edge 4 * axis + k runs along `axis` from the corner whose bits
 * on the two axes after it (cyclically) are the low and the high bit of k. */
#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { CORNERS = 8, EDGES = 12, MAX_LOOP = 9, MAX_TRIANGLES = 5, NONE = -1 };
/* Vertices along an axis of a brick of 16 cells: see iso_edge_key in base/primitives.h. */
enum { LATTICE = 17 };

typedef struct loop {
    int count;
    int edge[MAX_LOOP];
} loop;

typedef struct table_row {
    int count;
    int edge[MAX_TRIANGLES][3];
} table_row;

static int edge_base(int edge) {
    int axis = edge / 4, k = edge % 4;
    return (k & 1) << (axis + 1) % 3 | (k >> 1) << (axis + 2) % 3;
}

static int edge_between(int corner_a, int corner_b) {
    int low = corner_a & corner_b, axis_bit = corner_a ^ corner_b;
    for (int edge = 0; edge < EDGES; edge++)
        if (edge_base(edge) == low && 1 << edge / 4 == axis_bit) return edge;
    abort();
}

/* The corners of face (axis, side), counter-clockwise seen from outside the cube. */
static void face_corners(int axis, int side, int corner[4]) {
    int b = 1 << (axis + 1) % 3, c = 1 << (axis + 2) % 3, base = side << axis;
    const int cycle[4] = {base, base | b, base | b | c, base | c};
    for (int i = 0; i < 4; i++) corner[i] = cycle[side ? i : 3 - i];
}

/* next[e] = the edge where the segment that starts on edge e ends. */
static void face_segments(int inside, const int corner[4], int next[EDGES]) {
    for (int i = 0; i < 4; i++) {
        int outer = corner[i], first = corner[(i + 1) % 4];
        if ((inside >> outer & 1) || !(inside >> first & 1)) continue;
        int j = i + 1;
        while (inside >> corner[(j + 1) % 4] & 1) j++;
        next[edge_between(outer, first)] = edge_between(corner[j % 4], corner[(j + 1) % 4]);
    }
}

static bool edge_in_face(int edge, int axis, int side) {
    return edge / 4 != axis && (edge_base(edge) >> axis & 1) == side;
}

static bool share_face(int edge_a, int edge_b) {
    for (int face = 0; face < 6; face++)
        if (edge_in_face(edge_a, face / 2, face % 2) && edge_in_face(edge_b, face / 2, face % 2)) return true;
    return false;
}

static double squared_distance(const double a[3], const double b[3]) {
    double sum = 0;
    for (int axis = 0; axis < 3; axis++) sum += (a[axis] - b[axis]) * (a[axis] - b[axis]);
    return sum;
}

static void midpoint(int edge, double point[3]) {
    for (int axis = 0; axis < 3; axis++) point[axis] = edge_base(edge) >> axis & 1;
    point[edge / 4] = 0.5;
}

/* Area over the sum of squared sides: largest for the equilateral triangle. */
static double triangle_quality(int a, int b, int c) {
    double p[3], q[3], r[3];
    midpoint(a, p);
    midpoint(b, q);
    midpoint(c, r);
    double x = squared_distance(p, q), y = squared_distance(q, r), z = squared_distance(r, p);
    double sixteen_squared_areas = 2 * (x * y + y * z + z * x) - (x * x + y * y + z * z);
    return sqrt(fmax(0, sixteen_squared_areas)) / (x + y + z);
}

typedef struct triangulation {
    const loop *polygon;
    double worst[MAX_LOOP][MAX_LOOP]; /* of the sub-polygon i .. j; negative: none is allowed */
    int apex[MAX_LOOP][MAX_LOOP];
} triangulation;

static bool diagonal_allowed(const loop *polygon, int i, int j) {
    bool side = j == i + 1 || (i == 0 && j == polygon->count - 1);
    return side || !share_face(polygon->edge[i], polygon->edge[j]);
}

/* Best triangulation of every sub-polygon, short ones first. */
static void triangulate(triangulation *best) {
    const double tie = 1e-9; /* equal up to rounding: the first found stays */
    const loop *polygon = best->polygon;
    for (int span = 1; span < polygon->count; span++)
        for (int i = 0; i + span < polygon->count; i++) {
            int j = i + span;
            best->worst[i][j] = span == 1 ? 1 : -1;
            if (!diagonal_allowed(polygon, i, j)) continue;
            for (int k = i + 1; k < j; k++) {
                double worst = triangle_quality(polygon->edge[i], polygon->edge[k], polygon->edge[j]);
                worst = fmin(worst, fmin(best->worst[i][k], best->worst[k][j]));
                if (worst <= best->worst[i][j] + tie) continue;
                best->worst[i][j] = worst;
                best->apex[i][j] = k;
            }
        }
}

static void collect(const triangulation *best, int i, int j, table_row *row) {
    if (j == i + 1) return;
    int k = best->apex[i][j];
    collect(best, i, k, row);
    const int *edge = best->polygon->edge;
    if (row->count == MAX_TRIANGLES) abort();
    memcpy(row->edge[row->count++], (int[3]){edge[i], edge[k], edge[j]}, sizeof row->edge[0]);
    collect(best, k, j, row);
}

static void add_loop(int inside, const loop *polygon, table_row *row) {
    triangulation best = {.polygon = polygon};
    triangulate(&best);
    if (polygon->count < 3 || best.worst[0][polygon->count - 1] <= 0) {
        fprintf(stderr, "make_mc_table: case %d has a loop that cannot be triangulated\n", inside);
        exit(1);
    }
    collect(&best, 0, polygon->count - 1, row);
}

static table_row make_row(int inside) {
    int next[EDGES];
    for (int edge = 0; edge < EDGES; edge++) next[edge] = NONE;
    for (int face = 0; face < 6; face++) {
        int corner[4];
        face_corners(face / 2, face % 2, corner);
        face_segments(inside, corner, next);
    }
    table_row row = {0};
    for (int start = 0; start < EDGES; start++) {
        loop polygon = {0};
        for (int edge = start; next[edge] != NONE;) {
            if (polygon.count == MAX_LOOP) abort();
            polygon.edge[polygon.count++] = edge;
            int following = next[edge];
            next[edge] = NONE;
            edge = following;
        }
        if (polygon.count) add_loop(inside, &polygon, &row);
    }
    return row;
}

/* An edge's iso_edge_key less the key of the cell's first edge. */
static int edge_key(int edge) {
    int base = edge_base(edge);
    int voxel = ((base >> 2) * LATTICE + (base >> 1 & 1)) * LATTICE + (base & 1);
    return edge / 4 * LATTICE * LATTICE * LATTICE + voxel;
}

static void print_row(FILE *file, const table_row *row, bool flip) {
    fprintf(file, "    {%d, {", row->count);
    for (int i = 0; i < 3 * MAX_TRIANGLES; i++) { /* what is not used names an edge that exists */
        int k = i % 3, corner = flip && k ? 3 - k : k;
        int key = i < 3 * row->count ? edge_key(row->edge[i / 3][corner]) : 0;
        fprintf(file, "%s%d", i ? ", " : "", key);
    }
    fprintf(file, "}},\n");
}

/* Where vector code finds the vertex of an edge: 8 pairs of numbers, those of x edges with one that is not
 * wanted, then y edges, then z edges, both of neighbours in x; see add_triangles_avx2. */
static int vector_slot(int edge) {
    int base = edge_base(edge), axis = edge / 4;
    if (axis == 0) return 2 * (base >> 1);
    return 4 + 4 * axis + 2 * (axis == 1 ? base >> 2 : base >> 1 & 1) + (base & 1);
}

/* Byte shuffles that put vertex numbers into the order of the triangles' corners: first from pairs 0 .. 3,
 * then from pairs 4 .. 7. */
static void print_shuffle(FILE *file, const table_row *row, bool flip) {
    fprintf(file, "    {");
    for (int half = 0; half < 2; half++)
        for (int byte = 0; byte < 32; byte++) {
            int i = byte / 2, k = i % 3, corner = flip && k ? 3 - k : k, from = 0x80;
            if (i < 3 * row->count) {
                int slot = vector_slot(row->edge[i / 3][corner]) - 8 * half;
                if (slot >= 0 && slot < 8) from = 2 * slot + byte % 2;
            }
            fprintf(file, "%s%d", byte + half ? ", " : "", from);
        }
    fprintf(file, "},\n");
}

int main(int argc, char **argv) {
    FILE *file = argc == 2 ? fopen(argv[1], "w") : NULL;
    if (!file) {
        fprintf(stderr, "usage: make_mc_table OUTPUT.h\n");
        return 2;
    }
    fprintf(file,
            "/* Made by tools/make_mc_table.c. */\n"
            "#ifndef ISO_EXTRACT_MC_TABLE_H\n#define ISO_EXTRACT_MC_TABLE_H\n\n#include <stdint.h>\n\n"
            "/* The triangles of a case (bit i: corner i inside): iso_edge_keys of their corners, three a\n"
            " * triangle, less the key of the cell's first edge. [1]: wound the other way. */\n"
            "typedef struct mc_case {\n    uint16_t triangles;\n    uint16_t key[%d];\n} mc_case;\n\n"
            "static const mc_case mc_cases[2][256] = {{\n",
            3 * MAX_TRIANGLES);
    for (int flip = 0; flip < 2; flip++) {
        for (int inside = 0; inside < 256; inside++) {
            table_row row = make_row(inside);
            print_row(file, &row, flip);
        }
        fprintf(file, flip ? "}};\n\n" : "}, {\n");
    }
    fprintf(file, "static const uint8_t mc_shuffles[2][256][64] = {{\n");
    for (int flip = 0; flip < 2; flip++) {
        for (int inside = 0; inside < 256; inside++) {
            table_row row = make_row(inside);
            print_shuffle(file, &row, flip);
        }
        fprintf(file, flip ? "}};\n\n#endif\n" : "}, {\n");
    }
    if (ferror(file) | fclose(file)) {
        fprintf(stderr, "make_mc_table: cannot write %s\n", argv[1]);
        return 1;
    }
    return 0;
}
