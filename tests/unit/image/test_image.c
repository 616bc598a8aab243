#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmocka.h>
#include <png.h>

#include "base/memory.h"
#include "check_support.h"
#include "file_support.h"
#include "image/image.h"
#include "image/image_file.h"

static const char *const PATH = ISO_TEST_TMP "/image.png";

static iso_image random_image(int width, int height, int opaque) {
    iso_image image;
    uint32_t seed = (uint32_t)(width * 31 + height);
    assert_int_equal(iso_image_create(width, height, &image, NULL), ISO_OK);
    for (size_t i = 0; i < (size_t)width * (size_t)height * 4; i++)
        image.rgba[i] = opaque && i % 4 == 3 ? 255 : (uint8_t)random_bits(&seed);
    return image;
}

static void what_is_written_is_read(void **state) {
    (void)state;
    const int sizes[][2] = {{1, 1}, {16384, 1}, {1, 16384}, {37, 23}, {256, 3}};
    for (size_t k = 0; k < 2 * sizeof sizes / sizeof sizes[0]; k++) {
        int opaque = k % 2 == 0;
        iso_image image = random_image(sizes[k / 2][0], sizes[k / 2][1], opaque), back = {0};
        if (!opaque) image.rgba[3] = 254;
        assert_int_equal(iso_png_write(PATH, &image, NULL, 0, NULL), ISO_OK);
        assert_int_equal(iso_png_read(PATH, &back, NULL), ISO_OK);
        assert_int_equal(back.width, image.width);
        assert_int_equal(back.height, image.height);
        assert_memory_equal(back.rgba, image.rgba, (size_t)image.width * (size_t)image.height * 4);
        size_t size;
        uint8_t *bytes = slurp(PATH, &size);
        assert_int_equal(bytes[25], opaque ? PNG_COLOR_TYPE_RGB : PNG_COLOR_TYPE_RGBA);
        free(bytes);
        iso_image_free(&image);
        iso_image_free(&back);
    }
}

static void one_transparent_pixel_is_found(void **state) {
    (void)state;
    for (int width = 1; width < 4; width++) {
        iso_image image = random_image(width, 3, 1);
        assert_true(iso_image_is_opaque(&image));
        for (size_t i = 3; i < (size_t)width * 12; i += 4) {
            image.rgba[i] = 127;
            assert_false(iso_image_is_opaque(&image));
            image.rgba[i] = 255;
        }
        iso_image_free(&image);
    }
}

/* Several rounds of bands, for one thread and for three: the same file, and the picture comes back. */
static void threads_write_the_same_file(void **state) {
    (void)state;
    const int sizes[][2] = {{1, 1}, {300, 9000}, {16384, 40}};
    for (size_t k = 0; k < 6; k++) {
        iso_image image = random_image(sizes[k / 2][0], sizes[k / 2][1], k % 2), back = {0};
        uint8_t *bytes[2];
        size_t size[2];
        for (int many = 0; many < 2; many++) {
            iso_pool *pool = NULL;
            assert_int_equal(iso_pool_create(many ? 3 : 1, &pool, NULL), ISO_OK);
            assert_int_equal(iso_png_write_with(PATH, &image, &(iso_png_opts){.pool = pool}, NULL), ISO_OK);
            iso_pool_destroy(pool);
            bytes[many] = slurp(PATH, &size[many]);
        }
        assert_int_equal(size[0], size[1]);
        assert_memory_equal(bytes[0], bytes[1], size[0]);
        assert_int_equal(iso_png_read(PATH, &back, NULL), ISO_OK);
        assert_memory_equal(back.rgba, image.rgba, (size_t)image.width * (size_t)image.height * 4);
        free(bytes[0]);
        free(bytes[1]);
        iso_image_free(&image);
        iso_image_free(&back);
    }
}

/* A ramp of so many colours over rows, each shifted by its number. */
static iso_image ramp_image(int colours, uint8_t alpha) {
    iso_image image;
    assert_int_equal(iso_image_create(300, 500, &image, NULL), ISO_OK);
    for (int i = 0; i < 300 * 500; i++) {
        int colour = (i % 300 + i / 300) % colours;
        memcpy(image.rgba + 4 * i, (uint8_t[]){(uint8_t)colour, (uint8_t)(colour >> 8), 7, alpha}, 4);
    }
    return image;
}

/* Few colours are indexed, and nothing is lost either way, with one thread and with three. */
static void small_files_hold_the_same_picture(void **state) {
    (void)state;
    const struct {
        int colours;
        uint8_t alpha, type;
    } cases[] = {{1, 255, PNG_COLOR_TYPE_PALETTE},
                 {255, 255, PNG_COLOR_TYPE_PALETTE},
                 {256, 255, PNG_COLOR_TYPE_PALETTE},
                 {257, 255, PNG_COLOR_TYPE_RGB},
                 {2, 254, PNG_COLOR_TYPE_RGBA}};
    for (size_t k = 0; k < sizeof cases / sizeof cases[0]; k++) {
        iso_image image = ramp_image(cases[k].colours, cases[k].alpha), back = {0};
        uint8_t *bytes[2], *plain;
        size_t size[2], plain_size;
        for (int many = 0; many < 2; many++) {
            iso_pool *pool = NULL;
            assert_int_equal(iso_pool_create(many ? 3 : 1, &pool, NULL), ISO_OK);
            iso_png_opts opts = {.small = true, .pool = pool};
            assert_int_equal(iso_png_encode(&image, &opts, &bytes[many], &size[many], NULL), ISO_OK);
            iso_pool_destroy(pool);
        }
        assert_int_equal(size[0], size[1]);
        assert_memory_equal(bytes[0], bytes[1], size[0]);
        assert_int_equal(bytes[0][25], cases[k].type);
        assert_int_equal(iso_png_encode(&image, &(iso_png_opts){0}, &plain, &plain_size, NULL), ISO_OK);
        assert_true(size[0] < plain_size);
        spill(PATH, bytes[0], size[0]);
        assert_int_equal(iso_png_read(PATH, &back, NULL), ISO_OK);
        assert_memory_equal(back.rgba, image.rgba, 300 * 500 * 4);
        free(bytes[0]);
        free(bytes[1]);
        free(plain);
        iso_image_free(&image);
        iso_image_free(&back);
    }
}

static void sides_are_checked(void **state) {
    (void)state;
    const int sizes[][2] = {{0, 5}, {5, 0}, {-1, 5}, {ISO_IMAGE_MAX + 1, 1}, {1, ISO_IMAGE_MAX + 1}};
    for (size_t k = 0; k < sizeof sizes / sizeof sizes[0]; k++) {
        iso_image image = {0};
        iso_error error = {0};
        assert_int_equal(iso_image_create(sizes[k][0], sizes[k][1], &image, &error), ISO_ERR_USAGE);
        assert_non_null(strstr(error.text, "16384"));
        assert_null(image.rgba);
    }
}

/* Finds `needle` in the file. */
static int holds(const char *path, const char *needle) {
    size_t size, length = strlen(needle);
    uint8_t *bytes = slurp(path, &size);
    int found = 0;
    for (size_t i = 0; i + length <= size; i++) found |= memcmp(bytes + i, needle, length) == 0;
    free(bytes);
    return found;
}

static void texts_are_kept(void **state) {
    (void)state;
    const iso_png_text texts[] = {{"Software", "isopoint 0.1"}, {"Description", "B\xc3\xa6rentzen"}};
    iso_image image = random_image(4, 4, 1);
    assert_int_equal(iso_png_write(PATH, &image, texts, 2, NULL), ISO_OK);
    assert_true(holds(PATH, "tEXtSoftware"));
    assert_true(holds(PATH, "isopoint 0.1"));
    assert_true(holds(PATH, "iTXtDescription")); /* tEXt is Latin-1 only */
    assert_true(holds(PATH, "B\xc3\xa6rentzen"));

    const iso_png_text nameless = {"", "x"};
    iso_error error = {0};
    remove(PATH);
    assert_int_equal(iso_png_write(PATH, &image, &nameless, 1, &error), ISO_ERR_WRITE);
    assert_non_null(strstr(error.text, PATH));
    assert_int_not_equal(access(PATH, F_OK), 0);
    iso_image_free(&image);
}

/* One PNG of a kind that iso_png_write never makes. */
typedef struct kind {
    int color_type, depth, interlace, transparent;
} kind;

static void write_kind(const kind *k, int width, int height, const uint8_t *rows, size_t stride) {
    png_color palette[16];
    uint8_t alpha[16];
    for (int i = 0; i < 16; i++) {
        palette[i] = (png_color){(png_byte)(i * 3), (png_byte)(i * 5), (png_byte)(i * 7)};
        alpha[i] = (uint8_t)(255 - i);
    }
    png_color_16 clear = {.gray = 1};
    FILE *file = fopen(PATH, "wb");
    png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, NULL, NULL, NULL);
    png_infop info = png_create_info_struct(png);
    png_init_io(png, file);
    png_set_IHDR(png, info, (png_uint_32)width, (png_uint_32)height, k->depth, k->color_type, k->interlace,
                 PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    if (k->color_type == PNG_COLOR_TYPE_PALETTE) png_set_PLTE(png, info, palette, 16);
    if (k->transparent) {
        int indexed = k->color_type == PNG_COLOR_TYPE_PALETTE;
        png_set_tRNS(png, info, indexed ? alpha : NULL, indexed ? 16 : 0, indexed ? NULL : &clear);
    }
    png_write_info(png, info);
    int passes = png_set_interlace_handling(png);
    for (int pass = 0; pass < passes; pass++)
        for (int y = 0; y < height; y++) png_write_row(png, rows + (size_t)y * stride);
    png_write_end(png, info);
    png_destroy_write_struct(&png, &info);
    fclose(file);
}

/* What pixel x of a row must be read as. */
static void expected_pixel(const kind *k, const uint8_t *row, int x, uint8_t rgba[4]) {
    int value;
    rgba[3] = 255;
    switch (k->color_type) {
    case PNG_COLOR_TYPE_PALETTE:
        value = row[x / 2] >> (x % 2 ? 0 : 4) & 15;
        rgba[0] = (uint8_t)(value * 3);
        rgba[1] = (uint8_t)(value * 5);
        rgba[2] = (uint8_t)(value * 7);
        if (k->transparent) rgba[3] = (uint8_t)(255 - value);
        return;
    case PNG_COLOR_TYPE_GRAY:
        value = row[x / 8] >> (7 - x % 8) & 1;
        memset(rgba, value ? 255 : 0, 3);
        if (k->transparent && value == 1) rgba[3] = 0;
        return;
    default: /* 16-bit gray with alpha */
        value = (row[4 * x] << 8 | row[4 * x + 1]) * 255;
        memset(rgba, (value + 32895) >> 16, 3);
        value = (row[4 * x + 2] << 8 | row[4 * x + 3]) * 255;
        rgba[3] = (uint8_t)((value + 32895) >> 16);
    }
}

static void every_kind_is_read(void **state) {
    (void)state;
    const kind kinds[] = {{PNG_COLOR_TYPE_PALETTE, 4, PNG_INTERLACE_NONE, 1},
                          {PNG_COLOR_TYPE_PALETTE, 4, PNG_INTERLACE_ADAM7, 0},
                          {PNG_COLOR_TYPE_GRAY, 1, PNG_INTERLACE_NONE, 0},
                          {PNG_COLOR_TYPE_GRAY, 1, PNG_INTERLACE_ADAM7, 1},
                          {PNG_COLOR_TYPE_GRAY_ALPHA, 16, PNG_INTERLACE_NONE, 0},
                          {PNG_COLOR_TYPE_GRAY_ALPHA, 16, PNG_INTERLACE_ADAM7, 0}};
    enum { WIDTH = 21, HEIGHT = 13, STRIDE = WIDTH * 4 };
    uint8_t rows[STRIDE * HEIGHT];
    uint32_t seed = 5;
    for (size_t i = 0; i < sizeof rows; i++) rows[i] = (uint8_t)random_bits(&seed);
    for (size_t k = 0; k < sizeof kinds / sizeof kinds[0]; k++) {
        write_kind(&kinds[k], WIDTH, HEIGHT, rows, STRIDE);
        iso_image image = {0};
        assert_int_equal(iso_png_read(PATH, &image, NULL), ISO_OK);
        for (int y = 0; y < HEIGHT; y++)
            for (int x = 0; x < WIDTH; x++) {
                uint8_t wanted[4];
                expected_pixel(&kinds[k], rows + y * STRIDE, x, wanted);
                assert_memory_equal(image.rgba + (y * WIDTH + x) * 4, wanted, 4);
            }
        iso_image_free(&image);
    }
}

/* Sends file descriptor 2 to a file, and back: broken pictures must not make libpng talk. */
static int silence(const char *path) {
    fflush(stderr);
    int saved = dup(2);
    FILE *file = freopen(path, "w", stderr);
    assert_non_null(file);
    return saved;
}

static void unsilence(int saved) {
    fflush(stderr);
    dup2(saved, 2);
    close(saved);
}

static void broken_files_are_named(void **state) {
    (void)state;
    const char *broken = ISO_TEST_TMP "/broken.png", *talk = ISO_TEST_TMP "/stderr.txt";
    iso_image image = random_image(9, 7, 0), back = {0};
    const iso_png_text text = {"Title", "t"};
    assert_int_equal(iso_png_write(PATH, &image, &text, 1, NULL), ISO_OK);
    size_t size;
    uint8_t *bytes = slurp(PATH, &size);
    int saved = silence(talk);
    size_t accepted = 0;
    for (size_t length = 0; length < size; length++) {
        iso_error error = {0};
        spill(broken, bytes, length);
        assert_int_equal(iso_png_read(broken, &back, &error), ISO_ERR_FORMAT);
        assert_non_null(strstr(error.text, broken));
        assert_null(back.rgba);
    }
    for (size_t at = 0; at < size; at++) {
        iso_error error = {0};
        bytes[at] ^= 0x41;
        spill(broken, bytes, size);
        if (iso_png_read(broken, &back, &error) == ISO_OK) {
            accepted++; /* a damaged text chunk does not spoil the picture */
            assert_memory_equal(back.rgba, image.rgba, 9 * 7 * 4);
            iso_image_free(&back);
        } else {
            assert_non_null(strstr(error.text, broken));
        }
        bytes[at] ^= 0x41;
    }
    unsilence(saved);
    struct stat info;
    assert_int_equal(stat(talk, &info), 0);
    assert_int_equal(info.st_size, 0);
    assert_true(accepted <= 30);
    free(bytes);
    iso_image_free(&image);
}

static void unreadable_files_are_named(void **state) {
    (void)state;
    iso_image back = {0};
    iso_error error = {0};
    assert_int_equal(iso_png_read(ISO_TEST_TMP "/missing.png", &back, &error), ISO_ERR_IO);
    assert_non_null(strstr(error.text, "missing.png"));
    assert_int_equal(iso_png_read(ISO_TEST_TMP, &back, &error), ISO_ERR_IO);
    assert_non_null(strstr(error.text, "folder"));
    spill(PATH, "hello, this is text\n", 20);
    assert_int_equal(iso_png_read(PATH, &back, &error), ISO_ERR_FORMAT);
    uint8_t *row = calloc(1, (ISO_IMAGE_MAX + 1) / 8 + 1);
    const kind gray = {PNG_COLOR_TYPE_GRAY, 1, PNG_INTERLACE_NONE, 0};
    write_kind(&gray, ISO_IMAGE_MAX + 1, 1, row, 0);
    free(row);
    assert_int_equal(iso_png_read(PATH, &back, &error), ISO_ERR_FORMAT);
    assert_non_null(strstr(error.text, "16385x1"));
    assert_null(back.rgba);
}

static void unwritable_paths_are_named(void **state) {
    (void)state;
    iso_image image = random_image(5, 5, 1);
    iso_error error = {0};
    assert_int_equal(iso_png_write("/nonexistent/x.png", &image, NULL, 0, &error), ISO_ERR_WRITE);
    assert_non_null(strstr(error.text, "/nonexistent/x.png"));
    assert_int_equal(iso_png_write(ISO_TEST_TMP, &image, NULL, 0, &error), ISO_ERR_WRITE);
    assert_non_null(strstr(error.text, "directory"));
    iso_image_free(&image);
}

/* In a child, because a full stdout would stay full. The picture is larger than stdio's buffer in the second
 * round, so that the failure is met inside libpng. */
static void a_full_disk_is_reported(void **state) {
    (void)state;
    if (access("/dev/full", W_OK) != 0) {
        print_message("no /dev/full here\n");
        skip();
    }
    for (int side = 4; side <= 512; side *= 128) {
        iso_image picture = random_image(side, side, 1);
        iso_error refused = {0};
        struct stat info;
        assert_int_equal(iso_png_write("/dev/full", &picture, NULL, 0, &refused), ISO_ERR_WRITE);
        assert_non_null(strstr(refused.text, "/dev/full: cannot write: No space left"));
        assert_true(stat("/dev/full", &info) == 0 && S_ISCHR(info.st_mode));
        iso_image_free(&picture);
        fflush(stdout);
        pid_t child = fork();
        if (child == 0) {
            iso_image image = random_image(side, side, 1);
            iso_error error = {0};
            if (!freopen("/dev/full", "w", stdout)) _exit(100);
            iso_status status = iso_png_write("-", &image, NULL, 0, &error);
            int named = strstr(error.text, "standard output") && strstr(error.text, "No space left");
            iso_image_free(&image);
            _exit(status == ISO_ERR_WRITE && named ? 0 : 101);
        }
        int result = -1;
        assert_int_equal(waitpid(child, &result, 0), child);
        assert_true(WIFEXITED(result));
        assert_int_equal(WEXITSTATUS(result), 0);
    }
}

/* A picture of 40 x 24 pixels whose quarters have a grey each: 40, 90, 140, 190 from the top left on. */
static iso_image quarters(void) {
    iso_image image;
    assert_int_equal(iso_image_create(40, 24, &image, NULL), ISO_OK);
    for (int i = 0; i < 40 * 24; i++) {
        const int value = 40 + 50 * (i % 40 >= 20) + 100 * (i / 40 >= 12);
        for (int c = 0; c < 4; c++) image.rgba[4 * i + c] = (uint8_t)(c < 3 ? value : 255);
    }
    return image;
}

/* Puts an Exif block with an orientation after the first marker of a JPEG. */
static void add_orientation(const char *path, int orientation, bool little) {
    uint8_t block[] = {0xff, 0xe1, 0, 34, 'E', 'x', 'i', 'f', 0, 0, 'M', 'M', 0, 42, 0, 0, 0, 8,
                       0,    1,    1, 18, 0,   3,   0,   0,   0, 1, 0,   0,   0, 0,  0, 0, 0, 0};
    static const uint8_t other[] = {'I', 'I', 42, 0, 8, 0, 0, 0, 1, 0, 18, 1, 3, 0, 1, 0, 0, 0};
    size_t size;
    uint8_t *bytes = slurp(path, &size);
    if (little) memcpy(block + 10, other, sizeof other);
    block[little ? 28 : 29] = (uint8_t)orientation;
    uint8_t *all = malloc(size + sizeof block);
    memcpy(all, bytes, 2);
    memcpy(all + 2, block, sizeof block);
    memcpy(all + 2 + sizeof block, bytes + 2, size - 2);
    spill(path, all, size + sizeof block);
    free(bytes);
    free(all);
}

/* A JPEG is read like a PNG, and turned as its camera was held: the corners of the picture tell. */
static void jpeg_is_read(void **state) {
    (void)state;
    static const char *const JPEG = ISO_TEST_TMP "/turned.jpg";
    static const uint8_t corners[9][4] = {{40, 90, 140, 190}, {40, 90, 140, 190}, {90, 40, 190, 140},
                                          {190, 140, 90, 40}, {140, 190, 40, 90}, {40, 140, 90, 190},
                                          {140, 40, 190, 90}, {190, 90, 140, 40}, {90, 190, 40, 140}};
    if (!iso_jpeg_available()) skip();
    for (int i = 0; i < 2 * 9; i++) {
        const int orientation = i / 2;
        iso_image image = quarters(), back = {0};
        assert_int_equal(iso_jpeg_write(JPEG, &image, &(iso_png_opts){0}, NULL), ISO_OK);
        if (orientation) add_orientation(JPEG, orientation, i % 2);
        assert_int_equal(iso_image_file_read(JPEG, &back, NULL), ISO_OK);
        assert_int_equal(back.width, orientation >= 5 ? 24 : 40);
        assert_int_equal(back.height, orientation >= 5 ? 40 : 24);
        for (int k = 0; k < 4; k++) {
            const int x = k % 2 ? back.width - 3 : 2, y = k / 2 ? back.height - 3 : 2;
            const uint8_t *pixel = back.rgba + 4 * (y * back.width + x);
            assert_true(abs(pixel[0] - corners[orientation][k]) <= 3 && pixel[1] == pixel[0]);
            assert_int_equal(pixel[3], 255);
        }
        iso_image_free(&image);
        iso_image_free(&back);
    }
    /* what is cut is refused, and nothing is made up */
    size_t size;
    uint8_t *bytes = slurp(JPEG, &size);
    iso_image back = {0};
    iso_error error = {0};
    spill(JPEG, bytes, size - 40);
    assert_int_equal(iso_image_file_read(JPEG, &back, &error), ISO_ERR_IO);
    assert_non_null(strstr(error.text, "turned.jpg"));
    assert_null(back.rgba);
    free(bytes);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_is_written_is_read),
        cmocka_unit_test(one_transparent_pixel_is_found),
        cmocka_unit_test(threads_write_the_same_file),
        cmocka_unit_test(small_files_hold_the_same_picture),
        cmocka_unit_test(sides_are_checked),
        cmocka_unit_test(texts_are_kept),
        cmocka_unit_test(jpeg_is_read),
        cmocka_unit_test(every_kind_is_read),
        cmocka_unit_test(broken_files_are_named),
        cmocka_unit_test(unreadable_files_are_named),
        cmocka_unit_test(unwritable_paths_are_named),
        cmocka_unit_test(a_full_disk_is_reported),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
