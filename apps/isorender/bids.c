/* Folders of BIDS. */
#include "apps/isorender/bids.h"

#include <glob.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

bool isorender_bids_is(const char *folder) {
    char *path = NULL;
    if (asprintf(&path, "%s/dataset_description.json", folder) < 0) return false;
    const bool there = access(path, F_OK) == 0;
    free(path);
    return there;
}

/* Makes characters literal that mean something in a pattern; to be freed. */
static char *literal(const char *text, size_t length) {
    char *made = malloc(2 * length + 1), *to = made;
    for (size_t i = 0; made && i < length; i++) {
        if (strchr("*?[\\", text[i])) *to++ = '\\';
        *to++ = text[i];
    }
    if (made) *to = 0;
    return made;
}

/* Appends what matches FOLDER/PATTERN. */
static iso_status find(const char *folder, const char *pattern, glob_t *found, iso_error *error) {
    char *start = literal(folder, strlen(folder)), *whole = NULL;
    if (!start || asprintf(&whole, "%s/%s", start, pattern) < 0) whole = NULL;
    free(start);
    const int flags = found->gl_pathv ? GLOB_APPEND : 0;
    const int failed = whole ? glob(whole, flags, NULL, found) : GLOB_NOSPACE;
    free(whole);
    return failed == GLOB_NOSPACE ? iso_fail(error, ISO_ERR_NOMEM, "out of memory") : ISO_OK;
}

/* The mask of an image: of the brain or else any, here or else in a derivative. */
static iso_status find_mask(const char *folder, const char *image, char **mask, iso_error *error) {
    const char *place = image + strlen(folder), *name = strrchr(image, '/') + 1;
    place += strspn(place, "/");
    const char *end = strstr(name, "_desc-");
    if (!end) end = strstr(name, "_T1w.nii");
    char *where = literal(place, (size_t)(name - place)), *entities = literal(name, (size_t)(end - name));
    iso_status status = where && entities ? ISO_OK : iso_fail(error, ISO_ERR_NOMEM, "out of memory");
    for (int i = 0; i < 4 && status == ISO_OK && !*mask; i++) {
        char *pattern = NULL;
        glob_t found = {0};
        if (asprintf(&pattern, "%s%s%s%s", i % 2 ? "derivatives/*/" : "", where, entities,
                     i < 2 ? "_desc-brain_mask.nii*" : "_*mask.nii*") < 0)
            pattern = NULL;
        status =
            pattern ? find(folder, pattern, &found, error) : iso_fail(error, ISO_ERR_NOMEM, "out of memory");
        if (found.gl_pathc) *mask = strdup(found.gl_pathv[0]);
        globfree(&found);
        free(pattern);
    }
    free(where);
    free(entities);
    return status;
}

static iso_status take(const char *folder, const glob_t *found, isorender_bids *bids, iso_error *error) {
    if (!found->gl_pathc)
        return iso_fail(error, ISO_ERR_EMPTY,
                        "%s: a BIDS folder without images: no sub-*/anat/*_T1w.nii.gz, also not in sessions",
                        folder);
    bids->images = calloc(found->gl_pathc, sizeof *bids->images);
    bids->masks = calloc(found->gl_pathc, sizeof *bids->masks);
    if (!bids->images || !bids->masks) return iso_fail(error, ISO_ERR_NOMEM, "out of memory");
    for (size_t i = 0; i < found->gl_pathc; i++) {
        bids->images[i] = strdup(found->gl_pathv[i]);
        bids->count++;
        if (!bids->images[i]) return iso_fail(error, ISO_ERR_NOMEM, "out of memory");
        ISO_TRY(find_mask(folder, bids->images[i], &bids->masks[i], error));
    }
    return ISO_OK;
}

static int compare(const void *a, const void *b) {
    return strcmp(*(char *const *)a, *(char *const *)b);
}

iso_status isorender_bids_find(const char *folder, isorender_bids *bids, iso_error *error) {
    static const char *const patterns[] = {"sub-*/anat/*_T1w.nii", "sub-*/anat/*_T1w.nii.gz",
                                           "sub-*/ses-*/anat/*_T1w.nii", "sub-*/ses-*/anat/*_T1w.nii.gz"};
    glob_t found = {0};
    iso_status status = ISO_OK;
    *bids = (isorender_bids){.folder = folder};
    for (int i = 0; i < 4 && status == ISO_OK; i++) status = find(folder, patterns[i], &found, error);
    if (status == ISO_OK && found.gl_pathc)
        qsort(found.gl_pathv, found.gl_pathc, sizeof *found.gl_pathv, compare);
    if (status == ISO_OK) status = take(folder, &found, bids, error);
    globfree(&found);
    if (status != ISO_OK) isorender_bids_free(bids);
    return status;
}

void isorender_bids_free(isorender_bids *bids) {
    for (int i = 0; i < bids->count; i++) {
        free(bids->images[i]);
        free(bids->masks[i]);
    }
    free(bids->images);
    free(bids->masks);
    *bids = (isorender_bids){.images = NULL};
}
