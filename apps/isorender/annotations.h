/* annotations: what is drawn over a picture: scale bar, marker, colour bars, legend, --text, --arrow, --ruler
 * and --inset. */
#ifndef ISO_APPS_ISORENDER_ANNOTATIONS_H
#define ISO_APPS_ISORENDER_ANNOTATIONS_H

#include "apps/isorender/settings.h"
#include "scene/picture_file.h"

struct isorender_job;

/* The options --text, --arrow, --ruler, --inset and --legend. ISO_ERR_USAGE. */
iso_status isorender_apply_text(void *settings, const char *value, iso_error *error);
iso_status isorender_apply_arrow(void *settings, const char *value, iso_error *error);
iso_status isorender_apply_ruler(void *settings, const char *value, iso_error *error);
iso_status isorender_apply_inset(void *settings, const char *value, iso_error *error);
iso_status isorender_apply_legend(void *settings, const char *value, iso_error *error);
iso_status isorender_apply_color_bar(void *settings, const char *value, iso_error *error);
/* ISO_ERR_USAGE: an option that does not go with them. */
iso_status isorender_annotations_check(const isorender_settings *settings, iso_error *error);

/* How many times larger the picture is drawn for --inset; 0: there is none. */
int isorender_inset_factor(const isorender_settings *settings);
/* The size of the font in pixels, of --font-size; 0: by the picture's size. */
double isorender_font_pixels(const isorender_settings *settings);

/* Names and colours of a legend. */
typedef struct isorender_legend_list {
    iso_legend_entry entries[256];
    char names[256][96]; /* of the entries */
    int count, more;     /* entries; how many there was no room for */
} isorender_legend_list;

/* What colours stand for which numbers: bars of all that is coloured by numbers, of points, objects and
 * surfaces in this order, up to ISORENDER_BARS. Returns their number. */
enum { ISORENDER_BARS = ISORENDER_OBJECTS + 1 + ISORENDER_COLORINGS + 1 };
int isorender_color_bars(const struct isorender_job *job, iso_color_bar bars[ISORENDER_BARS]);
/* The bars that are drawn, with the titles that --color-bar gives them. ISO_ERR_USAGE: it names another
 * number of them. */
iso_status isorender_titled_bars(const struct isorender_job *job, iso_color_bar bars[ISORENDER_BARS],
                                 int *count, iso_error *error);

/* Draws rows rows[0] .. rows[1] - 1 of the picture of `factor` times as many pixels on each side, without
 * annotations, into `image`, which is created. */
typedef iso_status isorender_enlarged(struct isorender_job *job, int frame, int factor, const int rows[2],
                                      iso_image *image, iso_error *error);

/* Adds what is drawn over a frame, `image`, of which it covers little. enlarge: draws what an inset shows.
 * ISO_ERR_USAGE: --legend names another number of things than there are; ISO_ERR_NOMEM. */
iso_status isorender_annotate(struct isorender_job *job, int frame, const iso_camera *camera,
                              const iso_image *image, isorender_enlarged *enlarge, iso_drawing *drawing,
                              iso_error *error);

#endif
