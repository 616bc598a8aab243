/* images: the command "isocompare images", which compares two pictures from PNG or EXR files, or both. */
#include <math.h>
#include <string.h>

#include "apps/common/json.h"
#include "apps/isocompare/isocompare.h"
#include "base/file.h"
#include "base/file_types.h"
#include "base/memory.h"
#include "base/text.h"
#include "scene/picture_file.h"

/* One picture of the comparison, and its files. */
typedef struct side {
    const char *path, *aov_path;
    iso_image image;
    iso_aov aov;
    iso_compare_picture picture;
} side;

typedef struct comparison {
    const isocompare_settings *settings;
    iso_pool *pool;
    side sides[2];
    double voxel;
    float *map; /* FLIP differences, or NULL */
    iso_metrics metrics;
} comparison;

/* ---- reading ---- */

static bool is_exr(const char *path) {
    return iso_file_type_of_name(path, ISO_WRITES_CHANNELS) != ISO_FILE_UNKNOWN;
}

static iso_status read_aov(side *s, iso_pool *pool, iso_error *error) {
    ISO_TRY(iso_exr_read(s->aov_path, pool, &s->aov, error));
    if (s->image.rgba && (s->aov.width != s->image.width || s->aov.height != s->image.height))
        return iso_fail(error, ISO_ERR_MISMATCH, "%s is %dx%d, but %s is %dx%d", s->path, s->image.width,
                        s->image.height, s->aov_path, s->aov.width, s->aov.height);
    return ISO_OK;
}

static iso_status read_side(side *s, iso_pool *pool, iso_error *error) {
    if (is_exr(s->path) && s->aov_path)
        return iso_fail(error, ISO_ERR_USAGE, "%s is an .exr itself: it takes no other", s->path);
    if (is_exr(s->path))
        s->aov_path = s->path;
    else
        ISO_TRY(iso_png_read(s->path, &s->image, error));
    if (s->aov_path) ISO_TRY(read_aov(s, pool, error));
    bool image = s->image.rgba != NULL;
    s->picture = (iso_compare_picture){.width = image ? s->image.width : s->aov.width,
                                       .height = image ? s->image.height : s->aov.height,
                                       .rgba = s->image.rgba,
                                       .depth = s->aov.depth,
                                       .normal = {s->aov.normal[0], s->aov.normal[1], s->aov.normal[2]},
                                       .coverage = s->aov.coverage};
    return ISO_OK;
}

/* ---- output ---- */

static const char *source_text(const comparison *c, int which, char *text, size_t size) {
    iso_silhouette_source source = c->metrics.sources[which];
    iso_rgb b = c->settings->background;
    if (source == ISO_SILHOUETTE_BACKGROUND)
        snprintf(text, size, "all that is not %02X%02X%02X", b.r, b.g, b.b);
    else
        snprintf(text, size, "from %s", iso_silhouette_source_name(source));
    return text;
}

static void print_table(const comparison *c) {
    static const char *const titles[] = {"truth", "candidate"};
    char text[64];
    for (int i = 0; i < 2; i++) {
        printf("%-20s ", titles[i]);
        iso_text_put(stdout, c->sides[i].path);
        printf(", %dx%d; silhouette: %s\n", c->sides[i].picture.width, c->sides[i].picture.height,
               source_text(c, i, text, sizeof text));
    }
    size_t count;
    const iso_metric *list = iso_metric_list(&count);
    for (size_t i = 0; i < count; i++) {
        const double value = isocompare_metric_value(&list[i], &c->metrics);
        printf("%-20s %12s %-7s %s\n", list[i].name, isocompare_metric_text(value, "%.6g", text, sizeof text),
               isfinite(value) ? list[i].unit : "", list[i].title);
    }
}

static void put_side(iso_json *json, const char *key, const comparison *c, int which) {
    const side *s = &c->sides[which];
    iso_json_begin_object(json, key);
    iso_json_string(json, "path", s->path);
    iso_json_string(json, "aov", s->aov_path);
    iso_json_string(json, "silhouette", iso_silhouette_source_name(c->metrics.sources[which]));
    iso_json_integer(json, "covered", c->metrics.covered[which]);
    iso_json_end_object(json);
}

static void put_bounds(iso_json *json, const comparison *c) {
    const isocompare_settings *settings = c->settings;
    bool passed = true;
    iso_json_begin_array(json, "bounds");
    for (int i = 0; i < settings->bound_count; i++) {
        const isocompare_bound *bound = &settings->bounds[i];
        double value = isocompare_metric_value(bound->metric, &c->metrics);
        bool good = !iso_metric_is_worse(bound->metric, value, bound->value);
        iso_json_begin_object(json, NULL);
        iso_json_string(json, "metric", bound->metric->name);
        iso_json_real(json, "bound", bound->value);
        isocompare_put_metric(json, "value", value);
        iso_json_bool(json, "passed", good);
        iso_json_end_object(json);
        passed = passed && good;
    }
    iso_json_end_array(json);
    iso_json_bool(json, "passed", passed);
}

static void put_comparison(iso_json *json, const comparison *c) {
    char background[8];
    iso_rgb b = c->settings->background;
    snprintf(background, sizeof background, "%02X%02X%02X", b.r, b.g, b.b);
    iso_json_begin_object(json, NULL);
    iso_json_string(json, "schema", "isocompare-images/1");
    iso_json_string(json, "version", isocompare_program()->version);
    iso_json_integer(json, "width", (uint64_t)c->sides[0].picture.width);
    iso_json_integer(json, "height", (uint64_t)c->sides[0].picture.height);
    put_side(json, "truth", c, 0);
    put_side(json, "candidate", c, 1);
    iso_json_string(json, "background", background);
    iso_json_real(json, "voxel", c->voxel > 0 ? c->voxel : NAN);
    iso_json_begin_object(json, "metrics");
    size_t count;
    const iso_metric *list = iso_metric_list(&count);
    for (size_t i = 0; i < count; i++)
        isocompare_put_metric(json, list[i].name, isocompare_metric_value(&list[i], &c->metrics));
    iso_json_end_object(json);
    put_bounds(json, c);
    iso_json_end_object(json);
}

static iso_status write_json(const comparison *c, iso_error *error) {
    iso_sink sink = {0};
    ISO_TRY(iso_sink_open(c->settings->common.json_path ? c->settings->common.json_path : "-", &sink, error));
    iso_json json = {0};
    put_comparison(&json, c);
    return iso_json_commit(&json, &sink, error);
}

static iso_status write_difference(const comparison *c, iso_error *error) {
    const iso_compare_picture *picture = &c->sides[0].picture;
    iso_image image;
    ISO_TRY(iso_image_create(picture->width, picture->height, &image, error));
    size_t count = (size_t)image.width * (size_t)image.height;
    for (size_t i = 0; i < count; i++) {
        memset(image.rgba + 4 * i, (int)(c->map[i] * 255 + 0.5f), 3);
        image.rgba[4 * i + 3] = 255;
    }
    const iso_picture_facts facts = {.description = "LDR-FLIP, 0 black, 1 white"};
    const iso_status status = iso_picture_file_write(c->settings->difference, &image, NULL, &facts, error);
    iso_image_free(&image);
    return status;
}

/* Checks the bounds of --fail-under; the message lists all that are exceeded. */
static iso_status check_bounds(const comparison *c, iso_error *error) {
    char text[400] = "";
    size_t used = 0;
    for (int i = 0; i < c->settings->bound_count && used < sizeof text; i++) {
        const isocompare_bound *bound = &c->settings->bounds[i];
        double value = isocompare_metric_value(bound->metric, &c->metrics);
        if (!iso_metric_is_worse(bound->metric, value, bound->value)) continue;
        used += (size_t)snprintf(text + used, sizeof text - used, "%s%s is %.6g, not at %s %.6g",
                                 used ? "; " : "", bound->metric->name, value,
                                 bound->metric->larger_is_better ? "least" : "most", bound->value);
    }
    if (!used) return ISO_OK;
    return iso_fail(error, ISO_ERR_MISMATCH, "%s: %s", c->sides[1].path, text);
}

/* ---- one comparison ---- */

static iso_status check_outputs(const isocompare_settings *settings, iso_error *error) {
    const char *inputs[] = {settings->truth, settings->candidate, settings->truth_aov,
                            settings->candidate_aov};
    iso_file_set files = {0};
    for (int i = 0; i < 4; i++)
        if (inputs[i]) iso_file_set_read(&files, inputs[i]);
    iso_file_set_write(&files, settings->difference);
    iso_file_set_write(&files, settings->common.json_path);
    iso_status status = iso_file_set_check(&files, error);
    iso_file_set_free(&files);
    if (status == ISO_OK) status = iso_sink_check(settings->difference, error);
    return status == ISO_OK ? iso_sink_check(settings->common.json_path, error) : status;
}

/* Checks the memory for the pictures before anything is decoded: for the pictures themselves, the metrics
 * (colours and silhouettes of both pictures, distances to a silhouette) and the picture of differences. */
static iso_status check_memory(const isocompare_settings *settings, iso_error *error) {
    enum { PNG_BYTES = 4, EXR_BYTES = 20, METRIC_BYTES = 16, DIFFERENCE_BYTES = 8 };
    const char *const files[] = {settings->truth, settings->candidate, settings->truth_aov,
                                 settings->candidate_aov};
    const uint64_t limit = iso_memory_limit(settings->common.input.max_memory);
    uint64_t needs = 0, most = 0;
    for (int i = 0; i < 4; i++) {
        uint32_t size[2];
        bool exr = files[i] && is_exr(files[i]);
        if (!files[i] || !(exr ? iso_exr_size(files[i], size) : iso_png_size(files[i], size))) continue;
        if (size[0] > ISO_IMAGE_MAX || size[1] > ISO_IMAGE_MAX) continue; /* the reader reports it */
        uint64_t pixels = (uint64_t)size[0] * size[1];
        needs += pixels * (exr ? EXR_BYTES : PNG_BYTES);
        if (pixels > most) most = pixels;
    }
    needs += most * (METRIC_BYTES + (settings->difference ? DIFFERENCE_BYTES : 0));
    if (needs <= limit) return ISO_OK;
    return iso_fail(error, ISO_ERR_LIMIT,
                    "%s: comparing %.0f million pixels needs %.0f MB, limit is %.0f MB (--max-memory)",
                    settings->truth, (double)most / 1e6, (double)needs / 1e6, (double)limit / 1e6);
}

static iso_status prepare(comparison *c, iso_error *error) {
    const isocompare_settings *settings = c->settings;
    ISO_TRY(check_outputs(settings, error));
    ISO_TRY(check_memory(settings, error));
    for (int i = 0; i < 2; i++) ISO_TRY(read_side(&c->sides[i], c->pool, error));
    c->voxel = settings->voxel > 0 ? settings->voxel : (double)c->sides[0].aov.voxel;
    const iso_compare_picture *a = &c->sides[0].picture, *b = &c->sides[1].picture;
    if (!(a->rgba && b->rgba) && !(a->coverage && b->coverage))
        return iso_fail(error, ISO_ERR_USAGE,
                        "a .png and an .exr have nothing in common: see --aov-a, --aov-b");
    if (!settings->difference) return ISO_OK;
    if (!a->rgba || !b->rgba)
        return iso_fail(error, ISO_ERR_USAGE, "--difference needs two pictures with colours");
    c->map = iso_alloc((size_t)a->width * (size_t)a->height * sizeof *c->map);
    return c->map ? ISO_OK : iso_fail(error, ISO_ERR_NOMEM, "out of memory");
}

static iso_status compare(comparison *c, iso_error *error) {
    const isocompare_settings *settings = c->settings;
    ISO_TRY(prepare(c, error));
    iso_compare_opts opts = {.background = settings->background,
                             .voxel = c->voxel,
                             .pixels_per_voxel = settings->pixels_per_voxel,
                             .pixels_per_degree = settings->pixels_per_degree,
                             .flip_map = c->map,
                             .pool = c->pool};
    ISO_TRY(iso_compare(&c->sides[0].picture, &c->sides[1].picture, &opts, &c->metrics, error));
    if (settings->difference) ISO_TRY(write_difference(c, error));
    bool to_stdout = settings->common.json && !settings->common.json_path;
    if (!settings->common.quiet && !to_stdout) print_table(c);
    iso_status status = settings->common.json ? write_json(c, error) : ISO_OK;
    if (status != ISO_OK)
        iso_file_remove(settings->difference); /* no output is left unless all are written */
    ISO_TRY(status);
    return check_bounds(c, error);
}

iso_status isocompare_images(const isocompare_settings *settings, iso_pool *pool, iso_error *error) {
    comparison c = {.settings = settings,
                    .pool = pool,
                    .sides = {{.path = settings->truth, .aov_path = settings->truth_aov},
                              {.path = settings->candidate, .aov_path = settings->candidate_aov}}};
    iso_status status = compare(&c, error);
    for (int i = 0; i < 2; i++) {
        iso_image_free(&c.sides[i].image);
        iso_aov_free(&c.sides[i].aov);
    }
    iso_free(c.map);
    return status;
}
