/* label_colors: finds the label of each sample by its place in the fields. */
#include "scene/label_colors.h"

#include <string.h>

#include "base/cpu.h"
#include "base/kernel_units.h"
#include "base/memory.h"
#include "scene/label_colors_kernel.h"

enum { ROWS_PER_TASK = 8 };

typedef struct painting {
    const iso_label_colors *colors;
    int surface;
    const iso_view *view;
    iso_gbuffer *gbuffer;
    iso_affine affine; /* of the level sets */
    iso_label_samples_fn *place;
    bool *waits; /* of each task: it has samples whose labels are not told apart yet; these have no colour */
    bool again;  /* only these are painted */
} painting;

/* What the last sample showed. */
typedef struct last_sample {
    iso_label_cell cell;
    uint32_t color, element;
} last_sample;

static iso_label_rays rays_of_row(const painting *p, int y) {
    const int *dims = iso_label_fields_grid(p->colors->fields, p->colors->group)->dims;
    iso_vec3 origin[2], direction[2];
    for (int i = 0; i < 2; i++) {
        iso_view_ray(p->view, i + 0.5, y + 0.5, &origin[i], &direction[i]);
        origin[i] = iso_affine_point_to_index(&p->affine, origin[i]);
        direction[i] = iso_affine_vector_to_index(&p->affine, direction[i]);
    }
    const iso_vec3 along = iso_vec3_sub(origin[1], origin[0]),
                   turn = iso_vec3_sub(direction[1], direction[0]);
    return (iso_label_rays){{origin[0].x, origin[0].y, origin[0].z},
                            {along.x, along.y, along.z},
                            {direction[0].x, direction[0].y, direction[0].z},
                            {turn.x, turn.y, turn.z},
                            {dims[0] - 2, dims[1] - 2, dims[2] - 2}};
}

/* Whether sample i lies in the cell of the last one, and this shows one label. */
static inline bool is_same(const last_sample *last, const iso_label_samples *s, int i) {
    const iso_label_cell *cell = &last->cell;
    return cell->known && cell->count == 1 && s->cell[0][i] == cell->lo[0] && s->cell[1][i] == cell->lo[1] &&
           s->cell[2][i] == cell->lo[2];
}

/* Finds the label of sample i; false: it is not told apart yet. */
static bool look_at_sample(const painting *p, const iso_label_samples *s, int i, last_sample *last) {
    const iso_label_colors *colors = p->colors;
    const int label =
        iso_label_fields_near(colors->fields, colors->group,
                              iso_vec3_make(s->place[0][i], s->place[1][i], s->place[2][i]), &last->cell);
    if (label < 0) return false;
    const iso_rgb c = colors->colors[label];
    last->color = (uint32_t)c.r | (uint32_t)c.g << 8 | (uint32_t)c.b << 16 | ((uint32_t)p->surface + 1) << 24;
    last->element = (uint32_t)colors->labels[label].value;
    return true;
}

/* Paints `count` samples from `at` on. False: of some the label is not told apart yet. */
static bool paint_samples(const painting *p, const iso_label_samples *s, size_t at, int count,
                          last_sample *last) {
    iso_gbuffer *gbuffer = p->gbuffer;
    bool all = true;
    for (int i = 0; i < count; i++, at++) {
        if (gbuffer->surface[at] != p->surface || (p->again && gbuffer->color[at])) continue;
        const iso_vec3 normal = iso_gbuffer_normal(gbuffer, at);
        if (normal.x == 0 && normal.y == 0 && normal.z == 0) continue; /* a cap that shows the volume */
        const bool known = is_same(last, s, i) || look_at_sample(p, s, i, last);
        gbuffer->color[at] = known ? last->color : 0;
        if (known && gbuffer->element) gbuffer->element[at] = last->element;
        all &= known;
    }
    return all;
}

static void paint_rows(void *context, size_t index, int worker) {
    (void)worker;
    const painting *p = context;
    const iso_gbuffer *gbuffer = p->gbuffer;
    const int first = (int)index * ROWS_PER_TASK, width = gbuffer->width;
    last_sample last = {.cell.known = false};
    iso_label_samples samples = {.depth = {0}};
    if (p->again && !p->waits[index]) return;
    for (int y = first; y < first + ROWS_PER_TASK && y < gbuffer->height; y++) {
        const iso_label_rays rays = rays_of_row(p, y);
        for (int x = 0; x < width; x += ISO_LABEL_SAMPLES) {
            const int count = width - x < ISO_LABEL_SAMPLES ? width - x : ISO_LABEL_SAMPLES;
            const size_t at = (size_t)y * (size_t)width + (size_t)x;
            if (!memchr(gbuffer->surface + at, p->surface, (size_t)count)) continue;
            memcpy(samples.depth, gbuffer->depth + at, (size_t)count * sizeof *samples.depth);
            p->place(&rays, x, &samples);
            if (!paint_samples(p, &samples, at, count, &last)) p->waits[index] = true;
        }
    }
}

iso_status iso_label_colors_paint(const iso_label_colors *colors, int surface, const iso_view *view,
                                  iso_gbuffer *gbuffer, iso_pool *pool, iso_error *error) {
    const iso_hgrid *grid = iso_label_fields_grid(colors->fields, colors->group);
    const size_t tasks = ((size_t)gbuffer->height + ROWS_PER_TASK - 1) / ROWS_PER_TASK;
    painting p = {.colors = colors,
                  .surface = surface,
                  .view = view,
                  .gbuffer = gbuffer,
                  .affine = iso_transform_affine(&grid->transform),
                  .place = ISO_KERNEL_UNIT(iso_label_samples_place, iso_cpu_best())};
    ISO_TRY(iso_gbuffer_add_color(gbuffer, error));
    p.waits = iso_alloc_zero(tasks, sizeof *p.waits);
    if (!p.waits) return iso_fail(error, ISO_ERR_NOMEM, "out of memory for the colors of labels");
    iso_parallel_for(pool, tasks, paint_rows, &p);
    size_t task = 0;
    while (task < tasks && !p.waits[task]) task++;
    iso_status status = ISO_OK;
    if (task < tasks) {
        status = iso_label_fields_tell_apart(colors->fields, pool, error);
        p.again = true;
        if (status == ISO_OK) iso_parallel_for(pool, tasks, paint_rows, &p);
    }
    iso_free(p.waits);
    return status;
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
