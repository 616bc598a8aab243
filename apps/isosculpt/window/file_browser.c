/* The state of the file browser: entries of a folder, file types, the chosen path. */
#include "apps/isosculpt/window/file_browser.h"

#include <dirent.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>
#include <unistd.h>

#include "io/file_contents.h"

/* ---- file types */

/* Every name that grids/volume knows (a test compares), except .vdb, which has a row of its own, and others
 * of HDF5. */
const isosculpt_file_type *isosculpt_browser_types(isosculpt_purpose purpose) {
    static const isosculpt_file_type
        open[] = {{.label = "all that can be opened", .holds = ISO_HOLDS_STROKES | ISO_HOLDS_DATA},
                  {.label = "strokes", .holds = ISO_HOLDS_STROKES},
                  {.label = "level sets", .holds = ISO_WRITES_VOLUME},
                  {.label = "meshes", .holds = ISO_HOLDS_MESH},
                  {.label = "lines", .holds = ISO_HOLDS_LINES},
                  {.label = "points", .holds = ISO_HOLDS_POINTS},
                  {.label = "volumes", .holds = ISO_HOLDS_VOLUME | ISO_HOLDS_RAW},
                  {.label = "scenes", .holds = ISO_HOLDS_SCENE},
                  {.label = "all files"},
                  {.label = NULL}},
        stamp[] = {{.label = "meshes", .holds = ISO_HOLDS_MESH}, {.label = "all files"}, {.label = NULL}},
        colors[] = {{.label = "volumes", .holds = ISO_HOLDS_VOLUME}, {.label = "all files"}, {.label = NULL}},
        distances[] = {{.label = "volumes and meshes", .holds = ISO_HOLDS_VOLUME | ISO_HOLDS_MESH},
                       {.label = "all files"},
                       {.label = NULL}},
        save[] = {{.label = "level set", .type = ISO_FILE_vdb},
                  {.label = "mesh", .type = ISO_FILE_stl},
                  {.label = "mesh", .type = ISO_FILE_ply},
                  {.label = "mesh", .type = ISO_FILE_obj},
                  {.label = NULL}},
        export[] = {{.label = "mesh", .type = ISO_FILE_stl},
                    {.label = "mesh", .type = ISO_FILE_ply},
                    {.label = "mesh", .type = ISO_FILE_obj},
                    {.label = "level set", .type = ISO_FILE_vdb},
                    {.label = NULL}},
        picture[] = {{.label = "picture", .type = ISO_FILE_png},
                     {.label = "scene", .type = ISO_FILE_json},
                     {.label = NULL}};
    static const isosculpt_file_type *const all[] = {NULL,      open, stamp,  colors,
                                                     distances, save, export, picture};
    _Static_assert(sizeof all / sizeof *all == ISOSCULPT_PURPOSES, "types for each purpose");
    return all[purpose];
}

void isosculpt_browser_label(const isosculpt_browser *browser, int type, char label[ISOSCULPT_LABEL]) {
    const isosculpt_file_type *t = &isosculpt_browser_types(browser->purpose)[type];
    char extensions[ISOSCULPT_LABEL - 48] = "";
    if (isosculpt_browser_saves(browser->purpose))
        iso_file_type_extension(t->type, extensions);
    else if (type > 0 && t->holds) /* (the first names none: it shows all of them) */
        iso_file_type_extensions(t->holds, 0, NULL, extensions, sizeof extensions);
    snprintf(label, ISOSCULPT_LABEL, *extensions ? "%s (%s)" : "%s", t->label, extensions);
}

bool isosculpt_browser_saves(isosculpt_purpose purpose) {
    return purpose >= ISOSCULPT_BROWSE_SAVE;
}

/* Whether a file of this name is of a type. Most files in .txt are no points: they are among all files. */
static bool is_of_type(const isosculpt_browser *browser, const char *name, int type) {
    const isosculpt_file_type *t = &isosculpt_browser_types(browser->purpose)[type];
    if (isosculpt_browser_saves(browser->purpose)) return iso_file_type_of_name(name, ~0u) == t->type;
    const iso_file_type found = iso_file_type_of_name(name, t->holds);
    return !t->holds || (found != ISO_FILE_UNKNOWN && found != ISO_FILE_txt);
}

/* ---- a folder's entries */

static void free_entries(isosculpt_browser *browser) {
    for (size_t i = 0; i < browser->count; i++) free(browser->entries[i].name);
    free(browser->entries);
    browser->entries = NULL;
    browser->count = browser->room = 0;
    browser->selected = -1;
}

static bool add_entry(isosculpt_browser *browser, const char *name, bool is_folder) {
    if (browser->count == browser->room) {
        const size_t room = browser->room ? 2 * browser->room : 64;
        isosculpt_entry *larger = realloc(browser->entries, room * sizeof *larger);
        if (!larger) return false;
        browser->entries = larger;
        browser->room = room;
    }
    char *copy = strdup(name);
    if (copy) browser->entries[browser->count++] = (isosculpt_entry){copy, is_folder};
    return copy;
}

static int compare(const void *a, const void *b) {
    const isosculpt_entry *first = a, *second = b;
    if (first->is_folder != second->is_folder) return second->is_folder - first->is_folder;
    const int order = strcasecmp(first->name, second->name);
    return order ? order : strcmp(first->name, second->name);
}

/* Returns whether an entry is shown: folders and files of the chosen type, but no devices, and no paths that
 * are too long. */
static bool is_shown(const isosculpt_browser *browser, const char *name, bool *is_folder) {
    char path[2 * ISOSCULPT_PATH];
    struct stat about;
    if (strcmp(name, ".") == 0 || strcmp(name, "..") == 0) return false;
    if (name[0] == '.' && !browser->show_hidden) return false;
    const int length = snprintf(path, sizeof path, "%s/%s", browser->folder, name);
    if (length >= ISOSCULPT_PATH || stat(path, &about)) return false;
    *is_folder = S_ISDIR(about.st_mode);
    return *is_folder || (S_ISREG(about.st_mode) && is_of_type(browser, name, browser->type));
}

void isosculpt_browser_reread(isosculpt_browser *browser) {
    free_entries(browser);
    browser->error_text[0] = 0;
    DIR *directory = opendir(browser->folder);
    if (!directory) {
        snprintf(browser->error_text, sizeof browser->error_text, "%s", strerror(errno));
        return;
    }
    bool is_folder, room = true;
    for (struct dirent *entry; room && (entry = readdir(directory));)
        if (is_shown(browser, entry->d_name, &is_folder)) room = add_entry(browser, entry->d_name, is_folder);
    closedir(directory);
    if (browser->count) qsort(browser->entries, browser->count, sizeof *browser->entries, compare);
    if (!room)
        snprintf(browser->error_text, sizeof browser->error_text, "out of memory: not all files are shown");
}

/* ---- changing folders */

bool isosculpt_browser_is_folder(const char *path) {
    struct stat about;
    return stat(path, &about) == 0 && S_ISDIR(about.st_mode);
}

void isosculpt_browser_enter(isosculpt_browser *browser, const char *folder) {
    char *absolute = realpath(folder, NULL);
    DIR *readable = absolute ? opendir(absolute) : NULL;
    if (!readable || strlen(absolute) >= ISOSCULPT_PATH) {
        snprintf(browser->error_text, sizeof browser->error_text, "%.150s: %s", folder,
                 readable ? "the name is too long" : strerror(errno));
    } else {
        memcpy(browser->folder, absolute, strlen(absolute) + 1);
        isosculpt_browser_reread(browser);
    }
    if (readable) closedir(readable);
    free(absolute);
}

void isosculpt_browser_up(isosculpt_browser *browser) {
    char parent[ISOSCULPT_PATH + 4];
    snprintf(parent, sizeof parent, "%s/..", browser->folder);
    isosculpt_browser_enter(browser, parent);
}

static void set_name(isosculpt_browser *browser, const char *name) {
    snprintf(browser->name, sizeof browser->name, "%s", name);
    browser->generation++;
}

void isosculpt_browser_set_type(isosculpt_browser *browser, int type) {
    char *dot = strrchr(browser->name, '.');
    const size_t stem = dot && dot > browser->name ? (size_t)(dot - browser->name) : 0;
    if (isosculpt_browser_saves(browser->purpose) && stem &&
        stem + ISO_FILE_EXTENSION <= sizeof browser->name) {
        iso_file_type_extension(isosculpt_browser_types(browser->purpose)[type].type, dot);
        browser->generation++;
    }
    browser->type = type;
    isosculpt_browser_reread(browser);
}

/* Returns the file type for the extension of a name to save to; the chosen one when it is of no type. */
static int find_type(const isosculpt_browser *browser, const char *name) {
    const isosculpt_file_type *types = isosculpt_browser_types(browser->purpose);
    for (int i = 0; isosculpt_browser_saves(browser->purpose) && types[i].label; i++)
        if (is_of_type(browser, name, i)) return i;
    return browser->type;
}

void isosculpt_browser_follow_name(isosculpt_browser *browser) {
    const int type = find_type(browser, browser->name);
    if (type == browser->type) return;
    browser->type = type;
    isosculpt_browser_reread(browser);
}

void isosculpt_browser_open(isosculpt_browser *browser, isosculpt_purpose purpose, const char *path) {
    char folder[ISOSCULPT_PATH];
    const char *slash = strrchr(path, '/');
    const char *name = slash ? slash + 1 : path;
    browser->purpose = purpose;
    browser->type = 0;
    browser->type = find_type(browser, name);
    set_name(browser, isosculpt_browser_saves(purpose) ? name : "");
    snprintf(folder, sizeof folder, "%.*s", slash ? (int)(slash - path) + 1 : 1, slash ? path : ".");
    isosculpt_browser_enter(browser, folder);
    if (!browser->folder[0] || browser->error_text[0]) isosculpt_browser_enter(browser, "/");
}

void isosculpt_browser_close(isosculpt_browser *browser) {
    free_entries(browser);
    browser->purpose = ISOSCULPT_BROWSE_NOTHING;
    browser->folder[0] = browser->error_text[0] = 0;
}

void isosculpt_browser_select(isosculpt_browser *browser, int entry) {
    browser->selected = entry;
    browser->error_text[0] = 0;
    set_name(browser, browser->entries[entry].name);
}

void isosculpt_browser_step(isosculpt_browser *browser, int steps) {
    const int last = (int)browser->count - 1;
    if (last < 0) return;
    int next = browser->selected < 0 ? (steps > 0 ? steps - 1 : last) : browser->selected + steps;
    isosculpt_browser_select(browser, next < 0 ? 0 : next > last ? last : next);
}

/* ---- choosing */

static void add_extension(const isosculpt_browser *browser, char path[ISOSCULPT_PATH]) {
    const char *slash = strrchr(path, '/'), *name = slash ? slash + 1 : path;
    const size_t length = strlen(path);
    if (!name[0] || strchr(name + 1, '.') || length + ISO_FILE_EXTENSION > ISOSCULPT_PATH) return;
    iso_file_type_extension(isosculpt_browser_types(browser->purpose)[browser->type].type, path + length);
}

bool isosculpt_browser_path(const isosculpt_browser *browser, char path[ISOSCULPT_PATH]) {
    const char *name = browser->name, *home = getenv("HOME"),
               *separator = strcmp(browser->folder, "/") == 0 ? "" : "/";
    int length;
    if (!name[0]) return false;
    if (name[0] == '/')
        length = snprintf(path, ISOSCULPT_PATH, "%s", name);
    else if (name[0] == '~' && (name[1] == '/' || !name[1]) && home)
        length = snprintf(path, ISOSCULPT_PATH, "%s%s", home, name + 1);
    else
        length = snprintf(path, ISOSCULPT_PATH, "%s%s%s", browser->folder, separator, name);
    if (length >= ISOSCULPT_PATH) return false;
    if (isosculpt_browser_saves(browser->purpose) && !isosculpt_browser_is_folder(path))
        add_extension(browser, path);
    return true;
}

bool isosculpt_browser_choose(isosculpt_browser *browser, char path[ISOSCULPT_PATH]) {
    struct stat about;
    browser->error_text[0] = 0;
    if (!isosculpt_browser_path(browser, path)) return false;
    const bool is_there = stat(path, &about) == 0;
    if (is_there && S_ISDIR(about.st_mode)) {
        isosculpt_browser_enter(browser, path);
        if (!browser->error_text[0]) set_name(browser, "");
        return false;
    }
    if (is_there || isosculpt_browser_saves(browser->purpose)) return true;
    snprintf(browser->error_text, sizeof browser->error_text, "There is no such file.");
    return false;
}
