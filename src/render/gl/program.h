/* program: shaders by name and defines. Inside render/gl, and for the test that compiles all of them. */
#ifndef ISO_RENDER_GL_PROGRAM_H
#define ISO_RENDER_GL_PROGRAM_H

#include <stdio.h>

#include "render/gl/context.h"

#ifdef __cplusplus
extern "C" {
#endif

/* The files of shaders/ and shared.h, ended by a row of NULLs; made by shaders/embed.cmake. */
typedef struct iso_gl_text {
    const char *name, *text;
} iso_gl_text;
extern const iso_gl_text iso_gl_texts[];

typedef enum iso_gl_program {
    ISO_GL_POINTS_PACKED,
    ISO_GL_POINTS_SURFELS,
    ISO_GL_QUADS_PACKED,
    ISO_GL_QUADS_SURFELS,
    ISO_GL_MESH,
    /* Pull-push: projections by kind, of packed points and then of surfels, as pullpush_project.comp has them
     */
    ISO_GL_PROJECT_DEPTHS,
    ISO_GL_PROJECT_PAYLOADS,
    ISO_GL_PROJECT_DISCS,
    ISO_GL_PROJECT_KEYS, /* only where iso_gl_has_wide_atomics */
    ISO_GL_PROJECT_SURFELS,
    ISO_GL_PULL_LEVEL = ISO_GL_PROJECT_SURFELS + 4,
    ISO_GL_PULL_KEYS,
    ISO_GL_UNPACK,
    ISO_GL_PUSH,
    ISO_GL_FINISH,
    ISO_GL_COLORED, /* the same from ISO_GL_PULL_LEVEL on, of points that have colours */
    ISO_GL_COLORED_LAST = ISO_GL_COLORED + ISO_GL_FINISH - ISO_GL_PULL_LEVEL,
    ISO_GL_SHADE_TARGET,  /* colours: of what fragments made */
    ISO_GL_SHADE_PICTURE, /* and of what pull-push made */
    /* Refined: the nearest depths of discs and what they add there, by points and by quads, of packed points
     * and then of surfels. */
    ISO_GL_FRONT_POINTS,
    ISO_GL_FRONT_QUADS,
    ISO_GL_ADD_POINTS,
    ISO_GL_ADD_QUADS,
    ISO_GL_DISCS_OF_SURFELS,
    ISO_GL_SETTLE = ISO_GL_DISCS_OF_SURFELS + 4
} iso_gl_program;
enum { ISO_GL_PROGRAMS = ISO_GL_SETTLE + 1 };

const char *iso_gl_program_name(iso_gl_program program);

/* Whether the context has atomic operations on 64 bits in storage buffers (it is current). */
bool iso_gl_has_wide_atomics(const iso_gl_context *context);
/* Whether the program can be built there at all. */
bool iso_gl_program_fits(iso_gl_program program, bool wide_atomics);

/* The whole text of a program's stage (0, 1), for other compilers; returns the name of its file, or NULL:
 * there is no such stage. */
const char *iso_gl_program_write(iso_gl_program program, int stage, FILE *stream);

/* Compiles and links in the current context; *name is GL's number. ISO_ERR_BACKEND with the driver's log.
 * Texts come from the folder ISO_SHADER_DIR where that is set and has the file. */
iso_status iso_gl_program_build(iso_gl_context *context, iso_gl_program program, unsigned *name,
                                iso_error *error);

#ifdef __cplusplus
}
#endif
#endif
