/* file_contents: what a file holds, by its type (base/file_types.h) and, where a type can hold several
 * things, by its content. */
#ifndef ISO_IO_FILE_CONTENTS_H
#define ISO_IO_FILE_CONTENTS_H

#include "base/file_types.h"

/* What can be opened besides strokes, key images and scenes. */
enum {
    ISO_HOLDS_SHAPES = ISO_HOLDS_MESH | ISO_HOLDS_LINES | ISO_HOLDS_GLYPHS | ISO_HOLDS_POINTS,
    ISO_HOLDS_DATA = ISO_HOLDS_VOLUME | ISO_HOLDS_RAW | ISO_HOLDS_SHAPES
};

/* Returns the bits ISO_HOLDS_ of what a regular file may hold, 0 for a folder and for a file of no known
 * type. ISO_HOLDS_MESH means that it has faces, ISO_HOLDS_POINTS that it is one of points on surfaces, such
 * as a scan: not a molecule (.xyz), and not .csv, .vtk and .vtp, which more often hold other things. A file
 * that cannot be read, or is empty, holds what its name says, or nothing if that could be a volume or points.
 */
unsigned iso_file_contents(const char *path);

#endif
