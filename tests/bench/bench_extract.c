/* bench extract: from a volume to primitives, every variant of ours beside the peers.
 *
 * Ours is extracted again and again into the same buffers: the isovalue moves back and forth by so little
 * that no corner changes sides, which makes the whole set new (iso_point_set_isovalue to the same value would
 * do nothing). VTK's filter is modified and updated; volumeToMesh is called again. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "bench_harness.h"
#include "bench_peers.h"
#include "extract/mesh/mesh.h"
#include "extract/points/points.h"

#define CT_ISOVALUE 127.5
#define CT_ISOVALUE_FEW 212.5

/* No corner lies between: values of ct are integers, and those of the head are floats of about 1. */
static double nudge_of(const bench_row *row) {
    return row->head ? 0x1p-30 : 0x1p-10;
}

/* ---- ours: points and meshes ---- */

typedef struct extraction {
    iso_point_set *points;
    iso_mesh_set *mesh;
    bool nudged;
    bench_sample first;
} extraction;

static iso_status update(extraction *work, double isovalue, bench_sample *sample, iso_error *error) {
    bench_clock clock = bench_clock_start();
    if (work->points) {
        iso_point_set_isovalue(work->points, isovalue);
        ISO_TRY(iso_point_set_update(work->points, error));
    } else {
        iso_mesh_set_isovalue(work->mesh, isovalue);
        ISO_TRY(iso_mesh_set_update(work->mesh, error));
    }
    bench_clock_stop(&clock, sample);
    return ISO_OK;
}

static iso_status open_extraction(bench_row *row, bool as_mesh, iso_error *error) {
    const iso_grid *grid = NULL;
    ISO_TRY(bench_row_grid(row, &grid, error));
    extraction *work = calloc(1, sizeof *work);
    if (!work) return iso_fail(error, ISO_ERR_NOMEM, "out of memory");
    row->context = work;
    iso_pool *pool = bench_pool(row->bench, row->threads);
    bench_clock clock = bench_clock_start();
    if (as_mesh) {
        iso_mesh_opts opts = {.isovalue = row->isovalue, .pool = pool};
        ISO_TRY(iso_mesh_set_create(grid, &opts, &work->mesh, error));
        ISO_TRY(iso_mesh_set_update(work->mesh, error));
    } else {
        iso_points_opts opts = {.isovalue = row->isovalue, .pool = pool};
        ISO_TRY(iso_point_set_create(grid, &opts, &work->points, error));
        ISO_TRY(iso_point_set_update(work->points, error));
    }
    bench_clock_stop(&clock, &work->first);
    return ISO_OK;
}

static iso_status open_points(bench_row *row, iso_error *error) {
    return open_extraction(row, false, error);
}

static iso_status open_mesh(bench_row *row, iso_error *error) {
    return open_extraction(row, true, error);
}

static size_t primitives_of(const extraction *work) {
    if (work->points) return iso_point_set_stats(work->points).points;
    iso_mesh_view view = iso_mesh_set_view(work->mesh);
    return iso_mesh_view_vertex_count(&view);
}

static iso_status run_again(bench_row *row, bench_sample *sample, iso_error *error) {
    extraction *work = row->context;
    work->nudged = !work->nudged;
    ISO_TRY(update(work, row->isovalue + (work->nudged ? nudge_of(row) : 0), sample, error));
    sample->primitives = primitives_of(work);
    return ISO_OK;
}

static void finish_extraction(bench_row *row) {
    const extraction *work = row->context;
    bench_count(row, "first_ms", work->first.wall, 0, 0);
}

static void close_extraction(bench_row *row) {
    extraction *work = row->context;
    if (!work) return;
    iso_point_set_destroy(work->points);
    iso_mesh_set_destroy(work->mesh);
    free(work);
}

static const bench_kind points_kind = {
    .open = open_points, .run = run_again, .finish = finish_extraction, .close = close_extraction};
static const bench_kind mesh_kind = {
    .open = open_mesh, .run = run_again, .finish = finish_extraction, .close = close_extraction};

/* ---- ours: the isovalue moves between two values ---- */

static double other_isovalue(const bench_row *row) {
    return row->isovalue == CT_ISOVALUE ? CT_ISOVALUE_FEW : CT_ISOVALUE;
}

static iso_status run_move(bench_row *row, bench_sample *sample, iso_error *error) {
    extraction *work = row->context;
    bench_sample away;
    ISO_TRY(update(work, other_isovalue(row), &away, error));
    ISO_TRY(update(work, row->isovalue, sample, error));
    sample->primitives = primitives_of(work);
    return ISO_OK;
}

static const bench_kind move_kind = {
    .open = open_points, .run = run_move, .finish = finish_extraction, .close = close_extraction};

/* ---- peers ---- */

static iso_status open_flying_edges(bench_row *row, iso_error *error) {
    const iso_grid *grid = NULL;
    ISO_TRY(bench_row_grid(row, &grid, error));
    bench_flying_edges *peer = NULL;
    ISO_TRY(bench_flying_edges_create(grid->rgrid, row->isovalue, row->threads, &peer, error));
    row->context = peer;
    return ISO_OK;
}

static iso_status run_flying_edges(bench_row *row, bench_sample *sample, iso_error *error) {
    ISO_TRY(bench_flying_edges_ready(row->context, error));
    bench_clock clock = bench_clock_start();
    ISO_TRY(bench_flying_edges_run(row->context, error));
    bench_clock_stop(&clock, sample);
    sample->primitives = bench_flying_edges_points(row->context);
    return ISO_OK;
}

static void close_flying_edges(bench_row *row) {
    bench_flying_edges_destroy(row->context);
}

static const bench_kind flying_edges_kind = {
    .open = open_flying_edges, .run = run_flying_edges, .close = close_flying_edges, .batch = 1};

static iso_status open_volume_to_mesh(bench_row *row, iso_error *error) {
    const iso_grid *grid = NULL;
    ISO_TRY(bench_row_grid(row, &grid, error));
    bench_volume_to_mesh *peer = NULL;
    ISO_TRY(bench_volume_to_mesh_create(grid->hgrid, row->threads, &peer, error));
    row->context = peer;
    return ISO_OK;
}

static iso_status run_volume_to_mesh(bench_row *row, bench_sample *sample, iso_error *error) {
    bench_clock clock = bench_clock_start();
    ISO_TRY(bench_volume_to_mesh_run(row->context, error));
    bench_clock_stop(&clock, sample);
    sample->primitives = bench_volume_to_mesh_points(row->context);
    return ISO_OK;
}

static void close_volume_to_mesh(bench_row *row) {
    bench_volume_to_mesh_destroy(row->context);
}

static const bench_kind volume_to_mesh_kind = {
    .open = open_volume_to_mesh, .run = run_volume_to_mesh, .close = close_volume_to_mesh, .batch = 1};

/* ---- memory: how fast it can be read at all ---- */

enum { BANDWIDTH_CHUNK = 1 << 20 };

typedef struct bandwidth {
    const uint64_t *block;
    uint64_t sums[BENCH_THREADS * 8]; /* by worker, a cache line each; threads beyond share */
} bandwidth;

static void sum_chunk(void *context, size_t index, int worker) {
    bandwidth *work = context;
    enum { WORDS = BANDWIDTH_CHUNK / sizeof(uint64_t), LANES = 16 };
    const uint64_t *words = work->block + index * WORDS;
    uint64_t lanes[LANES] = {0}, sum = 0;
    for (size_t i = 0; i < WORDS; i += LANES)
        for (int k = 0; k < LANES; k++) lanes[k] += words[i + (size_t)k];
    for (int k = 0; k < LANES; k++) sum += lanes[k];
    work->sums[(worker % BENCH_THREADS) * 8] += sum;
}

static iso_status open_bandwidth(bench_row *row, iso_error *error) {
    bench_state *bench = row->bench;
    if (!bench->bandwidth) {
        bench->bandwidth_bytes = bench->settings->small ? (size_t)4 << 20 : (size_t)256 << 20;
        bench->bandwidth = iso_alloc(bench->bandwidth_bytes);
        if (!bench->bandwidth) return iso_fail(error, ISO_ERR_NOMEM, "out of memory");
        memset(bench->bandwidth, 1, bench->bandwidth_bytes); /* untouched pages would all be the same one */
    }
    bandwidth *work = calloc(1, sizeof *work);
    if (!work) return iso_fail(error, ISO_ERR_NOMEM, "out of memory");
    work->block = bench->bandwidth;
    row->context = work;
    return ISO_OK;
}

static iso_status run_bandwidth(bench_row *row, bench_sample *sample, iso_error *error) {
    (void)error;
    iso_pool *pool = bench_pool(row->bench, row->threads);
    bench_clock clock = bench_clock_start();
    iso_parallel_for(pool, row->bench->bandwidth_bytes / BANDWIDTH_CHUNK, sum_chunk, row->context);
    bench_clock_stop(&clock, sample);
    return ISO_OK;
}

static void finish_bandwidth(bench_row *row) {
    const bandwidth *work = row->context;
    uint64_t sum = 0;
    for (int i = 0; i < BENCH_THREADS; i++) sum += work->sums[i * 8];
    if (sum % 2) snprintf(row->problem, sizeof row->problem, "read something else than was written");
    double bytes = (double)row->bench->bandwidth_bytes;
    bench_count(row, "bytes_per_second", bytes / bench_row_median(row) * 1e3, 0, 0);
}

static void close_bandwidth(bench_row *row) {
    free(row->context);
}

static const bench_kind bandwidth_kind = {
    .open = open_bandwidth, .run = run_bandwidth, .finish = finish_bandwidth, .close = close_bandwidth};

/* ---- groups ---- */

/* The rows of one input, by instruction set and position in settings->threads. */
typedef struct input_rows {
    bench_row *bandwidth[BENCH_THREADS], *peer[BENCH_THREADS];
    bench_row *mesh[ISO_CPU_LEVELS][BENCH_THREADS], *points[ISO_CPU_LEVELS][BENCH_THREADS];
} input_rows;

/* What a group works on, and what is asked of its rows (one thread). */
typedef struct bench_input {
    bool head;
    iso_type type;
    int size;
    bool full_size;
    char text[32]; /* "uint8/512", "head1024" */
    double points_least[ISO_CPU_LEVELS], mesh_least;
} bench_input;

static void put_input(bench_row *row, const bench_input *input) {
    row->head = input->head;
    row->type = input->type;
    row->size = input->size;
    row->isovalue = input->head ? 0 : CT_ISOVALUE;
}

static void add_references(bench_state *bench, const bench_input *input, input_rows *rows) {
    const bench_settings *settings = bench->settings;
    for (int t = 0; t < settings->thread_count; t++) {
        int threads = settings->threads[t];
        const bench_kind *kind = input->head ? &volume_to_mesh_kind : &flying_edges_kind;
        rows->peer[t] = bench_add(bench, kind, "extract/%s/%s/threads:%d",
                                  input->head ? "volumeToMesh" : "vtkFlyingEdges3D", input->text, threads);
        rows->bandwidth[t] =
            bench_add(bench, &bandwidth_kind, "extract/read_bandwidth/%s/threads:%d", input->text, threads);
        rows->peer[t]->threads = rows->bandwidth[t]->threads = threads;
        put_input(rows->peer[t], input);
    }
}

static void add_ours(bench_state *bench, const bench_input *input, bool as_mesh, input_rows *rows) {
    const bench_settings *settings = bench->settings;
    const char *what = as_mesh ? "marching_cubes" : input->head ? "foot_points" : "edge_points";
    for (int level = 0; level <= (int)bench->best; level++)
        for (int t = 0; t < settings->thread_count; t++) {
            bench_row *row =
                bench_add(bench, as_mesh ? &mesh_kind : &points_kind, "extract/%s/%s/%s/threads:%d", what,
                          input->text, iso_cpu_level_name((iso_cpu_level)level), settings->threads[t]);
            put_input(row, input);
            row->threads = settings->threads[t];
            row->level = (iso_cpu_level)level;
            (as_mesh ? rows->mesh : rows->points)[level][t] = row;
        }
}

/* Speed-up over one thread; two threads are asked for 0.85 of what reading gains. */
static void compare_scaling(bench_row *row, bench_row *single, const bench_row *measure) {
    if (!single || row == single) return;
    bool asked = measure && row->threads == 2 && row->level != ISO_CPU_GENERIC;
    bench_against *against = bench_compare(row, single, "scaling", NULL, asked ? 0.85 : 0);
    if (against) against->measure = measure;
}

static void compare_threads(bench_state *bench, const bench_input *input, input_rows *rows, int t) {
    int single = bench_single_thread(bench->settings);
    bool asked = input->full_size && t == single;
    const char *ratio = input->head ? "ratio_vs_volumeToMesh" : "ratio_vs_vtkFlyingEdges3D";
    const char *pairwise =
        input->head ? "ratio_vs_volumeToMesh_pairwise" : "ratio_vs_vtkFlyingEdges3D_pairwise";
    for (int level = 0; level <= (int)bench->best; level++) {
        bool vector = level != ISO_CPU_GENERIC;
        bench_row *points = rows->points[level][t], *mesh = rows->mesh[level][t];
        bench_compare(points, rows->peer[t], ratio, pairwise, asked ? input->points_least[level] : 0);
        if (mesh) {
            bench_compare(mesh, rows->peer[t], ratio, pairwise, asked && vector ? input->mesh_least : 0);
            bench_compare(points, mesh, "ratio_vs_marching_cubes", NULL,
                          asked && vector && !input->head ? 2 : 0);
        }
        if (single < 0) continue;
        const bench_row *measure = input->full_size ? rows->bandwidth[t] : NULL;
        compare_scaling(points, rows->points[level][single], measure);
        if (mesh) compare_scaling(mesh, rows->mesh[level][single], measure);
    }
    if (single < 0) return;
    compare_scaling(rows->bandwidth[t], rows->bandwidth[single], NULL);
    compare_scaling(rows->peer[t], rows->peer[single], NULL);
}

static iso_status run_input(bench_state *bench, const bench_input *input, bool with_mesh, iso_error *error) {
    input_rows rows = {0};
    add_references(bench, input, &rows);
    if (with_mesh) add_ours(bench, input, true, &rows);
    add_ours(bench, input, false, &rows);
    for (int t = 0; t < bench->settings->thread_count; t++) compare_threads(bench, input, &rows, t);
    return bench_run_group(bench, input->text, error);
}

static iso_status run_ct(bench_state *bench, iso_type type, int size, bool full_size, iso_error *error) {
    bench_input input = {.type = type, .size = size, .full_size = full_size, .mesh_least = 6};
    /* The rows' names have no digits after "float". */
    const char *name = type == ISO_FLOAT32 ? "float" : iso_type_name(type);
    snprintf(input.text, sizeof input.text, "%s/%d", name, size);
    double least[2] = {15, 20};
    if (type == ISO_INT16 || type == ISO_FLOAT32) least[0] = least[1] = 10;
    if (type == ISO_UINT16) least[0] = least[1] = 0;
    input.points_least[ISO_CPU_AVX2] = least[0];
    input.points_least[ISO_CPU_AVX512] = least[1];
    return run_input(bench, &input, type == ISO_UINT8, error);
}

static iso_status run_head(bench_state *bench, int size, bool full_size, iso_error *error) {
    bench_input input = {.head = true, .size = size, .full_size = full_size};
    snprintf(input.text, sizeof input.text, "head%d", size);
    input.points_least[ISO_CPU_AVX2] = 25;
    input.points_least[ISO_CPU_AVX512] = 40;
    return run_input(bench, &input, true, error);
}

static iso_status run_isovalue(bench_state *bench, int size, bool full_size, iso_error *error) {
    bench_input input = {.type = ISO_UINT8, .size = size};
    bench_row *all = bench_add(bench, &move_kind, "extract/isovalue/ct%d/%g", size, CT_ISOVALUE);
    bench_row *few = bench_add(bench, &move_kind, "extract/isovalue/ct%d/%g", size, CT_ISOVALUE_FEW);
    put_input(all, &input);
    put_input(few, &input);
    few->isovalue = CT_ISOVALUE_FEW;
    bench_compare(few, all, "ratio_vs_full", "ratio_vs_full_pairwise", full_size ? 20 : 0);
    return bench_run_group(bench, "the isovalue moves, index built", error);
}

iso_status bench_extract(bench_state *bench, iso_error *error) {
    bool small = bench->settings->small;
    const int ct = small ? 48 : 512, smaller_ct = small ? 32 : 256;
    const int head = small ? 64 : 1024, smaller_head = small ? 48 : 512;
    const iso_type types[] = {ISO_UINT8, ISO_INT16, ISO_UINT16, ISO_FLOAT32};
    ISO_TRY(run_ct(bench, ISO_UINT8, smaller_ct, false, error));
    for (int i = 0; i < 4; i++) ISO_TRY(run_ct(bench, types[i], ct, !small, error));
    ISO_TRY(run_isovalue(bench, ct, !small, error));
    ISO_TRY(run_head(bench, smaller_head, false, error));
    ISO_TRY(run_head(bench, head, !small, error));
    ISO_TRY(bench_edit_group(bench, error));
    ISO_TRY(bench_lines_group(bench, error));
    ISO_TRY(bench_clouds_group(bench, error));
    return bench_process_groups(bench, error);
}
