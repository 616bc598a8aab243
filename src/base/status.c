/* status: names and exit statuses of iso_status, and error messages. */
#include "base/status.h"

#include "base/text.h"

const char *iso_status_text(iso_status status) {
    switch (status) {
#define ISO_X(name, exit_status, text)                                                                       \
    case ISO_##name:                                                                                         \
        return text;
        ISO_STATUS_MAP(ISO_X)
#undef ISO_X
    }
    return "unknown status";
}

int iso_status_exit(iso_status status) {
    switch (status) {
#define ISO_X(name, exit_status, text)                                                                       \
    case ISO_##name:                                                                                         \
        return exit_status;
        ISO_STATUS_MAP(ISO_X)
#undef ISO_X
    }
    return 2;
}

iso_status iso_fail(iso_error *error, iso_status status, const char *format, ...) {
    if (!error) return status;
    error->status = status;
    va_list arguments;
    va_start(arguments, format);
    iso_text_format(error->text, sizeof error->text, format, arguments);
    va_end(arguments);
    return status;
}

iso_status iso_fail_memory(iso_error *error, const char *name) {
    return iso_fail(error, ISO_ERR_NOMEM, "%s: out of memory", name);
}
