/* browser: a folder's files, for a person to choose one to open or a name to save to. The state is plain C;
 * Dear ImGui draws it (isosculpt_browser_draw). */
#ifndef ISO_APPS_ISOSCULPT_WINDOW_BROWSER_H
#define ISO_APPS_ISOSCULPT_WINDOW_BROWSER_H

#include <stdbool.h>
#include <stddef.h>

#include "apps/isosculpt/document.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef enum isosculpt_purpose {
    ISOSCULPT_BROWSE_NOTHING, /* it is not shown */
    ISOSCULPT_BROWSE_OPEN,
    ISOSCULPT_BROWSE_STAMP,
    ISOSCULPT_BROWSE_SAVE,
    ISOSCULPT_BROWSE_EXPORT,
    ISOSCULPT_BROWSE_PICTURE
} isosculpt_purpose;

typedef struct isosculpt_entry {
    char *name; /* owned */
    bool is_folder;
} isosculpt_entry;

/* Keys that were pressed since the last frame. The window notes them: Dear ImGui 1.86 does not see a key that
 * was released again before a frame begins. */
typedef struct isosculpt_typed {
    bool enter, escape, back;
    int steps; /* through a list, downwards */
} isosculpt_typed;

/* Zero-initialise. */
typedef struct isosculpt_browser {
    isosculpt_purpose purpose;
    char folder[ISOSCULPT_PATH];
    isosculpt_entry *entries; /* of the folder that the type shows: folders first, by name. Owned */
    size_t count, room;
    char name[ISOSCULPT_PATH]; /* in the box: of a file in the folder, or a path */
    int type;                  /* of the purpose's types */
    int selected;              /* an entry; -1: none */
    bool hidden;               /* files whose name begins with a dot are shown */
    int generation;            /* grows when `name` was changed other than by typing */
    isosculpt_typed typed;
    char trouble[256]; /* why something did not work; "" */
} isosculpt_browser;

/* Kinds of files that a purpose knows: a label and extensions separated by blanks ("": all). NULL label:
 * there are no more. */
typedef struct isosculpt_file_type {
    const char *label, *extensions;
} isosculpt_file_type;
const isosculpt_file_type *isosculpt_browser_types(isosculpt_purpose purpose);
bool isosculpt_browser_saves(isosculpt_purpose purpose); /* a name that need not be there */

/* Shows the folder of `path`, with its last part as the name when a name is to be chosen. */
void isosculpt_browser_open(isosculpt_browser *browser, isosculpt_purpose purpose, const char *path);
void isosculpt_browser_close(isosculpt_browser *browser); /* frees the entries; what was `hidden` stays */

/* Another folder; the one before stays when it cannot be read, and `trouble` says why. */
void isosculpt_browser_enter(isosculpt_browser *browser, const char *folder);
void isosculpt_browser_up(isosculpt_browser *browser);
/* Another of the purpose's types. A name to save gets its extension. */
void isosculpt_browser_set_type(isosculpt_browser *browser, int type);
/* The same folder as it is now, with what `hidden` says. */
void isosculpt_browser_reread(isosculpt_browser *browser);
/* Another entry, by `steps` from the selected one; its name goes into the box. */
void isosculpt_browser_step(isosculpt_browser *browser, int steps);
void isosculpt_browser_select(isosculpt_browser *browser, int entry);

/* The whole path that the box names; a name to save without extension gets the type's first. false: the box
 * is empty, or the path is too long. */
bool isosculpt_browser_path(const isosculpt_browser *browser, char path[ISOSCULPT_PATH]);
/* Takes what the box names: a folder is entered (false), a file is the choice. false with `trouble`: it is
 * not there. */
bool isosculpt_browser_choose(isosculpt_browser *browser, char path[ISOSCULPT_PATH]);

/* One frame, which uses up `typed`; `scale`: of text and widgets. True: `path` was chosen, and the browser is
 * closed. */
bool isosculpt_browser_draw(isosculpt_browser *browser, float scale, char path[ISOSCULPT_PATH]);

#ifdef __cplusplus
}
#endif
#endif
