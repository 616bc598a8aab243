/* box_items: begins with groups of items whose boxes extend farthest: most others then lie in the result. */
#include "base/box_items.h"

enum { SIDES = 6, GROUP = 32 };

static bool contains(const iso_box *box, const iso_box *other) {
    return box->lo.x <= other->lo.x && box->lo.y <= other->lo.y && box->lo.z <= other->lo.z &&
           box->hi.x >= other->hi.x && box->hi.y >= other->hi.y && box->hi.z >= other->hi.z;
}

/* The same bytes as iso_box_transform, with less work: rounding is monotonic, so that each side of the result
 * is at the corner that the signs of the row's coefficients choose. */
static iso_box map_box(const iso_box *box, const iso_affine *affine) {
    if (iso_box_is_empty(box)) return *box;
    const double lo[3] = {box->lo.x, box->lo.y, box->lo.z}, hi[3] = {box->hi.x, box->hi.y, box->hi.z};
    double least[3], most[3];
    for (int k = 0; k < 3; k++) {
        const double *m = affine->m + 3 * k;
        double low[3], high[3];
        for (int i = 0; i < 3; i++) {
            low[i] = m[i] * (m[i] < 0 ? hi[i] : lo[i]);
            high[i] = m[i] * (m[i] < 0 ? lo[i] : hi[i]);
        }
        least[k] = low[0] + low[1] + low[2] + affine->origin[k];
        most[k] = high[0] + high[1] + high[2] + affine->origin[k];
    }
    return (iso_box){{least[0], least[1], least[2]}, {most[0], most[1], most[2]}};
}

bool iso_box_contains_mapped(const iso_box *box, const iso_box *index, const iso_affine *affine) {
    const iso_box mapped = affine ? map_box(index, affine) : *index;
    return contains(box, &mapped);
}

/* How far a box extends to each side. */
static void find_reaches(const iso_box *box, double reaches[SIDES]) {
    iso_vec3_store(box->hi, reaches);
    iso_vec3_store(iso_vec3_scale(box->lo, -1), reaches + 3);
}

/* The box around a group of consecutive items, which lie near each other in most sets. */
static iso_box around_group(const iso_box_items *items, size_t group) {
    const size_t first = group * GROUP, end = first + GROUP < items->count ? first + GROUP : items->count;
    iso_box all = iso_box_empty();
    for (size_t i = first; i < end; i++) {
        const iso_box box = items->around(items->context, i);
        all.lo = iso_vec3_make(box.lo.x < all.lo.x ? box.lo.x : all.lo.x,
                               box.lo.y < all.lo.y ? box.lo.y : all.lo.y,
                               box.lo.z < all.lo.z ? box.lo.z : all.lo.z);
        all.hi = iso_vec3_make(box.hi.x > all.hi.x ? box.hi.x : all.hi.x,
                               box.hi.y > all.hi.y ? box.hi.y : all.hi.y,
                               box.hi.z > all.hi.z ? box.hi.z : all.hi.z);
    }
    return all;
}

/* Finds the groups whose boxes extend farthest to each side. */
static void find_farthest(const iso_box_items *items, size_t groups, const iso_affine *affine,
                          size_t farthest[SIDES]) {
    double most[SIDES], reaches[SIDES];
    for (size_t i = 0; i < groups; i++) {
        iso_box box = around_group(items, i);
        if (affine) box = map_box(&box, affine);
        find_reaches(&box, reaches);
        for (int side = 0; side < SIDES; side++)
            if (i == 0 || reaches[side] > most[side]) {
                most[side] = reaches[side];
                farthest[side] = i;
            }
    }
}

/* The item of a group whose box extends farthest to a side. */
static size_t farthest_item(const iso_box_items *items, size_t group, int side, const iso_affine *affine) {
    const size_t first = group * GROUP, end = first + GROUP < items->count ? first + GROUP : items->count;
    double most = 0, reaches[SIDES];
    size_t farthest = first;
    for (size_t i = first; i < end; i++) {
        iso_box box = items->around(items->context, i);
        if (affine) box = map_box(&box, affine);
        find_reaches(&box, reaches);
        if (i > first && !(reaches[side] > most)) continue;
        most = reaches[side];
        farthest = i;
    }
    return farthest;
}

/* Adds those items of a group that do not lie in the box. */
static void add_group(const iso_box_items *items, size_t group, const iso_affine *affine, iso_box *box) {
    const size_t first = group * GROUP, end = first + GROUP < items->count ? first + GROUP : items->count;
    for (size_t i = first; i < end; i++) {
        const iso_box around = items->around(items->context, i);
        if (!iso_box_contains_mapped(box, &around, affine)) items->add(items->context, i, affine, box);
    }
}

iso_box iso_box_of_items(const iso_box_items *items, const iso_affine *affine) {
    iso_box box = iso_box_empty();
    size_t farthest[SIDES];
    const size_t groups = (items->count + GROUP - 1) / GROUP;
    if (!items->around)
        for (size_t i = 0; i < items->count; i++) items->add(items->context, i, affine, &box);
    if (!items->around || items->count == 0) return box;
    find_farthest(items, groups, affine, farthest);
    for (int side = 0; side < SIDES; side++)
        items->add(items->context, farthest_item(items, farthest[side], side, affine), affine, &box);
    for (size_t i = 0; i < groups; i++) {
        const iso_box around = around_group(items, i);
        if (!iso_box_contains_mapped(&box, &around, affine)) add_group(items, i, affine, &box);
    }
    return box;
}
