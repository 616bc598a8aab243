/* gaussians: draws 3-D Gaussians as trainers of radiance fields write them (Kerbl, Kopanas, Leimkühler and
 * Drettakis 2023, "3D Gaussian Splatting for Real-Time Radiance Field Rendering"): ellipsoids of a density
 * that falls off as exp(-q / 2), with an opacity and a colour each, composited front to back.
 *
 * A Gaussian becomes an ellipse in the picture by the affine approximation of the projection at its centre
 * (Zwicker, Pfister, van Baar and Gross 2001, "EWA volume splatting"), whose covariance is
 * V = J W S W' J' + 0.3 sample^2: J are the derivatives of the projection, W is the rotation to the view, S
 * the covariance in space. As those trainers do it, J is taken not farther than 15 % of the picture outside
 * of it, and contributions with an opacity below 1 / 255 do not count. All pixels see the Gaussians in the
 * order of their centres' depths. A sample is finished when less than 1 / 512 of the light passes. */
#ifndef ISO_RENDER_GAUSSIANS_GAUSSIANS_H
#define ISO_RENDER_GAUSSIANS_GAUSSIANS_H

#include "render/layers/compose.h"
#include "render/view/clip.h"

#define ISO_GAUSSIAN_LOW_PASS 0.3f      /* square samples, added to the variances in the picture */
#define ISO_GAUSSIAN_LEAST (1.0f / 255) /* opacity of a contribution that counts */
#define ISO_GAUSSIAN_CUT (1.0f / 512)   /* share of the light that is left when a sample is finished */
#define ISO_GAUSSIAN_OUTSIDE 0.15       /* how far outside the picture J is taken, in parts of its sides */
#define ISO_GAUSSIAN_NEAREST 200        /* depth of the nearest centres that are drawn, in iso_view.near */

/* Gaussians. All arrays are borrowed and have one item for each. */
typedef struct iso_gaussians {
    iso_vec3 origin; /* added to every position */
    const float (*positions)[3];
    const float (*axes)[9];     /* three vectors, the columns of a matrix A with A A' = S: the axes of the
                                 ellipsoid with its standard deviations as lengths, mm */
    const float *opacities;     /* at the centre, 0 .. 1 */
    const uint8_t (*colors)[3]; /* display values; NULL: `color` for all */
    iso_rgb color;
    size_t count;
    const iso_clip *clip; /* NULL, or what is cut away: the Gaussians whose centres lie there */
} iso_gaussians;

/* The median standard deviation of Gaussians, mm, of some thousands of them; 1 if they have no size. */
double iso_gaussians_size(const float (*axes)[9], size_t count);

/* Draws Gaussians over the opaque surfaces of picture->strip into the strip's rows of the image. An opaque
 * surface hides the Gaussians whose centres lie behind it. A sample's number of layers is that of the
 * Gaussians that it shows. *totals is added to. Takes about 100 bytes for each Gaussian in view.
 * ISO_ERR_NOMEM; ISO_ERR_LIMIT: 2^32 Gaussians or more. The same bytes for every number of threads,
 * instruction set and division of the picture into strips. */
iso_status iso_shade_gaussians(const iso_gaussians *gaussians, const iso_layer_picture *picture,
                               iso_layer_totals *totals, iso_error *error);

#endif
