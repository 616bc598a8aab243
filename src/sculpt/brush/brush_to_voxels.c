/* Converts a brush and a touch, given in world millimetres, to dabs in voxels of the grid. */
#include <math.h>
#include <stddef.h>
#include <string.h>

#include "sculpt/brush/dab.h"
#include "sculpt/field/paint.h"

/* Converts a world position to index coordinates and rounds them to 1/4096 voxel. Differences between such
 * positions and voxels are exact in floats, so mirrored touches give mirrored results, to the bit. */
static void to_rounded_index(const iso_affine *affine, iso_vec3 world, double out[3]) {
    iso_vec3 p = iso_affine_point_to_index(affine, world);
    out[0] = rint(p.x * 4096) / 4096;
    out[1] = rint(p.y * 4096) / 4096;
    out[2] = rint(p.z * 4096) / 4096;
}

/* Returns the world position whose index coordinates are those of `world` after rounding. */
static iso_vec3 snapped(const iso_affine *affine, iso_vec3 world) {
    double p[3];
    to_rounded_index(affine, world, p);
    return iso_affine_point(affine, iso_vec3_make(p[0], p[1], p[2]));
}

/* Computes three perpendicular unit vectors in world coordinates. frame[2] is the normal, or the z axis if
 * the normal has length 0. */
static void make_tangent_frame(iso_vec3 normal, iso_vec3 frame[3]) {
    iso_vec3 n = iso_vec3_unit(normal);
    if (iso_vec3_length(n) == 0) n = iso_vec3_make(0, 0, 1);
    /* the coordinate axis that is closest to perpendicular to the normal */
    iso_vec3 a = fabs(n.x) <= fabs(n.y) && fabs(n.x) <= fabs(n.z) ? iso_vec3_make(1, 0, 0)
                 : fabs(n.y) <= fabs(n.z)                         ? iso_vec3_make(0, 1, 0)
                                                                  : iso_vec3_make(0, 0, 1);
    frame[0] = iso_vec3_unit(iso_vec3_cross(a, n));
    frame[1] = iso_vec3_cross(n, frame[0]);
    frame[2] = n;
}

/* Computes the frame of a picture: frame[1] is the direction of its upper edge, frame[2] the normal. `up`
 * need not be perpendicular to that. */
static void make_picture_frame(iso_vec3 normal, iso_vec3 up, iso_vec3 frame[3]) {
    const iso_vec3 n = iso_vec3_unit(normal), others[] = {up, {0, 0, 1}, {0, 1, 0}};
    make_tangent_frame(normal, frame);
    for (int i = 0; i < 3; i++) {
        const iso_vec3 across = iso_vec3_sub(others[i], iso_vec3_scale(n, iso_vec3_dot(n, others[i])));
        if (!(iso_vec3_length(across) > 0.1 * iso_vec3_length(others[i]))) continue;
        frame[1] = iso_vec3_unit(across);
        frame[0] = iso_vec3_cross(frame[1], frame[2]);
        return;
    }
}

/* Makes an image of a touch. The axes of the dab are turned and mirrored, too, so that boxes and stamps are.
 */
static void make_dab(const iso_dab_space *space, const iso_brush *brush, const iso_touch *touch,
                     const iso_brush_image *image, iso_dab *dab) {
    const iso_affine *affine = space->affine;
    iso_vec3 from = brush->tool == ISO_TOOL_MOVE ? touch->first.position : touch->previous.position, frame[3];
    to_rounded_index(affine, iso_brush_image_point(image, snapped(affine, touch->sample.position)),
                     dab->centre);
    to_rounded_index(affine, iso_brush_image_point(image, snapped(affine, from)), dab->from);
    if (brush->alpha == ISO_ALPHA_NONE || !iso_tool_has_alpha(brush->tool))
        make_tangent_frame(touch->sample.normal, frame);
    else
        make_picture_frame(touch->sample.normal,
                           brush->alpha == ISO_ALPHA_FOLLOWS
                               ? iso_vec3_sub(touch->sample.position, touch->previous.position)
                               : iso_vec3_make(0, 0, 0),
                           frame);
    for (int i = 0; i < 3; i++) {
        iso_vec3 axis = iso_affine_vector_to_index(affine, iso_brush_image_direction(image, frame[i]));
        axis = iso_vec3_scale(axis, space->spacing); /* of length 1 voxel instead of 1 mm */
        dab->axis[i][0] = axis.x;
        dab->axis[i][1] = axis.y;
        dab->axis[i][2] = axis.z;
    }
    dab->plane = 0;
}

static double length_of(const double a[3], const double b[3]) {
    return sqrt((a[0] - b[0]) * (a[0] - b[0]) + (a[1] - b[1]) * (a[1] - b[1]) +
                (a[2] - b[2]) * (a[2] - b[2]));
}

/* Whether no voxel is within the influence of two dabs. Turned and mirrored images see the others alike, so
 * that the distances from the first one tell; of repeated ones, which have ends, all do. */
static bool are_apart(const iso_dabs *dabs, bool repeated) {
    const iso_dab *first = &dabs->dab[0];
    const double least = 2 * (iso_dabs_influence(dabs) + 1 +
                              (dabs->solid == ISO_SOLID_CAPSULE ? length_of(first->centre, first->from) : 0));
    for (int k = 0; k < (repeated ? dabs->count : 1); k++)
        for (int i = k + 1; i < dabs->count; i++)
            if (length_of(dabs->dab[k].centre, dabs->dab[i].centre) < least) return false;
    return true;
}

/* Returns the effect of one touch of strength 1 at its centre. For INFLATE and DEFLATE this is an offset in
 * voxels, at most 0.5 so that the surface stays inside the band; for all other tools it is a factor. */
static double full_strength(iso_tool tool, double radius_voxels) {
    switch (tool) {
    case ISO_TOOL_INFLATE:
    case ISO_TOOL_DEFLATE:
        return 0.05 * radius_voxels < 0.5 ? 0.05 * radius_voxels : 0.5;
    case ISO_TOOL_FLATTEN:
    case ISO_TOOL_SCRAPE:
    case ISO_TOOL_FILL:
    case ISO_TOOL_CLAY:
        return 0.3;
    case ISO_TOOL_PINCH:
    case ISO_TOOL_CREASE:
        return 0.15;
    default:
        return 1;
    }
}

/* Returns the depth (iso_dabs) of one touch of strength 1, within the band. */
static double full_depth(iso_tool tool, double radius_voxels) {
    if (tool == ISO_TOOL_CLAY) return fmin(0.1 * radius_voxels, 1.25);
    if (tool == ISO_TOOL_CREASE) return fmin(0.025 * radius_voxels, 0.25);
    return 0;
}

void iso_dabs_make(const iso_dab_space *space, const iso_brush *brush, const iso_touch *touch,
                   iso_dabs *dabs) {
    double pressure = touch->sample.pressure;
    double radius_voxels = brush->radius * (brush->pressure_radius ? pressure : 1) / space->spacing;
    double strength = (brush->strength > 0 ? brush->strength : 1) * (brush->pressure_strength ? pressure : 1);
    bool blends = brush->tool == ISO_TOOL_BLEND_ADD || brush->tool == ISO_TOOL_BLEND_CARVE;
    double blend_voxels = brush->blend > 0 ? brush->blend / space->spacing : 0.25 * radius_voxels;
    double band =
        (double)
            space->band; /* a fillet is at most as wide as the band, because distances are known only there */
    iso_brush_image images[ISO_DAB_MAX];
    memset(dabs, 0, offsetof(iso_dabs, dab));
    dabs->tool = brush->tool;
    dabs->solid = brush->shape;
    dabs->falloff = brush->falloff;
    dabs->radius_voxels = (float)radius_voxels;
    dabs->strength = (float)(strength * full_strength(brush->tool, radius_voxels));
    dabs->depth = (float)(strength * full_depth(brush->tool, radius_voxels));
    dabs->aspect = (float)(brush->aspect > 0 ? brush->aspect : 0.5);
    dabs->blend_voxels = blends ? (float)(blend_voxels < band ? blend_voxels : band) : 0;
    dabs->band = space->band;
    if (brush->has_color) dabs->color = iso_paint_make(brush->color.r, brush->color.g, brush->color.b, 255);
    dabs->cover = (int)(strength * ISO_PAINT_ONE + 0.5);
    dabs->stamp = space->stamp && space->stamp->count ? iso_stamp_level(space->stamp, radius_voxels) : NULL;
    if (brush->alpha != ISO_ALPHA_NONE && iso_tool_has_alpha(brush->tool) && space->stamp)
        dabs->heights = space->stamp->heights.value ? &space->stamp->heights : NULL;
    dabs->averaged = iso_brush_is_radial(brush) || iso_brush_is_repeated(brush);
    dabs->count = iso_brush_images(brush, images);
    for (int i = 0; i < dabs->count; i++) make_dab(space, brush, touch, &images[i], &dabs->dab[i]);
    dabs->apart = dabs->count == 1 || (dabs->averaged && are_apart(dabs, iso_brush_is_repeated(brush)));
}
