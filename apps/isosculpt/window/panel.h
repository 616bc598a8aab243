/* panel: everything that is drawn over the picture: the panel with its sections, the help, dialogs, messages
 * and the brush's ring. Dear ImGui is used here, in the files panel*.cc and file_browser.cc, and nowhere
 * else. One panel in a program: Dear ImGui keeps its context in a global variable. */
#ifndef ISO_APPS_ISOSCULPT_WINDOW_PANEL_H
#define ISO_APPS_ISOSCULPT_WINDOW_PANEL_H

#include "apps/common/options.h"
#include "apps/isosculpt/input_controller.h"
#include "apps/isosculpt/window/file_browser.h"
#include "base/c_linkage.h"

ISO_C_BEGIN

/* Modal dialogs, one at a time; meanwhile mouse and keys do not reach the sculpture. */
typedef enum isosculpt_dialog {
    ISOSCULPT_DIALOG_NOTHING,
    ISOSCULPT_DIALOG_RECOVER, /* recover the journal `dialog_path`? */
    ISOSCULPT_DIALOG_CLOSE,   /* close with unsaved changes? */
    ISOSCULPT_DIALOG_OPEN,    /* open `dialog_path`, with unsaved changes? */
    ISOSCULPT_DIALOG_MESH,    /* open the mesh `dialog_path`, or use it as a stamp? */
    ISOSCULPT_DIALOG_REPLACE, /* overwrite the file `dialog_path`? */
    ISOSCULPT_DIALOG_NEW      /* which solid to begin with? */
} isosculpt_dialog;

/* What the user chose in a dialog or in the panel, as bits of isosculpt_screen.results. */
enum {
    ISOSCULPT_RESULT_RECOVER = 1,
    ISOSCULPT_RESULT_DISMISS = 2, /* do not offer this recovery again */
    ISOSCULPT_RESULT_PROCEED = 4, /* close the window, or open the other file, despite unsaved changes */
    ISOSCULPT_RESULT_KEEP = 8,    /* close the dialog without doing anything */
    ISOSCULPT_RESULT_SAVE = 16,
    ISOSCULPT_RESULT_OPEN = 32,  /* open `dialog_path` (in a dialog) or `typed_path` */
    ISOSCULPT_RESULT_STAMP = 64, /* use `dialog_path` as a stamp */
    ISOSCULPT_RESULT_CANCEL =
        128, /* cancel progress_items[0]; twice this value (256): progress_items[1] ... */
    ISOSCULPT_RESULT_REPLACE = 1024,  /* overwrite the file */
    ISOSCULPT_RESULT_CHOSEN = 2048,   /* `chosen_path` was chosen in the browser, for `chosen_purpose` */
    ISOSCULPT_RESULT_COMMAND = 4096,  /* copy the isorender command to the clipboard */
    ISOSCULPT_RESULT_NEW = 8192,      /* begin with `asked` */
    ISOSCULPT_RESULT_RESAMPLE = 16384 /* go on in voxels of `asked_voxel` */
};

/* What the dialog for a new session asks for. */
typedef struct isosculpt_new {
    iso_start_solid solid;
    double voxel; /* mm; 0: what suits the solid */
} isosculpt_new;

/* A background task that is running. */
typedef struct isosculpt_progress_item {
    char text[160];
    double fraction; /* 0 .. 1 */
} isosculpt_progress_item;
enum { ISOSCULPT_PROGRESS_ITEMS = 3 };

/* The state that window and panel share: the panel shows it and changes it. Owned by the window. */
typedef struct isosculpt_screen {
    isosculpt_controller *controller; /* borrowed */
    unsigned texture;                 /* OpenGL's name of the picture; 0: none yet */
    int width, height;                /* of the framebuffer */
    double pixels;                    /* framebuffer pixels to a window coordinate */
    int picture_x, picture_width;     /* of the picture in the framebuffer: what the panel leaves free; the
                                         controller's coordinates begin at picture_x */
    bool panel, help;                 /* shown */
    bool pen;                         /* a pen with pressure is connected */
    bool blank;                       /* nothing is open yet */
    isosculpt_dialog dialog;
    char dialog_path[ISOSCULPT_PATH];
    isosculpt_new asked;
    double asked_voxel; /* mm, in the box of the section of numbers; 0: not asked for */
    isosculpt_progress_item progress_items[ISOSCULPT_PROGRESS_ITEMS];
    int progress_item_count;
    char typed_path[ISOSCULPT_PATH]; /* in the panel's input box */
    isosculpt_browser browser;
    isosculpt_purpose browse_request; /* purpose for which the browser is opened in the next frame */
    isosculpt_purpose chosen_purpose;
    char chosen_path[ISOSCULPT_PATH];
    const iso_source_volume *volume; /* the viewed volume; NULL: there is a field */
    const iso_texts *references;     /* files of the reference; none: the surface at the beginning of the
                                       session */
    bool has_labels;                 /* the sculpture is one of a segmentation's labels */
    isosculpt_backdrop *backdrop;    /* the reference picture; borrowed */
    bool reference_pending;          /* the reference is being made */
    bool sculpting;                  /* the volume is being converted into a field */
    bool freeze_second;              /* what the second surface encloses is frozen in the sculpture */
    double isovalue;                 /* of the volume, physical, as chosen in the panel */
    bool isovalue_dragged;           /* the user is dragging the isovalue or the second one in this frame */
    bool second_line_dragged;        /* the line of the histogram that was dragged last is the second one */
    char message[600];               /* the status message; "": none */
    double message_seconds;          /* iso_clock_seconds when it was set */
    bool message_is_error;           /* it stays until the user dismisses it; others vanish after a while */
    unsigned results;                /* bits, cleared by the window */
} isosculpt_screen;

typedef struct isosculpt_panel isosculpt_panel;

/* `window`: a GLFWwindow whose context is current and whose callbacks are set; Dear ImGui calls them from its
 * own. `scale`: of text and widgets. `font`: a TrueType or OpenType file; "builtin": Dear ImGui's own font;
 * NULL: a font that is installed, else Dear ImGui's own. ISO_ERR_IO: the font cannot be read; ISO_ERR_FORMAT:
 * it is none; ISO_ERR_NOMEM, ISO_ERR_BACKEND. */
iso_status isosculpt_panel_create(void *window, double scale, const char *font, isosculpt_panel **panel,
                                  iso_error *error);
/* Changes the scale; call it between frames. ISO_ERR_NOMEM, ISO_ERR_BACKEND. */
iso_status isosculpt_panel_rescale(isosculpt_panel *panel, double scale, iso_error *error);
void isosculpt_panel_destroy(isosculpt_panel *panel);

/* The width of the panel, in window coordinates; 0 when there is none (NULL). */
double isosculpt_panel_width(const isosculpt_panel *panel);

/* If a list or a colour picker is open, closes it in the next frame and returns true. */
bool isosculpt_panel_close_list(isosculpt_panel *panel);

/* Draws one frame into the current framebuffer. */
iso_status isosculpt_panel_draw(isosculpt_panel *panel, isosculpt_screen *screen, iso_error *error);

/* Returns whether the panel or a dialog uses the pointer at a window position, or the keyboard. */
bool isosculpt_panel_has_pointer(const isosculpt_panel *panel, double x, double y);
bool isosculpt_panel_has_keys(void);

ISO_C_END
#endif
