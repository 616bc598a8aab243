/* html_cost: the report's tables of what extraction and frames cost (compare/cost.h), like tables 2 to 4 of
 * Baerentzen and Christensen 2003. */
#include <math.h>

#include "apps/isocompare/report.h"

void isocompare_put_cell(FILE *stream, double value, const char *unit) {
    if (isnan(value))
        fputs("<td>–</td>", stream);
    else
        fprintf(stream, value >= 999.5 ? "<td>%.0f%s</td>" : "<td>%.3g%s</td>", value, unit);
}

static void put_rate(FILE *stream, const iso_cost_frame *frame) {
    isocompare_put_cell(stream, 1 / frame->median, "");
}

static void put_row_head(int number, FILE *stream) {
    fprintf(stream, "<tr><td>%s</td>", iso_cost_method(number)->name);
}

/* Table 2. */
static void put_primitives(const iso_cost_study *study, FILE *stream) {
    fprintf(stream,
            "<h3>Primitives</h3>\n<div class=wide><table><thead><tr><th>method</th><th>primitives</th>"
            "<th>extraction, ms</th><th>frames a second, median</th><th>best run of %d</th></tr></thead>"
            "<tbody>\n",
            ISO_COST_RUNS);
    for (int i = 0; i < ISO_COST_METHODS; i++) {
        const iso_cost_row *row = &study->rows[i];
        put_row_head(i, stream);
        fputs("<td>", stream);
        isocompare_put_amount(stream, (double)row->primitives, "");
        fputs("</td><td>", stream);
        isocompare_put_milliseconds(stream, row->generation);
        fputs("</td>", stream);
        put_rate(stream, &row->still);
        isocompare_put_cell(stream, 1 / row->still.best, "");
        fputs("</tr>\n", stream);
    }
    fprintf(stream,
            "</tbody></table></div>\n<p>As triangle strips the mesh would need %.0f %% of its triangles' "
            "indices (the paper: 45 to 52 %%).</p>\n",
            100 * study->strips);
}

/* Table 3. */
static void put_edits(const iso_cost_study *study, FILE *stream) {
    fprintf(stream,
            "<h3>Edits</h3>\n<p class=soft>Before each frame %d of the %zu bricks that the surface crosses "
            "(of %zu in all) are extracted again.</p>\n<div class=wide><table><thead><tr><th>method</th>"
            "<th>frames a second</th><th>of the rate without edits</th></tr></thead><tbody>\n",
            study->dirty, study->crossed, study->bricks);
    for (int i = 0; i < ISO_COST_METHODS; i++) {
        const iso_cost_row *row = &study->rows[i];
        put_row_head(i, stream);
        put_rate(stream, &row->edited);
        isocompare_put_cell(stream, 100 * row->still.median / row->edited.median, " %");
        fputs("</tr>\n", stream);
    }
    fputs("</tbody></table></div>\n", stream);
}

/* Table 3 with the strokes of the file. */
static void put_strokes(const iso_stroke_cost *cost, FILE *stream) {
    fprintf(
        stream,
        "<h3>Strokes</h3>\n<p class=soft>The %zu strokes of the file, %zu samples, played again: medians. "
        "Editing the field takes ",
        cost->strokes, cost->samples);
    isocompare_put_milliseconds(stream, cost->edit);
    fputs(" ms a sample.</p>\n<div class=wide><table><thead><tr><th>method</th><th>extraction, ms</th>"
          "<th>frame, ms</th><th>samples a second</th></tr></thead><tbody>\n",
          stream);
    for (int i = 0; i < ISO_COST_METHODS; i++) {
        put_row_head(i, stream);
        isocompare_put_cell(stream, 1e3 * cost->rows[i].update, "");
        isocompare_put_cell(stream, 1e3 * cost->rows[i].frame, "");
        isocompare_put_cell(stream, 1 / (cost->edit + cost->rows[i].update + cost->rows[i].frame), "");
        fputs("</tr>\n", stream);
    }
    fputs("</tbody></table></div>\n", stream);
}

/* Table 4. */
static void put_viewports(const iso_cost_study *study, FILE *stream) {
    fputs("<h3>Viewports</h3>\n<div class=wide><table><thead><tr><th>frames a second</th>", stream);
    for (int v = 0; v < ISO_COST_VIEWPORTS; v++)
        fprintf(stream, "<th>%d × %d</th>", ISO_COST_VIEWPORT[v], ISO_COST_VIEWPORT[v]);
    fputs("</tr></thead><tbody>\n", stream);
    for (int i = 0; i < ISO_COST_METHODS; i++) {
        put_row_head(i, stream);
        for (int v = 0; v < ISO_COST_VIEWPORTS; v++) put_rate(stream, &study->rows[i].viewport[v]);
        fputs("</tr>\n", stream);
    }
    fputs("</tbody></table></div>\n", stream);
}

void isocompare_put_costs(const report *r, FILE *stream) {
    fprintf(
        stream,
        "<h2>What primitives cost</h2>\n<p class=soft>The measurements of Bærentzen and Christensen 2003, "
        "section 6, on this volume: points and triangles, and exact beside them. Each frame, of %d × %d "
        "pixels unless said otherwise, is drawn from another direction.</p>\n",
        r->cost.side, r->cost.side);
    put_primitives(&r->cost, stream);
    put_edits(&r->cost, stream);
    if (r->loader.has_strokes) put_strokes(&r->strokes, stream);
    put_viewports(&r->cost, stream);
}
