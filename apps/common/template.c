/* Names of outputs: replaces {model} and {n}. */
#include "apps/common/template.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>

#include "base/file.h"

static iso_status no_memory(iso_error *error) {
    return iso_fail(error, ISO_ERR_NOMEM, "out of memory");
}

/* ---- the model's name ---- */

static bool is_folder(const char *path) {
    struct stat info;
    return stat(path, &info) == 0 && S_ISDIR(info.st_mode);
}

/* Removes the extension; .gz is removed together with the extension before it. */
static void cut_extension(char *name) {
    size_t length = strlen(name);
    if (length > 3 && strcasecmp(name + length - 3, ".gz") == 0) name[length - 3] = 0;
    char *dot = strrchr(name, '.');
    if (dot && dot != name) *dot = 0;
}

static char *model_of_path(const char *path) {
    /* "." and ".." are resolved to find the folder's name */
    errno = 0;
    char *real = is_folder(path) ? realpath(path, NULL) : NULL;
    bool folder = real != NULL;
    if (!real && errno == ENOMEM) return NULL;
    char *copy = real ? real : strdup(path);
    if (!copy) return NULL;
    char *slash = strrchr(copy, '/');
    char *name = strdup(slash ? slash + 1 : copy);
    free(copy);
    if (name && !folder) cut_extension(name);
    return name;
}

iso_status iso_template_model(const char *input, char **model, iso_error *error) {
    char *name = NULL;
    if (strcmp(input, "-") == 0)
        name = strdup("stdin");
    else if (strncmp(input, "scene:", 6) == 0)
        name = strndup(input + 6, strcspn(input + 6, ":"));
    else
        name = model_of_path(input);
    if (name && !*name) {
        free(name);
        name = strdup("volume");
    }
    if (!name) return no_memory(error);
    *model = name;
    return ISO_OK;
}

/* ---- variables ---- */

typedef struct variable {
    bool model;
    int digits;
    size_t length; /* from '{' to '}' */
} variable;

/* Parses the variable at `text`, which begins with '{'. */
static bool read_variable(const char *text, variable *found) {
    const char *end = strchr(text, '}');
    if (!end) return false;
    *found = (variable){.length = (size_t)(end - text) + 1};
    if (strncmp(text, "{model}", 7) == 0) {
        found->model = true;
        return true;
    }
    if (strncmp(text, "{n}", 3) == 0) return true;
    if (strncmp(text, "{n:", 3) != 0 || found->length != 5 || text[3] < '1' || text[3] > '9') return false;
    found->digits = text[3] - '0';
    return true;
}

bool iso_template_has(const char *text, const char *name) {
    bool model = strcmp(name, "model") == 0;
    variable found;
    for (const char *at = text; (at = strchr(at, '{')); at++)
        if (read_variable(at, &found) && found.model == model) return true;
    return false;
}

static void put_variable(FILE *stream, const char *text, const variable *found, const char *model,
                         int number) {
    if (found->model && model)
        fputs(model, stream);
    else if (!found->model && number >= 0)
        fprintf(stream, "%0*d", found->digits, number);
    else
        fwrite(text, 1, found->length, stream);
}

static iso_status expand_into(FILE *stream, const char *text, const char *model, int number,
                              iso_error *error) {
    for (const char *at = text; *at;) {
        if (*at != '{') {
            fputc(*at++, stream);
            continue;
        }
        variable found;
        if (!read_variable(at, &found))
            return iso_fail(error, ISO_ERR_USAGE, "%s: '%.*s' is not {model}, {n} or {n:DIGITS}", text,
                            (int)(strcspn(at, "}") + (strchr(at, '}') != NULL)), at);
        put_variable(stream, at, &found, model, number);
        at += found.length;
    }
    return ISO_OK;
}

iso_status iso_template_expand(const char *text, const char *model, int number, char **out,
                               iso_error *error) {
    char *made = NULL;
    size_t size = 0;
    FILE *stream = open_memstream(&made, &size);
    if (!stream) return no_memory(error);
    iso_status status = expand_into(stream, text, model, number, error);
    if (!iso_memory_stream_close(stream, &made) && status == ISO_OK) status = no_memory(error);
    if (status != ISO_OK) {
        free(made);
        return status;
    }
    *out = made;
    return ISO_OK;
}

iso_status iso_template_numbered(const char *path, int digits, char **out, iso_error *error) {
    if (iso_template_has(path, "n")) {
        *out = strdup(path);
        return *out ? ISO_OK : no_memory(error);
    }
    const char *slash = strrchr(path, '/'), *dot = strrchr(path, '.');
    if (!dot || (slash && dot < slash)) dot = path + strlen(path);
    if (asprintf(out, "%.*s_{n:%d}%s", (int)(dot - path), path, digits, dot) < 0) return no_memory(error);
    return ISO_OK;
}
