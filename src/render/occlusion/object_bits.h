/* object_bits: what lines, glyphs and meshes fill of a lattice of bits, so that they block light as solids of
 * volumes do (render/occlusion/solid_bits.h). What is thinner than a voxel fills the voxels that it passes.
 */
#ifndef ISO_RENDER_OCCLUSION_OBJECT_BITS_H
#define ISO_RENDER_OCCLUSION_OBJECT_BITS_H

#include "base/parallel.h"
#include "render/occlusion/solid_bits.h"
#include "render/shapes/shapes.h"

/* Sets the bits of voxels in the solids of glyphs, in tubes and ribbons, but for those that `clip` (NULL:
 * nothing) cuts away. The same bits for any number of threads. */
void iso_solid_bits_add_shapes(iso_solid_bits *bits, const iso_shapes *shapes, const iso_clip *clip,
                               iso_pool *pool);
/* Sets the bits of voxels behind triangles, which are counterclockwise seen from outside; meshes are hollow.
 */
void iso_solid_bits_add_mesh(iso_solid_bits *bits, const iso_mesh_view *mesh, const iso_clip *clip,
                             iso_pool *pool);

#endif
