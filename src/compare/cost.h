/* cost: measures how long it takes to extract the primitives of an isosurface and to draw them: the
 * measurements of Baerentzen and Christensen 2003, section 6, tables 2 to 4, on any volume.
 *
 * Frames are drawn by the cpu engine, each from another direction; the directions are pseudo-random and the
 * same on every machine. Times are of the clock on the wall, with the threads of the surface's pool. */
#ifndef ISO_COMPARE_COST_H
#define ISO_COMPARE_COST_H

#include "compare/study.h"

enum { ISO_COST_METHODS = 4, ISO_COST_VIEWPORTS = 5, ISO_COST_RUNS = 3 };

/* Returns the methods that are measured: attenuated points, pull-push with Gaussian weights, the mesh and
 * exact. */
const iso_renderer *iso_cost_method(int number);
/* Pixels along a side of the pictures of table 4: 100, 200, 400, 800, 2048. */
extern const int ISO_COST_VIEWPORT[ISO_COST_VIEWPORTS];

/* Seconds a frame takes; NaN: the memory limit leaves no room for such pictures. */
typedef struct iso_cost_frame {
    double median; /* of all frames of ISO_COST_RUNS runs */
    double best;   /* the least mean of a run, which is what the paper reports */
    int frames;    /* number of frames that were drawn */
} iso_cost_frame;

typedef struct iso_cost_row {
    size_t primitives;     /* number of points, triangles or cells */
    double generation;     /* seconds to extract all bricks, median of ISO_COST_RUNS runs */
    iso_cost_frame still;  /* table 2: nothing changes between frames */
    iso_cost_frame edited; /* table 3: some bricks are extracted again before each frame; included */
    iso_cost_frame viewport[ISO_COST_VIEWPORTS]; /* table 4 */
} iso_cost_row;

typedef struct iso_cost_study {
    iso_cost_row rows[ISO_COST_METHODS];
    double strips;  /* indices of triangle strips divided by indices of the triangles; NaN: no triangles */
    int side;       /* pixels along a side of the pictures of tables 2 and 3 */
    size_t bricks;  /* number of bricks of the grid */
    size_t crossed; /* bricks that have triangles */
    int dirty;      /* bricks that are extracted again before each frame of table 3 */
} iso_cost_study;

/* How much is measured; zeros are the defaults. */
typedef struct iso_cost_opts {
    int side;       /* pixels along a side of the pictures of tables 2 and 3; 0: 800, as in the paper */
    int dirty;      /* bricks to extract again before each frame; 0: 4, as in the paper on average */
    double seconds; /* how long a run of frames lasts (two frames at least, 200 at most); 0: 0.2 */
} iso_cost_opts;

/* Measures everything. The surface needs its parts points, mesh and cells. Marks bricks of its grid as
 * edited, without changing a value. Points are those that the paper draws: foot points of sparse level
 * sets, else edge points. Only the colours of the look are used. ISO_ERR_NOMEM, and the errors of
 * extraction and drawing. */
iso_status iso_study_cost(const iso_scene_surface *surface, const iso_study_ball *ball,
                          const iso_study_look *look, const iso_cost_opts *opts, iso_cost_study *study,
                          iso_error *error);

#endif
