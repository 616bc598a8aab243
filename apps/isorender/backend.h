/* backend: which engine draws, the cpu engine or OpenGL on a context that is found at run time. */
#ifndef ISO_APPS_ISORENDER_BACKEND_H
#define ISO_APPS_ISORENDER_BACKEND_H

#include "apps/isorender/settings.h"
#include "scene/gl_scene.h"

/* isorender_backend_close when done. */
typedef struct isorender_backend {
    const char *name;        /* "cpu", "egl", "osmesa" */
    const char *renderer;    /* the driver's name for itself, or the cpu engine's instruction set */
    iso_gl_context *context; /* NULL with the cpu engine */
    iso_gl_engine *engine;   /* NULL with the cpu engine */
} isorender_backend;

/* Checks the options that depend on the backend, as far as possible without opening it. Chooses a method that
 * OpenGL has when an option needs OpenGL and no method is given. ISO_ERR_USAGE, ISO_ERR_BACKEND,
 * ISO_ERR_LIMIT. */
iso_status isorender_backend_check(isorender_settings *settings, iso_error *error);

isorender_backend isorender_backend_cpu(void);

/* Opens the backend that the settings name; with "auto" the cpu engine when there is no GPU. ISO_ERR_BACKEND
 * when a backend asked for by name cannot be used; then *backend is the cpu engine. */
iso_status isorender_backend_open(const isorender_settings *settings, isorender_backend *backend,
                                  iso_error *error);
void isorender_backend_close(isorender_backend *backend);

/* Prints every backend to standard output: what it is, or why it cannot be used. */
void isorender_backends_list(int threads);

#endif
