/* disc_samples: 32 places in a disc, for estimating how much of it other discs overlap. Internal. */
#ifndef ISO_RENDER_GROUPS_DISC_SAMPLES_H
#define ISO_RENDER_GROUPS_DISC_SAMPLES_H

#include <math.h>

enum { ISO_DISC_SAMPLES = 32 };

/* Sets samples of a disc of radius 1, spread evenly by the golden angle (Vogel 1979). */
static inline void iso_spread_disc_samples(float samples[ISO_DISC_SAMPLES][2]) {
    const double cosine = -0.73736887807831990, sine = 0.67549029426152364;
    double x = 1, y = 0;
    for (int i = 0; i < ISO_DISC_SAMPLES; i++) {
        const double radius = sqrt((i + 0.5) / ISO_DISC_SAMPLES), turned = cosine * x - sine * y;
        samples[i][0] = (float)(radius * x);
        samples[i][1] = (float)(radius * y);
        y = sine * x + cosine * y;
        x = turned;
    }
}

#endif
