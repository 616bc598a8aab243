/* Reads bytes from servers by libcurl (a module). Connections are kept for the next requests. */
#include <curl/curl.h>
#include <errno.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <strings.h>
#include <time.h>
#include <unistd.h>

#include "base/file.h"
#include "grids/volume/module.h"
#include "grids/volume/remote/remote.h"

enum { TRIES = 4, IDLE = 16, CONNECT_SECONDS = 20, SILENT_SECONDS = 60, REDIRECTS = 5 };

/* One request, and what came. */
typedef struct request {
    const char *url;
    const iso_remote_part *part;
    iso_buffer *bytes;
    FILE *stream; /* instead of `bytes` */
    size_t count;
    char mark[256]; /* the ETag of the reply */
    bool too_long, out_of_memory, stream_failed;
} request;

/* ---- handles */

static pthread_mutex_t idle_lock = PTHREAD_MUTEX_INITIALIZER;
static CURL *idle[IDLE];
static int idle_count;

static void begin(void) {
    curl_global_init(CURL_GLOBAL_DEFAULT);
}

static CURL *take_handle(void) {
    static pthread_once_t once = PTHREAD_ONCE_INIT;
    CURL *handle = NULL;
    pthread_once(&once, begin);
    pthread_mutex_lock(&idle_lock);
    if (idle_count > 0) handle = idle[--idle_count];
    pthread_mutex_unlock(&idle_lock);
    return handle ? handle : curl_easy_init();
}

static void give_handle(CURL *handle) {
    curl_easy_reset(handle); /* keeps its connections */
    pthread_mutex_lock(&idle_lock);
    const bool kept = idle_count < IDLE;
    if (kept) idle[idle_count++] = handle;
    pthread_mutex_unlock(&idle_lock);
    if (!kept) curl_easy_cleanup(handle);
}

/* ---- a reply */

static size_t take_bytes(char *bytes, size_t one, size_t count, void *context) {
    request *r = context;
    (void)one;
    r->too_long = count > r->part->size - r->count;
    if (r->stream) {
        r->stream_failed = !r->too_long && fwrite(bytes, 1, count, r->stream) != count;
    } else if (!r->too_long) {
        r->out_of_memory = iso_buffer_reserve(r->bytes, r->count + count + 1, r->count, NULL) != ISO_OK;
        if (!r->out_of_memory) memcpy((char *)r->bytes->data + r->count, bytes, count);
    }
    if (r->too_long || r->out_of_memory || r->stream_failed) return 0; /* ends the transfer */
    r->count += count;
    return count;
}

/* Takes the ETag; each reply on the way, such as one that redirects, begins with HTTP/. */
static size_t take_header(char *line, size_t one, size_t count, void *context) {
    static const char name[] = "etag:";
    request *r = context;
    (void)one;
    if (count > 5 && strncasecmp(line, "HTTP/", 5) == 0) *r->mark = 0;
    if (count < sizeof name || strncasecmp(line, name, sizeof name - 1) != 0) return count;
    size_t from = sizeof name - 1, to = count;
    while (from < to && line[from] == ' ') from++;
    while (to > from && (unsigned char)line[to - 1] <= ' ') to--;
    if (to - from < sizeof r->mark && line[from] != 'W') { /* (W/: of the same meaning, not the same bytes) */
        memcpy(r->mark, line + from, to - from);
        r->mark[to - from] = 0;
    }
    return count;
}

/* One request. *code: the server's answer, or 0. */
static CURLcode perform(CURL *handle, request *r, const char *kept_mark, long *code) {
    char range[64], condition[300];
    struct curl_slist *headers = NULL;
    r->count = 0;
    *r->mark = 0;
    r->too_long = r->out_of_memory = r->stream_failed = false;
    if (r->stream && (fflush(r->stream) || ftruncate(fileno(r->stream), 0))) clearerr(r->stream);
    if (r->stream) rewind(r->stream);
    *code = 0;
    if (*kept_mark) {
        snprintf(condition, sizeof condition, "If-None-Match: %s", kept_mark);
        headers = curl_slist_append(NULL, condition);
    }
    curl_easy_setopt(handle, CURLOPT_URL, r->url);
    curl_easy_setopt(handle, CURLOPT_HTTPHEADER, headers);
    curl_easy_setopt(handle, CURLOPT_USERAGENT, "isopoint/" ISO_VERSION);
    curl_easy_setopt(handle, CURLOPT_PROTOCOLS_STR, "http,https");
    curl_easy_setopt(handle, CURLOPT_REDIR_PROTOCOLS_STR,
                     strncmp(r->url, "https", 5) == 0 ? "https" : "http,https");
    curl_easy_setopt(handle, CURLOPT_FOLLOWLOCATION, 1L);
    curl_easy_setopt(handle, CURLOPT_MAXREDIRS, (long)REDIRECTS);
    curl_easy_setopt(handle, CURLOPT_NOSIGNAL, 1L);
    curl_easy_setopt(handle, CURLOPT_CONNECTTIMEOUT, (long)CONNECT_SECONDS);
    curl_easy_setopt(handle, CURLOPT_LOW_SPEED_LIMIT, 1L);
    curl_easy_setopt(handle, CURLOPT_LOW_SPEED_TIME, (long)SILENT_SECONDS);
    curl_easy_setopt(handle, CURLOPT_FAILONERROR, 1L); /* the text of an error page is not wanted */
    curl_easy_setopt(handle, CURLOPT_WRITEFUNCTION, take_bytes);
    curl_easy_setopt(handle, CURLOPT_WRITEDATA, r);
    curl_easy_setopt(handle, CURLOPT_HEADERFUNCTION, take_header);
    curl_easy_setopt(handle, CURLOPT_HEADERDATA, r);
    const bool in_parts = r->part->what >= ISO_REMOTE_BYTES;
    if (in_parts && r->part->what == ISO_REMOTE_BYTES)
        snprintf(range, sizeof range, "%llu-%llu", (unsigned long long)r->part->offset,
                 (unsigned long long)(r->part->offset + r->part->size - 1));
    else if (in_parts)
        snprintf(range, sizeof range, "-%llu", (unsigned long long)r->part->size);
    if (in_parts) curl_easy_setopt(handle, CURLOPT_RANGE, range);
    const CURLcode result = curl_easy_perform(handle);
    curl_easy_getinfo(handle, CURLINFO_RESPONSE_CODE, code);
    curl_slist_free_all(headers);
    return result;
}

/* Whether a request may succeed when it is made again: the server is busy, or the connection broke. */
static bool may_succeed(CURLcode result, long code) {
    if (result == CURLE_HTTP_RETURNED_ERROR) return code == 429 || code == 408 || code >= 500;
    return result == CURLE_PARTIAL_FILE || result == CURLE_RECV_ERROR || result == CURLE_SEND_ERROR ||
           result == CURLE_GOT_NOTHING || result == CURLE_HTTP2;
}

/* What went wrong, if anything. */
static iso_status judge(const request *r, CURLcode result, long code, iso_error *error) {
    if (r->out_of_memory) return iso_fail_memory(error, r->url);
    const bool in_parts = r->part->what >= ISO_REMOTE_BYTES;
    if (in_parts && code == 200)
        return iso_fail(error, ISO_ERR_IO, "%s: its server does not send parts of files: copy it here",
                        r->url);
    if (r->too_long)
        return iso_fail(error, ISO_ERR_LIMIT, "%s: has more than %llu bytes", r->url,
                        (unsigned long long)r->part->size);
    if (result == CURLE_HTTP_RETURNED_ERROR)
        return iso_fail(error, ISO_ERR_IO, "%s: cannot be read: the server answers %ld", r->url, code);
    if (result != CURLE_OK)
        return iso_fail(error, ISO_ERR_IO, "%s: cannot be read: %s", r->url, curl_easy_strerror(result));
    if (in_parts && r->count != r->part->size)
        return iso_fail(error, ISO_ERR_IO, "%s: %zu bytes came where %llu were wanted", r->url, r->count,
                        (unsigned long long)r->part->size);
    return ISO_OK;
}

/* Makes a request, again if that may help. */
static CURLcode ask(CURL *handle, request *r, const char *kept_mark, long *code) {
    CURLcode result = CURLE_OK;
    for (int i = 0; i < TRIES; i++) {
        const struct timespec pause = {i > 2, i > 2 ? 0 : 125000000L << i}; /* .25, .5 and 1 s */
        if (i > 0) nanosleep(&pause, NULL);
        result = perform(handle, r, kept_mark, code);
        if (!may_succeed(result, *code)) break;
    }
    return result;
}

/* ---- what servers have just said: readers ask for metadata, and open files, several times */

enum { SAID = 64, SECONDS_FRESH = 10 };

/* A reply of the last seconds. */
typedef struct reply {
    char *url;    /* owned; NULL: none */
    bool is_file; /* whose copy is in the cache as the server has it; else metadata: */
    bool absent;
    char *bytes; /* owned */
    size_t count;
    time_t when;
} reply;

static pthread_mutex_t said_lock = PTHREAD_MUTEX_INITIALIZER;
static reply said[SAID];

static time_t seconds_now(void) {
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return now.tv_sec;
}

/* Whether a server has just said what is asked; of metadata it is copied. */
static bool was_said(const char *url, bool is_file, iso_buffer *bytes, size_t *count, bool *absent) {
    bool was = false;
    pthread_mutex_lock(&said_lock);
    for (const reply *r = said; r < said + SAID && !was; r++) {
        if (!r->url || r->is_file != is_file || strcmp(r->url, url) != 0 ||
            seconds_now() - r->when >= SECONDS_FRESH)
            continue;
        was = is_file || iso_buffer_reserve(bytes, r->count + 1, 0, NULL) == ISO_OK;
        if (is_file || !was) continue;
        if (r->count) memcpy(bytes->data, r->bytes, r->count);
        *count = r->count;
        *absent = r->absent;
    }
    pthread_mutex_unlock(&said_lock);
    return was;
}

/* Keeps a reply in the place of the oldest one; or does not, where there is no memory. */
static void keep_reply(const char *url, bool is_file, const void *bytes, size_t count, bool absent) {
    reply made = {strdup(url), is_file, absent, malloc(count + 1), count, seconds_now()};
    if (made.bytes && count) memcpy(made.bytes, bytes, count);
    pthread_mutex_lock(&said_lock);
    reply *oldest = said;
    for (reply *r = said; r < said + SAID; r++)
        if (!r->url || (oldest->url && r->when < oldest->when)) oldest = r;
    if (made.url && made.bytes) {
        const reply before = *oldest;
        *oldest = made;
        made = before;
    }
    pthread_mutex_unlock(&said_lock);
    free(made.url);
    free(made.bytes);
}

static iso_status remote_read(const char *url, const iso_remote_part *part, iso_buffer *bytes, size_t *count,
                              bool *absent, iso_error *error) {
    iso_remote_entry kept = {.count = 0};
    request r = {.url = url, .part = part, .bytes = bytes};
    const bool is_metadata = part->what == ISO_REMOTE_METADATA;
    long code;
    if (is_metadata && was_said(url, false, bytes, count, absent)) return ISO_OK;
    CURL *handle = take_handle();
    if (!handle) return iso_fail_memory(error, url);
    if (!is_metadata) iso_remote_cache_find(url, part, &kept);
    const CURLcode result = ask(handle, &r, kept.mark, &code);
    give_handle(handle);
    *absent = code == 404 || code == 410 || (code == 403 && is_metadata);
    const iso_status status = *absent || code == 304 ? ISO_OK : judge(&r, result, code, error);
    *count = r.count;
    if (status == ISO_OK && code == 304) { /* as it is in the cache */
        iso_buffer_free(bytes);
        *bytes = kept.bytes;
        *count = kept.count;
        return ISO_OK;
    }
    iso_buffer_free(&kept.bytes);
    if (status == ISO_OK && is_metadata) {
        keep_reply(url, false, bytes->data, *absent ? 0 : r.count, *absent);
    } else if (status == ISO_OK && !*absent) {
        iso_remote_entry made = {.bytes = *bytes, .count = r.count};
        memcpy(made.mark, r.mark, sizeof made.mark);
        iso_remote_cache_keep(url, part, &made);
    }
    return status;
}

/* ---- whole files */

/* Asks for a file, which comes into `sink`, unless it is the copy. */
static iso_status ask_for_file(const char *url, uint64_t most, const iso_remote_copy *copy, iso_sink *sink,
                               iso_error *error) {
    const iso_remote_part part = {.what = ISO_REMOTE_WHOLE, .size = most};
    request r = {.url = url, .part = &part, .stream = sink->stream};
    long code;
    CURL *handle = take_handle();
    if (!handle) return iso_fail_memory(error, url);
    const CURLcode result = ask(handle, &r, copy->mark, &code);
    give_handle(handle);
    if (result == CURLE_OK && code == 304) return ISO_OK;
    if (r.stream_failed)
        return iso_fail(error, ISO_ERR_WRITE, "%s: cannot be copied to %s: %s", url, copy->path,
                        strerror(errno));
    ISO_TRY(judge(&r, result, code, error));
    ISO_TRY(iso_sink_commit(sink, error));
    iso_remote_copy_keep(url, copy, r.mark);
    return ISO_OK;
}

static iso_status remote_fetch(const char *url, uint64_t most, char path[PATH_MAX], iso_error *error) {
    iso_remote_copy copy;
    iso_sink sink = {0};
    if (!iso_remote_copy_find(url, &copy))
        return iso_fail(error, ISO_ERR_IO,
                        "%s: files of servers are copied to a cache, which there is none of (XDG_CACHE_HOME, "
                        "ISO_REMOTE_CACHE): copy it here (curl -O)",
                        url);
    if (!copy.is_there || !was_said(url, true, NULL, NULL, NULL)) {
        ISO_TRY(iso_sink_open(copy.path, &sink, error));
        const iso_status status = ask_for_file(url, most, &copy, &sink, error);
        iso_sink_abort(&sink);
        ISO_TRY(status);
        keep_reply(url, true, NULL, 0, false);
    }
    memcpy(path, copy.path, sizeof copy.path);
    return ISO_OK;
}

static const iso_remote remote = {remote_read, remote_fetch};

ISO_MODULE_EXTERN const iso_module iso_module_table;
const iso_module iso_module_table = {.abi = ISO_MODULE_ABI, .version = ISO_VERSION, .remote = &remote};
