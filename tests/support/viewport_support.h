/* viewport_support: a session of isosculpt that begins with a ball, its pictures, and strokes on it. */
#ifndef ISO_TESTS_VIEWPORT_SUPPORT_H
#define ISO_TESTS_VIEWPORT_SUPPORT_H

#include "apps/isosculpt/viewport/viewport.h"
#include "sculpt/session/session.h"

/* The size of the pictures, in pixels. */
enum { VIEWPORT_WIDTH = 333, VIEWPORT_HEIGHT = 250, VIEWPORT_PIXELS = VIEWPORT_WIDTH * VIEWPORT_HEIGHT };

/* The ball has a radius of 15 mm; the grid has 96^3 voxels of half a millimetre. */
extern const iso_journal_start VIEWPORT_START;
iso_session *viewport_session(iso_pool *pool);

/* Draws the picture; `moving`: as while the camera moves. */
void viewport_draw(isosculpt_viewport *view, bool moving);
/* Refines a picture at rest until it is fine. */
void viewport_refine(isosculpt_viewport *view);

/* A random place on the ball, mostly on the side that is seen from the front. */
iso_sample viewport_sample(uint32_t *seed);
/* Makes a stroke of four samples, the first of them at a random place, and draws after each. Returns the
 * number of pixels that were drawn before the last. */
size_t viewport_stroke(isosculpt_viewport *view, iso_session *session, const iso_brush *brush,
                       uint32_t *seed);

/* Fails the test unless both pictures have the same samples to pick from. */
void viewport_same_samples(const isosculpt_viewport *a, const isosculpt_viewport *b);

#endif
