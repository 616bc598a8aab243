/* placements_read: from the attributes of points to positions, rotations, scales and colours of instances. */
#include "io/glyphs/placements_read.h"

#include <math.h>
#include <string.h>
#include <strings.h>

#include "base/memory.h"
#include "base/placement.h"
#include "io/common/reading.h"
#include "io/glyphs/glyphs_read.h"

enum { QX, QY, QZ, QW, RX, RY, RZ, SCALE, COLUMNS };

static const char *const names[COLUMNS] = {"qx", "qy", "qz", "qw", "rx", "ry", "rz", "scale"};

/* The columns of a file that are used. */
typedef struct columns {
    const float *values[COLUMNS]; /* NULL: the file does not have the column */
    bool quaternion, angles;
} columns;

static int column_of(const iso_attribute *attribute) {
    for (int i = 0; i < COLUMNS && attribute->components == 1; i++)
        if (strcasecmp(attribute->name, names[i]) == 0) return i;
    return -1;
}

static void find_columns(iso_reading *reading, const iso_glyphs *glyphs, columns *found) {
    for (int i = 0; i < glyphs->attribute_count; i++) {
        const int column = column_of(&glyphs->attributes[i]);
        if (column >= 0)
            found->values[column] = glyphs->attributes[i].values;
        else
            iso_reading_note(reading, "column '%.40s' says nothing of instances", glyphs->attributes[i].name);
    }
    if (glyphs->radii) iso_reading_note(reading, "radii say nothing of instances: a column 'scale' does");
    if (glyphs->directions || glyphs->axes)
        iso_reading_note(reading, "%s say nothing of instances: columns qx qy qz qw or rx ry rz turn them",
                         glyphs->directions ? "directions" : "axes");
    if (glyphs->opacities) iso_reading_note(reading, "opacities are not used: instances are opaque");
    for (int i = QX; i <= QW; i++) found->quaternion |= found->values[i] != NULL;
    for (int i = RX; i <= RZ; i++) found->angles |= found->values[i] != NULL;
}

static iso_status check_columns(const char *path, const columns *found, iso_error *error) {
    if (found->quaternion && found->angles)
        return iso_fail(error, ISO_ERR_FORMAT, "%s: its rotations are given twice: qx qy qz qw and rx ry rz",
                        path);
    for (int i = QX; i <= QW && found->quaternion; i++)
        if (!found->values[i])
            return iso_fail(error, ISO_ERR_FORMAT, "%s: its quaternions (qx qy qz qw) have no %s", path,
                            names[i]);
    return ISO_OK;
}

static double value_of(const columns *found, int column, size_t i, double otherwise) {
    return found->values[column] ? (double)found->values[column][i] : otherwise;
}

/* Sets the rotation of an instance; false if it cannot be used. */
static bool take_rotation(const columns *found, size_t i, double rotation[4]) {
    double angles[3], square = 0;
    for (int k = 0; k < 3; k++) angles[k] = value_of(found, RX + k, i, 0);
    iso_quaternion_of_angles(angles, rotation);
    for (int k = 0; k < 4 && found->quaternion; k++) rotation[k] = value_of(found, QX + k, i, 0);
    for (int k = 0; k < 4; k++) square += rotation[k] * rotation[k];
    return square > 0 && isfinite(square);
}

static iso_status take_placement(const char *path, const iso_glyphs *glyphs, const columns *found, size_t i,
                                 iso_placement *placement, iso_error *error) {
    iso_error reason;
    placement->position = iso_glyph_position(glyphs, i);
    placement->scale = value_of(found, SCALE, i, 1);
    if (!(placement->scale > 0))
        return iso_fail(error, ISO_ERR_FORMAT, "%s: instance %zu: its scale is not a number above 0", path,
                        i + 1);
    if (!take_rotation(found, i, placement->rotation))
        return iso_fail(error, ISO_ERR_FORMAT, "%s: instance %zu: %s", path, i + 1,
                        found->quaternion ? "its quaternion is 0 or not finite"
                                          : "its angles are not finite");
    if (iso_placement_check(placement, &reason) != ISO_OK)
        return iso_fail(error, ISO_ERR_FORMAT, "%s: instance %zu: %s", path, i + 1, reason.text);
    return ISO_OK;
}

static iso_status take_placements(const char *path, const iso_glyphs *glyphs, const columns *found,
                                  iso_placements *made, iso_error *error) {
    made->count = glyphs->count;
    made->items = iso_alloc_zero(glyphs->count, sizeof *made->items);
    if (glyphs->colors) made->colors = iso_alloc_zero(glyphs->count, sizeof *made->colors);
    if (!made->items || (glyphs->colors && !made->colors)) return iso_fail_memory(error, path);
    for (size_t i = 0; i < glyphs->count; i++)
        ISO_TRY(take_placement(path, glyphs, found, i, &made->items[i], error));
    for (size_t i = 0; i < glyphs->count && glyphs->colors; i++)
        made->colors[i] = (iso_rgb){glyphs->colors[i][0], glyphs->colors[i][1], glyphs->colors[i][2]};
    return ISO_OK;
}

iso_status iso_placements_read_file(const char *path, const iso_read_opts *opts, iso_placements *placements,
                                    iso_error *error) {
    iso_read_report unused;
    iso_read_opts filled = opts ? *opts : (iso_read_opts){0};
    iso_glyphs glyphs = {.count = 0};
    iso_placements made = {.count = 0};
    columns found = {.quaternion = false};
    filled.keep_zeros = true;
    if (!filled.report) filled.report = &unused;
    ISO_TRY(iso_glyphs_read(path, &filled, &glyphs, error));
    iso_reading reading = {.path = path, .opts = filled, .report = filled.report};
    find_columns(&reading, &glyphs, &found);
    iso_status status = check_columns(path, &found, error);
    if (status == ISO_OK && !glyphs.count)
        status = iso_fail(error, ISO_ERR_EMPTY, "%s: holds no instance", path);
    if (status == ISO_OK) status = take_placements(path, &glyphs, &found, &made, error);
    iso_glyphs_free(&glyphs);
    if (status == ISO_OK)
        *placements = made;
    else
        iso_placements_free(&made);
    return status;
}

void iso_placements_free(iso_placements *placements) {
    iso_free(placements->items);
    iso_free(placements->colors);
    *placements = (iso_placements){.count = 0};
}
