/* flip: LDR-FLIP in bands of rows. Numbers of sections, tables and equations, and the symbols, are those of
 * Andersson et al. 2020 (compare/flip.h). */
#include "compare/flip.h"

#include <math.h>

#include "base/geometry.h"
#include "base/memory.h"
#include "compare/filter.h"

/* q_c, p_c, p_t of section 4.1.3; q_f and w (peak to trough, degrees) of section 4.2. */
static const double COLOR_EXPONENT = 0.7, COLOR_CUT = 0.4, COLOR_CUT_VALUE = 0.95;
static const double FEATURE_EXPONENT = 0.5, FEATURE_WIDTH = 0.082;

/* Contrast sensitivity, table 1: sums of a sqrt(pi / b) exp(-pi^2 d^2 / b), d in degrees. */
enum { GAUSSIANS = 4 };
static const struct sensitivity {
    int channel;
    double a, b;
} SENSITIVITIES[GAUSSIANS] = {{0, 1, 0.0047}, {1, 1, 0.0053}, {2, 34.1, 0.04}, {2, 13.5, 0.025}};

/* The matrix from linear sRGB to XYZ (white point D65), computed exactly from the chromaticities of sRGB's
 * primaries. */
static const double TO_XYZ[9] = {10135552.0 / 24577794, 8788810.0 / 24577794, 4435075.0 / 24577794,
                                 2613072.0 / 12288897,  8788810.0 / 12288897, 887015.0 / 12288897,
                                 1425312.0 / 73733382,  8788810.0 / 73733382, 70074185.0 / 73733382};

typedef struct flip {
    const uint8_t *picture[2];
    int width, height, halo;
    float linear[256];   /* display value to linear light */
    float to_white[9];   /* linear RGB to XYZ / white */
    float from_white[9]; /* its inverse */
    float color_max;     /* the largest possible HyAB difference, to the power q_c */
    iso_kernel along[GAUSSIANS],
        down[GAUSSIANS];            /* contrast sensitivity: along rows; along columns, weighted */
    iso_kernel smooth, edge, point; /* feature detectors: the Gaussian, its first and its second derivative */
    float *map;
    float *scratch; /* per worker */
    size_t scratch_floats;
    double *sums; /* per band */
} flip;

/* ---- setting up ---- */

static float lab_f(float t) { /* f of CIE L*a*b* */
    const float delta = 6.0f / 29;
    return t > delta * delta * delta ? cbrtf(t) : t / (3 * delta * delta) + 4.0f / 29;
}

static void multiply(const float m[9], const float v[3], float out[3]) {
    for (int i = 0; i < 3; i++) out[i] = m[3 * i] * v[0] + m[3 * i + 1] * v[1] + m[3 * i + 2] * v[2];
}

/* Hunt-adjusted L*a*b* of a linear colour (eq. 3). */
static void to_hunt_lab(const flip *f, const float rgb[3], float out[3]) {
    float xyz[3], root[3];
    multiply(f->to_white, rgb, xyz);
    for (int i = 0; i < 3; i++) root[i] = lab_f(xyz[i]);
    out[0] = 116 * root[1] - 16;
    out[1] = 0.01f * out[0] * 500 * (root[0] - root[1]);
    out[2] = 0.01f * out[0] * 200 * (root[1] - root[2]);
}

static float hyab(const float a[3], const float b[3]) {
    float da = a[1] - b[1], db = a[2] - b[2];
    return fabsf(a[0] - b[0]) + sqrtf(da * da + db * db);
}

static void set_colors(flip *f) {
    for (int i = 0; i < 256; i++) {
        double v = i / 255.0;
        f->linear[i] = (float)(v > 0.04045 ? pow((v + 0.055) / 1.055, 2.4) : v / 12.92);
    }
    iso_transform transform = iso_transform_identity();
    for (int row = 0; row < 3; row++) {
        double white = TO_XYZ[3 * row] + TO_XYZ[3 * row + 1] + TO_XYZ[3 * row + 2];
        for (int i = 0; i < 3; i++) transform.direction[3 * row + i] = TO_XYZ[3 * row + i] / white;
    }
    iso_affine affine = iso_transform_affine(&transform);
    for (int i = 0; i < 9; i++) {
        f->to_white[i] = (float)affine.m[i];
        f->from_white[i] = (float)affine.inverse[i];
    }
    const float green[3] = {0, 1, 0}, blue[3] = {0, 0, 1};
    float lab[2][3];
    to_hunt_lab(f, green, lab[0]);
    to_hunt_lab(f, blue, lab[1]);
    f->color_max = powf(hyab(lab[0], lab[1]), (float)COLOR_EXPONENT);
}

/* Sets the kernels of contrast sensitivity. A channel's Gaussians are weighted so that their sum over the
 * plane is 1; all have the radius that the widest needs. */
static void set_sensitivities(flip *f, double pixels_per_degree) {
    double widest = 0, weight[GAUSSIANS], total[3] = {0, 0, 0};
    for (int g = 0; g < GAUSSIANS; g++) widest = fmax(widest, SENSITIVITIES[g].b);
    int radius = (int)ceil(3 * sqrt(widest / (2 * ISO_PI * ISO_PI)) * pixels_per_degree);
    for (int g = 0; g < GAUSSIANS; g++) {
        const struct sensitivity *s = &SENSITIVITIES[g];
        double sigma = sqrt(s->b / (2 * ISO_PI * ISO_PI)) * pixels_per_degree;
        f->along[g] = iso_kernel_gaussian(sigma, radius, 1);
        double across = 1 / (double)f->along[g].taps[radius]; /* sum of the taps if the middle tap were 1 */
        weight[g] = s->a * sqrt(ISO_PI / s->b) * across * across;
        total[s->channel] += weight[g];
    }
    for (int g = 0; g < GAUSSIANS; g++) {
        f->down[g] = f->along[g];
        for (int k = 0; k <= 2 * radius; k++)
            f->down[g].taps[k] *= (float)(weight[g] / total[SENSITIVITIES[g].channel]);
    }
}

/* Scales the positive taps so that their sum is 1, and the negative ones so that theirs is -1. */
static void normalize_signs(iso_kernel *kernel) {
    double above = 0, below = 0;
    for (int k = 0; k <= 2 * kernel->radius; k++) {
        float tap = kernel->taps[k];
        above += tap > 0 ? (double)tap : 0;
        below -= tap < 0 ? (double)tap : 0;
    }
    for (int k = 0; k <= 2 * kernel->radius; k++)
        kernel->taps[k] = (float)((double)kernel->taps[k] / (kernel->taps[k] > 0 ? above : below));
}

/* Sets the feature detectors (section 4.2): first and second derivatives of a Gaussian. */
static void set_features(flip *f, double pixels_per_degree) {
    double sigma = 0.5 * FEATURE_WIDTH * pixels_per_degree;
    int radius = (int)ceil(3 * sigma);
    f->smooth = f->edge = f->point = iso_kernel_gaussian(sigma, radius, 1);
    for (int k = -radius; k <= radius; k++) {
        f->edge.taps[radius + k] *= (float)-k;
        f->point.taps[radius + k] *= (float)(k * k / (sigma * sigma) - 1);
    }
    normalize_signs(&f->edge);
    normalize_signs(&f->point);
    f->halo = radius > f->along[0].radius ? radius : f->along[0].radius;
}

/* ---- one band ---- */

/* One worker's image planes for a band of rows. Planes marked "tall" also have the rows above and below the
 * band that the filters read. */
typedef struct planes {
    float *opponent[3], *along, *padded;      /* with the rows above and below the band */
    float *seen[2][3], *feature[2][2], *part; /* with the band's rows only */
} planes;

static int tall_rows(const flip *f) {
    return ISO_COMPARE_BAND + 2 * f->halo;
}

static size_t planes_floats(const flip *f) {
    size_t width = (size_t)f->width;
    return width * (4 * (size_t)tall_rows(f) + 11 * ISO_COMPARE_BAND) + width + 2 * (size_t)f->halo;
}

static planes planes_of(const flip *f, int worker) {
    float *at = f->scratch + (size_t)worker * f->scratch_floats;
    size_t tall = (size_t)f->width * (size_t)tall_rows(f), band = (size_t)f->width * ISO_COMPARE_BAND;
    planes p;
    for (int c = 0; c < 3; c++, at += tall) p.opponent[c] = at;
    p.along = at;
    at += tall;
    for (int side = 0; side < 2; side++) {
        for (int c = 0; c < 3; c++, at += band) p.seen[side][c] = at;
        for (int i = 0; i < 2; i++, at += band) p.feature[side][i] = at;
    }
    p.part = at;
    p.padded = at + band;
    return p;
}

/* Converts rows y0 - halo .. y0 + rows + halo - 1 of a picture to the opponent space YCxCz (section 4.1.1).
 */
static void fill_opponent(const flip *f, int side, int y0, int rows, const planes *p) {
    for (int row = 0; row < rows + 2 * f->halo; row++) {
        int y = y0 + row - f->halo;
        y = y < 0 ? 0 : y < f->height ? y : f->height - 1;
        const uint8_t *rgb = f->picture[side] + (size_t)y * (size_t)f->width * 3;
        size_t first = (size_t)row * (size_t)f->width;
        for (int x = 0; x < f->width; x++) {
            const float color[3] = {f->linear[rgb[3 * x]], f->linear[rgb[3 * x + 1]],
                                    f->linear[rgb[3 * x + 2]]};
            float xyz[3];
            multiply(f->to_white, color, xyz);
            p->opponent[0][first + (size_t)x] = 116 * xyz[1] - 16;
            p->opponent[1][first + (size_t)x] = 500 * (xyz[0] - xyz[1]);
            p->opponent[2][first + (size_t)x] = 200 * (xyz[1] - xyz[2]);
        }
    }
}

/* Convolves a tall plane with `along` in x and `down` in y; `out` gets the band's rows. */
static void filter_plane(const flip *f, const planes *p, const float *in, const iso_kernel *along,
                         const iso_kernel *down, int rows, float *out) {
    in += (size_t)(f->halo - down->radius) * (size_t)f->width;
    iso_filter_rows(along, in, f->width, rows + 2 * down->radius, p->padded, p->along);
    iso_filter_columns(down, p->along, f->width, rows, out);
}

/* Filters a picture as the eye does: each channel by its contrast sensitivity, then clamped to the colours
 * that a screen can show. Writes the result in Hunt-adjusted L*a*b* to p->seen[side]. */
static void filter_picture(const flip *f, int side, int rows, const planes *p) {
    size_t count = (size_t)f->width * (size_t)rows;
    float *const *seen = p->seen[side];
    for (int g = 0; g < GAUSSIANS; g++) {
        int channel = SENSITIVITIES[g].channel;
        bool first = g == 0 || SENSITIVITIES[g - 1].channel != channel;
        float *out = first ? seen[channel] : p->part;
        filter_plane(f, p, p->opponent[channel], &f->along[g], &f->down[g], rows, out);
        for (size_t i = 0; !first && i < count; i++) seen[channel][i] += out[i];
    }
    for (size_t i = 0; i < count; i++) {
        float y = (seen[0][i] + 16) / 116, rgb[3], lab[3];
        const float xyz[3] = {y + seen[1][i] / 500, y, y - seen[2][i] / 200};
        multiply(f->from_white, xyz, rgb);
        for (int c = 0; c < 3; c++) rgb[c] = rgb[c] < 0 ? 0 : rgb[c] > 1 ? 1 : rgb[c];
        to_hunt_lab(f, rgb, lab);
        for (int c = 0; c < 3; c++) seen[c][i] = lab[c];
    }
}

/* Computes the strength of edges and of points in the luminance, 0 .. 1, in p->feature[side]. */
static void detect_features(const flip *f, int side, int rows, const planes *p) {
    const iso_kernel *kernels[2] = {&f->edge, &f->point};
    size_t count = (size_t)f->width * (size_t)rows;
    for (int i = 0; i < 2; i++) {
        float *strength = p->feature[side][i];
        filter_plane(f, p, p->opponent[0], kernels[i], &f->smooth, rows, strength);
        filter_plane(f, p, p->opponent[0], &f->smooth, kernels[i], rows, p->part);
        for (size_t k = 0; k < count; k++)
            strength[k] = sqrtf(strength[k] * strength[k] + p->part[k] * p->part[k]) / 116;
    }
}

/* Eq. 4: maps a colour difference to 0 .. 1. Differences up to p_c times the largest one are mapped to 0 ..
 * p_t. */
static float redistribute(const flip *f, float difference) {
    float power = powf(difference, (float)COLOR_EXPONENT);
    float cut = (float)COLOR_CUT * f->color_max, value = (float)COLOR_CUT_VALUE;
    return power < cut ? value / cut * power : value + (power - cut) / (f->color_max - cut) * (1 - value);
}

/* Returns the difference of pixel i (eq. 7). */
static float difference_at(const flip *f, const planes *p, size_t i) {
    const float a[3] = {p->seen[0][0][i], p->seen[0][1][i], p->seen[0][2][i]};
    const float b[3] = {p->seen[1][0][i], p->seen[1][1][i], p->seen[1][2][i]};
    float edges = fabsf(p->feature[0][0][i] - p->feature[1][0][i]);
    float points = fabsf(p->feature[0][1][i] - p->feature[1][1][i]);
    float feature = powf(fmaxf(edges, points) / sqrtf(2), (float)FEATURE_EXPONENT);
    return powf(redistribute(f, hyab(a, b)), 1 - feature);
}

static void compare_band(void *context, size_t index, int worker) {
    const flip *f = context;
    int y0 = (int)index * ISO_COMPARE_BAND;
    int rows = f->height - y0 < ISO_COMPARE_BAND ? f->height - y0 : ISO_COMPARE_BAND;
    planes p = planes_of(f, worker);
    for (int side = 0; side < 2; side++) {
        fill_opponent(f, side, y0, rows, &p);
        filter_picture(f, side, rows, &p);
        detect_features(f, side, rows, &p);
    }
    size_t first = (size_t)y0 * (size_t)f->width, count = (size_t)rows * (size_t)f->width;
    double sum = 0;
    for (size_t i = 0; i < count; i++) {
        float difference = difference_at(f, &p, i);
        if (f->map) f->map[first + i] = difference;
        sum += (double)difference;
    }
    f->sums[index] = sum;
}

/* ---- the whole picture ---- */

static iso_status compare_bands(flip *f, iso_pool *pool, double *mean, iso_error *error) {
    size_t bands = iso_compare_bands(f->height);
    f->scratch_floats = planes_floats(f);
    f->scratch = iso_alloc((size_t)iso_pool_threads(pool) * f->scratch_floats * sizeof *f->scratch);
    f->sums = iso_alloc(bands * sizeof *f->sums);
    iso_status status = ISO_OK;
    if (f->scratch && f->sums) {
        iso_parallel_for(pool, bands, compare_band, f);
        double sum = 0;
        for (size_t i = 0; i < bands; i++) sum += f->sums[i];
        *mean = sum / ((double)f->width * f->height);
    } else {
        status = iso_fail(error, ISO_ERR_NOMEM, "out of memory for FLIP");
    }
    iso_free(f->scratch);
    iso_free(f->sums);
    return status;
}

iso_status iso_flip(const uint8_t *reference, const uint8_t *test, const int size[2],
                    const iso_flip_opts *opts, double *mean, iso_error *error) {
    double density = opts->pixels_per_degree ? opts->pixels_per_degree : ISO_FLIP_PIXELS_PER_DEGREE;
    if (!(density >= 1 && density <= ISO_FLIP_PIXELS_PER_DEGREE_MAX))
        return iso_fail(error, ISO_ERR_USAGE, "%g pixels per degree: must be 1 to %g", density,
                        ISO_FLIP_PIXELS_PER_DEGREE_MAX);
    flip *f = iso_alloc_zero(1, sizeof *f);
    if (!f) return iso_fail(error, ISO_ERR_NOMEM, "out of memory for FLIP");
    f->picture[0] = reference;
    f->picture[1] = test;
    f->width = size[0];
    f->height = size[1];
    f->map = opts->map;
    set_colors(f);
    set_sensitivities(f, density);
    set_features(f, density);
    iso_status status = compare_bands(f, opts->pool, mean, error);
    iso_free(f);
    return status;
}
