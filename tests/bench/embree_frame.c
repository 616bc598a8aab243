/* embree_frame: what the tubes of bench render are measured against besides VTK: Embree's round linear
 * curves, which are the same chains of rounded cones, hit by one ray a pixel, in packets of 16 and without
 * shading, with one thread.
 *
 *   embree_frame FILE    says "ready SEGMENTS Embree", then answers a line each:
 *     "view WIDTH HEIGHT eye(3) focal point(3) up(3) angle centre(2)"  ->  "shown"; centre is not used
 *     "frame"      ->  "frame WALL CPU", milliseconds of the rays
 *     "built"      ->  "frame WALL CPU" of building the scene from its arrays, and the rays
 *     "covered"    ->  "covered PIXELS"
 *
 * FILE: as vtk_frame has it, of lines. */
#include <embree3/rtcore.h>
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { PACKET = 4 }; /* pixels on a side of a packet */

typedef struct lines {
    size_t points, lines;
    float (*vertices)[4]; /* x, y, z, radius */
} lines;

typedef struct view {
    int width, height;
    double eye[3], right[3], up[3], forward[3]; /* right and up: of a pixel's side at distance 1 */
} view;

static double milliseconds(clockid_t clock) {
    struct timespec now;
    clock_gettime(clock, &now);
    return (double)now.tv_sec * 1e3 + (double)now.tv_nsec * 1e-6;
}

static int read_lines(const char *path, lines *read) {
    FILE *file = fopen(path, "rb");
    int64_t counts[2] = {0, 0};
    int good = file && fread(counts, sizeof *counts, 2, file) == 2 && counts[0] > 0 && counts[1] > 0;
    read->points = (size_t)counts[0];
    read->lines = (size_t)counts[1];
    read->vertices = good ? malloc(read->points * sizeof *read->vertices) : NULL;
    float(*positions)[3] = good ? malloc(read->points * sizeof *positions) : NULL;
    float *radii = good ? malloc(read->points * sizeof *radii) : NULL;
    good = good && read->vertices && positions && radii &&
           fread(positions, sizeof *positions, read->points, file) == read->points &&
           fread(radii, sizeof *radii, read->points, file) == read->points;
    for (size_t i = 0; good && i < read->points; i++) {
        memcpy(read->vertices[i], positions[i], sizeof *positions);
        read->vertices[i][3] = radii[i];
    }
    free(positions);
    free(radii);
    if (file) fclose(file);
    return good;
}

static RTCScene build(RTCDevice device, const lines *from) {
    const size_t length = from->points / from->lines, segments = from->points - from->lines;
    RTCScene scene = rtcNewScene(device);
    RTCGeometry curve = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_ROUND_LINEAR_CURVE);
    rtcSetSharedGeometryBuffer(curve, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT4, from->vertices, 0,
                               sizeof *from->vertices, from->points);
    unsigned *first =
        rtcSetNewGeometryBuffer(curve, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT, sizeof *first, segments);
    unsigned char *flags =
        rtcSetNewGeometryBuffer(curve, RTC_BUFFER_TYPE_FLAGS, 0, RTC_FORMAT_UCHAR, sizeof *flags, segments);
    for (size_t line = 0, n = 0; line < from->lines; line++)
        for (size_t i = 0; i + 1 < length; i++, n++) {
            first[n] = (unsigned)(line * length + i);
            flags[n] = (unsigned char)((i > 0 ? RTC_CURVE_FLAG_NEIGHBOR_LEFT : 0) |
                                       (i + 2 < length ? RTC_CURVE_FLAG_NEIGHBOR_RIGHT : 0));
        }
    rtcCommitGeometry(curve);
    rtcAttachGeometry(scene, curve);
    rtcReleaseGeometry(curve);
    rtcCommitScene(scene);
    return scene;
}

static void unit(double v[3], double length) {
    const double scale = length / sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
    for (int i = 0; i < 3; i++) v[i] *= scale;
}

static void cross(const double a[3], const double b[3], double out[3]) {
    for (int i = 0; i < 3; i++) out[i] = a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3];
}

static int set_view(view *v, const char *line) {
    double focus[3], up[3], angle, centre[2];
    if (sscanf(line, "view %d %d %lf %lf %lf %lf %lf %lf %lf %lf %lf %lf %lf %lf", &v->width, &v->height,
               &v->eye[0], &v->eye[1], &v->eye[2], &focus[0], &focus[1], &focus[2], &up[0], &up[1], &up[2],
               &angle, &centre[0], &centre[1]) != 14)
        return 0;
    for (int i = 0; i < 3; i++) v->forward[i] = focus[i] - v->eye[i];
    unit(v->forward, 1);
    cross(v->forward, up, v->right);
    cross(v->right, v->forward, v->up);
    const double pixel = 2 * tan(angle * 3.14159265358979323846 / 360) / v->height;
    unit(v->right, pixel);
    unit(v->up, pixel);
    return 1;
}

/* Rays through the centres of PACKET x PACKET pixels; returns how many hit. */
static int trace(RTCScene scene, const view *v, int x, int y) {
    struct RTCIntersectContext context;
    struct RTCRayHit16 rays;
    int valid[16], hits = 0;
    rtcInitIntersectContext(&context);
    context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    for (int i = 0; i < 16; i++) {
        const double a = x + i % PACKET + 0.5 - v->width / 2.0, b = v->height / 2.0 - (y + i / PACKET + 0.5);
        float *const way[3] = {&rays.ray.dir_x[i], &rays.ray.dir_y[i], &rays.ray.dir_z[i]};
        for (int axis = 0; axis < 3; axis++)
            *way[axis] = (float)(v->forward[axis] + a * v->right[axis] + b * v->up[axis]);
        rays.ray.org_x[i] = (float)v->eye[0];
        rays.ray.org_y[i] = (float)v->eye[1];
        rays.ray.org_z[i] = (float)v->eye[2];
        rays.ray.tnear[i] = 0;
        rays.ray.tfar[i] = INFINITY;
        rays.ray.time[i] = 0;
        rays.ray.mask[i] = rays.ray.flags[i] = rays.ray.id[i] = 0;
        rays.ray.mask[i]--;
        rays.hit.geomID[i] = RTC_INVALID_GEOMETRY_ID;
        rays.hit.instID[0][i] = RTC_INVALID_GEOMETRY_ID;
        valid[i] = x + i % PACKET < v->width && y + i / PACKET < v->height ? -1 : 0;
    }
    rtcIntersect16(valid, scene, &context, &rays);
    for (int i = 0; i < 16; i++) hits += valid[i] && rays.hit.geomID[i] != RTC_INVALID_GEOMETRY_ID;
    return hits;
}

static long trace_all(RTCScene scene, const view *v) {
    long hits = 0;
    for (int y = 0; y < v->height; y += PACKET)
        for (int x = 0; x < v->width; x += PACKET) hits += trace(scene, v, x, y);
    return hits;
}

/* Answers a question about frames; 0 when it is none. */
static int answer(RTCDevice device, RTCScene *scene, const lines *from, const view *v, const char *line) {
    const int built = strcmp(line, "built\n") == 0;
    if (strcmp(line, "covered\n") == 0) {
        printf("covered %ld\n", trace_all(*scene, v));
        return 1;
    }
    if (!built && strcmp(line, "frame\n") != 0) return 0;
    const double cpu = milliseconds(CLOCK_PROCESS_CPUTIME_ID), wall = milliseconds(CLOCK_MONOTONIC);
    if (built) {
        rtcReleaseScene(*scene);
        *scene = build(device, from);
    }
    trace_all(*scene, v);
    printf("frame %.17g %.17g\n", milliseconds(CLOCK_MONOTONIC) - wall,
           milliseconds(CLOCK_PROCESS_CPUTIME_ID) - cpu);
    return 1;
}

int main(int argc, char **argv) {
    lines from;
    view v = {.width = 0};
    char line[1024];
    if (argc != 2 || !read_lines(argv[1], &from)) {
        fprintf(stderr, "usage: embree_frame FILE, of the bench's lines\n");
        return 2;
    }
    RTCDevice device = rtcNewDevice("threads=1");
    RTCScene scene = build(device, &from);
    printf("ready %zu Embree\n", from.points - from.lines);
    fflush(stdout);
    while (fgets(line, sizeof line, stdin)) {
        if (set_view(&v, line))
            printf("shown\n");
        else if (!answer(device, &scene, &from, &v, line))
            printf("what?\n");
        fflush(stdout);
    }
    rtcReleaseScene(scene);
    rtcReleaseDevice(device);
    free(from.vertices);
    return 0;
}
