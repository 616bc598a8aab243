/* hand: mouse and keys, made into strokes, camera moves and commands. Knows no window: coordinates are pixels
 * of the picture, keys are names. */
#ifndef ISO_APPS_ISOSCULPT_HAND_H
#define ISO_APPS_ISOSCULPT_HAND_H

#include "apps/isosculpt/desk.h"
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
typedef enum isosculpt_wish {
    ISOSCULPT_WISH_NONE = 0,
    ISOSCULPT_WISH_PICTURE = 1, /* camera or field changed */
    ISOSCULPT_WISH_SAVE = 2,
    ISOSCULPT_WISH_CLOSE = 4,
    ISOSCULPT_WISH_SCULPT = 8,   /* the volume that is only looked at */
    ISOSCULPT_WISH_SAVE_AS = 16, /* as SAVE, and the name is asked for */
    ISOSCULPT_WISH_OPEN = 32     /* a file that is to be chosen */
} isosculpt_wish;

typedef struct isosculpt_hand {
    isosculpt_desk *desk; /* borrowed */
    isosculpt_view *view; /* borrowed */
    iso_brush brush;      /* as chosen; modifiers change the tool of one stroke */
    isosculpt_drag drag;
    isosculpt_button button;   /* of the drag */
    char adjusting;            /* 'x' or 'c' while that key is down, 0 else */
    double x, y;               /* of the cursor */
    double pressure;           /* of the pen, 0 .. 1; 1 for a mouse */
    double depth;              /* of the stroke's last pick */
    iso_vec3 normal;           /* likewise */
    iso_sample last;           /* of the stroke, that the session was given */
    iso_tool tool;             /* of the stroke */
    bool looking;              /* at a volume: there is no field yet that a brush could work on, */
    bool awaiting;             /* but it is being made: strokes wait for it */
    isosculpt_strokes waiting; /* owned */
    iso_box box;     /* of the surface, world, since the last stroke; for showing the mirror's plane */
    bool unended;    /* the last stroke still is drawn: there was no memory to end it */
    bool clipped;    /* a brush reached beyond the grid */
    unsigned wishes; /* isosculpt_wish, until the window has seen to them */
    isosculpt_latency edit;
    iso_error error; /* of the last stroke, undo or redo; text[0] == 0: none */
} isosculpt_hand;

/* The tool of key 1 .. 9. */
enum { ISOSCULPT_TOOLS = 9 };
iso_tool isosculpt_hand_tool(int number);
/* The tool of a stroke with these modifiers: Shift smooths, Ctrl or Alt inverts. */
iso_tool isosculpt_hand_modified(iso_tool tool, unsigned modifiers);

/* Desk and view are borrowed until the hand is given others. The brush is a new one; its mirror is in the
 * middle of the surface. */
void isosculpt_hand_init(isosculpt_hand *hand, isosculpt_desk *desk, isosculpt_view *view);
void isosculpt_hand_free(isosculpt_hand *hand);

/* Puts the brush's mirror into the middle of the surface's box: on a voxel or half-way between two, so that
 * mirrored strokes make exactly mirrored voxels. */
void isosculpt_hand_center_mirror(isosculpt_hand *hand);

/* Draws the strokes that waited for the field; frees them. */
void isosculpt_hand_play(isosculpt_hand *hand, isosculpt_strokes *strokes);

void isosculpt_hand_press(isosculpt_hand *hand, isosculpt_button button, unsigned modifiers, double x,
                          double y);
void isosculpt_hand_move(isosculpt_hand *hand, double x, double y);
void isosculpt_hand_release(isosculpt_hand *hand, isosculpt_button button);
void isosculpt_hand_scroll(isosculpt_hand *hand, double steps);
/* `down` false: released. Whether the key means anything. */
bool isosculpt_hand_key(isosculpt_hand *hand, int key, unsigned modifiers, bool down);

/* The side that a view key (ISOSCULPT_KEY_FRONT ..) shows, or the opposite one. */
void isosculpt_hand_look(isosculpt_hand *hand, iso_direction direction);

/* Adds with a stamp from now on; the session takes it over. Not while a stroke is drawn. */
void isosculpt_hand_stamp(isosculpt_hand *hand, iso_stamp *stamp);

/* Whether the tool has a shape. */
bool isosculpt_hand_has_shape(iso_tool tool);

/* Undoes or redoes until `position` steps are done. */
void isosculpt_hand_history(isosculpt_hand *hand, size_t position);

/* Where the brush would touch; false: the cursor is beside the surface, or something is dragged. */
bool isosculpt_hand_under(const isosculpt_hand *hand, isosculpt_pick *pick);

#ifdef __cplusplus
}
#endif
#endif
