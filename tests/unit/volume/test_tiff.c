/* TIFF: every layout gives the same voxels, folders are in natural order, and metadata give distances and
 * channels. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include <cmocka.h>
#include <tiffio.h>

#include "file_support.h"
#include "grids/volume/volume.h"
#include "make_volumes.h"
#include "volume_support.h"

static const char folder[] = ISO_TEST_TMP "/tiff";

enum { WIDTH = 37, HEIGHT = 21, SLICES = 3, SAMPLES = 3, TILE = 16, ROWS = 4 };

/* How a file is written. */
typedef struct layout {
    const char *mode; /* of TIFFOpen: l or b: byte order, 8: BigTIFF */
    int format, bits, compression, samples;
    bool tiled, separate;
    const char *description;
    int pages, first; /* 0: SLICES; number of the first page's slice */
    int width;        /* 0: WIDTH */
    int resolution_unit;
    float resolution;
} layout;

static int value_at(int x, int y, int slice, int sample) {
    return (7 * x + 3 * y + 11 * slice + 29 * sample) % 120;
}

static int width_of(const layout *l) {
    return l->width ? l->width : WIDTH;
}

static void store(const layout *l, int value, void *target) {
    const size_t bytes = (size_t)l->bits / 8;
    const float real = (float)value + 0.5f;
    const double precise = value + 0.25;
    const int64_t integer = l->format == SAMPLEFORMAT_INT ? value - 60 : value;
    if (l->format == SAMPLEFORMAT_IEEEFP)
        memcpy(target, bytes == 4 ? (const void *)&real : (const void *)&precise, bytes);
    else
        memcpy(target, &integer, bytes); /* the test runs on little-endian machines, as all of ours do */
}

static float expected(const layout *l, int x, int y, int slice, int sample) {
    const int value = value_at(x, y, slice, sample);
    if (l->format == SAMPLEFORMAT_IEEEFP) return (float)value + (l->bits == 32 ? 0.5f : 0.25f);
    return (float)(l->format == SAMPLEFORMAT_INT ? value - 60 : value);
}

/* Fills a strip or tile: columns from x, rows from y; `sample` < 0: all samples of each pixel. */
static void fill_block(const layout *l, const int box[4], int slice, int sample, unsigned char *block) {
    const size_t bytes = (size_t)l->bits / 8;
    for (int y = box[1]; y < box[1] + box[3]; y++)
        for (int x = box[0]; x < box[0] + box[2]; x++)
            for (int s = sample < 0 ? 0 : sample; s < (sample < 0 ? l->samples : sample + 1);
                 s++, block += bytes)
                store(l, value_at(x, y, slice, s), block);
}

static void write_blocks(TIFF *tiff, const layout *l, int slice, int sample) {
    unsigned char block[WIDTH * TILE * SAMPLES * 8];
    const int width = width_of(l), step[2] = {l->tiled ? TILE : width, l->tiled ? TILE : ROWS};
    for (int y = 0; y < HEIGHT; y += step[1])
        for (int x = 0; x < width; x += step[0]) {
            const int rows = l->tiled || HEIGHT - y > ROWS ? step[1] : HEIGHT - y;
            const int box[4] = {x, y, step[0], rows};
            const uint16_t plane = (uint16_t)(sample < 0 ? 0 : sample);
            fill_block(l, box, slice, sample, block);
            const tmsize_t bytes = (tmsize_t)(step[0] * rows * (sample < 0 ? l->samples : 1) * l->bits / 8);
            if (l->tiled)
                TIFFWriteEncodedTile(tiff, TIFFComputeTile(tiff, (uint32_t)x, (uint32_t)y, 0, plane), block,
                                     bytes);
            else
                TIFFWriteEncodedStrip(tiff, TIFFComputeStrip(tiff, (uint32_t)y, plane), block, bytes);
        }
}

static void write_page(TIFF *tiff, const layout *l, int slice) {
    TIFFSetField(tiff, TIFFTAG_IMAGEWIDTH, width_of(l));
    TIFFSetField(tiff, TIFFTAG_IMAGELENGTH, HEIGHT);
    TIFFSetField(tiff, TIFFTAG_BITSPERSAMPLE, l->bits);
    TIFFSetField(tiff, TIFFTAG_SAMPLEFORMAT, l->format);
    TIFFSetField(tiff, TIFFTAG_SAMPLESPERPIXEL, l->samples);
    TIFFSetField(tiff, TIFFTAG_COMPRESSION, l->compression);
    TIFFSetField(tiff, TIFFTAG_PHOTOMETRIC, l->samples == 3 ? PHOTOMETRIC_RGB : PHOTOMETRIC_MINISBLACK);
    TIFFSetField(tiff, TIFFTAG_PLANARCONFIG, l->separate ? PLANARCONFIG_SEPARATE : PLANARCONFIG_CONTIG);
    if (l->tiled) {
        TIFFSetField(tiff, TIFFTAG_TILEWIDTH, TILE);
        TIFFSetField(tiff, TIFFTAG_TILELENGTH, TILE);
    } else {
        TIFFSetField(tiff, TIFFTAG_ROWSPERSTRIP, ROWS);
    }
    if (l->description) TIFFSetField(tiff, TIFFTAG_IMAGEDESCRIPTION, l->description);
    if (l->resolution_unit) {
        TIFFSetField(tiff, TIFFTAG_RESOLUTIONUNIT, l->resolution_unit);
        TIFFSetField(tiff, TIFFTAG_XRESOLUTION, l->resolution);
        TIFFSetField(tiff, TIFFTAG_YRESOLUTION, l->resolution);
    }
    for (int sample = 0; l->separate && sample < l->samples; sample++) write_blocks(tiff, l, slice, sample);
    if (!l->separate) write_blocks(tiff, l, slice, -1);
    assert_true(TIFFWriteDirectory(tiff));
}

static const char *write_file(const char *name, const layout *l) {
    const char *path = vol_path(folder, name, 0);
    TIFF *tiff = TIFFOpen(path, l->mode);
    assert_non_null(tiff);
    for (int page = 0; page < (l->pages ? l->pages : SLICES); page++) write_page(tiff, l, l->first + page);
    TIFFClose(tiff);
    return path;
}

static layout plain(void) {
    return (layout){
        .mode = "w", .format = SAMPLEFORMAT_UINT, .bits = 8, .compression = COMPRESSION_NONE, .samples = 1};
}

static void check_voxels(const iso_volume *volume, const layout *l, int sample) {
    const int *dims = iso_grid_dims(&volume->grid);
    assert_int_equal(dims[0], width_of(l));
    assert_int_equal(dims[1], HEIGHT);
    for (int z = 0; z < dims[2]; z++)
        for (int y = 0; y < dims[1]; y++)
            for (int x = 0; x < dims[0]; x++)
                if (iso_grid_at(&volume->grid, x, y, z) != expected(l, x, y, l->first + z, sample))
                    fail_msg("voxel %d %d %d: %g, expected %g", x, y, z,
                             (double)iso_grid_at(&volume->grid, x, y, z),
                             (double)expected(l, x, y, l->first + z, sample));
}

static void read_and_check(const char *path, const layout *l) {
    for (int sample = 0; sample < l->samples; sample++) {
        const iso_volume_opts opts = {.component = sample};
        iso_volume volume = test_read_volume(path, &opts);
        assert_int_equal(volume.info.dims[2], l->pages ? l->pages : SLICES);
        check_voxels(&volume, l, sample);
        iso_volume_free(&volume);
    }
}

/* ---- layouts ---- */

static void test_every_layout(void **state) {
    static const int kinds[][2] = {
        {SAMPLEFORMAT_UINT, 8},  {SAMPLEFORMAT_INT, 8},     {SAMPLEFORMAT_UINT, 16},
        {SAMPLEFORMAT_INT, 16},  {SAMPLEFORMAT_UINT, 32},   {SAMPLEFORMAT_INT, 32},
        {SAMPLEFORMAT_UINT, 64}, {SAMPLEFORMAT_IEEEFP, 32}, {SAMPLEFORMAT_IEEEFP, 64}};
    static const char *const modes[] = {"wl", "wb", "wl8", "wb8"};
    static const int compressions[] = {COMPRESSION_NONE, COMPRESSION_LZW, COMPRESSION_ADOBE_DEFLATE,
                                       COMPRESSION_PACKBITS};
    (void)state;
    for (size_t kind = 0; kind < sizeof kinds / sizeof *kinds; kind++)
        for (int mode = 0; mode < 4; mode++)
            for (int storage = 0; storage < 8; storage++) {
                layout l = {.mode = modes[mode],
                            .format = kinds[kind][0],
                            .bits = kinds[kind][1],
                            .compression = compressions[(kind + (size_t)mode + (size_t)storage) % 4],
                            .samples = storage & 2 ? SAMPLES : 1,
                            .tiled = storage & 1,
                            .separate = (storage & 6) == 6};
                read_and_check(write_file("layout.tif", &l), &l);
            }
}

static void test_reduced_images_are_left_out(void **state) {
    layout l = plain();
    const char *path = vol_path(folder, "pyramid.tif", 0);
    TIFF *tiff = TIFFOpen(path, "w");
    (void)state;
    for (int page = 0; page < 2 * SLICES; page++) {
        layout small = l;
        small.width = 18;
        if (page % 2) TIFFSetField(tiff, TIFFTAG_SUBFILETYPE, FILETYPE_REDUCEDIMAGE);
        write_page(tiff, page % 2 ? &small : &l, page / 2);
    }
    TIFFClose(tiff);
    read_and_check(path, &l);
    iso_volume volume = test_read_volume(path, NULL);
    assert_true(test_has_note(&volume.info, "3 reduced images"));
    iso_volume_free(&volume);
}

/* ---- folders ---- */

static const char *make_folder(const char *name, const layout *l, int count) {
    char file[64];
    const char *path = vol_path(folder, name, 0);
    char *copy = strdup(path);
    mkdir(path, 0777);
    for (int i = 0; i < count; i++) {
        layout slice = *l;
        slice.pages = 1;
        slice.first = i;
        snprintf(file, sizeof file, "%s/slice_%d.TIF", name, i);
        write_file(file, &slice);
    }
    return copy;
}

static void test_folder_in_natural_order(void **state) {
    layout l = plain();
    (void)state;
    char *path = (char *)make_folder("natural", &l, 12);
    vol_write_text(vol_path(folder, "natural/readme.txt", 0), "no slice");
    vol_write_text(vol_path(folder, "natural/._slice_1.TIF", 0), "no slice"); /* as macOS writes them */
    l.pages = 12;
    read_and_check(path, &l);
    free(path);
}

static void test_unequal_slices_are_named(void **state) {
    layout l = plain();
    (void)state;
    char *path = (char *)make_folder("unequal", &l, 3);
    l.width = 20;
    l.pages = 1;
    write_file("unequal/slice_1.TIF", &l);
    test_expect_no_volume(path, NULL, ISO_ERR_FORMAT, "slice_1.TIF", "20 x 21 uint8");
    test_expect_no_volume(path, NULL, ISO_ERR_FORMAT, "slice_0.TIF", "37 x 21 uint8");
    free(path);
}

/* ---- metadata ---- */

static void expect_spacing(const layout *l, double x, double y, double z) {
    iso_volume volume = test_read_volume(write_file("spacing.tif", l), NULL);
    const double *spacing = volume.info.transform.spacing, wanted[3] = {x, y, z};
    for (int i = 0; i < 3; i++)
        if (!(spacing[i] > wanted[i] * (1 - 1e-6) && spacing[i] < wanted[i] * (1 + 1e-6)))
            fail_msg("%s: spacing %d is %.9g, expected %.9g", l->description ? l->description : "tags", i,
                     spacing[i], wanted[i]);
    iso_volume_free(&volume);
}

static void test_spacing(void **state) {
    layout l = plain();
    (void)state;
    expect_spacing(&l, 1, 1, 1);
    l.resolution_unit = RESUNIT_INCH;
    l.resolution = 100;
    expect_spacing(&l, 0.254, 0.254, 0.254);
    l.resolution_unit = RESUNIT_CENTIMETER;
    expect_spacing(&l, 0.1, 0.1, 0.1);
    l.description = "ImageJ=1.53t\nimages=3\nslices=3\nunit=micron\nspacing=5.0\n";
    l.resolution = 4;
    expect_spacing(&l, 0.25e-3, 0.25e-3, 5e-3);
    l.description =
        "<?xml version='1.0'?><OME><Image><Pixels ID='P' SizeX='37' SizeZ='3' SizeC='1' SizeT='1' "
        "DimensionOrder='XYZCT' PhysicalSizeX='0.5' PhysicalSizeY='0.25' PhysicalSizeZ='2' "
        "PhysicalSizeZUnit='mm'/></Image></OME>";
    expect_spacing(&l, 0.5e-3, 0.25e-3, 2);
    static const char *const none[] = {"nan", "inf", "-5", "0", "five"};
    for (int i = 0; i < 5; i++) { /* no length */
        char text[128];
        snprintf(text, sizeof text, "ImageJ=1.53t\nimages=3\nslices=3\nunit=micron\nspacing=%s\n", none[i]);
        l.description = text;
        expect_spacing(&l, 0.25e-3, 0.25e-3, 0.25e-3);
    }
}

/* Six images: two channels of three slices, in the order of each writer; images have the slice's number. */
static void expect_channels(const char *description, int channel_step, int slice_step) {
    layout l = plain();
    l.pages = 6;
    l.description = description;
    const char *path = write_file("channels.tif", &l);
    for (int channel = 0; channel < 2; channel++) {
        const iso_volume_opts opts = {.component = channel};
        iso_volume volume = test_read_volume(path, &opts);
        assert_int_equal(volume.info.dims[2], 3);
        assert_int_equal(volume.info.components, 2);
        for (int z = 0; z < 3; z++)
            assert_true(iso_grid_at(&volume.grid, 5, 6, z) ==
                        (float)value_at(5, 6, channel * channel_step + z * slice_step, 0));
        iso_volume_free(&volume);
    }
}

static void test_channels(void **state) {
    (void)state;
    expect_channels("ImageJ=1.53t\nimages=6\nchannels=2\nslices=3\n", 1, 2);
    expect_channels("<OME><Pixels DimensionOrder=\"XYCZT\" SizeC=\"2\" SizeZ=\"3\" SizeT=\"1\"/></OME>", 1,
                    2);
    expect_channels("<OME><Pixels DimensionOrder=\"XYZCT\" SizeC=\"2\" SizeZ=\"3\" SizeT=\"1\"/></OME>", 3,
                    1);
    /* orders that name an axis twice, or others: that of ImageJ */
    expect_channels("<OME><Pixels DimensionOrder=\"XYZZC\" SizeC=\"2\" SizeZ=\"3\" SizeT=\"1\"/></OME>", 1,
                    2);
    expect_channels("<OME><Pixels DimensionOrder=\"XYZQC\" SizeC=\"2\" SizeZ=\"3\" SizeT=\"1\"/></OME>", 1,
                    2);
}

/* The samples of a pixel are channels to OME: three images of three samples are three slices. */
static void test_samples_are_channels(void **state) {
    layout l = plain();
    (void)state;
    l.samples = SAMPLES;
    l.description = "<OME><Pixels DimensionOrder=\"XYCZT\" SizeC=\"3\" SizeZ=\"3\" SizeT=\"1\"/></OME>";
    const char *path = write_file("samples.tif", &l);
    read_and_check(path, &l);
    iso_volume volume = test_read_volume(path, NULL);
    assert_int_equal(volume.info.components, SAMPLES);
    iso_volume_free(&volume);
    l.pages = 6;
    l.description = "<OME><Pixels DimensionOrder=\"XYCZT\" SizeC=\"3\" SizeZ=\"3\" SizeT=\"2\"/></OME>";
    volume = test_read_volume(write_file("samples.tif", &l), NULL);
    assert_int_equal(volume.info.dims[2], 3);
    iso_volume_free(&volume);
}

/* A series of planes is a volume; of a series of volumes the first one is read, and that is said. */
static void test_times(void **state) {
    layout l = plain();
    (void)state;
    l.description = "ImageJ=1.53t\nimages=3\nframes=3\n";
    read_and_check(write_file("planes.tif", &l), &l);
    l.pages = 6;
    l.description = "ImageJ=1.53t\nimages=6\nslices=3\nframes=2\n";
    iso_volume volume = test_read_volume(write_file("times.tif", &l), NULL);
    assert_int_equal(volume.info.dims[2], 3);
    assert_true(test_has_note(&volume.info, "the first of 2 times"));
    check_voxels(&volume, &l, 0);
    iso_volume_free(&volume);
}

/* Metadata that do not fit the images: each image is a slice, and it is said. */
static void test_metadata_that_lie(void **state) {
    layout l = plain();
    l.description = "ImageJ=1.53t\nimages=3\nslices=2\n";
    (void)state;
    iso_volume volume = test_read_volume(write_file("lie.tif", &l), NULL);
    assert_int_equal(volume.info.dims[2], SLICES);
    assert_true(test_has_note(&volume.info, "state 2 slices"));
    iso_volume_free(&volume);
}

/* ---- images without headers ---- */

/* Bytes of a file in one of the byte orders. */
typedef struct byte_list {
    unsigned char data[8192];
    size_t count;
    bool big;
} byte_list;

static void put(byte_list *b, uint32_t value, int size) {
    for (int i = 0; i < size; i++)
        b->data[b->count++] = (unsigned char)(value >> 8 * (b->big ? size - 1 - i : i));
}

static void put_entry(byte_list *b, uint32_t tag, uint32_t type, uint32_t count, uint32_t value) {
    const int size = type == TIFF_SHORT ? 2 : 4;
    put(b, tag, 2);
    put(b, type, 2);
    put(b, count, 4);
    put(b, value, size);
    put(b, 0, 4 - size);
}

/* ImageJ's way beyond 4 GB: one header, and the values of all images behind it, one after another. */
static void put_imagej(byte_list *b, const layout *l) {
    static const char text[] = "ImageJ=1.53t\nimages=3\nslices=3\n";
    enum { ENTRIES = 10, TEXT_AT = 8 + 2 + 12 * ENTRIES + 4 };
    const uint32_t values_at = TEXT_AT + sizeof text;
    b->data[0] = b->data[1] = b->big ? 'M' : 'I';
    b->count = 2;
    put(b, 42, 2);
    put(b, 8, 4);
    put(b, ENTRIES, 2);
    put_entry(b, TIFFTAG_IMAGEWIDTH, TIFF_SHORT, 1, WIDTH);
    put_entry(b, TIFFTAG_IMAGELENGTH, TIFF_SHORT, 1, HEIGHT);
    put_entry(b, TIFFTAG_BITSPERSAMPLE, TIFF_SHORT, 1, 16);
    put_entry(b, TIFFTAG_COMPRESSION, TIFF_SHORT, 1, COMPRESSION_NONE);
    put_entry(b, TIFFTAG_PHOTOMETRIC, TIFF_SHORT, 1, PHOTOMETRIC_MINISBLACK);
    put_entry(b, TIFFTAG_IMAGEDESCRIPTION, TIFF_ASCII, sizeof text, TEXT_AT);
    put_entry(b, TIFFTAG_STRIPOFFSETS, TIFF_LONG, 1, values_at);
    put_entry(b, TIFFTAG_SAMPLESPERPIXEL, TIFF_SHORT, 1, 1);
    put_entry(b, TIFFTAG_ROWSPERSTRIP, TIFF_SHORT, 1, HEIGHT);
    put_entry(b, TIFFTAG_STRIPBYTECOUNTS, TIFF_LONG, 1, WIDTH * HEIGHT * 2);
    put(b, 0, 4);
    memcpy(b->data + b->count, text, sizeof text);
    b->count += sizeof text;
    for (int z = 0; z < SLICES; z++)
        for (int y = 0; y < HEIGHT; y++)
            for (int x = 0; x < WIDTH; x++) put(b, (uint32_t)expected(l, x, y, z, 0), 2);
}

static void test_images_without_headers(void **state) {
    (void)state;
    for (int big = 0; big < 2; big++) {
        layout l = plain();
        byte_list b = {.big = big};
        const char *path = vol_path(folder, "contiguous.tif", 0);
        put_imagej(&b, &l);
        spill(path, b.data, b.count);
        read_and_check(path, &l);
        spill(path, b.data, b.count - 1);
        test_expect_no_volume(path, NULL, ISO_ERR_IO, NULL, "truncated");
        /* one image, without metadata: its only strip is too short */
        memcpy(memmem(b.data, b.count, "ImageJ", 6), "Others", 6);
        const size_t rest = (SLICES - 1) * WIDTH * HEIGHT * 2;
        spill(path, b.data, b.count - rest);
        l.pages = 1;
        l.bits = 16;
        read_and_check(path, &l);
        spill(path, b.data, b.count - rest - 1);
        test_expect_no_volume(path, NULL, ISO_ERR_IO, "contiguous.tif", "image 1");
    }
}

/* ---- bad files ---- */

static void test_truncated(void **state) {
    layout l = plain();
    const char *path = write_file("whole.tif", &l);
    size_t count;
    char *bytes = slurp(path, &count);
    const char *cut = vol_path(folder, "cut.tif", 0);
    (void)state;
    for (size_t length = 8; length < count; length += 97) {
        spill(cut, bytes, length);
        iso_error error = {0};
        iso_volume volume = {0};
        const iso_status status = iso_volume_read(cut, NULL, &volume, &error);
        if (status == ISO_OK) {
            assert_int_equal(volume.info.dims[2], SLICES);
            check_voxels(&volume, &l, 0);
            iso_volume_free(&volume);
        } else if (status != ISO_ERR_IO || !strstr(error.text, "cut.tif") || strchr(error.text, '\n')) {
            fail_msg("%zu bytes: status %d: %s", length, status, error.text);
        }
    }
    free(bytes);
}

static void test_damaged(void **state) {
    layout l = plain();
    (void)state;
    l.compression = COMPRESSION_LZW;
    test_read_damaged(write_file("damaged.tif", &l), 4, 2000, "damaged.tif");
}

static void test_refused(void **state) {
    layout l = plain();
    (void)state;
    const char *path = write_file("limit.tif", &l);
    const iso_volume_opts small = {.max_memory = 1000};
    test_expect_no_volume(path, &small, ISO_ERR_LIMIT, NULL, "--max-memory");
    const iso_volume_opts seventh = {.component = 6};
    test_expect_no_volume(path, &seventh, ISO_ERR_USAGE, NULL, "component");
    vol_write_text(vol_path(folder, "text.tif", 0), "no TIFF at all");
    test_expect_no_volume(vol_path(folder, "text.tif", 0), NULL, ISO_ERR_IO, NULL, "not a TIFF file");
}

/* Writes an image of a row of eight pixels. */
static const char *write_row(const char *name, int bits, int samples, int photometric) {
    char row[32] = {0};
    TIFF *tiff = TIFFOpen(vol_path(folder, name, 0), "w");
    TIFFSetField(tiff, TIFFTAG_IMAGEWIDTH, 8);
    TIFFSetField(tiff, TIFFTAG_IMAGELENGTH, 1);
    TIFFSetField(tiff, TIFFTAG_BITSPERSAMPLE, bits);
    TIFFSetField(tiff, TIFFTAG_SAMPLESPERPIXEL, samples);
    TIFFSetField(tiff, TIFFTAG_PLANARCONFIG, PLANARCONFIG_CONTIG);
    TIFFSetField(tiff, TIFFTAG_PHOTOMETRIC, photometric);
    TIFFWriteEncodedStrip(tiff, 0, row, (tmsize_t)(bits * samples));
    TIFFClose(tiff);
    return vol_path(folder, name, 0);
}

static void test_no_voxels(void **state) {
    (void)state;
    static const int bits[] = {1, 4, 12};
    for (int i = 0; i < 3; i++) {
        char text[32];
        snprintf(text, sizeof text, "bits a sample (%d)", bits[i]);
        test_expect_no_volume(write_row("bits.tif", bits[i], 1, PHOTOMETRIC_MINISBLACK), NULL, ISO_ERR_FORMAT,
                              NULL, text);
    }
    test_expect_no_volume(write_row("video.tif", 8, 3, PHOTOMETRIC_YCBCR), NULL, ISO_ERR_FORMAT, NULL,
                          "colours of video");
}

static int make_place(void **state) {
    (void)state;
    mkdir(folder, 0777);
    return 0;
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_every_layout),
                                       cmocka_unit_test(test_reduced_images_are_left_out),
                                       cmocka_unit_test(test_folder_in_natural_order),
                                       cmocka_unit_test(test_unequal_slices_are_named),
                                       cmocka_unit_test(test_spacing),
                                       cmocka_unit_test(test_channels),
                                       cmocka_unit_test(test_samples_are_channels),
                                       cmocka_unit_test(test_times),
                                       cmocka_unit_test(test_metadata_that_lie),
                                       cmocka_unit_test(test_images_without_headers),
                                       cmocka_unit_test(test_truncated),
                                       cmocka_unit_test(test_damaged),
                                       cmocka_unit_test(test_refused),
                                       cmocka_unit_test(test_no_voxels)};
    return cmocka_run_group_tests(tests, make_place, NULL);
}
