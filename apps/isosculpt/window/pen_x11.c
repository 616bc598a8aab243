/* The state of pens is asked for when a sample is taken, instead of listening to their events, which are
 * GLFW's to read. */
#define _GNU_SOURCE /* RTLD_DEFAULT */
#include <dlfcn.h>
#include <stdlib.h>
#include <string.h>

#include <X11/Xlib.h>
#include <X11/extensions/XInput2.h>

#include "apps/isosculpt/window/pen.h"

struct isosculpt_pen {
    Display *display; /* GLFW's */
    Atom pressure;
    bool present;
};

/* A GLFW that was built for Wayland has no such function. */
static Display *display_of_glfw(void) {
    Display *(*get)(void);
    void *symbol = dlsym(RTLD_DEFAULT, "glfwGetX11Display");
    if (!symbol) return NULL;
    memcpy(&get, &symbol, sizeof get);
    return get();
}

isosculpt_pen *isosculpt_pen_open(void) {
    int opcode, event, error, major = 2, minor = 0;
    Display *display = display_of_glfw();
    if (!display || !XQueryExtension(display, "XInputExtension", &opcode, &event, &error)) return NULL;
    if (XIQueryVersion(display, &major, &minor) != Success) return NULL;
    isosculpt_pen *pen = calloc(1, sizeof *pen);
    if (!pen) return NULL;
    pen->display = display;
    pen->pressure = XInternAtom(display, "Abs Pressure", False);
    isosculpt_pen_pressure(pen);
    return pen;
}

void isosculpt_pen_close(isosculpt_pen *pen) {
    free(pen);
}

bool isosculpt_pen_present(const isosculpt_pen *pen) {
    return pen && pen->present;
}

/* The pressure axis of a device; NULL: it has none. */
static const XIValuatorClassInfo *axis_of(const isosculpt_pen *pen, const XIDeviceInfo *device) {
    for (int i = 0; device->use == XISlavePointer && i < device->num_classes; i++) {
        const XIValuatorClassInfo *axis = (const XIValuatorClassInfo *)device->classes[i];
        if (axis->type == XIValuatorClass && axis->label == pen->pressure && axis->max > axis->min)
            return axis;
    }
    return NULL;
}

/* All devices are asked: asking for one by the number of one that is gone is an error that ends a program. */
double isosculpt_pen_pressure(isosculpt_pen *pen) {
    double most = 0;
    int count = 0;
    if (!pen) return 1;
    XIDeviceInfo *devices = XIQueryDevice(pen->display, XIAllDevices, &count);
    pen->present = false;
    for (int i = 0; devices && i < count; i++) {
        const XIValuatorClassInfo *axis = axis_of(pen, &devices[i]);
        if (!axis) continue;
        double pressure = (axis->value - axis->min) / (axis->max - axis->min);
        most = pressure > most ? pressure : most;
        pen->present = true;
    }
    if (devices) XIFreeDeviceInfo(devices);
    return most > 0 && most < 1 ? most : 1;
}
