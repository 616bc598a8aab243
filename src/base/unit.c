/* unit: the table of units. */
#include "base/unit.h"

static const struct {
    const char *suffix;
    double millimetres;
} units[] = {
    [ISO_UNIT_MILLIMETRE] = {" mm", 1},  [ISO_UNIT_NONE] = {"", 0},
    [ISO_UNIT_ANGSTROM] = {" A", 1e-7},  [ISO_UNIT_MICROMETRE] = {" um", 1e-3},
    [ISO_UNIT_METRE] = {" m", 1e3},      [ISO_UNIT_FOOT] = {" ft", 0},
    [ISO_UNIT_SURVEY_FOOT] = {" ft", 0}, [ISO_UNIT_DEGREE] = {" deg", 0},
};

const char *iso_unit_suffix(iso_unit unit) {
    return units[unit].suffix;
}

double iso_unit_millimetres(iso_unit unit) {
    return units[unit].millimetres;
}
