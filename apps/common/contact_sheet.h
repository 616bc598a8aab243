/* contact_sheet: pictures of many inputs, one beside the other, with their names and a number each, as one
 * page of HTML or one picture. The caller draws the pictures; here are the processes in which it does so, the
 * pictures that are kept for the next run, and the sheet.
 *
 * Each picture is drawn by one of several child processes: an input that makes one end takes only its own
 * panel with it. A finished picture is a PNG with its numbers in OUT-panels, called by its key, a number that
 * is made of all that it depends on: the next run draws only what has none there, and removes what no panel
 * has any more. Inputs that fail become red panels with the message, and are tried again by the next run.
 * The sheet has the same bytes for any number of processes, and whether pictures were kept or not. */
#ifndef ISO_APPS_COMMON_CONTACT_SHEET_H
#define ISO_APPS_COMMON_CONTACT_SHEET_H

#include "apps/common/json.h"
#include "apps/common/options.h"
#include "scene/picture_grid.h"

enum { ISO_SHEET_VALUES = 8 };

/* A number that is said of every panel. */
typedef struct iso_sheet_value {
    const char *name, *unit; /* unit: "" for none */
} iso_sheet_value;

/* What has become of a panel. Lies in memory that the processes share. */
typedef struct iso_sheet_panel {
    uint64_t key;
    double values[ISO_SHEET_VALUES]; /* NaN: not known */
    iso_error error;                 /* its status: ISO_OK, the picture is in the folder */
    bool begun, done, kept;          /* kept: not drawn by this run */
} iso_sheet_panel;

/* The caller sets the members up to context, all borrowed, and zeroes the others. */
typedef struct iso_contact_sheet {
    const iso_program *program;
    const char *output;        /* a .html, or a picture by iso_image_file_write_drawing */
    const char *const *inputs; /* `count` of them; a panel is called by what they do not have in common */
    const char *const *beside; /* what each is drawn or compared with, for JSON; or NULL */
    int count, jobs;           /* jobs: processes, at least 1 */
    iso_sheet_value values[ISO_SHEET_VALUES];
    int value_count, shown; /* shown: the value that stands at each panel; -1: none */
    bool table;             /* of all values, in the page */
    const char *note;       /* a sentence of the page about what is seen; or NULL */
    iso_picture_grid grid;  /* its panel, font, columns, background and transparent */
    bool json, quiet;
    const char *json_path; /* NULL: standard output */
    uint64_t max_memory;   /* bytes: iso_memory_limit */
    /* In a child process, in this order: the key of a panel, and, if there is no picture of that key, its
     * picture and values. A picture is the caller's, to be freed: iso_image_free. */
    iso_status (*find_key)(void *context, int panel, uint64_t *key, iso_error *error);
    iso_status (*draw)(void *context, int panel, iso_image *image, double *values, iso_error *error);
    void *context;

    iso_sheet_panel *panels; /* shared */
    char **names, *folder;
    int *next;      /* shared: the next panel that nobody draws yet */
    int said;       /* panels of which a line has been written */
    iso_sink lines; /* of JSON */
} iso_contact_sheet;

/* Draws all panels and writes the sheet. Says what failed, a line for each; with `json` writes a line of JSON
 * for each panel, in the order of the inputs, as soon as it and all before it are done. *code: the exit
 * status of the first input that failed, or 0. ISO_ERR_USAGE: the output's name is none of a sheet;
 * ISO_ERR_WRITE, ISO_ERR_LIMIT, ISO_ERR_NOMEM: there is no sheet, but the pictures are kept. */
iso_status iso_sheet_make(iso_contact_sheet *sheet, int *code, iso_error *error);

/* Chooses how many processes draw, if `jobs` is 0, and how many threads each has, if *threads is 0. */
iso_status iso_sheet_share_machine(iso_contact_sheet *sheet, int *threads, iso_error *error);

/* Memory of `bytes` zeros that child processes share; NULL: there is none. Never freed by them; the caller's:
 * iso_sheet_unshare. */
void *iso_sheet_share(size_t bytes);
void iso_sheet_unshare(void *memory, size_t bytes);

/* Calls work(context, descriptor) in each of `count` child processes, and waits until all have ended. `wake`
 * is called in this process whenever a child has written a byte to the descriptor; NULL: never.
 * ISO_ERR_NOMEM: no process could be made. */
typedef void iso_sheet_work(void *context, int descriptor);
iso_status iso_sheet_fork(int count, iso_sheet_work *work, void (*wake)(void *context), void *context,
                          iso_error *error);

#endif
