/* Meshes in binary glTF 2.0 (.glb; "glTF 2.0 Specification", Khronos 2021): the triangles of the file's
 * scene, each mesh where its node places it. glTF has metres and y up; they become mm and z up, as .glb is
 * written here. Colours are those of vertices times the materials' own, without textures; skins, morph
 * targets and animations are not applied. */
#include <jansson.h>
#include <string.h>

#include "base/srgb.h"
#include "grids/volume/scalar_load.h"
#include "io/mesh/placed_parts.h"

enum { HEADER = 12, CHUNK = 8, DEEPEST = 256, MOST_JSON = 1 << 24 };

typedef struct glb {
    iso_mesh_reading *r;
    json_t *root;
    const unsigned char *data; /* of the buffer, NULL: there is none */
    uint64_t bytes;
    iso_buffer placed; /* of each node, whether it was met */
    bool colored;      /* something in the file has a colour */
} glb;

/* Numbers in the buffer: `count` items of one, three or four. */
typedef struct glb_accessor {
    const unsigned char *at; /* NULL: there is no accessor */
    uint64_t count, stride;
    iso_scalar scalar;
    double scale; /* of normalised integers */
} glb_accessor;

static iso_status bad(const glb *g, const char *what, iso_error *error) {
    return iso_fail(error, ISO_ERR_FORMAT, "%s: not a readable .glb file: %s", g->r->path, what);
}

/* ---- the JSON text */

/* An integer member of an object that cannot be negative; `missing` if it is not there; UINT64_MAX, which
 * fits nothing: it is something else. */
static uint64_t index_of(const json_t *object, const char *name, uint64_t missing) {
    const json_t *value = json_object_get(object, name);
    if (!value) return missing;
    return json_is_integer(value) && json_integer_value(value) >= 0 ? (uint64_t)json_integer_value(value)
                                                                    : UINT64_MAX;
}

/* An object of one of the top arrays; NULL: there is none. */
static const json_t *item_of(const glb *g, const char *array, uint64_t index) {
    const json_t *items = json_object_get(g->root, array);
    const json_t *item = index < json_array_size(items) ? json_array_get(items, (size_t)index) : NULL;
    return json_is_object(item) ? item : NULL;
}

/* Reads `count` numbers of an array; false: it is something else. */
static bool numbers_of(const json_t *array, size_t count, double *numbers) {
    if (json_array_size(array) != count) return false;
    for (size_t i = 0; i < count; i++) {
        const json_t *number = json_array_get(array, i);
        if (!json_is_number(number)) return false;
        numbers[i] = json_number_value(number);
    }
    return true;
}

/* ---- numbers in the buffer */

static bool scalar_of(uint64_t code, iso_scalar *scalar, double *scale) {
    static const struct {
        iso_scalar scalar;
        double largest;
    } types[] = {{ISO_SCALAR_INT8, 127},     {ISO_SCALAR_UINT8, 255}, {ISO_SCALAR_INT16, 32767},
                 {ISO_SCALAR_UINT16, 65535}, {ISO_SCALAR_INT32, 0},   {ISO_SCALAR_UINT32, 4294967295.0},
                 {ISO_SCALAR_FLOAT, 1}};
    if (code < 5120 || code > 5126 || code == 5124) return false;
    *scalar = types[code - 5120].scalar;
    *scale = 1 / types[code - 5120].largest;
    return true;
}

/* Types of accessors. */
static const char SCALARS[] = "SCALAR", PLACES[] = "VEC3",
                  COLORS[] = "VEC4"; /* colours can be VEC3 as well */

static iso_status find_accessor(const glb *g, uint64_t index, const char *wanted, glb_accessor *a,
                                iso_error *error) {
    const json_t *accessor = item_of(g, "accessors", index);
    const char *type = json_string_value(json_object_get(accessor, "type"));
    const unsigned components = !type || wanted == SCALARS ? 1 : strcmp(type, COLORS) == 0 ? 4 : 3;
    if (!type || (strcmp(type, wanted) != 0 && !(wanted == COLORS && strcmp(type, PLACES) == 0)) ||
        !scalar_of(index_of(accessor, "componentType", 0), &a->scalar, &a->scale))
        return bad(g, "an accessor of another type than it must have", error);
    if (!json_is_true(json_object_get(accessor, "normalized"))) a->scale = 1;
    if (json_object_get(accessor, "sparse"))
        return iso_fail(error, ISO_ERR_UNSUPPORTED, "%s: sparse accessors are not read", g->r->path);
    const json_t *view = item_of(g, "bufferViews", index_of(accessor, "bufferView", UINT64_MAX));
    const json_t *buffer = item_of(g, "buffers", index_of(view, "buffer", UINT64_MAX));
    if (!buffer) return bad(g, "an accessor without bytes", error);
    if (json_object_get(buffer, "uri"))
        return iso_fail(error, ISO_ERR_UNSUPPORTED,
                        "%s: its vertices are in another file: a .glb that holds them is read", g->r->path);
    const uint64_t in_view = index_of(accessor, "byteOffset", 0), from = index_of(view, "byteOffset", 0),
                   length = index_of(view, "byteLength", UINT64_MAX), each = iso_scalar_size(a->scalar);
    a->count = index_of(accessor, "count", UINT64_MAX);
    a->stride = index_of(view, "byteStride", each * components);
    if (from > g->bytes || length > g->bytes - from || in_view > length || a->count == 0 || a->stride > 252 ||
        a->stride < each * components || length - in_view < each * components ||
        a->count - 1 > (length - in_view - each * components) / a->stride)
        return bad(g, "an accessor reaches beyond its bytes", error);
    a->at = g->data + from + in_view;
    return ISO_OK;
}

static double number_at(const glb_accessor *a, uint64_t item, unsigned component) {
    const unsigned char *at = a->at + item * a->stride + component * iso_scalar_size(a->scalar);
    const double number = iso_scalar_load(at, a->scalar, false) * a->scale;
    return a->scale < 1 && number < -1 ? -1 : number;
}

/* ---- meshes */

/* The corners of triangle i of a list, a strip or a fan, as places among the indices. */
static void corners_of(uint64_t mode, uint64_t i, uint64_t corners[3]) {
    enum { LIST = 4, STRIP = 5 };
    const uint64_t odd = i & 1;
    corners[0] = mode == LIST ? 3 * i : mode == STRIP ? i : i + 1;
    corners[1] = mode == LIST ? 3 * i + 1 : mode == STRIP ? i + 1 + odd : i + 2;
    corners[2] = mode == LIST ? 3 * i + 2 : mode == STRIP ? i + 2 - odd : 0;
}

/* The colour of a primitive's material, linear; false: it has none of its own. */
static bool material_color(const glb *g, const json_t *primitive, double color[4]) {
    const json_t *material = item_of(g, "materials", index_of(primitive, "material", UINT64_MAX)),
                 *surface = json_object_get(material, "pbrMetallicRoughness"),
                 *factor = json_object_get(surface, "baseColorFactor");
    for (int k = 0; k < 4; k++) color[k] = 1;
    return !json_object_get(surface, "baseColorTexture") && factor && numbers_of(factor, 4, color);
}

/* Whether a vertex of some mesh has a colour. */
static bool has_colors(const glb *g) {
    size_t i, k;
    double color[4];
    const json_t *mesh, *primitive, *meshes = json_object_get(g->root, "meshes");
    json_array_foreach(meshes, i, mesh) {
        const json_t *primitives = json_object_get(mesh, "primitives");
        json_array_foreach(primitives, k, primitive) {
            const json_t *attributes = json_object_get(primitive, "attributes");
            if (json_object_get(attributes, "COLOR_0") || material_color(g, primitive, color)) return true;
        }
    }
    return false;
}

/* Gives vertex i the colour of its vertex, if there is one, times that of its material. */
static iso_status add_color(const glb *g, const glb_accessor *colors, const double material[4], uint64_t i,
                            iso_error *error) {
    double color[3];
    for (unsigned k = 0; k < 3; k++)
        color[k] = iso_srgb_encode(material[k] * (colors->at ? number_at(colors, i, k) : 1));
    return iso_mesh_add_color(g->r, color, error);
}

static iso_status add_primitive(const glb *g, const json_t *primitive, const iso_mesh_place *place,
                                iso_error *error) {
    const uint64_t mode = index_of(primitive, "mode", 4);
    if (mode < 4) return ISO_OK; /* points and lines */
    if (mode > 6) return bad(g, "a primitive of a mode that glTF does not have", error);
    glb_accessor points, indices = {.at = NULL}, colors = {.at = NULL};
    double material[4];
    material_color(g, primitive, material);
    const json_t *attributes = json_object_get(primitive, "attributes");
    ISO_TRY(find_accessor(g, index_of(attributes, "POSITION", UINT64_MAX), PLACES, &points, error));
    if (json_object_get(primitive, "indices"))
        ISO_TRY(find_accessor(g, index_of(primitive, "indices", UINT64_MAX), SCALARS, &indices, error));
    if (json_object_get(attributes, "COLOR_0"))
        ISO_TRY(find_accessor(g, index_of(attributes, "COLOR_0", UINT64_MAX), COLORS, &colors, error));
    if (colors.at && colors.count < points.count) return bad(g, "fewer colours than vertices", error);
    const iso_mesh_part part = iso_mesh_part_begin(g->r, place);
    for (uint64_t i = 0; i < points.count; i++) {
        const iso_vec3 p = {number_at(&points, i, 0), number_at(&points, i, 1), number_at(&points, i, 2)};
        ISO_TRY(iso_mesh_part_vertex(g->r, &part, p, error));
        if (g->colored) ISO_TRY(add_color(g, &colors, material, i, error));
    }
    const uint64_t count = indices.at ? indices.count : points.count, triangles = mode == 4   ? count / 3
                                                                                  : count < 3 ? 0
                                                                                              : count - 2;
    for (uint64_t i = 0; i < triangles; i++) {
        uint64_t corners[3];
        corners_of(mode, i, corners);
        for (int k = 0; k < 3 && indices.at; k++) {
            const double corner = number_at(&indices, corners[k], 0);
            corners[k] = corner >= 0 ? (uint64_t)corner : UINT64_MAX;
        }
        ISO_TRY(iso_mesh_part_triangle(g->r, &part, corners, error));
    }
    return ISO_OK;
}

static iso_status add_mesh(const glb *g, const json_t *mesh, const iso_mesh_place *place, iso_error *error) {
    size_t i;
    const json_t *primitive, *primitives = json_object_get(mesh, "primitives");
    if (!primitives) return bad(g, "a mesh without primitives", error);
    json_array_foreach(primitives, i, primitive) ISO_TRY(add_primitive(g, primitive, place, error));
    return ISO_OK;
}

/* ---- the scene */

/* The place of a node in its parent: a matrix by columns, or scale, then rotation (x y z w), then
 * translation. */
static iso_status place_of(const glb *g, const json_t *node, iso_mesh_place *place, iso_error *error) {
    const json_t *matrix = json_object_get(node, "matrix"), *moved = json_object_get(node, "translation"),
                 *turned = json_object_get(node, "rotation"), *scaled = json_object_get(node, "scale");
    double c[16], t[3] = {0, 0, 0}, q[4] = {0, 0, 0, 1}, s[3] = {1, 1, 1};
    if ((matrix && !numbers_of(matrix, 16, c)) || (moved && !numbers_of(moved, 3, t)) ||
        (turned && !numbers_of(turned, 4, q)) || (scaled && !numbers_of(scaled, 3, s)))
        return bad(g, "the place of a node is not in numbers", error);
    if (matrix) {
        *place =
            (iso_mesh_place){{c[0], c[4], c[8], c[1], c[5], c[9], c[2], c[6], c[10]}, {c[12], c[13], c[14]}};
        return ISO_OK;
    }
    iso_quaternion_matrix((const double[4]){q[3], q[0], q[1], q[2]}, place->m);
    for (int i = 0; i < 9; i++) place->m[i] *= s[i % 3];
    place->origin = iso_vec3_make(t[0], t[1], t[2]);
    return ISO_OK;
}

static iso_status add_nodes(glb *g, const json_t *numbers, const iso_mesh_place *outer, int depth,
                            iso_error *error);

static iso_status add_node(glb *g, uint64_t index, const iso_mesh_place *outer, int depth, iso_error *error) {
    const json_t *node = item_of(g, "nodes", index);
    unsigned char *placed = g->placed.data;
    iso_mesh_place place;
    if (!node || placed[index] || depth == DEEPEST) return bad(g, "its nodes are not a tree", error);
    placed[index] = 1;
    ISO_TRY(place_of(g, node, &place, error));
    place = iso_mesh_place_within(outer, &place);
    const uint64_t number = index_of(node, "mesh", UINT64_MAX);
    const json_t *mesh = item_of(g, "meshes", number);
    if (mesh)
        ISO_TRY(add_mesh(g, mesh, &place, error));
    else if (json_object_get(node, "mesh"))
        return bad(g, "a node has a mesh that is not there", error);
    return add_nodes(g, json_object_get(node, "children"), &place, depth + 1, error);
}

static iso_status add_nodes(glb *g, const json_t *numbers, const iso_mesh_place *outer, int depth,
                            iso_error *error) {
    for (size_t i = 0; i < json_array_size(numbers); i++) {
        const json_t *number = json_array_get(numbers, i);
        const uint64_t index = json_is_integer(number) ? (uint64_t)json_integer_value(number) : UINT64_MAX;
        ISO_TRY(add_node(g, index, outer, depth, error));
    }
    return ISO_OK;
}

/* Whether the file needs an extension without which its triangles are others. */
static const char *needed_extension(const glb *g) {
    size_t i;
    const json_t *name, *names = json_object_get(g->root, "extensionsRequired");
    json_array_foreach(names, i, name) {
        const char *text = json_string_value(name);
        if (text && (strstr(text, "compression") || strstr(text, "instancing"))) return text;
    }
    return NULL;
}

/* Adds the scene that is shown first, or, where there is none, all meshes. */
static iso_status add_scene(glb *g, iso_error *error) {
    /* metres with y up in mm with z up */
    static const iso_mesh_place world = {{1000, 0, 0, 0, 0, -1000, 0, 1000, 0}, {0, 0, 0}};
    const char *extension = needed_extension(g);
    if (extension)
        return iso_fail(error, ISO_ERR_UNSUPPORTED,
                        "%s: needs glTF's extension %.40s, which is not read: export it without", g->r->path,
                        extension);
    g->colored = g->r->real_colors = has_colors(g);
    const json_t *scene = item_of(g, "scenes", index_of(g->root, "scene", 0));
    if (scene) {
        ISO_TRY(iso_reading_reserve(&g->r->text, &g->placed,
                                    json_array_size(json_object_get(g->root, "nodes")) + 1, 1, 0, error));
        memset(g->placed.data, 0, g->placed.bytes);
        return add_nodes(g, json_object_get(scene, "nodes"), &world, 0, error);
    }
    size_t i;
    const json_t *mesh, *meshes = json_object_get(g->root, "meshes");
    json_array_foreach(meshes, i, mesh) ISO_TRY(add_mesh(g, mesh, &world, error));
    return ISO_OK;
}

/* ---- the file */

/* Finds a chunk of the file: its bytes, which follow the place *at, and moves behind them. */
static iso_status take_chunk(const glb *g, const unsigned char *file, uint64_t count, const char *type,
                             uint64_t *at, const unsigned char **chunk, uint64_t *bytes, iso_error *error) {
    if (count - *at < CHUNK) return iso_fail(error, ISO_ERR_IO, "%s: truncated", g->r->path);
    const uint64_t length = (uint64_t)iso_scalar_load(file + *at, ISO_SCALAR_UINT32, false);
    const bool found = memcmp(file + *at + 4, type, 4) == 0;
    *at += CHUNK;
    if (length > count - *at) return iso_fail(error, ISO_ERR_IO, "%s: truncated", g->r->path);
    *chunk = found ? file + *at : NULL;
    *bytes = found ? length : 0;
    *at += length;
    return ISO_OK;
}

static iso_status read_chunks(glb *g, const unsigned char *file, uint64_t bytes, iso_error *error) {
    const unsigned char *text;
    uint64_t at = HEADER, length;
    json_error_t problem;
    if (bytes < HEADER || memcmp(file, "glTF", 4) != 0) return bad(g, "it does not begin with glTF", error);
    const double version = iso_scalar_load(file + 4, ISO_SCALAR_UINT32, false),
                 stated = iso_scalar_load(file + 8, ISO_SCALAR_UINT32, false);
    if (version != 2)
        return iso_fail(error, ISO_ERR_UNSUPPORTED, "%s: glTF %g is not read, glTF 2 is", g->r->path,
                        version);
    if (stated > (double)bytes) return iso_fail(error, ISO_ERR_IO, "%s: truncated", g->r->path);
    bytes = (uint64_t)stated;
    ISO_TRY(take_chunk(g, file, bytes, "JSON", &at, &text, &length, error));
    if (!text) return bad(g, "it does not begin with JSON", error);
    if (length > MOST_JSON)
        return iso_fail(error, ISO_ERR_LIMIT, "%s: more than %d MB of JSON", g->r->path, MOST_JSON >> 20);
    if (at < bytes) ISO_TRY(take_chunk(g, file, bytes, "BIN\0", &at, &g->data, &g->bytes, error));
    g->root = json_loadb((const char *)text, (size_t)length, 0, &problem);
    if (!g->root)
        return json_error_code(&problem) == json_error_out_of_memory ? iso_fail_memory(error, g->r->path)
                                                                     : bad(g, "damaged JSON", error);
    return add_scene(g, error);
}

iso_status iso_mesh_read_glb(iso_mesh_reading *r, iso_error *error) {
    glb g = {.r = r};
    iso_buffer file = {0};
    size_t bytes = 0;
    r->text = iso_reading_begin(r->path, NULL, &r->report);
    iso_status status = iso_reading_load(&r->text, &file, &bytes, error);
    r->bytes = (double)bytes;
    if (status == ISO_OK) status = read_chunks(&g, file.data, bytes, error);
    json_decref(g.root);
    iso_reading_free(&r->text, &g.placed);
    iso_reading_free(&r->text, &file);
    return status;
}
