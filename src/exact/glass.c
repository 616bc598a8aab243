/* glass: makes the map of crossings from the lists of fragments of a surface that hides nothing behind it. */
#include "exact/glass.h"

#include "exact/layers.h"

/* The callback iso_exact_layers_reader.read. */
static void read_band(void *context, const iso_layer_lists *lists, const iso_layer_rays *rays, int first) {
    const iso_glass_map *map = context;
    for (int row = 0; row < lists->rows; row++)
        for (int x = 0; x < lists->width; x++) {
            const ptrdiff_t at = (ptrdiff_t)row * lists->width + x;
            const iso_layer_group *group = iso_layer_group_at(lists, x, row);
            const int column = x % ISO_LAYER_GROUP, count = group->list[column].count;
            const float length = rays->length[at];
            float reached = rays->begin[at];
            bool inside = rays->inside[at] & 1;
            iso_glass_crossings c = iso_glass_crossings_begin(reached + lists->middle, inside);
            for (int k = 0; k < count; k++) {
                const iso_fragment fragment = iso_fragment_unpack(&iso_layer_at(group, k)[column]);
                float normal[3];
                iso_fragment_normal(&fragment, normal);
                iso_glass_crossings_add(&c, reached, fragment.depth, length, fragment.leaves, normal);
                reached = fragment.depth;
                inside = !fragment.leaves;
            }
            for (int k = 0; k < 2; k++)
                if (k >= c.inside) c.depth[k] += lists->middle;
            if (inside && rays->end[at] > reached) c.thickness += (rays->end[at] - reached) * length;
            map->crossings[(ptrdiff_t)(first + row) * lists->width + x] = c;
        }
}

iso_status iso_exact_map_glass(const iso_exact *exact, const iso_glass_map *map, iso_pool *pool,
                               iso_error *error) {
    const iso_gbuffer size = {.width = map->view->width, .height = map->view->height};
    const iso_strip strip = {.view = map->view, .gbuffer = &size, .factor = 1};
    const iso_exact_layer layer = {.exact = exact, .translucency = {.constant = true}};
    const iso_exact_layers_reader reader = {.read = read_band, .context = (void *)map};
    const iso_exact_layers layers = {
        .layers = &layer, .count = 1, .picture = {.strip = &strip, .pool = pool}, .reader = &reader};
    iso_exact_layers_totals totals = {.retraced = 0};
    return iso_shade_exact_layers(&layers, &totals, error);
}
