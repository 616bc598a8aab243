/* paint: draws the marks of a drawing onto pixels, with 64 samples a pixel. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "image/drawing.h"
#include "image/font.h"

enum { SIDE = 8, SAMPLES = SIDE * SIDE };

typedef iso_edge edge;

/* A rectangle of pixels with the corner (x0, y0); in each pixel, bit s is set if sample s is covered. */
typedef struct mask {
    uint64_t *bits;
    int x0, y0, width, height;
} mask;

static int bounded(double value, int most) {
    return value <= 0 ? 0 : value >= most ? most : (int)value;
}

/* The pixels of a picture that are within `radius` of edges; without bits. */
static mask rectangle(const edge *edges, int count, const iso_image *image, double radius) {
    double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
    for (int i = 0; i < count; i++) {
        const edge *e = &edges[i];
        low[0] = fmin(low[0], fmin(e->x0, e->x1));
        low[1] = fmin(low[1], fmin(e->y0, e->y1));
        high[0] = fmax(high[0], fmax(e->x0, e->x1));
        high[1] = fmax(high[1], fmax(e->y0, e->y1));
    }
    mask m = {.x0 = bounded(low[0] - radius, image->width), .y0 = bounded(low[1] - radius, image->height)};
    m.width = bounded(high[0] + radius + 1, image->width) - m.x0;
    m.height = bounded(high[1] + radius + 1, image->height) - m.y0;
    return m;
}

/* ---- what is near an edge */

static double distance_squared(const edge *l, double x, double y) {
    const double dx = l->x1 - l->x0, dy = l->y1 - l->y0, length = dx * dx + dy * dy;
    double t = length > 0 ? ((x - l->x0) * dx + (y - l->y0) * dy) / length : 0;
    t = t < 0 ? 0 : t > 1 ? 1 : t;
    const double ex = x - (l->x0 + t * dx), ey = y - (l->y0 + t * dy);
    return ex * ex + ey * ey;
}

/* Returns which samples of pixel (x, y) are within `radius` of a line. */
static uint64_t near_samples(const edge *l, double radius, int x, int y) {
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

static void mark_line(mask *m, const edge *l, double radius) {
    const int left = bounded(fmin(l->x0, l->x1) - radius - m->x0, m->width);
    const int right = bounded(fmax(l->x0, l->x1) + radius + 1 - m->x0, m->width);
    const int top = bounded(fmin(l->y0, l->y1) - radius - m->y0, m->height);
    const int bottom = bounded(fmax(l->y0, l->y1) + radius + 1 - m->y0, m->height);
    for (int y = top; y < bottom; y++)
        for (int x = left; x < right; x++)
            m->bits[(size_t)y * (size_t)m->width + (size_t)x] |=
                near_samples(l, radius, m->x0 + x, m->y0 + y);
}

/* ---- what is inside of edges */

/* Where a row of samples crosses an edge, and whether that goes down or up. */
typedef struct crossing {
    double x;
    int turn;
} crossing;

static int compare_crossings(const void *a, const void *b) {
    const crossing *p = a, *q = b;
    return p->x != q->x ? (p->x > q->x) - (p->x < q->x) : p->turn - q->turn;
}

/* Marks the samples from x = `from` to `to` of the row of samples `row` within the row of pixels `y`. */
static void mark_span(mask *m, int y, int row, double from, double to) {
    /* the first sample with centre >= from, and the first one >= to, in samples from the mask's left */
    const int most = m->width * SIDE;
    const int first = bounded(ceil((from - m->x0) * SIDE - 0.5), most),
              end = bounded(ceil((to - m->x0) * SIDE - 0.5), most);
    uint64_t *bits = m->bits + (size_t)y * (size_t)m->width;
    for (int s = first; s < end; s++) bits[s / SIDE] |= (uint64_t)1 << (row * SIDE + s % SIDE);
}

/* crossings: with room for one of each edge. */
static void fill(mask *m, const edge *edges, int count, crossing *crossings) {
    for (int sample = 0; sample < m->height * SIDE; sample++) {
        const double y = m->y0 + (sample + 0.5) / SIDE;
        int found = 0;
        for (int i = 0; i < count; i++) {
            const edge *e = &edges[i];
            if ((e->y0 <= y) == (e->y1 <= y)) continue;
            crossings[found++] =
                (crossing){e->x0 + (y - e->y0) / (e->y1 - e->y0) * (e->x1 - e->x0), e->y0 <= y ? 1 : -1};
        }
        qsort(crossings, (size_t)found, sizeof *crossings, compare_crossings);
        for (int i = 0, winding = 0; i + 1 < found; i++) {
            winding += crossings[i].turn;
            if (winding) mark_span(m, sample / SIDE, sample % SIDE, crossings[i].x, crossings[i + 1].x);
        }
    }
}

/* ---- blending */

/* Blends a colour, which covers `samples` samples of a pixel, over the pixel; both have straight alpha. */
static void blend(uint8_t rgba[4], const uint8_t ink[3], int above) {
    const int below = rgba[3] * (255 - above), whole = above * 255 + below;
    if (above == 0) return;
    for (int k = 0; k < 3; k++)
        rgba[k] = (uint8_t)((ink[k] * above * 255 + rgba[k] * below + whole / 2) / whole);
    rgba[3] = (uint8_t)((whole + 127) / 255);
}

static int count_bits(uint64_t bits) {
    int count = 0;
    for (; bits; bits &= bits - 1) count++;
    return count;
}

static void blend_mask(iso_image *image, const mask *m, iso_rgb color) {
    const uint8_t ink[3] = {color.r, color.g, color.b};
    for (int y = 0; y < m->height; y++)
        for (int x = 0; x < m->width; x++) {
            const uint64_t bits = m->bits[(size_t)y * (size_t)m->width + (size_t)x];
            const size_t pixel = (size_t)(m->y0 + y) * (size_t)image->width + (size_t)(m->x0 + x);
            if (bits) blend(image->rgba + 4 * pixel, ink, (count_bits(bits) * 255 + SAMPLES / 2) / SAMPLES);
        }
}

/* Draws what is inside of edges, if `inside`, and what is within `radius` of them: in bands of rows, which
 * bound the memory of long lines. */
static iso_status draw(iso_image *image, const edge *edges, int count, bool inside, double radius,
                       iso_rgb color, iso_error *error) {
    enum { BAND = 64 };
    mask m = rectangle(edges, count, image, radius);
    const int bottom = m.y0 + m.height;
    if (m.width <= 0 || m.height <= 0) return ISO_OK;
    crossing *crossings = iso_alloc((size_t)count * sizeof *crossings);
    m.bits = iso_alloc((size_t)m.width * BAND * sizeof *m.bits);
    for (; m.bits && crossings && m.y0 < bottom; m.y0 += BAND) {
        m.height = bottom - m.y0 < BAND ? bottom - m.y0 : BAND;
        memset(m.bits, 0, (size_t)m.width * (size_t)m.height * sizeof *m.bits);
        if (inside) fill(&m, edges, count, crossings);
        for (int i = 0; i < count && radius > 0; i++) mark_line(&m, &edges[i], radius);
        blend_mask(image, &m, color);
    }
    const bool done = m.bits && crossings;
    iso_free(crossings);
    iso_free(m.bits);
    return done ? ISO_OK : iso_fail(error, ISO_ERR_NOMEM, "out of memory for annotations");
}

/* ---- edges of marks */

/* The outlines of a text in pixels: *edges, to be freed; returns their number, or -1 without memory. */
static int text_edges(const iso_mark *mark, edge **edges) {
    const double unit = mark->size / ISO_FONT_SIZE;
    const int steps = mark->size < 40 ? 4 : 8;
    int count = 0, room = 0;
    double x = mark->x;
    const char *at = mark->text;
    *edges = NULL;
    for (uint32_t c = iso_font_next(&at); c; c = iso_font_next(&at)) {
        iso_font_edge glyph_edges[ISO_FONT_EDGES];
        const int glyph = iso_font_glyph(c), more = iso_font_outline(glyph, steps, glyph_edges);
        if (count + more > room) {
            room = 2 * (count + more);
            edge *grown = realloc(*edges, (size_t)room * sizeof *grown);
            if (!grown) {
                free(*edges);
                return -1;
            }
            *edges = grown;
        }
        for (int i = 0; i < more; i++) {
            const iso_font_edge *e = &glyph_edges[i];
            (*edges)[count++] =
                (edge){x + e->x0 * unit, mark->y - e->y0 * unit, x + e->x1 * unit, mark->y - e->y1 * unit};
        }
        x += iso_font_advance(glyph) * unit;
    }
    return count;
}

static int point_edges(const iso_mark *mark, edge **edges) {
    const bool closed = mark->kind == ISO_MARK_POLYGON;
    const int count = closed ? mark->point_count : mark->point_count / 2;
    *edges = malloc((size_t)count * sizeof **edges + 1);
    for (int i = 0; *edges && i < count; i++) {
        const double *a = mark->points[closed ? i : 2 * i],
                     *b = mark->points[closed ? (i + 1) % count : 2 * i + 1];
        (*edges)[i] = (edge){a[0], a[1], b[0], b[1]};
    }
    return *edges ? count : -1;
}

int iso_mark_edges(const iso_mark *mark, iso_edge **edges) {
    return mark->kind == ISO_MARK_TEXT ? text_edges(mark, edges) : point_edges(mark, edges);
}

static iso_status paint_edges(const iso_mark *mark, iso_image *image, iso_error *error) {
    const bool inside = mark->kind != ISO_MARK_LINES;
    const double bold = mark->kind == ISO_MARK_TEXT && mark->bold ? ISO_FONT_BOLD * mark->size : 0;
    const double radius = inside ? 0.5 * bold : 0.5 * mark->width;
    edge *edges;
    const int count = iso_mark_edges(mark, &edges);
    if (count < 0) return iso_fail(error, ISO_ERR_NOMEM, "out of memory for annotations");
    iso_status status = ISO_OK;
    if (mark->halo > 0)
        status = draw(image, edges, count, inside, radius + mark->halo, mark->halo_color, error);
    if (status == ISO_OK) status = draw(image, edges, count, inside, radius, mark->color, error);
    free(edges);
    return status;
}

static void paint_picture(const iso_mark *mark, iso_image *image) {
    const iso_image *from = &mark->picture;
    const int x0 = bounded(mark->left, image->width), x1 = bounded(mark->right, image->width),
              y0 = bounded(mark->top, image->height), y1 = bounded(mark->bottom, image->height);
    const int left = (int)floor(mark->left), top = (int)floor(mark->top);
    const int width = (int)floor(mark->right) - left, height = (int)floor(mark->bottom) - top;
    for (int y = y0; y < y1; y++)
        for (int x = x0; x < x1; x++) {
            const size_t column = (size_t)((int64_t)(x - left) * from->width / width),
                         row = (size_t)((int64_t)(y - top) * from->height / height);
            const uint8_t *p = from->rgba + 4 * (row * (size_t)from->width + column);
            uint8_t *to = image->rgba + 4 * ((size_t)y * (size_t)image->width + (size_t)x);
            for (int k = 0; k < 4; k++) to[k] = p[k];
        }
}

iso_status iso_drawing_paint(const iso_drawing *drawing, iso_image *image, iso_error *error) {
    ISO_TRY(iso_drawing_check(drawing, error));
    for (int i = 0; i < drawing->count; i++)
        if (drawing->marks[i].kind == ISO_MARK_PICTURE)
            paint_picture(&drawing->marks[i], image);
        else
            ISO_TRY(paint_edges(&drawing->marks[i], image, error));
    return ISO_OK;
}
