/* optics: absorption (Beer and Lambert), with an exponential that has the same bits on every machine. */
#include "render/glass/optics.h"

#include "base/srgb.h"

void iso_glass_set_absorption(iso_glass *glass, iso_rgb color, double distance) {
    const uint8_t display[3] = {color.r, color.g, color.b};
    const double none_left = 1000; /* for a colour of 0, which leaves no light at all */
    for (int k = 0; k < 3; k++) {
        const double left = iso_srgb_decode(display[k] / 255.0);
        glass->absorption[k] = (left > 0 ? -iso_log2(left) : none_left) / distance;
    }
}

void iso_glass_disperse(double ior, double abbe, double iors[3]) {
    const double half = (ior - 1) / (2 * abbe);
    iors[0] = ior - half < 1 ? 1 : ior - half;
    iors[1] = ior;
    iors[2] = ior + half;
}

void iso_glass_absorb(const iso_glass *glass, double mm, double light[3]) {
    for (int k = 0; k < 3; k++)
        if (glass->absorption[k] > 0) light[k] *= (double)iso_exp2((float)(-glass->absorption[k] * mm));
}
