/* status: status codes and error messages. The types are in isopoint.h.
 *
 * A function that can fail returns an iso_status and sets its results (out-parameters) only if it returns
 * ISO_OK. If it fails it writes a message of one line to an iso_error of the caller (NULL is allowed
 * everywhere). Bad data is reported in this way; programming mistakes are asserted. All functions here are
 * thread-safe. */
#ifndef ISO_BASE_STATUS_H
#define ISO_BASE_STATUS_H

#include "isopoint.h"
#include <stdarg.h>

#ifdef __cplusplus
extern "C" {
#endif

/* X(name, exit status of the programs, text), of every iso_status. */
#define ISO_STATUS_MAP(X)                                                                                    \
    X(OK, 0, "ok")                                                                                           \
    X(ERR_MISMATCH, 1, "a comparison failed")                                                                \
    X(ERR_USAGE, 2, "wrong usage")                                                                           \
    X(ERR_IO, 3, "cannot read")                                                                              \
    X(ERR_FORMAT, 3, "not a readable volume")                                                                \
    X(ERR_UNSUPPORTED, 3, "not supported by this build")                                                     \
    X(ERR_BRIDGE, 3, "a format library failed")                                                              \
    X(ERR_BACKEND, 4, "no usable backend")                                                                   \
    X(ERR_NOMEM, 5, "out of memory")                                                                         \
    X(ERR_LIMIT, 5, "over the memory limit")                                                                 \
    X(ERR_EMPTY, 6, "empty surface")                                                                         \
    X(ERR_WRITE, 7, "cannot write")

/* Writes a message to *error (if not NULL) and returns `status`, as in `return iso_fail(error, ISO_ERR_IO,
 * ...)`. String arguments may have any bytes, for example names of files and texts from headers; they are
 * cleaned (base/text.h). They may lie in error->text. */
#if defined(__GNUC__)
__attribute__((format(printf, 3, 4)))
#endif
iso_status
iso_fail(iso_error *error, iso_status status, const char *format, ...);

/* Calls iso_fail with ISO_ERR_NOMEM and the message "NAME: out of memory". */
iso_status iso_fail_memory(iso_error *error, const char *name);

/* Evaluates a call that returns an iso_status, and returns this from the calling function if it is not
 * ISO_OK. */
#define ISO_TRY(call)                                                                                        \
    do {                                                                                                     \
        iso_status iso_try_status_ = (call);                                                                 \
        if (iso_try_status_ != ISO_OK) return iso_try_status_;                                               \
    } while (0)

#ifdef __cplusplus
}
#endif
#endif
