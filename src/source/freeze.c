/* Freezes what a volume has, sampled at the voxels of a field. */
#include "source/source.h"

#include <math.h>

#include "base/parallel.h"

typedef struct sampling {
    const iso_grid *volume;
    double stored; /* isovalue; NAN: labels */
    int own;
    iso_affine to_world, from_world; /* of the set's voxels, and of the volume */
    iso_voxel_set set;
} sampling;

static bool is_frozen(const sampling *s, iso_vec3 index) {
    const int *dims = iso_grid_dims(s->volume);
    const double at[] = {index.x, index.y, index.z};
    for (int axis = 0; axis < 3; axis++)
        if (!(at[axis] >= -0.5 && at[axis] <= dims[axis] - 0.5)) return false;
    if (!isnan(s->stored)) {
        const double value = iso_grid_sample(s->volume, index);
        return iso_grid_is_level_set(s->volume) ? value < s->stored : value >= s->stored;
    }
    const double label = (double)iso_grid_at(s->volume, (int)floor(index.x + 0.5), (int)floor(index.y + 0.5),
                                             (int)floor(index.z + 0.5));
    return label != 0 && label != s->own;
}

/* Samples the 64 voxels of a word of the set. */
static uint64_t sample_word(const sampling *s, size_t word) {
    const size_t count = iso_voxel_set_count(&s->set), nx = (size_t)s->set.dims[0],
                 ny = (size_t)s->set.dims[1];
    uint64_t bits = 0;
    for (size_t i = 64 * word; i < 64 * (word + 1) && i < count; i++) {
        const iso_vec3 voxel = {(double)(i % nx), (double)(i / nx % ny), (double)(i / nx / ny)};
        const iso_vec3 world = iso_affine_point(&s->to_world, voxel);
        if (is_frozen(s, iso_affine_point_to_index(&s->from_world, world))) bits |= (uint64_t)1 << i % 64;
    }
    return bits;
}

static size_t words_of(const iso_voxel_set *set) {
    return (iso_voxel_set_count(set) + 63) / 64;
}

/* iso_task: so many words. */
enum { WORDS = 256 };
static void sample_words(void *context, size_t part, int worker) {
    sampling *s = context;
    const size_t words = words_of(&s->set);
    (void)worker;
    for (size_t i = part * WORDS; i < (part + 1) * WORDS && i < words; i++)
        s->set.word[i] = sample_word(s, i);
}

/* Chooses the voxels of the set: those of the field or, if these are too many, of the smallest multiple of
 * their size. */
static void choose_frame(const iso_hgrid *field, sampling *s) {
    iso_transform frame = field->transform;
    int factor = 0;
    do {
        factor++;
        for (int axis = 0; axis < 3; axis++) s->set.dims[axis] = (field->dims[axis] + factor - 1) / factor;
    } while (iso_voxel_set_count(&s->set) > ISO_VOXEL_SET_MOST);
    const double middle = 0.5 * (factor - 1);
    const iso_affine fine = iso_transform_affine(&field->transform);
    s->set.origin = iso_affine_point(&fine, iso_vec3_make(middle, middle, middle));
    s->set.spacing = factor * field->transform.spacing[0];
    const double origin[] = {s->set.origin.x, s->set.origin.y, s->set.origin.z};
    for (int axis = 0; axis < 3; axis++) {
        frame.origin[axis] = origin[axis];
        frame.spacing[axis] = s->set.spacing;
    }
    s->to_world = iso_transform_affine(&frame);
}

static bool any_frozen(const iso_voxel_set *set) {
    for (size_t i = 0; i < words_of(set); i++)
        if (set->word[i]) return true;
    return false;
}

/* The stroke, somewhere in the grid: the tool changes the whole mask. */
static iso_status draw(iso_session *session, iso_stamp *stamp, iso_error *error) {
    const iso_transform *frame = &iso_session_grid(session)->transform;
    const iso_brush brush = {.tool = ISO_TOOL_MASK_VOXELS, .radius = frame->spacing[0]};
    const iso_sample sample = {.position = {frame->origin[0], frame->origin[1], frame->origin[2]},
                               .normal = {0, 0, 1},
                               .pressure = 1};
    ISO_TRY(iso_session_set_stamp(session, stamp, error));
    ISO_TRY(iso_session_begin(session, &brush, &sample, NULL, error));
    return iso_session_end(session, error);
}

static iso_status freeze(iso_session *session, sampling *s, iso_pool *pool, iso_error *error) {
    iso_stamp *stamp;
    choose_frame(iso_session_grid(session), s);
    s->from_world = iso_transform_affine(iso_grid_transform(s->volume));
    ISO_TRY(iso_voxel_set_init(&s->set, error));
    iso_parallel_for(pool, (words_of(&s->set) + WORDS - 1) / WORDS, sample_words, s);
    if (!any_frozen(&s->set)) {
        iso_voxel_set_free(&s->set);
        return iso_fail(error, ISO_ERR_EMPTY, "there is nothing to freeze");
    }
    ISO_TRY(iso_stamp_from_voxels("frozen", &s->set, &stamp, error));
    return draw(session, stamp, error);
}

iso_status iso_source_freeze(iso_session *session, const iso_grid *volume, double isovalue, iso_pool *pool,
                             iso_error *error) {
    sampling s = {.volume = volume, .stored = iso_grid_stored(volume, isovalue)};
    if (!isfinite(isovalue)) return iso_fail(error, ISO_ERR_USAGE, "the isovalue is not finite");
    return freeze(session, &s, pool, error);
}

iso_status iso_source_freeze_labels(iso_session *session, const iso_grid *volume, int own, iso_pool *pool,
                                    iso_error *error) {
    sampling s = {.volume = volume, .stored = NAN, .own = own};
    return freeze(session, &s, pool, error);
}
