/* kernel: the steps of pull-push on rows of a pyramid, once per instruction set. Internal to render.
 *
 * Rows are independent of each other within a step, so that threads may process any of them at the same
 * time. */
#ifndef ISO_RENDER_PULLPUSH_KERNEL_H
#define ISO_RENDER_PULLPUSH_KERNEL_H

#include "base/cpu.h"
#include "render/points/point_blocks.h"
#include "render/pullpush/pyramid.h"
#include "render/raster/raster.h"

/* Parameters of the projection of points to keys. Positions of packed points are counted in steps of
 * 1 / per_voxel voxels from `low` voxels on; those of surfels in voxels from the brick's corner. */
typedef struct iso_point_projection {
    const iso_point_view *points;
    const iso_pyramid *pyramid;
    bool cull; /* leave out back-facing points */
    bool orthographic;
    float near;    /* depth of the near plane, mm */
    int32_t first; /* added to the points' numbers in the index */
    /* From index coordinates to view space, with x and y in pixels of the base level at depth 1
     * (orthographic: at any depth) and z in mm; `step` is the same matrix for positions in steps. */
    double matrix[9], origin[3];
    float step[9];
    double low, per_voxel;
    double eye[3];     /* index coordinates; orthographic: the direction of view */
    float column, row; /* of the optical axis in the base level, from the whole picture's guard band on */
    int rows_before;   /* rows of the base level of the whole picture above the pyramid's first */
} iso_point_projection;

/* What the pixels of a pyramid stand for. */
typedef enum iso_pullpush_kind {
    ISO_PULLPUSH_ONE_SIDED, /* points of a closed surface: none of them faces away from the eye */
    ISO_PULLPUSH_TWO_SIDED, /* back-facing points are drawn too: opposite normals must not be averaged */
    /* Line fragments. Tangents of tubes and normals of ribbons have no sign: before they are averaged, each
     * is turned to the side of the frontmost. */
    ISO_PULLPUSH_TUBES,
    ISO_PULLPUSH_RIBBONS,
    /* Several sets: surfaces, two-sided, and ribbons. Pixels of different sets are never averaged: the
     * frontmost decides which set a coarser pixel shows. */
    ISO_PULLPUSH_SETS
} iso_pullpush_kind;

/* Parameters of the other steps. */
typedef struct iso_pullpush_params {
    const iso_pyramid *pyramid;
    const iso_target *target;
    float normal[9];    /* normals from index to view space */
    float radius;       /* of discs of points without radii of their own, mm */
    const float *radii; /* of the points that the pyramid's index numbers, mm; NULL: all are the same */
    const uint8_t (*colors)[3]; /* the same; NULL: they have none */
    float scale;                /* pixels per mm at depth 1 (orthographic: at any depth) */
    bool orthographic;
    iso_pullpush_kind kind;
    /* The ray through pixel (c, r) of level 0 has x / z = (c + 0.5 - ray[0]) * slope and y / z = (r + 0.5 -
     * ray[1]) * slope, where r counts from the whole picture's guard band. */
    float ray[2], slope;
    float low_pass;     /* added to the squared axes of ellipses, pixels^2 */
    float least_radius; /* pixels: a pixel with a smaller mean radius has no ellipse */
    float facing, edge; /* the same towards the silhouette, for discs seen face-on and edge-on */
    /* Discs of a surface end at the border of the grid that its points come from: index coordinates 0 and
     * `border`. `eye`: index coordinates of view space's origin. */
    bool has_border;
    float border[3], eye[3];
    float voxels_per_pixel[3]; /* along the index axes, at depth 1 mm (orthographic: at any depth) */
    bool illuminated;          /* tubes get the normals of illuminated lines */
    float weight[4]; /* weight of a pixel at q (pyramid.h), 0 <= q < 1: a cubic, constant term first */
} iso_pullpush_params;

/* Blocks order[0] .. order[count - 1] of the array `blocks`. */
typedef struct iso_block_list {
    const iso_point_block *blocks;
    const uint32_t *order;
    size_t count;
} iso_block_list;

/* The steps that depend on what the pixels of a pyramid stand for. */
typedef struct iso_pullpush_steps {
    /* Converts rows of keys to planes of the base level, which is 1 or higher. */
    void (*unpack_keys)(const iso_pullpush_params *params, iso_rows rows);
    /* Averages the level below into rows of `level`; into level 1 directly from keys when level 0 is the
     * base. */
    void (*pull_rows)(const iso_pullpush_params *params, int level, iso_rows rows);
    /* Computes the ellipses of rows of a level from its other planes. */
    void (*make_ellipses)(const iso_pullpush_params *params, int level, iso_rows rows);
    /* Fills rows of the level below `level`, which must be 1 or higher, and computes their ellipses. Rows are
     * rows of cells: a cell is the square between the centres of four pixels of `level` and contains the
     * centres of four pixels of the level below. Row y of cells, 0 .. half the height of the level below,
     * lies between rows y - 1 and y of `level` and contains rows 2y - 1 and 2y of the level below. */
    void (*push_rows)(const iso_pullpush_params *params, int level, iso_rows rows);
    /* The last push, by rows of level 1's cells: writes samples into the gbuffer. */
    void (*finish_samples)(const iso_pullpush_params *params, iso_rows rows);
} iso_pullpush_steps;

/* Pull and push of lines, or of several sets, by another engine than the cpu. `draw`: draws a strip: `params`
 * has its target, and its pyramid, whose base level alone has been made. */
typedef struct iso_pyramid_engine {
    iso_status (*draw)(void *context, const iso_pullpush_params *params, iso_error *error);
    void *context;
} iso_pyramid_engine;

/* Projects the points of the blocks into rows of the keys, and of the index when there is one. */
typedef void iso_pullpush_project_fn(const iso_point_projection *projection, const iso_block_list *list,
                                     iso_rows rows);

ISO_KERNEL_UNITS(iso_pullpush_project_fn, iso_pullpush_project);
ISO_KERNEL_UNITS(const iso_pullpush_steps, iso_pullpush_steps_ONE);
ISO_KERNEL_UNITS(const iso_pullpush_steps, iso_pullpush_steps_TWO);
ISO_KERNEL_UNITS(const iso_pullpush_steps, iso_pullpush_steps_SETS);

/* The functions for the best instruction set that this processor and this build have. Never NULL. */
iso_pullpush_project_fn *iso_pullpush_project_get(void);
const iso_pullpush_steps *iso_pullpush_steps_get(iso_pullpush_kind kind);

/* The steps of lines alone (line_levels.c). */
extern const iso_pullpush_steps iso_line_steps;

#endif
