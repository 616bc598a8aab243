/* NRRD: the ways to store an array that the other tests of formats do not cover, the grammar of headers, and
 * headers with wrong numbers. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include <cmocka.h>

#include "grids/volume/nrrd.h"
#include "make_volumes.h"

static const char folder[] = ISO_TEST_TMP "/nrrd";

/* "abc" and the bytes 1 to 8, in two streams one after the other. */
static const unsigned char bzip2_bytes[] = {
    0x42, 0x5a, 0x68, 0x39, 0x31, 0x41, 0x59, 0x26, 0x53, 0x59, 0x06, 0x3b, 0x69, 0xee, 0x00, 0x00, 0x01,
    0xc1, 0x00, 0x38, 0x00, 0x38, 0x00, 0x20, 0x00, 0x21, 0x80, 0x0c, 0x03, 0x27, 0x2e, 0xe2, 0xee, 0x48,
    0xa7, 0x0a, 0x12, 0x00, 0xc7, 0x6d, 0x3d, 0xc0, 0x42, 0x5a, 0x68, 0x39, 0x31, 0x41, 0x59, 0x26, 0x53,
    0x59, 0x2d, 0x97, 0x69, 0x82, 0x00, 0x00, 0x00, 0x40, 0x00, 0x07, 0xc0, 0x20, 0x00, 0x21, 0x83, 0x41,
    0x9a, 0x02, 0x5c, 0x71, 0x77, 0x24, 0x53, 0x85, 0x09, 0x02, 0xd9, 0x76, 0x98, 0x20};

static void write_parts(const char *name, const char *header, const void *bytes, size_t count) {
    FILE *file = fopen(vol_path(folder, name, 0), "wb");
    assert_non_null(file);
    fputs(header, file);
    fwrite(bytes, 1, count, file);
    fclose(file);
}

/* Voxels 1, 2, 3 ... 8 of any type, two each way. */
static void check_counts(const char *name) {
    iso_volume volume;
    iso_error error = {0};
    if (iso_volume_read(vol_path(folder, name, 0), NULL, &volume, &error) != ISO_OK)
        fail_msg("%s: %s", name, error.text);
    for (int i = 0; i < 8; i++)
        if (iso_rgrid_at(volume.grid.rgrid, i & 1, i >> 1 & 1, i >> 2) != (float)(i + 1))
            fail_msg("%s: voxel %d is %g", name, i,
                     (double)iso_rgrid_at(volume.grid.rgrid, i & 1, i >> 1 & 1, i >> 2));
    iso_volume_free(&volume);
}

static void check_refused(const char *name, iso_status status, const char *part) {
    const char *path = vol_path(folder, name, 0);
    iso_volume volume;
    iso_error error = {0};
    iso_status got = iso_volume_read(path, NULL, &volume, &error);
    if (got == ISO_OK) iso_volume_free(&volume);
    if (got != status || strncmp(error.text, path, strlen(path)) != 0 || !strstr(error.text, part) ||
        strchr(error.text, '\n'))
        fail_msg("%s: status %d, '%s' instead of %d, '%s'", name, got, error.text, status, part);
}

#define BEGIN "NRRD0005\ntype: uchar\ndimension: 3\nsizes: 2 2 2\n"

static void bzip2_streams_follow_each_other(void **state) {
    (void)state;
    write_parts("a.nrrd", BEGIN "encoding: bzip2\nbyte skip: 3\n\n", bzip2_bytes, sizeof bzip2_bytes);
    iso_volume volume;
    iso_status status = iso_volume_read(vol_path(folder, "a.nrrd", 0), NULL, &volume, NULL);
    if (status == ISO_ERR_UNSUPPORTED) {
        check_refused("a.nrrd", ISO_ERR_UNSUPPORTED, "built without libbz2");
        skip();
    }
    if (status == ISO_OK) iso_volume_free(&volume);
    check_counts("a.nrrd");
    write_parts("a.nrrd", BEGIN "encoding: bz2\nbyte skip: -1\n\n", bzip2_bytes, sizeof bzip2_bytes);
    check_counts("a.nrrd");
    for (size_t cut = 1; cut < sizeof bzip2_bytes; cut++) {
        write_parts("a.nrrd", BEGIN "encoding: bz2\nbyte skip: 3\n\n", bzip2_bytes, sizeof bzip2_bytes - cut);
        check_refused("a.nrrd", ISO_ERR_IO, "truncated");
    }
    unsigned char wrong[sizeof bzip2_bytes];
    for (size_t i = 0; i < sizeof wrong; i++) {
        memcpy(wrong, bzip2_bytes, sizeof wrong);
        wrong[i] ^= 0x10;
        write_parts("a.nrrd", BEGIN "encoding: bz2\nbyte skip: 3\n\n", wrong, sizeof wrong);
        status = iso_volume_read(vol_path(folder, "a.nrrd", 0), NULL, &volume, NULL);
        if (status == ISO_OK) check_counts("a.nrrd"); /* a size of blocks, which need only be large enough */
        if (status == ISO_OK) iso_volume_free(&volume);
    }
}

static void run_lengths_of_zeros(void **state) {
    (void)state;
    static const unsigned char bytes[] = {7, 0, 2, 9, 0, 0, 3, 0, 1};
    write_parts("z.nrrd", BEGIN "encoding: zrl\n\n", bytes, sizeof bytes);
    iso_volume volume;
    iso_error error = {0};
    if (iso_volume_read(vol_path(folder, "z.nrrd", 0), NULL, &volume, &error) != ISO_OK)
        fail_msg("%s", error.text);
    static const unsigned char wanted[] = {7, 0, 0, 9, 0, 0, 0, 1};
    assert_memory_equal(volume.grid.rgrid->data, wanted, sizeof wanted);
    iso_volume_free(&volume);
    for (size_t count = 0; count < sizeof bytes; count++) {
        write_parts("z.nrrd", BEGIN "encoding: zrl\n\n", bytes, count);
        check_refused("z.nrrd", ISO_ERR_IO, "truncated");
    }
}

static void text_may_have_commas(void **state) {
    (void)state;
    write_parts("t.nrrd", BEGIN "encoding: ascii\n\n1, 2 ,3 , 4,\n5 6\t7 8\n", "", 0);
    check_counts("t.nrrd");
    write_parts("t.nrrd", BEGIN "encoding: ascii\n\n1 2 3 4 5 6 7 x\n", "", 0);
    check_refused("t.nrrd", ISO_ERR_IO, "not a number");
    write_parts("t.nrrd", BEGIN "encoding: ascii\n\n1 2 3 4 5 6 7", "", 0);
    check_refused("t.nrrd", ISO_ERR_IO, "truncated");
    write_parts("t.nrrd", BEGIN "encoding: hex\n\n01 0203\n04050607 0g", "", 0);
    check_refused("t.nrrd", ISO_ERR_IO, "not hexadecimal");
}

/* An array in several files, its parts named in all the ways that there are. */
static void parts_are_found(void **state) {
    (void)state;
    vol_write_text(vol_path(folder, "p-2.d", 0), "xx\1\2\3\4zz");
    vol_write_text(vol_path(folder, "p-4.d", 0), "xx\5\6\7\10zz");
    vol_write_text(vol_path(folder, "100%-02.d", 0), "xx\1\2\3\4zz");
    vol_write_text(vol_path(folder, "100%-04.d", 0), "xx\5\6\7\10zz");
    vol_write_text(vol_path(folder, "y 3.d", 0), "xx\1\2");
    vol_write_text(vol_path(folder, "y 2.d", 0), "xx\3\4");
    vol_write_text(vol_path(folder, "y 1.d", 0), "xx\5\6");
    vol_write_text(vol_path(folder, "y 0.d", 0), "xx\7\10");
    vol_write_text(vol_path(folder, "%s%n.d", 0), "\1\2\3\4\5\6\7\10");
    static const char *const good[] = {"byte skip: 2\ndata file: p-%d.d 2 4 2\n",
                                       "byte skip: 2\ndata file: p-%d.d 2 5 2 2\n",
                                       "byte skip: 2\ndata file: p-%d.d 2 4 2 3\n",
                                       "byte skip: 2\ndata file: 100%%-%02d.d 2 4 2\n",
                                       "byte skip: 2\ndata file: LIST\np-2.d\np-4.d\n",
                                       "byte skip: 2\ndata file: LIST 2\r\np-2.d\r\np-4.d",
                                       "byte skip: 2\ndata file: LIST 3\np-2.d\np-4.d\n\nnot a name\n",
                                       "byte skip: 2\ndata file: LIST 1\ny 3.d\ny 2.d\ny 1.d\ny 0.d\n",
                                       "byte skip: -3\ndata file: LIST\np-2.d\np-4.d\n",
                                       "data file: SKIPLIST\n2 p-2.d\n-3 p-4.d\n",
                                       "data file: %s%n.d\n"};
    for (size_t i = 0; i < sizeof good / sizeof *good; i++) {
        char text[512];
        snprintf(text, sizeof text, "%sencoding: raw\n%s", BEGIN, good[i]);
        vol_write_text(vol_path(folder, "p.nhdr", 0), text);
        check_counts("p.nhdr");
    }
    vol_write_text(vol_path(folder, "p.nhdr", 0),
                   BEGIN "encoding: raw\nbyte skip: 2\ndata file: y%2d.d 3 0 -1 1\n");
    check_counts("p.nhdr");
}

static const struct {
    const char *lines, *part;
    iso_status status;
} bad_parts[] = {
    {"data file: LIST\np-2.d\n", "names 1 data files for 2 parts", ISO_ERR_FORMAT},
    {"data file: LIST\np-2.d\np-4.d\np-4.d\np-4.d\n", "names at least 3 data files for 2 parts",
     ISO_ERR_FORMAT},
    {"data file: LIST 3\np-2.d\np-4.d\np-4.d\n", "names at least 3 data files for 2 slices", ISO_ERR_FORMAT},
    {"data file: LIST 4\np-2.d\n", "axes in a file", ISO_ERR_FORMAT},
    {"data file: LIST 0\np-2.d\n", "axes in a file", ISO_ERR_FORMAT},
    {"data file: LIST\n", "names 0 data files", ISO_ERR_FORMAT},
    {"data file: LIST\np-2.d\nmissing.d\n", "missing.d: cannot read: No such file", ISO_ERR_IO},
    {"data file: p-%d.d 1 2147483647 1\n", "names 2147483647 data files", ISO_ERR_FORMAT},
    {"data file: p-%d.d -2147483648 2147483647 1\n", "names 4294967296 data files", ISO_ERR_FORMAT},
    {"data file: p-%d.d 1 99999999999999999999 1\n", "not a first and a last number", ISO_ERR_FORMAT},
    {"data file: p-%d.d 2 4 0\n", "not a first and a last number", ISO_ERR_FORMAT},
    {"data file: p-%d.d 4 2 2\n", "not a first and a last number", ISO_ERR_FORMAT},
    {"data file: p-%d.d 2\n", "not a first and a last number", ISO_ERR_FORMAT},
    {"data file: p-%d.d 2 4 2 9\n", "axes in a file", ISO_ERR_FORMAT},
    {"data file: p-%100000d.d 2 4 2\n", "no pattern", ISO_ERR_FORMAT},
    {"data file: p-%300d.d 2 4 2\n", "no pattern", ISO_ERR_FORMAT},
    {"data file: p-%d%s%n.d 2 4 2\n", "no pattern", ISO_ERR_FORMAT},
    {"data file: p-%d-%d.d 2 4 2\n", "no pattern", ISO_ERR_FORMAT},
    {"data file: p-%100d.d 2 4 2\n", "No such file", ISO_ERR_IO},
    {"data file: SKIPLIST\np-2.d\np-4.d\n", "is not a number of bytes", ISO_ERR_FORMAT},
    {"data file: SKIPLIST\n99999999999999999999 p-2.d\n1 p-4.d\n", "is not a number of bytes",
     ISO_ERR_FORMAT},
    {"byte skip: 1\ndata file: SKIPLIST\n2 p-2.d\n2 p-4.d\n", "beside those of SKIPLIST", ISO_ERR_FORMAT},
    {"byte skip: 5\ndata file: LIST\np-2.d\np-4.d\n", "p-2.d: truncated: 8 of 9 bytes", ISO_ERR_IO},
    {"byte skip: 9223372036854775807\ndata file: p-2.d\n", "p-2.d: truncated", ISO_ERR_IO},
    {"byte skip: -9223372036854775808\ndata file: p-2.d\n", "p-2.d: truncated", ISO_ERR_IO},
    {"byte skip: -2\ndata file: p-2.d\n", "p-2.d: truncated: 8 of 9 bytes", ISO_ERR_IO},
    {"line skip: 4000000000\ndata file: p-2.d\n", "p-2.d: truncated: 1 of 4000000000 lines", ISO_ERR_IO},
    {"data file: \n", "there is no name", ISO_ERR_FORMAT},
};

static void wrong_parts_are_named(void **state) {
    (void)state;
    vol_write_text(vol_path(folder, "p-2.d", 0), "xx\1\2\3\4zz");
    vol_write_text(vol_path(folder, "p-4.d", 0), "xx\5\6\7\10zz");
    for (size_t i = 0; i < sizeof bad_parts / sizeof *bad_parts; i++) {
        char text[512];
        snprintf(text, sizeof text, "%sencoding: raw\n%s", BEGIN, bad_parts[i].lines);
        vol_write_text(vol_path(folder, "p.nhdr", 0), text);
        check_refused("p.nhdr", bad_parts[i].status, bad_parts[i].part);
    }
}

/* Lines between the sizes of an array of 2 x 2 x 2 bytes and its voxels. */
static const char *const good_lines[] = {
    "",
    "# a comment: with a colon\n#\n",
    "key:=value\nanother key:=a: value\na:=\n:=\n",
    "content: anything: goes := here\nnumber: 8\nmin: x\nmax: x\nold min: 0\noldmax: 1\nblock size: x\n",
    "labels: \"a\" \"b\" \"c\"\nsample units: mm\n",
    "ENDIAN: big\n",
    "kinds: domain ??? none\ncenterings: cell node none\n",
    "kinds: Space SPACE space   \nspacings: 1 2e0 0x1p0\t\naxismins: nan NaN -nan\naxis maxs: 4 4 4\n",
    "units: \"mm\" \"a \\\"quoted\\\" word\" \"\"\nspacings: 1 2 3\n",
    "space: Left Posterior-superior\nspacedirections: (1,0,0) ( 0 , 2,0)  (0,0,3)\nspace origin: (1, 2 ,3)\n",
    "space dimension: 3\nspace directions: (1,0,0) (0,2,0) (0,0,3)\nspace units: \"mm\" \"mm\" \"mm\"\n",
    "space: LPS\nmeasurement frame: (1,0,0) (0,1,0) (0,0,1)\nspace origin: none\nspacings: 1 1 1\n",
};

static void headers_are_understood(void **state) {
    (void)state;
    for (size_t i = 0; i < sizeof good_lines / sizeof *good_lines; i++)
        for (int windows = 0; windows < 2; windows++) {
            FILE *file = fopen(vol_path(folder, "h.nrrd", 0), "wb");
            char text[1024];
            snprintf(text, sizeof text, "%s%sencoding: raw\n\n", BEGIN, good_lines[i]);
            for (const char *c = text; *c; c++) {
                if (*c == '\n' && windows) fputc('\r', file);
                fputc(*c, file);
            }
            fputs("\1\2\3\4\5\6\7\10", file);
            fclose(file);
            check_counts("h.nrrd");
        }
}

static const struct {
    const char *lines, *part;
} bad_lines[] = {
    {"foo: bar\n", "line 5 of its header is no field of an NRRD file: 'foo'"},
    {"sizes\n", "no field of an NRRD file: 'sizes'"},
    {"content:\n", "no field of an NRRD file"},
    {"type: uchar\n", "'type': is there twice"},
    {"axismins: 1 2 3\naxis mins: 1 2 3\n", "'axis mins': is there twice"},
    {"encoding: rar\n", "'encoding': not raw"},
    {"endian: middle\n", "'endian': neither little nor big"},
    {"spacings: 1 2\n", "not a finite number for each axis"},
    {"spacings: 1 2 3 4\n", "more numbers than axes"},
    {"spacings: 1 2 3mm\n", "not a finite number"},
    {"spacings: 1 2 inf\n", "not a finite number"},
    {"spacings: 1 2 0\n", "a spacing is 0"},
    {"thicknesses: 1 2 -1\n", "a thickness is negative"},
    {"centers: cell cell\n", "not cell, node"},
    {"centers: cell cell cell cell\n", "more words than axes"},
    {"kinds: domain domain banana\n", "not a kind of axis"},
    {"kinds: domain domain\n", "fewer words than axes"},
    {"kinds: domain domain RGB-color\n", "axis 2 has 2 samples, its kind has 3"},
    {"units: \"mm\" \"mm\"\n", "not a word in quotes"},
    {"units: \"mm\" \"mm\" \"mm\n", "not a word in quotes"},
    {"units: \"mm\" \"mm\" \"mm\\\"\n", "not a word in quotes"},
    {"space: the final frontier\n", "not a space that the format knows"},
    {"space: LPS\nspace dimension: 3\n", "both a space and a space dimension"},
    {"space dimension: 9\n", "'space dimension'"},
    {"space origin: (0,0,0)\n", "comes before space"},
    {"space: LPS\nspace origin: (0,0)\n", "'space origin': not a vector"},
    {"space: LPS\nspace origin: (0,0,0,0)\n", "'space origin': not a vector"},
    {"space: LPS\nspace origin: (0,0,nan)\n", "'space origin': not a vector"},
    {"space: LPS\nspace directions: (1,0,0) (0,1,0) nonesuch\n", "'space directions': not a vector"},
    {"space: LPS\nspace directions: (1,0,0) (0,1,0) (0,0,inf)\n", "'space directions': not a vector"},
    {"space: LPS\nspace directions: (1,0,0) (0,1,0) (0,0,1) (1,1,1)\n", "more vectors than axes"},
    {"space: LPS\nspacings: 1 1 1\nspace directions: (1,0,0) (0,1,0) (0,0,1)\n", "also a spacing"},
    {"line skip: -1\n", "'line skip': not a number of lines"},
    {"byte skip: 9223372036854775808\n", "'byte skip': not a number of bytes"},
    {"byte skip: 1x\n", "'byte skip': not a number of bytes"},
};

/* From the first line on. */
static const struct {
    const char *text, *part;
} bad_headers[] = {
    {"NRRD0007\ntype: uchar\n", "not an NRRD file"},
    {"NRRD\n", "not an NRRD file"},
    {"NRRD0004", "its header does not end"},
    {"NRRD0004\ntype: uchar\ndimension: 1\nsizes: 1\nencoding: raw\n", "its header does not end"},
    {"NRRD0004\n\n", "no field 'type'"},
    {"NRRD0004\ntype: uchar\ndimension: 3\nsizes: 1 1 1\n\n", "no field 'encoding'"},
    {"NRRD0004\ntype: short\ndimension: 3\nsizes: 1 1 1\nencoding: raw\n\nab", "no field 'endian'"},
    {"NRRD0004\ntype: block\n\n", "holds blocks, not numbers"},
    {"NRRD0004\ntype: char\n\n", "'type': not a type of number"},
    {"NRRD0004\nsizes: 1 1 1\n\n", "'sizes': comes before dimension"},
    {"NRRD0004\ndata file: LIST\na\n", "'data file': comes before dimension"},
    {"NRRD0004\ndimension: 0\n\n", "'dimension': not a number from 1 to 16"},
    {"NRRD0004\ndimension: 17\n\n", "'dimension': not a number from 1 to 16"},
    {"NRRD0004\ndimension: 3\nsizes: 0 1 1\n\n", "an axis has 0 samples"},
    {"NRRD0004\ndimension: 3\nsizes: 1 1\n\n", "not a whole number for each axis"},
    {"NRRD0004\ndimension: 3\nsizes: 1 1 1 1\n\n", "more numbers than axes"},
    {"NRRD0004\ndimension: 3\nsizes: 1 1 -1\n\n", "not a whole number for each axis"},
    {"NRRD0004\ndimension: 3\nsizes: 1 1 18446744073709551616\n\n", "not a whole number for each axis"},
    {"NRRD0004\ntype: uchar\ndimension: 3\nsizes: 1 1 1\nencoding: hex\nbyte skip: -1\n\n00",
     "a byte skip of -1 is not possible in this encoding"},
};

static void wrong_headers_are_refused(void **state) {
    (void)state;
    for (size_t i = 0; i < sizeof bad_lines / sizeof *bad_lines; i++) {
        char text[1024];
        snprintf(text, sizeof text, "%s%sencoding: raw\n\n12345678", BEGIN, bad_lines[i].lines);
        vol_write_text(vol_path(folder, "h.nrrd", 0), text);
        check_refused("h.nrrd", ISO_ERR_FORMAT, bad_lines[i].part);
    }
    for (size_t i = 0; i < sizeof bad_headers / sizeof *bad_headers; i++) {
        vol_write_text(vol_path(folder, "h.nrrd", 0), bad_headers[i].text);
        bool cut = strstr(bad_headers[i].part, "does not end") != NULL;
        check_refused("h.nrrd", cut ? ISO_ERR_IO : ISO_ERR_FORMAT, bad_headers[i].part);
    }
}

/* A header of `length` bytes, most of which are comments of `line` bytes. */
static void write_long_header(size_t length, size_t line) {
    FILE *file = fopen(vol_path(folder, "l.nrrd", 0), "wb");
    fputs(BEGIN "encoding: raw\n", file);
    for (size_t left = length - 1 - (size_t)ftell(file); left;) {
        size_t count = left < line ? left : line;
        if (left - count == 1) count++; /* the shortest comment has two bytes */
        fprintf(file, "#%*s\n", (int)count - 2, "");
        left -= count;
    }
    fputs("\n\1\2\3\4\5\6\7\10", file);
    fclose(file);
}

static void long_headers_have_a_limit(void **state) {
    (void)state;
    for (size_t line = 2; line < ISO_NRRD_HEADER_BYTES; line = line * 37 + 1) {
        write_long_header(ISO_NRRD_HEADER_BYTES - line % 3, line);
        check_counts("l.nrrd");
        write_long_header(ISO_NRRD_HEADER_BYTES + 1 + line % 3, line);
        check_refused("l.nrrd", ISO_ERR_FORMAT, "its header is longer than 262144 bytes");
    }
    write_long_header(100 * ISO_NRRD_HEADER_BYTES, 1000);
    check_refused("l.nrrd", ISO_ERR_FORMAT, "its header is longer than 262144 bytes");
}

/* The names of a list do not count. */
static void lists_may_be_long(void **state) {
    (void)state;
    enum { SLICES = 6000 };
    vol_write_text(vol_path(folder, "slice.d", 0), "\7\10");
    FILE *file = fopen(vol_path(folder, "many.nhdr", 0), "wb");
    fprintf(file, "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 2 1 %d\nencoding: raw\ndata file: LIST\n",
            SLICES);
    for (int i = 0; i < SLICES; i++) fputs("././././././././././././././././././././././slice.d\n", file);
    assert_true(ftell(file) > ISO_NRRD_HEADER_BYTES);
    fclose(file);
    iso_volume volume;
    iso_error error = {0};
    if (iso_volume_read(vol_path(folder, "many.nhdr", 0), NULL, &volume, &error) != ISO_OK)
        fail_msg("%s", error.text);
    assert_true(iso_rgrid_at(volume.grid.rgrid, 1, 0, SLICES - 1) == 8);
    iso_volume_free(&volume);
    file = fopen(vol_path(folder, "many.nhdr", 0), "wb");
    fputs(BEGIN "encoding: raw\ndata file: LIST\n", file);
    for (int i = 0; i < 1 << 20; i++) fputc('x', file);
    fclose(file);
    check_refused("many.nhdr", ISO_ERR_FORMAT, "the name of a data file has 1048576 characters");
}

/* A name that is too long does not drive the reason out of the message. */
static void long_names_keep_the_reason(void **state) {
    (void)state;
    FILE *file = fopen(vol_path(folder, "n.nhdr", 0), "wb");
    fputs(BEGIN "encoding: raw\ndata file: ", file);
    for (int i = 0; i < 1000; i++) fputc('x', file);
    fputs(".raw\n", file);
    fclose(file);
    check_refused("n.nhdr", ISO_ERR_IO, "xxx.raw: cannot read: File name too long");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(bzip2_streams_follow_each_other),
        cmocka_unit_test(run_lengths_of_zeros),
        cmocka_unit_test(text_may_have_commas),
        cmocka_unit_test(parts_are_found),
        cmocka_unit_test(wrong_parts_are_named),
        cmocka_unit_test(headers_are_understood),
        cmocka_unit_test(wrong_headers_are_refused),
        cmocka_unit_test(long_headers_have_a_limit),
        cmocka_unit_test(lists_may_be_long),
        cmocka_unit_test(long_names_keep_the_reason),
    };
    mkdir(folder, 0777);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
