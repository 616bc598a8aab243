/* What is asked of pictures, and which of it they do not reach. */
#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

#include "bench_quality.h"

typedef struct tally {
    int asked, missed;
} tally;

static int zoom_index(int zoom) {
    return zoom == 1 ? 0 : zoom == 4 ? 1 : 2;
}

/* Counts a demand, and says it when it is not met. */
static void demand(tally *t, const quality_row *r, bool met, const char *what, double value, double bound) {
    t->asked++;
    if (met) return;
    t->missed++;
    printf("  %-14s %2d %-17s %-34s %9.3f, asked: %g\n", r->volume, r->zoom, r->method->name, what, value,
           bound);
}

static const quality_row *find(const quality_row *rows, int count, const quality_row *like,
                               const char *method) {
    for (const quality_row *r = rows; r < rows + count; r++)
        if (r->zoom == like->zoom && strcmp(r->volume, like->volume) == 0 &&
            strcmp(r->method->name, method) == 0)
            return r;
    return NULL;
}

static void judge_pullpush_psnr(tally *t, const quality_row *r) {
    static const struct {
        const char *volume;
        double least[3];
    } asked[] = {{"vase", {41, 42, 50}},
                 {"tooth", {33.5, 36, 36.5}},
                 {"FLAIR", {25, 27.5, 28}},
                 {"stent", {16, 14.5, 14.5}},
                 {"sphere.vdb", {49.5, 49.5, 49.5}}};
    for (size_t i = 0; i < sizeof asked / sizeof *asked; i++) {
        if (strcmp(asked[i].volume, r->volume) != 0) continue;
        double least = asked[i].least[zoom_index(r->zoom)];
        demand(t, r, r->metrics.psnr_in >= least, "psnr_in, at least", r->metrics.psnr_in, least);
    }
}

static void judge_pullpush(tally *t, const quality_row *r, const quality_row *mesh) {
    const iso_metrics *m = &r->metrics;
    bool stent = strcmp(r->volume, "stent") == 0, iron = strcmp(r->volume, "ironProt") == 0;
    bool sphere = strncmp(r->volume, "sphere", 6) == 0;
    double holes = stent ? 0.5 : 0.2, dilation = stent || iron ? 0.5 : 0.15;
    judge_pullpush_psnr(t, r);
    demand(t, r, !(m->holes > holes), "holes, %, at most", m->holes, holes);
    demand(t, r, !(fabs(m->dilation_mean_voxel) > dilation), "mean dilation, voxels, at most",
           m->dilation_mean_voxel, dilation);
    if (!mesh) return;
    double turned = mesh->metrics.normal_error_deg + (stent ? 6 : 1.5), near = mesh->metrics.psnr_in - 7.5;
    demand(t, r, m->normal_error_deg <= turned, "normal error, degrees, at most", m->normal_error_deg,
           turned);
    if (!sphere) demand(t, r, m->psnr_in >= near, "psnr_in, the mesh's less 7.5", m->psnr_in, near);
}

static void judge_exact(tally *t, const quality_row *r) {
    const iso_metrics *m = &r->metrics;
    if (r->pixels_per_voxel < 1) return;
    demand(t, r, m->missing == 0, "silhouette pixels missing", (double)m->missing, 0);
    demand(t, r, m->extra <= 2, "extra silhouette pixels", (double)m->extra, 2);
    demand(t, r, m->depth_off <= 5, "pixels off by 1e-3 voxel in depth", (double)m->depth_off, 5);
    demand(t, r, m->others_differing == 0, "others that differ in colour", (double)m->others_differing, 0);
}

void quality_print_asked(const quality_row *rows, int count) {
    tally t = {0};
    size_t missing = 0, extra = 0, off = 0, others = 0, pictures = 0;
    printf("\nwhat is asked for and not reached\n");
    for (const quality_row *r = rows; r < rows + count; r++) {
        if (strcmp(r->method->name, "pullpush") == 0) judge_pullpush(&t, r, find(rows, count, r, "mesh"));
        if (strcmp(r->method->name, "exact") != 0) continue;
        judge_exact(&t, r);
        pictures++;
        missing += r->metrics.missing;
        extra += r->metrics.extra;
        off += r->metrics.depth_off;
        others += r->metrics.others_differing;
    }
    printf("%d of %d demands are met\n", t.asked - t.missed, t.asked);
    if (pictures)
        printf("exact, all %zu pictures: %zu silhouette pixels missing, %zu extra, %zu pixels off in depth, "
               "%zu others of "
               "another colour\n",
               pictures, missing, extra, off, others);
}
