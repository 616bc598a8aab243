/* mesh_lines: pieces become tubes or ribbons if these are where the piece is. */
#include "extract/lines/mesh_lines.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/memory.h"
#include "base/numbers.h"
#include "extract/lines/ring_chains.h"

/* A piece is thin if its lines are so many times as long as their greatest width. */
static const double THIN = 2;
/* Its tubes are where it is if all but OUTSIDE of its vertices are within NEAR radii of their surface. */
static const double NEAR = 0.3, OUTSIDE = 0.1;
/* A leaf is at least so many times as long as wide, and its ribbon's area differs by less than this part. */
static const double LEAF_LENGTH = 1.5, LEAF_AREA = 0.25;

typedef enum piece_kind { PIECE_REST, PIECE_TUBES, PIECE_RIBBON } piece_kind;

typedef struct piece_fit {
    double length, widest; /* of its lines: their length, and their greatest radius, mm */
    size_t chains, outside;
    piece_kind kind;
} piece_fit;

typedef struct converting {
    iso_mesh_rings rings;
    iso_chains chains;
    piece_fit *fits;
    iso_mesh_lines *made;
} converting;

static double distance(iso_vec3 a, iso_vec3 b) {
    return iso_vec3_length(iso_vec3_sub(a, b));
}

/* The rings at both ends of a segment of a chain. */
static const iso_mesh_ring *ring_of(const converting *c, const iso_chain *chain, size_t i) {
    return &c->rings.rings[c->chains.places[chain->first + i].ring];
}

/* ---- tubes */

static void measure_chains(const converting *c) {
    for (size_t i = 0; i < c->chains.count; i++) {
        const iso_chain *chain = &c->chains.chains[i];
        piece_fit *fit = &c->fits[chain->piece];
        fit->chains++;
        for (size_t k = 1; k < chain->count; k++) {
            const iso_mesh_ring *a = ring_of(c, chain, k - 1), *b = ring_of(c, chain, k);
            const double length = distance(a->at, b->at);
            fit->length += length;
            fit->widest = iso_max(fit->widest, iso_max(a->radius, b->radius));
        }
    }
}

/* How far a vertex is from the surface of the tube between two rings, in radii; less than 0 inside. */
static double beyond(const iso_mesh_ring *a, const iso_mesh_ring *b, iso_vec3 v) {
    const iso_vec3 path = iso_vec3_sub(b->at, a->at), from = iso_vec3_sub(v, a->at);
    const double square = iso_vec3_dot(path, path);
    const double u = square > 0 ? iso_min(iso_max(iso_vec3_dot(from, path) / square, 0), 1) : 0;
    const double radius = (1 - u) * a->radius + u * b->radius;
    return (iso_vec3_length(iso_vec3_sub(from, iso_vec3_scale(path, u))) - radius) / iso_max(radius, 1e-30);
}

/* Whether a vertex lies near the surface of the tubes at its ring. */
static bool is_near(const converting *c, size_t vertex) {
    uint32_t at = c->rings.ring[vertex];
    while (c->chains.stand_in[at] != at) at = c->chains.stand_in[at];
    const iso_mesh_ring *ring = &c->rings.rings[at];
    const iso_vec3 v = iso_mesh_vertex(&c->rings.topology->mesh, vertex);
    double nearest = beyond(ring, ring, v);
    for (size_t k = c->rings.link_first[at]; k < c->rings.link_first[at + 1]; k++) {
        const uint32_t next = c->rings.links[k];
        if (c->chains.stand_in[next] == next)
            nearest = iso_min(nearest, beyond(ring, &c->rings.rings[next], v));
    }
    return fabs(nearest) <= NEAR;
}

static void judge_tubes(const converting *c) {
    measure_chains(c);
    for (size_t i = 0; i < c->rings.topology->mesh.vertex_count; i++) {
        const uint32_t piece = c->rings.piece[i];
        if (!c->rings.pieces[piece].sheet) c->fits[piece].outside += !is_near(c, i);
    }
    for (size_t i = 0; i < c->rings.piece_count; i++) {
        piece_fit *fit = &c->fits[i];
        const iso_mesh_piece *piece = &c->rings.pieces[i];
        const bool thin = fit->widest > 0 && fit->length >= THIN * 2 * fit->widest;
        if (!piece->sheet && thin && (double)fit->outside <= OUTSIDE * (double)piece->vertices)
            fit->kind = PIECE_TUBES;
    }
}

/* ---- ribbons */

/* The two vertices of a sheet's ring that are farthest apart, of those on its outline; false: there is
 * one. */
static bool find_pair(const converting *c, const iso_mesh_ring *ring, iso_vec3 pair[2]) {
    const iso_triangles *mesh = &c->rings.topology->mesh;
    const uint32_t *members = c->rings.members + ring->first;
    double most = -1;
    for (uint32_t i = 0; i < ring->count; i++)
        for (uint32_t k = i + 1; k < ring->count && c->rings.open[members[i]]; k++) {
            if (!c->rings.open[members[k]]) continue;
            const iso_vec3 a = iso_mesh_vertex(mesh, members[i]), b = iso_mesh_vertex(mesh, members[k]);
            if (!(distance(a, b) > most)) continue;
            most = distance(a, b);
            pair[0] = a;
            pair[1] = b;
        }
    return most > 0;
}

/* The normal of the triangles around a ring. */
static iso_vec3 normal_around(const converting *c, const iso_mesh_ring *ring) {
    iso_vec3 sum = {0, 0, 0};
    for (uint32_t i = 0; i < ring->count; i++) {
        const uint32_t v = c->rings.members[ring->first + i];
        for (size_t k = c->rings.around_first[v]; k < c->rings.around_first[v + 1]; k++)
            sum = iso_vec3_add(sum, iso_mesh_triangle_area(&c->rings.topology->mesh, c->rings.around[k]));
    }
    return iso_vec3_unit(sum);
}

/* Moves the rings of a leaf to the middles of its pairs of vertices; radii are half their distances. */
static void set_middles(const converting *c, const iso_chain *chain) {
    for (size_t i = 0; i < chain->count; i++) {
        const uint32_t number = c->chains.places[chain->first + i].ring;
        iso_mesh_ring *ring = &c->rings.rings[number];
        iso_vec3 pair[2] = {{0, 0, 0}, {0, 0, 0}};
        ring->radius = 0;
        if (!find_pair(c, ring, pair)) continue;
        ring->at = iso_vec3_scale(iso_vec3_add(pair[0], pair[1]), 0.5);
        ring->radius = 0.5 * distance(pair[0], pair[1]);
    }
}

/* Whether a sheet is the ribbon of a chain. */
static bool is_leaf(const converting *c, const iso_chain *chain) {
    double length = 0, area = 0, widest = 0;
    const iso_mesh_piece *piece = &c->rings.pieces[chain->piece];
    const size_t rings = c->rings.first_ring[chain->piece + 1] - c->rings.first_ring[chain->piece];
    if (chain->count != rings || c->fits[chain->piece].chains != 1) return false;
    set_middles(c, chain);
    for (size_t i = 0; i < chain->count; i++) {
        const iso_mesh_ring *b = ring_of(c, chain, i), *a = i ? ring_of(c, chain, i - 1) : b;
        widest = iso_max(widest, 2 * b->radius);
        length += distance(a->at, b->at);
        area += distance(a->at, b->at) * (a->radius + b->radius);
    }
    return length >= LEAF_LENGTH * widest && fabs(area - piece->area) <= LEAF_AREA * piece->area;
}

static void judge_sheets(const converting *c) {
    for (size_t i = 0; i < c->chains.count; i++) {
        const iso_chain *chain = &c->chains.chains[i];
        if (c->rings.pieces[chain->piece].sheet && is_leaf(c, chain))
            c->fits[chain->piece].kind = PIECE_RIBBON;
    }
}

/* ---- the lines that are made */

static void put(float to[3], iso_vec3 from) {
    to[0] = (float)from.x, to[1] = (float)from.y, to[2] = (float)from.z;
}

static void add_chain(const converting *c, const iso_chain *chain, iso_lines *lines) {
    const iso_chain_place *places = c->chains.places + chain->first;
    for (size_t i = 0; i < chain->count; i++) {
        const iso_mesh_ring *ring = ring_of(c, chain, i);
        if (!places[i].keep) continue;
        const size_t v = lines->vertex_count++;
        if (v == 0) {
            double first[3];
            iso_vec3_store(ring->at, first);
            lines->origin = iso_origin_for(first);
        }
        put(lines->vertices[v], iso_vec3_sub(ring->at, lines->origin));
        lines->radii[v] = (float)(lines->normals ? ring->radius : places[i].radius);
        if (lines->normals) put(lines->normals[v], normal_around(c, ring));
    }
    lines->starts[++lines->line_count] = lines->vertex_count;
}

static iso_status add_lines(const converting *c, piece_kind kind, iso_lines *lines, iso_error *error) {
    size_t count = 0, vertices = 0;
    for (size_t i = 0; i < c->chains.count; i++) {
        if (c->fits[c->chains.chains[i].piece].kind != kind) continue;
        count++;
        vertices += c->chains.chains[i].count;
    }
    lines->vertices = iso_alloc((vertices + 1) * sizeof *lines->vertices);
    lines->radii = iso_alloc((vertices + 1) * sizeof *lines->radii);
    lines->starts = iso_alloc_zero(count + 1, sizeof *lines->starts);
    if (kind == PIECE_RIBBON) lines->normals = iso_alloc((vertices + 1) * sizeof *lines->normals);
    if (!lines->vertices || !lines->radii || !lines->starts || (kind == PIECE_RIBBON && !lines->normals))
        return iso_fail_memory(error, "lines of a mesh");
    for (size_t i = 0; i < c->chains.count; i++)
        if (c->fits[c->chains.chains[i].piece].kind == kind) add_chain(c, &c->chains.chains[i], lines);
    return ISO_OK;
}

static iso_status add_rest(const converting *c, iso_triangles *rest, iso_error *error) {
    const iso_triangles *mesh = &c->rings.topology->mesh;
    size_t count = 0;
    for (size_t i = 0; i < mesh->triangle_count; i++)
        count += c->fits[c->rings.piece[mesh->triangles[i][0]]].kind == PIECE_REST;
    if (!count) return ISO_OK;
    rest->vertices = iso_alloc(mesh->vertex_count * sizeof *rest->vertices);
    rest->triangles = iso_alloc(count * sizeof *rest->triangles);
    if (!rest->vertices || !rest->triangles) return iso_fail_memory(error, "the rest of a mesh");
    memcpy(rest->vertices, mesh->vertices, mesh->vertex_count * sizeof *rest->vertices);
    rest->vertex_count = mesh->vertex_count;
    for (size_t i = 0; i < mesh->triangle_count; i++) {
        if (c->fits[c->rings.piece[mesh->triangles[i][0]]].kind != PIECE_REST) continue;
        memcpy(rest->triangles[rest->triangle_count++], mesh->triangles[i], sizeof *mesh->triangles);
    }
    return ISO_OK;
}

/* Says why the largest piece did not become lines. */
static iso_status fail_thick(const converting *c, const char *path, iso_error *error) {
    size_t largest = 0;
    char why[96];
    for (size_t i = 0; i < c->rings.piece_count; i++)
        if (c->rings.pieces[i].area > c->rings.pieces[largest].area) largest = i;
    const iso_mesh_piece *piece = &c->rings.pieces[largest];
    const piece_fit *fit = &c->fits[largest];
    const double ratio = fit->widest > 0 ? fit->length / (2 * fit->widest) : 0;
    if (piece->sheet)
        snprintf(why, sizeof why, "is a sheet that is no leaf");
    else if (ratio < THIN)
        snprintf(why, sizeof why, ratio < 1.5 ? "is as thick as long" : "is only %.1f times as long as thick",
                 ratio);
    else
        snprintf(why, sizeof why, "has %.0f %% of its vertices away from the tubes through it",
                 100 * (double)fit->outside / (double)piece->vertices);
    return iso_fail(error, ISO_ERR_EMPTY, "%s: not made of thin branches or leaves: %s %s", path,
                    c->rings.piece_count > 1 ? "its largest piece" : "it", why);
}

static iso_status add_all(converting *c, const char *path, iso_error *error) {
    iso_mesh_lines *made = c->made;
    for (size_t i = 0; i < c->rings.piece_count; i++) {
        made->pieces += c->rings.pieces[i].triangles > 0;
        made->tube_pieces += c->fits[i].kind == PIECE_TUBES;
        made->ribbon_pieces += c->fits[i].kind == PIECE_RIBBON;
    }
    if (!made->tube_pieces && !made->ribbon_pieces) return fail_thick(c, path, error);
    ISO_TRY(add_lines(c, PIECE_TUBES, &made->tubes, error));
    ISO_TRY(add_lines(c, PIECE_RIBBON, &made->ribbons, error));
    return add_rest(c, &made->rest, error);
}

/* Makes the rings again, by distance, if those of a piece cross each other. */
static iso_status make_rings(converting *c, const iso_mesh_topology *topology, iso_error *error) {
    bool again = false;
    ISO_TRY(iso_mesh_rings_make(topology, NULL, &c->rings, error));
    bool *by_distance = iso_alloc_zero(c->rings.piece_count, sizeof *by_distance);
    if (!by_distance) return iso_fail_memory(error, "lines of a mesh");
    for (size_t i = 0; i < c->rings.piece_count; i++) {
        by_distance[i] = !c->rings.pieces[i].sheet && iso_mesh_rings_cross(&c->rings, i);
        again |= by_distance[i];
    }
    if (again) iso_mesh_rings_free(&c->rings);
    const iso_status status = again ? iso_mesh_rings_make(topology, by_distance, &c->rings, error) : ISO_OK;
    iso_free(by_distance);
    return status;
}

static iso_status convert(converting *c, const char *path, const iso_mesh_topology *topology,
                          iso_error *error) {
    ISO_TRY(make_rings(c, topology, error));
    ISO_TRY(iso_chains_make(&c->rings, &c->chains, error));
    c->fits = iso_alloc_zero(c->rings.piece_count, sizeof *c->fits);
    if (!c->fits) return iso_fail_memory(error, "lines of a mesh");
    judge_tubes(c);
    judge_sheets(c);
    return add_all(c, path, error);
}

iso_status iso_mesh_lines_make(const char *path, const iso_triangles *mesh, iso_mesh_lines *made,
                               iso_error *error) {
    iso_mesh_topology topology = {.loops = 0};
    iso_mesh_lines lines = {.pieces = 0};
    converting c = {.made = &lines};
    ISO_TRY(iso_mesh_topology_make(path, mesh, &topology, error));
    const size_t triangles = topology.mesh.triangle_count, vertices = topology.mesh.vertex_count;
    const iso_status status = convert(&c, path, &topology, error);
    iso_free(c.fits);
    iso_chains_free(&c.chains);
    iso_mesh_rings_free(&c.rings);
    iso_mesh_topology_free(&topology);
    lines.vertices = vertices;
    lines.left_out = mesh->triangle_count - triangles;
    if (status == ISO_OK)
        *made = lines;
    else
        iso_mesh_lines_free(&lines);
    return status;
}

void iso_mesh_lines_free(iso_mesh_lines *lines) {
    iso_lines_free(&lines->tubes);
    iso_lines_free(&lines->ribbons);
    iso_free(lines->rest.vertices);
    iso_free(lines->rest.triangles);
    *lines = (iso_mesh_lines){.pieces = 0};
}
