/* path_handles: handles on the path of a stroke, which bend it when they are dragged in the picture. */
#ifndef ISO_APPS_ISOSCULPT_PATH_HANDLES_H
#define ISO_APPS_ISOSCULPT_PATH_HANDLES_H

#include <stdbool.h>
#include <stddef.h>

#include "apps/isosculpt/viewport/viewport.h"
#include "base/c_linkage.h"

ISO_C_BEGIN

/* The largest number of handles; the radius within which the pointer takes one, in pixels at scale 1. */
enum { ISOSCULPT_HANDLES = 9 };
static const double ISOSCULPT_HANDLE_GRIP = 8;

/* Chooses the samples that have a handle: the ends, and others at about equal distances along the path.
 * Returns their number, at least 1. */
int isosculpt_path_handles(const iso_sample *samples, size_t count, size_t at[ISOSCULPT_HANDLES]);

/* Returns the handle at pixel (x, y), the nearest one; -1: there is none. */
int isosculpt_path_handle_at(const isosculpt_pick_buffer *buffer, const iso_sample *samples, size_t count,
                             double x, double y, double scale);

/* A handle that is being dragged. Zero-initialise; isosculpt_bending_free. */
typedef struct isosculpt_bending {
    unsigned number;         /* of the stroke; 0: nothing is being bent */
    iso_sample *from, *bent; /* its samples before, and now; owned */
    size_t count;
    int handle;
    double depth;     /* of the handle, view z in mm: it moves parallel to the picture */
    iso_vec3 pressed; /* where the pointer took it, at that depth */
    bool moved;
} isosculpt_bending;

/* Takes a handle at pixel (x, y). ISO_ERR_NOMEM. */
iso_status isosculpt_bending_begin(isosculpt_bending *bending, const isosculpt_pick_buffer *buffer,
                                   unsigned number, const iso_sample *samples, size_t count, int handle,
                                   double x, double y, iso_error *error);
/* Moves the handle to pixel (x, y): the samples up to the handles beside it follow, the nearer the more. */
void isosculpt_bending_move(isosculpt_bending *bending, const isosculpt_pick_buffer *buffer, double x,
                            double y);
void isosculpt_bending_free(isosculpt_bending *bending);

/* Take a handle of the selected stroke, and release it: the stroke gets the path, or (cancel) keeps its own.
 * Errors are stored in controller->error. */
struct isosculpt_controller;
void isosculpt_bending_take(struct isosculpt_controller *controller, int handle);
void isosculpt_bending_release(struct isosculpt_controller *controller, bool cancel);

ISO_C_END
#endif
