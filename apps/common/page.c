/* Writes pages: chooses the range of isovalues, packs the voxels that it needs, and fills in the template. */
#include "apps/common/page.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <zlib.h>

#include "apps/common/json.h"
#include "apps/common/page_files.h"
#include "base/file.h"
#include "base/file_types.h"
#include "base/html.h"
#include "base/memory.h"
#include "grids/brick_index.h"
#include "grids/kept.h"
#include "image/image.h"

bool iso_page_is_named(const char *path) {
    return iso_file_type_of_name(path, ISO_WRITES_PAGE) != ISO_FILE_UNKNOWN;
}

static const iso_page_file *find_file(const char *name) {
    const iso_page_file *file = iso_page_files;
    while (file->name && strcmp(file->name, name) != 0) file++;
    return file->name ? file : NULL;
}

iso_status iso_page_check(const char *path, iso_error *error) {
    if (find_file("opaque.wasm.gz")) return ISO_OK;
    return iso_fail(error, ISO_ERR_BACKEND,
                    "%s: built without pages: their engine needs the packages clang-14, lld-14, "
                    "libclang-rt-14-dev-wasm32 and wasi-libc when Isopoint is built",
                    path);
}

/* ---- bytes as text */

static uint64_t base64_length(uint64_t bytes) {
    return (bytes + 2) / 3 * 4;
}

/* ---- voxels */

static size_t voxel_count(const int dims[3]) {
    return (size_t)dims[0] * (size_t)dims[1] * (size_t)dims[2];
}

typedef struct packed {
    unsigned char *bytes;
    size_t size;
    double range[2];
    size_t kept;
} packed;

/* Packs bytes as gzip does. p->size becomes 0 if they take more than `most`. ISO_ERR_NOMEM. */
static iso_status pack(const void *bytes, size_t count, size_t most, int level, packed *p, iso_error *error) {
    z_stream z = {0};
    const size_t step = (size_t)1 << 26; /* zlib counts in 32 bits */
    p->size = 0;
    if (deflateInit2(&z, level, Z_DEFLATED, MAX_WBITS + 16, 9, Z_DEFAULT_STRATEGY) != Z_OK)
        return iso_fail(error, ISO_ERR_NOMEM, "out of memory for a page");
    z.next_out = p->bytes;
    z.avail_out = (uInt)most;
    int code = Z_OK;
    for (size_t at = 0; code == Z_OK && at < count; at += step) {
        const size_t part = count - at < step ? count - at : step;
        z.next_in = (Bytef *)bytes + at;
        z.avail_in = (uInt)part;
        code = deflate(&z, at + part == count ? Z_FINISH : Z_NO_FLUSH);
        if (z.avail_in) break; /* `most` is reached */
    }
    if (code == Z_STREAM_END) p->size = (size_t)z.total_out;
    deflateEnd(&z);
    return ISO_OK;
}

typedef struct packer {
    const iso_page *page;
    void *voxels; /* as they are kept */
    size_t bytes; /* of them */
    size_t most;  /* of packed ones */
    packed best, tried;
} packer;

/* Packs the voxels of a range; it becomes the best one if they fit. */
static iso_status try_range(packer *p, double low, double high, bool *fits, iso_error *error) {
    p->tried.range[0] = low;
    p->tried.range[1] = high;
    ISO_TRY(iso_kept_copy(p->page->grid, low, high, p->voxels, &p->tried.kept, p->page->pool, error));
    ISO_TRY(pack(p->voxels, p->bytes, p->most, Z_BEST_COMPRESSION, &p->tried, error));
    *fits = p->tried.size > 0;
    if (!*fits) return ISO_OK;
    const packed swap = p->best;
    p->best = p->tried;
    p->tried = swap;
    return ISO_OK;
}

/* The ends of the isovalues that are drawn, and of all values. */
typedef struct ends {
    double low, high, least, greatest;
} ends;

static ends ends_of(const iso_page *page) {
    const iso_rgrid *grid = page->grid;
    ends e = {INFINITY, -INFINITY, 0, 0};
    iso_brick_index_extremes(grid->index, &e.least, &e.greatest);
    e.least = e.least * grid->scale + grid->offset;
    e.greatest = e.greatest * grid->scale + grid->offset;
    for (int i = 0; i < page->count; i++) {
        e.low = fmin(e.low, page->surfaces[i].isovalue);
        e.high = fmax(e.high, page->surfaces[i].isovalue);
    }
    return e;
}

/* A number of three digits between `inner` and `outer`, as near to `outer` as there is one; `outer` if none
 * is. */
static double round_inwards(double outer, double inner) {
    const double step = pow(10, floor(log10(fabs(outer - inner))) - 1);
    const double rounded = (outer > inner ? floor(outer / step) : ceil(outer / step)) * step;
    char text[32];
    snprintf(text, sizeof text, "%.10g", rounded);
    const double made = strtod(text, NULL);
    return isfinite(made) && (made - inner) * (outer - made) >= 0 ? made : outer;
}

/* The range that goes the part `share` of the way from the isovalues to the ends of all values. */
static void range_of(const ends *e, double share, double range[2]) {
    const double low = e->low - share * fmax(0, e->low - e->least),
                 high = e->high + share * fmax(0, e->greatest - e->high);
    range[0] = low < e->low ? round_inwards(low, e->low) : low;
    range[1] = high > e->high ? round_inwards(high, e->high) : high;
}

/* Whether a range would fit, judged by slabs of slices here and there, packed less well. */
static iso_status judge_range(packer *p, const double range[2], bool *fits, iso_error *error) {
    enum { SLABS = 4, SLICES = 16 };
    const iso_rgrid *grid = p->page->grid;
    const int nz = grid->dims[2];
    const bool whole = nz <= 2 * SLABS * SLICES;
    const int slabs = whole ? 1 : SLABS, slices = whole ? nz : SLICES;
    double bytes = 0;
    for (int i = 0; i < slabs; i++) {
        const int first = whole ? 0 : (2 * i + 1) * nz / (2 * SLABS) - SLICES / 2;
        const size_t size = iso_type_size(grid->type);
        iso_rgrid slab = *grid;
        slab.dims[2] = slices;
        slab.data = (char *)grid->data + (size_t)first * (size_t)grid->stride_z * size;
        ISO_TRY(iso_kept_copy(&slab, range[0], range[1], p->voxels, NULL, p->page->pool, error));
        ISO_TRY(pack(p->voxels, p->bytes / (size_t)nz * (size_t)slices, p->most, 4, &p->tried, error));
        bytes += p->tried.size ? (double)p->tried.size : INFINITY;
    }
    *fits = bytes * nz / (slabs * slices) <= (double)p->most;
    return ISO_OK;
}

/* Finds the widest range that should fit: halves it until one does, then tries three times between that and
 * the last one that does not. Then packs it; the estimate may have been too good. */
static iso_status find_range(packer *p, iso_error *error) {
    enum { HALVINGS = 8, REFINEMENTS = 3, SHRINKINGS = 12 };
    const ends e = ends_of(p->page);
    double share = 1, wider = 1, range[2];
    bool fits = false;
    for (int i = 0; !fits && i <= HALVINGS; i++) {
        wider = share;
        share = i == 0 ? 1 : i == HALVINGS ? 0 : share / 2;
        range_of(&e, share, range);
        ISO_TRY(judge_range(p, range, &fits, error));
    }
    for (int i = 0; fits && share < 1 && i < REFINEMENTS; i++) {
        const double middle = (share + wider) / 2;
        bool also;
        range_of(&e, middle, range);
        ISO_TRY(judge_range(p, range, &also, error));
        if (also)
            share = middle;
        else
            wider = middle;
    }
    fits = false;
    for (int i = 0; !fits && i <= SHRINKINGS; i++) {
        range_of(&e, i < SHRINKINGS ? share : 0, range);
        ISO_TRY(try_range(p, range[0], range[1], &fits, error));
        share *= i < 4 ? 0.93 : 0.6;
    }
    return ISO_OK;
}

static iso_status pack_voxels(packer *p, const char *path, iso_error *error) {
    const double *range = p->page->range;
    const ends e = ends_of(p->page);
    bool fits;
    if (isnan(range[0]))
        ISO_TRY(find_range(p, error));
    else
        ISO_TRY(try_range(p, fmin(range[0], e.low), fmax(range[1], e.high), &fits, error));
    if (p->best.size) return ISO_OK;
    return iso_fail(error, ISO_ERR_LIMIT, "%s: the voxels of %s take more than %.1f MB: %s", path,
                    isnan(range[0]) ? "the isovalue alone" : "this range of isovalues", (double)p->most / 1e6,
                    isnan(range[0]) ? "--page-size allows more, --crop leaves less"
                                    : "--isovalue-range may be narrower, or --page-size allow more");
}

/* ---- labels */

static size_t label_bytes(const iso_page_labels *labels) {
    return labels->count <= 256 ? 1 : 2;
}

/* Packs the labels: as bytes if there are few. Sets p->bytes, to be freed. */
static iso_status pack_labels(const iso_page_labels *labels, size_t most, packed *p, iso_error *error) {
    const size_t count = voxel_count(labels->dims);
    const bool narrow = label_bytes(labels) == 1;
    uint8_t *bytes = narrow ? iso_alloc(count) : NULL;
    p->bytes = iso_alloc(most);
    iso_status status = ISO_OK;
    if (!p->bytes || (narrow && !bytes))
        status = iso_fail(error, ISO_ERR_NOMEM, "out of memory for the labels of a page");
    for (size_t i = 0; bytes && i < count; i++) bytes[i] = (uint8_t)labels->number[i];
    if (status == ISO_OK)
        status = narrow ? pack(bytes, count, most, Z_BEST_COMPRESSION, p, error)
                        : pack(labels->number, 2 * count, most, Z_BEST_COMPRESSION, p, error);
    iso_free(bytes);
    return status;
}

/* ---- lines */

/* What apps/page/lines.c takes, in its order: the arrays of lines. */
typedef struct line_arrays {
    const void *data[5];
    size_t bytes[5];
} line_arrays;

enum { STARTS = 3 }; /* which are numbers of 32 bits there */

static line_arrays arrays_of(const iso_lines *l) {
    const size_t n = l->vertex_count;
    return (line_arrays){{l->vertices, l->radii, l->normals, l->starts, l->colors},
                         {n * sizeof *l->vertices, l->radii ? n * sizeof *l->radii : 0,
                          l->normals ? n * sizeof *l->normals : 0, (l->line_count + 1) * sizeof(uint32_t),
                          l->colors ? n * sizeof *l->colors : 0}};
}

static size_t lines_bytes(const iso_lines *lines) {
    const line_arrays arrays = arrays_of(lines);
    size_t sum = 0;
    for (int i = 0; i < 5; i++) sum += arrays.bytes[i];
    return (sum + 7) / 8 * 8; /* floats of the next lines are aligned */
}

static void put_arrays(const iso_lines *lines, char *to) {
    const line_arrays arrays = arrays_of(lines);
    memset(to, 0, lines_bytes(lines));
    for (int i = 0; i < 5; i++) {
        if (i == STARTS)
            for (size_t k = 0; k <= lines->line_count; k++)
                ((uint32_t *)(void *)to)[k] = (uint32_t)lines->starts[k];
        else if (arrays.bytes[i])
            memcpy(to, arrays.data[i], arrays.bytes[i]);
        to += arrays.bytes[i];
    }
}

/* Packs all lines. Sets p->bytes, to be freed. */
static iso_status pack_lines(const iso_page *page, size_t most, packed *p, iso_error *error) {
    size_t sum = 0, at = 0;
    for (int i = 0; i < page->lines_count; i++) sum += lines_bytes(&page->lines[i].lines);
    char *bytes = iso_alloc(sum);
    p->bytes = iso_alloc(most);
    iso_status status = ISO_OK;
    if (!bytes || !p->bytes) status = iso_fail(error, ISO_ERR_NOMEM, "out of memory for the lines of a page");
    for (int i = 0; i < page->lines_count && status == ISO_OK; i++) {
        put_arrays(&page->lines[i].lines, bytes + at);
        at += lines_bytes(&page->lines[i].lines);
    }
    if (status == ISO_OK) status = pack(bytes, sum, most, Z_BEST_COMPRESSION, p, error);
    iso_free(bytes);
    return status;
}

/* ---- the first picture */

enum { STILL = 512, STEP = 8 }; /* most pixels on a side; between values of a channel */

/* Makes the picture that is seen first smaller: means of squares of pixels, with fewer values. */
static iso_status make_still(const iso_image *from, iso_image *still, iso_error *error) {
    const int longest = from->width > from->height ? from->width : from->height,
              n = (longest + STILL - 1) / STILL, width = from->width / n ? from->width / n : 1,
              height = from->height / n ? from->height / n : 1;
    ISO_TRY(iso_image_create(width, height, still, error));
    for (int y = 0; y < height; y++)
        for (int i = 0; i < 4 * width; i++) {
            int sum = 0, count = 0;
            for (int v = y * n; v < (y + 1) * n && v < from->height; v++)
                for (int u = i / 4 * n; u < (i / 4 + 1) * n && u < from->width; u++, count++)
                    sum += from->rgba[((size_t)v * (size_t)from->width + (size_t)u) * 4 + (size_t)(i % 4)];
            const int mean = (sum + count / 2) / count, rounded = (mean + STEP / 2) / STEP * STEP;
            still->rgba[(size_t)y * (size_t)width * 4 + (size_t)i] = (uint8_t)(rounded < 255 ? rounded : 255);
        }
    return ISO_OK;
}

static iso_status encode_still(const iso_page *page, unsigned char **png, size_t *size, iso_error *error) {
    const iso_png_opts opts = {.small = true, .pool = page->pool};
    iso_image still = {0};
    iso_status status = make_still(page->image, &still, error);
    if (status == ISO_OK) status = iso_png_encode(&still, &opts, png, size, error);
    iso_image_free(&still);
    return status;
}

/* ---- the page */

static void put_vector(iso_json *json, const char *key, iso_vec3 v) {
    iso_json_reals(json, key, (const double[3]){v.x, v.y, v.z}, 3);
}

static void put_color(iso_json *json, const char *key, iso_rgb c) {
    iso_json_integer(json, key, (uint64_t)(c.r << 16 | c.g << 8 | c.b));
}

static void put_translucency(iso_json *json, const iso_translucency *t) {
    iso_json_real(json, "opacity", (double)t->opacity);
    iso_json_bool(json, "constant", t->constant);
    iso_json_real(json, "absorption", (double)t->absorption_length);
    iso_json_integer(json, "layers", (uint64_t)t->most_layers);
}

static void put_surfaces(iso_json *json, const char *key, const iso_page_surface *surfaces, int count) {
    iso_json_begin_array(json, key);
    for (int i = 0; i < count; i++) {
        const iso_page_surface *s = &surfaces[i];
        iso_json_begin_object(json, NULL);
        iso_json_real(json, "isovalue", s->isovalue);
        put_color(json, "color", s->color);
        put_translucency(json, &s->translucency);
        iso_json_end_object(json);
    }
    iso_json_end_array(json);
}

/* The surfaces of groups of labels, and all labels. */
static void put_labels(iso_json *json, const iso_page_labels *labels) {
    iso_json_begin_object(json, "labels");
    iso_json_ints(json, "dims", labels->dims, 3);
    iso_json_integer(json, "type", label_bytes(labels) == 1 ? ISO_UINT8 : ISO_UINT16);
    iso_json_reals(json, "transform", (const double *)labels->transform, 15);
    iso_json_integer(json, "shared", (uint64_t)labels->shared);
    put_surfaces(json, "groups", labels->groups, labels->group_count);
    iso_json_begin_array(json, "items");
    for (int i = 1; i < labels->count; i++) {
        const iso_page_label *item = &labels->items[i];
        iso_json_begin_object(json, NULL);
        iso_json_integer(json, "group", (uint64_t)item->group);
        if (item->group) iso_json_string(json, "name", item->name); /* what is not drawn is not named */
        if (item->group) put_color(json, "color", item->color);
        iso_json_end_object(json);
    }
    iso_json_end_array(json);
    iso_json_end_object(json);
}

static void put_lines(iso_json *json, const iso_page *page) {
    iso_json_begin_array(json, "lines");
    for (int i = 0; i < page->lines_count; i++) {
        const iso_page_lines *item = &page->lines[i];
        const iso_lines *l = &item->lines;
        iso_json_begin_object(json, NULL);
        iso_json_integer(json, "vertices", l->vertex_count);
        iso_json_integer(json, "lines", l->line_count);
        iso_json_integer(json, "bytes", lines_bytes(l));
        iso_json_integer(json, "has", (l->radii ? 1 : 0) | (l->normals ? 2 : 0) | (l->colors ? 4 : 0));
        put_vector(json, "origin", l->origin);
        iso_json_real(json, "radius", item->opts.radius);
        iso_json_real(json, "minPixels", item->opts.min_pixels);
        iso_json_integer(json, "style", item->opts.style);
        iso_json_integer(json, "caps", item->opts.caps);
        put_color(json, "color", item->color);
        put_translucency(json, &item->translucency);
        iso_json_end_object(json);
    }
    iso_json_end_array(json);
}

/* The box of everything, as a volume of two voxels along each axis. */
static void put_box(iso_json *json, const iso_box *box) {
    const iso_vec3 size = iso_vec3_sub(box->hi, box->lo);
    const double transform[15] = {box->lo.x, box->lo.y, box->lo.z, size.x, size.y, size.z, 1, 0,
                                  0,         0,         1,         0,      0,      0,      1};
    iso_json_begin_object(json, "box");
    iso_json_ints(json, "dims", (const int[3]){2, 2, 2}, 3);
    iso_json_reals(json, "transform", transform, 15);
    iso_json_end_object(json);
}

/* The volume, and which isovalues there are voxels for. */
static void put_volume(iso_json *json, const iso_rgrid *grid, const double range[2]) {
    iso_json_begin_object(json, "volume");
    iso_json_ints(json, "dims", grid->dims, 3);
    iso_json_integer(json, "type", (uint64_t)grid->type);
    iso_json_real(json, "scale", grid->scale);
    iso_json_real(json, "offset", grid->offset);
    iso_json_reals(json, "transform", (const double *)&grid->transform, 15);
    iso_json_integer(json, "levelSet", (uint64_t)grid->level_set);
    iso_json_reals(json, "range", range, 2);
    iso_json_end_object(json);
}

static void put_camera(iso_json *json, const iso_camera *camera) {
    iso_json_begin_object(json, "camera");
    put_vector(json, "position", camera->position);
    put_vector(json, "focal", camera->focal_point);
    put_vector(json, "up", camera->view_up);
    iso_json_real(json, "angle", camera->view_angle);
    iso_json_real(json, "scale", camera->parallel_scale);
    iso_json_bool(json, "orthographic", camera->orthographic);
    iso_json_end_object(json);
}

/* Writes what the page's script has to know, as JSON that may stand in an element of HTML. */
static iso_status put_facts(FILE *stream, const iso_page *page, const packed *voxels, iso_error *error) {
    iso_json json = {.one_line = true};
    iso_json_begin_object(&json, NULL);
    iso_json_string(&json, "name", page->name);
    iso_json_bool(&json, "withoutInput", page->without_input);
    if (page->grid) put_volume(&json, page->grid, voxels->range);
    put_surfaces(&json, "surfaces", page->surfaces, page->count);
    if (page->labels) put_labels(&json, page->labels);
    put_lines(&json, page);
    if (!page->grid && !page->labels) put_box(&json, &page->bounds);
    put_camera(&json, page->camera);
    put_color(&json, "background", page->background);
    iso_json_reals(&json, "plane", page->clip.plane, 4);
    iso_json_bool(&json, "cap", page->clip.cap);
    iso_json_ints(&json, "size", (const int[2]){page->image->width, page->image->height}, 2);
    if (page->options) iso_json_begin_array(&json, "options");
    for (int i = 0; i < page->option_count; i++) iso_json_string(&json, NULL, page->options[i]);
    if (page->options) iso_json_end_array(&json);
    iso_json_end_object(&json);
    char *text = NULL;
    size_t size;
    FILE *memory = open_memstream(&text, &size);
    iso_status status =
        memory ? iso_json_write(&json, memory, error) : iso_fail(error, ISO_ERR_NOMEM, "out of memory");
    if (!memory) iso_json_discard(&json);
    if (memory && !iso_memory_stream_close(memory, &text) && status == ISO_OK)
        status = iso_fail(error, ISO_ERR_NOMEM, "out of memory");
    for (const char *c = text; status == ISO_OK && *c; c++)
        if (*c == '<')
            fputs("\\u003c", stream);
        else
            putc(*c, stream);
    free(text);
    return status;
}

typedef struct parts {
    const iso_page *page;
    const packed *voxels, *labels, *lines;
    const iso_page_file *engine;
    unsigned char *png;
    size_t png_size;
} parts;

/* Writes what stands at a mark of the template. */
static iso_status put_part(FILE *stream, const char *mark, size_t length, const parts *p, iso_error *error) {
    const char *const names[] = {"NAME",   "PNG",   "FACTS", "ENGINE", "VOXELS",
                                 "LABELS", "LINES", "PAGE",  "WORKER"};
    size_t which = 0;
    while (strlen(names[which]) != length || strncmp(names[which], mark, length) != 0) which++;
    const iso_page_file *file = which == 7   ? find_file("page.js")
                                : which == 8 ? find_file("worker.js")
                                             : NULL;
    switch (which) {
    case 0:
        iso_html_text(stream, p->page->name);
        return ISO_OK;
    case 1:
        iso_html_base64(stream, p->png, p->png_size);
        return ISO_OK;
    case 2:
        return put_facts(stream, p->page, p->voxels, error);
    case 3:
        iso_html_base64(stream, p->engine->bytes, p->engine->size);
        return ISO_OK;
    case 4:
        iso_html_base64(stream, p->voxels->bytes, p->voxels->size);
        return ISO_OK;
    case 5:
        iso_html_base64(stream, p->labels->bytes, p->labels->size);
        return ISO_OK;
    case 6:
        iso_html_base64(stream, p->lines->bytes, p->lines->size);
        return ISO_OK;
    default:
        fwrite(file->bytes, 1, file->size, stream);
        return ISO_OK;
    }
}

/* Writes the template, with parts at its marks {{NAME}}. */
static iso_status put_page(FILE *stream, const parts *p, iso_error *error) {
    const iso_page_file *template = find_file("page.html");
    const char *at = (const char *)template->bytes, *end = at + template->size;
    while (at < end) {
        const char *mark = at;
        while (mark < end && !(mark + 1 < end && mark[0] == '{' && mark[1] == '{')) mark++;
        fwrite(at, 1, (size_t)(mark - at), stream);
        if (mark == end) break;
        const char *name = mark + 2, *close = memchr(name, '}', (size_t)(end - name));
        ISO_TRY(put_part(stream, name, (size_t)(close - name), p, error));
        at = close + 2;
    }
    return ISO_OK;
}

static const iso_page_file *choose_engine(const iso_page *page) {
    bool layers = false;
    for (int i = 0; i < page->count; i++) layers |= page->surfaces[i].translucency.opacity < 1;
    return find_file(page->lines_count ? "lines.wasm.gz"
                     : page->labels    ? "labels.wasm.gz"
                     : layers          ? "layers.wasm.gz"
                                       : "opaque.wasm.gz");
}

/* How many packed bytes of voxels, labels and lines there can be: what the other parts leave. */
static iso_status find_room(const iso_page *page, const char *path, const parts *made, size_t *room,
                            iso_error *error) {
    const bool given = !isnan(page->range[0]);
    const uint64_t most = page->most ? page->most
                          : given    ? ISO_PAGE_BYTES_GIVEN
                                     : ISO_PAGE_BYTES,
                   texts = 40000,
                   others = texts + base64_length(made->engine->size) + base64_length(made->png_size);
    if (most <= others + 1000)
        return iso_fail(error, ISO_ERR_LIMIT, "%s: --page-size: a page takes %.1f MB without its voxels",
                        path, (double)others / 1e6);
    const uint64_t left = (most - others) / 4 * 3;
    *room = (size_t)(left < UINT32_MAX / 2 ? left : UINT32_MAX / 2);
    return ISO_OK;
}

/* Packs the volume, into *best, whose bytes are to be freed. */
static iso_status pack_volume(const iso_page *page, const char *path, size_t most, packed *best,
                              iso_error *error) {
    packer p = {
        .page = page, .bytes = voxel_count(page->grid->dims) * iso_type_size(page->grid->type), .most = most};
    ISO_TRY(iso_brick_index_of(page->grid, page->pool, NULL, error));
    p.voxels = iso_alloc(p.bytes);
    p.best.bytes = iso_alloc(p.most);
    p.tried.bytes = iso_alloc(p.most);
    const iso_status status = p.voxels && p.best.bytes && p.tried.bytes
                                  ? pack_voxels(&p, path, error)
                                  : iso_fail(error, ISO_ERR_NOMEM, "out of memory for the voxels of a page");
    iso_free(p.voxels);
    iso_free(p.tried.bytes);
    *best = p.best;
    return status;
}

/* Packs lines and labels, then the voxels of the volume into what they leave. */
static iso_status pack_all(const iso_page *page, const char *path, size_t room, packed *lines, packed *labels,
                           packed *voxels, iso_error *error) {
    enum { LEAST = 1000 }; /* for what is packed next */
    if (page->lines_count) {
        ISO_TRY(pack_lines(page, room, lines, error));
        if (!lines->size || room < lines->size + LEAST)
            return iso_fail(error, ISO_ERR_LIMIT,
                            "%s: the lines take more than %.1f MB: --page-size allows more", path,
                            (double)room / 1e6);
        room -= lines->size;
    }
    if (page->labels) {
        ISO_TRY(pack_labels(page->labels, room, labels, error));
        if (!labels->size || room < labels->size + LEAST)
            return iso_fail(error, ISO_ERR_LIMIT,
                            "%s: the labels take more than %.1f MB: --page-size allows more", path,
                            (double)room / 1e6);
    }
    return page->grid ? pack_volume(page, path, room - labels->size, voxels, error) : ISO_OK;
}

iso_status iso_page_put(FILE *stream, const char *path, const iso_page *page, iso_page_written *written,
                        iso_error *error) {
    packed voxels = {0}, labels = {0}, lines = {0};
    parts made = {.page = page, .voxels = &voxels, .labels = &labels, .lines = &lines};
    size_t room = 0;
    ISO_TRY(iso_page_check(path, error));
    made.engine = choose_engine(page);
    iso_status status = encode_still(page, &made.png, &made.png_size, error);
    if (status == ISO_OK) status = find_room(page, path, &made, &room, error);
    if (status == ISO_OK) status = pack_all(page, path, room, &lines, &labels, &voxels, error);
    if (status == ISO_OK) status = put_page(stream, &made, error);
    *written = (iso_page_written){
        .range = {voxels.range[0], voxels.range[1]},
        .engine_bytes = base64_length(made.engine->size),
        .voxel_bytes = base64_length(voxels.size),
        .label_bytes = base64_length(labels.size),
        .line_bytes = base64_length(lines.size),
        .kept = page->grid ? (double)voxels.kept / (double)voxel_count(page->grid->dims) : 0};
    free(made.png);
    iso_free(voxels.bytes);
    iso_free(labels.bytes);
    iso_free(lines.bytes);
    return status;
}

iso_status iso_page_write(const char *path, const iso_page *page, iso_page_written *written,
                          iso_error *error) {
    iso_sink sink;
    ISO_TRY(iso_sink_open(path, &sink, error));
    iso_status status = iso_page_put(sink.stream, path, page, written, error);
    const long bytes = ftell(sink.stream);
    written->bytes = bytes > 0 ? (uint64_t)bytes : 0;
    if (status == ISO_OK) status = iso_sink_commit(&sink, error);
    iso_sink_abort(&sink);
    return status;
}
