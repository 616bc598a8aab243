/* fuzz: any bytes as a stroke file. Numbers of lines and checksums are put right before it is read, so that
 * what a line says is tried and not only that it is damaged. What is read is played on a small grid: the
 * field must stay a clamped distance field, undoing all of it must bring back the field as it was, and what
 * is refused must be refused in one line that names the file. */
#include <math.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#include "base/crc32c.h"
#include "sculpt/session/session.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

/* Largest grid that is played on; events and touches of a sample that are played. */
enum { SIDE = 32, EVENTS = 48, TOUCHES = 32 };

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
    const int cells = grid->cells[0] * grid->cells[1] * grid->cells[2];
    for (int cell = 0; cell < cells; cell++) {
        if (grid->cell[cell] < 0) continue;
        const float *brick = iso_hgrid_brick(grid, grid->cell[cell]);
        bool sound = true;
        for (int i = 0; i < ISO_BRICK_VOXELS; i++) sound &= brick[i] >= -grid->band && brick[i] <= grid->band;
        if (!sound) abort();
    }
}

/* (FNV-1a over words: a checksum from the library would be traced by the fuzzer, byte by byte) */
static uint64_t field_hash(const iso_hgrid *grid) {
    const int cells = grid->cells[0] * grid->cells[1] * grid->cells[2];
    uint64_t hash = 0xcbf29ce484222325u;
    for (int cell = 0; cell < cells; cell++) {
        const int32_t state = grid->cell[cell] < 0 ? grid->cell[cell] : 0;
        hash = (hash ^ (uint32_t)state) * 0x100000001b3u;
        for (int i = 0; state == 0 && i < ISO_BRICK_VOXELS; i++) {
            uint32_t bits;
            memcpy(&bits, iso_hgrid_brick(grid, grid->cell[cell]) + i, sizeof bits);
            hash = (hash ^ bits) * 0x100000001b3u;
        }
    }
    return hash;
}

static void check_undo(iso_session *session, uint64_t before) {
    const iso_history *history = iso_session_history(session);
    const uint64_t after = field_hash(iso_session_grid(session));
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
    double *origin[3] = {&start.origin.x, &start.origin.y, &start.origin.z};
    for (int axis = 0; axis < 3; axis++) {
        start.dims[axis] = start.dims[axis] < SIDE ? ISO_BRICK : SIDE;
        *origin[axis] = -0.5 * (start.dims[axis] - 1) * start.voxel_size;
    }
    start.radius = 0.3 * SIDE * start.voxel_size;
    if (!iso_start_has_solid(&start)) strcpy(start.source, "ball");
    if (iso_session_solid(&start, &grid, NULL) != ISO_OK) abort();
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
    const uint64_t before = field_hash(iso_session_grid(session));
    stroke s = {.spacing = 1};
    iso_event event;
    iso_error error = {0};
    bool more = true, drawing = false;
    iso_status status = ISO_OK;
    for (int i = 0; status == ISO_OK && more; i++) {
        status = iso_journal_next(reader, &event, &more, &error);
        if (status != ISO_OK || !more || i >= EVENTS || !is_short(&s, &event)) continue;
        status = iso_journal_add_location(reader, iso_session_play(session, &event, NULL, &error), &error);
        if (status == ISO_OK && event.kind <= ISO_EVENT_CANCEL) drawing = event.kind <= ISO_EVENT_SAMPLE;
        check_field(iso_session_grid(session));
    }
    if (status != ISO_OK) check_error(&error, status, path);
    if (drawing && iso_session_end_cut_off(session, NULL) != ISO_OK) abort();
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
