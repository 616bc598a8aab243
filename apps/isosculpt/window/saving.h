/* saving: saves the sculpture in the background, and asks before a file is overwritten. */
#ifndef ISO_APPS_ISOSCULPT_WINDOW_SAVING_H
#define ISO_APPS_ISOSCULPT_WINDOW_SAVING_H

#include "apps/isosculpt/render_command.h"
#include "apps/isosculpt/window/state.h"

/* Requests a save or an export (ISOSCULPT_BROWSE_SAVE, _EXPORT); path NULL: the document's target. A viewed
 * volume must be converted into a field before the save can start (commands.c). */
void isosculpt_window_request_save(window *w, isosculpt_purpose purpose, const char *path);

/* Starts the requested save as soon as there is a field, no stroke is drawn and no save is running; asks
 * first whether a file may be overwritten. */
void isosculpt_window_start_save(window *w);

/* Handles the user's answer: whether the file (of the save, or of a screenshot) may be overwritten. */
void isosculpt_window_answer_replace(window *w, bool agreed);

/* Shows the result when a save is done. Returns the action that was waiting for a successful save
 * (ISOSCULPT_DIALOG_CLOSE or _OPEN), else ISOSCULPT_DIALOG_NOTHING. */
isosculpt_dialog isosculpt_window_poll_save(window *w);

/* Saves the next picture to a .png file, or its scene to a .json file; asks first whether a file may be
 * overwritten. */
void isosculpt_window_request_screenshot(window *w, const char *path);

/* How isorender draws the current picture; it borrows the window's. false: no file has what is shown. */
bool isosculpt_window_render_command(const window *w, isosculpt_render_command *command);

/* Copies the isorender command that draws the current picture to the clipboard. */
void isosculpt_window_copy_command(window *w);

#endif
