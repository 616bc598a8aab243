/* vector_glyphs: first counts the glyphs of each slice and finds their greatest length, then makes the glyphs
 * in parallel; their order is that of the voxels. */
#include "extract/vectors/vector_glyphs.h"

#include <math.h>

#include "base/memory.h"
#include "base/tensor.h"
#include "extract/vectors/attributes.h"

/* An ellipsoid's smallest allowed eigenvalue, as a share of the largest. */
static const double FLATTEST = 1e-6;

typedef struct slice {
    size_t first, count; /* the slice's first glyph, number of its glyphs */
    double longest;      /* length of a vector, or eigenvalue */
    size_t zero, missing, small, indefinite;
} slice;

typedef struct making {
    const iso_vectors *vectors;
    bool centred;
    double least;
    iso_affine affine;
    int every, counts[3], first[3]; /* the lattice of glyphs: spacing in voxels, number of glyphs on each
                                       axis, voxel of the first glyph */
    double scale;
    slice *slices; /* counts[2] slices */
    iso_glyphs *glyphs;
    float *numbers[2]; /* values of the attributes */
} making;

/* ---- the lattice */

static void set_lattice(making *m, int every) {
    m->every = every;
    for (int axis = 0; axis < 3; axis++) {
        const int last = m->vectors->dims[axis] - 1;
        m->counts[axis] = last / every + 1;
        m->first[axis] = last % every / 2;
    }
}

static size_t lattice_count(const making *m) {
    return (size_t)m->counts[0] * (size_t)m->counts[1] * (size_t)m->counts[2];
}

/* Chooses the lattice. If its spacing is not given, chooses the smallest with at most ISO_VECTOR_GLYPHS_USUAL
 * glyphs, estimated from the share of voxels with a vector. */
static iso_status choose_lattice(making *m, const iso_vector_glyphs_opts *opts, iso_error *error) {
    iso_vectors_totals totals;
    set_lattice(m, opts->every ? opts->every : 1);
    if (opts->every) return ISO_OK;
    ISO_TRY(iso_vectors_measure(m->vectors, opts->pool, &totals, error));
    const double share = (double)totals.usable / (double)iso_vectors_count(m->vectors);
    while ((double)lattice_count(m) * share > ISO_VECTOR_GLYPHS_USUAL) set_lattice(m, m->every + 1);
    return ISO_OK;
}

/* Returns the smallest distance between neighbouring glyphs on any axis, mm. */
static double least_distance(const making *m) {
    double least = INFINITY, of_one = INFINITY;
    for (int axis = 0; axis < 3; axis++) {
        const double *c = m->affine.m + axis;
        const double step = sqrt(c[0] * c[0] + c[3] * c[3] + c[6] * c[6]);
        of_one = fmin(of_one, step);
        if (m->counts[axis] > 1) least = fmin(least, step);
    }
    return (isfinite(least) ? least : of_one) * m->every;
}

/* ---- one glyph */

typedef enum fate { DRAWN, ZERO, MISSING, SMALL, INDEFINITE } fate;

/* Computes the eigenvectors of a tensor; returns whether it has an ellipsoid. */
static fate decompose(const float *t, iso_eigen *eigen) {
    if (isnan(t[0])) return MISSING;
    *eigen = iso_tensor_eigen(t);
    const double *l = eigen->values;
    if (l[0] == 0 && l[2] == 0) return ZERO;
    return l[2] >= FLATTEST * l[0] && l[0] > 0 ? DRAWN : INDEFINITE;
}

static fate measure_vector(const float *v, double *length) {
    if (isnan(v[0])) return MISSING;
    *length = sqrt((double)v[0] * (double)v[0] + (double)v[1] * (double)v[1] + (double)v[2] * (double)v[2]);
    return *length > 0 ? DRAWN : ZERO;
}

static void put_position(const making *m, const int voxel[3], const float *direction, float position[3]) {
    const iso_vec3 p = iso_affine_point(&m->affine, iso_vec3_make(voxel[0], voxel[1], voxel[2]));
    const iso_vec3 at = iso_vec3_sub(p, m->glyphs->origin);
    const double back = m->centred ? 0.5 : 0;
    position[0] = (float)(at.x - back * (double)direction[0]);
    position[1] = (float)(at.y - back * (double)direction[1]);
    position[2] = (float)(at.z - back * (double)direction[2]);
}

static void put_vector(const making *m, const float *v, double length, size_t glyph) {
    for (int k = 0; k < 3; k++) m->glyphs->directions[glyph][k] = (float)((double)v[k] * m->scale);
    m->numbers[0][glyph] = (float)length;
}

static void put_tensor(const making *m, const iso_eigen *eigen, size_t glyph) {
    const double *l = eigen->values;
    for (int axis = 0; axis < 3; axis++)
        for (int k = 0; k < 3; k++)
            m->glyphs->axes[glyph][3 * axis + k] = (float)(eigen->vectors[axis][k] * l[axis] * m->scale);
    for (int k = 0; k < 3; k++) m->glyphs->directions[glyph][k] = 2 * m->glyphs->axes[glyph][k];
    m->numbers[0][glyph] = (float)((l[0] + l[1] + l[2]) / 3);
    m->numbers[1][glyph] = (float)iso_eigen_anisotropy(eigen);
}

/* Makes the glyph of a voxel, or, before there is memory for glyphs, only measures it. */
static fate do_voxel(const making *m, const int voxel[3], size_t glyph, double *length) {
    const float *v = iso_vectors_at(m->vectors, voxel[0], voxel[1], voxel[2]);
    const bool tensors = m->vectors->components == ISO_TENSOR_COMPONENTS;
    iso_eigen eigen;
    const fate found = tensors ? decompose(v, &eigen) : measure_vector(v, length);
    if (found != DRAWN) return found;
    if ((tensors ? iso_eigen_anisotropy(&eigen) : *length) < m->least) return SMALL;
    if (tensors) *length = eigen.values[0];
    if (!m->glyphs->positions) return DRAWN;
    if (tensors)
        put_tensor(m, &eigen, glyph);
    else
        put_vector(m, v, *length, glyph);
    put_position(m, voxel, m->glyphs->directions[glyph], m->glyphs->positions[glyph]);
    return DRAWN;
}

static void count_fate(slice *s, fate found, double length) {
    s->zero += found == ZERO;
    s->missing += found == MISSING;
    s->small += found == SMALL;
    s->indefinite += found == INDEFINITE;
    s->count += found == DRAWN;
    if (found == DRAWN && length > s->longest) s->longest = length;
}

static void do_slice(void *context, size_t index, int worker) {
    (void)worker;
    const making *m = context;
    slice *s = &m->slices[index];
    slice now = {.first = s->first};
    int voxel[3] = {0, 0, m->first[2] + (int)index * m->every};
    for (int y = 0; y < m->counts[1]; y++)
        for (int x = 0; x < m->counts[0]; x++) {
            double length = 0;
            voxel[0] = m->first[0] + x * m->every;
            voxel[1] = m->first[1] + y * m->every;
            const fate found = do_voxel(m, voxel, now.first + now.count, &length);
            count_fate(&now, found, length);
        }
    *s = now;
}

/* ---- all glyphs */

/* Adds up the slices, and computes the number of each slice's first glyph. */
static double add_up(making *m, size_t *count, iso_vector_glyphs_totals *totals) {
    double longest = 0;
    *count = 0;
    for (int z = 0; z < m->counts[2]; z++) {
        slice *s = &m->slices[z];
        s->first = *count;
        *count += s->count;
        totals->zero += s->zero;
        totals->missing += s->missing;
        totals->small += s->small;
        totals->indefinite += s->indefinite;
        longest = fmax(longest, s->longest);
    }
    return longest;
}

static iso_status allocate(making *m, const iso_vector_glyphs_opts *opts, size_t count, iso_error *error) {
    static const char *const of_vectors[] = {"magnitude"}, *const of_tensors[] = {"mean", "anisotropy"};
    const bool tensors = m->vectors->components == ISO_TENSOR_COMPONENTS;
    iso_glyphs *g = m->glyphs;
    const uint64_t each = sizeof *g->positions + sizeof *g->directions +
                          (tensors ? sizeof *g->axes + 2 * sizeof(float) : sizeof(float)),
                   limit = iso_memory_limit(opts->max_memory);
    if (count > limit / each)
        return iso_fail(error, ISO_ERR_LIMIT, "%zu glyphs need %.0f MB, limit is %.0f MB (--max-memory)",
                        count, (double)count * (double)each / 1e6, (double)limit / 1e6);
    ISO_TRY(iso_attributes_make(tensors ? of_tensors : of_vectors, tensors ? 2 : 1, count, &g->attributes,
                                error));
    g->attribute_count = tensors ? 2 : 1;
    for (int i = 0; i < g->attribute_count; i++) m->numbers[i] = g->attributes[i].values;
    g->positions = iso_alloc(count * sizeof *g->positions);
    g->directions = iso_alloc(count * sizeof *g->directions);
    g->axes = tensors ? iso_alloc(count * sizeof *g->axes) : NULL;
    if (g->positions && g->directions && (g->axes || !tensors)) return ISO_OK;
    return iso_fail_memory(error, "glyphs");
}

static iso_status make(making *m, const iso_vector_glyphs_opts *opts, iso_vector_glyphs_totals *totals,
                       iso_error *error) {
    ISO_TRY(choose_lattice(m, opts, error));
    const size_t slices = (size_t)m->counts[2];
    totals->every = m->every;
    totals->voxels = lattice_count(m);
    m->slices = iso_alloc_zero(slices, sizeof *m->slices);
    if (!m->slices) return iso_fail_memory(error, "glyphs");
    iso_parallel_for(opts->pool, slices, do_slice, m);
    size_t count;
    const double longest = add_up(m, &count, totals),
                 part = m->vectors->components == ISO_TENSOR_COMPONENTS ? 0.5 : 1;
    m->scale = opts->scale > 0 ? opts->scale : longest > 0 ? part * least_distance(m) / longest : 1;
    totals->scale = m->scale;
    ISO_TRY(allocate(m, opts, count, error));
    m->glyphs->count = count;
    iso_parallel_for(opts->pool, slices, do_slice, m);
    return ISO_OK;
}

iso_status iso_vector_glyphs(const iso_vectors *vectors, const iso_vector_glyphs_opts *opts,
                             iso_glyphs *glyphs, iso_vector_glyphs_totals *totals, iso_error *error) {
    iso_glyphs made = {.origin = iso_origin_for(vectors->transform.origin)};
    making m = {.vectors = vectors,
                .centred = opts->centred,
                .least = opts->least,
                .affine = iso_transform_affine(&vectors->transform),
                .glyphs = &made};
    *totals = (iso_vector_glyphs_totals){0};
    const iso_status status = make(&m, opts, totals, error);
    iso_free(m.slices);
    if (status == ISO_OK)
        *glyphs = made;
    else
        iso_glyphs_free(&made);
    return status;
}
