/* pullpush_kernel: the steps of pull-push on rows of a pyramid, for each instruction set. Internal to render.
 *
 * Rows are independent of each other within a step, so a step's rows may be dealt out to threads at will. */
#ifndef ISO_RENDER_PULLPUSH_KERNEL_H
#define ISO_RENDER_PULLPUSH_KERNEL_H

#include "base/cpu.h"
#include "render/point_blocks.h"
#include "render/pullpush/pyramid.h"
#include "render/raster/raster.h"

/* How points become keys. */
typedef struct iso_point_projection {
    const iso_point_view *points;
    const iso_pyramid *pyramid;
    bool cull; /* leave out points that face away */
    bool orthographic;
    float near;
    /* View space from index coordinates, x and y in pixels of the base level at depth 1 (orthographic: at any
     * depth); the same for a step of the points' positions, and where a brick's first step lies in it. */
    double matrix[9], origin[3];
    float step[9];
    double low, per_voxel;
    /* The eye in index coordinates, or (orthographic) the direction of the view. */
    double eye[3];
    float column, row; /* of the optical axis, from the whole frame's corner, base level */
    int rows_before;   /* base level rows of the whole frame before the pyramid's */
} iso_point_projection;

/* What the other steps need to know. */
typedef struct iso_pullpush_params {
    const iso_pyramid *pyramid;
    const iso_target *target;
    float normal[9]; /* index covector to view space */
    float radius;    /* of points that have none of their own, mm */
    float scale;     /* pixels per mm at depth 1 (orthographic: at any depth) */
    bool orthographic;
    bool two_sided;      /* points that face away are there too: normals are not averaged across */
    float ray[2], slope; /* x / z of pixel column c of level 0 is (c + 0.5 - ray[0]) * slope; y likewise, rows
                            being counted from the whole frame */
    float low_pass;      /* added to the squared axes of ellipses, pixels^2 */
    float facing, edge;  /* the same on the side where the surface ends, seen face-on and edge-on */
    float weight[4];     /* of q, 0 .. 1: a polynomial */
} iso_pullpush_params;

/* Blocks order[0] .. order[count - 1] of an array. */
typedef struct iso_block_list {
    const iso_point_block *blocks;
    const uint32_t *order;
    size_t count;
} iso_block_list;

typedef struct iso_pullpush_kernel {
    /* The blocks' points into rows first .. last of the keys, and of the index when there is one. */
    void (*project)(const iso_point_projection *projection, const iso_block_list *list, iso_rows rows);
    /* Keys of the base level, 1 or higher, into its planes. */
    void (*unpack)(const iso_pullpush_params *params, iso_rows rows);
    /* Rows of `level` from those of the level below; of level 1 from keys when that is the base. */
    void (*pull)(const iso_pullpush_params *params, int level, iso_rows rows);
    /* The ellipses of a level whose other planes are ready. */
    void (*ellipses)(const iso_pullpush_params *params, int level, iso_rows rows);
    /* Fills what lies between the pixels of `level`, by rows of cells: row y, of 0 .. half the height of the
     * level below, lies between rows y - 1 and y of the level, and is rows 2y - 1 and 2y of the level below,
     * 1 or higher; and makes their ellipses. */
    void (*push)(const iso_pullpush_params *params, int level, iso_rows rows);
    /* The same for rows of level 1's cells and the gbuffer. */
    void (*finish)(const iso_pullpush_params *params, iso_rows rows);
} iso_pullpush_kernel;

/* The kernel at an instruction set, or at the best below it that this build has. Never NULL. */
const iso_pullpush_kernel *iso_pullpush_kernel_get(iso_cpu_level level);

#endif
