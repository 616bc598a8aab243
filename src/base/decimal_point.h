/* decimal_point: numbers in text independent of the program's locale. */
#ifndef ISO_BASE_DECIMAL_POINT_H
#define ISO_BASE_DECIMAL_POINT_H

/* Between the two calls, this thread prints and parses numbers with a decimal point, whatever locale the
 * program has set. Pass the value returned by begin to end. NULL (no memory) is allowed: the locale is then
 * not changed. */
void *iso_decimal_point_begin(void);
void iso_decimal_point_end(void *state);

#endif
