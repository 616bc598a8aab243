#include "lent_ball.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>

#include <cmocka.h>

enum { SIDE = 24 };

iso_volume *lend_ball(int threads) {
    static float values[SIDE * SIDE * SIDE];
    for (int i = 0; i < SIDE * SIDE * SIDE; i++) {
        const double x = i % SIDE - 11.5, y = i / SIDE % SIDE - 11.5, z = i / (SIDE * SIDE) - 11.5;
        values[i] = (float)(8 - sqrt(x * x + y * y + z * z));
    }
    iso_volume *volume = NULL;
    const iso_lend_opts opts = {
        .dims = {SIDE, SIDE, SIDE}, .type = ISO_FLOAT32, .data = values, .threads = threads};
    assert_int_equal(iso_volume_lend(&opts, &volume, NULL), ISO_OK);
    return volume;
}

size_t bytes_of(const iso_image *image) {
    return (size_t)image->width * (size_t)image->height * 4;
}
