/* Sessions to work in and events to play, for the tests that lose nothing. */
#ifndef ISO_TESTS_SESSION_SUPPORT_H
#define ISO_TESTS_SESSION_SUPPORT_H

#include "sculpt/session/session.h"
#include "sculpt_support.h"

/* A ball of 20 voxels in 64^3 of half a millimetre. */
extern const iso_journal_start SESSION_START;

/* A file of this process in the tests' folder; the last four stay valid. */
const char *session_path(const char *name);
/* A journal and the snapshots beside it. */
void session_remove_files(const char *journal);

iso_session *session_open(const iso_session_opts *opts);

iso_sample session_random_sample(uint32_t *seed);
iso_brush session_random_brush(uint32_t *seed, int tools); /* of the first so many tools */
/* The next of an endless line of events; `drawing` is the caller's state. */
iso_event session_random_event(uint32_t *seed, int tools, bool *drawing);

/* What a session has made: the field and what is frozen. */
typedef struct session_field {
    iso_hgrid *grid;
    iso_mask mask;
} session_field;
session_field session_field_of(iso_session *session);
void session_field_free(session_field *field);
bool session_same_mask(const iso_mask *a, const iso_mask *b);
/* Whether the session holds that, to the bit. */
bool session_is(iso_session *session, const session_field *field);

#endif
