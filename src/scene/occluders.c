/* occluders: voxels of grids become bits, brick by brick; objects are added to them. */
#include "scene/occluders.h"

#include <math.h>
#include <string.h>

#include "grids/change_log.h"
#include "grids/threshold.h"
#include "render/occlusion/object_bits.h"
#include "render/shading/phong.h"

/* Empty voxels around the surfaces, so that what lies at a border has nodes. */
enum { MARGIN = 2 };
/* Voxels along the longest side of a lattice of objects alone. */
enum { OBJECT_VOXELS = 256 };
static const uint64_t MOST_BYTES = (uint64_t)1 << 30;

/* ---- the lattice */

static bool equal_transforms(const iso_transform *a, const iso_transform *b) {
    return memcmp(a, b, sizeof *a) == 0;
}

/* Adds a box in the index coordinates `own` to one in those of the lattice's voxels. */
static void add_box(iso_box *box, const iso_affine *first, const iso_box *more, const iso_affine *own) {
    for (int corner = 0; corner < 8 && !iso_box_is_empty(more); corner++)
        iso_box_add(box,
                    iso_affine_point_to_index(first, iso_affine_point(own, iso_box_corner(more, corner))));
}

/* The box of the objects, in the world. */
static iso_box box_of_objects(const iso_occluding *all) {
    iso_box box = iso_box_empty();
    for (int i = 0; i < all->object_count; i++) {
        const iso_box own = iso_scene_object_bounds(all->objects[i]);
        if (iso_box_is_empty(&own)) continue;
        iso_box_add(&box, own.lo);
        iso_box_add(&box, own.hi);
    }
    return box;
}

/* The index coordinates of the lattice's voxels before it is made coarser, and the box of what is in it. */
static iso_affine find_voxels(const iso_occluding *all, const iso_box *objects, iso_box *box) {
    const iso_transform identity = iso_transform_identity();
    const iso_affine world = iso_transform_affine(&identity);
    iso_transform cubes = identity;
    if (!all->count && !iso_box_is_empty(objects)) {
        const iso_vec3 size = iso_vec3_sub(objects->hi, objects->lo);
        const double longest = fmax(size.x, fmax(size.y, size.z));
        for (int axis = 0; axis < 3; axis++) cubes.spacing[axis] = longest > 0 ? longest / OBJECT_VOXELS : 1;
        iso_vec3_store(objects->lo, cubes.origin);
    }
    const iso_affine first =
        iso_transform_affine(all->count ? iso_grid_transform(&all->surfaces[0]->grid) : &cubes);
    *box = iso_box_empty();
    for (int i = 0; i < all->count; i++) {
        const iso_affine own = iso_transform_affine(iso_grid_transform(&all->surfaces[i]->grid));
        const int *dims = iso_grid_dims(&all->surfaces[i]->grid);
        const iso_box voxels = {{0, 0, 0}, {dims[0] - 1, dims[1] - 1, dims[2] - 1}};
        add_box(box, &first, &voxels, &own);
    }
    add_box(box, &first, objects, &world);
    if (iso_box_is_empty(box)) iso_box_add(box, iso_vec3_make(0, 0, 0));
    return first;
}

/* The size of the lattice with voxels of `coarse` voxels of the first surface's grid. */
static void size_lattice(const iso_box *box, int coarse, int origin[3], int dims[3]) {
    const double lo[3] = {box->lo.x, box->lo.y, box->lo.z}, hi[3] = {box->hi.x, box->hi.y, box->hi.z};
    for (int axis = 0; axis < 3; axis++) {
        origin[axis] = (int)floor(lo[axis] + 1e-6) - MARGIN * coarse;
        dims[axis] = (int)ceil((hi[axis] - 1e-6 - origin[axis]) / coarse) + MARGIN + 1;
    }
}

static iso_status make_lattice(iso_occluders *o, const iso_occluding *all, uint64_t most, iso_error *error) {
    iso_box box;
    const iso_affine first = find_voxels(all, &o->box, &box);
    int coarse = 1, dims[3];
    for (;; coarse *= 2) {
        const double side = fmax(box.hi.x - box.lo.x, fmax(box.hi.y - box.lo.y, box.hi.z - box.lo.z));
        if (side / coarse > 1 << 14) continue;
        size_lattice(&box, coarse, o->origin, dims);
        if (iso_solid_bits_bytes(dims) <= most || coarse >= 1 << 14) break;
    }
    iso_affine affine = first;
    const iso_vec3 origin = iso_affine_point(&first, iso_vec3_make(o->origin[0] + 0.5 * (coarse - 1),
                                                                   o->origin[1] + 0.5 * (coarse - 1),
                                                                   o->origin[2] + 0.5 * (coarse - 1)));
    affine.origin[0] = origin.x;
    affine.origin[1] = origin.y;
    affine.origin[2] = origin.z;
    for (int i = 0; i < 9; i++) {
        affine.m[i] *= coarse;
        affine.inverse[i] /= coarse;
    }
    affine.determinant *= (double)coarse * coarse * coarse;
    ISO_TRY(iso_solid_bits_create(dims, &affine, &o->bits, error));
    for (int i = 0; i < all->count; i++)
        if (o->occluders[i].clip.count && !o->removed.words)
            ISO_TRY(iso_solid_bits_create(dims, &affine, &o->removed, error));
    o->coarse = coarse;
    return ISO_OK;
}

/* ---- voxels */

/* The bits of a brick: row (z, y) of 16 voxels along x. */
typedef uint16_t brick_bits[ISO_BRICK][ISO_BRICK];

static bool is_solid(const iso_threshold *t, float value) {
    return isfinite(value) && iso_threshold_inside(t, value) == (t->normal_sign < 0);
}

/* Adds the voxels of a brick of a grid whose voxels are those of the lattice. */
static void add_brick(const iso_grid *grid, const iso_threshold *t, const int brick[3], brick_bits bits) {
    const int *dims = iso_grid_dims(grid);
    int left[3], bricks[3];
    iso_grid_bricks(grid, bricks);
    for (int axis = 0; axis < 3; axis++) {
        if (brick[axis] < 0 || brick[axis] >= bricks[axis]) return;
        const int rest = dims[axis] - ISO_BRICK * brick[axis];
        left[axis] = rest < ISO_BRICK ? rest : ISO_BRICK;
    }
    const uint16_t row = (uint16_t)((1u << left[0]) - 1);
    const bool may_differ = grid->rgrid && grid->rgrid->type == ISO_FLOAT32; /* voxels that are no numbers */
    if (!may_differ && !iso_grid_brick_may_cross(grid, brick, t->isovalue_ceil)) {
        if (!is_solid(t, iso_grid_at(grid, ISO_BRICK * brick[0], ISO_BRICK * brick[1], ISO_BRICK * brick[2])))
            return;
        for (int z = 0; z < left[2]; z++)
            for (int y = 0; y < left[1]; y++) bits[z][y] |= row;
        return;
    }
    float window[ISO_WINDOW_VOXELS];
    iso_grid_window(grid, brick, window);
    for (int z = 0; z < left[2]; z++)
        for (int y = 0; y < left[1]; y++) {
            const float *value = window +
                                 ((z + ISO_WINDOW_LOW) * ISO_WINDOW + y + ISO_WINDOW_LOW) * ISO_WINDOW +
                                 ISO_WINDOW_LOW;
            unsigned solid = 0;
            for (int x = 0; x < ISO_BRICK; x++) solid |= (unsigned)is_solid(t, value[x]) << x;
            bits[z][y] |= (uint16_t)(solid & row);
        }
}

/* Adds the voxels of a grid that has others than the lattice: the nearest ones. `at`: the first voxel of the
 * lattice. */
static void add_nearest(const iso_solid_bits *lattice, const iso_grid *grid, const iso_threshold *t,
                        const int at[3], brick_bits bits) {
    const iso_affine own = iso_transform_affine(iso_grid_transform(grid));
    const int *dims = iso_grid_dims(grid);
    for (int z = 0; z < ISO_BRICK; z++)
        for (int y = 0; y < ISO_BRICK; y++)
            for (int x = 0; x < ISO_BRICK; x++) {
                const iso_vec3 place = iso_affine_point_to_index(
                    &own, iso_affine_point(&lattice->affine, iso_vec3_make(at[0] + x, at[1] + y, at[2] + z)));
                const double i = floor(place.x + 0.5), j = floor(place.y + 0.5), k = floor(place.z + 0.5);
                if (!(i >= 0 && i < dims[0] && j >= 0 && j < dims[1] && k >= 0 && k < dims[2])) continue;
                if (is_solid(t, iso_grid_at(grid, (int)i, (int)j, (int)k))) bits[z][y] |= (uint16_t)(1u << x);
            }
}

typedef struct filling {
    iso_occluders *occluders;
    iso_threshold thresholds[ISO_OCCLUDERS_MAX];
    bool fits[ISO_OCCLUDERS_MAX]; /* the voxels of the grid are those of the lattice */
    int lo[3], hi[3];             /* bricks, in the first grid's numbers where its voxels are the lattice's */
} filling;

/* Takes the voxels that a clip cuts away out of `bits`, and adds them to `removed`. `at`: the first voxel of
 * the lattice. */
static void cut(const iso_solid_bits *lattice, const iso_clip *clip, const int at[3], brick_bits bits,
                brick_bits removed) {
    const iso_affine *affine = &lattice->affine;
    const double reach = 0.5 * ISO_BRICK, middle = reach - 0.5;
    const iso_vec3 centre = iso_affine_point(affine,
                                             iso_vec3_make(at[0] + middle, at[1] + middle, at[2] + middle)),
                   half[3] = {iso_affine_vector(affine, iso_vec3_make(reach, 0, 0)),
                              iso_affine_vector(affine, iso_vec3_make(0, reach, 0)),
                              iso_affine_vector(affine, iso_vec3_make(0, 0, reach))};
    unsigned cutting = 0;
    const iso_clip_rest rest = iso_clip_of_box(clip, centre, half, &cutting);
    if (rest == ISO_CLIP_ALL) return;
    for (int z = 0; z < ISO_BRICK; z++)
        for (int y = 0; y < ISO_BRICK; y++)
            for (unsigned left = bits[z][y]; left; left &= left - 1) {
                const int x = __builtin_ctz(left);
                const iso_vec3 place =
                    iso_affine_point(affine, iso_vec3_make(at[0] + x, at[1] + y, at[2] + z));
                if (rest == ISO_CLIP_SOME && iso_clip_shows(clip, place)) continue;
                bits[z][y] &= (uint16_t) ~(1u << x);
                removed[z][y] |= (uint16_t)(1u << x);
            }
}

static void fill_brick(const filling *f, const int brick[3]) {
    iso_occluders *o = f->occluders;
    brick_bits all = {{0}}, removed = {{0}};
    int at[3];
    for (int axis = 0; axis < 3; axis++)
        at[axis] = ISO_BRICK * brick[axis] - (o->coarse == 1 ? o->origin[axis] : 0);
    for (int i = 0; i < o->count; i++) {
        const iso_occluder *occluder = &o->occluders[i];
        brick_bits bits = {{0}};
        if (f->fits[i])
            add_brick(&occluder->grid, &f->thresholds[i], brick, bits);
        else
            add_nearest(&o->bits, &occluder->grid, &f->thresholds[i], at, bits);
        if (occluder->clip.count) cut(&o->bits, &occluder->clip, at, bits, removed);
        for (int z = 0; z < ISO_BRICK; z++)
            for (int y = 0; y < ISO_BRICK; y++) all[z][y] |= bits[z][y];
    }
    for (int z = 0; z < ISO_BRICK; z++)
        for (int y = 0; y < ISO_BRICK; y++) {
            iso_solid_bits_write(&o->bits, at[0], at[1] + y, at[2] + z, ISO_BRICK, all[z][y]);
            if (o->removed.words)
                iso_solid_bits_write(&o->removed, at[0], at[1] + y, at[2] + z, ISO_BRICK, removed[z][y]);
        }
}

/* Layers of bricks share no words. */
static void fill_layer(void *context, size_t index, int worker) {
    (void)worker;
    const filling *f = context;
    int brick[3] = {0, 0, f->lo[2] + (int)index};
    for (brick[1] = f->lo[1]; brick[1] <= f->hi[1]; brick[1]++)
        for (brick[0] = f->lo[0]; brick[0] <= f->hi[0]; brick[0]++) fill_brick(f, brick);
}

static int floor_divide(int a, int b) {
    return a >= 0 ? a / b : -((b - 1 - a) / b);
}

static filling start_filling(iso_occluders *o) {
    filling f = {.occluders = o};
    for (int i = 0; i < o->count; i++) {
        const iso_grid *grid = &o->occluders[i].grid, *first = &o->occluders[0].grid;
        f.thresholds[i] = iso_threshold_of(grid, o->occluders[i].isovalue);
        f.fits[i] = o->coarse == 1 && equal_transforms(iso_grid_transform(grid), iso_grid_transform(first));
    }
    for (int axis = 0; axis < 3; axis++) {
        const int origin = o->coarse == 1 ? o->origin[axis] : 0;
        f.lo[axis] = floor_divide(origin, ISO_BRICK);
        f.hi[axis] = floor_divide(origin + o->bits.dims[axis] - 1, ISO_BRICK);
    }
    return f;
}

static void fill_all(iso_occluders *o, iso_pool *pool) {
    filling f = start_filling(o);
    iso_parallel_for(pool, (size_t)(f.hi[2] - f.lo[2] + 1), fill_layer, &f);
}

/* ---- following edits */

static void follow_change(const filling *f, const iso_grid *grid, const iso_change *change) {
    iso_occluders *o = f->occluders;
    int bricks[3], lo[3], hi[3];
    iso_grid_bricks(grid, bricks);
    const int row = (int)(change->cell / (uint32_t)bricks[0]);
    const int brick[3] = {(int)(change->cell % (uint32_t)bricks[0]), row % bricks[1], row / bricks[1]};
    fill_brick(f, brick);
    for (int axis = 0; axis < 3; axis++) {
        lo[axis] = ISO_BRICK * brick[axis] + change->lo[axis] - o->origin[axis];
        hi[axis] = ISO_BRICK * brick[axis] + change->hi[axis] - o->origin[axis];
    }
    iso_occlusion_forget(&o->occlusion, lo, hi);
}

/* Whether there have been no edits that cannot be followed: all grids have the lattice's voxels, or were not
 * edited. */
static bool can_follow(const iso_occluders *o, const filling *f) {
    for (int i = 0; i < o->count; i++)
        if (!f->fits[i] && iso_change_log_now(iso_grid_log(&o->occluders[i].grid)) != o->occluders[i].edit)
            return false;
    return true;
}

static void follow_edits(iso_occluders *o, const filling *f) {
    for (int i = 0; i < o->count; i++) {
        iso_occluder *occluder = &o->occluders[i];
        const iso_change_log *log = iso_grid_log(&occluder->grid);
        const iso_change *changes;
        if (iso_change_log_now(log) == occluder->edit) continue;
        const size_t count = iso_change_log_since(log, occluder->edit, &changes);
        for (size_t k = 0; k < count; k++) follow_change(f, &occluder->grid, &changes[k]);
        occluder->edit = iso_change_log_now(log);
    }
}

/* With zeros in all bodies but those in use, to be compared byte by byte. */
static iso_clip clip_of(const iso_scene_surface *surface) {
    iso_clip clip;
    memset(&clip, 0, sizeof clip);
    if (surface->clip) memcpy(&clip, surface->clip, sizeof clip);
    return clip;
}

static bool is_of(const iso_occluders *o, const iso_occluding *all) {
    const iso_scene_surface *const *surfaces = all->surfaces;
    const iso_box box = box_of_objects(all);
    if (!o->coarse || o->count != all->count || memcmp(&box, &o->box, sizeof box) != 0) return false;
    for (int i = 0; i < all->count; i++) {
        const iso_occluder *occluder = &o->occluders[i];
        if (occluder->grid.rgrid != surfaces[i]->grid.rgrid ||
            occluder->grid.hgrid != surfaces[i]->grid.hgrid || occluder->isovalue != surfaces[i]->isovalue)
            return false;
        const iso_clip clip = clip_of(surfaces[i]);
        if (memcmp(&clip, &occluder->clip, sizeof clip) != 0) return false;
    }
    return true;
}

void iso_occluders_free(iso_occluders *o) {
    iso_occlusion_free(&o->occlusion);
    iso_solid_bits_free(&o->bits);
    iso_solid_bits_free(&o->removed);
    iso_solid_bits_free(&o->things);
    *o = (iso_occluders){.coarse = 0};
}

/* Adds what objects fill to the bits; it is drawn anew, as nothing says whether an object has changed. */
static iso_status add_objects(iso_occluders *o, const iso_occluding *all, iso_pool *pool, iso_error *error) {
    const size_t words = o->bits.layer * (size_t)o->bits.dims[2];
    iso_solid_bits now;
    if (!all->object_count) return ISO_OK;
    ISO_TRY(iso_solid_bits_create(o->bits.dims, &o->bits.affine, &now, error));
    for (int i = 0; i < all->object_count; i++) {
        const iso_scene_object *object = all->objects[i];
        const iso_mesh_view mesh = iso_triangle_spans_view(&object->spans);
        if (object->shapes)
            iso_solid_bits_add_shapes(&now, object->shapes, object->clip, pool);
        else
            iso_solid_bits_add_mesh(&now, &mesh, object->clip, pool);
    }
    if (o->things.words && memcmp(o->things.words, now.words, words * sizeof *now.words) != 0) {
        fill_all(o, pool);
        iso_occlusion_reset(&o->occlusion);
    }
    iso_solid_bits_free(&o->things);
    o->things = now;
    o->occlusion.things = &o->things;
    for (size_t i = 0; i < words; i++) o->bits.words[i] |= now.words[i];
    return ISO_OK;
}

static iso_status make(iso_occluders *o, const iso_occluding *all, uint64_t most, iso_pool *pool,
                       iso_error *error) {
    const iso_scene_surface *const *surfaces = all->surfaces;
    iso_occluders_free(o);
    o->count = all->count;
    o->box = box_of_objects(all);
    for (int i = 0; i < all->count; i++)
        o->occluders[i] =
            (iso_occluder){surfaces[i]->grid, surfaces[i]->isovalue,
                           iso_change_log_now(iso_grid_log(&surfaces[i]->grid)), clip_of(surfaces[i])};
    ISO_TRY(make_lattice(o, all, most, error));
    if (o->count) fill_all(o, pool);
    o->occlusion = (iso_occlusion){.bits = &o->bits, .removed = o->removed.words ? &o->removed : NULL};
    for (int axis = 0; axis < 3; axis++) {
        o->occlusion.lo[axis] = MARGIN;
        o->occlusion.hi[axis] = o->bits.dims[axis] - 1 - MARGIN;
    }
    return ISO_OK;
}

static iso_status update_lattice(iso_occluders *o, const iso_occluding *all, const iso_occlusion_opts *opts,
                                 iso_pool *pool, iso_error *error) {
    const uint64_t most = opts->most_bytes ? opts->most_bytes : MOST_BYTES;
    const bool same = is_of(o, all);
    const filling f = same ? start_filling(o) : (filling){.occluders = NULL};
    if (same && can_follow(o, &f))
        follow_edits(o, &f);
    else
        ISO_TRY(make(o, all, most, pool, error));
    return add_objects(o, all, pool, error);
}

/* ---- what pictures need */

/* Tenth of the longest side, mm. */
static double usual_range(const iso_solid_bits *bits) {
    double longest = 0;
    for (int axis = 0; axis < 3; axis++) {
        const iso_vec3 unit = iso_vec3_make(axis == 0, axis == 1, axis == 2);
        longest = fmax(longest, iso_vec3_length(iso_affine_vector(&bits->affine, unit)) * bits->dims[axis]);
    }
    return longest / 10;
}

/* Unit, in the world: towards the key light. */
static iso_vec3 light_of(const iso_camera *camera) {
    const iso_view view = iso_view_make(camera, 1, 1);
    const double *r = view.rotation,
                 l[3] = {(double)ISO_PHONG_LIGHT_X, (double)ISO_PHONG_LIGHT_Y, (double)ISO_PHONG_LIGHT_Z};
    return iso_vec3_make(r[0] * l[0] + r[3] * l[1] + r[6] * l[2], r[1] * l[0] + r[4] * l[1] + r[7] * l[2],
                         r[2] * l[0] + r[5] * l[1] + r[8] * l[2]);
}

static void set_occlusion(iso_occluders *o, const iso_occlusion_opts *opts, const iso_camera *camera) {
    iso_occlusion *occlusion = &o->occlusion;
    const double range = !opts->ambient ? 0 : opts->range > 0 ? opts->range : usual_range(&o->bits);
    if (occlusion->range != range || occlusion->has_shadow != opts->shadow) iso_occlusion_reset(occlusion);
    occlusion->range = range;
    occlusion->has_shadow = opts->shadow;
    if (opts->shadow) iso_occlusion_turn(occlusion, light_of(camera));
}

iso_status iso_occluders_update(iso_occluders *o, const iso_occluding *all, const iso_occlusion_opts *opts,
                                const iso_camera *camera, iso_pool *pool, iso_occlusion **occlusion,
                                iso_error *error) {
    *occlusion = NULL;
    if (!(all->count || all->object_count) || !(opts->ambient || opts->shadow)) return ISO_OK;
    const iso_status status = update_lattice(o, all, opts, pool, error);
    if (status != ISO_OK) {
        iso_occluders_free(o);
        return status;
    }
    set_occlusion(o, opts, camera);
    *occlusion = &o->occlusion;
    return ISO_OK;
}
