/* consumer FILE ISOVALUE: prints how many points a volume's surface has. */
#include <stdio.h>
#include <stdlib.h>

#include "extract/points.h"
#include "grids/volume.h"

int main(int argc, char **argv) {
    iso_error error = {0};
    iso_volume volume = {0};
    iso_point_set *set = NULL;
    if (argc != 3) return 2;
    iso_points_opts opts = {.isovalue = atof(argv[2])};
    iso_status status = iso_volume_read(argv[1], NULL, &volume, &error);
    if (status == ISO_OK) status = iso_point_set_create(&volume.grid, &opts, &set, &error);
    if (status == ISO_OK) status = iso_point_set_update(set, &error);
    if (status == ISO_OK) printf("%zu\n", iso_point_set_stats(set).points);
    if (status != ISO_OK) fprintf(stderr, "%s\n", error.text);
    iso_point_set_destroy(set);
    iso_volume_free(&volume);
    return iso_status_exit(status);
}
