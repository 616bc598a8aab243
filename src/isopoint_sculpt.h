/* isopoint_sculpt: the chapter of isopoint.h about sculpting. isopoint.h includes it; what that file says of
 * units, errors, ownership and threads holds here too. */
#ifndef ISOPOINT_SCULPT_H
#define ISOPOINT_SCULPT_H

#include "isopoint.h"

#ifdef __cplusplus
extern "C" {
#endif

/* The first four are set operations with the brush's solid; the others deform, change the mask, or paint. */
typedef enum iso_tool {
    ISO_TOOL_ADD,         /* union */
    ISO_TOOL_CARVE,       /* difference */
    ISO_TOOL_BLEND_ADD,   /* smooth union, over `blend` */
    ISO_TOOL_BLEND_CARVE, /* smooth difference */
    ISO_TOOL_SMOOTH,
    ISO_TOOL_INFLATE,
    ISO_TOOL_DEFLATE,
    ISO_TOOL_FLATTEN,    /* towards the plane of the sample's position and normal */
    ISO_TOOL_SCRAPE,     /* removes what rises above the mean plane of the surface within the radius */
    ISO_TOOL_FILL,       /* fills what lies below that plane */
    ISO_TOOL_CLAY,       /* fills up to a plane that is a little higher: each touch adds a layer */
    ISO_TOOL_PINCH,      /* towards the axis of the sample's normal */
    ISO_TOOL_CREASE,     /* pinches, and digs a groove along the stroke */
    ISO_TOOL_SNAKE_HOOK, /* drags the surface along, from each sample to the next */
    ISO_TOOL_MOVE,       /* drags what lay at the stroke's first sample to the current one */
    ISO_TOOL_MASK, /* freezes the voxels within the radius: brushes do not move them across the surface */
    ISO_TOOL_UNMASK,
    ISO_TOOL_CLEAR_MASK,  /* at a stroke's first sample: unfreezes all voxels, wherever the sample is */
    ISO_TOOL_INVERT_MASK, /* the same: freezes what is not frozen, and unfreezes the rest */
    ISO_TOOL_BLUR_MASK,   /* the same: smooths the border of the mask, over the radius, at most 16 voxels */
    ISO_TOOL_MASK_VOXELS, /* the same: freezes the voxels that iso_sculpt_freeze has named */
    ISO_TOOL_PAINT,       /* lays the brush's colour over the surface; without a colour: takes paint away */
    /* The last three act when the stroke ends, by what its samples outline for a viewer whom their normals
     * point to: parallel normals extend the outline as a prism, normals towards one point as a pyramid. */
    ISO_TOOL_TRIM_PLANE, /* removes what lies to the right of the line from the first sample to the last */
    ISO_TOOL_TRIM_LASSO, /* removes what lies within the outline, which needs three samples */
    ISO_TOOL_CROP_LASSO, /* removes what lies outside of it */
    ISO_TOOL_COUNT
} iso_tool;

/* The solid of a set operation, centred on the sample, its z axis along the normal. Sizes in brush radii. */
typedef enum iso_solid {
    ISO_SOLID_SPHERE,
    ISO_SOLID_BOX,      /* half sides 1, `aspect`, `aspect` */
    ISO_SOLID_CAPSULE,  /* from the previous sample to this one */
    ISO_SOLID_CYLINDER, /* radius 1, half height `aspect` */
    ISO_SOLID_TORUS,    /* ring radius 1, tube radius `aspect` */
    ISO_SOLID_STAMP,    /* a mesh, set by iso_sculpt_set_stamp */
    ISO_SOLID_COUNT
} iso_solid;

/* How a deforming touch weakens from 1 at the centre to 0 at the radius; t = distance / radius. */
typedef enum iso_falloff {
    ISO_FALLOFF_SMOOTH, /* (1 - t^2)^2 */
    ISO_FALLOFF_LINEAR,
    ISO_FALLOFF_CONSTANT,
    ISO_FALLOFF_COUNT
} iso_falloff;

/* Whether a picture of heights, set by iso_sculpt_set_stamp, weighs what SMOOTH to CLAY do: its longest side
 * is twice the radius, black does nothing, and its upper edge points to .. */
typedef enum iso_alpha {
    ISO_ALPHA_NONE,
    ISO_ALPHA_FIXED,   /* .. the z axis, as far as the surface allows; where it cannot, the y axis */
    ISO_ALPHA_FOLLOWS, /* .. where the stroke goes; at its first sample as FIXED */
    ISO_ALPHA_COUNT
} iso_alpha;

/* A brush. Members that are 0 mean: tool add, sphere, smooth falloff, full strength (for tools with a
 * strength), aspect 0.5, blend and spacing 0.25 of the radius, no symmetry. The radius must be set. With both
 * symmetries each image is mirrored, too; there are at most 256 images. Where radial or repeated images
 * overlap, they act as one of their mean. */
typedef struct iso_brush {
    iso_tool tool;
    iso_solid shape;
    iso_falloff falloff;
    double radius;     /* mm, > 0 */
    double strength;   /* 0 .. 1 */
    double aspect;     /* of a box, cylinder or torus, in radii: see iso_solid */
    double blend;      /* width of the smooth transition of BLEND tools, mm */
    double spacing;    /* distance between touches along the stroke, in radii */
    unsigned symmetry; /* bit a: mirrored at the plane through `mirror` perpendicular to axis a */
    iso_vec3 mirror;   /* a point in the world, mm */
    unsigned radial;   /* 2 .. 32: images, each turned by a further 1 / radial of a turn; 0, 1: none */
    iso_alpha alpha;
    char radial_axis;       /* 'x', 'y' or 'z' (0: 'z'): what they turn around, through `mirror` */
    bool pressure_radius;   /* pressure scales the radius */
    bool pressure_strength; /* pressure scales the strength */
    bool has_color;         /* the surface that PAINT, the first four tools, INFLATE, FILL and CLAY make .. */
    iso_rgb color;          /* .. has this colour (sRGB); without one it has no paint */
    unsigned repeat[2];     /* 2 ..: so many images, each moved by a further .. (0, 1: none). With the second
                               one: rows of the first, a grid. They are turned and mirrored, too. */
    iso_vec3 repeat_by[2];  /* .. distance, mm */
} iso_brush;

/* One position of the pointer during a stroke, on the surface or in space. */
typedef struct iso_sample {
    iso_vec3 position; /* world, mm */
    iso_vec3 normal;   /* unit, world, out of the solid */
    double pressure;   /* 0 .. 1; 1 for a mouse */
    double seconds;    /* time since the session began; recorded only, the result does not depend on it */
} iso_sample;

/* What edits did. Functions add to the members. */
typedef struct iso_edit_stats {
    size_t edited, redistanced, created, pruned; /* numbers of cells (16^3 voxels) */
    bool clipped; /* part of a brush that makes material was outside the grid and had no effect there */
} iso_edit_stats;

/* A sculpting session: a level set, its undo history and its journal. The journal is an append-only file of
 * all strokes (JSON lines with checksums): autosave, crash recovery, recording. */
typedef struct iso_sculpt iso_sculpt;

typedef struct iso_sculpt_opts {
    double voxel_size;   /* mm; 0 means 1 for a ball, and the smallest spacing for a volume */
    int dims[3];         /* voxels of the grid of a new ball, each at most 2048; 0 means 256 */
    double radius;       /* radius of a new ball, mm; 0: a quarter of the grid's smallest side */
    iso_solid solid;     /* of a new session: SPHERE to TORUS, whose axis is z, instead of this ball, if .. */
    iso_vec3 size;       /* .. the size of its bounding box is given, mm: of all but a box x and z count; a
                            torus is a ring of x, whose tube has the diameter z. The grid suits it: dims and
                            radius are 0, and the voxel size is by default 1/160 of its longest side */
    double round;        /* of a box or cylinder: the radius of its edges, mm */
    const char *journal; /* path of the journal (stroke file) to create; NULL: no journal */
    size_t undo_memory;  /* bytes; 0 means 1 GiB; further undo steps are kept in a file beside the journal */
    int threads;         /* 0: one for each processor */
} iso_sculpt_opts;

/* Creates a ball (or the solid of opts->size) at the world's origin, in the middle of its grid, as exact
 * distances. ISO_ERR_USAGE, ISO_ERR_LIMIT: the size;
 * ISO_ERR_WRITE: the journal already exists or cannot be created. */
ISO_API iso_status iso_sculpt_create(const iso_sculpt_opts *opts, iso_sculpt **sculpt, iso_error *error);
/* Converts the solid that a volume has at an isovalue to a level set with cubic voxels along the volume's
 * axes and a margin of 32 voxels on each side. The volume is borrowed for the call. opts->journal must be
 * NULL (else ISO_ERR_UNSUPPORTED), because a journal would have to name the volume's file. ISO_ERR_EMPTY: no
 * voxel is inside, or none is outside; ISO_ERR_LIMIT. */
ISO_API iso_status iso_sculpt_from_volume(iso_volume *volume, double isovalue, const iso_sculpt_opts *opts,
                                          iso_sculpt **sculpt, iso_error *error);
/* Replays a stroke file and leaves it unchanged. The file that the session began with, if any, is looked for
 * at its path and beside the stroke file. Of `opts` undo_memory and threads are used. An incomplete last
 * line, as after a crash, is ignored. ISO_ERR_IO: a file is missing; ISO_ERR_FORMAT: a line is damaged or
 * exceeds the limits, or the first file has changed (the text says which); else errors of reading it. */
ISO_API iso_status iso_sculpt_replay(const char *path, const iso_sculpt_opts *opts, iso_sculpt **sculpt,
                                     iso_error *error);
/* Replays a stroke file, and appends all further strokes to it. ISO_ERR_WRITE: it cannot be written to. */
ISO_API iso_status iso_sculpt_resume(const char *path, const iso_sculpt_opts *opts, iso_sculpt **sculpt,
                                     iso_error *error);
/* Waits until the journal is on disk; frees everything. Destroy the volume's surfaces first. NULL is fine. */
ISO_API void iso_sculpt_destroy(iso_sculpt *sculpt);
/* Returns the level set, whose surfaces follow every touch, and are drawn in its paint by methods that colour
 * surfaces (unless iso_render_opts.color_by colours them). It belongs to the sculpt: do not destroy it. */
ISO_API iso_volume *iso_sculpt_volume(iso_sculpt *sculpt);
/* Begins a stroke with its first sample; more samples follow, then the end or a cancel. Each sample makes as
 * many touches as the brush's spacing requires, perhaps none. `stats` (may be NULL) is added to.
 * ISO_ERR_USAGE: an invalid brush or sample, or a stroke is in progress; nothing has changed. */
ISO_API iso_status iso_sculpt_begin(iso_sculpt *sculpt, const iso_brush *brush, const iso_sample *sample,
                                    iso_edit_stats *stats, iso_error *error);
/* Adds a sample to the stroke. ISO_ERR_USAGE: an invalid sample, or no stroke is in progress. */
ISO_API iso_status iso_sculpt_sample(iso_sculpt *sculpt, const iso_sample *sample, iso_edit_stats *stats,
                                     iso_error *error);
/* Ends the stroke, which becomes one step of the undo history. ISO_ERR_USAGE: no stroke is in progress; or
 * the one that is trims, and outlines nothing: it goes on, and can be cancelled. */
ISO_API iso_status iso_sculpt_end(iso_sculpt *sculpt, iso_error *error);
/* Cancels the stroke: the field is again as it was before it. ISO_ERR_USAGE: no stroke is in progress. */
ISO_API iso_status iso_sculpt_cancel(iso_sculpt *sculpt, iso_error *error);
/* Undoes the last stroke, exactly. ISO_ERR_USAGE: nothing to undo, or a stroke is in progress. */
ISO_API iso_status iso_sculpt_undo(iso_sculpt *sculpt, iso_error *error);
/* Redoes the stroke undone last, exactly. ISO_ERR_USAGE: nothing to redo, or a stroke is in progress. */
ISO_API iso_status iso_sculpt_redo(iso_sculpt *sculpt, iso_error *error);
/* The numbers of strokes and edits that can be undone, and redone. */
ISO_API size_t iso_sculpt_undo_count(iso_sculpt *sculpt);
ISO_API size_t iso_sculpt_redo_count(iso_sculpt *sculpt);
/* A stroke that the field is made of. Strokes are numbered from 1 as they begin, cancelled ones, too. */
typedef struct iso_sculpt_stroke {
    unsigned number;
    bool muted; /* it is left out */
    iso_brush brush;
    size_t samples; /* at least 1 */
} iso_sculpt_stroke;

/* The strokes that the field is made of, in the order in which they are drawn. ISO_ERR_USAGE: there is no
 * such index; or the session was resumed at a snapshot beside its journal, and does not hold the strokes
 * before it (the count is 0, and no stroke can be edited). */
ISO_API size_t iso_sculpt_stroke_count(iso_sculpt *sculpt);
ISO_API iso_status iso_sculpt_get_stroke(iso_sculpt *sculpt, size_t index, iso_sculpt_stroke *stroke,
                                         iso_error *error);
/* Edit past strokes, those with the numbers first to last. The field is afterwards, bit for bit, that of
 * drawing the edited list of strokes anew. An edit is one step of the undo history, and in the journal. The
 * first one draws all strokes once more, later ones those that they can reach. ISO_ERR_USAGE: there is no
 * such stroke, an invalid brush, or a stroke is in progress. If one fails, nothing has changed. */
ISO_API iso_status iso_sculpt_edit(iso_sculpt *sculpt, unsigned number, const iso_brush *brush,
                                   iso_error *error);
ISO_API iso_status iso_sculpt_mute(iso_sculpt *sculpt, unsigned first, unsigned last, bool muted,
                                   iso_error *error);
ISO_API iso_status iso_sculpt_delete(iso_sculpt *sculpt, unsigned first, unsigned last, iso_error *error);
/* The samples of a stroke, which *samples points to until the strokes change, and their number; and as many
 * others for it. ISO_ERR_USAGE: also another number of samples. */
ISO_API iso_status iso_sculpt_get_path(iso_sculpt *sculpt, unsigned number, const iso_sample **samples,
                                       size_t *count, iso_error *error);
ISO_API iso_status iso_sculpt_set_path(iso_sculpt *sculpt, unsigned number, const iso_sample *samples,
                                       size_t count, iso_error *error);
/* Reseats strokes when edits of earlier ones have moved the surface from under them: each sample is moved
 * along its normal by as much as the surface there has moved since the stroke got its samples. The journal
 * gets the places. */
ISO_API iso_status iso_sculpt_reseat(iso_sculpt *sculpt, unsigned first, unsigned last, iso_error *error);
/* `before`: the number of the stroke that they are drawn before; 0: they are drawn last. */
ISO_API iso_status iso_sculpt_move(iso_sculpt *sculpt, unsigned first, unsigned last, unsigned before,
                                   iso_error *error);
/* Sets the stamp: for ISO_SOLID_STAMP the inside of a mesh in an .stl, .obj, .ply, .glb or .3mf file, small
 * holes closed, or for iso_brush.alpha the greys of a .png file (8 or 16 bits; more than 256 pixels along a
 * side are averaged). Its longest side is twice the brush's radius. The journal gets a copy of its distance
 * field or heights. ISO_ERR_IO, ISO_ERR_FORMAT, ISO_ERR_EMPTY (the mesh encloses nothing), ISO_ERR_USAGE (a
 * stroke is in progress). */
ISO_API iso_status iso_sculpt_set_stamp(iso_sculpt *sculpt, const char *path, iso_error *error);
/* Freezes the voxels in the solid that a volume has at an isovalue, as a stroke of its own (MASK_VOXELS),
 * beside those that are frozen already. The journal gets a copy of where they are, so that a replay, also in
 * other voxels, needs no volume; it is the stamp from then on. The volume is borrowed for the call.
 * ISO_ERR_EMPTY: no voxel is; ISO_ERR_USAGE: the isovalue is not finite, or a stroke is in progress;
 * ISO_ERR_NOMEM. */
ISO_API iso_status iso_sculpt_freeze(iso_sculpt *sculpt, iso_volume *volume, double isovalue,
                                     iso_error *error);
/* Returns ISO_OK, or why the journal is incomplete (such as a full disk). Writing is tried again. */
ISO_API iso_status iso_sculpt_journal_status(iso_sculpt *sculpt, iso_error *error);

#ifdef __cplusplus
}
#endif
#endif
