/* metadata: reads what describes an array: .zarray of Zarr 2, zarr.json of Zarr 3, attributes.json of N5. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/file.h"
#include "base/memory.h"
#include "grids/volume/zarr/zarr.h"

/* ---- JSON */

/* Metadata has some kilobytes. The parser takes up to 65 bytes for each of the text, so that what is longer
 * is not parsed at all. */
enum { MOST_JSON = 1 << 20 };

static iso_status parse(const char *path, const char *text, size_t bytes, json_t **json, iso_error *error) {
    json_error_t wrong;
    *json = json_loadb(text, bytes, JSON_DECODE_INT_AS_REAL, &wrong);
    if (!*json)
        return iso_fail(error, ISO_ERR_FORMAT, "%s: not JSON: line %d: %s", path, wrong.line, wrong.text);
    if (json_is_object(*json)) return ISO_OK;
    json_decref(*json);
    *json = NULL;
    return iso_fail(error, ISO_ERR_FORMAT, "%s: not a JSON object", path);
}

/* Loads a file of metadata; *absent: there is none. */
static iso_status load(const char *path, iso_buffer *text, size_t *bytes, bool *absent, iso_error *error) {
    FILE *file;
    uint64_t size;
    *absent = access(path, F_OK) != 0;
    if (*absent) return ISO_OK;
    ISO_TRY(iso_file_open(path, &file, &size, error));
    iso_status status = ISO_OK;
    if (size > MOST_JSON)
        status = iso_fail(error, ISO_ERR_LIMIT, "%s: has %.1f MB, metadata of more than %d MB is not read",
                          path, (double)size / (1 << 20), MOST_JSON >> 20);
    else if (iso_buffer_reserve(text, (size_t)size + 1, 0, NULL) != ISO_OK)
        status = iso_fail_memory(error, path);
    else if (fread(text->data, 1, (size_t)size, file) != size)
        status = iso_fail(error, ISO_ERR_IO, "%s: cannot be read, or changed meanwhile", path);
    fclose(file);
    *bytes = (size_t)size;
    return status;
}

iso_status iso_zarr_read_json(const char *folder, const char *name, const iso_volume_opts *opts,
                              json_t **json, iso_error *error) {
    static const iso_remote_part all = {ISO_REMOTE_METADATA, 0, MOST_JSON};
    char *path;
    iso_buffer text = {0};
    size_t bytes;
    bool absent;
    *json = NULL;
    if (asprintf(&path, "%s/%s", folder, name) < 0) return iso_fail_memory(error, folder);
    iso_status status = opts->remote ? opts->remote->read(path, &all, &text, &bytes, &absent, error)
                                     : load(path, &text, &bytes, &absent, error);
    if (status == ISO_OK && !absent) status = parse(path, text.data ? text.data : "", bytes, json, error);
    iso_buffer_free(&text);
    free(path);
    return status;
}

bool iso_zarr_number(const json_t *json, double low, double high, double *out) {
    const double value = json_is_real(json) ? json_real_value(json) : NAN;
    if (!(value >= low && value <= high)) return false;
    *out = value;
    return true;
}

/* ---- members of both versions */

/* The metadata that is being read. */
typedef struct metadata {
    const char *path; /* for messages */
    const json_t *json;
    iso_zarr_array *array;
} metadata;

static iso_status refuse(const metadata *m, const char *what, iso_error *error) {
    return iso_fail(error, ISO_ERR_FORMAT, "%s: %s", m->path, what);
}

static iso_status refuse_name(const metadata *m, const char *what, const char *name, iso_error *error) {
    return iso_fail(error, ISO_ERR_FORMAT, "%s: %s \"%.80s\" is not supported", m->path, what, name);
}

/* A list of one whole number from 1 for each axis. */
static bool read_sizes(const json_t *list, int axes, uint64_t sizes[ISO_ZARR_AXES]) {
    if (json_array_size(list) != (size_t)axes) return false;
    for (int i = 0; i < axes; i++) {
        double number;
        if (!iso_zarr_number(json_array_get(list, (size_t)i), 1, 1e15, &number) || number != floor(number))
            return false;
        sizes[i] = (uint64_t)number;
    }
    return true;
}

static iso_status read_shape(const metadata *m, iso_error *error) {
    const json_t *shape = json_object_get(m->json, "shape");
    const size_t axes = json_array_size(shape);
    if (axes < 2 || axes > ISO_ZARR_AXES) return refuse(m, "has no shape of 2 to 8 axes", error);
    m->array->axes = (int)axes;
    return read_sizes(shape, (int)axes, m->array->shape)
               ? ISO_OK
               : refuse(m, "its shape is not of whole numbers from 1", error);
}

/* A chunk must fit into memory many times over; the limit of memory is checked later. */
static iso_status check_chunk(const metadata *m, iso_error *error) {
    uint64_t elements = 1;
    for (int i = 0; i < m->array->axes; i++)
        if (__builtin_mul_overflow(elements, m->array->shard[i], &elements) || elements > 1ull << 50)
            return refuse(m, "its chunks are larger than any memory", error);
    return ISO_OK;
}

static void set_identity(iso_zarr_array *array) {
    for (int i = 0; i < array->axes; i++) array->order[i] = i;
}

/* Changes the order of the axes: "F" reverses it, "C" leaves it. */
static iso_status apply_order(const metadata *m, const char *order, iso_error *error) {
    const int axes = m->array->axes;
    int *now = m->array->order;
    const bool reversed = strcmp(order, "F") == 0;
    if (!reversed && strcmp(order, "C") != 0) return refuse_name(m, "the order", order, error);
    for (int i = 0; reversed && i < axes / 2; i++) {
        const int axis = now[i];
        now[i] = now[axes - 1 - i];
        now[axes - 1 - i] = axis;
    }
    return ISO_OK;
}

/* The bits of a number with a fraction: "0x7fc00000". */
static bool fill_of_bits(const char *text, iso_scalar scalar, double *value) {
    const bool is_real =
        scalar == ISO_SCALAR_HALF || scalar == ISO_SCALAR_FLOAT || scalar == ISO_SCALAR_DOUBLE;
    if (!text || !is_real || strncmp(text, "0x", 2) != 0) return false;
    if (strspn(text + 2, "0123456789abcdefABCDEF") != 2 * iso_scalar_size(scalar) ||
        strlen(text + 2) != 2 * iso_scalar_size(scalar))
        return false;
    const uint64_t bits = strtoull(text + 2, NULL, 16);
    const iso_scalar_source source = {.data = &bits, .scalar = scalar, .components = 1};
    float number;
    iso_scalar_convert(&source, 1, ISO_FLOAT32, &number);
    *value = (double)number;
    return true;
}

/* null: what absent chunks have is not defined; 0 is what everyone takes. */
static iso_status read_fill(const metadata *m, iso_error *error) {
    const json_t *fill = json_object_get(m->json, "fill_value");
    const char *text = json_string_value(fill);
    double *value = &m->array->fill;
    *value = 0;
    if (!fill || json_is_null(fill) || json_is_false(fill)) return ISO_OK;
    if (json_is_true(fill)) *value = 1;
    if (json_is_true(fill) || iso_zarr_number(fill, -HUGE_VAL, HUGE_VAL, value)) return ISO_OK;
    if (text && strcmp(text, "NaN") == 0) *value = NAN;
    if (text && strcmp(text, "Infinity") == 0) *value = HUGE_VAL;
    if (text && strcmp(text, "-Infinity") == 0) *value = -HUGE_VAL;
    if (*value != 0 || fill_of_bits(text, m->array->scalar, value)) return ISO_OK;
    return refuse(m, "its fill_value is not a number", error);
}

static bool is_separator(const char *text) {
    return text && (strcmp(text, ".") == 0 || strcmp(text, "/") == 0);
}

/* The size of the integers of which delta stored the differences, as if they were of the same type: "<i2". */
static bool delta_size(const json_t *settings, size_t *size) {
    const char *type = json_string_value(json_object_get(settings, "dtype")),
               *stored = json_string_value(json_object_get(settings, "astype"));
    if (!type || (stored && strcmp(stored, type) != 0)) return false;
    if (strlen(type) != 3 || !strchr("<|", type[0]) || !strchr("iu", type[1]) || !strchr("1248", type[2]))
        return false;
    *size = (size_t)(type[2] - '0');
    return true;
}

/* settings: the object with the codec's parameters. */
static iso_status add_codec(const metadata *m, const char *name, const json_t *settings,
                            iso_zarr_codecs *codecs, iso_error *error) {
    if (codecs->count == ISO_ZARR_CODECS) return refuse(m, "has too many codecs", error);
    if (!name) return refuse(m, "has a codec without a name", error);
    iso_zarr_codec *codec = &codecs->codec[codecs->count];
    if (!iso_zarr_codec_of_name(name, codec)) return refuse_name(m, "the codec", name, error);
    double element = 0;
    if (codec->codec == ISO_CODEC_SHUFFLE) {
        const json_t *size = json_object_get(settings, "elementsize");
        if (!iso_zarr_number(size, 1, 64, &element) || element != floor(element))
            return refuse(m, "its shuffle has no elementsize of 1 to 64", error);
        codec->element = (size_t)element;
    }
    if (codec->codec == ISO_CODEC_DELTA && !delta_size(settings, &codec->element))
        return refuse(m, "its delta is not one of little-endian integers that are stored as they are", error);
    codecs->count++;
    return ISO_OK;
}

/* ---- version 2 */

static bool scalar_of_v2(const char *text, iso_scalar *scalar) {
    static const struct {
        const char *name;
        iso_scalar scalar;
    } names[] = {{"b1", ISO_SCALAR_UINT8},  {"u1", ISO_SCALAR_UINT8},  {"i1", ISO_SCALAR_INT8},
                 {"u2", ISO_SCALAR_UINT16}, {"i2", ISO_SCALAR_INT16},  {"u4", ISO_SCALAR_UINT32},
                 {"i4", ISO_SCALAR_INT32},  {"u8", ISO_SCALAR_UINT64}, {"i8", ISO_SCALAR_INT64},
                 {"f2", ISO_SCALAR_HALF},   {"f4", ISO_SCALAR_FLOAT},  {"f8", ISO_SCALAR_DOUBLE}};
    if (!*text || !strchr("<>|", *text)) return false;
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        if (strcmp(text + 1, names[i].name) == 0) {
            *scalar = names[i].scalar;
            return true;
        }
    return false;
}

/* Filters are applied before the compressor. */
static iso_status read_compressor(const metadata *m, iso_error *error) {
    const json_t *compressor = json_object_get(m->json, "compressor"),
                 *filters = json_object_get(m->json, "filters");
    iso_zarr_codecs *codecs = &m->array->codecs;
    for (size_t i = 0; i < json_array_size(filters); i++) {
        const json_t *filter = json_array_get(filters, i);
        ISO_TRY(add_codec(m, json_string_value(json_object_get(filter, "id")), filter, codecs, error));
    }
    if (!compressor || json_is_null(compressor)) return ISO_OK;
    return add_codec(m, json_string_value(json_object_get(compressor, "id")), compressor, codecs, error);
}

static void read_axis_names(const json_t *names, iso_zarr_array *array) {
    for (int i = 0; i < array->axes; i++) {
        const char *name = json_string_value(json_array_get(names, (size_t)i));
        if (name) snprintf(array->names[i], ISO_ZARR_NAME, "%s", name);
    }
}

/* The names of axes as xarray writes them, into the attributes. */
static iso_status read_attributes_of_v2(const char *folder, const iso_volume_opts *opts,
                                        iso_zarr_array *array, iso_error *error) {
    json_t *json;
    ISO_TRY(iso_zarr_read_json(folder, ".zattrs", opts, &json, error));
    read_axis_names(json_object_get(json, "_ARRAY_DIMENSIONS"), array);
    json_decref(json);
    return ISO_OK;
}

static iso_status read_v2(const metadata *m, iso_error *error) {
    iso_zarr_array *array = m->array;
    double format;
    const json_t *type = json_object_get(m->json, "dtype"), *separator = NULL;
    const char *order = json_string_value(json_object_get(m->json, "order"));
    if (!iso_zarr_number(json_object_get(m->json, "zarr_format"), 2, 2, &format))
        return refuse(m, "its zarr_format is not 2", error);
    array->version = 2;
    ISO_TRY(read_shape(m, error));
    if (!read_sizes(json_object_get(m->json, "chunks"), array->axes, array->chunk))
        return refuse(m, "its chunks are not whole numbers from 1, one for each axis", error);
    memcpy(array->shard, array->chunk, sizeof array->shard);
    ISO_TRY(check_chunk(m, error));
    if (!json_is_string(type)) return refuse(m, "its dtype is not one of numbers", error);
    if (!scalar_of_v2(json_string_value(type), &array->scalar))
        return refuse_name(m, "the dtype", json_string_value(type), error);
    array->big_endian = json_string_value(type)[0] == '>';
    set_identity(array);
    ISO_TRY(apply_order(m, order ? order : "C", error));
    ISO_TRY(read_fill(m, error));
    ISO_TRY(read_compressor(m, error));
    separator = json_object_get(m->json, "dimension_separator");
    if (separator && !is_separator(json_string_value(separator)))
        return refuse(m, "its dimension_separator is neither . nor /", error);
    array->separator = separator ? *json_string_value(separator) : '.';
    return ISO_OK;
}

/* ---- version 3 */

static bool scalar_of_v3(const char *text, iso_scalar *scalar) {
    static const struct {
        const char *name;
        iso_scalar scalar;
    } names[] = {
        {"bool", ISO_SCALAR_UINT8},    {"uint8", ISO_SCALAR_UINT8},   {"int8", ISO_SCALAR_INT8},
        {"uint16", ISO_SCALAR_UINT16}, {"int16", ISO_SCALAR_INT16},   {"uint32", ISO_SCALAR_UINT32},
        {"int32", ISO_SCALAR_INT32},   {"uint64", ISO_SCALAR_UINT64}, {"int64", ISO_SCALAR_INT64},
        {"float16", ISO_SCALAR_HALF},  {"float32", ISO_SCALAR_FLOAT}, {"float64", ISO_SCALAR_DOUBLE}};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        if (strcmp(text, names[i].name) == 0) {
            *scalar = names[i].scalar;
            return true;
        }
    return false;
}

/* A name, or an object with one: {"name": .., "configuration": {..}}. */
static const char *name_of(const json_t *json) {
    return json_string_value(json_is_object(json) ? json_object_get(json, "name") : json);
}

static const json_t *configured(const json_t *json, const char *name) {
    return json_object_get(json_object_get(json, "configuration"), name);
}

static iso_status read_transpose(const metadata *m, const json_t *codec, iso_error *error) {
    iso_zarr_array *array = m->array;
    const json_t *list = configured(codec, "order");
    int composed[ISO_ZARR_AXES] = {0};
    unsigned seen = 0;
    if (json_is_string(list)) return apply_order(m, json_string_value(list), error);
    if (json_array_size(list) != (size_t)array->axes)
        return refuse(m, "transpose has not an order of all axes", error);
    for (int i = 0; i < array->axes; i++) {
        double axis;
        if (!iso_zarr_number(json_array_get(list, (size_t)i), 0, array->axes - 1, &axis) ||
            axis != floor(axis) || seen >> (int)axis & 1)
            return refuse(m, "transpose has not an order of all axes", error);
        seen |= 1u << (int)axis;
        composed[i] = array->order[(int)axis];
    }
    memcpy(array->order, composed, sizeof composed);
    return ISO_OK;
}

static iso_status read_endian(const metadata *m, const json_t *codec, bool *big, iso_error *error) {
    const json_t *endian = configured(codec, "endian");
    const char *text = json_string_value(endian);
    *big = text && strcmp(text, "big") == 0;
    if (endian && !*big && !(text && strcmp(text, "little") == 0))
        return refuse(m, "its endian is neither little nor big", error);
    return ISO_OK;
}

static iso_status read_codecs(const metadata *m, const json_t *list, bool in_shard, iso_error *error);

/* The codecs of the index of a shard: bytes, and then none or crc32c. Others would not have a known size. */
static iso_status read_index_codecs(const metadata *m, const json_t *list, iso_error *error) {
    iso_zarr_codecs *codecs = &m->array->index_codecs;
    const char *first = name_of(json_array_get(list, 0));
    bool big = false;
    if (!first || strcmp(first, "bytes") != 0) return refuse(m, "its shards' index is not of bytes", error);
    ISO_TRY(read_endian(m, json_array_get(list, 0), &big, error));
    if (big) return refuse(m, "its shards' index is big-endian", error);
    for (size_t i = 1; i < json_array_size(list); i++) {
        ISO_TRY(add_codec(m, name_of(json_array_get(list, i)), NULL, codecs, error));
        if (codecs->codec[codecs->count - 1].codec != ISO_CODEC_CRC32C || codecs->count > 1)
            return refuse(m, "its shards' index is compressed", error);
    }
    return ISO_OK;
}

static iso_status read_sharding(const metadata *m, const json_t *codec, iso_error *error) {
    iso_zarr_array *array = m->array;
    const json_t *place = configured(codec, "index_location");
    uint64_t sizes[ISO_ZARR_AXES];
    if (!read_sizes(configured(codec, "chunk_shape"), array->axes, sizes))
        return refuse(m, "its shards have no chunk_shape of whole numbers from 1", error);
    for (int i = 0; i < array->axes;
         i++) { /* a shard has the axes in the order of the transpositions before */
        const int axis = array->shard_order[i] = array->order[i];
        array->chunk[axis] = sizes[i];
        if (array->shard[axis] % sizes[i])
            return refuse(m, "the chunks of its shards do not divide them", error);
    }
    if (place && !(json_is_string(place) && (strcmp(json_string_value(place), "start") == 0 ||
                                             strcmp(json_string_value(place), "end") == 0)))
        return refuse(m, "its index_location is neither start nor end", error);
    array->sharded = true;
    array->index_at_start = place && strcmp(json_string_value(place), "start") == 0;
    ISO_TRY(read_index_codecs(m, configured(codec, "index_codecs"), error));
    return read_codecs(m, configured(codec, "codecs"), true, error);
}

/* First any number of transpositions, then bytes or shards, then what turns bytes into bytes. */
static iso_status read_codecs(const metadata *m, const json_t *list, bool in_shard, iso_error *error) {
    const size_t count = json_array_size(list);
    bool has_bytes = false;
    for (size_t i = 0; i < count && i < 4 * ISO_ZARR_CODECS; i++) {
        const json_t *codec = json_array_get(list, i);
        const char *name = name_of(codec);
        if (!name) return refuse(m, "has a codec without a name", error);
        const bool is_bytes = strcmp(name, "bytes") == 0, is_shard = strcmp(name, "sharding_indexed") == 0;
        if (!has_bytes && strcmp(name, "transpose") == 0) {
            ISO_TRY(read_transpose(m, codec, error));
        } else if (!has_bytes && is_bytes) {
            has_bytes = true;
            ISO_TRY(read_endian(m, codec, &m->array->big_endian, error));
        } else if (!has_bytes && is_shard && !in_shard && i + 1 == count) {
            has_bytes = true;
            ISO_TRY(read_sharding(m, codec, error));
        } else if (has_bytes && !is_bytes) {
            ISO_TRY(add_codec(m, name, json_object_get(codec, "configuration"), &m->array->codecs, error));
        } else {
            return refuse_name(m, "at this place the codec", name, error);
        }
    }
    return has_bytes ? ISO_OK : refuse(m, "its codecs do not say how numbers become bytes", error);
}

static iso_status read_keys(const metadata *m, iso_error *error) {
    const json_t *encoding = json_object_get(m->json, "chunk_key_encoding");
    const char *name = name_of(encoding);
    const json_t *separator = configured(encoding, "separator");
    const bool is_default = name && strcmp(name, "default") == 0, is_v2 = name && strcmp(name, "v2") == 0;
    if (!is_default && !is_v2) return refuse(m, "its chunk_key_encoding is neither default nor v2", error);
    if (separator && !is_separator(json_string_value(separator)))
        return refuse(m, "its separator is neither . nor /", error);
    m->array->has_prefix = is_default;
    m->array->separator = separator ? *json_string_value(separator) : is_default ? '/' : '.';
    return ISO_OK;
}

static iso_status read_v3(const metadata *m, iso_error *error) {
    iso_zarr_array *array = m->array;
    const json_t *grid = json_object_get(m->json, "chunk_grid");
    const char *type = name_of(json_object_get(m->json, "data_type")), *grid_name = name_of(grid);
    double format;
    if (!iso_zarr_number(json_object_get(m->json, "zarr_format"), 3, 3, &format))
        return refuse(m, "its zarr_format is not 3", error);
    array->version = 3;
    ISO_TRY(read_shape(m, error));
    set_identity(array);
    if (!type) return refuse(m, "has no data_type", error);
    if (!scalar_of_v3(type, &array->scalar)) return refuse_name(m, "the data_type", type, error);
    if (!grid_name || strcmp(grid_name, "regular") != 0)
        return refuse(m, "its chunk_grid is not regular", error);
    if (!read_sizes(configured(grid, "chunk_shape"), array->axes, array->shard))
        return refuse(m, "its chunk_shape is not of whole numbers from 1, one for each axis", error);
    memcpy(array->chunk, array->shard, sizeof array->chunk);
    ISO_TRY(check_chunk(m, error));
    ISO_TRY(read_fill(m, error));
    ISO_TRY(read_keys(m, error));
    ISO_TRY(read_codecs(m, json_object_get(m->json, "codecs"), false, error));
    read_axis_names(json_object_get(m->json, "dimension_names"), array);
    return ISO_OK;
}

/* ---- N5 */

/* Lists of N5 begin with x. */
static bool read_reversed(const json_t *list, int axes, uint64_t sizes[ISO_ZARR_AXES]) {
    uint64_t from_x[ISO_ZARR_AXES];
    if (!read_sizes(list, axes, from_x)) return false;
    for (int i = 0; i < axes; i++) sizes[axes - 1 - i] = from_x[i];
    return true;
}

/* The type of the compression, which older files give by itself. */
static iso_status read_compression(const metadata *m, iso_error *error) {
    static const char *const names[][2] = {
        {"bzip2", "bz2"}, {"zstandard", "zstd"}, {"gzip", "gzip"}, {"zstd", "zstd"}, {"blosc", "blosc"}};
    const json_t *compression = json_object_get(m->json, "compression");
    const char *type = json_string_value(compression ? json_object_get(compression, "type")
                                                     : json_object_get(m->json, "compressionType"));
    iso_zarr_codecs *codecs = &m->array->codecs;
    if (!type) return refuse(m, "its compression has no type", error);
    if (strcmp(type, "raw") == 0) return ISO_OK;
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        if (strcmp(type, names[i][0]) == 0) return add_codec(m, names[i][1], NULL, codecs, error);
    if (strcmp(type, "lz4") != 0) return refuse_name(m, "the compression", type, error);
    codecs->codec[codecs->count++] = (iso_zarr_codec){ISO_CODEC_LZ4_STREAM, "lz4", 1};
    return ISO_OK;
}

/* "resolution", with "units", or "pixelResolution": distances along x, y, z. */
static void read_resolution(const metadata *m) {
    const json_t *pixel = json_object_get(m->json, "pixelResolution"),
                 *list =
                     pixel ? json_object_get(pixel, "dimensions") : json_object_get(m->json, "resolution"),
                 *units = json_object_get(m->json, "units");
    const int axes = m->array->axes;
    for (int i = 0; i < axes; i++) {
        const char *unit =
            json_string_value(pixel ? json_object_get(pixel, "unit") : json_array_get(units, (size_t)i));
        double distance;
        if (!unit || !iso_zarr_number(json_array_get(list, (size_t)i), 1e-12, 1e12, &distance)) continue;
        m->array->spacing[axes - 1 - i] = distance * iso_zarr_unit_in_mm(unit);
    }
}

static iso_status read_n5(const metadata *m, iso_error *error) {
    iso_zarr_array *array = m->array;
    const json_t *dimensions = json_object_get(m->json, "dimensions"),
                 *names = json_object_get(m->json, "axes");
    const char *type = json_string_value(json_object_get(m->json, "dataType"));
    const size_t axes = json_array_size(dimensions);
    if (axes < 2 || axes > ISO_ZARR_AXES) return refuse(m, "has no dimensions of 2 to 8 axes", error);
    array->axes = (int)axes;
    if (!read_reversed(dimensions, array->axes, array->shape))
        return refuse(m, "its dimensions are not whole numbers from 1", error);
    if (!read_reversed(json_object_get(m->json, "blockSize"), array->axes, array->chunk))
        return refuse(m, "its blockSize is not of whole numbers from 1, one for each axis", error);
    memcpy(array->shard, array->chunk, sizeof array->shard);
    ISO_TRY(check_chunk(m, error));
    if (!type) return refuse(m, "has no dataType", error);
    if (!scalar_of_v3(type, &array->scalar)) return refuse_name(m, "the dataType", type, error);
    for (size_t i = 0; i < axes; i++) {
        const char *name = json_string_value(json_array_get(names, i));
        if (name) snprintf(array->names[axes - 1 - i], ISO_ZARR_NAME, "%s", name);
    }
    array->n5 = array->big_endian = true;
    array->separator = '/';
    read_resolution(m);
    set_identity(array);
    return read_compression(m, error);
}

/* ---- all */

static iso_status read_file(const char *folder, const char *name, const iso_volume_opts *opts,
                            iso_zarr_array *array, bool *found, iso_error *error) {
    json_t *json;
    char *path;
    ISO_TRY(iso_zarr_read_json(folder, name, opts, &json, error));
    const char *node = json_string_value(json_object_get(json, "node_type"));
    const bool is_v2 = strcmp(name, ".zarray") == 0, is_n5 = strcmp(name, "attributes.json") == 0;
    *found =
        json &&
        (is_v2 || (is_n5 ? json_object_get(json, "dimensions") != NULL : node && strcmp(node, "array") == 0));
    iso_status status = ISO_OK;
    if (*found && asprintf(&path, "%s/%s", folder, name) < 0) status = iso_fail_memory(error, folder);
    if (*found && status == ISO_OK) {
        const metadata m = {path, json, array};
        iso_file_set_read(opts->files, path);
        status = is_v2 ? read_v2(&m, error) : is_n5 ? read_n5(&m, error) : read_v3(&m, error);
        if (is_v2 && status == ISO_OK) status = read_attributes_of_v2(folder, opts, array, error);
        free(path);
    }
    json_decref(json);
    return status;
}

iso_status iso_zarr_read_array(const char *folder, const iso_volume_opts *opts, iso_zarr_array *array,
                               bool *found, iso_error *error) {
    *array = (iso_zarr_array){0};
    static const char *const names[] = {"zarr.json", ".zarray", "attributes.json"};
    *found = false;
    for (size_t i = 0; i < sizeof names / sizeof *names && !*found; i++)
        ISO_TRY(read_file(folder, names[i], opts, array, found, error));
    return ISO_OK;
}
