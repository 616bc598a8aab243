/* settings: the part of a program's settings that isorender, isocompare and isosculpt have in common, and the
 * options that set it.
 *
 * A program's settings struct begins with an iso_common_settings, so that the rows of input_options.inc and
 * running_options.inc mean the same in every program's option table. */
#ifndef ISO_APPS_COMMON_SETTINGS_H
#define ISO_APPS_COMMON_SETTINGS_H

#include "apps/common/options.h"
#include "scene/loader.h"

enum { ISO_RECORD_SIZE = 4096 };

/* What a program does instead of its normal work. */
typedef enum iso_program_action {
    ISO_ACTION_WORK,
    ISO_ACTION_HELP,
    ISO_ACTION_VERSION,
    ISO_ACTION_OWN /* this value and larger ones are free for actions of a single program */
} iso_program_action;

/* Zero-initialise. Strings are borrowed from argv. */
typedef struct iso_common_settings {
    iso_input input;              /* the first member, because the rows of input_options.inc store into it */
    int threads;                  /* 0: one for each processor */
    int quiet;                    /* print nothing but errors */
    int json;                     /* write a report as JSON */
    const char *json_path;        /* file of the report; NULL: standard output */
    int action;                   /* iso_program_action; the last such option on the command line wins */
    const char *help_topic;       /* of iso_options_help */
    char record[ISO_RECORD_SIZE]; /* the options that influence the result, as typed: " --name=value ..." */
} iso_common_settings;

/* Functions for iso_option.apply. `settings` begins with an iso_common_settings. */
iso_status iso_settings_apply_json(void *settings, const char *value, iso_error *error);
iso_status iso_settings_apply_help(void *settings, const char *value, iso_error *error);
iso_status iso_settings_apply_version(void *settings, const char *value, iso_error *error);

/* For iso_program.seen: appends the option to `record` when there is room, unless the option is marked
 * ISO_OPTION_UNRECORDED. */
void iso_settings_record_option(void *settings, const iso_option *option, const char *value);

/* Limits the memory of this program to --max-memory (iso_memory_set_limit). */
void iso_settings_limit_memory(const iso_common_settings *settings);

/* Adds the name of the option --max-memory to the message if a run failed because of that limit. */
void iso_settings_explain_memory(const iso_common_settings *settings, iso_error *error);

/* Prints the help or the version to standard output if the settings ask for one of them; *asked: whether they
 * do. ISO_ERR_USAGE: no such topic. */
iso_status iso_settings_print_help(const iso_common_settings *settings, const iso_program *program,
                                   bool *asked, iso_error *error);

#endif
