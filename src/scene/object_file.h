/* object_file: what objects are made of, from files: lines, glyphs or a mesh; lines or glyphs of a volume of
 * vectors or tensors; tubes, ribbons and triangles of a mesh of thin branches. */
#ifndef ISO_SCENE_OBJECT_FILE_H
#define ISO_SCENE_OBJECT_FILE_H

#include "extract/lines/mesh_lines.h"
#include "extract/vectors/gradient_glyphs.h"
#include "extract/vectors/streamlines.h"
#include "extract/vectors/vector_glyphs.h"
#include "grids/volume/vectors_read.h"
#include "io/common/read_opts.h"
#include "scene/object.h"
#include "scene/surface.h"

typedef enum iso_object_kind {
    ISO_OBJECT_LINES,
    ISO_OBJECT_GLYPHS,
    ISO_OBJECT_MESH,
    ISO_OBJECT_KINDS
} iso_object_kind;

/* What is made of a volume of vectors or tensors. All zero: the usual. */
typedef struct iso_vector_field_opts {
    const char
        *array; /* name of the array or grid that is read; NULL: the first that has vectors or tensors */
    iso_vector_axes axes;   /* the axes that the components of vectors refer to */
    int order[6];           /* the order of the components of tensors, as in iso_vectors_opts */
    double scale;           /* length of glyphs, mm per unit of the vectors; 0: not given */
    int streamlines, seed;  /* number of streamlines; seed of the random places where they begin */
    double length;          /* of streamlines, mm; 0: not given */
    double least;           /* shorter vectors, and tensors of less anisotropy, are not drawn; 0: not given */
    bool axial;             /* vectors v and -v mean the same */
    const iso_glyph *glyph; /* NULL: arrows of vectors, ellipsoids of tensors */
} iso_vector_field_opts;

/* Facts about such a volume. */
typedef struct iso_vector_field {
    int dims[3];
    int components; /* of the file; 0: the object is not made of a volume */
    iso_vectors_totals vectors;
    iso_vector_glyphs_totals glyphs;
    iso_streamlines_totals lines;
} iso_vector_field;

/* Zero-initialise, iso_object_file_free when done. */
typedef struct iso_object_file {
    iso_lines lines;
    iso_glyphs glyphs;
    iso_triangles mesh;
    iso_read_report report;
    iso_vector_field field;    /* of a volume */
    iso_glyph glyph;           /* of a volume's glyphs: the solid that shows them */
    const char *values;        /* of a volume: the attribute that says most; else NULL */
    iso_mesh_lines *branches;  /* of a mesh in place of lines: what it became */
    size_t branches_triangles; /* of this mesh */
} iso_object_file;

/* Reads a file of one kind: only `mesh` of a mesh, whose axes `opts` says, `lines`, or `glyphs`; `field`:
 * the file may also be a volume of vectors or tensors, of which lines or glyphs are made, and that of lines
 * a mesh of branches; NULL: neither. Errors: those of the readers; ISO_ERR_EMPTY: the file holds nothing of
 * this kind, or vectors that give nothing; ISO_ERR_USAGE: axes that only vectors have, or `every` of
 * branches. Messages name the file. `pool` may be NULL. */
iso_status iso_object_file_read(iso_object_file *file, const char *path, iso_object_kind kind,
                                const iso_read_opts *opts, const iso_vector_field_opts *field, iso_pool *pool,
                                iso_error *error);

/* Reads what a file of several contents holds: lines (`holds`: ISO_HOLDS_LINES), else glyphs
 * (ISO_HOLDS_GLYPHS), but not glyphs if it may hold a mesh. Nothing read is no error. */
iso_status iso_object_file_read_any(iso_object_file *file, const char *path, unsigned holds,
                                    const iso_read_opts *opts, iso_error *error);

void iso_object_file_free(iso_object_file *file);

/* Reads a mesh, whose file does not say its axes: turned to LPS if it is `ras`; iso_triangles_free when
 * done. Errors of iso_mesh_read. */
iso_status iso_object_read_mesh(const char *path, bool ras, iso_triangles *mesh, iso_error *error);

/* Whether a file, in which no lines were found, is a mesh. */
bool iso_object_file_is_mesh(const char *path);

/* Makes glyphs of the gradients at points of surfaces, which are extracted where a surface has none. Errors
 * of iso_gradient_glyphs and of extraction. */
iso_status iso_object_gradients(iso_scene_surface *const *surfaces, int count,
                                const iso_gradient_glyphs_opts *opts, iso_glyphs *glyphs,
                                iso_gradient_glyphs_totals *totals, iso_error *error);

#endif
