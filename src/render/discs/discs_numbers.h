/* discs_numbers: the constants of the method discs (render/discs/discs.h), for C and GLSL. */
#ifndef ISO_RENDER_DISCS_DISCS_NUMBERS_H
#define ISO_RENDER_DISCS_DISCS_NUMBERS_H

/* Radius of a disc's ball, in radii of its point: BALL, which is 0.85 voxel for extracted points and about
 * the smallest that leaves no holes, plus up to BALL_MORE (then 1 voxel) where discs cover many pixels:
 * more of them overlap, which averages noise. */
#define ISO_DISCS_BALL 1.2f
#define ISO_DISCS_BALL_MORE 0.215f
/* The growth begins at a point radius of GROW_FROM pixels and is complete GROW_OVER pixels later. */
#define ISO_DISCS_GROW_FROM 4.5f
#define ISO_DISCS_GROW_OVER 6.0f
/* The same for flat discs. They grow less and later: the farther a flat disc reaches, the farther it leaves
 * the surface, which widens outlines; without any growth gaps near outlines would show when magnified. */
#define ISO_DISCS_FLAT_MORE 0.16f
#define ISO_DISCS_FLAT_GROW_OVER 60.0f

/* Pixels: discs of a smaller radius are drawn flat, because their curvature would not be visible. */
#define ISO_DISCS_FLAT_RADIUS 0.9f
/* 1 / voxel: curvature from which discs are clipped to their extents, and curvature at which it is as
 * likely noise as surface. */
#define ISO_DISCS_TURNING_CURVATURE 0.15f
#define ISO_DISCS_NOISY_CURVATURE 1.8f
/* Voxels by which discs are drawn beyond their extents: without overlap cracks would show between them. */
#define ISO_DISCS_BEYOND_END 0.08f
/* Voxels: a packed point nearer to a voxel than this may belong to the edge on either side of it. */
#define ISO_DISCS_AT_VOXEL 0.002f

/* Square of the cosine between ray and normal. A back-facing disc with a smaller one is nearly edge-on and
 * may be visible because of its curvature. */
#define ISO_DISCS_BACK_FACING 0.04f
/* Radius / depth above which a disc is intersected with each pixel's own ray. For smaller discs all rays
 * are taken as parallel to the ray through the disc's centre. */
#define ISO_DISCS_EXACT 0.02f
/* The same for flat discs. */
#define ISO_DISCS_FLAT_EXACT 0.001f
/* A disc is averaged with the front when it lies behind it by less than this, in radii of the disc. */
#define ISO_DISCS_THICKNESS 1.5f

/* The low-pass filter against aliasing of flat discs: a Gaussian that is cut off at LOW_PASS pixels, where
 * it is exp(-2); its standard deviation is half of that. Blocks whose discs all have a radius of
 * LOW_PASS_RADIUS pixels or more are not filtered: it would change nothing that can be seen. */
#define ISO_DISCS_LOW_PASS 0.6f
#define ISO_DISCS_LOW_PASS_RADIUS 5.0f
/* Pixels: a pixel's ray hits the plane of a filtered disc at most the disc's radius and this before or
 * behind the disc's centre. */
#define ISO_DISCS_LOW_PASS_DEPTH 4.0f

/* Pixels: if only the centres of discs are drawn, they are averaged with the front when they lie behind it by
 * less than this and the disc's thickness: what a pixel contains of a surface tilted by 76 degrees. */
#define ISO_DISCS_CENTRES_DEPTH 4.0f

/* The weight exp(-2 q), 0 <= q < 1, within 0.0025: coefficients of 1 + GAUSS_1 q + GAUSS_2 q^2 + GAUSS_3
 * q^3. */
#define ISO_DISCS_GAUSS_1 -1.9457733f
#define ISO_DISCS_GAUSS_2 1.6291067f
#define ISO_DISCS_GAUSS_3 -0.5504321f

#endif
