/* The pieces of rays that bodies leave, against points of the rays; and what is left of boxes. */
#include "render/view/clip.h"

#include "check_support.h"

static uint64_t state = 1;

/* A number from -1 to 1. */
static double next(void) {
    state = state * 6364136223846793005u + 1442695040888963407u;
    return (double)(int64_t)(state >> 11) / (double)(1ll << 52) - 1;
}

static iso_vec3 next_vector(double scale) {
    const double x = next(), y = next(), z = next();
    return iso_vec3_scale(iso_vec3_make(x, y, z), scale);
}

static iso_clip random_clip(int count) {
    iso_clip clip = {.count = count};
    for (int i = 0; i < count; i++) {
        const iso_vec3 a = next_vector(10), b = next_vector(6);
        const iso_box box = {a, iso_vec3_add(a, iso_vec3_make(fabs(b.x) + 1, fabs(b.y) + 1, fabs(b.z) + 1))};
        clip.body[i] = i % 3 == 0   ? iso_clip_half_space(a, b)
                       : i % 3 == 1 ? iso_clip_box(&box)
                                    : iso_clip_ball(a, 2 + fabs(b.x));
        clip.body[i].keeps = next() > 0.6;
        if (clip.body[i].keeps && clip.body[i].faces != 1)
            clip.body[i] = iso_clip_ball(b, 12), clip.body[i].keeps = true;
    }
    return clip;
}

static bool is_in_pieces(const iso_clip_piece *pieces, int count, double t) {
    for (int i = 0; i < count; i++)
        if (t >= pieces[i].begin && t < pieces[i].end) return true;
    return false;
}

/* Every point of a ray is in a piece if it is left, but for points at the pieces' ends. */
static void test_pieces(void **unused) {
    (void)unused;
    size_t shown = 0, hidden = 0;
    for (int n = 0; n < 2000; n++) {
        const iso_clip clip = random_clip(1 + n % 7);
        const iso_vec3 origin = next_vector(20), direction = iso_vec3_sub(next_vector(8), origin);
        iso_clip_piece pieces[ISO_CLIP_PIECES];
        const int count = iso_clip_pieces(&clip, origin, direction, 0, 2, pieces);
        for (int k = 0; k < 100; k++) {
            const double t = 2 * (k + 0.5) / 100;
            const bool shows = iso_clip_shows(&clip, iso_vec3_add(origin, iso_vec3_scale(direction, t)));
            if (is_in_pieces(pieces, count, t) != shows)
                assert_true(is_in_pieces(pieces, count, t - 1e-9) != is_in_pieces(pieces, count, t + 1e-9));
            shows ? shown++ : hidden++;
        }
        for (int i = 0; i < count; i++) {
            assert_true(pieces[i].begin < pieces[i].end && pieces[i].begin >= 0 && pieces[i].end <= 2);
            if (i) assert_true(pieces[i].begin >= pieces[i - 1].end);
            assert_true(pieces[i].begin > 0 ? pieces[i].body >= 0 : pieces[i].body == -1);
        }
    }
    assert_true(shown > 10000 && hidden > 10000);
}

/* Where a piece begins the normal points back to what was cut away. */
static void test_normals(void **unused) {
    (void)unused;
    for (int n = 0; n < 2000; n++) {
        const iso_clip clip = random_clip(1 + n % 3);
        const iso_vec3 origin = next_vector(20), direction = iso_vec3_sub(next_vector(8), origin);
        iso_clip_piece pieces[ISO_CLIP_PIECES];
        const int count = iso_clip_pieces(&clip, origin, direction, 0, 2, pieces);
        for (int i = 0; i < count; i++) {
            if (pieces[i].body < 0) continue;
            const iso_vec3 at = iso_vec3_add(origin, iso_vec3_scale(direction, pieces[i].begin));
            const iso_vec3 normal = iso_clip_normal(&clip, &pieces[i], at);
            assert_float_equal(iso_vec3_length(normal), 1, 1e-9);
            assert_true(iso_vec3_dot(normal, direction) <= 1e-9);
        }
    }
}

/* Of a box of which all or nothing is left, no point says otherwise. */
static void test_boxes(void **unused) {
    (void)unused;
    int counts[3] = {0};
    for (int n = 0; n < 3000; n++) {
        const iso_clip clip = random_clip(1 + n % 4);
        const iso_vec3 centre = next_vector(10), half[3] = {next_vector(1), next_vector(1), next_vector(1)};
        unsigned cutting;
        const iso_clip_rest rest = iso_clip_of_box(&clip, centre, half, &cutting);
        counts[rest]++;
        assert_true(rest != ISO_CLIP_SOME || cutting);
        for (int k = 0; k < 50; k++) {
            iso_vec3 point = centre;
            for (int axis = 0; axis < 3; axis++)
                point = iso_vec3_add(point, iso_vec3_scale(half[axis], next()));
            if (rest != ISO_CLIP_SOME) assert_int_equal(iso_clip_shows(&clip, point), rest == ISO_CLIP_ALL);
        }
    }
    for (int i = 0; i < 3; i++) assert_true(counts[i] > 100);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_pieces), cmocka_unit_test(test_normals),
                                       cmocka_unit_test(test_boxes)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
