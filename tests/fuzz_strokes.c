/* fuzz: any bytes as a stroke file. Numbers of lines and checksums are put right before it is read, so that
 * what a line says is tried and not only that it is damaged. What is read is played on a small grid: the
 * field must stay a clamped distance field, undoing all of it must bring back the field as it was, and what
 * is refused must be refused in one line that names the file. */
#define _GNU_SOURCE
#include <math.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#include "sculpt/crc32c.h"
#include "sculpt/session.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

/* Largest grid that is played on; events and touches of a sample that are played. */
enum { SIDE = 64, EVENTS = 48, TOUCHES = 64 };

/* ---- the file */

/* Writes `,"crc":"xxxxxxxx"}` in place of what ends the line, and the number of the event. */
static void put_line(FILE *stream, const char *line, size_t size, int number) {
    static const char CRC[] = ",\"crc\":\"", N[] = "{\"n\":";
    if (size < 2 || line[size - 1] != '}') {
        fwrite(line, 1, size, stream);
        fputc('\n', stream);
        return;
    }
    const char *crc = memmem(line, size, CRC, sizeof CRC - 1);
    size_t end = crc ? (size_t)(crc - line) : size - 1, begin = 0;
    char *text = NULL;
    size_t length = 0;
    FILE *part = open_memstream(&text, &length);
    if (!part) abort();
    if (number >= 0 && end > sizeof N && memcmp(line, N, sizeof N - 1) == 0) {
        begin = sizeof N - 1;
        while (begin < end && line[begin] >= '0' && line[begin] <= '9') begin++;
        fprintf(part, "%s%d", N, number);
    }
    fwrite(line + begin, 1, end - begin, part);
    fclose(part);
    fwrite(text, 1, length, stream);
    fprintf(stream, "%s%08x\"}\n", CRC, (unsigned)iso_crc32c(0, text, length));
    free(text);
}

static void put_file(int descriptor, const char *bytes, size_t size) {
    FILE *stream = fdopen(dup(descriptor), "wb");
    if (!stream) abort();
    int number = -1; /* the first line is the header */
    for (size_t at = 0; at < size; number++) {
        const char *newline = memchr(bytes + at, '\n', size - at);
        const size_t length = newline ? (size_t)(newline - bytes) - at : size - at;
        put_line(stream, bytes + at, length, number);
        at += length + 1;
    }
    fclose(stream);
}

/* ---- what must hold */

static void check_error(const iso_error *error, iso_status status, const char *path) {
    const int code = iso_status_exit(status);
    if ((code != 3 && code != 5) || !strstr(error->text, path) || strchr(error->text, '\n')) {
        fprintf(stderr, "status %d: %s\n", (int)status, error->text);
        abort();
    }
}

static void check_field(const iso_hgrid *grid) {
    for (int z = 0; z < grid->dims[2]; z++)
        for (int y = 0; y < grid->dims[1]; y++)
            for (int x = 0; x < grid->dims[0]; x++)
                if (!(fabsf(iso_hgrid_at(grid, x, y, z)) <= grid->band)) abort();
}

static uint32_t field_hash(const iso_hgrid *grid) {
    uint32_t crc = 0;
    for (int z = 0; z < grid->dims[2]; z++)
        for (int y = 0; y < grid->dims[1]; y++)
            for (int x = 0; x < grid->dims[0]; x++) {
                const float value = iso_hgrid_at(grid, x, y, z);
                crc = iso_crc32c(crc, &value, sizeof value);
            }
    return crc;
}

static void check_undo(iso_session *session, uint32_t before) {
    const iso_history *history = iso_session_history(session);
    const uint32_t after = field_hash(iso_session_grid(session));
    const size_t position = iso_history_position(history);
    while (iso_history_position(history))
        if (iso_session_undo(session, NULL) != ISO_OK) abort();
    if (field_hash(iso_session_grid(session)) != before) abort();
    while (iso_history_position(history) < position)
        if (iso_session_redo(session, NULL) != ISO_OK) abort();
    if (field_hash(iso_session_grid(session)) != after) abort();
}

/* ---- playing */

/* The file's own grid is too large for so many runs: the part of it that matters is its voxel size. */
static iso_session *open_session(iso_journal_start start) {
    iso_hgrid *grid;
    iso_session *session;
    const iso_session_opts opts = {.undo_memory = 1 << 16};
    for (int axis = 0; axis < 3; axis++)
        start.dims[axis] = start.dims[axis] < SIDE ? (start.dims[axis] + 15) / 16 * 16 : SIDE;
    start.radius = 0.3 * SIDE * start.voxel_size;
    if (iso_session_ball(&start, &grid, NULL) != ISO_OK) abort();
    if (iso_session_create(grid, &start, &opts, &session, NULL) != ISO_OK) abort();
    return session;
}

typedef struct stroke {
    iso_vec3 last;
    double spacing;
} stroke;

/* Whether the event is played: one that makes many touches takes too long here. */
static bool is_short(stroke *s, const iso_event *event) {
    if (event->kind == ISO_EVENT_BEGIN)
        *s = (stroke){event->sample.position,
                      event->brush.radius * (event->brush.spacing > 0 ? event->brush.spacing : 0.25)};
    if (event->kind != ISO_EVENT_SAMPLE) return true;
    const double length = iso_vec3_length(iso_vec3_sub(event->sample.position, s->last));
    if (!(length <= TOUCHES * s->spacing)) return false;
    s->last = event->sample.position;
    return true;
}

static void play(iso_journal_reader *reader, iso_session *session, const char *path) {
    const uint32_t before = field_hash(iso_session_grid(session));
    stroke s = {.spacing = 1};
    iso_event event;
    iso_error error = {0};
    bool more = true, drawing = false;
    iso_status status = ISO_OK;
    for (int i = 0; status == ISO_OK && more; i++) {
        status = iso_journal_next(reader, &event, &more, &error);
        if (status != ISO_OK || !more || i >= EVENTS || !is_short(&s, &event)) continue;
        status = iso_journal_blame(reader, iso_session_play(session, &event, NULL, &error), &error);
        if (status == ISO_OK && event.kind <= ISO_EVENT_CANCEL) drawing = event.kind <= ISO_EVENT_SAMPLE;
        check_field(iso_session_grid(session));
    }
    if (status != ISO_OK) check_error(&error, status, path);
    if (drawing && iso_session_end(session, NULL) != ISO_OK) abort();
    check_field(iso_session_grid(session));
    check_undo(session, before);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    char path[64];
    int descriptor = memfd_create("fuzz_strokes", 0);
    if (descriptor < 0) abort();
    snprintf(path, sizeof path, "/proc/self/fd/%d", descriptor);
    put_file(descriptor, (const char *)data, size);
    iso_journal_start start;
    iso_journal_reader *reader;
    iso_error error = {0};
    iso_status status = iso_journal_open(path, &start, &reader, &error);
    if (status == ISO_OK) {
        iso_session *session = open_session(start);
        play(reader, session, path);
        iso_session_destroy(session);
        iso_journal_reader_free(reader);
    } else
        check_error(&error, status, path);
    close(descriptor);
    return 0;
}
