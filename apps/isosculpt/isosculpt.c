/* isosculpt: sculpts a signed distance field in a window, or replays stroke files without one. */
#include <stdlib.h>

#include "apps/isosculpt/isosculpt.h"

static iso_status run_session(const isosculpt_settings *settings, iso_error *error) {
    iso_pool *pool = NULL;
    /* In a window nothing but reading is limited: a stroke that was begun must not fail. */
    if (settings->headless) iso_settings_limit_memory(&settings->common);
    ISO_TRY(iso_pool_create(settings->common.threads, &pool, error));
    iso_status status = settings->headless ? isosculpt_replay(settings, pool, error)
                                           : isosculpt_window(settings, pool, error);
    iso_pool_destroy(pool);
    return status;
}

static int run_program(int argc, char **argv) {
    const iso_program *program = isosculpt_program();
    iso_error error = {0};
    isosculpt_settings settings;
    iso_operands operands = {calloc((size_t)argc + 1, sizeof *operands.values), 0};
    if (!operands.values)
        return iso_program_fail(program, &error, iso_fail(&error, ISO_ERR_NOMEM, "out of memory"));
    iso_status status = isosculpt_settings_parse(argc, argv, &settings, &operands, &error);
    bool helped = false;
    if (status == ISO_OK) status = iso_settings_print_help(&settings.common, program, &helped, &error);
    if (status == ISO_OK && !helped) status = run_session(&settings, &error);
    free(operands.values);
    if (settings.headless) iso_settings_explain_memory(&settings.common, &error);
    return iso_program_finish(program, status == ISO_OK ? 0 : iso_program_fail(program, &error, status));
}

int main(int argc, char **argv) {
    return iso_program_main(argc, argv, run_program);
}
