/* patch_search: finds the patches that may be nearest to a point, and the nearest point of the surface in
 * them.
 *
 * Points whose distances are asked for one after the other tend to be near to each other. A search so keeps
 * candidates: all patches that may be nearest to any point within some radius of the point that it was for,
 * its centre. Of each candidate k it knows a lower bound e of its distance from the centre c, and a box. For
 * a point q = c + d and any point x of the candidate |q - x|^2 = |c - x|^2 + 2 d.(c - x) + d^2 is at least
 * e^2 + d.(2 c + d) - 2 max d.x over the box: for small d this tells candidates apart far better than their
 * boxes do, since it depends on the box times |d|, and lets most points do with one search of a patch. */
#include "grids/distance/patch_search.h"

#include <math.h>

#include "base/memory.h"
#include "grids/closing/triangle_tree.h"

/* MOST: the largest number of candidates. FEW, MANY: as many points within the radius make the next one
 * larger, or smaller. */
enum { MOST = 1024, FEW = 16, MANY = 512 };

/* The radius at first and at least, of a voxel; and at most, of the distance. */
static const double RADIUS = 1, LEAST_RADIUS = 1, MOST_RADIUS = 0.25;

/* Of the radius: there are candidates only where points are so close to each other. */
static const double CLOSE = 0.3;

/* A search from a triangle is taken to end where another one has ended if the start is so near to that end:
 * so many times the triangle's slack and so much of a voxel. */
static const double SAME_SLACK = 0.5, SAME_VOXEL = 0.02;

/* What is nearer by less than so much of a voxel is not searched for. */
static const double ENOUGH = 1e-9;

typedef struct candidate {
    double squared;     /* lower bound of its squared distance from the centre */
    double at[3];       /* exact: its point that is nearest to the centre */
    float lo[3], hi[3]; /* its box */
    uint32_t patch;
    bool exact; /* `squared` is not only a bound */
} candidate;

/* What iso_nearby keeps. */
typedef struct candidates {
    double last[3]; /* the point before */
    double centre[3], radius;
    double next_radius; /* of the next centre */
    int count, points;  /* 0: there are none; how many distances were found by them */
    candidate items[MOST];
} candidates;

typedef struct search {
    const iso_patch_tree *tree;
    double p[3];
    double best, squared; /* the least distance so far, and its square */
    double at[3];         /* the point of the surface that has it */
    size_t patch;
    double reach;     /* twice the radius within which candidates are kept */
    candidates *kept; /* NULL: none are */
} search;

/* ---- one patch */

static iso_vec3 vector(const double v[3]) {
    return iso_vec3_make(v[0], v[1], v[2]);
}

static double squared_between(const double a[3], const double b[3]) {
    const double x = a[0] - b[0], y = a[1] - b[1], z = a[2] - b[2];
    return x * x + y * y + z * z;
}

/* The points of a patch's first triangles that are nearest to p. */
enum { TRIANGLES = 8 };
typedef struct patch_triangles {
    int count, nearest;
    double distance[TRIANGLES], bound[TRIANGLES]; /* of the triangle; of the surface there, from below */
    double at[TRIANGLES][3];
    double least; /* of the bounds */
} patch_triangles;

static void measure_triangles(const search *s, const iso_patch *patch, patch_triangles *found) {
    found->count = (int)(patch->count < TRIANGLES ? patch->count : TRIANGLES);
    found->nearest = 0;
    found->least = INFINITY;
    for (int i = 0; i < found->count; i++) {
        const iso_patch_triangle *t = &s->tree->triangles[patch->first + (uint32_t)i];
        const iso_vec3 at = iso_triangle_nearest(t->corners, vector(s->p));
        found->at[i][0] = at.x, found->at[i][1] = at.y, found->at[i][2] = at.z;
        found->distance[i] = sqrt(squared_between(found->at[i], s->p));
        if (found->distance[i] < found->distance[found->nearest]) found->nearest = i;
        found->bound[i] = found->distance[i] - (double)t->slack;
        found->least = fmin(found->least, found->bound[i]);
    }
}

/* A patch while it is searched. */
typedef struct patch_field {
    const iso_patch_tree *tree;
    const iso_patch *patch;
    iso_cell_patch field;
    double p[3]; /* the point, in the cell */
} patch_field;

static patch_field open_patch(const search *s, const iso_patch *patch) {
    patch_field f = {.tree = s->tree, .patch = patch, .field = iso_patch_field(s->tree, patch)};
    iso_patch_to_cell(s->tree, patch, vector(s->p), f.p);
    return f;
}

/* The distance of the surface in a patch, searched from a start; INFINITY: it is not below `limit`. *end:
 * where the search ended. */
static double search_from(const patch_field *f, const double start[3], double limit, double end[3]) {
    const int *cell = f->patch->cell;
    double at[3];
    iso_patch_to_cell(f->tree, f->patch, vector(start), at);
    const double found = iso_cell_patch_nearest(&f->field, &f->tree->metric, f->p, limit, at);
    const iso_vec3 place =
        iso_affine_vector(&f->tree->affine, iso_vec3_make(at[0] + cell[0], at[1] + cell[1], at[2] + cell[2]));
    end[0] = place.x, end[1] = place.y, end[2] = place.z;
    return found < limit ? found : INFINITY;
}

/* The same from the nearest triangle, and from those triangles that may be nearer than what has been found,
 * unless a search has ended there. *at: the nearest point. */
static double search_patch(const search *s, const iso_patch *patch, const patch_triangles *triangles,
                           double limit, double at[3]) {
    const patch_field f = open_patch(s, patch);
    const double voxel = s->tree->metric.voxel;
    double best = INFINITY, ends[TRIANGLES + 1][3];
    int count = 0;
    for (int i = -1; i < triangles->count; i++) {
        const double *from = triangles->at[i >= 0 ? i : triangles->nearest];
        bool known = i >= 0 && triangles->bound[i] >= limit;
        for (int k = 0; k < count && !known; k++) {
            const double same =
                SAME_SLACK * (triangles->distance[i] - triangles->bound[i]) + SAME_VOXEL * voxel;
            known = squared_between(from, ends[k]) < same * same;
        }
        if (known) continue;
        const double found = search_from(&f, from, limit, ends[count]);
        if (found < limit) {
            best = found;
            limit = found - ENOUGH * voxel;
            for (int axis = 0; axis < 3; axis++) at[axis] = ends[count][axis];
        }
        count++;
    }
    return best;
}

static void improve(search *s, size_t patch, double distance, const double at[3]) {
    if (!(distance < s->best)) return;
    s->best = distance;
    s->squared = distance * distance;
    s->patch = patch;
    for (int axis = 0; axis < 3; axis++) s->at[axis] = at[axis];
}

/* ---- the tree */

/* The squared distance of a box from a place. */
static inline double box_squared(const float lo[3], const float hi[3], const double p[3]) {
    double squared = 0;
    for (int axis = 0; axis < 3; axis++) {
        const double below = (double)lo[axis] - p[axis], above = p[axis] - (double)hi[axis];
        const double out = below > above ? below : above;
        squared += out > 0 ? out * out : 0;
    }
    return squared;
}

/* The squared distance of a box's farthest corner. */
static inline double corner_squared(const float lo[3], const float hi[3], const double p[3]) {
    double squared = 0;
    for (int axis = 0; axis < 3; axis++) {
        const double below = p[axis] - (double)lo[axis], above = (double)hi[axis] - p[axis];
        const double out = below > above ? below : above;
        squared += out * out;
    }
    return squared;
}

/* Whether something in a box, with this squared distance or more, can be nearest to no point within the
 * radius: of these each has s->at, too, |q - x|^2 - |q - at|^2 = |p - x|^2 - |p - at|^2 + 2 d.(at - x). */
static inline bool is_beyond(const search *s, double squared, const float lo[3], const float hi[3]) {
    const double more = squared - s->squared;
    if (more < 0) return false;
    return !s->kept || more * more >= s->reach * s->reach * corner_squared(lo, hi, s->at);
}

static void keep(search *s, size_t number, const candidate *found) {
    candidates *kept = s->kept;
    const iso_patch *patch = &s->tree->patches[number];
    if (kept->count == MOST) { /* there are none then */
        kept->count = 0;
        kept->points = FEW;
        kept->next_radius /= 2;
        s->kept = NULL;
        return;
    }
    candidate *c = &kept->items[kept->count++];
    *c = *found;
    c->patch = (uint32_t)number;
    for (int axis = 0; axis < 3; axis++) {
        c->lo[axis] = patch->lo[axis];
        c->hi[axis] = patch->hi[axis];
    }
}

static void visit_patch(search *s, size_t number) {
    const iso_patch *patch = &s->tree->patches[number];
    patch_triangles triangles;
    candidate c = {.squared = box_squared(patch->lo, patch->hi, s->p)};
    if (is_beyond(s, c.squared, patch->lo, patch->hi)) return;
    measure_triangles(s, patch, &triangles);
    if (triangles.least > 0) c.squared = fmax(c.squared, triangles.least * triangles.least);
    if (is_beyond(s, c.squared, patch->lo, patch->hi)) return;
    if (c.squared < s->squared) {
        const double found = search_patch(s, patch, &triangles, s->best, c.at);
        c.exact = found < s->best;
        c.squared = c.exact ? found * found : s->squared;
        improve(s, number, found, c.at);
    }
    if (s->kept) keep(s, number, &c);
}

static void search_tree(search *s) {
    const iso_patch_tree *tree = s->tree;
    struct {
        size_t node;
        double squared;
    } stack[2 * ISO_PATCH_TREE_DEEPEST];
    int depth = 0;
    stack[depth].node = 0, stack[depth++].squared = box_squared(tree->nodes[0].lo, tree->nodes[0].hi, s->p);
    while (depth > 0) {
        const size_t i = stack[--depth].node;
        if (is_beyond(s, stack[depth].squared, tree->nodes[i].lo, tree->nodes[i].hi)) continue;
        if (i + 1 >= tree->leaves) {
            const size_t leaf = i + 1 - tree->leaves;
            for (size_t k = iso_patch_tree_leaf(tree, leaf); k < iso_patch_tree_leaf(tree, leaf + 1); k++)
                visit_patch(s, k);
            continue;
        }
        double squared[2];
        for (size_t k = 0; k < 2; k++)
            squared[k] = box_squared(tree->nodes[2 * i + 1 + k].lo, tree->nodes[2 * i + 1 + k].hi, s->p);
        const size_t nearer = squared[1] < squared[0]; /* comes last, so that it is visited first */
        stack[depth].node = 2 * i + 2 - nearer, stack[depth++].squared = squared[1 - nearer];
        stack[depth].node = 2 * i + 1 + nearer, stack[depth++].squared = squared[nearer];
    }
}

/* ---- candidates */

/* The lower bound of a candidate's squared distance from the centre + d. */
static inline double bound_of(const candidate *c, const double d[3], double rest) {
    double most = 0;
    for (int axis = 0; axis < 3; axis++) most += d[axis] * (double)(d[axis] > 0 ? c->hi[axis] : c->lo[axis]);
    return c->squared + rest - 2 * most;
}

/* Finds a candidate's nearest point to the centre. */
static void make_exact(const search *s, const candidates *kept, candidate *c) {
    const iso_patch *patch = &s->tree->patches[c->patch];
    search at_centre = {.tree = s->tree};
    patch_triangles triangles;
    for (int axis = 0; axis < 3; axis++) at_centre.p[axis] = kept->centre[axis];
    measure_triangles(&at_centre, patch, &triangles);
    const double found = search_patch(&at_centre, patch, &triangles, INFINITY, c->at);
    c->squared = fmax(c->squared, found * found);
    c->exact = found < INFINITY;
}

/* Searches a candidate's surface. Its starts are those of a search without candidates, so that distances do
 * not depend on the searches before, also where a search ends in a local minimum. */
static void search_candidate(search *s, const candidate *c, double limit) {
    const iso_patch *patch = &s->tree->patches[c->patch];
    patch_triangles triangles;
    double at[3];
    measure_triangles(s, patch, &triangles);
    improve(s, c->patch, search_patch(s, patch, &triangles, limit, at), at);
}

static void search_candidates(search *s, candidates *kept) {
    const candidate *nearest = NULL;
    double d[3], rest = 0;
    for (int axis = 0; axis < 3; axis++) {
        d[axis] = s->p[axis] - kept->centre[axis];
        rest += d[axis] * (2 * kept->centre[axis] + d[axis]);
    }
    double least = INFINITY;
    for (int i = 0; i < kept->count; i++) {
        const candidate *c = &kept->items[i];
        const double squared = c->exact ? squared_between(c->at, s->p) : INFINITY;
        if (squared < least) least = squared, nearest = c;
    }
    if (nearest) search_candidate(s, nearest, INFINITY);
    for (int i = 0; i < kept->count; i++) {
        candidate *c = &kept->items[i];
        const double limit = s->best - ENOUGH * s->tree->metric.voxel;
        if (c == nearest || !(bound_of(c, d, rest) < limit * limit)) continue;
        if (!c->exact) make_exact(s, kept, c);
        if (bound_of(c, d, rest) < limit * limit) search_candidate(s, c, limit);
    }
}

/* Whether there are candidates for p. */
static bool are_near(const candidates *kept, const double p[3]) {
    return kept->count && squared_between(kept->centre, p) <= kept->radius * kept->radius;
}

/* Makes p the centre. */
static void begin(search *s, candidates *kept) {
    const double voxel = s->tree->metric.voxel;
    if (kept->points < FEW) kept->next_radius *= 2;
    if (kept->points > MANY) kept->next_radius /= 2;
    kept->next_radius = fmin(kept->next_radius, MOST_RADIUS * s->best);
    kept->next_radius = fmax(kept->next_radius, LEAST_RADIUS * voxel);
    kept->radius = kept->next_radius;
    kept->count = kept->points = 0;
    for (int axis = 0; axis < 3; axis++) kept->centre[axis] = s->p[axis];
    s->kept = kept;
    s->reach = 2 * kept->radius;
}

/* Leaves out what the nearest point has shown to be beyond the radius. */
static void end(search *s, candidates *kept) {
    int count = 0;
    for (int i = 0; i < kept->count; i++) {
        const candidate *c = &kept->items[i];
        if (!is_beyond(s, c->squared, c->lo, c->hi)) kept->items[count++] = *c;
    }
    kept->count = count;
}

/* The candidates, from the second search on; NULL: there is no memory for them, and no need. */
static candidates *find_candidates(const iso_patch_tree *tree, iso_nearby *nearby) {
    candidates *kept = nearby->memory;
    if (kept || nearby->searches++ == 0 || !(kept = iso_alloc(sizeof *kept))) return kept;
    nearby->memory = kept;
    kept->count = 0;
    kept->points = FEW;
    kept->next_radius = RADIUS * tree->metric.voxel;
    for (int axis = 0; axis < 3; axis++) kept->last[axis] = INFINITY;
    return kept;
}

double iso_patch_search(const iso_patch_tree *tree, iso_vec3 p, iso_nearby *nearby) {
    search s = {.tree = tree, .p = {p.x, p.y, p.z}, .best = INFINITY, .squared = INFINITY};
    candidates *kept = find_candidates(tree, nearby);
    if (kept && are_near(kept, s.p)) {
        kept->points++;
        search_candidates(&s, kept);
    } else {
        const iso_patch *guess = &tree->patches[nearby->last];
        patch_triangles triangles;
        double at[3];
        measure_triangles(&s, guess, &triangles);
        improve(&s, nearby->last, search_patch(&s, guess, &triangles, INFINITY, at), at);
        if (kept) begin(&s, kept);
        if (kept && !(squared_between(kept->last, s.p) < CLOSE * CLOSE * kept->radius * kept->radius)) {
            s.kept = NULL;
            kept->points = FEW;
        }
        search_tree(&s);
        if (s.kept) end(&s, kept);
    }
    nearby->last = s.patch;
    for (int axis = 0; axis < 3 && kept; axis++) kept->last[axis] = s.p[axis];
    return s.best;
}
