/* isopoint_figures: the chapter of isopoint.h about what stands over a picture for a paper or a talk: texts,
 * arrows, rulers, a legend, scale bar and orientation marker, painted onto the picture or, in files of SVG
 * and PDF, as text and lines over it. What isopoint.h says of units, errors, ownership and threads holds here
 * too.
 *
 * Letters are those of a font inside (Latin, Greek, Cyrillic, arrows, operators); texts are UTF-8, from
 * left to right, of 400 characters at most. */
#ifndef ISOPOINT_FIGURES_H
#define ISOPOINT_FIGURES_H

#include "isopoint.h"

#ifdef __cplusplus
extern "C" {
#endif

/* A place in the world, mm, or in the picture: at[0] and at[1] are parts of its width and height from its
 * top left corner. */
typedef struct iso_place {
    bool in_world;
    double at[3];
} iso_place;

typedef enum iso_note_kind {
    ISO_NOTE_TEXT,  /* with its middle at `to`, moved into the picture */
    ISO_NOTE_ARROW, /* its head is at `to`, its text at `from` */
    ISO_NOTE_RULER  /* between two places of the world, with ticks and its length */
} iso_note_kind;

typedef struct iso_note {
    iso_note_kind kind;
    iso_place from, to;
    bool has_from;    /* of an arrow: else it comes from beside its head */
    const char *text; /* of a TEXT; of an ARROW NULL: none; of a RULER not used */
} iso_note;

/* A line of a legend: a colour, and what has it. */
typedef struct iso_legend_entry {
    const char *name; /* characters that the font lacks are boxes */
    iso_rgb color;
} iso_legend_entry;

/* All arrays are borrowed during the call. */
typedef struct iso_figure_opts {
    iso_annotation_opts marks; /* scale bar, orientation marker, camera (not NULL) and background */
    double font_size;          /* size of the letters in points, 1/72 inch; 0: by the picture's size */
    double dpi;                /* pixels an inch; 0 means 72, a pixel is a point */
    const iso_note *notes;
    int note_count;
    const iso_legend_entry *legend; /* at the top left */
    int legend_count;
} iso_figure_opts;

/* Paints onto the picture. Notes at places behind the camera are left out. ISO_ERR_USAGE: there is no
 * picture or no camera; a text is empty, too long, has a character that the font lacks, or is written from
 * right to left; a ruler is between places of the picture. ISO_ERR_NOMEM. */
ISO_API iso_status iso_figure_paint(iso_image *image, const iso_figure_opts *opts, iso_error *error);

/* Writes the picture with what stands over it, to a file of the kind that the name's ending says: .svg and
 * .pdf with text as text and the picture embedded, on a sheet of its size at `dpi`; .png, .tif and .jpg
 * painted. The picture stays as it is. ISO_ERR_USAGE, as above and for another ending; ISO_ERR_WRITE,
 * ISO_ERR_BACKEND (a .jpg without libjpeg), ISO_ERR_NOMEM. */
ISO_API iso_status iso_figure_write(const iso_image *image, const iso_figure_opts *opts, const char *path,
                                    iso_error *error);

#ifdef __cplusplus
}
#endif
#endif
