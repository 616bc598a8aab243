#include "image/placing.h"

#include <math.h>
#include <string.h>

/* Of the room beside the drawing, which parts are left of it and above it. */
static const double places[][2] = {{0, 0}, {1, 0}, {0, 1}, {1, 1}, {0, 0.5}, {1, 0.5}};
enum { PLACES = sizeof places / sizeof *places };

void iso_placing_move(const iso_placing *placing, const iso_drawing *drawing, int place, double by[2]) {
    const int sides[2] = {placing->width, placing->height};
    double box[4];
    by[0] = by[1] = 0;
    iso_drawing_box(drawing, box);
    for (int axis = 0; place && axis < 2; axis++) {
        const double room = sides[axis] - 2 * placing->margin - (box[2 + axis] - box[axis]);
        by[axis] = floor(placing->margin + places[place - 1][axis] * room - box[axis] + 0.5);
    }
}

static int clamped(double value, int most) {
    return value < 0 ? 0 : value > most ? most : (int)value;
}

/* The number of pixels in a box that show something. */
static double shown(const iso_placing *placing, const double box[4]) {
    const iso_rgb b = placing->background;
    const uint8_t background[3] = {b.r, b.g, b.b};
    const int left = clamped(floor(box[0]), placing->width), right = clamped(ceil(box[2]), placing->width),
              top = clamped(floor(box[1]), placing->height), bottom = clamped(ceil(box[3]), placing->height);
    double count = 0;
    for (int y = top; y < bottom; y++)
        for (int x = left; x < right; x++) {
            const uint8_t *pixel =
                placing->under->rgba + 4 * ((size_t)y * (size_t)placing->width + (size_t)x);
            count += pixel[3] != 0 && memcmp(pixel, background, sizeof background) != 0;
        }
    return count;
}

static double area(const double box[4]) {
    return box[2] > box[0] && box[3] > box[1] ? (box[2] - box[0]) * (box[3] - box[1]) : 0;
}

static void box_of(const iso_mark *mark, const double by[2], double around, double box[4]) {
    iso_mark copy = *mark;
    const iso_drawing one = {.marks = &copy, .count = 1};
    iso_drawing_box(&one, box);
    for (int i = 0; i < 4; i++) box[i] += by[i % 2] + (i < 2 ? -around : around);
}

/* How much of a box the other drawings fill. */
static double overlap(const iso_placing *placing, int which, const double box[4]) {
    double sum = 0;
    for (int i = 0; i < placing->count; i++)
        for (int k = 0; i != which && k < placing->over[i].count; k++) {
            const iso_mark *mark = &placing->over[i].marks[k];
            double o[4];
            if (i >= placing->movable && mark->kind == ISO_MARK_LINES) continue;
            box_of(mark, i < placing->movable ? placing->moved[i] : (double[2]){0, 0}, 0, o);
            sum += area(
                (double[4]){fmax(o[0], box[0]), fmax(o[1], box[1]), fmin(o[2], box[2]), fmin(o[3], box[3])});
        }
    return sum;
}

/* Pixels that a drawing would cover; those of other drawings, which would not be legible, count several
 * times. */
static double cost(const iso_placing *placing, int which, const double by[2], double *covered) {
    static const double OVERLAP = 4;
    double pixels = 0, others = 0, all = 0;
    for (int i = 0; i < placing->over[which].count; i++) {
        double box[4];
        box_of(&placing->over[which].marks[i], by, placing->margin / 3, box);
        pixels += shown(placing, box);
        others += overlap(placing, which, box);
        all += area(box);
    }
    *covered = all > 0 ? fmin(1, pixels / all) : 0;
    return pixels + OVERLAP * others;
}

int iso_placing_choose(const iso_placing *placing, int which, double *covered) {
    const iso_drawing *drawing = &placing->over[which];
    const double sides = placing->width + placing->height;
    double box[4], least = INFINITY, nearest = 0;
    int best = 0;
    iso_drawing_box(drawing, box);
    const bool is_middle = fabs(box[1] + box[3] - placing->height) < 0.1 * placing->height;
    *covered = 0;
    for (int place = 0; place <= PLACES && drawing->count; place++) {
        const bool other = place && (places[place - 1][1] == 0.5) != is_middle;
        double by[2], part;
        iso_placing_move(placing, drawing, place, by);
        const double far = fabs(by[0]) + fabs(by[1]) + (other ? sides : 0),
                     pixels = cost(placing, which, by, &part);
        if (pixels > least || (pixels == least && far >= nearest)) continue;
        best = place, least = pixels, nearest = far, *covered = part;
    }
    iso_placing_move(placing, drawing, best, placing->moved[which]);
    return best;
}
