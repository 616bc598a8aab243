/* format_jpeg: reads a folder of JPEG files, a slice each (grids/volume/image_stack.h): greys, and colours as
 * components. Their density is ignored, because cameras and programs state 72 dots an inch of anything, and
 * so is how a camera was held. */
#include "base/jpeg_reader.h"
#include "grids/volume/image_stack.h"

static iso_status open_slice(const char *path, iso_jpeg **jpeg, iso_image_header *header, iso_error *error) {
    iso_jpeg_header is;
    ISO_TRY(iso_jpeg_open(path, jpeg, &is, error));
    *header = (iso_image_header){
        .layout = {is.width, is.height, ISO_SCALAR_UINT8, is.samples},
        .scratch = is.scratch,
        .note = "JPEG does not keep values: they are as far off as its compression was strong"};
    return ISO_OK;
}

static iso_status read_jpeg_header(const char *path, iso_image_header *header, iso_error *error) {
    iso_jpeg *jpeg;
    ISO_TRY(open_slice(path, &jpeg, header, error));
    iso_jpeg_close(jpeg);
    return ISO_OK;
}

/* Where one component of the pixels goes. */
typedef struct slice {
    const iso_image_layout *layout;
    size_t component;
    uint8_t *values;
} slice;

static void take_row(void *context, uint32_t y, const uint8_t *pixels) {
    const slice *s = context;
    uint8_t *target = s->values + (size_t)s->layout->width * y;
    for (size_t x = 0; x < s->layout->width; x++)
        target[x] = pixels[x * (size_t)s->layout->samples + s->component];
}

static iso_status decode_jpeg(const char *path, const iso_image_layout *expected, uint64_t scratch,
                              int component, void *values, iso_error *error) {
    iso_jpeg *jpeg;
    iso_image_header header;
    slice s = {expected, (size_t)component, values};
    ISO_TRY(open_slice(path, &jpeg, &header, error));
    iso_status status = iso_image_check_unchanged(path, &header, expected, scratch, error);
    if (status == ISO_OK) status = iso_jpeg_read_rows(jpeg, take_row, &s, error);
    iso_jpeg_close(jpeg);
    return status;
}

static const iso_image_codec codec = {ISO_SLICES_JPEG, read_jpeg_header, decode_jpeg};

static iso_status jpeg_info_of(const char *path, const iso_volume_opts *opts, iso_volume_info *info,
                               iso_error *error) {
    return iso_image_stack_info(&codec, path, opts, info, error);
}

static iso_status jpeg_open_tiled(const char *path, const iso_volume_opts *opts, const iso_volume_info *info,
                                  iso_tiled *tiled, iso_error *error) {
    return iso_image_stack_open(&codec, path, opts, info, tiled, error);
}

const iso_format iso_format_jpeg = {
    .name = "jpeg", .library = "libjpeg", .info = jpeg_info_of, .open_tiled = jpeg_open_tiled};
