/* The command line of isorender: the table of options. Options that F3D has, too, have F3D's names. */
#include <math.h>
#include <string.h>

#include "apps/common/looks.h"
#include "apps/isorender/annotations.h"
#include "apps/isorender/channels.h"
#include "apps/isorender/colorings.h"
#include "apps/isorender/cuts.h"
#include "apps/isorender/looks.h"
#include "apps/isorender/option_checks.h"
#include "base/file_identity.h"
#include "io/key_file.h"
#include "isopoint.h"

#ifndef ISO_VERSION
#error "ISO_VERSION comes from CMake"
#endif

enum group {
    INPUT,
    SURFACE,
    CUTS,
    COLORS,
    LABELS,
    POINTS,
    OBJECTS,
    PICTURE,
    CAMERA,
    OUTPUT,
    RUNNING,
    PAPERS
};
static const char *const groups[] = {"Input",
                                     "Surface",
                                     "Cuts and slices",
                                     "Colors by data, and their bars",
                                     "Labels",
                                     "Points",
                                     "Lines, glyphs and meshes",
                                     "Picture",
                                     "Camera",
                                     "Output",
                                     "Running",
                                     "Papers: variants, to compare with",
                                     NULL};

static const char *const usage[] = {"[options] IN [OUT.png | OUT.html]",
                                    "[options] --output TEMPLATE IN ...",
                                    "[options] --scene NAME[:SIZE] [OUT.png]",
                                    "[options] --lines FILE [--glyphs FILE ...] [OUT.png]",
                                    "merge PART.isokeys ... -o OUT.png",
                                    "sheet [options] IN ... -o OUT.html",
                                    NULL};

/* The reconstructions of a method have an option of their own. The names come from the table of renderers. */
static const char *method_names[ISO_METHOD_FAMILIES_MOST + 2]; /* filled by list_methods, and */
static char method_help[1024];
static int method_gaussians; /* files of 3-D Gaussians have a renderer that no isosurface has */
static const char *const reconstructions[] = {"curved", "box",  "gaussian", "flat", "onepass",
                                              "ewa",    "mean", "groups",   NULL};
static const char *const transparencies[] = {"sorted", "groups", "nearest", NULL};
static const char *const selections[] = {"auto", "visible", "all", NULL};
static const char *const group_radii[] = {"coverage", "root", "copies", NULL};
/* iso_direction, then its names for patients: camera.c. */
static const char *const directions[] = {"front", "back",     "left",      "right",    "top",      "bottom",
                                         "iso",   "anterior", "posterior", "superior", "inferior", NULL};
static const char *const lightings[] = {"phong", "edl", NULL};
static const char *const scalings[] = {"exact", "attenuated", NULL};
static const char *const units[] = {"auto", "none", "nm", "um",       "mm",
                                    "cm",   "m",    "km", "angstrom", NULL}; /* iso_length_unit */
static const char *const fits[] = {"box", "tight", NULL};
static const char *const opacity_modes[] = {"angle", "constant", NULL};
static const char *const normals_names[] = {"file", "auto", NULL};
static const char *refractions[ISO_REFRACTIONS + 1]; /* filled by isorender_program */
static const char *const primitives[] = {"auto", "edge", "foot", "foot-iterated", NULL};

/* ---- values that are not plain numbers ---- */

static iso_status add_isovalue(void *target, const char *value, iso_error *error) {
    isorender_settings *settings = target;
    isorender_isovalue isovalue;
    if (!isorender_parse_isovalue(value, &isovalue))
        return iso_fail(error, ISO_ERR_USAGE, "'%s' is neither a number, such as 40 or 3sigma, nor 'auto'",
                        value);
    if (settings->isovalue_count == ISORENDER_SURFACES)
        return iso_fail(error, ISO_ERR_USAGE, "more than %d isovalues", ISORENDER_SURFACES);
    settings->isovalue_sigmas[settings->isovalue_count] = isovalue.sigma;
    settings->isovalues[settings->isovalue_count++] = isovalue.value;
    return ISO_OK;
}

static iso_status apply_isovalue(void *target, const char *value, iso_error *error) {
    isorender_settings *settings = target;
    if (strcmp(value, "auto") != 0) return iso_parse_items(value, add_isovalue, settings, error);
    settings->isovalue_auto = 1;
    return ISO_OK;
}

static bool parse_color(const char *value, iso_rgb *color) {
    uint8_t rgb[3];
    if (!iso_parse_color(value, rgb)) return false;
    *color = (iso_rgb){rgb[0], rgb[1], rgb[2]};
    return true;
}

static iso_status add_color(void *target, const char *value, iso_error *error) {
    isorender_settings *settings = target;
    if (settings->color_count == ISORENDER_SURFACES)
        return iso_fail(error, ISO_ERR_USAGE, "more than %d colours", ISORENDER_SURFACES);
    if (!parse_color(value, &settings->colors[settings->color_count]))
        return iso_fail_color(value, "", error);
    settings->color_count++;
    return ISO_OK;
}

static iso_status apply_color(void *target, const char *value, iso_error *error) {
    return iso_parse_items(value, add_color, target, error);
}

static iso_status apply_radius(void *target, const char *value, iso_error *error) {
    isorender_settings *settings = target;
    double radius = -1;
    const bool given = strcmp(value, "auto") != 0;
    if (given && !(iso_parse_real(value, &radius) && radius > 0 && radius <= 1e12))
        return iso_fail(error, ISO_ERR_USAGE, "'%s' is neither a radius in mm nor 'auto'", value);
    settings->radius = radius;
    return ISO_OK;
}

static iso_status add_opacity(void *target, const char *value, iso_error *error) {
    isorender_settings *settings = target;
    double opacity;
    ISO_TRY(isorender_opacity(value, &opacity, error));
    if (settings->opacity_count == ISORENDER_SURFACES)
        return iso_fail(error, ISO_ERR_USAGE, "more than %d opacities", ISORENDER_SURFACES);
    settings->opacities[settings->opacity_count++] = opacity;
    return ISO_OK;
}

static iso_status apply_opacity(void *target, const char *value, iso_error *error) {
    return iso_parse_items(value, add_opacity, target, error);
}

static iso_status apply_lines(void *target, const char *value, iso_error *error) {
    return isorender_settings_add_object(target, ISO_OBJECT_LINES, value, error);
}

static iso_status apply_glyphs(void *target, const char *value, iso_error *error) {
    return isorender_settings_add_object(target, ISO_OBJECT_GLYPHS, value, error);
}

static iso_status apply_surface(void *target, const char *value, iso_error *error) {
    return isorender_settings_add_object(target, ISO_OBJECT_MESH, value, error);
}

static iso_status apply_volume(void *target, const char *value, iso_error *error) {
    isorender_volume_options *volumes = &((isorender_settings *)target)->volume_options;
    if (!*value) return iso_fail(error, ISO_ERR_USAGE, "the value is empty");
    if (volumes->count == ISORENDER_VOLUMES)
        return iso_fail(error, ISO_ERR_USAGE, "more than %d volumes", ISORENDER_VOLUMES);
    volumes->paths[volumes->count++] = value;
    return ISO_OK;
}

static iso_status apply_part(void *target, const char *value, iso_error *error) {
    isorender_settings *settings = target;
    char number[16];
    const size_t length = strcspn(value, "/");
    int part = 0, parts = 0;
    snprintf(number, sizeof number, "%.*s", length < 15 ? (int)length : 15, value);
    if (!value[length] || !iso_parse_int(number, &part) || !iso_parse_int(value + length + 1, &parts) ||
        part < 1 || part > parts || parts > ISO_KEY_PARTS)
        return iso_fail(error, ISO_ERR_USAGE, "'%s' is not K/N, with K from 1 to N and N up to %d", value,
                        ISO_KEY_PARTS);
    settings->part = part;
    settings->parts = parts;
    return ISO_OK;
}

static iso_status apply_occlusion(void *target, const char *value, iso_error *error) {
    isorender_settings *settings = target;
    settings->occlusion = NAN;
    if (!value || (iso_parse_real(value, &settings->occlusion) && settings->occlusion > 0 &&
                   settings->occlusion <= 1e12))
        return ISO_OK;
    return iso_fail(error, ISO_ERR_USAGE, "'%s' is not a range in mm, above 0", value);
}

static iso_status apply_outline(void *target, const char *value, iso_error *error) {
    isorender_settings *settings = target;
    settings->outline = 1;
    if (!value || (iso_parse_real(value, &settings->outline) && settings->outline > 0 &&
                   settings->outline <= ISO_OUTLINE_MOST))
        return ISO_OK;
    return iso_fail(error, ISO_ERR_USAGE, "'%s' is not a width in pixels, above 0 and up to %g", value,
                    ISO_OUTLINE_MOST);
}

static iso_status apply_background(void *target, const char *value, iso_error *error) {
    isorender_settings *settings = target;
    bool none = strcmp(value, "none") == 0 || strcmp(value, "transparent") == 0;
    if (!none && !parse_color(value, &settings->background))
        return iso_fail_color(value, " nor 'none'", error);
    settings->transparent = none;
    settings->background_given = 1;
    return ISO_OK;
}

static iso_status apply_attenuation_color(void *target, const char *value, iso_error *error) {
    isorender_settings *settings = target;
    settings->attenuation_colored = 1;
    return parse_color(value, &settings->attenuation_color) ? ISO_OK : iso_fail_color(value, "", error);
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
    double margin;
    if (!iso_parse_fraction(value, &margin) || !(margin >= 0 && margin <= 0.45))
        return iso_fail(error, ISO_ERR_USAGE,
                        "'%s' is not a part of the picture from 0 to 0.45, or 0%% to 45%%", value);
    settings->margin = margin;
    return ISO_OK;
}

static iso_status apply_up(void *target, const char *value, iso_error *error) {
    isorender_settings *settings = target;
    const char *axis = value + (*value == '+' || *value == '-');
    double sign = *value == '-' ? -1 : 1;
    const char letter = (char)(*axis | ('a' - 'A')); /* in lower case */
    if (strlen(axis) != 1 || letter < 'x' || letter > 'z')
        return iso_fail(error, ISO_ERR_USAGE, "'%s' is not one of +x -x +y -y +z -z", value);
    settings->up =
        iso_vec3_make(letter == 'x' ? sign : 0, letter == 'y' ? sign : 0, letter == 'z' ? sign : 0);
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

static iso_status apply_decimate(void *target, const char *value, iso_error *error) {
    isorender_settings *settings = target;
    double number;
    const bool share = strchr(value, '%') != NULL;
    const bool good = share ? iso_parse_fraction(value, &number) && number > 0 && number < 1
                            : iso_parse_real(value, &number) && number > 0 && number < 1e12;
    if (!good)
        return iso_fail(error, ISO_ERR_USAGE,
                        "'%s' is neither a share of the triangles, such as 10%%, nor mm", value);
    settings->mesh_edits.keep = share ? number : 0;
    settings->mesh_edits.deviation = share ? 0 : number;
    return ISO_OK;
}

static iso_status apply_schema(void *target, const char *value, iso_error *error) {
    (void)value, (void)error;
    ((isorender_settings *)target)->common.action = ISORENDER_ACTION_SCHEMA;
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
    {"channel", NULL, "N|NAME",
     "a channel (component) of the file, by its number from 0 or its name; several, separated by commas, are "
     "surfaces in one picture, with the names and colours that OME-TIFF, OME-Zarr and Imaris state (--info "
     "lists them); --isovalue, --color and --opacity are then lists by channel, of which the last isovalue "
     "and the last opacity repeat",
     .group = INPUT, CALL(isorender_apply_channel), .flags = ISO_OPTION_REPEATABLE},
    {"series-of", NULL, "FILES",
     "steps in time instead of one file: a pattern of names in quotes ('t_*.vti'), or one file whose "
     "components are "
     "times; all pictures have one framing, isovalue and range of colours, and are numbered, or a video",
     .group = INPUT, TEXT(series_of)},
    {"scene", NULL, "NAME[:SIZE]",
     "a procedural volume instead of a file: sphere, cylinder, cube, gyroid, torus, ct, "
     "head, organs (labels) (the same as the input scene:NAME[:SIZE])",
     .group = INPUT, TEXT(scene)},

    {"isovalue", "isosurface iso-value", "V",
     "value of the surface, in the file's physical units (of a level set: mm from its surface, above 0 "
     "outside); 3sigma: 3 standard deviations above the mean of all finite voxels, as levels of maps are "
     "stated; several, separated by commas, give several surfaces; auto: 0 for level sets, else Otsu's "
     "threshold of the histogram",
     .group = SURFACE, .standard = "auto", CALL(apply_isovalue), .flags = ISO_OPTION_REPEATABLE},
    {"color", "colour", "COLOR",
     "colour of the surface: RRGGBB in hexadecimal or a name of CSS such as ivory; several, separated by "
     "commas: the second one belongs to the second isovalue, and so on",
     .group = SURFACE, .standard = "E5DCC8", CALL(apply_color), .flags = ISO_OPTION_REPEATABLE},
    {"opacity", NULL, "A",
     "opacity of the surface, 0 (not seen) to 1 (or 100%); several, separated by commas: the second one "
     "belongs to the second isovalue, and so on; the last one repeats; for the methods exact, raycast and "
     "splats (files of points). Points with a column alpha are translucent without it: below 1 it multiplies "
     "theirs, 1 makes them opaque",
     .group = SURFACE, .standard = "1", CALL(apply_opacity), .flags = ISO_OPTION_REPEATABLE},
    {"opacity-mode", NULL, "NAME",
     "angle: the surface is a thin slab, more opaque where it is seen at a slant, so that outlines stand "
     "out; constant: the same at every angle",
     .group = SURFACE, .standard = "angle", CHOICE(opacity_mode, opacity_modes)},
    {"absorption", NULL, "MM",
     "the solid of a translucent surface takes light away: after this many mm 1/e of it is left, the rest "
     "has the surface's colour (with --opacity 0 only the solid is seen, as in an X-ray image)",
     .group = SURFACE, REAL(absorption_length, 1e-6, 1e9)},
    {"layers", NULL, "N",
     "draw only the first N crossings of each translucent surface or file of lines, glyphs or triangles: 1 "
     "is the skin without what lies behind it",
     .group = SURFACE, .standard = "all", INT(layers, 1, 1000000)},
    {"transparency", NULL, "NAME",
     "how splats are seen through: sorted (every layer of the surface, in order), groups (a picture of each "
     "group, and their mean) or nearest (the same behind a smooth nearest layer; both Zhang and Pajarola "
     "2006)",
     .group = SURFACE, .standard = "sorted", CHOICE(transparency, transparencies),
     .hint = "how much is seen through a surface is its --opacity"},
    {"ior", NULL, "N",
     "draw the solid as glass with this index of refraction (1.5: window glass, 1.33: water); for the "
     "methods exact, raycast and splats, and for files of points. With --opacity every surface on the way "
     "takes away this share of the light",
     .group = SURFACE, REAL(ior, 1, 10)},
    {"refraction", NULL, "NAME",
     "how glass bends light: traced (rays are followed through the solid of a volume, with all reflections: "
     "the truth), two-sided (bent where they enter and first leave, and followed where they are totally "
     "reflected), layers (bent once, more for each surface: pretty, but no approximation), single (bent "
     "once, by the first surface), none (only reflection and absorption) or auto (traced; of points "
     "two-sided, layers with --transparency nearest)",
     .group = SURFACE, .standard = "auto", CHOICE(refraction, refractions)},
    {"dispersion", NULL, "ABBE",
     "glass bends blue light more than red: its Abbe number, 60 for crown glass, 30 for flint; smaller "
     "numbers give wider rainbows (each colour is followed by itself: three times the time)",
     .group = SURFACE, .standard = "none", REAL(dispersion, 1, 1e6)},
    {"environment", NULL, "FILE",
     "what glass reflects and refracts: an equirectangular .exr (linear R G B) or .png; it is also the "
     "background unless --background is given",
     .group = SURFACE, .standard = "a studio", TEXT(environment), .flags = ISO_OPTION_READS},
    {"attenuation-color", NULL, "COLOR",
     "colour that white light has after --attenuation-distance in the glass (as in KHR_materials_volume)",
     .group = SURFACE, .standard = "FFFFFF", CALL(apply_attenuation_color)},
    {"attenuation-distance", NULL, "MM", "see --attenuation-color", .group = SURFACE,
     REAL(attenuation_distance, 1e-6, 1e9)},
    {"primitive", NULL, "NAME",
     "which points: auto or edge (the vertices of Marching Cubes), foot (of level sets: the nearest points "
     "to the voxels outside; they miss narrow creases) or foot-iterated (of any volume)",
     .group = POINTS, .standard = "auto", CHOICE(primitive, primitives)},

    {"radius", NULL, "MM",
     "radius of the points of a file; auto: estimated from the "
     "distances to the nearest neighbours, as are those that the file lacks",
     .group = POINTS, .standard = "the file's, or auto", CALL(apply_radius)},
    {"normals", NULL, "NAME",
     "normals of the points of a file: file (those that it lacks are estimated) or auto (all are estimated "
     "from the nearest neighbours)",
     .group = POINTS, .standard = "file", CHOICE(normals, normals_names)},

    {"columns", NULL, "NAMES",
     "what the numbers of a file of points are, if it has no names for them or wrong ones ({rows}): x y z, "
     "nx ny nz, red green blue, radius or any name, separated by commas; - is a number that is not wanted",
     .group = POINTS, .standard = "the file's, or found out", TEXT(columns)},

#define SOLID SURFACE
#include "apps/common/solid_options.inc"
#undef SOLID
    {"closed", NULL, NULL,
     "the solid ends at the volume's border and is capped there, so that meshes are closed; voxels that are "
     "no numbers are outside it",
     .group = SURFACE, FLAG(closed)},
    {"hollow", NULL, "MM",
     "leave only a wall of the solid, so many mm thick, for printing; it is --closed, too", .group = SURFACE,
     REAL(hollow, 1e-3, 1e6)},
    {"drain", NULL, "MM",
     "two holes of so many mm through the wall of --hollow: at the lowest and the highest place of the "
     "hollow",
     .group = SURFACE, REAL(drain, 1e-3, 1e6)},

    {"clip", NULL, "WHERE",
     "cut away " ISO_CUT_FORMS ", in mm, LPS; the normal points to what is cut away, camera: is so far into "
     "the view; ras: takes RAS, as NIfTI files state, keep: cuts the rest, @ only certain surfaces; several "
     "cut one after the other",
     .group = CUTS, CALL(isorender_apply_clip), .flags = ISO_OPTION_REPEATABLE},
    {"cap", NULL, "slice|surface|COLOR|none",
     "close what --clip cuts: slice (it shows the volume; slice:COLORMAP in other colours than gray), "
     "surface (the surface's colour), a colour, or none",
     .group = CUTS, .standard = "none", CALL(isorender_apply_cap)},
    {"slice", NULL, "PLANE",
     "show a slice of the volume, with the outlines of its surfaces: at x=MM (so y, z), x (in the middle; "
     "also sagittal, coronal, axial), X,Y,Z:NX,NY,NZ or camera:MM, in mm, LPS or behind ras: RAS; alone with "
     "--opacity 0",
     .group = CUTS, CALL(isorender_apply_slice), .flags = ISO_OPTION_REPEATABLE},
    {"surface-color-by", NULL, "WHAT",
     "colour isosurfaces, and meshes, by a volume (FILE, FILE:ARRAY or ARRAY, of the input; gray where it "
     "has no values), a mesh's numbers (lh.curv, lh.annot, .func.gii), curvature, distance:FILE (from its "
     "surface, in mm, below 0 inside; distance:FILE:ISOVALUE), depth or normal; @N,.. behind it: only "
     "certain surfaces",
     .group = COLORS, CALL(isorender_apply_surface_color_by),
     .flags = ISO_OPTION_REPEATABLE | ISO_OPTION_READS_PART},
    {"window", NULL, "CENTER,WIDTH|auto",
     "the values that caps and slices show, from black to white; auto: all but the least and the greatest 1 "
     "%",
     .group = CUTS, .standard = "all values", CALL(isorender_apply_window)},

#include "apps/isorender/object_options.inc"

    {"instances", NULL, "FILE",
     "draw the model once for each point of a .csv (with a row of names) or .ply, as the trees of a forest: "
     "its origin comes to lie at x y z (mm), rotated by qx qy qz qw (a quaternion) or rx ry rz (degrees "
     "about the world's x axis, then y, then z), in the size scale and the colour red green blue, as far as "
     "there are these columns; drawn as discs. What is out of view or hidden takes hardly any time. "
     "--volume, --lines, --glyphs and --surface are drawn once, beside them",
     .group = PICTURE, TEXT(instances), .flags = ISO_OPTION_READS},
    {"method", NULL, "NAME", method_help, .group = PICTURE,
     .standard = "exact, for files of points splats, of 3-D Gaussians gaussians",
     CHOICE(method, method_names), .hint = "raycast follows rays, mesh draws Marching Cubes"},
    {"reconstruction", NULL, "NAME",
     "of pullpush: gaussian or box (Gaussian or equal weights in ellipses; Marroquim 2008); of discs: "
     "curved (second-order discs; flat ones for points that have colours, and for files of points) or flat "
     "(as of splats); of splats: flat (Gaussian discs with a low-pass filter, so that many small points do "
     "not flicker), onepass (without the filter, front to back: Baerentzen and Christensen 2003), ewa (the "
     "filter also widens outlines: Zwicker 2001), mean (of the points with centres in a pixel, near the "
     "nearest: for scans with several points a pixel, with holes where there are none; Schuetz 2021) or "
     "groups (deferred blending of groups of discs that do not overlap: Zhang and Pajarola 2006)",
     .group = PICTURE,
     .standard = "gaussian; of discs curved; of splats flat, or groups with options of groups",
     CHOICE(reconstruction, reconstructions), .hint = "what was called refined is curved"},
    {"reconstruction-filter", NULL, "NAME",
     "of exact and raycast, the field between the voxels: linear (trilinear), cubic (a smooth B-spline: less "
     "stepped, more exact, slower) or interpolating (one through the voxels: for clean simulated fields)",
     .group = PICTURE, .standard = "linear", CHOICE(filter, iso_filter_names)},
    {"one-pyramid", NULL, NULL,
     "pullpush and hybrid draw the input's surfaces, meshes and ribbons in one image pyramid (2008, section "
     "5.1: to compare it) instead of each alone with the nearer one kept, which loses less around outlines",
     .group = PAPERS, FLAG(one_pyramid)},
    {"groups", NULL, "N",
     "most groups of splats; 64: as many as it takes so that no discs of a group overlap", .group = PAPERS,
     .standard = "8, with --transparency 4", INT(groups, 1, ISO_GROUPS_MOST)},
    {"group-overlap", NULL, "C",
     "discs of splats conflict when their distance is below C times the sum of their radii", .group = PAPERS,
     .standard = "1", REAL(group_overlap, 0.01, 1)},
    {"group-radii", NULL, "NAME",
     "how much larger the discs of a group are with --transparency groups and nearest, so that the group "
     "covers the surface by itself: coverage (until they cover nearly the area of all discs, three times at "
     "most: eq. 7 to 9 of the paper), root (by the square root of half the number of groups) or copies (not "
     "at all: copies of discs of other groups fill the gaps)",
     .group = PAPERS, .standard = "coverage", CHOICE(group_radii, group_radii)},
    {"group-bins", NULL, "N",
     "bins of depth in which splats are compared (eq. 6 of the paper) instead of by their own depths",
     .group = PAPERS, INT(group_bins, 1, 1 << 20)},
    {"lod", NULL, "PIXELS",
     "levels of detail for discs, pullpush and splats: where points are closer together than about two times "
     "PIXELS, fewer are "
     "drawn, each the mean of several; for turntables of many points; 0: all points are drawn",
     .group = POINTS, .standard = "1 if there are so many pictures that it saves time, else 0",
     REAL(lod, 0, 1000)},
    {"selection", NULL, "WHICH",
     "points that discs and splats (all but groups) draw: visible (points that nearer ones "
     "hide are left out; by OpenGL also some of those that share a pixel), all, or auto (visible on the cpu, "
     "and by OpenGL in software renderers where it saves time)",
     .group = POINTS, .standard = "auto", CHOICE(selection, selections)},
    {"group-opposite", NULL, NULL,
     "discs of splats that face opposite ways may share a group: fewer groups, but the sides of thin things "
     "then hide each other",
     .group = PAPERS, FLAG(group_opposite)},
    {"group-coplanar", NULL, "DEGREES",
     "discs of splats of one colour may share a group if they lie in one plane within this angle: fewer "
     "groups",
     .group = PAPERS, .standard = "0: they may not", REAL(group_coplanar, 0, 45)},
    {"shading", NULL, "NAME",
     "phong (by normals, with two lights) or edl (eye-dome lighting: samples are darker the more the "
     "surfaces around them stand out before them, which needs no normals; for files of points whose normals "
     "say little)",
     .group = PICTURE, .standard = "phong", CHOICE(lighting, lightings)},
    {"occlusion", NULL, "MM",
     "ambient occlusion: what is surrounded by surfaces within MM, as hollows and clefts, is darker; of "
     "what is opaque: surfaces of volumes, lines, glyphs and meshes",
     .group = PICTURE, .standard = "none; without MM a tenth of the longest side", CALL(apply_occlusion),
     .flags = ISO_OPTION_VALUE_OPTIONAL},
    {"shadow", NULL, NULL, "a soft shadow of the key light, which comes from above left", .group = PICTURE,
     FLAG(shadow)},
    {"outline", NULL, "PX",
     "lines along silhouettes and creases of opaque surfaces, PX wide; dark, on dark backgrounds light",
     .group = PICTURE, .standard = "none; without PX 1", CALL(apply_outline),
     .flags = ISO_OPTION_VALUE_OPTIONAL},
    {"look", NULL, "NAME",
     "paper (figures), studio (dark slides), xray (seen through) or clay: values for --color, --background, "
     "--opacity, --occlusion, --shadow, --outline and --samples, as far as these are not given (--look NAME "
     "--save-scene - prints them)",
     .group = PICTURE, .standard = "none", CHOICE(look, iso_look_names), UNRECORDED},
    {"point-scaling", NULL, "NAME",
     "width of points: exact (by depth) or attenuated (by distance, as OpenGL 1.4 did it; needs OpenGL)",
     .group = PAPERS, .standard = "exact", CHOICE(scaling, scalings)},
    {"strips", NULL, NULL,
     "draw the mesh as triangle strips; --json tells how many indices they save (needs OpenGL)",
     .group = PAPERS, FLAG(strips)},
    {"resolution", NULL, "WxH", "size of the picture in pixels; one number is a square", .group = PICTURE,
     .standard = "1024x1024", CALL(apply_resolution)},
    {"dpi", NULL, "N",
     "pixels an inch that the picture's file states, for printing; the picture is the same but for "
     "--font-size",
     .group = PICTURE, .standard = "none, with one scale (--mm-per-pixel) its true size", REAL(dpi, 1, 1e5)},
    {"samples", NULL, "N", "samples a pixel: 1, 4, 9, ... 64", .group = PICTURE,
     .standard = "4 of opaque pictures by exact, else 1", CALL(apply_samples)},
    {"background", "background-color", "COLOR|none",
     "colour of the background, RRGGBB or a name of CSS; none, or --no-background, is transparent (not in a "
     ".jpg)",
     .group = PICTURE, .standard = "FFFFFF", CALL(apply_background)},
    {"no-background", NULL, NULL, "the same as --background none", .group = PICTURE, FLAG(transparent)},
#include "apps/isorender/figure_options.inc"
#include "apps/isorender/sheet_options.inc"
    {"turntable", NULL, "N",
     "N pictures around the surface with one fixed framing: OUT_000.png, OUT_001.png, ..., or a video",
     .group = PICTURE, INT(turntable, 1, 100000)},
    {"keyframes", NULL, "FILE",
     "pictures between which cameras, isovalues, clips and opacities change: a .json with values of options "
     "at certain pictures, as a scene has them",
     .group = PICTURE, TEXT(keyframe_file), .flags = ISO_OPTION_READS},
    {"frame-rate", NULL, "N", "pictures a second of a video ({videos}), which ffmpeg encodes",
     .group = PICTURE, .standard = "25", REAL(frame_rate, 0.01, 1000)},

#include "apps/isorender/camera_options.inc"
    {"output", "o", "NAME",
     "the picture: a .png, .tif, .jpg, .svg or .pdf (the last two with text as text), - for a .png on "
     "stdout; with several pictures also a video: {videos}; {model} is the input's name, {n:3} a number with "
     "three digits; or a .html: a page in which the surface is turned and its isovalue moved, in any browser "
     "and without a network; it holds the voxels that this needs and the input's name, so mind who gets it",
     .group = OUTPUT, .standard = "{model}.png", TEXT(output), UNRECORDED},
    {"isovalue-range", NULL, "LOW,HIGH", "the isovalues that a page can show", .group = OUTPUT,
     .standard = "the widest around --isovalue with which the page is no larger than --page-size",
     REALS(isovalue_range, 2), UNRECORDED},
    {"page-size", NULL, "SIZE", "a page is no larger, e.g. 20M", .group = OUTPUT,
     .standard = "8 MB, with --isovalue-range 64 MB", .kind = ISO_OPTION_SIZE, FIELD(page_size), UNRECORDED},
    {"points", NULL, "FILE.ply",
     "write the points: x y z nx ny nz radius, in mm (isorender reads them back); x y z are doubles far "
     "from 0",
     .group = OUTPUT, TEXT(points), UNRECORDED},
    {"mesh", NULL, "FILE",
     "write the Marching Cubes mesh: {meshes written}, in mm (a .glb turned and scaled to glTF's metres); "
     "several surfaces and labels are the objects of an .obj, .glb or .3mf",
     .group = OUTPUT, TEXT(mesh), UNRECORDED},
    {"smooth-mesh", NULL, "N", "smooth what --mesh writes, N times (Taubin 1995: steps go, the volume stays)",
     .group = OUTPUT, INT(mesh_edits.smooth, 1, ISO_SMOOTH_MOST), UNRECORDED},
    {"decimate", NULL, "PERCENT|MM",
     "join triangles of what --mesh writes, in the order of the error (meshoptimizer): until so many are "
     "left, as 10%, or as long as the surface moves by about so many mm at most",
     .group = OUTPUT, CALL(apply_decimate), UNRECORDED},
    {"part", NULL, "K/N",
     "draw only part K of N of the surface, into a file of keys (-o NAME.isokeys): parts may be drawn in any "
     "order, by any number of processes or machines; isorender merge makes of all of them the picture that "
     "one process would have made",
     .group = OUTPUT, CALL(apply_part), UNRECORDED},
    {"aov", NULL, "FILE.exr",
     "write depth Z (mm along the view), normal N.X N.Y N.Z (world, out of the solid) and coverage A of "
     "every pixel as OpenEXR floats: means over its covered samples; with several surfaces, lines, glyphs or "
     "meshes also id.surface, id.element (glyph, line or triangle) and id.segment (of the line) of the "
     "nearest sample as integers: from 1, 0 where there is none",
     .group = OUTPUT, TEXT(aov), UNRECORDED},
    {"save-scene", NULL, "FILE.json",
     "write input, options and files of the picture as one JSON object, which isorender FILE.json draws "
     "again; every PNG holds it too (--again)",
     .group = OUTPUT, TEXT(save_scene), UNRECORDED},
    {"again", NULL, "FILE",
     "draw the picture of a .png or scene again, of the files beside it; options and inputs that are given "
     "replace its own",
     .group = OUTPUT, .kind = ISO_OPTION_TEXTS, FIELD(again),
     .flags = ISO_OPTION_REPEATABLE | ISO_OPTION_UNRECORDED},
    {"schema", NULL, NULL, "print the JSON schema of scenes", .group = OUTPUT, CALL(apply_schema),
     UNRECORDED},
    {"no-image", "no-render", NULL, "make no picture", .group = OUTPUT, FLAG(no_image), UNRECORDED},
    {"info", NULL, NULL, "no picture: header, matrix, value range, histogram, suggested isovalues, memory",
     .group = OUTPUT, FLAG(info), UNRECORDED},
    {"json", NULL, "FILE",
     "one object with what was read, made and measured, to stdout without a FILE: of several inputs a line "
     "each, or files by a template",
     .group = OUTPUT, CALL(iso_settings_apply_json), .extension = ".json",
     .flags = ISO_OPTION_VALUE_OPTIONAL | ISO_OPTION_UNRECORDED},

    {"backend", "rendering-backend", "NAME",
     "cpu, egl or osmesa (OpenGL without a window: points, discs, pullpush, hybrid, opaque splats, mesh, "
     "lines and glyphs); auto is a GPU where EGL finds one, else cpu; but what needs the cpu is drawn by it",
     .group = RUNNING, .standard = "auto", TEXT(backend), UNRECORDED},
    {"list-backends", "list-rendering-backends", NULL, "say what can render here", .group = RUNNING,
     CALL(apply_list_backends), UNRECORDED},
    {"progress", "loading-progress", NULL, "tell how far it is", .group = RUNNING, FLAG(progress),
     UNRECORDED},
    {"verbose", NULL, "LEVEL", "say more: timings and counts (quiet, error, warning, info, debug)",
     .group = RUNNING, CALL(apply_verbose), .flags = ISO_OPTION_VALUE_OPTIONAL | ISO_OPTION_UNRECORDED},
    {"chunk-size", NULL, "N",
     "draw the volume in chunks of N voxels a side, rounded up to multiples of 16, one after the other; what "
     "comes out does not depend on it, but for what fills the picture (--fit)",
     .group = RUNNING, .standard = "128, and only volumes larger than --max-memory",
     INT(chunk_size, 1, 1 << 20), UNRECORDED},
    {"no-index", NULL, NULL,
     "keep no index of a volume that is drawn in chunks: else NAME.isoindex beside its file, so that later "
     "pictures read only the chunks that they show",
     .group = RUNNING, FLAG(no_index), UNRECORDED},
    {"threads", NULL, "N", "threads to use; what comes out does not depend on it", .group = RUNNING,
     .standard = "one a processor", INT(common.threads, 1, 1024), UNRECORDED},
#include "apps/common/running_options.inc"
};

static const char *const inputs_text[] = {"Volumes: {volumes} (legacy .vtk, every kind of HDF5), a DICOM "
                                          "folder, folders of .tif or .png slices, Zarr and N5 folders, "
                                          ".strokes, raw data with --raw, scene:NAME[:SIZE], and - for stdin "
                                          "(the content tells the format).",
                                          "Points: {points}, without faces.",
                                          "Lines ({lines}) are drawn as --lines draws them, molecules and "
                                          "rows with names (.pdb, .csv) as --glyphs, faces "
                                          "({meshes}) as --surface.",
                                          "Without OUT the picture is IN's name with .png, in the current "
                                          "folder. World axes are LPS: front looks along +y.",
                                          NULL};

static const char *const exit_text[] = {"0  done",
                                        "2  wrong usage",
                                        "3  the input cannot be read: missing, truncated, not a volume",
                                        "4  no usable backend, or no ffmpeg for a video",
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
    "isorender large.nrrd --isovalue 9 --part 3/16 -o 3.isokeys    # and 1 to 16, then:",
    "isorender merge *.isokeys -o large.png",
    "isorender sheet subjects/*/t1.nii.gz -o qc.html --measure volume",
    NULL};

static const iso_section sections[] = {
    {"Files that are read", inputs_text}, {"Exit status", exit_text}, {"Examples", example_text}};

const char *isorender_reconstruction_name(const isorender_settings *settings, bool splats) {
    const bool usual = splats && settings->reconstruction < (int)ISO_RECONSTRUCTION_FLAT;
    return reconstructions[usual ? (int)ISO_RECONSTRUCTION_FLAT : settings->reconstruction];
}
_Static_assert(sizeof options / sizeof *options <= ISORENDER_MOST_OPTIONS, "isorender_settings.given");

static void note_option(void *target, const iso_option *option, const char *value) {
    isorender_settings *settings = target;
    uint64_t *hash = &settings->given[option - options];
    *hash = iso_hash(*hash + 1, value ? value : "", value ? strlen(value) : 0);
    iso_settings_record_option(settings, option, value);
    if (option->flags & ISO_OPTION_UNRECORDED) return;
    if (settings->noted_count < ISORENDER_NOTED)
        settings->noted[settings->noted_count] = (isorender_noted){option, value};
    settings->noted_count++;
}

/* Names and explains the methods as the table of renderers does. */
static void list_methods(void) {
    int count;
    const iso_method *families = iso_method_families(&count);
    int used = snprintf(method_help, sizeof method_help, "how the surface is drawn:");
    for (int i = 0; i < count; i++) {
        const iso_renderer *renderer = iso_renderer_get(families[i]);
        method_names[i] = renderer->name;
        used += snprintf(method_help + used, sizeof method_help - (size_t)used, " %s (%s)%s", renderer->name,
                         renderer->purpose, i + 1 < count ? "," : "");
    }
    snprintf(method_help + used, sizeof method_help - (size_t)used,
             " or gaussians (files of 3-D Gaussians: translucent ellipsoids, sorted by depth)");
    method_names[count] = "gaussians";
    method_gaussians = count;
}

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
                                        .seen = note_option};
    for (int i = 0; i < ISO_REFRACTIONS; i++) refractions[i] = iso_refraction_name((iso_refraction)i);
    list_methods();
    return &program;
}

iso_status isorender_settings_parse(int argc, char *const *argv, isorender_settings *settings,
                                    iso_operands *operands, iso_error *error) {
    *settings = (isorender_settings){.method = ISORENDER_METHOD_UNCHOSEN,
                                     .reconstruction = ISORENDER_RECONSTRUCTION_UNCHOSEN,
                                     .lod = NAN,
                                     .backend = "auto",
                                     .frame_rate = 25,
                                     .width = 1024,
                                     .height = 1024,
                                     .background = {255, 255, 255},
                                     .direction = ISORENDER_DIRECTION_UNCHOSEN,
                                     .up = {0, 0, 1},
                                     .fit = ISORENDER_FIT_UNCHOSEN,
                                     .zoom = 1,
                                     .line_min_pixels = 1,
                                     .margin = NAN,
                                     .cap = {.map = ISO_COLORMAP_GRAY},
                                     .view_angle = 30};
    for (int i = 0; i < 3; i++) settings->position[i] = settings->focal_point[i] = settings->view_up[i] = NAN;
    settings->window[0] = settings->window[1] = NAN;
    settings->isovalue_range[0] = settings->isovalue_range[1] = NAN;
    settings->merge = argc > 1 && strcmp(argv[1], "merge") == 0;
    settings->sheet.is_given = argc > 1 && strcmp(argv[1], "sheet") == 0;
    if (settings->sheet.is_given) settings->width = settings->height = ISORENDER_SHEET_PANEL;
    const int commands = settings->merge + settings->sheet.is_given;
    const iso_status status =
        iso_options_parse(isorender_program(), argc - commands, argv + commands, settings, operands, error);
    /* What is wrong with a layout is said together with the file that it is for, if that is known already. */
    if (status != ISO_OK && error && operands->count == 1 && strncmp(error->text, "option --raw:", 13) == 0)
        return iso_fail(error, status, "%s: %s", operands->values[0], error->text);
    ISO_TRY(status);
    settings->gaussians = settings->method == method_gaussians;
    if (settings->gaussians) settings->method = ISORENDER_METHOD_UNCHOSEN;
    if (settings->method != ISORENDER_METHOD_UNCHOSEN)
        settings->method = (int)iso_method_families(&(int){0})[settings->method];
    if (settings->common.action) return ISO_OK;
    ISO_TRY(isorender_look_apply(settings, error));
    return isorender_settings_check(settings, operands, error);
}
