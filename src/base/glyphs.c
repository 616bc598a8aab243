/* glyphs: bounds, the usual radius, and cropping. */
#include "base/glyphs.h"

#include <math.h>
#include <string.h>

#include "base/memory.h"

void iso_glyphs_free(iso_glyphs *glyphs) {
    iso_free(glyphs->positions);
    iso_free(glyphs->radii);
    iso_free(glyphs->directions);
    iso_free(glyphs->axes);
    iso_free(glyphs->colors);
    iso_free(glyphs->opacities);
    iso_attributes_free(glyphs->attributes, glyphs->attribute_count);
    *glyphs = (iso_glyphs){.count = 0};
}

iso_box iso_glyphs_bounds(const iso_glyphs *glyphs) {
    return iso_positions_bounds(glyphs->origin, (const float(*)[3])glyphs->positions, glyphs->count);
}

double iso_glyphs_usual_radius(const iso_glyphs *glyphs, iso_glyph glyph) {
    if (glyph == ISO_GLYPH_CONE || glyph == ISO_GLYPH_CYLINDER || glyph == ISO_GLYPH_ARROW) return 0;
    const iso_box box = iso_glyphs_bounds(glyphs);
    const double size = iso_vec3_length(iso_vec3_sub(box.hi, box.lo)),
                 radius = fmin(size / cbrt((double)glyphs->count) / 7, size / 150);
    return radius > 0 ? radius : 1; /* a single point, of no size */
}

iso_vec3 iso_glyph_position(const iso_glyphs *glyphs, size_t index) {
    const float *p = glyphs->positions[index];
    return iso_vec3_add(glyphs->origin, iso_vec3_make((double)p[0], (double)p[1], (double)p[2]));
}

bool iso_position_is_inside(iso_vec3 p, const iso_box *box) {
    return p.x >= box->lo.x && p.x <= box->hi.x && p.y >= box->lo.y && p.y <= box->hi.y && p.z >= box->lo.z &&
           p.z <= box->hi.z;
}

/* Moves item `from` of an array, which may be NULL, to the place of item `to`. */
static void move_item(void *array, size_t bytes, size_t from, size_t to) {
    if (array && from != to) memcpy((char *)array + to * bytes, (const char *)array + from * bytes, bytes);
}

void iso_glyphs_crop(iso_glyphs *glyphs, const iso_box *box) {
    size_t kept = 0;
    for (size_t i = 0; i < glyphs->count; i++) {
        if (!iso_position_is_inside(iso_glyph_position(glyphs, i), box)) continue;
        move_item(glyphs->positions, sizeof *glyphs->positions, i, kept);
        move_item(glyphs->radii, sizeof *glyphs->radii, i, kept);
        move_item(glyphs->directions, sizeof *glyphs->directions, i, kept);
        move_item(glyphs->axes, sizeof *glyphs->axes, i, kept);
        move_item(glyphs->colors, sizeof *glyphs->colors, i, kept);
        move_item(glyphs->opacities, sizeof *glyphs->opacities, i, kept);
        for (int k = 0; k < glyphs->attribute_count; k++) {
            const iso_attribute *attribute = &glyphs->attributes[k];
            move_item(attribute->values, (size_t)attribute->components * sizeof(float), i, kept);
        }
        kept++;
    }
    glyphs->closed &= kept == glyphs->count;
    glyphs->count = kept;
}
