/* golden: hashes of everything that the library computes, compared with a committed table.
 *
 * A row is a name and the FNV-1a hash of one result: the points, the mesh or a picture of one volume, or the
 * field that a stroke file makes. Results are the same bytes for every instruction set and thread count, so
 * there is one table for all of them. */
#ifndef ISO_TESTS_GOLDEN_H
#define ISO_TESTS_GOLDEN_H

#include <stddef.h>
#include <stdint.h>

#include "base/parallel.h"
#include "image/image.h"

typedef struct golden_table golden_table;

/* 64-bit FNV-1a over bytes; begin with GOLDEN_HASH_START. */
#define GOLDEN_HASH_START 0xcbf29ce484222325u
uint64_t golden_hash(uint64_t hash, const void *data, size_t bytes);

/* Adds a result to a table that is being written, or compares it with the committed row of that name.
 * `picture`, when not NULL, is left beside the test's other output if the row differs. */
void golden_row(golden_table *table, const char *name, uint64_t hash, const iso_image *picture);

/* Ends the program with the error's text unless `status` is ISO_OK. */
void golden_check(iso_status status, const iso_error *error);

/* The rows of all volumes (golden_volumes.c) and of all stroke files (golden_strokes.c). `folder` is the
 * source folder. */
void golden_volumes(golden_table *table, const char *folder, iso_pool *pool);
void golden_strokes(golden_table *table, const char *folder, iso_pool *pool);

#endif
