/* study_support: colours and changes of the pictures of a study (compare/study.h), for tests and benches. */
#ifndef ISO_TESTS_STUDY_SUPPORT_H
#define ISO_TESTS_STUDY_SUPPORT_H

#include "compare/study.h"

/* Shades a frame with float channels into unrounded colours, width * height * 3 display values 0 .. 255, for
 * errors smaller than the step of a byte: Phong's model with one light at the eye (ambient 0.15, diffuse 0.8,
 * specular 0.3 with exponent 40), both sides lit, with the look's colour and background. */
void iso_study_shade(const iso_study_frame *frame, const iso_view *view, const iso_study_look *look,
                     float *color);

/* The mean |difference| of R, G and B, 0 .. 255, of two frames over the union of their silhouettes; NaN when
 * both are empty. The frames must have float channels. */
double iso_study_change(const iso_study_frame *a, const iso_study_frame *b);

#endif
