/* commands: carries out what the input controller, the panel and the dialogs have asked for. */
#ifndef ISO_APPS_ISOSCULPT_WINDOW_COMMANDS_H
#define ISO_APPS_ISOSCULPT_WINDOW_COMMANDS_H

#include "apps/isosculpt/window/state.h"

/* Carries out the user's answer to the dialog that is shown, and closes the dialog. `results`: bits as in
 * isosculpt_screen. */
void isosculpt_window_handle_dialog_result(window *w, unsigned results);

/* Executes the commands queued by the input controller and the panel, once in each turn of the loop. Errors
 * end the program. */
iso_status isosculpt_window_process_commands(window *w, iso_error *error);

/* Shows the running background tasks in the panel. */
void isosculpt_window_show_progress(window *w);

#endif
