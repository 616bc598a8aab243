/* scene_organs: a torso of labels: ellipsoids, tubes and vertebrae that touch each other. */
#include "grids/scenes/scene_parts.h"

/* In units of the side: x to the left of the patient, y to the back, z up. Later ones replace earlier ones.
 */
typedef struct organ {
    int label;
    double centre[3], radius[3]; /* of an ellipsoid */
} organ;

static const char *const names[] = {"background", "skin",      "right lung", "left lung",    "heart",
                                    "liver",      "stomach",   "spleen",     "right kidney", "left kidney",
                                    "aorta",      "vertebrae", "discs",      "bladder"};

static const organ organs[] = {
    {2, {0.35, 0.50, 0.68}, {0.115, 0.15, 0.19}},  {3, {0.65, 0.50, 0.68}, {0.115, 0.15, 0.19}},
    {4, {0.53, 0.43, 0.61}, {0.085, 0.08, 0.10}},  {5, {0.40, 0.47, 0.43}, {0.20, 0.13, 0.085}},
    {6, {0.62, 0.43, 0.42}, {0.085, 0.075, 0.08}}, {7, {0.715, 0.56, 0.44}, {0.045, 0.06, 0.07}},
    {8, {0.38, 0.60, 0.31}, {0.05, 0.045, 0.08}},  {9, {0.63, 0.60, 0.33}, {0.05, 0.045, 0.08}},
    {13, {0.50, 0.44, 0.15}, {0.075, 0.06, 0.06}},
};

static double square(double x) {
    return x * x;
}

/* The label of a place, in units of the side. */
static int label_at(double x, double y, double z) {
    enum { SKIN = 1, AORTA = 10, VERTEBRA = 11, DISC = 12 };
    const double height = square((z - 0.5) / 0.47), end = height * height * height;
    int label = square((x - 0.5) / 0.37) + square((y - 0.5) / 0.26) < 1 - end ? SKIN : 0;
    for (size_t i = 0; i < sizeof organs / sizeof *organs; i++) {
        const organ *o = &organs[i];
        double sum = 0;
        const double p[3] = {x, y, z};
        for (int k = 0; k < 3; k++) sum += square((p[k] - o->centre[k]) / o->radius[k]);
        if (sum < 1) label = o->label;
    }
    if (z > 0.18 && z < 0.64 && square(x - 0.52) + square(y - 0.56) < square(0.016)) label = AORTA;
    const double turned = 15 * z, part = turned - (int)turned;
    if (z > 0.08 && z < 0.92 && square(x - 0.5) + square(y - 0.645) < square(part < 0.72 ? 0.05 : 0.042))
        label = part < 0.72 ? VERTEBRA : DISC;
    return label;
}

typedef struct filling {
    int size;
    uint8_t *voxels;
} filling;

static void fill_slice(void *context, size_t z, int worker) {
    (void)worker;
    const filling *f = context;
    uint8_t *out = f->voxels + z * (size_t)f->size * (size_t)f->size;
    for (int y = 0; y < f->size; y++)
        for (int x = 0; x < f->size; x++)
            *out++ = (uint8_t)label_at((x + 0.5) / f->size, (y + 0.5) / f->size, ((double)z + 0.5) / f->size);
}

iso_status iso_scene_organs(const iso_scene_opts *opts, iso_grid *grid, iso_error *error) {
    const iso_rgrid_desc desc = {.dims = {opts->size, opts->size, opts->size}, .type = ISO_UINT8};
    ISO_TRY(iso_rgrid_create(&desc, &grid->rgrid, error));
    filling f = {opts->size, grid->rgrid->data};
    iso_parallel_for(opts->pool, (size_t)opts->size, fill_slice, &f);
    return ISO_OK;
}

const char *iso_scene_organ_name(int label) {
    return label > 0 && label < (int)(sizeof names / sizeof *names) ? names[label] : NULL;
}
