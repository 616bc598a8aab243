/* line_fragments: the fragments of lines in the base level of a pyramid. Internal to render. */
#ifndef ISO_RENDER_PULLPUSH_LINE_FRAGMENTS_H
#define ISO_RENDER_PULLPUSH_LINE_FRAGMENTS_H

#include "render/pullpush/kernel.h"
#include "render/pullpush/lines.h"
#include "render/view/project.h"

struct iso_pyramid_lines {
    iso_lines lines; /* arrays borrowed; its radii and attributes do not count */
    iso_shapes_opts opts;
    float *radii;      /* one per vertex, mm */
    uint8_t *segments; /* one per vertex: of the segment from it to the next vertex */
    /* A leg of a line has neither ends nor sharp bends within. How far the segment's first vertex is from
     * where its leg begins, and its second from where the leg ends, mm. */
    float *before, *after;
    float *curves; /* one per vertex: radius of the line's curvature, mm; INFINITY: straight */
    /* One per vertex: it is dropped where the level of the picture (iso_line_dropping_level) is at least
     * this; ISO_LINE_KEPT: nowhere. */
    uint8_t *drop;
};

/* Of a segment: it can be drawn; its leg begins, or ends, where the line does. */
enum { ISO_LINE_DRAWN = 1, ISO_LINE_STARTS = 2, ISO_LINE_STOPS = 4 };

/* Values of iso_pyramid_lines.drop: that of a tolerance of 1 mm, and of vertices that are never dropped. */
enum { ISO_LINE_DROP_0 = 127, ISO_LINE_KEPT = 255 };

/* Segments that are culled as one: those that begin at so many neighbouring vertices. */
enum { ISO_LINE_RUN = 32 };

/* Where a run can be in the picture, in rows counted in pixels of level 0 from the whole picture's corner,
 * with the discs' radii; lo > hi: nowhere. */
typedef struct iso_line_rows {
    float lo, hi;
    float depth;   /* the least, mm */
    uint32_t run;  /* its number */
    uint8_t level; /* of the vertices that are dropped */
} iso_line_rows;

/* The lines as one view sees them. */
typedef struct iso_line_frame {
    const iso_pyramid_lines *lines;
    const iso_view *view; /* of the whole picture or a strip */
    double
        normal[9]; /* directions from view space to that of the keys' normals: world, or as the caller says */
    int set;       /* value of ISO_PLANE_SET, if the pyramid has it */
    iso_line_rows *rows; /* of each run that may be seen, front to back: most others are hidden by then */
    size_t runs;
    float
        radius[2]; /* least and greatest radius of discs in the picture, pixels; [0] > [1]: nothing is seen */
} iso_line_frame;

/* Sets set->drop by opts.drop_pixels. The other arrays have to be there. ISO_ERR_NOMEM. */
iso_status iso_line_dropping_prepare(iso_pyramid_lines *set, iso_error *error);
/* The level of a part of the picture: pixel: the size of a pixel at the nearest place of the part, mm. */
uint8_t iso_line_dropping_level(const iso_pyramid_lines *set, double pixel);

/* Finds where runs are. Fails with ISO_ERR_NOMEM; free with iso_line_frame_free. */
iso_status iso_line_frame_make(const iso_pyramid_lines *lines, const iso_target *target,
                               iso_line_frame *frame, iso_error *error);
void iso_line_frame_free(iso_line_frame *frame);

/* Writes the fragments of rows of the base level: keys, and the optional planes. */
void iso_line_fragments_project(const iso_line_frame *frame, const iso_pyramid *pyramid, iso_rows rows);

#endif
