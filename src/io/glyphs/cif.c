/* cif: molecules in mmCIF (wwPDB, PDBx/mmCIF; syntax: IUCr, "CIF version 1.1"): the rows of the loop of
 * _atom_site, of its first model. Coordinates are in angstrom. Of several alternate locations of an atom the
 * first is read, as of .pdb files. Copies of assemblies are not made, which a note says. Other CIF, of small
 * molecules with fractional coordinates or of reflections, is refused.
 *
 * Attributes: the number of the chain in order of appearance, and the temperature factor. */
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "base/parse.h"
#include "io/glyphs/atoms.h"
#include "io/glyphs/elements.h"

/* A word, a quoted text or a text of several lines; in the text that was loaded. */
typedef struct cif_token {
    const char *text;
    size_t length;
    bool quoted;
} cif_token;

/* Columns of _atom_site that are read; of three pairs the second is used where the first is not there. */
enum {
    X,
    Y,
    Z,
    SYMBOL,
    TEMPERATURE,
    MODEL,
    LOCATION,
    INSERTION,
    ATOM,
    ATOM_2,
    RESIDUE,
    RESIDUE_2,
    CHAIN,
    CHAIN_2,
    NUMBER,
    NUMBER_2,
    TAGS
};
static const char *const TAG[TAGS] = {"Cartn_x",       "Cartn_y",           "Cartn_z",
                                      "type_symbol",   "B_iso_or_equiv",    "pdbx_PDB_model_num",
                                      "label_alt_id",  "pdbx_PDB_ins_code", "auth_atom_id",
                                      "label_atom_id", "auth_comp_id",      "label_comp_id",
                                      "auth_asym_id",  "label_asym_id",     "auth_seq_id",
                                      "label_seq_id"};

enum { MOST_COLUMNS = 256, NEAR = 256 /* as of .pdb files */, MOST_CHAINS = 1 << 16 };

typedef struct cif_atom {
    double position[3];
    float temperature;
    int element, chain;
    cif_token name, residue, chain_name, number, insertion, location;
} cif_atom;

typedef struct cif {
    iso_reading *reading;
    const char *begin, *at, *end;
    iso_buffer buffer; /* of cif_atom */
    size_t count;
    int chains;
    uint64_t alternates;
    cif_token model;
    bool further, has_loop, fractional, assemblies;
} cif;

/* ---- syntax */

static bool is_blank(char c) {
    return c == ' ' || c == '\t' || c == '\n' || c == '\r';
}

static iso_status truncated(const cif *c, iso_error *error) {
    return iso_fail(error, ISO_ERR_IO, "%s: truncated", c->reading->path);
}

static void skip_blanks(cif *c) {
    while (c->at < c->end && (is_blank(*c->at) || *c->at == '#')) {
        if (*c->at == '#')
            while (c->at < c->end && *c->at != '\n') c->at++;
        else
            c->at++;
    }
}

/* Takes the next token; of length 0 and not quoted at the end of the file. ISO_ERR_IO: a text has no end. */
static iso_status next_token(cif *c, cif_token *token, iso_error *error) {
    skip_blanks(c);
    *token = (cif_token){c->at, 0, false};
    if (c->at == c->end) return ISO_OK;
    const char first = *c->at;
    if (first == ';' && (c->at == c->begin || c->at[-1] == '\n')) {
        const char *close = memmem(c->at, (size_t)(c->end - c->at), "\n;", 2);
        if (!close) return truncated(c, error);
        *token = (cif_token){c->at + 1, (size_t)(close - c->at - 1), true};
        c->at = close + 2;
        return ISO_OK;
    }
    if (first == '\'' || first == '"') {
        const char *close = c->at + 1;
        while (close < c->end && *close != '\n' &&
               !(*close == first && (close + 1 == c->end || is_blank(close[1]))))
            close++;
        if (close == c->end || *close == '\n') return truncated(c, error);
        *token = (cif_token){c->at + 1, (size_t)(close - c->at - 1), true};
        c->at = close + 1;
        return ISO_OK;
    }
    while (c->at < c->end && !is_blank(*c->at)) c->at++;
    token->length = (size_t)(c->at - token->text);
    return ISO_OK;
}

static bool is_word(const cif_token *token, const char *word) {
    return !token->quoted && token->length == strlen(word) &&
           strncasecmp(token->text, word, token->length) == 0;
}

static bool begins(const cif_token *token, const char *word) {
    return !token->quoted && token->length >= strlen(word) &&
           strncasecmp(token->text, word, strlen(word)) == 0;
}

/* Whether a token is no value: a tag, or a word of the syntax; or the end. */
static bool is_no_value(const cif_token *token) {
    return !token->quoted && (token->length == 0 || *token->text == '_' || is_word(token, "loop_") ||
                              begins(token, "data_") || begins(token, "save_"));
}

static bool same(const cif_token *a, const cif_token *b) {
    return a->length == b->length && memcmp(a->text, b->text, a->length) == 0;
}

/* Whether a value is stated: "." and "?" are none. */
static bool is_stated(const cif_token *token) {
    return token->quoted || (token->length > 0 && !is_word(token, ".") && !is_word(token, "?"));
}

/* A number, perhaps with its uncertainty in brackets behind it. */
static bool number_of(const cif_token *token, double *number) {
    char text[64];
    size_t length = 0;
    while (length < token->length && token->text[length] != '(') length++;
    if (length == 0 || length >= sizeof text) return false;
    memcpy(text, token->text, length);
    text[length] = 0;
    return iso_parse_real(text, number);
}

/* ---- atoms */

/* As of .pdb files: another location of the same atom, or of a residue that has alternates. */
static bool is_alternate(const cif *c, const cif_atom *a) {
    const cif_atom *atoms = c->buffer.data;
    if (!is_stated(&a->location)) return false;
    for (size_t i = c->count; i-- > 0 && c->count - i <= NEAR;) {
        const cif_atom *b = &atoms[i];
        if (!same(&a->chain_name, &b->chain_name) || !same(&a->number, &b->number) ||
            !same(&a->insertion, &b->insertion) || !is_stated(&b->location) ||
            same(&a->location, &b->location))
            continue;
        if (same(&a->name, &b->name) || !same(&a->residue, &b->residue)) return true;
    }
    return false;
}

/* The number of a chain: that of an earlier atom with its name. Files have chains one after the other, but
 * for waters, so that the last ones are looked at first. */
static int chain_of(cif *c, const cif_token *name, iso_buffer *firsts, iso_error *error, iso_status *status) {
    const cif_token *seen = firsts->data;
    for (int i = c->chains; i-- > 0;)
        if (same(&seen[i], name)) return i;
    if (c->chains == MOST_CHAINS) {
        *status =
            iso_fail(error, ISO_ERR_LIMIT, "%s: has more than %d chains", c->reading->path, MOST_CHAINS);
        return 0;
    }
    *status = iso_reading_reserve(c->reading, firsts, (size_t)c->chains + 1, sizeof *seen, (size_t)c->chains,
                                  error);
    if (*status != ISO_OK) return 0;
    ((cif_token *)firsts->data)[c->chains] = *name;
    return c->chains++;
}

static cif_token value_of(const cif_token *row, const int column[TAGS], int tag) {
    const cif_token none = {"", 0, false};
    return column[tag] >= 0 ? row[column[tag]] : none;
}

static cif_token either_value(const cif_token *row, const int column[TAGS], int tag) {
    const cif_token first = value_of(row, column, tag);
    return is_stated(&first) ? first : value_of(row, column, tag + 1);
}

static iso_status take_atom(cif *c, const cif_token *row, const int column[TAGS], iso_buffer *firsts,
                            iso_error *error) {
    const cif_token model = value_of(row, column, MODEL);
    cif_atom a = {.name = either_value(row, column, ATOM),
                  .residue = either_value(row, column, RESIDUE),
                  .chain_name = either_value(row, column, CHAIN),
                  .number = either_value(row, column, NUMBER),
                  .insertion = value_of(row, column, INSERTION),
                  .location = value_of(row, column, LOCATION)};
    if (!c->model.text) c->model = model;
    if (!same(&c->model, &model)) {
        c->further = true;
        return ISO_OK;
    }
    for (int axis = 0; axis < 3; axis++) {
        const cif_token value = value_of(row, column, X + axis);
        if (!number_of(&value, &a.position[axis]))
            return iso_fail(error, ISO_ERR_FORMAT, "%s: atom %zu has no three coordinates", c->reading->path,
                            c->count + 1);
    }
    if (is_alternate(c, &a)) {
        c->alternates++;
        return ISO_OK;
    }
    const cif_token symbol = value_of(row, column, SYMBOL), warm = value_of(row, column, TEMPERATURE);
    double temperature;
    if (number_of(&warm, &temperature)) a.temperature = (float)temperature;
    a.element = symbol.length && symbol.length <= 2 ? iso_element_of(symbol.text, (int)symbol.length) : 0;
    iso_status status = ISO_OK;
    a.chain = chain_of(c, &a.chain_name, firsts, error, &status);
    ISO_TRY(status);
    ISO_TRY(iso_reading_reserve(c->reading, &c->buffer, c->count + 1, sizeof a, c->count, error));
    ((cif_atom *)c->buffer.data)[c->count++] = a;
    return ISO_OK;
}

/* Sets the columns of the tags that are read, as `_atom_site.Cartn_x`; -1: there is none. */
static void take_tag(cif *c, const cif_token *tag, int number, int column[TAGS]) {
    static const char category[] = "_atom_site.";
    const size_t length = sizeof category - 1;
    c->fractional |= begins(tag, "_atom_site_fract_");
    c->assemblies |= begins(tag, "_pdbx_struct_oper_list.matrix");
    if (!begins(tag, category)) return;
    const cif_token name = {tag->text + length, tag->length - length, false};
    for (int i = 0; i < TAGS; i++)
        if (is_word(&name, TAG[i])) column[i] = number;
}

/* Reads the loop behind loop_; *token becomes the first one behind it. */
static iso_status take_loop(cif *c, cif_token *token, iso_buffer *firsts, iso_error *error) {
    cif_token row[MOST_COLUMNS];
    int column[TAGS], columns = 0;
    for (int i = 0; i < TAGS; i++) column[i] = -1;
    ISO_TRY(next_token(c, token, error));
    for (; begins(token, "_"); columns++) {
        if (columns == MOST_COLUMNS)
            return iso_fail(error, ISO_ERR_FORMAT, "%s: a loop has more than %d columns", c->reading->path,
                            MOST_COLUMNS);
        take_tag(c, token, columns, column);
        ISO_TRY(next_token(c, token, error));
    }
    const bool atoms = column[X] >= 0 && column[Y] >= 0 && column[Z] >= 0 && !c->has_loop;
    c->has_loop |= atoms;
    int filled = 0;
    for (; !is_no_value(token) && columns; filled = (filled + 1) % columns) {
        row[filled] = *token;
        if (filled == columns - 1 && atoms) ISO_TRY(take_atom(c, row, column, firsts, error));
        ISO_TRY(next_token(c, token, error));
    }
    if (filled) return truncated(c, error);
    return ISO_OK;
}

static iso_status take_tokens(cif *c, iso_buffer *firsts, iso_error *error) {
    cif_token token;
    bool has_block = false;
    ISO_TRY(next_token(c, &token, error));
    while (token.length || token.quoted) {
        has_block |= begins(&token, "data_");
        if (!has_block) break;
        if (is_word(&token, "loop_")) {
            ISO_TRY(take_loop(c, &token, firsts, error));
            continue;
        }
        int none[TAGS];
        take_tag(c, &token, -1, none);
        ISO_TRY(next_token(c, &token, error));
    }
    if (!has_block) return iso_fail(error, ISO_ERR_FORMAT, "%s: not a .cif file", c->reading->path);
    if (c->has_loop) return ISO_OK;
    return iso_fail(error, ISO_ERR_UNSUPPORTED,
                    c->fractional
                        ? "%s: its atoms have fractional coordinates: obabel FILE -O out.xyz "
                          "--fillUC strict makes a molecule of the crystal"
                        : "%s: holds no atoms: there is no loop of _atom_site with Cartn_x, y and z",
                    c->reading->path);
}

static iso_status make_glyphs(cif *c, iso_polydata *data, iso_error *error) {
    int chain, temperature;
    iso_atoms atoms;
    ISO_TRY(iso_polydata_add_column(data, "chain", 1, false, ISO_ROLE_NONE, &chain, error));
    ISO_TRY(iso_polydata_add_column(data, "temperature", 1, false, ISO_ROLE_NONE, &temperature, error));
    ISO_TRY(iso_atoms_begin(data, c->count, &atoms, error));
    float *chains = iso_polydata_column(data, chain)->values.data,
          *temperatures = iso_polydata_column(data, temperature)->values.data;
    for (size_t i = 0; i < c->count; i++) {
        const cif_atom *a = (cif_atom *)c->buffer.data + i;
        chains[i] = (float)a->chain;
        temperatures[i] = a->temperature;
        iso_atoms_add(&atoms, a->element, a->position);
    }
    iso_atoms_end(&atoms);
    if (c->alternates)
        iso_reading_note(c->reading, "%llu alternate locations are left out",
                         (unsigned long long)c->alternates);
    if (c->further) iso_reading_note(c->reading, "further models follow: only the first is read");
    if (c->assemblies && c->reading->opts.assembly >= 0)
        iso_reading_note(c->reading,
                         "the atoms as listed: copies of assemblies are made of .pdb files alone");
    return ISO_OK;
}

static iso_status read_cif(cif *c, iso_buffer *text, iso_buffer *firsts, iso_polydata *data,
                           iso_error *error) {
    size_t bytes;
    if (c->reading->opts.assembly > 0)
        return iso_fail(error, ISO_ERR_USAGE, "%s: assemblies are made of .pdb files alone",
                        c->reading->path);
    ISO_TRY(iso_reading_load(c->reading, text, &bytes, error));
    c->begin = c->at = text->data;
    c->end = c->begin + bytes;
    ISO_TRY(take_tokens(c, firsts, error));
    return make_glyphs(c, data, error);
}

iso_status iso_polydata_read_cif(iso_polydata *data, iso_error *error) {
    cif c = {.reading = data->reading};
    iso_buffer text = {0}, firsts = {0};
    const iso_status status = read_cif(&c, &text, &firsts, data, error);
    iso_reading_free(data->reading, &c.buffer);
    iso_reading_free(data->reading, &firsts);
    iso_reading_free(data->reading, &text);
    return status;
}
