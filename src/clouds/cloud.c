/* cloud: decides what has to be estimated, and puts the points into the order of their spans. */
#include "clouds/cloud.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "base/memory.h"
#include "clouds/radii.h"
#include "clouds/spans.h"

/* Marks the radius of a point that coincides with another one; finish_radii replaces it. */
#define REPEATED (-1.0f)

enum {
    CHUNK = 1024,
    LARGEST_RADIUS = 100, /* the largest radius that is used, in medians of all radii */
    LEAST_ACROSS = 20     /* an estimated radius is at most the diagonal of the bounds divided by this */
};

/* A cloud that is being made. The arrays are in the order of the file. */
typedef struct maker {
    const iso_glyphs *glyphs;
    const iso_cloud_opts *opts;
    iso_cloud *cloud;
    iso_point_source source;
    iso_point_survey survey;
    float (*normals)[3]; /* NULL: those of the source, none of which is missing */
    float *radii;        /* NULL: the same for all points */
    bool *has_radius;    /* whether the file's radius is used */
} maker;

static iso_status out_of_memory(size_t count, iso_error *error) {
    return iso_fail(error, ISO_ERR_NOMEM, "out of memory for %zu points", count);
}

/* ---- what the file has */

/* Copies the normals if some have to be estimated. */
static iso_status take_normals(maker *m, iso_error *error) {
    const size_t count = m->glyphs->count;
    const iso_point_column *given = &m->source.normals;
    m->cloud->estimated_normals = m->opts->without_normals ? 0 : m->survey.without_normals;
    if (!m->cloud->estimated_normals) return ISO_OK;
    m->normals = iso_alloc_zero(count, sizeof *m->normals);
    if (!m->normals) return out_of_memory(m->glyphs->count, error);
    for (size_t i = 0; i < count && given->data; i++) {
        iso_point_column_get(given, i, m->normals[i]);
        iso_point_normal(m->normals[i], m->normals[i]);
    }
    return ISO_OK;
}

/* Returns the value that would be number n in a sorted array. Reorders the values (Hoare 1961, "Algorithm 65:
 * Find"). */
static float select_nth(float *values, size_t count, size_t nth) {
    for (size_t low = 0, high = count - 1; low < high;) {
        const float pivot = values[low + (high - low) / 2];
        size_t i = low, j = high;
        for (;; i++, j--) {
            while (values[i] < pivot) i++;
            while (pivot < values[j]) j--;
            if (i >= j) break;
            const float moved = values[i];
            values[i] = values[j];
            values[j] = moved;
        }
        *(nth <= j ? &high : &low) = nth <= j ? j : j + 1;
    }
    return values[nth];
}

/* Returns the median of the values above 0, or 0 if there are none. Reorders the values. */
static float median_of(float *values, size_t count) {
    size_t kept = 0;
    for (size_t i = 0; i < count; i++)
        if (values[i] > 0 && isfinite(values[i])) values[kept++] = values[i];
    if (!kept) return 0;
    return select_nth(values, kept, kept / 2);
}

/* The median of the radii of the cloud; 0 on failure or if there are none. */
static iso_status median_radius(const maker *m, const float *radii, float *median, iso_error *error) {
    float *copy = iso_alloc(m->glyphs->count * sizeof *copy);
    if (!copy) return out_of_memory(m->glyphs->count, error);
    memcpy(copy, radii, m->glyphs->count * sizeof *copy);
    *median = median_of(copy, m->glyphs->count);
    iso_free(copy);
    return ISO_OK;
}

static iso_status take_radii(maker *m, iso_error *error) {
    const size_t count = m->glyphs->count;
    float median = 0;
    const bool given = m->glyphs->radii && !m->opts->estimate_radii && !(m->opts->radius > 0);
    if ((float)m->opts->radius > 0) return ISO_OK; /* of all points */
    m->radii = iso_alloc(count * sizeof *m->radii);
    m->has_radius = iso_alloc(count * sizeof *m->has_radius);
    if (!m->radii || !m->has_radius) return out_of_memory(m->glyphs->count, error);
    if (given) ISO_TRY(median_radius(m, m->glyphs->radii, &median, error));
    for (size_t i = 0; i < count; i++) {
        const float radius = given ? m->glyphs->radii[i] : 0;
        m->has_radius[i] = radius > 0 && radius <= LARGEST_RADIUS * median;
        m->radii[i] = m->has_radius[i] ? radius : 0;
        m->cloud->estimated_radii += !m->has_radius[i];
    }
    return ISO_OK;
}

/* ---- what is estimated */

typedef struct estimates {
    iso_tree tree;
    iso_neighbour_row *neighbours;
    float (*normals)[3], *radii; /* by slot */
} estimates;

static void find_neighbours(void *context, size_t chunk, int worker) {
    (void)worker;
    const estimates *e = context;
    const size_t first = chunk * CHUNK, end = first + CHUNK;
    for (size_t slot = first; slot < (end < e->tree.count ? end : e->tree.count); slot++) {
        iso_neighbour found[ISO_CLOUD_NEIGHBOURS];
        const int count = iso_tree_nearest(&e->tree, slot, ISO_CLOUD_NEIGHBOURS, found);
        for (int i = 0; i < ISO_CLOUD_NEIGHBOURS; i++)
            e->neighbours[slot][i] = count ? found[i < count ? i : count - 1].slot : (uint32_t)slot;
    }
}

static iso_status prepare(const maker *m, estimates *e, iso_error *error) {
    const size_t count = m->glyphs->count;
    ISO_TRY(iso_tree_make((const float(*)[3])m->glyphs->positions, count, m->opts->pool, &e->tree, error));
    e->neighbours = iso_alloc(count * sizeof *e->neighbours);
    e->normals = iso_alloc(count * sizeof *e->normals);
    e->radii = iso_alloc(count * sizeof *e->radii);
    if (!e->neighbours || !e->normals || !e->radii) return out_of_memory(m->glyphs->count, error);
    iso_parallel_for(m->opts->pool, (count + CHUNK - 1) / CHUNK, find_neighbours, e);
    return ISO_OK;
}

static iso_status estimate_normals(maker *m, estimates *e, iso_error *error) {
    const size_t bytes = sizeof *e->normals;
    for (size_t slot = 0; slot < e->tree.count; slot++)
        memcpy(e->normals[slot], m->normals[e->tree.points[slot].index], bytes);
    ISO_TRY(iso_normals_estimate(&e->tree, (const iso_neighbour_row *)e->neighbours, e->normals,
                                 m->opts->pool, error));
    for (size_t slot = 0; slot < e->tree.count; slot++)
        memcpy(m->normals[e->tree.points[slot].index], e->normals[slot], bytes);
    return ISO_OK;
}

/* Returns the largest radius that may be estimated. The limit is for clouds of few points, where the sixth
 * nearest point can be on another part of the surface. */
static double largest_estimate(const maker *m) {
    const iso_box box = iso_glyphs_bounds(m->glyphs);
    return iso_vec3_length(iso_vec3_sub(box.hi, box.lo)) / LEAST_ACROSS;
}

/* Whether the point in a slot, and the one before it, coincide with all their neighbours and with each
 * other. */
static bool repeats(const estimates *e, size_t slot) {
    if (!slot) return false;
    const float *p = e->tree.points[slot].position, *before = e->tree.points[slot - 1].position,
                *last = e->tree.points[e->neighbours[slot][ISO_CLOUD_NEIGHBOURS - 1]].position;
    return memcmp(p, before, 3 * sizeof *p) == 0 && memcmp(p, last, 3 * sizeof *p) == 0;
}

static iso_status estimate_radii(maker *m, estimates *e, iso_error *error) {
    const double largest = largest_estimate(m);
    ISO_TRY(iso_radii_estimate(&e->tree, (const iso_neighbour_row *)e->neighbours, e->radii, m->opts->pool,
                               error));
    for (size_t slot = 0; slot < e->tree.count; slot++) {
        const uint32_t i = e->tree.points[slot].index;
        if (m->has_radius[i]) continue;
        m->radii[i] = repeats(e, slot) ? REPEATED : fminf(e->radii[slot], (float)largest);
    }
    return ISO_OK;
}

static iso_status estimate(maker *m, iso_error *error) {
    estimates e = {.neighbours = NULL};
    iso_status status = prepare(m, &e, error);
    if (status == ISO_OK && m->cloud->estimated_normals) status = estimate_normals(m, &e, error);
    if (status == ISO_OK && m->cloud->estimated_radii) status = estimate_radii(m, &e, error);
    iso_tree_free(&e.tree);
    iso_free(e.neighbours);
    iso_free(e.normals);
    iso_free(e.radii);
    return status;
}

/* Sets the missing radii. Points whose neighbours are all at the same place have radius 0 and get the median.
 * One such disc is enough for a place: those that are marked as repeated get a radius so small that drawing
 * them takes no time. */
static iso_status finish_radii(maker *m, iso_error *error) {
    float median = (float)m->opts->radius;
    if (m->radii) ISO_TRY(median_radius(m, m->radii, &median, error));
    if (!(median > 0)) median = 1;
    for (size_t i = 0; i < m->glyphs->count && m->radii; i++)
        if (!(m->radii[i] > 0))
            m->radii[i] = m->radii[i] == REPEATED ? fmaxf(1e-6f * median, FLT_MIN) : median;
    m->cloud->radius = (double)median;
    return ISO_OK;
}

/* ---- the order of spans */

/* Fills the cloud, but for what has been estimated. */
static iso_status fill_cloud(const iso_point_source *source, const iso_point_survey *survey, double radius,
                             iso_pool *pool, iso_cloud *cloud, iso_error *error) {
    const double origin[3] = {source->origin.x, source->origin.y, source->origin.z};
    iso_sorted_points sorted;
    /* the radius of extracted points is sqrt(2) / 2 voxels */
    ISO_TRY(iso_points_sort(source, survey, radius * 1.4142135623730951, pool, &sorted, error));
    cloud->transform = iso_transform_identity();
    for (int axis = 0; axis < 3; axis++) {
        cloud->transform.origin[axis] = origin[axis] + sorted.origin[axis];
        cloud->transform.spacing[axis] = sorted.voxel;
    }
    cloud->surfels = sorted.surfels;
    cloud->radii = sorted.radii;
    cloud->colors = sorted.colors;
    cloud->opacities = sorted.opacities;
    cloud->spans = sorted.spans;
    cloud->bounds = sorted.bounds;
    cloud->span_count = sorted.span_count;
    cloud->count = source->count;
    cloud->radius = radius;
    return ISO_OK;
}

static iso_status make_cloud(maker *m, iso_error *error) {
    m->source = iso_point_source_of_glyphs(m->glyphs);
    if (m->opts->estimate_normals) m->source.normals.data = NULL;
    ISO_TRY(iso_point_source_survey(&m->source, m->opts->pool, &m->survey, error));
    ISO_TRY(take_normals(m, error));
    ISO_TRY(take_radii(m, error));
    if (m->cloud->estimated_normals || m->cloud->estimated_radii) ISO_TRY(estimate(m, error));
    ISO_TRY(finish_radii(m, error));
    if (m->normals) m->source.normals = iso_point_column_of(m->normals, sizeof *m->normals);
    m->source.radii = iso_point_column_of(m->radii, sizeof *m->radii);
    m->cloud->closed =
        m->glyphs->closed && m->glyphs->directions && !m->normals && !m->opts->estimate_normals;
    return fill_cloud(&m->source, &m->survey, m->cloud->radius, m->opts->pool, m->cloud, error);
}

iso_status iso_cloud_make(const iso_glyphs *glyphs, const iso_cloud_opts *opts, iso_cloud *cloud,
                          iso_error *error) {
    iso_cloud made = {0};
    maker m = {.glyphs = glyphs, .opts = opts, .cloud = &made};
    if (!glyphs->count) return iso_fail(error, ISO_ERR_EMPTY, "there are no points");
    const iso_status status = make_cloud(&m, error);
    iso_free(m.normals);
    iso_free(m.radii);
    iso_free(m.has_radius);
    if (status == ISO_OK)
        *cloud = made;
    else
        iso_cloud_free(&made);
    return status;
}

iso_status iso_cloud_make_of_source(const iso_point_source *source, const iso_point_survey *survey,
                                    double radius, iso_pool *pool, iso_cloud *cloud, iso_error *error) {
    iso_cloud made = {0};
    const iso_status status = fill_cloud(source, survey, (double)(float)radius, pool, &made, error);
    if (status == ISO_OK)
        *cloud = made;
    else
        iso_cloud_free(&made);
    return status;
}

iso_status iso_cloud_spacing(const iso_glyphs *glyphs, iso_pool *pool, double *spacing, iso_error *error) {
    enum { SAMPLES = 4096 };
    const size_t step = glyphs->count / SAMPLES + 1;
    float distances[SAMPLES];
    size_t count = 0;
    iso_tree tree = {0};
    ISO_TRY(iso_tree_make((const float(*)[3])glyphs->positions, glyphs->count, pool, &tree, error));
    for (size_t slot = 0; slot < tree.count && count < SAMPLES; slot += step) {
        iso_neighbour nearest;
        if (iso_tree_nearest(&tree, slot, 1, &nearest)) distances[count++] = sqrtf(nearest.square);
    }
    iso_tree_free(&tree);
    *spacing = count ? (double)select_nth(distances, count, count / 2) : 0;
    return ISO_OK;
}

void iso_cloud_free(iso_cloud *cloud) {
    iso_free(cloud->surfels);
    iso_free(cloud->radii);
    iso_free(cloud->colors);
    iso_free(cloud->opacities);
    iso_free(cloud->spans);
    iso_free(cloud->bounds);
    *cloud = (iso_cloud){0};
}

iso_point_view iso_cloud_view(const iso_cloud *cloud) {
    return (iso_point_view){.surfels = cloud->surfels,
                            .radii = cloud->radii,
                            .colors = (const uint8_t(*)[3])cloud->colors,
                            .opacities = cloud->opacities,
                            .spans = cloud->spans,
                            .bounds = cloud->bounds,
                            .span_count = cloud->span_count,
                            .transform = cloud->transform,
                            .radius = cloud->radius,
                            .closed = cloud->closed,
                            .overlapping = true};
}
