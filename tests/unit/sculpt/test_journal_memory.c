/* A journal whose disk is full and whose memory is used up at once: no line is lost. The linker's --wrap
 * replaces write and malloc; the writing thread's first write after arming fails, and more lines are put
 * during it. */
#include <errno.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

#include "session_support.h"

static iso_journal *journal;
static atomic_bool armed, without_memory, failed;

static void put_stroke(double x) {
    iso_event event;
    memset(&event, 0, sizeof event);
    event.kind = ISO_EVENT_BEGIN;
    event.brush = (iso_brush){.tool = ISO_TOOL_ADD, .radius = 2, .strength = 1};
    event.sample = (iso_sample){.position = {x, 0, 10}, .normal = {0, 0, 1}, .pressure = 1};
    assert_int_equal(iso_journal_put(journal, &event, NULL), ISO_OK);
    event.kind = ISO_EVENT_END;
    assert_int_equal(iso_journal_put(journal, &event, NULL), ISO_OK);
}

void *__real_malloc(size_t bytes);
void *__wrap_malloc(size_t bytes);
void *__wrap_malloc(size_t bytes) {
    return atomic_load(&without_memory) ? NULL : __real_malloc(bytes);
}

ssize_t __real_write(int file, const void *bytes, size_t count);
ssize_t __wrap_write(int file, const void *bytes, size_t count);
ssize_t __wrap_write(int file, const void *bytes, size_t count) {
    if (!atomic_exchange(&armed, false)) {
        atomic_store(&without_memory, false);
        return __real_write(file, bytes, count);
    }
    put_stroke(2); /* as the program does while the thread writes */
    atomic_store(&without_memory, true);
    atomic_store(&failed, true);
    errno = ENOSPC;
    return -1;
}

static void no_line_is_lost(void **state) {
    (void)state;
    const char *path = session_path("memory.strokes");
    unlink(path);
    assert_int_equal(iso_journal_create(path, &SESSION_START, &journal, NULL), ISO_OK);
    atomic_store(&armed, true);
    put_stroke(1);
    while (!atomic_load(&failed)) usleep(1000);
    assert_int_equal(iso_journal_sync(journal, NULL), ISO_OK); /* the disk has room again */
    assert_int_equal(iso_journal_count(journal), 4);
    assert_int_equal(iso_journal_close(journal, NULL), ISO_OK);
    iso_journal_start start;
    iso_journal_reader *reader;
    assert_int_equal(iso_journal_open(path, &start, &reader, NULL), ISO_OK);
    iso_event event;
    bool more = true;
    int events = 0;
    for (;; events++) {
        assert_int_equal(iso_journal_next(reader, &event, &more, NULL), ISO_OK);
        if (!more) break;
        if (event.kind == ISO_EVENT_BEGIN) assert_true(event.sample.position.x == 1 + events / 2);
    }
    assert_int_equal(events, 4);
    iso_journal_reader_free(reader);
    unlink(path);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(no_line_is_lost)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
