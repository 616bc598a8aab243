/* format_vdb: OpenVDB's sparse grids. A level set with cubic voxels becomes an hgrid, every other grid of
 * numbers an rgrid over its active bounding box. */
#include "grids/volume/format.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <stdexcept>
#include <string>
#include <vector>

#include <openvdb/openvdb.h>

#include "base/bridge_guard.hpp"
#include "base/srgb.h"
#include "grids/volume/level_set_vdb.hpp"
#include "grids/volume/module.h"
#include "grids/volume/vdb_archive.hpp"

namespace {

using namespace iso::vdb;
using openvdb::Coord;
using openvdb::CoordBBox;
using openvdb::GridBase;

/* OpenVDB's message, without the name of the exception. */
std::string words_of(const openvdb::Exception &exception) {
    const std::string line = iso::one_line(exception.what());
    const size_t colon = line.find("Error: ");
    return colon == std::string::npos ? line : line.substr(colon + 7);
}

/* Executes body(), and converts exceptions of OpenVDB to errors with a message about the file. While only
 * headers are read, impossible lengths mean that the file is damaged. */
template <class Body> iso_status reading(const char *path, iso_error *error, Body &&body) {
    try {
        return body();
    } catch (const std::ios_base::failure &) {
        return iso_fail(error, ISO_ERR_IO, "%s: truncated: the file ends before its grids do", path);
    } catch (const openvdb::TypeError &exception) {
        return iso_fail(error, ISO_ERR_FORMAT, "%s: %s", path, words_of(exception).c_str());
    } catch (const openvdb::LookupError &exception) {
        return iso_fail(error, ISO_ERR_FORMAT, "%s: %s", path, words_of(exception).c_str());
    } catch (const openvdb::Exception &exception) {
        return iso_fail(error, ISO_ERR_IO, "%s: corrupt: %s", path, words_of(exception).c_str());
    } catch (const std::length_error &) {
        return iso_fail(error, ISO_ERR_IO, "%s: corrupt: a length in the file is not possible", path);
    }
}

/* ---- choosing a grid ---- */

std::string names_of(const archive &file) {
    std::string names;
    for (const vdb_grid &entry : file.grids) names += (names.empty() ? "" : ", ") + entry.name();
    return iso::one_line(names);
}

iso_status choose_named(const char *path, const char *name, archive &file, vdb_grid **chosen,
                        iso_error *error) {
    *chosen = nullptr;
    for (vdb_grid &entry : file.grids)
        if (!*chosen && (entry.name() == name || entry.descriptor.gridName() == name)) *chosen = &entry;
    if (!*chosen)
        return iso_fail(error, ISO_ERR_USAGE, "%s: no grid \"%s\", there is %s", path, name,
                        file.grids.empty() ? "none" : names_of(file).c_str());
    const GridBase &grid = *(*chosen)->grid;
    if (is_points(grid))
        return iso_fail(error, ISO_ERR_FORMAT, "%s: grid \"%s\" holds points, no volume", path, name);
    if (!is_scalar(grid) && !is_vector(grid))
        return iso_fail(error, ISO_ERR_FORMAT, "%s: grid \"%s\" holds %s, no numbers", path, name,
                        grid.valueType().c_str());
    return ISO_OK;
}

template <class Wanted> vdb_grid *first_of(archive &file, Wanted wanted) {
    auto found = std::find_if(file.grids.begin(), file.grids.end(),
                              [&](const vdb_grid &entry) { return wanted(*entry.grid); });
    return found == file.grids.end() ? nullptr : &*found;
}

iso_status choose(const char *path, const iso_volume_opts *opts, archive &file, vdb_grid **chosen,
                  iso_error *error) {
    if (opts->grid) return choose_named(path, opts->grid, file, chosen, error);
    *chosen = first_of(file, opts->component_axes ? is_vector : is_level_set);
    if (!*chosen) *chosen = first_of(file, is_level_set);
    if (!*chosen) *chosen = first_of(file, is_scalar);
    if (!*chosen) *chosen = first_of(file, is_vector);
    if (*chosen) return ISO_OK;
    if (file.grids.empty()) return iso_fail(error, ISO_ERR_FORMAT, "%s: holds no grids", path);
    const vdb_grid *points = first_of(file, is_points);
    if (points)
        return iso_fail(error, ISO_ERR_FORMAT, "%s: holds only points (grid \"%s\"), no volume", path,
                        points->name().c_str());
    return iso_fail(error, ISO_ERR_FORMAT, "%s: holds no grid of numbers, only %s", path,
                    names_of(file).c_str());
}

/* ---- the header ---- */

struct extent {
    CoordBBox box; /* of the active voxels */
    uint64_t voxels = 0;
    uint64_t leaves = 0, tree_bytes = 0; /* counted in the file, not taken from its metadata */
};

/* The extent by the statistics that OpenVDB writes with every grid; false when they are missing or
 * impossible. */
bool stated_extent(const GridBase &grid, extent *result) {
    const auto lo = grid.getMetadata<openvdb::Vec3IMetadata>(GridBase::META_FILE_BBOX_MIN);
    const auto hi = grid.getMetadata<openvdb::Vec3IMetadata>(GridBase::META_FILE_BBOX_MAX);
    const auto voxels = grid.getMetadata<openvdb::Int64Metadata>(GridBase::META_FILE_VOXEL_COUNT);
    if (!lo || !hi || !voxels || voxels->value() < 0) return false;
    result->box = CoordBBox(Coord(lo->value()), Coord(hi->value()));
    result->voxels = static_cast<uint64_t>(voxels->value());
    return true;
}

/* The extent by the grid's tree; the topology is enough. */
extent counted_extent(const GridBase &grid) {
    extent result;
    result.box = grid.evalActiveVoxelBoundingBox();
    result.voxels = grid.activeVoxelCount();
    return result;
}

bool box_dims(const CoordBBox &box, uint64_t dims[3]) {
    for (int i = 0; i < 3; i++) {
        const int64_t count = int64_t{box.max()[i]} - box.min()[i] + 1;
        if (count < 1) return false;
        dims[i] = static_cast<uint64_t>(count);
    }
    return true;
}

void list_grids(const archive &file, iso_volume_info *info) {
    for (const vdb_grid &entry : file.grids) {
        if (info->item_count == ISO_VOLUME_ITEMS) break;
        extent known;
        uint64_t dims[3];
        std::string size = "size not stated";
        if (stated_extent(*entry.grid, &known)) {
            size = std::to_string(known.voxels) + " voxels";
            if (box_dims(known.box, dims))
                size += "  " + std::to_string(dims[0]) + "x" + std::to_string(dims[1]) + "x" +
                        std::to_string(dims[2]);
        }
        const std::string line = iso::one_line(entry.name()) + "  " + entry.grid->valueType() + "  " +
                                 GridBase::gridClassToString(entry.grid->getGridClass()) + "  " + size;
        std::snprintf(info->items[info->item_count++], ISO_VOLUME_TEXT, "%s", line.c_str());
    }
}

/* Sets the transform of a grid whose first voxel is `lo`. OpenVDB multiplies row vectors with its matrix, so
 * that the rows are the images of the index axes. */
iso_status fill_transform(const char *path, const vdb_grid &entry, const Coord &lo, iso_transform *transform,
                          iso_error *error) {
    const openvdb::math::Transform &map = entry.grid->transform();
    if (!map.isLinear())
        return iso_fail(error, ISO_ERR_FORMAT,
                        "%s: grid \"%s\" has a transform that is not linear (a %s): cannot be read", path,
                        entry.name().c_str(), map.mapType().c_str());
    const openvdb::Mat4d matrix = map.baseMap()->getAffineMap()->getMat4();
    const openvdb::Vec3d origin = map.indexToWorld(lo);
    for (int axis = 0; axis < 3; axis++) {
        const openvdb::Vec3d step(matrix(axis, 0), matrix(axis, 1), matrix(axis, 2));
        transform->origin[axis] = origin[axis];
        transform->spacing[axis] = step.length();
        for (int i = 0; i < 3; i++) transform->direction[3 * i + axis] = step[i] / step.length();
    }
    return ISO_OK;
}

/* Vectors of a grid in local space have the directions of the voxels' axes. */
void take_component_axes(const GridBase &grid, const iso_transform &transform, iso_component_axes *axes) {
    axes->stated = true;
    if (!grid.isInWorldSpace()) std::copy_n(transform.direction, 9, axes->to_world);
}

/* Whether voxels are cubes, of any size and orientation, to the precision of a transform in floats. */
bool has_cubic_voxels(const iso_transform &transform) {
    const double *s = transform.spacing, *d = transform.direction;
    const double tolerance = 1e-5;
    for (int a = 0; a < 3; a++) {
        const int b = (a + 1) % 3;
        if (!(std::fabs(s[a] - s[b]) <= tolerance * s[a])) return false;
        if (!(std::fabs(d[a] * d[b] + d[3 + a] * d[3 + b] + d[6 + a] * d[6 + b]) <= tolerance)) return false;
    }
    return true;
}

uint64_t dense_bytes(const uint64_t dims[3]) {
    uint64_t bytes = sizeof(float);
    for (int i = 0; i < 3; i++)
        if (__builtin_mul_overflow(bytes, dims[i], &bytes)) return UINT64_MAX;
    return bytes;
}

/* An estimate of the size of an hgrid: a brick of 16^3 voxels covers eight leaves or more, of which a surface
 * crosses about four. */
uint64_t hgrid_bytes(const iso_volume_info &info, const extent &known) {
    uint64_t cells = 1;
    for (int i = 0; i < 3; i++) cells *= static_cast<uint64_t>((info.dims[i] - 1) / ISO_BRICK + 1);
    const uint64_t bricks = std::min(cells, known.leaves / 2 + 1);
    return cells * 16 + bricks * ISO_BRICK_VOXELS * sizeof(float);
}

iso_status fill_size(const char *path, const vdb_grid &entry, const extent &known, iso_volume_info *info,
                     iso_error *error) {
    uint64_t dims[3];
    if (known.voxels == 0 || !box_dims(known.box, dims))
        return iso_fail(error, ISO_ERR_FORMAT, "%s: grid \"%s\" has no active voxels", path,
                        entry.name().c_str());
    const int farthest = 1 << 30; /* coordinates a few cells beyond the box must not overflow */
    for (int i = 0; i < 3; i++)
        if (known.box.min()[i] < -farthest || known.box.max()[i] > farthest)
            return iso_fail(error, ISO_ERR_FORMAT, "%s: grid \"%s\" has voxels farther out than 2^30", path,
                            entry.name().c_str());
    ISO_TRY(iso_format_dims(path, dims, info, error));
    ISO_TRY(fill_transform(path, entry, known.box.min(), &info->transform, error));
    info->level_set = is_level_set(*entry.grid);
    info->sparse = info->level_set && has_cubic_voxels(info->transform);
    if (info->sparse && *std::max_element(info->dims, info->dims + 3) > ISO_HGRID_MAX)
        return iso_fail(error, ISO_ERR_LIMIT,
                        "%s: level set \"%s\" spans %d x %d x %d voxels, at most %d an axis can be read",
                        path, entry.name().c_str(), info->dims[0], info->dims[1], info->dims[2],
                        ISO_HGRID_MAX);
    info->bytes = info->sparse ? hgrid_bytes(*info, known) : dense_bytes(dims);
    if (__builtin_add_overflow(info->bytes, known.tree_bytes, &info->read_bytes))
        info->read_bytes = UINT64_MAX;
    return ISO_OK;
}

iso_status fill_info(const char *path, const iso_volume_opts *opts, archive &file, iso_volume_info *info,
                     iso_error *error) {
    vdb_grid *chosen = nullptr;
    ISO_TRY(choose(path, opts, file, &chosen, error));
    const std::string name = chosen->name();
    std::snprintf(info->name, sizeof info->name, "%s", name.c_str());
    list_grids(file, info);
    if (!opts->grid && file.grids.size() > 1)
        iso_volume_note(info, "several grids: using \"%s\" of %zu (%s)", name.c_str(), file.grids.size(),
                        opts->component_axes ? "--vectors" : "--grid");
    const GridBase &grid = *chosen->grid;
    info->type = ISO_FLOAT32;
    std::snprintf(info->file_type, sizeof info->file_type, "%s",
                  grid.saveFloatAsHalf() ? "half" : grid.valueType().c_str());
    ISO_TRY(iso_format_component(path, opts, is_vector(grid) ? 3 : 1, info, error));
    extent known;
    if (!stated_extent(grid, &known)) {
        ISO_TRY(file.load(*chosen, true, error));
        known = counted_extent(grid);
    }
    ISO_TRY(file.measure(*chosen, &known.tree_bytes, &known.leaves, error));
    ISO_TRY(fill_size(path, *chosen, known, info, error));
    if (opts->component_axes) take_component_axes(grid, info->transform, opts->component_axes);
    return ISO_OK;
}

iso_status vdb_info(const char *path, const iso_volume_opts *opts, iso_volume_info *info, iso_error *error) {
    return iso::guard(path, error, [&] {
        initialize();
        return reading(path, error, [&] {
            archive file(path, opts);
            ISO_TRY(file.scan(error));
            return fill_info(path, opts, file, info, error);
        });
    });
}

/* ---- voxels ---- */

template <class T> float component_of(const T &value, int) {
    return static_cast<float>(value);
}
template <class T> float component_of(const openvdb::math::Vec3<T> &value, int component) {
    return static_cast<float>(value[component]);
}

/* The array to which a box of voxels is copied, x fastest. */
struct box_target {
    Coord lo;
    int dims[3];
    float *data;
    ptrdiff_t stride_y, stride_z;
};

constexpr int LEAF = 8;
static_assert(openvdb::FloatTree::LeafNodeType::DIM == LEAF && ISO_BRICK % LEAF == 0, "leaves are 8^3");

/* The largest multiple of a leaf's side that is at most i. */
int leaf_floor(int i) {
    return i & ~(LEAF - 1);
}

/* Copies the part of one leaf (z fastest), or of a tile in its place, that lies in the target. Accessors of
 * this type are not registered with their tree, so that each thread can have one. */
template <class Tree>
void copy_block(const openvdb::tree::ValueAccessor<const Tree, false> &accessor, const Coord &block,
                int component, const box_target &target) {
    const auto *leaf = accessor.probeConstLeaf(block);
    const float tile = leaf ? 0 : component_of(accessor.getValue(block), component);
    int lo[3], hi[3];
    for (int i = 0; i < 3; i++) {
        lo[i] = std::max(block[i], target.lo[i]) - block[i];
        hi[i] = static_cast<int>(std::min<int64_t>(LEAF, int64_t{target.lo[i]} + target.dims[i] - block[i]));
    }
    for (int z = lo[2]; z < hi[2]; z++)
        for (int y = lo[1]; y < hi[1]; y++) {
            float *row = target.data + (block.z() + z - target.lo.z()) * target.stride_z +
                         (block.y() + y - target.lo.y()) * target.stride_y + (block.x() - target.lo.x());
            for (int x = lo[0]; x < hi[0]; x++)
                row[x] = leaf ? component_of(leaf->getValue((x * LEAF + y) * LEAF + z), component) : tile;
        }
}

/* Copies the blocks of the target whose lowest z is `z`. */
template <class Tree>
void copy_layer(const openvdb::tree::ValueAccessor<const Tree, false> &accessor, int64_t z, int component,
                const box_target &target) {
    const int64_t end_x = int64_t{target.lo.x()} + target.dims[0];
    const int64_t end_y = int64_t{target.lo.y()} + target.dims[1];
    for (int64_t y = leaf_floor(target.lo.y()); y < end_y; y += LEAF)
        for (int64_t x = leaf_floor(target.lo.x()); x < end_x; x += LEAF)
            copy_block<Tree>(accessor, Coord(static_cast<int>(x), static_cast<int>(y), static_cast<int>(z)),
                             component, target);
}

/* Calls body(0 .. count - 1) on the pool's threads. body must not throw. */
template <class Body> void parallel(iso_pool *pool, size_t count, const Body &body) {
    iso_parallel_for(
        pool, count, [](void *context, size_t index, int) { (*static_cast<const Body *>(context))(index); },
        const_cast<Body *>(&body));
}

template <class Tree>
void copy_dense(const Tree &tree, int component, iso_pool *pool, const box_target &target) {
    const int64_t first = leaf_floor(target.lo.z()), end = int64_t{target.lo.z()} + target.dims[2];
    parallel(pool, static_cast<size_t>((end - first + LEAF - 1) / LEAF), [&](size_t layer) {
        const openvdb::tree::ValueAccessor<const Tree, false> accessor(tree);
        copy_layer<Tree>(accessor, first + static_cast<int64_t>(layer) * LEAF, component, target);
    });
}

struct read_request {
    const char *path;
    const iso_volume_opts *opts;
    iso_volume_info *info;
    Coord lo;
    iso_error *error;
};

/* ---- level sets ---- */

/* Checks the memory again with the true number of bricks: the estimate from the header assumes a surface, and
 * scattered leaves need more bricks. */
iso_status check_bricks(const read_request &read, size_t cells, size_t bricks) {
    const iso_volume_info &info = *read.info;
    const uint64_t tree = info.read_bytes > info.bytes ? info.read_bytes - info.bytes : 0;
    const uint64_t bytes = tree + cells * 17 + bricks * (ISO_BRICK_VOXELS * sizeof(float) + 8);
    const std::string what = std::to_string(bricks) + " bricks of a level set";
    return iso_format_check_memory(read.path, read.opts, bytes, what.c_str(), read.error);
}

/* Converts a tree of distances in world units to an hgrid of distances in voxels. */
template <class Tree> struct level_set {
    const Tree &tree;
    double background; /* world units, > 0 */
    double voxel;      /* size of one, world units */
    Coord lo;          /* voxel 0 of the grid */
    iso_hgrid *grid;
    std::atomic<uint64_t> nan_count;

    /* A distance in voxels. Values of at least the background are outside the narrow band. */
    float distance(float value) {
        if (std::isnan(value)) {
            nan_count.fetch_add(1, std::memory_order_relaxed);
            return grid->band;
        }
        if (value >= static_cast<float>(background)) return grid->band;
        if (value <= -static_cast<float>(background)) return -grid->band;
        return std::clamp(static_cast<float>(value / voxel), -grid->band, grid->band);
    }

    Coord cell_origin(const int cell[3]) const {
        return lo.offsetBy(cell[0] * ISO_BRICK, cell[1] * ISO_BRICK, cell[2] * ISO_BRICK);
    }
    int32_t state_of(const int cell[3]) const;
    void fill(const int cell[3], float *brick);
};

/* The state of a cell that needs no brick (ISO_CELL_OUTSIDE or ISO_CELL_INSIDE), or 0 when it needs one:
 * because it contains a part of a leaf, a tile inside the band, or tiles of both sides. */
template <class Tree> int32_t level_set<Tree>::state_of(const int cell[3]) const {
    const openvdb::tree::ValueAccessor<const Tree, false> accessor(tree);
    const Coord first = cell_origin(cell), last = first.offsetBy(ISO_BRICK - 1);
    int32_t state = 0;
    for (int z = leaf_floor(first.z()); z <= last.z(); z += LEAF)
        for (int y = leaf_floor(first.y()); y <= last.y(); y += LEAF)
            for (int x = leaf_floor(first.x()); x <= last.x(); x += LEAF) {
                const Coord block(x, y, z);
                if (accessor.probeConstLeaf(block)) return 0;
                const float value = static_cast<float>(accessor.getValue(block));
                if (!(std::fabs(value) >= static_cast<float>(background))) return 0;
                const int32_t side = value > 0 ? ISO_CELL_OUTSIDE : ISO_CELL_INSIDE;
                if (state != 0 && state != side) return 0;
                state = side;
            }
    return state;
}

template <class Tree> void level_set<Tree>::fill(const int cell[3], float *brick) {
    const openvdb::tree::ValueAccessor<const Tree, false> accessor(tree);
    const box_target target = {cell_origin(cell),
                               {ISO_BRICK, ISO_BRICK, ISO_BRICK},
                               brick,
                               ISO_BRICK,
                               ptrdiff_t{ISO_BRICK} * ISO_BRICK};
    for (int z = leaf_floor(target.lo.z()); z < target.lo.z() + ISO_BRICK; z += LEAF)
        copy_layer<Tree>(accessor, z, 0, target);
    for (int i = 0; i < ISO_BRICK_VOXELS; i++) brick[i] = distance(brick[i]);
}

/* Creates and fills the bricks. They are allocated one after the other, so that their numbers do not depend
 * on threads; the classification of cells and the filling of bricks are parallel. */
template <class Tree>
iso_status fill_cells(level_set<Tree> &job, const read_request &read, iso_error *error) {
    iso_pool *pool = read.opts->pool;
    iso_hgrid *grid = job.grid;
    const size_t count = static_cast<size_t>(grid->cells[0]) * static_cast<size_t>(grid->cells[1]) *
                         static_cast<size_t>(grid->cells[2]);
    const size_t row = static_cast<size_t>(grid->cells[0]);
    const auto cell_of = [&](size_t i, int cell[3]) {
        cell[0] = static_cast<int>(i % row);
        cell[1] = static_cast<int>(i / row % static_cast<size_t>(grid->cells[1]));
        cell[2] = static_cast<int>(i / row / static_cast<size_t>(grid->cells[1]));
    };
    std::vector<int8_t> states(count);
    parallel(pool, count / row, [&](size_t line) {
        int cell[3];
        for (size_t i = line * row; i < (line + 1) * row; i++) {
            cell_of(i, cell);
            states[i] = static_cast<int8_t>(job.state_of(cell));
        }
    });
    ISO_TRY(check_bricks(read, count, static_cast<size_t>(std::count(states.begin(), states.end(), 0))));
    std::vector<size_t> full;
    for (size_t i = 0; i < count; i++) {
        int cell[3];
        float *brick;
        cell_of(i, cell);
        if (states[i] != 0) {
            iso_hgrid_coalesce(grid, cell[0], cell[1], cell[2], states[i]);
        } else {
            ISO_TRY(iso_hgrid_split(grid, cell[0], cell[1], cell[2], &brick, error));
            full.push_back(i);
        }
    }
    parallel(pool, full.size(), [&](size_t k) {
        int cell[3];
        cell_of(full[k], cell);
        job.fill(cell, iso_hgrid_brick(grid, grid->cell[full[k]]));
    });
    iso_hgrid_prune(grid);
    return ISO_OK;
}

/* ---- reading ---- */

iso_status load_chosen(const char *path, const iso_volume_opts *opts, GridBase::ConstPtr *grid,
                       iso_error *error) {
    return reading(path, error, [&] {
        archive file(path, opts);
        ISO_TRY(file.scan(error));
        vdb_grid *chosen = nullptr;
        ISO_TRY(choose(path, opts, file, &chosen, error));
        ISO_TRY(file.load(*chosen, false, error));
        *grid = chosen->grid;
        return ISO_OK;
    });
}

/* Sets *lo to the lowest voxel of the box whose size `info` has; the box must contain every active voxel. */
iso_status announced_box(const char *path, const GridBase &grid, const iso_volume_info &info, Coord *lo,
                         iso_error *error) {
    extent known;
    if (!stated_extent(grid, &known)) known = counted_extent(grid);
    uint64_t dims[3];
    bool right = box_dims(known.box, dims);
    for (int i = 0; i < 3 && right; i++) right = dims[i] == static_cast<uint64_t>(info.dims[i]);
    if (!right) return iso_fail(error, ISO_ERR_IO, "%s: changed while it was read", path);
    const CoordBBox actual = grid.evalActiveVoxelBoundingBox();
    if (!actual.empty() && !known.box.isInside(actual))
        return iso_fail(error, ISO_ERR_IO, "%s: corrupt: grid \"%s\" has voxels outside the box it states",
                        path, info.name);
    *lo = known.box.min();
    return ISO_OK;
}

iso_status read_dense(const read_request &job, const GridBase &source, iso_grid *grid) {
    ISO_TRY(iso_format_create(job.path, job.info, nullptr, grid, job.error));
    const iso_rgrid *rgrid = grid->rgrid;
    const box_target target = {job.lo,
                               {rgrid->dims[0], rgrid->dims[1], rgrid->dims[2]},
                               static_cast<float *>(rgrid->data),
                               rgrid->stride_y,
                               rgrid->stride_z};
    const auto copy = [&](const auto &typed) {
        copy_dense(typed.constTree(), job.info->component, job.opts->pool, target);
    };
    if (!source.apply<scalar_grids>(copy)) source.apply<vector_grids>(copy);
    return ISO_OK;
}

template <class Tree>
iso_status read_tree(const read_request &job, const Tree &tree, double voxel, iso_grid *grid) {
    iso_volume_info *info = job.info;
    const double background = static_cast<double>(tree.background()), half_width = background / voxel;
    if (!(half_width > 0 && std::isfinite(half_width)))
        return iso_fail(job.error, ISO_ERR_FORMAT, "%s: level set \"%s\" has a background of %g", job.path,
                        info->name, background);
    if (half_width < 3 * (1 - 1e-5))
        iso_volume_note(info, "the narrow band is only %.3g voxels wide on either side (3 are usual)",
                        half_width);
    const float band = static_cast<float>(std::max(3.0, half_width));
    iso_error detail = {};
    iso_status status = iso_hgrid_create(info->dims, band, &info->transform, &grid->hgrid, &detail);
    if (status == ISO_OK) {
        level_set<Tree> levels = {tree, background, voxel, job.lo, grid->hgrid, {0}};
        status = fill_cells(levels, job, &detail);
        if (levels.nan_count > 0)
            iso_volume_note(info, "%llu distances are not numbers: taken to be outside",
                            static_cast<unsigned long long>(levels.nan_count));
    }
    if (status != ISO_OK && !*detail.text) return status; /* job.error has the message */
    if (status != ISO_OK) return iso_fail(job.error, status, "%s: %s", job.path, detail.text);
    info->bytes = iso_hgrid_bytes(grid->hgrid);
    return ISO_OK;
}

/* Reads a level set as an hgrid. Distances are divided by the file's voxel size, also when the caller
 * overrides the spacing. */
iso_status read_sparse(const read_request &job, const GridBase &source, iso_grid *grid) {
    iso_status status = ISO_ERR_FORMAT;
    const double voxel = source.transform().voxelSize()[0];
    source.apply<real_grids>(
        [&](const auto &typed) { status = read_tree(job, typed.constTree(), voxel, grid); });
    return status;
}

/* The grid of the file is freed before the caller's is used: both are counted in read_bytes. */
iso_status vdb_read(const char *path, const iso_volume_opts *opts, iso_volume_info *info, iso_grid *grid,
                    iso_error *error) {
    iso_grid result = {};
    const iso_status status = iso::guard(path, error, [&] {
        GridBase::ConstPtr source;
        ISO_TRY(load_chosen(path, opts, &source, error));
        ISO_TRY(iso_format_progress(path, opts, 0.6, error));
        read_request job = {path, opts, info, Coord(), error};
        ISO_TRY(announced_box(path, *source, *info, &job.lo, error));
        return info->sparse ? read_sparse(job, *source, &result) : read_dense(job, *source, &result);
    });
    if (status == ISO_OK)
        *grid = result;
    else
        iso_grid_destroy(&result);
    return status;
}

/* ---- colours ---- */

using openvdb::Vec3SGrid;

uint32_t display_color(const openvdb::Vec3f &linear) {
    uint32_t color = 255u << 24;
    for (int k = 0; k < 3; k++)
        color |= static_cast<uint32_t>(255 * iso_srgb_encode(static_cast<double>(linear[k])) + 0.5) << 8 * k;
    return color;
}

/* Copies the colours of the active voxels of a cell; returns whether there are any. */
bool copy_colors(Vec3SGrid::ConstAccessor &source, const Coord &first, std::vector<uint32_t> *colors) {
    bool any = false;
    std::fill(colors->begin(), colors->end(), 0);
    for (int leaf = 0; leaf < 8; leaf++) {
        const Coord from = first.offsetBy((leaf & 1) * LEAF, (leaf >> 1 & 1) * LEAF, (leaf >> 2) * LEAF);
        if (!source.probeConstLeaf(from) && !source.isValueOn(from)) continue; /* all of it is inactive */
        for (int i = 0; i < LEAF * LEAF * LEAF; i++) {
            const Coord at = from.offsetBy(i % LEAF, i / LEAF % LEAF, i / (LEAF * LEAF)), in = at - first;
            openvdb::Vec3f color;
            if (!source.probeValue(at, color)) continue;
            any = true;
            (*colors)[static_cast<size_t>((in.z() * ISO_BRICK + in.y()) * ISO_BRICK + in.x())] =
                display_color(color);
        }
    }
    return any;
}

iso_status send_colors(const char *path, const vdb_grid &entry, const Vec3SGrid &grid,
                       const iso_color_receiver &to, iso_error *error) {
    const CoordBBox box = grid.evalActiveVoxelBoundingBox();
    const Coord lo(leaf_floor(box.min().x()), leaf_floor(box.min().y()), leaf_floor(box.min().z()));
    uint64_t dims[3];
    int cells[3];
    if (!box_dims(CoordBBox(lo, box.max()), dims)) return ISO_OK; /* nothing is coloured */
    for (int i = 0; i < 3; i++) {
        if (dims[i] > ISO_HGRID_MAX)
            return iso_fail(error, ISO_ERR_LIMIT, "%s: grid \"%s\" spans more than %d voxels", path,
                            entry.name().c_str(), ISO_HGRID_MAX);
        cells[i] = static_cast<int>((dims[i] + ISO_BRICK - 1) / ISO_BRICK);
    }
    iso_transform transform;
    ISO_TRY(fill_transform(path, entry, lo, &transform, error));
    const uint32_t own = display_color(grid.background());
    const uint8_t bytes[3] = {static_cast<uint8_t>(own), static_cast<uint8_t>(own >> 8),
                              static_cast<uint8_t>(own >> 16)};
    ISO_TRY(to.begin(to.context, &transform, cells, bytes, error));
    Vec3SGrid::ConstAccessor accessor = grid.getConstAccessor();
    std::vector<uint32_t> colors(ISO_BRICK_VOXELS);
    size_t number = 0;
    for (int z = 0; z < cells[2]; z++)
        for (int y = 0; y < cells[1]; y++)
            for (int x = 0; x < cells[0]; x++, number++)
                if (copy_colors(accessor, lo.offsetBy(x * ISO_BRICK, y * ISO_BRICK, z * ISO_BRICK), &colors))
                    ISO_TRY(to.cell(to.context, number, colors.data(), error));
    return ISO_OK;
}

iso_status read_colors(const char *path, const iso_volume_opts *opts, const iso_color_receiver *to,
                       iso_error *error) {
    const iso_volume_opts usual = {};
    return iso::guard(path, error, [&] {
        initialize();
        return reading(path, error, [&] {
            archive file(path, opts ? opts : &usual);
            ISO_TRY(file.scan(error));
            vdb_grid *entry = first_of(file, [](const GridBase &grid) {
                return grid.getName() == "Cd" && grid.isType<Vec3SGrid>();
            });
            if (!entry) return ISO_OK;
            ISO_TRY(file.load(*entry, false, error));
            return send_colors(path, *entry, static_cast<const Vec3SGrid &>(*entry->grid), *to, error);
        });
    });
}

const iso_format format = {"vdb", "OpenVDB", nullptr, vdb_info, vdb_read, nullptr};

} // namespace

ISO_MODULE(&format, nullptr, iso_vdb_write_level_set, read_colors, nullptr);
