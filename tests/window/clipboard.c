/* clipboard: prints the clipboard's text, which it gets in the way of a program that pastes it: it asks the
 * owner of the CLIPBOARD selection for UTF-8 text (ICCCM, section 2). Exit status 1: there is none. */
#include <stdio.h>
#include <unistd.h>

#include <X11/Xlib.h>

enum { PATIENCE = 100 };

static int print_property(Display *display, Window window, Atom property) {
    Atom type;
    int format;
    unsigned long items, left;
    unsigned char *text = NULL;
    const int got = XGetWindowProperty(display, window, property, 0, 1 << 20, False, AnyPropertyType, &type,
                                       &format, &items, &left, &text);
    if (got != Success || !text) return 1;
    fwrite(text, 1, items, stdout);
    XFree(text);
    return 0;
}

int main(void) {
    alarm(PATIENCE);
    Display *display = XOpenDisplay(NULL);
    if (!display) return 1;
    const Window window = XCreateSimpleWindow(display, DefaultRootWindow(display), 0, 0, 1, 1, 0, 0, 0);
    const Atom property = XInternAtom(display, "ISO_TEST", False);
    XConvertSelection(display, XInternAtom(display, "CLIPBOARD", False),
                      XInternAtom(display, "UTF8_STRING", False), property, window, CurrentTime);
    int code = 1;
    for (XEvent event;;) {
        XNextEvent(display, &event);
        if (event.type != SelectionNotify) continue;
        if (event.xselection.property != None) code = print_property(display, window, property);
        break;
    }
    XCloseDisplay(display);
    return code;
}
