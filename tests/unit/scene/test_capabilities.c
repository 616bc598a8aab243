/* What a method's row denies is refused, what it has is drawn, and a refusal names the methods that draw it:
 * for every option that needs a capability and every method with each of its reconstructions, by isorender
 * and by the C interface. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include "check_support.h"
#include "lent_ball.h"
#include "scene/method.h"

/* ---- the rows, as isorender calls them */

typedef struct way {
    iso_method family;
    const char *reconstruction; /* NULL: the family has only one */
} way;

enum { MOST_WAYS = 32 };

static const iso_method *families;
static int family_count;

static int list_ways(way ways[MOST_WAYS]) {
    int count = 0;
    for (int i = 0; i < family_count; i++) {
        const iso_method family = families[i];
        char list[ISO_METHODS_TEXT];
        static char names[MOST_WAYS][32];
        const char *text = iso_method_reconstructions(family, list);
        if (!*text) ways[count++] = (way){family, NULL};
        while (*text) {
            const size_t length = strcspn(text, ", ");
            snprintf(names[count], sizeof names[count], "%.*s", (int)length, text);
            text += length;
            text += strspn(text, ", ");
            if (strcmp(names[count], "or") == 0) continue;
            assert_true(count < MOST_WAYS);
            ways[count] = (way){family, names[count]};
            count++;
        }
    }
    return count;
}

static const iso_renderer *renderer_of(const way *chosen) {
    return iso_renderer_find(chosen->family, chosen->reconstruction);
}

/* ---- what a refusal says */

/* The families that a refusal names as those that can do it: words behind the last of the phrases that
 * introduce them. */
static unsigned read_named(const char *message) {
    static const char *const phrases[] = {
        "that needs ", "is for --method ", "by --method ", "it needs --method ", "only ", "needs a volume; "};
    const char *tail = message;
    unsigned named = 0;
    for (size_t i = 0; i < sizeof phrases / sizeof *phrases; i++) {
        const char *found = strstr(message, phrases[i]);
        if (found && found + strlen(phrases[i]) > tail) tail = found + strlen(phrases[i]);
    }
    for (int i = 0; i < family_count; i++) {
        const char *name = iso_method_name(families[i]);
        const size_t length = strlen(name);
        for (const char *at = tail; tail > message && (at = strstr(at, name)); at += length)
            if (at[-1] == ' ' && !strchr("abcdefghijklmnopqrstuvwxyz-", at[length] ? at[length] : '.'))
                named |= 1u << families[i];
    }
    return named;
}

static int wrong;

static void note(const char *what, const way *chosen, const char *options, const char *message) {
    wrong++;
    print_error("%s: --method %s%s%s %s: %s\n", what, iso_method_name(chosen->family),
                chosen->reconstruction ? " --reconstruction " : "",
                chosen->reconstruction ? chosen->reconstruction : "", options, message);
}

/* ---- isorender */

typedef struct option_case {
    unsigned needs;
    const char *input, *options;
} option_case;

#define VOLUME "scene:ct:24"

static const option_case cases[] = {
    {ISO_CAN_LAYERS, VOLUME, "--opacity 0.5"},
    {ISO_CAN_OBJECT_LAYERS, VOLUME, "--glyphs cloud.xyz --glyph-radius 4 --glyph-opacity 0.5"},
    {ISO_CAN_ABSORPTION, VOLUME, "--opacity 0.5 --absorption 3"},
    {ISO_CAN_GLASS, VOLUME, "--ior 1.5"},
    {ISO_CAN_TRACED, VOLUME, "--ior 1.5 --refraction traced"},
    {ISO_CAN_LEVELS, VOLUME, "--lod 1"},
    {ISO_CAN_SELECTION, VOLUME, "--selection all"},
    {ISO_CAN_INSTANCES, VOLUME, "--instances one.csv"},
    {ISO_CAN_PYRAMID, VOLUME, "--one-pyramid"},
    {ISO_CAN_PYRAMID, VOLUME, "--lines line.obj --line-shading illuminated"},
    {ISO_CAN_CHUNKS, VOLUME, "--chunk-size 16"},
    {ISO_CAN_GL, VOLUME, "--backend osmesa"},
    {ISO_CAN_CLIP, VOLUME, "--clip 'x<0'"},
    {ISO_CAN_CLIP_LAYERS, VOLUME, "--clip 'x<0' --opacity 0.5"},
    {ISO_CAN_OCCLUSION, VOLUME, "--occlusion=4"},
    {ISO_CAN_LIT_LAYERS, VOLUME, "--glyphs cloud.xyz --occlusion=4 --opacity 0.5"},
    {ISO_CAN_COLORS, VOLUME, "--surface-color-by curvature"},
    {ISO_CAN_COLOR_LAYERS, VOLUME, "--surface-color-by curvature --opacity 0.5"},
    {ISO_CAN_SMOOTH, VOLUME, "--reconstruction-filter cubic"},
    {ISO_CAN_GROUPS, VOLUME, "--opacity 0.5 --transparency groups"},
    {ISO_CAN_GROUPS, VOLUME, "--groups 8"},
    {ISO_CAN_GL_LAYERS, VOLUME, "--opacity 0.5 --backend osmesa"},
    {ISO_CAN_STRIPS, VOLUME, "--strips --backend osmesa"},
    {ISO_CAN_ATTENUATED, VOLUME, "--point-scaling attenuated --backend osmesa"},
    {ISO_CAN_PAGE, VOLUME, "-o page.html"},
    {ISO_CAN_CLOUDS, "cloud.xyz", ""},
    {ISO_CAN_CLOUDS | ISO_CAN_INSTANCES, "cloud.xyz", "--instances one.csv"},
};

/* Runs isorender; returns its exit status, and what it says first. */
static int run(const option_case *c, const way *chosen, char said[512]) {
    char command[1024];
    snprintf(command, sizeof command,
             "'" ISORENDER "' %s %s --method %s %s %s %s --resolution 24x24 --threads 1 "
             "--quiet >/dev/null 2>said",
             c->input, strstr(c->options, "-o ") ? "" : "out.png", iso_method_name(chosen->family),
             chosen->reconstruction ? "--reconstruction" : "",
             chosen->reconstruction ? chosen->reconstruction : "", c->options);
    const int status = system(command);
    assert_true(WIFEXITED(status));
    FILE *file = fopen("said", "r");
    assert_non_null(file);
    const size_t length = fread(said, 1, 511, file);
    said[length] = 0;
    said[strcspn(said, "\n")] = 0;
    fclose(file);
    return WEXITSTATUS(status);
}

static void write_file(const char *name, const char *text) {
    FILE *file = fopen(name, "w");
    assert_non_null(file);
    assert_true(fputs(text, file) >= 0 && fclose(file) == 0);
}

static void test_isorender(void **state) {
    (void)state;
    way ways[MOST_WAYS];
    const int count = list_ways(ways);
    assert_true(count >= family_count);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char said[MOST_WAYS][512];
        unsigned drawn = 0, refused = 0;
        for (int k = 0; k < count; k++) {
            const int status = run(&cases[i], &ways[k], said[k]);
            const bool can = (renderer_of(&ways[k])->can & cases[i].needs) == cases[i].needs;
            if ((status == 2) == can || (status != 0 && status != 2 && !strstr(cases[i].options, "osmesa")))
                note(can ? "refused" : "drawn", &ways[k], cases[i].options, said[k]);
            if (status == 2)
                refused |= 1u << k;
            else
                drawn |= 1u << ways[k].family;
        }
        for (int k = 0; k < count; k++)
            if (refused & 1u << k && read_named(said[k]) != drawn)
                note("names others than draw it", &ways[k], cases[i].options, said[k]);
    }
    assert_int_equal(wrong, 0);
}

/* ---- the C interface */

typedef struct scene {
    iso_surface *surface;
    iso_render_opts opts;
} scene;

static const char *const clips[] = {"x<0"};
static const iso_glass_opts glass = {.ior = 1.5, .refraction = ISO_REFRACTION_LAYERS};
static const iso_placement here = {.scale = 1, .rotation = {0, 0, 0, 1}};
static const iso_placements once = {.items = (iso_placement *)&here, .count = 1};
static const iso_color_by by_curvature = {.source = ISO_COLOR_BY_CURVATURE};

static void see_through(scene *s) {
    assert_int_equal(iso_surface_set_look(s->surface, NULL, 0.5, NULL), ISO_OK);
}
static void absorb(scene *s) {
    see_through(s);
    s->opts.absorption_length = 3;
}
static void refract(scene *s) {
    s->opts.glass = &glass;
}
static void use_levels(scene *s) {
    s->opts.lod = 1;
}
static void place(scene *s) {
    s->opts.instances = &once;
}
static void cut(scene *s) {
    s->opts.clips = clips;
    s->opts.clip_count = 1;
}
static void cut_layers(scene *s) {
    see_through(s);
    cut(s);
}
static void occlude(scene *s) {
    s->opts.occlusion = 4;
}
static void occlude_layers(scene *s) {
    see_through(s);
    occlude(s);
}
static void color(scene *s) {
    s->opts.color_by = &by_curvature;
    s->opts.color_by_count = 1;
}
static void color_layers(scene *s) {
    see_through(s);
    color(s);
}
static void filter(scene *s) {
    s->opts.filter = ISO_FILTER_CUBIC;
}
static void divide(scene *s) {
    see_through(s);
    s->opts.transparency = ISO_TRANSPARENCY_GROUPS;
}

static const struct {
    unsigned needs;
    const char *name;
    void (*ask)(scene *s);
} asked[] = {{ISO_CAN_LAYERS, "opacity", see_through},
             {ISO_CAN_ABSORPTION, "absorption", absorb},
             {ISO_CAN_GLASS, "glass", refract},
             {ISO_CAN_LEVELS, "lod", use_levels},
             {ISO_CAN_INSTANCES, "instances", place},
             {ISO_CAN_CLIP, "clips", cut},
             {ISO_CAN_CLIP_LAYERS, "clips, opacity", cut_layers},
             {ISO_CAN_OCCLUSION, "occlusion", occlude},
             {ISO_CAN_LIT_LAYERS, "occlusion, opacity", occlude_layers},
             {ISO_CAN_COLORS, "color_by", color},
             {ISO_CAN_COLOR_LAYERS, "color_by, opacity", color_layers},
             {ISO_CAN_SMOOTH, "filter", filter},
             {ISO_CAN_GROUPS, "transparency", divide}};

static iso_status draw(iso_volume *volume, iso_method method, void (*ask)(scene *s), iso_error *error) {
    scene s = {.opts = {.method = method, .width = 24, .height = 24, .samples = 1, .threads = 1}};
    iso_image image = {0};
    assert_int_equal(iso_surface_create(volume, NULL, &s.surface, NULL), ISO_OK);
    ask(&s);
    const iso_status status = iso_render(s.surface, &s.opts, &image, error);
    iso_image_free(&image);
    iso_surface_destroy(s.surface);
    return status;
}

static void test_interface(void **state) {
    (void)state;
    iso_volume *volume = lend_ball(1);
    iso_error error = {ISO_OK, ""};
    for (size_t i = 0; i < sizeof asked / sizeof *asked; i++) {
        char said[ISO_METHODS][sizeof error.text];
        unsigned drawn = 0, refused = 0;
        for (int m = 0; m < ISO_METHODS; m++) {
            const iso_renderer *renderer = iso_renderer_get((iso_method)m);
            const way called = {renderer->family, renderer->reconstruction};
            const bool can = (renderer->can & asked[i].needs) == asked[i].needs;
            error = (iso_error){ISO_OK, ""};
            const iso_status status = draw(volume, renderer->method, asked[i].ask, &error);
            snprintf(said[m], sizeof said[m], "%s", error.text);
            if (status != (can ? ISO_OK : ISO_ERR_USAGE))
                note(can ? "refused" : "drawn", &called, asked[i].name, error.text);
            if (status == ISO_OK)
                drawn |= 1u << renderer->family;
            else
                refused |= 1u << m;
        }
        for (int m = 0; m < ISO_METHODS; m++)
            if (refused & 1u << m && read_named(said[m]) != drawn) {
                const iso_renderer *renderer = iso_renderer_get((iso_method)m);
                note("names others than draw it", &(way){renderer->family, renderer->reconstruction},
                     asked[i].name, said[m]);
            }
    }
    iso_volume_destroy(volume);
    assert_int_equal(wrong, 0);
}

int main(void) {
    char folder[] = ISO_TEST_TMP "/capabilities-XXXXXX";
    if (!mkdtemp(folder) || chdir(folder) != 0) return 1;
    families = iso_method_families(&family_count);
    write_file("cloud.xyz", "0 0 0\n3 0 0\n0 3 0\n3 3 0\n1 2 0\n-2 1 0\n-3 -3 0\n");
    write_file("one.csv", "x,y,z\n0,0,0\n");
    write_file("line.obj", "v 0 0 0\nv 9 9 9\nv 0 9 0\nl 1 2 3\n");
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_isorender), cmocka_unit_test(test_interface)};
    const int failed = cmocka_run_group_tests(tests, NULL, NULL);
    return system("rm -r \"$PWD\"") != 0 || failed;
}
