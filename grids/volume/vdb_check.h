/* vdb_check: whether the bytes of a grid in a .vdb file are laid out as OpenVDB's reader takes for granted.
 *
 * That reader believes the length of a block of values that is not compressed and reads as much into memory
 * that it sized by counting bits elsewhere: one flipped bit overwrites the heap. */
#ifndef ISO_GRIDS_VOLUME_VDB_CHECK_H
#define ISO_GRIDS_VOLUME_VDB_CHECK_H

#include <stdbool.h>
#include <stdint.h>

#include "base/status.h"

#ifdef __cplusplus
extern "C" {
#endif

/* How the leaves of a tree keep their voxels. */
typedef enum iso_vdb_leaf { ISO_VDB_VALUES, ISO_VDB_BOOLS, ISO_VDB_MASK } iso_vdb_leaf;

/* A tree of 32^3, 16^3 and 8^3 nodes, in a file of version 222 or later. */
typedef struct iso_vdb_layout {
    int value_bytes;  /* of one value in memory, as tiles and inactive values are stored */
    int stored_bytes; /* of one value in a block: less for halves */
    iso_vdb_leaf leaf;
    bool compressed, blosc, active_only; /* blocks: with a length before them; only values of active voxels */
    uint64_t topology;                   /* where the tree begins in the file */
    uint64_t blocks, end; /* where its voxels begin and where it ends; 0: not stated, it may end anywhere */
} iso_vdb_layout;

/* What a tree is made of: what it takes in memory follows from that. */
typedef struct iso_vdb_nodes {
    uint64_t tiles;        /* of the root */
    uint64_t upper, lower; /* nodes of 32^3 and of 16^3 children */
    uint64_t leaves;
} iso_vdb_nodes;

/* ISO_OK, or ISO_ERR_IO: truncated or corrupt, or ISO_ERR_NOMEM. Nothing is kept. */
iso_status iso_vdb_check(const char *path, const iso_vdb_layout *layout, iso_error *error);

/* Counts the nodes of a tree, and checks what comes before its voxels; errors as above. */
iso_status iso_vdb_count(const char *path, const iso_vdb_layout *layout, iso_vdb_nodes *nodes,
                         iso_error *error);

#ifdef __cplusplus
}
#endif
#endif
