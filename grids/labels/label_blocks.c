/* label_blocks: smooths labels in blocks of 2 x 2 x 2 bricks. Of every label in or near a block the field is
 * computed in the box of its voxels there, and what the level sets need is kept: at each voxel the field of
 * its own label, the greatest of the others, and the greatest of each group. */
#include "grids/labels/label_blocks.h"

#include <math.h>
#include <string.h>

#include "base/cpu.h"
#include "base/kernel_units.h"
#include "base/memory.h"
#include "grids/labels/smooth_kernel.h"

enum {
    SIDE = 2 * ISO_BRICK,
    NEAR = 3,   /* how far from the block labels count, and voxels that would change their label */
    FILTER = 7, /* the greatest radius of a filter */
    FIELD = SIDE + 2 * NEAR,
    DISTANCES = FIELD + 2 * FILTER,
    WINDOW = DISTANCES + 2 * ISO_LABEL_REACH,
    OFFSET = FILTER + ISO_LABEL_REACH, /* of a field's voxels in the window */
    FIELD_VOXELS = FIELD * FIELD * FIELD,
    DISTANCE_VOXELS = DISTANCES * DISTANCES * DISTANCES,
    WINDOW_VOXELS = WINDOW * WINDOW * WINDOW,
    BRICKS = 8,               /* of a block */
    KEPT = 16 * FIELD_VOXELS, /* of the fields of a block's labels, for where things are thin */
    NEIGHBOURS = 27,          /* a voxel and those around it */
    FAR = ISO_LABEL_FAR_SQUARE
};
/* By how much a voxel's own label leads, voxels, and by how much more where things are thin, so that sheets
 * of one voxel have few holes. */
static const float LEAD = 0.05f, THIN_LEAD = 0.2f;
/* Where things are thin: the wide filter gives voxels to another label, by more than noise, or takes more
 * than this from their distance to the border. */
static const float THIN_CHANGE = 0.1f, THIN_LOSS = 0.6f;

/* A Gaussian: the weight in the middle, and of both sides. */
typedef struct gaussian {
    int radius;
    float w[FILTER + 1];
    float back;
} gaussian;
/* Filters: (1 + back) * the first Gaussian - back * the second one, which is sqrt(2) as wide. With back = 1
 * the surface of a distance field is not moved; a little more makes up for the trilinear interpolation, which
 * makes balls smaller. */
static const gaussian wide[2] = {
    {5, {0.266011725f, 0.213005538f, 0.10936069f, 0.0360007721f, 0.00759875814f, 0.00102838008f}, 1.13f},
    {7,
     {0.188130836f, 0.168346869f, 0.120625802f, 0.0692094667f, 0.0317966163f, 0.0116973214f, 0.00344573645f,
      0.000812770263f},
     0}}; /* 1.5 voxels */
static const gaussian narrow[2] = {
    {3, {0.498676452f, 0.228310716f, 0.0219103142f, 0.000440743367f}, 1.5f},
    {4, {0.352632958f, 0.238603394f, 0.0739158834f, 0.0104835015f, 0.000680741752f}, 0}}; /* 0.8 voxels */

/* The voxels lo .. hi - 1, counted from the first voxel of a block's fields. */
typedef struct box {
    int lo[3], hi[3];
} extent;

/* A label near a block, and its voxels in the block's fields. */
typedef struct near_label {
    int label;
    extent box;
    extent kept_box;   /* of its field by the wide filter */
    const float *kept; /* NULL: not kept */
} near_label;

/* Working memory of a worker. */
typedef struct scratch {
    uint16_t *window; /* labels; those that are not drawn are 0 */
    uint8_t *mask, *work8, *to_inside, *to_outside;
    float *distance, *work, *field, *second, *third;
    float *kept; /* fields of labels */
    size_t kept_count;
    int margin;         /* of the distances around the field */
    float *own, *other; /* at every voxel: its own label's field, and the greatest other one */
    float *loss;        /* what its own label's field is less than the distance */
    float *best;        /* the greatest field of each group, group 0 first */
    float *weight;      /* of the narrow filter */
    near_label *near;
    int near_count;
    int *place;               /* of a label in `near`; -1: it is not in it */
    iso_label_value *entries; /* candidates of a brick */
    bool failed, blends;
} scratch;

typedef struct smoothing {
    iso_label_fields *fields;
    const iso_smooth_kernel *kernel;
    scratch *scratch;
    int blocks[3];
} smoothing;

/* A block that is being smoothed. */
typedef struct block {
    const smoothing *all;
    scratch *s;
    int first[3];  /* its first voxel that has values, in the level sets */
    int out[3];    /* its size: of the bricks that need values */
    int size[3];   /* of its fields */
    int window[3]; /* of its window */
    iso_label_candidates *candidates[BRICKS];
} block;

static inline size_t index_in(const int size[3], int x, int y, int z) {
    return ((size_t)z * (size_t)size[1] + (size_t)y) * (size_t)size[0] + (size_t)x;
}

/* ---- the labels of a block */

/* Where the run of labels that begins at x ends, in a row of n. */
static inline int run_end(const uint16_t *row, int x, int n) {
    const uint16_t label = row[x];
    const uint64_t four = label * (uint64_t)0x0001000100010001;
    uint64_t next;
    for (x++; x + 4 <= n; x += 4) {
        memcpy(&next, row + x, sizeof next);
        if (next != four) break;
    }
    while (x < n && row[x] == label) x++;
    return x;
}

/* The first labels that are found in a window. */
typedef struct first_labels {
    int label[3], count; /* count: 3 at most */
} first_labels;

static void add_label(first_labels *first, int label) {
    for (int i = 0; i < first->count; i++)
        if (first->label[i] == label) return;
    if (first->count < 3) first->label[first->count++] = label;
}

/* Sets a row of the window; its first voxel is at `at` in the volume. */
static void load_row(const iso_label_fields *f, const int at[3], int n, uint16_t *row, first_labels *found) {
    const int *dims = f->labels->dims;
    const int first = at[0] < 0 ? -at[0] : 0, end = at[0] + n > dims[0] ? dims[0] - at[0] : n;
    const bool outside = at[1] < 0 || at[2] < 0 || at[1] >= dims[1] || at[2] >= dims[2] || first >= end;
    if (outside || first > 0 || end < n) {
        memset(row, 0, (size_t)n * sizeof *row);
        add_label(found, 0);
    }
    if (outside) return;
    const uint16_t *number =
        f->labels->number + ((size_t)at[2] * (size_t)dims[1] + (size_t)at[1]) * (size_t)dims[0] + at[0];
    for (int x = first, next; x < end; x = next) {
        const uint16_t drawn = f->group[number[x]] ? number[x] : 0;
        next = run_end(number, x, end);
        for (int i = x; i < next; i++) row[i] = drawn;
        add_label(found, drawn);
    }
}

/* Sets the window; returns the number of labels in it, 3 at most. */
static int load_window(block *b) {
    first_labels found = {{0, 0, 0}, 0};
    const int margin = NEAR + OFFSET + ISO_LABEL_BORDER;
    for (int z = 0; z < b->window[2]; z++)
        for (int y = 0; y < b->window[1]; y++) {
            const int at[3] = {b->first[0] - margin, b->first[1] - margin + y, b->first[2] - margin + z};
            load_row(b->all->fields, at, b->window[0], b->s->window + index_in(b->window, 0, y, z), &found);
        }
    return found.count;
}

static inline const uint16_t *window_row(const block *b, int y, int z) {
    return b->s->window + index_in(b->window, OFFSET, y + OFFSET, z + OFFSET);
}

static void add_near(scratch *s, int label, int x, int end, int y, int z) {
    if (s->place[label] < 0) {
        s->place[label] = s->near_count;
        s->near[s->near_count++] = (near_label){.label = label, .box = {{x, y, z}, {end, y + 1, z + 1}}};
    }
    extent *box = &s->near[s->place[label]].box;
    const int lo[3] = {x, y, z}, hi[3] = {end, y + 1, z + 1};
    for (int k = 0; k < 3; k++) {
        box->lo[k] = lo[k] < box->lo[k] ? lo[k] : box->lo[k];
        box->hi[k] = hi[k] > box->hi[k] ? hi[k] : box->hi[k];
    }
}

/* Lists the labels within NEAR voxels of the block. */
static void list_near(block *b) {
    scratch *s = b->s;
    s->near_count = 0;
    s->kept_count = 0;
    for (int z = 0; z < b->size[2]; z++)
        for (int y = 0; y < b->size[1]; y++) {
            const uint16_t *row = window_row(b, y, z);
            for (int x = 0, end; x < b->size[0]; x = end) {
                end = run_end(row, x, b->size[0]);
                add_near(s, row[x], x, end, y, z);
            }
        }
    for (int i = 0; i < s->near_count; i++) s->place[s->near[i].label] = -1;
}

/* ---- the field of a label */

/* Where `zone` and the label's box, which is made larger by NEAR, overlap; false: nowhere. */
static bool clip_box(const extent *of_label, const extent *zone, extent *clipped) {
    for (int k = 0; k < 3; k++) {
        const int lo = of_label->lo[k] - NEAR, hi = of_label->hi[k] + NEAR;
        clipped->lo[k] = lo > zone->lo[k] ? lo : zone->lo[k];
        clipped->hi[k] = hi < zone->hi[k] ? hi : zone->hi[k];
        if (clipped->lo[k] >= clipped->hi[k]) return false;
    }
    return true;
}

/* mask = 0 at voxels of the label. */
static void make_mask(const block *b, int label, const extent *box, const int size[3]) {
    for (int z = 0; z < size[2]; z++)
        for (int y = 0; y < size[1]; y++) {
            const int skipped = FILTER - b->s->margin;
            const size_t row =
                index_in(b->window, box->lo[0] + skipped, box->lo[1] + y + skipped, box->lo[2] + z + skipped);
            b->all->kernel->mask(b->s->window + row, size[0], (uint16_t)label,
                                 b->s->mask + index_in(size, 0, y, z));
        }
}

/* mask = 0 at all other voxels. */
static void invert_mask(uint8_t *mask, const int size[3]) {
    const size_t count = (size_t)size[0] * (size_t)size[1] * (size_t)size[2];
    const uint64_t flip = FAR * (uint64_t)0x0101010101010101;
    for (size_t i = 0; i < count; i += sizeof flip) { /* (there is slack behind the last one) */
        uint64_t eight;
        memcpy(&eight, mask + i, sizeof eight);
        eight ^= flip;
        memcpy(mask + i, &eight, sizeof eight);
    }
}

/* out = the filter of the signed distances. */
static void filter_twiced(const block *b, const gaussian g[2], const int n[3], float *out) {
    scratch *s = b->s;
    const size_t count = (size_t)n[0] * (size_t)n[1] * (size_t)n[2];
    const iso_smooth_kernel *kernel = b->all->kernel;
    kernel->filter(s->distance, n, s->margin, g[0].radius, g[0].w, s->work, out);
    float *second = s->second;
    kernel->filter(s->distance, n, s->margin, g[1].radius, g[1].w, s->work, second);
    for (size_t i = 0; i < count; i++) out[i] = (1 + g->back) * out[i] - g->back * second[i];
}

/* Blends in the narrow filter. */
static void blend(const block *b, const extent *box, const int n[3]) {
    scratch *s = b->s;
    float *narrowed = s->third;
    filter_twiced(b, narrow, n, narrowed);
    for (int z = 0; z < n[2]; z++)
        for (int y = 0; y < n[1]; y++) {
            const float *w = s->weight + index_in(b->size, box->lo[0], box->lo[1] + y, box->lo[2] + z);
            const size_t row = index_in(n, 0, y, z);
            for (int x = 0; x < n[0]; x++)
                s->field[row + (size_t)x] += w[x] * (narrowed[row + (size_t)x] - s->field[row + (size_t)x]);
        }
}

/* Keeps the field of a label, if there is room. */
static void keep_wide(scratch *s, near_label *near, const extent *box, size_t count) {
    near->kept = NULL;
    if (s->kept_count + count > KEPT) return;
    memcpy(s->kept + s->kept_count, s->field, count * sizeof *s->field);
    near->kept = s->kept + s->kept_count;
    near->kept_box = *box;
    s->kept_count += count;
}

/* Sets `field` in a box from what is kept of it. */
static void load_kept(scratch *s, const near_label *near, const extent *box, const int n[3]) {
    const extent *from = &near->kept_box;
    const int size[3] = {from->hi[0] - from->lo[0], from->hi[1] - from->lo[1], from->hi[2] - from->lo[2]};
    for (int z = 0; z < n[2]; z++)
        for (int y = 0; y < n[1]; y++)
            memcpy(s->field + index_in(n, 0, y, z),
                   near->kept + index_in(size, box->lo[0] - from->lo[0], box->lo[1] + y - from->lo[1],
                                         box->lo[2] + z - from->lo[2]),
                   (size_t)n[0] * sizeof *s->field);
}

/* Computes `field` of a label in a box; after the first time, with `blends`, only what the narrow filter
 * needs if the field is kept. */
static void make_field(const block *b, near_label *near, const extent *box, bool blends) {
    scratch *s = b->s;
    const int label = near->label;
    const bool kept = blends && near->kept;
    s->margin = kept ? narrow[1].radius : FILTER;
    const iso_smooth_kernel *kernel = b->all->kernel;
    int n[3], far[3], masked[3];
    size_t count = 1;
    for (int k = 0; k < 3; k++) {
        n[k] = box->hi[k] - box->lo[k];
        far[k] = n[k] + 2 * s->margin;
        masked[k] = far[k] + 2 * ISO_LABEL_REACH;
        count *= (size_t)far[k];
    }
    make_mask(b, label, box, masked);
    kernel->squares(s->mask, far, s->work8, s->to_inside);
    invert_mask(s->mask, masked);
    kernel->squares(s->mask, far, s->work8, s->to_outside);
    kernel->signed_distance(s->to_outside, s->to_inside, count, s->distance);
    if (kept)
        load_kept(s, near, box, n);
    else
        filter_twiced(b, wide, n, s->field);
    if (blends)
        blend(b, box, n);
    else
        keep_wide(s, near, box, (size_t)n[0] * (size_t)n[1] * (size_t)n[2]);
}

/* ---- what is kept of it */

/* The voxels of brick `number`, 0 .. 7, of the block, in its fields; false: it has no such brick. */
static bool box_of_brick(const block *b, int number, extent *box) {
    for (int k = 0; k < 3; k++) {
        const int place = number >> k & 1;
        if (place * ISO_BRICK >= b->out[k]) return false;
        box->lo[k] = NEAR + place * ISO_BRICK;
        box->hi[k] = box->lo[k] + ISO_BRICK;
    }
    return true;
}

/* The field of a label at a voxel becomes known to the brick's candidates. */
static inline void set_candidate(iso_label_candidates *c, int voxel, int label, float value) {
    for (uint32_t i = c->start[voxel]; i < c->start[voxel + 1]; i++)
        if (c->entry[i].label == label) c->entry[i].value = value;
}

static void keep_candidates(const block *b, int label, const extent *field, float sign) {
    const int n[3] = {field->hi[0] - field->lo[0], field->hi[1] - field->lo[1], field->hi[2] - field->lo[2]};
    for (int brick = 0; brick < BRICKS; brick++) {
        extent part;
        if (!b->candidates[brick] || !box_of_brick(b, brick, &part)) continue;
        const int first[3] = {part.lo[0], part.lo[1], part.lo[2]};
        for (int k = 0; k < 3; k++) {
            part.lo[k] = part.lo[k] > field->lo[k] ? part.lo[k] : field->lo[k];
            part.hi[k] = part.hi[k] < field->hi[k] ? part.hi[k] : field->hi[k];
        }
        for (int z = part.lo[2]; z < part.hi[2]; z++)
            for (int y = part.lo[1]; y < part.hi[1]; y++) {
                const int row = ((z - first[2]) * ISO_BRICK + y - first[1]) * ISO_BRICK - first[0];
                const float *value =
                    b->s->field + index_in(n, 0, y - field->lo[1], z - field->lo[2]) - field->lo[0];
                for (int x = part.lo[0]; x < part.hi[0]; x++)
                    set_candidate(b->candidates[brick], row + x, label, sign * value[x]);
            }
    }
}

/* Adds sign * field, of the label in the box, to what is known of the voxels. */
static void keep_field(const block *b, int label, const extent *box, float sign) {
    scratch *s = b->s;
    float *best = s->best + (size_t)b->all->fields->group[label] * FIELD_VOXELS;
    size_t from = 0;
    const int m = s->margin, far[3] = {box->hi[0] - box->lo[0] + 2 * m, box->hi[1] - box->lo[1] + 2 * m,
                                       box->hi[2] - box->lo[2] + 2 * m};
    for (int z = box->lo[2]; z < box->hi[2]; z++)
        for (int y = box->lo[1]; y < box->hi[1]; y++) {
            const uint16_t *row = window_row(b, y, z);
            const size_t at = index_in(b->size, 0, y, z);
            const float *distance =
                s->distance - box->lo[0] + index_in(far, m, y - box->lo[1] + m, z - box->lo[2] + m);
            for (int x = box->lo[0]; x < box->hi[0]; x++) {
                const float value = sign * s->field[from++];
                const size_t i = at + (size_t)x;
                best[i] = value > best[i] ? value : best[i];
                if (row[x] == label) {
                    s->own[i] = value;
                    s->loss[i] = sign * distance[x] - value;
                } else {
                    s->other[i] = value > s->other[i] ? value : s->other[i];
                }
            }
        }
    keep_candidates(b, label, box, sign);
}

static void clear_row(float *row, const extent *zone) {
    for (int x = 0; x < zone->hi[0] - zone->lo[0]; x++) row[x] = -ISO_LABEL_BAND;
}

/* The fields of all labels in a zone of the block. `pair`: there are but two labels, whose fields are
 * opposite. */
static void make_all(const block *b, const extent *zone, bool pair, bool blends) {
    scratch *s = b->s;
    const int groups = b->all->fields->group_count;
    for (int z = zone->lo[2]; z < zone->hi[2]; z++)
        for (int y = zone->lo[1]; y < zone->hi[1]; y++) {
            const size_t row = index_in(b->size, zone->lo[0], y, z);
            clear_row(s->own + row, zone);
            clear_row(s->other + row, zone);
            for (int g = 0; g <= groups; g++) clear_row(s->best + (size_t)g * FIELD_VOXELS + row, zone);
        }
    for (int i = 0; i < s->near_count; i++) {
        near_label *near = &s->near[i];
        extent part = *zone;
        if (!pair && !clip_box(&near->box, zone, &part)) continue;
        make_field(b, near, &part, blends);
        keep_field(b, near->label, &part, 1);
        if (!pair) continue;
        keep_field(b, s->near[1].label, &part, -1);
        return;
    }
}

/* ---- where things are thin */

static inline bool is_thin(const scratch *s, size_t i) {
    return s->own[i] < s->other[i] - THIN_CHANGE || s->loss[i] > THIN_LOSS;
}

static void grow_extent(extent *e, int x, int y, int z) {
    const int at[3] = {x, y, z};
    for (int k = 0; k < 3; k++) {
        e->lo[k] = at[k] < e->lo[k] ? at[k] : e->lo[k];
        e->hi[k] = at[k] >= e->hi[k] ? at[k] + 1 : e->hi[k];
    }
}

/* Finds such voxels, and sets the weights of the narrow filter: 1 within a voxel of them, 0 from NEAR voxels
 * on. *zone: the part of it with weights. False: there is none. */
static bool find_thin(const block *b, extent *zone) {
    enum { R = ISO_LABEL_REACH };
    scratch *s = b->s;
    const int padded[3] = {b->size[0] + 2 * R, b->size[1] + 2 * R, b->size[2] + 2 * R};
    const size_t count = (size_t)b->size[0] * (size_t)b->size[1] * (size_t)b->size[2];
    bool any = false;
    for (size_t i = 0; i < count && !any; i++) any = is_thin(s, i);
    if (!any) return false;
    memset(s->mask, FAR, (size_t)padded[0] * (size_t)padded[1] * (size_t)padded[2]);
    for (int z = 0; z < b->size[2]; z++)
        for (int y = 0; y < b->size[1]; y++)
            for (int x = 0; x < b->size[0]; x++) {
                const size_t i = index_in(b->size, x, y, z);
                if (is_thin(s, i)) s->mask[index_in(padded, x + R, y + R, z + R)] = 0;
            }
    b->all->kernel->squares(s->mask, b->size, s->work8, s->to_inside);
    const extent all = *zone;
    *zone = (extent){{INT32_MAX, INT32_MAX, INT32_MAX}, {INT32_MIN, INT32_MIN, INT32_MIN}};
    for (int z = all.lo[2]; z < all.hi[2]; z++)
        for (int y = all.lo[1]; y < all.hi[1]; y++)
            for (int x = all.lo[0]; x < all.hi[0]; x++) {
                const size_t i = index_in(b->size, x, y, z);
                const int square = s->to_inside[i];
                const float w = square < NEAR * NEAR ? (NEAR - sqrtf((float)square)) / (NEAR - 1) : 0;
                s->weight[i] = w > 1 ? 1 : w;
                if (w > 0) grow_extent(zone, x, y, z);
            }
    return zone->lo[0] < zone->hi[0];
}

/* ---- candidates */

/* Lists the labels at and around a voxel that share a group with others, each once; returns their number. */
static int list_candidates(const block *b, int x, int y, int z, iso_label_value list[NEIGHBOURS]) {
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
                if (i == count) list[count++] = (iso_label_value){(uint16_t)label, -ISO_LABEL_BAND};
            }
        }
    return count;
}

/* Whether labels near the block share a group. */
static bool has_candidates(const block *b) {
    const iso_label_fields *f = b->all->fields;
    int shared = 0;
    for (int i = 0; i < b->s->near_count; i++) {
        const int label = b->s->near[i].label;
        shared += label && f->labels_in_group[f->group[label]] > 1;
    }
    return shared > 1;
}

/* Whether the eight corners of a cell have one label. */
static inline bool is_of_one_label(const uint16_t *row[4], int x) {
    const uint16_t label = row[0][x];
    bool other = row[0][x + 1] != label;
    for (int i = 1; i < 4; i++) other |= (row[i][x] != label) | (row[i][x + 1] != label);
    return !other;
}

/* Whether four rows of n voxels have one label. */
static bool are_of_one_label(const uint16_t *row[4], int x, int n) {
    for (int i = 0; i < 4; i++)
        if (row[i][x] != row[0][x] || run_end(row[i] + x, 0, n) < n) return false;
    return true;
}

/* Marks the voxels of a brick that are corners of a cell with several labels. */
static void mark_mixed(const block *b, const extent *part, bool mixed[ISO_BRICK_VOXELS]) {
    memset(mixed, 0, ISO_BRICK_VOXELS * sizeof *mixed);
    for (int z = -1; z < ISO_BRICK; z++)
        for (int y = -1; y < ISO_BRICK; y++) {
            const int at[2] = {part->lo[1] + y, part->lo[2] + z};
            const uint16_t *row[4] = {window_row(b, at[0], at[1]), window_row(b, at[0] + 1, at[1]),
                                      window_row(b, at[0], at[1] + 1), window_row(b, at[0] + 1, at[1] + 1)};
            if (are_of_one_label(row, part->lo[0] - 1, ISO_BRICK + 2)) continue;
            for (int x = -1; x < ISO_BRICK; x++) {
                if (is_of_one_label(row, part->lo[0] + x)) continue;
                for (int corner = 0; corner < 8; corner++) {
                    const int c[3] = {x + (corner & 1), y + (corner >> 1 & 1), z + (corner >> 2)};
                    if (c[0] >= 0 && c[1] >= 0 && c[2] >= 0 && c[0] < ISO_BRICK && c[1] < ISO_BRICK &&
                        c[2] < ISO_BRICK)
                        mixed[(c[2] * ISO_BRICK + c[1]) * ISO_BRICK + c[0]] = true;
                }
            }
        }
}

/* ISO_ERR_NOMEM (without a message). */
static iso_status make_candidates(block *b, int brick) {
    bool mixed[ISO_BRICK_VOXELS];
    extent part;
    iso_label_value *list = b->s->entries;
    uint32_t start[ISO_BRICK_VOXELS + 1] = {0}, count = 0;
    if (!box_of_brick(b, brick, &part)) return ISO_OK;
    mark_mixed(b, &part, mixed);
    for (int i = 0; i < ISO_BRICK_VOXELS; i++) {
        start[i] = count;
        if (!mixed[i]) continue;
        const int n = list_candidates(b, part.lo[0] + i % ISO_BRICK, part.lo[1] + i / ISO_BRICK % ISO_BRICK,
                                      part.lo[2] + i / ISO_BRICK / ISO_BRICK, list + count);
        count += n > 1 ? (uint32_t)n : 0;
    }
    start[ISO_BRICK_VOXELS] = count;
    if (!count) return ISO_OK;
    iso_label_candidates *c = iso_alloc(sizeof *c + count * sizeof *list);
    if (!c) return ISO_ERR_NOMEM;
    memcpy(c->start, start, sizeof start);
    memcpy(c->entry, list, count * sizeof *list);
    b->candidates[brick] = c;
    return ISO_OK;
}

/* ---- the level sets */

/* Raises the own label of voxels above the others. */
static void raise_own(const block *b, int x, int y, int z) {
    scratch *s = b->s;
    const size_t i = index_in(b->size, x, y, z);
    const float least = s->other[i] + LEAD + (s->blends ? s->weight[i] * THIN_LEAD : 0);
    if (s->own[i] >= least) return;
    const int label = window_row(b, y, z)[x];
    float *best = s->best + (size_t)b->all->fields->group[label] * FIELD_VOXELS + i;
    s->own[i] = least;
    *best = *best > least ? *best : least;
    for (int brick = 0; brick < BRICKS; brick++) {
        extent part;
        if (!b->candidates[brick] || !box_of_brick(b, brick, &part)) continue;
        const int at[3] = {x - part.lo[0], y - part.lo[1], z - part.lo[2]};
        if (at[0] < 0 || at[1] < 0 || at[2] < 0 || at[0] >= ISO_BRICK || at[1] >= ISO_BRICK ||
            at[2] >= ISO_BRICK)
            continue;
        set_candidate(b->candidates[brick], (at[2] * ISO_BRICK + at[1]) * ISO_BRICK + at[0], label, least);
    }
}

/* Half of what `value` is above `most`, negative where it is, in the band. */
static inline float level_of(float value, float most) {
    const float level = (most - value) / 2;
    return level > ISO_LABEL_BAND ? ISO_LABEL_BAND : level < -ISO_LABEL_BAND ? -ISO_LABEL_BAND : level;
}

/* Sets a row of a group's level set; i: the first voxel in the fields. */
static void write_row(const block *b, int group, size_t i, float *level) {
    const int groups = b->all->fields->group_count;
    const float *best = b->s->best + i, *own = best + (size_t)group * FIELD_VOXELS;
    float rest[ISO_BRICK];
    for (int x = 0; x < ISO_BRICK; x++) rest[x] = best[x]; /* of group 0 */
    for (int g = 1; g <= groups; g++) {
        const float *other = best + (size_t)g * FIELD_VOXELS;
        for (int x = 0; x < ISO_BRICK && g != group; x++) rest[x] = other[x] > rest[x] ? other[x] : rest[x];
    }
    for (int x = 0; x < ISO_BRICK; x++) level[x] = level_of(own[x], rest[x]);
}

static void write_bricks(const block *b, const int at[3], const extent *part) {
    const iso_label_fields *f = b->all->fields;
    const size_t cell = iso_hgrid_cell_index(f->grid[1], at[0], at[1], at[2]);
    for (int g = 1; g <= f->group_count; g++) {
        if (f->grid[g]->cell[cell] < 0) continue;
        float *value = iso_hgrid_brick(f->grid[g], f->grid[g]->cell[cell]);
        for (int z = part->lo[2]; z < part->hi[2]; z++)
            for (int y = part->lo[1]; y < part->hi[1]; y++, value += ISO_BRICK)
                write_row(b, g, index_in(b->size, part->lo[0], y, z), value);
    }
}

static void smooth_block(block *b) {
    const extent all = {{0, 0, 0}, {b->size[0], b->size[1], b->size[2]}},
                 out = {{NEAR, NEAR, NEAR}, {NEAR + b->out[0], NEAR + b->out[1], NEAR + b->out[2]}};
    const bool pair = load_window(b) == 2;
    list_near(b);
    const int bricks = has_candidates(b) ? BRICKS : 0;
    for (int brick = 0; brick < bricks; brick++)
        if (make_candidates(b, brick) != ISO_OK) b->s->failed = true;
    make_all(b, &all, pair && b->s->near_count == 2, false);
    extent thin = out;
    b->s->blends = find_thin(b, &thin);
    if (b->s->blends) make_all(b, &thin, pair && b->s->near_count == 2, true);
    for (int z = out.lo[2]; z < out.hi[2]; z++)
        for (int y = out.lo[1]; y < out.hi[1]; y++)
            for (int x = out.lo[0]; x < out.hi[0]; x++) raise_own(b, x, y, z);
    for (int brick = 0; brick < BRICKS; brick++) {
        extent part;
        if (!box_of_brick(b, brick, &part)) continue;
        const int at[3] = {b->first[0] / ISO_BRICK + (brick & 1), b->first[1] / ISO_BRICK + (brick >> 1 & 1),
                           b->first[2] / ISO_BRICK + (brick >> 2)};
        write_bricks(b, at, &part);
        const iso_label_fields *f = b->all->fields;
        f->candidates[iso_hgrid_cell_index(f->grid[1], at[0], at[1], at[2])] = b->candidates[brick];
    }
}

/* Finds the bricks of block `at` that need values: those with several groups, or with several labels. */
static bool find_bricks(const smoothing *all, const int at[3], block *b) {
    const iso_label_fields *f = all->fields;
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
        b->window[k] = b->size[k] + 2 * OFFSET;
    }
    return true;
}

static void smooth_task(void *context, size_t index, int worker) {
    const smoothing *all = context;
    const int at[3] = {(int)(index % (size_t)all->blocks[0]),
                       (int)(index / (size_t)all->blocks[0] % (size_t)all->blocks[1]),
                       (int)(index / (size_t)all->blocks[0] / (size_t)all->blocks[1])};
    block b = {.all = all, .s = &all->scratch[worker]};
    if (find_bricks(all, at, &b)) smooth_block(&b);
}

/* ---- memory */

static float *alloc_floats(size_t count) {
    return iso_alloc((count + ISO_LABEL_SLACK) * sizeof(float));
}

static iso_status make_scratch(scratch *s, const iso_label_fields *f, iso_error *error) {
    const size_t count = (size_t)f->labels->count;
    s->window = iso_alloc((WINDOW_VOXELS + ISO_LABEL_SLACK) * sizeof *s->window);
    s->mask = iso_alloc(WINDOW_VOXELS + ISO_LABEL_SLACK);
    s->work8 = iso_alloc(2 * (size_t)WINDOW_VOXELS + ISO_LABEL_SLACK);
    s->to_inside = iso_alloc(DISTANCE_VOXELS + ISO_LABEL_SLACK);
    s->to_outside = iso_alloc(DISTANCE_VOXELS + ISO_LABEL_SLACK);
    s->distance = alloc_floats(DISTANCE_VOXELS);
    s->work = alloc_floats(2 * (size_t)DISTANCE_VOXELS);
    s->field = alloc_floats(FIELD_VOXELS);
    s->second = alloc_floats(FIELD_VOXELS);
    s->third = alloc_floats(FIELD_VOXELS);
    s->kept = alloc_floats(KEPT);
    s->loss = iso_alloc(FIELD_VOXELS * sizeof(float));
    s->own = iso_alloc(FIELD_VOXELS * sizeof(float));
    s->other = iso_alloc(FIELD_VOXELS * sizeof(float));
    s->weight = iso_alloc(FIELD_VOXELS * sizeof(float));
    s->best = iso_alloc(((size_t)f->group_count + 1) * FIELD_VOXELS * sizeof(float));
    s->near = iso_alloc((count < FIELD_VOXELS ? count : FIELD_VOXELS) * sizeof *s->near);
    s->place = iso_alloc(count * sizeof *s->place);
    s->entries = iso_alloc((size_t)ISO_BRICK_VOXELS * NEIGHBOURS * sizeof *s->entries);
    if (!s->window || !s->mask || !s->work8 || !s->to_inside || !s->to_outside || !s->distance || !s->work ||
        !s->field || !s->second || !s->third || !s->loss || !s->own || !s->other || !s->weight || !s->best ||
        !s->near || !s->place || !s->entries || !s->kept)
        return iso_fail(error, ISO_ERR_NOMEM, "out of memory for labels");
    memset(s->place, -1, count * sizeof *s->place);
    return ISO_OK;
}

static void free_scratch(scratch *s) {
    void *const all[] = {s->window, s->mask,   s->work8,   s->to_inside, s->to_outside, s->distance, s->work,
                         s->field,  s->second, s->third,   s->own,       s->other,      s->weight,   s->best,
                         s->near,   s->place,  s->entries, s->loss,      s->kept};
    for (size_t i = 0; i < sizeof all / sizeof *all; i++) iso_free(all[i]);
}

iso_status iso_label_blocks_smooth(iso_label_fields *fields, iso_pool *pool, iso_error *error) {
    const int workers = iso_pool_threads(pool);
    smoothing all = {.fields = fields,
                     .kernel = ISO_KERNEL_UNIT(iso_smooth_kernel, iso_cpu_best()),
                     .scratch = iso_alloc_zero((size_t)workers, sizeof(scratch))};
    if (!all.scratch) return iso_fail(error, ISO_ERR_NOMEM, "out of memory for labels");
    iso_status status = ISO_OK;
    for (int i = 0; i < workers && status == ISO_OK; i++)
        status = make_scratch(&all.scratch[i], fields, error);
    for (int k = 0; k < 3; k++) all.blocks[k] = (fields->bricks[k] + 1) / 2;
    const size_t count = (size_t)all.blocks[0] * (size_t)all.blocks[1] * (size_t)all.blocks[2];
    if (status == ISO_OK) iso_parallel_for(pool, count, smooth_task, &all);
    for (int i = 0; i < workers; i++) {
        if (status == ISO_OK && all.scratch[i].failed)
            status = iso_fail(error, ISO_ERR_NOMEM, "out of memory for labels");
        free_scratch(&all.scratch[i]);
    }
    iso_free(all.scratch);
    return status;
}
