/* render_command: the isorender command line that draws the picture in a viewport. */
#ifndef ISO_APPS_ISOSCULPT_RENDER_COMMAND_H
#define ISO_APPS_ISOSCULPT_RENDER_COMMAND_H

#include "apps/isosculpt/viewport/viewport.h"

typedef struct isosculpt_render_command {
    const char *path;    /* of the volume or level set */
    const char *reading; /* the options it is read with, as iso_input_write writes them; "" for none */
    const isosculpt_viewport *viewport; /* camera, method, colours; of volumes also the isovalue */
    int width, height;                  /* of the picture at rest, pixels */
} isosculpt_render_command;

/* Writes the command as one line for a shell, without line end. Numbers have all digits that matter. false:
 * `room` bytes are not enough. */
bool isosculpt_render_command_text(const isosculpt_render_command *command, char *text, size_t room);

#endif
