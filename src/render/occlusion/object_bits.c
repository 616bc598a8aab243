/* object_bits: glyphs are tested voxel by voxel; lines and triangles are followed in steps of half a
 * voxel. */
#include "render/occlusion/object_bits.h"

#include <math.h>

#include "render/shapes/set.h"
#include "render/shapes/solid.h"

/* What is filled, and with what. */
typedef struct filling {
    iso_solid_bits *bits;
    const iso_shapes *shapes; /* NULL: the mesh */
    const iso_mesh_view *mesh;
    const iso_clip *clip;
    double voxel; /* the longest edge of a voxel, mm */
} filling;

/* Sets the bit of a voxel; of any thread. */
static void set_voxel(const filling *f, int x, int y, int z) {
    const iso_solid_bits *bits = f->bits;
    if ((unsigned)x >= (unsigned)bits->dims[0] || (unsigned)y >= (unsigned)bits->dims[1] ||
        (unsigned)z >= (unsigned)bits->dims[2])
        return;
    uint32_t *word = iso_solid_word(bits, x / ISO_SOLID_WORD, y, z);
    const uint32_t bit = 1u << x % ISO_SOLID_WORD;
    if (__atomic_load_n(word, __ATOMIC_RELAXED) & bit) return;
    if (f->clip && f->clip->count &&
        !iso_clip_shows(f->clip, iso_affine_point(&bits->affine, iso_vec3_make(x, y, z))))
        return;
    __atomic_fetch_or(word, bit, __ATOMIC_RELAXED);
}

/* Sets the bit of the voxel around a place in the world. */
static void set_place(const filling *f, iso_vec3 place) {
    const iso_vec3 at = iso_affine_point_to_index(&f->bits->affine, place);
    const int *dims = f->bits->dims;
    if (!(at.x > -1 && at.y > -1 && at.z > -1 && at.x < dims[0] && at.y < dims[1] && at.z < dims[2])) return;
    set_voxel(f, (int)floor(at.x + 0.5), (int)floor(at.y + 0.5), (int)floor(at.z + 0.5));
}

/* How many steps of half a voxel make a way of `length` mm; not more than cross the lattice. */
static int steps_of(const filling *f, double length) {
    const int *dims = f->bits->dims;
    const double steps = ceil(length / f->voxel * 2);
    const int most = 4 * (dims[0] + dims[1] + dims[2]);
    return steps < 1 ? 1 : steps < most ? (int)steps : most;
}

static iso_vec3 between(iso_vec3 a, iso_vec3 b, double t) {
    return iso_vec3_add(a, iso_vec3_scale(iso_vec3_sub(b, a), t));
}

/* ---- boxes of voxels */

/* The voxels, in the lattice, of the box around a place that reaches `reach` mm in every direction; false:
 * there is none. */
static bool box_of(const filling *f, iso_vec3 place, double reach, int lo[3], int hi[3]) {
    const iso_solid_bits *bits = f->bits;
    const double *inverse = bits->affine.inverse;
    double at[3];
    iso_vec3_store(iso_affine_point_to_index(&bits->affine, place), at);
    for (int i = 0; i < 3; i++) {
        const double *row = inverse + 3 * i,
                     wide = reach * sqrt(row[0] * row[0] + row[1] * row[1] + row[2] * row[2]);
        if (!(at[i] + wide >= 0 && at[i] - wide <= bits->dims[i] - 1)) return false;
        lo[i] = (int)fmax(ceil(at[i] - wide), 0);
        hi[i] = (int)fmin(floor(at[i] + wide), bits->dims[i] - 1);
    }
    return true;
}

typedef bool inside_fn(const void *solid, iso_vec3 place);

/* Sets the bits of voxels within `reach` of a place whose centres are in a solid. */
static void fill_box(const filling *f, iso_vec3 place, double reach, inside_fn *inside, const void *solid) {
    int lo[3], hi[3];
    if (!box_of(f, place, reach, lo, hi)) return;
    for (int z = lo[2]; z <= hi[2]; z++)
        for (int y = lo[1]; y <= hi[1]; y++)
            for (int x = lo[0]; x <= hi[0]; x++)
                if (inside(solid, iso_affine_point(&f->bits->affine, iso_vec3_make(x, y, z))))
                    set_voxel(f, x, y, z);
}

typedef struct ball {
    iso_vec3 centre;
    double radius;
} ball;

static bool is_in_ball(const void *solid, iso_vec3 place) {
    const ball *b = solid;
    const iso_vec3 way = iso_vec3_sub(place, b->centre);
    return iso_vec3_dot(way, way) <= b->radius * b->radius;
}

static void fill_ball(const filling *f, iso_vec3 centre, double radius) {
    const ball b = {centre, radius};
    set_place(f, centre);
    if (radius > 0.25 * f->voxel) fill_box(f, centre, radius, is_in_ball, &b);
}

/* ---- glyphs */

typedef struct glyph_solid {
    iso_glyph glyph;
    iso_vec3 centre;
    double inverse[3][3]; /* rows */
    double shaft;         /* of arrows: its radius in the unit solid */
} glyph_solid;

static bool is_in_glyph(const void *solid, iso_vec3 place) {
    const glyph_solid *g = solid;
    const iso_vec3 way = iso_vec3_sub(place, g->centre);
    double p[3];
    for (int i = 0; i < 3; i++)
        p[i] = g->inverse[i][0] * way.x + g->inverse[i][1] * way.y + g->inverse[i][2] * way.z;
    const double round = p[0] * p[0] + p[1] * p[1], z = p[2];
    const double cone = (1 - z) / (g->glyph == ISO_GLYPH_ARROW ? 1 - ISO_ARROW_NECK : 2);
    if (g->glyph == ISO_GLYPH_ELLIPSOID) return round + z * z <= 1;
    if (!(fabs(z) <= 1)) return false;
    if (g->glyph == ISO_GLYPH_BOX) return fabs(p[0]) <= 1 && fabs(p[1]) <= 1;
    if (g->glyph == ISO_GLYPH_CONE) return round <= cone * cone;
    if (g->glyph == ISO_GLYPH_ARROW) return round <= (z < ISO_ARROW_NECK ? g->shaft * g->shaft : cone * cone);
    return round <= 1;
}

/* Makes an axis of a solid at least half a voxel long. */
static void thicken(double axis[3], double least) {
    const double length = sqrt(axis[0] * axis[0] + axis[1] * axis[1] + axis[2] * axis[2]);
    for (int i = 0; i < 3 && length > 0 && length < least; i++) axis[i] *= least / length;
}

static void fill_glyph(const filling *f, uint32_t id, iso_vec3 place) {
    iso_solid_map map;
    if (f->shapes->kind == ISO_SHAPE_SPHERE) {
        fill_ball(f, place, iso_solid_reach(f->shapes, id));
        return;
    }
    if (!iso_solid_map_of(f->shapes, id, &map)) return;
    const double least = 0.6 * f->voxel;
    const double *across = map.axis[0],
                 radius = sqrt(across[0] * across[0] + across[1] * across[1] + across[2] * across[2]);
    glyph_solid solid = {.glyph = f->shapes->glyph,
                         .centre =
                             iso_vec3_add(place, iso_vec3_make(map.centre[0], map.centre[1], map.centre[2])),
                         .shaft = fmin(1, fmax(ISO_ARROW_SHAFT, least / fmax(radius, least)))};
    for (int i = 0; i < 3; i++) thicken(map.axis[i], least);
    iso_solid_invert((const double(*)[3])map.axis, solid.inverse);
    set_place(f, solid.centre);
    double square = 0;
    for (int i = 0; i < 9; i++) square += map.axis[i / 3][i % 3] * map.axis[i / 3][i % 3];
    fill_box(f, solid.centre, sqrt(square), is_in_glyph, &solid);
}

/* ---- lines */

typedef struct cone {
    iso_vec3 ends[2];
    double radii[2];
} cone;

/* Whether a place is in a tube's segment, the radius of which changes evenly along it. */
static bool is_in_cone(const void *solid, iso_vec3 place) {
    const cone *c = solid;
    const iso_vec3 along = iso_vec3_sub(c->ends[1], c->ends[0]), way = iso_vec3_sub(place, c->ends[0]);
    const double square = iso_vec3_dot(along, along),
                 t = square > 0 ? fmin(1, fmax(0, iso_vec3_dot(way, along) / square)) : 0,
                 radius = c->radii[0] + t * (c->radii[1] - c->radii[0]);
    const iso_vec3 off = iso_vec3_sub(way, iso_vec3_scale(along, t));
    return iso_vec3_dot(off, off) <= radius * radius;
}

static iso_vec3 vertex_of(const iso_shapes *set, size_t i) {
    const float *v = set->vertices[i];
    return iso_vec3_add(set->origin, iso_vec3_make((double)v[0], (double)v[1], (double)v[2]));
}

static void fill_tube(const filling *f, size_t i) {
    const iso_shapes *set = f->shapes;
    const cone c = {{vertex_of(set, i), vertex_of(set, i + 1)},
                    {(double)set->vertices[i][3], (double)set->vertices[i + 1][3]}};
    const double length = iso_vec3_length(iso_vec3_sub(c.ends[1], c.ends[0])),
                 thick = fmax(c.radii[0], c.radii[1]);
    const int steps = steps_of(f, length);
    for (int k = 0; k <= steps; k++) set_place(f, between(c.ends[0], c.ends[1], (double)k / steps));
    if (!(thick > 0.25 * f->voxel)) return;
    const int pieces = steps_of(f, length / 8); /* boxes around pieces are smaller than one around it all */
    for (int k = 0; k < pieces; k++)
        fill_box(f, between(c.ends[0], c.ends[1], (k + 0.5) / pieces), length / 2 / pieces + thick,
                 is_in_cone, &c);
}

/* A bilinear patch between the edges of a ribbon. */
static void fill_ribbon(const filling *f, size_t i) {
    const iso_shapes *set = f->shapes;
    iso_vec3 edges[2][2];
    double widest = 0;
    for (int k = 0; k < 2; k++) {
        float across[3];
        iso_shapes_across(set, i + (size_t)k, across);
        const double half = (double)set->vertices[i + (size_t)k][3];
        const iso_vec3 middle = vertex_of(set, i + (size_t)k),
                       way = iso_vec3_make(half * (double)across[0], half * (double)across[1],
                                           half * (double)across[2]);
        edges[k][0] = iso_vec3_sub(middle, way);
        edges[k][1] = iso_vec3_add(middle, way);
        widest = fmax(widest, 2 * half);
    }
    const double length = fmax(iso_vec3_length(iso_vec3_sub(edges[1][0], edges[0][0])),
                               iso_vec3_length(iso_vec3_sub(edges[1][1], edges[0][1])));
    const int steps = steps_of(f, length), wide = steps_of(f, widest);
    for (int k = 0; k <= steps; k++) {
        const double t = (double)k / steps;
        const iso_vec3 a = between(edges[0][0], edges[1][0], t), b = between(edges[0][1], edges[1][1], t);
        for (int n = 0; n <= wide; n++) set_place(f, between(a, b, (double)n / wide));
    }
}

/* ---- triangles */

static void fill_triangle(const filling *f, iso_vec3 a, iso_vec3 b, iso_vec3 c) {
    const int steps =
        steps_of(f, fmax(iso_vec3_length(iso_vec3_sub(b, a)),
                         fmax(iso_vec3_length(iso_vec3_sub(c, a)), iso_vec3_length(iso_vec3_sub(c, b)))));
    for (int i = 0; i <= steps; i++) {
        const iso_vec3 from = between(a, b, (double)i / steps), to = between(a, c, (double)i / steps);
        for (int k = 0; k <= i; k++) set_place(f, between(from, to, i ? (double)k / i : 0));
    }
}

/* Moves the corners of a triangle half a voxel to its inner side, so that the voxels that it passes are as
 * those in a solid. */
static void move_inside(const filling *f, iso_vec3 p[3]) {
    const iso_vec3 normal = iso_vec3_unit(iso_vec3_cross(iso_vec3_sub(p[1], p[0]), iso_vec3_sub(p[2], p[0])));
    const double voxels = iso_vec3_length(iso_affine_vector_to_index(&f->bits->affine, normal));
    for (int k = 0; k < 3 && voxels > 0; k++) p[k] = iso_vec3_sub(p[k], iso_vec3_scale(normal, 0.5 / voxels));
}

static void fill_span(void *context, size_t index, int worker) {
    (void)worker;
    const filling *f = context;
    const iso_mesh_span *span = &f->mesh->spans[index];
    for (size_t i = 0; i < span->triangle_count; i++) {
        const uint16_t *corners = f->mesh->triangles[span->first_triangle + i];
        iso_vec3 p[3];
        for (int k = 0; k < 3; k++) {
            const float *at = f->mesh->vertices[span->first_vertex + corners[k]].position;
            p[k] = iso_vec3_make((double)at[0], (double)at[1], (double)at[2]);
        }
        move_inside(f, p);
        fill_triangle(f, p[0], p[1], p[2]);
    }
}

/* ---- sets */

static void fill_block(void *context, size_t index, int worker) {
    (void)worker;
    const filling *f = context;
    const iso_shapes *set = f->shapes;
    const iso_shapes_block *block = &set->blocks[index];
    if (iso_shapes_are_lines(set)) {
        int32_t ids[ISO_SHAPES_BLOCK], flags[ISO_SHAPES_BLOCK];
        const int count = iso_shapes_list_segments(set, block, ids, flags);
        for (int i = 0; i < count; i++)
            (set->kind == ISO_SHAPE_TUBE ? fill_tube : fill_ribbon)(f, (size_t)ids[i]);
        return;
    }
    for (uint32_t i = block->first; i < block->first + block->count; i++) {
        const iso_vec3 place = iso_vec3_make((double)block->origin[0] + (double)set->x[i],
                                             (double)block->origin[1] + (double)set->y[i],
                                             (double)block->origin[2] + (double)set->z[i]);
        fill_glyph(f, iso_shapes_id(set, i), iso_vec3_add(set->origin, place));
    }
}

static filling filling_of(iso_solid_bits *bits, const iso_clip *clip) {
    filling f = {.bits = bits, .clip = clip};
    for (int axis = 0; axis < 3; axis++) {
        const iso_vec3 unit = iso_vec3_make(axis == 0, axis == 1, axis == 2);
        f.voxel = fmax(f.voxel, iso_vec3_length(iso_affine_vector(&bits->affine, unit)));
    }
    return f;
}

void iso_solid_bits_add_shapes(iso_solid_bits *bits, const iso_shapes *shapes, const iso_clip *clip,
                               iso_pool *pool) {
    filling f = filling_of(bits, clip);
    f.shapes = shapes;
    iso_parallel_for(pool, shapes->block_count, fill_block, &f);
}

void iso_solid_bits_add_mesh(iso_solid_bits *bits, const iso_mesh_view *mesh, const iso_clip *clip,
                             iso_pool *pool) {
    filling f = filling_of(bits, clip);
    f.mesh = mesh;
    iso_parallel_for(pool, mesh->span_count, fill_span, &f);
}
