/* tensor: eigenvalues and eigenvectors of a symmetric tensor. */
#ifndef ISO_BASE_TENSOR_H
#define ISO_BASE_TENSOR_H

typedef struct iso_eigen {
    double values[3];     /* in descending order */
    double vectors[3][3]; /* vectors[i]: unit vector for values[i]; perpendicular to each other; the sign is
                             arbitrary */
} iso_eigen;

/* Decomposes the tensor xx xy xz yy yz zz, whose entries must be finite. The bits are the same on every
 * machine, because only square roots are used. */
iso_eigen iso_tensor_eigen(const float tensor[6]);

/* Returns the fractional anisotropy of eigenvalues, 0 (a sphere) .. 1 (a needle); 0 when all are 0 (Basser
 * and Pierpaoli 1996, "Microstructural and physiological features of tissues elucidated by
 * quantitative-diffusion-tensor MRI"). */
double iso_eigen_anisotropy(const iso_eigen *eigen);

#endif
