/* scene_tree: grows stems level by level, each as a line and as rings of triangles around it. */
#include "scene_tree.h"

#include <math.h>
#include <string.h>

#include "base/memory.h"

enum { LEVELS = 4, MOST_SEGMENTS = 12, RING = 3, LEAF_CORNERS = 6, LEAF_TRIANGLES = 4, LEAF_VERTICES = 4 };

/* The stems of a level. Angles in degrees. */
typedef struct level {
    int segments;
    double length; /* of the parent's; of the trunk mm */
    double curve;  /* by how much a stem bends from its foot to its tip, */
    double turn;   /* and at most, at random, at each vertex */
    double down;   /* between a stem and its parent */
    int children;  /* stems of the next level, of the last level leaves */
    double bare;   /* the part of the stem, from its foot, that carries nothing */
    double radius; /* of the parent's where the stem begins; of the trunk mm */
} level;

static const level LEVEL[LEVELS] = {{12, 950, 4, 3, 0, 50, 0.18, 22},
                                    {8, 0.42, -30, 10, 62, 16, 0.15, 0.42},
                                    {5, 0.3, -12, 14, 50, 22, 0.1, 0.45},
                                    {3, 0.28, 0, 18, 48, 3, 0.1, 0.5}};
static const double GOLDEN_ANGLE = 137.50776405003785, LEAF_LENGTH = 11, LEAF_WIDTH = 2.6, LEAF_DOWN = 50;

/* ---- frames */

/* Where a stem is: its direction is `way`; `side` is perpendicular to it. */
typedef struct frame {
    iso_vec3 at, way, side;
} frame;

static iso_vec3 add_scaled(iso_vec3 a, iso_vec3 b, double s) {
    return iso_vec3_add(a, iso_vec3_scale(b, s));
}

/* A vector perpendicular to the axis, turned around it. */
static iso_vec3 turned(iso_vec3 vector, iso_vec3 axis, double degrees) {
    double sine, cosine;
    iso_sincos(degrees * ISO_PI / 180, &sine, &cosine);
    return add_scaled(iso_vec3_scale(vector, cosine), iso_vec3_cross(axis, vector), sine);
}

/* Tilts a frame away from its direction, towards the side that is turned by `around` from its own. */
static frame tilted(const frame *from, double around, double degrees) {
    double sine, cosine;
    iso_sincos(degrees * ISO_PI / 180, &sine, &cosine);
    const iso_vec3 side = turned(from->side, from->way, around);
    return (frame){from->at, add_scaled(iso_vec3_scale(from->way, cosine), side, sine),
                   add_scaled(iso_vec3_scale(side, cosine), from->way, -sine)};
}

/* Bends a stem: the same without a turn of the frame around its direction. */
static frame bent(const frame *from, double around, double degrees) {
    frame f = tilted(from, around, degrees);
    f.side = turned(f.side, f.way, -around);
    return f;
}

/* ---- growing */

typedef struct growth {
    iso_scene_tree *tree;
    double part; /* of the branches of each level */
    uint64_t seed;
} growth;

static double uniform(growth *g) {
    g->seed = g->seed * 6364136223846793005u + 1442695040888963407u;
    return (double)(g->seed >> 11) / 9007199254740992.0;
}

static double around_0(growth *g, double most) {
    return most * (2 * uniform(g) - 1);
}

static void put(float to[3], iso_vec3 from) {
    to[0] = (float)from.x, to[1] = (float)from.y, to[2] = (float)from.z;
}

static void add_triangle(iso_triangles *mesh, size_t a, size_t b, size_t c) {
    uint32_t *to = mesh->triangles[mesh->triangle_count++];
    to[0] = (uint32_t)a, to[1] = (uint32_t)b, to[2] = (uint32_t)c;
}

static void add_line_vertex(iso_lines *lines, iso_vec3 at, double radius) {
    put(lines->vertices[lines->vertex_count], at);
    lines->radii[lines->vertex_count++] = (float)radius;
}

/* A vertex of a stem, and the ring around it, which is joined to the ring before unless it is the first. */
static void add_ring(iso_scene_tree *tree, const frame *f, double radius, bool first) {
    iso_triangles *mesh = &tree->wood_mesh;
    const size_t ring = mesh->vertex_count;
    add_line_vertex(&tree->wood, f->at, radius);
    for (int i = 0; i < RING; i++)
        put(mesh->vertices[mesh->vertex_count++],
            add_scaled(f->at, turned(f->side, f->way, i * 360.0 / RING), radius));
    for (size_t i = 0; i < RING && !first; i++) {
        const size_t next = (i + 1) % RING, before = ring - RING;
        add_triangle(mesh, before + i, before + next, ring + next);
        add_triangle(mesh, before + i, ring + next, ring + i);
    }
}

/* A leaf from f->at along f->way, its face across f->side. */
static void add_leaf(growth *g, const frame *f) {
    iso_scene_tree *tree = g->tree;
    iso_triangles *mesh = &tree->leaf_mesh;
    const double length = LEAF_LENGTH * (0.7 + 0.6 * uniform(g)), width = LEAF_WIDTH * length / LEAF_LENGTH;
    const iso_vec3 across = iso_vec3_cross(f->way, f->side);
    const double along[LEAF_VERTICES] = {0, 0.35, 0.7, 1}, wide[LEAF_VERTICES] = {0.05, 1, 0.8, 0.05};
    const size_t first = mesh->vertex_count;
    for (int i = 0; i < LEAF_VERTICES; i++) {
        const iso_vec3 at = add_scaled(f->at, f->way, along[i] * length);
        const bool end = i == 0 || i == LEAF_VERTICES - 1;
        put(tree->leaves.normals[tree->leaves.vertex_count], f->side);
        add_line_vertex(&tree->leaves, at, wide[i] * width);
        if (!end) put(mesh->vertices[mesh->vertex_count++], add_scaled(at, across, -wide[i] * width));
        put(mesh->vertices[mesh->vertex_count++], end ? at : add_scaled(at, across, wide[i] * width));
    }
    tree->leaves.starts[++tree->leaves.line_count] = tree->leaves.vertex_count;
    add_triangle(mesh, first, first + 2, first + 1);
    add_triangle(mesh, first + 1, first + 2, first + 4);
    add_triangle(mesh, first + 1, first + 4, first + 3);
    add_triangle(mesh, first + 3, first + 4, first + 5);
}

static int children_of(const growth *g, int number) {
    const int all = LEVEL[number].children;
    const int some = (int)(all * g->part + 0.5);
    return number == LEVELS - 1 ? all : some > 1 ? some : 1;
}

static void add_stem(growth *g, int number, const frame *foot, double length, double radius);

/* What a stem carries on a segment, which begins at f->at. */
static void add_children(growth *g, int number, const frame *f, int segment, double length, double radius) {
    const level *own = &LEVEL[number], *next = number + 1 < LEVELS ? own + 1 : NULL;
    const int count = children_of(g, number);
    for (int i = 0; i < count; i++) {
        const double place = own->bare + (1 - own->bare) * (i + 0.5) / count;
        if ((int)(place * own->segments) != segment) continue;
        frame foot = *f;
        foot.at = add_scaled(foot.at, foot.way, (place - (double)segment / own->segments) * length);
        const double around = i * GOLDEN_ANGLE + around_0(g, 20);
        foot = tilted(&foot, around, (next ? next->down : LEAF_DOWN) + around_0(g, 12));
        if (!next) {
            add_leaf(g, &foot);
            continue;
        }
        /* the crown is widest at a third of its height */
        const double shape = number ? 1 - 0.5 * place : place < 0.4 ? 0.6 + place : 1.4 - place;
        add_stem(g, number + 1, &foot, next->length * length * shape,
                 next->radius * radius * (1 - 0.7 * place));
    }
}

static void add_stem(growth *g, int number, const frame *foot, double length, double radius) {
    const level *own = &LEVEL[number];
    iso_lines *wood = &g->tree->wood;
    frame frames[MOST_SEGMENTS + 1] = {*foot};
    add_ring(g->tree, &frames[0], radius, true);
    for (int i = 0; i < own->segments; i++) {
        frame f = frames[i];
        f.at = add_scaled(f.at, f.way, length / own->segments);
        f = bent(&f, 0, own->curve / own->segments + around_0(g, own->turn));
        f = bent(&f, 90, around_0(g, own->turn));
        frames[i + 1] = f;
        add_ring(g->tree, &f, radius * (1 - 0.85 * (i + 1) / own->segments), false);
    }
    wood->starts[++wood->line_count] = wood->vertex_count;
    for (int i = 0; i < own->segments; i++) add_children(g, number, &frames[i], i, length, radius);
}

/* ---- the tree */

typedef struct counts {
    size_t stems, vertices, leaves; /* vertices: of the stems */
} counts;

static counts count_all(const growth *g) {
    counts c = {0};
    size_t stems = 1;
    for (int number = 0; number < LEVELS; number++) {
        c.stems += stems;
        c.vertices += stems * (size_t)(LEVEL[number].segments + 1);
        stems *= (size_t)children_of(g, number);
    }
    c.leaves = stems;
    return c;
}

static bool reserve_lines(iso_lines *lines, size_t count, size_t vertices, bool normals) {
    lines->vertices = iso_alloc(vertices * sizeof *lines->vertices);
    lines->radii = iso_alloc(vertices * sizeof *lines->radii);
    lines->starts = iso_alloc_zero(count + 1, sizeof *lines->starts);
    if (normals) lines->normals = iso_alloc(vertices * sizeof *lines->normals);
    return lines->vertices && lines->radii && lines->starts && (lines->normals || !normals);
}

static bool reserve_mesh(iso_triangles *mesh, size_t vertices, size_t triangles) {
    mesh->vertices = iso_alloc(vertices * sizeof *mesh->vertices);
    mesh->triangles = iso_alloc(triangles * sizeof *mesh->triangles);
    return mesh->vertices && mesh->triangles;
}

iso_status iso_scene_tree_make(const iso_scene_tree_opts *opts, iso_scene_tree *tree, iso_error *error) {
    growth g = {.tree = tree, .part = opts && opts->size > 0 ? opts->size : 1, .seed = opts ? opts->seed : 0};
    const counts c = count_all(&g);
    const frame foot = {.at = {0, 0, 0}, .way = {0, 0, 1}, .side = {1, 0, 0}};
    *tree = (iso_scene_tree){.wood = {.line_count = 0}};
    if (!reserve_lines(&tree->wood, c.stems, c.vertices, false) ||
        !reserve_lines(&tree->leaves, c.leaves, c.leaves * LEAF_VERTICES, true) ||
        !reserve_mesh(&tree->wood_mesh, c.vertices * RING, 2 * c.vertices * RING) ||
        !reserve_mesh(&tree->leaf_mesh, c.leaves * LEAF_CORNERS, c.leaves * LEAF_TRIANGLES)) {
        iso_scene_tree_free(tree);
        return iso_fail_memory(error, "a tree");
    }
    add_stem(&g, 0, &foot, LEVEL[0].length, LEVEL[0].radius);
    return ISO_OK;
}

static void free_mesh(iso_triangles *mesh) {
    iso_free(mesh->vertices);
    iso_free(mesh->triangles);
    *mesh = (iso_triangles){.vertex_count = 0};
}

void iso_scene_tree_free(iso_scene_tree *tree) {
    iso_lines_free(&tree->wood);
    iso_lines_free(&tree->leaves);
    free_mesh(&tree->wood_mesh);
    free_mesh(&tree->leaf_mesh);
}
