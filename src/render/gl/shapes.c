/* shapes: draws lines and glyphs part by part into a framebuffer of their own, reads it back, and puts
 * what is nearer into the gbuffer.
 *
 * Blocks in sight are found by the cpu (render/shapes/frame.h), nearest first. Each is one draw command,
 * whose per-instance data is the block's origin in double precision less its pixel and depth: floats
 * suffice for what is relative to it. Shapes of blocks that are wide in the picture have an origin each;
 * those that the near plane cuts or that are huge in the picture are traced in double precision
 * (render/shapes/near.h). */
#include "render/gl/shapes.h"

#include <assert.h>
#include <float.h>
#include <glad/gl.h>
#include <math.h>
#include <string.h>

#include "render/gl/shapes_set.h"
#include "render/gl/shared.h"
#include "render/shapes/near.h"
#include "render/shapes/solid.h"

_Static_assert(offsetof(iso_gl_shaping_uniforms, turn_x) == 32 && sizeof(iso_gl_shaping_uniforms) == 160,
               "layout of std140");
_Static_assert(offsetof(iso_gl_near_shape, box) == 224 && sizeof(iso_gl_near_shape) == 288,
               "layout of std430");

static const size_t READ_BYTES = (size_t)8 << 20;
enum { TARGET_BYTES = 28 }; /* a pixel: RGBA32F, RG32UI, DEPTH_COMPONENT32F */

/* Per-instance data of a draw command: ISO_GL_SHAPE_PIXEL, .. */
typedef struct origin {
    float pixel[4], ray[4], from[3];
} origin;

/* The drawing of a picture. */
typedef struct shapes_call {
    iso_gl_engine *engine;
    const GladGLContext *gl;
    const iso_gl_shapes_opts *opts;
    double range[2];                           /* of depth, in parallel views */
    iso_buffer commands, origins, near_shapes; /* of one set in one part */
    size_t count, near_count;
    iso_shapes_drawn *drawn;
} shapes_call;

/* One set in one part of the picture. */
typedef struct set_draw {
    shapes_call *call;
    const iso_gl_shapes *shapes;
    const iso_view *view;
    iso_shapes_frame frame;
} set_draw;

/* ---- the framebuffer */

void iso_gl_shapes_target_free(iso_gl_shapes_target *target, const GladGLContext *gl) {
    iso_gl_target_free(&target->target, gl);
    gl->DeleteBuffers(1, &target->quads);
    gl->DeleteVertexArrays(1, &target->array);
    gl->DeleteVertexArrays(1, &target->empty_array);
    *target = (iso_gl_shapes_target){.quads = 0};
}

/* Indices of two triangles for each shape of a block. */
static void make_quads(iso_gl_shapes_target *target, const GladGLContext *gl) {
    static const uint16_t corners[6] = {0, 1, 2, 2, 1, 3};
    uint16_t indices[ISO_SHAPES_BLOCK * 6];
    for (int i = 0; i < ISO_SHAPES_BLOCK * 6; i++) indices[i] = (uint16_t)(4 * (i / 6) + corners[i % 6]);
    gl->CreateBuffers(1, &target->quads);
    gl->NamedBufferStorage(target->quads, sizeof indices, indices, 0);
}

static void make_arrays(const iso_gl_engine *engine, iso_gl_shapes_target *target, const GladGLContext *gl) {
    static const struct {
        GLuint slot, offset;
        GLint size;
    } inputs[] = {{ISO_GL_SHAPE_PIXEL, offsetof(origin, pixel), 4},
                  {ISO_GL_SHAPE_RAY, offsetof(origin, ray), 4},
                  {ISO_GL_SHAPE_FROM, offsetof(origin, from), 3}};
    if (target->array) return;
    make_quads(target, gl);
    gl->CreateVertexArrays(1, &target->empty_array);
    gl->CreateVertexArrays(1, &target->array);
    gl->VertexArrayElementBuffer(target->array, target->quads);
    gl->VertexArrayVertexBuffer(target->array, 0, engine->instances, 0, sizeof(origin));
    gl->VertexArrayBindingDivisor(target->array, 0, 1);
    for (int i = 0; i < 3; i++) {
        gl->EnableVertexArrayAttrib(target->array, inputs[i].slot);
        gl->VertexArrayAttribFormat(target->array, inputs[i].slot, inputs[i].size, GL_FLOAT, GL_FALSE,
                                    inputs[i].offset);
        gl->VertexArrayAttribBinding(target->array, inputs[i].slot, 0);
    }
}

/* Depth is reversed, as in engine.c. */
static void begin_part(const iso_gl_engine *engine, const iso_view *view) {
    const GladGLContext *gl = engine->context->gl;
    const GLfloat nothing[4] = {0, 0, -1, INFINITY}, far = 0;
    const GLuint none[4] = {0};
    gl->BindFramebuffer(GL_FRAMEBUFFER, engine->shapes.target.framebuffer);
    gl->ClipControl(GL_LOWER_LEFT, GL_ZERO_TO_ONE);
    gl->Viewport(0, 0, view->width, view->height);
    gl->Enable(GL_SCISSOR_TEST);
    gl->Scissor(0, 0, view->width, view->height);
    gl->Enable(GL_DEPTH_TEST);
    gl->DepthFunc(GL_GREATER);
    gl->ClearBufferfv(GL_COLOR, ISO_GL_NORMAL_DEPTH, nothing);
    gl->ClearBufferuiv(GL_COLOR, ISO_GL_IDS, none);
    gl->ClearBufferfv(GL_DEPTH, 0, &far);
}

/* ---- draw commands */

static iso_status append(iso_buffer *buffer, size_t index, const void *item, size_t bytes, iso_error *error) {
    ISO_TRY(iso_buffer_reserve(buffer, (index + 1) * bytes, index * bytes, error));
    memcpy((char *)buffer->data + index * bytes, item, bytes);
    return ISO_OK;
}

/* Adds a command that draws `count` shapes from `first` on, whose positions are relative to `from`. */
static iso_status add_command(set_draw *d, uint32_t first, uint32_t count, const iso_shapes_origin *o,
                              const float from[3], iso_error *error) {
    shapes_call *call = d->call;
    const iso_gl_mesh_command command = {6 * count, 1, 0, (int32_t)(4 * first), (uint32_t)call->count};
    const origin place = {{(float)o->column, (float)(o->row - d->frame.top), o->x, o->y},
                          {o->depth, o->rest, o->u, o->v},
                          {from[0], from[1], from[2]}};
    ISO_TRY(append(&call->commands, call->count, &command, sizeof command, error));
    ISO_TRY(append(&call->origins, call->count, &place, sizeof place, error));
    call->count++;
    return ISO_OK;
}

/* The box in the part of what lies between two corners in view space, at or behind the near plane; false: it
 * is outside. */
static bool box_between(const set_draw *d, const double low[3], const double high[3], float box[4]) {
    const iso_shapes_frame *frame = &d->frame;
    const double near = low[2] > frame->near ? low[2] : frame->near;
    if (!(high[2] >= near)) return false;
    for (int a = 0; a < 2; a++) {
        const double axis = a ? d->view->cy : d->view->cx, side = a ? d->view->height : d->view->width;
        const double least = frame->parallel ? low[a] : low[a] / (low[a] < 0 ? near : high[2]),
                     most = frame->parallel ? high[a] : high[a] / (high[a] > 0 ? near : high[2]);
        const double first = axis + frame->focal * least - 1, last = axis + frame->focal * most + 1;
        if (!(last >= 0 && first <= side)) return false;
        box[a] = (float)fmax(first, -1);
        box[a + 2] = (float)fmin(last, side + 1);
    }
    return true;
}

/* The corners around two points in view space and `reach` around them. */
typedef struct corners {
    double low[3], high[3];
} corners;

static corners corners_of(const double a[3], const double b[3], double reach) {
    corners c;
    for (int k = 0; k < 3; k++) {
        c.low[k] = fmin(a[k], b[k]) - reach;
        c.high[k] = fmax(a[k], b[k]) + reach;
    }
    return c;
}

/* The corners around a glyph: of the image of the cube around its unit solid. */
static corners solid_corners(const iso_solid_placed *placed) {
    corners c;
    for (int k = 0; k < 3; k++) {
        const double half = fabs(placed->axis[0][k]) + fabs(placed->axis[1][k]) + fabs(placed->axis[2][k]);
        c.low[k] = placed->centre[k] - half;
        c.high[k] = placed->centre[k] + half;
    }
    return c;
}

/* Adds a shape between two corners in view space. */
static iso_status add_near(set_draw *d, const iso_near_shape *shape, const double low[3],
                           const double high[3], iso_error *error) {
    shapes_call *call = d->call;
    const iso_shapes *set = d->shapes->set;
    const size_t last = (size_t)shape->id + iso_shapes_are_lines(set);
    const double front = low[2] - 1e-6 * (fabs(low[2]) + high[2] - low[2]);
    iso_gl_near_shape to = {.front = {(float)fmax(fmax(shape->nearest, front), -FLT_MAX)},
                            .numbers = {shape->id, iso_gl_shape_color(set, shape->id),
                                        iso_gl_shape_color(set, last), (unsigned)shape->flags}};
    if (!box_between(d, low, high, to.box)) return ISO_OK;
    for (int i = 0; i < 2; i++) {
        memcpy(to.ends[i], shape->end[i], sizeof shape->end[i]);
        to.ends[i][3] = shape->radius[i];
        memcpy(to.across[i], shape->across[i], sizeof shape->across[i]);
    }
    for (int i = 0; i < 3; i++) memcpy(to.inverse[i], shape->inverse[i], sizeof shape->inverse[i]);
    ISO_TRY(append(&call->near_shapes, call->near_count, &to, sizeof to, error));
    call->near_count++;
    return ISO_OK;
}

/* ---- shapes that are placed one by one */

static iso_status add_sphere(set_draw *d, const iso_shapes_block *block, uint32_t i, iso_error *error) {
    const iso_shapes_frame *frame = &d->frame;
    const iso_shapes *set = d->shapes->set;
    const float from[3] = {set->x[i], set->y[i], set->z[i]};
    const double position[3] = {(double)block->origin[0] + (double)from[0],
                                (double)block->origin[1] + (double)from[1],
                                (double)block->origin[2] + (double)from[2]};
    const double radius = (double)iso_shapes_radius(set, iso_shapes_id(set, i));
    double view[3];
    float box[4];
    iso_shapes_origin o;
    iso_shapes_to_view(frame, position, view);
    const corners c = corners_of(view, view, radius);
    if (!box_between(d, c.low, c.high, box)) return ISO_OK;
    if (iso_near_fits(frame, view[2] - radius, radius) && iso_shapes_origin_of(frame, view, &o))
        return add_command(d, i, 1, &o, from, error);
    const iso_near_shape shape = iso_near_sphere(frame, view, radius, iso_shapes_id(set, i));
    return add_near(d, &shape, c.low, c.high, error);
}

static iso_status add_solid(set_draw *d, const iso_shapes_block *block, uint32_t i, iso_error *error) {
    const iso_shapes_frame *frame = &d->frame;
    const iso_shapes *set = d->shapes->set;
    const double position[3] = {(double)block->origin[0] + (double)set->x[i],
                                (double)block->origin[1] + (double)set->y[i],
                                (double)block->origin[2] + (double)set->z[i]};
    iso_solid_map map;
    double view[3];
    float box[4], centre[3];
    iso_shapes_origin o;
    iso_shapes_to_view(frame, position, view);
    if (!iso_solid_map_of(set, iso_shapes_id(set, i), &map)) return ISO_OK; /* never: the set has none such */
    const iso_solid_placed placed = iso_solid_in_view(frame, &map, position);
    const corners c = solid_corners(&placed);
    if (!box_between(d, c.low, c.high, box)) return ISO_OK;
    const double reach = iso_solid_extent(set->glyph, &map);
    if (iso_solid_fits(frame, &placed, view[2], reach) && iso_shapes_origin_of(frame, placed.centre, &o)) {
        iso_gl_solid_centre(set, i, &map, centre);
        return add_command(d, i, 1, &o, centre, error);
    }
    const iso_near_shape shape = iso_solid_near(frame, &placed, iso_shapes_id(set, i));
    return add_near(d, &shape, c.low, c.high, error);
}

/* index: of the segment on the GPU. */
static iso_status add_segment(set_draw *d, uint32_t index, uint32_t id, int flags, iso_error *error) {
    const iso_shapes_frame *frame = &d->frame;
    const iso_near_shape shape = iso_near_segment(frame, id, flags);
    const double reach = fmax(shape.radius[0], shape.radius[1]),
                 front = fmin(shape.end[0][2], shape.end[1][2]) - reach;
    float box[4];
    iso_shapes_origin o;
    const corners c = corners_of(shape.end[0], shape.end[1], reach);
    if (!(reach > 0) || !box_between(d, c.low, c.high, box)) return ISO_OK;
    if (iso_near_fits(frame, front, reach) && iso_shapes_origin_of(frame, shape.end[0], &o))
        return add_command(d, index, 1, &o, d->shapes->set->vertices[id], error);
    return add_near(d, &shape, c.low, c.high, error);
}

static iso_status add_segments(set_draw *d, uint32_t block, iso_error *error) {
    const iso_shapes *set = d->shapes->set;
    int32_t ids[ISO_SHAPES_BLOCK], flags[ISO_SHAPES_BLOCK];
    const int count = iso_shapes_list_segments(set, &set->blocks[block], ids, flags);
    for (int i = 0; i < count; i++)
        ISO_TRY(add_segment(d, d->shapes->starts[block] + (uint32_t)i, (uint32_t)ids[i], flags[i], error));
    return ISO_OK;
}

/* ---- blocks */

/* Shapes of a block on the GPU. */
static uint32_t count_of(const iso_shapes *set, const iso_shapes_block *block) {
    uint32_t count = 0;
    if (!iso_shapes_are_lines(set)) return block->count;
    for (uint32_t i = block->first; i < block->first + block->count; i++) count += set->runs.length[i];
    return count;
}

static iso_status add_block(set_draw *d, const iso_shapes_seen *seen, iso_error *error) {
    static const float nowhere[3] = {0, 0, 0};
    const iso_shapes *set = d->shapes->set;
    const iso_shapes_block *block = &set->blocks[seen->block];
    const bool lines = iso_shapes_are_lines(set);
    iso_shapes_origin o;
    if (!seen->apart && iso_shapes_origin_of(&d->frame, seen->centre, &o))
        return add_command(d, d->shapes->starts[seen->block], count_of(set, block), &o,
                           lines ? block->origin : nowhere, error);
    if (lines) return add_segments(d, seen->block, error);
    for (uint32_t i = block->first; i < block->first + block->count; i++)
        ISO_TRY(set->kind == ISO_SHAPE_SPHERE ? add_sphere(d, block, i, error)
                                              : add_solid(d, block, i, error));
    return ISO_OK;
}

/* ---- one set */

static void upload_uniforms(const set_draw *d, int number) {
    const iso_shapes_frame *f = &d->frame;
    const iso_view *view = d->view;
    const shapes_call *call = d->call;
    const bool lines = iso_shapes_are_lines(f->shapes);
    iso_gl_shaping_uniforms u = {
        .camera = {view->cx, view->cy, f->focal, f->near},
        .lens = {(float)view->cx, (float)view->cy, f->length, f->parallel ? 0 : (float)f->near},
        .rays = {f->slope, f->spread, f->fixed},
        .least = {lines ? (float)f->least_slope : 0, lines ? (float)f->least_fixed : 0, (float)call->range[1],
                  (float)(1 / (call->range[1] - call->range[0]))},
        .screen = {(float)view->width, (float)view->height},
        .set = {number, f->shapes->colors != NULL, f->parallel}};
    memcpy(u.turn_x, f->turn, 3 * sizeof(float));
    memcpy(u.turn_y, f->turn + 3, 3 * sizeof(float));
    memcpy(u.turn_z, f->turn + 6, 3 * sizeof(float));
    iso_gl_engine_ensure_storage(call->engine, ISO_GL_STORE_SHAPING, sizeof u);
    call->gl->NamedBufferSubData(call->engine->storage[ISO_GL_STORE_SHAPING], 0, sizeof u, &u);
    call->gl->BindBufferBase(GL_UNIFORM_BUFFER, ISO_GL_SHAPING, call->engine->storage[ISO_GL_STORE_SHAPING]);
}

/* The program of the set's kind, counted from the one for spheres. */
static iso_status use_program(const set_draw *d, iso_gl_program spheres, iso_error *error) {
    const iso_shapes *set = d->shapes->set;
    const int kind = (int)set->kind, solid = kind == ISO_SHAPE_SOLID ? (int)set->glyph - ISO_GLYPH_CONE : 0;
    unsigned name;
    ISO_TRY(
        iso_gl_engine_program(d->call->engine, (iso_gl_program)((int)spheres + kind + solid), &name, error));
    d->call->gl->UseProgram(name);
    return ISO_OK;
}

static iso_status execute_commands(const set_draw *d, iso_error *error) {
    const shapes_call *call = d->call;
    const iso_gl_engine *engine = call->engine;
    const GladGLContext *gl = call->gl;
    const iso_gl_shapes *shapes = d->shapes;
    if (!call->count) return ISO_OK;
    ISO_TRY(use_program(d, ISO_GL_DRAW_SHAPES, error));
    gl->NamedBufferData(engine->commands, (GLsizeiptr)(call->count * sizeof(iso_gl_mesh_command)),
                        call->commands.data, GL_STREAM_DRAW);
    gl->NamedBufferData(engine->instances, (GLsizeiptr)(call->count * sizeof(origin)), call->origins.data,
                        GL_STREAM_DRAW);
    gl->BindBufferBase(GL_SHADER_STORAGE_BUFFER, ISO_GL_SHAPES, shapes->data);
    gl->BindBufferBase(GL_SHADER_STORAGE_BUFFER, ISO_GL_MARKS, shapes->marks);
    gl->BindBufferBase(GL_SHADER_STORAGE_BUFFER, ISO_GL_LINE_COLORS, shapes->colors);
    gl->BindBuffer(GL_DRAW_INDIRECT_BUFFER, engine->commands);
    gl->BindVertexArray(engine->shapes.array);
    gl->MultiDrawElementsIndirect(GL_TRIANGLES, GL_UNSIGNED_SHORT, NULL, (GLsizei)call->count, 0);
    return ISO_OK;
}

static iso_status draw_near_shapes(const set_draw *d, iso_error *error) {
    const shapes_call *call = d->call;
    iso_gl_engine *engine = call->engine;
    const size_t bytes = call->near_count * sizeof(iso_gl_near_shape);
    if (!call->near_count) return ISO_OK;
    ISO_TRY(use_program(d, ISO_GL_DRAW_NEAR_SHAPES, error));
    iso_gl_engine_ensure_storage(engine, ISO_GL_STORE_NEAR_SHAPES, bytes);
    call->gl->NamedBufferSubData(engine->storage[ISO_GL_STORE_NEAR_SHAPES], 0, (GLsizeiptr)bytes,
                                 call->near_shapes.data);
    call->gl->BindBufferBase(GL_SHADER_STORAGE_BUFFER, ISO_GL_NEAR_SHAPES,
                             engine->storage[ISO_GL_STORE_NEAR_SHAPES]);
    call->gl->BindVertexArray(engine->shapes.empty_array);
    call->gl->DrawArraysInstanced(GL_TRIANGLE_STRIP, 0, 4, (GLsizei)call->near_count);
    return ISO_OK;
}

static iso_status draw_seen(set_draw *d, int number, iso_error *error) {
    d->call->count = d->call->near_count = 0;
    for (size_t i = 0; i < d->frame.seen_count; i++) ISO_TRY(add_block(d, &d->frame.seen[i], error));
    upload_uniforms(d, number);
    ISO_TRY(draw_near_shapes(d, error)); /* first: they hide the most */
    return execute_commands(d, error);
}

static iso_status draw_set(shapes_call *call, const iso_view *view, int index, iso_error *error) {
    const iso_target target = {.view = view};
    set_draw d = {.call = call, .shapes = call->opts->sets[index], .view = view};
    iso_status status = iso_shapes_frame_see(&target, d.shapes->set, &d.frame, error);
    if (status == ISO_OK) status = draw_seen(&d, call->opts->first_surface + index, error);
    iso_shapes_frame_free(&d.frame);
    return status;
}

/* ---- reading back */

/* Puts a pixel into the gbuffer if it is nearer than the sample there. ids: shapes_ids.glsl. */
static void put_sample(const shapes_call *call, const iso_gbuffer *to, size_t sample, const float pixel[4],
                       const uint32_t ids[2]) {
    if (!(pixel[3] < to->depth[sample])) return;
    const int surface = (int)(ids[0] >> 24) - 1, index = surface - call->opts->first_surface;
    const iso_shapes *set = call->opts->sets[index]->set;
    const bool line = iso_shapes_are_lines(set);
    for (int axis = 0; axis < 3; axis++) to->normal[axis][sample] = pixel[axis];
    to->depth[sample] = pixel[3];
    to->surface[sample] = (uint8_t)surface;
    if (set->colors) to->color[sample] = ids[0];
    if (to->element) to->element[sample] = line ? ids[1] & 0x7FFFFFFFu : ids[1];
    if (!call->drawn) return;
    call->drawn[index].samples++;
    call->drawn[index].widened += line && ids[1] >> 31;
}

/* The first sample of a part in the picture. */
typedef struct part_origin {
    int x, y;
} part_origin;

static iso_status read_part(const shapes_call *call, const iso_view *view, part_origin at,
                            const iso_gbuffer *to, iso_error *error) {
    enum { PIXEL = 4 * sizeof(float) + 2 * sizeof(uint32_t) };
    const GladGLContext *gl = call->gl;
    const iso_gl_target *target = &call->engine->shapes.target;
    const size_t row = (size_t)view->width * PIXEL;
    int step = row < READ_BYTES ? (int)(READ_BYTES / row) : 1;
    if (step > view->height) step = view->height;
    float *pixels = iso_alloc(row * (size_t)step);
    if (!pixels) return iso_fail(error, ISO_ERR_NOMEM, "out of memory to read a picture back");
    uint32_t *ids = (uint32_t *)(pixels + 4 * (size_t)view->width * (size_t)step);
    for (int y = 0; y < view->height; y += step) {
        const int rows = view->height - y < step ? view->height - y : step;
        gl->NamedFramebufferReadBuffer(target->framebuffer, GL_COLOR_ATTACHMENT0 + ISO_GL_NORMAL_DEPTH);
        gl->ReadPixels(0, y, view->width, rows, GL_RGBA, GL_FLOAT, pixels);
        gl->NamedFramebufferReadBuffer(target->framebuffer, GL_COLOR_ATTACHMENT0 + ISO_GL_IDS);
        gl->ReadPixels(0, y, view->width, rows, GL_RG_INTEGER, GL_UNSIGNED_INT, ids);
        for (size_t i = 0; i < (size_t)rows * (size_t)view->width; i++) {
            const size_t x = i % (size_t)view->width, down = i / (size_t)view->width;
            put_sample(call, to, ((size_t)(at.y + y) + down) * (size_t)to->width + (size_t)at.x + x,
                       pixels + 4 * i, ids + 2 * i);
        }
    }
    iso_free(pixels);
    return ISO_OK;
}

/* ---- the picture */

/* Range of depths of all sets, a little widened. */
static void depth_range(const iso_gl_shapes_opts *opts, double range[2]) {
    const iso_view *view = opts->view;
    iso_vec3 rows[3];
    iso_box all = iso_box_empty();
    for (int a = 0; a < 3; a++)
        rows[a] = iso_vec3_make(view->rotation[3 * a], view->rotation[3 * a + 1], view->rotation[3 * a + 2]);
    const double eye = iso_vec3_dot(rows[2], view->eye);
    double width = 0;
    for (int i = 0; i < opts->set_count; i++) {
        const iso_shapes *set = opts->sets[i]->set;
        const iso_box box = iso_shapes_bounds_along(set, rows);
        if (iso_box_is_empty(&box)) continue;
        iso_box_add(&all, box.lo);
        iso_box_add(&all, box.hi);
        width = fmax(width, set->min_pixels / view->focal);
    }
    const double low = iso_box_is_empty(&all) ? 0 : all.lo.z - eye,
                 high = iso_box_is_empty(&all) ? 0 : all.hi.z - eye,
                 slack = 1e-3 * (high - low) + 1e-6 * fabs(high) + width + 1e-6;
    range[0] = fmax(low - slack, view->near < high ? view->near : -INFINITY);
    range[1] = high + slack;
}

static iso_status draw_part(shapes_call *call, const iso_view *view, part_origin at, const iso_gbuffer *to,
                            iso_error *error) {
    iso_gl_timer *timer = &call->engine->timer;
    iso_gl_engine *engine = call->engine;
    make_arrays(engine, &engine->shapes, call->gl);
    ISO_TRY(iso_gl_target_ensure(&engine->shapes.target, engine->context, GL_RG32UI, view->width,
                                 view->height, error));
    begin_part(call->engine, view);
    iso_gl_timer_begin(timer, call->gl, ISO_GL_PASS_DRAW);
    iso_status status = ISO_OK;
    for (int i = 0; i < call->opts->set_count && status == ISO_OK; i++)
        status = draw_set(call, view, i, error);
    iso_gl_timer_end(timer, call->gl);
    ISO_TRY(status);
    ISO_TRY(read_part(call, view, at, to, error));
    iso_gl_timer_read(timer, call->gl);
    return iso_gl_check(call->engine->context, error); /* stop when the context is lost */
}

static iso_status draw_parts(shapes_call *call, const iso_gbuffer *to, iso_error *error) {
    const iso_view *whole = call->opts->view;
    const int side = call->engine->max_side;
    for (int y = 0; y < whole->height; y += side)
        for (int x = 0; x < whole->width; x += side) {
            iso_view view = iso_view_rows(whole, y, whole->height - y < side ? whole->height - y : side);
            view.cx -= x;
            view.width = whole->width - x < side ? whole->width - x : side;
            ISO_TRY(draw_part(call, &view, (part_origin){x, y}, to, error));
        }
    return ISO_OK;
}

iso_status iso_gl_draw_shapes(iso_gl_engine *engine, const iso_gl_shapes_opts *opts, iso_gbuffer *gbuffer,
                              iso_shapes_drawn *drawn, iso_error *error) {
    assert(opts->view->width == gbuffer->width && opts->view->height == gbuffer->height);
    assert(opts->first_surface >= 0 && opts->first_surface + opts->set_count <= ISO_SURFACE_MAX);
    shapes_call call = {.engine = engine, .gl = engine->context->gl, .opts = opts, .drawn = drawn};
    if (!opts->set_count) return ISO_OK;
    for (int i = 0; i < opts->set_count; i++)
        if (opts->sets[i]->set->colors) ISO_TRY(iso_gbuffer_add_color(gbuffer, error));
    depth_range(opts, call.range);
    ISO_TRY(iso_gl_enter(engine->context, error));
    const iso_status status = draw_parts(&call, gbuffer, error);
    iso_buffer_free(&call.commands);
    iso_buffer_free(&call.origins);
    iso_buffer_free(&call.near_shapes);
    return iso_gl_leave(engine->context, status, error);
}

uint64_t iso_gl_shapes_bytes(const iso_gl_engine *engine, int width, int height) {
    const uint64_t side = (uint64_t)engine->max_side, w = (uint64_t)width, h = (uint64_t)height;
    return (w < side ? w : side) * (h < side ? h : side) * TARGET_BYTES + READ_BYTES;
}
