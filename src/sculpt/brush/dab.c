/* dab: which tools change what, and how far dabs reach. */
#include "sculpt/brush/dab.h"

#include <math.h>

#include "base/kernel_units.h"

const iso_dab_kernel *iso_dab_kernel_get(iso_cpu_level level) {
    return ISO_KERNEL_UNIT(iso_dab_kernel, level);
}

bool iso_tool_is_set_operation(iso_tool tool) {
    return tool <= ISO_TOOL_BLEND_CARVE;
}

bool iso_tool_is_whole_mask(iso_tool tool) {
    return tool >= ISO_TOOL_CLEAR_MASK && tool <= ISO_TOOL_MASK_VOXELS;
}

bool iso_tool_is_warp(iso_tool tool) {
    return tool >= ISO_TOOL_PINCH && tool <= ISO_TOOL_MOVE;
}

bool iso_tool_is_drag(iso_tool tool) {
    return tool == ISO_TOOL_SNAKE_HOOK || tool == ISO_TOOL_MOVE;
}

bool iso_tool_is_trim(iso_tool tool) {
    return tool >= ISO_TOOL_TRIM_PLANE;
}

bool iso_tool_has_alpha(iso_tool tool) {
    return tool >= ISO_TOOL_SMOOTH && tool <= ISO_TOOL_CLAY;
}

bool iso_tool_has_area_plane(iso_tool tool) {
    return tool >= ISO_TOOL_SCRAPE && tool <= ISO_TOOL_CLAY;
}

/* Returns the radius, in brush radii, of the ball around the centre (of a capsule: around each point of its
 * segment) that contains the solid. */
static double solid_radius(const iso_dabs *dabs) {
    const double aspect = (double)dabs->aspect;
    switch (dabs->solid) {
    case ISO_SOLID_BOX:
        return sqrt(1 + 2 * aspect * aspect);
    case ISO_SOLID_CYLINDER:
        return sqrt(1 + aspect * aspect);
    case ISO_SOLID_TORUS:
        return 1 + aspect;
    case ISO_SOLID_STAMP:
        return sqrt(3);
    default:
        return 1;
    }
}

double iso_dabs_influence(const iso_dabs *dabs) {
    if (!iso_tool_is_set_operation(dabs->tool)) return (double)dabs->radius_voxels;
    return solid_radius(dabs) * (double)dabs->radius_voxels + (double)dabs->band + (double)dabs->blend_voxels;
}

int iso_dabs_steps(const iso_dabs *dabs) {
    float s[3];
    for (int k = 0; k < 3; k++) s[k] = (float)(dabs->dab[0].from[k] - dabs->dab[0].centre[k]);
    const float steps = ceilf(8 * sqrtf(s[0] * s[0] + s[1] * s[1] + s[2] * s[2]) / dabs->radius_voxels);
    return steps < 1 ? 1 : steps > 256 ? 256 : (int)steps;
}

static bool has_segment(const iso_dabs *dabs) {
    return iso_tool_is_drag(dabs->tool) || dabs->solid == ISO_SOLID_CAPSULE;
}

double iso_dab_brick_distance(const iso_dabs *dabs, const iso_dab *dab, const int brick[3]) {
    const bool segment = has_segment(dabs);
    double centre[3], half = 0.5 * (ISO_BRICK - 1), t = 0, along = 0, square = 0;
    for (int axis = 0; axis < 3; axis++) {
        double d = segment ? dab->from[axis] - dab->centre[axis] : 0;
        centre[axis] = ISO_BRICK * (double)brick[axis] + half;
        along += (centre[axis] - dab->centre[axis]) * d;
        square += d * d;
    }
    if (square > 0) t = fmin(fmax(along / square, 0), 1);
    if (segment) { /* the distance to the ball around the brick */
        double distance = 0;
        for (int axis = 0; axis < 3; axis++) {
            double d = centre[axis] - dab->centre[axis] - t * (dab->from[axis] - dab->centre[axis]);
            distance += d * d;
        }
        return sqrt(distance) - half * sqrt(3);
    }
    double distance = 0;
    for (int axis = 0; axis < 3; axis++) {
        double d = fmax(fabs(centre[axis] - dab->centre[axis]) - half, 0);
        distance += d * d;
    }
    return sqrt(distance);
}

/* Returns how far, in voxels, one dab of a drag can carry a voxel; 0 for all other tools. */
static double carried(const iso_dabs *dabs) {
    double most = 0;
    for (int i = 0; i < dabs->count && iso_tool_is_drag(dabs->tool); i++) {
        double square = 0;
        for (int k = 0; k < 3; k++) {
            const double d = dabs->dab[i].from[k] - dabs->dab[i].centre[k];
            square += d * d;
        }
        most = fmax(most, square);
    }
    return sqrt(most);
}

/* A drag follows voxels back, out of the reach of one dab perhaps into that of another: n dabs carry a voxel
 * by at most n times what one does, so that all dabs are listed that are as near as this, once they are n. */
int iso_dabs_find_near(const iso_dabs *dabs, const int brick[3], int near[ISO_DAB_MAX]) {
    near[0] = 0;
    if (dabs->count == 1) return 1;
    const double reach = iso_dabs_influence(dabs) + 1, step = carried(dabs);
    for (int carrying = 1;;) {
        int count = 0;
        for (int i = 0; i < dabs->count; i++)
            if (iso_dab_brick_distance(dabs, &dabs->dab[i], brick) < reach + carrying * step)
                near[count++] = i;
        if (step == 0 || count <= carrying) return count;
        carrying = count;
    }
}
