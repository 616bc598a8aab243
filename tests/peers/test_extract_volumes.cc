// The real volumes of INDEX.tsv: triangles as it says, bounds to half a voxel, the vertices of
// vtkFlyingEdges3D, and the edge points are the welded vertices.
#include <cmath>
#include <csetjmp>
#include <cstdarg>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>
#include <vector>

#include "base/geometry.h"
#include "extract/mesh/mesh.h"
#include "extract/points/points.h"
#include "flying_edges.hpp"
#include "grids/volume/volume.h"

// Last: it defines a macro fail(), which the streams of C++ do not survive.
extern "C" {
#include <cmocka.h>
}

namespace {

enum column {
    NAME,
    PATH,
    FORMAT,
    DIMS,
    TYPE,
    SPACING,
    LOW,
    HIGH,
    ISOVALUE,
    MEANING,
    TRIANGLES,
    BOUNDS,
    COLUMNS
};
using row = std::vector<std::string>;

std::vector<row> read_index(const std::string &path) {
    std::vector<row> rows;
    FILE *file = std::fopen(path.c_str(), "r");
    if (!file) return rows;
    char line[4096];
    while (std::fgets(line, sizeof line, file)) {
        row fields(1);
        for (const char *c = line; *c && *c != '\n'; c++) {
            if (*c == '\t')
                fields.emplace_back();
            else
                fields.back() += *c;
        }
        if (fields.size() >= COLUMNS && fields[NAME] != "name") rows.push_back(fields);
    }
    std::fclose(file);
    return rows;
}

// Edge points are the vertices that the mesh owns.
void check_points(const iso_grid *grid, double isovalue, const iso_mesh_view &mesh) {
    iso_points_opts opts = {};
    opts.isovalue = isovalue;
    opts.primitive = ISO_PRIMITIVE_EDGE;
    opts.floats = true;
    iso_point_set *set = nullptr;
    assert_int_equal(iso_point_set_create(grid, &opts, &set, nullptr), ISO_OK);
    assert_int_equal(iso_point_set_update(set, nullptr), ISO_OK);
    iso_point_view points = iso_point_set_view(set);
    size_t next = 0;
    for (size_t s = 0; s < mesh.span_count; s++) {
        const iso_mesh_span &span = mesh.spans[s];
        assert_true(next + span.owned_count <= iso_point_view_count(&points));
        if (span.owned_count)
            assert_memory_equal(mesh.vertices + span.first_vertex, points.surfels + next,
                                span.owned_count * sizeof(iso_surfel));
        next += span.owned_count;
    }
    assert_int_equal(next, iso_point_view_count(&points));
    iso_point_set_destroy(set);
}

void check_bounds(const row &fields, const iso_mesh_view &mesh) {
    double wanted[6];
    assert_int_equal(std::sscanf(fields[BOUNDS].c_str(), "%lf %lf %lf %lf %lf %lf", wanted, wanted + 1,
                                 wanted + 2, wanted + 3, wanted + 4, wanted + 5),
                     6);
    iso_box box = iso_mesh_view_bounds(&mesh);
    const double lo[3] = {box.lo.x, box.lo.y, box.lo.z}, hi[3] = {box.hi.x, box.hi.y, box.hi.z};
    for (int axis = 0; axis < 3; axis++) {
        double spacing = mesh.transform.spacing[axis], half = spacing / 2;
        if (std::fabs(lo[axis] * spacing - wanted[2 * axis]) > half ||
            std::fabs(hi[axis] * spacing - wanted[2 * axis + 1]) > half)
            fail_msg("%s: axis %d covers %.2f .. %.2f mm", fields[PATH].c_str(), axis, lo[axis] * spacing,
                     hi[axis] * spacing);
    }
}

void check_volume(const row &fields, const iso_volume &volume) {
    // the index gives stored isovalues; a slope or a rescale moves them
    double isovalue = std::atof(fields[ISOVALUE].c_str());
    if (volume.grid.rgrid) isovalue = isovalue * volume.grid.rgrid->scale + volume.grid.rgrid->offset;
    iso_mesh_opts opts = {};
    opts.isovalue = isovalue;
    iso_mesh_set *set = nullptr;
    assert_int_equal(iso_mesh_set_create(&volume.grid, &opts, &set, nullptr), ISO_OK);
    assert_int_equal(iso_mesh_set_update(set, nullptr), ISO_OK);
    iso_mesh_view mesh = iso_mesh_set_view(set);
    size_t triangles = iso_mesh_view_triangle_count(&mesh);
    print_message("%-36s %8zu triangles\n", fields[PATH].c_str(), triangles);
    assert_int_equal(triangles, std::atol(fields[TRIANGLES].c_str()));
    check_points(&volume.grid, isovalue, mesh);
    check_bounds(fields, mesh);
    iso_mesh_set_destroy(set);
    check_against_flying_edges(&volume.grid, isovalue);
}

// The sample sphere.vdb: radius 3 around the world's origin, voxels of 0.05.
void check_sphere(const iso_grid *grid) {
    iso_points_opts opts = {};
    opts.floats = true;
    iso_point_set *set = nullptr;
    assert_int_equal(iso_point_set_create(grid, &opts, &set, nullptr), ISO_OK);
    assert_int_equal(iso_point_set_update(set, nullptr), ISO_OK);
    iso_point_view view = iso_point_set_view(set);
    iso_affine affine = iso_transform_affine(&view.transform);
    double sum = 0, spacing = view.transform.spacing[0];
    for (size_t s = 0; s < view.span_count; s++)
        for (uint32_t i = 0; i < view.spans[s].count; i++) {
            const float *p = view.surfels[view.spans[s].first + i].position;
            const int32_t *b = view.spans[s].brick;
            iso_vec3 index = iso_vec3_make(16.0 * b[0] + p[0], 16.0 * b[1] + p[1], 16.0 * b[2] + p[2]);
            sum += std::fabs(iso_vec3_length(iso_affine_point(&affine, index)) - 3.0) / spacing;
        }
    iso_points_stats stats = iso_point_set_stats(set);
    double mean = sum / static_cast<double>(stats.points);
    print_message("sphere.vdb: %zu foot points, %.5f voxels from radius 3 on average, %zu rejected\n",
                  stats.points, mean, stats.rejected);
    assert_true(stats.points > 50000 && mean < 0.01);
    iso_point_set_destroy(set);
}

// Files without a header that says all: what the index says.
bool is_raw(const row &fields, iso_raw_layout *layout) {
    if (fields[FORMAT].find("raw + .dat") == std::string::npos &&
        fields[FORMAT].find("62-byte header") == std::string::npos)
        return false;
    std::string text = fields[DIMS] + ":" + fields[TYPE];
    if (fields[FORMAT].find("62-byte") != std::string::npos) text += "::62";
    assert_int_equal(iso_raw_layout_parse(text.c_str(), layout, nullptr), ISO_OK);
    return true;
}

// Whether there is something to test.
bool check_index() {
    const std::string folder = ISO_TEST_VOLUMES "/";
    const std::vector<row> rows = read_index(folder + "INDEX.tsv");
    if (rows.empty()) print_message("skipped: no INDEX.tsv in %s\n", folder.c_str());
    for (const row &fields : rows) {
        iso_volume_opts opts = {};
        iso_raw_layout layout = {};
        if (is_raw(fields, &layout)) opts.raw = &layout;
        iso_volume volume = {};
        iso_error error = {};
        iso_status status = iso_volume_read((folder + fields[PATH]).c_str(), &opts, &volume, &error);
        if (status == ISO_ERR_UNSUPPORTED) {
            print_message("skipped: %s\n", error.text);
            continue;
        }
        if (status != ISO_OK) fail_msg("%s", error.text);
        check_volume(fields, volume);
        if (volume.grid.hgrid && fields[PATH].find("sphere.vdb") != std::string::npos)
            check_sphere(&volume.grid);
        iso_volume_free(&volume);
    }
    return !rows.empty();
}

// (skip() jumps out: nothing that has a destructor may live here)
void volumes_of_the_index(void **) {
    if (!check_index()) skip();
}

} // namespace

int main() {
    const struct CMUnitTest tests[] = {cmocka_unit_test(volumes_of_the_index)};
    return cmocka_run_group_tests(tests, nullptr, nullptr);
}
