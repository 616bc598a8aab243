/* annotate: draws lines with antialiasing by 64 samples a pixel, and composes scale bar, orientation
 * marker and colour bars of them. */
#include "image/annotate.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/memory.h"
#include "image/vector_font.h"

typedef struct color {
    int rgb[3];
} color;

static const color BLACK = {{0, 0, 0}}, WHITE = {{255, 255, 255}};

/* ---- lines */

typedef struct line {
    double x0, y0, x1, y1; /* pixels */
} line;

enum { LINES = 512, SIDE = 8, SAMPLES = SIDE * SIDE };

/* Lines that are drawn together: a pixel that several of them cover is blended only once. */
typedef struct drawing {
    line lines[LINES];
    int count;
} drawing;

static void add_line(drawing *d, double x0, double y0, double x1, double y1) {
    if (d->count < LINES) d->lines[d->count++] = (line){x0, y0, x1, y1};
}

/* A rectangle of pixels with the corner (x0, y0); in each pixel, bit s is set if sample s is covered. */
typedef struct mask {
    uint64_t *bits;
    int x0, y0, width, height;
} mask;

static int bounded(double value, int most) {
    return value <= 0 ? 0 : value >= most ? most : (int)value;
}

static iso_status create_mask(const drawing *d, const iso_image *image, double radius, mask *m,
                              iso_error *error) {
    double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
    for (int i = 0; i < d->count; i++) {
        const line *l = &d->lines[i];
        low[0] = fmin(low[0], fmin(l->x0, l->x1));
        low[1] = fmin(low[1], fmin(l->y0, l->y1));
        high[0] = fmax(high[0], fmax(l->x0, l->x1));
        high[1] = fmax(high[1], fmax(l->y0, l->y1));
    }
    m->x0 = bounded(low[0] - radius, image->width);
    m->y0 = bounded(low[1] - radius, image->height);
    m->width = bounded(high[0] + radius + 1, image->width) - m->x0;
    m->height = bounded(high[1] + radius + 1, image->height) - m->y0;
    if (m->width <= 0 || m->height <= 0) return ISO_OK;
    m->bits = iso_alloc_zero((size_t)m->width * (size_t)m->height, sizeof *m->bits);
    return m->bits ? ISO_OK : iso_fail(error, ISO_ERR_NOMEM, "out of memory for the scale bar or marker");
}

static double distance_squared(const line *l, double x, double y) {
    const double dx = l->x1 - l->x0, dy = l->y1 - l->y0, length = dx * dx + dy * dy;
    double t = length > 0 ? ((x - l->x0) * dx + (y - l->y0) * dy) / length : 0;
    t = t < 0 ? 0 : t > 1 ? 1 : t;
    const double ex = x - (l->x0 + t * dx), ey = y - (l->y0 + t * dy);
    return ex * ex + ey * ey;
}

/* Returns which samples of pixel (x, y) are within `radius` of a line. */
static uint64_t covered_samples(const line *l, double radius, int x, int y) {
    const double inner = radius - 0.75, outer = radius + 0.75; /* half a pixel's diagonal is 0.71 */
    const double middle = distance_squared(l, x + 0.5, y + 0.5);
    if (middle > outer * outer) return 0;
    if (inner > 0 && middle < inner * inner) return UINT64_MAX;
    uint64_t bits = 0;
    for (int s = 0; s < SAMPLES; s++) {
        const double sx = x + (s % SIDE + 0.5) / SIDE, sy = y + (s / SIDE + 0.5) / SIDE;
        bits |= (uint64_t)(distance_squared(l, sx, sy) <= radius * radius) << s;
    }
    return bits;
}

static void mark_line(mask *m, const line *l, double radius) {
    const int left = bounded(fmin(l->x0, l->x1) - radius - m->x0, m->width);
    const int right = bounded(fmax(l->x0, l->x1) + radius + 1 - m->x0, m->width);
    const int top = bounded(fmin(l->y0, l->y1) - radius - m->y0, m->height);
    const int bottom = bounded(fmax(l->y0, l->y1) + radius + 1 - m->y0, m->height);
    for (int y = top; y < bottom; y++)
        for (int x = left; x < right; x++)
            m->bits[(size_t)y * (size_t)m->width + (size_t)x] |=
                covered_samples(l, radius, m->x0 + x, m->y0 + y);
}

/* Blends the colour `ink`, which covers `samples` samples of a pixel, over the pixel; both have straight
 * alpha. */
static void blend(uint8_t rgba[4], const color *ink, int samples) {
    const int above = (samples * 255 + SAMPLES / 2) / SAMPLES, below = rgba[3] * (255 - above);
    const int whole = above * 255 + below;
    if (above == 0) return;
    for (int k = 0; k < 3; k++)
        rgba[k] = (uint8_t)((ink->rgb[k] * above * 255 + rgba[k] * below + whole / 2) / whole);
    rgba[3] = (uint8_t)((whole + 127) / 255);
}

static int count_bits(uint64_t bits) {
    int count = 0;
    for (; bits; bits &= bits - 1) count++;
    return count;
}

static iso_status draw_lines(iso_image *image, const drawing *d, double radius, const color *ink,
                             iso_error *error) {
    mask m = {0};
    ISO_TRY(create_mask(d, image, radius, &m, error));
    if (!m.bits) return ISO_OK;
    for (int i = 0; i < d->count; i++) mark_line(&m, &d->lines[i], radius);
    for (int y = 0; y < m.height; y++)
        for (int x = 0; x < m.width; x++) {
            const uint64_t bits = m.bits[(size_t)y * (size_t)m.width + (size_t)x];
            const size_t pixel = (size_t)(m.y0 + y) * (size_t)image->width + (size_t)(m.x0 + x);
            if (bits) blend(image->rgba + 4 * pixel, ink, count_bits(bits));
        }
    iso_free(m.bits);
    return ISO_OK;
}

/* ---- sizes */

/* Colours and sizes for one picture; sizes in pixels. */
typedef struct pen {
    iso_image *image;
    color ink, outline;
    double text;   /* height of capital letters */
    double unit;   /* of the vector font */
    double radius; /* half the width of lines */
    double border; /* width of the outline */
} pen;

static pen pen_of(iso_image *image, bool dark) {
    const int side = image->width < image->height ? image->width : image->height;
    pen p = {.image = image, .ink = dark ? WHITE : BLACK, .outline = dark ? BLACK : WHITE};
    p.text = fmax(9, side * 0.024);
    p.unit = p.text / ISO_FONT_HEIGHT;
    p.radius = fmax(0.6, 0.4 * p.unit);
    p.border = fmax(1, 0.45 * p.unit);
    return p;
}

/* Draws lines with their outline. */
static iso_status draw_outlined(const pen *p, const drawing *d, double radius, const color *ink,
                                iso_error *error) {
    ISO_TRY(draw_lines(p->image, d, radius + p->border, &p->outline, error));
    return draw_lines(p->image, d, radius, ink, error);
}

/* Adds a text centred at (x, y). */
static void add_text(drawing *d, const pen *p, const char *text, double x, double y) {
    iso_font_line lines[LINES];
    const int count = iso_font_lines(text, lines, LINES);
    const double left = x - 0.5 * iso_font_width(text) * p->unit, top = y - 0.5 * p->text;
    for (int i = 0; i < count && i < LINES; i++)
        add_line(d, left + lines[i].x0 * p->unit, top + lines[i].y0 * p->unit, left + lines[i].x1 * p->unit,
                 top + lines[i].y1 * p->unit);
}

/* ---- the scale bar */

double iso_scale_bar_length(const iso_camera *camera, int width, int height) {
    const double wanted = iso_camera_mm_per_pixel(camera, height) * width / 5;
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

static const struct {
    const char *name;
    double millimetres;
} length_units[ISO_UNITS] = {
    [ISO_UNIT_AUTO] = {"", 0},    [ISO_UNIT_NONE] = {"", 0},  [ISO_UNIT_NM] = {"nm", 1e-6},
    [ISO_UNIT_UM] = {"um", 1e-3}, [ISO_UNIT_MM] = {"mm", 1},  [ISO_UNIT_CM] = {"cm", 10},
    [ISO_UNIT_M] = {"m", 1e3},    [ISO_UNIT_KM] = {"km", 1e6}};

const char *iso_length_unit_name(const iso_length_style *style) {
    if (style->unit != ISO_UNIT_AUTO) return length_units[style->unit].name;
    const char *suffix = iso_world_unit_suffix(style->world);
    return suffix + (*suffix == ' ');
}

double iso_length_factor(const iso_length_style *style) {
    const double to = length_units[style->unit].millimetres, from = iso_world_unit_millimetres(style->world);
    return to > 0 && from > 0 ? from / to : 1;
}

void iso_scale_bar_label(double length, const iso_length_style *style, char label[32]) {
    static const iso_length_unit sizes[] = {ISO_UNIT_KM, ISO_UNIT_M, ISO_UNIT_MM, ISO_UNIT_UM, ISO_UNIT_NM};
    const double millimetres = length * iso_world_unit_millimetres(style->world);
    iso_length_style shown = *style;
    if (style->unit == ISO_UNIT_AUTO && millimetres > 0) {
        int size = 0;
        while (size < 4 &&
               millimetres <
                   (sizes[size] == ISO_UNIT_MM ? 0.1 : length_units[sizes[size]].millimetres) * (1 - 1e-9))
            size++;
        shown.unit = sizes[size];
    }
    const char *name = iso_length_unit_name(&shown);
    snprintf(label, 32, "%.10g%s%s", length * iso_length_factor(&shown), *name ? " " : "", name);
}

static iso_status draw_scale_bar(const pen *p, const iso_annotation *a, iso_error *error) {
    const iso_camera *camera = a->camera;
    const int width = p->image->width, height = p->image->height;
    const double length = iso_scale_bar_length(camera, width, height);
    if (!(length > 0)) return ISO_OK;
    char label[32];
    iso_scale_bar_label(length, &a->lengths, label);
    const double pixels = length / iso_camera_mm_per_pixel(camera, height);
    const double text = iso_font_width(label) * p->unit; /* the label may be wider than the bar */
    const double right = width - 1.2 * p->text - fmax(0, 0.5 * (text - pixels)), left = right - pixels;
    const double y = height - 1.5 * p->text, tick = 0.4 * p->text;
    drawing d = {.count = 0};
    add_line(&d, left, y, right, y);
    add_line(&d, left, y - tick, left, y + tick);
    add_line(&d, right, y - tick, right, y + tick);
    add_text(&d, p, label, 0.5 * (left + right), y - 1.5 * p->text);
    return draw_outlined(p, &d, p->radius, &p->ink, error);
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

static int make_arms(const iso_annotation *a, const iso_image *image, arm arms[6]) {
    const iso_view view = iso_view_make(a->camera, image->width, image->height);
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
static iso_status draw_axes(const pen *p, const arm arms[6], int count, const double middle[2],
                            iso_error *error) {
    static const color colors[3] = {{{208, 58, 47}}, {{46, 150, 62}}, {{58, 108, 216}}};
    for (int layer = 0; layer < 2; layer++)
        for (int i = 0; i < count; i++) {
            const arm *a = &arms[i];
            const double radius = (a->positive ? 1.5 : 0.9) * p->radius, length = ARM * p->text;
            drawing d = {.count = 0};
            add_line(&d, middle[0], middle[1], middle[0] + a->x * length, middle[1] + a->y * length);
            ISO_TRY(layer ? draw_lines(p->image, &d, radius, &colors[a->axis], error)
                          : draw_lines(p->image, &d, radius + p->border, &p->outline, error));
        }
    return ISO_OK;
}

static iso_status draw_marker(const pen *p, const iso_annotation *a, iso_error *error) {
    arm arms[6];
    const int count = make_arms(a, p->image, arms);
    const double middle[2] = {5 * p->text, p->image->height - 5 * p->text};
    drawing letters = {.count = 0};
    double x = 0, y = 0;
    for (int i = 0; i < count; i++)
        if (!is_covered(p, arms, count, i) && letter_of(p, &arms[i], &x, &y))
            add_text(&letters, p, arms[i].letter, middle[0] + x, middle[1] + y);
    ISO_TRY(draw_axes(p, arms, count, middle, error));
    return draw_outlined(p, &letters, p->radius, &p->ink, error);
}

/* ---- colour bars */

enum { BAR_LABELS = 3 };

/* Fills a rectangle of pixels with the colours of a map, the highest at the top. */
static void fill_bar(iso_image *image, const iso_color_bar *bar, int left, int right, int top, int bottom) {
    iso_color_bar unit = *bar;
    unit.low = 0;
    unit.high = 1;
    for (int y = top; y < bottom; y++) {
        const iso_rgb c = iso_color_bar_at(&unit, 1 - (y + 0.5 - top) / (bottom - top));
        for (int x = left; x < right; x++) {
            uint8_t *rgba = image->rgba + 4 * ((size_t)y * (size_t)image->width + (size_t)x);
            rgba[0] = c.r, rgba[1] = c.g, rgba[2] = c.b, rgba[3] = 255;
        }
    }
}

/* Adds the numbers at both ends and in the middle of a bar, right-aligned at `right`. Returns the width of
 * the widest. */
static double add_labels(drawing *d, const pen *p, const iso_color_bar *bar, double right, double top,
                         double bottom) {
    double widest = 0;
    for (int i = 0; i < BAR_LABELS; i++) {
        const double part = (double)i / (BAR_LABELS - 1), y = bottom + (top - bottom) * part;
        char label[32];
        snprintf(label, sizeof label, "%.4g", bar->low + (bar->high - bar->low) * part);
        const double width = iso_font_width(label) * p->unit;
        add_line(d, right + 0.3 * p->text, y, right + 0.6 * p->text, y);
        add_text(d, p, label, right - width / 2, y);
        widest = fmax(widest, width);
    }
    return widest;
}

/* Adds words, as many as a title has room for, that begin at x or end there; returns their
 * width. */
static double add_words(drawing *d, const pen *p, const char *words, double x, bool end_there, double y) {
    char letters[ISO_COLOR_BAR_TITLE];
    snprintf(letters, sizeof letters, "%s", words);
    for (char *c = letters; *c; c++)
        if (*c == 'u') *c = ISO_FONT_U;
    const double width = iso_font_width(letters) * p->unit;
    if (*letters) add_text(d, p, letters, end_there ? x - width / 2 : x + width / 2, y);
    return width;
}

static void add_box(drawing *d, double left, double top, double right, double bottom) {
    add_line(d, left, top, right, top);
    add_line(d, right, top, right, bottom);
    add_line(d, right, bottom, left, bottom);
    add_line(d, left, bottom, left, top);
}

/* Draws a bar whose right end is *right, and moves *right to the left of it. */
static iso_status draw_color_bar(const pen *p, const iso_color_bar *bar, double *right, iso_error *error) {
    const double top = 0.25 * p->image->height, bottom = 0.75 * p->image->height, left = *right - p->text;
    const int x0 = bounded(left, p->image->width), x1 = bounded(*right, p->image->width);
    drawing frame = {.count = 0}, labels = {.count = 0};
    add_box(&frame, left, top, *right, bottom);
    const double widest = add_labels(&labels, p, bar, left - 0.8 * p->text, top, bottom);
    ISO_TRY(draw_outlined(p, &frame, p->radius, &p->ink, error));
    fill_bar(p->image, bar, x0, x1, bounded(top, p->image->height), bounded(bottom, p->image->height));
    const double room = add_words(&labels, p, bar->title, *right, true, top - 1.9 * p->text);
    *right -= fmax(3 * p->text + widest, room > 0 ? room + p->text : 0);
    return draw_outlined(p, &labels, p->radius, &p->ink, error);
}

/* ---- the legend */

static void fill_swatch(iso_image *image, iso_rgb c, double left, double top, double side) {
    const int x0 = bounded(left, image->width), x1 = bounded(left + side, image->width),
              y0 = bounded(top, image->height), y1 = bounded(top + side, image->height);
    for (int y = y0; y < y1; y++)
        for (int x = x0; x < x1; x++) {
            uint8_t *rgba = image->rgba + 4 * ((size_t)y * (size_t)image->width + (size_t)x);
            rgba[0] = c.r, rgba[1] = c.g, rgba[2] = c.b, rgba[3] = 255;
        }
}

/* Draws an entry with its top left corner at (x, y); returns its width. */
static iso_status draw_entry(const pen *p, const iso_legend_entry *entry, double x, double y, double *width,
                             iso_error *error) {
    const double side = p->text;
    drawing frame = {.count = 0}, name = {.count = 0};
    add_box(&frame, x, y, x + side, y + side);
    *width = 1.6 * side + add_words(&name, p, entry->name, x + 1.6 * side, false, y + side / 2);
    ISO_TRY(draw_outlined(p, &frame, p->radius, &p->ink, error));
    fill_swatch(p->image, entry->color, x, y, side);
    return draw_outlined(p, &name, p->radius, &p->ink, error);
}

/* Columns that do not fit beside each other are left out. */
static iso_status draw_legend(const pen *p, const iso_annotation *a, iso_error *error) {
    const double step = 1.7 * p->text, margin = 1.2 * p->text;
    const int rows = (int)fmax(1, (p->image->height - 2 * margin) / step);
    double left = margin, widest = 0;
    for (int i = 0; i < a->legend_count; i++) {
        if (i && i % rows == 0) left += widest + 1.5 * p->text, widest = 0;
        if (left > p->image->width - margin) return ISO_OK;
        double width;
        ISO_TRY(draw_entry(p, &a->legend[i], left, margin + i % rows * step, &width, error));
        widest = fmax(widest, width);
    }
    return ISO_OK;
}

bool iso_is_dark(iso_rgb background, bool transparent) {
    const iso_rgb c = background;
    return !transparent && 299 * c.r + 587 * c.g + 114 * c.b < 128 * 1000;
}

iso_status iso_annotate(iso_image *image, const iso_annotation *annotation, iso_error *error) {
    const pen p = pen_of(image, annotation->dark);
    if (annotation->orientation_marker) ISO_TRY(draw_marker(&p, annotation, error));
    if (annotation->legend_count) ISO_TRY(draw_legend(&p, annotation, error));
    double right = image->width - 1.2 * p.text;
    for (int i = 0; i < annotation->color_bar_count; i++)
        ISO_TRY(draw_color_bar(&p, &annotation->color_bars[i], &right, error));
    return annotation->scale_bar ? draw_scale_bar(&p, annotation, error) : ISO_OK;
}
