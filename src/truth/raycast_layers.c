/* raycast_layers: composites all crossings of a sample's ray, front to back. The crossings of several
 * surfaces are merged in order of distance. pow and exp are those of libm on purpose: the renderers, which
 * are compared with this code, use their own. */
#include "truth/raycast_layers.h"

#include <math.h>
#include <stdatomic.h>

#include "truth/raycaster.h"

/* The ray of a sample. */
typedef struct sample_ray {
    const iso_raycast_layers *input;
    int x, y;
    iso_vec3 origin, direction; /* world space */
    float to_eye[3];            /* view space */
    double length;              /* mm along the ray for 1 mm of depth */
    double limit;               /* depth of the opaque surface behind this sample, mm; INFINITY: none */
    iso_ray ray[ISO_RAYCAST_LAYERS_MAX];
    iso_ray_hit hit[ISO_RAYCAST_LAYERS_MAX]; /* the next crossing of each surface */
    bool more[ISO_RAYCAST_LAYERS_MAX];       /* hit[i] is valid: the surface has another crossing */
    bool inside[ISO_RAYCAST_LAYERS_MAX];     /* the ray is in the surface's solid */
    int listed[ISO_RAYCAST_LAYERS_MAX];      /* number of the surface's crossings so far */
    double end;                              /* depth where the ray leaves the volume, mm */
    double depth;                            /* depth up to which the ray has been followed, mm */
} sample_ray;

/* The colour of a sample accumulated so far, and the share of the light that passes all layers so far. */
typedef struct light {
    double color[3], through;
    int layers;
} light;

/* Whether the ray is after a hit of surface i in its solid. */
static bool is_inside(const sample_ray *s, int i) {
    return s->hit[i].falls == s->input->layers[i].caster->level_set;
}

/* Whether a hit is where a solid borders on the opaque surface. */
static bool is_border(const sample_ray *s, int i) {
    const float gap = s->input->layers[i].translucency.gap;
    return !is_inside(s, i) && !((float)s->hit[i].t < (float)s->limit - gap);
}

static void next_hit(sample_ray *s, int i) {
    const iso_raycast_layer *layer = &s->input->layers[i];
    const int most = layer->translucency.most_layers;
    do
        s->more[i] = (!most || s->listed[i] < most) &&
                     iso_ray_next(layer->caster->tracer, &s->ray[i], &s->hit[i]) &&
                     (float)s->hit[i].t < (float)s->limit;
    while (s->more[i] &&
           (is_border(s, i) || !iso_raycast_shows(layer->clip, s->origin, s->direction, s->hit[i].t)));
    s->listed[i]++;
}

static void start_ray(sample_ray *s, const iso_raycast_layers *input, int x, int y) {
    const iso_view *view = input->picture.strip->view;
    const iso_gbuffer *opaque = input->picture.strip->gbuffer;
    iso_view_ray(view, x + 0.5, y + 0.5, &s->origin, &s->direction);
    const iso_vec3 along = iso_view_vector(view, s->direction);
    s->input = input;
    s->x = x;
    s->y = y;
    s->to_eye[0] = -(float)along.x;
    s->to_eye[1] = -(float)along.y;
    s->to_eye[2] = -(float)along.z;
    s->length = iso_vec3_length(along);
    s->limit =
        opaque->depth ? (double)opaque->depth[(size_t)y * (size_t)opaque->width + (size_t)x] : INFINITY;
    s->depth = s->end = 0;
    for (int i = 0; i < input->count; i++) {
        const iso_raycaster *caster = input->layers[i].caster;
        s->listed[i] = 0;
        s->more[i] = s->inside[i] = false;
        if (!iso_ray_start(caster->tracer, s->origin, s->direction, view->near, &s->ray[i])) continue;
        s->inside[i] = iso_ray_starts_above(caster->tracer, &s->ray[i]) != caster->level_set;
        s->depth = s->ray[i].t;
        s->end = iso_ray_end(caster->tracer, &s->ray[i]);
        next_hit(s, i);
    }
}

/* Returns the surface with the nearest crossing; -1: no surface has another crossing. */
static int nearest_hit(const sample_ray *s) {
    int nearest = -1;
    for (int i = 0; i < s->input->count; i++)
        if (s->more[i] && (nearest < 0 || s->hit[i].t < s->hit[nearest].t)) nearest = i;
    return nearest;
}

/* Follows the ray to `depth` and attenuates its light in the absorbing solids on the way. */
static void absorb(sample_ray *s, light *l, double depth) {
    double rate = 0, color[3] = {0, 0, 0};
    for (int i = 0; i < s->input->count; i++) {
        const iso_raycast_layer *layer = &s->input->layers[i];
        if (!s->inside[i] || !(layer->translucency.absorption_length > 0)) continue;
        const double per_mm = 1 / (double)layer->translucency.absorption_length;
        rate += per_mm;
        color[0] += per_mm * layer->color.r / 255;
        color[1] += per_mm * layer->color.g / 255;
        color[2] += per_mm * layer->color.b / 255;
    }
    if (rate > 0 && depth > s->depth) {
        const double left = exp(-rate * s->length * (depth - s->depth));
        for (int k = 0; k < 3; k++) l->color[k] += l->through * (1 - left) * color[k] / rate;
        l->through *= left;
    }
    s->depth = fmax(s->depth, depth);
}

static double opacity_of(const iso_translucency *translucency, const float normal[3], const float to_eye[3]) {
    const double opacity = (double)translucency->opacity;
    double dot = 0, square = 0;
    if (translucency->constant) return opacity;
    for (int k = 0; k < 3; k++) {
        dot += (double)normal[k] * (double)to_eye[k];
        square += (double)to_eye[k] * (double)to_eye[k];
    }
    return 1 - pow(1 - opacity, 1 / fmax(fabs(dot) / sqrt(square), 1e-6));
}

/* The colour of the next crossing of surface i. normal: in view space. */
static iso_rgb color_of(const sample_ray *s, int i, iso_vec3 normal) {
    const iso_surface_colors *colors = s->input->layers[i].colors;
    if (!colors) return s->input->layers[i].color;
    const iso_colored_point point =
        iso_colored_point_at(s->input->picture.strip->view, s->x, s->y, s->hit[i].t, normal);
    iso_nearby nearby = {0};
    const iso_rgb color = colors->at(colors->context, &point, &nearby);
    iso_nearby_free(&nearby);
    return color;
}

/* Returns the next crossing of surface i with its opacity and shaded colour. */
static iso_raycast_crossing crossing_of(const sample_ray *s, int i) {
    const iso_raycast_layer *layer = &s->input->layers[i];
    const iso_ray_hit *hit = &s->hit[i];
    const iso_vec3 n = iso_view_vector(s->input->picture.strip->view,
                                       iso_ray_hit_normal(layer->caster->tracer, &s->ray[i], hit));
    const float normal[3] = {(float)n.x, (float)n.y, (float)n.z};
    iso_raycast_crossing crossing = {.depth = hit->t,
                                     .opacity = opacity_of(&layer->translucency, normal, s->to_eye)};
    iso_shade_sample(normal, s->to_eye, color_of(s, i, n), crossing.rgb);
    return crossing;
}

/* Composites the next crossing of surface i. */
static void add_layer(sample_ray *s, int i, light *l) {
    const iso_raycast_crossing crossing = crossing_of(s, i);
    absorb(s, l, crossing.depth);
    for (int k = 0; k < 3; k++) l->color[k] += l->through * crossing.opacity * (double)crossing.rgb[k];
    l->through *= 1 - crossing.opacity;
    l->layers++;
    s->inside[i] = is_inside(s, i);
    next_hit(s, i);
}

/* Adds the opaque surface behind the layers, if there is one. Returns whether there is one. */
static bool add_opaque(const sample_ray *s, int x, int y, light *l) {
    const iso_shading *shading = s->input->picture.shading;
    const iso_gbuffer *opaque = s->input->picture.strip->gbuffer;
    if (!opaque->depth) return false;
    const size_t at = (size_t)y * (size_t)opaque->width + (size_t)x;
    const int surface = opaque->surface[at];
    if (surface == ISO_SURFACE_NONE) return false;
    const iso_vec3 n = iso_gbuffer_normal(opaque, at);
    const float normal[3] = {(float)n.x, (float)n.y, (float)n.z};
    const int last = shading->color_count - 1;
    const uint32_t own = opaque->color ? opaque->color[at] : 0;
    const bool has_own = own >> 24 == (uint32_t)surface + 1;
    const iso_rgb color = has_own ? (iso_rgb){own & 255, own >> 8 & 255, own >> 16 & 255}
                                  : shading->colors[surface < last ? surface : last];
    float rgb[3] = {(float)color.r / 255, (float)color.g / 255, (float)color.b / 255};
    const bool lit = normal[0] != 0 || normal[1] != 0 || normal[2] != 0 || !has_own;
    if (lit && (opaque->ambient || opaque->key))
        iso_shade_occluded(normal, s->to_eye, color, opaque->ambient ? opaque->ambient[at] : 1,
                           opaque->key ? opaque->key[at] : 1, rgb);
    else if (lit)
        iso_shade_sample(normal, s->to_eye, color, rgb);
    for (int k = 0; k < 3; k++) l->color[k] += l->through * (double)rgb[k];
    l->through = 0;
    return true;
}

/* Composites a sample; returns whether it shows a surface. */
static bool cast_sample(const iso_raycast_layers *input, int x, int y, light *l) {
    sample_ray s;
    start_ray(&s, input, x, y);
    *l = (light){.through = 1};
    for (int i; l->through >= (double)ISO_LAYER_CUT && (i = nearest_hit(&s)) >= 0;) add_layer(&s, i, l);
    if (l->through >= (double)ISO_LAYER_CUT) absorb(&s, l, fmin(s.end, s.limit));
    return add_opaque(&s, x, y, l) || l->layers > 0;
}

/* ---- the picture */

typedef struct layers_cast {
    const iso_raycast_layers *input;
    atomic_size_t covered, layers;
    atomic_int most;
} layers_cast;

static uint8_t to_byte(double value) {
    return (uint8_t)(fmin(value, 1) * 255 + 0.5);
}

static void write_pixel(const iso_layer_picture *picture, const light *mean, size_t at) {
    const iso_rgb c = picture->shading->background;
    const double background[3] = {c.r / 255.0, c.g / 255.0, c.b / 255.0}, alpha = 1 - mean->through;
    uint8_t *rgba = picture->image->rgba + 4 * at;
    for (int k = 0; k < 3; k++)
        rgba[k] = to_byte(!picture->shading->transparent ? mean->color[k] + mean->through * background[k]
                          : alpha > 0                    ? mean->color[k] / alpha
                                                         : 0);
    rgba[3] = picture->shading->transparent ? to_byte(alpha) : 255;
    if (picture->coverage) picture->coverage[at] = (float)alpha;
}

static void count_layers(layers_cast *cast, int layers, bool shows) {
    atomic_fetch_add(&cast->covered, shows);
    atomic_fetch_add(&cast->layers, (size_t)layers);
    for (int most = atomic_load(&cast->most);
         layers > most && !atomic_compare_exchange_weak(&cast->most, &most, layers);) {
    }
}

static void cast_pixel(layers_cast *cast, int x, int y) {
    const iso_layer_picture *picture = &cast->input->picture;
    const int factor = picture->strip->factor;
    const size_t at = (size_t)(picture->strip->y0 + y) * (size_t)picture->image->width + (size_t)x;
    light mean = {.through = 0};
    for (int sample = 0; sample < factor * factor; sample++) {
        light l;
        const bool shows =
            cast_sample(cast->input, x * factor + sample % factor, y * factor + sample / factor, &l);
        count_layers(cast, l.layers, shows);
        for (int k = 0; k < 3; k++) mean.color[k] += l.color[k] / (factor * factor);
        mean.through += l.through / (factor * factor);
        mean.layers += l.layers;
    }
    write_pixel(picture, &mean, at);
    if (picture->layer_counts) picture->layer_counts[at] = (float)mean.layers / (float)(factor * factor);
}

static void cast_row(void *context, size_t row, int worker) {
    (void)worker;
    layers_cast *cast = context;
    for (int x = 0; x < cast->input->picture.image->width; x++) cast_pixel(cast, x, (int)row);
}

void iso_shade_raycast_layers(const iso_raycast_layers *input, iso_layer_totals *totals) {
    const iso_strip *strip = input->picture.strip;
    layers_cast cast = {.input = input};
    iso_parallel_until(input->picture.pool, (size_t)(strip->view->height / strip->factor), cast_row, &cast);
    const iso_layer_totals counted = {cast.covered, cast.layers, cast.most};
    iso_layer_totals_add(totals, &counted);
}

/* ---- the crossings themselves */

typedef struct layers_reading {
    const iso_raycast_layers *input;
    const iso_raycast_reader *reader;
} layers_reading;

static void read_row(void *context, size_t row, int worker) {
    (void)worker;
    const layers_reading *reading = context;
    for (int x = 0; x < reading->input->picture.strip->view->width; x++) {
        sample_ray s;
        start_ray(&s, reading->input, x, (int)row);
        for (int i; (i = nearest_hit(&s)) >= 0; next_hit(&s, i)) {
            const iso_raycast_crossing crossing = crossing_of(&s, i);
            reading->reader->read(reading->reader->context, x, (int)row, &crossing);
        }
    }
}

void iso_read_raycast_layers(const iso_raycast_layers *input, const iso_raycast_reader *reader) {
    layers_reading reading = {input, reader};
    iso_parallel_until(input->picture.pool, (size_t)input->picture.strip->view->height, read_row, &reading);
}
