/* panel: all that is drawn over the picture: the panel, the help sheet, questions and the brush's ring. Dear
 * ImGui is behind it and nowhere else. One a program: Dear ImGui keeps its context in a global. */
#ifndef ISO_APPS_ISOSCULPT_PANEL_H
#define ISO_APPS_ISOSCULPT_PANEL_H

#include "apps/isosculpt/hand.h"
#include "apps/isosculpt/window/browser.h"

#ifdef __cplusplus
extern "C" {
#endif

/* What is asked, one thing at a time; meanwhile the sculpture is out of reach. */
typedef enum isosculpt_question {
    ISOSCULPT_ASK_NOTHING,
    ISOSCULPT_ASK_RECOVER, /* whether to recover the journal `path` */
    ISOSCULPT_ASK_CLOSE,   /* what to do about changes that are not saved */
    ISOSCULPT_ASK_OPEN,    /* the same, before `path` is opened */
    ISOSCULPT_ASK_MESH,    /* whether to open the mesh `path`, or to make it a stamp */
    ISOSCULPT_ASK_REPLACE  /* whether to write over the file `path` */
} isosculpt_question;

/* Answers of the person to what the panel shows, for the window. */
enum {
    ISOSCULPT_ANSWER_RECOVER = 1,
    ISOSCULPT_ANSWER_DISMISS = 2, /* do not offer it again */
    ISOSCULPT_ANSWER_LEAVE = 4,   /* close, or open, as was asked */
    ISOSCULPT_ANSWER_STAY = 8,
    ISOSCULPT_ANSWER_SAVE = 16,
    ISOSCULPT_ANSWER_OPEN = 32,    /* what `path` names */
    ISOSCULPT_ANSWER_STAMP = 64,   /* the same, as a stamp */
    ISOSCULPT_ANSWER_CANCEL = 128, /* busy[0], and its double busy[1] */
    ISOSCULPT_ANSWER_REPLACE = 512,
    ISOSCULPT_ANSWER_CHOSEN = 1024, /* `chosen`, for `chosen_for` */
    ISOSCULPT_ANSWER_COMMAND = 2048 /* the command that draws this goes to the clipboard */
};

/* Heavy work that is under way. */
typedef struct isosculpt_busy {
    char text[160];
    double fraction;
} isosculpt_busy;
enum { ISOSCULPT_BUSY = 2 };

/* What the panel shows and changes; the window's. */
typedef struct isosculpt_screen {
    isosculpt_hand *hand;
    unsigned texture;  /* of the picture; 0: none yet */
    int width, height; /* framebuffer */
    double pixels;     /* framebuffer pixels a window coordinate */
    bool panel, help;  /* shown */
    bool pen;          /* one with pressure is there */
    bool blank;        /* there is nothing to work on yet */
    isosculpt_question question;
    char asked[ISOSCULPT_PATH]; /* the path that the question is about */
    isosculpt_busy busy[ISOSCULPT_BUSY];
    int busy_count;
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
    double said;                    /* after so long since then (isosculpt_now) */
    bool message_is_bad;
    unsigned answers;
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
