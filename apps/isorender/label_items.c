/* label_items: parses --label and finds the labels that it means. */
#include "apps/isorender/label_items.h"

#include <fnmatch.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/parse.h"

enum { WORD = 256 };

typedef struct label_item {
    char which[WORD];
    double opacity; /* NaN: not given */
    bool colored;
    iso_rgb color;
} label_item;

static iso_status take_style(const char *word, label_item *item, iso_error *error) {
    uint8_t rgb[3];
    double opacity;
    /* (a number with six digits is a colour) */
    if (strlen(word) < 6 && iso_parse_fraction(word, &opacity) && opacity >= 0 && opacity <= 1) {
        item->opacity = opacity;
        return ISO_OK;
    }
    if (!iso_parse_color(word, rgb))
        return iso_fail(error, ISO_ERR_USAGE,
                        "--label %s: '%s' is neither an opacity from 0 to 1 nor a colour", item->which, word);
    item->color = (iso_rgb){rgb[0], rgb[1], rgb[2]};
    item->colored = true;
    return ISO_OK;
}

/* Parses the item that a text begins with; *next: behind it and its comma, or NULL. */
static iso_status parse_item(const char *text, label_item *item, const char **next, iso_error *error) {
    char copy[WORD], *rest = copy;
    const size_t length = strcspn(text, ",");
    *item = (label_item){.opacity = NAN};
    *next = text[length] ? text + length + 1 : NULL;
    if (!length || length >= sizeof copy)
        return iso_fail(error, ISO_ERR_USAGE, "--label: '%s' is no label", text);
    snprintf(copy, sizeof copy, "%.*s", (int)length, text);
    char *word = strsep(&rest, ":");
    snprintf(item->which, sizeof item->which, "%s", word);
    while ((word = strsep(&rest, ":"))) ISO_TRY(take_style(word, item, error));
    return ISO_OK;
}

iso_status isorender_label_items_check(const iso_texts *texts, iso_error *error) {
    for (int i = 0; i < texts->count; i++)
        for (const char *text = texts->values[i]; text;) {
            label_item item;
            ISO_TRY(parse_item(text, &item, &text, error));
        }
    return ISO_OK;
}

bool isorender_label_items_translucent(const iso_texts *texts) {
    iso_error unused;
    for (int i = 0; i < texts->count; i++)
        for (const char *text = texts->values[i]; text;) {
            label_item item;
            if (parse_item(text, &item, &text, &unused) != ISO_OK) return false;
            if (item.opacity > 0 && item.opacity < 1) return true;
        }
    return false;
}

/* Parses N or N-M. */
static bool parse_range(const char *text, int *first, int *last) {
    char low[WORD];
    const char *dash = strchr(text, '-');
    if (iso_parse_int(text, first)) {
        *last = *first;
        return *first >= 0;
    }
    if (!dash || dash == text) return false;
    snprintf(low, sizeof low, "%.*s", (int)(dash - text), text);
    return iso_parse_int(low, first) && iso_parse_int(dash + 1, last) && *first >= 0 && *last >= *first;
}

/* The labels that there are, for a message. */
static void list_labels(const iso_labels *labels, const iso_drawn_label *items, char *text, size_t room) {
    size_t used = 0;
    text[0] = 0;
    for (int i = 1; i < labels->count && used + 96 < room; i++)
        used += (size_t)snprintf(text + used, room - used, "%s%d%s%s", i > 1 ? ", " : "",
                                 labels->label[i].value, strncmp(items[i].name, "label ", 6) ? " " : "",
                                 strncmp(items[i].name, "label ", 6) ? items[i].name : "");
    if (used + 96 >= room) snprintf(text + used, room - used, ", ..");
}

static bool is_meant(const label_item *item, int value, const char *name) {
    int first, last;
    if (strcmp(item->which, "all") == 0) return true;
    if (parse_range(item->which, &first, &last)) return value >= first && value <= last;
    return fnmatch(item->which, name, FNM_CASEFOLD) == 0;
}

static iso_status apply_item(const label_item *item, const iso_labels *labels, iso_drawn_label *items,
                             bool *drawn, iso_error *error) {
    int found = 0;
    for (int i = 1; i < labels->count; i++) {
        if (!is_meant(item, labels->label[i].value, items[i].name)) continue;
        found++;
        drawn[i] = true;
        if (!isnan(item->opacity)) items[i].opacity = item->opacity;
        if (item->colored) items[i].color = item->color;
    }
    char known[400];
    list_labels(labels, items, known, sizeof known);
    if (found) return ISO_OK;
    return iso_fail(error, ISO_ERR_USAGE, "--label: there is no label %s: there are %s", item->which, known);
}

iso_status isorender_label_items_apply(const iso_texts *texts, const iso_labels *labels,
                                       iso_drawn_label *items, iso_error *error) {
    if (!texts->count) return ISO_OK;
    bool *drawn = calloc((size_t)labels->count, sizeof *drawn);
    if (!drawn) return iso_fail(error, ISO_ERR_NOMEM, "out of memory");
    iso_status status = ISO_OK;
    for (int i = 0; i < texts->count && status == ISO_OK; i++)
        for (const char *text = texts->values[i]; text && status == ISO_OK;) {
            label_item item;
            status = parse_item(text, &item, &text, error);
            if (status == ISO_OK) status = apply_item(&item, labels, items, drawn, error);
        }
    for (int i = 1; i < labels->count; i++)
        if (!drawn[i]) items[i].opacity = 0;
    free(drawn);
    return status;
}
