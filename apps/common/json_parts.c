#include "apps/common/json_parts.h"

void iso_put_components(iso_json *json, const char *key, const iso_components_totals *parts) {
    iso_json_begin_object(json, key);
    iso_json_integer(json, "kept", parts->kept);
    iso_json_integer(json, "dropped", parts->dropped);
    iso_json_real(json, "dropped_share", parts->dropped_share);
    iso_json_integer(json, "kept_voxels", parts->kept_voxels);
    iso_json_integer(json, "dropped_voxels", parts->dropped_voxels);
    iso_json_real(json, "kept_volume", parts->kept_volume);
    iso_json_real(json, "dropped_volume", parts->dropped_volume);
    iso_json_end_object(json);
}

void iso_put_mesh_measures(iso_json *json, const char *key, const iso_mesh_measures *measures) {
    iso_json_begin_object(json, key);
    iso_json_integer(json, "pieces", measures->pieces);
    iso_json_real(json, "area", measures->area);
    iso_json_real(json, "volume", measures->volume);
    iso_json_integer(json, "open_edges", measures->open_edges);
    iso_json_integer(json, "crowded_edges", measures->crowded_edges);
    iso_json_real(json, "euler", (double)measures->euler);
    iso_json_end_object(json);
}
