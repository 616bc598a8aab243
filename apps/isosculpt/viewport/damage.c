/* Damage rectangles: merged when few pixels are gained by keeping them apart. */
#include "apps/isosculpt/viewport/damage.h"

#include <math.h>

/* One more rectangle costs as much as drawing so many pixels. */
enum { RECTANGLE_PIXELS = 4096 };
/* Voxels around a changed voxel on which the picture depends; pixels for rounding. */
static const double REACH_VOXELS = 2, SLACK_PIXELS = 1;

static isosculpt_rectangle merge(isosculpt_rectangle a, isosculpt_rectangle b) {
    return (isosculpt_rectangle){a.x0 < b.x0 ? a.x0 : b.x0, a.y0 < b.y0 ? a.y0 : b.y0,
                                 a.x1 > b.x1 ? a.x1 : b.x1, a.y1 > b.y1 ? a.y1 : b.y1};
}

/* Pixels that are drawn in addition when two rectangles are merged; negative when they overlap. */
static double growth(isosculpt_rectangle a, isosculpt_rectangle b) {
    return (double)isosculpt_rectangle_area(merge(a, b)) - (double)isosculpt_rectangle_area(a) -
           (double)isosculpt_rectangle_area(b);
}

/* The index of the rectangle that grows least when it is merged. */
static int find_nearest(const isosculpt_damage *damage, isosculpt_rectangle rectangle) {
    int best = 0;
    for (int i = 1; i < damage->count; i++)
        if (growth(damage->rectangle[i], rectangle) < growth(damage->rectangle[best], rectangle)) best = i;
    return best;
}

void isosculpt_damage_add(isosculpt_damage *damage, isosculpt_rectangle rectangle) {
    if (rectangle.x0 >= rectangle.x1 || rectangle.y0 >= rectangle.y1) return;
    while (damage->count) {
        int other = find_nearest(damage, rectangle);
        bool full = damage->count == ISOSCULPT_RECTANGLES;
        if (!full && growth(damage->rectangle[other], rectangle) > RECTANGLE_PIXELS) break;
        rectangle = merge(rectangle, damage->rectangle[other]);
        damage->rectangle[other] = damage->rectangle[--damage->count];
    }
    damage->rectangle[damage->count++] = rectangle;
}

static int clamp_pixel(double value, int end) {
    return value <= 0 ? 0 : value >= end ? end : (int)value;
}

static void add_projected_box(isosculpt_damage *damage, const iso_view *view, const iso_box *box) {
    double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
    for (int i = 0; i < 8; i++) {
        iso_vec3 p = iso_view_point(view, iso_box_corner(box, i));
        if (!(p.z > view->near)) { /* a corner beside the eye can be projected to any pixel */
            isosculpt_damage_add(damage, (isosculpt_rectangle){0, 0, view->width, view->height});
            return;
        }
        double scale = view->orthographic ? view->focal : view->focal / p.z;
        const double at[2] = {view->cx + scale * p.x, view->cy + scale * p.y};
        for (int k = 0; k < 2; k++) {
            low[k] = fmin(low[k], at[k]);
            high[k] = fmax(high[k], at[k]);
        }
    }
    isosculpt_damage_add(damage,
                         (isosculpt_rectangle){clamp_pixel(floor(low[0] - SLACK_PIXELS), view->width),
                                               clamp_pixel(floor(low[1] - SLACK_PIXELS), view->height),
                                               clamp_pixel(ceil(high[0] + SLACK_PIXELS), view->width),
                                               clamp_pixel(ceil(high[1] + SLACK_PIXELS), view->height)});
}

/* The voxels of a change, widened by REACH_VOXELS; index coordinates. */
static iso_box reached_box(const iso_hgrid *grid, const iso_change *change) {
    const uint32_t x = (uint32_t)grid->cells[0], y = (uint32_t)grid->cells[1];
    const uint32_t at[3] = {change->cell % x, change->cell / x % y, change->cell / x / y};
    double lo[3], hi[3];
    for (int axis = 0; axis < 3; axis++) {
        lo[axis] = ISO_BRICK * (double)at[axis] + change->lo[axis] - REACH_VOXELS;
        hi[axis] = ISO_BRICK * (double)at[axis] + change->hi[axis] + REACH_VOXELS;
    }
    return (iso_box){{lo[0], lo[1], lo[2]}, {hi[0], hi[1], hi[2]}};
}

void isosculpt_damage_add_edits(isosculpt_damage *damage, const iso_view *view, const iso_hgrid *grid,
                                const iso_change_log *log, uint64_t drawn_edit) {
    const iso_affine affine = iso_transform_affine(&grid->transform);
    const iso_change *changes;
    size_t count = iso_change_log_since(log, drawn_edit, &changes);
    for (size_t i = 0; i < count; i++) {
        iso_box box = reached_box(grid, &changes[i]);
        box = iso_box_transform(&box, &affine);
        add_projected_box(damage, view, &box);
    }
}

size_t isosculpt_damage_area(const isosculpt_damage *damage) {
    size_t area = 0;
    for (int i = 0; i < damage->count; i++) area += isosculpt_rectangle_area(damage->rectangle[i]);
    return area;
}
