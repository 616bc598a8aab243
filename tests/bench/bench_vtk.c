/* VTK's frame of a subject's mesh or points as a row: drawn by vtk_frame, timed there. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/file.h"
#include "bench_frame.h"

/* ---- the mesh as a file ---- */

static iso_status write_vectors(FILE *file, const iso_weld *weld, const iso_affine *affine, bool normals) {
    for (size_t i = 0; i < weld->vertex_count; i++) {
        const float *p = weld->vertices[i].position, *n = weld->vertices[i].normal;
        iso_vec3 v = normals ? iso_affine_normal(affine, iso_vec3_make(n[0], n[1], n[2]))
                             : iso_affine_point(affine, iso_vec3_make(p[0], p[1], p[2]));
        const float out[3] = {(float)v.x, (float)v.y, (float)v.z};
        fwrite(out, sizeof *out, 3, file);
    }
    return ISO_OK;
}

static iso_status write_weld(const iso_weld *weld, const iso_affine *affine, const char *path,
                             iso_error *error) {
    iso_sink sink = {0};
    ISO_TRY(iso_sink_open(path, &sink, error));
    const int64_t counts[2] = {(int64_t)weld->vertex_count, (int64_t)weld->triangle_count};
    fwrite(counts, sizeof *counts, 2, sink.stream);
    write_vectors(sink.stream, weld, affine, false);
    write_vectors(sink.stream, weld, affine, true);
    for (size_t i = 0; i < weld->triangle_count; i++) {
        const uint32_t *corner = weld->triangles[i];
        const int64_t out[3] = {corner[0], corner[1], corner[2]};
        fwrite(out, sizeof *out, 3, sink.stream);
    }
    return iso_sink_commit(&sink, error);
}

static void name_file(const bench_subject *subject, bench_vtk *vtk, const char *extension) {
    const char *folder = getenv("TMPDIR");
    snprintf(vtk->path, sizeof vtk->path, "%.400s/isopoint-bench-%ld-%s.%s", folder ? folder : "/tmp",
             (long)getpid(), subject->name, extension);
}

static iso_status write_mesh(bench_subject *subject, bench_vtk *vtk, iso_error *error) {
    iso_mesh_view mesh;
    ISO_TRY(bench_subject_mesh(subject, &mesh, error));
    iso_weld weld = {0};
    ISO_TRY(iso_mesh_weld(&mesh, NULL, &weld, error));
    iso_affine affine = iso_transform_affine(&mesh.transform);
    name_file(subject, vtk, "mesh");
    iso_status status = write_weld(&weld, &affine, vtk->path, error);
    iso_weld_free(&weld);
    return status;
}

/* ---- the points as a file: counts, positions, radii ---- */

static iso_status write_points(bench_subject *subject, bench_vtk *vtk, iso_error *error) {
    iso_point_view points;
    iso_sink sink = {0};
    ISO_TRY(bench_subject_points(subject, &points, error));
    name_file(subject, vtk, "points");
    ISO_TRY(iso_sink_open(vtk->path, &sink, error));
    const iso_affine affine = iso_transform_affine(&points.transform);
    const int64_t counts[2] = {(int64_t)iso_point_view_count(&points), 0};
    fwrite(counts, sizeof *counts, 2, sink.stream);
    for (const iso_point_span *s = points.spans; s < points.spans + points.span_count; s++)
        for (size_t i = s->first; i < s->first + s->count; i++) {
            const iso_surfel surfel = iso_point_view_get(&points, i);
            const iso_vec3 at = iso_affine_point(&affine, iso_brick_position(s->brick, surfel.position));
            const float out[3] = {(float)at.x, (float)at.y, (float)at.z};
            fwrite(out, sizeof *out, 3, sink.stream);
        }
    const float radius = (float)points.radius;
    for (int64_t i = 0; i < counts[0]; i++) fwrite(&radius, sizeof radius, 1, sink.stream);
    return iso_sink_commit(&sink, error);
}

/* ---- the process ---- */

static bench_vtk *vtk_of(const bench_frame_plan *plan) {
    return plan->vtk_points ? &plan->subject->vtk_points : &plan->subject->vtk;
}

static int threads_index(const bench_settings *settings, int threads) {
    int index = 0;
    while (index < settings->thread_count - 1 && settings->threads[index] != threads) index++;
    return index;
}

static iso_status start(const bench_frame_plan *plan, int threads, bench_child **child, iso_error *error) {
    bench_subject *subject = plan->subject;
    bench_vtk *vtk = vtk_of(plan);
    char program[1100], line[512];
    const char *display;
    ISO_TRY(bench_sibling("vtk_frame", program, sizeof program, error));
    ISO_TRY(bench_display_open(&subject->bench->display, &display, error));
    if (!vtk->path[0]) ISO_TRY((plan->vtk_points ? write_points : write_mesh)(subject, vtk, error));
    const char *const argv[] = {program, plan->vtk_points ? "gaussians" : "mesh", vtk->path, NULL};
    ISO_TRY(bench_child_start(argv, threads, display, child, error));
    ISO_TRY(bench_child_ask(*child, NULL, line, sizeof line, error));
    int name = 0;
    if (sscanf(line, "ready %zu %n", &vtk->primitives, &name) != 1 || !name)
        return iso_fail(error, ISO_ERR_UNSUPPORTED, "vtk_frame said '%.80s'", line);
    snprintf(subject->bench->vtk_renderer, sizeof subject->bench->vtk_renderer, "%.80s", line + name);
    return ISO_OK;
}

static iso_status set_peels(bench_vtk *vtk, int index, int peels, iso_error *error) {
    char text[64], line[256];
    if (vtk->peels[index] == peels) return ISO_OK;
    snprintf(text, sizeof text, "opacity %g %d", peels == BENCH_VTK_OPAQUE ? 1 : BENCH_OPACITY,
             peels == BENCH_VTK_OPAQUE ? 0 : peels);
    ISO_TRY(bench_child_ask(vtk->child[index], text, line, sizeof line, error));
    vtk->peels[index] = peels;
    return ISO_OK;
}

static iso_status show(const bench_frame_plan *plan, int threads, iso_error *error) {
    bench_subject *subject = plan->subject;
    const int number = plan->view;
    bench_vtk *vtk = vtk_of(plan);
    int index = threads_index(subject->bench->settings, threads);
    ISO_TRY(set_peels(vtk, index, plan->vtk_peels, error));
    if (vtk->child[index] && vtk->shown[index] == number) return ISO_OK;
    bench_view view;
    char text[1024], line[256];
    ISO_TRY(bench_subject_view(subject, number, &view, error));
    const iso_camera *c = &view.camera;
    snprintf(text, sizeof text,
             "view %d %d %.17g %.17g %.17g %.17g %.17g %.17g %.17g %.17g %.17g %.17g %.17g %.17g",
             view.view.width, view.view.height, c->position.x, c->position.y, c->position.z, c->focal_point.x,
             c->focal_point.y, c->focal_point.z, c->view_up.x, c->view_up.y, c->view_up.z, c->view_angle,
             view.centre[0], -view.centre[1]);
    ISO_TRY(bench_child_ask(vtk->child[index], text, line, sizeof line, error));
    vtk->shown[index] = number;
    return ISO_OK;
}

void bench_vtk_end(bench_vtk *vtk) {
    for (int i = 0; i < BENCH_THREADS; i++) bench_child_end(vtk->child[i]);
    if (vtk->path[0]) remove(vtk->path);
    *vtk = (bench_vtk){0};
}

/* ---- the row ---- */

typedef struct vtk_row {
    bench_child *child;
    size_t covered;
} vtk_row;

/* The first frame uploads the mesh; it is not timed. */
static iso_status open_row(bench_row *row, iso_error *error) {
    const bench_frame_plan *plan = row->plan;
    bench_vtk *vtk = vtk_of(plan);
    int index = threads_index(row->bench->settings, row->threads);
    if (!vtk->child[index]) {
        vtk->shown[index] = -1;
        vtk->peels[index] = BENCH_VTK_OPAQUE;
        iso_status status = start(plan, row->threads, &vtk->child[index], error);
        if (status != ISO_OK) {
            bench_child_stop(vtk->child[index]);
            vtk->child[index] = NULL;
            return status;
        }
    }
    vtk_row *opened = calloc(1, sizeof *opened);
    if (!opened) return iso_fail(error, ISO_ERR_NOMEM, "out of memory");
    row->context = opened;
    opened->child = vtk->child[index];
    char line[256];
    ISO_TRY(show(plan, row->threads, error));
    ISO_TRY(bench_child_ask(opened->child, "covered", line, sizeof line, error));
    if (sscanf(line, "covered %zu", &opened->covered) != 1)
        return iso_fail(error, ISO_ERR_UNSUPPORTED, "vtk_frame said '%.80s'", line);
    return ISO_OK;
}

static iso_status run_row(bench_row *row, bench_sample *sample, iso_error *error) {
    const bench_frame_plan *plan = row->plan;
    const vtk_row *opened = row->context;
    char line[256];
    ISO_TRY(show(plan, row->threads, error));
    ISO_TRY(bench_child_ask(opened->child, "frame", line, sizeof line, error));
    if (sscanf(line, "frame %lf %lf", &sample->wall, &sample->cpu) != 2)
        return iso_fail(error, ISO_ERR_UNSUPPORTED, "vtk_frame said '%.80s'", line);
    sample->primitives = vtk_of(plan)->primitives;
    return ISO_OK;
}

static void finish_row(bench_row *row) {
    const vtk_row *opened = row->context;
    bench_count(row, "covered_pixels", (double)opened->covered, 0, 0);
}

static void close_row(bench_row *row) {
    free(row->context);
}

const bench_kind bench_vtk_kind = {
    .open = open_row, .run = run_row, .finish = finish_row, .close = close_row, .batch = 1, .rounds = 5};
