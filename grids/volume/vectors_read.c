/* vectors_read: reads the components of a volume one after the other with the reader of its format, and
 * rotates them to the axes of the world. A compressed file is decompressed once for each component. This
 * takes longer than reading all components together, but the eight readers need no code for it. */
#include "grids/volume/vectors_read.h"

#include <math.h>
#include <string.h>

#include "base/memory.h"

/* The place of the mask, which is not a component of the result. */
enum { MASK = -1 };

typedef struct job {
    const char *path;
    const iso_vectors_opts *opts;
    iso_volume_opts volume_opts;
    iso_component_axes axes; /* of the header */
    double to_world[9];
    uint64_t limit;
    iso_vectors *vectors;
    iso_vectors_info *info;
    /* the component that is being read */
    const iso_rgrid *grid;
    int place;           /* place of the component among the values of a voxel, or MASK */
    bool is_second;      /* the place already has the value of the transposed entry */
    double *differences; /* for each slice: the greatest difference between transposed entries */
} job;

/* ---- what the components are */

/* The places of the six components of a symmetric tensor, by their order in the file. */
static const int upper[6] = {0, 1, 2, 3, 4, 5}, lower[6] = {0, 1, 3, 2, 4, 5}, vtk[6] = {0, 3, 5, 1, 4, 2};
static const int matrix[9] = {0, 1, 2, 1, 3, 4, 2, 4, 5};

static int place_in_order(const job *j, int component) {
    const char *format = j->info->volume.format;
    if (j->opts->order[0]) {
        int place = 0;
        while (j->opts->order[place] != component + 1) place++;
        return place;
    }
    if (strcmp(format, "vti") == 0 || strcmp(format, "vtk") == 0) return vtk[component];
    return (j->axes.lower ? lower : upper)[component];
}

static int place_of(const job *j, int component) {
    const int components = j->info->volume.components;
    if (components == 3) return component;
    if (components == 6) return place_in_order(j, component);
    if (components == 7) return component == 0 ? MASK : component - 1;
    return matrix[component];
}

static bool is_below_diagonal(const job *j, int component) {
    return j->info->volume.components == 9 && component / 3 > component % 3;
}

static iso_status check_components(job *j, iso_error *error) {
    const int components = j->info->volume.components;
    const bool usable = components == 3 || components == 6 || components == 7 || components == 9;
    j->vectors->components = components == 3 ? ISO_VECTOR_COMPONENTS : ISO_TENSOR_COMPONENTS;
    if (usable) return ISO_OK;
    return iso_fail(error, ISO_ERR_EMPTY,
                    "%s: %d component%s at a voxel; vectors have 3, symmetric tensors 6 (7 with a mask) or 9",
                    j->path, components, components == 1 ? "" : "s");
}

/* ---- axes */

static void set_diagonal(double m[9], double x, double y, double z) {
    memset(m, 0, 9 * sizeof *m);
    m[0] = x, m[4] = y, m[8] = z;
}

/* Computes the axes of the voxels. For FSL the first axis is reversed if the axes are right-handed. (RAS and
 * LPS have the same handedness.) */
static void set_voxel_axes(const iso_transform *transform, bool fsl, double m[9]) {
    const double *d = transform->direction;
    const double determinant = d[0] * (d[4] * d[8] - d[5] * d[7]) - d[1] * (d[3] * d[8] - d[5] * d[6]) +
                               d[2] * (d[3] * d[7] - d[4] * d[6]);
    memcpy(m, d, 9 * sizeof *m);
    for (int row = 0; row < 3; row++)
        if (fsl && determinant > 0) m[3 * row] = -m[3 * row];
}

/* Converts positions from RAS to LPS. */
static void turn_positions(iso_transform *transform) {
    for (int row = 0; row < 2; row++) {
        transform->origin[row] = -transform->origin[row];
        for (int axis = 0; axis < 3; axis++)
            transform->direction[3 * row + axis] = -transform->direction[3 * row + axis];
    }
}

static void choose_axes(job *j) {
    iso_transform *transform = &j->vectors->transform;
    double *m = j->to_world;
    const iso_vector_axes axes = j->opts->axes;
    memcpy(m, j->axes.to_world, sizeof j->to_world);
    *transform = j->info->volume.transform;
    if (axes == ISO_VECTOR_AXES_RAS && !j->info->volume.anatomical) turn_positions(transform);
    if (axes == ISO_VECTOR_AXES_LPS) set_diagonal(m, 1, 1, 1);
    if (axes == ISO_VECTOR_AXES_RAS) set_diagonal(m, -1, -1, 1);
    if (axes == ISO_VECTOR_AXES_VOXELS || axes == ISO_VECTOR_AXES_FSL)
        set_voxel_axes(transform, axes == ISO_VECTOR_AXES_FSL, m);
    double ras[9];
    set_diagonal(ras, -1, -1, 1);
    j->info->ras = memcmp(m, ras, sizeof ras) == 0;
    j->info->axes_stated = axes == ISO_VECTOR_AXES_FILE && j->axes.stated;
}

/* ---- components */

static float physical(const iso_rgrid *grid, int x, int y, int z) {
    return (float)((double)iso_rgrid_at(grid, x, y, z) * grid->scale + grid->offset);
}

static void put(const job *j, float *voxel, float value, double *difference) {
    if (j->place == MASK) {
        if (!(value >= 0.5f)) voxel[0] = NAN;
        return;
    }
    float *to = voxel + j->place;
    if (!j->is_second) {
        *to = value;
        return;
    }
    *difference = fmax(*difference, fabs((double)*to - (double)value));
    *to = (float)(((double)*to + (double)value) / 2);
}

static void take_slice(void *context, size_t index, int worker) {
    (void)worker;
    const job *j = context;
    const int z = (int)index, *dims = j->vectors->dims;
    double difference = 0;
    for (int y = 0; y < dims[1]; y++) {
        float *voxel = (float *)iso_vectors_at(j->vectors, 0, y, z);
        for (int x = 0; x < dims[0]; x++, voxel += j->vectors->components)
            put(j, voxel, physical(j->grid, x, y, z), &difference);
    }
    j->differences[index] = difference;
}

static iso_status read_component(job *j, int component, iso_error *error) {
    iso_volume volume = {0};
    j->volume_opts.component = component;
    ISO_TRY(iso_volume_read(j->path, &j->volume_opts, &volume, error));
    iso_status status = ISO_OK;
    if (!volume.grid.rgrid || memcmp(volume.info.dims, j->vectors->dims, sizeof volume.info.dims) != 0)
        status = iso_fail(error, ISO_ERR_IO, "%s: changed while it was read", j->path);
    j->grid = volume.grid.rgrid;
    j->place = place_of(j, component);
    j->is_second = is_below_diagonal(j, component);
    if (status == ISO_OK) iso_parallel_for(j->opts->pool, (size_t)j->vectors->dims[2], take_slice, j);
    for (int z = 0; status == ISO_OK && z < j->vectors->dims[2]; z++)
        j->info->asymmetry = fmax(j->info->asymmetry, j->differences[z]);
    iso_volume_free(&volume);
    return status;
}

/* Reads all components. The mask is read last, and marks the voxels that have values. */
static iso_status read_components(job *j, iso_error *error) {
    const int components = j->info->volume.components;
    for (int i = 0; i < components; i++) ISO_TRY(read_component(j, components == 7 ? (i + 1) % 7 : i, error));
    return ISO_OK;
}

/* ---- to the world */

static void turn_vector(const double m[9], float v[3]) {
    const double x = (double)v[0], y = (double)v[1], z = (double)v[2];
    for (int row = 0; row < 3; row++)
        v[row] = (float)(m[3 * row] * x + m[3 * row + 1] * y + m[3 * row + 2] * z);
}

/* Computes m t m^T. */
static void turn_tensor(const double m[9], float t[6]) {
    const double full[9] = {(double)t[0], (double)t[1], (double)t[2], (double)t[1], (double)t[3],
                            (double)t[4], (double)t[2], (double)t[4], (double)t[5]};
    double half[9];
    for (int row = 0; row < 3; row++)
        for (int column = 0; column < 3; column++)
            half[3 * row + column] = m[3 * row] * full[column] + m[3 * row + 1] * full[3 + column] +
                                     m[3 * row + 2] * full[6 + column];
    for (int i = 0; i < 9; i++) {
        const double *a = half + 3 * (i / 3), *b = m + 3 * (i % 3);
        if (i / 3 <= i % 3) t[matrix[i]] = (float)(a[0] * b[0] + a[1] * b[1] + a[2] * b[2]);
    }
}

static void turn_slice(void *context, size_t index, int worker) {
    (void)worker;
    const job *j = context;
    const int components = j->vectors->components, *dims = j->vectors->dims;
    float *voxel = (float *)iso_vectors_at(j->vectors, 0, 0, (int)index);
    for (int i = 0; i < dims[0] * dims[1]; i++, voxel += components) {
        (components == ISO_VECTOR_COMPONENTS ? turn_vector : turn_tensor)(j->to_world, voxel);
        bool usable = true;
        for (int k = 0; k < components; k++) usable = usable && isfinite(voxel[k]);
        for (int k = 0; k < components && !usable; k++) voxel[k] = NAN;
    }
}

/* ---- the whole volume */

static iso_status check_memory(const job *j, uint64_t bytes, iso_error *error) {
    const iso_volume_info *info = &j->info->volume;
    uint64_t all;
    if (__builtin_add_overflow(bytes, info->read_bytes, &all)) all = UINT64_MAX;
    if (all <= j->limit) return ISO_OK;
    return iso_fail(
        error, ISO_ERR_LIMIT,
        "%s: %d x %d x %d voxels of %d numbers need %.0f MB to read, limit is %.0f MB (--max-memory)",
        j->path, info->dims[0], info->dims[1], info->dims[2], info->components, (double)all / 1e6,
        (double)j->limit / 1e6);
}

static iso_status read_all(job *j, iso_error *error) {
    ISO_TRY(iso_volume_read_info(j->path, &j->volume_opts, &j->info->volume, error));
    ISO_TRY(check_components(j, error));
    choose_axes(j);
    memcpy(j->vectors->dims, j->info->volume.dims, sizeof j->vectors->dims);
    uint64_t bytes = (uint64_t)j->vectors->components * sizeof(float);
    for (int axis = 0; axis < 3; axis++)
        if (__builtin_mul_overflow(bytes, (uint64_t)j->vectors->dims[axis], &bytes)) bytes = UINT64_MAX;
    ISO_TRY(check_memory(j, bytes, error));
    j->vectors->values = iso_alloc(bytes);
    j->differences = iso_alloc((size_t)j->vectors->dims[2] * sizeof *j->differences);
    if (!j->vectors->values || !j->differences) return iso_fail_memory(error, j->path);
    j->volume_opts.max_memory = j->limit - bytes;
    ISO_TRY(read_components(j, error));
    iso_parallel_for(j->opts->pool, (size_t)j->vectors->dims[2], turn_slice, j);
    return ISO_OK;
}

iso_status iso_vectors_read(const char *path, const iso_vectors_opts *opts, iso_vectors *vectors,
                            iso_vectors_info *info, iso_error *error) {
    const iso_vectors_opts defaults = {0};
    iso_vectors made = {0};
    *info = (iso_vectors_info){0};
    job j = {.path = path, .opts = opts ? opts : &defaults, .vectors = &made, .info = info};
    j.limit = iso_memory_limit(j.opts->max_memory);
    j.volume_opts = (iso_volume_opts){.grid = j.opts->array,
                                      .component_axes = &j.axes,
                                      .max_memory = j.opts->max_memory,
                                      .files = j.opts->files,
                                      .pool = j.opts->pool};
    const iso_status status = read_all(&j, error);
    iso_free(j.differences);
    if (status == ISO_OK)
        *vectors = made;
    else
        iso_vectors_free(&made);
    return status;
}
