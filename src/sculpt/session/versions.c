/* Keeps the versions of cells by stroke, and draws edited lists of strokes with them. */
#include "sculpt/session/versions.h"

#include <math.h>
#include <string.h>

#include "sculpt/session/version_cells.h"

/* Bricks of versions, unpacked. */
enum { CACHED = 64 };
typedef struct cast_cache {
    const iso_cell_version *of[CACHED];
    float bricks[CACHED][ISO_BRICK_VOXELS];
} cast_cache;

/* ---- memory */

void iso_versions_destroy(iso_versions *v) {
    if (!v) return;
    for (size_t i = 0; i < v->count; i++) iso_drawn_free(v, v->list[i]);
    for (size_t i = 0; v->first && i < v->keys; i++) {
        if (v->first[i]) iso_version_free(v, v->first[i]);
        iso_free(v->first[i]);
    }
    iso_version_store_free(&v->store);
    iso_history_destroy(v->history);
    iso_editor_destroy(v->editor);
    iso_hgrid_destroy(v->grid);
    if (v->dirty_at) iso_versions_clear_dirty(v);
    for (size_t i = 0; i < v->spare_count; i++) iso_free(((float **)v->spare.data)[i]);
    iso_free(v->list);
    iso_free(v->first);
    iso_free(v->held);
    iso_free(v->before);
    iso_free(v->after);
    iso_free(v->dirty);
    iso_free(v->dirty_at);
    for (int i = 0; i < 2; i++) iso_free(v->constant[i]);
    iso_free(v->room);
    iso_buffer_free(&v->spare);
    iso_buffer_free(&v->stale);
    iso_buffer_free(&v->written);
    iso_buffer_free(&v->packed);
    iso_buffer_free(&v->ranges);
    iso_buffer_free(&v->reads);
    iso_free(v->cache);
    iso_free(v);
}

static iso_status set_up(iso_versions *v, const iso_cell_items *paint, iso_pool *pool, iso_error *error) {
    const iso_editor_opts editor = {.pool = pool};
    ISO_TRY(iso_editor_create(v->grid, &editor, &v->editor, error));
    if (paint->cell) ISO_TRY(iso_editor_set_paint(v->editor, paint, error));
    const iso_history_opts history = {.items = iso_editor_items(v->editor)};
    ISO_TRY(iso_history_create(v->grid, &history, &v->history, error));
    v->keys = ISO_PARTS * iso_hgrid_cell_count(v->grid);
    v->first = iso_alloc_zero(v->keys, sizeof *v->first);
    v->held = iso_alloc_zero(v->keys, sizeof *v->held);
    v->before = iso_alloc_zero(v->keys, sizeof *v->before);
    v->after = iso_alloc_zero(v->keys, sizeof *v->after);
    v->dirty_at = iso_alloc_zero(v->keys, sizeof *v->dirty_at);
    v->room = iso_alloc(ISO_BRICK_VOXELS * sizeof *v->room);
    for (int sign = 0; sign < 2; sign++) {
        v->constant[sign] = iso_alloc(ISO_BRICK_VOXELS * sizeof(float));
        for (int i = 0; v->constant[sign] && i < ISO_BRICK_VOXELS; i++)
            v->constant[sign][i] = sign ? -v->grid->band : v->grid->band;
    }
    const bool whole = v->first && v->held && v->before && v->after && v->dirty_at && v->room &&
                       v->constant[0] && v->constant[1];
    return whole ? ISO_OK : iso_versions_no_memory(error);
}

iso_status iso_versions_create(iso_hgrid *first, const iso_cell_items *paint, size_t memory, iso_pool *pool,
                               iso_versions_check *check, void *context, iso_versions **versions,
                               iso_error *error) {
    iso_versions *v = iso_alloc_zero(1, sizeof *v);
    if (!v) {
        iso_hgrid_destroy(first);
        return iso_versions_no_memory(error);
    }
    v->grid = first;
    v->store.limit = memory;
    v->check = check;
    v->context = context;
    v->pool = pool;
    iso_status status = set_up(v, paint, pool, error);
    if (status == ISO_OK)
        *versions = v;
    else
        iso_versions_destroy(v);
    return status;
}

/* ---- updating */

/* An update: the strokes of the new list that are drawn, with the old ones that they keep. */
typedef struct update {
    iso_stroke **strokes;
    iso_drawn *
        *old; /* by stroke: as it was drawn in the old list, in the same order there; NULL: not at all */
    iso_drawn **made; /* by stroke: new, owned until the update succeeds; NULL: `old` is kept */
    size_t count;
} update;

static void free_update(iso_versions *v, update *u) {
    for (size_t i = 0; u->made && i < u->count; i++) iso_drawn_free(v, u->made[i]);
    iso_free(u->strokes);
    iso_free(u->old);
    iso_free(u->made);
}

/* Finds the longest sequence of strokes that are in the same order in both lists; the others are drawn anew.
 * places: by stroke of the new list its place in the old one, or SIZE_MAX. Sets the others' to SIZE_MAX. */
static bool keep_longest_order(size_t *places, size_t count) {
    size_t *ends = iso_alloc(2 * count * sizeof *ends), *from = ends ? ends + count : NULL, length = 0;
    if (!ends) return false;
    for (size_t i = 0; i < count; i++) {
        size_t lo = 0, hi = length;
        if (places[i] == SIZE_MAX) continue;
        while (lo < hi) {
            const size_t middle = (lo + hi) / 2;
            if (places[ends[middle]] < places[i])
                lo = middle + 1;
            else
                hi = middle;
        }
        from[i] = lo ? ends[lo - 1] : SIZE_MAX;
        ends[lo] = i;
        length += lo == length;
    }
    size_t next = length ? ends[length - 1] : SIZE_MAX;
    for (size_t i = count; i-- > 0;)
        if (i == next)
            next = from[i];
        else
            places[i] = SIZE_MAX;
    iso_free(ends);
    return true;
}

/* Matches the strokes of the new list with those of the old one. */
static iso_status match(iso_versions *v, const iso_stroke_list *list, update *u, iso_error *error) {
    unsigned most = 0;
    for (size_t i = 0; i < v->count; i++) most = v->list[i]->number > most ? v->list[i]->number : most;
    u->strokes = iso_alloc_zero(list->count + 1, sizeof *u->strokes);
    u->old = iso_alloc_zero(list->count + 1, sizeof *u->old);
    u->made = iso_alloc_zero(list->count + 1, sizeof *u->made);
    size_t *by_number = iso_alloc_zero((size_t)most + 1, sizeof *by_number),
           *places = iso_alloc_zero(list->count + 1, sizeof *places);
    bool whole = u->strokes && u->old && u->made && by_number && places;
    for (size_t i = 0; whole && i < v->count; i++) by_number[v->list[i]->number] = i + 1;
    for (size_t i = 0; whole && i < list->count; i++) {
        iso_stroke *stroke = iso_stroke_at(list, i);
        if (!stroke->muted) u->strokes[u->count++] = stroke;
    }
    for (size_t i = 0; whole && i < u->count; i++) {
        const unsigned number = u->strokes[i]->number;
        places[i] = number <= most && by_number[number] ? by_number[number] - 1 : SIZE_MAX;
    }
    whole = whole && (u->count == 0 || keep_longest_order(places, u->count));
    for (size_t i = 0; whole && i < u->count; i++)
        if (places[i] != SIZE_MAX) u->old[i] = v->list[places[i]];
    iso_free(by_number);
    iso_free(places);
    return whole ? ISO_OK : iso_versions_no_memory(error);
}

static bool is_drawn_so(const iso_drawn *d, const iso_stroke *stroke) {
    return d->path == stroke->path && iso_brush_is_same(&d->brush, &stroke->brush);
}

/* Moves lists on by a stroke. */
static void apply(iso_versions *v, iso_drawn *d, bool in_old, bool in_new) {
    const int made = iso_list_made(v);
    for (size_t i = 0; i < d->count; i++) {
        iso_cell_version *at = &d->versions[i];
        if (in_new) {
            const iso_cell_version *before = v->after[at->key];
            if (at->before[made] != before) at->before[made] = before; /* (mostly it is; memory is slow) */
            v->after[at->key] = at;
        }
        if (in_old) v->before[at->key] = at;
    }
}

/* Moves the old list on by a stroke that the new one does not have here. */
static iso_status leave_out(iso_versions *v, iso_drawn *d, iso_error *error) {
    apply(v, d, true, false);
    for (size_t i = 0; i < d->count; i++) ISO_TRY(iso_versions_judge(v, d->versions[i].key, error));
    return ISO_OK;
}

/* Whether two versions change the same in contents that were the same. */
static bool changes_the_same(const iso_cell_version *a, const iso_cell_version *b) {
    return a->state == b->state && a->touches == b->touches && a->end == b->end &&
           (a->touches + a->end == 0 || memcmp(a->bytes, b->bytes, a->touches + a->end) == 0);
}

/* Moves the lists on by a stroke that was `old` (NULL: it was not there) and is `made` now. */
static iso_status replace(iso_versions *v, iso_drawn *old, iso_drawn *made, iso_error *error) {
    if (old) apply(v, old, true, false);
    apply(v, made, false, true);
    for (size_t i = 0; i < made->count; i++) {
        const iso_cell_version *now = &made->versions[i], *was = v->before[now->key];
        const bool both = old && was >= old->versions && was < old->versions + old->count;
        if (v->dirty_at[now->key] || !both || !changes_the_same(was, now))
            ISO_TRY(iso_versions_judge(v, now->key, error));
    }
    for (size_t i = 0; old && i < old->count; i++) {
        const iso_cell_version *is = v->after[old->versions[i].key];
        if (!is || is < made->versions || is >= made->versions + made->count)
            ISO_TRY(iso_versions_judge(v, old->versions[i].key, error));
    }
    return ISO_OK;
}

/* The number of strokes of the new list after the last one that may be kept. */
static size_t count_keepable(const update *u) {
    size_t count = u->count;
    while (count && !u->old[count - 1]) count--;
    return count;
}

/* Walks both lists and draws what must be drawn. */
static iso_status walk(iso_versions *v, update *u, const iso_versions_visitor *visitor,
                       const iso_progress *progress, iso_error *error) {
    const size_t keepable = count_keepable(u);
    size_t old = 0;
    for (size_t i = 0; i < u->count; i++) {
        iso_drawn *kept = u->old[i];
        iso_concern concern = ISO_CONCERN_TOUCHES;
        ISO_TRY(iso_progress_tell(progress, "the strokes", (double)i / (double)u->count, error));
        v->blind = i >= keepable;
        while (kept && v->list[old] != kept) ISO_TRY(leave_out(v, v->list[old++], error));
        old += kept != NULL;
        if (visitor) ISO_TRY(visitor->visit(visitor->context, v, u->strokes[i], error));
        if (kept && is_drawn_so(kept, u->strokes[i]))
            ISO_TRY(iso_versions_find_concern(v, kept, &concern, error));
        if (concern == ISO_CONCERN_NONE) {
            apply(v, kept, true, true);
            continue;
        }
        ISO_TRY(concern == ISO_CONCERN_END ? iso_versions_end_again(v, kept, &u->made[i], error)
                                           : iso_versions_draw(v, u->strokes[i], &u->made[i], error));
        ISO_TRY(replace(v, kept, u->made[i], error));
    }
    v->blind = true;
    while (old < v->count) ISO_TRY(leave_out(v, v->list[old++], error));
    v->blind = false;
    return iso_versions_settle(v, error);
}

/* Makes the new list the present one and frees the versions that it does not have (changes refer to those of
 * the new list). */
static void accept(iso_versions *v, update *u) {
    for (size_t i = 0; i < u->count; i++)
        if (!u->made[i]) u->old[i]->kept = true;
    for (size_t i = 0; i < v->count; i++)
        if (v->list[i]->kept)
            v->list[i]->kept = false;
        else
            iso_drawn_free(v, v->list[i]);
    for (size_t i = 0; i < u->count; i++) {
        if (u->made[i]) u->old[i] = u->made[i];
        u->made[i] = NULL;
    }
    iso_free(v->list);
    v->list = u->old;
    v->count = u->count;
    v->list_now = iso_list_made(v);
    u->old = NULL;
}

iso_status iso_versions_update(iso_versions *v, const iso_stroke_list *list,
                               const iso_versions_visitor *visitor, const iso_progress *progress,
                               iso_error *error) {
    update u = {.count = 0};
    memset(v->before, 0, v->keys * sizeof *v->before);
    memset(v->after, 0, v->keys * sizeof *v->after);
    iso_versions_clear_dirty(v);
    if (v->cache) memset(v->cache->of, 0, sizeof v->cache->of);
    iso_status status = match(v, list, &u, error);
    if (status == ISO_OK) status = walk(v, &u, visitor, progress, error);
    if (status == ISO_OK) {
        v->stats.strokes += u.count;
        accept(v, &u);
    } else
        iso_versions_clear_dirty(v);
    free_update(v, &u);
    return status;
}

/* ---- results */

size_t iso_versions_change_count(const iso_versions *v) {
    return v->dirty_count;
}

static const iso_cell_version *changed_to(const iso_versions *v, size_t index) {
    const iso_cell_key key = v->dirty[index].key;
    return iso_or_first(v, key, v->after[key]);
}

iso_cell_change iso_versions_change(const iso_versions *v, size_t index) {
    const iso_cell_version *at = changed_to(v, index);
    return (iso_cell_change){
        .cell = iso_cell_of_key(at->key), .kind = iso_part_of_key(at->key) - 1, .state = at->state};
}

void iso_versions_change_values(const iso_versions *v, size_t index, void *values) {
    const iso_cell_version *at = changed_to(v, index);
    if (iso_part_of_key(at->key) != ISO_PART_DISTANCES)
        iso_version_read_item(v, at, values);
    else
        iso_version_read(v, at, v->list_now, ISO_NO_SERIAL, values);
}

/* The eight voxels around a place: of each its cell's key, its number there, its distance and weight; and the
 * cells, of which there are at most as many. */
typedef struct corners {
    iso_cell_key key[8];
    int voxel[8];
    double value[8], weight[8];
    float cells[8][ISO_BRICK_VOXELS]; /* that of a corner is that of the first corner in it */
} corners;

/* The first corner in a cell; -1: there is none. */
static int corner_in(const corners *c, iso_cell_key key) {
    for (int k = 0; k < 8; k++)
        if (c->key[k] == key) return k;
    return -1;
}

/* Takes the distances after a version, which follows the ones taken, if corners lie in its cell. */
static bool take_values(const iso_versions *v, const iso_cell_version *at, corners *c) {
    const int first = corner_in(c, at->key);
    if (first < 0) return false;
    iso_cell_delta_apply(at->bytes, at->touches, v->grid->band, c->cells[first]);
    iso_cell_delta_apply(at->bytes + at->touches, at->end, v->grid->band, c->cells[first]);
    for (int k = 0; k < 8; k++)
        if (c->key[k] == at->key) c->value[k] = (double)c->cells[first][c->voxel[k]];
    return true;
}

static double interpolate(const corners *c) {
    double sum = 0;
    for (int k = 0; k < 8; k++) sum += c->weight[k] * c->value[k];
    return sum;
}

unsigned iso_versions_find(const iso_versions *v, const double at[3]) {
    const double least = 0.05;
    corners c;
    memset(c.value, 0, sizeof c.value);
    unsigned found = 0;
    for (int k = 0; k < 8; k++) {
        int voxel[3];
        c.weight[k] = 1;
        for (int axis = 0; axis < 3; axis++) {
            const double down = floor(at[axis]), part = at[axis] - down;
            if (!(down >= 0 && down < v->grid->dims[axis] - 1)) return 0;
            voxel[axis] = (int)down + (k >> axis & 1);
            c.weight[k] *= k >> axis & 1 ? part : 1 - part;
        }
        c.key[k] =
            (iso_cell_key)(ISO_PARTS * iso_hgrid_cell_index(v->grid, voxel[0] / ISO_BRICK,
                                                            voxel[1] / ISO_BRICK, voxel[2] / ISO_BRICK));
        c.voxel[k] =
            (voxel[2] % ISO_BRICK * ISO_BRICK + voxel[1] % ISO_BRICK) * ISO_BRICK + voxel[0] % ISO_BRICK;
    }
    for (int k = 0; k < 8; k++) {
        const iso_cell_version *first = v->first[c.key[k]];
        const int in = corner_in(&c, c.key[k]);
        if (first && in == k) iso_version_read(v, first, v->list_now, ISO_NO_SERIAL, c.cells[k]);
        if (first) c.value[k] = (double)c.cells[in][c.voxel[k]]; /* (else no stroke wrote the cell) */
    }
    double before = interpolate(&c);
    for (size_t i = 0; i < v->count; i++) {
        bool any = false;
        for (size_t m = 0; m < v->list[i]->count; m++) any |= take_values(v, &v->list[i]->versions[m], &c);
        const double now = any ? interpolate(&c) : before;
        if (fabs(now - before) > least) found = v->list[i]->number;
        before = now;
    }
    return found;
}

/* ---- the surface along a line */

/* Returns the distance at a voxel, at this place of the new list. */
static double value_at(iso_versions *v, const int at[3]) {
    const size_t cell =
        iso_hgrid_cell_index(v->grid, at[0] / ISO_BRICK, at[1] / ISO_BRICK, at[2] / ISO_BRICK);
    const iso_cell_key key = (iso_cell_key)(ISO_PARTS * cell);
    const iso_cell_version *is = iso_or_first(v, key, v->after[key]);
    const int voxel = (at[2] % ISO_BRICK * ISO_BRICK + at[1] % ISO_BRICK) * ISO_BRICK + at[0] % ISO_BRICK;
    const int32_t state = is ? is->state : v->grid->cell[cell];
    if (is && is->state == 0) {
        const int slot = (int)(cell % CACHED);
        if (v->cache->of[slot] != is)
            iso_version_read(v, is, iso_list_made(v), ISO_NO_SERIAL, v->cache->bricks[slot]);
        v->cache->of[slot] = is;
        return (double)v->cache->bricks[slot][voxel];
    }
    if (!is && state >= 0) return (double)iso_hgrid_brick(v->grid, state)[voxel];
    return state == ISO_CELL_INSIDE ? -(double)v->grid->band : (double)v->grid->band;
}

/* A line in voxels; t: along it. */
typedef struct line {
    double from[3], along[3];
} line;

/* The distance at a place of the line; NAN outside of the grid. */
static double value_on(iso_versions *v, const line *l, double t) {
    double part[3], sum = 0;
    int down[3];
    for (int axis = 0; axis < 3; axis++) {
        const double at = l->from[axis] + t * l->along[axis];
        if (!(at >= 0 && at < v->grid->dims[axis] - 1)) return NAN;
        down[axis] = (int)at;
        part[axis] = at - down[axis];
    }
    for (int k = 0; k < 8; k++) {
        double weight = 1;
        int at[3];
        for (int axis = 0; axis < 3; axis++) {
            at[axis] = down[axis] + (k >> axis & 1);
            weight *= k >> axis & 1 ? part[axis] : 1 - part[axis];
        }
        if (weight > 0) sum += weight * value_at(v, at);
    }
    return sum;
}

/* Where the distance, which is inside at lo and outside at hi, is 0. */
static double find_root(iso_versions *v, const line *l, double lo, double hi) {
    for (int i = 0; i < 30; i++) {
        const double middle = 0.5 * (lo + hi);
        *(value_on(v, l, middle) > 0 ? &hi : &lo) = middle;
    }
    return 0.5 * (lo + hi);
}

iso_status iso_versions_cast(iso_versions *v, const iso_sample *sample, double *distance, iso_error *error) {
    const double step = 0.5;
    const iso_affine affine = iso_transform_affine(&v->grid->transform);
    const iso_vec3 from = iso_affine_point_to_index(&affine, sample->position),
                   along = iso_affine_vector_to_index(&affine, iso_vec3_unit(sample->normal));
    const double voxels = iso_vec3_length(along); /* to one mm */
    const int *dims = v->grid->dims, most = dims[0] > dims[1] ? dims[0] : dims[1],
              steps = (most > dims[2] ? most : dims[2]) / 2;
    line l;
    *distance = NAN;
    if (!v->cache) v->cache = iso_alloc_zero(1, sizeof *v->cache);
    if (!v->cache) return iso_versions_no_memory(error);
    if (!(voxels > 0)) return ISO_OK;
    iso_vec3_store(from, l.from);
    iso_vec3_store(iso_vec3_scale(along, 1 / voxels), l.along);
    double ahead = value_on(v, &l, 0), behind = ahead;
    for (int i = 1; i <= steps; i++) {
        const double next = value_on(v, &l, i * step), last = value_on(v, &l, -i * step);
        const bool leaves = ahead <= 0 && next > 0, left = last <= 0 && behind > 0;
        if (leaves || left) {
            const double lo = leaves ? (i - 1) * step : -i * step;
            *distance = find_root(v, &l, lo, lo + step) / voxels;
            return ISO_OK;
        }
        ahead = next;
        behind = last;
    }
    return ISO_OK;
}

iso_versions_stats iso_versions_get_stats(const iso_versions *v) {
    iso_versions_stats stats = v->stats;
    stats.cost = iso_editor_cost(v->editor);
    stats.bytes = v->store.in_memory + v->store.in_files;
    stats.in_files = v->store.in_files;
    return stats;
}
