#include "sculpt/field/work.h"

#include <math.h>
#include <string.h>

#include "sculpt/field/wall.h"

/* Voxels that redistancing reads on each side: the band. */
enum { REACH = 3 };
enum { SPREAD = ISO_WORK_SPREAD };
/* Of iso_job.sides. */
enum { BOTH_SIDES = 3 };
/* Voxels by which a step of redistancing must move something for the next one to be worth it near by: where
 * the interface itself is rescaled distances have farther to go, step by step. */
static const float LEAST_FROZEN = 0.02f, LEAST_RESCALED = 0.01f;

iso_status iso_work_init(iso_work *work, iso_hgrid *grid, iso_pool *pool, iso_error *error) {
    size_t cells = iso_hgrid_cell_count(grid);
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
    iso_status room = iso_mask_init(&work->mask, cells, NULL);
    if (room == ISO_OK) room = iso_slabs_reserve(&work->slabs, 1, NULL);
    iso_slabs_touch(&work->slabs);
    if (work->job_of && work->workers && work->constant[0] && work->constant[1] && room == ISO_OK)
        return ISO_OK;
    iso_work_free(work);
    return iso_fail(error, ISO_ERR_NOMEM, "out of memory for sculpting %zu cells", cells);
}

void iso_work_free(iso_work *work) {
    iso_mask_free(&work->mask);
    iso_free(work->job_of);
    iso_free(work->constant[0]);
    iso_free(work->constant[1]);
    for (int i = 0; work->workers && i < iso_pool_threads(work->pool); i++) {
        iso_buffer_free(&work->workers[i].window);
        iso_buffer_free(&work->workers[i].crossings);
    }
    iso_free(work->workers);
    iso_buffer_free(&work->jobs);
    iso_buffer_free(&work->walls);
    iso_slabs_free(&work->slabs);
}

void iso_work_clear(iso_work *work) {
    for (size_t i = 0; i < work->job_count; i++) work->job_of[iso_work_job(work, i)->cell] = 0;
    work->job_count = 0;
    work->now = 0;
    work->redistanced = false;
    work->away = 0;
    work->torn = false;
    work->progress = NULL;
    work->taken = 0;
    for (int i = 0; i < iso_pool_threads(work->pool); i++) work->workers[i].stage = NULL;
}

const iso_job *iso_work_beside(const iso_work *work, const iso_job *job, const int side[3]) {
    int at[3];
    for (int axis = 0; axis < 3; axis++) {
        at[axis] = job->at[axis] + side[axis];
        if (at[axis] < 0 || at[axis] >= work->grid->cells[axis]) return NULL;
    }
    const uint32_t number = work->job_of[iso_hgrid_cell_index(work->grid, at[0], at[1], at[2])];
    return number ? iso_work_job(work, number - 1) : NULL;
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
    *job = (iso_job){.cell = cell, .state = work->grid->cell[cell], .edited = edited};
    for (int axis = 0; axis < 3; axis++) job->at[axis] = at[axis];
    job->value[work->now] = iso_work_before(work, job->state);
    work->job_of[cell] = (uint32_t)work->job_count;
    return ISO_OK;
}

/* ---- memory */

/* So many more bricks can be taken. */
static iso_status reserve(iso_work *work, size_t bricks, iso_error *error) {
    return iso_slabs_reserve(&work->slabs, work->taken + bricks, error);
}

/* (which brick goes to which job does not matter) */
static float *take(iso_work *work) {
    return iso_slabs_brick(&work->slabs, __atomic_fetch_add(&work->taken, 1, __ATOMIC_RELAXED));
}

iso_status iso_work_reserve(iso_work *work, iso_error *error) {
    return reserve(work, work->job_count + (size_t)iso_pool_threads(work->pool), error);
}

/* Memory of the job's own that holds neither of two values. */
static float *room(iso_work *work, iso_job *job, const float *one, const float *two) {
    int i = 0;
    while (job->own[i] && (job->own[i] == one || job->own[i] == two)) i++;
    if (!job->own[i]) job->own[i] = take(work);
    return job->own[i];
}

static bool is_own(const iso_job *job, const float *values) {
    bool own = false;
    for (int i = 0; i < ISO_WORK_FIELDS; i++) own |= job->own[i] == values;
    return own;
}

float *iso_work_own(iso_work *work, size_t number) {
    iso_job *job = iso_work_job(work, number);
    const float *values = job->value[work->now];
    if (!is_own(job, values)) {
        float *own = room(work, job, NULL, NULL);
        memcpy(own, values, ISO_BRICK_VOXELS * sizeof *own);
        job->value[work->now] = own;
    }
    return (float *)job->value[work->now];
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
    stencil->self = grid ? iso_work_before(work, job->state) : job->value[field];
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
        stencil->face[face] = beside ? iso_work_job(work, beside - 1)->value[field]
                                     : iso_work_before(work, work->grid->cell[cell]);
    }
}

/* ---- what changed */

void iso_work_find_box(iso_job *job, const iso_voxel_bits *marked) {
    enum { LOW = (1 << SPREAD) - 1, HIGH = LOW << (ISO_BRICK - SPREAD) };
    uint32_t x = 0, y = 0, z = 0;
    for (int i = 0; i < ISO_BRICK; i++) {
        uint32_t any = 0, low = 0, high = 0;
        for (int k = 0; k < ISO_BRICK; k++) {
            const uint32_t bits = marked->row[i * ISO_BRICK + k];
            x |= bits;
            any |= (uint32_t)(bits != 0) << k;
            low |= (uint32_t)((bits & LOW) != 0) << k;
            high |= (uint32_t)((bits & HIGH) != 0) << k;
        }
        job->rows.any[i] = (uint16_t)any;
        job->rows.low[i] = (uint16_t)low;
        job->rows.high[i] = (uint16_t)high;
        y |= any;
        z |= (uint32_t)(any != 0) << i;
    }
    const uint32_t bits[3] = {x, y, z};
    for (int axis = 0; axis < 3; axis++) {
        job->lo[axis] = (uint8_t)__builtin_ctz(bits[axis] | 1u << 31);
        job->hi[axis] = (uint8_t)(31 - __builtin_clz(bits[axis] | 1));
    }
}

float *iso_work_stage(iso_work *work, int worker) {
    iso_worker *own = &work->workers[worker];
    if (!own->stage) own->stage = take(work);
    return own->stage;
}

/* A brush that begins with other values than the grid's has changed what it changed of those: what it only
 * puts back makes no neighbours change. */
void iso_work_edited(iso_work *work, size_t number, int worker) {
    iso_job *job = iso_work_job(work, number);
    float *values = work->workers[worker].stage;
    const float *before = iso_work_before(work, job->state);
    job->edited = work->dab->settle(job->source ? job->source : before, iso_mask_bits(&work->mask, job->cell),
                                    values, &job->changed);
    if (job->source) job->edited |= memcmp(values, before, ISO_BRICK_VOXELS * sizeof *values) != 0;
    if (!job->edited) return;
    job->value[work->now] = job->own[0] = values;
    work->workers[worker].stage = NULL;
}

/* Closes up: jobs that nothing happened to go. */
static void drop_unchanged(iso_work *work) {
    size_t kept = 0;
    for (size_t i = 0; i < work->job_count; i++) {
        const iso_job *job = iso_work_job(work, i);
        work->job_of[job->cell] = 0;
        if (!job->edited) continue;
        if (kept != i) *iso_work_job(work, kept) = *job;
        work->job_of[job->cell] = (uint32_t)++kept;
    }
    work->job_count = kept;
}

/* Where redistancing of an edited job begins. */
static void seam_job(void *context, size_t index, int worker) {
    static const iso_voxel_bits none;
    iso_work *work = context;
    iso_job *job = iso_work_job(work, index);
    iso_voxel_bits seam;
    if (work->away == 0) {
        iso_work_find_box(job, &job->changed);
        return;
    }
    iso_stencil stencil;
    iso_work_stencil(work, work->now, index, work->workers[worker].border, &stencil);
    iso_seam_side side = {.self = &job->changed, .away = work->away};
    for (int face = 0; face < 6; face++) {
        int sides[3] = {0};
        sides[face / 2] = face % 2 ? 1 : -1;
        const iso_job *beside = iso_work_beside(work, job, sides);
        side.face[face] = beside ? &beside->changed : &none;
    }
    work->redistancer->find_seam(&stencil, &side, &seam);
    iso_work_find_box(job, &seam);
}

/* Whether the job has a voxel inside the band within REACH of the neighbour at `side` (-1, 0, 1 an axis). */
static bool band_near(const iso_work *work, size_t number, const int side[3]) {
    const float *values = iso_work_values(work, number), band = work->grid->band;
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

/* Whether what redistancing begins from lies within REACH of that neighbour. */
static bool begins_near(const iso_job *job, const int side[3]) {
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
        if (!within || !begins_near(job, side)) continue;
        int32_t state = work->grid->cell[iso_hgrid_cell_index(work->grid, at[0], at[1], at[2])];
        if (state < 0 && !work->torn && !band_near(work, number, side)) continue;
        ISO_TRY(iso_work_add(work, at, false, error));
    }
    return ISO_OK;
}

iso_status iso_work_settle(iso_work *work, bool neighbours, bool *any, iso_error *error) {
    drop_unchanged(work);
    size_t edited = work->job_count;
    *any = edited > 0;
    if (!neighbours) return ISO_OK;
    const bool frozen = iso_wall_near(work);
    if (frozen) { /* the brush did not go where distances to what it left may reach */
        work->away = 0;
        work->torn = true;
        ISO_TRY(iso_wall_find(work, error));
    }
    iso_parallel_for(work->pool, edited, seam_job, work);
    for (size_t i = 0; i < edited; i++) ISO_TRY(add_neighbours(work, i, error));
    if (!frozen) return ISO_OK;
    ISO_TRY(reserve(work, work->job_count, error));
    iso_wall_close(work);
    return ISO_OK;
}

/* ---- redistancing */

typedef struct pass {
    iso_work *work;
    int from, to, phi; /* fields */
    int turn;          /* of job->moved: which this step writes */
    bool first;        /* step */
    float least;       /* of iso_relaxation */
} pass;

/* Adds the marked rows of the job beside that are within SPREAD, in rows of this one: plane[z + SPREAD] bit
 * (y + SPREAD). */
static void add_rows(const iso_job *beside, const int side[3], uint32_t plane[ISO_BRICK + 2 * SPREAD]) {
    const uint16_t *rows = side[0] == 0  ? beside->rows.any
                           : side[0] < 0 ? beside->rows.high
                                         : beside->rows.low;
    const int first = side[2] < 0 ? ISO_BRICK - SPREAD : 0, last = side[2] > 0 ? SPREAD - 1 : ISO_BRICK - 1;
    for (int z = first; z <= last; z++) {
        const uint32_t bits = rows[z], into = side[1] == 0 ? bits << SPREAD
                                              : side[1] < 0
                                                  ? bits >> (ISO_BRICK - SPREAD)
                                                  : (bits & ((1 << SPREAD) - 1)) << (ISO_BRICK + SPREAD);
        plane[z + ISO_BRICK * side[2] + SPREAD] |= into;
    }
}

static void set_rows(iso_row_bits *rows, int z, uint32_t bits) {
    rows->word[z / 2] |= (bits & 0xffff) << 16 * (z % 2);
}

static uint32_t rows_of(const iso_row_bits *rows, int z) {
    return rows->word[z / 2] >> 16 * (z % 2) & 0xffff;
}

/* The other rows need not be made distances again: they are. */
static void near_rows(const iso_work *work, const iso_job *job, iso_row_bits *near) {
    uint32_t plane[ISO_BRICK + 2 * SPREAD] = {0};
    for (int k = 0; k < 27; k++) {
        const int side[3] = {k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1};
        const iso_job *beside = iso_work_beside(work, job, side);
        if (beside && beside->edited) add_rows(beside, side, plane);
    }
    for (int z = 0; z < ISO_BRICK + 2 * SPREAD; z++)
        for (int step = 0; step < SPREAD; step++) plane[z] |= plane[z] << 1 | plane[z] >> 1;
    memset(near, 0, sizeof *near);
    for (int z = 0; z < ISO_BRICK; z++) {
        uint32_t rows = 0;
        for (int step = 0; step <= 2 * SPREAD; step++) rows |= plane[z + step];
        set_rows(near, z, rows >> SPREAD);
    }
}

/* What is frozen is not rescaled, and beyond what can have changed stays as it is. */
static void freeze(const iso_work *work, iso_job *job, const iso_voxel_bits *masked) {
    iso_voxel_bits reached;
    iso_wall_reach(work, job, &reached);
    for (int row = 0; row < ISO_BRICK_ROWS; row++) {
        const uint16_t still = masked->row[row] & (uint16_t)~reached.row[row];
        job->band.frozen.row[row] |= still;
        job->band.lost.row[row] &= (uint16_t)~masked->row[row];
        job->still |= still != 0;
    }
}

static void classify_job(void *context, size_t index, int worker) {
    const pass *p = context;
    iso_job *job = iso_work_job(p->work, index);
    iso_stencil stencil;
    iso_row_bits near;
    iso_work_stencil(p->work, p->from, index, p->work->workers[worker].border, &stencil);
    near_rows(p->work, job, &near);
    p->work->redistancer->classify(&stencil, p->work->grid->band, &near, &job->band);
    if (p->work->torn) job->band.active = near;
    const iso_voxel_bits *masked = iso_mask_bits(&p->work->mask, job->cell);
    if (masked) freeze(p->work, job, masked);
}

/* Whether the brush changed a voxel at the interface, or brought the interface to one that it did not change.
 */
static bool is_rescaled(const iso_job *job) {
    uint32_t any = 0;
    for (int row = 0; row < ISO_BRICK_ROWS; row++)
        any |= (job->band.frozen.row[row] & job->changed.row[row]) | job->band.lost.row[row];
    return any != 0;
}

static void rescale_job(void *context, size_t index, int worker) {
    const pass *p = context;
    iso_job *job = iso_work_job(p->work, index);
    job->value[p->to] = job->value[p->from];
    if (!is_rescaled(job)) return;
    iso_stencil stencil;
    iso_work_stencil(p->work, p->from, index, p->work->workers[worker].border, &stencil);
    float *out = room(p->work, job, stencil.self, NULL);
    p->work->redistancer->rescale(&stencil, &job->band, &job->changed, out);
    job->value[p->to] = out;
}

static void correct_job(void *context, size_t index, int worker) {
    const pass *p = context;
    iso_job *job = iso_work_job(p->work, index);
    job->value[p->to] = job->value[p->from];
    if (!is_rescaled(job)) return;
    iso_stencil phi, scaled;
    iso_work_stencil(p->work, p->phi, index, &p->work->workers[worker].border[0], &phi);
    iso_work_stencil(p->work, p->from, index, &p->work->workers[worker].border[1], &scaled);
    float *out = room(p->work, job, phi.self, scaled.self);
    p->work->redistancer->correct(&phi, &scaled, &job->band, &job->changed, out);
    job->value[p->to] = out;
}

/* Rows of the active ones whose stencils hold what the last step moved. */
static void find_due(const pass *p, const iso_job *job, iso_row_bits *due) {
    enum { FAR = 2 };                                                   /* what the stencil reaches */
    uint32_t plane[ISO_BRICK + 2 * FAR] = {0}, across[ISO_BRICK] = {0}; /* bit y + FAR; bit y */
    const int last = 1 - p->turn;
    for (int z = 0; z < ISO_BRICK; z++) plane[z + FAR] = rows_of(&job->moved[last], z) << FAR;
    for (int face = 0; face < 6; face++) {
        const int up = face % 2, side[3] = {face / 2 == 0 ? 2 * up - 1 : 0, face / 2 == 1 ? 2 * up - 1 : 0,
                                            face / 2 == 2 ? 2 * up - 1 : 0};
        const iso_job *beside = iso_work_beside(p->work, job, side);
        if (!beside) continue;
        const iso_row_bits *moved = &beside->moved[last];
        for (int z = 0; z < ISO_BRICK && side[0]; z++) across[z] |= rows_of(moved, z);
        for (int z = 0; z < ISO_BRICK && side[1]; z++)
            plane[z + FAR] |= up ? (rows_of(moved, z) & ((1 << FAR) - 1)) << (ISO_BRICK + FAR)
                                 : rows_of(moved, z) >> (ISO_BRICK - FAR);
        for (int z = 0; z < FAR && side[2]; z++)
            plane[up ? ISO_BRICK + FAR + z : z] |= rows_of(moved, up ? z : ISO_BRICK - FAR + z) << FAR;
    }
    memset(due, 0, sizeof *due);
    for (int z = 0; z < ISO_BRICK; z++) {
        uint32_t rows = plane[z + FAR];
        rows |= rows << 1 | rows << 2 | rows >> 1 | rows >> 2;
        rows |= plane[z] | plane[z + 1] | plane[z + 3] | plane[z + 4];
        set_rows(due, z, rows >> FAR | across[z]);
    }
    for (int i = 0; i < ISO_ROW_WORDS; i++) due->word[i] &= job->band.active.word[i];
}

/* A step need only be taken where the one before has moved something. */
static void relax_job(void *context, size_t index, int worker) {
    const pass *p = context;
    iso_work *work = p->work;
    iso_job *job = iso_work_job(work, index);
    iso_relaxation step = {.due = job->band.active, .band = work->grid->band, .least = p->least};
    if (!p->first) find_due(p, job, &step.due);
    uint32_t any = 0;
    for (int i = 0; i < ISO_ROW_WORDS; i++) any |= step.due.word[i];
    job->value[p->to] = job->value[p->from];
    memset(&job->moved[p->turn], 0, sizeof job->moved[p->turn]);
    if (!any) return;
    iso_stencil stencil;
    iso_work_stencil(work, p->from, index, work->workers[worker].border, &stencil);
    float *out = job->spare ? job->spare : room(work, job, stencil.self, NULL);
    if (job->spare)
        step.stale = job->stale;
    else
        memset(&step.stale, 0xff, sizeof step.stale);
    work->redistancer->relax(&stencil, &job->band.frozen, &step, out, &job->moved[p->turn]);
    job->value[p->to] = out;
    job->stale = step.due;
    job->spare = is_own(job, stencil.self) ? (float *)stencil.self : NULL;
}

static void run(const pass *p, iso_task *task) {
    iso_parallel_for(p->work->pool, p->work->job_count, task, (void *)p);
}

iso_status iso_work_redistance(iso_work *work, int iterations, bool rescale, iso_error *error) {
    pass p = {.work = work,
              .from = work->now,
              .to = (work->now + 1) % ISO_WORK_FIELDS,
              .phi = work->now,
              .first = true,
              .least = rescale ? LEAST_RESCALED : LEAST_FROZEN};
    ISO_TRY(reserve(work, work->job_count * (rescale ? 3 : 2), error));
    run(&p, classify_job);
    work->redistanced = true;
    if (rescale) {
        run(&p, rescale_job);
        p.from = p.to;
        p.to = (p.phi + 2) % ISO_WORK_FIELDS;
        run(&p, correct_job);
        p.from = p.to;
        p.to = p.phi;
    }
    for (int i = 0; i < iterations; i++) {
        ISO_TRY(iso_progress_tell(work->progress, "the field", (double)i / iterations, error));
        p.turn = i % 2;
        p.first = i == 0;
        run(&p, relax_job);
        const int swap = p.from;
        p.from = p.to;
        p.to = swap;
    }
    work->now = p.from;
    return ISO_OK;
}

static void sides_job(void *context, size_t index, int worker) {
    (void)worker;
    const iso_work *work = context;
    iso_job *job = iso_work_job(work, index);
    job->sides = job->still ? BOTH_SIDES : (uint8_t)work->redistancer->sides(iso_work_values(work, index));
}

/* The sides of the interface that a cell's voxels are on, for all that is known: bricks that are no jobs may
 * have both. */
static unsigned sides_of(const iso_work *work, const int at[3]) {
    const size_t cell = iso_hgrid_cell_index(work->grid, at[0], at[1], at[2]);
    if (work->job_of[cell]) return iso_work_job(work, work->job_of[cell] - 1)->sides;
    return work->grid->cell[cell] >= 0 ? BOTH_SIDES : 1u << (work->grid->cell[cell] == ISO_CELL_INSIDE);
}

/* A surface that was taken away leaves distances to nothing behind. Where neither a cell nor any around it
 * has an interface, they go at once. */
static void clear_ghost(void *context, size_t index, int worker) {
    (void)worker;
    iso_work *work = context;
    iso_job *job = iso_work_job(work, index);
    unsigned sides = job->sides;
    for (int k = 0; k < 27 && sides != BOTH_SIDES; k++) {
        const int at[3] = {job->at[0] + k % 3 - 1, job->at[1] + k / 3 % 3 - 1, job->at[2] + k / 9 - 1};
        bool within = true;
        for (int axis = 0; axis < 3; axis++) within &= at[axis] >= 0 && at[axis] < work->grid->cells[axis];
        if (within) sides |= sides_of(work, at);
    }
    if (sides != BOTH_SIDES) job->value[work->now] = work->constant[sides >> 1];
}

static void compare_job(void *context, size_t index, int worker) {
    (void)worker;
    const iso_work *work = context;
    iso_job *job = iso_work_job(work, index);
    const float *before = iso_work_before(work, job->state), *values = iso_work_values(work, index);
    job->edited = before != values && work->dab->settle(before, NULL, (float *)values, &job->changed);
    if (job->edited) iso_work_find_box(job, &job->changed);
}

void iso_work_compare(iso_work *work, bool *any) {
    if (work->redistanced) {
        iso_parallel_for(work->pool, work->job_count, sides_job, work);
        iso_parallel_for(work->pool, work->job_count, clear_ghost, work);
    }
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

static void find_empty(void *context, size_t index, int worker) {
    (void)worker;
    const iso_work *work = context;
    iso_job *job = iso_work_job(work, index);
    if (job->edited) job->empty = empty_state(work, iso_work_values(work, index));
}

/* Everything that can fail: the log's entries (too many do no harm) and the bricks, which hold nothing yet.
 */
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
        if (job->state >= 0 || job->empty) continue;
        ISO_TRY(iso_hgrid_split_unset(work->grid, job->at[0], job->at[1], job->at[2], error));
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
    iso_parallel_for(work->pool, work->job_count, find_empty, work);
    iso_status status = prepare(work, &made, error);
    if (status != ISO_OK) {
        take_back(work);
        return status;
    }
    for (size_t i = 0; i < work->job_count; i++) {
        const iso_job *job = iso_work_job(work, i);
        if (!job->edited) continue;
        if (job->empty) {
            made.pruned += job->state >= 0;
            iso_hgrid_coalesce(work->grid, job->at[0], job->at[1], job->at[2], job->empty);
        } else
            memcpy(iso_hgrid_brick(work->grid, work->grid->cell[job->cell]), iso_work_values(work, i),
                   ISO_BRICK_VOXELS * sizeof(float));
    }
    *stats = made;
    return ISO_OK;
}
