/* bdv: reads the .xml files of BigDataViewer ("SpimData"), which say where the images of an HDF5 file lie.
 *
 * Of the text only a few elements matter, none of which is within another one of the same name; it is
 * searched for them. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "grids/volume/hdf5/hdf5.h"

/* A thousand images take about a megabyte. */
enum { MOST_TEXT = 16 << 20, HEAD = 1024 };

static iso_status read_text(const char *path, char **text, iso_error *error) {
    FILE *file;
    uint64_t bytes;
    iso_status status = ISO_OK;
    *text = NULL;
    ISO_TRY(iso_file_open(path, &file, &bytes, error));
    if (bytes > MOST_TEXT)
        status = iso_fail(error, ISO_ERR_LIMIT, "%s: has %.0f MB, texts of more than %d MB are not read",
                          path, (double)bytes / (1 << 20), MOST_TEXT >> 20);
    else if (!(*text = calloc((size_t)bytes + 1, 1)))
        status = iso_fail_memory(error, path);
    else if (fread(*text, 1, (size_t)bytes, file) != bytes)
        status = iso_fail(error, ISO_ERR_IO, "%s: cannot be read, or changed meanwhile", path);
    fclose(file);
    if (status != ISO_OK) free(*text);
    return status;
}

bool iso_bdv_is_xml(const char *path) {
    char head[HEAD + 1] = "";
    head[iso_file_head(path, head, HEAD)] = 0;
    return strstr(head, "<SpimData") != NULL;
}

/* ---- elements ---- */

/* A part of the text. */
typedef struct part {
    const char *begin, *end;
} part;

static const char *find(part text, const char *word) {
    return text.begin < text.end ? memmem(text.begin, (size_t)(text.end - text.begin), word, strlen(word))
                                 : NULL;
}

/* Finds the next element <name ...>content</name>, and moves *text behind it. `tag` (may be NULL) gets its
 * attributes. */
static bool next_element(part *text, const char *name, part *tag, part *content) {
    char open[48], close[48];
    const size_t length = (size_t)snprintf(open, sizeof open, "<%s", name);
    snprintf(close, sizeof close, "</%s>", name);
    for (const char *at; (at = find(*text, open)); text->begin = at + length) {
        const part rest = {at + length, text->end};
        const char *end = find(rest, ">");
        if (!end) return false;
        if (!strchr(" \t\r\n/>", at[length])) continue; /* a longer name */
        if (tag) *tag = (part){rest.begin, end};
        *content = (part){end + 1, end + 1};
        text->begin = end + 1;
        if (end[-1] == '/') return true;
        content->end = find(*text, close);
        if (!content->end) return false;
        text->begin = content->end;
        return true;
    }
    return false;
}

static bool first_element(part text, const char *name, part *content) {
    return next_element(&text, name, NULL, content);
}

static void copy_part(part text, char *copy, size_t room) {
    while (text.begin < text.end && strchr(" \t\r\n", *text.begin)) text.begin++;
    while (text.begin < text.end && strchr(" \t\r\n", text.end[-1])) text.end--;
    snprintf(copy, room, "%.*s", (int)(text.end - text.begin), text.begin);
}

/* Reads exactly `count` numbers. */
static bool read_numbers(part text, double *numbers, int count) {
    const char *at = text.begin;
    for (int i = 0; i < count; i++) {
        char *end;
        numbers[i] = strtod(at, &end);
        if (end == at || end > text.end) return false;
        at = end;
    }
    return true;
}

/* Whether an attribute of a tag has this number. */
static bool has_number(part tag, const char *attribute, unsigned wanted) {
    char start[48];
    double number;
    snprintf(start, sizeof start, " %s=", attribute);
    const char *at = find(tag, start);
    if (!at) return false;
    const part value = {at + strlen(start) + 1, tag.end}; /* behind a quotation mark */
    return read_numbers(value, &number, 1) && number == (double)wanted;
}

/* ---- what is looked for ---- */

iso_status iso_bdv_file(const char *xml, char **path, iso_error *error) {
    char *text, name[1024], format[80] = "";
    part loader = {0}, content;
    iso_status status = ISO_OK;
    *path = NULL;
    ISO_TRY(read_text(xml, &text, error));
    part rest = {text, text + strlen(text)}, tag = {0};
    const bool has_loader = next_element(&rest, "ImageLoader", &tag, &loader);
    if (has_loader && first_element(loader, "hdf5", &content)) {
        copy_part(content, name, sizeof name);
        *path = iso_format_beside(xml, name);
        if (!*path) status = iso_fail_memory(error, xml);
    } else {
        const char *at = has_loader ? find(tag, "format=") : NULL;
        if (at) copy_part((part){at + strlen("format="), tag.end}, format, sizeof format);
        status = iso_fail(error, ISO_ERR_UNSUPPORTED,
                          "%s: its images are not in one HDF5 file (%s): name their file or folder", xml,
                          at ? format : "no ImageLoader");
    }
    free(text);
    return status;
}

/* *total becomes *total * next, of affine maps in rows of four numbers. */
static void append(double total[12], const double next[12]) {
    double product[12];
    for (int row = 0; row < 3; row++)
        for (int column = 0; column < 4; column++) {
            double sum = column == 3 ? total[4 * row + 3] : 0;
            for (int k = 0; k < 3; k++) sum += total[4 * row + k] * next[4 * k + column];
            product[4 * row + column] = sum;
        }
    memcpy(total, product, sizeof product);
}

/* The voxels' size of a setup. */
static bool find_size(part text, unsigned setup, iso_bdv_view *view) {
    part element, id, voxel, content;
    double number;
    while (next_element(&text, "ViewSetup", NULL, &element)) {
        if (!first_element(element, "id", &id) || !read_numbers(id, &number, 1) || number != (double)setup)
            continue;
        if (!first_element(element, "voxelSize", &voxel) || !first_element(voxel, "size", &content))
            return true;
        view->has_size = true;
        if (!read_numbers(content, view->size, 3)) return false;
        for (int i = 0; i < 3; i++)
            if (!(view->size[i] > 0 && view->size[i] < 1e12)) return false;
        if (first_element(voxel, "unit", &content)) copy_part(content, view->unit, sizeof view->unit);
        return true;
    }
    return true;
}

/* The transforms of a view: the first one is applied last. */
static bool find_affine(part text, unsigned time, unsigned setup, iso_bdv_view *view) {
    part tag, element, transform, content;
    double next[12];
    while (next_element(&text, "ViewRegistration", &tag, &element)) {
        if (!has_number(tag, "timepoint", time) || !has_number(tag, "setup", setup)) continue;
        memcpy(view->affine, (const double[12]){1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0}, sizeof view->affine);
        while (next_element(&element, "ViewTransform", NULL, &transform)) {
            if (!first_element(transform, "affine", &content) || !read_numbers(content, next, 12))
                return false;
            append(view->affine, next);
            view->has_affine = true;
        }
        return true;
    }
    return true;
}

iso_status iso_bdv_read_view(const char *xml, unsigned time, unsigned setup, iso_bdv_view *view,
                             iso_error *error) {
    char *text;
    *view = (iso_bdv_view){.has_size = false};
    ISO_TRY(read_text(xml, &text, error));
    const part all = {text, text + strlen(text)};
    const bool good = find_size(all, setup, view) && find_affine(all, time, setup, view);
    free(text);
    return good ? ISO_OK
                : iso_fail(error, ISO_ERR_FORMAT,
                           "%s: the voxelSize or transforms of setup %u are not numbers", xml, setup);
}
