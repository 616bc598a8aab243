/* input_controller: turns mouse and keyboard input into strokes, camera moves and commands for the window.
 * Independent of the window system: positions are pixels of the picture, y down; keys are numbers of
 * isosculpt_key. */
#ifndef ISO_APPS_ISOSCULPT_INPUT_CONTROLLER_H
#define ISO_APPS_ISOSCULPT_INPUT_CONTROLLER_H

#include "apps/isosculpt/document.h"
#include "apps/isosculpt/measuring.h"
#include "apps/isosculpt/path_handles.h"
#include "apps/isosculpt/recorded_strokes.h"
#include "apps/isosculpt/viewport/viewport.h"
#include "base/c_linkage.h"

ISO_C_BEGIN

typedef enum isosculpt_button {
    ISOSCULPT_BUTTON_LEFT,
    ISOSCULPT_BUTTON_RIGHT,
    ISOSCULPT_BUTTON_MIDDLE
} isosculpt_button;

enum { ISOSCULPT_MODIFIER_SHIFT = 1, ISOSCULPT_MODIFIER_CTRL = 2, ISOSCULPT_MODIFIER_ALT = 4 };

/* Letters (lower case), digits, brackets, comma, full stop, + and - are their own numbers. */
typedef enum isosculpt_key {
    ISOSCULPT_KEY_FRONT = 256, /* 1, 3 and 7 of the number pad; with Ctrl the opposite side */
    ISOSCULPT_KEY_RIGHT,
    ISOSCULPT_KEY_TOP,
    ISOSCULPT_KEY_ESCAPE,
    ISOSCULPT_KEY_DELETE,     /* deletes the selected strokes */
    ISOSCULPT_KEY_ARROW_LEFT, /* the picture moves to the left */
    ISOSCULPT_KEY_ARROW_RIGHT,
    ISOSCULPT_KEY_ARROW_UP,
    ISOSCULPT_KEY_ARROW_DOWN
} isosculpt_key;

typedef enum isosculpt_drag {
    ISOSCULPT_DRAG_NONE,
    ISOSCULPT_DRAG_BRUSH,
    ISOSCULPT_DRAG_ORBIT,
    ISOSCULPT_DRAG_PAN,
    ISOSCULPT_DRAG_PLANE,   /* moves the plane that cuts (viewport/cut.h) */
    ISOSCULPT_DRAG_TILT,    /* tilts it */
    ISOSCULPT_DRAG_SELECT,  /* Alt on the surface: a stroke when the pointer moves, else selects one */
    ISOSCULPT_DRAG_OUTLINE, /* outlines what a tool that trims removes */
    ISOSCULPT_DRAG_HANDLE   /* bends the path of the selected stroke */
} isosculpt_drag;

/* Commands for the window, as bits of isosculpt_controller.commands. */
typedef enum isosculpt_command {
    ISOSCULPT_COMMAND_NONE = 0,
    ISOSCULPT_COMMAND_REDRAW = 1, /* camera or field changed */
    ISOSCULPT_COMMAND_SAVE = 2,
    ISOSCULPT_COMMAND_CLOSE = 4,
    ISOSCULPT_COMMAND_SCULPT = 8,   /* convert the viewed volume into a field */
    ISOSCULPT_COMMAND_SAVE_AS = 16, /* save to a name that the user chooses */
    ISOSCULPT_COMMAND_OPEN = 32,    /* open a file that the user chooses */
    ISOSCULPT_COMMAND_NEW = 64      /* begin with a solid that the user chooses */
} isosculpt_command;

/* The path of the pointer while it outlines what is removed, in pixels of the picture. */
enum { ISOSCULPT_OUTLINE_POINTS = 1024 };
typedef struct isosculpt_outline {
    double at[ISOSCULPT_OUTLINE_POINTS][2];
    int count;
} isosculpt_outline;

typedef struct isosculpt_controller {
    isosculpt_document *document; /* borrowed */
    isosculpt_viewport *viewport; /* borrowed */
    iso_brush brush;              /* as chosen; modifier keys change the tool for one stroke */
    isosculpt_drag drag;
    isosculpt_button button; /* the button that is held during a drag */
    char adjusting;          /* 'x' (size) or 'c' (strength) while that key is down, else 0 */
    double x, y;             /* of the pointer */
    double scale;            /* of the handle of the plane that cuts; pixels to one at scale 1 */
    double pressure;         /* of the pen, 0 .. 1; 1 for a mouse */

    double depth;           /* of the last pick of the stroke, view z in mm */
    iso_vec3 normal;        /* of the same pick, world */
    iso_sample last_sample; /* of the stroke, as the session got it */
    iso_tool tool;          /* of the stroke */

    double press_x, press_y; /* ISOSCULPT_DRAG_SELECT: where it began, and with which modifier keys */
    unsigned press_modifiers;
    isosculpt_outline outline; /* ISOSCULPT_DRAG_OUTLINE */
    isosculpt_bending bending; /* ISOSCULPT_DRAG_HANDLE */
    isosculpt_measuring measuring;
    bool brush_held; /* the panel's brush is being changed: a stroke gets it when this is over */

    bool viewing_volume; /* a volume is shown: there is no field that a brush could change */
    bool field_pending;  /* the volume is to become a field, or becomes one: strokes are queued until then */
    isosculpt_strokes queued_strokes; /* owned */
    bool queueing; /* the stroke that is drawn is queued: there is no field, or past ones are edited */

    iso_box surface_box;    /* world box of the surface after the last stroke; the mirror planes are drawn as
                               large as it */
    bool stroke_unfinished; /* the last stroke could not be ended: there was no memory */
    bool edited;            /* the field was changed; the window clears this when it has said what it says */
    bool emptied;           /* the last stroke has removed all that there was */
    bool clipped;           /* a brush reached beyond the grid, and what it made there is lost */
    unsigned commands;      /* isosculpt_command bits; the window clears those that it has carried out */
    isosculpt_latency edit; /* times of touches */
    iso_error error;        /* error of the last stroke, undo or redo; text[0] == 0: none */
} isosculpt_controller;

/* The tools that keys and buttons choose, and the key of each; number: 0 .. ISOSCULPT_TOOLS - 1. */
enum { ISOSCULPT_TOOLS = 17 };
iso_tool isosculpt_controller_tool(int number);
char isosculpt_controller_tool_key(int number);
/* Returns the tool of a stroke with modifier keys: Shift smooths, Ctrl or Alt inverts. */
iso_tool isosculpt_controller_modified_tool(iso_tool tool, unsigned modifiers);

/* Starts with a new brush, whose mirror is in the middle of the surface. `document` and `viewport` are
 * borrowed until isosculpt_controller_free. */
void isosculpt_controller_init(isosculpt_controller *controller, isosculpt_document *document,
                               isosculpt_viewport *viewport);
void isosculpt_controller_free(isosculpt_controller *controller);

/* The brush that the panel shows and changes: that of the stroke that is selected, or else the next one's. */
iso_brush *isosculpt_controller_brush(isosculpt_controller *controller);

/* Makes the edits of strokes that are requested (document->strokes) in the background, and then draws the
 * strokes that were made meanwhile. Called often; `wake`: see isosculpt_task_start. Errors are stored in
 * controller->error. */
void isosculpt_controller_update_strokes(isosculpt_controller *controller, void (*wake)(void));

/* Moves the brush's mirror planes to the middle of the surface's box, rounded to a voxel or half-way between
 * two, so that mirrored strokes make exactly mirrored voxels. */
void isosculpt_controller_center_mirror(isosculpt_controller *controller);

/* Cancels waiting for a field: drops the queued strokes and the stroke that is being drawn. */
void isosculpt_controller_drop_strokes(isosculpt_controller *controller);
/* Applies the strokes that were queued before there was a field, and frees them. Errors are stored in
 * controller->error. */
void isosculpt_controller_apply_strokes(isosculpt_controller *controller, isosculpt_strokes *strokes);

void isosculpt_controller_press(isosculpt_controller *controller, isosculpt_button button, unsigned modifiers,
                                double x, double y);
void isosculpt_controller_move(isosculpt_controller *controller, double x, double y);
void isosculpt_controller_release(isosculpt_controller *controller, isosculpt_button button);
void isosculpt_controller_scroll(isosculpt_controller *controller, double steps);
/* A key was pressed (`down`) or released. Returns whether the key has a meaning. */
bool isosculpt_controller_key(isosculpt_controller *controller, int key, unsigned modifiers, bool down);

/* Shows the surface from a side. Does nothing during a stroke. */
void isosculpt_controller_set_direction(isosculpt_controller *controller, iso_direction direction);

/* The radii of brushes that the window offers, in voxels: the slider, keys and drags alike. What a brush of
 * less changes cannot be seen, with one of more a touch takes longer than a frame. Stroke files and the C
 * interface may go further: ISO_LIMIT_RADIUS of sculpt/limits.h bounds every brush. */
enum { ISOSCULPT_RADIUS_LEAST = 2, ISOSCULPT_RADIUS_MOST = 256 };
/* Sets the radius of the brush in mm, within these bounds. */
void isosculpt_controller_set_radius(isosculpt_controller *controller, double radius);

/* Whether strokes with the tool can have a colour (iso_brush.has_color); painting always has one. */
bool isosculpt_tool_has_color(iso_tool tool);
/* Takes the brush's colour from the surface under the pointer, if it is over one. */
void isosculpt_controller_pick_color(isosculpt_controller *controller);
/* Changes the whole mask as a stroke of its own: ISO_TOOL_CLEAR_MASK to ISO_TOOL_BLUR_MASK, this one over
 * the brush's radius. Does nothing
 * while the pointer is dragged, while a volume is shown, or while strokes are being edited. */
void isosculpt_controller_change_mask(isosculpt_controller *controller, iso_tool tool);

/* Measures the solid (controller->measuring.solid). Not while a stroke is drawn. Errors are stored in
 * controller->error. */
void isosculpt_controller_measure_solid(isosculpt_controller *controller);

/* Makes a stamp the shape of the brush; the session takes it over. Not during a stroke. */
void isosculpt_controller_set_stamp(isosculpt_controller *controller, iso_stamp *stamp);

/* Whether the tool adds or removes a solid whose shape can be chosen. */
bool isosculpt_tool_has_shape(iso_tool tool);
/* Whether the strength of the brush acts on the tool. For tools with a shape it is how far the solid extends
 * beyond the surface, in radii. */
bool isosculpt_tool_has_strength(iso_tool tool);

/* Undoes or redoes until `position` steps of the history are done. */
void isosculpt_controller_go_to_step(isosculpt_controller *controller, size_t position);

/* The part of the handle of the plane that cuts that is under the pointer, or is dragged. */
isosculpt_cut_part isosculpt_controller_handle(const isosculpt_controller *controller);
/* Whether it matters where the samples of the tool's strokes are. */
static inline bool isosculpt_tool_has_path(iso_tool tool) {
    return tool < ISO_TOOL_CLEAR_MASK || tool > ISO_TOOL_MASK_VOXELS;
}
/* The samples of a stroke of the list as they are to be drawn, as many as it has: bent while a handle is
 * dragged, and as they are requested. */
const iso_sample *isosculpt_controller_path(const isosculpt_controller *controller, const iso_stroke *stroke);
/* The handle of the selected stroke's path (path_handles.h) that is under the pointer, or is dragged; -1:
 * none. */
int isosculpt_controller_path_handle(isosculpt_controller *controller);
/* Whether a stroke, an outline or a path is being drawn, which Escape cancels. */
bool isosculpt_controller_is_drawing(const isosculpt_controller *controller);
/* The surface under the pointer; false: there is none, or the camera or the plane that cuts is being moved,
 * or a handle is there. */
bool isosculpt_controller_pick(isosculpt_controller *controller, isosculpt_pick *pick);

ISO_C_END
#endif
