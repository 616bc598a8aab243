/* bridge_guard: keeps C++ exceptions out of C.
 *
 * Every function that C calls in a bridge runs its body in iso::guard. A callback from C into a bridge must
 * not longjmp; it returns a status. */
#ifndef ISO_BASE_BRIDGE_GUARD_HPP
#define ISO_BASE_BRIDGE_GUARD_HPP

#include <exception>
#include <new>
#include <string>
#include <utility>

#include "base/status.h"

namespace iso {

/* A library's message as part of one line: control characters and runs of blanks become one blank. */
inline std::string one_line(const std::string &text) {
    std::string line;
    for (unsigned char c : text) {
        if (c > ' ' && c != 0x7f)
            line += static_cast<char>(c);
        else if (!line.empty() && line.back() != ' ')
            line += ' ';
    }
    while (!line.empty() && line.back() == ' ') line.pop_back();
    return line;
}

/* Runs body(), which returns iso_status; `path` begins the text of what it throws. */
template <class Body> iso_status guard(const char *path, iso_error *error, Body &&body) noexcept {
    try {
        try {
            return std::forward<Body>(body)();
        } catch (const std::bad_alloc &) {
            return iso_fail(error, ISO_ERR_NOMEM, "%s: out of memory", path);
        } catch (const std::exception &exception) {
            return iso_fail(error, ISO_ERR_BRIDGE, "%s: %s", path, one_line(exception.what()).c_str());
        }
    } catch (...) {
        return iso_fail(error, ISO_ERR_BRIDGE, "%s: a format library failed without saying why", path);
    }
}

} // namespace iso

#endif
