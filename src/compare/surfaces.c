/* surfaces: samples both surfaces, measures the distances of the samples, and counts the points inside. */
#include "compare/surfaces.h"

#include <math.h>
#include <stdlib.h>

#include "base/memory.h"

enum { SAMPLES_PER_TASK = 256, MOST_STEPS = 512, MESH_SAMPLES = 100000 };

/* A point of a surface, the area that it stands for, and its distance. */
typedef struct sample {
    iso_vec3 place;
    double area, distance;
} sample;

typedef struct samples {
    sample *items;
    size_t count;
    const iso_distance *distance;
} samples;

static iso_vec3 vertex(const iso_triangles *mesh, uint32_t number) {
    const float *v = mesh->vertices[number];
    return iso_vec3_make((double)v[0], (double)v[1], (double)v[2]);
}

/* A triangle's corners and its area. */
typedef struct triangle {
    iso_vec3 p[3];
    double area;
    int parts; /* along its sides */
} triangle;

static triangle triangle_at(const iso_triangles *mesh, size_t number, double spacing) {
    triangle t;
    for (int k = 0; k < 3; k++) t.p[k] = vertex(mesh, mesh->triangles[number][k]);
    const iso_vec3 sides[3] = {iso_vec3_sub(t.p[1], t.p[0]), iso_vec3_sub(t.p[2], t.p[0]),
                               iso_vec3_sub(t.p[2], t.p[1])};
    t.area = iso_vec3_length(iso_vec3_cross(sides[0], sides[1])) / 2;
    double longest = 0;
    for (int k = 0; k < 3; k++) longest = fmax(longest, iso_vec3_length(sides[k]));
    const double parts = spacing > 0 ? ceil(longest / spacing) : 0;
    t.parts = parts < 1 ? 1 : parts > MOST_STEPS ? MOST_STEPS : (int)parts;
    return t;
}

static iso_vec3 mix(const triangle *t, double u, double v) {
    return iso_vec3_add(iso_vec3_scale(t->p[0], 1 - u - v),
                        iso_vec3_add(iso_vec3_scale(t->p[1], u), iso_vec3_scale(t->p[2], v)));
}

/* Adds the middles of the equal parts of a triangle. */
static void add_parts(const triangle *t, samples *s) {
    const int n = t->parts;
    const double area = t->area / ((double)n * n);
    for (int i = 0; i < n; i++)
        for (int j = 0; i + j < n; j++) {
            s->items[s->count++] = (sample){mix(t, (i + 1 / 3.0) / n, (j + 1 / 3.0) / n), area, 0};
            if (i + j + 1 < n)
                s->items[s->count++] = (sample){mix(t, (i + 2 / 3.0) / n, (j + 2 / 3.0) / n), area, 0};
        }
}

/* The length of sides at which a mesh's triangles are divided, so that there are about MESH_SAMPLES parts. */
static double find_spacing(const iso_triangles *mesh) {
    double area = 0;
    for (size_t i = 0; i < mesh->triangle_count; i++) area += triangle_at(mesh, i, 0).area;
    return sqrt(2 * area / MESH_SAMPLES);
}

static iso_status make_samples(const iso_compared_surface *surface, samples *s, iso_error *error) {
    const iso_triangles *mesh = surface->mesh;
    const double spacing = surface->is_field ? 0 : find_spacing(mesh);
    size_t room = mesh->vertex_count;
    for (size_t i = 0; i < mesh->triangle_count && !surface->is_field; i++) {
        const triangle t = triangle_at(mesh, i, spacing);
        room += (size_t)t.parts * (size_t)t.parts;
    }
    s->items = iso_alloc((room + 1) * sizeof *s->items);
    if (!s->items) return iso_fail(error, ISO_ERR_NOMEM, "out of memory for %zu points", room);
    for (s->count = 0; s->count < mesh->vertex_count; s->count++)
        s->items[s->count] = (sample){vertex(mesh, (uint32_t)s->count), 0, 0};
    for (size_t i = 0; i < mesh->triangle_count; i++) {
        const triangle t = triangle_at(mesh, i, spacing);
        if (surface->is_field)
            for (int k = 0; k < 3; k++) s->items[mesh->triangles[i][k]].area += t.area / 3;
        else
            add_parts(&t, s);
    }
    return ISO_OK;
}

static void measure_samples(void *context, size_t index, int worker) {
    (void)worker;
    const samples *s = context;
    const size_t first = index * SAMPLES_PER_TASK;
    iso_nearby nearby = {0};
    for (size_t i = first; i < first + SAMPLES_PER_TASK && i < s->count; i++)
        s->items[i].distance = iso_distance_at(s->distance, s->items[i].place, &nearby);
    iso_nearby_free(&nearby);
}

static int compare_samples(const void *a, const void *b) {
    const double x = fabs(((const sample *)a)->distance), y = fabs(((const sample *)b)->distance);
    return (x > y) - (x < y);
}

static void sum_samples(samples *s, iso_surface_distances *d) {
    *d = (iso_surface_distances){.points = s->count};
    qsort(s->items, s->count, sizeof *s->items, compare_samples);
    for (size_t i = 0; i < s->count; i++) {
        const sample *item = &s->items[i];
        d->area += item->area;
        d->mean += item->area * fabs(item->distance);
        d->signed_mean += item->area * item->distance;
        d->rms += item->area * item->distance * item->distance;
    }
    if (d->area > 0) {
        d->mean /= d->area;
        d->signed_mean /= d->area;
        d->rms = sqrt(d->rms / d->area);
    }
    double before = 0;
    for (size_t i = 0; i < s->count && before < 0.95 * d->area; i++) {
        before += s->items[i].area;
        d->p95 = fabs(s->items[i].distance);
    }
    d->most = s->count ? fabs(s->items[s->count - 1].distance) : 0;
}

/* ---- volumes */

/* Counts of the lattice's points in each plane. */
typedef struct lattice {
    const iso_compared_surface *surfaces;
    iso_box box;
    double step;
    size_t dims[3], (*counts)[3]; /* in the first, in the second, in both */
} lattice;

static void count_plane(void *context, size_t plane, int worker) {
    (void)worker;
    const lattice *l = context;
    for (int k = 0; k < 3; k++) l->counts[plane][k] = 0;
    for (size_t y = 0; y < l->dims[1]; y++)
        for (size_t x = 0; x < l->dims[0]; x++) {
            const iso_vec3 place = {l->box.lo.x + ((double)x + 0.5) * l->step,
                                    l->box.lo.y + ((double)y + 0.5) * l->step,
                                    l->box.lo.z + ((double)plane + 0.5) * l->step};
            const bool a = iso_distance_is_inside(l->surfaces[0].distance, place),
                       b = iso_distance_is_inside(l->surfaces[1].distance, place);
            l->counts[plane][0] += a;
            l->counts[plane][1] += b;
            l->counts[plane][2] += a && b;
        }
}

static iso_status count_volumes(const iso_compared_surface surfaces[2], const iso_box *box, iso_pool *pool,
                                iso_surfaces_compared *compared, iso_error *error) {
    const double most = surfaces[0].is_field && surfaces[1].is_field ? 1e6 : 1e5;
    const iso_vec3 size = iso_vec3_sub(box->hi, box->lo);
    const double longest = fmax(size.x, fmax(size.y, size.z)), least = longest / 1000;
    lattice l = {.surfaces = surfaces, .box = *box};
    l.step = cbrt(fmax(size.x, least) * fmax(size.y, least) * fmax(size.z, least) / most);
    const double sides[3] = {size.x, size.y, size.z};
    for (int axis = 0; axis < 3 && l.step > 0; axis++) l.dims[axis] = (size_t)ceil(sides[axis] / l.step) + 1;
    l.counts = iso_alloc((l.dims[2] + 1) * sizeof *l.counts);
    if (!l.counts) return iso_fail(error, ISO_ERR_NOMEM, "out of memory");
    iso_parallel_for(pool, l.dims[2], count_plane, &l);
    size_t sums[3] = {0};
    for (size_t i = 0; i < l.dims[2]; i++)
        for (int k = 0; k < 3; k++) sums[k] += l.counts[i][k];
    iso_free(l.counts);
    const double each = l.step * l.step * l.step, both = (double)(sums[0] + sums[1]);
    compared->step = l.step;
    compared->volume[0] = (double)sums[0] * each;
    compared->volume[1] = (double)sums[1] * each;
    compared->overlap = (double)sums[2] * each;
    compared->dice = both > 0 ? 2 * (double)sums[2] / both : (double)NAN;
    return ISO_OK;
}

/* ---- both */

static iso_box box_of(const iso_compared_surface surfaces[2]) {
    iso_box box = iso_box_empty();
    for (int i = 0; i < 2; i++)
        for (size_t k = 0; k < surfaces[i].mesh->vertex_count; k++)
            iso_box_add(&box, vertex(surfaces[i].mesh, (uint32_t)k));
    return box;
}

iso_status iso_compare_surfaces(const iso_compared_surface surfaces[2], iso_pool *pool,
                                iso_surfaces_compared *compared, iso_error *error) {
    const iso_box box = box_of(surfaces);
    *compared = (iso_surfaces_compared){.step = 0};
    for (int i = 0; i < 2; i++) {
        samples s = {.distance = surfaces[1 - i].distance};
        ISO_TRY(make_samples(&surfaces[i], &s, error));
        iso_parallel_for(pool, (s.count + SAMPLES_PER_TASK - 1) / SAMPLES_PER_TASK, measure_samples, &s);
        sum_samples(&s, &compared->side[i]);
        iso_free(s.items);
    }
    const iso_surface_distances *a = &compared->side[0], *b = &compared->side[1];
    compared->mean = (a->mean + b->mean) / 2;
    compared->p95 = fmax(a->p95, b->p95);
    compared->hausdorff = fmax(a->most, b->most);
    return count_volumes(surfaces, &box, pool, compared, error);
}
