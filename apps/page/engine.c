/* engine: what a page draws with, as WebAssembly: surfaces of one volume by the method exact, as isorender
 * draws them: to the same bytes. Each worker of a page has an engine of its own, and draws a band of rows.
 *
 * Functions that return int return an iso_status; page_error says what it is about. Nothing is freed: an
 * engine ends with its worker. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "apps/page/engine.h"
#include "grids/brick_index.h"

/* The row of the method exact in the table of methods (scene/method.c), which would bring all others. */
static iso_status draw_exact(const iso_scene_surface *surface, const iso_target *target, iso_error *error) {
    iso_target to = *target;
    to.clip = surface->clip;
    return iso_draw_exact(&to, surface->exact, error);
}
static const iso_renderer renderer = {
    .method = ISO_METHOD_EXACT, .name = "exact", .needs = 1 << ISO_PART_CELLS, .draw = draw_exact};
const iso_renderer *iso_renderer_get(iso_method method) {
    return method == ISO_METHOD_EXACT ? &renderer : NULL;
}

struct page page;

EXPORT(alloc) void *page_alloc(size_t bytes) {
    return iso_alloc(bytes);
}

EXPORT(error_text) const char *page_error(void) {
    return page.error.text;
}

iso_status page_grid(int nx, int ny, int nz, int type, void *data, double scale, double offset,
                     const double *transform, int level_set, iso_rgrid **grid) {
    iso_transform t;
    memcpy(&t, transform, sizeof t);
    const iso_rgrid_desc desc = {.dims = {nx, ny, nz},
                                 .type = (iso_type)type,
                                 .data = data,
                                 .scale = scale,
                                 .offset = offset,
                                 .transform = &t,
                                 .level_set = level_set};
    return iso_rgrid_create(&desc, grid, &page.error);
}

/* Takes a volume of nx x ny x nz voxels at `data`, from alloc. */
EXPORT(volume)
int page_volume(int nx, int ny, int nz, int type, void *data, double scale, double offset,
                const double *transform, int level_set) {
    iso_rgrid **grid = &page.levels[0].grid.rgrid;
    ISO_TRY(page_grid(nx, ny, nz, type, data, scale, offset, transform, level_set, grid));
    return iso_brick_index_of(*grid, NULL, NULL, &page.error);
}

/* Makes the second level. */
static iso_status halve(void) {
    const iso_rgrid *from = page.levels[0].grid.rgrid;
    iso_rgrid **made = &page.levels[1].grid.rgrid;
    iso_transform t = from->transform;
    iso_rgrid_desc desc = {.type = from->type,
                           .scale = from->scale,
                           .offset = from->offset,
                           .transform = &t,
                           .level_set = from->level_set};
    for (int axis = 0; axis < 3; axis++) {
        desc.dims[axis] = (from->dims[axis] + 1) / 2;
        t.spacing[axis] *= 2;
    }
    ISO_TRY(iso_rgrid_create(&desc, made, &page.error));
    const size_t size = iso_type_size(from->type);
    char *to = (*made)->data;
    for (int z = 0; z < desc.dims[2]; z++)
        for (int y = 0; y < desc.dims[1]; y++) {
            const char *row =
                (const char *)from->data + (size_t)(2 * y * from->stride_y + 2 * z * from->stride_z) * size;
            for (int x = 0; x < desc.dims[0]; x++, to += size) memcpy(to, row + (size_t)(2 * x) * size, size);
        }
    return iso_brick_index_of(*made, NULL, NULL, &page.error);
}

/* Sets surface `number`, from 0 without gaps. color: 0xRRGGBB. group: of labels; 0: it is an isosurface. Its
 * cells are found when it is drawn. */
EXPORT(surface)
void page_surface(int number, double isovalue, int color, double opacity, int constant, double absorption,
                  int most_layers, int group) {
    if (number >= page.count) page.count = number + 1;
    for (int k = 0; k < 2; k++) page.levels[k].parts[number].isovalue = isovalue;
    page.colors[number] = rgb(color);
    page.groups[number] = group;
    page.surfaces[number] =
        (iso_layered_surface){NULL, {(float)opacity, constant != 0, (float)absorption, most_layers}};
}

EXPORT(background) void page_background(int color) {
    page.background = rgb(color);
}

/* Cuts away the side of a plane through a point that the normal points to; a normal of 0: nothing. cap: the
 * cut is closed in the colours of the surfaces. The arithmetic is that of --clip (scene/cuts.c). */
EXPORT(clip) void page_clip(double x, double y, double z, double nx, double ny, double nz, int cap) {
    const double largest = fmax(fabs(nx), fmax(fabs(ny), fabs(nz)));
    page.clip.count = largest > 0;
    page.caps = page.clip.count && cap;
    if (page.clip.count)
        page.clip.body[0] =
            iso_clip_half_space((iso_vec3){x, y, z}, (iso_vec3){nx / largest, ny / largest, nz / largest});
}

/* Where the camera's numbers are: position, focal point and view up, view angle, half the height. */
EXPORT(camera) double *page_camera(void) {
    return &page.camera.position.x;
}

/* iso_scene_surface_update of cells, without the parts of other methods. */
static iso_status update(iso_scene_surface *part) {
    const double isovalue = part->isovalue;
    const iso_exact_opts opts = {.isovalue = isovalue};
    if (part->exact && part->isovalues[ISO_PART_CELLS] == isovalue) return ISO_OK;
    if (part->exact)
        iso_exact_set_isovalue(part->exact, isovalue);
    else
        ISO_TRY(iso_exact_create(&part->grid, &opts, &part->exact, &page.error));
    part->isovalues[ISO_PART_CELLS] = isovalue;
    return iso_exact_update(part->exact, &page.error);
}

/* The cells that the isosurfaces cross together, after a picture of the first level. */
EXPORT(cells) double page_cells(void) {
    double cells = 0;
    for (int i = 0; i < page.count; i++)
        if (!page.groups[i]) cells += (double)iso_exact_stats(page.levels[0].parts[i].exact).cells;
    return cells;
}

/* Draws rows first .. first + rows - 1 of a picture of width x height pixels; `orthographic` belongs to the
 * camera; `half`: of the second level. Returns their pixels, RGBA; NULL: it has failed. */
EXPORT(draw)
uint8_t *page_draw(int width, int height, int first, int rows, int samples, int orthographic, int half) {
    iso_capped solids[SURFACES];
    iso_layered_surface surfaces[SURFACES];
    bool translucent = false;
    page.camera.orthographic = orthographic != 0;
    if (iso_buffer_reserve(&page.pixels, (size_t)width * (size_t)rows * 4, 0, &page.error) != ISO_OK ||
        iso_camera_check(&page.camera, &page.error) != ISO_OK)
        return NULL;
    if (half && !page.levels[1].grid.rgrid && halve() != ISO_OK) return NULL;
    for (int i = 0; i < page.count; i++) {
        const group *labels = page.groups[i] ? &page.labels[page.groups[i]] : NULL;
        level *drawn = &page.levels[half && !labels];
        iso_scene_surface *part = &drawn->parts[i];
        surfaces[i] = (iso_layered_surface){part, page.surfaces[i].translucency};
        part->grid = labels ? labels->grid : drawn->grid;
        part->labels = labels ? labels->colors : NULL;
        part->borders = labels != NULL;
        part->clip = page.clip.count ? &page.clip : NULL;
        translucent |= page.surfaces[i].translucency.opacity < 1;
        solids[i] =
            (iso_capped){&part->grid, part->isovalue, (uint8_t)i, page.colors[i], part->clip, labels != NULL};
        if (update(part) != ISO_OK) return NULL;
    }
    for (int i = 0; i < page.object_count; i++) {
        translucent |= !iso_scene_object_is_opaque(page.objects[i]);
        page.objects[i]->clip = page.clip.count ? &page.clip : NULL;
        page.colors[page.count + i] = page.objects[i]->color;
    }
    const iso_cut_caps caps = {
        .solids = solids, .count = page.count, .caps = true, .factor = iso_picture_factor(samples)};
    const iso_view whole = iso_view_make(&page.camera, width, height),
                   band = iso_view_rows(&whole, first, rows);
    iso_scene scene = {.renderer = &renderer,
                       .surfaces = surfaces,
                       .count = page.count,
                       .objects = page.objects,
                       .object_count = page.object_count,
                       .translucent = translucent,
                       .caps = page.caps ? &caps : NULL};
    iso_picture_opts opts = {
        .view = &band,
        .width = width,
        .height = rows,
        .samples = samples,
        .shading = {page.colors, page.count + page.object_count, page.background, 0, {0, 0, 0}}};
    iso_image image = {.width = width, .height = rows, .rgba = page.pixels.data};
    return iso_scene_render(&scene, &opts, &image, NULL, &page.error) == ISO_OK ? image.rgba : NULL;
}

/* ---- the camera, moved by the page */

EXPORT(orbit) void page_orbit(double azimuth, double elevation) {
    iso_camera_orbit(&page.camera, azimuth, elevation);
}

EXPORT(zoom) void page_zoom(double factor) {
    iso_camera_zoom(&page.camera, factor);
}

/* Moves the scene by parts of the picture's height, to the right and down. */
EXPORT(pan) void page_pan(double right, double down) {
    iso_camera *c = &page.camera;
    const iso_view view = iso_view_make(c, 1, 1);
    const double distance = iso_vec3_length(iso_vec3_sub(c->focal_point, c->position)),
                 height = c->orthographic ? 2 * c->parallel_scale : distance / view.focal;
    const double *r = view.rotation;
    const iso_vec3 shift = {-(right * r[0] + down * r[3]) * height, -(right * r[1] + down * r[4]) * height,
                            -(right * r[2] + down * r[5]) * height};
    c->position = iso_vec3_add(c->position, shift);
    c->focal_point = iso_vec3_add(c->focal_point, shift);
}
