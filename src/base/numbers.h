/* numbers: comparisons and limits of plain numbers. */
#ifndef ISO_BASE_NUMBERS_H
#define ISO_BASE_NUMBERS_H

static inline int iso_min_int(int a, int b) {
    return a < b ? a : b;
}

/* Minimum and maximum. fmin and fmax would be library calls. */
static inline double iso_min(double a, double b) {
    return a < b ? a : b;
}

static inline double iso_max(double a, double b) {
    return a > b ? a : b;
}

/* The index in 0 .. count - 1 that is nearest to `index`; count is at least 1. */
static inline int iso_clamp_index(int index, int count) {
    return index < 0 ? 0 : index < count ? index : count - 1;
}

/* Orders doubles from small to large, for qsort. None may be NaN. */
static inline int iso_compare_doubles(const void *left, const void *right) {
    const double a = *(const double *)left, b = *(const double *)right;
    return (a > b) - (a < b);
}

#endif
