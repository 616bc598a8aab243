/* The functions of isopoint.h that compare pictures. */
#include "compare/metrics.h"

#include "isopoint.h"

static iso_compare_picture picture_of(const iso_image *image, const iso_aov *aov) {
    iso_compare_picture picture = {.width = image->width, .height = image->height, .rgba = image->rgba};
    if (!aov) return picture;
    picture.depth = aov->depth;
    picture.coverage = aov->coverage;
    for (int axis = 0; axis < 3; axis++) picture.normal[axis] = aov->normal[axis];
    return picture;
}

static iso_status check(const iso_image *image, const iso_aov *aov, const char *name, iso_error *error) {
    if (!image->rgba) return iso_fail(error, ISO_ERR_USAGE, "%s has no pixels", name);
    if (aov && (aov->width != image->width || aov->height != image->height))
        return iso_fail(error, ISO_ERR_MISMATCH, "%s is %d x %d pixels, its depth and normals %d x %d", name,
                        image->width, image->height, aov->width, aov->height);
    return ISO_OK;
}

static iso_difference difference_of(const iso_metrics *m) {
    return (iso_difference){.psnr_in = m->psnr_in,
                            .psnr = m->psnr,
                            .error_p99 = m->error_p99,
                            .error_max = m->error_max,
                            .ssim = m->ssim,
                            .flip = m->flip,
                            .iou = m->iou,
                            .dilation_mean = m->dilation_mean,
                            .dilation_p99 = m->dilation_p99,
                            .dilation_max = m->dilation_max,
                            .dilation_mean_voxel = m->dilation_mean_voxel,
                            .dilation_max_voxel = m->dilation_max_voxel,
                            .holes = m->holes,
                            .normal_error_deg = m->normal_error_deg,
                            .depth_error_voxel = m->depth_error_voxel,
                            .wrong = m->wrong,
                            .pixels_differing = m->pixels_differing};
}

iso_status iso_compare_images(const iso_image *truth, const iso_image *candidate,
                              const iso_difference_opts *opts, iso_difference *difference, iso_error *error) {
    static const iso_difference_opts defaults;
    if (!opts) opts = &defaults;
    ISO_TRY(check(truth, opts->truth_aov, "the truth", error));
    ISO_TRY(check(candidate, opts->candidate_aov, "the candidate", error));
    const iso_rgb white = {255, 255, 255};
    const double known = opts->truth_aov ? (double)opts->truth_aov->voxel : 0;
    const iso_compare_opts how = {.background = opts->background ? *opts->background : white,
                                  .voxel = opts->voxel > 0 ? opts->voxel : known,
                                  .pixels_per_voxel = opts->pixels_per_voxel,
                                  .pixels_per_degree = opts->pixels_per_degree,
                                  .flip_map = opts->flip_map};
    const iso_compare_picture a = picture_of(truth, opts->truth_aov),
                              b = picture_of(candidate, opts->candidate_aov);
    iso_metrics metrics;
    ISO_TRY(iso_compare(&a, &b, &how, &metrics, error));
    *difference = difference_of(&metrics);
    return ISO_OK;
}
