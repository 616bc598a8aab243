/* radix_sort: counting sorts by one digit after the other, the lowest first. */
#include "base/radix_sort.h"

enum { DIGIT_BITS = 11, DIGITS = 1 << DIGIT_BITS };

static void sort_digit(const iso_radix_item *from, iso_radix_item *to, size_t count, int shift) {
    size_t starts[DIGITS + 1] = {0};
    for (size_t i = 0; i < count; i++) starts[(from[i].key >> shift & (DIGITS - 1)) + 1]++;
    for (int digit = 0; digit < DIGITS; digit++) starts[digit + 1] += starts[digit];
    for (size_t i = 0; i < count; i++) to[starts[from[i].key >> shift & (DIGITS - 1)]++] = from[i];
}

iso_radix_item *iso_radix_sort(iso_radix_item *items, iso_radix_item *spare, size_t count, int bits) {
    for (int shift = 0; shift < bits; shift += DIGIT_BITS) {
        sort_digit(items, spare, count, shift);
        iso_radix_item *sorted = spare;
        spare = items;
        items = sorted;
    }
    return items;
}
