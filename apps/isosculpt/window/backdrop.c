/* Keeps the reference picture beside the strokes: a line of numbers, and the path. */
#include "apps/isosculpt/window/backdrop.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"

static const char MARK[] = "isopoint picture 1\n";

static bool name_file(const window *w, char path[ISOSCULPT_PATH + 16]) {
    snprintf(path, ISOSCULPT_PATH + 16, "%s.picture", w->document.journal);
    return w->document.journal[0] && !w->screen.blank && !w->volume;
}

static void show(window *w, const char *path, bool has_crc, uint32_t crc) {
    isosculpt_backdrop *backdrop = &w->backdrop;
    iso_error reason = {0};
    char text[sizeof w->screen.message];
    if (isosculpt_backdrop_read(backdrop, path, &reason) != ISO_OK)
        snprintf(text, sizeof text, "No reference picture: %.500s", reason.text);
    else if (has_crc && crc != backdrop->crc)
        snprintf(text, sizeof text, "The reference picture has changed since: %.500s", path);
    else
        return;
    isosculpt_window_set_status(w, true, text);
}

/* Reads what isosculpt_window_keep_backdrop has written. */
static void restore(window *w) {
    char name[ISOSCULPT_PATH + 16], mark[sizeof MARK] = "", path[ISOSCULPT_PATH];
    isosculpt_backdrop b = {.shown = false};
    FILE *file;
    int shown;
    if (!name_file(w, name) || iso_file_open(name, &file, NULL, NULL) != ISO_OK) return;
    const bool sound = fread(mark, 1, sizeof MARK - 1, file) == sizeof MARK - 1 && strcmp(mark, MARK) == 0 &&
                       fscanf(file, "%8x %c %lf %lf %lf %lf %lf %d %1023[^\n]", &b.crc, &b.axis, &b.height,
                              &b.opacity, &b.centre.x, &b.centre.y, &b.centre.z, &shown, path) == 9 &&
                       b.axis >= 'x' && b.axis <= 'z' && b.height > 0 && isfinite(b.height) &&
                       b.opacity >= 0 && b.opacity <= 1 && iso_vec3_is_finite(b.centre);
    fclose(file);
    if (!sound) return;
    b.shown = shown != 0;
    w->backdrop = b;
    show(w, path, true, b.crc);
}

void isosculpt_window_adopt_backdrop(window *w) {
    const isosculpt_picture_request *asked = &w->settings->picture;
    if (w->screen.blank || w->volume) return;
    isosculpt_backdrop_free(&w->backdrop);
    w->kept_backdrop[0] = 0;
    if (asked->path[0] && !w->backdrop_asked) {
        char *absolute = realpath(asked->path, NULL); /* as the strokes may be opened from elsewhere */
        w->backdrop = (isosculpt_backdrop){.shown = true,
                                           .axis = asked->axis,
                                           .height = asked->height,
                                           .opacity = 0.6,
                                           .centre = w->controller.brush.mirror};
        show(w, absolute ? absolute : asked->path, false, 0);
        free(absolute);
        w->backdrop_asked = true;
    } else
        restore(w);
    w->viewport.backdrop = &w->backdrop;
    w->viewport.style++;
}

void isosculpt_window_keep_backdrop(window *w) {
    const isosculpt_backdrop *b = &w->backdrop;
    char text[sizeof w->kept_backdrop], name[ISOSCULPT_PATH + 16];
    iso_sink sink;
    if (!b->image.rgba || !name_file(w, name)) return;
    snprintf(text, sizeof text, "%s%08x %c %.17g %.17g %.17g %.17g %.17g %d %s\n", MARK, (unsigned)b->crc,
             b->axis, b->height, b->opacity, b->centre.x, b->centre.y, b->centre.z, b->shown, b->path);
    if (strcmp(text, w->kept_backdrop) == 0) return;
    memcpy(w->kept_backdrop, text, sizeof text);
    if (iso_sink_open_own(name, MARK, sizeof MARK - 1, &sink, NULL) != ISO_OK) return;
    fputs(text, sink.stream);
    iso_sink_commit(&sink, NULL);
}
