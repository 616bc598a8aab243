/* splats_layers.comp: the layers of translucent splats in the samples of a tile (render/splats/images.c;
 * Zhang and Pajarola 2006, algorithms 2 and 3). A tile has a list of the discs that it may show, group by
 * group. All samples of a tile read the same discs, each keeps its own picture, and nothing depends on the
 * order of threads.
 *
 * KIND 0: the mean of the groups' pictures. The discs of a group are listed back to front. KIND 1: the
 * nearest layer, of discs that are not enlarged. */
#ifndef KIND
#define KIND 0
#endif

layout(local_size_x = ISO_GL_SPLAT_TILE, local_size_y = ISO_GL_SPLAT_TILE) in;
layout(std430, binding = ISO_GL_LOOKS) readonly buffer look_buffer { vec4 looks[]; };
layout(std430, binding = ISO_GL_TILE_STARTS) readonly buffer start_buffer { uint starts[]; };
layout(std430, binding = ISO_GL_TILE_DISCS) readonly buffer order_buffer { uint order[]; };
/* Only discs behind the first depth and before the second one are drawn. */
layout(std430, binding = ISO_GL_LAYER_BOUNDS) buffer bound_buffer { vec2 bounds[]; };
/* KIND 0: colour, opacity, depth. KIND 1: sums of normals, weight (0: no layer), colours; depth. */
layout(std430, binding = ISO_GL_LAYERS) writeonly buffer layer_buffer { vec4 found[]; };

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
#else
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
#endif

void main() {
    ivec2 at = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(at, picture.xy))) return;
    uint tile = gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x;
    find_layer(starts[tile], starts[tile + 1u], centre_of(at), at.y * picture.x + at.x);
}
