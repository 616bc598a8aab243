/* beside: a note about files whose box lies beside everything else. Most files of lines and glyphs do not say
 * which axes they have, so that they may be mirrored. */
#ifndef ISO_APPS_COMMON_BESIDE_H
#define ISO_APPS_COMMON_BESIDE_H

#include "base/geometry.h"
#include "io/read_opts.h"

#ifdef __cplusplus
extern "C" {
#endif

enum { ISO_BESIDE_TEXT = 1024 };

/* Whether `box`, of the file `path` that was read as `space`, lies beside `rest`; then writes a note of both
 * boxes, which asks for the other space unless `space` is ISO_SPACE_FILE: the file states its axes. An empty
 * `rest` has nothing beside it. */
bool iso_beside_note(const char *path, const iso_box *box, const iso_box *rest, iso_space space,
                     char text[ISO_BESIDE_TEXT]);

#ifdef __cplusplus
}
#endif
#endif
