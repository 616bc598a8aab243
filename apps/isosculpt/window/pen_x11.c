/* Pen pressure on X11: the state of all devices is queried when a sample is taken. Their events are not read,
 * since GLFW reads the event queue. */
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

/* Returns NULL for a GLFW that was built for Wayland, because it lacks the function. */
static Display *find_display(void) {
    Display *(*get)(void);
    void *symbol = dlsym(RTLD_DEFAULT, "glfwGetX11Display");
    if (!symbol) return NULL;
    memcpy(&get, &symbol, sizeof get);
    return get();
}

isosculpt_pen *isosculpt_pen_open(void) {
    int opcode, event, error, major = 2, minor = 0;
    Display *display = find_display();
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

/* Returns the pressure axis of a device; NULL: it has none. */
static const XIValuatorClassInfo *find_pressure_axis(const isosculpt_pen *pen, const XIDeviceInfo *device) {
    for (int i = 0; device->use == XISlavePointer && i < device->num_classes; i++) {
        const XIValuatorClassInfo *axis = (const XIValuatorClassInfo *)device->classes[i];
        if (axis->type == XIValuatorClass && axis->label == pen->pressure && axis->max > axis->min)
            return axis;
    }
    return NULL;
}

/* Queries all devices, because querying a single device that was unplugged is an X error, which ends the
 * program. */
double isosculpt_pen_pressure(isosculpt_pen *pen) {
    double most = 0;
    int count = 0;
    if (!pen) return 1;
    XIDeviceInfo *devices = XIQueryDevice(pen->display, XIAllDevices, &count);
    pen->present = false;
    for (int i = 0; devices && i < count; i++) {
        const XIValuatorClassInfo *axis = find_pressure_axis(pen, &devices[i]);
        if (!axis) continue;
        double pressure = (axis->value - axis->min) / (axis->max - axis->min);
        most = pressure > most ? pressure : most;
        pen->present = true;
    }
    if (devices) XIFreeDeviceInfo(devices);
    return most > 0 && most < 1 ? most : 1;
}
