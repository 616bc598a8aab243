/* neighbours: builds the k-d tree level by level, and searches it with the squared distance to the region of
 * each node, which is updated from node to node (Arya and Mount 1993, "Algorithms for fast vector
 * quantization"). */
#include "clouds/neighbours.h"

#include <math.h>
#include <stdbool.h>

#include "base/memory.h"

/* ---- building */

/* Returns the first slot of a leaf. */
static size_t leaf_start(const iso_tree *tree, uint64_t leaf) {
    return (size_t)(leaf * tree->count >> tree->depth);
}

/* Returns the first slot of the node with this number among the nodes of its level. */
static size_t node_start(const iso_tree *tree, int level, uint64_t number) {
    return leaf_start(tree, number << (tree->depth - level));
}

/* Returns the axis along which the points first .. end - 1 have the largest extent. */
static int longest_axis(const iso_tree_point *points, size_t first, size_t end) {
    float lo[3] = {INFINITY, INFINITY, INFINITY}, hi[3] = {-INFINITY, -INFINITY, -INFINITY};
    for (size_t i = first; i < end; i++)
        for (int axis = 0; axis < 3; axis++) {
            lo[axis] = fminf(lo[axis], points[i].position[axis]);
            hi[axis] = fmaxf(hi[axis], points[i].position[axis]);
        }
    int longest = 0;
    for (int axis = 1; axis < 3; axis++)
        if (hi[axis] - lo[axis] > hi[longest] - lo[longest]) longest = axis;
    return longest;
}

/* Orders points by their coordinate, and those with the same coordinate by their index. */
static bool precedes(const iso_tree_point *a, const iso_tree_point *b, int axis) {
    const float left = a->position[axis], right = b->position[axis];
    return left < right || (left == right && a->index < b->index);
}

/* Exchanges the points first .. end - 1 so that the one that belongs at slot `middle` by its order along the
 * axis is there, with all that precede it before it (Hoare 1961, "Algorithm 65: find"). The pivot is taken
 * from a scrambled place, so that no order of points in a file is slow. */
static void select_middle(iso_tree_point *points, size_t first, size_t end, size_t middle, int axis) {
    while (end - first > 1) {
        const size_t count = end - first;
        const iso_tree_point pivot = points[first + (size_t)((uint64_t)count * 0x9e3779b97f4a7c15u % count)];
        size_t low = first, high = end - 1;
        for (;;) {
            while (precedes(&points[low], &pivot, axis)) low++;
            while (precedes(&pivot, &points[high], axis)) high--;
            if (low >= high) break;
            const iso_tree_point swapped = points[low];
            points[low++] = points[high];
            points[high--] = swapped;
        }
        /* Points before `low` do not follow the pivot, and points behind `high` do not precede it. */
        if (low == high) {
            if (middle == low) return;
            if (middle < low)
                end = low;
            else
                first = low + 1;
        } else if (middle <= high) {
            end = high + 1;
        } else {
            first = low;
        }
    }
}

typedef struct level_job {
    iso_tree *tree;
    int level;
} level_job;

static void divide_node(void *context, size_t number, int worker) {
    (void)worker;
    const level_job *job = context;
    iso_tree *tree = job->tree;
    const size_t first = node_start(tree, job->level, number), end = node_start(tree, job->level, number + 1),
                 middle = node_start(tree, job->level + 1, 2 * number + 1),
                 node = ((size_t)1 << job->level) + number;
    const int axis = longest_axis(tree->points, first, end);
    select_middle(tree->points, first, end, middle, axis);
    tree->axes[node] = (uint8_t)axis;
    tree->splits[node] = tree->points[middle].position[axis];
}

iso_status iso_tree_make(const float (*positions)[3], size_t count, iso_pool *pool, iso_tree *tree,
                         iso_error *error) {
    if (count >= (size_t)1 << 31)
        return iso_fail(error, ISO_ERR_LIMIT, "more than %zu points", ((size_t)1 << 31) - 1);
    iso_tree made = {.count = count};
    while (count >> made.depth > ISO_TREE_LEAF) made.depth++;
    const size_t nodes = (size_t)1 << made.depth;
    made.points = iso_alloc(count * sizeof *made.points);
    made.splits = iso_alloc(nodes * sizeof *made.splits);
    made.axes = iso_alloc(nodes * sizeof *made.axes);
    if (!made.points || !made.splits || !made.axes) {
        iso_tree_free(&made);
        return iso_fail(error, ISO_ERR_NOMEM, "out of memory for the neighbours of %zu points", count);
    }
    for (size_t i = 0; i < count; i++)
        made.points[i] = (iso_tree_point){{positions[i][0], positions[i][1], positions[i][2]}, (uint32_t)i};
    for (int level = 0; level < made.depth; level++)
        iso_parallel_for(pool, (size_t)1 << level, divide_node, &(level_job){&made, level});
    *tree = made;
    return ISO_OK;
}

void iso_tree_free(iso_tree *tree) {
    iso_free(tree->points);
    iso_free(tree->splits);
    iso_free(tree->axes);
    *tree = (iso_tree){0};
}

/* ---- searching */

typedef struct search {
    const iso_tree *tree;
    const float *position;
    size_t self; /* the slot of the point whose neighbours are sought, which is not one of them */
    iso_neighbour *found;
    int count, most;
    float sides[3]; /* distances along the axes to the region of the node that is being visited */
} search;

/* Returns the squared distance below which a point is one of the nearest found so far. */
static float farthest(const search *s) {
    return s->count < s->most ? INFINITY : s->found[s->most - 1].square;
}

/* Adds a neighbour, in place of the farthest one if there are enough already. */
static void insert(search *s, float square, size_t slot) {
    int i = s->count < s->most ? s->count++ : s->most - 1;
    for (; i > 0 && s->found[i - 1].square > square; i--) s->found[i] = s->found[i - 1];
    s->found[i] = (iso_neighbour){square, (uint32_t)slot};
}

static void visit_leaf(search *s, uint64_t leaf) {
    const size_t end = leaf_start(s->tree, leaf + 1);
    float limit = farthest(s);
    for (size_t slot = leaf_start(s->tree, leaf); slot < end; slot++) {
        const float *p = s->tree->points[slot].position;
        const float x = p[0] - s->position[0], y = p[1] - s->position[1], z = p[2] - s->position[2];
        const float square = x * x + y * y + z * z;
        if (!(square < limit) || slot == s->self) continue;
        insert(s, square, slot);
        limit = farthest(s);
    }
}

/* Searches a node. `square` is the squared distance to the node's region. */
static void visit(search *s, uint64_t node, int level, float square) {
    const iso_tree *tree = s->tree;
    if (level == tree->depth) {
        visit_leaf(s, node - ((uint64_t)1 << level));
        return;
    }
    const int axis = tree->axes[node];
    const float beyond = s->position[axis] - tree->splits[node], side = s->sides[axis];
    const uint64_t near = 2 * node + (beyond >= 0);
    visit(s, near, level + 1, square);
    const float across = square - side * side + beyond * beyond;
    if (!(across < farthest(s))) return;
    s->sides[axis] = beyond;
    visit(s, near ^ 1, level + 1, across);
    s->sides[axis] = side;
}

/* self: as in `search`. */
static int find(const iso_tree *tree, const float position[3], size_t self, int most, iso_neighbour *found) {
    search s = {.tree = tree, .position = position, .self = self, .found = found, .most = most};
    visit(&s, 1, 0, 0);
    return s.count;
}

int iso_tree_nearest(const iso_tree *tree, size_t slot, int most, iso_neighbour *found) {
    return find(tree, tree->points[slot].position, slot, most, found);
}

int iso_tree_nearest_to(const iso_tree *tree, const float position[3], int most, iso_neighbour *found) {
    return find(tree, position, SIZE_MAX, most, found);
}
