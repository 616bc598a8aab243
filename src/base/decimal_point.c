#include "base/decimal_point.h"

#include <locale.h>
#include <stdlib.h>

typedef struct numbers {
    locale_t own, before;
} numbers;

void *iso_decimal_point_begin(void) {
    numbers *state = malloc(sizeof *state);
    if (!state) return NULL;
    state->own = newlocale(LC_NUMERIC_MASK, "C", (locale_t)0);
    if (!state->own) {
        free(state);
        return NULL;
    }
    state->before = uselocale(state->own);
    return state;
}

void iso_decimal_point_end(void *opaque) {
    numbers *state = opaque;
    if (!state) return;
    uselocale(state->before);
    freelocale(state->own);
    free(state);
}
