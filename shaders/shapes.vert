/* shapes.vert: places a shape in the picture: its fields, and its exact box as a quad at the depth of the
 * shape's front. Vertex number 4 i + k is corner k of shape i. Positions are relative to an origin, that of
 * the shape's block or the shape itself, which the cpu has placed in double precision
 * (render/shapes/frame.h). */
layout(location = ISO_GL_SHAPE_PIXEL) in vec4 origin_pixel; /* column, row; place in that pixel */
layout(location = ISO_GL_SHAPE_RAY) in vec4 origin_ray;     /* depth, and what the float leaves; slopes */
layout(location = ISO_GL_SHAPE_FROM) in vec3 from;          /* what positions are relative to */

layout(std430, binding = ISO_GL_SHAPES) readonly buffer shape_buffer { vec4 shapes[]; };
layout(std430, binding = ISO_GL_MARKS) readonly buffer mark_buffer { uint numbers[]; };
#if KIND == ISO_GL_TUBES || KIND == ISO_GL_RIBBONS
layout(std430, binding = ISO_GL_LINE_COLORS) readonly buffer color_buffer { uint line_colors[]; };
#endif

#define SOLID_VALUES 7                                 /* of each solid: shapes_upload.c */
#define VERTEX_VALUES (KIND == ISO_GL_RIBBONS ? 2 : 1) /* of each vertex */

out shape_values { SHAPE_VALUES; };

vec3 turned(vec3 v) {
    return vec3(dot(turn_x.xyz, v), dot(turn_y.xyz, v), dot(turn_z.xyz, v));
}

/* Sets the pixel of the shape's centre, which is given relative to the origin's pixel. */
void set_place(vec2 at) {
    vec2 whole = floor(at);
    place = vec4(origin_pixel.xy + whole, at - whole);
}

#if KIND == ISO_GL_SPHERES
void main() {
    int shape = gl_VertexID >> 2;
    vec4 sphere = shapes[shape];
    end e = end_of(origin_pixel, origin_ray, turned(sphere.xyz - from), sphere.w);
    set_place(e.at);
    fields[0] = vec4(e.z, e.radius, 0.0, 0.0);
    marks = uvec4(numbers[2 * shape], uvec2(numbers[2 * shape + 1]), 0u);
    gl_Position = corner_of(e.reach + origin_pixel.xyxy, gl_VertexID & 3, sphere_nearest(e.z, e.radius));
}
#endif

#if KIND == ISO_GL_TUBES
/* E1 is perpendicular to the axis and to the ray of the first vertex; returns the ray's component along
 * E2. */
float make_frame(vec3 axis, vec2 u, out vec3 e1, out vec3 e2) {
    vec3 product = cross(axis, vec3(u, 1.0)) * -1.0;
    float size = length(product);
    bool end_on = size < 1e-6;
    if (end_on) product = abs(axis.x) < 0.8 ? vec3(0.0, -axis.z, axis.y) : vec3(axis.z, 0.0, -axis.x);
    e1 = product / length(product);
    /* Where the ray runs nearly along the axis, rounding has tilted E1: make it perpendicular again. */
    e1 -= dot(e1, axis) * axis;
    e2 = cross(axis, e1);
    return end_on ? dot(vec3(u, 1.0), e2) : size;
}

/* path: from a to b. */
void set_fields(end a, end b, vec3 path) {
    float size = length(path), sine = size > 0.0 ? (b.radius - a.radius) / size : 0.0;
    vec3 axis = size > 0.0 ? path / size : vec3(1.0, 0.0, 0.0), e1, e2;
    float along = dot(vec3(a.u, 1.0), axis), k = a.z * rays.x + rays.z, across = make_frame(axis, a.u, e1, e2);
    vec2 last = b.at - a.at;
    fields[0] = vec4(a.z, a.radius, b.z, b.radius);
    fields[1] = vec4(last, e1.xy);
    fields[2] = vec4(e2.xy, axis.xy);
    fields[3] = vec4(across, along, size, sine);
    fields[4] = vec4((1.0 - sine) * (1.0 + sine), a.radius * rays.x - sine * (k * along), 0.0, 0.0);
}
#endif

#if KIND == ISO_GL_RIBBONS
/* A vector with its components across the ray that has the slopes u. */
vec3 skewed(vec2 u, vec3 v) {
    return vec3(v.xy - u * v.z, v.z);
}
#endif

#if KIND == ISO_GL_TUBES
/* Where one sphere holds the other, the larger is drawn alone. */
uint place_segment(int first, end a, end b, vec3 path, uint flags) {
    float taper = b.radius - a.radius;
    if (dot(path, path) <= taper * taper) {
        flags = taper > 0.0 ? ISO_GL_TUBE_SECOND_ONLY : 0u;
        if (taper > 0.0)
            a = b;
        else
            b = a;
        path = vec3(0.0);
    }
    set_place(a.at);
    set_fields(a, b, path);
    return flags;
}
#endif

#if KIND == ISO_GL_RIBBONS
uint place_segment(int first, end a, end b, vec3 path, uint flags) {
    set_place(a.at);
    fields[0] = vec4(a.z, skewed(a.u, path));
    fields[1] = vec4(a.radius * skewed(a.u, turned(shapes[VERTEX_VALUES * first + 1].xyz)), 0.0);
    fields[2] = vec4(b.radius * skewed(a.u, turned(shapes[VERTEX_VALUES * first + 3].xyz)), 0.0);
    return 0u;
}
#endif

#if KIND == ISO_GL_TUBES || KIND == ISO_GL_RIBBONS
void main() {
    uint word = numbers[gl_VertexID >> 2];
    int first = int(word & 0x3FFFFFFFu);
    vec4 from_vertex = shapes[VERTEX_VALUES * first], to_vertex = shapes[VERTEX_VALUES * (first + 1)];
    vec3 offset = turned(from_vertex.xyz - from), path = turned(to_vertex.xyz - from_vertex.xyz);
    end a = end_of(origin_pixel, origin_ray, offset, from_vertex.w),
        b = end_of(origin_pixel, origin_ray, offset + path, to_vertex.w);
    uint flags = place_segment(first, a, b, path, word >> 30);
    if (a.widened || b.widened) flags |= ISO_GL_TUBE_WIDENED;
    marks = uvec4(uint(first), 0u, 0u, flags);
    if (set.y != 0) marks.yz = uvec2(line_colors[first], line_colors[first + 1]);
    gl_Position = corner_of(both(a.reach, b.reach) + origin_pixel.xyxy, gl_VertexID & 3,
                            min(sphere_nearest(a.z, a.radius), sphere_nearest(b.z, b.radius)));
}
#endif

#if KIND == ISO_GL_SOLIDS
void main() {
    int shape = gl_VertexID >> 2, at = SOLID_VALUES * shape;
    vec4 middle = shapes[at];
    end e = end_of(origin_pixel, origin_ray, turned(middle.xyz - from), 0.0);
    mat3 axes = mat3(turned(shapes[at + 1].xyz), turned(shapes[at + 2].xyz), turned(shapes[at + 3].xyz));
    vec3 x, y, ray;
    for (int i = 0; i < 3; i++) {
        vec3 row = turned(shapes[at + 4 + i].xyz); /* of the map's inverse */
        x[i] = row.x;
        y[i] = row.y;
        ray[i] = rays.y == 0.0 ? row.z : dot(vec3(e.u, 1.0), row);
    }
    set_place(e.at);
    fields[0] = vec4(e.z, x);
    fields[1] = vec4(y, 0.0);
    fields[2] = vec4(ray, 0.0);
    marks = uvec4(numbers[2 * shape], uvec2(numbers[2 * shape + 1]), 0u);
    solid_box box = solid_box_of(GLYPH, vec3(e.u, e.z), axes);
    gl_Position = corner_of(e.at.xyxy + origin_pixel.xyxy + box.pixels, gl_VertexID & 3,
                            box.front - 1e-5 * middle.w - 1e-6 * abs(box.front));
}
#endif
