/* The images of a brush's touches: by mirror planes, by radial symmetry, and repeated ones. */
#include "sculpt/brush/brush.h"

bool iso_brush_is_radial(const iso_brush *brush) {
    return brush->radial > 1;
}

int iso_brush_radial_axis(const iso_brush *brush) {
    return brush->radial_axis ? brush->radial_axis - 'x' : 2;
}

bool iso_brush_is_repeated(const iso_brush *brush) {
    return brush->repeat[0] > 1 || brush->repeat[1] > 1;
}

/* Returns the turn number `index` of `count` around an axis; half and quarter turns are exact. */
static iso_brush_image make_turn(int index, int count, int axis) {
    static const double quarters[] = {1, 0, -1, 0};
    iso_brush_image image = {.axis = axis, .turned = index > 0};
    if (4 * index % count == 0) {
        image.cosine = quarters[4 * index / count];
        image.sine = quarters[(4 * index / count + 3) % 4];
    } else
        iso_sincos(2 * ISO_PI * index / count, &image.sine, &image.cosine);
    return image;
}

static int turns_of(const iso_brush *brush) {
    return iso_brush_is_radial(brush) ? (int)brush->radial : 1;
}

/* The mirror planes that make further images: two along the axis of a radial symmetry make half a turn, which
 * is there already if the number of turns is even. */
static unsigned planes_of(const iso_brush *brush) {
    const int axis = iso_brush_radial_axis(brush);
    const unsigned beside = (1u << (axis + 1) % 3) | (1u << (axis + 2) % 3);
    const bool twice = turns_of(brush) % 2 == 0 && (brush->symmetry & beside) == beside;
    return twice ? brush->symmetry & ~(1u << (axis + 2) % 3) : brush->symmetry;
}

static int repeats(const iso_brush *brush, int which) {
    return brush->repeat[which] > 1 ? (int)brush->repeat[which] : 1;
}

int iso_brush_image_count(const iso_brush *brush) {
    int count = turns_of(brush) * repeats(brush, 0) * repeats(brush, 1);
    for (int axis = 0; axis < 3; axis++) count *= planes_of(brush) >> axis & 1 ? 2 : 1;
    return count;
}

int iso_brush_images(const iso_brush *brush, iso_brush_image images[ISO_IMAGES_MOST]) {
    const int turns = turns_of(brush), along = repeats(brush, 0), copies = along * repeats(brush, 1);
    const unsigned planes = planes_of(brush);
    int count = 0;
    for (unsigned bits = 0; bits < 8; bits++)
        for (int i = 0; i < turns * copies && !(bits & ~planes) && count < ISO_IMAGES_MOST; i++) {
            const int copy = i / turns;
            iso_brush_image *image = &images[count++];
            *image = make_turn(i % turns, turns, iso_brush_radial_axis(brush));
            image->through = brush->mirror;
            image->mirrored = bits;
            image->moved = copy > 0;
            image->by = iso_vec3_add(iso_vec3_scale(brush->repeat_by[0], copy % along),
                                     iso_vec3_scale(brush->repeat_by[1], copy / along));
        }
    return count;
}

static iso_vec3 turn(const iso_brush_image *image, iso_vec3 v) {
    const double in[3] = {v.x, v.y, v.z};
    const int a = image->axis, b = (a + 1) % 3, c = (a + 2) % 3;
    double out[3];
    out[a] = in[a];
    out[b] = image->cosine * in[b] - image->sine * in[c];
    out[c] = image->sine * in[b] + image->cosine * in[c];
    return iso_vec3_make(out[0], out[1], out[2]);
}

/* Mirrors `v` at the planes through `at`. */
static iso_vec3 reflect(const iso_brush_image *image, iso_vec3 v, iso_vec3 at) {
    const unsigned bits = image->mirrored;
    return iso_vec3_make(bits & 1 ? 2 * at.x - v.x : v.x, bits & 2 ? 2 * at.y - v.y : v.y,
                         bits & 4 ? 2 * at.z - v.z : v.z);
}

iso_vec3 iso_brush_image_point(const iso_brush_image *image, iso_vec3 point) {
    const iso_vec3 at = image->through;
    if (image->moved) point = iso_vec3_add(point, image->by);
    return reflect(image, image->turned ? iso_vec3_add(turn(image, iso_vec3_sub(point, at)), at) : point, at);
}

iso_vec3 iso_brush_image_direction(const iso_brush_image *image, iso_vec3 direction) {
    return reflect(image, image->turned ? turn(image, direction) : direction, iso_vec3_make(0, 0, 0));
}
