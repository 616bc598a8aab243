/* layer_lists: adds the layers of one surface of points to the lists of a band. Internal to groups. */
#ifndef ISO_RENDER_GROUPS_LAYER_LISTS_H
#define ISO_RENDER_GROUPS_LAYER_LISTS_H

#include "render/glass/glass.h"
#include "render/groups/disc_layers.h"
#include "render/groups/slots.h"
#include "render/layers/opacity.h"

/* A surface while a strip is drawn. */
typedef struct iso_splat_surface {
    const iso_splat_layer *input;
    int number;
    iso_banded_discs discs; /* sorted front to back */
    iso_banded_discs wide;  /* for the modes groups and nearest: enlarged discs, so that each group covers the
                        surface; back to front */
    iso_layer_opacity opacity;
    float bin;    /* mm: width of the bins of depth */
    bool normals; /* layers are listed with their normals instead of colours, and hide nothing; in the mode
                     nearest those behind the first one have no normals */
} iso_splat_surface;

/* Projects the points of a surface into `view`, and assigns their discs to bands of `band_rows` rows. With
 * `sorted`, `wide` stays empty. Free with iso_groups_end_surface, also after errors. ISO_ERR_NOMEM;
 * ISO_ERR_LIMIT: 2^32 - 1 points or more. */
iso_status iso_groups_start_surface(const iso_splat_layer *input, const iso_view *view, bool sorted,
                                    int band_rows, iso_pool *pool, iso_splat_surface *surface,
                                    iso_error *error);
void iso_groups_end_surface(iso_splat_surface *surface);

/* The rows to list, and the memory of a worker. */
typedef struct iso_splat_band {
    size_t number; /* of the band */
    iso_rows rows; /* of the band or a part of it */
    int width;     /* samples */
    iso_layer_lists *lists;
    iso_buffer *memory, *starts; /* of the worker; they contain old data */
    bool last;                   /* the rows cannot be divided further */
} iso_splat_band;

/* Lists the layers of a surface whose pass has begun. Returns false if memory runs out or lists->full is
 * set. */
bool iso_groups_list_sorted(const iso_splat_surface *surface, const iso_splat_band *band);
/* Lists one layer by algorithm 2, or two layers by algorithm 3. Returns false in the same cases. */
bool iso_groups_list_images(const iso_splat_surface *surface, const iso_splat_band *band, bool nearest);

/* Stores the crossings of the listed rows in the rows of a map from `first` on, from layers with normals. */
void iso_groups_read_crossings(const iso_layer_lists *lists, int first, const iso_glass_map *map);

/* Returns a fragment for a single disc at its centre. */
iso_fragment iso_splat_fragment(const iso_splat_surface *surface, const iso_disc *disc);
/* Returns a fragment for a layer of averaged discs. away: they are back-facing. */
iso_fragment iso_splat_mean_fragment(const iso_splat_surface *surface, const iso_splat_sums *sums, bool away,
                                     float x, float y);

#endif
