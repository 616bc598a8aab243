/* instances: sorts instances by the least depth of their boxes, tests each box against the depth pyramid of
 * what has been drawn, and brings the pyramid up to date where an instance was drawn. */
#include "render/selection/instances.h"

#include <math.h>
#include <stdlib.h>

#include "render/discs/discs_numbers.h"

/* Discs reach at most this many radii of their points beyond the points (ISO_DISCS_BALL + _MORE, 1.415),
 * and depths are rounded. */
static const double DISC_REACH = 1.45;

/* An instance of fewer points is drawn before other threads would have begun to. */
enum { LEAST_SHARED = 8192 };

/* An instance in the order of drawing. */
typedef struct placed {
    double depth; /* least depth of its box, mm */
    uint32_t number;
    iso_area area;
} placed;

static int compare_depths(const void *a, const void *b) {
    const placed *one = a, *other = b;
    if (one->depth != other->depth) return one->depth < other->depth ? -1 : 1;
    return one->number < other->number ? -1 : one->number > other->number;
}

/* How much larger an instance is than its set. */
static double scale_of(const iso_instances *all, const iso_instance *instance) {
    const iso_instanced *set = &all->sets[instance->set];
    return instance->transform.spacing[0] / set->lod->points.transform.spacing[0];
}

/* The greatest depth of a box, mm. */
static double farthest_depth(const iso_projector *projector, const iso_box *box) {
    const double *m = projector->matrix + 6;
    return projector->origin[2] + iso_max(m[0] * box->lo.x, m[0] * box->hi.x) +
           iso_max(m[1] * box->lo.y, m[1] * box->hi.y) + iso_max(m[2] * box->lo.z, m[2] * box->hi.z);
}

/* What is known of the levels of detail of a set. */
typedef struct set_levels {
    double radius[ISO_LOD_LEVELS]; /* the largest of a level's points, mm in the set's own transform */
    double error[ISO_LOD_LEVELS];  /* the least of a level's spans, voxels */
} set_levels;

static double largest_radius(const iso_point_view *points) {
    double largest = points->radii ? 0 : points->radius;
    for (size_t s = 0; points->radii && s < points->span_count; s++)
        for (size_t i = points->spans[s].first; i < points->spans[s].first + points->spans[s].count; i++)
            largest = iso_max((double)points->radii[i], largest);
    return largest;
}

static set_levels survey_levels(const iso_instanced *set) {
    const iso_lod *lod = set->lod;
    set_levels levels = {.radius = {set->reach}};
    for (int k = 1; k < lod->count; k++) {
        const iso_point_view view = iso_lod_view(lod, k);
        levels.radius[k] = largest_radius(&view);
        levels.error[k] = 1;
        for (size_t s = 0; s < lod->level[k].span_count; s++)
            levels.error[k] = iso_min(levels.error[k], (double)lod->level[k].errors[s]);
    }
    return levels;
}

/* How far the discs of an instance reach beyond its box, mm: those of coarser levels farther, but these are
 * drawn only where their errors are small enough in the picture, at the box's farthest depth if anywhere. */
static double reach_of(const iso_instances *all, const iso_instance *instance, const set_levels *levels,
                       const iso_projector *projector) {
    const iso_instanced *set = &all->sets[instance->set];
    const double *side = instance->transform.spacing, depth = farthest_depth(projector, &set->box),
                 scale = scale_of(all, instance);
    double radius = levels->radius[0], voxel = iso_max(side[0], iso_max(side[1], side[2]));
    for (int k = 1; k < set->lod->count && all->lod_pixels > 0; k++) {
        const double error = ldexp(voxel, k) * levels->error[k];
        if (!projector->view->orthographic && !(depth > 0)) break;
        if (error * iso_projector_scale(projector, depth) > 1.01 * all->lod_pixels) continue;
        radius = iso_max(radius, levels->radius[k]);
    }
    return DISC_REACH * radius * scale;
}

/* The pixels that an instance can cover, and the least depth that it can have there: hits of discs that are
 * wider by a filter can lie LOW_PASS_DEPTH pixels before their centres, and what is averaged with a front the
 * thickness of a disc before it. */
static iso_area area_of(const iso_instances *all, const iso_instance *instance, const set_levels *levels,
                        const iso_view *view) {
    const iso_projector projector = iso_projector_make(view, &instance->transform);
    const double reach = reach_of(all, instance, levels, &projector);
    iso_area area = iso_projector_area(&projector, &all->sets[instance->set].box, reach);
    const double pixel = 1 / iso_projector_scale(&projector, iso_max(area.nearest, 0));
    area.nearest -= (double)ISO_DISCS_THICKNESS * reach;
    if (all->reconstruction == ISO_RECONSTRUCTION_EWA)
        area.nearest -= 1.01 * pixel * (double)ISO_DISCS_LOW_PASS_DEPTH;
    return area;
}

/* Lists the instances that are in the picture, sorted. */
static iso_status sort_instances(iso_instance_drawing *drawing, const iso_view *view,
                                 const iso_instances *all, size_t *count, iso_error *error) {
    ISO_TRY(iso_buffer_reserve(&drawing->order, all->count * sizeof(placed), 0, error));
    ISO_TRY(iso_buffer_reserve(&drawing->levels, all->set_count * sizeof(set_levels), 0, error));
    placed *order = drawing->order.data;
    set_levels *levels = drawing->levels.data;
    *count = 0;
    for (size_t i = 0; i < all->set_count; i++) levels[i] = survey_levels(&all->sets[i]);
    for (size_t i = 0; i < all->count; i++) {
        const iso_instance *instance = &all->instances[i];
        const iso_area area = area_of(all, instance, &levels[instance->set], view);
        if (!iso_area_is_empty(&area)) order[(*count)++] = (placed){area.nearest, (uint32_t)i, area};
    }
    qsort(order, *count, sizeof *order, compare_depths);
    return ISO_OK;
}

/* Draws an instance; adds to *points how many points that were. `looks`: what is hidden is left out. */
static iso_status draw_instance(iso_instance_drawing *drawing, const iso_target *target,
                                const iso_instances *all, const placed *at, bool looks, size_t *points,
                                iso_error *error) {
    const size_t number = at->number;
    const iso_instance *instance = &all->instances[number];
    const iso_point_surface_opts opts = {.reconstruction = all->reconstruction,
                                         .workspace = drawing->workspace,
                                         .selection = all->selection,
                                         .color = all->colors ? &all->colors[number] : NULL};
    iso_lod lod = *all->sets[instance->set].lod; /* a copy, which borrows the levels */
    lod.points.transform = instance->transform;
    lod.points.radius *= scale_of(all, instance);
    lod.points.radii_scale = (float)scale_of(all, instance);
    ISO_TRY(iso_lod_cut_make(&drawing->cut, &lod, target->view, all->lod_pixels, target->pool, error));
    size_t count = 0;
    for (int k = 0; k < drawing->cut.levels; k++) count += drawing->cut.points[k];
    iso_target alone = *target;
    if (count < LEAST_SHARED) alone.pool = NULL;
    for (int k = 0; k < drawing->cut.levels; k++) {
        if (!drawing->cut.view[k].span_count) continue;
        *points += drawing->cut.points[k];
        if (!all->engine) {
            ISO_TRY(iso_draw_point_surface(&alone, &drawing->cut.view[k], &opts, error));
            continue;
        }
        const iso_instance_part part = {
            drawing->cut.view[k], instance->set, k, opts.color, at->area, looks ? &drawing->pyramid : NULL};
        ISO_TRY(all->engine->draw(all->engine->context, &part, error));
    }
    return ISO_OK;
}

/* What has been drawn since the pyramid of depths was last brought up to date. */
typedef struct recent {
    iso_area area; /* around all of it */
    size_t points;
} recent;

static void add_recent(recent *since, const iso_area *area, size_t points) {
    iso_rows *const to[] = {&since->area.columns, &since->area.rows};
    const iso_rows from[] = {area->columns, area->rows};
    for (int axis = 0; axis < 2; axis++) {
        if (!since->points || from[axis].first < to[axis]->first) to[axis]->first = from[axis].first;
        if (!since->points || from[axis].last > to[axis]->last) to[axis]->last = from[axis].last;
    }
    since->points += points;
}

/* Whether nothing in the area can be seen, by the pyramid of depths, which is brought up to date when it
 * shows too little to hide the area and enough has been drawn since. */
static iso_status find_hidden(iso_instance_drawing *drawing, const iso_gbuffer *gbuffer,
                              const iso_instance_engine *engine, const iso_area *area, recent *since,
                              bool *hidden, iso_error *error) {
    *hidden = iso_depth_pyramid_hides(&drawing->pyramid, area);
    if (*hidden || since->points <= (engine ? engine->points_between : 0)) return ISO_OK;
    if (engine) ISO_TRY(engine->read_depths(engine->context, since->area.rows, error));
    iso_depth_pyramid_update(&drawing->pyramid, gbuffer, &since->area);
    since->points = 0;
    *hidden = iso_depth_pyramid_hides(&drawing->pyramid, area);
    return ISO_OK;
}

static void note_state(const iso_instances *all, size_t number, iso_instance_state state) {
    if (all->states && all->states[number] < (uint8_t)state) all->states[number] = (uint8_t)state;
}

iso_status iso_draw_instances(iso_instance_drawing *drawing, const iso_target *target,
                              const iso_instances *all, iso_instance_counts *counts, iso_error *error) {
    const bool looks = !all->draw_hidden;
    iso_instance_counts n = {0};
    recent since = {.points = 0};
    size_t count;
    if (!drawing->workspace) ISO_TRY(iso_point_workspace_create(&drawing->workspace, error));
    ISO_TRY(sort_instances(drawing, target->view, all, &count, error));
    if (looks) ISO_TRY(iso_depth_pyramid_make(&drawing->pyramid, target->gbuffer, error));
    const placed *order = drawing->order.data;
    n.outside = all->count - count;
    for (size_t i = 0; i < count; i++) {
        const iso_area *area = &order[i].area;
        const size_t before = n.points;
        bool hidden = false;
        if (looks) ISO_TRY(find_hidden(drawing, target->gbuffer, all->engine, area, &since, &hidden, error));
        if (hidden) {
            n.hidden++;
            note_state(all, order[i].number, ISO_INSTANCE_HIDDEN);
            continue;
        }
        ISO_TRY(draw_instance(drawing, target, all, &order[i], looks, &n.points, error));
        note_state(all, order[i].number, ISO_INSTANCE_DRAWN);
        n.drawn++;
        add_recent(&since, area, n.points - before);
    }
    if (counts) *counts = n;
    return ISO_OK;
}

void iso_instance_drawing_free(iso_instance_drawing *drawing) {
    iso_point_workspace_destroy(drawing->workspace);
    iso_depth_pyramid_free(&drawing->pyramid);
    iso_lod_cut_free(&drawing->cut);
    iso_buffer_free(&drawing->order);
    iso_buffer_free(&drawing->levels);
    *drawing = (iso_instance_drawing){0};
}
