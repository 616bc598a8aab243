/* absorb: composites fragments of solids that absorb light. Between two fragments the light is attenuated
 * exponentially by the length of the ray (Beer and Lambert); what is absorbed is replaced by the colours of
 * the solids in which the ray is. */
#include <math.h>

#include "base/exponential.h"
#include "render/layers/compose_kernel.h"

static const float LOG2_E = 1.44269504f;

/* The state of a ray during compositing. */
typedef struct light {
    float color[3], through;
    float depth;     /* depth that has been reached */
    uint64_t inside; /* bit by surface: the ray is in its solid */
} light;

/* Follows the ray to `depth` and attenuates its light in the solids that it is in. length: mm along the ray
 * for 1 mm of depth. */
static void absorb(const iso_layer_media *media, light *l, float depth, float length) {
    float rate = 0, color[3] = {0, 0, 0};
    for (uint64_t inside = l->inside; inside; inside &= inside - 1) {
        const iso_layer_medium *medium = &media->solids[__builtin_ctzll(inside)];
        rate += medium->per_mm;
        for (int k = 0; k < 3; k++) color[k] += medium->per_mm * medium->color[k];
    }
    if (rate > 0 && depth > l->depth) {
        const float left = iso_exp2(-rate * LOG2_E * length * (depth - l->depth));
        for (int k = 0; k < 3; k++) l->color[k] += l->through * (1 - left) * (color[k] / rate);
        l->through *= left;
    }
    if (depth > l->depth) l->depth = depth;
}

/* Composites the fragments of a sample; returns their number. */
static int composite(const iso_layer_media *media, const iso_layer_group *group, int column, light *l,
                     float length) {
    int k = 0;
    for (; k < group->list[column].count && l->through >= ISO_LAYER_CUT; k++) {
        const iso_fragment fragment = iso_fragment_unpack(&iso_layer_at(group, k)[column]);
        absorb(media, l, fragment.depth, length);
        const float weight = l->through * fragment.opacity;
        for (int c = 0; c < 3; c++) l->color[c] += weight * fragment.color[c];
        l->through *= 1 - fragment.opacity;
        if (fragment.surface >= media->count) continue;
        const uint64_t bit = (uint64_t)1 << fragment.surface;
        l->inside = fragment.leaves ? l->inside & ~bit : l->inside | bit;
    }
    return k;
}

void iso_layers_absorb(const iso_layer_media *media, const iso_layer_lists *lists, int row,
                       const iso_layer_line *line, iso_layer_totals *totals) {
    const iso_layer_rays *rays = media->rays;
    for (int x = 0; x < lists->width; x++) {
        const ptrdiff_t at = (ptrdiff_t)row * lists->width + x;
        light l = {.through = 1, .depth = rays->begin[at], .inside = rays->inside[at]};
        const float length = rays->length[at];
        const int layers =
            composite(media, iso_layer_group_at(lists, x, row), x % ISO_LAYER_GROUP, &l, length);
        if (l.through >= ISO_LAYER_CUT) {
            float end = rays->end[at];
            if (lists->limit) end = fminf(end, lists->limit[at] - lists->middle);
            absorb(media, &l, end, length);
        }
        for (int c = 0; c < 3; c++) line->color[c][x] = l.color[c];
        line->through[x] = l.through;
        line->layers[x] = (float)layers;
        totals->layers += (size_t)layers;
        if (layers > totals->most) totals->most = layers;
    }
}
