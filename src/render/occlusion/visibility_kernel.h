/* visibility_kernel: finds the nodes of a group of voxels and the directions in which each is blocked.
 * Internal to render/occlusion. */
#ifndef ISO_RENDER_OCCLUSION_VISIBILITY_KERNEL_H
#define ISO_RENDER_OCCLUSION_VISIBILITY_KERNEL_H

#include "base/cpu.h"
#include "render/occlusion/visibility_groups.h"

/* What a thread finds of a group before it is stored. */
typedef struct scratch {
    uint32_t node[ISO_VISIBILITY_ROWS];
    uint32_t blocked[ISO_DIRECTIONS_MAX][ISO_VISIBILITY_ROWS]; /* set only in rows with nodes */
} scratch;

typedef void follow_fn(const iso_visibility *v, const int at[3], scratch *out);
ISO_KERNEL_UNITS(follow_fn, iso_visibility_follow);

#endif
