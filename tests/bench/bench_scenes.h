/* bench_scenes: the volumes that the bench works on, made when first asked for and kept while they are
 * wanted.
 */
#ifndef ISO_TESTS_BENCH_SCENES_H
#define ISO_TESTS_BENCH_SCENES_H

#include "extract/points/points.h"
#include "grids/grid.h"

typedef struct bench_scenes bench_scenes;

iso_status bench_scenes_create(bench_scenes **scenes, iso_error *error);
void bench_scenes_destroy(bench_scenes *scenes);

/* The ct scene of `size` voxels a side, its values as `type`. Borrowed until another size or type is asked
 * for. Isovalue 127.5 is bone. */
iso_status bench_scene_ct(bench_scenes *scenes, int size, iso_type type, const iso_grid **grid,
                          iso_error *error);

/* The head scene, an hgrid. Borrowed until another size is asked for or the head is dropped. */
iso_status bench_scene_head(bench_scenes *scenes, int size, iso_grid **grid, iso_error *error);

/* Forgets the head, for those who have edited it. */
void bench_scene_drop_head(bench_scenes *scenes);

/* Where a brush may begin: a point each of up to `room` bricks, each far from the one before, in voxels.
 * Returns how many. */
int bench_scatter_places(const iso_point_set *set, iso_vec3 *places, int room);

#endif
