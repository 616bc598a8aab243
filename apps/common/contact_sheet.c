/* Contact sheets: processes, kept pictures, pages and pictures. */
#include "apps/common/contact_sheet.h"

#include <dirent.h>
#include <errno.h>
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/file_types.h"
#include "base/html.h"
#include "base/parse.h"
#include "base/text.h"
#include "scene/picture_file.h"

/* ---- processes */

void *iso_sheet_share(size_t bytes) {
    void *memory = mmap(NULL, bytes, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    return memory == MAP_FAILED ? NULL : memory;
}

void iso_sheet_unshare(void *memory, size_t bytes) {
    if (memory) munmap(memory, bytes);
}

iso_status iso_sheet_fork(int count, iso_sheet_work *work, void (*wake)(void *context), void *context,
                          iso_error *error) {
    int ends[2], started = 0;
    char bytes[64];
    if (pipe(ends) != 0) return iso_fail(error, ISO_ERR_NOMEM, "no pipe: %s", strerror(errno));
    fflush(NULL);
    for (; started < count; started++) {
        const pid_t child = fork();
        if (child < 0) break;
        if (child > 0) continue;
        close(ends[0]);
        work(context, ends[1]);
        _exit(0);
    }
    close(ends[1]);
    for (ssize_t got; (got = read(ends[0], bytes, sizeof bytes)) != 0;)
        if (got > 0 && wake)
            wake(context);
        else if (got < 0 && errno != EINTR)
            break;
    close(ends[0]);
    for (int i = 0; i < started; i++)
        while (wait(NULL) < 0 && errno == EINTR) continue;
    return started ? ISO_OK : iso_fail(error, ISO_ERR_NOMEM, "no process can be made: %s", strerror(errno));
}

iso_status iso_sheet_share_machine(iso_contact_sheet *s, int *threads, iso_error *error) {
    iso_pool *pool = NULL;
    ISO_TRY(iso_pool_create(0, &pool, error));
    const int processors = iso_pool_threads(pool);
    iso_pool_destroy(pool);
    if (!s->jobs) s->jobs = processors;
    if (s->jobs > s->count) s->jobs = s->count;
    if (!*threads) *threads = processors > s->jobs ? processors / s->jobs : 1;
    return ISO_OK;
}

/* ---- pictures that are kept */

static char *picture_path(const iso_contact_sheet *s, uint64_t key) {
    char *path = NULL, extension[ISO_FILE_EXTENSION];
    iso_file_type_extension(ISO_FILE_png, extension);
    return asprintf(&path, "%s/%016" PRIx64 "%s", s->folder, key, extension) < 0 ? NULL : path;
}

/* The values of a picture that is there. False: there is none, or it is none of ours. */
static bool find_kept(const char *path, double values[ISO_SHEET_VALUES]) {
    char *text = NULL;
    if (iso_png_read_text(path, "Values", &text, NULL) != ISO_OK) return false;
    int count = 0;
    for (const char *at = text; at && count < ISO_SHEET_VALUES; count++) {
        char number[40];
        snprintf(number, sizeof number, "%.*s", (int)strcspn(at, " "), at);
        values[count] = NAN;
        iso_parse_real(number, &values[count]);
        at = strchr(at, ' ');
        if (at) at++;
    }
    free(text);
    return count == ISO_SHEET_VALUES;
}

static iso_status keep(const char *path, const iso_image *image, const double values[ISO_SHEET_VALUES],
                       iso_error *error) {
    char text[ISO_SHEET_VALUES * 32];
    size_t used = 0;
    for (int i = 0; i < ISO_SHEET_VALUES; i++)
        used += isfinite(values[i]) ? (size_t)snprintf(text + used, sizeof text - used, "%.17g ", values[i])
                                    : (size_t)snprintf(text + used, sizeof text - used, "- ");
    text[used - 1] = 0;
    const iso_png_text texts[] = {{"Values", text}};
    const iso_png_opts opts = {.texts = texts, .text_count = 1};
    return iso_png_write_with(path, image, &opts, error);
}

static iso_status make_picture(iso_contact_sheet *s, int number, iso_error *error) {
    iso_sheet_panel *p = &s->panels[number];
    iso_image image = {0};
    for (int i = 0; i < ISO_SHEET_VALUES; i++) p->values[i] = NAN;
    ISO_TRY(s->find_key(s->context, number, &p->key, error));
    char *path = picture_path(s, p->key);
    if (!path) return iso_fail(error, ISO_ERR_NOMEM, "out of memory");
    p->kept = find_kept(path, p->values);
    iso_status status = ISO_OK;
    if (!p->kept) status = s->draw(s->context, number, &image, p->values, error);
    if (!p->kept && status == ISO_OK) status = keep(path, &image, p->values, error);
    iso_image_free(&image);
    free(path);
    return status;
}

static void draw_panels(void *context, int descriptor) {
    iso_contact_sheet *s = context;
    for (int i; (i = __atomic_fetch_add(s->next, 1, __ATOMIC_RELAXED)) < s->count;) {
        iso_sheet_panel *p = &s->panels[i];
        iso_error error = {0};
        if (p->done) continue;
        p->begun = true;
        const iso_status status = make_picture(s, i, &error);
        if (status != ISO_OK && !error.text[0]) iso_fail(&error, status, "%s", iso_status_text(status));
        p->error = error;
        p->error.status = status;
        __atomic_store_n(&p->done, true, __ATOMIC_RELEASE);
        if (write(descriptor, "", 1) != 1) return; /* nobody waits for it any more */
    }
}

static int compare_keys(const void *a, const void *b) {
    const uint64_t x = *(const uint64_t *)a, y = *(const uint64_t *)b;
    return (x > y) - (x < y);
}

/* Removes pictures from the folder that no panel has. */
static void prune(const iso_contact_sheet *s) {
    uint64_t *keys = calloc((size_t)s->count, sizeof *keys), key;
    DIR *folder = keys ? opendir(s->folder) : NULL;
    for (int i = 0; keys && i < s->count; i++) keys[i] = s->panels[i].key;
    if (keys) qsort(keys, (size_t)s->count, sizeof *keys, compare_keys);
    for (struct dirent *entry; folder && (entry = readdir(folder));) {
        key = strtoull(entry->d_name, NULL, 16);
        char *path = picture_path(s, key);
        if (path && strcmp(path + strlen(s->folder) + 1, entry->d_name) == 0 &&
            !bsearch(&key, keys, (size_t)s->count, sizeof *keys, compare_keys))
            unlink(path);
        free(path);
    }
    if (folder) closedir(folder);
    free(keys);
}

static iso_status make_folder(iso_contact_sheet *s, iso_error *error) {
    const char *slash = strrchr(s->output, '/'), *dot = strrchr(slash ? slash : s->output, '.');
    if (asprintf(&s->folder, "%.*s-panels", (int)(dot - s->output), s->output) < 0) s->folder = NULL;
    if (!s->folder) return iso_fail(error, ISO_ERR_NOMEM, "out of memory");
    if (mkdir(s->folder, 0777) == 0 || errno == EEXIST) return ISO_OK;
    return iso_fail(error, ISO_ERR_WRITE, "%s: cannot make this folder: %s", s->folder, strerror(errno));
}

/* ---- names */

/* Panels are called by their inputs, without the folders that all have in common. */
static iso_status make_names(iso_contact_sheet *s, iso_error *error) {
    size_t common = 0;
    for (const char *at = s->inputs[0]; (at = strchr(at, '/')) && at[1]; at++) {
        const size_t length = (size_t)(at - s->inputs[0]) + 1;
        bool all = true;
        for (int i = 1; i < s->count && all; i++)
            all = strncmp(s->inputs[i], s->inputs[0], length) == 0 && s->inputs[i][length];
        if (!all) break;
        common = length;
    }
    s->names = calloc((size_t)s->count, sizeof *s->names);
    for (int i = 0; s->names && i < s->count; i++)
        if (!(s->names[i] = iso_text_clean_copy(s->inputs[i] + common))) break;
    return s->names && s->names[s->count - 1] ? ISO_OK : iso_fail(error, ISO_ERR_NOMEM, "out of memory");
}

/* ---- what is said */

static void put_json(const iso_contact_sheet *s, int number, iso_json *json) {
    const iso_sheet_panel *p = &s->panels[number];
    const bool good = p->error.status == ISO_OK;
    char *path = good ? picture_path(s, p->key) : NULL;
    iso_json_begin_object(json, NULL);
    iso_json_string(json, "input", s->inputs[number]);
    if (s->beside) iso_json_string(json, "beside", s->beside[number]);
    iso_json_integer(json, "status", (uint64_t)iso_status_exit(p->error.status));
    iso_json_string(json, "error", good ? NULL : p->error.text);
    iso_json_string(json, "picture", path);
    iso_json_bool(json, "kept", good && p->kept);
    for (int i = 0; i < s->value_count; i++)
        iso_json_real(json, s->values[i].name, good ? p->values[i] : NAN);
    iso_json_end_object(json);
    free(path);
}

/* Says what is new of the panels that are done, up to the first that is not. */
static void say(void *context) {
    iso_contact_sheet *s = context;
    iso_error error = {0};
    for (; s->said < s->count && __atomic_load_n(&s->panels[s->said].done, __ATOMIC_ACQUIRE); s->said++) {
        const iso_sheet_panel *p = &s->panels[s->said];
        if (p->error.status != ISO_OK) iso_program_log(s->program, "%s", p->error.text);
        iso_json json = {.one_line = true};
        if (!s->json) continue;
        put_json(s, s->said, &json);
        iso_json_write(&json, s->lines.stream, &error);
        fflush(s->lines.stream);
    }
}

static int failed(const iso_contact_sheet *s) {
    int count = 0;
    for (int i = 0; i < s->count; i++) count += s->panels[i].error.status != ISO_OK;
    return count;
}

static const char *name_of_value(const iso_contact_sheet *s, int number, int value, char text[64]) {
    const double v = s->panels[number].values[value];
    const char *unit = s->values[value].unit;
    if (isnan(v)) return "\u2013";
    snprintf(text, 64, "%.6g%s%s", v, *unit ? " " : "", unit);
    return text;
}

/* ---- the page */

static const char STYLE[] =
    ":root{--ink:#1d2330;--soft:#5d6675;--line:#dfe3ea;--page:#f6f7f9;--card:#fff;--bad:#b3261e}\n"
    "@media(prefers-color-scheme:dark){:root{--ink:#e6e9ef;--soft:#9aa4b5;--line:#2c3340;--page:#14171d;"
    "--card:#1b2028}}\n"
    "body{margin:24px;background:var(--page);color:var(--ink);font:15px/1.5 system-ui,sans-serif}\n"
    "h1{font-size:24px;margin:0 0 4px;overflow-wrap:anywhere}.soft{color:var(--soft)}a{color:var(--bad)}\n"
    "main{display:flex;flex-wrap:wrap;gap:14px;margin-top:16px}\n"
    "figure{margin:0;background:var(--card);border:1px solid var(--line);border-radius:8px;overflow:hidden}\n"
    "figure img{display:block}figcaption{display:flex;gap:10px;justify-content:space-between;padding:5px "
    "9px;font-size:13px}\n"
    "figcaption span{overflow-wrap:anywhere}figcaption b{white-space:nowrap;font-weight:600}\n"
    ".bad p{margin:0;padding:12px;box-sizing:border-box;overflow:auto;overflow-wrap:anywhere;background:"
    "var(--bad);color:#fff;font-size:13px}\n"
    "table{border-collapse:collapse;font-size:13.5px;font-variant-numeric:tabular-nums;margin-top:16px}\n"
    "td,th{padding:4px 10px;text-align:right;border-top:1px solid var(--line)}td:first-child{text-align:"
    "left}\n";

static iso_status put_picture(const iso_contact_sheet *s, int number, FILE *stream, iso_error *error) {
    char *path = picture_path(s, s->panels[number].key);
    FILE *file = NULL;
    uint64_t size = 0;
    iso_status status =
        path ? iso_file_open(path, &file, &size, error) : iso_fail(error, ISO_ERR_NOMEM, "out of memory");
    uint8_t *bytes = status == ISO_OK ? malloc((size_t)size + 1) : NULL;
    if (status == ISO_OK && !bytes) status = iso_fail_memory(error, path);
    if (status == ISO_OK && fread(bytes, 1, (size_t)size, file) != size)
        status = iso_fail(error, ISO_ERR_IO, "%s: cannot be read", path);
    if (status == ISO_OK) {
        fputs("<img loading=lazy alt=\"", stream);
        iso_html_text(stream, s->names[number]);
        fprintf(stream, "\" width=%d height=%d src=\"data:image/png;base64,", s->grid.panel[0],
                s->grid.panel[1]);
        iso_html_base64(stream, bytes, (size_t)size);
        fputs("\">", stream);
    }
    if (file) fclose(file);
    free(bytes);
    free(path);
    return status;
}

static iso_status put_panel(const iso_contact_sheet *s, int number, FILE *stream, iso_error *error) {
    const iso_sheet_panel *p = &s->panels[number];
    const bool good = p->error.status == ISO_OK;
    char text[64];
    fprintf(stream, "<figure id=p%d%s style=\"width:%dpx\">", number + 1, good ? "" : " class=bad",
            s->grid.panel[0]);
    if (good) {
        ISO_TRY(put_picture(s, number, stream, error));
    } else {
        fprintf(stream, "<p style=\"height:%dpx\">", s->grid.panel[1]);
        iso_html_text(stream, p->error.text);
        fputs("</p>", stream);
    }
    fputs("<figcaption><span>", stream);
    iso_html_text(stream, s->names[number]);
    fputs("</span>", stream);
    if (good && s->shown >= 0) fprintf(stream, "<b>%s</b>", name_of_value(s, number, s->shown, text));
    fputs("</figcaption></figure>\n", stream);
    return ISO_OK;
}

static void put_table(const iso_contact_sheet *s, FILE *stream) {
    char text[64];
    fputs("<table><tr><th>", stream);
    for (int k = 0; k < s->value_count; k++)
        fprintf(stream, "<th>%s%s%s", s->values[k].name, *s->values[k].unit ? ", " : "", s->values[k].unit);
    for (int i = 0; i < s->count; i++) {
        fprintf(stream, "<tr><td><a href=#p%d>", i + 1);
        iso_html_text(stream, s->names[i]);
        fputs("</a>", stream);
        for (int k = 0; k < s->value_count; k++) {
            const bool known = s->panels[i].error.status == ISO_OK && !isnan(s->panels[i].values[k]);
            snprintf(text, sizeof text, "%.6g", s->panels[i].values[k]);
            fprintf(stream, "<td>%s", known ? text : "\u2013");
        }
    }
    fputs("</table>\n", stream);
}

static iso_status put_page(const iso_contact_sheet *s, FILE *stream, iso_error *error) {
    const char *slash = strrchr(s->output, '/');
    const int bad = failed(s);
    iso_status status = ISO_OK;
    fputs("<!doctype html><html lang=en><meta charset=utf-8><meta name=viewport "
          "content=\"width=device-width\"><title>",
          stream);
    iso_html_text(stream, slash ? slash + 1 : s->output);
    fprintf(stream, "</title>\n<style>%s</style>\n<h1>", STYLE);
    iso_html_text(stream, slash ? slash + 1 : s->output);
    fprintf(stream, "</h1>\n<div class=soft>%d panel%s, %d failed.", s->count, s->count == 1 ? "" : "s", bad);
    if (s->shown >= 0) fprintf(stream, " The number of a panel: %s.", s->values[s->shown].name);
    if (s->note) fprintf(stream, " %s", s->note);
    fputs("</div>\n", stream);
    if (bad) fputs("<ul>", stream);
    for (int i = 0; i < s->count && bad; i++) {
        if (s->panels[i].error.status == ISO_OK) continue;
        fprintf(stream, "<li><a href=#p%d>", i + 1);
        iso_html_text(stream, s->names[i]);
        fputs("</a>\n", stream);
    }
    if (bad) fputs("</ul>\n", stream);
    if (s->table) put_table(s, stream);
    fputs("<main>\n", stream);
    for (int i = 0; i < s->count && status == ISO_OK; i++) status = put_panel(s, i, stream, error);
    fputs("</main>\n", stream);
    return status;
}

static iso_status write_page(const iso_contact_sheet *s, iso_error *error) {
    iso_sink sink;
    ISO_TRY(iso_sink_open(s->output, &sink, error));
    const iso_status status = put_page(s, sink.stream, error);
    if (status == ISO_OK) return iso_sink_commit(&sink, error);
    iso_sink_abort(&sink);
    return status;
}

/* ---- the picture */

/* A red panel, with as much of the message as it has room for. */
static void add_message(const iso_contact_sheet *s, int number, iso_drawing *over) {
    const iso_picture_grid *g = &s->grid;
    int corner[2];
    iso_picture_grid_corner(g, number, corner);
    const double x = corner[0], y = corner[1], right = x + g->panel[0], bottom = y + g->panel[1];
    const double corners[4][2] = {{x, y}, {right, y}, {right, bottom}, {x, bottom}};
    iso_drawing_polygon(over, (iso_rgb){0xB3, 0x26, 0x1E}, corners, 4);
    const char *text = s->panels[number].error.text;
    for (double line = y + 2.5 * g->text; *text && line < bottom - 0.5 * g->text; line += 1.8 * g->text) {
        char cut[256];
        size_t taken = iso_picture_grid_cut(g, text, g->panel[0] - 2 * g->text, cut, sizeof cut);
        size_t blank = taken;
        while (text[taken] && blank > 1 && text[blank - 1] != ' ') blank--;
        if (text[taken] && blank > 1) taken = blank;
        if (taken == 0) break; /* not even a letter has room */
        snprintf(cut, sizeof cut, "%.*s", (int)taken, text);
        iso_drawing_text(over, cut, x + g->text, line, g->font, (iso_rgb){255, 255, 255});
        text += taken;
    }
}

static iso_status fill_picture(const iso_contact_sheet *s, iso_image *sheet, iso_drawing *over,
                               iso_error *error) {
    iso_picture_grid_fill(&s->grid, sheet);
    for (int i = 0; i < s->count; i++) {
        const bool good = s->panels[i].error.status == ISO_OK;
        char text[64], *path = good ? picture_path(s, s->panels[i].key) : NULL;
        iso_image image = {0};
        if (good && !path) return iso_fail(error, ISO_ERR_NOMEM, "out of memory");
        iso_status status = good ? iso_png_read(path, &image, error) : ISO_OK;
        if (status == ISO_OK && good && (image.width != s->grid.panel[0] || image.height != s->grid.panel[1]))
            status = iso_fail(error, ISO_ERR_FORMAT, "%s: not a picture of this sheet: remove it", path);
        if (good && status == ISO_OK) iso_picture_grid_place(&s->grid, i, &image, sheet);
        if (!good) add_message(s, i, over);
        iso_image_free(&image);
        free(path);
        ISO_TRY(status);
        const bool says = good && s->shown >= 0;
        iso_picture_grid_title(&s->grid, i, 0, s->names[i], says ? name_of_value(s, i, s->shown, text) : NULL,
                               over);
    }
    return iso_drawing_check(over, error);
}

static iso_status write_picture(iso_contact_sheet *s, iso_error *error) {
    iso_image sheet = {0};
    iso_drawing over = {.marks = NULL};
    ISO_TRY(iso_image_create(s->grid.width, s->grid.height, &sheet, error));
    const iso_png_opts opts = {.small = true};
    iso_status status = fill_picture(s, &sheet, &over, error);
    if (status == ISO_OK) status = iso_image_file_write_drawing(s->output, &sheet, &over, &opts, error);
    iso_drawing_free(&over);
    iso_image_free(&sheet);
    return status;
}

/* ---- the run */

/* Draws until every panel is done. A process that ends at a panel is that panel's failure. */
static iso_status draw_all(iso_contact_sheet *s, iso_error *error) {
    for (int left = s->count, before; left;) {
        *s->next = s->said;
        ISO_TRY(iso_sheet_fork(s->jobs < s->count ? s->jobs : s->count, draw_panels, say, s, error));
        before = left;
        left = 0;
        for (int i = 0; i < s->count; i++) {
            iso_sheet_panel *p = &s->panels[i];
            if (!p->done && p->begun) {
                p->done = true;
                p->error.status = iso_fail(&p->error, ISO_ERR_BRIDGE,
                                           "%s: the process that drew it has ended early", s->inputs[i]);
            }
            left += !p->done;
        }
        say(s);
        if (left == before) return iso_fail(error, ISO_ERR_NOMEM, "the processes that draw end at once");
    }
    for (int i = 0; i < s->count; i++)
        if (s->panels[i].error.status == ISO_ERR_WRITE)
            return iso_fail(error, ISO_ERR_WRITE, "%s", s->panels[i].error.text);
    return ISO_OK;
}

static iso_status make_sheet(iso_contact_sheet *s, iso_error *error) {
    const bool page = iso_file_type_of_name(s->output, ISO_WRITES_PAGE) != ISO_FILE_UNKNOWN;
    if (!page && iso_image_kind_of(s->output) == ISO_IMAGE_UNKNOWN)
        return iso_fail(error, ISO_ERR_USAGE,
                        "%s: a contact sheet is a .html, .png, .jpg, .tif, .svg or .pdf", s->output);
    if (!page) ISO_TRY(iso_image_file_check(s->output, error));
    ISO_TRY(iso_sink_check(s->output, error));
    s->grid.count = s->count;
    s->grid.below = true;
    if (!page) ISO_TRY(iso_picture_grid_lay_out(&s->grid, s->output, s->max_memory, error));
    if (s->json) ISO_TRY(iso_sink_open(s->json_path ? s->json_path : "-", &s->lines, error));
    ISO_TRY(make_folder(s, error));
    ISO_TRY(make_names(s, error));
    s->next = iso_sheet_share(sizeof *s->next);
    s->panels = iso_sheet_share((size_t)s->count * sizeof *s->panels);
    if (!s->next || !s->panels)
        return iso_fail(error, ISO_ERR_NOMEM, "out of memory for %d panels", s->count);
    ISO_TRY(draw_all(s, error));
    prune(s);
    ISO_TRY(page ? write_page(s, error) : write_picture(s, error));
    return s->json ? iso_sink_commit(&s->lines, error) : ISO_OK;
}

iso_status iso_sheet_make(iso_contact_sheet *s, int *code, iso_error *error) {
    const iso_status status = make_sheet(s, error);
    int kept = 0;
    for (int i = s->count - 1; status == ISO_OK && i >= 0; i--) {
        const iso_sheet_panel *p = &s->panels[i];
        if (p->error.status != ISO_OK) *code = iso_status_exit(p->error.status);
        kept += p->error.status == ISO_OK && p->kept;
    }
    if (status == ISO_OK && !s->quiet)
        iso_program_log(s->program, "wrote %s: %d panels, %d drawn, %d kept, %d failed", s->output, s->count,
                        s->count - kept - failed(s), kept, failed(s));
    iso_sink_abort(&s->lines);
    iso_sheet_unshare(s->panels, (size_t)s->count * sizeof *s->panels);
    iso_sheet_unshare(s->next, sizeof *s->next);
    for (int i = 0; s->names && i < s->count; i++) free(s->names[i]);
    free(s->names);
    free(s->folder);
    return status;
}
