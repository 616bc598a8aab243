/* The picture as a page. */
#include "apps/isorender/page.h"

#include "apps/isorender/cuts.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "apps/common/page.h"
#include "apps/isorender/segmentation.h"
#include "base/text.h"

static bool is_page(const isorender_settings *settings) {
    return settings->output && !settings->no_image && !settings->info && iso_page_is_named(settings->output);
}

/* The options that pages can have beside those that only say how the program runs: what the page itself
 * changes or states, and what its command keeps. */
static const char changed[] =
    "isovalue color background resolution samples clip scene camera up azimuth elevation "
    "zoom orthographic fit margin mm-per-pixel view-angle camera-position "
    "camera-focal-point camera-view-up same-view method backend max-memory dpi legend";
static const char kept[] =
    "raw spacing grid series component level crop crop-mm channel cap opacity opacity-mode absorption layers "
    "labels label label-table smooth lines tube-radius line-color line-opacity line-style caps "
    "line-min-pixels streamlines streamline-length streamline-seed axial vectors least tensor-order color-by "
    "range colormap space every";
/* Those that can name files, which the command names without folders. */
static const char files[] = "labels label-table lines colormap";

static bool is_in(const char *names, const char *name) {
    return iso_text_has_word(names, name, strlen(name));
}

/* Whether the page's command keeps an option. (Colours are the page's own, but for those of --smooth.) */
static bool is_kept(const isorender_settings *settings, const char *name) {
    return is_in(kept, name) || (settings->smooth && strcmp(name, "color") == 0);
}

static bool has_labels(const isorender_settings *settings) {
    return settings->labels || settings->smooth;
}

/* The cut of a page is a plane through everything. */
static bool is_plane(const iso_cut *cut) {
    return cut->plane && !cut->by_depth && !cut->things.named && !cut->body.keeps;
}

static iso_status check_clip(const isorender_settings *settings, iso_error *error) {
    if (settings->cut_count > 1 || (settings->cut_count && !is_plane(&settings->cuts[0])))
        return iso_fail(error, ISO_ERR_USAGE,
                        "%s: a page can have one --clip, which is a plane through all surfaces: x<MM or "
                        "X,Y,Z:NX,NY,NZ",
                        settings->output);
    if (settings->cap.kind != ISO_CAP_NONE && settings->cap.kind != ISO_CAP_SURFACE)
        return iso_fail(error, ISO_ERR_USAGE,
                        "%s: --cap of a page is surface: it has not all voxels that a slice shows",
                        settings->output);
    return ISO_OK;
}

static iso_status check_page(const isorender_settings *settings, iso_error *error) {
    const char *page = settings->output;
    char who[ISO_METHODS_TEXT];
    if ((settings->no_input && !has_labels(settings) && !settings->object_options.count) ||
        settings->object_options.has_cloud)
        return iso_fail(error, ISO_ERR_USAGE, "%s: a page shows isosurfaces of a volume, labels and lines",
                        page);
    for (int i = 0; i < settings->noted_count && i < ISORENDER_NOTED; i++) {
        const char *name = settings->noted[i].option->name;
        if (!is_in(changed, name) && !is_in(kept, name))
            return iso_fail(
                error, ISO_ERR_USAGE,
                "%s: a page has no --%s: it shows isosurfaces of one volume, labels and lines, drawn "
                "by --method %s (a .png can have it)",
                page, name, iso_methods_that_can(ISO_CAN_PAGE, who));
    }
    if (settings->volume_count || settings->channel_count > 1)
        return iso_fail(error, ISO_ERR_USAGE, "%s: a page shows one volume, or one channel of it", page);
    if (!isorender_method_can(settings, ISO_CAN_PAGE))
        return iso_fail(error, ISO_ERR_USAGE, "%s: a page is drawn by --method %s", page,
                        iso_methods_that_can(ISO_CAN_PAGE, who));
    if (settings->transparent)
        return iso_fail(error, ISO_ERR_USAGE, "%s: the background of a page has a colour", page);
    if (settings->isovalue_count > ISO_PAGE_SURFACES)
        return iso_fail(error, ISO_ERR_USAGE, "%s: a page has at most %d isovalues", page, ISO_PAGE_SURFACES);
    ISO_TRY(check_clip(settings, error));
    return iso_page_check(page, error);
}

iso_status isorender_page_check(const isorender_settings *settings, iso_error *error) {
    const bool ranged = !isnan(settings->isovalue_range[0]);
    if (is_page(settings)) {
        ISO_TRY(check_page(settings, error));
        if (ranged && !(settings->isovalue_range[0] <= settings->isovalue_range[1]))
            return iso_fail(error, ISO_ERR_USAGE,
                            "--isovalue-range: the second number must not be below the first");
        if (ranged && settings->no_input)
            return iso_fail(error, ISO_ERR_USAGE,
                            "--isovalue-range: a page without a volume has no isovalues");
        return ISO_OK;
    }
    if (ranged || settings->page_size)
        return iso_fail(error, ISO_ERR_USAGE, "--%s is for pages: a name that ends in .html",
                        ranged ? "isovalue-range" : "page-size");
    return ISO_OK;
}

/* ---- writing */

/* An input as the page's command names it, to be freed: without the folders in which it lies. */
static char *name_alone(const char *input) {
    const char *array = iso_volume_array_of(input);
    size_t end = array ? (size_t)(array - input) : strlen(input);
    if (array && end > 0 && input[end - 1] == ':') end--;
    while (!array && end > 1 && input[end - 1] == '/') end--;
    size_t begin = end;
    while (begin > 0 && input[begin - 1] != '/') begin--;
    return strndup(input + begin, (array ? strlen(input) : end) - begin);
}

/* The options that the page's command keeps, to be freed. */
static iso_status list_options(const isorender_settings *settings, char **options, int *count,
                               iso_error *error) {
    for (int i = 0; i < settings->noted_count && i < ISORENDER_NOTED; i++) {
        const isorender_noted *noted = &settings->noted[i];
        const char *name = noted->option->name;
        if (!is_kept(settings, name)) continue;
        char *file = is_in(files, name) ? name_alone(noted->value) : NULL;
        const char *value = file ? file : noted->value;
        const int length = asprintf(&options[*count], value ? "--%s=%s" : "--%s%s", name, value ? value : "");
        free(file);
        if (length < 0) return iso_fail(error, ISO_ERR_NOMEM, "out of memory");
        (*count)++;
    }
    return ISO_OK;
}

static iso_page_clip clip_of(isorender_job *job) {
    const isorender_settings *settings = job->settings;
    iso_page_clip made = {.cap = settings->cap.kind == ISO_CAP_SURFACE};
    /* a body is what lies behind its face; the page has the side that is cut away */
    const iso_cut cut = isorender_cut_placed(job, &settings->cuts[0]);
    const double *face = cut.body.face[0];
    for (int i = 0; settings->cut_count && i < 4; i++) made.plane[i] = -face[i];
    return made;
}

static iso_status check_grid(const isorender_job *job, const char *path, iso_error *error) {
    if (job->chunks)
        return iso_fail(error, ISO_ERR_UNSUPPORTED,
                        "%s: a page needs the whole volume in memory: --crop and --level leave less of it",
                        path);
    if (job->input_surface_count && !job->surfaces[0].scene.grid.rgrid)
        return iso_fail(error, ISO_ERR_UNSUPPORTED, "%s: pages of sparse volumes (.vdb) are not written",
                        path);
    return ISO_OK;
}

static void log_page(const isorender_job *job, const iso_page_written *written) {
    const double megabytes = (double)written->bytes / 1e6;
    const char *others = job->segmentation && job->object_count ? "the labels of all voxels, and all lines"
                         : job->segmentation                    ? "the labels of all voxels"
                         : job->object_count                    ? "all lines"
                                                                : "";
    if (job->input_surface_count)
        isorender_log(
            job,
            "the page holds the isovalues from %.6g to %.6g, and %.3g %% of the volume's voxels%s%s: "
            "who has the page has these (%.2f MB)",
            written->range[0], written->range[1], 100 * written->kept, *others ? ", " : "", others,
            megabytes);
    else
        isorender_log(job, "the page holds %s: who has the page has these (%.2f MB)", others, megabytes);
    isorender_log_verbose(
        job, "of the page %.2f MB are the engine, %.2f MB the voxels, %.2f MB the labels, %.2f MB the lines",
        (double)written->engine_bytes / 1e6, (double)written->voxel_bytes / 1e6,
        (double)written->label_bytes / 1e6, (double)written->line_bytes / 1e6);
}

/* The labels of the page; items: of all, to be filled. */
static iso_page_labels labels_of(const isorender_job *job, const iso_page_surface *groups,
                                 iso_page_label *items) {
    const iso_segmentation *s = job->segmentation;
    iso_page_labels made = {.transform = &s->labels.transform,
                            .number = s->labels.number,
                            .items = items,
                            .count = s->labels.count,
                            .groups = groups,
                            .group_count = job->surface_count - job->input_surface_count};
    memcpy(made.dims, s->labels.dims, sizeof made.dims);
    for (int i = 0; i < s->labels.count; i++)
        items[i] = (iso_page_label){s->items[i].name, s->items[i].color, s->group[i]};
    for (int i = job->input_surface_count; i < job->surface_count; i++)
        if (job->surfaces[i].scene.labels) made.shared = job->surfaces[i].label_group;
    return made;
}

/* The lines of the page. ISO_ERR_UNSUPPORTED: some of a mesh in --lines are triangles. */
static iso_status list_lines(const isorender_job *job, const char *path, iso_page_lines *lines,
                             iso_error *error) {
    const isorender_line_pixels pixels = {job->settings->line_min_pixels, job->settings->line_drop_pixels};
    for (int i = 0; i < job->object_count; i++) {
        const isorender_object *object = &job->objects[i];
        if (object->settings->kind != ISO_OBJECT_LINES)
            return iso_fail(
                error, ISO_ERR_UNSUPPORTED,
                "%s: a page has lines, but no triangles: not all of the mesh in --lines has become lines",
                path);
        lines[i].lines = isorender_object_lines(object, &pixels, &lines[i].opts);
        lines[i].color = object->scene.color;
        lines[i].translucency = object->scene.translucency;
    }
    return ISO_OK;
}

/* What the page is called by: the volume, or else labels, or else lines. */
static const char *page_input(const isorender_job *job) {
    const char *labels = isorender_labels_path(job);
    return job->input_surface_count ? isorender_input_name(job)
           : labels                 ? labels
                                    : job->objects[0].settings->path;
}

iso_status isorender_page_write(isorender_job *job, const iso_image *image, const char *path,
                                iso_error *error) {
    const isorender_settings *settings = job->settings;
    iso_page_surface surfaces[ISORENDER_SURFACES];
    char *options[ISORENDER_NOTED];
    iso_page_written written;
    int count = 0;
    ISO_TRY(check_grid(job, path, error));
    const int isosurfaces = job->input_surface_count;
    iso_rgrid *grid = isosurfaces ? job->surfaces[0].scene.grid.rgrid : NULL;
    const iso_segmentation *s = job->segmentation;
    iso_page_label *items = s ? calloc((size_t)s->labels.count, sizeof *items) : NULL;
    if (s && !items) return iso_fail(error, ISO_ERR_NOMEM, "out of memory");
    const iso_page_labels labels = s ? labels_of(job, surfaces + isosurfaces, items) : (iso_page_labels){0};
    for (int i = 0; i < job->surface_count; i++) {
        const isorender_surface *surface = &job->surfaces[i];
        surfaces[i] = (iso_page_surface){surface->scene.isovalue, surface->color, surface->translucency};
    }
    const iso_camera camera = isorender_camera_of_frame(job, 0);
    iso_page_lines lines[ISORENDER_OBJECTS];
    char *name = name_alone(page_input(job));
    iso_status status = name ? ISO_OK : iso_fail(error, ISO_ERR_NOMEM, "out of memory");
    if (status == ISO_OK) status = list_lines(job, path, lines, error);
    if (status == ISO_OK) status = list_options(settings, options, &count, error);
    const iso_page page = {.name = name,
                           .without_input = !isosurfaces && !settings->smooth,
                           .grid = grid,
                           .surfaces = surfaces,
                           .count = isosurfaces,
                           .labels = s ? &labels : NULL,
                           .lines = lines,
                           .lines_count = job->object_count,
                           .bounds = job->bounds_world,
                           .clip = clip_of(job),
                           .camera = &camera,
                           .image = image,
                           .background = settings->background,
                           .options = (const char *const *)options,
                           .option_count = count,
                           .range = {settings->isovalue_range[0], settings->isovalue_range[1]},
                           .most = settings->page_size,
                           .pool = job->pool};
    if (status == ISO_OK) status = iso_page_write(path, &page, &written, error);
    if (status == ISO_OK) log_page(job, &written);
    for (int i = 0; i < count; i++) free(options[i]);
    free(items);
    free(name);
    return status;
}
