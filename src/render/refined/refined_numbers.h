/* refined_numbers: the numbers of the refined reconstruction (render/refined/refined.h), for C and GLSL. */
#ifndef ISO_RENDER_REFINED_REFINED_NUMBERS_H
#define ISO_RENDER_REFINED_REFINED_NUMBERS_H

/* Radius of a disc's ball in radii of its point: BALL, for extracted points 0.85 voxel, about the smallest
 * that leaves no holes; plus up to BALL_MORE (1 voxel) where that is many pixels: more discs overlap and
 * noise averages out. */
#define ISO_REFINED_BALL 1.2f
#define ISO_REFINED_BALL_MORE 0.215f
/* The growth begins at a point radius of GROW_FROM pixels and is complete GROW_OVER pixels later. */
#define ISO_REFINED_GROW_FROM 4.5f
#define ISO_REFINED_GROW_OVER 6.0f

/* Pixels: discs of a smaller radius are drawn flat, as their curvature would not be visible. */
#define ISO_REFINED_FLAT_RADIUS 0.9f
/* 1 / voxel: curvature from which discs are clipped to their extents, and curvature at which it is as
 * likely noise as surface. */
#define ISO_REFINED_TURNING_BEND 0.15f
#define ISO_REFINED_NOISY_BEND 1.8f
/* Voxels by which discs are drawn beyond their extents: without overlap cracks would show between them. */
#define ISO_REFINED_BEYOND_END 0.08f
/* Voxels: a packed point nearer to a voxel than this may belong to the edge on either side of it. */
#define ISO_REFINED_AT_VOXEL 0.002f

/* Square of a cosine: discs whose normals face away by less may still be visible because of their
 * curvature. */
#define ISO_REFINED_BACK_FACING 0.04f
/* Radius / distance to the eye above which a disc is intersected with the pixels' own rays; rays through
 * smaller discs count as parallel. */
#define ISO_REFINED_EXACT 0.02f
/* The same for flat discs. */
#define ISO_REFINED_FLAT_EXACT 0.001f
/* A disc is averaged with the front when it lies behind it by less than this, in radii of the disc. */
#define ISO_REFINED_THICKNESS 1.5f

/* exp(-2 q) for q in 0 .. 1, within 0.0025: a polynomial, of which the constant is 1. */
#define ISO_REFINED_GAUSS_1 -1.9457733f
#define ISO_REFINED_GAUSS_2 1.6291067f
#define ISO_REFINED_GAUSS_3 -0.5504321f

#endif
