#define _DEFAULT_SOURCE /* flock */
#include "apps/isosculpt/document.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include "apps/isosculpt/save.h"
#include "base/clock.h"
#include "base/text.h"

static const char STROKES[] = ".strokes", OPEN[] = ".open", UNDO[] = ".undo";

/* The new ball: half the side of its grid. */
enum { BALL_VOXELS = 384 };
static const double BALL_VOXEL = 0.5, BALL_RADIUS = 40;

static iso_status join(char out[ISOSCULPT_PATH], const char *a, const char *b, iso_error *error) {
    size_t first = strlen(a), second = strlen(b);
    if (first + second >= ISOSCULPT_PATH)
        return iso_fail(error, ISO_ERR_WRITE, "%s: the name is too long", a);
    memmove(out, a, first);
    memcpy(out + first, b, second + 1);
    return ISO_OK;
}

/* ---- the folder */

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

iso_status isosculpt_document_state_folder(char folder[ISOSCULPT_PATH], iso_error *error) {
    const char *state = getenv("XDG_STATE_HOME"), *home = getenv("HOME");
    if (state && state[0] == '/') /* the specification: others are to be ignored */
        ISO_TRY(join(folder, state, "/isopoint", error));
    else if (home && home[0] == '/')
        ISO_TRY(join(folder, home, "/.local/state/isopoint", error));
    else
        return iso_fail(error, ISO_ERR_WRITE, "neither XDG_STATE_HOME nor HOME says where journals go");
    return make_folders(folder, error);
}

/* ---- markers */

/* Locks NAME.strokes.open, made when it is not there. ISO_ERR_WRITE. */
static iso_status mark(const char *journal, int *marker, iso_error *error) {
    char path[ISOSCULPT_PATH];
    ISO_TRY(join(path, journal, OPEN, error));
    int file = open(path, O_RDWR | O_CREAT | O_CLOEXEC, 0600);
    if (file < 0) return iso_fail(error, ISO_ERR_WRITE, "%s: %s", path, strerror(errno));
    if (flock(file, LOCK_EX | LOCK_NB)) {
        close(file);
        return iso_fail(error, ISO_ERR_WRITE, "%s: another program has it open", journal);
    }
    *marker = file + 1;
    return ISO_OK;
}

void isosculpt_document_dismiss_recovery(const char *journal) {
    char path[ISOSCULPT_PATH];
    if (join(path, journal, OPEN, NULL) == ISO_OK) unlink(path);
}

/* Whether it counts as open, by whomever. */
static bool is_marked(const char *journal) {
    char path[ISOSCULPT_PATH];
    return join(path, journal, OPEN, NULL) == ISO_OK && access(path, F_OK) == 0;
}

static bool is_held(const char *marker) {
    int file = open(marker, O_RDWR | O_CLOEXEC);
    bool pick_layer = file < 0 || flock(file, LOCK_EX | LOCK_NB) != 0;
    if (file >= 0) close(file);
    return pick_layer;
}

bool isosculpt_document_find_unclosed(const char *folder, char path[ISOSCULPT_PATH]) {
    DIR *directory = opendir(folder);
    if (!directory) return false;
    struct timespec newest = {0};
    bool found = false;
    for (struct dirent *entry; (entry = readdir(directory));) {
        char marker[2 * ISOSCULPT_PATH], journal[2 * ISOSCULPT_PATH];
        struct stat about;
        if (!iso_text_ends_with(entry->d_name, ".strokes.open")) continue;
        int length = snprintf(marker, sizeof marker, "%s/%s", folder, entry->d_name);
        if (length >= ISOSCULPT_PATH) continue;
        snprintf(journal, sizeof journal, "%.*s", length - (int)strlen(OPEN), marker);
        if (stat(journal, &about) || is_held(marker)) continue;
        const struct timespec t = about.st_mtim;
        if (found && (t.tv_sec < newest.tv_sec || (t.tv_sec == newest.tv_sec && t.tv_nsec < newest.tv_nsec)))
            continue;
        found = true;
        newest = t;
        memcpy(path, journal, strlen(journal) + 1);
    }
    closedir(directory);
    return found;
}

/* ---- opening and closing */

/* Takes over the grid. */
static iso_status open_session(isosculpt_document *document, iso_hgrid *grid, const iso_session_opts *how,
                               iso_error *error) {
    iso_session_opts opts = *how;
    opts.pool = document->pool;
    opts.undo_memory = document->undo_memory;
    ISO_TRY(iso_session_create(grid, &document->start, &opts, &document->session, error));
    document->began = iso_clock_seconds();
    document->changes = document->saved = 0;
    return ISO_OK;
}

/* NAME by the time; a number is added when two begin in one second. */
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
        ISO_TRY(join(path, folder, name, error));
        if (access(path, F_OK)) return ISO_OK;
    }
    return iso_fail(error, ISO_ERR_WRITE, "%s: too many journals of this second", folder);
}

/* Takes over the grid, unless it leaves it there because there can be no journal. */
static iso_status new_journal(isosculpt_document *document, const char *folder, iso_hgrid **grid,
                              iso_error *error) {
    if (!folder) return iso_fail(error, ISO_ERR_WRITE, "there is no folder for it");
    ISO_TRY(name_journal(folder, document->journal, error));
    ISO_TRY(mark(document->journal, &document->marker, error));
    const iso_session_opts opts = {.journal = document->journal};
    iso_hgrid *taken = *grid;
    *grid = NULL;
    iso_status status = open_session(document, taken, &opts, error);
    document->surface_isovalue = status == ISO_OK;
    return status;
}

static void unmark(isosculpt_document *document) {
    if (!document->marker) return;
    isosculpt_document_dismiss_recovery(document->journal);
    close(document->marker - 1);
    document->marker = 0;
}

static iso_status make_field(isosculpt_document *document, const isosculpt_source *source, iso_hgrid **grid,
                             iso_error *error) {
    if (source) return isosculpt_source_open(source, &document->start, grid, error);
    const double origin = -0.5 * (BALL_VOXELS - 1) * BALL_VOXEL;
    document->start = (iso_journal_start){.source = "ball",
                                          .voxel_size = BALL_VOXEL,
                                          .dims = {BALL_VOXELS, BALL_VOXELS, BALL_VOXELS},
                                          .origin = {origin, origin, origin},
                                          .radius = BALL_RADIUS};
    return iso_session_ball(&document->start, grid, error);
}

iso_status isosculpt_document_new(isosculpt_document *document, const char *folder,
                                  const isosculpt_source *source, iso_error *error) {
    iso_hgrid *grid;
    iso_error reason = {0};
    ISO_TRY(make_field(document, source, &grid, error));
    isosculpt_target_default(strcmp(document->start.source, "ball") == 0 ? NULL : document->start.source,
                             document->target);
    if (new_journal(document, folder, &grid, &reason) == ISO_OK) return ISO_OK;
    unmark(document);
    document->journal[0] = 0;
    snprintf(document->trouble, sizeof document->trouble, "%s", reason.text);
    if (!grid) ISO_TRY(make_field(document, source, &grid, error)); /* it went with the journal's session */
    return open_session(document, grid, &(iso_session_opts){0}, error);
}

iso_status isosculpt_document_init_empty(isosculpt_document *document, iso_error *error) {
    iso_hgrid *grid;
    const iso_transform *none = NULL;
    document->start =
        (iso_journal_start){.source = "nothing", .voxel_size = 1, .dims = {ISO_BRICK, ISO_BRICK, ISO_BRICK}};
    ISO_TRY(iso_hgrid_create(document->start.dims, 0, none, &grid, error));
    return open_session(document, grid, &(iso_session_opts){0}, error);
}

static iso_status find_field(isosculpt_document *document, const char *journal, const iso_progress *progress,
                             iso_hgrid **grid, iso_error *error) {
    if (strcmp(document->start.source, "ball") == 0) return iso_session_ball(&document->start, grid, error);
    const isosculpt_source how = {.pool = document->pool, .progress = progress};
    return isosculpt_source_find(journal, &how, &document->start, grid, error);
}

/* A stroke file that its user keeps is what the sculpture lies beside. One in the folder of journals was put
 * there by the program: then it is the file that the session began with. */
static void choose_target(isosculpt_document *document, const char *journal) {
    char folder[ISOSCULPT_PATH];
    const char *slash = strrchr(journal, '/');
    const size_t length = slash ? (size_t)(slash - journal) : 0;
    if (isosculpt_document_state_folder(folder, NULL) != ISO_OK) folder[0] = 0;
    if (strlen(folder) == length && strncmp(folder, journal, length) == 0)
        isosculpt_target_default(strcmp(document->start.source, "ball") == 0 ? NULL : document->start.source,
                                 document->target);
    else
        isosculpt_target_beside(journal, document->target);
}

iso_status isosculpt_document_open(isosculpt_document *document, const char *journal,
                                   const iso_progress *progress, iso_error *error) {
    iso_journal_reader *reader;
    ISO_TRY(iso_journal_open(journal, &document->start, &reader, error));
    iso_journal_reader_free(reader);
    ISO_TRY(join(document->journal, journal, "", error));
    const bool marked = is_marked(journal);
    ISO_TRY(mark(journal, &document->marker, error));
    iso_hgrid *grid;
    const iso_progress reading = iso_progress_part(progress, 0, 0.3),
                       playing = iso_progress_part(progress, 0.3, 1);
    const iso_session_opts opts = {.journal = journal, .resume = true, .progress = &playing};
    iso_status status = find_field(document, journal, &reading, &grid, error);
    if (status == ISO_OK) status = open_session(document, grid, &opts, error);
    document->unclosed = marked;
    if (status == ISO_OK) {
        choose_target(document, journal);
        return ISO_OK;
    }
    if (!marked) unmark(document); /* else it stays: what could not be opened was not closed */
    if (document->marker) close(document->marker - 1);
    document->marker = 0;
    document->journal[0] = 0;
    return status;
}

/* A new session in which nothing was done leaves nothing. */
static void remove_empty(const isosculpt_document *document) {
    char path[ISOSCULPT_PATH];
    unlink(document->journal);
    if (join(path, document->journal, UNDO, NULL) == ISO_OK) unlink(path);
}

static void shut(isosculpt_document *document, bool offered) {
    isosculpt_document_saving(document, true, NULL, NULL);
    bool drawn = document->session && iso_session_journal_status(document->session, NULL) == ISO_OK;
    iso_session_destroy(document->session);
    if (drawn && document->surface_isovalue && !document->kept && document->changes == 0)
        remove_empty(document);
    if (drawn && !offered) unmark(document);
    if (document->marker) close(document->marker - 1); /* a journal that lags behind was not closed well */
    *document = (isosculpt_document){.pool = document->pool, .undo_memory = document->undo_memory};
}

void isosculpt_document_close(isosculpt_document *document) {
    shut(document, false);
}

void isosculpt_document_discard(isosculpt_document *document) {
    shut(document, document->unclosed);
}
