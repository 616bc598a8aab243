/* environment: reads pictures of environments, makes the built-in studio, and looks up directions. Angles are
 * computed by base/geometry.h instead of libm, so that pictures have the same bytes on every machine. */
#include "image/environment.h"

#include <math.h>
#include <string.h>

#include "base/file_types.h"
#include "base/memory.h"
#include "base/srgb.h"
#include "image/camera.h"
#include "image/exr.h"
#include "image/image.h"

struct iso_environment {
    iso_float_image picture;
    iso_vec3 right, front, up; /* world space; unit vectors */
};

/* ---- making */

/* Takes ownership of the picture's pixels, also when it fails. */
static iso_status make(const iso_float_image *picture, iso_environment **out, iso_error *error) {
    iso_environment *environment = iso_alloc_zero(1, sizeof *environment);
    if (!environment) {
        iso_free(picture->rgb);
        return iso_fail(error, ISO_ERR_NOMEM, "out of memory for the environment");
    }
    environment->picture = *picture;
    iso_environment_set_up(environment, iso_vec3_make(0, 0, 1));
    *out = environment;
    return ISO_OK;
}

/* Allocates the pixels of a picture. */
static iso_status make_picture(int width, int height, iso_float_image *picture, iso_error *error) {
    float *rgb = iso_alloc((size_t)width * (size_t)height * 3 * sizeof *rgb);
    if (!rgb) return iso_fail(error, ISO_ERR_NOMEM, "out of memory for the environment");
    *picture = (iso_float_image){width, height, rgb};
    return ISO_OK;
}

iso_status iso_environment_create(int width, int height, const float *rgb, iso_environment **environment,
                                  iso_error *error) {
    iso_float_image picture = {0};
    ISO_TRY(make_picture(width, height, &picture, error));
    memcpy(picture.rgb, rgb, (size_t)width * (size_t)height * 3 * sizeof *rgb);
    return make(&picture, environment, error);
}

void iso_environment_destroy(iso_environment *environment) {
    if (!environment) return;
    iso_free(environment->picture.rgb);
    iso_free(environment);
}

void iso_environment_set_up(iso_environment *environment, iso_vec3 up) {
    iso_direction_vectors(ISO_FRONT, up, &environment->front, &environment->up);
    environment->right = iso_vec3_cross(environment->front, environment->up);
}

void iso_environment_size(const iso_environment *environment, int size[2]) {
    size[0] = environment->picture.width;
    size[1] = environment->picture.height;
}

/* ---- reading */

static iso_status read_png(const char *path, iso_float_image *picture, iso_error *error) {
    iso_image image = {0};
    ISO_TRY(iso_png_read(path, &image, error));
    float light[256];
    for (int i = 0; i < 256; i++) light[i] = (float)iso_srgb_decode(i / 255.0);
    const iso_status status = make_picture(image.width, image.height, picture, error);
    const size_t pixels = (size_t)image.width * (size_t)image.height;
    for (size_t i = 0; i < pixels && status == ISO_OK; i++)
        for (int k = 0; k < 3; k++) picture->rgb[3 * i + (size_t)k] = light[image.rgba[4 * i + (size_t)k]];
    iso_image_free(&image);
    return status;
}

static iso_status check_picture(const char *path, const iso_float_image *picture, iso_error *error) {
    const size_t width = (size_t)picture->width, pixels = width * (size_t)picture->height;
    if (picture->width < 2 || picture->height < 2)
        return iso_fail(error, ISO_ERR_FORMAT,
                        "%s: %dx%d pixels are no environment: an equirectangular picture is wanted, twice as "
                        "wide as it is high",
                        path, picture->width, picture->height);
    for (size_t i = 0; i < 3 * pixels; i++) {
        if (!isfinite(picture->rgb[i]))
            return iso_fail(error, ISO_ERR_FORMAT, "%s: pixel %zu,%zu is NaN or infinite", path,
                            i / 3 % width, i / 3 / width);
        if (picture->rgb[i] < 0) picture->rgb[i] = 0;
    }
    return ISO_OK;
}

/* Checks the size that the header states. Files without a readable header pass; reading them reports the
 * reason. */
static iso_status check_size(const char *path, uint64_t limit, iso_error *error) {
    enum { BYTES = 3 * sizeof(float) + 4 }; /* memory for one pixel, including the decoded PNG */
    uint32_t size[2];
    if (!iso_png_size(path, size) && !iso_exr_size(path, size)) return ISO_OK;
    if (size[0] > ISO_IMAGE_MAX || size[1] > ISO_IMAGE_MAX) return ISO_OK;
    const double bytes = (double)BYTES * size[0] * size[1];
    if (bytes <= (double)limit) return ISO_OK;
    return iso_fail(error, ISO_ERR_LIMIT,
                    "%s: an environment of %ux%u needs %.0f MB, limit is %.0f MB (--max-memory)", path,
                    size[0], size[1], bytes / 1e6, (double)limit / 1e6);
}

iso_status iso_environment_read(const char *path, uint64_t limit, iso_pool *pool,
                                iso_environment **environment, iso_error *error) {
    iso_float_image picture = {0};
    uint32_t size[2];
    ISO_TRY(check_size(path, limit, error));
    if (iso_file_type_of_name(path, ~0u) == ISO_FILE_png || iso_png_size(path, size))
        ISO_TRY(read_png(path, &picture, error));
    else
        ISO_TRY(iso_exr_read_color(path, pool, &picture, error));
    const iso_status status = check_picture(path, &picture, error);
    if (status == ISO_OK) return make(&picture, environment, error);
    iso_free(picture.rgb);
    return status;
}

/* ---- the studio */

/* The studio's light by elevation, linearly interpolated between the rows of this table. It is bright in the
 * directions of usual cameras and dark above and below: refraction brings the dark parts to the rims of
 * glass, which makes it stand out. */
static const struct {
    double elevation, rgb[3];
} gradient[] = {{-90, {.26, .26, .27}}, {-35, {.32, .32, .335}}, {-14, {.50, .50, .52}},
                {-3, {.80, .81, .83}},  {6, {.90, .92, .95}},    {20, {.62, .66, .72}},
                {45, {.20, .22, .26}},  {90, {.10, .11, .14}}};

/* Light boxes: the middle and half size in degrees, and the width of the soft edge. A box with repeat > 1
 * stands for that many boxes spaced evenly in azimuth. */
static const struct {
    double azimuth, elevation, half_width, half_height, edge, light;
    int repeat;
} boxes[] = {{0, 90, 1000, 20, 8, .8, 1}, {50, 43, 7, 23, 2, 4, 4}};

static double smooth_step(double from, double to, double x) {
    const double t = x <= from ? 0 : x >= to ? 1 : (x - from) / (to - from);
    return t * t * (3 - 2 * t);
}

/* Returns how much of the light of box i arrives from a direction, 0 .. 1. */
static double share_of_box(int i, double azimuth, double elevation) {
    const double turn = 360.0 / boxes[i].repeat, from_first = azimuth - boxes[i].azimuth;
    const double across = fabs(from_first - turn * floor(from_first / turn + 0.5)),
                 along = fabs(elevation - boxes[i].elevation), edge = boxes[i].edge;
    return (1 - smooth_step(boxes[i].half_width - edge, boxes[i].half_width + edge, across)) *
           (1 - smooth_step(boxes[i].half_height - edge, boxes[i].half_height + edge, along));
}

static void studio_light(double azimuth, double elevation, float rgb[3]) {
    enum { ROWS = sizeof gradient / sizeof *gradient, BOXES = sizeof boxes / sizeof *boxes };
    int row = 0;
    while (row < ROWS - 2 && elevation > gradient[row + 1].elevation) row++;
    const double t =
        (elevation - gradient[row].elevation) / (gradient[row + 1].elevation - gradient[row].elevation);
    for (int k = 0; k < 3; k++) {
        double light = gradient[row].rgb[k] * (1 - t) + gradient[row + 1].rgb[k] * t;
        for (int i = 0; i < BOXES; i++) light += share_of_box(i, azimuth, elevation) * boxes[i].light;
        rgb[k] = (float)light;
    }
}

iso_status iso_environment_studio(iso_environment **environment, iso_error *error) {
    enum { WIDTH = 1024, HEIGHT = 512 };
    iso_float_image picture = {0};
    ISO_TRY(make_picture(WIDTH, HEIGHT, &picture, error));
    for (int y = 0; y < HEIGHT; y++)
        for (int x = 0; x < WIDTH; x++)
            studio_light((x + 0.5) * 360 / WIDTH - 180, 90 - (y + 0.5) * 180 / HEIGHT,
                         picture.rgb + 3 * ((ptrdiff_t)y * WIDTH + x));
    return make(&picture, environment, error);
}

/* ---- looking */

void iso_environment_look(const iso_environment *environment, iso_vec3 direction, double rgb[3]) {
    const int width = environment->picture.width, height = environment->picture.height;
    const double x = iso_vec3_dot(direction, environment->right),
                 y = iso_vec3_dot(direction, environment->front),
                 z = iso_vec3_dot(direction, environment->up);
    const double column = (0.5 + iso_atan2(x, y) / (2 * ISO_PI)) * width - 0.5,
                 row = iso_atan2(sqrt(x * x + y * y), z) / ISO_PI * height - 0.5;
    const double left = floor(column), top = fmin(fmax(floor(row), 0), height - 2);
    const double u = column - left, v = fmin(fmax(row - top, 0), 1);
    const int x0 = ((int)left + width) % width, x1 = (x0 + 1) % width;
    const float *upper = environment->picture.rgb + 3 * (ptrdiff_t)top * width, *lower = upper + 3 * width;
    for (int k = 0; k < 3; k++)
        rgb[k] = ((double)upper[3 * x0 + k] * (1 - u) + (double)upper[3 * x1 + k] * u) * (1 - v) +
                 ((double)lower[3 * x0 + k] * (1 - u) + (double)lower[3 * x1 + k] * u) * v;
}
