/* assembly: reads from the remarks 350 of a .pdb file how its chains are copied to a biological assembly.
 * Internal to src/io/glyphs. */
#ifndef ISO_IO_GLYPHS_ASSEMBLY_H
#define ISO_IO_GLYPHS_ASSEMBLY_H

#include "io/common/rows.h"

/* A copy of some chains, moved by a matrix. */
typedef struct iso_assembly_copy {
    double matrix[12]; /* rows of a 3 x 4 matrix */
    bool chains[256];  /* by the character that names a chain */
} iso_assembly_copy;

/* Zero-initialise, then set wanted; iso_assembly_free when done. */
typedef struct iso_assembly {
    int wanted;  /* number of the assembly to read, from 1 */
    int current; /* number of the assembly whose remarks are being read */
    iso_buffer buffer;
    iso_assembly_copy *copies;
    size_t count;
    int next_row;      /* next row of the last copy's matrix that is expected; 0: the matrix is complete */
    bool chains[256];  /* the chains that the next copies contain */
    bool has_chains;   /* a row has named chains since the assembly began */
    bool named_before; /* the previous row named chains, so the next one may continue it */
} iso_assembly;

/* Reads a row that begins with "REMARK 350". ISO_ERR_FORMAT, ISO_ERR_LIMIT, ISO_ERR_NOMEM. */
iso_status iso_assembly_take(iso_assembly *assembly, const iso_text_rows *rows, const char *row,
                             iso_error *error);
void iso_assembly_free(iso_assembly *assembly, iso_reading *reading);

/* Parses the number in characters from .. to - 1 of a row, which may be shorter. False: there is none. */
bool iso_pdb_number(const char *row, int from, int to, double *number);

#endif
