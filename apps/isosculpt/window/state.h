/* state: the state of isosculpt's window, and what all its parts need. The parts include each other only
 * downwards:
 *
 *     window.c (the loop) -> events.c -> commands.c -> opening.c, saving.c, picture.c -> reference.c ->
 * state.c
 */
#ifndef ISO_APPS_ISOSCULPT_WINDOW_STATE_H
#define ISO_APPS_ISOSCULPT_WINDOW_STATE_H

#include "apps/isosculpt/isosculpt.h"
#include "apps/isosculpt/load_job.h"
#include "apps/isosculpt/opened_scene.h"
#include "apps/isosculpt/reference_job.h"
#include "apps/isosculpt/save.h"
#include "apps/isosculpt/window/panel.h"
#include "apps/isosculpt/window/pen.h"

/* Frames that are drawn after an event, because Dear ImGui shows some effects one frame later. */
enum { ISOSCULPT_FRAMES_AFTER_EVENT = 3 };
/* Seconds between two checks of the journal while nothing happens. */
static const double ISOSCULPT_IDLE_SECONDS = 0.25;

typedef struct window {
    struct GLFWwindow *glfw;
    const isosculpt_settings *settings;
    iso_pool *pool;     /* the program's pool, or own_pool */
    iso_pool *own_pool; /* pool of the file that was opened; NULL: none */
    bool has_folder;
    char folder[ISOSCULPT_PATH]; /* folder of journals, if has_folder */

    iso_source_volume *volume; /* viewed, not yet converted into a field; NULL: the document has a field */
    isosculpt_document document;
    isosculpt_viewport viewport;
    isosculpt_controller controller;
    double voxel; /* voxel size of the field or volume, mm; 0: nothing yet */
    isosculpt_screen screen;
    isosculpt_panel *panel;
    isosculpt_pen *pen;

    iso_gl_context
        *context;     /* the window's context, for the gl engine; NULL: its OpenGL version is too old */
    isosculpt_gl *gl; /* or NULL */
    isosculpt_engine engine; /* as chosen */
    unsigned texture;        /* of the cpu engine's picture; 0: none yet */
    int texture_width, texture_height;
    char title[ISOSCULPT_PATH + 32]; /* of the window */
    int frames_left;                 /* number of frames to be drawn before the loop waits for events */
    double last_change;              /* iso_clock_seconds when the picture last had to be drawn */

    isosculpt_load_job *load_job;           /* a file is being opened; or NULL */
    isosculpt_opened_scene scene;           /* that it is the input of, and to be shown as; zero: of none */
    char next_path[ISOSCULPT_PATH];         /* path to be opened if the user agrees to lose unsaved changes */
    isosculpt_new next;                     /* what to begin with then instead; solid.size.x = 0: next_path */
    size_t agreed_changes;                  /* document.change_count that the user agreed to lose */
    isosculpt_backdrop backdrop;            /* the reference picture */
    char kept_backdrop[2 * ISOSCULPT_PATH]; /* what was written of it beside the strokes */
    bool backdrop_asked;                    /* that of --reference was shown, or tried */
    isosculpt_reference_job *reference_job; /* the reference is being made; or NULL */
    bool reference_labels;                  /* it is, or that of the viewport is, of the other labels */
    bool resampling;                        /* load_job plays the strokes in other voxels */
    bool sculpting;                         /* load_job converts the viewed volume into a field */
    isosculpt_freezing freezing;            /* of what was opened, by --freeze */
    bool sculpting_to_save;                 /* it does so because a save was requested */
    bool stamp_loaded;                      /* the mesh of --stamp was opened, or tried */

    isosculpt_purpose pending_save; /* purpose ISOSCULPT_BROWSE_SAVE or _EXPORT: save to save_path as soon as
                                       no stroke is drawn; else ISOSCULPT_BROWSE_NOTHING */
    char save_path[ISOSCULPT_PATH];
    bool replace_agreed;         /* the user agreed to overwrite save_path */
    isosculpt_dialog after_save; /* ISOSCULPT_DIALOG_CLOSE or _OPEN: what follows if the save succeeds */

    bool screenshot, screenshot_window;   /* save the picture, or the whole window, when it is drawn */
    char screenshot_path[ISOSCULPT_PATH]; /* of the next screenshot; "": an unused name beside the target */
} window;

/* Shows a message until there is another one, errors also on standard error. */
void isosculpt_window_set_status(window *w, bool is_error, const char *text);

/* Reads the size of the framebuffer from the window system, and places the picture beside the panel. */
void isosculpt_window_update_framebuffer_size(window *w);

/* Shows the name of the file that the window works on in its title, with * after unsaved changes. */
void isosculpt_window_update_title(window *w);

/* Keeps the look of picture and brush with the journal, for recovery. */
void isosculpt_window_remember_look(window *w);

/* The scale of text and widgets on the screen that the window is on. */
double isosculpt_window_text_scale(const window *w);

/* Passes the current pointer position to the input controller after the viewport has changed without a mouse
 * event. Not for use in event callbacks: queued events carry older positions. */
void isosculpt_window_sync_pointer(window *w);

bool isosculpt_window_has_unsaved_changes(const window *w);

/* Shows a dialog about `path`. */
void isosculpt_window_show_dialog(window *w, isosculpt_dialog dialog, const char *path);

/* Wakes the loop up. For background threads, as the `wake` of isosculpt_task_start. */
void isosculpt_window_wake(void);

#endif
