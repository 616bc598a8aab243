/* isopoint.h: isosurfaces of volumes, rendered and sculpted with points. The whole interface of libisopoint:
 * chapters of it are in isopoint_clouds.h, isopoint_figures.h, isopoint_lines.h, isopoint_meshes.h,
 * isopoint_parts.h and isopoint_sculpt.h, which this file includes.
 *
 * Overview:
 *
 *     iso_volume_open, iso_volume_lend    a file, or an array of yours, becomes a volume
 *     iso_surface_create                  a volume and an isovalue: a surface, which follows edits
 *     iso_render                          a picture of it, by any method, with depth and normals
 *     iso_surface_points, iso_surface_mesh    the same surface as points, or as Marching Cubes triangles
 *     iso_placements_read                 instances of surfaces, such as the trees of a forest
 *     iso_shape_set_read_lines, ...          lines and glyphs, also of vectors, in the same picture
 *     iso_sculpt_create                   a level set under brushes, with strokes, undo and a journal
 *     iso_keys_draw                       parts of a picture, drawn by several processes and merged
 *     iso_compare_images                  how far one picture is from another
 *     iso_image_write, iso_surface_write_mesh, ...    files
 *
 * Options are structs in which all zero means the default: write (iso_render_opts){.width = 640} and leave
 * the rest. A pointer to options may be NULL. Pointers to options and strings are borrowed for the call.
 *
 * Functions that can fail return iso_status, ISO_OK being 0. What they make goes to out-parameters, which are
 * left alone by a failure. The details are one line of text in an iso_error of the caller's; NULL is fine
 * everywhere. Bad data is always an error, never an assertion; a NULL volume, surface or sculpt is a mistake
 * in the program, and so is an index out of range. Files are written whole or not at all. Memory that runs
 * out is ISO_ERR_NOMEM, which is not repeated below.
 *
 * Units: world coordinates are millimetres, LPS: x to the patient's left, y to the back, z up; files in RAS
 * are converted. Index coordinates are voxels; the centre of voxel (i, j, k) is at exactly (i, j, k). Values
 * and isovalues are physical: what the file means, Hounsfield units for instance. Of a level set they are the
 * signed distance to its surface in millimetres, negative inside.
 *
 * Inside is at or above the isovalue; in a level set it is below. Normals point out of the solid. Results do
 * not depend on the number of threads or on the processor: the same bytes everywhere.
 *
 * Threads: a volume owns threads that work for it and for its surfaces, so a volume and its surfaces together
 * are used by one thread at a time; different volumes are independent. Functions without a volume, a surface
 * or a sculpt are thread-safe as long as their arguments are not shared. The library has no global state.
 * The header is valid C17 and C++17; the library exports nothing else. */
#ifndef ISOPOINT_H
#define ISOPOINT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#if defined(__GNUC__)
#define ISO_API __attribute__((visibility("default")))
#else
#define ISO_API
#endif

/* ---- version ---- */
/* Until 1.0 a minor version may change anything. CMakeLists.txt takes the version from here. */
#define ISO_VERSION_MAJOR 0
#define ISO_VERSION_MINOR 1
#define ISO_VERSION_PATCH 0

/* The version of the library that the program runs with, as "0.1.0". Never NULL. */
ISO_API const char *iso_version(void);

/* ---- errors ---- */
typedef enum iso_status {
    ISO_OK = 0,
    ISO_ERR_MISMATCH,    /* values that must agree differ, such as the sizes of two pictures */
    ISO_ERR_USAGE,       /* an argument is out of its range */
    ISO_ERR_IO,          /* a file is missing, unreadable or truncated; or progress was cancelled */
    ISO_ERR_FORMAT,      /* a file's content is damaged, or not of the expected format */
    ISO_ERR_UNSUPPORTED, /* the library that this needs was not built in or is not installed */
    ISO_ERR_BRIDGE,      /* a library that reads the format failed */
    ISO_ERR_BACKEND,     /* no usable OpenGL implementation */
    ISO_ERR_NOMEM,
    ISO_ERR_LIMIT, /* larger than a limit set by the caller, or than the library can count */
    ISO_ERR_EMPTY, /* there is no surface */
    ISO_ERR_WRITE  /* a file cannot be written */
} iso_status;

/* One line of detail, printable UTF-8 without a newline, that names the thing and the reason. Initialise it
 * with zeros; it is written to by failures only. */
typedef struct iso_error {
    iso_status status;
    char text[512];
} iso_error;

/* Returns the general meaning of a status, such as "out of memory". Never NULL. */
ISO_API const char *iso_status_text(iso_status status);

/* Returns a program's exit status for `status`: 0 success, 1 a comparison failed, 2 wrong usage, 3 unreadable
 * input, 4 no usable backend, 5 out of memory, 6 no surface, 7 could not write. */
ISO_API int iso_status_exit(iso_status status);

/* ---- space ---- */
typedef struct iso_vec3 {
    double x, y, z;
} iso_vec3;

/* An axis-aligned box; empty when lo > hi on any axis. */
typedef struct iso_box {
    iso_vec3 lo, hi;
} iso_box;

/* The map from index to world coordinates: world = origin + direction * (spacing .* index). `direction` is
 * row-major; its columns are unit world directions of the index axes (as in ITK, VTK), also left-handed. */
typedef struct iso_transform {
    double origin[3];    /* of voxel (0, 0, 0), mm */
    double spacing[3];   /* > 0, mm */
    double direction[9]; /* invertible */
} iso_transform;

/* ---- volumes ---- */
typedef enum iso_type { ISO_UINT8, ISO_INT16, ISO_UINT16, ISO_FLOAT32 } iso_type; /* how voxels are stored */

/* How voxels are laid out in a file without a header. */
typedef struct iso_raw_layout {
    int dims[3]; /* voxels, x fastest */
    iso_type type;
    char number[8]; /* "int8", "int32", "uint32" or "float64", instead of `type`: converted; "": of `type` */
    int components; /* interleaved; 0 means 1 */
    bool big_endian;
    uint64_t offset; /* bytes before the first voxel */
} iso_raw_layout;

/* A function of the caller's that is called from time to time during long operations. `fraction` is the part
 * that is done, 0 .. 1; a negative fraction reports nothing and only asks whether to cancel. Return 0 to
 * continue; any other value cancels the operation, which then fails with ISO_ERR_IO. */
typedef int iso_progress_fn(void *context, double fraction);

enum { ISO_VOLUME_ITEMS = 32, ISO_VOLUME_NOTES = 8, ISO_VOLUME_TEXT = 256 };

/* What a file's header says, without pointers. Texts are one line of printable UTF-8. */
typedef struct iso_volume_info {
    char format[16]; /* "nrrd", "nifti", "dicom", "tiff", "hdf5", "zarr", "vdb", "vti", "raw" or another */
    char name[ISO_VOLUME_TEXT]; /* name of the grid, array or series; or empty */
    int dims[3];
    iso_type type;             /* in memory */
    char file_type[32];        /* in the file, such as "int16", "double", "half" */
    int components, component; /* number of components in the file; the one that was chosen */
    iso_transform transform;
    double scale, offset; /* physical = stored * scale + offset */
    bool anatomical;      /* world axes are known to be patient axes (LPS) */
    /* What is called mm is the file's unit: it states none; or the angstrom, as in maps of molecules. */
    bool unitless, angstrom;
    bool level_set, sparse; /* a distance field, negative inside; one in a narrow band of 16^3 bricks */
    uint64_t bytes;         /* memory that the volume will take (estimated for sparse ones) */
    uint64_t read_bytes;    /* largest amount of memory in use while the file is read */
    int item_count;         /* number of grids in a .vdb, arrays in a file, or series in a folder */
    char items[ISO_VOLUME_ITEMS][ISO_VOLUME_TEXT]; /* a line each; the chosen one's begins with its name */
    int note_count;                                /* decisions of the reader, to be shown to the user */
    char notes[ISO_VOLUME_NOTES][ISO_VOLUME_TEXT];
} iso_volume_info;

/* A volume in memory, with its threads. */
typedef struct iso_volume iso_volume;

typedef struct iso_open_opts {
    /* The grid of a .vdb; NULL: its first level set, else its first scalar grid. The array of a .vti, .vtk or
     * HDF5 file; NULL: the active scalars, else the first (of HDF5: the only) array. */
    const char *grid;
    const char *series; /* DICOM: series UID, or number from 1; ":2" behind it: the 2nd acquisition */
    int component;      /* which of several components to read, counted from 0 */
    int level;          /* which resolution of OME-Zarr, Imaris or BigDataViewer to read; 0: the finest */
    const iso_raw_layout *raw; /* read as raw data; NULL: only if the file's name states a layout */
    double spacing[3];         /* mm; where > 0, used instead of the file's spacing */
    uint64_t max_memory;       /* limit in bytes for reading; 0: 80 % of the free memory */
    int threads;               /* number of threads that work for the volume; 0: one for each processor */
    iso_progress_fn *progress; /* called from the calling thread; NULL: not called */
    void *progress_context;
} iso_open_opts;

/* Reads a volume: NRRD, NIfTI, DICOM, TIFF, PNG or JPEG slices, HDF5, OME-Zarr, MetaImage, .vdb, .vti, .vtk,
 * .npy or raw, told by content or name. iso_volume_destroy frees it. ISO_ERR_IO, ISO_ERR_FORMAT,
 * ISO_ERR_UNSUPPORTED, ISO_ERR_BRIDGE, ISO_ERR_LIMIT, ISO_ERR_USAGE (no such grid, series, component or
 * level). */
ISO_API iso_status iso_volume_open(const char *path, const iso_open_opts *opts, iso_volume **volume,
                                   iso_error *error);
/* Reads only the header of a file. The errors are those of iso_volume_open. */
ISO_API iso_status iso_volume_inspect(const char *path, const iso_open_opts *opts, iso_volume_info *info,
                                      iso_error *error);

/* An array of voxels that belongs to the caller. */
typedef struct iso_lend_opts {
    int dims[3]; /* voxels, each at least 1 */
    iso_type type;
    const void *data; /* voxel (0, 0, 0); dims[0] * dims[1] * dims[2] values, x fastest; not copied */
    ptrdiff_t stride_y, stride_z; /* values between neighbours along y and z; 0: the voxels are dense */
    /* Called with `owner` once, when the volume is destroyed or when lending fails; or NULL. */
    void (*release)(void *owner);
    void *owner;
    double scale, offset;           /* physical = stored * scale + offset; scale 0 means 1, else > 0 */
    const iso_transform *transform; /* copied; NULL: spacing 1, origin 0 */
    bool level_set;                 /* a distance field in mm whose inside is negative */
    int threads; /* number of threads that work for the volume; 0: one for each processor */
} iso_lend_opts;

/* Makes a volume of an array that the caller owns and keeps valid until the volume is destroyed. After
 * changes to the array it calls iso_volume_changed. ISO_ERR_USAGE (no data, a wrong number of threads, or
 * strides that let voxels overlap), ISO_ERR_FORMAT (dims, scale or transform), ISO_ERR_LIMIT. */
ISO_API iso_status iso_volume_lend(const iso_lend_opts *opts, iso_volume **volume, iso_error *error);
/* Frees a volume. Destroy its surfaces first. NULL is allowed. */
ISO_API void iso_volume_destroy(iso_volume *volume);
/* Returns the description of a volume, valid until it is destroyed. The format of a lent one is "lent". */
ISO_API const iso_volume_info *iso_volume_describe(const iso_volume *volume);
/* Crops the volume to the voxels lo .. hi (inclusive), which keep their positions in the world, before it has
 * surfaces. ISO_ERR_USAGE: the range is empty or not within the volume, or a sculpt owns the volume. */
ISO_API iso_status iso_volume_crop(iso_volume *volume, const int lo[3], const int hi[3], iso_error *error);
/* Tells that the voxels lo .. hi (inclusive, clipped to the volume) of a lent array have changed. Its
 * surfaces are updated at their next use, from the changed bricks. ISO_ERR_USAGE: the volume is sparse. */
ISO_API iso_status iso_volume_changed(iso_volume *volume, const int lo[3], const int hi[3], iso_error *error);
/* Sets a function that is called during everything that is done with the volume and its surfaces from now on
 * (histograms, points, meshes, pictures), some 20 times a second; NULL: none. It cancels as that of
 * iso_open_opts does; nothing is lost then, and what is asked for next is computed as if for the first time.
 */
ISO_API void iso_volume_set_progress(iso_volume *volume, iso_progress_fn *progress, void *context);

/* Where the voxels of a dense volume are. */
typedef struct iso_voxels {
    const void *data; /* stored values; voxel (0, 0, 0) */
    iso_type type;
    int dims[3];
    ptrdiff_t stride_y, stride_z; /* in values; x is contiguous */
} iso_voxels;

/* Gives access to the voxels, until the volume is cropped or destroyed. ISO_ERR_UNSUPPORTED: it is sparse. */
ISO_API iso_status iso_volume_voxels(const iso_volume *volume, iso_voxels *voxels, iso_error *error);
/* Returns the physical value of a voxel. Coordinates outside the volume are clamped to it. */
ISO_API double iso_volume_value(const iso_volume *volume, int x, int y, int z);

enum { ISO_HISTOGRAM_BINS = 256, ISO_ISOVALUE_CANDIDATES = 3 };

/* Bin i counts physical values in [low + i * width, low + (i + 1) * width); the last one includes `high`. */
typedef struct iso_histogram {
    /* Range of the finite voxels without padding, low == high for a constant volume; width of a bin. */
    double low, high, width;
    uint64_t bins[ISO_HISTOGRAM_BINS];
    uint64_t counted, nonfinite, padding; /* voxels in bins; NaN or infinite; padding */
    double minimum, maximum;              /* of all finite voxels */
    double padding_value;                 /* meaningful when padding > 0 */
} iso_histogram;

/* Computes the histogram. Padding, which is not counted in bins, are voxels with the value of more than half
 * of the volume's six faces, if it is also the data's least or largest. ISO_ERR_EMPTY: no voxel is finite. */
ISO_API iso_status iso_volume_histogram(iso_volume *volume, iso_histogram *histogram, iso_error *error);
/* Suggests an isovalue, the default of isorender: 0 for level sets, else Otsu's. ISO_ERR_EMPTY: constant. */
ISO_API iso_status iso_volume_suggest(iso_volume *volume, double *isovalue, iso_error *error);
/* Writes a sparse level set, such as a sculpt's volume, as .vdb for OpenVDB's tools, Blender and Houdini.
 * `name` is the grid's name; NULL: "surface". ISO_ERR_USAGE: the volume is dense, or its voxels are not
 * cubes; ISO_ERR_UNSUPPORTED: this build has no OpenVDB; ISO_ERR_WRITE. */
ISO_API iso_status iso_volume_write_vdb(const iso_volume *volume, const char *path, const char *name,
                                        iso_error *error);

/* ---- surfaces ---- */
/* A colour as display values (sRGB). */
typedef struct iso_rgb {
    uint8_t r, g, b;
} iso_rgb;

/* The kind of points that iso_surface_points extracts and pictures are drawn from. */
typedef enum iso_primitive {
    ISO_PRIMITIVE_AUTO, /* EDGE */
    ISO_PRIMITIVE_EDGE, /* the vertices of Marching Cubes, on the edges between voxels */
    ISO_PRIMITIVE_FOOT, /* for level sets only: the nearest points of the surface to the voxels beside it;
                           they are missing in creases narrower than about two voxels */
    ISO_PRIMITIVE_FOOT_ITERATED /* the same for any field, found by iteration */
} iso_primitive;

/* The isosurface of a volume at an isovalue. Points, triangles and crossed cells are computed when first
 * needed, and kept. After an edit the next use updates the bricks (16^3 voxels) that changed. */
typedef struct iso_surface iso_surface;

typedef struct iso_surface_opts {
    double isovalue;
    const iso_rgb *color; /* copied; NULL: one of a small palette, by its place in the picture */
    iso_primitive primitive;
    double opacity; /* share of the light that the surface stops where it is seen face on, 0 .. 1; 0 means 1,
                       opaque (iso_surface_set_look makes it 0). Values below 1 need the method EXACT,
                       RAYCAST or SPLATS */
    /* Of a volume of labels, whole numbers from 0 to 65535: the surface around the voxels with these
     * label_count labels, smooth, so that no voxel changes sides (docs/labels.md); `isovalue` is 0. Surfaces
     * of labels that touch share their border, but for less than a voxel along its edge. Edits are not
     * followed. */
    const int *labels;
    int label_count;
} iso_surface_opts;

/* Creates a surface, which borrows the volume. Whether it is empty is known when it is first used.
 * ISO_ERR_USAGE: the isovalue is not finite, the opacity is out of range, or FOOT was chosen for a volume
 * that is not a level set; ISO_ERR_EMPTY: the isovalue lies outside the narrow band, no voxel has one of the
 * labels; ISO_ERR_FORMAT: there are labels, and a voxel is no label; ISO_ERR_LIMIT: more than 2046 voxels
 * of labels along an axis. */
ISO_API iso_status iso_surface_create(iso_volume *volume, const iso_surface_opts *opts, iso_surface **surface,
                                      iso_error *error);
/* Frees a surface. NULL is allowed. */
ISO_API void iso_surface_destroy(iso_surface *surface);
/* Changes the isovalue, which stays as it was after a failure. Errors as iso_surface_create. */
ISO_API iso_status iso_surface_set_isovalue(iso_surface *surface, double isovalue, iso_error *error);
/* Changes the colour (NULL: one of a small palette; of a cloud its own) and the opacity, 0 .. 1, where 0
 * is 0: only what it absorbs or hides of the light is seen of the surface. ISO_ERR_USAGE: the opacity. */
ISO_API iso_status iso_surface_set_look(iso_surface *surface, const iso_rgb *color, double opacity,
                                        iso_error *error);
/* Frees the points, triangles and cells that the surface keeps; they are computed again when needed. */
ISO_API void iso_surface_trim(iso_surface *surface);
/* Sets the place, mm, that the positions of iso_surface_points and iso_surface_mesh are relative to: near the
 * surface, they keep their precision as floats wherever in the world it is. (0, 0, 0) at first.
 * ISO_ERR_USAGE: it is not finite. */
ISO_API iso_status iso_surface_set_origin(iso_surface *surface, const double origin[3], iso_error *error);
/* Computes the bounding box of the surface in the world, mm. ISO_ERR_EMPTY: the surface is empty. */
ISO_API iso_status iso_surface_bounds(iso_surface *surface, iso_box *box, iso_error *error);

/* A point of a surface, in world space; positions are relative to iso_surface_set_origin. */
typedef struct iso_surface_point {
    float position[3]; /* mm */
    float normal[3];   /* unit, out of the solid */
    float radius;      /* mm; discs with these radii cover the surface */
} iso_surface_point;

/* Copies the points to `points`, which has room for `capacity` of them, and sets *count to their number. With
 * `points` NULL it only counts. Edits may change the order. ISO_ERR_LIMIT: there is not enough room; *count
 * is the number needed, and nothing is copied. A surface may have no points. */
ISO_API iso_status iso_surface_points(iso_surface *surface, iso_surface_point *points, size_t capacity,
                                      size_t *count, iso_error *error);

/* An indexed triangle mesh, in world space; positions are relative to iso_surface_set_origin. */
typedef struct iso_mesh {
    float (*positions)[3];    /* mm; vertex_count of them; owned by the struct, like all its arrays */
    float (*normals)[3];      /* unit, out of the solid */
    uint32_t (*triangles)[3]; /* numbers of vertices, counter-clockwise seen from outside */
    size_t vertex_count, triangle_count;
} iso_mesh;

/* Computes the Marching Cubes mesh of a surface. Vertices are shared by triangles (welded), and the mesh is
 * closed where the surface is. On ambiguous faces, corners at or above the isovalue are separated, as in VTK.
 * Free the mesh with iso_mesh_free. It may be empty. ISO_ERR_LIMIT: more than 2^32 - 1 vertices. */
ISO_API iso_status iso_surface_mesh(iso_surface *surface, iso_mesh *mesh, iso_error *error);
/* Frees the arrays and zeroes the struct. A zeroed struct is allowed. */
ISO_API void iso_mesh_free(iso_mesh *mesh);

typedef struct iso_mesh_measures {
    size_t vertices; /* number of vertices that triangles use */
    size_t edges;    /* number of pairs of vertices that a side of a triangle joins */
    size_t triangles;
    size_t pieces;     /* number of connected pieces; two pieces share no vertex */
    size_t open_edges; /* sides of triangles without an opposite one (an edge can have several); 0: closed */
    size_t crowded_edges; /* number of edges of more than two triangles; a closed mesh can have some */
    int64_t euler;        /* Euler characteristic: vertices - edges + triangles; 2 for a ball, 0 for a ring */
    double area;          /* mm2 */
    double volume;        /* enclosed volume, mm3; NaN when the mesh is open */
} iso_mesh_measures;

/* Measures the mesh of a surface. ISO_ERR_LIMIT: more than 2^31 - 1 vertices. */
ISO_API iso_status iso_surface_measure(iso_surface *surface, iso_mesh_measures *measures, iso_error *error);
/* Writes the points as binary .ply with x y z nx ny nz radius. ISO_ERR_EMPTY, ISO_ERR_WRITE. */
ISO_API iso_status iso_surface_write_points(iso_surface *surface, const char *path, iso_error *error);
/* Writes the welded mesh as .ply, .stl, .obj, .vtp, .glb or .3mf, as the extension of `path` says.
 * ISO_ERR_USAGE: another extension; ISO_ERR_EMPTY, ISO_ERR_WRITE, ISO_ERR_LIMIT. */
ISO_API iso_status iso_surface_write_mesh(iso_surface *surface, const char *path, iso_error *error);

/* ---- lines, glyphs and meshes ---- */
/* The shape that is drawn at a point. The base of cones, cylinders and arrows is at the point, and they
 * extend along the point's direction; the other shapes are centred on the point. */
typedef enum iso_glyph {
    ISO_GLYPH_SPHERE,
    ISO_GLYPH_CONE,
    ISO_GLYPH_CYLINDER,
    ISO_GLYPH_ARROW,
    ISO_GLYPH_ELLIPSOID, /* with the half axes of its point; a sphere when there are none */
    ISO_GLYPH_DISC,      /* perpendicular to its direction */
    ISO_GLYPH_BOX,       /* with the half axes of its point; a cube when there are none */
    ISO_GLYPH_COUNT
} iso_glyph;

/* A set of lines (tubes or ribbons), points (glyphs) or triangles, rendered with surfaces; lines and glyphs
 * are exact at any zoom. It has copies of its data and never changes: several threads may render it. */
typedef struct iso_shape_set iso_shape_set;

typedef struct iso_shape_set_opts {
    const iso_rgb *color; /* one for all; NULL: the colours of the arrays or the file, or of the palette */
    double radius;        /* mm, where the data has no radii; 0: chosen by size and number */
    iso_glyph glyph;      /* the shape drawn at each point */
    bool ribbons;         /* lines: draw flat strips of width 2 * radius instead of tubes */
    bool flat_caps;       /* tubes: flat ends instead of round ones */
    bool true_width;      /* lines: those thinner than a pixel are not widened to a pixel */
    bool ras;             /* files: take the coordinates as RAS although the file does not say so */
    double opacity; /* as of iso_surface_opts, where rays enter a shape and where they leave; EXACT only */
} iso_shape_set_opts;

/* Lines in the caller's arrays; world coordinates in mm. */
typedef struct iso_line_arrays {
    const float *vertices; /* x y z of the vertices of all lines, one line after the other */
    const size_t *starts;  /* line_count + 1: line i has the vertices starts[i] .. starts[i + 1] - 1 */
    size_t line_count;
    const float *radii;    /* one per vertex, >= 0; NULL: opts.radius */
    const uint8_t *colors; /* red green blue, one per vertex; NULL: opts.color */
    const float *normals;  /* of ribbons: x y z of unit vectors; NULL: they twist as little as possible */
} iso_line_arrays;

typedef struct iso_glyph_arrays {
    const float *positions; /* count x 3 */
    size_t count;
    const float *radii;      /* NULL: opts.radius */
    const float *directions; /* count x 3: mm, as long as the cone, cylinder or arrow; NULL: there are none */
    const float *axes;       /* count x 9: three half axes in mm, one after the other; NULL: there are none */
    const uint8_t *colors;   /* count x 3: red green blue; NULL: opts.color */
} iso_glyph_arrays;

/* Make a set of lines or of glyphs and copy the arrays. ISO_ERR_USAGE: an option out of range, or a shape
 * lacks its directions; ISO_ERR_EMPTY: nothing to draw; ISO_ERR_LIMIT: 2^29 vertices, 2^31 points or more. */
ISO_API iso_status iso_shape_set_of_lines(const iso_line_arrays *lines, const iso_shape_set_opts *opts,
                                          iso_shape_set **set, iso_error *error);
ISO_API iso_status iso_shape_set_of_glyphs(const iso_glyph_arrays *glyphs, const iso_shape_set_opts *opts,
                                           iso_shape_set **set, iso_error *error);
/* Reads lines from a file of any type that holds them (docs/formats.md). ISO_ERR_IO,
 * ISO_ERR_FORMAT, ISO_ERR_UNSUPPORTED, and the errors of iso_shape_set_of_lines. */
ISO_API iso_status iso_shape_set_read_lines(const char *path, const iso_shape_set_opts *opts,
                                            iso_shape_set **set, iso_error *error);
/* Reads glyphs from a file of any type that holds them (docs/formats.md). Errors as above. */
ISO_API iso_status iso_shape_set_read_glyphs(const char *path, const iso_shape_set_opts *opts,
                                             iso_shape_set **set, iso_error *error);

/* Make a set of triangles: of arrays, whose normals are not used, or of a file: .stl .obj .ply .off .glb .3mf
 * .vtk or .vtp. Of the options color, ras and opacity count. Faces that are bent by less than 60 degrees are
 * shaded smoothly. ISO_ERR_USAGE: an index without a vertex, a position that is not finite; ISO_ERR_EMPTY: no
 * triangle has an area; ISO_ERR_LIMIT: 2^32 / 3 triangles or more; of files also as above. */
ISO_API iso_status iso_shape_set_of_mesh(const iso_mesh *mesh, const iso_shape_set_opts *opts,
                                         iso_shape_set **set, iso_error *error);
ISO_API iso_status iso_shape_set_read_mesh(const char *path, const iso_shape_set_opts *opts,
                                           iso_shape_set **set, iso_error *error);

/* Vectors or symmetric tensors at the voxels of a grid. */
typedef struct iso_vector_array {
    const float *values;     /* x fastest, in world axes: x y z, or xx xy xz yy yz zz; NaN: there is none */
    int components, dims[3]; /* components 3: vectors; 6: tensors; 0 means 3 */
    const iso_transform *transform; /* NULL: spacing 1, origin 0 */
} iso_vector_array;

typedef struct iso_vector_shape_opts {
    int streamlines;     /* make so many lines along the vectors; 0: glyphs at the voxels */
    int every;           /* glyphs: at each so many voxels on an axis; 0: about 10,000 glyphs at most */
    double scale;        /* glyphs: mm of a vector of length 1, or half axis of eigenvalue 1; 0: chosen */
    double least;        /* shorter vectors, and tensors of less anisotropy, have no glyph; lines end there */
    double step, length; /* lines: mm between vertices, and to each side of the seed at most; 0: chosen */
    uint64_t seed;       /* lines: another number gives lines in other random places */
    bool axial;          /* lines: the vectors have no sign, as the axes of fibres */
} iso_vector_shape_opts;

/* Make a set of vectors or tensors. Instead of SPHERE, opts->glyph means arrows, or ellipsoids whose half
 * axes are the eigenvectors. A file is a volume of 3, 6, 7 (a mask and a tensor) or 9 components. Errors:
 * those above and of iso_volume_open; streamlines of tensors are ISO_ERR_USAGE. */
ISO_API iso_status iso_shape_set_of_vectors(const iso_vector_array *vectors, const iso_vector_shape_opts *how,
                                            const iso_shape_set_opts *opts, iso_shape_set **set,
                                            iso_error *error);
ISO_API iso_status iso_shape_set_read_vectors(const char *path, const iso_vector_shape_opts *how,
                                              const iso_shape_set_opts *opts, iso_shape_set **set,
                                              iso_error *error);
/* Changes the colour (NULL: one of the palette), unless lines or glyphs have colours of their own, and the
 * opacity, as iso_surface_set_look does; not while a thread renders the set. ISO_ERR_USAGE: the opacity. */
ISO_API iso_status iso_shape_set_set_look(iso_shape_set *set, const iso_rgb *color, double opacity,
                                          iso_error *error);
/* Frees a set. NULL is allowed. */
ISO_API void iso_shape_set_destroy(iso_shape_set *set);
/* Returns a world box (mm) that contains all lines or glyphs with their radii. */
ISO_API iso_box iso_shape_set_bounds(const iso_shape_set *set);

/* ---- instances ---- */
typedef struct iso_placement { /* what is at p is drawn at position + scale * (p rotated) */
    iso_vec3 position;         /* mm */
    double rotation[4];        /* quaternion x y z w, of any length; all 0 means none */
    double scale;              /* 1e-9 .. 1e9; 0 means 1 */
} iso_placement;

typedef struct iso_placements {
    iso_placement *items; /* count of them */
    iso_rgb *colors;      /* one for each, instead of the surfaces' and points'; NULL: none */
    size_t count;
} iso_placements;
/* What a picture shows of instances; an instance of several surfaces counts once. */
typedef struct iso_instance_counts {
    size_t drawn, outside, hidden; /* outside the picture; hidden by nearer ones as a whole */
    size_t points;                 /* points of the instances that were drawn */
} iso_instance_counts;

/* Reads placements from .csv, .ply or another file of points: x y z; qx qy qz qw, or rx ry rz (degrees about
 * the world's x axis, then y, then z); scale; red green blue. Owned by the struct: iso_placements_free.
 * ISO_ERR_IO, ISO_ERR_FORMAT, ISO_ERR_LIMIT; ISO_ERR_EMPTY: the file holds no placement. */
ISO_API iso_status iso_placements_read(const char *path, iso_placements *placements, iso_error *error);
/* Frees the arrays and zeroes the struct. A zeroed struct is allowed. */
ISO_API void iso_placements_free(iso_placements *placements);

/* ---- pictures ---- */
/* Largest width or height of a picture, in pixels. */
enum { ISO_IMAGE_MAX = 16384 };

/* 8-bit RGBA, row 0 at the top, alpha straight (not premultiplied). */
typedef struct iso_image {
    int width, height;
    uint8_t *rgba; /* width * height * 4 bytes; owned; freed by iso_image_free */
} iso_image;

/* Allocates an image; its pixels are uninitialised. ISO_ERR_USAGE: a side is not in 1 .. ISO_IMAGE_MAX. */
ISO_API iso_status iso_image_create(int width, int height, iso_image *image, iso_error *error);
/* Frees the pixels and zeroes the struct. A zeroed struct is allowed. */
ISO_API void iso_image_free(iso_image *image);
/* Writes a PNG: RGB when all pixels are opaque, else RGBA. Path "-": to standard output. ISO_ERR_WRITE. */
ISO_API iso_status iso_image_write(const iso_image *image, const char *path, iso_error *error);
/* The bytes of that file, in memory: free them with iso_bytes_free (NULL is allowed). */
ISO_API iso_status iso_image_encode(const iso_image *image, uint8_t **bytes, size_t *size, iso_error *error);
ISO_API void iso_bytes_free(uint8_t *bytes);
/* Reads a PNG or JPEG; profiles are ignored. ISO_ERR_IO, ISO_ERR_FORMAT, ISO_ERR_BACKEND (libjpeg). */
ISO_API iso_status iso_image_read(const char *path, iso_image *image, iso_error *error);

/* The contents of a picture as numbers ("arbitrary output variables"): planes of width * height floats, row 0
 * at the top. In pixels with several samples, depth and normal are means over the covered samples. */
typedef struct iso_aov {
    int width, height;
    float *depth;     /* along the view direction (not along the ray), mm; INFINITY in empty pixels */
    float *normal[3]; /* world x, y, z; unit vectors out of the solid, also where they point away from the
                         viewer; 0 in empty pixels and where the normals of a pixel's samples cancel */
    float *coverage;  /* share of covered samples, 0 .. 1; in pictures with translucent surfaces the alpha */
    float *layers;    /* mean number of layers in the samples of a pixel; NULL: all surfaces are opaque */
    /* Numbers from 1 of what a pixel's nearest sample shows; 0: none; NULL: not known. ids[0]: surface (sets
     * of shapes come after them); ids[1]: glyph, line or triangle of a set; ids[2]: segment of a line. */
    uint32_t *ids[3];
    float voxel; /* smallest voxel spacing of the volumes shown, mm; 0 when unknown */
} iso_aov;

/* Frees the planes and zeroes the struct. A zeroed struct is allowed. */
ISO_API void iso_aov_free(iso_aov *aov);
/* Writes OpenEXR with the 32-bit float channels Z, N.X N.Y N.Z and A, one for the layers if they are known,
 * and the 32-bit integer channels id.surface, id.element and id.segment if ids are known.
 * ISO_ERR_UNSUPPORTED: there is no OpenEXR; ISO_ERR_USAGE: the path is "-"; ISO_ERR_WRITE. */
ISO_API iso_status iso_aov_write(const iso_aov *aov, const char *path, iso_error *error);
/* Reads OpenEXR with these channels, of any program. ISO_ERR_IO, ISO_ERR_FORMAT, ISO_ERR_UNSUPPORTED. */
ISO_API iso_status iso_aov_read(const char *path, iso_aov *aov, iso_error *error);

/* How a surface is drawn. */
typedef enum iso_method {
    ISO_METHOD_EXACT,    /* the trilinear surface itself, found cell by cell: the best pictures */
    ISO_METHOD_MESH,     /* Marching Cubes triangles, as most other programs draw them */
    ISO_METHOD_DISCS,    /* points as curved discs, which follow the surface's curvature */
    ISO_METHOD_PULLPUSH, /* points, joined in an image pyramid by Gaussian weights (Marroquim et al. 2008) */
    ISO_METHOD_PULLPUSH_GAUSSIAN = ISO_METHOD_PULLPUSH, /* an older name */
    ISO_METHOD_PULLPUSH_BOX,                            /* the same by equal weights */
    ISO_METHOD_POINTS,         /* a flat disc parallel to the picture at each point */
    ISO_METHOD_SPLATS,         /* points as flat discs, blended in one pass (Zhang and Pajarola 2006) */
    ISO_METHOD_RAYCAST,        /* rays through the whole volume: slow, the reference for the other methods */
    ISO_METHOD_HYBRID,         /* points where cells are small in the picture, else triangles (2008) */
    ISO_METHOD_SPLATS_FLAT,    /* points as flat discs, filtered against aliasing: for points of files */
    ISO_METHOD_SPLATS_ONEPASS, /* flat discs, front to back (Baerentzen and Christensen 2003) */
    ISO_METHOD_SPLATS_EWA,     /* flat discs by EWA splatting (Zwicker et al. 2001) */
    ISO_METHOD_SPLATS_MEAN     /* the mean of the points in a pixel: for many in each (Schuetz et al. 2021) */
} iso_method;
enum { ISO_METHODS = 13 };

/* The name of a method, such as "exact" (NULL: it is none); and the method of a name (ISO_ERR_USAGE). */
ISO_API const char *iso_method_name(iso_method method);
ISO_API iso_status iso_method_find(const char *name, iso_method *method, iso_error *error);

/* The field whose isosurface is drawn: trilinear between the voxels, or a smooth one, by EXACT and RAYCAST:
 * the tricubic B-spline, prefiltered; or the one that passes through the voxels, for clean simulations. */
typedef enum iso_filter { ISO_FILTER_LINEAR, ISO_FILTER_CUBIC, ISO_FILTER_INTERPOLATING } iso_filter;

/* A camera; the members have the names that VTK and F3D use. */
typedef struct iso_camera {
    iso_vec3 position, focal_point, view_up; /* mm; view_up need not be unit or orthogonal */
    double view_angle;                       /* degrees, full vertical angle, 0 < angle < 180 */
    bool orthographic;
    double parallel_scale; /* orthographic: half the picture's height, mm */
} iso_camera;

/* Standard views, named after the side of the object that faces the viewer. */
typedef enum iso_direction {
    ISO_FRONT, /* looks along +y, z up: the patient's face in LPS */
    ISO_BACK,
    ISO_LEFT, /* the patient's left side (+x) faces the viewer */
    ISO_RIGHT,
    ISO_TOP, /* looks along -z, front (-y) at the bottom */
    ISO_BOTTOM,
    ISO_ISOMETRIC /* from front, patient's left and above */
} iso_direction;

/* How iso_camera_of_box places a camera: in front of a side, turned by azimuth and elevation, and moved to
 * the distance at which the box fits with a margin of 4 %. */
typedef struct iso_fit_opts {
    iso_direction direction;
    const iso_vec3 *up;        /* unit vector, the world direction that is up; NULL: +z */
    double azimuth, elevation; /* degrees: the camera then moves around the box to the right, and upwards */
    double zoom;               /* magnification; 0 means 1 */
    double view_angle;         /* degrees; 0 means 30 */
    bool orthographic;
    int turns; /* the box fits in all of so many views, evenly spaced in azimuth; 0 means 1 */
} iso_fit_opts;

/* Places a camera so that `box` (world) fits into a picture of width x height pixels. ISO_ERR_USAGE: a value
 * is not finite or out of range, or the box is empty. */
ISO_API iso_status iso_camera_of_box(const iso_box *box, int width, int height, const iso_fit_opts *opts,
                                     iso_camera *camera, iso_error *error);

/* How translucent surfaces of points are composited by the method SPLATS (Zhang and Pajarola 2006). */
typedef enum iso_transparency {
    ISO_TRANSPARENCY_SORTED,  /* all discs of a pixel are sorted by depth, and averaged to layers */
    ISO_TRANSPARENCY_GROUPS,  /* algorithm 2: groups of discs that do not overlap are composited apart, and
                                 averaged: faster, and near to SORTED */
    ISO_TRANSPARENCY_NEAREST, /* algorithm 3: GROUPS, behind a nearest layer that is drawn smoothly */
    ISO_TRANSPARENCIES
} iso_transparency;

/* How glass bends light. */
typedef enum iso_refraction {
    ISO_REFRACTION_AUTO,      /* TRACED; of points TWO_SIDED */
    ISO_REFRACTION_NONE,      /* only reflection and absorption */
    ISO_REFRACTION_SINGLE,    /* bent once, by the first surface */
    ISO_REFRACTION_LAYERS,    /* bent once, more for each surface (Zhang and Pajarola 2006): pretty, but no
                                 approximation */
    ISO_REFRACTION_TWO_SIDED, /* bent where rays enter and first leave (Wyman 2005), and followed where they
                                 are totally reflected */
    ISO_REFRACTION_TRACED,    /* rays are followed through the field, with all reflections; not for SPLATS */
    ISO_REFRACTIONS
} iso_refraction;

/* A surface drawn as a solid of glass. */
typedef struct iso_glass_opts {
    double ior; /* index of refraction, 1 .. 10; 1.5: window glass */
    iso_refraction refraction;
    double dispersion; /* Abbe number, 1 or more: small ones bend blue more than red; 0: none */
    /* The colour that white light has after so many mm in the glass; distance 0: clear glass. */
    iso_rgb attenuation_color;
    double attenuation_distance;
    /* Share of the light that each surface takes away, 0 .. 1; for NONE, SINGLE and LAYERS. */
    double surface_opacity;
    /* File of what glass reflects and refracts: an equirectangular .exr (linear R G B) or .png, which is also
     * the background unless one is given; NULL: a built-in studio. */
    const char *environment;
} iso_glass_opts;

/* How solids are closed where they are cut. */
typedef enum iso_cut_cap {
    ISO_CUT_CAP_NONE,
    ISO_CUT_CAP_SURFACE, /* by a face with the surface's colour */
    ISO_CUT_CAP_SLICE,   /* by the volume itself, in greys */
    ISO_CUT_CAPS
} iso_cut_cap;

/* What surfaces are coloured by, as by isorender's --surface-color-by. */
typedef enum iso_color_source {
    ISO_COLOR_BY_VOLUME,    /* values of a volume, trilinear, at the place of each sample; gray outside */
    ISO_COLOR_BY_CURVATURE, /* mean curvature, 1/mm: 1 / r of a ball */
    ISO_COLOR_BY_DISTANCE,  /* signed distance from an isosurface, mm; below 0 inside */
    ISO_COLOR_BY_DEPTH,     /* mm from the camera, along the view */
    ISO_COLOR_BY_NORMAL     /* x, y and z of the normal, -1 .. 1, as red, green and blue */
} iso_color_source;

typedef struct iso_color_by {
    int surface; /* its number in the picture, from 0 */
    iso_color_source source;
    iso_volume *volume; /* BY_VOLUME; BY_DISTANCE: of the isosurface at `isovalue` */
    double isovalue;
    const char *colormap; /* NULL: viridis; for numbers with signs coolwarm */
    double range[2];      /* ascending; both 0: all but 2 % of the surface's numbers at each end */
} iso_color_by;

typedef struct iso_render_opts {
    iso_method method;
    int width, height; /* pixels; 0 means 1024 */
    int samples;       /* of a pixel: 1, 4, 9 .. 64; 0 means 4 for opaque pictures by EXACT, else 1 */
    /* The camera. NULL: a camera that shows everything, placed by `fit`. */
    const iso_camera *camera;
    iso_fit_opts fit;
    const iso_rgb *background; /* NULL: white */
    bool transparent;          /* the background has alpha 0 */
    /* Options of translucent surfaces and shapes, whose crossings are composited in order of depth. */
    bool constant_opacity; /* the opacity is the same at every angle. If not, a thin slab's, which stops more
                              light from slanting rays: 1 - (1 - opacity)^(1 / cos) (Kay, Greenberg 1979) */
    double absorption_length; /* the solid absorbs light: mm after which 1/e of the light is left; what is
                                 absorbed becomes the surface's colour. All surfaces must be of one volume;
                                 not for the method SPLATS. 0: the solid is clear */
    int most_layers;          /* number of crossings of each surface or set that are drawn, from the nearest
                                 on; 0: all. Not together with absorption, which needs all */
    /* Lines and glyphs in the same picture, for every method; in `aov` where they are opaque. */
    iso_shape_set *const *shapes;
    int shapes_count;
    /* Draw the surfaces once for each placement; NULL: once, where they are. For opaque surfaces, drawn as
     * discs: by DISCS or SPLATS_FLAT, _ONEPASS, _EWA or _MEAN. What is outside the picture or hidden as a
     * whole takes no time (Guennebaud et al. 2004, section 7.1). Borrowed. */
    const iso_placements *instances;
    /* Levels of detail of points, also of instances: their error in pixels; 0: all points are drawn. For
     * opaque surfaces by PULLPUSH, DISCS or SPLATS_FLAT, _ONEPASS, _EWA and _MEAN. */
    double lod;
    iso_instance_counts *instance_counts; /* receives what became of the instances; NULL: not wanted */
    iso_transparency transparency;        /* of translucent surfaces, for SPLATS only */
    /* Draws the only surface as glass, by the methods EXACT, RAYCAST, SPLATS and SPLATS_FLAT; NULL: it is not
     * glass. */
    const iso_glass_opts *glass;
    iso_aov *aov; /* receives depth, normals and coverage, and with shapes also ids; NULL: not wanted */
    /* What is cut away, to show what lies behind it, as isorender's --clip says it: "x<12" (y, z, >), "x"
     * (below the middle of the first surface's volume, or of everything), "X,Y,Z:NX,NY,NZ", "camera:30"
     * (mm behind the nearest corner of the box around everything), "box:X0,Y0,Z0,X1,Y1,Z1" or
     * "sphere:X,Y,Z,R"; "keep:" before it keeps only that; "@2,3" behind it cuts only these surfaces,
     * lines, glyphs and meshes (from 1, in this order). At most 16, for EXACT, MESH, RAYCAST and discs;
     * of points the discs, and the centres of Gaussians. */
    const char *const *clips;
    int clip_count;
    iso_cut_cap cap;      /* how cuts are closed */
    double cap_values[2]; /* of SLICE: the values that are black and white */
    /* Light that shows the shape of what is opaque. Ambient occlusion: within how many mm things darken each
     * other; ISO_OCCLUSION_USUAL: a tenth of the longest side; 0: not at all. A soft shadow of the key light.
     * Dark lines along silhouettes and creases, on dark backgrounds light, not beside translucent surfaces:
     * their width in pixels, up to 16; 0: none. What is found out about occlusion is kept by the surface for
     * further pictures in which it is the only one. */
    double occlusion;
    bool shadow;
    double outline;
    iso_filter filter;            /* of all surfaces; not with glass and caps */
    const iso_color_by *color_by; /* translucent surfaces are coloured by EXACT and RAYCAST only */
    int color_by_count;
    iso_camera *camera_used;   /* receives the picture's camera; NULL: not wanted */
    iso_progress_fn *progress; /* instead of those of the volumes (iso_volume_set_progress); NULL: those */
    void *progress_context;
    int threads; /* of a picture without surfaces, which have their own; as of iso_open_opts */
} iso_render_opts;
#define ISO_OCCLUSION_USUAL (-1.0)

/* Renders a surface on the CPU. `image` and opts->aov are zeroed or hold an earlier picture, whose memory is
 * reused if the size is the same. After a failure their pixels are undefined. ISO_ERR_EMPTY: the surface is
 * empty or not in view; ISO_ERR_USAGE: an invalid size, number of samples or camera, or a translucent surface
 * with a method that cannot draw it; ISO_ERR_LIMIT: more than 64 translucent surfaces and sets of shapes. */
ISO_API iso_status iso_render(iso_surface *surface, const iso_render_opts *opts, iso_image *image,
                              iso_error *error);
/* Renders several surfaces in one picture; the nearest hides the others. `count` plus the number of
 * opts->shapes is at most 255; `count` may be 0 if there are shapes. The surfaces may be of different
 * volumes; no other thread may use any of these volumes during the call. */
ISO_API iso_status iso_render_surfaces(iso_surface *const *surfaces, int count, const iso_render_opts *opts,
                                       iso_image *image, iso_error *error);

/* What iso_image_annotate draws over a picture, sized by it and outlined, legible on any background. */
typedef struct iso_annotation_opts {
    const iso_camera *camera; /* of the picture */
    bool scale_bar;           /* bottom right, with its length; of orthographic cameras only */
    bool orientation_marker;  /* bottom left: the world's axes as the camera sees them, x y z */
    bool anatomical;          /* they are called L R, A P and H F: the world is LPS */
    bool no_unit;             /* the length is a number without mm, um .. */
    bool light;               /* light lines: the background is dark */
} iso_annotation_opts;

/* Draws into the picture. ISO_ERR_USAGE: there is no picture or no camera; ISO_ERR_NOMEM. */
ISO_API iso_status iso_image_annotate(iso_image *image, const iso_annotation_opts *opts, iso_error *error);

/* ---- comparing ---- */
typedef struct iso_difference_opts {
    const iso_aov *truth_aov, *candidate_aov; /* of the same size as the pictures; NULL: there is none */
    const iso_rgb *background; /* the colour of uncovered pixels in pictures without alpha; NULL: white */
    double voxel;              /* size of a voxel, mm; 0: truth_aov->voxel */
    double pixels_per_voxel;   /* 0: unknown, and there are no dilations in voxels */
    double pixels_per_degree;  /* pixels per degree of the viewer's visual field, for FLIP; 0 means 67.02 */
    float *flip_map;           /* width * height; receives the FLIP difference of each pixel; or NULL */
} iso_difference_opts;

/* The differences of a candidate picture from the true one. NaN: unknown, or nothing to measure. */
typedef struct iso_difference {
    double psnr_in; /* PSNR in dB over the pixels of either silhouette, widened by 2 pixels */
    double psnr;    /* PSNR in dB of the whole picture; 138.1 for equal pictures */
    /* The largest difference of R, G and B, 0 .. 255: what 99 % of the pixels of psnr_in do not exceed, and
     * its maximum. */
    double error_p99, error_max;
    double ssim; /* SSIM of the luma (Wang et al. 2004); 1 for equal pictures */
    double flip; /* LDR-FLIP (Andersson et al. 2020); 0 for equal pictures */
    double iou;  /* pixels in both silhouettes / pixels in either of them */
    /* Pixels by which the candidate's silhouette is too large; the mean is signed; 99 % of the pixels of its
     * border do not exceed dilation_p99. */
    double dilation_mean, dilation_p99, dilation_max;
    double dilation_mean_voxel, dilation_max_voxel; /* the same in voxels */
    double holes;             /* % of the true silhouette, eroded by 2 pixels, that is not covered */
    double normal_error_deg;  /* mean angle between normals, degrees */
    double depth_error_voxel; /* mean difference of depths, voxels */
    double wrong;             /* % of the pixels covered in both whose depths differ by over 2 voxels */
    double pixels_differing;  /* number of pixels in which a channel differs by more than 1 of 255 */
} iso_difference;

/* Compares two pictures. ISO_ERR_MISMATCH: of different sizes; ISO_ERR_USAGE: pixels_per_degree. */
ISO_API iso_status iso_compare_images(const iso_image *truth, const iso_image *candidate,
                                      const iso_difference_opts *opts, iso_difference *difference,
                                      iso_error *error);

#ifdef __cplusplus
}
#endif

#include "isopoint_clouds.h"  /* points without a volume */
#include "isopoint_figures.h" /* what stands over pictures, as pixels, SVG and PDF */
#include "isopoint_lines.h"   /* lines of meshes of thin branches */
#include "isopoint_meshes.h"  /* smoother, simpler and hollow meshes */
#include "isopoint_parts.h"   /* pictures in parts */
#include "isopoint_sculpt.h"  /* sculpting */

#endif
