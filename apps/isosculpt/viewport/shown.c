/* shown: a viewport's scene, and pictures of it. */
#include "apps/isosculpt/viewport/shown.h"

#include "apps/isosculpt/viewport/color_by.h"
#include "apps/isosculpt/viewport/masked.h"
#include "base/memory.h"
#include "render/shading/outline.h"

/* ---- the scene */

static void list_caps(const isosculpt_viewport *viewport, int count, int factor, isosculpt_shown *s) {
    const isosculpt_cut *cut = &viewport->cut;
    const double centre = cut->window[0], width = cut->window[1];
    const bool all = isnan(centre);
    for (int i = 0; i < count; i++)
        s->solids[i] =
            (iso_capped){.grid = &s->surfaces[i].grid,
                         .isovalue = i ? viewport->see_through.second_isovalue : viewport->isovalue,
                         .surface = (uint8_t)i,
                         .color = cut->cap.kind == ISO_CAP_COLOR ? cut->cap.color : s->colors[i],
                         .clip = &s->clips[i],
                         .plain = !viewport->lod};
    s->caps = (iso_cut_caps){.solids = s->solids,
                             .count = count,
                             .caps = true,
                             .shows = cut->cap.kind == ISO_CAP_SLICE,
                             .look = {all ? viewport->values[0] : centre - width / 2,
                                      all ? viewport->values[1] : centre + width / 2, cut->cap.map},
                             .factor = factor};
    if (cut->count && cut->cap.kind != ISO_CAP_NONE) s->scene.caps = &s->caps;
}

iso_status isosculpt_shown_list(isosculpt_viewport *viewport, iso_method method, int factor, bool lit,
                                isosculpt_shown *s, iso_error *error) {
    const isosculpt_see_through *how = &viewport->see_through;
    const isosculpt_cut *cut = &viewport->cut;
    const int count = isosculpt_viewport_has_second(viewport) ? ISOSCULPT_SURFACES : 1;
    const bool see_through = isosculpt_viewport_is_see_through(viewport);
    const isosculpt_light light = isosculpt_viewport_light(viewport);
    *s = (isosculpt_shown){.surfaces = {viewport->surface, viewport->second},
                           .colors = {viewport->mode.material.color, how->second_color}};
    s->layered[0].translucency.opacity = see_through ? (float)how->opacity : 1;
    s->layered[1].translucency.opacity = (float)how->second_opacity;
    if (isosculpt_viewport_is_painted(viewport) && iso_method_can(method, ISO_CAN_COLORS)) {
        s->painted = viewport->painted;
        s->painted.own = viewport->mode.material.color;
        s->paint = iso_painted_coloring(&s->painted);
        s->surfaces[0].coloring = &s->paint;
    }
    for (int i = 0; i < count; i++) {
        s->layered[i].surface = &s->surfaces[i];
        if (isosculpt_viewport_is_colored(viewport) && iso_method_can(method, ISO_CAN_COLORS))
            s->surfaces[i].coloring = &viewport->color_by->coloring;
        if (!cut->count) continue;
        s->clips[i] = iso_cuts_clip(cut->cuts, cut->count, i, &viewport->camera, 0);
        s->surfaces[i].clip = &s->clips[i];
    }
    if (viewport->drawn_points && method != ISO_METHOD_MESH && method != ISO_METHOD_EXACT) {
        s->points = iso_point_set_view(viewport->drawn_points);
        s->surfaces[0].given = &s->points;
    }
    s->shading = (iso_shading){.colors = s->colors,
                               .color_count = count,
                               .background = viewport->mode.material.background,
                               .ink = iso_outline_color(viewport->mode.material.background, false)};
    s->scene = (iso_scene){.renderer = iso_renderer_get(method),
                           .surfaces = s->layered,
                           .count = count,
                           .translucent = isosculpt_viewport_is_translucent(viewport),
                           .workspace = viewport->workspace,
                           .occlusion = light.occlusion};
    list_caps(viewport, count, factor, s);
    if (!lit || !(light.occlusion.ambient || light.occlusion.shadow)) return ISO_OK;
    if (!viewport->occluders) viewport->occluders = iso_alloc_zero(1, sizeof *viewport->occluders);
    if (!viewport->occluders) return iso_fail(error, ISO_ERR_NOMEM, "out of memory for occlusion");
    s->scene.occluders = viewport->occluders;
    return ISO_OK;
}

/* ---- its picture */

/* What the threads that take out samples read. */
typedef struct cutting {
    const iso_clip *clip;
    const iso_view *view;
    iso_gbuffer *gbuffer;
} cutting;

static void cut_row(void *context, size_t row, int worker) {
    (void)worker;
    const cutting *c = context;
    iso_gbuffer *g = c->gbuffer;
    for (size_t x = 0; x < (size_t)g->width; x++) {
        const size_t at = row * (size_t)g->width + x;
        iso_vec3 origin, direction;
        if (g->surface[at] == ISO_SURFACE_NONE) continue;
        iso_view_ray(c->view, (double)x + 0.5, (double)row + 0.5, &origin, &direction);
        if (iso_clip_shows(c->clip, iso_vec3_add(origin, iso_vec3_scale(direction, (double)g->depth[at]))))
            continue;
        g->surface[at] = ISO_SURFACE_NONE;
        g->depth[at] = INFINITY;
    }
}

void isosculpt_shown_cut_samples(const isosculpt_viewport *viewport, int surface, const iso_view *view,
                                 iso_gbuffer *gbuffer) {
    const isosculpt_cut *cut = &viewport->cut;
    const iso_clip clip = iso_cuts_clip(cut->cuts, cut->count, surface, &viewport->camera, 0);
    cutting c = {&clip, view, gbuffer};
    if (clip.count) iso_parallel_for(viewport->pool, (size_t)gbuffer->height, cut_row, &c);
}

/* Draws and shades by a matcap, or by a method that does not cut. */
static iso_status render_samples(isosculpt_viewport *viewport, isosculpt_shown *s, const iso_strip *strip,
                                 iso_gbuffer *gbuffer, iso_image *image, iso_error *error) {
    const bool cuts = viewport->cut.count && !iso_method_can(s->scene.renderer->method, ISO_CAN_CLIP);
    const iso_cut_caps *caps = s->scene.caps;
    if (cuts) s->scene.caps = NULL;
    iso_gbuffer_clear_bands(gbuffer, viewport->pool);
    ISO_TRY(iso_scene_draw(&s->scene, strip->view, gbuffer, viewport->pool, error));
    if (cuts) isosculpt_shown_cut_samples(viewport, 0, strip->view, gbuffer);
    if (cuts && caps) ISO_TRY(iso_caps_draw(caps, strip->view, gbuffer, viewport->pool, error));
    const isosculpt_material material = isosculpt_viewport_material(viewport);
    isosculpt_material_strip(&material, &viewport->matcap, strip, image, viewport->pool);
    return ISO_OK;
}

iso_status isosculpt_shown_render(isosculpt_viewport *viewport, iso_method method, const iso_view *pixels,
                                  int factor, bool lit, int widen, iso_gbuffer *gbuffer, iso_image *image,
                                  iso_error *error) {
    const iso_view samples = iso_view_scaled(pixels, factor);
    const iso_strip strip = {.view = &samples, .gbuffer = gbuffer, .factor = factor};
    const bool lamps = isosculpt_viewport_material(viewport).shading == ISOSCULPT_SHADING_LAMPS,
               cuts = !viewport->cut.count || iso_method_can(method, ISO_CAN_CLIP);
    isosculpt_shown s;
    size_t covered;
    ISO_TRY(isosculpt_shown_list(viewport, method, factor, lit, &s, error));
    if (method == ISO_METHOD_MESH) /* spans that face away are not drawn */
        ISO_TRY(iso_mesh_set_bound(viewport->surface.mesh, error));
    if (lamps && cuts) {
        iso_picture_opts opts = {.camera = &viewport->camera,
                                 .view = pixels,
                                 .width = pixels->width,
                                 .height = pixels->height,
                                 .samples = factor * factor,
                                 .shading = s.shading,
                                 .outline = lit ? widen * isosculpt_viewport_light(viewport).outline : 0,
                                 .gbuffer = gbuffer,
                                 .pool = viewport->pool};
        ISO_TRY(iso_scene_render(&s.scene, &opts, image, &covered, error));
    } else
        ISO_TRY(render_samples(viewport, &s, &strip, gbuffer, image, error));
    if (viewport->mask.at) isosculpt_darken_masked(viewport, &strip, image);
    return ISO_OK;
}
