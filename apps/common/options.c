/* Parsing of command lines: numbers, sizes, colours, option names with suggestions, values. */
#include "apps/common/options.h"

#include <limits.h>
#include <math.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "apps/common/synonyms.h"
#include "base/text.h"
#include "base/thread.h"
#include "isopoint.h"
#include "scene/loader.h"

/* Compares words without regard to case, independent of the locale. */
static bool same_letters(const char *a, const char *b) {
    for (; *a && *b; a++, b++) {
        char x = *a >= 'A' && *a <= 'Z' ? (char)(*a - 'A' + 'a') : *a;
        if (x != *b) return false;
    }
    return *a == *b;
}

/* ---- numbers ---- */

bool iso_parse_size(const char *text, uint64_t *out) {
    static const char units[] = "KMGT";
    double value;
    const char *end;
    if (!iso_parse_real_prefix(text, &value, &end) || !(value > 0)) return false;
    if (*end) {
        const char *unit = strchr(units, *end >= 'a' ? *end - ('a' - 'A') : *end);
        if (unit)
            for (long i = unit - units; i >= 0; i--) value *= 1024;
        end += unit != NULL;
        if (unit && end[0] == 'i') end++;
        if (end[0] == 'B' || (end[0] == 'b' && unit)) end++;
    }
    if (*end || value < 1 || value >= 0x1p63) return false;
    *out = (uint64_t)value;
    return true;
}

iso_status iso_parse_items(const char *list,
                           iso_status (*take)(void *settings, const char *item, iso_error *error),
                           void *settings, iso_error *error) {
    enum { ROOM = 128 };
    for (const char *at = list;; at++) {
        char item[ROOM];
        const size_t blanks = strspn(at, " ");
        size_t length = 0;
        at += blanks;
        for (int depth = 0; at[length] && (at[length] != ',' || depth > 0); length++)
            depth += (at[length] == '(') - (at[length] == ')');
        const char *end = at + length;
        while (length && at[length - 1] == ' ') length--;
        if (length >= ROOM)
            return iso_fail(error, ISO_ERR_USAGE, "'%.40s..' is too long between two commas", at);
        snprintf(item, sizeof item, "%.*s", (int)length, at);
        ISO_TRY(take(settings, item, error));
        if (!*end) return ISO_OK;
        at = end;
    }
}

bool iso_parse_fraction(const char *text, double *out) {
    double number;
    const char *end;
    if (!iso_parse_real_prefix(text, &number, &end)) return false;
    if (strcmp(end, "%") == 0)
        number /= 100;
    else if (*end)
        return false;
    *out = number;
    return true;
}

/* Takes the number of pixels, as 640 or 640px, that *at points to, and the blanks before it. */
static bool take_pixels(const char **at, int *pixels) {
    char number[16];
    const char *text = *at + strspn(*at, " ");
    const size_t digits = strspn(text, "0123456789");
    if (digits == 0 || digits >= sizeof number) return false;
    snprintf(number, sizeof number, "%.*s", (int)digits, text);
    *at = text + digits + (strncmp(text + digits, "px", 2) == 0 ? 2 : 0);
    return iso_parse_int(number, pixels);
}

static iso_status fail_resolution(const char *text, iso_error *error) {
    static const struct {
        const char *name, *size;
    } names[] = {{"720p", "1280x720"}, {"hd", "1920x1080"}, {"1080p", "1920x1080"}, {"1440p", "2560x1440"},
                 {"2k", "2048x1080"},  {"4k", "3840x2160"}, {"uhd", "3840x2160"},   {"8k", "7680x4320"}};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        if (same_letters(text, names[i].name))
            return iso_fail(error, ISO_ERR_USAGE, "'%s' is not WxH: %s", text, names[i].size);
    return iso_fail(error, ISO_ERR_USAGE, "'%s' is neither WxH, such as 1920x1080, nor the side of a square",
                    text);
}

iso_status iso_parse_resolution(const char *text, int size[2], iso_error *error) {
    const char *at = text;
    int w, h;
    if (!take_pixels(&at, &w)) return fail_resolution(text, error);
    at += strspn(at, " ");
    const bool square = !*at;
    if (square)
        h = w;
    else if (!strchr("xX,*", *at++) || !take_pixels(&at, &h) || *at)
        return fail_resolution(text, error);
    if (w < 1 || h < 1 || w > ISO_IMAGE_MAX || h > ISO_IMAGE_MAX)
        return iso_fail(error, ISO_ERR_USAGE, "%s: sides must be 1 to %d pixels", text, ISO_IMAGE_MAX);
    size[0] = w;
    size[1] = h;
    return ISO_OK;
}

/* The value of a hexadecimal digit; below 0: it is none. */
static int digit_value(char c) {
    if (c >= '0' && c <= '9') return c - '0';
    if (c >= 'A' && c <= 'F') return c - 'A' + 10;
    return c >= 'a' && c <= 'f' ? c - 'a' + 10 : -1;
}

/* RRGGBB, or RGB, of which each digit is doubled; behind # or 0x. */
static bool parse_hexadecimal_color(const char *text, uint8_t rgb[3]) {
    if (*text == '#')
        text++;
    else if (strncmp(text, "0x", 2) == 0)
        text += 2;
    const size_t length = strlen(text), step = length / 3;
    if (length != 3 && length != 6) return false;
    for (size_t i = 0; i < length; i++)
        if (digit_value(text[i]) < 0) return false;
    for (size_t i = 0; i < 3; i++)
        rgb[i] = (uint8_t)(16 * digit_value(text[step * i]) + digit_value(text[step * i + step - 1]));
    return true;
}

static const struct color_name {
    const char *name;
    unsigned rgb;
} color_names[] = {
#include "color_names.inc"
};

/* rgb(255,128,0), as in CSS. Numbers of which none is above 1 are refused: they are meant as parts of 1. */
static bool parse_rgb_color(const char *text, uint8_t rgb[3]) {
    char numbers[64];
    double values[3];
    const size_t length = strlen(text);
    if (strncmp(text, "rgb(", 4) != 0 || text[length - 1] != ')' || length >= sizeof numbers) return false;
    snprintf(numbers, sizeof numbers, "%.*s", (int)(length - 5), text + 4);
    if (!iso_parse_reals(numbers, 3, values)) return false;
    double most = 0;
    for (int i = 0; i < 3; i++) {
        if (!(values[i] >= 0 && values[i] <= 255)) return false;
        most = fmax(most, values[i]);
    }
    if (most > 0 && most <= 1) return false;
    for (int i = 0; i < 3; i++) rgb[i] = (uint8_t)(values[i] + 0.5);
    return true;
}

bool iso_parse_color(const char *text, uint8_t rgb[3]) {
    if (parse_hexadecimal_color(text, rgb) || parse_rgb_color(text, rgb)) return true;
    for (size_t i = 0; i < sizeof color_names / sizeof *color_names; i++) {
        if (!same_letters(text, color_names[i].name)) continue;
        for (int k = 0; k < 3; k++) rgb[k] = (uint8_t)(color_names[i].rgb >> (16 - 8 * k));
        return true;
    }
    return false;
}

iso_status iso_fail_color(const char *text, const char *others, iso_error *error) {
    const bool transparent = same_letters(text, "transparent") || same_letters(text, "none");
    if (transparent && !*others)
        return iso_fail(error, ISO_ERR_USAGE, "'%s' is no colour: an opacity below 1 lets be seen through",
                        text);
    return iso_fail(error, ISO_ERR_USAGE,
                    "'%s' is neither RRGGBB in hexadecimal, rgb(255,128,0), nor a colour name of CSS%s", text,
                    others);
}

/* ---- names ---- */

const iso_option *iso_options_find(const iso_program *program, const char *name, size_t length) {
    for (size_t i = 0; i < program->option_count; i++) {
        const iso_option *option = &program->options[i];
        if (iso_text_has_word(option->name, name, length) || iso_text_has_word(option->aliases, name, length))
            return option;
    }
    return NULL;
}

enum { NAME_MAX_LENGTH = 63 };

static int least(int a, int b, int c) {
    int low = a < b ? a : b;
    return low < c ? low : c;
}

/* Returns the number of edits (insert, delete, replace, swap neighbours) from one name to another. */
static int distance(const char *a, const char *b) {
    int row[3][NAME_MAX_LENGTH + 1];
    int la = (int)strlen(a), lb = (int)strlen(b);
    if (la > NAME_MAX_LENGTH || lb > NAME_MAX_LENGTH) return INT_MAX;
    for (int j = 0; j <= lb; j++) row[0][j] = j;
    for (int i = 1; i <= la; i++) {
        int *now = row[i % 3], *last = row[(i + 2) % 3], *before = row[(i + 1) % 3];
        now[0] = i;
        for (int j = 1; j <= lb; j++) {
            now[j] = least(last[j] + 1, now[j - 1] + 1, last[j - 1] + (a[i - 1] != b[j - 1]));
            bool swapped = i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1];
            if (swapped && before[j - 2] + 1 < now[j]) now[j] = before[j - 2] + 1;
        }
    }
    return row[la % 3][lb];
}

/* Returns a measure of how different a typed name is; the beginning of a name is nearer than any misspelt
 * name. */
static int remoteness(const char *typed, const char *name) {
    size_t length = strlen(typed);
    if (length >= 2 && strncmp(typed, name, length) == 0) return 0;
    int edits = distance(typed, name);
    int allowed = length < 6 ? 1 : length < 9 ? 2 : 3;
    return edits <= allowed ? edits : INT_MAX;
}

const char *iso_options_nearest(const iso_program *program, const char *name, int most) {
    const char *nearest = NULL;
    int best = most;
    for (size_t i = 0; i < program->option_count; i++) {
        const iso_option *option = &program->options[i];
        if (option->flags & ISO_OPTION_HIDDEN) continue;
        int far = remoteness(name, option->name);
        if (far < best) {
            best = far;
            nearest = option->name;
        }
    }
    return nearest;
}

/* Explains a name, without dashes before it, that is an option's or a word of other programs. */
static bool explain_known(const iso_program *program, const char *name, char *hint, size_t size) {
    if (!iso_options_find(program, name, strlen(name))) return iso_synonym_explain(program, name, hint, size);
    snprintf(hint, size, "did you mean --%s?", name);
    return true;
}

/* Explains a name of several words by those of them that are known: by as many neighbours as possible, the
 * first ones of several. */
static bool explain_words(const iso_program *program, const char *name, char *hint, size_t size) {
    int begin[NAME_MAX_LENGTH + 2] = {0}, words = 1;
    for (int i = 0; name[i]; i++)
        if (name[i] == '-') begin[words++] = i + 1;
    begin[words] = (int)strlen(name) + 1;
    for (int count = words - 1; count > 0; count--)
        for (int first = 0; first + count <= words; first++) {
            char part[NAME_MAX_LENGTH + 1];
            const int length = begin[first + count] - 1 - begin[first];
            snprintf(part, sizeof part, "%.*s", length, name + begin[first]);
            if (*part && explain_known(program, part, hint, size)) return true;
        }
    return false;
}

/* Writes a name as the names of options are written: in lower case, words joined by '-'. */
static void write_name(const char *typed, char *name, size_t size) {
    snprintf(name, size, "%.*s", (int)strcspn(typed, "="), typed);
    for (; *name; name++)
        *name = *name == '_' ? '-' : *name >= 'A' && *name <= 'Z' ? (char)(*name - 'A' + 'a') : *name;
}

/* Writes an unknown option as "--name (what is meant)". */
static void explain_unknown(const iso_program *program, const char *argument, char *text, size_t size) {
    char name[NAME_MAX_LENGTH + 1], hint[256];
    write_name(argument + strspn(argument, "-"), name, sizeof name);
    if (iso_options_find(program, name, strlen(name))) /* with one dash, or in capitals */
        snprintf(hint, sizeof hint, "did you mean %s%s?", name[1] ? "--" : "-", name);
    else if (!iso_synonym_explain(program, name, hint, sizeof hint)) {
        const char *nearest = iso_options_nearest(program, name, 2); /* its beginning, or a letter is wrong */
        if (nearest || !explain_words(program, name, hint, sizeof hint)) {
            if (!nearest) nearest = iso_options_nearest(program, name, INT_MAX);
            snprintf(hint, sizeof hint, nearest ? "did you mean --%s?" : "see --help", nearest);
        }
    }
    snprintf(text, size, "%.*s (%s)", (int)strcspn(argument, "="), argument, hint);
}

/* The option that an argument names: -x has one letter, --name has more. NULL: there is none. */
static const iso_option *option_of(const iso_program *program, const char *argument) {
    const size_t dashes = argument[1] == '-' ? 2 : 1, length = strcspn(argument + dashes, "=");
    return (length == 1) == (dashes == 1) ? iso_options_find(program, argument + dashes, length) : NULL;
}

/* Whether the argument behind an option whose value is optional can only be meant as its value. */
static bool is_value_of(const iso_option *option, const char *next) {
    return next && *next != '-' && option->extension && iso_text_has_extension(next, option->extension);
}

/* The value of an option is missing: it is named, or what it can be. */
static iso_status fail_missing(const iso_option *option, iso_error *error) {
    char names[200] = "";
    for (size_t i = 0, used = 0; option->choices && option->choices[i] && used < sizeof names; i++)
        used += (size_t)snprintf(names + used, sizeof names - used, "%s%s", i ? ", " : " is one of ",
                                 option->choices[i]);
    return iso_fail(error, ISO_ERR_USAGE, "option --%s needs a value: %s%s", option->name, option->value,
                    names);
}

/* Finds the value of an option, which follows '=' or is the next argument; in this case *index is
 * advanced. */
static iso_status find_value(const iso_option *option, int argc, char *const *argv, int *index,
                             const char **value, iso_error *error) {
    const char *argument = argv[*index], *equals = strchr(argument, '=');
    bool none = option->value == NULL;
    *value = equals ? equals + 1 : NULL;
    if (equals && none) return iso_fail(error, ISO_ERR_USAGE, "option --%s takes no value", option->name);
    const char *next = *index + 1 < argc ? argv[*index + 1] : NULL;
    const bool optional = option->flags & ISO_OPTION_VALUE_OPTIONAL;
    if (equals || none || (optional && !is_value_of(option, next))) return ISO_OK;
    if (!next || strncmp(next, "--", 2) == 0) return fail_missing(option, error);
    *value = next;
    ++*index;
    return ISO_OK;
}

/* Fails with all unknown options from argv[first], which is one, on: a list of them, not one a try. Of the
 * arguments that follow an unknown option the first may be its value. */
static iso_status fail_unknown(const iso_program *program, int argc, char *const *argv, int first,
                               iso_error *error) {
    char all[sizeof error->text] = "";
    size_t used = 0;
    int count = 0, more = 0;
    for (int i = first; i < argc && strcmp(argv[i], "--") != 0; i++) {
        const bool long_name = strncmp(argv[i], "--", 2) == 0; /* -1 may be a number */
        if (i > first && !long_name) continue;
        const iso_option *option = option_of(program, argv[i]);
        const char *value;
        if (option && find_value(option, argc, argv, &i, &value, NULL) == ISO_OK) continue;
        if (option) break;
        char one[384];
        explain_unknown(program, argv[i], one, sizeof one);
        if (used + strlen(one) + 64 > sizeof all) {
            more++;
            continue;
        }
        used += (size_t)snprintf(all + used, sizeof all - used, "%s%s", count++ ? ", " : "", one);
    }
    if (more) snprintf(all + used, sizeof all - used, ", and %d more", more);
    return iso_fail(error, ISO_ERR_USAGE, "unknown option%s %s", count > 1 ? "s" : "", all);
}

/* ---- values ---- */

static bool in_range(const iso_option *option, double value) {
    return value >= option->low && value <= option->high;
}

static iso_status store_int(const iso_option *option, const char *value, int *out, iso_error *error) {
    int number;
    if (!iso_parse_int(value, &number) || !in_range(option, number))
        return iso_fail(error, ISO_ERR_USAGE, "'%s' is not a whole number from %.0f to %.0f%s%s%s", value,
                        option->low, option->high, option->standard ? " (default: " : "",
                        option->standard ? option->standard : "", option->standard ? ")" : "");
    *out = number;
    return ISO_OK;
}

static iso_status store_real(const iso_option *option, const char *value, double *out, iso_error *error) {
    double number;
    const bool fraction = option->flags & ISO_OPTION_PERCENT;
    if (!(fraction ? iso_parse_fraction(value, &number) : iso_parse_real(value, &number)))
        return iso_fail(error, ISO_ERR_USAGE, "'%s' is not a number%s", value,
                        fraction ? ", or one of percent" : "");
    if (!in_range(option, number))
        return iso_fail(error, ISO_ERR_USAGE, "%s is not in %g .. %g", value, option->low, option->high);
    *out = number;
    return ISO_OK;
}

static iso_status store_ints(const iso_option *option, const char *value, int *out, iso_error *error) {
    double numbers[16];
    bool good = iso_parse_reals(value, option->count, numbers);
    for (int i = 0; good && i < option->count; i++)
        good = numbers[i] == floor(numbers[i]) && in_range(option, numbers[i]);
    if (!good)
        return iso_fail(error, ISO_ERR_USAGE, "'%s' is not %d whole numbers separated by commas", value,
                        option->count);
    for (int i = 0; i < option->count; i++) out[i] = (int)numbers[i];
    return ISO_OK;
}

static iso_status store_choice(const iso_option *option, const char *value, int *out, iso_error *error) {
    char known[256] = "";
    size_t used = 0;
    for (int i = 0; option->choices[i]; i++) {
        if (same_letters(value, option->choices[i])) {
            *out = i;
            return ISO_OK;
        }
        if (used < sizeof known)
            used += (size_t)snprintf(known + used, sizeof known - used, "%s%s", i ? ", " : "",
                                     option->choices[i]);
    }
    return iso_fail(error, ISO_ERR_USAGE, "'%s' is not one of %s%s%s", value, known, option->hint ? "; " : "",
                    option->hint ? option->hint : "");
}

/* A number alone is in bytes. Nobody means a memory of so few. */
static iso_status store_size(const char *value, uint64_t *bytes, iso_error *error) {
    enum { LEAST = 1 << 20 };
    if (!iso_parse_size(value, bytes))
        return iso_fail(error, ISO_ERR_USAGE, "'%s' is not a size such as 512M or 2G", value);
    if (*bytes < LEAST && strspn(value, "0123456789") == strlen(value))
        return iso_fail(error, ISO_ERR_USAGE, "'%s' is in bytes: write %sM or %sG", value, value, value);
    return ISO_OK;
}

static iso_status append_text(const char *value, iso_texts *texts, iso_error *error) {
    if (texts->count == ISO_TEXTS) return iso_fail(error, ISO_ERR_USAGE, "more than %d values", ISO_TEXTS);
    texts->values[texts->count++] = value;
    return ISO_OK;
}

iso_status iso_option_store(const iso_option *option, const char *value, void *settings, iso_error *error) {
    void *field = (char *)settings + option->offset;
    switch (option->kind) {
    case ISO_OPTION_FLAG:
        *(int *)field = 1;
        return ISO_OK;
    case ISO_OPTION_TEXT:
        if (!*value) return iso_fail(error, ISO_ERR_USAGE, "the value is empty");
        *(const char **)field = value;
        return ISO_OK;
    case ISO_OPTION_TEXTS:
        return append_text(value, field, error);
    case ISO_OPTION_INT:
        if (!value) *(int *)field = 1;
        if (!value) return ISO_OK;
        return store_int(option, value, field, error);
    case ISO_OPTION_REAL:
        return store_real(option, value, field, error);
    case ISO_OPTION_REALS:
        if (iso_parse_reals(value, option->count, field)) return ISO_OK;
        return iso_fail(error, ISO_ERR_USAGE, "'%s' is not %d numbers separated by commas", value,
                        option->count);
    case ISO_OPTION_INTS:
        return store_ints(option, value, field, error);
    case ISO_OPTION_CHOICE:
        return store_choice(option, value, field, error);
    case ISO_OPTION_SIZE:
        return store_size(value, field, error);
    case ISO_OPTION_CALL:
        break;
    }
    return option->apply(settings, value, error);
}

/* ---- the command line ---- */

static iso_status parse_option(const iso_program *program, int argc, char *const *argv, int *index,
                               void *settings, iso_error *error) {
    const iso_option *option = option_of(program, argv[*index]);
    if (!option) return fail_unknown(program, argc, argv, *index, error);
    const char *value = NULL;
    ISO_TRY(find_value(option, argc, argv, index, &value, error));
    iso_error detail = {0};
    iso_status status = iso_option_store(option, value, settings, &detail);
    if (status != ISO_OK) return iso_fail(error, status, "option --%s: %s", option->name, detail.text);
    if (program->seen) program->seen(settings, option, value);
    return ISO_OK;
}

iso_status iso_options_parse(const iso_program *program, int argc, char *const *argv, void *settings,
                             iso_operands *operands, iso_error *error) {
    bool options = true;
    operands->count = 0;
    const iso_option *help = iso_options_find(program, "help", strlen("help"));
    if (help && argc > 1 && strcmp(argv[1], help->name) == 0 && access(argv[1], F_OK) != 0)
        return iso_option_store(help, argc > 2 ? argv[2] : NULL, settings, error);
    for (int i = 1; i < argc; i++) {
        bool operand = !options || argv[i][0] != '-' || !argv[i][1];
        if (operand)
            operands->values[operands->count++] = argv[i];
        else if (strcmp(argv[i], "--") == 0)
            options = false;
        else
            ISO_TRY(parse_option(program, argc, argv, &i, settings, error));
    }
    return ISO_OK;
}

int iso_options_without(const iso_program *program, int argc, char *const *argv, const char *const *names,
                        int count, char **kept) {
    bool options = true;
    int left = 0;
    for (int i = 0; i < argc; i++) {
        const int first = i;
        const size_t dashes = argv[i][0] == '-' ? 1 + (argv[i][1] == '-') : 0;
        const iso_option *option = i && options && dashes ? iso_options_find(program, argv[i] + dashes,
                                                                             strcspn(argv[i] + dashes, "="))
                                                          : NULL;
        const char *value;
        bool out = false;
        options &= strcmp(argv[i], "--") != 0;
        if (option && find_value(option, argc, argv, &i, &value, NULL) == ISO_OK)
            for (int k = 0; k < count; k++) out |= strcmp(option->name, names[k]) == 0;
        for (int k = first; k <= i && !out; k++) kept[left++] = argv[k];
    }
    return left;
}

typedef struct main_call {
    int argc;
    char **argv;
    int (*run)(int argc, char **argv);
    int status;
} main_call;

static void *call_main(void *argument) {
    main_call *call = argument;
    call->status = call->run(call->argc, call->argv);
    return NULL;
}

int iso_program_main(int argc, char **argv, int (*run)(int argc, char **argv)) {
    signal(SIGPIPE, SIG_IGN);
    signal(SIGXFSZ, SIG_IGN);
    iso_volume_use_servers();
    main_call call = {.argc = argc, .argv = argv, .run = run};
    iso_call_with_stack(call_main, &call);
    return call.status;
}
