/* clip: the bodies that cut an octant, and which of its cells they cut or cut away; in double precision. */

#include "exact/kernel.h"

iso_clip_rest iso_exact_clip_of_box(const iso_exact_projection *projection, const double centre[3],
                                    const double half[3], unsigned *cutting) {
    *cutting = 0;
    if (!projection->clip) return ISO_CLIP_ALL;
    const double slack = 1e-3; /* voxels: cells are drawn a little larger than they are */
    const iso_affine *affine = &projection->to_world;
    const iso_vec3 at = iso_affine_point(affine, iso_vec3_make(centre[0], centre[1], centre[2]));
    const iso_vec3 sides[3] = {iso_affine_vector(affine, iso_vec3_make(half[0] + slack, 0, 0)),
                               iso_affine_vector(affine, iso_vec3_make(0, half[1] + slack, 0)),
                               iso_affine_vector(affine, iso_vec3_make(0, 0, half[2] + slack))};
    return iso_clip_of_box(projection->clip, at, sides, cutting);
}

/* `body` in voxels from the octant's centre, which is at `centre` in the world. */
static iso_exact_cut make_cut(const iso_affine *affine, const iso_clip_body *body, iso_vec3 centre) {
    iso_exact_cut cut = {.faces = body->faces, .keeps = body->keeps};
    const double *m = affine->m;
    const double c[3] = {centre.x, centre.y, centre.z};
    for (int i = 0; i < body->faces; i++) {
        const double *f = body->face[i];
        for (int k = 0; k < 3; k++) cut.face[i][k] = (float)(f[0] * m[k] + f[1] * m[3 + k] + f[2] * m[6 + k]);
        cut.face[i][3] = (float)(f[0] * c[0] + f[1] * c[1] + f[2] * c[2] - f[3]);
    }
    if (body->faces) return cut;
    const iso_vec3 from = iso_vec3_sub(centre, body->centre);
    cut.constant = (float)(iso_vec3_dot(from, from) - body->radius * body->radius);
    for (int k = 0; k < 3; k++) {
        const int other = (k + 1) % 3;
        cut.linear[k] = (float)(2 * (from.x * m[k] + from.y * m[3 + k] + from.z * m[6 + k]));
        cut.square[k] = (float)(m[k] * m[k] + m[3 + k] * m[3 + k] + m[6 + k] * m[6 + k]);
        cut.square[3 + k] = (float)(m[k] * m[other] + m[3 + k] * m[3 + other] + m[6 + k] * m[6 + other]);
    }
    return cut;
}

static void cut_cells(const iso_exact_projection *projection, const double corner[3],
                      iso_exact_scratch *scratch) {
    const double half[3] = {0.5, 0.5, 0.5};
    for (int i = 0; i < scratch->octant->cells; i++) {
        const int position = scratch->position[i];
        const double centre[3] = {corner[0] + (position & 7) + 0.5, corner[1] + (position >> 3 & 7) + 0.5,
                                  corner[2] + (position >> 6) + 0.5};
        unsigned cutting;
        const iso_clip_rest rest = iso_exact_clip_of_box(projection, centre, half, &cutting);
        scratch->is_cut[i] = rest == ISO_CLIP_SOME;
        if (rest == ISO_CLIP_NOTHING) scratch->box[1][i] = scratch->box[0][i] - 1;
    }
}

void iso_exact_cut_octant(const iso_exact_projection *projection, iso_exact_scratch *scratch) {
    double corner[3], centre[3];
    const double half[3] = {0.5 * ISO_EXACT_SIDE, 0.5 * ISO_EXACT_SIDE, 0.5 * ISO_EXACT_SIDE};
    for (int axis = 0; axis < 3; axis++) {
        corner[axis] = (double)ISO_BRICK * scratch->span->brick[axis] + scratch->octant->origin[axis];
        centre[axis] = corner[axis] + half[axis];
    }
    unsigned cutting;
    scratch->cuts = 0;
    iso_exact_clip_of_box(projection, centre, half, &cutting);
    if (!cutting) return;
    const iso_vec3 world =
        iso_affine_point(&projection->to_world, iso_vec3_make(centre[0], centre[1], centre[2]));
    for (int i = 0; i < projection->clip->count; i++)
        if (cutting >> i & 1)
            scratch->cut[scratch->cuts++] =
                make_cut(&projection->to_world, &projection->clip->body[i], world);
    cut_cells(projection, corner, scratch);
}
