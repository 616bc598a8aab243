/* html: the report as one self-contained HTML page: pictures are embedded, and plots are SVG. Without
 * JavaScript only the full-size view of pictures is missing. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "apps/isocompare/report.h"
#include "base/cpu.h"
#include "base/html.h"

/* ---- texts ---- */

static const char *const STYLE[] = {
    ":root{--ink:#1d2330;--soft:#5d6675;--line:#dfe3ea;--page:#f6f7f9;--card:#fff;--best:#e8f3ec;--link:#"
    "2f5fa8}",
    "@media(prefers-color-scheme:dark){:root{--ink:#e6e9ef;--soft:#9aa4b5;--line:#2c3340;--page:#14171d;",
    "--card:#1b2028;--best:#1e3327;--link:#8db4ee}}",
    "*{box-sizing:border-box}body{margin:0;background:var(--page);color:var(--ink);",
    "font:15px/1.5 system-ui,-apple-system,\"Segoe UI\",Roboto,\"Helvetica Neue\",sans-serif}",
    "main{max-width:1440px;margin:0 auto;padding:40px 24px 80px}",
    "h1{font-size:30px;line-height:1.2;margin:0 0 6px;letter-spacing:-.01em;overflow-wrap:anywhere}",
    "h2{font-size:20px;margin:48px 0 4px}h3{font-size:15px;margin:28px 0 10px}",
    "p{margin:6px 0 14px;max-width:76ch}.soft{color:var(--soft)}",
    ".facts{display:flex;flex-wrap:wrap;gap:10px;margin:22px 0 18px;padding:0;list-style:none}",
    ".facts li{background:var(--card);border:1px solid var(--line);border-radius:10px;padding:9px 14px}",
    ".facts b{display:block;font-size:17px;font-weight:600}.facts span{color:var(--soft);font-size:13px}",
    ".legend{display:flex;flex-wrap:wrap;gap:6px 18px;margin:10px 0 0;padding:0;list-style:none}",
    ".legend i{display:inline-block;width:11px;height:11px;border-radius:3px;margin-right:7px}",
    ".row{display:grid;grid-template-columns:repeat(var(--columns),minmax(150px,1fr));gap:14px;margin-top:"
    "14px;",
    "overflow-x:auto}",
    /* side by side only where there is room for all of them */
    "@media(max-width:1350px){.row{grid-template-columns:repeat(auto-fill,minmax(180px,1fr))}}",
    ".key{font-size:13px;color:var(--soft);align-self:end;padding:0 12px 10px 0}.key b{color:var(--ink);",
    "font-weight:600}.key i{display:block;height:10px;border-radius:5px;margin:8px 0 4px;",
    "background:linear-gradient(90deg,#000,#42106e,#9c286a,#e25c32,#fab01a,#fefdbe)}",
    ".key span{display:flex;justify-content:space-between}",
    ".shot{margin:0;background:var(--card);border:1px solid var(--line);border-radius:10px;overflow:hidden}",
    ".shot img{display:block;width:100%;aspect-ratio:1;cursor:zoom-in}.shot img.difference{background:#000}",
    ".shot figcaption{padding:8px 12px 10px;font-size:13px;line-height:1.4}",
    ".shot b{display:block;font-size:14px}.shot figcaption span{color:var(--soft)}",
    ".wide{overflow-x:auto;background:var(--card);border:1px solid var(--line);border-radius:10px}",
    "table{border-collapse:collapse;width:100%;font-size:13.5px;font-variant-numeric:tabular-nums}",
    "th,td{padding:7px 10px;text-align:right;white-space:nowrap;border-top:1px solid var(--line)}",
    "th{font-weight:600;color:var(--soft);border-top:0;white-space:normal;vertical-align:bottom;line-height:"
    "1.3}td:first-child,th:first-child{text-align:left}",
    "tr.new td{border-top:2px solid var(--line)}td.best{background:var(--best);font-weight:600}",
    "td i{display:inline-block;width:9px;height:9px;border-radius:3px;margin-right:7px}",
    ".plots{display:grid;grid-template-columns:repeat(auto-fit,minmax(340px,1fr));gap:14px;margin-top:14px}",
    ".plot{margin:0;background:var(--card);border:1px solid var(--line);border-radius:10px;padding:10px "
    "12px}",
    ".plot figcaption{font-size:13px;font-weight:600}.plot svg{display:block;width:100%}",
    ".grid{stroke:var(--line)}.tick{fill:var(--soft);font-size:11px}",
    "dl{display:grid;grid-template-columns:max-content 1fr;gap:4px 18px;margin:10px 0;font-size:14px}",
    "dt{color:var(--soft)}dd{margin:0;overflow-wrap:anywhere}",
    "code{font:13px ui-monospace,SFMono-Regular,Menlo,Consolas,monospace}",
    "#view{position:fixed;inset:0;display:none;background:#0b0d11f2;color:#fff;cursor:pointer;z-index:9}",
    "#view.open{display:grid;grid-template-rows:auto 1fr;justify-items:center;padding:12px;gap:8px}",
    "#view img{max-width:100%;max-height:calc(100vh - 60px);background:var(--under)}", NULL};

/* A click opens a picture large; further clicks and the space bar flip between it, the truth and their
 * difference. */
static const char *const SCRIPT[] = {
    "const "
    "view=document.getElementById('view'),image=view.querySelector('img'),label=view.querySelector('p');",
    "let list=[],at=0;function show(){image.src=list[at].src;label.textContent=list[at].alt+",
    "(list.length>1?'   (click or space: next, Esc: close)':'   (Esc: close)')}",
    "function next(){at=(at+1)%list.length;show()}",
    "document.querySelectorAll('.shot img').forEach(i=>i.addEventListener('click',()=>{",
    "const set=i.closest('.zoom'),name=i.dataset.method;",
    "list=[i,...[...set.querySelectorAll('.shot img')].filter(o=>o!==i&&",
    "(o.dataset.method===name||(o.dataset.truth&&name)))];at=0;view.classList.add('open');show()}));",
    "view.addEventListener('click',next);document.addEventListener('keydown',e=>{",
    "if(!view.classList.contains('open'))return;if(e.key==='Escape')view.classList.remove('open');",
    "if(e.key===' '){e.preventDefault();next()}});",
    NULL};

static void put_lines(FILE *stream, const char *const *lines) {
    for (; *lines; lines++) fprintf(stream, "%s\n", *lines);
}

static const char *zoom_title(int zoom) {
    return zoom == 1 ? "Fit" : zoom == 4 ? "4 times" : "16 times";
}

void isocompare_put_milliseconds(FILE *stream, double seconds) {
    double ms = 1e3 * seconds;
    fprintf(stream, ms >= 100 ? "%.0f" : ms >= 10 ? "%.1f" : "%.2f", ms);
}

void isocompare_put_amount(FILE *stream, double value, const char *unit) {
    static const char *const prefixes[] = {"", "k", "M", "G", "T"};
    int prefix = 0;
    for (; value >= 1000 && prefix < 4; prefix++) value /= 1000;
    fprintf(stream, prefix ? "%.3g %s%s" : "%.0f %s%s", value, prefixes[prefix], unit);
}

/* Returns the PSNR inside the silhouettes at one sample for each pixel; infinite for equal pictures. */
static double psnr_in(const report_cell *cell) {
    return isocompare_metric_value(iso_metric_find("psnr_in"), &cell->metrics[REPORT_SINGLE]);
}

/* ---- pictures ---- */

static void put_image(FILE *stream, const report_picture *picture, const char *kind, const char *method,
                      const char *alt) {
    fprintf(stream, "<img class=\"%s\" loading=lazy ", kind);
    if (strcmp(kind, "truth") == 0)
        fputs("data-truth=1 ", stream);
    else
        fprintf(stream, "data-method=\"%s\" ", method);
    fprintf(stream, "alt=\"%s\" src=\"data:image/png;base64,", alt);
    iso_html_base64(stream, picture->bytes, picture->size);
    fputs("\">", stream);
}

static void put_shots(const report *r, const report_view *v, FILE *stream) {
    char alt[160], text[40];
    fputs("<div class=row>\n", stream);
    for (int m = 0; m < r->method_count; m++) {
        const iso_renderer *method = r->methods[m];
        const report_cell *cell = &v->cells[m];
        snprintf(alt, sizeof alt, "%s%s, %s", m ? "" : "The truth: ", method->name, zoom_title(v->zoom));
        fputs("<figure class=shot>", stream);
        put_image(stream, &cell->picture, m ? "drawn" : "truth", method->name, alt);
        fprintf(stream, "<figcaption><b>%s</b>", method->name);
        if (m)
            fprintf(stream, "%s<br>FLIP %.4f<br>IoU %.4f<br>",
                    isocompare_metric_text(psnr_in(cell), "%.2f dB", text, sizeof text),
                    cell->metrics[REPORT_SINGLE].flip,
                    isocompare_metric_value(iso_metric_find("iou"), &cell->metrics[REPORT_SINGLE]));
        else
            fputs("the truth<br>", stream);
        fprintf(stream, "<span>%s, ", method->title);
        isocompare_put_milliseconds(stream, cell->seconds);
        fputs(" ms</span></figcaption></figure>\n", stream);
    }
    fputs("</div>\n<div class=row>\n<div class=key><b>What differs</b> from the truth, as FLIP sees it<i></i>"
          "<span><span>0</span><span>1</span></span></div>\n",
          stream);
    for (int m = 1; m < r->method_count; m++) {
        snprintf(alt, sizeof alt, "What differs: %s, %s", r->methods[m]->name, zoom_title(v->zoom));
        fputs("<figure class=shot>", stream);
        put_image(stream, &v->cells[m].difference, "difference", r->methods[m]->name, alt);
        fprintf(stream, "<figcaption>%s against the truth</figcaption></figure>\n", r->methods[m]->name);
    }
    fputs("</div>\n", stream);
}

static void put_pictures(const report *r, FILE *stream) {
    fputs(
        "<h2>Pictures</h2>\n<p class=soft>One sample a pixel. Click a picture to see it large, and again to "
        "flip between it, the truth and what differs.</p>\n",
        stream);
    for (int z = 0; z < REPORT_ZOOMS; z++) {
        const report_view *v = &r->views[z];
        fprintf(stream, "<section class=zoom><h3>%s: %.3g pixels a voxel</h3>\n", zoom_title(v->zoom),
                v->pixels_per_voxel);
        put_shots(r, v, stream);
        fputs("</section>\n", stream);
    }
}

/* ---- tables ---- */

/* A column of the tables: a metric with a short title. */
typedef struct column {
    const char *title, *metric, *format;
} column;

static const column COLUMNS[] = {{"PSNR inside, dB", "psnr_in", "%.2f"},
                                 {"PSNR, dB", "psnr", "%.2f"},
                                 {"error, p99", "error_p99", "%.0f"},
                                 {"SSIM", "ssim", "%.4f"},
                                 {"FLIP", "flip", "%.4f"},
                                 {"IoU", "iou", "%.4f"},
                                 {"dilation, voxels", "dilation_mean_voxel", "%+.3f"},
                                 {"p99, px", "dilation_p99", "%.1f"},
                                 {"largest, px", "dilation_max", "%.1f"},
                                 {"holes, %", "holes", "%.3f"},
                                 {"normals, °", "normal_error_deg", "%.2f"},
                                 {"depth, voxels", "depth_error_voxel", "%.4f"},
                                 {"wrong, %", "wrong", "%.2f"},
                                 {"pixels differing", "pixels_differing", "%.0f"}};
enum { COLUMN_COUNT = sizeof COLUMNS / sizeof *COLUMNS };

/* Returns whether any view has a value of a metric. Metrics of depth and normals exist only for one sample
 * for each pixel. */
static bool has_column(const report *r, report_sampling sampling, const iso_metric *metric) {
    for (int z = 0; z < REPORT_ZOOMS; z++)
        for (int m = 1; m < r->method_count; m++)
            if (!isnan(iso_metric_value(metric, &r->views[z].cells[m].metrics[sampling]))) return true;
    return false;
}

/* Returns whether a value is the best of all methods; signed values are compared by magnitude. */
static bool is_best(const report *r, const report_view *v, report_sampling sampling, const iso_metric *metric,
                    double value) {
    for (int m = 1; m < r->method_count; m++) {
        double other = iso_metric_value(metric, &v->cells[m].metrics[sampling]);
        if (!isnan(other) && iso_metric_is_worse(metric, value, fabs(other))) return false;
    }
    return r->method_count > 2 && !isnan(value);
}

static void put_cell(const report *r, const report_view *v, int method, report_sampling sampling,
                     const column *c, FILE *stream) {
    const iso_metric *metric = iso_metric_find(c->metric);
    double value = isocompare_metric_value(metric, &v->cells[method].metrics[sampling]);
    if (!has_column(r, sampling, metric)) return;
    fputs(is_best(r, v, sampling, metric, value) ? "<td class=best>" : "<td>", stream);
    char text[40];
    fputs(isnan(value) ? "–" : isocompare_metric_text(value, c->format, text, sizeof text), stream);
    fputs("</td>", stream);
}

static void put_table(const report *r, report_sampling sampling, FILE *stream) {
    fputs("<div class=wide><table><thead><tr><th>method</th><th>zoom</th>", stream);
    for (int i = 0; i < COLUMN_COUNT; i++)
        if (has_column(r, sampling, iso_metric_find(COLUMNS[i].metric)))
            fprintf(stream, "<th>%s</th>", COLUMNS[i].title);
    fputs("</tr></thead><tbody>\n", stream);
    for (int z = 0; z < REPORT_ZOOMS; z++)
        for (int m = 1; m < r->method_count; m++) {
            fprintf(stream, "<tr%s><td><i style=\"background:%s\"></i>%s</td><td>%s</td>",
                    m == 1 && z ? " class=new" : "", isocompare_method_color(m), r->methods[m]->name,
                    zoom_title(r->views[z].zoom));
            for (int i = 0; i < COLUMN_COUNT; i++)
                put_cell(r, &r->views[z], m, sampling, &COLUMNS[i], stream);
            fputs("</tr>\n", stream);
        }
    fputs("</tbody></table></div>\n", stream);
}

static void put_extraction(const report *r, FILE *stream) {
    fputs("<h2>Time and memory</h2>\n<p class=soft>Extraction is what is done once for a volume and an "
          "isovalue, here for the first time; a frame is what is done for every view, shading included "
          "(median of three).</p>\n"
          "<div class=wide><table><thead><tr><th>extraction</th><th>ms</th><th>primitives</th>"
          "<th>memory</th></tr></thead><tbody>\n",
          stream);
    for (int part = 0; part < ISO_PART_COUNT; part++) {
        const report_part *p = &r->parts[part];
        if (!p->made) continue;
        fprintf(stream, "<tr><td>%s</td><td>", iso_part_name((iso_part)part));
        isocompare_put_milliseconds(stream, p->seconds);
        fputs("</td><td>", stream);
        if (p->size.primitives) isocompare_put_amount(stream, (double)p->size.primitives, "");
        fputs("</td><td>", stream);
        if (p->size.bytes) isocompare_put_amount(stream, (double)p->size.bytes, "B");
        fputs("</td></tr>\n", stream);
    }
    fputs("</tbody></table></div>\n<h3>Frames</h3>\n<div class=wide><table><thead><tr><th>method</th>",
          stream);
    for (int z = 0; z < REPORT_ZOOMS; z++)
        fprintf(stream, "<th>%s, ms</th><th>memory</th>", zoom_title(r->views[z].zoom));
    fputs("</tr></thead><tbody>\n", stream);
    for (int m = 0; m < r->method_count; m++) {
        fprintf(stream, "<tr><td><i style=\"background:%s\"></i>%s</td>", isocompare_method_color(m),
                r->methods[m]->name);
        for (int z = 0; z < REPORT_ZOOMS; z++) {
            const report_cell *cell = &r->views[z].cells[m];
            fputs("<td>", stream);
            isocompare_put_milliseconds(stream, cell->seconds);
            fputs("</td><td>", stream);
            if (cell->memory)
                isocompare_put_amount(stream, (double)cell->memory, "B");
            else
                fputs("–", stream);
            fputs("</td>", stream);
        }
        fputs("</tr>\n", stream);
    }
    fputs("</tbody></table></div>\n", stream);
}

/* ---- transparency ---- */

/* Returns the root mean square of the differences, 0 .. 255, at the largest opacity. */
static double levels_of(const report *r, iso_compositing compositing) {
    const double psnr = r->transparency.psnr[compositing][ISO_TRANSPARENCY_OPACITIES - 1];
    return 255 / pow(10, isocompare_psnr_value(psnr) / 20);
}

/* Writes the text that explains the translucent pictures and the table. */
static void put_transparency_text(const report *r, FILE *stream) {
    const iso_transparency_study *study = &r->transparency;
    char layers[40];
    fprintf(stream,
            "<h2>Transparency</h2>\n<p class=soft>The fit view with a translucent surface, %d × %d pixels. "
            "The surface stops the same share of the light at every angle. PSNR is over the whole picture; "
            "the truth is every crossing of the rays, composited in order. Average colour and weighted "
            "blending are given the same crossings: only their compositing differs. Splats are points, "
            "which differ in shape too.</p>\n",
            r->transparency_side, r->transparency_side);
    fprintf(stream,
            "<p>A covered pixel has %s layers on average, and up to %d. <b>exact</b> has another number of "
            "layers than the truth in %zu, %zu and %zu of %zu pixels (at the three opacities). ",
            isocompare_metric_text(study->mean_layers, "%.2f", layers, sizeof layers), study->most_layers,
            study->wrong_layers[0], study->wrong_layers[1], study->wrong_layers[2], study->covered);
    fprintf(stream,
            "At opacity 0.7 its colours are off by %.2g of 255 levels (root mean square); without order "
            "they are off by %.2g with average colour, which VTK draws unless depth peeling is on, and by "
            "%.2g with weighted blending.</p>\n",
            levels_of(r, ISO_COMPOSITING_EXACT), levels_of(r, ISO_COMPOSITING_AVERAGE),
            levels_of(r, ISO_COMPOSITING_WEIGHTED));
}

static void put_transparency(const report *r, FILE *stream) {
    char text[40];
    put_transparency_text(r, stream);
    fputs("<div class=wide><table><thead><tr><th>compositing</th>", stream);
    for (int i = 0; i < ISO_TRANSPARENCY_OPACITIES; i++)
        fprintf(stream, "<th>opacity %.1f, dB</th>", ISO_TRANSPARENCY_OPACITY[i]);
    fputs("<th>picture, ms</th></tr></thead><tbody>\n", stream);
    for (int c = 0; c < ISO_COMPOSITINGS; c++) {
        fprintf(stream, "<tr><td>%s: %s</td>", iso_compositing_name((iso_compositing)c),
                iso_compositing_title((iso_compositing)c));
        for (int i = 0; i < ISO_TRANSPARENCY_OPACITIES; i++) {
            const double psnr = isocompare_psnr_value(r->transparency.psnr[c][i]);
            fprintf(stream, "<td>%s</td>", isocompare_metric_text(psnr, "%.2f", text, sizeof text));
        }
        isocompare_put_cell(stream, 1e3 * r->transparency.seconds[c], "");
        fputs("</tr>\n", stream);
    }
    fputs("</tbody></table></div>\n", stream);
}

/* ---- plots ---- */

static double psnr_of(const report *r, int view, int method) {
    return r->views[view].cells[method].metrics[REPORT_SINGLE].psnr_in;
}
static double flip_of(const report *r, int view, int method) {
    return r->views[view].cells[method].metrics[REPORT_SINGLE].flip;
}
static double dilation_of(const report *r, int view, int method) {
    return r->views[view].cells[method].metrics[REPORT_SINGLE].dilation_mean_voxel;
}
static double normal_of(const report *r, int view, int method) {
    return r->views[view].cells[method].metrics[REPORT_SINGLE].normal_error_deg;
}
static double milliseconds_of(const report *r, int view, int method) {
    return 1e3 * r->views[view].cells[method].seconds;
}

static void put_legend(const report *r, FILE *stream) {
    fputs("<ul class=legend>", stream);
    for (int m = 0; m < r->method_count; m++)
        fprintf(stream, "<li><i style=\"background:%s\"></i>%s: %s</li>", isocompare_method_color(m),
                r->methods[m]->name, r->methods[m]->title);
    fputs("</ul>\n", stream);
}

static void put_plots(const report *r, FILE *stream) {
    static const report_plot plots[] = {
        {"PSNR inside the silhouettes (more is better)", "dB", psnr_of, false, false},
        {"FLIP (less is better)", "", flip_of, false, false},
        {"Dilation of the silhouette (0 is best)", "voxels", dilation_of, false, false},
        {"Error of normals (less is better)", "degrees", normal_of, false, false},
        {"Time of a frame (less is better)", "ms", milliseconds_of, true, true}};
    fputs("<h2>Plots</h2>\n", stream);
    put_legend(r, stream);
    fputs("<div class=plots>\n", stream);
    for (size_t i = 0; i < sizeof plots / sizeof *plots; i++) isocompare_plot_bars(r, &plots[i], stream);
    isocompare_plot_scatter(r, stream);
    fputs("</div>\n", stream);
}

/* ---- program, machine and volume ---- */

static void put_head(const report *r, FILE *stream) {
    fputs("<!doctype html>\n<html lang=en><head><meta charset=utf-8>\n"
          "<meta name=viewport content=\"width=device-width,initial-scale=1\">\n<title>",
          stream);
    iso_html_text(stream, r->model);
    fputs(": methods against the truth</title>\n<style>\n", stream);
    put_lines(stream, STYLE);
    iso_rgb back = r->settings->background;
    fprintf(stream, ":root{--under:#%02x%02x%02x;--columns:%d}.shot img{background:var(--under)}\n", back.r,
            back.g, back.b, r->method_count);
    fputs("</style></head><body><main>\n", stream);
}

static void put_facts(const report *r, FILE *stream) {
    const iso_volume_info *info = &r->loader.volume.info;
    fputs("<h1>", stream);
    iso_html_text(stream, r->model);
    fprintf(
        stream,
        "</h1>\n<p class=soft>Every way to draw one isosurface, against rays through the trilinear field "
        "itself (raycast). For pictures choose exact, isorender's default: it draws that field at any zoom. "
        "Choose mesh to export the surface or to compare with other programs, discs to draw points without "
        "holes, as for files of points and on a GPU, points to see the samples themselves, and raycast, "
        "which is "
        "slow, to check the others.</p>\n<ul class=facts><li><b>%d × %d × %d</b><span>voxels, %s</span></li>",
        info->dims[0], info->dims[1], info->dims[2], iso_type_name(info->type));
    fprintf(stream, "<li><b>%.6g</b><span>isovalue, %s</span></li>", r->surface.isovalue, r->isovalue_from);
    for (int part = 0; part < ISO_PART_COUNT; part++) {
        const report_part *p = &r->parts[part];
        if (!p->made || !p->size.primitives) continue;
        fputs("<li><b>", stream);
        isocompare_put_amount(stream, (double)p->size.primitives, "");
        fprintf(stream, "</b><span>%s</span></li>",
                part == ISO_PART_MESH ? "triangles" : iso_part_name((iso_part)part));
    }
    fprintf(stream, "<li><b>%d × %d</b><span>pixels a picture</span></li></ul>\n", r->settings->side,
            r->settings->side);
}

/* Writes a sentence that names the method nearest to the truth at each zoom. */
static void put_verdict(const report *r, FILE *stream) {
    char text[40];
    fputs("<p>Nearest to the truth, by PSNR inside the silhouettes: ", stream);
    for (int z = 0; z < REPORT_ZOOMS; z++) {
        int best = 1;
        for (int m = 2; m < r->method_count; m++)
            if (psnr_of(r, z, m) > psnr_of(r, z, best)) best = m;
        fprintf(stream, "%s<b>%s</b> at %s (%s)", z ? ", " : "", r->methods[best]->name,
                z ? zoom_title(r->views[z].zoom) : "fit",
                isocompare_metric_text(psnr_in(&r->views[z].cells[best]), "%.1f dB", text, sizeof text));
    }
    fputs(".</p>\n", stream);
}

static void put_run(const report *r, FILE *stream) {
    const iso_volume_info *info = &r->loader.volume.info;
    fprintf(stream,
            "<h2>What was run, and on what</h2>\n<dl><dt>program</dt><dd>%s %s</dd><dt>volume</dt><dd>",
            isocompare_program()->name, isocompare_program()->version);
    iso_html_text(stream, r->loader.input);
    fprintf(stream, " (%s, spacing %.6g × %.6g × %.6g mm)</dd>", info->format, info->transform.spacing[0],
            info->transform.spacing[1], info->transform.spacing[2]);
    for (int i = 0; i < info->note_count; i++) {
        fputs("<dt>note</dt><dd>", stream);
        iso_html_text(stream, info->notes[i]);
        fputs("</dd>", stream);
    }
    fputs("<dt>command</dt><dd><code>isocompare report ", stream);
    iso_html_text(stream, r->model);
    iso_html_text(stream, r->settings->common.record);
    fputs("</code></dd><dt>processor</dt><dd>", stream);
    iso_html_text(stream, r->processor);
    fprintf(stream, ", %s, %d thread%s</dd><dt>memory</dt><dd>", iso_cpu_level_name(iso_cpu_best()),
            iso_pool_threads(r->pool), iso_pool_threads(r->pool) > 1 ? "s" : "");
    isocompare_put_amount(stream, (double)r->peak, "B");
    fputs(" at most, for all of this</dd><dt>view</dt><dd>perspective, 30° at fit, from 34° to the right of "
          "the front and 20° above; the others narrow that view around a spot with silhouettes in "
          "sight</dd></dl>\n",
          stream);
}

static void put_metrics(FILE *stream) {
    static const char *const texts[][2] = {
        {"PSNR inside",
         "over the pixels of either silhouette widened by 2 pixels; 138 dB for equal pictures"},
        {"SSIM", "Wang, Bovik, Sheikh and Simoncelli 2004, of luma"},
        {"FLIP",
         "LDR-FLIP of Andersson et al. 2020, mean over the picture: what one sees flipping between both"},
        {"IoU", "shared part of both silhouettes"},
        {"dilation",
         "area that the silhouette gained, along the truth's border; largest: its farthest pixel"},
        {"holes", "what is open inside the truth's silhouette, 2 pixels and more from its border"},
        {"normals, depth", "mean errors where both are covered and at most 2 voxels apart; wrong: the rest"},
        {"pixels differing", "by more than 1 of 255 in red, green or blue"}};
    fputs("<h2>What the numbers mean</h2>\n<dl>", stream);
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++)
        fprintf(stream, "<dt>%s</dt><dd>%s</dd>", texts[i][0], texts[i][1]);
    fputs("</dl>\n", stream);
}

void isocompare_write_html(const report *r, FILE *stream) {
    put_head(r, stream);
    put_facts(r, stream);
    put_verdict(r, stream);
    put_pictures(r, stream);
    fputs("<h2>Errors</h2>\n<h3>One sample a pixel against the truth's one</h3>\n", stream);
    put_table(r, REPORT_SINGLE, stream);
    fputs("<h3>Four samples a pixel against the truth's sixteen</h3>\n", stream);
    put_table(r, REPORT_FINE, stream);
    put_transparency(r, stream);
    put_plots(r, stream);
    if (r->page) fwrite(r->page, 1, strlen(r->page), stream);
    put_extraction(r, stream);
    isocompare_put_costs(r, stream);
    isocompare_put_points(r, stream);
    put_run(r, stream);
    put_metrics(stream);
    fputs("</main><div id=view><p></p><img alt=\"\"></div>\n<script>\n", stream);
    put_lines(stream, SCRIPT);
    fputs("</script></body></html>\n", stream);
}
