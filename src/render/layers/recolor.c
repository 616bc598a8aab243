/* recolor: goes through the fragments of a band, row by row. */
#include "render/layers/recolor.h"

#include "render/shading/phong_vectors.h"
#include "render/shading/shading.h"

static void recolor_sample(const iso_layer_lists *lists, const iso_layer_recolor *recolor, int x, int row,
                           int y, iso_nearby nearby[ISO_LAYER_SURFACES]) {
    iso_layer_group *group = iso_layer_group_at(lists, x, row);
    const int column = x % ISO_LAYER_GROUP, count = group->list[column].count;
    const float to_eye[3] = {-iso_slope_of_column(recolor->view, x), -iso_slope_of_row(recolor->view, y), -1};
    for (int k = 0; k < count; k++) {
        iso_packed_fragment *packed = &iso_layer_at(group, k)[column];
        iso_fragment fragment = iso_fragment_unpack(packed);
        if (fragment.surface >= recolor->count || !recolor->colors[fragment.surface]) continue;
        const iso_surface_colors *colors = recolor->colors[fragment.surface];
        float n[3];
        iso_fragment_normal(&fragment, n);
        const double depth = (double)fragment.depth + (double)lists->middle;
        const iso_colored_point point = iso_colored_point_at(
            recolor->view, x, y, depth, iso_vec3_make((double)n[0], (double)n[1], (double)n[2]));
        const iso_rgb color = colors->at(colors->context, &point, &nearby[fragment.surface]);
        iso_shade_sample(n, to_eye, color, fragment.color);
        *packed = iso_fragment_pack(&fragment);
    }
}

void iso_layer_lists_recolor(iso_layer_lists *lists, const iso_layer_recolor *recolor, int first) {
    for (int row = 0; row < lists->rows; row++) {
        iso_nearby nearby[ISO_LAYER_SURFACES] = {{0}};
        for (int x = 0; x < lists->width; x++) recolor_sample(lists, recolor, x, row, first + row, nearby);
        for (int i = 0; i < ISO_LAYER_SURFACES; i++) iso_nearby_free(&nearby[i]);
    }
}
