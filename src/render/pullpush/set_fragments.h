/* set_fragments: the base level of a pyramid of several sets. Internal to render. */
#ifndef ISO_RENDER_PULLPUSH_SET_FRAGMENTS_H
#define ISO_RENDER_PULLPUSH_SET_FRAGMENTS_H

#include "render/pullpush/line_fragments.h"
#include "render/pullpush/polygon_fragments.h"
#include "render/pullpush/sets.h"

/* A set as one view sees it. Which of these are used depends on what the set has. */
typedef struct iso_set_frame {
    const iso_pyramid_set *set;
    iso_hybrid_parts parts;       /* of a hybrid surface */
    const iso_point_view *points; /* the set's, or those of `parts`; NULL: none */
    const iso_mesh_view *mesh;    /* the same */
    iso_point_blocks blocks;
    iso_point_projection projection;
    int32_t first; /* number of the set's first point among all points */
    iso_line_frame lines;
} iso_set_frame;

typedef struct iso_sets_frame {
    iso_set_frame *sets;
    size_t count;
    iso_projector projector; /* from the points' index space, or the world if there are none */
    iso_polygon_set *polygon_sets;
    iso_polygons polygons;
    float
        radius[2]; /* least and greatest radius of discs in the picture, pixels; [0] > [1]: there are none */
    bool colored;  /* some sets have colours of their own */
} iso_sets_frame;

/* ISO_ERR_NOMEM, ISO_ERR_USAGE (sets.h). Free with iso_sets_frame_free, also after an error. */
iso_status iso_sets_frame_make(const iso_pyramid_set *sets, size_t count, const iso_target *target,
                               iso_sets_frame *frame, iso_error *error);
void iso_sets_frame_free(iso_sets_frame *frame);

/* Prepares the drawing of a strip: projections, bands of points, the picture of all triangles. ISO_ERR_NOMEM.
 */
iso_status iso_sets_frame_prepare(iso_sets_frame *frame, const iso_target *strip, const iso_pyramid *pyramid,
                                  int band_rows, iso_error *error);

/* iso_draw_pyramid_sets (sets.h) by an engine, which gets keys and planes of level 0; NULL: by the cpu.
 * (pullpush.c) */
iso_status iso_draw_pyramid_sets_by(const iso_pyramid_engine *engine, const iso_target *target,
                                    const iso_pyramid_set *sets, size_t count, const iso_pullpush_opts *opts,
                                    iso_error *error);

/* Writes the fragments of a band, rows of level 0: keys and the optional planes. */
void iso_set_fragments_project(const iso_sets_frame *frame, const iso_pyramid *pyramid, size_t band,
                               iso_rows rows);

#endif
