/* assembly: how the chains of a .pdb file are copied to a biological assembly: its remarks 350. Internal to
 * src/io/glyphs. */
#ifndef ISO_IO_GLYPHS_ASSEMBLY_H
#define ISO_IO_GLYPHS_ASSEMBLY_H

#include "io/rows.h"

#ifdef __cplusplus
extern "C" {
#endif

/* A copy of some chains: moved by a matrix. */
typedef struct iso_assembly_copy {
    double matrix[12]; /* rows of a 3 x 4 matrix */
    bool chains[256];  /* by the character of a chain */
} iso_assembly_copy;

/* Zero-initialise, then set wanted; iso_assembly_free when done. */
typedef struct iso_assembly {
    int wanted;  /* which of the file's assemblies, from 1 */
    int current; /* the one whose remarks are being read */
    iso_buffer buffer;
    iso_assembly_copy *copies;
    size_t count;
    int next_row;      /* the row of the last copy's matrix that comes next: 0, if it is complete */
    bool chains[256];  /* that the next copies are of */
    bool has_chains;   /* a row has named chains since the assembly began */
    bool named_before; /* the row before has named chains: the next one may go on */
} iso_assembly;

/* Takes a row that begins with "REMARK 350". ISO_ERR_FORMAT, ISO_ERR_LIMIT, ISO_ERR_NOMEM. */
iso_status iso_assembly_take(iso_assembly *assembly, const iso_rows *rows, const char *row, iso_error *error);
void iso_assembly_free(iso_assembly *assembly, iso_reading *reading);

/* Parses the number in characters from .. to - 1 of a row, which may be shorter. False: there is none. */
bool iso_pdb_number(const char *row, int from, int to, double *number);

#ifdef __cplusplus
}
#endif
#endif
