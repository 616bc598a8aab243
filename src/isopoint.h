/* isopoint.h: isosurfaces of volumes, rendered and sculpted with points. The whole interface of libisopoint.
 *
 * The way through it:
 *
 *     iso_volume_open, iso_volume_lend    a file, or an array of yours, becomes a volume
 *     iso_surface_create                  a volume and an isovalue: a surface, which follows edits
 *     iso_render                          a picture of it, by any method, with depth and normals
 *     iso_surface_points, iso_surface_mesh    the same surface as points, or as Marching Cubes triangles
 *     iso_shape_set_read_lines, ...          lines and glyphs in the same picture
 *     iso_sculpt_create                   a level set under brushes, with strokes, undo and a journal
 *     iso_compare_images                  how far one picture is from another
 *     iso_image_write, iso_surface_write_mesh, ...    files
 *
 * Options are structs in which all zero means the default: write (iso_render_opts){.width = 640} and leave
 * the rest. A pointer to options may be NULL. Pointers to options and strings are borrowed for the call.
 *
 * Functions that can fail return iso_status, ISO_OK being 0. What they make goes to out-parameters, which are
 * left alone by a failure. The details are one line of text in an iso_error of the caller's; NULL is fine
 * everywhere. Bad data is always an error, never an assertion; a NULL volume, surface or sculpt is a mistake
 * in the program, and so is an index out of range. Memory that runs out is ISO_ERR_NOMEM, which is not
 * repeated below.
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
 *
 * The header is C17 and C++17. Nothing that is not in it is exported. */
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
    ISO_ERR_MISMATCH,    /* things that should agree do not */
    ISO_ERR_USAGE,       /* an argument is out of its range */
    ISO_ERR_IO,          /* missing, unreadable or truncated; or cancelled by a progress function */
    ISO_ERR_FORMAT,      /* not what it should be, or damaged */
    ISO_ERR_UNSUPPORTED, /* a library for it was not built in or is not installed */
    ISO_ERR_BRIDGE,      /* a library that reads the format failed */
    ISO_ERR_BACKEND,     /* no usable OpenGL */
    ISO_ERR_NOMEM,
    ISO_ERR_LIMIT, /* larger than a limit that was set, or than the library can count */
    ISO_ERR_EMPTY, /* there is no surface */
    ISO_ERR_WRITE  /* cannot be written */
} iso_status;

/* One line of detail, printable UTF-8 without a newline, that names the thing and the reason. Initialise it
 * with zeros; it is written to by failures only. */
typedef struct iso_error {
    iso_status status;
    char text[512];
} iso_error;

/* What a status means in general, as "out of memory". Never NULL. */
ISO_API const char *iso_status_text(iso_status status);

/* The exit status of a program that ends with `status`: 0 done, 1 a comparison failed, 2 usage, 3 unreadable
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

/* From index to world: world = origin + direction * (spacing .* index). direction is row-major; its columns
 * are the unit world directions of the x, y and z index axes (as ITK and VTK have it). It may be left-handed.
 */
typedef struct iso_transform {
    double origin[3];    /* of voxel (0, 0, 0), mm */
    double spacing[3];   /* > 0, mm */
    double direction[9]; /* invertible */
} iso_transform;

/* ---- volumes ---- */

/* How voxels are stored. */
typedef enum iso_type { ISO_UINT8, ISO_INT16, ISO_UINT16, ISO_FLOAT32 } iso_type;

/* A file without a header. */
typedef struct iso_raw_layout {
    int dims[3]; /* voxels, x fastest */
    iso_type type;
    int components; /* interleaved; 0 means 1 */
    bool big_endian;
    uint64_t offset; /* bytes before the first voxel */
} iso_raw_layout;

/* Called now and then during long work, `fraction` 0 .. 1; below 0: no news, only the question. Returns 0 to
 * go on; anything else cancels: the work ends with ISO_ERR_IO. */
typedef int iso_progress_fn(void *context, double fraction);

enum { ISO_VOLUME_ITEMS = 32, ISO_VOLUME_NOTES = 8, ISO_VOLUME_TEXT = 256 };

/* What a file's header says. Plain data. The texts are printable UTF-8, a line each. */
typedef struct iso_volume_info {
    char format[16]; /* "vti", "vtk", "nrrd", "metaimage", "nifti", "dicom", "vdb", "raw", "scene" */
    char name[ISO_VOLUME_TEXT]; /* grid or series name, or empty */
    int dims[3];
    iso_type type;             /* as it will be stored */
    char file_type[32];        /* as the file has it, e.g. "int16", "double", "half" */
    int components, component; /* in the file, and the one chosen */
    iso_transform transform;
    double scale, offset; /* physical = stored * scale + offset */
    bool anatomical;      /* world axes are known to be patient axes (LPS) */
    bool level_set;       /* a distance field whose inside is negative */
    bool sparse;          /* stored as a narrow band of 16^3 bricks, in voxels */
    uint64_t bytes;       /* that the volume will take (estimated for sparse ones) */
    uint64_t read_bytes;  /* most that reading takes at one time */
    int item_count;       /* grids in a .vdb, arrays in a .vti or .vtk, series in a folder */
    char items[ISO_VOLUME_ITEMS][ISO_VOLUME_TEXT]; /* one line each, the chosen one's name first in `name` */
    int note_count;                                /* what the reader had to decide */
    char notes[ISO_VOLUME_NOTES][ISO_VOLUME_TEXT];
} iso_volume_info;

/* A volume in memory. */
typedef struct iso_volume iso_volume;

typedef struct iso_open_opts {
    /* The .vdb grid's name, NULL: the only one, or the first level set, or the first scalar one. The .vti or
     * .vtk array's name, NULL: the active scalars, or the first array. */
    const char *grid;
    const char *series;        /* DICOM: series instance UID, or its number, from 1 */
    int component;             /* which of several components, from 0 */
    const iso_raw_layout *raw; /* read as raw, whatever the name; NULL: only when the name tells a layout */
    double spacing[3];         /* > 0 overrides the file's spacing, mm */
    uint64_t max_memory;       /* bytes that reading may take; 0: 80 % of what is free */
    int threads;               /* of the volume; 0: one a processor */
    iso_progress_fn *progress; /* called from the calling thread */
    void *progress_context;
} iso_open_opts;

/* Reads a volume: .nrrd, .nhdr, NIfTI, a DICOM file or folder, .vdb, .vti, legacy .vtk, MetaImage, raw. What
 * a file is follows from its content, and from its name where the content does not tell. The size is checked
 * from the header before memory is taken. Destroy with iso_volume_destroy. ISO_ERR_IO, ISO_ERR_FORMAT,
 * ISO_ERR_UNSUPPORTED, ISO_ERR_BRIDGE, ISO_ERR_USAGE (no such grid, series or component), ISO_ERR_LIMIT. */
ISO_API iso_status iso_volume_open(const char *path, const iso_open_opts *opts, iso_volume **volume,
                                   iso_error *error);

/* Reads the header only, as iso_volume_open would. */
ISO_API iso_status iso_volume_inspect(const char *path, const iso_open_opts *opts, iso_volume_info *info,
                                      iso_error *error);

/* An array of the program's own. */
typedef struct iso_lend_opts {
    int dims[3]; /* voxels, each at least 1 */
    iso_type type;
    void *data; /* dims[0] * dims[1] * dims[2] values, x fastest; kept, not copied */
    void (*release)(
        void *owner); /* called once when the volume is destroyed, and when lending fails; or NULL */
    void *owner;
    double scale, offset;           /* physical = stored * scale + offset; scale 0 means 1, else > 0 */
    const iso_transform *transform; /* copied; NULL: spacing 1, origin 0 */
    bool level_set;                 /* a distance field in mm whose inside is negative */
    int threads;                    /* of the volume; 0: one a processor */
} iso_lend_opts;

/* A volume over an array that the program keeps. Tell what you write to it later with iso_volume_changed.
 * ISO_ERR_USAGE (no data, a thread count), ISO_ERR_FORMAT (dims, scale or transform), ISO_ERR_LIMIT. */
ISO_API iso_status iso_volume_lend(const iso_lend_opts *opts, iso_volume **volume, iso_error *error);

/* Frees a volume. Its surfaces must be destroyed before. NULL is fine. */
ISO_API void iso_volume_destroy(iso_volume *volume);

/* What the volume is; of a lent one, format is "lent". Borrowed until destroy. */
ISO_API const iso_volume_info *iso_volume_describe(const iso_volume *volume);

/* Narrows the volume to voxels lo .. hi (both inclusive); the world stays where it is. Before it has
 * surfaces. ISO_ERR_USAGE when the range is empty or reaches out of the volume, or for a sculpt's volume. */
ISO_API iso_status iso_volume_crop(iso_volume *volume, const int lo[3], const int hi[3], iso_error *error);

/* Tells that voxels lo .. hi (inclusive, clipped to the volume) of a lent array were written: the surfaces of
 * the volume follow at their next use, reading only what changed. Not while they are used. ISO_ERR_USAGE: the
 * volume is sparse. */
ISO_API iso_status iso_volume_changed(iso_volume *volume, const int lo[3], const int hi[3], iso_error *error);

/* The value at a voxel. Coordinates outside are clamped. */
ISO_API double iso_volume_value(const iso_volume *volume, int x, int y, int z);

enum { ISO_HISTOGRAM_BINS = 256, ISO_ISOVALUE_CANDIDATES = 3 };

/* Physical values. Bin i covers [low + i * width, low + (i + 1) * width); the last one includes high. */
typedef struct iso_histogram {
    double low, high, width; /* of finite voxels, padding left out; low == high for a constant volume */
    uint64_t bins[ISO_HISTOGRAM_BINS];
    uint64_t counted, nonfinite, padding; /* voxels in bins, NaN or infinite ones, and left out as padding */
    double minimum, maximum;              /* of all finite voxels */
    double padding_value;                 /* meaningful when padding > 0 */
} iso_histogram;

/* The histogram of a volume. When one single value makes up more than half of the volume's six faces and is
 * the least or the largest of the data, its voxels are padding and left out. ISO_ERR_EMPTY: no finite voxel.
 */
ISO_API iso_status iso_volume_histogram(iso_volume *volume, iso_histogram *histogram, iso_error *error);

/* The isovalue that isorender chooses: 0 for level sets, else Otsu's threshold of the histogram.
 * ISO_ERR_EMPTY: the volume is constant. */
ISO_API iso_status iso_volume_suggest(iso_volume *volume, double *isovalue, iso_error *error);

/* Writes a sparse level set, such as a sculpt's volume, as .vdb for OpenVDB's tools, Blender and Houdini; the
 * file appears whole or not at all. `name` is the grid's, NULL: "surface". ISO_ERR_USAGE: the volume is
 * dense, or its voxels are no cubes; ISO_ERR_UNSUPPORTED without OpenVDB; ISO_ERR_WRITE. */
ISO_API iso_status iso_volume_write_vdb(const iso_volume *volume, const char *path, const char *name,
                                        iso_error *error);

/* ---- surfaces ---- */

/* Display values (sRGB). */
typedef struct iso_rgb {
    uint8_t r, g, b;
} iso_rgb;

/* Which points iso_surface_points makes. */
typedef enum iso_primitive {
    ISO_PRIMITIVE_AUTO, /* FOOT for sparse level sets unless the isovalue is near the end of the narrow band,
                           EDGE for the rest */
    ISO_PRIMITIVE_EDGE, /* the vertices of Marching Cubes, on the edges between voxels */
    ISO_PRIMITIVE_FOOT, /* feet of the perpendiculars from the voxels beside the surface; of level sets only
                         */
    ISO_PRIMITIVE_FOOT_ITERATED /* the same of any field, by iteration */
} iso_primitive;

/* The isosurface of a volume at an isovalue. What a use of it needs (points, triangles, crossed cells) is
 * made when it is first needed, kept, and brought up to date by later uses after edits: only bricks of 16^3
 * voxels that changed are looked at. */
typedef struct iso_surface iso_surface;

typedef struct iso_surface_opts {
    double isovalue;
    const iso_rgb *color; /* copied; NULL: one of a small palette, by its place among those in the picture */
    iso_primitive primitive;
    double opacity; /* share of light that it stops where it is seen face on, 0 .. 1; 0 means 1, opaque. Below
                       1, only the methods EXACT, RAYCAST and SPLATS draw it */
} iso_surface_opts;

/* Makes a surface. The volume is borrowed until destroy. An empty surface is found by its first use.
 * ISO_ERR_USAGE: isovalue not finite, an opacity that cannot be, FOOT for a volume that is no level set;
 * ISO_ERR_EMPTY: the isovalue lies beyond a narrow band. */
ISO_API iso_status iso_surface_create(iso_volume *volume, const iso_surface_opts *opts, iso_surface **surface,
                                      iso_error *error);

/* Frees a surface. NULL is fine. */
ISO_API void iso_surface_destroy(iso_surface *surface);

/* Another isovalue. As iso_surface_create; after a failure the surface has its old one. */
ISO_API iso_status iso_surface_set_isovalue(iso_surface *surface, double isovalue, iso_error *error);

/* The world box of the surface, mm. ISO_ERR_EMPTY: there is no surface. */
ISO_API iso_status iso_surface_bounds(iso_surface *surface, iso_box *box, iso_error *error);

/* A point of a surface, in world space. */
typedef struct iso_surface_point {
    float position[3]; /* mm */
    float normal[3];   /* unit, out of the solid */
    float radius;      /* mm: discs of this radius cover the surface */
} iso_surface_point;

/* Copies the points to `points`, which has room for `capacity` of them; *count is how many there are. Points
 * NULL: only counts. The order is the same every time the whole surface is made, and may change with edits.
 * ISO_ERR_LIMIT: there is not enough room; *count says how much is needed, and nothing is copied. A surface
 * without points is no error here. */
ISO_API iso_status iso_surface_points(iso_surface *surface, iso_surface_point *points, size_t capacity,
                                      size_t *count, iso_error *error);

/* An indexed triangle mesh, in world space. */
typedef struct iso_mesh {
    float (*positions)[3];    /* mm, vertex_count of them; owned, as all arrays here */
    float (*normals)[3];      /* unit, out of the solid */
    uint32_t (*triangles)[3]; /* vertices, counter-clockwise seen from outside */
    size_t vertex_count, triangle_count;
} iso_mesh;

/* The Marching Cubes mesh of a surface, welded: vertices are shared, and the mesh is closed where the surface
 * is. Corners at or above the isovalue are kept apart on ambiguous faces, as VTK does. Free with
 * iso_mesh_free. ISO_ERR_LIMIT above 2^32 - 1 vertices. A mesh of no triangles is no error. */
ISO_API iso_status iso_surface_mesh(iso_surface *surface, iso_mesh *mesh, iso_error *error);

/* Frees the arrays and zeroes the struct. A mesh of zeros is fine. */
ISO_API void iso_mesh_free(iso_mesh *mesh);

typedef struct iso_mesh_measures {
    size_t vertices; /* that a triangle uses */
    size_t edges;    /* pairs of vertices that a triangle's side joins */
    size_t triangles;
    size_t pieces; /* pieces that share no vertex */
    /* Sides of triangles without their opposite: each edge counts by how many more triangles run along it in
     * one direction than in the other. 0: the mesh is closed. */
    size_t open_edges;
    size_t crowded_edges; /* with more than two triangles: they may be there also when the mesh is closed */
    int64_t euler;        /* Euler characteristic: vertices - edges + triangles; 2 for a ball, 0 for a ring */
    double area;          /* mm2 */
    double volume;        /* mm3, enclosed; NaN when the mesh is open */
} iso_mesh_measures;

/* Measures the surface by its mesh. ISO_ERR_LIMIT above 2^31 - 1 vertices. */
ISO_API iso_status iso_surface_measure(iso_surface *surface, iso_mesh_measures *measures, iso_error *error);

/* Writes points as binary .ply: x y z nx ny nz radius. The file appears whole or not at all. ISO_ERR_EMPTY,
 * ISO_ERR_WRITE. */
ISO_API iso_status iso_surface_write_points(iso_surface *surface, const char *path, iso_error *error);

/* Writes the welded mesh as .ply, .stl (both binary) or .obj, by the name's end. The file appears whole or
 * not at all. ISO_ERR_USAGE: another ending; ISO_ERR_EMPTY, ISO_ERR_WRITE, ISO_ERR_LIMIT. */
ISO_API iso_status iso_surface_write_mesh(iso_surface *surface, const char *path, iso_error *error);

/* ---- lines and glyphs ---- */

/* Solids that stand for points. Cones, cylinders and arrows stand on their position and point along their
 * direction; the others are centred on it. */
typedef enum iso_glyph {
    ISO_GLYPH_SPHERE,
    ISO_GLYPH_CONE,
    ISO_GLYPH_CYLINDER,
    ISO_GLYPH_ARROW,
    ISO_GLYPH_ELLIPSOID, /* with half axes; without, a sphere */
    ISO_GLYPH_DISC,      /* perpendicular to its direction */
    ISO_GLYPH_BOX,       /* with half axes; without, a cube */
    ISO_GLYPH_COUNT
} iso_glyph;

/* Lines that are drawn as tubes or ribbons, or points that are drawn as solids, ready to be shown with
 * surfaces: their depth and outline are exact at any zoom. They hold copies of what they are made of and
 * never change; several threads may draw them at the same time. */
typedef struct iso_shape_set iso_shape_set;

typedef struct iso_shape_set_opts {
    const iso_rgb *color; /* of all; NULL: the arrays' or the file's, else the picture chooses one */
    double radius;        /* mm, where there are no radii; 0: chosen by the extent and number */
    iso_glyph glyph;      /* of points */
    bool ribbons;         /* lines are drawn as flat strips, 2 radii wide; else as tubes */
    bool flat_caps;       /* of tubes: the ends are cut off; else they are round */
    bool true_width;      /* of lines: those thinner than a pixel are not widened to one */
    bool ras;             /* of files: the coordinates are RAS though the file does not say so */
} iso_shape_set_opts;

/* Arrays of the caller, world mm. */
typedef struct iso_line_arrays {
    const float (*vertices)[3]; /* one line after the other */
    const size_t *starts;       /* line i has the vertices starts[i] .. starts[i + 1] - 1; line_count + 1 */
    size_t line_count;
    const float *radii;         /* one per vertex, >= 0; NULL: opts.radius */
    const uint8_t (*colors)[3]; /* red green blue, one per vertex; NULL: opts.color */
    const float (*normals)[3];  /* unit, one per vertex, of ribbons; NULL: they turn as little as possible */
} iso_line_arrays;

typedef struct iso_glyph_arrays {
    const float (*positions)[3];
    size_t count;
    const float *radii;           /* NULL: opts.radius */
    const float (*directions)[3]; /* mm: cones, cylinders and arrows are so long; NULL: none */
    const float (*axes)[9];       /* three half axes, mm, one after the other; NULL: none */
    const uint8_t (*colors)[3];   /* red green blue; NULL: opts.color */
} iso_glyph_arrays;

/* Copies arrays. ISO_ERR_USAGE: options out of range, or no direction for a solid that needs one;
 * ISO_ERR_EMPTY: nothing can be drawn; ISO_ERR_LIMIT: 2^29 vertices or 2^31 points, or more. */
ISO_API iso_status iso_shape_set_of_lines(const iso_line_arrays *lines, const iso_shape_set_opts *opts,
                                          iso_shape_set **set, iso_error *error);
ISO_API iso_status iso_shape_set_of_glyphs(const iso_glyph_arrays *glyphs, const iso_shape_set_opts *opts,
                                           iso_shape_set **set, iso_error *error);

/* Reads .tck, .trk, .swc, .obj, .ply with edges, or polydata in .vtk or .vtp. ISO_ERR_IO, ISO_ERR_FORMAT,
 * ISO_ERR_UNSUPPORTED, and the errors above. */
ISO_API iso_status iso_shape_set_read_lines(const char *path, const iso_shape_set_opts *opts,
                                            iso_shape_set **set, iso_error *error);
/* Reads .pdb, .xyz, .csv, .ply, or the points of .vtk or .vtp. */
ISO_API iso_status iso_shape_set_read_glyphs(const char *path, const iso_shape_set_opts *opts,
                                             iso_shape_set **set, iso_error *error);

/* NULL is fine. */
ISO_API void iso_shape_set_destroy(iso_shape_set *set);

/* A world box around all of them, sizes included. */
ISO_API iso_box iso_shape_set_bounds(const iso_shape_set *set);

/* ---- pictures ---- */

/* Largest width or height. */
enum { ISO_IMAGE_MAX = 16384 };

/* 8-bit RGBA, row 0 at the top, alpha straight (not premultiplied). */
typedef struct iso_image {
    int width, height;
    uint8_t *rgba; /* width * height * 4 bytes; owned: iso_image_free */
} iso_image;

/* An image with pixels of any value. ISO_ERR_USAGE when a side is not in 1 .. ISO_IMAGE_MAX. */
ISO_API iso_status iso_image_create(int width, int height, iso_image *image, iso_error *error);

/* Frees the pixels and zeroes the struct. An image of zeros is fine. */
ISO_API void iso_image_free(iso_image *image);

/* Writes a PNG, RGB when all pixels are opaque and RGBA otherwise; "-" is stdout, and a file appears whole or
 * not at all. ISO_ERR_WRITE. */
ISO_API iso_status iso_image_write(const iso_image *image, const char *path, iso_error *error);

/* Reads any PNG; gamma and colour profiles are ignored. ISO_ERR_IO, ISO_ERR_FORMAT. */
ISO_API iso_status iso_image_read(const char *path, iso_image *image, iso_error *error);

/* What a picture shows as numbers ("arbitrary output variables"): planes of width * height floats, row 0 at
 * the top. Of a pixel with several samples, depth and normal are the means of its covered samples. */
typedef struct iso_aov {
    int width, height;
    float *depth;     /* distance along the view direction (not along the ray), mm; INFINITY where empty */
    float *normal[3]; /* world x, y, z: unit, out of the solid, not turned to the viewer; 0 where empty and
                         where the normals of a pixel's samples cancel */
    float *coverage;  /* share of covered samples, 0 .. 1; with translucent surfaces: alpha */
    float *layers;    /* mean number of layers of a pixel's samples; NULL: all surfaces are opaque */
    /* What the nearest sample of a pixel shows, counted from 1; 0 where empty. Which surface: surfaces in
     * their order, then sets of shapes. Which of its glyphs, lines or triangles; 0: a surface of a volume.
     * Which segment of the line; 0: no line. NULL: not known. */
    uint32_t *ids[3];
    float voxel; /* smallest voxel spacing of what is shown, mm; 0 when unknown */
} iso_aov;

/* Frees the planes and zeroes the struct. One of zeros is fine. */
ISO_API void iso_aov_free(iso_aov *aov);

/* Writes OpenEXR: Z, N.X N.Y N.Z, A and, if they are known, layers as 32-bit floats, id.surface, id.element
 * and id.segment as 32-bit integers. The file appears whole or not at all. ISO_ERR_UNSUPPORTED without
 * OpenEXR; ISO_ERR_USAGE ("-" cannot be written to), ISO_ERR_WRITE. */
ISO_API iso_status iso_aov_write(const iso_aov *aov, const char *path, iso_error *error);

/* Reads such a picture, also of other programs. ISO_ERR_IO, ISO_ERR_FORMAT, ISO_ERR_UNSUPPORTED. */
ISO_API iso_status iso_aov_read(const char *path, iso_aov *aov, iso_error *error);

/* How a surface is drawn. */
typedef enum iso_method {
    ISO_METHOD_EXACT,             /* the trilinear surface itself, cell by cell: choose it for pictures */
    ISO_METHOD_MESH,              /* Marching Cubes triangles: what other programs draw */
    ISO_METHOD_PULLPUSH,          /* points as curved discs, filled in image space */
    ISO_METHOD_PULLPUSH_GAUSSIAN, /* points, filled with Gaussian weights (Marroquim et al. 2008) */
    ISO_METHOD_PULLPUSH_BOX,      /* the same with equal weights */
    ISO_METHOD_POINTS,            /* discs that face the picture: the samples themselves */
    ISO_METHOD_SPLATS,            /* points as flat discs, blended in one pass (Zhang and Pajarola 2006) */
    ISO_METHOD_RAYCAST            /* rays through the whole field: slow, to check the others */
} iso_method;
enum { ISO_METHODS = 8 };

/* "exact", "mesh", "pullpush", "pullpush-gaussian", "pullpush-box", "points", "splats", "raycast"; NULL: no
 * method. */
ISO_API const char *iso_method_name(iso_method method);

/* The method of that name. ISO_ERR_USAGE. */
ISO_API iso_status iso_method_find(const char *name, iso_method *method, iso_error *error);

/* Names are F3D's. */
typedef struct iso_camera {
    iso_vec3 position, focal_point, view_up; /* mm; view_up need not be unit or orthogonal */
    double view_angle;                       /* degrees, full vertical angle, 0 < angle < 180 */
    bool orthographic;
    double parallel_scale; /* orthographic: half the picture's height, mm */
} iso_camera;

/* The side that is looked at. */
typedef enum iso_direction {
    ISO_FRONT, /* looks along +y, z up: the patient's face in LPS */
    ISO_BACK,
    ISO_LEFT, /* the patient's left side (+x) faces the viewer */
    ISO_RIGHT,
    ISO_TOP, /* looks along -z, front (-y) at the bottom */
    ISO_BOTTOM,
    ISO_ISOMETRIC /* from front, patient's left and above */
} iso_direction;

/* A camera that shows all of something, as isorender chooses it: from a side, turned, at the distance at
 * which it fits with a margin of 4 %. */
typedef struct iso_fit_opts {
    iso_direction direction;
    const iso_vec3 *up;        /* which world axis is up, unit; NULL: +z */
    double azimuth, elevation; /* degrees: then the eye goes to the right, and upwards */
    double zoom;               /* enlarges; 0 means 1 */
    double view_angle;         /* degrees; 0 means 30 */
    bool orthographic;
    int turns; /* the distance fits this many views, evenly spaced in azimuth: a turntable; 0 means 1 */
} iso_fit_opts;

/* Fits `box` (world) into a picture of width x height. ISO_ERR_USAGE: a value that is not finite, an empty
 * box, a size, angle, zoom or number of turns that cannot be. */
ISO_API iso_status iso_camera_of_box(const iso_box *box, int width, int height, const iso_fit_opts *opts,
                                     iso_camera *camera, iso_error *error);

typedef struct iso_render_opts {
    iso_method method;
    int width, height; /* pixels; 0 means 1024 */
    int samples;       /* a pixel: a square number 1, 4, 9 .. 64; 0 means 1 */
    /* Where it is seen from. NULL: `fit` of all that is shown. */
    const iso_camera *camera;
    iso_fit_opts fit;
    const iso_rgb *background; /* NULL: white */
    bool transparent;          /* the background's alpha is 0 */
    /* Of translucent surfaces. Every crossing of a ray is composited, in order. */
    bool constant_opacity; /* the same at every angle. Else a surface is a thin slab, of which slanting rays
                              pass more: it stops 1 - (1 - opacity)^(1 / cos) (Kay and Greenberg 1979) */
    double absorption_length; /* mm of the solid after which 1/e of the light is left, the rest becomes the
                                 surface's colour; of surfaces of one volume, not by splats; 0: the solid is
                                 clear */
    int most_layers;          /* only the first so many crossings of each surface are drawn; 0: all. Not with
                                 absorption, which must know where rays leave the solid */
    iso_shape_set *const
        *shapes; /* drawn in the picture, too, in front of or behind the surfaces; by any method */
    int shapes_count;
    iso_aov *aov; /* gets depth, normals and coverage as well, and ids with shapes; NULL: not wanted */
} iso_render_opts;

/* Renders a surface on the cpu. `image` (and opts->aov) hold zeros or an earlier picture, whose memory is
 * used again where its size is the same; after a failure they can be freed or used again, and their pixels
 * mean nothing. ISO_ERR_EMPTY: there is no surface, or nothing of it is in view; ISO_ERR_USAGE: a size, a
 * number of samples, a camera that cannot see, or a translucent surface by a method that cannot draw it;
 * ISO_ERR_LIMIT: more than 64 translucent surfaces. */
ISO_API iso_status iso_render(iso_surface *surface, const iso_render_opts *opts, iso_image *image,
                              iso_error *error);

/* Several surfaces in one picture, each before what lies behind it: up to 255 of them and of opts->shapes,
 * and none with shapes. They may be of different volumes; all these are in use by the calling thread then. */
ISO_API iso_status iso_render_surfaces(iso_surface *const *surfaces, int count, const iso_render_opts *opts,
                                       iso_image *image, iso_error *error);

/* ---- comparing ---- */

typedef struct iso_difference_opts {
    const iso_aov *truth_aov, *candidate_aov; /* of the pictures' size; NULL: not known */
    const iso_rgb *background; /* means "not covered" in pictures without transparency; NULL: white */
    double voxel;              /* mm; 0: what truth_aov says */
    double pixels_per_voxel;   /* 0: dilations are not known in voxels */
    double pixels_per_degree;  /* how densely the eye sees the pictures; 0 means 67.02 */
    float *flip_map;           /* width * height differences 0 .. 1 are written to it; NULL */
} iso_difference_opts;

/* How far a candidate is from the truth. NaN: not known, or nothing to measure. */
typedef struct iso_difference {
    double psnr_in; /* dB, over the pixels of either silhouette widened by 2 pixels */
    double psnr;    /* dB, whole picture; 138.1 for equal ones */
    double ssim;    /* Wang et al. 2004, of luma; 1 for equal ones */
    double flip;    /* LDR-FLIP, Andersson et al. 2020; 0 for equal ones */
    double iou;     /* pixels in both silhouettes / in either */
    double dilation_mean,
        dilation_max; /* pixels that the candidate's silhouette is too large; mean is signed */
    double dilation_mean_voxel, dilation_max_voxel; /* the same in voxels */
    double holes;             /* percent of the truth, eroded by 2 pixels, that the candidate leaves open */
    double normal_error_deg;  /* mean angle, degrees */
    double depth_error_voxel; /* mean, voxels */
    double wrong;             /* percent of the pixels covered by both that are more than 2 voxels apart */
    double pixels_differing;  /* pixels with a difference of more than 1 of 255 in any channel */
} iso_difference;

/* Compares two pictures. ISO_ERR_MISMATCH: sizes differ; ISO_ERR_USAGE: pixels_per_degree. */
ISO_API iso_status iso_compare_images(const iso_image *truth, const iso_image *candidate,
                                      const iso_difference_opts *opts, iso_difference *difference,
                                      iso_error *error);

/* ---- sculpting ---- */

/* What a touch of a brush does. The first four are set operations with the brush's solid, the others deform
 * what is there. */
typedef enum iso_tool {
    ISO_TOOL_ADD,         /* union */
    ISO_TOOL_CARVE,       /* difference */
    ISO_TOOL_BLEND_ADD,   /* smooth union, over `blend` */
    ISO_TOOL_BLEND_CARVE, /* smooth difference */
    ISO_TOOL_SMOOTH,
    ISO_TOOL_INFLATE,
    ISO_TOOL_DEFLATE,
    ISO_TOOL_FLATTEN, /* towards the plane of the sample's position and normal */
    ISO_TOOL_PINCH,   /* towards the axis of the sample's normal */
    ISO_TOOL_MOVE,    /* drags what lay at the stroke's first sample to the current one */
    ISO_TOOL_MASK,    /* freezes what it touches */
    ISO_TOOL_UNMASK,
    ISO_TOOL_COUNT
} iso_tool;

/* The solid of a set operation, centred on the sample, its z axis along the sample's normal; sizes in radii.
 */
typedef enum iso_solid {
    ISO_SOLID_SPHERE,
    ISO_SOLID_BOX,      /* half sides 1, `aspect`, `aspect` */
    ISO_SOLID_CAPSULE,  /* from the sample before to this one */
    ISO_SOLID_CYLINDER, /* radius 1, half height `aspect` */
    ISO_SOLID_TORUS,    /* ring radius 1, tube radius `aspect` */
    ISO_SOLID_STAMP,    /* a mesh: iso_sculpt_set_stamp */
    ISO_SOLID_COUNT
} iso_solid;

/* How the effect of a deforming touch fades from 1 at the centre to 0 at the radius. */
typedef enum iso_falloff {
    ISO_FALLOFF_SMOOTH, /* (1 - t^2)^2 */
    ISO_FALLOFF_LINEAR,
    ISO_FALLOFF_CONSTANT,
    ISO_FALLOFF_COUNT
} iso_falloff;

/* Zero fields mean: add, sphere, smooth falloff, strength 1 where a strength applies, aspect 0.5, blend 0.25
 * of the radius, spacing 0.25 of the radius, no symmetry. The radius must be given. */
typedef struct iso_brush {
    iso_tool tool;
    iso_solid shape;
    iso_falloff falloff;
    double radius;          /* mm, > 0 */
    double strength;        /* 0 .. 1 */
    double aspect;          /* of a box, cylinder or torus, in radii: see iso_solid */
    double blend;           /* width of the smooth transition of BLEND tools, mm */
    double spacing;         /* between touches along the stroke, in radii */
    unsigned symmetry;      /* bit a: mirrored at the plane of axis a through `mirror` */
    iso_vec3 mirror;        /* world */
    bool pressure_radius;   /* pressure scales the radius */
    bool pressure_strength; /* pressure scales the strength */
} iso_brush;

/* One pick on the surface, or in space. */
typedef struct iso_sample {
    iso_vec3 position; /* world, mm */
    iso_vec3 normal;   /* unit, world, out of the solid */
    double pressure;   /* 0 .. 1; 1 for a mouse */
    double seconds;    /* since the session began; says how it was played, nothing depends on it */
} iso_sample;

/* What touches did; functions add to it. */
typedef struct iso_edit_stats {
    size_t edited, redistanced, created, pruned; /* cells of 16^3 voxels */
    bool clipped; /* the brush reached beyond the grid: what lies outside is lost */
} iso_edit_stats;

/* A level set, the brushes that work on it, its undo history and its journal. A journal is an append-only
 * file of strokes (one JSON line each, with a checksum): autosave, crash recovery and recording in one. */
typedef struct iso_sculpt iso_sculpt;

typedef struct iso_sculpt_opts {
    double voxel_size;   /* mm; 0 means 1, or the smallest spacing of the volume that it is made of */
    int dims[3];         /* of a ball's grid, voxels, at most 2048; 0 means 256 */
    double radius;       /* of the ball, mm; 0: a quarter of the grid's smallest side */
    const char *journal; /* a stroke file to create; NULL: none */
    size_t undo_memory;  /* bytes; 0 means 1 GiB; beyond it, undo steps go to a file beside the journal */
    int threads;         /* 0: one a processor */
} iso_sculpt_opts;

/* A new ball, at the world's origin, in the middle of its grid. ISO_ERR_USAGE, ISO_ERR_LIMIT: its size;
 * ISO_ERR_WRITE: the journal exists already, or cannot be made. */
ISO_API iso_status iso_sculpt_create(const iso_sculpt_opts *opts, iso_sculpt **sculpt, iso_error *error);

/* The solid that a volume has at an isovalue, sampled with cubic voxels along the volume's axes and made a
 * distance field, with 32 voxels of room around. The volume is borrowed for the call. A journal is not
 * possible (ISO_ERR_UNSUPPORTED): it would need the volume's file. ISO_ERR_EMPTY: nothing is inside, or
 * nothing outside; ISO_ERR_LIMIT. */
ISO_API iso_status iso_sculpt_from_volume(iso_volume *volume, double isovalue, const iso_sculpt_opts *opts,
                                          iso_sculpt **sculpt, iso_error *error);

/* Plays a stroke file that began with a ball; the file is only read. Of `opts`, undo_memory and threads
 * count. A last line that was cut short by a crash is left out. ISO_ERR_IO, ISO_ERR_FORMAT (naming the line
 * that is damaged or asks for more than a stroke file may), ISO_ERR_UNSUPPORTED: it began with a file. */
ISO_API iso_status iso_sculpt_replay(const char *path, const iso_sculpt_opts *opts, iso_sculpt **sculpt,
                                     iso_error *error);

/* The same, and what is done from here on is appended to the file. ISO_ERR_WRITE: it cannot be written. */
ISO_API iso_status iso_sculpt_resume(const char *path, const iso_sculpt_opts *opts, iso_sculpt **sculpt,
                                     iso_error *error);

/* Closes the journal, after all of it is on the disk, and frees everything. Surfaces of the sculpt's volume
 * must be destroyed before. NULL is fine. */
ISO_API void iso_sculpt_destroy(iso_sculpt *sculpt);

/* The level set, as a volume: surfaces of it follow every touch. Borrowed until the sculpt is destroyed; not
 * to be destroyed by the caller. */
ISO_API iso_volume *iso_sculpt_volume(iso_sculpt *sculpt);

/* A stroke: begin with its first sample, then samples, then end or cancel. A sample makes as many touches as
 * the brush's spacing asks for, none when the pointer has hardly moved. `stats` (NULL is fine) are added to.
 * ISO_ERR_USAGE: a bad brush or sample, or not the time for it; the field is as before then. */
ISO_API iso_status iso_sculpt_begin(iso_sculpt *sculpt, const iso_brush *brush, const iso_sample *sample,
                                    iso_edit_stats *stats, iso_error *error);
/* The next sample of a stroke. As iso_sculpt_begin. */
ISO_API iso_status iso_sculpt_sample(iso_sculpt *sculpt, const iso_sample *sample, iso_edit_stats *stats,
                                     iso_error *error);
/* Ends a stroke: it is one step of the undo history. ISO_ERR_USAGE: none was begun. */
ISO_API iso_status iso_sculpt_end(iso_sculpt *sculpt, iso_error *error);
/* Undoes the stroke that is being drawn, and ends it. ISO_ERR_USAGE: none was begun. */
ISO_API iso_status iso_sculpt_cancel(iso_sculpt *sculpt, iso_error *error);

/* Undoes the last stroke: the field is as before it, to the bit. ISO_ERR_USAGE: there is nothing to undo, or
 * a stroke is being drawn. */
ISO_API iso_status iso_sculpt_undo(iso_sculpt *sculpt, iso_error *error);
/* Redoes the stroke that was undone last, to the bit. As iso_sculpt_undo. */
ISO_API iso_status iso_sculpt_redo(iso_sculpt *sculpt, iso_error *error);

/* How many strokes can be undone. */
ISO_API size_t iso_sculpt_undo_count(iso_sculpt *sculpt);
/* How many strokes can be redone. */
ISO_API size_t iso_sculpt_redo_count(iso_sculpt *sculpt);

/* What ISO_SOLID_STAMP is from now on: the solid that a mesh encloses, .stl, .obj or .ply; small holes are
 * closed, and the journal gets a copy of its field. Its longest side is twice the brush's radius. ISO_ERR_IO,
 * ISO_ERR_FORMAT, ISO_ERR_EMPTY (it encloses nothing), ISO_ERR_USAGE while a stroke is drawn. */
ISO_API iso_status iso_sculpt_set_stamp(iso_sculpt *sculpt, const char *path, iso_error *error);

/* ISO_OK, or why the journal lags behind what was done (a full disk): it keeps trying. */
ISO_API iso_status iso_sculpt_journal_status(iso_sculpt *sculpt, iso_error *error);

#ifdef __cplusplus
}
#endif
#endif
