/* method: the table of methods: the name of each, the parts of a surface that it needs, and the function that
 * draws. */
#ifndef ISO_SCENE_METHOD_H
#define ISO_SCENE_METHOD_H

#include "scene/surface.h"

typedef struct iso_renderer {
    iso_method method;
    const char *name, *title; /* title: a few words, for reports */
    unsigned needs;           /* bits 1 << iso_part */
    /* Draws into the target's gbuffer, like iso_draw_points. The needed parts must exist and be up to date.
     */
    iso_status (*draw)(const iso_scene_surface *surface, const iso_target *target, iso_error *error);
} iso_renderer;

/* Returns the list of all methods except the reference renderer. The second function returns the reference
 * renderer, with which they are compared. */
const iso_renderer *iso_renderer_list(size_t *count);
const iso_renderer *iso_renderer_truth(void);

/* The renderer of any method, also the reference and those that are not compared; NULL when there is no such
 * method. */
const iso_renderer *iso_renderer_get(iso_method method);

/* Samples a pixel of opaque pictures when nobody says how many: 4 by exact, whose edges they smooth for less
 * than twice its time, else 1. */
int iso_method_samples(iso_method method);

#endif
