/* isocompare: the main function of the program that compares pictures of isosurfaces with the truth. */
#include <stdlib.h>

#include "apps/isocompare/isocompare.h"

static iso_status run_command(const isocompare_settings *settings, int *code, iso_error *error) {
    iso_pool *pool = NULL;
    iso_settings_limit_memory(&settings->common);
    if (settings->command == ISOCOMPARE_SHEET) return isocompare_sheet(settings, code, error);
    ISO_TRY(iso_pool_create(settings->common.threads, &pool, error));
    iso_status (*const commands[])(const isocompare_settings *, iso_pool *,
                                   iso_error *) = {[ISOCOMPARE_IMAGES] = isocompare_images,
                                                   [ISOCOMPARE_REPORT] = isocompare_report,
                                                   [ISOCOMPARE_SURFACES] = isocompare_surfaces};
    const iso_status status = commands[settings->command](settings, pool, error);
    iso_pool_destroy(pool);
    return status;
}

static int run_program(int argc, char **argv) {
    const iso_program *program = isocompare_program();
    iso_error error = {0};
    isocompare_settings settings;
    iso_operands operands = {calloc((size_t)argc + 1, sizeof *operands.values), 0};
    if (!operands.values)
        return iso_program_fail(program, &error, iso_fail(&error, ISO_ERR_NOMEM, "out of memory"));
    iso_status status = isocompare_settings_parse(argc, argv, &settings, &operands, &error);
    bool helped = false;
    int failed = 0;
    if (status == ISO_OK) status = iso_settings_print_help(&settings.common, program, &helped, &error);
    if (status == ISO_OK && !helped) status = run_command(&settings, &failed, &error);
    free(operands.values);
    iso_settings_explain_memory(&settings.common, &error);
    int code = status == ISO_OK ? failed : iso_program_fail(program, &error, status);
    return iso_program_finish(program, code);
}

int main(int argc, char **argv) {
    return iso_program_main(argc, argv, run_program);
}
