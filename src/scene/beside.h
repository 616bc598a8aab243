/* beside: detects files whose box lies beside everything else, and writes a note. Most files of lines and
 * glyphs do not state the axes of their coordinates, so they may have been read mirrored. */
#ifndef ISO_SCENE_BESIDE_H
#define ISO_SCENE_BESIDE_H

#include "io/common/read_opts.h"

enum { ISO_BESIDE_TEXT = 1024 };

/* Returns whether `box`, of the file `path` that was read as `space`, lies beside `rest`; if so, writes a
 * note with both boxes. The note suggests the other space, unless `space` is ISO_SPACE_FILE, that is, the
 * file states its axes. Nothing lies beside an empty `rest`. */
bool iso_beside_note(const char *path, const iso_box *box, const iso_box *rest, iso_space space,
                     char text[ISO_BESIDE_TEXT]);

#endif
