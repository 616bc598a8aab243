/* points.frag: keeps the pixels of a point's square whose centres lie in its disc, and the pixel that
 * contains the disc's centre. */
layout(std140, binding = ISO_GL_DRAW) uniform draw_block { ISO_GL_DRAW_FIELDS };

flat in vec4 normal_depth;
flat in vec3 disc;
layout(location = ISO_GL_NORMAL_DEPTH) out vec4 out_normal_depth;
layout(location = ISO_GL_SURFACE) out uint out_surface;

void main() {
    vec2 offset = gl_FragCoord.xy - disc.xy;
    bool own = floor(gl_FragCoord.xy) == floor(disc.xy);
    if (dot(offset, offset) > disc.z * disc.z && !own) discard;
    out_normal_depth = normal_depth;
    out_surface = flags.x;
}
