/* bench_subject: what a group of frames shows: one surface as points, as a mesh and as a field, and where it
 * is looked at from. Each is made when the first row asks for it and shared by all rows. */
#ifndef ISO_TESTS_BENCH_SUBJECT_H
#define ISO_TESTS_BENCH_SUBJECT_H

#include "bench_bumpy.h"
#include "bench_child.h"
#include "bench_harness.h"
#include "exact/exact.h"
#include "extract/points/points.h"
#include "grids/volume/volume.h"
#include "image/image.h"
#include "render/raster/raster.h"
#include "truth/raycast.h"

/* Instead of a number of peels: the mesh is opaque. */
enum { BENCH_VTK_OPAQUE = -1 };

/* VTK's frames of the mesh or of the points: a file, and a process for each number of threads. */
typedef struct bench_vtk {
    char path[512]; /* empty: not written yet */
    bench_child *child[BENCH_THREADS];
    int shown[BENCH_THREADS]; /* number of the view that it has, -1: none */
    int peels[BENCH_THREADS]; /* as bench_frame_plan.vtk_peels; BENCH_VTK_OPAQUE before any is set */
    size_t primitives;
} bench_vtk;

/* A place to look from: a camera, and for close-ups a picture moved aside from its axis. */
typedef struct bench_view {
    iso_camera camera; /* zoomed */
    double centre[2];  /* of the picture, in half pictures from the optical axis; x right, y down */
    iso_view view;
} bench_view;

enum { BENCH_VIEWS = 2 }; /* fit, and closer */

typedef struct bench_subject {
    bench_state *bench;
    char name[32];
    /* Exactly one of the three says what it is. */
    int bumpy_side;      /* bench_bumpy.h */
    int ct_size;         /* the ct scene */
    const char *file;    /* below the folder of real volumes */
    double isovalue;     /* physical */
    int bumpy_piece;     /* bricks */
    bool bumpy_meshless; /* no row wants a mesh of it */

    /* The rest is made on demand. */
    bool made;
    iso_pool *pool;
    bench_bumpy bumpy;
    iso_volume volume;
    const iso_grid *grid; /* NULL for a bumpy sphere */
    iso_point_set *points;
    iso_mesh_set *mesh;
    iso_raycaster *caster;
    iso_exact *exact;
    bench_view views[BENCH_VIEWS];
    bool aimed[BENCH_VIEWS];
    bench_vtk vtk, vtk_points;
    iso_gbuffer gbuffer; /* one frame: rows take turns */
    iso_image image;
} bench_subject;

/* What is made belongs to the subject. Errors: ISO_ERR_UNSUPPORTED without the file or a mesh, and those of
 * what is called. */
iso_status bench_subject_points(bench_subject *subject, iso_point_view *points, iso_error *error);
iso_status bench_subject_mesh(bench_subject *subject, iso_mesh_view *mesh, iso_error *error);
iso_status bench_subject_caster(bench_subject *subject, const iso_raycaster **caster, iso_error *error);
iso_status bench_subject_exact(bench_subject *subject, const iso_exact **exact, iso_error *error);
iso_status bench_subject_grid(bench_subject *subject, const iso_grid **grid, iso_error *error);
/* Number 0: everything in sight; 1: four times as large, aimed at the nearest place to the middle that has
 * surface and background, as the quality of pictures is measured. */
iso_status bench_subject_view(bench_subject *subject, int number, bench_view *view, iso_error *error);
/* Makes the gbuffer and the image. */
iso_status bench_subject_frame(bench_subject *subject, iso_error *error);

/* Destroys what was made. */
void bench_subject_end(bench_subject *subject);

/* Samples that show a surface. */
size_t bench_covered(const iso_gbuffer *gbuffer);

/* bench_vtk.c: a row that measures VTK's frame of a view, at row->threads. */
typedef struct bench_frame_plan bench_frame_plan;
extern const bench_kind bench_vtk_kind;
void bench_vtk_end(bench_vtk *vtk);

#endif
