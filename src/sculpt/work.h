/* work: the cells that a touch works on: their new values beside the grid, until all is done.
 *
 * Jobs are listed cells with their values in scratch; a job's neighbours are other jobs' scratch, the grid's
 * bricks, or one of two constant bricks. Nothing is written to the grid before iso_work_commit, so a touch
 * that fails leaves no trace. Internal to sculpt. */
#ifndef ISO_SCULPT_WORK_H
#define ISO_SCULPT_WORK_H

#include "base/memory.h"
#include "base/parallel.h"
#include "sculpt/dab.h"
#include "sculpt/edit.h"

/* One cell. */
typedef struct iso_job {
    uint32_t cell;
    int at[3];
    int32_t state;          /* the grid's entry before */
    const float *source;    /* what the brush began with; NULL: the grid's floats */
    bool edited;            /* the brush wrote it; else it is a neighbour that redistancing may reach */
    iso_voxel_bits changed; /* by the brush; later by all that was done */
    iso_band_state band;
    uint8_t lo[3], hi[3]; /* box of `changed` */
} iso_job;

/* Neighbours beyond the grid's border, made up for one stencil. */
typedef struct iso_border {
    float face[6][ISO_BRICK_VOXELS];
} iso_border;

/* One worker's. */
typedef struct iso_worker {
    iso_border border[2];
    iso_warp warp;
    iso_buffer window;
    bool failed; /* no memory */
} iso_worker;

/* Values of a job that a step may read and the next one writes; and, read only, the grid's own. */
enum { ISO_WORK_FIELDS = 3, ISO_WORK_GRID = -1 };

typedef struct iso_work {
    iso_hgrid *grid;
    iso_pool *pool;
    const iso_redistancer *redistancer;
    const iso_dab_kernel *dab;
    float *constant[2]; /* bricks of +band and -band */
    uint32_t *job_of;   /* by cell: 1 + its job, 0: none */
    iso_mask mask;
    iso_buffer jobs, field[ISO_WORK_FIELDS];
    size_t job_count;
    int now;         /* the field that holds the jobs' values */
    bool classified; /* the jobs' band states are known */
    iso_worker *workers;
    const iso_progress *progress; /* of redistancing; NULL: nobody waits */
} iso_work;

/* Zero-initialised storage; grid and pool are borrowed until free. */
iso_status iso_work_init(iso_work *work, iso_hgrid *grid, iso_pool *pool, iso_error *error);
void iso_work_free(iso_work *work);
/* Forgets all jobs. */
void iso_work_clear(iso_work *work);

static inline iso_job *iso_work_job(const iso_work *work, size_t job) {
    return (iso_job *)work->jobs.data + job;
}
static inline float *iso_work_field(const iso_work *work, int field, size_t job) {
    return (float *)work->field[field].data + job * ISO_BRICK_VOXELS;
}

/* The floats of a cell with this entry in the grid. */
const float *iso_work_before(const iso_work *work, int32_t state);
/* Whether a worker ran out of memory since the last question. */
bool iso_work_failed(iso_work *work);

/* Lists a cell once; room for its values is made by iso_work_reserve. Values are not set. ISO_ERR_NOMEM. */
iso_status iso_work_add(iso_work *work, const int at[3], bool edited, iso_error *error);
iso_status iso_work_reserve(iso_work *work, iso_error *error);
/* Jobs `first` and on take the grid's values. */
void iso_work_load(iso_work *work, size_t first);

/* The stencil of a job's values in `field` (of the grid's where a neighbour is no job); faces on the grid's
 * border repeat the outermost voxels (kept in `border` while the stencil is used). */
void iso_work_stencil(const iso_work *work, int field, size_t job, iso_border *border, iso_stencil *stencil);

/* After the brush has written field `now`: finds what it changed, drops jobs where nothing did, and lists the
 * neighbours that redistancing may reach. *any: whether anything changed. */
iso_status iso_work_settle(iso_work *work, bool neighbours, bool *any, iso_error *error);

/* Sets a job's box from what has changed in it. */
void iso_work_find_box(iso_job *job);

/* Makes the listed cells a distance field where something changed near by (jobs that are `edited`, their
 * bits and boxes); `rescale`: voxels at the interface that the brush changed too. */
void iso_work_redistance(iso_work *work, int iterations, bool rescale);

/* Finds what differs from the grid now; *any: whether anything does. */
void iso_work_compare(iso_work *work, bool *any);

/* Writes what differs, under one edit of the change log. ISO_ERR_NOMEM: nothing was written. */
iso_status iso_work_commit(iso_work *work, iso_edit_stats *stats, iso_error *error);

#endif
