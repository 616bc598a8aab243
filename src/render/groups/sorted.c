/* sorted: lists of all discs of each pixel of a band, sorted by depth and merged into layers. */
#include <string.h>

#include "render/groups/disc_hits.h"
#include "render/groups/layer_lists.h"

/* The largest size in bytes of a band's hits, and of those of a band that cannot be divided. */
static const size_t MOST_BYTES = 64 << 20, MOST_BYTES_LAST = (size_t)1 << 30;

/* A disc that a pixel's ray hits. */
typedef struct hit {
    float depth, e;
    uint32_t disc;
    bool away;
} hit;

/* The hits of a band: those of pixel i are hits[start[i]] .. hits[start[i + 1] - 1]. */
typedef struct hit_lists {
    size_t *start;
    hit *hits;
} hit_lists;

/* ---- collecting */

/* The collecting of a disc's hits. */
typedef struct collection {
    const iso_splat_band *band;
    const hit_lists *to;
    uint32_t disc;
} collection;

/* Adds hits of a disc: without `hits` only to the pixels' counts, which are start[2 ..]; else also stores
 * the hits where start[1 ..] points. */
static void collect_hits(void *context, const iso_disc_hits *found, int count) {
    const collection *c = context;
    const hit_lists *to = c->to;
    for (int i = 0; i < count; i++) {
        const size_t pixel =
            (size_t)(found->row[i] - c->band->rows.first) * (size_t)c->band->width + (size_t)found->column[i];
        if (to->hits)
            to->hits[to->start[pixel + 1]++] =
                (hit){found->depth[i], found->e[i], c->disc, found->away[i] != 0};
        else
            to->start[pixel + 2]++;
    }
}

static void collect_discs(const iso_splat_surface *surface, const iso_splat_band *band, const hit_lists *to) {
    const size_t *start = (const size_t *)surface->discs.start.data + band->number;
    const uint32_t *order = surface->discs.order.data;
    const iso_disc *discs = surface->discs.disc.data;
    const iso_disc_box within = {{0, band->width - 1}, band->rows};
    for (size_t i = start[0]; i < start[1]; i++) {
        collection c = {band, to, order[i]};
        iso_disc_visit_hits(&surface->discs, &discs[order[i]], &within, collect_hits, &c);
    }
}

/* Collects the hits of a band; those of each pixel are nearly in order. Returns false if they do not fit into
 * memory. */
static bool collect(const iso_splat_surface *surface, const iso_splat_band *band, size_t pixels,
                    hit_lists *all) {
    if (iso_buffer_reserve(band->starts, (pixels + 2) * sizeof *all->start, 0, NULL) != ISO_OK) return false;
    *all = (hit_lists){band->starts->data, NULL};
    memset(all->start, 0, (pixels + 2) * sizeof *all->start);
    collect_discs(surface, band, all);
    for (size_t i = 2; i < pixels + 2; i++) all->start[i] += all->start[i - 1];
    const size_t bytes = all->start[pixels + 1] * sizeof(hit);
    if (bytes > (band->last ? MOST_BYTES_LAST : MOST_BYTES)) return false;
    if (iso_buffer_reserve(band->memory, bytes, 0, NULL) != ISO_OK) return false;
    all->hits = band->memory->data;
    collect_discs(surface, band, all);
    return true;
}

/* ---- layers */

static bool is_nearer(const hit *a, const hit *b) {
    return a->depth < b->depth || (a->depth == b->depth && a->disc < b->disc);
}

/* Sorts the hits of a pixel, which are nearly sorted, by insertion. */
static void sort(hit *hits, size_t count) {
    for (size_t i = 1; i < count; i++) {
        const hit moved = hits[i];
        size_t at = i;
        for (; at > 0 && is_nearer(&moved, &hits[at - 1]); at--) hits[at] = hits[at - 1];
        hits[at] = moved;
    }
}

/* One side's layers, while they are extracted from the sorted hits of a pixel. */
typedef struct side {
    size_t at; /* index of the next hit */
    bool away, found;
    iso_splat_sums next;
} side;

/* Finds the next layer of a side, if there is one. */
static void find_layer(const iso_splat_surface *surface, const hit *hits, size_t count, side *s) {
    const iso_disc *discs = surface->discs.disc.data;
    float front = 0;
    s->found = false;
    s->next = (iso_splat_sums){0};
    for (; s->at < count; s->at++) {
        const hit *h = &hits[s->at];
        const iso_disc *disc = &discs[h->disc];
        if (h->away != s->away) continue;
        if (s->found && h->depth > front + iso_splat_thickness(disc)) return;
        if (!s->found) front = h->depth;
        s->found = true;
        iso_splat_add(&surface->input->points, disc, h->depth, h->e, &s->next);
    }
}

static float mean_depth(const side *s) {
    return s->found ? s->next.depth / s->next.weight : INFINITY;
}

/* Lists the layers of a pixel from front to back, until no more light passes. */
static void list_layers(const iso_splat_surface *surface, const iso_splat_band *band, const hit *hits,
                        size_t count, int x, int y) {
    const iso_disc_view *view = &surface->discs.view;
    side sides[2] = {{.away = false}, {.away = true}};
    for (int k = 0; k < 2; k++) find_layer(surface, hits, count, &sides[k]);
    while (sides[0].found || sides[1].found) {
        side *nearer = &sides[mean_depth(&sides[1]) < mean_depth(&sides[0])];
        const iso_fragment fragment = iso_splat_mean_fragment(
            surface, &nearer->next, nearer->away, iso_disc_column(view, x), iso_disc_row(view, y));
        if (iso_layer_add(band->lists, x, y - band->rows.first, &fragment, false)) return;
        find_layer(surface, hits, count, nearer);
    }
}

bool iso_groups_list_sorted(const iso_splat_surface *surface, const iso_splat_band *band) {
    const size_t width = (size_t)band->width,
                 pixels = width * (size_t)(band->rows.last - band->rows.first + 1);
    hit_lists all;
    if (!collect(surface, band, pixels, &all)) return false;
    for (size_t i = 0; i < pixels; i++) {
        const size_t count = all.start[i + 1] - all.start[i];
        if (!count) continue; /* without any hits there is no array */
        hit *own = all.hits + all.start[i];
        sort(own, count);
        list_layers(surface, band, own, count, (int)(i % width), band->rows.first + (int)(i / width));
    }
    return !band->lists->full;
}
