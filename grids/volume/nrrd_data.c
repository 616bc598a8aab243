/* nrrd_data: decodes the array of an NRRD file, from one file or from several that are read like one.
 *
 * Names that a header gives are opened by iso_file_open. Memory does not depend on the header; time is
 * bounded by what the files hold: the number of files is known from the sizes before a name is used, and a
 * name is as long as the system allows at most. Where a byte skip says that the array ends with a compressed
 * stream, the stream is unpacked twice. */
#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/file.h"
#include "base/memory.h"
#include "grids/volume/nrrd.h"

/* The most bytes that may come before an array which is at the end of a compressed stream. */
#define MAX_BEFORE (UINT64_C(256) << 20)

struct iso_nrrd_data {
    const char *path; /* of the header */
    const iso_nrrd_header *header;
    uint64_t files, each; /* number of files, and decoded bytes in each */
    FILE *list;           /* of a list: the header file, at the next name */
    uint64_t opened;      /* number of files opened so far */
    char *name;           /* of the current file, owned */
    FILE *file;
    uint64_t left; /* decoded bytes of it that are not read yet */
    iso_inflater *inflater;
    iso_bunzip *bunzip;
    unsigned zeros; /* rest of a run of zeros (ISO_NRRD_ZRL) */
    bool more;      /* the current file goes on behind its part of the array */
    char *longer;   /* the name of the first file that did, owned */
};

static void close_decoders(iso_nrrd_data *d) {
    iso_inflater_destroy(d->inflater);
    iso_bunzip_destroy(d->bunzip);
    d->inflater = NULL;
    d->bunzip = NULL;
}

/* Keeps the name of a file beside the header that goes on behind its part of the array. */
static void keep_longer(iso_nrrd_data *d) {
    if (d->more && !d->longer && d->header->place != ISO_NRRD_ATTACHED) d->longer = strdup(d->name);
    d->more = false;
}

const char *iso_nrrd_data_longer(const iso_nrrd_data *d) {
    return d->longer;
}

static void close_file(iso_nrrd_data *d) {
    close_decoders(d);
    if (d->file) fclose(d->file);
    d->file = NULL;
    free(d->name);
    d->name = NULL;
}

void iso_nrrd_data_close(iso_nrrd_data *d) {
    if (!d) return;
    close_file(d);
    free(d->longer);
    if (d->list) fclose(d->list);
    iso_free(d);
}

/* ---- names ---- */

/* Reads a line without its end (\n, \r\n or \r), cut to `size` - 1 characters; *length is that of the whole
 * line. False at the end of the file. */
static bool read_line(FILE *file, char *line, size_t size, size_t *length) {
    int c = getc_unlocked(file);
    if (c == EOF) return false;
    for (*length = 0; c != EOF && c != '\n' && c != '\r'; c = getc_unlocked(file)) {
        if (*length + 1 < size) line[*length] = (char)c;
        (*length)++;
    }
    if (c == '\r' && (c = getc_unlocked(file)) != '\n' && c != EOF) ungetc(c, file);
    if (size) line[*length < size ? *length : size - 1] = 0;
    return true;
}

/* Reads the next name of a list; an empty name at its end. */
static iso_status read_name(iso_nrrd_data *d, char line[ISO_NRRD_NAME], iso_error *error) {
    size_t length = 0;
    if (!read_line(d->list, line, ISO_NRRD_NAME, &length)) *line = 0;
    if (length < ISO_NRRD_NAME) return ISO_OK;
    return iso_fail(error, ISO_ERR_FORMAT, "%s: the name of a data file has %zu characters", d->path, length);
}

/* Counts the names of the list, up to most + 1. */
static iso_status count_names(iso_nrrd_data *d, uint64_t most, uint64_t *count, iso_error *error) {
    ISO_TRY(iso_file_open(d->path, &d->list, NULL, error));
    char line[ISO_NRRD_NAME];
    for (int pass = 0; pass < 2; pass++) {
        if (fseeko(d->list, (off_t)d->header->after, SEEK_SET) != 0)
            return iso_fail(error, ISO_ERR_IO, "%s: cannot read: %s", d->path, strerror(errno));
        if (pass == 1) break;
        for (*count = 0; *count <= most; ++*count) {
            ISO_TRY(read_name(d, line, error));
            if (!*line) break;
        }
    }
    return ISO_OK;
}

/* Sets the number of files and the size of the part in each, from the sizes of the array and the number of
 * axes in a file. If each file has a part of the last axis, the number of files is `given`. */
static iso_status split_over_files(iso_nrrd_data *d, uint64_t all, uint64_t given, iso_error *error) {
    const iso_nrrd_header *header = d->header;
    uint64_t last = header->axis[header->dim - 1].size;
    bool parts = header->file_dim == header->dim;
    uint64_t wanted = 1;
    for (unsigned i = header->file_dim; i < header->dim; i++) wanted *= header->axis[i].size;
    d->files = parts ? given : wanted;
    if (given == 0 || given != d->files || (parts && last % given != 0))
        return iso_fail(error, ISO_ERR_FORMAT, "%s: names %s%llu data files for %llu %s", d->path,
                        d->list && given > (parts ? last : wanted) ? "at least " : "",
                        (unsigned long long)given, (unsigned long long)(parts ? last : wanted),
                        parts ? "slices" : "parts of its array");
    d->each = all / d->files;
    return ISO_OK;
}

static iso_status count_files(iso_nrrd_data *d, uint64_t all, iso_error *error) {
    const iso_nrrd_header *header = d->header;
    d->files = 1;
    d->each = all;
    if (header->place == ISO_NRRD_ATTACHED || header->place == ISO_NRRD_FILE) return ISO_OK;
    uint64_t given = 0, most = 1;
    for (unsigned i = header->file_dim < header->dim ? header->file_dim : header->dim - 1; i < header->dim;
         i++)
        most *= header->axis[i].size;
    if (header->place == ISO_NRRD_PATTERN)
        given = (uint64_t)((header->last - header->first) / header->step) + 1;
    else
        ISO_TRY(count_names(d, most, &given, error));
    return split_over_files(d, all, given, error);
}

/* Writes the name of file `index`: replaces %d, %5d or %05d by its number, and %% by %. */
static bool print_name(const iso_nrrd_header *header, uint64_t index, char name[ISO_NRRD_NAME]) {
    int number = (int)(header->first + (int64_t)index * header->step);
    size_t length = 0;
    bool printed = false;
    for (const char *c = header->name; *c; c++) {
        char digits[300];
        int count = 1;
        digits[0] = *c;
        if (c[0] == '%' && c[1] == '%') {
            c++;
        } else if (*c == '%') {
            size_t places = strspn(c + 1, "0123456789");
            bool zeros = c[1] == '0';
            int width = places && places <= 4 ? atoi(c + 1) : 0;
            if (printed || places > 4 || width > 256 || c[1 + places] != 'd') return false;
            count = zeros ? snprintf(digits, sizeof digits, "%0*d", width, number)
                          : snprintf(digits, sizeof digits, "%*d", width, number);
            c += 1 + places;
            printed = true;
        }
        if (length + (size_t)count >= ISO_NRRD_NAME) return false;
        memcpy(name + length, digits, (size_t)count);
        length += (size_t)count;
    }
    name[length] = 0;
    return true;
}

/* Finds the name of the next file, and the number of bytes to skip in it. */
static iso_status next_name(iso_nrrd_data *d, int64_t *skip, iso_error *error) {
    const iso_nrrd_header *header = d->header;
    char line[ISO_NRRD_NAME];
    const char *name = line;
    *skip = header->byte_skip;
    if (d->list) {
        ISO_TRY(read_name(d, line, error));
    } else if (header->place == ISO_NRRD_PATTERN && !print_name(header, d->opened, line)) {
        return iso_fail(error, ISO_ERR_FORMAT, "%s: '%.80s' is no pattern for names of data files", d->path,
                        header->name);
    } else if (header->place == ISO_NRRD_FILE) {
        name = header->name;
    }
    if (header->place == ISO_NRRD_SKIP_LIST) {
        char *end;
        errno = 0;
        *skip = strtoll(line, &end, 10);
        if (errno || end == line || *end != ' ' || !end[1])
            return iso_fail(error, ISO_ERR_FORMAT, "%s: '%.80s' is not a number of bytes, a space and a name",
                            d->path, line);
        name = end + 1;
    }
    d->name = header->place == ISO_NRRD_ATTACHED ? strdup(d->path) : iso_format_beside(d->path, name);
    return d->name ? ISO_OK : iso_fail_memory(error, d->path);
}

/* ---- the position of the array in a file ---- */

static bool is_packed(const iso_nrrd_header *header) {
    return header->encoding == ISO_NRRD_GZIP || header->encoding == ISO_NRRD_BZIP2;
}

static iso_status seek(const iso_nrrd_data *d, uint64_t position, iso_error *error) {
    if (position <= INT64_MAX && fseeko(d->file, (off_t)position, SEEK_SET) == 0) return ISO_OK;
    return iso_fail(error, ISO_ERR_IO, "%s: cannot read: %s", d->name, strerror(errno));
}

static iso_status skip_lines(const iso_nrrd_data *d, iso_error *error) {
    for (uint64_t i = 0; i < d->header->line_skip; i++) {
        size_t length;
        if (!read_line(d->file, NULL, 0, &length))
            return iso_fail(error, ISO_ERR_IO, "%s: truncated: %llu of %llu lines to skip", d->name,
                            (unsigned long long)i, (unsigned long long)d->header->line_skip);
    }
    return ISO_OK;
}

/* Skips to the array in a file of `bytes` bytes, as byte_skip states. Raw data must be complete. */
static iso_status skip_bytes(iso_nrrd_data *d, uint64_t bytes, int64_t skip, iso_error *error) {
    off_t at = ftello(d->file);
    if (at < 0) return iso_fail(error, ISO_ERR_IO, "%s: cannot read: %s", d->name, strerror(errno));
    bool raw = d->header->encoding == ISO_NRRD_RAW;
    uint64_t start = (uint64_t)at, needs = raw ? d->each : 0;
    /* none of these is above INT64_MAX */
    uint64_t beside = skip < 0 ? (uint64_t) - (skip + 1) : (uint64_t)skip;
    if (bytes < start || bytes - start < beside || bytes - start - beside < needs)
        return iso_format_truncated(d->name, bytes, start + beside + needs, error);
    d->more = raw && skip >= 0 && bytes - start - beside > needs;
    return seek(d, skip < 0 ? bytes - beside - needs : start + beside, error);
}

/* ---- compressed streams ---- */

static iso_status open_decoder(iso_nrrd_data *d, uint64_t total, iso_error *error) {
    if (d->header->encoding == ISO_NRRD_GZIP)
        return iso_inflater_create(d->name, d->file, total, &d->inflater, error);
    return iso_bunzip_create(d->name, d->file, total, &d->bunzip, error);
}

/* Decompresses the next bytes; *got is less than `bytes` only at the stream's end. */
static iso_status unpack(iso_nrrd_data *d, void *target, size_t bytes, size_t *got, iso_error *error) {
    return d->inflater ? iso_inflater_read(d->inflater, target, bytes, got, error)
                       : iso_bunzip_read(d->bunzip, target, bytes, got, error);
}

static iso_status unpack_all(iso_nrrd_data *d, void *target, size_t bytes, iso_error *error) {
    size_t got = 0;
    ISO_TRY(unpack(d, target, bytes, &got, error));
    return got == bytes ? ISO_OK : iso_format_truncated(d->name, d->each - d->left + got, d->each, error);
}

/* Sets *before to the number of decompressed bytes before an array that ends `behind` bytes before the
 * stream's end. */
static iso_status measure(iso_nrrd_data *d, uint64_t behind, uint64_t *before, iso_error *error) {
    off_t start = ftello(d->file);
    char scratch[1 << 14];
    uint64_t total = 0, most, wanted;
    if (__builtin_add_overflow(d->each, behind, &wanted) || __builtin_add_overflow(wanted, MAX_BEFORE, &most))
        return iso_fail(error, ISO_ERR_FORMAT, "%s: a byte skip of %lld is not possible", d->path,
                        (long long)d->header->byte_skip);
    ISO_TRY(open_decoder(d, wanted, error));
    for (size_t got = sizeof scratch; got == sizeof scratch && total <= most; total += got)
        ISO_TRY(unpack(d, scratch, sizeof scratch, &got, error));
    close_decoders(d);
    if (total < wanted) return iso_format_truncated(d->name, total, wanted, error);
    if (total > most)
        return iso_fail(error, ISO_ERR_FORMAT, "%s: more than %llu MiB lie before its array", d->name,
                        (unsigned long long)(MAX_BEFORE >> 20));
    *before = total - wanted;
    return seek(d, (uint64_t)start, error);
}

static iso_status begin_packed(iso_nrrd_data *d, int64_t skip, iso_error *error) {
    uint64_t before = (uint64_t)skip, total;
    if (skip < 0) ISO_TRY(measure(d, (uint64_t) - (skip + 1), &before, error));
    if (__builtin_add_overflow(before, d->each, &total)) total = UINT64_MAX;
    ISO_TRY(open_decoder(d, total, error));
    char scratch[1 << 14];
    while (before) {
        size_t part = before < sizeof scratch ? (size_t)before : sizeof scratch, got = 0;
        ISO_TRY(unpack(d, scratch, part, &got, error));
        if (got < part)
            return iso_fail(error, ISO_ERR_IO, "%s: truncated: ends within the %lld bytes to skip", d->name,
                            (long long)skip);
        before -= part;
    }
    return ISO_OK;
}

/* Reads the rest of the compressed data up to its checksum: that of the stream or, in bzip2, that of the
 * block, which damage may have made longer. Stops if the end is far behind the array. */
static iso_status end_packed(iso_nrrd_data *d, iso_error *error) {
    if (d->inflater) return iso_inflater_finish(d->inflater, &d->more, error);
    char scratch[1 << 14];
    size_t got = sizeof scratch;
    for (int i = 0; i < 64 && got == sizeof scratch; i++) {
        ISO_TRY(unpack(d, scratch, sizeof scratch, &got, error));
        d->more |= got > 0;
    }
    return ISO_OK;
}

/* Behind numbers in text, and other bytes that were read one by one. */
static void end_unpacked(iso_nrrd_data *d) {
    int c = getc_unlocked(d->file);
    while (d->header->encoding != ISO_NRRD_ZRL && (c == ' ' || (c >= '\t' && c <= '\r')))
        c = getc_unlocked(d->file);
    d->more = c != EOF;
}

/* Sees what follows the current file's part of the array, after that has been read. What lies between the
 * part and a byte skip from the end is meant to be there. */
static iso_status end_part(iso_nrrd_data *d, iso_error *error) {
    if (is_packed(d->header))
        ISO_TRY(end_packed(d, error));
    else if (d->header->encoding != ISO_NRRD_RAW)
        end_unpacked(d);
    if (d->header->byte_skip >= 0) keep_longer(d);
    return ISO_OK;
}

/* ---- files ---- */

static iso_status open_next(iso_nrrd_data *d, iso_error *error) {
    const iso_nrrd_header *header = d->header;
    int64_t skip = 0;
    uint64_t bytes = 0;
    close_file(d);
    ISO_TRY(next_name(d, &skip, error));
    ISO_TRY(iso_file_open(d->name, &d->file, &bytes, error));
    if (header->place == ISO_NRRD_ATTACHED) ISO_TRY(seek(d, header->after, error));
    ISO_TRY(skip_lines(d, error));
    ISO_TRY(is_packed(header) ? begin_packed(d, skip, error) : skip_bytes(d, bytes, skip, error));
    d->opened++;
    d->zeros = 0;
    d->left = d->each;
    return ISO_OK;
}

iso_status iso_nrrd_data_open(const char *path, const iso_nrrd_header *header, iso_nrrd_data **data,
                              iso_error *error) {
    uint64_t all = iso_nrrd_bytes(header);
    if (all == UINT64_MAX)
        return iso_fail(error, ISO_ERR_FORMAT, "%s: its array is more than any machine can hold", path);
    iso_nrrd_data *d = iso_alloc_zero(1, sizeof *d);
    if (!d) return iso_fail_memory(error, path);
    d->path = path;
    d->header = header;
    iso_status status = count_files(d, all, error);
    if (status == ISO_OK) status = open_next(d, error);
    if (status != ISO_OK) {
        iso_nrrd_data_close(d);
        return status;
    }
    *data = d;
    return ISO_OK;
}

void iso_nrrd_data_list(const char *path, const iso_nrrd_header *header, iso_file_set *files) {
    uint64_t all = iso_nrrd_bytes(header);
    if (!files || header->place == ISO_NRRD_ATTACHED || all == UINT64_MAX) return;
    iso_nrrd_data *d = iso_alloc_zero(1, sizeof *d);
    files->incomplete = files->incomplete || !d;
    if (!d) return;
    d->path = path;
    d->header = header;
    bool there = count_files(d, all, NULL) == ISO_OK;
    for (int64_t skip; there && d->opened < d->files; d->opened++) {
        there = next_name(d, &skip, NULL) == ISO_OK && access(d->name, F_OK) == 0;
        if (there) iso_file_set_read(files, d->name);
        free(d->name);
        d->name = NULL;
    }
    iso_nrrd_data_close(d);
}

/* ---- decoding ---- */

static iso_status ends_early(const iso_nrrd_data *d, iso_error *error) {
    return iso_fail(error, ISO_ERR_IO, "%s: %s", d->name,
                    ferror(d->file) ? "cannot be read" : "truncated: the file ends within the array");
}

static iso_status fill_raw(const iso_nrrd_data *d, void *target, size_t bytes, iso_error *error) {
    return fread(target, 1, bytes, d->file) == bytes ? ISO_OK : ends_early(d, error);
}

static iso_status fill_text(const iso_nrrd_data *d, void *target, size_t bytes, iso_error *error) {
    iso_scalar scalar = d->header->scalar;
    if (iso_format_read_numbers(d->file, ",", scalar, bytes / iso_scalar_size(scalar), target)) return ISO_OK;
    if (feof(d->file) || ferror(d->file)) return ends_early(d, error);
    return iso_fail(error, ISO_ERR_IO, "%s: holds something that is not a number", d->name);
}

/* Returns the value of the next hexadecimal digit; -1: another character; -2: the end of the file. */
static int next_digit(FILE *file) {
    int c = getc_unlocked(file);
    while (c == ' ' || (c >= '\t' && c <= '\r')) c = getc_unlocked(file);
    if (c >= '0' && c <= '9') return c - '0';
    if (c >= 'a' && c <= 'f') return c - 'a' + 10;
    if (c >= 'A' && c <= 'F') return c - 'A' + 10;
    return c == EOF ? -2 : -1;
}

static iso_status fill_hex(const iso_nrrd_data *d, void *target, size_t bytes, iso_error *error) {
    unsigned char *at = target;
    for (size_t i = 0; i < bytes; i++) {
        int high = next_digit(d->file), low = high < 0 ? high : next_digit(d->file);
        if (low == -2) return ends_early(d, error);
        if (low < 0)
            return iso_fail(error, ISO_ERR_IO, "%s: holds something that is not hexadecimal", d->name);
        at[i] = (unsigned char)(high << 4 | low);
    }
    return ISO_OK;
}

/* Decodes run lengths of zeros: 0, n stands for n zeros; 0, 0 and a number of two bytes for as many zeros;
 * every other byte for itself. */
static iso_status fill_zrl(iso_nrrd_data *d, void *target, size_t bytes, iso_error *error) {
    unsigned char *at = target;
    while (bytes) {
        if (d->zeros) {
            size_t part = d->zeros < bytes ? d->zeros : bytes;
            memset(at, 0, part);
            d->zeros -= (unsigned)part;
            at += part;
            bytes -= part;
            continue;
        }
        int c = getc_unlocked(d->file), count = c == 0 ? getc_unlocked(d->file) : 0;
        if (c == 0 && count == 0) {
            int low = getc_unlocked(d->file), high = getc_unlocked(d->file);
            count = low == EOF || high == EOF ? EOF : low + 256 * high;
        }
        if (c == EOF || count == EOF) return ends_early(d, error);
        d->zeros = (unsigned)count;
        if (c == 0) continue;
        *at++ = (unsigned char)c;
        bytes--;
    }
    return ISO_OK;
}

static iso_status decode(iso_nrrd_data *d, void *target, size_t bytes, iso_error *error) {
    switch (d->header->encoding) {
    case ISO_NRRD_RAW:
        return fill_raw(d, target, bytes, error);
    case ISO_NRRD_TEXT:
        return fill_text(d, target, bytes, error);
    case ISO_NRRD_HEX:
        return fill_hex(d, target, bytes, error);
    case ISO_NRRD_ZRL:
        return fill_zrl(d, target, bytes, error);
    default:
        return unpack_all(d, target, bytes, error);
    }
}

iso_status iso_nrrd_data_fill(void *data, void *target, size_t bytes, iso_error *error) {
    iso_nrrd_data *d = data;
    for (char *at = target; bytes;) {
        if (d->left == 0) ISO_TRY(open_next(d, error));
        size_t part = bytes < d->left ? bytes : (size_t)d->left;
        ISO_TRY(decode(d, at, part, error));
        d->left -= part;
        if (d->left == 0) ISO_TRY(end_part(d, error));
        at += part;
        bytes -= part;
    }
    return ISO_OK;
}

FILE *iso_nrrd_data_plain(void *data, uint64_t bytes) {
    iso_nrrd_data *d = data;
    if (d->header->encoding != ISO_NRRD_RAW || (d->left == 0 && open_next(d, NULL) != ISO_OK) ||
        d->left < bytes)
        return NULL; /* (what is wrong with the next file is said when it is read) */
    d->left -= bytes;
    if (d->left == 0) keep_longer(d);
    return d->file;
}

iso_status iso_nrrd_data_skip(iso_nrrd_data *d, uint64_t bytes, iso_error *error) {
    char scratch[1 << 14]; /* a multiple of every scalar's size */
    while (bytes) {
        if (d->left == 0) ISO_TRY(open_next(d, error));
        uint64_t part = bytes < d->left ? bytes : d->left;
        if (d->header->encoding == ISO_NRRD_RAW) {
            if (fseeko(d->file, (off_t)part, SEEK_CUR) != 0)
                return iso_fail(error, ISO_ERR_IO, "%s: cannot read: %s", d->name, strerror(errno));
            d->left -= part;
            if (d->left == 0) keep_longer(d);
        } else {
            if (part > sizeof scratch) part = sizeof scratch;
            ISO_TRY(iso_nrrd_data_fill(d, scratch, (size_t)part, error));
        }
        bytes -= part;
    }
    return ISO_OK;
}
