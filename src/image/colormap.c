/* colormap: linear interpolation between the colours of a table, which is built in or comes from a file. */
#include "image/colormap.h"

#include <limits.h>
#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

#include "base/file.h"
#include "base/memory.h"
#include "base/parse.h"
#include "base/text.h"

enum { STEPS = 64 };

static const uint32_t tables[ISO_COLORMAP_GRAY][STEPS + 1] = {
#include "image/colormap_tables.inc"
};

const char iso_colormap_names[] =
    "viridis, inferno, turbo, coolwarm, cividis, batlow, vik, magma, plasma or gray";

const char *iso_colormap_name(iso_colormap map) {
#define COLORMAP_TEXT(name, text) text,
    static const char *const names[] = {ISO_COLORMAPS(COLORMAP_TEXT)};
#undef COLORMAP_TEXT
    return names[map];
}

/* How many letters have to be changed, inserted or left out to make one name of the other. */
static int letters_apart(const char *a, const char *b) {
    enum { MOST = 32 };
    int row[MOST + 1];
    const int width = strlen(b) < MOST ? (int)strlen(b) : MOST;
    for (int i = 0; i <= width; i++) row[i] = i;
    for (int k = 1; *a && k <= MOST; k++, a++) {
        int diagonal = row[0];
        row[0] = k;
        for (int i = 1; i <= width; i++) {
            const int change = diagonal + (*a != b[i - 1]);
            diagonal = row[i];
            const int step = (row[i] < row[i - 1] ? row[i] : row[i - 1]) + 1;
            row[i] = change < step ? change : step;
        }
    }
    return row[width];
}

iso_status iso_colormap_find(const char *name, iso_colormap *map, iso_error *error) {
    int nearest = 0, least = INT_MAX;
    for (int i = 0; i < ISO_COLORMAP_COUNT; i++) {
        const int apart = letters_apart(name, iso_colormap_name((iso_colormap)i));
        if (strcasecmp(name, iso_colormap_name((iso_colormap)i)) == 0) {
            *map = (iso_colormap)i;
            return ISO_OK;
        }
        if (apart < least) nearest = i;
        if (apart < least) least = apart;
    }
    const bool near = least <= 3;
    return iso_fail(error, ISO_ERR_USAGE, "there is no colormap '%s'%s%s%s: %s", name,
                    near ? " (did you mean " : "", near ? iso_colormap_name((iso_colormap)nearest) : "",
                    near ? "?)" : "", iso_colormap_names);
}

static uint8_t mix(uint32_t low, uint32_t high, int shift, double part) {
    const double a = low >> shift & 255, b = high >> shift & 255;
    return (uint8_t)(a + (b - a) * part + 0.5);
}

/* The colour of `at`, 0 .. 1, of `steps` + 1 colours. */
static iso_rgb table_at(const uint32_t *colors, size_t steps, double at) {
    const size_t step = at < 1 ? (size_t)(at * (double)steps) : steps - 1;
    const uint32_t low = colors[step], high = colors[step + 1];
    const double part = at * (double)steps - (double)step;
    return (iso_rgb){mix(low, high, 16, part), mix(low, high, 8, part), mix(low, high, 0, part)};
}

static double clamp(double at) {
    return at < 0 ? 0 : at > 1 ? 1 : at;
}

static const iso_rgb NEUTRAL = {128, 128, 128};

iso_rgb iso_colormap_at(iso_colormap map, double at) {
    if (isnan(at)) return NEUTRAL;
    const uint8_t gray = iso_gray_at(at);
    if (map == ISO_COLORMAP_GRAY) return (iso_rgb){gray, gray, gray};
    return table_at(tables[map], STEPS, clamp(at));
}

iso_rgb iso_color_bar_at(const iso_color_bar *bar, double number) {
    const double width = bar->high - bar->low, at = width > 0 ? (number - bar->low) / width : 0.5;
    if (isnan(number) || isnan(at)) return NEUTRAL;
    return bar->table ? table_at(bar->table->colors, bar->table->count - 1, clamp(at))
                      : iso_colormap_at(bar->map, at);
}

/* ---- files of colours */

/* Parses red, green and blue as three numbers. */
static bool parse_numbers(const char *row, double rgb[3]) {
    static const char between[] = " \t,;";
    for (int k = 0; k < 3; k++) {
        row += strspn(row, between);
        if (!iso_parse_real_prefix(row, &rgb[k], &row) || !(rgb[k] >= 0 && rgb[k] <= 255)) return false;
    }
    return row[strspn(row, between)] == 0;
}

/* Parses RRGGBB or #RRGGBB. */
static bool parse_hexadecimal(const char *row, double rgb[3]) {
    unsigned colors = 0;
    row += *row == '#';
    if (strspn(row, "0123456789abcdefABCDEF") != 6 || row[6 + strspn(row + 6, " \t,;")]) return false;
    for (int i = 0; i < 6; i++) {
        const char c = row[i];
        colors = colors << 4 | (unsigned)(c <= '9' ? c - '0' : (c | 32) - 'a' + 10);
    }
    for (int k = 0; k < 3; k++) rgb[k] = colors >> (16 - 8 * k) & 255;
    return true;
}

/* The rows of a file: red, green and blue of each colour, as they are written. */
typedef struct color_rows {
    iso_buffer colors; /* double[3] */
    size_t count;
    double greatest; /* number, which tells 0 .. 1 from 0 .. 255 */
} color_rows;

static iso_status take_row(const char *path, int number, char *row, color_rows *rows, iso_error *error) {
    double rgb[3];
    row[strcspn(row, "\r\n")] = 0;
    if (number == 1) row += iso_text_mark(row, strlen(row));
    row += strspn(row, " \t");
    const bool hexadecimal = parse_hexadecimal(row, rgb);
    if (!*row || (*row == '#' && !hexadecimal)) return ISO_OK;
    if (!hexadecimal && !parse_numbers(row, rgb))
        return iso_fail(
            error, ISO_ERR_FORMAT,
            "%s: row %d, '%.40s', is no colour: RRGGBB, or red, green and blue from 0 to 1 or to 255", path,
            number, row);
    if (rows->count == ISO_COLOR_TABLE_MOST)
        return iso_fail(error, ISO_ERR_FORMAT, "%s: more than %d colours", path, ISO_COLOR_TABLE_MOST);
    const size_t used = rows->count * sizeof rgb;
    ISO_TRY(iso_buffer_reserve(&rows->colors, used + sizeof rgb, used, error));
    memcpy((char *)rows->colors.data + used, rgb, sizeof rgb);
    rows->count++;
    for (int k = 0; k < 3; k++) rows->greatest = fmax(rows->greatest, hexadecimal ? 255 : rgb[k]);
    return ISO_OK;
}

static iso_status take_rows(const char *path, FILE *stream, color_rows *rows, iso_error *error) {
    char row[512];
    for (int number = 1; fgets(row, sizeof row, stream); number++)
        ISO_TRY(take_row(path, number, row, rows, error));
    if (ferror(stream)) return iso_fail(error, ISO_ERR_IO, "%s: cannot be read", path);
    if (rows->count < 2)
        return iso_fail(error, ISO_ERR_FORMAT, "%s: %s: a colormap has two colours at least", path,
                        rows->count ? "has one colour" : "has no colours");
    return ISO_OK;
}

static iso_status make_table(const color_rows *rows, iso_color_table *table, iso_error *error) {
    const double(*from)[3] = rows->colors.data;
    const double scale = rows->greatest > 1 ? 1 : 255;
    table->colors = iso_alloc(rows->count * sizeof *table->colors);
    if (!table->colors) return iso_fail(error, ISO_ERR_NOMEM, "out of memory for %zu colours", rows->count);
    table->count = rows->count;
    for (size_t i = 0; i < rows->count; i++) {
        table->colors[i] = 0;
        for (int k = 0; k < 3; k++)
            table->colors[i] = table->colors[i] << 8 | (uint32_t)(from[i][k] * scale + 0.5);
    }
    return ISO_OK;
}

iso_status iso_color_table_read(const char *path, iso_color_table *table, iso_error *error) {
    FILE *stream;
    color_rows rows = {.count = 0};
    ISO_TRY(iso_file_open(path, &stream, NULL, error));
    iso_status status = take_rows(path, stream, &rows, error);
    fclose(stream);
    if (status == ISO_OK) status = make_table(&rows, table, error);
    iso_buffer_free(&rows.colors);
    return status;
}

void iso_color_table_free(iso_color_table *table) {
    iso_free(table->colors);
    *table = (iso_color_table){.colors = NULL};
}
