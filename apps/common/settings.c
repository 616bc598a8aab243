/* The options that all programs share: --json, --help, --version, and the record of the options given. */
#include "apps/common/settings.h"

#include <string.h>

#include "apps/common/value_path.h"
#include "base/file_blocks.h"
#include "base/memory.h"
#include "base/temporary_file.h"

iso_status iso_settings_apply_json(void *target, const char *value, iso_error *error) {
    iso_common_settings *settings = target;
    if (value && !*value) return iso_fail(error, ISO_ERR_USAGE, "the value is empty");
    settings->json = 1;
    settings->json_path = value && strcmp(value, "-") == 0 ? NULL : value;
    return ISO_OK;
}

iso_status iso_settings_apply_help(void *target, const char *value, iso_error *error) {
    iso_common_settings *settings = target;
    (void)error;
    settings->action = ISO_ACTION_HELP;
    settings->help_topic = value;
    return ISO_OK;
}

iso_status iso_settings_apply_version(void *target, const char *value, iso_error *error) {
    (void)value, (void)error;
    ((iso_common_settings *)target)->action = ISO_ACTION_VERSION;
    return ISO_OK;
}

void iso_settings_record_option(void *target, const iso_option *option, const char *value) {
    iso_common_settings *settings = target;
    if (option->flags & ISO_OPTION_UNRECORDED) return;
    char text[512];
    /* the same picture is the same file, whatever folder its inputs are in */
    const int before =
        value && option->flags & ISO_OPTION_READS_PART ? (int)iso_value_path_whole(value).begin : 0;
    const char *start = value ? value : "";
    const char *slash =
        option->flags & (ISO_OPTION_READS | ISO_OPTION_READS_PART) ? strrchr(start, '/') : NULL;
    const int length = snprintf(text, sizeof text, " --%s%s%.*s%s", option->name, value ? "=" : "", before,
                                start, slash ? slash + 1 : start + before);
    const size_t used = strlen(settings->record);
    if (length < (int)sizeof text && used + (size_t)length < sizeof settings->record)
        memcpy(settings->record + used, text, (size_t)length + 1);
}

void iso_settings_limit_memory(const iso_common_settings *settings) {
    iso_memory_set_limit(iso_memory_limit(settings->input.max_memory));
}

void iso_settings_explain_memory(const iso_common_settings *settings, iso_error *error) {
    if (error->status != ISO_ERR_NOMEM || !iso_memory_was_refused()) return;
    const char *problem = iso_file_blocks_problem();
    const double limit = (double)iso_memory_limit(settings->input.max_memory) / 1e6;
    if (problem)
        iso_fail(error, ISO_ERR_LIMIT,
                 "%s, limit is %.0f MB (--max-memory); temporary files cannot be made in %s (TMPDIR): %s",
                 error->text, limit, iso_temporary_folder(), problem);
    else
        iso_fail(error, ISO_ERR_LIMIT, "%s, limit is %.0f MB (--max-memory)", error->text, limit);
}

iso_status iso_settings_print_help(const iso_common_settings *settings, const iso_program *program,
                                   bool *asked, iso_error *error) {
    *asked = settings->action == ISO_ACTION_HELP || settings->action == ISO_ACTION_VERSION;
    if (settings->action == ISO_ACTION_HELP)
        return iso_options_help(program, settings->help_topic, stdout, error);
    if (settings->action == ISO_ACTION_VERSION) printf("%s %s\n", program->name, program->version);
    return ISO_OK;
}
