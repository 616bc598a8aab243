/* bench: measures Isopoint against its peers and itself, side by side in one process. See --help. */
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "apps/common/options.h"
#include "bench_harness.h"
#include "bench_quality.h"

static iso_status add_threads(void *target, const char *value, iso_error *error) {
    bench_settings *settings = target;
    int threads = 0;
    if (!iso_parse_int(value, &threads) || threads < 1 || threads > 1024)
        return iso_fail(error, ISO_ERR_USAGE, "'%s' is not a number of threads", value);
    if (settings->thread_count == BENCH_THREADS)
        return iso_fail(error, ISO_ERR_USAGE, "given more than %d times", BENCH_THREADS);
    settings->threads[settings->thread_count++] = threads;
    return ISO_OK;
}

static const iso_option options[] = {
    {.name = "filter",
     .value = "TEXT",
     .help = "Only rows whose name contains TEXT, and the rows they are compared with",
     .kind = ISO_OPTION_TEXT,
     .offset = offsetof(bench_settings, filter)},
    {.name = "json",
     .value = "FILE",
     .help = "Write the numbers in Google Benchmark's JSON as well",
     .kind = ISO_OPTION_TEXT,
     .offset = offsetof(bench_settings, json)},
    {.name = "repeat",
     .value = "N",
     .help = "Rounds in which all rows of a group take turns; medians are over rounds",
     .standard = "7",
     .kind = ISO_OPTION_INT,
     .offset = offsetof(bench_settings, repeat),
     .low = 1,
     .high = BENCH_ROUNDS},
    {.name = "threads",
     .value = "N",
     .help = "A number of threads to measure with",
     .standard = "1 and 2",
     .kind = ISO_OPTION_CALL,
     .flags = ISO_OPTION_REPEATABLE,
     .apply = add_threads},
    {.name = "list",
     .help = "Print the names of the rows and do nothing",
     .kind = ISO_OPTION_FLAG,
     .offset = offsetof(bench_settings, list)},
    {.name = "help",
     .aliases = "h",
     .help = "Print this text",
     .kind = ISO_OPTION_FLAG,
     .offset = offsetof(bench_settings, help)},
    {.name = "small",
     .help = "Tiny volumes: for the test of the bench itself",
     .kind = ISO_OPTION_FLAG,
     .flags = ISO_OPTION_HIDDEN,
     .offset = offsetof(bench_settings, small)},
    {.name = "vtk-child",
     .value = "FILE",
     .help = "Read FILE with VTK and print the time: for extract/vtkXMLImageDataReader",
     .kind = ISO_OPTION_TEXT,
     .flags = ISO_OPTION_HIDDEN,
     .offset = offsetof(bench_settings, vtk_child)},
};

static const char *const usage[] = {"[extract] [render] [sculpt] [OPTION]...", "quality [OPTION]...", NULL};
static const char *const groups[] = {"Options", NULL};
static const char *const notes[] = {
    "Every row is run in turn with those it is compared with, in one process; a ratio is that of",
    "two medians of the same run. Machines are shared and drift: ratios hold, milliseconds do not.",
    "Beside a ratio stands what the project asks for; the exit status is 0 whatever the speed.",
    "VTK's frames are drawn by Mesa's software renderer in a process of their own, on an X display",
    "that the bench starts (Xvfb), bound to as many processors as a row has threads.",
    "ISO_CPU=generic|avx2|avx512 bounds the instruction sets.",
    NULL};
static const iso_section sections[] = {{"Notes", notes}};

static const iso_program program = {
    .name = "bench",
    .version = "",
    .summary = "measures extraction, rendering and sculpting against VTK and OpenVDB",
    .usage = usage,
    .groups = groups,
    .options = options,
    .option_count = sizeof options / sizeof *options,
    .sections = sections,
    .section_count = 1};

typedef struct choices {
    bool extract, render, sculpt;
} choices;

static iso_status choose(const iso_operands *operands, choices *choice, iso_error *error) {
    for (int i = 0; i < operands->count; i++) {
        if (strcmp(operands->values[i], "extract") == 0)
            choice->extract = true;
        else if (strcmp(operands->values[i], "render") == 0)
            choice->render = true;
        else if (strcmp(operands->values[i], "sculpt") == 0)
            choice->sculpt = true;
        else
            return iso_fail(error, ISO_ERR_USAGE, "no bench is called '%s': extract, render, sculpt",
                            operands->values[i]);
    }
    if (operands->count == 0) choice->extract = choice->render = choice->sculpt = true;
    return ISO_OK;
}

static iso_status run(const bench_settings *settings, const choices *choice, iso_error *error) {
    bench_state bench;
    iso_status status = bench_open(settings, &bench, error);
    if (status == ISO_OK && !settings->list) bench_print_machine(&bench);
    if (status == ISO_OK && choice->extract) status = bench_extract(&bench, error);
    if (status == ISO_OK && choice->render) status = bench_render(&bench, error);
    if (status == ISO_OK && choice->sculpt) status = bench_sculpt(&bench, error);
    if (status == ISO_OK && !settings->list) bench_print_asked(&bench);
    if (status == ISO_OK && !settings->list && settings->json) status = bench_write_json(&bench, error);
    bench_close(&bench);
    return status;
}

static iso_status parse(int argc, char **argv, bench_settings *settings, choices *choice, iso_error *error) {
    const char **values = calloc((size_t)argc + 1, sizeof *values);
    if (!values) return iso_fail(error, ISO_ERR_NOMEM, "out of memory");
    iso_operands operands = {.values = values};
    iso_status status = iso_options_parse(&program, argc, argv, settings, &operands, error);
    if (status == ISO_OK) status = choose(&operands, choice, error);
    free(values);
    if (settings->thread_count == 0) {
        settings->threads[0] = 1;
        settings->threads[1] = 2;
        settings->thread_count = 2;
    }
    return status;
}

int main(int argc, char **argv) {
    if (argc > 1 && strcmp(argv[1], "quality") == 0) return bench_quality(argc - 1, argv + 1);
    bench_settings settings = {.repeat = 7};
    choices choice = {0};
    iso_error error = {0};
    iso_status status = parse(argc, argv, &settings, &choice, &error);
    if (status == ISO_OK && settings.help) {
        iso_options_help(&program, "all", stdout, NULL);
        return 0;
    }
    if (status == ISO_OK && settings.vtk_child) return bench_vtk_child(&settings);
    if (status == ISO_OK) status = run(&settings, &choice, &error);
    if (status != ISO_OK) fprintf(stderr, "bench: %s\n", error.text);
    return iso_status_exit(status);
}
