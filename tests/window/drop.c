/* drop: drops files on a window like a file manager, as a source of the XDND protocol, version 5
 * (https://www.freedesktop.org/wiki/Specifications/XDND/). Usage: drop WINDOW X Y FILE ..., with the pointer
 * at X, Y of the screen. Exit status 0: the window accepted them; 2: it refused, or did not answer in time.
 */
#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <X11/Xatom.h>
#include <X11/Xlib.h>

enum { PATIENCE = 100, VERSION = 5 };

typedef struct source {
    Display *display;
    Window own, target;
    Atom selection, list;
    char text[1 << 16]; /* text/uri-list */
    size_t length;
} source;

static Atom atom(const source *s, const char *name) {
    return XInternAtom(s->display, name, False);
}

/* Adds a file to the list of URIs, percent-encoded except for letters, digits and a few other characters. */
static void add_file(source *s, const char *path) {
    const size_t room = sizeof s->text;
    s->length += (size_t)snprintf(s->text + s->length, room - s->length, "file://");
    for (const char *c = path; *c && s->length + 8 < room; c++) {
        const char *format = isalnum((unsigned char)*c) || strchr("/._-", *c) ? "%c" : "%%%02X";
        s->length += (size_t)snprintf(s->text + s->length, room - s->length, format, (unsigned char)*c);
    }
    s->length += (size_t)snprintf(s->text + s->length, room - s->length, "\r\n");
}

static void send(const source *s, const char *type, const long data[5]) {
    XClientMessageEvent message = {.type = ClientMessage,
                                   .display = s->display,
                                   .window = s->target,
                                   .message_type = atom(s, type),
                                   .format = 32};
    for (int i = 0; i < 5; i++) message.data.l[i] = data[i];
    XSendEvent(s->display, s->target, False, NoEventMask, (XEvent *)&message);
    XFlush(s->display);
}

static void serve(const source *s, const XSelectionRequestEvent *request) {
    XSelectionEvent answer = {.type = SelectionNotify,
                              .display = request->display,
                              .requestor = request->requestor,
                              .selection = request->selection,
                              .target = request->target,
                              .time = request->time};
    if (request->target == s->list) {
        answer.property = request->property;
        XChangeProperty(s->display, request->requestor, request->property, s->list, 8, PropModeReplace,
                        (const unsigned char *)s->text, (int)s->length);
    }
    XSendEvent(s->display, request->requestor, False, NoEventMask, (XEvent *)&answer);
    XFlush(s->display);
}

/* Serves the selection until the target sends a message of this type, and returns that message. */
static XClientMessageEvent wait_for(const source *s, const char *type) {
    const Atom wanted = atom(s, type);
    for (XEvent event;;) {
        XNextEvent(s->display, &event);
        if (event.type == SelectionRequest) serve(s, &event.xselectionrequest);
        if (event.type == ClientMessage && event.xclient.message_type == wanted) return event.xclient;
    }
}

static int drop(const source *s, long x, long y) {
    const long own = (long)s->own, enter[5] = {own, (long)VERSION << 24, (long)s->list},
               position[5] = {own, 0, x << 16 | y, CurrentTime, (long)atom(s, "XdndActionCopy")},
               let_go[5] = {own, 0, CurrentTime}, leave[5] = {own};
    send(s, "XdndEnter", enter);
    send(s, "XdndPosition", position);
    if (!(wait_for(s, "XdndStatus").data.l[1] & 1)) {
        send(s, "XdndLeave", leave);
        return 2;
    }
    send(s, "XdndDrop", let_go);
    return wait_for(s, "XdndFinished").data.l[1] ? 0 : 2; /* (GLFW 3.3 sends a length instead of the flag) */
}

int main(int argc, char **argv) {
    static source s;
    if (argc < 5) return 1;
    alarm(PATIENCE);
    s.display = XOpenDisplay(NULL);
    if (!s.display) return 1;
    s.target = strtoul(argv[1], NULL, 0);
    s.own = XCreateSimpleWindow(s.display, DefaultRootWindow(s.display), 0, 0, 1, 1, 0, 0, 0);
    s.selection = atom(&s, "XdndSelection");
    s.list = atom(&s, "text/uri-list");
    for (int i = 4; i < argc; i++) add_file(&s, argv[i]);
    XSetSelectionOwner(s.display, s.selection, s.own, CurrentTime);
    const int code = drop(&s, strtol(argv[2], NULL, 10), strtol(argv[3], NULL, 10));
    XCloseDisplay(s.display);
    return code;
}
