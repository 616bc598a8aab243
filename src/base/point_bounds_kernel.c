/* point_bounds_kernel: bounds of points and their normals. */
#include <float.h>

#include "base/point_bounds.h"
#include "base/point_code_simd.h"
#include "base/simd.h"

typedef struct bounds_box {
    vf lo[3], hi[3];
} bounds_box;

ISO_INLINE bounds_box no_box(void) {
    bounds_box box;
    for (int k = 0; k < 3; k++) {
        box.lo[k] = v_set(FLT_MAX);
        box.hi[k] = v_set(-FLT_MAX);
    }
    return box;
}

/* Extends the boxes by the lanes in `live`. A NaN is ignored, as v_min and v_max then return their second
 * argument. */
ISO_INLINE void widen(bounds_box *box, const vf at[3], vm live) {
    for (int k = 0; k < 3; k++) {
        box->lo[k] = v_select(live, v_min(at[k], box->lo[k]), box->lo[k]);
        box->hi[k] = v_select(live, v_max(at[k], box->hi[k]), box->hi[k]);
    }
}

ISO_INLINE void fold_box(const bounds_box *box, float lo[3], float hi[3]) {
    for (int k = 0; k < 3; k++) {
        float lows[ISO_LANES], highs[ISO_LANES];
        v_store(lows, box->lo[k]);
        v_store(highs, box->hi[k]);
        lo[k] = lows[0];
        hi[k] = highs[0];
        for (int lane = 1; lane < ISO_LANES; lane++) {
            lo[k] = lows[lane] < lo[k] ? lows[lane] : lo[k];
            hi[k] = highs[lane] > hi[k] ? highs[lane] : hi[k];
        }
    }
}

static void find_packed(const iso_point *points, size_t count, iso_point_bounds *bounds) {
    bounds_box positions = no_box(), normals = positions;
    for (size_t i = 0; i < count; i += ISO_LANES) {
        iso_point end[ISO_LANES];
        const iso_point *from = points + i;
        if (count - i < ISO_LANES) { /* lanes beyond the end repeat a point */
            for (size_t lane = 0; lane < ISO_LANES; lane++)
                end[lane] = points[i + lane < count ? i + lane : i];
            from = end;
        }
        vi low, high;
        vf at[3], normal[3];
        load_points(from, &low, &high);
        vi bits = unpack_points(low, high, at);
        unfold_normals(bits, normal);
        const vm all = v_eqi(low, low);
        widen(&positions, at, all);
        widen(&normals, normal, all);
    }
    fold_box(&positions, bounds->lo, bounds->hi);
    fold_box(&normals, bounds->normal_lo, bounds->normal_hi);
    if (count == 0) return;
    for (int k = 0; k < 3; k++) {
        bounds->lo[k] = iso_point_coordinate(bounds->lo[k]);
        bounds->hi[k] = iso_point_coordinate(bounds->hi[k]);
    }
}

static void find_surfels(const iso_surfel *surfels, size_t count, iso_point_bounds *bounds) {
    bounds_box positions = no_box(), normals = positions;
    for (size_t i = 0; i < count; i += ISO_LANES) {
        vf at[3], normal[3];
        vm good = load_surfels(surfels + i, count - i, at, normal);
        vm there = v_lti(v_lanes(), v_seti(count - i < ISO_LANES ? (int32_t)(count - i) : ISO_LANES));
        for (int k = 0; k < 3; k++) there = v_and(there, v_le(v_abs(at[k]), v_set(FLT_MAX)));
        widen(&positions, at, there);
        widen(&normals, normal, v_and(there, good));
    }
    fold_box(&positions, bounds->lo, bounds->hi);
    fold_box(&normals, bounds->normal_lo, bounds->normal_hi);
}

void ISO_KERNEL_NAME(iso_find_point_bounds)(const iso_point_view *view, size_t first, size_t count,
                                            iso_point_bounds *bounds) {
    if (view->packed)
        find_packed(view->packed + first, count, bounds);
    else
        find_surfels(view->surfels + first, count, bounds);
}
