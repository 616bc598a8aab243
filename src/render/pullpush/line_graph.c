/* line_graph: counts, numbers and links the fragments of lines. */
#include "render/pullpush/line_graph.h"

#include <math.h>

#include "base/numbers.h"
#include "base/primitives.h"

void iso_line_graph_count_rows(const iso_pyramid *pyramid, iso_rows rows) {
    const size_t stride = pyramid->key_stride, pieces = stride / ISO_KEY_PIECE;
    for (int y = rows.first; y <= rows.last; y++) {
        const int64_t *keys = pyramid->keys + (size_t)y * stride;
        uint8_t *used = pyramid->used + (size_t)(y / 2) * pieces;
        int32_t count = 0;
        for (size_t i = 0; i < pieces; i++) {
            int32_t here = 0;
            for (size_t x = 0; x < ISO_KEY_PIECE; x++) here += keys[i * ISO_KEY_PIECE + x] != ISO_KEY_NONE;
            used[i] = (y & 1 && used[i]) || here;
            count += here;
        }
        pyramid->line_starts[y + 1] = count;
    }
}

iso_status iso_line_graph_reserve(iso_pyramid *pyramid, iso_error *error) {
    const int height = pyramid->level[pyramid->layout.base].height;
    int32_t *starts = pyramid->line_starts;
    starts[0] = 0;
    for (int y = 0; y < height; y++) starts[y + 1] += starts[y];
    return iso_buffer_reserve(&pyramid->line_fragments, (size_t)starts[height] * sizeof(iso_line_fragment), 0,
                              error);
}

static void set_forms(iso_line_fragment *f) {
    const double xx = (double)f->shape[0], xy = (double)f->shape[1], yy = (double)f->shape[2],
                 inverse = 1 / iso_max(xx * yy - xy * xy, 1e-12);
    const iso_line_form m = {inverse * yy, -inverse * xy, inverse * xx};
    f->ellipse = m;
    f->reach = (float)sqrt(xx + yy);
    f->thin = xx + yy < ISO_LINE_THIN * ISO_LINE_THIN;
    /* With D, which projects onto the line's direction, half of the form's slope along the line at d has the
     * square (Md)'D(Md), and half of its second derivative is the trace of DM. */
    const double c = (double)f->cosine, s = (double)f->sine, d[3] = {0.5 * (1 + c), 0.5 * s, 0.5 * (1 - c)},
                 bend = d[0] * m.xx + 2 * d[1] * m.xy + d[2] * m.yy, less = 1 / iso_max(bend * bend, 1e-24);
    const double a[4] = {d[0] * m.xx + d[1] * m.xy, d[0] * m.xy + d[1] * m.yy, d[1] * m.xx + d[2] * m.xy,
                         d[1] * m.xy + d[2] * m.yy}; /* DM */
    f->along = (iso_line_form){less * (m.xx * a[0] + m.xy * a[2]), less * (m.xx * a[1] + m.xy * a[3]),
                               less * (m.xy * a[1] + m.yy * a[3])};
}

static void set_direction(const iso_pullpush_params *params, int64_t key, iso_line_fragment *f) {
    const iso_surfel packed = iso_point_unpack((iso_point){.bits = (uint64_t)(key & 0x3fffff) << 42});
    double n[3] = {0};
    for (int k = 0; k < 3; k++)
        for (int i = 0; i < 3; i++) n[k] += (double)params->normal[3 * k + i] * (double)packed.normal[i];
    const double length = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    for (int k = 0; k < 3; k++) f->n[k] = (float)(n[k] / length);
}

static void make_fragment(const iso_pullpush_params *params, int x, int y, int64_t key, int32_t line,
                          iso_line_fragment *f) {
    const iso_pyramid *p = params->pyramid;
    const iso_pyramid_level *base = &p->level[p->layout.base];
    float *const *plane = base->plane;
    const size_t at = (size_t)y * base->stride + (size_t)x;
    const double pixel = (double)(1 << p->layout.base);
    *f = (iso_line_fragment){.x = (float)(pixel * (x + ((key >> 22 & 31) + 0.5) / 32)),
                             .y = (float)(pixel * (y + ((key >> 27 & 31) + 0.5) / 32)),
                             .depth = iso_key_depth(key),
                             .interval = plane[ISO_PLANE_INTERVAL][at],
                             .cosine = plane[ISO_PLANE_TWICE_X][at],
                             .sine = plane[ISO_PLANE_TWICE_Y][at],
                             .column = x,
                             .row = y,
                             .line = (uint16_t)line,
                             .key = (uint32_t)((size_t)y * p->key_stride + (size_t)x),
                             .radius = plane[ISO_PLANE_RADIUS][at],
                             .end = plane[ISO_PLANE_ROOM][at]};
    for (int k = 0; k < 3; k++) f->shape[k] = plane[ISO_PLANE_SHAPE_XX + k][at];
    for (int k = 0; k < 3 && plane[ISO_PLANE_RED]; k++)
        f->color |= (uint32_t)((double)plane[ISO_PLANE_RED + k][at] + 0.5) << 8 * k;
    set_forms(f);
    set_direction(params, key, f);
}

void iso_line_graph_make_rows(const iso_pullpush_params *params, iso_rows rows) {
    const iso_pyramid *p = params->pyramid;
    iso_line_fragment *fragments = p->line_fragments.data;
    const size_t pieces = p->key_stride / ISO_KEY_PIECE;
    for (int y = rows.first; y <= rows.last; y++) {
        const size_t at = (size_t)y * p->key_stride;
        int32_t number = p->line_starts[y];
        for (size_t i = 0; i < pieces; i++) {
            if (!p->used[(size_t)(y / 2) * pieces + i]) continue;
            for (size_t x = i * ISO_KEY_PIECE; x < (i + 1) * ISO_KEY_PIECE; x++) {
                if (p->keys[at + x] == ISO_KEY_NONE) continue;
                make_fragment(params, (int)x, y, p->keys[at + x], p->index[at + x], &fragments[number]);
                p->index[at + x] = number++;
            }
        }
    }
}

static uint8_t links_of(const iso_pyramid *p, const iso_line_fragment *f) {
    const iso_pyramid_level *base = &p->level[p->layout.base];
    const iso_line_fragment *fragments = p->line_fragments.data;
    const int columns[2] = {f->column > 0 ? -1 : 0, f->column + 1 < base->width ? 1 : 0},
              rows[2] = {f->row > 0 ? -1 : 0, f->row + 1 < base->height ? 1 : 0};
    unsigned links = 0;
    for (int dy = rows[0]; dy <= rows[1]; dy++)
        for (int dx = columns[0]; dx <= columns[1]; dx++) {
            const ptrdiff_t at = (ptrdiff_t)f->key + dy * (ptrdiff_t)p->key_stride + dx;
            const int place = 3 * (dy + 1) + dx + 1;
            if (p->keys[at] != ISO_KEY_NONE && place != 4 &&
                iso_line_fragments_follow(f, &fragments[p->index[at]]))
                links |= 1u << (place - (place > 4));
        }
    return (uint8_t)links;
}

void iso_line_graph_link_rows(const iso_pullpush_params *params, iso_rows rows) {
    const iso_pyramid *p = params->pyramid;
    iso_line_fragment *fragments = p->line_fragments.data;
    for (int32_t i = p->line_starts[rows.first]; i < p->line_starts[rows.last + 1]; i++)
        fragments[i].links = links_of(p, &fragments[i]);
}
