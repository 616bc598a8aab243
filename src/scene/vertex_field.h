/* vertex_field: numbers or colours of a mesh's vertices, anywhere on the mesh: interpolated in the triangle
 * that is nearest. */
#ifndef ISO_SCENE_VERTEX_FIELD_H
#define ISO_SCENE_VERTEX_FIELD_H

#include "base/nearby.h"
#include "base/primitives.h"
#include "base/status.h"
#include "image/image.h"

/* Immutable; thread-safe. */
typedef struct iso_vertex_field iso_vertex_field;

/* Numbers by vertex, or labels with their colours (NULL: numbers): of labels a place has that of the
 * nearest of its triangle's corners. Not finite: none. values NULL: colours alone, which are interpolated.
 * All is copied. ISO_ERR_EMPTY: there is no triangle; ISO_ERR_NOMEM. */
iso_status iso_vertex_field_create(const iso_triangles *mesh, const float *values, const uint8_t (*colors)[3],
                                   iso_vertex_field **field, iso_error *error);
void iso_vertex_field_destroy(iso_vertex_field *field); /* NULL is allowed */

/* Whether it has colours of its own: of labels, or colours alone. */
bool iso_vertex_field_has_colors(const iso_vertex_field *field);

/* The number at a point in the world, mm; NaN: none; of colours alone 0. *color: its own, if it has any.
 * *nearby: as iso_distance_at. */
double iso_vertex_field_at(const iso_vertex_field *field, iso_vec3 point, iso_nearby *nearby, iso_rgb *color);

#endif
