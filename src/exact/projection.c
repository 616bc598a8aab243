/* Projection of grids and octants in double precision: matrices from the camera, boxes of pixels (exact ones
 * by clipping at the near plane, or first-order bounds far from the eye), and the order of octants. */
#include "exact/projection.h"

#include <float.h>
#include <math.h>

/* ---- the projection */

/* Sets `ray` (columns of the inverse of `matrix`), `eye` and `split`. The ray through the view-space
 * direction d is index = eye + depth * inverse(matrix) * d. */
static void set_rays(iso_exact_projection *projection, const iso_affine *affine) {
    const iso_view *view = projection->target->view;
    double inverse[3][3], largest = 0; /* [view axis][index axis] */
    for (int k = 0; k < 3; k++)
        for (int i = 0; i < 3; i++) {
            inverse[k][i] = 0;
            for (int j = 0; j < 3; j++)
                inverse[k][i] += affine->inverse[3 * i + j] * view->rotation[3 * k + j];
            largest = fmax(largest, fabs(inverse[k][i]));
        }
    for (int k = 0; k < 3; k++)
        for (int i = 0; i < 3; i++) projection->ray[k][i] = (float)(2 * inverse[k][i]);
    /* Makes sure that no direction has a component of exactly 0, because later code divides by each
     * component. */
    for (int i = 0; i < 3; i++) projection->ray[2][i] += (float)(1e-9 * largest);
    for (int i = 0; i < 3; i++) {
        projection->eye[i] = 0;
        for (int k = 0; k < 3; k++) projection->eye[i] -= inverse[k][i] * projection->origin[k];
        /* front-to-back order goes away from the eye, or along the parallel rays */
        double split = projection->perspective ? floor(projection->eye[i]) : inverse[2][i] >= 0 ? -1e9 : 1e9;
        projection->split[i] = (int)fmin(fmax(split, -1e9), 1e9);
    }
}

static double depth_of(const iso_exact_projection *projection, const double index[3]) {
    const double *m = projection->matrix;
    return m[6] * index[0] + m[7] * index[1] + m[8] * index[2] + projection->origin[2];
}

iso_exact_projection iso_exact_projection_make(const iso_target *target, const iso_exact *exact) {
    const iso_view *view = target->view;
    const iso_transform *transform = &exact->transform;
    const iso_projector projector = iso_projector_make(view, transform);
    const iso_affine affine = iso_transform_affine(transform);
    iso_exact_projection projection = {.target = target, .exact = exact, .perspective = !view->orthographic};
    for (int i = 0; i < 9; i++) projection.matrix[i] = projector.matrix[i];
    for (int i = 0; i < 3; i++) projection.origin[i] = projector.origin[i];
    for (int i = 0; i < 9; i++) projection.normal[i] = exact->surface.normal_sign * projector.normal[i];
    projection.clip = target->clip && target->clip->count ? target->clip : NULL;
    projection.to_world = affine;
    set_rays(&projection, &affine);
    for (int k = 0; k < 3; k++) projection.half_depth += 0.5 * fabs(projection.matrix[6 + k]);
    const double centre[2] = {view->cx, view->cy};
    for (int k = 0; k < 2; k++) {
        projection.axis[k] = (int)floor(centre[k]);
        projection.offset[k] = 0.5 - (centre[k] - floor(centre[k]));
    }
    const int *dims = exact->dims;
    projection.middle = (float)depth_of(
        &projection, (const double[3]){0.5 * (dims[0] - 1), 0.5 * (dims[1] - 1), 0.5 * (dims[2] - 1)});
    projection.per_focal = projection.perspective ? (float)(1 / view->focal) : 0;
    const float part = exact->type == ISO_FLOAT32 ? 0.25f : 1;
    projection.isovalue_ceil = part * exact->surface.isovalue_ceil;
    projection.residual = part * exact->surface.residual;
    return projection;
}

/* ---- boxes in the picture */

/* A rectangle in the picture, in pixels from the optical axis. */
typedef struct pixel_box {
    double x0, x1, y0, y1;
} pixel_box;

static void add_point(const iso_exact_projection *projection, const double p[3], pixel_box *box) {
    const double scale =
        projection->perspective ? projection->target->view->focal / p[2] : projection->target->view->focal;
    box->x0 = fmin(box->x0, p[0] * scale);
    box->x1 = fmax(box->x1, p[0] * scale);
    box->y0 = fmin(box->y0, p[1] * scale);
    box->y1 = fmax(box->y1, p[1] * scale);
}

/* The projected box of the part of a cuboid that is behind the near plane: the box of its corners there, and
 * of the points where its edges meet the plane. */
static pixel_box clipped_box(const iso_exact_projection *projection, double corner[8][3]) {
    pixel_box box = {DBL_MAX, -DBL_MAX, DBL_MAX, -DBL_MAX};
    const double near = projection->target->view->near;
    for (int i = 0; i < 8; i++) {
        if (!(corner[i][2] >= near)) continue;
        add_point(projection, corner[i], &box);
        for (int axis = 0; axis < 3; axis++) {
            const double *other = corner[i ^ 1 << axis];
            if (other[2] >= near) continue;
            const double t = (near - corner[i][2]) / (other[2] - corner[i][2]);
            double p[3] = {corner[i][0] + t * (other[0] - corner[i][0]),
                           corner[i][1] + t * (other[1] - corner[i][1]), near};
            add_point(projection, p, &box);
        }
    }
    return box;
}

/* Sets `pixels` to the pixels of `clip` whose centres are in the box (both x0 x1 y0 y1); false if there are
 * none. The box is enlarged by a hundredth of a pixel and 1e-5 of its size, because callers work with rounded
 * values. */
static bool clip_to_pixels(const iso_exact_projection *projection, pixel_box box, const int clip[4],
                           int pixels[4]) {
    const double slack = 0.01, relative = 1e-5;
    const double reach[2] = {slack + relative * (box.x1 - box.x0), slack + relative * (box.y1 - box.y0)};
    const double low[2] = {box.x0, box.y0}, high[2] = {box.x1, box.y1};
    for (int k = 0; k < 2; k++) {
        const double shift = projection->axis[k] - projection->offset[k];
        const double first = ceil(low[k] - reach[k] + shift), last = floor(high[k] + reach[k] + shift);
        if (!(first <= clip[2 * k + 1] && last >= clip[2 * k] && first <= last)) return false;
        pixels[2 * k] = first > clip[2 * k] ? (int)first : clip[2 * k];
        pixels[2 * k + 1] = last < clip[2 * k + 1] ? (int)last : clip[2 * k + 1];
    }
    return true;
}

static void transform_to_view(const iso_exact_projection *projection, const double index[3], double view[3]) {
    const double *m = projection->matrix;
    for (int k = 0; k < 3; k++)
        view[k] =
            m[3 * k] * index[0] + m[3 * k + 1] * index[1] + m[3 * k + 2] * index[2] + projection->origin[k];
}

bool iso_exact_pixel_box(const iso_exact_projection *projection, const double centre[3], const double half[3],
                         const int clip[4], int pixels[4]) {
    double corner[8][3];
    for (int i = 0; i < 8; i++) {
        double index[3];
        for (int axis = 0; axis < 3; axis++)
            index[axis] = centre[axis] + (i >> axis & 1 ? half[axis] : -half[axis]);
        transform_to_view(projection, index, corner[i]);
    }
    return clip_to_pixels(projection, clipped_box(projection, corner), clip, pixels);
}

/* Like iso_exact_pixel_box, for a box far from the eye, from a bound around its projected centre (x, y, z):
 * (x + dx) / (z + dz) differs from x / z by (dx - x / z * dz) / (z + dz), and z + dz > 0 is needed in the
 * whole box. */
static bool far_box_pixels(const iso_exact_projection *projection, const double centre[3],
                           const double half[3], const int clip[4], int pixels[4]) {
    const double *m = projection->matrix, focal = projection->target->view->focal;
    double p[3], reach_z = 0, reach[2] = {0, 0};
    transform_to_view(projection, centre, p);
    for (int i = 0; i < 3; i++) reach_z += fabs(m[6 + i]) * half[i];
    if (p[2] + reach_z < projection->target->view->near) return false;
    const double x = projection->perspective ? p[0] / p[2] : p[0],
                 y = projection->perspective ? p[1] / p[2] : p[1];
    const double tilt_x = projection->perspective ? x : 0, tilt_y = projection->perspective ? y : 0;
    for (int i = 0; i < 3; i++) {
        reach[0] += fabs(m[i] - tilt_x * m[6 + i]) * half[i];
        reach[1] += fabs(m[3 + i] - tilt_y * m[6 + i]) * half[i];
    }
    const double scale = projection->perspective ? focal / (p[2] - reach_z) : focal;
    const pixel_box box = {focal * x - scale * reach[0], focal * x + scale * reach[0],
                           focal * y - scale * reach[1], focal * y + scale * reach[1]};
    return clip_to_pixels(projection, box, clip, pixels);
}

/* Like iso_exact_pixel_box, by the cheaper far_box_pixels where the box is far enough from the eye. */
static bool box_pixels(const iso_exact_projection *projection, const double centre[3], const double half[3],
                       const int clip[4], int pixels[4]) {
    if (projection->perspective) {
        double p[3], reach_z = 0;
        transform_to_view(projection, centre, p);
        for (int i = 0; i < 3; i++) reach_z += fabs(projection->matrix[6 + i]) * half[i];
        /* next to the eye, the bound of far_box_pixels is too wide */
        if (!(p[2] - reach_z > 0.2 * p[2]))
            return iso_exact_pixel_box(projection, centre, half, clip, pixels);
    }
    return far_box_pixels(projection, centre, half, clip, pixels);
}

static bool is_cut_away(const iso_exact_projection *projection, const double centre[3],
                        const double half[3]) {
    unsigned cutting;
    return iso_exact_clip_of_box(projection, centre, half, &cutting) == ISO_CLIP_NOTHING;
}

static bool is_in_picture(const iso_exact_projection *projection, const double centre[3],
                          const double half[3], iso_exact_box *box) {
    const iso_view *view = projection->target->view;
    const int clip[4] = {0, view->width - 1, 0, view->height - 1};
    int pixels[4];
    if (!box_pixels(projection, centre, half, clip, pixels)) return false;
    *box =
        (iso_exact_box){(uint16_t)pixels[0], (uint16_t)pixels[1], (uint16_t)pixels[2], (uint16_t)pixels[3]};
    return true;
}

bool iso_exact_brick_is_visible(const iso_exact_projection *projection, const int32_t brick[3],
                                iso_exact_box *box) {
    double centre[3];
    const double half[3] = {0.5 * ISO_BRICK, 0.5 * ISO_BRICK, 0.5 * ISO_BRICK};
    for (int axis = 0; axis < 3; axis++) centre[axis] = (double)ISO_BRICK * brick[axis] + half[axis];
    return is_in_picture(projection, centre, half, box);
}

int iso_exact_list_visible_octants(const iso_exact_projection *projection, uint32_t number,
                                   iso_exact_visible *visible) {
    const iso_exact_span *span = &iso_exact_spans(projection->exact)[number];
    double corner[3], centre[3], half[3];
    int split[3];
    for (int axis = 0; axis < 3; axis++) {
        corner[axis] = (double)ISO_BRICK * span->brick[axis];
        /* the cell where the order turns, counted from the brick's first; 0 .. 7: it is in the lower
         * octants */
        const double cells = projection->split[axis] - corner[axis];
        split[axis] = cells < 0 ? 0 : cells < ISO_EXACT_SIDE ? 0 : cells < ISO_BRICK ? 1 : 2;
    }
    const iso_exact_octant *at[ISO_EXACT_OCTANTS] = {0};
    for (uint32_t i = 0; i < span->octants; i++) {
        const iso_exact_octant *octant = &iso_exact_octants(projection->exact)[span->octant + i];
        int rank = 0;
        for (int axis = 0; axis < 3; axis++)
            rank |= iso_exact_rank(octant->origin[axis] / ISO_EXACT_SIDE, 2, split[axis]) << axis;
        at[rank] = octant;
    }
    int count = 0;
    for (int rank = 0; rank < ISO_EXACT_OCTANTS; rank++) {
        const iso_exact_octant *octant = at[rank];
        if (!octant) continue;
        for (int axis = 0; axis < 3; axis++) {
            const double first = corner[axis] + octant->origin[axis] + octant->low[axis];
            half[axis] = 0.5 * (octant->high[axis] + 1 - octant->low[axis]);
            centre[axis] = first + half[axis];
        }
        iso_exact_box box;
        if (!is_in_picture(projection, centre, half, &box) || is_cut_away(projection, centre, half)) continue;
        visible[count++] = (iso_exact_visible){
            .span = number,
            .octant = (uint32_t)(octant - iso_exact_octants(projection->exact)),
            .box = box,
            .corners = iso_exact_corners(projection->exact, span, octant),
        };
    }
    return count;
}

/* ---- cells in an octant */

iso_exact_octant_projection iso_exact_project_octant(const iso_exact_projection *projection,
                                                     const iso_exact_span *span,
                                                     const iso_exact_octant *octant) {
    const double *m = projection->matrix, focal = projection->target->view->focal;
    const double near = projection->target->view->near, reach = ISO_EXACT_SIDE * projection->half_depth;
    double index[3], p[3];
    for (int i = 0; i < 3; i++)
        index[i] = (double)ISO_BRICK * span->brick[i] + octant->origin[i] + 0.5 * ISO_EXACT_SIDE;
    transform_to_view(projection, index, p);
    iso_exact_octant_projection result = {
        .near = projection->perspective && p[2] < reach + 2 * projection->half_depth,
        .clip = p[2] - reach < near,
        .focal = (float)focal,
        .depth = (float)p[2],
        .relative = (float)(p[2] - projection->middle),
        .behind = (float)fmin(p[2] - near, FLT_MAX),
    };
    for (int i = 0; i < 3; i++) result.along[i] = (float)m[6 + i];
    for (int k = 0; k < 2; k++) {
        result.origin[k] = projection->axis[k];
        result.off_axis[k] = (float)projection->offset[k];
    }
    if (result.near) return result;
    result.cell_pixels = 1;
    for (int k = 0; k < 2; k++) {
        const double size = fabs(m[3 * k]) + fabs(m[3 * k + 1]) + fabs(m[3 * k + 2]);
        result.cell_pixels *= (float)(size * focal / (projection->perspective ? p[2] : 1));
        const double reference = projection->perspective ? (float)(p[k] / p[2]) : 0;
        const double projected = focal * (projection->perspective ? reference : p[k]),
                     pixel = floor(projected);
        result.origin[k] = projection->axis[k] + (int)pixel;
        result.off_axis[k] = (float)(pixel + projection->offset[k]);
        result.place[k] = (float)(projected - pixel - projection->offset[k]);
        result.residue[k] = projection->perspective ? (float)(p[k] - reference * p[2]) : 0;
        result.reference[k] = (float)reference;
        for (int i = 0; i < 3; i++) {
            result.across[k][i] = (float)m[3 * k + i];
            result.sheared[k][i] = (float)(m[3 * k + i] - reference * m[6 + i]);
        }
    }
    return result;
}
