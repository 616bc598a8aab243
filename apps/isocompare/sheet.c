/* sheet: the command "isocompare sheet", which compares the surfaces in the files of two folders. */
#include <dirent.h>
#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "apps/common/contact_sheet.h"
#include "apps/isocompare/isocompare.h"
#include "base/file_identity.h"
#include "base/file_types.h"
#include "base/memory.h"
#include "base/text.h"
#include "scene/loader.h"

typedef struct pairs {
    isocompare_settings settings; /* of the pair that is compared, with the memory of one process */
    char **paths[2];              /* of the first folder and of the second */
    int count, room, threads;
    iso_pool *pool;
} pairs;

static int compare(const void *a, const void *b) {
    return strcmp(*(char *const *)a, *(char *const *)b);
}

/* Adds the names of a folder's files that may hold a surface. */
static iso_status list(const char *folder, char ***names, int *count, iso_error *error) {
    DIR *stream = opendir(folder);
    if (!stream)
        return iso_fail(error, ISO_ERR_IO, "%s: cannot read this folder: %s", folder, strerror(errno));
    iso_status status = ISO_OK;
    for (struct dirent *entry; status == ISO_OK && (entry = readdir(stream));) {
        if (iso_file_type_of_name(entry->d_name, ISO_HOLDS_VOLUME | ISO_HOLDS_MESH) == ISO_FILE_UNKNOWN)
            continue;
        char **larger = realloc(*names, ((size_t)*count + 1) * sizeof *larger);
        if (larger) *names = larger;
        if (!larger || !(larger[*count] = strdup(entry->d_name)))
            status = iso_fail(error, ISO_ERR_NOMEM, "out of memory");
        else
            ++*count;
    }
    closedir(stream);
    return status;
}

/* Makes the paths of all pairs: of each name that is in one of the folders. */
static iso_status pair(pairs *p, const char *const folders[2], iso_error *error) {
    char **names = NULL;
    int count = 0;
    iso_status status = list(folders[0], &names, &count, error);
    if (status == ISO_OK) status = list(folders[1], &names, &count, error);
    if (status == ISO_OK && !count)
        status = iso_fail(error, ISO_ERR_EMPTY, "%s: no volumes and no meshes here", folders[0]);
    if (count) qsort(names, (size_t)count, sizeof *names, compare);
    for (int side = 0; side < 2 && status == ISO_OK; side++) {
        p->paths[side] = calloc((size_t)count + 1, sizeof **p->paths);
        p->count = 0;
        for (int i = 0; p->paths[side] && i < count; i++) {
            if (i && strcmp(names[i], names[i - 1]) == 0) continue;
            const char *folder = folders[side], *slash = iso_text_ends_with(folder, "/") ? "" : "/";
            if (asprintf(&p->paths[side][p->count++], "%s%s%s", folder, slash, names[i]) < 0)
                p->paths[side][--p->count] = NULL;
        }
        if (!p->paths[side] || !p->paths[side][p->count - 1])
            status = iso_fail(error, ISO_ERR_NOMEM, "out of memory");
    }
    for (int i = 0; i < count; i++) free(names[i]);
    free(names);
    return status;
}

static iso_status find_key(void *context, int number, uint64_t *key, iso_error *error) {
    pairs *p = context;
    const iso_input plain = {.max_memory = p->settings.common.input.max_memory};
    iso_file_set files = {0};
    (void)error;
    p->settings.truth = p->paths[0][number];
    p->settings.candidate = p->paths[1][number];
    for (int side = 0; side < 2; side++) {
        iso_file_set_read(&files, p->paths[side][number]);
        iso_loader_list_files(p->paths[side][number], &plain, &files);
    }
    const double numbers[] = {p->settings.isovalue, p->settings.side, p->settings.background.r,
                              p->settings.background.g, p->settings.background.b};
    const char *texts[] = {isocompare_program()->version, p->settings.truth, p->settings.candidate};
    *key = iso_hash(iso_file_set_identity(&files), numbers, sizeof numbers);
    for (int i = 0; i < 3; i++) *key = iso_hash(*key, texts[i], strlen(texts[i]) + 1);
    iso_file_set_free(&files);
    return ISO_OK;
}

static iso_status draw(void *context, int number, iso_image *image, double *values, iso_error *error) {
    pairs *p = context;
    iso_surfaces_compared r;
    (void)number;
    if (!p->pool) iso_settings_limit_memory(&p->settings.common);
    if (!p->pool) ISO_TRY(iso_pool_create(p->threads, &p->pool, error));
    const iso_status status = isocompare_pair(&p->settings, p->pool, image, &r, error);
    if (status != ISO_OK) iso_settings_explain_memory(&p->settings.common, error);
    ISO_TRY(status);
    const double found[] = {r.volume[0], r.volume[1], r.volume[1] - r.volume[0], r.dice, r.hausdorff,
                            r.p95,       r.mean};
    memcpy(values, found, sizeof found);
    return ISO_OK;
}

iso_status isocompare_sheet(const isocompare_settings *given, int *code, iso_error *error) {
    const char *const folders[2] = {given->truth, given->candidate};
    pairs p = {.settings = *given};
    iso_status status = pair(&p, folders, error);
    iso_contact_sheet sheet = {
        .program = isocompare_program(),
        .output = given->output,
        .inputs = (const char *const *)p.paths[0],
        .beside = (const char *const *)p.paths[1],
        .count = p.count,
        .jobs = given->jobs,
        .values = {{"volume_a", "mm3"},
                   {"volume_b", "mm3"},
                   {"difference", "mm3"},
                   {"dice", ""},
                   {"hausdorff", "mm"},
                   {"p95", "mm"},
                   {"mean", "mm"}},
        .value_count = 7,
        .shown = 6,
        .table = true,
        .note = "Each picture shows the first surface, coloured by its distance from the second, below "
                "0 inside it; the range is the 95th percentile of the pair.",
        .grid = {.panel = {given->side, given->side}, .background = given->background},
        .json = given->common.json,
        .quiet = given->common.quiet,
        .json_path = given->common.json_path,
        .max_memory = iso_memory_limit(given->common.input.max_memory),
        .find_key = find_key,
        .draw = draw,
        .context = &p};
    p.threads = given->common.threads;
    p.settings.output = p.settings.common.json_path = NULL;
    if (status == ISO_OK) status = iso_sheet_share_machine(&sheet, &p.threads, error);
    p.settings.common.input.max_memory = sheet.max_memory / (uint64_t)(sheet.jobs ? sheet.jobs : 1);
    if (status == ISO_OK) status = iso_sheet_make(&sheet, code, error);
    for (int side = 0; side < 2; side++) {
        for (int i = 0; p.paths[side] && i < p.count; i++) free(p.paths[side][i]);
        free(p.paths[side]);
    }
    return status;
}
