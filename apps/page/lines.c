/* lines: the part of a page's engine that draws opaque lines, as isorender --lines does. */
#include "base/lines.h"
#include "apps/page/engine.h"

enum { RADII = 1, NORMALS = 2, COLORS = 4 };

static struct {
    iso_lines lines; /* whose arrays lie in what the page has given */
    iso_scene_object object;
} made[OBJECTS];

/* What stands next in the data: `count` items; NULL: it is not there. */
static void *take(char **data, bool there, size_t count, size_t bytes) {
    void *at = there ? *data : NULL;
    if (there) *data += count * bytes;
    return at;
}

/* Adds lines. data: from alloc: floats of vertices, of radii and of normals, the first vertices of lines and
 * their end as 32-bit numbers, and bytes of colours; `has` says which of them there are. origin: 3 numbers.
 */
EXPORT(lines)
int page_lines(int vertices, int lines, char *data, int has, const double *origin, double radius,
               double min_pixels, int style, int caps, int color, double opacity, int constant,
               double absorption, int most_layers) {
    _Static_assert(sizeof(size_t) == 4, "starts are taken as they are");
    const size_t count = (size_t)vertices;
    iso_lines *l = &made[page.object_count].lines;
    iso_scene_object *object = &made[page.object_count].object;
    *l = (iso_lines){
        .origin = {origin[0], origin[1], origin[2]}, .vertex_count = count, .line_count = (size_t)lines};
    l->vertices = take(&data, true, count, sizeof *l->vertices);
    l->radii = take(&data, has & RADII, count, sizeof *l->radii);
    l->normals = take(&data, has & NORMALS, count, sizeof *l->normals);
    l->starts = take(&data, true, l->line_count + 1, sizeof *l->starts);
    l->colors = take(&data, has & COLORS, count, sizeof *l->colors);
    object->lines = l;
    object->color = rgb(color);
    object->translucency = (iso_translucency){(float)opacity, constant != 0, (float)absorption, most_layers};
    page.objects[page.object_count++] = object;
    const iso_shapes_opts opts = {
        .radius = radius, .min_pixels = min_pixels, .style = (iso_line_style)style, .caps = (iso_caps)caps};
    return iso_shapes_from_lines(l, &opts, &object->shapes, &page.error);
}
