/* opening: opens files in place of the current document, or as a stamp, in the background. */
#ifndef ISO_APPS_ISOSCULPT_WINDOW_OPENING_H
#define ISO_APPS_ISOSCULPT_WINDOW_OPENING_H

#include "apps/isosculpt/window/state.h"

/* Opens what the command line asks for: a stroke file, a file, the journal to recover, or a new ball. */
iso_status isosculpt_window_open_first(window *w, iso_error *error);

/* Starts to open a file, as a stamp or in place of the current document; then asks first about unsaved
 * changes. */
void isosculpt_window_open_file(window *w, const char *path, bool stamp);

/* Begins a new session with w->screen.asked; asks first about unsaved changes. _can_: whether there is such a
 * solid; the dialog says why not. */
bool isosculpt_window_can_begin(const window *w);
void isosculpt_window_begin(window *w);

/* Starts to play all strokes in voxels of w->screen.asked_voxel; their file stays as it is. */
void isosculpt_window_resample(window *w);

/* Starts to open a journal for recovery. A new ball without changes is replaced without asking. */
void isosculpt_window_recover(window *w, const char *journal);

/* Opens a dropped file; for a mesh asks whether it is to be a stamp. */
void isosculpt_window_drop(window *w, const char *path);

/* Continues to open `next_path` after the question about unsaved changes: the user has agreed to lose them,
 * or they have been saved. */
void isosculpt_window_confirm_open(window *w);

/* Cancels opening `next_path`: the user wants to keep the current document. */
void isosculpt_window_reject_open(window *w);

/* Returns whether a file is being opened; if so, also shows a message that asks the user to wait. */
bool isosculpt_window_is_opening(window *w);

/* Starts to convert the viewed volume into a field. */
void isosculpt_window_start_sculpting(window *w);

/* Opens the mesh of --stamp, once there is a field. */
void isosculpt_window_load_first_stamp(window *w);

/* Shows the result when opening is done. If a stroke, a save or a dialog is in progress, a later call does
 * it. Errors end the program. */
iso_status isosculpt_window_finish_opening(window *w, iso_error *error);

/* Cancels opening and waits for its end, before the window closes. */
void isosculpt_window_cancel_load(window *w);

#endif
