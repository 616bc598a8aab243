/* options: the command line of isocompare: the table of options and the checks between options. */
#include <math.h>
#include <string.h>

#include "apps/isocompare/isocompare.h"
#include "base/file_types.h"

#ifndef ISO_VERSION
#error "ISO_VERSION comes from CMake"
#endif

enum group { IMAGES, REPORT, INPUT, RUNNING };

static const char *const groups[] = {"images: two pictures", "report: a volume", "report: reading the volume",
                                     "Running", NULL};

static const char *const usage[] = {
    "images [options] TRUTH CANDIDATE", "surfaces [options] A[:ISOVALUE] B[:ISOVALUE] [--output PAGE.html]",
    "sheet [options] A/ B/ --output PAGE.html", "report [options] VOLUME [--output DIR]", NULL};

/* ---- values that are not plain numbers ---- */

static iso_status apply_background(void *target, const char *value, iso_error *error) {
    isocompare_settings *settings = target;
    uint8_t rgb[3];
    if (!iso_parse_color(value, rgb)) return iso_fail_color(value, "", error);
    settings->background = (iso_rgb){rgb[0], rgb[1], rgb[2]};
    return ISO_OK;
}

static iso_status fail_metric(const char *value, size_t length, iso_error *error) {
    char known[256] = "";
    size_t count, used = 0;
    const iso_metric *list = iso_metric_list(&count);
    for (size_t i = 0; i < count && used < sizeof known; i++)
        used += (size_t)snprintf(known + used, sizeof known - used, "%s%s", i ? ", " : "", list[i].name);
    return iso_fail(error, ISO_ERR_USAGE, "'%.*s' is not one of %s", (int)length, value, known);
}

static iso_status apply_bound(void *target, const char *value, iso_error *error) {
    isocompare_settings *settings = target;
    char name[32];
    size_t length = strcspn(value, "=");
    isocompare_bound bound = {0};
    snprintf(name, sizeof name, "%.*s", length < sizeof name ? (int)length : 0, value);
    bound.metric = iso_metric_find(name);
    if (!bound.metric) return fail_metric(value, length, error);
    if (!value[length] || !iso_parse_real(value + length + 1, &bound.value))
        return iso_fail(error, ISO_ERR_USAGE, "'%s' is not METRIC=VALUE, such as psnr_in=40", value);
    if (settings->bound_count == ISOCOMPARE_BOUNDS)
        return iso_fail(error, ISO_ERR_USAGE, "given more than %d times", ISOCOMPARE_BOUNDS);
    settings->bounds[settings->bound_count++] = bound;
    return ISO_OK;
}

static iso_status apply_isovalue(void *target, const char *value, iso_error *error) {
    isocompare_settings *settings = target;
    if (iso_parse_real(value, &settings->isovalue)) return ISO_OK;
    return iso_fail(error, ISO_ERR_USAGE, "'%s' is not a number", value);
}

/* ---- the table ---- */

#define FIELD(name) .offset = offsetof(isocompare_settings, name)
#include "apps/common/option_rows.h"

static const iso_option options[] = {
    {"fail-under", NULL, "METRIC=VALUE",
     "end with status 1 when the candidate is worse than this: below VALUE for psnr, psnr_in, ssim and iou, "
     "above it for the others; a metric that is not known is worse than anything",
     .group = IMAGES, CALL(apply_bound), .flags = ISO_OPTION_REPEATABLE},
    {"background", "background-color", "COLOR",
     "the colour, RRGGBB or a name of CSS, that means \"not covered\" in pictures without transparency, and "
     "what transparent ones and those of a report are laid on",
     .group = IMAGES, .standard = "FFFFFF", CALL(apply_background)},
    {"aov-a", NULL, "FILE.exr", "depth, normals and coverage of TRUTH, as isorender --aov writes them",
     .group = IMAGES, TEXT(truth_aov)},
    {"aov-b", NULL, "FILE.exr", "the same of CANDIDATE", .group = IMAGES, TEXT(candidate_aov)},
    {"voxel", NULL, "MM", "size of a voxel, for errors of depth", .group = IMAGES,
     .standard = "what TRUTH's .exr says", REAL(voxel, 1e-12, 1e12)},
    {"pixels-per-voxel", NULL, "N", "for dilations in voxels", .group = IMAGES,
     REAL(pixels_per_voxel, 1e-9, 1e9)},
    {"pixels-per-degree", "ppd", "N", "how densely the eye sees the pictures, for FLIP", .group = IMAGES,
     .standard = "67.02", REAL(pixels_per_degree, 1, 450)},
    {"difference", NULL, "FILE.png", "write a picture of FLIP's differences, black to white", .group = IMAGES,
     TEXT(difference)},

    {"json", NULL, "FILE", "one object with all metrics, or distances of surfaces, to stdout without a FILE",
     .group = IMAGES, CALL(iso_settings_apply_json), .extension = ".json",
     .flags = ISO_OPTION_VALUE_OPTIONAL},

    {"output", "o", "DIR",
     "folder for report.html and report.json; made when it is not there. Of surfaces a page, .html, with "
     "both coloured by distance; of a sheet a .html or a picture",
     .group = REPORT, .standard = "the volume's name with -report, in the current folder; of surfaces none",
     TEXT(output), .flags = ISO_OPTION_UNRECORDED},
    {"isovalue", "isosurface iso-value", "V",
     "value of the surface, or of both surfaces, in the file's physical units (of a level set: mm)",
     .group = REPORT, .standard = "as isorender chooses it", CALL(apply_isovalue)},
    {"side", NULL, "N", "pixels a side of its pictures, a multiple of 32", .group = REPORT,
     .standard = "1024, of a sheet 320", INT(side, 64, 4096)},
#include "apps/common/input_options.inc"

    {"jobs", "j", "N", "pairs of a sheet that are compared at a time, each by a process", .group = RUNNING,
     .standard = "one a processor", INT(jobs, 1, 1024), UNRECORDED},
    {"threads", NULL, "N", "threads to use; what comes out does not depend on it", .group = RUNNING,
     .standard = "one a processor", INT(common.threads, 1, 1024), UNRECORDED},
#include "apps/common/running_options.inc"
};

static const char *const metrics_text[] = {
    "psnr_in            dB, over both silhouettes widened by 2 pixels    larger is better; identical "
    "(--json: \"inf\")",
    "psnr               dB, over the whole picture                       larger",
    "error_p99          of 255: 99 % of these pixels differ by at most   smaller",
    "error_max          of 255: largest difference of a channel          smaller",
    "ssim               structural similarity (2004) of luma             larger; 1 when equal",
    "flip               LDR-FLIP (2020), mean                            smaller; 0 when equal",
    "iou                shared part of the silhouettes                   larger; 1 when equal",
    "dilation_mean      pixels: area gained along the truth's border     nearer to 0",
    "dilation_p99       pixels: 99 % of the border are at most so far    smaller",
    "dilation_max       pixels: farthest from the truth's silhouette     smaller",
    "dilation_mean_voxel, dilation_max_voxel: with --pixels-per-voxel    smaller",
    "holes              % open inside the truth's silhouette             smaller",
    "normal_error_deg   degrees, mean; from .exr                         smaller",
    "depth_error_voxel  voxels, mean without the wrong ones; from .exr   smaller",
    "wrong              % more than 2 voxels off; from .exr              smaller",
    "pixels_differing   pixels off by more than 1/255 in a channel       smaller",
    "A silhouette comes from alpha when the picture is transparent, else from coverage (.exr), else it is",
    "all that is not the background's colour; the output says which.",
    NULL};

static const char *const exit_text[] = {"0  done",
                                        "1  the candidate is worse than a bound, or the sizes differ",
                                        "2  wrong usage",
                                        "3  a picture or the volume cannot be read",
                                        "5  over the memory limit, or out of memory",
                                        "6  the surface is empty",
                                        "7  an output could not be written",
                                        "Of a sheet: that of the first pair that failed, which is red on it.",
                                        NULL};

static const char *const example_text[] = {
    "isocompare images truth.png points.png",
    "isocompare images truth.png points.png --fail-under psnr_in=30 --fail-under holes=0.2",
    "isocompare images truth.png points.png --aov-a truth.exr --aov-b points.exr --json=errors.json",
    "isocompare images truth.exr points.exr",
    "isocompare surfaces before.nrrd:300 after.nrrd:300 --output change.html",
    "isocompare sheet before/ after/ --isovalue 300 -o changes.html",
    NULL};

static const iso_section sections[] = {
    {"Metrics", metrics_text}, {"Exit status", exit_text}, {"Examples", example_text}};

/* Records options that belong to only one of the commands; with the other command they are an error. */
static void record_command_option(void *target, const iso_option *option, const char *value) {
    isocompare_settings *settings = target;
    if (option->group == IMAGES && strcmp(option->name, "background") != 0 &&
        strcmp(option->name, "pixels-per-degree") != 0)
        settings->of_images = option->name;
    if (option->group == REPORT || (option->group == INPUT && strcmp(option->name, "max-memory") != 0))
        settings->of_report = option->name;
    static const char *const of_surfaces[] = {"json", "output",     "isovalue",
                                              "side", "background", "max-memory"};
    bool shared = option->group == RUNNING;
    for (size_t i = 0; i < sizeof of_surfaces / sizeof *of_surfaces; i++)
        shared |= strcmp(option->name, of_surfaces[i]) == 0;
    if (!shared) settings->not_of_surfaces = option->name;
    iso_settings_record_option(settings, option, value);
}

const iso_program *isocompare_program(void) {
    static const iso_program program = {.name = "isocompare",
                                        .version = ISO_VERSION,
                                        .summary = "how far pictures of isosurfaces are from the truth",
                                        .usage = usage,
                                        .groups = groups,
                                        .options = options,
                                        .option_count = sizeof options / sizeof *options,
                                        .sections = sections,
                                        .section_count = sizeof sections / sizeof *sections,
                                        .seen = record_command_option};
    return &program;
}

/* ---- checks between options ---- */

static iso_status take_images(isocompare_settings *settings, const iso_operands *operands, iso_error *error) {
    if (operands->count != 3)
        return iso_fail(error, ISO_ERR_USAGE, "images takes two pictures, the truth first");
    settings->command = ISOCOMPARE_IMAGES;
    settings->truth = operands->values[1];
    settings->candidate = operands->values[2];
    return ISO_OK;
}

static iso_status take_report(isocompare_settings *settings, const iso_operands *operands, iso_error *error) {
    if (operands->count != 2) return iso_fail(error, ISO_ERR_USAGE, "report takes one volume");
    if (settings->side % 32)
        return iso_fail(error, ISO_ERR_USAGE, "--side: %d is not a multiple of 32", settings->side);
    settings->command = ISOCOMPARE_REPORT;
    settings->volume = operands->values[1];
    return ISO_OK;
}

static iso_status take_surfaces(isocompare_settings *settings, const iso_operands *operands,
                                iso_error *error) {
    if (operands->count != 3)
        return iso_fail(error, ISO_ERR_USAGE,
                        "surfaces takes two volumes or meshes, each FILE or FILE:ISOVALUE");
    if (settings->output && iso_file_type_of_name(settings->output, ISO_WRITES_PAGE) == ISO_FILE_UNKNOWN)
        return iso_fail(
            error, ISO_ERR_USAGE,
            "%s: surfaces writes a page, .html (a picture of one coloured by its distance to the other: "
            "isorender A OUT.png --surface-color-by distance:B)",
            settings->output);
    settings->command = ISOCOMPARE_SURFACES;
    settings->truth = operands->values[1];
    settings->candidate = operands->values[2];
    return ISO_OK;
}

static iso_status take_sheet(isocompare_settings *settings, const iso_operands *operands, iso_error *error) {
    if (operands->count != 3)
        return iso_fail(error, ISO_ERR_USAGE,
                        "sheet takes two folders, whose files are paired by their names");
    if (!settings->output)
        return iso_fail(error, ISO_ERR_USAGE, "sheet: needs a name: -o OUT.html or OUT.png");
    settings->command = ISOCOMPARE_SHEET;
    settings->truth = operands->values[1];
    settings->candidate = operands->values[2];
    return ISO_OK;
}

static iso_status take_operands(isocompare_settings *settings, const iso_operands *operands,
                                iso_error *error) {
    if (operands->count == 0) return iso_fail(error, ISO_ERR_USAGE, "no command (see --help)");
    const char *command = operands->values[0];
    if (strcmp(command, "images") == 0) return take_images(settings, operands, error);
    if (settings->jobs && strcmp(command, "sheet") != 0)
        return iso_fail(error, ISO_ERR_USAGE, "--jobs does not belong to %s", command);
    if (strcmp(command, "report") == 0) return take_report(settings, operands, error);
    if (strcmp(command, "sheet") == 0) return take_sheet(settings, operands, error);
    if (strcmp(command, "surfaces") == 0) return take_surfaces(settings, operands, error);
    return iso_fail(
        error, ISO_ERR_USAGE,
        "there is no command '%s': 'images TRUTH CANDIDATE', 'surfaces A B', 'sheet A/ B/' or 'report "
        "VOLUME'",
        command);
}

static iso_status check_command(const isocompare_settings *settings, iso_error *error) {
    static const char *const names[] = {"images", "report", "surfaces", "sheet"};
    const char *const strays[] = {settings->of_report, settings->of_images, settings->not_of_surfaces,
                                  settings->not_of_surfaces};
    const char *stray = strays[settings->command];
    if (!stray) return ISO_OK;
    return iso_fail(error, ISO_ERR_USAGE, "--%s does not belong to %s", stray, names[settings->command]);
}

iso_status isocompare_settings_parse(int argc, char *const *argv, isocompare_settings *settings,
                                     iso_operands *operands, iso_error *error) {
    *settings = (isocompare_settings){.background = {255, 255, 255}, .isovalue = NAN, .side = 1024};
    if (argc > 1 && strcmp(argv[1], "sheet") == 0) settings->side = 320;
    ISO_TRY(iso_options_parse(isocompare_program(), argc, argv, settings, operands, error));
    if (settings->common.action) return ISO_OK;
    ISO_TRY(take_operands(settings, operands, error));
    return check_command(settings, error);
}
