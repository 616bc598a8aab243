/* Closes meshes: open loops are classified, then capped in the faces of the bounding box (mesh_border.h) or
 * filled with the triangulation of least area (Barequet and Sharir 1995). */
#include "grids/closing/closed_mesh.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/memory.h"
#include "grids/closing/mesh_border.h"
#include "grids/closing/mesh_topology.h"

/* Loops of up to this many edges are filled with the triangulation of least area, which takes cubic time;
 * longer loops with a fan of triangles around their centroid. */
enum { LEAST_AREA = 64 };
/* A loop is a crack if the area of its filling is below this fraction of its squared perimeter: it is then
 * 250 times as long as wide. */
static const double CRACK = 1e-3;
/* A closed mesh counts as a sheet, which encloses nothing, if its volume is below this fraction of its area
 * times the longest side of its box. */
static const double SHEET = 1e-6;

struct iso_closed_mesh {
    iso_mesh_topology topology;
    iso_triangles mesh; /* owned: the topology's mesh with the triangles of fillings */
    size_t vertex_room, triangle_room;
    iso_triangle_tree *surface,
        *caps; /* over the triangles of `mesh`, and over the fans of the caps; caps NULL: there are none */
    iso_border border;
    iso_mesh_report report;
};

static iso_vec3 vertex(const iso_triangles *mesh, uint32_t number) {
    const float *v = mesh->vertices[number];
    return iso_vec3_make(v[0], v[1], v[2]);
}

/* ---- adding vertices and triangles */

static bool grow(void **memory, size_t *room, size_t count, size_t size) {
    if (count < *room) return true;
    const size_t more = 2 * count + 64;
    void *grown = iso_alloc(more * size);
    if (!grown) return false;
    if (count) memcpy(grown, *memory, count * size);
    iso_free(*memory);
    *memory = grown;
    *room = more;
    return true;
}

static bool add_vertex(iso_closed_mesh *c, iso_vec3 p) {
    void *memory = c->mesh.vertices;
    const bool room = grow(&memory, &c->vertex_room, c->mesh.vertex_count, sizeof *c->mesh.vertices);
    c->mesh.vertices = memory;
    if (!room) return false;
    float *v = c->mesh.vertices[c->mesh.vertex_count++];
    v[0] = (float)p.x;
    v[1] = (float)p.y;
    v[2] = (float)p.z;
    return true;
}

static bool add_triangle(iso_closed_mesh *c, uint32_t first, uint32_t second, uint32_t third) {
    void *memory = c->mesh.triangles;
    const bool room = grow(&memory, &c->triangle_room, c->mesh.triangle_count, sizeof *c->mesh.triangles);
    c->mesh.triangles = memory;
    if (!room) return false;
    uint32_t *t = c->mesh.triangles[c->mesh.triangle_count++];
    t[0] = first;
    t[1] = second;
    t[2] = third;
    return true;
}

/* ---- filling loops: the new triangles have the edges of the loop in the opposite direction */

static double triangle_area(iso_vec3 a, iso_vec3 b, iso_vec3 c) {
    return 0.5 * iso_vec3_length(iso_vec3_cross(iso_vec3_sub(b, a), iso_vec3_sub(c, a)));
}

/* The triangulation of a loop with the least area (Barequet and Sharir 1995). area[i][k]: the area of the
 * polygon of vertices i .. k. split[i][k]: the third corner of the triangle on the edge between k and i. */
typedef struct filling {
    double area[LEAST_AREA][LEAST_AREA];
    uint8_t split[LEAST_AREA][LEAST_AREA];
} filling;

/* Finds the triangulation of a loop with the least area and returns this area. */
static double find_filling(const iso_triangles *mesh, const uint32_t *loop, int count, filling *f) {
    for (int i = 0; i + 1 < count; i++) f->area[i][i + 1] = 0;
    for (int width = 2; width < count; width++)
        for (int i = 0; i + width < count; i++) {
            const int k = i + width;
            f->area[i][k] = INFINITY;
            for (int m = i + 1; m < k; m++) {
                const double area =
                    f->area[i][m] + f->area[m][k] +
                    triangle_area(vertex(mesh, loop[i]), vertex(mesh, loop[m]), vertex(mesh, loop[k]));
                if (area >= f->area[i][k]) continue;
                f->area[i][k] = area;
                f->split[i][k] = (uint8_t)m;
            }
        }
    return f->area[0][count - 1];
}

static bool add_filling(iso_closed_mesh *c, const uint32_t *loop, const filling *f, int i, int k) {
    if (k - i < 2) return true;
    const int m = f->split[i][k];
    return add_triangle(c, loop[k], loop[m], loop[i]) && add_filling(c, loop, f, i, m) &&
           add_filling(c, loop, f, m, k);
}

static bool fill_with_fan(iso_closed_mesh *c, const uint32_t *loop, size_t count) {
    iso_vec3 sum = {0, 0, 0};
    for (size_t i = 0; i < count; i++) sum = iso_vec3_add(sum, vertex(&c->mesh, loop[i]));
    const uint32_t middle = (uint32_t)c->mesh.vertex_count;
    bool whole = add_vertex(c, iso_vec3_scale(sum, 1 / (double)count));
    for (size_t i = 0; whole && i < count; i++)
        whole = add_triangle(c, loop[(i + 1) % count], loop[i], middle);
    return whole;
}

/* ---- how each loop is closed */

typedef enum loop_kind { LOOP_BORDER, LOOP_FILL, LOOP_TOO_LARGE } loop_kind;

typedef struct closing {
    const char *path;
    iso_closed_mesh *closed;
    filling *scratch;
    double most;                  /* largest hole to fill, mm */
    uint32_t (*border)[2];        /* edges of loops in the faces of the box, which are to be capped */
    size_t border_count, refused; /* numbers of such edges, and of loops that are too large */
    double largest_refused;
} closing;

static const uint32_t *loop_of(const iso_mesh_topology *t, size_t loop, size_t *count) {
    *count = t->loop_first[loop + 1] - t->loop_first[loop];
    return t->loop_vertices + t->loop_first[loop];
}

static double loop_size(const iso_triangles *mesh, const uint32_t *loop, size_t count) {
    iso_box box = iso_box_empty();
    for (size_t i = 0; i < count; i++) iso_box_add(&box, vertex(mesh, loop[i]));
    return iso_vec3_length(iso_vec3_sub(box.hi, box.lo));
}

static bool is_crack(const closing *c, const uint32_t *loop, size_t count) {
    double perimeter = 0;
    if (count > LEAST_AREA) return false;
    for (size_t i = 0; i < count; i++)
        perimeter += iso_vec3_length(
            iso_vec3_sub(vertex(&c->closed->mesh, loop[(i + 1) % count]), vertex(&c->closed->mesh, loop[i])));
    return find_filling(&c->closed->mesh, loop, (int)count, c->scratch) <= CRACK * perimeter * perimeter;
}

static bool in_border(const closing *c, const uint32_t *loop, size_t count) {
    for (size_t i = 0; i < count; i++)
        if (!iso_border_holds(&c->closed->border, c->closed->mesh.vertices[loop[i]],
                              c->closed->mesh.vertices[loop[(i + 1) % count]]))
            return false;
    return true;
}

/* Decides how a loop is closed; `capped`: loops in the faces of the box are to be capped. */
static loop_kind choose_kind(const closing *c, const uint32_t *loop, size_t count, bool capped) {
    if (count == 3) return LOOP_FILL; /* a single triangle is missing */
    if (capped && in_border(c, loop, count)) return LOOP_BORDER;
    if (loop_size(&c->closed->mesh, loop, count) <= c->most || is_crack(c, loop, count)) return LOOP_FILL;
    return LOOP_TOO_LARGE;
}

static bool fill_hole(closing *c, const uint32_t *loop, size_t count) {
    iso_closed_mesh *closed = c->closed;
    closed->report.holes_closed++;
    closed->report.largest_hole = fmax(closed->report.largest_hole, loop_size(&closed->mesh, loop, count));
    if (count > LEAST_AREA) return fill_with_fan(closed, loop, count);
    find_filling(&closed->mesh, loop, (int)count, c->scratch);
    return add_filling(closed, loop, c->scratch, 0, (int)count - 1);
}

static void add_border_edges(closing *c, const uint32_t *loop, size_t count) {
    for (size_t i = 0; i < count; i++) {
        c->border[c->border_count][0] = loop[i];
        c->border[c->border_count++][1] = loop[(i + 1) % count];
    }
    c->closed->report.loops_capped++;
}

static iso_status fail_open(const closing *c, iso_error *error) {
    return iso_fail(error, ISO_ERR_FORMAT,
                    "%s: the mesh is open: %zu open edges; the largest hole measures %.3g mm, and only holes "
                    "up to %.3g mm can be closed",
                    c->path, c->closed->report.open_edges, c->largest_refused, fmax(c->most, 0));
}

/* Closes all loops. `capped`: those in the faces of the box are capped. */
static iso_status close_loops(closing *c, bool capped, iso_error *error) {
    const iso_mesh_topology *t = &c->closed->topology;
    c->border_count = c->refused = 0;
    for (size_t i = 0; i < t->loops; i++) {
        size_t count;
        const uint32_t *loop = loop_of(t, i, &count);
        const loop_kind kind = choose_kind(c, loop, count, capped);
        if (kind == LOOP_BORDER) add_border_edges(c, loop, count);
        if (kind == LOOP_FILL && !fill_hole(c, loop, count)) return iso_fail_memory(error, c->path);
        if (kind != LOOP_TOO_LARGE) continue;
        c->refused++;
        c->largest_refused = fmax(c->largest_refused, loop_size(&c->closed->mesh, loop, count));
    }
    if (c->refused) return fail_open(c, error);
    if (c->border_count == 0) return ISO_OK;
    return iso_border_close(&c->closed->border, &c->closed->mesh, (const uint32_t(*)[2])c->border,
                            c->border_count, error);
}

/* Closes the mesh, with caps in the faces of the box. If caps are not possible there, closes it without: the
 * loops in the faces of the box may be small enough to be filled like other holes. */
static iso_status close_open_mesh(closing *c, iso_error *error) {
    iso_closed_mesh *closed = c->closed;
    const iso_mesh_report before = closed->report;
    const size_t vertices = closed->mesh.vertex_count, triangles = closed->mesh.triangle_count;
    iso_status status = close_loops(c, true, error);
    if (status != ISO_ERR_FORMAT || c->refused) return status;
    closed->report = before;
    closed->mesh.vertex_count = vertices;
    closed->mesh.triangle_count = triangles;
    return close_loops(c, false, error);
}

/* ---- volume and area */

/* Returns twice the area vector of a triangle; *a is its first corner. */
static iso_vec3 cross_of(const iso_triangles *mesh, size_t triangle, iso_vec3 *a) {
    const uint32_t *t = mesh->triangles[triangle];
    *a = vertex(mesh, t[0]);
    return iso_vec3_cross(iso_vec3_sub(vertex(mesh, t[1]), *a), iso_vec3_sub(vertex(mesh, t[2]), *a));
}

/* Returns the signed volume of a mesh by the divergence theorem: the sum over the tetrahedra between its
 * triangles and the point `from`. */
static double volume_of(const iso_triangles *mesh, iso_vec3 from) {
    double volume = 0;
    for (size_t i = 0; i < mesh->triangle_count; i++) {
        iso_vec3 a;
        const iso_vec3 cross = cross_of(mesh, i, &a);
        volume += iso_vec3_dot(iso_vec3_sub(a, from), cross) / 6;
    }
    return volume;
}

static double area_of(const iso_triangles *mesh) {
    double area = 0;
    for (size_t i = 0; i < mesh->triangle_count; i++) {
        iso_vec3 a;
        area += 0.5 * iso_vec3_length(cross_of(mesh, i, &a));
    }
    return area;
}

static double longest_side(const iso_border *border) {
    double longest = 0;
    for (int axis = 0; axis < 3; axis++) longest = fmax(longest, border->hi[axis] - border->lo[axis]);
    return longest;
}

static iso_status measure(const char *path, iso_closed_mesh *c, const iso_triangles *fans, iso_error *error) {
    const iso_box box = iso_closed_mesh_box(c);
    const iso_vec3 middle = iso_vec3_scale(iso_vec3_add(box.lo, box.hi), 0.5);
    c->report.volume = volume_of(&c->mesh, middle) + volume_of(fans, middle);
    c->report.area = area_of(&c->mesh);
    const double most = c->report.area * longest_side(&c->border);
    if (fabs(c->report.volume) > SHEET * most) return ISO_OK;
    if (c->report.open_edges)
        return iso_fail(error, ISO_ERR_FORMAT,
                        "%s: the mesh is an open sheet of %zu open edges: it encloses nothing", path,
                        c->report.open_edges);
    return iso_fail(error, ISO_ERR_EMPTY, "%s: the mesh encloses nothing", path);
}

/* ---- the closed mesh */

static iso_status build_trees(const char *path, iso_closed_mesh *c, iso_error *error) {
    iso_triangles fans;
    ISO_TRY(iso_border_fans(&c->border, &fans, error));
    iso_status status = measure(path, c, &fans, error);
    if (status == ISO_OK) status = iso_triangle_tree_create(&c->mesh, &c->surface, error);
    if (status == ISO_OK && fans.triangle_count) status = iso_triangle_tree_create(&fans, &c->caps, error);
    iso_free(fans.vertices);
    iso_free(fans.triangles);
    return status;
}

static iso_status close_mesh(const char *path, iso_closed_mesh *c, double hole, iso_error *error) {
    const iso_mesh_topology *t = &c->topology;
    iso_border_init(&c->border, &c->mesh);
    closing work = {.path = path,
                    .closed = c,
                    .scratch = iso_alloc(sizeof *work.scratch),
                    .most = hole == 0 ? ISO_MESH_HOLE * longest_side(&c->border) : hole,
                    .border = iso_alloc((t->open_count + 1) * sizeof *work.border)};
    iso_status status =
        work.scratch && work.border ? close_open_mesh(&work, error) : iso_fail_memory(error, path);
    iso_free(work.scratch);
    iso_free(work.border);
    return status;
}

static iso_status build_closed_mesh(const char *path, const iso_triangles *mesh, const iso_closing_opts *opts,
                                    iso_closed_mesh *c, iso_error *error) {
    const iso_progress *progress = opts->progress;
    ISO_TRY(iso_progress_tell(progress, path, 0, error));
    ISO_TRY(iso_mesh_topology_make(path, mesh, &c->topology, error));
    ISO_TRY(iso_progress_tell(progress, path, 0.6, error));
    c->mesh = c->topology.mesh;
    c->topology.mesh = (iso_triangles){0};
    c->vertex_room = c->mesh.vertex_count;
    c->triangle_room = c->mesh.triangle_count;
    c->report.triangles = c->mesh.triangle_count;
    c->report.open_edges = c->topology.open_count;
    c->report.turned = c->topology.turned;
    ISO_TRY(close_mesh(path, c, opts->hole, error));
    iso_mesh_topology_free(&c->topology);
    ISO_TRY(iso_progress_tell(progress, path, 0.7, error));
    ISO_TRY(build_trees(path, c, error));
    return iso_progress_tell(progress, path, 1, error);
}

iso_status iso_closed_mesh_create(const char *path, const iso_triangles *mesh, const iso_closing_opts *opts,
                                  iso_closed_mesh **closed, iso_error *error) {
    if (mesh->triangle_count == 0) return iso_fail(error, ISO_ERR_EMPTY, "%s: holds no triangles", path);
    iso_closed_mesh *c = iso_alloc_zero(1, sizeof *c);
    iso_status status = c ? build_closed_mesh(path, mesh, opts, c, error) : iso_fail_memory(error, path);
    if (status == ISO_OK)
        *closed = c;
    else
        iso_closed_mesh_destroy(c);
    return status;
}

void iso_closed_mesh_destroy(iso_closed_mesh *closed) {
    if (!closed) return;
    iso_mesh_topology_free(&closed->topology);
    iso_free(closed->mesh.vertices);
    iso_free(closed->mesh.triangles);
    iso_triangle_tree_destroy(closed->surface);
    iso_triangle_tree_destroy(closed->caps);
    iso_border_free(&closed->border);
    iso_free(closed);
}

const iso_mesh_report *iso_closed_mesh_report(const iso_closed_mesh *closed) {
    return &closed->report;
}

iso_box iso_closed_mesh_box(const iso_closed_mesh *closed) {
    const double *lo = closed->border.lo, *hi = closed->border.hi;
    return (iso_box){iso_vec3_make(lo[0], lo[1], lo[2]), iso_vec3_make(hi[0], hi[1], hi[2])};
}

double iso_closed_mesh_winding(const iso_closed_mesh *closed, iso_vec3 p) {
    return iso_triangle_tree_winding(closed->surface, p) + iso_triangle_tree_winding(closed->caps, p);
}

/* The change along the segment from p to q; false: it meets a vertex or an edge. */
static bool change_along(const iso_closed_mesh *closed, iso_vec3 p, iso_vec3 q, int *change) {
    int caps;
    if (!iso_triangle_tree_change(closed->surface, p, q, change) ||
        !iso_triangle_tree_change(closed->caps, p, q, &caps))
        return false;
    *change += caps;
    return true;
}

/* The change is the same along every path: where the segment meets a vertex or an edge, as it often does if
 * the mesh was made of the same grid, a path beside it is tried. */
bool iso_closed_mesh_change(const iso_closed_mesh *closed, iso_vec3 p, iso_vec3 q, int *change) {
    static const double DETOURS[][3] = {{0.23, -0.11, 0.17}, {-0.19, 0.29, 0.07}, {0.13, 0.07, -0.31}};
    const double length = iso_vec3_length(iso_vec3_sub(q, p));
    const iso_vec3 middle = iso_vec3_scale(iso_vec3_add(p, q), 0.5);
    if (change_along(closed, p, q, change)) return true;
    for (size_t i = 0; i < sizeof DETOURS / sizeof *DETOURS; i++) {
        const double *d = DETOURS[i];
        const iso_vec3 over = iso_vec3_add(middle, iso_vec3_scale(iso_vec3_make(d[0], d[1], d[2]), length));
        int before, after;
        if (!change_along(closed, p, over, &before) || !change_along(closed, over, q, &after)) continue;
        *change = before + after;
        return true;
    }
    return false;
}

void iso_closed_mesh_nearest(const iso_closed_mesh *closed, iso_vec3 p, iso_nearest *nearest) {
    iso_triangle_tree_nearest(closed->surface, p, nearest);
    iso_border_nearest(&closed->border, p, nearest);
}

void iso_closed_mesh_measure(const iso_closed_mesh *closed, const iso_brick_place *brick, double band,
                             double squared[ISO_BRICK_VOXELS]) {
    iso_brick_distances(closed->surface, brick, band, squared, NULL);
    for (int i = 0; i < ISO_BRICK_VOXELS && closed->border.faces; i++) {
        iso_nearest nearest = {.squared = squared[i]};
        iso_border_nearest(&closed->border, iso_brick_voxel(brick, i), &nearest);
        squared[i] = nearest.squared;
    }
}

void iso_closed_mesh_nearest_triangles(const iso_closed_mesh *closed, const iso_brick_place *brick,
                                       double band, double squared[ISO_BRICK_VOXELS],
                                       const iso_tree_triangle *nearest[ISO_BRICK_VOXELS]) {
    iso_brick_distances(closed->surface, brick, band, squared, nearest);
}

bool iso_mesh_report_note(const iso_mesh_report *r, char *text, size_t size) {
    text[0] = 0;
    size_t at = 0;
#define NOTE(...)                                                                                            \
    at += (size_t)snprintf(text + (at < size ? at : size), at < size ? size - at : 0, __VA_ARGS__)
    if (r->open_edges) NOTE("the mesh has %zu open edges:", r->open_edges);
    if (r->loops_capped) NOTE(" %zu loops capped at the border of its box", r->loops_capped);
    if (r->holes_closed)
        NOTE("%s %zu holes of up to %.3g mm filled", r->loops_capped ? "," : "", r->holes_closed,
             r->largest_hole);
    if (r->turned) NOTE("%s%zu triangles turned over", at ? "; " : "the mesh has ", r->turned);
    if (r->volume < 0) NOTE("%s", at ? "; it is inside out" : "the mesh is inside out");
#undef NOTE
    return at > 0;
}
