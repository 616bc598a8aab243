/* ring_chains: leaves out short side branches, and cuts the graph of rings into chains. */
#include <string.h>

#include "base/memory.h"
#include "base/numbers.h"
#include "extract/lines/ring_chains.h"
#include "extract/lines/ring_smoothing.h"

/* A side branch is left out if it reaches less than so many times as far from the middle as the ring
 * there. */
static const double SHORT = 1.5;
/* Places of a line so near the ring where it leaves another one, in the ring's reach, are left out. */
static const double BESIDE = 1.5;
/* Of more links than this, the line through a ring is chosen among those with the first one. */
enum { MOST_PAIRED = 16 };
static const uint32_t NONE = ISO_NO_RING;

typedef struct chaining {
    iso_mesh_rings *rings;
    iso_chains *made;
    uint32_t *degree;       /* of each ring: links to rings that are not left out */
    uint32_t (*through)[2]; /* of each ring with more than two links: those by which one line goes through */
    bool *walked;           /* of each link */
    uint32_t *path;         /* rings */
} chaining;

static bool is_left_out(const chaining *c, uint32_t ring) {
    return c->made->stand_in[ring] != ring;
}

static double distance(const chaining *c, uint32_t a, uint32_t b) {
    return iso_vec3_length(iso_vec3_sub(c->rings->rings[a].at, c->rings->rings[b].at));
}

/* The first ring linked to `ring` that is neither `from` nor left out; NONE: there is none. */
static uint32_t next_ring(const chaining *c, uint32_t from, uint32_t ring) {
    const iso_mesh_rings *rings = c->rings;
    for (size_t k = rings->link_first[ring]; k < rings->link_first[ring + 1]; k++)
        if (rings->links[k] != from && !is_left_out(c, rings->links[k])) return rings->links[k];
    return NONE;
}

/* ---- short side branches */

/* Goes from the free end of a branch to the ring where it begins, and leaves it out if it is short. */
static bool leave_out(chaining *c, uint32_t end) {
    size_t count = 0;
    uint32_t from = NONE, at = end;
    double farthest = 0;
    while (at != NONE && c->degree[at] <= 2) {
        const uint32_t next = next_ring(c, from, at);
        c->path[count++] = at;
        from = at;
        at = next;
        if (at == end) return false;
    }
    if (at == NONE) return false;
    for (size_t i = 0; i < count; i++) farthest = iso_max(farthest, distance(c, c->path[i], at));
    if (farthest > SHORT * c->rings->rings[at].reach) return false;
    for (size_t i = 0; i < count; i++) c->made->stand_in[c->path[i]] = at;
    c->degree[at]--;
    return true;
}

static void leave_out_short(chaining *c) {
    for (bool again = true; again;) {
        again = false;
        for (size_t i = 0; i < c->rings->ring_count; i++)
            if (!is_left_out(c, (uint32_t)i) && c->degree[i] == 1) again |= leave_out(c, (uint32_t)i);
    }
}

/* ---- lines through rings where branches join */

/* The direction in which a branch leaves a ring, as far from it as the ring reaches. */
static iso_vec3 direction_of(const chaining *c, uint32_t ring, uint32_t next) {
    uint32_t from = ring, at = next;
    while (c->degree[at] == 2 && distance(c, ring, at) < c->rings->rings[ring].reach) {
        const uint32_t after = next_ring(c, from, at);
        if (after == NONE || after == ring) break;
        from = at;
        at = after;
    }
    return iso_vec3_unit(iso_vec3_sub(c->rings->rings[at].at, c->rings->rings[ring].at));
}

/* Chooses the two branches of a ring that continue each other best. */
static void choose_through(chaining *c, uint32_t ring) {
    const iso_mesh_rings *rings = c->rings;
    const size_t first = rings->link_first[ring], end = rings->link_first[ring + 1];
    double best = 2;
    for (size_t k = first; k < end && (end - first <= MOST_PAIRED || best == 2); k++)
        for (size_t i = k + 1; i < end; i++) {
            const uint32_t a = rings->links[k], b = rings->links[i];
            if (is_left_out(c, a) || is_left_out(c, b)) continue;
            const double cosine = iso_vec3_dot(direction_of(c, ring, a), direction_of(c, ring, b));
            if (!(cosine < best)) continue;
            best = cosine;
            c->through[ring][0] = a;
            c->through[ring][1] = b;
        }
}

/* ---- chains */

/* Whether the line that comes from `from` goes on behind `ring`. */
static bool goes_through(const chaining *c, uint32_t from, uint32_t ring) {
    return c->degree[ring] == 2 ||
           (c->degree[ring] > 2 && (c->through[ring][0] == from || c->through[ring][1] == from));
}

static uint32_t next_of_line(const chaining *c, uint32_t from, uint32_t ring) {
    if (c->degree[ring] == 2) return next_ring(c, from, ring);
    return c->through[ring][c->through[ring][0] == from];
}

/* The place of a link from one ring to another. */
static size_t link_of(const chaining *c, uint32_t from, uint32_t to) {
    size_t k = c->rings->link_first[from];
    while (c->rings->links[k] != to) k++;
    return k;
}

static void put(chaining *c, iso_chain *chain, uint32_t ring) {
    c->made->places[c->made->place_count++] = (iso_chain_place){.ring = ring, .keep = true};
    chain->count++;
}

/* Walks along a line from `ring` over `next` to its end, or to where it began. */
static void walk(chaining *c, uint32_t ring, uint32_t next) {
    iso_chains *made = c->made;
    iso_chain *chain = &made->chains[made->count];
    uint32_t from = ring, at = next;
    if (c->walked[link_of(c, ring, next)]) return;
    made->count++;
    *chain = (iso_chain){.first = made->place_count, .piece = c->rings->rings[ring].piece};
    chain->attached[0] = c->degree[ring] > 2 && !goes_through(c, next, ring);
    put(c, chain, ring);
    for (;;) {
        c->walked[link_of(c, from, at)] = c->walked[link_of(c, at, from)] = true;
        put(c, chain, at);
        if (!goes_through(c, from, at) || at == ring) break;
        const uint32_t after = next_of_line(c, from, at);
        if (after == NONE || c->walked[link_of(c, at, after)]) break;
        from = at;
        at = after;
    }
    chain->attached[1] = c->degree[at] > 2 && !goes_through(c, from, at);
}

/* Chains from rings where lines end, or from all others. */
static void start_chains(chaining *c, bool ends) {
    const iso_mesh_rings *rings = c->rings;
    for (size_t i = 0; i < rings->ring_count; i++) {
        const uint32_t ring = (uint32_t)i;
        if (is_left_out(c, ring)) continue;
        for (size_t k = rings->link_first[i]; k < rings->link_first[i + 1]; k++) {
            const uint32_t next = rings->links[k];
            if (is_left_out(c, next) || (ends && goes_through(c, next, ring))) continue;
            walk(c, ring, next);
        }
    }
}

static iso_status reserve(chaining *c, iso_error *error) {
    const size_t rings = c->rings->ring_count, links = c->rings->link_first[rings];
    c->degree = iso_alloc_zero(rings + 1, sizeof *c->degree);
    c->through = iso_alloc((rings + 1) * sizeof *c->through);
    c->walked = iso_alloc_zero(links + 1, sizeof *c->walked);
    c->path = iso_alloc((rings + 1) * sizeof *c->path);
    c->made->stand_in = iso_alloc((rings + 1) * sizeof *c->made->stand_in);
    c->made->chains = iso_alloc((links + 1) * sizeof *c->made->chains);
    c->made->places = iso_alloc((links + 1) * sizeof *c->made->places);
    if (c->degree && c->through && c->walked && c->path && c->made->stand_in && c->made->chains &&
        c->made->places)
        return ISO_OK;
    return iso_fail_memory(error, "lines of a mesh");
}

static void cut(chaining *c) {
    const iso_mesh_rings *rings = c->rings;
    for (size_t i = 0; i < rings->ring_count; i++) {
        c->made->stand_in[i] = (uint32_t)i;
        c->degree[i] = (uint32_t)(rings->link_first[i + 1] - rings->link_first[i]);
    }
    leave_out_short(c);
    for (size_t i = 0; i < rings->ring_count; i++)
        if (c->degree[i] > 2 && !is_left_out(c, (uint32_t)i)) choose_through(c, (uint32_t)i);
    start_chains(c, true);
    start_chains(c, false); /* closed lines have no ends */
}

/* ---- where lines begin on others */

/* The next place of a chain that is kept, from one of its ends on; the last place if there is none. */
static size_t kept_after(const iso_chains *chains, const iso_chain *chain, size_t i, int end) {
    const size_t last = end ? 0 : chain->count - 1;
    while (i != last) {
        i += end ? SIZE_MAX : 1;
        if (chains->places[chain->first + i].keep) break;
    }
    return i;
}

/* The chain that a place belongs to. */
static const iso_chain *chain_at(const iso_chains *chains, size_t place) {
    size_t low = 0, high = chains->count;
    while (high - low > 1) {
        const size_t middle = (low + high) / 2;
        if (chains->chains[middle].first <= place)
            low = middle;
        else
            high = middle;
    }
    return &chains->chains[low];
}

/* Lets a line begin at the place of the other line that continues it best, near the ring where they join:
 * where their surfaces part, which is later, they lie beside each other already. owner: of each ring its
 * place. */
static void move_start(chaining *c, const iso_chain *chain, int end, const size_t *owner) {
    iso_chain_place *places = c->made->places;
    const size_t at = end ? chain->count - 1 : 0;
    const iso_mesh_ring *rings = c->rings->rings, *joint = &rings[places[chain->first + at].ring];
    const size_t own = owner[places[chain->first + at].ring];
    if (chain->count < 3 || own == SIZE_MAX) return;
    const iso_chain *other = chain_at(c->made, own);
    for (size_t i = 1; i + 1 < chain->count; i++) { /* beside or in the other branch */
        iso_chain_place *p = &places[chain->first + (end ? chain->count - 1 - i : i)];
        if (iso_vec3_length(iso_vec3_sub(rings[p->ring].at, joint->at)) >= BESIDE * joint->reach) break;
        p->keep = false;
    }
    const size_t first = kept_after(c->made, chain, at, end), second = kept_after(c->made, chain, first, end);
    const iso_vec3 from = rings[places[chain->first + first].ring].at,
                   back = iso_vec3_unit(iso_vec3_sub(from, rings[places[chain->first + second].ring].at));
    double best = -2;
    places[chain->first + at].radius = places[chain->first + first].radius;
    for (size_t i = other->first; i < other->first + other->count && other != chain; i++) {
        const iso_mesh_ring *ring = &rings[places[i].ring];
        const iso_vec3 path = iso_vec3_sub(ring->at, from);
        const double cosine = iso_vec3_dot(iso_vec3_unit(path), back);
        if (owner[places[i].ring] != i || !(cosine > best)) continue;
        if (iso_vec3_length(iso_vec3_sub(ring->at, joint->at)) > 2 * joint->reach) continue;
        best = cosine;
        places[chain->first + at].ring = places[i].ring;
    }
}

static iso_status move_starts(chaining *c, iso_error *error) {
    const iso_chains *made = c->made;
    size_t *owner = iso_alloc((c->rings->ring_count + 1) * sizeof *owner);
    if (!owner) return iso_fail_memory(error, "lines of a mesh");
    memset(owner, 0xff, c->rings->ring_count * sizeof *owner);
    for (size_t i = 0; i < made->count; i++) {
        const iso_chain *chain = &made->chains[i];
        for (size_t k = chain->attached[0]; k + chain->attached[1] < chain->count; k++)
            owner[made->places[chain->first + k].ring] = chain->first + k;
    }
    for (size_t i = 0; i < made->count; i++)
        for (int end = 0; end < 2; end++)
            if (made->chains[i].attached[end]) move_start(c, &made->chains[i], end, owner);
    iso_free(owner);
    return ISO_OK;
}

iso_status iso_chains_make(iso_mesh_rings *rings, iso_chains *chains, iso_error *error) {
    chaining c = {.rings = rings, .made = chains};
    *chains = (iso_chains){.count = 0};
    iso_status status = reserve(&c, error);
    if (status == ISO_OK) {
        cut(&c);
        status = iso_chains_smooth(rings, chains, c.degree, error);
        if (status == ISO_OK) status = move_starts(&c, error);
    }
    iso_free(c.degree);
    iso_free(c.through);
    iso_free(c.walked);
    iso_free(c.path);
    if (status != ISO_OK) iso_chains_free(chains);
    return status;
}

void iso_chains_free(iso_chains *chains) {
    iso_free(chains->chains);
    iso_free(chains->places);
    iso_free(chains->stand_in);
    *chains = (iso_chains){.count = 0};
}
