/* vdb_check: checks that the bytes of a grid in a .vdb file are laid out as OpenVDB's reader expects.
 *
 * OpenVDB reads a block of uncompressed values by the length stored before it, into memory whose size follows
 * from bits stored elsewhere. In a damaged file the two differ, and OpenVDB would write beyond its memory. */
#ifndef ISO_GRIDS_VOLUME_VDB_CHECK_H
#define ISO_GRIDS_VOLUME_VDB_CHECK_H

#include <stdbool.h>
#include <stdint.h>

#include "base/c_linkage.h"
#include "base/status.h"

ISO_C_BEGIN

/* How the leaves of a tree store their voxels. */
typedef enum iso_vdb_leaf { ISO_VDB_VALUES, ISO_VDB_BOOLS, ISO_VDB_MASK } iso_vdb_leaf;

/* A tree of 32^3, 16^3 and 8^3 nodes, in a file of version 222 or later. */
typedef struct iso_vdb_layout {
    int value_bytes;  /* size of a value in memory, and of tiles and inactive values in the file */
    int stored_bytes; /* size of a value in a block: less for grids of halves */
    iso_vdb_leaf leaf;
    bool compressed, blosc; /* blocks begin with a length; they are Blosc chunks */
    bool active_only;       /* blocks have only the values of active voxels */
    uint64_t topology;      /* position of the tree in the file */
    uint64_t blocks, end;   /* positions of the tree's voxels and of its end; 0: not stated */
} iso_vdb_layout;

/* The numbers of a tree's nodes, from which its memory follows. */
typedef struct iso_vdb_nodes {
    uint64_t tiles;        /* of the root */
    uint64_t upper, lower; /* nodes of 32^3 and of 16^3 children */
    uint64_t leaves;
} iso_vdb_nodes;

/* Checks a whole tree. ISO_ERR_IO: truncated or corrupt; ISO_ERR_NOMEM. */
iso_status iso_vdb_check(const char *path, const iso_vdb_layout *layout, iso_error *error);

/* Counts the nodes of a tree, and checks everything before its voxels. Errors: those of iso_vdb_check. */
iso_status iso_vdb_count(const char *path, const iso_vdb_layout *layout, iso_vdb_nodes *nodes,
                         iso_error *error);

ISO_C_END
#endif
