/* Reads the solid of --new. */
#include <stdlib.h>
#include <string.h>

#include "apps/isosculpt/isosculpt.h"
#include "sculpt/brush/brush.h"

static iso_status fail(const char *text, const char *why, iso_error *error) {
    return iso_fail(
        error, ISO_ERR_USAGE,
        "'%s': %s; sphere:80, box:60x40x20,round=4, capsule:20x60, cylinder:40x60 and torus:80x16 are known",
        text, why);
}

/* Reads up to three numbers with x between them; returns how many, and where they end. */
static int read_sizes(const char *at, double sizes[3], const char **rest) {
    int count = 0;
    for (char *end; count < 3; at = end + 1) {
        sizes[count] = strtod(at, &end);
        *rest = end;
        if (end == at) return 0;
        count++;
        if (*end != 'x') break;
    }
    return count;
}

iso_status isosculpt_solid_parse(const char *text, iso_start_solid *solid, iso_error *error) {
    const char *colon = strchr(text, ':'), *rest;
    char name[16] = "", *end;
    double sizes[3], round = 0;
    iso_solid kind;
    if (colon && colon - text < (long)sizeof name) memcpy(name, text, (size_t)(colon - text));
    if (iso_solid_find(name, &kind, NULL) != ISO_OK || kind > ISO_SOLID_TORUS)
        return fail(text, "is no solid to begin with", error);
    const int wanted = kind == ISO_SOLID_SPHERE ? 1 : kind == ISO_SOLID_BOX ? 3 : 2;
    if (read_sizes(colon + 1, sizes, &rest) != wanted) return fail(text, "is no size of such a solid", error);
    if (strncmp(rest, ",round=", 7) == 0) {
        round = strtod(rest + 7, &end);
        rest = end;
    }
    if (*rest) return fail(text, "is no size of such a solid", error);
    const double across = wanted == 3 ? sizes[1] : sizes[0];
    *solid = (iso_start_solid){kind, {sizes[0], across, sizes[wanted - 1]}, round};
    return ISO_OK;
}
