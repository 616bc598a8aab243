/* host: what base/memory.c, base/parallel.c, base/status.c and the system are to a page's engine: the heap of
 * the C library, one thread, no environment, and short messages. */
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include "base/foresee.h"
#include "base/memory.h"
#include "base/parallel.h"

void *iso_alloc(size_t bytes) {
    if (bytes > SIZE_MAX - 2 * ISO_ALIGNMENT) return NULL;
    const size_t rounded = (bytes + ISO_ALIGNMENT - 1) / ISO_ALIGNMENT * ISO_ALIGNMENT;
    return aligned_alloc(ISO_ALIGNMENT, rounded ? rounded : ISO_ALIGNMENT);
}
void *iso_alloc_zero(size_t count, size_t size) {
    return calloc(count ? count : 1, size ? size : 1);
}
void iso_free(void *block) {
    free(block);
}
void iso_memory_trim(void) {}
void iso_advise_huge(void *block, size_t bytes) {
    (void)block, (void)bytes;
}
void iso_advise_order(void *block, size_t bytes, bool random) {
    (void)block, (void)bytes, (void)random;
}
bool iso_size_multiply(size_t a, size_t b, size_t *out) {
    return !__builtin_mul_overflow(a, b, out);
}
size_t iso_foresee_bytes(size_t used, size_t done, size_t total) {
    (void)used, (void)done, (void)total;
    return 0;
}
iso_status iso_buffer_reserve(iso_buffer *buffer, size_t bytes, size_t keep, iso_error *error) {
    if (bytes <= buffer->bytes) return ISO_OK;
    const size_t grown = buffer->bytes + buffer->bytes / 2, wanted = bytes > grown ? bytes : grown;
    void *data = iso_alloc(wanted);
    if (!data) return iso_fail(error, ISO_ERR_NOMEM, "out of memory: %zu bytes refused", wanted);
    if (keep) memcpy(data, buffer->data, keep < buffer->bytes ? keep : buffer->bytes);
    iso_free(buffer->data);
    *buffer = (iso_buffer){data, wanted};
    return ISO_OK;
}
void iso_buffer_free(iso_buffer *buffer) {
    iso_free(buffer->data);
    *buffer = (iso_buffer){0};
}
void iso_copy_stream(void *to, const void *from, size_t bytes) {
    memcpy(to, from, bytes);
}
void iso_copy_stream_end(void) {}

/* A message as far as its first number: printf's ways of writing these are a large part of an engine. */
iso_status iso_fail(iso_error *error, iso_status status, const char *format, ...) {
    va_list arguments;
    if (!error) return status;
    error->status = status;
    char *to = error->text, *const end = to + sizeof error->text - 1;
    va_start(arguments, format);
    for (; *format && to < end && (*format != '%' || format[1] == 's'); format++)
        if (*format != '%') {
            *to++ = *format;
        } else {
            const char *word = va_arg(arguments, const char *);
            while (*word && to < end) *to++ = *word++;
            format++;
        }
    va_end(arguments);
    *to = 0;
    return status;
}

iso_status iso_fail_memory(iso_error *error, const char *name) {
    return iso_fail(error, ISO_ERR_NOMEM, "%s: out of memory", name);
}

int iso_pool_threads(const iso_pool *pool) {
    (void)pool;
    return 1;
}
void iso_parallel_for(iso_pool *pool, size_t count, iso_task *task, void *context) {
    (void)pool;
    for (size_t i = 0; i < count; i++) task(context, i, 0);
}
/* (a worker of the page that is no longer needed is ended as a whole) */
void iso_parallel_until(iso_pool *pool, size_t count, iso_task *task, void *context) {
    iso_parallel_for(pool, count, task, context);
}
bool iso_pool_is_cancelled(const iso_pool *pool) {
    (void)pool;
    return false;
}
bool iso_pool_ask(iso_pool *pool) {
    (void)pool;
    return false;
}
iso_status iso_pool_check(const iso_pool *pool, const char *what, iso_error *error) {
    (void)pool, (void)what, (void)error;
    return ISO_OK;
}
size_t iso_ordered_slots(const iso_pool *pool) {
    (void)pool;
    return 4;
}
void iso_parallel_ordered(iso_pool *pool, size_t count, const iso_ordered *steps, void *context) {
    (void)pool;
    for (size_t i = 0; i < count; i++) {
        steps->work(context, i, 0, 0);
        steps->place(context, 0, true);
        steps->finish(context, 0);
    }
}

/* With these two, nothing of WASI but three functions of stdio is imported, which the page answers. */
char *getenv(const char *name) {
    (void)name;
    return NULL;
}
_Noreturn void abort(void) {
    __builtin_trap();
}
