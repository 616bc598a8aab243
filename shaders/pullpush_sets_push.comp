/* pullpush_sets_push.comp: push of several sets into a level, 1 or higher, from the one above. */
layout(local_size_x = ISO_GL_TILE, local_size_y = ISO_GL_TILE) in;

void main() {
    ivec2 at = ivec2(gl_GlobalInvocationID.xy);
    if (!is_inside(level, at)) return;
    mixture m = mixed(level + 1, at, fetched(level, at), false);
    if (m.made) store(level, at, m.value, m.hidden);
}
