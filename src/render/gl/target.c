/* Makes framebuffers, and replaces them by larger ones. */
#include "render/gl/target.h"

#include <glad/gl.h>

#include "render/gl/shared.h"
#include "render/gl/surface.h"

void iso_gl_target_free(iso_gl_target *target, const GladGLContext *gl) {
    gl->DeleteTextures(2, target->colors); /* 0 is ignored */
    gl->DeleteTextures(1, &target->depth);
    gl->DeleteFramebuffers(1, &target->framebuffer);
    *target = (iso_gl_target){.width = 0};
}

iso_status iso_gl_target_ensure(iso_gl_target *target, const iso_gl_context *context, unsigned format,
                                int width, int height, iso_error *error) {
    static const GLenum outputs[] = {GL_COLOR_ATTACHMENT0, GL_COLOR_ATTACHMENT1};
    const GladGLContext *gl = context->gl;
    if (target->framebuffer && target->width >= width && target->height >= height) return ISO_OK;
    if (width < target->width) width = target->width;
    if (height < target->height) height = target->height;
    iso_gl_target_free(target, gl);
    target->colors[ISO_GL_NORMAL_DEPTH] = iso_gl_make_texture(gl, GL_RGBA32F, width, height);
    target->colors[1] = iso_gl_make_texture(gl, format, width, height);
    target->depth = iso_gl_make_texture(gl, GL_DEPTH_COMPONENT32F, width, height);
    gl->CreateFramebuffers(1, &target->framebuffer);
    for (int i = 0; i < 2; i++)
        gl->NamedFramebufferTexture(target->framebuffer, outputs[i], target->colors[i], 0);
    gl->NamedFramebufferTexture(target->framebuffer, GL_DEPTH_ATTACHMENT, target->depth, 0);
    gl->NamedFramebufferDrawBuffers(target->framebuffer, 2, outputs);
    target->width = width;
    target->height = height;
    if (gl->CheckNamedFramebufferStatus(target->framebuffer, GL_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE)
        return ISO_OK;
    iso_gl_target_free(target, gl);
    return iso_fail(error, ISO_ERR_BACKEND, "%s: no framebuffer of %d x %d pixels", context->name, width,
                    height);
}
