#include "sculpt/field/wall.h"

#include <math.h>

static const float HALF = 0.5f; /* of an edge, in voxels */

/* A voxel of an edited job. */
typedef struct wall_voxel {
    uint32_t job;
    uint16_t at;
} wall_voxel;

typedef struct place {
    uint32_t cell, job; /* job: 1 + its number, 0: none */
    int at;
} place;

static bool is_bit(const iso_voxel_bits *bits, int at) {
    return bits->row[at / ISO_BRICK] >> at % ISO_BRICK & 1;
}

static bool is_masked(const iso_work *work, const place *p) {
    const iso_voxel_bits *bits = iso_mask_bits(&work->mask, p->cell);
    return bits && is_bit(bits, p->at);
}

static bool is_changed(const iso_work *work, const place *p) {
    return p->job && is_bit(&iso_work_job(work, p->job - 1)->changed, p->at);
}

static float value_of(const iso_work *work, const place *p) {
    return p->job ? iso_work_values(work, p->job - 1)[p->at]
                  : iso_work_before(work, work->grid->cell[p->cell])[p->at];
}

/* The voxel across `face`, -x, +x, -y ...; false beyond the grid. */
static bool beside(const iso_work *work, const place *p, int face, place *out) {
    const int axis = face / 2, step = axis == 0 ? 1 : axis == 1 ? ISO_BRICK : ISO_BRICK_ROWS;
    const int *cells = work->grid->cells, up = face % 2, at = p->at / step % ISO_BRICK;
    *out = *p;
    if (at != (up ? ISO_BRICK - 1 : 0)) {
        out->at += up ? step : -step;
        return true;
    }
    const uint32_t stride = axis == 0 ? 1 : (uint32_t)cells[0] * (axis == 1 ? 1 : (uint32_t)cells[1]);
    const int cell = (int)(p->cell / stride % (uint32_t)cells[axis]);
    if (cell == (up ? cells[axis] - 1 : 0)) return false;
    out->cell = up ? p->cell + stride : p->cell - stride;
    out->job = work->job_of[out->cell];
    out->at -= (up ? 1 : -1) * (ISO_BRICK - 1) * step;
    return true;
}

/* The voxel across `face` when it is on the surface's other side. */
static bool across(const iso_work *work, const place *p, int face, place *out) {
    return beside(work, p, face, out) && (value_of(work, p) < 0) != (value_of(work, out) < 0);
}

static bool wall_across(const iso_work *work, const place *changed, int face, place *frozen) {
    return across(work, changed, face, frozen) && is_masked(work, frozen);
}

/* How far a changed voxel can be from the surface; *wall: whether a frozen one is across it. */
static float bound_changed(const iso_work *work, const place *changed, bool *wall) {
    float most = fabsf(value_of(work, changed));
    place frozen;
    *wall = false;
    for (int face = 0; face < 6; face++) {
        if (!wall_across(work, changed, face, &frozen)) continue;
        *wall = true;
        most = fminf(most, fmaxf(1 - fabsf(value_of(work, &frozen)), HALF));
    }
    return most;
}

bool iso_wall_near(const iso_work *work) {
    for (size_t i = 0; i < work->job_count && work->mask.used; i++) {
        const iso_job *job = iso_work_job(work, i);
        for (int k = 0; k < 27 && job->edited; k++) {
            const int at[3] = {job->at[0] + k % 3 - 1, job->at[1] + k / 3 % 3 - 1, job->at[2] + k / 9 - 1};
            bool within = true;
            for (int axis = 0; axis < 3; axis++)
                within &= at[axis] >= 0 && at[axis] < work->grid->cells[axis];
            if (within && iso_mask_bits(&work->mask, iso_hgrid_cell_index(work->grid, at[0], at[1], at[2])))
                return true;
        }
    }
    return false;
}

/* Voxels of a row that have a frozen one across a face. */
static uint32_t beside_frozen(const iso_work *work, uint32_t cell, int row) {
    uint32_t bits = 0;
    place from = {.cell = cell}, to;
    for (int face = 0; face < 6; face++) {
        const int end = face == 1 ? ISO_BRICK - 1 : 0;
        from.at = row * ISO_BRICK + end;
        if (face < 2) { /* along the row */
            const iso_voxel_bits *own = iso_mask_bits(&work->mask, cell);
            const uint32_t frozen = own ? own->row[row] : 0;
            bits |= face ? frozen >> 1 : frozen << 1;
            if (beside(work, &from, face, &to)) bits |= (uint32_t)is_masked(work, &to) << end;
        } else if (beside(work, &from, face, &to)) {
            const iso_voxel_bits *other = iso_mask_bits(&work->mask, to.cell);
            bits |= other ? other->row[to.at / ISO_BRICK] : 0;
        }
    }
    return bits;
}

static iso_status find_in_row(iso_work *work, uint32_t number, int row, iso_error *error) {
    iso_job *job = iso_work_job(work, number);
    if (!job->changed.row[row]) return ISO_OK;
    uint32_t bits = job->changed.row[row] & beside_frozen(work, job->cell, row);
    for (; bits; bits &= bits - 1) {
        const place changed = {job->cell, number + 1, row * ISO_BRICK + __builtin_ctz(bits)};
        bool wall;
        const float most = bound_changed(work, &changed, &wall);
        if (!wall) continue;
        const size_t bytes = work->wall_count * sizeof(wall_voxel);
        ISO_TRY(iso_buffer_reserve(&work->walls, bytes + sizeof(wall_voxel), bytes, error));
        ((wall_voxel *)work->walls.data)[work->wall_count++] = (wall_voxel){number, (uint16_t)changed.at};
        float *value = &job->own[0][changed.at];
        *value = *value < 0 ? -most : most;
    }
    return ISO_OK;
}

iso_status iso_wall_find(iso_work *work, iso_error *error) {
    work->wall_count = 0;
    for (uint32_t job = 0; job < work->job_count; job++)
        for (int row = 0; row < ISO_BRICK_ROWS; row++) ISO_TRY(find_in_row(work, job, row, error));
    return ISO_OK;
}

/* Whether a frozen voxel is at a surface that the brush left where it is. */
static bool is_held(const iso_work *work, const place *frozen) {
    place other;
    for (int face = 0; face < 6; face++)
        if (across(work, frozen, face, &other) && !is_changed(work, &other)) return true;
    return false;
}

void iso_wall_close(iso_work *work) {
    for (size_t i = 0; i < work->wall_count; i++) {
        const wall_voxel *wall = (const wall_voxel *)work->walls.data + i;
        const place changed = {iso_work_job(work, wall->job)->cell, wall->job + 1, wall->at};
        const float left = 1 - fabsf(value_of(work, &changed));
        place frozen;
        for (int face = 0; face < 6; face++) {
            if (!wall_across(work, &changed, face, &frozen) || is_held(work, &frozen)) continue;
            const float value = value_of(work, &frozen);
            if (fabsf(value) <= left) continue;
            iso_work_own(work, frozen.job - 1)[frozen.at] = value < 0 ? -left : left;
        }
    }
}

/* Voxels of a job and SPREAD on each side: bit x + SPREAD of row[z + SPREAD][y + SPREAD]. */
enum { SPREAD = ISO_WORK_SPREAD, WIDE = ISO_BRICK + 2 * SPREAD };
typedef struct surroundings {
    uint32_t row[WIDE][WIDE];
} surroundings;

static void add_changed(const iso_voxel_bits *changed, const int side[3], surroundings *s) {
    int lo[3], hi[3];
    for (int axis = 0; axis < 3; axis++) {
        lo[axis] = side[axis] < 0 ? ISO_BRICK - SPREAD : 0;
        hi[axis] = side[axis] > 0 ? SPREAD : ISO_BRICK;
    }
    for (int z = lo[2]; z < hi[2]; z++)
        for (int y = lo[1]; y < hi[1]; y++) {
            const uint32_t bits = changed->row[z * ISO_BRICK + y] & ((1u << hi[0]) - (1u << lo[0]));
            s->row[z + ISO_BRICK * side[2] + SPREAD][y + ISO_BRICK * side[1] + SPREAD] |=
                side[0] < 0 ? bits >> (ISO_BRICK - SPREAD) : bits << (ISO_BRICK * side[0] + SPREAD);
        }
}

/* Bits of rows within SPREAD of row `at`, `step` apart. */
static uint32_t spread_rows(const uint32_t *rows, int at, int step) {
    uint32_t bits = 0;
    for (int i = at - SPREAD; i <= at + SPREAD; i++) bits |= rows[i * step];
    return bits;
}

void iso_wall_reach(const iso_work *work, const iso_job *job, iso_voxel_bits *reached) {
    surroundings s = {0}, along_y = {0};
    for (int k = 0; k < 27; k++) {
        const int side[3] = {k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1};
        const iso_job *beside = iso_work_beside(work, job, side);
        if (beside && beside->edited) add_changed(&beside->changed, side, &s);
    }
    for (int z = 0; z < WIDE; z++)
        for (int y = SPREAD; y < WIDE - SPREAD; y++) along_y.row[z][y] = spread_rows(s.row[z], y, 1);
    for (int row = 0; row < ISO_BRICK_ROWS; row++) {
        uint32_t bits =
            spread_rows(&along_y.row[0][row % ISO_BRICK + SPREAD], row / ISO_BRICK + SPREAD, WIDE);
        for (int i = 0; i < SPREAD; i++) bits |= bits << 1 | bits >> 1;
        reached->row[row] = (uint16_t)(bits >> SPREAD);
    }
}
