/* Implements a complete binary tree over triangles in Morton order, with boxes for nearest points and dipoles
 * for winding numbers; triangle_tree.h names the papers. */
#include "grids/closing/triangle_tree.h"

#include <math.h>
#include <stdint.h>
#include <string.h>

#include "base/memory.h"
#include "grids/closing/triangle_reach.h"

/* LEAF: the largest number of triangles of a leaf. DEEPEST: the largest depth of a tree; the stack of a
 * search has room for twice as many nodes. MORTON_BITS: bits of a Morton key for each axis. */
enum { LEAF = 4, DEEPEST = 30, MORTON_BITS = 10 };
/* The triangles of a node are approximated by a dipole beyond this many times the node's radius. The error of
 * the winding number of a closed surface is then below 0.1 (tests/unit/grids/test_closed_mesh.c). */
static const double FAR = 2;

typedef struct node {
    float lo[3], hi[3];
    double centre[3], dipole[3]; /* area-weighted centre; sum of the triangles' area vectors */
    double radius;               /* of a ball around the centre that contains the triangles */
} node;

/* A complete binary tree: the children of node i are 2 i + 1 and 2 i + 2, and the triangles, in the order of
 * a Morton curve, are divided evenly among the leaves. */
struct iso_triangle_tree {
    iso_tree_triangle *triangles;
    node *nodes;
    size_t count, leaves; /* leaves: 2^depth */
    int depth;
};

/* ---- building */

/* A triangle and its Morton key. */
typedef struct place {
    uint32_t key, triangle;
} place;

/* Inserts two zero bits before each of the low ten bits of x. */
static uint32_t spread(uint32_t x) {
    x = (x | x << 16) & 0x030000ffu;
    x = (x | x << 8) & 0x0300f00fu;
    x = (x | x << 4) & 0x030c30c3u;
    return (x | x << 2) & 0x09249249u;
}

static iso_box bounds_of(const iso_triangles *mesh) {
    iso_box box = iso_box_empty();
    for (size_t i = 0; i < 3 * mesh->triangle_count; i++) {
        const float *v = mesh->vertices[mesh->triangles[i / 3][i % 3]];
        iso_box_add(&box, iso_vec3_make(v[0], v[1], v[2]));
    }
    return box;
}

/* Lists the triangles that have an area and returns their number; all of them, if none has. A line encloses
 * nothing, and is no surface unless the edges of other triangles lie there. */
static size_t find_triangles(const iso_triangles *mesh, place *places) {
    size_t count = 0;
    for (size_t t = 0; t < mesh->triangle_count; t++)
        if (iso_triangle_has_area(mesh, t)) places[count++].triangle = (uint32_t)t;
    if (count) return count;
    for (; count < mesh->triangle_count; count++) places[count].triangle = (uint32_t)count;
    return count;
}

static void find_keys(const iso_triangles *mesh, place *places, size_t count) {
    const iso_box box = bounds_of(mesh);
    const double lo[3] = {box.lo.x, box.lo.y, box.lo.z}, hi[3] = {box.hi.x, box.hi.y, box.hi.z};
    for (size_t i = 0; i < count; i++) {
        const uint32_t t = places[i].triangle;
        uint32_t key = 0;
        for (int axis = 0; axis < 3; axis++) {
            double sum = 0;
            for (int k = 0; k < 3; k++) sum += (double)mesh->vertices[mesh->triangles[t][k]][axis];
            const double extent = hi[axis] - lo[axis], steps = (1 << MORTON_BITS) - 1;
            const double at = extent > 0 ? (sum / 3 - lo[axis]) / extent * steps : 0;
            key |= spread((uint32_t)fmin(fmax(at, 0), steps)) << axis;
        }
        places[i].key = key;
    }
}

/* Sorts by key: a stable radix sort of three passes. */
static void sort_places(place *places, place *scratch, size_t count) {
    enum { BITS = 10, BUCKETS = 1 << BITS };
    for (int pass = 0; pass < 3; pass++) {
        size_t first[BUCKETS + 1] = {0};
        for (size_t i = 0; i < count; i++) first[(places[i].key >> (BITS * pass) & (BUCKETS - 1)) + 1]++;
        for (int b = 0; b < BUCKETS; b++) first[b + 1] += first[b];
        for (size_t i = 0; i < count; i++)
            scratch[first[places[i].key >> (BITS * pass) & (BUCKETS - 1)]++] = places[i];
        memcpy(places, scratch, count * sizeof *places);
    }
}

/* Returns the index of the first triangle of a leaf. */
static size_t leaf_first(const iso_triangle_tree *tree, size_t leaf) {
    return tree->count * leaf >> tree->depth; /* the product is below 2^62 */
}

static iso_vec3 corner(const iso_tree_triangle *t, int k) {
    return iso_vec3_make(t->corners[k][0], t->corners[k][1], t->corners[k][2]);
}

static iso_vec3 area_vector(const iso_tree_triangle *t) {
    const iso_vec3 a = corner(t, 0);
    return iso_vec3_scale(iso_vec3_cross(iso_vec3_sub(corner(t, 1), a), iso_vec3_sub(corner(t, 2), a)), 0.5);
}

/* Sums over the triangles of a node: area, area-weighted centroids (moment) and area vectors (dipole). The
 * data of the node is computed from them. */
typedef struct sums {
    iso_vec3 moment, dipole;
    double area;
} sums;

static void set_node(node *n, const sums *s) {
    const double *lo = (const double[3]){(double)n->lo[0], (double)n->lo[1], (double)n->lo[2]};
    const double *hi = (const double[3]){(double)n->hi[0], (double)n->hi[1], (double)n->hi[2]};
    const double moment[3] = {s->moment.x, s->moment.y, s->moment.z};
    double squared = 0;
    for (int axis = 0; axis < 3; axis++) {
        const double middle = s->area > 0 ? moment[axis] / s->area : 0.5 * (lo[axis] + hi[axis]);
        n->centre[axis] = fmin(fmax(middle, lo[axis]), hi[axis]);
        const double reach = fmax(n->centre[axis] - lo[axis], hi[axis] - n->centre[axis]);
        squared += reach * reach;
    }
    n->dipole[0] = s->dipole.x;
    n->dipole[1] = s->dipole.y;
    n->dipole[2] = s->dipole.z;
    n->radius = sqrt(squared);
}

static void clear_box(node *n) {
    for (int axis = 0; axis < 3; axis++) {
        n->lo[axis] = INFINITY;
        n->hi[axis] = -INFINITY;
    }
}

static void build_leaf(const iso_triangle_tree *tree, size_t leaf, node *n, sums *s) {
    *s = (sums){0};
    clear_box(n);
    for (size_t i = leaf_first(tree, leaf); i < leaf_first(tree, leaf + 1); i++) {
        const iso_tree_triangle *t = &tree->triangles[i];
        const iso_vec3 vector = area_vector(t);
        const double area = iso_vec3_length(vector);
        iso_vec3 middle = {0, 0, 0};
        for (int k = 0; k < 3; k++) {
            middle = iso_vec3_add(middle, iso_vec3_scale(corner(t, k), 1.0 / 3));
            for (int axis = 0; axis < 3; axis++) {
                n->lo[axis] = fminf(n->lo[axis], t->corners[k][axis]);
                n->hi[axis] = fmaxf(n->hi[axis], t->corners[k][axis]);
            }
        }
        s->moment = iso_vec3_add(s->moment, iso_vec3_scale(middle, area));
        s->dipole = iso_vec3_add(s->dipole, vector);
        s->area += area;
    }
    set_node(n, s);
}

static void build_sums(const iso_triangle_tree *tree, sums *s) {
    for (size_t leaf = 0; leaf < tree->leaves; leaf++) {
        const size_t i = tree->leaves - 1 + leaf;
        build_leaf(tree, leaf, &tree->nodes[i], &s[i]);
    }
    for (size_t i = tree->leaves - 1; i-- > 0;) {
        const node *a = &tree->nodes[2 * i + 1], *b = &tree->nodes[2 * i + 2];
        const sums *x = &s[2 * i + 1], *y = &s[2 * i + 2];
        for (int axis = 0; axis < 3; axis++) {
            tree->nodes[i].lo[axis] = fminf(a->lo[axis], b->lo[axis]);
            tree->nodes[i].hi[axis] = fmaxf(a->hi[axis], b->hi[axis]);
        }
        s[i] =
            (sums){iso_vec3_add(x->moment, y->moment), iso_vec3_add(x->dipole, y->dipole), x->area + y->area};
        set_node(&tree->nodes[i], &s[i]);
    }
}

/* Creates a tree; NULL: out of memory. */
static iso_triangle_tree *create_tree(const iso_triangles *mesh) {
    iso_triangle_tree *tree = iso_alloc_zero(1, sizeof *tree);
    if (!tree) return NULL;
    place *places = iso_alloc(2 * mesh->triangle_count * sizeof *places);
    tree->count = places ? find_triangles(mesh, places) : 0;
    while ((size_t)LEAF << tree->depth < tree->count) tree->depth++;
    tree->leaves = (size_t)1 << tree->depth;
    sums *s = iso_alloc(2 * tree->leaves * sizeof *s);
    tree->triangles = iso_alloc(tree->count * sizeof *tree->triangles);
    tree->nodes = iso_alloc(2 * tree->leaves * sizeof *tree->nodes);
    float *reaches = iso_alloc(mesh->triangle_count * sizeof *reaches);
    const bool whole =
        places && s && tree->triangles && tree->nodes && reaches && iso_triangle_reaches(mesh, reaches);
    if (whole) {
        find_keys(mesh, places, tree->count);
        sort_places(places, places + tree->count, tree->count);
        for (size_t i = 0; i < tree->count; i++) {
            const uint32_t number = places[i].triangle;
            tree->triangles[i].reach = reaches[number];
            tree->triangles[i].number = number;
            for (int k = 0; k < 3; k++)
                memcpy(tree->triangles[i].corners[k], mesh->vertices[mesh->triangles[number][k]],
                       sizeof tree->triangles[i].corners[k]);
        }
        build_sums(tree, s);
    }
    iso_free(places);
    iso_free(s);
    iso_free(reaches);
    if (whole) return tree;
    iso_triangle_tree_destroy(tree);
    return NULL;
}

iso_status iso_triangle_tree_create(const iso_triangles *mesh, iso_triangle_tree **tree, iso_error *error) {
    iso_triangle_tree *made = create_tree(mesh);
    if (!made) return iso_fail(error, ISO_ERR_NOMEM, "out of memory for %zu triangles", mesh->triangle_count);
    *tree = made;
    return ISO_OK;
}

void iso_triangle_tree_destroy(iso_triangle_tree *tree) {
    if (!tree) return;
    iso_free(tree->triangles);
    iso_free(tree->nodes);
    iso_free(tree);
}

/* ---- winding numbers */

/* Returns the arc tangent of x, 0 <= x <= 1, with an error below 1e-11. */
static double arc_tangent(double x) {
    static const double EIGHTH = 0.41421356237309503; /* tan(pi / 8) */
    const bool large = x > EIGHTH;
    if (large) x = (x - 1) / (x + 1);
    const double square = x * x;
    double sum = 0;
    for (int n = 25; n >= 1; n -= 2) sum = ((n & 2) ? -1.0 : 1.0) / n + square * sum;
    return (large ? ISO_PI / 4 : 0) + x * sum;
}

/* Returns the angle of the vector (x, y) as atan2 does, but with the same bits on every machine; 0 if y is 0.
 */
static double angle_of(double y, double x) {
    const double ay = fabs(y), ax = fabs(x);
    if (ay == 0) return 0;
    const double first = ay <= ax ? arc_tangent(ay / ax) : ISO_PI / 2 - arc_tangent(ax / ay);
    const double angle = x < 0 ? ISO_PI - first : first;
    return y < 0 ? -angle : angle;
}

/* Returns the winding number of a triangle around p: its solid angle divided by 4 pi. */
static double triangle_winding(const iso_tree_triangle *t, iso_vec3 p) {
    const iso_vec3 a = iso_vec3_sub(corner(t, 0), p), b = iso_vec3_sub(corner(t, 1), p),
                   c = iso_vec3_sub(corner(t, 2), p);
    const double la = iso_vec3_length(a), lb = iso_vec3_length(b), lc = iso_vec3_length(c);
    const double determinant = iso_vec3_dot(a, iso_vec3_cross(b, c));
    const double rest =
        la * lb * lc + iso_vec3_dot(a, b) * lc + iso_vec3_dot(b, c) * la + iso_vec3_dot(c, a) * lb;
    return angle_of(determinant, rest) / (2 * ISO_PI);
}

/* Returns the winding number of a node's dipole around p if the node is far enough away; *far says whether.
 */
static double dipole_winding(const node *n, iso_vec3 p, bool *far) {
    const iso_vec3 way = iso_vec3_sub(iso_vec3_make(n->centre[0], n->centre[1], n->centre[2]), p);
    const double squared = iso_vec3_dot(way, way);
    *far = squared > FAR * FAR * n->radius * n->radius;
    if (!*far) return 0;
    const iso_vec3 dipole = {n->dipole[0], n->dipole[1], n->dipole[2]};
    return iso_vec3_dot(way, dipole) / (4 * ISO_PI * squared * sqrt(squared));
}

static double leaf_winding(const iso_triangle_tree *tree, size_t leaf, iso_vec3 p) {
    double sum = 0;
    for (size_t i = leaf_first(tree, leaf); i < leaf_first(tree, leaf + 1); i++)
        sum += triangle_winding(&tree->triangles[i], p);
    return sum;
}

double iso_triangle_tree_winding(const iso_triangle_tree *tree, iso_vec3 p) {
    size_t stack[2 * DEEPEST];
    int depth = 0;
    double sum = 0;
    if (!tree) return 0;
    stack[depth++] = 0;
    while (depth > 0) {
        const size_t i = stack[--depth];
        bool far;
        sum += dipole_winding(&tree->nodes[i], p, &far);
        if (far) continue;
        if (i >= tree->leaves - 1) {
            sum += leaf_winding(tree, i - (tree->leaves - 1), p);
            continue;
        }
        stack[depth++] = 2 * i + 2;
        stack[depth++] = 2 * i + 1;
    }
    return sum;
}

/* ---- nearest points */

/* Returns the point of a triangle that is nearest to p, depending on the region of the triangle's plane that
 * p is above (Ericson 2005, "Real-time collision detection", 5.1.5). */
iso_vec3 iso_triangle_nearest(const float triangle[3][3], iso_vec3 p) {
    iso_vec3 t[3];
    for (int k = 0; k < 3; k++)
        t[k] = iso_vec3_make((double)triangle[k][0], (double)triangle[k][1], (double)triangle[k][2]);
    const iso_vec3 a = t[0], b = t[1], c = t[2];
    const iso_vec3 ab = iso_vec3_sub(b, a), ac = iso_vec3_sub(c, a), ap = iso_vec3_sub(p, a);
    const double d1 = iso_vec3_dot(ab, ap), d2 = iso_vec3_dot(ac, ap);
    if (d1 <= 0 && d2 <= 0) return a;
    const iso_vec3 bp = iso_vec3_sub(p, b);
    const double d3 = iso_vec3_dot(ab, bp), d4 = iso_vec3_dot(ac, bp);
    if (d3 >= 0 && d4 <= d3) return b;
    const double vc = d1 * d4 - d3 * d2;
    if (vc <= 0 && d1 >= 0 && d3 <= 0) return iso_vec3_add(a, iso_vec3_scale(ab, d1 / (d1 - d3)));
    const iso_vec3 cp = iso_vec3_sub(p, c);
    const double d5 = iso_vec3_dot(ab, cp), d6 = iso_vec3_dot(ac, cp);
    if (d6 >= 0 && d5 <= d6) return c;
    const double vb = d5 * d2 - d1 * d6;
    if (vb <= 0 && d2 >= 0 && d6 <= 0) return iso_vec3_add(a, iso_vec3_scale(ac, d2 / (d2 - d6)));
    const double va = d3 * d6 - d5 * d4, along = d4 - d3, back = d5 - d6;
    if (va <= 0 && along >= 0 && back >= 0)
        return iso_vec3_add(b, iso_vec3_scale(iso_vec3_sub(c, b), along / (along + back)));
    const double sum = va + vb + vc;
    if (!(sum > 0))
        return a; /* a triangle without an area: any of its points will do, as its edges have neighbours */
    return iso_vec3_add(a, iso_vec3_add(iso_vec3_scale(ab, vb / sum), iso_vec3_scale(ac, vc / sum)));
}

/* Sets *nearest to the nearest point of a triangle, if this point is nearer. */
static void test_triangle(const iso_triangle_tree *tree, size_t triangle, iso_vec3 p, iso_nearest *nearest) {
    const iso_vec3 point = iso_triangle_nearest(tree->triangles[triangle].corners, p),
                   way = iso_vec3_sub(p, point);
    const double squared = iso_vec3_dot(way, way);
    if (squared < nearest->squared) *nearest = (iso_nearest){squared, point, triangle};
}

/* Returns the squared distance from p to a node's box. */
static double box_squared_distance(const node *n, const double p[3]) {
    double squared = 0;
    for (int axis = 0; axis < 3; axis++) {
        const double below = (double)n->lo[axis] - p[axis], above = p[axis] - (double)n->hi[axis];
        const double out = below > above ? below : above;
        squared += out > 0 ? out * out : 0;
    }
    return squared;
}

/* A node that is still to be searched. */
typedef struct pending {
    size_t place;
    double squared; /* distance of its box */
} pending;

/* Pushes the children of a node; the nearer one last, so that it is visited first. */
static void push_children(const iso_triangle_tree *tree, size_t parent, const double p[3],
                          pending stack[2 * DEEPEST], int *depth) {
    const size_t child = 2 * parent + 1;
    const double d[2] = {box_squared_distance(&tree->nodes[child], p),
                         box_squared_distance(&tree->nodes[child + 1], p)};
    const int nearer = d[1] < d[0];
    for (int k = 0; k < 2; k++) {
        const int which = k ? nearer : 1 - nearer;
        stack[(*depth)++] = (pending){child + (size_t)which, d[which]};
    }
}

void iso_triangle_tree_nearest(const iso_triangle_tree *tree, iso_vec3 p, iso_nearest *nearest) {
    const double at[3] = {p.x, p.y, p.z};
    pending stack[2 * DEEPEST];
    int depth = 0;
    if (nearest->triangle < tree->count) test_triangle(tree, nearest->triangle, p, nearest);
    stack[depth++] = (pending){0, box_squared_distance(&tree->nodes[0], at)};
    while (depth > 0) {
        const size_t i = stack[--depth].place;
        if (stack[depth].squared >= nearest->squared) continue;
        if (i < tree->leaves - 1) {
            push_children(tree, i, at, stack, &depth);
            continue;
        }
        const size_t leaf = i - (tree->leaves - 1);
        for (size_t k = leaf_first(tree, leaf); k < leaf_first(tree, leaf + 1); k++)
            test_triangle(tree, k, p, nearest);
    }
}

size_t iso_triangle_tree_count(const iso_triangle_tree *tree) {
    return tree->count;
}

const iso_tree_triangle *iso_triangle_tree_get(const iso_triangle_tree *tree, size_t triangle) {
    return &tree->triangles[triangle];
}

/* ---- all triangles in a box */

void iso_triangle_tree_visit(const iso_triangle_tree *tree, const iso_box *box,
                             void (*visit)(void *context, const iso_tree_triangle *triangle), void *context) {
    size_t stack[2 * DEEPEST];
    int depth = 0;
    stack[depth++] = 0;
    while (depth > 0) {
        const size_t i = stack[--depth];
        const node *n = &tree->nodes[i];
        if ((double)n->lo[0] > box->hi.x || (double)n->hi[0] < box->lo.x || (double)n->lo[1] > box->hi.y ||
            (double)n->hi[1] < box->lo.y || (double)n->lo[2] > box->hi.z || (double)n->hi[2] < box->lo.z)
            continue;
        if (i < tree->leaves - 1) {
            stack[depth++] = 2 * i + 2;
            stack[depth++] = 2 * i + 1;
            continue;
        }
        const size_t leaf = i - (tree->leaves - 1);
        for (size_t k = leaf_first(tree, leaf); k < leaf_first(tree, leaf + 1); k++)
            visit(context, &tree->triangles[k]);
    }
}

/* ---- changes of the winding number along a way */

/* How small a volume may be in comparison with the lengths that it is computed from, before its sign counts
 * as unknown. Cracks without an area, which the tree leaves out, are narrower. */
static const double UNSURE = 1e-6;

/* The way from p to q, with q and the triangles relative to p. */
typedef struct crossing {
    iso_vec3 from, way;
    double length;
    int change;
    bool unsure;
} crossing;

/* Returns the sign of a volume, 0 if it is unknown. */
static int sign_of(double volume, double size) {
    return volume > UNSURE * size ? 1 : volume < -UNSURE * size ? -1 : 0;
}

static void cross_triangle(void *context, const iso_tree_triangle *triangle) {
    crossing *c = context;
    iso_vec3 p[3];
    double size = c->length;
    for (int k = 0; k < 3; k++) {
        p[k] = iso_vec3_sub(corner(triangle, k), c->from);
        size = fmax(size, fmax(fabs(p[k].x), fmax(fabs(p[k].y), fabs(p[k].z))));
    }
    int inside[3];
    for (int k = 0; k < 3; k++)
        inside[k] =
            sign_of(iso_vec3_dot(c->way, iso_vec3_cross(p[k], p[(k + 1) % 3])), c->length * size * size);
    const bool some_left = inside[0] > 0 || inside[1] > 0 || inside[2] > 0,
               some_right = inside[0] < 0 || inside[1] < 0 || inside[2] < 0;
    if (some_left && some_right) return; /* the line passes beside the triangle */
    const iso_vec3 normal = iso_vec3_cross(iso_vec3_sub(p[1], p[0]), iso_vec3_sub(p[2], p[0]));
    const double start = -iso_vec3_dot(normal, p[0]), end = start + iso_vec3_dot(normal, c->way);
    const int before = sign_of(start, size * size * size), after = sign_of(end, size * size * size);
    if (before * after > 0) return;
    if (before && after && inside[0] && inside[1] && inside[2])
        c->change += before > 0 ? 1 : -1;
    else
        c->unsure = true;
}

bool iso_triangle_tree_change(const iso_triangle_tree *tree, iso_vec3 p, iso_vec3 q, int *change) {
    crossing c = {.from = p, .way = iso_vec3_sub(q, p)};
    iso_box box = iso_box_empty();
    c.length = iso_vec3_length(c.way);
    iso_box_add(&box, p);
    iso_box_add(&box, q);
    if (tree) iso_triangle_tree_visit(tree, &box, cross_triangle, &c);
    *change = c.change;
    return !c.unsure;
}
