/* refined_numbers: the numbers of the refined reconstruction (render/refined/refined.h), for C and GLSL. */
#ifndef ISO_RENDER_REFINED_REFINED_NUMBERS_H
#define ISO_RENDER_REFINED_REFINED_NUMBERS_H

/* The ball of a disc, in the point's own radii: for extracted points 0.85 voxel, which is about the least
 * that leaves no holes, and up to 1 where that is many pixels: more discs meet there, and what noise there is
 * in them averages out. */
#define ISO_REFINED_BALL 1.2f
#define ISO_REFINED_BALL_MORE 0.215f
/* Pixels of a point's radius. */
#define ISO_REFINED_GROW_FROM 4.5f
#define ISO_REFINED_GROW_OVER 6.0f

/* Pixels: how discs of less bend within them is too little to be seen. */
#define ISO_REFINED_FLAT_RADIUS 0.9f
/* 1 / voxel: how much surfaces bend before it is asked where they turn away, and how much until what bends
 * is as likely noise. (Normals come from gradients over two voxels, shapes from where the surface leaves
 * the faces around an edge.) */
#define ISO_REFINED_TURNING_BEND 0.15f
#define ISO_REFINED_NOISY_BEND 1.8f
/* Voxels that discs go on beyond their ends: if they met in these alone, they would leave cracks. */
#define ISO_REFINED_BEYOND_END 0.08f
/* Voxels: packed points that are so near to a voxel may be on the edge to either side of it. */
#define ISO_REFINED_AT_VOXEL 0.002f

/* Discs whose normals face away by less than the root of this (a cosine) may be in sight where they bend. */
#define ISO_REFINED_BACK_FACING 0.04f
/* Discs of a larger radius, in their distances to the eye, are met by rays that are not nearly parallel. */
#define ISO_REFINED_EXACT 0.02f
/* The same for flat discs, which are met all over at once. */
#define ISO_REFINED_FLAT_EXACT 0.001f
/* Discs join what is in front of them by less, in their radii. */
#define ISO_REFINED_THICKNESS 1.5f

/* exp(-2 q) for q in 0 .. 1, within 0.0025: a polynomial, of which the constant is 1. */
#define ISO_REFINED_GAUSS_1 -1.9457733f
#define ISO_REFINED_GAUSS_2 1.6291067f
#define ISO_REFINED_GAUSS_3 -0.5504321f

#endif
