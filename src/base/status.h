/* status: status codes and error messages of all functions that can fail. The types are in isopoint.h.
 *
 * A fallible function returns iso_status; results go to out-parameters, which are untouched unless ISO_OK
 * is returned; the message is one line of text in an iso_error of the caller (NULL is allowed everywhere).
 * Bad data never fails an assertion; programming mistakes do. All functions here are thread-safe. */
#ifndef ISO_BASE_STATUS_H
#define ISO_BASE_STATUS_H

#include "base/c_linkage.h"
#include "isopoint.h"
#include <stdarg.h>

ISO_C_BEGIN

/* The list of all iso_status: X(name, exit status of the programs, text). */
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

/* Sets *error (when not NULL) and returns status: `return iso_fail(error, ISO_ERR_IO, ...)`. String arguments
 * may hold any bytes, such as file names and texts from headers, because the message is made printable
 * (base/text.h). They may point into error->text. */
#if defined(__GNUC__)
__attribute__((format(printf, 3, 4)))
#endif
iso_status
iso_fail(iso_error *error, iso_status status, const char *format, ...);

/* iso_fail with ISO_ERR_NOMEM and "NAME: out of memory". */
iso_status iso_fail_memory(iso_error *error, const char *name);

/* Returns from the calling function when the call fails, with the call's status. */
#define ISO_TRY(call)                                                                                        \
    do {                                                                                                     \
        iso_status iso_try_status_ = (call);                                                                 \
        if (iso_try_status_ != ISO_OK) return iso_try_status_;                                               \
    } while (0)

ISO_C_END
#endif
