/* cgroup: finds the process's memory cgroup from /proc/self/cgroup and /proc/self/mountinfo (man 7 cgroups,
 * man 5 proc), and reads its limits and those of the groups above it. */
#include "base/cgroup.h"

#include <stdbool.h>
#include <stdio.h>
#include <string.h>

enum { PATH_SIZE = 4096, LINE_SIZE = 8192, FOLDER_SIZE = 2 * PATH_SIZE + 64 };

/* The names of the files in which the two versions of cgroups say the same. */
typedef struct cgroup_files {
    const char *limit, *usage;
    const char *active, *inactive; /* lines of memory.stat: bytes of cached file pages */
} cgroup_files;

static const cgroup_files VERSION_1 = {"memory.limit_in_bytes", "memory.usage_in_bytes", "total_active_file ",
                                       "total_inactive_file "};
static const cgroup_files VERSION_2 = {"memory.max", "memory.current", "active_file ", "inactive_file "};

uint64_t iso_number_in_file(const char *path, const char *key) {
    FILE *file = fopen(path, "r");
    if (!file) return UINT64_MAX;
    char line[256];
    unsigned long long value = UINT64_MAX;
    const size_t key_length = strlen(key);
    while (fgets(line, sizeof line, file)) {
        if (strncmp(line, key, key_length) != 0) continue;
        if (sscanf(line + key_length, "%llu", &value) != 1) value = UINT64_MAX; /* "max": no limit */
        break;
    }
    fclose(file);
    return value;
}

static uint64_t number_in_folder(const char *folder, const char *name, const char *key) {
    char path[FOLDER_SIZE + 64];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    return iso_number_in_file(path, key);
}

/* What one cgroup leaves. */
static uint64_t left_in_group(const char *folder, const cgroup_files *files) {
    const uint64_t limit = number_in_folder(folder, files->limit, "");
    uint64_t used = number_in_folder(folder, files->usage, "");
    if (limit == UINT64_MAX || used == UINT64_MAX) return UINT64_MAX;
    const uint64_t cached[2] = {number_in_folder(folder, "memory.stat", files->active),
                                number_in_folder(folder, "memory.stat", files->inactive)};
    for (int i = 0; i < 2; i++)
        if (cached[i] != UINT64_MAX) used -= cached[i] < used ? cached[i] : used;
    return limit > used ? limit - used : 0;
}

/* Where the cgroups of the memory controller are mounted. */
typedef struct cgroup_mount {
    char root[PATH_SIZE];  /* the cgroup that is the mount's top folder */
    char point[PATH_SIZE]; /* that folder */
} cgroup_mount;

/* Whether a comma-separated list has this word. */
static bool lists(const char *list, const char *word) {
    const size_t length = strlen(word);
    for (; *list; list += strcspn(list, ",\n"), list += *list == ',')
        if (strncmp(list, word, length) == 0 && (!list[length] || strchr(",\n", list[length]))) return true;
    return false;
}

/* Parses a line of mountinfo: "ID PARENT DEVICE ROOT POINT OPTIONS .. - TYPE SOURCE OPTIONS". */
static bool parse_mount(const char *line, bool version_2, cgroup_mount *mount) {
    char type[32], options[LINE_SIZE];
    const char *end = strstr(line, " - ");
    if (!end || sscanf(line, "%*s %*s %*s %4095s %4095s", mount->root, mount->point) != 2) return false;
    if (sscanf(end, " - %31s %*s %8191s", type, options) != 2) return false;
    return version_2 ? strcmp(type, "cgroup2") == 0 : strcmp(type, "cgroup") == 0 && lists(options, "memory");
}

static bool find_mount(const char *root, bool version_2, cgroup_mount *mount) {
    char path[PATH_SIZE], line[LINE_SIZE];
    snprintf(path, sizeof path, "%s/proc/self/mountinfo", root);
    FILE *file = fopen(path, "r");
    bool found = false;
    while (file && !found && fgets(line, sizeof line, file)) found = parse_mount(line, version_2, mount);
    if (file) fclose(file);
    return found;
}

/* The least that the groups from `group` up to the mount's top leave. */
static uint64_t left_in_groups(const char *root, const char *group, bool version_2) {
    cgroup_mount mount;
    char folder[FOLDER_SIZE];
    uint64_t left = UINT64_MAX;
    if (!find_mount(root, version_2, &mount)) return left;
    /* In a container the mount's top may be the container's group, and the group's name may begin with its
     * name or, from outside, with "/..": then only the top can be seen. */
    const size_t skip = strcmp(mount.root, "/") == 0 ? 0 : strlen(mount.root);
    const bool below = strncmp(group, mount.root, skip) == 0 && !strstr(group, "/..");
    const int top = snprintf(folder, sizeof folder, "%s%s", root, mount.point);
    if (below && top > 0 && (size_t)top < sizeof folder)
        snprintf(folder + top, sizeof folder - (size_t)top, "%s", group + skip);
    for (;;) {
        const uint64_t here = left_in_group(folder, version_2 ? &VERSION_2 : &VERSION_1);
        left = here < left ? here : left;
        char *slash = strrchr(folder, '/');
        if (!slash || slash < folder + top) return left;
        *slash = 0;
    }
}

uint64_t iso_cgroup_memory_left(const char *root) {
    char path[PATH_SIZE], line[LINE_SIZE];
    uint64_t left = UINT64_MAX;
    snprintf(path, sizeof path, "%s/proc/self/cgroup", root);
    FILE *file = fopen(path, "r");
    while (file && fgets(line, sizeof line, file)) { /* "0::GROUP", or "NUMBER:CONTROLLERS:GROUP" */
        char *controllers = strchr(line, ':'), *group = controllers ? strchr(controllers + 1, ':') : NULL;
        if (!group) continue;
        *group++ = 0;
        group[strcspn(group, "\n")] = 0;
        const bool version_2 = !controllers[1];
        if (!version_2 && !lists(controllers + 1, "memory")) continue;
        const uint64_t here = left_in_groups(root, group, version_2);
        left = here < left ? here : left;
    }
    if (file) fclose(file);
    return left;
}
