/* pullpush_lines.glsl: the fragments of lines in pull-push (Marroquim, Kraus and Cavalcanti 2008, section 4),
 * and how passes go along a line from one to the next: render/pullpush/line_levels.c in floats. Fragments and
 * their links come from the cpu. Numbers of fragments count from 1; 0: none. */
struct line_fragment {
    ISO_GL_LINE_FIELDS
};

layout(std140, binding = ISO_GL_PULLPUSH) uniform lines_block { ISO_GL_LINES_FIELDS };
layout(std430, binding = ISO_GL_LINE_FRAGMENTS) readonly buffer fragment_buffer {
    line_fragment fragments[];
};
/* The numbers in the pixels of the base level; and in those of all levels above 0 what they show, and what
 * lies behind it. */
layout(std430, binding = ISO_GL_LINE_INDEX) buffer index_buffer { uint index_of_base[]; };
layout(std430, binding = ISO_GL_LINE_PLACES) buffer place_buffer { uvec2 places[]; };
layout(location = ISO_GL_LEVEL) uniform int level; /* that a pass pulls into, or pushes from */

#define INFINITE uintBitsToFloat(0x7F800000u) /* glslang takes it for no constant expression */
/* The numbers of line_levels.c. */
const float MARGIN = 0.75, BESIDE = 1.5, BEND = 0.5, NEAREST = 0.75;
const int CORNERS = 8, CANDIDATES = 10;

bool orthographic = flags.x != 0u, tubes = flags.y != 0u;

bool is_inside(int number, ivec2 at) {
    return all(greaterThanEqual(at, ivec2(0))) && all(lessThan(at, levels[number].xy));
}

int place(int number, ivec2 at) {
    return levels[number].z + at.y * levels[number].x + at.x;
}

uint base_number(ivec2 at) {
    return is_inside(lattice.x, at) ? index_of_base[at.y * levels[lattice.x].x + at.x] : 0u;
}

/* What a pixel of a level above 0 shows, and what lies behind it. */
uvec2 numbers_at(int number, ivec2 at) {
    return is_inside(number, at) ? places[place(number, at)] : uvec2(0u);
}

float depth_of(uint number) {
    return fragments[number - 1u].spot.z;
}

float interval_of(uint number) {
    return fragments[number - 1u].spot.w;
}

vec2 spot_of(uint number) {
    return fragments[number - 1u].spot.xy;
}

ivec2 pixel_of(uint number) {
    uint bits = fragments[number - 1u].more.x;
    return ivec2(bits & 0xFFFFu, bits >> 16);
}

bool is_thin(uint number) {
    return (fragments[number - 1u].more.w & 0x100u) != 0u;
}

uint line_of(uint number) {
    return fragments[number - 1u].more.w >> 16;
}

/* The fragment that link k of another one leads to. */
uint linked(uint from, uint k) {
    int cell = int(k) + int(k > 3u);
    return base_number(pixel_of(from) + ivec2(cell % 3, cell / 3) - 1);
}

float form_at(vec3 form, vec2 d) {
    return (form.x * d.x + 2.0 * form.y * d.y) * d.x + form.z * d.y * d.y;
}

/* A fragment as a pixel's centre sees it. */
struct sight {
    uint from;
    vec2 away;   /* from its place to the pixel's centre, pixels of level 0 */
    float q;     /* less than 1 in its ellipse */
    float along; /* square of the distance from the pixel's centre along the line, pixels^2 */
};

sight see(uint number, vec2 at) {
    vec2 away = at - spot_of(number);
    return sight(number, away, form_at(fragments[number - 1u].ellipse.xyz, away),
                 form_at(fragments[number - 1u].along.xyz, away));
}

/* Pixels of the base level to a side of one of the level below `level`. */
int finer_pixels() {
    return 1 << max(level - 1 - lattice.x, 0);
}

/* Whether two fragments that are near each other in the picture continue each other. */
bool follow(uint a, uint b) {
    float between = abs(depth_of(a) - depth_of(b));
    return line_of(a) == line_of(b) && (between <= interval_of(a) || between <= interval_of(b));
}

bool is_same_line(uint a, uint b, int window) {
    ivec2 between = abs(pixel_of(a) - pixel_of(b));
    return max(between.x, between.y) <= window && line_of(a) == line_of(b) &&
           abs(depth_of(a) - depth_of(b)) <= interval_of(a);
}

/* Of a fragment and those that `links` links it to, the nearest. */
uint step_along(vec2 at, uint from, uint links, inout float q, out uint way) {
    uint best = from;
    way = 0u;
    for (uint k = 0u; k < 8u; k++) {
        if ((links >> k & 1u) == 0u) continue;
        uint number = linked(from, k);
        float other = form_at(fragments[number - 1u].ellipse.xyz, at - spot_of(number));
        if (other >= q) continue;
        q = other;
        way = k;
        best = number;
    }
    return best;
}

/* The same, with those that are two pixels away. */
uint jump_along(vec2 at, uint from, inout float q) {
    uint best = from;
    ivec2 pixel = pixel_of(from);
    for (int dy = -2; dy <= 2; dy++)
        for (int dx = -2; dx <= 2; dx += abs(dy) == 2 ? 1 : 4) {
            uint number = base_number(pixel + ivec2(dx, dy));
            if (number == 0u) continue;
            float other = form_at(fragments[number - 1u].ellipse.xyz, at - spot_of(number));
            if (other >= q || !follow(from, number)) continue;
            q = other;
            best = number;
        }
    return best;
}

/* Goes along the line to the fragment that is nearest to the pixel's centre, or to one that is near
 * enough. */
void go_along(vec2 at, float enough, inout sight s) {
    uint number = s.from, back = 0u;
    float q = s.q, along = s.along, size = float(1 << lattice.x), beside = BESIDE * BESIDE * size * size;
    for (int steps = 8 * finer_pixels() + 2; steps > 0 && along > enough; steps--) {
        uint way;
        uint best = step_along(at, number, fragments[number - 1u].more.w & 0xFFu & ~back, q, way);
        back = 0x80u >> way;
        if (best == number && !(enough > 0.0) && along > beside) {
            best = jump_along(at, number, q);
            back = 0u;
        }
        if (best == number) break;
        number = best;
        along = form_at(fragments[number - 1u].along.xyz, at - spot_of(number));
    }
    s = sight(number, at - spot_of(number), q, along);
}

/* The fragments of the corners of the cell that a pixel of the level below lies in, one of each line, the
 * front ones first. Returns their number: where there is no front one, there is none. */
int read_corners(ivec2 at, out uint found[CORNERS]) {
    ivec2 cell = at + 1 >> 1;
    uvec2 corner[4];
    uint any = 0u;
    int count = 0;
    for (int k = 0; k < 4; k++) {
        corner[k] = numbers_at(level, cell - ivec2(k & 1, k >> 1));
        any |= corner[k].x;
    }
    if (any == 0u) return 0;
    for (int k = 0; k < CORNERS; k++) {
        uint number = k < 4 ? corner[k].x : corner[k - 4].y;
        bool known = number == 0u;
        for (int i = 0; i < count && !known; i++)
            known = is_same_line(number, found[i], 2 * finer_pixels());
        if (!known) found[count++] = number;
    }
    return count;
}

/* Goes from a corner's fragment to the one of its line that is nearest to `at`. False: it is one of those
 * that were found before, or does not reach within `margin`. */
bool find_nearest(vec2 at, float margin, sight found[CANDIDATES], int count, uint number, out sight s) {
    float pixel = float(1 << lattice.x), finer = float(finer_pixels());
    for (int i = 0; i < count; i++)
        if (is_same_line(number, found[i].from, 4 * finer_pixels())) return false;
    s = see(number, at);
    float reach = fragments[number - 1u].ellipse.w + margin + BEND * finer * pixel;
    if (!(dot(s.away, s.away) - s.along <= reach * reach)) return false;
    float near = NEAREST * pixel * finer;
    float enough = is_thin(number) || level == 1 && tubes ? near * near : 0.0;
    if (s.along > enough) go_along(at, enough, s);
    return true;
}
