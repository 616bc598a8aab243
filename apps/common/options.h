/* options: parses a command line according to a program's table of options. The same table produces --help,
 * the man page, the table in docs and the shell completion.
 *
 * Values are given as `--name value` or `--name=value`; a value that begins with `--` needs the second form.
 * `help` as the first word is --help, unless there is a file of that name; a word behind it is its topic.
 * `--` ends options, `-` alone is an operand. If an option is given several times the last one wins, unless
 * its row allows repetition. Numbers are decimal, must fill the whole text, and do not depend on the
 * locale. */
#ifndef ISO_APPS_COMMON_OPTIONS_H
#define ISO_APPS_COMMON_OPTIONS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include "base/c_linkage.h"
#include "base/parse.h"
#include "base/status.h"

ISO_C_BEGIN

/* How a value is parsed, and the type of the member at `offset` in the program's settings. */
typedef enum iso_option_kind {
    ISO_OPTION_FLAG,   /* int, set to 1; takes no value */
    ISO_OPTION_TEXT,   /* const char *, borrowed from argv */
    ISO_OPTION_TEXTS,  /* iso_texts: every value that is given */
    ISO_OPTION_INT,    /* int in low .. high */
    ISO_OPTION_REAL,   /* double in low .. high */
    ISO_OPTION_REALS,  /* double[count], separated by commas */
    ISO_OPTION_INTS,   /* int[count], separated by commas, each in low .. high */
    ISO_OPTION_CHOICE, /* int, the index in `choices` */
    ISO_OPTION_SIZE,   /* uint64_t bytes: 512M, 2G, 1.5GiB (powers of 1024), 2000000 */
    ISO_OPTION_CALL    /* `apply` parses and stores it */
} iso_option_kind;

/* The values of a repeatable option, borrowed from argv. */
enum { ISO_TEXTS = 32 };
typedef struct iso_texts {
    const char *values[ISO_TEXTS];
    int count;
} iso_texts;

enum {
    ISO_OPTION_HIDDEN = 1,         /* parsed, but not shown in the help */
    ISO_OPTION_VALUE_OPTIONAL = 2, /* `--name` alone is allowed; a value only as `--name=value`, or with
                                      the option's extension; an ISO_OPTION_INT is 1 without */
    ISO_OPTION_REPEATABLE = 4,     /* shown in the help; the option's kind or `apply` collects the values */
    ISO_OPTION_UNRECORDED = 8,     /* affects how the program runs, but not its result */
    ISO_OPTION_PERCENT = 16,       /* an ISO_OPTION_REAL may be given as 150% for 1.5 */
    ISO_OPTION_READS = 32,         /* the value is the path of a file that is read */
    ISO_OPTION_READS_PART = 64     /* the value may contain such a path (value_path.h) */
};

typedef struct iso_option {
    const char *name;     /* without dashes */
    const char *aliases;  /* further names, separated by blanks; one letter means -x; NULL for none */
    const char *value;    /* placeholder of the value; NULL for flags */
    const char *help;     /* one sentence, no full stop; iso_options_expand completes it */
    const char *standard; /* the default, as shown in the help; or NULL */
    iso_option_kind kind;
    unsigned flags;
    int group; /* index in iso_program.groups */
    size_t offset;
    double low, high;
    int count;
    const char *const *choices; /* NULL-terminated */
    const char *hint;           /* of an ISO_OPTION_CHOICE: said behind the refusal of a value; or NULL */
    const char
        *extension; /* of an optional value: the next argument is it if it ends with this; or NULL: never */
    /* For ISO_OPTION_CALL; value is NULL when it was omitted. Fails with iso_fail(ISO_ERR_USAGE, reason); the
     * name of the option is added in front of the reason. */
    iso_status (*apply)(void *settings, const char *value, iso_error *error);
} iso_option;

/* A part of the help below the options: "Exit status"; the last one has the examples. Lines are
 * NULL-terminated. */
typedef struct iso_section {
    const char *title;
    const char *const *lines;
} iso_section;

typedef struct iso_program {
    const char *name, *version, *summary;
    const char *const *usage;  /* operands for each form of the command, NULL-terminated */
    const char *const *groups; /* titles, NULL-terminated */
    const iso_option *options;
    size_t option_count;
    const iso_section *sections;
    size_t section_count;
    /* Called for every option that was parsed, in order, after it was applied; may be NULL. */
    void (*seen)(void *settings, const iso_option *option, const char *value);
} iso_program;

/* Operands: pointers into argv. The caller owns `values`, which has room for argc pointers. */
typedef struct iso_operands {
    const char **values;
    int count;
} iso_operands;

/* Parses argv[1 .. argc - 1] into settings. ISO_ERR_USAGE names the option, and the nearest one when there is
 * no such option. settings may have been changed when it fails. */
iso_status iso_options_parse(const iso_program *program, int argc, char *const *argv, void *settings,
                             iso_operands *operands, iso_error *error);

/* The name of the option that is nearest to a typed one, if it is nearer than `most`; NULL: there is none. */
const char *iso_options_nearest(const iso_program *program, const char *name, int most);

/* Copies argv to `kept`, which has room for it, without the options of these names and their values.
 * Returns how many arguments are left. */
int iso_options_without(const iso_program *program, int argc, char *const *argv, const char *const *names,
                        int count, char **kept);

/* The option with this name or alias, of `length` characters without dashes; NULL: there is none. */
const iso_option *iso_options_find(const iso_program *program, const char *name, size_t length);

/* Parses the value of one option into settings; NULL: the option was given without one. ISO_ERR_USAGE: the
 * reason, without the option's name. */
iso_status iso_option_store(const iso_option *option, const char *value, void *settings, iso_error *error);

/* Parses a number of bytes, such as 512M. False, and *out untouched, when `text` is anything else. */
bool iso_parse_size(const char *text, uint64_t *out);
/* Parses a number, or a percentage: 0.3 or 30%. False, and *out untouched, when `text` is anything else. */
bool iso_parse_fraction(const char *text, double *out);
/* Calls `take` with each item of a list, without the blanks around it, in order. Items are separated by
 * commas that are not within parentheses; an item may be empty. Ends with the first error: of `take`, or
 * ISO_ERR_USAGE of an item with 128 characters or more. */
iso_status iso_parse_items(const char *list,
                           iso_status (*take)(void *settings, const char *item, iso_error *error),
                           void *settings, iso_error *error);
/* Parses WxH, W,H or W*H, in pixels with or without px: sides of a picture, 1 .. ISO_IMAGE_MAX. ISO_ERR_USAGE
 * says what is wrong. */
iso_status iso_parse_resolution(const char *text, int size[2], iso_error *error);
/* Parses RRGGBB or RGB in hexadecimal, with #, 0x or nothing before it, rgb(R,G,B) with numbers to 255, or
 * one of the 148 colour names of CSS, in either case. */
bool iso_parse_color(const char *text, uint8_t rgb[3]);
/* Says why `text` is no colour. others: " nor ..", what else the option takes; or "". Returns
 * ISO_ERR_USAGE. */
iso_status iso_fail_color(const char *text, const char *others, iso_error *error);

/* Writes a text of a help with the extensions of files (base/file_types.h) where it says {volumes}, {meshes},
 * {lines}, {glyphs}, {points}, {rows} or {meshes written}. Cut to `room`. */
void iso_options_expand(const char *text, char *expanded, size_t room);

/* Prints help. topic: NULL, a page with usage, examples and topics; the first word of a group's or a
 * section's title, these; "all", everything; "markdown", "man" or "bash", everything as a table for docs, a
 * man page or a completion script; any other word, the options that speak of it. ISO_ERR_USAGE: none does. */
iso_status iso_options_help(const iso_program *program, const char *topic, FILE *stream, iso_error *error);

/* Prints one line on stderr that begins with the program's name. Arguments may contain any bytes
 * (base/text.h). */
#if defined(__GNUC__)
__attribute__((format(printf, 2, 3)))
#endif
void iso_program_log(const iso_program *program, const char *format, ...);

/* Prints the error on stderr and returns the exit status for `status`. */
int iso_program_fail(const iso_program *program, const iso_error *error, iso_status status);

/* For the main function of a program: calls run(argc, argv) with enough stack for the library and returns its
 * result. Signals for a closed pipe and for a file that may not grow are ignored, so that they become write
 * errors, and files that are read may be on web servers. */
int iso_program_main(int argc, char **argv, int (*run)(int argc, char **argv));

/* Flushes standard output. Returns the exit status: `status`, or that of ISO_ERR_WRITE when `status` is 0 and
 * standard output could not be written. */
int iso_program_finish(const iso_program *program, int status);

ISO_C_END
#endif
