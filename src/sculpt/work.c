#include "sculpt/work.h"

#include <math.h>
#include <string.h>

/* Voxels that redistancing reads on each side: the band. */
enum { REACH = 3 };
/* Voxels around a change within which distances can change: the band, and one for the stencil's sake. */
enum { SPREAD = REACH + 1 };

static size_t cell_count(const iso_hgrid *grid) {
    return (size_t)grid->cells[0] * (size_t)grid->cells[1] * (size_t)grid->cells[2];
}

iso_status iso_work_init(iso_work *work, iso_hgrid *grid, iso_pool *pool, iso_error *error) {
    size_t cells = cell_count(grid);
    size_t threads = (size_t)iso_pool_threads(pool);
    work->grid = grid;
    work->pool = pool;
    work->redistancer = iso_redistancer_get(iso_cpu_best());
    work->dab = iso_dab_kernel_get(iso_cpu_best());
    work->job_of = iso_alloc_zero(cells, sizeof *work->job_of);
    work->workers = iso_alloc_zero(threads, sizeof *work->workers);
    for (int sign = 0; sign < 2; sign++) {
        work->constant[sign] = iso_alloc(ISO_BRICK_VOXELS * sizeof(float));
        for (int i = 0; work->constant[sign] && i < ISO_BRICK_VOXELS; i++)
            work->constant[sign][i] = sign ? -grid->band : grid->band;
    }
    iso_status mask = iso_mask_init(&work->mask, cells, NULL);
    if (work->job_of && work->workers && work->constant[0] && work->constant[1] && mask == ISO_OK)
        return ISO_OK;
    iso_work_free(work);
    return iso_fail(error, ISO_ERR_NOMEM, "out of memory for sculpting %zu cells", cells);
}

void iso_work_free(iso_work *work) {
    iso_mask_free(&work->mask);
    iso_free(work->job_of);
    iso_free(work->constant[0]);
    iso_free(work->constant[1]);
    for (int i = 0; work->workers && i < iso_pool_threads(work->pool); i++)
        iso_buffer_free(&work->workers[i].window);
    iso_free(work->workers);
    iso_buffer_free(&work->jobs);
    for (int i = 0; i < ISO_WORK_FIELDS; i++) iso_buffer_free(&work->field[i]);
}

void iso_work_clear(iso_work *work) {
    for (size_t i = 0; i < work->job_count; i++) work->job_of[iso_work_job(work, i)->cell] = 0;
    work->job_count = 0;
    work->now = 0;
    work->classified = false;
}

const float *iso_work_before(const iso_work *work, int32_t state) {
    if (state >= 0) return iso_hgrid_brick(work->grid, state);
    return work->constant[state == ISO_CELL_INSIDE];
}

bool iso_work_failed(iso_work *work) {
    bool failed = false;
    for (int i = 0; i < iso_pool_threads(work->pool); i++) {
        failed |= work->workers[i].failed;
        work->workers[i].failed = false;
    }
    return failed;
}

iso_status iso_work_add(iso_work *work, const int at[3], bool edited, iso_error *error) {
    uint32_t cell = (uint32_t)iso_hgrid_cell_index(work->grid, at[0], at[1], at[2]);
    if (work->job_of[cell]) return ISO_OK;
    size_t bytes = work->job_count * sizeof(iso_job);
    ISO_TRY(iso_buffer_reserve(&work->jobs, bytes + sizeof(iso_job), bytes, error));
    iso_job *job = iso_work_job(work, work->job_count++);
    job->cell = cell;
    for (int axis = 0; axis < 3; axis++) job->at[axis] = at[axis];
    job->state = work->grid->cell[cell];
    job->source = NULL;
    job->edited = edited;
    memset(&job->changed, 0, sizeof job->changed);
    work->job_of[cell] = (uint32_t)work->job_count;
    return ISO_OK;
}

iso_status iso_work_reserve(iso_work *work, iso_error *error) {
    for (int i = 0; i < ISO_WORK_FIELDS; i++) {
        size_t kept = work->field[i].bytes, wanted = work->job_count * ISO_BRICK_VOXELS * sizeof(float);
        ISO_TRY(iso_buffer_reserve(&work->field[i], wanted, kept < wanted ? kept : wanted, error));
    }
    return ISO_OK;
}

void iso_work_load(iso_work *work, size_t first) {
    for (size_t i = first; i < work->job_count; i++)
        memcpy(iso_work_field(work, work->now, i), iso_work_before(work, iso_work_job(work, i)->state),
               ISO_BRICK_VOXELS * sizeof(float));
}

/* ---- stencils */

/* The neighbour across face `face` as the grid's border has it: the outermost layer, repeated. Only what a
 * stencil can read is made: whole rows along x, two layers along y and z. */
static void repeat_layer(const float *self, int face, float *out) {
    const int axis = face / 2, layer = face % 2 ? ISO_BRICK - 1 : 0;
    for (int row = 0; axis == 0 && row < ISO_BRICK_ROWS; row++)
        for (int x = 0; x < ISO_BRICK; x++) out[row * ISO_BRICK + x] = self[row * ISO_BRICK + layer];
    const int step = axis == 1 ? ISO_BRICK : ISO_BRICK_ROWS, along = axis == 1 ? ISO_BRICK_ROWS : ISO_BRICK;
    const int near = face % 2 ? 0 : ISO_BRICK - 1, next = face % 2 ? 1 : ISO_BRICK - 2;
    for (int i = 0; axis > 0 && i < ISO_BRICK; i++) {
        const float *from = self + layer * step + i * along;
        memcpy(out + near * step + i * along, from, ISO_BRICK * sizeof *out);
        memcpy(out + next * step + i * along, from, ISO_BRICK * sizeof *out);
    }
}

void iso_work_stencil(const iso_work *work, int field, size_t number, iso_border *border,
                      iso_stencil *stencil) {
    const iso_job *job = iso_work_job(work, number);
    const bool grid = field == ISO_WORK_GRID;
    stencil->self = grid ? iso_work_before(work, job->state) : iso_work_field(work, field, number);
    for (int face = 0; face < 6; face++) {
        int at[3] = {job->at[0], job->at[1], job->at[2]};
        at[face / 2] += face % 2 ? 1 : -1;
        if (at[face / 2] < 0 || at[face / 2] >= work->grid->cells[face / 2]) {
            repeat_layer(stencil->self, face, border->face[face]);
            stencil->face[face] = border->face[face];
            continue;
        }
        size_t cell = iso_hgrid_cell_index(work->grid, at[0], at[1], at[2]);
        uint32_t beside = grid ? 0 : work->job_of[cell];
        stencil->face[face] =
            beside ? iso_work_field(work, field, beside - 1) : iso_work_before(work, work->grid->cell[cell]);
    }
}

/* ---- what changed */

void iso_work_find_box(iso_job *job) {
    uint32_t x = 0, y = 0, z = 0;
    for (int row = 0; row < ISO_BRICK_ROWS; row++) {
        if (!job->changed.row[row]) continue;
        x |= job->changed.row[row];
        y |= 1u << (row % ISO_BRICK);
        z |= 1u << (row / ISO_BRICK);
    }
    const uint32_t bits[3] = {x, y, z};
    for (int axis = 0; axis < 3; axis++) {
        job->lo[axis] = (uint8_t)__builtin_ctz(bits[axis] | 1u << 31);
        job->hi[axis] = (uint8_t)(31 - __builtin_clz(bits[axis] | 1));
    }
}

static bool differs(const iso_work *work, iso_job *job, const float *before, float *values) {
    return work->dab->settle(before, iso_mask_bits(&work->mask, job->cell), values, &job->changed);
}

static void compare_job(void *context, size_t index, int worker) {
    (void)worker;
    const iso_work *work = context;
    iso_job *job = iso_work_job(work, index);
    job->edited =
        differs(work, job, iso_work_before(work, job->state), iso_work_field(work, work->now, index));
    if (job->edited) iso_work_find_box(job);
}

/* A brush that begins with other values than the grid's has changed what it changed of those: what it only
 * puts back makes no neighbours change. */
static void settle_job(void *context, size_t index, int worker) {
    const iso_work *work = context;
    iso_job *job = iso_work_job(work, index);
    float *values = iso_work_field(work, work->now, index);
    if (!job->source) {
        compare_job(context, index, worker);
        return;
    }
    const float *before = iso_work_before(work, job->state);
    bool moved = differs(work, job, job->source, values);
    iso_work_find_box(job);
    job->edited = moved || memcmp(values, before, ISO_BRICK_VOXELS * sizeof *values) != 0;
}

/* Closes up: jobs that nothing happened to go. */
static void drop_unchanged(iso_work *work) {
    size_t kept = 0;
    for (size_t i = 0; i < work->job_count; i++) {
        iso_job *job = iso_work_job(work, i);
        work->job_of[job->cell] = 0;
        if (!job->edited) continue;
        if (kept != i) {
            *iso_work_job(work, kept) = *job;
            memcpy(iso_work_field(work, work->now, kept), iso_work_field(work, work->now, i),
                   ISO_BRICK_VOXELS * sizeof(float));
        }
        kept++;
        work->job_of[iso_work_job(work, kept - 1)->cell] = (uint32_t)kept;
    }
    work->job_count = kept;
}

/* Whether the job has a voxel inside the band within REACH of the neighbour at `side` (-1, 0, 1 an axis). */
static bool band_near(const iso_work *work, size_t number, const int side[3]) {
    const float *values = iso_work_field(work, work->now, number), band = work->grid->band;
    int lo[3], hi[3];
    for (int axis = 0; axis < 3; axis++) {
        lo[axis] = side[axis] > 0 ? ISO_BRICK - REACH : 0;
        hi[axis] = side[axis] < 0 ? REACH - 1 : ISO_BRICK - 1;
    }
    for (int z = lo[2]; z <= hi[2]; z++)
        for (int y = lo[1]; y <= hi[1]; y++)
            for (int x = lo[0]; x <= hi[0]; x++)
                if (fabsf(values[(z * ISO_BRICK + y) * ISO_BRICK + x]) < band) return true;
    return false;
}

/* Whether a change of the job lies within REACH of that neighbour. */
static bool change_near(const iso_job *job, const int side[3]) {
    for (int axis = 0; axis < 3; axis++)
        if ((side[axis] < 0 && job->lo[axis] >= REACH) ||
            (side[axis] > 0 && job->hi[axis] < ISO_BRICK - REACH))
            return false;
    return true;
}

static iso_status add_neighbours(iso_work *work, size_t number, iso_error *error) {
    for (int k = 0; k < 27; k++) {
        const iso_job *job = iso_work_job(work, number); /* (the list moves) */
        const int side[3] = {k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1};
        int at[3];
        bool within = true;
        for (int axis = 0; axis < 3; axis++) {
            at[axis] = job->at[axis] + side[axis];
            within &= at[axis] >= 0 && at[axis] < work->grid->cells[axis];
        }
        if (!within || !change_near(job, side)) continue;
        int32_t state = work->grid->cell[iso_hgrid_cell_index(work->grid, at[0], at[1], at[2])];
        if (state < 0 && !band_near(work, number, side)) continue;
        ISO_TRY(iso_work_add(work, at, false, error));
    }
    return ISO_OK;
}

iso_status iso_work_settle(iso_work *work, bool neighbours, bool *any, iso_error *error) {
    iso_parallel_for(work->pool, work->job_count, settle_job, work);
    drop_unchanged(work);
    size_t edited = work->job_count;
    *any = edited > 0;
    for (size_t i = 0; i < edited && neighbours; i++) ISO_TRY(add_neighbours(work, i, error));
    ISO_TRY(iso_work_reserve(work, error));
    iso_work_load(work, edited);
    return ISO_OK;
}

/* ---- redistancing */

typedef struct pass {
    iso_work *work;
    int from, to, phi; /* fields */
} pass;

/* Adds the changed rows of the job beside (side: -1, 0, 1 an axis) that are within SPREAD, in rows of this
 * one: plane[z + SPREAD] bit (y + SPREAD). */
static void add_rows(const iso_job *beside, const int side[3], uint32_t plane[ISO_BRICK + 2 * SPREAD]) {
    const uint16_t near = side[0] == 0  ? 0xffff
                          : side[0] < 0 ? (uint16_t)(0xffff << (ISO_BRICK - SPREAD))
                                        : (1 << SPREAD) - 1;
    int lo[3], hi[3];
    for (int axis = 1; axis < 3; axis++) {
        lo[axis] =
            side[axis] < 0 && beside->lo[axis] < ISO_BRICK - SPREAD ? ISO_BRICK - SPREAD : beside->lo[axis];
        hi[axis] = side[axis] > 0 && beside->hi[axis] >= SPREAD ? SPREAD - 1 : beside->hi[axis];
    }
    for (int z = lo[2]; z <= hi[2]; z++)
        for (int y = lo[1]; y <= hi[1]; y++)
            if (beside->changed.row[z * ISO_BRICK + y] & near)
                plane[z + ISO_BRICK * side[2] + SPREAD] |= 1u << (y + ISO_BRICK * side[1] + SPREAD);
}

/* Rows from which no change is near need not be made distances again: they are. */
static void limit_rows(const iso_work *work, iso_job *job) {
    uint32_t plane[ISO_BRICK + 2 * SPREAD] = {0};
    for (int k = 0; k < 27; k++) {
        const int side[3] = {k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1};
        int at[3];
        bool within = true;
        for (int axis = 0; axis < 3; axis++) {
            at[axis] = job->at[axis] + side[axis];
            within &= at[axis] >= 0 && at[axis] < work->grid->cells[axis];
        }
        if (!within) continue;
        const uint32_t number = work->job_of[iso_hgrid_cell_index(work->grid, at[0], at[1], at[2])];
        if (number && iso_work_job(work, number - 1)->edited)
            add_rows(iso_work_job(work, number - 1), side, plane);
    }
    for (int z = 0; z < ISO_BRICK + 2 * SPREAD; z++)
        for (int step = 0; step < SPREAD; step++) plane[z] |= plane[z] << 1 | plane[z] >> 1;
    for (int z = 0; z < ISO_BRICK; z++) {
        uint32_t rows = 0;
        for (int step = 0; step <= 2 * SPREAD; step++) rows |= plane[z + step];
        rows = rows >> SPREAD & 0xffff;
        job->band.active[z / 2] &= rows << 16 * (z % 2) | 0xffffu << 16 * (1 - z % 2);
    }
}

static void classify_job(void *context, size_t index, int worker) {
    const pass *p = context;
    iso_job *job = iso_work_job(p->work, index);
    iso_stencil stencil;
    iso_work_stencil(p->work, p->from, index, p->work->workers[worker].border, &stencil);
    p->work->redistancer->classify(&stencil, p->work->grid->band, &job->band);
    limit_rows(p->work, job);
    memcpy(iso_work_field(p->work, p->to, index), stencil.self, ISO_BRICK_VOXELS * sizeof(float));
    const iso_voxel_bits *masked = iso_mask_bits(&p->work->mask, job->cell);
    for (int row = 0; masked && row < ISO_BRICK_ROWS; row++) job->band.frozen.row[row] |= masked->row[row];
}

static void rescale_job(void *context, size_t index, int worker) {
    const pass *p = context;
    const iso_job *job = iso_work_job(p->work, index);
    iso_stencil stencil;
    iso_work_stencil(p->work, p->from, index, p->work->workers[worker].border, &stencil);
    p->work->redistancer->rescale(&stencil, &job->band, &job->changed, iso_work_field(p->work, p->to, index));
}

static void correct_job(void *context, size_t index, int worker) {
    const pass *p = context;
    const iso_job *job = iso_work_job(p->work, index);
    iso_stencil phi, scaled;
    iso_work_stencil(p->work, p->phi, index, &p->work->workers[worker].border[0], &phi);
    float *out = iso_work_field(p->work, p->to, index);
    iso_work_stencil(p->work, p->from, index, &p->work->workers[worker].border[1], &scaled);
    p->work->redistancer->correct(&phi, &scaled, &job->band, &job->changed, out);
}

static void relax_job(void *context, size_t index, int worker) {
    const pass *p = context;
    iso_stencil stencil;
    iso_work_stencil(p->work, p->from, index, p->work->workers[worker].border, &stencil);
    p->work->redistancer->relax(&stencil, &iso_work_job(p->work, index)->band, p->work->grid->band,
                                iso_work_field(p->work, p->to, index));
}

/* Rows that no step writes must be the same in both fields that the steps alternate between. */
static void copy_job(void *context, size_t index, int worker) {
    (void)worker;
    const pass *p = context;
    memcpy(iso_work_field(p->work, p->to, index), iso_work_field(p->work, p->from, index),
           ISO_BRICK_VOXELS * sizeof(float));
}

static void run(const pass *p, iso_task *task) {
    iso_parallel_for(p->work->pool, p->work->job_count, task, (void *)p);
}

void iso_work_redistance(iso_work *work, int iterations, bool rescale) {
    int phi = work->now, one = (phi + 1) % ISO_WORK_FIELDS, two = (phi + 2) % ISO_WORK_FIELDS, from = phi,
        to = one;
    run(&(pass){work, phi, one, phi}, classify_job);
    work->classified = true;
    if (rescale) {
        run(&(pass){work, phi, one, phi}, rescale_job);
        run(&(pass){work, one, two, phi}, correct_job);
        from = two;
        to = one;
        run(&(pass){work, from, to, phi}, copy_job);
    }
    for (int i = 0; i < iterations; i++) {
        if (iso_progress_tell(work->progress, "", (double)i / iterations, NULL) != ISO_OK) break;
        run(&(pass){work, from, to, phi}, relax_job);
        int swap = from;
        from = to;
        to = swap;
    }
    work->now = from;
}

/* Whether the interface may lie in the cell: its voxels beside it are known for jobs; of others only empty
 * cells are sure to have none. */
static bool may_have_interface(const iso_work *work, const int at[3]) {
    size_t cell = iso_hgrid_cell_index(work->grid, at[0], at[1], at[2]);
    if (!work->job_of[cell]) return work->grid->cell[cell] >= 0;
    const iso_job *job = iso_work_job(work, work->job_of[cell] - 1);
    uint32_t any = 0;
    for (int row = 0; row < ISO_BRICK_ROWS; row++) any |= job->band.frozen.row[row];
    return any != 0;
}

/* A surface that was taken away leaves distances to nothing behind. Where neither a cell nor any around it
 * has an interface, they go at once. */
static void clear_ghost(void *context, size_t index, int worker) {
    (void)worker;
    const iso_work *work = context;
    const iso_job *job = iso_work_job(work, index);
    for (int k = 0; k < 27; k++) {
        const int at[3] = {job->at[0] + k % 3 - 1, job->at[1] + k / 3 % 3 - 1, job->at[2] + k / 9 - 1};
        bool within = true;
        for (int axis = 0; axis < 3; axis++) within &= at[axis] >= 0 && at[axis] < work->grid->cells[axis];
        if (within && may_have_interface(work, at)) return;
    }
    float *values = iso_work_field(work, work->now, index);
    const float empty = values[0] < 0 ? -work->grid->band : work->grid->band;
    for (int i = 0; i < ISO_BRICK_VOXELS; i++) values[i] = empty;
}

void iso_work_compare(iso_work *work, bool *any) {
    if (work->classified) iso_parallel_for(work->pool, work->job_count, clear_ghost, work);
    iso_parallel_for(work->pool, work->job_count, compare_job, work);
    *any = false;
    for (size_t i = 0; i < work->job_count; i++) *any |= iso_work_job(work, i)->edited;
}

/* ---- writing */

/* The state of a cell whose values are all +band or all -band; 0 when they are not. */
static int32_t empty_state(const iso_work *work, const float *values) {
    const float first = values[0], band = work->grid->band;
    if (first != band && first != -band) return 0;
    int same = 1;
    for (int i = 0; i < ISO_BRICK_VOXELS && same; i += ISO_BRICK)
        for (int k = 0; k < ISO_BRICK; k++) same &= values[i + k] == first;
    return !same ? 0 : first > 0 ? ISO_CELL_OUTSIDE : ISO_CELL_INSIDE;
}

/* Everything that can fail: the log's entries (too many do no harm) and the bricks, which still hold what the
 * empty cells said. */
static iso_status prepare(iso_work *work, iso_edit_stats *stats, iso_error *error) {
    iso_change_log_begin(work->grid->log);
    for (size_t i = 0; i < work->job_count; i++) {
        const iso_job *job = iso_work_job(work, i);
        if (!job->edited) continue;
        int lo[3], hi[3];
        for (int axis = 0; axis < 3; axis++) {
            lo[axis] = ISO_BRICK * job->at[axis] + job->lo[axis];
            hi[axis] = ISO_BRICK * job->at[axis] + job->hi[axis];
        }
        ISO_TRY(iso_change_log_touch(work->grid->log, lo, hi, error));
        if (job->state >= 0 || empty_state(work, iso_work_field(work, work->now, i))) continue;
        float *brick;
        ISO_TRY(iso_hgrid_split(work->grid, job->at[0], job->at[1], job->at[2], &brick, error));
        stats->created++;
    }
    return ISO_OK;
}

static void take_back(iso_work *work) {
    for (size_t i = 0; i < work->job_count; i++) {
        const iso_job *job = iso_work_job(work, i);
        if (job->state < 0) iso_hgrid_coalesce(work->grid, job->at[0], job->at[1], job->at[2], job->state);
    }
}

iso_status iso_work_commit(iso_work *work, iso_edit_stats *stats, iso_error *error) {
    iso_edit_stats made = *stats;
    iso_status status = prepare(work, &made, error);
    if (status != ISO_OK) {
        take_back(work);
        return status;
    }
    for (size_t i = 0; i < work->job_count; i++) {
        const iso_job *job = iso_work_job(work, i);
        if (!job->edited) continue;
        const float *values = iso_work_field(work, work->now, i);
        int32_t empty = empty_state(work, values);
        if (empty) {
            made.pruned += job->state >= 0;
            iso_hgrid_coalesce(work->grid, job->at[0], job->at[1], job->at[2], empty);
        } else
            memcpy(iso_hgrid_brick(work->grid, work->grid->cell[job->cell]), values,
                   ISO_BRICK_VOXELS * sizeof(float));
    }
    *stats = made;
    return ISO_OK;
}
