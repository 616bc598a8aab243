/* The texts generated from an option table: help for a screen, table for docs, man page (roff), shell
 * completion. */
#include <ctype.h>
#include <errno.h>
#include <stdarg.h>
#include <string.h>
#include <strings.h>

#include "apps/common/options.h"
#include "apps/common/progress_bar.h"
#include "apps/common/synonyms.h"
#include "base/file_types.h"
#include "base/text.h"

enum { COLUMN = 31, WIDTH = 100 };

static bool is_shown(const iso_option *option, int group) {
    return option->group == group && !(option->flags & ISO_OPTION_HIDDEN);
}

/* Returns the first one-letter alias, or 0. */
static char letter_of(const iso_option *option) {
    for (const char *word = option->aliases; word && *word;) {
        size_t length = strcspn(word, " ");
        if (length == 1) return *word;
        word += length + (word[length] == ' ');
    }
    return 0;
}

/* Writes an option as it is typed, "--name VALUE", to `text`. */
static void write_form(const iso_option *option, char *text, size_t size) {
    if (!option->value)
        snprintf(text, size, "--%s", option->name);
    else if (option->flags & ISO_OPTION_VALUE_OPTIONAL)
        snprintf(text, size, "--%s[=%s]", option->name, option->value);
    else
        snprintf(text, size, "--%s %s", option->name, option->value);
}

/* The words in texts that stand for the extensions of files. */
static const struct {
    const char *word;
    unsigned holds;
} lists[] = {
    {"{volumes}", ISO_HOLDS_VOLUME}, {"{meshes}", ISO_HOLDS_MESH},          {"{lines}", ISO_HOLDS_LINES},
    {"{glyphs}", ISO_HOLDS_GLYPHS},  {"{points}", ISO_HOLDS_POINTS},        {"{rows}", ISO_HOLDS_ROWS},
    {"{scenes}", ISO_HOLDS_SCENE},   {"{meshes written}", ISO_WRITES_MESH}, {"{videos}", ISO_WRITES_VIDEO}};

void iso_options_expand(const char *text, char *expanded, size_t room) {
    size_t used = 0;
    *expanded = 0;
    while (*text && used + 1 < room) {
        char list[512];
        size_t length = strcspn(text + 1, "{") + 1, skip = length;
        const char *piece = text;
        for (size_t i = 0; i < sizeof lists / sizeof *lists; i++) {
            if (strncmp(text, lists[i].word, strlen(lists[i].word)) != 0) continue;
            iso_file_type_extensions(lists[i].holds, 0, "or", list, sizeof list);
            piece = list;
            length = strlen(list);
            skip = strlen(lists[i].word);
        }
        if (length >= room - used) length = room - used - 1;
        memcpy(expanded + used, piece, length);
        used += length;
        expanded[used] = 0;
        text += skip;
    }
}

static void write_help(const iso_option *option, char *text, size_t size) {
    char help[960];
    iso_options_expand(option->help, help, sizeof help);
    snprintf(text, size, "%s%s%s%s%s", help, option->flags & ISO_OPTION_REPEATABLE ? "; repeatable" : "",
             option->standard ? " (default: " : "", option->standard ? option->standard : "",
             option->standard ? ")" : "");
}

/* ---- screen ---- */

/* Prints words of text in lines that begin at this column; the first one has begun. */
static void print_wrapped(FILE *stream, const char *text, int column) {
    for (int at = column; *text;) {
        int length = (int)strcspn(text, " ");
        if (at > column && at + 1 + length > WIDTH) {
            fprintf(stream, "\n%*s", column, "");
            at = column;
        }
        if (at > column) at += fprintf(stream, " ");
        at += fprintf(stream, "%.*s", length, text);
        text += length + (text[length] == ' ');
    }
    fprintf(stream, "\n");
}

static void print_option(FILE *stream, const iso_option *option) {
    char form[128], help[1024];
    write_form(option, form, sizeof form);
    write_help(option, help, sizeof help);
    char letter = letter_of(option);
    int at = letter ? fprintf(stream, "  -%c, %s", letter, form) : fprintf(stream, "  %s", form);
    if (at >= COLUMN - 1) {
        fprintf(stream, "\n");
        at = 0;
    }
    fprintf(stream, "%*s", COLUMN - at, "");
    print_wrapped(stream, help, COLUMN);
}

static void print_group(const iso_program *program, int group, FILE *stream) {
    fprintf(stream, "\n%s:\n", program->groups[group]);
    for (size_t i = 0; i < program->option_count; i++)
        if (is_shown(&program->options[i], group)) print_option(stream, &program->options[i]);
}

static void print_section(const iso_section *section, FILE *stream) {
    fprintf(stream, "\n%s:\n", section->title);
    for (const char *const *line = section->lines; *line; line++) {
        char text[1024];
        iso_options_expand(*line, text, sizeof text);
        fprintf(stream, "  ");
        if (strcmp(text, *line) == 0)
            fprintf(stream, "%s\n", text);
        else
            print_wrapped(stream, text, 2);
    }
}

static void print_usage(const iso_program *program, FILE *stream) {
    for (int i = 0; program->usage[i]; i++)
        fprintf(stream, "%s %s %s\n", i ? "      " : "usage:", program->name, program->usage[i]);
    fprintf(stream, "\n%s\n", program->summary);
}

static void print_everything(const iso_program *program, FILE *stream) {
    print_usage(program, stream);
    for (int group = 0; program->groups[group]; group++) print_group(program, group, stream);
    for (size_t i = 0; i < program->section_count; i++) print_section(&program->sections[i], stream);
}

/* ---- topics ---- */

/* Whether a word is the first one of a title, in either case. */
static bool is_first_word(const char *title, const char *word) {
    const size_t length = strcspn(title, " ,:");
    return strlen(word) == length && strncasecmp(title, word, length) == 0;
}

/* Writes "input, surface, ..": the first words of all titles, each once. */
static void write_topics(const iso_program *program, char *text, size_t size) {
    const char *titles[32];
    size_t count = 0, used = 0;
    for (int i = 0; program->groups[i]; i++) titles[count++] = program->groups[i];
    for (size_t i = 0; i < program->section_count; i++) titles[count++] = program->sections[i].title;
    for (size_t i = 0; i < count && used < size; i++) {
        const int length = (int)strcspn(titles[i], " ,:");
        if (i > 0 && strncasecmp(titles[i], titles[i - 1], (size_t)length) == 0) continue;
        used += (size_t)snprintf(text + used, size - used, "%s%c%.*s", used ? ", " : "",
                                 tolower((unsigned char)*titles[i]), length - 1, titles[i] + 1);
    }
}

static void print_first_page(const iso_program *program, FILE *stream) {
    char topics[512];
    print_usage(program, stream);
    print_section(&program->sections[program->section_count - 1], stream); /* the examples */
    write_topics(program, topics, sizeof topics);
    fprintf(stream, "\nMore, by --help TOPIC:%*s", COLUMN - (int)strlen("More, by --help TOPIC:"), "");
    print_wrapped(stream, topics, COLUMN);
    fprintf(stream, "--help WORD: the options that speak of it; --help all: everything\n");
}

static bool print_topic(const iso_program *program, const char *topic, FILE *stream) {
    bool found = false;
    for (int group = 0; program->groups[group]; group++)
        if (is_first_word(program->groups[group], topic)) {
            print_group(program, group, stream);
            found = true;
        }
    for (size_t i = 0; i < program->section_count; i++)
        if (is_first_word(program->sections[i].title, topic)) {
            print_section(&program->sections[i], stream);
            found = true;
        }
    return found;
}

/* Whether an option's name, its aliases or what is said about it has a word that begins with `word`. */
static bool speaks_of(const iso_option *option, const char *word) {
    char help[1024];
    const char *texts[] = {option->name, option->aliases, option->value, help};
    iso_options_expand(option->help, help, sizeof help);
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++)
        for (const char *at = texts[i]; at && *at; at++)
            if ((at == texts[i] || !isalnum((unsigned char)at[-1])) &&
                strncasecmp(at, word, strlen(word)) == 0)
                return true;
    return false;
}

/* How well an option answers a question for a word: 0: it is called so, also by others; 1: it speaks of it.
 * */
enum { CALLED, SPOKEN_OF, NEITHER };
static int rank(const iso_program *program, const iso_option *option, const char *word, const char *name) {
    if (iso_options_find(program, name, strlen(name)) == option || iso_synonym_means(name, option->name))
        return CALLED;
    return speaks_of(option, word) || speaks_of(option, name) ? SPOKEN_OF : NEITHER;
}

/* Prints the options that a word is the name of, or what others call them, and then those that speak of it.
 * */
static bool print_options_with(const iso_program *program, const char *word, FILE *stream) {
    bool found = false;
    char name[64]; /* as an option's name */
    snprintf(name, sizeof name, "%s", word);
    for (char *c = name; *c; c++) *c = *c == ' ' || *c == '_' ? '-' : (char)tolower((unsigned char)*c);
    for (int wanted = CALLED; wanted < NEITHER; wanted++)
        for (int group = 0; program->groups[group]; group++)
            for (size_t i = 0; i < program->option_count; i++) {
                const iso_option *option = &program->options[i];
                if (!is_shown(option, group) || rank(program, option, word, name) != wanted) continue;
                print_option(stream, option);
                found = true;
            }
    return found;
}

/* ---- markdown ---- */

static void print_cell(FILE *stream, const char *text) {
    for (; *text; text++) {
        if (*text == '|') fputc('\\', stream);
        fputc(*text, stream);
    }
}

/* Prints the aliases of more than one letter as "--a, --b". */
static void print_aliases(FILE *stream, const iso_option *option, const char *before, const char *quote) {
    const char *separator = before;
    for (const char *word = option->aliases; word && *word;) {
        int length = (int)strcspn(word, " ");
        fprintf(stream, "%s%s%s%.*s%s", separator, quote, length == 1 ? "-" : "--", length, word, quote);
        separator = ", ";
        word += length + (word[length] == ' ');
    }
}

static void print_markdown(const iso_program *program, FILE *stream) {
    fprintf(stream, "| option | what it does |\n|---|---|\n");
    for (int group = 0; program->groups[group]; group++) {
        fprintf(stream, "| **%s** | |\n", program->groups[group]);
        for (size_t i = 0; i < program->option_count; i++) {
            const iso_option *option = &program->options[i];
            if (!is_shown(option, group)) continue;
            char form[128], help[1024];
            write_form(option, form, sizeof form);
            write_help(option, help, sizeof help);
            fprintf(stream, "| `");
            print_cell(stream, form);
            fprintf(stream, "` | ");
            print_cell(stream, help);
            print_aliases(stream, option, "; also ", "`");
            fprintf(stream, " |\n");
        }
    }
}

/* ---- man page ---- */

/* Prints text for roff: escapes dashes and backslashes, and dots and quotes at the beginning of a line. */
static void print_roff(FILE *stream, const char *text) {
    if (*text == '.' || *text == '\'') fputs("\\&", stream);
    for (; *text; text++) {
        if (*text == '-')
            fputs("\\-", stream);
        else if (*text == '\\')
            fputs("\\e", stream);
        else
            fputc(*text, stream);
    }
}

static void print_man_option(FILE *stream, const iso_option *option) {
    char form[128], help[1024];
    write_form(option, form, sizeof form);
    write_help(option, help, sizeof help);
    fprintf(stream, ".TP\n.B ");
    char letter = letter_of(option);
    if (letter) fprintf(stream, "\\-%c, ", letter);
    print_roff(stream, form);
    fprintf(stream, "\n");
    print_roff(stream, help);
    print_aliases(stream, option, "; also ", "");
    fprintf(stream, "\n");
}

static void print_upper(FILE *stream, const char *text) {
    for (; *text; text++) fputc(toupper((unsigned char)*text), stream);
}

static void print_man(const iso_program *program, FILE *stream) {
    fprintf(stream, ".TH ");
    print_upper(stream, program->name);
    fprintf(stream, " 1 \"\" \"%s %s\" \"User Commands\"\n.SH NAME\n%s \\- ", program->name, program->version,
            program->name);
    print_roff(stream, program->summary);
    fprintf(stream, "\n.SH SYNOPSIS\n");
    for (int i = 0; program->usage[i]; i++) {
        fprintf(stream, "%s.B %s\n", i ? ".br\n" : "", program->name);
        print_roff(stream, program->usage[i]);
        fprintf(stream, "\n");
    }
    fprintf(stream, ".SH OPTIONS\n");
    for (int group = 0; program->groups[group]; group++) {
        fprintf(stream, ".SS %s\n", program->groups[group]);
        for (size_t i = 0; i < program->option_count; i++)
            if (is_shown(&program->options[i], group)) print_man_option(stream, &program->options[i]);
    }
    for (size_t i = 0; i < program->section_count; i++) {
        fprintf(stream, ".SH ");
        print_upper(stream, program->sections[i].title);
        fprintf(stream, "\n.nf\n");
        for (const char *const *line = program->sections[i].lines; *line; line++) {
            char text[1024];
            iso_options_expand(*line, text, sizeof text);
            print_roff(stream, text);
            fprintf(stream, "\n");
        }
        fprintf(stream, ".fi\n");
    }
}

/* ---- bash completion ---- */

static void print_bash_choices(const iso_program *program, FILE *stream) {
    for (size_t i = 0; i < program->option_count; i++) {
        const iso_option *option = &program->options[i];
        if (option->kind != ISO_OPTION_CHOICE) continue;
        fprintf(stream, "        --%s) words=\"", option->name);
        for (int k = 0; option->choices[k]; k++) fprintf(stream, "%s%s", k ? " " : "", option->choices[k]);
        fprintf(stream, "\" ;;\n");
    }
}

static void print_bash(const iso_program *program, FILE *stream) {
    fprintf(stream, "# bash completion for %s\n_%s() {\n", program->name, program->name);
    fprintf(stream,
            "    local current=${COMP_WORDS[COMP_CWORD]} previous=${COMP_WORDS[COMP_CWORD-1]} words=\n");
    fprintf(stream, "    case $previous in\n");
    print_bash_choices(program, stream);
    fprintf(stream,
            "    esac\n    if [ -z \"$words\" ] && [ \"${current:0:1}\" = - ]; then\n        words=\"");
    for (size_t i = 0; i < program->option_count; i++)
        if (!(program->options[i].flags & ISO_OPTION_HIDDEN))
            fprintf(stream, "%s--%s", i ? " " : "", program->options[i].name);
    fprintf(stream, "\"\n    fi\n    COMPREPLY=()\n");
    fprintf(stream, "    [ -z \"$words\" ] || COMPREPLY=($(compgen -W \"$words\" -- \"$current\"))\n");
    fprintf(stream, "}\ncomplete -o default -F _%s %s\n", program->name, program->name);
}

iso_status iso_options_help(const iso_program *program, const char *topic, FILE *stream, iso_error *error) {
    static const struct {
        const char *name;
        void (*print)(const iso_program *program, FILE *stream);
    } forms[] = {
        {"all", print_everything}, {"markdown", print_markdown}, {"man", print_man}, {"bash", print_bash}};
    char topics[512];
    if (!topic) {
        print_first_page(program, stream);
        return ISO_OK;
    }
    for (size_t i = 0; i < sizeof forms / sizeof *forms; i++)
        if (strcmp(forms[i].name, topic) == 0) {
            forms[i].print(program, stream);
            return ISO_OK;
        }
    const char *word = topic + strspn(topic, "-");
    if (print_topic(program, word, stream) || (*word && print_options_with(program, word, stream)))
        return ISO_OK;
    char meant[256];
    if (iso_synonym_explain(program, word, meant, sizeof meant))
        return iso_fail(error, ISO_ERR_USAGE, "--help: there is no option '%s': %s", word, meant);
    write_topics(program, topics, sizeof topics);
    return iso_fail(error, ISO_ERR_USAGE, "--help: no option speaks of '%s'; topics are %s, all", topic,
                    topics);
}

void iso_program_log(const iso_program *program, const char *format, ...) {
    char line[4096];
    va_list arguments;
    va_start(arguments, format);
    iso_text_format(line, sizeof line, format, arguments);
    va_end(arguments);
    iso_progress_bar_clear();
    fprintf(stderr, "%s: %s\n", program->name, line);
}

int iso_program_fail(const iso_program *program, const iso_error *error, iso_status status) {
    iso_program_log(program, "%s", error->text[0] ? error->text : iso_status_text(status));
    return iso_status_exit(status);
}

int iso_program_finish(const iso_program *program, int status) {
    if (status) return status;
    errno = 0;
    if (fflush(stdout) == 0 && !ferror(stdout)) return status;
    iso_program_log(program, "standard output: cannot write: %s", strerror(errno ? errno : EIO));
    return iso_status_exit(ISO_ERR_WRITE);
}
