/* Documents: journals in the state folder, their lock files, opening and closing. */
#include "apps/isosculpt/document.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include "apps/isosculpt/save.h"
#include "base/clock.h"
#include "base/file.h"
#include "base/text.h"

static const char STROKES[] = ".strokes", OPEN[] = ".open";

/* What a session begins with if nothing is asked for. */
static const iso_start_solid BALL = {ISO_SOLID_SPHERE, {80, 80, 80}, 0};

static iso_status join_path(char out[ISOSCULPT_PATH], const char *a, const char *b, iso_error *error) {
    size_t first = strlen(a), second = strlen(b);
    if (first + second >= ISOSCULPT_PATH)
        return iso_fail(error, ISO_ERR_WRITE, "%s: the name is too long", a);
    memmove(out, a, first);
    memcpy(out + first, b, second + 1);
    return ISO_OK;
}

/* ---- the state folder */

static iso_status make_folders(char *path, iso_error *error) {
    for (char *slash = path + 1;; slash++) {
        if (*slash != '/' && *slash != 0) continue;
        char rest = *slash;
        *slash = 0;
        int failed = mkdir(path, 0700);
        if (failed && errno != EEXIST)
            return iso_fail(error, ISO_ERR_WRITE, "%s: cannot make the folder: %s", path, strerror(errno));
        *slash = rest;
        if (!rest) return ISO_OK;
    }
}

iso_status isosculpt_document_name_state_folder(char folder[ISOSCULPT_PATH], iso_error *error) {
    const char *state = getenv("XDG_STATE_HOME"), *home = getenv("HOME");
    if (state && state[0] == '/') /* the specification ignores relative paths */
        ISO_TRY(join_path(folder, state, "/isopoint", error));
    else if (home && home[0] == '/')
        ISO_TRY(join_path(folder, home, "/.local/state/isopoint", error));
    else
        return iso_fail(error, ISO_ERR_WRITE, "neither XDG_STATE_HOME nor HOME says where journals go");
    return ISO_OK;
}

iso_status isosculpt_document_state_folder(char folder[ISOSCULPT_PATH], iso_error *error) {
    ISO_TRY(isosculpt_document_name_state_folder(folder, error));
    return make_folders(folder, error);
}

/* ---- lock files */

/* Opens a lock file, whose content may be written over: never through a link, nor a file that has another
 * name too. Returns -1 with errno set. */
static int open_lock_file(const char *path, int flags) {
    struct stat about;
    const int file = open(path, O_RDWR | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC | flags, 0600);
    if (file < 0 || (fstat(file, &about) == 0 && S_ISREG(about.st_mode) && about.st_nlink == 1)) return file;
    close(file);
    errno = ELOOP; /* as for a symbolic link */
    return -1;
}

/* Makes and locks NAME.strokes.open. `ours`: this program has the journal open already. ISO_ERR_WRITE when
 * another program holds the lock. */
static iso_status lock_journal(const char *journal, bool ours, int *lock_file, iso_error *error) {
    char path[ISOSCULPT_PATH];
    ISO_TRY(join_path(path, journal, OPEN, error));
    int file = open_lock_file(path, O_CREAT);
    if (file < 0)
        return iso_fail(error, ISO_ERR_WRITE, "%s: %s", path,
                        errno == ELOOP ? "is a link to a file, and not written to" : strerror(errno));
    if (flock(file, LOCK_EX | LOCK_NB) || (!ours && iso_journal_is_locked(journal))) {
        close(file);
        return iso_fail(error, ISO_ERR_WRITE, "%s: another program has it open", journal);
    }
    *lock_file = file + 1;
    return ISO_OK;
}

void isosculpt_document_dismiss_recovery(const char *journal) {
    char path[ISOSCULPT_PATH];
    if (join_path(path, journal, OPEN, NULL) == ISO_OK) unlink(path);
}

/* Returns whether the lock file exists, because a program has the journal open or was killed. */
static bool has_lock_file(const char *journal) {
    char path[ISOSCULPT_PATH];
    return join_path(path, journal, OPEN, NULL) == ISO_OK && access(path, F_OK) == 0;
}

/* Returns whether a running program holds the lock. */
static bool is_locked(const char *lock_file) {
    int file = open_lock_file(lock_file, 0);
    const bool locked = file < 0 || flock(file, LOCK_EX | LOCK_NB) != 0;
    if (file >= 0) close(file);
    return locked;
}

/* Writes the lines. The rest of longer old lines follows them until the file is truncated. */
void isosculpt_document_remember(const isosculpt_document *document) {
    char lines[ISOSCULPT_PATH + ISOSCULPT_LOOK + 2];
    const int length = snprintf(lines, sizeof lines, "%s\n%s\n",
                                document->target_was_saved ? document->target : "", document->look);
    const int file = document->lock_file - 1;
    if (file < 0 || pwrite(file, lines, (size_t)length, 0) != length) return;
    while (ftruncate(file, length) && errno == EINTR) continue;
}

/* Copies the line at *at without its newline and moves *at behind it. Returns false if the line is incomplete
 * or too long. */
static bool take_line(const char **at, char *line, size_t room) {
    const char *end = strchr(*at, '\n');
    if (!end || (size_t)(end - *at) >= room) return false;
    memcpy(line, *at, (size_t)(end - *at));
    line[end - *at] = 0;
    *at = end + 1;
    return true;
}

/* Reads target and look that an earlier program wrote into the lock file. A target that is not there stays as
 * it is. */
static void recall(isosculpt_document *document) {
    char lines[ISOSCULPT_PATH + ISOSCULPT_LOOK + 2] = "", target[ISOSCULPT_PATH];
    const char *at = lines;
    if (pread(document->lock_file - 1, lines, sizeof lines - 1, 0) <= 0) return;
    if (!take_line(&at, target, sizeof target)) return;
    document->target_was_saved = target[0] == '/';
    if (document->target_was_saved) memcpy(document->target, target, sizeof target);
    if (!take_line(&at, document->look, sizeof document->look)) document->look[0] = 0;
}

/* Returns whether a journal has events. A journal that cannot be read counts, so that the user is told about
 * it, but not one that ends within its first line: its session was killed before there was anything to lose.
 */
static bool has_events(const char *journal) {
    char head[1 << 14];
    struct stat about;
    const size_t bytes = iso_file_head(journal, head, sizeof head);
    const bool whole = stat(journal, &about) == 0 && bytes == (size_t)about.st_size;
    if (whole && !memchr(head, '\n', bytes)) return false;
    iso_journal_start start;
    iso_journal_reader *reader;
    iso_event event;
    bool more = true;
    if (iso_journal_open(journal, &start, &reader, NULL) != ISO_OK) return true;
    const iso_status status = iso_journal_next(reader, &event, &more, NULL);
    iso_journal_reader_free(reader);
    return status != ISO_OK || more;
}

bool isosculpt_document_find_unclosed(const char *folder, char path[ISOSCULPT_PATH]) {
    DIR *directory = opendir(folder);
    if (!directory) return false;
    struct timespec newest = {0};
    bool found = false;
    for (struct dirent *entry; (entry = readdir(directory));) {
        char lock_file[2 * ISOSCULPT_PATH], journal[2 * ISOSCULPT_PATH];
        struct stat about;
        if (!iso_text_ends_with(entry->d_name, ".strokes.open")) continue;
        int length = snprintf(lock_file, sizeof lock_file, "%s/%s", folder, entry->d_name);
        if (length >= ISOSCULPT_PATH) continue;
        snprintf(journal, sizeof journal, "%.*s", length - (int)strlen(OPEN), lock_file);
        if (stat(journal, &about) || is_locked(lock_file) || iso_journal_is_locked(journal)) continue;
        const struct timespec t = about.st_mtim;
        if (found && (t.tv_sec < newest.tv_sec || (t.tv_sec == newest.tv_sec && t.tv_nsec < newest.tv_nsec)))
            continue;
        if (!has_events(journal)) continue;
        found = true;
        newest = t;
        memcpy(path, journal, strlen(journal) + 1);
    }
    closedir(directory);
    return found;
}

/* ---- opening and closing */

/* The field that a session begins with. */
typedef struct first_field {
    iso_hgrid *grid; /* NULL: a session owns it */
    iso_cell_items paint;
} first_field;

/* Creates the session, which takes ownership of the field, also when it fails. */
static iso_status create_session(isosculpt_document *document, first_field *field,
                                 const iso_session_opts *how, iso_error *error) {
    iso_hgrid *grid = field->grid;
    iso_session_opts opts = *how;
    field->grid = NULL;
    opts.paint = &field->paint;
    opts.pool = document->pool;
    opts.undo_memory = document->undo_memory;
    opts.edits_aside = true;
    ISO_TRY(iso_session_create(grid, &document->start, &opts, &document->session, error));
    document->start_seconds = iso_clock_seconds();
    document->change_count = document->saved_change_count = 0;
    return ISO_OK;
}

/* Makes a path from the current time, with a number if two sessions begin in the same second. */
static iso_status name_journal(const char *folder, char path[ISOSCULPT_PATH], iso_error *error) {
    time_t now = time(NULL);
    struct tm local;
    char stamp[64], name[128];
    localtime_r(&now, &local);
    strftime(stamp, sizeof stamp, "%Y-%m-%d-%H%M%S", &local);
    for (int number = 1; number < 100; number++) {
        if (number == 1)
            snprintf(name, sizeof name, "/%s%s", stamp, STROKES);
        else
            snprintf(name, sizeof name, "/%s-%d%s", stamp, number, STROKES);
        ISO_TRY(join_path(path, folder, name, error));
        if (access(path, F_OK)) return ISO_OK;
    }
    return iso_fail(error, ISO_ERR_WRITE, "%s: too many journals of this second", folder);
}

/* Creates a session with a new journal. */
static iso_status create_journaled_session(isosculpt_document *document, const char *folder,
                                           first_field *field, iso_error *error) {
    if (!folder) return iso_fail(error, ISO_ERR_WRITE, "there is no folder for it");
    ISO_TRY(name_journal(folder, document->journal, error));
    ISO_TRY(lock_journal(document->journal, false, &document->lock_file, error));
    const iso_session_opts opts = {.journal = document->journal};
    iso_status status = create_session(document, field, &opts, error);
    document->journal_is_new = status == ISO_OK;
    return status;
}

/* Closes and removes the lock file. */
static void unlock_journal(isosculpt_document *document) {
    if (!document->lock_file) return;
    isosculpt_document_dismiss_recovery(document->journal);
    close(document->lock_file - 1);
    document->lock_file = 0;
}

/* Makes the field of a new session: that of the source, or a ball. */
static iso_status make_start_field(isosculpt_document *document, const iso_source *source, first_field *field,
                                   iso_error *error) {
    *field = (first_field){.grid = NULL};
    if (source) {
        iso_source with_paint = *source;
        with_paint.paint = &field->paint;
        return iso_source_open(&with_paint, &document->start, &field->grid, error);
    }
    ISO_TRY(iso_start_with_solid(&BALL, 0, &document->start, error));
    return iso_session_solid(&document->start, &field->grid, error);
}

iso_status isosculpt_document_new(isosculpt_document *document, const char *folder, const iso_source *source,
                                  iso_error *error) {
    first_field field;
    iso_error reason = {0};
    ISO_TRY(make_start_field(document, source, &field, error));
    isosculpt_target_default(iso_start_has_solid(&document->start) ? NULL : document->start.source,
                             document->target);
    if (create_journaled_session(document, folder, &field, &reason) == ISO_OK) return ISO_OK;
    unlock_journal(document);
    document->journal[0] = 0;
    snprintf(document->journal_error, sizeof document->journal_error, "%s", reason.text);
    if (!field.grid)
        ISO_TRY(make_start_field(document, source, &field, error)); /* the failed session has freed it */
    return create_session(document, &field, &(iso_session_opts){0}, error);
}

iso_status isosculpt_document_init_empty(isosculpt_document *document, iso_error *error) {
    first_field field = {.grid = NULL};
    const iso_transform *none = NULL;
    document->start =
        (iso_journal_start){.source = "nothing", .voxel_size = 1, .dims = {ISO_BRICK, ISO_BRICK, ISO_BRICK}};
    ISO_TRY(iso_hgrid_create(document->start.dims, 0, none, &field.grid, error));
    return create_session(document, &field, &(iso_session_opts){0}, error);
}

/* Makes the field that a session began with, and updates the header. paint: iso_source.paint. */
static iso_status make_first_field(iso_journal_start *start, const char *journal, iso_pool *pool,
                                   const iso_progress *progress, iso_hgrid **grid, iso_cell_items *paint,
                                   iso_error *error) {
    const iso_source how = {.pool = pool, .progress = progress, .paint = paint};
    return iso_source_reopen(journal, &how, start, grid, error);
}

iso_status isosculpt_document_first_field(const iso_journal_start *start, const char *journal, iso_pool *pool,
                                          const iso_progress *progress, iso_hgrid **grid, iso_error *error) {
    iso_journal_start copy = *start;
    return make_first_field(&copy, journal, pool, progress, grid, NULL, error);
}

/* Chooses the target of a stroke file that is continued: beside the stroke file or, for a journal in the
 * state folder, where users do not look, beside the file that the session began with. */
static void choose_target(isosculpt_document *document, const char *journal) {
    char folder[ISOSCULPT_PATH];
    const char *slash = strrchr(journal, '/');
    const size_t length = slash ? (size_t)(slash - journal) : 0;
    if (isosculpt_document_state_folder(folder, NULL) != ISO_OK) folder[0] = 0;
    if (strlen(folder) == length && strncmp(folder, journal, length) == 0)
        isosculpt_target_default(iso_start_has_solid(&document->start) ? NULL : document->start.source,
                                 document->target);
    else
        isosculpt_target_beside(journal, document->target);
}

iso_status isosculpt_document_open(isosculpt_document *document, const char *journal,
                                   const iso_progress *progress, iso_error *error) {
    iso_journal_reader *reader;
    ISO_TRY(iso_journal_open(journal, &document->start, &reader, error));
    iso_journal_reader_free(reader);
    ISO_TRY(join_path(document->journal, journal, "", error));
    const bool was_unclosed = has_lock_file(journal);
    ISO_TRY(lock_journal(journal, false, &document->lock_file, error));
    first_field field = {.grid = NULL};
    const iso_progress reading = iso_progress_part(progress, 0, 0.3),
                       playing = iso_progress_part(progress, 0.3, 1);
    const iso_session_opts opts = {.journal = journal, .resume = true, .progress = &playing};
    iso_status status = make_first_field(&document->start, journal, document->pool, &reading, &field.grid,
                                         &field.paint, error);
    if (status == ISO_OK) status = create_session(document, &field, &opts, error);
    document->was_unclosed = was_unclosed;
    if (status == ISO_OK) {
        choose_target(document, journal);
        if (was_unclosed) {
            recall(document);
            iso_file_remove_unfinished(document->target);
        }
        document->change_count =
            was_unclosed && has_events(journal); /* the recovered work has not been saved */
        return ISO_OK;
    }
    if (!was_unclosed) unlock_journal(document); /* otherwise its recovery is offered again */
    if (document->lock_file) close(document->lock_file - 1);
    document->lock_file = 0;
    document->journal[0] = 0;
    return status;
}

/* ---- another voxel size */

/* Plays all events of a stroke file in a session that records them. */
static iso_status play_into(iso_session *session, iso_journal_reader *reader, uint64_t size,
                            const iso_progress *progress, iso_error *error) {
    iso_event event;
    bool more = true, drawing = false;
    for (;;) {
        ISO_TRY(iso_journal_next(reader, &event, &more, error));
        if (!more) break;
        const double done = (double)iso_journal_sound_bytes(reader) / fmax((double)size, 1);
        ISO_TRY(iso_progress_tell(progress, "the strokes", done, error));
        ISO_TRY(iso_journal_add_location(reader, iso_session_play(session, &event, NULL, error), error));
        if (event.kind <= ISO_EVENT_CANCEL) drawing = event.kind <= ISO_EVENT_SAMPLE;
    }
    return drawing ? iso_session_end_cut_off(session, error) : ISO_OK;
}

/* Makes the field that a session began with, in other voxels. A file that was found beside the strokes is
 * named by its path from now on. */
static iso_status make_resampled_field(isosculpt_document *document, const char *journal, double voxel,
                                       const iso_progress *progress, first_field *field, iso_error *error) {
    const iso_source how = {
        .pool = document->pool, .progress = progress, .paint = &field->paint, .voxel = voxel};
    char found[ISO_SOURCE_PATH];
    if (!iso_start_has_solid(&document->start)) {
        ISO_TRY(iso_source_find(journal, &document->start, progress, found, error));
        if (strlen(found) < sizeof document->start.source) strcpy(document->start.source, found);
    }
    return iso_source_reopen(journal, &how, &document->start, &field->grid, error);
}

/* Plays the events of the reader in a session with a new journal. The journal counts as that of a session,
 * which is recovered after a crash, only when it has all of them. */
static iso_status play_again(isosculpt_document *document, const char *folder, iso_journal_reader *reader,
                             uint64_t size, double cost_factor, first_field *field,
                             const iso_progress *progress, iso_error *error) {
    if (!folder) return iso_fail(error, ISO_ERR_WRITE, "there is no folder for the strokes");
    ISO_TRY(name_journal(folder, document->journal, error));
    const iso_session_opts opts = {.journal = document->journal, .cost_factor = cost_factor};
    ISO_TRY(create_session(document, field, &opts, error));
    document->journal_is_new = true;
    ISO_TRY(play_into(document->session, reader, size, progress, error));
    return lock_journal(document->journal, true, &document->lock_file, error);
}

iso_status isosculpt_document_resample(isosculpt_document *document, const char *journal, const char *folder,
                                       double voxel, const iso_progress *progress, iso_error *error) {
    const iso_progress making = iso_progress_part(progress, 0, 0.3),
                       playing = iso_progress_part(progress, 0.3, 1);
    iso_journal_reader *reader;
    struct stat about = {.st_size = 0};
    first_field field = {.grid = NULL};
    ISO_TRY(iso_journal_open(journal, &document->start, &reader, error));
    stat(journal, &about);
    const double before = document->start.voxel_size;
    iso_status status = make_resampled_field(document, journal, voxel, &making, &field, error);
    const double factor = fmax(1, pow(before / document->start.voxel_size, 3));
    if (status == ISO_OK)
        status =
            play_again(document, folder, reader, (uint64_t)about.st_size, factor, &field, &playing, error);
    if (status == ISO_OK) choose_target(document, journal);
    if (field.grid) iso_hgrid_destroy(field.grid);
    iso_cell_items_free(&field.paint);
    iso_journal_reader_free(reader);
    return status;
}

/* Removes a new journal in which nothing was done. */
static void remove_empty_journal(const isosculpt_document *document) {
    unlink(document->journal);
}

/* `keep_unclosed`: the journal stays unclosed, so its recovery is offered again. */
static void close_document(isosculpt_document *document, bool keep_unclosed) {
    isosculpt_document_poll_save(document, true, NULL, NULL);
    const bool complete = document->session && iso_session_journal_status(document->session, NULL) == ISO_OK;
    isosculpt_stroke_editor_free(&document->strokes, document->session);
    iso_session_destroy(document->session);
    if (complete && document->journal_is_new && !document->has_stamp && document->change_count == 0)
        remove_empty_journal(document);
    if (complete && !keep_unclosed) unlock_journal(document);
    if (document->lock_file) close(document->lock_file - 1); /* an incomplete journal counts as unclosed */
    *document = (isosculpt_document){.pool = document->pool, .undo_memory = document->undo_memory};
}

void isosculpt_document_close(isosculpt_document *document) {
    close_document(document, false);
}

void isosculpt_document_discard(isosculpt_document *document) {
    close_document(document, document->was_unclosed);
}
