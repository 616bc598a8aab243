/* pdb: molecules (wwPDB, "Atomic Coordinate Entry Format Version 3.3"): ATOM and HETATM rows of the first
 * model, with numbers in fixed columns, which may follow each other without a blank. Coordinates are in
 * angstrom.
 *
 * If the element column is empty, the element is taken from the atom's name, whose first two columns contain
 * it, right-aligned: "CA" from the first column on is calcium, from the second on a carbon. Of several
 * alternate locations of an atom the first is read. The copies of the wanted assembly are made by its
 * matrices (assembly.h). Programs write serial numbers above 99999 and numbers of residues above 9999 with
 * one digit more, which shifts the columns behind them, or in letters and digits ("hybrid-36"), which does
 * not.
 *
 * Entries of the Protein Data Bank, which begin with a HEADER, end with END, and models with ENDMDL: without
 * them the file is truncated.
 *
 * Attributes: the number of the chain in order of appearance, the temperature factor, and the number of the
 * copy if there are several; all count from 0. */
#include <ctype.h>
#include <string.h>

#include "io/common/rows.h"
#include "io/glyphs/assembly.h"
#include "io/glyphs/atoms.h"
#include "io/glyphs/elements.h"

/* First characters of columns, from 0. */
enum {
    AT_SERIAL = 6,
    AT_NAME = 12,
    AT_LOCATION = 16,
    AT_RESIDUE = 17,
    AT_CHAIN = 21,
    AT_NUMBER = 22, /* of the residue */
    AT_X = 30,
    AT_TEMPERATURE = 60,
    AT_ELEMENT = 76,
    ROW = 80,
    MORE_DIGITS = 3, /* of a number */
    ROOM = ROW + 2 * MORE_DIGITS,
    /* Alternate locations of an atom are searched for among so many atoms before it; residues have fewer. */
    NEAR = 256
};

typedef struct atom {
    double position[3];
    float temperature;
    uint8_t element, chain;
    char location;
    char name[4], residue[10]; /* residue: its name, chain and number */
} atom;

enum { CHAIN, TEMPERATURE, COPY, COLUMNS };

typedef struct pdb {
    iso_polydata *data;
    iso_reading *reading;
    iso_text_rows rows;
    iso_buffer atom_buffer;
    atom *atoms;
    size_t count;
    uint64_t unknown, alternates; /* atoms of unknown elements; further locations, which were left out */
    int chain_numbers[256];       /* by the character of the chain; 0: the chain has not appeared yet */
    int chains;
    iso_assembly assembly;
} pdb;

/* ---- atoms */

/* Returns the element for an atom's name of four characters; see the head of this file. */
static int element_of_name(const char name[4]) {
    if (!isalpha((unsigned char)name[0])) return iso_element_of(name + 1, 1);
    /* names of hydrogens with four characters begin in the first column */
    const bool two = isalpha((unsigned char)name[1]) && !(name[0] == 'H' && name[3] != ' ');
    const int element = two ? iso_element_of(name, 2) : 0;
    return element ? element : iso_element_of(name, 1);
}

static int element_of_row(const char row[ROW]) {
    const char *field = row + AT_ELEMENT;
    const int element =
        field[0] == ' ' ? iso_element_of(field + 1, 1) : iso_element_of(field, field[1] == ' ' ? 1 : 2);
    return element ? element : element_of_name(row + AT_NAME);
}

/* Returns whether a previous atom of the same residue is another location of this atom: it has the same name,
 * or the residue itself has alternates. */
static bool is_alternate(const pdb *p, const atom *a) {
    if (a->location == ' ') return false;
    for (size_t i = p->count; i-- > 0 && p->count - i <= NEAR;) {
        const atom *b = &p->atoms[i];
        if (memcmp(a->residue + 3, b->residue + 3, sizeof a->residue - 3) != 0) continue;
        if (b->location == a->location || b->location == ' ') continue;
        if (memcmp(a->name, b->name, sizeof a->name) == 0 || memcmp(a->residue, b->residue, 3) != 0)
            return true;
    }
    return false;
}

static uint8_t chain_of(pdb *p, char name) {
    int *number = &p->chain_numbers[(unsigned char)name];
    if (*number == 0) *number = ++p->chains;
    return (uint8_t)(*number - 1);
}

static bool has_digits(const char *row, int from, int to) {
    while (from < to && isdigit((unsigned char)row[from])) from++;
    return from == to;
}

/* Whether the decimal points of the coordinates lie `more` columns behind their own. */
static bool has_points(const char *row, int more) {
    for (int axis = 0; axis < 3; axis++)
        if (row[AT_X + 4 + 8 * axis + more] != '.') return false;
    return true;
}

static void remove_digit(char row[ROOM + 1], int at) {
    memmove(row + at, row + at + 1, (size_t)(ROOM - at));
}

/* Removes the first digits of numbers that are too long, so that all others are in their columns. */
static void shorten_numbers(char row[ROOM + 1]) {
    for (int i = 0; i < MORE_DIGITS && has_digits(row, AT_SERIAL, AT_NAME); i++) remove_digit(row, AT_SERIAL);
    for (int more = MORE_DIGITS; more > 0; more--)
        if (has_points(row, more) && has_digits(row, AT_NUMBER, AT_NUMBER + 4 + more))
            for (int i = 0; i < more; i++) remove_digit(row, AT_NUMBER);
}

/* Copies a row and fills it up with blanks. Some programs write names of four characters one column too far
 * to the right, as " H111"; their last digit would be mistaken for a location. */
static void pad_row(const char *row, char padded[ROOM + 1]) {
    const size_t length = strlen(row);
    memset(padded, ' ', ROOM);
    memcpy(padded, row, length < ROOM ? length : ROOM);
    padded[ROOM] = 0;
    shorten_numbers(padded);
    if (padded[AT_NAME] != ' ' || padded[AT_NAME + 3] == ' ' || !isdigit((unsigned char)padded[AT_LOCATION]))
        return;
    memmove(padded + AT_NAME, padded + AT_NAME + 1, 4);
    padded[AT_LOCATION] = ' ';
}

static iso_status take_atom(pdb *p, const char *row, iso_error *error) {
    char padded[ROOM + 1];
    double temperature = 0;
    ISO_TRY(iso_reading_reserve(p->reading, &p->atom_buffer, p->count + 1, sizeof(atom), p->count, error));
    p->atoms = p->atom_buffer.data;
    pad_row(row, padded);
    atom a = {.location = padded[AT_LOCATION], .element = (uint8_t)element_of_row(padded)};
    for (int axis = 0; axis < 3; axis++)
        if (!iso_pdb_number(padded, AT_X + 8 * axis, AT_X + 8 * axis + 8, &a.position[axis]))
            return iso_text_rows_fail(&p->rows, "an atom without three coordinates", error);
    memcpy(a.name, padded + AT_NAME, sizeof a.name);
    memcpy(a.residue, padded + AT_RESIDUE, sizeof a.residue);
    if (is_alternate(p, &a)) {
        p->alternates++;
        return ISO_OK;
    }
    if (iso_pdb_number(padded, AT_TEMPERATURE, AT_TEMPERATURE + 6, &temperature))
        a.temperature = (float)temperature;
    a.chain = chain_of(p, padded[AT_CHAIN]);
    p->unknown += a.element == 0;
    p->atoms[p->count++] = a;
    return ISO_OK;
}

static bool begins(const char *row, const char *record) {
    return strncmp(row, record, strlen(record)) == 0;
}

/* (A serial number of six digits may take the second blank.) */
static bool is_atom(const char *row) {
    return begins(row, "ATOM ") || begins(row, "HETATM");
}

/* What the rows of a file have said so far. */
typedef struct progress {
    bool known;          /* a row of this format has been found */
    bool entry, ended;   /* the file begins with HEADER; it has an END */
    bool model, further; /* a model has begun and not ended; further models follow the first */
} progress;

static void take_record(progress *seen, const char *row) {
    if (begins(row, "HEADER") && !seen->known) seen->entry = true;
    seen->known = seen->known || is_atom(row) || begins(row, "REMARK") || begins(row, "HEADER") ||
                  begins(row, "CRYST1");
    if (begins(row, "MODEL ")) seen->model = true;
    if (begins(row, "ENDMDL")) seen->model = false;
    seen->ended = seen->ended || (begins(row, "END") && !begins(row, "ENDMDL"));
}

/* Reads up to the end of the first model. */
static iso_status read_model(pdb *p, progress *seen, iso_error *error) {
    for (char *row = iso_text_rows_next(&p->rows); row; row = iso_text_rows_next(&p->rows)) {
        take_record(seen, row);
        if (is_atom(row)) ISO_TRY(take_atom(p, row, error));
        if (begins(row, "REMARK 350")) ISO_TRY(iso_assembly_take(&p->assembly, &p->rows, row, error));
        if (begins(row, "ENDMDL")) break;
    }
    return ISO_OK;
}

static iso_status read_rows(pdb *p, iso_error *error) {
    progress seen = {.known = false};
    ISO_TRY(read_model(p, &seen, error));
    if (!seen.known) return iso_fail(error, ISO_ERR_FORMAT, "%s: not a .pdb file", p->reading->path);
    for (char *row = iso_text_rows_next(&p->rows); row; row = iso_text_rows_next(&p->rows)) {
        take_record(&seen, row);
        seen.further = seen.further || seen.model;
    }
    if (seen.model || (seen.entry && !seen.ended))
        return iso_fail(error, ISO_ERR_IO, "%s: truncated: it has no %s record", p->reading->path,
                        seen.model ? "ENDMDL" : "END");
    if (seen.further) iso_reading_note(p->reading, "further models follow: only the first is read");
    return ISO_OK;
}

/* ---- copies */

/* Sets the only copy of a file without an assembly: all chains, not moved. */
static void stand_alone(iso_assembly_copy *copy) {
    *copy = (iso_assembly_copy){.matrix = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0}};
    memset(copy->chains, true, sizeof copy->chains);
}

static size_t count_atoms(const pdb *p, const iso_assembly_copy *copy) {
    size_t count = 0;
    for (size_t i = 0; i < p->count; i++)
        count += copy->chains[(unsigned char)p->atoms[i].residue[AT_CHAIN - AT_RESIDUE]];
    return count;
}

static void move_atom(const iso_assembly_copy *copy, const atom *a, double world[3]) {
    for (int row = 0; row < 3; row++) {
        const double *m = copy->matrix + 4 * row;
        world[row] = m[0] * a->position[0] + m[1] * a->position[1] + m[2] * a->position[2] + m[3];
    }
}

/* Adds the atoms of copy `number`; columns: where the attributes go, COPY only if there are several. */
static void add_copy(const pdb *p, const iso_assembly_copy *copy, size_t number,
                     float *const columns[COLUMNS], iso_atoms *atoms) {
    for (size_t i = 0; i < p->count; i++) {
        const atom *a = &p->atoms[i];
        double world[3];
        if (!copy->chains[(unsigned char)a->residue[AT_CHAIN - AT_RESIDUE]]) continue;
        columns[CHAIN][atoms->count] = a->chain;
        columns[TEMPERATURE][atoms->count] = a->temperature;
        if (columns[COPY]) columns[COPY][atoms->count] = (float)number;
        move_atom(copy, a, world);
        iso_atoms_add(atoms, a->element, world);
    }
}

static void note_oddities(pdb *p, size_t made) {
    if (p->alternates)
        iso_reading_note(p->reading, "%llu alternate locations are left out",
                         (unsigned long long)p->alternates);
    if (p->assembly.count > 1)
        iso_reading_note(p->reading, "assembly %d: %zu copies make %zu atoms of %zu", p->assembly.wanted,
                         p->assembly.count, made, p->count);
    else if (made < p->count)
        iso_reading_note(p->reading, "assembly %d leaves out the chains of %zu atoms", p->assembly.wanted,
                         p->count - made);
}

static iso_status add_atoms(pdb *p, const iso_assembly_copy *copies, size_t count, iso_error *error) {
    static const char *const names[COLUMNS] = {"chain", "temperature", "copy"};
    float *columns[COLUMNS] = {NULL};
    iso_atoms atoms;
    size_t total = 0;
    const int column_count = count > 1 ? COLUMNS : COPY;
    int numbers[COLUMNS];
    for (size_t i = 0; i < count; i++)
        if (__builtin_add_overflow(total, count_atoms(p, &copies[i]), &total)) total = SIZE_MAX / 8;
    for (int i = 0; i < column_count; i++)
        ISO_TRY(iso_polydata_add_column(p->data, names[i], 1, false, ISO_ROLE_NONE, &numbers[i], error));
    ISO_TRY(iso_atoms_begin(p->data, total, &atoms, error));
    for (int i = 0; i < column_count; i++) columns[i] = iso_polydata_column(p->data, numbers[i])->values.data;
    for (size_t i = 0; i < count; i++) add_copy(p, &copies[i], i, columns, &atoms);
    atoms.unknown = p->unknown; /* not once a copy */
    iso_atoms_end(&atoms);
    note_oddities(p, atoms.count);
    return ISO_OK;
}

/* Returns whether the assembly has atoms; one that names none of the file's chains is ignored. */
static bool has_atoms(const pdb *p) {
    size_t atoms = 0;
    for (size_t i = 0; i < p->assembly.count && atoms == 0; i++)
        atoms = count_atoms(p, &p->assembly.copies[i]);
    return atoms > 0;
}

static iso_status read_pdb(pdb *p, iso_error *error) {
    const int asked = p->reading->opts.assembly;
    iso_assembly_copy alone;
    stand_alone(&alone);
    p->assembly.wanted = asked > 0 ? asked : 1;
    ISO_TRY(iso_text_rows_load(p->reading, &p->rows, error));
    ISO_TRY(read_rows(p, error));
    if (p->assembly.next_row != 0)
        return iso_fail(error, ISO_ERR_FORMAT, "%s: a BIOMT matrix is not complete", p->reading->path);
    if (asked > 0 && p->assembly.count == 0)
        return iso_fail(error, ISO_ERR_USAGE, "%s: no assembly %d: there %s %d", p->reading->path, asked,
                        p->assembly.current == 1 ? "is" : "are", p->assembly.current);
    if (asked < 0 || !has_atoms(p)) return add_atoms(p, &alone, 1, error);
    return add_atoms(p, p->assembly.copies, p->assembly.count, error);
}

iso_status iso_polydata_read_pdb(iso_polydata *data, iso_error *error) {
    pdb *p = iso_alloc_zero(1, sizeof *p);
    if (!p) return iso_fail_memory(error, data->reading->path);
    p->data = data;
    p->reading = data->reading;
    const iso_status status = read_pdb(p, error);
    iso_text_rows_free(&p->rows);
    iso_assembly_free(&p->assembly, p->reading);
    iso_reading_free(p->reading, &p->atom_buffer);
    iso_free(p);
    return status;
}
