/* shapes_near.vert: the box of a shape whose rays are traced in double precision: an instance of four
 * vertices each. */
flat out int number;

void main() {
    number = gl_InstanceID;
    vec4 box = near_shapes[number].box;
    vec2 at = vec2((gl_VertexID & 1) != 0 ? box.z : box.x, (gl_VertexID & 2) != 0 ? box.w : box.y);
    gl_Position = vec4(2.0 * at / screen.xy - 1.0, buffer_depth(near_shapes[number].front.x), 1.0);
}
