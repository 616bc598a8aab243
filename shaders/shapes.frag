/* shapes.frag: where the ray of a pixel first meets a shape: depth, normal, colour and numbers. The
 * shape's quad lies at its front, so that the driver can still reject hidden pixels before this shader is
 * executed. */
in shape_values { SHAPE_VALUES; };
layout(depth_less) out float gl_FragDepth;
layout(location = ISO_GL_NORMAL_DEPTH) out vec4 out_normal_depth;
layout(location = ISO_GL_IDS) out uvec2 out_ids;

/* The pixel relative to the shape's centre, whose ray's slopes are `centre`. */
pixel pixel_at(vec2 centre) {
    vec2 offset = (floor(gl_FragCoord.xy) - place.xy) + 0.5 - place.zw;
    return pixel(offset, centre + offset * rays.y, fields[0].x * rays.x + rays.z, rays.y);
}

#if KIND == ISO_GL_SPHERES
bool sees(pixel p, vec2 centre, out sight s) {
    float radius = fields[0].y, dd, d = sphere_discriminant(p, radius, dd), root = sphere_root(p, d, dd);
    s = sight(fields[0].x + root, vec3(p.k * p.offset + root * p.ray, root) / radius, 0.0);
    return d >= 0.0;
}
#endif

#if KIND == ISO_GL_TUBES
bool sees(pixel p, vec2 centre, out sight s) {
    return sees_tube(p, centre, tube_of(fields), marks.w, s);
}
#endif

#if KIND == ISO_GL_RIBBONS
bool sees(pixel p, vec2 centre, out sight s) {
    return sees_ribbon(p, centre, ribbon_of(fields), s);
}
#endif

#if KIND == ISO_GL_SOLIDS
bool sees(pixel p, vec2 centre, out sight s) {
    return sees_solid(p, centre, solid_of(fields), GLYPH, s);
}
#endif

void main() {
    vec2 centre = (place.xy + (place.zw - lens.xy)) * rays.y;
    sight s;
    if (!sees(pixel_at(centre), centre, s)) discard;
    gl_FragDepth = min(buffer_depth(s.depth), gl_FragCoord.z);
    out_normal_depth = vec4(s.normal, s.depth);
    out_ids = ids_of(marks, s.along);
}
