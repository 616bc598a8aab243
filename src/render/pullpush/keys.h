/* keys: pull-push of points that are not all at hand at once: level 0 of the pyramid is a key image, which
 * is drawn in parts, in any order, and merged by the minimum. Pull and push then run once. The picture has
 * the bytes of iso_draw_pullpush with all points.
 *
 * Before anything is drawn, the parts are surveyed: the levels of the pyramid depend on the sizes of all
 * discs, and whether points that face away are left out depends on the whole surface. Surveys of parts are
 * merged, too. Points have no radii and no colours of their own. */
#ifndef ISO_RENDER_PULLPUSH_KEYS_H
#define ISO_RENDER_PULLPUSH_KEYS_H

#include "render/pullpush/pullpush.h"
#include "render/view/key_image.h"

/* What must be known of all points before some of them are drawn. */
typedef struct iso_pullpush_survey {
    bool closed;         /* all parts are (iso_point_view.closed) */
    float radius[2];     /* smallest and largest projected radius of discs that are seen, pixels */
    double lo[3], hi[3]; /* the box around all points, with the eye at the origin */
} iso_pullpush_survey;

iso_pullpush_survey iso_pullpush_survey_begin(void);

/* Adds a part's points. ISO_ERR_NOMEM. */
iso_status iso_pullpush_survey_add(iso_pullpush_survey *survey, const iso_view *view,
                                   const iso_point_view *points, iso_pool *pool, iso_error *error);
void iso_pullpush_survey_merge(iso_pullpush_survey *survey, const iso_pullpush_survey *other);

/* A survey as numbers, of which merging takes the smaller ones: for reductions over processes. */
enum { ISO_SURVEY_NUMBERS = ISO_KEYS_SURVEY };
void iso_pullpush_survey_put(const iso_pullpush_survey *survey, double numbers[ISO_SURVEY_NUMBERS]);
iso_pullpush_survey iso_pullpush_survey_get(const double numbers[ISO_SURVEY_NUMBERS]);

/* How level 0 is laid out, and which points it shows: the same for all parts. */
typedef struct iso_pullpush_base {
    int32_t base, top;     /* levels: iso_pyramid_layout */
    int32_t width, height; /* of the key image */
    int32_t cull;          /* 1: points that face away are left out */
} iso_pullpush_base;
iso_pullpush_base iso_pullpush_base_of(const iso_pullpush_survey *survey, const iso_view *view);

/* What is drawn, the same for all parts; borrowed. */
typedef struct iso_pullpush_keys {
    const iso_view *view; /* of the whole picture */
    iso_pullpush_base base;
    iso_key_image *keys; /* of base.width x base.height */
    iso_pool *pool;      /* NULL: the calling thread */
} iso_pullpush_keys;

/* Points are projected as keys with a sign; key images have none. Call this before a key image is drawn
 * into, and again when all is drawn. */
void iso_pullpush_flip_keys(iso_key_image *image, iso_pool *pool);

/* Adds a part's points to the keys, which have a sign. `survey`: of the whole. ISO_ERR_NOMEM. */
iso_status iso_pullpush_draw_keys(const iso_pullpush_keys *picture, const iso_pullpush_survey *survey,
                                  const iso_point_view *points, iso_error *error);

/* Draws the surface of keys without a sign into the gbuffer of the target, whose view is the keys' or rows
 * of it. The points' transform and radius are those of every part's view; its points are not used.
 * `reconstruction`: box or Gaussian. ISO_ERR_NOMEM. */
iso_status iso_pullpush_draw_merged(const iso_target *target, const iso_pullpush_keys *picture,
                                    const iso_point_view *points, iso_reconstruction reconstruction,
                                    iso_error *error);

#endif
