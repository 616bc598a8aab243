/* patch_tree: finds the patches in a mesh, measures how far they are from its triangles, and builds the
 * tree. */
#include "grids/distance/patch_tree.h"

#include <math.h>
#include <string.h>

#include "base/memory.h"
#include "grids/closing/triangle_reach.h"

/* How much farther than measured at a few places the surface of a cell may be from its triangles; and at
 * least, in voxels: triangles are stored in floats. */
static const double SLACK_FACTOR = 2, SLACK_LEAST = 1e-3;

/* LEAF: the largest number of patches of a leaf. MORTON_BITS: bits of a Morton key for each axis. */
enum { PATCHES_PER_TASK = 2048, LEAF = 2, MORTON_BITS = 10 };

iso_cell_patch iso_patch_field(const iso_patch_tree *tree, const iso_patch *patch) {
    double corners[8];
    for (int i = 0; i < 8; i++) corners[i] = (double)patch->corners[i] - tree->isovalue;
    return iso_cell_patch_make(corners);
}

void iso_patch_to_cell(const iso_patch_tree *tree, const iso_patch *patch, iso_vec3 place, double at[3]) {
    const iso_vec3 index = iso_affine_vector_to_index(&tree->affine, place);
    at[0] = index.x - patch->cell[0];
    at[1] = index.y - patch->cell[1];
    at[2] = index.z - patch->cell[2];
}

/* ---- patches */

/* The cell that a triangle lies in, and the grid's values there. False: there is no surface. */
static bool find_cell(const iso_grid *grid, const iso_triangles *mesh, size_t triangle, iso_patch *patch) {
    for (int axis = 0; axis < 3; axis++) {
        double sum = 0;
        for (int k = 0; k < 3; k++) sum += (double)mesh->vertices[mesh->triangles[triangle][k]][axis];
        const int last = iso_grid_dims(grid)[axis] - 2;
        if (last < 0) return false;
        patch->cell[axis] = sum < 0 ? 0 : sum / 3 > last ? last : (int)(sum / 3);
    }
    for (int i = 0; i < 8; i++) {
        const int *cell = patch->cell;
        patch->corners[i] = iso_grid_at(grid, cell[0] + (i & 1), cell[1] + (i >> 1 & 1), cell[2] + (i >> 2));
        if (!isfinite(patch->corners[i])) return false;
    }
    return true;
}

static bool share_a_vertex(const uint32_t a[3], const uint32_t b[3]) {
    for (int i = 0; i < 9; i++)
        if (a[i / 3] == b[i % 3]) return true;
    return false;
}

/* Whether a triangle goes on with a patch that the triangles from `first` up to it belong to. */
static bool continues(const iso_triangles *mesh, const iso_patch *patch, size_t first, size_t triangle,
                      const int cell[3]) {
    if (memcmp(cell, patch->cell, sizeof patch->cell) != 0) return false;
    for (size_t i = first; i < triangle; i++)
        if (share_a_vertex(mesh->triangles[i], mesh->triangles[triangle])) return true;
    return false;
}

static void place_triangle(const iso_affine *affine, const iso_triangles *mesh, size_t triangle,
                           iso_patch_triangle *placed) {
    for (int k = 0; k < 3; k++) {
        const float *v = mesh->vertices[mesh->triangles[triangle][k]];
        const iso_vec3 place =
            iso_affine_vector(affine, iso_vec3_make((double)v[0], (double)v[1], (double)v[2]));
        placed->corners[k][0] = (float)place.x;
        placed->corners[k][1] = (float)place.y;
        placed->corners[k][2] = (float)place.z;
    }
}

/* Triangles without an area, which lie where the surface only touches a voxel, are left out unless `all`. The
 * triangles of a cell follow each other in meshes of Marching Cubes; where they do not, the cell has several
 * patches. */
static void find_patches(const iso_grid *grid, const iso_triangles *mesh, bool all, iso_patch_tree *tree) {
    size_t first = 0;
    uint32_t placed = 0;
    for (size_t i = 0; i < mesh->triangle_count; i++) {
        iso_patch found, *last = tree->count ? &tree->patches[tree->count - 1] : NULL;
        if ((!all && !iso_triangle_has_area(mesh, i)) || !find_cell(grid, mesh, i, &found)) {
            first = i + 1;
            continue;
        }
        place_triangle(&tree->affine, mesh, i, &tree->triangles[placed]);
        if (last && first < i && continues(mesh, last, first, i, found.cell)) {
            last->count++;
        } else {
            found.first = placed;
            found.count = 1;
            tree->patches[tree->count++] = found;
            first = i;
        }
        placed++;
    }
}

/* ---- slack and boxes */

static float slack_of(const iso_patch_tree *tree, const iso_patch *patch, const iso_cell_patch *field,
                      const iso_patch_triangle *t) {
    /* the middle of a triangle, and of its sides */
    static const double weights[4][3] = {
        {1 / 3.0, 1 / 3.0, 1 / 3.0}, {0.5, 0.5, 0}, {0, 0.5, 0.5}, {0.5, 0, 0.5}};
    double most = 0;
    for (int i = 0; i < 4; i++) {
        double sum[3] = {0}, at[3];
        for (int k = 0; k < 9; k++) sum[k % 3] += weights[i][k / 3] * (double)t->corners[k / 3][k % 3];
        iso_patch_to_cell(tree, patch, iso_vec3_make(sum[0], sum[1], sum[2]), at);
        most = fmax(most, iso_cell_patch_offset(field, &tree->metric, at));
    }
    return (float)(SLACK_FACTOR * most + SLACK_LEAST * tree->metric.voxel);
}

/* The surface is within the slack of its triangles, and within the cell. */
static void measure_patch(const iso_patch_tree *tree, iso_patch *patch) {
    const iso_cell_patch field = iso_patch_field(tree, patch);
    const int *cell = patch->cell;
    const iso_box own = {{cell[0], cell[1], cell[2]}, {cell[0] + 1, cell[1] + 1, cell[2] + 1}};
    iso_affine turned = tree->affine;
    turned.origin[0] = turned.origin[1] = turned.origin[2] = 0;
    const iso_box box = iso_box_transform(&own, &turned);
    const double lo[3] = {box.lo.x, box.lo.y, box.lo.z}, hi[3] = {box.hi.x, box.hi.y, box.hi.z};
    const float little = (float)(SLACK_LEAST * tree->metric.voxel);
    for (int axis = 0; axis < 3; axis++) patch->lo[axis] = INFINITY, patch->hi[axis] = -INFINITY;
    for (uint32_t i = patch->first; i < patch->first + patch->count; i++) {
        iso_patch_triangle *t = &tree->triangles[i];
        t->slack = slack_of(tree, patch, &field, t);
        for (int k = 0; k < 9; k++) {
            patch->lo[k % 3] = fminf(patch->lo[k % 3], t->corners[k / 3][k % 3] - t->slack);
            patch->hi[k % 3] = fmaxf(patch->hi[k % 3], t->corners[k / 3][k % 3] + t->slack);
        }
    }
    for (int axis = 0; axis < 3; axis++) {
        patch->lo[axis] = fmaxf(patch->lo[axis], (float)lo[axis] - little);
        patch->hi[axis] = fminf(patch->hi[axis], (float)hi[axis] + little);
    }
}

static void measure_patches(void *context, size_t index, int worker) {
    (void)worker;
    const iso_patch_tree *tree = context;
    const size_t first = index * PATCHES_PER_TASK;
    for (size_t i = first; i < first + PATCHES_PER_TASK && i < tree->count; i++)
        measure_patch(tree, &tree->patches[i]);
}

/* ---- the tree */

/* Inserts two zero bits before each of the low ten bits of x. */
static uint32_t spread(uint32_t x) {
    x = (x | x << 16) & 0x030000ffu;
    x = (x | x << 8) & 0x0300f00fu;
    x = (x | x << 4) & 0x030c30c3u;
    return (x | x << 2) & 0x09249249u;
}

static uint32_t key_of(const iso_patch *patch, int shift) {
    uint32_t key = 0;
    for (int axis = 0; axis < 3; axis++) key |= spread((uint32_t)patch->cell[axis] >> shift) << axis;
    return key;
}

/* Sorts by key: a stable radix sort of three passes, of which the last leaves the patches in `to`. */
static void sort_patches(iso_patch *from, iso_patch *to, size_t count, int shift) {
    enum { BUCKETS = 1 << MORTON_BITS };
    for (int pass = 0; pass < 3; pass++) {
        size_t first[BUCKETS + 1] = {0};
        const int low = MORTON_BITS * pass;
        for (size_t i = 0; i < count; i++) first[(key_of(&from[i], shift) >> low & (BUCKETS - 1)) + 1]++;
        for (int b = 0; b < BUCKETS; b++) first[b + 1] += first[b];
        for (size_t i = 0; i < count; i++)
            to[first[key_of(&from[i], shift) >> low & (BUCKETS - 1)]++] = from[i];
        iso_patch *other = from;
        from = to;
        to = other;
    }
}

static iso_status order_patches(const iso_grid *grid, iso_patch_tree *tree, iso_error *error) {
    const int *dims = iso_grid_dims(grid);
    int shift = 0;
    iso_patch *ordered = iso_alloc(tree->count * sizeof *ordered);
    if (!ordered) return iso_fail(error, ISO_ERR_NOMEM, "out of memory for distances");
    for (int axis = 0; axis < 3; axis++)
        while (dims[axis] >> shift >= 1 << MORTON_BITS) shift++;
    sort_patches(tree->patches, ordered, tree->count, shift);
    iso_free(tree->patches);
    tree->patches = ordered;
    return ISO_OK;
}

static void add_box(iso_patch_node *n, const float lo[3], const float hi[3]) {
    for (int axis = 0; axis < 3; axis++) {
        n->lo[axis] = fminf(n->lo[axis], lo[axis]);
        n->hi[axis] = fmaxf(n->hi[axis], hi[axis]);
    }
}

static void build_nodes(iso_patch_tree *tree) {
    for (size_t i = 2 * tree->leaves - 1; i-- > 0;) {
        iso_patch_node *n = &tree->nodes[i];
        *n = (iso_patch_node){{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};
        if (i + 1 < tree->leaves) {
            for (size_t k = 2 * i + 1; k < 2 * i + 3; k++) add_box(n, tree->nodes[k].lo, tree->nodes[k].hi);
            continue;
        }
        const size_t leaf = i - (tree->leaves - 1);
        for (size_t k = iso_patch_tree_leaf(tree, leaf); k < iso_patch_tree_leaf(tree, leaf + 1); k++)
            add_box(n, tree->patches[k].lo, tree->patches[k].hi);
    }
}

iso_status iso_patch_tree_create(const iso_grid *grid, double isovalue, const iso_triangles *mesh,
                                 iso_pool *pool, iso_patch_tree *tree, iso_error *error) {
    static const char message[] = "out of memory for distances from %zu triangles";
    const size_t most = mesh->triangle_count ? mesh->triangle_count : 1;
    tree->affine = iso_transform_affine(iso_grid_transform(grid));
    tree->metric = iso_cell_metric_make(tree->affine.m);
    tree->isovalue = isovalue;
    tree->triangles = iso_alloc(most * sizeof *tree->triangles);
    tree->patches = iso_alloc(most * sizeof *tree->patches);
    if (!tree->triangles || !tree->patches) return iso_fail(error, ISO_ERR_NOMEM, message, most);
    find_patches(grid, mesh, false, tree);
    if (!tree->count) find_patches(grid, mesh, true, tree);
    if (!tree->count) return iso_fail(error, ISO_ERR_EMPTY, "there is no surface to measure from");
    ISO_TRY(order_patches(grid, tree, error));
    iso_parallel_for(pool, (tree->count + PATCHES_PER_TASK - 1) / PATCHES_PER_TASK, measure_patches, tree);
    while ((size_t)LEAF << tree->depth < tree->count) tree->depth++;
    tree->leaves = (size_t)1 << tree->depth;
    tree->nodes = iso_alloc(2 * tree->leaves * sizeof *tree->nodes);
    if (!tree->nodes) return iso_fail(error, ISO_ERR_NOMEM, message, most);
    build_nodes(tree);
    return ISO_OK;
}

void iso_patch_tree_free(iso_patch_tree *tree) {
    iso_free(tree->triangles);
    iso_free(tree->patches);
    iso_free(tree->nodes);
    *tree = (iso_patch_tree){.patches = NULL};
}
