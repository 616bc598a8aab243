/* Without meshoptimizer. */
#include "extract/mesh/mesh_edit.h"

bool iso_weld_can_decimate(void) {
    return false;
}

iso_status iso_weld_decimate(iso_weld *weld, const iso_transform *transform, const iso_mesh_edits *edits,
                             iso_error *error) {
    (void)weld, (void)transform, (void)edits;
    return iso_fail(error, ISO_ERR_BACKEND, "built without meshoptimizer, which joins triangles");
}
