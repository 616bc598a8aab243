/* window: what the parts of isosculpt's window share. Nothing else includes it. */
#ifndef ISO_APPS_ISOSCULPT_WINDOW_WINDOW_H
#define ISO_APPS_ISOSCULPT_WINDOW_WINDOW_H

#include "apps/isosculpt/isosculpt.h"
#include "apps/isosculpt/load_job.h"
#include "apps/isosculpt/save.h"
#include "apps/isosculpt/window/panel.h"
#include "apps/isosculpt/window/pen.h"

/* Frames after an event: Dear ImGui shows some answers only in the next. */
enum { ISOSCULPT_FRAMES = 3 };
/* Seconds between looks at the journal. */
static const double ISOSCULPT_IDLE = 0.25;

typedef struct window {
    struct GLFWwindow *glfw;
    const isosculpt_settings *settings;
    iso_pool *pool;     /* the program's, or own_pool */
    iso_pool *own_pool; /* of what was opened; NULL: none */
    isosculpt_load_job *load_job;
    isosculpt_volume *volume; /* that is looked at; NULL: the desk has a field */
    isosculpt_document document;
    isosculpt_view view;
    isosculpt_controller controller;
    double voxel; /* of what the hand works on, mm; 0: nothing yet */
    isosculpt_screen screen;
    isosculpt_panel *panel;
    isosculpt_pen *pen;
    iso_gl_context *context; /* the window's, for the gl engine; NULL: OpenGL is older than that needs */
    isosculpt_gl *gl;        /* or NULL */
    isosculpt_engine engine; /* as chosen */
    unsigned texture;        /* of the cpu engine's picture; 0: none yet */
    char folder[ISOSCULPT_PATH];
    char next[ISOSCULPT_PATH]; /* to be opened once the question about it is answered */
    size_t agreed; /* changes of the desk whose loss from sight was agreed to when `opening` began */
    bool has_folder;
    int texture_width, texture_height;
    int frames;               /* still to be drawn */
    double changed;           /* when the picture last had to be drawn */
    bool sculpting;           /* the volume is being made a field */
    bool stamp_asked;         /* --stamp was seen to */
    isosculpt_purpose saving; /* SAVE or EXPORT to save_path as soon as no stroke is drawn; NOTHING */
    char save_path[ISOSCULPT_PATH];
    bool replace;             /* it was agreed to that this file is written over */
    isosculpt_dialog leaving; /* ..CLOSE or ..OPEN: what comes after a save, which must succeed */
    bool screenshot, screenshot_all;
    char shot_path[ISOSCULPT_PATH]; /* of the next picture; "": a free name beside the target */
} window;

/* ---- window.c */

/* On screen, until something else is said. */
void isosculpt_window_set_status(window *w, bool bad, const char *text);
void isosculpt_window_update_framebuffer_size(window *w);
/* Of text and widgets, where the window is now. */
double isosculpt_window_text_scale(const window *w);
/* Where the pointer is, for a hand that has not seen it move. (Not for events: they may be of before.) */
void isosculpt_window_sync_pointer(window *w);

/* ---- mouse, keys and drops (events.c) */

void isosculpt_window_install_callbacks(window *w);

/* ---- the sculpture and its files (files.c) */

/* What the window begins with. */
iso_status isosculpt_window_open(window *w, iso_error *error);
/* A file that was dropped: asks what to do with it, or begins to open it. */
void isosculpt_window_drop(window *w, const char *path);
/* To the question that is asked, which then is not asked any more. */
void isosculpt_window_handle_dialog_result(window *w, unsigned results);
/* Does what hand and panel ask for. Errors end the program. */
iso_status isosculpt_window_process_commands(window *w, iso_error *error);
/* Asks on the screen; `path` is what the question is about. */
void isosculpt_window_ask(window *w, isosculpt_dialog dialog, const char *path);
/* What was asked about closing or opening, now that it is settled. */
void isosculpt_window_leave(window *w, isosculpt_dialog dialog);
/* Begins to open a file in place of what is there, or as a stamp; asks first about unsaved changes. */
void isosculpt_window_open_file(window *w, const char *path, bool stamp);
/* What is under way, for the panel. */
void isosculpt_window_show_progress(window *w);
/* The window closes over what is being opened. */
void isosculpt_window_cancel_load(window *w);

/* ---- saving (save.c) */

/* Whether there are changes that are not saved. */
bool isosculpt_window_has_unsaved_changes(const window *w);
/* To save or export; path NULL: the desk's target. Done by isosculpt_window_go_on_saving. */
void isosculpt_window_save(window *w, isosculpt_purpose purpose, const char *path);
/* Begins the save that was asked for when that can be; asks before a file is written over. */
void isosculpt_window_go_on_saving(window *w);
/* The answer to that. */
void isosculpt_window_replace(window *w, bool agreed);
/* What the browser chose. */
void isosculpt_window_take_choice(window *w);
/* Sees whether a save is done. */
void isosculpt_window_poll_save(window *w);
/* Puts the isorender command that draws this onto the clipboard. */
void isosculpt_window_copy_command(window *w);

/* ---- the picture (picture.c) */

/* The picture that is due, and the panel over it. Errors end the program. */
iso_status isosculpt_window_draw(window *w, iso_error *error);
/* Seconds until a better picture is due; < 0: it is. */
double isosculpt_window_seconds_until_refine(const window *w);

#endif
