/* file_browser: a dialog that shows the files of a folder, to choose a file to open or a name to save to. The
 * state is plain C (file_browser.c); file_browser.cc draws it with Dear ImGui. */
#ifndef ISO_APPS_ISOSCULPT_WINDOW_FILE_BROWSER_H
#define ISO_APPS_ISOSCULPT_WINDOW_FILE_BROWSER_H

#include <stdbool.h>
#include <stddef.h>

#include "apps/isosculpt/document.h"
#include "base/c_linkage.h"
#include "base/file_types.h"

ISO_C_BEGIN

typedef enum isosculpt_purpose {
    ISOSCULPT_BROWSE_NOTHING, /* the dialog is closed */
    ISOSCULPT_BROWSE_OPEN,
    ISOSCULPT_BROWSE_STAMP,
    ISOSCULPT_BROWSE_COLORS,    /* a volume that surfaces are coloured by */
    ISOSCULPT_BROWSE_DISTANCES, /* a volume or a mesh from which they are coloured by their distance */
    ISOSCULPT_BROWSE_SAVE,
    ISOSCULPT_BROWSE_EXPORT,
    ISOSCULPT_BROWSE_PICTURE,
    ISOSCULPT_PURPOSES /* how many there are */
} isosculpt_purpose;

typedef struct isosculpt_entry {
    char *name; /* owned */
    bool is_folder;
} isosculpt_entry;

/* Keys that were pressed since the last frame. The window records them: Dear ImGui 1.86 misses a key that is
 * released before a frame begins. */
typedef struct isosculpt_typed {
    bool enter, escape, back;
    int steps; /* through the list, downwards */
} isosculpt_typed;

/* Zero-initialise; isosculpt_browser_close. */
typedef struct isosculpt_browser {
    isosculpt_purpose purpose;
    char folder[ISOSCULPT_PATH];
    isosculpt_entry *entries; /* of the folder, filtered by type; folders first, by name. Owned */
    size_t count, room;
    char name[ISOSCULPT_PATH]; /* in the input box: a file in the folder, or a path */
    int type;                  /* index in isosculpt_browser_types */
    int selected;              /* index of an entry; -1: none */
    bool show_hidden;          /* files whose name begins with a dot */
    int generation;            /* grows when `name` is changed other than by typing */
    isosculpt_typed typed;
    char error_text[256]; /* why the last action failed; "": it did not */
} isosculpt_browser;

/* The file types of a purpose; the list ends with a NULL label. To open: the types that hold something of
 * `holds` (0: all files); to save: `type`. */
typedef struct isosculpt_file_type {
    const char *label;
    unsigned holds;
    iso_file_type type;
} isosculpt_file_type;
const isosculpt_file_type *isosculpt_browser_types(isosculpt_purpose purpose);
/* The label with the extensions, as it is shown. */
enum { ISOSCULPT_LABEL = 256 };
void isosculpt_browser_label(const isosculpt_browser *browser, int type, char label[ISOSCULPT_LABEL]);
bool isosculpt_browser_saves(isosculpt_purpose purpose); /* whether the chosen file need not exist */

/* Shows the folder of `path`; when a name to save to is chosen, the last part of the path is the name
 * offered. */
void isosculpt_browser_open(isosculpt_browser *browser, isosculpt_purpose purpose, const char *path);
void isosculpt_browser_close(isosculpt_browser *browser); /* frees the entries; keeps `show_hidden` */

bool isosculpt_browser_is_folder(const char *path);

/* Changes to another folder; when it cannot be read the folder stays, and `error_text` says why. */
void isosculpt_browser_enter(isosculpt_browser *browser, const char *folder);
void isosculpt_browser_up(isosculpt_browser *browser); /* to the parent folder */
/* Chooses another file type. A name to save to gets its extension. */
void isosculpt_browser_set_type(isosculpt_browser *browser, int type);
/* After `name` was typed: an extension in a name to save to chooses the file type. */
void isosculpt_browser_follow_name(isosculpt_browser *browser);
/* Reads the folder again. */
void isosculpt_browser_reread(isosculpt_browser *browser);
/* Selects the entry `steps` below the selected one; its name goes into the input box. */
void isosculpt_browser_step(isosculpt_browser *browser, int steps);
void isosculpt_browser_select(isosculpt_browser *browser, int entry);

/* The full path that the input box names; a name to save to without extension gets the type's first one.
 * false: the box is empty, or the path is too long. */
bool isosculpt_browser_path(const isosculpt_browser *browser, char path[ISOSCULPT_PATH]);
/* Confirms the input box: true: `path` is chosen. false: it is a folder, which is entered; or it does not
 * exist, and `error_text` says so. */
bool isosculpt_browser_choose(isosculpt_browser *browser, char path[ISOSCULPT_PATH]);

/* Draws one frame and handles `typed`. `scale`: of text and widgets. true: `path` was chosen, and the browser
 * is closed. */
bool isosculpt_browser_draw(isosculpt_browser *browser, float scale, char path[ISOSCULPT_PATH]);

ISO_C_END
#endif
