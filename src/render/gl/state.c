/* state: which OpenGL state is saved and restored, as tables of names and the queries for the rest. */
#include "render/gl/state.h"

#include <glad/gl.h>
#include <stddef.h>

#include "render/gl/shared.h"

static const GLenum switches[ISO_GL_SWITCHES] = {
    GL_SCISSOR_TEST,      GL_DEPTH_TEST,     GL_PROGRAM_POINT_SIZE,  GL_PRIMITIVE_RESTART_FIXED_INDEX,
    GL_PRIMITIVE_RESTART, GL_BLEND,          GL_CULL_FACE,           GL_STENCIL_TEST,
    GL_COLOR_LOGIC_OP,    GL_DEPTH_CLAMP,    GL_POLYGON_OFFSET_FILL, GL_RASTERIZER_DISCARD,
    GL_SAMPLE_MASK,       GL_SAMPLE_COVERAGE};

static const GLenum pixel_stores[ISO_GL_PIXEL_STORES] = {
    GL_PACK_ALIGNMENT,   GL_PACK_ROW_LENGTH,   GL_PACK_SKIP_ROWS,   GL_PACK_SKIP_PIXELS,
    GL_UNPACK_ALIGNMENT, GL_UNPACK_ROW_LENGTH, GL_UNPACK_SKIP_ROWS, GL_UNPACK_SKIP_PIXELS};

static const struct {
    GLenum target, name;
} bindings[ISO_GL_BINDINGS] = {{GL_PIXEL_PACK_BUFFER, GL_PIXEL_PACK_BUFFER_BINDING},
                               {GL_PIXEL_UNPACK_BUFFER, GL_PIXEL_UNPACK_BUFFER_BINDING},
                               {GL_DRAW_INDIRECT_BUFFER, GL_DRAW_INDIRECT_BUFFER_BINDING},
                               {GL_UNIFORM_BUFFER, GL_UNIFORM_BUFFER_BINDING},
                               {GL_SHADER_STORAGE_BUFFER, GL_SHADER_STORAGE_BUFFER_BINDING}};

/* Vertex attributes that draws set to a constant when they read no array. */
static const GLuint attributes[ISO_GL_ATTRIBUTES] = {ISO_GL_RADIUS, ISO_GL_ORIGIN, ISO_GL_PLACE};

static const GLenum blend_values[ISO_GL_BLEND_VALUES] = {GL_BLEND_SRC_RGB,      GL_BLEND_DST_RGB,
                                                         GL_BLEND_SRC_ALPHA,    GL_BLEND_DST_ALPHA,
                                                         GL_BLEND_EQUATION_RGB, GL_BLEND_EQUATION_ALPHA};

static void set_switch(const GladGLContext *gl, GLenum name, bool on) {
    (on ? gl->Enable : gl->Disable)(name);
}

static void set_defaults(const GladGLContext *gl) {
    for (int i = 0; i < ISO_GL_SWITCHES; i++) gl->Disable(switches[i]);
    for (int i = 0; i < ISO_GL_PIXEL_STORES; i++) gl->PixelStorei(pixel_stores[i], i % 4 == 0 ? 4 : 0);
    for (int i = 0; i < ISO_GL_BINDINGS; i++) gl->BindBuffer(bindings[i].target, 0);
    gl->DepthMask(GL_TRUE);
    gl->ColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
    gl->PolygonMode(GL_FRONT_AND_BACK, GL_FILL);
}

void iso_gl_state_save(iso_gl_state *state, const GladGLContext *gl) {
    for (int i = 0; i < ISO_GL_SWITCHES; i++) state->on[i] = gl->IsEnabled(switches[i]);
    for (int i = 0; i < ISO_GL_PIXEL_STORES; i++) gl->GetIntegerv(pixel_stores[i], &state->pixel_store[i]);
    for (int i = 0; i < ISO_GL_BINDINGS; i++) gl->GetIntegerv(bindings[i].name, &state->binding[i]);
    gl->GetIntegerv(GL_DRAW_FRAMEBUFFER_BINDING, &state->draw_framebuffer);
    gl->GetIntegerv(GL_READ_FRAMEBUFFER_BINDING, &state->read_framebuffer);
    gl->GetIntegerv(GL_CURRENT_PROGRAM, &state->program);
    gl->GetIntegerv(GL_VERTEX_ARRAY_BINDING, &state->array);
    gl->GetIntegerv(GL_VIEWPORT, state->viewport);
    gl->GetIntegerv(GL_SCISSOR_BOX, state->scissor);
    gl->GetIntegerv(GL_DEPTH_FUNC, &state->depth_func);
    gl->GetIntegerv(GL_CLIP_ORIGIN, &state->clip_origin);
    gl->GetIntegerv(GL_CLIP_DEPTH_MODE, &state->clip_depth);
    gl->GetIntegerv(GL_POLYGON_MODE, state->polygon_mode); /* compatibility profiles give two */
    gl->GetBooleanv(GL_DEPTH_WRITEMASK, &state->depth_mask);
    gl->GetBooleanv(GL_COLOR_WRITEMASK, state->color_mask);
    for (GLuint i = 0; i < ISO_GL_BLENDS; i++)
        for (int k = 0; k < ISO_GL_BLEND_VALUES; k++)
            gl->GetIntegeri_v(blend_values[k], i, &state->blend[i][k]);
    for (int i = 0; i < ISO_GL_ATTRIBUTES; i++)
        gl->GetVertexAttribfv(attributes[i], GL_CURRENT_VERTEX_ATTRIB, state->attribute[i]);
    set_defaults(gl);
}

static void unbind_slots(const GladGLContext *gl) {
    for (GLuint slot = 0; slot < ISO_GL_UNIFORM_SLOTS; slot++) gl->BindBufferBase(GL_UNIFORM_BUFFER, slot, 0);
    for (GLuint slot = 0; slot < ISO_GL_STORAGE_SLOTS; slot++)
        gl->BindBufferBase(GL_SHADER_STORAGE_BUFFER, slot, 0);
    gl->BindTextures(0, ISO_GL_TEXTURE_SLOTS, NULL);
    gl->BindImageTextures(0, ISO_GL_IMAGE_SLOTS, NULL);
}

void iso_gl_state_restore(const iso_gl_state *state, const GladGLContext *gl) {
    unbind_slots(gl);
    for (int i = 0; i < ISO_GL_SWITCHES; i++) set_switch(gl, switches[i], state->on[i]);
    for (int i = 0; i < ISO_GL_PIXEL_STORES; i++) gl->PixelStorei(pixel_stores[i], state->pixel_store[i]);
    for (int i = 0; i < ISO_GL_BINDINGS; i++) gl->BindBuffer(bindings[i].target, (GLuint)state->binding[i]);
    gl->BindFramebuffer(GL_DRAW_FRAMEBUFFER, (GLuint)state->draw_framebuffer);
    gl->BindFramebuffer(GL_READ_FRAMEBUFFER, (GLuint)state->read_framebuffer);
    gl->UseProgram((GLuint)state->program);
    gl->BindVertexArray((GLuint)state->array);
    gl->Viewport(state->viewport[0], state->viewport[1], state->viewport[2], state->viewport[3]);
    gl->Scissor(state->scissor[0], state->scissor[1], state->scissor[2], state->scissor[3]);
    gl->DepthFunc((GLenum)state->depth_func);
    gl->ClipControl((GLenum)state->clip_origin, (GLenum)state->clip_depth);
    gl->PolygonMode(GL_FRONT_AND_BACK, (GLenum)state->polygon_mode[0]);
    gl->DepthMask(state->depth_mask);
    gl->ColorMask(state->color_mask[0], state->color_mask[1], state->color_mask[2], state->color_mask[3]);
    for (GLuint i = 0; i < ISO_GL_BLENDS; i++) {
        const int *value = state->blend[i];
        gl->BlendFuncSeparatei(i, (GLenum)value[0], (GLenum)value[1], (GLenum)value[2], (GLenum)value[3]);
        gl->BlendEquationSeparatei(i, (GLenum)value[4], (GLenum)value[5]);
    }
    for (int i = 0; i < ISO_GL_ATTRIBUTES; i++) gl->VertexAttrib4fv(attributes[i], state->attribute[i]);
}
