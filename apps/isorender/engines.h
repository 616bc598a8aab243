/* engines: which engine has drawn a picture and the objects in it, where OpenGL was to draw it. */
#ifndef ISO_APPS_ISORENDER_ENGINES_H
#define ISO_APPS_ISORENDER_ENGINES_H

#include "apps/isorender/isorender.h"

/* Returns the backend that has drawn the picture, or most of it: the cpu engine where OpenGL has drawn
 * nothing, although there is a context. If nothing was to be drawn, that of the options. */
isorender_backend isorender_engines_backend(const isorender_job *job);

/* Logs what the cpu engine has drawn, and why, if OpenGL was asked for by name. */
void isorender_engines_log(const isorender_job *job);

#endif
