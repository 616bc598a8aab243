/* --info: what a file holds, as text on stdout. */
#include <math.h>
#include <string.h>

#include "apps/isorender/channels.h"
#include "apps/isorender/picture_record.h"
#include "base/text.h"

/* 1234567 bytes as "1.2 MB". */
static void print_bytes(uint64_t bytes) {
    static const char *const units[] = {"bytes", "kB", "MB", "GB", "TB", "PB"};
    double value = (double)bytes;
    int unit = 0;
    for (; value >= 1000 && unit < 5; unit++) value /= 1000;
    printf(unit ? "%.1f %s" : "%.0f %s", value, units[unit]);
}

static void print_numbers(const char *title, const double v[3], const char *unit) {
    printf("  %-11s %.10g %.10g %.10g%s\n", title, v[0], v[1], v[2], unit);
}

static void print_lengths(const char *title, const double v[3], const iso_length_style *style,
                          const char *space) {
    const double factor = iso_length_factor(style), shown[3] = {v[0] * factor, v[1] * factor, v[2] * factor};
    const char *name = iso_length_unit_name(style);
    char unit[32];
    snprintf(unit, sizeof unit, "%s%s%s", *name ? " " : "", name, space);
    print_numbers(title, shown, unit);
}

/* unit: of the world; "": it is not known. */
static void print_matrix(const iso_transform *transform, const char *unit) {
    iso_affine affine = iso_transform_affine(transform);
    for (int row = 0; row < 3; row++)
        printf("  %-11s %12.6g %12.6g %12.6g %12.6g\n", row ? "" : "matrix", affine.m[3 * row],
               affine.m[3 * row + 1], affine.m[3 * row + 2], affine.origin[row]);
    printf("  %-11s from voxels to world%s%s%s\n", "", *unit ? " " : "", unit,
           affine.determinant < 0 ? ", left-handed" : "");
}

static void print_memory(const isorender_job *job, const iso_volume_info *info) {
    printf("  %-11s ", "memory");
    print_bytes(info->bytes);
    printf(" for the grid, ");
    print_bytes(info->read_bytes);
    printf(" while reading, ");
    print_bytes(isorender_picture_bytes(job, job->samples));
    printf(" for a picture of %dx%d\n", job->settings->width, job->settings->height);
}

/* What else the voxels can be drawn as; components may also be times or colours, which files do not say. */
static void print_field(const iso_volume_info *info) {
    const int n = info->components;
    if (n == 3) printf("  %-11s if they are vectors: arrows (--glyphs), streamlines (--lines)\n", "drawable");
    if (n == 6 || n == 7 || n == 9)
        printf("  %-11s if they are tensors: ellipsoids (--glyphs)\n", "drawable");
}

static void print_header(const isorender_job *job, const iso_loader *loader) {
    const iso_volume_info *info = &loader->volume.info;
    const iso_length_style lengths = {(iso_length_unit)job->settings->unit, isorender_volume_unit(info)};
    iso_text_put(stdout, iso_spool_name(loader->input));
    putchar('\n');
    if (loader->has_points) return;
    printf("  %-11s %s%s%s\n", "format", info->format, info->name[0] ? ", " : "", info->name);
    printf("  %-11s %d x %d x %d, %s", "voxels", info->dims[0], info->dims[1], info->dims[2],
           info->file_type);
    if (info->components > 1) printf(", component %d of %d", info->component, info->components);
    if (strcmp(info->file_type, iso_type_name(info->type)) != 0)
        printf(", held as %s", iso_type_name(info->type));
    printf("%s\n", info->sparse ? ", sparse level set" : info->level_set ? ", level set" : "");
    print_field(info);
    isorender_channels_info(loader);
    if (info->scale != 1 || info->offset != 0)
        printf("  %-11s physical = %.10g * stored + %.10g\n", "values", info->scale, info->offset);
    print_lengths("spacing", info->transform.spacing, &lengths, "");
    print_lengths("origin", info->transform.origin, &lengths, info->anatomical ? " (LPS)" : "");
    for (int row = 0; row < 3; row++)
        print_numbers(row ? "" : "direction", &info->transform.direction[3 * row], "");
    print_matrix(&info->transform, lengths.world == ISO_WORLD_UNIT_NONE
                                       ? iso_length_unit_name(&lengths)
                                       : iso_world_unit_suffix(lengths.world) + 1);
    if (lengths.world == ISO_WORLD_UNIT_NONE)
        printf("  %-11s the file states none%s\n", "unit",
               job->settings->unit == ISO_UNIT_AUTO ? ": --unit says what its lengths are in" : "");
    print_memory(job, info);
    for (int i = 0; i < info->item_count; i++) printf("  %-11s %s\n", i ? "" : "holds", info->items[i]);
}

void isorender_info_header(const isorender_job *job) {
    if (!job->settings->no_input) print_header(job, &job->loader);
}

/* Rows of a histogram: bars grow with the square root of the count, or a peak would hide the rest. */
static void print_histogram(const iso_histogram *histogram) {
    enum { ROWS = 16, BAR = 60, PER_ROW = ISO_HISTOGRAM_BINS / ROWS };
    uint64_t counts[ROWS] = {0}, most = 1;
    for (int i = 0; i < ISO_HISTOGRAM_BINS; i++) counts[i / PER_ROW] += histogram->bins[i];
    for (int row = 0; row < ROWS; row++)
        if (counts[row] > most) most = counts[row];
    for (int row = 0; row < ROWS; row++) {
        int length = (int)ceil(BAR * sqrt((double)counts[row] / (double)most));
        printf("  %-11s %12.6g %-*.*s %llu\n", row ? "" : "histogram",
               histogram->low + row * PER_ROW * histogram->width, BAR, length,
               "############################################################",
               (unsigned long long)counts[row]);
    }
}

static void print_isovalues(const iso_loader *loader) {
    const size_t count = loader->candidate_count;
    printf("  %-11s ", "isovalues");
    if (count == 0) printf("none: the volume is constant");
    for (size_t i = 0; i < count; i++) printf("%s%.6g", i ? ", " : "", loader->candidates[i]);
    if (count > 0)
        printf(iso_grid_is_level_set(&loader->volume.grid) ? " (level set)"
                                                           : " (Otsu; then two of three classes)");
    printf("\n");
}

/* What the voxels say. */
static void print_values(const iso_loader *loader) {
    if (loader->nonfinite)
        printf("  %-11s %zu voxels are NaN or infinite\n", "not finite", loader->nonfinite);
    if (!loader->has_histogram) {
        printf("  %-11s none: no voxel is finite\n", "range");
        return;
    }
    const iso_histogram *histogram = &loader->histogram;
    printf("  %-11s %.10g .. %.10g\n", "range", histogram->minimum, histogram->maximum);
    if (histogram->padding)
        printf("  %-11s %llu voxels of %.10g around the rest, left out below\n", "padding",
               (unsigned long long)histogram->padding, histogram->padding_value);
    if (histogram->low < histogram->high) print_histogram(histogram);
    print_isovalues(loader);
}

/* Of a channel that is not the input's, the file's header has been printed. */
static void print_volume(const isorender_job *job, const iso_loader *loader) {
    char title[ISORENDER_CHANNEL_TITLE];
    if (loader->options->channel)
        printf("%s\n", isorender_channel_title(loader, title));
    else
        print_header(job, loader);
    print_values(loader);
}

void isorender_info_values(const isorender_job *job) {
    if (job->loader.has_points)
        isorender_cloud_info(job);
    else if (!job->settings->no_input)
        print_values(&job->loader);
    for (int i = 0; i < job->volume_count; i++) print_volume(job, &job->volumes[i]);
    isorender_instances_info(job);
    for (int i = 0; i < job->object_count; i++) isorender_object_info(&job->objects[i]);
}
