/* unit: the table of units. */
#include "base/unit.h"

static const struct {
    const char *suffix;
    double millimetres;
} units[] = {
    [ISO_WORLD_UNIT_MILLIMETRE] = {" mm", 1},  [ISO_WORLD_UNIT_NONE] = {"", 0},
    [ISO_WORLD_UNIT_ANGSTROM] = {" A", 1e-7},  [ISO_WORLD_UNIT_MICROMETRE] = {" um", 1e-3},
    [ISO_WORLD_UNIT_METRE] = {" m", 1e3},      [ISO_WORLD_UNIT_FOOT] = {" ft", 0},
    [ISO_WORLD_UNIT_SURVEY_FOOT] = {" ft", 0}, [ISO_WORLD_UNIT_DEGREE] = {" deg", 0},
};

const char *iso_world_unit_suffix(iso_world_unit unit) {
    return units[unit].suffix;
}

double iso_world_unit_millimetres(iso_world_unit unit) {
    return units[unit].millimetres;
}
