/* bench render: from primitives to pixels, 1024 x 1024, one sample a pixel; against VTK's frame of the
 * corresponding mesh at the same number of threads. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "bench_gl.h"

/* ---- what is asked for ---- */

static bool is_method(const bench_method *method, const char *name) {
    return strcmp(method->name, name) == 0;
}

/* Pull-push is judged by the bumpy sphere, at full size and with what this machine does best. */
static bool is_judged_pullpush(const bench_row *row, const bench_method *method) {
    const bench_frame_plan *plan = row->plan;
    return is_method(method, "pullpush") && row->level == row->bench->best && plan &&
           plan->subject->bumpy_side && !row->bench->settings->small;
}

static bool is_judged_exact(const bench_row *row, const bench_method *method) {
    return is_method(method, "exact") && row->level != ISO_CPU_GENERIC && !row->bench->settings->small;
}

/* Of VTK's time for the mesh. */
static double asked_of_vtk(const bench_row *row, const bench_method *method) {
    if (is_judged_pullpush(row, method)) return 40;
    if (!is_judged_exact(row, method)) return 0;
    return row->level == ISO_CPU_AVX512 ? 20 : 10;
}

/* Of one thread's time. */
static double asked_of_scaling(const bench_row *row, const bench_method *method) {
    bool asked = is_judged_pullpush(row, method) || is_judged_exact(row, method);
    return asked && row->threads == 2 ? 1.6 : 0;
}

/* ---- the rows of a group ---- */

enum { SUBJECTS = 4, METHODS = 16, GL_METHODS = 4 };

/* How VTK draws a translucent mesh. */
enum { VTK_LAYERS = 2 };
static const struct vtk_layers {
    const char *name;
    int peels;
    const char *ratio;
    double asked;
} vtk_layers[VTK_LAYERS] = {{"vtk_peeling", 100, "ratio_vs_vtk_peeling", 25},
                            {"vtk_average", 0, "ratio_vs_vtk_average", 10}};

typedef struct frame_group {
    bench_state *bench;
    bench_subject subjects[SUBJECTS];
    int subject_count, view_count;
    bench_row *vtk[SUBJECTS][BENCH_VIEWS][BENCH_THREADS];
    bench_row *vtk_points[SUBJECTS][BENCH_THREADS]; /* at fit */
    bench_row *vtk_layers[SUBJECTS][BENCH_VIEWS][VTK_LAYERS][BENCH_THREADS];
    bench_gl *gl; /* NULL: not in this group */
    bench_row *gl_rows[SUBJECTS][GL_METHODS];
    bench_row *rows[SUBJECTS][BENCH_VIEWS][METHODS][ISO_CPU_LEVELS][BENCH_THREADS];
} frame_group;

/* "1M", or with several views "ct512/fit" */
static void describe(const frame_group *group, int subject, int view, char text[64]) {
    static const char *const names[BENCH_VIEWS] = {"fit", "4x"};
    bool several = group->view_count > 1;
    snprintf(text, 64, "%.31s%s%s", group->subjects[subject].name, several ? "/" : "",
             several ? names[view] : "");
}

static void add_plan(bench_row *row, const bench_method *method, bench_subject *subject, int view) {
    bench_frame_plan *plan = calloc(1, sizeof *plan);
    if (plan)
        *plan = (bench_frame_plan){
            .method = method, .subject = subject, .view = view, .vtk_peels = BENCH_VTK_OPAQUE};
    row->plan = plan;
}

static void add_vtk(frame_group *group, int subject, int view) {
    const bench_settings *settings = group->bench->settings;
    char text[64];
    describe(group, subject, view, text);
    for (int t = 0; t < settings->thread_count; t++) {
        bench_row *row = bench_add(group->bench, &bench_vtk_kind, "render/vtk_frame/%s/threads:%d", text,
                                   settings->threads[t]);
        row->threads = settings->threads[t];
        add_plan(row, NULL, &group->subjects[subject], view);
        group->vtk[subject][view][t] = row;
    }
}

static void add_vtk_points(frame_group *group, int subject) {
    const bench_settings *settings = group->bench->settings;
    char text[64];
    describe(group, subject, 0, text);
    for (int t = 0; t < settings->thread_count; t++) {
        bench_row *row = bench_add(group->bench, &bench_vtk_kind, "render/vtk_gaussians/%s/threads:%d", text,
                                   settings->threads[t]);
        row->threads = settings->threads[t];
        add_plan(row, NULL, &group->subjects[subject], 0);
        if (row->plan) ((bench_frame_plan *)row->plan)->vtk_points = true;
        group->vtk_points[subject][t] = row;
    }
}

static void add_vtk_layers(frame_group *group, int subject, int view, int mode) {
    const bench_settings *settings = group->bench->settings;
    char text[64];
    describe(group, subject, view, text);
    for (int t = 0; t < settings->thread_count; t++) {
        bench_row *row = bench_add(group->bench, &bench_vtk_kind, "render/%s/%s/threads:%d",
                                   vtk_layers[mode].name, text, settings->threads[t]);
        row->threads = settings->threads[t];
        add_plan(row, NULL, &group->subjects[subject], view);
        if (row->plan) ((bench_frame_plan *)row->plan)->vtk_peels = vtk_layers[mode].peels;
        group->vtk_layers[subject][view][mode][t] = row;
    }
}

static void add_method(frame_group *group, int subject, int view, int number) {
    const bench_method *method = &bench_methods[number];
    bench_state *bench = group->bench;
    const bench_settings *settings = bench->settings;
    const bench_kind *kind = method->slow ? &bench_slow_frame_kind : &bench_frame_kind;
    char text[64];
    describe(group, subject, view, text);
    for (int level = method->kernels ? 0 : (int)bench->best; level <= (int)bench->best; level++)
        for (int t = 0; t < settings->thread_count; t++) {
            const char *variant = method->kernels ? iso_cpu_level_name((iso_cpu_level)level) : "";
            bench_row *row = bench_add(bench, kind, "render/%s/%s%s%s/threads:%d", method->name, text,
                                       method->kernels ? "/" : "", variant, settings->threads[t]);
            row->threads = settings->threads[t];
            row->level = (iso_cpu_level)level;
            add_plan(row, method, &group->subjects[subject], view);
            group->rows[subject][view][number][level][t] = row;
        }
}

/* OpenGL draws with what threads it likes; shading after it takes as many as a row may. */
static void add_gl(frame_group *group, int subject) {
    const bench_settings *settings = group->bench->settings;
    for (int m = 0; m < bench_gl_method_count; m++) {
        const bench_method *method = &bench_gl_methods[m];
        if (group->subjects[subject].bumpy_meshless && is_method(method, "gl_mesh")) continue;
        if (is_method(method, "gl_discs") && !iso_gl_context_info(group->gl->context).hardware)
            continue; /* a frame of many points takes software a minute */
        bench_row *row = bench_add(group->bench, &bench_slow_frame_kind, "render/%s/%s/%s", method->name,
                                   group->subjects[subject].name, group->gl->name);
        row->threads = settings->threads[settings->thread_count - 1];
        add_plan(row, method, &group->subjects[subject], 0);
        if (row->plan) ((bench_frame_plan *)row->plan)->gl = group->gl;
        group->gl_rows[subject][m] = row;
    }
}

/* ---- what they are compared with ---- */

/* Position of a method in the table, -1 when there is none. */
static int method_number(const char *name) {
    for (int m = 0; m < bench_method_count; m++)
        if (is_method(&bench_methods[m], name)) return m;
    return -1;
}

/* The row of another method at the same threads; of the best level when it has but one. */
static bench_row *row_of(const frame_group *group, int subject, int view, const char *name,
                         const bench_row *like, int t) {
    int m = method_number(name);
    if (m < 0) return NULL;
    iso_cpu_level level = bench_methods[m].kernels ? like->level : group->bench->best;
    bench_row *row = group->rows[subject][view][m][level][t];
    return row == like ? NULL : row;
}

static void compare_exact(const frame_group *group, bench_row *row, int subject, int view, int t) {
    const bench_method *method = &bench_methods[method_number("exact")];
    bench_compare(row, row_of(group, subject, view, "raycast", row, t), "ratio_vs_raycast", NULL,
                  is_judged_exact(row, method) ? 5 : 0);
    bench_compare(row, row_of(group, subject, view, "pullpush", row, t), "ratio_vs_pullpush", NULL, 0);
}

static bool is_layers(const bench_method *method) {
    return strncmp(method->name, "layers/", 7) == 0;
}

/* Translucent at one half: at most six opaque frames, and far from VTK's two ways. By angle the opacity costs
 * a power. */
static void compare_layers(const frame_group *group, bench_row *row, const bench_method *method, int subject,
                           int view, int t) {
    const bool judged = row->level == group->bench->best && !group->bench->settings->small,
               constant = is_method(method, "layers/constant");
    bench_compare(row, row_of(group, subject, view, "exact", row, t), "ratio_vs_opaque", NULL,
                  judged && constant && row->threads == 1 ? 1.0 / 6 : 0);
    if (!constant)
        bench_compare(row, row_of(group, subject, view, "layers/constant", row, t), "ratio_vs_constant", NULL,
                      judged ? 1 / 1.3 : 0);
    for (int mode = 0; mode < VTK_LAYERS && constant; mode++)
        bench_compare(row, group->vtk_layers[subject][view][mode][t], vtk_layers[mode].ratio, NULL,
                      judged ? vtk_layers[mode].asked : 0);
}

/* The same method by OpenGL. Pull-push is asked to be faster than a software renderer alone. */
static void compare_gl(const frame_group *group, bench_row *row, const bench_method *method, int subject) {
    if (!group->gl || !group->gl->context || row->level != group->bench->best) return;
    for (int m = 0; m < bench_gl_method_count; m++) {
        if (strcmp(bench_gl_methods[m].name + strlen("gl_"), method->name) != 0) continue;
        bool asked =
            is_judged_pullpush(row, method) && !iso_gl_context_info(group->gl->context).hardware &&
            row->threads == group->bench->settings->threads[group->bench->settings->thread_count - 1];
        bench_compare(row, group->gl_rows[subject][m], "ratio_vs_gl", NULL, asked ? 20 : 0);
    }
}

/* A twentyfold of points in at most five times the time; discs in three times pull-push's; the most points
 * with levels of detail in a third of the discs'. */
static void compare_pullpush(const frame_group *group, bench_row *row, const bench_method *method,
                             int subject, int view, int t) {
    bool judged = group->subjects[subject].bumpy_side && row->level == group->bench->best &&
                  !group->bench->settings->small;
    if (is_method(method, "discs"))
        bench_compare(row, row_of(group, subject, view, "pullpush", row, t), "ratio_vs_pullpush", NULL,
                      judged ? 1.0 / 3 : 0);
    bool most = group->subject_count == SUBJECTS && subject == SUBJECTS - 1;
    if (is_method(method, "discs/lod"))
        bench_compare(row, row_of(group, subject, view, "discs", row, t), "ratio_vs_discs", NULL,
                      most && judged ? 3 : 0);
    if (most && is_method(method, "pullpush"))
        bench_compare(row, group->rows[1][view][method_number(method->name)][row->level][t], "ratio_vs_1M",
                      NULL, judged ? 1.0 / 5 : 0);
}

/* Colours may cost a seventh; VTK's way to draw the same points is far slower. */
static void compare_splats(const frame_group *group, bench_row *row, const bench_method *method, int subject,
                           int view, int t) {
    const bool judged = row->level == group->bench->best && !group->bench->settings->small;
    bench_against *vtk =
        bench_compare(row, group->vtk_points[subject][t], "ratio_vs_vtk_gaussians", NULL, judged ? 40 : 0);
    if (vtk && row->threads == 1) vtk->cpu = "ratio_vs_vtk_gaussians_cpu";
    bench_compare(row, row_of(group, subject, view, "discs", row, t), "ratio_vs_discs", NULL, 0);
    if (is_method(method, "splats/colors"))
        bench_compare(row, row_of(group, subject, view, "splats/flat", row, t), "ratio_vs_flat", NULL,
                      judged && row->threads == 1 ? 1 / 1.15 : 0);
}

static void compare_row(const frame_group *group, int subject, int view, int number, int t) {
    const bench_method *method = &bench_methods[number];
    int single = bench_single_thread(group->bench->settings);
    for (int level = 0; level < ISO_CPU_LEVELS; level++) {
        bench_row *row = group->rows[subject][view][number][level][t];
        if (!row) continue;
        bench_against *vtk = is_layers(method)
                                 ? NULL
                                 : bench_compare(row, group->vtk[subject][view][t], "ratio_vs_vtk_frame",
                                                 "ratio_vs_vtk_frame_pairwise", asked_of_vtk(row, method));
        if (vtk && row->threads == 1) vtk->cpu = "ratio_vs_vtk_frame_cpu";
        if (is_method(method, "exact")) compare_exact(group, row, subject, view, t);
        if (is_layers(method)) compare_layers(group, row, method, subject, view, t);
        compare_pullpush(group, row, method, subject, view, t);
        if (strncmp(method->name, "splats/", 7) == 0) compare_splats(group, row, method, subject, view, t);
        compare_gl(group, row, method, subject);
        if (single >= 0 && single != t)
            bench_compare(row, group->rows[subject][view][number][level][single], "scaling", NULL,
                          asked_of_scaling(row, method));
    }
}

static void add_view(frame_group *group, int subject, int view) {
    const bench_subject *what = &group->subjects[subject];
    if (!what->bumpy_meshless) add_vtk(group, subject, view);
    if (what->bumpy_side) add_vtk_points(group, subject);
    for (int mode = 0; mode < VTK_LAYERS && !what->bumpy_side; mode++)
        add_vtk_layers(group, subject, view, mode);
    for (int m = 0; m < bench_method_count; m++) {
        const bench_method *method = &bench_methods[m];
        bool fits = what->bumpy_side ? method->on_bumpy : method->on_volumes;
        if (fits && !(what->bumpy_meshless && is_method(method, "mesh"))) add_method(group, subject, view, m);
    }
    if (group->gl && group->gl->context) add_gl(group, subject);
}

/* Of the most points that pull-push by OpenGL was measured with. */
static void say_limit(const frame_group *group) {
    const bench_row *most = NULL;
    for (int s = 0; s < group->subject_count; s++)
        for (int m = 0; m < bench_gl_method_count; m++) {
            const bench_row *row = group->gl_rows[s][m];
            if (row && row->rounds && is_method(&bench_gl_methods[m], "gl_pullpush")) most = row;
        }
    if (most) bench_gl_say_limit(group->gl, most);
}

static iso_status run_frames(frame_group *group, const char *title, iso_error *error) {
    for (int s = 0; s < group->subject_count; s++)
        for (int v = 0; v < group->view_count; v++) add_view(group, s, v);
    for (int s = 0; s < group->subject_count; s++)
        for (int v = 0; v < group->view_count; v++)
            for (int m = 0; m < bench_method_count; m++)
                for (int t = 0; t < group->bench->settings->thread_count; t++) compare_row(group, s, v, m, t);
    iso_status status = bench_run_group(group->bench, title, error);
    for (int s = 0; s < group->subject_count; s++) bench_subject_end(&group->subjects[s]);
    return status;
}

/* ---- the groups ---- */

/* About 0.3, 1, 5 and 20 million points; the last one is too fine for one hgrid, and for VTK's patience. */
static iso_status run_bumpy(bench_state *bench, bench_gl *gl, iso_error *error) {
    static const char *const names[SUBJECTS] = {"0.3M", "1M", "5M", "20M"};
    static const char *const small_names[SUBJECTS] = {"4k", "8k", "14k", "25k"};
    static const int sides[SUBJECTS] = {327, 597, 1336, 2672}, small_sides[SUBJECTS] = {40, 56, 72, 96};
    bool small = bench->settings->small;
    frame_group *group = calloc(1, sizeof *group);
    if (!group) return iso_fail(error, ISO_ERR_NOMEM, "out of memory");
    *group = (frame_group){.bench = bench, .gl = gl, .subject_count = SUBJECTS, .view_count = 1};
    for (int i = 0; i < SUBJECTS; i++) {
        bool last = i == SUBJECTS - 1;
        bench_subject *subject = &group->subjects[i];
        *subject = (bench_subject){.bench = bench,
                                   .bumpy_side = small ? small_sides[i] : sides[i],
                                   .bumpy_piece = small && last ? 2 : BENCH_BUMPY_PIECE,
                                   .bumpy_meshless = last};
        snprintf(subject->name, sizeof subject->name, "%s", small ? small_names[i] : names[i]);
    }
    iso_status status = run_frames(group, "frames of a bumpy sphere, by points", error);
    if (status == ISO_OK && group->gl) say_limit(group);
    free(group);
    return status;
}

static iso_status run_volume(bench_state *bench, const bench_subject *what, iso_error *error) {
    char title[64];
    frame_group *group = calloc(1, sizeof *group);
    if (!group) return iso_fail(error, ISO_ERR_NOMEM, "out of memory");
    *group = (frame_group){.bench = bench, .subject_count = 1, .view_count = BENCH_VIEWS};
    group->subjects[0] = *what;
    group->subjects[0].bench = bench;
    snprintf(title, sizeof title, "frames of %s", what->name);
    iso_status status = run_frames(group, title, error);
    free(group);
    return status;
}

static iso_status run_ct(bench_state *bench, int size, iso_error *error) {
    bench_subject what = {.ct_size = size, .isovalue = 127.5};
    snprintf(what.name, sizeof what.name, "ct%d", size);
    return run_volume(bench, &what, error);
}

iso_status bench_render(bench_state *bench, iso_error *error) {
    bool small = bench->settings->small;
    bench_subject brain = {.name = "ch2better", .file = "mricron/ch2better.nii.gz", .isovalue = 60};
    if (small) brain = (bench_subject){.name = "headmr", .file = "headmr/HeadMRVolume.mhd", .isovalue = 40};
    bench_gl gl;
    iso_status status = bench_gl_open(&gl, error);
    if (status == ISO_OK) status = run_bumpy(bench, &gl, error);
    bench_gl_close(&gl);
    ISO_TRY(status);
    ISO_TRY(run_ct(bench, small ? 32 : 256, error));
    ISO_TRY(run_volume(bench, &brain, error));
    ISO_TRY(run_ct(bench, small ? 48 : 512, error));
    ISO_TRY(bench_forest_groups(bench, error));
    ISO_TRY(bench_shapes_groups(bench, error));
    ISO_TRY(bench_together_groups(bench, error));
    ISO_TRY(bench_picture_group(bench, error));
    ISO_TRY(bench_tracts_group(bench, error));
    return bench_cloud_picture_group(bench, error);
}
