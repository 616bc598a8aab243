#define _DEFAULT_SOURCE /* flock */
#include "apps/isosculpt/desk.h"

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

static const char STROKES[] = ".strokes", OPEN[] = ".open", UNDO[] = ".undo";

/* The new ball: half the side of its grid. */
enum { BALL_VOXELS = 384 };
static const double BALL_VOXEL = 0.5, BALL_RADIUS = 40;

double isosculpt_now(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static iso_status join(char out[ISOSCULPT_PATH], const char *a, const char *b, iso_error *error) {
    size_t first = strlen(a), second = strlen(b);
    if (first + second >= ISOSCULPT_PATH)
        return iso_fail(error, ISO_ERR_WRITE, "%s: the name is too long", a);
    memmove(out, a, first);
    memcpy(out + first, b, second + 1);
    return ISO_OK;
}

static bool ends_with(const char *text, const char *suffix) {
    size_t length = strlen(text), tail = strlen(suffix);
    return length > tail && strcmp(text + length - tail, suffix) == 0;
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

iso_status isosculpt_desk_folder(char folder[ISOSCULPT_PATH], iso_error *error) {
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

void isosculpt_desk_dismiss(const char *journal) {
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
    bool held = file < 0 || flock(file, LOCK_EX | LOCK_NB) != 0;
    if (file >= 0) close(file);
    return held;
}

bool isosculpt_desk_unclosed(const char *folder, char path[ISOSCULPT_PATH]) {
    DIR *directory = opendir(folder);
    if (!directory) return false;
    struct timespec newest = {0};
    bool found = false;
    for (struct dirent *entry; (entry = readdir(directory));) {
        char marker[2 * ISOSCULPT_PATH], journal[2 * ISOSCULPT_PATH];
        struct stat about;
        if (!ends_with(entry->d_name, ".strokes.open")) continue;
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
static iso_status open_session(isosculpt_desk *desk, iso_hgrid *grid, const iso_session_opts *how,
                               iso_error *error) {
    iso_session_opts opts = *how;
    opts.pool = desk->pool;
    opts.undo_memory = desk->undo_memory;
    ISO_TRY(iso_session_create(grid, &desk->start, &opts, &desk->session, error));
    desk->began = isosculpt_now();
    desk->changes = desk->saved = 0;
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
static iso_status new_journal(isosculpt_desk *desk, const char *folder, iso_hgrid **grid, iso_error *error) {
    if (!folder) return iso_fail(error, ISO_ERR_WRITE, "there is no folder for it");
    ISO_TRY(name_journal(folder, desk->journal, error));
    ISO_TRY(mark(desk->journal, &desk->marker, error));
    const iso_session_opts opts = {.journal = desk->journal};
    iso_hgrid *taken = *grid;
    *grid = NULL;
    iso_status status = open_session(desk, taken, &opts, error);
    desk->made = status == ISO_OK;
    return status;
}

static void unmark(isosculpt_desk *desk) {
    if (!desk->marker) return;
    isosculpt_desk_dismiss(desk->journal);
    close(desk->marker - 1);
    desk->marker = 0;
}

static iso_status make_field(isosculpt_desk *desk, const isosculpt_source *source, iso_hgrid **grid,
                             iso_error *error) {
    if (source) return isosculpt_source_open(source, &desk->start, grid, error);
    const double origin = -0.5 * (BALL_VOXELS - 1) * BALL_VOXEL;
    desk->start = (iso_journal_start){.source = "ball",
                                      .voxel_size = BALL_VOXEL,
                                      .dims = {BALL_VOXELS, BALL_VOXELS, BALL_VOXELS},
                                      .origin = {origin, origin, origin},
                                      .radius = BALL_RADIUS};
    return iso_session_ball(&desk->start, grid, error);
}

iso_status isosculpt_desk_new(isosculpt_desk *desk, const char *folder, const isosculpt_source *source,
                              iso_error *error) {
    iso_hgrid *grid;
    iso_error reason = {0};
    ISO_TRY(make_field(desk, source, &grid, error));
    isosculpt_target_default(strcmp(desk->start.source, "ball") == 0 ? NULL : desk->start.source,
                             desk->target);
    if (new_journal(desk, folder, &grid, &reason) == ISO_OK) return ISO_OK;
    unmark(desk);
    desk->journal[0] = 0;
    snprintf(desk->trouble, sizeof desk->trouble, "%s", reason.text);
    if (!grid) ISO_TRY(make_field(desk, source, &grid, error)); /* it went with the journal's session */
    return open_session(desk, grid, &(iso_session_opts){0}, error);
}

iso_status isosculpt_desk_blank(isosculpt_desk *desk, iso_error *error) {
    iso_hgrid *grid;
    const iso_transform *none = NULL;
    desk->start =
        (iso_journal_start){.source = "nothing", .voxel_size = 1, .dims = {ISO_BRICK, ISO_BRICK, ISO_BRICK}};
    ISO_TRY(iso_hgrid_create(desk->start.dims, 0, none, &grid, error));
    return open_session(desk, grid, &(iso_session_opts){0}, error);
}

static iso_status find_field(isosculpt_desk *desk, const char *journal, const iso_progress *progress,
                             iso_hgrid **grid, iso_error *error) {
    if (strcmp(desk->start.source, "ball") == 0) return iso_session_ball(&desk->start, grid, error);
    const isosculpt_source how = {.pool = desk->pool, .progress = progress};
    return isosculpt_source_find(journal, &how, &desk->start, grid, error);
}

/* A stroke file that its user keeps is what the sculpture lies beside. One in the folder of journals was put
 * there by the program: then it is the file that the session began with. */
static void choose_target(isosculpt_desk *desk, const char *journal) {
    char folder[ISOSCULPT_PATH];
    const char *slash = strrchr(journal, '/');
    const size_t length = slash ? (size_t)(slash - journal) : 0;
    if (isosculpt_desk_folder(folder, NULL) != ISO_OK) folder[0] = 0;
    if (strlen(folder) == length && strncmp(folder, journal, length) == 0)
        isosculpt_target_default(strcmp(desk->start.source, "ball") == 0 ? NULL : desk->start.source,
                                 desk->target);
    else
        isosculpt_target_beside(journal, desk->target);
}

iso_status isosculpt_desk_open(isosculpt_desk *desk, const char *journal, const iso_progress *progress,
                               iso_error *error) {
    iso_journal_reader *reader;
    ISO_TRY(iso_journal_open(journal, &desk->start, &reader, error));
    iso_journal_reader_free(reader);
    ISO_TRY(join(desk->journal, journal, "", error));
    const bool marked = is_marked(journal);
    ISO_TRY(mark(journal, &desk->marker, error));
    iso_hgrid *grid;
    const iso_progress reading = iso_progress_part(progress, 0, 0.3),
                       playing = iso_progress_part(progress, 0.3, 1);
    const iso_session_opts opts = {.journal = journal, .resume = true, .progress = &playing};
    iso_status status = find_field(desk, journal, &reading, &grid, error);
    if (status == ISO_OK) status = open_session(desk, grid, &opts, error);
    desk->unclosed = marked;
    if (status == ISO_OK) {
        choose_target(desk, journal);
        return ISO_OK;
    }
    if (!marked) unmark(desk); /* else it stays: what could not be opened was not closed */
    if (desk->marker) close(desk->marker - 1);
    desk->marker = 0;
    desk->journal[0] = 0;
    return status;
}

/* A new session in which nothing was done leaves nothing. */
static void remove_empty(const isosculpt_desk *desk) {
    char path[ISOSCULPT_PATH];
    unlink(desk->journal);
    if (join(path, desk->journal, UNDO, NULL) == ISO_OK) unlink(path);
}

static void shut(isosculpt_desk *desk, bool offered) {
    isosculpt_desk_saving(desk, true, NULL, NULL);
    bool drawn = desk->session && iso_session_journal_status(desk->session, NULL) == ISO_OK;
    iso_session_destroy(desk->session);
    if (drawn && desk->made && !desk->kept && desk->changes == 0) remove_empty(desk);
    if (drawn && !offered) unmark(desk);
    if (desk->marker) close(desk->marker - 1); /* a journal that lags behind was not closed well */
    *desk = (isosculpt_desk){.pool = desk->pool, .undo_memory = desk->undo_memory};
}

void isosculpt_desk_close(isosculpt_desk *desk) {
    shut(desk, false);
}

void isosculpt_desk_drop(isosculpt_desk *desk) {
    shut(desk, desk->unclosed);
}
