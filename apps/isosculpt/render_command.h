/* render_command: how isorender draws the picture in a viewport: as options, as a command line for a shell,
 * and as a scene (apps/common/scene_json.h). */
#ifndef ISO_APPS_ISOSCULPT_RENDER_COMMAND_H
#define ISO_APPS_ISOSCULPT_RENDER_COMMAND_H

#include "apps/common/scene_json.h"
#include "apps/isosculpt/viewport/viewport.h"

typedef struct isosculpt_render_command {
    const char *path;    /* of the volume or level set */
    const char *reading; /* the options it is read with, as iso_input_write writes them; "" for none */
    const isosculpt_viewport *viewport; /* camera, method, colours; of volumes also the isovalue */
    int width, height;                  /* of the picture at rest, pixels */
} isosculpt_render_command;

/* The options, with the text that their names and values lie in. */
enum { ISOSCULPT_RENDER_OPTIONS = 40, ISOSCULPT_RENDER_TEXT = 16384 };
typedef struct isosculpt_render_options {
    iso_scene_option items[ISOSCULPT_RENDER_OPTIONS];
    int count;
    double isovalues[2];
    int isovalue_count;
    char text[ISOSCULPT_RENDER_TEXT];
} isosculpt_render_options;

/* Lists the options. Numbers have all digits that matter. false: there is not enough room for them. */
bool isosculpt_render_options_make(const isosculpt_render_command *command,
                                   isosculpt_render_options *options);

/* Writes the command as one line for a shell, without line end. false: `room` bytes are not enough. */
bool isosculpt_render_command_text(const isosculpt_render_command *command, char *text, size_t room);

/* The scene of the picture; it borrows both. */
iso_scene_record isosculpt_render_record(const isosculpt_render_command *command,
                                         const isosculpt_render_options *options);

#endif
