#include "bench_scenes.h"

#include <stdio.h>
#include <stdlib.h>
#include <time.h>

#include "base/memory.h"
#include "grids/scenes/scenes.h"

struct bench_scenes {
    iso_pool *pool;           /* scenes may be made with all processors */
    iso_grid ct, other, head; /* other: ct in another type */
    int ct_size, head_size;
};

iso_status bench_scenes_create(bench_scenes **out, iso_error *error) {
    bench_scenes *scenes = calloc(1, sizeof *scenes);
    if (!scenes) return iso_fail(error, ISO_ERR_NOMEM, "out of memory");
    *out = scenes;
    return ISO_OK;
}

void bench_scenes_destroy(bench_scenes *scenes) {
    if (!scenes) return;
    iso_grid_destroy(&scenes->ct);
    iso_grid_destroy(&scenes->other);
    iso_grid_destroy(&scenes->head);
    iso_pool_destroy(scenes->pool);
    free(scenes);
}

static iso_status make(bench_scenes *scenes, const char *name, int size, iso_grid *grid, iso_error *error) {
    if (!scenes->pool) ISO_TRY(iso_pool_create(0, &scenes->pool, error));
    iso_grid_destroy(grid);
    iso_scene_opts opts = {.size = size, .pool = scenes->pool};
    fprintf(stderr, "bench: making %s of %d voxels a side\n", name, size);
    return iso_scene_create(name, &opts, grid, NULL, error);
}

static iso_status convert(const iso_rgrid *from, iso_type type, iso_grid *to, iso_error *error) {
    iso_rgrid_desc desc = {.dims = {from->dims[0], from->dims[1], from->dims[2]}, .type = type};
    ISO_TRY(iso_rgrid_create(&desc, &to->rgrid, error));
    const uint8_t *source = from->data;
    size_t count = (size_t)from->dims[0] * (size_t)from->dims[1] * (size_t)from->dims[2];
    void *data = to->rgrid->data;
    for (size_t i = 0; i < count; i++) {
        if (type == ISO_FLOAT32)
            ((float *)data)[i] = source[i];
        else
            ((uint16_t *)data)[i] = source[i]; /* 0 .. 255 look alike as int16 */
    }
    return ISO_OK;
}

iso_status bench_scene_ct(bench_scenes *scenes, int size, iso_type type, const iso_grid **grid,
                          iso_error *error) {
    if (scenes->ct_size != size) {
        scenes->ct_size = 0;
        iso_grid_destroy(&scenes->other);
        ISO_TRY(make(scenes, "ct", size, &scenes->ct, error));
        scenes->ct_size = size;
    }
    *grid = &scenes->ct;
    if (type == ISO_UINT8) return ISO_OK;
    *grid = &scenes->other;
    if (scenes->other.rgrid && scenes->other.rgrid->type == type) return ISO_OK;
    iso_grid_destroy(&scenes->other);
    return convert(scenes->ct.rgrid, type, &scenes->other, error);
}

iso_status bench_scene_head(bench_scenes *scenes, int size, iso_grid **grid, iso_error *error) {
    if (scenes->head_size != size) {
        scenes->head_size = 0;
        ISO_TRY(make(scenes, "head", size, &scenes->head, error));
        scenes->head_size = size;
    }
    *grid = &scenes->head;
    return ISO_OK;
}

void bench_scene_drop_head(bench_scenes *scenes) {
    iso_grid_destroy(&scenes->head);
    scenes->head_size = 0;
}

/* 2654435761 is odd and near the golden section of 2^32. */
int bench_scatter_places(const iso_point_set *set, iso_vec3 *places, int room) {
    iso_point_view view = iso_point_set_view(set);
    int count = 0;
    uint32_t at = 0;
    for (int i = 0; i < room && view.span_count; i++, at += 2654435761u) {
        const iso_point_span *span = &view.spans[(size_t)at * view.span_count >> 32];
        if (!span->count) continue;
        const float *p = iso_point_view_get(&view, span->first + span->count / 2).position;
        places[count++] = iso_vec3_make(span->brick[0] * (double)ISO_BRICK + p[0],
                                        span->brick[1] * (double)ISO_BRICK + p[1],
                                        span->brick[2] * (double)ISO_BRICK + p[2]);
    }
    return count;
}
