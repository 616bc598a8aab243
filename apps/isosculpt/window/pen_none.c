/* For window systems that report no pen pressure. */
#include <stddef.h>

#include "apps/isosculpt/window/pen.h"

isosculpt_pen *isosculpt_pen_open(void) {
    return NULL;
}
void isosculpt_pen_close(isosculpt_pen *pen) {
    (void)pen;
}
bool isosculpt_pen_present(const isosculpt_pen *pen) {
    (void)pen;
    return false;
}
double isosculpt_pen_pressure(isosculpt_pen *pen) {
    (void)pen;
    return 1;
}
