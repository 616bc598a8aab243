/* disc_hits_kernel: intersects a disc with the rays of ISO_LANES pixels of a row at a time. */
#include "base/simd.h"
#include "render/groups/disc_hits.h"

/* Adds the pixels of a row from column `first` on that the disc covers; returns the number of all hits. */
ISO_INLINE int add_hits(const iso_disc_view *view, const iso_disc *disc, int first, int last, int row,
                        const float *xs, float y, int count, iso_disc_hits *hits) {
    const vf x = v_load(xs + first), r = v_set(disc->radius), z = v_set(disc->z), near = v_set(view->near),
             nx = v_set(disc->normal[0]), ny = v_set(disc->normal[1]), zero = v_set(0);
    const vf dx = x - v_set(disc->x), dy = v_set(y - disc->y),
             mm = v_set(view->scale + disc->z * view->slope), u = x * v_set(view->slope),
             v = v_set(y * view->slope), facing = nx * u + ny * v + v_set(disc->normal[2]);
    const vf qx = dx * mm, qy = dy * mm, t = -(nx * qx + ny * qy) / facing, px = qx + t * u, py = qy + t * v;
    const vf exact = (px * px + py * py + t * t) / (r * r),
             low = (dx * dx + dy * dy) / v_set(ISO_DISC_LOW_PASS * ISO_DISC_LOW_PASS);
    const vm on_disc = v_and(v_lt(exact, low), v_le(near, z + t));
    const vf e = v_select(on_disc, exact, low);
    const vi columns = v_lanes() + v_seti(first);
    const vm hit = v_and(v_lt(e, v_set(1)), v_lti(columns, v_seti(last + 1)));
    const uint32_t mask = v_mask(hit);
    if (!mask) return count;
    const vf limited = v_select(v_lt(r, t), r, v_select(v_lt(t, -r), -r, zero)),
             depth = z + v_select(v_or(on_disc, v_le(v_abs(t), r)), t, limited);
    v_compressi(hits->column + count, hit, columns);
    v_compressi(hits->row + count, hit, v_seti(row));
    v_compress(hits->depth + count, hit, v_select(v_lt(depth, near), near, depth));
    v_compress(hits->e + count, hit, e);
    v_compressi(hits->away + count, hit, v_selecti(v_lt(zero, facing), v_seti(1), v_seti(0)));
    return count + __builtin_popcount(mask);
}

int ISO_KERNEL_NAME(iso_disc_find_hits)(const iso_disc_view *view, const iso_disc *disc,
                                        const iso_disc_box *box, const float *x, const float *y,
                                        iso_disc_hits *hits) {
    int count = 0;
    for (int row = box->rows.first; row <= box->rows.last; row++)
        for (int at = box->columns.first; at <= box->columns.last; at += ISO_LANES)
            count =
                add_hits(view, disc, at, box->columns.last, row, x, y[row - box->rows.first], count, hits);
    return count;
}
