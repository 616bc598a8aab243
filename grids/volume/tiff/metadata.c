/* metadata: the image descriptions of ImageJ ("ImageJ=1.53t", a key and a value a line) and of OME-TIFF
 * (XML, whose element Pixels has what is needed). */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "grids/volume/tiff/tiff.h"

/* ---- numbers ---- */

enum { VALUE = 64, MOST_SIZE = 1 << 30 };

static uint32_t size_of(const char *text) {
    char *end;
    const double value = strtod(text, &end);
    return end != text && value >= 1 && value <= MOST_SIZE ? (uint32_t)value : 0;
}

static double length_of(const char *text) {
    char *end;
    const double value = strtod(text, &end);
    return end != text && value > 0 && isfinite(value) ? value : 0;
}

/* ---- ImageJ ---- */

/* Copies the value of a line "key=value"; false: there is no such line. */
static bool line_value(const char *text, const char *key, char value[VALUE]) {
    const size_t length = strlen(key);
    for (const char *line = text; line; line = strchr(line, '\n')) {
        line += *line == '\n';
        if (strncmp(line, key, length) != 0 || line[length] != '=') continue;
        snprintf(value, VALUE, "%.*s", (int)strcspn(line + length + 1, "\r\n"), line + length + 1);
        return true;
    }
    return false;
}

static void parse_imagej(const char *text, iso_tiff_metadata *m) {
    static const char *const sizes[ISO_TIFF_AXES] = {"channels", "slices", "frames"};
    char value[VALUE];
    m->writer = "ImageJ";
    for (int axis = 0; axis < ISO_TIFF_AXES; axis++)
        if (line_value(text, sizes[axis], value)) m->sizes[axis] = size_of(value);
    if (line_value(text, "images", value)) m->images = size_of(value);
    if (line_value(text, "unit", value)) m->unit = iso_format_unit(value);
    if (line_value(text, "spacing", value) && m->unit > 0) m->spacing[2] = length_of(value) * m->unit;
}

/* ---- OME ---- */

/* Copies the value of an attribute of the element that begins at `element`; false: it has no such
 * attribute. */
static bool attribute(const char *element, const char *name, char value[VALUE]) {
    const char *end = strchr(element, '>');
    const size_t length = strlen(name);
    for (const char *at = element; (at = strstr(at, name)) && end && at < end; at += length) {
        if (strchr(" \t\r\n", at[-1]) == NULL || at[length] != '=') continue;
        const char quote = at[length + 1];
        if (quote != '"' && quote != '\'') return false;
        const char *from = at + length + 2, *to = strchr(from, quote);
        if (!to) return false;
        snprintf(value, VALUE, "%.*s", (int)(to - from < VALUE ? to - from : VALUE - 1), from);
        return true;
    }
    return false;
}

/* "XYCZT": the axes after X and Y. */
static void parse_order(const char *text, iso_tiff_metadata *m) {
    static const char letters[] = "CZT";
    iso_tiff_axis order[ISO_TIFF_AXES];
    unsigned met = 0;
    if (strlen(text) != 5 || strncmp(text, "XY", 2) != 0) return;
    for (int i = 0; i < ISO_TIFF_AXES; i++) {
        const char *letter = strchr(letters, text[2 + i]);
        if (!letter) return;
        order[i] = (iso_tiff_axis)(letter - letters);
        met |= 1u << order[i];
    }
    if (met == (1u << ISO_TIFF_AXES) - 1) memcpy(m->order, order, sizeof order);
}

static void parse_ome(const char *pixels, iso_tiff_metadata *m) {
    static const char *const sizes[ISO_TIFF_AXES] = {"SizeC", "SizeZ", "SizeT"};
    char name[32], value[VALUE];
    m->writer = "OME";
    if (attribute(pixels, "DimensionOrder", value)) parse_order(value, m);
    for (int axis = 0; axis < ISO_TIFF_AXES; axis++)
        if (attribute(pixels, sizes[axis], value)) m->sizes[axis] = size_of(value);
    for (int i = 0; i < 3; i++) {
        double unit = 1e-3; /* the schema's default is the micrometre */
        snprintf(name, sizeof name, "PhysicalSize%cUnit", "XYZ"[i]);
        if (attribute(pixels, name, value)) unit = iso_format_unit(value);
        snprintf(name, sizeof name, "PhysicalSize%c", "XYZ"[i]);
        if (attribute(pixels, name, value)) m->spacing[i] = length_of(value) * unit;
    }
}

void iso_tiff_metadata_parse(const char *description, iso_tiff_metadata *metadata) {
    *metadata = (iso_tiff_metadata){.order = {ISO_TIFF_CHANNEL, ISO_TIFF_SLICE, ISO_TIFF_TIME}};
    if (!description) return;
    const char *pixels = strstr(description, "<Pixels");
    if (strncmp(description, "ImageJ=", 7) == 0)
        parse_imagej(description, metadata);
    else if (strstr(description, "<OME") && pixels)
        parse_ome(pixels, metadata);
}
