/* The command line of isosculpt: the table of options and the checks between options. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "apps/isosculpt/document.h"
#include "apps/isosculpt/isosculpt.h"
#include "apps/isosculpt/window/keyboard.h"
#include "base/file_types.h"
#include "io/mesh/mesh_write.h"
#include "sculpt/brush/brush.h"

#ifndef ISO_VERSION
#error "ISO_VERSION comes from CMake"
#endif

enum group { SESSION, INPUT, OUTPUT, RUNNING };

static const char *const groups[] = {"Session", ISOSCULPT_READING, "Output", "Running", NULL};
static const char *const usage[] = {"[STROKES|FILE]", "--replay STROKES --headless [--output OUT] [--json]",
                                    "--open FILE --headless [--replay STROKES] [--output OUT]", NULL};

static iso_status apply_resolution(void *target, const char *value, iso_error *error) {
    isosculpt_settings *settings = target;
    return iso_parse_resolution(value, settings->resolution, error);
}

static iso_status apply_measure(void *target, const char *value, iso_error *error) {
    return isosculpt_measure_parse(value, &((isosculpt_settings *)target)->measure, error);
}

static iso_status apply_freeze(void *target, const char *value, iso_error *error) {
    return isosculpt_freezing_parse(value, &((isosculpt_settings *)target)->freezing, error);
}

static iso_status apply_new(void *target, const char *value, iso_error *error) {
    isosculpt_settings *settings = target;
    ISO_TRY(isosculpt_solid_parse(value, &settings->solid, error));
    const iso_status status = iso_start_solid_check(&settings->solid, settings->solid.size.x, error);
    return status == ISO_OK ? ISO_OK : ISO_ERR_USAGE;
}

static iso_status apply_close_holes(void *target, const char *value, iso_error *error) {
    isosculpt_settings *settings = target;
    char *end;
    const double size = strtod(value, &end);
    if (end == value || *end || !(size >= 0) || !isfinite(size))
        return iso_fail(error, ISO_ERR_USAGE, "'%s' is no size in mm", value);
    settings->close_holes = size > 0 ? size : -1;
    return ISO_OK;
}

#define STROKE_EDIT(name, kind)                                                                              \
    static iso_status apply_##name(void *target, const char *value, iso_error *error) {                      \
        return isosculpt_edits_add(&((isosculpt_settings *)target)->edits, ISO_EVENT_##kind, value, error);  \
    }
STROKE_EDIT(edit, EDIT)
STROKE_EDIT(delete, DELETE)
STROKE_EDIT(mute, MUTE)
STROKE_EDIT(unmute, UNMUTE)
STROKE_EDIT(move, MOVE)
STROKE_EDIT(group, GROUP)
STROKE_EDIT(reseat, RESEAT)
#undef STROKE_EDIT

static const char *const backends[] = {"auto", "cpu", "gl", NULL};
static const char *const x_rays[] = {"off", "under", "over", NULL};
static const char *const spaces[] = {"file", "lps", "ras", NULL}; /* iso_space */

#define AT(member) .offset = offsetof(isosculpt_settings, member)

static const iso_option options[] = {
    {"recover", NULL, NULL, "continue the last session that was not closed", .group = SESSION,
     .kind = ISO_OPTION_FLAG, AT(recover)},
    {"new", NULL, "SOLID:SIZE",
     "begin with a solid around the origin: sphere:80, box:60x40x20 (mm), capsule:20x60, cylinder:40x60, "
     "torus:80x16 (across and along z); the edges of box and cylinder can be rounded (,round=4)",
     .group = SESSION, .kind = ISO_OPTION_CALL, .apply = apply_new, .standard = "sphere:80"},
    {"replay", NULL, "FILE", "play a stroke file", .group = SESSION, .kind = ISO_OPTION_TEXT, AT(replay)},
    {"edit", NULL, "STROKES:KEY=VALUE,...",
     "before the result is written, give strokes of --replay another brush; STROKES is a number or two (12 "
     "or 30-40, counted from 1 as they begin) or a group's name, KEY is tool, shape, falloff, radius, "
     "strength, aspect, blend, "
     "spacing, color (#RRGGBB, or none), symmetry (xz), radial (6z: six images around z), repeat "
     "(8x5/0/0: eight images, 5 mm apart along x; with three rows of them 8x5/0/0+3x0/5/0), alpha (fixed or "
     "follows), mirror (X/Y/Z, a "
     "point of the planes and the axis), pressure-radius or pressure-strength (on); these edits are made in "
     "the order in which they are given",
     .group = SESSION, .kind = ISO_OPTION_CALL, .apply = apply_edit, .flags = ISO_OPTION_REPEATABLE},
    {"delete", NULL, "STROKES", "remove strokes", .group = SESSION, .kind = ISO_OPTION_CALL,
     .apply = apply_delete, .flags = ISO_OPTION_REPEATABLE},
    {"mute", NULL, "STROKES", "leave strokes out, until --unmute brings them back", .group = SESSION,
     .kind = ISO_OPTION_CALL, .apply = apply_mute, .flags = ISO_OPTION_REPEATABLE},
    {"unmute", NULL, "STROKES", "draw muted strokes again", .group = SESSION, .kind = ISO_OPTION_CALL,
     .apply = apply_unmute, .flags = ISO_OPTION_REPEATABLE},
    {"move", NULL, "STROKES:N", "draw strokes before stroke N, or after all others (end)", .group = SESSION,
     .kind = ISO_OPTION_CALL, .apply = apply_move, .flags = ISO_OPTION_REPEATABLE},
    {"group", NULL, "STROKES:NAME",
     "give strokes the name of a group, which the list of --json shows, and by which further edits can name "
     "them (--mute ears)",
     .group = SESSION, .kind = ISO_OPTION_CALL, .apply = apply_group, .flags = ISO_OPTION_REPEATABLE},
    {"reseat", NULL, "STROKES",
     "move the samples of strokes along with the surface that edits of earlier strokes have moved from under "
     "them",
     .group = SESSION, .kind = ISO_OPTION_CALL, .apply = apply_reseat, .flags = ISO_OPTION_REPEATABLE},
    {"open", NULL, "FILE",
     "begin with a level set (.vdb), a mesh ({meshes}), lines as tubes ({lines}), points without faces "
     "({points}), whose holes are closed, a volume, or a scene ({scenes})",
     .group = SESSION, .kind = ISO_OPTION_TEXT, AT(open)},
    {"isovalue", NULL, "V",
     "of the volume that is opened (of a level set: mm from its surface); a window can change it",
     .group = SESSION, .kind = ISO_OPTION_REAL, AT(isovalue), .low = -1e300, .high = 1e300},
    {"label", NULL, "WHICH",
     "open one label of a segmentation: its number, or its name in a .seg.nrrd or --label-table; it goes "
     "back into a copy of its own file",
     .group = SESSION, .kind = ISO_OPTION_TEXT, AT(common.input.label)},
    {"label-table", NULL, "FILE", "names of labels (FreeSurfer, 3D Slicer or ITK-SNAP), for --label",
     .group = SESSION, .kind = ISO_OPTION_TEXT, AT(common.input.label_table)},
    {"freeze", NULL, "V",
     "freeze what the opened volume has at or above this isovalue, before the first stroke; labels: all "
     "others than --label",
     .group = SESSION, .kind = ISO_OPTION_CALL, .apply = apply_freeze},
#define SOLID SESSION
#include "apps/common/solid_options.inc"
#undef SOLID
    {"stamp", NULL, "FILE",
     "add and carve with this mesh ({meshes}), or weigh what deforming brushes do by this grey picture "
     "(.png); the strokes keep it",
     .group = SESSION, .kind = ISO_OPTION_TEXT, AT(stamp)},
    {"close-holes", NULL, "MM",
     "close holes of a mesh up to this size, 0: none; cuts by the border of a volume are capped in any case",
     .group = SESSION, .kind = ISO_OPTION_CALL, .apply = apply_close_holes,
     .standard = "a tenth of its longest side"},
    {"headless", NULL, NULL, "open no window", .group = SESSION, .kind = ISO_OPTION_FLAG, AT(headless)},
    {"voxel-size", NULL, "MM", "open or play at another voxel size", .group = SESSION,
     .kind = ISO_OPTION_REAL, AT(voxel_size), .standard = "the file's", .low = 1e-6, .high = 1e6},
    {"undo-memory", NULL, "SIZE", "memory for undo; more goes to disk", .group = SESSION,
     .kind = ISO_OPTION_SIZE, AT(undo_memory), .standard = "1G"},

#include "apps/common/input_options.inc"

    {"output", "o", "FILE",
     "write the result: .vdb level set, .ply points, .stl or .obj mesh; of --label also the segmentation "
     "with the label as it is now, under a name that ends as its own",
     .group = OUTPUT, .kind = ISO_OPTION_TEXT, AT(output)},
    {"mesh", NULL, "FILE", "write a mesh: {meshes written}", .group = OUTPUT, .kind = ISO_OPTION_TEXT,
     AT(mesh)},
    {"closed", NULL, NULL,
     "the solid ends at the border of the grid and is capped there, so that the meshes that are written are "
     "closed",
     .group = OUTPUT, .kind = ISO_OPTION_FLAG, AT(closed)},
    {"save-strokes", NULL, "FILE",
     "write the strokes of --replay with the edits as a stroke file (.strokes), in which these can be undone",
     .group = OUTPUT, .kind = ISO_OPTION_TEXT, AT(save_strokes)},
    {"measure", NULL, "PLACES",
     "say volume, area and size; of each place (X/Y/Z,X/Y/Z, mm) the nearest one of the surface, how thick "
     "the solid is there along the inward normal, and how far it is from the place before (--json: measured)",
     .group = OUTPUT, .kind = ISO_OPTION_CALL, .apply = apply_measure, .flags = ISO_OPTION_VALUE_OPTIONAL},
    {"video", NULL, "FILE",
     "write a video ({videos}) of the strokes as they are drawn, those that are left and in their order; "
     "ffmpeg encodes it",
     .group = OUTPUT, .kind = ISO_OPTION_TEXT, AT(video)},
    {"seconds", NULL, "S", "that the strokes take in the video", .group = OUTPUT, .kind = ISO_OPTION_REAL,
     AT(seconds), .standard = "10", .low = 0.04, .high = 36000},
    {"turntable", NULL, "S", "after the strokes the camera turns once around the result, in so many seconds",
     .group = OUTPUT, .kind = ISO_OPTION_REAL, AT(turntable), .standard = "0; 5 without strokes", .low = 0,
     .high = 36000},
    {"frame-rate", NULL, "N", "pictures a second of the video", .group = OUTPUT, .kind = ISO_OPTION_REAL,
     AT(frame_rate), .standard = "25", .low = 0.01, .high = 1000},
    {"json", NULL, "FILE", "say what was done as JSON, to standard output without a file", .group = OUTPUT,
     .kind = ISO_OPTION_CALL, .apply = iso_settings_apply_json, .extension = ".json",
     .flags = ISO_OPTION_VALUE_OPTIONAL},

    {"extract", NULL, NULL, "extract the points after every sample, and time it", .group = RUNNING,
     .kind = ISO_OPTION_FLAG, AT(extract)},
    {"draw", NULL, NULL, "draw the picture after every sample, as a window does, and time it",
     .group = RUNNING, .kind = ISO_OPTION_FLAG, AT(draw)},
    {"resolution", NULL, "WxH", "size of the pictures of --draw and --video", .group = RUNNING,
     .kind = ISO_OPTION_CALL, .apply = apply_resolution, .standard = "1280x800"},
    {"backend", "rendering-backend", "NAME",
     "what draws in the window: cpu, or gl (OpenGL: points, discs, pullpush and mesh, and exact as a mesh "
     "while it moves); auto is gl where a GPU does it; the panel changes it",
     .group = RUNNING, .kind = ISO_OPTION_CHOICE, AT(backend), .choices = backends, .standard = "auto"},
    {"x-ray", NULL, "NAME",
     "show the surface as it was when the session began, translucent: over the sculpture, or under it, where "
     "it lies in front; in a window, which can change it, or with --draw",
     .group = RUNNING, .kind = ISO_OPTION_CHOICE, AT(x_ray), .choices = x_rays, .standard = "off"},
    {"reference", NULL, "FILE",
     "show this with the sculpture instead: lines ({lines}), glyphs ({glyphs}) or a surface (a level set or "
     "a mesh, translucent); in a window or with --draw; R and --x-ray as above. In a window also a picture "
     "behind the sculpture, a .png or .jpg: face.jpg,y,120 is 120 mm high and faces the front",
     .group = RUNNING, .kind = ISO_OPTION_TEXTS, AT(references)},
    {"space", NULL, "NAME",
     "the axes of --reference: ras (to the right, to the front, up), lps or file (as it says; lps when it "
     "does not)",
     .group = RUNNING, .kind = ISO_OPTION_CHOICE, AT(space), .choices = spaces, .standard = "file"},
    {"scale", NULL, "F", "size of text and panel in the window: 2 is twice as large", .group = RUNNING,
     .kind = ISO_OPTION_REAL, AT(scale), .standard = "the screen's", .low = 0.5, .high = 4},
    {"font", NULL, "FILE", "a TrueType or OpenType font for the window, or builtin", .group = RUNNING,
     .kind = ISO_OPTION_TEXT, AT(font),
     .standard = "Inter, Noto Sans or DejaVu Sans, whichever is installed, else the built-in one"},
    {"threads", NULL, "N", "threads to use; the result does not depend on it", .group = RUNNING,
     .kind = ISO_OPTION_INT, AT(common.threads), .standard = "one a processor", .low = 1, .high = 1024},
#include "apps/common/running_options.inc"
};

static const char *const exit_text[] = {"0  done",
                                        "2  wrong usage",
                                        "3  the stroke file cannot be read, or is damaged",
                                        "4  no window can be opened: use --headless; or ffmpeg is missing",
                                        "5  out of memory",
                                        "6  nothing is left of the solid",
                                        "7  an output could not be written",
                                        NULL};
static const char *const example_text[] = {
    "isosculpt                    # a new ball",
    "isosculpt bear.strokes       # goes on where the file ends",
    "isosculpt --replay bear.strokes --headless --output bear.vdb",
    "isosculpt --replay bear.strokes --headless --edit 12:radius=4 --mute 20-24 --output bear.vdb",
    "isosculpt head.nrrd --isovalue 1150",
    "isosculpt bear.strokes --stamp star.stl",
    "isosculpt --open teapot.stl --headless --voxel-size 0.5 --output teapot.vdb",
    "isosculpt --replay bear.strokes --headless --voxel-size 0.5 --output bear.stl --json",
    NULL};
#define TOOL(name, text) text " "
static const char *const stroke_text[] = {
    "A stroke file (.strokes) is what the window writes while somebody works: one JSON object a",
    "line, each with a checksum. The first says what the strokes begin with; a stroke is a line",
    "\"begin\" (its brush: tool, radius in mm ..; at: mm in the world; normal: out of the solid),",
    "lines with further places, and a line \"end\". Programs make such files by isopoint_sculpt.h",
    "in C, or in Python:",
    "    s = isopoint.Sculpt(radius=40, journal=\"dent.strokes\")    # a ball",
    "    s.stroke(isopoint.Brush(12, \"carve\"), [[0, -40, 0], [5, -40, 0]])",
    "isosculpt and isorender open them. The tools:",
    ISO_TOOLS(TOOL),
    NULL};
#undef TOOL
#define KEY_LINE(key, meaning) key ": " meaning,
static const char *const key_text[] = {ISOSCULPT_KEYS(KEY_LINE) NULL};
#undef KEY_LINE
static const iso_section sections[] = {{"Mouse and keys", key_text},
                                       {"Strokes", stroke_text},
                                       {"Exit status", exit_text},
                                       {"Examples", example_text}};

const iso_program *isosculpt_program(void) {
    static const iso_program program = {.name = "isosculpt",
                                        .version = ISO_VERSION,
                                        .summary =
                                            "models a signed distance field by hand and never loses work",
                                        .usage = usage,
                                        .groups = groups,
                                        .options = options,
                                        .option_count = sizeof options / sizeof *options,
                                        .sections = sections,
                                        .section_count = sizeof sections / sizeof *sections};
    return &program;
}

/* Whether files of this name hold or are written as one of the bits of base/file_types.h says. */
static bool is_type(const char *name, unsigned holds) {
    return iso_file_type_of_name(name, holds) != ISO_FILE_UNKNOWN;
}

/* Rejects standard input as a source: a journal names the file that the session began with, which is read
 * again later. */
static iso_status check_files(const isosculpt_settings *settings, const iso_operands *operands,
                              iso_error *error) {
    const char *const files[] = {settings->open, settings->replay, settings->stamp,
                                 operands->count ? operands->values[0] : NULL};
    for (int i = 0; i < 4; i++)
        if (files[i] && strcmp(files[i], "-") == 0)
            return iso_fail(error, ISO_ERR_USAGE,
                            "standard input cannot be opened: a session needs a file that stays");
    return ISO_OK;
}

/* Rejects options for reading a volume if no file is opened. */
static iso_status check_opened(const isosculpt_settings *settings, iso_error *error) {
    const char *option = iso_input_volume_option(&settings->common.input);
    ISO_TRY(iso_input_check(&settings->common.input, error));
    if (!settings->open && !isnan(settings->isovalue))
        return iso_fail(error, ISO_ERR_USAGE, "--isovalue needs a file to open");
    if (settings->common.input.label && !isnan(settings->isovalue))
        return iso_fail(error, ISO_ERR_USAGE,
                        "--label and --isovalue cannot be combined: a label is a solid");
    if (settings->freezing.on && !settings->open)
        return iso_fail(error, ISO_ERR_USAGE, "--freeze needs a volume to open");
    if (settings->freezing.labels && !settings->common.input.label)
        return iso_fail(error, ISO_ERR_USAGE, "--freeze labels needs --label");
    if (!option && iso_input_drops_parts(&settings->common.input))
        option = settings->common.input.largest ? "--largest" : "--min-size";
    if (!settings->open && option) return iso_fail(error, ISO_ERR_USAGE, "%s needs a file to open", option);
    return ISO_OK;
}

/* Where the name of a picture's file ends in FILE.png,AXIS,HEIGHT; NULL: it names no picture. */
static const char *end_of_picture(const char *text) {
    static const char *const endings[] = {".png,", ".jpg,", ".jpeg,"};
    for (const char *at = text; *at; at++)
        for (size_t i = 0; i < sizeof endings / sizeof *endings; i++)
            if (strncasecmp(at, endings[i], strlen(endings[i])) == 0) return at + strlen(endings[i]) - 1;
    return NULL;
}

/* Takes the reference picture, FILE.png,AXIS,HEIGHT, out of the files of the reference. */
static iso_status take_picture(isosculpt_settings *settings, iso_error *error) {
    iso_texts *files = &settings->references;
    isosculpt_picture_request *picture = &settings->picture;
    int kept = 0;
    for (int i = 0; i < files->count; i++) {
        const char *text = files->values[i], *end = end_of_picture(text);
        int used = 0;
        if (!end) {
            files->values[kept++] = text;
            continue;
        }
        const size_t length = (size_t)(end - text);
        if (settings->headless)
            return iso_fail(error, ISO_ERR_USAGE, "--reference %s: reference pictures are for a window",
                            text);
        if (picture->path[0] || length >= sizeof picture->path)
            return iso_fail(error, ISO_ERR_USAGE, "--reference %s: %s", text,
                            picture->path[0] ? "one reference picture at a time" : "the path is too long");
        if (sscanf(end + 1, "%c,%lf%n", &picture->axis, &picture->height, &used) != 2 || end[1 + used] ||
            picture->axis < 'x' || picture->axis > 'z' || !(picture->height > 0 && picture->height < 1e9))
            return iso_fail(error, ISO_ERR_USAGE,
                            "--reference %s: a picture is FILE,AXIS,HEIGHT: face.jpg,y,120 stands across "
                            "the axis y and is 120 mm high",
                            text);
        memcpy(picture->path, text, length);
    }
    files->count = kept;
    return ISO_OK;
}

/* Refuses options that a window does not use. The operand is a stroke file or a file to open. */
static iso_status check_window(isosculpt_settings *settings, const iso_operands *operands, iso_error *error) {
    if (settings->video) return iso_fail(error, ISO_ERR_USAGE, "--video needs --headless");
    if (settings->measure.on)
        return iso_fail(error, ISO_ERR_USAGE, "--measure needs --headless: in a window the key D measures");
    if (settings->replay || settings->output || settings->mesh || settings->common.json ||
        settings->extract || settings->draw)
        return iso_fail(error, ISO_ERR_USAGE,
                        "--replay, --output, --mesh, --json, --extract and --draw need --headless");
    if (settings->edits.count || settings->save_strokes)
        return iso_fail(error, ISO_ERR_USAGE, "edits of strokes by options need --replay and --headless");
    const int begun = operands->count + (settings->open != NULL) + (settings->recover != 0);
    if (isosculpt_has_new(settings) && begun > 0)
        return iso_fail(error, ISO_ERR_USAGE, "one session at a time: --new is too many");
    if (begun > 1)
        return iso_fail(error, ISO_ERR_USAGE, "one session at a time: '%s' is too many",
                        operands->count ? operands->values[operands->count - 1] : settings->open);
    const char *operand = operands->count ? operands->values[0] : NULL;
    if (operand && is_type(operand, ISO_HOLDS_STROKES))
        settings->strokes = operand;
    else if (operand)
        settings->open = operand;
    if (settings->voxel_size > 0 && !settings->open && !isosculpt_has_new(settings))
        return iso_fail(error, ISO_ERR_USAGE, "--voxel-size needs a file to open, --new, or --headless");
    return check_opened(settings, error);
}

/* Rejects --recover without a window, because a recovered session is continued in one. The message names the
 * journal, so that the user can replay it. */
static iso_status refuse_recovery(iso_error *error) {
    char folder[ISOSCULPT_PATH], journal[ISOSCULPT_PATH];
    ISO_TRY(isosculpt_document_name_state_folder(folder, error));
    if (!isosculpt_document_find_unclosed(folder, journal))
        return iso_fail(error, ISO_ERR_USAGE,
                        "--recover needs a window, and %.700s holds no session that was not closed", folder);
    return iso_fail(error, ISO_ERR_USAGE,
                    "--recover needs a window; with --headless the session is played by --replay %.700s",
                    journal);
}

/* What is not said about the video; refuses what is said if there is none. */
static iso_status complete_video(isosculpt_settings *settings, iso_error *error) {
    const char *given = settings->seconds > 0      ? "--seconds"
                        : settings->turntable >= 0 ? "--turntable"
                        : settings->frame_rate > 0 ? "--frame-rate"
                                                   : NULL;
    if (given && !settings->video) return iso_fail(error, ISO_ERR_USAGE, "%s is for --video FILE", given);
    if (settings->frame_rate <= 0) settings->frame_rate = 25;
    if (settings->seconds <= 0) settings->seconds = 10;
    if (settings->turntable < 0) settings->turntable = settings->replay ? 0 : 5;
    return ISO_OK;
}

iso_status isosculpt_settings_parse(int argc, char *const *argv, isosculpt_settings *settings,
                                    iso_operands *operands, iso_error *error) {
    memset(settings, 0, sizeof *settings);
    settings->isovalue = NAN;
    settings->resolution[0] = 1280;
    settings->resolution[1] = 800;
    settings->turntable = -1;
    ISO_TRY(iso_options_parse(isosculpt_program(), argc, argv, settings, operands, error));
    if (settings->common.action) return ISO_OK;
    ISO_TRY(take_picture(settings, error));
    ISO_TRY(check_files(settings, operands, error));
    if (settings->space && !settings->references.count)
        return iso_fail(error, ISO_ERR_USAGE, "--space is for --reference, which is not given");
    ISO_TRY(complete_video(settings, error));
    if (!settings->headless) return check_window(settings, operands, error);
    if (settings->recover) return refuse_recovery(error);
    if (settings->scale > 0 || settings->font)
        return iso_fail(error, ISO_ERR_USAGE, "%s is for the window, which --headless does not open",
                        settings->font ? "--font" : "--scale");
    if (settings->backend == ISOSCULPT_BACKEND_GL)
        return iso_fail(error, ISO_ERR_USAGE,
                        "--backend gl needs a window: with --headless the cpu engine draws");
    if (operands->count > 0)
        return iso_fail(error, ISO_ERR_USAGE,
                        "%s: with --headless a file is named by --open, and strokes by --replay",
                        operands->values[0]);
    if (settings->open && isosculpt_has_new(settings))
        return iso_fail(error, ISO_ERR_USAGE, "a session begins with --open or with --new");
    if (!settings->replay && !settings->open && !isosculpt_has_new(settings))
        return iso_fail(error, ISO_ERR_USAGE, "--headless needs --replay FILE, --open FILE or --new SOLID");
    if ((settings->edits.count || settings->save_strokes) && !settings->replay)
        return iso_fail(error, ISO_ERR_USAGE, "edits of strokes, and --save-strokes, need --replay");
    if (settings->save_strokes && !is_type(settings->save_strokes, ISO_HOLDS_STROKES))
        return iso_fail(error, ISO_ERR_USAGE, "%s: strokes are written as .strokes", settings->save_strokes);
    if (settings->stamp)
        return iso_fail(error, ISO_ERR_USAGE, "--stamp is for a window: strokes hold their stamps");
    if ((settings->x_ray || settings->references.count) && !settings->draw)
        return iso_fail(error, ISO_ERR_USAGE, "%s is for pictures: with --headless it needs --draw",
                        settings->x_ray ? "--x-ray" : "--reference");
    ISO_TRY(check_opened(settings, error));
    const unsigned results = ISO_WRITES_VOLUME | ISO_WRITES_POINTS | ISO_WRITES_MESH;
    char known[64];
    iso_file_type_extensions(results, 0, "or", known, sizeof known);
    /* (Whether strokes began with a label is known when they are opened.) */
    const bool labels = (settings->common.input.label || (settings->replay && !settings->open)) &&
                        is_type(settings->output ? settings->output : "", ISO_HOLDS_VOLUME);
    if (settings->output && !labels && !is_type(settings->output, results))
        return iso_fail(error, ISO_ERR_USAGE, "%s: the result is written as %s", settings->output, known);
    if (settings->mesh) ISO_TRY(iso_mesh_write_check(settings->mesh, error));
    const bool writes_mesh =
        settings->mesh || (settings->output && is_type(settings->output, ISO_WRITES_MESH) &&
                           !is_type(settings->output, ISO_WRITES_POINTS));
    if (settings->closed && !writes_mesh)
        return iso_fail(error, ISO_ERR_USAGE,
                        "--closed is for meshes: it needs --mesh, or --output with .stl or .obj");
    return ISO_OK;
}
