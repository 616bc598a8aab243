/* slots: deferred blending (Zhang and Pajarola 2006, sections 3.2 and 5.1) with one slot for each group in
 * every pixel. */
#include "render/groups/slots.h"

#include <string.h>

#include "render/groups/disc_hits.h"

static const uint64_t NO_DISC = UINT64_MAX;

/* ---- keys */

/* Maps a depth to an integer with the same order. */
static uint32_t ordered_bits(float depth) {
    uint32_t bits;
    memcpy(&bits, &depth, sizeof bits);
    return bits >> 31 ? ~bits : bits | 1u << 31;
}

/* Returns the upper half of a key of the paper: the depth in bins (eq. 6), and in each bin the distance
 * from the disc's centre (eq. 10), which stays below 1 so that a rim does not count as the centre of the
 * next bin. */
static uint32_t binned(const iso_slots *slots, float depth, float e) {
    const double least = (double)slots->discs->depth[0], range = (double)slots->discs->depth[1] - least,
                 part = range > 0 ? ((double)depth - least) / range : 0,
                 bin = floor((part < 0   ? 0
                              : part > 1 ? 1
                                         : part) *
                             slots->bins),
                 distance = sqrt((double)e) * (1 - 1.0 / 4096);
    return (uint32_t)((bin + distance) * (4294967295.0 / (slots->bins + 2)));
}

/* ---- drawing */

void iso_slots_clear(const iso_slots_band *band) {
    const size_t pixels = (size_t)(band->rows.last - band->rows.first + 1) * (size_t)band->slots->width;
    memset(band->keys, 0xff, pixels * (size_t)band->slots->groups->count * sizeof *band->keys); /* NO_DISC */
}

/* What the clip leaves of a disc. */
static iso_clip_rest rest_of(const iso_slots *slots, const iso_disc *disc) {
    if (!slots->cut) return ISO_CLIP_ALL;
    const iso_view *view = slots->cut->view;
    iso_vec3 origin, direction;
    iso_view_ray(view, view->cx + (double)disc->x, view->cy + (double)disc->y, &origin, &direction);
    const double r = (double)disc->radius;
    const iso_vec3 centre = iso_vec3_add(origin, iso_vec3_scale(direction, (double)disc->z)),
                   half[3] = {{r, 0, 0}, {0, r, 0}, {0, 0, r}};
    return iso_clip_of_box(slots->cut->clip, centre, half, &(unsigned){0});
}

/* Whether the clip leaves what is seen at this depth in the middle of a pixel of the whole picture. */
static bool is_left(const iso_slots *slots, int x, int y, float depth) {
    iso_vec3 origin, direction;
    iso_view_ray(slots->cut->view, x + 0.5, y + 0.5, &origin, &direction);
    return iso_clip_shows(slots->cut->clip, iso_vec3_add(origin, iso_vec3_scale(direction, (double)depth)));
}

/* The drawing of a disc into a band. */
typedef struct drawn_disc {
    const iso_slots_band *band;
    const iso_disc *disc;
    uint32_t number;
    bool is_cut; /* the clip leaves a part of it */
} drawn_disc;

static void draw_hits(void *context, const iso_disc_hits *hits, int count) {
    const drawn_disc *d = context;
    const iso_slots_band *band = d->band;
    const iso_slots *slots = band->slots;
    uint64_t *slot = band->keys + slots->groups->group[d->disc->point];
    const float thickness = iso_splat_thickness(d->disc);
    for (int i = 0; i < count; i++) {
        const int x = hits->column[i], y = hits->row[i];
        const size_t pixel = (size_t)(y - band->rows.first) * (size_t)slots->width + (size_t)x;
        uint64_t *to = slot + pixel * (size_t)slots->groups->count;
        if ((band->limit && !(hits->depth[i] < band->limit[pixel])) ||
            (d->is_cut && !is_left(slots, x, y, hits->depth[i])))
            continue;
        const uint32_t depth = slots->bins > 0 ? binned(slots, hits->depth[i], hits->e[i])
                                               : ordered_bits(hits->depth[i] + thickness * hits->e[i]);
        const uint64_t key = (uint64_t)depth << 32 | d->number;
        *to = key < *to ? key : *to;
    }
}

void iso_slots_draw(const iso_slots_band *band, uint32_t number) {
    const iso_slots *slots = band->slots;
    const iso_disc *disc = (const iso_disc *)slots->discs->disc.data + number;
    const iso_disc_box within = {{0, slots->width - 1}, band->rows};
    const iso_clip_rest rest = rest_of(slots, disc);
    drawn_disc drawn = {band, disc, number, rest == ISO_CLIP_SOME};
    if (rest != ISO_CLIP_NOTHING) iso_disc_visit_hits(slots->discs, disc, &within, draw_hits, &drawn);
}

/* ---- resolving */

/* The discs of a pixel's slots, intersected again with its ray. */
typedef struct candidates {
    const iso_disc *disc[ISO_GROUPS_MOST];
    iso_disc_hit hit[ISO_GROUPS_MOST];
    int count, front; /* number of discs; index of the nearest one */
} candidates;

static void find_candidates(const iso_slots *slots, const uint64_t *keys, float x, float y, candidates *c) {
    c->count = c->front = 0;
    for (int k = 0; k < slots->groups->count; k++) {
        if (keys[k] == NO_DISC) continue;
        const iso_disc *disc = (const iso_disc *)slots->discs->disc.data + (uint32_t)keys[k];
        iso_disc_intersect(&slots->discs->view, disc, x, y, &c->hit[c->count]);
        c->disc[c->count] = disc;
        if (c->hit[c->count].depth < c->hit[c->front].depth) c->front = c->count;
        c->count++;
    }
}

bool iso_slots_resolve(const iso_slots *slots, const uint64_t *keys, float x, float y, iso_splat_sums *sums,
                       float *front) {
    candidates c;
    find_candidates(slots, keys, x, y, &c);
    *sums = (iso_splat_sums){0};
    if (c.count == 0) return false;
    *front = c.hit[c.front].depth;
    for (int i = 0; i < c.count; i++)
        if (c.hit[i].away == c.hit[c.front].away && c.hit[i].depth <= *front + iso_splat_thickness(c.disc[i]))
            iso_splat_add(slots->points, c.disc[i], c.hit[i].depth, c.hit[i].e, sums);
    return true;
}
