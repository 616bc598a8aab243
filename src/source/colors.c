/* colors: looks up the colour of each voxel near the surface, cell by cell. */
#include "source/colors.h"

#include <math.h>
#include <stdatomic.h>
#include <string.h>

#include "base/memory.h"
#include "clouds/neighbours.h"
#include "grids/closing/brick_distances.h"
#include "grids/grid.h"

/* Points of whose colours a voxel's is the mean; the farthest one has no weight. */
enum { POINTS = 7 };

typedef struct coloring {
    iso_hgrid *field; /* which is only read */
    iso_cell_items *paint;
    iso_paint_item **made; /* by cell; NULL: no voxel of it has a colour */
    atomic_bool failed;
    /* Sets the colours of a cell's voxels; the lowest voxel is `at`. Those that are not near the surface do
     * not count. */
    void (*color)(const struct coloring *all, const int at[3], uint32_t *colors);
    const iso_triangles *mesh;
    const iso_triangle_tree *triangles;
    const iso_tree *points;
    const uint8_t (*point_colors)[3];
    const iso_paint_file *file;
    bool same_voxels; /* those of the file have the size of the field's */
} coloring;

/* The mean of colours; of weights that are not all above 0 those of the first colour. */
static uint32_t weigh(const uint8_t *const *colors, const double *weights, int count) {
    unsigned rgb[3];
    double sum = 0;
    for (int i = 0; i < count; i++) sum += weights[i];
    for (int k = 0; k < 3; k++) {
        double part = 0;
        for (int i = 0; i < count; i++) part += weights[i] * colors[i][k];
        rgb[k] = sum > 0 ? (unsigned)(part / sum + 0.5) : colors[0][k];
    }
    return iso_paint_make(rgb[0], rgb[1], rgb[2], 255);
}

static void color_cell(void *context, size_t cell, int worker) {
    coloring *all = context;
    const iso_hgrid *field = all->field;
    (void)worker;
    if (field->cell[cell] < 0) return;
    const float *brick = iso_hgrid_brick(field, field->cell[cell]);
    iso_paint_item *item = iso_item_create(sizeof *item);
    if (!item) {
        atomic_store(&all->failed, true);
        return;
    }
    int at[3];
    iso_hgrid_cell_position(field, cell, at);
    for (int axis = 0; axis < 3; axis++) at[axis] *= ISO_BRICK;
    memset(item, 0, sizeof *item);
    all->color(all, at, item->voxel);
    uint32_t any = 0;
    for (int i = 0; i < ISO_BRICK_VOXELS; i++) {
        if (!(fabsf(brick[i]) < field->band)) item->voxel[i] = 0;
        any |= item->voxel[i];
    }
    all->made[cell] = any ? item : NULL;
    if (!any) iso_item_release(item);
}

static iso_status color_field(coloring *all, iso_pool *pool, iso_error *error) {
    const size_t cells = iso_hgrid_cell_count(all->field);
    ISO_TRY(iso_cell_items_init(all->paint, "the colours", cells, sizeof(iso_paint_item), error));
    all->made = iso_alloc_zero(cells, sizeof *all->made);
    if (all->made) iso_parallel_for(pool, cells, color_cell, all);
    for (size_t i = 0; all->made && i < cells; i++)
        if (all->made[i]) iso_cell_items_give(all->paint, i, all->made[i]);
    const bool whole = all->made && !atomic_load(&all->failed);
    iso_free(all->made);
    if (whole) return ISO_OK;
    iso_cell_items_free(all->paint);
    return iso_fail(error, ISO_ERR_NOMEM, "out of memory for the colours");
}

/* ---- meshes */

/* Twice the area of the triangle p q r, seen along a normal. */
static double area(iso_vec3 p, iso_vec3 q, iso_vec3 r, iso_vec3 normal) {
    return fmax(iso_vec3_dot(iso_vec3_cross(iso_vec3_sub(q, p), iso_vec3_sub(r, p)), normal), 0);
}

static void color_by_mesh(const coloring *all, const int at[3], uint32_t *colors) {
    const iso_hgrid *field = all->field;
    const iso_brick_place place = {
        field->transform.origin, field->transform.spacing[0], {at[0], at[1], at[2]}};
    double squared[ISO_BRICK_VOXELS];
    const iso_tree_triangle *nearest[ISO_BRICK_VOXELS];
    iso_brick_distances(all->triangles, &place, (double)field->band, squared, nearest);
    for (int i = 0; i < ISO_BRICK_VOXELS; i++) {
        if (!nearest[i]) continue;
        const uint32_t *corners = all->mesh->triangles[nearest[i]->number];
        const iso_vec3 p = iso_triangle_nearest(nearest[i]->corners, iso_brick_voxel(&place, i));
        iso_vec3 t[3];
        const uint8_t *of[3];
        for (int k = 0; k < 3; k++) {
            const float *c = nearest[i]->corners[k];
            t[k] = iso_vec3_make((double)c[0], (double)c[1], (double)c[2]);
            of[k] = all->mesh->colors[corners[k]];
        }
        const iso_vec3 normal = iso_vec3_cross(iso_vec3_sub(t[1], t[0]), iso_vec3_sub(t[2], t[0]));
        const double weights[3] = {area(t[1], t[2], p, normal), area(t[2], t[0], p, normal),
                                   area(t[0], t[1], p, normal)};
        colors[i] = weigh(of, weights, 3);
    }
}

iso_status iso_source_paint_of_mesh(const iso_triangles *mesh, iso_hgrid *field, iso_pool *pool,
                                    iso_cell_items *paint, iso_error *error) {
    iso_triangle_tree *tree;
    *paint = (iso_cell_items){.cell = NULL};
    ISO_TRY(iso_triangle_tree_create(mesh, &tree, error));
    coloring all = {.field = field, .paint = paint, .color = color_by_mesh, .mesh = mesh, .triangles = tree};
    const iso_status status = color_field(&all, pool, error);
    iso_triangle_tree_destroy(tree);
    return status;
}

/* ---- points */

/* Places are in voxels of the field. */
static void color_by_points(const coloring *all, const int at[3], uint32_t *colors) {
    const iso_hgrid *field = all->field;
    const size_t cell = iso_hgrid_cell_index(field, at[0] / ISO_BRICK, at[1] / ISO_BRICK, at[2] / ISO_BRICK);
    const float *brick = iso_hgrid_brick(field, field->cell[cell]);
    for (int i = 0; i < ISO_BRICK_VOXELS; i++) {
        const float place[3] = {(float)(at[0] + i % ISO_BRICK), (float)(at[1] + i / ISO_BRICK % ISO_BRICK),
                                (float)(at[2] + i / (ISO_BRICK * ISO_BRICK))};
        iso_neighbour found[POINTS];
        const uint8_t *of[POINTS];
        double weights[POINTS];
        if (!(fabsf(brick[i]) < field->band)) continue;
        const int count = iso_tree_nearest_to(all->points, place, POINTS, found);
        for (int k = 0; k < count; k++) {
            const double most = (double)found[count - 1].square,
                         part = most > 0 ? 1 - (double)found[k].square / most : 0;
            of[k] = all->point_colors[all->points->points[found[k].slot].index];
            weights[k] = part * part;
        }
        colors[i] = weigh(of, weights, count);
    }
}

iso_status iso_source_paint_of_points(const iso_cloud *cloud, iso_hgrid *field, iso_pool *pool,
                                      iso_cell_items *paint, iso_error *error) {
    const iso_affine from = iso_transform_affine(&cloud->transform),
                     to = iso_transform_affine(&field->transform);
    iso_tree tree = {.points = NULL};
    *paint = (iso_cell_items){.cell = NULL};
    float(*places)[3] = iso_alloc(cloud->count * sizeof *places);
    if (!places) return iso_fail(error, ISO_ERR_NOMEM, "out of memory for the colours");
    for (size_t s = 0; s < cloud->span_count; s++)
        for (size_t i = cloud->spans[s].first; i < cloud->spans[s].first + cloud->spans[s].count; i++) {
            const iso_vec3 p = iso_brick_position(cloud->spans[s].brick, cloud->surfels[i].position),
                           at = iso_affine_point_to_index(&to, iso_affine_point(&from, p));
            places[i][0] = (float)at.x, places[i][1] = (float)at.y, places[i][2] = (float)at.z;
        }
    iso_status status = iso_tree_make((const float(*)[3])places, cloud->count, pool, &tree, error);
    iso_free(places);
    coloring all = {.field = field,
                    .paint = paint,
                    .color = color_by_points,
                    .points = &tree,
                    .point_colors = (const uint8_t(*)[3])cloud->colors};
    if (status == ISO_OK) status = color_field(&all, pool, error);
    iso_tree_free(&tree);
    return status;
}

/* ---- level sets */

/* The place of the surface that is nearest to a voxel of the band. */
static iso_vec3 foot_of(iso_hgrid *field, const int at[3]) {
    const iso_grid grid = {.hgrid = field};
    const iso_vec3 way = iso_vec3_unit(iso_grid_voxel_gradient(&grid, at[0], at[1], at[2]));
    return iso_vec3_sub(iso_vec3_make(at[0], at[1], at[2]),
                        iso_vec3_scale(way, (double)iso_hgrid_at(field, at[0], at[1], at[2])));
}

/* Voxels of another size than the file's get the colours of the surface, where all the file's voxels have
 * some. */
static void color_by_paint(const coloring *all, const int at[3], uint32_t *colors) {
    const iso_affine affine = iso_transform_affine(&all->field->transform);
    for (int i = 0; i < ISO_BRICK_VOXELS; i++) {
        const int voxel[3] = {at[0] + i % ISO_BRICK, at[1] + i / ISO_BRICK % ISO_BRICK,
                              at[2] + i / (ISO_BRICK * ISO_BRICK)};
        const iso_vec3 place =
            all->same_voxels ? iso_vec3_make(voxel[0], voxel[1], voxel[2]) : foot_of(all->field, voxel);
        colors[i] =
            iso_paint_at(&all->file->view,
                         iso_affine_point_to_index(&all->file->affine, iso_affine_point(&affine, place)));
    }
}

iso_status iso_source_paint_of_vdb(const char *path, iso_hgrid *field, iso_pool *pool, iso_cell_items *paint,
                                   iso_error *error) {
    iso_cell_items colors;
    iso_paint_file file;
    *paint = (iso_cell_items){.cell = NULL};
    ISO_TRY(iso_paint_read(path, NULL, &colors, &file, error));
    coloring all = {.field = field, .paint = paint, .color = color_by_paint, .file = &file};
    const double side = field->transform.spacing[0],
                 own = iso_vec3_length(iso_affine_vector(&file.affine, iso_vec3_make(1, 0, 0)));
    all.same_voxels = fabs(own - side) < 1e-9 * side;
    const iso_status status = file.view.paint ? color_field(&all, pool, error) : ISO_OK;
    iso_cell_items_free(&colors);
    return status;
}
