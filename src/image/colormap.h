/* colormap: maps numbers to colours. */
#ifndef ISO_IMAGE_COLORMAP_H
#define ISO_IMAGE_COLORMAP_H

#include <stddef.h>
#include <stdint.h>

#include "base/c_linkage.h"
#include "base/status.h"
#include "isopoint.h"

ISO_C_BEGIN

/* GRAY is the last one: it has no table. */
#define ISO_COLORMAPS(X)                                                                                     \
    X(VIRIDIS, "viridis")                                                                                    \
    X(INFERNO, "inferno")                                                                                    \
    X(TURBO, "turbo")                                                                                        \
    X(COOLWARM, "coolwarm")                                                                                  \
    X(CIVIDIS, "cividis")                                                                                    \
    X(BATLOW, "batlow")                                                                                      \
    X(VIK, "vik")                                                                                            \
    X(MAGMA, "magma")                                                                                        \
    X(PLASMA, "plasma")                                                                                      \
    X(GRAY, "gray")
typedef enum iso_colormap {
#define ISO_COLORMAP_ENUM(name, text) ISO_COLORMAP_##name,
    ISO_COLORMAPS(ISO_COLORMAP_ENUM)
#undef ISO_COLORMAP_ENUM
        ISO_COLORMAP_COUNT
} iso_colormap;

/* All names, as "viridis, inferno, .. or gray". */
extern const char iso_colormap_names[];

const char *iso_colormap_name(iso_colormap map);
/* ISO_ERR_USAGE: there is no map of this name; the message has the nearest name. */
iso_status iso_colormap_find(const char *name, iso_colormap *map, iso_error *error);

/* The gray of `at`, 0 (black) .. 1 (white); values outside are clamped. Not for NaN. */
static inline uint8_t iso_gray_at(double at) {
    return (uint8_t)((at < 0 ? 0 : at > 1 ? 1 : at) * 255 + 0.5);
}

/* Returns the colour of `at`, 0 (lowest) .. 1 (highest). Values outside are clamped; NaN is middle gray. */
iso_rgb iso_colormap_at(iso_colormap map, double at);

/* Colours at equal steps, of a file; between them they are interpolated linearly. */
typedef struct iso_color_table {
    uint32_t *colors; /* 0xRRGGBB; owned; NULL: no table */
    size_t count;     /* at least 2 */
} iso_color_table;

enum { ISO_COLOR_TABLE_MOST = 65536 }; /* colours of a table */

/* Reads a text file with a colour a row, the lowest first: RRGGBB, #RRGGBB, or red, green and blue as three
 * numbers, all of them 0 .. 1 or all of them 0 .. 255. Empty rows, and rows that begin with #
 * and are no colour, do not count. Free with iso_color_table_free. ISO_ERR_IO, ISO_ERR_NOMEM; ISO_ERR_FORMAT,
 * with the row: it has no colours, or less than two. */
iso_status iso_color_table_read(const char *path, iso_color_table *table, iso_error *error);
void iso_color_table_free(iso_color_table *table);

enum { ISO_COLOR_BAR_TITLE = 96 };

/* Which colours stand for which numbers, and what the numbers are; drawn as a colour bar (annotate.h). */
typedef struct iso_color_bar {
    iso_colormap map;
    const iso_color_table *table;    /* used instead of `map`; borrowed; NULL: `map` */
    double low, high;                /* the numbers at the ends of the bar */
    char title[ISO_COLOR_BAR_TITLE]; /* name and unit, as "curvature (1/mm)"; "": none */
} iso_color_bar;

/* The colour of a number. If low == high all numbers have the middle colour. NaN is middle gray. */
iso_rgb iso_color_bar_at(const iso_color_bar *bar, double number);

ISO_C_END
#endif
