/* freezing: --freeze: what of a volume is frozen before the first stroke. */
#ifndef ISO_APPS_ISOSCULPT_FREEZING_H
#define ISO_APPS_ISOSCULPT_FREEZING_H

#include "source/source.h"

/* The solid at an isovalue, or all other labels than the one that the session began with. */
typedef struct isosculpt_freezing {
    bool on, labels;
    double isovalue; /* physical; for labels it is not used */
} isosculpt_freezing;

/* Reads an isovalue, or "labels". ISO_ERR_USAGE. */
iso_status isosculpt_freezing_parse(const char *text, isosculpt_freezing *freezing, iso_error *error);

/* Reads the volume once more and freezes that, as the session's first stroke. `input`: how it is read,
 * borrowed; label: the session's, or 0. Errors of reading it and of iso_source_freeze, with the path. */
iso_status isosculpt_freeze(iso_session *session, const char *path, const iso_input *input, int label,
                            const isosculpt_freezing *freezing, iso_pool *pool, iso_error *error);

#endif
