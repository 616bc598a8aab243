/* isosculpt: a signed distance field modelled by hand. */
#define _XOPEN_SOURCE 700 /* SIGXFSZ */
#include <errno.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "apps/isosculpt.h"

static int fail(const iso_error *error, iso_status status) {
    fprintf(stderr, "isosculpt: %s\n", error->text[0] ? error->text : iso_status_text(status));
    return iso_status_exit(status);
}

static iso_status run(const isosculpt_settings *settings, iso_error *error) {
    if (settings->help == ISOSCULPT_HELP) iso_options_help(isosculpt_program(), settings->help_form, stdout);
    if (settings->help == ISOSCULPT_VERSION) printf("isosculpt %s\n", isosculpt_program()->version);
    if (settings->help) return ISO_OK;
    iso_pool *pool = NULL;
    ISO_TRY(iso_pool_create(settings->threads, &pool, error));
    iso_status status = settings->headless ? isosculpt_replay(settings, pool, error)
                                           : isosculpt_window(settings, pool, error);
    iso_pool_destroy(pool);
    return status;
}

int main(int argc, char **argv) {
    signal(SIGPIPE, SIG_IGN);
    signal(SIGXFSZ, SIG_IGN); /* a file that may not grow is a full disk, not the end */
    iso_error error = {0};
    isosculpt_settings settings;
    iso_operands operands = {calloc((size_t)argc + 1, sizeof *operands.values), 0};
    if (!operands.values) return iso_status_exit(ISO_ERR_NOMEM);
    iso_status status = isosculpt_settings_parse(argc, argv, &settings, &operands, &error);
    if (status == ISO_OK) status = run(&settings, &error);
    free(operands.values);
    if (status == ISO_OK && (fflush(stdout) || ferror(stdout)))
        status = iso_fail(&error, ISO_ERR_WRITE, "standard output: cannot write: %s", strerror(errno));
    return status == ISO_OK ? 0 : fail(&error, status);
}
