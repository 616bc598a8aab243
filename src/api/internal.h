/* internal: what stands behind the handles of isopoint.h. This folder is a thin face: it checks arguments,
 * puts defaults in and calls the modules below. Nothing below includes it. */
#ifndef ISO_API_INTERNAL_H
#define ISO_API_INTERNAL_H

#include "base/parallel.h"
#include "extract/points/points.h"
#include "grids/volume/volume.h"
#include "isopoint.h"
#include "methods/method.h"

#ifdef __cplusplus
extern "C" {
#endif

/* The handle of a volume points to the first member. */
typedef struct iso_api_volume {
    iso_volume volume;
    iso_pool *pool;
    int surfaces;  /* that borrow the volume */
    bool borrowed; /* the grid and the pool are a sculpt's */
} iso_api_volume;

static inline iso_api_volume *iso_api_volume_of(iso_volume *volume) {
    return (iso_api_volume *)volume;
}

struct iso_surface {
    iso_api_volume *volume;
    iso_subject subject;   /* what is drawn */
    iso_point_set *points; /* what is handed out: floats; NULL: not asked for yet */
    iso_primitive primitive;
    bool has_color;
    iso_rgb color;
};

/* Brings what reading the grid needs up to date with its edits; before any use of a surface. */
iso_status iso_api_surface_ready(iso_surface *surface, iso_error *error);

/* Makes a part of the surface, or brings it up to date; ISO_ERR_EMPTY when it holds nothing. */
iso_status iso_api_surface_part(iso_surface *surface, iso_part part, iso_error *error);

/* The world box of a part that is there. */
iso_box iso_api_surface_bounds(const iso_surface *surface, iso_part part);

/* ISO_ERR_USAGE unless it is 0 .. 1024. */
iso_status iso_api_pool(int threads, iso_pool **pool, iso_error *error);

#ifdef __cplusplus
}
#endif
#endif
