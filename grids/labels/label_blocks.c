/* label_blocks: smooths labels in blocks of 2 x 2 x 2 bricks: groups, each as if it were one label, for the
 * level sets, and labels where several of a group meet, to tell them apart. Of every one in or near a block
 * the field is computed where its box there has voxels that are needed, and what the level sets need is kept:
 * at each voxel the field of its own label, the greatest of the others, and that of each group. Needed are
 * the corners of the cells that a surface passes and those beside them, for gradients, and around these the
 * voxels that tell whether things are thin there. */
#include "grids/labels/label_blocks.h"

#include <math.h>
#include <string.h>

#include "base/cpu.h"
#include "base/kernel_units.h"
#include "base/memory.h"
#include "grids/labels/label_block.h"

/* By how much a voxel's own label leads, voxels, and by how much more where things are thin, so that sheets
 * of one voxel have few holes. */
static const float LEAD = 0.05f, THIN_LEAD = 0.2f;
/* Where things are thin: the wide filter gives voxels to another label, by more than noise, or takes more
 * than this from their distance to the border. */
static const float THIN_CHANGE = 0.1f, THIN_LOSS = 0.6f;

/* The second Gaussian is sqrt(2) as wide as the first. With back = 1 the surface of a distance field is not
 * moved; a little more makes up for the trilinear interpolation, which makes balls smaller. */
static const iso_label_filter wide = {
    {5, 7},
    {{0.266011725f, 0.213005538f, 0.10936069f, 0.0360007721f, 0.00759875814f, 0.00102838008f},
     {0.188130836f, 0.168346869f, 0.120625802f, 0.0692094667f, 0.0317966163f, 0.0116973214f, 0.00344573645f,
      0.000812770263f}},
    1.13f}; /* 1.5 voxels */
static const iso_label_filter narrow = {
    {3, 4},
    {{0.498676452f, 0.228310716f, 0.0219103142f, 0.000440743367f},
     {0.352632958f, 0.238603394f, 0.0739158834f, 0.0104835015f, 0.000680741752f}},
    1.5f}; /* 0.8 voxels */

/* ---- the field of a label */

/* Where the field of a label is computed. */
typedef struct region {
    const near_label *near;
    const uint64_t *set; /* the voxels of the block's fields for which it is */
    bool everywhere;     /* for all of them; else for those near the label */
    extent box;          /* of these voxels */
} region;

/* The voxels of a row in a region. */
static inline uint64_t region_row(const label_block *b, const region *r, int y, int z) {
    const uint64_t set = r->set[row_in(b, y, z)];
    if (r->everywhere || !set) return set;
    const extent *box = &r->near->box;
    if (y < box->lo[1] || z < box->lo[2] || y >= box->hi[1] || z >= box->hi[2]) return 0;
    return set & r->near->rows[z / 4 * COARSE + y / 4];
}

static inline void grow_extent(extent *e, int lo, int hi, int y, int z) {
    const int first[3] = {lo, y, z}, end[3] = {hi, y + 1, z + 1};
    for (int k = 0; k < 3; k++) {
        e->lo[k] = first[k] < e->lo[k] ? first[k] : e->lo[k];
        e->hi[k] = end[k] > e->hi[k] ? end[k] : e->hi[k];
    }
}

/* Sets the box of a region; false: it has no voxel. */
static bool find_box(const label_block *b, region *r) {
    int lo[3] = {0, 0, 0}, hi[3] = {b->size[0], b->size[1], b->size[2]};
    for (int k = 1; k < 3 && !r->everywhere; k++) {
        lo[k] = r->near->box.lo[k];
        hi[k] = r->near->box.hi[k];
    }
    r->box = (extent){{INT32_MAX, INT32_MAX, INT32_MAX}, {INT32_MIN, INT32_MIN, INT32_MIN}};
    for (int z = lo[2]; z < hi[2]; z++)
        for (int y = lo[1]; y < hi[1]; y++) {
            const uint64_t set = region_row(b, r, y, z);
            if (set) grow_extent(&r->box, first_of(set), end_of(set), y, z);
        }
    return r->box.lo[0] < r->box.hi[0];
}

/* The box of a region and the rows that are needed of it. */
static iso_label_box box_of(const label_block *b, const region *r, int margin, int radius) {
    const block_memory *s = b->s;
    iso_label_box box = {.margin = margin, .radius = radius};
    for (int k = 0; k < 3; k++) box.n[k] = r->box.hi[k] - r->box.lo[k];
    for (int i = 0; i < ISO_LABEL_STEPS; i++) box.lo[i] = s->lo[i], box.hi[i] = s->hi[i];
    const int edge = margin + ISO_LABEL_REACH, pitch = box.n[1] + 2 * edge;
    const size_t rows = (size_t)pitch * (size_t)(box.n[2] + 2 * edge);
    memset(box.lo[ISO_LABEL_RESULTS], UINT8_MAX, rows + ISO_LABEL_GUARD);
    memset(box.hi[ISO_LABEL_RESULTS], 0, rows + ISO_LABEL_GUARD);
    for (int z = 0; z < box.n[2]; z++)
        for (int y = 0; y < box.n[1]; y++) {
            const uint64_t set = region_row(b, r, y + r->box.lo[1], z + r->box.lo[2]);
            const size_t row = (size_t)(z + edge) * (size_t)pitch + (size_t)(y + edge);
            if (!set) continue;
            box.lo[ISO_LABEL_RESULTS][row] = (uint8_t)(first_of(set) - r->box.lo[0]);
            box.hi[ISO_LABEL_RESULTS][row] = (uint8_t)(end_of(set) - r->box.lo[0]);
        }
    b->all->kernel->needs(&box);
    return box;
}

/* mask = 0 at voxels of the label, in the rows that are needed. */
static void make_mask(const label_block *b, const region *r, const iso_label_box *box) {
    const int edge = box->margin + ISO_LABEL_REACH,
              size[3] = {box->n[0] + 2 * edge, box->n[1] + 2 * edge, box->n[2] + 2 * edge};
    const int at[3] = {r->box.lo[0] - edge, r->box.lo[1] - edge, r->box.lo[2] - edge};
    uint16_t copy[MASK + ISO_LABEL_SLACK];
    const label_rows rows = iso_label_block_rows(b, at, size[0], r->near->label, copy);
    for (int z = 0; z < size[2]; z++)
        for (int y = 0; y < size[1]; y++)
            if (box->hi[ISO_LABEL_MASK][z * size[1] + y])
                b->all->kernel->mask(label_row(&rows, y, z), size[0], (uint16_t)r->near->label,
                                     b->s->mask + index_in(size, 0, y, z));
}

/* Computes the distances of a label in a region. */
static void find_distances(const label_block *b, const region *r, const iso_label_box *box,
                           float *distances) {
    block_memory *s = b->s;
    const iso_smooth_kernel *kernel = b->all->kernel;
    make_mask(b, r, box);
    kernel->squares(s->mask, box, s->work8, s->squares);
    kernel->signed_distance(s->squares, box, distances);
}

/* Blends in the narrow filter. */
static void blend(const label_block *b, const region *r, const iso_label_box *box, const float *distances,
                  float *field) {
    block_memory *s = b->s;
    b->all->kernel->filter(distances, box, &narrow, s->work, s->narrowed);
    for (int z = 0; z < box->n[2]; z++)
        for (int y = 0; y < box->n[1]; y++) {
            const uint64_t set = region_row(b, r, y + r->box.lo[1], z + r->box.lo[2]);
            if (!set) continue;
            const float *w = s->weight + index_in(b->size, r->box.lo[0], r->box.lo[1] + y, r->box.lo[2] + z);
            const size_t row = index_in(box->n, 0, y, z);
            const int end = end_of(set) - r->box.lo[0];
            for (int x = first_of(set) - r->box.lo[0]; x < end; x++)
                field[row + (size_t)x] += w[x] * (s->narrowed[row + (size_t)x] - field[row + (size_t)x]);
        }
}

/* The field of a label in a region, and its distances, with a margin of FILTER. */
typedef struct label_field {
    float *field, *distances;
} label_field;

/* Memory for the field of a label by the wide filter, which is kept if there is room. */
static label_field take_field(block_memory *s, near_label *near, const extent *box) {
    size_t count = 1, far = 1;
    for (int k = 0; k < 3; k++) {
        count *= (size_t)(box->hi[k] - box->lo[k]);
        far *= (size_t)(box->hi[k] - box->lo[k] + 2 * FILTER);
    }
    near->kept_field = NULL;
    if (s->kept_count + count + far + 2 * ISO_LABEL_SLACK > KEPT) return (label_field){s->field, s->distance};
    near->kept_field = s->kept + s->kept_count;
    near->kept_distances = near->kept_field + count + ISO_LABEL_SLACK;
    near->kept_box = *box;
    s->kept_count += count + far + 2 * ISO_LABEL_SLACK;
    return (label_field){near->kept_field, near->kept_distances};
}

/* Computes the field of a label in a region; after the first time, with `blends`, from what is kept. */
static label_field make_field(const label_block *b, near_label *near, region *r, bool blends) {
    block_memory *s = b->s;
    const bool kept = blends && near->kept_field;
    if (kept) r->box = near->kept_box;
    const iso_label_box box = box_of(b, r, FILTER, kept ? narrow.radius[1] : FILTER);
    const label_field f = kept     ? (label_field){near->kept_field, near->kept_distances}
                          : blends ? (label_field){s->field, s->distance}
                                   : take_field(s, near, &r->box);
    if (!kept) {
        find_distances(b, r, &box, f.distances);
        b->all->kernel->filter(f.distances, &box, &wide, s->work, f.field);
    }
    if (blends) blend(b, r, &box, f.distances, f.field);
    return f;
}

/* ---- what is kept of it */

/* The voxels of brick `number`, 0 .. 7, of the block, in its fields; false: it has no such brick. */
static bool box_of_brick(const label_block *b, int number, extent *box) {
    for (int k = 0; k < 3; k++) {
        const int place = number >> k & 1;
        if (place * ISO_BRICK >= b->out[k]) return false;
        box->lo[k] = NEAR + place * ISO_BRICK;
        box->hi[k] = box->lo[k] + ISO_BRICK;
    }
    return true;
}

/* The field of a label becomes known to the candidates of bricks. */
static void keep_candidates(const label_block *b, int label, const region *r, const float *field) {
    const extent *box = &r->box;
    const int n[3] = {box->hi[0] - box->lo[0], box->hi[1] - box->lo[1], box->hi[2] - box->lo[2]};
    for (int brick = 0; brick < BRICKS; brick++) {
        iso_label_candidates *c = b->candidates[brick];
        extent part;
        if (!c || !box_of_brick(b, brick, &part)) continue;
        for (int row = 0; row < ISO_BRICK * ISO_BRICK; row++) {
            const int y = part.lo[1] + row % ISO_BRICK, z = part.lo[2] + row / ISO_BRICK;
            if (c->start[row] == c->start[row + 1] || y < box->lo[1] || z < box->lo[2] || y >= box->hi[1] ||
                z >= box->hi[2])
                continue;
            const uint64_t set = region_row(b, r, y, z) >> part.lo[0];
            const float *value =
                field + index_in(n, 0, y - box->lo[1], z - box->lo[2]) + part.lo[0] - box->lo[0];
            for (uint32_t i = c->start[row]; i < c->start[row + 1]; i++)
                if (c->entry[i].label == label && set >> c->entry[i].x & 1)
                    c->entry[i].value = value[c->entry[i].x];
        }
    }
}

/* Where in `best` the values of a group are; those of labels are not told apart. */
static inline size_t best_of(const label_block *b, int label) {
    return b->solids ? (size_t)label * BEST_VOXELS : 0;
}

/* Adds the field of the label in the region to what is known of the voxels. */
static void keep_field(const label_block *b, int label, const region *r, const label_field *f) {
    block_memory *s = b->s;
    const extent *box = &r->box;
    float *best = s->best + best_of(b, label);
    const int m = FILTER, n[3] = {box->hi[0] - box->lo[0], box->hi[1] - box->lo[1], box->hi[2] - box->lo[2]},
              far[3] = {n[0] + 2 * m, n[1] + 2 * m, n[2] + 2 * m};
    for (int z = 0; z < n[2]; z++)
        for (int y = 0; y < n[1]; y++) {
            const uint64_t set = region_row(b, r, y + box->lo[1], z + box->lo[2]) >> box->lo[0];
            if (!set) continue;
            const size_t i = index_in(b->size, box->lo[0], y + box->lo[1], z + box->lo[2]);
            b->all->kernel->keep(set, window_row(b, y + box->lo[1], z + box->lo[2]) + box->lo[0],
                                 (uint16_t)label, f->field + index_in(n, 0, y, z),
                                 f->distances + index_in(far, m, y + m, z + m), s->own + i, s->loss + i,
                                 s->other + i, best + i);
        }
    keep_candidates(b, label, r, f->field);
}

/* Nothing is known of the voxels `set`. */
static void forget(const label_block *b, const uint64_t *set) {
    block_memory *s = b->s;
    const iso_smooth_kernel *kernel = b->all->kernel;
    for (int z = 0; z < b->size[2]; z++)
        for (int y = 0; y < b->size[1]; y++) {
            const uint64_t row = set[row_in(b, y, z)];
            const size_t i = index_in(b->size, 0, y, z);
            if (!row) continue;
            kernel->fill(row, -ISO_LABEL_BAND, s->own + i);
            kernel->fill(row, -ISO_LABEL_BAND, s->other + i);
            for (int g = 0; g <= (b->solids ? b->all->fields->group_count : 0); g++)
                kernel->fill(row, -ISO_LABEL_BAND, s->best + (size_t)g * BEST_VOXELS + i);
        }
}

/* The fields of all groups or labels at the voxels `set` of the block. */
static void make_all(const label_block *b, const uint64_t *set, bool blends) {
    block_memory *s = b->s;
    forget(b, set);
    for (int i = 0; i < s->near_count; i++) {
        near_label *near = &s->near[i];
        region r = {.near = near, .set = set};
        if ((!b->solids && !near->label) || !find_box(b, &r)) continue;
        const label_field f = make_field(b, near, &r, blends);
        keep_field(b, near->label, &r, &f);
    }
}

/* The same if there are but two groups. */
static void make_pair(const label_block *b, const uint64_t *set, bool blends) {
    block_memory *s = b->s;
    near_label *near = &s->near[0];
    region r = {.near = near, .set = set, .everywhere = true};
    if (!find_box(b, &r)) return;
    const label_field f = make_field(b, near, &r, blends);
    const int m = FILTER, *lo = r.box.lo, *hi = r.box.hi,
              n[3] = {hi[0] - lo[0], hi[1] - lo[1], hi[2] - lo[2]},
              far[3] = {n[0] + 2 * m, n[1] + 2 * m, n[2] + 2 * m};
    for (int z = 0; z < n[2]; z++)
        for (int y = 0; y < n[1]; y++) {
            const uint64_t row = set[row_in(b, y + lo[1], z + lo[2])] >> lo[0];
            const size_t i = index_in(b->size, lo[0], y + lo[1], z + lo[2]);
            for (int g = 0; row && g <= b->all->fields->group_count; g++)
                if (g != near->label && g != s->near[1].label)
                    b->all->kernel->fill(row, -ISO_LABEL_BAND, s->best + best_of(b, g) + i);
            float *const best[2] = {s->best + best_of(b, near->label) + i,
                                    s->best + best_of(b, s->near[1].label) + i};
            b->all->kernel->keep_pair(row, window_row(b, y + lo[1], z + lo[2]) + lo[0], (uint16_t)near->label,
                                      -ISO_LABEL_BAND, f.field + index_in(n, 0, y, z),
                                      f.distances + index_in(far, m, y + m, z + m), s->own + i, s->loss + i,
                                      s->other + i, best);
        }
}

/* ---- where things are thin */

/* Finds such voxels, and sets the weights of the narrow filter: 1 within a voxel of them, 0 from NEAR voxels
 * on, and `blended`. False: there is none with a weight. */
static bool find_thin(const label_block *b) {
    enum { R = ISO_LABEL_REACH };
    block_memory *s = b->s;
    const int padded[3] = {b->size[0] + 2 * R, b->size[1] + 2 * R, b->size[2] + 2 * R};
    const iso_smooth_kernel *kernel = b->all->kernel;
    bool any = false;
    for (int z = 0; z < b->size[2]; z++)
        for (int y = 0; y < b->size[1]; y++) {
            const size_t row = row_in(b, y, z), i = index_in(b->size, 0, y, z);
            uint64_t thin = !s->needed[row]
                                ? 0
                                : s->needed[row] & kernel->thin(s->own + i, s->other + i, s->loss + i,
                                                                b->size[0], THIN_CHANGE, THIN_LOSS);
            if (thin && !any)
                memset(s->mask, UINT8_MAX, (size_t)padded[0] * (size_t)padded[1] * (size_t)padded[2]);
            any |= thin != 0;
            for (; thin; thin &= thin - 1) s->mask[index_in(padded, first_of(thin) + R, y + R, z + R)] = 0;
        }
    if (!any) return false;
    const region r = {
        .set = s->drawn, .everywhere = true, .box = {{0, 0, 0}, {b->size[0], b->size[1], b->size[2]}}};
    const iso_label_box box = box_of(b, &r, 0, 0);
    kernel->squares(s->mask, &box, s->work8, s->squares);
    any = false;
    for (int z = 0; z < b->size[2]; z++)
        for (int y = 0; y < b->size[1]; y++) {
            const size_t row = row_in(b, y, z);
            s->blended[row] = 0;
            for (uint64_t set = s->drawn[row]; set; set &= set - 1) {
                const size_t i = index_in(b->size, first_of(set), y, z);
                const int square = s->squares[i] < 0 ? ~s->squares[i] : 0;
                const float w = square < NEAR * NEAR ? (NEAR - sqrtf((float)square)) / (NEAR - 1) : 0;
                s->weight[i] = w > 1 ? 1 : w;
                if (w > 0) s->blended[row] |= set & -set;
            }
            any |= s->blended[row] != 0;
        }
    return any;
}

/* ---- candidates */

/* Lists the labels at and around a voxel that share a group with others, each once; returns their number. */
static int list_candidates(const label_block *b, int x, int y, int z, iso_label_value list[NEIGHBOURS]) {
    const iso_label_fields *f = b->all->fields;
    int count = 0, last = -1;
    for (int dz = -1; dz <= 1; dz++)
        for (int dy = -1; dy <= 1; dy++) {
            const uint16_t *row = window_row(b, y + dy, z + dz) + x;
            for (int dx = -1; dx <= 1; dx++) {
                const int label = row[dx];
                if (label == last || f->labels_in_group[f->group[label]] < 2 || !label) continue;
                last = label;
                int i = 0;
                while (i < count && list[i].label != label) i++;
                if (i == count) list[count++] = (iso_label_value){(uint16_t)label, 0, -ISO_LABEL_BAND};
            }
        }
    return count;
}

/* ISO_ERR_NOMEM (without a message). */
static iso_status make_candidates(label_block *b, int brick) {
    extent part;
    iso_label_value *list = b->s->entries;
    uint32_t start[ISO_BRICK * ISO_BRICK + 1], count = 0;
    if (!box_of_brick(b, brick, &part)) return ISO_OK;
    for (int row = 0; row < ISO_BRICK * ISO_BRICK; row++) {
        const int y = part.lo[1] + row % ISO_BRICK, z = part.lo[2] + row / ISO_BRICK;
        uint64_t marked = b->s->drawn[row_in(b, y, z)] & range_of(part.lo[0], part.hi[0]);
        start[row] = count;
        for (; marked; marked &= marked - 1) {
            const int x = first_of(marked), n = list_candidates(b, x, y, z, list + count);
            for (int i = 0; i < n; i++) list[count + (uint32_t)i].x = (uint16_t)(x - part.lo[0]);
            count += n > 1 ? (uint32_t)n : 0;
        }
    }
    start[ISO_BRICK * ISO_BRICK] = count;
    if (!count) return ISO_OK;
    iso_label_candidates *c = iso_alloc(sizeof *c + count * sizeof *list);
    if (!c) return ISO_ERR_NOMEM;
    memcpy(c->start, start, sizeof start);
    memcpy(c->entry, list, count * sizeof *list);
    b->candidates[brick] = c;
    return ISO_OK;
}

/* ---- the level sets */

/* Raises the own label of a voxel above the others. */
static void raise_own(const label_block *b, int x, int y, int z) {
    block_memory *s = b->s;
    const size_t i = index_in(b->size, x, y, z);
    const float least = s->other[i] + LEAD + (s->blends ? s->weight[i] * THIN_LEAD : 0);
    const int label = window_row(b, y, z)[x];
    float *best = s->best + best_of(b, label) + i;
    s->own[i] = least;
    *best = *best > least ? *best : least;
    for (int brick = 0; brick < BRICKS; brick++) {
        iso_label_candidates *c = b->candidates[brick];
        extent part;
        if (!c || !box_of_brick(b, brick, &part)) continue;
        const int at[3] = {x - part.lo[0], y - part.lo[1], z - part.lo[2]};
        if (at[0] < 0 || at[1] < 0 || at[2] < 0 || at[0] >= ISO_BRICK || at[1] >= ISO_BRICK ||
            at[2] >= ISO_BRICK)
            continue;
        const int row = at[2] * ISO_BRICK + at[1];
        for (uint32_t e = c->start[row]; e < c->start[row + 1]; e++)
            if (c->entry[e].x == at[0] && c->entry[e].label == label) c->entry[e].value = least;
    }
}

/* Raises the own labels of the voxels that need it. */
static void raise_all(const label_block *b) {
    const block_memory *s = b->s;
    for (int z = NEAR; z < NEAR + b->out[2]; z++)
        for (int y = NEAR; y < NEAR + b->out[1]; y++) {
            const uint64_t drawn = s->drawn[row_in(b, y, z)];
            const size_t i = index_in(b->size, 0, y, z);
            if (!drawn) continue;
            uint64_t weak =
                drawn & b->all->kernel->weak(s->own + i, s->other + i, s->blends ? s->weight + i : NULL,
                                             b->size[0], LEAD, THIN_LEAD);
            for (; weak; weak &= weak - 1) raise_own(b, first_of(weak), y, z);
        }
}

/* Half of what `value` is above `most`, negative where it is, in the band. */
static inline float level_of(float value, float most) {
    const float level = (most - value) / 2;
    return level > ISO_LABEL_BAND ? ISO_LABEL_BAND : level < -ISO_LABEL_BAND ? -ISO_LABEL_BAND : level;
}

/* Sets a row of a group's level set, whose first voxel is x, y, z of the fields. */
static void write_row(const label_block *b, int group, int x, int y, int z, float *level) {
    const int groups = b->all->fields->group_count;
    const size_t i = index_in(b->size, x, y, z);
    const uint16_t *own_group = window_row(b, y, z) + x;
    uint64_t drawn = b->s->drawn[row_in(b, y, z)] >> x & range_of(0, ISO_BRICK);
    for (int k = 0; k < ISO_BRICK; k++) level[k] = own_group[k] == group ? -ISO_LABEL_BAND : ISO_LABEL_BAND;
    if (!drawn) return;
    const float *best = b->s->best + i, *own = best + (size_t)group * BEST_VOXELS;
    float rest[ISO_BRICK];
    for (int k = 0; k < ISO_BRICK; k++) rest[k] = best[k]; /* of group 0 */
    for (int g = 1; g <= groups; g++) {
        const float *other = best + (size_t)g * BEST_VOXELS;
        for (int k = 0; k < ISO_BRICK && g != group; k++) rest[k] = other[k] > rest[k] ? other[k] : rest[k];
    }
    for (; drawn; drawn &= drawn - 1) {
        const int k = first_of(drawn);
        level[k] = level_of(own[k], rest[k]);
    }
}

/* Sets the voxels `part` of the block's fields in the level sets that have a brick in this cell. */
static void write_brick(const label_block *b, size_t cell, const extent *part) {
    const iso_label_fields *f = b->all->fields;
    for (int g = 1; g <= f->group_count; g++) {
        if (f->grid[g]->cell[cell] < 0) continue;
        float *value = iso_hgrid_brick(f->grid[g], f->grid[g]->cell[cell]);
        for (int z = part->lo[2]; z < part->hi[2]; z++)
            for (int y = part->lo[1]; y < part->hi[1]; y++, value += ISO_BRICK)
                write_row(b, g, part->lo[0], y, z, value);
    }
}

/* Computes the fields at the voxels that are needed. */
static void smooth_needed(const label_block *b, bool pair) {
    block_memory *s = b->s;
    void (*const make)(const label_block *, const uint64_t *, bool) = pair ? make_pair : make_all;
    make(b, s->needed, false);
    s->blends = find_thin(b);
    if (s->blends) make(b, s->blended, true);
    raise_all(b);
}

/* The cell of a brick of the block in the level sets. */
static size_t cell_of_brick(const label_block *b, int brick) {
    const int *first = b->first;
    return iso_hgrid_cell_index(b->all->fields->grid[1], first[0] / ISO_BRICK + (brick & 1),
                                first[1] / ISO_BRICK + (brick >> 1 & 1), first[2] / ISO_BRICK + (brick >> 2));
}

/* The level sets of a block. */
static void smooth_block(label_block *b) {
    extent part;
    bool pair;
    if (iso_label_block_groups(b, &pair)) smooth_needed(b, pair);
    for (int brick = 0; brick < BRICKS; brick++)
        if (box_of_brick(b, brick, &part)) write_brick(b, cell_of_brick(b, brick), &part);
}

/* The candidates of a block. */
static void tell_block_apart(label_block *b) {
    extent part;
    if (!iso_label_block_labels(b)) return;
    for (int brick = 0; brick < BRICKS; brick++)
        if (make_candidates(b, brick) != ISO_OK) b->s->failed = true;
    smooth_needed(b, false);
    for (int brick = 0; brick < BRICKS; brick++) {
        if (!box_of_brick(b, brick, &part)) continue;
        iso_label_candidates **kept = &b->all->fields->candidates[cell_of_brick(b, brick)];
        iso_free(*kept);
        *kept = b->candidates[brick];
    }
}

/* Finds the bricks of a block that need values: those with several groups, or with several labels. */
static bool find_bricks(const iso_label_fields *f, size_t block, label_block *b) {
    const size_t across = (size_t)f->blocks[0], down = (size_t)f->blocks[1];
    const int at[3] = {(int)(block % across), (int)(block / across % down), (int)(block / across / down)};
    int lo[3] = {INT32_MAX, INT32_MAX, INT32_MAX}, hi[3] = {INT32_MIN, INT32_MIN, INT32_MIN};
    for (int number = 0; number < BRICKS; number++) {
        const int brick[3] = {2 * at[0] + (number & 1), 2 * at[1] + (number >> 1 & 1),
                              2 * at[2] + (number >> 2)};
        if (brick[0] >= f->bricks[0] || brick[1] >= f->bricks[1] || brick[2] >= f->bricks[2]) continue;
        if (!f->smoothed[iso_hgrid_cell_index(f->grid[1], brick[0], brick[1], brick[2])]) continue;
        for (int k = 0; k < 3; k++) {
            lo[k] = brick[k] < lo[k] ? brick[k] : lo[k];
            hi[k] = brick[k] > hi[k] ? brick[k] : hi[k];
        }
    }
    if (lo[0] > hi[0]) return false;
    for (int k = 0; k < 3; k++) {
        b->first[k] = ISO_BRICK * lo[k];
        b->out[k] = ISO_BRICK * (hi[k] - lo[k] + 1);
        b->size[k] = b->out[k] + 2 * NEAR;
    }
    return true;
}

static void smooth_task(void *context, size_t index, int worker) {
    const smoothing *all = context;
    label_block b = {.all = all, .s = &all->scratch[worker]};
    if (find_bricks(all->fields, index, &b)) smooth_block(&b);
}

static void tell_apart_task(void *context, size_t index, int worker) {
    const smoothing *all = context;
    iso_label_fields *f = all->fields;
    const uint64_t asked = atomic_load_explicit(&f->asked[index], memory_order_relaxed);
    if (!(asked & ~f->apart[index])) return;
    label_block b = {
        .all = all, .s = &all->scratch[worker], .octants = f->apart[index] != 0 ? UINT64_MAX : asked};
    if (find_bricks(f, index, &b)) tell_block_apart(&b);
    if (!b.s->failed) f->apart[index] = b.octants;
}

/* ---- memory */

static float *alloc_floats(size_t count) {
    return iso_alloc((count + ISO_LABEL_SLACK) * sizeof(float));
}

static iso_status make_scratch(block_memory *s, const iso_label_fields *f, iso_error *error) {
    const size_t labels = (size_t)f->labels->count, groups = (size_t)f->group_count + 1,
                 count = labels > groups ? labels : groups,
                 rows = MASK_ROWS + 2 * ISO_LABEL_GUARD + ISO_LABEL_SLACK;
    s->window = iso_alloc((FIELD_VOXELS + ISO_LABEL_SLACK) * sizeof *s->window);
    s->mask = iso_alloc(MASK_VOXELS + ISO_LABEL_SLACK);
    s->work8 = iso_alloc(MASK_VOXELS + ISO_LABEL_SLACK);
    s->squares = iso_alloc(DISTANCE_VOXELS + ISO_LABEL_SLACK);
    s->distance = alloc_floats(DISTANCE_VOXELS);
    s->work = alloc_floats(4 * ((size_t)DISTANCE_VOXELS + ISO_LABEL_SLACK));
    s->field = alloc_floats(FIELD_VOXELS);
    s->narrowed = alloc_floats(FIELD_VOXELS);
    s->kept = alloc_floats(KEPT);
    s->loss = alloc_floats(FIELD_VOXELS);
    s->own = alloc_floats(FIELD_VOXELS);
    s->other = alloc_floats(FIELD_VOXELS);
    s->weight = alloc_floats(FIELD_VOXELS);
    s->best = alloc_floats(groups * BEST_VOXELS);
    s->sets = iso_alloc((size_t)SETS * FIELD_ROWS * sizeof *s->sets);
    s->ranges = iso_alloc(2 * ISO_LABEL_STEPS * rows);
    s->near = iso_alloc((count < FIELD_VOXELS ? count : FIELD_VOXELS) * sizeof *s->near);
    s->place = iso_alloc(count * sizeof *s->place);
    s->entries = iso_alloc((size_t)ISO_BRICK_VOXELS * NEIGHBOURS * sizeof *s->entries);
    if (!s->window || !s->mask || !s->work8 || !s->squares || !s->distance || !s->work || !s->field ||
        !s->narrowed || !s->loss || !s->own || !s->other || !s->weight || !s->best || !s->near || !s->place ||
        !s->entries || !s->kept || !s->sets || !s->ranges)
        return iso_fail(error, ISO_ERR_NOMEM, "out of memory for labels");
    memset(s->place, -1, count * sizeof *s->place);
    uint64_t **const set[SETS] = {&s->cells,    &s->drawn,    &s->needed,  &s->blended,
                                  &s->edges[0], &s->edges[1], &s->edges[2]};
    for (size_t i = 0; i < SETS; i++) *set[i] = s->sets + i * FIELD_ROWS;
    memset(s->ranges, UINT8_MAX, ISO_LABEL_STEPS * rows);
    memset(s->ranges + ISO_LABEL_STEPS * rows, 0, ISO_LABEL_STEPS * rows);
    for (size_t i = 0; i < ISO_LABEL_STEPS; i++) {
        s->lo[i] = s->ranges + i * rows + ISO_LABEL_GUARD;
        s->hi[i] = s->lo[i] + ISO_LABEL_STEPS * rows;
    }
    return ISO_OK;
}

static void free_scratch(block_memory *s) {
    void *const all[] = {s->window,  s->mask,     s->work8, s->squares, s->distance, s->work, s->field,
                         s->own,     s->narrowed, s->other, s->weight,  s->best,     s->near, s->place,
                         s->entries, s->loss,     s->kept,  s->sets,    s->ranges};
    for (size_t i = 0; i < sizeof all / sizeof *all; i++) iso_free(all[i]);
}

static iso_status for_blocks(iso_label_fields *fields, iso_task *task, iso_pool *pool, iso_error *error) {
    const int workers = iso_pool_threads(pool);
    smoothing all = {.fields = fields,
                     .kernel = ISO_KERNEL_UNIT(iso_smooth_kernel, iso_cpu_best()),
                     .scratch = iso_alloc_zero((size_t)workers, sizeof(block_memory))};
    if (!all.scratch) return iso_fail(error, ISO_ERR_NOMEM, "out of memory for labels");
    iso_status status = ISO_OK;
    for (int i = 0; i < workers && status == ISO_OK; i++)
        status = make_scratch(&all.scratch[i], fields, error);
    if (status == ISO_OK) iso_parallel_for(pool, fields->block_count, task, &all);
    for (int i = 0; i < workers; i++) {
        if (status == ISO_OK && all.scratch[i].failed)
            status = iso_fail(error, ISO_ERR_NOMEM, "out of memory for labels");
        free_scratch(&all.scratch[i]);
    }
    iso_free(all.scratch);
    return status;
}

iso_status iso_label_blocks_smooth(iso_label_fields *fields, iso_pool *pool, iso_error *error) {
    return for_blocks(fields, smooth_task, pool, error);
}

iso_status iso_label_blocks_tell_apart(iso_label_fields *fields, iso_pool *pool, iso_error *error) {
    return for_blocks(fields, tell_apart_task, pool, error);
}
