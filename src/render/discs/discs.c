/* discs: divides the picture into patches, one task each, sorts the blocks of points by depth, lists
 * those that each patch may show, and draws a patch from front to back with the kernel (kernel.h). While a
 * patch is drawn, the depths behind which nothing more can be seen are kept for square cells of it, like a
 * coarse hierarchical z-buffer (Greene, Kass and Miller 1993). */
#include "render/discs/discs.h"

#include <math.h>
#include <string.h>

#include "render/discs/discs_numbers.h"
#include "render/discs/kernel.h"
#include "render/discs/setup.h"

enum {
    PATCH_WIDTH = 128, /* pixels: the sums of a patch fit into a core's own cache */
    PATCH_HEIGHT = 64,
    LANES = 16,                         /* of the widest vectors */
    MOST_ROWS = LANES / ISO_DISCS_TILE, /* of a tile */
    CELL_SHIFT_LEAST = 3,
    LAYERS = 4096,      /* of depth, that blocks are sorted into */
    HIDDEN_UPDATES = 6, /* how often a patch's hidden depths are computed while it is drawn */
    PLANES = 6,         /* values of a pixel beside its sums, in a patch */
    PREFETCHED = 512    /* points of a block that are prefetched, at most */
};

/* The state of drawing one surface. */
typedef struct discs_call {
    iso_discs_params params;
    const iso_discs_kernel *kernel;
    const iso_point_blocks *blocks;
    iso_discs *workspace;
    bool draw_hidden; /* of iso_discs_opts */
    int across, down; /* columns and rows of patches */
    /* pixels in a row of a patch, and in the whole patch with the rows that tiles may reach beyond it */
    size_t stride, pixels;
    int shift, wide, high; /* cells: see iso_discs_patch; columns and rows of cells in a patch */
    float behind; /* mm by which a disc's centre must be behind the deepest front around it to be hidden */
} discs_call;

/* Columns first[0] .. last[0] and rows first[1] .. last[1] of patches. */
typedef struct patch_range {
    int16_t first[2], last[2];
} patch_range;

/* ---- preparation */

/* Computes the view space position that the steps of each block count from. */
static iso_status set_up_corners(discs_call *call, const iso_projector *projector, iso_error *error) {
    const iso_point_block *block = call->blocks->blocks.data;
    const double low = (double)call->params.first_step;
    ISO_TRY(iso_buffer_reserve(&call->workspace->corners, call->blocks->count * sizeof(float[3]), 0, error));
    float(*corner)[3] = call->workspace->corners.data;
    for (size_t i = 0; i < call->blocks->count; i++) {
        double at[3];
        for (int k = 0; k < 3; k++) at[k] = block[i].brick[k] * (double)ISO_BRICK + low;
        for (int k = 0; k < 3; k++) {
            const double *m = projector->matrix + 3 * k;
            corner[i][k] = (float)(m[0] * at[0] + m[1] * at[1] + m[2] * at[2] + projector->origin[k]);
        }
    }
    call->params.corner = (const float(*)[3])corner;
    return ISO_OK;
}

/* Sets the border that discs are clipped at: the surface ends there, discs would continue. */
static void set_up_border(iso_discs_params *params) {
    const int32_t *dims = params->points->dims;
    params->has_border = dims[0] > 0 && dims[1] > 0 && dims[2] > 0;
    params->voxels_per_mm = iso_discs_voxels_per_mm(params->normal);
    for (int k = 0; k < 3; k++) params->border[k] = (float)(dims[k] - 1);
}

/* Sets the metric of balls: the squared length in voxels times the square of the largest spacing. */
static void set_up_metric(iso_discs_params *params, const double spacing[3]) {
    const double side = fmax(spacing[0], fmax(spacing[1], spacing[2]));
    int i = 0;
    params->anisotropic = spacing[0] != spacing[1] || spacing[1] != spacing[2];
    for (int r = 0; r < 3; r++)
        for (int c = r; c < 3; c++, i++) {
            double sum = 0;
            for (int k = 0; k < 3; k++)
                sum += (double)params->normal[3 * r + k] * (double)params->normal[3 * c + k];
            params->metric[i] = (float)(sum * side * side * (r == c ? 1 : 2));
        }
}

/* Sets the bodies that cut discs, in view space. */
static void set_up_cuts(iso_discs_params *params) {
    const iso_clip *clip = params->target->clip;
    const iso_view *view = params->target->view;
    params->cuts = clip ? clip->count : 0;
    for (int i = 0; i < params->cuts; i++) {
        const iso_clip_body *body = &clip->body[i];
        const iso_vec3 centre = iso_view_point(view, body->centre);
        iso_discs_cut *cut = &params->cut[i];
        *cut = (iso_discs_cut){.faces = body->faces, .keeps = body->keeps};
        cut->centre[0] = (float)centre.x, cut->centre[1] = (float)centre.y, cut->centre[2] = (float)centre.z;
        cut->radius = (float)body->radius;
        for (int k = 0; k < body->faces; k++) {
            const double *f = body->face[k];
            const iso_vec3 normal = {f[0], f[1], f[2]}, turned = iso_view_vector(view, normal);
            cut->face[k][0] = (float)turned.x, cut->face[k][1] = (float)turned.y;
            cut->face[k][2] = (float)turned.z;
            cut->face[k][3] = (float)(f[3] - iso_vec3_dot(normal, view->eye));
        }
    }
}

static void set_up_params(discs_call *call, const iso_projector *projector) {
    iso_discs_params *params = &call->params;
    const iso_view *view = params->target->view;
    params->first_step = params->points->packed ? ISO_POINT_LOW : 0;
    params->voxels_per_step = params->points->packed ? ISO_POINT_STEP : 1;
    for (int k = 0; k < 9; k++)
        params->step[k] = (float)(projector->matrix[k] * (double)params->voxels_per_step);
    memcpy(params->normal, projector->normal, sizeof params->normal);
    params->ball[0] = ISO_DISCS_BALL;
    params->ball[1] = ISO_DISCS_BALL_MORE;
    params->grow_from = ISO_DISCS_GROW_FROM;
    params->grow = 1 / ISO_DISCS_GROW_OVER;
    params->radius = params->points->radius > 0 ? (float)params->points->radius : 0;
    params->focal = (float)view->focal;
    params->slope = view->orthographic ? 0 : (float)(1 / view->focal);
    params->axis[0] = (float)view->cx;
    params->axis[1] = (float)(view->cy + view->above);
    params->slant = iso_discs_slant(view, 0);
    const double *spacing = params->points->transform.spacing;
    set_up_metric(params, spacing);
    if (!params->anisotropic) params->per_length = (float)spacing[0];
    params->near = view->near < -ISO_NOWHERE ? -ISO_NOWHERE : (float)view->near;
    params->orthographic = view->orthographic;
    params->cull = params->points->closed && !call->blocks->around_eye;
    params->radii_scale = iso_point_view_radii_scale(params->points);
    params->colored = params->points->colors != NULL;
    set_up_border(params);
    set_up_cuts(params);
}

/* `color` NULL: there is no colour of all discs. */
static void set_up_color(iso_discs_params *params, const iso_rgb *color) {
    if (!color) return;
    params->color = (uint32_t)color->r | (uint32_t)color->g << 8 | (uint32_t)color->b << 16 |
                    (uint32_t)(params->target->surface + 1) << 24;
}

static void set_up_flat_discs(iso_discs_params *params, iso_flat_disc_style flat) {
    if (params->points->curvatures && !params->colored) return;
    params->ball[1] = ISO_DISCS_FLAT_MORE;
    params->grow = 1 / ISO_DISCS_FLAT_GROW_OVER;
    params->first = flat == ISO_FLAT_DISCS_ONEPASS;
    params->filtered = flat == ISO_FLAT_DISCS_FILTERED || flat == ISO_FLAT_DISCS_EWA;
    params->widened = flat == ISO_FLAT_DISCS_EWA;
    params->centres = flat == ISO_FLAT_DISCS_MEAN;
}

static void choose_patches(discs_call *call) {
    const iso_view *view = call->params.target->view;
    call->across = (view->width + PATCH_WIDTH - 1) / PATCH_WIDTH;
    call->down = (view->height + PATCH_HEIGHT - 1) / PATCH_HEIGHT;
    const int width = view->width < PATCH_WIDTH ? view->width : PATCH_WIDTH,
              height = view->height < PATCH_HEIGHT ? view->height : PATCH_HEIGHT;
    call->stride = (size_t)(width + LANES - 1) / LANES * LANES;
    call->pixels = call->stride * (size_t)((height + 3) / 4 * 4 + MOST_ROWS);
}

/* The largest radius of a point, mm. */
static float largest_radius(const iso_point_view *points, float shared) {
    float largest = points->radii ? 0 : shared, scale = 1;
    for (size_t s = 0; points->span_scales && s < points->span_count; s++)
        scale = fmaxf(scale, points->span_scales[s]);
    for (size_t s = 0; points->radii && s < points->span_count; s++)
        for (size_t i = 0; i < points->spans[s].count; i++) {
            const float radius = points->radii[points->spans[s].first + i];
            largest = radius > largest ? radius : largest;
        }
    return points->radii ? largest * iso_point_view_radii_scale(points) : largest * scale;
}

/* The width of a pixel (mm) at the depth of the farthest point that is seen. */
static float largest_pixel(const discs_call *call) {
    const iso_point_block *block = call->blocks->blocks.data;
    float depth = 0;
    for (size_t i = 0; i < call->blocks->count; i++)
        if (block[i].seen && block[i].depth[1] > depth) depth = block[i].depth[1];
    return call->params.orthographic ? 1 / call->params.focal : depth * call->params.slope;
}

/* How far a disc of a radius reaches in the picture, pixels: farther if it is convolved with the low-pass
 * filter. */
static float reach_of(float radius, bool filtered) {
    return hypotf(radius, filtered ? ISO_DISCS_LOW_PASS : 0);
}

/* Chooses the cells: as large as the largest disc's reach, so that a disc lies in its centre's cell and
 * the eight around it. */
static void set_up_occlusion(discs_call *call) {
    const float radius = call->blocks->radius[1] / ISO_DISC_RADII * (ISO_DISCS_BALL + ISO_DISCS_BALL_MORE),
                most = reach_of(radius * call->params.slant, call->params.filtered);
    call->shift = CELL_SHIFT_LEAST;
    while (call->shift < 16 && most > (float)(1 << call->shift)) call->shift++;
    const size_t side = (size_t)1 << call->shift;
    call->wide = (int)((call->stride + side - 1) >> call->shift);
    call->high = (int)((call->pixels / call->stride + side - 1) >> call->shift);
    /* A disc reaches one radius towards the eye and is averaged with hits up to 1.5 radii before it: 2.5,
     * and a margin. Without culling a front-facing disc can replace a flipped one that lies another 1.5
     * radii before. */
    const float ball =
        largest_radius(call->params.points, call->params.radius) * (ISO_DISCS_BALL + ISO_DISCS_BALL_MORE);
    call->behind = (call->params.cull ? 2.6f : 4.1f) * ball;
    if (call->params.filtered) call->behind += ISO_DISCS_LOW_PASS_DEPTH * largest_pixel(call);
    /* centres are averaged over a greater depth, which counts twice where they can replace flipped ones */
    if (call->params.centres) call->behind += 2 * ISO_DISCS_CENTRES_DEPTH * largest_pixel(call);
}

/* The patches that a block's discs can cover. */
static patch_range patches_of_block(const discs_call *call, const iso_point_block *block) {
    const iso_view *view = call->params.target->view;
    const double reach = (double)(iso_discs_largest_radius(block) * call->params.slant + 2);
    const int most[2] = {call->across, call->down}, size[2] = {PATCH_WIDTH, PATCH_HEIGHT};
    patch_range in = {{0, 0}, {-1, -1}};
    if (!block->seen || (call->params.cull && block->back_facing)) return in;
    for (int k = 0; k < 2; k++) {
        const int32_t *range = k ? block->row : block->column;
        const double axis = k ? view->cy : view->cx;
        const double first = (range[0] + axis - reach) / size[k], last = (range[1] + axis + reach) / size[k];
        if (!(first < most[k] && last >= 0)) return (patch_range){{0, 0}, {-1, -1}};
        in.first[k] = (int16_t)(first < 0 ? 0 : first);
        in.last[k] = (int16_t)(last < most[k] ? last : most[k] - 1);
    }
    return in;
}

/* Sorts the blocks by the depth of their bricks' corners, in LAYERS layers, so that the front is drawn
 * first and hides the rest. Blocks that are not seen are sorted too: then every strip of a picture has the
 * same layers. */
static iso_status sort_blocks(discs_call *call, uint32_t **sorted, iso_error *error) {
    const float(*corner)[3] = call->params.corner;
    const size_t count = call->blocks->count;
    ISO_TRY(iso_buffer_reserve(&call->workspace->sorted, count * sizeof **sorted, 0, error));
    *sorted = call->workspace->sorted.data;
    size_t start[LAYERS + 1] = {0};
    float least = INFINITY, most = -INFINITY;
    for (size_t i = 0; i < count; i++) {
        least = corner[i][2] < least ? corner[i][2] : least;
        most = corner[i][2] > most ? corner[i][2] : most;
    }
    const float scale = most > least ? (LAYERS - 1) / (most - least) : 0;
    for (size_t i = 0; i < count; i++) start[(size_t)((corner[i][2] - least) * scale) + 1]++;
    for (size_t k = 1; k <= LAYERS; k++) start[k] += start[k - 1];
    for (size_t i = 0; i < count; i++)
        (*sorted)[start[(size_t)((corner[i][2] - least) * scale)]++] = (uint32_t)i;
    return ISO_OK;
}

/* Lists the blocks of each patch, sorted: patch p's are order[start[p]] .. order[start[p + 1] - 1]. */
static iso_status assign_blocks(discs_call *call, iso_error *error) {
    const iso_point_block *block = call->blocks->blocks.data;
    iso_discs *w = call->workspace;
    const size_t count = call->blocks->count, all = (size_t)call->across * (size_t)call->down;
    ISO_TRY(iso_buffer_reserve(&w->start, (all + 2) * sizeof(size_t), 0, error));
    ISO_TRY(iso_buffer_reserve(&w->reached, count * sizeof(patch_range), 0, error));
    uint32_t *sorted;
    ISO_TRY(sort_blocks(call, &sorted, error));
    size_t *start = w->start.data;
    patch_range *reached = w->reached.data;
    memset(start, 0, (all + 2) * sizeof(size_t));
    for (size_t i = 0; i < count; i++) {
        const patch_range in = reached[i] = patches_of_block(call, &block[i]);
        for (int y = in.first[1]; y <= in.last[1]; y++)
            for (int x = in.first[0]; x <= in.last[0]; x++) start[y * call->across + x + 2]++;
    }
    for (size_t p = 0; p < all; p++) start[p + 2] += start[p + 1];
    ISO_TRY(iso_buffer_reserve(&w->order, (start[all + 1] + 1) * sizeof(uint32_t), 0, error));
    uint32_t *order = w->order.data;
    for (size_t i = 0; i < count; i++) {
        const patch_range in = reached[sorted[i]];
        for (int y = in.first[1]; y <= in.last[1]; y++)
            for (int x = in.first[0]; x <= in.last[0]; x++)
                order[start[y * call->across + x + 1]++] = sorted[i];
    }
    return ISO_OK;
}

/* ---- patches */

/* The drawing of a patch. */
typedef struct drawing {
    iso_discs_patch patch;
    const uint32_t *order; /* numbers of its blocks, front to back */
    size_t count;
    bool tiles;     /* discs are splatted to tiles, else scattered to pixels */
    float *hidden;  /* for each cell: a disc with its centre in the cell and deeper is hidden */
    float *deepest; /* working memory, one value per cell */
    float *limits;  /* for each cell: the deepest limit (iso_discs_patch), if there are limits */
    float least;    /* the least value of `hidden` */
} drawing;

/* The counts of a worker, alone in a cache line. */
typedef struct tally {
    _Alignas(ISO_ALIGNMENT) iso_selection_counts counts;
} tally;

static size_t worker_bytes(const discs_call *call) {
    return (call->pixels * (ISO_SUMS + PLANES) + 3 * (size_t)(call->wide * call->high)) * sizeof(float);
}

/* Prepares patch `number` in the worker's memory. */
static drawing start_patch(const discs_call *call, size_t number, int worker) {
    const size_t *start = call->workspace->start.data;
    const iso_view *view = call->params.target->view;
    const int x = (int)number % call->across * PATCH_WIDTH, y = (int)number / call->across * PATCH_HEIGHT;
    float *sums = (float *)((char *)call->workspace->memory.data + (size_t)worker * worker_bytes(call)),
          *front = sums + call->pixels * ISO_SUMS, *limit = front + call->pixels,
          *outer = limit + call->pixels, *facing = outer + call->pixels,
          *hidden = front + PLANES * call->pixels;
    const size_t sides = call->params.pass == ISO_DISCS_SUM_PASS ? 3 * call->pixels : 0;
    for (size_t i = 0; i < call->pixels; i++) front[i] = ISO_NOWHERE;
    for (size_t i = 0; i < call->pixels && call->params.filtered; i++) outer[i] = ISO_NOWHERE;
    for (size_t i = 0; i < sides; i++) facing[i] = ISO_NOWHERE;
    return (drawing){
        .patch = {.first = {x, y},
                  .last = {(x + PATCH_WIDTH < view->width ? x + PATCH_WIDTH : view->width) - 1,
                           (y + PATCH_HEIGHT < view->height ? y + PATCH_HEIGHT : view->height) - 1},
                  .stride = call->stride,
                  .tiles = call->stride / ISO_DISCS_TILE,
                  .sums = sums,
                  .colors = sums + 4 * call->pixels,
                  .depths = sums + 8 * call->pixels,
                  .sides = sums + 9 * call->pixels,
                  .front = front,
                  .limit = limit,
                  .counts = &((tally *)call->workspace->tallies.data)[worker].counts,
                  .outer_front = outer,
                  .facing = facing,
                  .flipped = facing + call->pixels,
                  .facing_reach = facing + 2 * call->pixels,
                  .shift = call->shift,
                  .cells = call->wide},
        .order = (const uint32_t *)call->workspace->order.data + start[number],
        .count = start[number + 1] - start[number],
        .hidden = hidden,
        .deepest = hidden + call->wide * call->high,
        .limits = hidden + 2 * call->wide * call->high,
        .least = ISO_NOWHERE};
}

/* Chooses how the discs of a patch are added: scattered when even the largest fits into ISO_DISCS_BOX
 * pixels, and when only their centres are drawn. */
static void choose_method(const discs_call *call, drawing *d) {
    const iso_point_block *block = call->blocks->blocks.data;
    float most = 0;
    bool filtered = false;
    d->patch.flat = true;
    for (size_t i = 0; i < d->count; i++) {
        const iso_point_block *b = &block[d->order[i]];
        most = b->radius[1] > most ? b->radius[1] : most;
        d->patch.flat &= !iso_discs_use_curvature(&call->params, b);
        filtered |= iso_discs_use_filter(&call->params, b);
    }
    const iso_point_block largest = {.radius = {0, most}};
    const float reach = reach_of(iso_discs_largest_radius(&largest) * call->params.slant, filtered);
    d->tiles = !call->params.centres && 2 * reach + 1 > ISO_DISCS_BOX;
}

/* Empties the sums of flat discs, and all that are added in two passes. */
static void clear_sums(const discs_call *call, const drawing *d) {
    const iso_discs_patch *p = &d->patch;
    const size_t plane = call->pixels * sizeof *p->sums;
    if (d->tiles && call->params.pass == ISO_DISCS_SUM_PASS) memset(p->sums, 0, ISO_SUMS * plane);
    if (d->tiles || !p->flat) return;
    memset(p->sums, 0, 4 * plane);
    if (call->params.colored) memset(p->colors, 0, 4 * plane);
    memset(p->depths, 0, plane);
    memset(p->sides, 0, plane);
}

static float max_float(float a, float b) {
    return a > b ? a : b;
}

/* Whether nothing has been drawn into a patch of the gbuffer. */
static bool is_empty(const iso_gbuffer *g, const iso_discs_patch *patch) {
    const float nothing = INFINITY;
    uint32_t none, differs = 0;
    memcpy(&none, &nothing, sizeof none);
    for (int y = patch->first[1]; y <= patch->last[1]; y++) {
        const float *row = g->depth + (size_t)y * (size_t)g->width;
        for (int x = patch->first[0]; x <= patch->last[0]; x++) {
            uint32_t bits;
            memcpy(&bits, &row[x], sizeof bits);
            differs |= bits ^ none;
        }
    }
    return !differs;
}

static void find_deepest(const discs_call *call, const drawing *d, float *plane, float *deepest) {
    iso_discs_patch patch = d->patch;
    patch.front = plane;
    for (int i = 0; i < call->wide * call->high; i++) deepest[i] = -ISO_NOWHERE;
    (d->tiles ? call->kernel->find_deepest_tiles : call->kernel->find_deepest_pixels)(&patch, deepest);
}

/* Sets the limits of a patch from what has been drawn into the gbuffer before; there are none if that is
 * nothing. */
static void set_up_limits(const discs_call *call, drawing *d) {
    const iso_gbuffer *g = call->params.target->gbuffer;
    const iso_discs_patch *p = &d->patch;
    if (is_empty(g, p)) {
        d->patch.limit = NULL;
        return;
    }
    for (size_t i = 0; i < call->pixels; i++) p->limit[i] = -ISO_NOWHERE; /* beyond the picture's sides */
    const size_t count = (size_t)(p->last[0] - p->first[0] + 1);
    for (int y = p->first[1]; y <= p->last[1] && !d->tiles; y++)
        memcpy(p->limit + (size_t)(y - p->first[1]) * p->stride,
               g->depth + (size_t)y * (size_t)g->width + p->first[0], count * sizeof(float));
    if (d->tiles) call->kernel->load_limits_tiles(&call->params, p);
    find_deepest(call, d, p->limit, d->limits);
}

/* Computes `hidden` from what has been drawn: the deepest front, or limit, of a cell and the eight around it,
 * plus call->behind. Maxima of three cells along x, then along y. */
static void update_hidden(const discs_call *call, drawing *d) {
    const int wide = call->wide, high = call->high;
    find_deepest(call, d, d->patch.front, d->deepest);
    for (int i = 0; i < wide * high && d->patch.limit; i++)
        d->deepest[i] = d->deepest[i] < d->limits[i] ? d->deepest[i] : d->limits[i];
    for (int y = 0; y < high; y++) {
        const float *from = d->deepest + y * wide;
        for (int x = 0; x < wide; x++)
            d->hidden[y * wide + x] =
                max_float(max_float(from[x > 0 ? x - 1 : x], from[x]), from[x + 1 < wide ? x + 1 : x]);
    }
    memcpy(d->deepest, d->hidden, (size_t)(wide * high) * sizeof *d->hidden);
    d->least = ISO_NOWHERE;
    for (int y = 0; y < high; y++) {
        const float *from = d->deepest + y * wide, *above = y > 0 ? from - wide : from,
                    *below = y + 1 < high ? from + wide : from;
        for (int x = 0; x < wide; x++) {
            const float hidden = max_float(max_float(above[x], from[x]), below[x]) + call->behind;
            d->hidden[y * wide + x] = hidden;
            d->least = hidden < d->least ? hidden : d->least;
        }
    }
}

/* The cells along an axis that contain centres of a block's points, clamped to the patch. */
static void cells_of_block(const discs_call *call, const drawing *d, const iso_point_block *block, int axis,
                           int range[2]) {
    const iso_view *view = call->params.target->view;
    const int32_t *pixels = axis ? block->row : block->column;
    const double from = (axis ? view->cy : view->cx) - d->patch.first[axis];
    const int last = (d->patch.last[axis] - d->patch.first[axis]) >> call->shift;
    for (int end = 0; end < 2; end++) {
        const double at = (pixels[end] + from) / (1 << call->shift);
        range[end] = at < 0 ? 0 : at > last ? last : (int)at;
    }
}

/* Whether all discs of a block are hidden; *some: whether some may be. */
static bool is_hidden(const discs_call *call, const drawing *d, const iso_point_block *block, bool *some) {
    *some = block->depth[1] > d->least;
    if (!*some) return false;
    int x[2], y[2];
    float least = ISO_NOWHERE, most = -ISO_NOWHERE;
    cells_of_block(call, d, block, 0, x);
    cells_of_block(call, d, block, 1, y);
    for (int v = y[0]; v <= y[1]; v++)
        for (int u = x[0]; u <= x[1]; u++) {
            const float hidden = d->hidden[v * call->wide + u];
            least = hidden < least ? hidden : least;
            most = hidden > most ? hidden : most;
        }
    *some = block->depth[1] > least;
    return block->depth[0] > most;
}

static void prefetch_bytes(const void *items, size_t bytes) {
    for (size_t at = 0; at < bytes; at += 64) __builtin_prefetch((const char *)items + at);
}

/* Prefetches a block's points: blocks are too short for hardware prefetchers. */
static void prefetch_block(const discs_call *call, const iso_point_block *block) {
    const iso_point_view *points = call->params.points;
    const size_t count = block->count < PREFETCHED ? block->count : PREFETCHED;
    if (!points->packed) return;
    prefetch_bytes(points->packed + block->first, count * sizeof *points->packed);
    if (iso_discs_use_curvature(&call->params, block))
        prefetch_bytes(points->curvatures + block->first, count * sizeof *points->curvatures);
}

/* Draws the blocks of a patch that may be visible; whether there is one. */
static bool draw_blocks(const discs_call *call, const iso_discs_params *params, drawing *d) {
    const iso_point_block *block = call->blocks->blocks.data;
    const size_t rounds = d->count / HIDDEN_UPDATES + 1;
    const bool updates = !call->draw_hidden && params->pass != ISO_DISCS_SUM_PASS;
    bool drawn = false;
    for (size_t i = 0; i < d->count; i++) {
        bool some = false;
        if (i + 1 < d->count) prefetch_block(call, &block[d->order[i + 1]]);
        if (i && i % rounds == 0 && updates) update_hidden(call, d);
        if (!call->draw_hidden && is_hidden(call, d, &block[d->order[i]], &some)) continue;
        d->patch.hidden = some ? d->hidden : NULL;
        drawn = true;
        (d->tiles ? call->kernel->splat_block : call->kernel->scatter_block)(params, &d->patch, d->order[i]);
    }
    return drawn;
}

/* The front pass, and what the sum pass needs of it: a pixel's front is that of its front-facing discs, or of
 * the flipped ones where they win. */
static void find_fronts(const discs_call *call, drawing *d) {
    iso_discs_params params = call->params;
    params.pass = ISO_DISCS_FRONT_PASS;
    params.filtered = params.widened;
    draw_blocks(call, &params, d);
    const iso_discs_patch *p = &d->patch;
    for (size_t i = 0; i < call->pixels; i++) {
        const bool flipped = p->flipped[i] < p->facing_reach[i];
        p->front[i] = flipped ? p->flipped[i] : p->facing[i];
        if (!d->tiles) p->sides[i] = flipped ? -1 : 1;
    }
    if (!call->draw_hidden) update_hidden(call, d);
}

static void draw_patch(void *context, size_t number, int worker) {
    const discs_call *call = context;
    const size_t *start = call->workspace->start.data;
    if (start[number] == start[number + 1]) return;
    drawing d = start_patch(call, number, worker);
    choose_method(call, &d);
    set_up_limits(call, &d);
    clear_sums(call, &d);
    if (d.patch.limit) update_hidden(call, &d);
    if (call->params.pass == ISO_DISCS_SUM_PASS) find_fronts(call, &d);
    if (draw_blocks(call, &call->params, &d))
        (d.tiles ? call->kernel->resolve_tiles : call->kernel->resolve_pixels)(&call->params, &d.patch);
}

static void add_counts(iso_discs *workspace, const iso_point_view *points, size_t workers) {
    const tally *tallies = workspace->tallies.data;
    workspace->counts.points += iso_point_view_count(points);
    for (size_t i = 0; i < workers; i++) {
        workspace->counts.tested += tallies[i].counts.tested;
        workspace->counts.drawn += tallies[i].counts.drawn;
    }
}

iso_status iso_discs_draw(iso_discs *workspace, const iso_target *target, const iso_point_view *points,
                          const iso_point_blocks *blocks, const iso_discs_opts *opts, iso_error *error) {
    discs_call call = {.params = {.target = target, .points = points, .blocks = blocks->blocks.data},
                       .kernel = iso_discs_kernel_get(iso_cpu_best()),
                       .blocks = blocks,
                       .workspace = workspace,
                       .draw_hidden = opts->draw_hidden};
    const iso_projector projector = iso_projector_make(target->view, &points->transform);
    set_up_params(&call, &projector);
    set_up_flat_discs(&call.params, opts->flat);
    set_up_color(&call.params, opts->color);
    const bool overlapping = points->radii || points->overlapping,
               two_passes = call.params.centres || call.params.widened ||
                            (blocks->around_eye && opts->flat != ISO_FLAT_DISCS_ONEPASS) ||
                            (overlapping && opts->flat == ISO_FLAT_DISCS_FILTERED);
    call.params.pass = two_passes ? ISO_DISCS_SUM_PASS : ISO_DISCS_ONE_PASS;
    choose_patches(&call);
    set_up_occlusion(&call);
    ISO_TRY(set_up_corners(&call, &projector, error));
    ISO_TRY(assign_blocks(&call, error));
    const size_t workers = (size_t)iso_pool_threads(target->pool);
    ISO_TRY(iso_buffer_reserve(&workspace->memory, workers * worker_bytes(&call), 0, error));
    ISO_TRY(iso_buffer_reserve(&workspace->tallies, workers * sizeof(tally), 0, error));
    memset(workspace->tallies.data, 0, workers * sizeof(tally));
    iso_parallel_for(target->pool, (size_t)call.across * (size_t)call.down, draw_patch, &call);
    add_counts(workspace, points, workers);
    return ISO_OK;
}

void iso_discs_free(iso_discs *workspace) {
    iso_buffer_free(&workspace->corners);
    iso_buffer_free(&workspace->sorted);
    iso_buffer_free(&workspace->reached);
    iso_buffer_free(&workspace->order);
    iso_buffer_free(&workspace->start);
    iso_buffer_free(&workspace->memory);
    iso_buffer_free(&workspace->tallies);
}
