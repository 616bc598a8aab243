/* scene_ct: an artificial CT of a skull with the properties that make extraction hard: thin porous bone,
 * partial volume, noise.
 *
 * An ellipsoidal head in the cube [-1, 1]^3: air 8, soft tissue 60, brain 75, bone 190. The skull wall has
 * gyroid pores (diploe), and the lower front consists of gyroid sheets (facial bone). The noise is white
 * noise filtered by a binomial [1 2 1]/4 along each axis, which resembles the reconstruction kernel of a
 * scanner. */
#include "base/memory.h"
#include "base/numbers.h"
#include "grids/scenes/scene_parts.h"

/* The volume is computed in beams of BEAM x BEAM rows, so that the noise for one fits into the cache. */
enum { BEAM = 16, HALO = BEAM + 2 };

/* Sines of one frequency at the voxels of an axis; all three axes use the same. */
typedef struct wave {
    float *sine, *cosine;
} wave;

typedef struct ct {
    int size, beams; /* number of beams along y, and along z */
    float noise;     /* factor of the noise; 0: none */
    float edge;      /* half width of a smoothed step, in the units of the cube */
    float pore_edge, sheet_edge;
    wave pores, sheets;
    float *wobble[3]; /* deformation of the skull wall: a product of three sines */
    float *scratch;   /* noise_bytes for each worker */
    size_t scratch_floats;
    uint8_t *voxels;
} ct;

static uint32_t hash(uint32_t x) {
    x ^= x >> 16;
    x *= 0x7feb352dU;
    x ^= x >> 15;
    x *= 0x846ca68bU;
    return x ^ x >> 16;
}

/* Computes a row of white noise, uniform in [-1/2, 1/2), smoothed along x. */
static void noise_row(int size, int y, int z, float *raw, float *out) {
    uint32_t row = hash((uint32_t)y * 19349663U ^ hash((uint32_t)z * 83492791U));
    for (int x = 0; x < size; x++) {
        uint32_t h = hash((uint32_t)x * 73856093U ^ row);
        raw[x + 1] = (float)(h >> 8) * (1.0f / 16777216.0f) - 0.5f;
    }
    raw[0] = raw[1];
    raw[size + 1] = raw[size];
    for (int x = 0; x < size; x++) out[x] = 0.25f * raw[x] + 0.5f * raw[x + 1] + 0.25f * raw[x + 2];
}

static void smooth_rows(int size, const float *a, const float *b, const float *c, float *out) {
    for (int x = 0; x < size; x++) out[x] = 0.25f * a[x] + 0.5f * b[x] + 0.25f * c[x];
}

/* Computes noise smoothed along x and y for rows y0 .. y0 + BEAM - 1 of slices z0 - 1 .. z0 + BEAM; row j of
 * slice k is at (k * BEAM + j) * size. Beyond the border the last slice or row is repeated. */
static float *noise_beam(const ct *scene, int y0, int z0, float *scratch) {
    int n = scene->size;
    float *raw = scratch, *slice = raw + n + 2, *smooth = slice + (size_t)HALO * (size_t)n;
    for (int k = 0; k < HALO; k++) {
        int z = iso_clamp_index(z0 - 1 + k, n);
        for (int j = 0; j < HALO; j++)
            noise_row(n, iso_clamp_index(y0 - 1 + j, n), z, raw, slice + (size_t)j * (size_t)n);
        for (int j = 0; j < BEAM; j++) {
            const float *row = slice + (size_t)j * (size_t)n;
            smooth_rows(n, row, row + n, row + 2 * n, smooth + (size_t)(k * BEAM + j) * (size_t)n);
        }
    }
    return smooth;
}

static inline float smooth_step(float middle, float half_width, float x) {
    float t = (x - (middle - half_width)) / (2 * half_width);
    t = t < 0 ? 0 : t > 1 ? 1 : t;
    return t * t * (3 - 2 * t);
}

static inline float gyroid(const wave *w, int x, int y, int z) {
    return w->sine[x] * w->cosine[y] + w->sine[y] * w->cosine[z] + w->sine[z] * w->cosine[x];
}

static inline float position(const ct *scene, int i) {
    return 2 * ((float)i + 0.5f) / (float)scene->size - 1;
}

/* Returns the amount of bone in the facial sheets at a voxel, where `mask` (0 .. 1: how far the voxel belongs
 * to the lower front) is not 0. */
static float sheets_at(const ct *scene, float mask, int x, int y, int z) {
    float g = fabsf(gyroid(&scene->sheets, x, y, z));
    return mask * (1 - smooth_step(0.25f, scene->sheet_edge, g));
}

static float bone_at(const ct *scene, float r, float outer, float inner, const int v[3]) {
    float e = scene->edge, bone = 0;
    if (r < outer + e && r > inner - e) {
        bone = (1 - smooth_step(outer, e, r)) * smooth_step(inner, e, r);
        float pore = (1 - smooth_step(outer - 0.02f, e, r)) * smooth_step(inner + 0.02f, e, r);
        if (pore > 0) {
            float half = 0.5f * scene->pore_edge;
            bone *= 1 - 0.8f * pore * smooth_step(0.2f + half, half, gyroid(&scene->pores, v[0], v[1], v[2]));
        }
    }
    return bone;
}

typedef struct ct_row {
    float squares; /* the y and z terms of r^2, which is 1 at the skin */
    float wobble;  /* product of the y and z sines */
    float front;   /* 0 .. 1: how far the row belongs to the lower front */
} ct_row;

static float tissue(const ct *scene, const ct_row *row, const int v[3]) {
    float x = position(scene, v[0]), e = scene->edge;
    float r = sqrtf(x * x / (0.80f * 0.80f) + row->squares);
    if (r >= 1 + e) return 8;
    float wobble = row->wobble * scene->wobble[0][v[0]];
    float outer = 0.92f + wobble, inner = 0.80f + 1.5f * wobble;
    float bone = bone_at(scene, r, outer, inner, v);
    if (row->front > 0 && r < inner - 0.05f + e) {
        float mask = row->front * (1 - smooth_step(inner - 0.05f, e, r));
        float sheet = sheets_at(scene, mask, v[0], v[1], v[2]);
        if (sheet > bone) bone = sheet;
    }
    float value = 8 + 52 * (1 - smooth_step(1, e, r)) + 135 * bone;
    return r < inner ? value + 15 * (1 - bone) : value;
}

static void ct_line(const ct *scene, int y, int z, const float *noise, uint8_t *out) {
    float py = position(scene, y), pz = position(scene, z);
    ct_row row = {.squares = py * py / (0.90f * 0.90f) + pz * pz / (0.86f * 0.86f),
                  .wobble = 0.02f * scene->wobble[1][y] * scene->wobble[2][z],
                  .front = smooth_step(0.15f, 0.05f, -py) * smooth_step(-0.05f, 0.05f, -pz - 0.1f)};
    for (int x = 0; x < scene->size; x++) {
        const int v[3] = {x, y, z};
        float value = tissue(scene, &row, v);
        if (noise) value += scene->noise * noise[x];
        value = value < 0 ? 0 : value > 255 ? 255 : value;
        out[x] = (uint8_t)(value + 0.5f);
    }
}

static void ct_beam(void *context, size_t index, int worker) {
    const ct *scene = context;
    int n = scene->size, y0 = (int)(index % (size_t)scene->beams) * BEAM;
    int z0 = (int)(index / (size_t)scene->beams) * BEAM;
    float *scratch = scene->scratch + (size_t)worker * scene->scratch_floats, *smooth = NULL;
    if (scene->noise > 0) smooth = noise_beam(scene, y0, z0, scratch);
    size_t slice = (size_t)BEAM * (size_t)n;
    for (int k = 0; k < BEAM && z0 + k < n; k++)
        for (int j = 0; j < BEAM && y0 + j < n; j++) {
            if (smooth) {
                const float *below = smooth + (size_t)k * slice + (size_t)j * (size_t)n;
                smooth_rows(n, below, below + slice, below + 2 * slice, scratch);
            }
            size_t row = (size_t)(z0 + k) * (size_t)n + (size_t)(y0 + j);
            ct_line(scene, y0 + j, z0 + k, smooth ? scratch : NULL, scene->voxels + row * (size_t)n);
        }
}

/* Writes `size` sines of rate * position + phase, and cosines unless their pointer is NULL. */
static void fill_wave(int size, double rate, double phase, float *sine, float *cosine) {
    for (int i = 0; i < size; i++) {
        double s, c;
        iso_sincos(rate * (2 * (i + 0.5) / size - 1) + phase, &s, &c);
        sine[i] = (float)s;
        if (cosine) cosine[i] = (float)c;
    }
}

static void prepare(ct *scene, const iso_scene_opts *opts, float *tables) {
    int n = scene->size;
    float *table[7];
    for (int i = 0; i < 7; i++) table[i] = tables + (size_t)i * (size_t)n;
    double pores = opts->detail > 0 ? opts->detail : 29, sheets = 0.8 * pores;
    double deviation = opts->noise < 0 ? 0 : opts->noise == 0 ? 5 : opts->noise;
    /* Uniform noise has variance 1/12; each smoothing leaves 1/16 + 1/4 + 1/16 = 3/8 of it. */
    scene->noise = (float)(deviation / sqrt(3.0 / 8 * 3 / 8 * 3 / 8 / 12));
    scene->edge = (float)(2.0 / n * 1.2);
    scene->pore_edge = (float)(1.5 * pores) * scene->edge;
    scene->sheet_edge = (float)sheets * scene->edge;
    scene->pores = (wave){table[0], table[1]};
    scene->sheets = (wave){table[2], table[3]};
    fill_wave(n, pores, 0, table[0], table[1]);
    fill_wave(n, sheets, 0, table[2], table[3]);
    for (int axis = 0; axis < 3; axis++) {
        scene->wobble[axis] = table[4 + axis];
        fill_wave(n, 9 - axis, axis, table[4 + axis], NULL);
    }
}

iso_status iso_scene_ct(const iso_scene_opts *opts, iso_grid *grid, iso_error *error) {
    size_t n = (size_t)opts->size;
    ct scene = {.size = opts->size, .beams = (opts->size - 1) / BEAM + 1};
    scene.scratch_floats = n + 2 + (HALO + HALO * BEAM) * n;
    scene.scratch = iso_alloc((size_t)iso_pool_threads(opts->pool) * scene.scratch_floats * sizeof(float));
    float *tables = iso_alloc(7 * n * sizeof *tables);
    iso_rgrid_desc desc = {.dims = {opts->size, opts->size, opts->size}, .type = ISO_UINT8};
    iso_status status = scene.scratch && tables
                            ? iso_rgrid_create(&desc, &grid->rgrid, error)
                            : iso_fail(error, ISO_ERR_NOMEM, "out of memory for the scene 'ct'");
    if (status == ISO_OK) {
        prepare(&scene, opts, tables);
        scene.voxels = grid->rgrid->data;
        iso_parallel_for(opts->pool, (size_t)scene.beams * (size_t)scene.beams, ct_beam, &scene);
    }
    iso_free(scene.scratch);
    iso_free(tables);
    return status;
}
