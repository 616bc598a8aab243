/* mesh.vert: projects the vertices of triangles. Positions are computed in doubles: a vertex that
 * neighbouring bricks share must get the same bits from both, otherwise gaps would show. Snapping is that
 * of render/raster/mesh.c. */
layout(std140, binding = ISO_GL_DRAW) uniform draw_block { ISO_GL_DRAW_FIELDS };

layout(location = ISO_GL_POSITION) in vec3 position;
layout(location = ISO_GL_NORMAL) in vec3 normal;
layout(location = ISO_GL_BRICK) in ivec3 brick;

smooth out vec4 normal_depth;

/* Pixels rounded to 1 / ISO_GL_SUBPIXEL. */
dvec2 snapped(dvec2 at) {
    return floor(at * ISO_GL_SUBPIXEL + 0.5) / ISO_GL_SUBPIXEL;
}

void main() {
    dvec4 index = dvec4(dvec3(brick) * ISO_BRICK + dvec3(position), 1.0);
    precise dvec3 at = dvec3(dot(row_x, index), dot(row_y, index), dot(row_z, index));
    vec3 n = vec3(dot(normal_x.xyz, normal), dot(normal_y.xyz, normal), dot(normal_z.xyz, normal));
    float size = length(n);
    normal_depth = vec4(size > 0.0 ? n / size : vec3(0.0, 0.0, -1.0), float(at.z));

    bool orthographic = flags.y != 0u;
    dvec2 across = 2.0 / dvec2(screen.xy), corner = across * (pixels.yz + screen.z) - 1.0;
    if (orthographic) {
        dvec2 center = snapped(at.xy * pixels.x);
        gl_Position = vec4(vec2(across * center + corner), (depths.x - float(at.z)) * depths.y, 1.0);
    } else if (at.z >= pixels.w) {
        dvec2 center = snapped(at.xy * (pixels.x / at.z));
        gl_Position = vec4(vec2((across * center + corner) * at.z), float(pixels.w), float(at.z));
    } else { /* nearer than the near plane, at which OpenGL clips the triangle: no need to snap */
        gl_Position = vec4(vec2(across * at.xy * pixels.x + corner * at.z), float(pixels.w), float(at.z));
    }
}
