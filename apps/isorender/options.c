/* The command line of isorender: the table of options and the checks between options. Options that F3D has,
 * too, have F3D's names. */
#include <limits.h>
#include <math.h>
#include <string.h>

#include "apps/isorender/backend.h"
#include "apps/isorender/settings.h"
#include "base/text.h"
#include "image/image.h"
#include "methods/glass.h"
#include "methods/layers.h"

#ifndef ISO_VERSION
#error "ISO_VERSION comes from CMake"
#endif

enum group { INPUT, SURFACE, OBJECTS, PICTURE, CAMERA, OUTPUT, RUNNING };

static const char *const groups[] = {
    "Input", "Surface", "Lines, glyphs and meshes", "Picture", "Camera", "Other outputs", "Running", NULL};

static const char *const usage[] = {"[options] IN [OUT.png]", "[options] --output TEMPLATE IN ...",
                                    "[options] --scene NAME[:SIZE] [OUT.png]",
                                    "[options] --lines FILE [--glyphs FILE ...] [OUT.png]", NULL};

/* The reconstructions of pullpush have an option of their own. The names come from the table of renderers. */
enum { METHODS = 7 };
static const iso_method methods[METHODS] = {ISO_METHOD_EXACT,  ISO_METHOD_POINTS, ISO_METHOD_PULLPUSH,
                                            ISO_METHOD_SPLATS, ISO_METHOD_MESH,   ISO_METHOD_RAYCAST,
                                            ISO_METHOD_HYBRID};
static const char *method_names[METHODS + 1]; /* filled by isorender_program */
static const char *const reconstructions[] = {"refined", "box", "gaussian", "groups", NULL};
static const char *const transparencies[] = {"sorted", "groups", "nearest", NULL};
static const char *const directions[] = {"front", "back", "left", "right", "top", "bottom", "iso", NULL};
static const char *const scalings[] = {"exact", "attenuated", NULL};
static const char *const fits[] = {"box", "tight", NULL};
static const char *const opacity_modes[] = {"angle", "constant", NULL};
static const char *refractions[ISO_REFRACTIONS + 1]; /* filled by isorender_program */
static const char *const primitives[] = {"auto", "edge", "foot", "foot-iterated", NULL};

/* ---- values that are not plain numbers ---- */

static iso_status apply_isovalue(void *target, const char *value, iso_error *error) {
    isorender_settings *settings = target;
    if (strcmp(value, "auto") == 0) {
        settings->isovalue_auto = 1;
        return ISO_OK;
    }
    for (const char *at = value;;) {
        char number[64];
        size_t length = strcspn(at, ",");
        snprintf(number, sizeof number, "%.*s", length < 63 ? (int)length : 63, at);
        double isovalue;
        if (length > 63 || !iso_parse_real(number, &isovalue))
            return iso_fail(error, ISO_ERR_USAGE, "'%s' is neither a number nor 'auto'", value);
        if (settings->isovalue_count == ISORENDER_SURFACES)
            return iso_fail(error, ISO_ERR_USAGE, "more than %d isovalues", ISORENDER_SURFACES);
        settings->isovalues[settings->isovalue_count++] = isovalue;
        if (!at[length]) return ISO_OK;
        at += length + 1;
    }
}

static bool parse_color(const char *value, iso_rgb *color) {
    uint8_t rgb[3];
    if (!iso_parse_color(value, rgb)) return false;
    *color = (iso_rgb){rgb[0], rgb[1], rgb[2]};
    return true;
}

static iso_status add_color(isorender_settings *settings, const char *value, iso_error *error) {
    if (settings->color_count == ISORENDER_SURFACES)
        return iso_fail(error, ISO_ERR_USAGE, "more than %d colours", ISORENDER_SURFACES);
    if (!parse_color(value, &settings->colors[settings->color_count]))
        return iso_fail(error, ISO_ERR_USAGE,
                        "'%s' is neither RRGGBB in hexadecimal nor a colour name of CSS", value);
    settings->color_count++;
    return ISO_OK;
}

static iso_status apply_color(void *target, const char *value, iso_error *error) {
    for (const char *at = value;;) {
        char color[64];
        size_t length = strcspn(at, ",");
        snprintf(color, sizeof color, "%.*s", length < 63 ? (int)length : 63, at);
        ISO_TRY(add_color(target, color, error));
        if (!at[length]) return ISO_OK;
        at += length + 1;
    }
}

static iso_status apply_opacity(void *target, const char *value, iso_error *error) {
    isorender_settings *settings = target;
    for (const char *at = value;;) {
        char number[64];
        size_t length = strcspn(at, ",");
        snprintf(number, sizeof number, "%.*s", length < 63 ? (int)length : 63, at);
        double opacity;
        if (length > 63 || !iso_parse_real(number, &opacity) || !(opacity >= 0 && opacity <= 1))
            return iso_fail(error, ISO_ERR_USAGE, "'%s' is not an opacity from 0 to 1", number);
        if (settings->opacity_count == ISORENDER_SURFACES)
            return iso_fail(error, ISO_ERR_USAGE, "more than %d opacities", ISORENDER_SURFACES);
        settings->opacities[settings->opacity_count++] = opacity;
        if (!at[length]) return ISO_OK;
        at += length + 1;
    }
}

static iso_status add_object(isorender_settings *settings, isorender_object_kind kind, const char *path,
                             iso_error *error) {
    isorender_object_options *objects = &settings->object_options;
    if (!*path) return iso_fail(error, ISO_ERR_USAGE, "the value is empty");
    if (objects->count == ISORENDER_OBJECTS)
        return iso_fail(error, ISO_ERR_USAGE, "more than %d files of lines, glyphs and meshes",
                        ISORENDER_OBJECTS);
    objects->kinds[objects->count] = kind;
    objects->paths[objects->count++] = path;
    return ISO_OK;
}

static iso_status apply_lines(void *target, const char *value, iso_error *error) {
    return add_object(target, ISORENDER_LINES, value, error);
}

static iso_status apply_glyphs(void *target, const char *value, iso_error *error) {
    return add_object(target, ISORENDER_GLYPHS, value, error);
}

static iso_status apply_surface(void *target, const char *value, iso_error *error) {
    return add_object(target, ISORENDER_MESH, value, error);
}

static iso_status apply_volume(void *target, const char *value, iso_error *error) {
    isorender_volume_options *volumes = &((isorender_settings *)target)->volume_options;
    if (!*value) return iso_fail(error, ISO_ERR_USAGE, "the value is empty");
    if (volumes->count == ISORENDER_VOLUMES)
        return iso_fail(error, ISO_ERR_USAGE, "more than %d volumes", ISORENDER_VOLUMES);
    volumes->paths[volumes->count++] = value;
    return ISO_OK;
}

static iso_status apply_background(void *target, const char *value, iso_error *error) {
    isorender_settings *settings = target;
    bool none = strcmp(value, "none") == 0;
    if (!none && !parse_color(value, &settings->background))
        return iso_fail(error, ISO_ERR_USAGE,
                        "'%s' is neither RRGGBB in hexadecimal nor a colour name of CSS nor 'none'", value);
    settings->transparent = none;
    settings->background_given = 1;
    return ISO_OK;
}

static iso_status apply_attenuation_color(void *target, const char *value, iso_error *error) {
    isorender_settings *settings = target;
    settings->attenuation_colored = 1;
    if (parse_color(value, &settings->attenuation_color)) return ISO_OK;
    return iso_fail(error, ISO_ERR_USAGE, "'%s' is neither RRGGBB in hexadecimal nor a colour name of CSS",
                    value);
}

static iso_status apply_resolution(void *target, const char *value, iso_error *error) {
    isorender_settings *settings = target;
    int size[2];
    ISO_TRY(iso_parse_resolution(value, size, error));
    settings->width = size[0];
    settings->height = size[1];
    return ISO_OK;
}

static iso_status apply_samples(void *target, const char *value, iso_error *error) {
    isorender_settings *settings = target;
    int samples;
    if (iso_parse_int(value, &samples))
        for (int side = 1; side <= 8; side++)
            if (side * side == samples) {
                settings->samples = samples;
                return ISO_OK;
            }
    return iso_fail(error, ISO_ERR_USAGE, "'%s' is not a square number from 1 to 64 (1, 4, 9, 16, ...)",
                    value);
}

/* 0.05 or 5%. */
static iso_status apply_margin(void *target, const char *value, iso_error *error) {
    isorender_settings *settings = target;
    char number[64];
    const size_t length = strlen(value);
    const bool percent = length > 0 && value[length - 1] == '%';
    double margin;
    snprintf(number, sizeof number, "%.*s", length < 63 ? (int)(length - percent) : 63, value);
    bool good = length < 63 && iso_parse_real(number, &margin);
    if (good && percent) margin /= 100;
    if (!good || !(margin >= 0 && margin <= 0.45))
        return iso_fail(error, ISO_ERR_USAGE,
                        "'%s' is not a part of the picture from 0 to 0.45, or 0%% to 45%%", value);
    settings->margin = margin;
    return ISO_OK;
}

static iso_status apply_up(void *target, const char *value, iso_error *error) {
    isorender_settings *settings = target;
    const char *axis = value + (*value == '+' || *value == '-');
    double sign = *value == '-' ? -1 : 1;
    if (strlen(axis) != 1 || *axis < 'x' || *axis > 'z')
        return iso_fail(error, ISO_ERR_USAGE, "'%s' is not one of +x -x +y -y +z -z", value);
    settings->up = iso_vec3_make(*axis == 'x' ? sign : 0, *axis == 'y' ? sign : 0, *axis == 'z' ? sign : 0);
    return ISO_OK;
}

static iso_status apply_verbose(void *target, const char *value, iso_error *error) {
    static const char *const levels[] = {"quiet", "error", "warning", "info", "debug"};
    isorender_settings *settings = target;
    int level = 3;
    if (value)
        for (level = 0; level < 5 && strcmp(levels[level], value) != 0;) level++;
    if (level == 5)
        return iso_fail(error, ISO_ERR_USAGE, "'%s' is not one of quiet, error, warning, info, debug", value);
    settings->verbose = level >= 3;
    settings->common.quiet = level <= 1;
    return ISO_OK;
}

static iso_status apply_list_backends(void *target, const char *value, iso_error *error) {
    (void)value, (void)error;
    ((isorender_settings *)target)->common.action = ISORENDER_ACTION_LIST_BACKENDS;
    return ISO_OK;
}

/* ---- the table ---- */

#define FIELD(name) .offset = offsetof(isorender_settings, name)
#include "apps/common/option_rows.h"

static const iso_option options[] = {
#include "apps/common/input_options.inc"
    {"scene", NULL, "NAME[:SIZE]",
     "a procedural volume instead of a file: sphere, cylinder, cube, gyroid, torus, ct, "
     "head (the same as the input scene:NAME[:SIZE])",
     .group = INPUT, TEXT(scene)},

    {"isovalue", "isosurface iso-value", "V",
     "value of the surface, in the file's physical units (of a level set: mm from its surface, above 0 "
     "outside); "
     "several, separated by commas, give several surfaces; auto: 0 for level sets, else Otsu's threshold of "
     "the "
     "histogram",
     .group = SURFACE, .standard = "auto", CALL(apply_isovalue), .flags = ISO_OPTION_REPEATABLE},
    {"color", "colour", "COLOR",
     "colour of the surface: RRGGBB in hexadecimal or a name of CSS such as ivory; several, separated by "
     "commas: the second one belongs to the second isovalue, and so on",
     .group = SURFACE, .standard = "D9B36C", CALL(apply_color), .flags = ISO_OPTION_REPEATABLE},
    {"opacity", NULL, "A",
     "opacity of the surface, 0 (not seen) to 1; several, separated by commas: the second one belongs to the "
     "second isovalue, and so on; the last one repeats; for the methods exact, raycast and splats (files of "
     "points)",
     .group = SURFACE, .standard = "1", CALL(apply_opacity), .flags = ISO_OPTION_REPEATABLE},
    {"opacity-mode", NULL, "NAME",
     "angle: the surface is a thin slab, more opaque where it is seen at a slant, so that outlines stand "
     "out; "
     "constant: the same at every angle",
     .group = SURFACE, .standard = "angle", CHOICE(opacity_mode, opacity_modes)},
    {"absorption", NULL, "MM",
     "the solid of a translucent surface takes light away: after this many mm 1/e of it is left, the rest "
     "has "
     "the surface's colour (with --opacity 0 only the solid is seen, as in an X-ray image)",
     .group = SURFACE, REAL(absorption_length, 1e-6, 1e9)},
    {"layers", NULL, "N",
     "draw only the first N crossings of each translucent surface or file of lines, glyphs or triangles: 1 "
     "is "
     "the skin without what lies behind it",
     .group = SURFACE, .standard = "all", INT(layers, 1, 1000000)},
    {"transparency", NULL, "NAME",
     "how splats are seen through: sorted (every layer of the surface, in order), groups (a picture of each "
     "group, and their mean) or nearest (the same behind a smooth nearest layer; both Zhang and Pajarola "
     "2006)",
     .group = SURFACE, .standard = "sorted", CHOICE(transparency, transparencies)},
    {"ior", NULL, "N",
     "draw the solid as glass with this index of refraction (1.5: window glass, 1.33: water); for the "
     "methods "
     "exact and raycast",
     .group = SURFACE, REAL(ior, 1, 10)},
    {"refraction", NULL, "NAME",
     "how glass bends light: traced (rays are followed through the solid, with all reflections: the truth), "
     "two-sided (bent where they enter and first leave), layers (bent once, more for each surface: pretty, "
     "but "
     "no approximation) or none (only reflection and absorption)",
     .group = SURFACE, .standard = "traced", CHOICE(refraction, refractions)},
    {"environment", NULL, "FILE",
     "what glass reflects and refracts: an equirectangular .exr (linear R G B) or .png; it is also the "
     "background unless --background is given",
     .group = SURFACE, .standard = "a studio", TEXT(environment)},
    {"attenuation-color", NULL, "COLOR",
     "colour that white light has after --attenuation-distance in the glass (as in KHR_materials_volume)",
     .group = SURFACE, .standard = "FFFFFF", CALL(apply_attenuation_color)},
    {"attenuation-distance", NULL, "MM", "see --attenuation-color", .group = SURFACE,
     REAL(attenuation_distance, 1e-6, 1e9)},
    {"primitive", NULL, "NAME",
     "which points: auto, edge, foot, foot-iterated; auto is foot for sparse level sets unless they are "
     "drawn by "
     "refined or the isovalue is near the end of the narrow band, edge for the rest",
     .group = SURFACE, .standard = "auto", CHOICE(primitive, primitives)},

#define SOLID SURFACE
#include "apps/common/solid_options.inc"
#undef SOLID
    {"closed", NULL, NULL,
     "the solid ends at the volume's border and is capped there, so that meshes are closed; voxels that are "
     "no numbers are outside it",
     .group = SURFACE, FLAG(closed)},

#include "apps/isorender/object_options.inc"

    {"method", NULL, "NAME",
     "how the surface is drawn: exact (the trilinear surface itself, at any zoom: choose it for pictures), "
     "mesh (Marching Cubes: to see what --mesh exports, or to compare with other programs), pullpush "
     "(points, filled in image space: for files of points, and to draw many points on a GPU; --lines are "
     "drawn that way, too: the method of Marroquim et al. 2008, to compare it), points (discs: to see the "
     "samples themselves), splats (points as flat discs: the method of Zhang and Pajarola 2006), raycast "
     "(rays through the field, slow: to check the others) or hybrid (triangles where the volume's cells are "
     "larger than 3 pixels, points elsewhere: also of 2008); files of points: points",
     .group = PICTURE, .standard = "exact", CHOICE(method, method_names)},
    {"reconstruction", NULL, "NAME",
     "how pullpush fills in: refined (second-order discs; points that have colours: as gaussian), box or "
     "gaussian (equal or Gaussian weights in ellipses; Marroquim 2008); how splats does: groups (deferred "
     "blending of groups of discs that do not overlap)",
     .group = PICTURE, .standard = "refined, or groups", CHOICE(reconstruction, reconstructions)},
    {"groups", NULL, "N",
     "most groups of splats; 64: as many as it takes so that no discs of a group overlap", .group = PICTURE,
     .standard = "8, with --transparency 4", INT(groups, 1, ISO_GROUPS_MOST)},
    {"group-overlap", NULL, "C",
     "discs of splats conflict when their distance is below C times the sum of their radii", .group = PICTURE,
     .standard = "1", REAL(group_overlap, 0.01, 1)},
    {"group-bins", NULL, "N",
     "bins of depth in which splats are compared (eq. 6 of the paper) instead of by their own depths",
     .group = PICTURE, INT(group_bins, 1, 1 << 20)},
    {"group-opposite", NULL, NULL,
     "discs of splats that face opposite ways may share a group: fewer groups, but the sides of thin things "
     "then hide each other",
     .group = PICTURE, FLAG(group_opposite)},
    {"point-scaling", NULL, "NAME",
     "width of points: exact (by depth) or attenuated (by distance, as OpenGL 1.4 did it; needs OpenGL)",
     .group = PICTURE, .standard = "exact", CHOICE(scaling, scalings)},
    {"strips", NULL, NULL,
     "draw the mesh as triangle strips; --json tells how many indices they save (needs OpenGL)",
     .group = PICTURE, FLAG(strips)},
    {"resolution", NULL, "WxH", "size of the picture in pixels", .group = PICTURE, .standard = "1024x1024",
     CALL(apply_resolution)},
    {"samples", NULL, "N", "samples a pixel: 1, 4, 9, ... 64", .group = PICTURE, .standard = "1",
     CALL(apply_samples)},
    {"background", "background-color", "COLOR|none",
     "colour of the background, RRGGBB or a name of CSS; none is transparent", .group = PICTURE,
     .standard = "FFFFFF", CALL(apply_background)},
    {"no-background", NULL, NULL, "the same as --background none", .group = PICTURE, FLAG(transparent)},
    {"scale-bar", NULL, NULL,
     "draw a bar of a round length, about a fifth of the picture's width, with its length in mm; needs "
     "--orthographic or --mm-per-pixel",
     .group = PICTURE, FLAG(scale_bar)},
    {"orientation-marker", NULL, NULL,
     "draw the world's axes in a corner: L R A P H F (left, right, anterior, posterior, head, foot) when the "
     "file "
     "says where the patient is, else x y z",
     .group = PICTURE, FLAG(orientation_marker)},
    {"turntable", NULL, "N",
     "N pictures around the surface with one fixed framing: OUT_000.png, OUT_001.png, ...", .group = PICTURE,
     INT(turntable, 1, 100000)},

    {"camera", "camera-preset", "NAME", "side to look from: front, back, left, right, top, bottom, iso",
     .group = CAMERA, .standard = "front", CHOICE(direction, directions)},
    {"up", NULL, "AXIS", "world axis that is up: +x -x +y -y +z -z", .group = CAMERA, .standard = "+z",
     CALL(apply_up)},
    {"azimuth", "camera-azimuth-angle camera-azimuth", "DEGREES", "then turn the camera to the right",
     .group = CAMERA, REAL(azimuth, -1e6, 1e6)},
    {"elevation", "camera-elevation-angle camera-elevation", "DEGREES", "and upwards", .group = CAMERA,
     REAL(elevation, -1e6, 1e6)},
    {"zoom", "camera-zoom-factor", "FACTOR", "enlarge", .group = CAMERA, .standard = "1",
     REAL(zoom, 1e-6, 1e6)},
    {"orthographic", "camera-orthographic", NULL, "parallel projection", .group = CAMERA, FLAG(orthographic)},
    {"mm-per-pixel", NULL, "MM",
     "scale of the picture: a parallel projection (as --orthographic) in which a pixel is this many mm wide",
     .group = CAMERA, REAL(mm_per_pixel, 1e-9, 1e9)},
    {"fit", NULL, "NAME",
     "what fills the picture: box (the box around the surface along the world's axes) or tight (the surface "
     "as it is seen); with --mm-per-pixel, which sets the scale, what is in the middle of the picture",
     .group = CAMERA, .standard = "box", CHOICE(fit, fits)},
    {"margin", NULL, "PART", "part of the picture left free on each side, as 0.1 or 10%", .group = CAMERA,
     .standard = "4%", CALL(apply_margin)},
    {"view-angle", "camera-view-angle", "DEGREES", "full vertical angle of the perspective", .group = CAMERA,
     .standard = "30", REAL(view_angle, 0.01, 179)},
    {"camera-position", NULL, "X,Y,Z", "where the eye is, in mm; nothing is fitted then", .group = CAMERA,
     REALS(position, 3)},
    {"camera-focal-point", NULL, "X,Y,Z", "what it looks at, in mm", .group = CAMERA,
     .standard = "centre of the surface", REALS(focal_point, 3)},
    {"camera-view-up", "view-up", "X,Y,Z", "which direction is up in the picture", .group = CAMERA,
     REALS(view_up, 3)},

    {"output", "o", "NAME",
     "the picture: a .png, - for stdout; {model} is the input's name, {n:3} a number with three "
     "digits",
     .group = OUTPUT, .standard = "{model}.png", TEXT(output), UNRECORDED},
    {"points", NULL, "FILE.ply", "write the points: x y z nx ny nz radius, in mm (isorender reads them back)",
     .group = OUTPUT, TEXT(points), UNRECORDED},
    {"mesh", NULL, "FILE", "write the Marching Cubes mesh: .ply, .stl or .obj, in mm", .group = OUTPUT,
     TEXT(mesh), UNRECORDED},
    {"aov", NULL, "FILE.exr",
     "write depth Z (mm along the view), normal N.X N.Y N.Z (world, out of the solid) and coverage A of "
     "every pixel "
     "as OpenEXR floats: means over its covered samples; with several surfaces, lines, glyphs or meshes also "
     "id.surface, id.element (glyph, line or triangle) and id.segment (of the line) of the nearest sample as "
     "integers: from 1, 0 where there is none",
     .group = OUTPUT, TEXT(aov), UNRECORDED},
    {"no-image", "no-render", NULL, "make no picture", .group = OUTPUT, FLAG(no_image), UNRECORDED},
    {"info", NULL, NULL, "no picture: header, matrix, value range, histogram, suggested isovalues, memory",
     .group = OUTPUT, FLAG(info), UNRECORDED},
    {"json", NULL, "FILE", "one object with what was read, made and measured, to stdout without a FILE",
     .group = OUTPUT, CALL(iso_settings_apply_json),
     .flags = ISO_OPTION_VALUE_OPTIONAL | ISO_OPTION_UNRECORDED},

    {"backend", "rendering-backend", "NAME",
     "cpu, egl or osmesa (OpenGL without a window: points, pullpush, opaque splats, mesh, lines and glyphs); "
     "auto is a GPU "
     "where EGL finds "
     "one, else cpu; but what needs the cpu is drawn by it",
     .group = RUNNING, .standard = "auto", TEXT(backend), UNRECORDED},
    {"list-backends", "list-rendering-backends", NULL, "say what can render here", .group = RUNNING,
     CALL(apply_list_backends), UNRECORDED},
    {"progress", "loading-progress", NULL, "tell how far it is", .group = RUNNING, FLAG(progress),
     UNRECORDED},
    {"verbose", NULL, "LEVEL", "say more: timings and counts (quiet, error, warning, info, debug)",
     .group = RUNNING, CALL(apply_verbose), .flags = ISO_OPTION_VALUE_OPTIONAL | ISO_OPTION_UNRECORDED},
    {"threads", NULL, "N", "threads to use; what comes out does not depend on it", .group = RUNNING,
     .standard = "one a processor", INT(common.threads, 1, 1024), UNRECORDED},
#include "apps/common/running_options.inc"
};

static const char *const inputs_text[] = {
    ".vti, legacy .vtk, .nrrd .nhdr, .mha .mhd, .nii .nii.gz .hdr, "
    ".vdb, a DICOM folder or file, raw data with --raw,",
    "a .ply of points as --points writes it, scene:NAME[:SIZE], and - "
    "for stdin (the content tells the format).",
    "A .tck, .trk, .swc, .vtp, .pdb, .xyz, .csv or .stl is drawn as --lines, "
    "--glyphs and --surface draw it.",
    "Without OUT the picture is IN's name with .png, in the current "
    "folder. World axes are LPS: front looks along +y.",
    NULL};

static const char *const exit_text[] = {"0  done",
                                        "2  wrong usage",
                                        "3  the input cannot be read: missing, truncated, not a volume",
                                        "4  no usable backend",
                                        "5  over the memory limit, or out of memory",
                                        "6  the surface is empty, or nothing of it is in view",
                                        "7  an output could not be written",
                                        "After a failure no output of that input is left behind.",
                                        NULL};

static const char *const example_text[] = {
    "isorender ct.nii.gz bone.png --isovalue 300 --samples 4",
    "isorender dicom/ --camera iso --method raycast",
    "isorender brain.nrrd --isovalue 40 --turntable 90 -o frame_{n:3}.png",
    "isorender --output '{model}.png' *.vti --json='{model}.json'",
    "isorender sphere.vdb --points sphere.ply --no-image",
    "isorender t1.nii.gz brain.png --isovalue 60 --opacity 0.3 --lines tracts.tck --line-color direction",
    "isorender protein.pdb --samples 4",
    NULL};

static const iso_section sections[] = {
    {"Inputs", inputs_text}, {"Exit status", exit_text}, {"Examples", example_text}};

const iso_program *isorender_program(void) {
    static const iso_program program = {.name = "isorender",
                                        .version = ISO_VERSION,
                                        .summary =
                                            "a correct picture of a volume's isosurface, in one command",
                                        .usage = usage,
                                        .groups = groups,
                                        .options = options,
                                        .option_count = sizeof options / sizeof *options,
                                        .sections = sections,
                                        .section_count = sizeof sections / sizeof *sections,
                                        .seen = iso_settings_record_option};
    for (int i = 0; i < ISO_REFRACTIONS; i++) refractions[i] = iso_refraction_name((iso_refraction)i);
    for (int i = 0; i < METHODS; i++) method_names[i] = iso_method_name(methods[i]);
    return &program;
}

/* ---- checks between options ---- */

/* The kind of object that a file holds by its name; false: it is a volume, or only its content tells. */
static bool is_object_name(const char *name, isorender_object_kind *kind) {
    static const struct {
        const char *ending;
        isorender_object_kind kind;
    } endings[] = {{".tck", ISORENDER_LINES},  {".trk", ISORENDER_LINES},  {".swc", ISORENDER_LINES},
                   {".vtp", ISORENDER_LINES},  {".pdb", ISORENDER_GLYPHS}, {".xyz", ISORENDER_GLYPHS},
                   {".csv", ISORENDER_GLYPHS}, {".stl", ISORENDER_MESH}};
    for (size_t i = 0; i < sizeof endings / sizeof *endings; i++)
        if (iso_text_ends_with(name, endings[i].ending)) {
            *kind = endings[i].kind;
            return true;
        }
    return false;
}

/* Takes an input that is an object: it becomes the first one. */
static iso_status take_object(isorender_settings *settings, iso_error *error) {
    isorender_object_options *objects = &settings->object_options;
    isorender_object_kind kind;
    if (settings->no_input || settings->scene || !is_object_name(settings->inputs[0], &kind)) return ISO_OK;
    if (settings->input_count > 1)
        return iso_fail(error, ISO_ERR_USAGE,
                        "%s: lines, glyphs and meshes are drawn one file at a time, or together with "
                        "--lines, --glyphs and --surface",
                        settings->inputs[0]);
    ISO_TRY(add_object(settings, kind, settings->inputs[0], error));
    for (int i = objects->count - 1; i > 0; i--) {
        objects->paths[i] = objects->paths[i - 1];
        objects->kinds[i] = objects->kinds[i - 1];
    }
    objects->paths[0] = settings->inputs[0];
    objects->kinds[0] = kind;
    settings->no_input = 1;
    return ISO_OK;
}

/* Whether the only operand is the name of a picture of --lines, --glyphs, --surface and --volume, which need
 * no input. */
static bool is_only_picture(const isorender_settings *settings, const iso_operands *operands) {
    return (settings->object_options.count || settings->volume_options.count) && !settings->scene &&
           (operands->count == 0 ||
            (operands->count == 1 && !settings->output && iso_text_ends_with(operands->values[0], ".png")));
}

/* Takes the output from the operands: the last of them, when it is one more than there are inputs. */
static iso_status take_output(isorender_settings *settings, const iso_operands *operands, int inputs,
                              int *count, iso_error *error) {
    if (settings->output || *count != inputs + 1) return ISO_OK;
    settings->output = operands->values[--*count];
    if (strcmp(settings->output, "-") != 0 && !iso_text_ends_with(settings->output, ".png"))
        return iso_fail(error, ISO_ERR_USAGE,
                        "%s: a picture's name must end in .png (several inputs need --output TEMPLATE)",
                        settings->output);
    return ISO_OK;
}

static iso_status take_operands(isorender_settings *settings, const iso_operands *operands,
                                iso_error *error) {
    int count = operands->count;
    settings->no_input = is_only_picture(settings, operands);
    ISO_TRY(take_output(settings, operands, settings->scene || settings->no_input ? 0 : 1, &count, error));
    if (count == 0 && !settings->scene && !settings->no_input)
        return iso_fail(error, ISO_ERR_USAGE, "no input (see --help)");
    if (settings->scene && count > 0)
        return iso_fail(error, ISO_ERR_USAGE, "%s: --scene takes no other input", operands->values[0]);
    if (count > 1 && !settings->output && !settings->info && !settings->no_image)
        return iso_fail(error, ISO_ERR_USAGE, "%d inputs need --output TEMPLATE, such as '{model}.png'",
                        count);
    const char *const *files =
        settings->object_options.count ? settings->object_options.paths : settings->volume_options.paths;
    settings->inputs = settings->no_input ? files : operands->values;
    settings->input_count = settings->scene || settings->no_input ? 1 : count;
    return take_object(settings, error);
}

static bool is_vector_given(const double v[3]) {
    return !isnan(v[0]);
}

static iso_status check_framing(const isorender_settings *settings, iso_error *error) {
    const bool tight = settings->fit == ISORENDER_FIT_TIGHT, margin = !isnan(settings->margin);
    const char *option = tight ? "--fit tight" : "--margin";
    if (!tight && !margin) return ISO_OK;
    if (is_vector_given(settings->position))
        return iso_fail(error, ISO_ERR_USAGE, "%s frames the surface, which --camera-position does not",
                        option);
    if (tight && is_vector_given(settings->focal_point))
        return iso_fail(error, ISO_ERR_USAGE, "--fit tight chooses the focal point: give one or the other");
    return ISO_OK;
}

/* --mm-per-pixel makes the projection parallel. */
static iso_status check_camera(isorender_settings *settings, iso_error *error) {
    ISO_TRY(check_framing(settings, error));
    if (settings->mm_per_pixel > 0) {
        settings->orthographic = 1;
        if (settings->zoom != 1 || !isnan(settings->margin))
            return iso_fail(error, ISO_ERR_USAGE, "--mm-per-pixel and %s both set the scale",
                            settings->zoom != 1 ? "--zoom" : "--margin");
    }
    if (settings->scale_bar && !settings->orthographic)
        return iso_fail(
            error, ISO_ERR_USAGE,
            "--scale-bar needs --orthographic or --mm-per-pixel: in perspective what is near is larger "
            "than what is far");
    return ISO_OK;
}

static iso_status check_aov(const isorender_settings *settings, iso_error *error) {
    if (!settings->aov) return ISO_OK;
    if (!iso_text_ends_with(settings->aov, ".exr"))
        return iso_fail(error, ISO_ERR_USAGE, "%s: --aov writes OpenEXR files: a name must end in .exr",
                        settings->aov);
    if (settings->info)
        return iso_fail(error, ISO_ERR_USAGE, "--info renders nothing that --aov could write");
    return ISO_OK;
}

static iso_status check_outputs(const isorender_settings *settings, iso_error *error) {
    bool image = !settings->no_image && !settings->info;
    bool to_stdout = image && settings->output && strcmp(settings->output, "-") == 0;
    if (settings->output && !to_stdout && image && !iso_text_ends_with(settings->output, ".png"))
        return iso_fail(error, ISO_ERR_USAGE, "%s: a picture's name must end in .png", settings->output);
    if (to_stdout && settings->common.json && !settings->common.json_path)
        return iso_fail(error, ISO_ERR_USAGE, "the picture and --json cannot both go to standard output");
    if (to_stdout && settings->turntable)
        return iso_fail(error, ISO_ERR_USAGE, "a turntable cannot go to standard output");
    if (settings->points && !iso_text_ends_with(settings->points, ".ply"))
        return iso_fail(error, ISO_ERR_USAGE, "%s: points are written as .ply", settings->points);
    if (settings->mesh && !iso_text_ends_with(settings->mesh, ".ply") &&
        !iso_text_ends_with(settings->mesh, ".stl") && !iso_text_ends_with(settings->mesh, ".obj"))
        return iso_fail(error, ISO_ERR_USAGE, "%s: a mesh is written as .ply, .stl or .obj", settings->mesh);
    ISO_TRY(check_aov(settings, error));
    if (settings->no_image && !settings->points && !settings->mesh && !settings->aov &&
        !settings->common.json && !settings->info)
        return iso_fail(error, ISO_ERR_USAGE, "--no-image leaves nothing to do");
    if (settings->input_count > 1 && settings->common.json && !settings->common.json_path)
        return iso_fail(error, ISO_ERR_USAGE,
                        "--json of several inputs needs a template: --json='{model}.json'");
    return ISO_OK;
}

static iso_status check_surfaces(const isorender_settings *settings, iso_error *error) {
    if (settings->isovalue_auto && settings->isovalue_count)
        return iso_fail(error, ISO_ERR_USAGE, "--isovalue auto cannot be combined with other isovalues");
    int surfaces = settings->isovalue_count ? settings->isovalue_count : 1;
    if (surfaces + settings->volume_options.count > ISORENDER_SURFACES)
        return iso_fail(error, ISO_ERR_USAGE, "more than %d surfaces", ISORENDER_SURFACES);
    if (settings->color_count > surfaces)
        return iso_fail(error, ISO_ERR_USAGE, "%d colours for %d isovalue%s", settings->color_count, surfaces,
                        surfaces > 1 ? "s" : "");
    if (surfaces > 1 && (settings->points || settings->mesh))
        return iso_fail(error, ISO_ERR_USAGE, "--points and --mesh write one surface: give one isovalue");
    const iso_primitive primitive = (iso_primitive)settings->primitive;
    if (settings->method == ISO_METHOD_HYBRID && primitive != ISO_PRIMITIVE_AUTO &&
        primitive != ISO_PRIMITIVE_EDGE)
        return iso_fail(error, ISO_ERR_USAGE,
                        "--method hybrid joins edge points to triangles: --primitive %s lies elsewhere",
                        iso_primitive_name(primitive));
    if (settings->closed && primitive != ISO_PRIMITIVE_AUTO && primitive != ISO_PRIMITIVE_EDGE)
        return iso_fail(error, ISO_ERR_USAGE, "--closed makes edge points: --primitive %s has no caps",
                        iso_primitive_name(primitive));
    for (int i = 0; i < surfaces; i++)
        for (int j = 0; j < i; j++)
            if (settings->isovalues[i] == settings->isovalues[j])
                return iso_fail(error, ISO_ERR_USAGE, "isovalue %g is given twice", settings->isovalues[i]);
    return ISO_OK;
}

bool isorender_is_translucent(const isorender_settings *settings) {
    for (int i = 0; i < settings->opacity_count; i++)
        if (settings->opacities[i] < 1) return true;
    for (int i = 0; i < settings->volume_options.count; i++)
        if (settings->volumes[i].opacity < 1) return true;
    return false;
}

const char *isorender_object_opacity_option(const isorender_settings *settings) {
    static const char *const names[ISORENDER_OBJECT_KINDS] = {[ISORENDER_LINES] = "--line-opacity",
                                                              [ISORENDER_GLYPHS] = "--glyph-opacity",
                                                              [ISORENDER_MESH] = "--surface-opacity"};
    for (int i = 0; i < settings->object_options.count; i++)
        if (settings->objects[i].opacity < 1) return names[settings->objects[i].kind];
    return NULL;
}

/* Options that are for translucent surfaces and, but for --absorption, for translucent objects. */
static iso_status check_translucent(const isorender_settings *settings, iso_error *error) {
    const bool absorbs = settings->absorption_length > 0;
    const char *needs = absorbs                                                ? "--absorption"
                        : settings->layers                                     ? "--layers"
                        : settings->opacity_mode != ISORENDER_OPACITY_BY_ANGLE ? "--opacity-mode"
                                                                               : NULL;
    if (!needs || isorender_is_translucent(settings)) return ISO_OK;
    if (!absorbs && isorender_object_opacity_option(settings)) return ISO_OK;
    return iso_fail(error, ISO_ERR_USAGE, "%s is for translucent surfaces: it needs an opacity below 1",
                    needs);
}

static iso_status check_opacity(const isorender_settings *settings, iso_error *error) {
    const int surfaces = settings->isovalue_count ? settings->isovalue_count : 1;
    ISO_TRY(check_translucent(settings, error));
    if (settings->absorption_length > 0 && settings->layers)
        return iso_fail(error, ISO_ERR_USAGE,
                        "--layers leaves out where rays leave the solid, which --absorption must know");
    if (!settings->opacity_count && !isorender_is_translucent(settings)) return ISO_OK;
    if (settings->opacity_count > surfaces)
        return iso_fail(error, ISO_ERR_USAGE, "%d opacities for %d isovalue%s", settings->opacity_count,
                        surfaces, surfaces > 1 ? "s" : "");
    if (settings->method != ISORENDER_METHOD_UNCHOSEN && !iso_method_has_layers((iso_method)settings->method))
        return iso_fail(error, ISO_ERR_USAGE,
                        "--method %s draws no translucent surfaces: exact, raycast and splats do",
                        iso_method_name((iso_method)settings->method));
    if (settings->mesh)
        return iso_fail(error, ISO_ERR_USAGE, "--mesh writes no opacities: --opacity is for pictures");
    bool seen = settings->absorption_length > 0 || settings->volume_options.count || !settings->opacity_count;
    for (int i = 0; i < settings->opacity_count; i++) seen |= settings->opacities[i] > 0;
    return seen ? ISO_OK : iso_fail(error, ISO_ERR_EMPTY, "all opacities are 0: nothing would be seen");
}

/* An option that has no meaning for glass; NULL: none is given. */
static const char *option_unfit_for_glass(const isorender_settings *settings) {
    return settings->isovalue_count > 1     ? "several isovalues"
           : settings->volume_options.count ? "--volume"
           : settings->opacity_count        ? "--opacity"
           : settings->color_count          ? "--color"
           : settings->mesh                 ? "--mesh"
                                            : NULL;
}

/* An option that is for glass only; NULL: none is given. */
static const char *option_of_glass(const isorender_settings *settings) {
    return settings->refraction != ISO_REFRACTION_TRACED ? "--refraction"
           : settings->environment                       ? "--environment"
           : settings->attenuation_colored               ? "--attenuation-color"
           : settings->attenuation_distance > 0          ? "--attenuation-distance"
                                                         : NULL;
}

static iso_status check_glass(const isorender_settings *settings, iso_error *error) {
    const char *needs = option_of_glass(settings), *unfit = option_unfit_for_glass(settings);
    if (!(settings->ior > 0) && needs)
        return iso_fail(error, ISO_ERR_USAGE, "%s is for glass: it needs --ior", needs);
    if (!(settings->ior > 0)) return ISO_OK;
    if (unfit)
        return iso_fail(error, ISO_ERR_USAGE,
                        "--ior draws one surface, as glass: it cannot be combined with %s", unfit);
    if (settings->method != ISORENDER_METHOD_UNCHOSEN && !iso_method_has_glass((iso_method)settings->method))
        return iso_fail(error, ISO_ERR_USAGE, "--method %s draws no glass: exact and raycast do",
                        iso_method_name((iso_method)settings->method));
    if (settings->attenuation_colored != (settings->attenuation_distance > 0))
        return iso_fail(error, ISO_ERR_USAGE,
                        "--attenuation-color and --attenuation-distance need each other");
    return ISO_OK;
}

static iso_status check_objects(isorender_settings *settings, iso_error *error) {
    ISO_TRY(isorender_objects_resolve(&settings->object_options, settings->objects, error));
    if (!settings->object_options.count) return ISO_OK;
    if (settings->ior > 0)
        return iso_fail(error, ISO_ERR_USAGE,
                        "--ior draws glass alone: no --lines, --glyphs and --surface beside it");
    const char *opacity = isorender_object_opacity_option(settings);
    if (opacity && (strcmp(settings->backend, "egl") == 0 || strcmp(settings->backend, "osmesa") == 0))
        return iso_fail(error, ISO_ERR_USAGE, "--backend %s draws no translucent objects: %s needs the cpu",
                        settings->backend, opacity);
    if (opacity && settings->method != ISORENDER_METHOD_UNCHOSEN && settings->method != ISO_METHOD_EXACT)
        return iso_fail(error, ISO_ERR_USAGE,
                        "--method %s draws opaque lines, glyphs and meshes only: %s needs exact",
                        iso_method_name((iso_method)settings->method), opacity);
    return ISO_OK;
}

iso_status isorender_settings_parse(int argc, char *const *argv, isorender_settings *settings,
                                    iso_operands *operands, iso_error *error) {
    *settings = (isorender_settings){.method = ISORENDER_METHOD_UNCHOSEN,
                                     .reconstruction = ISORENDER_RECONSTRUCTION_UNCHOSEN,
                                     .backend = "auto",
                                     .width = 1024,
                                     .height = 1024,
                                     .samples = 1,
                                     .background = {255, 255, 255},
                                     .refraction = ISO_REFRACTION_TRACED,
                                     .up = {0, 0, 1},
                                     .zoom = 1,
                                     .line_min_pixels = 1,
                                     .margin = NAN,
                                     .view_angle = 30};
    for (int i = 0; i < 3; i++) settings->position[i] = settings->focal_point[i] = settings->view_up[i] = NAN;
    ISO_TRY(iso_options_parse(isorender_program(), argc, argv, settings, operands, error));
    if (settings->method != ISORENDER_METHOD_UNCHOSEN) settings->method = (int)methods[settings->method];
    if (settings->common.action) return ISO_OK;
    ISO_TRY(iso_input_check(&settings->common.input, error));
    ISO_TRY(isorender_volumes_resolve(&settings->volume_options, settings->volumes, error));
    ISO_TRY(check_camera(settings, error));
    ISO_TRY(isorender_splats_check(settings, error));
    ISO_TRY(take_operands(settings, operands, error));
    ISO_TRY(isorender_backend_check(settings, error));
    ISO_TRY(check_outputs(settings, error));
    ISO_TRY(check_surfaces(settings, error));
    ISO_TRY(check_glass(settings, error));
    ISO_TRY(check_objects(settings, error));
    return check_opacity(settings, error);
}
