/* Finds flat things by the principal axes of a sample of their vertices. */
#include <math.h>

#include "apps/isorender/flat.h"

#include "base/tensor.h"

enum { SAMPLES = 50000 }; /* points of each set, at most about so many */

/* Sums over points. */
typedef struct moments {
    iso_vec3 center; /* what positions are relative to, so that those far from 0 lose no digits */
    double scale;    /* by which they are multiplied */
    double count, sum[3], products[6];
} moments;

static void add(moments *m, iso_vec3 world) {
    double p[3];
    iso_vec3_store(iso_vec3_scale(iso_vec3_sub(world, m->center), m->scale), p);
    m->count++;
    for (int a = 0, k = 0; a < 3; a++) {
        m->sum[a] += p[a];
        for (int b = a; b < 3; b++) m->products[k++] += p[a] * p[b];
    }
}

static void add_positions(moments *m, iso_vec3 origin, const float (*positions)[3], size_t count) {
    for (size_t i = 0; i < count; i += count / SAMPLES + 1) {
        const float *p = positions[i];
        add(m, iso_vec3_add(origin, iso_vec3_make((double)p[0], (double)p[1], (double)p[2])));
    }
}

static void add_cloud(moments *m, const iso_point_view *view, size_t count) {
    const iso_affine affine = iso_transform_affine(&view->transform);
    const size_t step = count / SAMPLES + 1;
    for (size_t s = 0; s < view->span_count; s++)
        for (size_t i = 0; i < view->spans[s].count; i += step) {
            const iso_surfel surfel = iso_point_view_get(view, view->spans[s].first + i);
            add(m, iso_affine_point(&affine, iso_brick_position(view->spans[s].brick, surfel.position)));
        }
}

static void add_object(moments *m, const isorender_object *object) {
    const iso_triangles *mesh = &object->file.mesh;
    add_positions(m, (iso_vec3){0}, (const float(*)[3])mesh->vertices, mesh->vertex_count);
    const iso_lines *lines = &object->file.lines;
    add_positions(m, lines->origin, (const float(*)[3])lines->vertices, lines->vertex_count);
    const iso_glyphs *glyphs = &object->file.glyphs;
    add_positions(m, glyphs->origin, (const float(*)[3])glyphs->positions, glyphs->count);
}

/* What is at most this part of its length wide, by standard deviations, is a line, which has no face. */
static const double LINE = 0.02;

bool isorender_is_flat(const isorender_job *job, double ratio, iso_vec3 *across) {
    const iso_box *box = &job->bounds_framed;
    const double size = iso_vec3_length(iso_vec3_sub(box->hi, box->lo));
    moments m = {.center = iso_vec3_scale(iso_vec3_add(box->lo, box->hi), 0.5), .scale = 1 / size};
    if (!(size > 0) || job->cloud.outside) return false;
    if (job->loader.has_points) add_cloud(&m, &job->read_points, job->cloud.discs.count);
    for (int i = 0; i < job->object_count; i++) add_object(&m, &job->objects[i]);
    if (!(m.count > 0)) return false;
    float covariance[6];
    for (int a = 0, k = 0; a < 3; a++)
        for (int b = a; b < 3; b++, k++)
            covariance[k] = (float)(m.products[k] / m.count - m.sum[a] / m.count * (m.sum[b] / m.count));
    const iso_eigen eigen = iso_tensor_eigen(covariance);
    const double *least = eigen.vectors[2];
    double deviation[3];
    for (int i = 0; i < 3; i++) deviation[i] = sqrt(fmax(eigen.values[i], 0));
    *across = iso_vec3_make(least[0], least[1], least[2]);
    return deviation[2] < ratio * deviation[1] && deviation[1] > LINE * deviation[0];
}
