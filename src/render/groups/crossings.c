/* crossings: makes the map of crossings of a solid from the layers of its points. */
#include "render/groups/layer_lists.h"

/* A layer behind a sample. */
static iso_fragment layer_at(const iso_layer_lists *lists, int x, int row, int number) {
    const int column = x % ISO_LAYER_GROUP;
    return iso_fragment_unpack(&iso_layer_at(iso_layer_group_at(lists, x, row), number)[column]);
}

/* Returns the number of the layer at which the ray crosses the solid's surface after the first `done` layers:
 * of consecutive layers of one side the first if the ray enters there, the last if it leaves. count: there is
 * none. */
static int next_crossing(const iso_layer_lists *lists, int x, int row, int done, int count, bool leaves) {
    int at = done;
    while (at < count && layer_at(lists, x, row, at).leaves != leaves) at++;
    while (leaves && at + 1 < count && layer_at(lists, x, row, at + 1).leaves) at++;
    return at;
}

static iso_glass_crossings crossings_of(const iso_layer_lists *lists, int x, int row, float length) {
    const int count = iso_layer_group_at(lists, x, row)->list[x % ISO_LAYER_GROUP].count;
    iso_glass_crossings c = iso_glass_crossings_begin(0, false);
    float reached = 0;
    bool leaves = false;
    int at = next_crossing(lists, x, row, 0, count, false);
    if (at == count) at = 0; /* only far sides are seen: the first of them stands for the near side */
    for (; at < count; at = next_crossing(lists, x, row, at + 1, count, leaves)) {
        const iso_fragment fragment = layer_at(lists, x, row, at);
        float normal[3];
        iso_fragment_normal(&fragment, normal);
        iso_glass_crossings_add(&c, reached, fragment.depth, length, leaves, normal);
        reached = fragment.depth;
        leaves = !leaves;
    }
    c.layers = (uint16_t)(count < UINT16_MAX - 1 ? count : UINT16_MAX - 1);
    return c;
}

void iso_groups_read_crossings(const iso_layer_lists *lists, int first, const iso_glass_map *map) {
    for (int row = 0; row < lists->rows; row++)
        for (int x = 0; x < lists->width; x++) {
            iso_vec3 origin, direction;
            iso_view_ray(map->view, x + 0.5, first + row + 0.5, &origin, &direction);
            map->crossings[(ptrdiff_t)(first + row) * map->view->width + x] =
                crossings_of(lists, x, row, (float)iso_vec3_length(direction));
        }
}
