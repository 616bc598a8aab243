/* radii: distances to the sixth neighbour, smoothed by their median. */
#include "clouds/radii.h"

#include <math.h>

#include "base/memory.h"

enum { CHUNK = 4096, SIXTH = 5 };

typedef struct radius_job {
    const iso_tree *tree;
    const iso_neighbour_row *neighbours;
    float *distances, *radii;
} radius_job;

static size_t chunk_end(const radius_job *job, size_t chunk) {
    const size_t end = (chunk + 1) * CHUNK;
    return end < job->tree->count ? end : job->tree->count;
}

static void measure_chunk(void *context, size_t chunk, int worker) {
    (void)worker;
    const radius_job *job = context;
    for (size_t slot = chunk * CHUNK; slot < chunk_end(job, chunk); slot++) {
        const float *a = job->tree->points[slot].position,
                    *b = job->tree->points[job->neighbours[slot][SIXTH]].position;
        float square = 0;
        for (int axis = 0; axis < 3; axis++) square += (a[axis] - b[axis]) * (a[axis] - b[axis]);
        job->distances[slot] = sqrtf(square);
    }
}

static void smooth_chunk(void *context, size_t chunk, int worker) {
    (void)worker;
    const radius_job *job = context;
    for (size_t slot = chunk * CHUNK; slot < chunk_end(job, chunk); slot++) {
        float sorted[ISO_CLOUD_NEIGHBOURS + 1];
        for (int count = 0; count <= ISO_CLOUD_NEIGHBOURS; count++) {
            const size_t from = count ? job->neighbours[slot][count - 1] : slot;
            int i = count;
            for (; i > 0 && sorted[i - 1] > job->distances[from]; i--) sorted[i] = sorted[i - 1];
            sorted[i] = job->distances[from];
        }
        job->radii[slot] = ISO_CLOUD_RADIUS * sorted[ISO_CLOUD_NEIGHBOURS / 2];
    }
}

iso_status iso_radii_estimate(const iso_tree *tree, const iso_neighbour_row *neighbours, float *radii,
                              iso_pool *pool, iso_error *error) {
    radius_job job = {tree, neighbours, iso_alloc(tree->count * sizeof *job.distances), radii};
    if (!job.distances) return iso_fail(error, ISO_ERR_NOMEM, "out of memory for %zu radii", tree->count);
    const size_t chunks = (tree->count + CHUNK - 1) / CHUNK;
    iso_parallel_for(pool, chunks, measure_chunk, &job);
    iso_parallel_for(pool, chunks, smooth_chunk, &job);
    iso_free(job.distances);
    return ISO_OK;
}
