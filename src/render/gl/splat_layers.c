/* splat_layers: finds the layers of translucent splats by compute shaders (shaders/splats_layers.comp):
 * lists the discs of each tile of a picture, uploads discs and lists, and reads back for each sample the mean
 * of the groups' pictures and, for algorithm 3, the nearest layer (Zhang and Pajarola 2006;
 * render/splats/layers.h). */
#include <assert.h>
#include <glad/gl.h>
#include <math.h>
#include <string.h>

#include "render/gl/shared.h"
#include "render/gl/splat.h"
#include "render/gl/splats.h"
#include "render/gl/surface.h"
#include "render/splats/layer_lists.h"

/* Limit of the storage buffers of samples; a larger strip is drawn in parts. */
static const size_t STORAGE_BYTES = (size_t)256 << 20;

static const uint32_t NOT_UPLOADED = UINT32_MAX;

/* What a disc looks like: shaded colour and opacity; the thickness of its layer. */
typedef struct look {
    float color[3], opacity, thickness, unused[3];
} look;
_Static_assert(sizeof(look) == 32, "layout of std430");
_Static_assert(ISO_GL_MOST_GROUPS == ISO_GROUPS_MOST, "the same limit");

/* A part of a strip, and working memory. */
typedef struct layers_call {
    iso_gl_engine *engine;
    const GladGLContext *gl;
    const iso_splat_layers *input;
    iso_view view;  /* of the part */
    int row;        /* the part's first row in the strip */
    size_t samples; /* of the part */
    iso_splat_surface surface;
    int across, down;                       /* tiles */
    iso_buffer splats, looks;               /* the discs that the part shows */
    iso_buffer numbers;                     /* uint32_t for each disc: its number among them */
    iso_buffer starts, next, order, bounds; /* lists of the tiles; depths of the samples */
    iso_buffer layers;                      /* read back */
    size_t count;                           /* of splats */
} layers_call;

/* ---- lists of tiles */

/* Returns the tile columns that a disc may cover in a row of tiles; none when first > last. */
static iso_rows tile_columns(const layers_call *call, const iso_discs *discs, uint32_t disc, int band) {
    const iso_disc_box within = {{0, call->view.width - 1}, iso_discs_band(discs, (size_t)band)},
                       box =
                           iso_disc_bounds(&discs->view, (const iso_disc *)discs->disc.data + disc, &within);
    if (box.columns.first > box.columns.last || box.rows.first > box.rows.last) return (iso_rows){0, -1};
    return (iso_rows){box.columns.first / ISO_GL_SPLAT_TILE, box.columns.last / ISO_GL_SPLAT_TILE};
}

/* Visits every disc of every tile, in the discs' order: counts it by tile and group in `next`, or writes its
 * number to the place that `next` says. */
static void visit_tiles(const layers_call *call, const iso_discs *discs, uint32_t *next, uint32_t *order) {
    const iso_groups *groups = call->surface.input->groups;
    const iso_disc *disc = discs->disc.data;
    const uint32_t *sorted = discs->order.data, *numbers = call->numbers.data;
    const size_t *start = discs->start.data;
    for (int band = 0; band < discs->bands; band++)
        for (size_t i = start[band]; i < start[band + 1]; i++) {
            const iso_rows columns = tile_columns(call, discs, sorted[i], band);
            const uint8_t group = groups->group[disc[sorted[i]].point];
            for (int x = columns.first; x <= columns.last; x++) {
                uint32_t *at = &next[(size_t)(band * call->across + x) * (size_t)groups->count + group];
                if (order) order[*at] = numbers[sorted[i]];
                ++*at;
            }
        }
}

/* Lists the discs of each tile, group by group. */
static iso_status list_tiles(layers_call *call, const iso_discs *discs, iso_error *error) {
    const size_t groups = (size_t)call->surface.input->groups->count,
                 tiles = (size_t)call->across * (size_t)call->down, lists = tiles * groups;
    ISO_TRY(iso_buffer_reserve(&call->starts, (tiles + 1) * sizeof(uint32_t), 0, error));
    ISO_TRY(iso_buffer_reserve(&call->next, lists * sizeof(uint32_t), 0, error));
    uint32_t *starts = call->starts.data, *next = call->next.data;
    size_t total = 0;
    memset(next, 0, lists * sizeof *next);
    visit_tiles(call, discs, next, NULL);
    for (size_t i = 0; i < lists; i++) {
        const size_t count = next[i];
        if (i % groups == 0) starts[i / groups] = (uint32_t)total;
        next[i] = (uint32_t)total;
        total += count;
        if (total > UINT32_MAX - 1)
            return iso_fail(error, ISO_ERR_LIMIT, "2^32 - 1 discs or more in the tiles of a picture");
    }
    starts[tiles] = (uint32_t)total;
    ISO_TRY(iso_buffer_reserve(&call->order, (total + 1) * sizeof(uint32_t), 0, error));
    visit_tiles(call, discs, next, call->order.data);
    return ISO_OK;
}

/* ---- discs */

static look look_of(const layers_call *call, const iso_disc *wide, const iso_disc *disc) {
    const iso_point_view *points = &call->surface.input->points;
    const uint8_t *rgb = points->colors ? points->colors[disc->point] : NULL;
    const iso_fragment shaded =
        iso_splat_fragment(&call->surface, wide->normal, wide->z, rgb, wide->x, wide->y);
    return (look){{shaded.color[0], shaded.color[1], shaded.color[2]},
                  shaded.opacity,
                  iso_splat_thickness(disc),
                  {0, 0, 0}};
}

/* Makes the splats of the discs that the part shows, and their looks. */
static iso_status gather_splats(layers_call *call, const iso_discs *discs, iso_error *error) {
    const iso_splat_layer *layer = call->surface.input;
    const iso_disc *disc = discs->disc.data, *usual = call->surface.discs.disc.data;
    const iso_rows *rows = discs->rows.data;
    ISO_TRY(iso_buffer_reserve(&call->splats, discs->count * sizeof(iso_gl_splat), 0, error));
    ISO_TRY(iso_buffer_reserve(&call->looks, discs->count * sizeof(look), 0, error));
    ISO_TRY(iso_buffer_reserve(&call->numbers, discs->count * sizeof(uint32_t), 0, error));
    iso_gl_splat *splats = call->splats.data;
    look *looks = call->looks.data;
    uint32_t *numbers = call->numbers.data;
    call->count = 0;
    for (size_t i = 0; i < discs->count; i++) {
        numbers[i] = NOT_UPLOADED;
        if (rows[i].first > rows[i].last) continue;
        const iso_disc *d = &disc[i];
        numbers[i] = (uint32_t)call->count;
        looks[call->count] = look_of(call, d, &usual[i]);
        splats[call->count++] = iso_gl_splat_make(d, &layer->points, layer->groups);
    }
    return ISO_OK;
}

/* ---- one pass of shaders */

static iso_status fill(const layers_call *call, iso_gl_storage which, const void *data, size_t bytes,
                       iso_error *error) {
    if (bytes > call->engine->max_storage)
        return iso_fail(error, ISO_ERR_LIMIT, "%s: %zu bytes of discs do not fit into a storage buffer of %s",
                        call->engine->context->name, bytes, call->engine->context->renderer);
    iso_gl_engine_ensure_storage(call->engine, which, bytes ? bytes : 1);
    if (bytes) call->gl->NamedBufferSubData(call->engine->storage[which], 0, (GLsizeiptr)bytes, data);
    return ISO_OK;
}

static iso_status upload(const layers_call *call, iso_error *error) {
    const iso_splat_surface *surface = &call->surface;
    const iso_disc_view *rays = &surface->discs.view;
    const size_t tiles = (size_t)call->across * (size_t)call->down;
    const uint32_t *starts = call->starts.data;
    const iso_gl_splatting_uniforms u = {
        .axis = {(float)call->view.cx, (float)call->view.cy},
        .rays = {rays->slope, rays->scale, rays->near, ISO_SPLATS_THICKNESS / ISO_SPLATS_DISC},
        .picture = {call->view.width, call->view.height},
        .counts = {(int)call->count, surface->input->groups->count, surface->input->points.colors != NULL},
        .layers = {surface->bin}};
    ISO_TRY(fill(call, ISO_GL_STORE_SPLATTING, &u, sizeof u, error));
    ISO_TRY(fill(call, ISO_GL_STORE_SPLATS, call->splats.data, call->count * sizeof(iso_gl_splat), error));
    ISO_TRY(fill(call, ISO_GL_STORE_LOOKS, call->looks.data, call->count * sizeof(look), error));
    ISO_TRY(fill(call, ISO_GL_STORE_TILE_STARTS, starts, (tiles + 1) * sizeof *starts, error));
    return fill(call, ISO_GL_STORE_TILE_DISCS, call->order.data, starts[tiles] * sizeof(uint32_t), error);
}

static iso_status run(const layers_call *call, iso_gl_program program, iso_error *error) {
    const unsigned *storage = call->engine->storage;
    const GladGLContext *gl = call->gl;
    unsigned name;
    ISO_TRY(iso_gl_engine_program(call->engine, program, &name, error));
    gl->BindBufferBase(GL_UNIFORM_BUFFER, ISO_GL_SPLATTING, storage[ISO_GL_STORE_SPLATTING]);
    gl->BindBufferBase(GL_SHADER_STORAGE_BUFFER, ISO_GL_SPLATS, storage[ISO_GL_STORE_SPLATS]);
    gl->BindBufferBase(GL_SHADER_STORAGE_BUFFER, ISO_GL_LOOKS, storage[ISO_GL_STORE_LOOKS]);
    gl->BindBufferBase(GL_SHADER_STORAGE_BUFFER, ISO_GL_TILE_STARTS, storage[ISO_GL_STORE_TILE_STARTS]);
    gl->BindBufferBase(GL_SHADER_STORAGE_BUFFER, ISO_GL_TILE_DISCS, storage[ISO_GL_STORE_TILE_DISCS]);
    gl->BindBufferBase(GL_SHADER_STORAGE_BUFFER, ISO_GL_LAYER_BOUNDS, storage[ISO_GL_STORE_LAYER_BOUNDS]);
    gl->BindBufferBase(GL_SHADER_STORAGE_BUFFER, ISO_GL_LAYERS, storage[ISO_GL_STORE_LAYERS]);
    gl->UseProgram(name);
    gl->DispatchCompute((GLuint)call->across, (GLuint)call->down, 1);
    gl->MemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT | GL_BUFFER_UPDATE_BARRIER_BIT);
    return ISO_OK;
}

/* Lists and uploads the discs, runs a program for all samples, and reads their layers back. */
static iso_status find_layers(layers_call *call, const iso_discs *discs, iso_gl_program program,
                              iso_error *error) {
    const size_t bytes = call->samples * ISO_GL_LAYER_FLOATS * sizeof(float);
    ISO_TRY(gather_splats(call, discs, error));
    ISO_TRY(list_tiles(call, discs, error));
    ISO_TRY(upload(call, error));
    iso_gl_engine_ensure_storage(call->engine, ISO_GL_STORE_LAYERS, bytes);
    ISO_TRY(run(call, program, error));
    ISO_TRY(iso_buffer_reserve(&call->layers, bytes, 0, error));
    call->gl->GetNamedBufferSubData(call->engine->storage[ISO_GL_STORE_LAYERS], 0, (GLsizeiptr)bytes,
                                    call->layers.data);
    return iso_gl_check(call->engine->context, error);
}

/* ---- layers of a part */

/* Sets the depths between which discs are drawn: before what is opaque. */
static iso_status set_bounds(layers_call *call, iso_error *error) {
    const iso_gbuffer *opaque = call->input->picture.strip->gbuffer;
    const size_t first = (size_t)call->row * (size_t)call->view.width,
                 bytes = 2 * call->samples * sizeof(float);
    ISO_TRY(iso_buffer_reserve(&call->bounds, bytes, 0, error));
    float *bounds = call->bounds.data;
    for (size_t i = 0; i < call->samples; i++) {
        const float limit = opaque->depth ? opaque->depth[first + i] : INFINITY;
        bounds[2 * i] = (float)-ISO_GL_NOWHERE;
        bounds[2 * i + 1] = limit < (float)ISO_GL_NOWHERE ? limit : (float)ISO_GL_NOWHERE;
    }
    return fill(call, ISO_GL_STORE_LAYER_BOUNDS, bounds, bytes, error);
}

/* Shades the nearest layers, and puts them into the strip's samples. */
static iso_status find_nearest(layers_call *call, iso_packed_fragment *to, iso_error *error) {
    ISO_TRY(find_layers(call, &call->surface.discs, ISO_GL_SPLAT_NEAREST, error));
    const float(*found)[ISO_GL_LAYER_FLOATS] = call->layers.data;
    for (size_t i = 0; i < call->samples; i++) {
        const float *f = found[i];
        const int x = (int)(i % (size_t)call->view.width), y = (int)(i / (size_t)call->view.width);
        const iso_splat_sums sums = {f[3], f[7], {f[0], f[1], f[2]}, {f[4], f[5], f[6]}};
        to[i] = (iso_packed_fragment){0};
        if (!(sums.weight > 0)) continue;
        const iso_fragment fragment =
            iso_splat_mean_fragment(&call->surface, &sums, iso_disc_column(&call->surface.discs.view, x),
                                    iso_disc_row(&call->surface.discs.view, y));
        to[i] = iso_fragment_pack(&fragment);
    }
    const size_t bytes = 2 * call->samples * sizeof(float);
    call->gl->GetNamedBufferSubData(call->engine->storage[ISO_GL_STORE_LAYER_BOUNDS], 0, (GLsizeiptr)bytes,
                                    call->bounds.data);
    return ISO_OK;
}

/* Puts the means of the groups' pictures into the strip's samples. They lie behind the nearest layer. */
static iso_status find_means(layers_call *call, iso_packed_fragment *to, iso_error *error) {
    ISO_TRY(find_layers(call, &call->surface.wide, ISO_GL_SPLAT_MEAN, error));
    const float(*found)[ISO_GL_LAYER_FLOATS] = call->layers.data;
    const float *bounds = call->bounds.data;
    for (size_t i = 0; i < call->samples; i++) {
        const float *f = found[i];
        const iso_fragment fragment = {.depth = f[4] < bounds[2 * i] ? bounds[2 * i] : f[4],
                                       .opacity = f[3],
                                       .color = {f[0], f[1], f[2]},
                                       .surface = call->surface.number};
        to[i] = iso_fragment_pack(&fragment);
    }
    return ISO_OK;
}

/* ---- strips */

/* Memory for the layers of a surface in a strip. */
typedef struct found_layers {
    iso_packed_fragment *nearest, *mean;
    iso_splat_images images;
} found_layers;

static iso_status find_part(layers_call *call, int number, const found_layers *found, iso_error *error) {
    const size_t first = (size_t)call->row * (size_t)call->view.width;
    const iso_splat_layer *layer = &call->input->layers[number];
    call->surface = (iso_splat_surface){.number = number};
    iso_status status = iso_splats_start_surface(layer, &call->view, false, ISO_GL_SPLAT_TILE,
                                                 call->input->picture.pool, &call->surface, error);
    if (status == ISO_OK) status = set_bounds(call, error);
    if (status == ISO_OK && found->nearest) status = find_nearest(call, found->nearest + first, error);
    if (status == ISO_OK) status = find_means(call, found->mean + first, error);
    iso_splats_end_surface(&call->surface);
    return status;
}

static iso_status find_in_parts(layers_call *call, found_layers *found, iso_error *error) {
    const iso_view *whole = call->input->picture.strip->view;
    const size_t most = call->engine->max_storage < STORAGE_BYTES ? call->engine->max_storage : STORAGE_BYTES,
                 row = (size_t)whole->width * ISO_GL_LAYER_FLOATS * sizeof(float);
    int rows = most / row < (size_t)whole->height ? (int)(most / row) : whole->height;
    if (rows > ISO_GL_SPLAT_TILE) rows -= rows % ISO_GL_SPLAT_TILE;
    if (rows < 1) rows = 1;
    for (call->row = 0; call->row < whole->height; call->row += rows) {
        call->view = iso_view_rows(whole, call->row,
                                   whole->height - call->row < rows ? whole->height - call->row : rows);
        call->samples = (size_t)call->view.width * (size_t)call->view.height;
        call->across = (call->view.width + ISO_GL_SPLAT_TILE - 1) / ISO_GL_SPLAT_TILE;
        call->down = (call->view.height + ISO_GL_SPLAT_TILE - 1) / ISO_GL_SPLAT_TILE;
        for (int i = 0; i < call->input->count; i++)
            if (call->input->layers[i].groups->count) ISO_TRY(find_part(call, i, &found[i], error));
    }
    return ISO_OK;
}

/* Allocates the layers of the surfaces; none are found yet. */
static iso_status allocate(const iso_splat_layers *input, found_layers *found, iso_splat_layer *layers,
                           iso_error *error) {
    const iso_view *view = input->picture.strip->view;
    const size_t samples = (size_t)view->width * (size_t)view->height;
    const bool nearest = input->transparency == ISO_TRANSPARENCY_NEAREST;
    for (int i = 0; i < input->count; i++) {
        found[i].mean = iso_alloc_zero(samples, sizeof *found[i].mean);
        found[i].nearest = nearest ? iso_alloc_zero(samples, sizeof *found[i].nearest) : NULL;
        if (!found[i].mean || (nearest && !found[i].nearest))
            return iso_fail(error, ISO_ERR_NOMEM, "out of memory for drawing layers");
        found[i].images = (iso_splat_images){found[i].nearest, found[i].mean};
        layers[i] = input->layers[i];
        layers[i].images = &found[i].images;
    }
    return ISO_OK;
}

static void free_call(layers_call *call) {
    iso_buffer *buffers[] = {&call->splats, &call->looks, &call->numbers, &call->starts,
                             &call->next,   &call->order, &call->bounds,  &call->layers};
    for (size_t i = 0; i < sizeof buffers / sizeof *buffers; i++) iso_buffer_free(buffers[i]);
}

iso_status iso_gl_shade_splat_layers(iso_gl_engine *engine, const iso_splat_layers *input,
                                     iso_layer_totals *totals, iso_error *error) {
    assert(input->transparency != ISO_TRANSPARENCY_SORTED && input->count <= ISO_LAYER_SURFACES);
    found_layers found[ISO_LAYER_SURFACES] = {0};
    iso_splat_layer layers[ISO_LAYER_SURFACES];
    layers_call call = {.engine = engine, .gl = engine->context->gl, .input = input};
    iso_splat_layers given = *input;
    given.layers = layers;
    iso_status status = allocate(input, found, layers, error);
    if (status == ISO_OK) {
        status = iso_gl_enter(engine->context, error);
        if (status == ISO_OK)
            status = iso_gl_leave(engine->context, find_in_parts(&call, found, error), error);
    }
    if (status == ISO_OK) status = iso_shade_splat_layers(&given, totals, error);
    free_call(&call);
    for (int i = 0; i < input->count; i++) {
        iso_free(found[i].nearest);
        iso_free(found[i].mean);
    }
    return status;
}
