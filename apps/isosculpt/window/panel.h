/* panel: all that is drawn over the picture: the panel, the help sheet, questions and the brush's ring. Dear
 * ImGui is behind it and nowhere else. One a program: Dear ImGui keeps its context in a global. */
#ifndef ISO_APPS_ISOSCULPT_WINDOW_PANEL_H
#define ISO_APPS_ISOSCULPT_WINDOW_PANEL_H

#include "apps/isosculpt/controller.h"
#include "apps/isosculpt/window/browser.h"

#ifdef __cplusplus
extern "C" {
#endif

/* What is asked, one thing at a time; meanwhile the sculpture is out of reach. */
typedef enum isosculpt_dialog {
    ISOSCULPT_DIALOG_NOTHING,
    ISOSCULPT_DIALOG_RECOVER, /* whether to recover the journal `path` */
    ISOSCULPT_DIALOG_CLOSE,   /* what to do about changes that are not saved */
    ISOSCULPT_DIALOG_OPEN,    /* the same, before `path` is opened */
    ISOSCULPT_DIALOG_MESH,    /* whether to open the mesh `path`, or to make it a stamp */
    ISOSCULPT_DIALOG_REPLACE  /* whether to write over the file `path` */
} isosculpt_dialog;

/* Answers of the person to what the panel shows, for the window. */
enum {
    ISOSCULPT_RESULT_RECOVER = 1,
    ISOSCULPT_RESULT_DISMISS = 2, /* do not offer it again */
    ISOSCULPT_RESULT_LEAVE = 4,   /* close, or open, as was asked */
    ISOSCULPT_RESULT_STAY = 8,
    ISOSCULPT_RESULT_SAVE = 16,
    ISOSCULPT_RESULT_OPEN = 32,    /* what `path` names */
    ISOSCULPT_RESULT_STAMP = 64,   /* the same, as a stamp */
    ISOSCULPT_RESULT_CANCEL = 128, /* busy[0], and its double busy[1] */
    ISOSCULPT_RESULT_REPLACE = 512,
    ISOSCULPT_RESULT_CHOSEN = 1024, /* `chosen`, for `chosen_for` */
    ISOSCULPT_RESULT_COMMAND = 2048 /* the command that draws this goes to the clipboard */
};

/* Heavy work that is under way. */
typedef struct isosculpt_progress_item {
    char text[160];
    double fraction;
} isosculpt_progress_item;
enum { ISOSCULPT_PROGRESS_ITEMS = 2 };

/* What the panel shows and changes; the window's. */
typedef struct isosculpt_screen {
    isosculpt_controller *controller;
    unsigned texture;  /* of the picture; 0: none yet */
    int width, height; /* framebuffer */
    double pixels;     /* framebuffer pixels a window coordinate */
    bool panel, help;  /* shown */
    bool pen;          /* one with pressure is there */
    bool blank;        /* there is nothing to work on yet */
    isosculpt_dialog dialog;
    char asked[ISOSCULPT_PATH]; /* the path that the question is about */
    isosculpt_progress_item progress_items[ISOSCULPT_PROGRESS_ITEMS];
    int progress_item_count;
    char path[ISOSCULPT_PATH]; /* that is typed in */
    isosculpt_browser browser;
    isosculpt_purpose browse; /* to be shown with the next frame */
    isosculpt_purpose chosen_for;
    char chosen[ISOSCULPT_PATH];
    const isosculpt_volume *volume; /* that is looked at; NULL: there is a field */
    bool sculpting;                 /* it is being made a field */
    double isovalue;                /* chosen for it */
    bool sliding;                   /* just now, by hand */
    char message[600];              /* of the last command; "" none. Good ones go by themselves, */
    double said;                    /* after so long since then (iso_clock_seconds) */
    bool message_is_bad;
    unsigned results;
} isosculpt_screen;

typedef struct isosculpt_panel isosculpt_panel;

/* For a GLFWwindow whose context is current; its callbacks are set already and are called by ours. `scale`:
 * of text and widgets. ISO_ERR_NOMEM, ISO_ERR_BACKEND. */
iso_status isosculpt_panel_create(void *window, double scale, isosculpt_panel **panel, iso_error *error);
/* Between frames. ISO_ERR_NOMEM, ISO_ERR_BACKEND. */
iso_status isosculpt_panel_rescale(isosculpt_panel *panel, double scale, iso_error *error);
void isosculpt_panel_destroy(isosculpt_panel *panel);

/* One frame into the current framebuffer. */
iso_status isosculpt_panel_draw(isosculpt_panel *panel, isosculpt_screen *screen, iso_error *error);

/* Whether the pointer at a window position, or the keys, belong to the panel. */
bool isosculpt_panel_has_pointer(const isosculpt_panel *panel, double x, double y);
bool isosculpt_panel_has_keys(void);

#ifdef __cplusplus
}
#endif
#endif
