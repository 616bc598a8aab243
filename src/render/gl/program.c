#define _GNU_SOURCE
#include "render/gl/program.h"

#include <glad/gl.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "render/gl/internal.h"

typedef struct recipe {
    const char *name, *vertex, *fragment, *defines;
} recipe;

static const recipe recipes[ISO_GL_PROGRAMS] = {
    [ISO_GL_POINTS_PACKED] = {"points", "points.vert", "points.frag", ""},
    [ISO_GL_POINTS_SURFELS] = {"points of surfels", "points.vert", "points.frag", "#define SURFELS 1\n"},
    [ISO_GL_QUADS_PACKED] = {"quads", "points.vert", "points.frag", "#define QUADS 1\n"},
    [ISO_GL_QUADS_SURFELS] = {"quads of surfels", "points.vert", "points.frag",
                              "#define QUADS 1\n#define SURFELS 1\n"},
    [ISO_GL_MESH] = {"mesh", "mesh.vert", "mesh.frag", ""},
};

const char *iso_gl_program_name(iso_gl_program program) {
    return recipes[program].name;
}

static const char *embedded(const char *name) {
    for (const iso_gl_text *text = iso_gl_texts; text->name; text++)
        if (strcmp(text->name, name) == 0) return text->text;
    return "#error the shader is not embedded\n";
}

/* The whole file, free(); NULL when it is not there. */
static char *read_file(const char *folder, const char *name) {
    char path[PATH_MAX];
    if (snprintf(path, sizeof path, "%s/%s", folder, name) >= (int)sizeof path) return NULL;
    FILE *file = fopen(path, "rb");
    if (!file) return NULL;
    char *text = NULL;
    size_t size = 0;
    if (getdelim(&text, &size, 0, file) < 0) {
        free(text);
        text = NULL;
    }
    fclose(file);
    return text;
}

static iso_status compile(iso_gl_context *context, GLenum type, const char *file, const char *defines,
                          GLuint *shader, iso_error *error) {
    const GladGLContext *gl = context->gl;
    const char *folder = secure_getenv("ISO_SHADER_DIR");
    char *own = folder && *folder ? read_file(folder, file) : NULL;
    const char *parts[] = {"#version 450 core\n#define ISO_GLSL 1\n", defines, embedded("shared.h"),
                           "#line 1 1\n", own ? own : embedded(file)};
    GLuint made = gl->CreateShader(type);
    gl->ShaderSource(made, (GLsizei)(sizeof parts / sizeof *parts), parts, NULL);
    free(own);
    gl->CompileShader(made);
    GLint good = 0;
    gl->GetShaderiv(made, GL_COMPILE_STATUS, &good);
    if (good) {
        *shader = made;
        return ISO_OK;
    }
    char log[ISO_GL_TEXT] = "";
    gl->GetShaderInfoLog(made, sizeof log, NULL, log);
    gl->DeleteShader(made);
    log[strcspn(log, "\n")] = 0;
    return iso_fail(error, ISO_ERR_BACKEND, "%s: shader %s: %s", context->name, file, log);
}

static iso_status link_program(iso_gl_context *context, const recipe *r, const GLuint shaders[2],
                               unsigned *name, iso_error *error) {
    const GladGLContext *gl = context->gl;
    GLuint made = gl->CreateProgram();
    for (int i = 0; i < 2; i++) gl->AttachShader(made, shaders[i]);
    gl->LinkProgram(made);
    for (int i = 0; i < 2; i++) gl->DetachShader(made, shaders[i]);
    GLint good = 0;
    gl->GetProgramiv(made, GL_LINK_STATUS, &good);
    if (good) {
        *name = made;
        return ISO_OK;
    }
    char log[ISO_GL_TEXT] = "";
    gl->GetProgramInfoLog(made, sizeof log, NULL, log);
    gl->DeleteProgram(made);
    log[strcspn(log, "\n")] = 0;
    return iso_fail(error, ISO_ERR_BACKEND, "%s: shaders of %s: %s", context->name, r->name, log);
}

iso_status iso_gl_program_build(iso_gl_context *context, iso_gl_program program, unsigned *name,
                                iso_error *error) {
    const recipe *r = &recipes[program];
    GLuint shaders[2];
    ISO_TRY(compile(context, GL_VERTEX_SHADER, r->vertex, r->defines, &shaders[0], error));
    iso_status status = compile(context, GL_FRAGMENT_SHADER, r->fragment, r->defines, &shaders[1], error);
    if (status == ISO_OK) {
        status = link_program(context, r, shaders, name, error);
        context->gl->DeleteShader(shaders[1]);
    }
    context->gl->DeleteShader(shaders[0]);
    return status;
}
