/* ply_gaussians: 256 Gaussians at a time share a chunk, which holds the ranges of their positions, scales and
 * colours. A Gaussian is four words:
 *
 *     packed_position   x y z in 11, 10 and 11 bits, parts of the range of the chunk
 *     packed_scale      the same of the natural logarithms of the standard deviations
 *     packed_rotation   in 2 bits, which number of the unit quaternion (w, x, y, z) is the largest; in
 *                       10 bits each the others, -.7071 .. .7071
 *     packed_color      in 8 bits each: red green blue, parts of the range of the chunk or of 0 .. 1,
 *                       and opacity, 0 .. 1
 *
 * Colours by direction (element "sh") are not used. */
#include "io/polydata/ply_gaussians.h"

#include <math.h>
#include <string.h>

enum { SHARING = 256, RANGES = 18, RANGES_LEAST = 12 };

enum { POSITION, ROTATION, SCALE, COLOR, WORDS };
static const char *const word_names[WORDS] = {"packed_position", "packed_rotation", "packed_scale",
                                              "packed_color"};

/* The numbers of a chunk: minima and maxima. The last six may be missing. */
static const char *const range_names[RANGES] = {
    "min_x",       "min_y",       "min_z",       "max_x",       "max_y",       "max_z",
    "min_scale_x", "min_scale_y", "min_scale_z", "max_scale_x", "max_scale_y", "max_scale_z",
    "min_r",       "min_g",       "min_b",       "max_r",       "max_g",       "max_b"};

typedef struct packed {
    iso_ply *ply;
    iso_polydata *data;
    iso_buffer ranges; /* float[RANGES] for each chunk */
    size_t chunks;
    int scale, rot, colors, opacity; /* columns */
    double values[ISO_PLY_PROPERTIES];
} packed;

/* ---- the header */

static const iso_ply_element *find_element(const iso_ply *ply, const char *name) {
    for (int i = 0; i < ply->element_count; i++)
        if (strcmp(ply->elements[i].name, name) == 0) return &ply->elements[i];
    return NULL;
}

/* Returns the index of a property among those of its element; -1: there is none that is a number. */
static int find_property(const iso_ply *ply, const iso_ply_element *element, const char *name) {
    for (int i = 0; i < element->property_count; i++) {
        const iso_ply_property *property = &ply->properties[element->first_property + i];
        if (!property->is_list && strcmp(property->name, name) == 0) return i;
    }
    return -1;
}

bool iso_ply_packs_gaussians(const iso_ply *ply) {
    const iso_ply_element *chunk = find_element(ply, "chunk"), *vertex = find_element(ply, "vertex");
    if (!chunk || !vertex || chunk > vertex) return false;
    for (int i = 0; i < WORDS; i++) {
        const int at = find_property(ply, vertex, word_names[i]);
        if (at < 0 || ply->properties[vertex->first_property + at].type != ISO_PLY_UINT32) return false;
    }
    for (int i = 0; i < RANGES_LEAST; i++)
        if (find_property(ply, chunk, range_names[i]) < 0) return false;
    return true;
}

/* ---- chunks */

static iso_status read_chunks(packed *p, const iso_ply_element *element, iso_error *error) {
    int at[RANGES];
    for (int k = 0; k < RANGES; k++) at[k] = find_property(p->ply, element, range_names[k]);
    ISO_TRY(iso_ply_check_size(p->ply, element, error));
    p->chunks = (size_t)element->count;
    ISO_TRY(
        iso_reading_reserve(p->data->reading, &p->ranges, p->chunks + 1, RANGES * sizeof(float), 0, error));
    float *to = p->ranges.data;
    for (size_t i = 0; i < p->chunks; i++, to += RANGES) {
        ISO_TRY(iso_ply_read_item(p->ply, element, p->values, error));
        for (int k = 0; k < RANGES; k++)
            to[k] = at[k] >= 0 ? (float)p->values[at[k]] : k < RANGES_LEAST + 3 ? 0 : 1;
    }
    return ISO_OK;
}

/* ---- Gaussians */

/* The number that lies `part` of the way between minimum k and its maximum, which is three numbers behind. */
static double between(const float *range, int k, double part) {
    return (double)range[k] * (1 - part) + (double)range[k + 3] * part;
}

static void unpack_triple(uint32_t word, const float *range, double to[3]) {
    to[0] = between(range, 0, (double)(word >> 21) / 2047);
    to[1] = between(range, 1, (double)(word >> 11 & 1023) / 1023);
    to[2] = between(range, 2, (double)(word & 2047) / 2047);
}

static void unpack_rotation(uint32_t word, float to[4]) {
    const uint32_t largest = word >> 30;
    double rest = 1;
    for (uint32_t k = 0, shift = 20; k < 4; k++) {
        if (k == largest) continue;
        const double number = ((double)(word >> shift & 1023) / 1023 - 0.5) * 1.4142135623730951;
        to[k] = (float)number;
        rest -= number * number;
        shift -= 10;
    }
    to[largest] = (float)sqrt(fmax(rest, 0));
}

static float *place_in(packed *p, int column, size_t point) {
    const iso_column *c = iso_polydata_column(p->data, column);
    return (float *)c->values.data + point * (size_t)c->components;
}

static void add_gaussian(packed *p, const uint32_t words[WORDS]) {
    const size_t point = p->data->point_count;
    const float *range = (const float *)p->ranges.data + point / SHARING * RANGES;
    double position[3], scale[3];
    unpack_triple(words[POSITION], range, position);
    unpack_triple(words[SCALE], range + 6, scale);
    float *scales = place_in(p, p->scale, point), *color = place_in(p, p->colors, point);
    for (int k = 0; k < 3; k++) {
        scales[k] = (float)scale[k];
        color[k] = (float)(255 * between(range + 12, k, (double)(words[COLOR] >> (24 - 8 * k) & 255) / 255));
    }
    unpack_rotation(words[ROTATION], place_in(p, p->rot, point));
    *place_in(p, p->opacity, point) = (float)(words[COLOR] & 255) / 255;
    iso_polydata_add_point(p->data, position);
}

static iso_status add_columns(packed *p, iso_error *error) {
    iso_polydata *data = p->data;
    ISO_TRY(iso_polydata_add_column(data, "scale", 3, false, ISO_ROLE_NONE, &p->scale, error));
    ISO_TRY(iso_polydata_add_column(data, "rot", 4, false, ISO_ROLE_NONE, &p->rot, error));
    ISO_TRY(iso_polydata_add_column(data, "colors", 3, false, ISO_ROLE_COLOR, &p->colors, error));
    return iso_polydata_add_column(data, "opacity", 1, false, ISO_ROLE_NONE, &p->opacity, error);
}

static iso_status read_vertices(packed *p, const iso_ply_element *element, iso_error *error) {
    int at[WORDS];
    for (int k = 0; k < WORDS; k++) at[k] = find_property(p->ply, element, word_names[k]);
    ISO_TRY(iso_ply_check_size(p->ply, element, error));
    if (element->count / SHARING + (element->count % SHARING > 0) > p->chunks)
        return iso_fail(error, ISO_ERR_FORMAT, "%s: damaged: %zu chunks of 256 for %llu Gaussians",
                        p->ply->in.path, p->chunks, (unsigned long long)element->count);
    ISO_TRY(add_columns(p, error));
    ISO_TRY(iso_polydata_reserve(p->data, (size_t)element->count, error));
    for (uint64_t i = 0; i < element->count; i++) {
        uint32_t words[WORDS];
        ISO_TRY(iso_ply_read_item(p->ply, element, p->values, error));
        for (int k = 0; k < WORDS; k++) {
            const double word = p->values[at[k]];
            if (!(word >= 0 && word <= UINT32_MAX))
                return iso_fail(error, ISO_ERR_FORMAT, "%s: damaged: %s of %g", p->ply->in.path,
                                word_names[k], word);
            words[k] = (uint32_t)word;
        }
        add_gaussian(p, words);
    }
    p->data->packed_gaussians = true;
    return ISO_OK;
}

static iso_status read_elements(packed *p, iso_error *error) {
    const iso_ply_element *chunk = find_element(p->ply, "chunk"), *vertex = find_element(p->ply, "vertex");
    for (const iso_ply_element *element = p->ply->elements; element < vertex; element++)
        ISO_TRY(element == chunk ? read_chunks(p, element, error)
                                 : iso_ply_skip_element(p->ply, element, error));
    return read_vertices(p, vertex, error);
}

iso_status iso_ply_read_packed_gaussians(iso_ply *ply, iso_polydata *data, iso_error *error) {
    packed *p = iso_alloc_zero(1, sizeof *p);
    if (!p) return iso_fail_memory(error, data->reading->path);
    p->ply = ply;
    p->data = data;
    iso_status status = read_elements(p, error);
    iso_reading_free(data->reading, &p->ranges);
    iso_free(p);
    return status;
}
