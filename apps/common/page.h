/* page: a picture of isosurfaces, labels and lines as one HTML file that anyone can open, without a network
 * or a server, and in which these can be turned and isovalues moved. It holds the voxels that this needs, and
 * the engine that draws them (apps/page): the library itself, compiled to WebAssembly. docs/page.md. */
#ifndef ISO_APPS_COMMON_PAGE_H
#define ISO_APPS_COMMON_PAGE_H

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

#include "isopoint.h"
#include "scene/layered_picture.h"
#include "scene/object.h"

enum { ISO_PAGE_SURFACES = 16 };
/* The largest page when nobody says it: of a range that is chosen, and of one that is given. */
#define ISO_PAGE_BYTES ((uint64_t)8000000)
#define ISO_PAGE_BYTES_GIVEN ((uint64_t)64000000)

typedef struct iso_page_surface {
    double isovalue; /* physical */
    iso_rgb color;
    iso_translucency translucency;
} iso_page_surface;

/* A half-space that is cut away. */
typedef struct iso_page_clip {
    /* Cut away is where x * p.x + y * p.y + z * p.z > offset; x y z is a unit vector, 0: nothing is. */
    double plane[4];
    bool cap; /* the cut is closed in the colours of the surfaces */
} iso_page_clip;

/* How a label is drawn. */
typedef struct iso_page_label {
    const char *name;
    iso_rgb color;
    int group; /* of labels, 1 .. group_count; 0: it is not drawn */
} iso_page_label;

/* A volume of labels. */
typedef struct iso_page_labels {
    int dims[3];
    const iso_transform *transform;
    const uint16_t
        *number; /* of every voxel, x fastest: the place of its label in `items`; 0: the background */
    const iso_page_label *items;
    int count;                      /* of items, with that of the background; each of the others has voxels */
    const iso_page_surface *groups; /* their surfaces, without isovalues */
    int group_count;
    int shared; /* the group whose surface has the colours of its labels; 0: none */
} iso_page_labels;

/* Lines, as they are drawn. */
typedef struct iso_page_lines {
    iso_lines lines; /* whose arrays are borrowed */
    iso_shapes_opts opts;
    iso_rgb color;
    iso_translucency translucency;
} iso_page_lines;

/* What is written; all borrowed. */
typedef struct iso_page {
    const char *name;   /* of the input, as the page's title and command have it */
    bool without_input; /* the name is that of labels or lines: the command has no input */
    iso_rgrid *grid;    /* NULL: there are no isosurfaces */
    const iso_page_surface *surfaces;
    int count;                     /* ISO_PAGE_SURFACES at most */
    const iso_page_labels *labels; /* NULL: none */
    const iso_page_lines *lines;
    int lines_count; /* of files */
    iso_box bounds;  /* of everything; used without volume and labels */
    iso_page_clip clip;
    const iso_camera *camera;
    const iso_image *image; /* the first picture */
    iso_rgb background;
    /* Of isorender, beside those that the page itself changes, such as "--crop=..". NULL: they are not known,
     * and the page offers no command. */
    const char *const *options;
    int option_count;
    double range[2]; /* of isovalues; NaN: the widest around the isovalues that fits */
    uint64_t most;   /* bytes of the page; 0: ISO_PAGE_BYTES or ISO_PAGE_BYTES_GIVEN */
    iso_pool *pool;  /* or NULL */
} iso_page;

/* What has been written. */
typedef struct iso_page_written {
    double range[2];
    uint64_t bytes, engine_bytes, voxel_bytes, label_bytes, line_bytes; /* of the file, and of parts of it */
    double kept; /* share of the voxels that are kept */
} iso_page_written;

/* Whether a file of this name is a page. */
bool iso_page_is_named(const char *path);
/* Whether this build can write pages: else ISO_ERR_BACKEND names what it lacks. */
iso_status iso_page_check(const char *path, iso_error *error);
/* Writes a page to a stream, whose errors the caller finds; `path` is what messages call it. Errors: those of
 * iso_page_check; ISO_ERR_LIMIT: the page would be larger than `most`; ISO_ERR_NOMEM. */
iso_status iso_page_put(FILE *stream, const char *path, const iso_page *page, iso_page_written *written,
                        iso_error *error);
/* Writes a page to a file, wholly or not at all. Errors: those of iso_page_put; ISO_ERR_WRITE. */
iso_status iso_page_write(const char *path, const iso_page *page, iso_page_written *written,
                          iso_error *error);

#endif
