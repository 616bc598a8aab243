/* Writes and reads stroke files. Lines wait in a queue, which a background thread takes and writes; after a
 * failure the thread keeps the unwritten rest. event.c makes and parses the text of a line. */
#include "sculpt/session/journal.h"

#include <errno.h>
#include <fcntl.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <time.h>
#include <unistd.h>

#include "base/file.h"
#include "base/memory.h"
#include "base/thread.h"
#include "sculpt/limits.h"
#include "sculpt/session/event.h"

/* The longest time that a line waits in the queue. */
enum { FLUSH_SECONDS = 1 };

/* Text that has not been written yet. */
typedef struct queue {
    char *text;
    size_t size, room;
} queue;

struct iso_journal {
    char *path;
    int file;
    unsigned long long next; /* number of the next line */
    pthread_t thread;
    pthread_mutex_t mutex;
    pthread_cond_t wake, done;
    queue writing;  /* lines taken from `waiting`; only the thread uses `writing` and `written` */
    size_t written; /* bytes of `writing` that are in the file */
    /* protected by the mutex */
    queue waiting;
    bool sync_wanted, closing, idle;
    int failure; /* errno of the last attempt, 0: it succeeded */
};

/* ---- the writing thread */

/* Writes the whole queue to the file and adds the number of written bytes to *done. Returns 0, or the errno
 * of a failure. */
static int write_all(int file, const queue *q, size_t *done) {
    while (*done < q->size) {
        ssize_t n = write(file, q->text + *done, q->size - *done);
        if (n > 0) *done += (size_t)n;
        if (n < 0 && errno != EINTR) return errno;
        if (n == 0) return ENOSPC;
    }
    return 0;
}

static void wait_for_lines(iso_journal *j) {
    struct timespec until;
    clock_gettime(CLOCK_REALTIME, &until);
    until.tv_sec += FLUSH_SECONDS;
    while (!j->closing && !j->sync_wanted)
        if (pthread_cond_timedwait(&j->wake, &j->mutex, &until)) return;
}

/* Waits 0.2 s after a failure. */
static void pause_writing(iso_journal *j) {
    struct timespec until;
    clock_gettime(CLOCK_REALTIME, &until);
    until.tv_nsec += 200000000;
    until.tv_sec += until.tv_nsec / 1000000000;
    until.tv_nsec %= 1000000000;
    pthread_cond_timedwait(&j->wake, &j->mutex, &until);
}

/* Whether lines that were taken from the queue are not in the file yet. */
static bool is_writing(const iso_journal *j) {
    return j->written < j->writing.size;
}

static void take_queue(iso_journal *j) {
    free(j->writing.text);
    j->writing = j->waiting;
    j->waiting = (queue){0};
    j->written = 0;
}

/* Writes the lines that were taken from the queue, then those that are still in it; the mutex is unlocked
 * meanwhile. Lines that could not be written stay where they are until the next attempt, so a failure takes
 * no memory. */
static void write_queue(iso_journal *j) {
    const bool sync = j->sync_wanted;
    int failure = 0;
    j->sync_wanted = false;
    while (!failure && (is_writing(j) || j->waiting.size)) {
        if (!is_writing(j)) take_queue(j);
        pthread_mutex_unlock(&j->mutex);
        failure = write_all(j->file, &j->writing, &j->written);
        pthread_mutex_lock(&j->mutex);
    }
    if (!is_writing(j)) take_queue(j); /* the queue is empty; frees the written lines */
    if (!failure && sync) {
        pthread_mutex_unlock(&j->mutex);
        if (fdatasync(j->file) && errno != EINVAL && errno != EROFS) failure = errno;
        pthread_mutex_lock(&j->mutex);
    }
    j->sync_wanted |= sync && failure;
    j->failure = failure;
}

static void *write_lines(void *context) {
    iso_journal *j = context;
    pthread_mutex_lock(&j->mutex);
    for (;;) {
        j->idle = !is_writing(j) && !j->waiting.size && !j->sync_wanted;
        pthread_cond_broadcast(&j->done);
        if (j->closing && (j->idle || j->failure)) break;
        wait_for_lines(j);
        if (is_writing(j) || j->waiting.size || j->sync_wanted) {
            j->idle = false;
            write_queue(j);
            if (j->failure && !j->closing) {
                pthread_cond_broadcast(&j->done);
                pause_writing(j);
            }
        }
    }
    pthread_mutex_unlock(&j->mutex);
    return NULL;
}

/* ---- opening and closing */

static iso_status start_thread(iso_journal *j, iso_error *error) {
    pthread_mutex_init(&j->mutex, NULL);
    pthread_cond_init(&j->wake, NULL);
    pthread_cond_init(&j->done, NULL);
    j->idle = true;
    if (iso_thread_start(&j->thread, write_lines, j) == 0) return ISO_OK;
    pthread_mutex_destroy(&j->mutex);
    pthread_cond_destroy(&j->wake);
    pthread_cond_destroy(&j->done);
    return iso_fail(error, ISO_ERR_NOMEM, "cannot start the journal's thread");
}

static void free_journal(iso_journal *j) {
    if (j->file >= 0) close(j->file);
    free(j->writing.text);
    free(j->waiting.text);
    iso_free(j->path);
    iso_free(j);
}

static iso_journal *allocate_journal(const char *path) {
    iso_journal *j = iso_alloc_zero(1, sizeof *j);
    size_t size = strlen(path) + 1;
    if (!j) return NULL;
    j->file = -1;
    j->path = iso_alloc(size);
    if (!j->path) {
        free_journal(j);
        return NULL;
    }
    memcpy(j->path, path, size);
    return j;
}

/* The lock is one of the file, whatever name it has been opened by. (There are file systems without locks.)
 */
static iso_status open_locked(iso_journal *j, int flags, iso_error *error) {
    j->file = open(j->path, O_WRONLY | O_NONBLOCK | O_CLOEXEC | flags, 0666);
    if (j->file < 0) return iso_fail(error, ISO_ERR_WRITE, "cannot write '%s': %s", j->path, strerror(errno));
    if (flock(j->file, LOCK_EX | LOCK_NB) == 0 || errno != EWOULDBLOCK) return ISO_OK;
    return iso_fail(error, ISO_ERR_WRITE, "%s: another program has it open", j->path);
}

/* Appends a line to the queue and frees the line. Returns false if `line` is NULL or there is no memory. The
 * mutex must be locked, unless the thread does not run yet. */
static bool enqueue(queue *q, char *line) {
    size_t size = line ? strlen(line) : 0;
    if (line && q->size + size > q->room) {
        size_t room = 2 * q->room > q->size + size ? 2 * q->room : q->size + size + 4096;
        char *text = realloc(q->text, room);
        if (text) {
            q->text = text;
            q->room = room;
        }
    }
    bool fits = line && q->size + size <= q->room;
    if (fits) {
        memcpy(q->text + q->size, line, size);
        q->size += size;
    }
    free(line);
    return fits;
}

iso_status iso_journal_create(const char *path, const iso_journal_start *start, iso_journal **out,
                              iso_error *error) {
    iso_journal *j = allocate_journal(path);
    if (!j || !enqueue(&j->waiting, iso_event_header_text(start))) {
        if (j) free_journal(j);
        return iso_fail(error, ISO_ERR_NOMEM, "out of memory for the journal");
    }
    iso_status status = open_locked(j, O_CREAT | O_EXCL, error);
    if (status == ISO_OK) status = start_thread(j, error);
    if (status != ISO_OK) {
        free_journal(j);
        return status;
    }
    *out = j;
    return iso_journal_sync(j, error) == ISO_OK ? ISO_OK : iso_journal_close(j, error);
}

/* Counts the events of a journal that is opened, and removes an incomplete last line. */
static iso_status continue_lines(iso_journal *j, iso_error *error) {
    iso_journal_start start;
    iso_journal_reader *reader;
    ISO_TRY(iso_journal_open(j->path, &start, &reader, error));
    iso_event event;
    bool more = true;
    iso_status status = ISO_OK;
    while (status == ISO_OK && more) {
        status = iso_journal_next(reader, &event, &more, error);
        j->next += status == ISO_OK && more;
    }
    const uint64_t sound = iso_journal_sound_bytes(reader);
    iso_journal_reader_free(reader);
    if (status != ISO_OK || ftruncate(j->file, (off_t)sound) == 0) return status;
    return iso_fail(error, ISO_ERR_WRITE, "cannot write '%s': %s", j->path, strerror(errno));
}

bool iso_journal_is_locked(const char *path) {
    const int file = open(path, O_RDONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC);
    const bool locked = file >= 0 && flock(file, LOCK_SH | LOCK_NB) != 0 && errno == EWOULDBLOCK;
    if (file >= 0) close(file);
    return locked;
}

iso_status iso_journal_append(const char *path, iso_journal **out, iso_error *error) {
    iso_journal *j = allocate_journal(path);
    if (!j) return iso_fail(error, ISO_ERR_NOMEM, "out of memory for the journal");
    iso_status status = open_locked(j, O_APPEND, error);
    if (status == ISO_OK) status = continue_lines(j, error);
    if (status == ISO_OK) status = start_thread(j, error);
    if (status != ISO_OK)
        free_journal(j);
    else
        *out = j;
    return status;
}

iso_status iso_journal_put(iso_journal *j, const iso_event *event, iso_error *error) {
    pthread_mutex_lock(&j->mutex);
    bool put = enqueue(&j->waiting, iso_event_text(event, j->next));
    j->next += put;
    j->idle &= !put;
    if (put && event->kind != ISO_EVENT_BEGIN && event->kind != ISO_EVENT_SAMPLE) {
        j->sync_wanted = true;
        pthread_cond_signal(&j->wake);
    }
    pthread_mutex_unlock(&j->mutex);
    return put ? ISO_OK : iso_fail(error, ISO_ERR_NOMEM, "out of memory for the journal");
}

unsigned long long iso_journal_count(const iso_journal *j) {
    return j->next; /* without the mutex, because the writing thread does not use it */
}

static iso_status report_failure(const iso_journal *j, iso_error *error) {
    if (!j->failure) return ISO_OK;
    return iso_fail(error, ISO_ERR_WRITE, "cannot write '%s': %s (strokes are kept in memory)", j->path,
                    strerror(j->failure));
}

iso_status iso_journal_status(iso_journal *j, iso_error *error) {
    pthread_mutex_lock(&j->mutex);
    iso_status status = report_failure(j, error);
    pthread_mutex_unlock(&j->mutex);
    return status;
}

iso_status iso_journal_sync(iso_journal *j, iso_error *error) {
    pthread_mutex_lock(&j->mutex);
    j->sync_wanted = true;
    j->idle = false;
    j->failure = 0;
    pthread_cond_signal(&j->wake);
    while (!j->idle && !j->failure) pthread_cond_wait(&j->done, &j->mutex);
    iso_status status = report_failure(j, error);
    pthread_mutex_unlock(&j->mutex);
    return status;
}

iso_status iso_journal_close(iso_journal *j, iso_error *error) {
    iso_status status = iso_journal_sync(j, error);
    pthread_mutex_lock(&j->mutex);
    j->closing = true;
    pthread_cond_signal(&j->wake);
    pthread_mutex_unlock(&j->mutex);
    pthread_join(j->thread, NULL);
    pthread_mutex_destroy(&j->mutex);
    pthread_cond_destroy(&j->wake);
    pthread_cond_destroy(&j->done);
    free_journal(j);
    return status;
}

/* ---- reading */

struct iso_journal_reader {
    char *path;
    FILE *file;
    iso_buffer line;
    iso_journal_start start;
    unsigned long long lines;  /* read so far, the header included */
    uint64_t sound;            /* bytes up to the end of the last valid line */
    iso_stamp *stamp;          /* the last event's; NULL: it has none */
    const iso_sample *samples; /* of its path, the same */
};

void iso_journal_reader_free(iso_journal_reader *reader) {
    if (!reader) return;
    if (reader->file) fclose(reader->file);
    iso_stamp_free(reader->stamp);
    iso_free((void *)reader->samples);
    iso_buffer_free(&reader->line);
    iso_free(reader->path);
    iso_free(reader);
}

/* Reads the next line; *size does not count its newline. *whole is false if the file ends before a newline.
 */
static iso_status next_line(iso_journal_reader *reader, size_t *size, bool *whole, iso_error *error) {
    enum { PIECE = 4096 };
    *size = 0;
    *whole = false;
    for (int c; (c = getc_unlocked(reader->file)) != EOF; ((char *)reader->line.data)[(*size)++] = (char)c) {
        *whole = c == '\n';
        if (*whole) return ISO_OK;
        if (*size == ISO_LIMIT_LINE)
            return iso_fail(error, ISO_ERR_FORMAT,
                            "'%s' is not a stroke file: line %llu is longer than %d bytes", reader->path,
                            reader->lines + 1, ISO_LIMIT_LINE);
        if (*size % PIECE == 0) ISO_TRY(iso_buffer_reserve(&reader->line, *size + PIECE, *size, error));
    }
    if (!ferror(reader->file)) return ISO_OK;
    return iso_fail(error, ISO_ERR_IO, "cannot read '%s': %s", reader->path, strerror(errno));
}

/* The status of a line that could not be read. */
static iso_status status_of(const iso_error *why) {
    return why->status == ISO_ERR_NOMEM ? ISO_ERR_NOMEM : ISO_ERR_FORMAT;
}

static iso_status read_header(iso_journal_reader *reader, iso_error *error) {
    size_t size;
    bool whole;
    iso_error why = {0};
    ISO_TRY(iso_file_open(reader->path, &reader->file, NULL, error));
    ISO_TRY(next_line(reader, &size, &whole, error));
    if (!whole)
        return iso_fail(error, ISO_ERR_FORMAT, "'%s' is not a stroke file: it has no whole line",
                        reader->path);
    switch (iso_event_header_read(reader->line.data, size, &reader->start, &why)) {
    case ISO_LINE_SOUND:
        break;
    case ISO_LINE_TORN:
        return iso_fail(error, ISO_ERR_FORMAT, "'%s' is not a stroke file: line 1: %s", reader->path,
                        why.text);
    default:
        return iso_fail(error, status_of(&why), "'%s' line 1: %s", reader->path, why.text);
    }
    reader->lines = 1;
    reader->sound = size + 1;
    return ISO_OK;
}

iso_status iso_journal_open(const char *path, iso_journal_start *start, iso_journal_reader **out,
                            iso_error *error) {
    iso_journal_reader *reader = iso_alloc_zero(1, sizeof *reader);
    size_t size = strlen(path) + 1;
    if (reader) reader->path = iso_alloc(size);
    if (!reader || !reader->path) {
        iso_journal_reader_free(reader);
        return iso_fail(error, ISO_ERR_NOMEM, "out of memory for reading '%s'", path);
    }
    memcpy(reader->path, path, size);
    iso_status status = read_header(reader, error);
    if (status == ISO_OK) {
        *start = reader->start;
        *out = reader;
    } else
        iso_journal_reader_free(reader);
    return status;
}

/* Returns the status of an incomplete line. ISO_OK: the line is the last one, as a crash leaves it (which may
 * write the end of a line but not its beginning). ISO_ERR_FORMAT: another line follows, so the file is
 * damaged. */
static iso_status check_incomplete_line(iso_journal_reader *reader, const char *why, iso_error *error) {
    if (getc_unlocked(reader->file) == EOF) return ISO_OK;
    return iso_fail(error, ISO_ERR_FORMAT, "'%s' is damaged at line %llu: %s", reader->path,
                    reader->lines + 1, why);
}

iso_status iso_journal_next(iso_journal_reader *reader, iso_event *event, bool *more, iso_error *error) {
    size_t size;
    iso_error why = {0};
    *more = false;
    iso_stamp_free(reader->stamp);
    iso_free((void *)reader->samples);
    reader->stamp = NULL;
    reader->samples = NULL;
    bool whole;
    ISO_TRY(next_line(reader, &size, &whole, error));
    if (!whole) return ISO_OK;
    const iso_event_context place = {&reader->start, reader->lines - 1};
    switch (iso_event_read(reader->line.data, size, &place, event, &why)) {
    case ISO_LINE_SOUND:
        break;
    case ISO_LINE_TORN:
        return check_incomplete_line(reader, why.text, error);
    default:
        return iso_fail(error, status_of(&why), "'%s' line %llu: %s", reader->path, reader->lines + 1,
                        why.text);
    }
    *more = true;
    reader->stamp = event->stamp;
    reader->samples = event->path;
    reader->lines++;
    reader->sound += size + 1;
    return ISO_OK;
}

iso_status iso_journal_add_location(const iso_journal_reader *reader, iso_status status, iso_error *error) {
    if (status == ISO_OK || !error) return status;
    const iso_error why = *error;
    if (status == ISO_ERR_USAGE) status = ISO_ERR_FORMAT; /* the file caused it */
    if (status != ISO_ERR_FORMAT && status != ISO_ERR_NOMEM && status != ISO_ERR_LIMIT) return status;
    return iso_fail(error, status, "'%s' line %llu: %s", reader->path, reader->lines, why.text);
}

uint64_t iso_journal_sound_bytes(const iso_journal_reader *reader) {
    return reader->sound;
}

/* ---- rewriting */

/* Writes a line and frees it. (iso_sink_commit finds errors of writing.) */
static iso_status write_line(FILE *stream, char *line, iso_error *error) {
    if (!line) return iso_fail(error, ISO_ERR_NOMEM, "out of memory for a stroke file");
    fputs(line, stream);
    free(line);
    return ISO_OK;
}

static iso_status write_events(iso_journal_reader *reader, const iso_event *edits, size_t count, FILE *stream,
                               iso_error *error) {
    iso_event event;
    iso_journal_start start = reader->start;
    unsigned long long number = 0;
    bool more = true, drawing = false, acts_at_end = false;
    if (count && (start.isovalue == 0 || !start.voxel_isovalue)) {
        start.has_edits = true;
        start.voxel_isovalue = false;
    }
    ISO_TRY(write_line(stream, iso_event_header_text(&start), error));
    for (;;) {
        ISO_TRY(iso_journal_next(reader, &event, &more, error));
        if (!more) break;
        if (event.kind <= ISO_EVENT_CANCEL) drawing = event.kind <= ISO_EVENT_SAMPLE;
        if (event.kind == ISO_EVENT_BEGIN) acts_at_end = iso_tool_is_trim(event.brush.tool);
        if (event.kind != ISO_EVENT_CHECKPOINT)
            ISO_TRY(write_line(stream, iso_event_text(&event, number++), error));
    }
    memset(&event, 0, sizeof event);
    event.kind = acts_at_end ? ISO_EVENT_CANCEL : ISO_EVENT_END; /* as iso_session_end_cut_off */
    if (drawing) ISO_TRY(write_line(stream, iso_event_text(&event, number++), error));
    for (size_t i = 0; i < count; i++)
        ISO_TRY(write_line(stream, iso_event_text(&edits[i], number++), error));
    return ISO_OK;
}

iso_status iso_journal_rewrite(const char *from, const iso_event *edits, size_t count, const char *to,
                               iso_error *error) {
    iso_journal_start start;
    iso_journal_reader *reader;
    iso_sink sink;
    ISO_TRY(iso_journal_open(from, &start, &reader, error));
    iso_status status = iso_sink_open(to, &sink, error);
    if (status == ISO_OK) {
        status = write_events(reader, edits, count, sink.stream, error);
        if (status == ISO_OK)
            status = iso_sink_commit(&sink, error);
        else
            iso_sink_abort(&sink);
    }
    iso_journal_reader_free(reader);
    return status;
}
