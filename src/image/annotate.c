/* annotate: composes scale bar, orientation marker, colour bars, legend and notes of the marks of a
 * drawing. */
#include "image/annotate.h"

#include <math.h>
#include <stdio.h>

#include "image/font.h"
#include "image/placing.h"

static const iso_rgb BLACK = {0, 0, 0}, WHITE = {255, 255, 255};

/* ---- sizes */

/* Colours and sizes for one picture; sizes in pixels. */
typedef struct pen {
    iso_drawing *drawing;
    int width, height; /* of the picture */
    iso_rgb ink, outline;
    double text;   /* height of capital letters */
    double size;   /* of the font */
    double line;   /* width of lines */
    double border; /* width of the outline */
} pen;

double iso_annotation_font_size(double given, int width, int height) {
    const int side = width < height ? width : height;
    return given > 0 ? given : fmax(9, side * 0.024) * ISO_FONT_SIZE / ISO_FONT_CAPITALS;
}

static pen pen_of(iso_drawing *drawing, const iso_annotation *a, int width, int height) {
    pen p = {.drawing = drawing, .width = width, .height = height};
    p.ink = a->dark ? WHITE : BLACK;
    p.outline = a->dark ? BLACK : WHITE;
    p.size = iso_annotation_font_size(a->font_size, width, height);
    p.text = p.size * ISO_FONT_CAPITALS / ISO_FONT_SIZE;
    p.line = fmax(1.2, 0.8 * p.text / 6);
    p.border = fmax(1, 0.45 * p.text / 6);
    return p;
}

static void outline(const pen *p, iso_mark *mark) {
    if (!mark) return;
    mark->halo = p->border;
    mark->halo_color = p->outline;
}

/* Begins lines with their outline. */
static iso_mark *outlined_lines(const pen *p) {
    iso_mark *lines = iso_drawing_lines(p->drawing, p->ink, p->line);
    outline(p, lines);
    return lines;
}

static void add_line(const pen *p, iso_mark *lines, double x0, double y0, double x1, double y1) {
    iso_drawing_line(p->drawing, lines, x0, y0, x1, y1);
}

static double text_width(const pen *p, const char *text) {
    return iso_font_width(text) * p->size / ISO_FONT_SIZE;
}

/* Adds a text that begins at x, with the middle of its capitals at y. */
static void add_text(const pen *p, const char *text, double x, double y) {
    outline(p, iso_drawing_text(p->drawing, text, x, y + 0.5 * p->text, p->size, p->ink));
}

static void add_centred(const pen *p, const char *text, double x, double y) {
    add_text(p, text, x - 0.5 * text_width(p, text), y);
}

/* ---- the scale bar */

/* The round length nearest to `wanted`: 1, 2 or 5 times a power of ten; 0 if that is no length. */
static double round_length(double wanted) {
    static const int steps[] = {1, 2, 5};
    double best = 0, nearest = INFINITY, power = 1;
    if (!(wanted > 0 && wanted < 1e15)) return 0;
    while (power > wanted && power > 1e-15) power /= 10;
    while (power * 10 <= wanted) power *= 10;
    for (int i = 0; i < 4; i++) {
        const double length = i < 3 ? steps[i] * power : 10 * power;
        const double ratio = length > wanted ? length / wanted : wanted / length;
        if (ratio < nearest) {
            nearest = ratio;
            best = length;
        }
    }
    return best;
}

double iso_scale_bar_length(const iso_camera *camera, int width, int height) {
    return round_length(iso_camera_mm_per_pixel(camera, height) * width / 5);
}

static const struct {
    const char *name, *shown; /* shown: in a picture, if it is another name */
    double millimetres;
} length_units[ISO_UNITS] = {[ISO_UNIT_AUTO] = {"", NULL, 0},
                             [ISO_UNIT_NONE] = {"", NULL, 0},
                             [ISO_UNIT_NM] = {"nm", NULL, 1e-6},
                             [ISO_UNIT_UM] = {"um", "\u00b5m", 1e-3},
                             [ISO_UNIT_MM] = {"mm", NULL, 1},
                             [ISO_UNIT_CM] = {"cm", NULL, 10},
                             [ISO_UNIT_M] = {"m", NULL, 1e3},
                             [ISO_UNIT_KM] = {"km", NULL, 1e6},
                             [ISO_UNIT_ANGSTROM] = {"A", "\u00c5", 1e-7}};

const char *iso_length_unit_name(const iso_length_style *style) {
    if (style->unit != ISO_UNIT_AUTO) return length_units[style->unit].name;
    const char *suffix = iso_world_unit_suffix(style->world);
    return suffix + (*suffix == ' ');
}

double iso_length_factor(const iso_length_style *style) {
    const double to = length_units[style->unit].millimetres, from = iso_world_unit_millimetres(style->world);
    return to > 0 && from > 0 ? from / to : 1;
}

/* The largest unit in which a length is not too small a number: for lengths that a person reads, mm down to
 * 0.1 mm, cm only from 10 cm on. */
static iso_length_unit unit_of_size(double millimetres, iso_world_unit world) {
    static const struct {
        iso_length_unit unit;
        double from; /* mm */
    } sizes[] = {
        {ISO_UNIT_KM, 1e6}, {ISO_UNIT_M, 1e3}, {ISO_UNIT_CM, 100}, {ISO_UNIT_MM, 0.1}, {ISO_UNIT_UM, 1e-3}};
    for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++)
        if (millimetres >= sizes[i].from * (1 - 1e-9)) return sizes[i].unit;
    return world == ISO_WORLD_UNIT_ANGSTROM && millimetres < 1e-5 * (1 - 1e-9) ? ISO_UNIT_ANGSTROM
                                                                               : ISO_UNIT_NM;
}

void iso_length_label(double length, int digits, const iso_length_style *style, char label[32]) {
    const double millimetres = length * iso_world_unit_millimetres(style->world);
    iso_length_style shown = *style;
    if (style->unit == ISO_UNIT_AUTO && millimetres > 0) shown.unit = unit_of_size(millimetres, style->world);
    const char *name = length_units[shown.unit].shown;
    if (!name) name = iso_length_unit_name(&shown);
    snprintf(label, 32, "%.*g%s%s", digits, length * iso_length_factor(&shown), *name ? " " : "", name);
}

static void draw_scale_bar(const pen *p, const iso_annotation *a) {
    const iso_camera *camera = a->camera;
    const double length = iso_scale_bar_length(camera, p->width, p->height);
    if (!(length > 0)) return;
    char label[32];
    iso_length_label(length, 10, &a->lengths, label);
    const double pixels = length / iso_camera_mm_per_pixel(camera, p->height);
    const double text = text_width(p, label); /* the label may be wider than the bar */
    const double right = p->width - 1.2 * p->text - fmax(0, 0.5 * (text - pixels)), left = right - pixels;
    const double y = p->height - 1.5 * p->text, tick = 0.4 * p->text;
    iso_mark *lines = outlined_lines(p);
    add_line(p, lines, left, y, right, y);
    add_line(p, lines, left, y - tick, left, y + tick);
    add_line(p, lines, right, y - tick, right, y + tick);
    add_centred(p, label, 0.5 * (left + right), y - 1.5 * p->text);
}

/* ---- the orientation marker: three axes with up to six arms */

/* Length of an arm, in heights of letters. */
static const double ARM = 2.6;

/* An arm is one half of an axis, as the camera sees it. */
typedef struct arm {
    char letter[2];
    double x, y, depth; /* unit vector: to the right, down, away from the viewer */
    int axis;
    bool positive;
} arm;

static int make_arms(const iso_annotation *a, const pen *p, arm arms[6]) {
    const iso_view view = iso_view_make(a->camera, p->width, p->height);
    static const char letters[3][2] = {{'R', 'L'}, {'A', 'P'}, {'F', 'H'}}, plain[3] = {'x', 'y', 'z'};
    int count = 0;
    for (int axis = 0; axis < 3; axis++)
        for (int positive = !a->anatomical; positive < 2; positive++) {
            const double sign = positive ? 1 : -1;
            arm made = {.letter = {a->anatomical ? letters[axis][positive] : plain[axis], 0},
                        .x = sign * view.rotation[axis],
                        .y = sign * view.rotation[3 + axis],
                        .depth = sign * view.rotation[6 + axis],
                        .axis = axis,
                        .positive = positive};
            int at = count++;
            for (; at > 0 && arms[at - 1].depth < made.depth; at--)
                arms[at] = arms[at - 1]; /* sorted: the farthest first */
            arms[at] = made;
        }
    return count;
}

/* The position of an arm's letter relative to the marker's middle; false when the letter is left out, because
 * the arm points towards the viewer or away and the letter would cover others. */
static bool letter_of(const pen *p, const arm *a, double *x, double *y) {
    const double reach = sqrt(a->x * a->x + a->y * a->y);
    if (reach < 0.25) return false;
    const double out = ARM * p->text + p->text / reach;
    *x = a->x * out;
    *y = a->y * out;
    return true;
}

/* Whether an arm's letter is left out: of two letters that would overlap, the one farther from the middle is
 * drawn. */
static bool is_covered(const pen *p, const arm arms[6], int count, int which) {
    double x, y, other_x, other_y;
    if (!letter_of(p, &arms[which], &x, &y)) return true;
    for (int i = 0; i < count; i++) {
        if (i == which || !letter_of(p, &arms[i], &other_x, &other_y)) continue;
        const bool overlap = fabs(x - other_x) < p->text && fabs(y - other_y) < 1.2 * p->text;
        const double own = x * x + y * y, others = other_x * other_x + other_y * other_y;
        if (overlap && (others > own || (others == own && i < which))) return true;
    }
    return false;
}

/* Draws all outlines first, so that no outline covers another axis. */
static void draw_axes(const pen *p, const arm arms[6], int count, const double middle[2]) {
    static const iso_rgb colors[3] = {{208, 58, 47}, {46, 150, 62}, {58, 108, 216}};
    for (int layer = 0; layer < 2; layer++)
        for (int i = 0; i < count; i++) {
            const arm *a = &arms[i];
            const double width = (a->positive ? 1.5 : 0.9) * p->line, length = ARM * p->text;
            iso_mark *axis = iso_drawing_lines(p->drawing, layer ? colors[a->axis] : p->outline,
                                               layer ? width : width + 2 * p->border);
            add_line(p, axis, middle[0], middle[1], middle[0] + a->x * length, middle[1] + a->y * length);
        }
}

static void draw_marker(const pen *p, const iso_annotation *a) {
    arm arms[6];
    const int count = make_arms(a, p, arms);
    const double middle[2] = {5 * p->text, p->height - 5 * p->text};
    double x = 0, y = 0;
    draw_axes(p, arms, count, middle);
    for (int i = 0; i < count; i++)
        if (!is_covered(p, arms, count, i) && letter_of(p, &arms[i], &x, &y))
            add_centred(p, arms[i].letter, middle[0] + x, middle[1] + y);
}

/* ---- colour bars */

/* Round numbers in a range: first .. last times step, which is 1, 2, 2.5 or 5 times a power of ten. */
typedef struct bar_ticks {
    double times, over; /* step = times / over, of which one is exact */
    double first, last;
    int digits; /* that their texts need */
} bar_ticks;

/* Sets *t to at most `most` and, but for that, at least 3 ticks in low .. high. False: there are none,
 * because the numbers are equal, or nearly. */
static bool make_ticks(double low, double high, int most, bar_ticks *t) {
    static const double steps[] = {1, 2, 2.5, 5};
    const double size = high - low, greatest = fmax(fabs(low), fabs(high));
    if (!(size > 1e-12 * greatest && greatest < 1e300)) return false;
    int exponent = 0;
    double power = 1; /* 10^|exponent| */
    for (double rest = size / most; rest >= 10; rest /= 10) exponent++, power *= 10;
    for (double rest = size / most; rest < 1 && power < 1e300; rest *= 10) exponent--, power *= 10;
    for (int i = 0; i < 8; i++) {
        const double step = steps[i % 4] * (i / 4 ? 10 : 1);
        t->times = exponent < 0 ? step : step * power;
        t->over = exponent < 0 ? power : 1;
        t->first = ceil(low * t->over / t->times - 1e-9);
        t->last = floor(high * t->over / t->times + 1e-9);
        if (t->last - t->first >= most) continue;
        t->digits = 2 - exponent;
        for (double rest = greatest; rest >= 10; rest /= 10) t->digits++;
        t->digits = t->digits < 6 ? 6 : t->digits > 15 ? 15 : t->digits;
        return true;
    }
    return false;
}

/* Fills a rectangle with the colours of a map, the highest at the top. */
static void fill_bar(const pen *p, const iso_color_bar *bar, double left, double right, double top,
                     double bottom) {
    iso_color_bar unit = *bar;
    iso_image colors;
    unit.low = 0;
    unit.high = 1;
    const int rows = (int)fmax(1, floor(bottom) - floor(top));
    if (iso_image_create(1, rows, &colors, NULL) != ISO_OK) {
        p->drawing->failed = true;
        return;
    }
    for (int y = 0; y < rows; y++) {
        const iso_rgb c = iso_color_bar_at(&unit, 1 - (y + 0.5) / rows);
        uint8_t *rgba = colors.rgba + 4 * y;
        rgba[0] = c.r, rgba[1] = c.g, rgba[2] = c.b, rgba[3] = 255;
    }
    iso_drawing_picture(p->drawing, &colors, floor(left), floor(top), floor(right), floor(bottom));
}

/* Adds a number and its tick, right-aligned at `right`. Returns the number's width. */
static double add_label(const pen *p, double number, int digits, double right, double y) {
    char label[40];
    add_line(p, outlined_lines(p), right + 0.3 * p->text, y, right + 0.6 * p->text, y);
    snprintf(label, sizeof label, "%s%.*g", number < 0 ? "\u2212" : "", digits,
             fabs(number)); /* a minus sign */
    const double width = text_width(p, label);
    add_text(p, label, right - width, y);
    return width;
}

/* Adds round numbers beside a bar; of a range without any, its middle. Returns the width of the widest. */
static double add_labels(const pen *p, const iso_color_bar *bar, double right, double top, double bottom) {
    enum { MOST = 6 };
    const double low = fmin(bar->low, bar->high), high = fmax(bar->low, bar->high),
                 room = (bottom - top) / (2 * p->text);
    double widest = 0;
    bar_ticks t;
    if (!make_ticks(low, high, room < 2 ? 2 : room > MOST ? MOST : (int)room, &t))
        return add_label(p, 0.5 * (low + high), 6, right, 0.5 * (top + bottom));
    for (double i = t.first; i <= t.last; i++) {
        const double number = i * t.times / t.over, part = (number - bar->low) / (bar->high - bar->low);
        widest = fmax(widest, add_label(p, number, t.digits, right, bottom + (top - bottom) * part));
    }
    return widest;
}

static void add_box(const pen *p, iso_mark *lines, double left, double top, double right, double bottom) {
    add_line(p, lines, left, top, right, top);
    add_line(p, lines, right, top, right, bottom);
    add_line(p, lines, right, bottom, left, bottom);
    add_line(p, lines, left, bottom, left, top);
}

/* Draws a bar whose right end is *right, and moves *right to the left of it. */
static void draw_color_bar(const pen *p, const iso_color_bar *bar, double *right) {
    const double top = 0.25 * p->height, bottom = 0.75 * p->height, left = *right - p->text;
    add_box(p, outlined_lines(p), left, top, *right, bottom);
    fill_bar(p, bar, left, *right, top, bottom);
    const double widest = add_labels(p, bar, left - 0.8 * p->text, top, bottom),
                 room = text_width(p, bar->title);
    if (*bar->title) add_text(p, bar->title, *right - room, top - 1.9 * p->text);
    *right -= fmax(3 * p->text + widest, room > 0 ? room + p->text : 0);
}

/* ---- the legend */

/* Draws an entry with its top left corner at (x, y); returns its width. */
static double draw_entry(const pen *p, const iso_legend_entry *entry, double x, double y) {
    const double side = p->text, corners[4][2] = {{x, y}, {x + side, y}, {x + side, y + side}, {x, y + side}};
    add_box(p, outlined_lines(p), x, y, x + side, y + side);
    iso_drawing_polygon(p->drawing, entry->color, corners, 4);
    add_text(p, entry->name, x + 1.6 * side, y + side / 2);
    return 1.6 * side + text_width(p, entry->name);
}

/* How many entries columns of so many rows show that fit beside each other: of the first column all. */
static int entries_that_fit(const pen *p, const iso_annotation *a, int rows, double margin) {
    double left = margin, widest = 0;
    for (int i = 0; i < a->legend_count; i++) {
        if (i && i % rows == 0) left += widest + 1.5 * p->text, widest = 0;
        widest = fmax(widest, 1.6 * p->text + text_width(p, a->legend[i].name));
        if (i >= rows && left + widest > p->width - margin) return i / rows * rows;
    }
    return a->legend_count;
}

/* Draws the entries that there is room for, and in the place of the last how many more there are. Returns
 * their number. */
static int draw_legend(const pen *p, const iso_annotation *a) {
    const double step = 1.7 * p->text, margin = 1.2 * p->text;
    const int rows = (int)fmax(1, (p->height - 2 * margin) / step), all = a->legend_count + a->legend_more,
              fitting = entries_that_fit(p, a, rows, margin), shown = fitting < all ? fitting - 1 : fitting;
    double left = margin, widest = 0;
    for (int i = 0; i < fitting; i++) {
        const double y = margin + i % rows * step;
        char more[32];
        if (i && i % rows == 0) left += widest + 1.5 * p->text, widest = 0;
        if (i < shown) widest = fmax(widest, draw_entry(p, &a->legend[i], left, y));
        snprintf(more, sizeof more, "+%d more", all - shown);
        if (i == shown) add_text(p, more, left, y + p->text / 2);
    }
    return all - shown;
}

/* ---- notes: texts, arrows and rulers */

bool iso_place_project(const iso_place *place, const iso_camera *camera, int width, int height,
                       double pixel[2]) {
    if (!place->in_world) {
        pixel[0] = place->at[0] * width, pixel[1] = place->at[1] * height;
        return true;
    }
    const iso_view view = iso_view_make(camera, width, height);
    const iso_vec3 at = iso_view_point(&view, iso_vec3_make(place->at[0], place->at[1], place->at[2]));
    if (!view.orthographic && !(at.z > view.near)) return false;
    const double scale = view.orthographic ? view.focal : view.focal / at.z;
    pixel[0] = view.cx + scale * at.x, pixel[1] = view.cy + scale * at.y;
    return true;
}

static double clamped(double value, double low, double high) {
    return value < low || high < low ? low : value > high ? high : value;
}

/* Draws a text with its middle at `at`, moved so that it stays inside the picture. */
static void draw_words(const pen *p, const char *text, const double at[2]) {
    const double width = text_width(p, text), edge = 0.5 * p->text;
    add_text(p, text, clamped(at[0] - 0.5 * width, edge, p->width - width - edge),
             clamped(at[1], p->text, p->height - p->text));
}

/* Where the text of an arrow stands that does not say it: away from the picture's middle. */
static void usual_tail(const pen *p, const double head[2], double tail[2]) {
    const double side = head[0] < 0.5 * p->width ? -1 : 1, up = head[1] > 0.7 * p->height ? 1 : -1;
    tail[0] = head[0] + side * 5 * p->text;
    tail[1] = head[1] + up * 4 * p->text;
}

/* The part of the way from a text's middle to `to` at which its box ends. */
static double leave_box(const pen *p, double text, const double from[2], const double to[2]) {
    const double dx = fabs(to[0] - from[0]), dy = fabs(to[1] - from[1]);
    const double x = dx > 0 ? (0.5 * text + 0.4 * p->text) / dx : INFINITY,
                 y = dy > 0 ? 1.1 * p->text / dy : INFINITY;
    return fmin(1, fmin(x, y));
}

static void draw_arrow(const pen *p, const iso_note *note, const double head[2], double tail[2]) {
    const double width = note->text ? text_width(p, note->text) : 0, edge = 0.5 * p->text;
    if (note->text) {
        tail[0] = clamped(tail[0], edge + 0.5 * width, p->width - 0.5 * width - edge);
        tail[1] = clamped(tail[1], p->text, p->height - p->text);
    }
    const double leave = note->text ? leave_box(p, width, tail, head) : 0;
    const double begin[2] = {tail[0] + leave * (head[0] - tail[0]), tail[1] + leave * (head[1] - tail[1])};
    const double dx = head[0] - begin[0], dy = head[1] - begin[1], length = sqrt(dx * dx + dy * dy);
    if (length > 0) {
        const double tip = fmin(length, 1.1 * p->text), x = dx / length, y = dy / length, half = 0.38 * tip;
        const double base[2] = {head[0] - tip * x, head[1] - tip * y};
        const double corners[3][2] = {{head[0], head[1]},
                                      {base[0] - half * y, base[1] + half * x},
                                      {base[0] + half * y, base[1] - half * x}};
        add_line(p, outlined_lines(p), begin[0], begin[1], base[0], base[1]);
        outline(p, iso_drawing_polygon(p->drawing, p->ink, corners, 3));
    }
    if (note->text) add_centred(p, note->text, tail[0], tail[1]);
}

/* Ticks are at round lengths from the first point on. */
static void draw_ruler(const pen *p, const iso_annotation *a, const iso_note *note, const double from[2],
                       const double to[2]) {
    const double *q = note->to.at, *o = note->from.at, d[3] = {q[0] - o[0], q[1] - o[1], q[2] - o[2]};
    const double length = sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]), step = round_length(length / 8);
    const double dx = to[0] - from[0], dy = to[1] - from[1], seen = sqrt(dx * dx + dy * dy);
    if (!(step > 0 && seen > 0)) return;
    /* ticks and length stand on the side that is away from the picture's middle, or else above */
    const double out[2] = {0.5 * (from[0] + to[0] - p->width), 0.5 * (from[1] + to[1] - p->height)};
    const double across = out[0] * dy - out[1] * dx, little = 0.02 * seen * p->height;
    const bool upwards = dx > 0 || (dx == 0 && dy < 0), outwards = across > 0;
    const double side = (fabs(across) > little ? outwards : upwards) ? 1 : -1;
    const double x = side * dy / seen, y = -side * dx / seen;
    const int ticks = (int)(length / step + 1e-9);
    iso_mark *lines = outlined_lines(p);
    add_line(p, lines, from[0], from[1], to[0], to[1]);
    const double high = 0.6 * p->text, *ends[2] = {from, to};
    for (int i = 0; i < 2; i++)
        add_line(p, lines, ends[i][0] - x * high, ends[i][1] - y * high, ends[i][0] + x * high,
                 ends[i][1] + y * high);
    for (int i = 1; i <= ticks && seen > ticks * 2 * p->line; i++) {
        const double part = i * step / length, low = 0.4 * p->text;
        const iso_place place = {true, {o[0] + part * d[0], o[1] + part * d[1], o[2] + part * d[2]}};
        double at[2];
        if (part < 1 - 1e-9 && iso_place_project(&place, a->camera, p->width, p->height, at))
            add_line(p, lines, at[0], at[1], at[0] + x * low, at[1] + y * low);
    }
    char label[32];
    iso_length_label(length, 4, &a->lengths, label);
    const double away = high + 0.5 * (fabs(x) * text_width(p, label) + fabs(y) * p->text) + 0.6 * p->text;
    const double middle[2] = {0.5 * (from[0] + to[0]) + x * away, 0.5 * (from[1] + to[1]) + y * away};
    draw_words(p, label, middle);
}

static void draw_note(const pen *p, const iso_annotation *a, const iso_note *note) {
    double from[2], to[2];
    if (!iso_place_project(&note->to, a->camera, p->width, p->height, to)) return;
    if (note->kind == ISO_NOTE_ARROW && !note->has_from)
        usual_tail(p, to, from);
    else if (note->kind != ISO_NOTE_TEXT &&
             !iso_place_project(&note->from, a->camera, p->width, p->height, from))
        return;
    if (note->kind == ISO_NOTE_TEXT)
        draw_words(p, note->text, to);
    else if (note->kind == ISO_NOTE_ARROW)
        draw_arrow(p, note, to, from);
    else
        draw_ruler(p, a, note, from, to);
}

/* ---- insets */

void iso_inset_place(iso_inset *inset, int width, int height) {
    static const double MOST = 0.45, MARGIN = 0.02, LITTLE = 1e-6; /* parts of the picture; of a pixel */
    const int sides[2] = {width, height}, margin = (int)(MARGIN * (width < height ? width : height));
    const bool at_end[2] = {inset->corner == ISO_CORNER_TOP_RIGHT || inset->corner == ISO_CORNER_BOTTOM_RIGHT,
                            inset->corner == ISO_CORNER_BOTTOM_LEFT ||
                                inset->corner == ISO_CORNER_BOTTOM_RIGHT};
    inset->factor = ISO_INSET_MOST;
    for (int axis = 0; axis < 2; axis++) {
        const int low = (int)(inset->box[axis] * sides[axis] + LITTLE),
                  high = (int)(inset->box[2 + axis] * sides[axis] + LITTLE);
        const int most = (int)(MOST * sides[axis] / (high > low ? high - low : 1) + LITTLE);
        inset->part[axis] = low;
        inset->part[2 + axis] = high > low ? high : low + 1;
        if (most < inset->factor) inset->factor = most < 2 ? 2 : most;
    }
    for (int axis = 0; axis < 2; axis++) {
        const int side = inset->factor * (inset->part[2 + axis] - inset->part[axis]);
        inset->place[axis] = at_end[axis] ? sides[axis] - margin - side : margin;
        inset->place[2 + axis] = inset->place[axis] + side;
    }
}

static void draw_inset(const pen *p, const iso_inset *inset) {
    const int *to = inset->place, *from = inset->part;
    iso_mark *frame = outlined_lines(p);
    add_box(p, frame, from[0], from[1], from[2], from[3]);
    /* from the two corners that do not lie behind the inset */
    const bool down = (to[1] < from[1]) == (to[0] < from[0]);
    const int x[2] = {0, 2}, y[2] = {down ? 3 : 1, down ? 1 : 3};
    for (int i = 0; i < 2; i++) add_line(p, frame, from[x[i]], from[y[i]], to[x[i]], to[y[i]]);
    iso_image picture = *inset->picture;
    *inset->picture = (iso_image){.rgba = NULL};
    iso_drawing_picture(p->drawing, &picture, to[0], to[1], to[2], to[3]);
    add_box(p, outlined_lines(p), to[0], to[1], to[2], to[3]);
}

/* ---- all */

bool iso_is_dark(iso_rgb background, bool transparent) {
    const iso_rgb c = background;
    return !transparent && 299 * c.r + 587 * c.g + 114 * c.b < 128 * 1000;
}

/* Draws one kind at its usual place. */
static void draw_kind(const pen *p, const iso_annotation *a, iso_annotation_kind kind,
                      iso_annotation_places *places) {
    double right = p->width - 1.2 * p->text;
    if (kind == ISO_ANNOTATION_MARKER && a->orientation_marker) draw_marker(p, a);
    if (kind == ISO_ANNOTATION_LEGEND) places->legend_more = draw_legend(p, a);
    for (int i = 0; kind == ISO_ANNOTATION_COLOR_BARS && i < a->color_bar_count; i++)
        draw_color_bar(p, &a->color_bars[i], &right);
    if (kind == ISO_ANNOTATION_SCALE_BAR && a->scale_bar) draw_scale_bar(p, a);
}

/* Chooses where kinds stand, or looks up where they are to stand, and sets how far they are moved. The
 * largest ones choose first. */
static void place_kinds(const iso_annotation *a, const iso_placing *placing, iso_annotation_places *places) {
    static const iso_annotation_kind order[] = {ISO_ANNOTATION_COLOR_BARS, ISO_ANNOTATION_LEGEND,
                                                ISO_ANNOTATION_SCALE_BAR, ISO_ANNOTATION_MARKER};
    for (int i = 0; i < ISO_ANNOTATION_KINDS; i++) {
        const int kind = (int)order[i];
        if (places->chosen || !a->under)
            iso_placing_move(placing, &placing->over[kind], places->place[kind], placing->moved[kind]);
        else
            places->place[kind] = iso_placing_choose(placing, kind, &places->covered[kind]);
    }
    places->chosen = true;
}

iso_status iso_annotation_draw(iso_drawing *drawing, const iso_annotation *annotation, int width, int height,
                               iso_error *error) {
    enum { INSET = ISO_ANNOTATION_KINDS, NOTES, ALL };
    const iso_annotation *a = annotation;
    iso_drawing over[ALL] = {{.marks = NULL}};
    iso_annotation_places own = {.chosen = false}, *places = a->places ? a->places : &own;
    double moved[ISO_ANNOTATION_KINDS][2] = {{0}};
    pen p = pen_of(&over[NOTES], a, width, height);
    for (int i = 0; i < a->note_count; i++) draw_note(&p, a, &a->notes[i]);
    p.drawing = &over[INSET];
    if (a->inset) draw_inset(&p, a->inset);
    for (int i = 0; i < ISO_ANNOTATION_KINDS; i++) {
        p.drawing = &over[i];
        draw_kind(&p, a, (iso_annotation_kind)i, places);
    }
    const iso_placing placing = {.under = a->under,
                                 .background = a->background,
                                 .width = width,
                                 .height = height,
                                 .margin = 1.2 * p.text,
                                 .over = over,
                                 .count = ALL,
                                 .movable = ISO_ANNOTATION_KINDS,
                                 .moved = moved};
    place_kinds(a, &placing, places);
    iso_drawing_append(drawing, &over[INSET], 0, 0);
    for (int i = 0; i < ISO_ANNOTATION_KINDS; i++)
        iso_drawing_append(drawing, &over[i], moved[i][0], moved[i][1]);
    iso_drawing_append(drawing, &over[NOTES], 0, 0);
    return iso_drawing_check(drawing, error);
}

iso_status iso_annotate(iso_image *image, const iso_annotation *annotation, iso_error *error) {
    iso_drawing drawing = {.marks = NULL};
    iso_status status = iso_annotation_draw(&drawing, annotation, image->width, image->height, error);
    if (status == ISO_OK) status = iso_drawing_paint(&drawing, image, error);
    iso_drawing_free(&drawing);
    return status;
}
