/* cuts: the words of cuts. */
#include "scene/cuts.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/parse.h"

/* A position or length that is larger is a mistake, mm. */
static const double MOST = 1e9;

static bool are_possible(const double *numbers, int count) {
    for (int i = 0; i < count; i++)
        if (!(fabs(numbers[i]) <= MOST)) return false;
    return true;
}

static bool parse_numbers(const char *text, int count, double *numbers) {
    return iso_parse_reals(text, count, numbers) && are_possible(numbers, count);
}

/* The axis that a text names; 0: none. */
static char axis_named(const char *text) {
    static const char *const names[] = {"sagittal", "coronal", "axial"};
    for (int axis = 0; axis < 3; axis++)
        if (strcmp(text, names[axis]) == 0 || (text[0] == 'x' + axis && !text[1])) return (char)('x' + axis);
    return 0;
}

/* x<MM or x>MM */
static bool parse_axis(const char *text, iso_clip_body *body) {
    double at;
    if (text[0] < 'x' || text[0] > 'z' || (text[1] != '<' && text[1] != '>')) return false;
    if (!parse_numbers(text + 2, 1, &at)) return false;
    const double side = text[1] == '<' ? -1 : 1;
    const iso_vec3 axis = {text[0] == 'x', text[0] == 'y', text[0] == 'z'};
    *body = iso_clip_half_space(iso_vec3_scale(axis, at), iso_vec3_scale(axis, side));
    return true;
}

/* X,Y,Z:NX,NY,NZ; *failed: the normal is 0. */
static bool parse_plane(const char *text, iso_clip_body *body, bool *failed) {
    char point[256];
    double p[3], n[3];
    const char *colon = strchr(text, ':');
    if (!colon || colon - text >= (ptrdiff_t)sizeof point) return false;
    snprintf(point, sizeof point, "%.*s", (int)(colon - text), text);
    if (!parse_numbers(point, 3, p) || !iso_parse_reals(colon + 1, 3, n)) return false;
    const double largest = fmax(fabs(n[0]), fmax(fabs(n[1]), fabs(n[2])));
    *failed = !(largest > 0);
    if (*failed) return true;
    *body = iso_clip_half_space(iso_vec3_make(p[0], p[1], p[2]),
                                iso_vec3_make(n[0] / largest, n[1] / largest, n[2] / largest));
    return true;
}

static const char *behind(const char *text, const char *word) {
    const size_t length = strlen(word);
    return strncmp(text, word, length) == 0 ? text + length : NULL;
}

static iso_status fail_form(const char *text, iso_error *error) {
    return iso_fail(error, ISO_ERR_USAGE, "'%s' is not " ISO_CUT_FORMS, text);
}

static iso_status parse_box(const char *text, iso_cut *cut, iso_error *error) {
    double n[6];
    if (!parse_numbers(text, 6, n)) return fail_form(text, error);
    for (int axis = 0; axis < 3; axis++)
        if (!(n[axis] < n[axis + 3]))
            return iso_fail(error, ISO_ERR_USAGE,
                            "the box %s is empty: its least %c, %g, is not below its greatest, %g", text,
                            'x' + axis, n[axis], n[axis + 3]);
    const iso_box box = {{n[0], n[1], n[2]}, {n[3], n[4], n[5]}};
    cut->body = iso_clip_box(&box);
    return ISO_OK;
}

static iso_status parse_ball(const char *text, iso_cut *cut, iso_error *error) {
    double n[4];
    if (!parse_numbers(text, 4, n)) return fail_form(text, error);
    if (!(n[3] > 0))
        return iso_fail(error, ISO_ERR_USAGE, "the radius of the sphere %s is not above 0", text);
    cut->body = iso_clip_ball(iso_vec3_make(n[0], n[1], n[2]), n[3]);
    return ISO_OK;
}

/* A form without keep:, ras: and @. */
static iso_status parse_plain(const char *text, iso_cut *cut, iso_error *error) {
    bool no_normal = false;
    const char *box = behind(text, "box:"), *ball = behind(text, "sphere:"),
               *camera = behind(text, "camera:");
    if (box) return parse_box(box, cut, error);
    if (ball) return parse_ball(ball, cut, error);
    if (camera) {
        cut->by_depth = true;
        return parse_numbers(camera, 1, &cut->depth) ? ISO_OK : fail_form(text, error);
    }
    const char middle[4] = {axis_named(text), '<', '0', 0};
    cut->plane = true;
    cut->by_middle = *middle != 0;
    if (cut->by_middle) text = middle;
    if (!parse_axis(text, &cut->body) && !parse_plane(text, &cut->body, &no_normal))
        return fail_form(text, error);
    return no_normal ? iso_fail(error, ISO_ERR_USAGE, "the normal of '%s' is 0: it has no direction", text)
                     : ISO_OK;
}

static void turn_to_lps(iso_clip_body *body) {
    for (int face = 0; face < body->faces; face++)
        for (int axis = 0; axis < 2; axis++) body->face[face][axis] *= -1;
    body->centre = iso_vec3_make(-body->centre.x, -body->centre.y, body->centre.z);
}

/* A form without keep: and @. */
static iso_status parse_form(const char *text, iso_cut *cut, iso_error *error) {
    const char *ras = behind(text, "ras:"), *lps = behind(text, "lps:");
    ISO_TRY(parse_plain(ras ? ras : lps ? lps : text, cut, error));
    if (ras) turn_to_lps(&cut->body);
    cut->space_stated = ras || lps;
    return ISO_OK;
}

iso_status iso_things_parse(const char *text, iso_things *things, iso_error *error) {
    *things = (iso_things){.named = true};
    for (const char *at = text;; at++) {
        char *end;
        const bool digit = *at >= '0' && *at <= '9';
        const long number = digit ? strtol(at, &end, 10) : 0;
        if (number < 1 || number > ISO_CUT_THINGS || (*end && *end != ','))
            return iso_fail(error, ISO_ERR_USAGE,
                            "'@%s' is not @N or @N,N..: numbers of surfaces and objects from 1 to %d", text,
                            ISO_CUT_THINGS);
        things->bits[(number - 1) / 64] |= (uint64_t)1 << (number - 1) % 64;
        at = end;
        if (!*at) return ISO_OK;
    }
}

iso_status iso_cut_parse(const char *text, iso_cut *cut, iso_error *error) {
    char form[512];
    *cut = (iso_cut){.by_depth = false};
    const char *rest = behind(text, "keep:"), *at = strchr(text, '@');
    const char *first = rest ? rest : text;
    const size_t length = at ? (size_t)(at - first) : strlen(first);
    if (length >= sizeof form) return fail_form("..", error);
    snprintf(form, sizeof form, "%.*s", (int)length, first);
    ISO_TRY(parse_form(form, cut, error));
    cut->body.keeps = rest != NULL;
    return at ? iso_things_parse(at + 1, &cut->things, error) : ISO_OK;
}

/* Whether a form is "x=MM", which becomes "x<MM", or none with a side. */
static bool take_equals(char *form) {
    if (behind(form, "ras:") || behind(form, "lps:")) form += 4;
    if (!form[0] || form[1] == '<' || form[1] == '>') return false;
    if (form[1] == '=') form[1] = '<';
    return true;
}

iso_status iso_cut_parse_plane(const char *text, iso_cut *plane, iso_error *error) {
    char form[256];
    iso_error reason;
    *plane = (iso_cut){.by_depth = false};
    snprintf(form, sizeof form, "%s", text);
    if (take_equals(form) && parse_form(form, plane, &reason) == ISO_OK && (plane->plane || plane->by_depth))
        return ISO_OK;
    return iso_fail(
        error, ISO_ERR_USAGE,
        "'%s' is not a plane: x=MM, x (in the middle; also sagittal, coronal, axial), X,Y,Z:NX,NY,NZ or "
        "camera:MM",
        text);
}

iso_vec3 iso_cut_middle(const iso_transform *transform, const int dims[3]) {
    const iso_affine affine = iso_transform_affine(transform);
    return iso_affine_point(&affine,
                            iso_vec3_make((dims[0] - 1) / 2.0, (dims[1] - 1) / 2.0, (dims[2] - 1) / 2.0));
}

void iso_cut_set_middle(iso_cut *cut, iso_vec3 middle) {
    double *face = cut->body.face[0];
    if (cut->by_middle) face[3] = face[0] * middle.x + face[1] * middle.y + face[2] * middle.z;
    cut->by_middle = false;
}

iso_clip_body iso_cut_solve(const iso_cut *cut, const iso_camera *camera, double front) {
    if (!cut->by_depth) return cut->body;
    const iso_vec3 forward = iso_vec3_unit(iso_vec3_sub(camera->focal_point, camera->position));
    iso_clip_body body =
        iso_clip_half_space(iso_vec3_scale(forward, front + cut->depth), iso_vec3_scale(forward, -1));
    body.keeps = cut->body.keeps;
    return body;
}

bool iso_things_have(const iso_things *things, int number) {
    return !things->named || (number < ISO_CUT_THINGS && things->bits[number / 64] >> number % 64 & 1);
}

bool iso_cut_is_for(const iso_cut *cut, int number) {
    return iso_things_have(&cut->things, number);
}

iso_clip iso_cuts_clip(const iso_cut *cuts, int count, int thing, const iso_camera *camera, double front) {
    iso_clip clip = {.count = 0};
    for (int i = 0; i < count; i++)
        if (iso_cut_is_for(&cuts[i], thing)) clip.body[clip.count++] = iso_cut_solve(&cuts[i], camera, front);
    return clip;
}
