/* html_points: the report's tables of what is selected from the points (Guennebaud et al. 2004, table 1) and
 * of splats in groups (Zhang and Pajarola 2006, tables 1 and 2). */
#include "apps/isocompare/report.h"

static void put_selection(const report *r, FILE *stream) {
    fputs(
        "<h3>Selection of points</h3>\n<p class=soft>How many points have to be drawn at all: a point is "
        "left "
        "out if its centre is outside the picture, if the surface hides it, or if another point in the same "
        "pixel is nearer. (Guennebaud et al. 2004, table 1: 70 to 98 % of the points are left out.)</p>\n"
        "<div class=wide><table><thead><tr><th>view</th><th>points</th><th>outside</th><th>hidden</th>"
        "<th>same pixel</th><th>left out in all</th></tr></thead><tbody>\n",
        stream);
    for (int z = 0; z < REPORT_ZOOMS; z++) {
        const iso_visible_points *visible = &r->views[z].visible;
        const size_t out[4] = {visible->outside, visible->hidden, visible->same_pixel,
                               visible->points - visible->seen};
        fprintf(stream, "<tr><td>%d ×</td><td>", r->views[z].zoom);
        isocompare_put_amount(stream, (double)visible->points, "");
        fputs("</td>", stream);
        for (int i = 0; i < 4; i++)
            fprintf(stream, "<td>%.1f %%</td>", 100 * (double)out[i] / (double)visible->points);
        fputs("</tr>\n", stream);
    }
    fputs("</tbody></table></div>\n", stream);
}

static void put_splats(const report *r, FILE *stream) {
    fprintf(stream,
            "<h3>Splats in groups</h3>\n<p class=soft>Splats of one group must not overlap by more than c "
            "allows (1: not at all), so that all groups are drawn in one pass. The mean degree is the number "
            "of splats that a splat may not share a group with. Below: the same splats without groups, from "
            "front to back. Frames of %d × %d pixels. (Zhang and Pajarola 2006, tables 1 and 2: 14 to 19 "
            "groups with c = 1, 5 to 8 with c = .4.)</p>\n<div class=wide><table><thead><tr><th>c</th>"
            "<th>groups</th><th>mean degree</th><th>grouping, ms</th><th>frames a second</th></tr></thead>"
            "<tbody>\n",
            r->cost.side, r->cost.side);
    for (int i = 0; i < ISO_SPLAT_COST_OVERLAPS; i++) {
        fprintf(stream, "<tr><td>%g</td><td>%d</td><td>%.3g</td><td>", ISO_SPLAT_COST_OVERLAP[i],
                r->splats.rows[i].groups, r->splats.rows[i].mean_degree);
        isocompare_put_milliseconds(stream, r->splats.rows[i].grouping);
        fputs("</td>", stream);
        isocompare_put_cell(stream, 1 / r->splats.rows[i].frame, "");
        fputs("</tr>\n", stream);
    }
    fputs("<tr><td>no groups</td><td>–</td><td>–</td><td>–</td>", stream);
    isocompare_put_cell(stream, 1 / r->splats.ungrouped, "");
    fputs("</tr>\n</tbody></table></div>\n", stream);
}

void isocompare_put_points(const report *r, FILE *stream) {
    fputs("<h2>What the later papers add</h2>\n<p class=soft>Layers in order and without sorting stand under "
          "<i>Transparency</i>, points reconstructed in an image pyramid (Marroquim et al. 2008) above, as "
          "pullpush and pullpush-box.</p>\n",
          stream);
    put_selection(r, stream);
    put_splats(r, stream);
}
