#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "check_support.h"
#include "compare/flip.h"
#include "compare/metrics.h"
#include "compare/silhouette.h"
#include "compare/ssim.h"

/* ---- pictures ---- */

enum { W = 48, H = 40, N = W * H };
static const int SIZE[2] = {W, H};

/* A disc on gradients; `moved` shifts it by (3, 1) and adds a white dot. */
static void make_picture(int moved, uint8_t rgb[3 * N]) {
    for (int y = 0; y < H; y++)
        for (int x = 0; x < W; x++) {
            int dx = x - 24 - 3 * moved, dy = y - 20 - moved;
            int color[3] = {40 + 3 * x, 200 - 2 * y, x * y % 256};
            if (dx * dx + dy * dy < 150) color[0] = 220, color[1] = 60, color[2] = 40;
            if (moved && x == 8 && y == 8) color[0] = color[1] = color[2] = 255;
            for (int c = 0; c < 3; c++) rgb[3 * (y * W + x) + c] = (uint8_t)color[c];
        }
}

static void to_rgba(const uint8_t rgb[3 * N], uint8_t rgba[4 * N]) {
    for (int i = 0; i < N; i++) {
        memcpy(rgba + 4 * i, rgb + 3 * i, 3);
        rgba[4 * i + 3] = 255;
    }
}

static void fill(uint8_t *rgb, size_t count, int r, int g, int b) {
    for (size_t i = 0; i < count; i++) {
        rgb[3 * i] = (uint8_t)r;
        rgb[3 * i + 1] = (uint8_t)g;
        rgb[3 * i + 2] = (uint8_t)b;
    }
}

/* Reads a mask from text: '#' is covered. */
static void read_mask(const char *const *rows, int width, int height, uint8_t *mask) {
    for (int y = 0; y < height; y++)
        for (int x = 0; x < width; x++) mask[y * width + x] = rows[y][x] == '#';
}

/* ---- FLIP ---- */

static double flip_of(const uint8_t *a, const uint8_t *b, const int size[2], double density) {
    double mean = -1;
    iso_flip_opts opts = {.pixels_per_degree = density};
    assert_int_equal(iso_flip(a, b, size, &opts, &mean, NULL), ISO_OK);
    return mean;
}

/* Expected numbers of this group: the formulas of the authors' own Python program (version 1.2), evaluated in
 * double precision with 2-D kernels. */
static void flip_gives_the_authors_values(void **state) {
    (void)state;
    static uint8_t a[3 * N], b[3 * N];
    static float map[N];
    make_picture(0, a);
    make_picture(1, b);
    double mean;
    iso_flip_opts opts = {.map = map};
    assert_int_equal(iso_flip(a, b, SIZE, &opts, &mean, NULL), ISO_OK);
    near(mean, 0.1661758, 2e-6);
    static const struct {
        int y, x;
        double value;
    } samples[] = {{8, 8, 0.476454},   {20, 12, 0.757018}, {0, 0, 0.000429},
                   {20, 37, 0.710230}, {39, 47, 0},        {21, 24, 0.011277}};
    for (size_t i = 0; i < sizeof samples / sizeof *samples; i++)
        near((double)map[samples[i].y * W + samples[i].x], samples[i].value, 2e-5);
    near(flip_of(a, b, SIZE, 30), 0.1261301, 2e-6);
}

static void flip_of_plain_colors(void **state) {
    (void)state;
    static const struct {
        int a[3], b[3];
        double value;
    } pairs[] = {{{0, 0, 0}, {255, 255, 255}, 0.9673798},
                 {{0, 255, 0}, {0, 0, 255}, 1},
                 {{255, 0, 0}, {0, 255, 0}, 0.9866623},
                 {{100, 100, 100}, {110, 110, 110}, 0.1534606},
                 {{200, 50, 50}, {180, 60, 70}, 0.3073976}};
    const int size[2] = {24, 24};
    static uint8_t a[3 * 24 * 24], b[3 * 24 * 24];
    for (size_t i = 0; i < sizeof pairs / sizeof *pairs; i++) {
        fill(a, 24 * 24, pairs[i].a[0], pairs[i].a[1], pairs[i].a[2]);
        fill(b, 24 * 24, pairs[i].b[0], pairs[i].b[1], pairs[i].b[2]);
        near(flip_of(a, b, size, 0), pairs[i].value, 1e-5);
        near(flip_of(b, a, size, 0), pairs[i].value, 1e-5);
    }
}

static void flip_of_equal_pictures_is_nothing(void **state) {
    (void)state;
    static uint8_t a[3 * N];
    static float map[N];
    make_picture(1, a);
    double mean = -1;
    iso_flip_opts opts = {.map = map};
    assert_int_equal(iso_flip(a, a, SIZE, &opts, &mean, NULL), ISO_OK);
    assert_true(mean == 0);
    for (int i = 0; i < N; i++) assert_true(map[i] == 0);
}

static void flip_refuses_strange_densities(void **state) {
    (void)state;
    uint8_t pixel[3] = {1, 2, 3};
    const int size[2] = {1, 1};
    const double bad[] = {0.5, -3, 451, NAN};
    for (int i = 0; i < 4; i++) {
        iso_flip_opts opts = {.pixels_per_degree = bad[i]};
        double mean;
        assert_int_equal(iso_flip(pixel, pixel, size, &opts, &mean, NULL), ISO_ERR_USAGE);
    }
    assert_true(flip_of(pixel, pixel, size, ISO_FLIP_PIXELS_PER_DEGREE_MAX) == 0);
    assert_true(flip_of(pixel, pixel, size, 1) == 0);
}

static void threads_change_nothing(void **state) {
    (void)state;
    static uint8_t a[3 * N], b[3 * N];
    static float alone[N], shared[N];
    make_picture(0, a);
    make_picture(1, b);
    iso_pool *pool = NULL;
    assert_int_equal(iso_pool_create(3, &pool, NULL), ISO_OK);
    double means[2], ssims[2];
    iso_flip_opts one = {.map = alone}, three = {.map = shared, .pool = pool};
    assert_int_equal(iso_flip(a, b, SIZE, &one, &means[0], NULL), ISO_OK);
    assert_int_equal(iso_flip(a, b, SIZE, &three, &means[1], NULL), ISO_OK);
    assert_int_equal(iso_ssim(a, b, SIZE, NULL, &ssims[0], NULL), ISO_OK);
    assert_int_equal(iso_ssim(a, b, SIZE, pool, &ssims[1], NULL), ISO_OK);
    assert_memory_equal(alone, shared, sizeof alone);
    assert_true(means[0] == means[1] && ssims[0] == ssims[1]);
    iso_pool_destroy(pool);
}

/* ---- SSIM ---- */

static double ssim_of(const uint8_t *a, const uint8_t *b, const int size[2]) {
    double ssim = -2;
    assert_int_equal(iso_ssim(a, b, size, NULL, &ssim, NULL), ISO_OK);
    return ssim;
}

/* 0.6603611: scikit-image 0.19, gaussian_weights, sigma 1.5, use_sample_covariance off, 11 pixels, of luma.
 */
static void ssim_gives_known_values(void **state) {
    (void)state;
    static uint8_t a[3 * N], b[3 * N];
    make_picture(0, a);
    make_picture(1, b);
    near(ssim_of(a, b, SIZE), 0.6603611, 2e-6);
    assert_true(ssim_of(a, a, SIZE) == 1);
    near(ssim_of(a, b, SIZE), ssim_of(b, a, SIZE), 1e-12);
    fill(a, N, 100, 100, 100);
    fill(b, N, 120, 120, 120);
    const double c1 = 2.55 * 2.55; /* no variance: only the term of the means is left */
    near(ssim_of(a, b, SIZE), (2 * 100 * 120 + c1) / (100 * 100 + 120 * 120 + c1), 1e-5);
    const int smallest[2] = {11, 11}, low[2] = {40, 10}, narrow[2] = {10, 40};
    assert_true(ssim_of(a, a, smallest) == 1);
    assert_true(isnan(ssim_of(a, b, low)) && isnan(ssim_of(a, b, narrow)));
}

/* ---- silhouettes ---- */

static void silhouettes_by_hand(void **state) {
    (void)state;
    enum { SIDE = 12 };
    static const char *const truth_rows[] = {"............", "............", "..#######...", "..#######...",
                                             "..#######...", "..#######...", "..#######...", "..#######...",
                                             "..#######...", "............", "............", "............"};
    /* one hole in the middle, one row more at the bottom, a pixel far to the right */
    static const char *const candidate_rows[] = {
        "............", "............", "..#######...", "..#######...", "..#######...", "..###.###...",
        "..#######...", "..#######...", "..#######...", "..#######...", "............", "...........#"};
    const int size[2] = {SIDE, SIDE};
    uint8_t truth[SIDE * SIDE], candidate[SIDE * SIDE];
    read_mask(truth_rows, SIDE, SIDE, truth);
    read_mask(candidate_rows, SIDE, SIDE, candidate);
    iso_silhouette_difference d;
    assert_int_equal(iso_silhouette_compare(truth, candidate, size, &d, NULL), ISO_OK);
    near(d.iou, 48.0 / (49 + 8), 1e-15);
    near(d.dilation_mean, (56.0 - 49) / 24, 1e-15);
    near(d.dilation_max, sqrt(3 * 3 + 3 * 3), 1e-12);
    near(d.dilation_p99, sqrt(3 * 3 + 3 * 3), 1e-12); /* one pixel of the border is more than 1 % */
    near(d.holes, 100.0 / 9, 1e-12);                  /* 7 x 7 eroded by 2 is 3 x 3 */
    assert_int_equal(d.missing, 1);
    assert_int_equal(d.extra, 8);
    assert_int_equal(iso_silhouette_compare(truth, truth, size, &d, NULL), ISO_OK);
    assert_true(d.iou == 1 && d.dilation_mean == 0 && d.dilation_max == 0 && d.holes == 0);
}

static void empty_and_full_silhouettes(void **state) {
    (void)state;
    const int size[2] = {5, 4};
    uint8_t none[20] = {0}, all[20];
    memset(all, 1, sizeof all);
    iso_silhouette_difference d;
    assert_int_equal(iso_silhouette_compare(none, none, size, &d, NULL), ISO_OK);
    assert_true(isnan(d.iou) && isnan(d.dilation_mean) && isnan(d.dilation_max) && isnan(d.holes));
    assert_int_equal(iso_silhouette_compare(none, all, size, &d, NULL), ISO_OK);
    assert_true(d.iou == 0 && isnan(d.dilation_max) && d.extra == 20);
    /* a truth that fills the picture has no border to widen, and no pixel beyond the picture is missing */
    assert_int_equal(iso_silhouette_compare(all, none, size, &d, NULL), ISO_OK);
    assert_true(d.iou == 0 && isnan(d.dilation_mean) && d.dilation_max == 0 && d.holes == 100);
}

/* Against brute force, on masks from nearly empty to nearly full. */
static void squares_and_distances_are_right(void **state) {
    (void)state;
    enum { A = 23, B = 17, ALL = A * B };
    const int size[2] = {A, B};
    uint32_t seed = 5;
    for (int round = 0; round < 60; round++) {
        uint8_t truth[ALL], candidate[ALL], wide[ALL], thin[ALL];
        for (int i = 0; i < ALL; i++) {
            truth[i] = (int)(random_bits(&seed) % 60) < round;
            candidate[i] = random_bits(&seed) % 3 == 0;
        }
        int radius = round % 4;
        assert_int_equal(iso_silhouette_dilate(truth, size, radius, wide, NULL), ISO_OK);
        assert_int_equal(iso_silhouette_erode(truth, size, radius, thin, NULL), ISO_OK);
        double farthest = 0, far[ALL];
        int borders = 0;
        for (int i = 0; i < ALL; i++) {
            int x = i % A, y = i / A, any = 0, all = 1, nearest = 1 << 20;
            for (int k = 0; k < ALL; k++) {
                int dx = abs(k % A - x), dy = abs(k / A - y);
                if (truth[k] && dx * dx + dy * dy < nearest) nearest = dx * dx + dy * dy;
                if (dx > radius || dy > radius) continue;
                any |= truth[k];
                all &= truth[k];
            }
            assert_int_equal(wide[i], any);
            assert_int_equal(thin[i], all);
            if (!candidate[i] || nearest == 1 << 20) continue;
            if (sqrt(nearest) > farthest) farthest = sqrt(nearest);
            const bool border = (x && !candidate[i - 1]) || (x + 1 < A && !candidate[i + 1]) ||
                                (y && !candidate[i - A]) || (y + 1 < B && !candidate[i + A]);
            if (border) far[borders++] = sqrt(nearest);
        }
        iso_silhouette_difference d;
        assert_int_equal(iso_silhouette_compare(truth, candidate, size, &d, NULL), ISO_OK);
        if (isnan(d.dilation_max)) continue;
        near(d.dilation_max, farthest, 1e-12);
        int below = 0, at = 0; /* of the border's pixels: nearer than dilation_p99; at most so far */
        for (int i = 0; i < borders; i++) {
            below += far[i] < d.dilation_p99 - 1e-9;
            at += far[i] <= d.dilation_p99 + 1e-9;
        }
        assert_true(borders == 0 || (100 * below < 99 * borders && 100 * at >= 99 * borders));
    }
}

/* ---- all together ---- */

static iso_metrics metrics_of(const iso_compare_picture *a, const iso_compare_picture *b,
                              const iso_compare_opts *opts) {
    iso_metrics metrics;
    assert_int_equal(iso_compare(a, b, opts, &metrics, NULL), ISO_OK);
    return metrics;
}

static void equal_pictures_are_perfect(void **state) {
    (void)state;
    static uint8_t rgb[3 * N], rgba[4 * N];
    make_picture(1, rgb);
    to_rgba(rgb, rgba);
    iso_compare_picture picture = {.width = W, .height = H, .rgba = rgba};
    iso_compare_opts opts = {0};
    iso_metrics m = metrics_of(&picture, &picture, &opts);
    near(m.psnr, 10 * log10(65025 / 1e-9), 1e-9);
    assert_true(m.psnr == m.psnr_in && m.ssim == 1 && m.flip == 0 && m.iou == 1 && m.holes == 0);
    assert_true(m.pixels_differing == 0);
    assert_true(isnan(m.normal_error_deg) && isnan(m.depth_error_voxel) && isnan(m.wrong));
}

/* A square of 6 x 6 on white; the candidate's is one column wider and has one pixel of another colour. */
static void colors_by_hand(void **state) {
    (void)state;
    enum { SIDE = 20, ALL = SIDE * SIDE };
    static uint8_t a[4 * ALL], b[4 * ALL];
    memset(a, 255, sizeof a);
    for (int y = 5; y < 11; y++)
        for (int x = 5; x < 11; x++) memset(a + 4 * (y * SIDE + x), 100, 3);
    memcpy(b, a, sizeof b);
    for (int y = 5; y < 11; y++) memset(b + 4 * (y * SIDE + 11), 100, 3);
    b[4 * (7 * SIDE + 7) + 1] = 110;
    b[4 * (8 * SIDE + 8)] = 101; /* one step does not count as different, but is an error */
    iso_compare_picture truth = {.width = SIDE, .height = SIDE, .rgba = a}, candidate = truth;
    candidate.rgba = b;
    iso_compare_opts opts = {.background = {255, 255, 255}};
    iso_metrics m = metrics_of(&truth, &candidate, &opts);
    double squares = 6 * 3 * 155.0 * 155 + 10 * 10 + 1;
    near(m.psnr, 10 * log10(65025 / (squares / (3 * ALL))), 1e-9);
    near(m.psnr_in, 10 * log10(65025 / (squares / (3 * 11 * 10))), 1e-9);
    assert_true(m.pixels_differing == 7);
    assert_true(m.error_p99 == 155 && m.error_max == 155); /* 6 of 110 pixels differ by 155 */
    assert_int_equal(m.others_differing, 1);
    near(m.iou, 36.0 / 42, 1e-15);
    near(m.dilation_mean, 6.0 / 20, 1e-15);
    near(m.dilation_max, 1, 1e-12);
    assert_int_equal(m.covered[0], 36);
    assert_int_equal(m.covered[1], 42);
    assert_int_equal(m.sources[0], ISO_SILHOUETTE_BACKGROUND);
}

static void unrounded_colors_are_finer(void **state) {
    (void)state;
    enum { ALL = 4 };
    uint8_t pixels[4 * ALL];
    memset(pixels, 255, sizeof pixels);
    pixels[0] = 0; /* one covered pixel; all are within 2 pixels of it */
    float a[3 * ALL] = {0}, b[3 * ALL] = {0};
    b[4] = 0.25f;
    iso_compare_picture truth = {.width = 2, .height = 2, .rgba = pixels, .color = a}, candidate = truth;
    candidate.color = b;
    iso_compare_opts opts = {.background = {255, 255, 255}};
    iso_metrics m = metrics_of(&truth, &candidate, &opts);
    near(m.psnr, 10 * log10(65025 / (0.0625 / 12)), 1e-5);
    near(m.psnr_in, m.psnr, 1e-12);
    assert_true(m.pixels_differing == 0);
    candidate.color = NULL;
    near(metrics_of(&truth, &candidate, &opts).psnr, 10 * log10(65025 / 1e-9), 1e-9);
}

static void transparent_pictures_lie_on_the_background(void **state) {
    (void)state;
    enum { SIDE = 16, ALL = SIDE * SIDE };
    static uint8_t a[4 * ALL], b[4 * ALL];
    memset(a, 0, sizeof a);
    for (int i = 0; i < ALL / 2; i++) memcpy(a + 4 * i, (uint8_t[]){200, 100, 50, 255}, 4);
    memcpy(a, (uint8_t[]){200, 100, 50, 128}, 4);
    memcpy(a + 4, (uint8_t[]){200, 100, 50, 127}, 4);
    memcpy(b, a, sizeof b);
    memcpy(b + 4 * (ALL - 1), (uint8_t[]){9, 9, 9, 0}, 4); /* what is not seen is no difference */
    iso_compare_picture truth = {.width = SIDE, .height = SIDE, .rgba = a}, candidate = truth;
    candidate.rgba = b;
    iso_compare_opts opts = {.background = {10, 20, 30}};
    iso_metrics m = metrics_of(&truth, &candidate, &opts);
    assert_true(m.pixels_differing == 0 && m.flip == 0 && m.iou == 1);
    assert_int_equal(m.covered[0], ALL / 2 - 1);
    assert_int_equal(m.sources[1], ISO_SILHOUETTE_ALPHA);
    /* an opaque picture of the same colours over that background is equal, too */
    for (int i = 0; i < ALL; i++) {
        if (a[4 * i + 3] == 0) memcpy(b + 4 * i, (uint8_t[]){10, 20, 30, 255}, 4);
        b[4 * i + 3] = 255;
    }
    memcpy(b, (uint8_t[]){105, 60, 40, 255}, 4);     /* (200 * 128 + 10 * 127) / 255, ... */
    memcpy(b + 4, (uint8_t[]){105, 60, 40, 255}, 4); /* 104.6, 59.8, 40.0 */
    m = metrics_of(&truth, &candidate, &opts);
    assert_true(m.pixels_differing == 0);
    near(m.psnr, 10 * log10(65025 / 1e-9), 1e-9);
}

static void channels_by_hand(void **state) {
    (void)state;
    enum { ALL = 8 };
    float cover_a[ALL] = {1, 1, 1, 1, 1, 0.5f, 0.49f, 0}, cover_b[ALL] = {1, 1, 1, 1, 1, 1, 1, 0};
    float depth_a[ALL] = {10, 10, 10, 10, 10, 10, 10, INFINITY};
    float depth_b[ALL] = {10, 10.5f, 9, 11.25f, 14.1f, 10, 99, INFINITY};
    float x[2][ALL] = {{0}}, y[2][ALL] = {{0}}, z[2][ALL];
    for (int i = 0; i < ALL; i++) z[0][i] = z[1][i] = -1;
    y[1][1] = 1, z[1][1] = 0;  /* 90 degrees */
    x[1][2] = 2, z[1][2] = -2; /* 45, not unit */
    z[1][4] = 1;               /* 180, but too far away to count */
    z[0][5] = 0;               /* no direction */
    iso_compare_picture truth = {
        .width = 4, .height = 2, .depth = depth_a, .normal = {x[0], y[0], z[0]}, .coverage = cover_a};
    iso_compare_picture candidate = {
        .width = 4, .height = 2, .depth = depth_b, .normal = {x[1], y[1], z[1]}, .coverage = cover_b};
    iso_compare_opts opts = {.voxel = 2};
    iso_metrics m = metrics_of(&truth, &candidate, &opts);
    near(m.wrong, 100.0 / 6, 1e-12); /* 4.1 mm is 2.05 voxels */
    near(m.depth_error_voxel, (0 + 0.25 + 0.5 + 0.625 + 0) / 5, 1e-12);
    near(m.normal_error_deg, (0 + 90 + 45 + 0) / 4.0, 1e-9);
    assert_int_equal(m.sources[0], ISO_SILHOUETTE_COVERAGE);
    assert_int_equal(m.extra, 1);
    assert_int_equal(m.depth_off, 4);
    assert_true(isnan(m.psnr) && isnan(m.flip));
    opts.voxel = 0; /* then normals count wherever both are covered */
    m = metrics_of(&truth, &candidate, &opts);
    assert_true(isnan(m.wrong) && isnan(m.depth_error_voxel));
    near(m.normal_error_deg, (0 + 90 + 45 + 0 + 180) / 5.0, 1e-9);
}

/* A turn of a hundredth of a degree is there in floats, and an arc cosine would miss it. */
static void small_angles_are_not_lost(void **state) {
    (void)state;
    const double turn = 0.01 * ISO_PI / 180;
    float one = 1, depth = 5, x = 0, y = 0.6f, z = -0.8f, x2 = (float)turn;
    iso_compare_picture truth = {
        .width = 1, .height = 1, .depth = &depth, .normal = {&x, &y, &z}, .coverage = &one};
    iso_compare_picture candidate = truth;
    candidate.normal[0] = &x2;
    iso_compare_opts opts = {.voxel = 1};
    near(metrics_of(&truth, &candidate, &opts).normal_error_deg, 0.01, 1e-5);
    assert_true(metrics_of(&truth, &truth, &opts).normal_error_deg == 0);
}

static void sizes_must_agree(void **state) {
    (void)state;
    uint8_t pixels[4 * 6] = {0};
    iso_compare_picture a = {.width = 3, .height = 2, .rgba = pixels},
                        b = {.width = 2, .height = 3, .rgba = pixels};
    iso_compare_opts opts = {0};
    iso_metrics metrics;
    iso_error error = {0};
    assert_int_equal(iso_compare(&a, &b, &opts, &metrics, &error), ISO_ERR_MISMATCH);
    assert_non_null(strstr(error.text, "3x2"));
}

static void bounds_know_which_way_is_worse(void **state) {
    (void)state;
    size_t count;
    const iso_metric *list = iso_metric_list(&count);
    for (size_t i = 0; i < count; i++) {
        const iso_metric *metric = &list[i];
        assert_ptr_equal(iso_metric_find(metric->name), metric);
        assert_int_equal(iso_metric_is_worse(metric, 3, 4), metric->larger_is_better);
        assert_int_equal(iso_metric_is_worse(metric, 4, 3), !metric->larger_is_better);
        assert_false(iso_metric_is_worse(metric, 3, 3));
        assert_true(iso_metric_is_worse(metric, NAN, 3));
    }
    assert_null(iso_metric_find("beauty"));
    const iso_metric *mean = iso_metric_find("dilation_mean");
    assert_true(iso_metric_is_worse(mean, -3, 2)); /* too thin is as bad as too fat */
    assert_false(iso_metric_is_worse(mean, -1, 2));
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(flip_gives_the_authors_values),
        cmocka_unit_test(flip_of_plain_colors),
        cmocka_unit_test(flip_of_equal_pictures_is_nothing),
        cmocka_unit_test(flip_refuses_strange_densities),
        cmocka_unit_test(threads_change_nothing),
        cmocka_unit_test(ssim_gives_known_values),
        cmocka_unit_test(silhouettes_by_hand),
        cmocka_unit_test(empty_and_full_silhouettes),
        cmocka_unit_test(squares_and_distances_are_right),
        cmocka_unit_test(equal_pictures_are_perfect),
        cmocka_unit_test(colors_by_hand),
        cmocka_unit_test(unrounded_colors_are_finer),
        cmocka_unit_test(transparent_pictures_lie_on_the_background),
        cmocka_unit_test(channels_by_hand),
        cmocka_unit_test(small_angles_are_not_lost),
        cmocka_unit_test(sizes_must_agree),
        cmocka_unit_test(bounds_know_which_way_is_worse),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
