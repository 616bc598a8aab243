/* method: the table of methods: the name of each, the parts of a surface that it needs, and the function that
 * draws. */
#ifndef ISO_SCENE_METHOD_H
#define ISO_SCENE_METHOD_H

#include "scene/surface.h"

/* What a method can do beside drawing opaque surfaces with the cpu engine: bits of iso_renderer.can, from
 * which follow what is refused and the words that name who can do it. */
typedef enum iso_capability {
    ISO_CAN_LAYERS = 1 << 0,        /* translucent surfaces, with all their layers */
    ISO_CAN_OBJECT_LAYERS = 1 << 1, /* translucent lines, glyphs and meshes of files */
    ISO_CAN_ABSORPTION = 1 << 2,    /* opacity by the thickness of the solid */
    ISO_CAN_GLASS = 1 << 3,
    ISO_CAN_LEVELS = 1 << 4,    /* levels of detail of points */
    ISO_CAN_SELECTION = 1 << 5, /* leaves out points that are hidden */
    ISO_CAN_INSTANCES = 1 << 6,
    ISO_CAN_PYRAMID = 1 << 7, /* has an image pyramid, which lines and triangles can share */
    ISO_CAN_CHUNKS = 1 << 8,  /* draws volumes that are larger than memory, and parts of a picture */
    ISO_CAN_GL = 1 << 9,      /* the gl engine has it, too */
    ISO_CAN_CLIP = 1 << 10,   /* draws what is left of a surface that bodies cut (render/clip.h), and caps */
    ISO_CAN_OCCLUSION = 1 << 11,    /* occlusion, shadows and outlines of opaque surfaces */
    ISO_CAN_COLORS = 1 << 12,       /* colours opaque surfaces by data (coloring.h) */
    ISO_CAN_COLOR_LAYERS = 1 << 13, /* the same of translucent surfaces */
    ISO_CAN_SMOOTH = 1 << 14,       /* draws the isosurface of a spline (iso_filter) */
    ISO_CAN_LIT_LAYERS = 1 << 15,   /* occlusion and shadows of what is opaque beside translucent surfaces */
    ISO_CAN_CLOUDS = 1 << 16,       /* draws points of files, not only those of volumes */
    ISO_CAN_GROUPS = 1 << 17,       /* divides points into groups: other transparencies than sorted */
    ISO_CAN_GL_LAYERS = 1 << 18,    /* the gl engine has its translucent surfaces, too */
    ISO_CAN_CLIP_LAYERS = 1 << 19,  /* cuts translucent surfaces */
    ISO_CAN_TRACED = 1 << 20,       /* follows refracted rays through the volume */
    ISO_CAN_PAGE = 1 << 21,         /* is the engine of pages */
    ISO_CAN_STRIPS = 1 << 22,       /* draws triangles in strips */
    ISO_CAN_ATTENUATED = 1 << 23    /* scales points by their distance */
} iso_capability;

typedef struct iso_renderer {
    iso_method method;
    const char *name, *title;   /* title: a few words, for reports */
    const char *purpose;        /* what --help says of it, in brackets; NULL: the family's first row does */
    iso_method family;          /* the method of isorender's --method, */
    const char *reconstruction; /* and its --reconstruction; NULL: there is only one */
    iso_reconstruction discs; /* how iso_draw_point_surface draws its points; means nothing without points */
    unsigned needs;           /* bits 1 << iso_part */
    unsigned can;             /* bits iso_capability */
    /* As iso_renderer_draw; NULL: iso_draw_reconstructed draws, with `discs`. */
    iso_status (*draw)(const iso_scene_surface *surface, const iso_target *target, iso_error *error);
} iso_renderer;

/* Draws the points of a surface by a reconstruction. */
iso_status iso_draw_reconstructed(const iso_scene_surface *surface, const iso_target *target,
                                  iso_reconstruction reconstruction, iso_error *error);

/* Draws into the target's gbuffer, like iso_draw_points. The needed parts must exist and be up to date. */
static inline iso_status iso_renderer_draw(const iso_renderer *renderer, const iso_scene_surface *surface,
                                           const iso_target *target, iso_error *error) {
    return renderer->draw ? renderer->draw(surface, target, error)
                          : iso_draw_reconstructed(surface, target, renderer->discs, error);
}

extern const char *const iso_filter_names[]; /* by iso_filter; then NULL */

/* Returns the list of all methods except the reference renderer. The second function returns the reference
 * renderer, with which they are compared. */
const iso_renderer *iso_renderer_list(size_t *count);
const iso_renderer *iso_renderer_truth(void);

/* The renderer of any method, also the reference and those that are not compared; NULL when there is no such
 * method. */
const iso_renderer *iso_renderer_get(iso_method method);

/* The renderer of a family with a reconstruction (NULL: its usual one); NULL: it has none of that name. */
const iso_renderer *iso_renderer_find(iso_method family, const char *reconstruction);

/* The families, in the order in which they are named: at most ISO_METHOD_FAMILIES_MOST. */
enum { ISO_METHOD_FAMILIES_MOST = 16 };
const iso_method *iso_method_families(int *count);

enum { ISO_METHODS_TEXT = 160 };
/* Writes which families have all of some capabilities, as "exact, splats (groups or flat) or raycast": of one
 * that has them with some of its reconstructions only, these in brackets. Returns `text`. */
const char *iso_methods_that_can(unsigned capabilities, char text[ISO_METHODS_TEXT]);
/* Writes the reconstructions of a family, as "gaussian or box", "" if there is only one; returns `text`. */
const char *iso_method_reconstructions(iso_method family, char text[ISO_METHODS_TEXT]);
/* Writes the families that have a reconstruction, as "discs or splats"; returns `text`. */
const char *iso_methods_with_reconstruction(const char *reconstruction, char text[ISO_METHODS_TEXT]);

/* Refuses what a method cannot draw with ISO_ERR_USAGE: with `called` "--method" and `what` "glass" as
 * "--method splats (ewa) cannot draw glass: that needs exact, splats (groups or flat) or raycast". */
iso_status iso_renderer_require(const iso_renderer *renderer, unsigned capabilities, const char *called,
                                const char *what, iso_error *error);

/* Whether a method draws flat discs or groups of discs, whose layers are the same. */
static inline bool iso_method_is_splats(iso_method method) {
    return method == ISO_METHOD_SPLATS || method == ISO_METHOD_SPLATS_FLAT;
}

/* Whether a method can do it. */
bool iso_method_can(iso_method method, iso_capability capability);

/* Samples a pixel of opaque pictures when nobody says how many: 4 by exact, whose edges they smooth for less
 * than twice its time, else 1. */
int iso_method_samples(iso_method method);

#endif
