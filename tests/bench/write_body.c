/* write_body FOLDER [SIDE]: writes a body of 104 labels, those that TotalSegmentator 1 has (Wasserthal et al.
 * 2023), as made of ellipsoids and rounded cylinders: body.nrrd, and scan.nrrd, whose isosurface at 128 is
 * the surface of all labels together. What a picture of many labels costs is measured with these: `isorender
 * --labels body.nrrd` against `isorender scan.nrrd --isovalue 128`. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "base/file.h"
#include "base/geometry.h"

enum { RIBS = 12, VERTEBRAE = 24, LABELS = 104 };

/* An ellipsoid around `a` with the radii `b`, or, of a radius, a rounded cylinder from a to b. In units of
 * the side: x to the left of the patient, y to the back, z up. `both`: the next label is its mirror image.
 * What is named "" belongs to the label before. Later ones replace earlier ones. */
typedef struct part {
    const char *name;
    iso_vec3 a, b;
    double radius;
    bool both;
} part;

static const part parts[] = {
    {"liver", {0.38, 0.47, 0.50}, {0.13, 0.11, 0.075}, 0, false},
    {"spleen", {0.66, 0.56, 0.50}, {0.035, 0.05, 0.055}, 0, false},
    {"stomach", {0.58, 0.44, 0.49}, {0.06, 0.06, 0.06}, 0, false},
    {"pancreas", {0.44, 0.50, 0.43}, {0.60, 0.53, 0.46}, 0.016, false},
    {"gallbladder", {0.41, 0.40, 0.44}, {0.018, 0.02, 0.03}, 0, false},
    {"kidney", {0.40, 0.59, 0.42}, {0.035, 0.032, 0.055}, 0, true},
    {"adrenal gland", {0.43, 0.57, 0.485}, {0.455, 0.555, 0.475}, 0.007, true},
    {"lung upper lobe right", {0.36, 0.46, 0.72}, {0.085, 0.11, 0.09}, 0, false},
    {"lung middle lobe right", {0.36, 0.42, 0.62}, {0.09, 0.09, 0.05}, 0, false},
    {"lung lower lobe right", {0.36, 0.56, 0.62}, {0.09, 0.08, 0.08}, 0, false},
    {"lung upper lobe left", {0.64, 0.45, 0.70}, {0.085, 0.11, 0.10}, 0, false},
    {"lung lower lobe left", {0.64, 0.56, 0.62}, {0.09, 0.08, 0.08}, 0, false},
    {"heart myocardium", {0.55, 0.42, 0.61}, {0.06, 0.055, 0.055}, 0, false},
    {"heart ventricle left", {0.56, 0.43, 0.61}, {0.03, 0.03, 0.035}, 0, false},
    {"heart atrium left", {0.53, 0.48, 0.65}, {0.04, 0.03, 0.03}, 0, false},
    {"heart ventricle right", {0.50, 0.40, 0.61}, {0.035, 0.04, 0.045}, 0, false},
    {"heart atrium right", {0.46, 0.44, 0.63}, {0.03, 0.035, 0.04}, 0, false},
    {"pulmonary artery", {0.53, 0.43, 0.68}, {0.46, 0.49, 0.70}, 0.018, false},
    {"aorta", {0.51, 0.57, 0.34}, {0.52, 0.57, 0.72}, 0.017, false},
    {"", {0.52, 0.57, 0.72}, {0.49, 0.46, 0.73}, 0.017, false},
    {"inferior vena cava", {0.47, 0.56, 0.33}, {0.46, 0.52, 0.60}, 0.016, false},
    {"portal vein", {0.48, 0.51, 0.44}, {0.41, 0.48, 0.50}, 0.010, false},
    {"esophagus", {0.53, 0.53, 0.52}, {0.50, 0.53, 0.84}, 0.012, false},
    {"trachea", {0.50, 0.49, 0.70}, {0.50, 0.48, 0.85}, 0.014, false},
    {"duodenum", {0.42, 0.47, 0.45}, {0.43, 0.49, 0.37}, 0.018, false},
    {"small bowel", {0.42, 0.42, 0.34}, {0.58, 0.42, 0.35}, 0.022, false},
    {"", {0.58, 0.41, 0.30}, {0.42, 0.43, 0.31}, 0.022, false},
    {"", {0.43, 0.41, 0.26}, {0.57, 0.42, 0.25}, 0.022, false},
    {"colon", {0.34, 0.48, 0.27}, {0.33, 0.47, 0.42}, 0.027, false},
    {"", {0.34, 0.41, 0.41}, {0.66, 0.40, 0.42}, 0.025, false},
    {"", {0.66, 0.47, 0.43}, {0.66, 0.49, 0.27}, 0.025, false},
    {"", {0.65, 0.49, 0.26}, {0.52, 0.53, 0.20}, 0.023, false},
    {"urinary bladder", {0.50, 0.42, 0.16}, {0.055, 0.045, 0.04}, 0, false},
    {"sacrum", {0.50, 0.63, 0.27}, {0.50, 0.67, 0.18}, 0.040, false},
    {"hip", {0.38, 0.58, 0.27}, {0.44, 0.48, 0.13}, 0.030, true},
    {"femur", {0.35, 0.53, 0.17}, {0.33, 0.52, 0.01}, 0.026, true},
    {"iliac artery", {0.50, 0.56, 0.34}, {0.42, 0.46, 0.16}, 0.009, true},
    {"iliac vein", {0.47, 0.58, 0.33}, {0.43, 0.49, 0.16}, 0.010, true},
    {"gluteus maximus", {0.36, 0.70, 0.17}, {0.07, 0.045, 0.08}, 0, true},
    {"gluteus medius", {0.31, 0.61, 0.24}, {0.04, 0.05, 0.06}, 0, true},
    {"gluteus minimus", {0.32, 0.56, 0.20}, {0.025, 0.03, 0.04}, 0, true},
    {"autochthon", {0.44, 0.70, 0.22}, {0.45, 0.69, 0.80}, 0.030, true},
    {"iliopsoas", {0.44, 0.59, 0.42}, {0.37, 0.47, 0.13}, 0.024, true},
    {"humerus", {0.20, 0.52, 0.80}, {0.13, 0.54, 0.52}, 0.020, true},
    {"scapula", {0.28, 0.66, 0.78}, {0.34, 0.70, 0.66}, 0.014, true},
    {"clavicula", {0.47, 0.40, 0.79}, {0.24, 0.47, 0.83}, 0.010, true},
    {"brain", {0.50, 0.49, 0.955}, {0.075, 0.085, 0.05}, 0, false},
    {"face", {0.50, 0.38, 0.90}, {0.06, 0.035, 0.05}, 0, false},
};

typedef struct body {
    int side, labels;
    uint8_t *label, *scan;
    float *depth; /* how far a voxel lies inside of all labels, voxels */
} body;

/* About how far p lies inside, in units of the side. */
static double depth_in(const part *s, iso_vec3 p) {
    const iso_vec3 from = iso_vec3_sub(p, s->a);
    if (s->radius > 0) {
        const iso_vec3 axis = iso_vec3_sub(s->b, s->a);
        const double t = fmin(fmax(iso_vec3_dot(from, axis) / iso_vec3_dot(axis, axis), 0), 1);
        return s->radius - iso_vec3_length(iso_vec3_sub(from, iso_vec3_scale(axis, t)));
    }
    const iso_vec3 scaled = {from.x / s->b.x, from.y / s->b.y, from.z / s->b.z};
    return (1 - iso_vec3_length(scaled)) * fmin(s->b.x, fmin(s->b.y, s->b.z));
}

/* Adds a part; only what lies near it is looked at. */
static void add(body *b, const part *s, int label) {
    const double margin = 6.0 / b->side, r = s->radius;
    const double a[3] = {s->a.x, s->a.y, s->a.z}, c[3] = {s->b.x, s->b.y, s->b.z};
    int lo[3], hi[3];
    for (int k = 0; k < 3; k++) {
        const double first = r > 0 ? fmin(a[k], c[k]) - r : a[k] - c[k],
                     last = r > 0 ? fmax(a[k], c[k]) + r : a[k] + c[k];
        lo[k] = (int)fmax(0, (first - margin) * b->side);
        hi[k] = (int)fmin(b->side - 1, (last + margin) * b->side);
    }
    for (int z = lo[2]; z <= hi[2]; z++)
        for (int y = lo[1]; y <= hi[1]; y++)
            for (int x = lo[0]; x <= hi[0]; x++) {
                const size_t i = ((size_t)z * (size_t)b->side + (size_t)y) * (size_t)b->side + (size_t)x;
                const iso_vec3 p = {(x + 0.5) / b->side, (y + 0.5) / b->side, (z + 0.5) / b->side};
                const double depth = depth_in(s, p) * b->side;
                if (depth > 0) b->label[i] = (uint8_t)label;
                b->depth[i] = fmaxf(b->depth[i], (float)depth);
            }
}

static void add_mirrored(body *b, const part *s, int label) {
    part other = *s;
    other.a.x = 1 - s->a.x;
    if (s->radius > 0) other.b.x = 1 - s->b.x;
    add(b, &other, label);
}

static void add_vertebra(body *b, int i) {
    const double z = 0.285 + 0.0245 * i, size = 0.042 - 0.0008 * i;
    const part core = {"", {0.5, 0.62, z}, {size, size, 0.0115}, 0, false},
               arch = {"", {0.5, 0.65, z}, {0.5, 0.70, z - 0.012}, 0.009, false};
    b->labels++;
    add(b, &core, b->labels);
    add(b, &arch, b->labels);
}

/* A pair of ribs: chains of rounded cylinders around the chest. */
static void add_ribs(body *b, int i) {
    enum { PIECES = 10 };
    const double top = 0.50 + 0.0245 * i, width = 0.20 - 0.0006 * (i - 4) * (i - 4);
    iso_vec3 before = {0.46, 0.63, top};
    for (int k = 1; k <= PIECES; k++) {
        const double angle = (0.1 + 0.75 * k / PIECES) * ISO_PI;
        const iso_vec3 next = {0.5 - width * sin(angle), 0.5 + 0.15 * cos(angle), top - 0.009 * k};
        const part piece = {"", before, next, 0.008, true};
        add(b, &piece, b->labels + 1);
        add_mirrored(b, &piece, b->labels + 2);
        before = next;
    }
    b->labels += 2;
}

static void fill(body *b) {
    for (size_t i = 0; i < sizeof parts / sizeof *parts; i++) {
        const part *s = &parts[i];
        b->labels += s->name[0] != 0;
        add(b, s, b->labels);
        if (s->both) add_mirrored(b, s, ++b->labels);
    }
    for (int i = 0; i < VERTEBRAE; i++) add_vertebra(b, i);
    for (int i = 0; i < RIBS; i++) add_ribs(b, i);
}

static iso_status write_volume(const char *folder, const char *name, const body *b, const uint8_t *voxels,
                               iso_error *error) {
    char path[1024];
    iso_sink sink = {0};
    snprintf(path, sizeof path, "%s/%s.nrrd", folder, name);
    ISO_TRY(iso_sink_open(path, &sink, error));
    fprintf(sink.stream,
            "NRRD0004\ntype: uint8\ndimension: 3\nsizes: %d %d %d\nspacings: 1.5 1.5 1.5\nencoding: raw\n\n",
            b->side, b->side, b->side);
    fwrite(voxels, (size_t)b->side * (size_t)b->side, (size_t)b->side, sink.stream);
    return iso_sink_commit(&sink, error);
}

int main(int argc, char **argv) {
    iso_error error = {0};
    body b = {.side = argc > 2 ? atoi(argv[2]) : 256};
    if (argc < 2 || b.side < 16 || b.side > 1024) {
        fprintf(stderr, "usage: write_body FOLDER [SIDE]\n");
        return 2;
    }
    const size_t count = (size_t)b.side * (size_t)b.side * (size_t)b.side;
    b.label = calloc(count, 1);
    b.scan = calloc(count, 1);
    b.depth = calloc(count, sizeof *b.depth);
    if (!b.label || !b.scan || !b.depth) return 1;
    for (size_t i = 0; i < count; i++) b.depth[i] = -5;
    fill(&b);
    for (size_t i = 0; i < count; i++) b.scan[i] = (uint8_t)fmin(fmax(128 + 25 * (double)b.depth[i], 0), 255);
    iso_status status = write_volume(argv[1], "body", &b, b.label, &error);
    if (status == ISO_OK) status = write_volume(argv[1], "scan", &b, b.scan, &error);
    if (status != ISO_OK) fprintf(stderr, "write_body: %s\n", error.text);
    printf("%d labels\n", b.labels);
    free(b.label);
    free(b.scan);
    free(b.depth);
    return iso_status_exit(status);
}
