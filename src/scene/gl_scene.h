/* gl_scene: the gl engine for a scene: its surfaces and objects in GPU memory, and their picture. */
#ifndef ISO_SCENE_GL_SCENE_H
#define ISO_SCENE_GL_SCENE_H

#include "render/gl/engine.h"
#include "render/gl/shapes.h"
#include "scene/picture.h"

/* Set the members before `surfaces`, zero the rest; iso_gl_scene_free when done. */
typedef struct iso_gl_scene {
    iso_gl_engine *engine;     /* borrowed; its context is current in every call */
    iso_pool *pool;            /* borrowed, or NULL */
    bool strips;               /* surfaces drawn by the method mesh are uploaded as triangle strips */
    iso_point_scaling scaling; /* of the method points */
    double tan_x, tan_y;       /* of the method points: half the size of the whole picture at depth 1 */
    /* By number of the surface, and of the object. */
    iso_gl_surface *surfaces[ISO_SURFACE_MAX], *meshes[ISO_SURFACE_MAX];
    iso_gl_shapes *shapes[ISO_SURFACE_MAX];
} iso_gl_scene;

/* Uploads surfaces and objects. The scene's renderer has ISO_CAN_GL. Surfaces in groups, hybrid surfaces,
 * levels of detail, instances, lines of the image pyramid, and what shares one pyramid are uploaded for every
 * picture. ISO_ERR_BACKEND, ISO_ERR_LIMIT, ISO_ERR_NOMEM. */
iso_status iso_gl_scene_upload(iso_gl_scene *gl, const iso_scene *scene, iso_error *error);

/* A picture, for its size in memory. */
typedef struct iso_gl_picture {
    const iso_renderer *renderer;
    int width, height; /* in samples */
    int groups;        /* of points, at most; 0: ISO_GROUPS_DEFAULT */
    bool selects;      /* of discs, those that are not hidden are selected */
    bool shapes;       /* there are lines or glyphs */
} iso_gl_picture;

/* Bytes of GPU memory (of main memory with a software renderer) that drawing takes, without what is uploaded.
 */
uint64_t iso_gl_scene_bytes(const iso_gl_engine *engine, const iso_gl_picture *picture);

/* The engine of iso_scene, which borrows `gl`. It draws what was uploaded; the cpu draws meshes whose
 * triangles are to be numbered. */
iso_scene_engine iso_gl_scene_engine(iso_gl_scene *gl);

/* Frees what was uploaded. */
void iso_gl_scene_free(iso_gl_scene *gl);

#endif
