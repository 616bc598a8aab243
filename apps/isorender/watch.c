/* Watching inputs. Their files are looked at four times a second: that works on every file system, and finds
 * files that another one has replaced. */
#include "apps/isorender/watch.h"

#include <errno.h>
#include <string.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "apps/isorender/plan.h"
#include "base/file_identity.h"
#include "scene/loader.h"

/* A number that is another one when the files that the command reads are. */
static uint64_t identity(const isorender_settings *given) {
    isorender_settings s = *given;
    isorender_plan *plans = NULL;
    isorender_bids bids = {.images = NULL};
    iso_file_set *files;
    uint64_t found = 0;
    s.no_image = 1; /* only what is read */
    s.common.json_path = NULL;
    s.points = s.mesh = s.table = s.aov = s.save_scene = NULL;
    if (given->sheet.bids.count && isorender_bids_find(given->sheet.bids.folder, &bids, NULL) == ISO_OK) {
        s.inputs = (const char *const *)bids.images;
        s.input_count = bids.count;
    }
    if (isorender_plans_make(&s, &plans, NULL) == ISO_OK) {
        files = plans->files;
        for (int i = 0; i < s.input_count; i++) iso_loader_list_files(plans[i].input, &s.common.input, files);
        for (int i = 0; i < bids.count; i++)
            if (bids.masks[i]) iso_file_set_read(files, bids.masks[i]);
        found = iso_file_set_identity(files);
        isorender_plans_free(plans, s.input_count);
    }
    isorender_bids_free(&bids);
    return found;
}

iso_status isorender_watch(isorender_settings *settings, iso_error *error) {
    static const struct timespec quarter = {.tv_nsec = 250000000};
    if (iso_ranks_are_several())
        return iso_fail(error, ISO_ERR_USAGE, "mpirun draws one picture: it cannot be combined with --watch");
    for (;;) {
        const uint64_t drawn = identity(settings);
        fflush(NULL);
        const pid_t child = fork();
        if (child == 0) return ISO_OK;
        if (child < 0) return iso_fail(error, ISO_ERR_NOMEM, "no process can be made: %s", strerror(errno));
        while (waitpid(child, NULL, 0) < 0 && errno == EINTR) continue;
        for (uint64_t now = drawn, before = drawn; now == drawn || now != before;) {
            nanosleep(&quarter, NULL);
            before = now;
            now = identity(settings);
        }
    }
}
