/* lent_ball: a volume for tests of the public interface. */
#ifndef ISO_TEST_LENT_BALL_H
#define ISO_TEST_LENT_BALL_H

#include "isopoint.h"

/* A ball of radius 8 in the middle of a volume of 24 x 24 x 24 voxels, whose isovalue is 0. */
iso_volume *lend_ball(int threads);
size_t bytes_of(const iso_image *image);

#endif
