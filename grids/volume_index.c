/* volume_index: reads and writes index files. */
#include "grids/volume_index.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/crc32c.h"
#include "base/file.h"
#include "base/primitives.h"

static const char MAGIC[8] = {'I', 'S', 'O', 'I', 'N', 'D', 'E', 'X'};
enum { VERSION = 2 };

iso_status iso_volume_index_create(const iso_volume_identity *identity, iso_volume_index *index,
                                   iso_error *error) {
    *index = (iso_volume_index){.identity = *identity};
    const int dims[3] = {identity->dims[0], identity->dims[1], identity->dims[2]};
    const int before[3] = {identity->before[0], identity->before[1], identity->before[2]};
    return iso_block_ranges_create(dims, before, &index->ranges, error);
}

void iso_volume_index_free(iso_volume_index *index) {
    iso_block_ranges_free(&index->ranges);
    *index = (iso_volume_index){0};
}

/* ---- a file with a checksum of all bytes that have passed, read or written */

typedef struct index_file {
    FILE *stream;
    bool writes, failed;
    uint32_t crc;
} index_file;

/* Reads or writes little-endian memory (the library runs on little-endian machines only). */
static void pass(index_file *file, void *bytes, size_t size) {
    if (file->failed) return;
    const size_t done =
        file->writes ? fwrite(bytes, 1, size, file->stream) : fread(bytes, 1, size, file->stream);
    file->failed = done != size;
    file->crc = iso_crc32c(file->crc, bytes, size);
}

/* Reads or writes bytes that are the same in every such file; reading others is a failure. */
static void pass_constant(index_file *file, const void *wanted, size_t size) {
    char bytes[sizeof(iso_volume_identity)];
    memcpy(bytes, wanted, size);
    pass(file, bytes, size);
    file->failed |= memcmp(bytes, wanted, size) != 0;
}

static void pass_surfaces(index_file *file, iso_volume_index *index) {
    int32_t counts[2] = {index->has_histogram, index->surface_count};
    pass(file, counts, sizeof counts);
    if (counts[0] < 0 || counts[0] > 1 || counts[1] < 0 || counts[1] > ISO_INDEXED_SURFACES)
        file->failed = true;
    if (file->failed) return;
    index->has_histogram = counts[0];
    index->surface_count = counts[1];
    if (counts[0]) pass(file, &index->histogram, sizeof index->histogram);
    pass(file, index->surfaces, (size_t)counts[1] * sizeof *index->surfaces);
}

static void pass_ranges(index_file *file, iso_block_ranges *ranges) {
    pass(file, ranges->lo, ranges->count * sizeof *ranges->lo);
    pass(file, ranges->hi, ranges->count * sizeof *ranges->hi);
    pass(file, ranges->states, ranges->count);
}

static void pass_all(index_file *file, iso_volume_index *index) {
    const uint32_t version = VERSION;
    pass_constant(file, MAGIC, sizeof MAGIC);
    pass_constant(file, &version, sizeof version);
    pass_constant(file, &index->identity, sizeof index->identity);
    pass_surfaces(file, index);
    pass_ranges(file, &index->ranges);
    uint32_t crc = file->crc;
    pass_constant(file, &crc, sizeof crc);
}

/* Forgets blocks that were read in part only: their other bricks would be entered a second time. */
static void keep_known(iso_block_ranges *ranges) {
    ranges->unknown = 0;
    for (size_t i = 0; i < ranges->count; i++) {
        if (ranges->states[i] & ISO_BLOCK_KNOWN) continue;
        ranges->lo[i] = INFINITY;
        ranges->hi[i] = -INFINITY;
        ranges->states[i] = 0;
        ranges->unknown++;
    }
}

/* ---- whether a file that is sound as a file can be true */

static bool is_range(float lo, float hi) {
    return (isfinite(lo) && isfinite(hi) && lo <= hi) || (lo == INFINITY && hi == -INFINITY);
}

static bool are_ranges(const iso_block_ranges *ranges) {
    for (size_t i = 0; i < ranges->count; i++) {
        const bool known = ranges->states[i] & ISO_BLOCK_KNOWN;
        if (known && (ranges->states[i] & ISO_BLOCK_BRICKS_SEEN || !is_range(ranges->lo[i], ranges->hi[i])))
            return false;
    }
    return true;
}

static uint64_t voxels_of(const iso_volume_identity *identity) {
    return (uint64_t)identity->dims[0] * (uint64_t)identity->dims[1] * (uint64_t)identity->dims[2];
}

static bool is_histogram(const iso_volume_index *index) {
    const iso_histogram *h = &index->histogram;
    const uint64_t voxels = voxels_of(&index->identity);
    uint64_t counted = 0;
    for (int i = 0; i < ISO_HISTOGRAM_BINS; i++) {
        if (h->bins[i] > voxels) return false;
        counted += h->bins[i];
    }
    return counted == h->counted && h->counted <= voxels && h->nonfinite <= voxels && h->padding <= voxels &&
           isfinite(h->low) && isfinite(h->high) && isfinite(h->width) && h->low <= h->high &&
           h->width >= 0 && isfinite(h->minimum) && isfinite(h->maximum) && h->minimum <= h->maximum &&
           (!h->padding || isfinite(h->padding_value));
}

static bool is_box(const double box[6]) {
    for (int axis = 0; axis < 3; axis++)
        if (!isfinite(box[axis]) || !isfinite(box[axis + 3]) || box[axis] > box[axis + 3]) return false;
    return true;
}

/* Whether a box lies in another one, but for what is rounded. */
static bool is_within(const double box[6], const double outer[6]) {
    for (int axis = 0; axis < 3; axis++) {
        const double size = fabs(outer[axis]) + fabs(outer[axis + 3]), rounded = 1e-6 * size + 1e-300;
        if (box[axis] < outer[axis] - rounded || box[axis + 3] > outer[axis + 3] + rounded) return false;
    }
    return true;
}

/* The box in index coordinates of all blocks that an isovalue can cross; lo > hi if there are none. */
static void box_of_crossed(const iso_volume_index *index, double isovalue, double box[6]) {
    const iso_block_ranges *ranges = &index->ranges;
    const double stored = (isovalue - index->identity.offset) / index->identity.scale,
                 rounded = 1e-6 * fabs(stored); /* (of ranges, which are floats) */
    for (int axis = 0; axis < 3; axis++) {
        box[axis] = INFINITY;
        box[axis + 3] = -INFINITY;
    }
    for (size_t i = 0; i < ranges->count; i++) {
        if (ranges->lo[i] > stored + rounded || ranges->hi[i] < stored - rounded) continue;
        const size_t at[3] = {i % (size_t)ranges->blocks[0],
                              i / (size_t)ranges->blocks[0] % (size_t)ranges->blocks[1],
                              i / (size_t)ranges->blocks[0] / (size_t)ranges->blocks[1]};
        for (int axis = 0; axis < 3; axis++) {
            const double first = ISO_BRICK * ((double)at[axis] * ISO_BLOCK_BRICKS - ranges->before[axis]);
            box[axis] = fmin(box[axis], fmax(first, 0));
            box[axis + 3] = fmax(box[axis + 3],
                                 fmin(first + ISO_BRICK * ISO_BLOCK_BRICKS, index->identity.dims[axis] - 1));
        }
    }
}

static bool is_surface(const iso_volume_index *index, const iso_indexed_surface *surface) {
    if (!isfinite(surface->isovalue) || surface->primitives > 3 * voxels_of(&index->identity)) return false;
    if (!surface->primitives || index->ranges.unknown) return true; /* empty; not used */
    double outer[6];
    box_of_crossed(index, surface->isovalue, outer);
    if (!is_box(outer) || !is_box(surface->index) || !is_box(surface->world)) return false;
    if (!is_within(surface->index, outer)) return false;
    const double *b = surface->index;
    const iso_box box = {{b[0], b[1], b[2]}, {b[3], b[4], b[5]}};
    const iso_affine affine = iso_transform_affine(&index->identity.transform);
    const iso_box world = iso_box_transform(&box, &affine);
    const double around[6] = {world.lo.x, world.lo.y, world.lo.z, world.hi.x, world.hi.y, world.hi.z};
    return is_within(surface->world, around);
}

static bool is_consistent(const iso_volume_index *index) {
    if (!are_ranges(&index->ranges) || (index->has_histogram && !is_histogram(index))) return false;
    for (int i = 0; i < index->surface_count; i++)
        if (!is_surface(index, &index->surfaces[i])) return false;
    return true;
}

static void forget(iso_volume_index *index) {
    index->has_histogram = index->surface_count = 0;
    for (size_t i = 0; i < index->ranges.count; i++) index->ranges.states[i] = 0;
    keep_known(&index->ranges);
}

bool iso_volume_index_read(const char *path, iso_volume_index *index) {
    index_file file = {0};
    if (iso_file_open(path, &file.stream, NULL, NULL) != ISO_OK) return false;
    pass_all(&file, index);
    const bool whole = !file.failed && fgetc(file.stream) == EOF;
    fclose(file.stream);
    keep_known(&index->ranges);
    const bool used = whole && is_consistent(index);
    if (!used) forget(index);
    index->changed = 0;
    return used;
}

iso_status iso_volume_index_write(const char *path, iso_volume_index *index, iso_error *error) {
    iso_sink sink;
    ISO_TRY(iso_sink_open_own(path, MAGIC, sizeof MAGIC, &sink, error));
    index_file file = {.stream = sink.stream, .writes = true};
    pass_all(&file, index); /* (what fails is found by the commit) */
    ISO_TRY(iso_sink_commit(&sink, error));
    index->changed = 0;
    return ISO_OK;
}

/* ---- surfaces */

const iso_indexed_surface *iso_volume_index_find(const iso_volume_index *index, double isovalue,
                                                 uint64_t kind) {
    for (int i = 0; i < index->surface_count; i++)
        if (index->surfaces[i].isovalue == isovalue && index->surfaces[i].kind == kind)
            return &index->surfaces[i];
    return NULL;
}

void iso_volume_index_add(iso_volume_index *index, const iso_indexed_surface *surface) {
    if (index->surface_count < ISO_INDEXED_SURFACES) index->surface_count++;
    memmove(index->surfaces + 1, index->surfaces,
            (size_t)(index->surface_count - 1) * sizeof *index->surfaces);
    index->surfaces[0] = *surface;
    index->changed = 1;
}
