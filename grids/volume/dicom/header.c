/* header: parses the data set of a DICOM file up to its pixels (PS3.5, sections 7 and 10 and annex A).
 *
 * Every length is checked against the rest of the file before it is used. Only a few dozen elements are read;
 * all others are skipped. */
#include "grids/volume/dicom/dicom.h"

#include <errno.h>
#include <locale.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/memory.h"

/* MAX_FRAMES: more slices than volumes have; each needs about 300 bytes of memory before its pixels are read.
 */
enum { UNDEFINED = -1, MAX_DEPTH = 32, MAX_VALUE = 1 << 20, MAX_FRAMES = 1 << 16 };

#define TAG(group, element) ((uint32_t)(group) << 16 | (element))
#define ITEM TAG(0xfffe, 0xe000)
#define ITEM_END TAG(0xfffe, 0xe00d)
#define SEQUENCE_END TAG(0xfffe, 0xe0dd)
#define PIXEL_DATA TAG(0x7fe0, 0x0010)
#define SHARED_GROUPS TAG(0x5200, 0x9229)
#define PER_FRAME_GROUPS TAG(0x5200, 0x9230)
#define DETECTORS TAG(0x0054, 0x0022)
#define SEGMENTS TAG(0x0062, 0x0002)

/* What the elements that are being parsed describe: the file, all frames, one frame, a segment of a
 * segmentation, or nothing that is used. */
typedef enum scope { FILE_SCOPE, SHARED_SCOPE, FRAME_SCOPE, SEGMENT_SCOPE, OTHER_SCOPE } scope;

typedef struct parser {
    FILE *stream;
    int64_t at, size; /* position in the file; size of the file */
    bool explicit_vr, big_endian;
    locale_t c_locale; /* decimal points whatever the program's locale */
    iso_dicom_file *file;
    char storage[65];       /* SOP class UID: the kind of object */
    iso_dicom_frame common; /* values for all frames */
    double *offsets;        /* positions of frames along the normal (dose grids) */
    size_t offset_count;
    bool cut, corrupt, no_memory;
    char problem[80]; /* message about an element with a wrong value that must not be ignored; "": none */
} parser;

typedef struct element {
    uint32_t tag;
    char vr[3];
    int64_t length; /* or UNDEFINED */
} element;

/* The position of an element in the structure of the data set. */
typedef struct place {
    scope scope;
    int item, depth; /* the number of the frame or segment */
    int64_t end;     /* of the enclosing item or sequence; UNDEFINED: a delimiter ends it */
} place;

static bool parse_set(parser *p, place here);

static bool cut_off(parser *p) {
    p->cut = true;
    return false;
}

static bool is_corrupt(parser *p) {
    p->corrupt = true;
    return false;
}

static bool take_bytes(parser *p, void *bytes, size_t count) {
    if ((int64_t)count > p->size - p->at || fread(bytes, 1, count, p->stream) != count) return cut_off(p);
    p->at += (int64_t)count;
    return true;
}

static bool skip_to(parser *p, int64_t at) {
    if (at > p->size) return cut_off(p);
    if (at < p->at) return is_corrupt(p);
    if (at > p->at && fseeko(p->stream, at, SEEK_SET) != 0) return cut_off(p);
    p->at = at;
    return true;
}

static uint32_t number16(const parser *p, const uint8_t b[2]) {
    return p->big_endian ? (uint32_t)b[0] << 8 | b[1] : (uint32_t)b[1] << 8 | b[0];
}

static uint32_t number32(const parser *p, const uint8_t b[4]) {
    uint32_t first = number16(p, b), second = number16(p, b + 2);
    return p->big_endian ? first << 16 | second : second << 16 | first;
}

/* Whether a value representation has a length of four bytes, after two reserved ones (PS3.5, 7.1.2). */
static bool has_long_length(const char *vr) {
    static const char names[] = "OB OD OF OL OV OW SQ SV UC UN UR UT UV";
    return strstr(names, vr) != NULL;
}

static bool read_element_head(parser *p, element *e) {
    uint8_t b[8];
    if (!take_bytes(p, b, 8)) return false;
    e->tag = TAG(number16(p, b), number16(p, b + 2));
    uint32_t length = number32(p, b + 4);
    strcpy(e->vr, "");
    if (p->explicit_vr && e->tag >> 16 != 0xfffe) {
        e->vr[0] = (char)b[4];
        e->vr[1] = (char)b[5];
        e->vr[2] = 0;
        if (b[4] < 'A' || b[4] > 'Z' || b[5] < 'A' || b[5] > 'Z') return is_corrupt(p);
        if (has_long_length(e->vr)) {
            if (!take_bytes(p, b, 4)) return false;
            length = number32(p, b);
        } else {
            length = number16(p, b + 6);
        }
    }
    e->length = length == UINT32_MAX ? UNDEFINED : (int64_t)length;
    return true;
}

/* ---- values ---- */

/* Reads a value as text, without the blanks around it; release it with free(). NULL without memory or at the
 * end of the file. */
static char *take_text(parser *p, int64_t length) {
    if (length > p->size - p->at) {
        cut_off(p);
        return NULL;
    }
    char *text = malloc((size_t)length + 1);
    if (!text) p->no_memory = true;
    if (!text || !take_bytes(p, text, (size_t)length)) {
        free(text);
        return NULL;
    }
    text[length] = 0;
    return text;
}

static void copy_text(char *target, size_t room, const char *text) {
    while (*text == ' ') text++;
    size_t length = strnlen(text, room - 1);
    while (length && text[length - 1] == ' ') length--;
    memcpy(target, text, length);
    target[length] = 0;
}

/* Parses up to `count` decimal strings, separated by backslashes; returns how many there are. */
static size_t parse_decimals(const parser *p, const char *text, double *values, size_t count) {
    size_t found = 0;
    while (found < count) {
        char *end;
        double value = strtod_l(text, &end, p->c_locale);
        if (end == text || !isfinite(value)) break;
        values[found++] = value;
        while (*end == ' ') end++;
        if (*end != '\\') break;
        text = end + 1;
    }
    return found;
}

static bool parse_integer(const char *text, long *value) {
    char *end;
    errno = 0;
    long parsed = strtol(text, &end, 10);
    if (end == text || errno) return false;
    *value = parsed;
    return true;
}

static bool parse_vector(const parser *p, const char *text, double *values, size_t count) {
    double parsed[6];
    if (parse_decimals(p, text, parsed, count) != count) return false;
    memcpy(values, parsed, count * sizeof *values);
    return true;
}

static bool parse_orientation(const parser *p, const char *text, iso_dicom_frame *frame) {
    double v[6];
    if (parse_decimals(p, text, v, 6) != 6) return false;
    iso_vec3 row = iso_vec3_unit(iso_vec3_make(v[0], v[1], v[2]));
    iso_vec3 column = iso_vec3_unit(iso_vec3_make(v[3], v[4], v[5]));
    if (!(iso_vec3_length(iso_vec3_cross(row, column)) > 0.1)) return false; /* parallel, or zero */
    const double unit[6] = {row.x, row.y, row.z, column.x, column.y, column.z};
    memcpy(frame->orientation, unit, sizeof unit);
    return true;
}

/* Records a wrong value, unless there was an earlier one. A blank value counts as missing, not as wrong. */
static void note_problem(parser *p, const char *name, const char *text) {
    char value[33];
    copy_text(value, sizeof value, text);
    if (*value && !*p->problem)
        snprintf(p->problem, sizeof p->problem, "its %s of '%s' is not possible", name, value);
}

/* Uses a rescale slope or intercept. A value that is not a number, or does not fit into a float, is an error,
 * as it cannot be guessed. */
static void use_rescale(parser *p, const char *name, const char *text, double *target) {
    double value = 0;
    if (parse_vector(p, text, &value, 1) && fabs(value) <= 1e30)
        *target = value;
    else
        note_problem(p, name, text);
}

static void use_spacing(const parser *p, const char *text, double pixel[2]) {
    double parsed[2];
    if (parse_vector(p, text, parsed, 2) && parsed[0] > 0 && parsed[1] > 0)
        memcpy(pixel, parsed, sizeof parsed);
}

static void use_frame_count(parser *p, const char *text) {
    long frames = 0;
    bool whole = parse_integer(text, &frames) && !text[strspn(text, " +0123456789")];
    if (!whole || frames < 1 || frames > MAX_FRAMES)
        note_problem(p, "number of frames", text);
    else if (!p->file->frames)
        p->file->frame_count = (int)frames;
}

/* Uses an element that can differ from frame to frame. */
static void use_frame_text(parser *p, uint32_t tag, const char *text, iso_dicom_frame *frame) {
    switch (tag) {
    case TAG(0x0020, 0x0032):
        frame->has_position |= parse_vector(p, text, frame->position, 3);
        break;
    case TAG(0x0020, 0x0037):
        frame->has_orientation |= parse_orientation(p, text, frame);
        break;
    case TAG(0x0028, 0x0030):
        use_spacing(p, text, frame->pixel);
        break;
    case TAG(0x0018, 0x0088):
        parse_vector(p, text, &frame->between, 1);
        break;
    case TAG(0x0018, 0x0050):
        parse_vector(p, text, &frame->thickness, 1);
        break;
    case TAG(0x0028, 0x1052):
        use_rescale(p, "rescale intercept", text, &frame->intercept);
        break;
    case TAG(0x0028, 0x1053):
    case TAG(0x3004, 0x000e): /* dose grid scaling */
        use_rescale(p, "rescale slope", text, &frame->slope);
        break;
    default:
        break;
    }
}

static void use_frame_offsets(parser *p, const char *text) {
    size_t count = 1;
    for (const char *c = text; *c; c++) count += *c == '\\';
    double *offsets = malloc(count * sizeof *offsets);
    if (!offsets) {
        p->no_memory = true;
        return;
    }
    free(p->offsets);
    p->offsets = offsets;
    p->offset_count = parse_decimals(p, text, offsets, count);
}

static void use_file_text(parser *p, uint32_t tag, const char *text) {
    iso_dicom_file *file = p->file;
    switch (tag) {
    case TAG(0x0002, 0x0002):
        copy_text(p->storage, sizeof p->storage, text);
        break;
    case TAG(0x0002, 0x0010):
        copy_text(file->syntax, sizeof file->syntax, text);
        break;
    case TAG(0x0008, 0x0018):
        copy_text(file->instance, sizeof file->instance, text);
        break;
    case TAG(0x0020, 0x000e):
        copy_text(file->series, sizeof file->series, text);
        break;
    case TAG(0x0008, 0x103e):
        copy_text(file->description, sizeof file->description, text);
        break;
    case TAG(0x0008, 0x0060):
        copy_text(file->modality, sizeof file->modality, text);
        break;
    case TAG(0x0028, 0x0004):
        copy_text(file->photometric, sizeof file->photometric, text);
        break;
    case TAG(0x0020, 0x0011):
        parse_integer(text, &file->series_number);
        break;
    case TAG(0x0028, 0x0008):
        use_frame_count(p, text);
        break;
    case TAG(0x0020, 0x0013):
        p->common.has_number |= parse_integer(text, &p->common.number);
        break;
    case TAG(0x0020, 0x0100):
        parse_integer(text, &p->common.phase[0]);
        break;
    case TAG(0x0020, 0x0012):
        parse_integer(text, &p->common.phase[1]);
        break;
    case TAG(0x0018, 0x0086):
        parse_integer(text, &p->common.phase[2]);
        break;
    case TAG(0x3004, 0x000c):
        use_frame_offsets(p, text);
        break;
    case TAG(0x0062, 0x0001):
        copy_text(file->segmentation, sizeof file->segmentation, text);
        break;
    default:
        use_frame_text(p, tag, text, &p->common);
    }
}

static void use_number(parser *p, uint32_t tag, uint32_t value) {
    iso_dicom_file *file = p->file;
    switch (tag) {
    case TAG(0x0028, 0x0002):
        file->samples = (int)value;
        break;
    case TAG(0x0028, 0x0010):
        file->rows = (int)value;
        break;
    case TAG(0x0028, 0x0011):
        file->columns = (int)value;
        break;
    case TAG(0x0028, 0x0100):
        file->bits_allocated = (int)value;
        break;
    case TAG(0x0028, 0x0101):
        file->bits_stored = (int)value;
        break;
    case TAG(0x0028, 0x0102):
        file->high_bit = (int)value;
        break;
    case TAG(0x0028, 0x0103):
        file->is_signed = value != 0;
        break;
    case TAG(0x0028, 0x0120):
        file->padding = (int)value;
        break;
    case TAG(0x0062, 0x000e):
        file->whole_fraction = (int)value;
        break;
    default:
        break;
    }
}

static bool is_number(uint32_t tag) {
    return tag == TAG(0x0028, 0x0002) || tag == TAG(0x0028, 0x0010) || tag == TAG(0x0028, 0x0011) ||
           (tag >= TAG(0x0028, 0x0100) && tag <= TAG(0x0028, 0x0103)) || tag == TAG(0x0028, 0x0120) ||
           tag == TAG(0x0062, 0x000e);
}

static bool is_file_text(uint32_t tag) {
    static const uint32_t tags[] = {TAG(0x0002, 0x0002), TAG(0x0002, 0x0010), TAG(0x0020, 0x000e),
                                    TAG(0x0008, 0x103e), TAG(0x0008, 0x0060), TAG(0x0028, 0x0004),
                                    TAG(0x0020, 0x0011), TAG(0x0028, 0x0008), TAG(0x0020, 0x0013),
                                    TAG(0x0020, 0x0100), TAG(0x0020, 0x0012), TAG(0x0018, 0x0086),
                                    TAG(0x3004, 0x000c), TAG(0x0008, 0x0018), TAG(0x0062, 0x0001)};
    for (size_t i = 0; i < sizeof tags / sizeof *tags; i++)
        if (tags[i] == tag) return true;
    return false;
}

static bool is_frame_text(uint32_t tag) {
    return tag == TAG(0x0020, 0x0032) || tag == TAG(0x0020, 0x0037) || tag == TAG(0x0028, 0x0030) ||
           tag == TAG(0x0018, 0x0088) || tag == TAG(0x0018, 0x0050) || tag == TAG(0x0028, 0x1052) ||
           tag == TAG(0x0028, 0x1053) || tag == TAG(0x3004, 0x000e);
}

/* The frame with this index. Allocates the frames when it is first called: their number comes before all
 * elements about single frames. */
static iso_dicom_frame *frame_of(parser *p, int index) {
    iso_dicom_file *file = p->file;
    if (!file->frames && file->frame_count > p->size) {
        is_corrupt(p); /* more frames than bytes */
    } else if (!file->frames) {
        file->frames = iso_alloc_zero((size_t)file->frame_count, sizeof *file->frames);
        if (!file->frames) p->no_memory = true;
    }
    return file->frames && index < file->frame_count ? &file->frames[index] : NULL;
}

/* Uses the temporal position index of a frame, and the number of its segment. */
static bool use_frame_number(parser *p, const element *e, place here) {
    uint8_t b[4];
    if (!take_bytes(p, b, (size_t)e->length)) return false;
    iso_dicom_frame *target = here.scope == FRAME_SCOPE ? frame_of(p, here.item) : &p->common;
    if (target && e->tag == TAG(0x0020, 0x9128)) target->phase[0] = 1 + (long)number32(p, b);
    if (target && e->tag == TAG(0x0062, 0x000b)) target->segment = (int)number16(p, b);
    return true;
}

static bool is_frame_number(const element *e, place here) {
    return (e->tag == TAG(0x0020, 0x9128) && e->length == 4 && here.scope == FRAME_SCOPE) ||
           (e->tag == TAG(0x0062, 0x000b) && e->length == 2 &&
            (here.scope == FRAME_SCOPE || here.scope == SHARED_SCOPE));
}

/* The segment whose item is parsed, which is added if it is new. NULL: no memory. */
static iso_dicom_segment *segment_of(parser *p, int item) {
    iso_dicom_file *file = p->file;
    if ((size_t)item < file->segment_count) return &file->segments[item];
    if (file->segment_count == file->segment_room) {
        const size_t room = file->segment_room ? 2 * file->segment_room : 16;
        iso_dicom_segment *grown = realloc(file->segments, room * sizeof *grown);
        if (!grown) {
            p->no_memory = true;
            return NULL;
        }
        file->segments = grown;
        file->segment_room = room;
    }
    file->segments[file->segment_count] = (iso_dicom_segment){.number = 0};
    return &file->segments[file->segment_count++];
}

/* Uses the number, name or colour of a segment. */
static bool use_segment(parser *p, const element *e, place here) {
    const bool number = e->tag == TAG(0x0062, 0x0004) && e->length == 2;
    const bool color = e->tag == TAG(0x0062, 0x000d) && e->length == 6;
    const bool name = e->tag == TAG(0x0062, 0x0005) && e->length <= MAX_VALUE;
    iso_dicom_segment *segment = number || color || name ? segment_of(p, here.item) : NULL;
    if (!segment) return !p->no_memory;
    uint8_t b[6];
    char *text = name ? take_text(p, e->length) : NULL;
    if (name ? !text : !take_bytes(p, b, (size_t)e->length)) return false;
    if (number) segment->number = (int)number16(p, b);
    for (int i = 0; color && i < 3; i++) segment->lab[i] = (uint16_t)number16(p, b + 2 * i);
    segment->colored |= color;
    if (name) copy_text(segment->name, sizeof segment->name, text);
    free(text);
    return true;
}

static bool use_text(parser *p, const element *e, place here) {
    char *text = take_text(p, e->length);
    if (!text) return false;
    if (here.scope == FRAME_SCOPE) {
        iso_dicom_frame *frame = frame_of(p, here.item);
        if (frame) use_frame_text(p, e->tag, text, frame);
    } else if (here.scope == SHARED_SCOPE) {
        use_frame_text(p, e->tag, text, &p->common);
    } else {
        use_file_text(p, e->tag, text);
    }
    free(text);
    return !p->no_memory;
}

/* Uses an element with a value (not a sequence), and moves behind it. */
static bool use_value(parser *p, const element *e, place here) {
    int64_t end = p->at + e->length;
    if (e->length > p->size - p->at) return cut_off(p);
    bool file_scope = here.scope == FILE_SCOPE && here.depth == 0;
    if (here.scope == SEGMENT_SCOPE) return use_segment(p, e, here) && skip_to(p, end);
    bool text = e->length <= MAX_VALUE && here.scope != OTHER_SCOPE &&
                (is_frame_text(e->tag) || (file_scope && is_file_text(e->tag)));
    if (text && !use_text(p, e, here)) return false;
    if (file_scope && is_number(e->tag) && e->length >= 2) {
        uint8_t b[2];
        if (!take_bytes(p, b, 2)) return false;
        use_number(p, e->tag, number16(p, b));
    }
    if (is_frame_number(e, here) && !use_frame_number(p, e, here)) return false;
    return skip_to(p, end);
}

/* ---- structure ---- */

/* Whether an element is a sequence that is parsed. Files with implicit value representations do not tell. */
static bool is_known_sequence(uint32_t tag) {
    static const uint32_t tags[] = {SHARED_GROUPS,       PER_FRAME_GROUPS,
                                    DETECTORS,           TAG(0x0020, 0x9111),
                                    TAG(0x0020, 0x9113), TAG(0x0020, 0x9116),
                                    TAG(0x0028, 0x9110), TAG(0x0028, 0x9145),
                                    TAG(0x0062, 0x000a), SEGMENTS};
    for (size_t i = 0; i < sizeof tags / sizeof *tags; i++)
        if (tags[i] == tag) return true;
    return false;
}

static scope scope_inside(const element *e, place here) {
    if (here.scope == SHARED_SCOPE || here.scope == FRAME_SCOPE) return here.scope;
    if (here.scope == FILE_SCOPE && here.depth == 0) {
        if (e->tag == SHARED_GROUPS) return SHARED_SCOPE;
        if (e->tag == PER_FRAME_GROUPS) return FRAME_SCOPE;
        if (e->tag == DETECTORS) return SHARED_SCOPE;
        if (e->tag == SEGMENTS) return SEGMENT_SCOPE;
    }
    return OTHER_SCOPE;
}

static bool parse_sequence(parser *p, const element *e, place here) {
    if (here.depth >= MAX_DEPTH) return is_corrupt(p);
    int64_t end = e->length == UNDEFINED ? UNDEFINED : p->at + e->length;
    if (end > p->size) return cut_off(p);
    bool counts = (e->tag == PER_FRAME_GROUPS || e->tag == SEGMENTS) && here.depth == 0;
    bool was_explicit = p->explicit_vr;
    if (strcmp(e->vr, "UN") == 0) p->explicit_vr = false; /* PS3.5, 6.2.2 */
    for (int item = 0; end == UNDEFINED || p->at < end; item++) {
        element head;
        if (!read_element_head(p, &head)) return false;
        if (head.tag == SEQUENCE_END) break;
        if (head.tag != ITEM) return is_corrupt(p);
        place inside = {scope_inside(e, here), counts ? item : here.item, here.depth + 1,
                        head.length == UNDEFINED ? UNDEFINED : p->at + head.length};
        if (inside.end > p->size) return cut_off(p);
        if (!parse_set(p, inside)) return false;
    }
    p->explicit_vr = was_explicit;
    return true;
}

/* Moves behind the items of encapsulated pixels (PS3.5, A.4). Without a delimiter at the end, the file is
 * truncated. */
static bool parse_fragments(parser *p) {
    for (;;) {
        element head;
        if (!read_element_head(p, &head)) return false;
        if (head.tag == SEQUENCE_END) return true;
        if (head.tag != ITEM || head.length == UNDEFINED) return is_corrupt(p);
        if (!skip_to(p, p->at + head.length)) return false;
    }
}

static bool parse_pixels(parser *p, const element *e) {
    iso_dicom_file *file = p->file;
    file->has_pixels = true;
    file->pixel_offset = (uint64_t)p->at;
    file->encapsulated = e->length == UNDEFINED;
    /* 8-bit pixels in big-endian 16-bit words would have to be swapped; such files are no longer written */
    if (p->big_endian && file->bits_allocated <= 8 && strcmp(e->vr, "OW") == 0) return is_corrupt(p);
    if (!(file->encapsulated ? parse_fragments(p) : skip_to(p, p->at + e->length))) return false;
    file->pixel_bytes = (uint64_t)p->at - file->pixel_offset;
    return true;
}

static bool parse_set(parser *p, place here) {
    while (here.end == UNDEFINED || p->at < here.end) {
        element e;
        if (!read_element_head(p, &e)) return false;
        if (e.tag == ITEM_END && here.depth > 0) return here.end == UNDEFINED || skip_to(p, here.end);
        if (e.tag == PIXEL_DATA && here.depth == 0) return parse_pixels(p, &e);
        if (e.tag == TAG(0x0028, 0x3000) && here.depth == 0) p->file->has_lookup_table = true;
        if (e.tag == PIXEL_DATA && e.length == UNDEFINED) { /* the pixels of an icon, in a sequence */
            if (!parse_fragments(p)) return false;
            continue;
        }
        bool sequence =
            e.length == UNDEFINED || strcmp(e.vr, "SQ") == 0 || (!p->explicit_vr && is_known_sequence(e.tag));
        bool wanted = e.length == UNDEFINED || scope_inside(&e, here) != OTHER_SCOPE;
        if (!(sequence && wanted ? parse_sequence(p, &e, here) : use_value(p, &e, here))) return false;
    }
    return true;
}

/* ---- the file around the data set ---- */

/* Parses group 2, which is always explicit and little-endian (PS3.10, 7.1), up to the next group. */
static bool parse_meta(parser *p) {
    const place here = {FILE_SCOPE, 0, 0, UNDEFINED};
    p->explicit_vr = true;
    while (p->at < p->size) {
        uint8_t b[2];
        int64_t start = p->at;
        if (!take_bytes(p, b, 2)) return false;
        if (fseeko(p->stream, start, SEEK_SET) != 0) return cut_off(p);
        p->at = start;
        if (number16(p, b) != 2) return true;
        element e;
        if (!read_element_head(p, &e)) return false;
        if (e.length == UNDEFINED) return is_corrupt(p);
        if (!use_value(p, &e, here)) return false;
    }
    return cut_off(p);
}

/* Sets the byte order and encoding of the data set by the transfer syntax; returns NULL, or the reason for a
 * failure. */
static const char *apply_syntax(parser *p) {
    const char *syntax = p->file->syntax;
    p->explicit_vr = strcmp(syntax, "1.2.840.10008.1.2") != 0;
    p->big_endian = strcmp(syntax, "1.2.840.10008.1.2.2") == 0;
    p->file->big_endian = p->big_endian;
    if (!p->explicit_vr || p->big_endian || strcmp(syntax, "1.2.840.10008.1.2.1") == 0) return NULL;
    if (strcmp(syntax, "1.2.840.10008.1.2.1.99") == 0) return "the whole data set is deflated";
    if (strncmp(syntax, "1.2.840.10008.1.2.4.", 20) == 0) return NULL;
    if (strcmp(syntax, "1.2.840.10008.1.2.5") == 0) return NULL;
    return "its transfer syntax is not known";
}

/* Whether a file without the 128-byte preamble (older than 1993, or not standard) begins with a data set:
 * with group 8. */
static bool looks_bare(const uint8_t b[8]) {
    return b[0] == 8 && b[1] == 0 && b[3] == 0;
}

static bool begin_bare(parser *p, const uint8_t b[8]) {
    p->explicit_vr = b[4] >= 'A' && b[4] <= 'Z' && b[5] >= 'A' && b[5] <= 'Z';
    strcpy(p->file->syntax, p->explicit_vr ? "1.2.840.10008.1.2.1" : "1.2.840.10008.1.2");
    return fseeko(p->stream, 0, SEEK_SET) == 0;
}

/* Completes a frame with the values for all frames, and with its position along the normal if the file gives
 * offsets. */
static void complete_frame(const parser *p, int index, iso_dicom_frame *frame) {
    const iso_dicom_frame *common = &p->common;
    iso_dicom_frame whole = *common;
    whole.index = index;
    if (p->file->frame_count > 1) whole.number = index + 1, whole.has_number = true;
    if (frame->has_orientation) memcpy(whole.orientation, frame->orientation, sizeof whole.orientation);
    whole.has_orientation |= frame->has_orientation;
    if (frame->has_position) {
        memcpy(whole.position, frame->position, sizeof whole.position);
        whole.has_position = true;
    } else if (p->file->frame_count > 1) {
        bool stated = (size_t)index < p->offset_count;
        double along = stated ? p->offsets[index] - p->offsets[0] : index * common->between;
        whole.has_position &= stated || common->between != 0;
        const double *o = whole.orientation;
        iso_vec3 normal = iso_vec3_cross(iso_vec3_make(o[0], o[1], o[2]), iso_vec3_make(o[3], o[4], o[5]));
        whole.position[0] += along * normal.x;
        whole.position[1] += along * normal.y;
        whole.position[2] += along * normal.z;
    }
    if (frame->pixel[0] > 0) memcpy(whole.pixel, frame->pixel, sizeof whole.pixel);
    if (frame->between > 0) whole.between = frame->between;
    if (frame->thickness > 0) whole.thickness = frame->thickness;
    if (frame->slope != 0) whole.slope = frame->slope, whole.intercept = frame->intercept;
    if (frame->phase[0] > 0) whole.phase[0] = frame->phase[0] - 1;
    if (frame->segment) whole.segment = frame->segment;
    *frame = whole;
}

/* Whether the kind of object always has an image: CT, MR, PET, NM, ultrasound, dose, secondary captures. */
static bool announces_image(const parser *p) {
    static const char *const kinds[] = {"2", "4", "128", "130", "20", "3", "6", "481.2", "7"};
    const char *prefix = "1.2.840.10008.5.1.4.1.1.";
    if (p->file->rows > 0 && p->file->columns > 0) return true;
    if (strncmp(p->storage, prefix, strlen(prefix)) != 0) return false;
    const char *kind = p->storage + strlen(prefix);
    for (size_t i = 0; i < sizeof kinds / sizeof *kinds; i++) {
        size_t length = strlen(kinds[i]);
        if (strncmp(kind, kinds[i], length) == 0 && (!kind[length] || kind[length] == '.')) return true;
    }
    return false;
}

static iso_status check_image(const iso_dicom_file *file, iso_error *error) {
    if (file->rows < 1 || file->columns < 1)
        return iso_fail(error, ISO_ERR_FORMAT, "%s: an image of %d x %d pixels", file->path, file->columns,
                        file->rows);
    int allocated = file->bits_allocated;
    const bool bits = allocated == 1 && *file->segmentation && !file->encapsulated && file->samples == 1;
    if ((allocated != 8 && allocated != 16 && allocated != 32 && !bits) || file->bits_stored < 1 ||
        file->bits_stored > allocated || file->high_bit >= allocated ||
        file->high_bit + 1 < file->bits_stored)
        return iso_fail(error, ISO_ERR_FORMAT, "%s: cannot read pixels of %d bits of which %d are used",
                        file->path, allocated, file->bits_stored);
    uint64_t wanted = iso_dicom_frame_bytes(file);
    if (__builtin_mul_overflow(wanted, (uint64_t)file->frame_count, &wanted)) wanted = UINT64_MAX;
    if (bits) wanted = wanted / 8 + (wanted % 8 != 0);
    if (!file->encapsulated && file->pixel_bytes < wanted)
        return iso_fail(error, ISO_ERR_IO, "%s: truncated: %llu of %llu bytes of pixels", file->path,
                        (unsigned long long)file->pixel_bytes, (unsigned long long)wanted);
    return ISO_OK;
}

static iso_status finish_file(parser *p, iso_dicom_kind *kind, iso_error *error) {
    iso_dicom_file *file = p->file;
    if (p->no_memory) return iso_fail_memory(error, file->path);
    if (p->cut) return iso_fail(error, ISO_ERR_IO, "%s: truncated: the file ends too early", file->path);
    if (p->corrupt) return iso_fail(error, ISO_ERR_IO, "%s: corrupt: not a DICOM data set", file->path);
    if (*p->problem) return iso_fail(error, ISO_ERR_FORMAT, "%s: %s", file->path, p->problem);
    if (!file->has_pixels && announces_image(p))
        return iso_fail(error, ISO_ERR_IO, "%s: truncated: an image without pixels", file->path);
    if (!file->has_pixels) {
        *kind = strcmp(p->storage, "1.2.840.10008.1.3.10") == 0 ? ISO_DICOM_DIRECTORY : ISO_DICOM_NO_IMAGE;
        return ISO_OK;
    }
    ISO_TRY(check_image(file, error));
    if (!frame_of(p, 0))
        return iso_fail(error, p->corrupt ? ISO_ERR_IO : ISO_ERR_NOMEM, "%s: no room for %d frames",
                        file->path, file->frame_count);
    for (int i = 0; i < file->frame_count; i++) complete_frame(p, i, &file->frames[i]);
    *kind = ISO_DICOM_IMAGE;
    return ISO_OK;
}

static iso_status parse_file(parser *p, iso_dicom_kind *kind, iso_error *error) {
    const char *path = p->file->path;
    uint8_t preamble[132] = {0};
    size_t count = fread(preamble, 1, sizeof preamble, p->stream);
    bool standard = count == sizeof preamble && memcmp(preamble + 128, "DICM", 4) == 0;
    if (!standard && !(count >= 8 && looks_bare(preamble))) return ISO_OK;
    bool ok = true;
    if (standard) {
        p->at = (int64_t)count;
        ok = parse_meta(p);
        const char *reason = ok ? apply_syntax(p) : NULL;
        if (reason)
            return iso_fail(error, ISO_ERR_FORMAT, "%s: cannot be read: %s (%s)", path, reason,
                            p->file->syntax);
    } else {
        ok = begin_bare(p, preamble);
    }
    /* The data set of a file ends with the file. */
    if (ok) parse_set(p, (place){FILE_SCOPE, 0, 0, p->size});
    if (!standard && (p->cut || p->corrupt)) return ISO_OK;
    return finish_file(p, kind, error);
}

static iso_status open_parser(parser *p, iso_error *error) {
    const char *path = p->file->path;
    ISO_TRY(iso_file_open(path, &p->stream, NULL, error));
    if (fseeko(p->stream, 0, SEEK_END) != 0 || (p->size = ftello(p->stream)) < 0)
        return iso_fail(error, ISO_ERR_IO, "%s: cannot read: %s", path, strerror(errno));
    rewind(p->stream);
    p->c_locale = newlocale(LC_NUMERIC_MASK, "C", (locale_t)0);
    if (!p->c_locale) return iso_fail_memory(error, path);
    return ISO_OK;
}

iso_status iso_dicom_file_read(const char *path, iso_dicom_file *file, iso_dicom_kind *kind,
                               iso_error *error) {
    *file = (iso_dicom_file){
        .path = strdup(path), .frame_count = 1, .samples = 1, .series_number = -1, .padding = -1};
    if (!file->path) return iso_fail_memory(error, path);
    parser p = {.file = file,
                .common = {.slope = 1, .phase = {-1, -1, -1}, .orientation = {1, 0, 0, 0, 1, 0}}};
    *kind = ISO_DICOM_NOT;
    iso_status status = open_parser(&p, error);
    if (status == ISO_OK) status = parse_file(&p, kind, error);
    if (p.stream) fclose(p.stream);
    if (p.c_locale) freelocale(p.c_locale);
    free(p.offsets);
    if (p.common.has_position) memcpy(file->position, p.common.position, sizeof file->position);
    file->has_position = p.common.has_position;
    return status;
}

void iso_dicom_file_free(iso_dicom_file *file) {
    free(file->path);
    iso_free(file->frames);
    free(file->segments);
    *file = (iso_dicom_file){0};
}

uint64_t iso_dicom_frame_bytes(const iso_dicom_file *file) {
    return (uint64_t)file->rows * (uint64_t)file->columns * (uint64_t)file->samples *
           (uint64_t)(file->bits_allocated < 8 ? 1 : file->bits_allocated / 8);
}
