/* format_xdmf: uniform and rectilinear grids of XDMF (versions 2 and 3, xdmf.org). The values stand in the
 * text, or in a raw file or an HDF5 file beside it. The grids of a collection are its times, which are
 * components as in .pvd: component c of the file is component c % n of time c / n. */
#include <errno.h>
#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "base/file.h"
#include "base/memory.h"
#include "base/xml.h"
#include "grids/volume/module.h"
#include "grids/volume/rectilinear.h"
#include "grids/volume/scalar_load.h"

enum { MOST_TEXT = 64 << 20, ARRAYS = ISO_VOLUME_ITEMS, MOST_AXIS = 1 << 20 };

/* A DataItem. */
typedef struct item {
    uint64_t numbers; /* the product of its Dimensions */
    iso_scalar scalar;
    enum { TEXT, BINARY, HDF } format;
    bool swap, zlib;
    uint64_t seek;
    const char *at, *end; /* its text */
    const char *problem;  /* why its values are not read */
} item;

/* One grid. */
typedef struct grid {
    uint64_t points[3];
    bool has_topology, has_origin, rectilinear;
    item geometry[3];
    int geometry_count, count;
    iso_format_array arrays[ARRAYS];
    item items[ARRAYS];
} grid;

typedef struct xdmf {
    const char *path;
    char *text;
    size_t bytes;
    int grids;
    grid one; /* the grid that is asked for */
} xdmf;

static iso_status bad(const xdmf *x, const char *what, iso_error *error) {
    return iso_fail(error, ISO_ERR_FORMAT, "%s: not a readable XDMF file: %s", x->path, what);
}

/* ---- markup */

static bool attribute_of(const iso_xml_tag *t, const char *name, const char *other,
                         char value[ISO_XML_TEXT]) {
    return iso_xml_attribute(t, name, value) || iso_xml_attribute(t, other, value);
}

/* Parses up to `room` sizes, of which the first is the slowest; returns how many, 0 if they are none. */
static int read_sizes(const char *text, uint64_t *sizes, int room) {
    int count = 0;
    for (char *end; text[strspn(text, " \t\r\n")]; text = end) {
        errno = 0;
        const long long size = strtoll(text, &end, 10);
        if (end == text || errno || size < 1 || count == room) return 0;
        sizes[count++] = (uint64_t)size;
    }
    return count;
}

static iso_status take_item(const xdmf *x, const iso_xml_tag *t, item *i, iso_error *error) {
    char type[ISO_XML_TEXT] = "Float", text[ISO_XML_TEXT] = "4";
    uint64_t sizes[8];
    *i = (item){.numbers = 1};
    iso_xml_attribute(t, "Precision", text);
    const int precision = atoi(text);
    attribute_of(t, "NumberType", "DataType", type);
    static const struct {
        const char *name;
        int bytes;
        iso_scalar scalar;
    } types[] = {
        {"Float", 4, ISO_SCALAR_FLOAT}, {"Float", 8, ISO_SCALAR_DOUBLE}, {"Int", 1, ISO_SCALAR_INT8},
        {"Int", 2, ISO_SCALAR_INT16},   {"Int", 4, ISO_SCALAR_INT32},    {"Int", 8, ISO_SCALAR_INT64},
        {"UInt", 1, ISO_SCALAR_UINT8},  {"UInt", 2, ISO_SCALAR_UINT16},  {"UInt", 4, ISO_SCALAR_UINT32},
        {"UInt", 8, ISO_SCALAR_UINT64}, {"Char", 0, ISO_SCALAR_INT8},    {"UChar", 0, ISO_SCALAR_UINT8},
        {"Short", 0, ISO_SCALAR_INT16}, {"UShort", 0, ISO_SCALAR_UINT16}};
    bool known = false;
    for (size_t k = 0; k < sizeof types / sizeof *types && !known; k++) {
        known = strcasecmp(type, types[k].name) == 0 && (!types[k].bytes || types[k].bytes == precision);
        i->scalar = types[k].scalar;
    }
    if (!known) i->problem = "are of a type that is not read";
    if (!iso_xml_attribute(t, "Dimensions", text)) text[0] = 0;
    const int count = read_sizes(text, sizes, 8);
    if (!count) return bad(x, "a DataItem without Dimensions", error);
    for (int k = 0; k < count; k++)
        if (__builtin_mul_overflow(i->numbers, sizes[k], &i->numbers))
            return bad(x, "the Dimensions of a DataItem are not possible", error);
    if (!iso_xml_attribute(t, "Format", text)) strcpy(text, "XML");
    i->format = strcasecmp(text, "HDF") == 0 ? HDF : strcasecmp(text, "Binary") == 0 ? BINARY : TEXT;
    if (i->format == TEXT && strcasecmp(text, "XML") != 0) i->problem = "are in a format that is not read";
    const bool big = iso_xml_attribute(t, "Endian", text) && strcasecmp(text, "Big") == 0,
               little = !big && iso_xml_attribute(t, "Endian", text) && strcasecmp(text, "Little") == 0;
    if (big || little) i->swap = big != (__BYTE_ORDER__ == __ORDER_BIG_ENDIAN__);
    if (iso_xml_attribute(t, "Seek", text)) {
        char *end;
        errno = 0;
        const long long seek = strtoll(text, &end, 10);
        if (end == text || errno || seek < 0) return bad(x, "the Seek of a DataItem is not possible", error);
        i->seek = (uint64_t)seek;
    }
    if (iso_xml_attribute(t, "Compression", text) && strcasecmp(text, "Raw") != 0) {
        i->zlib = strcasecmp(text, "Zlib") == 0;
        if (!i->zlib) i->problem = "are compressed by a method that is not read";
    }
    if (iso_xml_attribute(t, "Reference", text)) i->problem = "refer to another element, which is not read";
    if (attribute_of(t, "ItemType", "Type", text) && strcasecmp(text, "Uniform") != 0)
        i->problem = "are a selection or function of others, which is not read";
    i->at = t->end + 1;
    i->end = memchr(i->at, '<', (size_t)(x->text + x->bytes - i->at));
    return i->end ? ISO_OK : iso_fail(error, ISO_ERR_IO, "%s: truncated", x->path);
}

static iso_status take_topology(const xdmf *x, const iso_xml_tag *t, grid *g, iso_error *error) {
    char type[ISO_XML_TEXT] = "", text[ISO_XML_TEXT] = "";
    uint64_t sizes[3];
    attribute_of(t, "TopologyType", "Type", type);
    const bool even = strcasecmp(type, "3DCoRectMesh") == 0;
    if (!even && strcasecmp(type, "3DRectMesh") != 0) {
        char kind[96];
        snprintf(kind, sizeof kind, "grid of %.60s", *type ? type : "an unknown topology");
        return iso_format_not_image(x->path, kind, error);
    }
    if (!attribute_of(t, "Dimensions", "NumberOfElements", text) || read_sizes(text, sizes, 3) != 3)
        return bad(x, "a topology without three Dimensions", error);
    for (int axis = 0; axis < 3; axis++) g->points[axis] = sizes[2 - axis];
    g->has_topology = true;
    g->rectilinear = !even;
    return ISO_OK;
}

static iso_status take_attribute(const xdmf *x, const iso_xml_tag *t, const iso_xml_tag *of, grid *g,
                                 iso_error *error) {
    char text[ISO_XML_TEXT];
    iso_format_array array = {.components = 1, .tuples = 1};
    if (g->count == ARRAYS || !g->has_topology) return ISO_OK;
    if (iso_xml_attribute(of, "Center", text)) {
        array.cells = strcasecmp(text, "Cell") == 0;
        if (!array.cells && strcasecmp(text, "Node") != 0) return ISO_OK; /* of the whole grid, or of faces */
    }
    if (iso_xml_attribute(of, "Name", text)) memcpy(array.name, text, sizeof array.name - 1);
    item *i = &g->items[g->count];
    ISO_TRY(take_item(x, t, i, error));
    for (int axis = 0; axis < 3; axis++)
        if (__builtin_mul_overflow(array.tuples, g->points[axis] - (array.cells && g->points[axis] > 1),
                                   &array.tuples))
            return bad(x, "its Dimensions are not possible", error);
    array.components = i->numbers / array.tuples;
    if (!array.components || i->numbers % array.tuples) array.components = 1, array.tuples = i->numbers;
    array.scalar = i->scalar;
    g->arrays[g->count++] = array;
    return ISO_OK;
}

/* Finds grid `wanted` among those that have a topology, and their number. */
static iso_status parse(xdmf *x, int wanted, iso_error *error) {
    iso_xml xml = {x->text, x->text + x->bytes};
    iso_xml_tag t = {x->text, x->text}, attribute = t;
    enum { NOTHING, GEOMETRY, ATTRIBUTE } in = NOTHING;
    bool taken = false;
    x->grids = 0;
    x->one = (grid){.count = 0};
    while (iso_xml_next(&xml, &t)) {
        if (iso_xml_is(&t, "Topology")) {
            taken = x->grids++ == wanted;
            if (taken) ISO_TRY(take_topology(x, &t, &x->one, error));
        } else if (iso_xml_is(&t, "Geometry")) {
            char type[ISO_XML_TEXT] = "";
            in = GEOMETRY;
            attribute_of(&t, "GeometryType", "Type", type);
            const bool fits = strcasecmp(type, x->one.rectilinear ? "VXVYVZ" : "ORIGIN_DXDYDZ") == 0;
            if (taken && !fits) return bad(x, "its Geometry is not that of its Topology", error);
        } else if (iso_xml_is(&t, "Attribute")) {
            in = ATTRIBUTE;
            attribute = t;
        } else if (iso_xml_is(&t, "/Geometry") || iso_xml_is(&t, "/Attribute")) {
            in = NOTHING;
        } else if (iso_xml_is(&t, "DataItem") && taken && in == ATTRIBUTE) {
            in = NOTHING;
            ISO_TRY(take_attribute(x, &t, &attribute, &x->one, error));
        } else if (iso_xml_is(&t, "DataItem") && taken && in == GEOMETRY && x->one.geometry_count < 3) {
            ISO_TRY(take_item(x, &t, &x->one.geometry[x->one.geometry_count++], error));
        }
    }
    if (!iso_xml_is(&t, "/Xdmf"))
        return iso_fail(error, ISO_ERR_IO, "%s: truncated: it does not end with </Xdmf>", x->path);
    if (!x->grids) return bad(x, "it has no grid", error);
    return wanted < x->grids && x->one.geometry_count != (x->one.rectilinear ? 3 : 2)
               ? bad(x, "its Geometry has not as many DataItems as it needs", error)
               : ISO_OK;
}

/* ---- where values are */

/* Copies the text of an item, without the blanks around it. */
static iso_status name_of(const xdmf *x, const item *i, char name[ISO_FORMAT_PATH], iso_error *error) {
    const char *at = i->at, *end = i->end;
    while (at < end && strchr(" \t\r\n", *at)) at++;
    while (end > at && strchr(" \t\r\n", end[-1])) end--;
    if (at == end || end - at >= ISO_FORMAT_PATH) return bad(x, "a DataItem names no file", error);
    snprintf(name, ISO_FORMAT_PATH, "%.*s", (int)(end - at), at);
    return ISO_OK;
}

static iso_status file_of(const xdmf *x, const item *i, char path[ISO_FORMAT_PATH], iso_error *error) {
    ISO_TRY(name_of(x, i, path, error));
    char *beside = iso_format_beside(x->path, path);
    if (!beside) return iso_fail_memory(error, x->path);
    const bool fits = snprintf(path, ISO_FORMAT_PATH, "%s", beside) < ISO_FORMAT_PATH;
    free(beside);
    return fits ? ISO_OK : bad(x, "the name of a file is too long", error);
}

static iso_status numbers_of_hdf5(const xdmf *x, const item *i, const iso_volume_opts *opts, uint64_t count,
                                  double *numbers, iso_error *error) {
    const iso_module *module;
    char path[ISO_FORMAT_PATH];
    ISO_TRY(file_of(x, i, path, error));
    const char *array = iso_volume_array_of(path);
    if (!array)
        return iso_fail(error, ISO_ERR_IO, "%s: %s: cannot read: there is no such HDF5 file", x->path, path);
    ISO_TRY(iso_module_load(x->path, "hdf5", "libhdf5", &module, error));
    path[array - path - 1] = 0;
    iso_file_set_read(opts->files, path);
    return module->read_numbers(path, array, opts, count, numbers, error);
}

/* Reads the numbers of a small item: a step, or coordinates. */
static iso_status small_numbers(const xdmf *x, const item *i, const iso_volume_opts *opts, uint64_t count,
                                double *numbers, iso_error *error) {
    if (i->numbers != count || i->zlib || i->problem)
        return bad(x, "its origin, steps or coordinates are not numbers in the text or a file", error);
    if (i->format == HDF) return numbers_of_hdf5(x, i, opts, count, numbers, error);
    FILE *file;
    char path[ISO_FORMAT_PATH];
    const bool text = i->format == TEXT;
    if (!text) ISO_TRY(file_of(x, i, path, error));
    ISO_TRY(iso_file_open(text ? x->path : path, &file, NULL, error));
    bool good = fseeko(file, (off_t)(text ? (uint64_t)(i->at - x->text) : i->seek), SEEK_SET) == 0;
    if (text) {
        good = good && iso_format_read_numbers(file, "<", ISO_SCALAR_DOUBLE, (size_t)count, numbers);
    } else {
        for (uint64_t k = 0; k < count && good; k++) {
            unsigned char bytes[8];
            good = fread(bytes, iso_scalar_size(i->scalar), 1, file) == 1;
            if (good)
                numbers[k] =
                    iso_scalar_load(bytes, i->scalar, i->swap != (__BYTE_ORDER__ == __ORDER_BIG_ENDIAN__));
        }
    }
    fclose(file);
    return good ? ISO_OK : iso_fail(error, ISO_ERR_IO, "%s: truncated: coordinates are missing", x->path);
}

static iso_status take_geometry(const xdmf *x, bool cells, const iso_volume_opts *opts, iso_volume_info *info,
                                iso_error *error) {
    iso_rectilinear *axes = opts->axes;
    const grid *g = &x->one;
    iso_transform *t = &info->transform;
    double origin[3], steps[3];
    if (!g->rectilinear) {
        ISO_TRY(small_numbers(x, &g->geometry[0], opts, 3, origin, error));
        ISO_TRY(small_numbers(x, &g->geometry[1], opts, 3, steps, error));
        for (int i = 0; i < 3; i++) {
            t->spacing[i] = fabs(steps[2 - i]);
            t->direction[4 * i] = steps[2 - i] < 0 ? -1 : 1;
            t->origin[i] = origin[2 - i] + (cells && g->points[i] > 1 ? 0.5 * steps[2 - i] : 0);
        }
        return ISO_OK;
    }
    for (int i = 0; i < 3; i++) {
        const uint64_t count = g->points[i];
        if (count > MOST_AXIS || g->geometry[i].numbers != count)
            return bad(x, "an axis has not as many coordinates as points", error);
        double *at = axes->axis[i] = iso_alloc((size_t)count * sizeof *at);
        if (!at) return iso_fail_memory(error, x->path);
        axes->count[i] = (int)count;
        ISO_TRY(small_numbers(x, &g->geometry[i], opts, count, at, error));
    }
    if (cells) iso_rectilinear_take_cells(axes);
    for (int i = 0; i < 3; i++) t->origin[i] = axes->axis[i][0];
    return ISO_OK;
}

/* ---- the file */

/* Loads the file, and finds the grid and array that are read. */
static iso_status open_xdmf(const char *path, const iso_volume_opts *given, xdmf *x, iso_volume_info *info,
                            int *chosen, int *component, iso_error *error) {
    iso_volume_opts opts = *given;
    iso_volume_info first = *info;
    *x = (xdmf){.path = path};
    ISO_TRY(iso_format_load_text(path, MOST_TEXT, &x->text, &x->bytes, error));
    ISO_TRY(parse(x, 0, error));
    opts.component = 0;
    iso_format_image image = {
        {x->one.points[0], x->one.points[1], x->one.points[2]}, x->one.arrays, x->one.count};
    ISO_TRY(iso_format_take_array(path, &opts, &image, &first, chosen, error));
    const uint64_t all = (uint64_t)first.components * (uint64_t)x->grids;
    iso_volume_info times = *info;
    ISO_TRY(iso_format_component(path, given, all > INT_MAX ? 0 : (int)all, &times, error));
    const int time = times.component / first.components;
    opts.component = *component = times.component % first.components;
    if (time) ISO_TRY(parse(x, time, error));
    image = (iso_format_image){
        {x->one.points[0], x->one.points[1], x->one.points[2]}, x->one.arrays, x->one.count};
    ISO_TRY(iso_format_take_array(path, &opts, &image, info, chosen, error));
    if (x->grids > 1 && !given->component_axes)
        iso_volume_note(info, "several grids: using component %d of %d (--component; --series-of draws all)",
                        times.component, times.components);
    info->components = times.components;
    info->component = times.component;
    const item *i = &x->one.items[*chosen];
    if (i->problem)
        return iso_fail(error, ISO_ERR_UNSUPPORTED, "%s: the values of '%.80s' %s", path,
                        x->one.arrays[*chosen].name, i->problem);
    return ISO_OK;
}

/* The options for an HDF5 array of which only the values are used: a spacing is given, because positions of
 * voxels that the file states, too, would have it resampled. */
static iso_volume_opts opts_for_values(const iso_volume_opts *given, int component) {
    iso_volume_opts opts = *given;
    opts.grid = NULL;
    opts.raw = NULL;
    opts.mappable = NULL;
    opts.component = component;
    for (int i = 0; i < 3; i++) opts.spacing[i] = 1;
    return opts;
}

/* The header of an HDF5 array, of which only what tells of the values is taken. */
static iso_status describe_hdf(const xdmf *x, const item *i, const iso_volume_opts *given, int component,
                               int components, iso_volume_info *info, iso_error *error) {
    char path[ISO_FORMAT_PATH];
    iso_volume_info found;
    const iso_volume_opts opts = opts_for_values(given, component);
    ISO_TRY(file_of(x, i, path, error));
    if (!iso_volume_array_of(path))
        return iso_fail(error, ISO_ERR_IO, "%s: %s: cannot read: there is no such HDF5 file", x->path, path);
    ISO_TRY(iso_volume_read_info(path, &opts, &found, error));
    if (memcmp(found.dims, info->dims, sizeof found.dims) != 0 || found.components != components)
        return iso_fail(error, ISO_ERR_FORMAT, "%s: %s has not the Dimensions that are stated", x->path,
                        path);
    info->type = found.type;
    info->scale = found.scale;
    info->offset = found.offset;
    info->bytes = found.bytes;
    info->read_bytes = found.read_bytes;
    memcpy(info->file_type, found.file_type, sizeof info->file_type);
    return ISO_OK;
}

static iso_status describe(xdmf *x, const iso_volume_opts *opts, int chosen, int component,
                           iso_volume_info *info, iso_error *error) {
    const grid *g = &x->one;
    const item *i = &g->items[chosen];
    ISO_TRY(take_geometry(x, g->arrays[chosen].cells, opts, info, error));
    if (i->format == HDF)
        return describe_hdf(x, i, opts, component, (int)g->arrays[chosen].components, info, error);
    iso_format_place place = {.known = true,
                              .components = (int)g->arrays[chosen].components,
                              .component = component,
                              .scalar = i->scalar,
                              .swap = i->swap,
                              .text = i->format == TEXT,
                              .gzip = i->zlib,
                              .position = i->seek};
    if (place.text) {
        place.position = (uint64_t)(i->at - x->text);
        place.gzip = place.swap = false;
    } else {
        ISO_TRY(file_of(x, i, place.file, error));
        iso_file_set_read(opts->files, place.file);
    }
    if (place.gzip) place.plain = place.position, place.position = 0;
    iso_format_set_place(&place, opts, info);
    return ISO_OK;
}

static iso_status xdmf_info(const char *path, const iso_volume_opts *opts, iso_volume_info *info,
                            iso_error *error) {
    xdmf x;
    int chosen, component;
    iso_status status = open_xdmf(path, opts, &x, info, &chosen, &component, error);
    if (status == ISO_OK) status = describe(&x, opts, chosen, component, info, error);
    iso_free(x.text);
    return status;
}

/* Reads an HDF5 array. */
static iso_status xdmf_read(const char *path, const iso_volume_opts *given, iso_volume_info *info,
                            iso_grid *target, iso_error *error) {
    xdmf x;
    int chosen, component;
    char file[ISO_FORMAT_PATH];
    iso_volume volume;
    iso_volume_info now = {.transform = iso_transform_identity()};
    iso_status status = open_xdmf(path, given, &x, &now, &chosen, &component, error);
    if (status == ISO_OK && x.one.items[chosen].format != HDF)
        status = iso_fail(error, ISO_ERR_IO, "%s: changed while it was read", path);
    if (status == ISO_OK) status = file_of(&x, &x.one.items[chosen], file, error);
    iso_free(x.text);
    ISO_TRY(status);
    const iso_volume_opts opts = opts_for_values(given, component);
    ISO_TRY(iso_volume_read(file, &opts, &volume, error));
    *target = volume.grid;
    if (target->rgrid) target->rgrid->transform = info->transform;
    return ISO_OK;
}

const iso_format iso_format_xdmf = {"xdmf", "isopoint", NULL, xdmf_info, xdmf_read, NULL};
