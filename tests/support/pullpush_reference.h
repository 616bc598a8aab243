/* Pull-push point by point and pixel by pixel, in plain C: what the kernels are held against. */
#ifndef ISO_TESTS_PULLPUSH_REFERENCE_H
#define ISO_TESTS_PULLPUSH_REFERENCE_H

#include "render/gbuffer.h"
#include "render/pullpush/pullpush.h"

/* How the library lays out its pyramid and weighs; the rest is 2008, section 3. */
typedef struct reference_opts {
    bool box, cull;
    int base, top, guard;
    double low_pass, facing, edge, disc_radii;
} reference_opts;

/* Draws into a cleared gbuffer of the view's size, which must be whole (no strip). */
void reference_pullpush(const reference_opts *opts, const iso_view *view, const iso_point_view *points,
                        iso_gbuffer *gbuffer);

#endif
