/* beside: compares boxes and writes the note about a file that lies beside the others. */
#include "scene/beside.h"

#include <stdio.h>

#include "base/geometry.h"

static bool overlap(const iso_box *a, const iso_box *b) {
    return a->lo.x <= b->hi.x && b->lo.x <= a->hi.x && a->lo.y <= b->hi.y && b->lo.y <= a->hi.y &&
           a->lo.z <= b->hi.z && b->lo.z <= a->hi.z;
}

bool iso_beside_note(const char *path, const iso_box *box, const iso_box *rest, iso_space space,
                     char text[ISO_BESIDE_TEXT]) {
    if (iso_box_is_empty(rest) || overlap(box, rest)) return false;
    const char *question = space == ISO_SPACE_FILE  ? ""
                           : space == ISO_SPACE_RAS ? ": should it be read with --space lps?"
                                                    : ": should it be read with --space ras?";
    snprintf(text, ISO_BESIDE_TEXT,
             "%.700s lies beside the rest: %.4g %.4g %.4g .. %.4g %.4g %.4g mm, the rest %.4g %.4g %.4g .. "
             "%.4g %.4g %.4g%s",
             path, box->lo.x, box->lo.y, box->lo.z, box->hi.x, box->hi.y, box->hi.z, rest->lo.x, rest->lo.y,
             rest->lo.z, rest->hi.x, rest->hi.y, rest->hi.z, question);
    return true;
}
