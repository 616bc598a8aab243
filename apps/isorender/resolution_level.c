/* --level auto: chooses the level of a multiscale image for a picture. */
#include <math.h>
#include <string.h>

#include "apps/isorender/resolution_level.h"

static double smallest_spacing(const iso_volume_info *info) {
    const double *s = info->transform.spacing;
    return fmin(s[0], fmin(s[1], s[2]));
}

/* The size of a pixel, mm, at the focal point of the picture that frames the whole volume. */
static double pixel_size(isorender_job *job, const iso_volume_info *info) {
    const iso_affine affine = iso_transform_affine(&info->transform);
    const iso_box index = {.hi = {info->dims[0] - 1, info->dims[1] - 1, info->dims[2] - 1}};
    const iso_box box = iso_box_transform(&index, &affine);
    const iso_camera camera = isorender_camera_of_box(job, &box);
    if (camera.orthographic) return iso_camera_mm_per_pixel(&camera, job->settings->height);
    const double distance = iso_vec3_length(iso_vec3_sub(camera.focal_point, camera.position));
    return 2 * distance * tan(camera.view_angle * acos(-1.0) / 360) / job->settings->height;
}

static bool is_next_level(const iso_volume_info *finer, const iso_volume_info *info) {
    return memcmp(finer->dims, info->dims, sizeof info->dims) != 0;
}

iso_status isorender_level_choose(isorender_job *job, iso_error *error) {
    const char *path = job->plan->input;
    iso_input *input = &job->input;
    *input = job->settings->common.input;
    if (input->level != ISO_LEVEL_AUTO) return ISO_OK;
    input->level = 0;
    iso_volume_opts opts = iso_input_volume_opts(input);
    iso_volume_info info, next;
    if (iso_loader_is_scene(path) || iso_spool_is_stream(path)) return ISO_OK;
    if (iso_loader_reads_points(path, job->settings->columns)) return ISO_OK;
    ISO_TRY(iso_volume_read_info(path, &opts, &info, error));
    const double pixel = pixel_size(job, &info);
    while (smallest_spacing(&info) < pixel / 2) {
        opts.level = input->level + 1;
        const iso_status status = iso_volume_read_info(path, &opts, &next, error);
        if (status == ISO_ERR_USAGE || (status == ISO_OK && !is_next_level(&info, &next))) break;
        ISO_TRY(status);
        info = next;
        input->level++;
    }
    isorender_log(job, "--level auto: level %d, voxels of %g mm; a pixel is %g mm in a picture of the whole",
                  input->level, smallest_spacing(&info), pixel);
    return ISO_OK;
}
