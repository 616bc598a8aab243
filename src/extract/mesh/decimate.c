/* Fewer triangles, by meshoptimizer, which is loaded when it is needed: it brings the library of C++, which
 * takes longer to load than many pictures take to draw. */
#include <dlfcn.h>
#include <math.h>
#include <meshoptimizer.h>
#include <string.h>

#include "base/memory.h"
#include "extract/mesh/mesh_edit.h"

bool iso_weld_can_decimate(void) {
    return true;
}

typedef struct simplifier {
    __typeof__(&meshopt_simplifyScale) scale;
    __typeof__(&meshopt_simplify) simplify;
} simplifier;

static iso_status load(simplifier *loaded, iso_error *error) {
    void *library = dlopen(ISO_MESHOPTIMIZER, RTLD_NOW | RTLD_LOCAL); /* never closed */
    *(void **)&loaded->scale = library ? dlsym(library, "meshopt_simplifyScale") : NULL;
    *(void **)&loaded->simplify = library ? dlsym(library, "meshopt_simplify") : NULL;
    if (loaded->scale && loaded->simplify) return ISO_OK;
    return iso_fail(error, ISO_ERR_BACKEND, "meshoptimizer, which joins triangles, is not there: %s",
                    dlerror());
}

/* Keeps the vertices that triangles use, in their order. */
static void compact(iso_weld *weld, uint32_t *number) {
    memset(number, 0, weld->vertex_count * sizeof *number);
    for (size_t t = 0; t < weld->triangle_count; t++)
        for (int k = 0; k < 3; k++) number[weld->triangles[t][k]] = 1;
    size_t kept = 0;
    for (size_t i = 0; i < weld->vertex_count; i++) {
        if (!number[i]) continue;
        weld->vertices[kept] = weld->vertices[i];
        if (weld->colors) memcpy(weld->colors[kept], weld->colors[i], sizeof *weld->colors);
        number[i] = (uint32_t)kept++;
    }
    weld->vertex_count = kept;
    for (size_t t = 0; t < weld->triangle_count; t++)
        for (int k = 0; k < 3; k++) weld->triangles[t][k] = number[weld->triangles[t][k]];
}

iso_status iso_weld_decimate(iso_weld *weld, const iso_transform *transform, const iso_mesh_edits *edits,
                             iso_error *error) {
    simplifier loaded;
    if (!weld->triangle_count) return ISO_OK;
    ISO_TRY(load(&loaded, error));
    const iso_affine affine = iso_transform_affine(transform);
    float *world = iso_alloc(weld->vertex_count * 3 * sizeof *world);
    uint32_t *made = iso_alloc(weld->triangle_count * 3 * sizeof *made);
    uint32_t *number = iso_alloc(weld->vertex_count * sizeof *number);
    if (!world || !made || !number) {
        iso_free(world), iso_free(made), iso_free(number);
        return iso_fail(error, ISO_ERR_NOMEM, "out of memory for joining %zu triangles",
                        weld->triangle_count);
    }
    for (size_t i = 0; i < weld->vertex_count; i++) {
        const float *p = weld->vertices[i].position;
        const iso_vec3 at = iso_affine_point(&affine, iso_vec3_make(p[0], p[1], p[2]));
        world[3 * i] = (float)at.x, world[3 * i + 1] = (float)at.y, world[3 * i + 2] = (float)at.z;
    }
    const float scale = loaded.scale(world, weld->vertex_count, 3 * sizeof *world);
    const size_t wanted = edits->keep > 0 ? 3 * (size_t)ceil(edits->keep * (double)weld->triangle_count) : 0;
    /* (quadric errors are means over the triangles around: the most is about twice as much) */
    const float deviation = edits->deviation > 0 ? (float)edits->deviation / (2 * scale) : 1e9f;
    const size_t indices = loaded.simplify(made, &weld->triangles[0][0], 3 * weld->triangle_count, world,
                                           weld->vertex_count, 3 * sizeof *world, wanted, deviation, 0, NULL);
    memcpy(weld->triangles, made, indices * sizeof *made);
    weld->triangle_count = indices / 3;
    compact(weld, number);
    iso_free(world), iso_free(made), iso_free(number);
    iso_weld_find_normals(weld);
    return ISO_OK;
}
