/* deferred_splatting: the passes of Guennebaud et al. 2004 (section 4.1), implemented again to measure what
 * the paper claims: scalar C, one thread. For each frame
 *
 *   1. visibility splatting: the discs seen in the frame before are drawn into a depth buffer;
 *   2. every point that this depth buffer does not hide is drawn as one pixel that holds its number;
 *   3. visibility splatting of the points found by pass 2 that were not seen in the frame before;
 *   4. filtered splatting (the paper: EWA; here the filter of Botsch et al. 2005): the discs found by
 *      pass 2 near the front are summed with Gaussian weights;
 *   5. normalization: the sums are divided by the sums of weights.
 *
 * Without selection all discs are drawn in passes 1 and 4, as in the algorithm that the paper starts from.
 * Times are of the processor.
 *
 * usage: deferred_splatting times POINTS
 *            prints times as JSON: the object turns by 5 degrees from frame to frame
 *        deferred_splatting figure POINTS FOLDER
 *            writes the pictures of figure 3: a checkerboard and the object, which turns by 120 degrees
 *            between two frames */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "base/memory.h"
#include "clouds/cloud.h"
#include "image/camera.h"
#include "image/image.h"
#include "io/glyphs/glyphs_read.h"

enum { SIDE = 512, CHECKER = 400, SQUARES = 8, FRAMES = 12 };
/* Radii of discs in radii of points; how far behind the front discs are still summed, in radii of discs. */
static const float DISC = 1.35f, THICKNESS = 1.5f;

typedef struct splat {
    float position[3], normal[3], radius; /* mm */
    float color;                          /* grey, 0 .. 1 */
    bool turns;                           /* with the object; else it is of the checkerboard */
} splat;

typedef struct scene {
    splat *splats;
    size_t count;
    iso_vec3 center;
    double extent; /* half of the object's largest side, mm */
    iso_view view;
    double angle; /* of the object about z through its centre, radians */
} scene;

/* Buffers of SIDE * SIDE pixels, and lists of splats. */
typedef struct drawing {
    float *depth, *color, *weight, *nearest;
    uint32_t *number;
    uint32_t *seen, *before; /* splats found by pass 2 in this frame, and in the frame before */
    size_t seen_count, before_count;
    uint8_t *was_seen; /* for each splat: whether it is in `before` */
    uint32_t *all;     /* the numbers of all splats */
} drawing;

/* Seconds of each pass, and how many splats it drew. */
typedef struct frame_cost {
    double seconds[6];
    size_t splats[6];
} frame_cost;

/* ---- the scene ---- */

static iso_status read_object(const char *path, iso_cloud *cloud, iso_error *error) {
    iso_glyphs glyphs = {.count = 0};
    const iso_cloud_opts opts = {.radius = 0};
    ISO_TRY(iso_glyphs_read(path, NULL, &glyphs, error));
    const iso_status status = iso_cloud_make(&glyphs, &opts, cloud, error);
    iso_glyphs_free(&glyphs);
    return status;
}

static void put_object(scene *s, const iso_cloud *cloud) {
    const iso_affine affine = iso_transform_affine(&cloud->transform);
    iso_box box = iso_box_empty();
    for (size_t span = 0; span < cloud->span_count; span++)
        for (size_t i = cloud->spans[span].first, n = 0; n < cloud->spans[span].count; i++, n++) {
            const iso_surfel *surfel = &cloud->surfels[i];
            const iso_vec3 at =
                iso_affine_point(&affine, iso_brick_position(cloud->spans[span].brick, surfel->position));
            const iso_vec3 normal = iso_vec3_unit(iso_affine_normal(
                &affine, iso_vec3_make(surfel->normal[0], surfel->normal[1], surfel->normal[2])));
            iso_box_add(&box, at);
            s->splats[s->count++] = (splat){{(float)at.x, (float)at.y, (float)at.z},
                                            {(float)normal.x, (float)normal.y, (float)normal.z},
                                            DISC * (cloud->radii ? cloud->radii[i] : (float)cloud->radius),
                                            0.85f,
                                            true};
        }
    s->center = iso_vec3_scale(iso_vec3_add(box.lo, box.hi), 0.5);
    const iso_vec3 size = iso_vec3_sub(box.hi, box.lo);
    s->extent = fmax(size.x, fmax(size.y, size.z)) / 2;
}

/* A wall of black and white squares behind the object. */
static void put_checkerboard(scene *s) {
    const double step = 5 * s->extent / CHECKER;
    for (int y = 0; y < CHECKER; y++)
        for (int x = 0; x < CHECKER; x++) {
            const bool white = (x * SQUARES / CHECKER + y * SQUARES / CHECKER) % 2;
            s->splats[s->count++] = (splat){{(float)(s->center.x + (x - CHECKER / 2) * step),
                                             (float)(s->center.y + 1.6 * s->extent),
                                             (float)(s->center.z + (y - CHECKER / 2) * step)},
                                            {0, -1, 0},
                                            (float)step,
                                            white ? 0.95f : 0.1f,
                                            false};
        }
}

static iso_status make_scene(const char *path, bool checkerboard, scene *s, iso_error *error) {
    iso_cloud cloud = {.count = 0};
    ISO_TRY(read_object(path, &cloud, error));
    s->splats = calloc(cloud.count + CHECKER * CHECKER, sizeof *s->splats);
    if (!s->splats) {
        iso_cloud_free(&cloud);
        return iso_fail(error, ISO_ERR_NOMEM, "out of memory");
    }
    put_object(s, &cloud);
    iso_cloud_free(&cloud);
    if (checkerboard) put_checkerboard(s);
    const iso_camera camera = {
        .position = {s->center.x, s->center.y - 5 * s->extent, s->center.z + 1 * s->extent},
        .focal_point = {s->center.x, s->center.y, s->center.z},
        .view_up = {0, 0, 1},
        .view_angle = 30};
    s->view = iso_view_make(&camera, SIDE, SIDE);
    return ISO_OK;
}

/* ---- drawing ---- */

/* A disc in view space. */
typedef struct disc {
    float center[3], normal[3];
    float radius, column, row, scale; /* pixels; pixels per mm */
} disc;

static void rotate(const double m[9], const double v[3], float out[3]) {
    for (int k = 0; k < 3; k++) out[k] = (float)(m[3 * k] * v[0] + m[3 * k + 1] * v[1] + m[3 * k + 2] * v[2]);
}

/* Returns false for discs behind the eye. */
static bool make_disc(const scene *s, const splat *from, disc *to) {
    const double c = from->turns ? cos(s->angle) : 1, n = from->turns ? sin(s->angle) : 0;
    const double x = (double)from->position[0] - s->center.x, y = (double)from->position[1] - s->center.y;
    const double at[3] = {s->center.x + c * x - n * y - s->view.eye.x,
                          s->center.y + n * x + c * y - s->view.eye.y,
                          (double)from->position[2] - s->view.eye.z};
    const double nx = (double)from->normal[0], ny = (double)from->normal[1];
    const double normal[3] = {c * nx - n * ny, n * nx + c * ny, (double)from->normal[2]};
    rotate(s->view.rotation, at, to->center);
    rotate(s->view.rotation, normal, to->normal);
    if (to->center[2] <= 0) return false;
    to->radius = from->radius;
    to->scale = (float)s->view.focal / to->center[2];
    to->column = (float)s->view.cx + to->scale * to->center[0];
    to->row = (float)s->view.cy + to->scale * to->center[1];
    return true;
}

/* Intersects the ray of a pixel with the disc. *depth: of the hit; *apart: 0 in the middle, 1 at the rim.
 * Around its centre a disc covers two thirds of a pixel however small it is (the low-pass filter). */
static bool hit_disc(const scene *s, const disc *d, int x, int y, float *depth, float *apart) {
    const float px = (float)x + 0.5f, py = (float)y + 0.5f, focal = (float)s->view.focal;
    const float ray[2] = {(px - (float)s->view.cx) / focal, (py - (float)s->view.cy) / focal};
    const float slope = d->normal[0] * ray[0] + d->normal[1] * ray[1] + d->normal[2];
    const float screen = ((px - d->column) * (px - d->column) + (py - d->row) * (py - d->row)) / 0.45f;
    const float height =
        d->normal[0] * d->center[0] + d->normal[1] * d->center[1] + d->normal[2] * d->center[2];
    const float t = height / slope;
    *depth = d->center[2];
    *apart = screen;
    if (fabsf(t - d->center[2]) <= d->radius) {
        const float q[3] = {t * ray[0] - d->center[0], t * ray[1] - d->center[1], t - d->center[2]};
        const float object = (q[0] * q[0] + q[1] * q[1] + q[2] * q[2]) / (d->radius * d->radius);
        if (object < screen) {
            *depth = t;
            *apart = object;
        }
    }
    return *apart <= 1;
}

typedef void add_sample(drawing *p, const splat *from, const disc *d, size_t pixel, float depth, float apart);

static void draw_splat(const scene *s, drawing *p, const splat *from, add_sample *add) {
    disc d;
    float depth, apart;
    if (!make_disc(s, from, &d)) return;
    const float reach = fmaxf(d.radius * d.scale, 0.7f);
    const int x0 = (int)fmaxf(d.column - reach, 0), x1 = (int)fminf(d.column + reach, SIDE - 1);
    const int y0 = (int)fmaxf(d.row - reach, 0), y1 = (int)fminf(d.row + reach, SIDE - 1);
    for (int y = y0; y <= y1; y++)
        for (int x = x0; x <= x1; x++)
            if (hit_disc(s, &d, x, y, &depth, &apart))
                add(p, from, &d, (size_t)y * SIDE + (size_t)x, depth, apart);
}

static void add_depth(drawing *p, const splat *from, const disc *d, size_t pixel, float depth, float apart) {
    (void)from;
    (void)d;
    (void)apart;
    if (depth < p->depth[pixel]) p->depth[pixel] = depth;
}

/* Sides that face away are dark, so that they are noticed where they should not be seen. */
static void add_color(drawing *p, const splat *from, const disc *d, size_t pixel, float depth, float apart) {
    if (depth > p->depth[pixel] + THICKNESS * d->radius) return;
    const float weight = expf(-3 * apart),
                length = sqrtf(d->center[0] * d->center[0] + d->center[1] * d->center[1] +
                               d->center[2] * d->center[2]);
    const float facing =
        -(d->normal[0] * d->center[0] + d->normal[1] * d->center[1] + d->normal[2] * d->center[2]) / length;
    p->color[pixel] += weight * from->color * (0.15f + 0.85f * fmaxf(facing, 0));
    p->weight[pixel] += weight;
}

static void draw_list(const scene *s, drawing *p, const uint32_t *list, size_t count, add_sample *add) {
    for (size_t i = 0; i < count; i++) draw_splat(s, p, &s->splats[list[i]], add);
}

/* ---- passes ---- */

/* Pass 2, and reading the buffer. */
static void find_seen(const scene *s, drawing *p) {
    memset(p->number, 0, SIDE * SIDE * sizeof *p->number);
    for (size_t i = 0; i < s->count; i++) {
        disc d;
        if (!make_disc(s, &s->splats[i], &d)) continue;
        if (!(d.column >= 0 && d.column < SIDE && d.row >= 0 && d.row < SIDE)) continue;
        const size_t pixel = (size_t)d.row * SIDE + (size_t)d.column;
        if (d.center[2] > p->depth[pixel] + THICKNESS * d.radius) continue;
        if (p->number[pixel] && p->nearest[pixel] <= d.center[2]) continue;
        p->nearest[pixel] = d.center[2];
        p->number[pixel] = (uint32_t)i + 1;
    }
    p->seen_count = 0;
    for (size_t pixel = 0; pixel < SIDE * SIDE; pixel++)
        if (p->number[pixel]) p->seen[p->seen_count++] = p->number[pixel] - 1;
}

/* Pass 3: splats that are seen now and were not seen before. */
static size_t draw_new(const scene *s, drawing *p) {
    size_t count = 0;
    for (size_t i = 0; i < p->seen_count; i++) {
        if (p->was_seen[p->seen[i]]) continue;
        draw_splat(s, p, &s->splats[p->seen[i]], add_depth);
        count++;
    }
    return count;
}

static void clear(drawing *p) {
    for (size_t i = 0; i < SIDE * SIDE; i++) p->depth[i] = INFINITY;
    memset(p->color, 0, SIDE * SIDE * sizeof *p->color);
    memset(p->weight, 0, SIDE * SIDE * sizeof *p->weight);
}

/* The splats of this frame become those of the frame before. */
static void keep_seen(drawing *p) {
    for (size_t i = 0; i < p->before_count; i++) p->was_seen[p->before[i]] = 0;
    for (size_t i = 0; i < p->seen_count; i++) p->was_seen[p->seen[i]] = 1;
    uint32_t *const list = p->before;
    p->before = p->seen;
    p->before_count = p->seen_count;
    p->seen = list;
}

/* Seconds of the processor since the last lap; there is one thread. */
static double lap(clock_t *start) {
    const clock_t now = clock(), spent = now - *start;
    *start = now;
    return (double)spent / CLOCKS_PER_SEC;
}

static void draw_selected(const scene *s, drawing *p, bool third_pass, frame_cost *cost) {
    clock_t start = clock();
    clear(p);
    draw_list(s, p, p->before, p->before_count, add_depth);
    cost->seconds[1] = lap(&start);
    cost->splats[1] = p->before_count;
    find_seen(s, p);
    cost->seconds[2] = lap(&start);
    cost->splats[2] = s->count;
    cost->splats[3] = third_pass ? draw_new(s, p) : 0;
    cost->seconds[3] = lap(&start);
    draw_list(s, p, p->seen, p->seen_count, add_color);
    cost->seconds[4] = lap(&start);
    cost->splats[4] = p->seen_count;
    keep_seen(p);
}

static void draw_everything(const scene *s, drawing *p, frame_cost *cost) {
    clock_t start = clock();
    clear(p);
    draw_list(s, p, p->all, s->count, add_depth);
    cost->seconds[1] = lap(&start);
    draw_list(s, p, p->all, s->count, add_color);
    cost->seconds[4] = lap(&start);
    cost->splats[1] = cost->splats[4] = s->count;
}

static iso_status write_picture(const drawing *p, const char *folder, const char *name, iso_error *error) {
    char path[1024];
    iso_image image;
    snprintf(path, sizeof path, "%s/%s.png", folder, name);
    ISO_TRY(iso_image_create(SIDE, SIDE, &image, error));
    for (size_t i = 0; i < SIDE * SIDE; i++) {
        const float grey = p->weight[i] > 0 ? p->color[i] / p->weight[i] : 0; /* pass 5 */
        memset(image.rgba + 4 * i, (int)(255 * fminf(grey, 1) + 0.5f), 3);
        image.rgba[4 * i + 3] = p->weight[i] > 0 ? 255 : 0;
    }
    const iso_status status = iso_png_write(path, &image, NULL, 0, error);
    iso_image_free(&image);
    return status;
}

/* ---- the two commands ---- */

static int compare_doubles(const void *a, const void *b) {
    const double one = *(const double *)a, other = *(const double *)b;
    return (one > other) - (one < other);
}

static double median(double *values) {
    qsort(values, FRAMES, sizeof *values, compare_doubles);
    return values[FRAMES / 2];
}

/* Prints the median seconds of frames and the rates of passes. */
static void measure(scene *s, drawing *p) {
    double with[FRAMES], without[FRAMES];
    frame_cost sum = {{0}, {0}}, cost;
    size_t seen = 0;
    draw_selected(s, p, true, &cost); /* fills the list of the frame before */
    for (int frame = 0; frame < FRAMES; frame++) {
        s->angle += 5 * ISO_PI / 180;
        draw_selected(s, p, true, &cost);
        with[frame] = cost.seconds[1] + cost.seconds[2] + cost.seconds[3] + cost.seconds[4];
        for (int pass = 1; pass <= 4; pass++) {
            sum.seconds[pass] += cost.seconds[pass];
            sum.splats[pass] += cost.splats[pass];
        }
        seen += p->before_count;
    }
    for (int frame = 0; frame < FRAMES; frame++) {
        s->angle += 5 * ISO_PI / 180;
        draw_everything(s, p, &cost);
        without[frame] = cost.seconds[1] + cost.seconds[4];
    }
    printf("{\"points\": %zu, \"culled\": %.17g, \"seconds_with\": %.17g, \"seconds_without\": %.17g",
           s->count, 1 - (double)seen / ((double)s->count * FRAMES), median(with), median(without));
    for (int pass = 1; pass <= 4; pass++)
        printf(", \"pass_%d_points_per_second\": %.17g, \"pass_%d_seconds\": %.17g", pass,
               sum.splats[pass] ? (double)sum.splats[pass] / sum.seconds[pass] : 0, pass,
               sum.seconds[pass] / FRAMES);
    puts("}");
}

/* Writes the pictures of figure 3. Without pass 3: before the object turns (a), the first frame after it (b)
 * and the next one (c); with pass 3, the first frame after it (d). And the pictures of a and b in which all
 * splats are drawn, which have no holes. */
static iso_status write_figure(scene *s, drawing *p, const char *folder, iso_error *error) {
    frame_cost cost;
    const double turned = 120 * ISO_PI / 180;
    for (int third_pass = 0; third_pass <= 1; third_pass++) {
        s->angle = 0;
        for (int i = 0; i < 3; i++) draw_selected(s, p, third_pass, &cost);
        if (!third_pass) ISO_TRY(write_picture(p, folder, "deferred-a", error));
        s->angle = turned;
        draw_selected(s, p, third_pass, &cost);
        ISO_TRY(write_picture(p, folder, third_pass ? "deferred-d" : "deferred-b", error));
        draw_selected(s, p, third_pass, &cost);
        if (!third_pass) ISO_TRY(write_picture(p, folder, "deferred-c", error));
    }
    draw_everything(s, p, &cost);
    ISO_TRY(write_picture(p, folder, "deferred-all-b", error));
    s->angle = 0;
    draw_everything(s, p, &cost);
    return write_picture(p, folder, "deferred-all-a", error);
}

static bool make_drawing(drawing *p, size_t count) {
    const size_t pixels = SIDE * SIDE;
    *p = (drawing){.depth = calloc(pixels, sizeof(float)),
                   .color = calloc(pixels, sizeof(float)),
                   .weight = calloc(pixels, sizeof(float)),
                   .nearest = calloc(pixels, sizeof(float)),
                   .number = calloc(pixels, sizeof(uint32_t)),
                   .seen = calloc(pixels, sizeof(uint32_t)),
                   .before = calloc(pixels, sizeof(uint32_t)),
                   .was_seen = calloc(count, 1),
                   .all = calloc(count, sizeof(uint32_t))};
    for (size_t i = 0; p->all && i < count; i++) p->all[i] = (uint32_t)i;
    return p->depth && p->color && p->weight && p->nearest && p->number && p->seen && p->before &&
           p->was_seen && p->all;
}

static void free_drawing(drawing *p) {
    void *const arrays[] = {p->depth, p->color,  p->weight,   p->nearest, p->number,
                            p->seen,  p->before, p->was_seen, p->all};
    for (size_t i = 0; i < sizeof arrays / sizeof *arrays; i++) free(arrays[i]);
}

int main(int argc, char **argv) {
    iso_error error = {0};
    scene s = {.splats = NULL};
    drawing p = {.depth = NULL};
    const bool figure = argc == 4 && strcmp(argv[1], "figure") == 0;
    if (!figure && !(argc == 3 && strcmp(argv[1], "times") == 0)) {
        fprintf(stderr, "usage: deferred_splatting times POINTS | figure POINTS FOLDER\n");
        return 2;
    }
    iso_status status = make_scene(argv[2], figure, &s, &error);
    if (status == ISO_OK && !make_drawing(&p, s.count))
        status = iso_fail(&error, ISO_ERR_NOMEM, "out of memory");
    if (status == ISO_OK && figure) status = write_figure(&s, &p, argv[3], &error);
    if (status == ISO_OK && !figure) measure(&s, &p);
    if (status != ISO_OK) fprintf(stderr, "deferred_splatting: %s\n", error.text);
    free_drawing(&p);
    free(s.splats);
    return iso_status_exit(status);
}
