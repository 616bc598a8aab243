/* ring_smoothing: where the line of a chain of rings is: radii, the places where branches join, ends,
 * smoothing and the vertices that are kept. */
#include "extract/lines/ring_smoothing.h"

#include <math.h>
#include <string.h>

#include "base/memory.h"
#include "base/numbers.h"

/* Rings are dense if a neighbour is nearer than so many radii: then a ring need not be plane or
 * perpendicular. */
static const double DENSE = 0.75;
/* A ring is round if its vertices' distances from the line deviate by less than this part of their mean. */
static const double ROUND = 0.25;
/* Passes of smoothing, by Taubin 1995 ("Curve and surface smoothing without shrinkage"), and their
 * weights. */
enum { MOST_PASSES = 40 };
static const double SMOOTH = 0.5, UNSHRINK = -0.53;
/* Of dense rings a place is left out if the line without it is so near, in radii. */
static const double SIMPLIFY = 0.02;
/* A closed end is flat if a ring that is nearer to it than FLAT radii has FULL of the radius. */
static const double FLAT = 0.25, FULL = 0.9;

typedef struct place {
    iso_vec3 at;
    double radius, mean; /* mm; mean: distance of the ring's vertices from its middle */
    bool dense, round;
} place;

typedef struct smoothing {
    iso_mesh_rings *rings;
    iso_chains *chains;
    const uint32_t *degree;
    place *places, *other; /* of the longest chain */
    size_t (*stack)[2];
    /* of the chain that is being smoothed */
    iso_chain *chain;
    size_t first, last; /* its places that are left */
} smoothing;

static iso_mesh_ring *ring_at(const smoothing *s, size_t i) {
    return &s->rings->rings[s->chains->places[s->chain->first + i].ring];
}

static double distance(iso_vec3 a, iso_vec3 b) {
    return iso_vec3_length(iso_vec3_sub(a, b));
}

/* ---- radii */

/* The direction of the line at a place, over the length of its radius to both sides. */
static iso_vec3 direction_at(const smoothing *s, size_t i) {
    size_t before = i, after = i;
    const place *p = s->places;
    while (before > 0 && distance(p[before].at, p[i].at) < p[i].mean) before--;
    while (after + 1 < s->chain->count && distance(p[after].at, p[i].at) < p[i].mean) after++;
    return iso_vec3_unit(iso_vec3_sub(p[after].at, p[before].at));
}

static bool is_dense(const smoothing *s, size_t i) {
    const place *p = &s->places[i];
    double nearest = INFINITY;
    if (s->rings->pieces[s->chain->piece].by_distance) return true;
    if (i > 0) nearest = distance(p->at, p[-1].at);
    if (i + 1 < s->chain->count) nearest = iso_min(nearest, distance(p->at, p[1].at));
    return nearest < DENSE * p->mean;
}

/* The radius of a ring: the mean distance of its vertices from its middle, or from the line if rings are
 * dense. */
static void measure(const smoothing *s, size_t i) {
    const iso_mesh_ring *ring = ring_at(s, i);
    place *p = &s->places[i];
    const iso_vec3 along = p->dense ? direction_at(s, i) : iso_vec3_make(0, 0, 0);
    double sum = 0, squares = 0;
    p->radius = ring->radius;
    p->round = true;
    if (ring->lid) return;
    for (uint32_t k = 0; k < ring->count; k++) {
        const iso_vec3 away = iso_vec3_sub(
            iso_mesh_vertex(&s->rings->topology->mesh, s->rings->members[ring->first + k]), p->at);
        const double part = iso_vec3_dot(away, along),
                     square = iso_max(iso_vec3_dot(away, away) - part * part, 0);
        sum += sqrt(square);
        squares += square;
    }
    p->radius = sum / ring->count;
    const double variance = squares / ring->count - p->radius * p->radius;
    p->round = variance <= ROUND * ROUND * p->radius * p->radius;
}

static void take_places(smoothing *s) {
    for (size_t i = 0; i < s->chain->count; i++) {
        const iso_mesh_ring *ring = ring_at(s, i);
        s->places[i] = (place){.at = ring->at, .mean = ring->radius};
    }
    for (size_t i = 0; i < s->chain->count; i++) s->places[i].dense = is_dense(s, i);
    for (size_t i = 0; i < s->chain->count; i++) measure(s, i);
}

/* ---- places where branches join */

static bool is_good(const smoothing *s, size_t i) {
    const bool own =
        !(i == 0 && s->chain->attached[0]) && !(i + 1 == s->chain->count && s->chain->attached[1]);
    const uint32_t ring = s->chains->places[s->chain->first + i].ring;
    return own && s->places[i].round && s->degree[ring] <= 2;
}

/* Puts places from..to - 1 evenly between the good ones beside them: a ring where branches join is too
 * large. */
static void bridge(const smoothing *s, size_t from, size_t to) {
    place *p = s->places;
    const bool before = from > 0, after = to < s->chain->count;
    for (size_t i = from; i < to; i++) {
        const double u = (double)(i + 1 - from) / (double)(to - from + 1);
        if (before && after) {
            p[i].at = iso_vec3_add(iso_vec3_scale(p[from - 1].at, 1 - u), iso_vec3_scale(p[to].at, u));
            p[i].radius = (1 - u) * p[from - 1].radius + u * p[to].radius;
        } else if (before || after) {
            p[i].radius = p[before ? from - 1 : to].radius;
        }
    }
}

static void bridge_joints(const smoothing *s) {
    for (size_t i = 0, end; i < s->chain->count; i = end + 1) {
        for (end = i; end < s->chain->count && !is_good(s, end);) end++;
        if (end > i) bridge(s, i, end);
    }
}

/* ---- ends */

/* Of the places from an end on, `step` apart, the first that is farther from the end than its radius;
 * and whether one before it shows that the end is flat, which is then *flat. */
static size_t find_end(const smoothing *s, size_t end, int step, size_t *flat) {
    const place *p = s->places;
    size_t i = end;
    const size_t stop = step > 0 ? s->last : s->first;
    while (i != stop && (i == end || distance(p[i].at, p[end].at) < p[i].radius)) i += (size_t)step;
    *flat = SIZE_MAX;
    for (size_t k = end; k != i; k += (size_t)step)
        if (*flat == SIZE_MAX && distance(p[k].at, p[end].at) <= FLAT * p[i].radius &&
            p[k].radius >= FULL * p[i].radius)
            *flat = k;
    return i;
}

/* The end of a line where a lid is: the rings that are beside it are left out. */
static size_t end_at_lid(const smoothing *s, size_t end, int step) {
    const place *p = s->places;
    size_t i = end + (size_t)step;
    const size_t stop = step > 0 ? s->last : s->first;
    while (i != stop && distance(p[i].at, p[end].at) < 0.5 * p[end].radius) i += (size_t)step;
    const size_t at = i - (size_t)step;
    s->places[at] = s->places[end];
    return at;
}

/* Where a line ends, from its first or last place: at a lid; at the ring of a flat end; at the middle of
 * a round one; else at the end. */
static size_t end_line(const smoothing *s, size_t end, int step) {
    place *p = s->places;
    size_t flat;
    if (s->first == s->last) return end;
    if (ring_at(s, end)->lid) return end_at_lid(s, end, step);
    const size_t beyond = find_end(s, end, step, &flat);
    if (flat != SIZE_MAX) return flat;
    const size_t before = beyond - (size_t)step;
    if (before == end || distance(p[beyond].at, p[end].at) < p[beyond].radius) return end;
    const double a = p[before].radius - distance(p[before].at, p[end].at),
                 b = distance(p[beyond].at, p[end].at) - p[beyond].radius, u = a + b > 0 ? a / (a + b) : 0;
    p[before].at = iso_vec3_add(iso_vec3_scale(p[before].at, 1 - u), iso_vec3_scale(p[beyond].at, u));
    p[before].radius = (1 - u) * p[before].radius + u * p[beyond].radius;
    return before;
}

static bool is_closed(const smoothing *s) {
    const iso_chain_place *places = s->chains->places + s->chain->first;
    return places[0].ring == places[s->chain->count - 1].ring;
}

static void set_ends(smoothing *s) {
    s->first = 0;
    s->last = s->chain->count - 1;
    if (is_closed(s)) return;
    if (!s->chain->attached[0]) s->first = end_line(s, 0, 1);
    if (!s->chain->attached[1]) s->last = end_line(s, s->chain->count - 1, -1);
    for (size_t i = 0; i < s->first; i++) s->places[i] = s->places[s->first];
    for (size_t i = s->last + 1; i < s->chain->count; i++) s->places[i] = s->places[s->last];
}

/* ---- smoothing */

static void smooth_once(smoothing *s, double weight) {
    place *p = s->places;
    memcpy(s->other + s->first, p + s->first, (s->last + 1 - s->first) * sizeof *p);
    for (size_t i = s->first + 1; i < s->last; i++) {
        const place *a = &s->other[i - 1], *b = &s->other[i + 1], *own = &s->other[i];
        const iso_vec3 middle = iso_vec3_scale(iso_vec3_add(a->at, b->at), 0.5);
        if (!own->dense) continue;
        p[i].at = iso_vec3_add(iso_vec3_scale(own->at, 1 - weight), iso_vec3_scale(middle, weight));
        p[i].radius = iso_max((1 - weight) * own->radius + weight * 0.5 * (a->radius + b->radius), 0);
    }
}

/* As many passes as let neighbours within a radius smooth each other. */
static void smooth(smoothing *s) {
    double radius = 0, length = 0;
    size_t dense = 0;
    for (size_t i = s->first; i < s->last; i++) {
        if (!s->places[i].dense) continue;
        radius += s->places[i].radius;
        length += distance(s->places[i].at, s->places[i + 1].at);
        dense++;
    }
    if (!dense || !(length > 0)) return;
    const double rings = radius / length; /* in a radius */
    const int passes = (int)iso_min(ceil(rings * rings), MOST_PASSES);
    for (int i = 0; i < passes; i++) {
        smooth_once(s, SMOOTH);
        smooth_once(s, UNSHRINK);
    }
}

/* ---- the places that are kept */

/* How far the line and its radius at a place are from those of the segment between two others, in radii. */
static double deviation(const place *p, const place *a, const place *b) {
    const iso_vec3 path = iso_vec3_sub(b->at, a->at), from = iso_vec3_sub(p->at, a->at);
    const double square = iso_vec3_dot(path, path);
    const double u = square > 0 ? iso_min(iso_max(iso_vec3_dot(from, path) / square, 0), 1) : 0;
    const double away = iso_vec3_length(iso_vec3_sub(from, iso_vec3_scale(path, u))),
                 wider = fabs(p->radius - ((1 - u) * a->radius + u * b->radius));
    return iso_max(away, wider) / iso_max(p->radius, 1e-30);
}

/* Keeps, of the places between two others, those that the line needs (Douglas and Peucker 1973). */
static void keep_between(smoothing *s, size_t first, size_t last) {
    iso_chain_place *kept = s->chains->places + s->chain->first;
    const place *p = s->places;
    size_t depth = 1;
    s->stack[0][0] = first;
    s->stack[0][1] = last;
    while (depth--) {
        const size_t from = s->stack[depth][0], to = s->stack[depth][1];
        double worst = SIMPLIFY;
        size_t at = from;
        for (size_t i = from + 1; i < to; i++) {
            const double d = deviation(&p[i], &p[from], &p[to]);
            if (d > worst) worst = d, at = i;
        }
        if (at == from) continue;
        kept[at].keep = true;
        s->stack[depth][0] = from;
        s->stack[depth++][1] = at;
        s->stack[depth][0] = at;
        s->stack[depth++][1] = to;
    }
}

/* Keeps the ends, the places where branches join, those that are not dense, and what the line needs of
 * the others. */
static void keep_places(smoothing *s) {
    iso_chain_place *kept = s->chains->places + s->chain->first;
    size_t before = s->first;
    for (size_t i = 0; i < s->chain->count; i++) {
        const bool joint = s->degree[kept[i].ring] > 2, end = i == s->first || i == s->last;
        kept[i].keep = end || (i > s->first && i < s->last && (joint || !s->places[i].dense));
    }
    for (size_t i = s->first + 1; i <= s->last; i++) {
        if (!kept[i].keep) continue;
        keep_between(s, before, i);
        before = i;
    }
}

/* ---- chains */

/* Gives the rings what the line has there; one that belongs to another line stays as that line has it. */
static void give_back(smoothing *s) {
    iso_chain_place *kept = s->chains->places + s->chain->first;
    place *p = s->places;
    const size_t last = s->chain->count - 1;
    if (s->chain->attached[0]) p[0].radius = iso_min(p[0].radius, p[1].radius);
    if (s->chain->attached[1]) p[last].radius = iso_min(p[last].radius, p[last - 1].radius);
    for (size_t i = 0; i <= last; i++) {
        kept[i].radius = s->places[i].radius;
        if ((i == 0 && s->chain->attached[0]) || (i == last && s->chain->attached[1])) continue;
        ring_at(s, i)->at = s->places[i].at;
        ring_at(s, i)->radius = s->places[i].radius;
    }
}

iso_status iso_chains_smooth(iso_mesh_rings *rings, iso_chains *chains, const uint32_t *degree,
                             iso_error *error) {
    smoothing s = {.rings = rings, .chains = chains, .degree = degree};
    size_t most = 0;
    for (size_t i = 0; i < chains->count; i++)
        most = chains->chains[i].count > most ? chains->chains[i].count : most;
    s.places = iso_alloc((most + 1) * sizeof *s.places);
    s.other = iso_alloc((most + 1) * sizeof *s.other);
    s.stack = iso_alloc((most + 2) * sizeof *s.stack);
    const bool room = s.places && s.other && s.stack;
    for (size_t i = 0; room && i < chains->count; i++) {
        s.chain = &chains->chains[i];
        if (rings->pieces[s.chain->piece].sheet) continue;
        take_places(&s);
        bridge_joints(&s);
        set_ends(&s);
        smooth(&s);
        keep_places(&s);
        give_back(&s);
    }
    iso_free(s.places);
    iso_free(s.other);
    iso_free(s.stack);
    return room ? ISO_OK : iso_fail_memory(error, "lines of a mesh");
}
