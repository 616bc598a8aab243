/* The fields that stroke files make, and pictures of them. */
#include <stdio.h>

#include "extract/points/points.h"
#include "golden.h"
#include "sculpt/session/session.h"

/* Cells without a brick count by their state, bricks by all of their values. */
static uint64_t hash_field(const iso_hgrid *grid) {
    uint64_t hash = golden_hash(GOLDEN_HASH_START, grid->dims, sizeof grid->dims);
    size_t cells = iso_hgrid_cell_count(grid);
    for (size_t i = 0; i < cells; i++) {
        int32_t brick = grid->cell[i];
        if (brick < 0)
            hash = golden_hash(hash, &brick, sizeof brick);
        else
            hash = golden_hash(hash, iso_hgrid_brick(grid, brick), ISO_BRICK_VOXELS * sizeof(float));
    }
    return hash;
}

static void play(iso_session *session, iso_journal_reader *reader, size_t *strokes) {
    iso_error error = {0};
    iso_event event;
    bool more = true;
    for (;;) {
        golden_check(iso_journal_next(reader, &event, &more, &error), &error);
        if (!more) return;
        iso_edit_stats stats = {0};
        golden_check(iso_session_play(session, &event, &stats, &error), &error);
        *strokes += event.kind == ISO_EVENT_BEGIN;
    }
}

static void strokes_row(golden_table *table, const char *path, const char *name, iso_pool *pool) {
    iso_error error = {0};
    iso_journal_start start;
    iso_journal_reader *reader = NULL;
    iso_hgrid *grid = NULL;
    iso_session *session = NULL;
    const iso_session_opts opts = {.pool = pool};
    golden_check(iso_journal_open(path, &start, &reader, &error), &error);
    golden_check(iso_session_solid(&start, &grid, &error), &error);
    golden_check(iso_session_create(grid, &start, &opts, &session, &error), &error);
    size_t strokes = 0;
    play(session, reader, &strokes);
    char row[96];
    snprintf(row, sizeof row, "%s field after %zu strokes", name, strokes);
    golden_row(table, row, hash_field(iso_session_grid(session)), NULL);
    iso_session_destroy(session);
    iso_journal_reader_free(reader);
}

void golden_strokes(golden_table *table, const char *folder, iso_pool *pool) {
    static const char *const files[][2] = {{"volumes/bear.strokes", "bear"},
                                           {"volumes/head.strokes", "head"},
                                           {"tests/golden/masked.strokes", "masked"}};
    for (size_t i = 0; i < sizeof files / sizeof *files; i++) {
        char path[1024];
        snprintf(path, sizeof path, "%s/%s", folder, files[i][0]);
        strokes_row(table, path, files[i][1], pool);
    }
}
