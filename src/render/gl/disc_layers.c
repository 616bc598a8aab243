/* disc_layers: finds the layers of translucent splats by compute shaders (shaders/splats_layers.comp):
 * lists the discs of each tile of a picture, uploads discs and lists, and reads back for each sample all
 * layers in order; or the mean of the groups' pictures and, for algorithm 3, the nearest layer (Zhang and
 * Pajarola 2006; render/groups/disc_layers.h). */
#include <assert.h>
#include <glad/gl.h>
#include <math.h>
#include <string.h>

#include "render/gl/groups.h"
#include "render/gl/shared.h"
#include "render/gl/splat.h"
#include "render/gl/surface.h"
#include "render/groups/layer_lists.h"

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
    bool sorted;                            /* the mode */
    int groups;                             /* lists of a tile: the surface's groups; sorted: 1 */
    int across, down;                       /* tiles */
    iso_buffer splats, looks;               /* the discs that the part shows */
    iso_buffer numbers;                     /* uint32_t for each disc: its number among them */
    iso_buffer starts, next, order, bounds; /* lists of the tiles; depths of the samples */
    iso_buffer layers, nearest;             /* read back; nearest layers (iso_packed_fragment) */
    size_t count;                           /* of splats */
} layers_call;

/* ---- lists of tiles */

/* Returns the tile columns that a disc may cover in a row of tiles; none when first > last. */
static iso_rows tile_columns(const layers_call *call, const iso_banded_discs *discs, uint32_t disc,
                             int band) {
    const iso_disc_box within = {{0, call->view.width - 1}, iso_banded_discs_band(discs, (size_t)band)},
                       box =
                           iso_disc_bounds(&discs->view, (const iso_disc *)discs->disc.data + disc, &within);
    if (box.columns.first > box.columns.last || box.rows.first > box.rows.last) return (iso_rows){0, -1};
    return (iso_rows){box.columns.first / ISO_GL_SPLAT_TILE, box.columns.last / ISO_GL_SPLAT_TILE};
}

/* Visits every disc of every tile, in the discs' order: counts it by tile and group in `next`, or writes its
 * number to the place that `next` says. */
static void visit_tiles(const layers_call *call, const iso_banded_discs *discs, uint32_t *next,
                        uint32_t *order) {
    const uint8_t *groups = call->sorted ? NULL : call->surface.input->groups->group;
    const iso_disc *disc = discs->disc.data;
    const uint32_t *sorted = discs->order.data, *numbers = call->numbers.data;
    const size_t *start = discs->start.data;
    for (int band = 0; band < discs->bands; band++)
        for (size_t i = start[band]; i < start[band + 1]; i++) {
            const iso_rows columns = tile_columns(call, discs, sorted[i], band);
            const uint8_t group = groups ? groups[disc[sorted[i]].point] : 0;
            for (int x = columns.first; x <= columns.last; x++) {
                uint32_t *at = &next[(size_t)(band * call->across + x) * (size_t)call->groups + group];
                if (order) order[*at] = numbers[sorted[i]];
                ++*at;
            }
        }
}

/* Lists the discs of each tile, group by group. */
static iso_status list_tiles(layers_call *call, const iso_banded_discs *discs, iso_error *error) {
    const size_t groups = (size_t)call->groups, tiles = (size_t)call->across * (size_t)call->down,
                 lists = tiles * groups;
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
    const iso_fragment shaded = iso_splat_fragment(&call->surface, wide);
    return (look){{shaded.color[0], shaded.color[1], shaded.color[2]},
                  shaded.opacity,
                  iso_splat_thickness(disc),
                  {0, 0, 0}};
}

/* Makes the splats of the discs that the part shows, and their looks. */
static iso_status gather_splats(layers_call *call, const iso_banded_discs *discs, iso_error *error) {
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
        splats[call->count++] = iso_gl_splat_make(d, &layer->points, call->sorted ? NULL : layer->groups);
    }
    return ISO_OK;
}

/* ---- one pass of shaders */

static size_t most_bytes(const layers_call *call) {
    return call->engine->max_storage < STORAGE_BYTES ? call->engine->max_storage : STORAGE_BYTES;
}

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
        .rays = {rays->slope, rays->scale, rays->near, ISO_GROUPS_THICKNESS / ISO_GROUPS_DISC},
        .picture = {call->view.width, call->view.height},
        .counts = {(int)call->count, call->groups, surface->input->points.colors != NULL},
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
    gl->BindBufferBase(GL_SHADER_STORAGE_BUFFER, ISO_GL_HITS, storage[ISO_GL_STORE_HITS]);
    gl->UseProgram(name);
    iso_gl_timer_begin(&call->engine->timer, gl, ISO_GL_PASS_DRAW);
    gl->DispatchCompute((GLuint)call->across, (GLuint)call->down, 1);
    gl->MemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT | GL_BUFFER_UPDATE_BARRIER_BIT);
    iso_gl_timer_end(&call->engine->timer, gl);
    return ISO_OK;
}

static iso_status send_discs(layers_call *call, const iso_banded_discs *discs, iso_error *error) {
    ISO_TRY(gather_splats(call, discs, error));
    ISO_TRY(list_tiles(call, discs, error));
    return upload(call, error);
}

/* Runs a program for all samples, and reads `bytes` bytes of layers back. */
static iso_status find_layers(layers_call *call, iso_gl_program program, size_t bytes, iso_error *error) {
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

/* Shades a mean of discs, as the shader sums it up; opacity 0: there is none. */
static iso_packed_fragment shade(const layers_call *call, size_t sample, const float f[ISO_GL_LAYER_FLOATS]) {
    const iso_disc_view *view = &call->surface.discs.view;
    const int x = (int)(sample % (size_t)call->view.width), y = (int)(sample / (size_t)call->view.width);
    const iso_splat_sums sums = {f[3], f[7], {f[0], f[1], f[2]}, {f[4], f[5], f[6]}, f[3]};
    if (!(sums.weight > 0)) return (iso_packed_fragment){0};
    const iso_fragment fragment = iso_splat_mean_fragment(&call->surface, &sums, false,
                                                          iso_disc_column(view, x), iso_disc_row(view, y));
    return iso_fragment_pack(&fragment);
}

/* Shades the nearest layers; their depths become bounds of what lies behind them. */
static iso_status find_nearest(layers_call *call, iso_error *error) {
    const size_t bytes = call->samples * ISO_GL_LAYER_FLOATS * sizeof(float),
                 of_bounds = 2 * call->samples * sizeof(float);
    ISO_TRY(iso_buffer_reserve(&call->nearest, call->samples * sizeof(iso_packed_fragment), 0, error));
    iso_packed_fragment *to = call->nearest.data;
    memset(to, 0, call->samples * sizeof *to);
    if (call->input->transparency != ISO_TRANSPARENCY_NEAREST) return ISO_OK;
    ISO_TRY(send_discs(call, &call->surface.discs, error));
    ISO_TRY(find_layers(call, ISO_GL_SPLAT_NEAREST, bytes, error));
    const float(*found)[ISO_GL_LAYER_FLOATS] = call->layers.data;
    for (size_t i = 0; i < call->samples; i++) to[i] = shade(call, i, found[i]);
    call->gl->GetNamedBufferSubData(call->engine->storage[ISO_GL_STORE_LAYER_BOUNDS], 0,
                                    (GLsizeiptr)of_bounds, call->bounds.data);
    return ISO_OK;
}

/* The layers of a surface in a strip: iso_splat_lists. */
typedef struct found_layers {
    iso_buffer layers; /* iso_packed_fragment */
    size_t count;
    size_t *start; /* one more than samples of the strip */
    iso_splat_lists lists;
} found_layers;

static void append(found_layers *found, const iso_packed_fragment *fragment) {
    iso_packed_fragment *to = found->layers.data;
    if (iso_packed_opacity(fragment) > 0) to[found->count++] = *fragment;
}

static iso_status make_room(found_layers *found, size_t more, iso_error *error) {
    return iso_buffer_reserve(&found->layers, (found->count + more) * sizeof(iso_packed_fragment),
                              found->count * sizeof(iso_packed_fragment), error);
}

/* Appends the nearest layers and the means of the groups' pictures, which lie behind them. */
static iso_status find_means(layers_call *call, found_layers *found, size_t first, iso_error *error) {
    const size_t bytes = call->samples * ISO_GL_LAYER_FLOATS * sizeof(float);
    ISO_TRY(send_discs(call, &call->surface.wide, error));
    ISO_TRY(find_layers(call, ISO_GL_SPLAT_MEAN, bytes, error));
    ISO_TRY(make_room(found, 2 * call->samples, error));
    const float(*layers)[ISO_GL_LAYER_FLOATS] = call->layers.data;
    const float *bounds = call->bounds.data;
    const iso_packed_fragment *nearest = call->nearest.data;
    for (size_t i = 0; i < call->samples; i++) {
        const float *f = layers[i];
        const iso_fragment mean = {.depth = f[4] < bounds[2 * i] ? bounds[2 * i] : f[4],
                                   .opacity = f[3],
                                   .color = {f[0], f[1], f[2]},
                                   .surface = call->surface.number};
        const iso_packed_fragment packed = iso_fragment_pack(&mean);
        append(found, &nearest[i]);
        append(found, &packed);
        found->start[first + i + 1] = found->count;
    }
    return ISO_OK;
}

/* ---- sorted layers of a part */

/* Counts the hits of each sample, and sets `bounds` to where its list begins and *total to the number of all
 * hits. */
static iso_status count_hits(layers_call *call, size_t *total, iso_error *error) {
    ISO_TRY(find_layers(call, ISO_GL_SPLAT_COUNTS, call->samples * sizeof(uint32_t), error));
    ISO_TRY(iso_buffer_reserve(&call->bounds, 2 * call->samples * sizeof(float), 0, error));
    const uint32_t *counts = call->layers.data;
    uint32_t *bounds = call->bounds.data;
    *total = 0;
    for (size_t i = 0; i < call->samples; i++) {
        bounds[2 * i] = (uint32_t)*total;
        bounds[2 * i + 1] = 0;
        *total += counts[i];
    }
    return ISO_OK;
}

/* Appends all layers; sets *fits to false instead if the lists of the part are too long. */
static iso_status find_sorted(layers_call *call, found_layers *found, size_t first, bool *fits,
                              iso_error *error) {
    const size_t each = ISO_GL_LAYER_FLOATS * sizeof(float);
    size_t total;
    ISO_TRY(send_discs(call, &call->surface.discs, error));
    ISO_TRY(count_hits(call, &total, error));
    *fits = total * each <= most_bytes(call);
    if (!*fits) return ISO_OK;
    iso_gl_engine_ensure_storage(call->engine, ISO_GL_STORE_HITS, total * 4 * sizeof(uint32_t) + 16);
    ISO_TRY(
        fill(call, ISO_GL_STORE_LAYER_BOUNDS, call->bounds.data, 2 * call->samples * sizeof(float), error));
    ISO_TRY(find_layers(call, ISO_GL_SPLAT_LISTS, total * each + each, error));
    ISO_TRY(make_room(found, total, error));
    const float(*layers)[ISO_GL_LAYER_FLOATS] = call->layers.data;
    const uint32_t *begin = call->bounds.data;
    for (size_t i = 0; i < call->samples; i++) {
        const size_t end = i + 1 < call->samples ? begin[2 * i + 2] : total;
        for (size_t k = begin[2 * i]; k < end && layers[k][3] > 0; k++) {
            const iso_packed_fragment packed = shade(call, i, layers[k]);
            append(found, &packed);
        }
        found->start[first + i + 1] = found->count;
    }
    return ISO_OK;
}

/* ---- strips */

static iso_status find_part(layers_call *call, int number, found_layers *found, bool *fits,
                            iso_error *error) {
    const size_t first = (size_t)call->row * (size_t)call->view.width;
    const iso_splat_layer *layer = &call->input->layers[number];
    call->surface = (iso_splat_surface){.number = number};
    call->groups = call->sorted ? 1 : layer->groups->count;
    for (size_t i = 0; i < call->samples; i++) found->start[first + i + 1] = found->count;
    if (call->groups == 0) return ISO_OK;
    iso_status status = iso_groups_start_surface(layer, &call->view, call->sorted, ISO_GL_SPLAT_TILE,
                                                 call->input->picture.pool, &call->surface, error);
    if (status == ISO_OK && call->sorted) status = find_sorted(call, found, first, fits, error);
    if (status == ISO_OK && !call->sorted) status = set_bounds(call, error);
    if (status == ISO_OK && !call->sorted) status = find_nearest(call, error);
    if (status == ISO_OK && !call->sorted) status = find_means(call, found, first, error);
    iso_groups_end_surface(&call->surface);
    return status;
}

/* Finds the layers of all surfaces in `rows` rows from call->row on. */
static iso_status find_rows(layers_call *call, int rows, found_layers *found, bool *fits, iso_error *error) {
    call->view = iso_view_rows(call->input->picture.strip->view, call->row, rows);
    call->samples = (size_t)call->view.width * (size_t)rows;
    call->across = (call->view.width + ISO_GL_SPLAT_TILE - 1) / ISO_GL_SPLAT_TILE;
    call->down = (rows + ISO_GL_SPLAT_TILE - 1) / ISO_GL_SPLAT_TILE;
    *fits = true;
    for (int i = 0; i < call->input->count && *fits; i++) ISO_TRY(find_part(call, i, &found[i], fits, error));
    iso_gl_timer_read(&call->engine->timer, call->gl);
    for (int i = 0; i < call->input->count && !*fits; i++) /* take back what was appended */
        found[i].count = found[i].start[(size_t)call->row * (size_t)call->view.width];
    return ISO_OK;
}

static iso_status find_in_parts(layers_call *call, found_layers *found, iso_error *error) {
    const iso_view *whole = call->input->picture.strip->view;
    const size_t row = (size_t)whole->width * ISO_GL_LAYER_FLOATS * sizeof(float),
                 most = most_bytes(call) / row;
    int rows = most < (size_t)whole->height ? (int)most : whole->height;
    if (rows > ISO_GL_SPLAT_TILE) rows -= rows % ISO_GL_SPLAT_TILE;
    if (rows < 1) rows = 1;
    for (call->row = 0; call->row < whole->height;) {
        const int left = whole->height - call->row, now = rows < left ? rows : left;
        bool fits;
        ISO_TRY(find_rows(call, now, found, &fits, error));
        if (fits) {
            call->row += now;
        } else if (now > 1) {
            rows = now / 2; /* the lists of fewer rows */
        } else {
            return iso_fail(error, ISO_ERR_LIMIT,
                            "%s: the layers of a row of samples do not fit into a storage buffer of %s",
                            call->engine->context->name, call->engine->context->renderer);
        }
    }
    return ISO_OK;
}

/* Allocates the lists of the surfaces; they are empty. */
static iso_status allocate(const iso_splat_layers *input, found_layers *found, iso_splat_layer *layers,
                           iso_error *error) {
    const iso_view *view = input->picture.strip->view;
    const size_t samples = (size_t)view->width * (size_t)view->height;
    for (int i = 0; i < input->count; i++) {
        found[i].start = iso_alloc_zero(samples + 1, sizeof *found[i].start);
        if (!found[i].start) return iso_fail(error, ISO_ERR_NOMEM, "out of memory for drawing layers");
        layers[i] = input->layers[i];
        layers[i].lists = &found[i].lists;
    }
    return ISO_OK;
}

static void free_call(layers_call *call) {
    iso_buffer *buffers[] = {&call->splats, &call->looks,  &call->numbers, &call->starts, &call->next,
                             &call->order,  &call->bounds, &call->layers,  &call->nearest};
    for (size_t i = 0; i < sizeof buffers / sizeof *buffers; i++) iso_buffer_free(buffers[i]);
}

iso_status iso_gl_shade_splat_layers(iso_gl_engine *engine, const iso_splat_layers *input,
                                     iso_layer_totals *totals, iso_error *error) {
    assert(input->count <= ISO_LAYER_SURFACES);
    found_layers found[ISO_LAYER_SURFACES] = {0};
    iso_splat_layer layers[ISO_LAYER_SURFACES];
    layers_call call = {.engine = engine,
                        .gl = engine->context->gl,
                        .input = input,
                        .sorted = input->transparency == ISO_TRANSPARENCY_SORTED};
    iso_splat_layers given = *input;
    given.layers = layers;
    iso_status status = allocate(input, found, layers, error);
    if (status == ISO_OK) status = iso_gl_enter(engine->context, error);
    if (status == ISO_OK) status = iso_gl_leave(engine->context, find_in_parts(&call, found, error), error);
    for (int i = 0; i < input->count; i++)
        found[i].lists = (iso_splat_lists){found[i].layers.data, found[i].start};
    if (status == ISO_OK) status = iso_shade_splat_layers(&given, totals, error);
    free_call(&call);
    for (int i = 0; i < input->count; i++) {
        iso_buffer_free(&found[i].layers);
        iso_free(found[i].start);
    }
    return status;
}
