/* point_source: reads blocks, and surveys all points: bounds and missing normals. */
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
                              .arrays = {.positions = (const float(*)[3])glyphs->positions,
                                         .normals = (const float(*)[3])glyphs->directions,
                                         .colors = (const uint8_t(*)[3])glyphs->colors,
                                         .opacities = glyphs->opacities}};
}

iso_point_arrays iso_point_source_read(const iso_point_source *source, size_t first, size_t count,
                                       iso_point_block *block) {
    const iso_point_arrays *all = &source->arrays;
    if (source->read) {
        source->read(source->context, first, count, block);
        return (iso_point_arrays){.positions = (const float(*)[3])block->positions,
                                  .normals = all->normals ? (const float(*)[3])block->normals : NULL,
                                  .colors = all->colors ? (const uint8_t(*)[3])block->colors : NULL};
    }
    return (iso_point_arrays){.positions = all->positions + first,
                              .normals = all->normals ? all->normals + first : NULL,
                              .radii = all->radii ? all->radii + first : NULL,
                              .colors = all->colors ? all->colors + first : NULL,
                              .opacities = all->opacities ? all->opacities + first : NULL};
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

/* Widens the bounds of part of the points. Four points at a time: as many coordinates as fill whole vectors,
 * in which each place always holds the same axis. */
static void survey_positions(const float (*positions)[3], size_t count, iso_point_survey *part) {
    enum { PLACES = 12 };
    const float *at = positions[0], *end = at + 3 * count;
    float lo[PLACES], hi[PLACES], zero[PLACES] = {0};
    for (int k = 0; k < PLACES; k++) lo[k] = hi[k] = at[k % 3];
    for (; end - at >= PLACES; at += PLACES)
        for (int k = 0; k < PLACES; k++) {
            lo[k] = at[k] < lo[k] ? at[k] : lo[k];
            hi[k] = at[k] > hi[k] ? at[k] : hi[k];
            zero[k] += at[k] - at[k]; /* NaN of infinities and NaN */
        }
    for (int k = 0; at < end; at++, k++) {
        lo[k] = *at < lo[k] ? *at : lo[k];
        hi[k] = *at > hi[k] ? *at : hi[k];
        zero[k] += *at - *at;
    }
    for (int k = 0; k < PLACES; k++) {
        part->lo[k % 3] = lo[k] < part->lo[k % 3] ? lo[k] : part->lo[k % 3];
        part->hi[k % 3] = hi[k] > part->hi[k % 3] ? hi[k] : part->hi[k % 3];
        part->finite &= zero[k] == 0;
    }
}

static size_t count_without(const float (*normals)[3], size_t count) {
    float unused[3];
    size_t units = 0, without = 0;
    for (size_t i = 0; i < count; i++) units += iso_point_normal_is_unit(normals[i]);
    for (size_t i = 0; i < count && units < count; i++) without += !iso_point_normal(normals[i], unused);
    return without;
}

static const iso_point_survey nothing = {
    .lo = {FLT_MAX, FLT_MAX, FLT_MAX}, .hi = {-FLT_MAX, -FLT_MAX, -FLT_MAX}, .finite = true};

static void survey_task(void *context, size_t task, int worker) {
    (void)worker;
    const surveyor *s = context;
    const size_t first = task * TASK, left = s->source->count - first, count = left < TASK ? left : TASK;
    iso_point_survey part = nothing;
    iso_point_block block;
    for (size_t done = 0; done < count; done += ISO_POINT_BLOCK) {
        const size_t some = count - done < ISO_POINT_BLOCK ? count - done : ISO_POINT_BLOCK;
        const iso_point_arrays points = iso_point_source_read(s->source, first + done, some, &block);
        survey_positions(points.positions, some, &part);
        part.without_normals += points.normals ? count_without(points.normals, some) : some;
    }
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
    }
    iso_free(s.parts);
    return ISO_OK;
}
