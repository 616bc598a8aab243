/* engine: what the parts of a page's engine share: the page that is shown. engine.c draws it, labels.c and
 * lines.c add labels and lines to it. */
#ifndef ISO_APPS_PAGE_ENGINE_H
#define ISO_APPS_PAGE_ENGINE_H

#include "base/memory.h"
#include "scene/label_colors.h"
#include "scene/picture.h"

#define EXPORT(name) __attribute__((export_name(#name)))

enum { SURFACES = 64, OBJECTS = 32 };

/* The volume, and the same with every second voxel on each axis, for moving pictures of fine surfaces. */
typedef struct level {
    iso_grid grid;
    iso_scene_surface parts[SURFACES];
} level;

/* A group of labels, which share a surface. */
typedef struct group {
    iso_grid grid;                  /* its level set */
    const iso_label_colors *colors; /* NULL: that of the surface */
} group;

extern struct page {
    level levels[2];
    iso_layered_surface surfaces[SURFACES]; /* without their parts */
    int groups[SURFACES];                   /* whose surfaces they are; 0: of the volume */
    group labels[ISO_LABEL_GROUPS + 1];
    iso_scene_object *objects[OBJECTS]; /* lines */
    int object_count;
    iso_rgb colors[SURFACES + OBJECTS];
    int count;
    iso_rgb background;
    iso_clip clip;
    bool caps;
    iso_camera camera;
    iso_buffer pixels;
    iso_error error;
} page;

static inline iso_rgb rgb(int color) {
    return (iso_rgb){(uint8_t)(color >> 16), (uint8_t)(color >> 8), (uint8_t)color};
}

/* Makes a volume of voxels at `data`. transform: origin, spacing and direction, 15 numbers. */
iso_status page_grid(int nx, int ny, int nz, int type, void *data, double scale, double offset,
                     const double *transform, int level_set, iso_rgrid **grid);

#endif
