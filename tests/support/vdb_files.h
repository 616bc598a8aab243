/* vdb_files: writes the .vdb files that test_vdb reads back. All functions return 0, or 1 on failure. */
#ifndef ISO_TESTS_VDB_FILES_H
#define ISO_TESTS_VDB_FILES_H

#include "base/c_linkage.h"

ISO_C_BEGIN

enum vdb_class { VDB_UNKNOWN, VDB_LEVEL_SET, VDB_FOG };

typedef struct vdb_spec {
    const char *name;
    const char *type; /* float double int32 int64 bool mask vec3s */
    enum vdb_class grid_class;
    double background;
    int lo[3], hi[3]; /* the voxels for which `value` is called */
    /* Returns the value of a component at a voxel; sets *active to 0 for a voxel that is not set. */
    double (*value)(const void *context, const int voxel[3], int component, int *active);
    const void *context;
    double axis[9];   /* row-major, columns are the world steps of the index axes */
    double origin[3]; /* world position of voxel (0, 0, 0) */
    int half;         /* stored as half floats */
    int frustum;      /* a transform that is not linear */
    int local;        /* vectors are in local space, not in the world */
} vdb_spec;

enum vdb_flags { VDB_STREAM = 1, VDB_NO_STATS = 2, VDB_ZIP = 4, VDB_BLOSC = 8, VDB_ACTIVE_MASK = 16 };

int vdb_write(const char *path, const vdb_spec *specs, int count, int flags);

/* Writes a file with one grid of points, which has no voxels to read. */
int vdb_write_points(const char *path, const char *name);

/* Writes two grids, "a" and "b", that share one tree; b is shifted by `shift` along x. */
int vdb_write_instances(const char *path, const vdb_spec *spec, double shift);

ISO_C_END
#endif
