/* make_volumes: writers of all formats, each from the description of its format. */
#include "make_volumes.h"

#include <stdlib.h>
#include <string.h>

#include <zlib.h>

/* ---- values ---- */

size_t vol_count(const vol_spec *spec) {
    return (size_t)spec->dims[0] * (size_t)spec->dims[1] * (size_t)spec->dims[2];
}

double vol_value(const vol_spec *spec, size_t voxel, int component) {
    uint32_t hash = (uint32_t)(voxel * 3 + (size_t)component + 1) * 2654435761u;
    switch (spec->scalar) {
    case ISO_SCALAR_UINT8:
        return hash >> 24;
    case ISO_SCALAR_INT8:
        return (int)(hash >> 24) - 128;
    case ISO_SCALAR_UINT16:
        return hash >> 16;
    case ISO_SCALAR_INT16:
        return (int)(hash >> 16) - 32768;
    case ISO_SCALAR_UINT32:
    case ISO_SCALAR_UINT64:
        return hash >> 9;
    case ISO_SCALAR_INT32:
    case ISO_SCALAR_INT64:
        return (int)(hash >> 9) - 4000000;
    default:
        return ((int)(hash >> 10) - 2000000) / 8.0;
    }
}

#define STORE(type)                                                                                          \
    do {                                                                                                     \
        type v = (type)value;                                                                                \
        memcpy(bytes, &v, sizeof v);                                                                         \
    } while (0)

static void put_value(FILE *file, iso_scalar scalar, double value, bool big) {
    unsigned char bytes[8];
    switch (scalar) {
    case ISO_SCALAR_UINT8:
        STORE(uint8_t);
        break;
    case ISO_SCALAR_INT8:
        STORE(int8_t);
        break;
    case ISO_SCALAR_UINT16:
        STORE(uint16_t);
        break;
    case ISO_SCALAR_INT16:
        STORE(int16_t);
        break;
    case ISO_SCALAR_UINT32:
        STORE(uint32_t);
        break;
    case ISO_SCALAR_INT32:
        STORE(int32_t);
        break;
    case ISO_SCALAR_UINT64:
        STORE(uint64_t);
        break;
    case ISO_SCALAR_INT64:
        STORE(int64_t);
        break;
    case ISO_SCALAR_FLOAT:
        STORE(float);
        break;
    default:
        STORE(double);
    }
    size_t size = iso_scalar_size(scalar);
    for (size_t i = 0; i < size; i++) fputc(bytes[big ? size - 1 - i : i], file);
}

void vol_put_values(FILE *file, const vol_spec *spec, bool planar) {
    size_t count = vol_count(spec);
    for (size_t i = 0; i < count * (size_t)spec->components; i++) {
        size_t voxel = planar ? i % count : i / (size_t)spec->components;
        int component = (int)(planar ? i / count : i % (size_t)spec->components);
        put_value(file, spec->scalar, vol_value(spec, voxel, component), spec->big);
    }
}

static void put_text(FILE *file, const vol_spec *spec) {
    for (size_t i = 0; i < vol_count(spec); i++)
        for (int c = 0; c < spec->components; c++)
            fprintf(file, "%.12g%c", vol_value(spec, i, c), (i + 1) % 7 ? ' ' : '\n');
}

/* The values of a volume as a block of memory. */
static unsigned char *value_block(const vol_spec *spec, bool planar, size_t *bytes) {
    char *block = NULL;
    FILE *memory = open_memstream(&block, bytes);
    vol_put_values(memory, spec, planar);
    fclose(memory);
    return (unsigned char *)block;
}

/* ---- files ---- */

const char *vol_path(const char *folder, const char *name, int slot) {
    static char paths[4][1024];
    snprintf(paths[slot], sizeof paths[slot], "%s/%s", folder, name);
    return paths[slot];
}

static FILE *create(const char *folder, const char *name) {
    const char *path = vol_path(folder, name, 3);
    FILE *file = fopen(path, "wb");
    if (file) return file;
    fprintf(stderr, "%s: cannot be written\n", path);
    abort();
}

void vol_write_bytes(const char *path, const void *bytes, size_t count) {
    FILE *file = fopen(path, "wb");
    if (!file || fwrite(bytes, 1, count, file) != count) abort();
    fclose(file);
}

void vol_write_text(const char *path, const char *text) {
    vol_write_bytes(path, text, strlen(text));
}

unsigned char *vol_read_bytes(const char *path, size_t *count) {
    FILE *file = fopen(path, "rb");
    if (!file) abort();
    fseek(file, 0, SEEK_END);
    *count = (size_t)ftell(file);
    rewind(file);
    unsigned char *bytes = malloc(*count + 1);
    if (!bytes || fread(bytes, 1, *count, file) != *count) abort();
    bytes[*count] = 0;
    fclose(file);
    return bytes;
}

/* Compresses bytes by deflate, with a zlib (window 15) or gzip (31) header. */
static unsigned char *deflated(const unsigned char *bytes, size_t count, int window, size_t *packed) {
    z_stream z = {0};
    if (deflateInit2(&z, 6, Z_DEFLATED, window, 8, Z_DEFAULT_STRATEGY) != Z_OK) abort();
    size_t room = deflateBound(&z, count) + 64;
    unsigned char *out = malloc(room);
    if (!out) abort();
    z.next_in = (unsigned char *)bytes;
    z.avail_in = (uInt)count;
    z.next_out = out;
    z.avail_out = (uInt)room;
    if (deflate(&z, Z_FINISH) != Z_STREAM_END) abort();
    *packed = z.total_out;
    deflateEnd(&z);
    return out;
}

/* ---- legacy VTK ---- */

static const char *vtk_type(iso_scalar scalar) {
    static const char *const names[] = {"unsigned_char", "char",  "unsigned_short", "short",
                                        "unsigned_int",  "int",   "unsigned_long",  "long",
                                        "float",         "double"};
    return names[scalar];
}

enum { VTK_BINARY = 0, VTK_ASCII = 1, VTK_FIELD = 2, VTK_CELLS = 4 };

static void write_vtk(const vol_kind *kind, const char *folder, const vol_spec *spec) {
    FILE *file = create(folder, kind->files[0]);
    bool ascii = kind->variant & VTK_ASCII, cells = kind->variant & VTK_CELLS;
    int more = cells ? 1 : 0;
    fprintf(file, "# vtk DataFile Version 3.0\nmade for a test\n%s\nDATASET STRUCTURED_POINTS\n",
            ascii ? "ASCII" : "BINARY");
    fprintf(file, "DIMENSIONS %d %d %d\nSPACING 0.5 1 2\nORIGIN 1 2 3\n", spec->dims[0] + more,
            spec->dims[1] + more, spec->dims[2] + more);
    fprintf(file, "%s_DATA %zu\n", cells ? "CELL" : "POINT", vol_count(spec));
    if (kind->variant & VTK_FIELD)
        fprintf(file, "FIELD FieldData 1\nvalues %d %zu %s\n", spec->components, vol_count(spec),
                vtk_type(spec->scalar));
    else
        fprintf(file, "SCALARS values %s %d\nLOOKUP_TABLE default\n", vtk_type(spec->scalar),
                spec->components);
    vol_spec big = *spec;
    big.big = true;
    if (ascii)
        put_text(file, spec);
    else
        vol_put_values(file, &big, false);
    fputc('\n', file);
    fclose(file);
}

/* ---- MetaImage ---- */

static const char *meta_type(iso_scalar scalar) {
    static const char *const names[] = {"MET_UCHAR", "MET_CHAR",  "MET_USHORT",     "MET_SHORT",
                                        "MET_UINT",  "MET_INT",   "MET_ULONG_LONG", "MET_LONG_LONG",
                                        "MET_FLOAT", "MET_DOUBLE"};
    return names[scalar];
}

enum { META_LOCAL, META_ZLIB, META_TEXT, META_RAW, META_SKIP, META_LIST, META_PATTERN, META_ZRAW };

static void put_meta_data(FILE *file, const vol_kind *kind, const vol_spec *spec) {
    if (kind->variant == META_TEXT) {
        put_text(file, spec);
    } else if (kind->variant == META_ZLIB || kind->variant == META_ZRAW) {
        size_t bytes, packed;
        unsigned char *block = value_block(spec, false, &bytes);
        unsigned char *small = deflated(block, bytes, 15, &packed);
        fwrite(small, 1, packed, file);
        free(block);
        free(small);
    } else {
        vol_put_values(file, spec, false);
    }
}

/* Writes one file for each slice. */
static void write_slices(const vol_kind *kind, const char *folder, const vol_spec *spec) {
    size_t bytes;
    unsigned char *block = value_block(spec, false, &bytes);
    size_t each = bytes / (size_t)spec->dims[2];
    for (int z = 0; z < spec->dims[2] && kind->files[z + 1]; z++)
        vol_write_bytes(vol_path(folder, kind->files[z + 1], 3), block + (size_t)z * each, each);
    free(block);
}

static void write_meta(const vol_kind *kind, const char *folder, const vol_spec *spec) {
    FILE *file = create(folder, kind->files[0]);
    int variant = kind->variant;
    fprintf(file, "ObjectType = Image\nNDims = 3\nBinaryData = %s\nBinaryDataByteOrderMSB = %s\n",
            variant == META_TEXT ? "False" : "True", spec->big ? "True" : "False");
    fprintf(file, "CompressedData = %s\n", variant == META_ZLIB || variant == META_ZRAW ? "True" : "False");
    fprintf(file, "Offset = 1 2 3\nElementSpacing = 0.5 1 2\nDimSize = %d %d %d\n", spec->dims[0],
            spec->dims[1], spec->dims[2]);
    if (variant == META_SKIP) fprintf(file, "HeaderSize = 11\n");
    fprintf(file, "ElementNumberOfChannels = %d\nElementType = %s\nElementDataFile = ", spec->components,
            meta_type(spec->scalar));
    if (variant == META_LIST) {
        fprintf(file, "LIST\n");
        for (int z = 0; z < spec->dims[2]; z++) fprintf(file, "%s\n", kind->files[z + 1]);
    } else if (variant == META_PATTERN) {
        fprintf(file, "slice%%03d.raw 7 8 1\n");
    } else if (kind->files[1]) {
        fprintf(file, "%s\n", kind->files[1]);
    } else {
        fprintf(file, "LOCAL\n");
        put_meta_data(file, kind, spec);
    }
    fclose(file);
    if (variant == META_LIST || variant == META_PATTERN) {
        write_slices(kind, folder, spec);
    } else if (kind->files[1]) {
        file = create(folder, kind->files[1]);
        if (variant == META_SKIP) fprintf(file, "not voxels!");
        put_meta_data(file, kind, spec);
        fclose(file);
    }
}

/* ---- NRRD ---- */

enum {
    NRRD_RAW,
    NRRD_GZIP,
    NRRD_ASCII,
    NRRD_HEX,
    NRRD_DETACHED,
    NRRD_SKIP,
    NRRD_LINES,
    NRRD_LIST,
    NRRD_PATTERN,
    NRRD_LAST
};

static const char *nrrd_type(iso_scalar scalar) {
    static const char *const names[] = {"uchar", "signed char", "ushort", "short", "uint",
                                        "int",   "uint64",      "int64",  "float", "double"};
    return names[scalar];
}

static void put_nrrd_data(FILE *file, int variant, const vol_spec *spec) {
    size_t bytes, packed;
    unsigned char *block = value_block(spec, variant == NRRD_LAST, &bytes);
    if (variant == NRRD_GZIP) {
        unsigned char *small = deflated(block, bytes, 31, &packed);
        fwrite(small, 1, packed, file);
        free(small);
    } else if (variant == NRRD_ASCII) {
        put_text(file, spec);
    } else if (variant == NRRD_HEX) {
        for (size_t i = 0; i < bytes; i++) fprintf(file, "%02x%s", block[i], i % 30 == 29 ? "\n" : "");
    } else {
        fwrite(block, 1, bytes, file);
    }
    free(block);
}

static void put_nrrd_header(FILE *file, const vol_kind *kind, const vol_spec *spec) {
    int variant = kind->variant;
    bool several = spec->components > 1, last = variant == NRRD_LAST;
    const char *encoding = variant == NRRD_GZIP    ? "gzip"
                           : variant == NRRD_ASCII ? "ascii"
                           : variant == NRRD_HEX   ? "hex"
                                                   : "raw";
    fprintf(file, "NRRD0004\ntype: %s\ndimension: %d\nsizes:", nrrd_type(spec->scalar), several ? 4 : 3);
    if (several && !last) fprintf(file, " %d", spec->components);
    fprintf(file, " %d %d %d", spec->dims[0], spec->dims[1], spec->dims[2]);
    if (several && last) fprintf(file, " %d", spec->components);
    fprintf(file, "\nspace: left-posterior-superior\nspace directions:%s (0.5,0,0) (0,1,0) (0,0,2)%s\n",
            several && !last ? " none" : "", several && last ? " none" : "");
    fprintf(file, "space origin: (1,2,3)\nencoding: %s\nendian: %s\n", encoding,
            spec->big ? "big" : "little");
    if (variant == NRRD_SKIP) fprintf(file, "byte skip: 11\n");
    if (variant == NRRD_LINES) fprintf(file, "line skip: 2\n");
    if (variant == NRRD_PATTERN) fprintf(file, "data file: part%%02d.raw 3 4 1\n");
    if (variant == NRRD_LIST) {
        fprintf(file, "data file: LIST\n");
        for (int z = 0; z < spec->dims[2]; z++) fprintf(file, "%s\n", kind->files[z + 1]);
    } else if (kind->files[1] && variant != NRRD_PATTERN) {
        fprintf(file, "data file: %s\n", kind->files[1]);
    }
}

static void write_nrrd(const vol_kind *kind, const char *folder, const vol_spec *spec) {
    FILE *file = create(folder, kind->files[0]);
    put_nrrd_header(file, kind, spec);
    int variant = kind->variant;
    if (variant == NRRD_LIST || variant == NRRD_PATTERN) {
        write_slices(kind, folder, spec);
    } else if (kind->files[1]) {
        FILE *data = create(folder, kind->files[1]);
        if (variant == NRRD_SKIP) fprintf(data, "not voxels!");
        if (variant == NRRD_LINES) fprintf(data, "one\ntwo\n");
        put_nrrd_data(data, variant, spec);
        fclose(data);
    } else {
        fputc('\n', file);
        put_nrrd_data(file, variant, spec);
    }
    fclose(file);
}

/* ---- NIfTI ---- */

enum { NII_ONE = 1, NII_TWO = 2, NII_GZIP = 4, NII_PAIR = 8, NII_ANALYZE = 16 };

static void put_at(vol_nifti *header, size_t offset, iso_scalar scalar, double value) {
    char *block = NULL;
    size_t count;
    FILE *memory = open_memstream(&block, &count);
    put_value(memory, scalar, value, header->big);
    fclose(memory);
    memcpy(header->bytes + offset, block, count);
    free(block);
}

void vol_nifti_set(vol_nifti *header, vol_nifti_field field, int index, double value) {
    static const struct {
        int offset[2];
        iso_scalar scalar[2];
    } fields[] = {{{112, 176}, {ISO_SCALAR_FLOAT, ISO_SCALAR_DOUBLE}},
                  {{116, 184}, {ISO_SCALAR_FLOAT, ISO_SCALAR_DOUBLE}},
                  {{123, 500}, {ISO_SCALAR_UINT8, ISO_SCALAR_INT32}},
                  {{252, 344}, {ISO_SCALAR_INT16, ISO_SCALAR_INT32}},
                  {{254, 348}, {ISO_SCALAR_INT16, ISO_SCALAR_INT32}},
                  {{256, 352}, {ISO_SCALAR_FLOAT, ISO_SCALAR_DOUBLE}},
                  {{280, 400}, {ISO_SCALAR_FLOAT, ISO_SCALAR_DOUBLE}},
                  {{40, 16}, {ISO_SCALAR_INT16, ISO_SCALAR_INT64}},
                  {{76, 104}, {ISO_SCALAR_FLOAT, ISO_SCALAR_DOUBLE}},
                  {{70, 12}, {ISO_SCALAR_INT16, ISO_SCALAR_INT16}},
                  {{108, 168}, {ISO_SCALAR_FLOAT, ISO_SCALAR_INT64}}};
    int which = header->version - 1;
    iso_scalar scalar = fields[field].scalar[which];
    size_t offset = (size_t)fields[field].offset[which] + (size_t)index * iso_scalar_size(scalar);
    put_at(header, offset, scalar, value);
}

void vol_nifti_make(vol_nifti *header, int version, const vol_spec *spec) {
    static const int types[] = {2, 256, 512, 4, 768, 8, 1280, 1024, 16, 64};
    *header = (vol_nifti){.version = version, .big = spec->big, .count = version == 1 ? 352 : 544};
    put_at(header, 0, ISO_SCALAR_INT32, version == 1 ? 348 : 540);
    if (version == 1)
        memcpy(header->bytes + 344, "n+1", 4);
    else
        memcpy(header->bytes + 4, "n+2\0\r\n\032\n", 8);
    vol_nifti_set(header, VOL_NIFTI_DIM, 0, spec->components > 1 ? 4 : 3);
    for (int i = 0; i < 3; i++) vol_nifti_set(header, VOL_NIFTI_DIM, i + 1, spec->dims[i]);
    for (int i = 4; i < 8; i++) vol_nifti_set(header, VOL_NIFTI_DIM, i, i == 4 ? spec->components : 1);
    vol_nifti_set(header, VOL_NIFTI_TYPE, 0, types[spec->scalar]);
    put_at(header, version == 1 ? 72 : 14, ISO_SCALAR_INT16, 8.0 * (double)iso_scalar_size(spec->scalar));
    const double pixdim[4] = {1, 0.5, 1, 2};
    for (int i = 0; i < 4; i++) vol_nifti_set(header, VOL_NIFTI_PIXDIM, i, pixdim[i]);
    vol_nifti_set(header, VOL_NIFTI_OFFSET, 0, (double)header->count);
    /* the rows in RAS of the LPS origin 1 2 3 and identity directions */
    const double rows[12] = {-0.5, 0, 0, -1, 0, -1, 0, -2, 0, 0, 2, 3};
    vol_nifti_set(header, VOL_NIFTI_SFORM, 0, 1);
    for (int i = 0; i < 12; i++) vol_nifti_set(header, VOL_NIFTI_SROW, i, rows[i]);
}

static void write_nifti(const vol_kind *kind, const char *folder, const vol_spec *spec) {
    vol_nifti header;
    vol_nifti_make(&header, kind->variant & NII_TWO ? 2 : 1, spec);
    size_t bytes, packed;
    unsigned char *block = value_block(spec, true, &bytes);
    if (kind->variant & (NII_PAIR | NII_ANALYZE)) {
        vol_nifti_set(&header, VOL_NIFTI_OFFSET, 0, 0);
        memcpy(header.bytes + 344, kind->variant & NII_PAIR ? "ni1" : "\0\0\0", 4);
        vol_write_bytes(vol_path(folder, kind->files[0], 3), header.bytes, 348);
        vol_write_bytes(vol_path(folder, kind->files[1], 3), block, bytes);
        free(block);
        return;
    }
    unsigned char *whole = malloc(header.count + bytes);
    if (!whole) abort();
    memcpy(whole, header.bytes, header.count);
    memcpy(whole + header.count, block, bytes);
    if (kind->variant & NII_GZIP) {
        unsigned char *small = deflated(whole, header.count + bytes, 31, &packed);
        vol_write_bytes(vol_path(folder, kind->files[0], 3), small, packed);
        free(small);
    } else {
        vol_write_bytes(vol_path(folder, kind->files[0], 3), whole, header.count + bytes);
    }
    free(whole);
    free(block);
}

static bool analyze_suits(const vol_spec *spec) {
    return spec->scalar == ISO_SCALAR_UINT8 || spec->scalar == ISO_SCALAR_INT16 ||
           spec->scalar == ISO_SCALAR_INT32 || spec->scalar == ISO_SCALAR_FLOAT ||
           spec->scalar == ISO_SCALAR_DOUBLE;
}

/* ---- .vti ---- */

enum { VTI_ASCII, VTI_INLINE, VTI_RAW, VTI_BASE64, VTI_ZLIB = 4, VTI_CELLS = 8 };

static void put_base64(FILE *file, const unsigned char *bytes, size_t count) {
    static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    for (size_t i = 0; i < count; i += 3) {
        uint32_t v = (uint32_t)bytes[i] << 16;
        if (i + 1 < count) v |= (uint32_t)bytes[i + 1] << 8;
        if (i + 2 < count) v |= bytes[i + 2];
        fputc(digits[v >> 18], file);
        fputc(digits[v >> 12 & 63], file);
        fputc(i + 1 < count ? digits[v >> 6 & 63] : '=', file);
        fputc(i + 2 < count ? digits[v & 63] : '=', file);
    }
}

static void put_vti_data(FILE *file, const vol_kind *kind, const vol_spec *spec) {
    size_t bytes, packed, head;
    unsigned char *block = value_block(spec, false, &bytes), *data = block;
    char *prefix = NULL;
    FILE *memory = open_memstream(&prefix, &head);
    bool zlib = kind->variant & VTI_ZLIB;
    if (zlib) {
        data = deflated(block, bytes, 15, &packed);
        const size_t numbers[4] = {1, bytes, 0, packed}; /* blocks, size, size of the last, compressed size */
        for (int i = 0; i < 4; i++) put_value(memory, ISO_SCALAR_UINT32, (double)numbers[i], spec->big);
    } else {
        packed = bytes;
        put_value(memory, ISO_SCALAR_UINT32, (double)bytes, spec->big);
    }
    fclose(memory);
    if ((kind->variant & 3) == VTI_RAW) {
        fwrite(prefix, 1, head, file);
        fwrite(data, 1, packed, file);
    } else if (zlib) { /* the header is encoded separately from the data */
        put_base64(file, (unsigned char *)prefix, head);
        put_base64(file, data, packed);
    } else {
        prefix = realloc(prefix, head + packed);
        if (!prefix) abort();
        memcpy(prefix + head, data, packed);
        put_base64(file, (unsigned char *)prefix, head + packed);
    }
    if (zlib) free(data);
    free(prefix);
    free(block);
}

static void write_vti(const vol_kind *kind, const char *folder, const vol_spec *spec) {
    static const char *const types[] = {"UInt8", "Int8",   "UInt16", "Int16",   "UInt32",
                                        "Int32", "UInt64", "Int64",  "Float32", "Float64"};
    FILE *file = create(folder, kind->files[0]);
    int way = kind->variant & 3, more = kind->variant & VTI_CELLS ? 1 : 0;
    char box[80];
    /* the extent begins at 2 -1 0, so that the origin of index 0 lies elsewhere */
    snprintf(box, sizeof box, "2 %d -1 %d 0 %d", spec->dims[0] + 1 + more, spec->dims[1] - 2 + more,
             spec->dims[2] - 1 + more);
    fprintf(file,
            "<?xml version=\"1.0\"?>\n<VTKFile type=\"ImageData\" version=\"0.1\" byte_order=\"%s\"%s>\n",
            spec->big ? "BigEndian" : "LittleEndian",
            kind->variant & VTI_ZLIB ? " compressor=\"vtkZLibDataCompressor\"" : "");
    fprintf(file,
            "<ImageData WholeExtent=\"%s\" Origin=\"0 3 3\" Spacing=\"0.5 1 2\">\n<Piece Extent=\"%s\">\n",
            box, box);
    const char *data = more ? "CellData" : "PointData";
    fprintf(file,
            "<%s Scalars=\"values\">\n<DataArray type=\"%s\" Name=\"values\" NumberOfComponents=\"%d\" "
            "format=\"%s\"",
            data, types[spec->scalar], spec->components,
            way == VTI_ASCII    ? "ascii"
            : way == VTI_INLINE ? "binary"
                                : "appended");
    bool appended = way == VTI_RAW || way == VTI_BASE64;
    fprintf(file, appended ? " offset=\"0\"/>\n" : ">\n");
    if (way == VTI_ASCII) put_text(file, spec);
    if (way == VTI_INLINE) put_vti_data(file, kind, spec);
    fprintf(file, "%s</%s>\n</Piece>\n</ImageData>\n", appended ? "" : "\n</DataArray>\n", data);
    if (appended) {
        fprintf(file, "<AppendedData encoding=\"%s\">\n_", way == VTI_RAW ? "raw" : "base64");
        put_vti_data(file, kind, spec);
        fprintf(file, "\n</AppendedData>\n");
    }
    fprintf(file, "</VTKFile>\n");
    fclose(file);
}

const vol_kind vol_kinds[] = {
    {"vtk binary", {"a.vtk"}, NULL, write_vtk, VTK_BINARY, "vtk"},
    {"vtk text", {"b.vtk"}, NULL, write_vtk, VTK_ASCII, "vtk"},
    {"vtk field", {"c.vtk"}, NULL, write_vtk, VTK_FIELD, "vtk"},
    {"vtk field text", {"d.vtk"}, NULL, write_vtk, VTK_FIELD | VTK_ASCII, "vtk"},
    {"vtk cells", {"e.vtk"}, NULL, write_vtk, VTK_CELLS, "vtk"},
    {"mha", {"a.mha"}, NULL, write_meta, META_LOCAL, "metaimage"},
    {"mha deflated", {"b.mha"}, NULL, write_meta, META_ZLIB, "metaimage"},
    {"mha text", {"c.mha"}, NULL, write_meta, META_TEXT, "metaimage"},
    {"mhd raw", {"a.mhd", "a.raw"}, NULL, write_meta, META_RAW, "metaimage"},
    {"mhd HeaderSize", {"b.mhd", "b.raw"}, NULL, write_meta, META_SKIP, "metaimage"},
    {"mhd zraw", {"c.mhd", "c.zraw"}, NULL, write_meta, META_ZRAW, "metaimage"},
    {"mhd list", {"d.mhd", "d1.raw", "d2.raw"}, NULL, write_meta, META_LIST, "metaimage"},
    {"mhd pattern", {"e.mhd", "slice007.raw", "slice008.raw"}, NULL, write_meta, META_PATTERN, "metaimage"},
    {"nrrd raw", {"a.nrrd"}, NULL, write_nrrd, NRRD_RAW, "nrrd"},
    {"nrrd gzip", {"b.nrrd"}, NULL, write_nrrd, NRRD_GZIP, "nrrd"},
    {"nrrd text", {"c.nrrd"}, NULL, write_nrrd, NRRD_ASCII, "nrrd"},
    {"nrrd hex", {"d.nrrd"}, NULL, write_nrrd, NRRD_HEX, "nrrd"},
    {"nrrd components last", {"e.nrrd"}, NULL, write_nrrd, NRRD_LAST, "nrrd"},
    {"nhdr", {"a.nhdr", "an.raw"}, NULL, write_nrrd, NRRD_DETACHED, "nrrd"},
    {"nhdr byte skip", {"b.nhdr", "bn.raw"}, NULL, write_nrrd, NRRD_SKIP, "nrrd"},
    {"nhdr line skip", {"c.nhdr", "cn.raw"}, NULL, write_nrrd, NRRD_LINES, "nrrd"},
    {"nhdr list", {"d.nhdr", "dn1.raw", "dn2.raw"}, NULL, write_nrrd, NRRD_LIST, "nrrd"},
    {"nhdr pattern", {"e.nhdr", "part03.raw", "part04.raw"}, NULL, write_nrrd, NRRD_PATTERN, "nrrd"},
    {"nii", {"a.nii"}, NULL, write_nifti, NII_ONE, "nifti"},
    {"nii version 2", {"b.nii"}, NULL, write_nifti, NII_TWO, "nifti"},
    {"nii.gz", {"c.nii.gz"}, NULL, write_nifti, NII_ONE | NII_GZIP, "nifti"},
    {"nifti pair", {"d.hdr", "d.img"}, NULL, write_nifti, NII_ONE | NII_PAIR, "nifti"},
    {"analyze", {"e.hdr", "e.img"}, analyze_suits, write_nifti, NII_ONE | NII_ANALYZE, "nifti"},
    {"vti text", {"a.vti"}, NULL, write_vti, VTI_ASCII, "vti"},
    {"vti inline", {"b.vti"}, NULL, write_vti, VTI_INLINE, "vti"},
    {"vti raw", {"c.vti"}, NULL, write_vti, VTI_RAW, "vti"},
    {"vti base64", {"d.vti"}, NULL, write_vti, VTI_BASE64, "vti"},
    {"vti zlib", {"e.vti"}, NULL, write_vti, VTI_BASE64 | VTI_ZLIB, "vti"},
    {"vti inline zlib", {"f.vti"}, NULL, write_vti, VTI_INLINE | VTI_ZLIB, "vti"},
    {"vti cells", {"g.vti"}, NULL, write_vti, VTI_RAW | VTI_CELLS, "vti"},
};
const size_t vol_kind_count = sizeof vol_kinds / sizeof *vol_kinds;
