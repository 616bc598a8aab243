/* glass: computes the light of samples from a map of crossings, and converts the light of samples to
 * pixels. */
#include "render/glass/glass.h"

#include <math.h>
#include <stdatomic.h>

#include "base/memory.h"
#include "base/srgb.h"

const char *iso_refraction_name(iso_refraction refraction) {
    static const char *const names[ISO_REFRACTIONS] = {"auto",   "none",      "single",
                                                       "layers", "two-sided", "traced"};
    return names[refraction];
}

iso_status iso_glass_map_create(const iso_view *view, iso_glass_map *map, iso_error *error) {
    const size_t count = (size_t)view->width * (size_t)view->height;
    *map = (iso_glass_map){view, iso_alloc(count * sizeof *map->crossings)};
    return map->crossings ? ISO_OK : iso_fail(error, ISO_ERR_NOMEM, "out of memory for the map of crossings");
}

void iso_glass_map_free(iso_glass_map *map) {
    iso_free(map->crossings);
    map->crossings = NULL;
}

/* ---- one sample */

/* The ray of a sample, and its crossings. */
typedef struct sample {
    iso_vec3 origin, ray; /* world space; ray: unit length */
    double length;        /* mm along the ray for 1 mm of depth */
    const iso_glass_crossings *crossings;
} sample;

static const iso_glass_crossings *crossings_at(const iso_glass_map *map, int x, int y) {
    return &map->crossings[(ptrdiff_t)y * map->view->width + x];
}

static sample sample_at(const iso_glass_map *map, int x, int y) {
    sample s = {.crossings = crossings_at(map, x, y)};
    iso_vec3 direction;
    iso_view_ray(map->view, x + 0.5, y + 0.5, &s.origin, &direction);
    s.length = iso_vec3_length(direction);
    s.ray = iso_vec3_scale(direction, 1 / s.length);
    return s;
}

static iso_vec3 vector_to_world(const iso_view *view, const float v[3]) {
    const double *r = view->rotation;
    const double x = (double)v[0], y = (double)v[1], z = (double)v[2];
    return iso_vec3_make(r[0] * x + r[3] * y + r[6] * z, r[1] * x + r[4] * y + r[7] * z,
                         r[2] * x + r[5] * y + r[8] * z);
}

/* Returns the normal at a sample's crossing, turned so that it points against a ray. */
static iso_vec3 normal_against(const iso_glass_map *map, const float normal[3], iso_vec3 ray) {
    const iso_vec3 n = iso_vec3_unit(vector_to_world(map->view, normal));
    return iso_vec3_dot(n, ray) > 0 ? iso_vec3_scale(n, -1) : n;
}

/* Bends a ray by equation 12 of the paper: sin t = ratio^layers * sin i. If the ray leaves the solid (the eye
 * is inside), the ratio is above 1, and the sine is clamped. */
static iso_vec3 bend_by_layers(iso_vec3 ray, iso_vec3 normal, double ratio, int layers) {
    const double cosine = -iso_vec3_dot(ray, normal);
    const iso_vec3 along = iso_vec3_unit(iso_vec3_add(ray, iso_vec3_scale(normal, cosine)));
    double sine = sqrt(fmax(0, 1 - cosine * cosine));
    for (int i = 0; i < layers && sine < 1; i++) sine *= ratio;
    sine = fmin(sine, 1);
    return iso_vec3_add(iso_vec3_scale(along, sine), iso_vec3_scale(normal, -sqrt(1 - sine * sine)));
}

/* ---- two-sided */

/* Adds the normal and depth of the point where the ray of sample (x, y) first leaves the solid, with a
 * weight. Returns the weight, 0 if the ray does not leave it. */
static double add_exit(const iso_glass_map *map, int x, int y, double weight, float normal[3],
                       double *depth) {
    if (x < 0 || y < 0 || x >= map->view->width || y >= map->view->height) return 0;
    const iso_glass_crossings *c = crossings_at(map, x, y);
    if (!isfinite(c->depth[1])) return 0;
    for (int k = 0; k < 3; k++) normal[k] += (float)weight * c->normal[1][k];
    *depth += weight * (double)c->depth[1];
    return weight;
}

/* Interpolates the depth and normal (view space, not of unit length) of the far side at a position of the
 * picture from the four samples around it. Returns false if the solid is not there. */
static bool exit_at(const iso_glass_map *map, double px, double py, float normal[3], double *depth) {
    if (!(px > -1 && py > -1 && px < map->view->width + 1 && py < map->view->height + 1)) return false;
    const double left = floor(px - 0.5), top = floor(py - 0.5), u = px - 0.5 - left, v = py - 0.5 - top;
    const int x = (int)left, y = (int)top;
    double total = 0;
    normal[0] = normal[1] = normal[2] = 0;
    *depth = 0;
    total += add_exit(map, x, y, (1 - u) * (1 - v), normal, depth);
    total += add_exit(map, x + 1, y, u * (1 - v), normal, depth);
    total += add_exit(map, x, y + 1, (1 - u) * v, normal, depth);
    total += add_exit(map, x + 1, y + 1, u * v, normal, depth);
    if (!(total > 0)) return false;
    *depth /= total;
    return true;
}

/* The point where a refracted ray leaves the solid, as far as the map shows it. */
typedef struct way_out {
    double distance; /* from the point of entry, mm */
    float normal[3]; /* view space, not of unit length */
} way_out;

/* Follows a ray from the point of entry to the far side. The first guess of the distance is the thickness
 * straight behind the entry; each next one comes from the depth of the far side at the position that the ray
 * then reaches. Wyman interpolates between this thickness and the one along the normal, which needs
 * precomputed distances; the search in the map is that of Oliveira and Brauwers 2007, "Real-time refraction
 * through deformable objects". */
static way_out find_way_out(const iso_glass_map *map, iso_vec3 entry, iso_vec3 ray, double guess,
                            const float normal[3]) {
    enum { STEPS = 6 };
    const iso_view *view = map->view;
    const iso_vec3 from = iso_view_point(view, entry), along = iso_view_vector(view, ray);
    way_out out = {guess, {normal[0], normal[1], normal[2]}};
    for (int i = 0; i < STEPS; i++) {
        const iso_vec3 at = iso_vec3_add(from, iso_vec3_scale(along, out.distance));
        const double scale = view->focal / (view->orthographic ? 1 : at.z);
        float found[3];
        double depth;
        if (!exit_at(map, view->cx + scale * at.x, view->cy + scale * at.y, found, &depth)) break;
        for (int k = 0; k < 3; k++) out.normal[k] = found[k];
        if (!(along.z > 0)) break;
        out.distance = fmax(0, out.distance + (depth - at.z) / along.z);
    }
    return out;
}

/* Returns the crossings of the sample that shows a point (view space), if the point lies in the solid before
 * that sample's ray first leaves it; else NULL. */
static const iso_glass_crossings *crossings_around(const iso_glass_map *map, iso_vec3 at) {
    const iso_view *view = map->view;
    const double scale = view->focal / (view->orthographic ? 1 : at.z), x = floor(view->cx + scale * at.x),
                 y = floor(view->cy + scale * at.y);
    if (!(at.z > view->near && x >= 0 && y >= 0 && x < view->width && y < view->height)) return NULL;
    const iso_glass_crossings *c = crossings_at(map, (int)x, (int)y);
    return (double)c->depth[0] < at.z && at.z < (double)c->depth[1] ? c : NULL;
}

/* Follows a ray that was reflected at a point of the surface through the solid, in steps of `step` mm.
 * Returns false if the map does not show the ray's way out. */
static bool march_out(const iso_glass_map *map, iso_vec3 point, iso_vec3 ray, double step, way_out *out) {
    enum { STEPS = 96, BISECTIONS = 6 };
    const iso_vec3 start = iso_view_point(map->view, point), along = iso_view_vector(map->view, ray);
    const iso_glass_crossings *last = NULL, *c = NULL; /* at the farthest point inside so far; at the next */
    double inside = 0, outside = 0;
    for (int i = 1; i <= STEPS; i++) {
        outside = i * step;
        c = crossings_around(map, iso_vec3_add(start, iso_vec3_scale(along, outside)));
        if (!c) break;
        inside = outside;
        last = c;
    }
    if (c || !last) return false;
    for (int i = 0; i < BISECTIONS; i++) {
        const double middle = (inside + outside) / 2;
        c = crossings_around(map, iso_vec3_add(start, iso_vec3_scale(along, middle)));
        if (c) last = c;
        *(c ? &inside : &outside) = middle;
    }
    const double z = start.z + inside * along.z;
    const bool far = z - (double)last->depth[0] > (double)last->depth[1] - z;
    if (!far && last->inside) return false; /* there is no surface */
    out->distance = inside;
    memcpy(out->normal, last->normal[far], sizeof out->normal);
    return true;
}

/* Follows a ray from the point of entry until it leaves the solid, also where it is totally reflected, unless
 * the map does not show its way. Sets `ray` to its direction then; returns its length in the solid, mm. */
static double leave(const iso_mapped_glass *m, const sample *s, iso_vec3 *ray) {
    enum { REFLECTIONS = 6 };
    const iso_view *view = m->map->view;
    const iso_glass_crossings *c = s->crossings;
    const double depth = (double)c->depth[0], straight = ((double)c->depth[1] - depth) * s->length,
                 pixel = (view->orthographic ? 1 : depth) / view->focal,
                 step = fmax(2 * pixel, 0.01 * straight);
    iso_vec3 at = iso_vec3_add(s->origin, iso_vec3_scale(s->ray, depth * s->length)), out;
    way_out way = find_way_out(m->map, at, *ray, straight, c->normal[1]);
    double length = way.distance;
    for (int i = 0; i <= REFLECTIONS; i++) {
        const iso_vec3 normal = normal_against(m->map, way.normal, *ray);
        if (iso_glass_refract(*ray, normal, m->glass->ior, &out)) {
            *ray = out;
            return length;
        }
        at = iso_vec3_add(at, iso_vec3_scale(*ray, way.distance));
        *ray = iso_glass_reflect(*ray, normal);
        if (i == REFLECTIONS || !march_out(m->map, at, *ray, step, &way)) break;
        length += way.distance;
    }
    return length;
}

/* Adds the light along a ray that starts inside the solid, at the point where the sample's ray does. */
static void light_behind(const iso_mapped_glass *m, const sample *s, iso_vec3 ray, double light[3]) {
    const double distance =
        isfinite(s->crossings->depth[1]) ? leave(m, s, &ray) : (double)s->crossings->thickness;
    iso_environment_look(m->glass->environment, ray, light);
    iso_glass_absorb(m->glass, distance, light);
}

/* ---- the light of a sample */

/* Computes the light that reaches the sample through the solid. normal: at the first crossing, against the
 * ray. */
static void light_through(const iso_mapped_glass *m, const sample *s, iso_vec3 normal, double light[3]) {
    const iso_glass_crossings *c = s->crossings;
    const double ior = m->glass->ior;
    iso_vec3 ray = s->ray;
    if (m->refraction == ISO_REFRACTION_TWO_SIDED) {
        if (!c->inside) iso_glass_refract(s->ray, normal, 1 / ior, &ray);
        light_behind(m, s, ray, light);
        return;
    }
    const int layers = m->refraction == ISO_REFRACTION_SINGLE && c->layers > 1 ? 1 : c->layers;
    if (m->refraction != ISO_REFRACTION_NONE)
        ray = bend_by_layers(ray, normal, c->inside ? ior : 1 / ior, layers);
    iso_environment_look(m->glass->environment, ray, light);
    iso_glass_absorb(m->glass, (double)c->thickness, light);
    if (!(m->glass->surface_opacity > 0)) return;
    for (int i = 0; i < layers; i++)
        for (int k = 0; k < 3; k++) light[k] *= 1 - m->glass->surface_opacity;
}

bool iso_glass_light(const void *context, int x, int y, double rgb[3]) {
    const iso_mapped_glass *m = context;
    const sample s = sample_at(m->map, x, y);
    const iso_glass_crossings *c = s.crossings;
    if (c->layers + c->inside == 0) return false;
    const iso_vec3 normal = normal_against(m->map, c->normal[c->inside], s.ray);
    light_through(m, &s, normal, rgb);
    if (c->inside) return true;
    double mirrored[3];
    const double share = iso_glass_reflectance(m->glass->ior, -iso_vec3_dot(s.ray, normal));
    iso_environment_look(m->glass->environment, iso_glass_reflect(s.ray, normal), mirrored);
    for (int k = 0; k < 3; k++) rgb[k] = share * mirrored[k] + (1 - share) * rgb[k];
    return true;
}

bool iso_dispersed_glass_light(const void *context, int x, int y, double rgb[3]) {
    const iso_dispersed_glass *glass = context;
    for (int k = 0; k < 3; k++) {
        double light[3];
        if (!glass->light(glass->contexts[k], x, y, light)) return false;
        rgb[k] = light[k];
    }
    return true;
}

/* ---- pixels */

typedef struct glass_shade {
    const iso_glass_picture *picture;
    double background[3]; /* linear */
    atomic_size_t covered;
} glass_shade;

/* Computes the light that a sample sees if it misses the solid. */
static void light_beside(const glass_shade *shade, int x, int y, double rgb[3]) {
    iso_vec3 origin, direction;
    for (int k = 0; k < 3; k++) rgb[k] = shade->background[k];
    if (!shade->picture->behind) return;
    iso_view_ray(shade->picture->view, x + 0.5, y + 0.5, &origin, &direction);
    iso_environment_look(shade->picture->behind, direction, rgb);
}

/* Adds a sample's light, clamped to what can be displayed. Returns whether the sample shows the solid. */
static bool add_sample(const glass_shade *shade, int x, int y, double sum[3]) {
    const iso_glass_picture *picture = shade->picture;
    double rgb[3];
    const bool shows = picture->light(picture->context, x, y, rgb);
    if (!shows && picture->background->transparent) return false;
    if (!shows) light_beside(shade, x, y, rgb);
    for (int k = 0; k < 3; k++) sum[k] += fmin(fmax(rgb[k], 0), 1);
    return shows;
}

static uint8_t display_byte(double light) {
    return (uint8_t)(iso_srgb_encode(light) * 255 + 0.5);
}

/* Shades the pixel (x, y) of the picture. Returns the number of samples that show the solid. */
static int shade_pixel(const glass_shade *shade, int x, int y) {
    const iso_glass_picture *picture = shade->picture;
    const int factor = picture->strip->factor, samples = factor * factor;
    uint8_t *rgba = picture->image->rgba + 4 * ((ptrdiff_t)y * picture->image->width + x);
    double sum[3] = {0, 0, 0};
    int covered = 0;
    for (int i = 0; i < samples; i++)
        covered += add_sample(shade, x * factor + i % factor, y * factor + i / factor, sum);
    const int counted = picture->background->transparent ? covered : samples;
    for (int k = 0; k < 3; k++) rgba[k] = counted ? display_byte(sum[k] / counted) : 0;
    rgba[3] = (uint8_t)((double)counted / samples * 255 + 0.5);
    return covered;
}

static void shade_row(void *context, size_t index, int worker) {
    (void)worker;
    glass_shade *shade = context;
    const iso_glass_picture *picture = shade->picture;
    size_t covered = 0;
    for (int x = 0; x < picture->image->width; x++)
        covered += (size_t)shade_pixel(shade, x, picture->strip->y0 + (int)index);
    atomic_fetch_add(&shade->covered, covered);
}

size_t iso_glass_shade(const iso_glass_picture *picture) {
    const iso_rgb c = picture->background->background;
    const size_t rows = (size_t)(picture->strip->view->height / picture->strip->factor);
    glass_shade shade = {.picture = picture,
                         .background = {iso_srgb_decode(c.r / 255.0), iso_srgb_decode(c.g / 255.0),
                                        iso_srgb_decode(c.b / 255.0)}};
    iso_parallel_until(picture->pool, rows, shade_row, &shade);
    return shade.covered;
}
