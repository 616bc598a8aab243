/* font: reads the tables of font/sans.ttf (OpenType 1.9: cmap format 4, glyf, hmtx, loca), a file of ours
 * that tools/make_font.py has made plain: no composite glyphs, one encoding, the long or the short form of
 * loca. */
#include "image/font.h"

#include <string.h>

#include "base/text.h"

static unsigned u16(const uint8_t *at) {
    return (unsigned)at[0] << 8 | at[1];
}

static uint32_t u32(const uint8_t *at) {
    return (uint32_t)u16(at) << 16 | u16(at + 2);
}

static int i16(const uint8_t *at) {
    return (int16_t)u16(at);
}

static const uint8_t *table(const char name[4]) {
    const uint8_t *row = iso_font_file + 12;
    while (memcmp(row, name, 4) != 0) row += 16;
    return iso_font_file + u32(row + 8);
}

/* ---- characters */

uint32_t iso_font_next(const char **text) {
    const unsigned char *at = (const unsigned char *)*text;
    if (!*at) return 0;
    const int length = iso_text_utf8(*text);
    *text += length ? length : 1;
    if (length == 0) return 0xFFFD;
    if (length == 1) return at[0];
    uint32_t character = at[0] & (0x7Fu >> length);
    for (int i = 1; i < length; i++) character = character << 6 | (at[i] & 0x3Fu);
    return character;
}

int iso_font_glyph(uint32_t character) {
    const uint8_t *map = table("cmap");
    map += u32(map + 8); /* the only encoding */
    const unsigned twice = u16(map + 6);
    const uint8_t *ends = map + 14, *starts = ends + twice + 2, *deltas = starts + twice,
                  *offsets = deltas + twice;
    for (unsigned i = 0; i < twice && character < 0xFFFF; i += 2) {
        if (character > u16(ends + i)) continue;
        if (character < u16(starts + i)) return 0;
        const unsigned offset = u16(offsets + i);
        const unsigned glyph =
            offset ? u16(offsets + i + offset + 2 * (character - u16(starts + i))) : (unsigned)character;
        return glyph || !offset ? (int)((glyph + u16(deltas + i)) & 0xFFFF) : 0;
    }
    return 0;
}

int iso_font_advance(int glyph) {
    const int count = (int)u16(table("hhea") + 34);
    return (int)u16(table("hmtx") + 4 * (glyph < count ? glyph : count - 1));
}

double iso_font_width(const char *text) {
    double width = 0;
    for (uint32_t c = iso_font_next(&text); c; c = iso_font_next(&text))
        width += iso_font_advance(iso_font_glyph(c));
    return width;
}

/* ---- outlines */

enum { POINTS = 128, ON_CURVE = 1, SHORT_X = 2, SHORT_Y = 4, REPEAT = 8, SAME_X = 16, SAME_Y = 32 };

typedef struct point {
    double x, y;
    bool on;
} point;

static point middle(point a, point b) {
    return (point){0.5 * (a.x + b.x), 0.5 * (a.y + b.y), true};
}

/* Reads the coordinates of one axis behind `at`; returns what follows. */
static const uint8_t *read_axis(const uint8_t *at, const uint8_t *flags, int count, int is_short, int same,
                                double *out, size_t stride) {
    int value = 0;
    for (int i = 0; i < count; i++) {
        if (flags[i] & is_short)
            value += flags[i] & same ? *at : -(int)*at, at++;
        else if (!(flags[i] & same))
            value += i16(at), at += 2;
        *(double *)(void *)((char *)out + stride * (size_t)i) = value;
    }
    return at;
}

typedef struct outline {
    iso_font_edge *edges;
    int count, steps;
    double x, y; /* where it has come to */
} outline;

static void go_to(outline *o, double x, double y) {
    if (o->count < ISO_FONT_EDGES) o->edges[o->count++] = (iso_font_edge){o->x, o->y, x, y};
    o->x = x, o->y = y;
}

/* A quadratic Bezier curve from where the outline is. */
static void bend_to(outline *o, point control, point end) {
    const double x = o->x, y = o->y;
    for (int i = 1; i < o->steps; i++) {
        const double t = (double)i / o->steps, a = (1 - t) * (1 - t), b = 2 * t * (1 - t), c = t * t;
        go_to(o, a * x + b * control.x + c * end.x, a * y + b * control.y + c * end.y);
    }
    go_to(o, end.x, end.y);
}

/* Between two control points lies a point of the curve that the file leaves out. */
static void add_contour(outline *o, const point *p, int count) {
    if (count < 2) return;
    const point last = p[count - 1], first = p[0].on ? p[0] : last.on ? last : middle(p[0], last);
    o->x = first.x, o->y = first.y;
    for (int i = p[0].on; i < count; i++) {
        if (p[i].on) {
            go_to(o, p[i].x, p[i].y);
            continue;
        }
        const point next = i + 1 < count ? p[i + 1] : first;
        bend_to(o, p[i], next.on ? next : middle(p[i], next));
        i += next.on;
    }
    if (o->x != first.x || o->y != first.y) go_to(o, first.x, first.y);
}

int iso_font_outline(int glyph, int steps, iso_font_edge edges[ISO_FONT_EDGES]) {
    const uint8_t *loca = table("loca"), *glyf = table("glyf"), *head = table("head");
    const bool is_long = u16(head + 50) != 0;
    const uint32_t from = is_long ? u32(loca + 4 * glyph) : 2 * u16(loca + 2 * glyph),
                   to = is_long ? u32(loca + 4 * (glyph + 1)) : 2 * u16(loca + 2 * (glyph + 1));
    if (from == to) return 0; /* a space */
    const uint8_t *at = glyf + from, *ends = at + 10;
    const int contours = i16(at), count = (int)u16(ends + 2 * (contours - 1)) + 1;
    uint8_t flags[POINTS];
    point points[POINTS];
    at = ends + 2 * contours;
    at += 2 + u16(at); /* instructions */
    for (int i = 0; i < count && i < POINTS;) {
        const uint8_t flag = *at++;
        for (int again = flag & REPEAT ? *at++ + 1 : 1; again && i < POINTS; again--) flags[i++] = flag;
    }
    at = read_axis(at, flags, count, SHORT_X, SAME_X, &points[0].x, sizeof *points);
    read_axis(at, flags, count, SHORT_Y, SAME_Y, &points[0].y, sizeof *points);
    for (int i = 0; i < count; i++) points[i].on = flags[i] & ON_CURVE;
    outline o = {.edges = edges, .steps = steps};
    for (int k = 0, first = 0; k < contours; k++) {
        const int end = (int)u16(ends + 2 * k) + 1;
        add_contour(&o, points + first, end - first);
        first = end;
    }
    return o.count;
}
