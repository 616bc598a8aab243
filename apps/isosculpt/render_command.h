/* render_command: the isorender command that draws what a window shows. */
#ifndef ISO_APPS_ISOSCULPT_RENDER_COMMAND_H
#define ISO_APPS_ISOSCULPT_RENDER_COMMAND_H

#include "apps/isosculpt/view/view.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct isosculpt_render_command {
    const char *path;           /* of the volume or level set */
    const char *reading;        /* how it is read, as iso_input_write says it; "" by default */
    const isosculpt_view *view; /* its camera, method, colours, and of volumes the isovalue */
    int width, height;          /* of the picture at rest, pixels */
} isosculpt_render_command;

/* One line for a shell, without its end. Numbers have all their digits. false: `room` is too small. */
bool isosculpt_render_command_text(const isosculpt_render_command *command, char *text, size_t room);

#ifdef __cplusplus
}
#endif
#endif
