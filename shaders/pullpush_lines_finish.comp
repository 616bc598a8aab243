/* pullpush_lines_finish.comp: the last push of lines, into the picture: each sample lies where its ray meets
 * the tube around a fragment, or the plane of a ribbon (render/pullpush/line_levels.c). */
layout(local_size_x = ISO_GL_TILE, local_size_y = ISO_GL_TILE) in;

const float HALF = 0.5 + 1.0 / 32.0, RIBBON_SLOPE = 0.25, TUBE_SLOPE = 1.0 / 16.0;
const float ASIDE = 0.5, FRONT = 1e-3;

/* What a pixel shows; depth INFINITE: nothing. */
struct sample_of_line {
    float depth;
    vec3 normal;
    uint color;
};

/* A pixel's ray, of depth 1, as a fragment sees it. */
struct meeting {
    vec3 ray, n;  /* n: tangent of a tube, normal of a ribbon: unit, view space */
    vec3 beside;  /* from the fragment's place to the ray at the same depth, mm */
    float radius; /* mm */
};

bool meet_cylinder(meeting m, inout sample_of_line made) {
    float along = dot(m.ray, m.n), square = dot(m.ray, m.ray);
    vec3 turn = m.ray - along * m.n;
    float less = 1.0 / max(square - along * along, square * TUBE_SLOPE);
    float nearest = -dot(m.beside, turn) * less;
    vec3 from = m.beside - dot(m.beside, m.n) * m.n + nearest * turn;
    float rest = m.radius * m.radius - dot(from, from), back = sqrt(max(rest, 0.0) * less);
    made.normal = from - back * turn;
    made.depth += nearest - back;
    return rest >= 0.0;
}

/* `rest`: how far the end is from the fragment along the tangent. */
bool meet_end(meeting m, float rest, inout sample_of_line made) {
    float square = dot(m.ray, m.ray);
    vec3 beside = m.beside - rest * m.n;
    float nearest = -dot(beside, m.ray) / square;
    vec3 from = beside + nearest * m.ray;
    float room = m.radius * m.radius - dot(from, from), back = sqrt(max(room, 0.0) / square);
    made.normal = from - back * m.ray;
    made.depth += nearest - back;
    return room >= 0.0;
}

void meet_plane(meeting m, inout sample_of_line made) {
    float across = dot(m.ray, m.n), steep = max(abs(across), RIBBON_SLOPE * length(m.ray));
    float side = across > 0.0 ? -1.0 : 1.0;
    made.normal = side * m.n;
    made.depth += side * dot(m.beside, m.n) / steep;
}

void illuminate(meeting m, inout sample_of_line made) {
    vec3 light = vec3(ISO_PHONG_LIGHT_X, ISO_PHONG_LIGHT_Y, ISO_PHONG_LIGHT_Z);
    made.normal = light - dot(light, m.n) * m.n;
    if (dot(made.normal, made.normal) <= 1e-6) made.normal = -m.ray;
}

/* How far a place at `depth` on a ray is from the fragment along the tangent, mm. */
float along_tangent(meeting m, uint number, float depth) {
    return dot(m.beside, m.n) + (depth - depth_of(number)) * dot(m.ray, m.n);
}

meeting meet(sight s, vec3 ray) {
    float mm = sight_line.w * (orthographic ? 1.0 : depth_of(s.from));
    return meeting(ray, fragments[s.from - 1u].way.xyz, vec3(s.away * mm, 0.0),
                   fragments[s.from - 1u].along.w);
}

bool complete_tube(sight s, meeting m, inout sample_of_line made) {
    float end = fragments[s.from - 1u].shape.w, size = float(1 << lattice.x);
    bool meets = meet_cylinder(m, made) && s.along <= BESIDE * BESIDE * size * size || s.q <= 1.0;
    float along = along_tangent(m, s.from, made.depth);
    if (end < 0.0 ? along < end : along > end) {
        made.depth = depth_of(s.from);
        meets = meet_end(m, end, made) && s.q <= 1.0;
    }
    if (flags.z != 0u) illuminate(m, made);
    return meets;
}

/* Whether a pixel's own fragment is less than half a pixel beside the line, or within `room` of its end. */
bool is_on_line(sight s, float room) {
    float cosine = fragments[s.from - 1u].way.w, sine = uintBitsToFloat(fragments[s.from - 1u].more.y);
    float x = s.away.x, y = s.away.y;
    float across = 0.5 * (x * x + y * y - cosine * (x * x - y * y) - 2.0 * sine * x * y);
    return across <= HALF * HALF || abs(fragments[s.from - 1u].shape.w) <= room;
}

/* What a pixel shows of a fragment, which can be its own. */
sample_of_line complete(sight s, vec3 ray, bool own) {
    float size = float(1 << lattice.x), depth = depth_of(s.from);
    sample_of_line made = sample_of_line(depth, vec3(0.0), fragments[s.from - 1u].more.z);
    bool meets = s.q <= 1.0;
    if (meets || own || tubes && s.along <= BESIDE * BESIDE * size * size) {
        meeting m = meet(s, ray);
        if (tubes)
            meets = complete_tube(s, m, made);
        else
            meet_plane(m, made);
    }
    if (!(meets || own && is_on_line(s, tubes ? 0.0 : 1.0))) made.depth = INFINITE;
    return made;
}

/* Where the ray of a pixel enters the ball around a fragment; INFINITE: nowhere. */
float ball_depth(vec2 at, vec3 ray, uint number) {
    sample_of_line made = sample_of_line(depth_of(number), vec3(0.0), 0u);
    meeting m = meet(sight(number, at - spot_of(number), 0.0, 0.0), ray);
    return meet_end(m, 0.0, made) ? made.depth : INFINITE;
}

/* Goes on along a tube while the ray enters the ball around the next fragment sooner. */
void go_to_front(vec2 at, vec3 ray, inout sight s) {
    uint from = s.from, best = from;
    float least = FRONT * fragments[from - 1u].along.w, depth = ball_depth(at, ray, from);
    int steps = int(fragments[from - 1u].ellipse.w) + 8 * finer_pixels() + 2;
    for (; steps > 0; steps--, from = best) {
        uint links = fragments[from - 1u].more.w;
        for (uint k = 0u; k < 8u; k++) {
            if ((links >> k & 1u) == 0u) continue;
            uint number = linked(from, k);
            if (depth_of(number) >= depth_of(from)) continue;
            float other = ball_depth(at, ray, number);
            if (!(other < depth - least)) continue;
            depth = other;
            best = number;
        }
        if (best == from) break;
    }
    if (best != s.from) s = see(best, at);
}

/* Adds what a pixel shows of a fragment, if it is nearer. */
void add_sample(vec2 at, vec3 ray, sight s, bool own, inout sample_of_line nearest) {
    sample_of_line made = complete(s, ray, own);
    meeting m = meet(s, ray);
    bool there = made.depth < INFINITE && (is_thin(s.from) ||
                 abs(along_tangent(m, s.from, made.depth)) <= ASIDE * m.radius);
    if (tubes && !there) {
        uint number = s.from;
        go_to_front(at, ray, s);
        sample_of_line moved = made;
        if (s.from != number) moved = complete(s, ray, false);
        if (moved.depth < INFINITE) made = moved;
    }
    if (made.depth < nearest.depth) nearest = made;
}

void main() {
    ivec2 sample_at = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(sample_at, picture.xy))) return;
    ivec2 at = sample_at - lattice.zw;
    uint corner[CORNERS];
    int corners = read_corners(at, corner), count = 0;
    if (corners == 0) return;
    vec2 centre = vec2(at) + 0.5;
    vec3 ray = vec3((centre + vec2(0.0, lattice.y) - sight_line.xy) * sight_line.z, 1.0);
    sight found[CANDIDATES];
    sample_of_line nearest = sample_of_line(INFINITE, vec3(0.0), 0u);
    uint own = lattice.x == 0 ? base_number(at) : 0u;
    if (own != 0u) {
        found[count++] = see(own, centre);
        add_sample(centre, ray, found[0], true, nearest);
    }
    for (int k = 0; k < corners; k++) {
        sight s;
        if (depth_of(corner[k]) - interval_of(corner[k]) > nearest.depth) continue; /* hidden */
        if (!find_nearest(centre, 0.0, found, count, corner[k], s)) continue;
        found[count++] = s;
        add_sample(centre, ray, s, false, nearest);
    }
    if (!put_sample(sample_at, nearest.depth, nearest.normal) || picture.w == 0) return;
    uint color = nearest.color;
    put_color(sample_at, uvec3(color, color >> 8, color >> 16) & 255u);
    if (picture.w == 1) samples[sample_at.y * picture.x + sample_at.x + 5 * picture.x * picture.y] = 0u;
}
