/* consumer FILE ISOVALUE: prints how many points a volume's surface has. */
#include <stdio.h>
#include <stdlib.h>

#include <isopoint.h>

int main(int argc, char **argv) {
    iso_error error = {0};
    iso_volume *volume = NULL;
    iso_surface *surface = NULL;
    size_t count = 0;
    if (argc != 3) return 2;
    iso_surface_opts opts = {.isovalue = atof(argv[2])};
    iso_status status = iso_volume_open(argv[1], NULL, &volume, &error);
    if (status == ISO_OK) status = iso_surface_create(volume, &opts, &surface, &error);
    if (status == ISO_OK) status = iso_surface_points(surface, NULL, 0, &count, &error);
    if (status == ISO_OK) printf("%zu\n", count);
    if (status != ISO_OK) fprintf(stderr, "%s\n", error.text);
    iso_surface_destroy(surface);
    iso_volume_destroy(volume);
    return iso_status_exit(status);
}
