/* annotations: parses what is written over a picture, and collects it for image/annotate.h. */
#include "apps/isorender/annotations.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "apps/common/template.h"
#include "apps/isorender/channels.h"
#include "apps/isorender/colorings.h"
#include "apps/isorender/cuts.h"
#include "apps/isorender/picture_record.h"
#include "apps/isorender/segmentation.h"

/* ---- options */

/* Parses X,Y (parts of the picture, or percent) or X,Y,Z (mm) at the beginning of a text, and returns what
 * follows; NULL: it is neither. */
static const char *take_place(const char *text, iso_place *place) {
    int count = 0;
    for (;; text++) {
        const char *end;
        if (count == 3 || !iso_parse_real_prefix(text, &place->at[count], &end)) return NULL;
        if (*end == '%') place->at[count] /= 100, end++;
        count++;
        text = end;
        if (*text != ',') break;
    }
    place->in_world = count == 3;
    return count >= 2 ? text : NULL;
}

static iso_status add_note(isorender_settings *settings, const iso_note *note, iso_error *error) {
    if (note->text) ISO_TRY(iso_drawing_check_text(note->text, error));
    if (settings->note_count == ISORENDER_NOTES)
        return iso_fail(error, ISO_ERR_USAGE, "more than %d texts, arrows and rulers", ISORENDER_NOTES);
    settings->notes[settings->note_count++] = *note;
    return ISO_OK;
}

iso_status isorender_apply_text(void *settings, const char *value, iso_error *error) {
    iso_note note = {.kind = ISO_NOTE_TEXT};
    const char *rest = take_place(value, &note.to);
    if (!rest || *rest != ':')
        return iso_fail(
            error, ISO_ERR_USAGE,
            "'%.60s' is not PLACE:TEXT, with the place X,Y (parts of the picture from its top left "
            "corner, as .5,.1) or X,Y,Z (mm)",
            value);
    note.text = rest + 1;
    return add_note(settings, &note, error);
}

iso_status isorender_apply_arrow(void *settings, const char *value, iso_error *error) {
    iso_note note = {.kind = ISO_NOTE_ARROW};
    const char *rest = take_place(value, &note.to);
    if (rest && *rest == '>') {
        note.from = note.to;
        note.has_from = true;
        rest = take_place(rest + 1, &note.to);
    }
    if (!rest || (*rest && *rest != ':') || (!*rest && !note.has_from))
        return iso_fail(
            error, ISO_ERR_USAGE,
            "'%.60s' is not PLACE:TEXT, FROM>PLACE or FROM>PLACE:TEXT, with places X,Y (parts of the "
            "picture from its top left corner) or X,Y,Z (mm)",
            value);
    if (*rest) note.text = rest + 1;
    return add_note(settings, &note, error);
}

iso_status isorender_apply_ruler(void *settings, const char *value, iso_error *error) {
    iso_note note = {.kind = ISO_NOTE_RULER, .from.in_world = true, .to.in_world = true};
    double ends[6];
    if (!iso_parse_reals(value, 6, ends))
        return iso_fail(error, ISO_ERR_USAGE, "'%.60s' is not two points X0,Y0,Z0,X1,Y1,Z1 in mm", value);
    memcpy(note.from.at, ends, sizeof note.from.at);
    memcpy(note.to.at, ends + 3, sizeof note.to.at);
    if (memcmp(ends, ends + 3, 3 * sizeof *ends) == 0)
        return iso_fail(error, ISO_ERR_USAGE, "'%.60s': both points are the same", value);
    return add_note(settings, &note, error);
}

iso_status isorender_apply_inset(void *target, const char *value, iso_error *error) {
    static const char *const corners[] = {"top-right", "top-left", "bottom-right", "bottom-left"};
    isorender_settings *settings = target;
    iso_place low, high;
    const char *rest = take_place(value, &low);
    rest = rest && *rest == ':' ? take_place(rest + 1, &high) : NULL;
    int corner = 0;
    if (rest && *rest == ':')
        for (; corner < 4 && strcmp(rest + 1, corners[corner]) != 0; corner++) continue;
    const bool whole = rest && (!*rest || *rest == ':') && corner < 4 && !low.in_world && !high.in_world;
    for (int axis = 0; whole && axis < 2; axis++) {
        settings->inset[axis] = low.at[axis];
        settings->inset[2 + axis] = high.at[axis];
        if (!(low.at[axis] >= 0 && high.at[axis] <= 1 && high.at[axis] - low.at[axis] >= 0.01))
            return iso_fail(error, ISO_ERR_USAGE, "'%.60s' is not a part of the picture, from 0,0 to 1,1",
                            value);
        if (high.at[axis] - low.at[axis] > 0.45)
            return iso_fail(
                error, ISO_ERR_USAGE,
                "'%.60s' is more than .45 of the picture's %s: it would not be larger in a corner", value,
                axis ? "height" : "width");
    }
    settings->inset_corner = corner;
    settings->has_inset = whole;
    if (whole) return ISO_OK;
    return iso_fail(error, ISO_ERR_USAGE,
                    "'%.60s' is not X0,Y0:X1,Y1 in parts of the picture, with :top-right, :top-left, "
                    ":bottom-right or :bottom-left behind it",
                    value);
}

iso_status isorender_apply_legend(void *target, const char *value, iso_error *error) {
    isorender_settings *settings = target;
    settings->legend = 1;
    settings->legend_names = value;
    return value ? iso_drawing_check_text(value, error) : ISO_OK;
}

iso_status isorender_apply_color_bar(void *target, const char *value, iso_error *error) {
    isorender_settings *settings = target;
    settings->color_bar = 1;
    settings->bar_titles = value;
    return value ? iso_drawing_check_text(value, error) : ISO_OK;
}

iso_status isorender_annotations_check(const isorender_settings *settings, iso_error *error) {
    const char *option = settings->has_inset    ? "--inset"
                         : settings->note_count ? "--text, --arrow and --ruler"
                         : settings->legend     ? "--legend"
                                                : NULL;
    if (option && settings->parts)
        return iso_fail(error, ISO_ERR_USAGE, "%s cannot be combined with --part", option);
    const int side = settings->width > settings->height ? settings->width : settings->height,
              factor = isorender_inset_factor(settings);
    if (factor && side > ISO_IMAGE_MAX / factor)
        return iso_fail(
            error, ISO_ERR_LIMIT,
            "--inset: %d times larger, the picture has more than %d pixels a side: a larger part, or a "
            "smaller --resolution",
            factor, ISO_IMAGE_MAX);
    return ISO_OK;
}

static iso_inset place_inset(const isorender_settings *settings) {
    iso_inset inset = {.corner = (iso_corner)settings->inset_corner};
    memcpy(inset.box, settings->inset, sizeof inset.box);
    iso_inset_place(&inset, settings->width, settings->height);
    return inset;
}

int isorender_inset_factor(const isorender_settings *settings) {
    return settings->has_inset ? place_inset(settings).factor : 0;
}

double isorender_font_pixels(const isorender_settings *settings) {
    return settings->font_size * (settings->dpi > 0 ? settings->dpi : 72) / 72;
}

/* ---- the legend */

typedef isorender_legend_list legend;
enum {
    LEGEND = sizeof((legend *)0)->entries / sizeof(iso_legend_entry),
    NAME = sizeof((legend *)0)->names[0]
};

static bool same_color(iso_rgb a, iso_rgb b) {
    return a.r == b.r && a.g == b.g && a.b == b.b;
}

/* What several panels show is there once. */
static void add_entry(legend *l, const char *name, iso_rgb color) {
    for (int i = 0; i < l->count; i++)
        if (strncmp(l->names[i], name, NAME - 1) == 0 && same_color(l->entries[i].color, color)) return;
    if (l->count == LEGEND) l->more++;
    if (l->count == LEGEND) return;
    snprintf(l->names[l->count], NAME, "%s", name);
    l->entries[l->count] = (iso_legend_entry){l->names[l->count], color};
    l->count++;
}

/* Adds a file's name without folder and extension. */
static void add_file(legend *l, const char *path, iso_rgb color) {
    char *model = NULL;
    if (iso_template_model(path, &model, NULL) == ISO_OK) add_entry(l, model, color);
    free(model);
}

static void add_surface(const isorender_job *job, const isorender_surface *surface, legend *l) {
    char value[32] = "", title[ISORENDER_CHANNEL_TITLE];
    const char *channel = isorender_channel_title(surface->loader, title);
    if (surface->label_group || surface->scene.coloring || !(surface->translucency.opacity > 0)) return;
    if (!isnan(surface->scene.isovalue))
        snprintf(value, sizeof value, "isovalue %.6g", surface->scene.isovalue);
    if (*channel)
        add_entry(l, channel, surface->color);
    else if (job->volume_count == 0 && *value)
        add_entry(l, value, surface->color);
    else
        add_file(l, surface->loader->input, surface->color);
}

/* Copies the names of a list, which stand between semicolons, or between commas if there are none, and of
 * which there must be `count`, to texts of `size` bytes that are `step` bytes apart. */
static iso_status take_names(const char *list, const char *option, const char *what, int count, char *names,
                             size_t step, size_t size, iso_error *error) {
    const char *separator = strchr(list, ';') ? ";" : ",";
    int found = 1;
    for (const char *c = list; *c; c++) found += *c == *separator;
    if (found != count)
        return iso_fail(error, ISO_ERR_USAGE, "%s: %d names for %d %s", option, found, count, what);
    for (int i = 0; i < count; i++) {
        const size_t length = strcspn(list, separator);
        snprintf(names + (size_t)i * step, size, "%.*s", (int)length, list);
        list += length + (list[length] != 0);
    }
    return ISO_OK;
}

/* Replaces the names by those of the list. */
static iso_status rename_entries(const char *list, legend *l, iso_error *error) {
    ISO_TRY(take_names(list, "--legend", "surfaces, labels and objects", l->count, l->names[0],
                       sizeof l->names[0], sizeof l->names[0], error));
    for (int i = 0; i < l->count; i++) l->entries[i].name = l->names[i];
    return ISO_OK;
}

/* Adds what has one colour: surfaces, then labels, then objects. */
static void add_to_legend(const isorender_job *job, legend *l) {
    iso_legend_entry labels[LEGEND];
    for (int i = 0; i < job->surface_count; i++) add_surface(job, &job->surfaces[i], l);
    int all;
    const int count = isorender_legend(job, LEGEND, labels, &all);
    if (all - count > l->more) l->more = all - count;
    for (int i = 0; i < count; i++) add_entry(l, labels[i].name, labels[i].color);
    for (int i = 0; i < job->object_count; i++) {
        const isorender_object *object = &job->objects[i];
        if (!object->has_bar && object->settings && object->settings->path)
            add_file(l, object->settings->path, object->scene.color);
    }
}

/* ---- all */

/* Says which notes are for places outside of the picture. */
static void tell_outside(const isorender_job *job, const iso_camera *camera) {
    static const char *const kinds[] = {"text", "arrow", "ruler"};
    const int width = job->settings->width, height = job->settings->height;
    for (int i = 0; i < job->settings->note_count; i++) {
        const iso_note *note = &job->settings->notes[i];
        double at[2];
        if (iso_place_project(&note->to, camera, width, height, at) && at[0] >= 0 && at[1] >= 0 &&
            at[0] <= width && at[1] <= height)
            continue;
        isorender_log(job, "note: --%s%s%.40s: its place is outside of the picture", kinds[note->kind],
                      note->text ? " " : "", note->text ? note->text : "");
    }
}

/* Says what covers more than a little of the picture wherever it stands. */
static void tell_covered(const isorender_job *job, const iso_annotation_places *places) {
    static const char *const names[] = {"orientation marker", "legend", "colour bar", "scale bar"};
    static const double LITTLE = 0.02;
    for (int i = 0; i < ISO_ANNOTATION_KINDS; i++)
        if (places->covered[i] > LITTLE)
            isorender_log(job,
                          "note: the %s covers a part of what is shown: a larger --margin makes room for it",
                          names[i]);
    if (places->legend_more)
        isorender_log(
            job,
            "note: the legend has no room for %d entries: --label chooses labels, a smaller --font-size "
            "or a larger --resolution makes room",
            places->legend_more);
}

/* Makes the picture of the inset: its part of an enlarged frame. */
static iso_status make_inset(isorender_job *job, int frame, isorender_enlarged *enlarge, iso_inset *inset,
                             iso_error *error) {
    iso_image large = {0};
    const int left = inset->part[0] * inset->factor, top = inset->part[1] * inset->factor,
              width = inset->place[2] - inset->place[0], height = inset->place[3] - inset->place[1];
    iso_status status = enlarge(job, frame, inset->factor, (int[2]){top, top + height}, &large, error);
    if (status == ISO_OK) status = iso_image_create(width, height, inset->picture, error);
    for (int y = 0; status == ISO_OK && y < height; y++)
        memcpy(inset->picture->rgba + 4 * (size_t)y * (size_t)width,
               large.rgba + 4 * ((size_t)(top + y) * (size_t)large.width + (size_t)left), 4 * (size_t)width);
    iso_image_free(&large);
    return status;
}

/* Legend and colour bars of panels stand beside them: moves them from a panel's annotations into drawings of
 * their own. */
static iso_status draw_beside(const isorender_settings *settings, iso_annotation *a, iso_error *error) {
    isorender_panel *panel = settings->panel;
    const int width = settings->width, height = settings->height;
    const iso_annotation plain = {.camera = a->camera, .font_size = a->font_size, .dark = a->dark};
    iso_annotation list = plain, bars = plain;
    list.legend = a->legend, list.legend_count = a->legend_count;
    list.legend_more = a->legend_more;
    bars.color_bars = a->color_bars, bars.color_bar_count = a->color_bar_count;
    a->legend_count = a->legend_more = a->color_bar_count = 0;
    ISO_TRY(iso_annotation_draw(&panel->legend, &list, width, height, error));
    return iso_annotation_draw(&panel->bars, &bars, width, height, error);
}

iso_status isorender_annotate(isorender_job *job, int frame, const iso_camera *camera, const iso_image *image,
                              isorender_enlarged *enlarge, iso_drawing *drawing, iso_error *error) {
    const isorender_settings *settings = job->settings;
    const bool last = !settings->panel || settings->panel->is_last;
    iso_color_bar bars[ISORENDER_BARS];
    iso_image enlarged = {0};
    iso_inset inset = place_inset(settings);
    inset.picture = &enlarged;
    int bar_count = 0;
    legend *own = settings->panel ? NULL : calloc(1, sizeof *own), *l = own ? own
                                                                        : settings->panel
                                                                            ? settings->panel->names
                                                                            : NULL;
    if (!l) return iso_fail(error, ISO_ERR_NOMEM, "out of memory for the legend");
    if (settings->legend) add_to_legend(job, l);
    iso_status status =
        settings->legend_names && last ? rename_entries(settings->legend_names, l, error) : ISO_OK;
    if (status == ISO_OK && last) status = isorender_titled_bars(job, bars, &bar_count, error);
    if (status == ISO_OK && settings->has_inset) status = make_inset(job, frame, enlarge, &inset, error);
    if (status == ISO_OK && frame == 0) tell_outside(job, camera);
    iso_annotation annotation = {.camera = camera,
                                 .font_size = isorender_font_pixels(settings),
                                 .lengths = isorender_lengths(job),
                                 .scale_bar = settings->scale_bar != 0,
                                 .orientation_marker = settings->orientation_marker != 0,
                                 .anatomical = job->has_volume && job->loader.volume.info.anatomical,
                                 .color_bars = bars,
                                 .color_bar_count = bar_count,
                                 .legend = l->entries,
                                 .legend_count = last ? l->count : 0,
                                 .legend_more = last ? l->more : 0,
                                 .notes = settings->notes,
                                 .note_count = settings->note_count,
                                 .inset = settings->has_inset ? &inset : NULL,
                                 .dark = iso_is_dark(settings->background, settings->transparent != 0),
                                 .under = settings->panel ? NULL : image, /* panels are alike */
                                 .background = settings->background,
                                 .places = settings->panel ? NULL : &settings->film->places};
    const bool chooses = annotation.under && !annotation.places->chosen;
    if (status == ISO_OK && settings->panel && last) status = draw_beside(settings, &annotation, error);
    if (status == ISO_OK)
        status = iso_annotation_draw(drawing, &annotation, settings->width, settings->height, error);
    if (status == ISO_OK && chooses) tell_covered(job, annotation.places);
    free(own);
    iso_image_free(&enlarged);
    return status;
}

iso_status isorender_titled_bars(const isorender_job *job, iso_color_bar bars[ISORENDER_BARS], int *count,
                                 iso_error *error) {
    const isorender_settings *settings = job->settings;
    *count = settings->color_bar ? isorender_color_bars(job, bars) : 0;
    if (!settings->bar_titles) return ISO_OK;
    return take_names(settings->bar_titles, "--color-bar", "bar(s)", *count, bars[0].title, sizeof bars[0],
                      sizeof bars[0].title, error);
}

int isorender_color_bars(const isorender_job *job, iso_color_bar bars[ISORENDER_BARS]) {
    int count = 0;
    if (job->cloud_colors.has_bar) bars[count++] = job->cloud_colors.bar;
    for (int i = 0; i < job->object_count; i++)
        if (job->objects[i].has_bar) bars[count++] = job->objects[i].bar;
    count += isorender_colorings_bars(job, bars + count);
    if (isorender_slice_bar(job, &bars[count])) count++;
    return count;
}
