/* format: functions that all readers share, also those in modules: memory limits, opening files, creating
 * grids. */
#include "grids/volume/format.h"

#include "base/file.h"
#include "base/text.h"

#include <fcntl.h>
#include <limits.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/memory.h"

iso_status iso_format_dims(const char *path, const uint64_t dims[3], iso_volume_info *info,
                           iso_error *error) {
    for (int i = 0; i < 3; i++) {
        if (dims[i] < 1 || dims[i] > INT_MAX)
            return iso_fail(error, ISO_ERR_FORMAT, "%s: cannot have %llu voxels on axis %d", path,
                            (unsigned long long)dims[i], i);
        info->dims[i] = (int)dims[i];
    }
    return ISO_OK;
}

/* The command by VTK's Python (Debian: python3-vtk9) that resamples a grid which one of its readers reads. */
#define RESAMPLE(reader)                                                                                     \
    ": python3 -c \"import vtk; r = vtk." reader "; s = vtk.vtkResampleToImage(); "                          \
    "s.SetSamplingDimensions(128, 128, 128); s.SetInputConnection(r.GetOutputPort()); "                      \
    "w = vtk.vtkXMLImageDataWriter(); w.SetInputConnection(s.GetOutputPort()); "                             \
    "w.SetFileName('FILE.vti'); w.Write()\" resamples it"

iso_status iso_format_not_image(const char *path, const char *kind, iso_error *error) {
    static const struct {
        const char *kind, *advice;
    } grids[] = {
        {"UNSTRUCTURED_GRID", RESAMPLE("vtkGenericDataObjectReader(); r.SetFileName('FILE')")},
        {"STRUCTURED_GRID", RESAMPLE("vtkGenericDataObjectReader(); r.SetFileName('FILE')")},
        {"UnstructuredGrid", RESAMPLE("vtkXMLGenericDataObjectReader(); r.SetFileName('FILE')")},
        {"StructuredGrid", RESAMPLE("vtkXMLGenericDataObjectReader(); r.SetFileName('FILE')")},
        {"grid of Exodus", RESAMPLE("vtkExodusIIReader(); r.SetFileName('FILE'); r.UpdateInformation(); "
                                    "r.SetAllArrayStatus(r.NODAL, 1)")},
        {"grid of Gmsh",
         ": meshio convert FILE FILE.vtu makes a .vtu of it, whose refusal names what resamples"}};
    const char *advice = strcasestr(kind, "grid")
                             ? ": resample it in ParaView (Filters, Resample To Image), and "
                               "save it as .vti"
                             : "";
    for (size_t i = 0; i < sizeof grids / sizeof *grids; i++)
        if (strcmp(kind, grids[i].kind) == 0) advice = grids[i].advice;
    return iso_fail(error, ISO_ERR_FORMAT, "%s: holds a %.80s, not an image%s", path, kind, advice);
}

iso_status iso_format_component(const char *path, const iso_volume_opts *opts, int components,
                                iso_volume_info *info, iso_error *error) {
    if (components < 1) return iso_fail(error, ISO_ERR_FORMAT, "%s: has no components", path);
    if (opts->component < 0 || opts->component >= components)
        return iso_fail(error, ISO_ERR_USAGE, "%s: no %s %d, there %s %d (from 0)", path,
                        opts->by_channel ? "channel" : "component", opts->component,
                        components == 1 ? "is" : "are", components);
    info->components = components;
    info->component = opts->component;
    if (components > 1 && !opts->component_axes && !opts->by_channel)
        iso_volume_note(info, "several components: using %d of %d (--component)", opts->component,
                        components);
    return ISO_OK;
}

/* ---- memory ---- */

uint64_t iso_format_memory_limit(const iso_volume_opts *opts) {
    return iso_memory_limit(opts->max_memory);
}

/* "1.5 GB", decimal units. */
static void byte_text(uint64_t bytes, char text[16]) {
    static const char *const units[] = {"bytes", "kB", "MB", "GB", "TB", "PB", "EB"};
    double value = (double)bytes;
    int unit = 0;
    for (; value >= 1000 && unit < 6; unit++) value /= 1000;
    snprintf(text, 16, unit && value < 10 ? "%.1f %s" : "%.0f %s", value, units[unit]);
}

void iso_format_transform(const iso_vec3 steps[3], const iso_vec3 *origin, double unit,
                          iso_volume_info *info) {
    iso_transform *transform = &info->transform;
    for (int axis = 0; axis < 3; axis++) {
        const iso_vec3 direction = iso_vec3_unit(steps[axis]);
        transform->spacing[axis] = iso_vec3_length(steps[axis]) * unit;
        transform->direction[axis] = direction.x;
        transform->direction[3 + axis] = direction.y;
        transform->direction[6 + axis] = direction.z;
    }
    transform->origin[0] = origin->x * unit;
    transform->origin[1] = origin->y * unit;
    transform->origin[2] = origin->z * unit;
}

iso_status iso_format_check_memory(const char *path, const iso_volume_opts *opts, uint64_t bytes,
                                   const char *what, iso_error *error) {
    const uint64_t limit = iso_format_memory_limit(opts);
    if (bytes <= limit) return ISO_OK;
    char needs[16], allowed[16];
    byte_text(bytes, needs);
    byte_text(limit, allowed);
    return iso_fail(error, ISO_ERR_LIMIT, "%s: needs %s to read (%s), limit is %s (--max-memory)", path,
                    needs, what, allowed);
}

/* ---- progress and files ---- */

iso_status iso_format_progress(const char *path, const iso_volume_opts *opts, double fraction,
                               iso_error *error) {
    if (!opts->progress || opts->progress(opts->progress_context, fraction) == 0) return ISO_OK;
    return iso_fail(error, ISO_ERR_IO, "%s: cancelled", path);
}

iso_status iso_format_file_bytes(const char *path, uint64_t *bytes, iso_error *error) {
    FILE *file;
    ISO_TRY(iso_file_open(path, &file, bytes, error));
    fclose(file);
    return ISO_OK;
}

iso_status iso_format_truncated(const char *path, uint64_t bytes, uint64_t wanted, iso_error *error) {
    return iso_fail(error, ISO_ERR_IO, "%s: truncated: %llu of %llu bytes", path, (unsigned long long)bytes,
                    (unsigned long long)wanted);
}

iso_status iso_format_create(const char *path, const iso_volume_info *info, const iso_format_data *lent,
                             iso_grid *grid, iso_error *error) {
    iso_rgrid_desc desc = {.dims = {info->dims[0], info->dims[1], info->dims[2]},
                           .type = info->type,
                           .scale = info->scale,
                           .offset = info->offset,
                           .transform = &info->transform,
                           .level_set = info->level_set};
    if (lent) {
        desc.data = lent->data;
        desc.release = lent->release;
        desc.owner = lent->owner;
    }
    iso_error detail = {0};
    iso_rgrid *rgrid = NULL;
    iso_status status = iso_rgrid_create(&desc, &rgrid, &detail);
    if (status != ISO_OK) return iso_fail(error, status, "%s: %s", path, detail.text);
    *grid = (iso_grid){.rgrid = rgrid};
    return ISO_OK;
}

void iso_volume_note(iso_volume_info *info, const char *format, ...) {
    if (info->note_count >= ISO_VOLUME_NOTES) return;
    va_list arguments;
    va_start(arguments, format);
    iso_text_format(info->notes[info->note_count++], ISO_VOLUME_TEXT, format, arguments);
    va_end(arguments);
}

/* \u00B5 is how ImageJ writes the micro sign. */
double iso_format_unit(const char *name) {
    static const struct {
        const char *name;
        double mm;
    } units[] = {{"mm", 1},           {"millimeter", 1},    {"millimetre", 1},    {"micron", 1e-3},
                 {"microns", 1e-3},   {"um", 1e-3},         {"µm", 1e-3},         {"μm", 1e-3},
                 {"\\u00B5m", 1e-3},  {"micrometer", 1e-3}, {"micrometre", 1e-3}, {"nm", 1e-6},
                 {"nanometer", 1e-6}, {"nanometre", 1e-6},  {"cm", 10},           {"m", 1000},
                 {"meter", 1000},     {"metre", 1000},      {"inch", 25.4},       {"inches", 25.4},
                 {"in", 25.4},        {"pm", 1e-9},         {"angstrom", 1e-7},   {"Å", 1e-7}};
    for (size_t i = 0; i < sizeof units / sizeof *units; i++)
        if (strcasecmp(name, units[i].name) == 0) return units[i].mm;
    return 0;
}

void iso_format_skip_line(FILE *file) {
    int c;
    do c = getc(file);
    while (c != EOF && c != '\n');
}
