/* point_source: surveys points: bounds and missing normals. */
#include "clouds/point_source.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "base/memory.h"

/* Points that one task surveys. */
enum { TASK = 1 << 17 };

iso_point_source iso_point_source_of_glyphs(const iso_glyphs *glyphs) {
    return (iso_point_source){.count = glyphs->count,
                              .origin = glyphs->origin,
                              .positions = iso_point_column_of(glyphs->positions, sizeof *glyphs->positions),
                              .normals = iso_point_column_of(glyphs->directions, sizeof *glyphs->directions),
                              .colors = iso_point_column_of(glyphs->colors, sizeof *glyphs->colors),
                              .opacities = iso_point_column_of(glyphs->opacities, sizeof *glyphs->opacities)};
}

bool iso_point_normal(const float from[3], float normal[3]) {
    double largest = 0;
    for (int axis = 0; axis < 3; axis++) {
        const double n = (double)from[axis];
        largest = isfinite(n) ? fmax(largest, fabs(n)) : INFINITY;
        normal[axis] = from[axis];
    }
    if (!(largest > 0 && largest < INFINITY)) {
        memset(normal, 0, 3 * sizeof *normal);
        return false;
    }
    if (iso_point_normal_is_unit(from)) return true;
    /* The vector is scaled first, because the squares of tiny components would underflow. */
    const iso_vec3 unit = iso_vec3_unit(
        iso_vec3_make((double)from[0] / largest, (double)from[1] / largest, (double)from[2] / largest));
    normal[0] = (float)unit.x;
    normal[1] = (float)unit.y;
    normal[2] = (float)unit.z;
    return true;
}

/* ---- the survey */

typedef struct surveyor {
    const iso_point_source *source;
    iso_point_survey *parts; /* one for each task */
} surveyor;

static const iso_point_survey nothing = {
    .lo = {FLT_MAX, FLT_MAX, FLT_MAX}, .hi = {-FLT_MAX, -FLT_MAX, -FLT_MAX}, .finite = true};

static void survey_task(void *context, size_t task, int worker) {
    (void)worker;
    const surveyor *s = context;
    const iso_point_source *source = s->source;
    const size_t first = task * TASK, left = source->count - first, end = first + (left < TASK ? left : TASK);
    iso_point_survey part = nothing;
    float zero[3] = {0};
    for (size_t i = first; i < end; i++) {
        float p[3], normal[3] = {0};
        iso_point_column_prefetch(&source->positions, i);
        iso_point_column_get(&source->positions, i, p);
        for (int axis = 0; axis < 3; axis++) {
            part.lo[axis] = p[axis] < part.lo[axis] ? p[axis] : part.lo[axis];
            part.hi[axis] = p[axis] > part.hi[axis] ? p[axis] : part.hi[axis];
            zero[axis] += p[axis] - p[axis]; /* NaN of infinities and NaN */
        }
        part.zeros += p[0] == 0 && p[1] == 0 && p[2] == 0;
        if (source->normals.data) iso_point_column_get(&source->normals, i, normal);
        part.without_normals += !iso_point_normal_is_unit(normal) && !iso_point_normal(normal, normal);
    }
    for (int axis = 0; axis < 3; axis++) part.finite &= zero[axis] == 0;
    s->parts[task] = part;
}

iso_status iso_point_source_survey(const iso_point_source *source, iso_pool *pool, iso_point_survey *survey,
                                   iso_error *error) {
    const size_t tasks = (source->count + TASK - 1) / TASK;
    surveyor s = {source, iso_alloc(tasks * sizeof *s.parts)};
    if (!s.parts) return iso_fail(error, ISO_ERR_NOMEM, "out of memory for the bounds of points");
    iso_parallel_for(pool, tasks, survey_task, &s);
    *survey = nothing;
    for (size_t task = 0; task < tasks; task++) {
        const iso_point_survey *part = &s.parts[task];
        for (int axis = 0; axis < 3; axis++) {
            survey->lo[axis] = fminf(survey->lo[axis], part->lo[axis]);
            survey->hi[axis] = fmaxf(survey->hi[axis], part->hi[axis]);
        }
        survey->finite &= part->finite;
        survey->without_normals += part->without_normals;
        survey->zeros += part->zeros;
    }
    iso_free(s.parts);
    return ISO_OK;
}
