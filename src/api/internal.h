/* internal: the structs behind the handles of isopoint.h. This folder is a thin layer: it checks arguments,
 * fills in defaults and calls the other modules, which never include it. */
#ifndef ISO_API_INTERNAL_H
#define ISO_API_INTERNAL_H

#include "base/parallel.h"
#include "extract/points/points.h"
#include "grids/labels/label_fields.h"
#include "grids/volume/volume.h"
#include "isopoint.h"
#include "render/gaussians/gaussians.h"
#include "scene/cloud.h"
#include "scene/instances.h"
#include "scene/object_file.h"
#include "scene/occluders.h"
#include "sculpt/field/cell_items.h"

/* The caller's function for progress, and the part of the operation that is being done. */
typedef struct iso_api_watch {
    iso_progress_fn *tell; /* NULL: nobody is told */
    void *context;
    double from, to;                /* the part of the whole that the loops belong to */
    double told, asked, loop_start; /* what was reported last; when: s */
} iso_api_watch;

/* A volume. Its handle points to the first member. */
typedef struct iso_api_volume {
    iso_volume volume;
    iso_pool *pool;
    iso_api_watch watch;         /* iso_volume_set_progress */
    int surfaces;                /* number of surfaces that borrow the volume */
    bool borrowed;               /* the grid and the pool belong to an iso_sculpt */
    const iso_cell_items *paint; /* of the sculpt, borrowed; NULL: it is no sculpt's */
} iso_api_volume;

static inline iso_api_volume *iso_api_volume_of(iso_volume *volume) {
    return (iso_api_volume *)volume;
}

/* Points without a volume. */
typedef struct iso_api_cloud {
    iso_glyphs points; /* of Gaussians only, once the discs are made */
    float *opacities;  /* of Gaussians, 0 .. 1 */
    iso_scene_cloud made;
    iso_point_view view; /* of its discs */
} iso_api_cloud;

struct iso_surface {
    iso_api_volume *volume;         /* NULL: a cloud */
    iso_api_cloud *cloud;           /* owned; NULL: an isosurface of the volume */
    iso_pool *pool;                 /* the volume's; a cloud owns its pool */
    iso_scene_surface scene;        /* the parts that renderers draw */
    iso_occluders occluders;        /* of pictures of this surface alone */
    iso_point_set *points;          /* points as floats for iso_surface_points; NULL: not requested yet */
    iso_labels labels;              /* of a surface of labels, whose level set is that of label_fields */
    iso_label_fields *label_fields; /* NULL: it is an isosurface, or a cloud */
    double origin[3];               /* of what iso_surface_points and iso_surface_mesh give */
    double opacity;
    bool has_color;
    iso_rgb color;
};

/* A set of lines, glyphs or triangles. */
struct iso_shape_set {
    iso_object_file file;    /* its lines or glyphs */
    iso_scene_object object; /* what is drawn, without a colour; it borrows those */
    double opacity;
    bool has_color;
    iso_rgb color;
};

/* Whether the caller names a file, which may be on a web server: ISO_ERR_USAGE. */
iso_status iso_api_check_path(const char *path, iso_error *error);
/* Whether the caller's mesh can be used: ISO_ERR_EMPTY, ISO_ERR_USAGE. */
iso_status iso_api_check_mesh(const iso_mesh *mesh, iso_error *error);
/* Reads a mesh, turned to LPS if the caller says that it is `ras`; iso_triangles_free when done. */
iso_status iso_api_read_mesh(const char *path, bool ras, iso_triangles *triangles, iso_error *error);

/* Begins an operation: from now on the loops of the pool report to `watch` (borrowed), and can be cancelled.
 */
void iso_api_watch_begin(iso_pool *pool, iso_api_watch *watch);
/* What is done next is this part of the operation. */
void iso_api_watch_part(iso_api_watch *watch, double from, double to);
/* Ends it: nobody is told any more. */
void iso_api_watch_end(iso_pool *pool);

/* Brings the brick index of the grid up to date with edits. Call this before any use of a surface. */
iso_status iso_api_surface_ready(iso_surface *surface, iso_error *error);

/* Extracts or updates a part of the surface. ISO_ERR_EMPTY: it is empty. */
iso_status iso_api_surface_part(iso_surface *surface, iso_part part, iso_error *error);

/* The world box of an extracted part. */
iso_box iso_api_surface_bounds(const iso_surface *surface, iso_part part);

/* Copies `count` items of `size` bytes to new memory and sets the pointer at `to`; NULL stays NULL. */
iso_status iso_api_copy(const void *from, size_t count, size_t size, void *to, iso_error *error);

void iso_api_cloud_destroy(iso_api_cloud *cloud); /* NULL is allowed */
static inline bool iso_api_is_gaussians(const iso_surface *surface) {
    return surface->cloud && surface->cloud->points.gaussians;
}
/* Shows or hides the cloud's own colours, which one given colour replaces. */
void iso_api_cloud_hide_colors(iso_api_cloud *cloud, bool hidden);
/* The Gaussians of a cloud, which they borrow; `color`: of those without colours. */
iso_gaussians iso_api_cloud_gaussians(const iso_api_cloud *cloud, iso_rgb color);

/* Creates a pool of `threads` threads. ISO_ERR_USAGE: the number of threads is not in 0 .. 1024. */
iso_status iso_api_pool(int threads, iso_pool **pool, iso_error *error);

#endif
