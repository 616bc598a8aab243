/* surfaces: the command "isocompare surfaces", which measures how far two surfaces are from each other,
 * and draws both, coloured by their distance from the other one. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "apps/isocompare/report.h"
#include "base/file.h"
#include "base/file_types.h"
#include "base/html.h"
#include "base/parse.h"
#include "compare/surfaces.h"
#include "scene/coloring.h"
#include "scene/distances.h"
#include "scene/loader.h"
#include "scene/picture.h"
#include "scene/picture_file.h"

enum { VIEWS = 2 };

/* One of the two surfaces. */
typedef struct side {
    char *path;
    double isovalue; /* of a volume; NAN until it is known */
    bool is_mesh;
    iso_input input;
    iso_loader loader; /* of a volume */
    iso_triangles mesh;
    iso_distance *distance;
    iso_scene_surface surface; /* of a volume */
    iso_scene_object object;   /* of a mesh */
    iso_coloring coloring;
    report_picture pictures[VIEWS];
} side;

typedef struct comparison {
    const isocompare_settings *settings;
    iso_pool *pool;
    iso_file_set files;
    side sides[2];
    iso_surfaces_compared result;
} comparison;

/* ---- reading */

/* Splits FILE:ISOVALUE, if there is no file of that name. */
static iso_status take_operand(const char *operand, double isovalue, side *s, iso_error *error) {
    FILE *stream = NULL;
    s->path = strdup(operand);
    if (!s->path) return iso_fail(error, ISO_ERR_NOMEM, "out of memory");
    s->isovalue = isovalue;
    char *colon = strrchr(s->path, ':');
    double number;
    const bool there = iso_file_open(operand, &stream, NULL, NULL) == ISO_OK;
    if (there) fclose(stream);
    if (there || !colon || iso_loader_is_scene(s->path) || !iso_parse_real(colon + 1, &number)) return ISO_OK;
    *colon = 0;
    s->isovalue = number;
    return ISO_OK;
}

static bool holds_mesh(const char *path) {
    const iso_file_type type = iso_file_type_find(path, ISO_HOLDS_MESH | ISO_HOLDS_VOLUME);
    return !iso_loader_is_scene(path) && type != ISO_FILE_UNKNOWN &&
           iso_file_type_holds(type) & ISO_HOLDS_MESH;
}

static iso_status read_volume(comparison *c, side *s, iso_error *error) {
    iso_weld weld;
    bool chosen;
    s->input = (iso_input){.max_memory = c->settings->common.input.max_memory};
    s->loader = (iso_loader){.input = s->path,
                             .options = &s->input,
                             .files = &c->files,
                             .pool = c->pool,
                             .is_further = true,
                             .wants_histogram = isnan(s->isovalue)};
    ISO_TRY(iso_loader_open(&s->loader, error));
    if (s->loader.has_points)
        return iso_fail(error, ISO_ERR_USAGE, "holds points: volumes and meshes are compared");
    ISO_TRY(iso_loader_read(&s->loader, error));
    ISO_TRY(iso_loader_isovalue(&s->loader, s->isovalue, &s->isovalue, &chosen, error));
    const iso_grid *grid = &s->loader.volume.grid;
    const iso_affine affine = iso_transform_affine(iso_grid_transform(grid));
    ISO_TRY(iso_isosurface_mesh(grid, s->isovalue, c->pool, &weld, error));
    iso_status status = iso_weld_triangles(&weld, &affine, &s->mesh, error);
    iso_weld_free(&weld);
    ISO_TRY(status);
    s->surface = (iso_scene_surface){.grid = *grid, .isovalue = s->isovalue, .pool = c->pool};
    return iso_distance_of_isosurface(grid, s->isovalue, c->pool, &s->distance, error);
}

static iso_status read_side(comparison *c, side *s, iso_error *error) {
    s->is_mesh = holds_mesh(s->path);
    if (!s->is_mesh) return read_volume(c, s, error);
    iso_file_set_read(&c->files, s->path);
    return iso_distance_of_mesh_file(s->path, &s->mesh, &s->distance, error);
}

static iso_status read_sides(comparison *c, iso_error *error) {
    const isocompare_settings *settings = c->settings;
    const char *operands[2] = {settings->truth, settings->candidate};
    if (settings->output) iso_file_set_write(&c->files, settings->output);
    if (settings->common.json_path) iso_file_set_write(&c->files, settings->common.json_path);
    for (int i = 0; i < 2; i++) {
        ISO_TRY(take_operand(operands[i], settings->isovalue, &c->sides[i], error));
        const iso_status status = read_side(c, &c->sides[i], error);
        char text[sizeof error->text];
        snprintf(text, sizeof text, "%s", error->text);
        if (status != ISO_OK && strncmp(text, c->sides[i].path, strlen(c->sides[i].path)) != 0)
            return iso_fail(error, status, "%s: %s", c->sides[i].path, text);
        ISO_TRY(status);
    }
    return iso_file_set_check(&c->files, error);
}

/* ---- pictures */

static iso_status prepare_picture(side *s, const side *other, double most, iso_error *error) {
    s->coloring = (iso_coloring){.source = ISO_COLOR_BY_DISTANCE,
                                 .distance = other->distance,
                                 .bar = {.map = ISO_COLORMAP_COOLWARM,
                                         .table = NULL,
                                         .low = -most,
                                         .high = most,
                                         .title = "distance (mm)"}};
    s->surface.coloring = s->object.coloring = &s->coloring;
    s->object.translucency.opacity = 1;
    s->object.color = iso_shading_palette(0);
    return s->is_mesh ? iso_triangle_spans_make(&s->mesh, &s->object.spans, error)
                      : iso_scene_surface_prepare(&s->surface, ISO_PART_CELLS, error);
}

static iso_status paint(const comparison *c, side *s, const iso_camera *camera, iso_image *image,
                        iso_error *error) {
    const iso_rgb color = iso_shading_palette(0);
    const iso_layered_surface surface = {&s->surface, {.opacity = 1}};
    iso_scene_object *const objects[1] = {&s->object};
    iso_scene scene = {.renderer = iso_renderer_get(ISO_METHOD_EXACT),
                       .surfaces = &surface,
                       .count = !s->is_mesh,
                       .objects = objects,
                       .object_count = s->is_mesh};
    const int pixels = c->settings->side;
    iso_picture_opts opts = {
        .camera = camera,
        .width = pixels,
        .height = pixels,
        .samples = 4,
        .shading = {.colors = &color, .color_count = 1, .background = c->settings->background},
        .pool = c->pool};
    const iso_annotation annotation = {.camera = camera,
                                       .color_bars = &s->coloring.bar,
                                       .color_bar_count = 1,
                                       .orientation_marker = true,
                                       .dark = iso_is_dark(c->settings->background, false)};
    ISO_TRY(iso_image_create(pixels, pixels, image, error));
    ISO_TRY(iso_scene_render(&scene, &opts, image, NULL, error));
    return iso_annotate(image, &annotation, error);
}

static iso_status draw(const comparison *c, side *s, int view, const iso_camera *camera, iso_error *error) {
    const iso_png_opts png = {.small = true, .pool = c->pool};
    iso_image image = {0};
    iso_status status = paint(c, s, camera, &image, error);
    if (status == ISO_OK)
        status = iso_png_encode(&image, &png, &s->pictures[view].bytes, &s->pictures[view].size, error);
    iso_image_free(&image);
    return status;
}

/* The camera of a view of both. */
static iso_status look(const comparison *c, int view, iso_camera *camera, iso_error *error) {
    static const iso_direction directions[VIEWS] = {ISO_FRONT, ISO_BACK};
    const iso_fit_opts fit = {.direction = directions[view], .elevation = 15, .azimuth = -25};
    iso_box box = iso_box_empty();
    for (int i = 0; i < 2; i++)
        for (size_t k = 0; k < c->sides[i].mesh.vertex_count; k++) {
            const float *v = c->sides[i].mesh.vertices[k];
            iso_box_add(&box, iso_vec3_make((double)v[0], (double)v[1], (double)v[2]));
        }
    return iso_camera_of_box(&box, c->settings->side, c->settings->side, &fit, camera, error);
}

/* The largest distance that has a colour of its own. */
static double most(const comparison *c) {
    return c->result.p95 > 0 ? c->result.p95 : fmax(c->result.hausdorff, 1e-6);
}

static iso_status draw_all(comparison *c, iso_error *error) {
    for (int i = 0; i < 2; i++) ISO_TRY(prepare_picture(&c->sides[i], &c->sides[1 - i], most(c), error));
    for (int view = 0; view < VIEWS; view++) {
        iso_camera camera;
        ISO_TRY(look(c, view, &camera, error));
        for (int i = 0; i < 2; i++) ISO_TRY(draw(c, &c->sides[i], view, &camera, error));
    }
    return ISO_OK;
}

/* ---- results */

/* A number of the table: its name, and its values for the first surface and the second, or for both in the
 * first. */
typedef struct row {
    const char *name, *unit;
    double values[2];
    bool both;
} row;

enum { ROWS = 11 };

static void list_rows(const comparison *c, row rows[ROWS]) {
    const iso_surfaces_compared *r = &c->result;
    const iso_surface_distances *a = &r->side[0], *b = &r->side[1];
    const row made[ROWS] = {{"mean", "mm", {a->mean, b->mean}, false},
                            {"signed_mean", "mm", {a->signed_mean, b->signed_mean}, false},
                            {"rms", "mm", {a->rms, b->rms}, false},
                            {"p95", "mm", {a->p95, b->p95}, false},
                            {"hausdorff", "mm", {a->most, b->most}, false},
                            {"area", "mm2", {a->area, b->area}, false},
                            {"volume", "mm3", {r->volume[0], r->volume[1]}, false},
                            {"mean_of_both", "mm", {r->mean, NAN}, true},
                            {"hausdorff_of_both", "mm", {r->hausdorff, NAN}, true},
                            {"overlap", "mm3", {r->overlap, NAN}, true},
                            {"dice", "", {r->dice, NAN}, true}};
    memcpy(rows, made, sizeof made);
}

static void print_table(const comparison *c) {
    row rows[ROWS];
    list_rows(c, rows);
    printf("%-18s %14s %14s\n", "", "A from B", "B from A");
    for (int i = 0; i < ROWS; i++) {
        printf("%-18s %14.6g", rows[i].name, rows[i].values[0]);
        if (!rows[i].both) printf(" %14.6g", rows[i].values[1]);
        printf("%s%s\n", *rows[i].unit ? "  " : "", rows[i].unit);
    }
}

static void put_json(const comparison *c, iso_json *json) {
    static const char *const keys[2] = {"a", "b"};
    row rows[ROWS];
    list_rows(c, rows);
    iso_json_begin_object(json, NULL);
    for (int i = 0; i < 2; i++) {
        iso_json_begin_object(json, keys[i]);
        iso_json_string(json, "path", c->sides[i].path);
        if (!c->sides[i].is_mesh) iso_json_real(json, "isovalue", c->sides[i].isovalue);
        iso_json_integer(json, "points", c->result.side[i].points);
        for (int k = 0; k < ROWS; k++)
            if (!rows[k].both) iso_json_real(json, rows[k].name, rows[k].values[i]);
        iso_json_end_object(json);
    }
    for (int k = 0; k < ROWS; k++)
        if (rows[k].both) iso_json_real(json, rows[k].name, rows[k].values[0]);
    iso_json_real(json, "step", c->result.step);
    iso_json_end_object(json);
}

static iso_status write_json(const comparison *c, iso_error *error) {
    iso_json json = {0};
    iso_sink sink;
    if (!c->settings->common.json) return ISO_OK;
    put_json(c, &json);
    if (!c->settings->common.json_path) return iso_json_write(&json, stdout, error);
    const iso_status status = iso_sink_open(c->settings->common.json_path, &sink, error);
    return status == ISO_OK ? iso_json_commit(&json, &sink, error) : status;
}

static void put_page(const comparison *c, FILE *stream) {
    static const char *const views[VIEWS] = {"from the front", "from behind"};
    row rows[ROWS];
    list_rows(c, rows);
    fputs("<!doctype html><meta charset=utf-8><title>Surfaces</title><style>body{font:15px/1.5 "
          "system-ui,sans-serif;"
          "margin:2em auto;max-width:1100px;padding:0 1em}table{border-collapse:collapse}td,th{padding:4px "
          "12px;"
          "text-align:right;border-top:1px solid "
          "#ccc}td:first-child{text-align:left}figure{display:inline-block;"
          "width:48%;margin:1%}img{width:100%}</style>\n<h1>Two surfaces</h1>\n<ol type=A>",
          stream);
    for (int i = 0; i < 2; i++) {
        fputs("<li>", stream);
        iso_html_text(stream, c->sides[i].path);
        if (!c->sides[i].is_mesh) fprintf(stream, ", isovalue %.10g", c->sides[i].isovalue);
        fputs("</li>", stream);
    }
    fputs("</ol>\n<table><tr><th><th>A from B<th>B from A<th></tr>\n", stream);
    for (int i = 0; i < ROWS; i++) {
        fprintf(stream, "<tr><td>%s<td>%.6g<td>", rows[i].name, rows[i].values[0]);
        if (!rows[i].both) fprintf(stream, "%.6g", rows[i].values[1]);
        fprintf(stream, "<td>%s</tr>\n", rows[i].unit);
    }
    fputs("</table>\n<p>Each surface is coloured by its distance from the other one, below 0 inside it; the "
          "range is the "
          "95th percentile.</p>\n",
          stream);
    for (int view = 0; view < VIEWS; view++)
        for (int i = 0; i < 2; i++) {
            fprintf(stream, "<figure><img alt=\"%c %s\" src=\"data:image/png;base64,", 'A' + i, views[view]);
            iso_html_base64(stream, c->sides[i].pictures[view].bytes, c->sides[i].pictures[view].size);
            fprintf(stream, "\"><figcaption>%c %s</figcaption></figure>\n", 'A' + i, views[view]);
        }
}

static iso_status write_page(comparison *c, iso_error *error) {
    iso_sink sink;
    if (!c->settings->output) return ISO_OK;
    ISO_TRY(draw_all(c, error));
    ISO_TRY(iso_sink_open(c->settings->output, &sink, error));
    put_page(c, sink.stream);
    return iso_sink_commit(&sink, error);
}

static iso_status measure(comparison *c, iso_error *error) {
    ISO_TRY(read_sides(c, error));
    const iso_compared_surface surfaces[2] = {
        {&c->sides[0].mesh, c->sides[0].distance, !c->sides[0].is_mesh},
        {&c->sides[1].mesh, c->sides[1].distance, !c->sides[1].is_mesh}};
    return iso_compare_surfaces(surfaces, c->pool, &c->result, error);
}

static iso_status compare(comparison *c, iso_error *error) {
    ISO_TRY(measure(c, error));
    ISO_TRY(write_page(c, error));
    const bool to_stdout = c->settings->common.json && !c->settings->common.json_path;
    if (!c->settings->common.quiet && !to_stdout) print_table(c);
    const iso_status status = write_json(c, error);
    if (status != ISO_OK) iso_file_remove(c->settings->output);
    return status;
}

static void free_comparison(comparison *c) {
    for (int i = 0; i < 2; i++) {
        side *s = &c->sides[i];
        iso_scene_surface_free(&s->surface);
        iso_scene_object_free(&s->object);
        iso_distance_destroy(s->distance);
        iso_triangles_free(&s->mesh);
        if (s->path && !s->is_mesh && s->loader.input) iso_loader_close(&s->loader);
        for (int view = 0; view < VIEWS; view++) free(s->pictures[view].bytes);
        free(s->path);
    }
    iso_file_set_free(&c->files);
    free(c);
}

static comparison *make_comparison(const isocompare_settings *settings, iso_pool *pool, iso_error *error) {
    comparison *c = calloc(1, sizeof *c);
    if (!c) iso_fail(error, ISO_ERR_NOMEM, "out of memory");
    if (c) c->settings = settings, c->pool = pool;
    return c;
}

iso_status isocompare_surfaces(const isocompare_settings *settings, iso_pool *pool, iso_error *error) {
    comparison *c = make_comparison(settings, pool, error);
    if (!c) return ISO_ERR_NOMEM;
    const iso_status status = compare(c, error);
    free_comparison(c);
    return status;
}

iso_status isocompare_pair(const isocompare_settings *settings, iso_pool *pool, iso_image *image,
                           iso_surfaces_compared *result, iso_error *error) {
    comparison *c = make_comparison(settings, pool, error);
    iso_camera camera;
    if (!c) return ISO_ERR_NOMEM;
    iso_status status = measure(c, error);
    if (status == ISO_OK) status = prepare_picture(&c->sides[0], &c->sides[1], most(c), error);
    if (status == ISO_OK) status = look(c, 0, &camera, error);
    if (status == ISO_OK) status = paint(c, &c->sides[0], &camera, image, error);
    *result = c->result;
    free_comparison(c);
    return status;
}
