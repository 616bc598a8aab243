/* bench_peers: what we are measured against, behind C. Without its library a peer answers "built without". */
#ifndef ISO_TESTS_BENCH_PEERS_H
#define ISO_TESTS_BENCH_PEERS_H

#include <stdbool.h>
#include <stddef.h>

#include "base/c_linkage.h"
#include "grids/grid.h"

ISO_C_BEGIN

/* vtkFlyingEdges3D over the grid's own data (borrowed until destroy): normals on, gradients and scalars off,
 * VTK's SMP backend with `threads` threads. ISO_ERR_BRIDGE when no backend really runs that many. */
typedef struct bench_flying_edges bench_flying_edges;
iso_status bench_flying_edges_create(const iso_rgrid *grid, double isovalue, int threads,
                                     bench_flying_edges **peer, iso_error *error);
/* Gives VTK its backend and threads, which are global: before a run, outside of its time. */
iso_status bench_flying_edges_ready(bench_flying_edges *peer, iso_error *error);
/* Modified() and Update(). */
iso_status bench_flying_edges_run(bench_flying_edges *peer, iso_error *error);
size_t bench_flying_edges_points(const bench_flying_edges *peer);
void bench_flying_edges_destroy(bench_flying_edges *peer);

/* Reads a .vti file with a new vtkXMLImageDataReader and lets go of it again. */
iso_status bench_vti_read(const char *path, size_t *voxels, iso_error *error);

/* openvdb::tools::volumeToMesh, isovalue 0, no adaptivity, over a level set with the grid's values (copied).
 */
typedef struct bench_volume_to_mesh bench_volume_to_mesh;
iso_status bench_volume_to_mesh_create(const iso_hgrid *grid, int threads, bench_volume_to_mesh **peer,
                                       iso_error *error);
iso_status bench_volume_to_mesh_run(bench_volume_to_mesh *peer, iso_error *error);
size_t bench_volume_to_mesh_points(const bench_volume_to_mesh *peer);
void bench_volume_to_mesh_destroy(bench_volume_to_mesh *peer);

/* A sphere united with a copy of the level set (csgUnion; copying is not timed), then meshed: all of it, or
 * only what lies in the sphere's box. */
iso_status bench_vdb_sculpt_run(bench_volume_to_mesh *peer, const double centre[3], double radius,
                                bool clipped, double *seconds, iso_error *error);

ISO_C_END
#endif
