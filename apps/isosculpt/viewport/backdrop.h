/* backdrop: a reference picture that stands on a plane across an axis of the world, and is seen wherever the
 * picture shows no surface: behind the sculpture, whatever the side. */
#ifndef ISO_APPS_ISOSCULPT_VIEWPORT_BACKDROP_H
#define ISO_APPS_ISOSCULPT_VIEWPORT_BACKDROP_H

#include "apps/isosculpt/viewport/damage.h"
#include "apps/isosculpt/viewport/shading.h"
#include "base/c_linkage.h"
#include "base/parallel.h"

ISO_C_BEGIN

/* Zero-initialise; isosculpt_backdrop_free. */
typedef struct isosculpt_backdrop {
    iso_image image; /* owned; rgba == NULL: there is none */
    char path[1024]; /* of its file */
    uint32_t crc;    /* CRC-32C of the pixels */
    bool shown;
    char axis;       /* 'x', 'y' or 'z': as seen from the right, the front or the top */
    double height;   /* mm */
    double opacity;  /* 0 .. 1 */
    iso_vec3 centre; /* world, mm */
} isosculpt_backdrop;

/* Reads the picture of a PNG or JPEG file; the other members stay as they are. Errors: those of
 * iso_image_read; then there is none. */
iso_status isosculpt_backdrop_read(isosculpt_backdrop *backdrop, const char *path, iso_error *error);
void isosculpt_backdrop_free(isosculpt_backdrop *backdrop);

/* Whether there is one, and it is shown. */
bool isosculpt_backdrop_is_shown(const isosculpt_backdrop *backdrop);

/* Lays it over the pixels of `image`, of which each has factor x factor samples of `gbuffer`, by the share of
 * the samples without a surface, whose colour is `background`. `view`: of the samples, without gaps between
 * rows. `backdrop` may be NULL. */
void isosculpt_backdrop_blend(const isosculpt_backdrop *backdrop, const iso_view *view,
                              const iso_gbuffer *gbuffer, int factor, iso_rgb background, iso_image *image,
                              iso_pool *pool);

ISO_C_END
#endif
