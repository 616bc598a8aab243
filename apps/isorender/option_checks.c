/* option_checks: what operands are, and which options go together. */
#include "apps/isorender/option_checks.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "apps/isorender/annotations.h"
#include "apps/isorender/backend.h"
#include "apps/isorender/channels.h"
#include "apps/isorender/colorings.h"
#include "apps/isorender/cuts.h"
#include "apps/isorender/keyframes.h"
#include "apps/isorender/label_items.h"
#include "apps/isorender/page.h"
#include "apps/isorender/panels.h"
#include "apps/isorender/segmentation.h"
#include "apps/isorender/series.h"
#include "apps/isorender/sheet.h"
#include "io/file_contents.h"
#include "scene/glass.h"
#include "scene/loader.h"
#include "scene/segmentation.h"

iso_status isorender_settings_add_object(isorender_settings *settings, iso_object_kind kind, const char *path,
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

/* The kind of object that a file holds besides faces; false: it is a volume, or a file of points. */
static bool is_object(const char *name, iso_object_kind *kind) {
    const unsigned holds = iso_file_contents(name);
    *kind = holds & ISO_HOLDS_LINES    ? ISO_OBJECT_LINES
            : holds & ISO_HOLDS_GLYPHS ? ISO_OBJECT_GLYPHS
                                       : ISO_OBJECT_MESH;
    return holds & ISO_HOLDS_SHAPES && !(holds & (ISO_HOLDS_VOLUME | ISO_HOLDS_POINTS));
}

/* Whether an option that only points have is given. */
static bool wants_points(const isorender_settings *settings) {
    const isorender_object_options *objects = &settings->object_options;
    return settings->columns || settings->points || settings->gaussians || settings->radius != 0 ||
           settings->normals != ISORENDER_NORMALS_FILE || objects->color_by.count || objects->every.count ||
           (settings->method != ISORENDER_METHOD_UNCHOSEN && settings->method != ISO_METHOD_EXACT &&
            settings->method != ISO_METHOD_MESH);
}

/* A file of faces is a mesh, although its vertices could be drawn as points, unless an option asks for points
 * or the vertices have colours, which a mesh does not show. */
static bool is_mesh(isorender_settings *settings) {
    const iso_mesh_content content = iso_mesh_find_faces(settings->inputs[0]);
    const bool points = iso_loader_reads_points(settings->inputs[0], settings->columns);
    if (content == ISO_MESH_NO_FACES) return false;
    if (points && (content == ISO_MESH_COLORED_FACES || wants_points(settings))) {
        settings->faces = ISORENDER_FACES_LEFT_OUT;
        return false;
    }
    if (points) settings->faces = ISORENDER_FACES_DRAWN;
    return true;
}

/* Takes an input that is an object: it becomes the first one. With --raw it is a volume, whatever its name.
 */
static iso_status take_object(isorender_settings *settings, iso_error *error) {
    isorender_object_options *objects = &settings->object_options;
    iso_object_kind kind;
    if (settings->no_input || settings->scene || settings->common.input.has_raw) return ISO_OK;
    if (settings->input_count == 1 && is_mesh(settings))
        kind = ISO_OBJECT_MESH;
    else if (!is_object(settings->inputs[0], &kind) ||
             iso_loader_reads_points(settings->inputs[0], settings->columns))
        return ISO_OK;
    if (settings->input_count > 1)
        return iso_fail(error, ISO_ERR_USAGE,
                        "%s: lines, glyphs and meshes are drawn one file at a time, or together with "
                        "--lines, --glyphs and --surface",
                        settings->inputs[0]);
    ISO_TRY(isorender_settings_add_object(settings, kind, settings->inputs[0], error));
    for (int i = objects->count - 1; i > 0; i--) {
        objects->paths[i] = objects->paths[i - 1];
        objects->kinds[i] = objects->kinds[i - 1];
    }
    objects->paths[0] = settings->inputs[0];
    objects->kinds[0] = kind;
    settings->no_input = 1;
    return ISO_OK;
}

static bool is_picture(const char *name) {
    return strcmp(name, "-") != 0 && iso_file_type_of_name(name, ISO_WRITES_IMAGE | ISO_WRITES_VIDEO |
                                                                     ISO_WRITES_PAGE) != ISO_FILE_UNKNOWN;
}

static bool exists(const char *path) {
    return access(path, F_OK) == 0;
}

/* The option that writes a file of this kind; NULL: none does. */
static const char *option_that_writes(const char *name) {
    const unsigned holds = iso_file_type_holds(iso_file_type_of_name(name, ~0u));
    if (holds & ISO_WRITES_MESH && holds & ISO_WRITES_POINTS) return "--mesh or --points ";
    if (holds & ISO_WRITES_MESH) return "--mesh ";
    if (holds & ISO_WRITES_CHANNELS) return "--aov ";
    return holds & ISO_WRITES_REPORT ? "--json=" : NULL;
}

static bool is_number(const char *word) {
    char *end;
    return strtod(word, &end), end > word && !*end;
}

/* Whether an operand is no file and not like the name of one: it may be a further value of an option. */
static bool is_stray(const char *word) {
    return !exists(word) && (is_number(word) || !strpbrk(word, "./:-"));
}

static iso_status fail_value(const char *word, iso_error *error) {
    return iso_fail(error, ISO_ERR_USAGE,
                    "%s: no such file; several values of an option are one word, as in --isovalue 40,90, and "
                    "those that may be left out follow =, as in --largest=2",
                    word);
}

/* The last operand is no picture's name: it may be an output of another kind, or a further input. */
static iso_status fail_picture_name(const char *name, iso_error *error) {
    const char *option = option_that_writes(name);
    char hint[256] = "";
    if (exists(name)) snprintf(hint, sizeof hint, " (several inputs need --output TEMPLATE)");
    if (option && !exists(name)) snprintf(hint, sizeof hint, " (%s%.160s writes such a file)", option, name);
    return iso_fail(error, ISO_ERR_USAGE,
                    "%s: a picture's name must end in .png, .tif, .jpg, .svg or .pdf, a page's in .html%s",
                    name, hint);
}

/* Writes what to do if the inputs are the slices of one volume: three or more files of one kind in one
 * folder; else an empty text. */
static void hint_at_folder(const char *const *inputs, int count, char text[256]) {
    const iso_file_type type = iso_file_type_of_name(inputs[0], ISO_HOLDS_VOLUME | ISO_WRITES_IMAGE);
    const char *slash = strrchr(inputs[0], '/');
    const int folder = slash ? (int)(slash - inputs[0]) : 0;
    text[0] = 0;
    if (type != ISO_FILE_dicom && type != ISO_FILE_png && type != ISO_FILE_tiff) return;
    if (count < 3 || folder > 150) return;
    for (int i = 1; i < count; i++) {
        const char *end = strrchr(inputs[i], '/');
        const bool beside =
            (end ? end - inputs[i] : 0) == folder && !strncmp(inputs[i], inputs[0], (size_t)folder);
        if (!beside || iso_file_type_of_name(inputs[i], ~0u) != type) return;
    }
    snprintf(text, 256, "; slices of one volume are read by their folder: isorender %.*s", slash ? folder : 1,
             slash ? inputs[0] : ".");
}

/* Several operands without --output. */
static iso_status fail_several(const iso_operands *operands, iso_error *error) {
    const char *last = operands->values[operands->count - 1];
    for (int i = 1; i < operands->count; i++)
        if (is_stray(operands->values[i])) return fail_value(operands->values[i], error);
    const bool picture = is_picture(last) && !exists(last);
    const int inputs = operands->count - picture;
    char hint[256];
    hint_at_folder(operands->values, inputs, hint);
    return iso_fail(error, ISO_ERR_USAGE, "%d inputs need --output TEMPLATE, such as '{model}.png'%s%s%s",
                    inputs, picture ? ", not " : "", picture ? last : "", hint);
}

/* Whether the only operand is the name of a picture of --lines, --glyphs, --surface and --volume, which need
 * no input. */
static bool is_only_picture(const isorender_settings *settings, const iso_operands *operands) {
    return (settings->object_options.count || settings->volume_options.count || settings->labels) &&
           !settings->scene && !settings->smooth &&
           (operands->count == 0 ||
            (operands->count == 1 && !settings->output && is_picture(operands->values[0])));
}

/* Takes the output from the operands: the last of them, when it is one more than there are inputs. */
static iso_status take_output(isorender_settings *settings, const iso_operands *operands, int inputs,
                              int *count, iso_error *error) {
    if (*count != inputs + 1) return ISO_OK;
    const char *last = operands->values[*count - 1];
    if (settings->output && !strchr(settings->output, '{') && is_picture(last) && !exists(last))
        return iso_fail(error, ISO_ERR_USAGE, "%s: the picture has a name already: --output %s", last,
                        settings->output);
    if (settings->output) return ISO_OK;
    settings->output = operands->values[--*count];
    if (is_number(settings->output)) return fail_value(settings->output, error);
    if (strcmp(settings->output, "-") != 0 && !settings->parts && !is_picture(settings->output))
        return fail_picture_name(settings->output, error);
    return ISO_OK;
}

/* A single input whose header names the segments that its labels are (.seg.nrrd) is drawn as --smooth draws
 * it, unless isosurfaces are asked for. */
static void take_segments(isorender_settings *settings) {
    const bool unfit = settings->no_input || settings->scene || settings->series_of || settings->labels ||
                       settings->smooth || settings->info || settings->input_count != 1 ||
                       settings->common.input.has_raw || settings->isovalue_count;
    settings->segments = !unfit && iso_segmentation_has_segments(settings->inputs[0]);
    settings->smooth |= settings->segments;
}

static iso_status take_operands(isorender_settings *settings, const iso_operands *operands,
                                iso_error *error) {
    int count = operands->count;
    const char *const *names = operands->values;
    const bool may_be_input = count > 0 && iso_image_kind_of(names[0]) == ISO_IMAGE_TIFF && exists(names[0]);
    if (count == 2 && is_picture(names[0]) && !may_be_input && !is_picture(names[1]) && exists(names[1]))
        return iso_fail(error, ISO_ERR_USAGE, "the input comes first: isorender %s %s", names[1], names[0]);
    settings->no_input = is_only_picture(settings, operands);
    if (settings->series_of) settings->no_input = 0;
    const bool named = settings->scene || settings->no_input || settings->series_of;
    ISO_TRY(take_output(settings, operands, named ? 0 : 1, &count, error));
    if (count == 0 && !named) return iso_fail(error, ISO_ERR_USAGE, "no input (see --help)");
    if ((settings->scene || settings->series_of) && count > 0)
        return iso_fail(error, ISO_ERR_USAGE, "%s: --%s takes no other input", operands->values[0],
                        settings->scene ? "scene" : "series-of");
    if (count > 1 && !settings->output && !settings->info && !settings->no_image)
        return fail_several(operands, error);
    const char *const *files = settings->object_options.count   ? settings->object_options.paths
                               : settings->volume_options.count ? settings->volume_options.paths
                                                                : &settings->labels;
    settings->inputs = settings->no_input ? files : operands->values;
    settings->input_count = settings->scene || settings->no_input ? 1 : count;
    if (settings->series_of) ISO_TRY(isorender_series_take(settings, error));
    take_segments(settings);
    if (settings->smooth) settings->no_input = 1; /* it is read as labels */
    ISO_TRY(take_object(settings, error));
    settings->object_options.has_cloud = !settings->no_input && !settings->scene &&
                                         !settings->common.input.has_raw &&
                                         iso_loader_reads_points(settings->inputs[0], settings->columns);
    return ISO_OK;
}

/* Several inputs cannot write one file, but for a device. */
static iso_status check_templates(const isorender_settings *settings, iso_error *error) {
    const struct {
        const char *option, *name;
    } outputs[] = {{"output", settings->output},         {"json", settings->common.json_path},
                   {"points", settings->points},         {"mesh", settings->mesh},
                   {"save-scene", settings->save_scene}, {"aov", settings->aov}};
    for (size_t i = 0; settings->input_count > 1 && i < sizeof outputs / sizeof *outputs; i++) {
        const char *name = outputs[i].name, *dot = name ? strrchr(name, '.') : NULL;
        struct stat found;
        const bool device = name && stat(name, &found) == 0 && !S_ISREG(found.st_mode);
        const bool numbered = settings->series_of && (name == settings->output || name == settings->aov);
        if (!name || numbered || device || strcmp(name, "-") == 0 || strchr(name, '{')) continue;
        char hint[256];
        hint_at_folder(settings->inputs, settings->input_count, hint);
        return iso_fail(error, ISO_ERR_USAGE,
                        "option --%s: %s: %d inputs need an output each: a template, such as '{model}%s'%s",
                        outputs[i].option, name, settings->input_count, dot ? dot : "", hint);
    }
    return ISO_OK;
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
    if (iso_file_type_of_name(settings->aov, ISO_WRITES_CHANNELS) == ISO_FILE_UNKNOWN)
        return iso_fail(error, ISO_ERR_USAGE, "%s: --aov writes OpenEXR files: a name must end in .exr",
                        settings->aov);
    if (settings->info)
        return iso_fail(error, ISO_ERR_USAGE, "--info renders nothing that --aov could write");
    return ISO_OK;
}

static iso_status check_video(const isorender_settings *settings, iso_error *error) {
    const iso_video_opts opts = {
        .width = settings->width, .height = settings->height, .transparent = settings->transparent != 0};
    if (!iso_video_is_name(settings->output)) return ISO_OK;
    if (!settings->turntable && !settings->series_of && !settings->keyframe_file)
        return iso_fail(
            error, ISO_ERR_USAGE,
            "%s: a video needs several pictures: --turntable, --keyframes or --series-of makes them",
            settings->output);
    return iso_video_check(settings->output, &opts, error);
}

static iso_status check_outputs(const isorender_settings *settings, iso_error *error) {
    bool image = !settings->no_image && !settings->info;
    bool to_stdout = image && settings->output && strcmp(settings->output, "-") == 0;
    if (settings->output && !to_stdout && image && !settings->parts && !is_picture(settings->output))
        return iso_fail(error, ISO_ERR_USAGE,
                        "%s: a picture's name must end in .png, .tif, .jpg, .svg or .pdf, a page's in .html",
                        settings->output);
    if (image && settings->output && settings->transparent &&
        iso_image_kind_of(settings->output) == ISO_IMAGE_JPEG)
        return iso_fail(error, ISO_ERR_USAGE, "%s: a JPEG has no transparency: .png and .tif have",
                        settings->output);
    if (image && settings->output) ISO_TRY(check_video(settings, error));
    if (to_stdout && settings->common.json && !settings->common.json_path)
        return iso_fail(error, ISO_ERR_USAGE, "the picture and --json cannot both go to standard output");
    if (to_stdout && (settings->turntable || settings->keyframe_file || settings->series_of))
        return iso_fail(error, ISO_ERR_USAGE, "several pictures cannot go to standard output");
    if (settings->points && iso_file_type_of_name(settings->points, ISO_WRITES_POINTS) == ISO_FILE_UNKNOWN)
        return iso_fail(error, ISO_ERR_USAGE, "%s: points are written as .ply", settings->points);
    if (settings->mesh) ISO_TRY(iso_mesh_write_check(settings->mesh, error));
    ISO_TRY(check_aov(settings, error));
    if (settings->no_image && !settings->points && !settings->mesh && !settings->aov &&
        !settings->common.json && !settings->info)
        return iso_fail(error, ISO_ERR_USAGE, "--no-image leaves nothing to do");
    return ISO_OK;
}

/* What is done to the mesh, and to the solid for printing. */
static iso_status check_mesh(isorender_settings *settings, iso_error *error) {
    const iso_mesh_edits *edits = &settings->mesh_edits;
    const bool decimates = edits->keep > 0 || edits->deviation > 0;
    if ((edits->smooth || decimates) && !settings->mesh)
        return iso_fail(error, ISO_ERR_USAGE, "%s is of a file: it needs --mesh FILE",
                        edits->smooth ? "--smooth-mesh" : "--decimate");
    if (decimates && !iso_weld_can_decimate())
        return iso_fail(error, ISO_ERR_BACKEND,
                        "--decimate: built without meshoptimizer, which joins triangles");
    if (settings->drain > 0 && !(settings->hollow > 0))
        return iso_fail(error, ISO_ERR_USAGE, "--drain is of what is hollow: it needs --hollow MM");
    if (settings->hollow > 0) settings->closed = 1;
    const char *unfit = !(settings->hollow > 0)              ? NULL
                        : settings->no_input                 ? "no input"
                        : settings->object_options.has_cloud ? "points"
                        : settings->parts                    ? "--part"
                        : settings->chunk_size               ? "--chunk-size"
                                                             : NULL;
    if (unfit)
        return iso_fail(error, ISO_ERR_USAGE, "--hollow is of the solid of a volume in memory: not with %s",
                        unfit);
    return ISO_OK;
}

static iso_status check_surfaces(isorender_settings *settings, iso_error *error) {
    if (settings->isovalue_auto && settings->isovalue_count)
        return iso_fail(error, ISO_ERR_USAGE, "--isovalue auto cannot be combined with other isovalues");
    int surfaces = settings->isovalue_count ? settings->isovalue_count : 1;
    if (surfaces + settings->volume_count > ISORENDER_SURFACES)
        return iso_fail(error, ISO_ERR_USAGE, "more than %d surfaces", ISORENDER_SURFACES);
    if (settings->color_count > surfaces)
        return iso_fail(error, ISO_ERR_USAGE, "%d colours for %d isovalue%s", settings->color_count, surfaces,
                        surfaces > 1 ? "s" : "");
    if (surfaces > 1 && settings->points)
        return iso_fail(error, ISO_ERR_USAGE, "--points writes one surface: give one isovalue");
    if (surfaces > 1 && settings->mesh && iso_mesh_file_objects(settings->mesh) == 1)
        return iso_fail(
            error, ISO_ERR_USAGE,
            "%s: holds one surface: give one isovalue, or an .obj, .glb or .3mf, which hold several",
            settings->mesh);
    ISO_TRY(check_mesh(settings, error));
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
            if (settings->isovalues[i] == settings->isovalues[j] &&
                settings->isovalue_sigmas[i] == settings->isovalue_sigmas[j])
                return iso_fail(error, ISO_ERR_USAGE, "isovalue %g%s is given twice", settings->isovalues[i],
                                settings->isovalue_sigmas[i] ? "sigma" : "");
    return ISO_OK;
}

bool isorender_is_translucent(const isorender_settings *settings) {
    if (settings->ior > 0) return false; /* glass; its opacity takes light away */
    for (int i = 0; i < settings->opacity_count; i++)
        if (settings->opacities[i] < 1) return true;
    for (int i = 0; i < settings->volume_count; i++)
        if (settings->volumes[i].opacity < 1) return true;
    return isorender_label_items_translucent(&settings->label_items);
}

const char *isorender_object_opacity_option(const isorender_settings *settings) {
    static const char *const names[ISO_OBJECT_KINDS] = {[ISO_OBJECT_LINES] = "--line-opacity",
                                                        [ISO_OBJECT_GLYPHS] = "--glyph-opacity",
                                                        [ISO_OBJECT_MESH] = "--surface-opacity"};
    for (int i = 0; i < settings->object_options.count; i++)
        if (settings->objects[i].opacity < 1) return names[settings->objects[i].kind];
    return NULL;
}

iso_status isorender_translucent_check(const isorender_settings *settings, bool translucent,
                                       iso_error *error) {
    const bool absorbs = settings->absorption_length > 0,
               ordered = settings->transparency && !(settings->ior > 0);
    const char *needs = absorbs                                                ? "--absorption"
                        : ordered                                              ? "--transparency"
                        : settings->layers                                     ? "--layers"
                        : settings->opacity_mode != ISORENDER_OPACITY_BY_ANGLE ? "--opacity-mode"
                                                                               : NULL;
    if (!needs || translucent) return ISO_OK;
    if (!absorbs && !ordered && isorender_object_opacity_option(settings)) return ISO_OK;
    return iso_fail(error, ISO_ERR_USAGE, "%s is for translucent surfaces: it needs an opacity below 1",
                    needs);
}

const char *isorender_light_option(const isorender_settings *settings) {
    return settings->lighting != ISO_LIGHTING_PHONG ? "--shading edl"
           : settings->occlusion != 0               ? "--occlusion"
           : settings->shadow                       ? "--shadow"
           : settings->outline > 0                  ? "--outline"
                                                    : NULL;
}

/* What is found out with the depths and normals of a picture is of opaque surfaces; occlusion and shadows are
 * of what is opaque beside translucent ones as well. */
static iso_status check_lighting(const isorender_settings *settings, iso_error *error) {
    const char *light = isorender_light_option(settings);
    const char *translucent = isorender_is_translucent(settings)          ? "--opacity below 1"
                              : isorender_object_opacity_option(settings) ? "translucent objects"
                                                                          : NULL;
    const bool depths = settings->lighting != ISO_LIGHTING_PHONG;
    const char *option = settings->ior > 0                 ? "--ior"
                         : settings->gaussians             ? "--method gaussians"
                         : depths || settings->outline > 0 ? translucent
                                                           : NULL;
    if (!light) return ISO_OK;
    if (option && option == translucent) light = depths ? "--shading edl" : "--outline";
    if (option)
        return iso_fail(error, ISO_ERR_USAGE, "%s is of opaque surfaces: it cannot be combined with %s",
                        light, option);
    if (depths && (settings->occlusion != 0 || settings->shadow))
        return iso_fail(error, ISO_ERR_USAGE,
                        "--shading edl lights by depths alone: it cannot be combined with %s",
                        settings->occlusion != 0 ? "--occlusion" : "--shadow");
    if (settings->instances && (settings->occlusion != 0 || settings->shadow))
        return iso_fail(error, ISO_ERR_USAGE,
                        "instances do not darken each other: %s cannot be combined with --instances", light);
    char what[64];
    if (!translucent) return isorender_method_require(settings, ISO_CAN_OCCLUSION, light, error);
    snprintf(what, sizeof what, "%s beside %s", light, translucent);
    return isorender_method_require(settings, ISO_CAN_LIT_LAYERS, what, error);
}

/* Smooth surfaces. */
static iso_status check_filter(const isorender_settings *settings, iso_error *error) {
    const char *option = settings->ior > 0              ? "--ior"
                         : isorender_has_caps(settings) ? "--cap or --slice"
                                                        : NULL;
    const char *name = iso_filter_names[settings->filter];
    if (settings->filter == ISO_FILTER_LINEAR) return ISO_OK;
    ISO_TRY(isorender_method_require(settings, ISO_CAN_SMOOTH, "smooth surfaces (--reconstruction-filter)",
                                     error));
    if (option)
        return iso_fail(error, ISO_ERR_USAGE,
                        "%s is of trilinear surfaces: it cannot be combined with --reconstruction-filter %s",
                        option, name);
    return ISO_OK;
}

/* Gaussians have opacities of their own, and only the cpu engine draws them. */
static iso_status check_gaussians(const isorender_settings *settings, iso_error *error) {
    const bool gl = strcmp(settings->backend, "egl") == 0 || strcmp(settings->backend, "osmesa") == 0;
    const char *option = isorender_is_translucent(settings) ? "translucent surfaces"
                         : gl                               ? "OpenGL"
                         : settings->transparency           ? "--transparency"
                                                            : NULL;
    if (!settings->gaussians || !option) return ISO_OK;
    return iso_fail(error, ISO_ERR_USAGE, "--method gaussians cannot be combined with %s", option);
}

static iso_status check_opacity(const isorender_settings *settings, iso_error *error) {
    const int surfaces = settings->isovalue_count ? settings->isovalue_count : 1;
    /* whether a file of points has opacities is known when it has been read */
    const bool may_be = isorender_is_translucent(settings) || settings->object_options.has_cloud;
    ISO_TRY(isorender_translucent_check(settings, may_be, error));
    if (settings->absorption_length > 0 && settings->layers)
        return iso_fail(error, ISO_ERR_USAGE,
                        "--layers leaves out where rays leave the solid, which --absorption must know");
    if (!settings->opacity_count && !isorender_is_translucent(settings)) return ISO_OK;
    if (settings->opacity_count > surfaces)
        return iso_fail(error, ISO_ERR_USAGE, "%d opacities for %d isovalue%s", settings->opacity_count,
                        surfaces, surfaces > 1 ? "s" : "");
    ISO_TRY(isorender_method_require(settings, ISO_CAN_LAYERS, "translucent surfaces", error));
    if (settings->ior > 0) return ISO_OK;
    if (settings->mesh && !iso_mesh_file_has_opacities(settings->mesh))
        return iso_fail(error, ISO_ERR_USAGE,
                        "%s: such a file has no opacities: --opacity is for pictures, .glb and .3mf",
                        settings->mesh);
    bool seen = settings->absorption_length > 0 || settings->volume_options.count || !settings->opacity_count;
    for (int i = 0; i < settings->volume_count; i++) seen |= settings->volumes[i].opacity > 0;
    for (int i = 0; i < settings->opacity_count; i++) seen |= settings->opacities[i] > 0;
    return seen || settings->slice_count
               ? ISO_OK
               : iso_fail(error, ISO_ERR_EMPTY, "all opacities are 0: nothing would be seen");
}

/* An option that has no meaning for glass; NULL: none is given. */
static const char *option_unfit_for_glass(const isorender_settings *settings) {
    return settings->isovalue_count > 1     ? "several isovalues"
           : settings->volume_options.count ? "--volume"
           : settings->channel_count > 1    ? "several channels"
           : settings->color_count          ? "--color"
           : settings->mesh                 ? "--mesh"
                                            : NULL;
}

/* An option that is for glass only; NULL: none is given. */
static const char *option_of_glass(const isorender_settings *settings) {
    return settings->refraction != (int)ISO_REFRACTION_AUTO ? "--refraction"
           : settings->dispersion > 0                       ? "--dispersion"
           : settings->environment                          ? "--environment"
           : settings->attenuation_colored                  ? "--attenuation-color"
           : settings->attenuation_distance > 0             ? "--attenuation-distance"
                                                            : NULL;
}

/* Chooses the refraction when none is given, and checks that the chosen one can be drawn. */
static iso_status check_refraction(isorender_settings *settings, iso_error *error) {
    const bool splats = settings->method == ISO_METHOD_SPLATS,
               nearest = settings->transparency == (int)ISO_TRANSPARENCY_NEAREST;
    if (settings->refraction == (int)ISO_REFRACTION_AUTO)
        settings->refraction = (int)iso_glass_usual_refraction(splats || settings->object_options.has_cloud,
                                                               (iso_transparency)settings->transparency);
    const bool two_sided = settings->refraction == ISO_REFRACTION_TWO_SIDED,
               traced = settings->refraction == ISO_REFRACTION_TRACED;
    if (settings->transparency == (int)ISO_TRANSPARENCY_GROUPS)
        return iso_fail(
            error, ISO_ERR_USAGE,
            "--transparency groups draws no surface that could refract: --ior needs sorted or nearest");
    if (nearest && (two_sided || settings->attenuation_colored))
        return iso_fail(error, ISO_ERR_USAGE,
                        "--transparency nearest knows no far side of the glass: %s needs sorted",
                        two_sided ? "--refraction two-sided" : "--attenuation-color");
    if (settings->opacity_count && (two_sided || traced))
        return iso_fail(error, ISO_ERR_USAGE,
                        "--opacity of glass counts surfaces: it needs --refraction layers, single or none");
    return ISO_OK;
}

static iso_status check_glass(isorender_settings *settings, iso_error *error) {
    const char *needs = option_of_glass(settings), *unfit = option_unfit_for_glass(settings);
    if (!(settings->ior > 0) && needs)
        return iso_fail(error, ISO_ERR_USAGE, "%s is for glass: it needs --ior", needs);
    if (!(settings->ior > 0)) return ISO_OK;
    if (unfit)
        return iso_fail(error, ISO_ERR_USAGE,
                        "--ior draws one surface, as glass: it cannot be combined with %s", unfit);
    ISO_TRY(settings->refraction == (int)ISO_REFRACTION_TRACED
                ? isorender_method_require(settings, ISO_CAN_TRACED, "--refraction traced", error)
                : isorender_method_require(settings, ISO_CAN_GLASS, "glass (--ior)", error));
    ISO_TRY(check_refraction(settings, error));
    if (settings->attenuation_colored != (settings->attenuation_distance > 0))
        return iso_fail(error, ISO_ERR_USAGE,
                        "--attenuation-color and --attenuation-distance need each other");
    return ISO_OK;
}

/* Whether the method that is chosen has an image pyramid, which the usual ones have not. */
static bool has_pyramid(const isorender_settings *settings) {
    return settings->method != ISORENDER_METHOD_UNCHOSEN && isorender_method_can(settings, ISO_CAN_PYRAMID);
}

static iso_status check_line_shading(const isorender_settings *settings, iso_error *error) {
    if (has_pyramid(settings)) return ISO_OK;
    for (int i = 0; i < settings->object_options.count; i++)
        if (settings->objects[i].shading == ISO_LINE_ILLUMINATED)
            return iso_fail(error, ISO_ERR_USAGE,
                            "--line-shading illuminated is for lines by pull-push: it needs --method %s",
                            iso_methods_that_can(ISO_CAN_PYRAMID, (char[ISO_METHODS_TEXT]){0}));
    return ISO_OK;
}

static iso_status check_one_pyramid(const isorender_settings *settings, iso_error *error) {
    if (!settings->one_pyramid) return ISO_OK;
    if (!has_pyramid(settings))
        return iso_fail(error, ISO_ERR_USAGE,
                        "--one-pyramid is for --method %s: others have no image pyramid",
                        iso_methods_that_can(ISO_CAN_PYRAMID, (char[ISO_METHODS_TEXT]){0}));
    if (settings->lod > 0)
        return iso_fail(error, ISO_ERR_USAGE, "--one-pyramid draws all points: --lod is without it");
    return ISO_OK;
}

static iso_status check_objects(isorender_settings *settings, iso_error *error) {
    ISO_TRY(isorender_objects_resolve(&settings->object_options, settings->objects, &settings->cloud, error));
    isorender_object_settings *first = &settings->objects[0];
    if (settings->no_input && settings->input_count && settings->object_options.count &&
        settings->color_count && first->kind == ISO_OBJECT_MESH && first->path == settings->inputs[0] &&
        !first->colored) {
        first->colored = true;
        first->color = settings->colors[0];
    }
    if (settings->object_options.has_cloud && settings->cloud.color_by && settings->color_count)
        return iso_fail(error, ISO_ERR_USAGE, "%s: --color and --color-by both say how it is coloured",
                        settings->inputs[0]);
    if (!settings->object_options.count) return ISO_OK;
    if (settings->ior > 0)
        return iso_fail(error, ISO_ERR_USAGE,
                        "--ior draws glass alone: no --lines, --glyphs and --surface beside it");
    ISO_TRY(check_line_shading(settings, error));
    const char *opacity = isorender_object_opacity_option(settings);
    if (opacity && (strcmp(settings->backend, "egl") == 0 || strcmp(settings->backend, "osmesa") == 0))
        return iso_fail(error, ISO_ERR_USAGE, "--backend %s draws no translucent objects: %s needs the cpu",
                        settings->backend, opacity);
    if (!opacity) return ISO_OK;
    char what[96];
    snprintf(what, sizeof what, "translucent lines, glyphs and meshes (%s)", opacity);
    return isorender_method_require(settings, ISO_CAN_OBJECT_LAYERS, what, error);
}

/* The command merge: its operands are files of keys. All options of the picture are in these. */
static iso_status check_merge(isorender_settings *settings, const iso_operands *operands, iso_error *error) {
    const char *record = settings->common.record, *output = settings->output;
    if (*record)
        return iso_fail(error, ISO_ERR_USAGE,
                        "merge: the picture has the options that its parts were drawn with:%s", record);
    if (!operands->count) return iso_fail(error, ISO_ERR_USAGE, "merge: no files of keys (.isokeys)");
    if (!output || (strcmp(output, "-") != 0 && !is_picture(output)))
        return iso_fail(error, ISO_ERR_USAGE, "merge: needs the picture's name: -o OUT.png");
    settings->inputs = operands->values;
    settings->input_count = operands->count;
    return ISO_OK;
}

static iso_status check_part(const isorender_settings *settings, iso_error *error) {
    const bool keys =
        settings->output && iso_file_type_of_name(settings->output, ISO_HOLDS_KEYS) != ISO_FILE_UNKNOWN;
    if (!settings->parts && keys)
        return iso_fail(error, ISO_ERR_USAGE, "%s: --part writes files of keys", settings->output);
    if (!settings->parts) return ISO_OK;
    if (settings->output && !keys)
        return iso_fail(error, ISO_ERR_USAGE, "%s: --part writes a file of keys: a name must end in .isokeys",
                        settings->output);
    if (settings->turntable || settings->keyframe_file || settings->series_of || settings->no_image ||
        settings->info)
        return iso_fail(error, ISO_ERR_USAGE, "--part draws one picture: it cannot be combined with %s",
                        settings->turntable       ? "--turntable"
                        : settings->keyframe_file ? "--keyframes"
                        : settings->series_of     ? "--series-of"
                        : settings->info          ? "--info"
                                                  : "--no-image");
    return ISO_OK;
}

/* What each keyframe shows must be what can be drawn. */
static iso_status check_keyframes(isorender_settings *settings, iso_error *error) {
    iso_error reason = {0};
    ISO_TRY(isorender_keyframes_read(settings, error));
    for (int i = 0; i < isorender_keyframes_count(settings->keyframes); i++) {
        isorender_settings *now = isorender_keyframe(settings->keyframes, i);
        iso_status status = check_camera(now, &reason);
        if (status == ISO_OK) status = isorender_cuts_check(now, &reason);
        if (status == ISO_OK && isorender_is_translucent(now)) status = check_opacity(now, &reason);
        if (status == ISO_OK) status = check_lighting(now, &reason);
        if (status == ISO_OK) status = check_filter(now, &reason);
        if (status != ISO_OK) return iso_fail(error, status, "%s: %s", settings->keyframe_file, reason.text);
    }
    return ISO_OK;
}

iso_status isorender_settings_check(isorender_settings *settings, const iso_operands *operands,
                                    iso_error *error) {
    if (settings->merge) return check_merge(settings, operands, error);
    if (settings->sheet.is_given) return isorender_sheet_check(settings, operands, error);
    if (settings->sheet.jobs || settings->sheet.measure)
        return iso_fail(error, ISO_ERR_USAGE, "--%s is for sheets: isorender sheet IN ... -o OUT.html",
                        settings->sheet.jobs ? "jobs" : "measure");
    ISO_TRY(iso_input_check(&settings->common.input, error));
    ISO_TRY(isorender_channels_take(settings, error));
    ISO_TRY(isorender_volumes_resolve(&settings->volume_options, settings->volumes + settings->volume_count,
                                      error));
    settings->volume_count += settings->volume_options.count;
    ISO_TRY(check_camera(settings, error));
    ISO_TRY(check_gaussians(settings, error));
    ISO_TRY(isorender_method_check(settings, error));
    ISO_TRY(isorender_detail_check(settings, error));
    ISO_TRY(take_operands(settings, operands, error));
    ISO_TRY(check_templates(settings, error));
    ISO_TRY(isorender_channels_check(settings, error));
    ISO_TRY(isorender_backend_check(settings, error));
    ISO_TRY(check_part(settings, error));
    ISO_TRY(check_outputs(settings, error));
    ISO_TRY(isorender_page_check(settings, error));
    ISO_TRY(isorender_panels_check(settings, error));
    if (isorender_has_panels(settings)) return ISO_OK; /* the rest is checked of each panel */
    ISO_TRY(check_surfaces(settings, error));
    ISO_TRY(check_glass(settings, error));
    ISO_TRY(check_objects(settings, error));
    ISO_TRY(check_lighting(settings, error));
    ISO_TRY(check_filter(settings, error));
    ISO_TRY(check_one_pyramid(settings, error));
    ISO_TRY(isorender_cuts_check(settings, error));
    ISO_TRY(isorender_segmentation_check(settings, error));
    ISO_TRY(isorender_colorings_check(settings, error));
    ISO_TRY(isorender_annotations_check(settings, error));
    ISO_TRY(check_opacity(settings, error));
    if (!settings->series_of) settings->pictures = settings->turntable;
    return check_keyframes(settings, error);
}
