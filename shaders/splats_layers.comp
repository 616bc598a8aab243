/* splats_layers.comp: the layers of translucent splats in the samples of a tile (render/groups/images.c;
 * Zhang and Pajarola 2006, algorithms 2 and 3). A tile has a list of the discs that it may show, group by
 * group. All samples of a tile read the same discs, each keeps its own picture, and nothing depends on the
 * order of threads.
 *
 * KIND 0: the mean of the groups' pictures. The discs of a group are listed back to front. KIND 1: the
 * nearest layer, of discs that are not enlarged.
 *
 * All layers, in order (render/groups/sorted.c), of discs that are listed front to back: KIND 2 counts the
 * discs that each sample's ray hits; KIND 3 lists them, sorts each list and merges it into layers. */
#ifndef KIND
#define KIND 0
#endif

layout(local_size_x = ISO_GL_SPLAT_TILE, local_size_y = ISO_GL_SPLAT_TILE) in;
layout(std430, binding = ISO_GL_LOOKS) readonly buffer look_buffer { vec4 looks[]; };
layout(std430, binding = ISO_GL_TILE_STARTS) readonly buffer start_buffer { uint starts[]; };
layout(std430, binding = ISO_GL_TILE_DISCS) readonly buffer order_buffer { uint order[]; };
/* Only discs behind the first depth and before the second one are drawn. */
layout(std430, binding = ISO_GL_LAYER_BOUNDS) buffer bound_buffer { vec2 bounds[]; };
/* KIND 0: colour, opacity, depth. KIND 1 and 3: sums of normals, weight (0: no layer), colours; depth.
 * KIND 2: numbers of hits. */
#if KIND == 2
layout(std430, binding = ISO_GL_LAYERS) writeonly buffer layer_buffer { uint found[]; };
#else
layout(std430, binding = ISO_GL_LAYERS) writeonly buffer layer_buffer { vec4 found[]; };
#endif

int group_of(splat s) {
    return int(s.paint & 255u);
}

#if KIND == 0
/* The picture of the group that is drawn, and the sums of the finished ones. */
struct picture_of_group {
    vec4 color; /* premultiplied colour, share of the light that passes */
    float bin;  /* bin of depth of the last disc */
};
struct picture_sums {
    vec4 all, whole; /* of all groups; of those that have the front layer */
    int count, whole_count;
};

void finish(picture_of_group image, float front, inout picture_sums sums) {
    sums.all += image.color;
    sums.count++;
    if (image.bin > front) return;
    sums.whole += image.color;
    sums.whole_count++;
}

bool covers(uint number, splat s, vec2 at, vec2 bound, out vec3 hit) {
    hit = intersect(s, at);
    precise float nearest = bound.x + looks[2u * number + 1u].x;
    return hit.y < 1.0 && hit.x > nearest && hit.x < bound.y;
}

float bin_of(float depth) {
    precise float bin = depth / layers.x;
    return floor(bin);
}

void composite(inout picture_of_group image, vec4 shade, float bin) {
    if (!(bin < image.bin)) return;
    image.bin = bin;
    image.color.rgb = shade.a * shade.rgb + (1.0 - shade.a) * image.color.rgb;
    image.color.a *= 1.0 - shade.a;
}

picture_sums draw_groups(uint first, uint end, vec2 at, vec2 bound, float front) {
    picture_sums sums = picture_sums(vec4(0.0), vec4(0.0), 0, 0);
    picture_of_group image = picture_of_group(vec4(0.0, 0.0, 0.0, 1.0), ISO_GL_NOWHERE);
    int group = -1;
    for (uint i = first; i < end; i++) {
        splat s = splats[order[i]];
        vec3 hit;
        if (group_of(s) != group) {
            if (group >= 0) finish(image, front, sums);
            image = picture_of_group(vec4(0.0, 0.0, 0.0, 1.0), ISO_GL_NOWHERE);
            group = group_of(s);
        }
        if (covers(order[i], s, at, bound, hit)) composite(image, looks[2u * order[i]], bin_of(hit.x));
    }
    if (group >= 0) finish(image, front, sums);
    return sums;
}

float find_front(uint first, uint end, vec2 at, vec2 bound) {
    float front = ISO_GL_NOWHERE;
    for (uint i = first; i < end; i++) {
        vec3 hit;
        if (covers(order[i], splats[order[i]], at, bound, hit)) front = min(front, hit.x);
    }
    return front;
}

void find_layer(uint first, uint end, vec2 at, int sample_number) {
    vec2 bound = bounds[sample_number];
    float front = find_front(first, end, at, bound);
    found[2 * sample_number] = vec4(0.0);
    if (!(front < ISO_GL_NOWHERE)) return;
    picture_sums sums = draw_groups(first, end, at, bound, bin_of(front) + 1.0);
    sums.all.a += float(counts.y - sums.count); /* groups without discs in this tile let all light pass */
    bool leave_out = 2 * sums.whole_count > counts.y;
    vec4 mean = leave_out ? sums.whole / float(sums.whole_count) : sums.all / float(counts.y);
    float opacity = 1.0 - mean.a;
    if (!(opacity > 0.0)) return;
    found[2 * sample_number] = vec4(mean.rgb / opacity, opacity);
    found[2 * sample_number + 1] = vec4(front, 0.0, 0.0, 0.0);
}
#elif KIND == 1
/* For each group the disc with the smallest key. */
uint best[ISO_GL_MOST_GROUPS];

void find_best(uint first, uint end, vec2 at, float limit) {
    float least = ISO_GL_NOWHERE;
    int group = -1;
    for (int k = 0; k < counts.y; k++) best[k] = ISO_GL_KEY_NONE;
    for (uint i = first; i < end; i++) {
        splat s = splats[order[i]];
        if (group_of(s) != group) least = ISO_GL_NOWHERE;
        group = group_of(s);
        vec3 hit = intersect(s, at);
        precise float key = hit.x + thickness_of(s) * hit.y;
        if (!(hit.y < 1.0 && hit.x < limit && key < least)) continue;
        least = key;
        best[group] = order[i];
    }
}

vec3 find_front(vec2 at) {
    vec3 front = vec3(ISO_GL_NOWHERE);
    for (int k = 0; k < counts.y; k++) {
        if (best[k] == ISO_GL_KEY_NONE) continue;
        vec3 hit = intersect(splats[best[k]], at);
        if (hit.x < front.x) front = hit;
    }
    return front;
}

void find_layer(uint first, uint end, vec2 at, int sample_number) {
    find_best(first, end, at, bounds[sample_number].y);
    vec3 front = find_front(at);
    vec4 normal = vec4(0.0), color = vec4(0.0);
    for (int k = 0; k < counts.y && front.x < ISO_GL_NOWHERE; k++) {
        if (best[k] == ISO_GL_KEY_NONE) continue;
        splat s = splats[best[k]];
        vec3 hit = intersect(s, at);
        if (hit.z != front.z || hit.x > front.x + thickness_of(s)) continue;
        float w = weight_of(hit.y);
        normal += w * vec4(s.normal_x, s.normal_y, s.normal_z, 1.0);
        color += w * vec4(vec3(uvec3(s.paint >> 8, s.paint >> 16, s.paint >> 24) & 255u), hit.x);
    }
    found[2 * sample_number] = normal;
    found[2 * sample_number + 1] = color;
    if (front.x < ISO_GL_NOWHERE) bounds[sample_number].x = front.x;
}
#elif KIND == 2
void find_layer(uint first, uint end, vec2 at, int sample_number) {
    uint count = 0u;
    for (uint i = first; i < end; i++)
        if (intersect(splats[order[i]], at).y < 1.0) count++;
    found[sample_number] = count;
}
#else
/* The list of a sample begins at the number that bounds has for it, and so do its layers. */
layout(std430, binding = ISO_GL_HITS) buffer hit_buffer { uvec4 hits[]; }; /* depth, e, disc, away */

/* Lists the hits by depth, then by number; discs arrive nearly in order. Returns the end of the list. */
uint list_hits(uint first, uint end, vec2 at, uint begin) {
    uint last = begin;
    for (uint i = first; i < end; i++) {
        vec3 hit = intersect(splats[order[i]], at);
        if (!(hit.y < 1.0)) continue;
        uint place = last++;
        for (; place > begin; place--) {
            uvec4 before = hits[place - 1u];
            float depth = uintBitsToFloat(before.x);
            if (depth < hit.x || (depth == hit.x && before.z < order[i])) break;
            hits[place] = before;
        }
        hits[place] = uvec4(floatBitsToUint(hit.x), floatBitsToUint(hit.y), order[i], uint(hit.z));
    }
    return last;
}

/* The next layer of a side: sums of normals and weights; of colours and depths. */
struct side {
    uint at;
    vec4 normal, color;
};

/* Finds the next layer of the side `away` in the list up to `end`; its weight is 0 if there is none. */
void find_next(inout side s, uint end, uint away) {
    float front = 0.0;
    s.normal = s.color = vec4(0.0);
    for (; s.at < end; s.at++) {
        uvec4 hit = hits[s.at];
        if (hit.w != away) continue;
        splat disc = splats[hit.z];
        float depth = uintBitsToFloat(hit.x), w = weight_of(uintBitsToFloat(hit.y));
        if (s.normal.w > 0.0 && depth > front + thickness_of(disc)) return;
        if (s.normal.w == 0.0) front = depth;
        s.normal += w * vec4(disc.normal_x, disc.normal_y, disc.normal_z, 1.0);
        s.color += w * vec4(vec3(uvec3(disc.paint >> 8, disc.paint >> 16, disc.paint >> 24) & 255u), depth);
    }
}

float mean_depth(side s) {
    return s.normal.w > 0.0 ? s.color.w / s.normal.w : ISO_GL_NOWHERE;
}

void find_layer(uint first, uint end, vec2 at, int sample_number) {
    uint begin = floatBitsToUint(bounds[sample_number].x), to = begin;
    uint list_end = list_hits(first, end, at, begin);
    side facing = side(begin, vec4(0.0), vec4(0.0)), away = facing;
    find_next(facing, list_end, 0u);
    find_next(away, list_end, 1u);
    while (facing.normal.w > 0.0 || away.normal.w > 0.0) {
        bool behind = mean_depth(away) < mean_depth(facing);
        found[2u * to] = behind ? away.normal : facing.normal;
        found[2u * to + 1u] = behind ? away.color : facing.color;
        to++;
        if (behind)
            find_next(away, list_end, 1u);
        else
            find_next(facing, list_end, 0u);
    }
    for (; to < list_end; to++) found[2u * to] = vec4(0.0);
}
#endif

void main() {
    ivec2 at = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(at, picture.xy))) return;
    uint tile = gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x;
    find_layer(starts[tile], starts[tile + 1u], centre_of(at), at.y * picture.x + at.x);
}
