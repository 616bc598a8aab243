/* Freezes what a volume has in a session that began with it. */
#include "apps/isosculpt/freezing.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

iso_status isosculpt_freezing_parse(const char *text, isosculpt_freezing *freezing, iso_error *error) {
    char *end;
    *freezing = (isosculpt_freezing){.on = true, .labels = strcmp(text, "labels") == 0};
    if (freezing->labels) return ISO_OK;
    freezing->isovalue = strtod(text, &end);
    if (end == text || *end || !isfinite(freezing->isovalue))
        return iso_fail(error, ISO_ERR_USAGE, "'%s' is neither an isovalue nor labels", text);
    return ISO_OK;
}

iso_status isosculpt_freeze(iso_session *session, const char *path, const iso_input *input, int label,
                            const isosculpt_freezing *freezing, iso_pool *pool, iso_error *error) {
    iso_input plain = *input;
    iso_source_volume *volume;
    iso_error reason = {0};
    plain.label = plain.label_table = NULL;
    ISO_TRY(iso_source_volume_read(path, &plain, pool, NULL, &volume, error));
    const iso_grid *grid = &volume->volume.grid;
    const iso_status status = freezing->labels
                                  ? iso_source_freeze_labels(session, grid, label, pool, &reason)
                                  : iso_source_freeze(session, grid, freezing->isovalue, pool, &reason);
    iso_source_volume_free(volume);
    return status == ISO_OK ? ISO_OK : iso_fail(error, status, "%s: --freeze: %s", path, reason.text);
}
