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

static void judge_discs_psnr(tally *t, const quality_row *r) {
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

static void judge_discs(tally *t, const quality_row *r, const quality_row *mesh) {
    const iso_metrics *m = &r->metrics;
    bool stent = strcmp(r->volume, "stent") == 0, iron = strcmp(r->volume, "ironProt") == 0;
    bool sphere = strncmp(r->volume, "sphere", 6) == 0;
    double holes = stent ? 0.5 : 0.2, dilation = stent || iron ? 0.5 : 0.15;
    judge_discs_psnr(t, r);
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

/* The means of a method over the study's volumes at a zoom; false unless all seven are there. */
static bool mean_of_study(const quality_row *rows, int count, const char *method, int zoom,
                          quality_row *mean) {
    int seen = 0;
    double psnr = 0, holes = 0;
    for (const quality_row *r = rows; r < rows + count; r++) {
        if (r->zoom != zoom || strcmp(r->method->name, method) != 0 || !quality_is_in_study(r->volume))
            continue;
        *mean = *r;
        psnr += r->metrics.psnr_in;
        holes += isnan(r->metrics.holes) ? 0 : r->metrics.holes;
        seen++;
    }
    if (seen != 7) return false;
    strcpy(mean->volume, "mean of seven");
    mean->metrics.psnr_in = psnr / seen;
    mean->metrics.holes = holes / seen;
    return true;
}

/* Splats are judged by means: flat discs by fixed numbers, discs in one pass by flat ones. */
static void judge_splats(tally *t, const quality_row *rows, int count) {
    static const double least[3] = {30.6, 31.5, 33};
    static const int zooms[3] = {1, 4, 16};
    for (int z = 0; z < 3; z++) {
        quality_row flat, onepass;
        if (!mean_of_study(rows, count, "splats-flat", zooms[z], &flat)) continue;
        const double near = flat.metrics.psnr_in - 0.2;
        demand(t, &flat, flat.metrics.psnr_in >= least[z], "psnr_in, at least", flat.metrics.psnr_in,
               least[z]);
        demand(t, &flat, flat.metrics.holes <= 0.05, "holes, %, at most", flat.metrics.holes, 0.05);
        if (!mean_of_study(rows, count, "splats-onepass", zooms[z], &onepass)) continue;
        demand(t, &onepass, onepass.metrics.psnr_in >= near, "psnr_in, flat's less 0.2",
               onepass.metrics.psnr_in, near);
    }
}

void quality_print_asked(const quality_row *rows, int count) {
    tally t = {0};
    size_t missing = 0, extra = 0, off = 0, others = 0, pictures = 0;
    printf("\nwhat is asked for and not reached\n");
    for (const quality_row *r = rows; r < rows + count; r++) {
        if (strcmp(r->method->name, "discs") == 0) judge_discs(&t, r, find(rows, count, r, "mesh"));
        if (strcmp(r->method->name, "exact") != 0) continue;
        judge_exact(&t, r);
        pictures++;
        missing += r->metrics.missing;
        extra += r->metrics.extra;
        off += r->metrics.depth_off;
        others += r->metrics.others_differing;
    }
    judge_splats(&t, rows, count);
    printf("%d of %d demands are met\n", t.asked - t.missed, t.asked);
    if (pictures)
        printf("exact, all %zu pictures: %zu silhouette pixels missing, %zu extra, %zu pixels off in depth, "
               "%zu others of "
               "another colour\n",
               pictures, missing, extra, off, others);
}
