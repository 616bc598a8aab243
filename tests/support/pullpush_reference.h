/* pullpush_reference: pull-push point by point and pixel by pixel, in plain C, with which the kernels are
 * compared. */
#ifndef ISO_TESTS_PULLPUSH_REFERENCE_H
#define ISO_TESTS_PULLPUSH_REFERENCE_H

#include "render/pullpush/pullpush.h"
#include "render/view/gbuffer.h"

/* The layout of the library's pyramid and its weights; all else is as in 2008, section 3. */
typedef struct reference_opts {
    bool box, cull;
    int base, top, guard;
    double low_pass, facing, edge, disc_radii;
} reference_opts;

/* Draws into a cleared gbuffer of the view's size; the view must be of the whole picture, not of a strip. */
void reference_pullpush(const reference_opts *opts, const iso_view *view, const iso_point_view *points,
                        iso_gbuffer *gbuffer);

#endif
