/* The command line without the command: parsing, settings of isorender, output names, JSON, generated help.
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "apps/common/json.h"
#include "apps/common/template.h"
#include "apps/isorender/isorender.h"

enum { ARGUMENTS = 40 };

typedef struct parsed {
    char line[512]; /* argv points into it */
    isorender_settings settings;
    const char *operands[ARGUMENTS];
    iso_error error;
} parsed;

/* Parses a command line that is split at blanks. */
static iso_status parse(const char *text, parsed *result) {
    char *argv[ARGUMENTS] = {"isorender"};
    int argc = 1;
    snprintf(result->line, sizeof result->line, "%s", text);
    for (char *word = strtok(result->line, " "); word; word = strtok(NULL, " ")) argv[argc++] = word;
    iso_operands operands = {result->operands, 0};
    result->error = (iso_error){0};
    return isorender_settings_parse(argc, argv, &result->settings, &operands, &result->error);
}

static void parse_good(const char *text, parsed *result) {
    if (parse(text, result) != ISO_OK) fail_msg("%s: %s", text, result->error.text);
}

static void expect_failure(const char *text, iso_status status, const char *part) {
    parsed result;
    iso_status got = parse(text, &result);
    if (got != status) fail_msg("%s: status %d instead of %d (%s)", text, got, status, result.error.text);
    if (!strstr(result.error.text, part))
        fail_msg("%s: '%s' does not say '%s'", text, result.error.text, part);
}

/* ---- numbers ---- */

static void test_numbers(void **state) {
    (void)state;
    double real = -7;
    assert_true(iso_parse_real("-12.5e1", &real));
    assert_true(real == -125);
    static const char *const bad[] = {"",    " 1",    "1 ", "1,5", "0x10", "nan",
                                      "inf", "1e999", "1e", "--1", "one",  "."};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
        if (iso_parse_real(bad[i], &real)) fail_msg("'%s' was taken for %g", bad[i], real);
    assert_true(real == -125);
    int number = 3;
    assert_true(iso_parse_int("-2147483648", &number));
    assert_int_equal(number, INT32_MIN);
    assert_false(iso_parse_int("2147483648", &number));
    assert_false(iso_parse_int("1.0", &number));
    assert_false(iso_parse_int("1e3", &number));
    assert_false(iso_parse_int("+", &number));
    double three[3];
    assert_true(iso_parse_reals("1,-2.5,3e2", 3, three));
    assert_true(three[0] == 1 && three[1] == -2.5 && three[2] == 300);
    assert_true(iso_parse_reals(" 4, 5 ,6 ", 3, three) && three[0] == 4 && three[1] == 5 && three[2] == 6);
    assert_true(iso_parse_reals("7 8  -9", 3, three) && three[0] == 7 && three[1] == 8 && three[2] == -9);
    assert_false(iso_parse_reals("7 8-9", 3, three));
    assert_false(iso_parse_reals("1 2 , , 3", 3, three));
    assert_false(iso_parse_reals("1,2", 3, three));
    assert_false(iso_parse_reals("1,2,3,", 3, three));
    assert_false(iso_parse_reals("1,,3", 3, three));
}

static void test_sizes(void **state) {
    (void)state;
    static const struct {
        const char *text;
        uint64_t bytes;
    } good[] = {{"4096", 4096}, {"2G", 2ull << 30}, {"512M", 512ull << 20}, {"1.5GiB", 3ull << 29},
                {"1k", 1024},   {"7B", 7},          {"3TB", 3ull << 40}};
    uint64_t bytes;
    for (size_t i = 0; i < sizeof good / sizeof *good; i++) {
        if (!iso_parse_size(good[i].text, &bytes)) fail_msg("%s was refused", good[i].text);
        if (bytes != good[i].bytes) fail_msg("%s: %llu", good[i].text, (unsigned long long)bytes);
    }
    static const char *const bad[] = {"", "G", "0", "-1", "2X", "2GX", "1e30", "0.1", "2 G", "2iB"};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
        if (iso_parse_size(bad[i], &bytes)) fail_msg("'%s' was taken for a size", bad[i]);
}

/* ---- the table ---- */

static void test_defaults(void **state) {
    (void)state;
    parsed p;
    parse_good("in.nrrd", &p);
    const isorender_settings *s = &p.settings;
    assert_int_equal(s->input_count, 1);
    assert_string_equal(s->inputs[0], "in.nrrd");
    assert_null(s->output);
    assert_int_equal(s->width, 1024);
    assert_int_equal(s->height, 1024);
    assert_int_equal(s->method, ISORENDER_METHOD_UNCHOSEN);
    assert_int_equal(s->isovalue_count, 0);
    assert_int_equal(s->samples, 0); /* the usual number */
    assert_true(s->up.x == 0 && s->up.y == 0 && s->up.z == 1);
    assert_true(isnan(s->position[0]));
}

static void test_forms(void **state) {
    (void)state;
    parsed p;
    parse_good(
        "--isovalue -1024 --color=ff8000 --resolution 640,480 --zoom 2 --zoom=3 -o out.png --samples=16 "
        "--crop 1,2,3,4,5,6 --up -y --max-memory 2G --camera-position 1,2,-3 --background none -- --in.vti",
        &p);
    const isorender_settings *s = &p.settings;
    assert_true(s->isovalues[0] == -1024);
    assert_int_equal(s->colors[0].g, 0x80);
    assert_int_equal(s->width, 640);
    assert_int_equal(s->height, 480);
    assert_true(s->zoom == 3); /* the last wins */
    assert_string_equal(s->output, "out.png");
    assert_int_equal(s->samples, 16);
    assert_int_equal(s->common.input.crop[5], 6);
    assert_true(s->up.y == -1);
    assert_true(s->common.input.max_memory == 2ull << 30);
    assert_true(s->position[2] == -3);
    assert_int_equal(s->transparent, 1);
    assert_string_equal(s->inputs[0], "--in.vti");
}

static void test_aliases(void **state) {
    (void)state;
    parsed p;
    parse_good(
        "--camera-azimuth-angle 10 --camera-elevation-angle 20 --camera-zoom-factor 2 --camera-orthographic "
        "--camera-view-angle 40 --no-background --rendering-backend cpu --verbose=debug in.vtk out.png",
        &p);
    const isorender_settings *s = &p.settings;
    assert_true(s->azimuth == 10 && s->elevation == 20 && s->zoom == 2 && s->view_angle == 40);
    assert_int_equal(s->orthographic, 1);
    assert_int_equal(s->transparent, 1);
    assert_int_equal(s->verbose, 1);
    assert_string_equal(s->output, "out.png");
}

static void test_repeated(void **state) {
    (void)state;
    parsed p;
    parse_good("--isovalue 1,2 --color 010203 --isovalue 3 --color 040506 in.vti", &p);
    assert_int_equal(p.settings.isovalue_count, 3);
    assert_true(p.settings.isovalues[1] == 2 && p.settings.isovalues[2] == 3);
    assert_int_equal(p.settings.color_count, 2);
    assert_int_equal(p.settings.colors[1].b, 6);
}

static void test_colors(void **state) {
    (void)state;
    parsed p;
    parse_good("--isovalue 1,2,3,4 --color red,#00ff00,DarkSlateBlue --color ivory --background gray x.vti",
               &p);
    const iso_rgb *colors = p.settings.colors, background = p.settings.background;
    const iso_rgb expected[] = {{255, 0, 0}, {0, 255, 0}, {0x48, 0x3D, 0x8B}, {255, 255, 0xF0}};
    assert_int_equal(p.settings.color_count, 4);
    for (int i = 0; i < 4; i++) assert_memory_equal(&colors[i], &expected[i], sizeof colors[i]);
    assert_true(background.r == 128 && background.g == 128 && background.b == 128); /* CSS's, not X11's */
}

static void test_operands(void **state) {
    (void)state;
    parsed p;
    parse_good("a.vti b.vti -o {model}.png c.vti", &p);
    assert_int_equal(p.settings.input_count, 3);
    {
        parse_good("--scene gyroid:64 out.png", &p);
        assert_int_equal(p.settings.input_count, 1);
        assert_string_equal(p.settings.output, "out.png");
    }
    {
        parse_good("- -", &p);
        assert_string_equal(p.settings.inputs[0], "-");
        assert_string_equal(p.settings.output, "-");
    }
}

static void test_usage_errors(void **state) {
    (void)state;
    expect_failure("", ISO_ERR_USAGE, "no input");
    expect_failure("--isovale 3 x.vti", ISO_ERR_USAGE, "unknown option --isovale (did you mean --isovalue?)");
    expect_failure("--reslution=3 x.vti", ISO_ERR_USAGE,
                   "unknown option --reslution (did you mean --resolution?)");
    expect_failure("-isovalue 3 x.vti", ISO_ERR_USAGE, "did you mean --isovalue?");
    expect_failure("--turn 3 x.vti", ISO_ERR_USAGE, "did you mean --turntable?");
    expect_failure("--bogosity x.vti", ISO_ERR_USAGE, "unknown option --bogosity (see --help)");
    expect_failure("--isovalue", ISO_ERR_USAGE, "--isovalue needs a value");
    expect_failure("--isovalue --color=ff0000 x.vti", ISO_ERR_USAGE, "--isovalue needs a value");
    expect_failure("--quiet=1 x.vti", ISO_ERR_USAGE, "--quiet takes no value");
    expect_failure("--isovalue 3mm x.vti", ISO_ERR_USAGE, "option --isovalue: '3mm'");
    expect_failure("--isovalue 3, x.vti", ISO_ERR_USAGE, "option --isovalue");
    expect_failure("--isovalue auto --isovalue 3 x.vti", ISO_ERR_USAGE, "auto cannot be combined");
    expect_failure("--isovalue 3 --isovalue 3 x.vti", ISO_ERR_USAGE, "given twice");
    expect_failure(
        "--color rad x.vti", ISO_ERR_USAGE,
        "option --color: 'rad' is neither RRGGBB in hexadecimal, rgb(255,128,0), nor a colour name of CSS");
    expect_failure("--isovalue 1,2 --color red, x.vti", ISO_ERR_USAGE, "option --color: '' is neither");
    expect_failure("--color red,blue x.vti", ISO_ERR_USAGE, "2 colours for 1 isovalue");
    expect_failure("--background blu x.vti", ISO_ERR_USAGE, "option --background: 'blu' is neither");
    expect_failure("--color 010203 --color 010203 x.vti", ISO_ERR_USAGE, "2 colours for 1 isovalue");
    expect_failure("--samples 3 x.vti", ISO_ERR_USAGE, "square number");
    expect_failure("--samples 81 x.vti", ISO_ERR_USAGE, "square number");
    expect_failure("--resolution 640x x.vti", ISO_ERR_USAGE, "WxH");
    expect_failure("--resolution 0x480 x.vti", ISO_ERR_USAGE, "1 to 16384");
    expect_failure("--resolution 16385x480 x.vti", ISO_ERR_USAGE, "1 to 16384");
    expect_failure("--method splat x.vti", ISO_ERR_USAGE,
                   "exact, points, pullpush, discs, splats, mesh, raycast, hybrid");
    expect_failure("--camera nose x.vti", ISO_ERR_USAGE, "front, back");
    expect_failure("--up w x.vti", ISO_ERR_USAGE, "+x -x");
    expect_failure("--crop 5,4,0,1,0,1 x.vti", ISO_ERR_USAGE, "option --crop");
    expect_failure("--spacing 1,0,1 x.vti", ISO_ERR_USAGE, "option --spacing");
    expect_failure("--threads 0 x.vti", ISO_ERR_USAGE, "1 to 1024");
    expect_failure("--max-memory much x.vti", ISO_ERR_USAGE, "option --max-memory");
    expect_failure("--raw 3x4:uint8 x.raw", ISO_ERR_USAGE, "option --raw");
    expect_failure("x.vti out.bmp", ISO_ERR_USAGE, "out.bmp: a picture's name must end in .png");
    expect_failure("x.vti -o out.bmp", ISO_ERR_USAGE, "must end in .png");
    expect_failure("x.vti out.gif", ISO_ERR_USAGE, "a video needs several pictures");
    expect_failure("a.vti b.vti c.vti", ISO_ERR_USAGE, "--output TEMPLATE");
    expect_failure("x.vti - --json", ISO_ERR_USAGE, "standard output");
    expect_failure("x.vti - --turntable 4", ISO_ERR_USAGE, "standard output");
    expect_failure("x.vti --points p.xyz", ISO_ERR_USAGE, ".ply");
    expect_failure("x.vti --mesh p.gltf", ISO_ERR_USAGE, ".vtp, .stl, .ply, .obj, .glb or .3mf");
    expect_failure("x.vti --isovalue 1,2 --mesh p.ply", ISO_ERR_USAGE, "one isovalue");
    expect_failure("x.vti --no-image", ISO_ERR_USAGE, "nothing to do");
    expect_failure("--backend glx x.vti", ISO_ERR_BACKEND, "no backend 'glx'");
    expect_failure("--backend egl --method raycast x.vti", ISO_ERR_USAGE,
                   "--method points, pullpush, discs, splats (groups, flat or ewa), mesh or hybrid");
    expect_failure("--backend cpu --point-scaling attenuated x.vti", ISO_ERR_USAGE,
                   "--backend egl or osmesa");
}

/* What the table says must be usable: every name once, and every form of help names every option. */
static void test_table(void **state) {
    (void)state;
    const iso_program *program = isorender_program();
    for (size_t i = 0; i < program->option_count; i++)
        for (size_t j = 0; j < i; j++)
            assert_string_not_equal(program->options[i].name, program->options[j].name);
    static const char *const forms[] = {"all", "markdown", "man", "bash"};
    for (int form = 0; form < 4; form++) {
        char *text = NULL;
        size_t size = 0;
        FILE *stream = open_memstream(&text, &size);
        assert_int_equal(iso_options_help(program, forms[form], stream, NULL), ISO_OK);
        fclose(stream);
        for (size_t i = 0; i < program->option_count; i++) {
            char name[80];
            snprintf(name, sizeof name, "--%s", program->options[i].name);
            /* roff escapes dashes */
            char roff[160];
            size_t length = 0;
            for (const char *c = name; *c; c++) {
                if (form == 2 && *c == '-') roff[length++] = '\\';
                roff[length++] = *c;
            }
            roff[length] = 0;
            if (!strstr(text, roff)) fail_msg("--help %s does not name %s", forms[form], name);
        }
        if (form == 0)
            for (const char *line = text; *line; line += strcspn(line, "\n") + 1)
                if (strcspn(line, "\n") > 120) fail_msg("too long: %.*s", (int)strcspn(line, "\n"), line);
        free(text);
    }
}

/* ---- output names ---- */

static void expect_model(const char *input, const char *expected) {
    char *model = NULL;
    assert_int_equal(iso_template_model(input, &model, NULL), ISO_OK);
    assert_string_equal(model, expected);
    free(model);
}

static void test_models(void **state) {
    (void)state;
    expect_model("a/b/foo.nii.gz", "foo");
    expect_model("foo.bar.vti", "foo.bar");
    expect_model("foo", "foo");
    expect_model(".hidden", ".hidden");
    expect_model("scene:gyroid:64", "gyroid");
    expect_model("-", "stdin");
    expect_model("/usr/include/", "include");
    expect_model("/", "volume");
}

static void expect_name(const char *text, int number, const char *expected) {
    char *name = NULL;
    assert_int_equal(iso_template_expand(text, "m", number, &name, NULL), ISO_OK);
    assert_string_equal(name, expected);
    free(name);
}

static void test_templates(void **state) {
    (void)state;
    expect_name("out.png", 0, "out.png");
    expect_name("{model}_{n:3}.png", 7, "m_007.png");
    expect_name("{n}{n:2}{model}{model}", 123, "123123mm");
    expect_name("{model}_{n:4}.png", -1, "m_{n:4}.png");
    iso_error error = {0};
    char *name = NULL;
    static const char *const bad[] = {"{modle}.png", "{n:}.png", "{n:12}.png", "{n:x}.png", "a{.png"};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
        if (iso_template_expand(bad[i], "m", 0, &name, &error) != ISO_ERR_USAGE) fail_msg("%s", bad[i]);
    assert_true(iso_template_has("a{n:3}", "n"));
    assert_false(iso_template_has("a{n:3}", "model"));
    assert_int_equal(iso_template_numbered("d.x/out.png", 3, &name, NULL), ISO_OK);
    assert_string_equal(name, "d.x/out_{n:3}.png");
    free(name);
    assert_int_equal(iso_template_numbered("{n}.png", 3, &name, NULL), ISO_OK);
    assert_string_equal(name, "{n}.png");
    free(name);
}

static void test_plans(void **state) {
    (void)state;
    parsed p;
    isorender_plan *plans = NULL;
    {
        parse_good("x/a.vti y/b.nii.gz -o {model}.png --json={model}.json", &p);
        assert_int_equal(isorender_plans_make(&p.settings, &plans, NULL), ISO_OK);
        assert_string_equal(plans[0].image, "a.png");
        assert_string_equal(plans[1].json, "b.json");
        isorender_plans_free(plans, 2);
    }
    {
        parse_good("x/a.vti y/a.vti -o {model}.png", &p);
        assert_int_equal(isorender_plans_make(&p.settings, &plans, NULL), ISO_ERR_USAGE);
    }
    {
        parse_good("x/a.vti --turntable 4000 --aov b/{model}.exr", &p);
        assert_int_equal(isorender_plans_make(&p.settings, &plans, NULL), ISO_OK);
        char *frame = NULL;
        assert_int_equal(isorender_plan_frame(plans, plans->image, 37, &frame, NULL), ISO_OK);
        assert_string_equal(frame, "a_0037.png");
        free(frame);
        assert_int_equal(isorender_plan_frame(plans, plans->aov, 37, &frame, NULL), ISO_OK);
        assert_string_equal(frame, "b/a_0037.exr");
        free(frame);
        isorender_plans_free(plans, 1);
    }
    {
        parse_good("--scene torus:32 --points t.ply --mesh t.ply", &p);
        assert_int_equal(isorender_plans_make(&p.settings, &plans, NULL), ISO_ERR_USAGE);
    }
}

/* ---- JSON ---- */

static void test_json(void **state) {
    (void)state;
    char *text = NULL;
    size_t size = 0;
    FILE *stream = open_memstream(&text, &size);
    iso_json json = {0};
    iso_json_begin_object(&json, NULL);
    iso_json_string(&json, "a\"b", "\\ \n \x01 \xc3\xa9");
    iso_json_string(&json, "not UTF-8", "\xff \xed\xa0\x80");
    iso_json_real(&json, "tenth", 0.1);
    iso_json_real(&json, "third", 1.0 / 3);
    iso_json_real(&json, "nan", NAN);
    iso_json_integer(&json, "big", INT64_MAX);
    iso_json_integer(&json, "beyond", UINT64_MAX);
    iso_json_begin_array(&json, "empty");
    iso_json_end_array(&json);
    iso_json_ints(&json, "ints", (int[]){1, -2}, 2);
    iso_json_bool(&json, "yes", true);
    iso_json_string(&json, "none", NULL);
    iso_json_end_object(&json);
    assert_int_equal(iso_json_write(&json, stream, NULL), ISO_OK);
    fclose(stream);
    assert_string_equal(text, "{\n"
                              "  \"a\\\"b\": \"\\\\ \\n \\u0001 \xc3\xa9\",\n"
                              "  \"not UTF-8\": \"\\\\xff \\\\xed\\\\xa0\\\\x80\",\n"
                              "  \"tenth\": 0.10000000000000001,\n"
                              "  \"third\": 0.33333333333333331,\n"
                              "  \"nan\": null,\n"
                              "  \"big\": 9223372036854775807,\n"
                              "  \"beyond\": 1.8446744073709552e19,\n"
                              "  \"empty\": [],\n"
                              "  \"ints\": [\n    1,\n    -2\n  ],\n"
                              "  \"yes\": true,\n"
                              "  \"none\": null\n"
                              "}\n");
    free(text);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_numbers), cmocka_unit_test(test_sizes),    cmocka_unit_test(test_defaults),
        cmocka_unit_test(test_forms),   cmocka_unit_test(test_aliases),  cmocka_unit_test(test_repeated),
        cmocka_unit_test(test_colors),  cmocka_unit_test(test_operands), cmocka_unit_test(test_usage_errors),
        cmocka_unit_test(test_table),   cmocka_unit_test(test_models),   cmocka_unit_test(test_templates),
        cmocka_unit_test(test_plans),   cmocka_unit_test(test_json),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
