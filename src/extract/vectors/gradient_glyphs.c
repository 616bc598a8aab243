/* gradient_glyphs: sorts the points of a surface by the block of voxels that contains them, and interpolates
 * the gradient trilinearly at one point of each block. */
#include "extract/vectors/gradient_glyphs.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/numbers.h"
#include "extract/vectors/attributes.h"

/* The number of edge points in a block of n x n x n voxels, divided by n x n, for a plane that is oblique to
 * all axes. */
static const double POINTS_OF_A_BLOCK = 1.5;
/* The share of gradients that are drawn with different lengths; longer ones are shortened. A few very sharp
 * edges, as at the border of a mask, would otherwise make all other glyphs too short to be seen. */
static const double LONG = 0.95;

/* A point of the surface, and its block. */
typedef struct pick {
    int block[3];
    float distance; /* squared distance from the middle of the block, voxels */
    float at[3];    /* index coordinates */
} pick;

typedef struct making {
    const iso_gradient_glyphs_opts *opts;
    int every;
    pick *picks;
    size_t pick_count;
    iso_glyphs *glyphs;
    float *lengths;
    size_t missing;
} making;

/* ---- one point of each block */

static int compare_picks(const void *left, const void *right) {
    const pick *a = left, *b = right;
    const int blocks = memcmp(a->block, b->block, sizeof a->block);
    if (blocks) return blocks;
    if (a->distance != b->distance) return a->distance < b->distance ? -1 : 1;
    return memcmp(a->at, b->at, sizeof a->at); /* any order will do if it is always the same */
}

static pick pick_at(iso_vec3 p, int every) {
    const double at[3] = {p.x, p.y, p.z};
    pick made = {.distance = 0};
    for (int axis = 0; axis < 3; axis++) {
        made.block[axis] = at[axis] > 0 ? (int)(at[axis] / every) : 0;
        const double offset = at[axis] - (made.block[axis] + 0.5) * every;
        made.distance += (float)(offset * offset);
        made.at[axis] = (float)at[axis];
    }
    return made;
}

/* Sorts the points of a surface and keeps the first of each block. */
static void pick_points(making *m, const iso_point_view *view) {
    size_t count = 0, kept = 0;
    for (size_t s = 0; s < view->span_count; s++) {
        const iso_point_span *span = &view->spans[s];
        for (size_t i = span->first; i < span->first + span->count; i++) {
            const iso_surfel surfel = iso_point_view_get(view, i);
            m->picks[count++] = pick_at(iso_brick_position(span->brick, surfel.position), m->every);
        }
    }
    qsort(m->picks, count, sizeof *m->picks, compare_picks);
    for (size_t i = 0; i < count; i++) {
        const bool first =
            kept == 0 || memcmp(m->picks[kept - 1].block, m->picks[i].block, sizeof m->picks[i].block) != 0;
        if (first) m->picks[kept++] = m->picks[i];
    }
    m->pick_count = kept;
}

/* ---- gradients */

/* Returns the gradient in physical units per mm, pointing out of the solid. */
static iso_vec3 outward_gradient(const iso_grid *grid, const iso_affine *affine, iso_vec3 at) {
    const iso_vec3 g = iso_grid_gradient(grid, at);
    const double *m = affine->inverse;
    const double factor = iso_grid_scale(grid) * (iso_grid_is_level_set(grid) ? 1 : -1);
    return iso_vec3_make(factor * (m[0] * g.x + m[3] * g.y + m[6] * g.z),
                         factor * (m[1] * g.x + m[4] * g.y + m[7] * g.z),
                         factor * (m[2] * g.x + m[5] * g.y + m[8] * g.z));
}

static void add_glyph(making *m, const iso_grid *grid, const iso_affine *affine, const pick *from) {
    iso_glyphs *g = m->glyphs;
    const iso_vec3 at = iso_vec3_make((double)from->at[0], (double)from->at[1], (double)from->at[2]);
    const iso_vec3 gradient = outward_gradient(grid, affine, at);
    const double length = iso_vec3_length(gradient);
    if (!(length > 0 && isfinite(length))) {
        m->missing++;
        return;
    }
    const iso_vec3 p = iso_vec3_sub(iso_affine_point(affine, at), g->origin);
    const double position[3] = {p.x, p.y, p.z}, direction[3] = {gradient.x, gradient.y, gradient.z};
    for (int k = 0; k < 3; k++) {
        g->positions[g->count][k] = (float)position[k];
        g->directions[g->count][k] = (float)direction[k];
    }
    m->lengths[g->count++] = (float)length;
}

/* Makes room for `more` glyphs. */
static iso_status grow(making *m, size_t more, iso_error *error) {
    static const char *const names[] = {"gradient"};
    iso_glyphs *g = m->glyphs, old = *g;
    iso_glyphs grown = {.origin = old.origin, .count = old.count, .attribute_count = 1};
    ISO_TRY(iso_attributes_make(names, 1, old.count + more, &grown.attributes, error));
    grown.positions = iso_alloc((old.count + more) * sizeof *grown.positions);
    grown.directions = iso_alloc((old.count + more) * sizeof *grown.directions);
    if (!grown.positions || !grown.directions) {
        iso_glyphs_free(&grown);
        return iso_fail_memory(error, "glyphs");
    }
    if (old.count) {
        memcpy(grown.positions, old.positions, old.count * sizeof *old.positions);
        memcpy(grown.directions, old.directions, old.count * sizeof *old.directions);
        memcpy(grown.attributes[0].values, old.attributes[0].values, old.count * sizeof(float));
    }
    iso_glyphs_free(&old);
    *g = grown;
    m->lengths = g->attributes[0].values;
    return ISO_OK;
}

static iso_status add_surface(making *m, const iso_gradient_source *source, iso_error *error) {
    const size_t points = iso_point_view_count(&source->points);
    const uint64_t bytes = (uint64_t)points * sizeof *m->picks, limit = iso_memory_limit(m->opts->max_memory);
    if (bytes > limit)
        return iso_fail(error, ISO_ERR_LIMIT,
                        "sorting %zu points needs %.0f MB, limit is %.0f MB (--max-memory)", points,
                        (double)bytes / 1e6, (double)limit / 1e6);
    m->picks = iso_alloc(bytes);
    if (!m->picks) return iso_fail_memory(error, "points");
    pick_points(m, &source->points);
    const iso_affine affine = iso_transform_affine(iso_grid_transform(source->grid));
    const iso_status status = grow(m, m->pick_count, error);
    for (size_t i = 0; status == ISO_OK && i < m->pick_count; i++)
        add_glyph(m, source->grid, &affine, &m->picks[i]);
    iso_free(m->picks);
    return status;
}

/* ---- sizes */

static int usual_every(size_t points) {
    return 1 + (int)sqrt((double)points / (POINTS_OF_A_BLOCK * ISO_GRADIENT_GLYPHS_USUAL));
}

static double smallest_spacing(const iso_transform *transform) {
    return fmin(transform->spacing[0], fmin(transform->spacing[1], transform->spacing[2]));
}

/* Finds the length that LONG of the gradients do not exceed; 0: there are no gradients. */
static iso_status find_long(const making *m, double *length, iso_error *error) {
    const size_t count = m->glyphs->count;
    *length = 0;
    if (!count) return ISO_OK;
    double *sorted = iso_alloc(count * sizeof *sorted);
    if (!sorted) return iso_fail_memory(error, "glyphs");
    for (size_t i = 0; i < count; i++) sorted[i] = (double)m->lengths[i];
    qsort(sorted, count, sizeof *sorted, iso_compare_doubles);
    *length = sorted[(size_t)(LONG * (double)(count - 1))];
    iso_free(sorted);
    return ISO_OK;
}

/* Scales the directions to mm, and shortens those that would be longer than `most`. */
static void scale_glyphs(const making *m, double scale, double most) {
    for (size_t i = 0; i < m->glyphs->count; i++) {
        const double length = (double)m->lengths[i] * scale, factor = length > most ? most / length : 1;
        for (int k = 0; k < 3; k++)
            m->glyphs->directions[i][k] = (float)((double)m->glyphs->directions[i][k] * scale * factor);
    }
}

/* Chooses the scale if the options do not give one. */
static iso_status choose_scale(const making *m, double size, double *scale, iso_error *error) {
    double length;
    *scale = m->opts->scale;
    if (*scale > 0) {
        scale_glyphs(m, *scale, INFINITY);
        return ISO_OK;
    }
    ISO_TRY(find_long(m, &length, error));
    *scale = length > 0 ? size / length : 1;
    scale_glyphs(m, *scale, size);
    return ISO_OK;
}

iso_status iso_gradient_glyphs(const iso_gradient_source *sources, int count,
                               const iso_gradient_glyphs_opts *opts, iso_glyphs *glyphs,
                               iso_gradient_glyphs_totals *totals, iso_error *error) {
    const iso_transform *transform = iso_grid_transform(sources[0].grid);
    iso_glyphs made = {.origin = iso_origin_for(transform->origin)};
    making m = {.opts = opts, .glyphs = &made};
    *totals = (iso_gradient_glyphs_totals){0};
    for (int i = 0; i < count; i++) totals->points += iso_point_view_count(&sources[i].points);
    m.every = opts->every ? opts->every : usual_every(totals->points);
    iso_status status = ISO_OK;
    for (int i = 0; i < count && status == ISO_OK; i++) status = add_surface(&m, &sources[i], error);
    if (status == ISO_OK)
        status = choose_scale(&m, m.every * smallest_spacing(transform), &totals->scale, error);
    totals->every = m.every;
    totals->missing = m.missing;
    if (status == ISO_OK)
        *glyphs = made;
    else
        iso_glyphs_free(&made);
    return status;
}
