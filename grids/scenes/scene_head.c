/* scene_head: nine smoothly united balls with a fine gyroid relief, as a signed distance field. It replaces
 * the sculpted head of Baerentzen and Christensen 2003, table 2.
 *
 * The field f is a Lipschitz function, not a distance. For each brick near its zero set, the surface is
 * sampled where grid edges cross it (one Newton step along the gradient from the linear crossing), every
 * voxel takes the nearest sample, and from there walks along the surface to its foot point: the tangent
 * plane's foot, projected back along the gradient, taken only when that is nearer. Since the walk starts at
 * the globally nearest sample, it ends at the nearest of several foot points also where the relief is finer
 * than the band is wide. */

#include "base/memory.h"
#include "grids/scenes/scene_parts.h"

/* A brick is computed in a window that extends REACH voxels beyond it: 3 for the band and 1 for an edge. */
enum { REACH = 4, WINDOW = ISO_BRICK + 2 * REACH, BLOCK = 4 };
enum { WINDOW_VOXELS = WINDOW * WINDOW * WINDOW, SAMPLES = 3 * WINDOW * WINDOW * (WINDOW - 1) };
enum { STEPS = 4, BALLS = 9 };

/* Centre and radius in the cube [-1, 1]^3. */
static const double balls[BALLS][4] = {
    {0, 0, 0.12, 0.56},        {0, -0.12, -0.25, 0.44},    {0, -0.52, -0.12, 0.13},
    {0, -0.42, -0.55, 0.22},   {0.34, -0.12, -0.15, 0.26}, {-0.34, -0.12, -0.15, 0.26},
    {0.62, 0.05, -0.05, 0.13}, {-0.62, 0.05, -0.05, 0.13}, {0, 0.05, -0.75, 0.24},
};
static const double lift = 0.07;       /* offset of the whole head along z */
static const double softness = 0.12;   /* width of the transitions in the smooth union */
static const double frequency = 70;    /* frequency of the relief */
static const double amplitude = 0.012; /* amplitude of the relief; its gyroid is in -1.5 .. 1.5 */
static const double relief = 0.012 * 1.5;
/* a bound of the field's gradient: that of the union of balls is at most 1, and that of the gyroid at most
 * sqrt(3) */
static const double lipschitz = 1 + 0.012 * 70 * 1.7320508075688774;

typedef struct head {
    int size;
    double voxel;   /* size of a voxel in the cube [-1, 1]^3 */
    double *sines;  /* of frequency * coordinate; (sine, cosine) for voxels -REACH and up */
    double *lifted; /* the same for z */
} head;

/* The balls that can affect the field near a brick. */
typedef struct choice {
    int count, ball[BALLS];
} choice;

/* A value of the field and its gradient; the value is in voxels in the functions of bricks. */
typedef struct field {
    double value;
    iso_vec3 gradient;
} field;

typedef struct scratch {
    float value[WINDOW_VOXELS];
    float nearest[ISO_BRICK_VOXELS]; /* squared distance, voxels */
    int32_t which[ISO_BRICK_VOXELS];
    float sample[SAMPLES][3]; /* window coordinates */
    int count;
} scratch;

static double coordinate(const head *h, double voxel) {
    return (voxel + 0.5) * h->voxel - 1;
}

static double ball_distance(int ball, iso_vec3 p) {
    const double *b = balls[ball];
    double x = p.x - b[0], y = p.y - b[1], z = p.z - b[2];
    return sqrt(x * x + y * y + z * z) - b[3];
}

/* Returns the smooth minimum of two distances: a quadratic blend, which equals the minimum where they differ
 * by more than `softness`. */
static double unite(double a, double b) {
    double apart = fabs(a - b), least = a < b ? a : b;
    if (apart >= softness) return least;
    double h = (softness - apart) / softness;
    return least - h * h * softness * 0.25;
}

static double balls_value(const choice *c, iso_vec3 p) {
    double value = ball_distance(c->ball[0], p);
    for (int i = 1; i < c->count; i++) value = unite(value, ball_distance(c->ball[i], p));
    return value;
}

static field balls_field(const choice *c, iso_vec3 p) {
    field united = {0};
    for (int i = 0; i < c->count; i++) {
        const double *b = balls[c->ball[i]];
        iso_vec3 from = iso_vec3_make(p.x - b[0], p.y - b[1], p.z - b[2]);
        double length = iso_vec3_length(from);
        field ball = {length - b[3], iso_vec3_scale(from, length > 0 ? 1 / length : 0)};
        double apart = fabs(united.value - ball.value);
        if (i == 0 || (apart >= softness && ball.value < united.value)) {
            united = ball;
        } else if (apart < softness) {
            double share = (softness - apart) / softness * 0.5; /* weight of the gradient of the ball that is
                                                                   farther away */
            if (ball.value < united.value) share = 1 - share;
            united.gradient = iso_vec3_add(iso_vec3_scale(united.gradient, 1 - share),
                                           iso_vec3_scale(ball.gradient, share));
            united.value = unite(united.value, ball.value);
        }
    }
    return united;
}

/* Sine and cosine by Taylor series after reduction to |x| <= pi/4; |angle| below 1000, error below 1e-10.
 * Much faster than iso_sincos, whose precision is not needed here. */
static inline void quick_sincos(double angle, double *sine, double *cosine) {
    double turns = angle * (2 / ISO_PI);
    int quadrant = (int)(turns + (turns < 0 ? -0.5 : 0.5));
    double x = angle - quadrant * (ISO_PI / 2), q = x * x;
    double s =
        x * (1 + q * (-1.0 / 6 +
                      q * (1.0 / 120 + q * (-1.0 / 5040 + q * (1.0 / 362880 + q * (-1.0 / 39916800))))));
    double c =
        1 + q * (-1.0 / 2 +
                 q * (1.0 / 24 +
                      q * (-1.0 / 720 + q * (1.0 / 40320 + q * (-1.0 / 3628800 + q * (1.0 / 479001600))))));
    double swapped_s = quadrant & 1 ? c : s, swapped_c = quadrant & 1 ? s : c;
    *sine = quadrant & 2 ? -swapped_s : swapped_s;
    *cosine = (quadrant + 1) & 2 ? -swapped_c : swapped_c;
}

/* Returns the field at a position in voxels. */
static field field_at(const head *h, const choice *c, iso_vec3 voxel) {
    iso_vec3 p = iso_vec3_make(coordinate(h, voxel.x), coordinate(h, voxel.y), coordinate(h, voxel.z) - lift);
    double sx, cx, sy, cy, sz, cz;
    quick_sincos(frequency * p.x, &sx, &cx);
    quick_sincos(frequency * p.y, &sy, &cy);
    quick_sincos(frequency * p.z, &sz, &cz);
    field f = balls_field(c, p);
    f.value = (f.value + amplitude * (sx * cy + sy * cz + sz * cx)) / h->voxel;
    const double slope = amplitude * frequency;
    f.gradient.x += slope * (cx * cy - sz * sx);
    f.gradient.y += slope * (cy * cz - sx * sy);
    f.gradient.z += slope * (cz * cx - sy * sz);
    return f;
}

/* Returns the value of the field at a voxel, computed from tables, without the gradient. */
static double value_at(const head *h, const choice *c, const int v[3]) {
    const double *x = h->sines + 2 * (v[0] + REACH), *y = h->sines + 2 * (v[1] + REACH);
    const double *z = h->lifted + 2 * (v[2] + REACH);
    iso_vec3 p = iso_vec3_make(coordinate(h, v[0]), coordinate(h, v[1]), coordinate(h, v[2]) - lift);
    return (balls_value(c, p) + amplitude * (x[0] * y[1] + y[0] * z[1] + z[0] * x[1])) / h->voxel;
}

/* Chooses the balls that affect the field somewhere within `radius` of p. Within this radius each distance
 * changes by at most the radius, so differences of distances change by at most twice the radius. */
static choice choose_balls(iso_vec3 p, double radius) {
    choice c = {.count = 1};
    double value = ball_distance(0, p), margin = softness + 2 * radius;
    for (int ball = 1; ball < BALLS; ball++) {
        double d = ball_distance(ball, p);
        if (d >= value + margin) continue;
        if (value >= d + margin) c.count = 0;
        c.ball[c.count++] = ball;
        value = c.count == 1 ? d : unite(value, d);
    }
    return c;
}

static choice all_balls(void) {
    choice c = {.count = BALLS};
    for (int i = 0; i < BALLS; i++) c.ball[i] = i;
    return c;
}

/* Returns whether the field certainly has no zero within `voxels` voxels of a position where it has this
 * value (in voxels). */
static int no_zero(const head *h, double value, double voxels) {
    double without_relief = fabs(value) - 2 * relief / h->voxel; /* the relief can change the value both here
                                                                    and at the zero */
    return fabs(value) > lipschitz * voxels || without_relief > voxels;
}

static int32_t classify(const void *self, const int cell[3]) {
    const head *h = self;
    const double half_diagonal = 7.5 * 1.7320508075688774, slack = 0.01;
    choice c = all_balls();
    iso_vec3 middle =
        iso_vec3_make(cell[0] * ISO_BRICK + 7.5, cell[1] * ISO_BRICK + 7.5, cell[2] * ISO_BRICK + 7.5);
    double value = field_at(h, &c, middle).value;
    if (!no_zero(h, value, half_diagonal + ISO_SCENE_BAND + slack)) return 0;
    return value > 0 ? ISO_CELL_OUTSIDE : ISO_CELL_INSIDE;
}

static int window_index(int x, int y, int z) {
    return (z * WINDOW + y) * WINDOW + x;
}

/* Sets the values of one block of the window. If no edge that touches the block can cross the surface, all
 * get the same value, as only their sign is used. */
static void fill_block(const head *h, const choice *c, const int corner[3], const int at[3], float *value) {
    const double middle = (BLOCK - 1) / 2.0, reach = middle * 1.7320508075688774 + 1.01;
    iso_vec3 p =
        iso_vec3_make(corner[0] + at[0] + middle, corner[1] + at[1] + middle, corner[2] + at[2] + middle);
    double there = field_at(h, c, p).value;
    int far = no_zero(h, there, reach);
    for (int z = at[2]; z < at[2] + BLOCK; z++)
        for (int y = at[1]; y < at[1] + BLOCK; y++)
            for (int x = at[0]; x < at[0] + BLOCK; x++) {
                const int voxel[3] = {corner[0] + x, corner[1] + y, corner[2] + z};
                value[window_index(x, y, z)] = (float)(far ? there : value_at(h, c, voxel));
            }
}

static void fill_window(const head *h, const choice *c, const int corner[3], float *value) {
    int at[3];
    for (at[2] = 0; at[2] < WINDOW; at[2] += BLOCK)
        for (at[1] = 0; at[1] < WINDOW; at[1] += BLOCK)
            for (at[0] = 0; at[0] < WINDOW; at[0] += BLOCK) fill_block(h, c, corner, at, value);
}

static iso_vec3 in_volume(const int corner[3], const float local[3]) {
    return iso_vec3_make(corner[0] + (double)local[0], corner[1] + (double)local[1],
                         corner[2] + (double)local[2]);
}

static void add_sample(const head *h, const choice *c, const int corner[3], scratch *s,
                       const float crossing[3]) {
    float *sample = s->sample[s->count++];
    field f = field_at(h, c, in_volume(corner, crossing));
    double step = f.value / iso_vec3_dot(f.gradient, f.gradient);
    /* a step of more than half a voxel is not used: the gradient nearly vanishes here */
    if (!(fabs(step) * iso_vec3_length(f.gradient) < 0.5)) step = 0;
    sample[0] = crossing[0] - (float)(step * f.gradient.x);
    sample[1] = crossing[1] - (float)(step * f.gradient.y);
    sample[2] = crossing[2] - (float)(step * f.gradient.z);
}

/* Samples the surface on every edge of the window that it crosses. */
static void sample_edges(const head *h, const choice *c, const int corner[3], scratch *s) {
    s->count = 0;
    for (int z = 0; z < WINDOW; z++)
        for (int y = 0; y < WINDOW; y++)
            for (int x = 0; x < WINDOW; x++) {
                const int at[3] = {x, y, z};
                float low = s->value[window_index(x, y, z)];
                for (int axis = 0; axis < 3; axis++) {
                    if (at[axis] + 1 == WINDOW) continue;
                    float high = s->value[window_index(x + (axis == 0), y + (axis == 1), z + (axis == 2))];
                    if ((low < 0) == (high < 0)) continue;
                    float crossing[3] = {(float)x, (float)y, (float)z};
                    crossing[axis] += low / (low - high);
                    add_sample(h, c, corner, s, crossing);
                }
            }
}

/* Updates the nearest samples of the voxels near sample `index`, a row of 16 voxels at a time without
 * branches. */
static void scatter(scratch *s, int index) {
    const float *p = s->sample[index];
    int lo[3], hi[3];
    for (int axis = 0; axis < 3; axis++) {
        float local = p[axis] - REACH;
        lo[axis] = local > REACH ? (int)local + 1 - REACH : 0;
        hi[axis] = local + REACH < ISO_BRICK - 1 ? (int)(local + REACH) : ISO_BRICK - 1;
    }
    for (int z = lo[2]; z <= hi[2]; z++)
        for (int y = lo[1]; y <= hi[1]; y++) {
            float dy = (float)(y + REACH) - p[1], dz = (float)(z + REACH) - p[2], rest = dy * dy + dz * dz;
            float *nearest = s->nearest + (z * ISO_BRICK + y) * ISO_BRICK;
            int32_t *which = s->which + (z * ISO_BRICK + y) * ISO_BRICK;
            for (int x = 0; x < ISO_BRICK; x++) {
                float dx = (float)(x + REACH) - p[0], d = dx * dx + rest;
                int nearer = d < nearest[x];
                nearest[x] = nearer ? d : nearest[x];
                which[x] = nearer ? index : which[x];
            }
        }
}

/* Returns the distance from x to the surface: moves along the surface from the sample y towards the foot
 * point (all in voxels). */
static double walk(const head *h, const choice *c, iso_vec3 x, iso_vec3 y) {
    field f = field_at(h, c, y);
    double best = iso_vec3_length(iso_vec3_sub(x, y)), scale = 1;
    for (int i = 0; i < STEPS; i++) {
        iso_vec3 to = iso_vec3_sub(x, y);
        double square = iso_vec3_dot(f.gradient, f.gradient);
        if (!(square > 1e-6)) break;
        double along = (f.value + iso_vec3_dot(f.gradient, to)) / square;
        iso_vec3 move = iso_vec3_scale(iso_vec3_sub(to, iso_vec3_scale(f.gradient, along)), scale);
        double length = iso_vec3_length(move);
        if (length < 1e-3) break;
        if (length > 1) move = iso_vec3_scale(move, 1 / length);
        iso_vec3 q = iso_vec3_add(y, move);
        field g = field_at(h, c, q);
        double slope = iso_vec3_length(g.gradient), off = g.value / slope;
        iso_vec3 foot = iso_vec3_sub(q, iso_vec3_scale(g.gradient, off / slope));
        double distance = iso_vec3_length(iso_vec3_sub(x, foot));
        /* a long step back to the surface is not reliable: the gradient nearly vanishes here */
        if (distance < best && fabs(off) < 0.25 * iso_vec3_length(move)) {
            best = distance;
            y = foot;
            f = (field){0, g.gradient};
        } else {
            scale *= 0.5;
        }
    }
    return best;
}

static void fill_brick(const void *self, const int cell[3], void *memory, float *brick) {
    const head *h = self;
    scratch *s = memory;
    int corner[3];
    for (int axis = 0; axis < 3; axis++) corner[axis] = cell[axis] * ISO_BRICK - REACH;
    const double middle = (WINDOW - 1) / 2.0;
    iso_vec3 p = iso_vec3_make(coordinate(h, corner[0] + middle), coordinate(h, corner[1] + middle),
                               coordinate(h, corner[2] + middle) - lift);
    choice c = choose_balls(p, (middle * 1.7320508075688774 + REACH) * h->voxel);
    fill_window(h, &c, corner, s->value);
    sample_edges(h, &c, corner, s);
    for (int i = 0; i < ISO_BRICK_VOXELS; i++) s->nearest[i] = REACH * REACH;
    for (int i = 0; i < s->count; i++) scatter(s, i);
    const float band = (float)ISO_SCENE_BAND;
    for (int i = 0; i < ISO_BRICK_VOXELS; i++) {
        int x = i % ISO_BRICK + REACH, y = i / ISO_BRICK % ISO_BRICK + REACH;
        int z = i / ISO_BRICK / ISO_BRICK + REACH;
        float distance = band;
        if (s->nearest[i] < REACH * REACH) {
            iso_vec3 from = iso_vec3_make(corner[0] + x, corner[1] + y, corner[2] + z);
            distance = (float)walk(h, &c, from, in_volume(corner, s->sample[s->which[i]]));
            if (distance > band) distance = band;
        }
        brick[i] = s->value[window_index(x, y, z)] < 0 ? -distance : distance;
    }
}

iso_status iso_scene_head(const iso_scene_opts *opts, iso_grid *grid, iso_error *error) {
    int count = ((opts->size - 1) / ISO_BRICK + 1) * ISO_BRICK + 2 * REACH;
    head h = {.size = opts->size, .voxel = 2.0 / opts->size};
    h.sines = iso_alloc(4 * (size_t)count * sizeof *h.sines);
    if (!h.sines) return iso_fail(error, ISO_ERR_NOMEM, "out of memory for the scene 'head'");
    h.lifted = h.sines + 2 * count;
    iso_scene_axis axis = {frequency * h.voxel, -frequency, -REACH, count};
    iso_scene_sines(&axis, h.sines);
    axis.phase = -frequency * (1 + lift);
    iso_scene_sines(&axis, h.lifted);
    iso_scene_solid solid = {.size = opts->size,
                             .self = &h,
                             .classify = classify,
                             .fill = fill_brick,
                             .scratch_bytes = sizeof(scratch)};
    iso_status status = iso_scene_build(&solid, opts, grid, error);
    iso_free(h.sines);
    return status;
}
