/* images: makes a picture of each group of discs in a band, composited back to front, and averages the
 * pictures (Zhang and Pajarola 2006, algorithm 2). For algorithm 3, the nearest layer is drawn separately. */

#include "render/groups/disc_hits.h"
#include "render/groups/layer_lists.h"

/* A pixel in the picture of one group. */
typedef struct pixel {
    float color[3], through; /* composited so far: premultiplied colour, share of the light that passes */
    float bin;               /* bin of depth of the last disc */
    int layers;              /* number of discs that were composited */
} pixel;

/* The pictures of a band. In algorithm 3 the band's memory begins with the slots. */
typedef struct images {
    const iso_splat_surface *surface;
    const iso_splat_band *band;
    size_t pixels;
    uint64_t *keys; /* slots of the nearest layer */
    pixel *image;   /* a pixel for each group */
    float *front;   /* for each group: depth of the nearest disc that was composited */
    float *mask;    /* depth of the front of the nearest layer; -INFINITY: there is none */
} images;

static bool set_up(const iso_splat_surface *surface, const iso_splat_band *band, images *im) {
    const size_t groups = (size_t)surface->input->groups->count,
                 pixels = (size_t)band->width * (size_t)(band->rows.last - band->rows.first + 1);
    if (iso_buffer_reserve(band->memory,
                           pixels * (groups * (sizeof *im->keys + sizeof *im->image) + 2 * sizeof(float)), 0,
                           NULL) != ISO_OK)
        return false;
    *im = (images){.surface = surface, .band = band, .pixels = pixels, .keys = band->memory->data};
    im->image = (pixel *)(im->keys + pixels * groups);
    im->front = (float *)(im->image + pixels * groups);
    im->mask = im->front + pixels;
    for (size_t i = 0; i < pixels * groups; i++) im->image[i] = (pixel){{0, 0, 0}, 1, INFINITY, 0};
    for (size_t i = 0; i < pixels; i++) im->front[i] = INFINITY;
    for (size_t i = 0; i < pixels; i++) im->mask[i] = -INFINITY;
    return true;
}

/* ---- all layers, or those behind the nearest one */

/* Composites a disc over the discs behind it, unless its group already has a disc in the same bin of
 * depth. */
static void composite(pixel *to, const iso_fragment *disc, float bin) {
    if (!(bin < to->bin)) return;
    to->bin = bin;
    to->layers++;
    to->through *= 1 - disc->opacity;
    for (int k = 0; k < 3; k++)
        to->color[k] = disc->opacity * disc->color[k] + (1 - disc->opacity) * to->color[k];
}

/* The drawing of a disc. */
typedef struct drawn_disc {
    const images *im;
    iso_fragment shaded;
    float thickness; /* based on the disc's usual size, not on the enlarged one */
    uint64_t groups; /* bits of the groups that it belongs to */
} drawn_disc;

static void draw_hits(void *context, const iso_disc_hits *hits, int count) {
    const drawn_disc *d = context;
    const images *im = d->im;
    const iso_splat_band *band = im->band;
    for (int i = 0; i < count; i++) {
        const size_t at =
            (size_t)(hits->row[i] - band->rows.first) * (size_t)band->width + (size_t)hits->column[i];
        const float depth = hits->depth[i];
        if (depth <= im->mask[at] + d->thickness || (band->lists->limit && !(depth < band->lists->limit[at])))
            continue;
        for (uint64_t left = d->groups; left; left &= left - 1) {
            pixel *image = im->image + im->pixels * (size_t)__builtin_ctzll(left);
            composite(&image[at], &d->shaded, floorf(depth / im->surface->bin));
        }
        im->front[at] = depth < im->front[at] ? depth : im->front[at];
    }
}

static void draw_disc(const images *im, uint32_t number) {
    const iso_splat_surface *surface = im->surface;
    const iso_disc *disc = (const iso_disc *)surface->wide.disc.data + number;
    const iso_disc_box within = {{0, im->band->width - 1}, im->band->rows};
    const iso_groups *groups = surface->input->groups;
    drawn_disc drawn = {.im = im,
                        .shaded = iso_splat_fragment(surface, disc),
                        .thickness = iso_splat_thickness((const iso_disc *)surface->discs.disc.data + number),
                        .groups = (uint64_t)1 << groups->group[disc->point] |
                                  (groups->copies ? groups->copies[disc->point] : 0)};
    iso_disc_visit_hits(&surface->wide, disc, &within, draw_hits, &drawn);
}

static void draw_discs(const images *im) {
    const size_t *start = (const size_t *)im->surface->wide.start.data + im->band->number;
    const uint32_t *order = im->surface->wide.order.data;
    for (size_t i = start[0]; i < start[1]; i++) draw_disc(im, order[i]);
}

/* Sums over the groups' pictures at a pixel. */
typedef struct group_sums {
    float through, color[3];
    int layers, count; /* count: of groups */
} group_sums;

/* Sums up the groups' pictures. If most groups have the front layer, a group without it has a hole there and
 * is left out; if few groups have it, the layer itself may end there. */
static group_sums sum_groups(const images *im, size_t at) {
    const pixel *pixels = im->image + at;
    const int groups = im->surface->input->groups->count;
    const float front = floorf(im->front[at] / im->surface->bin) + 1;
    group_sums sums = {.count = 0};
    int whole = 0;
    for (int g = 0; g < groups; g++) whole += pixels[(size_t)g * im->pixels].bin <= front;
    for (int g = 0; g < groups; g++) {
        const pixel *p = &pixels[(size_t)g * im->pixels];
        if (2 * whole > groups && p->bin > front) continue;
        sums.through += p->through;
        for (int k = 0; k < 3; k++) sums.color[k] += p->color[k];
        sums.layers += p->layers;
        sums.count++;
    }
    return sums;
}

/* Sets a fragment to the mean of the groups' pictures; returns false if they are empty. */
static bool take_mean(const images *im, size_t at, iso_fragment *fragment) {
    const group_sums sums = sum_groups(im, at);
    *fragment = (iso_fragment){.depth = im->front[at],
                               .opacity = 1 - sums.through / (float)sums.count,
                               .surface = im->surface->number};
    if (!(fragment->opacity > 0)) return false;
    for (int k = 0; k < 3; k++) fragment->color[k] = sums.color[k] / (float)sums.count / fragment->opacity;
    return true;
}

/* Lists as many layers without normals as the groups' pictures have in the mean. */
static void list_count(const images *im, size_t at, int x, int row) {
    const group_sums sums = sum_groups(im, at);
    const iso_fragment layer = {.depth = im->front[at], .surface = im->surface->number};
    for (int i = (sums.layers + sums.count / 2) / sums.count; i > 0; i--)
        iso_layer_add(im->band->lists, x, row, &layer, false);
}

/* ---- the nearest layer */

static void draw_nearest(const images *im, const iso_slots *slots) {
    const iso_slots_band band = {slots, im->band->rows, im->keys, im->band->lists->limit};
    const size_t *start = (const size_t *)slots->discs->start.data + im->band->number;
    const uint32_t *order = slots->discs->order.data;
    iso_slots_clear(&band);
    for (size_t i = start[0]; i < start[1]; i++) iso_slots_draw(&band, order[i]);
}

/* Lists the nearest layer of each pixel, and sets im->mask. */
static void list_nearest(const images *im, const iso_slots *slots) {
    const iso_splat_band *band = im->band;
    const iso_disc_view *view = &slots->discs->view;
    for (size_t i = 0; i < im->pixels; i++) {
        const int x = (int)(i % (size_t)band->width), row = (int)(i / (size_t)band->width);
        const float px = iso_disc_column(view, x), py = iso_disc_row(view, band->rows.first + row);
        iso_splat_sums sums;
        if (!iso_slots_resolve(slots, im->keys + i * (size_t)slots->groups->count, px, py, &sums,
                               &im->mask[i]))
            continue;
        const iso_fragment fragment = iso_splat_mean_fragment(im->surface, &sums, false, px, py);
        iso_layer_add(band->lists, x, row, &fragment, false);
    }
}

bool iso_groups_list_images(const iso_splat_surface *surface, const iso_splat_band *band, bool nearest) {
    const iso_slots slots = {
        &surface->input->points, surface->input->groups, &surface->discs, band->width, 0, NULL};
    images im;
    if (!set_up(surface, band, &im)) return false;
    if (nearest) {
        draw_nearest(&im, &slots);
        list_nearest(&im, &slots);
    }
    draw_discs(&im);
    for (size_t i = 0; i < im.pixels; i++) {
        iso_fragment fragment;
        if (surface->normals) {
            list_count(&im, i, (int)(i % (size_t)band->width), (int)(i / (size_t)band->width));
            continue;
        }
        if (!take_mean(&im, i, &fragment)) continue;
        fragment.depth = fragment.depth < im.mask[i] ? im.mask[i] : fragment.depth;
        iso_layer_add(band->lists, (int)(i % (size_t)band->width), (int)(i / (size_t)band->width), &fragment,
                      false);
    }
    return !band->lists->full;
}
