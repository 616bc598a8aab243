/* vector_font: the table of characters and their strokes. */
#include "image/vector_font.h"

#include <stddef.h>

/* strokes: polylines separated by blanks; each point is two digits, x and y. */
typedef struct glyph {
    char character;
    int width;
    const char *strokes;
} glyph;

static const glyph glyphs[] = {
    {'0', 4, "103041453616050110"},
    {'1', 2, "012026"},
    {'2', 4, "01103041420646"},
    {'3', 4, "01103041423323 334445361605"},
    {'4', 4, "36300444"},
    {'5', 4, "400002324345361605"},
    {'6', 4, "413010010516364544331304"},
    {'7', 4, "004016"},
    {'8', 4, "103041423313020110 133344453616050413"},
    {'9', 4, "051636454130100102133342"},
    {'.', 0, "0606"},
    {'-', 3, "0333"},
    {'+', 3, "0333 1224"},
    {'d', 3, "3036 3222120305162635"},
    {'e', 3, "043433221203051626"},
    {'f', 2, "201116 0222"},
    {'g', 3, "3237281808 3222120305162635"},
    {'k', 3, "0600 3205 1436"},
    {'m', 6, "0602 0312223336 3342526366"},
    {'n', 3, "0602 0312223336"},
    {'t', 2, "101526 0222"},
    {'u', 3, "0208 05162635 3236"},
    {'L', 3, "000636"},
    {'R', 4, "06003041423303 2346"},
    {'A', 4, "062046 1333"},
    {'P', 4, "06003041423303"},
    {'H', 4, "0006 4046 0343"},
    {'F', 4, "400006 0333"},
    {'x', 4, "0246 4206"},
    {'y', 4, "0226 4218"},
    {'z', 4, "02420646"},
};
enum { SPACING = 2, BLANK = 2 };

static const glyph *glyph_of(char character) {
    for (size_t i = 0; i < sizeof glyphs / sizeof *glyphs; i++)
        if (glyphs[i].character == character) return &glyphs[i];
    static const glyph blank = {' ', BLANK, ""};
    return &blank;
}

int iso_font_width(const char *text) {
    int width = 0;
    for (; *text; text++) width += glyph_of(*text)->width + (text[1] ? SPACING : 0);
    return width;
}

int iso_font_lines(const char *text, iso_font_line *lines, int room) {
    int count = 0, left = 0;
    for (; *text; text++) {
        const glyph *g = glyph_of(*text);
        for (const char *s = g->strokes; *s; s += *s == ' ') {
            for (; s[2] && s[2] != ' '; s += 2, count++)
                if (count < room)
                    lines[count] =
                        (iso_font_line){left + s[0] - '0', s[1] - '0', left + s[2] - '0', s[3] - '0'};
            s += 2;
        }
        left += g->width + SPACING;
    }
    return count;
}
