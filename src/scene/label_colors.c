/* label_colors: finds the label of each sample by its place in the fields. */
#include "scene/label_colors.h"

enum { ROWS_PER_TASK = 8 };

typedef struct painting {
    const iso_label_colors *colors;
    int surface;
    const iso_view *view;
    iso_gbuffer *gbuffer;
    iso_affine affine; /* of the level sets */
} painting;

static void paint_sample(const painting *p, int x, int y, size_t at, iso_label_cell *cell) {
    iso_gbuffer *gbuffer = p->gbuffer;
    iso_vec3 origin, direction;
    const iso_vec3 normal = iso_gbuffer_normal(gbuffer, at);
    if (normal.x == 0 && normal.y == 0 && normal.z == 0) return; /* a cap that shows the volume */
    iso_view_ray(p->view, x + 0.5, y + 0.5, &origin, &direction);
    const iso_vec3 place = iso_vec3_add(origin, iso_vec3_scale(direction, (double)gbuffer->depth[at]));
    const int label = iso_label_fields_near(p->colors->fields, p->colors->group,
                                            iso_affine_point_to_index(&p->affine, place), cell);
    const iso_rgb c = p->colors->colors[label];
    gbuffer->color[at] =
        (uint32_t)c.r | (uint32_t)c.g << 8 | (uint32_t)c.b << 16 | ((uint32_t)p->surface + 1) << 24;
    if (gbuffer->element) gbuffer->element[at] = (uint32_t)p->colors->labels[label].value;
}

static void paint_rows(void *context, size_t index, int worker) {
    (void)worker;
    const painting *p = context;
    const int first = (int)index * ROWS_PER_TASK;
    iso_label_cell cell = {.known = false};
    for (int y = first; y < first + ROWS_PER_TASK && y < p->gbuffer->height; y++)
        for (int x = 0; x < p->gbuffer->width; x++) {
            const size_t at = (size_t)y * (size_t)p->gbuffer->width + (size_t)x;
            if (p->gbuffer->surface[at] == p->surface) paint_sample(p, x, y, at, &cell);
        }
}

iso_status iso_label_colors_paint(const iso_label_colors *colors, int surface, const iso_view *view,
                                  iso_gbuffer *gbuffer, iso_pool *pool, iso_error *error) {
    const iso_hgrid *grid = iso_label_fields_grid(colors->fields, colors->group);
    const painting p = {colors, surface, view, gbuffer, iso_transform_affine(&grid->transform)};
    ISO_TRY(iso_gbuffer_add_color(gbuffer, error));
    const size_t tasks = ((size_t)gbuffer->height + ROWS_PER_TASK - 1) / ROWS_PER_TASK;
    iso_parallel_for(pool, tasks, paint_rows, (void *)&p);
    return ISO_OK;
}

iso_label_painter iso_label_painter_make(const iso_label_colors *colors) {
    const iso_hgrid *grid = iso_label_fields_grid(colors->fields, colors->group);
    return (iso_label_painter){colors, iso_transform_affine(&grid->transform)};
}

/* iso_surface_colors.at. */
static iso_rgb color_of_place(const void *context, const iso_colored_point *point, iso_nearby *nearby) {
    (void)nearby;
    const iso_label_painter *p = context;
    const iso_vec3 place = iso_affine_point_to_index(&p->affine, point->place);
    return p->colors->colors[iso_label_fields_at(p->colors->fields, p->colors->group, place)];
}

iso_surface_colors iso_label_painter_colors(const iso_label_painter *painter) {
    return (iso_surface_colors){color_of_place, painter};
}
