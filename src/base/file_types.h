/* file_types: the types of files (file_types.inc), looked up by name and by content. What a type can hold
 * may depend on the file: io/file_contents.h looks into it. */
#ifndef ISO_BASE_FILE_TYPES_H
#define ISO_BASE_FILE_TYPES_H

#include <stdbool.h>
#include <stddef.h>

/* The types, in the order of the list; ISO_FILE_UNKNOWN: none of them. */
typedef enum iso_file_type {
    ISO_FILE_UNKNOWN = -1,
#define FILE_TYPE(name, extensions, magic, handlers) ISO_FILE_##name,
#include "base/file_types.inc"
    ISO_FILE_TYPES
} iso_file_type;

/* What files hold, and what is written to them, as bits. */
enum {
    ISO_HOLDS_VOLUME = 1 << 0,
    ISO_HOLDS_RAW = 1 << 1, /* voxels without a header */
    ISO_HOLDS_MESH = 1 << 2,
    ISO_HOLDS_LINES = 1 << 3,
    ISO_HOLDS_GLYPHS = 1 << 4, /* points with what they have: sizes, directions, .. */
    ISO_HOLDS_POINTS = 1 << 5, /* of such files: points on surfaces, such as a scan */
    ISO_HOLDS_ROWS = 1 << 6,   /* of such files: rows of numbers, for which iso_read_opts.columns is */
    ISO_HOLDS_STROKES = 1 << 7,
    ISO_HOLDS_KEYS = 1 << 8,
    ISO_HOLDS_SCENE = 1 << 9,
    ISO_WRITES_IMAGE = 1 << 10,
    ISO_WRITES_MESH = 1 << 11,
    ISO_WRITES_POINTS = 1 << 12,
    ISO_WRITES_VOLUME = 1 << 13, /* a level set */
    ISO_WRITES_CHANNELS = 1 << 14,
    ISO_WRITES_REPORT = 1 << 15,
    ISO_WRITES_VIDEO = 1 << 16,
    ISO_WRITES_PAGE = 1 << 17,
    ISO_HOLDS_VALUES = 1 << 18 /* numbers or colours of a mesh's vertices */
};

/* How many bytes of a file tell its type. */
enum { ISO_FILE_HEAD = 1024 };

/* The name as reports say it, and the bits of a type. */
const char *iso_file_type_name(iso_file_type type);
unsigned iso_file_type_holds(iso_file_type type);

/* Writes the usual extension of a type, with its dot; "" if it has none. */
enum { ISO_FILE_EXTENSION = 16 };
void iso_file_type_extension(iso_file_type type, char extension[ISO_FILE_EXTENSION]);

/* The first type with one of the bits `holds` that has the file's extension, in either case. */
iso_file_type iso_file_type_of_name(const char *path, unsigned holds);
/* The first type with one of the bits that the first bytes of a file, ISO_FILE_HEAD or all of them, are
 * those of. */
iso_file_type iso_file_type_of_head(const void *head, size_t bytes, unsigned holds);
/* The type of a regular file by its content, else by its name; by the name alone if it cannot be read. */
iso_file_type iso_file_type_find(const char *path, unsigned holds);

/* Writes the extensions of the types with one of the bits `holds` and none of `without`, each once: all of
 * them, separated by blanks, as in ".stl .ply .obj"; or the usual one of each type, as messages say it:
 * ".stl, .ply or .obj". `last` is the word before the last one ("": none), NULL for the first form. Cut to
 * `room`. */
void iso_file_type_extensions(unsigned holds, unsigned without, const char *last, char *text, size_t room);

#endif
