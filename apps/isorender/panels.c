#include "apps/isorender/panels.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "apps/common/template.h"
#include "apps/isorender/annotations.h"
#include "apps/isorender/scene_file.h"
#include "base/memory.h"
#include "scene/input_spool.h"
#include "scene/picture_grid.h"

enum { PANELS = 26, TITLE = 160 }; /* letters a to z */
enum { PANEL_OPTIONS = 8 };        /* that differ */

bool isorender_has_panels(const isorender_settings *settings) {
    return settings->panels.count || settings->panel_files.count;
}

/* ---- what differs */

/* A list, separated by commas or, if there is one, by semicolons. */
typedef struct list {
    char items[PANELS][TITLE];
    int count;
} list;

static iso_status split(const char *text, const char *option, list *l, iso_error *error) {
    const char separator = strchr(text, ';') ? ';' : ',';
    for (l->count = 0;; text++) {
        const char *end = strchr(text, separator);
        const size_t length = end ? (size_t)(end - text) : strlen(text);
        if (l->count == PANELS)
            return iso_fail(error, ISO_ERR_USAGE, "option %s: more than %d panels", option, PANELS);
        if (length == 0 || length >= TITLE)
            return iso_fail(error, ISO_ERR_USAGE, "option %s: %s value between two '%c'", option,
                            length ? "too long a" : "no", separator);
        snprintf(l->items[l->count++], TITLE, "%.*s", (int)length, text);
        if (!end) return ISO_OK;
        text = end;
    }
}

/* The value of --panels is no option with values. unknown: its name is that of none. */
static iso_status fail_form(const char *text, size_t length, bool unknown, iso_error *error) {
    char name[32], hint[64] = "";
    snprintf(name, sizeof name, "%.*s", (int)length, text);
    const char *nearest = unknown ? iso_options_nearest(isorender_program(), name, 3) : NULL;
    if (nearest) snprintf(hint, sizeof hint, ": did you mean %s=?", nearest);
    return iso_fail(
        error, ISO_ERR_USAGE,
        "option --panels: '%.60s' is not WHAT=A,B,.., with WHAT isovalue, camera, label, time or any other "
        "option%s",
        text, hint);
}

/* The option that one --panels changes, and the list of its values. */
static iso_status find_option(const isorender_settings *settings, const char *text, const iso_option **option,
                              const char **values, iso_error *error) {
    const char *equals = strchr(text, '=');
    const size_t length = equals ? (size_t)(equals - text) : strlen(text);
    const bool is_time = length == 4 && strncmp(text, "time", 4) == 0;
    *option = is_time ? iso_options_find(isorender_program(), "component", strlen("component"))
                      : iso_options_find(isorender_program(), text, length);
    *values = equals ? equals + 1 : "";
    if (length == 4 && strncmp(text, "file", 4) == 0)
        return iso_fail(
            error, ISO_ERR_USAGE,
            "option --panels: pictures of several files: the first is the input, --panel-file names "
            "each of the others");
    if (*option && equals && !**values && strcmp((*option)->name, "isovalue") == 0)
        return iso_fail(error, ISO_ERR_USAGE,
                        "option --panels: '%.60s' has no values: --info suggests some, as 'isovalue=300,700'",
                        text);
    if (!*option || !equals || !**values) return fail_form(text, length, !*option, error);
    if ((*option)->flags & ISO_OPTION_UNRECORDED || !(*option)->value ||
        strncmp((*option)->name, "panel", 5) == 0 || strcmp((*option)->name, "resolution") == 0)
        return iso_fail(error, ISO_ERR_USAGE, "option --panels: --%s does not make pictures that differ",
                        (*option)->name);
    if (strcmp((*option)->name, "ior") == 0 && !(settings->ior > 0))
        return iso_fail(error, ISO_ERR_USAGE, "option --panels: panels of glass need --ior beside it");
    return ISO_OK;
}

const char *isorender_panels_unfit(const isorender_settings *settings) {
    return settings->mesh            ? "--mesh"
           : settings->points        ? "--points"
           : settings->table         ? "--table"
           : settings->aov           ? "--aov"
           : settings->turntable     ? "--turntable"
           : settings->keyframe_file ? "--keyframes"
           : settings->series_of     ? "--series-of"
           : settings->parts         ? "--part"
           : settings->info          ? "--info"
           : settings->no_image      ? "--no-image"
                                     : NULL;
}

/* The cpu engine draws all panels, unless another one is named: it can draw whatever differs. */
iso_status isorender_panels_check(isorender_settings *settings, iso_error *error) {
    const bool given = isorender_has_panels(settings);
    const char *needs = settings->panel_titles    ? "--panel-titles"
                        : settings->panel_columns ? "--panel-columns"
                                                  : NULL;
    if (!given && needs) return iso_fail(error, ISO_ERR_USAGE, "%s is for --panels", needs);
    const char *unfit = !given                      ? NULL
                        : settings->input_count > 1 ? "several inputs (--panel-file names further ones)"
                        : settings->common.json     ? "--json"
                                                    : isorender_panels_unfit(settings);
    if (unfit) return iso_fail(error, ISO_ERR_USAGE, "--panels cannot be combined with %s", unfit);
    if (settings->panels.count && settings->panel_files.count)
        return iso_fail(error, ISO_ERR_USAGE,
                        "panels are of one file or of several: give --panels or --panel-file");
    if (settings->panels.count && settings->input_count && iso_spool_is_stream(settings->inputs[0]))
        return iso_fail(error, ISO_ERR_USAGE, "--panels reads %s for each panel: it must be a file",
                        iso_spool_name(settings->inputs[0]));
    if (given && strcmp(settings->backend, "auto") == 0) settings->backend = "cpu";
    const iso_option *option;
    const char *values;
    if (settings->panels.count > PANEL_OPTIONS)
        return iso_fail(error, ISO_ERR_USAGE, "more than %d options --panels", PANEL_OPTIONS);
    for (int i = 0; i < settings->panels.count; i++)
        ISO_TRY(find_option(settings, settings->panels.values[i], &option, &values, error));
    return ISO_OK;
}

/* ---- the commands of panels */

/* A panel's command line, and what it is made into. */
typedef struct cell {
    char **argv, *made[PANEL_OPTIONS]; /* made: the arguments of its own, or NULL */
    int argc;
    iso_operands operands;
    isorender_settings settings;
    isorender_plan *plans; /* one */
    isorender_panel panel;
    isorender_film film; /* of its one picture */
    char title[TITLE];
} cell;

typedef struct sheet {
    const isorender_settings *settings;
    const isorender_plan *plan;
    cell *cells[PANELS];
    int count;
    isorender_same_view shared; /* the isovalue */
    isorender_legend_list *names;
    iso_loader_shelf shelf;
    iso_picture_grid grid;
    char (*ranges)[80];
} sheet;

/* Puts "panel b (isovalue 300): " before a message that is not about the file alone. */
static iso_status named(const cell *c, int number, iso_status status, iso_error *error) {
    char text[sizeof error->text];
    if (status == ISO_OK || !error) return status;
    snprintf(text, sizeof text, "%s", error->text);
    return iso_fail(error, status, "panel %c (%.60s): %s", 'a' + number, c->title, text);
}

/* Makes the command of a panel: that of the sheet without the options of sheets and without those of its own,
 * which are in `own`; the input is `file`, if it is not NULL. */
static iso_status parse_cell(const sheet *p, cell *c, const char *const *own, int own_count, const char *file,
                             iso_error *error) {
    static const char *const left_out[] = {"panels", "panel-file", "panel-titles", "panel-columns",
                                           "save-scene"};
    enum { LEFT_OUT = sizeof left_out / sizeof *left_out, MORE = 1 + PANEL_OPTIONS + ISORENDER_BARS };
    const char *names[LEFT_OUT + PANEL_OPTIONS];
    const isorender_settings *settings = p->settings;
    memcpy(names, left_out, sizeof left_out);
    for (int i = 0; i < own_count; i++) names[LEFT_OUT + i] = own[i];
    c->argv = calloc((size_t)settings->argc + MORE, sizeof *c->argv);
    c->operands.values = calloc((size_t)settings->argc + MORE, sizeof *c->operands.values);
    if (!c->argv || !c->operands.values) return iso_fail(error, ISO_ERR_NOMEM, "out of memory");
    c->argc = iso_options_without(isorender_program(), settings->argc, settings->argv, names,
                                  LEFT_OUT + own_count, c->argv);
    bool replaced = !file;
    for (int i = 1; i < c->argc; i++)
        if (file && c->argv[i] == p->settings->inputs[0])
            c->argv[i] = (char *)(uintptr_t)file, replaced = true;
    if (!replaced) return iso_fail(error, ISO_ERR_USAGE, "--panel-file is beside an input, which is a file");
    return ISO_OK;
}

static iso_status finish_cell(const sheet *p, cell *c, iso_error *error) {
    isorender_plans_free(c->plans, 1);
    c->plans = NULL;
    ISO_TRY(isorender_settings_parse(c->argc, c->argv, &c->settings, &c->operands, error));
    c->settings.scene_output = p->settings->scene_output;
    c->settings.panel = &c->panel;
    c->film = isorender_film_of(&c->settings);
    c->settings.film = &c->film;
    c->settings.ranks = p->settings->ranks;
    return isorender_plans_make(&c->settings, &c->plans, error);
}

/* Inserts an argument behind the program's name. */
static void insert(cell *c, char *argument) {
    memmove(c->argv + 2, c->argv + 1, (size_t)(c->argc - 1) * sizeof *c->argv);
    c->argv[1] = argument;
    c->argc++;
}

static iso_status add_cell(sheet *p, const char *title, cell **made, iso_error *error) {
    cell *c = calloc(1, sizeof *c);
    if (!c) return iso_fail(error, ISO_ERR_NOMEM, "out of memory");
    p->cells[p->count++] = c;
    snprintf(c->title, sizeof c->title, "%s", title);
    *made = c;
    return ISO_OK;
}

/* What a panel is called: "isovalue 300", but labels and cameras by their names alone. */
static void make_title(const char *what, const char *value, char title[TITLE]) {
    const bool alone = strcmp(what, "label") == 0 || strcmp(what, "camera") == 0;
    snprintf(title, TITLE, "%.40s%s%.110s", alone ? "" : what, alone ? "" : " ", value);
    for (char *c = title; !alone && *c && *c != ' '; c++)
        if (*c == '-') *c = ' ';
}

/* Adds a panel for each value of the first --panels; further ones have as many, which go with them. */
static iso_status add_values(sheet *p, iso_error *error) {
    const iso_texts *panels = &p->settings->panels;
    const char *own[PANEL_OPTIONS], *values;
    for (int k = 0; k < panels->count; k++) {
        const iso_option *option;
        ISO_TRY(find_option(p->settings, panels->values[k], &option, &values, error));
        own[k] = option->name;
    }
    for (int k = 0; k < panels->count; k++) {
        const iso_option *option;
        list l;
        char what[TITLE], title[TITLE];
        ISO_TRY(find_option(p->settings, panels->values[k], &option, &values, error));
        ISO_TRY(split(values, "--panels", &l, error));
        snprintf(what, sizeof what, "%.*s", (int)(values - panels->values[k] - 1), panels->values[k]);
        if (k && l.count != p->count)
            return iso_fail(error, ISO_ERR_USAGE, "option --panels: %d values of %s for %d panels", l.count,
                            what, p->count);
        for (int i = 0; i < l.count; i++) {
            cell *c = k ? p->cells[i] : NULL;
            make_title(what, l.items[i], title);
            if (!k) ISO_TRY(add_cell(p, title, &c, error));
            if (!k) ISO_TRY(parse_cell(p, c, own, panels->count, NULL, error));
            if (asprintf(&c->made[k], "--%s=%s", option->name, l.items[i]) < 0) c->made[k] = NULL;
            if (!c->made[k]) return iso_fail(error, ISO_ERR_NOMEM, "out of memory");
            insert(c, c->made[k]);
        }
    }
    for (int i = 0; i < p->count; i++)
        ISO_TRY(named(p->cells[i], i, finish_cell(p, p->cells[i], error), error));
    return ISO_OK;
}

static iso_status add_files(sheet *p, iso_error *error) {
    const iso_texts *files = &p->settings->panel_files;
    for (int i = 0; i <= files->count; i++) {
        const char *file = i ? files->values[i - 1] : p->plan->input;
        char *model = NULL;
        cell *c = NULL;
        /* only the input may be one that is read to its end once, or waited for */
        if (i && iso_spool_is_stream(file))
            return iso_fail(error, ISO_ERR_IO, "%s: not a regular file", iso_spool_name(file));
        ISO_TRY(iso_template_model(file, &model, error));
        const iso_status status = add_cell(p, model, &c, error);
        free(model);
        ISO_TRY(status);
        ISO_TRY(parse_cell(p, c, NULL, 0, i ? file : NULL, error));
        ISO_TRY(named(c, i, finish_cell(p, c, error), error));
    }
    return ISO_OK;
}

static iso_status take_titles(sheet *p, iso_error *error) {
    list l;
    if (p->settings->panel_titles) {
        ISO_TRY(split(p->settings->panel_titles, "--panel-titles", &l, error));
        if (l.count != p->count)
            return iso_fail(error, ISO_ERR_USAGE, "--panel-titles: %d titles for %d panels", l.count,
                            p->count);
        for (int i = 0; i < p->count; i++) {
            ISO_TRY(iso_drawing_check_text(l.items[i], error));
            snprintf(p->cells[i]->title, TITLE, "%s", l.items[i]);
        }
    }
    return ISO_OK;
}

/* ---- what panels have in common */

static void add_box(iso_box *box, const iso_box *other) {
    box->lo = iso_vec3_make(fmin(box->lo.x, other->lo.x), fmin(box->lo.y, other->lo.y),
                            fmin(box->lo.z, other->lo.z));
    box->hi = iso_vec3_make(fmax(box->hi.x, other->hi.x), fmax(box->hi.y, other->hi.y),
                            fmax(box->hi.z, other->hi.z));
}

static double distance_of(const iso_camera *c) {
    return iso_vec3_length(iso_vec3_sub(c->position, c->focal_point));
}

/* Whether a box is all of another one, but for a little: the bounds of one surface differ by how it is
 * drawn. */
static bool is_all_of(const iso_box *box, const iso_box *all) {
    static const double LITTLE = 0.02;
    const double more =
        iso_vec3_length(iso_vec3_sub(box->lo, all->lo)) + iso_vec3_length(iso_vec3_sub(box->hi, all->hi));
    return more <= LITTLE * iso_vec3_length(iso_vec3_sub(all->hi, all->lo));
}

/* Whether two cameras look the same way, in one projection. */
static bool looks_alike(const iso_camera *a, const iso_camera *b) {
    const iso_vec3 x = iso_vec3_scale(iso_vec3_sub(a->position, a->focal_point), 1 / distance_of(a)),
                   y = iso_vec3_scale(iso_vec3_sub(b->position, b->focal_point), 1 / distance_of(b));
    return iso_vec3_length(iso_vec3_sub(x, y)) < 1e-9 &&
           iso_vec3_length(iso_vec3_sub(a->view_up, b->view_up)) < 1e-9 && a->view_angle == b->view_angle &&
           a->orthographic == b->orthographic;
}

/* Moves cameras that look at the same things from several sides away, until all have the scale of the
 * farthest. */
static void share_scale(sheet *p) {
    double scale = 0, distance = 0;
    for (int i = 0; i < p->count; i++) {
        scale = fmax(scale, p->cells[i]->panel.camera.parallel_scale);
        distance = fmax(distance, distance_of(&p->cells[i]->panel.camera));
    }
    for (int i = 0; i < p->count; i++) {
        iso_camera *c = &p->cells[i]->panel.camera;
        const iso_vec3 back = iso_vec3_sub(c->position, c->focal_point);
        if (c->orthographic)
            c->parallel_scale = scale;
        else
            c->position = iso_vec3_add(c->focal_point, iso_vec3_scale(back, distance / distance_of(c)));
    }
}

/* Gives all panels one framing. If they look the same way, it is that of the panel that holds all others,
 * if there is one; if they show the same from several sides, each has its own camera and all one scale.
 * Else all frame the box around everything. Where the camera is or how it zooms stays as it is given. */
static void share_camera(sheet *p) {
    const iso_camera *first = &p->cells[0]->panel.camera;
    bool zooms = false;
    iso_box all = p->cells[0]->panel.box;
    bool alike = true, same = true;
    int largest = -1;
    for (int i = 0; i < p->settings->panels.count; i++)
        zooms |= strncmp(p->settings->panels.values[i], "zoom=", 5) == 0;
    for (int i = 0; i < p->count; i++) add_box(&all, &p->cells[i]->panel.box);
    for (int i = p->count - 1; i >= 0; i--) {
        const bool whole = is_all_of(&p->cells[i]->panel.box, &all);
        if (whole) largest = i;
        same &= whole;
        alike &= looks_alike(&p->cells[i]->panel.camera, first);
    }
    const bool given = !isnan(p->cells[0]->settings.position[0]) || zooms,
               one = alike && largest >= 0 && !given;
    for (int i = 0; i < p->count; i++) {
        isorender_panel *panel = &p->cells[i]->panel;
        panel->has_camera = one || same || given;
        panel->box = all;
        if (one) panel->camera = p->cells[largest]->panel.camera;
    }
    if (same && !alike && !given) share_scale(p);
}

/* Gives all panels the ranges of colours that hold those of each, unless --range is given. */
static iso_status share_ranges(sheet *p, iso_error *error) {
    const isorender_panel *first = &p->cells[0]->panel;
    const isorender_settings *settings = &p->cells[0]->settings;
    const int colored = settings->object_options.color_by.count + settings->coloring_count;
    bool shares =
        first->range_count > 0 && first->range_count == colored && !settings->object_options.ranges.count;
    for (int i = 0; i < p->count; i++) shares &= p->cells[i]->panel.range_count == first->range_count;
    if (!shares) return ISO_OK;
    p->ranges = calloc(ISORENDER_BARS, sizeof *p->ranges);
    if (!p->ranges) return iso_fail(error, ISO_ERR_NOMEM, "out of memory");
    for (int k = 0; k < first->range_count; k++) {
        double low = INFINITY, high = -INFINITY;
        for (int i = 0; i < p->count; i++) {
            low = fmin(low, p->cells[i]->panel.ranges[k][0]);
            high = fmax(high, p->cells[i]->panel.ranges[k][1]);
        }
        if (!(low < high)) return ISO_OK;
        snprintf(p->ranges[k], sizeof *p->ranges, "--range=%.17g,%.17g", low, high);
    }
    for (int i = 0; i < p->count; i++) {
        for (int k = first->range_count - 1; k >= 0; k--) insert(p->cells[i], p->ranges[k]);
        ISO_TRY(named(p->cells[i], i, finish_cell(p, p->cells[i], error), error));
    }
    return ISO_OK;
}

typedef struct means {
    iso_pool *pool;
    const isorender_backend *backend;
    const iso_environment *environment;
} means;

/* Surveys or draws all panels. Notes are said once, by the survey, and of each file. */
static iso_status run_cells(sheet *p, const means *m, bool survey, iso_error *error) {
    for (int i = 0; i < p->count; i++) {
        cell *c = p->cells[i];
        const bool says = survey && (i == 0 || p->settings->panel_files.count);
        c->panel.names = p->names;
        c->panel.shelf = &p->shelf;
        c->panel.is_survey = survey;
        c->panel.is_last = i == p->count - 1;
        c->settings.first = &p->shared;
        c->settings.common.quiet |= !says;
        const iso_status status =
            isorender_run(&c->settings, &c->plans[0], m->pool, m->backend, m->environment, error);
        ISO_TRY(named(c, i, status, error));
    }
    return ISO_OK;
}

/* ---- the sheet */

static iso_status lay_out(sheet *p, iso_error *error) {
    const isorender_settings *s = p->settings;
    p->grid = (iso_picture_grid){.count = p->count,
                                 .columns = s->panel_columns,
                                 .panel = {s->width, s->height},
                                 .font = isorender_font_pixels(s),
                                 .background = s->background,
                                 .transparent = s->transparent != 0};
    return iso_picture_grid_lay_out(&p->grid, "--panels", iso_memory_limit(s->common.input.max_memory),
                                    error);
}

static void place_cell(const sheet *p, cell *c, int number, iso_image *image, iso_drawing *over) {
    int corner[2];
    iso_picture_grid_corner(&p->grid, number, corner);
    iso_picture_grid_place(&p->grid, number, &c->panel.image, image);
    iso_drawing_append(over, &c->panel.drawing, corner[0], corner[1]);
    iso_picture_grid_title(&p->grid, number, (char)('a' + number), c->title, NULL, over);
}

/* Moves what stands beside the panels to where they end, and *right behind it. */
static void place_beside(const sheet *p, iso_drawing *beside, int *right, iso_drawing *over) {
    double box[4];
    iso_drawing_box(beside, box);
    if (!(box[0] <= box[2])) return;
    iso_drawing_append(over, beside, *right - floor(box[0]), p->grid.band);
    *right += (int)ceil(box[2] - box[0] + 1.5 * p->grid.margin);
}

/* The sheet's scene and the texts of its file are those of the whole command. */
static iso_status write_sheet(sheet *p, iso_pool *pool, iso_image *image, const iso_drawing *over,
                              iso_error *error) {
    isorender_job *job = calloc(1, sizeof *job);
    if (!job) return iso_fail(error, ISO_ERR_NOMEM, "out of memory");
    job->settings = p->settings;
    job->plan = p->plan;
    job->pool = pool;
    job->camera = p->cells[0]->panel.camera;
    iso_status status = isorender_write_picture(job, image, over, p->plan->image, error);
    if (status == ISO_OK) {
        status = isorender_scene_save(job, error);
        if (status != ISO_OK) iso_file_remove(p->plan->image);
    }
    free(job);
    return status;
}

static iso_status make_sheet(sheet *p, const means *m, iso_error *error) {
    iso_image image = {0};
    iso_drawing over = {.marks = NULL};
    ISO_TRY(isorender_plan_check_writable(p->plan, error));
    if (p->settings->panels.count)
        ISO_TRY(add_values(p, error));
    else
        ISO_TRY(add_files(p, error));
    ISO_TRY(take_titles(p, error));
    ISO_TRY(lay_out(p, error));
    ISO_TRY(run_cells(p, m, true, error));
    share_camera(p);
    ISO_TRY(share_ranges(p, error));
    ISO_TRY(run_cells(p, m, false, error));
    isorender_panel *last = &p->cells[p->count - 1]->panel;
    int width = p->grid.width;
    place_beside(p, &last->legend, &width, &over);
    place_beside(p, &last->bars, &width, &over);
    iso_status status = iso_image_create(width, p->grid.height, &image, error);
    if (status == ISO_OK) {
        iso_picture_grid_fill(&p->grid, &image);
        for (int i = 0; i < p->count; i++) place_cell(p, p->cells[i], i, &image, &over);
        status = write_sheet(p, m->pool, &image, &over, error);
    }
    iso_drawing_free(&over);
    iso_image_free(&image);
    return status;
}

static void free_cell(cell *c) {
    isorender_plans_free(c->plans, 1);
    iso_image_free(&c->panel.image);
    iso_drawing_free(&c->panel.drawing);
    iso_drawing_free(&c->panel.legend);
    iso_drawing_free(&c->panel.bars);
    free(c->panel.ranges);
    free(c->operands.values);
    free(c->argv);
    for (int i = 0; i < PANEL_OPTIONS; i++) free(c->made[i]);
    free(c);
}

iso_status isorender_panels_run(const isorender_settings *settings, const isorender_plan *plan,
                                iso_pool *pool, const isorender_backend *backend,
                                const iso_environment *environment, iso_error *error) {
    const means m = {pool, backend, environment};
    sheet p = {.settings = settings, .plan = plan, .names = calloc(1, sizeof *p.names)};
    const iso_status status =
        p.names ? make_sheet(&p, &m, error) : iso_fail(error, ISO_ERR_NOMEM, "out of memory for the legend");
    if (status == ISO_OK && strcmp(plan->image, "-") != 0 && !settings->common.quiet)
        iso_program_log(isorender_program(), "%s: wrote %s: %d panels", plan->input, plan->image, p.count);
    for (int i = 0; i < p.count; i++) free_cell(p.cells[i]);
    iso_loader_shelf_free(&p.shelf);
    free(p.ranges);
    free(p.names);
    return status;
}
