/* program: the table of shader programs, how their sources are put together from files, and their
 * compilation. */
#include "render/gl/program.h"

#include <glad/gl.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "render/gl/internal.h"

/* HEAD: sources that every shader begins with, before its pieces. */
enum { STAGES = 2, PIECES = 5, HEAD = 5 };

/* How a program is put together: one file per stage, and the pieces (shared GLSL) included before each of
 * them. */
typedef struct recipe {
    const char *name, *files[STAGES], *pieces[PIECES], *defines;
} recipe;

#define PROJECT "pullpush_project.comp"
/* The extensions for 64-bit atomic operations. */
#define WIDE                                                                                                 \
    "#extension GL_ARB_gpu_shader_int64 : require\n"                                                         \
    "#extension GL_NV_shader_atomic_int64 : require\n"

/* The five steps of pull-push after projection. */
#define PYRAMID "unpack.glsl", "pullpush.glsl"
#define RECONSTRUCTION(first, what, defines)                                                                 \
    [first] = {"pull" what, {"pullpush_pull.comp"}, {PYRAMID}, defines},                                     \
    [first + 1] = {"pull of keys" what, {"pullpush_pull.comp"}, {PYRAMID}, defines "#define KEYS 1\n"},      \
    [first + 2] = {"unpacked keys" what, {"pullpush_pull.comp"}, {PYRAMID}, defines "#define KEYS 2\n"},     \
    [first + 3] = {"push" what, {"pullpush_push.comp"}, {PYRAMID, "pullpush_mix.glsl"}, defines},            \
    [first + 4] = {                                                                                          \
        "finish" what, {"pullpush_finish.comp"}, {PYRAMID, "pullpush_mix.glsl", "picture.glsl"}, defines}

#define LINES "shared_pyramid.h", "pullpush_lines.glsl"
#define PULL_LINES "pullpush_lines_pull.comp"
#define SETS "shared_pyramid.h", "unpack.glsl", "pullpush_sets.glsl"

/* The two passes over discs of the method discs, each as points and as quads. */
#define DISC_SOURCES "discs_numbers.h", "discs.glsl", "discs_curvature.glsl"
#define DISCS(first, what, defines)                                                                          \
    [first] = {"fronts" what, {"discs.vert", "discs.frag"}, {"unpack.glsl", DISC_SOURCES}, defines},         \
    [first + 1] = {"fronts of quads" what,                                                                   \
                   {"discs.vert", "discs.frag"},                                                             \
                   {"unpack.glsl", DISC_SOURCES},                                                            \
                   defines "#define QUADS 1\n"},                                                             \
    [first + 2] = {"sums" what,                                                                              \
                   {"discs.vert", "discs.frag"},                                                             \
                   {"unpack.glsl", DISC_SOURCES},                                                            \
                   defines "#define ADDING 1\n"},                                                            \
    [first + 3] = {"sums of quads" what,                                                                     \
                   {"discs.vert", "discs.frag"},                                                             \
                   {"unpack.glsl", DISC_SOURCES},                                                            \
                   defines "#define ADDING 1\n#define QUADS 1\n"}

/* The passes that select points: nothing is drawn, so they have no fragment shader. */
#define SELECTION(first, what, defines)                                                                      \
    [first] = {"selected depths" what,                                                                       \
               {"discs.vert"},                                                                               \
               {"unpack.glsl", DISC_SOURCES},                                                                \
               defines "#define SELECT 1\n"},                                                                \
    [first + 1] = {"selected points" what,                                                                   \
                   {"discs.vert"},                                                                           \
                   {"unpack.glsl", DISC_SOURCES},                                                            \
                   defines "#define SELECT 2\n"},                                                            \
    [first + 2] = {                                                                                          \
        "visible points" what, {"discs.vert"}, {"unpack.glsl", DISC_SOURCES}, defines "#define SELECT 3\n"}

/* Lines and glyphs of one kind: `index` 0 to 8, in floats and in double precision. Each has programs of
 * its own, because software renderers execute all branches of a shader. */
#define SHAPES(index, what, equations, defines)                                                              \
    [ISO_GL_DRAW_SHAPES +                                                                                    \
        index] = {what,                                                                                      \
                  {"shapes.vert", "shapes.frag"},                                                            \
                  {"shapes.glsl", "shapes_box.glsl", "shapes_ids.glsl", equations},                          \
                  defines},                                                                                  \
        [ISO_GL_DRAW_NEAR_SHAPES +                                                                           \
            index] = {what " in double precision",                                                           \
                      {"shapes_near.vert", "shapes_near.frag"},                                              \
                      {"shapes.glsl", "shapes_ids.glsl", "shapes_near.glsl", "shapes_near_solid.glsl"},      \
                      defines}
#define SOLIDS(index, what, glyph)                                                                           \
    SHAPES(index, what, "shapes_solid.glsl", "#define KIND ISO_GL_SOLIDS\n#define GLYPH " glyph "\n")

static const recipe recipes[ISO_GL_PROGRAMS] = {
    [ISO_GL_POINTS_PACKED] = {"points", {"points.vert", "points.frag"}, {"unpack.glsl"}, ""},
    [ISO_GL_POINTS_SURFELS] = {"points of surfels",
                               {"points.vert", "points.frag"},
                               {"unpack.glsl"},
                               "#define SURFELS 1\n"},
    [ISO_GL_QUADS_PACKED] = {"quads", {"points.vert", "points.frag"}, {"unpack.glsl"}, "#define QUADS 1\n"},
    [ISO_GL_QUADS_SURFELS] = {"quads of surfels",
                              {"points.vert", "points.frag"},
                              {"unpack.glsl"},
                              "#define QUADS 1\n#define SURFELS 1\n"},
    [ISO_GL_MESH] = {"mesh", {"mesh.vert", "mesh.frag"}, {NULL}, ""},
    [ISO_GL_PROJECT_DEPTHS] = {"projected depths", {PROJECT}, {"unpack.glsl"}, "#define KIND 0\n"},
    [ISO_GL_PROJECT_PAYLOADS] = {"projected payloads", {PROJECT}, {"unpack.glsl"}, "#define KIND 1\n"},
    [ISO_GL_PROJECT_DISCS] = {"projected discs", {PROJECT}, {"unpack.glsl"}, "#define KIND 2\n"},
    [ISO_GL_PROJECT_KEYS] = {"projected keys", {PROJECT}, {"unpack.glsl"}, WIDE "#define KIND 3\n"},
    [ISO_GL_PROJECT_SURFELS] = {"projected depths of surfels",
                                {PROJECT},
                                {"unpack.glsl"},
                                "#define KIND 0\n#define SURFELS 1\n"},
    [ISO_GL_PROJECT_SURFELS + 1] = {"projected payloads of surfels",
                                    {PROJECT},
                                    {"unpack.glsl"},
                                    "#define KIND 1\n#define SURFELS 1\n"},
    [ISO_GL_PROJECT_SURFELS + 2] = {"projected discs of surfels",
                                    {PROJECT},
                                    {"unpack.glsl"},
                                    "#define KIND 2\n#define SURFELS 1\n"},
    [ISO_GL_PROJECT_SURFELS + 3] = {"projected keys of surfels",
                                    {PROJECT},
                                    {"unpack.glsl"},
                                    WIDE "#define KIND 3\n#define SURFELS 1\n"},
    RECONSTRUCTION(ISO_GL_PULL_LEVEL, "", ""),
    RECONSTRUCTION(ISO_GL_COLORED, " with colours", "#define COLORS 1\n"),
    [ISO_GL_LINES_PLACE] = {"places of lines", {PULL_LINES}, {LINES}, "#define KIND 0\n"},
    [ISO_GL_LINES_PULL] = {"pull of lines", {PULL_LINES}, {LINES}, "#define KIND 1\n"},
    [ISO_GL_LINES_UNPACK] = {"unpacked places of lines", {PULL_LINES}, {LINES}, "#define KIND 2\n"},
    [ISO_GL_LINES_PUSH] = {"push of lines", {"pullpush_lines_push.comp"}, {LINES}, ""},
    [ISO_GL_LINES_FINISH] = {"finish of lines",
                             {"pullpush_lines_finish.comp"},
                             {"phong.h", LINES, "picture.glsl"},
                             ""},
    [ISO_GL_SETS_PULL] = {"pull of sets", {"pullpush_sets_pull.comp"}, {SETS}, ""},
    [ISO_GL_SETS_PUSH] = {"push of sets", {"pullpush_sets_push.comp"}, {SETS, "pullpush_sets_mix.glsl"}, ""},
    [ISO_GL_SETS_FINISH] = {"finish of sets",
                            {"pullpush_sets_finish.comp"},
                            {SETS, "pullpush_sets_mix.glsl", "picture.glsl"},
                            ""},
    [ISO_GL_POLYGON_KEYS] = {"keys of triangles",
                             {"pullpush_polygons.comp"},
                             {PYRAMID, "shared_pyramid.h"},
                             "#define KIND 0\n"},
    [ISO_GL_POLYGON_SAMPLES] = {"samples of triangles",
                                {"pullpush_polygons.comp"},
                                {PYRAMID, "shared_pyramid.h", "picture.glsl"},
                                "#define KIND 1\n"},
    [ISO_GL_SHADE_TARGET] = {"shading", {"shade.comp"}, {"phong.h"}, ""},
    [ISO_GL_SHADE_PICTURE] = {"shading of pull-push", {"shade.comp"}, {"phong.h"}, "#define BUFFER 1\n"},
    DISCS(ISO_GL_FRONT_POINTS, "", ""),
    DISCS(ISO_GL_DISCS_OF_SURFELS, " of surfels", "#define SURFELS 1\n"),
    SELECTION(ISO_GL_SELECT_DEPTHS, "", ""),
    SELECTION(ISO_GL_SELECT_SURFELS, " of surfels", "#define SURFELS 1\n"),
    [ISO_GL_CHOOSE] = {"chosen points", {"discs_choose.comp"}, {NULL}, ""},
    [ISO_GL_FIND_DEEPEST] = {"deepest fronts", {"discs_deepest.comp"}, {"discs_numbers.h", "discs.glsl"}, ""},
    [ISO_GL_RESOLVE] = {"resolved sums", {"discs_resolve.comp"}, {DISC_SOURCES, "picture.glsl"}, ""},
    [ISO_GL_SPLAT_DEPTHS] = {"depths of slots", {"splats.comp"}, {"splats.glsl"}, "#define KIND 0\n"},
    [ISO_GL_SPLAT_NUMBERS] = {"discs of slots", {"splats.comp"}, {"splats.glsl"}, "#define KIND 1\n"},
    [ISO_GL_SPLAT_KEYS] = {"keys of slots", {"splats.comp"}, {"splats.glsl"}, WIDE "#define KIND 2\n"},
    [ISO_GL_SPLAT_MEAN] = {"mean of groups", {"splats_layers.comp"}, {"splats.glsl"}, "#define KIND 0\n"},
    [ISO_GL_SPLAT_NEAREST] = {"nearest layer", {"splats_layers.comp"}, {"splats.glsl"}, "#define KIND 1\n"},
    [ISO_GL_SPLAT_COUNTS] = {"counts of hits", {"splats_layers.comp"}, {"splats.glsl"}, "#define KIND 2\n"},
    [ISO_GL_SPLAT_LISTS] = {"sorted layers", {"splats_layers.comp"}, {"splats.glsl"}, "#define KIND 3\n"},
    [ISO_GL_SPLAT_RESOLVE] = {"resolved slots", {"splats_resolve.comp"}, {"splats.glsl", "picture.glsl"}, ""},
    SHAPES(0, "spheres", NULL, "#define KIND ISO_GL_SPHERES\n"),
    SHAPES(1, "tubes", "shapes_tube.glsl", "#define KIND ISO_GL_TUBES\n"),
    SHAPES(2, "ribbons", "shapes_ribbon.glsl", "#define KIND ISO_GL_RIBBONS\n"),
    SOLIDS(3, "cones", "ISO_GL_CONE"),
    SOLIDS(4, "cylinders", "ISO_GL_CYLINDER"),
    SOLIDS(5, "arrows", "ISO_GL_ARROW"),
    SOLIDS(6, "ellipsoids", "ISO_GL_ELLIPSOID"),
    SOLIDS(7, "discs", "ISO_GL_DISC"),
    SOLIDS(8, "boxes", "ISO_GL_BOX"),
};

const char *iso_gl_program_name(iso_gl_program program) {
    return recipes[program].name;
}

static const char *embedded(const char *name) {
    for (const iso_gl_text *text = iso_gl_texts; text->name; text++)
        if (strcmp(text->name, name) == 0) return text->text;
    return "#error the shader is not embedded\n";
}

/* The whole file, to be released with free(); NULL: no such file. */
static char *read_file(const char *folder, const char *name) {
    char path[PATH_MAX];
    if (snprintf(path, sizeof path, "%s/%s", folder, name) >= (int)sizeof path) return NULL;
    FILE *file;
    if (iso_file_open(path, &file, NULL, NULL) != ISO_OK) return NULL;
    char *text = NULL;
    size_t size = 0;
    if (getdelim(&text, &size, 0, file) < 0) {
        free(text);
        text = NULL;
    }
    fclose(file);
    return text;
}

/* ---- 64-bit atomic operations */

static bool has_extension(const GladGLContext *gl, const char *name) {
    GLint count = 0;
    gl->GetIntegerv(GL_NUM_EXTENSIONS, &count);
    for (GLint i = 0; i < count; i++)
        if (strcmp((const char *)gl->GetStringi(GL_EXTENSIONS, (GLuint)i), name) == 0) return true;
    return false;
}

bool iso_gl_has_wide_atomics(const iso_gl_context *context) {
    return has_extension(context->gl, "GL_ARB_gpu_shader_int64") &&
           has_extension(context->gl, "GL_NV_shader_atomic_int64");
}

bool iso_gl_program_fits(iso_gl_program program, bool wide_atomics) {
    return wide_atomics || strncmp(recipes[program].defines, "#extension", strlen("#extension")) != 0;
}

/* ---- building */

static GLenum type_of(const char *file) {
    const char *ending = strrchr(file, '.');
    if (strcmp(ending, ".comp") == 0) return GL_COMPUTE_SHADER;
    return strcmp(ending, ".vert") == 0 ? GL_VERTEX_SHADER : GL_FRAGMENT_SHADER;
}

/* The sources of one shader in order; those read from disk are owned. */
typedef struct source {
    const char *part[HEAD + 2 * (PIECES + 1)];
    char *own[PIECES + 1];
    int parts, owned;
} source;

/* Adds a file, preceded by a #line directive so that error messages count its own lines. */
static void add_file(source *s, const char *file) {
    const char *folder = secure_getenv("ISO_SHADER_DIR");
    char *own = folder && *folder ? read_file(folder, file) : NULL;
    if (own) s->own[s->owned++] = own;
    s->part[s->parts++] = "#line 1 1\n";
    s->part[s->parts++] = own ? own : embedded(file);
}

static source source_of(const recipe *r, const char *file) {
    source s = {.part = {"#version 450 core\n", r->defines, "#define ISO_GLSL 1\n", embedded("shared.h"),
                         embedded("point_numbers.h")},
                .parts = HEAD};
    for (int i = 0; i < PIECES && r->pieces[i]; i++) add_file(&s, r->pieces[i]);
    add_file(&s, file);
    return s;
}

static void free_source(source *s) {
    for (int i = 0; i < s->owned; i++) free(s->own[i]);
}

const char *iso_gl_program_write(iso_gl_program program, int stage, FILE *stream) {
    const recipe *r = &recipes[program];
    if (stage >= STAGES || !r->files[stage]) return NULL;
    source s = source_of(r, r->files[stage]);
    for (int i = 0; i < s.parts; i++) fputs(s.part[i], stream);
    free_source(&s);
    return r->files[stage];
}

/* Leaves of a compiler's log the line that says what is wrong: drivers may put headings before it. */
static void keep_error_line(char *log) {
    const char *line = log;
    for (char *at = log; *at;) {
        const size_t length = strcspn(at, "\n");
        const bool last = at[length] == 0;
        at[length] = 0;
        if (strstr(at, "error") || strstr(at, "ERROR")) {
            line = at;
            break;
        }
        if (last) break;
        at += length + 1;
    }
    memmove(log, line, strlen(line) + 1);
}

static iso_status compile(iso_gl_context *context, const recipe *r, const char *file, GLuint *shader,
                          iso_error *error) {
    const GladGLContext *gl = context->gl;
    source s = source_of(r, file);
    GLuint made = gl->CreateShader(type_of(file));
    gl->ShaderSource(made, s.parts, s.part, NULL);
    free_source(&s);
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
    keep_error_line(log);
    return iso_fail(error, ISO_ERR_BACKEND, "%s: shader %s: %s", context->name, file, log);
}

static iso_status link_program(iso_gl_context *context, const recipe *r, const GLuint shaders[STAGES],
                               unsigned *name, iso_error *error) {
    const GladGLContext *gl = context->gl;
    GLuint made = gl->CreateProgram();
    for (int i = 0; i < STAGES && shaders[i]; i++) gl->AttachShader(made, shaders[i]);
    gl->LinkProgram(made);
    for (int i = 0; i < STAGES && shaders[i]; i++) gl->DetachShader(made, shaders[i]);
    GLint good = 0;
    gl->GetProgramiv(made, GL_LINK_STATUS, &good);
    if (good) {
        *name = made;
        return ISO_OK;
    }
    char log[ISO_GL_TEXT] = "";
    gl->GetProgramInfoLog(made, sizeof log, NULL, log);
    gl->DeleteProgram(made);
    keep_error_line(log);
    return iso_fail(error, ISO_ERR_BACKEND, "%s: shaders of %s: %s", context->name, r->name, log);
}

iso_status iso_gl_program_build(iso_gl_context *context, iso_gl_program program, unsigned *name,
                                iso_error *error) {
    const recipe *r = &recipes[program];
    GLuint shaders[STAGES] = {0};
    iso_status status = ISO_OK;
    for (int i = 0; status == ISO_OK && i < STAGES && r->files[i]; i++)
        status = compile(context, r, r->files[i], &shaders[i], error);
    if (status == ISO_OK) status = link_program(context, r, shaders, name, error);
    for (int i = 0; i < STAGES; i++) context->gl->DeleteShader(shaders[i]); /* 0 is ignored */
    return status;
}
