/* hand: mouse and keys, made into strokes, camera moves and commands. Knows no window: coordinates are pixels
 * of the picture, keys are names. */
#ifndef ISO_APPS_ISOSCULPT_CONTROLLER_H
#define ISO_APPS_ISOSCULPT_CONTROLLER_H

#include "apps/isosculpt/document.h"
#include "apps/isosculpt/strokes.h"
#include "apps/isosculpt/view/view.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef enum isosculpt_button { ISOSCULPT_LEFT, ISOSCULPT_RIGHT, ISOSCULPT_MIDDLE } isosculpt_button;

enum { ISOSCULPT_SHIFT = 1, ISOSCULPT_CTRL = 2, ISOSCULPT_ALT = 4 };

/* Letters, digits, brackets, + and - are themselves, letters in lower case. */
typedef enum isosculpt_key {
    ISOSCULPT_KEY_FRONT = 256, /* the number pad's 1, 3 and 7; with Ctrl the opposite side */
    ISOSCULPT_KEY_RIGHT,
    ISOSCULPT_KEY_TOP,
    ISOSCULPT_KEY_ESCAPE,
    ISOSCULPT_KEY_ARROW_LEFT, /* the picture moves that way */
    ISOSCULPT_KEY_ARROW_RIGHT,
    ISOSCULPT_KEY_ARROW_UP,
    ISOSCULPT_KEY_ARROW_DOWN
} isosculpt_key;

typedef enum isosculpt_drag {
    ISOSCULPT_DRAG_NONE,
    ISOSCULPT_DRAG_BRUSH,
    ISOSCULPT_DRAG_ORBIT,
    ISOSCULPT_DRAG_PAN
} isosculpt_drag;

/* What needs to be drawn, and what the window must do. */
typedef enum isosculpt_command {
    ISOSCULPT_COMMAND_NONE = 0,
    ISOSCULPT_COMMAND_PICTURE = 1, /* camera or field changed */
    ISOSCULPT_COMMAND_SAVE = 2,
    ISOSCULPT_COMMAND_CLOSE = 4,
    ISOSCULPT_COMMAND_SCULPT = 8,   /* the volume that is only looked at */
    ISOSCULPT_COMMAND_SAVE_AS = 16, /* as SAVE, and the name is asked for */
    ISOSCULPT_COMMAND_OPEN = 32     /* a file that is to be chosen */
} isosculpt_command;

typedef struct isosculpt_controller {
    isosculpt_document *document; /* borrowed */
    isosculpt_view *view;         /* borrowed */
    iso_brush brush;              /* as chosen; modifiers change the tool of one stroke */
    isosculpt_drag drag;
    isosculpt_button button;   /* of the drag */
    char adjusting;            /* 'x' or 'c' while that key is down, 0 else */
    double x, y;               /* of the cursor */
    double pressure;           /* of the pen, 0 .. 1; 1 for a mouse */
    double depth;              /* of the stroke's last pick */
    iso_vec3 normal;           /* likewise */
    iso_sample last;           /* of the stroke, that the session was given */
    iso_tool tool;             /* of the stroke */
    bool viewing_volume;       /* at a volume: there is no field yet that a brush could work on, */
    bool awaiting;             /* but it is being made: strokes wait for it */
    isosculpt_strokes waiting; /* owned */
    iso_box box;            /* of the surface, world, since the last stroke; for showing the mirror's plane */
    bool stroke_unfinished; /* the last stroke still is drawn: there was no memory to end it */
    bool clipped;           /* a brush reached beyond the grid */
    unsigned commands;      /* isosculpt_command, until the window has seen to them */
    isosculpt_latency edit;
    iso_error error; /* of the last stroke, undo or redo; text[0] == 0: none */
} isosculpt_controller;

/* The tool of key 1 .. 9. */
enum { ISOSCULPT_TOOLS = 9 };
iso_tool isosculpt_controller_tool(int number);
/* The tool of a stroke with these modifiers: Shift smooths, Ctrl or Alt inverts. */
iso_tool isosculpt_controller_modified_tool(iso_tool tool, unsigned modifiers);

/* Desk and view are borrowed until the hand is given others. The brush is a new one; its mirror is in the
 * middle of the surface. */
void isosculpt_controller_init(isosculpt_controller *controller, isosculpt_document *document,
                               isosculpt_view *view);
void isosculpt_controller_free(isosculpt_controller *controller);

/* Puts the brush's mirror into the middle of the surface's box: on a voxel or half-way between two, so that
 * mirrored strokes make exactly mirrored voxels. */
void isosculpt_controller_center_mirror(isosculpt_controller *controller);

/* Draws the strokes that waited for the field; frees them. */
void isosculpt_controller_play(isosculpt_controller *controller, isosculpt_strokes *strokes);

void isosculpt_controller_press(isosculpt_controller *controller, isosculpt_button button, unsigned modifiers,
                                double x, double y);
void isosculpt_controller_move(isosculpt_controller *controller, double x, double y);
void isosculpt_controller_release(isosculpt_controller *controller, isosculpt_button button);
void isosculpt_controller_scroll(isosculpt_controller *controller, double steps);
/* `down` false: released. Whether the key means anything. */
bool isosculpt_controller_key(isosculpt_controller *controller, int key, unsigned modifiers, bool down);

/* The side that a view key (ISOSCULPT_KEY_FRONT ..) shows, or the opposite one. */
void isosculpt_controller_look(isosculpt_controller *controller, iso_direction direction);

/* Adds with a stamp from now on; the session takes it over. Not while a stroke is drawn. */
void isosculpt_controller_set_stamp(isosculpt_controller *controller, iso_stamp *stamp);

/* Whether the tool has a shape. */
bool isosculpt_tool_has_shape(iso_tool tool);

/* Undoes or redoes until `position` steps are done. */
void isosculpt_controller_go_to_step(isosculpt_controller *controller, size_t position);

/* Where the brush would touch; false: the cursor is beside the surface, or something is dragged. */
bool isosculpt_controller_pick(const isosculpt_controller *controller, isosculpt_pick *pick);

#ifdef __cplusplus
}
#endif
#endif
