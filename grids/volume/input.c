/* Options for reading a volume: parses and checks them, crops volumes, and converts the options to text for a
 * journal. */
#include "grids/volume/input.h"

#include <limits.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "base/parse.h"

/* ---- values of options */

iso_status iso_input_apply_raw(void *settings, const char *value, iso_error *error) {
    iso_input *input = settings;
    ISO_TRY(iso_raw_layout_parse(value, &input->raw, error));
    input->has_raw = 1;
    return ISO_OK;
}

iso_status iso_input_apply_spacing(void *settings, const char *value, iso_error *error) {
    iso_input *input = settings;
    double spacing[3];
    bool good = iso_parse_reals(value, 3, spacing);
    if (!good && iso_parse_real(value, &spacing[0])) {
        spacing[1] = spacing[2] = spacing[0];
        good = true;
    }
    for (int i = 0; good && i < 3; i++) good = spacing[i] > 0;
    if (!good)
        return iso_fail(error, ISO_ERR_USAGE, "'%s' is neither one nor three positive numbers (mm)", value);
    memcpy(input->spacing, spacing, sizeof spacing);
    return ISO_OK;
}

iso_status iso_input_apply_level(void *settings, const char *value, iso_error *error) {
    iso_input *input = settings;
    const bool is_auto = strcmp(value, "auto") == 0;
    if (is_auto) input->level = ISO_LEVEL_AUTO;
    if (is_auto || (iso_parse_int(value, &input->level) && input->level >= 0)) return ISO_OK;
    return iso_fail(error, ISO_ERR_USAGE, "'%s' is neither a level, from 0, nor auto", value);
}

iso_status iso_input_apply_crop(void *settings, const char *value, iso_error *error) {
    iso_input *input = settings;
    double numbers[6];
    bool good = iso_parse_reals(value, 6, numbers);
    for (int i = 0; good && i < 6; i++)
        good = numbers[i] == floor(numbers[i]) && numbers[i] >= 0 && numbers[i] <= INT_MAX;
    for (int i = 0; good && i < 6; i += 2) good = numbers[i] <= numbers[i + 1];
    if (!good)
        return iso_fail(error, ISO_ERR_USAGE,
                        "'%s' is not x0,x1,y0,y1,z0,z1 in voxels, first and last of each", value);
    for (int i = 0; i < 6; i++) input->crop[i] = (int)numbers[i];
    input->cropped = 1;
    return ISO_OK;
}

iso_status iso_input_apply_crop_mm(void *settings, const char *value, iso_error *error) {
    iso_input *input = settings;
    double numbers[6];
    bool good = iso_parse_reals(value, 6, numbers);
    for (int i = 0; good && i < 6; i += 2) good = numbers[i] <= numbers[i + 1];
    if (!good)
        return iso_fail(error, ISO_ERR_USAGE,
                        "'%s' is not x0,x1,y0,y1,z0,z1 in mm, lowest and highest of each", value);
    memcpy(input->crop_mm, numbers, sizeof numbers);
    input->cropped_mm = 1;
    return ISO_OK;
}

iso_status iso_input_check(const iso_input *input, iso_error *error) {
    if (input->label_table && !input->label)
        return iso_fail(error, ISO_ERR_USAGE, "--label-table is for --label, which is not given");
    if (!input->cropped || !input->cropped_mm) return ISO_OK;
    return iso_fail(error, ISO_ERR_USAGE, "--crop and --crop-mm cannot be combined");
}

const char *iso_input_volume_option(const iso_input *input) {
    if (input->has_raw) return "--raw";
    if (input->spacing[0] > 0) return "--spacing";
    if (input->grid) return "--grid";
    if (input->series) return "--series";
    if (input->component) return "--component";
    if (input->label || input->label_table) return input->label ? "--label" : "--label-table";
    if (input->level) return "--level";
    if (input->cropped) return "--crop";
    return input->cropped_mm ? "--crop-mm" : NULL;
}

/* ---- reading */

iso_volume_opts iso_input_volume_opts(const iso_input *input) {
    return (iso_volume_opts){.grid = input->grid,
                             .series = input->series,
                             .component = input->component,
                             .by_channel = input->channel != NULL,
                             .level = input->level,
                             .raw = input->has_raw ? &input->raw : NULL,
                             .spacing = {input->spacing[0], input->spacing[1], input->spacing[2]},
                             .max_memory = input->max_memory};
}

/* Returns the range of index coordinates, along each axis, of a box in world mm. */
static iso_box index_box(const double mm[6], const iso_transform *transform) {
    const iso_affine affine = iso_transform_affine(transform);
    const iso_box world = {{mm[0], mm[2], mm[4]}, {mm[1], mm[3], mm[5]}};
    iso_box index = iso_box_empty();
    for (int corner = 0; corner < 8; corner++)
        iso_box_add(&index, iso_affine_point_to_index(&affine, iso_box_corner(&world, corner)));
    return index;
}

/* Fails with a message that shows both boxes in the order of the option's values, so that the user can
 * compare them. */
static iso_status fail_without_voxel(const double mm[6], const int dims[3], const iso_transform *transform,
                                     iso_error *error) {
    const iso_affine affine = iso_transform_affine(transform);
    const iso_box index = {.hi = {dims[0] - 1, dims[1] - 1, dims[2] - 1}},
                  volume = iso_box_transform(&index, &affine);
    return iso_fail(error, ISO_ERR_USAGE,
                    "no voxel lies in --crop-mm %g,%g,%g,%g,%g,%g: the volume's are in %g,%g,%g,%g,%g,%g mm",
                    mm[0], mm[1], mm[2], mm[3], mm[4], mm[5], volume.lo.x, volume.hi.x, volume.lo.y,
                    volume.hi.y, volume.lo.z, volume.hi.z);
}

static iso_status box_of_mm(const iso_input *input, const int dims[3], const iso_transform *transform,
                            int box[6], iso_error *error) {
    const double rounding = 1e-6; /* voxels; a position that lies outside the box only by rounding counts as
                                     inside */
    const iso_box index = index_box(input->crop_mm, transform);
    const double low[3] = {index.lo.x, index.lo.y, index.lo.z},
                 high[3] = {index.hi.x, index.hi.y, index.hi.z};
    for (int axis = 0; axis < 3; axis++) {
        const double first = fmax(ceil(low[axis] - rounding), 0);
        const double last = fmin(floor(high[axis] + rounding), dims[axis] - 1);
        if (!(first <= last)) return fail_without_voxel(input->crop_mm, dims, transform, error);
        box[2 * axis] = (int)first;
        box[2 * axis + 1] = (int)last;
    }
    return ISO_OK;
}

iso_status iso_input_box(const iso_input *input, const int dims[3], const iso_transform *transform,
                         int box[6], iso_error *error) {
    if (input->cropped_mm) return box_of_mm(input, dims, transform, box, error);
    for (int axis = 0; axis < 3; axis++) {
        box[2 * axis] = input->cropped ? input->crop[2 * axis] : 0;
        box[2 * axis + 1] = input->cropped ? input->crop[2 * axis + 1] : dims[axis] - 1;
        if (box[2 * axis + 1] >= dims[axis])
            return iso_fail(error, ISO_ERR_USAGE, "--crop reaches outside: there are %d x %d x %d voxels",
                            dims[0], dims[1], dims[2]);
    }
    return ISO_OK;
}

iso_status iso_input_crop(const iso_input *input, const int box[6], iso_grid *grid, iso_error *error) {
    const int lo[3] = {box[0], box[2], box[4]}, hi[3] = {box[1], box[3], box[5]};
    if (!input->cropped && !input->cropped_mm) return ISO_OK;
    if (grid->rgrid) return iso_rgrid_crop(grid->rgrid, lo, hi, error);
    iso_hgrid *cropped = NULL;
    ISO_TRY(iso_hgrid_crop(grid->hgrid, lo, hi, &cropped, error));
    iso_hgrid_destroy(grid->hgrid);
    grid->hgrid = cropped;
    return ISO_OK;
}

iso_status iso_input_read(const char *path, const iso_input *input, const iso_volume_opts *opts,
                          iso_volume *volume, iso_error *error) {
    iso_volume_opts how = iso_input_volume_opts(input);
    how.files = opts->files;
    how.pool = opts->pool;
    how.count_values = opts->count_values;
    how.progress = opts->progress;
    how.progress_context = opts->progress_context;
    ISO_TRY(iso_volume_read(path, &how, volume, error));
    int box[6];
    iso_error reason = {0};
    iso_status status =
        iso_input_box(input, iso_grid_dims(&volume->grid), iso_grid_transform(&volume->grid), box, &reason);
    if (status == ISO_OK) status = iso_input_crop(input, box, &volume->grid, &reason);
    if (status == ISO_OK) return ISO_OK;
    iso_volume_free(volume);
    return iso_fail(error, status, "%s: %s", path, reason.text);
}

bool iso_input_drops_parts(const iso_input *input) {
    return input->largest > 0 || input->min_size > 0;
}

/* ---- as text */

typedef struct writer {
    char *text;
    size_t room, used; /* size of `text`; length of the text, more than `room` if it did not fit */
} writer;

#if defined(__GNUC__)
__attribute__((format(printf, 2, 3)))
#endif
static void
put(writer *w, const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    const bool fits = w->used < w->room;
    const int length =
        vsnprintf(fits ? w->text + w->used : NULL, fits ? w->room - w->used : 0, format, arguments);
    va_end(arguments);
    w->used += (size_t)length;
}

static void put_reals(writer *w, const char *name, const double *values, int count) {
    put(w, "%s=", name);
    for (int i = 0; i < count; i++) put(w, "%s%.17g", i ? "," : "", values[i]);
    put(w, "\n");
}

static iso_status put_name(writer *w, const char *name, const char *value, iso_error *error) {
    if (!value) return ISO_OK;
    if (strpbrk(value, "\n\r"))
        return iso_fail(error, ISO_ERR_USAGE, "--%s: a stroke file cannot keep a name with line breaks",
                        name);
    put(w, "%s=%s\n", name, value);
    return ISO_OK;
}

iso_status iso_input_write(const iso_input *input, char *text, size_t room, iso_error *error) {
    writer w = {text, room, 0};
    const iso_raw_layout *raw = &input->raw;
    text[0] = 0;
    if (input->has_raw)
        put(&w, "raw=%dx%dx%d:%s:%s:%llu\n", raw->dims[0], raw->dims[1], raw->dims[2],
            iso_raw_layout_type_name(raw), raw->big_endian ? "big" : "little",
            (unsigned long long)raw->offset);
    if (input->spacing[0] > 0) put_reals(&w, "spacing", input->spacing, 3);
    ISO_TRY(put_name(&w, "grid", input->grid, error));
    ISO_TRY(put_name(&w, "series", input->series, error));
    if (input->component) put(&w, "component=%d\n", input->component);
    if (input->level) put(&w, "level=%d\n", input->level);
    const int *c = input->crop;
    if (input->cropped) put(&w, "crop=%d,%d,%d,%d,%d,%d\n", c[0], c[1], c[2], c[3], c[4], c[5]);
    if (input->cropped_mm) put_reals(&w, "crop-mm", input->crop_mm, 6);
    ISO_TRY(put_name(&w, "label", input->label, error));
    if (input->largest) put(&w, "largest=%d\n", input->largest);
    if (input->min_size > 0) put_reals(&w, "min-size", &input->min_size, 1);
    if (w.used >= room)
        return iso_fail(error, ISO_ERR_USAGE, "the options for reading are too long for a stroke file");
    return ISO_OK;
}

static iso_status apply_component(void *settings, const char *value, iso_error *error) {
    int *component = &((iso_input *)settings)->component;
    if (iso_parse_int(value, component) && *component >= 0) return ISO_OK;
    return iso_fail(error, ISO_ERR_FORMAT, "'%s' is not the number of a component", value);
}

static iso_status apply_largest(void *settings, const char *value, iso_error *error) {
    int *largest = &((iso_input *)settings)->largest;
    if (iso_parse_int(value, largest) && *largest > 0) return ISO_OK;
    return iso_fail(error, ISO_ERR_FORMAT, "'%s' is not a number of parts", value);
}

static iso_status apply_min_size(void *settings, const char *value, iso_error *error) {
    double *size = &((iso_input *)settings)->min_size;
    if (iso_parse_real(value, size) && *size >= 0) return ISO_OK;
    return iso_fail(error, ISO_ERR_FORMAT, "'%s' is not a volume in mm3", value);
}

static iso_status apply_grid(void *settings, const char *value, iso_error *error) {
    (void)error;
    ((iso_input *)settings)->grid = value;
    return ISO_OK;
}

static iso_status apply_label(void *settings, const char *value, iso_error *error) {
    int label;
    ((iso_input *)settings)->label = value;
    if (iso_parse_int(value, &label) && label > 0) return ISO_OK;
    return iso_fail(error, ISO_ERR_FORMAT, "'%s' is not the number of a label", value);
}

static iso_status apply_series(void *settings, const char *value, iso_error *error) {
    (void)error;
    ((iso_input *)settings)->series = value;
    return ISO_OK;
}

/* Applies a line of iso_input_write. */
static iso_status apply_line(iso_input *input, const char *name, const char *value, iso_error *error) {
    static const struct {
        const char *name;
        iso_status (*apply)(void *settings, const char *value, iso_error *error);
    } options[] = {{"raw", iso_input_apply_raw},
                   {"spacing", iso_input_apply_spacing},
                   {"grid", apply_grid},
                   {"series", apply_series},
                   {"component", apply_component},
                   {"label", apply_label},
                   {"level", iso_input_apply_level},
                   {"crop", iso_input_apply_crop},
                   {"largest", apply_largest},
                   {"crop-mm", iso_input_apply_crop_mm},
                   {"min-size", apply_min_size}};
    iso_error reason = {0};
    for (size_t i = 0; i < sizeof options / sizeof *options; i++)
        if (strcmp(name, options[i].name) == 0) {
            if (options[i].apply(input, value, &reason) == ISO_OK) return ISO_OK;
            return iso_fail(error, ISO_ERR_FORMAT, "how its source is read: %s: %s", name, reason.text);
        }
    return iso_fail(error, ISO_ERR_FORMAT, "how its source is read: there is no option '%s'", name);
}

iso_status iso_input_parse(char *text, iso_input *input, iso_error *error) {
    *input = (iso_input){0};
    while (*text) {
        char *end = strchr(text, '\n'), *equals = strchr(text, '=');
        if (!end || !equals || equals > end)
            return iso_fail(error, ISO_ERR_FORMAT, "how its source is read: '%.40s' is no option", text);
        *end = *equals = 0;
        ISO_TRY(apply_line(input, text, equals + 1, error));
        text = end + 1;
    }
    iso_error reason = {0};
    if (iso_input_check(input, &reason) == ISO_OK) return ISO_OK;
    return iso_fail(error, ISO_ERR_FORMAT, "how its source is read: %s", reason.text);
}
