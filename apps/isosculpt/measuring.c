/* Measures places and solids, and says the results. */
#include "apps/isosculpt/measuring.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

static double distance_of(const iso_measured_place *a, const iso_measured_place *b) {
    return iso_vec3_length(iso_vec3_sub(a->position, b->position));
}

iso_status isosculpt_measuring_pick(isosculpt_measuring *measuring, const iso_grid *grid, iso_vec3 point,
                                    iso_pool *pool, iso_error *error) {
    iso_measured_place place;
    ISO_TRY(iso_measure_place(grid, point, pool, &place, error));
    if (measuring->count == 2) measuring->count = 0;
    measuring->place[measuring->count++] = place;
    return ISO_OK;
}

double isosculpt_measuring_distance(const isosculpt_measuring *measuring) {
    return distance_of(&measuring->place[0], &measuring->place[1]);
}

void isosculpt_length_text(double length, char *text, size_t size) {
    if (isinf(length))
        snprintf(text, size, "beyond the grid");
    else
        snprintf(text, size, "%.5g mm", length);
}

/* ---- --measure */

static const char *read_place(const char *at, iso_vec3 *place) {
    double *const to[] = {&place->x, &place->y, &place->z};
    for (int axis = 0; axis < 3; axis++) {
        char *end;
        *to[axis] = strtod(at, &end);
        if (end == at || !isfinite(*to[axis]) || (axis < 2 && *end != '/')) return NULL;
        at = end + (axis < 2);
    }
    return at;
}

iso_status isosculpt_measure_parse(const char *text, isosculpt_measure_request *request, iso_error *error) {
    request->on = true;
    for (const char *at = text; at; at++) {
        if (request->count == ISOSCULPT_MEASURE_PLACES)
            return iso_fail(error, ISO_ERR_USAGE, "more than %d places", ISOSCULPT_MEASURE_PLACES);
        at = read_place(at, &request->near[request->count++]);
        if (!at || (*at && *at != ','))
            return iso_fail(error, ISO_ERR_USAGE, "'%s' is no list of places X/Y/Z,X/Y/Z (mm)", text);
        if (!*at) break;
    }
    return ISO_OK;
}

iso_status isosculpt_measure(const isosculpt_measure_request *request, const iso_grid *grid, iso_pool *pool,
                             isosculpt_measured *measured, iso_error *error) {
    ISO_TRY(iso_measure_solid(grid, pool, &measured->solid, error));
    for (measured->count = 0; measured->count < request->count; measured->count++)
        ISO_TRY(iso_measure_place(grid, request->near[measured->count], pool,
                                  &measured->place[measured->count], error));
    return ISO_OK;
}

static void put_vector(iso_json *json, const char *key, iso_vec3 v) {
    const double values[] = {v.x, v.y, v.z};
    iso_json_reals(json, key, values, 3);
}

void isosculpt_put_measured(iso_json *json, const isosculpt_measured *measured) {
    iso_json_begin_object(json, "measured");
    iso_json_real(json, "volume", measured->solid.volume);
    iso_json_real(json, "area", measured->solid.area);
    put_vector(json, "low", measured->solid.box.lo);
    put_vector(json, "high", measured->solid.box.hi);
    iso_json_integer(json, "pieces", measured->solid.pieces);
    iso_json_begin_array(json, "places");
    for (int i = 0; i < measured->count; i++) {
        const iso_measured_place *place = &measured->place[i];
        iso_json_begin_object(json, NULL);
        put_vector(json, "position", place->position);
        put_vector(json, "normal", place->normal);
        iso_json_real(json, "thickness", place->thickness);
        if (i) iso_json_real(json, "distance", distance_of(place, place - 1));
        iso_json_end_object(json);
    }
    iso_json_end_array(json);
    iso_json_end_object(json);
}

/* A number without what rounding has left of 0. */
static double clean(double value, double least) {
    return fabs(value) < least ? 0 : value;
}

void isosculpt_tell_measured(const isosculpt_measured *measured, void (*tell)(const char *line)) {
    const iso_solid_measures *solid = &measured->solid;
    const iso_vec3 size = iso_vec3_sub(solid->box.hi, solid->box.lo);
    char line[240], thickness[40];
    snprintf(line, sizeof line, "volume %.6g mm3, area %.6g mm2, size %.5g x %.5g x %.5g mm, %zu %s",
             solid->volume, solid->area, size.x, size.y, size.z, solid->pieces,
             solid->pieces == 1 ? "piece" : "pieces");
    tell(line);
    for (int i = 0; i < measured->count; i++) {
        const iso_measured_place *place = &measured->place[i];
        isosculpt_length_text(place->thickness, thickness, sizeof thickness);
        const double least = 1e-6 * iso_vec3_length(place->position);
        const int length = snprintf(line, sizeof line, "place %d: %.5g/%.5g/%.5g, thickness %s", i + 1,
                                    clean(place->position.x, least), clean(place->position.y, least),
                                    clean(place->position.z, least), thickness);
        if (i)
            snprintf(line + length, sizeof line - (size_t)length, ", %.5g mm from place %d",
                     distance_of(place, place - 1), i);
        tell(line);
    }
}
