/* plots: bar charts and the scatter plot of the report as inline SVG. Text and lines get their colours from
 * the page, by CSS class. */
#include <math.h>

#include "apps/isocompare/report.h"

/* Returns the colour of a method. The colours differ clearly in hue and lightness; the truth is grey. */
const char *isocompare_method_color(int method) {
    static const char *const colors[] = {"#8a8f98", "#4477aa", "#ee6677", "#228833", "#ccbb44",
                                         "#66ccee", "#aa3377", "#ee8866", "#44bb99", "#bbcc33"};
    return colors[(size_t)method % (sizeof colors / sizeof *colors)];
}

static const char *zoom_name(int zoom) {
    return zoom == 1 ? "fit" : zoom == 4 ? "4×" : "16×";
}

/* ---- axes ---- */

/* An axis that maps values low .. high to pixels from .. to. */
typedef struct axis {
    double low, high, from, to;
    bool logarithmic;
} axis;

static double place(const axis *a, double value) {
    double at = a->logarithmic ? log10(value / a->low) / log10(a->high / a->low)
                               : (value - a->low) / (a->high - a->low);
    return a->from + at * (a->to - a->from);
}

/* Returns the distance between grid lines for a range of values: 1, 2 or 5 times a power of ten, for about
 * four lines. */
static double grid_step(double range) {
    double power = pow(10, floor(log10(range / 4))), part = range / 4 / power;
    return power * (part < 1.5 ? 1 : part < 3.5 ? 2 : part < 7.5 ? 5 : 10);
}

static void fit_linear(axis *a, double least, double most) {
    a->low = fmin(0, least);
    a->high = fmax(0, most);
    if (a->low == a->high) a->high = 1;
    double step = grid_step(a->high - a->low);
    a->low = floor(a->low / step + 1e-9) * step;
    a->high = ceil(a->high / step - 1e-9) * step;
}

static void fit_logarithmic(axis *a, double least, double most) {
    a->low = pow(10, floor(log10(least)));
    a->high = pow(10, ceil(log10(most)));
    if (a->high == a->low) a->high *= 10;
}

typedef void line_fn(FILE *stream, double at, const char *label);

static void horizontal(FILE *stream, double at, const char *label) {
    fprintf(stream, "<line class=grid x1=46 x2=408 y1=%.1f y2=%.1f />", at, at);
    fprintf(stream, "<text class=tick x=40 y=%.1f text-anchor=end>%s</text>", at + 4, label);
}

static void vertical(FILE *stream, double at, const char *label) {
    fprintf(stream, "<line class=grid x1=%.1f x2=%.1f y1=18 y2=196 />", at, at);
    fprintf(stream, "<text class=tick x=%.1f y=212 text-anchor=middle>%s</text>", at, label);
}

static void draw_lines(FILE *stream, const axis *a, line_fn *line) {
    char label[32];
    if (a->logarithmic) {
        for (double value = a->low; value < a->high * 1.01; value *= 10) {
            snprintf(label, sizeof label, "%g", value);
            line(stream, place(a, value), label);
        }
        return;
    }
    double step = grid_step(a->high - a->low);
    int count = (int)((a->high - a->low) / step + 1.5);
    for (int i = 0; i < count; i++) {
        double value = a->low + i * step;
        snprintf(label, sizeof label, "%g", fabs(value) < step / 2 ? 0 : value);
        line(stream, place(a, value), label);
    }
}

static void begin(FILE *stream, const char *title) {
    fprintf(stream, "<figure class=plot><figcaption>%s</figcaption>", title);
    fprintf(stream, "<svg viewBox=\"0 0 420 232\" role=img aria-label=\"%s\">", title);
}

static void end(FILE *stream) {
    fputs("</svg></figure>\n", stream);
}

/* ---- bars ---- */

static bool find_range(const report *r, const report_plot *plot, double *least, double *most) {
    *least = INFINITY;
    *most = -INFINITY;
    for (int v = 0; v < REPORT_ZOOMS; v++)
        for (int m = plot->with_truth ? 0 : 1; m < r->method_count; m++) {
            double value = plot->value(r, v, m);
            if (!isfinite(value) || (plot->logarithmic && value <= 0)) continue;
            *least = fmin(*least, value);
            *most = fmax(*most, value);
        }
    return *least <= *most;
}

static void draw_bar(FILE *stream, const axis *a, double left, double width, double value,
                     const char *color) {
    double top = place(a, value), base = place(a, a->logarithmic ? a->low : 0);
    double y = fmin(top, base), height = fmax(fabs(top - base), 0.75);
    fprintf(stream,
            "<rect x=%.1f y=%.1f width=%.1f height=%.1f rx=1.5 fill=\"%s\"><title>%.4g</title></rect>", left,
            y, width, height, color, value);
}

void isocompare_plot_bars(const report *r, const report_plot *plot, FILE *stream) {
    double least, most;
    char title[128];
    if (!find_range(r, plot, &least, &most)) return;
    snprintf(title, sizeof title, "%s%s%s", plot->title, plot->unit[0] ? ", " : "", plot->unit);
    begin(stream, title);
    axis a = {.from = 196, .to = 18, .logarithmic = plot->logarithmic};
    if (plot->logarithmic)
        fit_logarithmic(&a, least, most);
    else
        fit_linear(&a, least, most);
    draw_lines(stream, &a, horizontal);
    int first = plot->with_truth ? 0 : 1, bars = r->method_count - first;
    double group = 362.0 / REPORT_ZOOMS, width = group * 0.76 / bars;
    for (int v = 0; v < REPORT_ZOOMS; v++) {
        double left = 46 + group * v;
        for (int m = first; m < r->method_count; m++) {
            double value = plot->value(r, v, m);
            if (!isfinite(value) || (plot->logarithmic && value <= 0)) continue;
            draw_bar(stream, &a, left + group * 0.12 + (m - first) * width, width * 0.9, value,
                     isocompare_method_color(m));
        }
        fprintf(stream, "<text class=tick x=%.1f y=214 text-anchor=middle>%s</text>", left + group / 2,
                zoom_name(r->views[v].zoom));
    }
    end(stream);
}

/* ---- error against time ---- */

void isocompare_plot_scatter(const report *r, FILE *stream) {
    axis x = {.from = 60, .to = 400, .logarithmic = true}, y = {.from = 190, .to = 24};
    double least = INFINITY, slowest = 0, worst = 0;
    for (int v = 0; v < REPORT_ZOOMS; v++)
        for (int m = 0; m < r->method_count; m++) {
            const report_cell *cell = &r->views[v].cells[m];
            least = fmin(least, 1e3 * cell->seconds);
            slowest = fmax(slowest, 1e3 * cell->seconds);
            if (m) worst = fmax(worst, cell->metrics[REPORT_SINGLE].flip);
        }
    if (!(least > 0)) return;
    fit_logarithmic(&x, least, slowest);
    fit_linear(&y, 0, worst);
    begin(stream, "FLIP against milliseconds a frame (circles: fit, squares: 4×, diamonds: 16×)");
    draw_lines(stream, &y, horizontal);
    draw_lines(stream, &x, vertical);
    for (int v = 0; v < REPORT_ZOOMS; v++)
        for (int m = 0; m < r->method_count; m++) {
            const report_cell *cell = &r->views[v].cells[m];
            double px = place(&x, 1e3 * cell->seconds), py = place(&y, m ? cell->metrics[0].flip : 0);
            const char *color = isocompare_method_color(m);
            if (v == 0)
                fprintf(stream, "<circle cx=%.1f cy=%.1f r=5 fill=\"%s\">", px, py, color);
            else
                fprintf(stream, "<rect x=%.1f y=%.1f width=9 height=9 fill=\"%s\"%s>", px - 4.5, py - 4.5,
                        color,
                        v == 2 ? " style=\"transform-box:fill-box;transform-origin:center;"
                                 "transform:rotate(45deg)\""
                               : "");
            fprintf(stream, "<title>%s, %s: %.3g ms</title></%s>", r->methods[m]->name,
                    zoom_name(r->views[v].zoom), 1e3 * cell->seconds, v ? "rect" : "circle");
        }
    end(stream);
}
