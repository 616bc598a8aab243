/* session_support: files and random events for the tests of sessions, which check that nothing is lost. */
#ifndef ISO_TESTS_SESSION_SUPPORT_H
#define ISO_TESTS_SESSION_SUPPORT_H

#include "sculpt/session/session.h"
#include "sculpt_support.h"

/* A session that begins with a ball of radius 20 voxels in a grid of 64^3 voxels of half a millimetre. */
extern const iso_journal_start SESSION_START;

/* The path of a file of this process in the tests' folder. The last four results stay valid. */
const char *session_path(const char *name);
/* Removes a journal and the checkpoints beside it. */
void session_remove_files(const char *journal);

iso_session *session_open(const iso_session_opts *opts);

iso_sample session_random_sample(uint32_t *seed);
/* Of the first so many tools; half of them with a colour if these are all tools. */
iso_brush session_random_brush(uint32_t *seed, int tools);
/* The next of an endless sequence of random events; `drawing` is state of the caller. */
iso_event session_random_event(uint32_t *seed, int tools, bool *drawing);

/* Draws a stroke through places whose normals lead away from the world's origin. */
void session_stroke(iso_session *session, const iso_brush *brush, const iso_vec3 *at, int count);

/* The result of a session: the field, the frozen voxels and the paint. */
typedef struct session_field {
    iso_hgrid *grid;
    iso_field_items items;
} session_field;
session_field session_field_of(iso_session *session);
void session_field_free(session_field *field);
bool session_same_items(const iso_field_items *a, const iso_field_items *b);
/* Whether the session has the same result, bit for bit. */
bool session_is(iso_session *session, const session_field *field);

/* A session with a new journal and without checkpoints, in which `draw` has drawn; *drawn is its result.
 * Fails if that is another one with four threads. */
iso_session *session_drawn(const char *journal, void (*draw)(iso_session *session), session_field *drawn);

#endif
