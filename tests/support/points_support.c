/* points_support: copies the arrays of glyphs to surfels. */
#include "points_support.h"

#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "io/glyphs/glyphs_read.h"

iso_status test_points_read(const char *path, uint64_t limit, test_points *points, iso_error *error) {
    const iso_read_opts opts = {.max_memory = limit};
    iso_glyphs glyphs;
    ISO_TRY(iso_glyphs_read(path, &opts, &glyphs, error));
    if (!glyphs.count) {
        iso_glyphs_free(&glyphs);
        return iso_fail(error, ISO_ERR_EMPTY, "%s: no points", path);
    }
    *points = (test_points){.surfels = iso_alloc_zero(glyphs.count, sizeof *points->surfels),
                            .radii = glyphs.radii,
                            .colors = glyphs.colors,
                            .span = {.count = (uint32_t)glyphs.count}};
    if (!points->surfels) abort();
    for (size_t i = 0; i < glyphs.count; i++) {
        iso_surfel *to = &points->surfels[i];
        const double origin[3] = {glyphs.origin.x, glyphs.origin.y, glyphs.origin.z};
        for (int axis = 0; axis < 3; axis++)
            to->position[axis] = (float)(origin[axis] + (double)glyphs.positions[i][axis]);
        if (glyphs.directions) memcpy(to->normal, glyphs.directions[i], sizeof to->normal);
    }
    glyphs.radii = NULL;
    glyphs.colors = NULL;
    iso_glyphs_free(&glyphs);
    return ISO_OK;
}

void test_points_free(test_points *points) {
    iso_free(points->surfels);
    iso_free(points->radii);
    iso_free(points->colors);
    *points = (test_points){0};
}

iso_point_view test_points_view(const test_points *points) {
    return (iso_point_view){.surfels = points->surfels,
                            .radii = points->radii,
                            .colors = (const uint8_t(*)[3])points->colors,
                            .spans = &points->span,
                            .span_count = 1,
                            .transform = iso_transform_identity()};
}
