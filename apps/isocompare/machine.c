/* machine: the processor, and the memory of this process, from Linux's /proc; unknown on other systems. */
#include <stdlib.h>
#include <string.h>
#ifdef __GLIBC__ /* defined by the headers above */
#include <malloc.h>
#endif

#include "apps/isocompare/report.h"

/* Reads the text that follows "KEY<blanks>: " in a file. */
static bool read_value(const char *path, const char *key, char *text, size_t size) {
    FILE *file = fopen(path, "r");
    char line[512];
    bool found = false;
    while (file && !found && fgets(line, sizeof line, file)) {
        const char *colon = strchr(line, ':');
        found = colon && strncmp(line, key, strlen(key)) == 0;
        if (!found) continue;
        const char *value = colon + 1 + strspn(colon + 1, " \t");
        snprintf(text, size, "%.*s", (int)strcspn(value, "\n"), value);
    }
    if (file) fclose(file);
    return found;
}

void isocompare_processor(char *text, size_t size) {
    if (!read_value("/proc/cpuinfo", "model name", text, size)) snprintf(text, size, "unknown processor");
}

bool isocompare_reset_peak(void) {
#ifdef __GLIBC__
    malloc_trim(0); /* returns freed memory to the system, so that reusing it counts as new memory */
#endif
    FILE *file = fopen("/proc/self/clear_refs", "w");
    if (!file) return false;
    bool good = fputs("5", file) >= 0;
    return fclose(file) == 0 && good;
}

uint64_t isocompare_resident(bool peak) {
    char text[64];
    if (!read_value("/proc/self/status", peak ? "VmHWM" : "VmRSS", text, sizeof text)) return 0;
    return (uint64_t)strtoull(text, NULL, 10) * 1024;
}
