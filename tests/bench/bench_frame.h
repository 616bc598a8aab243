/* bench_frame: a frame by one of our methods as a row: drawing into a cleared gbuffer and shading into an
 * image, or painting the image at once; all that a window needs, in memory that is kept from frame to frame.
 */
#ifndef ISO_TESTS_BENCH_FRAME_H
#define ISO_TESTS_BENCH_FRAME_H

#include "bench_subject.h"
#include "exact/layers.h"
#include "render/selection/lod_cut.h"

typedef struct bench_frame bench_frame;

/* A way to draw. */
typedef struct bench_method {
    const char *name;
    bool kernels;              /* there is a variant for each instruction set */
    bool slow;                 /* takes seconds: three rounds are enough */
    bool on_bumpy, on_volumes; /* which subjects it is measured on */
    /* Gets what is drawn into the frame, and its number of primitives. */
    iso_status (*open)(bench_frame *frame, iso_error *error);
    /* Either draws, or paints into the subject's image without a gbuffer and counts the pixels that show the
     * surface. */
    iso_status (*draw)(bench_frame *frame, const iso_target *target, iso_error *error);
    iso_status (*paint)(bench_frame *frame, size_t *covered, iso_error *error);
    void (*finish)(bench_row *row);    /* adds counters; NULL: none */
    void (*close)(bench_frame *frame); /* what open made; NULL: nothing */
} bench_method;

struct bench_frame {
    const bench_method *method;
    bench_subject *subject;
    iso_pool *pool;
    bench_view view;
    size_t primitives, covered;
    iso_point_view points; /* whichever open asked for */
    iso_mesh_view mesh;
    const iso_raycaster *caster;
    const iso_exact *exact;
    iso_exact_layers_totals totals;        /* of layers */
    struct iso_point_workspace *workspace; /* owned */
    iso_lod lod;                           /* owned, as is the cut */
    iso_lod_cut cut;
    uint8_t (*colors)[3]; /* of the points; owned */
    struct bench_gl *gl;  /* the plan's */
    struct bench_gl_frame *gl_frame;
};

/* What a row draws: row->plan, owned by the row. `method` is NULL in VTK's rows. */
struct bench_frame_plan {
    const bench_method *method;
    bench_subject *subject;
    int view;            /* number for bench_subject_view */
    int vtk_peels;       /* of VTK's rows: BENCH_VTK_OPAQUE; 0: translucent, by VTK's default; else layers
                            that are peeled at most */
    bool vtk_points;     /* of VTK's rows: the points, by vtkPointGaussianMapper, instead of the mesh */
    struct bench_gl *gl; /* for methods of bench_gl.h */
};

/* Opacity of translucent surfaces. */
#define BENCH_OPACITY 0.5

extern const bench_kind bench_frame_kind, bench_slow_frame_kind;
extern const bench_method bench_methods[];
extern const int bench_method_count;

#endif
