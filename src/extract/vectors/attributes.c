/* attributes: allocates named columns of numbers. */
#include "extract/vectors/attributes.h"

#include <string.h>

#include "base/memory.h"

static bool make_one(const char *name, size_t items, iso_attribute *attribute) {
    const size_t length = strlen(name) + 1;
    attribute->components = 1;
    attribute->name = iso_alloc(length);
    attribute->values = items ? iso_alloc(items * sizeof *attribute->values) : NULL;
    if (attribute->name) memcpy(attribute->name, name, length);
    return attribute->name && (attribute->values || !items);
}

iso_status iso_attributes_make(const char *const *names, int count, size_t items, iso_attribute **attributes,
                               iso_error *error) {
    iso_attribute *made = iso_alloc_zero((size_t)count, sizeof *made);
    bool good = made != NULL;
    for (int i = 0; good && i < count; i++) good = make_one(names[i], items, &made[i]);
    if (good) {
        *attributes = made;
        return ISO_OK;
    }
    if (made) iso_attributes_free(made, count);
    return iso_fail_memory(error, "columns of numbers");
}
