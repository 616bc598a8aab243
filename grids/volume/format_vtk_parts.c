/* format_vtk_parts: VTK's XML files that name other files: parallel image data (.pvti), whose pieces are put
 * together; collections of ParaView (.pvd), whose times are components; and blocks (.vtm), of which one is
 * read: FILE.vtm:/BLOCK, or FILE.vtm:/BLOCK/ARRAY.
 *
 * A piece's extent has its ghost points, which lie over those of its neighbours. */
#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/file_types.h"
#include "grids/volume/vtk_xml.h"

enum { MOST_TEXT = 16 << 20, MOST_PARTS = 100000 };

typedef struct part {
    char file[ISO_XML_TEXT], name[ISO_VTK_NAME];
    double time;
    int extent[6];
} part;

typedef struct parts {
    const char *path;
    iso_file_type type;
    char *text;
    iso_buffer buffer; /* of part */
    size_t count;
    /* Of .pvti. */
    int whole[6];
    bool has_whole;
    enum { NOTHING, POINT_DATA, CELL_DATA } in;
    char active[ISO_XML_TEXT];
    double origin[3], spacing[3], direction[9];
    iso_format_array arrays[ISO_VOLUME_ITEMS];
    int array_count;
} parts;

static part *part_of(const parts *p, size_t i) {
    return (part *)p->buffer.data + i;
}

static iso_status bad(const parts *p, const char *what, iso_error *error) {
    return iso_fail(error, ISO_ERR_FORMAT, "%s: not a readable .%s file: %s", p->path,
                    iso_file_type_name(p->type), what);
}

/* ---- the text */

static bool read_numbers(const iso_xml_tag *t, const char *name, int count, double *numbers) {
    char text[ISO_XML_TEXT], *at = text, *end;
    if (!iso_xml_attribute(t, name, text)) return true;
    for (int i = 0; i < count; i++, at = end) {
        numbers[i] = strtod(at, &end);
        if (end == at || !isfinite(numbers[i])) return false;
    }
    return at[strspn(at, " \t\r\n")] == 0;
}

static iso_status take_image(parts *p, const iso_xml_tag *t, iso_error *error) {
    char text[ISO_XML_TEXT];
    p->has_whole = iso_xml_attribute(t, "WholeExtent", text) && iso_vtk_xml_extent(text, p->whole);
    if (!p->has_whole) return bad(p, "its WholeExtent is not six whole numbers", error);
    return read_numbers(t, "Origin", 3, p->origin) && read_numbers(t, "Spacing", 3, p->spacing) &&
                   read_numbers(t, "Direction", 9, p->direction)
               ? ISO_OK
               : bad(p, "its Origin, Spacing or Direction are no numbers", error);
}

static iso_status take_array(parts *p, const iso_xml_tag *t, iso_error *error) {
    char text[ISO_XML_TEXT];
    iso_format_array array = {.tuples = 1, .cells = p->in == CELL_DATA};
    if (p->in == NOTHING || !p->has_whole || p->array_count == ISO_VOLUME_ITEMS ||
        !iso_xml_attribute(t, "type", text) || !iso_vtk_xml_type(text, &array.scalar) ||
        !iso_xml_attribute(t, "Name", text) || strlen(text) >= sizeof array.name)
        return ISO_OK;
    strcpy(array.name, text);
    array.active = !array.cells && strcmp(text, p->active) == 0;
    for (int i = 0; i < 3; i++) {
        const uint64_t points = (uint64_t)((int64_t)p->whole[2 * i + 1] - p->whole[2 * i] + 1);
        if (__builtin_mul_overflow(array.tuples, points - (array.cells && points > 1), &array.tuples))
            return bad(p, "its WholeExtent is larger than any image", error);
    }
    const iso_vtk_xml xml = {.path = p->path};
    ISO_TRY(iso_vtk_xml_count(&xml, t, "NumberOfComponents", 1, &array.components, error));
    p->arrays[p->array_count++] = array;
    return ISO_OK;
}

/* A file may name those of a lower rank, so that lists of lists end; 0: none names it. */
static int rank_of(iso_file_type type) {
    switch (type) {
    case ISO_FILE_pvd:
        return 4;
    case ISO_FILE_vtm:
        return 3;
    case ISO_FILE_pvti:
        return 2;
    case ISO_FILE_vti:
    case ISO_FILE_vtr:
    case ISO_FILE_vtk:
        return 1;
    default:
        return 0;
    }
}

static iso_status take_part(parts *p, const iso_xml_tag *t, const char *attribute, iso_error *error) {
    char text[ISO_XML_TEXT];
    part new = {.time = 0};
    if (!iso_xml_attribute(t, attribute, new.file)) return ISO_OK; /* an empty block */
    if (strlen(new.file) == ISO_XML_TEXT - 1) return bad(p, "the name of a file is too long", error);
    if (!read_numbers(t, "timestep", 1, &new.time)) return bad(p, "a timestep is no number", error);
    if (iso_xml_attribute(t, "name", text)) memcpy(new.name, text, sizeof new.name - 1);
    if (p->type == ISO_FILE_pvti) {
        bool in = iso_xml_attribute(t, "Extent", text) && iso_vtk_xml_extent(text, new.extent);
        for (int a = 0; in && a < 6; a += 2)
            in = new.extent[a] >= p->whole[a] && new.extent[a + 1] <= p->whole[a + 1];
        if (!p->has_whole || !in) return bad(p, "a piece lies outside the image's extent", error);
    }
    if (p->count == MOST_PARTS) return bad(p, "it names more than 100000 files", error);
    if (iso_buffer_reserve(&p->buffer, (p->count + 1) * sizeof new, p->count * sizeof new, NULL) != ISO_OK)
        return iso_fail_memory(error, p->path);
    *part_of(p, p->count++) = new;
    return ISO_OK;
}

static iso_status take_tag(parts *p, const iso_xml_tag *t, iso_error *error) {
    if (p->type != ISO_FILE_pvti) return iso_xml_is(t, "DataSet") ? take_part(p, t, "file", error) : ISO_OK;
    if (iso_xml_is(t, "PImageData")) return take_image(p, t, error);
    if (iso_xml_is(t, "Piece")) return take_part(p, t, "Source", error);
    if (iso_xml_is(t, "PDataArray")) return take_array(p, t, error);
    if (iso_xml_is(t, "PPointData")) {
        p->in = POINT_DATA;
        iso_xml_attribute(t, "Scalars", p->active);
    } else if (iso_xml_is(t, "PCellData")) {
        p->in = CELL_DATA;
    } else if (iso_xml_is(t, "/PPointData") || iso_xml_is(t, "/PCellData")) {
        p->in = NOTHING;
    }
    return ISO_OK;
}

static iso_status read_text(parts *p, iso_error *error) {
    size_t bytes;
    ISO_TRY(iso_format_load_text(p->path, MOST_TEXT, &p->text, &bytes, error));
    iso_xml xml = {p->text, p->text + bytes};
    iso_xml_tag t = {p->text, p->text};
    while (iso_xml_next(&xml, &t)) ISO_TRY(take_tag(p, &t, error));
    if (!iso_xml_is(&t, "/VTKFile"))
        return iso_fail(error, ISO_ERR_IO, "%s: truncated: it does not end with </VTKFile>", p->path);
    return p->count ? ISO_OK : bad(p, "it names no file", error);
}

static void close_parts(parts *p) {
    iso_free(p->text);
    iso_buffer_free(&p->buffer);
}

static iso_status open_parts(const char *path, iso_file_type type, parts *p, iso_error *error) {
    *p = (parts){.path = path, .type = type, .spacing = {1, 1, 1}, .direction = {1, 0, 0, 0, 1, 0, 0, 0, 1}};
    const iso_status status = read_text(p, error);
    if (status != ISO_OK) close_parts(p);
    return status;
}

/* ---- files that are named */

/* The path of a part's file (free). ISO_ERR_FORMAT: its type cannot be a part of this one. */
static iso_status find_file(const parts *p, const part *of, char **file, iso_error *error) {
    char *path = iso_format_beside(p->path, of->file);
    if (!path) return iso_fail_memory(error, p->path);
    const int rank = rank_of(iso_file_type_find(path, ISO_HOLDS_VOLUME));
    if (rank > 0 && rank < rank_of(p->type)) {
        *file = path;
        return ISO_OK;
    }
    FILE *stream;
    iso_status status = iso_file_open(path, &stream, NULL, error);
    if (status == ISO_OK) {
        fclose(stream);
        status = iso_format_not_image(path, "grid of another kind", error);
    }
    free(path);
    return status;
}

/* The header of a part, as that of this file. */
static iso_status describe_part(const parts *p, const part *of, const iso_volume_opts *opts,
                                iso_volume_info *info, iso_format_place *place, iso_error *error) {
    char *file, format[sizeof info->format];
    ISO_TRY(find_file(p, of, &file, error));
    memcpy(format, info->format, sizeof format);
    const iso_status status = iso_volume_find_place(file, opts, info, place, error);
    memcpy(info->format, format, sizeof format);
    if (status == ISO_OK && place->known && !*place->file) {
        if (snprintf(place->file, sizeof place->file, "%s", file) >= (int)sizeof place->file)
            place->known = false;
    }
    free(file);
    return status;
}

static iso_status read_part(const parts *p, const part *of, const iso_volume_opts *opts, iso_volume *volume,
                            iso_error *error) {
    char *file;
    ISO_TRY(find_file(p, of, &file, error));
    const iso_status status = iso_volume_read(file, opts, volume, error);
    free(file);
    return status;
}

/* ---- one of several */

static bool is_block(const char *text, const char *name, const char **rest) {
    const size_t length = strlen(name);
    if (!length || strncmp(text, name, length) != 0 || (text[length] && text[length] != '/')) return false;
    *rest = text[length] ? text + length + 1 : NULL;
    return true;
}

/* A block's name or, if it has none, its number. */
static const char *name_of(const parts *p, size_t i, char number[24]) {
    snprintf(number, 24, "%zu", i);
    return *part_of(p, i)->name ? part_of(p, i)->name : number;
}

/* Finds the block that --grid /BLOCK[/ARRAY] names, or the first; opts->grid becomes the array's name. */
static iso_status choose_block(const parts *p, iso_volume_opts *opts, size_t *chosen, iso_error *error) {
    char names[400] = "", number[24];
    *chosen = 0;
    if (!opts->grid || opts->grid[0] != '/') return ISO_OK;
    for (size_t i = 0; i < p->count; i++) {
        snprintf(number, sizeof number, "%zu", i);
        if (is_block(opts->grid + 1, part_of(p, i)->name, &opts->grid) ||
            is_block(opts->grid + 1, number, &opts->grid)) {
            *chosen = i;
            return ISO_OK;
        }
        const size_t used = strlen(names);
        if (used < sizeof names - ISO_VTK_NAME - 4)
            snprintf(names + used, sizeof names - used, "%s/%s", i ? ", " : "", name_of(p, i, number));
    }
    return iso_fail(error, ISO_ERR_USAGE, "%s: no block '%.80s', there %s %s", p->path, opts->grid,
                    p->count == 1 ? "is" : "are", names);
}

/* Of .pvd: the number of times, each of which begins with `first`'s part, or the part where time `wanted`
 * begins. */
static size_t find_time(const parts *p, size_t wanted, size_t *first) {
    size_t times = 0;
    for (size_t i = 0; i < p->count; i++) {
        if (i && part_of(p, i)->time == part_of(p, i - 1)->time) continue;
        if (times++ == wanted) *first = i;
    }
    return times;
}

/* Chooses the part and its component: component c of the file is component c % n of time c / n. */
static iso_status choose_time(const parts *p, const iso_volume_opts *given, iso_volume_opts *opts,
                              iso_volume_info *info, size_t *chosen, iso_error *error) {
    iso_volume_info first = *info;
    iso_format_place place = {0};
    const size_t times = find_time(p, 0, chosen);
    opts->component = 0;
    ISO_TRY(describe_part(p, part_of(p, *chosen), opts, &first, &place, error));
    const uint64_t all = (uint64_t)first.components * times;
    ISO_TRY(iso_format_component(p->path, given, all > INT_MAX ? 0 : (int)all, info, error));
    opts->component = info->component % first.components;
    find_time(p, (size_t)(info->component / first.components), chosen);
    return ISO_OK;
}

/* Which part is read, and with which options. */
static iso_status choose(const parts *p, const iso_volume_opts *given, iso_volume_opts *opts,
                         iso_volume_info *info, size_t *chosen, iso_error *error) {
    *opts = *given;
    opts->raw = NULL;
    opts->mappable = NULL;
    return p->type == ISO_FILE_pvd ? choose_time(p, given, opts, info, chosen, error)
                                   : choose_block(p, opts, chosen, error);
}

static iso_status describe_one(const parts *p, const iso_volume_opts *given, iso_volume_info *info,
                               iso_error *error) {
    iso_volume_opts opts;
    size_t chosen = 0;
    iso_volume_info all = *info;
    ISO_TRY(choose(p, given, &opts, &all, &chosen, error));
    const part *of = part_of(p, chosen);
    iso_format_place place = {0};
    ISO_TRY(describe_part(p, of, &opts, info, &place, error));
    if (p->type == ISO_FILE_pvd) {
        place.components = info->components;
        place.component = info->component;
        if (all.components != info->components && !given->component_axes)
            iso_volume_note(info, "time %g: using component %d of %d (--component; --series-of draws all)",
                            of->time, all.component, all.components);
        info->components = all.components;
        info->component = all.component;
        const size_t next = chosen + 1;
        if (next < p->count && part_of(p, next)->time == of->time)
            iso_volume_note(info, "a time has several files: using the first (%.80s)", of->file);
    } else if (p->count > 1) {
        char number[24];
        iso_volume_note(info, "several blocks: using /%s of %zu (FILE.vtm:/BLOCK)",
                        name_of(p, chosen, number), p->count);
        info->item_count = 0;
        for (size_t i = 0; i < p->count && i < ISO_VOLUME_ITEMS; i++)
            snprintf(info->items[info->item_count++], ISO_VOLUME_TEXT, "/%s: %.100s", name_of(p, i, number),
                     part_of(p, i)->file);
    }
    if (place.known) *given->place = place;
    return ISO_OK;
}

static iso_status info_of_one(const char *path, iso_file_type type, const iso_volume_opts *opts,
                              iso_volume_info *info, iso_error *error) {
    parts p;
    ISO_TRY(open_parts(path, type, &p, error));
    const iso_status status = describe_one(&p, opts, info, error);
    close_parts(&p);
    return status;
}

static iso_status read_one(const char *path, iso_file_type type, const iso_volume_opts *given,
                           iso_volume_info *info, iso_grid *grid, iso_error *error) {
    parts p;
    iso_volume_opts opts;
    iso_volume volume;
    iso_volume_info all = *info;
    size_t chosen = 0;
    ISO_TRY(open_parts(path, type, &p, error));
    iso_status status = choose(&p, given, &opts, &all, &chosen, error);
    if (status == ISO_OK) status = read_part(&p, part_of(&p, chosen), &opts, &volume, error);
    if (status == ISO_OK) *grid = volume.grid;
    close_parts(&p);
    return status;
}

static iso_status pvd_info(const char *path, const iso_volume_opts *opts, iso_volume_info *info,
                           iso_error *error) {
    return info_of_one(path, ISO_FILE_pvd, opts, info, error);
}

static iso_status pvd_read(const char *path, const iso_volume_opts *opts, iso_volume_info *info,
                           iso_grid *grid, iso_error *error) {
    return read_one(path, ISO_FILE_pvd, opts, info, grid, error);
}

static iso_status vtm_info(const char *path, const iso_volume_opts *opts, iso_volume_info *info,
                           iso_error *error) {
    return info_of_one(path, ISO_FILE_vtm, opts, info, error);
}

static iso_status vtm_read(const char *path, const iso_volume_opts *opts, iso_volume_info *info,
                           iso_grid *grid, iso_error *error) {
    return read_one(path, ISO_FILE_vtm, opts, info, grid, error);
}

/* ---- pieces of an image */

static iso_status describe_image(const parts *p, const iso_volume_opts *opts, iso_volume_info *info,
                                 int *chosen, iso_error *error) {
    iso_format_image image = {.arrays = p->arrays, .count = p->array_count};
    iso_transform *t = &info->transform;
    for (int axis = 0; axis < 3; axis++) {
        image.points[axis] = (uint64_t)((int64_t)p->whole[2 * axis + 1] - p->whole[2 * axis] + 1);
        t->spacing[axis] = fabs(p->spacing[axis]);
        t->origin[axis] += p->origin[axis];
        for (int i = 0; i < 3; i++) {
            t->direction[3 * i + axis] = p->direction[3 * i + axis] * (p->spacing[axis] < 0 ? -1 : 1);
            t->origin[i] += p->whole[2 * axis] * t->spacing[axis] * t->direction[3 * i + axis];
        }
    }
    ISO_TRY(iso_format_take_array(p->path, opts, &image, info, chosen, error));
    uint64_t largest = 0;
    for (size_t i = 0; i < p->count; i++) {
        int dims[3];
        for (int axis = 0; axis < 3; axis++)
            dims[axis] = part_of(p, i)->extent[2 * axis + 1] - part_of(p, i)->extent[2 * axis] + 1;
        const uint64_t bytes = iso_format_size(dims, 2 * p->arrays[*chosen].components *
                                                         iso_scalar_size(p->arrays[*chosen].scalar));
        if (bytes > largest) largest = bytes;
    }
    info->read_bytes = iso_format_size(info->dims, iso_type_size(info->type));
    if (__builtin_add_overflow(info->read_bytes, largest, &info->read_bytes)) info->read_bytes = UINT64_MAX;
    return ISO_OK;
}

/* The voxels of a piece: of cells, those up to the last but one point. */
static void voxels_of(const part *piece, const int whole[6], bool cells, int box[6]) {
    for (int a = 0; a < 6; a += 2) {
        box[a] = piece->extent[a];
        box[a + 1] = piece->extent[a + 1] - (cells && whole[a + 1] > whole[a]);
    }
}

static iso_status check_cover(const parts *p, bool cells, iso_error *error) {
    part whole;
    int box[6], *boxes = iso_alloc(p->count * sizeof box);
    if (!boxes) return iso_fail_memory(error, p->path);
    for (size_t i = 0; i < p->count; i++) voxels_of(part_of(p, i), p->whole, cells, boxes + 6 * i);
    memcpy(whole.extent, p->whole, sizeof whole.extent);
    voxels_of(&whole, p->whole, cells, box);
    const bool covered = iso_vti_covered(box, boxes, p->count);
    iso_free(boxes);
    return covered
               ? ISO_OK
               : iso_fail(error, ISO_ERR_IO, "%s: truncated: its pieces do not cover its extent", p->path);
}

static iso_status pvti_info(const char *path, const iso_volume_opts *opts, iso_volume_info *info,
                            iso_error *error) {
    parts p;
    int chosen = 0;
    ISO_TRY(open_parts(path, ISO_FILE_pvti, &p, error));
    for (size_t i = 0; opts->files && i < p.count; i++) {
        char *file = iso_format_beside(path, part_of(&p, i)->file);
        if (file) iso_file_set_read(opts->files, file);
        free(file);
    }
    iso_status status = describe_image(&p, opts, info, &chosen, error);
    if (status == ISO_OK) status = check_cover(&p, p.arrays[chosen].cells, error);
    close_parts(&p);
    return status;
}

/* Reads a piece and copies its voxels to their place. */
static iso_status add_piece(const parts *p, const part *piece, const iso_volume_opts *opts, bool cells,
                            iso_rgrid *to, iso_error *error) {
    iso_volume volume;
    int box[6];
    voxels_of(piece, p->whole, cells, box);
    if (box[1] < box[0] || box[3] < box[2] || box[5] < box[4]) return ISO_OK; /* points only, without cells */
    ISO_TRY(read_part(p, piece, opts, &volume, error));
    const iso_rgrid *from = volume.grid.rgrid;
    bool same = from && from->type == to->type;
    for (int axis = 0; same && axis < 3; axis++)
        same = from->dims[axis] == box[2 * axis + 1] - box[2 * axis] + 1;
    const size_t size = iso_type_size(to->type);
    for (int z = box[4]; same && z <= box[5]; z++)
        for (int y = box[2]; y <= box[3]; y++) {
            const ptrdiff_t target = (box[0] - p->whole[0]) + (y - p->whole[2]) * to->stride_y +
                                     (z - p->whole[4]) * to->stride_z,
                            source = (y - box[2]) * from->stride_y + (z - box[4]) * from->stride_z;
            memcpy((char *)to->data + target * (ptrdiff_t)size,
                   (const char *)from->data + source * (ptrdiff_t)size, (size_t)from->dims[0] * size);
        }
    iso_volume_free(&volume);
    return same ? ISO_OK
                : iso_fail(error, ISO_ERR_FORMAT, "%s: its piece %s has another extent or type than it says",
                           p->path, piece->file);
}

static iso_status read_pieces(const parts *p, const iso_volume_opts *given, iso_volume_info *info,
                              iso_grid *grid, iso_error *error) {
    iso_volume_info now = {.transform = iso_transform_identity()};
    iso_volume_opts opts = *given;
    int chosen = 0;
    ISO_TRY(describe_image(p, given, &now, &chosen, error));
    ISO_TRY(check_cover(p, p->arrays[chosen].cells, error));
    if (memcmp(now.dims, info->dims, sizeof now.dims) != 0 || now.type != info->type)
        return iso_fail(error, ISO_ERR_IO, "%s: changed while it was read", p->path);
    opts.grid = p->arrays[chosen].name;
    opts.raw = NULL;
    opts.mappable = NULL;
    opts.mapped = opts.count_values = false;
    opts.progress = NULL;
    memset(opts.spacing, 0, sizeof opts.spacing);
    ISO_TRY(iso_format_create(p->path, info, NULL, grid, error));
    iso_status status = ISO_OK;
    for (size_t i = 0; i < p->count && status == ISO_OK; i++) {
        status = add_piece(p, part_of(p, i), &opts, p->arrays[chosen].cells, grid->rgrid, error);
        if (status == ISO_OK)
            status = iso_format_progress(p->path, given, (double)(i + 1) / (double)p->count, error);
    }
    if (status != ISO_OK) iso_grid_destroy(grid);
    return status;
}

static iso_status pvti_read(const char *path, const iso_volume_opts *opts, iso_volume_info *info,
                            iso_grid *grid, iso_error *error) {
    parts p;
    ISO_TRY(open_parts(path, ISO_FILE_pvti, &p, error));
    const iso_status status = read_pieces(&p, opts, info, grid, error);
    close_parts(&p);
    return status;
}

const iso_format iso_format_pvti = {"pvti", "isopoint", NULL, pvti_info, pvti_read, NULL};
const iso_format iso_format_pvd = {"pvd", "isopoint", NULL, pvd_info, pvd_read, NULL};
const iso_format iso_format_vtm = {"vtm", "isopoint", NULL, vtm_info, vtm_read, NULL};
