/* option_rows: short macros for the rows of an option table. The including file first defines FIELD:
 *
 *     #define FIELD(name) .offset = offsetof(my_settings, name)
 */
#ifndef ISO_APPS_COMMON_OPTION_ROWS_H
#define ISO_APPS_COMMON_OPTION_ROWS_H

#include "apps/common/options.h"

#define FLAG(field) .kind = ISO_OPTION_FLAG, FIELD(field)
#define TEXT(field) .kind = ISO_OPTION_TEXT, FIELD(field)
#define TEXTS(field) .kind = ISO_OPTION_TEXTS, FIELD(field), .flags = ISO_OPTION_REPEATABLE
#define INT(field, from, to) .kind = ISO_OPTION_INT, FIELD(field), .low = (from), .high = (to)
#define REAL(field, from, to) .kind = ISO_OPTION_REAL, FIELD(field), .low = (from), .high = (to)
#define REALS(field, n) .kind = ISO_OPTION_REALS, FIELD(field), .count = (n)
#define CHOICE(field, list) .kind = ISO_OPTION_CHOICE, FIELD(field), .choices = (list)
#define CALL(function) .kind = ISO_OPTION_CALL, .apply = (function)
#define UNRECORDED .flags = ISO_OPTION_UNRECORDED

#endif
