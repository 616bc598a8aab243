/* Meshes in 3MF ("3D Manufacturing Format, Core Specification" 1.3): a ZIP archive with models in XML, whose
 * objects hold triangles, or other objects as components, also those of other models in the archive
 * ("Production Extension" 1.1). Read is what the first model builds, in its units, with the colours of base
 * materials and of colour groups ("Materials and Properties Extension" 1.2). Textures, beams and slices are
 * left out. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "base/xml.h"
#include "io/mesh/placed_parts.h"

enum { DEEPEST = 32, MOST_OBJECTS = 1 << 20 };

typedef struct threemf_model {
    iso_zip_entry entry;
    iso_buffer unpacked;
    iso_xml xml; /* all of it */
} threemf_model;

typedef struct threemf_object {
    size_t model;
    uint64_t id;
    iso_xml xml;     /* behind its tag */
    iso_xml_tag tag; /* its own */
} threemf_object;

/* Colours of a model that triangles name: those of base materials or of a colour group. */
typedef struct threemf_palette {
    size_t model, first, count; /* in threemf.colors */
    uint64_t id;
} threemf_palette;

static int compare_palettes(const void *a, const void *b) {
    const threemf_palette *x = a, *y = b;
    if (x->model != y->model) return x->model < y->model ? -1 : 1;
    return (x->id > y->id) - (x->id < y->id);
}

static int compare_objects(const void *a, const void *b) {
    const threemf_object *x = a, *y = b;
    if (x->model != y->model) return x->model < y->model ? -1 : 1;
    return (x->id > y->id) - (x->id < y->id);
}

typedef struct threemf {
    iso_mesh_reading *r;
    iso_buffer archive, relations, models, objects; /* of threemf_model, threemf_object */
    size_t model_count, object_count;
    size_t placed;               /* objects so far */
    iso_buffer palettes, colors; /* of threemf_palette, and three uint8_t each */
    size_t palette_count, color_count;
    iso_buffer given; /* of each vertex of the part, whether a triangle has given it a colour */
    size_t given_count;
    bool any_given;
} threemf;

static iso_status bad(const threemf *t, const char *what, iso_error *error) {
    return iso_fail(error, ISO_ERR_FORMAT, "%s: not a readable 3MF file: %s", t->r->path, what);
}

/* Names in an archive begin without a slash, and their case does not count. */
static bool is_named(const iso_zip_entry *entry, const char *name) {
    name += *name == '/';
    return strlen(name) == entry->name_length && strncasecmp(entry->name, name, entry->name_length) == 0;
}

/* Parses `count` numbers between blanks. */
static bool parse_numbers(const char *text, int count, double *numbers) {
    char *end = (char *)(uintptr_t)text;
    for (int i = 0; i < count; i++) {
        const char *from = end;
        numbers[i] = strtod(from, &end);
        if (end == from) return false;
    }
    return end[strspn(end, " \t\r\n")] == 0;
}

static bool parse_index(const iso_xml_tag *tag, const char *name, uint64_t *index) {
    char text[ISO_XML_TEXT], *end;
    if (!iso_xml_attribute(tag, name, text)) return false;
    *index = strtoull(text, &end, 10);
    return end != text && !*end && *text != '-';
}

/* The place that a tag states; none: where it is. */
static iso_status place_of(const threemf *t, const iso_xml_tag *tag, iso_mesh_place *place,
                           iso_error *error) {
    char text[ISO_XML_TEXT];
    double n[12] = {1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0};
    if (iso_xml_attribute(tag, "transform", text) && !parse_numbers(text, 12, n))
        return bad(t, "a transform is not twelve numbers", error);
    *place = (iso_mesh_place){{n[0], n[3], n[6], n[1], n[4], n[7], n[2], n[5], n[8]}, {n[9], n[10], n[11]}};
    return ISO_OK;
}

/* ---- what is in the archive */

static iso_status add_palette(threemf *t, const iso_xml_tag *tag, iso_error *error) {
    threemf_palette palette = {.model = t->model_count - 1, .first = t->color_count};
    if (!parse_index(tag, "id", &palette.id)) return bad(t, "colours without a number", error);
    ISO_TRY(iso_reading_reserve(&t->r->text, &t->palettes, t->palette_count + 1, sizeof palette,
                                t->palette_count, error));
    ((threemf_palette *)t->palettes.data)[t->palette_count++] = palette;
    return ISO_OK;
}

/* Adds a colour, #RRGGBB or #RRGGBBAA, to the last palette. */
static iso_status add_palette_color(threemf *t, const iso_xml_tag *tag, const char *name, iso_error *error) {
    char text[ISO_XML_TEXT];
    unsigned rgb[3] = {255, 255, 255};
    if (!t->palette_count) return bad(t, "a colour that is of no group", error);
    if (iso_xml_attribute(tag, name, text) && sscanf(text, "#%2x%2x%2x", &rgb[0], &rgb[1], &rgb[2]) != 3)
        return bad(t, "a colour that is not #RRGGBB", error);
    ISO_TRY(iso_reading_reserve(&t->r->text, &t->colors, t->color_count + 1, 3, t->color_count, error));
    uint8_t *to = (uint8_t *)t->colors.data + 3 * t->color_count++;
    for (int k = 0; k < 3; k++) to[k] = (uint8_t)rgb[k];
    ((threemf_palette *)t->palettes.data)[t->palette_count - 1].count++;
    return ISO_OK;
}

static iso_status add_resource(threemf *t, const iso_xml_tag *tag, iso_error *error) {
    if (iso_xml_is(tag, "basematerials") || iso_xml_is(tag, "m:colorgroup"))
        return add_palette(t, tag, error);
    if (iso_xml_is(tag, "base")) return add_palette_color(t, tag, "displaycolor", error);
    return iso_xml_is(tag, "m:color") ? add_palette_color(t, tag, "color", error) : ISO_OK;
}

static iso_status add_object(threemf *t, const iso_xml_tag *tag, const iso_xml *xml, iso_error *error) {
    uint64_t id;
    if (!parse_index(tag, "id", &id)) return bad(t, "an object without a number", error);
    ISO_TRY(iso_reading_reserve(&t->r->text, &t->objects, t->object_count + 1, sizeof(threemf_object),
                                t->object_count, error));
    ((threemf_object *)t->objects.data)[t->object_count++] =
        (threemf_object){t->model_count - 1, id, *xml, *tag};
    return ISO_OK;
}

static iso_status add_model(threemf *t, const iso_zip_entry *entry, iso_error *error) {
    const unsigned char *bytes;
    ISO_TRY(iso_reading_reserve(&t->r->text, &t->models, t->model_count + 1, sizeof(threemf_model),
                                t->model_count, error));
    threemf_model *model = (threemf_model *)t->models.data + t->model_count++;
    *model = (threemf_model){.entry = *entry};
    ISO_TRY(iso_reading_unzip(&t->r->text, entry, &model->unpacked, &bytes, error));
    model->xml = (iso_xml){(const char *)bytes, (const char *)bytes + entry->size};
    t->r->bytes += (double)entry->size;
    iso_xml xml = model->xml;
    iso_xml_tag tag;
    while (iso_xml_next(&xml, &tag))
        ISO_TRY(iso_xml_is(&tag, "object") ? add_object(t, &tag, &xml, error) : add_resource(t, &tag, error));
    return ISO_OK;
}

static const threemf_model *find_model(const threemf *t, const char *name) {
    const threemf_model *models = t->models.data;
    for (size_t i = 0; i < t->model_count; i++)
        if (is_named(&models[i].entry, name)) return &models[i];
    return NULL;
}

/* Unpacks the archive's models, and finds the name of the first one, which its relations state. */
static iso_status open_archive(threemf *t, char first[ISO_XML_TEXT], iso_error *error) {
    size_t count;
    iso_zip zip;
    iso_zip_entry entry;
    bool more;
    ISO_TRY(iso_reading_load(&t->r->text, &t->archive, &count, error));
    ISO_TRY(iso_zip_open(t->r->path, t->archive.data, count, &zip, error));
    for (;;) {
        ISO_TRY(iso_zip_next(t->r->path, &zip, &entry, &more, error));
        if (!more) break;
        if (entry.name_length > 6 && strncasecmp(entry.name + entry.name_length - 6, ".model", 6) == 0)
            ISO_TRY(add_model(t, &entry, error));
        if (!is_named(&entry, "_rels/.rels")) continue;
        const unsigned char *bytes;
        ISO_TRY(iso_reading_unzip(&t->r->text, &entry, &t->relations, &bytes, error));
        iso_xml xml = {(const char *)bytes, (const char *)bytes + entry.size};
        iso_xml_tag tag;
        char type[ISO_XML_TEXT];
        while (!*first && iso_xml_next(&xml, &tag))
            if (iso_xml_is(&tag, "Relationship") && iso_xml_attribute(&tag, "Type", type) &&
                strstr(type, "/3dmodel"))
                iso_xml_attribute(&tag, "Target", first);
    }
    if (t->object_count) qsort(t->objects.data, t->object_count, sizeof(threemf_object), compare_objects);
    if (t->palette_count)
        qsort(t->palettes.data, t->palette_count, sizeof(threemf_palette), compare_palettes);
    return ISO_OK;
}

/* ---- what is built */

static iso_status place_object(threemf *t, size_t model, uint64_t id, const iso_mesh_place *place, int depth,
                               iso_error *error);

/* Places the object that a build's item or a component names, in the model where it is. */
static iso_status place_named(threemf *t, size_t model, const iso_xml_tag *tag, const iso_mesh_place *outer,
                              int depth, iso_error *error) {
    char path[ISO_XML_TEXT];
    uint64_t id;
    iso_mesh_place inner;
    if (!parse_index(tag, "objectid", &id)) return bad(t, "an object is used without its number", error);
    if (iso_xml_attribute(tag, "p:path", path)) {
        const threemf_model *named = find_model(t, path);
        if (!named) return bad(t, "a model that it names is not in it", error);
        model = (size_t)(named - (threemf_model *)t->models.data);
    }
    ISO_TRY(place_of(t, tag, &inner, error));
    inner = iso_mesh_place_within(outer, &inner);
    return place_object(t, model, id, &inner, depth, error);
}

/* ---- colours */

/* A colour of a palette; NULL: it is not there. */
static const uint8_t *find_color(const threemf *t, size_t model, uint64_t id, uint64_t index) {
    const threemf_palette key = {.model = model, .id = id}, *palettes = t->palettes.data,
                          *found = bsearch(&key, palettes, t->palette_count, sizeof key, compare_palettes);
    return found && index < found->count ? (const uint8_t *)t->colors.data + 3 * (found->first + index)
                                         : NULL;
}

static iso_status add_color(threemf *t, const uint8_t *color, iso_error *error) {
    const double rgb[3] = {color[0], color[1], color[2]};
    return iso_mesh_add_color(t->r, rgb, error);
}

static iso_status add_vertex(threemf *t, const iso_xml_tag *tag, const iso_mesh_part *part,
                             iso_error *error) {
    static const char *const names[] = {"x", "y", "z"};
    char text[ISO_XML_TEXT];
    double p[3];
    for (int axis = 0; axis < 3; axis++)
        if (!iso_xml_attribute(tag, names[axis], text) || !parse_numbers(text, 1, &p[axis]))
            return bad(t, "a vertex without three numbers", error);
    ISO_TRY(iso_mesh_part_vertex(t->r, part, iso_vec3_make(p[0], p[1], p[2]), error));
    if (!t->color_count) return ISO_OK;
    ISO_TRY(iso_reading_reserve(&t->r->text, &t->given, t->given_count + 1, 1, t->given_count, error));
    ((uint8_t *)t->given.data)[t->given_count++] = 0;
    return add_color(t, (const uint8_t[3]){255, 255, 255}, error);
}

/* Gives a corner of a triangle a colour: its vertex, or a copy of that if other triangles gave it another
 * one. */
static iso_status color_corner(threemf *t, const iso_mesh_part *part, const uint8_t *color, uint64_t *corner,
                               iso_error *error) {
    iso_mesh_reading *r = t->r;
    const size_t vertex = part->first + *corner;
    if (*corner >= t->given_count || vertex >= r->color_count) return ISO_OK; /* (the triangle is refused) */
    t->any_given = true;
    float *stored = (float *)r->colors.data + 3 * vertex;
    uint8_t *given = (uint8_t *)t->given.data + *corner;
    const bool same =
        (float)color[0] == stored[0] && (float)color[1] == stored[1] && (float)color[2] == stored[2];
    if (*given && !same) {
        const float *at = (const float *)r->vertices.data + 3 * vertex;
        const double place[3] = {(double)at[0], (double)at[1], (double)at[2]};
        *corner = r->vertex_count - part->first;
        ISO_TRY(iso_mesh_add_vertex(r, place, error));
        return add_color(t, color, error);
    }
    for (int k = 0; k < 3; k++) stored[k] = color[k];
    *given = 1;
    return ISO_OK;
}

/* The colours of a triangle's corners: those that it names, else the one of its object. NULL: none. */
static void find_colors(const threemf *t, size_t model, const iso_xml_tag *triangle,
                        const iso_xml_tag *object, const uint8_t *colors[3]) {
    static const char *const names[] = {"p1", "p2", "p3"};
    uint64_t own = 0, palette = 0, index[3] = {0, 0, 0};
    const bool has_own = parse_index(object, "pid", &own), named = parse_index(triangle, names[0], &index[0]);
    if (!parse_index(triangle, "pid", &palette)) palette = own;
    if (!named && has_own && parse_index(object, "pindex", &index[0])) palette = own;
    for (int k = 1; k < 3; k++)
        if (!named || !parse_index(triangle, names[k], &index[k])) index[k] = index[0];
    for (int k = 0; k < 3; k++) colors[k] = find_color(t, model, palette, index[k]);
}

static iso_status add_triangle(threemf *t, size_t model, const iso_xml_tag *tag, const iso_xml_tag *object,
                               const iso_mesh_part *part, iso_error *error) {
    static const char *const names[] = {"v1", "v2", "v3"};
    const uint8_t *colors[3] = {NULL, NULL, NULL};
    uint64_t corners[3];
    for (int k = 0; k < 3; k++)
        if (!parse_index(tag, names[k], &corners[k]))
            return bad(t, "a triangle without three vertices", error);
    if (t->color_count) find_colors(t, model, tag, object, colors);
    for (int k = 0; k < 3; k++)
        if (colors[k]) ISO_TRY(color_corner(t, part, colors[k], &corners[k], error));
    return iso_mesh_part_triangle(t->r, part, corners, error);
}

static iso_status place_object(threemf *t, size_t model, uint64_t id, const iso_mesh_place *place, int depth,
                               iso_error *error) {
    const threemf_object key = {.model = model, .id = id};
    const threemf_object *object =
        t->object_count ? bsearch(&key, t->objects.data, t->object_count, sizeof key, compare_objects) : NULL;
    if (!object) return bad(t, "an object that it uses is not there", error);
    if (depth == DEEPEST) return bad(t, "its objects contain each other", error);
    if (t->placed++ == MOST_OBJECTS)
        return iso_fail(error, ISO_ERR_LIMIT, "%s: more than %d objects are built", t->r->path, MOST_OBJECTS);
    iso_xml xml = object->xml;
    iso_xml_tag tag;
    const iso_mesh_part part = iso_mesh_part_begin(t->r, place);
    t->given_count = 0;
    while (iso_xml_next(&xml, &tag) && !iso_xml_is(&tag, "/object") && !iso_xml_is(&tag, "object"))
        if (iso_xml_is(&tag, "vertex"))
            ISO_TRY(add_vertex(t, &tag, &part, error));
        else if (iso_xml_is(&tag, "triangle"))
            ISO_TRY(add_triangle(t, model, &tag, &object->tag, &part, error));
        else if (iso_xml_is(&tag, "component"))
            ISO_TRY(place_named(t, model, &tag, place, depth + 1, error));
    return ISO_OK;
}

static iso_status unit_of(const threemf *t, const iso_xml_tag *tag, double *mm, iso_error *error) {
    static const struct {
        const char *name;
        double mm;
    } units[] = {{"millimeter", 1}, {"micron", 1e-3}, {"centimeter", 10},
                 {"inch", 25.4},    {"foot", 304.8},  {"meter", 1000}};
    char name[ISO_XML_TEXT] = "millimeter";
    iso_xml_attribute(tag, "unit", name);
    for (size_t i = 0; i < sizeof units / sizeof *units; i++)
        if (strcmp(name, units[i].name) == 0) {
            *mm = units[i].mm;
            return ISO_OK;
        }
    return bad(t, "a unit that 3MF does not have", error);
}

static iso_status build(threemf *t, const threemf_model *first, iso_error *error) {
    iso_xml xml = first->xml;
    iso_xml_tag tag;
    double mm = 0;
    iso_mesh_place world = {.m = {0}, .origin = {0, 0, 0}};
    while (iso_xml_next(&xml, &tag) && !iso_xml_is(&tag, "/model"))
        if (iso_xml_is(&tag, "model")) {
            ISO_TRY(unit_of(t, &tag, &mm, error));
            for (int axis = 0; axis < 3; axis++) world.m[4 * axis] = mm;
        } else if (mm > 0 && iso_xml_is(&tag, "item"))
            ISO_TRY(
                place_named(t, (size_t)(first - (threemf_model *)t->models.data), &tag, &world, 0, error));
    return mm > 0 ? ISO_OK : bad(t, "its model has no element model", error);
}

iso_status iso_mesh_read_threemf(iso_mesh_reading *r, iso_error *error) {
    threemf t = {.r = r};
    char first[ISO_XML_TEXT] = "";
    r->text = iso_reading_begin(r->path, NULL, &r->report);
    iso_status status = open_archive(&t, first, error);
    const threemf_model *model = status == ISO_OK ? find_model(&t, first) : NULL;
    if (status == ISO_OK) status = model ? build(&t, model, error) : bad(&t, "it holds no model", error);
    if (!t.any_given) r->color_count = 0;
    for (size_t i = 0; i < t.model_count; i++)
        iso_reading_free(&r->text, &((threemf_model *)t.models.data)[i].unpacked);
    iso_reading_free(&r->text, &t.archive);
    iso_reading_free(&r->text, &t.relations);
    iso_reading_free(&r->text, &t.models);
    iso_reading_free(&r->text, &t.objects);
    iso_reading_free(&r->text, &t.palettes);
    iso_reading_free(&r->text, &t.colors);
    iso_reading_free(&r->text, &t.given);
    return status;
}
