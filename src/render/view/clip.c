/* clip: points, rays and boxes against convex bodies, in double precision. */
#include "render/view/clip.h"

static double distance(const double face[4], iso_vec3 point) {
    return face[0] * point.x + face[1] * point.y + face[2] * point.z - face[3];
}

static void set_face(double face[4], iso_vec3 normal, double offset) {
    iso_vec3_store(normal, face);
    face[3] = offset;
}

iso_clip_body iso_clip_half_space(iso_vec3 point, iso_vec3 normal) {
    iso_clip_body body = {.faces = 1};
    const iso_vec3 outward = iso_vec3_unit(iso_vec3_scale(normal, -1));
    set_face(body.face[0], outward, iso_vec3_dot(outward, point));
    return body;
}

iso_clip_body iso_clip_box(const iso_box *box) {
    iso_clip_body body = {.faces = 6};
    const double lo[3] = {box->lo.x, box->lo.y, box->lo.z}, hi[3] = {box->hi.x, box->hi.y, box->hi.z};
    for (int axis = 0; axis < 3; axis++) {
        const iso_vec3 up = {axis == 0, axis == 1, axis == 2};
        set_face(body.face[2 * axis], iso_vec3_scale(up, -1), -lo[axis]);
        set_face(body.face[2 * axis + 1], up, hi[axis]);
    }
    return body;
}

iso_clip_body iso_clip_ball(iso_vec3 centre, double radius) {
    return (iso_clip_body){.centre = centre, .radius = radius};
}

static bool contains(const iso_clip_body *body, iso_vec3 point) {
    const iso_vec3 from = iso_vec3_sub(point, body->centre);
    if (!body->faces) return iso_vec3_dot(from, from) < body->radius * body->radius;
    for (int i = 0; i < body->faces; i++)
        if (!(distance(body->face[i], point) < 0)) return false;
    return true;
}

bool iso_clip_shows(const iso_clip *clip, iso_vec3 point) {
    for (int i = 0; i < clip->count; i++)
        if (contains(&clip->body[i], point) != clip->body[i].keeps) return false;
    return true;
}

/* ---- rays */

/* The part of a ray in a body, enter < t < leave; empty if not enter < leave. The faces are those through
 * which it enters and leaves. */
typedef struct passage {
    double enter, leave;
    int entered, left;
} passage;

static passage through_faces(const iso_clip_body *body, iso_vec3 origin, iso_vec3 direction) {
    passage p = {-INFINITY, INFINITY, 0, 0};
    for (int i = 0; i < body->faces; i++) {
        const double *f = body->face[i];
        const double at = distance(f, origin),
                     slope = f[0] * direction.x + f[1] * direction.y + f[2] * direction.z;
        if (slope == 0 && !(at < 0)) return (passage){INFINITY, -INFINITY, 0, 0};
        const double t = -at / slope;
        if (slope < 0 && t > p.enter) p.enter = t, p.entered = i;
        if (slope > 0 && t < p.leave) p.leave = t, p.left = i;
    }
    return p;
}

static passage through_ball(const iso_clip_body *body, iso_vec3 origin, iso_vec3 direction) {
    const iso_vec3 from = iso_vec3_sub(origin, body->centre);
    const double square = iso_vec3_dot(direction, direction),
                 middle = -iso_vec3_dot(from, direction) / square;
    const iso_vec3 nearest = iso_vec3_add(from, iso_vec3_scale(direction, middle));
    const double reach = (body->radius * body->radius - iso_vec3_dot(nearest, nearest)) / square;
    if (!(reach > 0)) return (passage){INFINITY, -INFINITY, 0, 0};
    return (passage){middle - sqrt(reach), middle + sqrt(reach), 0, 0};
}

static passage through(const iso_clip_body *body, iso_vec3 origin, iso_vec3 direction) {
    return body->faces ? through_faces(body, origin, direction) : through_ball(body, origin, direction);
}

/* Moves the beginning of a piece out of what the bodies cut away. */
static void skip_cut(const iso_clip *clip, const passage *passages, iso_clip_piece *piece) {
    for (int round = 0; round < clip->count; round++)
        for (int i = 0; i < clip->count; i++) {
            const passage *p = &passages[i];
            const bool keeps = clip->body[i].keeps, some = p->enter < p->leave;
            if (keeps && !(some && piece->begin < p->leave)) {
                piece->begin = INFINITY;
                return;
            }
            const bool moves =
                keeps ? piece->begin < p->enter : some && piece->begin >= p->enter && piece->begin < p->leave;
            if (!moves) continue;
            *piece = (iso_clip_piece){keeps ? p->enter : p->leave, 0, i, keeps ? p->entered : p->left};
        }
}

/* Ends a piece at the next body that cuts the ray. */
static void end_piece(const iso_clip *clip, const passage *passages, double end, iso_clip_piece *piece) {
    piece->end = end;
    for (int i = 0; i < clip->count; i++) {
        const passage *p = &passages[i];
        if (clip->body[i].keeps)
            piece->end = fmin(piece->end, p->leave);
        else if (p->enter < p->leave && p->enter > piece->begin)
            piece->end = fmin(piece->end, p->enter);
    }
}

int iso_clip_pieces(const iso_clip *clip, iso_vec3 origin, iso_vec3 direction, double begin, double end,
                    iso_clip_piece pieces[ISO_CLIP_PIECES]) {
    passage passages[ISO_CLIP_BODIES];
    for (int i = 0; i < clip->count; i++) passages[i] = through(&clip->body[i], origin, direction);
    int count = 0;
    iso_clip_piece piece = {begin, 0, -1, -1};
    while (count < ISO_CLIP_PIECES) {
        skip_cut(clip, passages, &piece);
        if (!(piece.begin < end)) break;
        end_piece(clip, passages, end, &piece);
        pieces[count++] = piece;
        piece = (iso_clip_piece){piece.end, 0, -1, -1};
    }
    return count;
}

iso_vec3 iso_clip_normal(const iso_clip *clip, const iso_clip_piece *piece, iso_vec3 point) {
    const iso_clip_body *body = &clip->body[piece->body];
    const double *face = body->face[piece->face];
    const iso_vec3 outward = body->faces ? iso_vec3_make(face[0], face[1], face[2])
                                         : iso_vec3_unit(iso_vec3_sub(point, body->centre));
    return iso_vec3_scale(outward, body->keeps ? 1 : -1);
}

/* ---- boxes */

static iso_clip_rest part_in_faces(const iso_clip_body *body, iso_vec3 centre, const iso_vec3 half[3]) {
    iso_clip_rest inside = ISO_CLIP_ALL;
    for (int i = 0; i < body->faces; i++) {
        const double *f = body->face[i], at = distance(f, centre);
        double reach = 0;
        for (int k = 0; k < 3; k++) reach += fabs(f[0] * half[k].x + f[1] * half[k].y + f[2] * half[k].z);
        if (at - reach >= 0) return ISO_CLIP_NOTHING;
        if (!(at + reach < 0)) inside = ISO_CLIP_SOME;
    }
    return inside;
}

static iso_clip_rest part_in_ball(const iso_clip_body *body, iso_vec3 centre, const iso_vec3 half[3]) {
    double reach = 0;
    for (int k = 0; k < 3; k++) reach += iso_vec3_length(half[k]);
    const double from = iso_vec3_length(iso_vec3_sub(centre, body->centre));
    if (from - reach >= body->radius) return ISO_CLIP_NOTHING;
    return from + reach < body->radius ? ISO_CLIP_ALL : ISO_CLIP_SOME;
}

iso_clip_rest iso_clip_of_box(const iso_clip *clip, iso_vec3 centre, const iso_vec3 half[3],
                              unsigned *cutting) {
    *cutting = 0;
    for (int i = 0; i < clip->count; i++) {
        const iso_clip_body *body = &clip->body[i];
        const iso_clip_rest inside =
            body->faces ? part_in_faces(body, centre, half) : part_in_ball(body, centre, half);
        if (inside == (body->keeps ? ISO_CLIP_NOTHING : ISO_CLIP_ALL)) return ISO_CLIP_NOTHING;
        if (inside == ISO_CLIP_SOME) *cutting |= 1u << i;
    }
    return *cutting ? ISO_CLIP_SOME : ISO_CLIP_ALL;
}
