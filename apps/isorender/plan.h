/* plan: the names of the outputs of every input, known and checked before anything is read. */
#ifndef ISO_APPS_ISORENDER_PLAN_H
#define ISO_APPS_ISORENDER_PLAN_H

#include "apps/isorender/settings.h"

/* The outputs of one input. The names are owned; NULL for an output that is not written. */
typedef struct isorender_plan {
    const char *input; /* as typed, or `scene` */
    char *scene;       /* "scene:NAME" made from --scene, or NULL */
    char *model;       /* the input's name without folder and extension */
    char *image, *aov; /* of a turntable: with {model}, and {n:3} for the number of the frame */
    bool numbered;     /* of a turntable: a picture, unless it is a video, and an aov for each frame */
    bool video;        /* the image is a video of all frames */
    char *points, *mesh, *json, *scene_file, *table;
    iso_file_set *files; /* read and written by the whole run; shared by all plans, owned by the first */
} isorender_plan;

/* Makes settings->input_count plans; isorender_plans_free when done. ISO_ERR_USAGE when two outputs have the
 * same name, or one has the name of an input. */
iso_status isorender_plans_make(const isorender_settings *settings, isorender_plan **plans, iso_error *error);
void isorender_plans_free(isorender_plan *plans, int count);

/* Adds the outputs of all plans to `files`. ISO_ERR_NOMEM. */
iso_status isorender_plans_add_outputs(const isorender_settings *settings, const isorender_plan *plans,
                                       iso_file_set *files, iso_error *error);

/* Whether the plan has a picture or an aov to be rendered. */
bool isorender_plan_draws(const isorender_plan *plan);

/* The path of one frame: `name` is the plan's image or aov, `frame` counts from 0 (0 for a single picture).
 * *path is the caller's: free(). */
iso_status isorender_plan_frame(const isorender_plan *plan, const char *name, int frame, char **path,
                                iso_error *error);

/* Checks, before the work begins, that every output can be created, and leaves nothing behind. ISO_ERR_WRITE;
 * ISO_ERR_UNSUPPORTED when this build cannot write its format. */
iso_status isorender_plan_check_writable(const isorender_plan *plan, iso_error *error);

#endif
