/* instances: draws many copies of sets of points, such as the trees of a forest (Guennebaud et al. 2004,
 * figure 7), from front to back, and leaves out those that are hidden by nearer ones as a whole, by their
 * boxes (section 7.1), before any of their points is looked at. */
#ifndef ISO_RENDER_SELECTION_INSTANCES_H
#define ISO_RENDER_SELECTION_INSTANCES_H

#include "render/point_surface.h"
#include "render/selection/depth_pyramid.h"
#include "render/selection/lod_cut.h"

/* A set of points of which there are copies. All borrowed. */
typedef struct iso_instanced {
    const iso_lod *lod; /* the points, and their levels of detail if there are any */
    iso_box box;        /* around the points, index coordinates: iso_point_view_bounds */
    double reach;       /* the largest radius of a point, mm in the set's own transform */
} iso_instanced;

/* A copy: a set of points in another place. */
typedef struct iso_instance {
    uint32_t set;
    /* Takes the place of the set's transform: the copy is scaled as the spacing of the first axis is, with
     * the radii of its points. */
    iso_transform transform;
} iso_instance;

/* What became of an instance. */
typedef enum iso_instance_state {
    ISO_INSTANCE_OUTSIDE, /* of the picture */
    ISO_INSTANCE_HIDDEN,  /* by what was drawn before */
    ISO_INSTANCE_DRAWN
} iso_instance_state;

/* Points of an instance that are drawn at once. All borrowed. */
typedef struct iso_instance_part {
    iso_point_view points; /* those of one level of detail that the picture needs */
    uint32_t set;
    int level;
    const iso_rgb *color;            /* instead of the points'; NULL: none */
    iso_area area;                   /* the part of the picture that they can cover */
    const iso_depth_pyramid *fronts; /* of what has been drawn; NULL: nobody looks for what is hidden */
} iso_instance_part;

/* Another engine than the cpu. It need not keep the gbuffer up to date, only bring its depths in some rows up
 * to date when it is asked to, which it says is worth while after so many points have been drawn. */
typedef struct iso_instance_engine {
    iso_status (*draw)(void *context, const iso_instance_part *part, iso_error *error);
    iso_status (*read_depths)(void *context, iso_rows rows, iso_error *error);
    size_t points_between;
    void *context;
} iso_instance_engine;

typedef struct iso_instances {
    const iso_instanced *sets;
    const iso_instance *instances;
    size_t set_count, count;
    double lod_pixels;                 /* for iso_lod_cut_make; 0: all points are drawn */
    bool draw_hidden;                  /* do not look for hidden instances: to measure what that saves */
    iso_reconstruction reconstruction; /* one that draws discs: not BOX or GAUSSIAN */
    iso_point_selection selection;     /* of points */
    const iso_rgb *colors;             /* one of each instance, instead of the points'; NULL: none */
    /* One iso_instance_state of each instance, which is raised to what became of it in this call: of the
     * strips of a picture the greatest is kept. NULL: not wanted. */
    uint8_t *states;
    const iso_instance_engine *engine; /* NULL: the cpu */
} iso_instances;

/* Working memory, kept from one picture to the next. Zero-initialise; free with iso_instance_drawing_free. */
typedef struct iso_instance_drawing {
    iso_point_workspace *workspace;
    iso_depth_pyramid pyramid;
    iso_lod_cut cut;
    iso_buffer order, levels;
} iso_instance_drawing;

/* Draws all instances as one surface into the gbuffer, as discs (render/discs/discs.h), as
 * iso_draw_point_surface draws one after the other from front to back. What is left out would not be seen:
 * the picture is the same with `draw_hidden`, byte for byte, for every number of threads and instruction set,
 * and in strips. `counts` may be NULL. ISO_ERR_NOMEM. */
iso_status iso_draw_instances(iso_instance_drawing *drawing, const iso_target *target,
                              const iso_instances *instances, iso_instance_counts *counts, iso_error *error);
/* The same by another engine, which it sets. */
typedef iso_status iso_draw_instances_fn(void *context, iso_instance_drawing *drawing,
                                         const iso_target *target, const iso_instances *instances,
                                         iso_instance_counts *counts, iso_error *error);

void iso_instance_drawing_free(iso_instance_drawing *drawing);

#endif
