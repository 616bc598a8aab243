/* mesh.frag: writes the interpolated depth and normal of a triangle's pixel. OpenGL interpolates with
 * perspective correction. */
layout(std140, binding = ISO_GL_DRAW) uniform draw_block { ISO_GL_DRAW_FIELDS };

smooth in vec4 normal_depth;
layout(location = ISO_GL_NORMAL_DEPTH) out vec4 out_normal_depth;
layout(location = ISO_GL_SURFACE) out uint out_surface;

void main() {
    float size = length(normal_depth.xyz);
    out_normal_depth = vec4(size > 0.0 ? normal_depth.xyz / size : vec3(0.0, 0.0, -1.0), normal_depth.w);
    out_surface = flags.x;
}
