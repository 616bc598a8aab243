/* Meshes in 3MF ("3D Manufacturing Format, Core Specification" 1.3): a ZIP archive with models in XML, whose
 * objects hold triangles, or other objects as components, also those of other models in the archive
 * ("Production Extension" 1.1). Read is what the first model builds, in its units. Materials, beams and
 * slices are left out. */
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
    iso_xml xml; /* behind its tag */
} threemf_object;

static int compare_objects(const void *a, const void *b) {
    const threemf_object *x = a, *y = b;
    if (x->model != y->model) return x->model < y->model ? -1 : 1;
    return (x->id > y->id) - (x->id < y->id);
}

typedef struct threemf {
    iso_mesh_reading *r;
    iso_buffer archive, relations, models, objects; /* of threemf_model, threemf_object */
    size_t model_count, object_count;
    size_t placed; /* objects so far */
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

static iso_status add_object(threemf *t, const iso_xml_tag *tag, const iso_xml *xml, iso_error *error) {
    uint64_t id;
    if (!parse_index(tag, "id", &id)) return bad(t, "an object without a number", error);
    ISO_TRY(iso_reading_reserve(&t->r->text, &t->objects, t->object_count + 1, sizeof(threemf_object),
                                t->object_count, error));
    ((threemf_object *)t->objects.data)[t->object_count++] = (threemf_object){t->model_count - 1, id, *xml};
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
        if (iso_xml_is(&tag, "object")) ISO_TRY(add_object(t, &tag, &xml, error));
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

static iso_status add_vertex(threemf *t, const iso_xml_tag *tag, const iso_mesh_part *part,
                             iso_error *error) {
    static const char *const names[] = {"x", "y", "z"};
    char text[ISO_XML_TEXT];
    double p[3];
    for (int axis = 0; axis < 3; axis++)
        if (!iso_xml_attribute(tag, names[axis], text) || !parse_numbers(text, 1, &p[axis]))
            return bad(t, "a vertex without three numbers", error);
    return iso_mesh_part_vertex(t->r, part, iso_vec3_make(p[0], p[1], p[2]), error);
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
    while (iso_xml_next(&xml, &tag) && !iso_xml_is(&tag, "/object") && !iso_xml_is(&tag, "object"))
        if (iso_xml_is(&tag, "vertex")) {
            ISO_TRY(add_vertex(t, &tag, &part, error));
        } else if (iso_xml_is(&tag, "triangle")) {
            uint64_t c[3];
            if (!parse_index(&tag, "v1", &c[0]) || !parse_index(&tag, "v2", &c[1]) ||
                !parse_index(&tag, "v3", &c[2]))
                return bad(t, "a triangle without three vertices", error);
            ISO_TRY(iso_mesh_part_triangle(t->r, &part, c, error));
        } else if (iso_xml_is(&tag, "component"))
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
    for (size_t i = 0; i < t.model_count; i++)
        iso_reading_free(&r->text, &((threemf_model *)t.models.data)[i].unpacked);
    iso_reading_free(&r->text, &t.archive);
    iso_reading_free(&r->text, &t.relations);
    iso_reading_free(&r->text, &t.models);
    iso_reading_free(&r->text, &t.objects);
    return status;
}
