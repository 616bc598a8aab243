/* picture: clears the picture buffer and reads it back. */
#include "render/gl/picture.h"

#include <glad/gl.h>
#include <math.h>

#include "render/gl/shared.h"

void iso_gl_picture_clear(const iso_gl_engine *engine, size_t planes, size_t samples) {
    const float far = INFINITY;
    const GLuint none = ISO_SURFACE_NONE, zero = 0, picture = engine->storage[ISO_GL_STORE_PICTURE];
    const GladGLContext *gl = engine->context->gl;
    const size_t plane = samples * sizeof(float);
    gl->MemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT); /* shaders may still write the picture before */
    gl->ClearNamedBufferSubData(picture, GL_R32UI, 0, (GLsizeiptr)(planes * plane), GL_RED_INTEGER,
                                GL_UNSIGNED_INT, &zero);
    gl->ClearNamedBufferSubData(picture, GL_R32F, 0, (GLsizeiptr)plane, GL_RED, GL_FLOAT, &far);
    gl->ClearNamedBufferSubData(picture, GL_R32UI, (GLintptr)(4 * plane), (GLsizeiptr)plane, GL_RED_INTEGER,
                                GL_UNSIGNED_INT, &none);
}

iso_status iso_gl_picture_write(const iso_gl_engine *engine, size_t planes, const iso_gbuffer *from,
                                size_t start, size_t samples, iso_buffer *room, iso_error *error) {
    const GladGLContext *gl = engine->context->gl;
    const size_t bytes = samples * sizeof(float);
    ISO_TRY(iso_buffer_reserve(room, bytes, 0, error));
    uint32_t *surfaces = room->data;
    for (size_t i = 0; i < samples; i++) surfaces[i] = from->surface[start + i];
    const void *plane[] = {from->depth + start,
                           from->normal[0] + start,
                           from->normal[1] + start,
                           from->normal[2] + start,
                           surfaces,
                           from->color ? from->color + start : NULL};
    gl->MemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT); /* shaders may still write the picture before */
    for (size_t k = 0; k < planes; k++)
        gl->NamedBufferSubData(engine->storage[ISO_GL_STORE_PICTURE], (GLintptr)(k * bytes),
                               (GLsizeiptr)bytes, plane[k]);
    return ISO_OK;
}

iso_status iso_gl_picture_read(const iso_gl_engine *engine, size_t planes, const iso_gbuffer *to,
                               size_t start, size_t samples, iso_buffer *room, iso_error *error) {
    const GladGLContext *gl = engine->context->gl;
    const size_t bytes = samples * sizeof(float);
    float *plane[4] = {to->depth, to->normal[0], to->normal[1], to->normal[2]};
    const GLuint picture = engine->storage[ISO_GL_STORE_PICTURE];
    ISO_TRY(iso_buffer_reserve(room, bytes, 0, error));
    gl->MemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
    for (int k = 0; k < 4; k++)
        gl->GetNamedBufferSubData(picture, (GLintptr)((size_t)k * bytes), (GLsizeiptr)bytes,
                                  plane[k] + start);
    gl->GetNamedBufferSubData(picture, (GLintptr)(4 * bytes), (GLsizeiptr)bytes, room->data);
    const uint32_t *surfaces = room->data;
    for (size_t i = 0; i < samples; i++) to->surface[start + i] = (uint8_t)surfaces[i];
    if (planes > ISO_GL_PICTURE_PLANES)
        gl->GetNamedBufferSubData(picture, (GLintptr)(5 * bytes), (GLsizeiptr)bytes, to->color + start);
    return ISO_OK;
}
