/* Videos: ffmpeg reads pictures from a socket, and writes to the nameless file of a sink. */
#include "image/video.h"

#include <errno.h>
#include <signal.h>
#include <spawn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/file.h"
#include "base/file_types.h"
#include "base/memory.h"

extern char **environ;

/* The sink's file without a name, as ffmpeg's descriptor 3. */
#define OUR_FILE "/proc/self/fd/3"

typedef enum video_kind { NO_VIDEO, MP4, WEBM, GIF, APNG } video_kind;

/* Colours are those of HDTV. Every picture of a GIF has a palette of its own, whose dither does not move. */
#define TO_YUV "scale=out_color_matrix=bt709:out_range=tv:flags=accurate_rnd+full_chroma_int"
#define AS_HDTV "-colorspace", "bt709", "-color_primaries", "bt709", "-color_trc", "bt709"
static const char *const encoders[][22] = {
    [MP4] = {"-vf", TO_YUV ",format=yuv420p", "-c:v", "libx264", "-preset", "superfast", "-x264-params",
             "mbtree=1:rc-lookahead=10", "-crf", "17", AS_HDTV, "-movflags", "+faststart", "-f", "mp4", NULL},
    [WEBM] = {"-vf", TO_YUV ",format=yuv420p", "-c:v", "libvpx-vp9", "-crf", "22", "-b:v", "0", "-cpu-used",
              "5", AS_HDTV, "-f", "webm", NULL},
    [GIF] =
        {"-filter_complex",
         "split[a][b];[a]palettegen=stats_mode=single[p];[b][p]paletteuse=new=1:dither=bayer:bayer_scale=3",
         "-loop", "0", "-f", "gif", NULL},
    [APNG] = {"-c:v", "apng", "-pred", "mixed", "-plays", "0", "-f", "apng", NULL}};

struct iso_video {
    char *path; /* as it is given, for messages */
    iso_sink sink;
    size_t bytes; /* of a picture */
    pid_t child;  /* 0: none */
    int frames;   /* our end of the socket; below 0: closed */
    int said;     /* what ffmpeg says, a file in memory */
    int ended;    /* how ffmpeg ended, as waitpid tells it */
};

static video_kind kind_of(const char *path) {
    switch (iso_file_type_of_name(path, ISO_WRITES_VIDEO)) {
#define WRITE_VIDEO(kind) return kind;
#include "base/file_types.inc"
    default:
        break;
    }
    return NO_VIDEO;
}

bool iso_video_is_name(const char *path) {
    return kind_of(path) != NO_VIDEO;
}

/* Whether a program of this name is in a folder of PATH. */
static bool is_installed(const char *program) {
    char path[4096];
    const char *folder = getenv("PATH");
    for (size_t length; folder && *folder; folder += length + (folder[length] == ':')) {
        length = strcspn(folder, ":");
        const int size =
            snprintf(path, sizeof path, "%.*s%s%s", (int)length, folder, length ? "/" : "", program);
        if (size > 0 && (size_t)size < sizeof path && access(path, X_OK) == 0) return true;
    }
    return false;
}

static iso_status fail_missing(const char *path, iso_error *error) {
    return iso_fail(error, ISO_ERR_BACKEND,
                    "%s: videos are encoded by ffmpeg, which is not there (Debian's package is ffmpeg)",
                    path);
}

iso_status iso_video_check(const char *path, const iso_video_opts *opts, iso_error *error) {
    const video_kind kind = kind_of(path);
    const int width = opts->width, height = opts->height;
    if ((kind == MP4 || kind == WEBM) && (width % 2 || height % 2))
        return iso_fail(error, ISO_ERR_USAGE,
                        "%s: the sides of such a video are even numbers of pixels: --resolution %dx%d", path,
                        width + width % 2, height + height % 2);
    if (opts->transparent && (kind == MP4 || kind == GIF))
        return iso_fail(error, ISO_ERR_USAGE, "%s: such a video has no transparency: .apng and .webm have",
                        path);
    return is_installed("ffmpeg") ? ISO_OK : fail_missing(path, error);
}

/* The arguments of ffmpeg, which end with NULL. */
typedef struct arguments {
    const char *words[64];
    int count;
    char size[32], rate[32], title[512], text[4096];
} arguments;

static void add(arguments *a, const char *const *words) {
    while (*words) a->words[a->count++] = *words++;
}

static void list_arguments(const iso_video *video, const iso_video_opts *opts, arguments *a) {
    static const char *const transparent[] = {"-pix_fmt", "yuva420p", NULL};
    const video_kind kind = kind_of(video->path);
    const char *file = video->sink.temporary ? video->sink.temporary : video->sink.target;
    a->count = 0;
    snprintf(a->size, sizeof a->size, "%dx%d", opts->width, opts->height);
    snprintf(a->rate, sizeof a->rate, "%.9g", opts->frame_rate);
    snprintf(a->title, sizeof a->title, "title=%s", opts->title ? opts->title : "");
    snprintf(a->text, sizeof a->text, "comment=%s", opts->text ? opts->text : "");
    add(a, (const char *const[]){"ffmpeg",    "-hide_banner", "-nostdin",  "-loglevel",  "error",
                                 "-xerror",   "-y",           "-f",        "rawvideo",   "-pixel_format",
                                 "rgba",      "-video_size",  a->size,     "-framerate", a->rate,
                                 "-i",        "pipe:0",       "-threads",  "4",          "-fflags",
                                 "+bitexact", "-flags:v",     "+bitexact", NULL});
    if (opts->title) add(a, (const char *const[]){"-metadata", a->title, NULL});
    if (opts->text) add(a, (const char *const[]){"-metadata", a->text, NULL});
    if (kind == APNG) add(a, (const char *const[]){"-pix_fmt", opts->transparent ? "rgba" : "rgb24", NULL});
    add(a, encoders[kind] + (kind == WEBM && opts->transparent ? 2 : 0));
    if (kind == WEBM && opts->transparent) add(a, transparent);
    add(a, (const char *const[]){*file ? file : OUR_FILE, NULL});
    a->words[a->count] = NULL;
}

/* Starts ffmpeg: 0 is the socket, 2 the file in memory, 3 the sink's file. Returns an errno. */
static int start(iso_video *video, const iso_video_opts *opts, int socket) {
    arguments *a = iso_alloc(sizeof *a);
    posix_spawn_file_actions_t files;
    if (!a) return ENOMEM;
    list_arguments(video, opts, a);
    int code = posix_spawn_file_actions_init(&files);
    if (!code) {
        const int sink = fileno(video->sink.stream);
        posix_spawn_file_actions_adddup2(&files, socket, STDIN_FILENO);
        posix_spawn_file_actions_adddup2(&files, video->said, STDOUT_FILENO);
        posix_spawn_file_actions_adddup2(&files, video->said, STDERR_FILENO);
        posix_spawn_file_actions_adddup2(&files, sink, STDERR_FILENO + 1);
        code = posix_spawnp(&video->child, "ffmpeg", &files, NULL, (char *const *)a->words, environ);
        if (code) video->child = 0;
        posix_spawn_file_actions_destroy(&files);
    }
    iso_free(a);
    return code;
}

static iso_status open_video(iso_video *video, const iso_video_opts *opts, iso_error *error) {
    int ends[2];
    ISO_TRY(iso_sink_open(video->path, &video->sink, error));
    video->said = memfd_create("ffmpeg", MFD_CLOEXEC);
    int code = video->said < 0 || socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0 ? errno : 0;
    if (!code) {
        video->frames = ends[0];
        code = start(video, opts, ends[1]);
        close(ends[1]);
    }
    if (code == ENOENT) return fail_missing(video->path, error);
    return code ? iso_fail(error, code == ENOMEM ? ISO_ERR_NOMEM : ISO_ERR_WRITE,
                           "%s: cannot start ffmpeg: %s", video->path, strerror(code))
                : ISO_OK;
}

iso_status iso_video_open(const char *path, const iso_video_opts *opts, iso_video **video, iso_error *error) {
    ISO_TRY(iso_video_check(path, opts, error));
    iso_video *made = iso_alloc_zero(1, sizeof *made);
    if (!made) return iso_fail_memory(error, path);
    made->frames = made->said = -1;
    made->bytes = (size_t)opts->width * (size_t)opts->height * 4;
    made->path = strdup(path);
    const iso_status status = made->path ? open_video(made, opts, error) : iso_fail_memory(error, path);
    if (status == ISO_OK)
        *video = made;
    else
        iso_video_abort(made);
    return status;
}

/* Closes the socket and waits for ffmpeg. Returns whether it has written everything: it said nothing. */
static bool finish(iso_video *video) {
    if (video->frames >= 0) close(video->frames);
    video->frames = -1;
    if (!video->child) return false;
    while (waitpid(video->child, &video->ended, 0) < 0 && errno == EINTR) {
    }
    video->child = 0;
    return video->ended == 0 && lseek(video->said, 0, SEEK_END) == 0;
}

/* The first line of what ffmpeg said, without the part of it that is speaking, "[mp4 @ 0x5581]", and without
 * its name of our file; how it ended if it said nothing. */
static iso_status fail_ended(iso_video *video, iso_error *error) {
    char text[1024];
    finish(video);
    const ssize_t length = pread(video->said, text, sizeof text - 1, 0);
    text[length > 0 ? length : 0] = 0;
    text[strcspn(text, "\n")] = 0;
    const char *bracket = text[0] == '[' ? strstr(text, "] ") : NULL, *said = bracket ? bracket + 2 : text;
    static const char OWN[] = " of " OUR_FILE;
    char *own = strstr(text, OWN);
    if (own) memmove(own, own + sizeof OWN - 1, strlen(own + sizeof OWN - 1) + 1);
    const bool unknown = strstr(said, "Unknown encoder") != NULL;
    if (!*said && WIFSIGNALED(video->ended)) {
        const int number = WTERMSIG(video->ended);
        snprintf(text, sizeof text, "it was ended by signal %d (%s)", number, strsignal(number));
        said = text;
    }
    return iso_fail(error, unknown ? ISO_ERR_BACKEND : ISO_ERR_WRITE, "%s: cannot write: ffmpeg: %s",
                    video->path, *said ? said : "it ended too early");
}

iso_status iso_video_add(iso_video *video, const iso_image *image, iso_error *error) {
    const uint8_t *at = image->rgba;
    for (size_t left = video->bytes; left;) {
        const ssize_t now = send(video->frames, at, left, MSG_NOSIGNAL);
        if (now < 0 && errno == EINTR) continue;
        if (now <= 0) return fail_ended(video, error);
        at += now;
        left -= (size_t)now;
    }
    return ISO_OK;
}

iso_status iso_video_commit(iso_video *video, iso_error *error) {
    const iso_status status = finish(video) ? iso_sink_commit(&video->sink, error) : fail_ended(video, error);
    iso_video_abort(video);
    return status;
}

void iso_video_abort(iso_video *video) {
    if (!video) return;
    if (video->child) kill(video->child, SIGKILL);
    finish(video);
    if (video->said >= 0) close(video->said);
    iso_sink_abort(&video->sink);
    free(video->path);
    iso_free(video);
}
