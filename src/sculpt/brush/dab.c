/* dab: which tools change what, and how far dabs reach. */
#include "sculpt/brush/dab.h"

#include <math.h>

bool iso_tool_is_set_operation(iso_tool tool) {
    return tool <= ISO_TOOL_BLEND_CARVE;
}

bool iso_tool_is_whole_mask(iso_tool tool) {
    return tool == ISO_TOOL_CLEAR_MASK || tool == ISO_TOOL_INVERT_MASK;
}

bool iso_tool_is_warp(iso_tool tool) {
    return tool >= ISO_TOOL_PINCH && tool <= ISO_TOOL_MOVE;
}

bool iso_tool_is_drag(iso_tool tool) {
    return tool == ISO_TOOL_SNAKE_HOOK || tool == ISO_TOOL_MOVE;
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
