#include "apps/isorender/engines.h"

#include <string.h>

/* Whether OpenGL has drawn nothing of the picture. */
static bool is_by_cpu_alone(const isorender_job *job) {
    int by_cpu = 0;
    for (int i = 0; i < job->object_count; i++) by_cpu += job->objects[i].scene.by_cpu;
    return !job->surface_count && by_cpu && by_cpu == job->object_count;
}

isorender_backend isorender_engines_backend(const isorender_job *job) {
    return job->backend->engine && is_by_cpu_alone(job) ? isorender_backend_cpu() : *job->backend;
}

static const char *why_by_cpu(const isorender_job *job) {
    return job->translucent ? "OpenGL draws nothing beside translucent splats"
                            : "OpenGL does not number triangles, as --aov does";
}

void isorender_engines_log(const isorender_job *job) {
    const char *name = job->settings->backend;
    if (strcmp(name, "auto") == 0 || strcmp(name, "cpu") == 0) return;
    if (job->chunks) isorender_log(job, "note: --backend %s: the cpu draws chunks", name);
    for (int i = 0; i < job->object_count; i++)
        if (job->objects[i].scene.by_cpu)
            isorender_log(job, "note: --backend %s: the cpu draws %s: %s", name,
                          job->objects[i].settings->path, why_by_cpu(job));
}
