/* json_parts: writes objects that the reports of several programs contain. */
#ifndef ISO_APPS_COMMON_JSON_PARTS_H
#define ISO_APPS_COMMON_JSON_PARTS_H

#include "apps/common/json.h"
#include "scene/solid.h"

/* Writes which parts of the solid were kept and dropped. Their volumes (mm3) are those of the voxels
 * inside, each of which counts whole: a mesh's volume is what its triangles enclose, which is less by half
 * a voxel where caps end the solid at the outermost voxels' centres. */
void iso_put_components(iso_json *json, const char *key, const iso_components_totals *parts);

/* Writes the measures of a mesh: connected pieces, area (mm2), volume (mm3; null when the mesh is open), open
 * and crowded edges, and Euler number. */
void iso_put_mesh_measures(iso_json *json, const char *key, const iso_mesh_measures *measures);

#endif
