/* Frames of glyphs and tubes, 1024 x 1024, one sample a pixel, one thread; against VTK's frames of the same:
 * spheres by vtkOpenGLSphereMapper and vtkPointGaussianMapper, cones and arrows by vtkGlyph3DMapper, tubes by
 * vtkTubeFilter, whose own time is not counted; tubes also against Embree's rays. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/file.h"
#include "base/memory.h"
#include "bench_harness.h"
#include "render/shapes/shapes.h"
#include "render/view/gbuffer.h"

enum { SIDE = 1024, LINE = 101, PEERS = 2 };

typedef enum shapes_kind { SPHERES, TUBES, CONES, ARROWS, KINDS } shapes_kind;

typedef struct shapes_subject {
    const char *name;
    size_t count;  /* glyphs or segments */
    double pixels; /* mean radius; of cones and arrows the mean length */
    shapes_kind kind;
    /* Of the ratios to the peers, at full size with AVX-512; 0: nothing; -1: the peer is not measured. */
    double asked[PEERS];
    bool builds; /* preparing the set is a part of the frame */
} shapes_subject;

/* ---- the sets: in the cube -1 .. 1 */

typedef struct shapes_set {
    iso_glyphs glyphs;
    iso_lines lines;
    char path[512]; /* the same as a file for vtk_frame */
} shapes_set;

/* The camera sees the cube's sphere at an angle of 30 degrees. */
static iso_camera camera_of(void) {
    const double away = sqrt(3) / 0.25881904510252074; /* sin 15 degrees */
    const iso_vec3 eye = iso_vec3_scale(iso_vec3_unit(iso_vec3_make(0.6, 0.5, 0.7216878)), away);
    return (iso_camera){.position = eye, .view_up = {0, 1, 0}, .view_angle = 30};
}

/* How long a pixel is at the cube's middle. */
static double pixel_size(void) {
    const iso_camera camera = camera_of();
    const iso_view view = iso_view_make(&camera, SIDE, SIDE);
    return iso_vec3_length(camera.position) / view.focal;
}

static double uniform(uint64_t *state) {
    *state = *state * 6364136223846793005u + 1442695040888963407u;
    return (double)(*state >> 11) / 9007199254740992.0;
}

static void scatter_spheres(iso_glyphs *glyphs, double radius) {
    uint64_t seed = 1;
    for (size_t i = 0; i < glyphs->count; i++) {
        for (int a = 0; a < 3; a++) glyphs->positions[i][a] = (float)(2 * uniform(&seed) - 1);
        glyphs->radii[i] = (float)(radius * (0.5 + uniform(&seed)));
    }
}

/* Glyphs in all directions. */
static void scatter_directed(iso_glyphs *glyphs, double length) {
    uint64_t seed = 1;
    for (size_t i = 0; i < glyphs->count; i++) {
        double way[3], square = 0;
        for (int a = 0; a < 3; a++) {
            glyphs->positions[i][a] = (float)(2 * uniform(&seed) - 1);
            way[a] = 2 * uniform(&seed) - 1;
            square += way[a] * way[a];
        }
        const double scale = length * (0.5 + uniform(&seed)) / sqrt(square);
        for (int a = 0; a < 3; a++) glyphs->directions[i][a] = (float)(way[a] * scale);
    }
}

/* A walk that bends, reflected by the cube's faces. */
static void walk(float (*vertices)[3], double step, uint64_t *seed) {
    double at[3], way[3];
    for (int a = 0; a < 3; a++) at[a] = 2 * uniform(seed) - 1, way[a] = uniform(seed) - 0.5;
    for (int i = 0; i < LINE; i++) {
        double square = 0;
        for (int a = 0; a < 3; a++) {
            vertices[i][a] = (float)at[a];
            way[a] += 0.3 * (uniform(seed) - 0.5);
            square += way[a] * way[a];
        }
        for (int a = 0; a < 3; a++) {
            at[a] += step * (way[a] /= sqrt(square));
            if (fabs(at[a]) > 1) at[a] = copysign(2, at[a]) - at[a], way[a] = -way[a];
        }
    }
}

static iso_status make_lines(const shapes_subject *subject, iso_lines *lines, iso_error *error) {
    const double pixel = pixel_size();
    uint64_t seed = 1;
    lines->line_count = subject->count / (LINE - 1);
    lines->vertex_count = lines->line_count * LINE;
    lines->vertices = iso_alloc(lines->vertex_count * sizeof *lines->vertices);
    lines->radii = iso_alloc(lines->vertex_count * sizeof *lines->radii);
    lines->starts = iso_alloc((lines->line_count + 1) * sizeof *lines->starts);
    if (!lines->vertices || !lines->radii || !lines->starts) return iso_fail_memory(error, subject->name);
    for (size_t i = 0; i <= lines->line_count; i++) lines->starts[i] = i * LINE;
    for (size_t i = 0; i < lines->line_count; i++) walk(lines->vertices + i * LINE, 4 * pixel, &seed);
    for (size_t i = 0; i < lines->vertex_count; i++) lines->radii[i] = (float)(subject->pixels * pixel);
    return ISO_OK;
}

/* Once, when the first row needs it. */
static iso_status make_set(const shapes_subject *subject, shapes_set *made, iso_error *error) {
    iso_glyphs *glyphs = &made->glyphs;
    const double size = subject->pixels * pixel_size();
    if (made->lines.starts || glyphs->positions) return ISO_OK;
    if (subject->kind == TUBES) return make_lines(subject, &made->lines, error);
    glyphs->count = subject->count;
    glyphs->positions = iso_alloc(glyphs->count * sizeof *glyphs->positions);
    if (subject->kind == SPHERES)
        glyphs->radii = iso_alloc(glyphs->count * sizeof *glyphs->radii);
    else
        glyphs->directions = iso_alloc(glyphs->count * sizeof *glyphs->directions);
    if (!glyphs->positions || (!glyphs->radii && !glyphs->directions))
        return iso_fail_memory(error, subject->name);
    if (subject->kind == SPHERES)
        scatter_spheres(glyphs, size);
    else
        scatter_directed(glyphs, size);
    return ISO_OK;
}

static iso_status write_set(const shapes_subject *subject, shapes_set *made, iso_error *error) {
    const char *folder = getenv("TMPDIR");
    iso_sink sink = {0};
    snprintf(made->path, sizeof made->path, "%.400s/isopoint-bench-%ld.points", folder ? folder : "/tmp",
             (long)getpid());
    ISO_TRY(iso_sink_open(made->path, &sink, error));
    const bool tubes = subject->kind == TUBES;
    const iso_glyphs *glyphs = &made->glyphs;
    const size_t points = tubes ? made->lines.vertex_count : glyphs->count;
    const int64_t counts[2] = {(int64_t)points, (int64_t)made->lines.line_count};
    fwrite(counts, sizeof *counts, 2, sink.stream);
    fwrite(tubes ? made->lines.vertices : glyphs->positions, 3 * sizeof(float), points, sink.stream);
    if (glyphs->directions)
        fwrite(glyphs->directions, 3 * sizeof(float), points, sink.stream);
    else
        fwrite(tubes ? made->lines.radii : glyphs->radii, sizeof(float), points, sink.stream);
    return iso_sink_commit(&sink, error);
}

static void free_set(shapes_set *made) {
    iso_glyphs_free(&made->glyphs);
    iso_lines_free(&made->lines);
    if (made->path[0]) remove(made->path);
}

/* ---- rows */

typedef struct shapes_plan {
    const shapes_subject *subject;
    shapes_set *set;  /* borrowed */
    const char *peer; /* "embree", or how vtk_frame draws it; NULL: ours */
} shapes_plan;

typedef struct shapes_work {
    iso_shapes *shapes;
    iso_gbuffer gbuffer;
    bench_child *child;
    size_t covered;
} shapes_work;

static iso_status build_ours(const shapes_plan *plan, shapes_work *work, iso_error *error) {
    static const iso_glyph glyphs[KINDS] = {[CONES] = ISO_GLYPH_CONE, [ARROWS] = ISO_GLYPH_ARROW};
    const iso_shapes_opts opts = {.glyph = glyphs[plan->subject->kind]};
    iso_shapes_destroy(work->shapes);
    work->shapes = NULL;
    if (plan->subject->kind == TUBES)
        return iso_shapes_from_lines(&plan->set->lines, &opts, &work->shapes, error);
    return iso_shapes_from_glyphs(&plan->set->glyphs, &opts, &work->shapes, error);
}

static iso_status open_ours(const shapes_plan *plan, shapes_work *work, iso_error *error) {
    ISO_TRY(iso_gbuffer_create(SIDE, SIDE, &work->gbuffer, error));
    return build_ours(plan, work, error);
}

static iso_status open_peer(bench_row *row, const shapes_plan *plan, shapes_work *work, iso_error *error) {
    char program[1100], line[512];
    const char *display = NULL;
    const bool embree = strcmp(plan->peer, "embree") == 0;
    const iso_camera c = camera_of();
    if (!plan->set->path[0]) ISO_TRY(write_set(plan->subject, plan->set, error));
    ISO_TRY(bench_sibling(embree ? "embree_frame" : "vtk_frame", program, sizeof program, error));
    if (!embree) ISO_TRY(bench_display_open(&row->bench->display, &display, error));
    const char *const vtk[] = {program, plan->peer, plan->set->path, NULL};
    const char *const rays[] = {program, plan->set->path, NULL};
    ISO_TRY(bench_child_start(embree ? rays : vtk, 1, display, &work->child, error));
    ISO_TRY(bench_child_ask(work->child, NULL, line, sizeof line, error));
    snprintf(program, sizeof program, "view %d %d %.17g %.17g %.17g 0 0 0 0 1 0 30 0 0", SIDE, SIDE,
             c.position.x, c.position.y, c.position.z);
    ISO_TRY(bench_child_ask(work->child, program, line, sizeof line, error));
    ISO_TRY(bench_child_ask(work->child, "covered", line, sizeof line, error));
    if (sscanf(line, "covered %zu", &work->covered) != 1)
        return iso_fail(error, ISO_ERR_UNSUPPORTED, "the peer said '%.80s'", line);
    return ISO_OK;
}

static iso_status open_row(bench_row *row, iso_error *error) {
    const shapes_plan *plan = row->plan;
    shapes_work *work = calloc(1, sizeof *work);
    if (!work) return iso_fail(error, ISO_ERR_NOMEM, "out of memory");
    row->context = work;
    ISO_TRY(make_set(plan->subject, plan->set, error));
    return plan->peer ? open_peer(row, plan, work, error) : open_ours(plan, work, error);
}

static iso_status run_ours(bench_row *row, bench_sample *sample, iso_error *error) {
    const iso_camera camera = camera_of();
    const iso_view view = iso_view_make(&camera, SIDE, SIDE);
    shapes_work *work = row->context;
    const iso_target target = {.view = &view, .gbuffer = &work->gbuffer};
    const shapes_plan *plan = row->plan;
    iso_shapes_drawn drawn = {0};
    iso_cpu_limit(row->level);
    const bench_clock clock = bench_clock_start();
    iso_status status = plan->subject->builds ? build_ours(plan, work, error) : ISO_OK;
    iso_gbuffer_clear(&work->gbuffer);
    if (status == ISO_OK) status = iso_draw_shapes(&target, work->shapes, &drawn, error);
    bench_clock_stop(&clock, sample);
    iso_cpu_limit(ISO_CPU_AVX512);
    work->covered = drawn.samples;
    return status;
}

static iso_status run_peer(bench_row *row, bench_sample *sample, iso_error *error) {
    const shapes_work *work = row->context;
    const shapes_plan *plan = row->plan;
    char line[256];
    ISO_TRY(
        bench_child_ask(work->child, plan->subject->builds ? "built" : "frame", line, sizeof line, error));
    if (sscanf(line, "frame %lf %lf", &sample->wall, &sample->cpu) != 2)
        return iso_fail(error, ISO_ERR_UNSUPPORTED, "the peer said '%.80s'", line);
    return ISO_OK;
}

static iso_status run_row(bench_row *row, bench_sample *sample, iso_error *error) {
    const shapes_plan *plan = row->plan;
    sample->primitives = plan->subject->count;
    return plan->peer ? run_peer(row, sample, error) : run_ours(row, sample, error);
}

static void finish_row(bench_row *row) {
    const shapes_work *work = row->context;
    bench_count(row, "covered_pixels", (double)work->covered, 0, 0);
}

static void close_row(bench_row *row) {
    shapes_work *work = row->context;
    if (!work) return;
    iso_shapes_destroy(work->shapes);
    iso_gbuffer_free(&work->gbuffer);
    bench_child_stop(work->child);
    free(work);
}

static const bench_kind ours_kind = {
    .open = open_row, .run = run_row, .finish = finish_row, .close = close_row};
static const bench_kind peer_kind = {
    .open = open_row, .run = run_row, .finish = finish_row, .close = close_row, .batch = 1, .rounds = 5};

static void give_plan(bench_row *row, const shapes_subject *subject, shapes_set *set, const char *peer) {
    shapes_plan *plan = calloc(1, sizeof *plan);
    if (!plan) abort(); /* (as bench_add does when there are too many rows) */
    *plan = (shapes_plan){subject, set, peer};
    row->plan = plan;
    row->threads = 1;
}

static void add_rows(bench_state *bench, const shapes_subject *subject, shapes_set *set) {
    static const char *const peers[KINDS][PEERS] = {
        {"spheres", "gaussians"}, {"tubes", "embree"}, {"cones", NULL}, {"arrows", NULL}};
    static const char *const ratios[KINDS][PEERS] = {{"ratio_vs_vtk_sphere_mapper", "ratio_vs_vtk_gaussians"},
                                                     {"ratio_vs_vtk_tubes", "ratio_vs_embree"},
                                                     {"ratio_vs_vtk_glyph_mapper", NULL},
                                                     {"ratio_vs_vtk_glyph_mapper", NULL}};
    bench_row *others[PEERS] = {NULL};
    for (int i = 0; i < PEERS; i++) {
        const char *peer = peers[subject->kind][i];
        if (!peer || !(subject->asked[i] >= 0)) continue;
        others[i] = bench_add(bench, &peer_kind, "render/shapes/%s/%s%s", subject->name,
                              strcmp(peer, "embree") == 0 ? "" : "vtk_", peer);
        give_plan(others[i], subject, set, peer);
    }
    for (iso_cpu_level level = ISO_CPU_GENERIC; level <= bench->best; level++) {
        bench_row *row = bench_add(bench, &ours_kind, "render/shapes/%s/%s/threads:1", subject->name,
                                   iso_cpu_level_name(level));
        give_plan(row, subject, set, NULL);
        row->level = level;
        const double part = level == ISO_CPU_AVX512 ? 1 : level == ISO_CPU_AVX2 ? 0.65 : 0;
        for (int i = 0; i < PEERS; i++) {
            if (!others[i]) continue;
            bench_against *against = bench_compare(row, others[i], ratios[subject->kind][i], NULL,
                                                   bench->settings->small ? 0 : part * subject->asked[i]);
            static const char *const names[KINDS][PEERS] = {
                {"cpu_ratio_vs_vtk", "cpu_ratio_vs_vtk_gaussians"},
                {"cpu_ratio_vs_vtk", "cpu_ratio_vs_embree"}};
            const char *name = names[subject->kind][i];
            if (against) against->cpu = name ? name : "cpu_ratio_vs_vtk";
        }
    }
}

static iso_status run_subject(bench_state *bench, const shapes_subject *subject, iso_error *error) {
    char title[96];
    shapes_set made = {.path = ""};
    add_rows(bench, subject, &made);
    snprintf(title, sizeof title, "frames of %s", subject->name);
    const iso_status status = bench_run_group(bench, title, error);
    free_set(&made);
    return status;
}

iso_status bench_shapes_groups(bench_state *bench, iso_error *error) {
    static const shapes_subject large[] = {
        {"spheres-0.1M-3px", 100000, 3, SPHERES, {20, 12}, false},
        {"spheres-1M-3px", 1000000, 3, SPHERES, {100, 45}, false},
        {"spheres-5M-3px", 5000000, 3, SPHERES, {180, 80}, false},
        {"spheres-1M-1px", 1000000, 1, SPHERES, {20, 0}, false},
        {"spheres-1M-10px", 1000000, 10, SPHERES, {200, 0}, false},
        {"tubes-0.1M-1.5px", 100000, 1.5, TUBES, {18, 12}, false},
        {"tubes-1M-1.5px", 1000000, 1.5, TUBES, {75, 5}, false},
        {"tubes-1M-1.5px-built", 1000000, 1.5, TUBES, {-1, 8}, true},
        {"tubes-10M-1.5px", 10000000, 1.5, TUBES, {-1, 2}, false}, /* VTK's tubes need 16 GB */
        {"cones-0.1M-6px", 100000, 6, CONES, {30, 0}, false},
        {"cones-1M-6px", 1000000, 6, CONES, {50, 0}, false},
        {"arrows-0.1M-6px", 100000, 6, ARROWS, {30, 0}, false},
        {"arrows-1M-6px", 1000000, 6, ARROWS, {50, 0}, false}};
    static const shapes_subject small[] = {{"spheres-2k-3px", 2000, 3, SPHERES, {0}, false},
                                           {"tubes-2k-1.5px", 2000, 1.5, TUBES, {0}, false},
                                           {"cones-2k-6px", 2000, 6, CONES, {0}, false},
                                           {"arrows-2k-6px", 2000, 6, ARROWS, {0}, false}};
    const bool few = bench->settings->small;
    const shapes_subject *subjects = few ? small : large;
    const size_t count = few ? sizeof small / sizeof *small : sizeof large / sizeof *large;
    for (size_t i = 0; i < count; i++) ISO_TRY(run_subject(bench, &subjects[i], error));
    return ISO_OK;
}
