/* Checks the numbers of a stroke file against the table of limits.h. */
#include "sculpt/session/event_limits.h"

#include "grids/hgrid.h"
#include "sculpt/limits.h"

static iso_status check_vector(iso_limit limit, iso_vec3 v, double voxel, iso_error *error) {
    ISO_TRY(iso_limit_check(limit, v.x, voxel, error));
    ISO_TRY(iso_limit_check(limit, v.y, voxel, error));
    return iso_limit_check(limit, v.z, voxel, error);
}

/* The grid of a solid must consist of whole bricks; the radius of other sources than a ball is not used. */
static iso_status check_solid(const iso_journal_start *start, iso_error *error) {
    const bool solid = iso_start_has_solid(start), ball = solid && !(start->solid.size.x > 0);
    for (int axis = 0; axis < 3; axis++)
        if (solid && start->dims[axis] % ISO_BRICK)
            return iso_fail(error, ISO_ERR_FORMAT,
                            "number of voxels along an axis %d: must be a multiple of %d", start->dims[axis],
                            ISO_BRICK);
    if (solid && !ball && iso_start_solid_check(&start->solid, start->voxel_size, error) != ISO_OK)
        return ISO_ERR_FORMAT;
    return ball || start->radius != 0
               ? iso_limit_check(ISO_LIMIT_BALL, start->radius, start->voxel_size, error)
               : ISO_OK;
}

iso_status iso_limits_start(const iso_journal_start *start, iso_error *error) {
    ISO_TRY(iso_limit_check(ISO_LIMIT_VOXEL_SIZE, start->voxel_size, 1, error));
    for (int axis = 0; axis < 3; axis++)
        ISO_TRY(iso_limit_check(ISO_LIMIT_DIMS, start->dims[axis], 1, error));
    ISO_TRY(check_vector(ISO_LIMIT_ORIGIN, start->origin, start->voxel_size, error));
    ISO_TRY(iso_limit_check(ISO_LIMIT_ISOVALUE, start->isovalue, 1, error));
    return check_solid(start, error);
}

static iso_status check_brush(const iso_brush *brush, double voxel, iso_error *error) {
    ISO_TRY(iso_limit_check(ISO_LIMIT_RADIUS, brush->radius, voxel, error));
    ISO_TRY(iso_limit_check(ISO_LIMIT_STRENGTH, brush->strength, 1, error));
    ISO_TRY(iso_limit_check(ISO_LIMIT_ASPECT, brush->aspect, 1, error));
    ISO_TRY(iso_limit_check(ISO_LIMIT_BLEND, brush->blend, voxel, error));
    if (brush->spacing != 0) ISO_TRY(iso_limit_check(ISO_LIMIT_SPACING, brush->spacing, 1, error));
    ISO_TRY(iso_limit_check(ISO_LIMIT_SYMMETRY, brush->symmetry, 1, error));
    ISO_TRY(check_vector(ISO_LIMIT_MIRROR, brush->mirror, voxel, error));
    for (int i = 0; i < 2; i++) ISO_TRY(check_vector(ISO_LIMIT_REPEAT_BY, brush->repeat_by[i], voxel, error));
    return iso_brush_check(brush, error) == ISO_OK ? ISO_OK : ISO_ERR_FORMAT;
}

static iso_status check_sample(const iso_sample *sample, const iso_journal_start *start, iso_error *error) {
    const iso_vec3 relative = iso_vec3_sub(sample->position, start->origin);
    ISO_TRY(check_vector(ISO_LIMIT_POSITION, relative, start->voxel_size, error));
    ISO_TRY(check_vector(ISO_LIMIT_NORMAL, sample->normal, 1, error));
    ISO_TRY(iso_limit_check(ISO_LIMIT_PRESSURE, sample->pressure, 1, error));
    return iso_limit_check(ISO_LIMIT_SECONDS, sample->seconds, 1, error);
}

iso_status iso_limits_event(const iso_event *event, const iso_journal_start *start, iso_error *error) {
    if (event->kind == ISO_EVENT_BEGIN || event->kind == ISO_EVENT_EDIT)
        ISO_TRY(check_brush(&event->brush, start->voxel_size, error));
    for (size_t i = 0; iso_event_has_path(event->kind) && i < event->path_count; i++)
        ISO_TRY(check_sample(&event->path[i], start, error));
    return event->kind <= ISO_EVENT_SAMPLE ? check_sample(&event->sample, start, error) : ISO_OK;
}
