/* The peers that this build does not have: BENCH_HAVE_VTK and BENCH_HAVE_OPENVDB say which it has. */
#include "bench_peers.h"

#if !BENCH_HAVE_VTK
iso_status bench_flying_edges_create(const iso_rgrid *grid, double isovalue, int threads,
                                     bench_flying_edges **peer, iso_error *error) {
    (void)grid, (void)isovalue, (void)threads, (void)peer;
    return iso_fail(error, ISO_ERR_UNSUPPORTED, "built without VTK");
}
iso_status bench_flying_edges_ready(bench_flying_edges *peer, iso_error *error) {
    (void)peer;
    return iso_fail(error, ISO_ERR_UNSUPPORTED, "built without VTK");
}
iso_status bench_flying_edges_run(bench_flying_edges *peer, iso_error *error) {
    (void)peer;
    return iso_fail(error, ISO_ERR_UNSUPPORTED, "built without VTK");
}
size_t bench_flying_edges_points(const bench_flying_edges *peer) {
    (void)peer;
    return 0;
}
void bench_flying_edges_destroy(bench_flying_edges *peer) {
    (void)peer;
}
iso_status bench_vti_read(const char *path, size_t *voxels, iso_error *error) {
    (void)path, (void)voxels;
    return iso_fail(error, ISO_ERR_UNSUPPORTED, "built without VTK");
}
#endif

#if !BENCH_HAVE_OPENVDB
iso_status bench_volume_to_mesh_create(const iso_hgrid *grid, int threads, bench_volume_to_mesh **peer,
                                       iso_error *error) {
    (void)grid, (void)threads, (void)peer;
    return iso_fail(error, ISO_ERR_UNSUPPORTED, "built without OpenVDB");
}
iso_status bench_volume_to_mesh_run(bench_volume_to_mesh *peer, iso_error *error) {
    (void)peer;
    return iso_fail(error, ISO_ERR_UNSUPPORTED, "built without OpenVDB");
}
size_t bench_volume_to_mesh_points(const bench_volume_to_mesh *peer) {
    (void)peer;
    return 0;
}
void bench_volume_to_mesh_destroy(bench_volume_to_mesh *peer) {
    (void)peer;
}
iso_status bench_vdb_sculpt_run(bench_volume_to_mesh *peer, const double centre[3], double radius,
                                bool clipped, double *seconds, iso_error *error) {
    (void)peer, (void)centre, (void)radius, (void)clipped, (void)seconds;
    return iso_fail(error, ISO_ERR_UNSUPPORTED, "built without OpenVDB");
}
#endif
